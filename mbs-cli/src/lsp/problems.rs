//! What is wrong in a file and in those that it imports, as editors show it, with what may be written instead.

use std::collections::BTreeMap;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, Diagnostic as Shown, DiagnosticRelatedInformation,
    DiagnosticSeverity, Location, NumberOrString, TextEdit, Uri,
};
use mbs_derive::diagnostic::{Diagnostic, Severity};
use serde_json::json;

use super::documents::Documents;
use super::resolve::Files;

/// More are not read anyway.
const MOST: usize = 200;

/// A message with what may be written instead of what it is about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Problem {
    pub(super) shown: Shown,
    pub(super) fix: Option<TextEdit>,
    /// Whether others may have been meant as well.
    is_guess: bool,
}

/// The messages by the names of their files; each file that was looked at is among them.
pub(super) fn problems<'d>(
    files: &Files,
    found: impl Iterator<Item = &'d Diagnostic>,
    documents: &Documents,
) -> BTreeMap<String, Vec<Problem>> {
    let mut by_file: BTreeMap<String, Vec<Problem>> = BTreeMap::new();
    for file in &files.0 {
        by_file.entry(file.name.clone()).or_default();
    }
    let place = |span: &std::ops::Range<usize>| {
        let number = files.0.partition_point(|file| file.start <= span.start).saturating_sub(1);
        let file = &files.0[number];
        // The text of a robot's mechanism is not that of its file: what is wrong there is shown where it is imported.
        if let Some(import) = files.import_of(number) {
            return (&files.0[0], import);
        }
        (file, span.start - file.start..span.end.saturating_sub(file.start).max(span.start - file.start))
    };
    let robot = |span: &std::ops::Range<usize>| {
        let number = files.0.partition_point(|file| file.start <= span.start).saturating_sub(1);
        let file = &files.0[number];
        let place = file.text.range(&(span.start - file.start..span.start - file.start)).start;
        files.import_of(number)?;
        let name = file.name.rsplit('/').next().unwrap_or_default();
        Some(format!("`mbs import {name}`:{}:{}", place.line + 1, place.character + 1))
    };
    for diagnostic in found.take(MOST) {
        let (file, span) = place(&diagnostic.span);
        let notes = diagnostic.notes.iter().filter_map(|note| {
            let (file, span) = place(&note.span);
            let location = Location { uri: documents.uri(&file.name)?, range: file.text.range(&span) };
            Some(DiagnosticRelatedInformation { location, message: note.message.clone() })
        });
        let notes: Vec<_> = notes.collect();
        let mut message = robot(&diagnostic.span).map_or(String::new(), |place| format!("{place}: "));
        message += &diagnostic.message;
        message += &diagnostic.help.as_ref().map_or(String::new(), |help| format!("\nhelp: {help}"));
        let severity = match diagnostic.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        };
        let shown = Shown {
            range: file.text.range(&span),
            severity: Some(severity),
            code: Some(NumberOrString::String(diagnostic.code())),
            source: Some("mbs".to_string()),
            message,
            related_information: (!notes.is_empty()).then_some(notes),
            ..Shown::default()
        };
        let is_guess = diagnostic.help.as_ref().is_some_and(|help| help.starts_with("did you mean"));
        let mut own = diagnostic.clone();
        own.span = span;
        let fix = own.replacement(&file.text.text);
        let fix = fix.map(|(place, text)| TextEdit { range: file.text.range(&place), new_text: text });
        by_file.entry(file.name.clone()).or_default().push(Problem { shown, fix, is_guess });
    }
    by_file
}

/// What may be written instead, of the messages about a range.
pub(super) fn actions(uri: &Uri, problems: &[Problem], range: lsp_types::Range) -> Vec<CodeActionOrCommand> {
    let is_met = |problem: &&Problem| problem.shown.range.start <= range.end && range.start <= problem.shown.range.end;
    let action = |problem: &Problem| {
        let fix = problem.fix.as_ref()?;
        let title = match fix.range.start == fix.range.end {
            true => format!("insert `{}`", fix.new_text),
            false => format!("write `{}`", fix.new_text),
        };
        let edit = serde_json::from_value(json!({ "changes": { uri.as_str(): [fix] } })).ok()?;
        Some(CodeActionOrCommand::CodeAction(CodeAction {
            title,
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(vec![problem.shown.clone()]),
            edit: Some(edit),
            is_preferred: Some(!problem.is_guess),
            ..CodeAction::default()
        }))
    };
    problems.iter().filter(is_met).filter_map(action).collect()
}
