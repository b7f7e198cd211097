//! Landing times over amplitude, frequency and phase.

use mbs_examples::Failure;
use mbs_examples::quadrotor_landing::flight::{PLACE, TOLERANCE};
use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::Swell;
use mbs_landing::quadrotor::landing::{Controller, LEVEL, Landing, Plant};
use mbs_landing::quadrotor::lqr::{Lqr, Weights};
use mbs_models::Error;
use mbs_runtime::Dop853;
use rayon::prelude::*;

/// φ \[°\].
pub(crate) const PHASES: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
/// A landing is given up then \[s\].
pub(crate) const LIMIT: f64 = 20.0;
/// The greatest amplitude \[m\] and frequency \[rad/s\].
const GREATEST: [f64; 2] = [2.0, 4.0];

/// Why there is no landing.
pub(crate) const REASONS: [&str; 3] =
    ["no touchdown in 20 s", "deck falls faster than g", "attitude lost (pitch of 90°)"];

/// Middles of the cells.
pub(crate) struct Grid {
    /// A \[m\].
    pub(crate) amplitudes: Vec<f64>,
    /// ω \[rad/s\].
    pub(crate) frequencies: Vec<f64>,
}

impl Grid {
    pub(crate) fn new(cells: usize) -> Self {
        let middles = |greatest: f64| (0..cells).map(|i| greatest * (i as f64 + 0.5) / cells as f64).collect();
        Grid { amplitudes: middles(GREATEST[0]), frequencies: middles(GREATEST[1]) }
    }

    /// The lines between the cells.
    pub(crate) fn edges(&self) -> [Vec<f64>; 2] {
        let count = self.amplitudes.len();
        GREATEST.map(|greatest| (0..=count).map(|i| greatest * i as f64 / count as f64).collect())
    }
}

/// By which equations it moves, and who flies.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Law {
    plant: Plant,
    regulated: bool,
}

impl Law {
    pub(crate) const ALL: [Self; 4] = [
        Law { plant: Plant::Exact, regulated: false },
        Law { plant: Plant::SmallAngle, regulated: false },
        Law { plant: Plant::Exact, regulated: true },
        Law { plant: Plant::SmallAngle, regulated: true },
    ];

    pub(crate) fn key(self) -> &'static str {
        match (self.plant, self.regulated) {
            (Plant::Exact, false) => "exact_backstepping",
            (Plant::SmallAngle, false) => "small_angle_backstepping",
            (Plant::Exact, true) => "exact_lqr",
            (Plant::SmallAngle, true) => "small_angle_lqr",
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match (self.plant, self.regulated) {
            (Plant::Exact, false) => "exact plant, backstepping",
            (Plant::SmallAngle, false) => "small angles, backstepping",
            (Plant::Exact, true) => "exact plant, LQR",
            (Plant::SmallAngle, true) => "small angles, LQR",
        }
    }

    /// Without guidance, on a deck.
    fn landing(self, deck: Swell) -> Result<Landing<Swell>, Failure> {
        let mut landing = Landing::on(self.plant, deck);
        if self.regulated {
            landing.controller = Controller::Lqr(Lqr::new(*landing.vehicle.params(), &Weights::default())?);
        }
        (landing.approach, landing.touchdown_height, landing.t_end) = (Approach::UNGUIDED, TOLERANCE, LIMIT);
        // Times are wanted to a tenth of a millisecond.
        landing.integrator = Dop853::new(1e-8, 1e-8);
        Ok(landing)
    }
}

/// What became of a landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// At this time \[s\].
    Lands(f64),
    /// It was not down in time.
    TooLong,
    /// `A ω² > g`.
    DeckFalls,
    /// The vehicle turned over.
    AttitudeLost,
}

impl Outcome {
    /// Its place in [`REASONS`], of what is no landing.
    pub(crate) fn reason_index(self) -> Option<usize> {
        match self {
            Outcome::Lands(_) => None,
            Outcome::TooLong => Some(0),
            Outcome::DeckFalls => Some(1),
            Outcome::AttitudeLost => Some(2),
        }
    }

    pub(crate) fn reason(self) -> Option<&'static str> {
        self.reason_index().map(|reason| REASONS[reason])
    }

    fn of(law: Law, deck: Swell) -> Result<Self, Failure> {
        let landing = law.landing(deck)?;
        if deck.amplitude * deck.frequency * deck.frequency > landing.vehicle.params().g {
            return Ok(Outcome::DeckFalls);
        }
        match landing.simulate(Landing::initial_state(), |_, _, _| ()) {
            Ok(end) => Ok(Outcome::Lands(end.time)),
            Err(Error { failure: mbs_models::Failure::NoContact { .. }, .. }) => Ok(Outcome::TooLong),
            Err(error) if error.invalid().is_some_and(|wrong| wrong.parameter == LEVEL) => Ok(Outcome::AttitudeLost),
            Err(error) => Err(error.into()),
        }
    }
}

/// Of one law: phases, frequencies, amplitudes.
pub(crate) struct Map {
    pub(crate) law: Law,
    pub(crate) phases: Vec<Vec<Vec<Outcome>>>,
}

impl Map {
    /// Every cell by itself, so that the number of threads changes nothing.
    pub(crate) fn flown(law: Law, grid: &Grid) -> Result<Self, Failure> {
        let decks: Vec<Swell> = PHASES
            .iter()
            .flat_map(|phase| grid.frequencies.iter().map(move |w| (phase.to_radians(), *w)))
            .flat_map(|(phase, frequency)| {
                grid.amplitudes.iter().map(move |&amplitude| Swell { place: PLACE, amplitude, frequency, phase })
            })
            .collect();
        let flown: Vec<Result<Outcome, String>> = decks
            .into_par_iter()
            .map(|deck| Outcome::of(law, deck).map_err(|error| format!("{deck:?}: {error:?}")))
            .collect();
        let outcomes = flown.into_iter().collect::<Result<Vec<_>, _>>().map_err(Failure::new)?;
        let rows: Vec<Vec<Outcome>> = outcomes.chunks(grid.amplitudes.len()).map(<[Outcome]>::to_vec).collect();
        Ok(Map { law, phases: rows.chunks(grid.frequencies.len()).map(<[Vec<Outcome>]>::to_vec).collect() })
    }

    fn outcomes(&self) -> impl Iterator<Item = Outcome> {
        self.phases.iter().flatten().flatten().copied()
    }

    fn times(&self) -> impl Iterator<Item = f64> {
        self.outcomes().filter_map(|outcome| if let Outcome::Lands(time) = outcome { Some(time) } else { None })
    }

    /// How many land, and how many do not.
    pub(crate) fn counts(&self) -> [usize; 2] {
        let lands = self.times().count();
        [lands, self.outcomes().count() - lands]
    }

    pub(crate) fn count_of(&self, reason: usize) -> usize {
        self.outcomes().filter(|outcome| outcome.reason_index() == Some(reason)).count()
    }

    /// The shortest and the longest time \[s\].
    pub(crate) fn range(&self) -> [f64; 2] {
        self.times().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], time| [a.min(time), b.max(time)])
    }

    /// The greatest difference of times where both land \[s\].
    pub(crate) fn difference(&self, other: &Self) -> f64 {
        let both = self.outcomes().zip(other.outcomes());
        both.fold(0.0, |most, pair| match pair {
            (Outcome::Lands(a), Outcome::Lands(b)) => most.max((a - b).abs()),
            _ => most,
        })
    }
}
