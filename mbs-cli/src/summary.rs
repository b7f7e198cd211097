//! What all members say together: means, quantiles, and which variable the scatter comes from.

use mbs_ensemble::sequence::{Kind, Sequence};
use mbs_ensemble::statistics::chaos::Chaos;
use mbs_ensemble::statistics::sensitivity::{self, indices};
use mbs_ensemble::statistics::{Moments, quantile, quantile_interval};
use mbs_ensemble::table::{Column, Table};
use mbs_ensemble::{Design, Distribution};
use serde_json::{Value, json};

/// The confidence of all bounds.
const CONFIDENCE: f64 = 0.95;

/// What quantiles are shown.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// The widths of columns of text.
const NAME: usize = 20;
const NUMBER: usize = 10;
const BOUNDED: usize = 30;

/// The quantities of all members, column by column.
pub(crate) struct Summary {
    columns: Vec<Column>,
    values: Vec<Vec<f64>>,
    /// What varies, where its share of the variance can be told.
    variables: Option<Vec<String>>,
    seed: u64,
    /// Whether the members are drawn independently of each other, so that there are bounds.
    is_drawn: bool,
    /// The polynomials that the members were made for, if they were.
    chaos: Option<Polynomials>,
}

/// What quantities are written as by the design `chaos`.
struct Polynomials {
    distributions: Vec<Distribution>,
    degree: usize,
    /// Where the quantiles of a polynomial are taken from.
    points: Vec<Vec<f64>>,
}

impl Polynomials {
    fn of(design: &Design) -> Option<Self> {
        /// A power of two, for which Sobol's sequence is evenly spread.
        const POINTS: u64 = 1 << 15;
        let (distributions, degree) = (design.distributions(), design.degree()?);
        let sequence = Sequence::new(Kind::Sobol, design.seed(), POINTS, distributions.len())?;
        let point = |number| distributions.iter().zip(sequence.point(number)).map(|(d, p)| d.quantile(p)).collect();
        let points = (0..POINTS).map(point).collect();
        Some(Polynomials { distributions, degree, points })
    }
}

impl Summary {
    pub(crate) fn of(design: &Design, columns: &[Column]) -> Self {
        let names = || design.variables().iter().map(|variable| variable.name.clone()).collect();
        Summary {
            columns: columns.to_vec(),
            values: vec![Vec::new(); columns.len()],
            variables: matches!(design.kind(), Kind::Saltelli | Kind::Chaos).then(names),
            seed: design.seed(),
            is_drawn: design.draws_independently(),
            chaos: Polynomials::of(design),
        }
    }

    /// Of a table that was written before, without what a plan says of it: whether its members are drawn
    /// independently is not known.
    pub(crate) fn of_table(table: Table) -> Self {
        let (columns, values) = table.columns.into_iter().map(|column| (column.about, column.values)).unzip();
        Summary { columns, values, variables: None, seed: 0, is_drawn: false, chaos: None }
    }

    /// With the quantities of a table of the same plan; those that no member has are not in a table.
    pub(crate) fn filled(mut self, table: &Table) -> Self {
        for (column, values) in self.columns.iter().zip(&mut self.values) {
            let missing = || vec![f64::NAN; table.rows];
            *values = table.column(&column.name).map_or_else(missing, |found| found.values.clone());
        }
        self
    }

    /// One more member.
    pub(crate) fn push(&mut self, quantities: &[f64]) {
        self.values.iter_mut().zip(quantities).for_each(|(column, value)| column.push(*value));
    }

    fn statistics(&self) -> impl Iterator<Item = (&Column, Statistics)> {
        let statistics = |values: &Vec<f64>| match &self.chaos {
            Some(polynomials) => Statistics::of_polynomial(values, polynomials),
            None => Statistics::of_members(values, self.variables.as_ref().map(Vec::len), self.seed, self.is_drawn),
        };
        self.columns.iter().zip(self.values.iter().map(statistics))
    }

    /// A table for people.
    pub(crate) fn text(&self) -> String {
        // Sensitivities and polynomials take time.
        let all: Vec<_> = self.statistics().collect();
        let mut text = String::new();
        let row = |cells: &[(&str, usize)]| {
            let padded: Vec<String> = cells.iter().map(|(cell, width)| format!("{cell:<width$}")).collect();
            padded.join(" ").trim_end().to_string() + "\n"
        };
        text += &row(&[("\nquantity", NAME + 1), ("members", NUMBER), ("mean", BOUNDED), ("deviation", NUMBER)]);
        for (column, statistics) in &all {
            text += &row(&[
                (&labelled(column), NAME),
                (&statistics.count.to_string(), NUMBER),
                (&bounded(statistics.mean.value, statistics.mean.interval), BOUNDED),
                (&short(statistics.deviation), NUMBER),
            ]);
        }
        let quantiles = [("5 %", BOUNDED), ("median", BOUNDED), ("95 %", BOUNDED), ("greatest", NUMBER)];
        text += &row(&[&[("\nquantity", NAME + 1), ("least", NUMBER)], &quantiles[..]].concat());
        for (column, statistics) in &all {
            let [low, median, high] = QUANTILES.map(|p| statistics.quantile_text(p));
            let [least, greatest] = [0.0, 1.0].map(|p| short(quantile(&statistics.sorted, p)));
            let ends = [(least.as_str(), NUMBER), (&low, BOUNDED), (&median, BOUNDED), (&high, BOUNDED)];
            text += &row(&[&[(labelled(column).as_str(), NAME)], &ends[..], &[(&greatest, NUMBER)]].concat());
        }
        let Some(variables) = &self.variables else { return text };
        let heads = [("\nSobol' indices of", NAME + 1), ("by", NAME), ("first order", BOUNDED), ("total", BOUNDED)];
        text += &row(&heads);
        for (column, statistics) in &all {
            for (name, indices) in variables.iter().zip(&statistics.indices) {
                let [first, total] = indices.each_ref().map(|index| bounded(index.value, index.interval));
                text += &row(&[(&column.name, NAME), (name, NAME), (&first, BOUNDED), (&total, BOUNDED)]);
            }
        }
        if let Some(polynomials) = &self.chaos {
            let degree = polynomials.degree;
            text += &format!("\nby polynomials of degree {degree}, and the variance in their highest terms\n");
            for (column, statistics) in &all {
                let highest = statistics.highest.map_or("-".to_string(), |share| format!("{share:.1e}"));
                text += &row(&[(&labelled(column), NAME), (&highest, NUMBER)]);
            }
        }
        text
    }

    /// What [`text`](Self::text) shows, as JSON.
    pub(crate) fn object(&self) -> Value {
        let mut object = json!({});
        for (column, statistics) in self.statistics() {
            let Statistics { count, mean, deviation, sorted, indices, .. } = &statistics;
            let quantiles = QUANTILES.map(|p| {
                json!({
                    "probability": p,
                    "value": quantile(sorted, p),
                    "interval": statistics.quantile_interval(p),
                })
            });
            let mut entry = json!({
                "unit": column.unit,
                "members": count,
                "mean": mean.value,
                "mean_interval": mean.interval,
                "deviation": deviation,
                "least": quantile(sorted, 0.0),
                "greatest": quantile(sorted, 1.0),
                "quantiles": quantiles,
            });
            if let Some(variables) = &self.variables {
                let estimate = |e: &Estimate| json!({ "value": e.value, "interval": e.interval });
                let of = |[first, total]: &[Estimate; 2]| json!({ "first": estimate(first), "total": estimate(total) });
                entry["indices"] = variables.iter().zip(indices).map(|(name, i)| (name.clone(), of(i))).collect();
            }
            if let (Some(polynomials), Some(highest)) = (&self.chaos, statistics.highest) {
                entry["degree"] = polynomials.degree.into();
                entry["highest"] = highest.into();
            }
            object[&column.name] = entry;
        }
        object
    }
}

/// A number, with bounds where it is one of random numbers.
struct Estimate {
    value: f64,
    interval: Option<[f64; 2]>,
}

impl Estimate {
    fn exact(value: f64) -> Self {
        Estimate { value, interval: None }
    }

    fn of(estimate: sensitivity::Estimate) -> Self {
        Estimate { value: estimate.value, interval: Some(estimate.interval) }
    }
}

/// Of one quantity, over the members that have it, or of its polynomial.
struct Statistics {
    count: u64,
    mean: Estimate,
    deviation: f64,
    sorted: Vec<f64>,
    /// First and total ones of what varies; empty where they cannot be told.
    indices: Vec<[Estimate; 2]>,
    /// The share of the variance in the highest terms of a polynomial.
    highest: Option<f64>,
    /// Whether the sorted values are drawn at random.
    is_drawn: bool,
}

impl Statistics {
    /// Without bounds where it is not known that members are drawn independently.
    fn of_members(values: &[f64], variables: Option<usize>, seed: u64, is_drawn: bool) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let moments: Moments = sorted.iter().copied().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let indices = variables.and_then(|count| indices(values, count, seed)).unwrap_or_default();
        let mean = if moments.count > 0 { moments.mean } else { f64::NAN };
        Statistics {
            count: moments.count,
            mean: Estimate { value: mean, interval: is_drawn.then(|| moments.mean_interval(CONFIDENCE)) },
            deviation: moments.deviation(),
            sorted,
            indices: indices.into_iter().map(|i| [Estimate::of(i.first), Estimate::of(i.total)]).collect(),
            highest: None,
            is_drawn,
        }
    }

    /// NaN where a member has no value.
    fn of_polynomial(values: &[f64], polynomials: &Polynomials) -> Self {
        let Polynomials { distributions, degree, points } = polynomials;
        let count = values.iter().filter(|value| value.is_finite()).count() as u64;
        let Ok(chaos) = Chaos::of_grid(distributions, *degree, values) else {
            let (mean, deviation) = (Estimate::exact(f64::NAN), f64::NAN);
            let (sorted, indices) = (Vec::new(), Vec::new());
            return Statistics { count, mean, deviation, sorted, indices, highest: None, is_drawn: false };
        };
        let mut sorted: Vec<f64> = points.iter().map(|point| chaos.value(point)).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        // What rounding leaves of a share that is zero.
        let share = |share: f64| Estimate::exact(if share < 1e-14 { 0.0 } else { share });
        let index = |i: usize| [share(chaos.first(i)), share(chaos.total(i))];
        let varies = chaos.varies();
        Statistics {
            count,
            mean: Estimate::exact(chaos.mean()),
            deviation: chaos.variance().sqrt(),
            sorted,
            indices: if varies { (0..distributions.len()).map(index).collect() } else { Vec::new() },
            highest: varies.then(|| chaos.highest()),
            is_drawn: false,
        }
    }

    fn quantile_interval(&self, probability: f64) -> Option<[f64; 2]> {
        self.is_drawn.then(|| quantile_interval(&self.sorted, probability, CONFIDENCE)).flatten()
    }

    fn quantile_text(&self, probability: f64) -> String {
        bounded(quantile(&self.sorted, probability), self.quantile_interval(probability))
    }
}

/// `height [m]`
fn labelled(column: &Column) -> String {
    match column.unit.as_str() {
        "1" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// A value with its bounds, `1.25 (1.2 to 1.3)`, or the value alone where it has no bounds.
fn bounded(value: f64, interval: Option<[f64; 2]>) -> String {
    match interval.filter(|interval| interval.iter().all(|bound| bound.is_finite())) {
        Some([low, high]) => format!("{} ({} to {})", short(value), short(low), short(high)),
        None => short(value),
    }
}

/// Five digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_string(),
        size if !size.is_finite() => "-".to_string(),
        size if (1e-3..1e5).contains(&size) => {
            let decimals = (4.0 - size.log10().floor()).max(0.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.4e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_member_has_has_no_mean() {
        let statistics = Statistics::of_members(&[f64::NAN; 4], None, 0, true);
        assert_eq!(statistics.count, 0);
        assert_eq!(bounded(statistics.mean.value, statistics.mean.interval), "-");
    }

    #[test]
    fn numbers_have_five_digits() {
        assert_eq!(
            [0.0, 1.0, -123.456_78, 0.012_345_678, 1e-9, 1e7, f64::NAN].map(short),
            ["0", "1.0000", "-123.46", "0.012346", "1.0000e-9", "1.0000e7", "-"]
        );
        assert_eq!(bounded(1.0, Some([0.5, 2.0])), "1.0000 (0.50000 to 2.0000)");
    }
}
