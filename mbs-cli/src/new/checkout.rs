//! Where a checkout of mbs is, and what a crate writes to depend on it.

use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::failure::Failure;

/// A folder with `mbs-derive/` and `mbs-runtime/`.
pub(super) struct Checkout {
    root: PathBuf,
}

impl Checkout {
    /// The one that the user names.
    pub(super) fn given(path: &Path) -> Result<Self, Failure> {
        match is_checkout(path) {
            true => Ok(Checkout { root: path.to_path_buf() }),
            false => Err(Failure::new(format_args!(
                "--path: {} is no checkout of mbs {}: it has no mbs-derive and mbs-runtime of this version",
                path.display(),
                env!("CARGO_PKG_VERSION")
            ))),
        }
    }

    /// The one that the current folder lies in, or this program: what `cargo run` in a checkout has built.
    ///
    /// # Errors
    /// There is none. Nothing is taken from a registry, where others may have these names.
    pub(super) fn found() -> Result<Self, Failure> {
        let program = std::env::current_exe().ok().and_then(|program| program.canonicalize().ok());
        let folder = std::env::current_dir().ok();
        let above = [folder, program].into_iter().flatten();
        above
            .flat_map(|place| place.ancestors().map(Path::to_path_buf).collect::<Vec<_>>())
            .find_map(|root| is_checkout(&root).then_some(Checkout { root }))
            .ok_or_else(|| {
                Failure::new("the crate depends on a checkout of mbs, and there is none around: name it by --path DIR")
            })
    }

    pub(super) fn root(&self) -> &Path {
        &self.root
    }
}

/// Whether both crates are there, in the version of this program.
fn is_checkout(root: &Path) -> bool {
    let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
    let read = |file: PathBuf| fs::read_to_string(file).unwrap_or_default();
    let workspace = read(root.join("Cargo.toml"));
    ["mbs-derive", "mbs-runtime"].iter().all(|package| {
        let manifest = read(root.join(package).join("Cargo.toml"));
        let is_named = manifest.lines().any(|line| line == format!("name = \"{package}\""));
        // Of the workspace, or its own.
        let is_current = manifest.lines().any(|line| line == version) || workspace.lines().any(|line| line == version);
        is_named && is_current
    })
}

/// A line of a manifest: the package in the checkout, seen from the folder of the crate.
pub(super) fn dependency(checkout: &Checkout, folder: &Path, package: &str) -> String {
    let path = seen_from(folder, &checkout.root.join(package));
    // A string of TOML without escapes, where the path allows it.
    let path = path.to_string_lossy().replace('\\', "/");
    let quoted = if path.contains('\'') { format!("{path:?}") } else { format!("'{path}'") };
    let quoted = if path.contains(['\'', '"']) { quoted } else { format!("\"{path}\"") };
    format!("{package} = {{ path = {quoted} }}\n")
}

/// Relative where the crate lies within the checkout or beside it, so that both can be moved together; else absolute.
fn seen_from(folder: &Path, target: &Path) -> PathBuf {
    let absolute = |path: &Path| {
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        // The new folder is not there yet, its parent may be a link.
        let existing = whole.ancestors().find_map(|above| Some((above, above.canonicalize().ok()?)));
        let whole = match existing {
            Some((above, real)) => real.join(whole.strip_prefix(above).unwrap_or(Path::new(""))),
            None => whole.clone(),
        };
        without_dots(&whole)
    };
    let (from, to) = (absolute(folder), absolute(target));
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().count() - common;
    let is_near = to
        .parent()
        .and_then(Path::parent)
        .is_some_and(|around| around.components().count() > 1 && from.starts_with(around));
    if !is_near {
        return to;
    }
    let ups = std::iter::repeat_n(Component::ParentDir, up);
    ups.chain(to.components().skip(common)).collect()
}

fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(plain.pop()),
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_near_the_checkout() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let checkout = root.join("src/mbs");
        fs::create_dir_all(&checkout).unwrap();
        let check = |from: &str, expected: &str| {
            let found = seen_from(&root.join(from), &checkout.join("mbs-derive"));
            assert_eq!(found, Path::new(expected), "{from}");
        };
        check("src/pendulum", "../mbs/mbs-derive");
        check("src/mbs/pendulum", "../mbs-derive");
        check("src/robots/arm", "../../mbs/mbs-derive");
        assert_eq!(seen_from(&root.join("elsewhere/arm"), &checkout.join("mbs-derive")), checkout.join("mbs-derive"));
    }

    #[test]
    fn a_folder_is_a_checkout_by_its_manifests() {
        let folder = tempfile::tempdir().unwrap();
        let write = |file: &str, text: &str| {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        assert!(Checkout::given(folder.path()).is_err());
        write("mbs-derive/Cargo.toml", "[package]\nname = \"mbs-derive\"\nversion.workspace = true\n");
        write("mbs-runtime/Cargo.toml", "[package]\nname = \"mbs-runtime\"\nversion.workspace = true\n");
        write("Cargo.toml", "[workspace.package]\nversion = \"99.0.0\"\n");
        assert!(Checkout::given(folder.path()).is_err());
        write("Cargo.toml", &format!("[workspace.package]\nversion = \"{}\"\n", env!("CARGO_PKG_VERSION")));
        let checkout = Checkout::given(folder.path()).unwrap();
        let line = dependency(&checkout, &folder.path().join("arm"), "mbs-derive");
        assert_eq!(line, "mbs-derive = { path = \"../mbs-derive\" }\n");
    }
}
