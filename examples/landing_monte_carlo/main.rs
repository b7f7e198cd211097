//! How sure is a landing where mass, drag, wind and sensors are not what the controller believes?
//!
//! Many landings of case I, each with a vehicle, a wind and a start of its own, under a controller that is sampled at
//! 500 Hz and sees a noisy state. Look at the touchdown's velocity: what a wrong mass does to it, the controller does
//! not notice.
//!
//! The members are simulated in parallel; each has its own random numbers, so that the digest of all results is the
//! same for any number of threads. `--members N` says how many there are, `--threads N` by how many threads. `--out
//! DIR` writes all results as CSV, and their histograms (SVG and PNG).

mod member;

use std::time::Instant;

use mbs_ensemble::statistics::Moments;
use mbs_examples::quadrotor_landing::members;
use mbs_examples::{Failure, arguments::Arguments, assumed, histograms, output};
use serde_json::json;

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many landings; statistics need two.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(2..))]
    members: u32,
    /// By how many threads; as many as there are cores without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    threads: Option<u32>,
}

/// What is measured at a touchdown: name in the JSON, name and unit in the text.
const RESULTS: [(&str, &str, &str); 3] = [
    ("touchdown_time", "touchdown time", "s"),
    ("relative_velocity", "relative velocity", "m/s"),
    ("horizontal_offset", "horizontal offset", "m"),
];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let Options { members: count, threads } = arguments.options;
    members::use_threads(threads)?;
    let start = Instant::now();
    let landings = members::flown(count, member::landed);
    let seconds = start.elapsed().as_secs_f64();

    let touchdowns: Vec<[f64; 3]> = landings.iter().flatten().copied().collect();
    let landed = touchdowns.len();
    if landed < 2 {
        return Err(Failure::new(format!("{landed} of {count} members touched down")));
    }
    let keys = [assumed::LANDING, &members::ASSUMED].concat();
    if let Some(folder) = arguments.folder()? {
        let rows = landings.iter().enumerate().filter_map(|(member, landing)| {
            landing.as_ref().ok().map(|results| [&[member as f64][..], results].concat())
        });
        let words = "member touchdown_time_s relative_velocity_m_s horizontal_offset_m";
        output::write_table(folder, "landings", words, rows)?;
        let quantities = RESULTS.map(|(_, name, unit)| (name, unit));
        let columns = [0, 1, 2].map(|i| touchdowns.iter().map(|results| results[i]).collect());
        output::write_figure(folder, "landings", &histograms::figure("landings", &quantities, &columns), &keys)?;
    }
    let (failed, threads) = (count as usize - landed, rayon::current_num_threads());
    let mut object = json!({ "members": count, "failed": failed });
    let mut text = format!(
        "{count} landings in {seconds:.1} s on {threads} threads, {failed} without a touchdown\n\
         \x20                     mean        standard deviation   95 % confidence of the mean\n"
    );
    for (i, (key, name, unit)) in RESULTS.into_iter().enumerate() {
        let moments: Moments = touchdowns.iter().map(|results| results[i]).collect();
        let (mean, deviation, [low, high]) = (moments.mean, moments.deviation(), moments.mean_interval(0.95));
        object[key] = json!({ "mean": mean, "sd": deviation, "ci95": [low, high] });
        text +=
            &format!("{name:<18} {mean:>10.5} {unit:<4} {deviation:>14.5} {unit:<4}    {low:.5} to {high:.5} {unit}\n");
    }
    object["digest"] = json!(format!("{:016x}", digest(&touchdowns)));
    arguments.answer(object, &text, &keys);
    Ok(())
}

/// Fowler, Noll and Vo's hash (FNV-1a, 64 bits) of the bits of all results.
fn digest(touchdowns: &[[f64; 3]]) -> u64 {
    let bytes = touchdowns.as_flattened().iter().flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
