//! From an index to a member's values.
//!
//! A grid's values meet each other: all combinations. What is drawn is drawn `members` times, and each draw meets all
//! points of the grid, so that differences along the grid are not those of luck. The member with index k is draw
//! `k / points` at grid point `k % points`.

use chacha20::ChaCha8Rng;
use nalgebra::DMatrix;
use statrs::distribution::ContinuousCDF;

use crate::distribution::{Distribution, standard};
use crate::fault::{Fault, Faults};
use crate::plan::{Amount, Located, Named, Plan, Spread};
use crate::sequence::{Kind, Purpose, Sequence, random};
use crate::statistics::chaos::nodes;
use crate::vocabulary::Vocabulary;

/// What varies: its name, its unit, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// As the plan calls it.
    pub name: String,
    /// That of its numbers.
    pub unit: String,
    /// How it varies.
    pub spread: Values,
}

/// The values of one variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// These.
    Listed(Vec<f64>),
    /// Equally far apart, both ends included.
    Range {
        /// The first value.
        from: f64,
        /// The last value.
        to: f64,
        /// How many.
        count: u64,
    },
    /// Drawn.
    Drawn(Distribution),
}

impl Values {
    /// How many values of a grid there are.
    fn count(&self) -> Option<u64> {
        match self {
            Values::Listed(values) => Some(values.len() as u64),
            Values::Range { count, .. } => Some(*count),
            Values::Drawn(_) => None,
        }
    }

    /// The value of a grid with this index.
    fn at(&self, index: u64) -> f64 {
        match self {
            Values::Listed(values) => values[index as usize],
            Values::Range { to, count, .. } if index > 0 && index + 1 == *count => *to,
            Values::Range { from, to, count } => {
                from + (to - from) * (index as f64 / count.saturating_sub(1).max(1) as f64)
            }
            Values::Drawn(_) => f64::NAN,
        }
    }
}

/// All members of an ensemble, none of which is kept.
#[derive(Clone, Debug)]
pub struct Design {
    variables: Vec<Variable>,
    fixed: Vec<(String, f64)>,
    seed: u64,
    kind: Kind,
    draws: u64,
    points: u64,
    sequence: Sequence,
    /// The lower factor of the correlations of what is drawn, if any.
    factor: Option<DMatrix<f64>>,
    /// Of the design `chaos`: the degree of its polynomials, and the values of each variable.
    rules: Option<(usize, Vec<Vec<f64>>)>,
}

/// One member.
#[derive(Clone, Debug)]
pub struct Member {
    /// From 0.
    pub index: u64,
    /// In the order of [`Design::variables`].
    pub values: Vec<f64>,
    seed: u64,
}

impl Member {
    /// Random numbers for what happens during its motion, such as noise; the same at every call.
    pub fn random(&self) -> ChaCha8Rng {
        random(self.seed, Purpose::Motion, self.index)
    }
}

impl Plan {
    /// The members of a plan, whose variables are those of a vocabulary.
    ///
    /// # Errors
    /// Names that are not known or given twice, units that do not fit, values that are not a distribution, correlations
    /// that contradict each other, more members than can be counted.
    pub fn design(&self, vocabulary: &dyn Vocabulary) -> Result<Design, Faults> {
        let mut resolver = Resolver { vocabulary, faults: Vec::new() };
        let variables: Vec<Option<Variable>> = self.vary.iter().map(|entry| resolver.variable(entry)).collect();
        let fixed: Vec<Option<(String, f64)>> = self.fixed.iter().map(|entry| resolver.fixed(entry)).collect();
        for entry in &self.fixed {
            if self.vary.iter().any(|other| other.name.value == entry.name.value) {
                let message = format!("`{}` is fixed here and varies in [vary]", entry.name.value);
                resolver.faults.push(Fault::new(entry.name.span.clone(), message));
            }
        }
        let Some(variables) = variables.into_iter().collect::<Option<Vec<_>>>() else {
            return Err(resolver.faults.into());
        };
        let factor = resolver.factor(self, &variables);
        let points = variables.iter().filter_map(|v| v.spread.count()).try_fold(1_u64, u64::checked_mul);
        let drawn = variables.iter().filter(|variable| matches!(variable.spread, Values::Drawn(_))).count();
        let rows = self.members.as_ref().map_or(1, |members| members.value);
        if matches!(self.kind, Kind::Saltelli | Kind::Chaos) {
            resolver.check_rows(self, &variables);
        }
        let rules = resolver.rules(self, &variables);
        let draws = match &rules {
            None => rows.checked_mul(Sequence::row(self.kind, drawn)),
            Some((_, rules)) => rules.iter().try_fold(1_u64, |product, rule| product.checked_mul(rule.len() as u64)),
        };
        if let (Some(members), true) = (&self.members, drawn == 0 && !variables.is_empty()) {
            let message = "nothing is drawn: the grid alone says how many members there are";
            resolver.faults.push(Fault::new(members.span.clone(), message));
        }
        let whole = self.members.as_ref().map_or(0..0, |members| members.span.clone());
        let counted = points.zip(draws).filter(|(points, draws)| points.checked_mul(*draws).is_some());
        let Some((points, draws)) = counted else {
            resolver.faults.push(Fault::new(whole, "there are more members than can be counted"));
            return Err(resolver.faults.into());
        };
        let Some(sequence) = Sequence::new(self.kind, self.seed, rows, drawn) else {
            let message = format!("Sobol's sequence has {} dimensions: too few", Sequence::MOST_DIMENSIONS);
            resolver.faults.push(Fault::new(whole, message));
            return Err(resolver.faults.into());
        };
        let fixed = fixed.into_iter().flatten().collect();
        Faults::finish(
            resolver.faults,
            Design { variables, fixed, seed: self.seed, kind: self.kind, draws, points, sequence, factor, rules },
        )
    }
}

impl Design {
    /// How many there are.
    pub fn members(&self) -> u64 {
        self.draws * self.points
    }

    /// How what is drawn fills its space.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether members are drawn independently of each other: not on a grid, nor in a row, a hypercube or a sequence.
    pub fn draws_independently(&self) -> bool {
        self.points == 1 && self.kind == Kind::Random
    }

    /// The degree of the polynomials of the design `chaos`; `None` of others.
    pub fn degree(&self) -> Option<usize> {
        self.rules.as_ref().map(|(degree, _)| *degree)
    }

    /// The distributions of what is drawn, in the order of the plan.
    pub fn distributions(&self) -> Vec<Distribution> {
        let drawn = self.variables.iter().filter_map(|variable| match variable.spread {
            Values::Drawn(distribution) => Some(distribution),
            _ => None,
        });
        drawn.collect()
    }

    /// What all random numbers come from.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// What varies, in the order of the plan.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// What all members share, in the order of the plan.
    pub fn fixed(&self) -> &[(String, f64)] {
        &self.fixed
    }

    /// The values of a member, in the order of [`variables`](Self::variables).
    pub fn values(&self, index: u64) -> Vec<f64> {
        let mut drawn = self.drawn(index / self.points).into_iter();
        let mut point = index % self.points;
        // The last variable of the grid changes first.
        let mut digits: Vec<u64> = Vec::new();
        for variable in self.variables.iter().rev() {
            if let Some(count) = variable.spread.count() {
                digits.push(point % count);
                point /= count;
            }
        }
        let value = |variable: &Variable| match &variable.spread {
            Values::Drawn(_) => drawn.next().unwrap_or(f64::NAN),
            grid => grid.at(digits.pop().unwrap_or(0)),
        };
        self.variables.iter().map(value).collect()
    }

    /// What is drawn, in the order of the plan.
    fn drawn(&self, draw: u64) -> Vec<f64> {
        if let Some((_, rules)) = &self.rules {
            // The last variable changes first.
            let mut rest = draw;
            let mut values: Vec<f64> = Vec::new();
            for rule in rules.iter().rev() {
                values.push(rule[(rest % rule.len() as u64) as usize]);
                rest /= rule.len() as u64;
            }
            values.reverse();
            return values;
        }
        let point = self.sequence.point(draw);
        let distributions = self.distributions().into_iter();
        let Some(factor) = &self.factor else {
            return distributions.zip(point).map(|(distribution, p)| distribution.quantile(p)).collect();
        };
        let deviates: Vec<f64> = point.into_iter().map(|p| standard().inverse_cdf(p)).collect();
        let mixed = |row: usize| (0..=row).map(|k| factor[(row, k)] * deviates[k]).sum::<f64>();
        distributions.enumerate().map(|(row, distribution)| distribution.at_deviate(mixed(row))).collect()
    }

    /// A member with its values.
    pub fn member(&self, index: u64) -> Member {
        Member { index, values: self.values(index), seed: self.seed }
    }
}

struct Resolver<'v> {
    vocabulary: &'v dyn Vocabulary,
    faults: Vec<Fault>,
}

impl Resolver<'_> {
    fn fault<T>(&mut self, fault: Fault) -> Option<T> {
        self.faults.push(fault);
        None
    }

    fn unit(&mut self, name: &Located<String>) -> Option<String> {
        let unit = self.vocabulary.unit(&name.value);
        unit.or_else(|| {
            let known = self.vocabulary.names();
            self.fault(Fault::unknown(name.span.clone(), "variable", &name.value, &known))
        })
    }

    fn number(&mut self, amount: &Located<Amount>, unit: &str) -> Option<f64> {
        match &amount.value {
            Amount::Number(number) => Some(*number),
            Amount::Text(text) => match self.vocabulary.number(text, unit) {
                Ok(number) => Some(number),
                Err(reason) => self.fault(Fault::new(amount.span.clone(), format!("{text:?}: {reason}"))),
            },
        }
    }

    fn numbers<const N: usize>(&mut self, amounts: &[Located<Amount>; N], unit: &str) -> Option<[f64; N]> {
        let numbers: Vec<Option<f64>> = amounts.iter().map(|amount| self.number(amount, unit)).collect();
        numbers.into_iter().collect::<Option<Vec<f64>>>()?.try_into().ok()
    }

    fn fixed(&mut self, entry: &Named<Located<Amount>>) -> Option<(String, f64)> {
        let unit = self.unit(&entry.name)?;
        Some((entry.name.value.clone(), self.finite(&entry.value, &unit)?))
    }

    /// A value that members have: infinite is what bounds a distribution, nothing else.
    fn finite(&mut self, amount: &Located<Amount>, unit: &str) -> Option<f64> {
        let number = self.number(amount, unit)?;
        if number.is_finite() {
            return Some(number);
        }
        self.fault(Fault::new(amount.span.clone(), format!("a value must be finite, this is {number}")))
    }

    /// The values of a grid from one to another.
    fn range(&mut self, [from, to]: [&Located<Amount>; 2], count: u64, unit: &str) -> Option<Values> {
        let ends = [from, to].map(|end| self.finite(end, unit));
        let [Some(low), Some(high)] = ends else { return None };
        if !(high - low).is_finite() {
            let message = format!("the distance from {low:e} to {high:e} is not finite");
            return self.fault(Fault::new(to.span.clone(), message));
        }
        if count == 1 && low != high {
            return self
                .fault(Fault::new(to.span.clone(), "one value cannot be both ends: write a `count` of 2 or more"));
        }
        Some(Values::Range { from: low, to: high, count })
    }

    fn variable(&mut self, entry: &Named<Located<Spread>>) -> Option<Variable> {
        let unit = self.unit(&entry.name)?;
        let spread = match &entry.value.value {
            Spread::Values(values) => {
                let numbers: Vec<Option<f64>> = values.iter().map(|value| self.finite(value, &unit)).collect();
                Values::Listed(numbers.into_iter().collect::<Option<_>>()?)
            }
            Spread::Range { from, to, count } => self.range([from, to], *count, &unit)?,
            Spread::Uniform(bounds) => {
                let [low, high] = self.numbers(bounds, &unit)?;
                Values::Drawn(Distribution::Uniform { low, high })
            }
            Spread::Triangular(places) => {
                let [low, mode, high] = self.numbers(places, &unit)?;
                Values::Drawn(Distribution::Triangular { low, mode, high })
            }
            Spread::Normal { of, within } => {
                let moments = self.numbers(of, &unit);
                let bounds = within.as_ref().map(|within| self.numbers(within, &unit));
                let [mean, deviation] = moments?;
                Values::Drawn(match bounds {
                    None => Distribution::Normal { mean, deviation },
                    Some(bounds) => {
                        let [low, high] = bounds?;
                        Distribution::TruncatedNormal { mean, deviation, low, high }
                    }
                })
            }
            Spread::Lognormal([median, deviation]) => {
                let (median, deviation) = (self.number(median, &unit), self.number(deviation, "1"));
                Values::Drawn(Distribution::Lognormal { median: median?, deviation: deviation? })
            }
        };
        if let Values::Drawn(distribution) = spread
            && let Some(reason) = distribution.refusal()
        {
            return self.fault(Fault::new(entry.value.span.clone(), format!("`{}`: {reason}", entry.name.value)));
        }
        Some(Variable { name: entry.name.value.clone(), unit, spread })
    }

    /// The degree of the design `chaos`, and the values of each variable.
    fn rules(&mut self, plan: &Plan, variables: &[Variable]) -> Option<(usize, Vec<Vec<f64>>)> {
        /// Without a degree.
        const DEGREE: u64 = 3;
        /// Polynomials of a higher degree oscillate more than any quantity.
        const MOST: u64 = 30;
        if plan.kind != Kind::Chaos {
            let degree = plan.degree.as_ref()?;
            return self.fault(Fault::new(degree.span.clone(), "a degree is that of the design `chaos`"));
        }
        if let Some(members) = &plan.members {
            let message = "the degree of the design `chaos` says how many members there are";
            self.faults.push(Fault::new(members.span.clone(), message));
        }
        let degree = plan.degree.as_ref().map_or(DEGREE, |degree| degree.value);
        if let (Some(given), true) = (&plan.degree, degree > MOST) {
            let message = format!("the degree is {MOST} at most, it is {degree}");
            return self.fault(Fault::new(given.span.clone(), message));
        }
        let rule = |variable: &Variable| match &variable.spread {
            Values::Drawn(distribution) => Some(nodes(distribution, degree as usize)),
            _ => None,
        };
        Some((degree as usize, variables.iter().filter_map(rule).collect()))
    }

    /// For Sobol' indices variables are independent, and all of them drawn.
    fn check_rows(&mut self, plan: &Plan, variables: &[Variable]) {
        let kind = plan.kind.name();
        if let Some(correlation) = plan.correlation.first() {
            let message = format!("the design `{kind}` is for independent variables, these are correlated");
            self.faults.push(Fault::new(correlation.of[0].span.clone(), message));
        }
        for (entry, variable) in plan.vary.iter().zip(variables) {
            if variable.spread.count().is_some() {
                let message = format!("the design `{kind}` draws all variables, `{}` is a grid", variable.name);
                self.faults.push(Fault::new(entry.value.span.clone(), message));
            }
        }
    }

    /// The lower factor L of the correlations `L Lᵀ` of what is drawn.
    fn factor(&mut self, plan: &Plan, variables: &[Variable]) -> Option<DMatrix<f64>> {
        let first = plan.correlation.first()?;
        let drawn = variables.iter().filter(|variable| matches!(variable.spread, Values::Drawn(_)));
        let drawn: Vec<String> = drawn.map(|variable| variable.name.clone()).collect();
        let mut matrix = DMatrix::identity(drawn.len(), drawn.len());
        let mut set = Vec::new();
        for correlation in &plan.correlation {
            let places = correlation.of.each_ref().map(|name| drawn.iter().position(|own| *own == name.value));
            let [Some(i), Some(j)] = places else {
                for (name, _) in correlation.of.iter().zip(places).filter(|(_, place)| place.is_none()) {
                    let fault = Fault::unknown(name.span.clone(), "drawn variable", &name.value, &drawn);
                    self.faults.push(fault);
                }
                continue;
            };
            if i == j {
                self.faults.push(Fault::new(correlation.of[1].span.clone(), "a variable and itself are given"));
            } else if set.contains(&(i.min(j), i.max(j))) {
                self.faults.push(Fault::new(correlation.of[0].span.clone(), "this correlation is given twice"));
            }
            set.push((i.min(j), i.max(j)));
            (matrix[(i, j)], matrix[(j, i)]) = (correlation.coefficient.value, correlation.coefficient.value);
        }
        let span = first.of[0].span.start..plan.correlation.last().map_or(0, |last| last.coefficient.span.end);
        let refusal = "no variables are correlated so: the matrix is not positive definite";
        lower_factor(&matrix).or_else(|| self.fault(Fault::new(span, refusal)))
    }
}

/// The lower factor L of `L Lᵀ`; a variable that is made of those before it has a column of zeros, where nalgebra's
/// `cholesky` ends. `None` where the matrix is not positive semidefinite.
fn lower_factor(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    const ROUNDING: f64 = 1e-12;
    let size = matrix.nrows();
    let mut factor = DMatrix::zeros(size, size);
    for j in 0..size {
        let left = |i: usize, factor: &DMatrix<f64>| {
            (0..j).fold(matrix[(i, j)], |left, k| left - factor[(i, k)] * factor[(j, k)])
        };
        let pivot = left(j, &factor);
        for i in j..size {
            let rest = left(i, &factor);
            if pivot > ROUNDING {
                factor[(i, j)] = rest / pivot.sqrt();
            } else if pivot < -ROUNDING || rest.abs() > ROUNDING.sqrt() {
                return None;
            }
        }
    }
    Some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocabulary::Variables;

    fn design(text: &str) -> Result<Design, String> {
        let variables = Variables::new([("m", "kg"), ("k", "N/m"), ("x", "m"), ("c", "1")]);
        let plan = Plan::read(text).map_err(|faults| faults.render("p", text))?;
        plan.design(&variables).map_err(|faults| faults.render("p", text))
    }

    #[test]
    fn grids_meet_each_other_and_every_draw() {
        let text = "members = 2\n[vary]\nx = { values = [1, 2] }\nm = { uniform = [0, 1] }\n\
                    k = { from = 10, to = 30, count = 3 }\n";
        let design = design(text).unwrap();
        assert_eq!(design.members(), 12);
        let rows: Vec<Vec<f64>> = (0..12).map(|index| design.values(index)).collect();
        let grid: Vec<[f64; 2]> = rows[..6].iter().map(|row| [row[0], row[2]]).collect();
        assert_eq!(grid, [[1.0, 10.0], [1.0, 20.0], [1.0, 30.0], [2.0, 10.0], [2.0, 20.0], [2.0, 30.0]]);
        assert!(rows[..6].iter().all(|row| row[1] == rows[0][1]), "one draw at all points");
        assert_ne!(rows[0][1], rows[6][1]);
    }

    #[test]
    fn correlations_are_those_asked_for() {
        let text = "members = 20000\nseed = 5\ncorrelation = [[\"m\", \"k\", 0.8], [\"k\", \"x\", -0.5]]\n[vary]\n\
                    m = { normal = [1, 0.1] }\nk = { normal = [5, 2] }\nx = { normal = [0, 1] }\n";
        let design = design(text).unwrap();
        let rows: Vec<Vec<f64>> = (0..20_000).map(|index| design.values(index)).collect();
        let column = |i: usize| -> Vec<f64> { rows.iter().map(|row| row[i]).collect() };
        let correlation = |a: &[f64], b: &[f64]| {
            let n = a.len() as f64;
            let (x, y) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
            let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - x, b - y)).sum::<f64>();
            sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
        };
        let [m, k, x] = [0, 1, 2].map(column);
        // Four deviations of an estimate from 20 000 pairs.
        for (found, expected) in [(correlation(&m, &k), 0.8), (correlation(&k, &x), -0.5), (correlation(&m, &x), 0.0)] {
            assert!((found - expected).abs() < 4.0 / 20_000.0_f64.sqrt(), "{found} {expected}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_at_its_place() {
        let check = |text: &str, expected: &str| assert_eq!(design(text).unwrap_err(), expected, "{text}");
        check("[vary]\nmm = { uniform = [0, 1] }", "p:2:1: there is no variable `mm`; did you mean `m`?\n");
        check("[vary]\nm = { uniform = [2, 1] }", "p:2:5: `m`: the lowest value must be below the highest\n");
        check("[vary]\nm = { normal = [2, \"1 s\"] }", "p:2:20: \"1 s\": write a number in kg\n");
        check("degree = 3\n[vary]\nm = { uniform = [0, 1] }", "p:1:10: a degree is that of the design `chaos`\n");
        check(
            "members = 5\ndesign = \"chaos\"\n[vary]\nm = { uniform = [0, 1] }",
            "p:1:11: the degree of the design `chaos` says how many members there are\n",
        );
        check(
            "design = \"chaos\"\ndegree = 31\n[vary]\nm = { values = [0, 1] }",
            "p:2:10: the degree is 30 at most, it is 31\np:4:5: the design `chaos` draws all variables, `m` is a grid\n",
        );
        check("[vary]\nm = { values = [1, \"nan\"] }", "p:2:20: a value must be finite, this is NaN\n");
        check("[fixed]\nm = \"-inf kg\"", "p:2:5: a value must be finite, this is -inf\n");
        check(
            "[vary]\nm = { from = -1e308, to = 1e308, count = 3 }",
            "p:2:27: the distance from -1e308 to 1e308 is not finite\n",
        );
        check(
            "[vary]\nm = { from = 1, to = 2, count = 1 }",
            "p:2:22: one value cannot be both ends: write a `count` of 2 or more\n",
        );
        check("[fixed]\nm = 1\n[vary]\nm = { uniform = [0, 1] }", "p:2:1: `m` is fixed here and varies in [vary]\n");
        check(
            "members = 3\n[vary]\nm = { values = [0, 1] }",
            "p:1:11: nothing is drawn: the grid alone says how many members there are\n",
        );
        let one = "[vary]\nm = { uniform = [0, 1] }\nk = { uniform = [0, 1] }\nx = { uniform = [0, 1] }\n";
        check(
            &format!("correlation = [[\"m\", \"k\", 1], [\"k\", \"x\", 1], [\"m\", \"x\", -1]]\n{one}"),
            "p:1:17: no variables are correlated so: the matrix is not positive definite\n",
        );
        check(
            &format!("correlation = [[\"m\", \"c\", 0.1]]\n{one}"),
            "p:1:22: there is no drawn variable `c`; one of `m`, `k`, `x`\n",
        );
    }

    #[test]
    fn variables_may_be_one_and_the_same() {
        let text = "members = 50\ncorrelation = [[\"m\", \"k\", 1], [\"k\", \"x\", -1], [\"m\", \"x\", -1]]\n[vary]\n\
                    m = { normal = [0, 1] }\nk = { normal = [0, 1] }\nx = { normal = [0, 2] }";
        let design = design(text).unwrap();
        for values in (0..50).map(|index| design.values(index)) {
            assert!(values[0] == values[1] && (values[2] + 2.0 * values[0]).abs() < 1e-12, "{values:?}");
        }
    }

    #[test]
    fn chaos_is_a_grid_of_gauss_rules() {
        let text = "design = \"chaos\"\ndegree = 2\n[vary]\nm = { uniform = [0, 1] }\nx = { normal = [1, 2] }";
        let design = design(text).unwrap();
        assert_eq!((design.members(), design.degree()), (9, Some(2)));
        let expected = crate::statistics::chaos::grid(&design.distributions(), 2);
        assert_eq!((0..9).map(|index| design.values(index)).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn members_have_random_numbers_of_their_own() {
        use chacha20::rand_core::Rng;
        let design = design("members = 5\n[vary]\nm = { uniform = [0, 1] }").unwrap();
        let first: Vec<u64> = (0..5).map(|index| design.member(index).random().next_u64()).collect();
        let again: Vec<u64> = (0..5).rev().map(|index| design.member(index).random().next_u64()).rev().collect();
        assert_eq!(first, again);
        assert!((1..5).all(|i| !first[..i].contains(&first[i])));
    }
}
