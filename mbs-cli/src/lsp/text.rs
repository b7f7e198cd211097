//! Positions as editors count them: lines, and units of UTF-16 within a line.

use std::ops::Range;

use lsp_types::{Position, TextDocumentContentChangeEvent};

/// The text of a file with where its lines begin.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) text: String,
    starts: Vec<usize>,
}

impl Text {
    pub(super) fn new(text: String) -> Self {
        let bytes = text.as_bytes();
        let ends_line = |i: &usize| bytes[*i] == b'\n' || bytes[*i] == b'\r' && bytes.get(i + 1) != Some(&b'\n');
        let starts = std::iter::once(0).chain((0..bytes.len()).filter(ends_line).map(|i| i + 1)).collect();
        Text { text, starts }
    }

    /// Bytes before a position; behind the end of a line its end is meant, behind the last line the end.
    pub(super) fn offset(&self, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else { return self.text.len() };
        let end = self.starts.get(line + 1).copied().unwrap_or(self.text.len());
        let mut units = position.character as usize;
        for (at, c) in self.text[start..end].char_indices() {
            // A position within a character is before it.
            if units < c.len_utf16() || matches!(c, '\n' | '\r') {
                return start + at;
            }
            units -= c.len_utf16();
        }
        end
    }

    pub(super) fn position(&self, offset: usize) -> Position {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|&start| start <= offset) - 1;
        let character: usize = self.text[self.starts[line]..offset].chars().map(char::len_utf16).sum();
        Position { line: line as u32, character: character as u32 }
    }

    pub(super) fn range(&self, span: &Range<usize>) -> lsp_types::Range {
        lsp_types::Range { start: self.position(span.start), end: self.position(span.end.max(span.start)) }
    }

    pub(super) fn span(&self, range: lsp_types::Range) -> Range<usize> {
        let (start, end) = (self.offset(range.start), self.offset(range.end));
        start.min(end)..start.max(end)
    }

    /// Takes a change of the editor's.
    pub(super) fn change(&mut self, change: TextDocumentContentChangeEvent) {
        let mut text = std::mem::take(&mut self.text);
        match change.range {
            Some(range) => {
                let span = Text { text, starts: std::mem::take(&mut self.starts) };
                let place = span.span(range);
                text = span.text;
                text.replace_range(place, &change.text);
            }
            None => text = change.text,
        }
        *self = Text::new(text);
    }

    pub(super) fn whole(&self) -> lsp_types::Range {
        self.range(&(0..self.text.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, character: u32) -> Position {
        Position { line, character }
    }

    #[test]
    fn columns_are_units_of_utf_16() {
        let text = Text::new("q̇ = 𝛉;\r\nx\ry\n".to_string());
        // A combining dot is a character of its own, a mathematical letter takes two units.
        for (position, offset) in
            [(at(0, 0), 0), (at(0, 2), 3), (at(0, 5), 6), (at(0, 7), 10), (at(1, 0), 13), (at(2, 0), 15)]
        {
            assert_eq!(text.offset(position), offset, "{position:?}");
            assert_eq!(text.position(offset), position, "{offset}");
        }
        assert_eq!(text.offset(at(0, 6)), 6, "within a letter");
        assert_eq!(text.offset(at(0, 99)), 11, "behind the end of the line");
        assert_eq!(text.offset(at(99, 0)), text.text.len());
        assert_eq!(text.position(8), at(0, 5), "no boundary of characters");
        assert_eq!(text.position(999), at(3, 0));
        assert_eq!(Text::new(String::new()).whole(), lsp_types::Range { start: at(0, 0), end: at(0, 0) });
    }

    #[test]
    fn changes_are_taken() {
        let mut text = Text::new("one\ntwo\n".to_string());
        let change = |start, end, with: &str| TextDocumentContentChangeEvent {
            range: Some(lsp_types::Range { start, end }),
            range_length: None,
            text: with.to_string(),
        };
        text.change(change(at(0, 3), at(1, 1), "-"));
        assert_eq!(text.text, "one-wo\n");
        text.change(change(at(0, 99), at(0, 1), "𝛉"));
        assert_eq!(text.text, "o𝛉\n");
        text.change(change(at(7, 0), at(7, 9), "end"));
        assert_eq!(text.text, "o𝛉\nend");
        assert_eq!(text.position(text.text.len()), at(1, 3));
        text.change(TextDocumentContentChangeEvent { range: None, range_length: None, text: "new".to_string() });
        assert_eq!(text.text, "new");
    }
}
