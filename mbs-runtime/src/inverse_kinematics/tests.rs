use super::*;
use core::f64::consts::PI;
use nalgebra::Vector3;

/// Two links of one metre in the x, y plane, and a hand that turns.
fn planar(q: &[f64; 3]) -> (Pose<f64>, [[f64; 3]; 6]) {
    let [(s1, c1), (s12, c12), (s, c)] = [q[0], q[0] + q[1], q[0] + q[1] + q[2]].map(Scalar::sin_cos);
    let pose = Pose { position: [c1 + c12, s1 + s12, 0.0], rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] };
    let mut jacobian = [[0.0; 3]; 6];
    jacobian[0] = [-s1 - s12, -s12, 0.0];
    jacobian[1] = [c1 + c12, c12, 0.0];
    jacobian[5] = [1.0; 3];
    (pose, jacobian)
}

/// An arm with a fourth link of half a metre between: one coordinate more than needed.
fn redundant(q: &[f64; 4]) -> (Pose<f64>, [[f64; 4]; 6]) {
    let mut angle = 0.0;
    let mut position = [0.0; 3];
    let mut jacobian = [[0.0; 4]; 6];
    for (i, length) in [1.0, 0.5, 1.0, 0.0].into_iter().enumerate() {
        angle += q[i];
        let (s, c) = Scalar::sin_cos(angle);
        position[0] += length * c;
        position[1] += length * s;
        for k in 0..=i {
            jacobian[0][k] -= length * s;
            jacobian[1][k] += length * c;
        }
        jacobian[5][i] = 1.0;
    }
    let (s, c) = Scalar::sin_cos(angle);
    (Pose { position, rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] }, jacobian)
}

fn difference(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    let entries = |pose: &Pose<f64>| [pose.position, pose.rotation[0], pose.rotation[1], pose.rotation[2]];
    let (a, b) = (entries(a), entries(b));
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_regular_pose_is_found_in_a_few_steps() {
    let (target, _) = planar(&[0.4, -1.1, 2.0]);
    let solver = DampedLeastSquares { position_tolerance: 1e-13, rotation_tolerance: 1e-13, ..Default::default() };
    let found = solver.solve(planar, &target, &[0.0, -0.5, 1.5]).expect("reached");
    assert!(difference(&planar(&found.q).0, &target) < 1e-13);
    assert!(found.evaluations <= 10, "{}", found.evaluations);
}

#[test]
fn a_redundant_mechanism_has_a_solution_near_the_guess() {
    let guess = [0.3, 0.4, -0.2, 0.1];
    let (target, _) = redundant(&[0.35, 0.3, -0.1, 0.2]);
    let found = DampedLeastSquares::default().solve(redundant, &target, &guess).expect("reached");
    assert!(difference(&redundant(&found.q).0, &target) < 1e-10);
    assert!(found.q.iter().zip(guess).all(|(q, guess)| (q - guess).abs() < 0.3));
}

#[test]
fn a_singular_guess_is_left() {
    // Stretched, a pull inwards moves nothing to first order; sideways it does.
    let (target, _) = planar(&[0.2, 1.0, -0.3]);
    let found = DampedLeastSquares::default().solve(planar, &target, &[0.0, 0.0, 0.0]).expect("reached");
    assert!(difference(&planar(&found.q).0, &target) < 1e-9);
}

/// Stretched towards the target, or away from it, or folded, no step leads nearer to first order.
#[test]
fn a_guess_that_no_step_leads_from_is_left() {
    let identity = planar(&[0.0; 3]).0;
    for (x, guess) in [(1.5, [0.0; 3]), (-1.5, [0.0; 3]), (1.5, [0.0, PI, -PI]), (1e-3, [0.0; 3])] {
        let target = Pose { position: [x, 0.0, 0.0], ..identity };
        let found = DampedLeastSquares::default().solve(planar, &target, &guess).expect("reached");
        assert!(difference(&planar(&found.q).0, &target) < 1e-9, "{found:?}");
        // Also where the elbow is at its limit.
        let limits = DampedLeastSquares { upper: [9.0, guess[1], 9.0], ..Default::default() };
        let found = limits.solve(planar, &target, &guess).expect("reached");
        assert!(found.q[1] < guess[1] - 0.1, "{found:?}");
    }
    // What is out of reach stays so, and the guess may be the best place.
    let target = Pose { position: [2.5, 0.0, 0.0], ..identity };
    let best = match DampedLeastSquares::default().solve(planar, &target, &[0.0; 3]) {
        Err(NotReached::Stationary(best)) => best,
        other => panic!("{other:?}"),
    };
    assert!(best.q == [0.0; 3] && best.position_error == 0.5 && best.evaluations > 1, "{best:?}");
    let once = DampedLeastSquares { evaluations: 1, ..Default::default() }.solve(planar, &target, &[0.0; 3]);
    assert!(matches!(once, Err(NotReached::Stationary(Approach { evaluations: 1, .. }))), "{once:?}");
}

#[test]
fn out_of_reach_the_best_is_told() {
    let target = Pose { position: [2.5, 0.0, 0.0], ..planar(&[0.0; 3]).0 };
    let best = match DampedLeastSquares::default().solve(planar, &target, &[0.3, 0.4, -0.5]) {
        Err(NotReached::Stationary(best) | NotReached::TooManyEvaluations(best)) => best,
        other => panic!("{other:?}"),
    };
    // The damping shrinks with every good step: 19 evaluations to nine digits.
    assert!((best.position_error - 0.5).abs() < 1e-9 && best.evaluations <= 25, "{best:?}");
}

/// The planar arm in another unit of length, of which `scale` make a metre.
fn scaled(scale: f64) -> impl Fn(&[f64; 3]) -> (Pose<f64>, [[f64; 3]; 6]) {
    move |q| {
        let (mut pose, mut jacobian) = planar(q);
        pose.position.iter_mut().chain(jacobian[..3].iter_mut().flatten()).for_each(|x| *x *= scale);
        (pose, jacobian)
    }
}

/// The search is the same in millimetres and in miles, and the length of a radian counts.
#[test]
fn the_unit_of_length_does_not_matter() {
    let wanted = [0.4, -1.1, 2.0];
    for length in [0.03, 0.5, 1.0, 40.0] {
        let mut evaluations = None;
        for scale in [1.0, 1024.0, 2.0_f64.powi(-20), 2.0_f64.powi(400), 2.0_f64.powi(-400)] {
            let model = scaled(scale);
            let (target, _) = model(&wanted);
            let solver = DampedLeastSquares {
                length: length * scale,
                position_tolerance: 1e-12 * scale,
                rotation_tolerance: 1e-12,
                ..Default::default()
            };
            let found = solver.solve(&model, &target, &[0.0, -0.5, 1.5]).expect("reached");
            assert!(found.evaluations <= 12 && found.q.iter().zip(wanted).all(|(q, w)| (q - w).abs() < 1e-11));
            // To the last evaluation, which rounding may make needless.
            let first = *evaluations.get_or_insert(found.evaluations);
            assert!(first.abs_diff(found.evaluations) <= 1, "{length} {scale}: {found:?}");
        }
    }
}

/// The finding: a miss of 0.65 m was returned as reached, because its square, weighed with such a length, is zero.
#[test]
fn a_length_out_of_proportion_is_refused() {
    let (target, _) = planar(&[0.2, 1.0, -0.3]);
    let guess = [0.0, 0.5, 0.4];
    for length in [1e300, f64::MAX, 1e160, 1e100, 1e20, 1e-20, 1e-100, 1e-160, 1e-300, f64::MIN_POSITIVE] {
        let solver = DampedLeastSquares { length, ..Default::default() };
        let (best, reach) = match solver.solve(planar, &target, &guess) {
            Err(NotReached::LengthOutOfProportion { best, length: told, reach }) if told == length => (best, reach),
            other => panic!("{length:e}: {other:?}"),
        };
        let (pose, _) = planar(&best.q);
        let miss = (Vector3::from(pose.position) - Vector3::from(target.position)).norm();
        assert!((best.position_error - miss).abs() < 1e-15, "{length:e}: {best:?}, not {miss}");
        assert!(best.position_error > 1e-10 || best.rotation_error > 1e-10, "{best:?}");
        assert!((0.5..=2.0).contains(&reach[0]) && reach[1] == 1.0, "{reach:?}");
    }
}

#[test]
fn lower_limits_hold_and_let_go() {
    // The mirror image of a limit above: the second joint must not go below −0.5, where the target is.
    let (target, _) = planar(&[-0.2, -1.0, 0.3]);
    let narrow = DampedLeastSquares { upper: [PI, -0.2, PI], lower: [-PI, -0.5, -PI], ..Default::default() };
    match narrow.solve(planar, &target, &[-0.2, -0.3, 0.3]) {
        Err(NotReached::AtLimits { best, held }) => {
            assert_eq!(held, [false, true, false]);
            assert_eq!(best.q[1], -0.5);
        }
        other => panic!("{other:?}"),
    }
    // At a limit that the error pulls away from nothing is held, at either end.
    for (lower, upper, sign) in [(0.0, 2.0, 1.0), (-2.0, 0.0, -1.0)] {
        let (target, _) = planar(&[0.2 * sign, sign, -0.3 * sign]);
        let limits = DampedLeastSquares { lower: [-PI, lower, -PI], upper: [PI, upper, PI], ..Default::default() };
        let found = limits.solve(planar, &target, &[0.5 * sign, 0.0, 0.0]).expect("reached");
        assert!((found.q[1] - sign).abs() < 1e-8, "{found:?}");
    }
}

#[test]
fn limits_hold() {
    // Elbow up is forbidden: the other configuration is found from the other side of it, or nothing.
    let (target, _) = planar(&[0.2, 1.0, -0.3]);
    let within = DampedLeastSquares { upper: [PI, 0.0, PI], lower: [-PI; 3], ..Default::default() };
    let found = within.solve(planar, &target, &[0.9, -0.4, 0.0]).expect("reached with the elbow down");
    assert!((found.q[1] + 1.0).abs() < 1e-8, "{found:?}");
    // No configuration has the second joint within these.
    let narrow = DampedLeastSquares { upper: [PI, 0.5, PI], lower: [-PI, 0.2, -PI], ..Default::default() };
    match narrow.solve(planar, &target, &[0.2, 0.3, -0.3]) {
        Err(NotReached::AtLimits { best, held }) => {
            assert_eq!(held, [false, true, false]);
            assert_eq!(best.q[1], 0.5);
            assert!(best.position_error > 0.05);
        }
        other => panic!("{other:?}"),
    }
    // A guess beyond the limits starts at them.
    let found = within.solve(planar, &target, &[0.9, 3.0, 0.0]);
    assert!(found.is_ok_and(|found| found.q[1] <= 0.0));
}

#[test]
fn bad_input_is_refused() {
    let (target, _) = planar(&[0.4, -1.1, 2.0]);
    let solver = DampedLeastSquares::default();
    let guess = [0.0, 1.0, 0.0];
    let nowhere = Pose { position: [0.0, f64::NAN, 0.0], ..target };
    assert_eq!(solver.solve(planar, &nowhere, &guess), Err(NotReached::NonFiniteTarget { component: 1 }));
    let mirror = Pose { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]], ..target };
    let reflection = NotReached::Rotation(NotARotation::Reflection { determinant: -1.0 });
    assert_eq!(solver.solve(planar, &mirror, &guess), Err(reflection));
    let found = solver.solve(planar, &target, &[0.0, f64::NAN, 0.0]);
    assert!(matches!(found, Err(NotReached::InvalidLimits { coordinate: 1, .. })), "{found:?}");
    let crossed = DampedLeastSquares { lower: [1.0; 3], upper: [1.0, 1.0, 0.0], ..Default::default() };
    let found = crossed.solve(planar, &target, &guess);
    assert_eq!(found, Err(NotReached::InvalidLimits { coordinate: 2, lower: 1.0, guess: 0.0, upper: 0.0 }));
    let exact = DampedLeastSquares { rotation_tolerance: 0.0, ..Default::default() };
    let found = exact.solve(planar, &target, &guess);
    assert_eq!(found, Err(NotReached::InvalidTolerance { position: 1e-10, rotation: 0.0, length: 1.0 }));
    let nan = |_: &[f64; 3]| (target, [[f64::NAN; 3]; 6]);
    assert_eq!(solver.solve(nan, &target, &guess), Err(NotReached::NonFinite { q: guess }));
    for entry in 0..12 {
        let broken = |q: &[f64; 3]| {
            let (mut pose, jacobian) = planar(q);
            let mut entries = pose.position.iter_mut().chain(pose.rotation.iter_mut().flatten());
            *entries.nth(entry).expect("twelve entries") = f64::NAN;
            (pose, jacobian)
        };
        // At the solution nothing but the NaN is off.
        let found = solver.solve(broken, &target, &[0.4, -1.1, 2.0]);
        assert_eq!(found, Err(NotReached::NonFinite { q: [0.4, -1.1, 2.0] }), "entry {entry}");
    }
    let short = DampedLeastSquares { evaluations: 2, ..Default::default() };
    let found = short.solve(planar, &target, &guess);
    assert!(matches!(found, Err(NotReached::TooManyEvaluations(best)) if best.evaluations == 2), "{found:?}");
}

/// A rejected step damps the next ones more; each good one takes some of that back. Where it did not, the same poses
/// would take 13.7 evaluations instead of 12.2.
#[test]
fn good_steps_are_damped_less_and_less() {
    let mut evaluations = 0;
    for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (f64::from(i), f64::from(j)))) {
        let (target, _) = planar(&[0.4 + 0.15 * i, -3.0 + 0.15 * j, 0.7]);
        let found = DampedLeastSquares::default().solve(planar, &target, &[0.1, 0.05, -0.4]).expect("reached");
        evaluations += found.evaluations;
    }
    assert!(evaluations <= 1600 * 25 / 2, "{evaluations}");
}
