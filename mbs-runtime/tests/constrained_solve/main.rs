//! `M q̈ − Aᵀ λ = f`, `A q̈ = c` against exact rational arithmetic: graded, nearly singular, redundant and singular
//! systems.

use mbs_runtime::{
    ConstraintError, Dual, SingularMassMatrix, constrained_slopes, constrained_solve, constrained_solve_many,
    constrained_solve_vectors, state_sizes, try_constrained_solve,
};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

mod columns;

/// Uniform numbers, the same in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        // SplitMix64: Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In (−1, 1).
    fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    /// A number of `0..n`.
    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.number())
    }
}

#[derive(Clone, Copy, Debug)]
struct System<const N: usize, const K: usize> {
    m: [[f64; N]; N],
    a: [[f64; N]; K],
    f: [f64; N],
    c: [f64; K],
}

type Solution<const N: usize, const K: usize> = ([f64; N], [f64; K]);

impl<const N: usize, const K: usize> System<N, K> {
    /// Of order one; M has this rank.
    fn random(random: &mut Random, rank: usize) -> Self {
        let b: [[f64; N]; N] = core::array::from_fn(|_| random.numbers());
        let m = core::array::from_fn(|i| core::array::from_fn(|j| (0..rank).map(|k| b[i][k] * b[j][k]).sum()));
        System { m, a: core::array::from_fn(|_| random.numbers()), f: random.numbers(), c: random.numbers() }
    }

    fn solve(&self) -> Solution<N, K> {
        constrained_solve(self.m, self.a, self.f, self.c)
    }

    /// `2^mass D M D`, `R A D` and so on, with exponents.
    fn in_units(&self, mass: i32, columns: [i32; N], rows: [i32; K]) -> Self {
        let two = |exponent: i32| 2f64.powi(exponent);
        let scaled = |x: f64, a: i32, b: i32| x * two(a) * two(b);
        System {
            m: core::array::from_fn(|i| core::array::from_fn(|j| scaled(self.m[i][j], columns[i] + mass, columns[j]))),
            a: core::array::from_fn(|k| core::array::from_fn(|i| scaled(self.a[k][i], rows[k], columns[i]))),
            f: core::array::from_fn(|i| scaled(self.f[i], columns[i], mass)),
            c: core::array::from_fn(|k| scaled(self.c[k], rows[k], 0)),
        }
    }

    fn bordered(&self) -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| match (i < N, j < N) {
            (true, true) => self.m[i.max(j)][i.min(j)],
            (true, false) => -self.a[j - N][i],
            (false, true) => self.a[i - N][j],
            (false, false) => 0.0,
        };
        (0..N + K).map(|i| (0..N + K).map(|j| entry(i, j)).collect()).collect()
    }

    /// The exact solution, and the condition of the bordered matrix in the maximum norm; `None` where it is singular.
    fn exact(&self) -> Option<(Solution<N, K>, f64)> {
        let (bordered, size) = (self.bordered(), N + K);
        let number = |x: f64| BigRational::from_float(x).expect("finite");
        let right = |i: usize| if i < N { self.f[i] } else { self.c[i - N] };
        // With the right side and the unit matrix.
        let row = |i: usize| {
            let unit = (0..size).map(|j| f64::from(u8::from(i == j)));
            bordered[i].iter().copied().chain([right(i)]).chain(unit).map(number).collect::<Vec<_>>()
        };
        let mut rows: Vec<Vec<BigRational>> = (0..size).map(row).collect();
        for p in 0..size {
            let pivot = (p..size).find(|&i| !rows[i][p].is_zero())?;
            rows.swap(p, pivot);
            let reciprocal = rows[p][p].recip();
            rows[p].iter_mut().for_each(|x| *x *= &reciprocal);
            let pivots = rows[p].clone();
            for i in (0..size).filter(|&i| i != p) {
                let factor = rows[i][p].clone();
                if !factor.is_zero() {
                    rows[i].iter_mut().zip(&pivots).for_each(|(x, y)| *x -= &factor * y);
                }
            }
        }
        let value = |i: usize| rows[i][size].to_f64().unwrap();
        let solution = (core::array::from_fn(value), core::array::from_fn(|k| value(N + k)));
        let norm = |row: &[BigRational]| row.iter().map(|x| x.abs()).sum::<BigRational>().to_f64().unwrap();
        let inverse = rows.iter().map(|row| norm(&row[size + 1..])).fold(0.0, f64::max);
        let direct = bordered.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        Some((solution, inverse * direct))
    }
}

fn largest<'a>(x: impl IntoIterator<Item = &'a f64>) -> f64 {
    x.into_iter().fold(0.0, |largest: f64, x| if x.is_nan() { f64::NAN } else { largest.max(x.abs()) })
}

/// The largest difference of all unknowns, as a part of the largest of them.
fn distance<const N: usize, const K: usize>(found: &Solution<N, K>, expected: &Solution<N, K>) -> f64 {
    let all = |x: &Solution<N, K>| x.0.iter().chain(&x.1).copied().collect::<Vec<_>>();
    let (found, expected) = (all(found), all(expected));
    let apart: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
    largest(&apart) / largest(&expected)
}

/// Well scaled systems, some with an M of low rank, some nearly singular; then in other units.
fn agrees_with_exact_solutions<const N: usize, const K: usize>(random: &mut Random) {
    for round in 0..6 {
        let rank = if round % 3 == 0 { N } else { N - random.below(K.min(N) + 1) };
        let rank = rank.max(N - K.min(N));
        let mut system = System::<N, K>::random(random, rank);
        let small = [1.0, 1e-3, 1e-6][round % 3];
        if K > 1 && round % 2 == 1 {
            let (first, last) = (system.a[0], system.a[K - 1]);
            system.a[K - 1] = core::array::from_fn(|i| 0.5 * first[i] + small * last[i]);
        }
        let Some((expected, condition)) = system.exact() else { continue };
        if condition > 1e13 {
            continue;
        }
        let found = system.solve();
        let error = distance(&found, &expected);
        assert!(error <= 4e-15 * condition, "{N} {K} {rank}: {error:e} at a condition of {condition:e}\n{system:?}");
        assert_eq!(try_constrained_solve(system.m, system.a, system.f, system.c), Ok(found));

        let mut exponent = |most: usize| random.below(2 * most + 1) as i32 - most as i32;
        let (mass, columns, rows) =
            (exponent(100), core::array::from_fn(|_| exponent(75)), core::array::from_fn(|_| exponent(100)));
        let (q, l) = system.in_units(mass, columns, rows).solve();
        if rank == 0 {
            // Nothing but the rows has a size: there is more than one good scale.
            let q = core::array::from_fn(|i| q[i] * 2f64.powi(columns[i]));
            let l = core::array::from_fn(|k| l[k] * 2f64.powi(rows[k] - mass));
            let error = distance(&(q, l), &expected);
            assert!(error <= 4e-15 * condition, "{N} {K}: {error:e} at a condition of {condition:e}\n{system:?}");
            continue;
        }
        for i in 0..N {
            assert_eq!(q[i] * 2f64.powi(columns[i]), found.0[i], "{N} {K}: acceleration {i} of {system:?}");
        }
        for k in 0..K {
            assert_eq!(l[k] * 2f64.powi(rows[k] - mass), found.1[k], "{N} {K}: multiplier {k} of {system:?}");
        }
    }
}

macro_rules! of_all_sizes {
    ($check:ident, $random:expr; $($n:literal: $($k:literal)+;)+) => { $($($check::<$n, $k>($random);)+)+ };
}

/// Up to as many rows as coordinates.
macro_rules! of_regular_sizes {
    ($check:ident, $random:expr) => {
        of_all_sizes!($check, $random;
            1: 0 1; 2: 0 1 2; 3: 0 1 2 3; 4: 0 1 2 3 4; 5: 0 1 2 3 4 5; 6: 1 2 3 4 5 6; 7: 1 3 5 7; 8: 1 2 4 6 8;)
    };
}

#[test]
fn regular_systems_agree_with_exact_solutions_in_all_units() {
    let mut random = Random(1);
    of_regular_sizes!(agrees_with_exact_solutions, &mut random);
}

/// Zeros of M and of A that rounding has made into something.
fn noise_spoils_nothing<const N: usize, const K: usize>(random: &mut Random) {
    for round in 0..15 {
        let mut system = System::<N, K>::random(random, N);
        // Some coordinates without inertia, no more than rows; some rows that do not know some coordinates.
        let massless = random.below(K + 1);
        for i in 0..massless {
            (0..N).for_each(|j| (system.m[i][j], system.m[j][i]) = (0.0, 0.0));
        }
        for k in 0..K {
            (0..N).filter(|_| random.below(2) == 0).for_each(|i| system.a[k][i] = 0.0);
        }
        let Some((expected, condition)) = system.exact() else { continue };
        if condition > 1e6 {
            continue;
        }
        let error = distance(&system.solve(), &expected);
        assert!(error <= 1e-14 * condition, "{N} {K} {round}: {error:e} at a condition of {condition:e}\n{system:?}");
        let noise = [1e-17, 1e-16, 1e-18][round % 3];
        for k in 0..K {
            system.a[k].iter_mut().filter(|a| **a == 0.0).for_each(|a| *a = noise);
        }
        for i in 0..massless {
            system.m[i][i] = noise * noise * 10f64.powi(-(i as i32));
        }
        let error = distance(&system.solve(), &expected);
        assert!(error <= 2e-14 * condition, "{N} {K} {round}: {error:e} at a condition of {condition:e}\n{system:?}");
    }
}

#[test]
fn rounding_in_the_place_of_zeros_changes_nothing() {
    let mut random = Random(2);
    of_all_sizes!(noise_spoils_nothing, &mut random;
        2: 1 2; 3: 1 2 3; 4: 1 2 3 4; 5: 1 2 3 4 5; 6: 2 4 6; 7: 3 5; 8: 2 4 6 8;);
}

/// Each row of A a sum of others, up to rounding; λ is not unique, q̈ and Aᵀ λ are.
fn redundant_rows_agree<const N: usize, const K: usize, const L: usize>(random: &mut Random) {
    for _ in 0..12 {
        let system = System::<N, K>::random(random, N);
        let Some((_, condition)) = system.exact() else { continue };
        if condition > 1e6 {
            continue;
        }
        let (q, l) = system.solve();
        let combination: [[f64; K]; L] = core::array::from_fn(|i| {
            core::array::from_fn(|k| if i < K { f64::from(u8::from(i == k)) } else { random.number() })
        });
        let combined = |x: &dyn Fn(usize) -> f64, i: usize| (0..K).map(|k| combination[i][k] * x(k)).sum::<f64>();
        let mut twice = System::<N, L> {
            m: system.m,
            a: core::array::from_fn(|i| core::array::from_fn(|j| combined(&|k| system.a[k][j], i))),
            f: system.f,
            c: core::array::from_fn(|i| combined(&|k| system.c[k], i)),
        };
        let (all_q, all_l) = twice.solve();
        assert!(largest(&core::array::from_fn::<f64, N, _>(|i| q[i] - all_q[i])) <= 1e-13 * condition * largest(&q));
        let force = |l: &dyn Fn(usize) -> f64, rows: &[[f64; N]]| {
            core::array::from_fn::<f64, N, _>(|i| rows.iter().enumerate().map(|(k, row)| row[i] * l(k)).sum())
        };
        let (once, again) = (force(&|k| l[k], &system.a), force(&|k| all_l[k], &twice.a));
        assert!(
            largest(&core::array::from_fn::<f64, N, _>(|i| once[i] - again[i])) <= 1e-13 * condition * largest(&once)
        );
        // Other scales of the rows share the multipliers otherwise, and give the same forces.
        let other = twice.in_units(7, [-20; N], core::array::from_fn(|i| 13 * (i as i32 % 3)));
        let (scaled_q, _) = other.solve();
        assert!((0..N).all(|i| scaled_q[i] * 2f64.powi(-20) == all_q[i]));

        twice.c[L - 1] += 1e-3;
        let (q, l) = twice.solve();
        assert!(q.iter().chain(&l).all(|x| x.is_nan()), "{q:?} {l:?}");
        let refused = try_constrained_solve(twice.m, twice.a, twice.f, twice.c);
        assert!(matches!(refused, Err(ConstraintError::Contradiction { .. })), "{refused:?}");
    }
}

#[test]
fn rows_that_depend_on_others_leave_accelerations_and_forces() {
    let mut random = Random(3);
    redundant_rows_agree::<2, 1, 2>(&mut random);
    redundant_rows_agree::<3, 1, 3>(&mut random);
    redundant_rows_agree::<3, 2, 3>(&mut random);
    redundant_rows_agree::<4, 2, 4>(&mut random);
    redundant_rows_agree::<5, 3, 4>(&mut random);
    redundant_rows_agree::<6, 4, 6>(&mut random);
    redundant_rows_agree::<8, 5, 8>(&mut random);
}

#[test]
fn multipliers_of_redundant_rows_are_least() {
    // λ₀ + 2 λ₁ = 5 is given; (λ₀)² + (2 λ₁)² is least.
    let (q, l) = constrained_solve([[1.0]], [[1.0], [2.0]], [-5.0], [0.0, 0.0]);
    assert_eq!((q, l), ([0.0], [2.5, 1.25]));
    let (_, l) = constrained_solve([[1.0]], [[1.0], [1.0], [1.0]], [-6.0], [0.0; 3]);
    assert!(l.iter().all(|l| (l - 2.0).abs() < 1e-15), "{l:?}");
}

/// A direction without inertia that the rows do not know.
fn singular_motions_are_refused<const N: usize, const K: usize>(random: &mut Random) {
    for _ in 0..20 {
        let system = System::<N, K>::random(random, N);
        let direction: [f64; N] = random.numbers();
        let square: f64 = direction.iter().map(|x| x * x).sum();
        let without = |row: &[f64; N]| {
            let along: f64 = row.iter().zip(&direction).map(|(a, b)| a * b).sum();
            core::array::from_fn(|i| row[i] - along / square * direction[i])
        };
        let half = system.m.map(|row| without(&row));
        let m: [[f64; N]; N] = core::array::from_fn(|i| core::array::from_fn(|j| half[j][i]));
        let singular = System { m: m.map(|row| without(&row)), a: system.a.map(|row| without(&row)), ..system };
        let (q, l) = singular.solve();
        assert!(q.iter().chain(&l).all(|x| x.is_nan()), "{N} {K}: {q:?} {l:?} of {singular:?}");
        let refused = try_constrained_solve(singular.m, singular.a, singular.f, singular.c);
        assert!(refused.is_err(), "{refused:?}");
    }
}

#[test]
fn motions_without_inertia_are_refused_in_all_components() {
    let mut random = Random(4);
    of_all_sizes!(singular_motions_are_refused, &mut random;
        2: 0 1; 3: 0 1 2; 4: 0 1 2 3; 5: 1 2 3 4; 6: 1 2 4; 7: 3 5; 8: 2 4 6;);
}

#[test]
fn what_is_wrong_is_said() {
    let massless = try_constrained_solve([[1.0, 0.0], [0.0, 0.0]], [[1.0, 0.0]], [0.0; 2], [0.0]);
    assert_eq!(massless, Err(ConstraintError::SingularMassMatrix(SingularMassMatrix::new(0.0, 1))));
    let against = try_constrained_solve([[1.0]], [[1.0], [4.0]], [0.0], [1.0, 0.0]);
    assert_eq!(against, Err(ConstraintError::Contradiction { row: 1, residual: -4.0 }));
    for (m, a, f, c) in [(f64::NAN, 1.0, 1.0, 1.0), (1.0, f64::INFINITY, 1.0, 1.0), (1.0, 1.0, f64::NAN, 1.0)] {
        assert_eq!(try_constrained_solve([[m]], [[a]], [f], [c]), Err(ConstraintError::NonFinite));
        let (q, l) = constrained_solve([[m]], [[a]], [f], [c]);
        assert!(q[0].is_nan() && l[0].is_nan());
        // A row that depends on the other one, too, is asked for what is not finite.
        assert_eq!(try_constrained_solve([[m]], [[a], [a]], [f], [f64::NAN, c]), Err(ConstraintError::NonFinite));
    }
    // Nothing is nothing.
    assert_eq!(constrained_solve::<f64, 0, 0>([], [], [], []), ([], []));
    // A row of zeros asks for nothing, or for what is not.
    assert_eq!(constrained_solve([[2.0]], [[0.0]], [6.0], [0.0]), ([3.0], [0.0]));
    let (q, l): ([f64; 1], [f64; 1]) = constrained_solve([[2.0]], [[0.0]], [6.0], [1.0]);
    assert!(q[0].is_nan() && l[0].is_nan());
}

/// The bordered matrix of `repro/sing.mbs`: two coordinates about one axis, tied by a row.
#[test]
fn inertia_that_fades_where_a_row_holds() {
    for angle in [1.0, 1e-3, 1e-8, 1e-9, 1e-12, 1e-200, 0.0] {
        let (ab, bb) = (1.1 * 0.7 * 0.3, 1.1 * 0.3 * 0.3 + f64::sin(angle).powi(2));
        let m = [[1.1 * 0.7 * 0.7, ab, 0.0], [ab, bb, 0.0], [0.0, 0.0, 1.0]];
        let system = System { m, a: [[0.0, 2.0, 3.0]], f: [1.0, 0.0, 1.0], c: [0.0] };
        let (expected, _) = system.exact().unwrap();
        assert!(distance(&system.solve(), &expected) < 1e-15, "{angle}");
    }
}

#[test]
fn columns_are_solved_as_if_alone_and_the_upper_triangle_is_not_read() {
    let mut random = Random(5);
    let mut system = System::<5, 2>::random(&mut random, 4);
    let other = System::<5, 2>::random(&mut random, 4);
    let (first, second) = (system.solve(), System { f: other.f, c: other.c, ..system }.solve());
    let inconsistent = [f64::NAN, 1.0];
    for i in 0..5 {
        (i + 1..5).for_each(|j| system.m[i][j] = f64::NAN);
    }
    let columns = |a: [f64; 5], b: [f64; 5]| core::array::from_fn::<_, 5, _>(|i| [a[i], b[i], 0.0]);
    let target = core::array::from_fn::<_, 2, _>(|k| [system.c[k], other.c[k], inconsistent[k]]);
    let (q, l) = constrained_solve_many(system.m, system.a, columns(system.f, other.f), target);
    assert_eq!((q.map(|q| q[0]), l.map(|l| l[0])), first);
    assert_eq!((q.map(|q| q[1]), l.map(|l| l[1])), second);
    assert!(q.iter().all(|q| q[2].is_nan()) && l.iter().all(|l| l[2].is_nan()));
}

#[test]
fn dual_numbers_differentiate_the_solution() {
    let mut random = Random(6);
    let (system, rate) = (System::<4, 2>::random(&mut random, 3), System::<4, 2>::random(&mut random, 4));
    let dual = |value: f64, derivative: f64| Dual { value, derivative };
    let (q, l) = constrained_solve(
        core::array::from_fn(|i| core::array::from_fn(|j| dual(system.m[i][j], rate.m[i][j]))),
        core::array::from_fn(|i| core::array::from_fn(|j| dual(system.a[i][j], rate.a[i][j]))),
        core::array::from_fn(|i| dual(system.f[i], rate.f[i])),
        core::array::from_fn(|i| dual(system.c[i], rate.c[i])),
    );
    assert_eq!((q.map(|q| q.value), l.map(|l| l.value)), system.solve());
    let at = |h: f64| {
        let step = |x: f64, y: f64| x + h * y;
        System::<4, 2> {
            m: core::array::from_fn(|i| core::array::from_fn(|j| step(system.m[i][j], rate.m[i][j]))),
            a: core::array::from_fn(|i| core::array::from_fn(|j| step(system.a[i][j], rate.a[i][j]))),
            f: core::array::from_fn(|i| step(system.f[i], rate.f[i])),
            c: core::array::from_fn(|i| step(system.c[i], rate.c[i])),
        }
        .exact()
        .unwrap()
        .0
    };
    let (after, before) = (at(1e-5), at(-1e-5));
    for i in 0..4 {
        let slope = (after.0[i] - before.0[i]) / 2e-5;
        assert!((q[i].derivative - slope).abs() < 1e-6 * slope.abs().max(1.0), "{} {slope}", q[i].derivative);
    }
    for i in 0..2 {
        let slope = (after.1[i] - before.1[i]) / 2e-5;
        assert!((l[i].derivative - slope).abs() < 1e-6 * slope.abs().max(1.0), "{} {slope}", l[i].derivative);
    }
}

/// One lane with a regular M, one in which a coordinate has no inertia, one in which another has none, one that is
/// singular.
#[cfg(feature = "wide")]
#[test]
fn each_lane_chooses_by_itself() {
    use wide::f64x4;
    let lane = |first: f64, second: f64| System {
        m: [[first, 0.0, 0.0], [0.0, second, 0.0], [0.0, 0.0, 1.0]],
        a: [[1.0, 2.0, -1.0]],
        f: [0.0, 0.0, 3.0],
        c: [0.5],
    };
    let lanes = [lane(1.0, 3.0), lane(0.0, 3.0), lane(2.0, 0.0), lane(0.0, 0.0)];
    let pack = |x: &dyn Fn(&System<3, 1>) -> f64| f64x4::from(lanes.each_ref().map(x));
    let (q, l) = constrained_solve(
        core::array::from_fn(|i| core::array::from_fn(|j| pack(&|s| s.m[i][j]))),
        core::array::from_fn(|i| core::array::from_fn(|j| pack(&|s| s.a[i][j]))),
        core::array::from_fn::<_, 3, _>(|i| pack(&|s| s.f[i])),
        core::array::from_fn::<_, 1, _>(|i| pack(&|s| s.c[i])),
    );
    for (number, lane) in lanes.iter().enumerate() {
        let (own_q, own_l) = lane.solve();
        let (q, l) = (q.map(|q| q.to_array()[number]), l.map(|l| l.to_array()[number]));
        assert_eq!((q.map(f64::to_bits), l.map(f64::to_bits)), (own_q.map(f64::to_bits), own_l.map(f64::to_bits)));
        assert_eq!(q[0].is_nan(), number == 3);
    }
}

#[test]
fn single_precision_has_its_own_thresholds() {
    let mut random = Random(7);
    for _ in 0..50 {
        let system = System::<5, 3>::random(&mut random, 4);
        let single = |x: f64| x as f32;
        let (m, a) = (system.m.map(|row| row.map(single)), system.a.map(|row| row.map(single)));
        let (q, l) = constrained_solve(m, a, system.f.map(single), system.c.map(single));
        let Some((expected, condition)) = system.exact() else { continue };
        let found = (q.map(f64::from), l.map(f64::from));
        if condition < 1e4 {
            assert!(distance(&found, &expected) < 1e-6 * condition, "{} {condition}", distance(&found, &expected));
        }
    }
    let (q, _) = constrained_solve([[1.0_f32, 0.0], [0.0, 1.0]], [[1.0, 1.0], [2.0, 2.000_001]], [1.0, 0.0], [0.0; 2]);
    assert!((q[0] - 0.5).abs() < 1e-6 && (q[1] + 0.5).abs() < 1e-6, "the second row depends on the first: {q:?}");
}

/// With a row that depends on others where zeros of A have become 1e-17: it does not become independent.
#[test]
fn rounding_makes_no_row_independent() {
    for (first, second) in [(1.0, 1.0), (0.0, 1.0), (1e-33, 1.0), (1.0, 1e-33)] {
        let m = [[first, 0.0, 0.0], [0.0, second, 0.0], [0.0, 0.0, 1.0]];
        let a = [[1.0, 1.0, 1e-17], [2.0, 2.0, -3e-17]];
        let (q, _) = constrained_solve(m, a, [0.0, 2.0, 5.0], [1.0, 2.0]);
        let expected = System { m, a: [[1.0, 1.0, 0.0]], f: [0.0, 2.0, 5.0], c: [1.0] }.exact().unwrap().0.0;
        let apart: Vec<f64> = q.iter().zip(&expected).map(|(a, b)| (a - b) / b.abs().max(1.0)).collect();
        assert!(largest(&apart) < 1e-14, "{first} {second}: {q:?} {expected:?}");
    }
}

/// Redundant rows, rows of zeros, an M that is regular on the constrained motion alone, in any order and in units of
/// 2^±50: N coordinates, of which K are held, by L rows.
fn everything_at_once<const N: usize, const K: usize, const L: usize>(random: &mut Random) {
    let mut measured = 0;
    for round in 0..30 {
        // Integers: sums of rows are exact, and products with 1/3 are rounded.
        let mut integer = || random.below(9) as f64 - 4.0;
        let (b, a): ([[f64; N]; N], [[f64; N]; K]) = (
            core::array::from_fn(|_| core::array::from_fn(|_| integer())),
            core::array::from_fn(|_| core::array::from_fn(|_| integer())),
        );
        let (f, c) = (core::array::from_fn(|_| integer()), core::array::from_fn(|_| integer()));
        let rank = N - random.below(K.min(N) + 1);
        let m = core::array::from_fn(|i| core::array::from_fn(|j| (0..rank).map(|k| b[i][k] * b[j][k]).sum()));
        let system = System { m, a, f, c };
        let Some((expected, condition)) = system.exact() else { continue };
        if condition > 1e6 {
            continue;
        }
        measured += 1;
        let mut order: [usize; L] = core::array::from_fn(|i| i);
        (1..L).rev().for_each(|i| order.swap(i, random.below(i + 1)));
        let factors: [[f64; K]; L] = core::array::from_fn(|i| {
            let third = [1.0, 1.0 / 3.0][round % 2];
            core::array::from_fn(|k| match i {
                _ if i < K => f64::from(u8::from(i == k)),
                // The first of those that say nothing new says nothing.
                _ if i == K => 0.0,
                _ => (random.below(5) as f64 - 2.0) * third,
            })
        });
        let combined = |x: &dyn Fn(usize) -> f64, i: usize| (0..K).map(|k| factors[order[i]][k] * x(k)).sum::<f64>();
        let all = System::<N, L> {
            m,
            a: core::array::from_fn(|i| core::array::from_fn(|j| combined(&|k| a[k][j], i))),
            f,
            c: core::array::from_fn(|i| combined(&|k| c[k], i)),
        };
        let mut exponent = || random.below(101) as i32 - 50;
        let (mass, columns, rows) =
            (exponent(), core::array::from_fn(|_| exponent()), core::array::from_fn(|_| exponent()));
        let (q, l) = all.in_units(mass, columns, rows).solve();
        let q: [f64; N] = core::array::from_fn(|i| q[i] * 2f64.powi(columns[i]));
        let l: [f64; L] = core::array::from_fn(|k| l[k] * 2f64.powi(rows[k] - mass));
        let force = |l: &[f64], rows: &[[f64; N]]| -> [f64; N] {
            core::array::from_fn(|i| rows.iter().zip(l).map(|(row, l)| row[i] * l).sum())
        };
        let (found, exact) = ((q, force(&l, &all.a)), (expected.0, force(&expected.1, &a)));
        let error = distance(&found, &exact);
        assert!(error <= 1e-13 * condition, "{N} {K} {L}: {error:e} at a condition of {condition:e}\n{all:?}");
    }
    assert!(measured > 5, "{N} {K} {L}: {measured}");
}

#[test]
fn redundant_and_empty_rows_of_singular_bodies_in_any_units() {
    let mut random = Random(8);
    everything_at_once::<2, 1, 3>(&mut random);
    everything_at_once::<3, 2, 5>(&mut random);
    everything_at_once::<4, 4, 4>(&mut random);
    everything_at_once::<4, 4, 6>(&mut random);
    everything_at_once::<5, 3, 7>(&mut random);
    everything_at_once::<6, 5, 8>(&mut random);
    everything_at_once::<8, 6, 8>(&mut random);
}

/// One entry after the other is not finite: all results are NaN. Or it is near the end of the range of doubles: all
/// are, or none.
#[test]
fn no_result_is_a_number_beside_one_that_is_none() {
    let mut random = Random(9);
    for round in 0..20 {
        let system = System::<4, 2>::random(&mut random, 4 - round % 3);
        for place in 0..10 + 8 + 4 + 2 {
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -f64::MAX, 1e200, 1e-308, 5e-324] {
                let mut spoilt = system;
                let entry = match place {
                    0..10 => {
                        let lower: Vec<(usize, usize)> = (0..4).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
                        &mut spoilt.m[lower[place].0][lower[place].1]
                    }
                    10..18 => &mut spoilt.a[(place - 10) / 4][(place - 10) % 4],
                    18..22 => &mut spoilt.f[place - 18],
                    _ => &mut spoilt.c[place - 22],
                };
                *entry = wrong;
                let (q, l) = spoilt.solve();
                let numbers = q.iter().chain(&l).filter(|x| x.is_finite()).count();
                let nans = q.iter().chain(&l).filter(|x| x.is_nan()).count();
                let allowed = if wrong.is_finite() { numbers == 6 || nans == 6 } else { nans == 6 };
                assert!(allowed, "{wrong} at {place}: {q:?} {l:?} of {system:?}");
                let checked = try_constrained_solve(spoilt.m, spoilt.a, spoilt.f, spoilt.c);
                assert_eq!(checked.is_ok(), numbers == 6, "{checked:?}");
            }
        }
    }
}

/// Lanes of which one is not finite, one contradicts itself, and one has a row that depends on the other: each as if
/// alone.
#[cfg(feature = "wide")]
#[test]
fn a_lane_that_fails_does_not_touch_others() {
    use wide::f64x4;
    let mut random = Random(10);
    for _ in 0..50 {
        let mut lanes: [System<4, 2>; 4] = core::array::from_fn(|_| System::random(&mut random, 3));
        lanes[1].f[random.below(4)] = [f64::NAN, f64::INFINITY][random.below(2)];
        for lane in [2, 3] {
            lanes[lane].a[1] = lanes[lane].a[0].map(|x| 3.0 * x);
        }
        lanes[3].c[1] = 3.0 * lanes[3].c[0];
        let pack = |x: &dyn Fn(&System<4, 2>) -> f64| f64x4::from(lanes.each_ref().map(x));
        let (q, l) = constrained_solve(
            core::array::from_fn(|i| core::array::from_fn(|j| pack(&|s| s.m[i][j]))),
            core::array::from_fn(|i| core::array::from_fn(|j| pack(&|s| s.a[i][j]))),
            core::array::from_fn::<_, 4, _>(|i| pack(&|s| s.f[i])),
            core::array::from_fn::<_, 2, _>(|i| pack(&|s| s.c[i])),
        );
        for (number, lane) in lanes.iter().enumerate() {
            let (own_q, own_l) = lane.solve();
            let own: Vec<u64> = own_q.iter().chain(&own_l).map(|x| x.to_bits()).collect();
            let found: Vec<u64> = q
                .map(|q| q.to_array()[number])
                .iter()
                .chain(&l.map(|l| l.to_array()[number]))
                .map(|x| x.to_bits())
                .collect();
            assert_eq!(found, own);
            assert_eq!(own_q[0].is_nan(), number == 1 || number == 2, "{number}: {own_q:?}");
        }
    }
}
