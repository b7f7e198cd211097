//! Whether everybody computes the same.

use mbs_arm::Arm;
use mbs_examples::Failure;
use mbs_examples::numbers::{apart, poses_apart};
use mbs_runtime::Pose;

use crate::plain;

/// To 1e-9, at all configurations.
pub(crate) fn check(arm: &Arm, configurations: &[[f64; 6]], poses: &[Pose<f64>]) -> Result<(), Failure> {
    for (q, pose) in configurations.iter().zip(poses) {
        let (by_hand, jacobian) = arm.pose_and_jacobian(q);
        let (plain, plain_jacobian) = plain::pose_and_jacobian(q);
        let plain = Pose {
            position: std::array::from_fn(|i| plain[(i, 3)]),
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| plain[(i, j)])),
        };
        let generated = arm.jacobian(q).concat();
        let mut differences = vec![
            poses_apart(&by_hand, pose),
            poses_apart(&plain, pose),
            apart(&jacobian.concat(), &generated),
            apart(plain_jacobian.transpose().as_slice(), &generated),
        ];
        let (found, rival) = (arm.inverse(pose)?, plain::inverse(pose));
        if found.len() != rival.len() {
            return Err(Failure::new(format!("{} against {} configurations at {q:?}", found.len(), rival.len())));
        }
        for (solution, rival) in found.iter().zip(&rival) {
            let turns: Vec<f64> = solution.q.iter().zip(rival).map(|(a, b)| (0.5 * (a - b)).sin()).collect();
            differences.extend([poses_apart(&arm.pose(&solution.q), pose), apart(&turns, &[0.0; 6])]);
        }
        if let Some(difference) = differences.into_iter().find(|difference| difference.is_nan() || *difference > 1e-9) {
            return Err(Failure::new(format!("off by {difference:e} at {q:?}")));
        }
    }
    Ok(())
}
