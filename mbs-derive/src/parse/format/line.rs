//! Lines of a formatted text: what neighbouring lines have in one column, and the text that they make.

use std::ops::Range;

/// A line without its line break.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) indent: usize,
    /// What stands on it; a comment of several lines has line breaks in it.
    pub(super) text: String,
    pub(super) is_behind_blank: bool,
    /// Nothing but a comment.
    pub(super) is_remark: bool,
    /// The `+=` of its statement, if the statement begins on this line.
    pub(super) addition: Option<Addition>,
    /// The comment behind it.
    pub(super) comment: Option<Comment>,
}

/// `+=`, and how it stood.
#[derive(Debug)]
pub(super) struct Addition {
    /// Where it stands in the text of the line, in bytes.
    pub(super) at: usize,
    /// How many characters of the statement were before it.
    pub(super) column: usize,
    /// Whether more than one blank was before it.
    pub(super) is_padded: bool,
}

/// A comment behind what it is about, and how it stood.
#[derive(Debug)]
pub(super) struct Comment {
    pub(super) text: String,
    /// How many blanks were before it, at least one.
    pub(super) gap: usize,
    /// How many characters of its line were before it.
    pub(super) column: usize,
}

impl Line {
    pub(super) fn new(indent: usize, text: String) -> Self {
        Line { indent, text, is_behind_blank: false, is_remark: false, addition: None, comment: None }
    }

    /// How many characters the last line of its text has.
    fn width(&self) -> usize {
        match self.text.rsplit_once('\n') {
            Some((_, last)) => last.chars().count(),
            None => self.indent + self.text.chars().count(),
        }
    }
}

/// The text of all lines: neighbours whose `+=` or comments were in one column have them in one column.
pub(super) fn aligned(mut lines: Vec<Line>) -> String {
    // A comment between them is about the second.
    let additions = |line: &Line| line.addition.as_ref().map(|addition| (line.indent, addition.column));
    for run in runs(&lines, additions, |line| line.is_remark) {
        let run = &mut lines[run];
        let before = |line: &Line| line.addition.as_ref().map_or(0, |a| line.text[..a.at].chars().count());
        let is_padded = |line: &Line| line.addition.as_ref().is_some_and(|addition| addition.is_padded);
        if run.len() == 1 || !run.iter().any(is_padded) {
            continue;
        }
        let widest = run.iter().map(before).max().unwrap_or(0);
        for line in run {
            let padding = widest - before(line);
            if let Some(addition) = &line.addition {
                line.text.insert_str(addition.at, &" ".repeat(padding));
            }
        }
    }
    let comments = |line: &Line| line.comment.as_ref().map(|comment| comment.column);
    for run in runs(&lines, comments, |_| false) {
        let run = &mut lines[run];
        let widest = run.iter().map(Line::width).max().unwrap_or(0);
        let nearest = run.iter().filter_map(|line| line.comment.as_ref()).map(|comment| comment.gap).min().unwrap_or(1);
        for line in run {
            let gap = widest + nearest - line.width();
            if let Some(comment) = &mut line.comment {
                comment.gap = gap;
            }
        }
    }
    let mut text = String::new();
    for line in &lines {
        text += if line.is_behind_blank { "\n" } else { "" };
        text += &format!("{:1$}{2}", "", line.indent, line.text);
        if let Some(comment) = &line.comment {
            text += &format!("{:1$}{2}", "", comment.gap, comment.text);
        }
        text.push('\n');
    }
    text
}

/// Neighbouring lines that have something in common, first and last; lines that are passed over may stand in between.
fn runs<T: PartialEq>(
    lines: &[Line],
    common: impl Fn(&Line) -> Option<T>,
    is_passed: impl Fn(&Line) -> bool,
) -> Vec<Range<usize>> {
    let mut runs: Vec<(Range<usize>, T)> = Vec::new();
    // Where the next line must stand to go on with the last run.
    let mut next = 0;
    for (i, line) in lines.iter().enumerate() {
        let is_near = next == i && !line.is_behind_blank;
        match common(line) {
            Some(own) => {
                match runs.last_mut().filter(|(_, other)| is_near && *other == own) {
                    Some((run, _)) => run.end = i + 1,
                    None => runs.push((i..i + 1, own)),
                }
                next = i + 1;
            }
            None if is_near && is_passed(line) => next = i + 1,
            None => {}
        }
    }
    runs.into_iter().map(|(run, _)| run).collect()
}
