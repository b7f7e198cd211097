//! Many landings: random numbers of their own, all at once, and what they come to together.

use indicatif::{ProgressBar, ProgressStyle};
use mbs_runtime::State;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::Failure;

/// The period of all sampled controllers, of RK4 beside them, and of gusts \[s\].
pub const PERIOD: f64 = 0.002;
/// The standard deviation of the mass, relative.
pub const MASS: f64 = 0.02;
/// The standard deviation of each principal inertia, relative.
pub const INERTIA: f64 = 0.03;
/// The standard deviation of the drag coefficient, relative.
pub const DRAG: f64 = 0.1;
/// The deviation of each component of a steady wind \[m/s\]; the vertical one is a tenth of it.
pub const WIND: f64 = 1.5;
/// The deviations of the first state \[m\], \[rad\], \[m/s\], \[rad/s\].
pub const START: [f64; 4] = [0.3, 0.035, 0.2, 0.05];
/// The deviations of what the sensors say, white, in the units of [`START`].
pub const SEEN: [f64; 4] = [0.005, 0.001, 0.01, 0.002];

/// What such landings rest on, beside what every landing does.
pub const ASSUMED: [&str; 2] = ["landing.sampling", "landing.scatter"];

/// Normal deviates of a seed.
pub fn deviates(seed: u64) -> impl FnMut() -> f64 {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    move || StandardNormal.sample(&mut random)
}

/// A state with deviates of place, angles, velocity and rates; their standard deviations \[m\], \[rad\], \[m/s\],
/// \[rad/s\].
pub fn around(state: &State<[f64; 6]>, deviations: [f64; 4], mut normal: impl FnMut() -> f64) -> State<[f64; 6]> {
    let mut around = *state;
    for i in 0..3 {
        around.q[i] += deviations[0] * normal();
        around.q[3 + i] += deviations[1] * normal();
        around.qd[i] += deviations[2] * normal();
        around.qd[3 + i] += deviations[3] * normal();
    }
    around
}

/// Landings with the seeds 0, 1, …, the same for any number of threads; a terminal shows how far they are.
pub fn flown<T: Send>(count: u32, landing: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} landings, {eta} to go").expect("a template");
    let progress = ProgressBar::new(u64::from(count)).with_style(style);
    let flown = |seed| {
        let landing = landing(seed);
        progress.inc(1);
        landing
    };
    let landings = (0..u64::from(count)).into_par_iter().map(flown).collect();
    progress.finish_and_clear();
    landings
}

/// Runs what follows on this number of threads, or on as many as there are cores.
///
/// # Errors
/// Threads that the system refuses.
pub fn use_threads(threads: Option<u32>) -> Result<(), Failure> {
    match threads {
        Some(threads) => Ok(rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()?),
        None => Ok(()),
    }
}

/// Mean and standard deviation.
pub fn spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0)).sqrt()]
}
