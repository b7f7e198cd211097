//! A step of the quadrotor with rotor speeds that are held, and its exact derivatives.
//!
//! The step is one of the classical Runge–Kutta method, or several in a row. Each of its stages `kᵢ = f(x + cᵢ h kᵢ₋₁,
//! u)` is differentiated: with `∂f/∂x`, `∂f/∂u` generated, for the direction of every state, input and the length,
//!
//! ```text
//! kᵢ′ = ∂f/∂x (x′ + cᵢ h kᵢ₋₁′ + cᵢ h′ kᵢ₋₁) + ∂f/∂u u′
//! ```
//!
//! which is the derivative of what is computed, not of what it approximates.
//!
//! # Source
//! E. Hairer, S. P. Nørsett and G. Wanner, *Solving ordinary differential equations I*, 1993, section II.6 (internal
//! differentiation after Bock).

use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::{Scalar, to_matrix};
use nalgebra::{SMatrix, SVector};

use super::problem::Step;

/// Coordinates and velocities.
pub const STATES: usize = 12;
/// Rotors.
pub const ROTORS: usize = 4;
/// States, inputs, the length of the step.
const DIRECTIONS: usize = STATES + ROTORS + 1;
/// The direction of the length.
const LENGTH: usize = STATES + ROTORS;

/// `(q, q̇)`.
pub type StateVector = SVector<f64, STATES>;
/// Rotor speeds in units of the one at which the vehicle hovers.
pub type InputVector = SVector<f64, ROTORS>;
/// Derivatives of coordinates, or of their rates, in every direction.
type Tangent = SMatrix<f64, 6, DIRECTIONS>;

/// The vehicle as a plan knows it, in calm air.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// Its parameters.
    pub vehicle: QuadrotorEuler<f64>,
    /// A specific force that is taken as constant, what the vehicle has felt beside its model \[m/s²\].
    pub disturbance: [f64; 3],
    /// How many steps of the method an interval has, one at least.
    pub steps: usize,
}

/// The mean of a stage's, `(k₁ + 2 k₂ + 2 k₃ + k₄)/6`, and where the stage is.
const STAGES: [(f64, f64); 4] = [(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

impl Prediction {
    /// Of these parameters, without a disturbance, one step an interval.
    #[must_use]
    pub fn new(params: Params<f64>) -> Self {
        Prediction { vehicle: QuadrotorEuler::new(params), disturbance: [0.0; 3], steps: 1 }
    }

    /// `√(m g / 4 b)` \[rad/s\], the unit of inputs.
    #[must_use]
    pub fn hover_speed(&self) -> f64 {
        let Params { m, g, thrust_factor, .. } = *self.vehicle.params();
        Scalar::sqrt(m * g / (4.0 * thrust_factor))
    }

    /// The state after a length of time \[s\], and its derivatives.
    #[must_use]
    pub fn step(&self, x: &StateVector, u: &InputVector, length: f64) -> Step<STATES, ROTORS> {
        let parts = self.steps.max(1) as f64;
        let h = length / parts;
        let unit = self.hover_speed();
        let speeds: [f64; ROTORS] = core::array::from_fn(|i| unit * u[i]);
        let (mut q, mut qd): (SVector<f64, 6>, SVector<f64, 6>) =
            (x.fixed_rows::<6>(0).into(), x.fixed_rows::<6>(6).into());
        let mut by = [Tangent::zeros(), Tangent::zeros()];
        for i in 0..6 {
            by[0][(i, i)] = 1.0;
            by[1][(i, 6 + i)] = 1.0;
        }
        for _ in 0..self.steps.max(1) {
            let (start, start_by) = ([q, qd], by);
            let mut rate = [SVector::<f64, 6>::zeros(); 2];
            let mut rate_by = [Tangent::zeros(); 2];
            for (place, weight) in STAGES {
                let at = [0, 1].map(|i| start[i] + place * h * rate[i]);
                let mut at_by = [0, 1].map(|i| start_by[i] + place * h * rate_by[i]);
                for i in 0..2 {
                    let by_length = rate[i] * (place / parts);
                    let mut column = at_by[i].column_mut(LENGTH);
                    column += by_length;
                }
                let (coordinates, rates) = (at[0].into(), at[1].into());
                let calm = [[0.0; 3]; 3];
                let mut acceleration =
                    SVector::from(self.vehicle.forward_dynamics(&calm, &coordinates, &rates, &speeds));
                for i in 0..3 {
                    acceleration[i] += self.disturbance[i];
                }
                let slopes = self.vehicle.linearize(&calm, &coordinates, &rates, &speeds);
                let mut acceleration_by = to_matrix(&slopes.q) * at_by[0] + to_matrix(&slopes.qd) * at_by[1];
                let mut inputs = acceleration_by.fixed_columns_mut::<ROTORS>(STATES);
                inputs += to_matrix(&slopes.u) * unit;
                rate = [at[1], acceleration];
                rate_by = [at_by[1], acceleration_by];
                q += weight * h * rate[0];
                qd += weight * h * rate[1];
                for i in 0..2 {
                    by[i] += weight * h * rate_by[i];
                    let mut column = by[i].column_mut(LENGTH);
                    column += rate[i] * (weight / parts);
                }
            }
        }
        let mut end = Step::<STATES, ROTORS>::still();
        for (i, (value, tangent)) in [(q, by[0]), (qd, by[1])].into_iter().enumerate() {
            end.end.fixed_rows_mut::<6>(6 * i).copy_from(&value);
            end.by_state.fixed_rows_mut::<6>(6 * i).copy_from(&tangent.fixed_columns::<STATES>(0));
            end.by_input.fixed_rows_mut::<6>(6 * i).copy_from(&tangent.fixed_columns::<ROTORS>(STATES));
            end.by_length.fixed_rows_mut::<6>(6 * i).copy_from(&tangent.column(LENGTH));
        }
        end
    }
}
