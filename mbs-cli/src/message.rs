//! What standard error says: errors and warnings, each with its severity, and with its code and place where it is about
//! a text.

use std::fmt::Display;

use mbs_derive::Error;
use mbs_derive::diagnostic::{Diagnostic, Diagnostics, Severity};
use mbs_derive::source::Sources;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Messages as people read them, and one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Messages {
    /// The report; empty where there is nothing to say.
    text: String,
    items: Vec<Message>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Message {
    severity: String,
    /// What `mbs explain` has a page for.
    code: Option<String>,
    message: String,
    help: Option<String>,
    place: Option<Place>,
    notes: Vec<(String, Place)>,
}

/// Line and column from 1, the length within its line or lines, in characters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Place {
    file: String,
    line: usize,
    column: usize,
    length: usize,
}

impl Messages {
    /// About the text of a mechanism, or about data.
    pub(crate) fn of(diagnostics: &Diagnostics, sources: &Sources) -> Self {
        let item = |diagnostic: &Diagnostic| Message {
            severity: diagnostic.severity.to_string(),
            code: Some(diagnostic.code()),
            message: diagnostic.message.clone(),
            help: diagnostic.help.clone(),
            place: Some(Place::of(&diagnostic.span, sources)),
            notes: diagnostic.notes.iter().map(|n| (n.message.clone(), Place::of(&n.span, sources))).collect(),
        };
        Messages { text: diagnostics.render_in(sources), items: diagnostics.iter().map(item).collect() }
    }

    /// The messages without severities and places, one behind the other.
    pub(crate) fn plain_text(&self) -> String {
        self.items.iter().map(|item| item.message.as_str()).collect::<Vec<_>>().join("; ")
    }

    /// Why there is no derivation.
    pub(crate) fn of_error(error: &Error, sources: &Sources) -> Self {
        match error {
            Error::Declaration(diagnostics) => Messages::of(diagnostics, sources),
            other => Messages {
                text: other.render_in(sources),
                items: vec![Message {
                    code: other.codes().pop(),
                    place: Some(Place { file: sources.main().name.clone(), line: 1, column: 1, length: 1 }),
                    ..Message::plain(Severity::Error, other.to_string())
                }],
            },
        }
    }

    /// A report of the generator about a file that could not be read as a text: its title, its place and its help.
    pub(crate) fn of_file(report: String) -> Self {
        let title = report.lines().next().unwrap_or_default();
        let (head, message) = title.split_once(": ").unwrap_or(("", title));
        let code = head.split_once('[').and_then(|(_, rest)| rest.strip_suffix(']')).map(str::to_string);
        let behind = |mark: &str| report.lines().find_map(|line| line.trim_start().strip_prefix(mark));
        let place = behind("--> ").and_then(|place| {
            let mut parts = place.rsplitn(3, ':');
            let (column, line) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
            Some(Place { file: parts.next()?.to_string(), line, column, length: 1 })
        });
        let help = behind("= help: ").map(str::to_string);
        let item = Message { code, help, place, ..Message::plain(Severity::Error, message.to_string()) };
        Messages { text: report, items: vec![item] }
    }

    /// Without a place in a text: lower case, no full stop.
    pub(crate) fn plain(severity: Severity, message: impl Display) -> Self {
        Messages::several(severity, &[message.to_string()])
    }

    /// To be seen at once. More than twenty are not read anyway.
    pub(crate) fn several(severity: Severity, messages: &[String]) -> Self {
        const SHOWN: usize = 20;
        let mut text: String = messages.iter().take(SHOWN).map(|message| format!("{severity}: {message}\n")).collect();
        if messages.len() > SHOWN {
            text += &format!("… and {} more\n", messages.len() - SHOWN);
        }
        Messages { text, items: messages.iter().map(|message| Message::plain(severity, message.clone())).collect() }
    }

    /// These, and behind them others.
    pub(crate) fn append(&mut self, other: &Messages) {
        self.text += &other.text;
        self.items.extend_from_slice(&other.items);
    }

    /// Whether there is nothing to say.
    pub(crate) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// As people read it.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// One object a message.
    pub(crate) fn json(&self) -> Vec<Value> {
        self.items.iter().map(Message::json).collect()
    }
}

impl Message {
    fn plain(severity: Severity, message: String) -> Self {
        Message { severity: severity.to_string(), code: None, message, help: None, place: None, notes: Vec::new() }
    }

    fn json(&self) -> Value {
        let mut object = json!({ "severity": self.severity, "message": self.message });
        let mut put = |key: &str, value: Value| object[key] = value;
        if let Some(code) = &self.code {
            put("code", json!(code));
        }
        if let Some(help) = &self.help {
            put("help", json!(help));
        }
        if let Some(Place { file, line, column, length }) = &self.place {
            put("file", json!(file));
            put("line", json!(line));
            put("column", json!(column));
            put("length", json!(length));
        }
        if !self.notes.is_empty() {
            let note = |(message, Place { file, line, column, length }): &(String, Place)| json!({ "message": message, "file": file, "line": line, "column": column, "length": length });
            put("notes", self.notes.iter().map(note).collect());
        }
        object
    }
}

impl Place {
    fn of(span: &std::ops::Range<usize>, sources: &Sources) -> Self {
        let (file, text, span) = sources.locate(span);
        let start = boundary(text, span.start);
        let end = boundary(text, span.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        Place {
            file: file.to_string(),
            line: text[..line_start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            length: text[start..end].chars().count().max(1),
        }
    }
}

/// The nearest place at or before `offset` where a character begins.
fn boundary(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}
