//! The page of LaTeX → HTML with MathML Core, which browsers set by themselves.
//!
//! It reads what this folder writes, and knows the commands that occur there and no others; a formula with another one
//! stands there as it was written.
//!
//! - [`formula`]: one formula;
//! - here: headings, prose, tables and aligned equations.

mod formula;

use formula::formula;

/// What stands between `\begin{document}` and `\end{document}` as HTML: `h3` and `h4` headings, paragraphs, a table of
/// symbols (class `symbols`), and tables of equations (class `align`), a row for each line.
pub(crate) fn html(latex: &str) -> String {
    let body = latex.split_once("\\begin{document}").map_or(latex, |(_, body)| body);
    let mut rest = body.split_once("\\end{document}").map_or(body, |(body, _)| body);
    let mut html = String::new();
    while let Some((start, block)) = next_block(rest) {
        html += &paragraphs(rest[..start].trim_end_matches("{\\allowdisplaybreaks\n"));
        let inside = &rest[start..];
        let end = inside.find(block.end).map_or(inside.len(), |end| end + block.end.len());
        html += &(block.write)(inside[..end].trim_start_matches(block.begin).trim_end_matches(block.end));
        // The brace that `\allowdisplaybreaks` was in.
        rest = inside[end..].strip_prefix('}').unwrap_or(&inside[end..]);
    }
    html + &paragraphs(rest)
}

/// What is no prose.
struct Block {
    begin: &'static str,
    end: &'static str,
    write: fn(&str) -> String,
}

const BLOCKS: [Block; 2] = [
    Block { begin: "\\begin{align*}", end: "\\end{align*}", write: aligned },
    Block { begin: "\\begin{small}", end: "\\end{small}", write: symbols },
];

fn next_block(text: &str) -> Option<(usize, Block)> {
    BLOCKS.into_iter().filter_map(|block| Some((text.find(block.begin)?, block))).min_by_key(|(start, _)| *start)
}

/// Lines of an `align*`: what stands before the first `&` to the right, the rest to the left.
fn aligned(body: &str) -> String {
    let lines = split(body, "\\\\").into_iter().map(|line| {
        let parts = split(line, "&");
        let right = parts[1..].join(" ");
        format!("<tr><td>{}</td><td>{}</td></tr>\n", formula(parts[0]), formula(&right))
    });
    format!("<table class=\"align\">\n{}</table>\n", lines.collect::<String>())
}

/// Parts between separators that stand outside of braces and environments.
fn split<'a>(latex: &'a str, separator: &str) -> Vec<&'a str> {
    let (mut parts, mut depth, mut start, mut at) = (Vec::new(), 0_i32, 0, 0);
    while let Some(first) = latex[at..].chars().next() {
        let rest = &latex[at..];
        let length = if first == '\\' {
            let name = rest[1..].find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len() - 1);
            1 + name.max(rest[1..].chars().next().map_or(0, char::len_utf8))
        } else {
            first.len_utf8()
        };
        match &rest[..length] {
            "{" | "\\begin" => depth += 1,
            "}" | "\\end" => depth -= 1,
            token if token == separator && depth == 0 => {
                parts.push(&latex[start..at]);
                start = at + length;
            }
            _ => {}
        }
        at += length;
    }
    parts.push(&latex[start..]);
    parts
}

/// The table of symbols, its head first.
fn symbols(body: &str) -> String {
    let rows = body.lines().filter_map(|line| line.trim_end_matches("\\hline").trim_end().strip_suffix("\\\\"));
    let rows = rows.map(str::trim).enumerate().map(|(number, row)| {
        let tag = if number == 0 { "th" } else { "td" };
        let cells = cells(row);
        let cells = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", prose(cell.trim())));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    });
    format!("<table class=\"symbols\">\n{}</table>\n", rows.collect::<String>())
}

/// Between `&` that are no `\&`.
fn cells(row: &str) -> Vec<&str> {
    let (mut cells, mut start) = (Vec::new(), 0);
    for (at, _) in row.match_indices('&').filter(|(at, _)| !row[..*at].ends_with('\\')) {
        cells.push(&row[start..at]);
        start = at + 1;
    }
    cells.push(&row[start..]);
    cells
}

fn paragraphs(text: &str) -> String {
    let mut html = String::new();
    for part in text.split("\n\n").map(str::trim).filter(|part| !part.is_empty()) {
        html += &paragraph(part);
    }
    html
}

/// Headings are in braces that may hold others.
fn paragraph(part: &str) -> String {
    let heading = [("\\section*", "h3"), ("\\paragraph", "h4")]
        .into_iter()
        .find_map(|(command, tag)| Some((tag, group(part.strip_prefix(command)?)?)));
    let Some((tag, (title, rest))) = heading else { return format!("<p>{}</p>\n", prose(part)) };
    let rest = rest.trim();
    let rest = if rest.is_empty() { String::new() } else { format!("<p>{}</p>\n", prose(rest)) };
    format!("<{tag}>{}</{tag}>\n{rest}", prose(title))
}

/// What is in the braces with which a text begins, and what is behind them.
fn group(text: &str) -> Option<(&str, &str)> {
    let inside = text.strip_prefix('{')?;
    let (mut depth, mut is_escaped) = (1, false);
    for (at, c) in inside.char_indices() {
        match c {
            _ if is_escaped => {}
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        is_escaped = c == '\\' && !is_escaped;
        if depth == 0 {
            return Some((&inside[..at], &inside[at + 1..]));
        }
    }
    None
}

/// Prose with formulas in dollars, or in `\ensuremath`.
fn prose(text: &str) -> String {
    const STYLES: [(&str, &str, &str); 2] = [("\\emph", "<em>", "</em>"), ("\\texttt", "<code>", "</code>")];
    let mut html = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(['$', '\\']) {
        html += &words(&rest[..start]);
        rest = &rest[start..];
        let styled = STYLES.into_iter().find_map(|(command, open, close)| {
            let (inside, behind) = group(rest.strip_prefix(command)?)?;
            Some((open, inside, close, behind))
        });
        if let Some((inside, behind)) = rest.strip_prefix('$').and_then(|inside| inside.split_once('$')) {
            html += &formula(inside);
            rest = behind;
        } else if let Some((inside, behind)) = rest.strip_prefix("\\ensuremath").and_then(group) {
            html += &formula(inside);
            rest = behind;
        } else if let Some((open, inside, close, behind)) = styled {
            // Words alone stand inside, and formulas that hold no others.
            html += &format!("{open}{}{close}", plain(inside));
            rest = behind;
        } else {
            let (character, behind) = character(rest);
            html += &words(character);
            rest = behind;
        }
    }
    html + &words(rest)
}

/// The inside of `\texttt` and `\emph`.
fn plain(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some(start) = rest.find('\\') {
        html += &words(&rest[..start]);
        rest = &rest[start..];
        if let Some((inside, behind)) = rest.strip_prefix("\\ensuremath").and_then(group) {
            html += &formula(inside);
            rest = behind;
        } else {
            let (character, behind) = character(rest);
            html += &words(character);
            rest = behind;
        }
    }
    html + &words(rest)
}

/// The character that a command stands for, and what is behind it.
fn character(text: &str) -> (&str, &str) {
    const NAMED: [(&str, &str); 4] =
        [("\\textbackslash{}", "\\"), ("\\textasciitilde{}", "∼"), ("\\textasciicircum{}", "^"), ("\\dots{}", "…")];
    if let Some((name, letter)) = NAMED.into_iter().find(|(name, _)| text.starts_with(name)) {
        return (letter, &text[name.len()..]);
    }
    // `\_` is `_`.
    let rest = text.strip_prefix('\\').unwrap_or(text);
    let length = rest.chars().next().map_or(0, char::len_utf8);
    rest.split_at(length)
}

/// Characters that mean themselves, and dashes.
fn words(text: &str) -> String {
    escaped(&text.replace("---", "—").replace("--", "–").replace('~', "\u{a0}"))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_becomes_headings_prose_and_tables() {
        let latex = "\\documentclass{article}\n\\begin{document}\n\n\\section*{A\\_B}\nA \\emph{bob}, $m_1$.\n\n\
                     \\paragraph{Symbols.} $x$.\n\n\\begin{small}\n\\begin{tabular}{ll}\n  symbol & unit \\\\ \\hline\n  \
                     $m$ & kg \\& more \\\\\n\\end{tabular}\n\\end{small}\n\n\\paragraph{Terms.}\n{\\allowdisplaybreaks\n\
                     \\begin{align*}\n  T &= 1 \\\\\n  &\\quad + x\n\\end{align*}}\nToo long -- \\texttt{a\\_b}.\n\n\
                     \\end{document}\n";
        let html = html(latex);
        let open =
            "<h3>A_B</h3>\n<p>A <em>bob</em>, <math><mrow><msub><mi>m</mi><mn>1</mn></msub></mrow></math>.</p>\n";
        assert!(html.starts_with(open), "{html}");
        assert!(html.contains("<tr><th>symbol</th><th>unit</th></tr>"), "{html}");
        assert!(html.contains("<td>kg &amp; more</td>"), "{html}");
        assert_eq!(html.matches("<tr><td><math>").count(), 3, "{html}");
        assert!(html.ends_with("<p>Too long – <code>a_b</code>.</p>\n"), "{html}");
        assert!(!html.contains('\\'), "{html}");
    }

    #[test]
    fn what_is_escaped_means_itself() {
        assert_eq!(prose(r"50 \% of m\_1 \& \#2 \{x\} \$"), "50 % of m_1 &amp; #2 {x} $");
        assert_eq!(prose(r"a\textbackslash{}b \dots{}"), "a\\b …");
        assert_eq!(prose(r"open $ and \texttt{never closed"), r"open $ and texttt{never closed");
    }
}
