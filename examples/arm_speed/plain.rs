//! The arm's kinematics with nalgebra, as one writes it down: matrices of the links, and the angles by their formulas.

use std::f64::consts::{FRAC_PI_2, PI};

use mbs_arm::{A1, A2, A3, D1, D4, D6};
use mbs_runtime::Pose;
use nalgebra::{Matrix3, Matrix4, Matrix6, Vector3};

const D: [f64; 6] = [D1, 0.0, 0.0, D4, 0.0, D6];
const A: [f64; 6] = [A1, A2, A3, 0.0, 0.0, 0.0];
const ALPHA: [f64; 6] = [-FRAC_PI_2, 0.0, -FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2, 0.0];

/// The matrix (3.1) of a link.
fn link(i: usize, theta: f64) -> Matrix4<f64> {
    let (s, c) = theta.sin_cos();
    let (sa, ca) = ALPHA[i].sin_cos();
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        c, -s * ca, s * sa, A[i] * c,
        s, c * ca, -c * sa, A[i] * s,
        0.0, sa, ca, D[i],
        0.0, 0.0, 0.0, 1.0,
    );
    matrix
}

/// The chain (3.2), and the columns (3.15), (3.16).
pub(crate) fn pose_and_jacobian(q: &[f64; 6]) -> (Matrix4<f64>, Matrix6<f64>) {
    let mut frames = [Matrix4::identity(); 7];
    for i in 0..6 {
        frames[i + 1] = frames[i] * link(i, q[i]);
    }
    let column = |i: usize, j: usize| Vector3::new(frames[i][(0, j)], frames[i][(1, j)], frames[i][(2, j)]);
    let mut jacobian = Matrix6::zeros();
    for i in 0..6 {
        let axis = column(i, 2);
        jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&axis.cross(&(column(6, 3) - column(i, 3))));
        jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&axis);
    }
    (frames[6], jacobian)
}

/// All configurations, (3.7)–(3.12) with the signs of each branch; those with NaN angles left out.
pub(crate) fn inverse(pose: &Pose<f64>) -> Vec<[f64; 6]> {
    let h = Matrix3::from_fn(|i, j| pose.rotation[i][j]);
    let wrist = Vector3::from(pose.position) - D6 * h.column(2);
    let l1 = A3.hypot(D4);
    let phi = D4.atan2(A3);
    let mut solutions = Vec::with_capacity(8);
    for shoulder in [0.0, PI] {
        let theta_1 = wrist.y.atan2(wrist.x) + shoulder;
        let forward = wrist.x * theta_1.cos() + wrist.y * theta_1.sin() - A1;
        let down = D1 - wrist.z;
        let p14 = forward.hypot(down);
        let gamma = ((A2 * A2 + l1 * l1 - p14 * p14) / (2.0 * A2 * l1)).acos();
        let beta = ((A2 * A2 + p14 * p14 - l1 * l1) / (2.0 * A2 * p14)).acos();
        for elbow in [1.0, -1.0] {
            let theta_3 = elbow * (PI - gamma) - phi;
            let theta_2 = down.atan2(forward) - elbow * beta;
            if theta_2.is_nan() || theta_3.is_nan() {
                continue;
            }
            let frame = link(0, theta_1) * link(1, theta_2) * link(2, theta_3);
            let rest = frame.fixed_view::<3, 3>(0, 0).transpose() * h;
            for wrist in [1.0, -1.0] {
                let theta_4 = (-wrist * rest[(1, 2)]).atan2(-wrist * rest[(0, 2)]);
                let theta_5 = (wrist * rest[(0, 2)].hypot(rest[(1, 2)])).atan2(rest[(2, 2)]);
                let theta_6 = (-wrist * rest[(2, 1)]).atan2(wrist * rest[(2, 0)]);
                solutions.push([theta_1, theta_2, theta_3, theta_4, theta_5, theta_6]);
            }
        }
    }
    solutions
}
