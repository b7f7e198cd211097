//! How rows of constraints follow from others: by multiples that are the same at all states, or by others at each.
//!
//! Only in the first case have the rows that are left the rank of all of them at every state. Of two wheels on one
//! axle the direction that follows is that of the axle: `v.x = 0` is enough for the second one, but not where the axle
//! points along x.

use std::ops::Range;

/// How all rows of a constraint that others determine follow from these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// They are the same sums of multiples at all states.
    Constant,
    /// The sums change with the state, but which combination of the constraint's own rows follows does not; or nothing
    /// is known.
    Varying,
    /// Which combination of the constraint's own rows follows changes with the state.
    Turning,
}

/// Beyond this many operations nothing is computed.
const MOST_OPERATIONS: usize = 100_000_000;

/// Multiples are the same up to this.
const ROUNDING: f64 = 1e-6;

/// What dependent rows are of those that are kept, at some states.
pub(in crate::model) struct Multiples {
    /// Of each state, of each kept row its multiples in the dependent ones; `None` where they are not known.
    states: Option<Vec<Vec<Vec<f64>>>>,
}

impl Multiples {
    /// By one elimination a state for all that are `dependent`.
    pub(in crate::model) fn of(states: &[Vec<Vec<f64>>], dependent: &[usize], kept: &[usize]) -> Self {
        let unknown = Multiples { states: None };
        let Some(first) = states.first() else { return unknown };
        let n = first.first().map_or(0, Vec::len);
        let width = kept.len() + dependent.len();
        if n.saturating_mul(kept.len()).saturating_mul(width).saturating_mul(states.len()) > MOST_OPERATIONS {
            return unknown;
        }
        let scale = |row: &usize| first[*row].iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let scales = kept.iter().chain(dependent).map(scale).map(|size| if size == 0.0 { 1.0 } else { size });
        let scales: Vec<f64> = scales.collect();
        let multiples = |rows: &Vec<Vec<f64>>| {
            let mut matrix = vec![vec![0.0; width]; n];
            for (place, &row) in kept.iter().chain(dependent).enumerate() {
                matrix.iter_mut().zip(&rows[row]).for_each(|(entries, x)| entries[place] = x / scales[place]);
            }
            solved(matrix, kept.len())
        };
        Multiples { states: states.iter().map(multiples).collect() }
    }

    /// Of the dependent rows of one constraint, by their places among all; `is_own` tells which of the kept ones, by
    /// their places, are of the same constraint.
    pub(in crate::model) fn relation(&self, rows: Range<usize>, is_own: impl Fn(usize) -> bool) -> Relation {
        let Some(states) = &self.states else { return Relation::Varying };
        let kept = states[0].len();
        let entries = states.iter().flatten().flat_map(|multiples| &multiples[rows.clone()]);
        let size = entries.fold(1.0, |size: f64, x| size.max(x.abs()));
        let is_same = |place: usize| {
            let first = &states[0][place][rows.clone()];
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * size;
            states.iter().all(|here| here[place][rows.clone()].iter().zip(first).all(is_near))
        };
        if (0..kept).all(is_same) {
            Relation::Constant
        } else if (0..kept).filter(|&place| is_own(place)).all(is_same) {
            Relation::Varying
        } else {
            Relation::Turning
        }
    }
}

/// The unknowns of `rows`, whose first columns belong to them and whose others are right-hand sides; `None` where they
/// are not determined.
fn solved(mut rows: Vec<Vec<f64>>, unknowns: usize) -> Option<Vec<Vec<f64>>> {
    for unknown in 0..unknowns {
        let pivot = (unknown..rows.len()).max_by(|&a, &b| rows[a][unknown].abs().total_cmp(&rows[b][unknown].abs()))?;
        rows.swap(unknown, pivot);
        let leading = rows[unknown][unknown];
        if leading.abs() < 1e-9 || !leading.is_finite() {
            return None;
        }
        rows[unknown].iter_mut().for_each(|entry| *entry /= leading);
        let known = rows[unknown].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != unknown) {
            let factor = row[unknown];
            if factor != 0.0 {
                row.iter_mut().zip(&known).for_each(|(entry, known)| *entry -= factor * known);
            }
        }
    }
    Some(rows.into_iter().take(unknowns).map(|row| row[unknowns..].to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::refusals;

    fn check(statements: &str, message: &str) {
        let found = refusals(statements);
        assert!(found.len() == 1 && found[0].contains(message), "{statements}: {found:?}");
    }

    #[test]
    fn no_world_component_is_named_where_the_direction_turns() {
        // Two points of one body, along its axis.
        let statements = "let pose = translation([x, y, 0]) * rot_z(theta); \
             let a = pose.point([l, 0, 0]); let b = pose.point([-l, 0, 0]); \
             constraint first: dt(a) = [0, dt(z), 0]; constraint second: dt(b) = [0, dt(z), 0];";
        check(
            statements,
            "along a direction that changes with the state, the constraint `second` follows from the other rows, or \
             contradicts them; keep 1 component, across that direction: `v.dot(pose*[1, 0, 0]) = 0`, with \
             `let v = dt(b) - ([0, dt(z), 0]);` and a `pose` whose y axis has that direction at every state; components \
             in world axes are not enough at every state",
        );
    }

    #[test]
    fn each_constraint_follows_in_its_own_way() {
        let found = refusals(
            "constraint a: dt(x)*cos(theta) = dt(y)*sin(theta); constraint b: dt(x) = dt(z); \
             constraint c: dt(y)*sin(theta) = dt(z)*cos(theta); constraint d: 2*dt(x) - 2*dt(z) = 0;",
        );
        assert!(found.len() == 2, "{found:?}");
        assert!(found[0].contains("`c`") && found[0].contains("leave it out, if the rows"), "{found:?}");
        assert!(found[1].contains("`d`") && !found[1].contains("if the rows"), "{found:?}");
    }

    #[test]
    fn what_follows_by_other_multiples_at_each_state_is_left_out_on_a_condition() {
        check(
            "constraint a: dt(x)*cos(theta) = dt(y)*sin(theta); constraint b: dt(x) = dt(z); \
             constraint c: dt(y)*sin(theta) = dt(z)*cos(theta);",
            "the constraint `c` follows from the others, or contradicts them; leave it out, if the rows that are left are \
             independent at every state",
        );
        check("constraint a: x = y; constraint b: 2*x - 2*y = 0;", "or contradicts them; leave it out");
        assert!(!refusals("constraint a: x = y; constraint b: 2*x - 2*y = 0;")[0].contains("if the rows"));
    }
}
