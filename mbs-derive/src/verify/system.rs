//! What is claimed of systems that are solved at run time: their entries. A solution is what solves its system,
//! whatever the order of pivots is, so that nothing else is to be proved of it.

use crate::catalogue::FunctionKind as Kind;
use crate::expr::{Dual, Elimination, Symbol, remainder};
use crate::interpret::{Interpreter, State, columns};
use crate::optimise::Function;
use crate::shape::Shape;

use super::Failure;
use super::claim::{Trial, called};
use super::group::Group;
use super::linear::add;
use super::tested::Tested;
use super::witness::lift_all;

/// The lower triangle of M and A, row by row.
struct Matrices<V> {
    mass: Vec<V>,
    jacobian: Vec<V>,
}

impl<V: Tested> Trial<'_, V> {
    /// `M q̈ − Aᵀ λ = Q − h − ∂D/∂q̇`, `A q̈ = −γ`, as it is set up for accelerations and for multipliers.
    pub(super) fn systems_of_motion(&self) -> Result<(), Failure> {
        let forces = difference(&self.call(Kind::GeneralizedForce), &self.force_without_acceleration());
        let targets = self.rows(Kind::ConstraintBias).into_iter().map(|bias| -bias);
        let right_side: Vec<V> = forces.into_iter().chain(targets).collect();
        for function in [Kind::ForwardDynamics, Kind::Multipliers].map(|kind| self.derivation.function(kind)) {
            let Some(function) = function else { continue };
            let values = self.interpreter.values(function, self.state, &[]);
            let rest = match &self.derivation.elimination {
                Some(elimination) => self.products("system of the motion", elimination, &values)?,
                None => self.matrices("system of the motion", &values)?,
            };
            self.equal("right side of the system of the motion", rest, &right_side)?;
        }
        Ok(())
    }

    /// That M and A, whose entries stand first, give what inverse dynamics and the constraints' rates do for any
    /// accelerations; what stands behind them.
    fn products<'v>(
        &self,
        claim: &'static str,
        elimination: &Elimination,
        values: &'v [V],
    ) -> Result<&'v [V], Failure> {
        let (entries, rest) = values.split_at(elimination.entries.len());
        let qdd = &self.state.qdd;
        let mut unknowns = qdd.clone();
        unknowns.resize(elimination.order.len(), V::default());
        let expected = [self.inertial_force(), self.along_rows(qdd)].concat();
        self.equal(claim, &elimination.times(entries, &unknowns), &expected)?;
        Ok(rest)
    }

    /// `M q̈`, by inverse dynamics.
    fn inertial_force(&self) -> Vec<V> {
        difference(&self.call(Kind::InverseDynamics), &self.force_without_acceleration())
    }

    /// `h + ∂D/∂q̇`, by inverse dynamics where there is no function for h.
    fn force_without_acceleration(&self) -> Vec<V> {
        if self.derivation.function(Kind::Bias).is_some() {
            return add(&self.call(Kind::Bias), &self.call(Kind::DissipationForce));
        }
        let unaccelerated = State { qdd: vec![V::default(); self.n()], ..self.state.clone() };
        called(&self.interpreter, Kind::InverseDynamics, &unaccelerated)
    }

    /// `A v`, by the rates of the constraints.
    pub(super) fn along_rows(&self, v: &[V]) -> Vec<V> {
        let rate = |qd: Vec<V>| self.rows_at(Kind::ConstraintRate, &State { qd, ..self.state.clone() });
        difference(&rate(v.to_vec()), &rate(vec![V::default(); self.n()]))
    }

    /// That M and A stand first; what stands behind them.
    fn matrices<'v>(&self, claim: &'static str, values: &'v [V]) -> Result<&'v [V], Failure> {
        let n = self.n();
        let Matrices { mass, jacobian } = self.expected_matrices();
        let (found, rest) = values.split_at(self.derivation.matrix_entries());
        let in_full = self.derivation.elimination.as_ref().map(|elimination| elimination.in_full(found));
        let (found_mass, found_jacobian) = match &in_full {
            Some((mass, jacobian)) => (mass.as_slice(), jacobian.as_slice()),
            None => found.split_at(n * (n + 1) / 2),
        };
        self.equal(claim, found_mass, &mass)?;
        self.equal(claim, found_jacobian, &jacobian)?;
        Ok(rest)
    }

    fn expected_matrices(&self) -> Matrices<V> {
        let (n, mass) = (self.n(), self.call(Kind::MassMatrix));
        let mass = (0..n).flat_map(|i| mass[i * n..=i * n + i].to_vec()).collect();
        Matrices { mass, jacobian: self.rows(Kind::ConstraintJacobian) }
    }

    /// The columns of a linearization in the state and the inputs: from `K x = b` follows `K x′ = b′ − K′ x`.
    pub(super) fn systems_of_linearization(&self, function: &Function) -> Result<(), Failure> {
        let columns = self.columns_of("system of the linearization", function)?;
        let kinds: [fn(u32) -> Symbol; 3] = [Symbol::Coordinate, Symbol::Velocity, Symbol::Input];
        let mut columns = columns.as_slice();
        for (width, symbol) in [self.n(), self.n(), self.state.u.len()].into_iter().zip(kinds) {
            let (part, behind) = columns.split_at(width);
            for group in Group::of(width) {
                let varied = self.state.along(|other| group.weight_of(other, symbol));
                let expected = self.right_side_of_slope(&self.dual, &varied);
                self.equal("right side of the system of the linearization", &sum(group, part), &expected)?;
            }
            columns = behind;
        }
        Ok(())
    }

    /// The columns of a linearization in the parameters.
    pub(super) fn systems_of_linearization_in_parameters(&self, function: &Function) -> Result<(), Failure> {
        let columns = self.columns_of("system of the linearization in the parameters", function)?;
        let state = self.state.along(|_| V::default());
        for group in Group::of(self.parameters.len()) {
            let mut parameters = lift_all(self.parameters);
            group.columns().for_each(|j| parameters[j].derivative = group.weight(j));
            let varied = Interpreter::with_parameters(self.derivation, parameters);
            let expected = self.right_side_of_slope(&varied, &state);
            let found = sum(group, &columns);
            self.equal("right side of the system of the linearization in the parameters", &found, &expected)?;
        }
        Ok(())
    }

    /// The right sides that a program sets up for any q̈ and λ.
    fn columns_of(&self, claim: &'static str, function: &Function) -> Result<Vec<Vec<V>>, Failure> {
        let values = self.interpreter.values(function, self.state, &self.multipliers());
        let rest = self.matrices(claim, &values)?;
        let width = |shape: Shape| if let Shape::Matrix(_, columns) = shape { columns } else { 1 };
        let widths: Vec<usize> = function.results.iter().map(|part| width(part.shape)).collect();
        Ok(columns(rest, &widths, self.n() + self.derivation.constraints.len()))
    }

    fn right_side_of_slope(&self, varied: &Interpreter<'_, Dual<V>>, state: &State<Dual<V>>) -> Vec<V> {
        let forward = self.derivation.function(Kind::ForwardDynamics).expect("what is linearized is solved for");
        let system = varied.system_of_motion(forward, state);
        let rate = |numbers: &[Dual<V>]| numbers.iter().map(|v| v.derivative).collect::<Vec<V>>();
        let solution = [self.state.qdd.clone(), self.multipliers()].concat();
        let (mass, jacobian, right_side) = (rate(&system.mass), rate(&system.jacobian), rate(&system.right_side));
        remainder(&mass, &jacobian, &right_side, &solution, self.n())
    }

    /// λ, any.
    pub(super) fn multipliers(&self) -> Vec<V> {
        (0..self.derivation.constraints.len()).map(|k| V::multiplier(self.state.t, k)).collect()
    }
}

/// `Σ wⱼ` times the columns of a group.
fn sum<V: Tested>(group: Group, columns: &[Vec<V>]) -> Vec<V> {
    let rows = columns.first().map_or(0, Vec::len);
    (0..rows).map(|i| group.columns().map(|j| group.weight::<V>(j) * columns[j][i]).sum()).collect()
}

fn difference<V: Tested>(a: &[V], b: &[V]) -> Vec<V> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}
