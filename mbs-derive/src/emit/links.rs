//! Statements of one link together, as a textbook writes a sweep: of the links from the base outwards, and back.
//!
//! The walk writes statements where they are first needed, which leaves few values alive but jumps between links.
//! Compilers reorder independent statements: the arm's functions take 0.87 to 1.05 of the time (docs/performance.md).

use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry};
use std::ops::Bound;

use crate::optimise::Program;

use super::statement::Statement;

/// Where fewer statements of a link than this stand together on average, their order stays, and no comment says which
/// link it is.
const FEW: usize = 4;

/// A chain of more links than these is long.
pub(super) const MANY: usize = 30;

/// Whether a program is of a long chain.
pub(super) fn are_many(program: &Program) -> bool {
    program.notes.iter().filter_map(|(_, name)| of_note(name)).any(|link| link > MANY)
}

/// The number of the link that a value with this note belongs to, by the [key](super::doc::is_of_link) to locals.
pub(super) fn of_note(note: &str) -> Option<usize> {
    let note = note.trim_start_matches("by_");
    let letters = note.split(|c: char| c.is_ascii_digit()).next()?;
    let digits = note[letters.len()..].split(|c: char| !c.is_ascii_digit()).next()?;
    super::doc::is_of_link(letters).then(|| digits.parse().ok()).flatten()
}

/// Reorders statements so that those of one link stand together, as far as their operands allow. A statement of no link
/// whose operands are known stays before those that it stood before.
///
/// `links` are those of the locals.
pub(super) fn together(statements: Vec<Statement>, links: &[Option<usize>]) -> Vec<Statement> {
    let order = order(&statements, links);
    let ordered: Vec<Statement> = order.into_iter().map(|i| statements[i].clone()).collect();
    if starts(&ordered, links).is_empty() { statements } else { ordered }
}

/// The numbers of the statements in that order.
fn order(statements: &[Statement], links: &[Option<usize>]) -> Vec<usize> {
    let binds = |(i, statement): (usize, &Statement)| statement.binds().into_iter().map(move |local| (local, i));
    let bound_by: BTreeMap<usize, usize> = statements.iter().enumerate().flat_map(binds).collect();
    let mut users = vec![Vec::new(); statements.len()];
    let mut missing = vec![0; statements.len()];
    for (i, statement) in statements.iter().enumerate() {
        let needs: BTreeSet<usize> =
            statement.reads().iter().filter_map(|local| bound_by.get(local)).copied().collect();
        missing[i] = needs.len();
        needs.into_iter().for_each(|needed| users[needed].push(i));
    }
    let group = |i: usize| statements[i].link(links);
    // Those that need nothing more, of no link and of each.
    let mut ready: BTreeMap<Option<usize>, BTreeSet<usize>> = BTreeMap::new();
    for i in (0..statements.len()).filter(|&i| missing[i] == 0) {
        ready.entry(group(i)).or_default().insert(i);
    }
    let (mut order, mut current, mut outwards) = (Vec::with_capacity(statements.len()), None, true);
    loop {
        let here = [None, current].iter().filter_map(|link| ready.get(link)?.first().copied()).min();
        let Some(next) = here.or_else(|| onward(&ready, current, &mut outwards)) else { return order };
        current = group(next).or(current);
        if let Entry::Occupied(mut group) = ready.entry(group(next)) {
            group.get_mut().remove(&next);
            if group.get().is_empty() {
                group.remove();
            }
        }
        order.push(next);
        for &user in &users[next] {
            missing[user] -= 1;
            if missing[user] == 0 {
                ready.entry(group(user)).or_default().insert(user);
            }
        }
    }
}

/// The first statement of the next link: on outwards as long as there is one, then back, and so on.
fn onward(
    ready: &BTreeMap<Option<usize>, BTreeSet<usize>>,
    current: Option<usize>,
    outwards: &mut bool,
) -> Option<usize> {
    let outer = || ready.range((Bound::Excluded(current), Bound::Unbounded)).next();
    let inner = || ready.range(..current).next_back();
    let (link, statements) = if *outwards { outer().or_else(inner) } else { inner().or_else(outer) }?;
    *outwards = *link > current;
    statements.first().copied()
}

/// The statements at which another link begins, with its number; empty if there is one link alone, or if fewer than
/// [`FEW`] statements stand together on average. Statements of no link, such as those that solve with M, begin nothing.
pub(super) fn starts(statements: &[Statement], links: &[Option<usize>]) -> BTreeMap<usize, usize> {
    let of_links = || statements.iter().enumerate().filter_map(|(i, one)| Some((i, one.link(links)?)));
    let (mut starts, mut last) = (BTreeMap::new(), None);
    for (i, link) in of_links() {
        if last.replace(link) != Some(link) {
            starts.insert(i, link);
        }
    }
    if starts.len() > 1 && of_links().count() >= FEW * starts.len() { starts } else { BTreeMap::new() }
}

#[cfg(test)]
mod tests {
    use super::super::expression::Tree;
    use super::super::{Language, Options};
    use super::*;
    use crate::Analysis;
    use crate::expr::Graph;
    use crate::source::Sources;

    fn add(local: usize, a: usize, b: usize) -> Statement {
        Statement::Let(local, Tree::Add(Box::new(Tree::Local(a)), Box::new(Tree::Local(b))))
    }

    #[test]
    fn links_are_known_by_the_letters_of_the_key() {
        let notes = ["w3x", "by_wd12y", "ni2y", "mr4", "mc0", "m_1_0", "l_1_0", "d_2", "tau_1", "q_1", "x", "", "3"];
        let expected = [Some(3), Some(12), Some(2), Some(4), Some(0), None, None, None, None, None, None, None, None];
        assert_eq!(notes.map(of_note), expected);
    }

    /// Locals below 8 are of link 1, below 16 of link 2, 16 is of none, 17 of link 1 again.
    #[test]
    fn statements_of_a_link_stand_together_after_what_they_need() {
        let link = |local: usize| (local != 16).then_some(if (8..16).contains(&local) { 2 } else { 1 });
        let links: Vec<Option<usize>> = (0..18).map(link).collect();
        let one = |local| Statement::Let(local, Tree::Constant(1.0));
        let locals = |statements: &[Statement]| statements.iter().flat_map(Statement::binds).collect::<Vec<usize>>();
        let mut jumping: Vec<Statement> = (1..8).flat_map(|i| [add(8 + i, i - 1, 8), one(i)]).collect();
        jumping.splice(0..0, [one(0), add(8, 0, 0)]);
        jumping.extend([add(16, 9, 1), add(17, 15, 16)]);
        let ordered = together(jumping, &links);
        assert_eq!(locals(&ordered), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17]);
        assert_eq!(starts(&ordered, &links), BTreeMap::from([(0, 1), (8, 2), (17, 1)]));
        // Of one link, and too few together.
        assert_eq!(starts(&ordered[..8], &links), BTreeMap::new());
        let few = vec![one(0), add(8, 0, 0), one(1), add(9, 1, 0)];
        assert_eq!(starts(&few, &links), BTreeMap::new());
        assert_eq!(locals(&together(few, &links)), [0, 8, 1, 9]);
        assert!(together(Vec::new(), &links).is_empty());
    }

    const ARM: &str = "mechanism Arm {
        coord q[3]: rad;
        let first = rot_z(q[0]);
        let second = first * translation([1 m, 0, 0]) * rot_x(q[1]);
        let third = second * translation([1 m, 0, 0]) * rot_y(q[2]);
        const j: kg*m^2 = 1;
        fn body(pose) = rigid_body(2 kg, [1 m, 2 m, 3 m], inertia(9*j, 8*j, 7*j, j, 2*j, 3*j), pose);
        kinetic += body(first) + body(second) + body(third);
        potential += 2 kg * 10 m/s^2 * (second.point([1 m, 2 m, 3 m]).y + third.point([1 m, 2 m, 3 m]).y);
    }";

    /// A sweep outwards and one back, in all languages.
    #[test]
    fn comments_say_which_link_it_is() {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&Sources::new("arm.mbs", ARM), &graph).unwrap();
        let options = Options::default().functions(["inverse_dynamics"]);
        for language in Language::ALL {
            let text = language.write(analysis.programs(), "arm.mbs", &options);
            let comments = text.lines().filter_map(|line| line.trim().strip_suffix('.')?.split_once(" Link "));
            let links: Vec<u32> = comments.filter_map(|(_, link)| link.parse().ok()).collect();
            assert_eq!(links, [1, 2, 3, 2, 1], "{}", language.name());
        }
    }
}
