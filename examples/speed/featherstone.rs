//! The general algorithms for rigid-body dynamics on nalgebra, over a model that is known at run time only: trees of
//! hinges and slides about and along any axis, as the libraries have them.
//!
//! # Source
//!
//! Featherstone, *Rigid Body Dynamics Algorithms*, 2008 (RBDA): tables 5.1, 6.2 and 7.1, in body axes, with rotations
//! and translations in place of 6×6 matrices; Echeandia, Wensing, *Numerical methods to compute the Coriolis matrix and
//! Christoffel symbols for rigid-body systems*, J. Comput. Nonlinear Dyn. 16, 2021, algorithm 1, for C.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Motion (ω, v) or force (n, f) of a body, at its frame's origin in its axes.
#[derive(Clone, Copy)]
struct Spatial {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

/// Mass, first moments, and inertia about the frame's origin.
#[derive(Clone, Copy)]
struct Inertia {
    mass: f64,
    moment: Vector3<f64>,
    rotational: Matrix3<f64>,
}

/// `[A, B; Bᵀ, C]`
#[derive(Clone, Copy)]
struct ArticulatedInertia {
    a: Matrix3<f64>,
    b: Matrix3<f64>,
    c: Matrix3<f64>,
}

/// A body's or composite's Coriolis matrix B, `[A, 0; C, 0]`.
#[derive(Clone, Copy)]
struct Coriolis {
    a: Matrix3<f64>,
    c: Matrix3<f64>,
}

/// A frame in its parent: a point x of the frame is at `rotation x + position`.
#[derive(Clone, Copy)]
struct Pose {
    rotation: Matrix3<f64>,
    position: Vector3<f64>,
}

/// A joint of one degree of freedom.
#[derive(Clone)]
enum Joint {
    Hinge(Unit<Vector3<f64>>),
    /// The arm has none, but that is known at run time only.
    #[allow(dead_code)]
    Slide(Unit<Vector3<f64>>),
}

/// A body and the joint that carries it.
#[derive(Clone)]
struct Link {
    parent: Option<usize>,
    placement: Pose,
    joint: Joint,
    /// The joint's motion S at unit rate.
    axis: Spatial,
    inertia: Inertia,
}

/// A link of an arm in standard Denavit–Hartenberg frames: `[d, a, α]`, mass, mass centre, and `[xx, yy, zz, xy, xz,
/// yz]` of the inertia about it, in the link's frame.
pub(crate) type Row = ([f64; 3], f64, [f64; 3], [f64; 6]);

/// A tree of links, and room for what its algorithms compute on the way.
#[derive(Clone)]
pub(crate) struct Model {
    links: Vec<Link>,
    gravity: Vector3<f64>,
    poses: Vec<Pose>,
    velocities: Vec<Spatial>,
    accelerations: Vec<Spatial>,
    forces: Vec<Spatial>,
    composites: Vec<Inertia>,
    articulated: Vec<ArticulatedInertia>,
    columns: Vec<(Spatial, f64, f64)>,
    coriolis: Vec<Coriolis>,
}

impl Model {
    /// An upright arm.
    pub(crate) fn serial(links: &[Row], g: f64) -> Self {
        let mut before = Pose { rotation: Matrix3::identity(), position: Vector3::zeros() };
        let link = |(i, &([d, a, alpha], mass, center, [xx, yy, zz, xy, xz, yz])): (usize, &Row)| {
            // The link's frame is at the far end; the hinge's frame here turns with the link, too.
            let far = Pose { rotation: about_x(alpha), position: Vector3::new(a, 0.0, d) };
            let about_center = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            let center = Vector3::from(center);
            let cross = center.cross_matrix();
            let inertia = Inertia { mass, moment: mass * center, rotational: about_center - mass * cross * cross };
            let placement = std::mem::replace(&mut before, far);
            let joint = Joint::Hinge(Vector3::z_axis());
            Link {
                parent: usize::checked_sub(i, 1),
                placement,
                axis: joint.axis(),
                joint,
                inertia: inertia.to_parent(&far),
            }
        };
        let links: Vec<Link> = links.iter().enumerate().map(link).collect();
        let n = links.len();
        let zero = Spatial { angular: Vector3::zeros(), linear: Vector3::zeros() };
        let empty = ArticulatedInertia { a: Matrix3::zeros(), b: Matrix3::zeros(), c: Matrix3::zeros() };
        Model {
            poses: links.iter().map(|link| link.placement).collect(),
            composites: links.iter().map(|link| link.inertia).collect(),
            links,
            gravity: Vector3::new(0.0, 0.0, -g),
            velocities: vec![zero; n],
            accelerations: vec![zero; n],
            forces: vec![zero; n],
            articulated: vec![empty; n],
            columns: vec![(zero, 0.0, 0.0); n],
            coriolis: vec![Coriolis { a: Matrix3::zeros(), c: Matrix3::zeros() }; n],
        }
    }

    /// Recursive Newton–Euler, RBDA table 5.1; the bias where there are no accelerations.
    pub(crate) fn inverse_dynamics<const N: usize>(
        &mut self,
        q: &[f64; N],
        qd: &[f64; N],
        qdd: Option<&[f64; N]>,
    ) -> [f64; N] {
        self.place(q);
        for i in 0..N {
            let pose = self.poses[i];
            let (velocity, acceleration) = match self.links[i].parent {
                Some(p) => (pose.motion_to_child(&self.velocities[p]), pose.motion_to_child(&self.accelerations[p])),
                None => (Spatial::zero(), pose.motion_to_child(&Spatial { linear: -self.gravity, ..Spatial::zero() })),
            };
            let (axis, rate) = (&self.links[i].axis, self.links[i].axis.scale(qd[i]));
            let velocity = velocity.plus(&rate);
            let mut acceleration = acceleration.plus(&velocity.cross(&rate));
            if let Some(qdd) = qdd {
                acceleration = acceleration.plus(&axis.scale(qdd[i]));
            }
            let inertia = &self.links[i].inertia;
            self.forces[i] = inertia.times(&acceleration).plus(&velocity.cross_force(&inertia.times(&velocity)));
            self.velocities[i] = velocity;
            self.accelerations[i] = acceleration;
        }
        let mut tau = [0.0; N];
        for i in (0..N).rev() {
            tau[i] = self.links[i].axis.dot(&self.forces[i]);
            if let Some(p) = self.links[i].parent {
                self.forces[p] = self.forces[p].plus(&self.poses[i].force_to_parent(&self.forces[i]));
            }
        }
        tau
    }

    /// Composite bodies, RBDA table 6.2; both triangles.
    pub(crate) fn mass_matrix<const N: usize>(&mut self, q: &[f64; N]) -> [[f64; N]; N] {
        self.place(q);
        for (composite, link) in self.composites.iter_mut().zip(&self.links) {
            *composite = link.inertia;
        }
        let mut m = [[0.0; N]; N];
        for i in (0..N).rev() {
            let mut force = self.composites[i].times(&self.links[i].axis);
            m[i][i] = self.links[i].axis.dot(&force);
            let mut j = i;
            while let Some(p) = self.links[j].parent {
                force = self.poses[j].force_to_parent(&force);
                j = p;
                m[i][j] = self.links[j].axis.dot(&force);
                m[j][i] = m[i][j];
            }
            if let Some(p) = self.links[i].parent {
                self.composites[p] = self.composites[p].plus(&self.composites[i].to_parent(&self.poses[i]));
            }
        }
        m
    }

    /// Articulated bodies, RBDA table 7.1.
    pub(crate) fn forward_dynamics<const N: usize>(&mut self, q: &[f64; N], qd: &[f64; N], tau: &[f64; N]) -> [f64; N] {
        self.place(q);
        for i in 0..N {
            let pose = self.poses[i];
            let velocity = self.links[i].parent.map_or(Spatial::zero(), |p| pose.motion_to_child(&self.velocities[p]));
            let rate = self.links[i].axis.scale(qd[i]);
            let velocity = velocity.plus(&rate);
            let inertia = &self.links[i].inertia;
            self.accelerations[i] = velocity.cross(&rate);
            self.forces[i] = velocity.cross_force(&inertia.times(&velocity));
            self.articulated[i] = inertia.articulated();
            self.velocities[i] = velocity;
        }
        for i in (0..N).rev() {
            let ArticulatedInertia { a, b, c } = self.articulated[i];
            // U = I S, D = Sᵀ U, u = τ − Sᵀ p.
            let axis = &self.links[i].axis;
            let u = self.articulated[i].times(axis);
            let (pivot, rest) = (1.0 / axis.dot(&u), tau[i] - axis.dot(&self.forces[i]));
            self.columns[i] = (u, pivot, rest);
            if let Some(p) = self.links[i].parent {
                let scaled = u.scale(pivot);
                let reduced = ArticulatedInertia {
                    a: a - scaled.angular * u.angular.transpose(),
                    b: b - scaled.angular * u.linear.transpose(),
                    c: c - scaled.linear * u.linear.transpose(),
                };
                let force = self.forces[i].plus(&reduced.times(&self.accelerations[i])).plus(&scaled.scale(rest));
                self.articulated[p] = self.articulated[p].plus(&reduced.to_parent(&self.poses[i]));
                self.forces[p] = self.forces[p].plus(&self.poses[i].force_to_parent(&force));
            }
        }
        let mut qdd = [0.0; N];
        for i in 0..N {
            let pose = self.poses[i];
            let base = Spatial { linear: -self.gravity, ..Spatial::zero() };
            let above = self.links[i].parent.map_or(base, |p| self.accelerations[p]);
            let acceleration = pose.motion_to_child(&above).plus(&self.accelerations[i]);
            let (u, pivot, rest) = &self.columns[i];
            qdd[i] = (rest - u.dot(&acceleration)) * pivot;
            self.accelerations[i] = acceleration.plus(&self.links[i].axis.scale(qdd[i]));
        }
        qdd
    }

    /// Christoffel's C from body-level ones, Echeandia & Wensing, algorithm 1.
    pub(crate) fn coriolis_matrix<const N: usize>(&mut self, q: &[f64; N], qd: &[f64; N]) -> [[f64; N]; N] {
        self.place(q);
        for i in 0..N {
            let pose = self.poses[i];
            let velocity = self.links[i].parent.map_or(Spatial::zero(), |p| pose.motion_to_child(&self.velocities[p]));
            let Link { axis, inertia, .. } = &self.links[i];
            let velocity = velocity.plus(&axis.scale(qd[i]));
            self.composites[i] = *inertia;
            self.coriolis[i] = inertia.coriolis(&velocity);
            self.accelerations[i] = velocity.cross(axis);
            self.velocities[i] = velocity;
        }
        let mut c = [[0.0; N]; N];
        for j in (0..N).rev() {
            let axis = &self.links[j].axis;
            let (inertia, coriolis) = (self.composites[j], self.coriolis[j]);
            let mut f1 = inertia.times(&self.accelerations[j]).plus(&coriolis.times(axis));
            let mut f2 = inertia.times(axis);
            let mut f3 = coriolis.transposed_times(axis);
            c[j][j] = axis.dot(&f1);
            let mut i = j;
            while let Some(p) = self.links[i].parent {
                [f1, f2, f3] = [f1, f2, f3].map(|f| self.poses[i].force_to_parent(&f));
                i = p;
                let axis = &self.links[i].axis;
                c[i][j] = axis.dot(&f1);
                c[j][i] = self.accelerations[i].dot(&f2) + axis.dot(&f3);
            }
            if let Some(p) = self.links[j].parent {
                self.composites[p] = self.composites[p].plus(&inertia.to_parent(&self.poses[j]));
                self.coriolis[p] = self.coriolis[p].plus(&coriolis.to_parent(&self.poses[j]));
            }
        }
        c
    }

    fn place<const N: usize>(&mut self, q: &[f64; N]) {
        assert_eq!(self.links.len(), N, "one coordinate a link");
        for ((link, pose), q) in self.links.iter().zip(&mut self.poses).zip(q) {
            let Pose { rotation, position } = link.placement;
            *pose = match &link.joint {
                Joint::Hinge(axis) => {
                    Pose { rotation: rotation * Rotation3::from_axis_angle(axis, *q).into_inner(), position }
                }
                Joint::Slide(axis) => Pose { rotation, position: position + rotation * axis.scale(*q) },
            };
        }
    }
}

impl Joint {
    fn axis(&self) -> Spatial {
        match self {
            Joint::Hinge(axis) => Spatial { angular: axis.into_inner(), linear: Vector3::zeros() },
            Joint::Slide(axis) => Spatial { angular: Vector3::zeros(), linear: axis.into_inner() },
        }
    }
}

impl Spatial {
    fn zero() -> Self {
        Spatial { angular: Vector3::zeros(), linear: Vector3::zeros() }
    }

    fn plus(&self, other: &Self) -> Self {
        Spatial { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }

    fn scale(&self, factor: f64) -> Self {
        Spatial { angular: self.angular * factor, linear: self.linear * factor }
    }

    fn dot(&self, other: &Self) -> f64 {
        self.angular.dot(&other.angular) + self.linear.dot(&other.linear)
    }

    /// `v × m`
    fn cross(&self, motion: &Self) -> Self {
        Spatial {
            angular: self.angular.cross(&motion.angular),
            linear: self.angular.cross(&motion.linear) + self.linear.cross(&motion.angular),
        }
    }

    /// `v ×* f`
    fn cross_force(&self, force: &Self) -> Self {
        Spatial {
            angular: self.angular.cross(&force.angular) + self.linear.cross(&force.linear),
            linear: self.angular.cross(&force.linear),
        }
    }
}

impl Pose {
    fn motion_to_child(&self, motion: &Spatial) -> Spatial {
        let linear = motion.linear + motion.angular.cross(&self.position);
        Spatial { angular: self.rotation.tr_mul(&motion.angular), linear: self.rotation.tr_mul(&linear) }
    }

    fn force_to_parent(&self, force: &Spatial) -> Spatial {
        let linear = self.rotation * force.linear;
        Spatial { angular: self.rotation * force.angular + self.position.cross(&linear), linear }
    }
}

impl Inertia {
    fn plus(&self, other: &Self) -> Self {
        Inertia {
            mass: self.mass + other.mass,
            moment: self.moment + other.moment,
            rotational: self.rotational + other.rotational,
        }
    }

    fn times(&self, motion: &Spatial) -> Spatial {
        Spatial {
            angular: self.rotational * motion.angular + self.moment.cross(&motion.linear),
            linear: self.mass * motion.linear - self.moment.cross(&motion.angular),
        }
    }

    fn to_parent(self, pose: &Pose) -> Self {
        let Pose { rotation, position } = pose;
        let moment = rotation * self.moment;
        let (arm, cross) = (position.cross_matrix(), moment.cross_matrix());
        let shifted = cross * arm + arm * (cross + self.mass * arm);
        Inertia {
            mass: self.mass,
            moment: moment + self.mass * position,
            rotational: rotation * self.rotational * rotation.transpose() - shifted,
        }
    }

    fn articulated(&self) -> ArticulatedInertia {
        let mass = Matrix3::from_diagonal_element(self.mass);
        ArticulatedInertia { a: self.rotational, b: self.moment.cross_matrix(), c: mass }
    }

    /// `B = ½ (v ×* I − I v × + (I v) ×̄*)`, whose blocks on the right cancel.
    fn coriolis(&self, velocity: &Spatial) -> Coriolis {
        let Spatial { angular: n, linear: f } = self.times(velocity);
        let [w, v, h] = [&velocity.angular, &velocity.linear, &self.moment].map(|x| x.cross_matrix());
        let j = &self.rotational;
        let a = 0.5 * (w * j - j * w - v * h - h * v - n.cross_matrix());
        Coriolis { a, c: -f.cross_matrix() }
    }
}

impl Coriolis {
    fn plus(&self, other: &Self) -> Self {
        Coriolis { a: self.a + other.a, c: self.c + other.c }
    }

    fn times(&self, motion: &Spatial) -> Spatial {
        Spatial { angular: self.a * motion.angular, linear: self.c * motion.angular }
    }

    fn transposed_times(&self, motion: &Spatial) -> Spatial {
        let angular = self.a.tr_mul(&motion.angular) + self.c.tr_mul(&motion.linear);
        Spatial { angular, linear: Vector3::zeros() }
    }

    fn to_parent(self, pose: &Pose) -> Self {
        let r = &pose.rotation;
        let [a, c] = [self.a, self.c].map(|block| r * block * r.transpose());
        Coriolis { a: a + pose.position.cross_matrix() * c, c }
    }
}

impl ArticulatedInertia {
    fn plus(&self, other: &Self) -> Self {
        ArticulatedInertia { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    fn times(&self, motion: &Spatial) -> Spatial {
        Spatial {
            angular: self.a * motion.angular + self.b * motion.linear,
            linear: self.b.tr_mul(&motion.angular) + self.c * motion.linear,
        }
    }

    fn to_parent(self, pose: &Pose) -> Self {
        let (r, arm) = (&pose.rotation, pose.position.cross_matrix());
        let [a, b, c] = [self.a, self.b, self.c].map(|block| r * block * r.transpose());
        let shifted = b + arm * c;
        ArticulatedInertia { a: a - shifted * arm + arm * b.transpose(), b: shifted, c }
    }
}

fn about_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}
