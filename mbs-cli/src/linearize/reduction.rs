//! Coordinates and speeds that constraints leave independent, chosen by complete pivoting, or named.
//!
//! As `mbs_runtime::Reduction`, whose sizes are known to the compiler; its documentation has the equations and their
//! sources.

use nalgebra::DMatrix;

/// What is left of a row counts as zero below this part of it.
const NONE: f64 = 1e-10;

/// `x = slopes · x[independent] + constants`: what linear equations leave.
pub(super) struct Solution {
    pub(super) independent: Vec<usize>,
    /// One row per unknown.
    pub(super) slopes: DMatrix<f64>,
    pub(super) constants: DMatrix<f64>,
    /// A row of which constants alone are left: it vanishes or depends on the others here, but not in the
    /// neighbourhood.
    pub(super) singular: Option<usize>,
}

/// Why the named ones are not what is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The unknowns named are tied to each other by a row.
    Tied {
        /// Which row.
        row: usize,
    },
    /// An unknown that is not named stays free.
    Free {
        /// Which.
        unknown: usize,
    },
}

/// Solves `rows x + constants = 0` for as many unknowns as there are independent rows, of those that are not `named` if
/// any are.
pub(super) fn solve(
    mut rows: DMatrix<f64>,
    mut constants: DMatrix<f64>,
    named: Option<&[usize]>,
) -> Result<Solution, Fault> {
    let (count, unknowns) = rows.shape();
    let may_follow = |unknown: usize| named.is_none_or(|named| !named.contains(&unknown));
    for i in 0..count {
        let size = rows.row(i).amax();
        if size > 0.0 {
            rows.row_mut(i).unscale_mut(size);
            constants.row_mut(i).unscale_mut(size);
        }
    }
    // The row that a dependent unknown follows from.
    let mut follows: Vec<Option<usize>> = vec![None; unknowns];
    let mut done = vec![false; count];
    loop {
        let candidates = (0..count).filter(|&i| !done[i]).flat_map(|i| (0..unknowns).map(move |j| (i, j)));
        let open = candidates.filter(|&(_, j)| follows[j].is_none() && may_follow(j));
        let larger =
            |best: (usize, usize), next: (usize, usize)| if rows[next].abs() > rows[best].abs() { next } else { best };
        let Some((row, unknown)) = open.reduce(larger).filter(|&pivot| rows[pivot].abs() > NONE) else { break };
        let pivot = rows[(row, unknown)];
        rows.row_mut(row).unscale_mut(pivot);
        constants.row_mut(row).unscale_mut(pivot);
        for i in (0..count).filter(|&i| i != row) {
            let factor = rows[(i, unknown)];
            if factor != 0.0 {
                for j in 0..unknowns {
                    rows[(i, j)] -= factor * rows[(row, j)];
                }
                for j in 0..constants.ncols() {
                    constants[(i, j)] -= factor * constants[(row, j)];
                }
            }
        }
        (done[row], follows[unknown]) = (true, Some(row));
    }
    if let Some(row) = (0..count).find(|&i| !done[i] && rows.row(i).amax() > NONE) {
        return Err(Fault::Tied { row });
    }
    let left: Vec<usize> = (0..unknowns).filter(|&unknown| follows[unknown].is_none()).collect();
    if let Some(&unknown) = left.iter().find(|&&unknown| may_follow(unknown) && named.is_some()) {
        return Err(Fault::Free { unknown });
    }
    let size = constants.amax().max(1.0);
    let singular = (0..count).find(|&i| !done[i] && constants.ncols() > 0 && constants.row(i).amax() > NONE * size);
    let independent = named.map_or(left, <[usize]>::to_vec);
    let slopes = DMatrix::from_fn(unknowns, independent.len(), |i, j| match follows[i] {
        Some(row) => -rows[(row, independent[j])],
        None => f64::from(u8::from(i == independent[j])),
    });
    let constants =
        DMatrix::from_fn(unknowns, constants.ncols(), |i, j| follows[i].map_or(0.0, |row| -constants[(row, j)]));
    Ok(Solution { independent, slopes, constants, singular })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_repeat_each_other_leave_what_they_leave() {
        // x + 2y = 0 twice, in other units.
        let rows = DMatrix::from_row_slice(2, 3, &[1.0, 2.0, 0.0, -1e6, -2e6, 0.0]);
        let found = solve(rows.clone(), DMatrix::zeros(2, 0), None).ok().unwrap();
        assert_eq!(found.independent, [0, 2]);
        assert_eq!(found.slopes, DMatrix::from_row_slice(3, 2, &[1.0, 0.0, -0.5, 0.0, 0.0, 1.0]));
        let named = |list: &[usize]| solve(rows.clone(), DMatrix::zeros(2, 0), Some(list)).map(|found| found.slopes);
        assert_eq!(named(&[1, 2]), Ok(DMatrix::from_row_slice(3, 2, &[-2.0, 0.0, 1.0, 0.0, 0.0, 1.0])));
        assert_eq!(named(&[0, 1]), Err(Fault::Tied { row: 0 }));
        assert_eq!(named(&[0]), Err(Fault::Free { unknown: 2 }));
    }

    #[test]
    fn constants_follow() {
        // 2x + y = 4 a: y = 4 a − 2 x, or x = 2 a − y/2.
        let rows = DMatrix::from_row_slice(1, 2, &[2.0, 1.0]);
        let constants = DMatrix::from_row_slice(1, 1, &[-4.0]);
        let found = solve(rows, constants, None).ok().unwrap();
        assert_eq!((found.independent, found.slopes[(0, 0)], found.constants[(0, 0)]), (vec![1], -0.5, 2.0));
        assert_eq!(found.singular, None);
    }

    #[test]
    fn rows_that_are_left_without_unknowns_have_no_constants() {
        let singular = |rows: [f64; 4], constants: [f64; 2]| {
            let [rows, constants] = [DMatrix::from_row_slice(2, 2, &rows), DMatrix::from_row_slice(2, 1, &constants)];
            solve(rows, constants, None).ok().unwrap().singular
        };
        assert_eq!(singular([1.0, 2.0, 10.0, 20.0], [3.0, 30.0]), None);
        assert_eq!(singular([1.0, 2.0, 10.0, 20.0], [3.0, 31.0]), Some(1));
        assert_eq!(singular([1.0, 2.0, 0.0, 0.0], [3.0, 1.0]), Some(1));
        assert_eq!(singular([1.0, 2.0, 0.0, 0.0], [3.0, 0.0]), None);
    }
}
