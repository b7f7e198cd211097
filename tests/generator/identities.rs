//! What every mechanism satisfies at random states, straight arms and exact zeros among them, in the compiled code; and
//! that the compiled code is what the interpreter runs.

use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_runtime::{Constrained, Dual, Dynamics, Energies, Instant, Linearized, Mechanism, Scalar};
use mbs_tests::compare::error;
use mbs_tests::mechanisms as written;
use mbs_tests::random::{Random, State, states};
use mbs_tests::{derivation, source};

macro_rules! check {
    ($source:ident, $($module:ident $name:ident $n:literal $u:literal $k:tt;)*) => {$(
        mod $module {
            use super::*;
            use $source::$module::$name;

            #[test]
            fn equations_fit_together() {
                identities(&$name::default(), rows!($u $k));
            }

            #[test]
            fn derivatives_are_those_of_dual_numbers() {
                derivatives(&$name::default(), &$name::default(), rows!($u $k));
            }

            #[test]
            fn compiled_code_is_what_the_interpreter_runs() {
                compiled_is_interpreted(stringify!($module), &$name::default());
            }

            check_constraints!($module $name $k);
        }
    )*};
}
/// What those with constraints implement besides.
macro_rules! check_constraints {
    ($module:ident $name:ident 0) => {};
    ($module:ident $name:ident $k:literal) => {
        #[test]
        fn constraints_are_the_rates_of_each_other() {
            rates_of_constraints(&$name::default(), &$name::default());
        }

        #[test]
        fn compiled_constraints_are_what_the_interpreter_runs() {
            compiled_constraints_are_interpreted(stringify!($module), &$name::default());
        }
    };
}
macro_rules! rows {
    ($u:literal 0) => {
        |_, _, _, _| Rows::default()
    };
    ($u:literal $k:literal) => {
        Rows::of::<_, $u, $k>
    };
}
macro_rules! check_models {
    ($($mechanism:tt)*) => { check!(mbs_models, $($mechanism)*); };
}
macro_rules! check_written {
    ($($mechanism:tt)*) => { check!(written, $($mechanism)*); };
}
mbs_models::for_each_mechanism!(check_models);
mbs_tests::for_each_mechanism!(check_written);
check!(mbs_models, marine_platform MarinePlatform 4 10 0; assistive_arm AssistiveArm 4 7 0;);

/// Those of which only the functions of motions are generated.
macro_rules! check_motions {
    ($($module:ident $name:ident)*) => {$(
        #[test]
        fn $module() {
            use mbs_models::$module::$name;
            motions(&$name::default(), &$name::default());
        }
    )*};
}
check_motions!(irb7600_elastic Irb7600Elastic stewart_platform_elastic StewartPlatformElastic);

/// `T(q̇) = T(−q̇) ≥ 0`, which nothing moves that is declared in these, and the derivatives of the accelerations.
fn motions<const N: usize, const U: usize>(
    mechanism: &(impl Energies<N, U, Scalar = f64> + Linearized<N, U, Scalar = f64>),
    dual: &impl Dynamics<N, U, Scalar = Dual<f64>>,
) {
    let mut random = Random::new(17);
    for State { q, qd, qdd } in states(4, 6) {
        let [forth, back] = [qd, qd.map(|rate| -rate)].map(|qd| mechanism.kinetic_energy(instant(T), &q, &qd));
        assert!(forth >= 0.0);
        close("T(q̇) = T(−q̇)", &[forth], &[back], &[]);
        slopes(mechanism, dual, &State { q, qd, qdd }, &random.array::<U>(-5.0..5.0), &[0.0; N]);
    }
}

/// The time at which mechanisms are looked at.
const T: f64 = 0.7;

/// A motion that is prescribed: its value, its rate, and the rate's rate.
fn signal<S: Scalar>(t: S, number: usize) -> [S; 3] {
    let [offset, amplitude, rate] = [2.0 + number as f64, 0.4, 1.3 + 0.2 * number as f64].map(S::from_f64);
    let (sin, cos) = (rate * t).sin_cos();
    [offset + amplitude * sin, amplitude * rate * cos, -amplitude * rate * rate * sin]
}

/// A time, with the motions that are prescribed at it.
fn instant<S: Scalar, I: Instant<S>>(t: S) -> I {
    I::at(t, |number| signal(t, number))
}

/// All of them.
fn signals(count: usize) -> Vec<[f64; 3]> {
    (0..count).map(|number| signal(T, number)).collect()
}

/// States at which the potential is finite, which of those of a mechanism are nearly all: bodies that attract each
/// other do not meet.
fn regular_states<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64>,
    seed: u64,
    count: usize,
) -> Vec<State<N>> {
    let mut states = states(seed, count);
    states.retain(|state| mechanism.potential_energy(instant(T), &state.q).is_finite());
    assert!(2 * states.len() > count, "{}", states.len());
    states
}

/// `M` symmetric and positive semidefinite, `p − p(0) = M q̇`, `T(q̇) + T(−q̇) − 2 T(0) = q̇ᵀ M q̇`, `C q̇ + G = h`,
/// `M q̈ + h + ∂D/∂q̇ = τ`, and at the accelerations of forward dynamics `τ = Q + Aᵀλ` and `A q̈ + γ = 0`.
fn identities<M: Mechanism<N, U, Scalar = f64>, const N: usize, const U: usize>(
    mechanism: &M,
    rows: impl Fn(&M, &[f64; N], &[f64; N], &[f64; U]) -> Rows<N>,
) {
    let mut random = Random::new(7);
    for State { q, qd, qdd } in regular_states(mechanism, 1, 60) {
        let (t, u) = (instant(T), random.array::<U>(-5.0..5.0));
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

        let at = rows(mechanism, &q, &qd, &u);
        let accelerations = mechanism.forward_dynamics(t, &q, &qd, &u);
        if accelerations.iter().all(|a| a.is_finite()) && well_conditioned(&m) && at.independent() {
            let (force, reaction) = (mechanism.generalized_force(t, &q, &qd, &u), at.force());
            let back = mechanism.inverse_dynamics(t, &q, &qd, &accelerations);
            let m_qdd = times(&m, &accelerations);
            close(
                "inverse of forward dynamics: Q + Aᵀλ",
                &back,
                &sum(&force, &reaction),
                &[&m_qdd, &h, &reaction, &levers(&m, &accelerations)],
            );
            for (row, gamma) in at.rows.iter().zip(&at.bias) {
                let terms: [f64; N] = std::array::from_fn(|i| row[i] * accelerations[i]);
                close("A q̈ + γ = 0", &[terms.iter().sum::<f64>() + gamma], &[0.0], &[&terms, &[*gamma]]);
            }
        }
    }
}

/// `linearize` and `inverse_dynamics_jacobian` against the same generated code run on dual numbers.
fn derivatives<M: Mechanism<N, U, Scalar = f64>, const N: usize, const U: usize>(
    mechanism: &M,
    dual: &impl Mechanism<N, U, Scalar = Dual<f64>>,
    rows: impl Fn(&M, &[f64; N], &[f64; N], &[f64; U]) -> Rows<N>,
) {
    let mut random = Random::new(11);
    for State { q, qd, qdd } in regular_states(mechanism, 2, 12) {
        let (t, u) = (instant(T), random.array::<U>(-5.0..5.0));
        let fixed = |x: f64| Dual::constant(x);
        let at = rows(mechanism, &q, &qd, &u);
        skewness_and_balance(mechanism, dual, &State { q, qd, qdd }, &u, &at);
        let jacobian = mechanism.inverse_dynamics_jacobian(t, &q, &qd, &qdd);
        for j in 0..N {
            for (of_tau, in_velocity) in [(&jacobian.q, false), (&jacobian.qd, true)] {
                let (dq, dqd) = varied(&q, &qd, j, in_velocity);
                let tau = dual.inverse_dynamics(instant(fixed(T)), &dq, &dqd, &qdd.map(fixed)).map(|x| x.derivative);
                close("∂τ/∂x", &of_tau.map(|row| row[j]), &tau, &[&of_tau.concat()]);
            }
        }
        let m = mechanism.mass_matrix(t, &q);
        // Where two are nothing but rounding, so is how much of one the other one is.
        let longest = (0..N).fold(0.0, |most: f64, i| most.max(m[i][i]));
        let lost = (0..N).filter(|&i| m[i][i] < f64::EPSILON.powi(2) * longest).count();
        if well_conditioned(&m) && at.independent() && lost < 2 {
            let levers = levers(&m, &mechanism.forward_dynamics(t, &q, &qd, &u));
            slopes(mechanism, dual, &State { q, qd, qdd }, &u, &std::array::from_fn(|i| levers[i] / m[i][i]));
        }
    }
}

/// `linearize` against forward dynamics on dual numbers; `open` is what `close` lets rounding leave of levers.
fn slopes<const N: usize, const U: usize>(
    mechanism: &impl Linearized<N, U, Scalar = f64>,
    dual: &impl Dynamics<N, U, Scalar = Dual<f64>>,
    State { q, qd, .. }: &State<N>,
    u: &[f64; U],
    open: &[f64; N],
) {
    let linearization = mechanism.linearize(instant(T), q, qd, u);
    // Terms as large as q̈ add up to its derivatives: ∂q̈/∂x holds M⁻¹ ∂M/∂x q̈.
    let accelerations = mechanism.forward_dynamics(instant(T), q, qd, u);
    let now = instant(Dual::constant(T));
    for j in 0..N {
        for (of_qdd, in_velocity) in [(&linearization.q, false), (&linearization.qd, true)] {
            let (dq, dqd) = varied(q, qd, j, in_velocity);
            let qdd = dual.forward_dynamics(now, &dq, &dqd, &u.map(Dual::constant)).map(|x| x.derivative);
            close("∂q̈/∂x", &of_qdd.map(|row| row[j]), &qdd, &[&of_qdd.concat(), &accelerations, open]);
        }
    }
    for j in 0..U {
        let mut du = u.map(Dual::constant);
        du[j].derivative = 1.0;
        let qdd = dual.forward_dynamics(now, &q.map(Dual::constant), &qd.map(Dual::constant), &du);
        close("∂q̈/∂u", &linearization.u.map(|row| row[j]), &qdd.map(|x| x.derivative), &[&linearization.u.concat()]);
    }
}

/// A state in which one coordinate, or one velocity, varies.
fn varied<const N: usize>(
    q: &[f64; N],
    qd: &[f64; N],
    number: usize,
    in_velocity: bool,
) -> ([Dual<f64>; N], [Dual<f64>; N]) {
    let [mut dq, mut dqd] = [q, qd].map(|x| x.map(Dual::constant));
    if in_velocity {
        dqd[number].derivative = 1.0
    } else {
        dq[number].derivative = 1.0
    }
    (dq, dqd)
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
    let t = instant(T);
    let now = instant(Dual::variable(T));
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
        let levers = levers(&mechanism.mass_matrix(t, q), &qdd);
        let powers: [f64; N] = std::array::from_fn(|i| levers[i] * qd[i]);
        close("energy balance", &[relative + potential], &[power - explicit.derivative], &[&terms, &reaction, &powers]);
    }
}

/// Constraints at one state.
#[derive(Default)]
struct Rows<const N: usize> {
    /// A
    rows: Vec<[f64; N]>,
    /// γ
    bias: Vec<f64>,
    /// λ
    multipliers: Vec<f64>,
}

impl<const N: usize> Rows<N> {
    fn of<M: Constrained<N, U, K, Scalar = f64>, const U: usize, const K: usize>(
        mechanism: &M,
        q: &[f64; N],
        qd: &[f64; N],
        u: &[f64; U],
    ) -> Self {
        Rows {
            rows: mechanism.constraint_jacobian(instant(T), q).to_vec(),
            bias: mechanism.constraint_bias(instant(T), q, qd).to_vec(),
            multipliers: mechanism.multipliers(instant(T), q, qd, u).to_vec(),
        }
    }

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

/// `dφ/dt = A q̇ + b` of holonomic rows, the value of the others; `∂(A q̇ + b)/∂q̇ = A`; `d/dt (A q̇ + b) = A q̈ + γ`;
/// and `∂(A q̇ + b)/∂q`.
fn rates_of_constraints<M: Constrained<N, U, K, Scalar = f64>, const N: usize, const U: usize, const K: usize>(
    mechanism: &M,
    dual: &impl Constrained<N, U, K, Scalar = Dual<f64>>,
) {
    assert_eq!(M::CONSTRAINTS.len(), M::HOLONOMIC.len());
    for State { q, qd, qdd } in states::<N>(5, 12) {
        let (t, held, now) = (instant(T), instant(Dual::constant(T)), instant(Dual::variable(T)));
        let along = |x: &[f64; N], rate: &[f64; N]| -> [Dual<f64>; N] {
            std::array::from_fn(|i| Dual { value: x[i], derivative: rate[i] })
        };
        let (q_along, qd_along) = (along(&q, &qd), along(&qd, &qdd));
        let rate = mechanism.constraint_rate(t, &q, &qd);
        let value = dual.constraint(now, &q_along, &qd_along);
        let found: [f64; K] =
            std::array::from_fn(|i| if M::HOLONOMIC[i] { value[i].derivative } else { value[i].value });
        close("dφ/dt = A q̇ + b", &found, &rate, &[]);
        let a = mechanism.constraint_jacobian(t, &q);
        let terms = a.map(|row| std::array::from_fn::<f64, N, _>(|i| row[i] * qdd[i]));
        let gamma = mechanism.constraint_bias(t, &q, &qd);
        let sums: [f64; K] = std::array::from_fn(|i| terms[i].iter().sum::<f64>() + gamma[i]);
        let change = dual.constraint_rate(now, &q_along, &qd_along).map(|x| x.derivative);
        close("d/dt (A q̇ + b) = A q̈ + γ", &change, &sums, &[&terms.concat(), &gamma]);
        let of_rate = mechanism.constraint_rate_jacobian(t, &q, &qd);
        for j in 0..N {
            for (matrix, in_velocity) in [(&of_rate, false), (&a, true)] {
                let (dq, dqd) = varied(&q, &qd, j, in_velocity);
                let column = dual.constraint_rate(held, &dq, &dqd).map(|x| x.derivative);
                close("∂(A q̇ + b)/∂x", &matrix.map(|row| row[j]), &column, &[&matrix.concat()]);
            }
        }
    }
}

/// Bit for bit; to 1e-12 where the target has a fused multiply–add.
fn compiled_is_interpreted<M: Mechanism<N, U, Scalar = f64>, const N: usize, const U: usize>(
    module: &str,
    mechanism: &M,
) {
    let (derivation, mut random) = (derivation(source(mbs_models::SOURCES, module)), Random::new(13));
    for State { q, qd, qdd } in states::<N>(3, 30) {
        let (t, u) = (instant(T), random.array::<U>(-5.0..5.0));
        let same = interpreted::<M, N, U>(&derivation, [&q, &qd, &qdd], &u);
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

/// The functions of constraints are compiled to what the interpreter runs.
fn compiled_constraints_are_interpreted<M, const N: usize, const U: usize, const K: usize>(module: &str, mechanism: &M)
where
    M: Constrained<N, U, K, Scalar = f64>,
{
    let (derivation, mut random) = (derivation(source(mbs_models::SOURCES, module)), Random::new(13));
    assert_eq!(
        (M::CONSTRAINTS.map(str::to_string).to_vec(), M::HOLONOMIC.to_vec()),
        (derivation.constraints.clone(), derivation.holonomic.clone())
    );
    for State { q, qd, qdd } in states::<N>(3, 30) {
        let (t, u) = (instant(T), random.array::<U>(-5.0..5.0));
        let same = interpreted::<M, N, U>(&derivation, [&q, &qd, &qdd], &u);
        same(FunctionKind::Constraint, &mechanism.constraint(t, &q, &qd));
        same(FunctionKind::ConstraintRate, &mechanism.constraint_rate(t, &q, &qd));
        same(FunctionKind::ConstraintRateJacobian, &mechanism.constraint_rate_jacobian(t, &q, &qd).concat());
        same(FunctionKind::ConstraintJacobian, &mechanism.constraint_jacobian(t, &q).concat());
        same(FunctionKind::ConstraintBias, &mechanism.constraint_bias(t, &q, &qd));
        same(FunctionKind::Multipliers, &mechanism.multipliers(t, &q, &qd, &u));
    }
}

/// Asserts that a function is interpreted to the values that it is compiled to.
fn interpreted<'d, M: Dynamics<N, U, Scalar = f64>, const N: usize, const U: usize>(
    derivation: &'d Derivation,
    [q, qd, qdd]: [&[f64; N]; 3],
    u: &[f64; U],
) -> impl Fn(FunctionKind, &[f64]) + use<'d, M, N, U> {
    let interpreter = Interpreter::new(derivation);
    let [q, qd, qdd] = [q, qd, qdd].map(|x| x.to_vec());
    let state = interpret::State { t: T, q, qd, qdd, u: u.to_vec(), prescribed: signals(M::Time::SIGNALS) };
    move |kind, compiled| {
        let name = format!("{}::{}", derivation.name, kind.name());
        let interpreted = interpreter.call(kind, &state).expect("generated for every such mechanism");
        assert_eq!(interpreted.len(), compiled.len(), "{name}");
        for (a, b) in compiled.iter().zip(&interpreted) {
            let equal = if cfg!(target_feature = "fma") {
                (a - b).abs() <= 1e-12 * (1.0 + interpreted.iter().fold(0.0, |s: f64, x| s.max(x.abs())))
            } else {
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
            };
            assert!(equal, "{name}: compiled {a:?}, interpreted {b:?} at {state:?}");
        }
    }
}

/// Of the largest term: what two sides may differ by.
const LIMIT: f64 = 1e-10;

/// To 1e-10 of the largest of the terms that are added up: rounding errors of some thousand operations, and of the
/// factor 1e4 that [`well_conditioned`] allows.
#[track_caller]
fn close(what: &str, found: &[f64], expected: &[f64], terms: &[&[f64]]) {
    let scale = terms.iter().flat_map(|t| t.iter()).fold(1.0, |s: f64, x| s.max(x.abs()));
    let scaled = |values: &[f64]| values.iter().map(|x| x / scale).collect::<Vec<_>>();
    let error = error(&scaled(found), &scaled(expected));
    assert!(error <= LIMIT, "{what}: {error:e}\n{found:?}\n{expected:?}");
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

/// What `close` lets rounding leave of `M q̈`: a lever is known to a rounding error of the longest one, and so are
/// moments `m r² q̈` to four of `√(Mᵢᵢ Mₘₐₓ) q̈ᵢ`: all of them about the upright, of an arm that points along it.
fn levers<const N: usize>(m: &[[f64; N]; N], accelerations: &[f64; N]) -> [f64; N] {
    let longest = (0..N).fold(0.0, |most: f64, i| most.max(m[i][i]));
    std::array::from_fn(|i| 4.0 * f64::EPSILON / LIMIT * (m[i][i] * longest).sqrt() * accelerations[i])
}
