//! Chaplygin's sleigh, pushed backwards: the blade behind the mass centre is where it wants to be.
//!
//! With the speed `v` along the blade, `ω = φ̇` and `k² = (I + m a²)/m`,
//!
//! ```text
//! v̇ = a ω²,   k² ω̇ = −a v ω,   v² + k² ω² = V²
//! v = V tanh τ,   ω = (V/k) sech τ,   φ = (2 k/a) [atan tanh(τ/2) − atan tanh(τ₀/2)],   τ = a V (t − t₁)/k²
//! ```
//!
//! It turns by π k/a in all. The path is the integral of v along the blade, found by Gauss' formula.
//!
//! # Source
//! Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972; Bloch, *Nonholonomic Mechanics and Control*, 2003,
//! section 1.7.

use mbs_examples::Failure;
use mbs_runtime::State;
use serde_json::{Value, json};

use crate::chaplygin_sleigh::{ChaplyginSleigh, Params};
use crate::flown::Flown;

/// `V`: its speed in the end \[m/s\].
const SPEED: f64 = 1.0;
/// `t₁`: when it turns fastest \[s\].
const TURNING: f64 = 3.0;
/// How long it is looked at \[s\].
const DURATION: f64 = 6.0;

pub(crate) struct Sleigh {
    pub(crate) flown: Flown<3>,
    pub(crate) a: f64,
    /// Times, speed and rate of turning, integrated \[s, m/s, rad/s\].
    pub(crate) rates: Vec<[f64; 3]>,
    /// By the closed form.
    pub(crate) exact_rates: Vec<[f64; 3]>,
    /// Greatest difference of v \[m/s\] and ω \[rad/s\] from the closed form.
    rate_errors: [f64; 2],
    /// Momentum at both ends, along two fixed axes \[kg·m/s\].
    momentum: [[f64; 2]; 2],
    /// Angular momentum about the mass centre at both ends and where it is greatest \[kg·m²/s\].
    spin: [f64; 3],
    /// By how much it has turned, and by how much it would in all time \[rad\].
    turned: [f64; 2],
}

/// The closed form.
struct Exact {
    a: f64,
    k: f64,
}

impl Exact {
    fn tau(&self, t: f64) -> f64 {
        self.a * SPEED * (t - TURNING) / (self.k * self.k)
    }

    fn rates(&self, t: f64) -> [f64; 2] {
        let tau = self.tau(t);
        [SPEED * tau.tanh(), SPEED / self.k / tau.cosh()]
    }

    fn heading(&self, t: f64) -> f64 {
        let angle = |t: f64| (0.5 * self.tau(t)).tanh().atan();
        2.0 * self.k / self.a * (angle(t) - angle(0.0))
    }

    /// By Gauss' formula of five points in parts of at most 0.02 s.
    fn path(&self, t: f64) -> [f64; 2] {
        const POINTS: [(f64, f64); 3] = [
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ];
        let parts = (t / 0.02).ceil();
        let half = 0.5 * t / parts.max(1.0);
        let (mut sum, mut part) = ([0.0; 2], 0.0);
        while part < parts {
            let middle = (2.0 * part + 1.0) * half;
            for (node, weight) in POINTS {
                let sides: &[f64] = if node == 0.0 { &[0.0] } else { &[-1.0, 1.0] };
                for side in sides {
                    let at = middle + side * node * half;
                    let (sin, cos) = self.heading(at).sin_cos();
                    let length = half * weight * self.rates(at)[0];
                    sum = [sum[0] + length * cos, sum[1] + length * sin];
                }
            }
            part += 1.0;
        }
        sum
    }

    fn state(&self, t: f64) -> State<[f64; 3]> {
        let ([x, y], phi, [v, omega]) = (self.path(t), self.heading(t), self.rates(t));
        State::new([x, y, phi], [v * phi.cos(), v * phi.sin(), omega])
    }
}

pub(crate) fn run() -> Result<Sleigh, Failure> {
    let sleigh = ChaplyginSleigh::<f64>::default();
    let Params { m, moment, a } = *sleigh.params();
    let exact = Exact { a, k: (moment / m + a * a).sqrt() };
    let flown = Flown::of(&sleigh, DURATION, 300, |t| exact.state(t))?;
    let of = |t: f64, state: &State<[f64; 3]>| {
        let (sin, cos) = state.q[2].sin_cos();
        [t, state.qd[0] * cos + state.qd[1] * sin, state.qd[2]]
    };
    let rates: Vec<[f64; 3]> = flown.samples.iter().map(|(t, state)| of(*t, state)).collect();
    let exact_rates: Vec<[f64; 3]> =
        flown.samples.iter().map(|&(t, _)| [t, exact.rates(t)[0], exact.rates(t)[1]]).collect();
    let error = |i: usize| rates.iter().zip(&exact_rates).fold(0.0_f64, |most, (a, b)| most.max((a[i] - b[i]).abs()));
    let momentum = |state: &State<[f64; 3]>| {
        let (sin, cos) = state.q[2].sin_cos();
        [m * (state.qd[0] - a * sin * state.qd[2]), m * (state.qd[1] + a * cos * state.qd[2])]
    };
    let ends = [&flown.samples[0].1, &flown.samples[flown.samples.len() - 1].1];
    let greatest = rates.iter().fold(0.0_f64, |most, rate| most.max(rate[2]));
    Ok(Sleigh {
        a,
        rate_errors: [error(1), error(2)],
        momentum: ends.map(momentum),
        spin: [ends[0].qd[2], greatest, ends[1].qd[2]].map(|rate| moment * rate),
        turned: [ends[1].q[2], std::f64::consts::PI * exact.k / a],
        rates,
        exact_rates,
        flown,
    })
}

impl Sleigh {
    pub(crate) fn to_json(&self) -> Value {
        let mut all = self.flown.to_json(&[2]);
        all["speed_error"] = self.rate_errors[0].into();
        all["rate_error"] = self.rate_errors[1].into();
        all["momentum"] = json!({"start": self.momentum[0], "end": self.momentum[1]});
        all["angular_momentum"] = json!({"start": self.spin[0], "greatest": self.spin[1], "end": self.spin[2]});
        all["turned"] = self.turned[0].into();
        all["turns_in_all_time"] = self.turned[1].into();
        all
    }

    pub(crate) fn text(&self) -> String {
        let [[x, y], [u, v]] = self.momentum;
        format!(
            "Chaplygin's sleigh, pushed backwards: it turns by {:.4} rad of the {:.4} rad of all time\n{}  v {:.1e} m/s, ω \
             {:.1e} rad/s; momentum from ({x:.3}, {y:.3}) to ({u:.3}, {v:.3}) kg·m/s, about the mass centre from {:.4} over \
             {:.4} to {:.4} kg·m²/s\n",
            self.turned[0],
            self.turned[1],
            self.flown.text(&[2]),
            self.rate_errors[0],
            self.rate_errors[1],
            self.spin[0],
            self.spin[1],
            self.spin[2]
        )
    }
}
