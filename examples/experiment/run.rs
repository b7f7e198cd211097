//! One experiment: its plan, what it asks of the machines, and the simulated arm.

use mbs_examples::Failure;
use mbs_landing::experiment::error::Infeasible;
use mbs_landing::experiment::flight::Flight;
use mbs_landing::experiment::inbound::Inbound;
use mbs_landing::experiment::landed::{Landed, Meeting, Standing};
use mbs_landing::experiment::plan::{Attitude, Experiment, Plan};
use mbs_landing::experiment::search::Search;
use mbs_landing::experiment::survey::Survey;
use mbs_landing::experiment::tracking::{Look, Tracked, Tracking};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_runtime::Pose;

/// A motion of the platform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// In the thesis.
    pub(crate) name: &'static str,
    /// The elevation of the platform at full size.
    pub(crate) heave: Heave<4>,
}

/// What the arm does at one moment.
pub(crate) struct Sample {
    pub(crate) look: Look,
    /// Where the flange is.
    pub(crate) flange: Pose<f64>,
    /// Height of the deck over the arm's base \[m\].
    pub(crate) deck: f64,
    /// Lengths and forces of the platform's legs \[m, N\].
    pub(crate) legs: [[f64; 6]; 2],
}

/// A scale that is not the one of the run, for comparison.
pub(crate) struct Other {
    pub(crate) scale: f64,
    pub(crate) standoff: f64,
    pub(crate) clearance: f64,
    pub(crate) survey: Survey,
}

/// What comes of a scale at which the arm can follow.
pub(crate) struct Outcome<'a> {
    pub(crate) plan: Plan<'a>,
    pub(crate) survey: Survey,
    /// The arm under its controller, which may not come to a contact.
    pub(crate) simulated: Result<Simulated, Infeasible>,
    /// Arm and platform through the contact.
    pub(crate) landed: Result<Touched, Infeasible>,
}

pub(crate) struct Touched {
    pub(crate) standing: Standing,
    /// What both controllers see, from [`BEFORE`] the planned touchdown on.
    pub(crate) meetings: Vec<Meeting>,
}

/// How long before the planned touchdown arm and platform are simulated together \[s\].
pub(crate) const BEFORE: f64 = 3.0;

pub(crate) struct Simulated {
    pub(crate) tracked: Tracked,
    /// Every fifth look of the controller.
    pub(crate) samples: Vec<Sample>,
}

pub(crate) struct Run<'a> {
    pub(crate) case: Case,
    pub(crate) attitude: Attitude,
    pub(crate) experiment: &'a Experiment,
    pub(crate) scale: f64,
    /// What breaks first at this scale.
    pub(crate) broken: Option<Infeasible>,
    /// The next scale that was found infeasible, and why, where the greatest feasible one was searched.
    pub(crate) next: Option<(f64, Infeasible)>,
    /// Nothing where the arm cannot follow.
    pub(crate) outcome: Option<Outcome<'a>>,
    /// Scales below and above, where they are asked for.
    pub(crate) others: Vec<Other>,
}

/// One look in this many is kept.
const KEPT: usize = 5;
/// Between scales that are compared, and how many of them.
const COMPARED: (f64, u32) = (0.01, 15);

pub(crate) fn experiment(case: &Case, attitude: Attitude) -> Result<Experiment, Failure> {
    let landing = Landing::new(Plant::Exact, case.heave);
    let flight = Flight::simulated(&landing, Landing::initial_state())?;
    Ok(Experiment { attitude, ..Experiment::new(flight) })
}

/// The vehicle comes from afar along the rail, and accelerations of the joints count.
pub(crate) fn inbound(case: &Case, attitude: Attitude) -> Result<Experiment, Failure> {
    let landing = Landing::on(Plant::Exact, Inbound { heave: case.heave, ..Inbound::LABORATORY });
    let flight = Flight::inbound(&landing)?;
    Ok(Experiment { attitude, joint_accelerations: true, ..Experiment::new(flight) })
}

impl<'a> Run<'a> {
    /// At a scale, or at the greatest feasible one; without others.
    pub(crate) fn of(experiment: &'a Experiment, case: Case, scale: Option<f64>) -> Result<Self, Failure> {
        if let Some(scale) = scale.filter(|scale| *scale > 0.0 && !(1e-3..=10.0).contains(scale) && scale.is_finite()) {
            return Err(Failure::new(format!("a scale is from 0.001 to 10, it is {scale:e}")));
        }
        let attitude = experiment.attitude;
        let (scale, planned, next) = match scale {
            None => match experiment.greatest_scale(&Search::default()) {
                Ok(found) => (found.plan.scale(), Ok((found.plan, found.survey)), found.next),
                Err(Infeasible::Refused(error)) => return Err(error.into()),
                Err(reason) => (Search::default().step, Err(reason), None),
            },
            Some(scale) => (scale, surveyed(experiment, scale)?, None),
        };
        let (broken, outcome) = match planned {
            Ok((plan, survey)) => {
                (survey.broken, Some(Outcome { simulated: simulated(&plan), landed: landed(&plan), plan, survey }))
            }
            Err(reason) => (Some(reason), None),
        };
        Ok(Run { case, attitude, experiment, scale, broken, next, outcome, others: Vec::new() })
    }

    /// The run, with others to compare.
    pub(crate) fn compared(self) -> Result<Self, Failure> {
        let others = (1..=COMPARED.1).map(|k| other(self.experiment, f64::from(k) * COMPARED.0));
        let others = others.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        Ok(Run { others, ..self })
    }
}

fn simulated(plan: &Plan<'_>) -> Result<Simulated, Infeasible> {
    let tracking = Tracking::new(&plan.experiment().robot);
    let mut looks = Vec::new();
    let tracked = plan.track(&tracking, |look| looks.push(*look))?;
    let sample = |look: Look| {
        let legs = plan.legs(look.time)?;
        let flange = tracking.plant.flange(&look.state.q);
        Ok(Sample { flange, deck: plan.deck_height(look.time)[0], legs: [legs.length, legs.force], look })
    };
    let samples = looks.into_iter().step_by(KEPT).map(sample).collect::<Result<_, Infeasible>>()?;
    Ok(Simulated { tracked, samples })
}

fn landed(plan: &Plan<'_>) -> Result<Touched, Infeasible> {
    let landed = Landed::new(Tracking::new(&plan.experiment().robot));
    let from = (plan.experiment().flight.touchdown() - BEFORE).max(0.0);
    let mut meetings = Vec::new();
    let standing = plan.land(&landed, from, |meeting| meetings.push(*meeting))?;
    Ok(Touched { standing, meetings })
}

type Surveyed<'a> = Result<(Plan<'a>, Survey), Infeasible>;

/// The plan at a scale and what it asks for, or why the arm cannot follow.
fn surveyed(experiment: &Experiment, scale: f64) -> Result<Surveyed<'_>, Infeasible> {
    match experiment.plan(scale).and_then(|plan| plan.survey().map(|survey| (plan, survey))) {
        Err(Infeasible::Refused(error)) => Err(error.into()),
        found => Ok(found),
    }
}

fn other(experiment: &Experiment, scale: f64) -> Result<Option<Other>, Infeasible> {
    let Ok((plan, survey)) = surveyed(experiment, scale)? else { return Ok(None) };
    let clearance = plan.clearance()?;
    Ok(Some(Other { scale, standoff: plan.standoff(), clearance, survey }))
}
