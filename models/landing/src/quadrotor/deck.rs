//! What is landed on, as it moves: a level deck that heaves, and one that moves in all six degrees of freedom.
//!
//! A [`Deck`] is a function of time: [`HeavingDeck`] is that of the thesis, [`MovingDeck`] that of a platform which
//! moves as
//! [`PlatformMotion`] says, for example [`Superposition::MARINE`](mbs_platform::Superposition::MARINE), a deck at sea.
//!
//! ```
//! use mbs_platform::{HOME, Superposition};
//! use mbs_landing::quadrotor::deck::MovingDeck;
//! use mbs_landing::quadrotor::landing::{Landing, Plant};
//!
//! // A landing field beside the middle of the platform, whose mean height is that of the world's origin.
//! let deck = MovingDeck { motion: Superposition::MARINE, base: [12.0, 7.0, -HOME[2]], point: [0.4, -0.3, 0.3] };
//! let end = Landing::on(Plant::Exact, deck).simulate(Landing::initial_state(), |_, _, _| ()).unwrap();
//! let [roll, pitch, yaw] = end.relative.attitude.map(f64::to_degrees);
//! assert!(end.horizontal_offset < 0.01 && (end.relative_velocity + 0.2).abs() < 0.01);
//! // The vehicle stands upright on the deck, which rolls and pitches, and has its yaw.
//! assert!(roll > 5.0 && pitch > 1.0 && yaw.abs() < 0.5);
//! ```

use mbs_runtime::{Scalar, to_matrix, to_rows};
use nalgebra::Vector3;

use super::backstepping::Reference;
use super::heave::Heave;
use mbs_platform::geometry::attitude;
use mbs_platform::jacobian::angular_rates;
use mbs_platform::{Coordinates, PlatformMotion};

/// A deck, as a function of time.
pub trait Deck {
    /// Where it is at a time \[s\], and how it moves.
    fn at(&self, t: f64) -> DeckState;
}

/// A deck at a moment: its axes are those of the frame at the point that is to be landed on, the third one its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckState {
    /// The point that is to be landed on \[m\].
    pub position: [f64; 3],
    /// Its velocity \[m/s\].
    pub velocity: [f64; 3],
    /// Its acceleration \[m/s²\].
    pub acceleration: [f64; 3],
    /// The deck's axes, in columns.
    pub rotation: [[f64; 3]; 3],
    /// Angular velocity, in world axes \[rad/s\].
    pub angular_velocity: [f64; 3],
    /// Yaw of the deck \[rad\].
    pub heading: Reference,
}

/// A vehicle as it is seen from a deck that moves, in the deck's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative {
    /// From the point that is to be landed on to the vehicle \[m\]; the third component is the height over the deck.
    pub offset: [f64; 3],
    /// Rate of the offset \[m/s\].
    pub velocity: [f64; 3],
    /// Roll, pitch and yaw φ, θ, ψ of the vehicle against the deck \[rad\].
    pub attitude: [f64; 3],
}

impl DeckState {
    /// The deck of a platform whose frame has these coordinates, rates and accelerations, `R = Rz(ψ) Ry(θ) Rx(φ)`, with
    /// the point r in the axes of the platform \[m\] as the one that is to be landed on.
    ///
    /// ```text
    /// ω = T (φ̇, θ̇, ψ̇)                        v = ṗ + ω × R r
    /// α = T (φ̈, θ̈, ψ̈) + Ṫ (φ̇, θ̇, ψ̇)        a = p̈ + α × R r + ω × (ω × R r)
    /// ```
    #[must_use]
    pub fn of_platform([q, qd, qdd]: &[Coordinates; 3], point: &[f64; 3]) -> Self {
        let rotation = attitude(q);
        let (rates, rates_dot) = (to_matrix(&angular_rates(q)), to_matrix(&angular_rates_dot(q, qd)));
        let [linear, angular] = [0, 3].map(|i| move |x: &Coordinates| Vector3::new(x[i], x[i + 1], x[i + 2]));
        let lever = to_matrix(&rotation) * Vector3::from(*point);
        let angular_velocity = rates * angular(qd);
        let angular_acceleration = rates * angular(qdd) + rates_dot * angular(qd);
        let around = angular_velocity.cross(&lever);
        let turning = angular_acceleration.cross(&lever) + angular_velocity.cross(&around);
        DeckState {
            position: (linear(q) + lever).into(),
            velocity: (linear(qd) + around).into(),
            acceleration: (linear(qdd) + turning).into(),
            rotation,
            angular_velocity: angular_velocity.into(),
            heading: Reference { value: q[5], rate: qd[5], acceleration: qdd[5] },
        }
    }

    /// A level deck at a place \[m\] with this height, its rate and its acceleration.
    #[must_use]
    pub fn level([x, y]: [f64; 2], height: Reference) -> Self {
        DeckState {
            position: [x, y, height.value],
            velocity: [0.0, 0.0, height.rate],
            acceleration: [0.0, 0.0, height.acceleration],
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            angular_velocity: [0.0; 3],
            heading: Reference::default(),
        }
    }

    /// How far a place is over the plane of the deck, along its normal \[m\].
    #[must_use]
    pub fn height(&self, place: &[f64; 3]) -> f64 {
        to_matrix(&self.rotation).tr_mul(&(Vector3::from(*place) - Vector3::from(self.position))).z
    }

    /// The vehicle with these coordinates `(x, y, z, φ, θ, ψ)` and rates, as the deck sees it.
    ///
    /// The velocity is `Rᵀ (ẋ − v − ω × d)`, that of the vehicle against the point of the deck below it, d being its
    /// offset.
    #[must_use]
    pub fn relative(&self, q: &Coordinates, qd: &Coordinates) -> Relative {
        let rotation = to_matrix(&self.rotation);
        let offset = Vector3::new(q[0], q[1], q[2]) - Vector3::from(self.position);
        let velocity = Vector3::new(qd[0], qd[1], qd[2]) - Vector3::from(self.velocity);
        let velocity = velocity - Vector3::from(self.angular_velocity).cross(&offset);
        Relative {
            offset: rotation.tr_mul(&offset).into(),
            velocity: rotation.tr_mul(&velocity).into(),
            attitude: angles_of(&to_rows(&rotation.tr_mul(&to_matrix(&attitude(q))))),
        }
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let Reference { value, rate, acceleration } = self.heading;
        [self.position, self.velocity, self.acceleration, self.angular_velocity, [value, rate, acceleration]]
            .iter()
            .chain(&self.rotation)
            .all(|numbers| numbers.iter().all(|x| x.is_finite()))
    }
}

/// Roll, pitch and yaw of a rotation `Rz(ψ) Ry(θ) Rx(φ)`, between −π and π, the pitch between −π/2 and π/2 \[rad\].
pub(super) fn angles_of([[xx, _, _], [xy, _, _], [xz, yz, zz]]: &[[f64; 3]; 3]) -> [f64; 3] {
    let across = Scalar::sqrt(*xx * *xx + *xy * *xy);
    [Scalar::atan2(*yz, *zz), Scalar::atan2(-*xz, across), Scalar::atan2(*xy, *xx)]
}

/// A level deck that heaves and does nothing else, as in the thesis: up to rounding [`MovingDeck`] with
/// [`Heave::about`], without the turns that are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavingDeck<const K: usize> {
    /// Its elevation.
    pub heave: Heave<K>,
    /// Where the middle of it is \[m\].
    pub place: [f64; 2],
}

impl<const K: usize> Deck for HeavingDeck<K> {
    fn at(&self, t: f64) -> DeckState {
        DeckState::level(self.place, self.heave.at(t))
    }
}

/// A level deck that heaves by `A sin(ωt + φ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swell {
    /// Where the middle of it is \[m\].
    pub place: [f64; 2],
    /// A \[m\]
    pub amplitude: f64,
    /// ω \[rad/s\]
    pub frequency: f64,
    /// φ \[rad\]
    pub phase: f64,
}

impl Deck for Swell {
    fn at(&self, t: f64) -> DeckState {
        let Swell { place, amplitude: a, frequency: w, phase } = *self;
        let (sin, cos) = Scalar::sin_cos(w * t + phase);
        DeckState::level(place, Reference { value: a * sin, rate: a * w * cos, acceleration: -a * w * w * sin })
    }
}

/// The deck of a platform that moves in six degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingDeck<M> {
    /// The motion of the platform's frame over its base.
    pub motion: M,
    /// Where the base stands \[m\]; its axes are those of the world.
    pub base: [f64; 3],
    /// The point that is to be landed on, in the axes of the platform \[m\].
    pub point: [f64; 3],
}

impl<M> MovingDeck<M> {
    /// The deck of a platform whose frame has these coordinates over its base, rates and accelerations.
    #[must_use]
    pub fn over_base(&self, [q, qd, qdd]: &[Coordinates; 3]) -> DeckState {
        let [x, y, z, phi, theta, psi] = *q;
        let [x_base, y_base, z_base] = self.base;
        DeckState::of_platform(&[[x_base + x, y_base + y, z_base + z, phi, theta, psi], *qd, *qdd], &self.point)
    }
}

impl<M: PlatformMotion> Deck for MovingDeck<M> {
    fn at(&self, t: f64) -> DeckState {
        self.over_base(&self.motion.at(t))
    }
}

/// Ṫ of [`angular_rates`], along a motion.
fn angular_rates_dot(q: &Coordinates, qd: &Coordinates) -> [[f64; 3]; 3] {
    let ((s2, c2), (s3, c3)) = (Scalar::sin_cos(q[4]), Scalar::sin_cos(q[5]));
    let (pitch, yaw) = (qd[4], qd[5]);
    [
        [-s3 * c2 * yaw - c3 * s2 * pitch, -c3 * yaw, 0.0],
        [c3 * c2 * yaw - s3 * s2 * pitch, -s3 * yaw, 0.0],
        [-c2 * pitch, 0.0, 0.0],
    ]
}
