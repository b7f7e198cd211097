//! How sure is a landing where mass, drag, wind and sensors are not what the controller believes?
//!
//! Many landings of case I, each with a vehicle, a wind and a start of its own, under a controller that is sampled at
//! 500 Hz and sees a noisy state. Look at the touchdown's velocity: what a wrong mass does to it, the controller does
//! not notice.
//!
//! The members are simulated in parallel; each has its own random numbers, so that the digest of all results is the
//! same for any number of threads. `--members N` says how many there are, `--threads N` by how many threads. `--out
//! DIR` writes all results as CSV, and their histograms (SVG and PNG).

use mbs_examples::{print, println};
use mbs_models::Error;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::State;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde_json::{Value, json};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many landings; statistics need two.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(2..))]
    members: u32,
    /// By how many threads; as many as there are cores without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    threads: Option<u32>,
}

/// The period of the controller and of RK4 \[s\].
const PERIOD: f64 = 1.0 / 500.0;

/// Standard deviations of what is scattered.
mod scatter {
    /// Relative.
    pub(super) const MASS: f64 = 0.02;
    pub(super) const INERTIA: f64 = 0.03;
    pub(super) const DRAG: f64 = 0.1;
    /// The deviation of each component of a steady wind \[m/s\]; the vertical one is a tenth of it.
    pub(super) const WIND: f64 = 1.5;
    /// The deviations of the first state \[m\], \[rad\], \[m/s\], \[rad/s\].
    pub(super) const POSITION: f64 = 0.3;
    pub(super) const ANGLE: f64 = 0.035;
    pub(super) const VELOCITY: f64 = 0.2;
    pub(super) const RATE: f64 = 0.05;
    /// The deviations of what the sensors say, white \[m\], \[rad\], \[m/s\], \[rad/s\].
    pub(super) const SEEN_POSITION: f64 = 0.005;
    pub(super) const SEEN_ANGLE: f64 = 0.001;
    pub(super) const SEEN_VELOCITY: f64 = 0.01;
    pub(super) const SEEN_RATE: f64 = 0.002;
}

/// What the landings rest on, beside what every landing does.
const ASSUMED: [&str; 2] = ["landing.sampling", "landing.scatter"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("landing_monte_carlo.rs"));
    let members = arguments.options.members as usize;
    if let Some(threads) = arguments.options.threads.map(|threads| threads as usize) {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let progress = ProgressBar::new(members as u64)
        .with_style(ProgressStyle::with_template("{wide_bar} {pos}/{len} landings, {eta} to go")?);
    let start = Instant::now();
    let landings: Vec<Result<Touchdown, Error>> = (0..members as u64)
        .into_par_iter()
        .map(|seed| {
            let landing = member(seed);
            progress.inc(1);
            landing
        })
        .collect();
    progress.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();

    let touchdowns: Vec<&Touchdown> = landings.iter().flatten().collect();
    if touchdowns.len() < 2 {
        return Err(Failure::new(format!("{} of {members} members touched down", touchdowns.len())));
    }
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
        let header = ["member", "touchdown_time_s", "relative_velocity_m_s", "horizontal_offset_m"].map(String::from);
        let row = |(member, end): (usize, &Result<Touchdown, Error>)| {
            end.as_ref().ok().map(|end| [&[member as f64][..], &results(end)].concat())
        };
        output::write_table(folder, "landings", &header, landings.iter().enumerate().filter_map(row))?;
        output::write_figure(folder, "landings", &figure(&touchdowns), &[assumed::LANDING, &ASSUMED].concat())?;
    }
    let [time, velocity, offset] =
        [0, 1, 2].map(|i| Statistics::of(&touchdowns.iter().map(|end| results(end)[i]).collect::<Vec<_>>()));
    let failed = members - touchdowns.len();
    if arguments.json {
        let digest = format!("{:016x}", digest(&touchdowns));
        println!(
            "{}",
            json!({
                "members": members,
                "failed": failed,
                "touchdown_time": time.to_json(),
                "relative_velocity": velocity.to_json(),
                "horizontal_offset": offset.to_json(),
                "digest": digest,
                "assumed": assumed::to_json(&[assumed::LANDING, &ASSUMED].concat()),
            })
        );
    } else {
        println!(
            "{members} landings in {seconds:.1} s on {} threads, {failed} without a touchdown",
            rayon::current_num_threads()
        );
        println!("                      mean        standard deviation   95 % confidence of the mean");
        for (name, unit, statistics) in
            [("touchdown time", "s", time), ("relative velocity", "m/s", velocity), ("horizontal offset", "m", offset)]
        {
            let Statistics { mean, deviation, .. } = statistics;
            let [low, high] = statistics.confidence();
            println!("{name:<18} {mean:>10.5} {unit:<4} {deviation:>14.5} {unit:<4}    {low:.5} to {high:.5} {unit}");
        }
        print!("{}", assumed::text(&[assumed::LANDING, &ASSUMED].concat()));
    }
    Ok(())
}

/// What is measured at a touchdown, with its unit.
const RESULTS: [&str; 3] = ["touchdown time [s]", "relative velocity [m/s]", "horizontal offset [m]"];

/// How many landings ended where, for each result.
fn figure(touchdowns: &[&Touchdown]) -> Figure {
    let panel = |(i, name): (usize, &&str)| {
        let values: Vec<f64> = touchdowns.iter().map(|end| results(end)[i]).collect();
        let (edges, counts) = histogram(&values);
        let outline = edges.windows(2).zip(&counts).flat_map(|(edges, &count)| {
            let count = count as f64;
            [(edges[0], count), (edges[1], count)]
        });
        let [first, last] = [edges[0], edges[edges.len() - 1]];
        let outline = [(first, 0.0)].into_iter().chain(outline).chain([(last, 0.0)]).collect();
        Panel::curves([*name, "landings"], first..last, vec![Line::new("", outline)])
    };
    let title = format!("{} landings", touchdowns.len());
    Figure { title, size: (1000, 1000), panels: RESULTS.iter().enumerate().map(panel).collect() }
}

/// The edges of bins of equal width, and how many values are in each: as many bins as the root of the values, but 60 at
/// most.
fn histogram(values: &[f64]) -> (Vec<f64>, Vec<usize>) {
    let bins = ((values.len() as f64).sqrt() as usize).clamp(1, 60);
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    // Where all are equal there is one bin that holds them.
    let width = if high > low { (high - low) / bins as f64 } else { 1.0 };
    let mut counts = vec![0; bins];
    values.iter().for_each(|x| counts[(((x - low) / width) as usize).min(bins - 1)] += 1);
    ((0..=bins).map(|k| low + width * k as f64).collect(), counts)
}

/// Normal deviates of one member.
struct Deviates(Pcg64Mcg);

impl Deviates {
    fn next(&mut self, deviation: f64) -> f64 {
        let normal: f64 = StandardNormal.sample(&mut self.0);
        deviation * normal
    }

    /// A state with deviations of position, angles, and their rates.
    fn around(&mut self, state: &State<[f64; 6]>, deviations: [f64; 4]) -> State<[f64; 6]> {
        let mut around = *state;
        for i in 0..3 {
            around.q[i] += self.next(deviations[0]);
            around.q[3 + i] += self.next(deviations[1]);
            around.qd[i] += self.next(deviations[2]);
            around.qd[3 + i] += self.next(deviations[3]);
        }
        around
    }
}

/// A landing with a vehicle, a wind, a start and sensors of its own; the controller knows the vehicle as it was
/// designed.
fn member(seed: u64) -> Result<Touchdown, Error> {
    let mut deviates = Deviates(Pcg64Mcg::seed_from_u64(seed));
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let designed = *landing.vehicle.params();
    let mut relative = |value: f64, deviation: f64| value * deviates.next(deviation).exp();
    landing.vehicle = QuadrotorEuler::new(Params {
        m: relative(designed.m, scatter::MASS),
        inertias: designed.inertias.map(|inertia| relative(inertia, scatter::INERTIA)),
        drag_coefficient: relative(designed.drag_coefficient, scatter::DRAG),
        ..designed
    });
    landing.wind = [scatter::WIND, scatter::WIND, 0.1 * scatter::WIND].map(|deviation| deviates.next(deviation));
    let start = [scatter::POSITION, scatter::ANGLE, scatter::VELOCITY, scatter::RATE];
    let start = deviates.around(&Landing::initial_state(), start);
    let seen = [scatter::SEEN_POSITION, scatter::SEEN_ANGLE, scatter::SEEN_VELOCITY, scatter::SEEN_RATE];
    landing.simulate_sampled(start, PERIOD, |_, state| deviates.around(state, seen))
}

fn results(end: &Touchdown) -> [f64; 3] {
    [end.time, end.relative_velocity, end.horizontal_offset]
}

/// Mean and deviation of a sample.
#[derive(Clone, Copy)]
struct Statistics {
    count: usize,
    mean: f64,
    deviation: f64,
}

impl Statistics {
    fn of(values: &[f64]) -> Self {
        let count = values.len();
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Statistics { count, mean, deviation: (squares / (count as f64 - 1.0)).sqrt() }
    }

    /// The confidence interval of the mean, by the normal distribution.
    fn confidence(&self) -> [f64; 2] {
        let half = 1.959_963_984_540_054 * self.deviation / (self.count as f64).sqrt();
        [self.mean - half, self.mean + half]
    }

    fn to_json(self) -> Value {
        json!({ "mean": self.mean, "sd": self.deviation, "ci95": self.confidence() })
    }
}

/// Fowler, Noll and Vo's hash (FNV-1a, 64 bits) of the bits of all results.
fn digest(touchdowns: &[&Touchdown]) -> u64 {
    let bytes = touchdowns.iter().flat_map(|end| results(end)).flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
