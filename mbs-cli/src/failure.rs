//! Why a command ends with exit code 1, or 2.

use std::fmt::Display;

use mbs_derive::diagnostic::Severity;

use crate::message::Messages;

/// The model or the input is bad, or the usage is wrong: what standard error shall say.
#[derive(Debug)]
pub(crate) struct Failure {
    messages: Messages,
    code: u8,
}

impl Failure {
    /// A message without a place in a model's source: lower case, no full stop.
    pub(crate) fn new(message: impl Display) -> Self {
        Messages::plain(Severity::Error, message).into()
    }

    /// Options that do not go together: lower case, no full stop.
    pub(crate) fn of_usage(message: impl Display) -> Self {
        Failure { code: 2, ..Failure::new(message) }
    }

    /// What only a program with this feature does.
    #[cfg(not(all(feature = "accuracy", feature = "lsp")))]
    pub(crate) fn of_feature(name: &str) -> Self {
        let build = format!("cargo install --path mbs-cli --features {name}");
        Failure::of_usage(format_args!("this mbs is built without its feature `{name}`: `{build}` has it"))
    }

    /// Several messages, all to be seen at once.
    pub(crate) fn several(messages: &[String]) -> Self {
        Messages::several(Severity::Error, messages).into()
    }

    /// The message alone, for where it becomes a part of something else.
    pub(crate) fn text(&self) -> String {
        self.messages.plain_text()
    }

    /// What standard error says.
    pub(crate) fn messages(&self) -> &Messages {
        &self.messages
    }

    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        self.code
    }
}

impl From<Messages> for Failure {
    fn from(messages: Messages) -> Self {
        Failure { messages, code: 1 }
    }
}
