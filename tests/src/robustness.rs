//! Random models, most of them wrong, and what must hold of every text whatever it says.
//!
//! - [`mutation`]: the good models of the repository, damaged token by token;
//! - [`robot`]: robots of other formats, damaged;
//! - [`model`]: models written from the grammar, of which most are right;
//! - [`seeded`]: bytes of all that is read, damaged from a seed;
//! - [`examine`]: the whole generator run on a text;
//! - [`target`]: what is done with bytes of any kind, by tests and by the fuzz targets of `fuzz/`; `state`: the reader
//!   of state files of the program.

pub mod examine;
pub mod model;
pub mod mutation;
pub mod robot;
pub mod seeded;
mod state;
pub mod target;

use std::collections::BTreeMap;
use std::path::Path;

use mbs_derive::source::Unreadable;

/// Good models of the repository: files of mechanisms, and the examples of the manual.
#[derive(Clone, Debug)]
pub struct Models {
    /// Name and text of each mechanism.
    pub mechanisms: Vec<(String, String)>,
    /// What they import.
    pub shared: BTreeMap<String, String>,
}

impl Models {
    /// Reads them all, in order of their names.
    pub fn read() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut models = Models { mechanisms: Vec::new(), shared: BTreeMap::new() };
        for folder in ["models/mechanisms", "tests/mechanisms"] {
            models.mechanisms.extend(files(&root.join(folder)));
        }
        for (name, text) in files(&root.join("models/mechanisms/tables")) {
            models.shared.insert(format!("tables/{name}"), text);
        }
        let manual = std::fs::read_to_string(root.join("docs/language.md")).expect("the manual");
        for (title, text) in fenced(&manual) {
            match title {
                "" => models.mechanisms.push((format!("manual{}.mbs", models.mechanisms.len()), text)),
                name => {
                    models.shared.insert(name.to_string(), text);
                }
            }
        }
        models
    }

    /// What a file imports is looked for among the tables and in the manual.
    ///
    /// # Errors
    /// That there is no such block.
    pub fn import(&self, name: &str) -> Result<Vec<u8>, Unreadable> {
        let text = self.shared.get(name).map(|text| text.clone().into_bytes());
        text.ok_or_else(|| Unreadable::new("there is no such file", "look for it"))
    }
}

fn files(folder: &Path) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).expect("a folder of mechanisms");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "mbs"));
    paths.sort();
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), std::fs::read_to_string(path).expect("a mechanism"))).collect()
}

/// The blocks fenced as `mbs`, with what the fence says behind it.
fn fenced(manual: &str) -> Vec<(&str, String)> {
    let blocks = manual.split("\n```mbs").skip(1).filter_map(|rest| rest.split_once("\n```"));
    blocks
        .filter_map(|(block, _)| block.split_once('\n'))
        .map(|(title, text)| (title.trim(), format!("{text}\n")))
        .collect()
}
