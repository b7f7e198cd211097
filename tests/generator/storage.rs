//! Results of more than 64 kB: written to storage of the caller, on a stack that does not hold them.

use super::rope::run;

/// Masses on springs between neighbours: M, and accelerations' derivatives, by formulas typed by hand.
const ROW: &str = "
include!(\"row.rs\");

use mbs_runtime::{Linearization, Linearized};
use row::Row;

const N: usize = 100;

fn boxed<V: Copy>(value: V) -> Box<[V; N]> {
    vec![value; N].try_into().ok().unwrap()
}

fn off() -> f64 {
    let row = Row::<f64>::default();
    let q: [f64; N] = std::array::from_fn(|i| (i as f64).sin());
    let mut mass = boxed([f64::NAN; N]);
    row.mass_matrix(&q, &mut mass);
    let mut off: f64 = 0.0;
    for i in 0..N {
        for j in 0..N {
            // T = Σ m (ẋᵢ + ẋᵢ₋₁)²/2 with ẋ₋₁ = 0.
            let expected = match i.abs_diff(j) {
                0 if i + 1 < N => 0.2,
                0 => 0.1,
                1 => 0.1,
                _ => 0.0,
            };
            off = f64::max(off, (mass[i][j] - expected).abs());
            assert!(mass[i][j].is_finite());
        }
    }
    off
}

fn main() {
    // Less than M, which takes 80 kB.
    let off = std::thread::Builder::new().stack_size(60 << 10).spawn(off).unwrap().join().unwrap();
    println!(\"off by {off:e}\");
    assert!(off < 1e-15);
    let (row, zeros) = (Row::<f64>::default(), [0.0; N]);
    let mut mass = boxed([f64::NAN; N]);
    row.mass_matrix(&zeros, &mut mass);
    // M ∂q̈/∂q = −K, with numbers of up to N² on the left.
    let Linearization { q: slopes, qd, .. } = Linearized::linearize(&row, 0.0, &zeros, &zeros, &[]);
    for i in 0..N {
        for j in 0..N {
            let product: f64 = (0..N).map(|k| mass[i][k] * slopes[k][j]).sum();
            let stiffness = match i.abs_diff(j) {
                0 if i == 0 || i + 1 == N => 3.0,
                0 => 6.0,
                1 => -3.0,
                _ => 0.0,
            };
            assert!((product + stiffness).abs() < 1e-9, \"{i} {j} {product}\");
            assert_eq!(qd[i][j], 0.0);
        }
    }
}
";

/// Masses in a row, neighbours 1 m apart: states are brought back by M and A.
const TRAIN: &str = "
include!(\"train.rs\");

use mbs_runtime::{Projector, State};

const N: usize = 120;

fn main() {
    let q: [f64; N] = std::array::from_fn(|i| i as f64 + 0.1 * (i as f64).sin());
    let mut state = State::new(q, [0.0; N]);
    let mut projector = Projector::new(vec![0.0; Projector::<f64, Vec<f64>>::size(N, N - 1)]);
    projector.project(&train::Train::<f64>::default(), 0.0, &mut state).unwrap();
    let off = (1..N).map(|i| (state.q[i] - state.q[i - 1] - 1.0).abs()).fold(0.0, f64::max);
    println!(\"off by {off:e}\");
    assert!(off < 1e-12);
    // Nothing pushes the whole: the centre of mass stays, of places up to N.
    let moved: f64 = state.q.iter().zip(&q).map(|(a, b)| a - b).sum();
    assert!(moved.abs() < 1e-9, \"{moved}\");
}
";

/// Rods whose lengths change in time: derivatives of accelerations against differences, both by the elimination, and
/// inverse dynamics' against the accelerations; states on the rods.
const RODS: &str = "
include!(\"rods.rs\");

use mbs_runtime::{Constraints, Projector, State};

const N: usize = 70;
const TIME: f64 = 0.3;

fn main() {
    let chain = rods::Rods::<f64>::default();
    let q: [f64; N] = std::array::from_fn(|i| if i < N / 2 { 0.2 * (i + 1) as f64 } else { 0.03 * (i as f64).sin() });
    let mut state = State::new(q, std::array::from_fn(|i| (i as f64).cos()));
    let rows = chain.rows();
    let mut projector = Projector::new(vec![0.0; Projector::<f64, Vec<f64>>::size(N, rows)]);
    projector.project(&chain, TIME, &mut state).unwrap();
    let (mut phi, mut rate) = (vec![f64::NAN; rows], vec![f64::NAN; rows]);
    chain.position(TIME, &state.q, &mut phi);
    chain.rate(TIME, &state.q, &state.qd, &mut rate);
    assert!(phi.iter().chain(&rate).all(|x| x.abs() < 1e-12), \"{phi:?} {rate:?}\");
    // M and A in full are those of the functions.
    let (mut m, mut a) = (vec![f64::NAN; N * N], vec![f64::NAN; rows * N]);
    Constraints::mass_matrix(&chain, TIME, &state.q, &mut m);
    chain.jacobian(TIME, &state.q, &mut a);
    assert_eq!(m, chain.mass_matrix(TIME, &state.q).as_flattened());
    assert_eq!(a, chain.constraint_jacobian(TIME, &state.q).as_flattened());
    let zeros = mbs_runtime::Linearization { q: [[f64::NAN; N]; N], qd: [[f64::NAN; N]; N], u: [[]; N] };
    let mut found = zeros;
    chain.linearize(TIME, &state.q, &state.qd, &mut found);
    let (h, mut off) = (1e-6, 0.0_f64);
    for column in 0..N {
        let at = |change: f64, of_rates: bool| {
            let (mut q, mut qd) = (state.q, state.qd);
            if of_rates { qd[column] += change } else { q[column] += change }
            chain.forward_dynamics(TIME, &q, &qd)
        };
        for (of_rates, found) in [(false, &found.q), (true, &found.qd)] {
            let (after, before) = (at(h, of_rates), at(-h, of_rates));
            for row in 0..N {
                let slope = (after[row] - before[row]) / (2.0 * h);
                assert!(found[row][column].is_finite());
                off = off.max((found[row][column] - slope).abs() / (1.0 + slope.abs()));
            }
        }
    }
    println!(\"off by {off:e}\");
    assert!(off < 1e-7);
    // In single precision.
    let single = rods::Rods::<f32>::default().forward_dynamics(TIME as f32, &state.q.map(|x| x as f32), &state.qd.map(|x| x as f32));
    let double = chain.forward_dynamics(TIME, &state.q, &state.qd);
    let size = double.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    assert!(single.iter().zip(double).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-3 * size), \"{single:?}\");
}
";

#[test]
fn a_mass_matrix_larger_than_the_stack_is_written_to_storage() {
    let row = "mechanism Row {
        const n = 100;
        const m: kg = 0.1; const k: N/m = 3;
        coord x[n]: m;
        kinetic += m*dt(x[0])^2/2;
        for i in 1..n {
            kinetic += m*(dt(x[i]) + dt(x[i - 1]))^2/2;
            potential += k*(x[i] - x[i - 1])^2/2;
        }
    }";
    run("row", row, &["mass_matrix", "forward_dynamics", "linearize"], ROW);
}

#[test]
fn states_are_projected_with_matrices_in_storage() {
    let train = "mechanism Train {
        const n = 120;
        coord x[n]: m;
        for i in 0..n { kinetic += 0.1 kg*dt(x[i])^2/2; }
        for i in 1..n { constraint distance[i - 1]: x[i] - x[i - 1] = 1 m; }
    }";
    let functions = ["mass_matrix", "constraint", "constraint_rate", "constraint_jacobian"];
    run("train", train, &functions, TRAIN);
}

#[test]
fn linearizations_by_elimination_are_written_to_storage() {
    let rods = "mechanism Rods {
        const n = 35;
        const m: kg = 0.1; const l: m = 0.2; const g: m/s^2 = 9.81;
        coord x[n]: m; coord y[n]: m;
        let length = l*(1 + sin(2 rad/s*t)/10);
        for i in 0..n {
            kinetic += particle(m, [x[i], y[i], 0]);
            potential += m*g*y[i];
            constraint rod[i]: ((x[i] - if i > 0 { x[i - 1] } else { 0 })^2 + (y[i] - if i > 0 { y[i - 1] } else { 0 })^2 - length^2)/2 = 0;
        }
    }";
    let functions =
        ["forward_dynamics", "linearize", "mass_matrix", "constraint", "constraint_rate", "constraint_jacobian"];
    run("rods", rods, &functions, RODS);
}
