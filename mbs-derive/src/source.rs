//! The files that a mechanism is declared by: its own, and those that it imports.
//!
//! A `Span` counts the bytes of all of them, the mechanism's own file first: a place needs no file beside it, and
//! where nothing is imported spans are those of the one text. Files are known by their names, which are paths as text:
//! an import is looked for beside the file that it stands in, and `..` takes a folder away from the path, links or not.
//!
//! ```
//! use mbs_derive::source::{Sources, Unreadable};
//! let read = |name: &str| match name {
//!     "shared/steel.mbs" => Ok(b"const density: kg/m^3 = 7850;".to_vec()),
//!     _ => Err(Unreadable { reason: "there is no such file".into(), help: "look for it".into() }),
//! };
//! let sources = Sources::gather("arms/arm.mbs", "import \"../shared/steel.mbs\"; mechanism Arm { }", read);
//! assert_eq!(sources.names().collect::<Vec<_>>(), ["arms/arm.mbs", "shared/steel.mbs"]);
//! ```

mod insertion;

use std::collections::BTreeMap;
use std::fmt;
use std::panic::Location;
use std::path::{Component, Path};

use crate::span::Span;

use insertion::Edited;
pub use insertion::Insertion;

/// All files of a mechanism together may be so long: offsets of tokens are 32 bits wide.
pub(crate) const MAX_BYTES: usize = 1 << 26;

/// Files that one mechanism may import, directly or not.
pub(crate) const MAX_IMPORTS: usize = 100;

/// Files that import files that import files.
pub(crate) const MAX_DEPTH: usize = 20;

/// What the text of the mechanism begins with that a robot has become.
pub(crate) const IMPORTED: &str = "// Imported from ";

/// Whether a file is a robot: URDF, SDF or MJCF.
pub(crate) fn is_robot(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    let extension = extension.map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| ["urdf", "sdf", "xml", "mjcf", "xacro"].contains(&extension.as_str()))
}

/// Whether a text is that of the mechanism that the robot of this file has become.
pub(crate) fn is_written_robot(name: &str, text: &str) -> bool {
    text.starts_with(IMPORTED) && is_robot(name)
}

/// The texts of a mechanism and of all that it imports, directly or not, each once.
///
/// ```
/// use mbs_derive::source::{Sources, Unreadable};
/// let read = |name: &str| match name {
///     "constants.mbs" => Ok(b"const g: m/s^2 = 9.81;".to_vec()),
///     _ => Err(Unreadable::new("there is no such file", "check its name")),
/// };
/// let sources = Sources::gather("ball.mbs", "import \"constants.mbs\"; mechanism Ball { coord x: m; }", read);
/// assert_eq!(sources.count(), 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sources {
    /// The mechanism's own file first; never empty.
    files: Vec<Source>,
    /// The number of the file with this path, in its plain form.
    numbers: BTreeMap<String, usize>,
    /// In place of texts, the calls of a build script that wrote the mechanism: a span counts them.
    calls: Vec<Place>,
    /// The text of the mechanism's own file before a program has put something into it.
    edited: Option<Edited>,
}

/// Where a call was made that a mechanism is written by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// As reports call it.
    pub file: &'static str,
    /// From 1.
    pub line: u32,
    /// From 1.
    pub column: u32,
}

impl From<&'static Location<'static>> for Place {
    fn from(location: &'static Location<'static>) -> Self {
        Place { file: location.file(), line: location.line(), column: location.column() }
    }
}

/// As reports name it.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// One file.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// As reports call it.
    pub name: String,
    /// Its text, or why there is none.
    pub text: Result<String, Unreadable>,
    /// Where its text begins among those of all files; each begins behind the end of the one before.
    pub start: usize,
    /// What is doubtful in the file that it was made of, a robot's, and what to do about it.
    pub(crate) warnings: Vec<Warning>,
}

/// What is doubtful in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Warning {
    /// With its place in the file.
    pub(crate) message: String,
    /// What to do about it; it may be empty.
    pub(crate) help: String,
}

/// Why a file has no text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// As the end of a sentence: "there is no such file".
    pub reason: String,
    /// What to do about it.
    pub help: String,
}

impl Sources {
    /// One text, with no files beside it: what it imports is not there.
    pub fn new(name: &str, text: &str) -> Self {
        let mut sources = Sources { files: Vec::new(), numbers: BTreeMap::new(), calls: Vec::new(), edited: None };
        sources.push(name.to_string(), Ok(text.to_string()), Vec::new());
        sources
    }

    /// The same files, the mechanism's own with another text that imports no others.
    ///
    /// ```
    /// use mbs_derive::source::Sources;
    /// let import = "import \"g.mbs\";";
    /// let sources = Sources::gather("a.mbs", import, |_| Ok(b"const g = 9;".to_vec()));
    /// let other = sources.with_text(&format!("{import} mechanism A {{ coord x: m; }}"));
    /// assert_eq!(other.names().collect::<Vec<_>>(), ["a.mbs", "g.mbs"]);
    /// assert_eq!((other.imported(0, "g.mbs"), other.file(1).start), (Some(1), 44));
    /// ```
    #[must_use]
    pub fn with_text(&self, text: &str) -> Self {
        let mut sources = Sources::new(&self.main().name, text);
        for file in &self.files[1..] {
            sources.push(file.name.clone(), file.text.clone(), file.warnings.clone());
        }
        sources
    }

    /// The same files, with texts at places of the mechanism's own, of several at one place the last one first.
    ///
    /// Places in them are [located](Self::locate) where they were written, and so are all others: in the file as it
    /// was.
    #[must_use]
    pub fn with_insertions(&self, insertions: Vec<(usize, Insertion)>) -> Self {
        let (text, edited) = Edited::new(self.main().text.as_deref().unwrap_or_default(), insertions);
        Sources { edited: Some(edited), ..self.with_text(&text) }
    }

    /// No text, but the calls that a mechanism was written by, in a file of this name.
    pub(crate) fn of_calls(name: &str, calls: Vec<Place>) -> Self {
        Sources { calls, ..Sources::new(name, "") }
    }

    /// The call that a place is, where there is no text.
    pub(crate) fn call(&self, span: &Span) -> Option<Place> {
        self.calls.get(span.start).copied()
    }

    /// All of them.
    pub(crate) fn calls(&self) -> &[Place] {
        &self.calls
    }

    /// A text, and what it imports, directly or not: `imports` finds the paths in a text, `read` is given the name of
    /// each file once and answers its bytes, and what is doubtful in it.
    pub(crate) fn followed(
        name: &str,
        text: &str,
        imports: impl Fn(&str) -> Vec<String>,
        mut read: impl FnMut(&str) -> Result<(Vec<u8>, Vec<Warning>), Unreadable>,
    ) -> Self {
        let mut sources = Sources::new(name, text);
        let mut depths = vec![0];
        for number in 0.. {
            let Some(file) = sources.files.get(number) else { break };
            let from = file.name.clone();
            let text = file.text.as_deref().ok().filter(|_| !is_table(&from));
            for path in text.map(&imports).unwrap_or_default() {
                let name = beside(&from, &path);
                if sources.numbers.contains_key(&name) {
                    continue;
                }
                let read = sources.room(depths[number]).and_then(|()| read(&name));
                let read = read.and_then(|(bytes, warnings)| Ok((sources.checked(bytes)?, warnings)));
                let (text, warnings) = read.map_or_else(|e| (Err(e), Vec::new()), |(text, w)| (Ok(text), w));
                sources.push(name, text, warnings);
                depths.push(depths[number] + 1);
            }
        }
        sources
    }

    fn push(&mut self, name: String, text: Result<String, Unreadable>, warnings: Vec<Warning>) {
        let start = self.end();
        self.numbers.entry(plain(Path::new(&name))).or_insert(self.files.len());
        self.files.push(Source { name, text, start, warnings });
    }

    /// Where the next file begins.
    fn end(&self) -> usize {
        self.files.last().map_or(0, |file| file.start + file.text.as_ref().map_or(0, String::len) + 1)
    }

    /// Whether a file `depth` imports away from the mechanism may import one more.
    fn room(&self, depth: usize) -> Result<(), Unreadable> {
        let help = "put several of them into one file";
        if self.files.len() > MAX_IMPORTS {
            return Err(Unreadable::new(format!("more than {MAX_IMPORTS} files are imported"), help));
        }
        if depth == MAX_DEPTH {
            return Err(Unreadable::new(format!("imports are nested deeper than {MAX_DEPTH} files"), help));
        }
        Ok(())
    }

    fn checked(&self, bytes: Vec<u8>) -> Result<String, Unreadable> {
        if self.end() + bytes.len() > MAX_BYTES {
            let reason = "the files of this mechanism are larger than 64 MiB together";
            return Err(Unreadable::new(reason, "import constants and functions, not data"));
        }
        utf8(bytes).map_err(|(line, column)| {
            Unreadable::new(format!("line {line}, column {column} of it is not UTF-8 text"), "save it as UTF-8")
        })
    }

    /// The mechanism's own file.
    pub fn main(&self) -> &Source {
        &self.files[0]
    }

    /// What generated code may say of the mechanism's file: its name as given, but of an absolute path only the last
    /// part, because the same declaration gives the same code on every machine.
    pub fn portable_name(&self) -> &str {
        let name = &self.main().name;
        let path = Path::new(name);
        match path.file_name().and_then(|last| last.to_str()) {
            Some(last) if path.is_absolute() => last,
            _ => name,
        }
    }

    /// The file with this number; the mechanism's own is number 0.
    pub fn file(&self, number: usize) -> &Source {
        &self.files[number]
    }

    /// The number of the file that the file with number `from` imports as `path`, if it was gathered.
    pub fn imported(&self, from: usize, path: &str) -> Option<usize> {
        self.numbers.get(&beside(&self.files[from].name, path)).copied()
    }

    /// The names of all files, those that could not be read included.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.name.as_str())
    }

    /// How many files there are.
    pub fn count(&self) -> usize {
        self.files.len()
    }

    /// The name and text of the file that a place is in, and the place within that text.
    pub fn locate(&self, span: &Span) -> (&str, &str, Span) {
        let number = self.files.partition_point(|file| file.start <= span.start).saturating_sub(1);
        let file = &self.files[number];
        if let (0, Some(edited)) = (number, &self.edited) {
            let (name, text, place) = edited.locate(span);
            return (name.unwrap_or(&file.name), text, place);
        }
        let text = file.text.as_deref().unwrap_or_default();
        (&file.name, text, span.start - file.start..span.end.saturating_sub(file.start))
    }
}

impl Unreadable {
    /// Why, and what to do about it.
    pub fn new(reason: impl Into<String>, help: impl Into<String>) -> Self {
        Unreadable { reason: reason.into(), help: help.into() }
    }
}

/// Bytes as text, or the line and the column, counted from 1, at which they cease to be UTF-8.
fn utf8(bytes: Vec<u8>) -> Result<String, (usize, usize)> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
        let line = valid.rsplit('\n').next().unwrap_or_default();
        (valid.matches('\n').count() + 1, line.chars().count() + 1)
    })
}

/// Whether a file is a table of numbers, `.csv`.
pub(crate) fn is_table(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// A path that stands in a file, as seen from where the file's own name is seen from.
fn beside(file: &str, path: &str) -> String {
    plain(&Path::new(file).parent().unwrap_or(Path::new("")).join(path))
}

/// Without `.`, and with `..` in front only.
fn plain(path: &Path) -> String {
    let (mut root, mut parts) = (String::new(), Vec::new());
    for component in path.components() {
        let text = component.as_os_str().to_string_lossy().into_owned();
        match component {
            Component::Prefix(_) | Component::RootDir => root += &text,
            Component::CurDir => {}
            Component::ParentDir if parts.last().is_some_and(|last| last != "..") => drop(parts.pop()),
            // Nothing is above the root.
            Component::ParentDir if !root.is_empty() => {}
            Component::ParentDir | Component::Normal(_) => parts.push(text),
        }
    }
    root + &parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_seen_from_their_file() {
        let check = |file: &str, path: &str, expected: &str| assert_eq!(beside(file, path), expected, "{file} {path}");
        check("a.mbs", "b.mbs", "b.mbs");
        check("x/a.mbs", "b.mbs", "x/b.mbs");
        check("x/a.mbs", "./y/../b.mbs", "x/b.mbs");
        check("./x/a.mbs", "../b.mbs", "b.mbs");
        check("a.mbs", "../../b.mbs", "../../b.mbs");
        check("../a.mbs", "../b.mbs", "../../b.mbs");
        check("/x/a.mbs", "../../b.mbs", "/b.mbs");
    }

    #[test]
    fn generated_code_tells_no_absolute_path() {
        assert_eq!(Sources::new("mechanisms/a.mbs", "").portable_name(), "mechanisms/a.mbs");
        assert_eq!(Sources::new("/somewhere/mechanisms/a.mbs", "").portable_name(), "a.mbs");
        assert_eq!(Sources::new("../a.mbs", "").portable_name(), "../a.mbs");
    }

    /// A chain of files, each of which imports the next; the depth at which it is cut.
    #[test]
    fn imports_are_limited() {
        let mut names = Vec::new();
        let sources = Sources::gather("0.mbs", "import \"1.mbs\";", |name| {
            names.push(name.to_string());
            let number: usize = name.trim_end_matches(".mbs").parse().unwrap();
            Ok(format!("import \"{}.mbs\"; import \"0.mbs\"; import \"./1.mbs\";", number + 1).into_bytes())
        });
        assert_eq!(names.len(), MAX_DEPTH, "each file is read once");
        assert_eq!(sources.count(), MAX_DEPTH + 2);
        let last = sources.file(MAX_DEPTH + 1).text.as_ref().unwrap_err();
        assert_eq!(last.reason, "imports are nested deeper than 20 files");

        let many: String = (0..200).map(|i| format!("import \"{i}.mbs\";\n")).collect();
        let mut read = 0;
        let sources = Sources::gather("a.mbs", &many, |_| {
            read += 1;
            Ok(Vec::new())
        });
        assert_eq!((read, sources.count()), (MAX_IMPORTS, 201));
        assert_eq!(sources.file(101).text.as_ref().unwrap_err().reason, "more than 100 files are imported");

        let sources =
            Sources::gather("a.mbs", "import \"b.mbs\"; import \"c.mbs\";", |_| Ok(vec![b' '; MAX_BYTES / 2]));
        assert!(sources.file(1).text.is_ok());
        assert!(sources.file(2).text.as_ref().unwrap_err().reason.contains("64 MiB"));
        let sources = Sources::gather("a.mbs", "import \"b.mbs\";", |_| Ok(b"one\ntw\xf6".to_vec()));
        assert_eq!(sources.file(1).text.as_ref().unwrap_err().reason, "line 2, column 3 of it is not UTF-8 text");
    }

    #[test]
    fn places_belong_to_files() {
        let sources = Sources::gather("a", "import \"b\"; import \"c\";", |name| match name {
            "b" => Err(Unreadable::new("", "")),
            _ => Ok(b"const x = 1;".to_vec()),
        });
        let (b, c) = (sources.file(1).start, sources.file(2).start);
        assert_eq!((b, c), (24, 25));
        assert_eq!(sources.locate(&(23..23)), ("a", "import \"b\"; import \"c\";", 23..23));
        assert_eq!(sources.locate(&(b..b)), ("b", "", 0..0));
        assert_eq!(sources.locate(&(c + 6..c + 7)), ("c", "const x = 1;", 6..7));
    }
}
