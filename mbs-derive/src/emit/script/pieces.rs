//! Of what all files of a language share, the part that one file needs.

/// The pieces of `shared` that `text` needs, in their order. Pieces are parted by two empty lines; each is known by the
/// first word in it that begins with `mbs_`, after its comment, and uses none but pieces before it.
pub(super) fn needed(shared: &str, comment: &str, text: &str) -> String {
    let mut chosen: Vec<&str> = Vec::new();
    for piece in shared.trim().split("\n\n\n").collect::<Vec<_>>().into_iter().rev() {
        let name = name(piece, comment);
        if uses(text, name) || chosen.iter().any(|later| uses(later, name)) {
            chosen.push(piece);
        }
    }
    chosen.iter().rev().map(|piece| format!("{}\n\n", piece.trim())).collect()
}

fn name<'p>(piece: &'p str, comment: &str) -> &'p str {
    let is_comment = |line: &&str| line.starts_with(comment) || line.starts_with([' ', '/', '@']);
    let line = piece.lines().find(|line| !is_comment(line)).expect("a definition");
    let rest = &line[line.find("mbs_").expect("a name")..];
    &rest[..rest.find(|c: char| !is_word(c)).unwrap_or(rest.len())]
}

/// Whether a word is in the text.
pub(super) fn uses(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| !text[at + word.len()..].starts_with(is_word))
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
