//! Serial arms of rigid links and revolute joints, five ways:
//!
//! - inverse dynamics by Newton–Euler, with 3-vectors in base axes ([`SerialArm::newton_euler`]);
//! - mass matrix by composite rigid bodies, with spatial vectors in link axes ([`SerialArm::composite_bodies`]);
//! - forward dynamics by articulated bodies, in link axes ([`SerialArm::articulated_bodies`]);
//! - energies from Jacobians of the mass centres ([`SerialArm::jacobian_kinetic_energy`]);
//! - energies from 4×4 link transforms and pseudo-inertias ([`Energies`]), for [`lagrange`] to differentiate.
//!
//! They share the data and nothing else beyond the link pose; the tests below say that they agree.
//!
//! Frames are standard (distal) Denavit–Hartenberg: frame `i` is fixed to link `i` at its far end, joint `i` turns
//! about `z` of frame `i − 1`, and `T = Rz(θ) Tz(d) Tx(a) Rx(α)`.

use super::EquationsOfMotion;
use super::lagrange::{self, Dual, Energies, Number};
use nalgebra::{Matrix3, Matrix6, Rotation3, Vector3, Vector6};
use std::array::from_fn;

/// A link and the joint that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Offset along the joint axis, in m.
    pub d: f64,
    /// Length of the common normal, in m.
    pub a: f64,
    /// Twist about the common normal, in rad.
    pub alpha: f64,
    /// Mass, in kg.
    pub mass: f64,
    /// Centre of mass in the link's own frame, in m.
    pub center_of_mass: [f64; 3],
    /// `[xx, xy, xz, yy, yz, zz]` of the inertia tensor (products with the tensor's sign) about the centre of mass, in
    /// link axes, in kg·m².
    pub inertia: [f64; 6],
}

/// `N` links in a row on a fixed base; coordinates are the joint angles `θ`, in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialArm<const N: usize> {
    /// From the base to the flange.
    pub links: [Link; N],
    /// Gravity in base axes, in m/s²: `[0, 0, −g]` for an arm that stands upright.
    pub gravity: [f64; 3],
}

/// Where a frame is, in base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Columns are the frame's axes.
    pub rotation: Matrix3<f64>,
    /// The frame's origin, in m.
    pub position: Vector3<f64>,
}

impl Link {
    /// The link's frame in the one before it: `Rz(θ) Tz(d) Tx(a) Rx(α)`.
    fn pose(&self, theta: f64) -> Pose {
        let about_z = Rotation3::from_axis_angle(&Vector3::z_axis(), theta);
        let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), self.alpha);
        Pose { rotation: (about_z * about_x).into_inner(), position: about_z * Vector3::new(self.a, 0.0, self.d) }
    }

    fn inertia_tensor(&self) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// `I = [I_C + m c× c×ᵀ, m c×; m c×ᵀ, m 1]` at the link's frame, RBDA (2.63).
    fn spatial_inertia(&self) -> Matrix6<f64> {
        let moment = self.mass * Vector3::from(self.center_of_mass).cross_matrix();
        let rotational = self.inertia_tensor() + moment * Vector3::from(self.center_of_mass).cross_matrix().transpose();
        let mass = self.mass * Matrix3::identity();
        blocks([[rotational, moment], [moment.transpose(), mass]])
    }

    /// The joint's motion subspace `S` in link axes, a constant: the axis is `n = Rx(−α) e_z` and passes through
    /// `p = −[a, 0, 0]`, the foot of the common normal, so that `S = [n; p × n]`.
    fn joint_axis(&self) -> Vector6<f64> {
        let n = Vector3::new(0.0, self.alpha.sin(), self.alpha.cos());
        let p = Vector3::new(-self.a, 0.0, 0.0);
        spatial(n, p.cross(&n))
    }

    /// Spatial motion from the axes of the previous frame to this link's: `X = [E, 0; −E r×, E]`, RBDA (2.24).
    /// Spatial force the other way is `Xᵀ`.
    fn motion_transform(&self, theta: f64) -> Matrix6<f64> {
        let Pose { rotation, position } = self.pose(theta);
        let e = rotation.transpose();
        let lower = -e * position.cross_matrix();
        blocks([[e, Matrix3::zeros()], [lower, e]])
    }

    /// `∫ r rᵀ dm` over homogeneous `r = [x, y, z, 1]` in the link's frame.
    fn pseudo_inertia(&self) -> [[f64; 4]; 4] {
        let [x, y, z] = self.center_of_mass;
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let (m, half_trace) = (self.mass, 0.5 * (xx + yy + zz));
        let xy = m * x * y - xy;
        let xz = m * x * z - xz;
        let yz = m * y * z - yz;
        [
            [half_trace - xx + m * x * x, xy, xz, m * x],
            [xy, half_trace - yy + m * y * y, yz, m * y],
            [xz, yz, half_trace - zz + m * z * z, m * z],
            [m * x, m * y, m * z, m],
        ]
    }
}

impl<const N: usize> SerialArm<N> {
    /// Pose of the last frame.
    pub fn flange(&self, q: &[f64; N]) -> Pose {
        self.poses(q)[N]
    }

    /// Geometric Jacobian of the flange's origin: rows `v` then `ω`, base axes.
    ///
    /// Column `j` is `[zⱼ₋₁ × (p − pⱼ₋₁); zⱼ₋₁]`: Whitney, *The mathematics of coordinated control of prosthetic arms
    /// and manipulators*, 1972; the thesis' (3.16).
    pub fn jacobian(&self, q: &[f64; N]) -> [[f64; N]; 6] {
        let poses = self.poses(q);
        let columns: [Vector6<f64>; N] = from_fn(|j| {
            let axis = axis(&poses[j]);
            spatial(axis.cross(&(poses[N].position - poses[j].position)), axis)
        });
        from_fn(|row| columns.map(|column| column[row]))
    }

    /// Torques that cause `q̈`.
    pub fn newton_euler(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [f64; N] {
        let (poses, wrenches) = (self.poses(q), self.joint_wrenches(q, qd, qdd));
        from_fn(|i| axis(&poses[i]).dot(&wrenches[i].1))
    }

    /// For each joint the force and the moment of the link before it on the link behind it, in base axes, the moment
    /// about the origin of frame `i − 1`, on the joint's axis; base to flange and back with 3-vectors.
    ///
    /// # Source
    ///
    /// Luh, Walker, Paul, *On-line computational scheme for mechanical manipulators*, J. Dyn. Syst. Meas. Control 102,
    /// 1980; here in base axes instead of link axes. Gravity is an acceleration `−g` of the base.
    pub fn joint_wrenches(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [(Vector3<f64>, Vector3<f64>); N] {
        let poses = self.poses(q);
        let mut omega = Vector3::zeros();
        let mut alpha = Vector3::zeros();
        let mut acceleration = -Vector3::from(self.gravity);
        let mut wrenches = [(Vector3::zeros(), Vector3::zeros()); N];
        for i in 0..N {
            let z = axis(&poses[i]);
            // ω̇ᵢ = ω̇ᵢ₋₁ + z q̈ᵢ + ωᵢ₋₁ × z q̇ᵢ, ωᵢ = ωᵢ₋₁ + z q̇ᵢ.
            alpha += z * qdd[i] + omega.cross(&(z * qd[i]));
            omega += z * qd[i];
            // p̈ = p̈ᵢ₋₁ + ω̇ × r + ω × (ω × r), of the link's frame, then of its centre of mass.
            let transport = |r: &Vector3<f64>| alpha.cross(r) + omega.cross(&omega.cross(r));
            acceleration += transport(&(poses[i + 1].position - poses[i].position));
            let rotation = poses[i + 1].rotation;
            let center = rotation * Vector3::from(self.links[i].center_of_mass);
            let inertia = rotation * self.links[i].inertia_tensor() * rotation.transpose();
            let force = self.links[i].mass * (acceleration + transport(&center));
            wrenches[i] = (force, inertia * alpha + omega.cross(&(inertia * omega)));
        }
        let mut force = Vector3::zeros();
        let mut moment = Vector3::zeros();
        for i in (0..N).rev() {
            let r = poses[i + 1].position - poses[i].position;
            let center = r + poses[i + 1].rotation * Vector3::from(self.links[i].center_of_mass);
            let (link_force, link_moment) = wrenches[i];
            moment += r.cross(&force) + center.cross(&link_force) + link_moment;
            force += link_force;
            wrenches[i] = (force, moment);
        }
        wrenches
    }

    /// For each joint the axes of frame `i − 1` turned by its angle, as columns in base axes: those of the link, before
    /// its twist.
    pub fn joint_rotations(&self, q: &[f64; N]) -> [Matrix3<f64>; N] {
        let poses = self.poses(q);
        from_fn(|i| poses[i].rotation * Rotation3::from_axis_angle(&Vector3::z_axis(), q[i]))
    }

    /// Mass matrix; the bodies beyond a joint are one.
    ///
    /// # Source
    ///
    /// Featherstone, *Rigid Body Dynamics Algorithms*, 2008 (RBDA), table 6.2.
    pub fn composite_bodies(&self, q: &[f64; N]) -> [[f64; N]; N] {
        let transforms: [Matrix6<f64>; N] = from_fn(|i| self.links[i].motion_transform(q[i]));
        let mut composites = self.links.map(|link| link.spatial_inertia());
        let mut mass_matrix = [[0.0; N]; N];
        for i in (0..N).rev() {
            if i > 0 {
                composites[i - 1] += transforms[i].transpose() * composites[i] * transforms[i];
            }
            let mut force = composites[i] * self.links[i].joint_axis();
            for j in (0..=i).rev() {
                // `force` is in the axes of link j.
                mass_matrix[i][j] = force.dot(&self.links[j].joint_axis());
                mass_matrix[j][i] = mass_matrix[i][j];
                force = transforms[j].transpose() * force;
            }
        }
        mass_matrix
    }

    /// Accelerations that torques cause, without ever forming `M`.
    ///
    /// # Source
    ///
    /// Featherstone, RBDA, table 7.1; here `S` is constant in link axes and a joint has one degree of freedom.
    pub fn articulated_bodies(&self, q: &[f64; N], qd: &[f64; N], torques: &[f64; N]) -> [f64; N] {
        let transforms: [Matrix6<f64>; N] = from_fn(|i| self.links[i].motion_transform(q[i]));
        let axes = self.links.map(|link| link.joint_axis());
        let mut inertias = self.links.map(|link| link.spatial_inertia());
        let mut velocity = Vector6::zeros();
        let mut accelerations = [Vector6::zeros(); N];
        let mut forces = [Vector6::zeros(); N];
        for i in 0..N {
            // c = v × S q̇, p = v ×* I v.
            velocity = transforms[i] * velocity + axes[i] * qd[i];
            accelerations[i] = cross_motion(&velocity) * axes[i] * qd[i];
            forces[i] = cross_force(&velocity) * inertias[i] * velocity;
        }
        // U = I S, D = Sᵀ U, u = τ − Sᵀ p.
        let mut reduced = [(Vector6::zeros(), 0.0, 0.0); N];
        for i in (0..N).rev() {
            let column = inertias[i] * axes[i];
            let (pivot, rest) = (axes[i].dot(&column), torques[i] - axes[i].dot(&forces[i]));
            reduced[i] = (column, pivot, rest);
            if i > 0 {
                let inertia = inertias[i] - column * column.transpose() / pivot;
                let force = forces[i] + inertia * accelerations[i] + column * (rest / pivot);
                inertias[i - 1] += transforms[i].transpose() * inertia * transforms[i];
                forces[i - 1] += transforms[i].transpose() * force;
            }
        }
        let mut acceleration = spatial(Vector3::zeros(), -Vector3::from(self.gravity));
        from_fn(|i| {
            let (column, pivot, rest) = reduced[i];
            acceleration = transforms[i] * acceleration + accelerations[i];
            let qdd = (rest - column.dot(&acceleration)) / pivot;
            acceleration += axes[i] * qdd;
            qdd
        })
    }

    /// `T = Σ ½ m |v|² + ½ ωᵀ R I Rᵀ ω`, with `v = J_v q̇` of the centre of mass and `ω = J_ω q̇`.
    ///
    /// # Source
    ///
    /// Spong, Hutchinson, Vidyasagar, *Robot Modeling and Control*, 2006, section 7.2; the thesis' (3.13), (3.19).
    pub fn jacobian_kinetic_energy(&self, q: &[f64; N], qd: &[f64; N]) -> f64 {
        let poses = self.poses(q);
        let energy = |i: usize| {
            let (link, rotation) = (&self.links[i], poses[i + 1].rotation);
            let center = self.center_of_mass(&poses, i);
            let columns = || (0..=i).map(|j| (axis(&poses[j]), center - poses[j].position, qd[j]));
            let v: Vector3<f64> = columns().map(|(z, r, rate)| z.cross(&r) * rate).sum();
            let omega: Vector3<f64> = columns().map(|(z, _, rate)| z * rate).sum();
            let omega_body = rotation.transpose() * omega;
            0.5 * link.mass * v.dot(&v) + 0.5 * omega_body.dot(&(link.inertia_tensor() * omega_body))
        };
        (0..N).map(energy).sum()
    }

    /// `V = −Σ m g · r`, zero with every centre of mass at the height of the base.
    pub fn weight_energy(&self, q: &[f64; N]) -> f64 {
        let poses = self.poses(q);
        let height = |i| Vector3::from(self.gravity).dot(&self.center_of_mass(&poses, i));
        -(0..N).map(|i| self.links[i].mass * height(i)).sum::<f64>()
    }

    /// The base, then every link's frame.
    fn poses(&self, q: &[f64; N]) -> Vec<Pose> {
        let mut pose = Pose { rotation: Matrix3::identity(), position: Vector3::zeros() };
        let mut poses = vec![pose];
        for (link, &theta) in self.links.iter().zip(q) {
            let step = link.pose(theta);
            pose.position += pose.rotation * step.position;
            pose.rotation *= step.rotation;
            poses.push(pose);
        }
        poses
    }

    fn center_of_mass(&self, poses: &[Pose], i: usize) -> Vector3<f64> {
        poses[i + 1].position + poses[i + 1].rotation * Vector3::from(self.links[i].center_of_mass)
    }
}

/// One algorithm for each symbol; `C`, which none of them yields, from [`lagrange`].
impl<const N: usize> EquationsOfMotion<N> for SerialArm<N> {
    fn mass_matrix(&self, q: &[f64; N]) -> [[f64; N]; N] {
        self.composite_bodies(q)
    }

    fn coriolis_matrix(&self, q: &[f64; N], qd: &[f64; N]) -> [[f64; N]; N] {
        lagrange::coriolis_matrix(self, q, qd)
    }

    fn gravity(&self, q: &[f64; N]) -> [f64; N] {
        self.newton_euler(q, &[0.0; N], &[0.0; N])
    }

    fn kinetic_energy(&self, q: &[f64; N], qd: &[f64; N]) -> f64 {
        self.jacobian_kinetic_energy(q, qd)
    }

    fn potential_energy(&self, q: &[f64; N]) -> f64 {
        self.weight_energy(q)
    }

    fn bias(&self, q: &[f64; N], qd: &[f64; N]) -> [f64; N] {
        self.newton_euler(q, qd, &[0.0; N])
    }

    fn inverse_dynamics(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [f64; N] {
        self.newton_euler(q, qd, qdd)
    }
}

/// `T = ½ Σ tr(Ṫ J Ṫᵀ)` and `V = −Σ m gᵀ T r_C` with 4×4 link transforms `T` and pseudo-inertias `J`.
///
/// # Source
///
/// Uicker, *On the dynamic analysis of spatial linkages using 4×4 matrices*, 1965; Paul, *Robot Manipulators*, 1981,
/// chapter 6.
impl<const N: usize> Energies<N> for SerialArm<N> {
    fn kinetic<S: Number>(&self, q: &[S; N], qd: &[S; N]) -> S {
        let path: [_; N] = from_fn(|i| Dual { value: q[i], derivative: qd[i] });
        let mut energy = S::constant(0.0);
        for (link, transform) in self.links.iter().zip(transforms(&self.links, &path)) {
            let pseudo_inertia = link.pseudo_inertia();
            for row in transform {
                let row = row.map(|entry| entry.derivative);
                for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                    energy = energy + row[i] * row[j] * (0.5 * pseudo_inertia[i][j]);
                }
            }
        }
        energy
    }

    fn potential<S: Number>(&self, q: &[S; N]) -> S {
        let mut energy = S::constant(0.0);
        for (link, transform) in self.links.iter().zip(transforms(&self.links, q)) {
            let [x, y, z] = link.center_of_mass;
            for (row, g) in transform.iter().zip(self.gravity) {
                energy = energy - (row[0] * x + row[1] * y + row[2] * z + row[3]) * (link.mass * g);
            }
        }
        energy
    }
}

/// Upper three rows of `Tᵢ = T(θ₁) … T(θᵢ)` for every link.
fn transforms<S: Number>(links: &[Link], q: &[S]) -> Vec<[[S; 4]; 3]> {
    let [zero, one] = [S::constant(0.0), S::constant(1.0)];
    let mut product = [[one, zero, zero, zero], [zero, one, zero, zero], [zero, zero, one, zero]];
    let mut transforms = Vec::new();
    for (link, theta) in links.iter().zip(q) {
        let (s, c, (sa, ca)) = (theta.sin(), theta.cos(), link.alpha.sin_cos());
        // The matrix of Denavit and Hartenberg, the thesis' (3.1).
        let rows = [
            [c, s * -ca, s * sa, c * link.a],
            [s, c * ca, c * -sa, s * link.a],
            [zero, S::constant(sa), S::constant(ca), S::constant(link.d)],
            [zero, zero, zero, one],
        ];
        product = product.map(|row| from_fn(|j| (1..4).fold(row[0] * rows[0][j], |sum, k| sum + row[k] * rows[k][j])));
        transforms.push(product);
    }
    transforms
}

/// The joint axis that a frame carries: its `z`.
fn axis(pose: &Pose) -> Vector3<f64> {
    pose.rotation.column(2).into_owned()
}

/// A spatial vector of its two halves.
pub(super) fn spatial(upper: Vector3<f64>, lower: Vector3<f64>) -> Vector6<f64> {
    Vector6::from_fn(|row, _| if row < 3 { upper[row] } else { lower[row - 3] })
}

/// A spatial matrix of its four blocks.
pub(super) fn blocks(blocks: [[Matrix3<f64>; 2]; 2]) -> Matrix6<f64> {
    Matrix6::from_fn(|row, column| blocks[row / 3][column / 3][(row % 3, column % 3)])
}

/// `v× = [ω×, 0; v×, ω×]`, RBDA (2.31).
pub(super) fn cross_motion(velocity: &Vector6<f64>) -> Matrix6<f64> {
    let omega = velocity.fixed_rows::<3>(0).cross_matrix();
    let v = velocity.fixed_rows::<3>(3).cross_matrix();
    blocks([[omega, Matrix3::zeros()], [v, omega]])
}

/// `v×* = −(v×)ᵀ`, RBDA (2.32).
pub(super) fn cross_force(velocity: &Vector6<f64>) -> Matrix6<f64> {
    -cross_motion(velocity).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::{State, positive, states};
    use crate::reference::arms::{arm6, irb7600};
    use crate::reference::double_pendulum::DoublePendulum;
    use crate::reference::product;
    use crate::reference::tests::ROUND_OFF;

    /// The two arms, and one without a right angle: oblique twists, every offset and normal nonzero, slanted gravity.
    fn each_arm(check: impl Fn(&SerialArm<6>)) {
        check(&arm6());
        check(&irb7600());
        check(&oblique());
    }

    fn oblique() -> SerialArm<6> {
        let mut arm = arm6();
        let lengths: [f64; 12] = positive(9);
        for (i, link) in arm.links.iter_mut().enumerate() {
            link.d = 0.3 * lengths[i];
            link.a = -0.2 * lengths[i + 6];
            link.alpha += 0.3 + 0.1 * i as f64;
        }
        arm.gravity = [1.0, -2.0, -9.0];
        arm
    }

    #[test]
    fn newton_euler_columns_are_the_composite_bodies() {
        each_arm(|arm| {
            let weightless = SerialArm { gravity: [0.0; 3], ..*arm };
            for state in states::<6>(1, 60) {
                let columns: [[f64; 6]; 6] = from_fn(|j| {
                    weightless.newton_euler(&state.q, &[0.0; 6], &from_fn(|k| if k == j { 1.0 } else { 0.0 }))
                });
                assert_close("M", &columns.concat(), &arm.composite_bodies(&state.q).concat(), ROUND_OFF);
            }
        });
    }

    /// `q̈` comes back from its torques. The condition number of `M` reaches 6e4 (arm6), so that torques good to 1e-14
    /// yield `q̈` to some 1e-10 at worst.
    #[test]
    fn articulated_bodies_invert_newton_euler() {
        each_arm(|arm| {
            for state in states::<6>(2, 60) {
                let torques = arm.newton_euler(&state.q, &state.qd, &state.qdd);
                let qdd = arm.articulated_bodies(&state.q, &state.qd, &torques);
                assert_close("q̈", &qdd, &state.qdd, 1e-10);
            }
        });
    }

    #[test]
    fn newton_euler_is_lagrange_over_link_transforms() {
        each_arm(|arm| {
            for state in states::<6>(3, 60) {
                let (q, qd, qdd) = (&state.q, &state.qd, &state.qdd);
                let torques = arm.newton_euler(q, qd, qdd);
                assert_close("τ", &torques, &lagrange::euler_lagrange(arm, q, qd, qdd), ROUND_OFF);
                let mass_matrix = lagrange::mass_matrix(arm, q).concat();
                assert_close("M", &arm.composite_bodies(q).concat(), &mass_matrix, ROUND_OFF);
                assert_close("G", &EquationsOfMotion::gravity(arm, q), &lagrange::gravity(arm, q), ROUND_OFF);
                let bias: [f64; 6] =
                    from_fn(|i| product(&arm.coriolis_matrix(q, qd), qd)[i] + lagrange::gravity(arm, q)[i]);
                assert_close("h", &arm.bias(q, qd), &bias, ROUND_OFF);
            }
        });
    }

    #[test]
    fn energies_agree() {
        each_arm(|arm| {
            for State { q, qd, .. } in states::<6>(4, 60) {
                let momentum = product(&arm.composite_bodies(&q), &qd);
                let quadratic = 0.5 * momentum.iter().zip(qd).map(|(p, rate)| p * rate).sum::<f64>();
                let kinetic = arm.jacobian_kinetic_energy(&q, &qd);
                assert_close("T from Jacobians and from M", &[kinetic], &[quadratic], ROUND_OFF);
                assert_close("T from Jacobians and from transforms", &[kinetic], &[arm.kinetic(&q, &qd)], ROUND_OFF);
                assert_close("V", &[arm.weight_energy(&q)], &[arm.potential(&q)], ROUND_OFF);
            }
        });
    }

    /// The Jacobian's columns are directional derivatives of the pose: `ṗ`, and the axis of `Ṙ Rᵀ`.
    #[test]
    fn jacobian_is_the_derivative_of_the_pose() {
        let arm = oblique();
        let q = states::<6>(5, 1)[0].q;
        let jacobian = arm.jacobian(&q);
        for j in 0..6 {
            let path: [_; 6] = from_fn(|k| Dual { value: q[k], derivative: if k == j { 1.0 } else { 0.0 } });
            let transform = transforms(&arm.links, &path)[5];
            // (Ṙ Rᵀ)ₘₙ.
            let spin = |m: usize, n: usize| -> f64 {
                (0..3).map(|k| transform[m][k].derivative * transform[n][k].value).sum()
            };
            let [x, y, z] = transform.map(|row| row[3].derivative);
            let column = jacobian.map(|row| row[j]);
            assert_close("column", &column, &[x, y, z, spin(2, 1), spin(0, 2), spin(1, 0)], ROUND_OFF);
        }
    }

    /// Two point masses on parallel axes, gravity along the stretched arm: relative angles `θ₁`, `θ₂ − θ₁`.
    #[test]
    fn planar_arm_of_point_masses_is_the_double_pendulum() {
        let link = |mass, a| Link { d: 0.0, a, alpha: 0.0, mass, center_of_mass: [0.0; 3], inertia: [0.0; 6] };
        let arm = SerialArm { links: [link(1.2, 0.8), link(0.7, 1.1)], gravity: [9.81, 0.0, 0.0] };
        let pendulum = DoublePendulum { m1: 1.2, m2: 0.7, l1: 0.8, l2: 1.1, g: 9.81 };
        let relative = |[first, second]: [f64; 2]| [first, second - first];
        for State { q, qd, qdd } in states::<2>(6, 40) {
            let [t1, t2] = arm.newton_euler(&relative(q), &relative(qd), &relative(qdd));
            // Q₁ θ̇₁ + Q₂ θ̇₂ = t₁ θ̇₁ + t₂ (θ̇₂ − θ̇₁).
            assert_close("Q", &[t1 - t2, t2], &pendulum.inverse_dynamics(&q, &qd, &qdd), ROUND_OFF);
            let energy = pendulum.potential_energy(&q);
            assert_close("V", &[arm.weight_energy(&relative(q))], &[energy], ROUND_OFF);
        }
    }
}
