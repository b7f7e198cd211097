//! Of what all files of a language share, the part that one file needs.

/// The pieces of `shared` that `text` needs, in their order. Pieces are parted by two empty lines; each is known by the
/// first word in it that begins with `mbs_`, after its comment.
pub(super) fn needed(shared: &str, comment: &str, text: &str) -> String {
    let pieces: Vec<(&str, &str)> = pieces(shared).map(|piece| (name(piece, comment), piece)).collect();
    let mut chosen = vec![false; pieces.len()];
    loop {
        let is_used = |name: &str| {
            let others = pieces.iter().zip(&chosen).filter(|((other, _), chosen)| **chosen && *other != name);
            uses(text, name) || others.into_iter().any(|((_, piece), _)| uses(piece, name))
        };
        let found: Vec<bool> = pieces.iter().map(|(name, _)| is_used(name)).collect();
        if found == chosen {
            break;
        }
        chosen = found;
    }
    let chosen = pieces.iter().zip(chosen).filter(|(_, chosen)| *chosen);
    chosen.map(|((_, piece), _)| format!("{piece}\n\n")).collect()
}

/// All pieces of what files share.
pub(in crate::emit) fn pieces(shared: &str) -> impl Iterator<Item = &str> {
    shared.trim().split("\n\n\n").map(str::trim)
}

fn name<'p>(piece: &'p str, comment: &str) -> &'p str {
    let is_comment = |line: &&str| line.starts_with(comment) || line.starts_with([' ', '/', '@']);
    let line = piece.lines().find(|line| !is_comment(line)).expect("a definition");
    let rest = &line[line.find("mbs_").expect("a name")..];
    &rest[..rest.find(|c: char| !is_word(c)).unwrap_or(rest.len())]
}

/// Whether a word is in the text.
pub(super) fn uses(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| {
        let is_within = |c: Option<char>| c.is_some_and(is_word);
        !is_within(text[..at].chars().next_back()) && !is_within(text[at + word.len()..].chars().next())
    })
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_by_what_is_used_is_needed() {
        let shared = "// one\nfunction mbs_a() {}\n\n\nfunction mbs_ab() { mbs_c(); }\n\n\nconst mbs_c = 1;";
        assert_eq!(needed(shared, "//", "mbs_ab()"), "function mbs_ab() { mbs_c(); }\n\nconst mbs_c = 1;\n\n");
        assert_eq!(needed(shared, "//", "mbs_a(1)"), "// one\nfunction mbs_a() {}\n\n");
        assert_eq!(needed(shared, "//", "mbs_abc"), "");
    }
}
