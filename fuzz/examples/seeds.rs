//! `cargo run --example seeds`: the good and the wrong models of the repository, robots, tables and states, each a file
//! in `corpus/TARGET/`, and what the language has of words, in `dictionaries/`. Neither is kept in the repository.

use std::fs;
use std::io;
use std::path::Path;

use mbs_derive::source::Sources;
use mbs_fuzz::robustness::{robot, seeded, target::TARGETS};

fn main() -> io::Result<()> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, _) in TARGETS {
        let folder = here.join("corpus").join(name);
        fs::create_dir_all(&folder)?;
        let corpus = seeded::corpus(name);
        for (number, bytes) in corpus.iter().enumerate() {
            fs::write(folder.join(format!("seed{number:03}")), bytes)?;
        }
        println!("{name}: {} seeds", corpus.len());
    }
    let folder = here.join("dictionaries");
    fs::create_dir_all(&folder)?;
    let words = Sources::words().into_iter().map(|(_, word, _)| word);
    fs::write(folder.join("language"), dictionary(words.chain(robot::words())))?;
    let keys =
        ["\"q\"", "\"qd\"", "\"qdd\"", "\"u\"", "\"t\"", "\"params\"", "\"prescribed\"", "NaN", "-Infinity", "1e400"];
    fs::write(folder.join("state"), dictionary(keys.map(String::from).into_iter()))
}

/// As libFuzzer reads it, sorted.
fn dictionary(words: impl Iterator<Item = String>) -> String {
    let escaped = |word: String| {
        let bytes = word.bytes().map(|byte| match byte {
            b'"' | b'\\' => format!("\\{}", byte as char),
            b' '..=b'~' => (byte as char).to_string(),
            byte => format!("\\x{byte:02X}"),
        });
        format!("\"{}\"\n", bytes.collect::<String>())
    };
    let mut lines: Vec<String> = words.filter(|word| !word.is_empty()).map(escaped).collect();
    lines.sort();
    lines.dedup();
    lines.concat()
}
