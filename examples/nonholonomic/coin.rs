//! A coin that rolls: on a circle, leaning, and straight on, nodding.
//!
//! With the lean `θ` from upright, the heading's rate `Ω = φ̇`, the rate `s = ψ̇ + Ω sin θ` about the axis, moments of
//! inertia `A` about the axis and `B` about a diameter, it goes round at a constant lean where the moments about the
//! track balance,
//!
//! ```text
//! (A + m r²) s Ω cos θ − B Ω² sin θ cos θ + m g r sin θ = 0,   radius of the centre's circle r s/Ω
//! ```
//!
//! and upright and straight on it swings about the track with the frequency
//!
//! ```text
//! ν² = [A (A + m r²) s²/B − m g r]/(B + m r²)
//! ```
//!
//! so that it stays up where s² > m g r B/[A (A + m r²)], which is v² > g r/3 of a uniform disk.
//!
//! # Source
//! Routh, *Advanced Rigid Dynamics*, 6th edition 1905, §244, and Neimark, Fufaev, *Dynamics of Nonholonomic Systems*,
//! 1972, on the rolling disk.

use std::ops::ControlFlow;

use mbs_examples::Failure;
use mbs_runtime::{Event, Integrator, Response, State, accelerations};
use serde_json::Value;

use crate::flown::{Flown, projected};
use crate::rolling_coin::{Params, RollingCoin};

/// Of the circle: lean, to the left, and rate of the heading, to the left \[rad, rad/s\].
const LEAN: f64 = -0.4;
const TURN: f64 = 6.0;
const TURNS: f64 = 2.0;
/// Of the straight roll: rate about the axis \[rad/s\], and the first rate of the lean in terms of its frequency
/// \[rad\].
const SPIN: f64 = 40.0;
const NOD: f64 = 1e-4;

pub(crate) struct Coin {
    pub(crate) flown: Flown<5>,
    /// Of the circle of the centre \[m\].
    radius: f64,
    /// Its speed, and the least at which it rolls upright \[m/s\].
    speeds: [f64; 2],
    /// Of the swing of a coin that rolls straight on: measured, and by the formula \[s\].
    periods: [f64; 2],
}

pub(crate) fn run() -> Result<Coin, Failure> {
    let coin = RollingCoin::<f64>::default();
    let Params { m, radius, axial, transverse, g } = *coin.params();
    let (sin, cos) = LEAN.sin_cos();
    let rolling = axial + m * radius * radius;
    let about_axis = (transverse * TURN * TURN * cos - m * g * radius) * sin / (rolling * TURN * cos);
    let (circle, speed) = (radius * about_axis / TURN, radius * about_axis);
    let exact = |t: f64| {
        let (s, c) = (TURN * t).sin_cos();
        let spin = about_axis - TURN * sin;
        let q = [circle * s, circle * (1.0 - c), TURN * t, LEAN, spin * t];
        State::new(q, [speed * c, speed * s, TURN, 0.0, spin])
    };
    let flown = Flown::of(&coin, TURNS * std::f64::consts::TAU / TURN, 400, exact)?;
    let weight = m * g * radius;
    let frequency = ((axial * rolling * SPIN * SPIN / transverse - weight) / (transverse + rolling - axial)).sqrt();
    let least = radius * (weight * transverse / (axial * rolling)).sqrt();
    let periods = [swing(&coin, frequency)?, std::f64::consts::TAU / frequency];
    Ok(Coin { flown, radius: circle, speeds: [speed, least], periods })
}

/// From upright with a small rate of the lean to the next time that it passes upright the same way \[s\].
fn swing(coin: &RollingCoin<f64>, frequency: f64) -> Result<f64, Failure> {
    let speed = coin.params().radius * SPIN;
    // Where the coin tilts, its centre goes aside about the point of contact: −r θ̇ across.
    let tilt = NOD * frequency;
    let mut state = State::new([0.0; 5], [speed, -coin.params().radius * tilt, 0.0, tilt, SPIN]);
    let mut passed = |_, _: &mut State<[f64; 5]>| Response::Stop;
    let mut upright = [Event::new(&|_, s: &State<[f64; 5]>| s.q[3]).rising().with_action(&mut passed)];
    let motion = accelerations(coin, |_, _, _| []);
    let end = 1.5 * std::f64::consts::TAU / frequency;
    let summary = projected(coin)
        .integrate_with_events(motion, 0.0, end, &mut state, &mut upright, |_| ControlFlow::Continue(()))?;
    if summary.time < end { Ok(summary.time) } else { Err(Failure::new("the coin does not swing back")) }
}

impl Coin {
    /// The point of contact below a centre.
    pub(crate) fn contact(&self, state: &State<[f64; 5]>, radius: f64) -> [f64; 2] {
        let (sin, cos) = state.q[2].sin_cos();
        let aside = radius * state.q[3].sin();
        [state.q[0] - aside * sin, state.q[1] + aside * cos]
    }

    pub(crate) fn to_json(&self) -> Value {
        let mut all = self.flown.to_json(&[2, 3, 4]);
        all["circle_radius"] = self.radius.into();
        all["speed"] = self.speeds[0].into();
        all["least_speed_upright"] = self.speeds[1].into();
        all["swing_period"] = self.periods[0].into();
        all["swing_period_formula"] = self.periods[1].into();
        all
    }

    pub(crate) fn text(&self) -> String {
        format!(
            "rolling coin, leaning by {:.1}°: a circle of {:.3} mm at {:.4} m/s, {TURNS} turns\n{}  straight on at {SPIN} \
             rad/s it swings in {:.6} ms, by the formula {:.6} ms; upright from {:.4} m/s on\n",
            LEAN.to_degrees(),
            1e3 * self.radius,
            self.speeds[0],
            self.flown.text(&[2, 3, 4]),
            1e3 * self.periods[0],
            1e3 * self.periods[1],
            self.speeds[1]
        )
    }
}
