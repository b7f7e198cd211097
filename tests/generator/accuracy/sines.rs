//! `Scalar::sin_cos_all` against 200 bits: within one unit in the last place, dense and at random, at the multiples of
//! π/4 and beside them, and where the polynomials hand over to the library.

use std::f64::consts::FRAC_PI_4;

use mbs_derive::expr::{Function, Value};
use mbs_runtime::{Real, Scalar};
use mbs_tests::random::Random;

use super::measure::exact::{Exact, forgetting};

/// The largest multiples of π/4 for `f64` and `f32`.
const LAST: [u32; 2] = [127_323, 509];

/// The error of sine and cosine, in units in the last place of the exact value; `digits` are those of the type.
fn errors<T: Real>(x: T, digits: i32) -> [f64; 2] {
    let ([sin], [cos]) = T::sin_cos_all([x]);
    [(Function::Sin, sin), (Function::Cos, cos)].map(|(function, found)| {
        forgetting(|| {
            let exact = Exact::constant(x.to_f64()).call(function);
            let unit = 2f64.powf(f64::from(Scalar::exponent(exact.to_f64()) - digits + 1));
            exact.distance(Exact::constant(found.to_f64())) / unit
        })
    })
}

#[track_caller]
fn check<T: Real>(angles: impl Iterator<Item = T>, digits: i32, bound: f64) {
    for x in angles {
        let errors = errors(x, digits);
        assert!(errors.iter().all(|&error| error <= bound), "{x:?} ({}): {errors:?}", x.to_f64());
    }
}

/// Some multiples of π/4, the first ones all, each with its neighbours.
fn multiples(last: u32) -> impl Iterator<Item = f64> {
    let chosen = (0..64).chain((64..=last).step_by(last as usize / 300)).chain([last]);
    chosen.map(|k| f64::from(k) * FRAC_PI_4)
}

#[test]
fn sines_of_doubles_are_within_a_unit() {
    let mut random = Random::new(20);
    let beside = |x: f64| [x.next_down().next_down(), x.next_down(), x, x.next_up(), -x];
    check(multiples(LAST[0]).flat_map(beside), 53, 0.85);
    check((0..1500).map(|i| f64::from(i) * 0.007 - 5.0), 53, 0.85);
    for size in [1.0, 10.0, 1e3, 1e5] {
        check((0..400).map(|_| random.uniform(-size..size)), 53, 0.85);
    }
    let tiny = [5e-324, 1e-310, f64::MIN_POSITIVE, 1e-200, 1e-30, 1e-16, 1e-9, 1e-8, 1e-5];
    check(tiny.into_iter().flat_map(|x| [x, -x]), 53, 0.85);
    // The next angle is the library's.
    check([1e5, 1e5_f64.next_up(), -1e5_f64.next_up(), 1e9, 1e22, 1.7e308].into_iter(), 53, 1.0);
}

#[test]
fn sines_of_floats_are_within_a_unit() {
    let mut random = Random::new(21);
    let beside = |x: f64| [(x as f32).next_down(), x as f32, (x as f32).next_up(), -x as f32];
    check(multiples(LAST[1]).flat_map(beside), 24, 0.85);
    for size in [1.0, 10.0, 400.0] {
        check((0..400).map(|_| random.uniform(-size..size) as f32), 24, 0.85);
    }
    check([1e-45, f32::MIN_POSITIVE, 1e-20, 1e-4, 3e-4].into_iter(), 24, 0.85);
    check([400.0, 400f32.next_up(), 1e5, 1e30].into_iter(), 24, 1.0);
}
