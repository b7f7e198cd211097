//! Why a command ends with exit code 1.

use std::fmt::Display;

use mbs_derive::diagnostic::Severity;

use crate::message::Messages;

/// The model or the input is bad: what standard error shall say.
#[derive(Debug)]
pub(crate) struct Failure(Messages);

impl Failure {
    /// A message without a place in a model's source: lower case, no full stop.
    pub(crate) fn new(message: impl Display) -> Self {
        Failure(Messages::plain(Severity::Error, message))
    }

    /// Several messages, all to be seen at once.
    pub(crate) fn several(messages: &[String]) -> Self {
        Failure(Messages::several(Severity::Error, messages))
    }

    /// The message alone, for where it becomes a part of something else.
    pub(crate) fn text(&self) -> String {
        self.0.plain_text()
    }

    /// What standard error says.
    pub(crate) fn messages(&self) -> &Messages {
        &self.0
    }
}

impl From<Messages> for Failure {
    fn from(messages: Messages) -> Self {
        Failure(messages)
    }
}
