//! The arm as a multibody of rapier: bodies whose frames are the links', hinges about z.

use rapier3d_f64::prelude::*;

use crate::numbers::{Arm, Frame, Link};

/// A world with nothing but the arm.
pub struct World {
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    joints: ImpulseJointSet,
    multibodies: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    collisions: CCDSolver,
    arm: MultibodyIndex,
    gravity: Vector,
}

impl World {
    /// The arm on a fixed body.
    pub fn new(arm: &Arm) -> World {
        let (mut bodies, mut multibodies) = (RigidBodySet::new(), MultibodyJointSet::new());
        let mut before = bodies.insert(RigidBodyBuilder::fixed());
        for (Frame { d, a, alpha_deg }, Link { m, com, inertia }) in arm.dh.iter().zip(&arm.links) {
            let [xx, xy, xz, yy, yz, zz] = *inertia;
            let inertia = Matrix::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
            let mass = MassProperties::with_inertia_matrix(Vector::from_array(*com), *m, inertia);
            let body = RigidBodyBuilder::dynamic().additional_mass_properties(mass).can_sleep(false);
            let link = bodies.insert(body);
            // A hinge turns about the x axis of its frames.
            let z_is_x = Pose::from_rotation(Rotation::from_rotation_y(-std::f64::consts::FRAC_PI_2));
            let far = Pose::from_parts(Vector::new(*a, 0.0, *d), Rotation::from_rotation_x(alpha_deg.to_radians()));
            let hinge = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
                .local_frame1(z_is_x)
                .local_frame2(far.inverse() * z_is_x)
                .build();
            multibodies.insert(before, link, hinge, true).expect("a link has one parent");
            before = link;
        }
        let index = multibodies.rigid_body_link(before).expect("the last link").multibody;
        // The root is fixed from the first kinematics on; until then it has six coordinates.
        let multibody = multibodies.get_multibody_mut(index).expect("the arm");
        multibody.forward_kinematics(&bodies, true);
        // Its hinges are damped by 0.1 N m s unless told otherwise.
        multibody.damping_mut().fill(0.0);
        World {
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies,
            colliders: ColliderSet::new(),
            joints: ImpulseJointSet::new(),
            multibodies,
            soft_bodies: SoftBodySet::new(),
            collisions: CCDSolver::new(),
            arm: index,
            gravity: Vector::new(0.0, 0.0, -arm.g),
        }
    }

    /// The rates after a step from here \[rad/s\].
    pub fn step(&mut self, q: &[f64; 6], qd: &[f64; 6], dt: f64) -> [f64; 6] {
        self.place(q, qd);
        let parameters = IntegrationParameters { dt, ..Default::default() };
        self.pipeline.step(
            self.gravity,
            &parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibodies,
            &mut self.soft_bodies,
            &mut self.collisions,
            &(),
            &(),
        );
        let rates = self.multibodies.get_multibody(self.arm).expect("the arm").generalized_velocity();
        std::array::from_fn(|i| rates[i])
    }

    /// Accelerations without torques, by a step that is too short to move.
    pub fn accelerations(&mut self, q: &[f64; 6], qd: &[f64; 6]) -> [f64; 6] {
        const SHORT: f64 = 1e-9;
        let after = self.step(q, qd, SHORT);
        std::array::from_fn(|i| (after[i] - qd[i]) / SHORT)
    }

    /// The state, as coordinates of the joints.
    fn place(&mut self, q: &[f64; 6], qd: &[f64; 6]) {
        let arm = self.multibodies.get_multibody_mut(self.arm).expect("the arm");
        let now: Vec<f64> = arm.links().skip(1).map(|link| link.joint().coords()[3]).collect();
        let by: Vec<f64> = q.iter().zip(&now).map(|(q, now)| q - now).collect();
        arm.apply_displacements(&by);
        arm.generalized_velocity_mut().iter_mut().zip(qd).for_each(|(rate, qd)| *rate = *qd);
        arm.forward_kinematics(&self.bodies, false);
        arm.update_rigid_bodies(&mut self.bodies, true);
    }
}
