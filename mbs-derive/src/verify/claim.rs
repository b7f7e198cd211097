//! What is proved at one state: each generated function and identity against the witness.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;

use crate::expr::{AGREEMENT, Dual, Rounded, Symbol, Value, least_change};
use crate::interpret::{Interpreter, State};
use crate::numeric::elimination::{Elimination, ROUNDING, eliminate_rounded, on_allowed_motions, scales};

use crate::optimise::{Completion, Derivation, Function, FunctionKind, Shape};

use super::group::Group;
use super::inertia;
use super::linear::{add, quadratic_form, times};
use super::motion::Motion;
use super::witness::{LagrangeTerms, Witness, explicit_path, lift, lift_all, path, with_resting};
use super::{Disagreement, Failure, TOLERANCE};

/// A position and the rows of a rotation.
const POSE: usize = 12;

/// One state at which a derivation is tried.
pub struct Trial<'a> {
    pub(super) witness: &'a Witness<'a, 'a>,
    pub(super) derivation: &'a Derivation,
    pub(super) state: &'a State<Rounded>,
    pub(super) parameters: &'a [Rounded],
    pub(super) interpreter: Interpreter<'a, Rounded>,
    pub(super) dual: Interpreter<'a, Dual<Rounded>>,
    terms: OnceCell<Vec<LagrangeTerms>>,
    /// What functions give at the state, by their names.
    results: RefCell<BTreeMap<String, Vec<Rounded>>>,
    motion: OnceCell<Motion<'a>>,
}

/// How near to zero holonomic rows are brought at states that hold them, as a part of their terms.
pub(super) const CLOSED: f64 = 1e-13;

impl<'a> Trial<'a> {
    /// At a state, with parameters.
    pub fn new(
        witness: &'a Witness<'a, 'a>,
        derivation: &'a Derivation,
        state: &'a State<Rounded>,
        parameters: &'a [Rounded],
    ) -> Self {
        Trial {
            witness,
            derivation,
            state,
            parameters,
            interpreter: Interpreter::with_parameters(derivation, parameters.to_vec()),
            dual: Interpreter::with_parameters(derivation, lift_all(parameters)),
            terms: OnceCell::new(),
            results: RefCell::default(),
            motion: OnceCell::new(),
        }
    }

    /// Compares everything.
    pub fn prove(&self) -> Result<(), Failure> {
        self.energies()?;
        self.twists_of_frames()?;
        self.momentum_and_forces()?;
        self.inverse_dynamics()?;
        self.kinetic_form()?;
        self.mass_matrix_is_that_of_inverse_dynamics()?;
        self.coriolis_matrix()?;
        self.inverse_dynamics_jacobian()?;
        self.constraints()?;
        if self.accelerations_are_determined()? {
            self.forward_dynamics()?;
            self.linearization()?;
            self.conserved()?;
        }
        self.reactions()?;
        self.outputs()
    }

    /// What elimination shows of M, and of `M + Aᵀ A`, which is singular where a motion that the constraints allow has
    /// no inertia; each with the size of a pivot that may be nothing but rounding.
    pub(super) fn inertia(&self) -> [(Elimination, f64); 2] {
        [self.call("mass_matrix"), self.augmented_mass_matrix()].map(|matrix| eliminate_rounded(&matrix, self.n()))
    }

    pub(super) fn derivation(&self) -> &'a Derivation {
        self.derivation
    }

    /// The constraint of each row.
    pub(super) fn vectors(&self) -> &'a [usize] {
        &self.derivation.constraint_vectors
    }

    /// Whether there are constraints.
    pub fn is_constrained(&self) -> bool {
        !self.derivation.constraints.is_empty()
    }

    /// Whether the energies are finite at another state.
    pub fn is_finite_at(&self, state: &State<Rounded>) -> bool {
        self.witness.is_finite(state, self.parameters)
    }

    /// The same trial at another state.
    pub fn at<'b>(&'b self, state: &'b State<Rounded>) -> Trial<'b> {
        Trial::new(self.witness, self.derivation, state, self.parameters)
    }

    pub(super) fn n(&self) -> usize {
        self.derivation.dof()
    }

    pub(super) fn call(&self, name: &str) -> Vec<Rounded> {
        if let Some(results) = self.results.borrow().get(name) {
            return results.clone();
        }
        let results = self.interpreter.call(name, self.state).unwrap_or_default();
        self.results.borrow_mut().insert(name.to_string(), results.clone());
        results
    }

    /// The derivative of a Program's results in a direction of the state.
    fn slope(&self, name: &str, direction: impl Fn(Symbol) -> Rounded) -> Vec<Rounded> {
        let state = lift(self.state, direction);
        self.dual.call(name, &state).unwrap_or_default().iter().map(|v| v.derivative).collect()
    }

    /// The derivative of accelerations along that of a state and of the parameters of a mechanism.
    fn acceleration_slope(
        &self,
        varied: &Interpreter<'_, Dual<Rounded>>,
        state: &State<Dual<Rounded>>,
    ) -> Vec<Rounded> {
        match self.derivation.function("forward_dynamics") {
            Some(function) if function.completion == Completion::SolveConstrained => {
                self.motion(function).slope(self.n(), &varied.system_of_motion(function, state))
            }
            _ => varied.call("forward_dynamics", state).unwrap_or_default().iter().map(|v| v.derivative).collect(),
        }
    }

    pub(super) fn motion(&self, forward_dynamics: &Function) -> &Motion<'a> {
        self.motion.get_or_init(|| {
            Motion::new(self.n(), self.interpreter.system_of_motion(forward_dynamics, self.state), self.vectors())
        })
    }

    /// Compares component by component: to [`TOLERANCE`], or to what rounding may have done to either side.
    pub(super) fn equal(&self, claim: &'static str, found: &[Rounded], expected: &[Rounded]) -> Result<(), Failure> {
        assert_eq!(found.len(), expected.len(), "{claim}");
        for (component, (found, expected)) in found.iter().zip(expected).enumerate() {
            let rounding = ROUNDING * (found.error + expected.error);
            let allowed = TOLERANCE * found.value.abs().max(expected.value.abs()) + rounding;
            // Where the witness itself is 0/0 (a derivative at a corner), or all rounding, it says nothing; but where
            // it is a number, what is none disagrees.
            let silent = !(expected.value.is_finite() && expected.error.is_finite())
                || found.value.is_finite() && !found.error.is_finite();
            let agrees = (found.value - expected.value).abs() <= allowed;
            if !agrees && !silent {
                return Err(Failure::Disagreement(Box::new(Disagreement {
                    claim,
                    component,
                    found: found.value,
                    expected: expected.value,
                    state: doubles(self.state),
                    parameters: doubles_of(self.parameters),
                })));
            }
        }
        Ok(())
    }

    fn energies(&self) -> Result<(), Failure> {
        let [_, kinetic, potential, _] = self.witness.energies(self.state, self.parameters);
        self.equal("kinetic energy", &self.call("kinetic_energy"), &[kinetic])?;
        self.equal("potential energy", &self.call("potential_energy"), &[potential])
    }

    /// `[ω]× = Rᵀ Ṙ` and `v = Rᵀ ṗ`: the recursion of twists against the time derivative of the poses, where R is a
    /// rotation and stays one: a quaternion is of unit length only where its constraint holds.
    fn twists_of_frames(&self) -> Result<(), Failure> {
        let speed = self.state.qd.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        for values in self.witness.frames(self.state, self.parameters).chunks(18) {
            let (r, p) = (|i: usize, j: usize| values[3 * i + j], |i: usize| values[9 + i]);
            if !is_rotation(&values[..9]) {
                continue;
            }
            let spin = |i: usize, j: usize| (0..3).map(|k| r(k, i).value * r(k, j).derivative).sum::<Rounded>();
            let velocity = |i: usize| (0..3).map(|k| r(k, i).value * p(k).derivative).sum::<Rounded>();
            let expected = [spin(2, 1), spin(0, 2), spin(1, 0), velocity(0), velocity(1), velocity(2)];
            // A quaternion's length is held to rounding, and so is that R is a rotation.
            let open = Rounded { value: 0.0, error: 10.0 * CLOSED * speed };
            let found: Vec<Rounded> = values[12..18].iter().map(|v| v.value + open).collect();
            self.equal("twist of a frame", &found, &expected)?;
        }
        Ok(())
    }

    /// Lagrange's equations by the witness.
    fn terms(&self) -> &[LagrangeTerms] {
        self.terms.get_or_init(|| self.witness.lagrange(self.state, self.parameters))
    }

    fn momentum_and_forces(&self) -> Result<(), Failure> {
        let of = |f: fn(&LagrangeTerms) -> Rounded| self.terms().iter().map(f).collect::<Vec<_>>();
        self.equal("momentum = ∂L/∂q̇", &self.call("momentum"), &of(|t| t.momentum))?;
        let force = of(|t| t.dissipation_force);
        self.equal("dissipation force = ∂D/∂q̇", &self.call("dissipation_force"), &force)?;
        let declared = self.witness.forces(self.state, self.parameters);
        self.equal("generalized force", &self.call("generalized_force"), &declared)
    }

    /// `d/dt ∂L/∂q̇ − ∂L/∂q + ∂D/∂q̇`
    fn inverse_dynamics(&self) -> Result<(), Failure> {
        let expected = self.terms().iter().map(|t| t.momentum_rate - t.position_gradient + t.dissipation_force);
        self.equal(
            "inverse dynamics = Lagrange's equations",
            &self.call("inverse_dynamics"),
            &expected.collect::<Vec<_>>(),
        )
    }

    /// `q̇ᵀ M q̇ = L(q̇) + L(−q̇) − 2 L(0)`
    fn kinetic_form(&self) -> Result<(), Failure> {
        let with = |sign: f64| {
            let qd = self.state.qd.iter().map(|&v| Rounded::exact(sign) * v).collect();
            self.witness.energies(&State { qd, ..self.state.clone() }, self.parameters)[0]
        };
        let (forward, backward, rest) = (with(1.0), with(-1.0), with(0.0));
        let form = quadratic_form(&self.call("mass_matrix"), &self.state.qd);
        self.equal("q̇ᵀ M q̇ = 2 L₂", &[form], &[forward + backward - rest - rest])
    }

    /// `M q̈ + h + ∂D/∂q̇`, which ties the mass matrix and the bias to inverse dynamics.
    fn mass_matrix_is_that_of_inverse_dynamics(&self) -> Result<(), Failure> {
        let (m, bias, d) = (self.call("mass_matrix"), self.call("bias"), self.call("dissipation_force"));
        let product = times(&m, &self.state.qdd);
        let sum: Vec<Rounded> = (0..self.n()).map(|i| product[i] + bias[i] + d[i]).collect();
        self.equal("M q̈ + h + ∂D/∂q̇ = inverse dynamics", &sum, &self.call("inverse_dynamics"))
    }

    /// `C q̇ + G = h`, and C is that of Christoffel's symbols: `½(Ṁ + ∂M/∂t + P − Pᵀ) + ∂a/∂q − (∂a/∂q)ᵀ`, entry by
    /// entry, with `Pᵢⱼ = ∂(M q̇)ᵢ/∂qⱼ`.
    fn coriolis_matrix(&self) -> Result<(), Failure> {
        let n = self.n();
        let (c, g) = (self.call("coriolis_matrix"), self.call("gravity"));
        let product = times(&c, &self.state.qd);
        let sum: Vec<Rounded> = product.iter().zip(&g).map(|(&a, &b)| a + b).collect();
        self.equal("C q̇ + G = h", &sum, &self.call("bias"))?;
        let m_dot = self.slope("mass_matrix", |symbol| path(self.state, symbol));
        let m_t = self.slope("mass_matrix", |symbol| explicit_path(self.state, symbol));
        // The momenta are p = M q̇ + a: ∂p/∂q = P + ∂a/∂q, and ∂a/∂q where nothing moves.
        let [moving, resting] = [self.state.clone(), self.at_rest()].map(|state| self.momentum_gradient(&state));
        let half = Rounded::exact(0.5);
        let skew = |b: &[Rounded], k: usize| b[k] - b[k % n * n + k / n];
        let entry = |k: usize| half * (m_dot[k] + m_t[k]) + half * (skew(&moving, k) + skew(&resting, k));
        self.equal("C = ½(Ṁ + ∂M/∂t + P − Pᵀ) + ∂a/∂q − (∂a/∂q)ᵀ", &c, &(0..n * n).map(entry).collect::<Vec<_>>())
    }

    /// `∂p/∂q` by dual numbers, row by row; p itself is proved to be `∂L/∂q̇`.
    fn momentum_gradient(&self, state: &State<Rounded>) -> Vec<Rounded> {
        let n = self.n();
        let column = |j: usize| {
            let varied = lift(state, |symbol| one_if(symbol == Symbol::Coordinate(j as u32)));
            self.dual.call("momentum", &varied).unwrap_or_default()
        };
        let columns: Vec<Vec<Dual<Rounded>>> = (0..n).map(column).collect();
        (0..n * n).map(|k| columns[k % n][k / n].derivative).collect()
    }

    fn at_rest(&self) -> State<Rounded> {
        State { qd: vec![Rounded::default(); self.n()], ..self.state.clone() }
    }

    fn inverse_dynamics_jacobian(&self) -> Result<(), Failure> {
        let n = self.n();
        let found = self.call("inverse_dynamics_jacobian");
        for (matrix, symbol) in found.chunks(n * n).zip([Symbol::Coordinate, Symbol::Velocity]) {
            for group in Group::of(n) {
                let expected = self.slope("inverse_dynamics", |other| group.weight_of(other, symbol));
                self.equal("inverse dynamics Jacobian", &group.combined(matrix, n), &expected)?;
            }
        }
        Ok(())
    }

    /// `M + Aᵀ A`, regular wherever M is on the motions that A allows.
    fn augmented_mass_matrix(&self) -> Vec<Rounded> {
        on_allowed_motions(self.n(), self.call("mass_matrix"), self.call_if_any("constraint_jacobian"), self.vectors())
    }

    /// Whether accelerations are determined at this state: not where M, or M on the motions that A allows, is singular,
    /// or where rows contradict each other. They are numbers where it clearly is not, no row does, and all else is
    /// finite. Without constraints they may be numbers where M is singular, too: a pivot that would be zero is what
    /// rounding leaves of it.
    fn accelerations_are_determined(&self) -> Result<bool, Failure> {
        let found = self.call("forward_dynamics");
        if found.iter().all(|qdd| qdd.value.is_finite()) {
            let at = || inertia::is_undetermined(self, &doubles(self.state), &doubles_of(self.parameters));
            return Ok(self.is_constrained() || !at());
        }
        let finite = |name: &str| self.call(name).iter().all(|v| v.value.is_finite() && v.error.is_finite());
        let names = ["mass_matrix", "bias", "dissipation_force", "generalized_force"];
        let is_bound = !self.is_constrained() || finite("constraint_bias") && finite("constraint_jacobian");
        let is_given = is_bound && names.into_iter().all(finite);
        if is_given && self.is_regular(&self.augmented_mass_matrix(), self.n()) && self.rows_agree() {
            let zero = vec![Rounded::default(); found.len()];
            self.equal("accelerations are numbers where M is regular on the allowed motions", &found, &zero)?;
        }
        Ok(false)
    }

    /// Whether what holds the rows that others do not determine holds all of them.
    fn rows_agree(&self) -> bool {
        const AGREED: f64 = 1e-10;
        let (n, a) = (self.n(), doubles_of(&self.call_if_any("constraint_jacobian")));
        let target: Vec<f64> = self.call_if_any("constraint_bias").iter().map(|v| -v.value).collect();
        let Some(qdd) = least_change(&doubles_of(&self.weights()), &a, self.vectors(), &target) else { return false };
        a.chunks(n).zip(&target).all(|(row, c)| {
            let terms = || row.iter().zip(&qdd).map(|(a, x)| a * x);
            (c - terms().sum::<f64>()).abs() <= AGREED * (c.abs() + terms().map(f64::abs).sum::<f64>())
        })
    }

    /// Whether no pivot of a matrix is anywhere near zero.
    fn is_regular(&self, matrix: &[Rounded], n: usize) -> bool {
        let (elimination, rounding) = eliminate_rounded(matrix, n);
        elimination.smallest > rounding.max(1e-6)
    }

    /// The results of a function that exists only for constrained mechanisms.
    pub(super) fn call_if_any(&self, name: &str) -> Vec<Rounded> {
        if self.derivation.constraints.is_empty() { Vec::new() } else { self.call(name) }
    }

    /// The rows as declared; `A q̇ + b` is the rate of φ, or the Pfaffian row; `A q̈ + γ` is the rate of that.
    fn constraints(&self) -> Result<(), Failure> {
        let declared = self.witness.constraints(self.state, self.parameters);
        let (value, bias) = (self.call_if_any("constraint"), self.call_if_any("constraint_bias"));
        let jacobian = self.call_if_any("constraint_jacobian");
        let expected: Vec<Rounded> = declared.iter().map(|[row, _]| row.value).collect();
        self.equal("constraint", &value, &expected)?;
        // The velocity equation of each row, and its rate.
        let velocity = |(holonomic, [row, rate]): (&bool, &[Dual<Rounded>; 2])| if *holonomic { *rate } else { *row };
        let velocity: Vec<_> = self.derivation.holonomic.iter().zip(&declared).map(velocity).collect();
        let first: Vec<Rounded> = velocity.iter().map(|row| row.value).collect();
        self.equal("A q̇ + b", &self.call_if_any("constraint_rate"), &first)?;
        self.constraint_rate_jacobian()?;
        let second: Vec<Rounded> = velocity.iter().map(|row| row.derivative).collect();
        let product = times(&jacobian, &self.state.qdd);
        self.equal("A q̈ + γ", &add(&product, &bias), &second)
    }

    fn constraint_rate_jacobian(&self) -> Result<(), Failure> {
        let (found, rows) = (self.call_if_any("constraint_rate_jacobian"), self.derivation.constraints.len());
        for group in Group::of(if rows == 0 { 0 } else { self.n() }) {
            let expected = self.slope("constraint_rate", |other| group.weight_of(other, Symbol::Coordinate));
            self.equal("∂(A q̇ + b)/∂q", &group.combined(&found, rows), &expected)?;
        }
        Ok(())
    }

    /// `Aᵀ λ`
    pub(super) fn constraint_force(&self) -> Vec<Rounded> {
        let (a, l) = (self.call_if_any("constraint_jacobian"), self.call_if_any("multipliers"));
        let n = self.n();
        (0..n).map(|i| l.iter().enumerate().map(|(k, &l)| a[k * n + i] * l).sum()).collect()
    }

    fn forward_dynamics(&self) -> Result<(), Failure> {
        let (m, qdd) = (self.call("mass_matrix"), self.call("forward_dynamics"));
        let product = times(&m, &qdd);
        let (h, d, q) = (self.call("bias"), self.call("dissipation_force"), self.call("generalized_force"));
        let reaction = self.constraint_force();
        let residual: Vec<Rounded> = (0..self.n()).map(|i| product[i] + h[i] + d[i] - reaction[i]).collect();
        self.equal("M q̈ + h + ∂D/∂q̇ = Q + Aᵀ λ", &residual, &q)?;
        let (bias, a) = (self.call_if_any("constraint_bias"), self.call_if_any("constraint_jacobian"));
        let product = times(&a, &qdd);
        // A row that depends on others where the constraints hold does so no better than the state holds them.
        let open = |k: usize| {
            let size: f64 = (0..self.n()).map(|i| (a[k * self.n() + i].value * qdd[i].value).abs()).sum();
            Rounded { value: 0.0, error: 10.0 * CLOSED * (size + bias[k].value.abs()) }
        };
        let zero: Vec<Rounded> = (0..bias.len()).map(open).collect();
        let rates = add(&product, &bias);
        self.equal("A q̈ + γ = 0", &rates, &zero).or_else(|_| {
            let left: Vec<Rounded> =
                zero.iter().zip(self.left_by_state(&a, &qdd)).map(|(&zero, left)| zero + left).collect();
            let found = self.equal("A q̈ + γ = 0", &rates, &left);
            found.or_else(|failure| match self.holds_constraints() {
                true => Err(failure),
                false => self.equal("A q̈ + γ = 0", &rates, &self.left_by_solution(&a, &qdd, &bias)),
            })
        })
    }

    /// What the solution accepts of rows that depend on others: off the constraints these contradict each other, by a
    /// part of the terms of a row and of those it depends on, here of the greatest.
    fn left_by_solution(&self, a: &[Rounded], qdd: &[Rounded], bias: &[Rounded]) -> Vec<Rounded> {
        let n = self.n();
        let scales = scales(n, &self.call("mass_matrix"), a, self.vectors());
        let size = |(k, row): (usize, &[Rounded])| {
            let along: f64 = row.iter().zip(qdd).map(|(a, qdd)| (a.value * qdd.value).abs()).sum();
            scales.target(k, along + bias[k].value.abs())
        };
        let greatest = a.chunks(n).enumerate().map(size).fold(0.0, f64::max);
        let left = |k: usize| Rounded { value: 0.0, error: 2.0 * AGREEMENT * greatest / scales.target(k, 1.0) };
        (0..bias.len()).map(left).collect()
    }

    /// What places and velocities that hold the constraints to rounding leave of `A q̈ + γ`: rows that depend on others
    /// contradict them by that. An angle of hundreds of turns is held less well than a small one.
    fn left_by_state(&self, a: &[Rounded], qdd: &[Rounded]) -> Vec<Rounded> {
        let speed = self.state.qd.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        let blurred = |v: &Rounded, size: f64| Rounded { value: v.value, error: v.error + CLOSED * size };
        let qd = self.state.qd.iter().map(|v| blurred(v, speed)).collect();
        let moving = State { qd, ..self.state.clone() };
        let placed = State { q: self.state.q.iter().map(|v| blurred(v, v.value.abs())).collect(), ..moving.clone() };
        let call = |name: &str, state| self.interpreter.call(name, state).unwrap_or_default();
        let (accelerations, slopes, bias) =
            (call("forward_dynamics", &moving), call("constraint_jacobian", &placed), call("constraint_bias", &placed));
        let n = self.n();
        let left = |(k, bias): (usize, &Rounded)| {
            let along = |i: usize| {
                a[k * n + i].value.abs() * accelerations[i].error + slopes[k * n + i].error * qdd[i].value.abs()
            };
            Rounded { value: 0.0, error: (0..n).map(along).sum::<f64>() + bias.error }
        };
        bias.iter().enumerate().map(left).collect()
    }

    fn linearization(&self) -> Result<(), Failure> {
        let n = self.n();
        let found = self.call("linearize");
        let inputs = self.state.u.len();
        let kinds: [fn(u32) -> Symbol; 3] = [Symbol::Coordinate, Symbol::Velocity, Symbol::Input];
        let mut start = 0;
        for (width, symbol) in [n, n, inputs].into_iter().zip(kinds) {
            for group in Group::of(width) {
                let varied = lift(self.state, |other| group.weight_of(other, symbol));
                let expected = self.acceleration_slope(&self.dual, &varied);
                let found = group.combined(&found[start..start + n * width], n);
                self.equal("linearization", &found, &expected)?;
            }
            start += n * width;
        }
        self.linearization_in_parameters()
    }

    fn linearization_in_parameters(&self) -> Result<(), Failure> {
        let found = self.call("linearize_parameters");
        let state = lift(self.state, |_| Rounded::default());
        for group in Group::of(self.parameters.len()) {
            let mut parameters = lift_all(self.parameters);
            group.columns().for_each(|j| parameters[j].derivative = group.weight(j));
            let varied = Interpreter::with_parameters(self.derivation, parameters);
            let expected = self.acceleration_slope(&varied, &state);
            self.equal("linearization in the parameters", &group.combined(&found, self.n()), &expected)?;
        }
        Ok(())
    }

    /// The wrenches at joints hold the auxiliary coordinates of the joints at zero, whatever the multipliers are.
    fn reactions(&self) -> Result<(), Failure> {
        let Some(released) = &self.witness.released else { return Ok(()) };
        // Irregular, by the golden ratio, and others at other states.
        let multiplier = |k: usize| 4.0 * (self.state.t.value + 0.618_033_988_749_894_9 * k as f64).fract() - 2.0;
        let multipliers: Vec<Rounded> =
            (0..self.derivation.constraints.len()).map(|k| Rounded::exact(multiplier(k))).collect();
        let functions = self.derivation.functions.iter().filter(|f| matches!(f.kind, FunctionKind::Reaction(_)));
        let found: Vec<Rounded> =
            functions.flat_map(|f| self.interpreter.evaluate_with(f, self.state, &multipliers)).collect();
        let (n, state) = (self.n(), with_resting(self.state, found.len()));
        for group in Group::of(found.len()) {
            let direction = |i: usize| group.weight_of(Symbol::Coordinate(i as u32), Symbol::Coordinate);
            let direction = |i: usize| i.checked_sub(n).map_or(Rounded::default(), direction);
            let expected = released.holding_force(direction, &state, self.parameters, &multipliers);
            self.equal("reactions", &group.combined(&found, 1), &[expected])?;
        }
        Ok(())
    }

    fn outputs(&self) -> Result<(), Failure> {
        let declared = self.witness.outputs(self.state, self.parameters);
        let mut start = 0;
        for function in &self.derivation.functions {
            if matches!(function.kind, FunctionKind::Output(_)) {
                let count = function.program.results.len();
                self.output(function, &declared[start..start + count])?;
                start += count;
            }
        }
        Ok(())
    }

    /// Value, velocity (of a pose: of the origin, and the angular velocity) and Jacobian of one output.
    fn output(&self, function: &Function, declared: &[Dual<Rounded>]) -> Result<(), Failure> {
        let value: Vec<Rounded> = declared.iter().map(|v| v.value).collect();
        self.equal("output", &self.interpreter.evaluate(function, self.state), &value)?;
        let jacobian = self.call(&format!("{}_jacobian", function.name));
        self.jacobian_rate(&function.name)?;
        let Some(found) = self.interpreter.call(&format!("{}_velocity", function.name), self.state) else {
            return self.jacobian_of_a_velocity(function, &jacobian);
        };
        let is_of_frames = matches!(function.results[0].shape, Shape::Pose | Shape::Poses(_));
        let mut poses = declared.chunks(POSE);
        if is_of_frames && !poses.all(|pose| is_rotation(&pose[3..])) {
            return Ok(()); // a quaternion off its constraint: no angular velocity to compare with
        }
        let velocity = match is_of_frames {
            true => declared.chunks(POSE).flat_map(spatial_velocity).collect(),
            false => declared.iter().map(|v| v.derivative).collect::<Vec<_>>(),
        };
        self.equal("velocity of an output", &found, &velocity)?;
        // The velocity is J q̇ + ∂/∂t.
        let drift = self.interpreter.call(&format!("{}_velocity", function.name), &self.at_rest()).unwrap_or_default();
        let product = times(&jacobian, &self.state.qd);
        self.equal("Jacobian of an output", &add(&product, &drift), &velocity)
    }

    /// The rate of a Jacobian, where there is one: the Jacobian's derivative along the motion.
    fn jacobian_rate(&self, output: &str) -> Result<(), Failure> {
        let Some(found) = self.interpreter.call(&format!("{output}_jacobian_rate"), self.state) else { return Ok(()) };
        let expected = self.slope(&format!("{output}_jacobian"), |symbol| path(self.state, symbol));
        self.equal("rate of the Jacobian of an output", &found, &expected)
    }

    /// `∂output/∂q` of an output that depends on velocities or inputs, and its derivatives by these.
    fn jacobian_of_a_velocity(&self, function: &Function, jacobian: &[Rounded]) -> Result<(), Failure> {
        self.columns("Jacobian of an output", function, jacobian, self.n(), Symbol::Coordinate)?;
        let slopes = |suffix: &str| self.interpreter.call(&format!("{}_{suffix}", function.name), self.state);
        if let Some(found) = slopes("jacobian_qd") {
            self.columns("derivative of an output by q̇", function, &found, self.n(), Symbol::Velocity)?;
        }
        if let Some(found) = slopes("jacobian_u") {
            self.columns("derivative of an output by u", function, &found, self.state.u.len(), Symbol::Input)?;
        }
        Ok(())
    }

    /// Column by column, the derivatives of a function in symbols of one kind.
    fn columns(
        &self,
        claim: &'static str,
        function: &Function,
        found: &[Rounded],
        width: usize,
        symbol: fn(u32) -> Symbol,
    ) -> Result<(), Failure> {
        for j in 0..width {
            let chosen = symbol(j as u32);
            let state = lift(self.state, |symbol| one_if(symbol == chosen));
            let expected: Vec<Rounded> = self.dual.evaluate(function, &state).iter().map(|v| v.derivative).collect();
            let column: Vec<Rounded> = (0..expected.len()).map(|i| found[i * width + j]).collect();
            self.equal(claim, &column, &expected)?;
        }
        Ok(())
    }
}

/// Whether a matrix is orthonormal, and remains so.
fn is_rotation(r: &[Dual<Rounded>]) -> bool {
    let product = |i: usize, j: usize| {
        (0..3).fold(Dual::fixed(Rounded::default()), |sum, k| sum.add(r[3 * k + i].mul(r[3 * k + j])))
    };
    (0..9).all(|k| {
        let (entry, unit) = (product(k / 3, k % 3), one_if(k / 3 == k % 3));
        (entry.value - unit).value.abs() < 1e-9 && entry.derivative.value.abs() < 1e-9
    })
}

/// Velocity of the origin and angular velocity in world axes, `[ω]× = Ṙ Rᵀ`, from a pose and its rate.
fn spatial_velocity(pose: &[Dual<Rounded>]) -> Vec<Rounded> {
    let r = |i: usize, j: usize| pose[3 + 3 * i + j];
    let spin = |i: usize, j: usize| (0..3).map(|k| r(i, k).derivative * r(j, k).value).sum::<Rounded>();
    let position = pose[..3].iter().map(|p| p.derivative);
    position.chain([spin(2, 1), spin(0, 2), spin(1, 0)]).collect()
}

/// 1 where it holds, else 0.
fn one_if(holds: bool) -> Rounded {
    Rounded::exact(f64::from(u8::from(holds)))
}

/// The state without the bounds.
pub(super) fn doubles(state: &State<Rounded>) -> State {
    let all = doubles_of;
    State {
        t: state.t.value,
        q: all(&state.q),
        qd: all(&state.qd),
        qdd: all(&state.qdd),
        u: all(&state.u),
        prescribed: state.prescribed.iter().map(|signal| signal.map(|v| v.value)).collect(),
    }
}

pub(super) fn doubles_of(values: &[Rounded]) -> Vec<f64> {
    values.iter().map(|v| v.value).collect()
}
