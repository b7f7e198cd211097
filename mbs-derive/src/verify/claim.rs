//! What is proved at one state: each generated function and identity against the witness.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

use crate::catalogue::{Claim, FunctionKind, FunctionKind as Kind};
use crate::expr::{Dual, Rounded, Symbol, Value};
use crate::interpret::{Interpreter, State};
use crate::optimise::Derivation;

use super::Failure;
use super::group::Group;
use super::linear::{add, quadratic_form, times};
use super::motion::Motion;
use super::tested::Tested;
use super::witness::{LagrangeTerms, Witness, explicit_path, lift_all, path, with_resting};

/// One state at which a derivation is tried.
pub(crate) struct Trial<'a, V: Tested = Rounded> {
    pub(super) witness: &'a Witness<'a, 'a>,
    pub(super) derivation: &'a Derivation,
    pub(super) state: &'a State<V>,
    pub(super) parameters: &'a [V],
    pub(super) interpreter: Interpreter<'a, V>,
    pub(super) dual: Interpreter<'a, Dual<V>>,
    terms: OnceCell<Vec<LagrangeTerms<V>>>,
    /// What functions give at the state.
    results: RefCell<BTreeMap<FunctionKind, Vec<V>>>,
    pub(super) motion: OnceCell<Motion<'a, V>>,
    /// What is being claimed.
    pub(super) claim: Cell<Option<Claim>>,
    /// Of numbers that are not compared by themselves what is left of each claim, in order.
    pub(super) differences: RefCell<Vec<Difference<V>>>,
}

/// What a claim is about, and what is found less what is expected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference<V> {
    pub claim: Option<Claim>,
    pub text: &'static str,
    pub component: usize,
    /// Whether it is claimed at all, or only where constraints hold.
    pub is_made: bool,
    pub left: V,
}

/// How near to zero holonomic rows are brought at states that hold them, as a part of their terms.
pub(super) const CLOSED: f64 = 1e-13;

impl<'a, V: Tested> Trial<'a, V> {
    /// At a state, with parameters.
    pub(crate) fn new(
        witness: &'a Witness<'a, 'a>,
        derivation: &'a Derivation,
        state: &'a State<V>,
        parameters: &'a [V],
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
            claim: Cell::new(None),
            differences: RefCell::default(),
        }
    }

    /// Compares everything but what is known: each function of the mechanism, by what is claimed of it.
    pub(crate) fn prove(&self, known: &BTreeSet<Claim>) -> Result<(), Failure> {
        let claims: BTreeSet<Claim> = self.derivation.functions.iter().map(|f| f.kind.entry().claim).collect();
        let mut are_determined = None;
        for &claim in claims.difference(known) {
            self.claim.set(Some(claim));
            if claim.is_of_accelerations() && are_determined.is_none() {
                are_determined = Some(V::accelerations_are_determined(self)?);
            }
            if !claim.is_of_accelerations() || are_determined == Some(true) {
                self.hold(claim)?;
            }
        }
        Ok(())
    }

    fn hold(&self, claim: Claim) -> Result<(), Failure> {
        match claim {
            Claim::Energies => self.energies().and_then(|()| self.twists_of_frames()),
            Claim::Momentum => self.momentum(),
            Claim::DissipationForce => self.dissipation_force(),
            Claim::GeneralizedForce => self.generalized_force(),
            Claim::InverseDynamics => self.inverse_dynamics(),
            Claim::MassMatrix => self.kinetic_form(),
            Claim::Bias => self.mass_matrix_is_that_of_inverse_dynamics(),
            Claim::CoriolisMatrix => self.coriolis_matrix(),
            Claim::InverseDynamicsJacobian => self.inverse_dynamics_jacobian(),
            Claim::Constraint => self.constraint(),
            Claim::ConstraintRate => self.constraint_rate(),
            Claim::ConstraintRateJacobian => self.constraint_rate_jacobian(),
            Claim::ConstraintBias => self.constraint_bias(),
            Claim::ForwardDynamics => self.forward_dynamics(),
            Claim::Linearization => self.linearization(),
            Claim::LinearizationInParameters => self.linearization_in_parameters(),
            Claim::Conserved => self.conserved(),
            Claim::Reactions => self.reactions(),
            Claim::Outputs => self.outputs(),
        }
    }

    pub(super) fn derivation(&self) -> &'a Derivation {
        self.derivation
    }

    /// The constraint of each row.
    pub(super) fn vectors(&self) -> &'a [usize] {
        &self.derivation.constraint_vectors
    }

    /// Whether there are constraints.
    pub(crate) fn is_constrained(&self) -> bool {
        !self.derivation.constraints.is_empty()
    }

    /// The same trial at another state.
    pub(crate) fn at<'b>(&'b self, state: &'b State<V>) -> Trial<'b, V> {
        Trial::new(self.witness, self.derivation, state, self.parameters)
    }

    pub(super) fn n(&self) -> usize {
        self.derivation.dof()
    }

    /// The results of a function at the state.
    pub(super) fn call(&self, kind: FunctionKind) -> Vec<V> {
        self.results.borrow_mut().entry(kind).or_insert_with(|| called(&self.interpreter, kind, self.state)).clone()
    }

    /// The results at the state of a function of the rows of constraints, of which there may be none.
    pub(super) fn rows(&self, kind: FunctionKind) -> Vec<V> {
        if self.is_constrained() { self.call(kind) } else { Vec::new() }
    }

    /// Those at another state.
    pub(super) fn rows_at(&self, kind: FunctionKind, state: &State<V>) -> Vec<V> {
        self.interpreter.rows(kind, state)
    }

    /// The derivative of a Program's results in a direction of the state.
    pub(super) fn slope(&self, kind: FunctionKind, direction: impl Fn(Symbol) -> V) -> Vec<V> {
        called(&self.dual, kind, &self.state.along(direction)).iter().map(|v| v.derivative).collect()
    }

    /// Compares component by component.
    pub(super) fn equal(&self, claim: &'static str, found: &[V], expected: &[V]) -> Result<(), Failure> {
        assert_eq!(found.len(), expected.len(), "{claim}");
        V::compare(self, claim, found, expected)
    }

    pub(super) fn difference(&self, text: &'static str, component: usize, left: V) -> Difference<V> {
        Difference { claim: self.claim.get(), text, component, is_made: true, left }
    }

    /// Says nothing of a claim that is made where constraints hold alone.
    pub(super) fn pass_over(&self, claim: &'static str, components: usize) -> Result<(), Failure> {
        V::pass_over(self, claim, components)
    }

    fn energies(&self) -> Result<(), Failure> {
        let [_, kinetic, potential, _] = self.witness.energies(self.state, self.parameters);
        self.equal("kinetic energy", &self.call(Kind::KineticEnergy), &[kinetic])?;
        self.equal("potential energy", &self.call(Kind::PotentialEnergy), &[potential])
    }

    /// `[ω]× = Rᵀ Ṙ` and `v = Rᵀ ṗ`: the recursion of twists against the time derivative of the poses, where R is a
    /// rotation and stays one: a quaternion is of unit length only where its constraint holds.
    fn twists_of_frames(&self) -> Result<(), Failure> {
        // A quaternion's length is held to rounding, and so is that R is a rotation.
        let open = V::left_open(&self.state.qd);
        for values in self.witness.frames(self.state, self.parameters).chunks(18) {
            let (r, p) = (|i: usize, j: usize| values[3 * i + j], |i: usize| values[9 + i]);
            if !is_rotation(&values[..9]) {
                self.pass_over("twist of a frame", 6)?;
                continue;
            }
            let spin = |i: usize, j: usize| (0..3).map(|k| r(k, i).value * r(k, j).derivative).sum::<V>();
            let velocity = |i: usize| (0..3).map(|k| r(k, i).value * p(k).derivative).sum::<V>();
            let expected = [spin(2, 1), spin(0, 2), spin(1, 0), velocity(0), velocity(1), velocity(2)];
            let found: Vec<V> = values[12..18].iter().map(|v| v.value + open).collect();
            self.equal("twist of a frame", &found, &expected)?;
        }
        Ok(())
    }

    /// Lagrange's equations by the witness.
    fn terms(&self) -> &[LagrangeTerms<V>] {
        self.terms.get_or_init(|| self.witness.lagrange(self.state, self.parameters))
    }

    /// What each group of Lagrange's equations has of these numbers, one for each coordinate.
    fn in_equations(&self, values: &[V]) -> Vec<V> {
        Group::of_equations(self.n()).map(|group| group.sum(values)).collect()
    }

    fn momentum(&self) -> Result<(), Failure> {
        let expected: Vec<V> = self.terms().iter().map(|t| t.momentum).collect();
        self.equal("momentum = ∂L/∂q̇", &self.in_equations(&self.call(Kind::Momentum)), &expected)
    }

    fn dissipation_force(&self) -> Result<(), Failure> {
        let expected: Vec<V> = self.terms().iter().map(|t| t.dissipation_force).collect();
        let found = self.in_equations(&self.call(Kind::DissipationForce));
        self.equal("dissipation force = ∂D/∂q̇", &found, &expected)
    }

    fn generalized_force(&self) -> Result<(), Failure> {
        let declared = self.witness.forces(self.state, self.parameters);
        self.equal("generalized force", &self.in_equations(&self.call(Kind::GeneralizedForce)), &declared)
    }

    /// `d/dt ∂L/∂q̇ − ∂L/∂q + ∂D/∂q̇`
    fn inverse_dynamics(&self) -> Result<(), Failure> {
        let expected = self.terms().iter().map(|t| t.momentum_rate - t.position_gradient + t.dissipation_force);
        self.equal(
            "inverse dynamics = Lagrange's equations",
            &self.in_equations(&self.call(Kind::InverseDynamics)),
            &expected.collect::<Vec<_>>(),
        )
    }

    /// `q̇ᵀ M q̇ = L(q̇) + L(−q̇) − 2 L(0)`
    fn kinetic_form(&self) -> Result<(), Failure> {
        let with = |sign: f64| {
            let qd = self.state.qd.iter().map(|&v| V::exact(sign) * v).collect();
            self.witness.energies(&State { qd, ..self.state.clone() }, self.parameters)[0]
        };
        let (forward, backward, rest) = (with(1.0), with(-1.0), with(0.0));
        let form = quadratic_form(&self.call(Kind::MassMatrix), &self.state.qd);
        self.equal("q̇ᵀ M q̇ = 2 L₂", &[form], &[forward + backward - rest - rest])
    }

    /// `M q̈ + h + ∂D/∂q̇`, which ties the mass matrix and the bias to inverse dynamics.
    fn mass_matrix_is_that_of_inverse_dynamics(&self) -> Result<(), Failure> {
        let (m, bias, d) = (self.call(Kind::MassMatrix), self.call(Kind::Bias), self.call(Kind::DissipationForce));
        let product = times(&m, &self.state.qdd);
        let sum: Vec<V> = (0..self.n()).map(|i| product[i] + bias[i] + d[i]).collect();
        self.equal("M q̈ + h + ∂D/∂q̇ = inverse dynamics", &sum, &self.call(Kind::InverseDynamics))
    }

    /// `C q̇ + G = h`, and C is that of Christoffel's symbols: `½(Ṁ + ∂M/∂t + P − Pᵀ) + ∂a/∂q − (∂a/∂q)ᵀ`, entry by
    /// entry, with `Pᵢⱼ = ∂(M q̇)ᵢ/∂qⱼ`.
    fn coriolis_matrix(&self) -> Result<(), Failure> {
        let n = self.n();
        let (c, g) = (self.call(Kind::CoriolisMatrix), self.call(Kind::Gravity));
        let product = times(&c, &self.state.qd);
        let sum: Vec<V> = product.iter().zip(&g).map(|(&a, &b)| a + b).collect();
        self.equal("C q̇ + G = h", &sum, &self.call(Kind::Bias))?;
        let m_dot = self.slope(Kind::MassMatrix, |symbol| path(self.state, symbol));
        let m_t = self.slope(Kind::MassMatrix, |symbol| explicit_path(self.state, symbol));
        // The momenta are p = M q̇ + a: ∂p/∂q = P + ∂a/∂q, and ∂a/∂q where nothing moves.
        let [moving, resting] = [self.state.clone(), self.at_rest()].map(|state| self.momentum_gradient(&state));
        let half = V::exact(0.5);
        let skew = |b: &[V], k: usize| b[k] - b[k % n * n + k / n];
        let entry = |k: usize| half * (m_dot[k] + m_t[k]) + half * (skew(&moving, k) + skew(&resting, k));
        self.equal("C = ½(Ṁ + ∂M/∂t + P − Pᵀ) + ∂a/∂q − (∂a/∂q)ᵀ", &c, &(0..n * n).map(entry).collect::<Vec<_>>())
    }

    /// `∂p/∂q` by dual numbers, row by row; p itself is proved to be `∂L/∂q̇`.
    fn momentum_gradient(&self, state: &State<V>) -> Vec<V> {
        let n = self.n();
        let column = |j: usize| {
            let varied = state.along(|symbol| one_if(symbol == Symbol::Coordinate(j as u32)));
            called(&self.dual, Kind::Momentum, &varied)
        };
        let columns: Vec<Vec<Dual<V>>> = (0..n).map(column).collect();
        (0..n * n).map(|k| columns[k % n][k / n].derivative).collect()
    }

    pub(super) fn at_rest(&self) -> State<V> {
        State { qd: vec![V::default(); self.n()], ..self.state.clone() }
    }

    fn inverse_dynamics_jacobian(&self) -> Result<(), Failure> {
        let n = self.n();
        let found = self.call(Kind::InverseDynamicsJacobian);
        for (matrix, symbol) in found.chunks(n * n).zip([Symbol::Coordinate, Symbol::Velocity]) {
            for group in Group::of(n) {
                let expected = self.slope(Kind::InverseDynamics, |other| group.weight_of(other, symbol));
                self.equal("inverse dynamics Jacobian", &group.combined(matrix, n), &expected)?;
            }
        }
        Ok(())
    }

    /// The velocity equation of each row, the rate of φ or the Pfaffian row itself, with its rate.
    fn velocity_equations(&self) -> Vec<Dual<V>> {
        let declared = self.witness.constraints(self.state, self.parameters);
        let velocity = |(holonomic, [row, rate]): (&bool, [Dual<V>; 2])| if *holonomic { rate } else { row };
        self.derivation.holonomic.iter().zip(declared).map(velocity).collect()
    }

    fn constraint(&self) -> Result<(), Failure> {
        let declared = self.witness.constraints(self.state, self.parameters);
        let expected: Vec<V> = declared.iter().map(|[row, _]| row.value).collect();
        self.equal("constraint", &self.call(Kind::Constraint), &expected)
    }

    fn constraint_rate(&self) -> Result<(), Failure> {
        let expected: Vec<V> = self.velocity_equations().iter().map(|row| row.value).collect();
        self.equal("A q̇ + b", &self.call(Kind::ConstraintRate), &expected)
    }

    fn constraint_bias(&self) -> Result<(), Failure> {
        let expected: Vec<V> = self.velocity_equations().iter().map(|row| row.derivative).collect();
        let product = match self.derivation.function(Kind::ConstraintJacobian) {
            Some(_) => times(&self.call(Kind::ConstraintJacobian), &self.state.qdd),
            None => self.along_rows(&self.state.qdd),
        };
        self.equal("A q̈ + γ", &add(&product, &self.call(Kind::ConstraintBias)), &expected)
    }

    fn constraint_rate_jacobian(&self) -> Result<(), Failure> {
        let (found, rows) = (self.call(Kind::ConstraintRateJacobian), self.derivation.constraints.len());
        for group in Group::of(self.n()) {
            let expected = self.slope(Kind::ConstraintRate, |other| group.weight_of(other, Symbol::Coordinate));
            self.equal("∂(A q̇ + b)/∂q", &group.combined(&found, rows), &expected)?;
        }
        Ok(())
    }

    /// The wrenches at joints hold the auxiliary coordinates of the joints at zero, whatever the multipliers are.
    fn reactions(&self) -> Result<(), Failure> {
        let Some(released) = &self.witness.released else { return Ok(()) };
        let multipliers = self.multipliers();
        let functions = self.derivation.functions.iter().filter(|f| f.kind.reaction().is_some());
        let found: Vec<V> =
            functions.flat_map(|f| self.interpreter.evaluate_with(f, self.state, &multipliers)).collect();
        let (n, state) = (self.n(), with_resting(self.state, found.len()));
        for group in Group::of(found.len()) {
            let direction = |i: usize| group.weight_of(Symbol::Coordinate(i as u32), Symbol::Coordinate);
            let direction = |i: usize| i.checked_sub(n).map_or(V::default(), direction);
            let expected = released.holding_force(direction, &state, self.parameters, &multipliers);
            self.equal("reactions", &group.combined(&found, 1), &[expected])?;
        }
        Ok(())
    }
}

impl Trial<'_> {
    /// Whether the energies are finite at another state.
    pub(crate) fn is_finite_at(&self, state: &State<Rounded>) -> bool {
        self.witness.is_finite(state, self.parameters)
    }
}

/// The results of a function, which the mechanism has.
pub(super) fn called<V: Value>(interpreter: &Interpreter<'_, V>, kind: FunctionKind, state: &State<V>) -> Vec<V> {
    interpreter.call(kind, state).unwrap_or_else(|| panic!("there is no function `{}`", kind.name()))
}

/// Whether a matrix is orthonormal, and remains so.
pub(super) fn is_rotation<V: Tested>(r: &[Dual<V>]) -> bool {
    let product =
        |i: usize, j: usize| (0..3).fold(Dual::fixed(V::default()), |sum, k| sum.add(r[3 * k + i].mul(r[3 * k + j])));
    (0..9).all(|k| {
        let (entry, unit) = (product(k / 3, k % 3), one_if::<V>(k / 3 == k % 3));
        (entry.value - unit).vanishes() && entry.derivative.vanishes()
    })
}

/// 1 where it holds, else 0.
pub(super) fn one_if<V: Tested>(holds: bool) -> V {
    V::exact(f64::from(u8::from(holds)))
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
