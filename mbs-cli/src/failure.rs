//! Why a command ends with exit code 1.

use std::fmt::Display;

/// The model or the input is bad: what standard error shall say.
#[derive(Debug)]
pub(crate) struct Failure(String);

impl Failure {
    /// A message without a place in a model's source: lower case, no full stop.
    pub(crate) fn new(message: impl Display) -> Self {
        Failure(format!("error: {message}\n"))
    }

    /// Several messages, all to be seen at once. More than twenty are not read anyway.
    pub(crate) fn several(messages: &[String]) -> Self {
        const SHOWN: usize = 20;
        let mut report: String = messages.iter().take(SHOWN).map(|message| format!("error: {message}\n")).collect();
        if messages.len() > SHOWN {
            report += &format!("… and {} more\n", messages.len() - SHOWN);
        }
        Failure(report)
    }

    /// A finished report, as the generator renders it.
    pub(crate) fn rendered(report: String) -> Self {
        Failure(report)
    }

    /// The text for standard error.
    pub(crate) fn report(&self) -> &str {
        &self.0
    }
}
