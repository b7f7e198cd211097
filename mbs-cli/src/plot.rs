//! `mbs plot`: tables of `mbs sweep` as figures, or what they say in numbers.

use std::path::PathBuf;

use mbs_chart::{Figure, Format, Line, Panel};
use mbs_ensemble::statistics::quantile;
use mbs_ensemble::table::{Column, Numbers, Table};
use serde_json::json;

use crate::failure::Failure;
use crate::files::Files;
use crate::output;
use crate::state::hint;
use crate::summary::Summary;
use crate::words::plural;

/// Draw a table of `mbs sweep`: histograms of its columns, quantiles over one of them, or parallel coordinates; or
/// print its means and quantiles.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs plot swings.csv --out swings.svg")]
pub(crate) struct Arguments {
    /// The table: CSV or, with the feature `parquet`, Apache Parquet, of any program.
    #[arg(value_name = "TABLE.csv|TABLE.parquet")]
    table: PathBuf,
    /// Where the figure goes.
    #[arg(long, value_name = "FILE.svg|FILE.png", value_parser = output::figure_path, required_unless_present = "summary")]
    out: Option<(PathBuf, Format)>,
    /// Print means and quantiles of the columns, with bounds at a confidence of 95 %.
    #[arg(long, conflicts_with_all = ["out", "over", "parallel"])]
    summary: bool,
    /// Draw these columns; all that differ from row to row if not given.
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    columns: Vec<String>,
    /// Draw a fan of each column over this one: median, quartiles, 5 % and 95 % of the members at each of its values,
    /// or, where it has many, in each of twenty parts with equally many members.
    #[arg(long, value_name = "COLUMN")]
    over: Option<String>,
    /// Draw each member as a line through all columns, each from its least to its greatest value; of many members five
    /// hundred.
    #[arg(long, conflicts_with = "over")]
    parallel: bool,
}

/// Reads, draws, writes.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut files = Files::default();
    files.reads("the table", &arguments.table);
    if let Some((out, _)) = &arguments.out {
        files.writes("--out", out)?;
    }
    let mut table = Table::read(&arguments.table).map_err(Failure::new)?;
    let Some((out, format)) = &arguments.out else {
        let names = &arguments.columns;
        names.iter().try_for_each(|name| named(&table, name).map(|_| ()))?;
        table.columns.retain(|column| names.is_empty() || names.contains(&column.about.name));
        return summarize(table);
    };
    let over = arguments.over.as_deref().map(|name| named(&table, name)).transpose()?;
    let chosen: Vec<&Numbers> = if arguments.columns.is_empty() {
        let is_over = |column: &Numbers| over.is_some_and(|over| over.about.name == column.about.name);
        table.columns.iter().filter(|column| differs(column) && !is_over(column)).collect()
    } else {
        arguments.columns.iter().map(|name| named(&table, name)).collect::<Result<_, _>>()?
    };
    if chosen.is_empty() {
        return Err(Failure::new(format_args!("{}: no column differs from row to row", arguments.table.display())));
    }
    let panels: Vec<Panel> = match over {
        Some(over) => chosen.iter().map(|column| fan(over, column)).collect(),
        None if arguments.parallel => vec![parallel(&chosen, table.rows)],
        None => chosen.iter().map(|column| histogram(column)).collect(),
    };
    if *format == Format::Png && panels.len() > MOST_PANELS {
        let count = plural(panels.len(), "panel", "panels");
        let help = "choose columns by --columns, draw them --parallel, or write SVG";
        return Err(Failure::new(format_args!(
            "{count} are too many for a PNG, which has {MOST_PANELS} at most; {help}"
        )));
    }
    let height = HEIGHT.saturating_mul(u32::try_from(panels.len()).unwrap_or(u32::MAX)).max(LEAST_HEIGHT);
    let figure = Figure { title: plural(table.rows, "member", "members"), size: (WIDTH, height), panels };
    output::write(out, &mbs_chart::draw(&figure, *format).map_err(Failure::new)?)?;
    output::wrote(&[out])
}

/// Prints what a table says in numbers.
fn summarize(table: Table) -> Result<(), Failure> {
    let (rows, stopped) = (table.rows, table.stopped);
    let summary = Summary::of_table(table);
    let object = || json!({ "members": rows, "stopped": stopped, "summary": summary.object() });
    let text = || format!("{}, {stopped} stopped\n{}", plural(rows, "member", "members"), summary.text());
    output::answer(object, text)
}

/// Width in pixels, the height of a panel, and that of a figure at least.
const WIDTH: u32 = 1100;
const HEIGHT: u32 = 260;
const LEAST_HEIGHT: u32 = 600;

/// A PNG of more panels takes hundreds of megabytes to draw.
const MOST_PANELS: usize = 100;

/// The column with this name.
fn named<'t>(table: &'t Table, name: &str) -> Result<&'t Numbers, Failure> {
    table.column(name).ok_or_else(|| {
        let known: Vec<String> = table.columns.iter().map(|column| column.about.name.clone()).collect();
        Failure::new(format_args!("there is no column `{name}`{}", hint(name, &known, "columns")))
    })
}

fn finite(column: &Numbers) -> impl Iterator<Item = f64> {
    column.values.iter().copied().filter(|value| value.is_finite())
}

/// The least and the greatest value.
fn range(column: &Numbers) -> (f64, f64) {
    finite(column).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

fn differs(column: &Numbers) -> bool {
    let (low, high) = range(column);
    low < high
}

/// `height [m]`
fn label(column: &Numbers) -> String {
    let Column { name, unit } = &column.about;
    if unit == "1" { name.clone() } else { format!("{name} [{unit}]") }
}

/// A range of more than one number.
fn widened((low, high): (f64, f64)) -> std::ops::Range<f64> {
    if low < high { low..high } else { low - 0.5..high + 0.5 }
}

/// How many members are in each of some bins.
fn histogram(column: &Numbers) -> Panel {
    let range = widened(range(column));
    Panel::curves([&label(column), "members"], range, vec![Line::new("", outline(column))])
}

/// The outline of bins of equal width: as many bins as the root of the members, but 60 at most.
fn outline(column: &Numbers) -> Vec<(f64, f64)> {
    let range = widened(range(column));
    let bins = ((finite(column).count() as f64).sqrt() as usize).clamp(1, 60);
    let width = (range.end - range.start) / bins as f64;
    let mut counts = vec![0_usize; bins];
    finite(column).for_each(|x| counts[(((x - range.start) / width) as usize).min(bins - 1)] += 1);
    let edge = |k: usize| range.start + width * k as f64;
    let tops = counts.iter().enumerate().flat_map(|(k, &n)| [(edge(k), n as f64), (edge(k + 1), n as f64)]);
    [(range.start, 0.0)].into_iter().chain(tops).chain([(range.end, 0.0)]).collect()
}

/// The quantiles that a fan shows, with their names.
const FAN: [(f64, &str); 5] = [(0.05, "5 %"), (0.25, "25 %"), (0.5, "median"), (0.75, "75 %"), (0.95, "95 %")];

/// Quantiles of a column over another.
fn fan(over: &Numbers, column: &Numbers) -> Panel {
    let groups = groups(over, column);
    let line = |(probability, name): (f64, &str)| {
        Line::new(name, groups.iter().map(|(x, sorted)| (*x, quantile(sorted, probability))).collect())
    };
    let lines = FAN.map(line).into();
    Panel::curves([&label(over), &label(column)], widened(range(over)), lines)
}

/// The values of a column in ascending order at each value of another, or in each of twenty parts of it.
fn groups(over: &Numbers, column: &Numbers) -> Vec<(f64, Vec<f64>)> {
    const MOST_VALUES: usize = 200;
    const PARTS: usize = 20;
    let pairs = over.values.iter().copied().zip(column.values.iter().copied());
    let mut pairs: Vec<(f64, f64)> = pairs.filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<&[(f64, f64)]> = pairs.chunk_by(|a, b| a.0 == b.0).collect();
    if groups.len() > MOST_VALUES {
        let place = |part: usize| part * pairs.len() / PARTS;
        groups = (0..PARTS).map(|part| &pairs[place(part)..place(part + 1)]).collect();
    }
    let sorted = |group: &&[(f64, f64)]| {
        let mut values: Vec<f64> = group.iter().map(|(_, y)| *y).collect();
        values.sort_by(f64::total_cmp);
        (group.iter().map(|(x, _)| x).sum::<f64>() / group.len() as f64, values)
    };
    groups.iter().map(sorted).collect()
}

/// Members as lines through columns, one beside the other.
fn parallel(columns: &[&Numbers], rows: usize) -> Panel {
    const MOST_LINES: usize = 500;
    let ranges: Vec<_> = columns.iter().map(|column| widened(range(column))).collect();
    let place = |row: usize, k: usize| {
        (k as f64 + 1.0, (columns[k].values[row] - ranges[k].start) / (ranges[k].end - ranges[k].start))
    };
    let line = |row: usize| Line::new("", (0..columns.len()).map(|k| place(row, k)).collect());
    let is_whole = |row: &usize| columns.iter().all(|column| column.values[*row].is_finite());
    let lines = (0..rows).step_by(rows.div_ceil(MOST_LINES).max(1)).filter(is_whole).map(line).collect();
    let names: Vec<String> =
        columns.iter().enumerate().map(|(k, column)| format!("{}: {}", k + 1, column.about.name)).collect();
    Panel::curves([&names.join(", "), "least to greatest"], 1.0..(columns.len() as f64).max(1.5), lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, values: &[f64]) -> Numbers {
        Numbers { about: Column::new(name, "m"), values: values.to_vec() }
    }

    #[test]
    fn groups_are_values_or_parts() {
        let few = groups(&column("x", &[2.0, 1.0, 2.0, f64::NAN]), &column("y", &[5.0, 7.0, 3.0, 1.0]));
        assert_eq!(few, [(1.0, vec![7.0]), (2.0, vec![3.0, 5.0])]);
        let numbers: Vec<f64> = (0..1000).map(f64::from).collect();
        let many = groups(&column("x", &numbers), &column("y", &numbers));
        assert_eq!((many.len(), many[0].0, many[19].1.len()), (20, 24.5, 50));
        let uneven = groups(&column("x", &numbers[..381]), &column("y", &numbers[..381]));
        assert!(uneven.len() == 20 && uneven.iter().all(|(_, values)| [19, 20].contains(&values.len())));
    }

    #[test]
    fn histograms_count_all_members() {
        let points = outline(&column("x", &[0.0, 0.1, 0.9, 1.0]));
        assert_eq!(points, [(0.0, 0.0), (0.0, 2.0), (0.5, 2.0), (0.5, 2.0), (1.0, 2.0), (1.0, 0.0)]);
        assert_eq!(outline(&column("x", &[3.0])), [(2.5, 0.0), (2.5, 1.0), (3.5, 1.0), (3.5, 0.0)]);
    }
}
