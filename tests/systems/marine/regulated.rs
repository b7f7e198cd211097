//! The regulator, and thrusters at their limits.

use mbs_models::marine_platform::Params;
use mbs_platform::marine::control::{Regulator, STATES, Weights, linearized};
use mbs_platform::marine::excitation::Excitation;
use mbs_platform::marine::simulation::{AtSea, Moment};
use mbs_platform::marine::thrusters::Thrusters;
use mbs_platform::marine::wind::Wind;
use mbs_runtime::{State, to_matrix};
use nalgebra::{Complex, SMatrix};

use super::{hull, sea, uniform};

type Square = SMatrix<f64, STATES, STATES>;

fn sorted(values: impl Iterator<Item = Complex<f64>>) -> Vec<Complex<f64>> {
    let mut values: Vec<_> = values.collect();
    values.sort_by(|a, b| (a.re, a.im).partial_cmp(&(b.re, b.im)).expect("numbers"));
    values
}

/// Those of A − B K, those that the library finds, and the stable ones of Hamilton's matrix, which needs no K.
#[test]
fn the_loop_has_the_poles_of_hamiltons_matrix() {
    let (params, weights) = (Params::default(), Weights::default());
    let plant = linearized(&params);
    assert_eq!(plant.controllability_rank(), Ok(STATES));
    let regulator = Regulator::new(&params, &weights).expect("a regulator");
    let poles = plant.with_feedback(&regulator.gain).poles().expect("poles");
    assert!(poles.iter().all(|pole| pole.re < -0.05), "{poles:?}");

    let (a, b): (Square, SMatrix<f64, STATES, 6>) = (to_matrix(&plant.a), to_matrix(&plant.b));
    let gain: SMatrix<f64, 6, STATES> = to_matrix(&regulator.gain);
    let of_loop = sorted((a - b * gain).complex_eigenvalues().iter().copied());
    // With forces in units of 1e5 N, so that entries are of one order.
    let weight = |i: usize| if i < 4 { weights.position[i] } else { weights.rate[i - 4] };
    let q = Square::from_fn(|i, j| if i == j { weight(i).powi(-2) } else { 0.0 });
    let r = SMatrix::<f64, 6, 6>::from_fn(|i, j| if i == j { weights.thrust[i].powi(2) } else { 0.0 });
    let mut hamilton = SMatrix::<f64, 16, 16>::zeros();
    hamilton.fixed_view_mut::<8, 8>(0, 0).copy_from(&a);
    hamilton.fixed_view_mut::<8, 8>(0, 8).copy_from(&(-b * r * b.transpose()));
    hamilton.fixed_view_mut::<8, 8>(8, 0).copy_from(&-q);
    hamilton.fixed_view_mut::<8, 8>(8, 8).copy_from(&-a.transpose());
    let stable = sorted(hamilton.complex_eigenvalues().iter().copied().filter(|value| value.re < 0.0));
    let found = sorted(poles.iter().map(|pole| Complex::new(pole.re, pole.im)));
    assert_eq!(stable.len(), STATES);
    let close = |a: &[Complex<f64>], b: &[Complex<f64>], tolerance: f64| {
        // Each has its partner: the order of nearly equal real parts is that of rounding.
        assert!(a.iter().all(|x| b.iter().any(|y| (x - y).norm() < tolerance)), "{a:?}\n{b:?}");
    };
    close(&found, &of_loop, 1e-10);
    close(&found, &stable, 1e-7);
    close(&stable, &found, 1e-7);
}

/// Without control it swings with the natural periods, lightly damped.
#[test]
fn the_free_platform_has_the_natural_frequencies() {
    let (params, hull) = (Params::default(), hull());
    let poles = linearized(&params).poles().expect("poles");
    let damping = [params.heave_damping, params.turn_damping[0], params.turn_damping[1], params.turn_damping[2]];
    for i in 0..4 {
        let (inertia, stiffness) = (hull.inertia()[i], hull.stiffness()[i]);
        let re = -0.5 * damping[i] / inertia;
        let im = (stiffness / inertia - re * re).sqrt();
        assert!(poles.iter().any(|pole| (pole.re - re).abs() < 1e-12 && (pole.im - im).abs() < 1e-12), "{poles:?}");
    }
}

fn run(regulator: Option<Regulator>, thrusters: Thrusters) -> Vec<Moment> {
    let hull = hull();
    let wind = Wind::<20>::new(12.0, 2.0, uniform(8)).expect("a wind");
    let mut at_sea = AtSea::new(&hull.params, Excitation::new(&hull, &sea::<60>(9)), wind).expect("a platform");
    (at_sea.regulator, at_sea.thrusters) = (regulator, thrusters);
    let mut moments = Vec::new();
    at_sea.simulate(State::new([0.0; 4], [0.0; 4]), 0.1, 600.0, |moment| moments.push(*moment)).expect("a motion");
    moments
}

fn regulator() -> Option<Regulator> {
    Some(Regulator::new(&Params::default(), &Weights::default()).expect("a regulator"))
}

#[test]
fn thrusters_keep_their_limits() {
    let limits = Thrusters { thrust: [8e3; 6], rate: [4e3; 6] };
    let moments = run(regulator(), limits);
    let mut before = [0.0; 6];
    let (mut most, mut fastest) = (0.0_f64, 0.0_f64);
    for moment in &moments {
        for i in 0..6 {
            most = most.max(moment.thrust[i].abs());
            fastest = fastest.max((moment.thrust[i] - before[i]).abs() / 0.1);
        }
        before = moment.thrust;
    }
    // Both are reached, and neither is passed.
    assert_eq!(most, 8e3);
    assert!((fastest - 4e3).abs() < 1e-6, "{fastest}");
    assert!(moments.iter().any(|moment| moment.asked != moment.thrust));
}

/// Of a coordinate, beyond the start.
fn rms(moments: &[Moment], i: usize) -> f64 {
    let values: Vec<f64> = moments[1000..].iter().map(|moment| moment.q[i]).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Thrusters that are at their limits most of the time come late.
#[test]
fn greater_gains_make_it_worse() {
    let angles = [0.2_f64, 0.2, 0.1].map(f64::to_radians);
    let greedy = Weights { rate: [0.1, angles[0], angles[1], angles[2]], ..Weights::default() };
    let greedy = Regulator::new(&Params::default(), &greedy).expect("a regulator");
    let (free, moments) = (run(None, Thrusters::default()), run(Some(greedy), Thrusters::default()));
    let limited = moments.iter().filter(|moment| moment.asked[0] != moment.thrust[0]).count();
    assert!(2 * limited > moments.len(), "{limited} of {}", moments.len());
    assert!(rms(&moments, 1) > rms(&free, 1), "{} {}", rms(&moments, 1), rms(&free, 1));
}

#[test]
fn control_calms_the_platform() {
    let (free, controlled) = (run(None, Thrusters::default()), run(regulator(), Thrusters::default()));
    assert!(free.iter().all(|moment| moment.thrust == [0.0; 6]));
    for (i, most) in [(0, 0.8), (1, 0.95), (2, 0.7), (3, 0.5)] {
        let (before, after) = (rms(&free, i), rms(&controlled, i));
        assert!(after < most * before, "{i}: {before} {after}");
    }
}
