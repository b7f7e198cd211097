//! All figures of the thesis, and a page that shows them.
//!
//! The 26 with data are drawn from the same code as those of the programs `arm_trajectory`, `platform_dynamics`,
//! `quadrotor_landing` and `relative_motion`; the ten without are drawn from the mechanisms themselves: frames, joints
//! and actuators are where the generated kinematics says. Captions tell what each of them rests on that the thesis does
//! not give. Open `index.html` in the folder.

mod chapters;
mod data;
mod index;
mod scheme_arm;
mod scheme_frames;
mod scheme_platform;
mod solid;

use mbs_examples::println;
use std::path::PathBuf;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use mbs_chart::{Figure, Format};
use mbs_examples::figures::{FIGURES, file_name};
use mbs_examples::{Failure, output};
use rayon::prelude::*;

/// Draws the 36 figures of the thesis as SVG, with a page that shows them.
///
/// Each with its caption, and with what it rests on that the thesis does not give. Nothing is written before all that
/// is asked for is drawn.
#[derive(Debug, Parser)]
struct Arguments {
    /// Where the figures and `index.html` go.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Some figures alone, as 5.2,7.3; the page lists all.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = known)]
    only: Vec<&'static str>,
}

/// The number of a figure, as the list has it.
fn known(text: &str) -> Result<&'static str, String> {
    let numbers = || FIGURES.iter().map(|figure| figure.number);
    numbers().find(|number| *number == text.trim()).ok_or_else(|| {
        let all: Vec<&str> = numbers().collect();
        format!("there is no such figure in the thesis; there are {}", all.join(", "))
    })
}

/// Figures that are made of one calculation, with their numbers.
struct Job {
    numbers: &'static [&'static str],
    draw: fn() -> Result<Vec<Figure>, Failure>,
}

/// Those that take longest first.
const JOBS: [Job; 16] = [
    Job { numbers: &["5.2", "5.3", "5.4", "5.5"], draw: || data::landing(0) },
    Job { numbers: &["5.6", "5.7", "5.8", "5.9"], draw: || data::landing(1) },
    Job { numbers: &["7.3", "7.4"], draw: data::about_a_station },
    Job { numbers: &["3.4", "3.6", "3.8", "3.10"], draw: || data::arm(0) },
    Job { numbers: &["3.5", "3.7", "3.9", "3.11"], draw: || data::arm(1) },
    Job { numbers: &["4.9", "4.10", "4.11", "4.12"], draw: data::table_4 },
    Job { numbers: &["4.5", "4.6", "4.8", "4.7"], draw: data::table_3 },
    Job { numbers: &["3.1"], draw: scheme_arm::both_ways },
    Job { numbers: &["3.2"], draw: scheme_arm::side_view },
    Job { numbers: &["3.3"], draw: scheme_arm::second_angle },
    Job { numbers: &["4.1"], draw: scheme_platform::frames },
    Job { numbers: &["4.2"], draw: scheme_platform::joints },
    Job { numbers: &["4.3"], draw: scheme_platform::actuator },
    Job { numbers: &["4.4"], draw: scheme_platform::spherical },
    Job { numbers: &["5.1"], draw: scheme_frames::vehicle },
    Job { numbers: &["7.1", "7.2"], draw: scheme_frames::orbits },
];

fn main() -> Result<(), Failure> {
    let Arguments { out, only } = Arguments::parse();
    let is_wanted = |number: &str| only.is_empty() || only.contains(&number);
    let jobs: Vec<&Job> = JOBS.iter().filter(|job| job.numbers.iter().any(|number| is_wanted(number))).collect();
    // Shown on a terminal alone.
    let progress = ProgressBar::new(jobs.iter().map(|job| job.numbers.len() as u64).sum());
    progress.set_style(ProgressStyle::with_template("{bar:40} {pos}/{len} figures, {elapsed}  {msg}")?);
    progress.tick();
    let drawn: Vec<Vec<(&str, Vec<u8>)>> = jobs
        .par_iter()
        .map(|job| {
            let drawn = drawn(job).map_err(|failure| format!("Figure {}: {failure:?}", job.numbers.join(", ")))?;
            progress.set_message(format!("Figure {}", job.numbers.join(", ")));
            progress.inc(job.numbers.len() as u64);
            Ok(drawn)
        })
        .collect::<Result<_, String>>()
        .map_err(Failure::new)?;
    let scheme = mbs_chart::draw(&chapters::figure(), Format::Svg)?;
    progress.finish_and_clear();

    let figures: Vec<(&str, Vec<u8>)> = drawn.into_iter().flatten().filter(|(number, _)| is_wanted(number)).collect();
    let numbers: Vec<&str> = figures.iter().map(|(number, _)| *number).collect();
    output::create_folder(&out)?;
    for (number, svg) in &figures {
        output::write_file(&out.join(file_name(number)), svg)?;
    }
    output::write_file(&out.join("chapters.svg"), &scheme)?;
    output::write_file(&out.join("index.html"), index::page(&numbers).as_bytes())?;
    println!("{} figures and the diagram of the chapters: {}", figures.len(), out.join("index.html").display());
    Ok(())
}

fn drawn(job: &Job) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    let figures = (job.draw)()?;
    assert_eq!(figures.len(), job.numbers.len(), "a figure for each number of {:?}", job.numbers);
    let pairs = job.numbers.iter().zip(&figures);
    pairs.map(|(number, figure)| Ok((*number, mbs_chart::draw(figure, Format::Svg)?))).collect()
}
