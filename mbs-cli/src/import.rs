//! `mbs import`: a robot of URDF, SDF or MJCF as a mechanism of the model language.

use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use mbs_derive::diagnostic::Diagnostics;
use mbs_derive::parse;
use mbs_derive::source::Sources;
use serde_json::json;

use crate::failure::Failure;
use crate::files::Files;
use crate::message::Messages;
use crate::output;

/// Write a robot (URDF, SDF, MJCF) as a mechanism.
///
/// Links become frames and bodies, joints coordinates, those of one axis and ball joints with an input; damping,
/// springs, mimics and equality constraints are kept, limits are noted. `import "robot.urdf";` in a mechanism does the
/// same in memory.
#[derive(clap::Args)]
#[command(verbatim_doc_comment, after_help = "Example:\n  mbs import arm.urdf --out arm.mbs")]
pub(crate) struct Arguments {
    /// The robot: URDF, SDF, or MJCF (.xml).
    #[arg(value_name = "ROBOT")]
    file: PathBuf,
    /// Write to a file instead of standard output.
    #[arg(long, value_name = "FILE.mbs")]
    out: Option<PathBuf>,
    /// Masses, mass centres and inertias as parameters, which may change at run time, not as constants.
    #[arg(long)]
    parameters: bool,
    /// A base that no joint holds moves freely; else it stands in the world. Free bodies of MJCF and SDF are free.
    #[arg(long)]
    floating: bool,
    /// Attitudes by yaw, pitch and roll, which are singular at a pitch of 90°, not by unit quaternions.
    #[arg(long)]
    angles: bool,
    /// Take inertias that no body has as they are, with a warning: a negative principal moment, or one greater than
    /// the sum of the other two.
    #[arg(long)]
    any_inertia: bool,
}

/// Prints or writes the mechanism.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut files = Files::default();
    files.reads("the robot", &arguments.file);
    if let Some(out) = &arguments.out {
        files.writes("--out", out)?;
    }
    let name = arguments.file.to_string_lossy();
    let xml = parse::text(&name, bytes(&arguments.file)?).map_err(|report| Failure::from(Messages::of_file(report)))?;
    let robot = Sources::robot(&name, &xml)
        .parameters(arguments.parameters)
        .floating(arguments.floating)
        .angles(arguments.angles)
        .any_inertia(arguments.any_inertia);
    let folder = |path: &Path| {
        path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf()
    };
    let (from, to) = (folder(&arguments.file), arguments.out.as_deref().map_or(PathBuf::from("."), folder));
    let found = robot.text(&|mesh| find(&from, &to, mesh));
    let of_robot = |found: &Diagnostics| Messages::of(found, &Sources::new(&name, &xml));
    let (text, warnings) = found.map_err(|errors| Failure::from(of_robot(&errors)))?;
    match &arguments.out {
        None => output::answer(|| json!({ "text": text }), || text.clone())?,
        Some(path) => {
            output::write(path, text.as_bytes())?;
            output::wrote(&[path])?;
        }
    }
    output::report(&of_robot(&warnings));
    Ok(())
}

/// The longest file that is read.
const MAX_BYTES: u64 = 1 << 26;

fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let read = || {
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path)?;
        if file.metadata()?.is_dir() {
            return Err(ErrorKind::IsADirectory.into());
        }
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error: std::io::Error| Failure::new(format_args!("cannot read {}: {error}", path.display())))
}

/// Where a mesh is, seen from the folder `to`: its path is one from the folder `from`, or `package://name/path`, which
/// is looked for in the folders above.
fn find(from: &Path, to: &Path, mesh: &str) -> Option<String> {
    let from = from.canonicalize().ok()?;
    let in_package = ["package://", "model://"].iter().find_map(|scheme| mesh.strip_prefix(scheme));
    let there = match in_package {
        Some(path) => from.ancestors().find_map(|above| {
            let (package, rest) = path.split_once('/')?;
            let inside = (above.file_name()? == package).then(|| above.join(rest));
            inside.into_iter().chain([above.join(path)]).find(|file| file.is_file())
        })?,
        None => from.join(mesh.strip_prefix("file://").unwrap_or(mesh)),
    };
    let there = there.canonicalize().ok().filter(|there| there.is_file())?;
    let path = pathdiff::diff_paths(there, to.canonicalize().ok()?)?;
    let parts: Option<Vec<&str>> = path.iter().map(|part| part.to_str()).collect();
    Some(parts?.join("/"))
}
