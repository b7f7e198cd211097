//! The platform at sea of chapter 6: its generated equations against Newton, Euler and Archimedes, its sea against the
//! spectrum, waves' forces against the pressure in them, its regulator against Hamilton's matrix, landings on it, and
//! bad input.

mod equations;
mod landings;
mod loads;
mod refused;
mod regulated;
mod seas;

use mbs_platform::marine::excitation::Excitation;
use mbs_platform::marine::hull::Hull;
use mbs_platform::marine::sea::{Sea, Spreading, Wave};
use mbs_platform::marine::spectrum::Jonswap;
use mbs_platform::marine::wind::Wind;
use mbs_tests::random::Random;

/// Random numbers from 0 to below 1.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut random = Random::new(seed);
    move || random.uniform(0.0..1.0)
}

fn hull() -> Hull {
    Hull::new(&mbs_models::marine_platform::Params::default()).expect("it floats")
}

fn sea<const N: usize>(seed: u64) -> Sea<N> {
    let spectrum = Jonswap::new(2.5, 10.0, 3.3).expect("a sea");
    Sea::new(&spectrum, 0.4, Spreading::CosineSquared, uniform(seed)).expect("its waves")
}

/// A sea of one wave.
fn regular(hull: &Hull, wave: Wave) -> Excitation<1> {
    Excitation::new(hull, &Sea { waves: [wave] })
}

fn calm() -> Wind<1> {
    Wind::new(0.0, 0.0, uniform(1)).expect("a calm")
}
