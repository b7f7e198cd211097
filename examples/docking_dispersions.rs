//! Where does a chaser arrive that knows its place to metres and burns to a hundredth?
//!
//! From a point of the V-bar 3 km behind a station one burn leads to a point 250 m behind it. Navigation and engine err
//! as the plan `examples/ensembles/docking.toml` says. Once by linear covariance, `P = Φ (P₀ + B Q Bᵀ) Φᵀ` with the
//! state transition matrix of Clohessy and Wiltshire: a product of matrices. Once by thousands of flights on Kepler's
//! conics.
//! Look at the ratios: they say how far the product can be trusted; and at the share of flights within its ellipsoid.
//!
//! The table goes to `--table FILE`, which a killed run continues, and `mbs plot` draws.

use std::path::PathBuf;

use mbs_ensemble::statistics::Moments;
use mbs_ensemble::{Design, Member, Plan};
use mbs_examples::dispersion::Dispersion;
use mbs_examples::{Failure, arguments::Arguments};
use mbs_models::Error;
use mbs_orbit::clohessy_wiltshire::{self, state_transition};
use mbs_orbit::lvlh::Frame;
use mbs_orbit::vector::{StateVector, Vector};
use mbs_orbit::{EARTH_MU, EARTH_RADIUS, kepler};
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};
use serde_json::{Value, json};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many flights, instead of as many as the plan says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    members: Option<u64>,
    /// Where the table goes.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
}

/// What the plan varies, with units: errors of the state at the burn, its size, and by how much it points elsewhere.
const VARIABLES: [(&str, &str); 9] = [
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    ("v_x", "m/s"),
    ("v_y", "m/s"),
    ("v_z", "m/s"),
    ("size", "1"),
    ("in_plane", "rad"),
    ("across", "rad"),
];

/// By how much a flight misses: away from the centre, along the orbit, across it.
const QUANTITIES: [(&str, &str); 6] =
    [("miss_x", "m"), ("miss_y", "m"), ("miss_z", "m"), ("miss_v_x", "m/s"), ("miss_v_y", "m/s"), ("miss_v_z", "m/s")];

/// Altitude of the station \[m\], where the burn is and where it leads to \[m\], and how much of a revolution between.
const ALTITUDE: f64 = 400e3;
const FROM: Vector = [0.0, -3000.0, 0.0];
const TO: Vector = [0.0, -250.0, 0.0];
const REVOLUTION: f64 = 0.3;

/// What it rests on.
const ASSUMED: [&str; 2] = ["orbit.altitude", "dispersions.docking"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("docking_dispersions.rs"));
    let options = &arguments.options;
    let plan = ("docking.toml", include_str!("ensembles/docking.toml"));
    let members = options.members;
    let dispersion = Dispersion::planned("docking_dispersions", plan, members, VARIABLES, &QUANTITIES)?;
    let (flight, design) = (Flight::planned()?, &dispersion.design);
    let miss = |member: &Member| flight.miss(&in_order(design, member)).map_err(|error| error.to_string());
    let misses = dispersion.all_columns(options.table.as_deref(), &miss)?;
    let dispersions = Dispersions::of(&flight.covariance(&dispersion.plan, design)?, &misses)?;
    arguments.answer(dispersions.object(), &dispersions.text(), &ASSUMED);
    Ok(())
}

/// A member's values in the order of the variables; those that do not vary are what they should be.
fn in_order(design: &Design, member: &Member) -> [f64; 9] {
    let mut values = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    for (variable, value) in design.variables().iter().zip(&member.values) {
        if let Some(place) = VARIABLES.iter().position(|(name, _)| *name == variable.name) {
            values[place] = *value;
        }
    }
    values
}

/// The burn as it is planned.
struct Flight {
    /// Mean motion of the station \[rad/s\].
    n: f64,
    /// From the burn to the arrival \[s\].
    time: f64,
    /// The burn \[m/s\], and unit vectors along it, across it in the plane of the orbit, and out of that plane.
    burn: f64,
    axes: [Vector3<f64>; 3],
}

impl Flight {
    fn planned() -> Result<Self, Error> {
        let n = (EARTH_MU / (EARTH_RADIUS + ALTITUDE).powi(3)).sqrt();
        let time = REVOLUTION * std::f64::consts::TAU / n;
        let burn = Vector3::from(clohessy_wiltshire::transfer(n, &FROM, &TO, time)?.departure);
        let along = burn.normalize();
        let out = Vector3::z();
        Ok(Flight { n, time, burn: burn.norm(), axes: [along, out.cross(&along), out] })
    }

    /// What the engine does.
    fn burned(&self, [size, in_plane, across]: [f64; 3]) -> Vector3<f64> {
        let [along, aside, out] = self.axes;
        size * self.burn * (along + in_plane.tan() * aside + across.tan() * out).normalize()
    }

    /// Where it arrives in the nonlinear motion, less where it should.
    fn miss(&self, &[x, y, z, v_x, v_y, v_z, size, in_plane, across]: &[f64; 9]) -> Result<Vec<f64>, Error> {
        let radius = EARTH_RADIUS + ALTITUDE;
        let station = StateVector::new([radius, 0.0, 0.0], [0.0, self.n * radius, 0.0]);
        let burn = self.burned([size, in_plane, across]);
        let start =
            StateVector::new([FROM[0] + x, FROM[1] + y, FROM[2] + z], [v_x + burn.x, v_y + burn.y, v_z + burn.z]);
        let chaser = Frame::of(&station)?.to_inertial(&start);
        let [station, chaser] = [station, chaser].map(|state| kepler::propagate(EARTH_MU, &state, self.time));
        let end = Frame::of(&station?.state)?.to_relative(&chaser?.state);
        let expected = clohessy_wiltshire::transfer(self.n, &FROM, &TO, self.time)?.arrival;
        let position = end.position.iter().zip(TO).map(|(found, wanted)| found - wanted);
        let velocity = end.velocity.iter().zip(expected).map(|(found, wanted)| found - wanted);
        Ok(position.chain(velocity).collect())
    }

    /// `Φ (P₀ + B Q Bᵀ) Φᵀ`
    fn covariance(&self, plan: &Plan, design: &Design) -> Result<Matrix6<f64>, Failure> {
        let drawn = design.distributions();
        let place = |name: &str| design.variables().iter().position(|variable| variable.name == name);
        let deviation = |name: &str| place(name).map_or(0.0, |place| drawn[place].slope_at_germ(0.0));
        let mut all =
            SMatrix::<f64, 9, 9>::from_diagonal(&SMatrix::from(VARIABLES.map(|(name, _)| deviation(name).powi(2))));
        for correlation in &plan.correlation {
            let names = correlation.of.each_ref().map(|name| name.value.as_str());
            let [Some(i), Some(j)] = names.map(|name| VARIABLES.iter().position(|(own, _)| *own == name)) else {
                return Err(Failure::new("a correlation of something unknown"));
            };
            all[(i, j)] = correlation.coefficient.value * deviation(names[0]) * deviation(names[1]);
            all[(j, i)] = all[(i, j)];
        }
        // How the state behind the burn depends on what varies.
        let mut by = SMatrix::<f64, 6, 9>::zeros();
        by.fixed_view_mut::<6, 6>(0, 0).copy_from(&Matrix6::identity());
        for (column, axis) in self.axes.iter().enumerate() {
            by.fixed_view_mut::<3, 1>(3, 6 + column).copy_from(&(self.burn * axis));
        }
        let rows = state_transition(self.n, self.time)?;
        let phi = Matrix6::from_fn(|i, j| rows[i][j]);
        Ok(phi * by * all * by.transpose() * phi.transpose())
    }
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

    fn object(&self) -> Value {
        let mut object = json!({ "members": self.members, "within_95": self.within });
        for (i, (name, _)) in QUANTITIES.iter().enumerate() {
            let (linear, flown) = (self.linear[i], self.flown[i]);
            object[name] = json!({ "sd_linear": linear, "sd": flown.deviation(), "mean": flown.mean });
        }
        object
    }

    fn text(&self) -> String {
        let mut text = format!("{} flights\n            deviation: linear   flown       ratio   mean\n", self.members);
        for (i, (name, unit)) in QUANTITIES.iter().enumerate() {
            let (linear, flown) = (self.linear[i], self.flown[i]);
            let (deviation, ratio) = (flown.deviation(), flown.deviation() / linear);
            text +=
                &format!("{name:<9} {unit:<4}  {linear:>14.5}  {deviation:>10.5}  {ratio:>8.4}  {:>8.4}\n", flown.mean);
        }
        text + &format!("{:.2} % of the flights arrive within the ellipsoid of 95 %\n", 100.0 * self.within)
    }
}
