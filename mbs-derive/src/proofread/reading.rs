//! What reading gives: a value, or what is wrong with the text.

/// A value, or what is wrong with the text.
pub(super) type Reading<T> = Result<T, String>;

/// A text that is not known, or its beginning.
pub(super) fn cannot_read(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let short: String = text.chars().take(100).collect();
    format!("`{short}{}` cannot be read", if short.len() < text.len() { "…" } else { "" })
}

pub(super) fn unknown<T>(text: &str) -> Reading<T> {
    Err(cannot_read(text))
}
