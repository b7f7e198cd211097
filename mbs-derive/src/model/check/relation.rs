//! How rows of constraints follow from others: by multiples that are the same at all states, or by others at each.
//!
//! Only in the first case have the rows that are left the rank of all of them at every state. Of two wheels on one
//! axle the direction that follows is that of the axle: `v.x = 0` is enough for the second one, but not where the axle
//! points along x.

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

/// Of rows that are `dependent`, all those of one constraint, at some states; `kept` are those that they follow from,
/// `is_own` tells which of these are of the same constraint.
pub(in crate::model) fn of(
    states: &[Vec<Vec<f64>>],
    dependent: &[usize],
    kept: &[usize],
    is_own: impl Fn(usize) -> bool,
) -> Relation {
    let n = states.first().and_then(|rows| rows.first()).map_or(0, Vec::len);
    let width = kept.len() + dependent.len();
    if n.saturating_mul(kept.len()).saturating_mul(width).saturating_mul(states.len()) > MOST_OPERATIONS {
        return Relation::Varying;
    }
    let Some(first) = states.first() else { return Relation::Varying };
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
    let all: Option<Vec<Vec<Vec<f64>>>> = states.iter().map(multiples).collect();
    let Some(all) = all else { return Relation::Varying };
    let size = all.iter().flatten().flatten().fold(1.0, |size: f64, x| size.max(x.abs()));
    let is_same = |place: usize| {
        all.iter().all(|here| here[place].iter().zip(&all[0][place]).all(|(a, b)| (a - b).abs() <= ROUNDING * size))
    };
    if (0..kept.len()).all(is_same) {
        Relation::Constant
    } else if (0..kept.len()).filter(|&place| is_own(kept[place])).all(is_same) {
        Relation::Varying
    } else {
        Relation::Turning
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
