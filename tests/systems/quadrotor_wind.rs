//! Dryden's turbulence over a long run against its closed forms, and landings in wind that changes.

use std::f64::consts::TAU;

use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::wind::{Gusts, Shear, Turbulence, Wind};
use mbs_models::{At, Error, Failure};
use mbs_tests::random::Random;

/// Normal deviates by Box and Muller.
struct Normal(Random);

impl Normal {
    fn next(&mut self) -> f64 {
        let (u, angle) = (self.0.uniform(0.0..1.0), self.0.uniform(0.0..TAU));
        (-2.0 * (1.0 - u).ln()).sqrt() * angle.cos()
    }

    fn five(&mut self) -> [f64; 5] {
        std::array::from_fn(|_| self.next())
    }
}

const HEIGHT: f64 = 30.0;
const SPEED: f64 = 12.0;
const STEP: f64 = 0.05;

/// u, v, w of a vehicle at rest in this wind, whose mean blows along x.
fn run(seed: u64, count: usize) -> Vec<[f64; 3]> {
    let wind = Wind::new(SPEED, 0.0, Shear::Power { exponent: 0.0 }, 0.0).unwrap();
    let mut normal = Normal(Random::new(seed));
    let mut gusts = Gusts::stationary(&normal.five());
    let blow = |_| {
        let [u, v, w] = wind.blow(&mut gusts, HEIGHT, &[0.0; 3], STEP, &normal.five());
        [u - SPEED, v, w]
    };
    (0..count).map(blow).collect()
}

/// `R_u = σ² e^−r`, `R_v = R_w = σ² e^−r (1 − r/2)` with `r = V t/L` (Dryden's correlations, as of isotropic
/// turbulence); 200 000 s have some 20 000 lengths.
#[test]
fn variances_and_correlations_are_drydens() {
    let field = run(7, 4_000_000);
    let Turbulence { length, deviation } = Turbulence::at(HEIGHT, SPEED);
    for axis in 0..3 {
        let variance = deviation[axis].powi(2);
        for lag in [0_usize, 10, 40, 100, 160] {
            let products = field.windows(lag + 1).map(|part| part[0][axis] * part[lag][axis]);
            let found = products.sum::<f64>() / (field.len() - lag) as f64 / variance;
            let r = SPEED * lag as f64 * STEP / length[axis];
            let expected = (-r).exp() * if axis == 0 { 1.0 } else { 1.0 - 0.5 * r };
            assert!((found - expected).abs() < 0.02, "axis {axis}, lag {lag}: {found}, not {expected}");
        }
    }
    // Neither is correlated with another.
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let found = field.iter().map(|g| g[a] * g[b]).sum::<f64>() / field.len() as f64 / deviation[a] / deviation[b];
        assert!(found.abs() < 0.02, "{a} and {b}: {found}");
    }
}

/// Averaged periodograms against the two-sided spectral density of a sampled signal, `2 Σ R(k) cos(ω k Δ) Δ`, that is
/// `Φ(Ω)/V` with `Ω = ω/V` where the sampling is fine.
#[test]
fn the_spectrum_is_drydens() {
    const SEGMENT: usize = 4096;
    let field = run(11, 400 * SEGMENT);
    let Turbulence { length, deviation } = Turbulence::at(HEIGHT, SPEED);
    let duration = SEGMENT as f64 * STEP;
    for axis in 0..3 {
        for harmonic in [8_usize, 20, 60] {
            let w = TAU * harmonic as f64 / duration;
            let power: f64 = field
                .chunks(SEGMENT)
                .map(|part| {
                    let (mut re, mut im) = (0.0, 0.0);
                    for (k, gust) in part.iter().enumerate() {
                        let (sin, cos) = (w * k as f64 * STEP).sin_cos();
                        // Hann's window keeps what leaks from low frequencies out.
                        let window = 1.0 - (TAU * (k as f64 + 0.5) / SEGMENT as f64).cos();
                        (re, im) = (re + window * gust[axis] * cos, im + window * gust[axis] * sin);
                    }
                    (re * re + im * im) * STEP * STEP / duration / 1.5
                })
                .sum::<f64>()
                / 400.0;
            // One-sided over Ω, from the standard: ∫ Φ dΩ = σ².
            let x2 = (length[axis] * w / SPEED).powi(2);
            let l = length[axis] / std::f64::consts::PI;
            let density = deviation[axis].powi(2)
                * if axis == 0 { 2.0 * l / (1.0 + x2) } else { l * (1.0 + 3.0 * x2) / (1.0 + x2).powi(2) };
            // Two-sided over ω: a half of it, over V; times 2π for a periodogram.
            let expected = density / SPEED * TAU / 2.0;
            assert!((power / expected - 1.0).abs() < 0.15, "axis {axis}, {w} rad/s: {power}, not {expected}");
        }
    }
}

#[test]
fn a_seed_gives_the_same_gusts() {
    let bits = |seed: u64| run(seed, 500).into_iter().flatten().map(f64::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(3), bits(3));
    assert_ne!(bits(3), bits(4));
}

/// In still air nothing moves, and the field stays what it is.
#[test]
fn a_field_without_wind_stands_still() {
    let wind = Wind::new(0.0, 0.0, Shear::LANDING, 0.0).unwrap();
    let mut gusts = Gusts::stationary(&[1.0, -0.5, 0.2, 0.3, 0.4]);
    let before = gusts;
    assert_eq!(wind.blow(&mut gusts, 5.0, &[0.0; 3], 0.01, &[1.0; 5]), [0.0; 3]);
    assert_eq!(gusts, before);
}

#[test]
fn a_landing_in_a_wind_that_stays_is_that_in_steady_wind() {
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    landing.wind = [2.0, -1.0, 0.3];
    let start = Landing::initial_state();
    let steady = landing.simulate_sampled(start, 0.004, |_, state| *state).unwrap();
    let calm = Landing::new(Plant::Exact, Heave::CASE_I);
    let held = calm.simulate_in_wind(start, 0.004, |_, state| *state, |_, _| [2.0, -1.0, 0.3]).unwrap();
    assert_eq!(steady, held);
    let lost = calm.simulate_in_wind(
        start,
        0.004,
        |_, state| *state,
        |t, _| if t < 1.0 { [0.0; 3] } else { [0.0, f64::NAN, 0.0] },
    );
    assert!(
        matches!(lost, Err(Error { failure: Failure::NotFinite("the wind"), at: Some(At::Time(time)) }) if (time - 1.0).abs() < 1e-9),
        "{lost:?}"
    );
}
