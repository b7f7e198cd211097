//! One error measure for numbers, vectors and matrices, given as flat slices.

/// Largest difference of `got` and `want`, over `1 + max |want|`.
///
/// Relative to the largest entry where the entries are large, absolute where they are small: a torque that cancels to
/// zero beside one of 6000 N·m carries the round-off of the large one. NaN where either side is NaN.
///
/// # Panics
///
/// If the lengths differ.
pub fn error(got: &[f64], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len(), "lengths differ");
    let difference = largest(got.iter().zip(want).map(|(got, want)| got - want));
    difference / (1.0 + largest(want.iter().copied()))
}

/// Panics with `what` and both sides unless [`error`] is at most `tolerance`.
///
/// # Panics
///
/// On a disagreement, on NaN, and on different lengths.
#[track_caller]
pub fn assert_close(what: &str, got: &[f64], want: &[f64], tolerance: f64) {
    let error = error(got, want);
    // NaN compares false and is refused.
    assert!(error <= tolerance, "{what}: error {error:e} > {tolerance:e}\n got: {got:?}\nwant: {want:?}");
}

/// Largest magnitude; unlike a fold over `f64::max`, NaN if any value is.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| if value.abs() <= largest { largest } else { value.abs() + 0.0 * largest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_is_relative_to_the_largest_entry() {
        assert_eq!(error(&[999.0, 0.0], &[999.0, 10.0]), 10.0 / 1000.0);
        assert_eq!(error(&[0.5], &[0.0]), 0.5);
    }

    #[test]
    fn nan_is_never_close() {
        for (got, want) in [([f64::NAN, 1.0], [0.0, 1.0]), ([0.0, f64::NAN], [0.0, 1.0]), ([0.0, 1.0], [f64::NAN, 1.0])]
        {
            assert!(error(&got, &want).is_nan());
        }
    }

    #[test]
    #[should_panic(expected = "mass matrix: error")]
    fn assertion_names_what_differs() {
        assert_close("mass matrix", &[1.0], &[1.0 + 1e-9], 1e-10);
    }
}
