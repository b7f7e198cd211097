//! Mechanisms that may be driven, have friction and constraints: what `mbs eval` shows of them, from formulas typed by
//! hand.
//!
//! What is driven (times, prescribed motions, inputs) is held by the reference at its momentary value.

use nalgebra::{DMatrix, DVector};

/// `M q̈ + h = F + Aᵀλ` and `A q̈ + γ = 0`.
pub trait Dynamics<const N: usize> {
    /// `M = ∂²L/∂q̇²`.
    fn mass_matrix(&self, q: &[f64; N]) -> [[f64; N]; N];

    /// `h`: what is left of Lagrange's equations where `q̈ = 0` and nothing acts.
    fn bias(&self, q: &[f64; N], qd: &[f64; N]) -> [f64; N];

    /// `F = Q − ∂D/∂q̇`: inputs, declared forces and friction.
    fn force(&self, _q: &[f64; N], _qd: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }

    /// The rows of `A`, each with its entry of `γ`.
    fn constraints(&self, _q: &[f64; N], _qd: &[f64; N]) -> Vec<([f64; N], f64)> {
        Vec::new()
    }
}

/// How a mechanism moves at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<const N: usize> {
    /// `q̈`.
    pub accelerations: [f64; N],
    /// `λ`.
    pub multipliers: Vec<f64>,
    /// Largest over smallest singular value of the system they solve.
    pub condition: f64,
}

/// Solves `[M, −Aᵀ; A, 0] [q̈; λ] = [F − h; −γ]` as a whole; none where the matrix is singular.
pub fn motion<const N: usize>(system: &impl Dynamics<N>, q: &[f64; N], qd: &[f64; N]) -> Option<Motion<N>> {
    let (m, h, force) = (system.mass_matrix(q), system.bias(q, qd), system.force(q, qd));
    let rows = system.constraints(q, qd);
    let size = N + rows.len();
    let matrix = DMatrix::from_fn(size, size, |i, j| match (i < N, j < N) {
        (true, true) => m[i][j],
        (true, false) => -rows[j - N].0[i],
        (false, true) => rows[i - N].0[j],
        (false, false) => 0.0,
    });
    let right = DVector::from_fn(size, |i, _| if i < N { force[i] - h[i] } else { -rows[i - N].1 });
    let singular = matrix.singular_values();
    let solution = matrix.full_piv_lu().solve(&right)?;
    Some(Motion {
        accelerations: std::array::from_fn(|i| solution[i]),
        multipliers: solution.as_slice()[N..].to_vec(),
        condition: singular.max() / singular.min(),
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::lagrange::{self, Energies};
    use crate::reference::tests::ROUND_OFF;

    /// `M` and `h` against nested dual numbers over energies that come from elsewhere.
    pub(crate) fn agrees_with_lagrange<const N: usize>(closed: &impl Dynamics<N>, energies: &impl Energies<N>) {
        for state in &states::<N>(2025, 60) {
            let (q, qd) = (&state.q, &state.qd);
            let m = lagrange::mass_matrix(energies, q);
            assert_close(&format!("M at {state:?}"), &closed.mass_matrix(q).concat(), &m.concat(), ROUND_OFF);
            let h = lagrange::euler_lagrange(energies, q, qd, &[0.0; N]);
            assert_close(&format!("h at {state:?}"), &closed.bias(q, qd), &h, ROUND_OFF);
        }
    }

    /// Masses 2 and 3 on one line, tied together: they share a force of 10 as 4 and 6.
    struct Tied;

    impl Dynamics<2> for Tied {
        fn mass_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
            [[2.0, 0.0], [0.0, 3.0]]
        }
        fn bias(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
            [0.0; 2]
        }
        fn force(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
            [10.0, 0.0]
        }
        fn constraints(&self, _: &[f64; 2], _: &[f64; 2]) -> Vec<([f64; 2], f64)> {
            vec![([1.0, -1.0], 0.0)]
        }
    }

    #[test]
    fn masses_tied_together() {
        let motion = motion(&Tied, &[0.0; 2], &[0.0; 2]).expect("regular");
        assert_close("q̈", &motion.accelerations, &[2.0, 2.0], ROUND_OFF);
        assert_close("λ", &motion.multipliers, &[-6.0], ROUND_OFF);
    }
}
