//! Control by the model: the arm's own equations of motion, evaluated at each moment.

use mbs_runtime::control::ComputedTorque;

use super::{Arm, JointVector};

impl Arm {
    /// The joint torques \[N·m\] of computed torque at this state, by this arm as the model: the inputs of the plant,
    /// which may differ from it.
    ///
    /// | argument    | meaning                                                    | unit                |
    /// |-------------|------------------------------------------------------------|---------------------|
    /// | `reference` | angles, rates and accelerations wanted at this moment      | rad, rad/s, rad/s²  |
    /// | `q`, `qd`   | the state                                                  | rad, rad/s          |
    ///
    /// ```
    /// use mbs_arm::Arm;
    /// use mbs_runtime::control::ComputedTorque;
    ///
    /// let arm = Arm::default();
    /// let control = ComputedTorque::critically_damped(4.0).unwrap();
    /// let q = [0.1, -1.5, 0.2, 0.0, 0.4, 0.0];
    /// // At rest where it should be, the arm needs its weight carried and nothing else.
    /// let torque = arm.computed_torque(&control, &[q, [0.0; 6], [0.0; 6]], &q, &[0.0; 6]);
    /// let gravity = arm.gravity_compensation(&q);
    /// assert!((0..6).all(|i| (torque[i] - gravity[i]).abs() < 1e-9));
    /// ```
    #[must_use]
    pub fn computed_torque(
        &self,
        control: &ComputedTorque<6>,
        reference: &[JointVector; 3],
        q: &JointVector,
        qd: &JointVector,
    ) -> JointVector {
        self.model.inverse_dynamics(q, qd, &control.acceleration(reference, q, qd))
    }

    /// The joint torques \[N·m\] that carry the arm's weight: `G(q)`. Under them alone it stays where it is at rest.
    #[must_use]
    pub fn gravity_compensation(&self, q: &JointVector) -> JointVector {
        self.model.gravity(q)
    }
}
