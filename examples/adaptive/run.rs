//! A motion under a controller, sampled, and what is measured of it.

use std::ops::ControlFlow;

use mbs_examples::Failure;
use mbs_runtime::{Dop853, Integrator, State};

/// One moment.
pub(crate) struct Sample {
    pub(crate) t: f64,
    /// Coordinates, velocities, accelerations.
    pub(crate) motion: [[f64; 6]; 3],
    pub(crate) seen: Seen,
}

/// What is to be seen of a loop.
pub(crate) struct Seen {
    /// Distance from the reference: of the arm's flange, of the quadrotor's mass centre \[m\].
    pub(crate) error: f64,
    /// Joint torques \[N·m\], or thrust and torques of the rotors \[N, N·m\].
    pub(crate) forces: Vec<f64>,
    /// Whether a rotor would have had to turn backwards.
    pub(crate) limited: bool,
    /// What is learnt; none where nothing is.
    pub(crate) estimate: Vec<f64>,
    /// V \[J\]; 0 where nothing is learnt.
    pub(crate) lyapunov: f64,
    /// `∫ sᵀ K_D s dt` until now \[J\].
    pub(crate) spent: f64,
}

/// What a controller made of a motion.
pub(crate) struct Run {
    pub(crate) samples: Vec<Sample>,
    pub(crate) check: LyapunovCheck,
}

/// Whether V does what it must, at every step of the integrator and at every sample.
#[derive(Clone, Copy, Default)]
pub(crate) struct LyapunovCheck {
    /// V at the beginning \[J\].
    pub(crate) first: f64,
    /// V at the end \[J\].
    pub(crate) last: f64,
    /// The most that V grew from one look to the next \[J\]; 0 where it never did.
    pub(crate) greatest_rise: f64,
    /// The most that V, with `∫ sᵀ K_D s dt`, was off what it was at the beginning \[J\].
    pub(crate) greatest_imbalance: f64,
    /// How often it was looked at.
    pub(crate) looks: usize,
}

/// What rounding and the integrator may add to V, as a part of what it is at the beginning.
const TOLERANCE: f64 = 1e-8;

impl LyapunovCheck {
    /// Whether V never grew, and lost what damping took.
    pub(crate) fn holds(&self) -> bool {
        self.greatest_rise <= TOLERANCE * self.first && self.greatest_imbalance <= TOLERANCE * self.first
    }

    fn look(&mut self, &Seen { lyapunov: value, spent, .. }: &Seen) {
        if self.looks == 0 {
            self.first = value;
            self.last = value;
        }
        self.greatest_rise = self.greatest_rise.max(value - self.last);
        self.greatest_imbalance = self.greatest_imbalance.max((value + spent - self.first).abs());
        self.last = value;
        self.looks += 1;
    }
}

/// A mechanism of six coordinates with its controller, as the integrator sees it: coordinates, then integrals of
/// whatever else has a rate, so that the velocities behind the sixth are those numbers themselves.
pub(crate) trait Loop {
    /// The accelerations, and the rates of the numbers behind them.
    fn rates(&self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]);

    /// What is to be seen.
    fn look(&self, t: f64, q: &[f64], v: &[f64]) -> Seen;
}

/// Between two samples \[s\].
const SAMPLING: f64 = 0.02;

/// Runs a loop from t = 0 to its end \[s\].
pub(crate) fn simulate(of: &impl Loop, start: [f64; 6], velocities: Vec<f64>, end: f64) -> Result<Run, Failure> {
    let mut q = vec![0.0; velocities.len()];
    q[..6].copy_from_slice(&start);
    let mut state = State::new(q, velocities);
    let (mut samples, mut check, mut between) = (Vec::new(), LyapunovCheck::default(), state.clone());
    let mut failed = None;
    let right = |t: f64, q: &Vec<f64>, v: &Vec<f64>, a: &mut Vec<f64>| of.rates(t, q, v, a);
    Dop853::new(1e-10, 1e-10).integrate(right, 0.0, end, &mut state, |step| {
        loop {
            let t = samples.len() as f64 * SAMPLING;
            if t > step.time() {
                break;
            }
            if let Err(error) = step.interpolate(t, &mut between) {
                failed = Some(error);
                return ControlFlow::Break(step.time());
            }
            let seen = of.look(t, &between.q, &between.qd);
            check.look(&seen);
            let mut rates = between.qd.clone();
            of.rates(t, &between.q, &between.qd, &mut rates);
            samples.push(Sample { t, motion: [&between.q, &between.qd, &rates].map(|all| first(all)), seen });
        }
        check.look(&of.look(step.time(), &step.state().q, &step.state().qd));
        ControlFlow::Continue(())
    })?;
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(Run { samples, check }),
    }
}

/// Errors in a part of a run \[m\].
#[derive(Clone, Copy)]
pub(crate) struct Errors {
    pub(crate) greatest: f64,
    pub(crate) root_mean_square: f64,
}

impl Run {
    /// From one time to another \[s\].
    pub(crate) fn errors(&self, from: f64, to: f64) -> Errors {
        let errors = || self.samples.iter().filter(|s| from <= s.t && s.t <= to).map(|s| s.seen.error);
        let squares: f64 = errors().map(|e| e * e).sum();
        Errors { greatest: errors().fold(0.0, f64::max), root_mean_square: (squares / errors().count() as f64).sqrt() }
    }

    /// The last moment.
    pub(crate) fn end(&self) -> &Sample {
        &self.samples[self.samples.len() - 1]
    }

    /// The largest of a force, either way.
    pub(crate) fn greatest_force(&self, which: usize) -> f64 {
        self.samples.iter().fold(0.0, |most, s| most.max(s.seen.forces[which].abs()))
    }
}

/// The first numbers of many.
pub(crate) fn first<const N: usize>(numbers: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| numbers[i])
}
