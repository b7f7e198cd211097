//! The formulas of mechanics texts as a careful person types them: the measure of what generated code may cost.
//!
//! Every expression that occurs twice has a name, brackets are set where they save a product, and what depends on
//! parameters alone is computed beforehand, as in generated code. Nothing here knows the generator.

pub mod cart_pole;
pub mod double_pendulum;
pub mod furuta_pendulum;
pub mod heavy_top;
pub mod spherical_pendulum;

use mbs_runtime::Scalar;

/// `M q̈ + C q̇ + G + ∂D/∂q̇ = Q(u)` as formulas; coordinates as in the mechanism's file.
pub trait ByHand<T: Scalar, const N: usize, const U: usize> {
    /// M
    fn mass_matrix(&self, q: &[T; N]) -> [[T; N]; N];
    /// C, of Christoffel symbols.
    fn coriolis_matrix(&self, q: &[T; N], qd: &[T; N]) -> [[T; N]; N];
    /// G
    fn gravity(&self, q: &[T; N]) -> [T; N];
    /// `C q̇ + G`
    fn bias(&self, q: &[T; N], qd: &[T; N]) -> [T; N];
    /// `M q̈ + C q̇ + G + ∂D/∂q̇`
    fn inverse_dynamics(&self, q: &[T; N], qd: &[T; N], qdd: &[T; N]) -> [T; N];
    /// q̈
    fn forward_dynamics(&self, q: &[T; N], qd: &[T; N], u: &[T; U]) -> [T; N];
}
