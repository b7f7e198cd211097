use core::ops::ControlFlow;

use super::dense::{balance, identity, norm, scaled, solve, sum};
use super::*;
use crate::{Dop853, IntegrationError, Rk4, State};

/// Numbers between −1 and 1, the same in every run (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn matrix<const M: usize, const N: usize>(&mut self) -> [[f64; N]; M] {
        core::array::from_fn(|_| core::array::from_fn(|_| self.next()))
    }
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:?}, not {expected:?}");
}

fn all_close<const M: usize, const N: usize>(found: &[[f64; N]; M], expected: &[[f64; N]; M], tolerance: f64) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() <= tolerance, "{found:?}, not {expected:?}");
    }
}

fn system<const N: usize, const U: usize>(a: [[f64; N]; N], b: [[f64; U]; N]) -> StateSpace<N, U, N> {
    StateSpace { a, b, c: identity(1.0), d: [[0.0; U]; N] }
}

/// The matrix with this characteristic polynomial, `xⁿ + c[n−1] xⁿ⁻¹ + … + c[0]`.
fn companion<const N: usize>(c: [f64; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            if i + 1 == N {
                -c[j]
            } else if j == i + 1 {
                1.0
            } else {
                0.0
            }
        })
    })
}

#[test]
fn poles_of_known_polynomials() {
    // (x + 1)(x + 2)(x² + 2x + 5)
    let found = system(companion([10.0, 19.0, 13.0, 5.0]), [[]; 4]).poles().unwrap();
    for (re, im) in [(-2.0, 0.0), (-1.0, -2.0), (-1.0, 0.0), (-1.0, 2.0)] {
        assert!(found.iter().any(|z| (z.re - re).hypot(z.im - im) < 1e-13), "{found:?}");
    }
    // Roots of one: shifts would go in circles but for the exceptional ones.
    let found = system(companion([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [[]; 8]).poles().unwrap();
    for k in 0..8 {
        let (im, re) = (core::f64::consts::FRAC_PI_4 * f64::from(k)).sin_cos();
        assert!(found.iter().any(|z| (z.re - re).hypot(z.im - im) < 1e-14), "{found:?}");
    }
    // A triangle, a zero, one state, none.
    assert_eq!(system([[3.0, 7.0], [0.0, -1.0]], [[]; 2]).poles().unwrap().map(|z| z.re), [3.0, -1.0]);
    assert_eq!(system([[0.0; 5]; 5], [[]; 5]).poles().unwrap(), [Complex::new(0.0, 0.0); 5]);
    assert_eq!(system([[4.0]], [[]]).poles().unwrap()[0].re, 4.0);
    assert_eq!(system([[0.0; 0]; 0], [[0.0; 0]; 0]).poles(), Ok([]));
    let nan = system([[f64::NAN]], [[]]).poles();
    assert_eq!(nan, Err(ControlError::NotFinite { matrix: 'A' }));
}

/// Disks that roll in circles, where most poles are zero and rounding has left entries from 1e-32 on: beside zeros and
/// noise on the diagonal none below it ever gets small enough.
#[test]
fn poles_beside_zeros_and_noise() {
    // Coordinates, then rates of heading, lean and spin; the motion of the first five follows from these and from
    // heading and lean.
    let disk = |[x, y, heading, lean]: [[f64; 2]; 4], noise: [f64; 4], spin: f64| {
        let mut a = [[0.0; 8]; 8];
        [a[0][3], a[0][5], a[0][7]] = [x[0], x[1], 0.3];
        [a[1][2], a[1][6]] = y;
        [a[2][5], a[3][6], a[4][7]] = [1.0; 3];
        [a[5][2], a[5][4], a[7][2], a[7][4]] = noise;
        [a[5][6], a[6][3], a[6][5], a[6][7], a[7][6]] = [heading[0], lean[0], lean[1], spin, heading[1]];
        a
    };
    let systems = [
        disk(
            [
                [0.360641229885174, 0.12684048154924807],
                [-2.272128595751089, -0.27186668100441225],
                [17.95282295883539, -9.594044752474558],
                [30.312224596927337, -7.829601626203985],
            ],
            [1.8864240090489774e-15, 3.4742994826375137e-32, -7.97583099046118e-16, -3.700743415417188e-16],
            1.442564919540696,
        ),
        disk(
            [
                [0.7189744634921913, 0.26365206170646077],
                [-2.177532350107116, -0.1431348677224826],
                [48.93107444565296, -46.99689810531902],
                [60.57301067286922, -2.4707742909066694],
            ],
            [6.417463817996191e-14, 7.888609052210118e-31, -4.391018173713041e-14, -9.868649107779178e-16],
            2.8758978539687656,
        ),
    ];
    for a in systems {
        let square = -(a[6][3] + a[6][5] * a[5][6] + a[6][7] * a[7][6]);
        let mut poles = StateSpace { a, b: [[]; 8], c: [], d: [] }.poles().unwrap();
        poles.sort_by(|x, y| x.re.hypot(x.im).total_cmp(&y.re.hypot(y.im)));
        // Zeros in chains of up to three are as far off as the cube root of rounding.
        assert!(poles[..6].iter().all(|pole| pole.re.hypot(pole.im) < 1e-4), "{poles:?}");
        for pole in &poles[6..] {
            assert!(pole.re.abs() < 1e-10 && (pole.im.abs() - square.sqrt()).abs() < 1e-10, "{pole:?} {square}");
        }
    }
}

/// `T diag(blocks) T⁻¹` in units that are far apart.
#[test]
fn poles_of_random_systems_in_any_units() {
    let mut numbers = Numbers(5);
    for _ in 0..300 {
        let mut blocks = [[0.0; 7]; 7];
        let mut expected = [Complex::new(0.0, 0.0); 7];
        for k in 0..3 {
            let (re, im) = (3.0 * numbers.next(), 3.0 * numbers.next().abs() + 0.1);
            (blocks[2 * k][2 * k], blocks[2 * k + 1][2 * k + 1]) = (re, re);
            (blocks[2 * k][2 * k + 1], blocks[2 * k + 1][2 * k]) = (im, -im);
            (expected[2 * k], expected[2 * k + 1]) = (Complex::new(re, im), Complex::new(re, -im));
        }
        blocks[6][6] = numbers.next();
        expected[6] = Complex::new(blocks[6][6], 0.0);
        let turn = sum(&identity(2.0), &numbers.matrix::<7, 7>());
        let Some(back) = solve(turn, identity(1.0)) else { continue };
        let condition = norm(&turn) * norm(&back);
        if condition > 1e3 {
            continue;
        }
        let mut a = product(&product(&turn, &blocks), &back);
        let units: [f64; 7] = core::array::from_fn(|_| (30.0 * numbers.next()).exp2());
        a = core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] * units[i] / units[j]));
        let found = system(a, [[]; 7]).poles().unwrap();
        for expected in expected {
            let error = found.iter().map(|z| (z.re - expected.re).hypot(z.im - expected.im)).fold(9.0, f64::min);
            assert!(error < 1e-13 * condition, "{error:e}: {expected:?} of {found:?}");
        }
    }
}

#[test]
fn frequencies_and_damping() {
    let pole = Complex::new(-3.0, 4.0);
    assert_eq!((natural_frequency(pole), damping_ratio(pole)), (5.0, 0.6));
    assert_eq!((damping_ratio(Complex::new(2.0, 0.0)), damping_ratio(Complex::new(0.0, 0.0))), (-1.0, 1.0));
    assert_eq!(natural_frequency(Complex::new(3e300, -4e300)), 5e300);
    let z = Complex::new((-0.3_f64).exp() * 0.4_f64.cos(), (-0.3_f64).exp() * 0.4_f64.sin());
    let back = continuous_pole(z, 0.1);
    close(back.re, -3.0, 1e-14);
    close(back.im, 4.0, 1e-14);
}

#[test]
fn reach_of_inputs_in_any_units() {
    // Two masses and a spring: reached from either; the difference alone does not show their common motion.
    let (k, m) = (40.0, [2.0, 3.0]);
    let a =
        [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [-k / m[0], k / m[0], 0.0, 0.0], [k / m[1], -k / m[1], 0.0, 0.0]];
    for unit in [1.0, 1e-9, 1e9] {
        let b = [[0.0], [0.0], [unit / m[0]], [0.0]];
        let pushed = StateSpace { a, b, c: [[unit, -unit, 0.0, 0.0]], d: [[0.0]] };
        assert_eq!((pushed.controllability_rank(), pushed.observability_rank()), (Ok(4), Ok(2)));
        // A force between them leaves the common motion alone.
        let between = StateSpace { b: [[0.0], [0.0], [unit / m[0]], [-unit / m[1]]], ..pushed };
        assert_eq!(between.controllability_rank(), Ok(2));
        // Positions in micrometres, velocities in kilometres per second.
        let scale = [1e6, 1e6, 1e-3, 1e-3];
        let a = core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] * scale[i] / scale[j]));
        let b = core::array::from_fn(|i| [b[i][0] * scale[i]]);
        assert_eq!(StateSpace { a, b, ..pushed }.controllability_rank(), Ok(4));
    }
    // A chain of ten integrators, equal ones side by side, and no input at all.
    let chain: [[f64; 10]; 10] = core::array::from_fn(|i| core::array::from_fn(|j| if j == i + 1 { 1e3 } else { 0.0 }));
    assert_eq!(
        system(chain, core::array::from_fn(|i| [if i == 9 { 1.0 } else { 0.0 }])).controllability_rank(),
        Ok(10)
    );
    assert_eq!(system(identity::<3>(-1.0), [[1.0], [1.0], [1.0]]).controllability_rank(), Ok(1));
    assert_eq!(system(identity::<3>(-1.0), [[]; 3]).controllability_rank(), Ok(0));
    assert_eq!(
        system([[0.0; 2]; 2], [[f64::INFINITY]; 2]).controllability_rank(),
        Err(ControlError::NotFinite { matrix: 'B' })
    );
}

#[test]
fn samples_of_known_motions() {
    // A mass; an oscillator of 3 rad/s with damping 0.2; a stiff pair.
    for t in [1e-9, 0.1, 1.0, 30.0] {
        let mass = system([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]]).sampled(t).unwrap();
        all_close(&mass.a, &[[1.0, t], [0.0, 1.0]], 1e-15 * t);
        all_close(&mass.b, &[[0.5 * t * t], [t]], 4e-16 * (t + t * t));
        let (w, z) = (3.0_f64, 0.2_f64);
        let swing = system([[0.0, 1.0], [-w * w, -2.0 * z * w]], [[0.0], [w * w]]).sampled(t).unwrap();
        let (decay, wd) = ((-z * w * t).exp(), w * (1.0 - z * z).sqrt());
        let (s, c) = (wd * t).sin_cos();
        let first = decay * (c + z * w / wd * s);
        all_close(&swing.a, &[[first, decay * s / wd], [-w * w / wd * decay * s, decay * (c - z * w / wd * s)]], 1e-13);
        // From rest towards where the input pulls.
        all_close(&swing.b, &[[1.0 - first], [w * w / wd * decay * s]], 1e-13);
    }
    let stiff = system([[-1.0, 0.0], [0.0, -1e6]], [[1.0], [1e6]]).sampled(1.0).unwrap();
    // What squaring leaves: rounding times the norm of A T.
    all_close(&stiff.a, &[[(-1.0_f64).exp(), 0.0], [0.0, 0.0]], 1e-10);
    all_close(&stiff.b, &[[1.0 - (-1.0_f64).exp()], [1.0]], 1e-10);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(stiff.sampled(value), Err(ControlError::SampleTime { .. })), "{value}");
    }
    let grows = system([[1e3]], [[1.0]]).sampled(1.0);
    assert_eq!(grows, Err(ControlError::NotFinite { matrix: 'A' }));
}

/// In units that are powers of two apart not a bit changes.
#[test]
fn samples_do_not_depend_on_units() {
    let sampled = |u: f64| {
        let a = [[-1.0, u, u * u], [0.3 / u, -2.0, u], [0.1 / u / u, 0.7 / u, -0.5]];
        let found = system(a, [[u * u], [u], [1.0]]).sampled(1.0).unwrap();
        let unit = [u * u, u, 1.0];
        let phi: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| found.a[i][j] / unit[i] * unit[j]));
        (phi, core::array::from_fn::<_, 3, _>(|i| found.b[i][0] / unit[i]))
    };
    let expected = sampled(1.0);
    // The series of the exponential, summed.
    close(expected.0[0][0], 0.454_673_389_813_766_2, 1e-15);
    assert_eq!([sampled(2.0_f64.powi(20)), sampled(2.0_f64.powi(-40))], [expected; 2]);
    all_close(&sampled(1e9).0, &expected.0, 1e-14);
}

/// Twice half the time is the time, for random systems.
#[test]
fn samples_compose() {
    let mut numbers = Numbers(6);
    for size in [0.01, 1.0, 20.0] {
        for _ in 0..50 {
            let plant = system(scaled(size, &numbers.matrix::<5, 5>()), numbers.matrix::<5, 2>());
            let (half, whole) = (plant.sampled(0.5).unwrap(), plant.sampled(1.0).unwrap());
            let twice = product(&half.a, &half.a);
            let input = sum(&product(&half.a, &half.b), &half.b);
            let growth = norm(&half.a) * norm(&half.a);
            all_close(&twice, &whole.a, 1e-13 * growth * size.max(1.0));
            all_close(&input, &whole.b, 1e-13 * growth * norm(&half.b) * size.max(1.0));
        }
    }
}

#[test]
fn regulators_of_textbooks() {
    // The double integrator with Q = diag(1, 0), R = 1: K = (1, √2), X = [[√2, 1], [1, √2]] (Anderson and Moore, 1990).
    let root = 2.0_f64.sqrt();
    let found = lqr(&[[0.0, 1.0], [0.0, 0.0]], &[[0.0], [1.0]], &[[1.0, 0.0], [0.0, 0.0]], &[[1.0]]).unwrap();
    all_close(&found.gain, &[[1.0, root]], 1e-14);
    all_close(&found.cost, &[[root, 1.0], [1.0, root]], 1e-14);
    // One state: x = (a + √(a² + g h))/g, unstable ones too.
    for (a, b, q, r) in [(1.0, 1.0, 1.0, 1.0), (-2.0, 3.0, 0.5, 4.0), (5.0, 1e-3, 1e-6, 1.0), (0.0, 1e6, 1e-9, 1e9)] {
        let g: f64 = b * b / r;
        let x = (a + f64::sqrt(a * a + g * q)) / g;
        let found = lqr(&[[a]], &[[b]], &[[q]], &[[r]]).unwrap();
        close(found.cost[0][0] / x, 1.0, 1e-13);
        close(found.gain[0][0] / (b * x / r), 1.0, 1e-13);
    }
    // Controllable, but far from stable: as SciPy 1.17 has it.
    let (a, b) = ([[4.0, -2.0, -2.0], [0.0, 5.0, 3.0], [1.0, 2.0, -2.0]], [[3.0], [-2.0], [-1.0]]);
    let found = discrete_lqr(&a, &b, &identity(1.0), &[[1.0]]).unwrap();
    all_close(&found.gain, &[[10.8166, 11.2925, 2.8831]], 1e-4);
    // x' = a x + u, Q = R = 1: X² − a² X − 1 = 0.
    for a in [0.0_f64, 0.5, 1.0, -3.0] {
        let x = 0.5 * (a * a + (a.powi(4) + 4.0).sqrt());
        let found = discrete_lqr(&[[a]], &[[1.0]], &[[1.0]], &[[1.0]]).unwrap();
        close(found.cost[0][0], x, 1e-14 * x);
        close(found.gain[0][0], a * x / (1.0 + x), 1e-14);
    }
}

/// Residuals of the equations, and stability, of random systems in units up to a million apart.
#[test]
fn riccati_equations_are_satisfied_in_any_units() {
    let mut numbers = Numbers(7);
    for round in 0..200 {
        let (a, b) = (scaled(2.0, &numbers.matrix::<6, 6>()), numbers.matrix::<6, 2>());
        let out = numbers.matrix::<3, 6>();
        let q = product(&transpose(&out), &out);
        let r = [[1.0, 0.2], [0.2, 0.5]];
        let plain = lqr(&a, &b, &q, &r).unwrap();
        let x = plain.cost;
        let xa = product(&x, &a);
        let quadratic = product(&transpose(&plain.gain), &product(&r, &plain.gain));
        let left = difference(&sum(&sum(&xa, &transpose(&xa)), &q), &quadratic);
        assert!(norm(&left) < 1e-11 * (norm(&q) + norm(&quadratic) + norm(&xa)), "{round}: {:e}", norm(&left));
        assert!((0..6).all(|i| x[i][i] > 0.0 && (0..6).all(|j| x[i][j] == x[j][i])));

        let scale: [f64; 6] = core::array::from_fn(|_| (20.0 * numbers.next()).exp2());
        let again = lqr::<6, 2>(
            &core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] * scale[i] / scale[j])),
            &core::array::from_fn(|i| b[i].map(|entry| entry * scale[i])),
            &core::array::from_fn(|i| core::array::from_fn(|j| q[i][j] / scale[i] / scale[j])),
            &r,
        );
        let gain = again.unwrap().gain.map(|row| core::array::from_fn(|j| row[j] * scale[j]));
        all_close(&gain, &plain.gain, 1e-9 * norm(&plain.gain));

        let sampled = system(a, b).sampled(0.3).unwrap();
        let found = discrete_lqr(&sampled.a, &sampled.b, &q, &r).unwrap();
        let closed = sampled.with_feedback(&found.gain).a;
        let stay = product(&transpose(&closed), &product(&found.cost, &closed));
        let effort = product(&transpose(&found.gain), &product(&r, &found.gain));
        let left = difference(&sum(&sum(&stay, &q), &effort), &found.cost);
        // The largest of the terms that are summed, as they round.
        let rounding = 1e-13 * (1.0 + norm(&closed).powi(2)) * norm(&found.cost);
        assert!(norm(&left) < rounding, "{round}: {:e} {rounding:e}", norm(&left));
    }
}

#[test]
fn what_cannot_be_regulated_is_refused() {
    let weight = [[1.0, 0.0], [0.0, 1.0]];
    // An unstable motion that no input reaches; a swinging one that costs nothing is left alone only if it decays.
    let unreached = lqr(&[[1.0, 0.0], [0.0, -1.0]], &[[0.0], [1.0]], &weight, &[[1.0]]);
    assert_eq!(unreached, Err(ControlError::NotStabilizable));
    let unseen = lqr(&[[0.0, 1.0], [-1.0, 0.0]], &[[0.0], [1.0]], &[[0.0; 2]; 2], &[[1.0]]);
    assert_eq!(unseen, Err(ControlError::NotStabilizable));
    assert_eq!(lqr(&[[5.0]], &[[1.0]], &[[0.0]], &[[1.0]]), Err(ControlError::NotStabilizable));
    let decays = lqr(&[[0.0, 1.0], [-1.0, -1.0]], &[[0.0], [1.0]], &[[0.0; 2]; 2], &[[1.0]]).unwrap();
    assert_eq!(decays.gain, [[0.0; 2]]);
    let unreached = discrete_lqr(&[[2.0, 0.0], [0.0, 0.5]], &[[0.0], [1.0]], &weight, &[[1.0]]);
    assert_eq!(unreached, Err(ControlError::NotStabilizable));

    let (a, b) = ([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]]);
    let lopsided = lqr(&a, &b, &[[1.0, 0.1], [0.2, 1.0]], &[[1.0]]);
    assert_eq!(lopsided, Err(ControlError::NotSymmetric { matrix: 'Q', row: 1, column: 0 }));
    for (q, r, matrix) in [
        ([[1.0, 2.0], [2.0, 1.0]], 1.0, 'Q'),
        ([[1.0, 0.0], [0.0, -1e-3]], 1.0, 'Q'),
        ([[0.0, 1.0], [1.0, 0.0]], 1.0, 'Q'),
        (weight, 0.0, 'R'),
        (weight, -1.0, 'R'),
    ] {
        let found = lqr(&a, &b, &q, &[[r]]);
        assert!(matches!(found, Err(ControlError::NotPositive { matrix: found, .. }) if found == matrix), "{found:?}");
        assert_eq!(discrete_lqr(&a, &b, &q, &[[r]]).unwrap_err(), found.unwrap_err());
    }
    // Semidefinite, and far apart: no reason to refuse.
    for q in [[[1.0, 1e-9], [1e-9, 1e-18]], [[1e12, 0.0], [0.0, 0.0]], [[4.0, 2.0], [2.0, 1.0]]] {
        assert!(lqr(&a, &b, &q, &[[1e-12]]).is_ok(), "{q:?}");
    }
    let nan = lqr(&a, &[[f64::NAN], [1.0]], &weight, &[[1.0]]);
    assert_eq!(nan, Err(ControlError::NotFinite { matrix: 'B' }));
}

/// Rounding must not make motions decay that no input reaches or no weight sees; what decays by itself may be slow.
#[test]
fn motions_that_stay_are_refused() {
    let one = identity::<4>(1.0);
    // Two masses with a force between them, free or with a spring and a damper: their common motion stays.
    for ((m, n), (k, c)) in [(5.0, 2.0), (4.0, 8.0), (3.0, 7.0), (9.0, 1.0)]
        .into_iter()
        .flat_map(|masses| [(0.0, 0.0), (100.0, 1.0), (1.0, 0.0)].map(|spring| (masses, spring)))
    {
        let a = [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-k / m, k / m, -c / m, c / m],
            [k / n, -k / n, c / n, -c / n],
        ];
        let between = system(a, [[0.0], [0.0], [1.0 / m], [-1.0 / n]]);
        assert_eq!(lqr(&a, &between.b, &one, &[[1.0]]), Err(ControlError::NotStabilizable), "{m} {n} {k}");
        let sampled = between.sampled(0.1).unwrap();
        assert_eq!(
            discrete_lqr(&sampled.a, &sampled.b, &one, &[[1.0]]),
            Err(ControlError::NotStabilizable),
            "{m} {n} {k}"
        );
    }
    // The place of a mass that costs nothing, the velocity alone does.
    let (a, b) = ([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]]);
    let unseen = lqr(&a, &b, &[[0.0, 0.0], [0.0, 1.0]], &[[1.0]]);
    assert_eq!(unseen, Err(ControlError::NotStabilizable));
    // −2 a x = q for what decays alone; x² = 1 − 2 x for the rest.
    for slow in [1e-3, 1e-6, 1e-9] {
        let found = lqr(&[[-slow, 0.0], [0.0, -1.0]], &[[0.0], [1.0]], &identity(1.0), &[[1.0]]).unwrap();
        all_close(&found.gain, &[[0.0, 2.0_f64.sqrt() - 1.0]], 1e-14);
        close(found.cost[0][0] * 2.0 * slow, 1.0, 1e-9);
        let found = discrete_lqr(&[[1.0 - slow, 0.0], [0.0, 1.0]], &[[0.0], [1.0]], &identity(1.0), &[[1.0]]).unwrap();
        all_close(&found.gain, &[[0.0, (5.0_f64.sqrt() - 1.0) / 2.0]], 1e-14);
        close(found.cost[0][0] * slow * (2.0 - slow), 1.0, 1e-6);
    }
    let mut numbers = Numbers(8);
    for hidden in [0.0, 1.0] {
        for _ in 0..100 {
            let (mut a, mut b) = (scaled(2.0, &numbers.matrix::<5, 5>()), numbers.matrix::<5, 2>());
            (a[4], b[4]) = ([0.0, 0.0, 0.0, 0.0, hidden], [0.0; 2]);
            let turn = sum(&identity(2.0), &numbers.matrix::<5, 5>());
            let Some(back) = solve(turn, identity(1.0)) else { continue };
            let (a, b) = (product(&product(&turn, &a), &back), product(&turn, &b));
            assert!(lqr(&a, &b, &identity(1.0), &identity(1.0)).is_err(), "{a:?}");
            let next = sum(&a, &identity(1.0));
            assert!(discrete_lqr(&next, &b, &identity(1.0), &identity(1.0)).is_err(), "{next:?}");
        }
    }
}

/// What the inputs reach can be regulated, be it ever so unstable.
#[test]
fn controllable_systems_of_integers_have_regulators() {
    let mut numbers = Numbers(9);
    for _ in 0..300 {
        let a = numbers.matrix::<4, 4>().map(|row| row.map(|entry| (5.4 * entry).round()));
        let b = numbers.matrix::<4, 1>().map(|row| row.map(|entry| (3.4 * entry).round()));
        let plant = system(a, b);
        if plant.controllability_rank() != Ok(4) {
            continue;
        }
        let slow = plant.with_feedback(&lqr(&a, &b, &identity(1.0), &[[1.0]]).unwrap().gain).poles().unwrap();
        assert!(slow.iter().all(|pole| pole.re < 0.0), "{a:?} {b:?}");
        let found = discrete_lqr(&a, &b, &identity(1.0), &[[1.0]]).unwrap();
        let poles = plant.with_feedback(&found.gain).poles().unwrap();
        assert!(poles.iter().all(|&pole| natural_frequency(pole) < 1.0), "{a:?} {b:?}");
    }
}

#[test]
fn balance_keeps_a_similarity() {
    let mut a = [[1.0, 1e9, 0.0], [1e-7, 2.0, 1e3], [0.0, 1e-5, 3.0]];
    let before = a;
    let d = balance(&mut a, &mut [[]; 3]);
    all_close(&core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] * d[i] / d[j])), &before, 0.0);
    assert!(norm(&a) < 1e3, "{a:?}");
}

/// A mass under sampled feedback with a delay follows the recursion that the exponential gives.
#[test]
fn a_sampled_loop_follows_its_recursion() {
    let (time, delay) = (0.2, 0.07);
    let gain = [1.3, 1.9];
    let plant = system([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]]);
    let (early, late) = (plant.sampled(delay).unwrap(), plant.sampled(time - delay).unwrap());
    let (mut x, mut before) = ([[1.0], [-0.5]], [[0.25]]);
    let mut expected = [[0.0; 2]; 20];
    for entry in &mut expected {
        let u = [[-gain[0] * x[0][0] - gain[1] * x[1][0]]];
        let middle = sum(&product(&early.a, &x), &product(&early.b, &before));
        x = sum(&product(&late.a, &middle), &product(&late.b, &u));
        before = u;
        *entry = [x[0][0], x[1][0]];
    }
    let sampled = SampledLoop { sample_time: time, delay, initial: [0.25] };
    let law = |_: f64, state: &State<[f64; 1]>| [-gain[0] * state.q[0] - gain[1] * state.qd[0]];
    let pushed = |_: f64, _: &[f64; 1], _: &[f64; 1], u: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = u[0];
    for k in [0, 3, 19] {
        let mut state = State::new([1.0], [-0.5]);
        let end = time * (k + 1) as f64;
        let summary = sampled
            .integrate(&Rk4::new(0.05), law, pushed, 0.0, end, &mut state, |_, _| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!((summary.time, summary.stopped), (end, false));
        close(state.q[0], expected[k][0], 1e-13);
        close(state.qd[0], expected[k][1], 1e-13);
    }
    // A whole sample late, from another time on, to a time between two samples, and stopped by the observer.
    let late = SampledLoop { sample_time: 0.5, delay: 0.5, initial: [1.0] };
    let mut changes = std::vec![];
    let mut state = State::new([0.0], [0.0]);
    let summary = late.integrate(
        &Dop853::new(1e-9, 1e-9),
        |t, _| [t],
        pushed,
        10.0,
        11.25,
        &mut state,
        |step, u| {
            changes.push((step.time(), u[0]));
            if step.time() > 11.1 { ControlFlow::Break(11.2) } else { ControlFlow::Continue(()) }
        },
    );
    assert!(summary.is_ok_and(|summary| summary.stopped && summary.time == 11.2));
    assert!(
        changes.iter().all(|&(t, u)| u
            == if t <= 10.5 {
                1.0
            } else if t <= 11.0 {
                10.0
            } else {
                10.5
            }),
        "{changes:?}"
    );
    close(state.qd[0], 0.5 + 5.0 + 0.2 * 10.5, 1e-12);
}

/// k samples of T seconds are k calls and, by steps of T, k steps, whatever rounding makes of k T.
#[test]
fn a_sampled_loop_of_whole_samples_has_that_many() {
    let run = |[sample_time, delay]: [f64; 2], t: f64, t_end: f64| {
        let mut calls = 0;
        let mut state = State::new([0.0], [0.0]);
        let law = |_: f64, _: &State<[f64; 1]>| {
            calls += 1;
            [1.0]
        };
        let pushed = |_: f64, _: &[f64; 1], _: &[f64; 1], u: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = u[0];
        let summary = SampledLoop { sample_time, delay, initial: [0.0] }
            .integrate(&Rk4::new(sample_time), law, pushed, t, t_end, &mut state, |_, _| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!(summary.time, t_end);
        (calls, summary.accepted)
    };
    assert_eq!(run([0.03, 0.0], 0.0, 0.33), (11, 11));
    assert_eq!(run([0.03, 0.01], 0.0, 0.33), (11, 22));
    for hundredths in 1..=50 {
        for k in 1..=40 {
            let (sample_time, t_end) = (f64::from(hundredths) / 100.0, f64::from(hundredths * k) / 100.0);
            let expected = (k, k as usize);
            for delay in [0.0, sample_time] {
                assert_eq!(run([sample_time, delay], 0.0, t_end), expected, "{k} of {sample_time}, {delay} late");
                assert_eq!(run([sample_time, delay], 100.0, 100.0 + t_end), expected, "{k} of {sample_time} from 100");
            }
        }
    }
    // What is more than rounding has its sample.
    assert_eq!(run([0.1, 0.0], 0.0, 0.3 + 1e-12), (4, 4));
}

#[test]
fn times_of_a_loop_are_checked() {
    let run = |sample_time: f64, delay: f64, t: f64, t_end: f64| {
        SampledLoop { sample_time, delay, initial: [0.0] }
            .integrate(
                &Rk4::new(0.1),
                |_, _| [0.0],
                |_, _: &[f64; 1], _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0,
                t,
                t_end,
                &mut State::new([0.0], [1.0]),
                |_, _| ControlFlow::Continue(()),
            )
            .map(|summary| summary.time)
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(run(bad, 0.0, 0.0, 1.0), Err(IntegrationError::InvalidStep { .. })), "{bad}");
    }
    for bad in [-0.1, 0.6, f64::NAN] {
        assert!(matches!(run(0.5, bad, 0.0, 1.0), Err(IntegrationError::InvalidStep { .. })), "{bad}");
    }
    for (t, t_end, bad) in [(0.0, -1.0, -1.0), (f64::INFINITY, 1.0, f64::INFINITY), (0.0, f64::INFINITY, f64::INFINITY)]
    {
        assert_eq!(run(0.5, 0.0, t, t_end), Err(IntegrationError::InvalidTime { time: bad }), "{t} {t_end}");
    }
    assert!(matches!(run(0.5, 0.0, f64::NAN, 1.0), Err(IntegrationError::InvalidTime { time }) if time.is_nan()));
    assert_eq!(run(0.5, 0.1, 2.0, 2.0), Ok(2.0));
    assert_eq!(run(1e-20, 0.0, 1.0, 2.0), Err(IntegrationError::InvalidStep { step: 1e-20 }));
}
