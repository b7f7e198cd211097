//! What unit quaternions leave open. Their energies mean something only where the length is 1, so a derivative across
//! that sphere is nobody's: what has a component along the quaternion is compared without it, and what cannot be freed
//! of it is not.

use mbs_derive::optimise::FunctionKind;

/// How a function of a mechanism with quaternions is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Treatment {
    /// As it is.
    Whole,
    /// Without the component along each quaternion, row by row.
    Tangent,
    /// Without it in rows and columns.
    TangentTwice,
    /// Not at all.
    Not,
}

impl Treatment {
    /// Frees values of what is not compared.
    pub(super) fn apply(self, values: &mut Vec<f64>, q: &[f64], quaternions: &[usize]) {
        if matches!(self, Treatment::Tangent | Treatment::TangentTwice) {
            tangent(values, q, quaternions);
        }
        if self == Treatment::TangentTwice {
            transpose(values, q.len());
            tangent(values, q, quaternions);
        }
    }
}

pub(super) fn treatment(kind: &FunctionKind) -> Treatment {
    match kind {
        FunctionKind::KineticEnergy
        | FunctionKind::PotentialEnergy
        | FunctionKind::ForwardDynamics
        | FunctionKind::LinearizeParameters
        | FunctionKind::Constraint
        | FunctionKind::ConstraintRate
        | FunctionKind::Output(_)
        | FunctionKind::OutputVelocity(_)
        | FunctionKind::OutputJacobianU(_)
        | FunctionKind::Conserved => Treatment::Whole,
        FunctionKind::MassMatrix => Treatment::TangentTwice,
        FunctionKind::Momentum
        | FunctionKind::DissipationForce
        | FunctionKind::Gravity
        | FunctionKind::GeneralizedForce
        | FunctionKind::InverseDynamics
        | FunctionKind::ConstraintJacobian
        | FunctionKind::OutputJacobian(_)
        | FunctionKind::OutputJacobianQd(_) => Treatment::Tangent,
        // At q̈ = 0 the quaternion would leave the sphere.
        FunctionKind::Bias
        | FunctionKind::CoriolisMatrix
        | FunctionKind::Linearize
        | FunctionKind::InverseDynamicsJacobian
        | FunctionKind::ConstraintRateJacobian
        | FunctionKind::ConstraintBias
        | FunctionKind::Multipliers
        | FunctionKind::OutputJacobianRate(_)
        | FunctionKind::Reaction(_) => Treatment::Not,
    }
}

/// Rows of as many numbers as there are coordinates, each without its component along the quaternions.
fn tangent(values: &mut [f64], q: &[f64], quaternions: &[usize]) {
    for row in values.chunks_mut(q.len()) {
        for &first in quaternions {
            let (e, row) = (&q[first..first + 4], &mut row[first..first + 4]);
            let along: f64 = e.iter().zip(&*row).map(|(e, x)| e * x).sum();
            row.iter_mut().zip(e).for_each(|(x, e)| *x -= along * e);
        }
    }
}

/// Exchanges the rows and the columns of a square matrix.
fn transpose(values: &mut Vec<f64>, n: usize) {
    if values.len() == n * n {
        *values = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| values[i * n + j]).collect();
    }
}
