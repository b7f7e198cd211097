//! The order in which the unknowns of a symmetric system are eliminated, and what that costs, by its zeros alone.
//!
//! Eliminating an unknown couples all that it is coupled with. One with the fewest neighbours comes first (*minimum
//! degree*; A. George, J. W. H. Liu, *The evolution of the minimum degree ordering algorithm*, SIAM Review 31, 1989),
//! of equal ones the first: a tree is eliminated from its leaves without any fill-in, a full matrix row by row.

use std::collections::BTreeSet;

use crate::equations::Rows;

use super::LARGEST_UNROLLED;

/// An order of elimination, and the rows of L in it.
#[derive(Debug)]
pub(super) struct Elimination {
    /// The unknowns, the first eliminated first.
    pub(super) order: Vec<usize>,
    /// For each unknown in this order the places of those before it that its row of L has entries of, rising.
    pub(super) rows: Vec<Vec<usize>>,
}

impl Elimination {
    /// Of a symmetric matrix, by the zeros of its lower triangle; `None` where it has no rows, or too many statements
    /// to be written out: more for each unknown than a full matrix of [`LARGEST_UNROLLED`].
    pub(super) fn of(m: &Rows<'_>) -> Option<Self> {
        let n = m.len();
        let mut coupled: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        for i in 0..n {
            for j in (0..i).filter(|&j| !m[i][j].is_zero()) {
                coupled[i].insert(j);
                coupled[j].insert(i);
            }
        }
        // Pairs of a product and a sum that eliminate one unknown.
        let pairs = |degree: usize| degree * (degree + 1) / 2;
        let full: usize = (0..LARGEST_UNROLLED).map(pairs).sum();
        let mut left = full * n / LARGEST_UNROLLED;
        let mut by_degree: BTreeSet<(usize, usize)> = coupled.iter().map(BTreeSet::len).zip(0..).collect();
        let (mut order, mut rows_of) = (Vec::new(), vec![Vec::new(); n]);
        while let Some((degree, pivot)) = by_degree.pop_first() {
            left = left.checked_sub(pairs(degree))?;
            let neighbours = std::mem::take(&mut coupled[pivot]);
            for &i in &neighbours {
                by_degree.remove(&(coupled[i].len(), i));
                coupled[i].remove(&pivot);
                coupled[i].extend(neighbours.iter().filter(|&&j| j != i));
                by_degree.insert((coupled[i].len(), i));
                rows_of[i].push(order.len());
            }
            order.push(pivot);
        }
        let rows = order.iter().map(|&unknown| std::mem::take(&mut rows_of[unknown])).collect();
        (n > 0).then_some(Elimination { order, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    /// A matrix with ones at these places of its lower triangle and on its diagonal.
    fn elimination(n: usize, places: &[[usize; 2]]) -> Option<Elimination> {
        let graph = Graph::new();
        let entry = |i, j| graph.integer(i64::from(i == j || places.contains(&[i, j])));
        Elimination::of(&(0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
    }

    #[test]
    fn a_full_matrix_is_eliminated_row_by_row_and_unrolled_up_to_its_limit() {
        for n in 1..=LARGEST_UNROLLED + 1 {
            let all: Vec<[usize; 2]> = (0..n).flat_map(|i| (0..i).map(move |j| [i, j])).collect();
            let found = elimination(n, &all);
            assert_eq!(found.is_some(), n <= LARGEST_UNROLLED);
            let Some(found) = found else { continue };
            assert_eq!(found.order, (0..n).collect::<Vec<_>>());
            assert!(found.rows.iter().enumerate().all(|(i, row)| *row == (0..i).collect::<Vec<_>>()));
        }
        assert!(elimination(0, &[]).is_none());
    }

    /// A cart, the first coordinate, with pendulums: eliminated first it would couple all of them.
    #[test]
    fn leaves_of_a_tree_come_first_and_nothing_is_filled_in() {
        let n = 40;
        let arrow: Vec<[usize; 2]> = (1..n).map(|i| [i, 0]).collect();
        let found = elimination(n, &arrow).unwrap();
        assert_eq!(found.order[..n - 2], (1..n - 1).collect::<Vec<_>>());
        assert_eq!(found.rows.iter().map(Vec::len).sum::<usize>(), n - 1);
    }

    /// A square with its corners in a ring: whichever corner goes first couples its two neighbours.
    #[test]
    fn what_a_pivot_fills_in_is_counted() {
        let found = elimination(4, &[[1, 0], [2, 1], [3, 2], [3, 0]]).unwrap();
        assert_eq!(found.order, [0, 1, 2, 3]);
        assert_eq!(found.rows, [vec![], vec![0], vec![1], vec![0, 1, 2]]);
    }
}
