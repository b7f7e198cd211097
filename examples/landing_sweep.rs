//! How hard does a quadrotor land where mass, inertia, drag, wind, start, sensors and sea are drawn by a plan?
//!
//! The plan is `examples/ensembles/landing.toml`, or the one of `--plan FILE`, such as `landing_seas.toml` beside it;
//! each member is a closure of its values with generated code, the landing's controller at 500 Hz, and a noisy sensor,
//! whose random numbers are the member's own. The table goes to `--table FILE`, which a killed run continues.
//! `--compare` measures what the ensemble costs beside the bare loop over its closures, on one thread.

use std::path::PathBuf;
use std::time::Instant;

use mbs_ensemble::statistics::{Moments, quantile, quantile_interval};
use mbs_ensemble::{Design, Member, Share, Sweep};
use mbs_examples::dispersion::Dispersion;
use mbs_examples::{Failure, arguments::Arguments, assumed, println};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::State;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::rand_core::SeedableRng;
use serde_json::{Value, json};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// Another plan, of the same variables.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// How many landings, instead of as many as the plan says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    members: Option<u64>,
    /// Where the table goes.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// On how many threads; as many as there are cores without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Measure the ensemble beside the bare loop.
    #[arg(long)]
    compare: bool,
}

/// The period of the controller and of RK4 \[s\].
const PERIOD: f64 = 1.0 / 500.0;

/// The deviations of what the sensors say, white \[m\], \[rad\], \[m/s\], \[rad/s\].
const SEEN: [f64; 4] = [0.005, 0.001, 0.01, 0.002];

/// What the plan may vary, with units.
const VARIABLES: [(&str, &str); 12] = [
    ("mass", "kg"),
    ("inertia", "1"),
    ("drag", "1"),
    ("wind_x", "m/s"),
    ("wind_y", "m/s"),
    ("wind_z", "m/s"),
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    // What the sensors' noise, the deck's amplitudes and its frequencies are multiplied by.
    ("sensors", "1"),
    ("sea", "1"),
    ("swell", "1"),
];

/// What is measured at a touchdown.
const QUANTITIES: [(&str, &str); 3] =
    [("touchdown_time", "s"), ("relative_velocity", "m/s"), ("horizontal_offset", "m")];

/// What the landings rest on, beside what every landing does.
const ASSUMED: [&str; 2] = ["landing.sampling", "landing.scatter"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("landing_sweep.rs"));
    let options = &arguments.options;
    let (name, text) = match &options.plan {
        Some(path) => (path.display().to_string(), std::fs::read_to_string(path)?),
        None => ("landing.toml".to_string(), include_str!("ensembles/landing.toml").to_string()),
    };
    let members = options.members;
    let dispersion = Dispersion::planned("landing_sweep", (&name, &text), members, VARIABLES, &QUANTITIES)?;
    let landings = Landings::of(&dispersion.design)?;
    if options.compare {
        let folder = tempfile::tempdir()?;
        return compare(&landings, &dispersion.sweep(folder.path().join("landings.csv")));
    }
    let land = |member: &Member| landings.land(member);
    let (outcome, columns) = dispersion.columns(options.table.as_deref(), options.threads.map(usize::from), &land)?;
    let (object, text) = report(&outcome, columns);
    arguments.answer(object, &text, &[assumed::LANDING, &ASSUMED].concat());
    Ok(())
}

/// Where the values of a member go.
struct Landings {
    places: Vec<usize>,
}

impl Landings {
    fn of(design: &Design) -> Result<Self, Failure> {
        let place = |variable: &mbs_ensemble::design::Variable| VARIABLES.iter().position(|(n, _)| *n == variable.name);
        let places = design.variables().iter().map(place).collect::<Option<_>>();
        Ok(Landings { places: places.ok_or_else(|| Failure::new("the plan varies something unknown"))? })
    }

    /// A landing with its touchdown's quantities; the controller knows the vehicle as it was designed.
    fn land(&self, member: &Member) -> Result<Vec<f64>, String> {
        let calm = Landing::new(Plant::Exact, Heave::CASE_I);
        let designed = *calm.vehicle.params();
        let mut values = [designed.m, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        self.places.iter().zip(&member.values).for_each(|(place, value)| values[*place] = *value);
        let [m, inertia, drag, wind_x, wind_y, wind_z, x, y, z, sensors, sea, swell] = values;
        let heave = Heave {
            amplitude: Heave::CASE_I.amplitude.map(|amplitude| sea * amplitude),
            frequency: Heave::CASE_I.frequency.map(|frequency| swell * frequency),
        };
        let mut landing = Landing::new(Plant::Exact, heave);
        landing.vehicle = QuadrotorEuler::new(Params {
            m,
            inertias: designed.inertias.map(|of| inertia * of),
            drag_coefficient: drag * designed.drag_coefficient,
            ..designed
        });
        landing.wind = [wind_x, wind_y, wind_z];
        let mut start = Landing::initial_state();
        [x, y, z].iter().enumerate().for_each(|(i, off)| start.q[i] += off);
        let mut random = rand_pcg::Pcg64Mcg::from_rng(&mut member.random());
        let end = landing
            .simulate_sampled(start, PERIOD, |_, state| seen(state, sensors, &mut random))
            .map_err(|error| error.to_string())?;
        Ok(vec![end.time, end.relative_velocity, end.horizontal_offset])
    }
}

/// A state as sensors see it whose noise is a multiple of what it should be.
fn seen(state: &State<[f64; 6]>, noise: f64, random: &mut rand_pcg::Pcg64Mcg) -> State<[f64; 6]> {
    let mut seen = *state;
    let mut noise = |deviation: f64| {
        let normal: f64 = StandardNormal.sample(random);
        noise * deviation * normal
    };
    for i in 0..3 {
        seen.q[i] += noise(SEEN[0]);
        seen.q[3 + i] += noise(SEEN[1]);
        seen.qd[i] += noise(SEEN[2]);
        seen.qd[3 + i] += noise(SEEN[3]);
    }
    seen
}

/// What all landings say together.
fn report(outcome: &mbs_ensemble::sweep::Outcome, columns: Vec<Vec<f64>>) -> (Value, String) {
    let mut object = json!({ "members": outcome.members, "stopped": outcome.stopped });
    let mut text = format!("{} landings, {} without a touchdown\n", outcome.members, outcome.stopped);
    for ((name, unit), mut column) in QUANTITIES.into_iter().zip(columns) {
        column.retain(|value| value.is_finite());
        let moments: Moments = column.iter().copied().collect();
        column.sort_by(f64::total_cmp);
        let [low, high] = moments.mean_interval(0.95);
        let (median, last) = (quantile(&column, 0.5), quantile(&column, 0.99));
        let bounds = quantile_interval(&column, 0.99, 0.95);
        object[name] = json!({
            "mean": moments.mean, "sd": moments.deviation(), "ci95": [low, high],
            "median": median, "q99": last, "q99_ci95": bounds,
        });
        let bounds = bounds.map_or(String::new(), |[low, high]| format!(" ({low:.5} to {high:.5})"));
        text += &format!(
            "{name:<18} mean {:.5} ({low:.5} to {high:.5}), median {median:.5}, 99 % {last:.5}{bounds} {unit}\n",
            moments.mean
        );
    }
    (object, text)
}

/// Members a second on one thread: of the loop over the closures alone, and of the ensemble with its journal and table.
fn compare(landings: &Landings, sweep: &Sweep<'_>) -> Result<(), Failure> {
    let members = sweep.design.members();
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let began = Instant::now();
        let mut sum = 0.0;
        for index in 0..members {
            sum += landings.land(&sweep.design.member(index)).map_or(0.0, |row| row[0]);
        }
        rates[0].push(members as f64 / began.elapsed().as_secs_f64());
        if !sum.is_finite() {
            return Err(Failure::new("a touchdown time is not finite"));
        }
        let began = Instant::now();
        sweep.run(&|member: &Member| landings.land(member), Share::WHOLE, 1, &|_| ())?;
        sweep.merge(|_| ())?;
        rates[1].push(members as f64 / began.elapsed().as_secs_f64());
        std::fs::remove_file(&sweep.table)?;
    }
    let [bare, ensemble] = rates.map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        quantile(&rates, 0.5)
    });
    println!("{bare:.1} members/s in the bare loop, {ensemble:.1} in the ensemble: {:.3}", ensemble / bare);
    Ok(())
}
