//! Why there is no plan.

use mbs_models::check::Invalid;
use mbs_runtime::control::ControlError;

use crate::quadrotor::landing::LandingError;

/// Why there is no plan, or no landing by one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PredictiveError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// A derivative, a condition or a state of a plan is infinite or NaN.
    #[error("the plan is NaN or infinite at node {node}, t = {time} s")]
    NotFinite {
        /// Counted from 0.
        node: usize,
        /// Its time \[s\].
        time: f64,
    },
    /// No plan keeps this condition together with the others; it is the one that the best plan found breaks most.
    #[error("no plan keeps all limits: `{condition}` at node {node}, t = {time} s, is off by {excess}")]
    Infeasible {
        /// What cannot be kept.
        condition: &'static str,
        /// Where, counted from 0.
        node: usize,
        /// Its time \[s\].
        time: f64,
        /// By how much, in the condition's unit.
        excess: f64,
    },
    /// The iterations end before the conditions of optimality hold.
    #[error("not optimal after {iterations} quadratic programs: the residual is {residual}")]
    NotConverged {
        /// How many there were.
        iterations: usize,
        /// The greatest residual of the conditions of Karush, Kuhn and Tucker.
        residual: f64,
    },
    /// A quadratic program was not solved.
    #[error("a quadratic program was not solved in {iterations} iterations, its residuals are {primal} and {dual}")]
    Quadratic {
        /// The iterations of the interior-point method.
        iterations: u32,
        /// The residual of its equations.
        primal: f64,
        /// The residual of its stationarity.
        dual: f64,
    },
    /// No regulator gives the cost of what comes after the horizon.
    #[error("no regulator about hovering: {0}")]
    Regulator(ControlError),
    /// The flight ended otherwise.
    #[error(transparent)]
    Landing(#[from] LandingError),
}
