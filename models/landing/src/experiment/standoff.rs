//! How far the carriage is to stay behind the flange.

use mbs_runtime::Scalar;

use super::error::Infeasible;
use super::plan::{Experiment, Plan};
use mbs_arm::{A1, A2, A3, D1, D4, D6};

/// Between stand-offs that are tried first \[m\].
const STEP: f64 = 0.05;
/// How often the best of them is then made better, by 0.618 each time: to less than a tenth of a millimetre.
const REFINEMENTS: usize = 15;
/// The flange is never farther from the arm's base, in any direction \[m\]: all links in a line.
const REACH: f64 = D1 + A1 + A2 + A3 + D4 + D6;

impl Experiment {
    /// The plan at this scale, with the stand-off that keeps the arm farthest from the ends of its ranges and from
    /// singularities: [`Plan::clearance`] is the greatest.
    ///
    /// Stand-offs are those within [`standoffs`](Self::standoffs) with which the carriage stays on the rail: `x(t) − ρ`
    /// within
    /// [`RailLimits::range`](super::rail_arm::RailLimits::range) up to the touchdown. Where there is none, all of them
    /// are taken, and the [survey](Plan::survey) names the end of the rail. They are tried every 50 mm, and the best is
    /// made better by golden sections.
    ///
    /// # Errors
    /// [`Infeasible`]: if no stand-off lets the flange go all the way, why that in the middle does not.
    pub fn plan(&self, scale: f64) -> Result<Plan<'_>, Infeasible> {
        let wanted = self.plan_at(scale, middle(self.standoffs))?;
        let Some(reached) = overlap(self.standoffs, [-REACH, REACH]) else {
            // It is too far at any of them.
            wanted.clearance()?;
            return Ok(wanted);
        };
        let on_rail = self.standoffs_on_rail(&wanted)?;
        let [least, greatest] = overlap(reached, on_rail).unwrap_or(reached);

        let central = wanted.standing_off(middle([least, greatest]));
        let clearance = |standoff: f64| wanted.standing_off(standoff).clearance().unwrap_or(f64::NEG_INFINITY);
        let steps = ((greatest - least) / STEP) as u32;
        let (mut best, mut standoff) = (clearance(central.standoff()), central.standoff());
        for tried in (0..=steps).map(|k| least + f64::from(k) * STEP).chain([greatest]) {
            let found = clearance(tried);
            if found > best {
                (best, standoff) = (found, tried);
            }
        }
        if best == f64::NEG_INFINITY {
            central.clearance()?;
        }
        let golden = 0.5 * (Scalar::sqrt(5.0_f64) - 1.0);
        let (mut from, mut to) = ((standoff - STEP).max(least), (standoff + STEP).min(greatest));
        for _ in 0..REFINEMENTS {
            let (near, far) = (to - golden * (to - from), from + golden * (to - from));
            if clearance(near) >= clearance(far) { to = far } else { from = near }
        }
        let refined = 0.5 * (from + to);
        Ok(wanted.standing_off(if clearance(refined) > best { refined } else { standoff }))
    }

    /// The least and the greatest stand-off with which the carriage stays on the rail; crossed where there is none.
    fn standoffs_on_rail(&self, plan: &Plan<'_>) -> Result<[f64; 2], Infeasible> {
        let [start, end] = self.robot.rail.range;
        let mut standoffs = [f64::NEG_INFINITY, f64::INFINITY];
        for time in plan.times() {
            let x = plan.flange(time)?.pose.position[0];
            standoffs = [standoffs[0].max(x - end), standoffs[1].min(x - start)];
        }
        Ok(standoffs)
    }
}

fn middle([least, greatest]: [f64; 2]) -> f64 {
    0.5 * least + 0.5 * greatest
}

fn overlap(one: [f64; 2], other: [f64; 2]) -> Option<[f64; 2]> {
    let [least, greatest] = [one[0].max(other[0]), one[1].min(other[1])];
    (least <= greatest).then_some([least, greatest])
}
