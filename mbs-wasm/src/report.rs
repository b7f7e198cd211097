//! What is wrong, as JSON.

use mbs_derive::Error;
use mbs_derive::diagnostic::{Diagnostic, Diagnostics};
use mbs_derive::source::Sources;
use serde_json::{Value, json};

/// Why something was not done: what the page throws.
#[derive(Clone, Debug)]
pub struct Failure(pub Value);

impl Failure {
    /// The text is not a mechanism, or what was derived from it could not be proved.
    pub(crate) fn of_model(error: &Error, sources: &Sources) -> Self {
        let diagnostics = match error {
            Error::Declaration(diagnostics) => self::diagnostics(diagnostics, sources),
            _ => Vec::new(),
        };
        Failure(json!({
            "kind": "model",
            "message": error.to_string(),
            "report": error.render_in(sources),
            "diagnostics": diagnostics,
        }))
    }

    /// An argument is not what it should be.
    pub(crate) fn of_input(message: impl Into<String>) -> Self {
        Failure(json!({ "kind": "input", "message": message.into() }))
    }

    /// There is no way on from this state.
    pub(crate) fn of_motion(message: String, t: f64, q: &[f64], qd: &[f64]) -> Self {
        Failure(json!({ "kind": "motion", "message": message, "t": t, "q": q, "qd": qd }))
    }
}

/// Every message with its place.
pub(crate) fn diagnostics(diagnostics: &Diagnostics, sources: &Sources) -> Vec<Value> {
    diagnostics.iter().map(|message| diagnostic(message, sources)).collect()
}

fn diagnostic(message: &Diagnostic, sources: &Sources) -> Value {
    let mut value = place(&message.span, sources);
    value["severity"] = json!(message.severity.to_string());
    value["code"] = json!(message.code());
    value["message"] = json!(message.message);
    value["help"] = json!(message.help);
    let notes = message.notes.iter().map(|note| {
        let mut value = place(&note.span, sources);
        value["message"] = json!(note.message);
        value
    });
    value["notes"] = notes.collect();
    value
}

/// File, line and column counted from 1, and length, in characters; `start` and `end` in the units of JavaScript's
/// strings, from 0.
fn place(span: &std::ops::Range<usize>, sources: &Sources) -> Value {
    let (file, text, span) = sources.locate(span);
    let start = boundary(text, span.start);
    let end = boundary(text, span.end).max(start);
    let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    let units = |text: &str| text.encode_utf16().count();
    json!({
        "file": file,
        "line": text[..start].matches('\n').count() + 1,
        "column": text[line_start..start].chars().count() + 1,
        "length": text[start..end].chars().count(),
        "start": units(&text[..start]),
        "end": units(&text[..end]),
    })
}

/// The nearest place at or before `offset` where a character begins.
fn boundary(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}
