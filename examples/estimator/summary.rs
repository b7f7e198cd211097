//! What the landings came to, as text and as JSON.

use mbs_examples::quadrotor_landing::members::spread;
use mbs_landing::estimator::nominal::ERRORS;
use mbs_landing::quadrotor::touchdown::Touchdown;
use nalgebra::SVector;
use serde_json::{Value, json};

use crate::Case;
use crate::consistency::Looks;
use crate::monte_carlo::Run;

/// Mean, standard deviation, greatest magnitude.
fn statistics(values: impl Iterator<Item = f64> + Clone) -> [f64; 3] {
    let [mean, deviation] = spread(values.clone());
    [mean, deviation, values.fold(0.0, |most: f64, value| most.max(value.abs()))]
}

/// Name in the JSON, name and unit in the text, value.
type Column = (&'static str, &'static str, fn(&Touchdown) -> f64);

const COLUMNS: [Column; 4] = [
    ("touchdown_time", "touchdown [s]", |end| end.time),
    ("relative_velocity", "relative velocity [m/s]", |end| end.relative_velocity),
    ("horizontal_offset", "horizontal offset [m]", |end| end.horizontal_offset),
    ("horizontal_speed", "horizontal speed [m/s]", |end| end.horizontal_speed),
];

/// Who flew: name in the JSON, name in the text, its touchdown.
type Who = (&'static str, &'static str, fn(&Run) -> &Touchdown);

const WHO: [Who; 2] =
    [("estimated", "on the estimate", |run| &run.estimated), ("exact", "on the true state", |run| &run.exact)];

/// Normalized innovations of the sensors: name in the JSON, and what they are of.
pub(crate) fn sensors(runs: &[Run]) -> [(&'static str, Looks); 2] {
    [("range", Looks::of_sensor(runs, |run| &run.range)), ("image", Looks::of_sensor(runs, |run| &run.image))]
}

/// Root mean squares of the errors over the standard deviations that the filter states, by axes.
fn ratios(runs: &[Run]) -> SVector<f64, ERRORS> {
    let looks: usize = runs.iter().map(|run| run.state.len()).sum();
    let squares: SVector<f64, ERRORS> = runs.iter().map(|run| run.squares).sum();
    (squares / looks as f64).map(f64::sqrt)
}

/// Root mean square of the error of each coordinate of the place when the controller acted last \[m\].
fn last_errors(runs: &[Run]) -> [f64; 3] {
    [0, 1, 2].map(|i| (runs.iter().map(|run| run.last_error[i].powi(2)).sum::<f64>() / runs.len() as f64).sqrt())
}

fn refused(runs: &[Run]) -> [usize; 2] {
    [runs.iter().map(|run| run.refused).sum(), runs.iter().map(|run| run.measured).sum()]
}

pub(crate) fn to_json(cases: &[Case]) -> Value {
    cases.iter().map(|Case { name, runs }| ((*name).to_string(), of_case(runs))).collect()
}

fn of_case(runs: &[Run]) -> Value {
    let touchdown = |who: &Who| {
        let column = |&(key, _, value): &Column| {
            let [mean, deviation, greatest] = statistics(runs.iter().map(|run| value(who.2(run))));
            (key.to_string(), json!({ "mean": mean, "sd": deviation, "max": greatest }))
        };
        (who.0.to_string(), COLUMNS.iter().map(column).collect::<Value>())
    };
    let ratios = ratios(runs);
    let ratio = |first: usize| ratios.fixed_rows::<3>(first).iter().copied().collect::<Vec<_>>();
    let [refused, measured] = refused(runs);
    json!({
        "runs": runs.len(),
        "nees": Looks::of_state(runs).to_json(ERRORS as f64),
        "nis": sensors(runs).iter().map(|(key, looks)| (key.to_string(), looks.to_json(1.0))).collect::<Value>(),
        "rms_over_sd": {
            "place": ratio(0),
            "velocity": ratio(3),
            "attitude": ratio(6),
            "gyro_bias": ratio(9),
            "accelerometer_bias": ratio(12),
        },
        "measured": measured,
        "refused": refused,
        "last_error": last_errors(runs),
        "touchdown": WHO.iter().map(touchdown).collect::<Value>(),
    })
}

pub(crate) fn text(cases: &[Case]) -> String {
    let mut text = String::new();
    for Case { name, runs } in cases {
        text += &format!("case {name}, {} landings: averages over landings twice a second\n", runs.len());
        text += "  normalized squares              of times   outside 95 %   outside 99 %   least to greatest average   first bounds of 95 %\n";
        let state = Looks::of_state(runs);
        let rows = [("error of the estimate, 15", ERRORS as f64, &state)].into_iter();
        let sensors = sensors(runs);
        let of_sensors = sensors.iter().map(|(sensor, looks)| {
            (if *sensor == "range" { "innovation of a range, 1" } else { "of an image, a coordinate, 1" }, 1.0, looks)
        });
        for (what, freedom, looks) in rows.chain(of_sensors) {
            let [outside_95, outside_99] = looks.outside();
            let [least, greatest] = looks.range().map(|mean| freedom * mean);
            let [low, high] = looks.0.first().map_or([f64::NAN; 2], |look| look.bounds[0].map(|x| freedom * x));
            text += &format!(
                "  {what:<30} {:>9} {outside_95:>14} {outside_99:>14} {least:>16.3} to {greatest:.3} {low:>17.3} to {high:.3}\n",
                looks.0.len()
            );
        }
        let [refused, measured] = refused(runs);
        let [x, y, z] = last_errors(runs).map(|error| 1e3 * error);
        text += &format!(
            "  {refused} of {measured} measurements refused; last error of the place, root mean square: {x:.2}, {y:.2}, {z:.2} mm\n"
        );
        for (_, who, touchdown) in WHO {
            for (_, what, value) in COLUMNS {
                let [mean, deviation, greatest] = statistics(runs.iter().map(|run| value(touchdown(run))));
                text += &format!("  {who:<18} {what:<24} {mean:>11.5} ± {deviation:.2e}, at most {greatest:.5}\n");
            }
        }
        text += "\n";
    }
    text
}
