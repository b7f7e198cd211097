//! Digests, by which what was made earlier is known to be what would be made now.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::sync::OnceLock;

use crate::source::Sources;

/// What a digest is before the first part.
const BEGIN: u128 = 0x9e37_79b9_7f4a_7c15_c2b2_ae3d_27d4_eb4f;

/// 128 bits, into which sixteen bytes are mixed by one multiplication: a program of 20 MB is read at each call. Not
/// against forgery, and the same only between runs of one program, which [`of_request`](Self::of_request) makes part of
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u128);

impl Digest {
    /// Of several parts, with their lengths, so that none can be taken for another.
    pub fn of<'p>(parts: impl IntoIterator<Item = &'p [u8]>) -> Self {
        Self::finished(parts.into_iter().fold(BEGIN, absorbed))
    }

    /// Twice more, so that every bit of the last block reaches all bits.
    fn finished(state: u128) -> Self {
        Digest(mixed(mixed(state, 0), 0))
    }

    /// Of the program that runs, with the generator and all else that is linked into it; `None` where it cannot be
    /// read.
    pub fn of_this_program() -> Option<Self> {
        static PROGRAM: OnceLock<Option<Digest>> = OnceLock::new();
        let read = || Self::of_reader(File::open(std::env::current_exe().ok()?).ok()?).ok();
        *PROGRAM.get_or_init(read)
    }

    /// In parts that stay in the processor's cache: a file in one part would ask for as much memory, page by page.
    fn of_reader(mut reader: impl Read) -> io::Result<Self> {
        const PART: usize = 1 << 18;
        let (mut part, mut state) = (Vec::with_capacity(PART), BEGIN);
        loop {
            part.clear();
            (&mut reader).take(PART as u64).read_to_end(&mut part)?;
            if part.is_empty() {
                return Ok(Self::finished(state));
            }
            state = absorbed(state, &part);
        }
    }

    /// Of all that decides on what this program makes of a mechanism: itself, what is asked for, and the texts of the
    /// mechanism and of what it imports, as they are called in reports, with what is doubtful in the files of robots.
    pub fn of_request(what: &str, sources: &Sources) -> Self {
        let program = Self::of_this_program().map(Self::bytes).unwrap_or_default();
        let files = (0..sources.count()).map(|number| sources.file(number)).flat_map(|file| {
            let (kind, text) = match &file.text {
                Ok(text) => ("text", text),
                Err(unreadable) => ("unreadable", &unreadable.reason),
            };
            [file.name.as_bytes(), kind.as_bytes(), text.as_bytes()]
        });
        // Where something stands in the file of a robot its text, which has been written anew, does not tell.
        let warnings = (0..sources.count()).flat_map(|number| &sources.file(number).warnings);
        let warnings = warnings.flat_map(|warning| [warning.message.as_bytes(), warning.help.as_bytes()]);
        Self::of([&program[..], what.as_bytes()].into_iter().chain(files).chain(warnings))
    }

    /// The digest itself.
    pub fn bytes(self) -> [u8; 16] {
        self.0.to_be_bytes()
    }
}

/// A part and its length, behind those that came before.
fn absorbed(state: u128, part: &[u8]) -> u128 {
    let (blocks, rest) = part.as_chunks::<16>();
    let state =
        blocks.iter().fold(mixed(state, part.len() as u128), |state, block| mixed(state, u128::from_le_bytes(*block)));
    let mut last = [0; 16];
    last[..rest.len()].copy_from_slice(rest);
    mixed(state, u128::from_le_bytes(last))
}

/// The product of both halves, to 128 bits, with the halves exchanged: after wyhash (Wang Yi, 2019), without a loss of
/// what is multiplied by zero.
#[inline(always)]
fn mixed(state: u128, block: u128) -> u128 {
    const OFFSET: u128 = 0xa076_1d64_78bd_642f_e703_7ed1_a0b4_28db;
    let block = state ^ block;
    let [high, low] = [((block ^ OFFSET) >> 64) as u64, (block ^ OFFSET) as u64];
    (u128::from(high) * u128::from(low)) ^ block.rotate_left(64)
}

/// In 32 hexadecimal digits.
impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bit changed anywhere, or a byte moved, changes both halves.
    #[test]
    fn both_halves_depend_on_every_bit() {
        let text: Vec<u8> = (0..67_u8).map(|i| i.wrapping_mul(37)).collect();
        let of = |bytes: &[u8]| Digest::of([bytes]).0;
        let mut seen = vec![of(&text)];
        for bit in 0..8 * text.len() {
            let mut changed = text.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            seen.push(of(&changed));
        }
        seen.extend((0..text.len()).map(|length| of(&text[..length])));
        for half in [|x: u128| x as u64, |x: u128| (x >> 64) as u64] {
            let mut halves: Vec<u64> = seen.iter().map(|&digest| half(digest)).collect();
            halves.sort_unstable();
            halves.dedup();
            assert_eq!(halves.len(), seen.len());
        }
    }

    #[test]
    fn requests_tell_texts_names_and_wishes_apart() {
        let of = |what, name, text| Digest::of_request(what, &Sources::new(name, text));
        let all = [of("a", "b", "c"), of("ab", "", "c"), of("a", "bc", ""), of("", "ab", "c"), of("a", "b", "c ")];
        for (i, digest) in all.iter().enumerate() {
            assert!(!all[..i].contains(digest), "{i}");
        }
        let imported = |text: &'static [u8]| {
            let main = "import \"x.mbs\"; mechanism M { }";
            Digest::of_request("a", &Sources::gather("m.mbs", main, |_| Ok(text.to_vec())))
        };
        assert!(imported(b"const a = 1;") != imported(b"const a = 2;"));
        assert!(imported(b"const a = 1;") == imported(b"const a = 1;"));
        let doubtful = |message: &str| {
            let read = |_: &str| {
                let warning = crate::source::Warning { message: message.into(), help: String::new() };
                Ok((b"mechanism M { }".to_vec(), vec![warning]))
            };
            Digest::of_request("a", &Sources::followed("m.mbs", "", |_| vec!["r.urdf".into()], read))
        };
        assert!(doubtful("r.urdf:3:1: a") != doubtful("r.urdf:6:1: a"));
        assert!(Digest::of_this_program().is_some());
    }

    #[test]
    fn every_byte_of_a_file_counts() {
        let of = |bytes: &[u8]| Digest::of_reader(bytes).expect("it can be read");
        let mut bytes = vec![7; (1 << 18) + 5];
        let all = of(&bytes);
        assert_eq!(all, of(&bytes));
        for changed in [0, (1 << 18) - 1, 1 << 18, (1 << 18) + 4] {
            bytes[changed] ^= 1;
            assert_ne!(all, of(&bytes), "{changed}");
            bytes[changed] ^= 1;
        }
        assert_ne!(all, of(&bytes[..1 << 18]));
    }
}
