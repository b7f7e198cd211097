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
    // M ∂q̈/∂q = −K
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

/// Masses in pairs at distances: states are brought back by M and A.
const PAIRS: &str = "
include!(\"pairs.rs\");

use mbs_runtime::{Projector, State};

const N: usize = 120;

fn main() {
    let q: [f64; N] = std::array::from_fn(|i| i as f64 + 0.1 * (i as f64).sin());
    let mut state = State::new(q, [0.0; N]);
    let mut projector = Projector::new(vec![0.0; Projector::<f64, Vec<f64>>::size(N, N - 1)]);
    projector.project(&pairs::Pairs::<f64>::default(), 0.0, &mut state).unwrap();
    let off = (1..N).map(|i| (state.q[i] - state.q[i - 1] - 1.0).abs()).fold(0.0, f64::max);
    println!(\"off by {off:e}\");
    assert!(off < 1e-12);
    // Nothing pushes the whole: the centre of mass stays.
    let moved: f64 = state.q.iter().zip(&q).map(|(a, b)| a - b).sum();
    assert!(moved.abs() < 1e-9, \"{moved}\");
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
    let pairs = "mechanism Pairs {
        const n = 120;
        coord x[n]: m;
        for i in 0..n { kinetic += 0.1 kg*dt(x[i])^2/2; }
        for i in 1..n { constraint distance[i - 1]: x[i] - x[i - 1] = 1; }
    }";
    let functions = ["mass_matrix", "constraint", "constraint_rate", "constraint_jacobian"];
    run("pairs", pairs, &functions, PAIRS);
}
