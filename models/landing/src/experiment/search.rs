//! The greatest scale at which no limit breaks.
//!
//! ```
//! use mbs_landing::experiment::Experiment;
//! use mbs_landing::experiment::flight::Flight;
//! use mbs_landing::experiment::search::Search;
//! use mbs_landing::quadrotor::heave::Heave;
//! use mbs_landing::quadrotor::landing::{Landing, Plant};
//!
//! let flight = Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I))?;
//! let experiment = Experiment { sampling: 0.05, ..Experiment::new(flight) };
//! let found = experiment.greatest_scale(&Search::default())?;
//! assert!((found.plan.scale() - 0.111).abs() < 1e-3);
//! // A little above, two bodies touch.
//! let (_, broken) = found.next.expect("full size is too large");
//! assert!(broken.to_string().ends_with("m apart"), "{broken}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::error::Infeasible;
use super::plan::{Experiment, Plan};
use super::survey::Survey;
use mbs_models::Failure;
use mbs_models::check::{self, Must};

/// How scales are searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Scales are tried upwards from this one, in steps of it, until one is infeasible; positive.
    pub step: f64,
    /// The last one is then halved into until no more than this is left between feasible and infeasible; positive.
    pub tolerance: f64,
    /// No greater scale is tried.
    pub most: f64,
}

impl Default for Search {
    /// By steps of 0.02 up to 1, to 1e-4.
    fn default() -> Self {
        Self { step: 0.02, tolerance: 1e-4, most: 1.0 }
    }
}

/// A search goes up by no more steps.
const MOST_STEPS: f64 = 1e6;

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub struct Greatest<'a> {
    /// The plan at the greatest feasible scale.
    pub plan: Plan<'a>,
    /// What it asks of the machines.
    pub survey: Survey,
    /// The next scale, no more than the tolerance above, and what breaks first there; `None` where the greatest scale
    /// that may be tried is feasible.
    pub next: Option<(f64, Infeasible)>,
}

impl Experiment {
    /// The greatest feasible scale: by steps upwards to the first that is infeasible, then by halving.
    ///
    /// Of all stand-offs with which the carriage stays on the rail that with the greatest [clearance](Plan::clearance)
    /// is tried. Ranges of the axes, reach and singularities choose it so; speeds, accelerations and forces do not.
    /// Where one of those breaks first, another stand-off may allow a greater scale.
    ///
    /// Of a scale above one that is infeasible nothing is said: lengths grow with the scale, and limits that they break
    /// stay broken but in odd cases.
    ///
    /// # Errors
    /// [`Infeasible`]: what breaks first at the smallest scale that is tried, or [`Infeasible::Refused`].
    pub fn greatest_scale(&self, search: &Search) -> Result<Greatest<'_>, Infeasible> {
        let Search { step, tolerance, most } = *search;
        check::positive("step", step)?;
        check::positive("tolerance", tolerance)?;
        check::positive("most", most)?;
        Must::BeLessThan(MOST_STEPS).check("number of steps", most / step)?;
        let mut feasible = None;
        let mut next = None;
        for scale in (1_u32..).map(|k| (f64::from(k) * step).min(most)) {
            match self.tried(scale)? {
                Ok(found) => feasible = Some(found),
                Err(reason) => {
                    next = Some((scale, reason));
                    break;
                }
            }
            if scale >= most {
                break;
            }
        }
        let Some((mut plan, mut survey)) = feasible else {
            let none = Failure::Missing("scale to try").into();
            return Err(next.map_or(Infeasible::Refused(none), |(_, reason)| reason));
        };
        if let Some((above, reason)) = &mut next {
            while *above - plan.scale() > tolerance {
                let middle = 0.5 * (plan.scale() + *above);
                // Neighbouring numbers have no middle.
                if middle <= plan.scale() || middle >= *above {
                    break;
                }
                match self.tried(middle)? {
                    Ok(found) => (plan, survey) = found,
                    Err(found) => (*above, *reason) = (middle, found),
                }
            }
        }
        Ok(Greatest { plan, survey, next })
    }

    /// The plan at a scale, or what breaks first.
    fn tried(&self, scale: f64) -> Result<Result<(Plan<'_>, Survey), Infeasible>, Infeasible> {
        let found = self.plan(scale).and_then(|plan| plan.survey().map(|survey| (plan, survey)));
        match found {
            Err(Infeasible::Refused(error)) => Err(error.into()),
            found => Ok(found.and_then(|found| found.1.broken.map_or(Ok(found), Err))),
        }
    }
}
