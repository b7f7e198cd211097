//! Units as FMI has them: names, and exponents of base units.

use std::collections::BTreeMap;

use mbs_derive::model::Unit;

use super::xml::attribute;

/// The units of a mechanism's variables by their names.
#[derive(Default)]
pub(super) struct Units {
    known: BTreeMap<String, Option<[i16; 8]>>,
}

impl Units {
    /// The name of a unit, which is noted; none of plain numbers.
    pub(super) fn named(&mut self, unit: &str) -> Option<String> {
        let name = Unit(unit).in_ascii();
        if matches!(name.as_str(), "" | "1") {
            return None;
        }
        self.known.entry(name.clone()).or_insert_with(|| exponents(&name));
        Some(name)
    }

    /// `UnitDefinitions`; units whose exponents are not whole have a name alone.
    pub(super) fn definitions(&self) -> String {
        if self.known.is_empty() {
            return String::new();
        }
        let one = |(name, exponents): (&String, &Option<[i16; 8]>)| match exponents {
            None => format!("    <Unit{}/>\n", attribute("name", name)),
            Some(exponents) => {
                let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
                let given = names.iter().zip(exponents).filter(|(_, exponent)| **exponent != 0);
                let given: String = given.map(|(base, exponent)| attribute(base, &exponent.to_string())).collect();
                format!("    <Unit{}><BaseUnit{given}/></Unit>\n", attribute("name", name))
            }
        };
        format!("  <UnitDefinitions>\n{}  </UnitDefinitions>\n", self.known.iter().map(one).collect::<String>())
    }
}

/// Of kg, m, s, A, K, mol, cd and rad. Angles are plain numbers here, not in FMI: they are counted as if rad were cd.
fn exponents(unit: &str) -> Option<[i16; 8]> {
    const CANDELA: usize = 6;
    let [kg, m, s, ampere, kelvin, mol, cd] = Unit(unit).base_exponents()?;
    let rad = Unit(&unit.replace("rad", "cd")).base_exponents()?[CANDELA] - cd;
    Some([kg, m, s, ampere, kelvin, mol, cd, rad])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_base_units() {
        assert_eq!(exponents("rad"), Some([0, 0, 0, 0, 0, 0, 0, 1]));
        assert_eq!(exponents("N*m*s/rad"), Some([1, 2, -1, 0, 0, 0, 0, -1]));
        assert_eq!(exponents("(m/s)/s"), Some([0, 1, -2, 0, 0, 0, 0, 0]));
        assert_eq!(exponents(&Unit("kg·m²/s²").in_ascii()), Some([1, 2, -2, 0, 0, 0, 0, 0]));
        assert_eq!(exponents("m^(1/2)"), None);
    }
}
