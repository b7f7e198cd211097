//! The generated equations of motion.

use mbs_models::marine_platform::{MarinePlatform, Params};
use mbs_runtime::{Dop853, Integrator, State};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

use super::hull;

/// Heave up to 1 m and tilt up to 0.2 rad, any yaw: still water cuts all columns.
fn position(random: &mut Random) -> [f64; 4] {
    [random.uniform(-1.0..1.0), random.uniform(-0.2..0.2), random.uniform(-0.2..0.2), random.uniform(-3.0..3.0)]
}

/// Force and moment about the mass centre of the water at rest on columns and pontoons, in the platform's axes: weights
/// of what is displaced at their centres, summed up over small pieces of the columns.
fn archimedes(p: &Params, z: f64, up: Vector3<f64>) -> [Vector3<f64>; 2] {
    let volume = 2.0 * p.pontoon[0] * p.pontoon[1] * p.pontoon[2];
    let draught = (p.m / p.density - volume) / (4.0 * PI * p.column_radius.powi(2));
    // Of the mass centre over the water.
    let height = z + p.mass_centre - draught;
    let weight = p.density * p.g;
    let pontoons = Vector3::new(0.0, 0.0, -p.mass_centre - 0.5 * p.pontoon[2]);
    let mut force = weight * volume * up;
    let mut moment = pontoons.cross(&force);
    // Gauss' three points over the square of the radius, eight angles: exact for what is of the fifth degree.
    let gauss = [(-0.6_f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6_f64.sqrt(), 5.0 / 9.0)];
    for [sx, sy] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        for (node, part) in gauss {
            let radius = p.column_radius * (0.5 * (1.0 + node)).sqrt();
            for k in 0..8 {
                let (sin, cos) = (PI / 4.0 * f64::from(k) + 0.1).sin_cos();
                let [x, y] = [sx * p.column_place[0] + radius * cos, sy * p.column_place[1] + radius * sin];
                let area = part / 2.0 * PI * p.column_radius.powi(2) / 8.0;
                // Where the surface cuts this line along the column.
                let top = -(height + up.x * x + up.y * y) / up.z;
                let piece = weight * area * (top + p.mass_centre) * up;
                force += piece;
                moment += Vector3::new(x, y, 0.5 * (top - p.mass_centre)).cross(&piece);
            }
        }
    }
    [force, moment]
}

/// Linear and quadratic.
fn damping(linear: f64, quadratic: f64, rate: f64) -> f64 {
    -linear * rate - quadratic * rate.abs() * rate
}

#[test]
fn the_platform_moves_by_newton_and_euler() {
    let model = MarinePlatform::<f64>::default();
    let p = *model.params();
    let mut random = Random::new(6);
    for _ in 0..300 {
        let q = position(&mut random);
        let [qd, qdd] = [0.5, 1.0].map(|most| random.array::<4>(-most..most));
        let u = random.array::<10>(-1e6..1e6);
        let found = model.inverse_dynamics(&q, &qd, &qdd);
        let inputs = model.generalized_force(&q, &qd, &u);

        let [[sf, cf], [st, ct], [sp, cp]] = [q[1], q[2], q[3]].map(|angle| [angle.sin(), angle.cos()]);
        let turn = Matrix3::new(cp, -sp, 0.0, sp, cp, 0.0, 0.0, 0.0, 1.0)
            * Matrix3::new(ct, 0.0, st, 0.0, 1.0, 0.0, -st, 0.0, ct)
            * Matrix3::new(1.0, 0.0, 0.0, 0.0, cf, -sf, 0.0, sf, cf);
        let up: Vector3<f64> = turn.row(2).transpose();
        // Angular velocity in the platform's axes, and its rate.
        let rates = Matrix3::new(1.0, 0.0, -st, 0.0, cf, sf * ct, 0.0, -sf, cf * ct);
        let [_, f, t, s] = qd;
        let rates_dot = Matrix3::new(
            0.0,
            0.0,
            -ct * t,
            0.0,
            -sf * f,
            cf * ct * f - sf * st * t,
            0.0,
            -cf * f,
            -sf * ct * f - cf * st * t,
        );
        let angles = Vector3::new(f, t, s);
        let w = rates * angles;
        let w_dot = rates * Vector3::new(qdd[1], qdd[2], qdd[3]) + rates_dot * angles;
        let inertia = Matrix3::from_diagonal(&(Vector3::from(p.inertias) + Vector3::from(p.added_inertias)));

        let [buoyancy, righting] = archimedes(&p, q[0], up);
        let drag = Vector3::from_fn(|i, _| damping(p.turn_damping[i], p.turn_drag[i], w[i]));
        let vertical = up.dot(&buoyancy) - p.m * p.g + damping(p.heave_damping, p.heave_drag, qd[0]);
        let turning = rates.transpose() * (inertia * w_dot + w.cross(&(inertia * w)) - righting - drag);
        let mooring = p.mooring * q[3];
        let heave = (p.m + p.added_mass) * qdd[0] - vertical;
        let expected = [heave, turning.x, turning.y, turning.z + mooring];
        assert_close("M q̈ + h + ∂D/∂q̇", &found, &expected, 1e-11);

        let mut force = Vector3::zeros();
        let mut moment = Vector3::new(u[7], u[8], u[9]);
        for (i, [ahead, left]) in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].into_iter().enumerate() {
            let place = Vector3::new(ahead * p.lift_place[0], left * p.lift_place[1], -p.lift_place[2]);
            let thrust = Vector3::new(0.0, 0.0, u[i]);
            (force, moment) = (force + thrust, moment + place.cross(&thrust));
        }
        for (i, ahead) in [1.0, -1.0].into_iter().enumerate() {
            let place = Vector3::new(ahead * p.lateral_place[0], 0.0, -p.lateral_place[1]);
            let thrust = Vector3::new(0.0, u[4 + i], 0.0);
            (force, moment) = (force + thrust, moment + place.cross(&thrust));
        }
        let turning = rates.transpose() * moment;
        let expected = [up.dot(&force) + u[6], turning.x, turning.y, turning.z];
        assert_close("Q", &inputs, &expected, 1e-12);
    }
}

/// `GZ = (GM + ½ BM tan² φ) sin φ` at constant displacement, and the small-angle stiffnesses of the textbook.
#[test]
fn hydrostatics_are_those_of_the_textbook() {
    let model = MarinePlatform::<f64>::default();
    let (p, hull) = (*model.params(), hull());
    let [transverse, longitudinal] = hull.metacentric_heights;
    let weight = p.density * p.g * hull.displacement;
    assert!((weight / (p.m * p.g) - 1.0).abs() < 1e-14);
    let own = p.column_radius.powi(2) / 4.0;
    let moment = |place: f64| hull.waterplane * (place * place + own) / hull.displacement;
    let heights = [(1, transverse, moment(p.column_place[1])), (2, longitudinal, moment(p.column_place[0]))];
    for (i, gm, bm) in heights {
        for angle in [1e-3_f64, 0.05, 0.15, 0.25] {
            let mut q = [0.0; 4];
            q[i] = angle;
            // The upward force is linear in z: where it vanishes the displacement is as at rest.
            let at = |z: f64| model.gravity(&[z, q[1], q[2], 0.0]);
            let z = at(0.0)[0] / (at(0.0)[0] - at(1.0)[0]);
            let arm = (gm + 0.5 * bm * angle.tan().powi(2)) * angle.sin();
            assert_close("GZ", &[at(z)[i] / weight], &[arm], 1e-12);
        }
    }
    // By slopes of the generated equations at rest.
    let slopes = model.linearize(&[0.0; 4], &[0.0; 4], &[0.0; 10]);
    let (stiffness, inertia) = (hull.stiffness(), hull.inertia());
    for i in 0..4 {
        for j in 0..4 {
            let expected = if i == j { -stiffness[i] / inertia[i] } else { 0.0 };
            assert!((slopes.q[i][j] - expected).abs() < 1e-12, "{i} {j}: {} {expected}", slopes.q[i][j]);
        }
    }
    let by_hand = [p.density * p.g * 4.0 * PI * 1.5 * 1.5, weight * transverse, weight * longitudinal, p.mooring];
    assert_close("c", &stiffness, &by_hand, 1e-14);
}

fn without_damping() -> MarinePlatform<f64> {
    let none = [0.0; 3];
    MarinePlatform::new(Params {
        heave_damping: 0.0,
        heave_drag: 0.0,
        turn_damping: none,
        turn_drag: none,
        ..Params::default()
    })
}

/// Half a period passes from one zero to the next; the numbers are those of the formulas, worked out by hand.
#[test]
fn small_swings_have_the_natural_periods() {
    let (model, periods) = (without_damping(), hull().natural_periods());
    let expected = [11.6, 19.3, 13.1, 60.1];
    for i in 0..4 {
        let mut state = State::new([0.0; 4], [0.0; 4]);
        state.q[i] = 1e-4;
        let right = |_: f64, q: &[f64; 4], qd: &[f64; 4], qdd: &mut [f64; 4]| {
            *qdd = model.forward_dynamics(q, qd, &[0.0; 10]);
        };
        let step = periods[i] / 1000.0;
        let times: Vec<f64> = (0..4000).map(|k| step * f64::from(k)).collect();
        let mut record = Vec::new();
        Dop853::new(1e-11, 1e-16)
            .sample(right, 0.0, &times, &mut state, |_, state| record.push(state.q[i]))
            .expect("a motion");
        // Between two samples the way through zero is straight.
        let through = |k: usize| (record[k] > 0.0) != (record[k + 1] > 0.0);
        let zero = |k: usize| step * (k as f64 + record[k] / (record[k] - record[k + 1]));
        let zeros: Vec<f64> = (0..record.len() - 1).filter(|&k| through(k)).map(zero).collect();
        let count = zeros.len();
        assert!(count >= 7, "{count}");
        let found = 2.0 * (zeros[count - 1] - zeros[0]) / (count - 1) as f64;
        assert!((found / periods[i] - 1.0).abs() < 1e-5, "{i}: {found} s, by the formula {} s", periods[i]);
        assert!((found - expected[i]).abs() < 0.1, "{i}: {found} s");
    }
}

/// Ten minutes of large motions without damping, and what damping takes.
#[test]
fn energy_is_kept_or_goes_into_damping() {
    for (model, is_damped) in [(without_damping(), false), (MarinePlatform::default(), true)] {
        let mut state = State::new([0.8, 0.12, -0.08, 0.3], [0.2, -0.03, 0.04, 0.02]);
        let energy =
            |state: &State<[f64; 4]>| model.kinetic_energy(&state.q, &state.qd) + model.potential_energy(&state.q);
        let rest = model.potential_energy(&[0.0; 4]);
        let start = energy(&state) - rest;
        // The work of damping, by Simpson's rule over small steps.
        let (mut lost, step) = (0.0, 0.05);
        let power = |state: &State<[f64; 4]>| -> f64 {
            let force = model.dissipation_force(&state.q, &state.qd);
            force.iter().zip(&state.qd).map(|(f, v)| f * v).sum()
        };
        let right = |_: f64, q: &[f64; 4], qd: &[f64; 4], qdd: &mut [f64; 4]| {
            *qdd = model.forward_dynamics(q, qd, &[0.0; 10]);
        };
        for k in 0..12_000 {
            let t = step * f64::from(k);
            let first = power(&state);
            let half = |t: f64, state: &mut State<[f64; 4]>| {
                Dop853::new(1e-12, 1e-12).sample(right, t, &[t + 0.5 * step], state, |_, _| ()).expect("a motion");
            };
            half(t, &mut state);
            let middle = power(&state);
            half(t + 0.5 * step, &mut state);
            lost += step / 6.0 * (first + 4.0 * middle + power(&state));
        }
        let end = energy(&state) - rest;
        assert!((end + lost - start).abs() < 1e-7 * start, "{start} J, {end} J and {lost} J lost");
        assert_eq!(lost > 0.5 * start, is_damped);
    }
}
