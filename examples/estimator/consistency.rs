//! Whether an estimator errs as much as it says: averages over landings against bounds of χ².

use mbs_landing::estimator::chi_square::{NORMAL_95, NORMAL_99, bounds_of_mean};
use mbs_landing::estimator::filter::Innovation;
use mbs_landing::estimator::nominal::ERRORS;
use serde_json::{Value, json};

use crate::monte_carlo::{LOOK, Run};

/// An average over landings at one time.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    /// The time \[s\].
    pub(crate) time: f64,
    /// The average of a normalized square, of a degree of freedom.
    pub(crate) mean: f64,
    /// Two-sided bounds of 95 % and of 99 %.
    pub(crate) bounds: [[f64; 2]; 2],
}

/// Averages over time.
pub(crate) struct Looks(pub(crate) Vec<Look>);

impl Looks {
    /// Normalized estimation errors, until the first landing has touched down.
    pub(crate) fn of_state(runs: &[Run]) -> Self {
        Self::of(runs, |run, look| Some((*run.state.get(look)?, ERRORS)))
    }

    /// Normalized innovations of a sensor.
    pub(crate) fn of_sensor(runs: &[Run], sensor: fn(&Run) -> &[Option<Innovation>]) -> Self {
        Self::of(runs, |run, look| {
            let seen = (*sensor(run).get(look)?)?;
            Some((seen.squared, seen.freedom))
        })
    }

    fn of(runs: &[Run], value: impl Fn(&Run, usize) -> Option<(f64, usize)>) -> Self {
        let all = runs.iter().map(|run| run.state.len()).min().unwrap_or_default();
        let look = |look: usize| {
            let values = || runs.iter().filter_map(|run| value(run, look));
            let freedom = values().map(|(_, freedom)| freedom).sum::<usize>() as f64;
            let mean = values().map(|(squared, _)| squared).sum::<f64>() / freedom;
            let bounds = [NORMAL_95, NORMAL_99].map(|normal| bounds_of_mean(normal, 1.0, freedom));
            // With fewer degrees of freedom the bounds are not known well enough.
            (freedom >= 10.0).then_some(Look { time: LOOK * look as f64, mean, bounds })
        };
        Looks((0..all).filter_map(look).collect())
    }

    /// How many are outside the bounds of 95 % and of 99 %.
    pub(crate) fn outside(&self) -> [usize; 2] {
        [0, 1].map(|i| {
            let is_outside = |look: &&Look| !(look.bounds[i][0]..=look.bounds[i][1]).contains(&look.mean);
            self.0.iter().filter(is_outside).count()
        })
    }

    /// The least and the greatest average.
    pub(crate) fn range(&self) -> [f64; 2] {
        let means = || self.0.iter().map(|look| look.mean);
        [means().fold(f64::INFINITY, f64::min), means().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// In units of χ² with this many degrees of freedom.
    pub(crate) fn to_json(&self, freedom: f64) -> Value {
        let scaled = |values: &dyn Fn(&Look) -> f64| {
            let values = self.0.iter().map(|look| freedom * values(look));
            Value::from(values.collect::<Vec<_>>())
        };
        let [outside_95, outside_99] = self.outside();
        json!({
            "freedom": freedom,
            "time": self.0.iter().map(|look| look.time).collect::<Vec<_>>(),
            "mean": scaled(&|look| look.mean),
            "bounds_95": [scaled(&|look| look.bounds[0][0]), scaled(&|look| look.bounds[0][1])],
            "bounds_99": [scaled(&|look| look.bounds[1][0]), scaled(&|look| look.bounds[1][1])],
            "outside_95": outside_95,
            "outside_99": outside_99,
        })
    }
}
