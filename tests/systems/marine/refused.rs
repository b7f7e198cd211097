//! Seas, winds and platforms that there are not.

use mbs_models::At;
use mbs_models::marine_platform::Params;
use mbs_platform::marine::hull::Hull;
use mbs_platform::marine::sea::{Sea, Spreading};
use mbs_platform::marine::simulation::{AtSea, DEPTH};
use mbs_platform::marine::spectrum::Jonswap;
use mbs_platform::marine::wind::Wind;
use mbs_runtime::State;

use super::{calm, hull, regular, uniform};
use mbs_platform::marine::excitation::unit_wave;

/// The error, as it is printed, names the number.
#[track_caller]
fn says<T: std::fmt::Debug>(result: Result<T, impl std::error::Error>, words: &str) {
    let text = result.expect_err("refused").to_string();
    assert!(text.contains(words), "{text}");
}

#[test]
fn seas_that_there_are_not() {
    for (height, period, peakedness, words) in [
        (0.0, 10.0, 3.3, "significant wave height must be positive, it is 0"),
        (-1.0, 10.0, 3.3, "significant wave height must be positive, it is -1"),
        (f64::NAN, 10.0, 3.3, "significant wave height must be positive and finite, it is NaN"),
        (2.0, 0.0, 3.3, "peak period must be positive, it is 0"),
        (2.0, f64::INFINITY, 3.3, "peak period must be positive and finite, it is inf"),
        (2.0, 10.0, 0.5, "peakedness must be between 1 and 7, it is 0.5"),
        (2.0, 10.0, f64::NAN, "peakedness must be between 1 and 7, it is NaN"),
        (6.0, 5.0, 3.3, "steepness 2π Hs/(g Tp²) of the waves must be at most 0.0666"),
    ] {
        says(Jonswap::new(height, period, peakedness), words);
    }
    // Just below and just above 1/15 at 8 s and 1/25 at 15 s.
    for (period, limit) in [(8.0_f64, 15.0), (15.0, 25.0), (20.0, 25.0), (4.0, 15.0)] {
        let height = 9.80665 * period * period / (2.0 * std::f64::consts::PI * limit);
        assert!(Jonswap::new(0.999 * height, period, 3.3).is_ok());
        says(Jonswap::new(1.001 * height, period, 3.3), "steepness 2π Hs/(g Tp²) of the waves must be at most");
    }
    let spectrum = Jonswap::new(2.5, 10.0, 3.3).expect("a sea");
    says(Sea::<3>::new(&spectrum, f64::NAN, Spreading::None, uniform(1)), "direction of the waves must be finite");
    says(Sea::<0>::new(&spectrum, 0.0, Spreading::None, uniform(1)), "number of waves must be positive");
    for number in [1.0, -0.1, f64::NAN] {
        says(Sea::<3>::new(&spectrum, 0.0, Spreading::None, || number), "random number must be between 0 and 1");
        says(Wind::<3>::new(5.0, 0.0, || number), "random number must be between 0 and 1");
    }
}

#[test]
fn winds_that_there_are_not() {
    says(Wind::<3>::new(-1.0, 0.0, uniform(1)), "mean wind must not be negative, it is -1");
    says(Wind::<3>::new(f64::NAN, 0.0, uniform(1)), "mean wind must be finite and not negative");
    says(Wind::<3>::new(1.0, f64::INFINITY, uniform(1)), "direction of the wind must be finite");
    says(Wind::<0>::new(1.0, 0.0, uniform(1)), "number of gusts must be positive");
    assert_eq!(calm().speed(12.3), 0.0);
}

#[test]
fn platforms_that_do_not_float() {
    let params = Params::default();
    let refused = |params: Params, words: &str| says(Hull::new(&params), words);
    refused(Params { m: f64::NAN, ..params }, "m must be positive and finite, it is NaN");
    refused(Params { inertias: [1.0, 0.0, 1.0], ..params }, "inertias[1] must be positive, it is 0");
    refused(Params { heave_damping: -1.0, ..params }, "heave_damping must not be negative, it is -1");
    // So light that it lies on its pontoons, and so high that it turns over.
    refused(Params { m: 300e3, ..params }, "draught of the columns afloat must be positive, it is -");
    refused(Params { mass_centre: 4.2, ..params }, "must be positive, it is -");
    assert!(Hull::new(&Params { mass_centre: 4.1, ..params }).is_ok());
}

#[test]
fn runs_that_lead_nowhere() {
    let hull = hull();
    let at_sea = AtSea::new(&hull.params, regular(&hull, unit_wave(0.6, 0.0)), calm()).expect("a platform");
    let still = State::new([0.0; 4], [0.0; 4]);
    let from = |q: [f64; 4]| at_sea.simulate(State::new(q, [0.0; 4]), 0.1, 1.0, |_| ());
    says(from([f64::NAN, 0.0, 0.0, 0.0]), "coordinates[0] must be finite, it is NaN");
    says(at_sea.simulate(still, 0.0, 1.0, |_| ()), "period must be positive, it is 0");
    says(at_sea.simulate(still, 0.1, f64::NAN, |_| ()), "end must be finite and not negative");
    says(at_sea.simulate(still, 1e-7, 10.0, |_| ()), "end must be between 0 and 1");
    // Out of the water, with the deck in it, and turned over so far that one column is.
    for (q, column) in [([5.1, 0.0, 0.0, 0.0], 0), ([-5.1, 0.0, 0.0, 0.0], 0), ([0.0, 0.7, 0.0, 0.0], 0)] {
        let error = from(q).expect_err("off the columns");
        let named = error.invalid().expect("a number");
        assert_eq!((named.parameter, named.index, error.at), (DEPTH, Some(column), Some(At::Time(0.0))), "{q:?}");
    }
    let mut powerless = at_sea.clone();
    powerless.thrusters.rate[3] = 0.0;
    says(powerless.simulate(still, 0.1, 1.0, |_| ()), "rate of thrust[3] must be positive, it is 0");
}
