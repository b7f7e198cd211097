//! Lagrange's equations from the text: by Nielsen's form, `∂L̇/∂q̇ − 2 ∂L/∂q = d/dt ∂L/∂q̇ − ∂L/∂q`, so that one direction at a
//! time and the derivative along the motion are all that is ever differentiated.
//!
//! # Source
//! Nielsen, *Vorlesungen über elementare Mechanik*, 1935, p. 345.

use std::ops::Range;
use std::rc::Rc;

use super::evaluate::{Evaluator, State, Sums};
use super::mechanism::Mechanism;
use super::number::{Dual, Real};
use super::value::{Moving, Value, rate};

/// One component of a constraint, not yet known to be φ or `A q̇ + b`.
#[derive(Clone, Debug)]
pub(super) struct Component<S> {
    /// Its value, rate and second rate along the motion.
    pub(super) along: [S; 3],
    /// Derivatives of its value by the velocities: A where it is Pfaffian.
    pub(super) by_value: Vec<S>,
    /// Derivatives of its rate by the velocities: A where it is holonomic.
    pub(super) by_rate: Vec<S>,
}

impl<S: Real> Component<S> {
    /// Its row of A.
    pub(super) fn gradient(&self, holonomic: bool) -> &[S] {
        if holonomic { &self.by_rate } else { &self.by_value }
    }
    /// `A q̇ + b`
    pub(super) fn rate(&self, holonomic: bool) -> S {
        self.along[usize::from(holonomic)]
    }
    /// `A q̈ + γ`
    pub(super) fn second(&self, holonomic: bool) -> S {
        self.along[1 + usize::from(holonomic)]
    }
}

/// An output.
#[derive(Clone, Debug)]
pub(super) struct Output<S> {
    pub(super) value: Vec<S>,
    pub(super) velocity: Vec<S>,
    /// `∂(velocity)/∂q̇`, one column a coordinate.
    pub(super) columns: Vec<Vec<S>>,
    /// `∂(value)/∂q̇`, one column a coordinate.
    pub(super) speeds: Vec<Vec<S>>,
    /// `∂(value)/∂q`, one column a coordinate.
    pub(super) slopes: Vec<Vec<S>>,
}

/// What is wanted of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// What follows from derivatives by velocities: `inertia` lacks its part `−∂L/∂q`.
    Momenta,
    /// All but outputs.
    Motion,
    /// Everything.
    Outputs,
}

/// What Lagrange's equations are made of, for some of the coordinates.
#[derive(Clone, Debug)]
pub(super) struct Equations<S> {
    pub(super) kinetic: S,
    pub(super) potential: S,
    /// `∂L/∂q̇`
    pub(super) momentum: Vec<S>,
    /// `d/dt ∂L/∂q̇ − ∂L/∂q`
    pub(super) inertia: Vec<S>,
    /// `∂D/∂q̇`
    pub(super) dissipation: Vec<S>,
    /// Q
    pub(super) force: Vec<S>,
    /// All of them, those that vanish identically included.
    pub(super) rows: Vec<Component<S>>,
    pub(super) outputs: Vec<Output<S>>,
}

/// The equations of these coordinates; those behind the declared ones are the auxiliary ones of joints.
pub(super) fn equations<S: Real>(
    mechanism: &Mechanism,
    state: &State<S>,
    coordinates: Range<usize>,
    wanted: Wanted,
) -> Result<Equations<S>, String> {
    let mut equations: Option<Equations<S>> = None;
    let highest = coordinates.end.max(mechanism.dof());
    let mut lifted = state.map(&mut |x| Dual::fixed(x));
    for list in [&mut lifted.q, &mut lifted.qd, &mut lifted.qdd] {
        list.resize(highest, Dual::of(0.0));
    }
    for (done, i) in coordinates.enumerate() {
        let along_rate = seeded(mechanism, &lifted, wanted, |state| &mut state.qd[i])?;
        let equations = equations.get_or_insert_with(|| begun(&along_rate, wanted));
        let by_rate = lagrangian(&along_rate);
        equations.momentum.push(by_rate.re.re.eps);
        equations.inertia.push(by_rate.re.eps.eps);
        if wanted != Wanted::Momenta {
            let along = seeded(mechanism, &lifted, wanted, |state| &mut state.q[i])?;
            equations.inertia[done] = equations.inertia[done] - S::of(2.0) * lagrangian(&along).re.re.eps;
            if wanted == Wanted::Outputs {
                collect(equations, &along_rate, &along);
            }
        }
        equations.dissipation.push(along_rate.dissipation.re.re.eps);
        equations.force.push(force(&along_rate, i));
        let components = along_rate.constraints.iter().flat_map(|row| &row.components);
        for (row, component) in equations.rows.iter_mut().zip(components) {
            row.by_value.push(component.re.re.eps);
            row.by_rate.push(component.re.eps.eps);
        }
    }
    equations.ok_or_else(|| "no coordinates".to_string())
}

fn seeded<S: Real>(
    mechanism: &Mechanism,
    state: &State<Dual<S>>,
    wanted: Wanted,
    direction: impl Fn(&mut State<Dual<S>>) -> &mut Dual<S>,
) -> Result<Sums<Dual<S>>, String> {
    let mut state = state.clone();
    direction(&mut state).eps = S::of(1.0);
    let evaluator = Evaluator::new(mechanism, &state);
    if wanted == Wanted::Outputs { evaluator.run() } else { evaluator.without_outputs().run() }
}

fn lagrangian<S: Real>(sums: &Sums<S>) -> Moving<S> {
    sums.kinetic - sums.potential + sums.lagrangian
}

/// Virtual work: forces on the coordinate itself, and what places and rotations do when only this rate changes.
fn force<S: Real>(sums: &Sums<Dual<S>>, i: usize) -> S {
    let own = sums.forces.iter().filter(|(coordinate, _)| *coordinate == i).map(|(_, force)| force.re.re.re);
    let works = sums.works.iter().flat_map(|(rates, force)| rates.iter().zip(force));
    let works = works.map(|(rate, force)| rate.re.re.eps * force.re.re.re);
    own.chain(works).fold(S::zero(), |sum, term| sum + term)
}

/// What does not depend on the direction.
fn begun<S: Real>(sums: &Sums<Dual<S>>, wanted: Wanted) -> Equations<S> {
    let components = sums.constraints.iter().flat_map(|row| &row.components);
    let row = |x: &Moving<Dual<S>>| Component {
        along: [x.re.re.re, x.re.eps.re, x.eps.eps.re],
        by_value: Vec::new(),
        by_rate: Vec::new(),
    };
    let output = |(_, value): &(Rc<str>, Rc<Value<Dual<S>>>)| Output {
        value: value.flat().iter().map(|x| x.re.re.re).collect(),
        velocity: velocity(value).iter().map(|x| x.re.re.re).collect(),
        columns: Vec::new(),
        speeds: Vec::new(),
        slopes: Vec::new(),
    };
    Equations {
        kinetic: sums.kinetic.re.re.re,
        potential: sums.potential.re.re.re,
        momentum: Vec::new(),
        inertia: Vec::new(),
        dissipation: Vec::new(),
        force: Vec::new(),
        rows: components.map(row).collect(),
        outputs: if wanted == Wanted::Outputs { sums.outputs.iter().map(output).collect() } else { Vec::new() },
    }
}

/// Of a pose the velocity of its origin, then its angular velocity.
fn velocity<S: Real>(value: &Value<S>) -> Vec<Moving<S>> {
    match value {
        Value::Pose(pose) => pose.origin.iter().map(|&x| rate(x)).chain(pose.angular_velocity()).collect(),
        Value::Array(entries) => entries.iter().flat_map(|entry| velocity(entry)).collect(),
        other => other.flat().into_iter().map(rate).collect(),
    }
}

fn collect<S: Real>(equations: &mut Equations<S>, along_rate: &Sums<Dual<S>>, along: &Sums<Dual<S>>) {
    let sides = along_rate.outputs.iter().zip(&along.outputs);
    for (output, ((_, by_rate), (_, by_place))) in equations.outputs.iter_mut().zip(sides) {
        output.columns.push(velocity(by_rate).iter().map(|x| x.re.re.eps).collect());
        output.speeds.push(by_rate.flat().iter().map(|x| x.re.re.eps).collect());
        output.slopes.push(by_place.flat().iter().map(|x| x.re.re.eps).collect());
    }
}
