//! Where does a chaser arrive that knows its place to metres and burns to a hundredth?
//!
//! From a point of the V-bar 3 km behind a station one burn leads to a point 250 m behind it. Navigation and engine err
//! as the plan `examples/ensembles/docking.toml` says. Once by linear covariance, `P = Φ (P₀ + B Q Bᵀ) Φᵀ` with the
//! state transition matrix of Clohessy and Wiltshire: a product of matrices. Once by thousands of flights on Kepler's
//! conics.
//! Look at the ratios: they say how far the product can be trusted; and at the share of flights within its ellipsoid.
//!
//! The table goes to `--table FILE`, which a killed run continues, and `mbs plot` draws; `--out DIR` writes a figure of
//! the places with the ellipsoid of 95 %.

mod figure;
mod flight;
mod summary;

use std::path::PathBuf;

use mbs_ensemble::Member;
use mbs_ensemble::statistics::Moments;
use mbs_examples::dispersion::Dispersion;
use mbs_examples::{Failure, arguments::Arguments, output};
use nalgebra::{Matrix3, Matrix6, Vector3};

use flight::{Flight, PERFECT, VARIABLES};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many flights, instead of as many as the plan says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    members: Option<u64>,
    /// Where the table goes.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
}

/// By how much a flight misses: away from the centre, along the orbit, across it.
const QUANTITIES: [(&str, &str); 6] =
    [("miss_x", "m"), ("miss_y", "m"), ("miss_z", "m"), ("miss_v_x", "m/s"), ("miss_v_y", "m/s"), ("miss_v_z", "m/s")];

/// What it rests on.
const ASSUMED: [&str; 2] = ["orbit.altitude", "dispersions.docking"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let options = &arguments.options;
    let plan = ("docking.toml", include_str!("../ensembles/docking.toml"));
    let members = options.members;
    let dispersion = Dispersion::planned("docking_dispersions", plan, members, VARIABLES, &QUANTITIES)?;
    let flight = Flight::planned()?;
    let miss = |member: &Member| {
        flight.miss(dispersion.in_order(&VARIABLES, PERFECT, member)).map_err(|error| error.to_string())
    };
    let (folder, misses) = (arguments.folder()?, dispersion.all_columns(options.table.as_deref(), &miss)?);
    let covariance = flight.covariance(&dispersion.plan, &dispersion.design)?;
    let dispersions = Dispersions::of(&covariance, &misses)?;
    if let Some(folder) = folder {
        output::write_figure(folder, "docking_dispersions", &figure::places(&covariance, &misses), &ASSUMED)?;
    }
    arguments.answer(summary::to_json(&dispersions), &summary::text(&dispersions), &ASSUMED);
    Ok(())
}

/// The quantile of χ² with three degrees of freedom at 0.95: M. Abramowitz and I. A. Stegun, *Handbook of Mathematical
/// Functions*, 1964, table 26.8.
const WITHIN: f64 = 7.814_73;

/// What both ways say.
struct Dispersions {
    members: usize,
    /// The deviation of each quantity by covariance.
    linear: [f64; 6],
    /// Mean and deviation of the flights.
    flown: [Moments; 6],
    /// The share of the flights within the ellipsoid of places that holds 95 % of a normal distribution.
    within: f64,
}

impl Dispersions {
    fn of(covariance: &Matrix6<f64>, misses: &[Vec<f64>]) -> Result<Self, Failure> {
        let inverse: Matrix3<f64> = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let inverse =
            inverse.try_inverse().ok_or_else(|| Failure::new("the places do not scatter in all directions"))?;
        let members = misses[0].len();
        let is_within = |member: &usize| {
            let place = Vector3::from_fn(|axis, _| misses[axis][*member]);
            (place.transpose() * inverse * place)[0] <= WITHIN
        };
        Ok(Dispersions {
            members,
            linear: std::array::from_fn(|i| covariance[(i, i)].sqrt()),
            flown: std::array::from_fn(|i| misses[i].iter().copied().collect()),
            within: (0..members).filter(is_within).count() as f64 / members as f64,
        })
    }
}
