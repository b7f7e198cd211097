//! How many members ended where, for each quantity.

use mbs_chart::{Figure, Line, Panel};

/// A histogram of each quantity, one below the other: how many `members`, such as landings, and names with units; axes
/// alone where there are no values.
#[must_use]
pub fn figure(members: &str, quantities: &[(&str, &str)], columns: &[Vec<f64>]) -> Figure {
    let panel = |((name, unit), values): (&(&str, &str), &Vec<f64>)| {
        let (edges, counts) = histogram(values);
        let outline = edges.windows(2).zip(&counts).flat_map(|(edges, &count)| {
            let count = count as f64;
            [(edges[0], count), (edges[1], count)]
        });
        let [first, last] = [edges[0], edges[edges.len() - 1]];
        let outline = [(first, 0.0)].into_iter().chain(outline).chain([(last, 0.0)]).collect();
        Panel::curves([&format!("{name} [{unit}]"), members], first..last, vec![Line::new("", outline)])
    };
    let title = format!("{} {members}", columns.first().map_or(0, Vec::len));
    Figure { title, size: (1000, 1000), panels: quantities.iter().zip(columns).map(panel).collect() }
}

/// The edges of bins of equal width, and how many values are in each: as many bins as the root of the values, but 60 at
/// most.
fn histogram(values: &[f64]) -> (Vec<f64>, Vec<usize>) {
    let bins = ((values.len() as f64).sqrt() as usize).clamp(1, 60);
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    // If all values are equal the bins are 1 wide, and the first one holds them.
    let width = if high > low { (high - low) / bins as f64 } else { 1.0 };
    let mut counts = vec![0; bins];
    values.iter().for_each(|x| counts[(((x - low) / width) as usize).min(bins - 1)] += 1);
    ((0..=bins).map(|k| low + width * k as f64).collect(), counts)
}

#[cfg(test)]
mod tests {
    use super::histogram;

    #[test]
    fn every_value_is_in_one_bin() {
        assert_eq!(histogram(&[3.0; 4]), (vec![3.0, 4.0, 5.0], vec![4, 0]));
        assert_eq!(histogram(&[0.0, 1.0, 1.5, 4.0]), (vec![0.0, 2.0, 4.0], vec![3, 1]));
        assert_eq!(histogram(&[7.0]), (vec![7.0, 8.0], vec![1]));
    }
}
