//! How large may a landing be that an arm on a rail repeats over a small platform?
//!
//! Chapter 6 of the thesis: the flange of the IRB 7600 plays the quadrotor of chapter 5, its simulated landing scaled
//! down; the platform of chapter 4 heaves to the same scale. The greatest feasible scale is searched, and the arm,
//! heavier than its controller knows, is simulated at that scale up to the contact with the deck.
//!
//! `--case II` takes the faster platform, `--scale S` another scale, feasible or not, `--attitude level` lets the tool
//! point straight down instead of taking on the vehicle's attitude. `--out DIR` writes figures as SVG and PNG, and CSV.

#[path = "experiment/assumed.rs"]
mod assumed;
#[path = "experiment/figures.rs"]
mod figures;
#[path = "experiment/run.rs"]
mod run;
#[path = "experiment/summary.rs"]
mod summary;

use mbs_examples::{Failure, arguments::Arguments};
use mbs_landing::experiment::plan::Attitude;
use mbs_landing::quadrotor::heave::Heave;

use run::{Case, Run};

/// Options that are followed by a word.
const OPTIONS: [(&str, &str); 3] = [("--case", "I|II"), ("--scale", "S"), ("--attitude", "flown|level")];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::with_words(&OPTIONS);
    let refuse = |wrong: String| -> ! { Arguments::refuse(&wrong, &OPTIONS) };
    let word = |name: &str| arguments.words.get(name).map(String::as_str);
    let case = match word("--case") {
        None | Some("I") => Case { name: "I", heave: Heave::CASE_I },
        Some("II") => Case { name: "II", heave: Heave::CASE_II },
        Some(other) => refuse(format!("there is no case {other}")),
    };
    let attitude = match word("--attitude") {
        None | Some("flown") => Attitude::Flown,
        Some("level") => Attitude::Level,
        Some(other) => refuse(format!("there is no attitude {other}")),
    };
    let scale = word("--scale")
        .map(|text| text.parse::<f64>().unwrap_or_else(|_| refuse(format!("--scale needs a number, not {text}"))));
    let experiment = run::experiment(&case, attitude)?;
    let mut run = Run::of(&experiment, case, scale)?;
    if let Some(folder) = &arguments.out {
        run = run.compared()?;
        std::fs::create_dir_all(folder)?;
        figures::write(folder, &run)?;
    }
    if arguments.json {
        println!("{}", summary::to_json(&run));
    } else {
        print!("{}", summary::text(&run));
    }
    Ok(())
}
