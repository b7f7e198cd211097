//! What every mechanism satisfies at random states, straight arms and exact zeros among them, in the compiled code; and
//! that the compiled code is what the interpreter runs.

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::{declared, derived};
use mbs_runtime::{Dual, Mechanism};
use mbs_tests::compare::error;
use mbs_tests::mechanisms as written;
use mbs_tests::random::{Random, State, states};

macro_rules! check {
    ($source:ident, $($module:ident $name:ident $n:literal $u:literal;)*) => {$(
        mod $module {
            use super::*;
            use $source::$module::$name;

            #[test]
            fn equations_fit_together() {
                identities::<$n, $u>(stringify!($module), &$name::default());
            }

            #[test]
            fn derivatives_are_those_of_dual_numbers() {
                derivatives::<$n, $u>(stringify!($module), &$name::default(), &$name::default());
            }

            #[test]
            fn compiled_code_is_what_the_interpreter_runs() {
                compiled_is_interpreted::<$n, $u>(stringify!($module), &$name::default());
            }
        }
    )*};
}
macro_rules! check_models {
    ($($mechanism:tt)*) => { check!(mbs_models, $($mechanism)*); };
}
macro_rules! check_written {
    ($($mechanism:tt)*) => { check!(written, $($mechanism)*); };
}
mbs_models::for_each_mechanism!(check_models);
mbs_tests::for_each_mechanism!(check_written);
check!(mbs_models, marine_platform MarinePlatform 4 10;);

/// States at which the potential is finite, which of those of a mechanism are nearly all: bodies that attract each
/// other do not meet.
fn regular_states<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64>,
    seed: u64,
    count: usize,
) -> Vec<State<N>> {
    let mut states = states(seed, count);
    states.retain(|state| mechanism.potential_energy(0.7, &state.q).is_finite());
    assert!(2 * states.len() > count, "{}", states.len());
    states
}

/// `M` symmetric and positive semidefinite, `p − p(0) = M q̇`, `T(q̇) + T(−q̇) − 2 T(0) = q̇ᵀ M q̇`, `C q̇ + G = h`,
/// `M q̈ + h + ∂D/∂q̇ = τ`, and at the accelerations of forward dynamics `τ = Q + Aᵀλ` and `A q̈ + γ = 0`.
fn identities<const N: usize, const U: usize>(module: &str, mechanism: &impl Mechanism<N, U, Scalar = f64>) {
    let derivation = derivation_of(module);
    let constraints = Constraints(Interpreter::new(&derivation));
    let mut random = Random::new(7);
    for State { q, qd, qdd } in regular_states(mechanism, 1, 60) {
        let (t, u) = (0.7, random.array::<U>(-5.0..5.0));
        let m = mechanism.mass_matrix(t, &q);
        for i in 0..N {
            for j in 0..i {
                assert_eq!(m[i][j].to_bits(), m[j][i].to_bits(), "M is symmetric to the bit");
            }
            assert!(m[i][i] >= 0.0);
        }
        let smallest = mbs_derive::numeric::eliminate(&m.concat(), N).smallest;
        assert!(smallest >= -1e-12, "M is positive semidefinite: {smallest:e} at {q:?}");
        let m_qd = times(&m, &qd);
        let at_rest = mechanism.momentum(t, &q, &[0.0; N]);
        close("p = p(0) + M q̇", &mechanism.momentum(t, &q, &qd), &sum(&m_qd, &at_rest), &[&m_qd, &at_rest]);
        let energies = [qd, qd.map(|rate| -rate), [0.0; N]].map(|qd| mechanism.kinetic_energy(t, &q, &qd));
        let form: f64 = qd.iter().zip(&m_qd).map(|(a, b)| a * b).sum();
        close("2 T₂ = q̇ᵀ M q̇", &[energies[0] + energies[1] - 2.0 * energies[2]], &[form], &[&energies]);
        let h = mechanism.bias(t, &q, &qd);
        let g = mechanism.gravity(t, &q);
        let c_qd = times(&mechanism.coriolis_matrix(t, &q, &qd), &qd);
        close("C q̇ + G = h", &sum(&c_qd, &g), &h, &[&c_qd, &g]);

        let d = mechanism.dissipation_force(t, &q, &qd);
        let tau = mechanism.inverse_dynamics(t, &q, &qd, &qdd);
        let m_qdd = times(&m, &qdd);
        close("M q̈ + h + ∂D/∂q̇ = τ", &sum(&sum(&m_qdd, &h), &d), &tau, &[&m_qdd, &h]);

        let at = constraints.at(t, &q, &qd, &u);
        let accelerations = mechanism.forward_dynamics(t, &q, &qd, &u);
        if accelerations.iter().all(|a| a.is_finite()) && well_conditioned(&m) && at.independent() {
            let (force, reaction) = (mechanism.generalized_force(t, &q, &qd, &u), at.force());
            let back = mechanism.inverse_dynamics(t, &q, &qd, &accelerations);
            let m_qdd = times(&m, &accelerations);
            close("inverse of forward dynamics: Q + Aᵀλ", &back, &sum(&force, &reaction), &[&m_qdd, &h, &reaction]);
            for (row, gamma) in at.rows.iter().zip(&at.bias) {
                let terms: [f64; N] = std::array::from_fn(|i| row[i] * accelerations[i]);
                close("A q̈ + γ = 0", &[terms.iter().sum::<f64>() + gamma], &[0.0], &[&terms, &[*gamma]]);
            }
        }
    }
}

/// `linearize` and `inverse_dynamics_jacobian` against the same generated code run on dual numbers.
fn derivatives<const N: usize, const U: usize>(
    module: &str,
    mechanism: &impl Mechanism<N, U, Scalar = f64>,
    dual: &impl Mechanism<N, U, Scalar = Dual<f64>>,
) {
    let derivation = derivation_of(module);
    let constraints = Constraints(Interpreter::new(&derivation));
    let mut random = Random::new(11);
    for State { q, qd, qdd } in regular_states(mechanism, 2, 12) {
        let (t, u) = (0.7, random.array::<U>(-5.0..5.0));
        let fixed = |x: f64| Dual::constant(x);
        let at = constraints.at(t, &q, &qd, &u);
        skewness_and_balance(mechanism, dual, &State { q, qd, qdd }, &u, &at);
        let jacobian = mechanism.inverse_dynamics_jacobian(t, &q, &qd, &qdd);
        let linearization = mechanism.linearize(t, &q, &qd, &u);
        // Terms as large as q̈ add up to its derivatives: ∂q̈/∂x holds M⁻¹ ∂M/∂x q̈.
        let accelerations = mechanism.forward_dynamics(t, &q, &qd, &u);
        let regular = well_conditioned(&mechanism.mass_matrix(t, &q)) && at.independent();
        for j in 0..N {
            for (of_tau, of_qdd, in_velocity) in
                [(&jacobian.q, &linearization.q, false), (&jacobian.qd, &linearization.qd, true)]
            {
                let (mut dq, mut dqd) = (q.map(fixed), qd.map(fixed));
                if in_velocity {
                    dqd[j].derivative = 1.0
                } else {
                    dq[j].derivative = 1.0
                }
                let tau = dual.inverse_dynamics(fixed(t), &dq, &dqd, &qdd.map(fixed)).map(|x| x.derivative);
                close("∂τ/∂x", &of_tau.map(|row| row[j]), &tau, &[&of_tau.concat()]);
                if regular {
                    let qdd = dual.forward_dynamics(fixed(t), &dq, &dqd, &u.map(fixed)).map(|x| x.derivative);
                    close("∂q̈/∂x", &of_qdd.map(|row| row[j]), &qdd, &[&of_qdd.concat(), &accelerations]);
                }
            }
        }
        for j in 0..U {
            let mut du = u.map(fixed);
            du[j].derivative = 1.0;
            let qdd = dual.forward_dynamics(fixed(t), &q.map(fixed), &qd.map(fixed), &du).map(|x| x.derivative);
            if regular {
                close("∂q̈/∂u", &linearization.u.map(|row| row[j]), &qdd, &[&linearization.u.concat()]);
            }
        }
    }
}

/// `Ṁ + ∂M/∂t − 2 C` skew-symmetric and `d/dt (T₂ − T₀ + V) = q̇·(Q − ∂D/∂q̇ + Aᵀλ) − ∂L/∂t`. Terms of L beside T and V
/// are linear in the velocities and free of t in all mechanisms here: they do not enter.
fn skewness_and_balance<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64>,
    dual: &impl Mechanism<N, U, Scalar = Dual<f64>>,
    State { q, qd, .. }: &State<N>,
    u: &[f64; U],
    constraints: &Rows<N>,
) {
    let t = 0.7;
    let now = Dual::variable(t);
    let along = |x: &[f64; N], rate: &[f64; N]| -> [Dual<f64>; N] {
        std::array::from_fn(|i| Dual { value: x[i], derivative: rate[i] })
    };
    let c = mechanism.coriolis_matrix(t, q, qd);
    let [total, explicit] =
        [*qd, [0.0; N]].map(|rate| dual.mass_matrix(now, &along(q, &rate)).map(|row| row.map(|x| x.derivative)));
    for i in 0..N {
        let sums: [f64; N] = std::array::from_fn(|j| c[i][j] + c[j][i]);
        close("Ṁ + ∂M/∂t − 2 C skew", &sums, &sum(&total[i], &explicit[i]), &[&c.concat()]);
    }
    if well_conditioned(&mechanism.mass_matrix(t, q)) && constraints.independent() {
        let qdd = mechanism.forward_dynamics(t, q, qd, u);
        let (q_along, qd_along) = (along(q, qd), along(qd, &qdd));
        let kinetic = |sign: f64| {
            let qd = qd_along.map(|x| Dual { value: sign * x.value, derivative: sign * x.derivative });
            dual.kinetic_energy(now, &q_along, &qd).derivative
        };
        let relative = 0.5 * (kinetic(1.0) + kinetic(-1.0)) - 2.0 * kinetic(0.0);
        let potential = dual.potential_energy(now, &q_along).derivative;
        let (q_held, qd_held) = (q.map(Dual::constant), qd.map(Dual::constant));
        let explicit = dual.kinetic_energy(now, &q_held, &qd_held) - dual.potential_energy(now, &q_held);
        let (force, damping) = (mechanism.generalized_force(t, q, qd, u), mechanism.dissipation_force(t, q, qd));
        let reaction = constraints.force();
        let power: f64 = (0..N).map(|i| qd[i] * (force[i] - damping[i] + reaction[i])).sum();
        let terms = [kinetic(1.0), kinetic(-1.0), kinetic(0.0), potential, explicit.derivative, power];
        close("energy balance", &[relative + potential], &[power - explicit.derivative], &[&terms, &reaction]);
    }
}

/// The functions of the constraints, which the trait has not.
struct Constraints<'d>(Interpreter<'d>);

/// Constraints at one state.
struct Rows<const N: usize> {
    /// A
    rows: Vec<[f64; N]>,
    /// γ
    bias: Vec<f64>,
    /// λ
    multipliers: Vec<f64>,
}

impl Constraints<'_> {
    fn at<const N: usize>(&self, t: f64, q: &[f64; N], qd: &[f64; N], u: &[f64]) -> Rows<N> {
        let [q, qd, u] = [q.as_slice(), qd, u].map(<[f64]>::to_vec);
        let state = interpret::State { t, q, qd, qdd: vec![0.0; N], u, prescribed: Vec::new() };
        let call = |kind| self.0.rows(kind, &state);
        let rows =
            call(FunctionKind::ConstraintJacobian).chunks(N).map(|row| std::array::from_fn(|i| row[i])).collect();
        Rows { rows, bias: call(FunctionKind::ConstraintBias), multipliers: call(FunctionKind::Multipliers) }
    }
}

impl<const N: usize> Rows<N> {
    /// `Aᵀλ`.
    fn force(&self) -> [f64; N] {
        std::array::from_fn(|i| self.rows.iter().zip(&self.multipliers).map(|(row, lambda)| row[i] * lambda).sum())
    }

    /// Whether no pivot of `A Aᵀ`, scaled to a unit diagonal, is below 1e-4.
    fn independent(&self) -> bool {
        let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let products: Vec<f64> = self.rows.iter().flat_map(|a| self.rows.iter().map(move |b| dot(a, b))).collect();
        mbs_derive::numeric::eliminate(&products, self.rows.len()).smallest > 1e-4
    }
}

/// Bit for bit; to 1e-12 where the target has a fused multiply–add.
fn compiled_is_interpreted<const N: usize, const U: usize>(
    module: &str,
    mechanism: &impl Mechanism<N, U, Scalar = f64>,
) {
    let derivation = derivation_of(module);
    let interpreter = Interpreter::new(&derivation);
    let mut random = Random::new(13);
    for State { q, qd, qdd } in states::<N>(3, 30) {
        let (t, u) = (0.7, random.array::<U>(-5.0..5.0));
        let state = interpret::State {
            t,
            q: q.to_vec(),
            qd: qd.to_vec(),
            qdd: qdd.to_vec(),
            u: u.to_vec(),
            prescribed: Vec::new(),
        };
        let same = |kind: FunctionKind, compiled: &[f64]| {
            let (name, interpreted) =
                (kind.name(), interpreter.call(kind, &state).expect("generated for every mechanism"));
            assert_eq!(interpreted.len(), compiled.len(), "{module}::{name}");
            for (a, b) in compiled.iter().zip(&interpreted) {
                let equal = if cfg!(target_feature = "fma") {
                    (a - b).abs() <= 1e-12 * (1.0 + interpreted.iter().fold(0.0, |s: f64, x| s.max(x.abs())))
                } else {
                    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
                };
                assert!(equal, "{module}::{name}: compiled {a:?}, interpreted {b:?} at {state:?}");
            }
        };
        same(FunctionKind::KineticEnergy, &[mechanism.kinetic_energy(t, &q, &qd)]);
        same(FunctionKind::PotentialEnergy, &[mechanism.potential_energy(t, &q)]);
        same(FunctionKind::Momentum, &mechanism.momentum(t, &q, &qd));
        same(FunctionKind::MassMatrix, &mechanism.mass_matrix(t, &q).concat());
        same(FunctionKind::CoriolisMatrix, &mechanism.coriolis_matrix(t, &q, &qd).concat());
        same(FunctionKind::Gravity, &mechanism.gravity(t, &q));
        same(FunctionKind::Bias, &mechanism.bias(t, &q, &qd));
        same(FunctionKind::DissipationForce, &mechanism.dissipation_force(t, &q, &qd));
        same(FunctionKind::GeneralizedForce, &mechanism.generalized_force(t, &q, &qd, &u));
        same(FunctionKind::InverseDynamics, &mechanism.inverse_dynamics(t, &q, &qd, &qdd));
        same(FunctionKind::ForwardDynamics, &mechanism.forward_dynamics(t, &q, &qd, &u));
        let linearization = mechanism.linearize(t, &q, &qd, &u);
        let blocks = [linearization.q.concat(), linearization.qd.concat(), linearization.u.concat()];
        same(FunctionKind::Linearize, &blocks.concat());
        let jacobian = mechanism.inverse_dynamics_jacobian(t, &q, &qd, &qdd);
        same(FunctionKind::InverseDynamicsJacobian, &[jacobian.q.concat(), jacobian.qd.concat()].concat());
    }
}

fn derivation_of(module: &str) -> Derivation {
    let apart = [("marine_platform", mbs_models::MARINE_PLATFORM)];
    let mut sources = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).chain(&apart);
    let (_, source) = sources.find(|(name, _)| *name == module).expect("a file of this name");
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).expect("a mechanism of the repository");
    derived(&lagrangian)
}

/// To 1e-10 of the largest of the terms that are added up: rounding errors of some thousand operations, and of the
/// factor 1e4 that [`well_conditioned`] allows.
#[track_caller]
fn close(what: &str, found: &[f64], expected: &[f64], terms: &[&[f64]]) {
    let scale = terms.iter().flat_map(|t| t.iter()).fold(1.0, |s: f64, x| s.max(x.abs()));
    let scaled = |values: &[f64]| values.iter().map(|x| x / scale).collect::<Vec<_>>();
    let error = error(&scaled(found), &scaled(expected));
    assert!(error <= 1e-10, "{what}: {error:e}\n{found:?}\n{expected:?}");
}

fn times<const N: usize>(m: &[[f64; N]; N], x: &[f64; N]) -> [f64; N] {
    m.map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
}

fn sum<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Whether the accelerations can be trusted: no pivot of M, scaled to a unit diagonal, is below 1e-4.
fn well_conditioned<const N: usize>(m: &[[f64; N]; N]) -> bool {
    mbs_derive::numeric::eliminate(&m.concat(), N).smallest > 1e-4
}
