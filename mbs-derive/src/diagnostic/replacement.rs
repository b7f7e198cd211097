//! What an editor may write in place of what a message is about.

use super::Diagnostic;
use crate::span::Span;

impl Diagnostic {
    /// The place and the text to stand there, where the help is no more than a name, a sign or a number to be written
    /// in place of another: `source` is the text that the message is about.
    ///
    /// ```
    /// let text = "mechanism A { param length: m = 1; coord x: m; kinetic += 1 kg*dt(x)^2; potential += 1 N*lenght; }";
    /// let error = mbs_derive::generate("a.mbs", text, &Default::default()).unwrap_err();
    /// let mbs_derive::Error::Declaration(messages) = error else { unreachable!() };
    /// let unknown = messages.iter().next().unwrap();
    /// assert_eq!(unknown.replacement(text), Some((89..95, "length".to_string())));
    /// ```
    pub fn replacement(&self, source: &str) -> Option<(Span, String)> {
        let help = self.help.as_deref()?;
        let found = source.get(self.span.clone())?;
        if found.is_empty() {
            let is_end = help.starts_with("end the ") && help.ends_with(" with `;`");
            return is_end.then(|| (self.span.clone(), ";".to_string()));
        }
        if let Some(meant) = quoted(help, "did you mean `", "`?") {
            // Of a function with its arguments the name; what is written otherwise, `x^2` for `sqr(x)`, is the user's.
            let name = meant.split_once('(').map_or(meant, |(name, _)| name);
            let is_plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '*');
            return (is_plain && is_word(found)).then(|| (self.span.clone(), name.to_string()));
        }
        let meant = quoted(help, "write `", "`")?;
        let is_sign =
            found.chars().all(|c| c.is_ascii_punctuation()) && meant.chars().all(|c| c.is_ascii_punctuation());
        (!found.is_ascii() || is_sign).then(|| (self.span.clone(), meant.to_string()))
    }
}

/// What stands in back quotes, if that is all that is said.
fn quoted<'h>(help: &'h str, before: &str, behind: &str) -> Option<&'h str> {
    let quoted = help.strip_prefix(before)?.strip_suffix(behind)?;
    (!quoted.is_empty() && !quoted.contains(['`', '…'])).then_some(quoted)
}

fn is_word(text: &str) -> bool {
    text.chars().all(|c| c.is_alphanumeric() || c == '_')
}
