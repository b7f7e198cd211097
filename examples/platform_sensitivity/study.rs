//! The forces of a motion with the numbers of a member, and their derivatives in the middle of all.

use mbs_ensemble::Design;
use mbs_examples::Failure;
use mbs_models::Error;
use mbs_platform::sensitivity::Parameter;
use mbs_platform::{Motion, Platform};

/// How long it moves \[s\], and how often it is looked at.
const DURATION: f64 = 20.0;
const TIMES: u32 = 100;

/// The platform and its motion, and which of their numbers vary.
pub(crate) struct Study {
    pub(crate) parameters: Vec<Parameter>,
    /// The middle of what each is drawn from.
    middle: Vec<f64>,
}

impl Study {
    pub(crate) fn of(design: &Design) -> Result<Self, Failure> {
        let parameters = design.variables().iter().map(|variable| variable.name.parse());
        let parameters = parameters.collect::<Result<_, Error>>()?;
        let middle = design.distributions().iter().map(|distribution| distribution.at_germ(0.0)).collect();
        Ok(Study { parameters, middle })
    }

    /// A platform and a motion with these numbers in place of the declared ones.
    fn with(&self, values: &[f64]) -> Result<(Platform, Motion), Error> {
        let (mut params, mut motion) = (*Platform::default().params(), Motion::COMBINED);
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.add(value - parameter.value(&params, &motion), &mut params, &mut motion);
        }
        Ok((Platform::new(params)?, motion))
    }

    /// The quantities of a motion.
    pub(crate) fn forces(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let (platform, motion) = self.with(values).map_err(|error| error.to_string())?;
        let (mut square, mut peak) = (0.0, 0.0_f64);
        for t in times() {
            let [q, qd, qdd] = motion.at(t);
            let forces = platform.leg_forces(&q, &qd, &qdd).map_err(|error| error.or_at_time(t).to_string())?;
            square += forces.iter().map(|force| force * force).sum::<f64>();
            peak = forces.iter().fold(peak, |peak, force| peak.max(force.abs()));
        }
        Ok(vec![(square / f64::from(6 * TIMES)).sqrt(), peak])
    }

    /// The derivatives of both quantities by all parameters, at the middle. The peak's is that of the force at its
    /// time: there the force does not change with time.
    pub(crate) fn gradients(&self) -> Result<[Vec<f64>; 2], Failure> {
        let (platform, motion) = self.with(&self.middle)?;
        let rms = self.forces(&self.middle).map_err(Failure::new)?[0];
        let mut gradients = [Vec::new(), Vec::new()];
        for &parameter in &self.parameters {
            let (mut slope, mut peak) = (0.0, (0.0, 0.0));
            for t in times() {
                for force in platform.leg_state_by(parameter, &motion, t)?.force {
                    slope += force.value * force.derivative;
                    if force.value.abs() > peak.0 {
                        peak = (force.value.abs(), force.value.signum() * force.derivative);
                    }
                }
            }
            gradients[0].push(slope / f64::from(6 * TIMES) / rms);
            gradients[1].push(peak.1);
        }
        Ok(gradients)
    }
}

fn times() -> impl Iterator<Item = f64> {
    (0..TIMES).map(|number| DURATION * f64::from(number) / f64::from(TIMES))
}
