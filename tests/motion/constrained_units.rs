//! Units of mass, length and time do not matter to constrained dynamics: every mechanism of the repository with
//! constraints, and some that are ill-scaled on purpose, with each declared quantity in other units, by powers of two
//! up to 2^±50 each. All operations but those of the solution are then the same but for exponents; the solution must
//! be, too.

use mbs_derive::expr::{Graph, Number, Terms, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, FunctionKind, Operations, ResultPart, Shape};
use mbs_derive::variable::Variable;
use mbs_derive::{declared, derived};
use mbs_runtime::{constrained_slopes, constrained_solve, constrained_solve_many};
use mbs_tests::counting::{Counted, counted};
use mbs_tests::random::Random;

/// A body so small that its inertia is beyond rounding of one: its attitude is a unit quaternion.
const MICRO: &str = "mechanism Micro {
    param inertia_scale: kg*m^2 = 1e-18; param m: kg = 1e-9;
    coord e[4]: 1;
    input torque_in[3]: N*m;
    let body = quaternion(e[0], e[1], e[2], e[3]);
    kinetic += rigid_body(m, [0, 0, 0], inertia(2, 3, 4.5, 0.1, 0.2, -0.3)*inertia_scale, body);
    torque on body += body*torque_in;
    constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;
}";

/// A body of 1 mg and 1 mm at the end of a thread.
const BEAD: &str = "mechanism Bead {
    param m: kg = 1e-6; param r: m = 1e-3; param l: m = 0.02; param g: m/s^2 = 9.81;
    coord p[3]: m; coord e[4]: 1;
    let body = translation(p) * quaternion(e[0], e[1], e[2], e[3]);
    kinetic += rigid_body(m, [0, 0, 0], diag(0.4, 0.5, 0.6)*m*r^2, body);
    potential += m*g*p[2];
    let hook = body.point([0, 0, r]);
    constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;
    constraint thread: hook.x^2 + hook.y^2 + hook.z^2 = l^2;
}";

/// A mass in polar coordinates that a rod of its own coordinate, without inertia, holds at an angle.
const ROD: &str = "mechanism Rod {
    param m: kg = 2; param k: N/m = 30; param l: m = 0.5; param rate: 1/s = 3;
    coord r: m; coord phi: rad; coord s: m;
    input f: N;
    kinetic += 1/2*m*(dt(r)^2 + r^2*dt(phi)^2);
    potential += 1/2*k*s^2;
    force r += f;
    constraint held: dt(phi) = rate;
    constraint rod: s = l*sin(phi) - r;
}";

/// Powers of two, of mass, length and time.
#[derive(Clone, Copy, Debug)]
struct Units([i32; 3]);

impl Units {
    fn random(random: &mut Random) -> Self {
        Units([0; 3].map(|_: i32| random.uniform(-50.0..51.0).floor() as i32))
    }

    /// By how much a number grows that has these exponents of kg, m, s.
    fn factor(self, exponents: [i32; 3]) -> f64 {
        2f64.powi(self.0.iter().zip(exponents).map(|(unit, exponent)| unit * exponent).sum())
    }

    fn of(self, unit: &str) -> f64 {
        self.factor(exponents(unit))
    }

    /// Of each component of some variables.
    fn all(self, variables: &[Variable]) -> Vec<f64> {
        variables.iter().flat_map(|v| vec![self.of(&v.unit); v.count()]).collect()
    }
}

/// Exponents of kg, m and s of a unit as written.
fn exponents(unit: &str) -> [i32; 3] {
    let (mut sum, mut sign) = ([0; 3], 1);
    let mut rest = unit;
    while !rest.is_empty() {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let (name, power) = rest[..end].split_once('^').unwrap_or((&rest[..end], "1"));
        let base = match name.trim() {
            "kg" => [1, 0, 0],
            "m" => [0, 1, 0],
            "s" => [0, 0, 1],
            "N" => [1, 1, -2],
            "J" => [1, 2, -2],
            "rad" | "1" | "" => [0; 3],
            other => panic!("what is {other}, in {unit}?"),
        };
        let power: i32 = power.parse().expect("an integer");
        (0..3).for_each(|i| sum[i] += sign * power * base[i]);
        sign = if rest[end..].starts_with('/') { -1 } else { 1 };
        rest = rest.get(end + 1..).unwrap_or("");
    }
    sum
}

/// What is compared, each number with the factor that units give it.
fn results(derivation: &Derivation, units: Units, state: &State, parameters: &[f64]) -> Vec<(String, Vec<f64>)> {
    let second = units.factor([0, 0, 1]);
    let [q, u, p] = [&derivation.coordinates, &derivation.inputs, &derivation.parameters].map(|all| units.all(all));
    let n = q.len();
    let times = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).collect::<Vec<f64>>();
    let signals = units.all(&derivation.prescribed);
    let scaled = State {
        t: state.t * second,
        q: times(&state.q, &q),
        qd: times(&state.qd, &q).iter().map(|x| x / second).collect(),
        u: times(&state.u, &u),
        qdd: Vec::new(),
        prescribed: state
            .prescribed
            .iter()
            .zip(&signals)
            .map(|([a, b, c], s)| [a * s, b * s / second, c * s / second / second])
            .collect(),
    };
    let interpreter = Interpreter::with_parameters(derivation, times(parameters, &p));
    let call = |kind| interpreter.call(kind, &scaled).expect("generated for this mechanism");
    let acceleration = |i: usize| second * second / q[i];
    // By columns of these factors.
    let matrix = |values: &[f64], columns: &[f64], time: f64| -> Vec<f64> {
        let entry = |(at, &x): (usize, &f64)| x * acceleration(at / columns.len()) * columns[at % columns.len()] / time;
        values.iter().enumerate().map(entry).collect()
    };
    let (a, linear, energy) = (call(FunctionKind::ConstraintJacobian), call(FunctionKind::Linearize), units.of("J"));
    let reactions = call(FunctionKind::Multipliers)
        .into_iter()
        .zip(a.chunks(n))
        .map(|(l, row)| (0..n).map(|i| l * row[i] * q[i] / energy).collect::<Vec<f64>>());
    let rates: Vec<f64> = q.clone();
    vec![
        (
            "accelerations".to_string(),
            call(FunctionKind::ForwardDynamics).iter().enumerate().map(|(i, x)| x * acceleration(i)).collect(),
        ),
        ("reactions, row by row".to_string(), reactions.flatten().collect()),
        ("slopes in q".to_string(), matrix(&linear[..n * n], &q, 1.0)),
        ("slopes in q̇".to_string(), matrix(&linear[n * n..2 * n * n], &rates, second)),
        ("slopes in u".to_string(), if u.is_empty() { Vec::new() } else { matrix(&linear[2 * n * n..], &u, 1.0) }),
        (
            "slopes in the parameters".to_string(),
            if p.is_empty() { Vec::new() } else { matrix(&call(FunctionKind::LinearizeParameters), &p, 1.0) },
        ),
    ]
}

/// Every mechanism of the repository with constraints and units, and those above.
fn constrained() -> Vec<(&'static str, &'static str)> {
    let sources = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).copied();
    let chosen =
        sources.filter(|(_, source)| source.contains("\n    constraint ") && !source.contains("#![dimensionless]"));
    let loops = include_str!("../platform/stewart_platform_loops.mbs");
    chosen.chain([("micro", MICRO), ("bead", BEAD), ("rod", ROD), ("stewart_platform_loops", loops)]).collect()
}

#[test]
fn units_change_exponents_only() {
    for (module, source) in constrained() {
        let graph = Graph::verbatim();
        let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render(module, source)));
        let derivation = derived(&lagrangian);
        let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults);
        let parameters: Vec<f64> = defaults.copied().map(Number::to_f64).collect();
        let mut random = Random::new(11);
        let mut finite = 0;
        for _ in 0..6 {
            let mut numbers = |count: usize| {
                let mut values = vec![0.0; count];
                random.fill(&mut values, -1.5..1.5);
                values
            };
            let n = derivation.dof();
            let inputs = derivation.inputs.iter().map(Variable::count).sum();
            let (q, qd, u) = (numbers(n), numbers(n), numbers(inputs));
            let prescribed = vec![[0.4, -0.7, 1.3]; derivation.prescribed.iter().map(Variable::count).sum()];
            let state = State { t: 0.6, q, qd, qdd: Vec::new(), u, prescribed };
            let expected = results(&derivation, Units([0; 3]), &state, &parameters);
            finite += usize::from(expected[0].1.iter().all(|x| x.is_finite()));
            for _ in 0..4 {
                let units = Units::random(&mut random);
                for ((what, found), (_, expected)) in
                    results(&derivation, units, &state, &parameters).iter().zip(&expected)
                {
                    let bits =
                        |x: &[f64]| x.iter().map(|x| if x.is_nan() { None } else { Some(x + 0.0) }).collect::<Vec<_>>();
                    assert_eq!(bits(found), bits(expected), "{module}: {what} in {units:?} at {state:?}");
                }
            }
        }
        assert!(finite >= 3, "{module}: accelerations at {finite} states");
    }
}

/// Where the masses of 1e-18 kg m² and the inertia of one turn alike.
#[test]
fn a_body_turns_alike_at_every_size() {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(MICRO, &graph, &[]).unwrap();
    let derivation = derived(&lagrangian);
    let e = [0.5, -0.1, 0.7, 0.5];
    let at = |size: f64| {
        let state = State {
            q: e.to_vec(),
            qd: vec![0.3, 0.2, -0.1, -0.12],
            u: [0.3, -0.2, 0.9].map(|torque| torque * size).to_vec(),
            ..State::default()
        };
        Interpreter::with_parameters(&derivation, vec![size, 1e-9]).call(FunctionKind::ForwardDynamics, &state).unwrap()
    };
    let expected = at(1.0);
    for size in [1e-18, 1e-15, 1e-9, 1e3, 1e8, 1e12, 1e18] {
        for (found, expected) in at(size).iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-14, "{size:e}: {found} for {expected}");
        }
    }
}

/// Two coordinates that turn about one axis where a = 0; the constraint leaves no motion without inertia.
const SING: &str = "#![dimensionless]
mechanism Sing {
    coord a: rad; coord b: rad; coord c: rad;
    input u: N;
    kinetic += 1/2*1.1*(0.7*dt(a) + 0.3*dt(b))^2 + 1/2*sin(a)^2*dt(b)^2 + 1/2*dt(c)^2;
    force a += u;
    force c += 1;
    constraint k: 2*b + 3*c = 1;
}";

#[test]
fn inertia_may_fade_where_a_constraint_holds() {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(SING, &graph, &[]).unwrap();
    let derivation = derived(&lagrangian);
    let interpreter = Interpreter::new(&derivation);
    for a in [0.0, 1e-200, 1e-12, 1e-9, 1e-8, 1e-5] {
        let state = State { q: vec![a, 0.5, 0.0], qd: vec![0.0; 3], u: vec![1.0], ..State::default() };
        // c̈ = x, b̈ = −3x/2; 0.539 ä + 0.231 b̈ = 1, and along the row 9/4·(0.231/1.5 … ) as eliminated by hand, sin a
        // ≈ 0: −3/2·(0.231 ä + 0.099 b̈) + x = 1.
        let (maa, mab, mbb) = (1.1 * 0.49, 1.1 * 0.21, 1.1 * 0.09 + f64::sin(a).powi(2));
        // ä = (1 + 1.5 mab x)/maa
        let x = (1.0 + 1.5 * mab / maa) / (1.0 + 2.25 * (mbb - mab * mab / maa));
        let expected = [(1.0 + 1.5 * mab * x) / maa, -1.5 * x, x];
        let found = interpreter.call(FunctionKind::ForwardDynamics, &state).unwrap();
        let slopes = interpreter.call(FunctionKind::Linearize, &state).unwrap();
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-14, "{a:e}: {found} for {expected}");
        }
        assert!(slopes.iter().all(|x| x.is_finite()), "{a:e}: {slopes:?}");
        // ∂q̈/∂u: the same equations with 1 and no other force.
        let by_input = 1.5 * mab / maa / (1.0 + 2.25 * (mbb - mab * mab / maa));
        assert!((slopes[20] - by_input).abs() < 1e-14, "{a:e}: {} for {by_input}", slopes[20]);
    }
}

/// What a solution of independent rows without zeros does, against the formula that `mbs ops` counts it by.
fn costs_what_is_said<const N: usize, const K: usize, const C: usize>(random: &mut Random) {
    let mut number = || Counted(random.uniform(0.5..1.5));
    let b: [[Counted; N]; N] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
    let m = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            Counted((0..N).map(|k| b[i][k].0 * b[j][k].0).sum::<f64>() + f64::from(u8::from(i == j)))
        })
    });
    let a: [[Counted; N]; K] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
    let force: [[Counted; C]; N] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
    let target: [[Counted; C]; K] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
    let ((q, _), counts) = counted(|| constrained_solve_many(m, a, force, target));
    assert!(q.as_flattened().iter().all(|q| q.0.is_finite()));
    let expected = Operations::of_constrained_solve([N, K], &[ResultPart { name: "", shape: Shape::Matrix(N, C) }]);
    assert_eq!([counts.add, counts.mul, counts.div], [expected.add, expected.mul, expected.div], "{N} {K} {C}");
}

#[test]
fn operations_are_counted_as_they_are_done() {
    let mut random = Random::new(3);
    costs_what_is_said::<1, 1, 1>(&mut random);
    costs_what_is_said::<3, 2, 1>(&mut random);
    costs_what_is_said::<3, 3, 2>(&mut random);
    costs_what_is_said::<4, 0, 1>(&mut random);
    costs_what_is_said::<7, 1, 14>(&mut random);
    costs_what_is_said::<8, 5, 3>(&mut random);
    costs_what_is_said::<12, 7, 2>(&mut random);
}

/// The interpreter's solution and the runtime's, of systems of any rank and scale.
fn same_bits<const N: usize, const K: usize>(random: &mut Random) {
    for round in 0..200 {
        let mut number = |zeros: u64| {
            let (size, zero) = (random.uniform(-40.0..40.0), random.one_in(zeros));
            if zero { 0.0 } else { random.uniform(-1.5..1.5) * size.floor().exp2() }
        };
        let scale: [f64; N] = std::array::from_fn(|_| number(5).abs());
        let b: [[f64; N]; N] =
            std::array::from_fn(|_| std::array::from_fn(|i| (number(3) * 1e-12).clamp(-2.0, 2.0) * scale[i]));
        let m: [[f64; N]; N] =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| b[k][i] * b[k][j]).sum::<f64>()));
        let mut a: [[f64; N]; K] = std::array::from_fn(|_| std::array::from_fn(|i| number(2) * scale[i]));
        let (f, mut c): ([f64; N], [f64; K]) = (std::array::from_fn(|_| number(4)), std::array::from_fn(|_| number(4)));
        if K > 1 && round % 3 == 0 {
            (a[K - 1], c[K - 1]) = (a[0].map(|x| -3.0 * x), -3.0 * c[0]);
        }
        // A component that nearly vanishes beside another of its vector.
        if K > 1 && round % 3 == 1 {
            let small = [1e-9, 1e-18, 0.0][round / 3 % 3];
            (a[1], c[1]) = (a[0].map(|x| small * x * (1.0 + 1e-9 * number(0))), small * c[0]);
        }
        let (q, l) = constrained_solve(m, a, f, c);
        let triangle: Vec<f64> = (0..N).flat_map(|i| m[i][..=i].to_vec()).collect();
        let column: Vec<f64> = f.into_iter().chain(c).collect();
        let found =
            <f64 as Value>::constrained(N, triangle.clone(), a.concat(), &std::array::from_fn::<_, K, _>(|k| k))(
                &column,
            );
        let bits = |x: &f64| if x.is_nan() { None } else { Some(x.to_bits()) };
        let expected: Vec<_> = q.iter().chain(&l).map(bits).collect();
        assert_eq!(found.iter().map(bits).collect::<Vec<_>>(), expected, "{N} {K}: M = {m:?}, A = {a:?}, {f:?}, {c:?}");

        // Columns that are derivatives, of which one is rounding and may be a contradiction.
        let noise = |x: f64| x * [1e-17, 1e-9, 1e-6][round % 3];
        let (force, target) = (f.map(|f| [f, noise(f), 0.0]), c.map(|c| [c, noise(c) + noise(1.0), noise(scale[0])]));
        let sizes: [f64; 3] = std::array::from_fn(|_| number(4));
        let vectors: [usize; K] = std::array::from_fn(|k| k / 2);
        let slopes = constrained_slopes(m, a, force, target, vectors, &q, sizes);
        let columns: Vec<Vec<f64>> =
            (0..3).map(|j| force.iter().map(|f| f[j]).chain(target.iter().map(|c| c[j])).collect()).collect();
        let terms = Terms { sizes: Vec::new(), motion: q.to_vec(), scales: sizes.to_vec() };
        let found = <f64 as Value>::constrained_columns(N, triangle, a.concat(), &vectors)(&columns, &terms);
        for (j, column) in found.iter().enumerate() {
            let expected: Vec<_> = slopes.iter().map(|row| bits(&row[j])).collect();
            let found: Vec<_> = column[..N].iter().map(bits).collect();
            assert_eq!(found, expected, "{N} {K} {j}: M = {m:?}, A = {a:?}, {force:?}, {target:?}, {q:?}, {sizes:?}");
        }
    }
}

#[test]
fn in_process_and_compiled_are_the_same_bits() {
    let mut random = Random::new(17);
    same_bits::<1, 1>(&mut random);
    same_bits::<2, 2>(&mut random);
    same_bits::<3, 2>(&mut random);
    same_bits::<4, 6>(&mut random);
    same_bits::<7, 1>(&mut random);
    same_bits::<8, 5>(&mut random);
}
