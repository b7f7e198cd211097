//! One mission, with what is drawn of it.

use mbs_examples::Failure;
use mbs_orbit::mission::{Burn, Mission, Moment, Report, ThrusterErrors};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// What becomes of a planned burn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Thrusters {
    /// What was planned.
    Perfect,
    /// Sizes and directions are scattered.
    WithErrors,
}

/// 1 % and 0.5°.
const ERRORS: ThrusterErrors = ThrusterErrors { size: 0.01, direction: 0.5 * std::f64::consts::PI / 180.0 };
/// Of the random numbers: every run is the same.
const SEED: u64 = 400;

pub(crate) struct Flight {
    pub(crate) mission: Mission,
    pub(crate) moments: Vec<Moment>,
    /// As executed.
    pub(crate) burns: Vec<Burn>,
    pub(crate) report: Report,
}

impl Flight {
    pub(crate) fn of(mission: &Mission, thrusters: Thrusters) -> Result<Self, Failure> {
        let mut random = Pcg64Mcg::seed_from_u64(SEED);
        let (mut moments, mut burns) = (Vec::new(), Vec::new());
        let thrust = |burn: &Burn| {
            let delta_v = match thrusters {
                Thrusters::Perfect => burn.delta_v,
                Thrusters::WithErrors => ERRORS.executed(burn.delta_v, || StandardNormal.sample(&mut random)),
            };
            burns.push(Burn { delta_v, ..*burn });
            delta_v
        };
        let report = mission.fly(thrust, |moment| moments.push(*moment))?;
        Ok(Self { mission: *mission, moments, burns, report })
    }
}
