//! Landing under a sampled controller that sees the state through sensors.

use mbs_runtime::{IntegrationError, Rk4Stepper, State};

use super::backstepping::Command;
use super::deck::Deck;
use super::landing::{Landing, LandingError, Touchdown, Way};

/// How often the time of the touchdown is halved: to less than the resolution of the clock.
const HALVINGS: usize = 50;

impl<D: Deck> Landing<D> {
    /// The landing with rotor speeds that are held for one period, integrated by one step of RK4 a period.
    ///
    /// `sensor` gives the state that the controller sees at a time, for the one that is. The touchdown is found within the
    /// period by halving it.
    ///
    /// # Errors
    /// [`LandingError`]; `NotPositive` where the period \[s\] is not, `Sensor` where what the sensor gives is no number.
    pub fn simulate_sampled(
        &self,
        state: State<[f64; 6]>,
        period: f64,
        mut sensor: impl FnMut(f64, &State<[f64; 6]>) -> State<[f64; 6]>,
    ) -> Result<Touchdown, LandingError> {
        self.check(&state)?;
        let mut way = Way::new();
        let hold = |t: f64, state: &State<[f64; 6]>| {
            let seen = sensor(t, state);
            if !seen.is_finite() {
                return Err(LandingError::Sensor { time: t });
            }
            let deck = self.deck.at(t);
            if !deck.is_finite() {
                return Err(LandingError::Deck { time: t });
            }
            let command = self.command_over(&deck, t, &seen.q, &seen.qd);
            way.add(t, state, &command, &deck);
            Ok(command)
        };
        let run = Sampled {
            period,
            t_end: self.t_end,
            hold,
            accelerations: |held: &Command, t: f64, q: &[f64; 6], qd: &[f64; 6]| {
                self.accelerations(t, q, qd, &held.rotors.speed)
            },
            height: |t: f64, state: &State<[f64; 6]>| self.height(t, &state.q),
        };
        let (time, state) = run.until_touchdown(state)?;
        self.touchdown(time, state, self.deck.at(time), &way)
    }
}

/// A simulation under controllers that hold what they ask for.
pub(super) struct Sampled<Hold, Accelerations, Height> {
    /// Between two moments at which the controllers act, and of one step of RK4 \[s\].
    pub(super) period: f64,
    /// When it is given up \[s\].
    pub(super) t_end: f64,
    /// What the controllers hold from a moment on.
    pub(super) hold: Hold,
    /// Of all coordinates, with what is held.
    pub(super) accelerations: Accelerations,
    /// Over the deck \[m\].
    pub(super) height: Height,
}

impl<Hold, Accelerations, Height> Sampled<Hold, Accelerations, Height> {
    /// When the height is zero, and the state then.
    pub(super) fn until_touchdown<const N: usize, H>(
        self,
        mut state: State<[f64; N]>,
    ) -> Result<(f64, State<[f64; N]>), LandingError>
    where
        Hold: FnMut(f64, &State<[f64; N]>) -> Result<H, LandingError>,
        Accelerations: Fn(&H, f64, &[f64; N], &[f64; N]) -> [f64; N],
        Height: Fn(f64, &State<[f64; N]>) -> f64,
    {
        let Sampled { period, t_end, mut hold, accelerations, height } = self;
        if !(period > 0.0 && period.is_finite()) {
            return Err(LandingError::NotPositive { parameter: "period", value: period });
        }
        let mut stepper = Rk4Stepper::new(&state);
        for i in 0_u64.. {
            let t = i as f64 * period;
            let held = hold(t, &state)?;
            if t >= t_end {
                return Err(LandingError::NoTouchdown { time: t, height: height(t, &state) });
            }
            let mut step = |h: f64| {
                let mut end = state;
                let right = |t: f64, q: &[f64; N], qd: &[f64; N], qdd: &mut [f64; N]| {
                    *qdd = accelerations(&held, t, q, qd);
                };
                let moved = stepper.step(right, t, h, &mut end).is_ok() && end.is_finite();
                moved.then_some(end).ok_or(IntegrationError::NonFiniteState { time: t })
            };
            let end = step(period)?;
            let after = height(t + period, &end);
            if after > 0.0 || after.is_nan() {
                // Where there is no deck any more, `hold` says so.
                state = end;
                continue;
            }
            let (mut above, mut below) = (0.0, period);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (above + below);
                if height(t + middle, &step(middle)?) > 0.0 { above = middle } else { below = middle }
            }
            return Ok((t + below, step(below)?));
        }
        unreachable!("t passes t_end before the counter ends")
    }
}
