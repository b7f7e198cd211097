//! What all landings say together, as JSON and as text.

use mbs_ensemble::statistics::{Moments, quantile, quantile_interval};
use mbs_ensemble::sweep::Outcome;
use serde_json::{Value, json};

use crate::landings::QUANTITIES;

/// Of the values of each quantity, those of landings that touched down; bounds where they are drawn independently.
pub(crate) fn of(outcome: &Outcome, columns: Vec<Vec<f64>>, is_drawn: bool) -> (Value, String) {
    let bracketed =
        |bounds: Option<[f64; 2]>| bounds.map_or(String::new(), |[low, high]| format!(" ({low:.5} to {high:.5})"));
    let mut object = json!({ "members": outcome.members, "stopped": outcome.stopped });
    let mut text = format!("{} landings, {} without a touchdown\n", outcome.members, outcome.stopped);
    for ((name, unit), mut column) in QUANTITIES.into_iter().zip(columns) {
        let moments: Moments = column.iter().copied().collect();
        column.sort_by(f64::total_cmp);
        let of_mean = is_drawn.then(|| moments.mean_interval(0.95));
        let (median, last) = (quantile(&column, 0.5), quantile(&column, 0.99));
        let of_last = is_drawn.then(|| quantile_interval(&column, 0.99, 0.95)).flatten();
        object[name] = json!({
            "mean": moments.mean, "sd": moments.deviation(), "ci95": of_mean,
            "median": median, "q99": last, "q99_ci95": of_last,
        });
        let (mean, of_mean, of_last) = (moments.mean, bracketed(of_mean), bracketed(of_last));
        text += &format!("{name:<18} mean {mean:.5}{of_mean}, median {median:.5}, 99 % {last:.5}{of_last} {unit}\n");
    }
    (object, text)
}
