//! Columns that are solved together, and rows of one vector.

use super::*;

/// x = y, said twice; of the columns all targets are differences of larger terms.
#[test]
fn a_column_of_rounding_is_no_contradiction_among_others() {
    let (m, a) = ([[1.0, 0.0], [0.0, 3.0]], [[1.0, -1.0], [-2.0, 2.0]]);
    let force = [[1.0, 1e-17, 0.0], [7.0, 0.0, -1e-17]];
    let target = [[0.0, 1e-17, -2e-17], [0.0, 1e-17, 3e-17]];
    let slopes = |motion: f64, sizes: [f64; 3]| constrained_slopes(m, a, force, target, [0, 1], &[motion; 2], sizes);
    let nans = |slopes: [[f64; 3]; 2]| [0, 1, 2].map(|j| slopes[0][j].is_nan() && slopes[1][j].is_nan());
    // Beside the first column; beside the motion; beside neither, and where nothing is known.
    let alone = constrained_solve_many(m, a, force, target).0;
    assert_eq!(nans(alone), [false, true, true]);
    assert_eq!(nans(slopes(0.0, [1.0, 1.0, 1e-3])), [false; 3]);
    assert_eq!(nans(slopes(9.81, [0.0, 1.0, 1e-3])), [false; 3]);
    assert_eq!(nans(slopes(0.0, [0.0, 1.0, 1.0])), [false, true, true]);
    assert_eq!(nans(slopes(9.81, [1.0, 0.0, 1.0])), [false, true, false]);
    // What is left of terms of 1e-9 is none of terms of one: q̈ and the first column are as large.
    assert_eq!(nans(slopes(1e-9, [1e-9, 1.0, 1.0])), [false; 3]);
    assert_eq!(nans(slopes(1e-12, [1e-12, 1.0, 1.0])), [false, true, true]);
    // The numbers are those of the same columns without a word about their sizes.
    let (first, expected) = (slopes(9.81, [1.0; 3]).map(|row| row[0]), alone.map(|row| row[0]));
    assert_eq!(first, expected);
    // Where there is no motion there is no derivative of it.
    assert_eq!(nans(slopes(f64::NAN, [1.0; 3])), [true; 3]);
    // A contradiction remains one.
    let wrong = constrained_slopes(m, a, [[0.0], [0.0]], [[1.0], [1.0]], [0, 1], &[9.81; 2], [1.0]);
    assert!(wrong.as_flattened().iter().all(|x| x.is_nan()), "{wrong:?}");
}

/// Two bodies turn about x and y and are held parallel, `z₁ × z₂ = 0`, nearly upright. The third row is `x` and `y`
/// times the others, but for the rounding of rows and target of order one; by itself it would contradict them, or be
/// taken for independent with a pivot of 1e-8.
#[test]
fn a_component_near_zero_is_known_no_better_than_its_vector() {
    let mut random = Random(87175);
    for round in 0..200 {
        let tilt = 2f64.powi(-20 - round % 34);
        let [x, y] = random.numbers().map(|x: f64| tilt * x);
        let upright = [[0.0, 1.0, 0.0, -1.0], [-1.0, 0.0, 1.0, 0.0]];
        let rounding = 1e-17 * random.number();
        let third: [f64; 4] = core::array::from_fn(|i| -x * upright[0][i] - y * upright[1][i] + rounding);
        let targets: [f64; 2] = random.numbers();
        let target = -x * targets[0] - y * targets[1] + 1e-16 * random.number();
        let system = System::<4, 2> { a: upright, c: targets, ..System::random(&mut random, 4) };
        let (expected, _) = system.solve();
        let (a, c) = ([upright[0], upright[1], third], [targets[0], targets[1], target]);
        let (found, _) = constrained_solve_vectors(system.m, a, system.f, c, [0; 3]);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{round}: {found} {expected}");
        }
        // Of dual numbers likewise, and in every order of the rows.
        let dual = |x: f64| Dual { value: x, derivative: x };
        let turned = |k: usize| [(k + 1) % 3, (k + 2) % 3, k];
        let order = turned(round as usize % 3);
        let (q, _) = constrained_solve_vectors(
            system.m.map(|row| row.map(Dual::constant)),
            order.map(|k| a[k].map(Dual::constant)),
            system.f.map(dual),
            order.map(|k| dual(c[k])),
            [5; 3],
        );
        for (q, expected) in q.iter().zip(expected) {
            let bound = 1e-9 * (1.0 + expected.abs());
            assert!((q.value - expected).abs() < bound && (q.derivative - expected).abs() < bound, "{round}: {q:?}");
        }
    }
}

/// Components that move coordinates of their own are rows like others: without inertia, next to a dead centre where
/// zeros are rounding, and beside a coordinate of 1e-20 of their inertia.
#[test]
fn components_of_a_vector_keep_their_own_coordinates() {
    let solve = |m: [[f64; 2]; 2], a, c| constrained_solve_vectors(m, a, [0.0; 2], c, [0, 0]).0;
    let near = |found: [f64; 2], expected: [f64; 2]| {
        let is_near = |(x, y): (&f64, f64)| (x - y).abs() <= 1e-9 * y.abs();
        assert!(found.iter().zip(expected).all(is_near), "{found:?} {expected:?}");
    };
    for zero in [0.0, 1e-16, -6e-17, 1e-13, 1e-9, 1e-6, 1e-3] {
        near(solve([[0.0; 2]; 2], [[1.0, zero], [-zero, 1.1]], [4.4 - zero, -1.1 - 4.4 * zero]), [4.4, -1.0]);
    }
    near(solve([[1e-20, 0.0], [0.0, 1.0]], [[1.0, 0.0], [1e-3, 1.0]], [2.0, 3.0]), [2.0, 2.998]);
    near(solve([[1.0, 0.0], [0.0, 1e24]], [[1.0, 0.0], [0.0, 1e-12]], [2.0, 3e-12]), [2.0, 3.0]);
    let small = 2f64.powi(-40);
    near(solve([[1.0, 0.0], [0.0, 1.0]], [[0.0, 1e7], [small, 1.0]], [1e7, 1.0 + small]), [1.0, 1.0]);
    near(solve([[1.0, 0.0], [0.0, 1.0]], [[1.0, 1.0], [1e-11, -1e-11]], [3.0, -1e-11]), [1.0, 2.0]);
}

/// A parallelogram of light cranks and a heavy coupler next to its dead centre, φ = 1e-9: the first row alone says that
/// the cranks turn alike.
#[test]
fn a_component_next_to_a_dead_centre_counts() {
    for light in [1e-10, 1e-8, 1e-4, 1e-2, 1.0] {
        for angle in [1e-9, 1e-7, 1e-3] {
            let m = [[light, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, light]];
            let a = [[-angle, 0.0, angle], [1.0, 2.0, -1.0]];
            let (q, _) = constrained_solve_vectors(m, a, [0.3, 0.1, 0.0], [0.0, 0.0], [0, 0]);
            let expected = 0.15 / light;
            assert!((q[0] - expected).abs() < 1e-8 * expected && (q[2] - expected).abs() < 1e-8 * expected, "{q:?}");
            assert!(q[1].abs() < 1e-8 * expected, "{light} {angle}: {q:?}");
        }
    }
}

/// So in every unit of the rows, of the coordinates and of what is varied.
#[test]
fn whether_a_column_contradicts_does_not_depend_on_units() {
    let (m, a) = ([[1.0, 0.0], [0.0, 3.0]], [[1.0, -1.0], [-2.0, 2.0]]);
    let force = [[1.0, 1e-17], [7.0, 0.0]];
    for (contradiction, expected) in [(1e-17, false), (1e-9, false), (1e-6, true)] {
        for exponent in [-80, -50, -1, 0, 3, 50, 80] {
            let unit = 2f64.powi(exponent);
            let target = [[0.0, contradiction], [0.0, contradiction]];
            let slopes = |size: [f64; 2], force: [[f64; 2]; 2], target: [[f64; 2]; 2], a: [[f64; 2]; 2]| {
                constrained_slopes(m, a, force, target, [0, 1], &[1.0, 1.0], size)[0][1].is_nan()
            };
            // Of what is varied: its size grows as its column shrinks.
            let column = |rows: [[f64; 2]; 2]| rows.map(|[x, y]| [x, y / unit]);
            assert_eq!(slopes([1.0, unit], column(force), column(target), a), expected, "{contradiction} {exponent}");
            let row = |rows: [[f64; 2]; 2]| [rows[0], rows[1].map(|x| x * unit)];
            assert_eq!(slopes([1.0, 1.0], force, row(target), row(a)), expected, "{contradiction} {exponent}");
        }
    }
}

/// Two rows about x; y is in none of them.
#[test]
fn another_coordinate_excuses_no_contradiction() {
    let (m, a) = ([[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [1.0, 0.0]]);
    for fast in [0.0, 1.0, 1e6, 1e9, 1e12] {
        let solve = |second: f64| try_constrained_solve(m, a, [0.0, fast], [1.0, second]);
        assert!(matches!(solve(1.0 + 1e-6), Err(ConstraintError::Contradiction { .. })), "{fast}: {:?}", solve(1.0));
        assert_eq!(solve(1.0 + 1e-10).map(|(q, _)| q[0].round()), Ok(1.0), "{fast}");
        // Nor is a speed of its own row's size lost: 1e-7 of 10 is no contradiction to rounding of its terms.
        let wide = [[1.0, -1.0], [2.0, -2.0]];
        let agrees = try_constrained_solve(m, wide, [fast, fast], [0.0, fast * 1e-9]);
        assert_eq!(agrees.map(|(q, _)| (q[0] - q[1]).abs() <= 1e-15 * fast), Ok(true), "{fast}");
    }
}

/// A row that is another one but for 1e-11 of z says what that part of it asks for, whatever the order of the pivots.
#[test]
fn what_is_left_of_a_row_is_measured_by_its_own_coordinate() {
    let left = 1e-11;
    for z in [1, 2] {
        let y = 3 - z;
        let mut m = [[0.0; 3]; 3];
        (0..3).for_each(|i| m[i][i] = 1.0);
        // y has less inertia beside x than z: the second independent coordinate comes first, or does not.
        (m[0][y], m[y][0]) = (0.5, 0.5);
        let (mut first, mut force) = ([0.0; 3], [0.0; 3]);
        (first[0], first[y]) = (1.0, 1.0);
        let mut second = first;
        second[z] = left;
        force[z] = 1e3;
        let (q, _) = try_constrained_solve(m, [first, second], force, [0.0, 1e3 * left]).expect("it is satisfied");
        assert_eq!(q[z], 1e3);
        assert!(try_constrained_solve(m, [first, second], force, [0.0, 3e3 * left]).is_err(), "{z}");
        (force[z], force[y]) = (0.0, 1e3);
        assert!(try_constrained_solve(m, [first, second], force, [0.0, 1e-4]).is_err(), "{z}");
    }
}

#[test]
fn sizes_of_states_are_those_of_their_kind() {
    let (q, qd) = ([0.1, -3.0, 2.0, 0.0], [0.5, 0.25, -4.0, -0.125]);
    let sizes: [f64; 10] = state_sizes(&q, &qd, [0, 1, 1, 2]);
    assert_eq!(sizes, [1.0, 3.0, 3.0, 0.0, 0.5, 4.0, 4.0, 0.125, 0.0, 0.0]);
}
