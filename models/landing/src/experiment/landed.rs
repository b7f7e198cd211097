//! Through the contact: arm and platform, each under its controller, with what they push on each other with.
//!
//! The platform moves by its own dynamics, driven by its legs, which follow the planned motion of the deck as well as
//! computed torque does. The vehicle at the flange stands on four feet in the plane of its mass centre. Where the arm
//! feels a foot it stops the flight, takes the deck's planned motion for its own, is soft, and leaves the vehicle's
//! weight to the deck.
//!
//! ```text
//! M_a q̈_a = u − C q̇_a − G + J_fᵀ W,           M_p q̈_p = J_qᵀ f − C q̇_p − G − J_dᵀ W
//! ```
//!
//! with the wrench W of all feet, by [`Gear`].

use core::ops::ControlFlow;

use mbs_models::Error;
use mbs_models::check::{self, Invalid, Must};
use mbs_models::irb7600_rail::{Irb7600Rail, Params};
use mbs_platform::jacobian::angular_rates;
use mbs_platform::{Coordinates, HOME, LegVector, NOT_FINITE};
use mbs_runtime::control::{ComputedTorque, InvalidGain};
use mbs_runtime::{Dop853, Integrator, Pose, Scalar, State, to_matrix};
use nalgebra::{Vector3, Vector6};

use super::error::Infeasible;
use super::plan::{BRANCH, Plan, turned_over};
use super::rail_arm::{FlangeMotion, RailVector};
use super::survey::Seen;
use super::tracking::Tracking;
use crate::quadrotor::deck::DeckState;
use crate::quadrotor::gear::{Contact, Damping, Gear, RigidMotion};

/// How arm and platform are controlled when they meet.
#[derive(Clone, Debug)]
pub struct Landed {
    /// The arm and its controller up to the contact.
    pub tracking: Tracking,
    /// `ω` of the platform's controller, critically damped, positive \[rad/s\].
    pub platform_frequency: f64,
    /// What touches: feet in the plane of the vehicle's mass centre.
    pub gear: Gear,
    /// From this force on the arm knows that it stands, positive \[N\].
    pub threshold: f64,
    /// `ω` of every axis of the arm from then on, critically damped, positive \[rad/s\].
    pub soft_frequency: f64,
    /// How long the contact is followed, positive \[s\].
    pub after: f64,
}

impl Landed {
    /// Four feet of 50 kN/m under the vehicle, half a metre apart; a platform of 8 rad/s, an arm that is as soft as 2
    /// rad/s once it stands; for 4 s. All of it is assumed.
    #[must_use]
    pub fn new(tracking: Tracking) -> Self {
        Self {
            tracking,
            platform_frequency: 8.0,
            gear: Gear {
                half_track: 0.25,
                height: 0.0,
                stiffness: 5e4,
                exponent: 1.0,
                damping: Damping::HuntCrossley(2.0),
                friction: 0.6,
                creep_speed: 1e-3,
            },
            threshold: 20.0,
            soft_frequency: 2.0,
            after: 4.0,
        }
    }

    fn check(&self) -> Result<(), Invalid> {
        self.gear.check()?;
        check::positive("threshold", self.threshold)?;
        check::positive("after", self.after)
    }
}

/// Everything at a moment at which the controllers act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The time \[s\].
    pub time: f64,
    /// The axes of the arm.
    pub arm: State<RailVector>,
    /// The platform, over its base.
    pub platform: State<Coordinates>,
    /// Forces of the axes \[N, N·m\].
    pub drives: RailVector,
    /// Forces of the platform's legs \[N\].
    pub legs: LegVector,
    /// Height of the lowest foot over the deck \[m\].
    pub height: f64,
    /// What the deck carries: the normal forces of all feet \[N\].
    pub load: f64,
    /// From the platform's frame to the flange, along the deck's own axes \[m\].
    pub offset: [f64; 2],
    /// How far the platform is from where it was to be \[m\].
    pub platform_error: f64,
    /// Whether the arm knows that it stands.
    pub stands: bool,
}

/// What comes of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// When the controllers first saw a foot touch \[s\].
    pub time: f64,
    /// The greatest force on the deck.
    pub force: Seen,
    /// How often the controllers saw all feet lose touch again.
    pub rebounds: u32,
    /// The mean force on the deck in the second half of what follows the contact \[N\].
    pub resting: f64,
    /// How far the flange is along the deck from where it touched, at the end \[m\].
    pub slid: f64,
    /// The greatest distance of the platform from its plan before the contact, and after it \[m\].
    pub platform_error: [f64; 2],
    /// The greatest force of a leg before the contact, and after it \[N\].
    pub leg_force: [f64; 2],
}

impl Plan<'_> {
    /// Simulates arm and platform through the contact, from a time before it \[s\] at which both are as planned.
    /// `observer` sees them whenever the controllers act.
    ///
    /// # Errors
    /// [`Infeasible`]; `NoContact` where the flight ends before a foot touches.
    pub fn land(&self, landed: &Landed, from: f64, mut observer: impl FnMut(&Meeting)) -> Result<Standing, Infeasible> {
        let (period, end) = (landed.tracking.period, self.experiment().flight.end());
        landed.check()?;
        landed.tracking.check(end + landed.after)?;
        let pair = Pair::new(*self, landed)?;
        let (start, [p, pd, _]) = (self.axes(from)?, self.deck(from));
        let mut state = State::new(both(&start.q, &p), both(&start.qd, &pd));
        let mut way = Way::new();
        let mut felt = None;
        for k in 0_u32.. {
            let t = from + f64::from(k) * period;
            let meeting = pair.meeting(t, &state, &mut felt)?;
            way.add(&meeting, landed.after);
            observer(&meeting);
            match way.touched {
                None if t + period > end => return Err(Infeasible::NoContact { time: t, height: meeting.height }),
                Some(touched) if t >= touched + landed.after => return Ok(way.end(touched)),
                _ => {}
            }
            let right = |_: f64, q: &[f64; 13], qd: &[f64; 13], qdd: &mut [f64; 13]| {
                *qdd = pair.accelerations(&State::new(*q, *qd), &meeting.drives, &meeting.legs);
            };
            let integrator = Dop853::new(1e-9, 1e-9).with_first_step(period);
            integrator.integrate(right, t, t + period, &mut state, |_| ControlFlow::Continue(()))?;
        }
        unreachable!("the time ends before the counter does")
    }
}

/// Where the flange stood when the arm felt it, and how high the deck was to be then.
struct Felt {
    pose: Pose<f64>,
    deck: f64,
}

/// Arm and platform with their controllers.
struct Pair<'a> {
    plan: Plan<'a>,
    landed: &'a Landed,
    flying: ComputedTorque<7>,
    standing: ComputedTorque<7>,
    platform: ComputedTorque<6>,
    /// The arm as its controller knows it, without the vehicle.
    unladen: Irb7600Rail<f64>,
}

impl<'a> Pair<'a> {
    fn new(plan: Plan<'a>, landed: &'a Landed) -> Result<Self, Invalid> {
        fn damped<const N: usize>(name: &'static str, frequency: f64) -> Result<ComputedTorque<N>, Invalid> {
            let refused = |InvalidGain { gain, .. }| Must::BePositive.broken_by(name, gain);
            ComputedTorque::critically_damped(frequency).map_err(refused)
        }
        let known = plan.experiment().robot.model.params();
        Ok(Self {
            plan,
            landed,
            flying: damped("natural_frequency", landed.tracking.natural_frequency)?,
            standing: damped("soft_frequency", landed.soft_frequency)?,
            platform: damped("platform_frequency", landed.platform_frequency)?,
            unladen: Irb7600Rail::new(Params { module_mass: 0.0, module_inertia: [0.0; 3], ..*known }),
        })
    }

    fn deck(&self, platform: &State<Coordinates>) -> DeckState {
        let cell = self.plan.experiment().cell;
        let [x, y, z, phi, theta, psi] = platform.q;
        let over_rail = [cell.platform[0] + x, cell.platform[1] + y, cell.deck - HOME[2] + z, phi, theta, psi];
        DeckState::of_platform(&[over_rail, platform.qd, [0.0; 6]], &[0.0; 3])
    }

    fn contact(&self, arm: &State<RailVector>, deck: &DeckState) -> Contact {
        let plant = &self.landed.tracking.plant;
        let Pose { position, rotation } = plant.flange(&arm.q);
        let [vx, vy, vz, wx, wy, wz] = plant.flange_velocity(&arm.q, &arm.qd);
        let vehicle = RigidMotion {
            position: position.into(),
            rotation: to_matrix(&turned_over(rotation)),
            velocity: [vx, vy, vz].into(),
            angular_velocity: [wx, wy, wz].into(),
        };
        self.landed.gear.contact(&vehicle, deck)
    }

    /// What both controllers see and do.
    fn meeting(&self, time: f64, state: &State<[f64; 13]>, felt: &mut Option<Felt>) -> Result<Meeting, Infeasible> {
        let (arm, platform) = parted(state);
        let deck = self.deck(&platform);
        let contact = self.contact(&arm, &deck);
        let load = contact.normal.iter().sum();
        let pose = self.landed.tracking.plant.flange(&arm.q);
        if felt.is_none() && load > self.landed.threshold {
            *felt = Some(Felt { pose, deck: self.plan.deck_height(time)[0] });
        }
        let wanted = self.plan.deck(time);
        let control = &self.plan.experiment().platform;
        let failed = |reason| Infeasible::Pose { time, reason };
        let legs = control.computed_forces(&self.platform, &wanted, &platform.q, &platform.qd).map_err(failed)?;
        let away = Vector3::from(pose.position) - Vector3::from(deck.position);
        let offset = to_matrix(&deck.rotation).tr_mul(&away);
        let apart: f64 = (0..3).map(|i| (platform.q[i] - wanted[0][i]).powi(2)).sum();
        Ok(Meeting {
            time,
            arm,
            platform,
            drives: self.drives(time, &arm, felt.as_ref())?,
            legs: control.limits.saturated(&legs),
            height: -contact.deepest(),
            load,
            offset: [offset.x, offset.y],
            platform_error: Scalar::sqrt(apart),
            stands: felt.is_some(),
        })
    }

    /// Along the plan, or with the deck as it is planned, soft and without the vehicle's weight.
    fn drives(&self, t: f64, arm: &State<RailVector>, felt: Option<&Felt>) -> Result<RailVector, Infeasible> {
        let robot = &self.plan.experiment().robot;
        let asked = match felt {
            None => {
                let wanted = self.plan.axes(t)?;
                let acceleration = self.flying.acceleration(&[wanted.q, wanted.qd, wanted.qdd], &arm.q, &arm.qd);
                robot.model.inverse_dynamics(&arm.q, &arm.qd, &acceleration)
            }
            Some(Felt { pose, deck }) => {
                let [_, rate, acceleration] = self.plan.deck(t).map(|of| of[2]);
                let mut flange = FlangeMotion::at_rest(pose.position, pose.rotation);
                flange.pose.position[2] += self.plan.deck_height(t)[0] - deck;
                (flange.twist[2], flange.twist_rate[2]) = (rate, acceleration);
                let followed = robot.follow(&flange, self.plan.standoff(), BRANCH);
                let wanted = followed.map_err(|reason| Infeasible::Arm { time: t, reason })?;
                let acceleration = self.standing.acceleration(&[wanted.q, wanted.qd, wanted.qdd], &arm.q, &arm.qd);
                self.unladen.inverse_dynamics(&arm.q, &arm.qd, &acceleration)
            }
        };
        let limits = robot.force_limits();
        Ok(core::array::from_fn(|i| asked[i].clamp(-limits[i], limits[i])))
    }

    /// Of all thirteen; NaN where the platform has none, which the integrator refuses.
    fn accelerations(&self, state: &State<[f64; 13]>, drives: &RailVector, legs: &LegVector) -> [f64; 13] {
        let (arm, platform) = parted(state);
        let contact = self.contact(&arm, &self.deck(&platform));
        let wrench = both_of(contact.force, contact.moment);
        let plant = &self.landed.tracking.plant;
        let jacobian = plant.flange_jacobian(&arm.q);
        let pushed = core::array::from_fn(|j| drives[j] + (0..6).map(|i| jacobian[i][j] * wrench[i]).sum::<f64>());
        let of_arm = plant.forward_dynamics(&arm.q, &arm.qd, &pushed);
        let of_platform =
            self.of_platform(&platform, legs, &both_of(-contact.force, contact.deck_moment)).unwrap_or([f64::NAN; 6]);
        both(&of_arm, &of_platform)
    }

    /// `M⁻¹ (J_qᵀ f − C q̇ − G + Q)` with `Q = (F, Tᵀ M)`.
    fn of_platform(
        &self,
        state: &State<Coordinates>,
        legs: &LegVector,
        wrench: &[f64; 6],
    ) -> Result<Coordinates, Error> {
        let platform = &self.plan.experiment().platform;
        let free = platform.accelerations(&state.q, &state.qd, legs)?;
        let [x, y, z, moment @ ..] = *wrench;
        let [a, b, c]: [f64; 3] = to_matrix(&angular_rates(&state.q)).tr_mul(&Vector3::from(moment)).into();
        let masses = to_matrix(&platform.model().mass_matrix(&state.q)).cholesky().ok_or(NOT_FINITE)?;
        let pushed: Vector6<f64> = masses.solve(&Vector6::new(x, y, z, a, b, c));
        Ok(core::array::from_fn(|i| free[i] + pushed[i]))
    }
}

/// A force and a moment.
fn both_of(force: Vector3<f64>, moment: Vector3<f64>) -> [f64; 6] {
    core::array::from_fn(|i| if i < 3 { force[i] } else { moment[i - 3] })
}

fn both(arm: &RailVector, platform: &Coordinates) -> [f64; 13] {
    core::array::from_fn(|i| if i < 7 { arm[i] } else { platform[i - 7] })
}

fn parted(state: &State<[f64; 13]>) -> (State<RailVector>, State<Coordinates>) {
    let arm = |all: &[f64; 13]| core::array::from_fn(|i| all[i]);
    let platform = |all: &[f64; 13]| core::array::from_fn(|i| all[7 + i]);
    (State::new(arm(&state.q), arm(&state.qd)), State::new(platform(&state.q), platform(&state.qd)))
}

/// Extremes on the way.
struct Way {
    touched: Option<f64>,
    first_offset: [f64; 2],
    last_offset: [f64; 2],
    is_touching: bool,
    force: Seen,
    rebounds: u32,
    resting: (f64, u32),
    platform_error: [f64; 2],
    leg_force: [f64; 2],
}

impl Way {
    fn new() -> Self {
        Self {
            touched: None,
            first_offset: [0.0; 2],
            last_offset: [0.0; 2],
            is_touching: false,
            force: Seen { value: 0.0, time: 0.0 },
            rebounds: 0,
            resting: (0.0, 0),
            platform_error: [0.0; 2],
            leg_force: [0.0; 2],
        }
    }

    fn add(&mut self, meeting: &Meeting, after: f64) {
        let Meeting { time, load, legs, offset, platform_error, .. } = *meeting;
        let touches = load > 0.0;
        if touches && self.touched.is_none() {
            (self.touched, self.first_offset) = (Some(time), offset);
        }
        let part = usize::from(self.touched.is_some());
        self.platform_error[part] = self.platform_error[part].max(platform_error);
        self.leg_force[part] = legs.iter().fold(self.leg_force[part], |most, force| most.max(force.abs()));
        self.rebounds += u32::from(self.is_touching && !touches);
        (self.is_touching, self.last_offset) = (touches, offset);
        self.force.raise(load, time);
        if self.touched.is_some_and(|touched| time >= touched + 0.5 * after) {
            self.resting = (self.resting.0 + load, self.resting.1 + 1);
        }
    }

    fn end(self, time: f64) -> Standing {
        let along: [f64; 2] = core::array::from_fn(|i| self.last_offset[i] - self.first_offset[i]);
        Standing {
            time,
            force: self.force,
            rebounds: self.rebounds,
            resting: self.resting.0 / f64::from(self.resting.1.max(1)),
            slid: Scalar::sqrt(along[0] * along[0] + along[1] * along[1]),
            platform_error: self.platform_error,
            leg_force: self.leg_force,
        }
    }
}
