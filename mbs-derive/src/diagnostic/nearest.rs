//! What a name was probably meant to be.

/// [`Diagnostic::nearest`].
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name: Vec<char> = name.chars().flat_map(char::to_lowercase).collect();
    let allowed = name.len().max(3) / 3;
    let close = candidates.into_iter().filter_map(|candidate| {
        let letters: Vec<char> = candidate.chars().flat_map(char::to_lowercase).collect();
        let worth_it = letters.len().abs_diff(name.len()) <= allowed && name.len() <= 64;
        let slips = if worth_it { slips(&name, &letters) } else { usize::MAX };
        (slips <= allowed && slips < letters.len()).then_some((slips, candidate))
    });
    close.min_by_key(|&(slips, _)| slips).map(|(_, candidate)| candidate)
}

/// Optimal string alignment distance: Levenshtein's, and an exchange of neighbours counts once.
fn slips(a: &[char], b: &[char]) -> usize {
    let mut distance = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            distance[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = distance[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let exchanged = if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    distance[i - 2][j - 2] + 1
                } else {
                    usize::MAX
                };
                replaced.min(exchanged).min(distance[i - 1][j] + 1).min(distance[i][j - 1] + 1)
            };
        }
    }
    distance[a.len()][b.len()]
}
