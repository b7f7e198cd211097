//! In which units the components of a result are compared with each other.
//!
//! Where the largest components of a matrix are of order one, one that is 1e-17 instead of 0 has lost nothing. So
//! errors are held against the largest component of their kind, in coordinates that are measured so that all `Mᵢᵢ` are
//! one: what is of the order of one does not depend on units then.

use mbs_derive::optimise::{Function, FunctionKind, Shape};
use nalgebra::DMatrix;

use super::bordered::Conditioned;

/// What a component is compared with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Components with the same number are of one kind.
    pub(crate) kind: usize,
    /// Its unit.
    pub(crate) unit: f64,
}

/// Coordinates in which M has ones on its diagonal.
#[derive(Clone, Debug)]
pub(crate) struct Units {
    /// 1/√Mᵢᵢ
    pub(crate) coordinates: Vec<f64>,
    /// The units of the multipliers.
    pub(crate) multipliers: Vec<f64>,
    /// The condition of M in them, of the bordered matrix with constraints; infinite where it is singular.
    pub(crate) condition: f64,
    /// Whether rows depend on others, so that Aᵀλ is compared and not λ.
    pub(crate) is_redundant: bool,
}

impl Units {
    /// Of a mass matrix, row by row.
    pub(crate) fn of(mass_matrix: &[f64]) -> Self {
        let n = mass_matrix.len().isqrt();
        let inertia = |i: usize| mass_matrix[i * n + i];
        let unit = |i: usize| if inertia(i) > 0.0 { 1.0 / inertia(i).sqrt() } else { 1.0 };
        let coordinates: Vec<f64> = (0..n).map(unit).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| mass_matrix[i * n + j] * coordinates[i] * coordinates[j]);
        let finite = scaled.iter().all(|entry| entry.is_finite());
        let eigenvalues = if finite { scaled.symmetric_eigenvalues().as_slice().to_vec() } else { vec![f64::NAN] };
        let (least, largest) = (eigenvalues.iter().copied().fold(f64::INFINITY, f64::min), n as f64);
        let condition = if least > largest * f64::EPSILON { largest / least } else { f64::INFINITY };
        Units { coordinates, multipliers: Vec::new(), condition, is_redundant: false }
    }

    /// Of M and A, row by row: those in which the scaled solution has one unit.
    pub(crate) fn of_constrained(mass_matrix: &[f64], jacobian: &[f64]) -> Self {
        let n = mass_matrix.len().isqrt();
        let Conditioned { mut units, condition, is_redundant } = Conditioned::of(n, mass_matrix, jacobian);
        let multipliers = units.split_off(n);
        Units { coordinates: units, multipliers, condition, is_redundant }
    }

    /// For each component of a function's results.
    pub(crate) fn scales(&self, function: &Function) -> Vec<Scale> {
        use FunctionKind as Kind;
        let n = self.coordinates.len();
        let s = &self.coordinates;
        let count = |shape: Shape| if let Shape::Symmetric(n) = shape { n * n } else { shape.count() };
        let counts: Vec<usize> = function.results.iter().map(|part| count(part.shape)).collect();
        let all: usize = counts.iter().sum();
        let scale = |kind, unit| Scale { kind, unit };
        let each = || (0..all).map(|i| scale(i, 1.0)).collect();
        // Rows of n: of one kind as long as `kind` says so.
        let rows = |kind: &dyn Fn(usize) -> usize, unit: &dyn Fn(usize, usize) -> f64| {
            (0..all).map(|k| scale(kind(k / n), unit(k / n, k % n))).collect()
        };
        match &function.kind {
            Kind::KineticEnergy | Kind::PotentialEnergy | Kind::Conserved => each(),
            Kind::Constraint | Kind::ConstraintRate | Kind::ConstraintBias => each(),
            Kind::Multipliers if self.is_redundant => (0..n).map(|i| scale(0, s[i])).collect(),
            Kind::Multipliers => self.multipliers.iter().map(|s| scale(0, 1.0 / s)).collect(),
            Kind::Momentum
            | Kind::Gravity
            | Kind::Bias
            | Kind::DissipationForce
            | Kind::GeneralizedForce
            | Kind::InverseDynamics => (0..n).map(|i| scale(0, s[i])).collect(),
            Kind::MassMatrix | Kind::CoriolisMatrix => rows(&|_| 0, &|i, j| s[i] * s[j]),
            Kind::InverseDynamicsJacobian => rows(&|row| row / n, &|row, j| s[row % n] * s[j]),
            Kind::ForwardDynamics => (0..n).map(|i| scale(0, 1.0 / s[i])).collect(),
            Kind::Linearize => {
                let mut scales: Vec<Scale> =
                    (0..2 * n * n).map(|k| scale(k / (n * n), s[k % n] / s[k / n % n])).collect();
                let inputs = counts[2] / n;
                scales.extend((0..counts[2]).map(|k| scale(2 + k % inputs, 1.0 / s[k / inputs])));
                scales
            }
            Kind::LinearizeParameters => {
                let parameters = all / n;
                (0..all).map(|k| scale(k % parameters, 1.0 / s[k / parameters])).collect()
            }
            Kind::ConstraintJacobian | Kind::ConstraintRateJacobian => rows(&|row| row, &|_, j| s[j]),
            // Of each pose a position and a rotation.
            Kind::Output(_) if matches!(function.results[0].shape, Shape::Pose | Shape::Poses(_)) => {
                (0..all).map(|k| scale(2 * (k / 12) + usize::from(k % 12 > 2), 1.0)).collect()
            }
            // Of a pose six numbers, linear and angular.
            Kind::OutputVelocity(_) => (0..all).map(|k| scale(usize::from(all == 6 && k > 2), 1.0)).collect(),
            Kind::Output(_) => vec![scale(0, 1.0); all],
            // Inputs are measured as they are declared, each by itself.
            Kind::OutputJacobianU(_) => {
                let Shape::Matrix(_, inputs) = function.results[0].shape else { return each() };
                (0..all).map(|k| scale(k % inputs, 1.0)).collect()
            }
            Kind::OutputJacobian(_) | Kind::OutputJacobianQd(_) | Kind::OutputJacobianRate(_) => {
                rows(&|row| usize::from(all == 6 * n && row > 2), &|_, j| s[j])
            }
            Kind::Reaction(_) => (0..all).map(|k| scale(k / 3, 1.0)).collect(),
        }
    }
}
