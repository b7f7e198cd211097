//! What an earlier run of the same build script made of a mechanism, known by a file beside the module.
//!
//! ```text
//! digest of all that follows, of the module and of the files of other languages
//! digest of the request
//! module, name, coordinates, inputs, whether it implements `Mechanism`, files of other languages
//! warnings
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use super::digest::Digest;
use crate::emit::Options;
use crate::generated::Generated;
use crate::parse::syntax::Declaration;
use crate::source::Sources;

/// Where the record of a mechanism is, and of what request.
pub(super) struct Kept {
    folder: PathBuf,
    file: String,
    request: Digest,
}

impl Kept {
    /// In `OUT_DIR`, under the name of the mechanism's file and a digest of its path. `None` where the program cannot
    /// tell itself from another version.
    pub(super) fn new(folder: &Path, sources: &Sources, options: &Options) -> Option<Self> {
        Self::of(folder, "", &format!("{options:?}"), sources)
    }

    /// The record of a mechanism that calls have written, in place of a text and beside others of the same script:
    /// warnings name the places of the calls.
    pub(super) fn written(
        folder: &Path,
        declaration: &Declaration,
        sources: &Sources,
        options: &Options,
    ) -> Option<Self> {
        Self::of(
            folder,
            &declaration.name.text,
            &format!("{options:?}\n{declaration:?}\n{:?}", sources.calls()),
            sources,
        )
    }

    fn of(folder: &Path, name: &str, request: &str, sources: &Sources) -> Option<Self> {
        Digest::of_this_program()?;
        let path = &sources.main().name;
        let stem = Path::new(path).file_stem().unwrap_or_default().display();
        let parts = [path.as_bytes(), name.as_bytes()];
        // A file's digest is that of its path alone.
        let file = format!("{stem}.{}", Digest::of(parts.into_iter().take(1 + usize::from(!name.is_empty()))));
        Some(Kept { folder: folder.into(), file, request: Digest::of_request(request, sources) })
    }

    /// What was made, if the request is the same and both files are whole.
    pub(super) fn read(&self) -> Option<Generated> {
        self.whole().filter(|(request, _)| *request == self.request.to_string()).map(|(_, made)| made)
    }

    /// Removes what was made if it is stale, whatever the request was, unless others have written over it since.
    pub(super) fn forget(&self, is_stale: impl FnOnce(&Generated) -> bool) {
        let Some((_, made)) = self.whole().filter(|(_, made)| is_stale(made)) else { return };
        let module = format!("{}.rs", made.module);
        let files = made.others.iter().map(|(file, _)| file).chain([&module, &self.file]);
        files.for_each(|file| drop(fs::remove_file(self.folder.join(file))));
    }

    /// What was made, with the digest of the request.
    fn whole(&self) -> Option<(String, Generated)> {
        let record = fs::read_to_string(self.folder.join(&self.file)).ok()?;
        let (sum, content) = record.split_once('\n')?;
        let (request, content_of) = content.split_once('\n')?;
        let (line, warnings) = content_of.split_once('\n')?;
        let words: Vec<&str> = line.split(' ').collect();
        let (&[module, name, dof, inputs, constraints, implements], files) = words.split_first_chunk()?;
        let code = fs::read_to_string(self.folder.join(format!("{module}.rs"))).ok()?;
        let other = |file: &&str| Some((file.to_string(), fs::read_to_string(self.folder.join(file)).ok()?));
        let others = files.iter().map(other).collect::<Option<Vec<_>>>()?;
        (sum == sum_of(content, &code, &others)).then_some(())?;
        let made = Generated {
            module: module.into(),
            name: name.into(),
            dof: dof.parse().ok()?,
            inputs: inputs.parse().ok()?,
            constraints: constraints.parse().ok()?,
            implements_mechanism: implements.parse().ok()?,
            code,
            others,
            warnings: warnings.into(),
        };
        Some((request.to_string(), made))
    }

    /// The name of the record's file, and its text.
    pub(super) fn record(&self, made: &Generated) -> (&str, String) {
        let Generated { module, name, dof, inputs, constraints, implements_mechanism, code, others, warnings } = made;
        let files: String = others.iter().map(|(file, _)| format!(" {file}")).collect();
        let line = format!("{module} {name} {dof} {inputs} {constraints} {implements_mechanism}{files}");
        let content = format!("{}\n{line}\n{warnings}", self.request);
        (&self.file, format!("{}\n{content}", sum_of(&content, code, others)))
    }
}

fn sum_of(content: &str, code: &str, others: &[(String, String)]) -> String {
    let others = others.iter().map(|(_, text)| text.as_bytes());
    Digest::of([content.as_bytes(), code.as_bytes()].into_iter().chain(others)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mechanisms_of_calls_are_kept_one_by_one() {
        let mechanism_at = |line: u32, name: &str, unit: &str| {
            let mut mechanism = crate::builder::Mechanism::new(name, "");
            mechanism.at(crate::source::Place { file: "table.csv", line, column: 1 });
            mechanism.coord("x", unit);
            mechanism
        };
        let mechanism = |name: &str, unit: &str| mechanism_at(1, name, unit);
        let kept = |mechanism: crate::builder::Mechanism| {
            let (declaration, sources) = (mechanism.declaration().unwrap(), mechanism.sources());
            Kept::written(Path::new("out"), &declaration, &sources, &Options::default()).unwrap()
        };
        let [one, other, longer] =
            [("One", "m"), ("Other", "m"), ("One", "rad")].map(|(name, unit)| kept(mechanism(name, unit)));
        assert_ne!(one.file, other.file);
        assert_eq!(one.file, longer.file);
        assert_ne!(one.request.to_string(), longer.request.to_string());
        assert_eq!(one.request.to_string(), kept(mechanism("One", "m")).request.to_string());
        assert_ne!(one.request.to_string(), kept(mechanism_at(2, "One", "m")).request.to_string());
    }

    #[test]
    fn only_what_is_whole_and_of_the_same_request_is_taken() {
        let folder = std::env::temp_dir().join(format!("mbs_derive_kept_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let kept = |text: &str, options| Kept::new(&folder, &Sources::new("a/m.mbs", text), options).unwrap();
        let (options, frozen) = (Options::default(), Options { freeze: vec!["m".into()], ..Options::default() });
        let ours = kept("one", &options);
        let [module, name, code] = ["m", "M", "pub struct M;\n"].map(String::from);
        let warnings = "warning: a\n --> b\n".to_string();
        let others = vec![("m.h".to_string(), "struct m;\n".to_string())];
        let made = Generated {
            module,
            name,
            dof: 2,
            inputs: 1,
            constraints: 3,
            implements_mechanism: true,
            code,
            others,
            warnings,
        };
        let (file, record) = ours.record(&made);
        let files = [folder.join(file), folder.join("m.rs"), folder.join("m.h")];
        let texts = [record.as_bytes(), made.code.as_bytes(), made.others[0].1.as_bytes()];
        assert_eq!(ours.read(), None);
        let write = |n: usize, bytes: &[u8]| fs::write(&files[n], bytes).unwrap();
        write(0, texts[0]);
        assert_eq!(ours.read(), None, "no module");
        write(1, texts[1]);
        assert_eq!(ours.read(), None, "no header");
        write(2, texts[2]);
        assert_eq!(ours.read().as_ref(), Some(&made));
        assert_eq!(kept("two", &options).read(), None);
        assert_eq!(kept("one", &frozen).read(), None);
        for n in [0, 1, 2] {
            for at in 0..texts[n].len() {
                let mut bytes = texts[n].to_vec();
                bytes[at] ^= 1;
                write(n, &bytes);
                assert_eq!(ours.read(), None, "{at}");
                write(n, &texts[n][..at]);
                assert_eq!(ours.read(), None, "cut at {at}");
            }
            write(n, texts[n]);
        }
        assert_eq!(ours.read(), Some(made.clone()));
        // Another mechanism's module is not ours to remove.
        write(1, b"pub struct Other;\n");
        kept("two", &options).forget(|_| true);
        assert!(files.iter().all(|file| file.exists()));
        write(1, texts[1]);
        kept("two", &frozen).forget(|made| made.module == "other");
        assert!(files.iter().all(|file| file.exists()));
        kept("two", &frozen).forget(|_| true);
        assert!(!files.iter().any(|file| file.exists()));
        fs::remove_dir_all(&folder).unwrap();
    }
}
