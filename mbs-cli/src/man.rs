//! `mbs man`: manual pages.

use std::fs;
use std::path::{Path, PathBuf};

use clap_mangen::Man;
use serde_json::json;

use crate::failure::Failure;
use crate::files::Files;
use crate::output::{self, Staged};

/// Write the manual pages, one for the program and one for each command; without --out, print that of the program.
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  mbs man --out man/man1

Then `man -M man mbs-simulate` shows one of them.")]
pub(crate) struct Arguments {
    /// The folder to write them to, made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Writes `mbs.1`, `mbs-check.1` and the others.
pub(crate) fn run(arguments: &Arguments, mut command: clap::Command) -> Result<(), Failure> {
    command.build();
    let cannot = |error: &dyn std::fmt::Display| Failure::new(format_args!("cannot write the manual: {error}"));
    let Some(folder) = &arguments.out else {
        let page = rendered(command).map_err(|error| cannot(&error))?;
        return output::answer(|| json!({ "page": page }), || page.clone());
    };
    fs::create_dir_all(folder)
        .map_err(|error| Failure::new(format_args!("cannot make the folder {}: {error}", folder.display())))?;
    let mut pages = vec![("mbs.1".to_string(), rendered(command.clone()).map_err(|error| cannot(&error))?)];
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        let name = format!("mbs-{}", sub.get_name());
        pages.push((format!("{name}.1"), rendered(sub.clone()).map_err(|error| cannot(&error))?));
    }
    let mut files = Files::default();
    let mut staged = Vec::new();
    let paths: Vec<PathBuf> = pages.iter().map(|(name, _)| folder.join(name)).collect();
    for (path, (_, page)) in paths.iter().zip(&pages) {
        files.writes("--out", path)?;
        staged.push(Staged::new(path, page.as_bytes())?);
    }
    staged.into_iter().try_for_each(Staged::commit)?;
    output::wrote(&paths.iter().map(PathBuf::as_path).collect::<Vec<&Path>>())
}

fn rendered(command: clap::Command) -> std::io::Result<String> {
    let mut page = Vec::new();
    // Without a date, so that the same program writes the same bytes.
    Man::new(command).date("").render(&mut page)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
