//! Sequential quadratic programming: to the optimum, or one program a sample.
//!
//! Each program has the cost itself as its quadratic form (Gauss–Newton), which the steps and conditions are linear in.
//! To the optimum, corrections are halved until they lessen the cost with a price on what is broken, ten times at most,
//! and then taken; in real time they are taken whole, and the state that was measured enters the next program as it is
//! (initial value embedding).

use std::vec::Vec;

use super::problem::{OptimalControl, Plan};
pub use super::quadratic::Residual;
use super::quadratic::{Correction, Linearized, Programs};
use mbs_models::{Error, Failure};

/// How programs are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// ρ, the price of breaking a condition by its unit; above all multipliers where it is to be kept if it can be.
    pub broken: f64,
    /// What half the square of a correction costs at first; it is halved while they are taken whole.
    pub damping: f64,
    /// The accuracy of the interior-point method.
    pub accuracy: f64,
    /// The residual of an optimum.
    pub tolerance: f64,
    /// By how much a condition may be broken.
    pub feasibility: f64,
    /// The residual below which what is still broken cannot be kept.
    pub infeasibility: f64,
    /// When to give up.
    pub most_programs: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            broken: 100.0,
            damping: 1e-3,
            accuracy: 1e-9,
            tolerance: 1e-5,
            feasibility: 1e-4,
            infeasibility: 1e-3,
            most_programs: 150,
        }
    }
}

/// The condition that a plan breaks most, or comes nearest to breaking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Which.
    pub condition: &'static str,
    /// Where, counted from 0.
    pub node: usize,
    /// By how much, in its unit; negative where it is kept.
    pub excess: f64,
}

/// A plan that was found, and how good it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum<const X: usize, const U: usize> {
    /// The plan.
    pub plan: Plan<X, U>,
    /// What is left of the conditions of optimality.
    pub residual: Residual,
    /// How many programs it took.
    pub programs: usize,
    /// How many iterations of the interior-point method in them.
    pub iterations: u32,
    /// Of its conditions, if there are any.
    pub worst: Option<Worst>,
}

/// Solves problems of one shape, one after the other.
#[derive(Default)]
pub struct Sequential {
    /// How.
    pub options: Options,
    programs: Programs,
}

/// The least part of a correction that is tried.
const LEAST_PART: f64 = 1.0 / 1024.0;

/// The part of a correction below which the next ones are damped more.
const SMALL_PART: f64 = 0.3;

/// By what part of itself a cost may grow by rounding.
const ROUNDING: f64 = 1e-12;

impl Sequential {
    /// With these options.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Sequential { options, programs: Programs::default() }
    }

    /// One program about a plan, whose correction is taken whole; the number of iterations of its solver.
    ///
    /// # Errors
    /// [`Failure::NotFinite`], [`Failure::NotConverged`] of a quadratic program; the plan is unchanged then.
    pub fn iterate<const X: usize, const U: usize>(
        &mut self,
        problem: &impl OptimalControl<X, U>,
        plan: &mut Plan<X, U>,
    ) -> Result<u32, Error> {
        let Options { damping, broken, accuracy, .. } = self.options;
        let about = Linearized::about(problem, plan)?;
        let correction = self.programs.solve(&about, damping, broken, accuracy)?;
        *plan = corrected(plan, &correction, 1.0);
        Ok(correction.iterations)
    }

    /// The optimum that is reached from a plan.
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Infeasible`] where the least that is broken is not nothing.
    pub fn solve<const X: usize, const U: usize>(
        &mut self,
        problem: &impl OptimalControl<X, U>,
        guess: Plan<X, U>,
    ) -> Result<Optimum<X, U>, Error> {
        let found = self.improve(problem, guess, self.options.most_programs)?;
        let residual = found.residual.greatest();
        if let Some(Worst { condition, node, excess }) = found.worst
            && excess > self.options.feasibility
            && residual < self.options.infeasibility
        {
            return Err(Failure::Infeasible { limit: condition, excess }.at_time(found.plan.time(node)));
        }
        if residual > self.options.tolerance {
            let iterations = found.programs;
            return Err(
                Failure::NotConverged { what: "the plan", iterations, residual, unit: "in scaled variables" }.into()
            );
        }
        Ok(found)
    }

    /// What this many programs make of a plan at most, optimal or not.
    ///
    /// # Errors
    /// [`Failure::NotFinite`]; [`Failure::NotConverged`] of a quadratic program.
    pub fn improve<const X: usize, const U: usize>(
        &mut self,
        problem: &impl OptimalControl<X, U>,
        guess: Plan<X, U>,
        most_programs: usize,
    ) -> Result<Optimum<X, U>, Error> {
        let Options { broken, accuracy, tolerance, .. } = self.options;
        let (mut damping, mut jump) = (self.options.damping, 0.0_f64);
        let mut about = Linearized::about(problem, &guess)?;
        let mut found =
            Optimum { plan: guess, residual: Residual::UNKNOWN, programs: 0, iterations: 0, worst: about.worst() };
        while found.programs < most_programs && found.residual.greatest() > tolerance {
            let correction = self.programs.solve(&about, damping, broken, accuracy)?;
            let equations = &correction.multipliers[..found.plan.states.len() * X];
            jump = equations.iter().fold(jump, |a, b| a.max(1.5 * b.abs()));
            let most = about.merit(jump, broken);
            let most = most + ROUNDING * most.abs();
            let mut part = 1.0;
            (found.plan, about) = loop {
                let next = corrected(&found.plan, &correction, part);
                match Linearized::about(problem, &next) {
                    Ok(tried) if part <= LEAST_PART || tried.merit(jump, broken) <= most => break (next, tried),
                    Err(error) if part <= LEAST_PART => return Err(error),
                    _ => part *= 0.5,
                }
            };
            damping *= if part == 1.0 { 0.5 } else { 1.0 };
            damping *= if part < SMALL_PART { 2.0 } else { 1.0 };
            found.residual = self.programs.residual(&about, broken, &correction.multipliers, &correction.relaxed);
            found.programs += 1;
            found.iterations += correction.iterations;
            found.worst = about.worst();
        }
        Ok(found)
    }
}

fn corrected<const X: usize, const U: usize>(
    plan: &Plan<X, U>,
    correction: &Correction<X, U>,
    part: f64,
) -> Plan<X, U> {
    let moved = |a: &Vec<_>, b: &Vec<_>| a.iter().zip(b).map(|(a, b)| a + b * part).collect();
    Plan {
        start: plan.start,
        duration: plan.duration + part * correction.duration,
        states: moved(&plan.states, &correction.states),
        inputs: plan.inputs.iter().zip(&correction.inputs).map(|(a, b)| a + b * part).collect(),
    }
}
