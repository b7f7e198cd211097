//! The same landings on the Stewart platform of chapter 4, which its legs drive, against those on a deck that moves
//! exactly as it is to.
//!
//! The heave of the thesis is not one that the platform can make: about its home it would pass through its own base,
//! and legs of any length would have to be longer than they are. So each landing is made twice: with the motion in
//! full, on a platform that is raised until no leg is too short, where the legs are as long as it takes; and about home
//! with the motion scaled to what stroke, speed and force of the legs allow.

use crate::Failure;
use mbs_landing::quadrotor::deck::MovingDeck;
use mbs_landing::quadrotor::driven::{Drive, DrivenMoment, DrivenTouchdown};
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_platform::limits::{LegState, Quantity, Survey};
use mbs_platform::{HOME, Platform, PlatformMotion, Superposition};
use mbs_runtime::control::ComputedTorque;
use serde_json::{Value, json};

use super::flight::{KEPT, over_base};
use super::members::PERIOD;

/// Of the errors of the platform \[rad/s\].
const NATURAL_FREQUENCY: f64 = 8.0;
/// The motions are looked at for so long, the period of the heaves of the thesis, this often \[s\].
const DURATION: f64 = 40.0;
const STEP: f64 = 0.02;
/// The resolution of middles \[m\].
const RESOLUTION: f64 = 1e-3;

/// The platform with nothing on it yet.
pub fn platform() -> Result<Platform, Failure> {
    Ok(Platform::default().with_payload(0.0)?)
}

/// The factor by which a motion about home keeps the limits of the legs.
pub fn admissible<const K: usize>(platform: &Platform, motion: &Superposition<K>) -> Result<f64, Failure> {
    Ok(platform.admissible_scale(motion, DURATION, STEP)?)
}

/// A landing on the driven platform and the same one on an exact deck.
pub struct Comparison<const K: usize> {
    /// The scale of the motion.
    pub scale: f64,
    /// The motion, over the base.
    pub motion: Superposition<K>,
    /// The deck moves exactly, the controller acts in continuous time.
    pub exact: Touchdown,
    /// The deck moves exactly, the controller is sampled.
    pub sampled: Touchdown,
    /// The legs drive the deck, both controllers are sampled.
    pub driven: DrivenTouchdown,
    /// Every 10 ms.
    pub moments: Vec<DrivenMoment>,
}

/// What the Stewart platform makes of a motion.
pub struct OnPlatform<const K: usize> {
    /// Of the thesis, or that of the deck at sea.
    pub case: &'static str,
    /// How low the motion in full would come about home \[m\]: the base is at zero.
    pub lowest: f64,
    /// The motion in full, on a platform that is raised.
    pub full: Comparison<K>,
    /// About home, scaled.
    pub scaled: Comparison<K>,
}

impl<const K: usize> OnPlatform<K> {
    /// Of a motion about home, with the point of the platform that is landed on.
    pub fn of(case: &'static str, motion: &Superposition<K>, point: [f64; 3]) -> Result<Self, Failure> {
        let platform = platform()?;
        let raised = raised(&platform, motion)?;
        let scale = admissible(&platform, motion)?;
        Ok(OnPlatform {
            case,
            lowest: samples().map(|t| motion.at(t)[0][2]).fold(f64::INFINITY, f64::min),
            full: Comparison::of(&platform, raised, 1.0, point)?,
            scaled: Comparison::of(&platform, motion.scaled(scale), scale, point)?,
        })
    }

    /// Both, with their names in JSON.
    pub fn comparisons(&self) -> [(&'static str, &Comparison<K>); 2] {
        [("full", &self.full), ("scaled", &self.scaled)]
    }
}

fn samples() -> impl Iterator<Item = f64> {
    (0..=(DURATION / STEP) as u32).map(|i| f64::from(i) * STEP)
}

/// The motion about a pose above home, as low as it can be without a leg shorter than the shortest.
fn raised<const K: usize>(platform: &Platform, motion: &Superposition<K>) -> Result<Superposition<K>, Failure> {
    let about = |middle: f64| motion.about(&[0.0, 0.0, middle, 0.0, 0.0, 0.0]);
    let shortest = |middle: f64| -> Result<f64, Failure> {
        let motion = about(middle);
        samples().try_fold(f64::INFINITY, |least, t| {
            Ok(platform.lengths(&motion.at(t)[0])?.into_iter().fold(least, f64::min))
        })
    };
    let (mut low, mut high) = (HOME[2], HOME[2]);
    while shortest(high)? < platform.limits.shortest {
        (low, high) = (high, high + 1.0);
    }
    while high - low > RESOLUTION {
        let middle = 0.5 * (low + high);
        if shortest(middle)? < platform.limits.shortest { low = middle } else { high = middle }
    }
    Ok(about(high))
}

impl<const K: usize> Comparison<K> {
    fn of(platform: &Platform, motion: Superposition<K>, scale: f64, point: [f64; 3]) -> Result<Self, Failure> {
        let landing: Landing<MovingDeck<_>> = Landing::on(Plant::Exact, over_base(motion, point));
        let exact = landing.simulate(Landing::initial_state(), |_, _, _| ())?;
        let sampled = landing.simulate_sampled(Landing::initial_state(), PERIOD, |_, state| *state)?;
        let drive =
            Drive { platform: platform.clone(), control: ComputedTorque::critically_damped(NATURAL_FREQUENCY)? };
        let (mut moments, mut seen) = (Vec::new(), 0);
        let driven = landing.simulate_driven(Landing::initial_state(), &drive, PERIOD, |moment| {
            if seen % KEPT == 0 {
                moments.push(*moment);
            }
            seen += 1;
        })?;
        Ok(Comparison { scale, motion, exact, sampled, driven, moments })
    }

    /// By how much a landing is another one than that on the exact deck: time \[s\], relative velocity \[m/s\], offset
    /// \[m\].
    fn difference(&self, end: &Touchdown) -> [f64; 3] {
        let results = |end: &Touchdown| [end.time, end.relative_velocity, end.horizontal_offset];
        let (changed, exact) = (results(end), results(&self.exact));
        std::array::from_fn(|i| changed[i] - exact[i])
    }

    /// As JSON has it: SI units, and degrees where the name says so.
    pub fn to_json(&self) -> Value {
        let difference = |end: &Touchdown| {
            let [time, velocity, offset] = self.difference(end);
            json!({ "touchdown_time": time, "relative_velocity": velocity, "horizontal_offset": offset })
        };
        let DrivenTouchdown { touchdown, greatest_error, last_error, survey, .. } = &self.driven;
        json!({
            "scale": self.scale,
            "middle": self.motion.mean()[2],
            "touchdown_time": touchdown.time,
            "relative_velocity": touchdown.relative_velocity,
            "horizontal_offset": touchdown.horizontal_offset,
            "difference": difference(touchdown),
            "difference_of_sampling": difference(&self.sampled),
            "tracking_error_max": greatest_error.distance,
            "tracking_error_max_deg": greatest_error.angle.to_degrees(),
            "tracking_error_touchdown": last_error.distance,
            "leg_length": survey.length,
            "leg_speed_max": survey.speed,
            "leg_force_max": survey.force,
            "within_limits": survey.is_clear(),
            "out_of_stroke": worst(survey, &[Quantity::TooShort, Quantity::TooLong]),
            "over_speed": worst(survey, &[Quantity::Speed]),
            "over_force": worst(survey, &[Quantity::Force]),
            "condition_max": survey.condition.0,
        })
    }

    /// What became of the motion, in words.
    pub fn summary(&self, case: &str, name: &str) -> String {
        let DrivenTouchdown { touchdown: end, greatest_error, last_error, survey, .. } = &self.driven;
        let difference = |end: &Touchdown| {
            let [time, velocity, offset] = self.difference(end);
            format!("{time:+.2e} s, {velocity:+.2e} m/s, {offset:+.1e} m")
        };
        let [shortest, longest] = survey.length;
        let excess = [
            ("stroke", "m", worst(survey, &[Quantity::TooShort, Quantity::TooLong])),
            ("speed", "m/s", worst(survey, &[Quantity::Speed])),
            ("force", "N", worst(survey, &[Quantity::Force])),
        ];
        let excess: Vec<String> = excess
            .iter()
            .filter(|(_, _, worst)| *worst > 0.0)
            .map(|(what, unit, worst)| format!("{what} by {worst:.3} {unit}"))
            .collect();
        let limits =
            if excess.is_empty() { "all limits kept".to_string() } else { format!("BEYOND {}", excess.join(", ")) };
        format!(
            "{case:<6} {name:<6} motion × {:.3} about {:.3} m: touchdown {:.5} s, {:.5} m/s, {:.2e} m off\n\
             {:14}difference {}; by sampling alone {}\n\
             {:14}platform off by up to {:.4} m and {:.2}°, at the touchdown {:.1e} m\n\
             {:14}legs {shortest:.2} to {longest:.2} m, up to {:.2} m/s and {:.0} N; {limits}\n",
            self.scale,
            self.motion.mean()[2],
            end.time,
            end.relative_velocity,
            end.horizontal_offset,
            "",
            difference(end),
            difference(&self.sampled),
            "",
            greatest_error.distance,
            greatest_error.angle.to_degrees(),
            last_error.distance,
            "",
            survey.speed,
            survey.force,
        )
    }
}

/// The greatest excess over these limits; zero where they are kept.
fn worst(survey: &Survey, quantities: &[Quantity]) -> f64 {
    let excesses = survey.excesses.as_flattened().iter().flatten();
    excesses.filter(|e| quantities.contains(&e.worst.quantity)).map(|e| e.worst.excess()).fold(0.0, f64::max)
}

/// Lengths, rates and forces of the legs along the motion in full, exactly as it is to be, every 10 ms up to a time
/// \[s\].
pub fn legs<const K: usize>(motion: &Superposition<K>, end: f64) -> Result<Vec<(f64, LegState)>, Failure> {
    let platform = platform()?;
    let moments = (0..).map(|i| 0.01 * f64::from(i)).take_while(|&t| t <= end);
    let state = |t: f64| {
        let [q, qd, qdd] = motion.at(t);
        platform.leg_state(&q, &qd, &qdd).map(|legs| (t, legs))
    };
    Ok(moments.map(state).collect::<Result<_, _>>()?)
}

/// The least and the greatest force \[N\].
pub fn force_range(legs: &[(f64, LegState)]) -> [f64; 2] {
    let forces = legs.iter().flat_map(|(_, legs)| legs.force);
    forces.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], force| [a.min(force), b.max(force)])
}
