//! Landing under a sampled controller that sees the state through sensors.

use mbs_runtime::{IntegrationError, Rk4Stepper, State};

use super::landing::{Landing, LandingError, Touchdown, Way};

/// How often the time of the touchdown is halved: to less than the resolution of the clock.
const HALVINGS: usize = 50;

impl Landing {
    /// The landing with rotor speeds that are held for one period, integrated by one step of RK4 a period.
    ///
    /// `sensor` gives the state that the controller sees at a time, for the one that is. The touchdown is found within the
    /// period by halving it.
    ///
    /// # Errors
    /// [`LandingError`]; `NotPositive` where the period \[s\] is not, `Sensor` where what the sensor gives is no number.
    pub fn simulate_sampled(
        &self,
        mut state: State<[f64; 6]>,
        period: f64,
        mut sensor: impl FnMut(f64, &State<[f64; 6]>) -> State<[f64; 6]>,
    ) -> Result<Touchdown, LandingError> {
        self.check(&state)?;
        if !(period > 0.0 && period.is_finite()) {
            return Err(LandingError::NotPositive { parameter: "period", value: period });
        }
        let mut way = Way::new();
        let mut stepper = Rk4Stepper::new(&state);
        for i in 0_u64.. {
            let t = i as f64 * period;
            let seen = sensor(t, &state);
            if !seen.is_finite() {
                return Err(LandingError::Sensor { time: t });
            }
            let command = self.command(t, &seen.q, &seen.qd);
            way.add(t, &state, &command);
            if t >= self.t_end {
                return Err(LandingError::NoTouchdown { time: t, height: self.height(t, &state) });
            }
            let mut step = |h: f64| {
                let mut end = state;
                let accelerations = |_: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
                    *qdd = self.accelerations(q, qd, &command.rotors.speed);
                };
                let moved = stepper.step(accelerations, t, h, &mut end).is_ok() && end.is_finite();
                moved.then_some(end).ok_or(IntegrationError::NonFiniteState { time: t })
            };
            let end = step(period)?;
            if self.height(t + period, &end) > 0.0 {
                state = end;
                continue;
            }
            let (mut above, mut below) = (0.0, period);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (above + below);
                if self.height(t + middle, &step(middle)?) > 0.0 { above = middle } else { below = middle }
            }
            return Ok(self.touchdown(t + below, step(below)?, &way));
        }
        unreachable!("t passes t_end before the counter ends")
    }
}
