//! A simulation under controllers that act once a period and hold what they ask for in between.

use mbs_models::{Error, Failure};
use mbs_runtime::{IntegrationError, Rk4Stepper, State};

/// How often the time of the touchdown is halved: to less than the resolution of the clock.
const HALVINGS: usize = 50;

/// What moves, who holds it, and how high it is over the deck.
pub(super) struct ZeroOrderHold<Hold, Accelerations, Height> {
    /// Between two moments at which the controllers act, and of one step of RK4 \[s\]; checked with the landing.
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

impl<Hold, Accelerations, Height> ZeroOrderHold<Hold, Accelerations, Height> {
    /// When the height is zero, and the state then.
    pub(super) fn until_touchdown<const N: usize, H>(
        self,
        mut state: State<[f64; N]>,
    ) -> Result<(f64, State<[f64; N]>), Error>
    where
        Hold: FnMut(f64, &State<[f64; N]>) -> Result<H, Error>,
        Accelerations: Fn(&H, f64, &[f64; N], &[f64; N]) -> [f64; N],
        Height: Fn(f64, &State<[f64; N]>) -> f64,
    {
        let ZeroOrderHold { period, t_end, mut hold, accelerations, height } = self;
        let mut stepper = Rk4Stepper::new(&state);
        for i in 0_u64.. {
            let t = i as f64 * period;
            let held = hold(t, &state)?;
            if t >= t_end {
                return Err(Failure::NoContact { distance: height(t, &state) }.at_time(t));
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
