//! All figures of the thesis, and a page that shows them.
//!
//! The 26 with data are drawn from the same code as those of the programs `arm_trajectory`, `platform_dynamics`,
//! `quadrotor_landing` and `relative_motion`; the ten without are drawn from the mechanisms themselves: frames, joints
//! and actuators are where the generated kinematics says. Captions tell what each of them rests on that the thesis does
//! not give. Open `index.html` in the folder.

mod chapters;
mod data;
mod index;
mod jobs;
mod scheme_arm;
mod scheme_frames;
mod scheme_platform;
mod solid;

use mbs_examples::println;
use std::path::PathBuf;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use mbs_chart::Format;
use mbs_examples::figures::{FIGURES, file_name};
use mbs_examples::{Failure, output};
use rayon::prelude::*;

use jobs::{JOBS, Job};

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
            let drawn = job.drawn().map_err(|failure| format!("Figure {}: {failure:?}", job.numbers.join(", ")))?;
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
