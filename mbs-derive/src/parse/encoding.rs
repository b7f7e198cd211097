//! Bytes → text.

use crate::diagnostic::{Code, Diagnostics};

/// The text of a file.
///
/// # Errors
/// A report, as [`Diagnostics::render`] writes it, where the bytes are not UTF-8.
pub fn text(file_name: &str, bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let mut errors = Diagnostics::default();
        // Up to the first wrong byte both texts are the same.
        let shown = String::from_utf8_lossy(&bytes);
        errors
            .error(Code::NotText, at..at + char::REPLACEMENT_CHARACTER.len_utf8(), "this is not UTF-8 text")
            .help(help(&bytes, at));
        errors.render(file_name, &shown)
    })
}

fn help(bytes: &[u8], at: usize) -> String {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return "it looks like UTF-16: save the file as UTF-8".to_string();
    }
    match char::from(bytes[at]) {
        c if c.is_control() => "save the file as UTF-8".to_string(),
        c => format!("save the file as UTF-8; this byte was probably meant as `{c}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_bytes_are_shown_where_they_stand() {
        assert_eq!(text("a.mbs", b"mechanism".to_vec()).as_deref(), Ok("mechanism"));
        let expected = "error[MBS0101]: this is not UTF-8 text\n --> a.mbs:2:5\n  |\n2 | // 3\u{fffd}\n  |     ^\n  \
                        = help: save the file as UTF-8; this byte was probably meant as `°`\n";
        assert_eq!(text("a.mbs", b"\n// 3\xb0\n".to_vec()), Err(expected.to_string()));
        assert!(text("a.mbs", b"\xff\xfem\0".to_vec()).unwrap_err().contains("UTF-16"));
    }
}
