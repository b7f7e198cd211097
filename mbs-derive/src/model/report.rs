//! What has been said about a declaration, and from which calls.

use std::collections::HashSet;

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::model::check::Place;
use crate::model::names::function::{Call, Home};
use crate::model::value::evaluate::Refused;
use crate::span::Span;

/// Calls that a message about the body of a function shows.
const MAX_NOTES: usize = 3;

/// Messages, each once.
#[derive(Debug, Default)]
pub(in crate::model) struct Report {
    pub(in crate::model) errors: Diagnostics,
    /// What has been said, and where: loops would repeat it.
    said: HashSet<(usize, usize, String)>,
    /// The calls that are being made, the outermost first.
    pub(in crate::model) calls: Vec<Call>,
    /// Whether statements were passed over because of an error: what they would have done is not known.
    pub(in crate::model) gave_up: bool,
}

impl Report {
    /// Notes an error, once: in a function together with the calls that led there.
    pub(in crate::model) fn refuse(
        &mut self,
        code: Code,
        span: &Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Refused {
        let (mut message, help) = (message.into(), help.into());
        let (place, calls) = self.place(span);
        if let Some(call) = self.calls.iter().find(|call| call.home == Home::Library) {
            message = format!("in `{}`: {message}", call.name);
        }
        if self.said.insert((place.start, place.end, message.clone())) {
            let error = self.errors.error(code, place, message);
            if !help.is_empty() {
                error.help(help);
            }
            for (call, what) in calls {
                error.note(call, what);
            }
        }
        Refused
    }

    /// Whether this has been said about this place; from now on it has.
    pub(in crate::model) fn has_said(&mut self, place: &Span, what: &str) -> bool {
        !self.said.insert((place.start, place.end, what.to_string()))
    }

    /// Notes an error about what was built before, with the calls that had led there.
    pub(in crate::model) fn refuse_at(
        &mut self,
        code: Code,
        at: &Place,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        let (message, help) = (message.into(), help.into());
        let same: Vec<usize> = at.calls.iter().map(|(call, _)| call.start).collect();
        if self.said.insert((at.span.start, at.span.end, format!("{message} {same:?}"))) {
            let error = self.errors.error(code, at.span.clone(), message);
            if !help.is_empty() {
                error.help(help);
            }
            for (call, what) in &at.calls {
                error.note(call.clone(), what);
            }
        }
    }

    /// Notes a warning about what was built before, with the calls that had led there.
    pub(in crate::model) fn warn_at(&mut self, code: Code, at: &Place, message: impl Into<String>) -> &mut Diagnostic {
        let warning = self.errors.warning(code, at.span.clone(), message);
        for (call, what) in &at.calls {
            warning.note(call.clone(), what);
        }
        warning
    }

    /// This place, for messages that come when all is built.
    pub(in crate::model) fn here(&self, span: &Span) -> Place {
        let (span, calls) = self.place(span);
        Place { span, calls }
    }

    /// Where a message about this place is shown, and the calls that led there, the innermost first.
    pub(in crate::model) fn place(&self, span: &Span) -> (Span, Vec<(Span, String)>) {
        // Nobody can look into a library function: the call of it is the place.
        let own = self.calls.iter().take_while(|call| call.home != Home::Library).count();
        let place = self.calls.get(own).map_or(span, |call| &call.span).clone();
        let calls = self.calls[..own].iter().rev().take(MAX_NOTES);
        (place, calls.map(|call| (call.span.clone(), call.described())).collect())
    }
}
