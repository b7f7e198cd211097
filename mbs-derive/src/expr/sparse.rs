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

use std::collections::BTreeSet;

use super::evaluate::Value;

/// The constants of the runtime's `dynamics/sparse.rs`, which says what they are.
const SHARE: f64 = 1e3;
const NOTHING: f64 = 1e4;
const EXACT: [f64; 2] = [16.0, 1e-6];
const AGREES: [f64; 2] = [1e6, 1e-4];
const ROUNDS: usize = 25;

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

/// `K = L D Lᵀ`, each row off by a share of its multiplier.
pub(crate) struct Factors<V> {
    /// K itself: its diagonal, a step each, and its entries at the places of L.
    diagonal: Vec<V>,
    entries: Vec<V>,
    /// `√Mᵢᵢ` of coordinates, `√e` of multipliers, a step each.
    weights: Vec<V>,
    /// `1/D`, a step each.
    reciprocals: Vec<V>,
    /// The columns of L.
    lower: Vec<V>,
}

/// The diagonal of K and its entries at the places of L.
fn placed<V: Value>(elimination: &Elimination, values: &[V]) -> [Vec<V>; 2] {
    let size = elimination.order.len();
    let zeros = |count: usize| vec![V::constant(0.0); count];
    let [mut diagonal, mut entries] = [zeros(size), zeros(elimination.rows.len())];
    for (&place, &value) in elimination.places.iter().zip(values) {
        match place.checked_sub(size) {
            None => diagonal[place] = value,
            Some(place) => entries[place] = value,
        }
    }
    [diagonal, entries]
}

/// `1/D` and the columns of L; `None` at a pivot that is not sound beside its terms.
fn factorized<V: Value>(
    elimination: &Elimination,
    mut pivots: Vec<V>,
    mut lower: Vec<V>,
    is_sound: impl Fn(usize, V, V) -> bool,
) -> Option<[Vec<V>; 2]> {
    let Elimination { starts, rows, .. } = elimination;
    let mut terms: Vec<V> = pivots.iter().map(|&pivot| magnitude(pivot)).collect();
    let mut reciprocals = Vec::with_capacity(pivots.len());
    for step in 0..pivots.len() {
        let pivot = pivots[step];
        if !is_sound(step, pivot, terms[step]) || !magnitude(pivot).less(V::constant(f64::INFINITY)) {
            return None;
        }
        let reciprocal = V::constant(1.0).div(pivot);
        reciprocals.push(reciprocal);
        let column = starts[step]..starts[step + 1];
        for a in column.clone() {
            let (row, entry) = (rows[a], lower[a]);
            let factor = entry.mul(reciprocal);
            lower[a] = factor;
            let product = entry.mul(factor);
            pivots[row] = pivots[row].sub(product);
            terms[row] = terms[row].add(magnitude(product));
            // The entries behind are those of the pivot's column still, and have places in this row's column.
            let mut place = starts[row];
            for b in a + 1..column.end {
                while rows[place] != rows[b] {
                    place += 1;
                }
                lower[place] = lower[place].sub(factor.mul(lower[b]));
            }
        }
    }
    Some([reciprocals, lower])
}

impl<V: Value> Factors<V> {
    /// Of the system with these entries; `None` where a coordinate has no inertia, or something is not finite.
    pub(crate) fn new(elimination: &Elimination, values: &[V]) -> Option<Self> {
        let [diagonal, entries] = placed(elimination, values);
        let is_coordinate = |step: usize| elimination.order[step] < elimination.coordinates;
        let mut pivots = diagonal.clone();
        // What each multiplier moves, in the places of its pivot.
        for step in (0..pivots.len()).filter(|&step| is_coordinate(step)) {
            for a in elimination.starts[step]..elimination.starts[step + 1] {
                let row = elimination.rows[a];
                if !is_coordinate(row) {
                    pivots[row] = pivots[row].add(entries[a].mul(entries[a]).div(diagonal[step]));
                }
            }
        }
        let weights = pivots.iter().map(|pivot| pivot.power(1)).collect();
        let zero = V::constant(0.0);
        for step in (0..pivots.len()).filter(|&step| !is_coordinate(step)) {
            let own = V::constant(SHARE * f64::EPSILON).mul(pivots[step]).neg();
            pivots[step] = if zero.less(pivots[step]) { own } else { V::constant(-1.0) };
        }
        let is_sound = |step: usize, pivot: V, terms: V| match is_coordinate(step) {
            true => V::constant(NOTHING * f64::EPSILON).mul(terms).less(pivot),
            false => zero.less(pivot.neg()),
        };
        let [reciprocals, lower] = factorized(elimination, pivots, entries.clone(), is_sound)?;
        Some(Factors { diagonal, entries, weights, reciprocals, lower })
    }

    /// `K⁻¹ b`, where what is left agrees with its equations.
    pub(crate) fn solution(&self, elimination: &Elimination, b: &[V]) -> Option<Vec<V>> {
        let [x, right_side] = self.nearest_in_steps(elimination, b);
        let agrees = self.rest(elimination, &right_side, &x, AGREES).1;
        agrees.then(|| in_order(elimination, &x))
    }

    /// `K⁻¹ b`, or what comes near to it where rows contradict each other.
    fn nearest(&self, elimination: &Elimination, b: &[V]) -> Vec<V> {
        in_order(elimination, &self.nearest_in_steps(elimination, b)[0])
    }

    /// That, and b, in the order of the steps.
    fn nearest_in_steps(&self, elimination: &Elimination, b: &[V]) -> [Vec<V>; 2] {
        let right_side: Vec<V> = elimination.order.iter().map(|&unknown| b[unknown]).collect();
        let less = |sum: V, factor: V, x: V| sum.sub(factor.mul(x));
        let mut x = self.substituted(elimination, right_side.clone(), |x| x, less);
        for round in 0..ROUNDS {
            let (rest, is_exact) = self.rest(elimination, &right_side, &x, EXACT);
            if round > 0 && is_exact {
                break;
            }
            let change = self.substituted(elimination, rest, |x| x, less);
            x.iter_mut().zip(change).for_each(|(x, change)| *x = x.add(change));
        }
        [x, right_side]
    }

    /// `b − K x`, and whether it is no more than as many roundings of its terms, among them a share of what moves most
    /// and of what a row is off by.
    fn rest(
        &self,
        elimination: &Elimination,
        right_side: &[V],
        x: &[V],
        [roundings, share]: [f64; 2],
    ) -> (Vec<V>, bool) {
        let Elimination { coordinates, order, starts, rows, .. } = elimination;
        let moving = order.iter().zip(x.iter().zip(&self.weights)).filter(|(unknown, _)| *unknown < coordinates);
        let larger = |a: V, b: V| if a.less(b) || !b.less_equal(b) { b } else { a };
        let size = moving.fold(V::constant(0.0), |size, (_, (&x, &weight))| larger(size, magnitude(x.mul(weight))));
        let (size, off) = (V::constant(share).mul(size), V::constant(share * SHARE * f64::EPSILON));
        let mut rest = right_side.to_vec();
        let mut terms: Vec<V> = rest.iter().map(|&b| magnitude(b)).collect();
        for (step, (terms, &weight)) in terms.iter_mut().zip(&self.weights).enumerate() {
            *terms = terms.add(weight.mul(size));
            if order[step] >= *coordinates {
                *terms = terms.add(off.mul(weight.mul(weight)).mul(magnitude(x[step])));
            }
        }
        let mut take = |step: usize, product: V| {
            rest[step] = rest[step].sub(product);
            terms[step] = terms[step].add(magnitude(product));
        };
        for step in 0..order.len() {
            take(step, self.diagonal[step].mul(x[step]));
            for a in starts[step]..starts[step + 1] {
                take(rows[a], self.entries[a].mul(x[step]));
                take(step, self.entries[a].mul(x[rows[a]]));
            }
        }
        let most = V::constant(roundings * f64::EPSILON);
        let agrees = |(rest, &terms): (&V, &V)| {
            magnitude(*rest).less_equal(most.mul(terms)) && terms.less(V::constant(f64::INFINITY))
        };
        let all = rest.iter().zip(&terms).all(agrees);
        (rest, all)
    }

    /// How many rows depend on others, as far as pivots show.
    pub(crate) fn dependent_rows(&self, elimination: &Elimination) -> usize {
        // As `DEPENDENT` of the runtime's `dynamics/sparse.rs`, which says why.
        const LEAST: f64 = 1e-5;
        let steps = elimination.order.iter().zip(self.reciprocals.iter().zip(&self.weights));
        let rows = steps.filter(|(unknown, _)| **unknown >= elimination.coordinates);
        let is_dependent = |(reciprocal, &weight): (&V, &V)| {
            let (pivot, least) = (V::constant(-1.0).div(*reciprocal), V::constant(LEAST).mul(weight.mul(weight)));
            weight.less_equal(V::constant(0.0)) || pivot.less_equal(least)
        };
        rows.filter(|(_, row)| is_dependent(*row)).count()
    }

    /// Bounds on `|K⁻¹| b` for `b ≥ 0`: since `|L⁻¹|` is at most the inverse of the factor whose entries below the
    /// diagonal are `−|Lᵢⱼ|`.
    ///
    /// Source: Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, section 8.3.
    pub(crate) fn bounds(&self, elimination: &Elimination, b: &[V]) -> Vec<V> {
        let b = elimination.order.iter().map(|&unknown| b[unknown]).collect();
        let more = |sum: V, factor: V, x: V| sum.add(magnitude(factor).mul(x));
        in_order(elimination, &self.substituted(elimination, b, magnitude, more))
    }

    fn substituted(
        &self,
        elimination: &Elimination,
        mut x: Vec<V>,
        divisor: impl Fn(V) -> V,
        less: impl Fn(V, V, V) -> V,
    ) -> Vec<V> {
        let Elimination { starts, rows, .. } = elimination;
        for step in 0..x.len() {
            for a in starts[step]..starts[step + 1] {
                x[rows[a]] = less(x[rows[a]], self.lower[a], x[step]);
            }
        }
        for step in (0..x.len()).rev() {
            let column = starts[step]..starts[step + 1];
            let scaled = x[step].mul(divisor(self.reciprocals[step]));
            x[step] = column.fold(scaled, |sum, a| less(sum, self.lower[a], x[rows[a]]));
        }
        x
    }
}

/// What is in the order of the steps, in that of the unknowns.
fn in_order<V: Value>(elimination: &Elimination, x: &[V]) -> Vec<V> {
    let mut solution = x.to_vec();
    elimination.order.iter().zip(x).for_each(|(&unknown, &x)| solution[unknown] = x);
    solution
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

fn magnitude<V: Value>(x: V) -> V {
    if x.less(V::constant(0.0)) { x.neg() } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Dual, Rounded, evaluate::Terms};

    /// Links: masses in a row, coupled with their neighbours, and a row between each two but the first.
    const LINKS: usize = 60;

    fn system<V: Value>(vary: impl Fn(usize, f64) -> V) -> (Elimination, Vec<V>) {
        let (n, mut places, mut entries) = (LINKS, Vec::new(), Vec::new());
        let mut put = |place: [usize; 2], value: f64| {
            entries.push(vary(places.len(), value));
            places.push(place);
        };
        for i in 0..n {
            put([i, i], 2.0 + 0.1 * (i % 7) as f64);
            if i > 0 {
                put([i, i - 1], 0.5 - 0.03 * (i % 5) as f64);
            }
        }
        for k in 0..n - 2 {
            put([n + k, k + 1], 1.0 + 0.2 * (k % 3) as f64);
            put([n + k, k + 2], -0.7);
        }
        (Elimination::of(n, 2 * n - 2, places).expect("a chain"), entries)
    }

    fn right_side() -> Vec<f64> {
        (0..2 * LINKS - 2).map(|i| (1.0 + 2.3 * i as f64).sin()).collect()
    }

    #[test]
    fn it_solves_what_the_null_space_solves() {
        let (elimination, entries) = system(|_, x: f64| x);
        let (mass, jacobian) = elimination.in_full(&entries);
        let vectors: Vec<usize> = (0..LINKS - 2).collect();
        let expected = f64::constrained(LINKS, mass.clone(), jacobian.clone(), &vectors)(&right_side());
        let found = f64::eliminated(&elimination, entries.clone())(&right_side());
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        // The work grows with the length of the chain.
        assert!(elimination.pairs()[0] < 8 * elimination.order.len(), "{:?}", elimination.pairs());
        let (again, values) = Elimination::of_values(LINKS, &mass, &jacobian, |&x| x == 0.0).unwrap();
        let same = f64::eliminated(&again, values)(&right_side());
        assert!(same.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{same:?} {expected:?}");
        assert_eq!(Factors::new(&elimination, &entries).unwrap().dependent_rows(&elimination), 0);
        assert!(is_regular(LINKS, &mass, &jacobian));
    }

    #[test]
    fn a_solution_is_differentiated_and_bounded() {
        let change = |number: usize| if number % 9 == 4 { 0.3 } else { 0.0 };
        let at = |step: f64| {
            let (elimination, entries) = system(|number, x| x + step * change(number));
            f64::eliminated(&elimination, entries)(&right_side())
        };
        let (elimination, entries) = system(|number, x| Dual::new(x, change(number)));
        let found =
            Dual::eliminated(&elimination, entries)(&right_side().into_iter().map(Dual::fixed).collect::<Vec<_>>());
        for ((found, after), before) in found.iter().zip(at(1e-6)).zip(at(-1e-6)) {
            assert!((found.derivative - (after - before) / 2e-6).abs() < 1e-8, "{found:?}");
        }
        // An entry that is not known better than 1e-8 lets the solution move by no more than its bound.
        let (elimination, entries) = system(|number, value| Rounded { value, error: 1e-8 * change(number) });
        let column: Vec<Rounded> = right_side().into_iter().map(Rounded::exact).collect();
        let bounded = Rounded::eliminated(&elimination, entries.clone())(&column);
        let (mass, jacobian) = elimination.in_full(&entries);
        let vectors: Vec<usize> = (0..LINKS - 2).collect();
        let none = Terms { sizes: Vec::new(), motion: Vec::new(), scales: Vec::new() };
        let in_full = Rounded::constrained_columns(LINKS, mass, jacobian, &vectors)(&[column], &none).remove(0);
        for ((bounded, in_full), moved) in bounded.iter().zip(in_full).zip(at(1e-8)) {
            let off = (bounded.value - moved).abs();
            // It is 1.02e-6 at most: along 60 links bounds add up.
            assert!(off <= bounded.error && bounded.error < 2e-6, "{bounded:?} {moved}");
            assert!((bounded.value - in_full.value).abs() < 1e-12, "{bounded:?} {in_full:?}");
        }
        assert!(at(1e-8).iter().zip(at(0.0)).any(|(a, b)| (a - b).abs() > 1e-10));
    }

    #[test]
    fn what_has_no_solution_is_nan() {
        let first_of_rows = 2 * LINKS - 1;
        let solves = |vary: &dyn Fn(usize, f64) -> f64, target: f64| {
            let (elimination, entries) = system(vary);
            let mut b = right_side();
            b[LINKS + 4] = target;
            let dependent = Factors::new(&elimination, &entries).map(|factors| factors.dependent_rows(&elimination));
            (f64::eliminated(&elimination, entries)(&b), dependent)
        };
        // A row of zeros may ask for nothing but zero.
        let without: &dyn Fn(usize, f64) -> f64 =
            &|number, x| if [8, 9].contains(&number.wrapping_sub(first_of_rows)) { 0.0 } else { x };
        let (found, dependent) = solves(without, 0.0);
        assert!(found.iter().all(|x| x.is_finite()) && dependent == Some(1), "{dependent:?}");
        assert!(solves(without, 1.0).0.iter().all(|x| x.is_nan()));
        // A coordinate without inertia, an infinite entry.
        let cases: [&dyn Fn(usize, f64) -> f64; 2] =
            [&|number, x| if number < 2 { 0.0 } else { x }, &|number, x| if number == 7 { f64::INFINITY } else { x }];
        for (number, case) in cases.into_iter().enumerate() {
            assert!(solves(case, 0.0).0.iter().all(|x| x.is_nan()), "case {number}");
        }
        // A full matrix, and a coordinate that stands nowhere.
        let full = (0..70).flat_map(|i| (0..=i).map(move |j| [i, j])).collect();
        assert!(Elimination::of(70, 70, full).is_none());
        assert!(Elimination::of(2, 2, vec![[0, 0]]).is_none());
    }

    /// The third row follows from the other two, which are nearly parallel: their pivots make rounding large.
    #[test]
    fn what_rounding_leaves_of_a_row_is_no_row() {
        let n = 120;
        let mut jacobian = vec![0.0; 3 * n];
        for (row, factor) in [1.0, 1.0 + 1e-4, 3.0].into_iter().enumerate() {
            (jacobian[row * n], jacobian[row * n + 1], jacobian[row * n + 2]) = (1.0, factor, 1.0);
        }
        let unit: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| f64::from(u8::from(i == j)))).collect();
        assert!(!is_regular(n, &unit, &jacobian));
        assert!(is_regular(n, &unit, &jacobian[..n]));
    }

    /// Twice the same row, and one of zeros.
    #[test]
    fn rows_that_depend_on_others_change_what_they_may() {
        let n = 120;
        let mut jacobian = vec![0.0; 3 * n];
        (jacobian[3], jacobian[4], jacobian[n + 3], jacobian[n + 4]) = (1.0, 2.0, 2.0, 4.0);
        let weights: Vec<f64> = (0..n).map(|i| if i == 3 { 4.0 } else { 1.0 }).collect();
        let x = least_change(&weights, &jacobian, &[3.0, 6.0, 0.0], None).unwrap();
        // x = W⁻¹ aᵀ (a W⁻¹ aᵀ)⁻¹ c with a W⁻¹ aᵀ = 1/4 + 4.
        for (i, x) in x.iter().enumerate() {
            let expected = [0.75, 6.0].get(i.wrapping_sub(3)).map_or(0.0, |x| x / 4.25);
            assert!((x - expected).abs() < 1e-12, "{i}: {x} {expected}");
        }
        let apart = least_change(&weights, &jacobian, &[3.0, 5.0, 1.0], None).unwrap();
        assert!(
            apart.iter().all(|x| x.is_finite()) && (apart[3] + 2.0 * apart[4] - 2.75).abs() < 1e-2,
            "{:?}",
            &apart[3..5]
        );
    }
}
