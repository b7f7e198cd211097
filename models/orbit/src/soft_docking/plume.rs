//! What the exhaust of a jet does to a surface.
//!
//! Far from the nozzle the exhaust is a source flow: gas on straight lines, its momentum flux falling with the square
//! of the distance and with the angle from the axis,
//!
//! ```text
//! p = (k + 2) F/(2 π r²) cosᵏ θ,   θ < π/2
//! ```
//!
//! so that the momentum through a hemisphere, ∫ p cos θ dA, is the thrust F. A surface takes all of what meets it, and
//! gives nothing back: dF = p (−d·n) d dA with the direction d of the gas and the normal n. What stands before
//! something else does not shade it.
//!
//! # Source
//! Simons, *Effect of Nozzle Boundary Layers on Rocket Exhaust Plumes*, AIAA Journal 10(11), 1972, where the cosine
//! is one of a widened angle and k = 2/(γ − 1); Fehse, *Automated Rendezvous and Docking of Spacecraft*, 2003,
//! section 5.4.

use core::f64::consts::PI;

use mbs_models::check::{self, Invalid};
use mbs_runtime::Scalar;

use crate::vector::{Vector, combined, cross, dot, minus, norm, plus, scaled};

/// A rectangle that gas may meet on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Its middle \[m\].
    pub middle: Vector,
    /// From the middle to the middles of two edges, at right angles; their cross product points to the side that is
    /// met \[m\].
    pub halves: [Vector; 2],
}

/// The exhaust of a jet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plume {
    /// `k`: the larger, the narrower.
    pub exponent: f64,
    /// A panel is divided into this many parts each way.
    pub parts: u32,
}

impl Plume {
    /// Momentum flux at a distance and at an angle from the axis of which the cosine is given \[Pa\].
    #[must_use]
    pub fn pressure(&self, thrust: f64, distance: f64, cosine: f64) -> f64 {
        if cosine <= 0.0 {
            return 0.0;
        }
        (self.exponent + 2.0) * thrust / (2.0 * PI * distance * distance)
            * Scalar::exp(self.exponent * Scalar::ln(cosine))
    }

    /// Force and torque about the origin on panels, of a jet at `nozzle` whose gas goes along the unit vector `axis`
    /// \[N, N·m\].
    #[must_use]
    pub fn wrench(&self, thrust: f64, nozzle: &Vector, axis: &Vector, panels: &[Panel]) -> [Vector; 2] {
        let mut sum = [[0.0; 3]; 2];
        for Panel { middle, halves: [a, b] } in panels {
            let normal = cross(a, b);
            // The normal is as long as a quarter of the panel's area.
            let element = 4.0 / f64::from(self.parts * self.parts);
            let along = |k: u32| (2.0 * f64::from(k) + 1.0) / f64::from(self.parts) - 1.0;
            for (i, j) in (0..self.parts).flat_map(|i| (0..self.parts).map(move |j| (i, j))) {
                let place = plus(middle, &combined(along(i), a, along(j), b));
                let way = minus(&place, nozzle);
                let distance = norm(&way);
                let facing = -dot(&way, &normal);
                if facing <= 0.0 || distance == 0.0 {
                    continue;
                }
                let pressure = self.pressure(thrust, distance, dot(&way, axis) / distance);
                let force = scaled(pressure * facing * element / (distance * distance), &way);
                sum = [plus(&sum[0], &force), plus(&sum[1], &cross(&place, &force))];
            }
        }
        sum
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        check::not_negative("plume.exponent", self.exponent)?;
        check::within("plume.parts", f64::from(self.parts), [1.0, 1000.0])
    }
}
