//! `mbs new`: a crate of one's own around a mechanism, which builds, runs and passes its test.
//!
//! - [`name`]: names that a crate can have;
//! - [`checkout`]: where mbs is;
//! - [`template`]: what stands in the files.

mod checkout;
mod name;
mod template;

use std::fmt::Display;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use mbs_derive::expr::Graph;
use mbs_derive::source::Sources;
use mbs_derive::{Analysis, Error};
use serde_json::json;

use crate::failure::Failure;
use crate::message::Messages;
use crate::output;
use checkout::Checkout;
use template::Template;

/// Make a crate around a mechanism: its energies, a build script, a program that moves it, a test.
///
/// The program writes a table and a moving picture. The crate depends on mbs-derive and mbs-runtime: of the checkout
/// given by `--path`, else of one that the current folder or this program lies in.
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  mbs new pendulum
  mbs new robots/picker --template arm

Then `cd pendulum`, `cargo run --release`, and open motion.svg in a browser.")]
pub(crate) struct Arguments {
    /// Folder of the crate, which bears its name; there is none yet, or an empty one.
    #[arg(value_name = "NAME")]
    folder: PathBuf,
    /// What the mechanism is.
    #[arg(long, value_enum, default_value_t = Template::Pendulum)]
    template: Template,
    /// A checkout of mbs, which the crate shall depend on.
    #[arg(long, value_name = "DIR")]
    path: Option<PathBuf>,
}

/// Writes the crate whole, or nothing.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = name::of(&arguments.folder)?;
    let is_there = is_empty_folder(&arguments.folder)?;
    let checkout = match &arguments.path {
        Some(path) => Checkout::given(path)?,
        None => Checkout::found()?,
    };
    let template = arguments.template;
    let dependencies = |package: &str| checkout::dependency(&checkout, &arguments.folder, package);
    let mut files = template.files(&name, dependencies);
    files.push(snapshot(template)?);
    place(&arguments.folder, is_there, &files)?;
    let from = format!("mbs of {}", checkout.root().display());
    let folder = arguments.folder.display();
    output::answer(
        || {
            let names: Vec<&str> = files.iter().map(|(file, _)| file.as_str()).collect();
            json!({ "crate": name, "folder": folder.to_string(), "template": template.name(), "files": names, "uses": from })
        },
        || {
            format!(
                "{folder}: the crate `{name}` around mechanisms/{mechanism}.mbs, with {from}\n\
                 next: cd {folder}; cargo run --release; then open motion.svg in a browser\n",
                mechanism = template.name(),
            )
        },
    )
}

/// The test's snapshot, as the test finds it.
fn snapshot(template: Template) -> Result<(String, String), Failure> {
    let mechanism = template.name();
    let file = format!("mechanisms/{mechanism}.mbs");
    let sources = Sources::gather(&file, template.mechanism(), |name| {
        template.beside(name).map(|text| text.as_bytes().to_vec()).ok_or_else(|| {
            mbs_derive::source::Unreadable::new(format!("there is no file `{name}`"), "it is one of the template's")
        })
    });
    let graph = Graph::verbatim();
    let refused = |error: Error| Failure::from(Messages::of_error(&error, &sources));
    let analysis = Analysis::of(&sources, &graph).map_err(refused)?;
    analysis.prove(analysis.programs()).map_err(refused)?;
    let review = analysis.programs().review(sources.portable_name());
    let expression = format!("mbs_derive::review(\"{file}\").unwrap()");
    let text = format!("---\nsource: tests/review.rs\nexpression: {expression:?}\n---\n{review}");
    Ok((format!("tests/snapshots/review__{mechanism}.snap"), text))
}

/// Whether there is an empty folder; it is a failure if there is anything else.
fn is_empty_folder(folder: &Path) -> Result<bool, Failure> {
    match fs::symlink_metadata(folder) {
        Ok(there) if !there.is_dir() => Err(cannot(folder, "there is a file of this name")),
        Ok(_) if fs::read_dir(folder).map_err(|error| cannot(folder, error))?.next().is_some() => {
            Err(cannot(folder, "the folder is not empty"))
        }
        Ok(_) => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(cannot(folder, error)),
    }
}

fn cannot(folder: &Path, why: impl Display) -> Failure {
    Failure::new(format_args!("cannot make {}: {why}", folder.display()))
}

/// Writes all files into a folder beside, which then takes the name: there is never half a crate.
fn place(folder: &Path, is_there: bool, files: &[(String, String)]) -> Result<(), Failure> {
    let cannot = |error: std::io::Error| cannot(folder, error);
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(cannot)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mbs-").suffix(".tmp");
    // As any new folder, under the user's mask; temporary ones are closed to others by default.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    let beside = builder.tempdir_in(parent).map_err(cannot)?;
    for (file, text) in files {
        let path = beside.path().join(file);
        let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
        written.map_err(cannot)?;
    }
    if is_there {
        fs::remove_dir(folder).map_err(cannot)?;
    }
    // Renamed, it is no longer temporary; else it is removed when it is dropped.
    fs::rename(beside.path(), folder).map_err(cannot)?;
    let _ = beside.keep();
    Ok(())
}
