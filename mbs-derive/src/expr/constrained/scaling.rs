//! Powers of two that scale M and A, as the runtime's `dynamics/scaling.rs` finds them.

use crate::expr::evaluate::Value;

/// A weightless coordinate is taken before all others.
const WEIGHTLESS: i64 = 1 << 32;

/// Farther than any.
const UNREACHABLE: i64 = i64::MAX / 4;

/// An entry that is less than another of its vector in the same coordinate by more than this exponent is rounding.
const ROUNDING: i64 = 46;

/// `q = 2^−column q̂`, `λ = 2^(mass − row) λ̂`.
pub(crate) struct Scales {
    pub(super) taken: Vec<Option<usize>>,
    pub(super) columns: Vec<i32>,
    pub(super) rows: Vec<i32>,
    pub(super) small: Vec<i32>,
    pub(super) mass: i32,
}

/// Exponents of M's diagonal and of A, where they are not zero; and the row that takes each coordinate.
struct Exponents {
    inertia: Vec<Option<i64>>,
    slopes: Vec<Vec<Option<i64>>>,
    taken: Vec<Option<usize>>,
}

impl Scales {
    pub(crate) fn of<V: Value>(n: usize, diagonal: &dyn Fn(usize) -> V, a: &[&[V]], vectors: &[usize]) -> Self {
        let inertia: Vec<Option<i64>> = (0..n).map(|i| exponent(diagonal(i)).map(i64::from)).collect();
        let slopes = a.iter().map(|row| row.iter().map(|&x| exponent(x).map(i64::from)).collect()).collect();
        let mut exponents = Exponents { inertia, slopes, taken: vec![None; n] };
        exponents.forget_rounding(vectors);
        exponents.assign();
        let reference = exponents.inertia.iter().find_map(|&size| size).unwrap_or(0);
        let columns: Vec<i64> = exponents.sizes().iter().map(|size| (size - reference).div_euclid(2)).collect();
        let sizes: Vec<[i64; 2]> = (0..a.len()).map(|row| exponents.row_sizes(&columns, vectors, row)).collect();
        let small = sizes.iter().map(|[own, size]| (size - own) as i32).collect();
        let rows = sizes.iter().map(|[_, size]| *size as i32).collect();
        let columns = columns.iter().map(|&s| s as i32).collect();
        Scales { taken: exponents.taken, columns, rows, small, mass: reference as i32 }
    }

    /// An entry of M in these scales.
    pub(crate) fn mass<V: Value>(&self, i: usize, j: usize, entry: V) -> V {
        scaled(entry, -self.columns[i] - self.columns[j] - self.mass)
    }

    /// An entry of A in these scales.
    pub(crate) fn row<V: Value>(&self, row: usize, i: usize, entry: V) -> V {
        scaled(entry, -self.columns[i] - self.rows[row])
    }

    /// What a row asks for in these scales.
    pub(crate) fn target(&self, row: usize, entry: f64) -> f64 {
        scaled(entry, -self.rows[row])
    }

    /// The inertia that is one in these scales.
    pub(crate) fn weight<V: Value>(&self, i: usize) -> V {
        scaled(V::constant(1.0), 2 * self.columns[i] + self.mass)
    }
}

impl Exponents {
    fn assign(&mut self) {
        let Exponents { inertia, slopes, taken } = self;
        let (n, k) = (inertia.len(), slopes.len());
        let weight = |row: usize, i: usize| Some(2 * slopes[row][i]? - inertia[i].unwrap_or(-WEIGHTLESS));
        let (mut u, mut v) = (vec![0; k], vec![0; n]);
        for start in 0..k {
            let (mut distance, mut before, mut visited) = (vec![UNREACHABLE; n], vec![n; n], vec![false; n]);
            let (mut row, mut last, mut so_far) = (start, n, 0);
            u[start] = -(0..n).filter_map(|i| Some(weight(start, i)? + v[i])).max().unwrap_or(0);
            let free = loop {
                for i in (0..n).filter(|&i| !visited[i]) {
                    let Some(weight) = weight(row, i) else { continue };
                    let through = so_far - weight - u[row] - v[i];
                    if through < distance[i] {
                        (distance[i], before[i]) = (through, last);
                    }
                }
                let Some(next) = (0..n).filter(|&i| !visited[i]).min_by_key(|&i| distance[i]) else { break None };
                if distance[next] == UNREACHABLE {
                    break None;
                }
                (visited[next], so_far, last) = (true, distance[next], next);
                match taken[next] {
                    Some(other) => row = other,
                    None => break Some(next),
                }
            };
            let Some(mut column) = free else { continue };
            for i in (0..n).filter(|&i| visited[i] && i != column) {
                v[i] -= so_far - distance[i];
                if let Some(row) = taken[i] {
                    u[row] += so_far - distance[i];
                }
            }
            u[start] += so_far;
            while before[column] < n {
                taken[column] = taken[before[column]];
                column = before[column];
            }
            taken[column] = Some(start);
        }
    }

    fn sizes(&self) -> Vec<i64> {
        let n = self.inertia.len();
        let mut sizes = self.inertia.clone();
        self.raise(&mut sizes);
        let massless = |i: usize| self.taken[i].is_some() && self.inertia[i].is_none();
        (0..n).filter(|&i| massless(i)).for_each(|i| sizes[i] = None);
        self.relax(&mut sizes, massless);
        while let Some(i) = (0..n).find(|&i| massless(i) && sizes[i].is_none()) {
            sizes[i] = self.lower_bound(&sizes, i).or(Some(0));
            self.relax(&mut sizes, massless);
        }
        (0..n).map(|i| sizes[i].or_else(|| self.lower_bound(&sizes, i)).unwrap_or(0)).collect()
    }

    fn raise(&self, sizes: &mut [Option<i64>]) {
        for _ in 0..=self.slopes.len() {
            let mut changed = false;
            for i in (0..sizes.len()).filter(|&i| self.taken[i].is_some()) {
                let bound = self.lower_bound(sizes, i);
                if bound > sizes[i] {
                    (sizes[i], changed) = (bound, true);
                }
            }
            if !changed {
                return;
            }
        }
    }

    fn relax(&self, sizes: &mut [Option<i64>], massless: impl Fn(usize) -> bool) {
        let n = sizes.len();
        for _ in 0..=self.slopes.len() {
            let mut changed = false;
            for i in (0..n).filter(|&i| massless(i)) {
                let Some((row, own)) = self.taken[i].and_then(|row| Some((row, self.slopes[row][i]?))) else {
                    continue;
                };
                let bound = |j: usize| Some(2 * (own - self.slopes[row][j]?) + sizes[j]?);
                let least = (0..n).filter(|&j| j != i).filter_map(bound).min();
                if let Some(least) = least.filter(|&least| sizes[i].is_none_or(|size| least < size)) {
                    (sizes[i], changed) = (Some(least), true);
                }
            }
            if !changed {
                return;
            }
        }
    }

    fn forget_rounding(&mut self, vectors: &[usize]) {
        let k = self.slopes.len();
        for i in 0..self.taken.len() {
            for row in 0..k {
                let beside = (0..k).filter(|&other| vectors[other] == vectors[row]).filter_map(|k| self.slopes[k][i]);
                if beside.max() > self.slopes[row][i].map(|slope| slope + ROUNDING) {
                    self.slopes[row][i] = None;
                }
            }
        }
    }

    /// Of the row, and of its vector in the coordinates that it moves.
    fn row_sizes(&self, columns: &[i64], vectors: &[usize], row: usize) -> [i64; 2] {
        let vector = || self.slopes.iter().zip(vectors).filter(|(_, vector)| **vector == vectors[row]);
        let greatest = |i: usize| Some(vector().filter_map(|(slopes, _)| slopes[i]).max()? - columns[i]);
        let all = || 0..columns.len();
        let moved = || all().filter(|&i| self.slopes[row][i].is_some());
        let own = moved().filter_map(|i| Some(self.slopes[row][i]? - columns[i])).max();
        let size = moved().filter_map(greatest).max().or_else(|| all().filter_map(greatest).max());
        let size = size.unwrap_or(0);
        [own.unwrap_or(size - ROUNDING), size]
    }

    fn lower_bound(&self, sizes: &[Option<i64>], coordinate: usize) -> Option<i64> {
        let bound = |i: usize| {
            let row = &self.slopes[self.taken[i]?];
            Some(sizes[i]? + 2 * (row[coordinate]? - row[i]?))
        };
        (0..sizes.len()).filter(|&i| i != coordinate).filter_map(bound).max()
    }
}

pub(super) fn scaled<V: Value>(mut x: V, mut exponent: i32) -> V {
    const MOST: i32 = 100;
    while exponent.abs() > MOST {
        let step = exponent.clamp(-MOST, MOST);
        x = x.mul(power(step));
        exponent -= step;
    }
    x.mul(power(exponent))
}

/// `2^exponent`
pub(in crate::expr) fn power<V: Value>(exponent: i32) -> V {
    V::constant(f64::from_bits(((1023 + exponent) as u64) << 52))
}

/// Of a number that is not zero.
pub(super) fn exponent<V: Value>(x: V) -> Option<i32> {
    let zero = V::constant(0.0);
    (!(x.less_equal(zero) && zero.less_equal(x))).then(|| x.exponent())
}
