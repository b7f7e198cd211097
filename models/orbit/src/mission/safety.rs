//! Where the vehicle may be near the station: outside a sphere, or within a cone in front of the port.

use mbs_runtime::Scalar;

use super::super::vector::{Vector, dot, minus, norm, scaled};

/// A keep-out sphere with an approach corridor through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zones {
    /// Radius of the sphere about the station's mass centre \[m\].
    pub keep_out: f64,
    /// Half the opening of the cone \[rad\].
    pub half_angle: f64,
    /// Radius of the cone where the port is \[m\].
    pub mouth: f64,
    /// Of the port, in the station's frame \[m\].
    pub port: Vector,
    /// Unit vector from the port along the corridor.
    pub outward: Vector,
}

/// Where a place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// Outside the sphere.
    Outside,
    /// In the sphere, within the corridor.
    Corridor,
    /// In the sphere, outside the corridor.
    KeepOut,
}

impl Zones {
    /// Where a place is \[m\].
    #[must_use]
    pub fn of(&self, place: &Vector) -> Zone {
        // NaN is nowhere outside.
        if norm(place) >= self.keep_out {
            Zone::Outside
        } else if self.is_in_corridor(place) {
            Zone::Corridor
        } else {
            Zone::KeepOut
        }
    }

    /// Distance to go along the axis, and distance from it \[m\].
    #[must_use]
    pub fn from_port(&self, place: &Vector) -> (f64, f64) {
        let offset = minus(place, &self.port);
        let along = dot(&offset, &self.outward);
        (along, norm(&minus(&offset, &scaled(along, &self.outward))))
    }

    /// Within the cone, which goes on outside the sphere.
    #[must_use]
    pub fn is_in_corridor(&self, place: &Vector) -> bool {
        let (along, beside) = self.from_port(place);
        // Contact itself may be some roundings behind the port.
        along >= -1e-9 * self.keep_out && beside <= self.mouth + along * Scalar::tan(self.half_angle)
    }
}
