//! Exact sensitivities of the eight cases against central differences of platforms and motions with changed
//! parameters, the generated `linearize_parameters`, and textbook formulas by hand.

use mbs_models::stewart_platform::{PARAMETERS, Params};
use mbs_models::{Error, Failure};
use mbs_platform::sensitivity::{Output, Parameter};
use mbs_platform::{HOME, Motion, NOT_FINITE, Platform};
use mbs_runtime::to_matrix;
use mbs_tests::compare::assert_close;
use nalgebra::SMatrix;

use super::platform;

/// All outputs at a moment.
fn outputs(params: Params, motion: &Motion, t: f64) -> Vec<f64> {
    let [q, qd, qdd] = motion.at(t);
    let legs = Platform::new(params).unwrap().leg_state(&q, &qd, &qdd).unwrap();
    Output::all().map(|output| output.of(&legs)).collect()
}

#[test]
fn every_output_by_every_parameter_is_a_central_difference() {
    let params = *platform(300.0, true).params();
    let mut nonzero = 0;
    for (name, motion) in &Motion::CASES {
        for t in [0.0, 0.7, 2.3] {
            for parameter in Parameter::all() {
                let legs = platform(300.0, true).leg_state_by(parameter, motion, t).unwrap();
                let [values, slopes]: [Vec<f64>; 2] = [false, true].map(|slope| {
                    Output::all()
                        .map(|output| output.of(&legs))
                        .map(|x| if slope { x.derivative } else { x.value })
                        .collect()
                });
                assert_close(name, &values, &outputs(params, motion, t), 1e-12);
                // Five points leave the fifth derivative, times h⁴.
                let h = 1e-3 * parameter.value(&params, motion).abs().max(0.1);
                let moved = |amount: f64| {
                    let (mut params, mut motion) = (params, *motion);
                    parameter.add(amount, &mut params, &mut motion);
                    outputs(params, &motion, t)
                };
                let [more, less, far_more, far_less] = [h, -h, 2.0 * h, -2.0 * h].map(moved);
                // The power of all is a sum of powers that cancel.
                let largest = |kind: usize| values[6 * kind..][..6].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                for (i, output) in Output::all().enumerate() {
                    let difference = (8.0 * (more[i] - less[i]) - (far_more[i] - far_less[i])) / (12.0 * h);
                    let off = (slopes[i] - difference).abs();
                    assert!(
                        off <= 1e-8 * (1.0 + difference.abs() + largest((i / 6).min(3))),
                        "{name}, {t} s: ∂{output}/∂{parameter} = {} and not {difference}",
                        slopes[i]
                    );
                    nonzero += usize::from(difference.abs() > 1e-3);
                }
            }
        }
    }
    assert!(nonzero > 10_000, "{nonzero}");
}

/// Where the motion is imposed, `0 = ∂q̈/∂F ∂F/∂p + ∂q̈/∂p`: both factors are generated, and named by the generator.
#[test]
fn forces_by_parameters_are_those_of_the_generated_linearization() {
    let platform = platform(300.0, true);
    for (name, motion) in &Motion::CASES {
        let [q, qd, qdd] = motion.at(0.4);
        let forces = platform.leg_forces(&q, &qd, &qdd).unwrap();
        let by_forces = to_matrix(&platform.model().linearize(&q, &qd, &forces).u);
        let by_parameters = platform.model().linearize_parameters(&q, &qd, &forces);
        let by_parameters = SMatrix::<f64, 6, 19>::from_fn(|i, j| by_parameters[i][j]);
        let want = by_forces.lu().solve(&-by_parameters).expect("regular");
        for (column, parameter) in PARAMETERS.iter().enumerate() {
            let by: Parameter = parameter.parse().unwrap();
            let got = platform.leg_state_by(by, motion, 0.4).unwrap().force.map(|force| force.derivative);
            assert_close(&format!("{name} by {parameter}"), &got, want.column(column).as_slice(), 1e-10);
        }
    }
}

/// At home, in the middle of a surge of no size: every leg carries a sixth.
#[test]
fn textbook_formulas_at_home() {
    let still = Motion { mean: HOME, sine: [0.0; 6], cosine: [0.0; 6], frequency: [1.0; 6] };
    let by = |name: &str| platform(300.0, true).leg_state_by(name.parse().unwrap(), &still, 0.0).unwrap();
    let (rb, rp, h) = (1.2_f64, 0.9_f64, 1.1_f64);
    let turn = 36.0_f64.to_radians();
    // The theorem of cosines, with 60° − 12° − 12° between the joints of a leg.
    let l = (rb * rb + rp * rp - 2.0 * rb * rp * turn.cos() + h * h).sqrt();
    let all = |what: &str, got: [f64; 6], want: f64| assert_close(what, &got, &[want; 6], 1e-14);
    let lengths = |name: &str| by(name).length.map(|length| length.derivative);
    all("∂l/∂r_B", lengths("base_radius"), (rb - rp * turn.cos()) / l);
    all("∂l/∂r_P", lengths("platform_radius"), (rp - rb * turn.cos()) / l);
    all("∂l/∂δ_B", lengths("base_half_angle"), -rb * rp * turn.sin() / l);
    all("∂l/∂z", lengths("mean_z"), h / l);
    // 6 F h/l = m g: with the masses of plate and payload, and legs whose pistons stand on them.
    let forces = |name: &str| by(name).force.map(|force| force.derivative);
    all("∂F/∂m", forces("payload_mass"), 9.80665 * l / (6.0 * h));
    all("∂F/∂m", forces("platform_mass"), 9.80665 * l / (6.0 * h));
    // Levers about the foot: V = m_c g 0.35 h/l + m_p g (h − 0.4 h/l), F = dV/dz / (h/l), dl/dz = h/l.
    let slope = (1.0 - (h / l).powi(2)) / l;
    let weight = 550.0 / 6.0 + 35.0 * 0.35 * slope + 15.0 * (1.0 - 0.4 * slope);
    all("F", by("g").force.map(|force| force.value / 9.80665), weight * l / h);
    all("∂F/∂g", forces("g"), weight * l / h);
    all("∂F/∂m_c", forces("cylinder_mass"), 9.80665 * 0.35 * slope * l / h);
    // No motion, no inertia.
    all("∂F/∂I", forces("piston_inertia"), 0.0);
    // The speed of a heave: l̇ = (h/l) A ω, and power F l̇.
    let heave = Motion { sine: [0.0, 0.0, 0.1, 0.0, 0.0, 0.0], ..still };
    let by = |name: &str| platform(300.0, true).leg_state_by(name.parse().unwrap(), &heave, 0.0).unwrap();
    all("∂l̇/∂ω", by("omega").rate.map(|rate| rate.derivative), 0.1 * h / l);
    all("∂l̇/∂A", by("sine_z").rate.map(|rate| rate.derivative), h / l);
    let power = by("payload_mass").power().map(|power| power.derivative);
    all("∂P/∂m", power, 9.80665 / 6.0 * 0.1);
}

#[test]
fn names_and_units() {
    let mut names: Vec<&str> = Output::all().map(Output::name).chain(Parameter::all().map(Parameter::name)).collect();
    assert_eq!(names.len(), 25 + 19 + 24 + 1);
    assert!(Output::all().all(|output| output.name().parse() == Ok(output)));
    assert!(Parameter::all().all(|parameter| parameter.name().parse() == Ok(parameter)));
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 25 + 19 + 24 + 1);
    assert_eq!("force_7".parse::<Output>(), Err(Failure::Missing("output of this name").into()));
    assert_eq!("mass".parse::<Parameter>(), Err(Failure::Missing("parameter of this name").into()));
    // As declared; angles are declared in degrees and are radians.
    let (_, source) = mbs_models::SOURCES.iter().find(|(module, _)| *module == "stewart_platform").unwrap();
    let mut declared = Vec::new();
    for line in source.lines().filter_map(|line| line.trim().strip_prefix("param ")) {
        let (name, rest) = line.split_once(": ").unwrap();
        let unit = rest.split(" =").next().unwrap().replace('*', "·").replace("^2", "²").replace("deg", "rad");
        let count = name.split_once('[').map_or(1, |(_, size)| size.trim_end_matches(']').parse().unwrap());
        declared.extend(std::iter::repeat_n(unit, count));
    }
    let units: Vec<&str> = Parameter::all().map(Parameter::unit).take(19).collect();
    assert_eq!(units, declared);
}

#[test]
fn poses_without_legs_or_forces_are_refused() {
    let motion = Motion { mean: [f64::NAN; 6], ..Motion::TABLE_3 };
    let refused = Platform::default().leg_state_by(Parameter::Omega, &motion, 0.0);
    assert_eq!(refused.unwrap_err(), NOT_FINITE.into());
    let refused = Platform::default().leg_state_by(Parameter::Omega, &Motion::TABLE_3, f64::INFINITY);
    assert_eq!(refused.unwrap_err(), NOT_FINITE.into());
    // On its side the angles tell nothing.
    let motion =
        Motion { mean: [0.0, 0.0, 1.5, 0.0, std::f64::consts::FRAC_PI_2, 0.0], sine: [0.0; 6], ..Motion::CASES[1].1 };
    let refused = Platform::default().leg_state_by(Parameter::Platform(8), &motion, 0.0);
    assert!(matches!(refused, Err(Error { failure: Failure::Singular { .. }, .. })), "{refused:?}");
}
