//! What the thrusters can do: four vertical ones in the pontoons and two lateral ones, each within a thrust and a rate.

use mbs_models::check::{Invalid, positive};

/// `(lift, lateral)`, as the mechanism has them \[N\].
pub type Thrust = [f64; 6];

/// Limits of the thrusters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thrusters {
    /// The greatest thrusts, in both directions \[N\].
    pub thrust: Thrust,
    /// How fast they change at most \[N/s\].
    pub rate: Thrust,
}

impl Default for Thrusters {
    /// Vertical ones of 40 kN, lateral ones of 20 kN, full thrust in two seconds.
    fn default() -> Self {
        let thrust = [40e3, 40e3, 40e3, 40e3, 20e3, 20e3];
        Self { thrust, rate: thrust.map(|thrust| 0.5 * thrust) }
    }
}

impl Thrusters {
    /// Whether there are such thrusters.
    ///
    /// # Errors
    /// [`Invalid`] where a limit is not positive and finite.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("thrust", self.thrust)?;
        positive("rate of thrust", self.rate)
    }

    /// The thrusts that come nearest to those asked for, a time after others \[s\].
    #[must_use]
    pub fn follow(&self, before: &Thrust, asked: &Thrust, time: f64) -> Thrust {
        core::array::from_fn(|i| {
            let (limit, change) = (self.thrust[i], self.rate[i] * time);
            asked[i].clamp(-limit, limit).clamp(before[i] - change, before[i] + change)
        })
    }
}
