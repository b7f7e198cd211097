//! What is claimed of outputs: they are those declared, and their velocities and Jacobians are their derivatives.

use crate::catalogue::FunctionKind as Kind;
use crate::expr::{Dual, Symbol};
use crate::optimise::Function;
use crate::shape::Shape;

use super::Failure;
use super::claim::{Trial, called, is_rotation, one_if};
use super::linear::{add, times};
use super::tested::Tested;
use super::witness::path;

/// A position and the rows of a rotation.
const POSE: usize = 12;

impl<V: Tested> Trial<'_, V> {
    pub(super) fn outputs(&self) -> Result<(), Failure> {
        let declared = self.witness.outputs(self.state, self.parameters);
        let mut start = 0;
        for function in &self.derivation.functions {
            if let Kind::Output(number) = function.kind {
                let count = function.program.results.len();
                self.output(number, function, &declared[start..start + count])?;
                start += count;
            }
        }
        Ok(())
    }

    /// Value, velocity (of a pose: of the origin, and the angular velocity) and Jacobian of one output.
    fn output(&self, number: usize, function: &Function, declared: &[Dual<V>]) -> Result<(), Failure> {
        let value: Vec<V> = declared.iter().map(|v| v.value).collect();
        self.equal("output", &self.interpreter.evaluate(function, self.state), &value)?;
        let jacobian = self.call(Kind::OutputJacobian(number));
        self.jacobian_rate(number)?;
        let Some(found) = self.interpreter.call(Kind::OutputVelocity(number), self.state) else {
            return self.jacobian_of_a_velocity(number, function, &jacobian);
        };
        let is_of_frames = matches!(function.results[0].shape, Shape::Pose | Shape::Poses(_));
        let mut poses = declared.chunks(POSE);
        if is_of_frames && !poses.all(|pose| is_rotation(&pose[3..])) {
            // A quaternion off its constraint: no angular velocity to compare with.
            self.pass_over("velocity of an output", found.len())?;
            return self.pass_over("Jacobian of an output", found.len());
        }
        let velocity = match is_of_frames {
            true => declared.chunks(POSE).flat_map(spatial_velocity).collect(),
            false => declared.iter().map(|v| v.derivative).collect::<Vec<_>>(),
        };
        self.equal("velocity of an output", &found, &velocity)?;
        // The velocity is J q̇ + ∂/∂t.
        let drift = called(&self.interpreter, Kind::OutputVelocity(number), &self.at_rest());
        let product = times(&jacobian, &self.state.qd);
        self.equal("Jacobian of an output", &add(&product, &drift), &velocity)
    }

    /// The rate of a Jacobian, where there is one: the Jacobian's derivative along the motion.
    fn jacobian_rate(&self, number: usize) -> Result<(), Failure> {
        let found = self.interpreter.call(Kind::OutputJacobianRate(number), self.state);
        let Some(found) = found else { return Ok(()) };
        let expected = self.slope(Kind::OutputJacobian(number), |symbol| path(self.state, symbol));
        self.equal("rate of the Jacobian of an output", &found, &expected)
    }

    /// `∂output/∂q` of an output that depends on velocities or inputs, and its derivatives by these.
    fn jacobian_of_a_velocity(&self, number: usize, function: &Function, jacobian: &[V]) -> Result<(), Failure> {
        self.columns("Jacobian of an output", function, jacobian, self.n(), Symbol::Coordinate)?;
        if let Some(found) = self.interpreter.call(Kind::OutputJacobianQd(number), self.state) {
            self.columns("derivative of an output by q̇", function, &found, self.n(), Symbol::Velocity)?;
        }
        if let Some(found) = self.interpreter.call(Kind::OutputJacobianU(number), self.state) {
            self.columns("derivative of an output by u", function, &found, self.state.u.len(), Symbol::Input)?;
        }
        Ok(())
    }

    /// Column by column, the derivatives of a function in symbols of one kind.
    fn columns(
        &self,
        claim: &'static str,
        function: &Function,
        found: &[V],
        width: usize,
        symbol: fn(u32) -> Symbol,
    ) -> Result<(), Failure> {
        for j in 0..width {
            let chosen = symbol(j as u32);
            let state = self.state.along(|symbol| one_if(symbol == chosen));
            let expected: Vec<V> = self.dual.evaluate(function, &state).iter().map(|v| v.derivative).collect();
            let column: Vec<V> = (0..expected.len()).map(|i| found[i * width + j]).collect();
            self.equal(claim, &column, &expected)?;
        }
        Ok(())
    }
}

/// Velocity of the origin and angular velocity in world axes, `[ω]× = Ṙ Rᵀ`, from a pose and its rate.
fn spatial_velocity<V: Tested>(pose: &[Dual<V>]) -> Vec<V> {
    let r = |i: usize, j: usize| pose[3 + 3 * i + j];
    let spin = |i: usize, j: usize| (0..3).map(|k| r(i, k).derivative * r(j, k).value).sum::<V>();
    let position = pose[..3].iter().map(|p| p.derivative);
    position.chain([spin(2, 1), spin(0, 2), spin(1, 0)]).collect()
}
