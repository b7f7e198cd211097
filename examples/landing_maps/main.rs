//! How does the landing time depend on the motion of the deck, and on who flies by which equations?
//!
//! The deck heaves by `A sin(ωt + φ)`. The vehicle of the thesis follows its elevation from 10 m above, without
//! guidance, until it is 1 cm over it: under guidance the landing time would be the guidance's. Four maps over
//! amplitude and frequency, each for four phases: the exact plant and that for small angles, each under backstepping
//! and under a linear quadratic regulator.
//!
//! Where nothing lands a map says why instead of a time. Above `A ω² = g` the deck falls faster than freely: whatever
//! touches it does not stay. Look at how the time follows the phase: what counts is where the deck is when the vehicle
//! comes, and whether its thrust is at a limit.
//!
//! `--cells N` says how many there are along each axis, `--out DIR` writes the maps as SVG, PNG and CSV.

mod figures;
mod map;

use mbs_examples::{Failure, arguments::Arguments, assumed};
use serde_json::{Map as Object, Value, json};

use map::{Grid, LIMIT, Law, Map, Outcome, PHASES};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// Along each axis of a map.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(2..=200))]
    cells: u32,
}

/// What the maps rest on; the guidance is not among it.
fn assumed_keys() -> Vec<&'static str> {
    let landing = assumed::without(assumed::LANDING, "quadrotor.guidance");
    [&landing[..], &["quadrotor.regulator", "landing.tolerance"]].concat()
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let grid = Grid::new(arguments.options.cells as usize);
    let maps = Law::ALL.into_iter().map(|law| Map::flown(law, &grid)).collect::<Result<Vec<_>, _>>()?;
    if let Some(folder) = arguments.folder()? {
        maps.iter().try_for_each(|map| figures::write(folder, &grid, map))?;
    }
    arguments.answer(to_json(&grid, &maps), &text(&grid, &maps), &assumed_keys());
    Ok(())
}

/// Rows of a map are frequencies, columns amplitudes; what is no time \[s\] is the reason.
fn to_json(grid: &Grid, maps: &[Map]) -> Value {
    let outcome = |outcome: &Outcome| match outcome {
        Outcome::Lands(time) => json!(time),
        other => json!(other.reason()),
    };
    let rows = |phase: &[Vec<Outcome>]| -> Value {
        phase.iter().map(|row| row.iter().map(outcome).collect::<Value>()).collect()
    };
    let of_law = |map: &Map| -> Value {
        let phases = PHASES.iter().zip(&map.phases);
        let times: Object<String, Value> = phases.map(|(phase, cells)| (format!("{phase}"), rows(cells))).collect();
        let [lands, fails] = map.counts();
        json!({ "lands": lands, "no_landing": fails, "range": map.range(), "touchdown_time": times })
    };
    json!({
        "amplitudes": grid.amplitudes,
        "frequencies": grid.frequencies,
        "phases_deg": PHASES,
        "limit": LIMIT,
        "maps": maps.iter().map(|map| (map.law.key().to_string(), of_law(map))).collect::<Object<_, _>>(),
    })
}

fn text(grid: &Grid, maps: &[Map]) -> String {
    let [(first, last), (slow, fast)] =
        [&grid.amplitudes, &grid.frequencies].map(|axis| (axis[0], axis[axis.len() - 1]));
    let mut text = format!(
        "A sin(ωt + φ), A from {first:.3} to {last:.3} m, ω from {slow:.3} to {fast:.3} rad/s, φ = 0, 90, 180, 270°; given up after {LIMIT} s\n\n"
    );
    for map in maps {
        let [least, greatest] = map.range();
        let [lands, _] = map.counts();
        text += &format!("  {:<28} {lands:>5} land, from {least:.3} to {greatest:.3} s", map.law.name());
        for reason in 0..map::REASONS.len() {
            text += &format!("; {} {}", map.count_of(reason), map::REASONS[reason]);
        }
        text += "\n";
    }
    for (a, b) in [(0, 1), (2, 3)] {
        text += &format!(
            "  {} and {}: times differ by up to {:.2e} s\n",
            maps[a].law.name(),
            maps[b].law.name(),
            maps[a].difference(&maps[b])
        );
    }
    text
}
