//! Symmetric systems of many unknowns, most entries of which are zero: `K = L D Lᵀ` in an order that is chosen once,
//! from where the entries are.
//!
//! Eliminating an unknown couples all that it is coupled with. One with the fewest neighbours comes first (*minimum
//! degree*; A. George, J. W. H. Liu, *The evolution of the minimum degree ordering algorithm*, SIAM Review 31, 1989),
//! of equal ones the first: a tree is eliminated from its leaves without any fill-in, a full matrix row by row.
//!
//! With constraints the system is
//!
//! ```text
//! ⎡ M  Aᵀ ⎤ ⎡  q̈ ⎤   ⎡ f ⎤
//! ⎣ A  0  ⎦ ⎣ −λ ⎦ = ⎣ c ⎦
//! ```
//!
//! and a multiplier comes after all coordinates of its row. Where M is positive definite, pivots of coordinates are
//! then positive and those of multipliers negative, so that no entry has to be exchanged for another. The operations
//! are those of the runtime's `dynamics/sparse.rs`, in the same order, which says where they come from.
//!
//! - `order`: which unknown comes next;
//! - `factors`: the factorization by numbers, and its solutions.

mod factors;
mod order;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

use super::evaluate::Value;
pub(crate) use factors::Factors;
use factors::{factorized, placed};
pub(crate) use order::{Order, pairs};

/// Of more unknowns than these, coordinates and multipliers, those that most others are not coupled with are eliminated
/// in an order chosen by where the entries are; of fewer the numbers decide which coordinates depend on which.
pub(crate) const FEW_UNKNOWNS: usize = 100;

/// In which order the unknowns of a symmetric system are eliminated, and where its entries and those of L are.
///
/// Unknowns are coordinates and, behind them, multipliers. Steps are numbered in the order of elimination; places are
/// those of the pivots, a step each, and behind them those of the columns of L, one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Elimination {
    /// How many unknowns are coordinates.
    pub coordinates: usize,
    /// The unknown of each step.
    pub order: Vec<usize>,
    /// Where the column of each step begins in `rows`; behind them the length of `rows`.
    pub starts: Vec<usize>,
    /// The steps that have entries in the columns of L, rising in each.
    pub rows: Vec<usize>,
    /// The entries of the system that are not zero everywhere: two unknowns, the second not behind the first.
    pub entries: Vec<[usize; 2]>,
    /// The place of each of the entries.
    pub places: Vec<usize>,
}

impl Elimination {
    /// Of a system with these entries, in lower triangles, of this many coordinates and multipliers behind them; `None`
    /// where that takes more than an eighth of the work on a full matrix, or a coordinate has no entry on the diagonal.
    pub(crate) fn of(coordinates: usize, size: usize, entries: Vec<[usize; 2]>) -> Option<Self> {
        let mut coupled = vec![BTreeSet::new(); size];
        for &[i, j] in entries.iter().filter(|[i, j]| i != j) {
            coupled[i].insert(j);
            coupled[j].insert(i);
        }
        let has_own: BTreeSet<usize> = entries.iter().filter(|[i, j]| i == j).map(|[i, _]| *i).collect();
        let is_determined = (0..coordinates).all(|i| has_own.contains(&i));
        let order = is_determined.then(|| Order::of(coupled, coordinates, size * size * size / 48)).flatten();
        let Order { unknowns: order, rows: before } = order?;
        let mut columns = vec![Vec::new(); size];
        before.iter().enumerate().for_each(|(step, row)| row.iter().for_each(|&column| columns[column].push(step)));
        let mut starts = vec![0];
        starts.extend(columns.iter().scan(0, |end, column| {
            *end += column.len();
            Some(*end)
        }));
        let mut step_of = vec![0; size];
        order.iter().enumerate().for_each(|(step, &unknown)| step_of[unknown] = step);
        let place = |&[i, j]: &[usize; 2]| {
            let (row, column) = (step_of[i].max(step_of[j]), step_of[i].min(step_of[j]));
            let found = columns[column].binary_search(&row);
            if row == column { row } else { size + starts[column] + found.expect("L has what the system has") }
        };
        let places = entries.iter().map(place).collect();
        Some(Elimination { coordinates, order, starts, rows: columns.concat(), entries, places })
    }

    /// Of the entries that are not zero of M, by its lower triangle, and A, row by row; and those entries.
    pub(crate) fn of_values<V: Value>(
        n: usize,
        mass: &[V],
        jacobian: &[V],
        is_zero: impl Fn(&V) -> bool,
    ) -> Option<(Self, Vec<V>)> {
        let triangle = (0..n).flat_map(|i| (0..=i).map(move |j| [i, j])).zip(mass);
        let rows = (0..jacobian.len() / n.max(1)).flat_map(|k| (0..n).map(move |i| [n + k, i])).zip(jacobian);
        let all = triangle.chain(rows).filter(|([i, j], value)| i == j || !is_zero(value));
        let (entries, values) = all.map(|(place, &value)| (place, value)).unzip();
        Some((Self::of(n, n + jacobian.len() / n.max(1), entries)?, values))
    }

    /// The lower triangle of M and A, row by row, of their entries.
    pub fn in_full<V: Value>(&self, values: &[V]) -> (Vec<V>, Vec<V>) {
        let (n, zero) = (self.coordinates, V::constant(0.0));
        let mut mass = vec![zero; n * (n + 1) / 2];
        let mut jacobian = vec![zero; n * (self.order.len() - n)];
        for (&[i, j], &value) in self.entries.iter().zip(values) {
            match i.checked_sub(n) {
                None => mass[i * (i + 1) / 2 + j] = value,
                Some(row) => jacobian[row * n + j] = value,
            }
        }
        (mass, jacobian)
    }

    /// `K x`
    pub(crate) fn times<V: Value>(&self, values: &[V], x: &[V]) -> Vec<V> {
        let mut product = vec![V::constant(0.0); self.order.len()];
        for (&[i, j], &value) in self.entries.iter().zip(values) {
            product[i] = product[i].add(value.mul(x[j]));
            if i != j {
                product[j] = product[j].add(value.mul(x[i]));
            }
        }
        product
    }

    /// How many pairs of a product and a sum the factorization takes, and how many a solution.
    pub(crate) fn pairs(&self) -> [usize; 2] {
        [self.starts.windows(2).map(|ends| pairs(ends[1] - ends[0])).sum(), 2 * self.rows.len()]
    }

    /// K's solution, `−λ` behind q̈, as q̈ and λ.
    pub(crate) fn signed<V: Value>(&self, mut solution: Vec<V>) -> Vec<V> {
        solution[self.coordinates..].iter_mut().for_each(|x| *x = x.neg());
        solution
    }
}

/// The least x with `A x = target`, measured by `Σ wᵢ xᵢ²`, or one that comes near to it where rows do not agree;
/// `None` where there are few unknowns or most of A is not zero. An elimination of a system with these rows may be
/// known.
pub(crate) fn least_change(
    weights: &[f64],
    jacobian: &[f64],
    target: &[f64],
    known: Option<&Elimination>,
) -> Option<Vec<f64>> {
    let (n, k) = (weights.len(), target.len());
    let found;
    let elimination = match known {
        Some(known) => known,
        None if n + k <= FEW_UNKNOWNS => return None,
        None => {
            let rows =
                (0..k).flat_map(|row| (0..n).map(move |i| [row, i])).filter(|&[row, i]| jacobian[row * n + i] != 0.0);
            found =
                Elimination::of(n, n + k, (0..n).map(|i| [i, i]).chain(rows.map(|[row, i]| [n + row, i])).collect())?;
            &found
        }
    };
    let entry = |&[i, j]: &[usize; 2]| match i.checked_sub(n) {
        None if i == j => weights[i],
        None => 0.0,
        Some(row) => jacobian[row * n + j],
    };
    let factors = Factors::new(elimination, &elimination.entries.iter().map(entry).collect::<Vec<f64>>())?;
    let mut x = factors.nearest(elimination, &[vec![0.0; n], target.to_vec()].concat());
    x.truncate(n);
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// Whether M, by its lower triangle, and A, row by row, have many unknowns and are eliminated with pivots none of which
/// is a small part of its terms. Then M is positive definite, and no row depends on others; where the answer is no,
/// nothing is decided.
pub(crate) fn is_regular(n: usize, mass: &[f64], jacobian: &[f64]) -> bool {
    // So that what rounding has made of one pivot cannot be mistaken for another.
    const SMALL: f64 = 1e-5;
    if n + jacobian.len() / n.max(1) <= FEW_UNKNOWNS {
        return false;
    }
    let Some((elimination, values)) = Elimination::of_values(n, mass, jacobian, |&x| x == 0.0) else { return false };
    let [pivots, lower] = placed(&elimination, &values);
    let is_sound = |step: usize, pivot: f64, terms: f64| match elimination.order[step] < n {
        true => pivot > SMALL * terms,
        false => -pivot > SMALL * terms,
    };
    factorized(&elimination, pivots, lower, is_sound).is_some()
}
