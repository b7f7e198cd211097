//! A charged particle in uniform magnetic and electric fields: Lorentz's force `q (E + v × B)`, and the exact helix.
//!
//! # Source
//!
//! Jackson, *Classical Electrodynamics*, 3rd edition 1999, section 12.2 (a static uniform field); Landau,
//! Lifshitz, *The Classical Theory of Fields*, 4th edition 1975, §21; here at speeds far below that of light.

use nalgebra::{Rotation3, Unit, Vector3};

use super::dynamics::Dynamics;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargedParticle {
    /// Mass, in kg.
    pub m: f64,
    /// Charge, in C.
    pub charge: f64,
    /// Magnetic flux density, in T.
    pub b: [f64; 3],
    /// Electric field, in V/m.
    pub e: [f64; 3],
}

impl ChargedParticle {
    /// `ω_c = |q B|/m`, in rad/s.
    pub fn cyclotron_frequency(&self) -> f64 {
        (self.charge * Vector3::from(self.b).norm() / self.m).abs()
    }

    /// Place and velocity after `t` without an electric field: the velocity turns about `B` at `−q B/m`.
    pub fn helix(&self, r: [f64; 3], v: [f64; 3], t: f64) -> [[f64; 3]; 2] {
        let (r, v) = (Vector3::from(r), Vector3::from(v));
        let axis = Unit::new_normalize(Vector3::from(self.b));
        let rate = -self.charge * Vector3::from(self.b).norm() / self.m;
        let along = axis.into_inner() * axis.dot(&v);
        let across = v - along;
        // ∫ Rot(ω s) v_⊥ ds = (sin ωt v_⊥ + (1 − cos ωt) e × v_⊥)/ω.
        let (s, c) = (rate * t).sin_cos();
        let shift = (across * s + axis.cross(&across) * (1.0 - c)) / rate;
        let velocity = along + Rotation3::from_axis_angle(&axis, rate * t) * across;
        [(r + along * t + shift).into(), velocity.into()]
    }
}

impl Dynamics<3> for ChargedParticle {
    fn mass_matrix(&self, _: &[f64; 3]) -> [[f64; 3]; 3] {
        [[self.m, 0.0, 0.0], [0.0, self.m, 0.0], [0.0, 0.0, self.m]]
    }

    /// `−q (E + v × B)`.
    fn bias(&self, _: &[f64; 3], qd: &[f64; 3]) -> [f64; 3] {
        let lorentz = Vector3::from(self.e) + Vector3::from(*qd).cross(&Vector3::from(self.b));
        (lorentz * -self.charge).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;

    /// The helix satisfies Newton's law: its velocity's difference quotient is the acceleration.
    #[test]
    fn the_helix_obeys_lorentz() {
        let particle = ChargedParticle { m: 0.4, charge: -0.7, b: [0.5, -1.1, 0.3], e: [0.0; 3] };
        let (r, v, t, step) = ([1.0, 2.0, -1.0], [0.3, 0.8, -0.5], 2.3, 1e-4);
        let [_, velocity] = particle.helix(r, v, t);
        let force = particle.bias(&r, &velocity).map(|h| -h / particle.m);
        let [[later, faster], [earlier, slower]] = [particle.helix(r, v, t + step), particle.helix(r, v, t - step)];
        let quotient = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * step)) };
        assert_close("velocity", &quotient(later, earlier), &velocity, 1e-7);
        assert_close("acceleration", &quotient(faster, slower), &force, 1e-7);
        assert_eq!(particle.helix(r, v, 0.0), [r, v]);
    }
}
