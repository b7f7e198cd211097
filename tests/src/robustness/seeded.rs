//! Bytes of everything that is read, damaged from a seed, without a fuzzer: bits flipped, lines deleted, two texts
//! spliced, tokens exchanged, huge numbers, brackets nested deeply. The same on every machine.

use std::path::Path;

use super::Models;
use super::mutation::tokens;
use super::robot::ROBOTS;
use crate::random::Random;

/// Good bytes for a target, by its name: the models of the repository, right and wrong, robots, tables and states.
///
/// # Panics
/// If there is no such target, or no such folder.
pub fn corpus(target: &str) -> Vec<Vec<u8>> {
    match target {
        "parser" | "front_end" | "pipeline" => models(),
        "state" => states(),
        "import" => imported(),
        other => panic!("no target {other}"),
    }
}

fn models() -> Vec<Vec<u8>> {
    let good = Models::read().mechanisms.into_iter().map(|(_, text)| text.into_bytes());
    let entries = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/bad")).expect("tests/bad");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let wrong = paths.iter().filter(|path| path.is_file()).map(|path| std::fs::read(path).expect("a file"));
    good.chain(wrong).filter(|bytes| !bytes.is_empty()).collect()
}

/// States of the mechanisms of [`STATES_OF`](super::target::STATES_OF), behind a byte that says of which.
fn states() -> Vec<Vec<u8>> {
    let states = [
        r#"{"t": 0, "q": [0.1], "qd": [0.2], "qdd": [0], "u": [1.5], "params": {"m": 2.0, "k": [1, 1]}}"#,
        r#"{"x": "20 mm", "x_dot": 1, "x_ddot": -1e-3, "f": "2 kN", "params": {"k_0": "3 N/mm"}}"#,
        r#"[{"q": {"x": 0.3}}, {"q": ["-1 m"], "t": "3 ms"}]"#,
        r#"{"q": [0.1, "20 deg"], "params": {"l": 0.5, "r": [[1, 2], [3, 4]]}, "prescribed": {"lift": [1, 2, 3]}}"#,
        r#"{"q_0": 1, "q_1_dot": 2, "prescribed": {"lift": [0, "1 mm/s", 0], "swing": [0, 0, 0]}}"#,
        r#"{"q": [1, 2, 3], "qd": {"x": 1, "angle": NaN}, "u": [1, Infinity]}"#,
        r#"{"x": 1, "angle": "3 rad", "v_dot": 2, "v_dot_dot": 5, "u": [0, 1]}"#,
    ];
    let of = |k: usize| [0, 0, 0, 1, 1, 2, 2][k] as u8;
    states.iter().enumerate().map(|(k, state)| [&[of(k)], state.as_bytes()].concat()).collect()
}

/// Robots and tables, behind a byte that says which, and with which options.
fn imported() -> Vec<Vec<u8>> {
    let kind = |file: &str| if file.ends_with(".urdf") { 0 } else { 1 + u8::from(file.ends_with(".xml")) };
    let robots = ROBOTS.iter().enumerate();
    let robots = robots.map(|(k, (file, xml))| [&[kind(file) + 4 * k as u8], xml.as_bytes()].concat());
    let tables = [
        "# Measured.\nstretch [mm], pull [N]\n-40, -90\n-15, -20\n0, 0\n15, 20\n40, 90\n",
        "pull,stretch\r\n+1,0\r\n.5,1e3\n",
    ];
    robots.chain(tables.map(|table| [&[3], table.as_bytes()].concat())).collect()
}

/// One of the corpus, with one to four changes.
pub fn damaged(random: &mut Random, corpus: &[Vec<u8>]) -> Vec<u8> {
    let count = 1 + below(random, 4);
    (0..count).fold(corpus[below(random, corpus.len())].clone(), |bytes, _| changed(random, bytes, corpus))
}

fn below(random: &mut Random, n: usize) -> usize {
    (random.bits() % n.max(1) as u64) as usize
}

fn changed(random: &mut Random, mut bytes: Vec<u8>, corpus: &[Vec<u8>]) -> Vec<u8> {
    match below(random, 12) {
        0 => {
            let at = below(random, bytes.len());
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << below(random, 8);
            }
            bytes
        }
        1 | 2 => {
            let at = below(random, lines(&bytes).len());
            lines(&bytes)
                .into_iter()
                .enumerate()
                .filter(|(k, _)| *k != at)
                .flat_map(|(_, line)| line.to_vec())
                .collect()
        }
        3 => {
            let other = &corpus[below(random, corpus.len())];
            let (here, there) = (below(random, bytes.len()), below(random, other.len()));
            [&bytes[..here], &other[there..]].concat()
        }
        4 => {
            let others = lines(&corpus[below(random, corpus.len())]);
            let (line, at) = (others[below(random, others.len())], below(random, lines(&bytes).len()));
            let mut all = lines(&bytes);
            all.insert(at, line);
            all.concat()
        }
        _ => match String::from_utf8(bytes) {
            Ok(text) => rewritten(random, &text).into_bytes(),
            Err(error) => error.into_bytes(),
        },
    }
}

fn lines(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.split_inclusive(|&byte| byte == b'\n').collect()
}

fn rewritten(random: &mut Random, text: &str) -> String {
    let mut parts = tokens(text);
    let numbers: Vec<usize> =
        (0..parts.len()).filter(|&k| parts[k].starts_with(|c: char| c.is_ascii_digit())).collect();
    let solid: Vec<usize> = (0..parts.len()).filter(|&k| !parts[k].trim().is_empty()).collect();
    if solid.is_empty() {
        return text.to_string();
    }
    let at = solid[below(random, solid.len())];
    let nested;
    match below(random, 8) {
        0..3 => parts.swap(at, solid[below(random, solid.len())]),
        3 => parts[at] = parts[solid[below(random, solid.len())]],
        4 | 5 if !numbers.is_empty() => parts[numbers[below(random, numbers.len())]] = HUGE[below(random, HUGE.len())],
        6 => {
            let (open, close) = [("(", ")"), ("[", "]"), ("{", "}"), ("-(", ")"), ("sin(", ")"), ("<link>", "</link>")]
                [below(random, 6)];
            let depth = [3, 40, 1000, 20_000][below(random, 4)];
            nested = format!(
                "{}{}{}",
                open.repeat(depth),
                parts[at],
                close.repeat(if random.one_in(4) { 0 } else { depth })
            );
            parts[at] = &nested;
        }
        _ => drop(parts.remove(at)),
    }
    parts.concat()
}

/// Numbers that overflow something, vanish, or are NaN.
const HUGE: [&str; 16] = [
    "1e308",
    "1e309",
    "-1e308",
    "9e999999999999",
    "1e-400",
    "4294967296",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "1000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000",
    "0",
    "-0",
    "NaN",
    "Infinity",
    "0.1e-5",
    "1.2.3",
    "99999",
];
