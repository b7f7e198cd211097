//! Names and counts as messages write them.

/// At most eight names.
pub(crate) fn abridged(names: &[String]) -> String {
    match names {
        [head @ .., last] if names.len() > 8 => format!("{}, …, {last}", head[..6].join(", ")),
        _ => names.join(", "),
    }
}

/// Numbers in a sentence: without noise, and no more than a dozen.
pub(crate) fn vector(numbers: &[f64]) -> String {
    const MOST: usize = 12;
    let shown = without_noise(numbers);
    if shown.len() <= MOST {
        return format!("{shown:?}");
    }
    let first: Vec<String> = shown[..MOST / 2].iter().map(|x| format!("{x:?}")).collect();
    format!("[{}, … {} numbers]", first.join(", "), shown.len())
}

/// Numbers for people: what is nothing but rounding beside 1, or beside the greatest of them if that is less, is 0.
pub(crate) fn without_noise(numbers: &[f64]) -> Vec<f64> {
    const ROUNDING: f64 = 1e-12;
    let greatest = numbers.iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
    // NaN stays.
    numbers.iter().map(|&x| if x.abs() <= ROUNDING * greatest.min(1.0) { 0.0 } else { x }).collect()
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
        // A satellite far away and its attitude.
        assert_eq!(without_noise(&[7e6, 1e-7]), [7e6, 1e-7]);
    }

    #[test]
    fn long_vectors_are_cut() {
        assert_eq!(vector(&[1.0, -1e-30]), "[1.0, 0.0]");
        assert_eq!(vector(&[2.0; 12]).matches("2.0").count(), 12);
        assert_eq!(vector(&[2.0; 81]), "[2.0, 2.0, 2.0, 2.0, 2.0, 2.0, … 81 numbers]");
    }
}
