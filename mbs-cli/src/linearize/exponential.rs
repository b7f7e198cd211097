//! The exponential of a matrix.

use nalgebra::DMatrix;

/// The degree of the Padé approximant; with `|A| ≤ 1/2` it is exact to 3.4e-16.
const DEGREE: u32 = 6;

/// `exp A` by scaling, a diagonal Padé approximant and squaring (Golub and Van Loan, Matrix Computations, 2013,
/// algorithm 9.3.1); `None` where it leaves the range of numbers.
pub(super) fn exponential(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut norm = a.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
    let (mut part, mut squarings) = (1.0, 0);
    if !norm.is_finite() || a.iter().any(|x| x.is_nan()) {
        return None;
    }
    while norm > 0.5 {
        (norm, part, squarings) = (0.5 * norm, 0.5 * part, squarings + 1);
    }
    let scaled = a * part;
    let mut power = DMatrix::identity(a.nrows(), a.ncols());
    let (mut numerator, mut denominator) = (power.clone(), power.clone());
    let mut coefficient = 1.0;
    for k in 1..=DEGREE {
        coefficient *= f64::from(DEGREE - k + 1) / f64::from(k * (2 * DEGREE - k + 1));
        power = &scaled * power;
        numerator += &power * coefficient;
        denominator += &power * if k % 2 == 0 { coefficient } else { -coefficient };
    }
    let mut exponential = denominator.lu().solve(&numerator)?;
    for _ in 0..squarings {
        exponential = &exponential * &exponential;
    }
    exponential.iter().all(|x| x.is_finite()).then_some(exponential)
}

#[cfg(test)]
mod tests {
    use super::exponential;
    use nalgebra::DMatrix;

    fn square<const N: usize>(rows: [[f64; N]; N]) -> DMatrix<f64> {
        DMatrix::from_fn(N, N, |i, j| rows[i][j])
    }

    #[test]
    fn closed_forms_are_met() {
        // A rotation by φ, its growth by e^σ, and a chain of integrators.
        for (sigma, phi) in [(0.0, 0.3_f64), (-2.0, 7.0), (3.0, -40.0), (0.0, 0.0)] {
            let found = exponential(&square([[sigma, -phi], [phi, sigma]])).unwrap();
            let expected = square([[phi.cos(), -phi.sin()], [phi.sin(), phi.cos()]]) * f64::exp(sigma);
            assert!((found - &expected).amax() < 3e-14 * expected.amax(), "{sigma}, {phi}");
        }
        let chain = exponential(&square([[0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [0.0; 3]])).unwrap();
        assert!((chain - square([[1.0, 4.0, 8.0], [0.0, 1.0, 4.0], [0.0, 0.0, 1.0]])).amax() < 1e-14);
        assert_eq!(exponential(&DMatrix::zeros(0, 0)), Some(DMatrix::zeros(0, 0)));
    }

    #[test]
    fn what_leaves_the_range_of_numbers_is_none() {
        for entry in [1e4, f64::INFINITY, f64::NAN] {
            assert_eq!(exponential(&square([[entry, 0.0], [0.0, 1.0]])), None, "{entry}");
        }
    }
}
