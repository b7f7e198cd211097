//! Landing under a sampled controller that sees the state through sensors.

use mbs_models::{Error, Failure};
use mbs_runtime::State;

use super::deck::Deck;
use super::landing::{Landing, attitude_told, finite_deck};
use super::touchdown::{Touchdown, Way};
use super::zero_order_hold::ZeroOrderHold;

impl<D: Deck> Landing<D> {
    /// The landing with rotor speeds that are held for one period, integrated by one step of RK4 a period.
    ///
    /// `sensor` gives the state that the controller sees at a time, for the one that is. The touchdown is found within
    /// the period by halving it.
    ///
    /// # Errors
    /// [`Error`]; of the period \[s\] where it is none; `NotFinite` where the sensor gives NaN or an infinite value.
    pub fn simulate_sampled(
        &self,
        state: State<[f64; 6]>,
        period: f64,
        sensor: impl FnMut(f64, &State<[f64; 6]>) -> State<[f64; 6]>,
    ) -> Result<Touchdown, Error> {
        self.simulate_in_wind(state, period, sensor, |_, _| self.wind)
    }

    /// The sampled landing in a wind that changes: its velocity \[m/s\] is asked for at the beginning of each period
    /// and held, as the rotor speeds are.
    ///
    /// # Errors
    /// As [`simulate_sampled`](Self::simulate_sampled), and `NotFinite` where the wind is NaN or infinite.
    pub fn simulate_in_wind(
        &self,
        state: State<[f64; 6]>,
        period: f64,
        mut sensor: impl FnMut(f64, &State<[f64; 6]>) -> State<[f64; 6]>,
        mut wind: impl FnMut(f64, &State<[f64; 6]>) -> [f64; 3],
    ) -> Result<Touchdown, Error> {
        self.check(&state, period)?;
        let mut way = Way::new();
        let hold = |t: f64, state: &State<[f64; 6]>| {
            let seen = sensor(t, state);
            if !seen.is_finite() {
                return Err(Failure::NotFinite("what a sensor gives").at_time(t));
            }
            attitude_told(state, t)?;
            let deck = finite_deck(self.deck.at(t), t)?;
            let command = self.command_over(&deck, t, &seen.q, &seen.qd);
            way.hold(t, state, &command, &deck);
            let wind = wind(t, state);
            if wind.iter().any(|speed| !speed.is_finite()) {
                return Err(Failure::NotFinite("the wind").at_time(t));
            }
            Ok((command.rotors.speed, wind))
        };
        let run = ZeroOrderHold {
            period,
            t_end: self.t_end,
            hold,
            accelerations: |(speeds, wind): &([f64; 4], [f64; 3]), t: f64, q: &[f64; 6], qd: &[f64; 6]| {
                self.accelerations_at(wind, || self.height(t, q), q, qd, speeds)
            },
            height: |t: f64, state: &State<[f64; 6]>| self.above(t, &state.q),
        };
        let (time, state) = run.until_touchdown(state)?;
        way.touchdown(self, time, state, self.deck.at(time))
    }
}
