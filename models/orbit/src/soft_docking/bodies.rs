//! Two bodies by place, velocity, attitude and spin, and how the port of one stands before that of the other.

use mbs_runtime::{Scalar, State};

use super::docking_bodies::Params;
use crate::vector::{Vector, cross, minus, norm, plus};

/// Attitude, scalar part first: from the body's axes to those of the orbit.
pub type Quaternion = [f64; 4];

/// A rigid body in the axes of the orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The position of its mass centre \[m\].
    pub position: Vector,
    /// As seen in these axes \[m/s\].
    pub velocity: Vector,
    /// From its own axes to those of the orbit.
    pub attitude: Quaternion,
    /// Angular velocity against inertial space, in its own axes \[rad/s\].
    pub spin: Vector,
}

/// Chaser and station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// What comes.
    pub chaser: Body,
    /// Where it comes to.
    pub station: Body,
}

/// Of the circle that the axes go round on: `√(μ/R³)` \[rad/s\].
#[must_use]
pub fn rate(params: &Params<f64>) -> f64 {
    Scalar::sqrt(params.mu / params.radius) / params.radius
}

impl Body {
    /// Of its coordinates: three of the place, four of the attitude.
    fn from_coordinates(q: &[f64], qd: &[f64], rate: f64) -> Self {
        let attitude = [q[3], q[4], q[5], q[6]];
        // ω = 2 ē ė against the axes of the orbit, and they turn at the rate.
        let [_, x, y, z] = product(&conjugate(&attitude), &[qd[3], qd[4], qd[5], qd[6]]);
        let turning = turned_back(&attitude, &[0.0, 0.0, rate]);
        let spin = plus(&[2.0 * x, 2.0 * y, 2.0 * z], &turning);
        Self { position: [q[0], q[1], q[2]], velocity: [qd[0], qd[1], qd[2]], attitude, spin }
    }

    /// Its coordinates and their rates: `ė = ½ e ω`.
    fn coordinates(&self, rate: f64) -> [[f64; 7]; 2] {
        let [x, y, z] = minus(&self.spin, &turned_back(&self.attitude, &[0.0, 0.0, rate]));
        let ed = product(&self.attitude, &[0.0, 0.5 * x, 0.5 * y, 0.5 * z]);
        let join = |a: &Vector, b: &Quaternion| [a[0], a[1], a[2], b[0], b[1], b[2], b[3]];
        [join(&self.position, &self.attitude), join(&self.velocity, &ed)]
    }
}

impl Pair {
    /// Of a state of the mechanism.
    #[must_use]
    pub fn from_state(params: &Params<f64>, state: &State<[f64; 14]>) -> Self {
        let body = |at: usize| Body::from_coordinates(&state.q[at..at + 7], &state.qd[at..at + 7], rate(params));
        Self { chaser: body(0), station: body(7) }
    }

    /// The state of the mechanism.
    #[must_use]
    pub fn to_state(&self, params: &Params<f64>) -> State<[f64; 14]> {
        let [chaser, station] = [self.chaser, self.station].map(|body| body.coordinates(rate(params)));
        let join = |part: usize| core::array::from_fn(|i| if i < 7 { chaser[part][i] } else { station[part][i - 7] });
        State::new(join(0), join(1))
    }

    /// The ports against each other.
    #[must_use]
    pub fn misalignment(&self, params: &Params<f64>) -> Misalignment {
        let [probe, ring] = self.ports(params);
        let place = turned_back(&ring.attitude, &minus(&probe.position, &ring.position));
        // Against the station where the chaser's port is, as the ring feels it.
        let [spin, other] =
            [turned(&self.chaser.attitude, &self.chaser.spin), turned(&self.station.attitude, &self.station.spin)];
        let against = minus(&spin, &other);
        let turning = minus(&other, &[0.0, 0.0, rate(params)]);
        let carried = cross(&turning, &minus(&probe.position, &ring.position));
        let velocity = turned_back(&ring.attitude, &minus(&minus(&probe.velocity, &ring.velocity), &carried));
        let [a, b, c, d] = product(&conjugate(&ring.attitude), &probe.attitude);
        let spin = turned_back(&ring.attitude, &against);
        // A turn about the approach, then a tilt of it.
        let roll = 2.0 * Scalar::atan2(if a < 0.0 { -b } else { b }, a.abs());
        let tilt = 2.0 * Scalar::atan2(hypot(c, d), hypot(a, b));
        Misalignment { place, velocity, tilt, roll, spin }
    }

    /// The ports of chaser and station: places, velocities and attitudes in the axes of the orbit.
    fn ports(&self, params: &Params<f64>) -> [Port; 2] {
        let port = |body: &Body, arm: &Vector, angles: &Vector| {
            let arm = turned(&body.attitude, arm);
            let spin = minus(&turned(&body.attitude, &body.spin), &[0.0, 0.0, rate(params)]);
            Port {
                position: plus(&body.position, &arm),
                velocity: plus(&body.velocity, &cross(&spin, &arm)),
                attitude: product(&body.attitude, &roll_pitch_yaw(angles)),
            }
        };
        [
            port(&self.chaser, &params.chaser_port, &params.chaser_port_attitude),
            port(&self.station, &params.station_port, &params.station_port_attitude),
        ]
    }
}

struct Port {
    position: Vector,
    velocity: Vector,
    attitude: Quaternion,
}

/// The chaser's port in the axes of the station's: x along the approach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misalignment {
    /// The first number is the depth, negative before they touch \[m\].
    pub place: Vector,
    /// Of the chaser's port against the station there \[m/s\].
    pub velocity: Vector,
    /// Angle between the approach and the chaser's own \[rad\].
    pub tilt: f64,
    /// Angle about the approach \[rad\].
    pub roll: f64,
    /// Angular velocity against the station \[rad/s\].
    pub spin: Vector,
}

impl Misalignment {
    /// Beside the axis \[m\].
    #[must_use]
    pub fn lateral(&self) -> f64 {
        hypot(self.place[1], self.place[2])
    }

    /// Along the approach \[m/s\].
    #[must_use]
    pub fn closing(&self) -> f64 {
        self.velocity[0]
    }

    /// Across it \[m/s\].
    #[must_use]
    pub fn sliding(&self) -> f64 {
        hypot(self.velocity[1], self.velocity[2])
    }

    /// The magnitude of the angular velocity \[rad/s\].
    #[must_use]
    pub fn turning(&self) -> f64 {
        norm(&self.spin)
    }
}

fn hypot(a: f64, b: f64) -> f64 {
    Scalar::sqrt(a * a + b * b)
}

/// `a b`
pub(super) fn product(a: &Quaternion, b: &Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// `ā`
pub(super) fn conjugate(a: &Quaternion) -> Quaternion {
    [a[0], -a[1], -a[2], -a[3]]
}

/// From the body's axes to those of the orbit: `e v ē`.
pub(super) fn turned(attitude: &Quaternion, v: &Vector) -> Vector {
    let [_, x, y, z] = product(&product(attitude, &[0.0, v[0], v[1], v[2]]), &conjugate(attitude));
    [x, y, z]
}

/// From the axes of the orbit to the body's: `ē v e`.
pub(super) fn turned_back(attitude: &Quaternion, v: &Vector) -> Vector {
    turned(&conjugate(attitude), v)
}

/// Of roll, pitch and yaw, `R_z R_y R_x`.
#[must_use]
pub fn roll_pitch_yaw(angles: &Vector) -> Quaternion {
    let [(sr, cr), (sp, cp), (sy, cy)] = angles.map(|angle| Scalar::sin_cos(0.5 * angle));
    product(&product(&[cy, 0.0, 0.0, sy], &[cp, 0.0, sp, 0.0]), &[cr, sr, 0.0, 0.0])
}
