//! Robots of other formats as texts of the model language: URDF, SDF, and MuJoCo's MJCF.
//!
//! A file is read with the place of every element, becomes a `Robot`, bodies on joints, whatever its format, and that
//! is written. In reading order:
//!
//! - `xml`: elements and attributes with their places; `urdf`, `sdf`, `mjcf`: what they mean;
//! - `robot`: what all formats say, and what must hold of it; `pose`: places and attitudes as numbers;
//! - `identifier`: names; `write`: the text.

mod identifier;
mod mjcf;
mod pose;
mod robot;
mod sdf;
mod urdf;
mod write;
mod xml;

#[cfg(test)]
mod tests;

use crate::diagnostic::Diagnostics;
use xml::Reader;

/// How a robot is written, and what the writer has to know.
#[derive(Clone, Copy)]
pub(crate) struct Options<'o> {
    /// Masses, mass centres and inertias are parameters, not constants.
    pub(crate) parameters: bool,
    /// Attitudes are yaw, pitch and roll, not quaternions.
    pub(crate) angles: bool,
    /// A base that no joint holds moves freely.
    pub(crate) floating: bool,
    /// Inertias that no body has are told, and taken.
    pub(crate) any_inertia: bool,
    /// Words that cannot be names.
    pub(crate) is_word: fn(&str) -> bool,
    /// Where the mesh of this path is, seen from the folder of the text; `None` where it is not.
    pub(crate) find: &'o dyn Fn(&str) -> Option<String>,
}

/// The longest file, in bytes.
const MAX_BYTES: usize = 1 << 26;

/// The text of a robot's mechanism, and warnings about the file.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn mechanism(file: &str, xml: &str, options: &Options<'_>) -> Result<(String, Diagnostics), Diagnostics> {
    let mut reader = Reader::default();
    if xml.len() > MAX_BYTES {
        reader.refuse(0..0, "this file is larger than 64 MiB", "");
        return Err(reader.errors);
    }
    let document = xml::document(xml)?;
    let root = document.root_element();
    let (format, robot) = match root.tag_name().name() {
        "robot" => ("URDF", urdf::robot(root, &mut reader)),
        "sdf" | "gazebo" => ("SDF", sdf::robot(root, &mut reader)),
        "mujoco" => ("MJCF", mjcf::robot(root, &mut reader)),
        other => {
            let message = format!("`{}` is no robot", identifier::shown(other));
            reader.refuse(xml::tag(root), message, "a file begins with `<robot>` (URDF), `<sdf>` or `<mujoco>` (MJCF)");
            return Err(reader.errors);
        }
    };
    let Some(mut robot) = robot.filter(|_| !reader.errors.has_errors()) else { return Err(reader.errors) };
    if options.floating {
        robot.set_free();
    }
    robot.check(options.any_inertia, &mut reader);
    if reader.errors.has_errors() {
        return Err(reader.errors);
    }
    let name = file.rsplit('/').next().unwrap_or(file);
    match write::text(&robot, name, format, options, &mut reader) {
        Some(text) => Ok((text, reader.errors)),
        None => Err(reader.errors),
    }
}
