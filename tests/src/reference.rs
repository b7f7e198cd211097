//! Equations of motion derived another way than by the generator, which nothing here depends on.
//!
//! - [`lagrange`]: Lagrange's equations by nested dual numbers over the energies, no symbolic derivative;
//! - [`rigid_body`]: serial arms by Newton–Euler, composite bodies, articulated bodies and Jacobians;
//!   [`arms`]: the arms it is run on, and the thesis' values;
//! - [`tree`]: trees of bodies with every kind of joint by the same algorithms and by Christoffel symbols;
//!   [`robots`]: the trees it is run on;
//! - closed forms typed by hand from textbooks: [`pendulum`], [`cart_pole`], [`double_pendulum`],
//!   [`spherical_pendulum`], [`heavy_top`], [`n_pendulum`];
//! - and of mechanisms that are driven, constrained or full of friction ([`dynamics`]): [`bead_on_hoop`],
//!   [`bouncing_pendulum`], [`cart_with_five_links`], [`cartesian_pendulum`], [`chaplygin_sleigh`],
//!   [`charged_particle`], [`driven_dampers`], [`elastic_joint_arm`], [`four_bar`], [`furuta_pendulum`],
//!   [`knife_edge`], [`quadrotor_with_slung_load`], [`restricted_three_body`], [`rolling_coin`], [`shaken_pendulum`],
//!   [`slider_crank`], [`turntable`];
//! - the thesis' equations about a moving origin: [`cylindrical`].
//!
//! The former answer to [`EquationsOfMotion`], the latter to [`dynamics::Dynamics`]. z points up, gravity is `g`
//! downwards, units are SI.

pub mod arms;
pub mod bead_on_hoop;
pub mod bouncing_pendulum;
pub mod cart_pole;
pub mod cart_with_five_links;
pub mod cartesian_pendulum;
pub mod chaplygin_sleigh;
pub mod charged_particle;
pub mod cylindrical;
pub mod double_pendulum;
pub mod driven_dampers;
pub mod dynamics;
pub mod elastic_joint_arm;
pub mod four_bar;
pub mod furuta_pendulum;
pub mod heavy_top;
pub mod knife_edge;
pub mod lagrange;
pub mod n_pendulum;
pub mod pendulum;
pub mod quadrotor_with_slung_load;
pub mod restricted_three_body;
pub mod rigid_body;
pub mod robots;
pub mod rolling_coin;
pub mod shaken_pendulum;
pub mod slider_crank;
pub mod spherical_pendulum;
pub mod tree;
pub mod turntable;

/// `M(q) q̈ + C(q, q̇) q̇ + G(q) + ∂D/∂q̇ = Q`, each symbol a function. Matrices are rows.
pub trait EquationsOfMotion<const N: usize> {
    /// `M = ∂²T/∂q̇²`.
    fn mass_matrix(&self, q: &[f64; N]) -> [[f64; N]; N];

    /// `Cᵢⱼ = Γᵢⱼₖ q̇ₖ`, `Γᵢⱼₖ = ½(∂Mᵢⱼ/∂qₖ + ∂Mᵢₖ/∂qⱼ − ∂Mⱼₖ/∂qᵢ)`: Christoffel symbols of the first kind.
    fn coriolis_matrix(&self, q: &[f64; N], qd: &[f64; N]) -> [[f64; N]; N];

    /// `G = ∂V/∂q`.
    fn gravity(&self, q: &[f64; N]) -> [f64; N];

    /// `T`, in joules.
    fn kinetic_energy(&self, q: &[f64; N], qd: &[f64; N]) -> f64;

    /// `V`, in joules; its zero is where the mechanism's file says.
    fn potential_energy(&self, q: &[f64; N]) -> f64;

    /// `∂D/∂q̇`; zero unless the mechanism has friction.
    fn dissipation_force(&self, _qd: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }

    /// `h = C q̇ + G`.
    fn bias(&self, q: &[f64; N], qd: &[f64; N]) -> [f64; N] {
        sum(product(&self.coriolis_matrix(q, qd), qd), self.gravity(q))
    }

    /// `Q = M q̈ + h + ∂D/∂q̇`, the generalized force that causes `q̈`.
    fn inverse_dynamics(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [f64; N] {
        sum(sum(product(&self.mass_matrix(q), qdd), self.bias(q, qd)), self.dissipation_force(qd))
    }
}

/// Matrix times vector.
pub fn product<const N: usize>(matrix: &[[f64; N]; N], vector: &[f64; N]) -> [f64; N] {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}

fn sum<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::EquationsOfMotion;
    use super::lagrange::{self, Energies};
    use crate::compare::assert_close;
    use crate::random::states;

    /// Dual numbers and closed forms are exact up to round-off, which the thousands of operations of the largest model
    /// here grow to some 1e-14.
    pub(crate) const ROUND_OFF: f64 = 1e-12;

    /// Every function of `closed` against nested dual numbers over the energies of the same mechanism.
    ///
    /// The energies must come from elsewhere than the closed form, for instance from positions in space.
    pub(crate) fn agrees_with_lagrange<const N: usize>(closed: &(impl EquationsOfMotion<N> + Energies<N>)) {
        for state in &states::<N>(2024, 60) {
            let (q, qd, qdd) = (&state.q, &state.qd, &state.qdd);
            let flat = |matrix: [[f64; N]; N]| matrix.concat();
            let force = lagrange::euler_lagrange(closed, q, qd, qdd);
            let force = super::sum(force, closed.dissipation_force(qd));
            for (what, got, want) in [
                ("T", vec![closed.kinetic_energy(q, qd)], vec![closed.kinetic(q, qd)]),
                ("V", vec![closed.potential_energy(q)], vec![closed.potential(q)]),
                ("M", flat(closed.mass_matrix(q)), flat(lagrange::mass_matrix(closed, q))),
                ("C", flat(closed.coriolis_matrix(q, qd)), flat(lagrange::coriolis_matrix(closed, q, qd))),
                ("G", closed.gravity(q).to_vec(), lagrange::gravity(closed, q).to_vec()),
                ("Q", closed.inverse_dynamics(q, qd, qdd).to_vec(), force.to_vec()),
            ] {
                assert_close(&format!("{what} at {state:?}"), &got, &want, ROUND_OFF);
            }
        }
    }
}
