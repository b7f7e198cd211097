//! Pages of the book, `docs/`: their fenced blocks, links and headings. `tests/generator/book.rs` reads them with this,
//! too.
#![allow(dead_code)] // Each of the two takes a part.

use std::path::{Path, PathBuf};
use std::{fs, iter};

/// A page, by its path below `docs/`.
pub(crate) struct Page {
    pub(crate) name: String,
    pub(crate) text: String,
}

/// A fenced block.
#[derive(Debug, PartialEq)]
pub(crate) struct Block {
    /// The line of its first line, from 1.
    pub(crate) line: usize,
    /// `rust` of ` ```rust,build.rs`.
    pub(crate) kind: String,
    /// `build.rs` of it.
    pub(crate) argument: String,
    /// The reason in `<!-- not run: … -->` on the line before the fence.
    pub(crate) not_run: Option<String>,
    pub(crate) text: String,
}

/// The pages of the book in the order of `SUMMARY.md`, but for those that are not written yet, `[Title]()`; `None`
/// where there is no such book.
pub(crate) fn pages(docs: &Path) -> Option<Vec<Page>> {
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).ok()?;
    let page = |name: String| {
        let text = fs::read_to_string(docs.join(&name)).unwrap_or_else(|error| panic!("docs/{name}: {error}"));
        Page { name, text }
    };
    let targets = links(&summary).into_iter().map(|(_, target)| target);
    Some(targets.filter(|target| !target.is_empty()).map(page).collect())
}

/// Files of a folder and the folders in it that end with `.md`.
pub(crate) fn markdown_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            found.append(&mut markdown_below(&path));
        } else if path.extension().is_some_and(|end| end == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The fenced blocks of a text.
pub(crate) fn blocks(text: &str) -> Vec<Block> {
    let (mut found, mut open): (_, Option<Block>) = (Vec::new(), None);
    let mut before = "";
    for (number, line) in (1..).zip(text.lines()) {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(fence)) => {
                let (kind, argument) = fence.split_once([',', ' ']).unwrap_or((fence, ""));
                let reason = before.strip_prefix("<!-- not run: ").and_then(|rest| rest.strip_suffix(" -->"));
                open = Some(Block {
                    line: number + 1,
                    kind: kind.to_string(),
                    argument: argument.to_string(),
                    not_run: reason.map(String::from),
                    text: String::new(),
                });
            }
            (Some(_), Some("")) => found.extend(open.take()),
            (Some(block), _) => block.text.extend([line, "\n"]),
            (None, None) => {}
        }
        before = line;
    }
    assert!(open.is_none(), "a block is not closed: {open:?}");
    found
}

/// The lines outside fenced blocks, numbered, without what stands in backquotes.
fn prose(text: &str) -> Vec<(usize, String)> {
    let mut is_code = false;
    let lines = (1..).zip(text.lines()).filter(|(_, line)| {
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        !is_fence && !is_code
    });
    // What stands between an odd backquote and the next one is code; none of it goes over the end of a line.
    lines.map(|(number, line)| (number, line.split('`').step_by(2).collect::<Vec<_>>().join("``"))).collect()
}

/// Targets of the links and images of a text, with their lines.
pub(crate) fn links(text: &str) -> Vec<(usize, String)> {
    let of_line = |(number, line): (usize, String)| {
        let targets: Vec<String> =
            line.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0.to_string())).collect();
        targets.into_iter().map(move |target| (number, target))
    };
    prose(text).into_iter().flat_map(of_line).collect()
}

/// Anchors of the headings of a text, as code hosts and mdBook make them.
pub(crate) fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut is_code = false;
    for line in text.lines() {
        is_code ^= line.starts_with("```");
        let title = line.trim_start_matches('#');
        let depth = line.len() - title.len();
        if is_code || depth == 0 || depth > 6 || !title.starts_with(' ') {
            continue;
        }
        let anchor: String = title.trim().chars().filter_map(in_an_anchor).collect();
        let numbered = (1..).map(|k| format!("{anchor}-{k}"));
        let anchor = iter::once(anchor.clone()).chain(numbered).find(|anchor| !found.contains(anchor));
        found.extend(anchor);
    }
    found
}

/// What becomes of a sign of a heading. A link in one would have to be read first; there is none.
fn in_an_anchor(sign: char) -> Option<char> {
    match sign {
        ' ' => Some('-'),
        '-' | '_' => Some(sign),
        _ if sign.is_alphanumeric() => sign.to_lowercase().next(),
        _ => None,
    }
}

/// Whether a text is what a block shows: `…` stands for anything within a line, and for any lines where it is alone.
pub(crate) fn is_shown(shown: &str, printed: &str) -> bool {
    let (shown, printed): (Vec<&str>, Vec<&str>) =
        (shown.trim_end().lines().collect(), printed.trim_end().lines().collect());
    lines_match(&shown, &printed)
}

fn lines_match(shown: &[&str], printed: &[&str]) -> bool {
    match shown {
        [] => printed.is_empty(),
        ["…", rest @ ..] => (0..=printed.len()).any(|k| lines_match(rest, &printed[k..])),
        [line, rest @ ..] => {
            printed.split_first().is_some_and(|(first, others)| line_matches(line, first) && lines_match(rest, others))
        }
    }
}

fn line_matches(shown: &str, printed: &str) -> bool {
    let mut parts = shown.trim_end().split('…');
    let Some(mut rest) = parts.next().and_then(|first| printed.trim_end().strip_prefix(first)) else { return false };
    let mut parts: Vec<&str> = parts.collect();
    let Some(last) = parts.pop() else { return rest.is_empty() };
    for part in parts {
        let Some((_, after)) = rest.split_once(part) else { return false };
        rest = after;
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_links_and_anchors_are_read() {
        let text = "# A `b.rs`: 1, _2_\n[x](a.md#b), `[y](no.md)`\n\n<!-- not run: why -->\n```sh,x y\nls [z](no.md)\n# no\n```\n\
                    ## A b\n## A b\n![p](q.svg)\n";
        let block = Block {
            line: 6,
            kind: "sh".into(),
            argument: "x y".into(),
            not_run: Some("why".into()),
            text: "ls [z](no.md)\n# no\n".into(),
        };
        assert_eq!(blocks(text), [block]);
        assert_eq!(links(text), [(2, "a.md#b".to_string()), (11, "q.svg".to_string())]);
        assert_eq!(anchors(text), ["a-brs-1-_2_", "a-b", "a-b-1"]);
    }

    #[test]
    fn what_is_left_out_is_anything() {
        assert!(
            is_shown("a … c\n", "a b c\n")
                && is_shown("…\nz", "x\ny\nz\n")
                && is_shown("…", "")
                && is_shown("a…a", "aa")
        );
        for (shown, printed) in
            [("a", "b"), ("a", "a\nb"), ("a\nb", "a"), ("a … c", "a b d"), ("…\nz", "z\ny"), ("a…a", "a")]
        {
            assert!(!is_shown(shown, printed), "{shown} is not {printed}");
        }
    }
}
