//! Names and counts as messages write them.

/// At most eight names.
pub(crate) fn abridged(names: &[String]) -> String {
    match names {
        [head @ .., last] if names.len() > 8 => format!("{}, …, {last}", head[..6].join(", ")),
        _ => names.join(", "),
    }
}

/// Numbers for people: what is nothing but rounding beside the greatest of them is 0.
pub(crate) fn without_noise(numbers: &[f64]) -> Vec<f64> {
    const ROUNDING: f64 = 1e-12;
    let greatest = numbers.iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
    // NaN stays.
    numbers.iter().map(|&x| if x.abs() <= ROUNDING * greatest { 0.0 } else { x }).collect()
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero() {
        assert_eq!(format!("{:?}", without_noise(&[0.0, -4e-26, 0.2, 1e-9])), "[0.0, 0.0, 0.2, 1e-9]");
        assert_eq!(format!("{:?}", without_noise(&[-0.0, -0.0])), "[0.0, 0.0]");
        assert_eq!(without_noise(&[1e-30, 2e-30]), [1e-30, 2e-30]);
        assert!(without_noise(&[f64::NAN, 1.0])[0].is_nan());
    }
}
