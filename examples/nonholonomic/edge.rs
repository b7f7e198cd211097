//! A knife edge on an incline, let go from rest while it turns.
//!
//! Along the blade `u̇ = g sin α cos φ` with `φ = ω t`, since nothing turns it, so that `u = (g sin α/ω) sin ω t` and
//!
//! ```text
//! x = g sin α/(2 ω²) sin² ω t,   y = g sin α/(2 ω²) (ω t − ½ sin 2 ω t),   λ = −m u ω − m g sin α sin φ
//! ```
//!
//! a cycloid: it never comes lower than g sin α/(2 ω²), and goes across the slope at g sin α/(2 ω) on the average.
//!
//! # Source
//! Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972, and Bloch, *Nonholonomic Mechanics and Control*, 2003,
//! section 1.6, on the knife edge on an inclined plane.

use mbs_examples::Failure;
use mbs_runtime::State;
use serde_json::Value;

use crate::flown::Flown;
use crate::knife_edge::{KnifeEdge, Params};

/// At which it turns \[rad/s\].
const RATE: f64 = 0.7;
/// Turns that are looked at.
const TURNS: f64 = 2.0;

pub(crate) struct Edge {
    pub(crate) flown: Flown<3>,
    /// Greatest difference of the multiplier from its closed form \[N\].
    multiplier_error: f64,
    /// How far down it comes \[m\].
    lowest: f64,
    /// How far across it has come \[m\].
    across: f64,
}

pub(crate) fn run() -> Result<Edge, Failure> {
    let edge = KnifeEdge::<f64>::default();
    let Params { m, slope, g, .. } = *edge.params();
    let pull = g * slope.sin();
    let exact = |t: f64| {
        let (sin, cos) = (RATE * t).sin_cos();
        let size = pull / (2.0 * RATE * RATE);
        let speed = pull / RATE * sin;
        let place = [size * sin * sin, size * (RATE * t - sin * cos), RATE * t];
        State::new(place, [speed * cos, speed * sin, RATE])
    };
    let flown = Flown::of(&edge, TURNS * std::f64::consts::TAU / RATE, 400, exact)?;
    let multiplier_error = flown.samples.iter().fold(0.0_f64, |most, (t, state)| {
        let sin = (RATE * t).sin();
        let exact = -m * pull * sin - m * pull * sin;
        most.max((edge.multipliers(&state.q, &state.qd)[0] - exact).abs())
    });
    let lowest = flown.samples.iter().fold(0.0_f64, |most, (_, state)| most.max(state.q[0]));
    let across = flown.samples.last().map_or(0.0, |(_, state)| state.q[1]);
    Ok(Edge { flown, multiplier_error, lowest, across })
}

impl Edge {
    pub(crate) fn to_json(&self) -> Value {
        let mut all = self.flown.to_json(&[2]);
        all["multiplier_error"] = self.multiplier_error.into();
        all["lowest"] = self.lowest.into();
        all["across"] = self.across.into();
        all
    }

    pub(crate) fn text(&self) -> String {
        format!(
            "knife edge on an incline, from rest: {TURNS} turns later {:.3} m across, never more than {:.3} m down\n{}  \
             multiplier {:.1e} N\n",
            self.across,
            self.lowest,
            self.flown.text(&[2]),
            self.multiplier_error
        )
    }
}
