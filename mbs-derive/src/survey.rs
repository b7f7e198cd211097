//! What an editor asks of a text while it is being written.

use std::ops::Range;

use crate::diagnostic::Diagnostics;
use crate::source::Sources;
use crate::{model, parse};

/// For editors, which ask while a text is being written.
impl Sources {
    /// What is wrong with a mechanism, or with a file to be imported, before anything is derived; and what its names
    /// stand for, by the places where they are declared: `m/s²`, `vector of m`, `pose`. These are found in a text with
    /// mistakes, too, as far as it can be read.
    ///
    /// ```
    /// # use mbs_derive::source::Sources;
    /// let sources = Sources::new("a.mbs", "mechanism A { coord x: m; let v = dt(x); kinetic += y; }");
    /// let (errors, meanings) = sources.surveyed();
    /// assert_eq!(errors.iter().next().unwrap().message, "`y` is not declared");
    /// assert_eq!(meanings[1], (30..31, "m/s".to_string()));
    /// ```
    pub fn surveyed(&self) -> (Diagnostics, Vec<(Range<usize>, String)>) {
        let (declaration, is_mechanism, errors) = parse::readable(self);
        let Some(declaration) = declaration else { return (errors, Vec::new()) };
        // What was not read would be missed in the rest.
        let (is_read, mut errors) = (!errors.has_errors(), errors);
        let (found, meanings) = model::surveyed(&declaration, is_mechanism && is_read);
        if is_read {
            errors.append(found);
        }
        (errors, meanings)
    }

    /// The words of the language: kind (`keyword`, `constant`, `function`, `method`, `unit`), the word, and how it is
    /// called or what it stands for, nothing of keywords.
    pub fn words() -> Vec<(&'static str, String, String)> {
        let words = parse::words().map(|(kind, word, what)| (kind, word.to_string(), what.to_string()));
        words.chain(model::words()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Such a file has no block of a mechanism, in which its parts would stand.
    #[test]
    fn parts_built_in_a_file_to_be_imported_are_reported() {
        let (errors, _) = Sources::new("shared.mbs", "const a: 1 = 2; bob one(a);").surveyed();
        assert_eq!(
            errors.iter().next().map(|error| error.message.as_str()),
            Some("`bob` stands in a file without a mechanism")
        );
    }
}
