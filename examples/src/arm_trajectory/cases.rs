//! Both cases of Table 2, by three methods each.

use crate::Failure;
use mbs_arm::trajectory::cartesian::{Singularity, nearest_singularity};
use mbs_arm::trajectory::sign_change::sign_changes;
use mbs_arm::trajectory::time_optimal::{MotorLimits, TimeOptimal, retime};
use mbs_arm::trajectory::work::{self, Integral};
use mbs_arm::trajectory::{JointState, Motion, Piecewise, StraightPath, quartic, quintic, two_piece_quartic};
use mbs_arm::{Arm, JointVector, jacobian};

/// Table 2 of the thesis \[°\].
const START: JointVector = [20.0, 10.0, 10.0, 10.0, 20.0, 10.0];
const STOP: JointVector = [50.0, 90.0, 120.0, 80.0, 60.0, 100.0];
/// How long it takes \[s\].
pub const DURATION: f64 = 50.0;
/// In tables and figures, every tenth of a second.
const SAMPLES: usize = 500;
/// In which a change of sign of the determinant is looked for.
const INTERVALS: usize = 2000;
/// Of the grid along the path of the fastest motion.
const GRID: usize = 1000;

/// One case of the thesis.
pub struct Case {
    /// `case1` or `case2`.
    pub name: &'static str,
    /// 1 or 2.
    pub number: usize,
    /// The default first: `quartic`, `two_piece_quartic`, `quintic`.
    pub runs: Vec<Run>,
}

/// One motion, and what it does to the arm.
pub struct Run {
    /// Its name, as JSON has it.
    pub method: &'static str,
    /// Joint angles over time.
    pub motion: Box<dyn Motion<6>>,
    /// At equal intervals, both ends included.
    pub samples: Vec<Sample>,
    /// The largest speed of each joint, either way \[rad/s\].
    pub peak_speed: JointVector,
    /// The largest acceleration of each joint, either way \[rad/s²\].
    pub peak_acceleration: JointVector,
    /// `∫ Σ |τᵢ q̇ᵢ| dt` \[J\].
    pub energy: Integral,
    /// `∫ Σ τᵢ² dt` \[N²·m²·s\].
    pub effort: Integral,
    /// When the determinant of the Jacobian changes sign, and what is singular then.
    pub singularities: Vec<(f64, Singularity)>,
}

/// One instant.
pub struct Sample {
    /// When \[s\].
    pub t: f64,
    /// Angles and velocities of the joints \[rad, rad/s\].
    pub state: JointState<6>,
    /// The torque of the joints \[N·m\].
    pub torque: JointVector,
    /// The position of the flange \[m\].
    pub position: [f64; 3],
    /// The determinant of the Jacobian \[m³\].
    pub determinant: f64,
}

impl Sample {
    /// `Σ |τᵢ q̇ᵢ|` \[W\].
    pub fn power(&self) -> f64 {
        self.torque.iter().zip(&self.state.qd).map(|(torque, qd)| (torque * qd).abs()).sum()
    }
}

/// Start and stop \[rad\].
pub fn ends() -> [JointVector; 2] {
    [START, STOP].map(|q| q.map(f64::to_radians))
}

/// Case 1 from rest, case 2 with 1.5 °/s in every joint.
pub fn both(arm: &Arm) -> Result<[Case; 2], Failure> {
    let case = |name, number, speed: f64| -> Result<Case, Failure> {
        let ([start, stop], velocity) = (ends(), [speed.to_radians(); 6]);
        let runs = vec![
            run(arm, "quartic", quartic(start, velocity, stop, DURATION)?)?,
            run(arm, "two_piece_quartic", two_piece_quartic(start, velocity, stop, DURATION)?)?,
            run(arm, "quintic", quintic(start, velocity, stop, DURATION)?)?,
        ];
        Ok(Case { name, number, runs })
    };
    Ok([case("case1", 1, 0.0)?, case("case2", 2, 1.5)?])
}

fn run<const P: usize>(arm: &Arm, method: &'static str, motion: Piecewise<6, P>) -> Result<Run, Failure> {
    let singularities = sign_changes(&motion, jacobian::determinant, INTERVALS)?
        .map(|time| time.and_then(|time| Ok((time, nearest_singularity(&motion.at(time)?.q)))))
        .collect::<Result<_, _>>()?;
    Ok(Run {
        method,
        samples: samples(arm, &motion)?,
        peak_speed: motion.velocity_extrema().map(|extrema| extrema.farthest().value.abs()),
        peak_acceleration: motion.acceleration_extrema().map(|extrema| extrema.farthest().value.abs()),
        energy: work::energy(&arm.model, &motion)?,
        effort: work::effort(&arm.model, &motion)?,
        singularities,
        motion: Box::new(motion),
    })
}

/// Equal intervals of the whole motion.
pub fn samples(arm: &Arm, motion: &impl Motion<6>) -> Result<Vec<Sample>, Failure> {
    let sample = |k: usize| -> Result<Sample, Failure> {
        let t = motion.duration() * (k as f64 / SAMPLES as f64);
        let state = motion.at(t)?;
        let torque = arm.model.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        let (position, determinant) = (arm.pose(&state.q).position, jacobian::determinant(&state.q));
        Ok(Sample { t, state, torque, position, determinant })
    };
    (0..=SAMPLES).map(sample).collect()
}

/// The same way from rest to rest as fast as the drives can.
pub fn fastest(arm: &Arm) -> Result<TimeOptimal<6, StraightPath<6>>, Failure> {
    let [start, stop] = ends();
    Ok(retime(StraightPath::new(start, stop)?, &arm.model, &MotorLimits::from(&arm.limits), GRID)?)
}

/// When a joint is out of its range: from, to \[s\].
pub fn out_of_range(arm: &Arm, motion: &dyn Motion<6>, joint: usize) -> Result<Vec<[f64; 2]>, Failure> {
    let mut times = vec![0.0, motion.duration()];
    for limit in [arm.limits.lower[joint], arm.limits.upper[joint]] {
        for time in sign_changes(motion, |q| q[joint] - limit, INTERVALS)? {
            times.push(time?);
        }
    }
    times.sort_by(f64::total_cmp);
    let mut outside: Vec<[f64; 2]> = Vec::new();
    for pair in times.windows(2) {
        let middle = motion.at(0.5 * (pair[0] + pair[1]))?.q[joint];
        match outside.last_mut() {
            _ if arm.limits.admits(joint, middle) => {}
            Some(last) if last[1] == pair[0] => last[1] = pair[1],
            _ => outside.push([pair[0], pair[1]]),
        }
    }
    Ok(outside)
}
