//! Waves' forces against the pressure in them, and the motion in regular waves against the forced oscillator.

use mbs_models::marine_platform::Params;
use mbs_platform::marine::excitation::{Response, amplitude_operator, unit_wave};
use mbs_platform::marine::hull::Hull;
use mbs_platform::marine::sea::Wave;
use mbs_platform::marine::simulation::AtSea;
use mbs_platform::marine::wind::{Superstructure, Wind};
use mbs_runtime::State;
use nalgebra::{Complex, Vector3};
use std::f64::consts::PI;

use super::{calm, hull, regular, uniform};

/// Nodes and weights of Gauss' rule with five points on −1 … 1.
fn gauss() -> [(f64, f64); 5] {
    let root = 2.0 * (10.0_f64 / 7.0).sqrt();
    let [inner, outer] = [(5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0];
    let part = 13.0 * 70.0_f64.sqrt();
    let [near, far] = [(322.0 + part) / 900.0, (322.0 - part) / 900.0];
    [(-outer, far), (-inner, near), (0.0, 128.0 / 225.0), (inner, near), (outer, far)]
}

/// Pressure over `ρ g`, and its gradient, at a place over which the mean surface is at 0, for `τ = phase` at the
/// origin.
fn pressure(wave: &Wave, place: Vector3<f64>, phase: f64) -> (f64, Vector3<f64>) {
    let k = wave.frequency.powi(2) / 9.80665;
    let (s, c) = wave.direction.sin_cos();
    let (sin, cos) = (phase - k * (place.x * c + place.y * s)).sin_cos();
    let decay = wave.amplitude * (k * place.z).exp();
    (decay * cos, Vector3::new(k * c * decay * sin, k * s * decay * sin, k * decay * cos))
}

/// Force and moments about the mass centre of the pressure in the undisturbed wave: over the volume of the pontoons,
/// and of the columns sideways, upwards over their feet.
fn froude_krylov(hull: &Hull, wave: &Wave, phase: f64) -> [f64; 4] {
    let p = hull.params;
    let weight = p.density * p.g;
    // From the mean surface to the mass centre.
    let centre = Vector3::new(0.0, 0.0, p.mass_centre - hull.draught);
    let mut total = [0.0; 4];
    let mut add = |place: Vector3<f64>, force: Vector3<f64>| {
        let moment = (place - centre).cross(&force);
        let added = [force.z, moment.x, moment.y, moment.z];
        (0..4).for_each(|i| total[i] += added[i]);
    };
    let nodes = gauss();
    for side in [1.0, -1.0] {
        // Pieces of the length, each by Gauss' rule.
        for piece in 0..6 {
            let start = p.pontoon[0] * (f64::from(piece) / 6.0 - 0.5);
            for (a, wa) in nodes {
                for (b, wb) in nodes {
                    for (c, wc) in nodes {
                        let place = Vector3::new(
                            start + p.pontoon[0] / 12.0 * (1.0 + a),
                            side * p.column_place[1] + 0.5 * p.pontoon[1] * b,
                            -hull.draught - 0.5 * p.pontoon[2] * (1.0 + c),
                        );
                        let volume = wa * wb * wc / 8.0 * p.pontoon.iter().product::<f64>() / 6.0;
                        add(place, -weight * volume * pressure(wave, place, phase).1);
                    }
                }
            }
        }
        for end in [1.0, -1.0] {
            for (b, wb) in nodes {
                let radius = p.column_radius * (0.5 * (1.0 + b)).sqrt();
                for k in 0..12 {
                    let (sin, cos) = (PI / 6.0 * f64::from(k)).sin_cos();
                    let area = wb / 2.0 * PI * p.column_radius.powi(2) / 12.0;
                    let at = |depth: f64| {
                        let [x, y] = [end * p.column_place[0] + radius * cos, side * p.column_place[1] + radius * sin];
                        Vector3::new(x, y, -depth)
                    };
                    let foot = at(hull.draught);
                    add(foot, Vector3::new(0.0, 0.0, weight * area * pressure(wave, foot, phase).0));
                    for (c, wc) in nodes {
                        let place = at(0.5 * hull.draught * (1.0 + c));
                        let mut force = -weight * area * wc / 2.0 * hull.draught * pressure(wave, place, phase).1;
                        force.z = 0.0;
                        add(place, force);
                    }
                }
            }
        }
    }
    total
}

/// To the square of what the bodies' own breadth is of the wave: columns and pontoons count as lines.
#[test]
fn forces_are_those_of_the_pressure_in_the_wave() {
    let params = Params { added_mass: 0.0, heave_damping: 0.0, turn_damping: [0.0; 3], ..Params::default() };
    let hull = Hull::new(&params).expect("it floats");
    for frequency in [0.2, 0.4, 0.6, 1.0] {
        for direction in [0.0, 0.5, 1.2, 2.5, -2.0] {
            let wave = Wave { amplitude: 0.7, frequency, direction, phase: 0.0 };
            let response = Response::to(&hull, &wave);
            for phase in [0.0_f64, 0.8, 2.1] {
                let expected = froude_krylov(&hull, &wave, phase);
                let k = wave.number();
                let breadth = (k * params.pontoon[1]).powi(2);
                // Forces of single parts, which cancel in the sum.
                let part = params.density * params.g * 0.7 * hull.waterplane;
                let scales = [part, part * k * 64.0, part * k * 100.0, part * k * k * 1e3];
                for i in 0..4 {
                    let found = response.cosine[i] * phase.cos() + response.sine[i] * phase.sin();
                    let error = (found - expected[i]).abs() / scales[i];
                    assert!(error < breadth + 1e-9, "{frequency} {direction} {i}: {found} {} {error:e}", expected[i]);
                }
            }
        }
    }
}

/// Very long waves turn the platform as a slope does: `ρ g ∇ GM` times it; in yaw by the plan's second moments.
#[test]
fn very_long_waves_are_slopes() {
    let hull = hull();
    let wave = unit_wave(0.01, 0.6);
    let (s, c) = 0.6_f64.sin_cos();
    let (k, response, stiffness) = (wave.number(), Response::to(&hull, &wave), hull.stiffness());
    assert!((response.cosine[0] / stiffness[0] - 1.0).abs() < 1e-3);
    assert!((response.sine[1] / (stiffness[1] * k * s) - 1.0).abs() < 5e-3);
    // ∂ζ/∂x = k c at τ = 90°, and a surface that rises ahead lifts the bow.
    assert!((response.sine[2] / (-stiffness[2] * k * c) - 1.0).abs() < 5e-3);
    // Damping acts on the motion against the water's: none where it goes with the surface.
    let p = hull.params;
    let (w, damping) = (wave.frequency, p.turn_damping);
    assert!((response.sine[0] / (-p.heave_damping * w) - 1.0).abs() < 5e-3);
    assert!((response.cosine[1] / (damping[0] * w * k * s) - 1.0).abs() < 5e-3);
    assert!((response.cosine[2] / (-damping[1] * w * k * c) - 1.0).abs() < 5e-3);
    let columns = hull.waterplane * hull.draught * (p.column_place[0].powi(2) - p.column_place[1].powi(2));
    let pontoons = hull.submerged * ((p.pontoon[0].powi(2) - p.pontoon[1].powi(2)) / 12.0 - p.column_place[1].powi(2));
    let yaw = p.density * p.g * (columns + pontoons) * k * k * s * c;
    assert!((response.cosine[3] / yaw - 1.0).abs() < 1e-2, "{} {yaw}", response.cosine[3]);
}

/// `|z/ζ|`, typed from the long-wave forces on a semi-submersible.
fn heave_by_hand(hull: &Hull, w: f64, direction: f64) -> f64 {
    let p = hull.params;
    let k = w * w / 9.80665;
    let (s, c) = direction.sin_cos();
    let q = 0.5 * k * p.pontoon[0] * c;
    let mean = if q.abs() < 1e-12 { 1.0 } else { q.sin() / q };
    let across = (k * p.column_place[1] * s).cos();
    let at_pontoons = (-k * (hull.draught + 0.5 * p.pontoon[2])).exp() * mean * across;
    let at_feet = (-k * hull.draught).exp() * (k * p.column_place[0] * c).cos() * across;
    let stiffness = p.density * p.g * 4.0 * PI * p.column_radius.powi(2);
    let volume = 2.0 * p.pontoon.iter().product::<f64>();
    let force = Complex::new(
        stiffness * at_feet - w * w * (p.density * volume + p.added_mass) * at_pontoons,
        w * p.heave_damping * at_pontoons,
    );
    (force / Complex::new(stiffness - w * w * (p.m + p.added_mass), w * p.heave_damping)).norm()
}

/// The simulated platform in small regular waves, beyond the start.
#[test]
fn regular_waves_move_it_as_a_forced_oscillator() {
    let p = Params::default();
    let params = Params {
        heave_damping: 6.0 * p.heave_damping,
        turn_damping: p.turn_damping.map(|b| 6.0 * b),
        heave_drag: 0.0,
        turn_drag: [0.0; 3],
        ..p
    };
    let hull = Hull::new(&params).expect("it floats");
    for frequency in [0.3, 0.45, 0.543, 0.7, 1.1] {
        for direction in [0.0, 0.9] {
            let wave = Wave { amplitude: 1e-3, ..unit_wave(frequency, direction) };
            let at_sea = AtSea::new(&params, regular(&hull, wave), calm()).expect("a platform");
            // The transients die within 500 s; five periods are looked at.
            let period = 2.0 * PI / frequency;
            let (step, last) = (period / 200.0, 5 * 200);
            let steps = (600.0 / step) as usize + last;
            let mut sums = [Complex::new(0.0, 0.0); 3];
            let mut k = 0;
            at_sea
                .simulate(State::new([0.0; 4], [0.0; 4]), step, step * steps as f64, |moment| {
                    if k + last >= steps && k < steps {
                        let turn = Complex::from_polar(2.0 / last as f64, -frequency * moment.time);
                        (0..3).for_each(|i| sums[i] += turn * moment.q[i]);
                    }
                    k += 1;
                })
                .expect("a motion");
            let found = sums.map(|sum| sum.norm() / wave.amplitude);
            let expected = amplitude_operator(&hull, &wave);
            let by_hand = heave_by_hand(&hull, frequency, direction);
            assert!((expected[0] / by_hand - 1.0).abs() < 1e-12, "{frequency}: {} {by_hand}", expected[0]);
            assert!((found[0] - by_hand).abs() < 1e-3 * by_hand + 1e-4, "{frequency}: {} {by_hand}", found[0]);
            for i in [1, 2] {
                assert!(
                    (found[i] - expected[i]).abs() < 2e-3 * expected[i] + 2e-5,
                    "{frequency} {direction} {i}: {} {}",
                    found[i],
                    expected[i]
                );
            }
        }
    }
}

/// A steady wind: its pressure at its lever, and the heel that balances it.
#[test]
fn a_steady_wind_heels_the_platform() {
    let mut wind = Wind::<3>::new(10.0, 0.5 * PI, uniform(1)).expect("a wind");
    wind.amplitude = 0.0;
    let superstructure = Superstructure::default();
    let force = 0.5 * 1.225 * 1.1 * 90.0 * 100.0;
    let moments = wind.at(&superstructure, 3.0);
    let expected = [0.0, -8.0 * force, 0.0, 1.5 * force];
    (0..4).for_each(|i| assert!((moments[i] - expected[i]).abs() < 1e-9 * force, "{moments:?}"));
    // From the left to the right the other way round, and half as strong in the quarter, by its components.
    wind.direction = -0.5 * PI;
    assert!((wind.at(&superstructure, 0.0)[1] - 8.0 * force).abs() < 1e-9 * force);
    wind.direction = 0.0;
    assert!((wind.at(&superstructure, 0.0)[2] - 8.0 * force * 60.0 / 90.0).abs() < 1e-9 * force);

    wind.direction = 0.5 * PI;
    let hull = hull();
    let still = Wave { amplitude: 0.0, ..unit_wave(1.0, 0.0) };
    let at_sea = AtSea::new(&hull.params, regular(&hull, still), wind).expect("a platform");
    let mut end = [0.0; 4];
    let start = State::new([0.0, moments[1] / hull.stiffness()[1], 0.0, moments[3] / hull.stiffness()[3]], [0.0; 4]);
    at_sea.simulate(start, 0.1, 1000.0, |moment| end = moment.q).expect("a motion");
    assert!((end[1] / start.q[1] - 1.0).abs() < 1e-2 && (end[3] / start.q[3] - 1.0).abs() < 1e-2, "{end:?}");
}
