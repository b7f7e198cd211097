//! Files of robots: `import "robot.urdf";` reads what `mbs import` writes.

#[cfg(feature = "import")]
use crate::diagnostic::{Diagnostic, Diagnostics};
#[cfg(feature = "import")]
use crate::source::Sources;
use crate::source::{IMPORTED, Unreadable, Warning, is_robot};

/// The bytes of a file, of a robot the text of its mechanism, and warnings about it; what has been such a text before
/// stays as it is.
pub(super) fn as_text(name: &str, bytes: Vec<u8>) -> Result<(Vec<u8>, Vec<Warning>), Unreadable> {
    if !is_robot(name) || bytes.starts_with(IMPORTED.as_bytes()) {
        return Ok((bytes, Vec::new()));
    }
    text(name, bytes)
}

#[cfg(not(feature = "import"))]
fn text(_: &str, _: Vec<u8>) -> Result<(Vec<u8>, Vec<Warning>), Unreadable> {
    let help = "write `mbs-derive = { …, features = [\"import\"] }`, or import what `mbs import` writes";
    Err(Unreadable::new("robots are read with the feature `import` of mbs-derive", help))
}

#[cfg(feature = "import")]
fn text(name: &str, bytes: Vec<u8>) -> Result<(Vec<u8>, Vec<Warning>), Unreadable> {
    let Ok(xml) = String::from_utf8(bytes) else {
        return Err(Unreadable::new("it is not UTF-8 text", "save it as UTF-8"));
    };
    match Sources::robot(name, &xml).text(&|path| Some(path.trim_start_matches("file://").to_string())) {
        Ok((text, warnings)) => Ok((text.into_bytes(), warnings.iter().map(|w| warning(name, &xml, w)).collect())),
        Err(errors) => Err(unreadable(name, &xml, &errors)),
    }
}

#[cfg(feature = "import")]
fn warning(name: &str, xml: &str, found: &Diagnostic) -> Warning {
    Warning { message: placed(name, xml, found), help: found.help.clone().unwrap_or_default() }
}

/// What is said, with its place in the file.
#[cfg(feature = "import")]
fn placed(name: &str, xml: &str, found: &Diagnostic) -> String {
    let before = &xml[..found.span.start.min(xml.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    format!("{name}:{line}:{column}: {}", found.message)
}

/// The first error, with its place in the file.
#[cfg(feature = "import")]
fn unreadable(name: &str, xml: &str, errors: &Diagnostics) -> Unreadable {
    let first = errors.iter().find(|error| error.severity == crate::diagnostic::Severity::Error);
    let Some(error) = first else { return Unreadable::new("it is no robot", "") };
    let more = match errors.error_count() {
        0 | 1 => String::new(),
        n => format!(" (and {} more: `mbs import {name}` shows all)", n - 1),
    };
    let help = error.help.clone().unwrap_or_else(|| format!("`mbs import {name}` shows the place"));
    Unreadable::new(placed(name, xml, error) + &more, help)
}

/// A robot's file, and how its mechanism is written.
#[cfg(feature = "import")]
#[derive(Clone, Debug)]
#[must_use]
pub struct Robot<'a> {
    file: &'a str,
    xml: &'a str,
    parameters: bool,
    angles: bool,
    floating: bool,
    any_inertia: bool,
}

#[cfg(feature = "import")]
impl Sources {
    /// A robot of another format, URDF, SDF or MJCF, to be written in the model language.
    ///
    /// ```
    /// use mbs_derive::source::Sources;
    /// let urdf = r#"<robot name="pendulum">
    ///     <link name="stand"/>
    ///     <link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    ///         <inertia ixx="0.17" iyy="0.17" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
    ///     <joint name="hinge" type="continuous"><parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/></joint>
    /// </robot>"#;
    /// let (text, warnings) = Sources::robot("pendulum.urdf", urdf).text(&|_| None).unwrap();
    /// assert!(text.contains("let rod = stand * rot_y(hinge);") && warnings.iter().count() == 0);
    /// ```
    pub fn robot<'a>(file: &'a str, xml: &'a str) -> Robot<'a> {
        Robot { file, xml, parameters: false, angles: false, floating: false, any_inertia: false }
    }
}

#[cfg(feature = "import")]
impl Robot<'_> {
    /// Masses, mass centres and inertias as parameters, which may change at run time, in place of constants.
    pub fn parameters(self, parameters: bool) -> Self {
        Self { parameters, ..self }
    }

    /// Attitudes by yaw, pitch and roll, singular at a pitch of 90°, in place of unit quaternions.
    pub fn angles(self, angles: bool) -> Self {
        Self { angles, ..self }
    }

    /// Whether a base that no joint holds moves freely; else it stands in the world.
    pub fn floating(self, floating: bool) -> Self {
        Self { floating, ..self }
    }

    /// Whether inertias that no body has are taken, with a warning, in place of an error.
    pub fn any_inertia(self, any_inertia: bool) -> Self {
        Self { any_inertia, ..self }
    }

    /// The text of the mechanism, and warnings, whose places are in the robot's file. `find` says where a mesh is, as
    /// seen from the folder of the text.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn text(&self, find: &dyn Fn(&str) -> Option<String>) -> Result<(String, Diagnostics), Diagnostics> {
        let is_word = |word: &str| super::keyword::taken(word).is_some() || super::keyword::CONTEXTUAL.contains(&word);
        let Robot { file, xml, parameters, angles, floating, any_inertia } = *self;
        let options = crate::import::Options { parameters, angles, floating, any_inertia, is_word, find };
        crate::import::mechanism(file, xml, &options)
    }
}
