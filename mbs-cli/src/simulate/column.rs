//! The columns of a motion's table: names, units, and what they are.

use mbs_derive::variable::Variable;

/// A column.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// What it is one of, for the figure: `coordinates`.
    pub(crate) what: &'static str,
    /// In the header.
    pub(crate) name: String,
    /// In the figure.
    pub(crate) label: String,
    /// As the language writes it: `m/s^2`.
    pub(crate) unit: String,
}

impl Column {
    /// One that is called the same in header and figure.
    pub(crate) fn new(what: &'static str, name: &str, unit: &str) -> Self {
        Column { what, name: name.to_string(), label: name.to_string(), unit: unit.to_string() }
    }

    /// The name with the unit behind it: factors follow each other, `_` divides, exponents are digits, `per_` begins
    /// where nothing is above: `tip_m`, `x_dot_m_s`, `tau_Nm`, `rate_per_s`; a plain number has none. The tables of the
    /// examples are spelled so.
    pub(crate) fn name_with_unit(&self) -> String {
        let unit: String = self
            .unit
            .chars()
            .filter_map(|c| match c {
                '/' => Some('_'),
                '*' | '·' | '^' | '(' | ')' | ' ' => None,
                c => Some(
                    "⁰¹²³⁴⁵⁶⁷⁸⁹"
                        .chars()
                        .position(|raised| raised == c)
                        .map_or(c, |digit| char::from(b'0' + digit as u8)),
                ),
            })
            .collect();
        match unit.as_str() {
            "" | "1" => self.name.clone(),
            _ => {
                format!("{}_{}", self.name, unit.strip_prefix("1_").map_or(unit.clone(), |rest| format!("per_{rest}")))
            }
        }
    }
}

/// The components of some variables with a suffix to their names and units.
pub(crate) fn of_variables(what: &'static str, variables: &[Variable], suffix: &str, per: &str) -> Vec<Column> {
    let column = |v: &Variable, name: String| Column::new(what, &format!("{name}{suffix}"), &rate_unit(&v.unit, per));
    variables.iter().flat_map(|v| v.component_names().into_iter().map(|name| column(v, name))).collect()
}

/// `rad/s`, `1/s`, `m/s^2`, `(m/s)/s`
pub(crate) fn rate_unit(unit: &str, per: &str) -> String {
    match unit {
        _ if per.is_empty() => unit.to_string(),
        "" => format!("1{per}"),
        _ if unit.contains('/') => format!("({unit}){per}"),
        _ => format!("{unit}{per}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_rates() {
        assert_eq!(["rad", "1", "m/s"].map(|unit| rate_unit(unit, "/s")), ["rad/s", "1/s", "(m/s)/s"]);
        assert_eq!(rate_unit("m", "/s^2"), "m/s^2");
    }

    #[test]
    fn units_behind_names() {
        let name = |unit: &str| Column::new("outputs", "x", unit).name_with_unit();
        assert_eq!(
            ["m", "m/s", "m/s^2", "N*m", "1", "1/s"].map(name),
            ["x_m", "x_m_s", "x_m_s2", "x_Nm", "x", "x_per_s"]
        );
        assert_eq!(["kg*m^2/s^2", "kg·m²/s²"].map(name), ["x_kgm2_s2", "x_kgm2_s2"]);
    }
}
