//! Attributes of XML.

/// ` name="value"`, with what XML would take for something else written otherwise; control characters are blanks.
pub(super) fn attribute(name: &str, value: &str) -> String {
    let mut text = format!(" {name}=\"");
    for c in value.chars() {
        match c {
            '&' => text += "&amp;",
            '<' => text += "&lt;",
            '>' => text += "&gt;",
            '"' => text += "&quot;",
            c if c.is_control() => text.push(' '),
            c => text.push(c),
        }
    }
    text + "\""
}

#[cfg(test)]
mod tests {
    #[test]
    fn attributes_hold_anything() {
        assert_eq!(super::attribute("a", "x < \"y\" &\n1"), " a=\"x &lt; &quot;y&quot; &amp; 1\"");
    }
}
