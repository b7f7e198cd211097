//! Polynomials of degree five at most on `0 ≤ s ≤ 1`, their derivatives and their zeros.

/// Coefficients of a polynomial of degree 5 at most, the constant first.
pub(super) const COEFFICIENTS: usize = 6;

/// `Σ cₖ sᵏ` on `0 ≤ s ≤ 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polynomial(pub(super) [f64; COEFFICIENTS]);

impl Polynomial {
    /// By Horner's rule.
    pub(super) fn value(&self, s: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * s + c)
    }

    pub(super) fn derivative(&self) -> Self {
        let mut derivative = [0.0; COEFFICIENTS];
        for k in 1..COEFFICIENTS {
            derivative[k - 1] = k as f64 * self.0[k];
        }
        Self(derivative)
    }

    /// The highest power with a coefficient that is not zero.
    fn degree(&self) -> usize {
        self.0.iter().rposition(|c| *c != 0.0).unwrap_or(0)
    }

    /// Its zeros within `0 ≤ s ≤ 1` where its sign changes, in order, and how many there are.
    ///
    /// Between zeros of the derivative a polynomial is monotone: there a change of sign is one zero, and bisection
    /// finds it to the last bit. A zero without a change of sign is no extremum of the polynomial that this one is the
    /// derivative of, and is left out.
    pub(super) fn sign_changes(&self) -> ([f64; COEFFICIENTS], usize) {
        let (mut zeros, mut count) = ([0.0; COEFFICIENTS], 0);
        if self.degree() == 0 {
            return (zeros, 0);
        }
        let (turns, turn_count) = self.derivative().sign_changes();
        let mut low = 0.0;
        for i in 0..=turn_count {
            let high = if i < turn_count { turns[i] } else { 1.0 };
            if let Some(zero) = self.zero_between(low, high)
                && (count == 0 || zero > zeros[count - 1])
            {
                zeros[count] = zero;
                count += 1;
            }
            low = high;
        }
        (zeros, count)
    }

    /// Where it changes sign between `low` and `high`, if it is monotone there.
    fn zero_between(&self, mut low: f64, mut high: f64) -> Option<f64> {
        let (at_low, at_high) = (self.value(low), self.value(high));
        if at_low == 0.0 || at_high == 0.0 {
            return [(at_low, low), (at_high, high)].into_iter().find(|(value, _)| *value == 0.0).map(|(_, s)| s);
        }
        if (at_low < 0.0) == (at_high < 0.0) {
            return None;
        }
        loop {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                return Some(middle);
            }
            if (self.value(middle) < 0.0) == (at_low < 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(zeros: &[f64]) -> Polynomial {
        let mut c = [0.0; COEFFICIENTS];
        c[0] = 1.0;
        for (n, zero) in zeros.iter().enumerate() {
            for k in (0..=n + 1).rev() {
                c[k] = if k > 0 { c[k - 1] } else { 0.0 } - zero * c[k];
            }
        }
        Polynomial(c)
    }

    #[test]
    fn zeros_of_products() {
        let (zeros, count) = product(&[0.125, 0.25, 0.5, 0.75, 0.875]).sign_changes();
        assert_eq!(count, 5);
        for (found, expected) in zeros.iter().zip([0.125, 0.25, 0.5, 0.75, 0.875]) {
            assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
        }
        let (zeros, count) = product(&[-1.0, 0.3, 2.0]).sign_changes();
        assert_eq!(count, 1);
        assert!((zeros[0] - 0.3).abs() < 1e-15);
        assert_eq!(Polynomial([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]).sign_changes().1, 0);
    }

    #[test]
    fn values_and_derivatives() {
        let p = Polynomial([1.0, -2.0, 3.0, -4.0, 5.0, -6.0]);
        assert_eq!(p.value(1.0), -3.0);
        assert_eq!(p.derivative().0, [-2.0, 6.0, -12.0, 20.0, -30.0, 0.0]);
    }
}
