//! Motions that are played back, and landings on them.

use mbs_landing::quadrotor::deck::MovingDeck;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_models::marine_platform::Params;
use mbs_models::{At, Error, Failure};
use mbs_platform::marine::control::{Regulator, Weights};
use mbs_platform::marine::excitation::Excitation;
use mbs_platform::marine::recorded::Recorded;
use mbs_platform::marine::simulation::{AtSea, Moment};
use mbs_platform::marine::wind::Wind;
use mbs_platform::{Coordinates, Motion, PlatformMotion, Superposition};
use mbs_runtime::State;

use super::{hull, sea, uniform};

fn samples(motion: &impl PlatformMotion, step: f64, count: u32) -> Vec<[Coordinates; 3]> {
    (0..count).map(|k| motion.at(step * f64::from(k))).collect()
}

/// Against the motion that was recorded, and rates against differences of what is played back.
#[test]
fn what_was_recorded_is_played_back() {
    let step = 0.05;
    let samples = samples(&Motion::COMBINED, step, 200);
    let recorded = Recorded { step, samples: &samples };
    for k in 0..990 {
        let t = 0.01 * f64::from(k) + 0.003;
        let (found, expected) = (recorded.at(t), Motion::COMBINED.at(t));
        let close = |part: usize, tolerance: f64| {
            (0..6).for_each(|i| {
                let difference = (found[part][i] - expected[part][i]).abs();
                assert!(difference < tolerance, "{t} {part} {i}: {difference:e}");
            });
        };
        close(0, 1e-11);
        close(1, 2e-9);
        close(2, 5e-7);
        let h = 1e-5;
        let [before, after] = [recorded.at(t - h), recorded.at(t + h)];
        for i in 0..6 {
            for part in [0, 1] {
                let slope = (after[part][i] - before[part][i]) / (2.0 * h);
                assert!((slope - found[part + 1][i]).abs() < 1e-8, "{t} {part} {i}");
            }
        }
    }
    let (found, expected) = (recorded.at(7.0 * step).concat(), samples[7].concat());
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    for t in [-1e-9, 9.96, f64::NAN, f64::INFINITY] {
        assert!(recorded.at(t)[0][0].is_nan(), "{t}");
    }
    assert!(recorded.at(9.95)[0][0].is_finite());
    for few in [&samples[..0], &samples[..1]] {
        assert!(Recorded { step, samples: few }.at(0.0)[0][0].is_nan());
    }
}

fn deck<M>(motion: M) -> MovingDeck<M> {
    MovingDeck { motion, base: [12.0, 7.0, -1.1], point: [0.0; 3] }
}

/// On a record of a motion as on the motion itself; where the record ends there is no deck.
#[test]
fn a_record_carries_a_landing() {
    let samples = samples(&Superposition::MARINE, 0.05, 400);
    let record = |samples| Landing::on(Plant::Exact, deck(Recorded { step: 0.05, samples }));
    let itself = Landing::on(Plant::Exact, deck(Superposition::MARINE));
    let start = Landing::initial_state();
    let found = record(&samples).simulate(start, |_, _, _| ()).expect("a touchdown");
    let expected = itself.simulate(start, |_, _, _| ()).expect("a touchdown");
    assert!((found.time - expected.time).abs() < 1e-8, "{} {}", found.time, expected.time);
    assert!((found.horizontal_offset - expected.horizontal_offset).abs() < 1e-7);
    let short = record(&samples[..100]).simulate(start, |_, _, _| ());
    assert!(
        matches!(short, Err(Error { failure: Failure::NotFinite("the deck"), at: Some(At::Time(time)) }) if (4.9..5.0).contains(&time)),
        "{short:?}"
    );
}

/// The vehicle touches down on the deck of the simulated platform, at the point and with the sink rate that it was
/// led with.
#[test]
fn a_quadrotor_lands_on_the_platform_at_sea() {
    let hull = hull();
    let wind = Wind::<20>::new(12.0, 2.0, uniform(8)).expect("a wind");
    let mut at_sea = AtSea::new(&hull.params, Excitation::new(&hull, &sea::<60>(9)), wind).expect("a platform");
    at_sea.regulator = Some(Regulator::new(&Params::default(), &Weights::default()).expect("a regulator"));
    let mut moments = Vec::new();
    at_sea.simulate(State::new([0.0; 4], [0.0; 4]), 0.05, 100.0, |moment| moments.push(*moment)).expect("a motion");
    let samples: Vec<_> = moments[1000..].iter().map(Moment::in_six).collect();
    let point = [4.0, -3.0, 9.4];
    let motion = Recorded { step: 0.05, samples: &samples };
    let landing = Landing::on(Plant::Exact, MovingDeck { motion, base: [8.0, 10.0, -9.4], point });
    let end = landing.simulate(Landing::initial_state(), |_, _, _| ()).expect("a touchdown");
    // 12 s, and 0.25 m at 0.2 m/s.
    assert!((end.time - 13.25).abs() < 0.05, "{}", end.time);
    assert!((end.relative_velocity + 0.2).abs() < 0.02 && end.horizontal_offset < 0.1, "{end:?}");
    // The deck's velocity is that of the mass centre's heave and of the point's lever.
    let moment = &moments[1000 + (end.time / 0.05).round() as usize];
    let vertical = moment.qd[0] - point[0] * moment.qd[2] + point[1] * moment.qd[1];
    assert!((end.deck.velocity[2] - vertical).abs() < 0.03, "{} {vertical}", end.deck.velocity[2]);
}
