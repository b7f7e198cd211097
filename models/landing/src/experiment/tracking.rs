//! The arm simulated under its controller, up to the contact with the platform.
//!
//! The controller knows the model and the plan; the arm is another one, heavier than the model says. Once a period it
//! takes positions and rates, and holds the forces that the model asks for until the next:
//!
//! ```text
//! u = sat( M(q) (q̈_d + 2 ω ė + ω² e) + C(q, q̇) q̇ + G(q) ),   e = q_d − q
//! ```
//!
//! What is wrong about the masses, the period and the limits of the drives leave an error at the flange, which is what
//! [`Tracked`] measures. The contact is where the flange's origin comes down to the deck, found on the dense output.
//! The platform moves as planned.
//!
//! # Source
//! J. Y. S. Luh, M. W. Walker, R. P. C. Paul, *Resolved-acceleration control of mechanical manipulators*, IEEE
//! Transactions on Automatic Control 25:3, 1980, for the coordinates of the axes.

use core::ops::ControlFlow;

use mbs_models::check::{Invalid, Must};
use mbs_runtime::attitude::{difference, log};
use mbs_runtime::control::{ComputedTorque, InvalidGain};
use mbs_runtime::{Dop853, Event, Integrator, Scalar, State};

use super::error::Infeasible;
use super::masses;
use super::plan::{Plan, turned_over};
use super::rail_arm::{RailArm, RailVector};
use super::survey::{Seen, greatest_part};
use crate::quadrotor::landing::HEIGHT;
use mbs_arm::trajectory::JointState;
use mbs_models::irb7600_rail::{Irb7600Rail, Params};

/// How the arm is controlled, and what it is.
#[derive(Clone, Debug)]
pub struct Tracking {
    /// The arm as it is; the controller has [`Experiment::robot`](super::Experiment::robot).
    pub plant: Irb7600Rail<f64>,
    /// `ω` of every axis, positive \[rad/s\].
    pub natural_frequency: f64,
    /// Between two looks of the controller, positive \[s\].
    pub period: f64,
    /// The integrator of a period.
    pub integrator: Dop853,
}

/// By how much the links are heavier than the model says, by default.
pub const LINK_EXCESS: f64 = 0.03;
/// By how much the vehicle at the flange is, by default.
pub const MODULE_EXCESS: f64 = 0.10;

/// A controller looks no more often.
const MOST_LOOKS: f64 = 1e7;

impl Tracking {
    /// Of an arm whose links are 3 % heavier than the model's and whose load is 10 %, inertias alike; 20 rad/s, every 4
    /// ms.
    ///
    /// All of it is assumed.
    #[must_use]
    pub fn new(model: &RailArm) -> Self {
        let known = model.model.params();
        let heavier = |values: [f64; 6]| values.map(|value| (1.0 + LINK_EXCESS) * value);
        let plant = Params {
            mass: heavier(known.mass),
            i_xx: heavier(known.i_xx),
            i_yy: heavier(known.i_yy),
            i_zz: heavier(known.i_zz),
            module_mass: (1.0 + MODULE_EXCESS) * known.module_mass,
            module_inertia: known.module_inertia.map(|value| (1.0 + MODULE_EXCESS) * value),
            ..*known
        };
        Self { plant: Irb7600Rail::new(plant), ..Self::exact(model) }
    }

    /// Of an arm that is as the model says.
    #[must_use]
    pub fn exact(model: &RailArm) -> Self {
        Self { plant: model.model, natural_frequency: 20.0, period: 0.004, integrator: Dop853::new(1e-10, 1e-11) }
    }

    pub(super) fn check(&self, end: f64) -> Result<(), Invalid> {
        masses::check(self.plant.params())?;
        let Self { period, .. } = *self;
        Must::BeMoreThan(0.0).check("period", period)?;
        Must::BeLessThan(MOST_LOOKS).check("number of looks", end / period)
    }
}

/// What the controller sees and does at the beginning of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The time \[s\].
    pub time: f64,
    /// What the axes are to do.
    pub wanted: JointState<7>,
    /// What they do.
    pub state: State<RailVector>,
    /// Forces of the drives \[N, N·m\], within their limits.
    pub forces: RailVector,
    /// How far the flange is from where it is to be \[m\].
    pub error: f64,
    /// By how much it is turned against it \[rad\].
    pub turn: f64,
}

/// The flange and the deck where they meet. The deck is level, with the axes of the rail; the vehicle is the flange
/// turned over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The time \[s\].
    pub time: f64,
    /// From the middle of the deck to the flange \[m\]; the third is 0 up to rounding.
    pub position: [f64; 3],
    /// Attitude of the vehicle against the deck, as a rotation vector \[rad\].
    pub attitude: [f64; 3],
    /// Velocity of the flange against the deck \[m/s\].
    pub velocity: [f64; 3],
    /// Angular velocity \[rad/s\].
    pub angular_velocity: [f64; 3],
    /// State of the axes.
    pub state: State<RailVector>,
}

/// How the arm followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// Where it ended.
    pub contact: Contact,
    /// The largest distance of the flange from where it was to be, at looks and at the contact \[m\].
    pub error: Seen,
    /// The largest angle between its attitude and that which it was to have \[rad\].
    pub turn: Seen,
    /// The largest force or torque that a drive gave, as a part of its limit.
    pub force_ratio: Seen,
    /// The part of the looks at which a drive was at its limit.
    pub saturated: f64,
}

impl Plan<'_> {
    /// Simulates the arm from where the plan begins to the contact with the deck. `observer` sees every look of the
    /// controller.
    ///
    /// ```
    /// # use mbs_landing::experiment::{Experiment, flight::Flight, tracking::Tracking};
    /// # use mbs_landing::quadrotor::{heave::Heave, landing::{Landing, Plant}};
    /// # let experiment = Experiment::new(Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I))?);
    /// // An arm that is heavier than its controller knows is a millimetre off, and comes down early.
    /// let tracked = experiment.plan_at(0.1, 1.5)?.track(&Tracking::new(&experiment.robot), |_| ())?;
    /// assert!((1e-4..2e-3).contains(&tracked.error.value));
    /// assert!(tracked.contact.time < experiment.flight.touchdown());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Infeasible`].
    pub fn track(&self, tracking: &Tracking, mut observer: impl FnMut(&Look)) -> Result<Tracked, Infeasible> {
        tracking.check(self.experiment().flight.end())?;
        let control = ComputedTorque::critically_damped(tracking.natural_frequency)
            .map_err(|InvalidGain { gain, .. }| Must::BePositive.broken_by("natural_frequency", gain))?;
        let height =
            |t: f64, state: &State<RailVector>| tracking.plant.flange(&state.q).position[2] - self.deck_height(t)[0];
        let start = self.axes(0.0)?;
        let mut state = State::new(start.q, start.qd);
        let over = height(0.0, &state);
        Must::BeMoreThan(0.0).check(HEIGHT, over)?;
        let mut way = Way::default();
        let end = self.experiment().flight.end();
        for k in 0_u32.. {
            let t = f64::from(k) * tracking.period;
            let until = f64::from(k + 1) * tracking.period;
            if until > end {
                return Err(Infeasible::NoContact { time: t, height: height(t, &state) });
            }
            let look = self.look(tracking, &control, t, &state)?;
            way.add(&look, &self.experiment().robot.force_limits());
            observer(&look);

            let integrator = tracking.integrator.with_first_step(tracking.period);
            let accelerations = |_: f64, q: &RailVector, qd: &RailVector, qdd: &mut RailVector| {
                *qdd = tracking.plant.forward_dynamics(q, qd, &look.forces);
            };
            let mut events = [Event::new(&height).falling().terminal()];
            let summary = integrator.integrate_with_events(accelerations, t, until, &mut state, &mut events, |_| {
                ControlFlow::Continue(())
            })?;
            // It may come down at the very end of a period, too.
            if summary.stopped || height(summary.time, &state) <= 0.0 {
                let last = self.look(tracking, &control, summary.time, &state)?;
                way.errors(&last);
                return Ok(way.end(self.contact(tracking, summary.time, state)));
            }
        }
        unreachable!("the flight ends before the counter does")
    }

    /// What the controller sees and does at this state.
    fn look(
        &self,
        tracking: &Tracking,
        control: &ComputedTorque<7>,
        time: f64,
        state: &State<RailVector>,
    ) -> Result<Look, Infeasible> {
        let wanted = self.axes(time)?;
        let robot = &self.experiment().robot;
        let acceleration = control.acceleration(&[wanted.q, wanted.qd, wanted.qdd], &state.q, &state.qd);
        let asked = robot.model.inverse_dynamics(&state.q, &state.qd, &acceleration);
        let limits = robot.force_limits();
        let forces = core::array::from_fn(|i| asked[i].clamp(-limits[i], limits[i]));
        let (is, wanted_pose) = (tracking.plant.flange(&state.q), robot.pose(&wanted.q));
        let apart = [0, 1, 2].map(|i| is.position[i] - wanted_pose.position[i]);
        let turn = nalgebra::Vector3::from(difference(&is.rotation, &wanted_pose.rotation)).norm();
        let error = Scalar::sqrt(apart.iter().map(|x| x * x).sum::<f64>());
        Ok(Look { time, wanted, state: *state, forces, error, turn })
    }

    fn contact(&self, tracking: &Tracking, time: f64, state: State<RailVector>) -> Contact {
        let pose = tracking.plant.flange(&state.q);
        let [vx, vy, vz, wx, wy, wz] = tracking.plant.flange_velocity(&state.q, &state.qd);
        let ([x, y], [z, rate]) = (self.experiment().cell.platform, self.deck_height(time));
        let [px, py, pz] = pose.position;
        Contact {
            time,
            position: [px - x, py - y, pz - z],
            attitude: log(&turned_over(pose.rotation)),
            velocity: [vx, vy, vz - rate],
            angular_velocity: [wx, wy, wz],
            state,
        }
    }
}

/// Extremes on the way down.
struct Way {
    error: Seen,
    turn: Seen,
    force_ratio: Seen,
    looks: u32,
    saturated: u32,
}

impl Default for Way {
    fn default() -> Self {
        let none = Seen { value: 0.0, time: 0.0 };
        Self { error: none, turn: none, force_ratio: none, looks: 0, saturated: 0 }
    }
}

impl Way {
    fn add(&mut self, look: &Look, limits: &RailVector) {
        self.errors(look);
        let part = greatest_part(&look.forces, limits);
        self.force_ratio.raise(part, look.time);
        self.looks += 1;
        self.saturated += u32::from(part >= 1.0);
    }

    fn errors(&mut self, look: &Look) {
        self.error.raise(look.error, look.time);
        self.turn.raise(look.turn, look.time);
    }

    fn end(self, contact: Contact) -> Tracked {
        let saturated = f64::from(self.saturated) / f64::from(self.looks);
        Tracked { contact, error: self.error, turn: self.turn, force_ratio: self.force_ratio, saturated }
    }
}
