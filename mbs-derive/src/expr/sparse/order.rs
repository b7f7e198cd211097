//! The order of elimination: minimum degree, multipliers after the coordinates of their rows.

use std::collections::BTreeSet;

/// An order of elimination, and the rows of L in it.
#[derive(Debug)]
pub(crate) struct Order {
    /// The unknowns, the first eliminated first.
    pub(crate) unknowns: Vec<usize>,
    /// For each unknown in this order the places of those before it that its row of L has entries of, rising.
    pub(crate) rows: Vec<Vec<usize>>,
}

impl Order {
    /// Of unknowns that are coupled as these sets say; those from `waiting` on come after all that they are coupled
    /// with at first. `None` where elimination takes more than `most` pairs of a product and a sum.
    pub(crate) fn of(mut coupled: Vec<BTreeSet<usize>>, waiting: usize, most: usize) -> Option<Self> {
        let (n, mut left) = (coupled.len(), most);
        let mut waits_for: Vec<usize> = (0..n).map(|i| if i < waiting { 0 } else { coupled[i].len() }).collect();
        let waits: Vec<Vec<usize>> =
            coupled.iter().map(|all| all.iter().copied().filter(|&j| j >= waiting).collect()).collect();
        let mut by_degree: BTreeSet<(usize, usize)> =
            (0..n).filter(|&i| waits_for[i] == 0).map(|i| (coupled[i].len(), i)).collect();
        let (mut unknowns, mut rows_of) = (Vec::new(), vec![Vec::new(); n]);
        while let Some((degree, pivot)) = by_degree.pop_first() {
            left = left.checked_sub(pairs(degree))?;
            let neighbours = std::mem::take(&mut coupled[pivot]);
            for &i in &neighbours {
                let was_ready = by_degree.remove(&(coupled[i].len(), i));
                coupled[i].remove(&pivot);
                coupled[i].extend(neighbours.iter().filter(|&&j| j != i));
                if was_ready {
                    by_degree.insert((coupled[i].len(), i));
                }
                rows_of[i].push(unknowns.len());
            }
            for &i in &waits[pivot] {
                waits_for[i] -= 1;
                if waits_for[i] == 0 {
                    by_degree.insert((coupled[i].len(), i));
                }
            }
            unknowns.push(pivot);
        }
        let rows = unknowns.iter().map(|&unknown| std::mem::take(&mut rows_of[unknown])).collect();
        (unknowns.len() == n && n > 0).then_some(Order { unknowns, rows })
    }
}

/// Pairs of a product and a sum that eliminate an unknown with this many neighbours.
pub(crate) fn pairs(degree: usize) -> usize {
    degree * (degree + 1) / 2
}
