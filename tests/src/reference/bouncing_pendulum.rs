//! A rod on a hinge in the coordinates of its mass centre, x to the right and y upwards, and its angle `φ` from hanging
//! down; its tip bounces off a wall below the hinge.
//!
//! # Source
//!
//! Newton's and Euler's laws with the force of the hinge as multiplier. Impact: E. J. Routh, *Dynamics of a System of
//! Rigid Bodies*, 7th edition 1905, with Newton's coefficient of restitution. Between impacts it is a pendulum of the
//! reduced length `(I + m d²)/(m d)`.

use super::cartesian_pendulum::CartesianPendulum;
use super::dynamics::Dynamics;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BouncingPendulum {
    /// Mass, in kg.
    pub m: f64,
    /// Length, in m; the mass centre is in the middle.
    pub l: f64,
    /// Moment of inertia about the mass centre, in kg·m².
    pub moment: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl BouncingPendulum {
    /// From the hinge to the mass centre.
    fn lever(&self) -> f64 {
        0.5 * self.l
    }

    /// Place and angle of the rod that is held by its hinge.
    pub fn held(&self, phi: f64) -> [f64; 3] {
        [self.lever() * phi.sin(), -self.lever() * phi.cos(), phi]
    }

    /// The pendulum of one particle that swings alike.
    pub fn alike(&self) -> CartesianPendulum {
        let d = self.lever();
        CartesianPendulum { m: self.m, l: d + self.moment / (self.m * d), g: self.g }
    }

    /// When the tip hits the wall, released at rest at `phi`: after a quarter of a swing, then, as the wall is where
    /// the rod hangs, after half a swing each, of an amplitude with `sin(α/2)` smaller by the coefficient of
    /// restitution.
    pub fn impacts(&self, phi: f64, restitution: f64) -> impl Iterator<Item = f64> {
        let pendulum = self.alike();
        let mut sine = (0.5 * phi).sin();
        let mut time = -0.25 * pendulum.period(phi);
        std::iter::from_fn(move || {
            time += 0.5 * pendulum.period(2.0 * sine.asin());
            sine *= restitution;
            Some(time)
        })
    }
}

/// Coordinates `[x, y, φ]`.
impl Dynamics<3> for BouncingPendulum {
    fn mass_matrix(&self, _: &[f64; 3]) -> [[f64; 3]; 3] {
        [[self.m, 0.0, 0.0], [0.0, self.m, 0.0], [0.0, 0.0, self.moment]]
    }

    fn bias(&self, _: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        [0.0, self.m * self.g, 0.0]
    }

    /// `x − d sin φ = 0`, `y + d cos φ = 0`.
    fn constraints(&self, &[_, _, phi]: &[f64; 3], &[_, _, rate]: &[f64; 3]) -> Vec<([f64; 3], f64)> {
        let (d, (s, c)) = (self.lever(), phi.sin_cos());
        vec![([1.0, 0.0, -d * c], d * s * rate * rate), ([0.0, 1.0, -d * s], -d * c * rate * rate)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::dynamics::motion;

    /// The angle turns as that of the reduced length; the hinge bears weight and centripetal force.
    #[test]
    fn agrees_with_the_angle() {
        let rod = BouncingPendulum { m: 1.3, l: 0.8, moment: 0.2, g: 9.81 };
        for state in states::<1>(43, 40) {
            let ([phi], [rate]) = (state.q, state.qd);
            let ((s, c), d) = (phi.sin_cos(), rod.lever());
            let motion = motion(&rod, &rod.held(phi), &[d * c * rate, d * s * rate, rate]).expect("regular");
            let [turn, _] = rod.alike().swing(phi, rate);
            let acceleration = [d * (c * turn - s * rate * rate), d * (s * turn + c * rate * rate)];
            assert_close("q̈", &motion.accelerations, &[acceleration[0], acceleration[1], turn], 1e-12);
            let hinge = [rod.m * acceleration[0], rod.m * (acceleration[1] + rod.g)];
            assert_close("λ", &motion.multipliers, &hinge, 1e-12);
        }
    }
}
