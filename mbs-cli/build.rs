//! A digest of what the generator is built from: `MBS_GENERATOR`, by which `src/cache.rs` knows derivations of other
//! versions.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

use sha2::{Digest, Sha256};

/// From this crate's folder. What mbs-derive is made of decides on derivations, the rest on how they are kept.
const SOURCES: [&str; 6] =
    ["../mbs-derive/src", "../mbs-derive/Cargo.toml", "../Cargo.lock", "src", "Cargo.toml", "build.rs"];

fn main() {
    SOURCES.iter().for_each(|path| println!("cargo::rerun-if-changed={path}"));
    // Without all of the sources nothing is known about the generator, and nothing is kept.
    println!("cargo::rustc-env=MBS_GENERATOR={}", digest().unwrap_or_default());
}

fn digest() -> io::Result<String> {
    let mut files = Vec::new();
    SOURCES.iter().try_for_each(|path| find(Path::new(path), &mut files))?;
    let mut digest = Sha256::new();
    let mut add = |bytes: &[u8]| {
        digest.update(bytes.len().to_le_bytes());
        digest.update(bytes);
    };
    for file in files {
        add(file.to_string_lossy().as_bytes());
        add(&fs::read(&file)?);
    }
    let compiler = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    add(&Command::new(compiler).arg("-vV").output()?.stdout);
    add(env::var("TARGET").unwrap_or_default().as_bytes());
    Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// All files of a folder and of those in it, sorted, or the file itself.
fn find(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if !path.is_dir() {
        files.push(path.to_path_buf());
        return Ok(());
    }
    let mut entries = fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    entries.sort();
    entries.iter().try_for_each(|entry| find(entry, files))
}
