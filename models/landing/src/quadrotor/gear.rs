//! Landing gear: four compliant legs with friction, and what a deck and they do to each other.
//!
//! A leg is a spring and a damper without mass between the vehicle and its foot. How deep the foot would be in the deck
//! were the leg rigid is what the leg gives way, δ; with `v` the foot's velocity against the point of the deck where it
//! is, n the deck's normal and `v_t = v − (v·n) n`,
//!
//! ```text
//! δ = −n · (r − p),   δ̇ = −n · v
//! N = max(0, k δᵖ (1 + λ δ̇))         Hunt and Crossley;         N = max(0, k δᵖ + c δ̇) of a viscous damper
//! F = N n − μ N v_t/√(v_t² + v_s²)
//! ```
//!
//! so that the deck never pulls. The second term of F is Coulomb's friction but for speeds of the order of the creep
//! speed v_s: a load that friction can hold, by a part s of what it could, creeps with `v_s s/√(1 − s²)`.
//!
//! The leg stores `k δᵖ⁺¹/(p + 1)`; of the power `F · v` all else is dissipated.
//!
//! # Source
//! K. H. Hunt and F. R. E. Crossley, *Coefficient of restitution interpreted as damping in vibroimpact*, Journal of
//! Applied Mechanics 42, 1975, 440–445.

use mbs_models::check::{Invalid, not_negative, positive, within};
use mbs_runtime::{Scalar, to_matrix};
use nalgebra::{Matrix3, Vector3};

use super::deck::DeckState;

/// How a leg loses energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping {
    /// λ of Hunt and Crossley \[s/m\]: the force begins at zero.
    HuntCrossley(f64),
    /// c of a linear damper \[N·s/m\]: the force begins with a jump.
    Viscous(f64),
}

/// Four equal legs at the corners of a square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Feet are at ±this along the body's x and y axes \[m\].
    pub half_track: f64,
    /// Of the mass centre over the feet \[m\].
    pub height: f64,
    /// k \[N/mᵖ\].
    pub stiffness: f64,
    /// p, at least 1.
    pub exponent: f64,
    /// The damping of a leg.
    pub damping: Damping,
    /// μ
    pub friction: f64,
    /// v_s \[m/s\].
    pub creep_speed: f64,
}

impl Default for Gear {
    /// Assumed: static deflection of 9.8 mm, and about half of critical damping of a vehicle of 40 kg.
    fn default() -> Self {
        Gear {
            half_track: 0.35,
            height: 0.4,
            stiffness: 1e4,
            exponent: 1.0,
            damping: Damping::HuntCrossley(3.0),
            friction: 0.6,
            creep_speed: 0.002,
        }
    }
}

/// Corners of the square.
const CORNERS: [[f64; 2]; 4] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];

/// Where a vehicle is, how it is turned, how it moves: in world axes, of its mass centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// The position \[m\].
    pub position: Vector3<f64>,
    /// From body axes to those of the world.
    pub rotation: Matrix3<f64>,
    /// The velocity \[m/s\].
    pub velocity: Vector3<f64>,
    /// The angular velocity \[rad/s\].
    pub angular_velocity: Vector3<f64>,
}

/// What a deck and four legs do to each other at a moment; the deck suffers the opposite at the same points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// δ of each leg, negative above the deck \[m\].
    pub depth: [f64; 4],
    /// N of each leg \[N\].
    pub normal: [f64; 4],
    /// Speed of each foot along the deck, of those that touch \[m/s\].
    pub slip: [f64; 4],
    /// On the vehicle, in world axes \[N\].
    pub force: Vector3<f64>,
    /// On the vehicle about its mass centre, in world axes \[N·m\].
    pub moment: Vector3<f64>,
    /// On the deck about the point that is to be landed on, in world axes \[N·m\].
    pub deck_moment: Vector3<f64>,
    /// In the legs \[J\].
    pub stored: f64,
    /// The power that is dissipated \[W\].
    pub dissipated: f64,
}

impl Contact {
    /// The deepest foot, negative above the deck \[m\].
    #[must_use]
    pub fn deepest(&self) -> f64 {
        self.depth.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Gear {
    /// Whether these can be legs.
    ///
    /// # Errors
    /// [`Invalid`], the first number that is not.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("gear.half_track", self.half_track)?;
        not_negative("gear.height", self.height)?;
        positive("gear.stiffness", self.stiffness)?;
        within("gear.exponent", self.exponent, [1.0, 10.0])?;
        match self.damping {
            Damping::HuntCrossley(damping) | Damping::Viscous(damping) => not_negative("gear.damping", damping)?,
        }
        not_negative("gear.friction", self.friction)?;
        positive("gear.creep_speed", self.creep_speed)
    }

    /// Where the feet are in the axes of the body \[m\].
    #[must_use]
    pub fn feet(&self) -> [[f64; 3]; 4] {
        CORNERS.map(|[x, y]| [self.half_track * x, self.half_track * y, -self.height])
    }

    /// The tilt beyond which a vehicle on a level deck falls over two of its feet: `atan(half track/height)` \[rad\].
    #[must_use]
    pub fn tipping_angle(&self) -> f64 {
        Scalar::atan(self.half_track / self.height)
    }

    /// How far each leg gives way under a quarter of this weight \[N\], at rest on a level deck \[m\].
    #[must_use]
    pub fn static_depth(&self, weight: f64) -> f64 {
        Scalar::powf(weight / (4.0 * self.stiffness), 1.0 / self.exponent)
    }

    /// Forces between the legs of a vehicle and a deck.
    #[must_use]
    pub fn contact(&self, vehicle: &RigidMotion, deck: &DeckState) -> Contact {
        let normal = to_matrix(&deck.rotation).column(2).into_owned();
        let (origin, deck_velocity) = (Vector3::from(deck.position), Vector3::from(deck.velocity));
        let deck_turning = Vector3::from(deck.angular_velocity);
        let mut contact = Contact::default();
        for (i, foot) in self.feet().into_iter().enumerate() {
            let lever = vehicle.rotation * Vector3::from(foot);
            let on_deck = vehicle.position + lever - origin;
            let depth = -normal.dot(&on_deck);
            contact.depth[i] = depth;
            // NaN goes on.
            if depth <= 0.0 {
                continue;
            }
            let own = vehicle.velocity + vehicle.angular_velocity.cross(&lever);
            let against = own - deck_velocity - deck_turning.cross(&on_deck);
            let sinking = -normal.dot(&against);
            let along = against + normal * sinking;
            let spring = self.stiffness * Scalar::powf(depth, self.exponent);
            let push = match self.damping {
                Damping::HuntCrossley(damping) => spring * (1.0 + damping * sinking),
                Damping::Viscous(damping) => spring + damping * sinking,
            };
            let push = if push < 0.0 { 0.0 } else { push };
            let slip = Scalar::sqrt(along.dot(&along));
            let grip = self.friction * push / Scalar::sqrt(slip * slip + self.creep_speed * self.creep_speed);
            let force = normal * push - along * grip;
            contact.normal[i] = push;
            contact.slip[i] = slip;
            contact.force += force;
            contact.moment += lever.cross(&force);
            contact.deck_moment -= on_deck.cross(&force);
            contact.stored += spring * depth / (self.exponent + 1.0);
            contact.dissipated += (push - spring) * sinking + grip * slip * slip;
        }
        contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_that_are_none_are_refused() {
        let good = Gear::default();
        assert_eq!(good.check(), Ok(()));
        let refused = [
            (Gear { half_track: 0.0, ..good }, "gear.half_track"),
            (Gear { height: f64::NAN, ..good }, "gear.height"),
            (Gear { stiffness: -1.0, ..good }, "gear.stiffness"),
            (Gear { exponent: 0.5, ..good }, "gear.exponent"),
            (Gear { damping: Damping::Viscous(-1.0), ..good }, "gear.damping"),
            (Gear { damping: Damping::HuntCrossley(f64::NAN), ..good }, "gear.damping"),
            (Gear { friction: f64::INFINITY, ..good }, "gear.friction"),
            (Gear { creep_speed: 0.0, ..good }, "gear.creep_speed"),
        ];
        for (gear, parameter) in refused {
            assert_eq!(gear.check().unwrap_err().parameter, parameter);
        }
    }
}
