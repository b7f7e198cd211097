//! Problems of optimal control in discrete time, and plans that solve them.

use std::vec::Vec;

use nalgebra::{SMatrix, SVector};

/// What a step leads to, and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<const X: usize, const U: usize> {
    /// The state at its end.
    pub end: SVector<f64, X>,
    /// By the state at its beginning.
    pub by_state: SMatrix<f64, X, X>,
    /// By the input.
    pub by_input: SMatrix<f64, X, U>,
    /// By its length \[1/s\].
    pub by_length: SVector<f64, X>,
}

impl<const X: usize, const U: usize> Step<X, U> {
    pub(super) fn still() -> Self {
        Step {
            end: SVector::zeros(),
            by_state: SMatrix::zeros(),
            by_input: SMatrix::zeros(),
            by_length: SVector::zeros(),
        }
    }
}

/// A condition `g(x, t) ≥ 0` at a node, and its derivatives. Its unit is what it may be off by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition<const X: usize> {
    /// What is kept.
    pub name: &'static str,
    /// g
    pub value: f64,
    /// `∂g/∂x`
    pub by_state: SVector<f64, X>,
    /// `∂g/∂t` \[1/s\]
    pub by_time: f64,
}

impl<const X: usize> Condition<X> {
    /// One of this name that always holds.
    #[must_use]
    pub fn vacant(&self) -> Self {
        Condition { name: self.name, value: 1.0, by_state: SVector::zeros(), by_time: 0.0 }
    }
}

/// What deviations cost at a node, `½ (x − x̄)ᵀ Q (x − x̄) + ½ (u − ū)ᵀ R (u − ū)`; u counts before the last node only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost<const X: usize, const U: usize> {
    /// Q, symmetric and not negative.
    pub state: SMatrix<f64, X, X>,
    /// x̄
    pub target: SVector<f64, X>,
    /// R, symmetric and positive.
    pub input: SMatrix<f64, U, U>,
    /// ū
    pub input_target: SVector<f64, U>,
}

/// A free end of the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeEnd {
    /// The shortest and the longest horizon \[s\].
    pub range: [f64; 2],
    /// What a second costs.
    pub weight: f64,
}

/// A problem of optimal control with X states and U inputs over N intervals.
pub trait OptimalControl<const X: usize, const U: usize> {
    /// N
    fn intervals(&self) -> usize;

    /// The time of the first node \[s\].
    fn start(&self) -> f64;

    /// The state at the first node.
    fn initial_state(&self) -> SVector<f64, X>;

    /// Over an interval of this length \[s\].
    fn step(&self, x: &SVector<f64, X>, u: &SVector<f64, U>, length: f64) -> Step<X, U>;

    /// The least and the greatest inputs after a node.
    fn bounds(&self, node: usize) -> [SVector<f64, U>; 2];

    /// Whether the length of the horizon is a variable.
    fn free_end(&self) -> Option<FreeEnd>;

    /// At a node, at its time \[s\].
    fn cost(&self, node: usize, t: f64) -> Cost<X, U>;

    /// What must hold at a node after the first, at its time \[s\]: always the same conditions in the same order.
    fn conditions(&self, node: usize, t: f64, x: &SVector<f64, X>, rows: &mut Vec<Condition<X>>);
}

/// A motion over a horizon: N + 1 states, and N inputs that are held in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan<const X: usize, const U: usize> {
    /// The time of the first state \[s\].
    pub start: f64,
    /// The length of the horizon \[s\], positive.
    pub duration: f64,
    /// At the nodes.
    pub states: Vec<SVector<f64, X>>,
    /// Between them.
    pub inputs: Vec<SVector<f64, U>>,
}

impl<const X: usize, const U: usize> Plan<X, U> {
    /// The time of a node \[s\].
    #[must_use]
    pub fn time(&self, node: usize) -> f64 {
        self.start + self.duration * node as f64 / self.inputs.len() as f64
    }

    /// The input at a time \[s\]; the first one before, the last one after the horizon.
    #[must_use]
    pub fn input(&self, t: f64) -> SVector<f64, U> {
        let intervals = self.inputs.len();
        // A moment that rounding has put before its node belongs to it.
        let at = (t - self.start) / self.duration * intervals as f64 + 1e-9;
        self.inputs[(at.max(0.0) as usize).min(intervals - 1)]
    }

    /// The root of the mean square of the input from a time on for a period \[s\]: of rotor speeds, what gives the same
    /// impulse.
    #[must_use]
    pub fn mean_input(&self, t: f64, period: f64) -> SVector<f64, U> {
        let (mut at, mut sum) = (t, SVector::<f64, U>::zeros());
        while at < t + period - 1e-9 {
            let until = self.change_after(at).min(t + period);
            sum += self.input(at).map(|u| u * u) * (until - at);
            at = until;
        }
        (sum / (at - t)).map(|square| square.sqrt())
    }

    /// When the input changes next after a time \[s\]; infinite after the last change.
    #[must_use]
    pub fn change_after(&self, t: f64) -> f64 {
        let nodes = (0..=self.inputs.len()).map(|node| self.time(node));
        nodes.into_iter().find(|&node| node > t + 1e-9).unwrap_or(f64::INFINITY)
    }

    /// The state at a time \[s\], straight between nodes; the last one is kept after the horizon.
    #[must_use]
    pub fn state(&self, t: f64) -> SVector<f64, X> {
        let intervals = self.inputs.len();
        let at = ((t - self.start) / self.duration * intervals as f64).clamp(0.0, intervals as f64);
        let node = (at as usize).min(intervals - 1);
        self.states[node] + (self.states[node + 1] - self.states[node]) * (at - node as f64)
    }

    /// The same motion over another horizon, as the first guess for what is planned next.
    #[must_use]
    pub fn moved(&self, start: f64, duration: f64) -> Self {
        let intervals = self.inputs.len();
        let time = |at: f64| start + duration * at / intervals as f64;
        Plan {
            start,
            duration,
            states: (0..=intervals).map(|node| self.state(time(node as f64))).collect(),
            inputs: (0..intervals).map(|node| self.input(time(node as f64 + 0.5))).collect(),
        }
    }

    /// Whether every number is.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.duration.is_finite()
            && self.states.iter().all(|x| x.iter().all(|x| x.is_finite()))
            && self.inputs.iter().all(|u| u.iter().all(|u| u.is_finite()))
    }
}
