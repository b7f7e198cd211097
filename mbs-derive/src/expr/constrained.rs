//! Systems with constraints, `M q̈ − Aᵀ λ = f`, `A q̈ = c`, solved as the runtime solves them.
//!
//! The same operations in the same order as the runtime's `dynamics/null_space.rs` and `dynamics/scaling.rs`, which say
//! what they are and where they come from: the results are the same bits.

mod scaling;

use super::evaluate::{Terms, Value};
use super::sparse;

pub(crate) use scaling::Scales;
pub(super) use scaling::power;

use scaling::{exponent, scaled};

/// How exactly rows that depend on others must agree with them: the root of the rounding error, from above. A row of
/// which less than a hundredth of this is left depends on others.
pub(crate) const AGREEMENT: f64 = 1.490_116_119_384_765_6e-8;

/// M and A, factorized in a basis of the null space of A.
pub(super) struct NullSpace<V> {
    n: usize,
    k: usize,
    scales: Scales,
    mass: Vec<Vec<V>>,
    slopes: Vec<Vec<V>>,
    basis: Vec<Vec<V>>,
    vectors: Vec<usize>,
    reciprocals: Vec<V>,
    rank: usize,
    rows: Vec<usize>,
    columns: Vec<usize>,
    inertia: Vec<Vec<V>>,
    compliance: Vec<V>,
    gram: Vec<Vec<V>>,
}

fn magnitude<V: Value>(x: V) -> V {
    if x.less(V::constant(0.0)) { x.neg() } else { x }
}

fn larger<V: Value>(a: V, b: V) -> V {
    if a.less(b) { b } else { a }
}

/// The greatest `|x|`, 0 of none.
pub(crate) fn largest<V: Value>(x: impl IntoIterator<Item = V>) -> V {
    x.into_iter().fold(V::constant(0.0), |largest, x| larger(largest, magnitude(x)))
}

fn is_finite<V: Value>(x: V) -> bool {
    magnitude(x).less(V::constant(f64::INFINITY))
}

/// `sum − a b`
fn less_product<V: Value>(sum: V, a: V, b: V) -> V {
    sum.sub(a.mul(b))
}

impl<V: Value> NullSpace<V> {
    /// Of the lower triangle of M and of A, row by row; rows of the same number in `vectors` are of one vector. `None`
    /// where a motion that A leaves has no inertia, or something is not finite.
    pub(super) fn new(n: usize, mass: &[V], jacobian: &[V], vectors: &[usize]) -> Option<Self> {
        if !mass.iter().chain(jacobian).all(|&x| is_finite(x)) {
            return None;
        }
        let m = |i: usize, j: usize| mass[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        let a: Vec<&[V]> = jacobian.chunks_exact(n.max(1)).collect();
        let k = a.len();
        let scales = Scales::of(n, &|i| m(i, i), &a, vectors);
        let mass = (0..n).map(|i| (0..n).map(|j| scales.mass(i, j, m(i, j))).collect());
        let slopes: Vec<Vec<V>> = (0..k).map(|row| (0..n).map(|i| scales.row(row, i, a[row][i])).collect()).collect();
        let zero = V::constant(0.0);
        let mut system = NullSpace {
            n,
            k,
            mass: mass.collect(),
            basis: slopes.clone(),
            slopes,
            scales,
            vectors: vectors.to_vec(),
            reciprocals: vec![zero; k],
            rank: 0,
            rows: (0..k).collect(),
            columns: (0..n).collect(),
            inertia: vec![vec![zero; n]; n],
            compliance: vec![zero; n],
            gram: vec![vec![zero; k]; k],
        };
        system.eliminate();
        system.solve_for_dependent_coordinates();
        let bounds = system.reduce();
        system.factorize(&bounds)?;
        system.relate_redundant_rows();
        Some(system)
    }

    fn eliminate(&mut self) {
        while let Some((row, column)) = self.pivot() {
            let p = self.rank;
            self.basis.swap(p, row);
            self.rows.swap(p, row);
            self.basis.iter_mut().for_each(|row| row.swap(p, column));
            self.columns.swap(p, column);
            let pivots = self.basis[p].clone();
            self.reciprocals[p] = V::constant(1.0).div(pivots[p]);
            for row in &mut self.basis[p + 1..] {
                row[p] = row[p].mul(self.reciprocals[p]);
                for j in p + 1..self.n {
                    row[j] = less_product(row[j], row[p], pivots[j]);
                }
            }
            self.rank += 1;
        }
    }

    fn pivot(&self) -> Option<(usize, usize)> {
        let size = |(k, i): (usize, usize)| magnitude(self.basis[k][i]);
        let is_independent = |k: &usize| {
            let least = self.least_slope(self.rows[*k]);
            (self.rank..self.n).any(|i| least.less(size((*k, i))))
        };
        let rows: Vec<usize> = (self.rank..self.k).filter(is_independent).collect();
        let entries = || rows.iter().flat_map(|&k| (self.rank..self.n).map(move |i| (k, i)));
        let largest = entries().reduce(|best, entry| if size(best).less(size(entry)) { entry } else { best })?;
        let enough = size(largest).mul(V::constant(0.5));
        let is_taken = |&(k, i): &(usize, usize)| self.scales.taken[self.columns[i]] == Some(self.rows[k]);
        let taken = entries().filter(is_taken).filter(|&entry| !size(entry).less(enough));
        let gentlest = taken.min_by_key(|&entry| self.growth(entry));
        Some(gentlest.unwrap_or(largest))
    }

    fn least_slope(&self, row: usize) -> V {
        let (least, small) = (V::constant(AGREEMENT * 1e-2), self.scales.small[row]);
        if small == 0 { least } else { larger(scaled(least, -small), V::constant(16.0 * f64::EPSILON)) }
    }

    fn growth(&self, (row, column): (usize, usize)) -> Option<i32> {
        let along = (self.rank..self.n).filter(|&i| i != column).filter_map(|i| exponent(self.basis[row][i])).max();
        let across = (self.rank..self.k).filter(|&k| k != row).filter_map(|k| exponent(self.basis[k][column])).max();
        Some(along? + across? - exponent(self.basis[row][column])?)
    }

    fn solve_for_dependent_coordinates(&mut self) {
        for p in (0..self.rank).rev() {
            for j in self.rank..self.n {
                let rest = (p + 1..self.rank)
                    .fold(self.basis[p][j], |rest, i| less_product(rest, self.basis[p][i], self.basis[i][j]));
                self.basis[p][j] = rest.mul(self.reciprocals[p]);
            }
        }
    }

    fn reduce(&mut self) -> Vec<V> {
        let (r, s, w) = (self.rank, self.n - self.rank, &self.basis);
        let m = |i: usize, j: usize| self.mass[self.columns[i]][self.columns[j]];
        let carry = |p: usize, j: usize| (0..r).fold(m(p, r + j), |sum, i| less_product(sum, m(p, i), w[i][r + j]));
        let carried: Vec<Vec<V>> = (0..r).map(|p| (0..s).map(|j| carry(p, j)).collect()).collect();
        for i in 0..s {
            for j in 0..=i {
                let direct = (0..r).fold(m(r + i, r + j), |sum, p| less_product(sum, m(r + i, p), w[p][r + j]));
                self.inertia[i][j] = (0..r).fold(direct, |sum, p| less_product(sum, w[p][r + i], carried[p][j]));
            }
        }
        let terms = V::constant(r as f64 + 1.0);
        let bound = |i: usize| {
            let own = magnitude(m(r + i, r + i));
            let sum = (0..r).fold(own, |sum, p| sum.add(w[p][r + i].mul(w[p][r + i]).mul(magnitude(m(p, p)))));
            sum.mul(terms)
        };
        (0..s).map(bound).collect()
    }

    fn factorize(&mut self, bounds: &[V]) -> Option<()> {
        let s = self.n - self.rank;
        let mut weights: Vec<V> = bounds.iter().map(|&bound| V::constant(1.0).div(bound)).collect();
        let rounding = V::constant(16.0 * self.n as f64 * f64::EPSILON);
        for p in 0..s {
            let share = |i: usize| self.inertia[i][i].mul(weights[i]);
            let pivot = (p + 1..s).fold(p, |best, i| if share(best).less(share(i)) { i } else { best });
            if !rounding.less(share(pivot)) {
                return None;
            }
            self.exchange(p, pivot);
            weights.swap(p, pivot);
            self.compliance[p] = V::constant(1.0).div(self.inertia[p][p]);
            let column: Vec<V> = (p + 1..s).map(|i| self.inertia[i][p].mul(self.compliance[p])).collect();
            for i in p + 1..s {
                let u = self.inertia[i][p];
                for j in p + 1..=i {
                    self.inertia[i][j] = less_product(self.inertia[i][j], u, column[j - p - 1]);
                }
                self.inertia[i][p] = column[i - p - 1];
            }
        }
        Some(())
    }

    fn exchange(&mut self, p: usize, i: usize) {
        if p == i {
            return;
        }
        let (r, s) = (self.rank, self.n - self.rank);
        for other in (0..s).filter(|&other| other != p && other != i) {
            let [a, b] = [p, i].map(|x| if other < p { (x, other) } else { (x.max(other), x.min(other)) });
            let (first, second) = (self.inertia[a.0][a.1], self.inertia[b.0][b.1]);
            (self.inertia[a.0][a.1], self.inertia[b.0][b.1]) = (second, first);
        }
        let (first, second) = (self.inertia[p][p], self.inertia[i][i]);
        (self.inertia[p][p], self.inertia[i][i]) = (second, first);
        self.columns.swap(r + p, r + i);
        self.basis.iter_mut().for_each(|row| row.swap(r + p, r + i));
    }

    fn relate_redundant_rows(&mut self) {
        let r = self.rank;
        for k in r..self.k {
            for p in (0..r).rev() {
                for i in p + 1..r {
                    self.basis[k][p] = less_product(self.basis[k][p], self.basis[k][i], self.basis[i][p]);
                }
            }
        }
        for k in r..self.k {
            for l in r..=k {
                let unit = V::constant(if k == l { 1.0 } else { 0.0 });
                let product = (0..r).fold(unit, |sum, p| sum.add(self.basis[k][p].mul(self.basis[l][p])));
                let term = |i: usize| self.gram[k][i].mul(self.gram[l][i]).mul(self.gram[i][i]);
                self.gram[k][l] = (r..l).fold(product, |sum, i| sum.sub(term(i)));
                if k != l {
                    self.gram[k][l] = self.gram[k][l].div(self.gram[l][l]);
                }
            }
        }
    }

    /// q̈, then λ, in the place of f, then c, column by column; `None` where rows contradict each other, something is
    /// not finite, or the motion is none of which the columns are derivatives.
    pub(super) fn solve(&self, columns: &[Vec<V>], terms: &Terms<V>) -> Vec<Option<Vec<V>>> {
        if !terms.motion.iter().all(|&x| is_finite(x)) {
            return vec![None; columns.len()];
        }
        let columns: Vec<(Vec<V>, Vec<V>)> = columns.iter().map(|column| self.scaled_right_side(column)).collect();
        let greatest = if self.rank == self.k { Vec::new() } else { self.greatest_sizes(&columns, terms) };
        let solution = |(j, (force, target)): (usize, &(Vec<V>, Vec<V>))| {
            let motion = self.motion(force, target);
            let agrees = self.rank == self.k || {
                let mut sizes = self.given_sizes(terms, j, target);
                if let Some(scale) = terms.scales.get(j).map(|&scale| magnitude(scale))
                    && V::constant(0.0).less(scale)
                {
                    sizes.iter_mut().zip(&greatest).for_each(|(size, all)| *size = larger(*size, all.div(scale)));
                }
                self.agrees(&motion, target, &sizes)
            };
            agrees.then(|| self.unscaled_solution(&motion, force)).flatten()
        };
        columns.iter().enumerate().map(solution).collect()
    }

    /// The solution for one column, whatever rows ask for that depend on others.
    pub(super) fn solve_independent_rows(&self, column: &[V]) -> Option<Vec<V>> {
        let (force, target) = self.scaled_right_side(column);
        self.unscaled_solution(&self.motion(&force, &target), &force)
    }

    fn scaled_right_side(&self, column: &[V]) -> (Vec<V>, Vec<V>) {
        let (Scales { columns: s, rows: t, mass, .. }, (force, target)) = (&self.scales, column.split_at(self.n));
        let force = (0..self.n).map(|i| scaled(force[i], -s[i] - mass)).collect();
        (force, (0..self.k).map(|k| scaled(target[k], -t[k])).collect())
    }

    fn unscaled_solution(&self, motion: &[V], force: &[V]) -> Option<Vec<V>> {
        let Scales { columns: s, rows: t, mass, .. } = &self.scales;
        let multipliers = self.multipliers(motion, force);
        let motion = motion.iter().zip(s).map(|(&x, &s)| scaled(x, -s));
        let multipliers = multipliers.iter().zip(t).map(|(&x, &t)| scaled(x, mass - t));
        let all: Vec<V> = motion.chain(multipliers).collect();
        all.iter().all(|&x| is_finite(x)).then_some(all)
    }

    fn given_sizes(&self, terms: &Terms<V>, j: usize, target: &[V]) -> Vec<V> {
        let given = |k: usize| terms.sizes.get(j).map_or(V::constant(0.0), |x| scaled(x[k], -self.scales.rows[k]));
        (0..self.k).map(|k| larger(magnitude(target[k]), given(k))).collect()
    }

    fn greatest_sizes(&self, columns: &[(Vec<V>, Vec<V>)], terms: &Terms<V>) -> Vec<V> {
        let mut greatest = vec![V::constant(0.0); self.k];
        if terms.motion.is_empty() {
            return greatest;
        }
        let motion: Vec<V> = terms.motion.iter().zip(&self.scales.columns).map(|(&x, &s)| scaled(x, s)).collect();
        let mut fastest = largest(motion);
        for (j, (force, target)) in columns.iter().enumerate() {
            let scale = magnitude(terms.scales[j]);
            fastest = larger(fastest, largest(self.motion(force, target)).mul(scale));
            let given = self.given_sizes(terms, j, target);
            greatest.iter_mut().zip(given).for_each(|(size, given)| *size = larger(*size, given.mul(scale)));
        }
        for (size, row) in greatest.iter_mut().zip(&self.slopes) {
            if V::constant(0.0).less(largest(row.iter().copied())) {
                *size = larger(*size, fastest);
            }
        }
        greatest
    }

    fn along(&self, row: usize, motion: &[V]) -> V {
        let terms = self.slopes[row].iter().zip(motion).map(|(&a, &x)| magnitude(a).mul(magnitude(x)));
        terms.fold(V::constant(0.0), V::add)
    }

    fn motion(&self, force: &[V], target: &[V]) -> Vec<V> {
        let (n, r, s) = (self.n, self.rank, self.n - self.rank);
        let m = |i: usize, j: usize| self.mass[self.columns[i]][self.columns[j]];
        let mut q = vec![V::constant(0.0); n];
        for p in 0..r {
            q[p] = (0..p).fold(target[self.rows[p]], |sum, i| less_product(sum, self.basis[p][i], q[i]));
        }
        for p in (0..r).rev() {
            let rest = (p + 1..r).fold(q[p], |sum, i| less_product(sum, self.basis[p][i], q[i]));
            q[p] = rest.mul(self.reciprocals[p]);
        }
        let left = |i: usize| (0..r).fold(force[self.columns[i]], |sum, p| less_product(sum, m(i, p), q[p]));
        let force: Vec<V> = (0..n).map(left).collect();
        for i in 0..s {
            let along = (0..r).fold(force[r + i], |sum, p| less_product(sum, self.basis[p][r + i], force[p]));
            q[r + i] = (0..i).fold(along, |sum, j| less_product(sum, self.inertia[i][j], q[r + j]));
        }
        for i in (0..s).rev() {
            let scaled = q[r + i].mul(self.compliance[i]);
            q[r + i] = (i + 1..s).fold(scaled, |sum, j| less_product(sum, self.inertia[j][i], q[r + j]));
        }
        for p in 0..r {
            q[p] = (r..n).fold(q[p], |sum, i| less_product(sum, self.basis[p][i], q[i]));
        }
        self.in_order(&self.columns, &q)
    }

    /// What stands in the order of the pivots, in that of the declaration.
    fn in_order(&self, numbers: &[usize], values: &[V]) -> Vec<V> {
        let mut ordered = values.to_vec();
        numbers.iter().zip(values).for_each(|(&number, &value)| ordered[number] = value);
        ordered
    }

    fn size(&self, row: usize, motion: &[V], sizes: &[V]) -> V {
        let terms = |k: usize| sizes[k].add(self.along(k, motion));
        let own = terms(row);
        if !largest(self.slopes[row].iter().copied()).less(V::constant(1.0)) {
            return own;
        }
        let others = (0..self.k).filter(|&k| k != row && self.vectors[k] == self.vectors[row]);
        others.fold(own, |size, k| larger(size, scaled(terms(k), self.scales.rows[k] - self.scales.rows[row])))
    }

    fn agrees(&self, motion: &[V], target: &[V], sizes: &[V]) -> bool {
        (self.rank..self.k).all(|k| {
            let row = self.rows[k];
            let (mut rest, mut size) = (target[row], self.size(row, motion, sizes));
            for p in 0..self.rank {
                let factor = self.basis[k][p];
                rest = less_product(rest, factor, target[self.rows[p]]);
                size = size.add(magnitude(factor).mul(self.size(self.rows[p], motion, sizes)));
            }
            let rounding = size.mul(V::constant(AGREEMENT));
            let left = |i: usize| magnitude(self.basis[k][i]).mul(magnitude(motion[self.columns[i]]));
            let allowed = (self.rank..self.n).fold(rounding, |sum, i| sum.add(left(i)));
            let zero = V::constant(0.0);
            magnitude(rest).less(allowed) || (rest.less_equal(zero) && zero.less_equal(rest))
        })
    }

    fn multipliers(&self, motion: &[V], force: &[V]) -> Vec<V> {
        let r = self.rank;
        let mut l = vec![V::constant(0.0); self.k];
        for p in 0..r {
            let i = self.columns[p];
            let h = (0..self.n).fold(force[i].neg(), |sum, j| sum.add(self.mass[i][j].mul(motion[j])));
            let rest = (0..p).fold(h, |sum, q| less_product(sum, self.basis[q][p], l[q]));
            l[p] = rest.mul(self.reciprocals[p]);
        }
        for p in (0..r).rev() {
            l[p] = (p + 1..r).fold(l[p], |sum, k| less_product(sum, self.basis[k][p], l[k]));
        }
        self.share_with_redundant_rows(&mut l);
        self.in_order(&self.rows, &l)
    }

    fn share_with_redundant_rows(&self, l: &mut [V]) {
        let r = self.rank;
        for k in r..self.k {
            let along = (0..r).fold(V::constant(0.0), |sum, p| sum.add(self.basis[k][p].mul(l[p])));
            l[k] = (r..k).fold(along, |sum, i| less_product(sum, self.gram[k][i], l[i]));
        }
        for k in (r..self.k).rev() {
            let scaled = l[k].div(self.gram[k][k]);
            l[k] = (k + 1..self.k).fold(scaled, |sum, i| less_product(sum, self.gram[i][k], l[i]));
        }
        if r < self.k {
            for p in 0..r {
                l[p] = (r..self.k).fold(l[p], |sum, k| less_product(sum, self.basis[k][p], l[k]));
            }
        }
    }
}

/// The least x with `A x = target`, measured by `Σ wᵢ xᵢ²`; rows that others determine are left out. Rows of the same
/// number in `vectors` are of one vector.
pub(crate) fn least_change(weights: &[f64], jacobian: &[f64], vectors: &[usize], target: &[f64]) -> Option<Vec<f64>> {
    let n = weights.len();
    if let Some(change) = sparse::least_change(weights, jacobian, target, None) {
        return Some(change);
    }
    let triangle: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| if i == j { weights[i] } else { 0.0 })).collect();
    let column = [vec![0.0; n].as_slice(), target].concat();
    let mut x = NullSpace::new(n, &triangle, jacobian, vectors)?.solve_independent_rows(&column)?;
    x.truncate(n);
    Some(x)
}

/// `b − K x` of the system's matrix K, of its lower triangle of M and of A.
pub(crate) fn remainder<V: Value>(mass: &[V], jacobian: &[V], b: &[V], x: &[V], n: usize) -> Vec<V> {
    let m = |i: usize, j: usize| mass[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    let k = b.len() - n;
    let force = |i: usize| {
        let rest = (0..n).fold(b[i], |rest, j| less_product(rest, m(i, j), x[j]));
        (0..k).fold(rest, |rest, row| rest.add(jacobian[row * n + i].mul(x[n + row])))
    };
    let target = |row: usize| (0..n).fold(b[n + row], |rest, j| less_product(rest, jacobian[row * n + j], x[j]));
    (0..n).map(force).chain((0..k).map(target)).collect()
}

/// How large the terms of what [`remainder`] gives are, in the rows of A.
pub(crate) fn remainder_sizes<V: Value>(jacobian: &[V], b: &[V], x: &[V], n: usize) -> Vec<V> {
    let rows = jacobian.chunks_exact(n.max(1)).zip(&b[n..]);
    let size =
        |(row, &b): (&[V], &V)| row.iter().zip(x).fold(magnitude(b), |sum, (&a, &x)| sum.add(magnitude(a.mul(x))));
    rows.map(size).collect()
}

#[cfg(test)]
mod tests {
    use crate::expr::{Dual, Rounded, Value};

    /// A body about one axis twice where `fading` is zero, tied to a third coordinate.
    fn system<V: Value>(fading: V) -> (Vec<V>, Vec<V>) {
        let c = V::constant;
        (vec![c(0.5), c(0.25), c(0.125).add(fading), c(0.0), c(0.0), c(1.0)], vec![c(0.0), c(2.0), c(3.0)])
    }

    #[test]
    fn a_solution_is_differentiated_by_its_equation() {
        let (mass, jacobian) = system(Dual::new(0.0, 1.0));
        let column = [1.0, 0.0, 1.0, 0.0].map(Dual::fixed);
        let found = Dual::<f64>::constrained(3, mass, jacobian, &[0])(&column);
        let at = |fading: f64| {
            let (mass, jacobian) = system(fading);
            f64::constrained(3, mass, jacobian, &[0])(&[1.0, 0.0, 1.0, 0.0])
        };
        let (before, after) = (at(-1e-6), at(1e-6));
        for (i, found) in found.iter().enumerate() {
            let slope = (after[i] - before[i]) / 2e-6;
            assert!((found.derivative - slope).abs() < 1e-9, "{i}: {found:?} {slope}");
        }
    }

    /// An inertia of 1e-18 that is not known better than 1e-17 says nothing of accelerations that do not hang on it.
    #[test]
    fn bounds_follow_the_constrained_motion() {
        let fading = Rounded { value: 1e-18, error: 1e-17 };
        let (mass, jacobian) = system(fading);
        let column = [1.0, 0.0, 1.0, 0.0].map(Rounded::exact);
        let found = Rounded::constrained(3, mass, jacobian, &[0])(&column);
        let expected = [3.3125, -2.625, 1.75, 0.25];
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.error < 1e-14 && (found.value - expected).abs() <= found.error, "{found:?} {expected}");
        }
        let unknown = Rounded { value: 0.0, error: 1e-3 };
        let (mass, jacobian) = system(unknown);
        let found = Rounded::constrained(3, mass, jacobian, &[0])(&column);
        assert!(found[1].error > 1e-3 && found[1].error < 1.0, "{found:?}");
    }

    #[test]
    fn what_is_not_determined_is_nan_in_all_components() {
        let (mass, jacobian) = (vec![1.0, 0.0, 0.0], vec![1.0, 0.0]);
        assert!(f64::constrained(2, mass, jacobian, &[0])(&[1.0, 0.0, 0.0]).iter().all(|x| x.is_nan()));
        let twice = vec![1.0, 0.0, 2.0, 0.0];
        let solve = f64::constrained(2, vec![1.0, 0.0, 1.0], twice, &[0, 1]);
        assert_eq!(solve(&[0.0, 1.0, 1.0, 2.0])[..2], [1.0, 1.0]);
        assert!(solve(&[0.0, 1.0, 1.0, 3.0]).iter().all(|x| x.is_nan()));
    }
}
