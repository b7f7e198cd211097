//! A derivation, interpreted in process, against the algorithms for trees of bodies.

use mbs_derive::expr::Dual;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::numeric::eliminate;
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_tests::compare::error;
use mbs_tests::random::{Posture, Random, onto_the_sphere};
use mbs_tests::reference::tree::Tree;

/// Relative to the largest entry: thousands of operations, each to 1e-16.
const TOLERANCE: f64 = 1e-9;

/// A derivation, the same mechanism as a tree, and what ties them together.
pub(crate) struct Pair<'a> {
    /// What is judged.
    pub(crate) derivation: &'a Derivation,
    /// Parameters, flattened in declaration order.
    pub(crate) parameters: Vec<f64>,
    /// What judges, for the same parameters.
    pub(crate) tree: Tree,
    /// Signals that the declaration has as formulas of t, which come after those given at run time: values and
    /// derivatives.
    pub(crate) formulas: &'a dyn Fn(f64) -> Vec<[f64; 3]>,
    /// The generalized forces of inputs at `x`.
    pub(crate) force: Force<'a>,
}

/// The generalized force at variables `x` under inputs `u`.
pub(crate) type Force<'a> = &'a dyn Fn(&[f64], &[f64]) -> Vec<f64>;

/// A state of both sides.
struct Moment {
    state: State,
    /// Variables of the tree, and their first and second derivatives.
    x: [Vec<f64>; 3],
}

impl Pair<'_> {
    /// All functions at `count` states that walk through every posture.
    ///
    /// The error names the function and the state.
    pub(crate) fn agrees(&self, seed: u64, count: usize) -> Result<(), String> {
        let mut random = Random::new(seed);
        for k in 0..count {
            let moment = self.moment(&mut random, Posture::ALL[k % Posture::ALL.len()], k % 7 == 6);
            self.agrees_at(&moment).map_err(|error| format!("{error}\nat {:?}", moment.state))?;
        }
        Ok(())
    }

    fn moment(&self, random: &mut Random, posture: Posture, at_rest: bool) -> Moment {
        let n = self.tree.coordinates;
        let [mut q, mut qd, mut qdd] = [(); 3].map(|()| vec![0.0; n]);
        random.fill_posture(posture, &mut q);
        random.fill(&mut qd, if at_rest { 0.0..0.0 } else { -3.0..3.0 });
        random.fill(&mut qdd, -10.0..10.0);
        self.tree.balls().for_each(|at| onto_the_sphere(&mut q[at..][..4], &mut qd[at..][..4], &mut qdd[at..][..4]));
        let t = random.uniform(-2.0..2.0);
        let formulas = (self.formulas)(t);
        let given = self.tree.signals - formulas.len();
        let prescribed: Vec<[f64; 3]> = (0..given).map(|_| random.array(-1.5..1.5)).collect();
        let inputs = self.derivation.inputs.iter().map(|input| input.count()).sum();
        let mut u = vec![0.0; inputs];
        random.fill(&mut u, -5.0..5.0);
        let variables = |order: usize, own: &[f64]| -> Vec<f64> {
            let signals = prescribed.iter().chain(&formulas).map(|signal| signal[order]);
            own.iter().copied().chain(signals).collect()
        };
        let x = [variables(0, &q), variables(1, &qd), variables(2, &qdd)];
        Moment { state: State { t, q, qd, qdd, u, prescribed }, x }
    }

    fn agrees_at(&self, Moment { state, x: [x, xd, xdd] }: &Moment) -> Result<(), String> {
        let (tree, n) = (&self.tree, self.tree.coordinates);
        let interpreter = Interpreter::with_parameters(self.derivation, self.parameters.clone());
        let call = |kind| interpreter.call(kind, state).expect("generated for every mechanism");
        let of = |kind: FunctionKind, want: &[f64]| close(kind.name(), &call(kind), want, &[]);

        let m = tree.composite_bodies(x).view((0, 0), (n, n)).into_owned();
        of(FunctionKind::MassMatrix, m.as_slice())?;
        of(FunctionKind::KineticEnergy, &[tree.kinetic_energy(x, xd)])?;
        of(FunctionKind::PotentialEnergy, &[tree.potential_energy(x)])?;

        // Along a quaternion a force does nothing but strain its constraint, and depends on how energies go on off the
        // sphere.
        let tangential = |mut force: Vec<f64>| {
            force.truncate(n);
            for at in tree.balls() {
                let along: f64 = (at..at + 4).map(|k| force[k] * x[k]).sum();
                (at..at + 4).for_each(|k| force[k] -= along * x[k]);
            }
            force
        };
        let only_signals = |rates: &[f64]| -> Vec<f64> { [&vec![0.0; n][..], &rates[n..]].concat() };
        let (driven, driven_rates) = (only_signals(xdd), only_signals(xd));
        let forces = |kind: FunctionKind, xd: &[f64], xdd: &[f64]| {
            let want = tangential(tree.newton_euler(x, xd, xdd));
            close(kind.name(), &tangential(call(kind)), &want, &[]).map(|()| want)
        };
        forces(FunctionKind::InverseDynamics, xd, xdd)?;
        let bias = forces(FunctionKind::Bias, xd, &driven)?;
        forces(FunctionKind::Gravity, &driven_rates, &driven)?;

        let (c, gravity) = (call(FunctionKind::CoriolisMatrix), call(FunctionKind::Gravity));
        let c_qd: Vec<f64> = c.chunks(n).map(|row| row.iter().zip(&state.qd).map(|(c, v)| c * v).sum()).collect();
        let sum: Vec<f64> = c_qd.iter().zip(&gravity).map(|(a, b)| a + b).collect();
        close("C q̇ + G = h", &sum, &call(FunctionKind::Bias), &[&c_qd, &gravity])?;
        if !tree.has_ball_joints() {
            close("coriolis_matrix", &c, &tree.coriolis_matrix(x, xd).concat(), &[])?;
        }
        let doubled: Vec<f64> = (0..n * n).map(|k| c[k] + c[k % n * n + k / n]).collect();
        close("Ṁ + ∂M/∂t − 2 C skew", &doubled, &self.mass_rates(state), &[&c])?;

        self.accelerations_agree(state, [x, xd, xdd], &bias, &call(FunctionKind::ForwardDynamics))?;
        let jacobian = self.inverse_dynamics_jacobian(state);
        close("inverse_dynamics_jacobian", &call(FunctionKind::InverseDynamicsJacobian), &jacobian, &[])
    }

    /// `M q̈ + h = Q` always, and `q̈` that of articulated bodies where M can be trusted.
    fn accelerations_agree(
        &self,
        state: &State,
        [x, xd, xdd]: [&[f64]; 3],
        bias: &[f64],
        found: &[f64],
    ) -> Result<(), String> {
        let tree = &self.tree;
        if !found.iter().all(|a| a.is_finite()) || smallest_pivot(tree, x) < 1e-5 {
            return Ok(());
        }
        let force = (self.force)(x, &state.u);
        if !tree.has_ball_joints() {
            let m = tree.jacobian_mass_matrix(x);
            let m_qdd: Vec<f64> =
                m[..found.len()].iter().map(|row| row.iter().zip(found).map(|(m, a)| m * a).sum()).collect();
            let left: Vec<f64> = m_qdd.iter().zip(bias).map(|(a, b)| a + b).collect();
            close("forward_dynamics: M q̈ + h = Q", &left, &force, &[&m_qdd, bias])?;
        }
        match tree.articulated_bodies(x, xd, xdd, &force) {
            Some(want) => close("forward_dynamics", found, &want, &[&force, bias]),
            None => Ok(()),
        }
    }

    /// `Ṁ + ∂M/∂t` by running the program of M on dual numbers. Rows.
    fn mass_rates(&self, state: &State) -> Vec<f64> {
        let rates = |values: &[f64], rates: &[f64]| -> Vec<Dual<f64>> {
            values.iter().zip(rates).map(|(value, rate)| Dual::new(*value, *rate)).collect()
        };
        let along = |qd: &[f64]| {
            let q = rates(&state.q, qd);
            let signal = |[value, rate, acceleration]: &[f64; 3]| {
                [Dual::new(*value, *rate), Dual::new(*rate, *acceleration), Dual::fixed(*acceleration)]
            };
            let prescribed = state.prescribed.iter().map(signal).collect();
            let (qd, qdd, u) = (Vec::new(), Vec::new(), Vec::new());
            self.on_duals(FunctionKind::MassMatrix, &State { t: Dual::new(state.t, 1.0), q, qd, qdd, u, prescribed })
        };
        let (total, partial) = (along(&state.qd), along(&vec![0.0; state.q.len()]));
        total.iter().zip(&partial).map(|(total, partial)| total + partial).collect()
    }

    /// `[∂τ/∂q, ∂τ/∂q̇]`, each in rows, by running the program of inverse dynamics on dual numbers.
    fn inverse_dynamics_jacobian(&self, state: &State) -> Vec<f64> {
        let n = state.q.len();
        let seeded = |values: &[f64], seed: Option<usize>| -> Vec<Dual<f64>> {
            let one = |(k, value): (usize, &f64)| Dual::new(*value, if seed == Some(k) { 1.0 } else { 0.0 });
            values.iter().enumerate().map(one).collect()
        };
        let column = |in_velocity: bool, j: usize| {
            let (q, qd) = if in_velocity { (None, Some(j)) } else { (Some(j), None) };
            let at = State {
                t: Dual::fixed(state.t),
                q: seeded(&state.q, q),
                qd: seeded(&state.qd, qd),
                qdd: seeded(&state.qdd, None),
                u: Vec::new(),
                prescribed: state.prescribed.iter().map(|signal| signal.map(Dual::fixed)).collect(),
            };
            self.on_duals(FunctionKind::InverseDynamics, &at)
        };
        let block = |in_velocity: bool| {
            let columns: Vec<Vec<f64>> = (0..n).map(|j| column(in_velocity, j)).collect();
            (0..n * n).map(move |k| columns[k % n][k / n])
        };
        block(false).chain(block(true)).collect()
    }

    /// The derivatives that a function's results carry.
    fn on_duals(&self, kind: FunctionKind, state: &State<Dual<f64>>) -> Vec<f64> {
        let parameters = self.parameters.iter().map(|value| Dual::fixed(*value)).collect();
        let results = Interpreter::with_parameters(self.derivation, parameters).call(kind, state);
        results.expect("generated for every mechanism").iter().map(|result| result.derivative).collect()
    }
}

/// How well M is conditioned where nothing is special.
pub(crate) fn regularity(tree: &Tree, seed: u64) -> f64 {
    let mut random = Random::new(seed);
    let mut x = vec![0.0; tree.variables()];
    random.fill_posture(Posture::Generic, &mut x);
    for at in tree.balls() {
        let (mut rate, mut acceleration) = ([0.0; 4], [0.0; 4]);
        onto_the_sphere(&mut x[at..][..4], &mut rate, &mut acceleration);
    }
    smallest_pivot(tree, &x)
}

/// The smallest pivot of M over the coordinates, scaled to a unit diagonal; `M + q qᵀ` for quaternions, whose M says
/// nothing along q.
fn smallest_pivot(tree: &Tree, x: &[f64]) -> f64 {
    let n = tree.coordinates;
    let mut m = tree.composite_bodies(x).view((0, 0), (n, n)).into_owned();
    for at in tree.balls() {
        let size = (at..at + 4).map(|k| m[(k, k)]).fold(0.0, f64::max);
        for (i, j) in (at..at + 4).flat_map(|i| (at..at + 4).map(move |j| (i, j))) {
            m[(i, j)] += size * x[i] * x[j];
        }
    }
    eliminate(m.as_slice(), n).smallest
}

/// To [`TOLERANCE`] of the largest entry, or of the largest of the terms that were added up.
fn close(what: &str, found: &[f64], want: &[f64], terms: &[&[f64]]) -> Result<(), String> {
    let scale = terms.iter().flat_map(|terms| terms.iter()).fold(1.0, |largest: f64, term| largest.max(term.abs()));
    let scaled = |values: &[f64]| values.iter().map(|value| value / scale).collect::<Vec<_>>();
    let error = error(&scaled(found), &scaled(want));
    if error <= TOLERANCE {
        return Ok(());
    }
    Err(format!("{what}: error {error:e} > {TOLERANCE:e}\nfound: {found:?}\n want: {want:?}"))
}
