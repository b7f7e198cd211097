//! How much work a mechanism is: counted, not timed, so that a machine that is busy says the same.

use std::path::{Path, PathBuf};

use mbs_derive::Analysis;
use mbs_derive::expr::Graph;

/// Nodes of expressions that are made, and instructions of the proof: of the order of a microsecond each, on a laptop
/// of 2020, in a release build.
#[derive(Debug)]
struct Work {
    nodes: usize,
    proof: usize,
}

impl Work {
    /// Of a file that declares no mechanism: as far as its mistakes allow.
    fn of(file: &Path) -> Work {
        let graph = Graph::verbatim();
        let Ok(sources) = mbs_derive::read(file) else { return Work { nodes: 0, proof: 0 } };
        let Ok(analysis) = Analysis::of(&sources, &graph) else { return Work { nodes: graph.len(), proof: 0 } };
        let instructions: usize = analysis.programs().functions.iter().map(|f| f.program.instructions.len()).sum();
        let states = analysis.prove(analysis.programs()).map_or(0, |proof| proof.states);
        Work { nodes: analysis.nodes(), proof: instructions * states }
    }
}

/// Every `.mbs` file of the repository.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = ["models", "tests", "examples", "mbs-cli", "mbs-derive", "mbs-runtime"];
    let (mut found, mut folders) = (Vec::new(), folders.map(|folder| root.join(folder)).to_vec());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            match entry.extension().and_then(|extension| extension.to_str()) {
                _ if entry.is_dir() && !entry.ends_with("target") => folders.push(entry),
                Some("mbs") => found.push(entry),
                _ => {}
            }
        }
    }
    found
}

/// A tenth more than the largest of today but one: half a second of a laptop's time.
const LIMIT: Work = Work { nodes: 83_000, proof: 2_070_000 };
/// Two bodies of seven coordinates each that push on each other through a ring, three times as much to prove; and turns
/// of a loop up to the limit of the language.
const LARGEST: [(&str, Work); 2] = [
    ("docking_bodies.mbs", Work { nodes: 83_000, proof: 6_200_000 }),
    ("loop_without_end.mbs", Work { nodes: 210_000, proof: 0 }),
];

/// Wrong mechanisms too are answered in time.
#[test]
fn no_mechanism_is_more_work_than_it_was() {
    let files = files();
    assert!(files.len() > 150, "{} mechanisms", files.len());
    for file in files {
        let work = Work::of(&file);
        let limit = LARGEST.iter().find(|(name, _)| file.ends_with(name)).map_or(&LIMIT, |(_, limit)| limit);
        assert!(work.nodes <= limit.nodes && work.proof <= limit.proof, "{}: {work:?}", file.display());
    }
}
