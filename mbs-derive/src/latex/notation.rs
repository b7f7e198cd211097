//! Names of symbols, and units.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::Symbol;
use crate::model::Lagrangian;
use crate::variable::Variable;

/// How the symbols of a mechanism are written. Components of arrays are counted from 1, as rows of matrices are.
pub(super) struct Notation {
    pub(super) coordinates: Vec<Name>,
    pub(super) parameters: Vec<Name>,
    pub(super) inputs: Vec<Name>,
    pub(super) prescribed: Vec<Name>,
    /// Where each parameter stands in a product.
    pub(super) ranks: Vec<u32>,
    /// All names on the page.
    taken: BTreeSet<String>,
    /// Sines and cosines that are abbreviated, and what they are.
    pub(super) waves: BTreeMap<String, String>,
}

impl Notation {
    pub(super) fn of(lagrangian: &Lagrangian<'_>) -> Self {
        let mut taken = names_of_the_page(lagrangian);
        let mut names = |variables: &[Variable]| -> Vec<Name> {
            let pairs = variables.iter().flat_map(|v| v.component_names().into_iter().zip(counted_from_1(v)));
            pairs.map(|(declared, counted)| Name { declared, ..Name::unlike(&mut taken, &counted) }).collect()
        };
        let coordinates = names(&lagrangian.coordinates);
        let parameters = names(&lagrangian.parameters);
        let inputs = names(&lagrangian.inputs);
        let prescribed = names(&lagrangian.prescribed);
        let ranks = ranks(&lagrangian.parameters, &parameters);
        Notation { coordinates, parameters, inputs, prescribed, ranks, taken, waves: BTreeMap::new() }
    }

    /// A name for an abbreviation that nothing else on the page has: `b_1`, else `b_{1,a}`, `b_{1,b}`, ….
    pub(super) fn unique(&mut self, stem: &str, subscript: &str) -> String {
        let comma = if subscript.is_empty() { "" } else { "," };
        let others = (0..).map(|n| subscripted(stem, &format!("{subscript}{comma}{}", letters(n))));
        let name = std::iter::once(subscripted(stem, subscript)).chain(others).find(|name| !self.taken.contains(name));
        let name = name.expect("there are more names than abbreviations");
        self.taken.insert(name.clone());
        name
    }

    /// Whether a sine or cosine may have this name: it has this meaning alone.
    pub(super) fn wave(&mut self, name: &str, meaning: &str) -> bool {
        match self.waves.get(name) {
            Some(known) => known == meaning,
            None => {
                let is_free = self.taken.insert(name.to_string());
                if is_free {
                    self.waves.insert(name.to_string(), meaning.to_string());
                }
                is_free
            }
        }
    }

    /// The first of some letters that no declared name begins with.
    pub(super) fn free_letter(&self, letters: &[&'static str]) -> &'static str {
        let declared = || [&self.coordinates, &self.parameters, &self.inputs, &self.prescribed].into_iter().flatten();
        let is_free = |letter: &&&str| declared().all(|name| name.stem != ***letter);
        letters.iter().find(is_free).or(letters.last()).copied().unwrap_or("b")
    }

    /// The components of a coordinate as they stand in q: `x`, `q_0, \dots, q_5`.
    pub(super) fn components(&self, variable: &Variable) -> String {
        let names: Vec<String> =
            self.coordinates[variable.first..][..variable.count()].iter().map(Name::text).collect();
        match names.as_slice() {
            [first, _, _, .., last] => format!("{first}, \\dots, {last}"),
            few => few.join(", "),
        }
    }

    pub(super) fn symbol(&self, symbol: Symbol) -> String {
        match symbol {
            Symbol::Time => "t".to_string(),
            Symbol::Coordinate(i) => self.coordinates[i as usize].text(),
            Symbol::Velocity(i) => self.coordinates[i as usize].accented("\\dot"),
            Symbol::Acceleration(i) => self.coordinates[i as usize].accented("\\ddot"),
            Symbol::Parameter(i) => self.parameters[i as usize].text(),
            Symbol::Input(i) => self.inputs[i as usize].text(),
            Symbol::Prescribed(i, 0) => self.prescribed[i as usize].text(),
            Symbol::Prescribed(i, 1) => self.prescribed[i as usize].accented("\\dot"),
            Symbol::Prescribed(i, _) => self.prescribed[i as usize].accented("\\ddot"),
            Symbol::Multiplier(i) => subscripted("\\lambda", &(i + 1).to_string()),
        }
    }
}

/// What a page calls its energies and multipliers, and the base of exponentials.
fn names_of_the_page(lagrangian: &Lagrangian<'_>) -> BTreeSet<String> {
    let always = ["t", "T", "V", "E", "e"];
    let dissipation = (!lagrangian.dissipation.is_empty()).then_some("D");
    let others = (!lagrangian.lagrangian.is_empty()).then_some("L");
    let multipliers = (1..=lagrangian.holonomic_rows().len()).map(|i| subscripted("\\lambda", &i.to_string()));
    always.into_iter().chain(dissipation).chain(others).map(str::to_string).chain(multipliers).collect()
}

/// `x`, or `q_1`, `q_2`, …; of a matrix `a_1_1`, `a_1_2`, …, row by row.
fn counted_from_1(variable: &Variable) -> Vec<String> {
    let Variable { name, length, columns, .. } = variable;
    match (length, columns) {
        (None, _) => vec![name.clone()],
        (Some(n), None) => (1..=*n).map(|i| format!("{name}_{i}")).collect(),
        (Some(n), Some(columns)) => {
            (0..*n).map(|i| format!("{name}_{}_{}", i / columns + 1, i % columns + 1)).collect()
        }
    }
}

/// `a`, `b`, …, `z`, `aa`, `ab`, …
fn letters(n: usize) -> String {
    let last = char::from(b'a' + (n % 26) as u8);
    if n < 26 { last.to_string() } else { format!("{}{last}", letters(n / 26 - 1)) }
}

/// `m g l`: coefficients before gravity before lengths, one letter's symbols together, else as declared.
fn ranks(parameters: &[Variable], names: &[Name]) -> Vec<u32> {
    let units = parameters.iter().flat_map(|variable| std::iter::repeat_n(variable.unit.as_str(), variable.count()));
    let kind = |unit: &str| match unit {
        unit if unit.contains("kg") || unit.contains(['N', 'J', 'W']) => 0,
        "m/s^2" | "m/s/s" | "m*s^-2" => 1,
        _ => 2,
    };
    let letter = |name: &Name| names.iter().position(|other| other.stem == name.stem);
    let mut order: Vec<_> =
        units.zip(names).enumerate().map(|(i, (unit, name))| (kind(unit), letter(name), i)).collect();
    order.sort();
    let mut ranks = vec![0; order.len()];
    for (rank, (_, _, i)) in order.into_iter().enumerate() {
        ranks[i] = rank as u32;
    }
    ranks
}

/// A letter with its subscripts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    pub(super) declared: String,
    pub(super) stem: String,
    pub(super) subscript: String,
}

impl Name {
    /// `theta1` → θ₁, `m_bob` → m with the subscript bob, `lc2` → l with c2, `Ixx` → I with xx.
    pub(super) fn new(declared: &str) -> Self {
        let mut parts = declared.split('_').filter(|part| !part.is_empty());
        let first = parts.next().unwrap_or("x");
        let word = first.trim_end_matches(|c: char| c.is_ascii_digit());
        let (word, digits) = if word.is_empty() { (first, "") } else { (word, &first[word.len()..]) };
        let (stem, mut letters) = stem_and_letters(word);
        letters.push_str(digits);
        let subscripts: Vec<String> =
            std::iter::once(letters).filter(|text| !text.is_empty()).chain(parts.map(subscript_part)).collect();
        Name { declared: declared.to_string(), stem, subscript: subscripts.join(",") }
    }

    /// A name that looks like none of those taken: `m1` beside `m_1` is written out, a letter gets a tilde.
    pub(super) fn unlike(taken: &mut BTreeSet<String>, declared: &str) -> Self {
        let mut name = Name::new(declared);
        if taken.contains(&name.text()) && declared.len() > 1 {
            let stem = format!("\\mathrm{{{}}}", declared.replace('_', "\\_"));
            name = Name { declared: declared.to_string(), stem, subscript: String::new() };
        }
        while taken.contains(&name.text()) {
            name.stem = format!("\\tilde{{{}}}", name.stem);
        }
        taken.insert(name.text());
        name
    }

    pub(super) fn text(&self) -> String {
        subscripted(&self.stem, &self.subscript)
    }

    pub(super) fn accented(&self, accent: &str) -> String {
        subscripted(&format!("{accent}{{{}}}", self.stem), &self.subscript)
    }
}

/// The letter of a word, and what of it becomes a subscript.
fn stem_and_letters(word: &str) -> (String, String) {
    let letters: Vec<char> = word.chars().collect();
    match (greek(word), letters.as_slice()) {
        (Some(command), _) => (command, String::new()),
        (None, [letter]) => (letter.to_string(), String::new()),
        (None, [letter, one]) => (letter.to_string(), one.to_string()),
        (None, [letter, axes @ ..]) if axes.iter().all(|c| "xyz".contains(*c)) => {
            (letter.to_string(), axes.iter().collect())
        }
        _ => (format!("\\mathrm{{{word}}}"), String::new()),
    }
}

/// Digits, single letters and axes in italics, words upright.
fn subscript_part(part: &str) -> String {
    let word = part.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &part[word.len()..];
    let italic = word.chars().count() <= 1 || word.chars().all(|c| "xyz".contains(c));
    match greek(word) {
        Some(command) if digits.is_empty() => command,
        Some(command) => format!("{command} {digits}"),
        None if italic => part.to_string(),
        None => format!("\\mathrm{{{word}}}{digits}"),
    }
}

fn greek(word: &str) -> Option<String> {
    const LOWER: [&str; 28] = [
        "alpha",
        "beta",
        "gamma",
        "delta",
        "epsilon",
        "zeta",
        "eta",
        "theta",
        "iota",
        "kappa",
        "lambda",
        "mu",
        "nu",
        "xi",
        "pi",
        "rho",
        "sigma",
        "tau",
        "upsilon",
        "phi",
        "chi",
        "psi",
        "omega",
        "ell",
        "varphi",
        "vartheta",
        "varepsilon",
        "varrho",
    ];
    const UPPER: [&str; 11] =
        ["Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega"];
    (LOWER.contains(&word) || UPPER.contains(&word)).then(|| format!("\\{word}"))
}

pub(super) fn subscripted(stem: &str, subscript: &str) -> String {
    if subscript.is_empty() {
        return stem.to_string();
    }
    format!("{stem}{}", script('_', subscript))
}

/// `_1`, `_{12}`
pub(super) fn script(mark: char, text: &str) -> String {
    if text.chars().count() == 1 { format!("{mark}{text}") } else { format!("{mark}{{{text}}}") }
}

/// `$q_1$, $q_2$`, `$q_1, \dots, q_9$`
pub(super) fn listed(names: &[String]) -> String {
    match names {
        [first, _, _, .., last] => format!("${first}$, \\dots, ${last}$"),
        few => few.iter().map(|name| format!("${name}$")).collect::<Vec<_>>().join(", "),
    }
}

/// `kg*m^2/s^2` as mathematics, upright.
pub(super) fn unit(text: &str) -> String {
    let mut unit = String::new();
    let mut rest = text.chars().filter(|c| !c.is_whitespace()).peekable();
    while let Some(c) = rest.next() {
        match c {
            '*' => unit.push_str("\\,"),
            '^' => {
                let in_brackets = rest.next_if_eq(&'(').is_some();
                let mut exponent = String::new();
                let belongs = |c: &char| c.is_ascii_digit() || *c == '-' || (in_brackets && *c == '/');
                while let Some(digit) = rest.next_if(belongs) {
                    exponent.push(digit);
                }
                if in_brackets {
                    rest.next_if_eq(&')');
                }
                unit.push_str(&script('^', &exponent));
            }
            c if c.is_ascii_alphanumeric() || "/().-".contains(c) => unit.push(c),
            _ => {}
        }
    }
    format!("$\\mathrm{{{unit}}}$")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_letters_with_subscripts() {
        let name = |declared: &str| Name::new(declared).text();
        assert_eq!(["theta", "theta1", "theta_1", "Omega"].map(name), [r"\theta", r"\theta_1", r"\theta_1", r"\Omega"]);
        assert_eq!(
            ["m2", "m_bob", "m_bob2", "m12"].map(name),
            ["m_2", r"m_{\mathrm{bob}}", r"m_{\mathrm{bob}2}", "m_{12}"]
        );
        assert_eq!(["q_3", "q_10", "k_1_2", "i_xx_0"].map(name), ["q_3", "q_{10}", "k_{1,2}", "i_{xx,0}"]);
        assert_eq!(["lc1", "Ixx", "mu", "g"].map(name), ["l_{c1}", "I_{xx}", r"\mu", "g"]);
        assert_eq!(["length", "k_phi", "_a"].map(name), [r"\mathrm{length}", r"k_{\phi}", "a"]);
        assert_eq!(Name::new("theta1").accented("\\dot"), r"\dot{\theta}_1");
        let mut taken = BTreeSet::new();
        assert_eq!(["m_1", "m1"].map(|n| Name::unlike(&mut taken, n).text()), ["m_1", r"\mathrm{m1}"]);
        assert_eq!(unit("kg*m^2/s^(-1/2)"), r"$\mathrm{kg\,m^2/s^{-1/2}}$");
    }
}
