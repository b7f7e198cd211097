//! What carries a deck: a plan, which nothing disturbs, or the Stewart platform, which feels what stands on it.

use mbs_models::Error;
use mbs_platform::jacobian::angular_rates;
use mbs_platform::{LegVector, PlatformMotion};
use mbs_runtime::{State, to_matrix};
use nalgebra::Vector3;

use crate::quadrotor::deck::{Deck, DeckState, MovingDeck};
use crate::quadrotor::driven::Drive;

/// What feet do to a deck, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// The force \[N\].
    pub force: Vector3<f64>,
    /// About the point that is to be landed on \[N·m\].
    pub moment: Vector3<f64>,
}

/// What carries a deck, at a time \[s\] and with a state of its own, which it need not have.
pub trait Carrier {
    /// The deck; its acceleration does not count.
    fn deck(&self, t: f64, platform: &State<[f64; 6]>) -> DeckState;

    /// Accelerations of its coordinates under a load, and the power \[W\] of what drives it.
    ///
    /// # Errors
    /// [`Error`] where legs cannot hold it.
    fn carry(
        &self,
        t: f64,
        platform: &State<[f64; 6]>,
        deck: &DeckState,
        load: &Load,
    ) -> Result<([f64; 6], f64), Error>;

    /// Kinetic and potential energy \[J\], zero of a plan.
    fn energy(&self, platform: &State<[f64; 6]>) -> f64;
}

/// A deck that moves as it is to, whatever stands on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned<D>(pub D);

impl<D: Deck> Carrier for Planned<D> {
    fn deck(&self, t: f64, _: &State<[f64; 6]>) -> DeckState {
        self.0.at(t)
    }

    fn carry(&self, _: f64, _: &State<[f64; 6]>, deck: &DeckState, load: &Load) -> Result<([f64; 6], f64), Error> {
        let power =
            load.force.dot(&Vector3::from(deck.velocity)) + load.moment.dot(&Vector3::from(deck.angular_velocity));
        Ok(([0.0; 6], -power))
    }

    fn energy(&self, _: &State<[f64; 6]>) -> f64 {
        0.0
    }
}

/// The deck of the Stewart platform, which its legs drive along a motion by computed torque. Its controller acts in
/// continuous time, knows the platform without the vehicle, and its forces are cut to what the actuators give.
#[derive(Clone, Debug)]
pub struct Carried<M> {
    /// How it is to move.
    pub deck: MovingDeck<M>,
    /// Platform and controller.
    pub drive: Drive,
    /// Without: the legs give no force.
    pub controlled: bool,
}

impl<M: PlatformMotion> Carried<M> {
    /// Forces that the legs give \[N\].
    ///
    /// # Errors
    /// [`Error`].
    pub fn forces(&self, t: f64, platform: &State<[f64; 6]>) -> Result<LegVector, Error> {
        if !self.controlled {
            return Ok([0.0; 6]);
        }
        let Drive { platform: model, control } = &self.drive;
        let asked = model.computed_forces(control, &self.deck.motion.at(t), &platform.q, &platform.qd)?;
        Ok(model.limits.saturated(&asked))
    }
}

impl<M: PlatformMotion> Carrier for Carried<M> {
    fn deck(&self, _: f64, platform: &State<[f64; 6]>) -> DeckState {
        self.deck.over_base(&[platform.q, platform.qd, [0.0; 6]])
    }

    /// The load is the generalized force `(F, Tᵀ M_O)`, `M_O` about the origin of the platform's frame.
    fn carry(
        &self,
        t: f64,
        platform: &State<[f64; 6]>,
        deck: &DeckState,
        load: &Load,
    ) -> Result<([f64; 6], f64), Error> {
        let State { q, qd } = platform;
        let forces = self.forces(t, platform)?;
        let origin = Vector3::from(self.deck.base) + Vector3::new(q[0], q[1], q[2]);
        let moment = load.moment + (Vector3::from(deck.position) - origin).cross(&load.force);
        let turning = to_matrix(&angular_rates(q)).tr_mul(&moment);
        let generalized = [load.force.x, load.force.y, load.force.z, turning.x, turning.y, turning.z];
        let model = &self.drive.platform;
        let alike = model.legs_against(q, &generalized)?;
        let accelerations = model.accelerations(q, qd, &core::array::from_fn(|i| forces[i] + alike[i]))?;
        let rates = model.leg_rates(q, qd)?;
        Ok((accelerations, forces.iter().zip(rates).map(|(force, rate)| force * rate).sum()))
    }

    fn energy(&self, platform: &State<[f64; 6]>) -> f64 {
        let model = self.drive.platform.model();
        model.kinetic_energy(&platform.q, &platform.qd) + model.potential_energy(&platform.q)
    }
}
