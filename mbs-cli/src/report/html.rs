//! Elements of HTML.

/// A text whose characters mean themselves.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A text with its `code` and its *emphasis*.
pub(super) fn prose(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(['`', '*']) {
        let (before, from) = rest.split_at(start);
        let (mark, inside) = from.split_at(1);
        html += &escaped(before);
        let begins = mark == "`" || before.is_empty() || before.ends_with([' ', '(', '\n']);
        let end = inside.find(mark).filter(|&end| begins && end > 0 && !inside.starts_with(' '));
        rest = match end {
            Some(end) => {
                let tag = if mark == "`" { "code" } else { "em" };
                html += &format!("<{tag}>{}</{tag}>", escaped(&inside[..end]));
                &inside[end + 1..]
            }
            None => {
                html += mark;
                inside
            }
        };
    }
    html + &escaped(rest)
}

/// Doc comments, whose empty lines begin paragraphs.
pub(super) fn paragraphs(docs: &[String]) -> String {
    // An empty doc comment is an empty line.
    let text: Vec<&str> = docs.iter().flat_map(|doc| doc.split('\n')).map(str::trim).collect();
    let text = text.join("\n");
    let paragraphs = text.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty());
    paragraphs.map(|paragraph| format!("<p>{}</p>\n", prose(paragraph))).collect()
}

pub(super) fn code(text: &str) -> String {
    format!("<code>{}</code>", escaped(text))
}

/// Rows of cells that are HTML; columns from `numbers` on stand to the right.
pub(super) fn table(head: &[String], rows: &[Vec<String>], numbers: usize) -> String {
    let class = |column: usize| if column >= numbers { " class=\"number\"" } else { "" };
    let cells = |row: &[String], tag: &str| -> String {
        row.iter().enumerate().map(|(i, cell)| format!("<{tag}{}>{cell}</{tag}>", class(i))).collect()
    };
    let body: String = rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(row, "td"))).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{body}</tbody></table></div>\n",
        cells(head, "th")
    )
}

/// A section of the page with its heading.
pub(super) fn section(id: &str, title: &str, body: &str) -> String {
    format!("<section id=\"{id}\">\n<h2>{title}</h2>\n{body}</section>\n")
}

/// A number with as many digits as anybody reads.
pub(super) fn number(x: f64) -> String {
    let size = x.abs();
    let text = if x == 0.0 {
        "0".to_string()
    } else if (1e-3..1e6).contains(&size) {
        let digits = (6 - 1 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{x:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
    } else {
        let text = format!("{x:.5e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        format!("{digits}·10<sup>{}</sup>", power.replace('-', "−"))
    };
    text.replace('-', "−")
}

/// A small number by its order: two digits and a power of ten.
pub(super) fn size(x: f64) -> String {
    if !x.is_finite() {
        return "–".to_string();
    }
    let text = format!("{x:.1e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    if x == 0.0 { "0".to_string() } else { format!("{digits}·10<sup>{}</sup>", power.replace('-', "−")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (9.81, "9.81"),
            (-0.25, "−0.25"),
            (1200.0, "1200"),
            (1.0 / 3.0, "0.333333"),
            (5.9722e24, "5.9722·10<sup>24</sup>"),
            (-6.6743e-11, "−6.6743·10<sup>−11</sup>"),
            (999_999.5, "1000000"),
        ] {
            assert_eq!(number(x), text);
        }
        assert_eq!(size(f64::NAN), "–");
        assert_eq!(size(2.34e-16), "2.3·10<sup>−16</sup>");
    }

    #[test]
    fn code_is_marked_and_characters_mean_themselves() {
        assert_eq!(prose("a `b<c` d"), "a <code>b&lt;c</code> d");
        assert_eq!(prose("it`s <b>"), "it`s &lt;b&gt;");
        assert_eq!(prose("(*A book*) 2*3 and *4"), "(<em>A book</em>) 2*3 and *4");
        assert_eq!(paragraphs(&["one".into(), "".into(), "two".into()]), "<p>one</p>\n<p>two</p>\n");
    }
}
