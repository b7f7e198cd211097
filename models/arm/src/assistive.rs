//! An arm that carries a person's forearm: springs that take its weight, and motors that make it easy to move.
//!
//! Springs of zero free length balance both links in every posture; what is left for the motors is inertia and
//! friction. They turn the arm into a small mass in a viscous medium, in the person's hand: admittance control.
//!
//! # Source
//! Springs: J. L. Herder, *Energy-Free Systems*, 2001, section 4.2; control: N. Hogan, *Impedance control: an approach
//! to manipulation*, Journal of Dynamic Systems, Measurement, and Control 107:1, 1985, part II.

use mbs_models::assistive_arm::{AssistiveArm, Params};
use mbs_models::check::{Invalid, positive};
use mbs_runtime::nalgebra::{Matrix3, Vector3};
use mbs_runtime::{to_matrix, to_vector};

/// Rates of both springs that balance the arm with its payload in every posture \[N/m\]: `k a b = g S`.
///
/// S is the first moment that a link carries about its hinge: its own and, of the first one, all that hangs at its end.
#[must_use]
pub fn balancing_rates(params: &Params<f64>) -> [f64; 2] {
    let Params { mass, centre, length, payload, post, arm, g, .. } = *params;
    let moments = [mass[0] * centre[0] + (mass[1] + payload) * length[0], mass[1] * centre[1] + payload * length[1]];
    core::array::from_fn(|i| g * moments[i] / (post[i] * arm[i]))
}

/// What the person's hand is to feel: `m v̇ + d v = F`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admittance {
    /// m \[kg\]
    pub mass: f64,
    /// d \[N·s/m\]
    pub damping: f64,
    /// At which rate motions die that do not move the hand \[1/s\].
    pub settling: f64,
}

/// A pivot of J Jᵀ that is a smaller part of the largest counts as none.
const SINGULAR: f64 = 1e-8;

impl Admittance {
    /// All three positive and finite.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("mass", self.mass)?;
        positive("damping", self.damping)?;
        positive("settling", self.settling)
    }

    /// Torques of the four motors \[N·m\], two that turn and two that lift, by `model`, under the person's force \[N\].
    ///
    /// The hand's acceleration `a = (F − d v)/m` is met by `q̈ = J⁺ (a − J̇ q̇) − σ (q̇ − J⁺ J q̇)` with `J⁺ = Jᵀ (J
    /// Jᵀ)⁻¹`, and `τ = M q̈ + h + ∂D/∂q̇ − Jᵀ F`. `None` where J loses rank, or nearly: with both links upright, or
    /// one above the other.
    #[must_use]
    pub fn torques(
        &self,
        model: &AssistiveArm<f64>,
        q: &[f64; 4],
        qd: &[f64; 4],
        force: &[f64; 3],
    ) -> Option<[f64; 4]> {
        let jacobian = to_matrix(&model.hand_place_jacobian(q));
        let drift = to_matrix(&model.hand_place_jacobian_rate(q, qd)) * to_vector(qd);
        let (rates, force) = (to_vector(qd), to_vector(force));
        let velocity: Vector3<f64> = jacobian * rates;
        let wanted = (force - velocity * self.damping) / self.mass - drift;
        let square: Matrix3<f64> = jacobian * jacobian.transpose();
        let factor = square.cholesky()?;
        let pivots = factor.l_dirty().diagonal();
        // Of squares: directions in which the hand moves less than by 1e-4 of the others.
        if pivots.min() <= SINGULAR * pivots.max() {
            return None;
        }
        let least = |x: Vector3<f64>| jacobian.transpose() * factor.solve(&x);
        let idle = rates - least(velocity);
        let acceleration: [f64; 4] = (least(wanted) - idle * self.settling).into();
        let own = to_vector(&model.inverse_dynamics(q, qd, &acceleration));
        Some((own - jacobian.transpose() * force).into())
    }
}
