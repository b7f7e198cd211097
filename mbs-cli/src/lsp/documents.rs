//! The files that are open in the editor, whose texts count before those on the disk.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use lsp_types::Uri;
use mbs_derive::source::{Sources, Unreadable};

use super::text::Text;

/// A larger file is no mechanism.
const MAX_BYTES: u64 = 1 << 26;

/// How many files of the user's folders are looked at for uses of a name.
const MAX_FILES: usize = 2000;

#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) uri: Uri,
    pub(super) text: Text,
    pub(super) version: i32,
}

/// Open files by their names, which are paths where they are files.
#[derive(Clone, Debug, Default)]
pub(super) struct Documents {
    open: BTreeMap<String, Document>,
    /// The folders that are open in the editor.
    pub(super) folders: Vec<PathBuf>,
}

impl Documents {
    pub(super) fn insert(&mut self, document: Document) -> String {
        let name = name_of(&document.uri);
        self.open.insert(name.clone(), document);
        name
    }

    pub(super) fn remove(&mut self, name: &str) {
        self.open.remove(name);
    }

    pub(super) fn get(&self, name: &str) -> Option<&Document> {
        self.open.get(name)
    }

    pub(super) fn get_mut(&mut self, name: &str) -> Option<&mut Document> {
        self.open.get_mut(name)
    }

    /// The names of all open files.
    pub(super) fn names(&self) -> Vec<String> {
        self.open.keys().cloned().collect()
    }

    pub(super) fn uri(&self, name: &str) -> Option<Uri> {
        self.open.get(name).map(|document| document.uri.clone()).or_else(|| uri_of(name))
    }

    /// A file with all that it imports.
    pub(super) fn sources(&self, name: &str) -> Option<Sources> {
        let text = match self.open.get(name) {
            Some(document) => document.text.text.clone(),
            None => String::from_utf8(self.read(name).ok()?).ok()?,
        };
        Some(Sources::gather(name, &text, |name| self.read(name)))
    }

    fn read(&self, name: &str) -> Result<Vec<u8>, Unreadable> {
        if let Some(document) = self.open.get(name) {
            return Ok(document.text.text.clone().into_bytes());
        }
        let refused = |reason: String| {
            Unreadable::new(reason, "check its name: an import is seen from the file that it stands in")
        };
        let path = Path::new(name);
        // To open a pipe would wait for its other end.
        match fs::metadata(path) {
            Ok(there) if there.is_file() && there.len() <= MAX_BYTES => {}
            Ok(_) => return Err(refused("it is no file of text".to_string())),
            Err(error) => return Err(refused(error.to_string())),
        }
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(MAX_BYTES).read_to_end(&mut bytes));
        read.map(|_| bytes).map_err(|error| refused(error.to_string()))
    }

    /// The names of open files, and of mechanisms in the open folders.
    pub(super) fn all(&self) -> Vec<String> {
        let mut found = self.names();
        let (mut folders, mut seen) = (self.folders.clone(), 0);
        while let Some(folder) = folders.pop() {
            let Ok(entries) = fs::read_dir(folder) else { continue };
            let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
            paths.sort();
            for path in paths {
                seen += 1;
                let hidden = path.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
                if hidden || seen > 50 * MAX_FILES || found.len() > MAX_FILES || path.is_symlink() {
                    continue;
                }
                if path.is_dir() && !path.ends_with("target") && !path.ends_with("node_modules") {
                    folders.push(path);
                } else if path.extension().is_some_and(|extension| extension == "mbs") {
                    let name = path.to_string_lossy().into_owned();
                    if !found.contains(&name) {
                        found.push(name);
                    }
                }
            }
        }
        found
    }
}

/// The path of `file://…`, any other address as it is.
pub(super) fn name_of(uri: &Uri) -> String {
    let text = uri.as_str();
    let Some(path) = text.strip_prefix("file://") else { return text.to_string() };
    // `file://host/…` is not of this machine; `file:///c%3A/…` is a path of Windows.
    let path = decoded(&path[path.find('/').unwrap_or(0)..]);
    let mut letters = path.chars().skip(1);
    match (letters.next(), letters.next()) {
        (Some(drive), Some(':')) if drive.is_ascii_alphabetic() => path[1..].to_string(),
        _ => path,
    }
}

/// The address of a path.
fn uri_of(name: &str) -> Option<Uri> {
    let name = name.replace('\\', "/");
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
    let encoded: String =
        name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect();
    let slash = if encoded.starts_with('/') { "" } else { "/" };
    format!("file://{slash}{encoded}").parse().ok()
}

/// `%20` as the byte that it stands for; what is no text as it was.
fn decoded(text: &str) -> String {
    let (mut bytes, mut rest) = (Vec::new(), text.as_bytes());
    while let [first, behind @ ..] = rest {
        let code = behind.get(..2).filter(|_| *first == b'%').and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &behind[2..];
            }
            None => {
                bytes.push(*first);
                rest = behind;
            }
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_paths_and_back() {
        let check = |uri: &str, name: &str| assert_eq!(name_of(&uri.parse().unwrap()), name, "{uri}");
        check("file:///a/b%20c/%CE%B8.mbs", "/a/b c/θ.mbs");
        check("file:///c%3A/a.mbs", "c:/a.mbs");
        check("file://localhost/a.mbs", "/a.mbs");
        check("untitled:Untitled-1", "untitled:Untitled-1");
        // No address, but it may stand in one that was not read as one.
        assert_eq!(decoded("/a%zz%f"), "/a%zz%f");
        for name in ["/a/b c/θ.mbs", "/x+y&z?.mbs", "/100%/a.mbs"] {
            assert_eq!(name_of(&uri_of(name).unwrap()), name);
        }
    }
}
