//! The platform in a sea and a wind, with and without control.

use mbs_models::Error;
use mbs_models::check::{Must, finite, not_negative, positive, within};
use mbs_models::marine_platform::{MarinePlatform, Params};
use mbs_runtime::{IntegrationError, Rk4Stepper, State};

use super::Four;
use super::control::Regulator;
use super::excitation::Excitation;
use super::hull::Hull;
use super::spectrum::GRAVITY;
use super::thrusters::{Thrust, Thrusters};
use super::wind::{Superstructure, Wind};
use crate::Coordinates;

/// What is out of its range where still water does not cut a column, by its number, between its ends \[m\]: there the
/// hydrostatics hold.
pub const DEPTH: &str = "depth of column";
/// Length of a column above the water at rest \[m\].
pub const FREEBOARD: f64 = 5.0;
/// A run has at most this many steps.
pub const MOST_STEPS: f64 = 1e7;

/// The platform in a sea of N waves and a wind of G gusts.
#[derive(Clone, Debug)]
pub struct AtSea<const N: usize, const G: usize> {
    /// The equations of motion.
    model: MarinePlatform<f64>,
    /// Its closed forms.
    hull: Hull,
    /// What the sea does.
    pub excitation: Excitation<N>,
    /// The wind.
    pub wind: Wind<G>,
    /// What it blows at.
    pub superstructure: Superstructure,
    /// Who commands the thrusters; nobody without.
    pub regulator: Option<Regulator>,
    /// What they can do.
    pub thrusters: Thrusters,
}

/// A moment of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time \[s\].
    pub time: f64,
    /// (z, φ, θ, ψ) \[m, rad\].
    pub q: Four,
    /// Their rates.
    pub qd: Four,
    /// Their accelerations, from then on.
    pub qdd: Four,
    /// What is asked of the thrusters from then on \[N\].
    pub asked: Thrust,
    /// What they do \[N\].
    pub thrust: Thrust,
}

impl Moment {
    /// Coordinates, rates and accelerations of the mass centre's frame as a platform that moves in six degrees of
    /// freedom has them.
    #[must_use]
    pub fn in_six(&self) -> [Coordinates; 3] {
        [self.q, self.qd, self.qdd].map(|[z, phi, theta, psi]| [0.0, 0.0, z, phi, theta, psi])
    }
}

impl<const N: usize, const G: usize> AtSea<N, G> {
    /// Without control, with the thrusters and the superstructure that are assumed.
    ///
    /// # Errors
    /// Those of [`Hull::new`]; [`Invalid`](mbs_models::check::Invalid) where g is not that of the waves, [`GRAVITY`].
    pub fn new(params: &Params, excitation: Excitation<N>, wind: Wind<G>) -> Result<Self, Error> {
        within("g", params.g, [GRAVITY, GRAVITY])?;
        Ok(Self {
            model: MarinePlatform::new(*params),
            hull: Hull::new(params)?,
            excitation,
            wind,
            superstructure: Superstructure::default(),
            regulator: None,
            thrusters: Thrusters::default(),
        })
    }

    /// Its closed forms.
    #[must_use]
    pub fn hull(&self) -> &Hull {
        &self.hull
    }

    /// Simulates from a state at t = 0, with thrusters at rest, by one step of RK4 a period \[s\]; thrusts change at
    /// its beginning and are held until the next.
    ///
    /// `observer` sees every moment, the last one at or just after `end` \[s\].
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Invalid`](mbs_models::Failure::Invalid) of [`DEPTH`] where the motion leaves what the
    /// hydrostatics are made for.
    pub fn simulate(
        &self,
        mut state: State<[f64; 4]>,
        period: f64,
        end: f64,
        mut observer: impl FnMut(&Moment),
    ) -> Result<(), Error> {
        self.check(&state, period, end)?;
        let mut thrust = [0.0; 6];
        let mut stepper = Rk4Stepper::new(&state);
        for i in 0_u64.. {
            let time = i as f64 * period;
            if !state.is_finite() {
                return Err(IntegrationError::NonFiniteState { time }.into());
            }
            self.on_the_columns(&state.q, time)?;
            let asked = self.regulator.map_or([0.0; 6], |regulator| regulator.thrust(&state.q, &state.qd));
            thrust = self.thrusters.follow(&thrust, &asked, period);
            let accelerations =
                |t: f64, q: &Four, qd: &Four| self.model.forward_dynamics(q, qd, &self.inputs(t, &thrust));
            let qdd = accelerations(time, &state.q, &state.qd);
            observer(&Moment { time, q: state.q, qd: state.qd, qdd, asked, thrust });
            if time >= end {
                break;
            }
            let right = |t: f64, q: &Four, qd: &Four, qdd: &mut Four| *qdd = accelerations(t, q, qd);
            let Ok(()) = stepper.step(right, time, period, &mut state);
        }
        Ok(())
    }

    /// Thrusts, then what sea and wind do.
    fn inputs(&self, t: f64, thrust: &Thrust) -> [f64; 10] {
        let (sea, wind) = (self.excitation.at(t), self.wind.at(&self.superstructure, t));
        core::array::from_fn(|i| if i < 6 { thrust[i] } else { sea[i - 6] + wind[i - 6] })
    }

    fn on_the_columns(&self, q: &Four, time: f64) -> Result<(), Error> {
        let (least, most) = (0.0, self.hull.draught + FREEBOARD);
        let depths = self.hull.depths(q);
        match depths.iter().position(|&depth| !(least < depth && depth < most)) {
            Some(column) => {
                Err(Must::BeWithin([least, most]).broken_by(DEPTH, depths[column]).of(column).at_time(time))
            }
            None => Ok(()),
        }
    }

    fn check(&self, state: &State<[f64; 4]>, period: f64, end: f64) -> Result<(), Error> {
        finite("coordinates", state.q)?;
        finite("rates", state.qd)?;
        positive("period", period)?;
        not_negative("end", end)?;
        if end / period > MOST_STEPS {
            return Err(Must::BeWithin([0.0, MOST_STEPS * period]).broken_by("end", end).into());
        }
        let Superstructure { areas, drag_coefficient, air_density, place } = self.superstructure;
        not_negative("areas", areas)?;
        not_negative("drag_coefficient", drag_coefficient)?;
        not_negative("air_density", air_density)?;
        finite("place", place)?;
        self.thrusters.check()?;
        Ok(())
    }
}
