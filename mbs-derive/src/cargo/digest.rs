//! Digests, by which what was made earlier is known to be what would be made now.

use std::fmt;
use std::hash::{DefaultHasher, Hasher};
use std::sync::OnceLock;

use crate::source::Sources;

/// 128 bits, twice the hash of the standard library. Not against forgery, and the same only between runs of one
/// program, which [`of_request`](Self::of_request) makes part of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u128);

impl Digest {
    /// Of several parts, with their lengths, so that none can be taken for another.
    pub fn of<'p>(parts: impl IntoIterator<Item = &'p [u8]>) -> Self {
        let mut halves = [DefaultHasher::new(), DefaultHasher::new()];
        halves[1].write_u8(1);
        for part in parts {
            for half in &mut halves {
                half.write_usize(part.len());
                half.write(part);
            }
        }
        let [high, low] = halves.map(|half| u128::from(half.finish()));
        Digest(high << 64 | low)
    }

    /// Of the program that runs, with the generator and all else that is linked into it; `None` where it cannot be
    /// read.
    pub fn of_this_program() -> Option<Self> {
        static PROGRAM: OnceLock<Option<Digest>> = OnceLock::new();
        let read = || std::fs::read(std::env::current_exe().ok()?).ok();
        *PROGRAM.get_or_init(|| read().map(|bytes| Digest::of([&bytes[..]])))
    }

    /// Of all that decides on what this program makes of a mechanism: itself, what is asked for, and the texts of the
    /// mechanism and of what it imports, as they are called in reports.
    pub fn of_request(what: &str, sources: &Sources) -> Self {
        let program = Self::of_this_program().map(Self::bytes).unwrap_or_default();
        let files = (0..sources.count()).map(|number| sources.file(number)).flat_map(|file| {
            let (kind, text) = match &file.text {
                Ok(text) => ("text", text),
                Err(unreadable) => ("unreadable", &unreadable.reason),
            };
            [file.name.as_bytes(), kind.as_bytes(), text.as_bytes()]
        });
        Self::of([&program[..], what.as_bytes()].into_iter().chain(files))
    }

    /// The digest itself.
    pub fn bytes(self) -> [u8; 16] {
        self.0.to_be_bytes()
    }
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
        assert!(Digest::of_this_program().is_some());
    }
}
