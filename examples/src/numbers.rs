//! Numbers beside each other: how far they are apart.

use mbs_runtime::Pose;

/// The largest difference of two numbers at one place; NaN if one of them is.
#[must_use]
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |most, difference| if difference <= most || most.is_nan() { most } else { difference })
}

/// The largest difference of two poses, of positions and entries of the rotation alike; NaN if one has it.
#[must_use]
pub fn poses_apart(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    let entries = |pose: &Pose<f64>| [&pose.position[..], pose.rotation.as_flattened()].concat();
    apart(&entries(a), &entries(b))
}

#[cfg(test)]
mod tests {
    use super::apart;

    #[test]
    fn the_largest_difference_counts() {
        assert_eq!(apart(&[1.0, 2.0, 3.0], &[1.5, 0.0, 3.5]), 2.0);
        assert_eq!(apart(&[], &[]), 0.0);
        assert!(apart(&[f64::NAN, 2.0], &[0.0, 0.0]).is_nan() && apart(&[2.0, 0.0], &[0.0, f64::NAN]).is_nan());
    }
}
