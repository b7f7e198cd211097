//! Lagrange's equations from the energies as declared, by nested dual numbers.

use crate::expr::{Dual, Expr, Rounded, Symbol, Tape, Value};
use crate::interpret::State;
use crate::model::{Lagrangian, OutputValue};

use super::group::Group;
use super::tested::Tested;

/// The declared scalars, ready to be evaluated over any kind of number.
pub struct Witness<'l, 'g> {
    /// The mechanism.
    pub lagrangian: &'l Lagrangian<'g>,
    energies: Tape,
    forces: Tape,
    /// For each force on a point the velocity and the force, three components each; and the terms of D whose force is
    /// a part of Q.
    point_forces: Tape,
    constraints: Tape,
    outputs: Tape,
    frames: Tape,
    /// The mechanism with the joints of its reactions let go.
    pub released: Option<Box<Witness<'l, 'g>>>,
}

/// The values of all steps of the energies, with their rates: at a state, and with their derivatives along the motion.
struct Steps<V> {
    here: Vec<Dual<V>>,
    along_path: Vec<Dual<Dual<V>>>,
}

/// `∂L/∂q̇`, its time derivative, `∂L/∂q` and `∂D/∂q̇` for one coordinate, or along a direction of several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LagrangeTerms<V> {
    /// `∂L/∂q̇`
    pub momentum: V,
    /// `d/dt ∂L/∂q̇`
    pub momentum_rate: V,
    /// `∂L/∂q`
    pub position_gradient: V,
    /// `∂D/∂q̇`
    pub dissipation_force: V,
}

impl<'l, 'g> Witness<'l, 'g> {
    /// Tapes for everything declared.
    pub fn new(lagrangian: &'l Lagrangian<'g>) -> Self {
        let graph = lagrangian.graph;
        let sum = |terms: &[Expr<'g>]| terms.iter().fold(graph.integer(0), |sum, &term| sum + term);
        let kinetic = sum(&lagrangian.kinetic);
        let potential = sum(&lagrangian.potential);
        let l = kinetic - potential + sum(&lagrangian.lagrangian);
        let force = |i: usize| {
            let terms = lagrangian.forces.iter().filter(|(coordinate, _)| *coordinate == i);
            sum(&terms.map(|(_, force)| *force).collect::<Vec<_>>())
        };
        let outputs: Vec<_> = lagrangian.outputs.iter().flat_map(|o| output_components(lagrangian, &o.value)).collect();
        let [dissipation, dissipation_with_inputs] = lagrangian.dissipation_without_and_with_inputs();
        // −∂D/∂q̇ is what a force −1 gives on something that moves at the rate D.
        let [zero, minus_one] = [0, -1].map(|number| graph.integer(number));
        let of_inputs = |power: Expr<'g>| [power, zero, zero, minus_one, zero, zero];
        let point_forces: Vec<_> = (lagrangian.point_forces.iter())
            .flat_map(|f| f.velocity.0.into_iter().chain(f.force.0))
            .chain(dissipation_with_inputs.into_iter().flat_map(of_inputs))
            .collect();
        let frames = lagrangian.frames.iter().flat_map(|frame| {
            let rotation = frame.rotation.0.into_iter().flatten();
            let vectors = [frame.position, frame.angular_velocity, frame.velocity];
            rotation.chain(vectors.into_iter().flat_map(|v| v.0)).collect::<Vec<_>>()
        });
        Witness {
            lagrangian,
            energies: Tape::of_motions(&[l, kinetic, potential, sum(&dissipation)]),
            forces: Tape::of_motions(&(0..lagrangian.dof()).map(force).collect::<Vec<_>>()),
            point_forces: Tape::of_motions(&point_forces),
            constraints: Tape::of_motions(
                &lagrangian.constraints.iter().flat_map(|c| c.rows.clone()).collect::<Vec<_>>(),
            ),
            outputs: Tape::of_motions(&outputs),
            frames: Tape::of_motions(&frames.collect::<Vec<_>>()),
            released: lagrangian.released.as_deref().map(|released| Box::new(Witness::new(released))),
        }
    }

    /// Everything declared.
    pub(super) fn tapes(&self) -> [&Tape; 6] {
        [&self.energies, &self.forces, &self.point_forces, &self.constraints, &self.outputs, &self.frames]
    }

    /// Whether the energies, the forces, the rows of the constraints and their slopes along the motion are finite.
    pub(crate) fn is_finite(&self, state: &State<Rounded>, parameters: &[Rounded]) -> bool {
        let along_path = state.along(|symbol| path(state, symbol));
        let energies = self.energies(&along_path, &lift_all(parameters));
        let forces = self.forces(state, parameters);
        self.constraints_are_finite(state, parameters)
            && energies.iter().all(|e| e.value.value.is_finite() && e.derivative.value.is_finite())
            && forces.iter().all(|q| q.value.is_finite())
    }

    /// Holonomic rows with two derivatives, Pfaffian ones with one.
    fn constraints_are_finite(&self, state: &State<Rounded>, parameters: &[Rounded]) -> bool {
        self.constraints(state, parameters).iter().zip(self.lagrangian.holonomic_rows()).all(
            |([row, rate], holonomic)| {
                let last = if holonomic { rate.derivative } else { row.derivative };
                row.value.value.is_finite() && last.value.is_finite()
            },
        )
    }

    /// L, T, V, D.
    pub fn energies<V: Value>(&self, state: &State<V>, parameters: &[V]) -> [V; 4] {
        let values = self.energies.run(moving(state, parameters));
        [0, 1, 2, 3].map(|i| values[i].value)
    }

    /// L, T, V, D where some symbols vary from a point at which all steps are known.
    fn varied_energies<V: Value>(
        &self,
        known: &[Dual<V>],
        point: impl Fn(Symbol) -> Option<Dual<Dual<V>>>,
    ) -> [Dual<V>; 4] {
        let fixed = |v: Dual<V>| Dual::new(Dual::fixed(v.value), Dual::fixed(v.derivative));
        let values = self.energies.run_varied(known, fixed, point);
        [0, 1, 2, 3].map(|i| values[i].value)
    }

    /// Q along each group of coordinates.
    pub(crate) fn forces<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Vec<V> {
        let direct: Vec<V> = self.forces.run(moving(state, parameters)).iter().map(|q| q.value).collect();
        let groups = Group::of_equations(direct.len());
        groups.map(|group| group.sum(&direct) + self.virtual_work(group.direction(), state, parameters)).collect()
    }

    /// `Σ F · ∂v/∂q̇`, along a direction of the coordinates, over the forces on points and torques on bodies.
    fn virtual_work<V: Tested>(&self, direction: impl Fn(usize) -> V, state: &State<V>, parameters: &[V]) -> V {
        let varied = state.along(|symbol| in_velocities(&direction, symbol));
        let values = self.point_forces.run(moving(&varied, &lift_all(parameters)));
        let work =
            |pair: &[Dual<Dual<V>>]| -> V { (0..3).map(|k| pair[k].value.derivative * pair[3 + k].value.value).sum() };
        values.chunks(6).map(work).sum()
    }

    /// For each row of the constraints its value and its rate along the motion, both with their own rates.
    pub(crate) fn constraints<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Vec<[Dual<V>; 2]> {
        let along_path = state.along(|symbol| path(state, symbol));
        let values = self.constraints.run(moving(&along_path, &lift_all(parameters)));
        values.iter().map(|row| [row.value, row.derivative]).collect()
    }

    /// The outputs' components with their time derivatives, in the order of declaration.
    pub(crate) fn outputs<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Vec<Dual<V>> {
        self.outputs.run(moving(state, parameters))
    }

    /// For each frame rotation (9), position (3), angular velocity (3) and velocity (3), with their time derivatives.
    pub(crate) fn frames<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Vec<Dual<V>> {
        self.frames.run(moving(state, parameters))
    }

    /// The terms of Lagrange's equation along each group of coordinates.
    pub(crate) fn lagrange<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Vec<LagrangeTerms<V>> {
        let groups: Vec<Group> = Group::of_equations(state.q.len()).collect();
        // In one direction of all coordinates every step varies.
        let steps = (groups.len() == state.q.len()).then(|| self.steps(state, parameters));
        let along = |group: Group| self.lagrange_along(group.direction(), steps.as_ref(), state, parameters);
        groups.into_iter().map(along).collect()
    }

    /// All that the energies are computed of, at a state and along the motion.
    fn steps<V: Tested>(&self, state: &State<V>, parameters: &[V]) -> Steps<V> {
        let along_path = state.along(|symbol| path(state, symbol));
        Steps {
            here: self.energies.all(moving(state, parameters)),
            along_path: self.energies.all(moving(&along_path, &lift_all(parameters))),
        }
    }

    /// What holds the coordinates on their way, along a direction of them, beside the declared forces:
    /// `d/dt ∂L/∂q̇ − ∂L/∂q + ∂D/∂q̇ − (∂v/∂q̇)ᵀ F − Aᵀ λ`.
    pub(crate) fn holding_force<V: Tested>(
        &self,
        direction: impl Fn(usize) -> V,
        state: &State<V>,
        parameters: &[V],
        multipliers: &[V],
    ) -> V {
        let terms = self.lagrange_along(&direction, Some(&self.steps(state, parameters)), state, parameters);
        let work = self.virtual_work(&direction, state, parameters);
        // Of holonomic rows the slope in the coordinates is A, of Pfaffian ones that in the velocities.
        let parameters = lift_all(parameters);
        let slopes =
            |varied| self.constraints.run(moving(&varied, &parameters)).into_iter().map(|row| row.value.derivative);
        let by_position = slopes(state.along(|symbol| in_coordinates(&direction, symbol)));
        let by_velocity = slopes(state.along(|symbol| in_velocities(&direction, symbol)));
        let rows = self.lagrangian.holonomic_rows().into_iter().zip(by_position.zip(by_velocity));
        let rows = rows.map(|(holonomic, (position, velocity))| if holonomic { position } else { velocity });
        let constraint: V = rows.zip(multipliers).map(|(a, &lambda)| a * lambda).sum();
        terms.momentum_rate - terms.position_gradient + terms.dissipation_force - work - constraint
    }

    /// Where the steps of the energies are known, those alone that vary in the direction are computed.
    fn lagrange_along<V: Tested>(
        &self,
        direction: impl Fn(usize) -> V,
        steps: Option<&Steps<V>>,
        state: &State<V>,
        parameters: &[V],
    ) -> LagrangeTerms<V> {
        let once = lift_all(parameters);
        // ε along the motion, then δ along the direction of q̇: the coefficient of εδ is d/dt ∂L/∂q̇.
        let along_path = state.along(|symbol| path(state, symbol));
        let twice = along_path.along(|symbol| Dual::fixed(in_velocities(&direction, symbol)));
        let twice_fixed = lift_all(&once);
        let varies = |i: u32| !direction(i as usize).is_exactly_zero();
        // A velocity is the rate of its coordinate, too.
        let in_direction = |symbol| matches!(symbol, Symbol::Coordinate(i) | Symbol::Velocity(i) if varies(i));
        let point = moving(&twice, &twice_fixed);
        let [l, _, _, d] = match steps {
            Some(steps) => {
                let point = |symbol| in_direction(symbol).then(|| point(symbol));
                self.varied_energies(&steps.along_path, point)
            }
            None => self.energies(&twice, &twice_fixed),
        };
        let varied = state.along(|symbol| in_coordinates(&direction, symbol));
        let point = moving(&varied, &once);
        let [l_varied, ..] = match steps {
            Some(steps) => {
                let point = |symbol| matches!(symbol, Symbol::Coordinate(i) if varies(i)).then(|| point(symbol));
                self.varied_energies(&steps.here, point)
            }
            None => self.energies(&varied, &once),
        };
        LagrangeTerms {
            momentum: l.derivative.value,
            momentum_rate: l.derivative.derivative,
            position_gradient: l_varied.derivative,
            dissipation_force: d.derivative.value,
        }
    }
}

/// A direction of the coordinates.
fn in_coordinates<V: Tested>(direction: impl Fn(usize) -> V, symbol: Symbol) -> V {
    if let Symbol::Coordinate(i) = symbol { direction(i as usize) } else { V::default() }
}

/// A direction of the velocities.
fn in_velocities<V: Tested>(direction: impl Fn(usize) -> V, symbol: Symbol) -> V {
    if let Symbol::Velocity(i) = symbol { direction(i as usize) } else { V::default() }
}

/// How the symbols change along the motion.
pub(crate) fn path<V: Tested>(state: &State<V>, symbol: Symbol) -> V {
    match symbol {
        Symbol::Time => V::exact(1.0),
        Symbol::Coordinate(i) => state.qd[i as usize],
        Symbol::Velocity(i) => state.qdd[i as usize],
        Symbol::Prescribed(i, order @ (0 | 1)) => state.prescribed[i as usize][usize::from(order) + 1],
        Symbol::Prescribed(..) => V::constant(f64::NAN), // a third derivative is nowhere needed
        Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Multiplier(_) => V::default(),
    }
}

/// How the symbols change with time alone, coordinates and velocities held.
pub(crate) fn explicit_path<V: Tested>(state: &State<V>, symbol: Symbol) -> V {
    match symbol {
        Symbol::Coordinate(_) | Symbol::Velocity(_) => V::default(),
        other => path(state, other),
    }
}

/// A state whose numbers are exact.
pub(crate) fn exact(state: &State) -> State<Rounded> {
    let all = |values: &[f64]| values.iter().copied().map(Rounded::exact).collect();
    State {
        t: Rounded::exact(state.t),
        q: all(&state.q),
        qd: all(&state.qd),
        qdd: all(&state.qdd),
        u: all(&state.u),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Rounded::exact)).collect(),
    }
}

/// The state with `more` further coordinates, which rest at zero.
pub(crate) fn with_resting<V: Tested>(state: &State<V>, more: usize) -> State<V> {
    let all = |values: &[V]| [values, vec![V::default(); more].as_slice()].concat();
    State { q: all(&state.q), qd: all(&state.qd), qdd: all(&state.qdd), ..state.clone() }
}

/// Values that do not change.
pub(crate) fn lift_all<V: Value>(values: &[V]) -> Vec<Dual<V>> {
    values.iter().map(|&v| Dual::fixed(v)).collect()
}

/// The symbols with their time derivatives, for the declared `dt`.
pub(super) fn moving<V: Value>(state: &State<V>, parameters: &[V]) -> impl Fn(Symbol) -> Dual<V> {
    move |symbol| match symbol {
        Symbol::Time => Dual::new(state.t, V::constant(1.0)),
        Symbol::Coordinate(i) => Dual::new(state.q[i as usize], state.qd[i as usize]),
        Symbol::Velocity(i) => Dual::new(state.qd[i as usize], state.qdd[i as usize]),
        Symbol::Acceleration(i) => Dual::fixed(state.qdd[i as usize]),
        Symbol::Parameter(i) => Dual::fixed(parameters[i as usize]),
        Symbol::Input(i) => Dual::fixed(state.u[i as usize]),
        Symbol::Prescribed(i, order) => {
            let signal = &state.prescribed[i as usize];
            let rate = signal.get(usize::from(order) + 1).copied().unwrap_or(V::constant(f64::NAN));
            Dual::new(signal[usize::from(order)], rate)
        }
        Symbol::Multiplier(_) => unreachable!("multipliers are not declared"),
    }
}

pub(super) fn output_components<'g>(lagrangian: &Lagrangian<'g>, value: &OutputValue<'g>) -> Vec<Expr<'g>> {
    value.components(&lagrangian.frames)
}
