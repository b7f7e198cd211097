//! The simulations: landings under guidance up to the first touch, and what follows.

use mbs_examples::Failure;
use mbs_examples::quadrotor_landing::flight::{CASES, FIELD, MARINE, heaving, marine, over_base};
use mbs_examples::quadrotor_landing::platform::{admissible, platform};
use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::{Deck, MovingDeck};
use mbs_landing::quadrotor::driven::Drive;
use mbs_landing::quadrotor::gear::{Damping, Gear};
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::standing::{Moment, Planned, Settled, Stand, Standing, Start, with_quaternion};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_platform::{HOME, Motion, Superposition};
use mbs_runtime::State;
use mbs_runtime::control::ComputedTorque;

/// Of both controllers before the touchdown \[s\].
const PERIOD: f64 = 0.002;
/// Of the errors of the platform \[rad/s\].
const NATURAL_FREQUENCY: f64 = 8.0;
/// What is shown before the first touch \[s\].
pub(crate) const BEFORE: f64 = 0.3;

/// A vehicle on a deck that nothing disturbs.
pub(crate) struct OnDeck {
    pub(crate) name: &'static str,
    /// How the landing before it ended; none where the start was made by hand.
    pub(crate) landing: Option<Touchdown>,
    pub(crate) settled: Settled,
    /// Every millisecond.
    pub(crate) moments: Vec<Moment>,
}

fn followed<D: Deck>(
    name: &'static str,
    landing: Option<Touchdown>,
    standing: &Standing,
    deck: D,
    start: &Start,
) -> Result<OnDeck, Failure> {
    let mut moments = Vec::new();
    let settled = standing.simulate(&Planned(deck), start, |moment| moments.push(*moment))?;
    Ok(OnDeck { name, landing, settled, moments })
}

/// A deck at rest, rolled by an angle \[rad\].
fn sloped(roll: f64) -> MovingDeck<Motion> {
    let still = Motion { mean: [0.0, 0.0, 0.0, roll, 0.0, 0.0], sine: [0.0; 6], cosine: [0.0; 6], frequency: [0.0; 6] };
    MovingDeck { motion: still, base: [0.0; 3], point: [0.0; 3] }
}

/// The four endings, each from a start by hand with rotors that stand.
pub(crate) fn by_hand() -> Result<Vec<OnDeck>, Failure> {
    let gear = Gear::default();
    let soft = Gear { damping: Damping::HuntCrossley(0.2), ..gear };
    let steep = 35.0_f64.to_radians();
    // Name, gear, the deck's roll, velocity in the deck's axes; feet are 5 cm over the deck.
    let starts = [
        ("rest", gear, 0.0, [0.0, 0.0, -0.2]),
        ("rebound", soft, 0.0, [0.0, 0.0, -2.0]),
        ("sliding", gear, steep, [0.0, 0.0, -0.2]),
        ("tip_over", Gear { friction: 1.0, ..gear }, 0.0, [0.0, -4.0, -1.0]),
    ];
    let of = |(name, gear, roll, [x, y, z]): (&'static str, Gear, f64, [f64; 3])| {
        let standing = Standing { duration: 4.0, ..Standing::new(gear) };
        let ((sin, cos), height) = (roll.sin_cos(), gear.height + 0.05);
        let q = [0.0, -sin * height, cos * height, roll, 0.0, 0.0];
        let vehicle = State::new(q, [x, cos * y - sin * z, sin * y + cos * z, 0.0, 0.0, 0.0]);
        followed(name, None, &standing, sloped(roll), &Start::at_rest(0.0, with_quaternion(&vehicle)))
    };
    starts.into_iter().map(of).collect()
}

/// A guided landing of a vehicle with legs; heights of the guidance count from the feet at its end.
fn guided<D>(deck: D) -> Landing<D> {
    let (gear, approach) = (Gear::default(), Approach::default());
    let last_height = approach.last_height + gear.height;
    Landing { gear: Some(gear), approach: Approach { last_height, ..approach }, ..Landing::on(Plant::Exact, deck) }
}

fn landed<D: Deck + Copy>(name: &'static str, deck: D) -> Result<OnDeck, Failure> {
    let landing = guided(deck);
    let end = landing.simulate(Landing::initial_state(), |_, _, _| ())?;
    let State { q, qd } = end.state;
    let start = Start {
        rotor_speed: landing.command(end.time, &q, &qd).rotors.speed,
        ..Start::at_rest(end.time, with_quaternion(&end.state))
    };
    // The period of the heaves of the thesis.
    let standing = Standing { duration: 40.0, ..Standing::new(Gear::default()) };
    followed(name, Some(end), &standing, deck, &start)
}

pub(crate) fn on_planned_decks() -> Result<Vec<OnDeck>, Failure> {
    let [first, second] = CASES.map(|(case, heave)| landed(case, heaving(heave)));
    Ok(vec![first?, second?, landed(MARINE, marine(Superposition::MARINE))?])
}

/// A vehicle on the platform under control.
pub(crate) struct OnPlatform {
    pub(crate) name: &'static str,
    /// Of the motion, so that the legs keep their limits without the vehicle.
    pub(crate) scale: f64,
    pub(crate) stand: Stand,
}

fn carried<const K: usize>(
    name: &'static str,
    motion: &Superposition<K>,
    point: [f64; 3],
) -> Result<OnPlatform, Failure> {
    let platform = platform()?;
    let scale = admissible(&platform, motion)?;
    let landing = guided(over_base(motion.scaled(scale), point));
    let drive = Drive { platform, control: ComputedTorque::critically_damped(NATURAL_FREQUENCY)? };
    let stand = Stand::of(&landing, drive, &Standing::new(Gear::default()), PERIOD, BEFORE)?;
    Ok(OnPlatform { name, scale, stand })
}

pub(crate) fn on_the_platform() -> Result<Vec<OnPlatform>, Failure> {
    let mut all = Vec::new();
    for (case, heave) in CASES {
        all.push(carried(case, &heave.about(HOME[2]), [0.0; 3])?);
    }
    all.push(carried(MARINE, &Superposition::MARINE, FIELD)?);
    Ok(all)
}
