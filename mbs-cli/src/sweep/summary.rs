//! What all members say together: means, quantiles, and which variable the scatter comes from.

use mbs_ensemble::Design;
use mbs_ensemble::sequence::Kind;
use mbs_ensemble::statistics::sensitivity::{Estimate, Indices, indices};
use mbs_ensemble::statistics::{Moments, quantile, quantile_interval};
use mbs_ensemble::table::Column;
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
pub(super) struct Summary {
    columns: Vec<Column>,
    values: Vec<Vec<f64>>,
    /// What varies, where its share of the variance can be told.
    variables: Option<Vec<String>>,
    seed: u64,
}

impl Summary {
    pub(super) fn of(design: &Design, columns: &[Column]) -> Self {
        let names = || design.variables().iter().map(|variable| variable.name.clone()).collect();
        Summary {
            columns: columns.to_vec(),
            values: vec![Vec::new(); columns.len()],
            variables: (design.kind() == Kind::Saltelli).then(names),
            seed: design.seed(),
        }
    }

    /// One more member.
    pub(super) fn push(&mut self, quantities: &[f64]) {
        self.values.iter_mut().zip(quantities).for_each(|(column, value)| column.push(*value));
    }

    fn statistics(&self) -> impl Iterator<Item = (&Column, Statistics)> {
        let statistics = |values: &Vec<f64>| {
            let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
            let moments = sorted.iter().copied().collect();
            sorted.sort_by(f64::total_cmp);
            let count = self.variables.as_ref().map(Vec::len);
            let indices = count.and_then(|count| indices(values, count, self.seed)).unwrap_or_default();
            Statistics { moments, sorted, indices }
        };
        self.columns.iter().zip(self.values.iter().map(statistics))
    }

    /// A table for people.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let row = |cells: &[(&str, usize)]| {
            let padded: Vec<String> = cells.iter().map(|(cell, width)| format!("{cell:<width$}")).collect();
            padded.join(" ").trim_end().to_string() + "\n"
        };
        text += &row(&[("\nquantity", NAME + 1), ("members", NUMBER), ("mean", BOUNDED), ("deviation", NUMBER)]);
        for (column, statistics) in self.statistics() {
            let moments = statistics.moments;
            text += &row(&[
                (&labelled(column), NAME),
                (&moments.count.to_string(), NUMBER),
                (&bounded(moments.mean, Some(moments.mean_interval(CONFIDENCE))), BOUNDED),
                (&short(moments.deviation()), NUMBER),
            ]);
        }
        let quantiles = [("5 %", BOUNDED), ("median", BOUNDED), ("95 %", BOUNDED), ("greatest", NUMBER)];
        text += &row(&[&[("\nquantity", NAME + 1), ("least", NUMBER)], &quantiles[..]].concat());
        for (column, statistics) in self.statistics() {
            let [low, median, high] = QUANTILES.map(|p| statistics.quantile_text(p));
            let [least, greatest] = [0.0, 1.0].map(|p| short(quantile(&statistics.sorted, p)));
            let ends = [(least.as_str(), NUMBER), (&low, BOUNDED), (&median, BOUNDED), (&high, BOUNDED)];
            text += &row(&[&[(labelled(column).as_str(), NAME)], &ends[..], &[(&greatest, NUMBER)]].concat());
        }
        let Some(variables) = &self.variables else { return text };
        let heads = [("\nSobol' indices of", NAME + 1), ("by", NAME), ("first order", BOUNDED), ("total", BOUNDED)];
        text += &row(&heads);
        for (column, statistics) in self.statistics() {
            for (name, Indices { first, total }) in variables.iter().zip(&statistics.indices) {
                let [first, total] = [first, total].map(|e| bounded(e.value, Some(e.interval)));
                text += &row(&[(&column.name, NAME), (name, NAME), (&first, BOUNDED), (&total, BOUNDED)]);
            }
        }
        text
    }

    /// What [`text`](Self::text) shows, as JSON.
    pub(super) fn object(&self) -> Value {
        let mut object = json!({});
        for (column, statistics) in self.statistics() {
            let Statistics { moments, sorted, indices } = &statistics;
            let quantiles = QUANTILES.map(|p| {
                json!({
                    "probability": p,
                    "value": quantile(sorted, p),
                    "interval": quantile_interval(sorted, p, CONFIDENCE),
                })
            });
            let mut entry = json!({
                "unit": column.unit,
                "members": moments.count,
                "mean": moments.mean,
                "mean_interval": moments.mean_interval(CONFIDENCE),
                "deviation": moments.deviation(),
                "least": quantile(sorted, 0.0),
                "greatest": quantile(sorted, 1.0),
                "quantiles": quantiles,
            });
            if let Some(variables) = &self.variables {
                let estimate = |e: &Estimate| json!({ "value": e.value, "interval": e.interval });
                let of =
                    |indices: &Indices| json!({ "first": estimate(&indices.first), "total": estimate(&indices.total) });
                entry["indices"] = variables.iter().zip(indices).map(|(name, i)| (name.clone(), of(i))).collect();
            }
            object[&column.name] = entry;
        }
        object
    }
}

/// Of one quantity, over the members that have it.
struct Statistics {
    moments: Moments,
    sorted: Vec<f64>,
    /// Of what varies; empty where they cannot be told.
    indices: Vec<Indices>,
}

impl Statistics {
    fn quantile_text(&self, probability: f64) -> String {
        bounded(quantile(&self.sorted, probability), quantile_interval(&self.sorted, probability, CONFIDENCE))
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
    fn numbers_have_five_digits() {
        assert_eq!(
            [0.0, 1.0, -123.456_78, 0.012_345_678, 1e-9, 1e7, f64::NAN].map(short),
            ["0", "1.0000", "-123.46", "0.012346", "1.0000e-9", "1.0000e7", "-"]
        );
        assert_eq!(bounded(1.0, Some([0.5, 2.0])), "1.0000 (0.50000 to 2.0000)");
    }
}
