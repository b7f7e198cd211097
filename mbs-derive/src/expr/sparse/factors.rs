//! `K = L D Lᵀ` by numbers, and its solutions: the operations of the runtime's `dynamics/sparse.rs`, in the same order.

use crate::expr::evaluate::Value;

use super::Elimination;

/// The constants of the runtime's `dynamics/sparse.rs`, which says what they are.
const SHARE: f64 = 1e3;
const NOTHING: f64 = 1e4;
const EXACT: [f64; 2] = [16.0, 1e-6];
const AGREES: [f64; 2] = [1e6, 1e-4];
const ROUNDS: usize = 25;

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
pub(super) fn placed<V: Value>(elimination: &Elimination, values: &[V]) -> [Vec<V>; 2] {
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
pub(super) fn factorized<V: Value>(
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
    pub(super) fn nearest(&self, elimination: &Elimination, b: &[V]) -> Vec<V> {
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

fn magnitude<V: Value>(x: V) -> V {
    if x.less(V::constant(0.0)) { x.neg() } else { x }
}
