//! Lagrange's equations from the text: by Nielsen's form, `∂L̇/∂q̇ − 2 ∂L/∂q = d/dt ∂L/∂q̇ − ∂L/∂q`, so that gradients
//! and the derivative along the motion are all that is ever differentiated.
//!
//! # Source
//! Nielsen, *Vorlesungen über elementare Mechanik*, 1935, p. 345.

use std::ops::Range;

use super::evaluate::{Evaluator, State, Sums};
use super::mechanism::Mechanism;
use super::number::{Base, Real};
use super::trace::{Trace, Traced};
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
    /// `∂(velocity)/∂q̇`, one row a component.
    pub(super) jacobian: Vec<Vec<S>>,
    /// `∂(value)/∂q̇`, one row a component.
    pub(super) speeds: Vec<Vec<S>>,
    /// `∂(value)/∂q`, one row a component.
    pub(super) slopes: Vec<Vec<S>>,
}

/// What is wanted of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Wanted {
    /// What the Lagrangian gives.
    Inertia,
    /// And the constraints.
    Rows,
    /// And all but outputs.
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

/// What the statements add up to at one state, and how: lines of a trace.
#[derive(Debug)]
pub(super) struct Written {
    trace: Trace,
    lines: Lines,
    /// The calculation with other roundings of the axes that vectors are turned into and back, if they are rounded:
    /// what two ways to the same force differ by does not cancel.
    again: Option<(Trace, Lines)>,
    /// How many coordinates there are, with those of joints.
    coordinates: usize,
}

#[derive(Debug)]
struct Lines {
    kinetic: usize,
    potential: usize,
    /// L and its rate.
    lagrangian: [usize; 2],
    dissipation: usize,
    /// Forces on coordinates.
    forces: Vec<(usize, usize)>,
    /// Rates of places and turns, and what does work on them.
    works: Vec<(usize, usize)>,
    /// Each component with its rate and its second rate.
    rows: Vec<[usize; 3]>,
    /// Components of values and of velocities.
    outputs: Vec<[Vec<usize>; 2]>,
}

impl Written {
    /// Goes through the text at a state. Behind the declared coordinates stand the auxiliary ones of joints, if the
    /// state has any.
    ///
    /// # Errors
    /// What the referee does not understand.
    pub(super) fn at<R: Base>(mechanism: &Mechanism, state: &State<R>) -> Result<Self, String> {
        let given = in_a_row(state);
        let calculation = |given: &[Traced<R>]| {
            let mut given = given.iter();
            let traced = state.map(&mut |_| *given.next().expect("as many numbers as the state has"));
            Ok(Lines::of(&Evaluator::new(mechanism, &traced).run()?, &traced.u))
        };
        let (trace, lines) = Trace::of(&given, calculation, Lines::groups)?;
        let again = if R::ROUGH { Some(Trace::of(&given, calculation, Lines::groups)?) } else { None };
        Ok(Written { trace, lines, again, coordinates: state.q.len() })
    }

    /// The equations of these coordinates. On which sides of branches they are was decided where they were written
    /// down.
    pub(super) fn equations<S: Real>(&self, state: &State<S>, range: Range<usize>, wanted: Wanted) -> Equations<S> {
        let (lines, one, given) = (&self.lines, S::of(1.0), in_a_row(state));
        let values = self.trace.values(&given, wanted as usize);
        let gradient = |line: usize| self.gradient(&values, &[(line, one)], given.len());
        let places = |gradient: &[S]| gradient[range.clone()].to_vec();
        let rates = |gradient: &[S]| gradient[self.coordinates..][range.clone()].to_vec();
        let [of_lagrangian, of_its_rate] = lines.lagrangian.map(gradient);
        let by_place = match &self.again {
            None => places(&of_lagrangian),
            Some((trace, lines)) => {
                let values = trace.values(&given, Wanted::Inertia as usize);
                places(&trace.gradient(&values, &[(lines.lagrangian[0], one)], given.len()))
            }
        };
        let inertia = rates(&of_its_rate).into_iter().zip(by_place);
        let mut equations = Equations {
            kinetic: values[lines.kinetic],
            potential: values[lines.potential],
            momentum: rates(&of_lagrangian),
            inertia: inertia.map(|(by_rate, by_place)| by_rate - S::of(2.0) * by_place).collect(),
            dissipation: Vec::new(),
            force: Vec::new(),
            rows: Vec::new(),
            outputs: Vec::new(),
        };
        if wanted >= Wanted::Rows {
            let row = |row: &[usize; 3]| Component {
                along: row.map(|line| values[line]),
                by_value: rates(&gradient(row[0])),
                by_rate: rates(&gradient(row[1])),
            };
            equations.rows = lines.rows.iter().map(row).collect();
        }
        if wanted >= Wanted::Motion {
            equations.dissipation = rates(&gradient(lines.dissipation));
            // Virtual work: what places and rotations do when only one rate changes, and forces on the coordinates
            // themselves.
            let works: Vec<(usize, S)> = lines.works.iter().map(|&(rate, force)| (rate, values[force])).collect();
            equations.force = rates(&self.gradient(&values, &works, given.len()));
            for &(coordinate, force) in lines.forces.iter().filter(|(coordinate, _)| range.contains(coordinate)) {
                let sum = &mut equations.force[coordinate - range.start];
                *sum = *sum + values[force];
            }
        }
        if wanted >= Wanted::Outputs {
            let all = |lines: &[usize]| lines.iter().map(|&line| values[line]).collect();
            let output = |[value, velocity]: &[Vec<usize>; 2]| {
                let by_value: Vec<Vec<S>> = value.iter().map(|&line| gradient(line)).collect();
                Output {
                    value: all(value),
                    velocity: all(velocity),
                    jacobian: velocity.iter().map(|&line| rates(&gradient(line))).collect(),
                    speeds: by_value.iter().map(|gradient| rates(gradient)).collect(),
                    slopes: by_value.iter().map(|gradient| places(gradient)).collect(),
                }
            };
            equations.outputs = lines.outputs.iter().map(output).collect();
        }
        equations
    }

    fn gradient<S: Real>(&self, values: &[S], sum: &[(usize, S)], given: usize) -> Vec<S> {
        self.trace.gradient(values, sum, given)
    }
}

/// All numbers of a state: places, rates, and the others.
fn in_a_row<S: Copy>(state: &State<S>) -> Vec<S> {
    let mut numbers = Vec::new();
    let _: State<()> = state.map(&mut |x| numbers.push(x));
    numbers
}

impl Lines {
    fn of<R: Base>(sums: &Sums<Traced<R>>, inputs: &[Traced<R>]) -> Self {
        let value = |x: &Moving<Traced<R>>| x.re.re.line();
        let (with_inputs, without): (Vec<Moving<Traced<R>>>, Vec<_>) =
            sums.dissipation.iter().copied().partition(|term| term.re.re.depends_on(inputs));
        let dissipation = without.into_iter().fold(Moving::of(0.0), |sum, term| sum + term);
        // −∂D/∂q̇ is what a force −1 gives on something that moves at the rate D.
        let driven = with_inputs.iter().map(|power| (value(power), value(&Moving::of(-1.0))));
        let lagrangian = sums.kinetic - sums.potential + sums.lagrangian;
        let components = sums.constraints.iter().flat_map(|row| &row.components);
        let all = |values: Vec<Moving<Traced<R>>>| values.iter().map(value).collect::<Vec<usize>>();
        Lines {
            kinetic: value(&sums.kinetic),
            potential: value(&sums.potential),
            lagrangian: [value(&lagrangian), lagrangian.re.eps.line()],
            dissipation: value(&dissipation),
            forces: sums.forces.iter().map(|(coordinate, force)| (*coordinate, value(force))).collect(),
            works: (sums.works.iter())
                .flat_map(|(rates, force)| rates.iter().map(value).zip(force.iter().map(value)))
                .chain(driven)
                .collect(),
            rows: components.map(|x| [value(x), x.re.eps.line(), x.eps.eps.line()]).collect(),
            outputs: sums.outputs.iter().map(|(_, y)| [all(y.flat()), all(velocity(y))]).collect(),
        }
    }

    /// In the order of [`Wanted`].
    fn groups(&self) -> Vec<Vec<usize>> {
        let pairs = self.forces.iter().map(|(_, force)| *force);
        let works = self.works.iter().flat_map(|&(rate, force)| [rate, force]);
        vec![
            vec![self.kinetic, self.potential, self.lagrangian[0], self.lagrangian[1]],
            self.rows.iter().flatten().copied().collect(),
            pairs.chain(works).chain([self.dissipation]).collect(),
            self.outputs.iter().flatten().flatten().copied().collect(),
        ]
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
