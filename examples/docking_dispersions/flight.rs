//! One burn with its errors: where it leads to in the nonlinear motion, and its covariance by the linear one.

use mbs_ensemble::{Design, Plan};
use mbs_examples::Failure;
use mbs_models::Error;
use mbs_orbit::clohessy_wiltshire::{self, state_transition};
use mbs_orbit::lvlh::Frame;
use mbs_orbit::vector::{StateVector, Vector};
use mbs_orbit::{EARTH_MU, EARTH_RADIUS, kepler};
use nalgebra::{Matrix6, SMatrix, Vector3};

/// What the plan varies, with units: errors of the state at the burn, its size, and by how much it points elsewhere.
pub(crate) const VARIABLES: [(&str, &str); 9] = [
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

/// Their values of a burn without errors.
pub(crate) const PERFECT: [f64; 9] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// Altitude of the station \[m\], where the burn is and where it leads to \[m\], and how much of a revolution between.
const ALTITUDE: f64 = 400e3;
const FROM: Vector = [0.0, -3000.0, 0.0];
const TO: Vector = [0.0, -250.0, 0.0];
const REVOLUTION: f64 = 0.3;

/// The burn as it is planned.
pub(crate) struct Flight {
    /// Mean motion of the station \[rad/s\].
    n: f64,
    /// From the burn to the arrival \[s\].
    time: f64,
    /// The burn \[m/s\], and unit vectors along it, across it in the plane of the orbit, and out of that plane.
    burn: f64,
    axes: [Vector3<f64>; 3],
}

impl Flight {
    pub(crate) fn planned() -> Result<Self, Error> {
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

    /// Where it arrives in the nonlinear motion, less where it should, by the values of the variables.
    pub(crate) fn miss(&self, values: [f64; 9]) -> Result<Vec<f64>, Error> {
        let [x, y, z, v_x, v_y, v_z, size, in_plane, across] = values;
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
    pub(crate) fn covariance(&self, plan: &Plan, design: &Design) -> Result<Matrix6<f64>, Failure> {
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
