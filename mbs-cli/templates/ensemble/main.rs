//! A thousand pendulums whose masses, lengths and friction are not quite known: `ensemble.csv` has
//! mean and spread of their angles over time, `motion.svg` shows some of them in a browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, IntegrationError, Integrator, State, accelerations};
use rayon::prelude::*;

mbs_runtime::include_mechanism!("ensemble");
use ensemble::{Ensemble, Params};

const MEMBERS: u64 = 1000;
/// Relative standard deviations of what is random.
const SPREAD: f64 = 0.03;

fn main() -> Result<(), Box<dyn Error>> {
    let times: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.05).collect();
    // Members are independent: as many at once as there are cores, and in order, whoever comes
    // first.
    let members: Vec<Vec<[f64; 3]>> = (0..MEMBERS)
        .into_par_iter()
        .map(|number| run(number, &times))
        .collect::<Result<_, _>>()?;

    let mut table = String::from("t,mean,deviation,least,greatest\n");
    let mut last = 0.0;
    for (i, t) in times.iter().enumerate() {
        let angles = || members.iter().map(|member| member[i][0]);
        let mean = angles().sum::<f64>() / MEMBERS as f64;
        let deviation = (angles().map(|angle| (angle - mean).powi(2)).sum::<f64>()
            / (MEMBERS - 1) as f64)
            .sqrt();
        let (least, greatest) = (
            angles().fold(f64::INFINITY, f64::min),
            angles().fold(f64::NEG_INFINITY, f64::max),
        );
        table += &format!("{t},{mean},{deviation},{least},{greatest}\n");
        last = deviation;
    }
    std::fs::write("ensemble.csv", table)?;
    let line = |&[_, x, z]: &[f64; 3]| vec![[0.0, 0.0], [x, z]];
    let frames: Vec<picture::Frame> = (0..times.len())
        .map(|i| {
            members
                .iter()
                .take(20)
                .map(|member| line(&member[i]))
                .collect()
        })
        .collect();
    picture::write("motion.svg", &frames, 10.0)?;
    println!(
        "{MEMBERS} members, after 10 s they differ by {last:.3} rad; ensemble.csv, and motion.svg for a browser"
    );
    Ok(())
}

/// The motion of one member, always the same: angle, and place of the bob.
fn run(number: u64, times: &[f64]) -> Result<Vec<[f64; 3]>, IntegrationError> {
    let nominal = Params::<f64>::default();
    let mut random = Random(number);
    let pendulum = Ensemble::new(Params {
        mass: nominal.mass * random.near_one(),
        length: nominal.length * random.near_one(),
        friction: nominal.friction * random.near_one(),
        ..nominal
    });
    let mut state = State {
        q: [1.0],
        qd: [0.0],
    };
    let mut rows = Vec::with_capacity(times.len());
    Dop853::new(1e-8, 1e-8).sample(
        accelerations(&pendulum, |_, _, _| []),
        0.0,
        times,
        &mut state,
        |_, state| {
            let [x, _, z] = pendulum.tip(&state.q);
            rows.push([state.q[0], x, z]);
        },
    )?;
    Ok(rows)
}

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, *Fast splittable pseudorandom number generators*,
/// OOPSLA 2014).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Twelve uniform numbers are nearly normal, with the variance 1, and never far off.
    fn near_one(&mut self) -> f64 {
        let normal = (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0;
        1.0 + SPREAD * normal
    }
}
