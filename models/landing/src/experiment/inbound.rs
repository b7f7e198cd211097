//! A landing that comes from afar along the rail, which takes the carriage metres.
//!
//! ```
//! use mbs_landing::experiment::inbound::Inbound;
//! use mbs_landing::quadrotor::deck::Deck;
//!
//! let inbound = Inbound::LABORATORY;
//! let (start, end) = (inbound.at(0.0), inbound.at(inbound.duration));
//! assert_eq!(end.position[0] - start.position[0], inbound.distance);
//! assert_eq!((start.velocity[0], end.velocity[0]), (0.0, 0.0));
//! ```

use mbs_models::check::{self, Invalid};
use mbs_runtime::State;

use crate::quadrotor::deck::{Deck, DeckState, HeavingDeck};
use crate::quadrotor::heave::Heave;

/// What guidance leads over: a level point that comes along x from a distance to the platform, at rest at both ends,
/// and goes up and down with the platform on the way.
///
/// ```text
/// x(t) = x_p − D (1 − 10 s³ + 15 s⁴ − 6 s⁵),   s = t/T
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inbound {
    /// Elevation of the platform.
    pub heave: Heave<4>,
    /// Where it is \[m\].
    pub place: [f64; 2],
    /// D, from where the vehicle begins to the platform, at full size \[m\].
    pub distance: f64,
    /// T, positive \[s\].
    pub duration: f64,
}

impl Inbound {
    /// 40 m in 9 s, to the platform of case I: assumed. At a scale of 0.1 the carriage moves by 4 m with up to 0.8 m/s,
    /// and the vehicle no longer brakes, which tilts it, when it comes near the deck.
    pub const LABORATORY: Self = Self { heave: Heave::CASE_I, place: [12.0, 7.0], distance: 40.0, duration: 9.0 };

    pub(super) fn check(&self) -> Result<(), Invalid> {
        check::finite("distance", self.distance)?;
        check::positive("duration", self.duration)
    }

    /// A vehicle that is level and moves with the point, this high over it \[m\].
    pub(super) fn over_start(&self, height: f64) -> State<[f64; 6]> {
        let DeckState { position: [x, y, z], velocity: [vx, vy, vz], .. } = self.at(0.0);
        State::new([x, y, z + height, 0.0, 0.0, 0.0], [vx, vy, vz, 0.0, 0.0, 0.0])
    }
}

impl Deck for Inbound {
    fn at(&self, t: f64) -> DeckState {
        let mut deck = HeavingDeck { heave: self.heave, place: self.place }.at(t);
        let s = (t / self.duration).clamp(0.0, 1.0);
        let left = 1.0 - s;
        deck.position[0] -= self.distance * left * left * left * (1.0 + s * (3.0 + 6.0 * s));
        let per_duration = self.distance / self.duration;
        deck.velocity[0] += per_duration * 30.0 * (s * left) * (s * left);
        deck.acceleration[0] += per_duration / self.duration * 60.0 * s * left * (1.0 - 2.0 * s);
        deck
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbs_runtime::Dual;

    /// The polynomial as printed, in dual numbers of dual numbers.
    #[test]
    fn rates_are_those_of_the_way() {
        let inbound = Inbound { place: [3.0, -2.0], ..Inbound::LABORATORY };
        for t in [0.0, 0.1, 3.0, 7.7, 8.999, 9.0] {
            let one =
                Dual { value: Dual { value: t, derivative: 1.0 }, derivative: Dual { value: 1.0, derivative: 0.0 } };
            let of = |x: f64| Dual {
                value: Dual { value: x, derivative: 0.0 },
                derivative: Dual { value: 0.0, derivative: 0.0 },
            };
            let s = one * of(1.0 / inbound.duration);
            let cube = s * s * s;
            let way = of(1.0) - of(10.0) * cube + of(15.0) * cube * s - of(6.0) * cube * s * s;
            let x = of(3.0) - of(inbound.distance) * way;
            let deck = inbound.at(t);
            let found = [deck.position[0], deck.velocity[0], deck.acceleration[0]];
            let want = [x.value.value, x.value.derivative, x.derivative.derivative];
            assert!((0..3).all(|i| (found[i] - want[i]).abs() < 1e-11), "{t}: {found:?}, not {want:?}");
            assert_eq!((deck.position[1], deck.position[2]), (-2.0, inbound.heave.at(t).value));
        }
        assert_eq!(inbound.at(50.0).position[0], 3.0);
    }
}
