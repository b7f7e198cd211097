//! What a plan may speak of.

/// The variables that a plan may fix or vary, and how it writes their values.
pub trait Vocabulary {
    /// The unit that the numbers of a variable are in; `None` where there is no such variable.
    fn unit(&self, name: &str) -> Option<String>;

    /// All names, for hints.
    fn names(&self) -> Vec<String>;

    /// The number, in this unit, of a text such as `20 deg`.
    ///
    /// # Errors
    /// As the end of a sentence: it is not a number with a unit, or the unit does not fit.
    fn number(&self, text: &str, unit: &str) -> Result<f64, String>;
}

/// A list of variables with their units: what a program that has no mechanism gives a plan to vary.
///
/// Values are plain numbers, or texts with exactly this unit.
#[derive(Clone, Debug, Default)]
pub struct Variables(Vec<(String, String)>);

impl Variables {
    /// Names with units, `1` for plain numbers.
    pub fn new<'a>(variables: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        Variables(variables.into_iter().map(|(name, unit)| (name.to_string(), unit.to_string())).collect())
    }
}

impl Vocabulary for Variables {
    fn unit(&self, name: &str) -> Option<String> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, unit)| unit.clone())
    }

    fn names(&self) -> Vec<String> {
        self.0.iter().map(|(name, _)| name.clone()).collect()
    }

    fn number(&self, text: &str, unit: &str) -> Result<f64, String> {
        // Of plain numbers `1` is no suffix.
        let number = text.strip_suffix(unit).filter(|_| unit != "1").unwrap_or(text);
        number.trim().parse().map_err(|_| format!("write a number in {unit}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_to_their_last_digit() {
        let variables = Variables::default();
        let number = |text, unit| variables.number(text, unit);
        assert_eq!(["0.21", "21", "1", " 1e1 "].map(|text| number(text, "1")), [Ok(0.21), Ok(21.0), Ok(1.0), Ok(10.0)]);
        assert_eq!(["2.1 m", "21m", "0.1"].map(|text| number(text, "m")), [Ok(2.1), Ok(21.0), Ok(0.1)]);
        assert_eq!(number("2 kg", "m"), Err("write a number in m".to_string()));
        assert!(number("2 kg", "1").is_err() && number("", "1").is_err());
    }
}
