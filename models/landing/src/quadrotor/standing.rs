//! From the touchdown on: rebound, sliding, tip-over or rest on a deck that moves.
//!
//! The vehicle is that of [`quadrotor_quaternion`](mbs_models::quadrotor_quaternion), whose attitude has no
//! singularity; the forces of its [`Gear`] join its equations by the generated Jacobian of its pose,
//!
//! ```text
//! M q̈ + C q̇ + G = Q + Jᵀ (F; M_F) + Aᵀ λ,   A q̈ + γ = 0
//! ```
//!
//! Its rotors run down from the first touch on. The deck moves as a function of time, [`Planned`], or is that of the
//! Stewart platform under its control, [`Carried`], which feels what the feet do to it: [`Stand`]. The deck is a plane
//! without an edge.
//!
//! Work is integrated along with the motion, so that the balance of energy can be seen: [`Moment::balance`].

mod carrier;
mod ending;
#[cfg(feature = "std")]
mod on_platform;

use core::cell::Cell;
use core::ops::ControlFlow;

use mbs_models::Error;
use mbs_models::check::{Invalid, finite, not_negative, positive, within};
use mbs_models::quadrotor_quaternion::QuadrotorQuaternion;
use mbs_runtime::{Dopri5, Event, IntegrationError, Integrator, Scalar, State, Step, constrained_solve, to_matrix};
use nalgebra::Vector3;

use super::deck::DeckState;
use super::gear::{Contact, Gear, RigidMotion};
use super::landing::{HEIGHT, finite_deck, upright};
pub use carrier::{Carried, Carrier, Load, Planned};
use ending::Watch;
pub use ending::{Ending, Settled, Still};
#[cfg(feature = "std")]
pub use on_platform::{Legs, Stand};

/// A vehicle that comes to stand.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The vehicle.
    pub vehicle: QuadrotorQuaternion<f64>,
    /// Its legs.
    pub gear: Gear,
    /// Velocity of the air \[m/s\].
    pub wind: [f64; 3],
    /// How long the rotors take from the first touch until they stand, with speeds that fall linearly \[s\].
    pub run_down: f64,
    /// What counts as rest.
    pub still: Still,
    /// Tilt against the deck at which it has tipped over \[rad\].
    pub tipped: f64,
    /// How long it is followed \[s\].
    pub duration: f64,
    /// The integrator.
    pub integrator: Dopri5,
}

impl Standing {
    /// The declared vehicle on this gear in calm air; limits are assumed.
    #[must_use]
    pub fn new(gear: Gear) -> Self {
        let mut integrator = Dopri5::new(1e-12, 1e-12);
        // Not longer than what is between two samples, for the sake of its dense output.
        integrator.max_step = SAMPLING;
        Standing {
            vehicle: QuadrotorQuaternion::default(),
            gear,
            wind: [0.0; 3],
            run_down: 0.3,
            still: Still::default(),
            tipped: 75.0_f64.to_radians(),
            duration: 10.0,
            integrator,
        }
    }
}

/// Where everything is at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The time \[s\].
    pub time: f64,
    /// Position and unit quaternion.
    pub vehicle: State<[f64; 7]>,
    /// A carried deck's platform over its base; a planned deck has no use for it.
    pub platform: State<[f64; 6]>,
    /// At that time \[rad/s\].
    pub rotor_speed: [f64; 4],
}

impl Start {
    /// With rotors that stand, on a deck that is planned.
    #[must_use]
    pub fn at_rest(time: f64, vehicle: State<[f64; 7]>) -> Self {
        Start { time, vehicle, platform: State::new([0.0; 6], [0.0; 6]), rotor_speed: [0.0; 4] }
    }
}

/// What is the case at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time \[s\].
    pub time: f64,
    /// The vehicle.
    pub vehicle: State<[f64; 7]>,
    /// The platform of a carried deck.
    pub platform: State<[f64; 6]>,
    /// The deck.
    pub deck: DeckState,
    /// Between both.
    pub contact: Contact,
    /// Kinetic and potential energy of the vehicle and of what carries the deck \[J\].
    pub energy: f64,
    /// Dissipated by legs and friction since the beginning \[J\].
    pub dissipated: f64,
    /// Done since then by rotors, air, and whatever moves the deck \[J\].
    pub work: f64,
    /// Way of each foot along the deck since then \[m\].
    pub slid: [f64; 4],
}

impl Moment {
    /// `T + V + stored + dissipated − work` \[J\], which is constant.
    #[must_use]
    pub fn balance(&self) -> f64 {
        self.energy + self.contact.stored + self.dissipated - self.work
    }
}

/// Position and unit quaternion of a state with the angles of `R = Rz(ψ) Ry(θ) Rx(φ)`.
#[must_use]
pub fn with_quaternion(State { q, qd }: &State<[f64; 6]>) -> State<[f64; 7]> {
    let [(s1, c1), (s2, c2), (s3, c3)] = [q[3], q[4], q[5]].map(|angle| Scalar::sin_cos(0.5 * angle));
    let e = [
        c1 * c2 * c3 + s1 * s2 * s3,
        s1 * c2 * c3 - c1 * s2 * s3,
        c1 * s2 * c3 + s1 * c2 * s3,
        c1 * c2 * s3 - s1 * s2 * c3,
    ];
    // ω in the axes of the body, then ė = ½ e ∘ (0, ω).
    let ((sr, cr), (sp, cp)) = (Scalar::sin_cos(q[3]), Scalar::sin_cos(q[4]));
    let x = qd[3] - sp * qd[5];
    let y = cr * qd[4] + sr * cp * qd[5];
    let z = cr * cp * qd[5] - sr * qd[4];
    let rate = [
        -e[1] * x - e[2] * y - e[3] * z,
        e[0] * x + e[2] * z - e[3] * y,
        e[0] * y + e[3] * x - e[1] * z,
        e[0] * z + e[1] * y - e[2] * x,
    ]
    .map(|rate| 0.5 * rate);
    State::new([q[0], q[1], q[2], e[0], e[1], e[2], e[3]], [qd[0], qd[1], qd[2], rate[0], rate[1], rate[2], rate[3]])
}

/// Vehicle, platform, and what is summed up: dissipated energy, work, ways of four feet. Sums are velocities.
const SIZE: usize = 7 + 6 + 6;
type All = State<[f64; SIZE]>;

fn parted(all: &All) -> (State<[f64; 7]>, State<[f64; 6]>) {
    let vehicle = |x: &[f64; SIZE]| core::array::from_fn(|i| x[i]);
    let platform = |x: &[f64; SIZE]| core::array::from_fn(|i| x[7 + i]);
    (State::new(vehicle(&all.q), vehicle(&all.qd)), State::new(platform(&all.q), platform(&all.qd)))
}

/// How often the way is shown \[s\].
pub const SAMPLING: f64 = 0.001;

impl Standing {
    /// Follows the vehicle until it is at rest, tips over, or the time is over. `observer` sees every millisecond and
    /// the end.
    ///
    /// # Errors
    /// [`Error`]: `Invalid`, also where the mass centre is not over the deck or the deck is not upright; `NotFinite`
    /// where the deck is NaN or infinite; those of the carrier; `Integration`.
    pub fn simulate<C: Carrier>(
        &self,
        carrier: &C,
        start: &Start,
        mut observer: impl FnMut(&Moment),
    ) -> Result<Settled, Error> {
        self.check(start)?;
        let deck = upright(finite_deck(carrier.deck(start.time, &start.platform), start.time)?, start.time)?;
        let [x, y, z, ..] = start.vehicle.q;
        let height = deck.height(&[x, y, z]);
        positive(HEIGHT, height)?;
        let joined = |v: &[f64; 7], p: &[f64; 6]| {
            core::array::from_fn(|i| if i < 7 { v[i] } else { p.get(i - 7).copied().unwrap_or(0.0) })
        };
        let (vehicle, platform) = (&start.vehicle, &start.platform);
        let mut all: All = State::new(joined(&vehicle.q, &platform.q), joined(&vehicle.qd, &platform.qd));

        // The right-hand side answers with NaN where it has none, and keeps why.
        let lost = Cell::new(None);
        let touched = Cell::new(None);
        let derivative = |t: f64, q: &[f64; SIZE], qd: &[f64; SIZE], qdd: &mut [f64; SIZE]| match self.derivative(
            carrier,
            start,
            touched.get(),
            t,
            &State::new(*q, *qd),
        ) {
            Ok(found) => *qdd = found,
            Err(error) => {
                lost.set(Some(error));
                *qdd = [f64::NAN; SIZE];
            }
        };
        let moment = |t: f64, all: &All| self.moment(carrier, t, all);
        let deepest = |t: f64, all: &All| moment(t, all).contact.deepest();
        let over = |t: f64, all: &All| ending::tilt(&moment(t, all), &self.vehicle) - self.tipped;
        let mut watch = Watch::new(start.time);
        let (mut touches, mut rebounds) = (0_usize, 0_usize);
        if deepest(start.time, &all) >= 0.0 {
            touched.set(Some(start.time));
            touches = 1;
        }
        let mut touch = |t: f64, _: &mut All| {
            touches += 1;
            if touched.get().is_none() {
                touched.set(Some(t));
            }
            mbs_runtime::Response::Restart
        };
        let mut leave = |_: f64, _: &mut All| {
            rebounds += 1;
            mbs_runtime::Response::Restart
        };
        let mut events = [
            Event::new(&deepest).rising().with_action(&mut touch),
            Event::new(&deepest).falling().with_action(&mut leave),
            Event::new(&over).rising().terminal(),
        ];
        let mut sample = all;
        let mut next = 0_u64;
        let failed = Cell::new(None);
        let look = |step: &mut dyn Step<[f64; SIZE]>| {
            while start.time + next as f64 * SAMPLING <= step.time() {
                let t = start.time + next as f64 * SAMPLING;
                if let Err(error) = step.interpolate(t, &mut sample) {
                    failed.set(Some(Error::from(error)));
                    return ControlFlow::Break(step.time());
                }
                let now = moment(t, &sample);
                observer(&now);
                next += 1;
                let running = touched.get().is_none_or(|touched| t < touched + self.run_down);
                if watch.see(&now, &self.vehicle, &self.still, running) {
                    return ControlFlow::Break(t);
                }
            }
            ControlFlow::Continue(())
        };
        let end = start.time + self.duration;
        let done = self.integrator.integrate_with_events(derivative, start.time, end, &mut all, &mut events, look);
        if let Some(error) = failed.get() {
            return Err(error);
        }
        let summary = match (done, lost.get()) {
            (Ok(summary), _) => summary,
            (Err(IntegrationError::NonFiniteState { .. } | IntegrationError::NonFiniteEvent { .. }), Some(error)) => {
                return Err(error);
            }
            (Err(error), _) => return Err(error.into()),
        };
        let tipped = events[2].count() > 0;
        let last = moment(summary.time, &all);
        finite_deck(last.deck, summary.time)?;
        Ok(watch.settled(&last, &self.vehicle, &self.gear, touched.get(), [touches, rebounds], tipped))
    }

    fn check(&self, start: &Start) -> Result<(), Invalid> {
        self.gear.check()?;
        finite("wind", self.wind)?;
        not_negative("run_down", self.run_down)?;
        positive("still.speed", self.still.speed)?;
        positive("still.rate", self.still.rate)?;
        positive("still.duration", self.still.duration)?;
        within("tipped", self.tipped, [0.0, core::f64::consts::PI])?;
        positive("duration", self.duration)?;
        finite("start.time", start.time)?;
        finite("start.vehicle.q", start.vehicle.q)?;
        finite("start.vehicle.qd", start.vehicle.qd)?;
        finite("start.platform.q", start.platform.q)?;
        finite("start.platform.qd", start.platform.qd)?;
        not_negative("start.rotor_speed", start.rotor_speed)?;
        let [.., a, b, c, d] = start.vehicle.q;
        let square = a * a + b * b + c * c + d * d;
        within("start.vehicle quaternion's square", square, [1.0 - 1e-6, 1.0 + 1e-6])
    }

    fn moment<C: Carrier>(&self, carrier: &C, t: f64, all: &All) -> Moment {
        let (vehicle, platform) = parted(all);
        let deck = carrier.deck(t, &platform);
        let contact = self.gear.contact(&twist(&self.vehicle, &vehicle), &deck);
        let still = [[0.0; 3]; 3];
        let own = self.vehicle.kinetic_energy(&still, &vehicle.q, &vehicle.qd)
            + self.vehicle.potential_energy(&still, &vehicle.q);
        let [.., dissipated, work, a, b, c, d] = all.qd;
        let energy = own + carrier.energy(&platform);
        Moment { time: t, vehicle, platform, deck, contact, energy, dissipated, work, slid: [a, b, c, d] }
    }

    fn derivative<C: Carrier>(
        &self,
        carrier: &C,
        start: &Start,
        touched: Option<f64>,
        t: f64,
        all: &All,
    ) -> Result<[f64; SIZE], Error> {
        let (State { q, qd }, platform) = parted(all);
        let deck = finite_deck(carrier.deck(t, &platform), t)?;
        let twist = twist(&self.vehicle, &State::new(q, qd));
        let contact = self.gear.contact(&twist, &deck);

        let left = match touched {
            None => 1.0,
            Some(touched) if t < touched + self.run_down => 1.0 - (t - touched) / self.run_down,
            Some(_) => 0.0,
        };
        let speeds = start.rotor_speed.map(|speed| left * speed);
        let air = self.wind.map(|wind| [wind, 0.0, 0.0]);
        let vehicle = &self.vehicle;
        let driven = vehicle.generalized_force(&air, &q, &qd, &speeds);
        let bias = vehicle.bias(&air, &q, &qd);
        let (force, moment) = (contact.force, contact.moment);
        let wrench = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        let jacobian = vehicle.pose_jacobian(&air, &q);
        let pushed = |i: usize| (0..6).map(|k| jacobian[k][i] * wrench[k]).sum::<f64>();
        let right = core::array::from_fn(|i| driven[i] + pushed(i) - bias[i]);
        let rows = vehicle.constraint_jacobian(&air, &q);
        let target = vehicle.constraint_bias(&air, &q, &qd).map(|bias| -bias);
        let (own, _) = constrained_solve(vehicle.mass_matrix(&air, &q), rows, right, target);

        let load = Load { force: -contact.force, moment: contact.deck_moment };
        let (carried, power) = carrier.carry(t, &platform, &deck, &load).map_err(|error| error.or_at_time(t))?;
        let power = power + driven.iter().zip(&qd).map(|(force, rate)| force * rate).sum::<f64>();
        let mut found = [0.0; SIZE];
        found[..7].copy_from_slice(&own);
        found[7..13].copy_from_slice(&carried);
        found[13..15].copy_from_slice(&[contact.dissipated, power]);
        found[15..].copy_from_slice(&contact.slip);
        Ok(found)
    }
}

/// Of a vehicle, in world axes.
#[must_use]
pub fn twist(vehicle: &QuadrotorQuaternion<f64>, state: &State<[f64; 7]>) -> RigidMotion {
    let still = [[0.0; 3]; 3];
    let rotation = to_matrix(&vehicle.pose(&still, &state.q).rotation);
    let [.., x, y, z] = vehicle.pose_velocity(&still, &state.q, &state.qd);
    RigidMotion {
        position: Vector3::new(state.q[0], state.q[1], state.q[2]),
        rotation,
        velocity: Vector3::new(state.qd[0], state.qd[1], state.qd[2]),
        angular_velocity: Vector3::new(x, y, z),
    }
}
