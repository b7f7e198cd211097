//! Mechanisms of a thousand bodies: derived, proved, printed, compiled, run. A chain is printed in loops over its
//! links; particles with forces between neighbours take no solver; with rods between them their system is eliminated in
//! an order that is printed with it.

use std::fs;

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{Analysis, expr::Graph, source::Sources};

use super::downstream::{Downstream, text};

/// Links of the chain.
const LINKS: usize = 1000;

/// Accelerations, what they take, and whether that gives them back, on a stack of a mebibyte.
const CHAIN: &str = "
include!(\"chain.rs\");

const LINKS: usize = 1000;

fn numbers(most: f64, seed: f64) -> [f64; LINKS] {
    std::array::from_fn(|i| most * (2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0))
}

fn off() -> f64 {
    let chain = n_chain::NChain::<f64>::default();
    let (q, qd, qdd) = (numbers(3.0, 0.0), numbers(0.1, 0.3), numbers(2.0, 0.7));
    let found = chain.forward_dynamics(&q, &qd, &chain.inverse_dynamics(&q, &qd, &qdd));
    assert!(found.iter().all(|x| x.is_finite()));
    found.iter().zip(&qdd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn main() {
    let off = std::thread::Builder::new().stack_size(1 << 20).spawn(off).unwrap().join().unwrap();
    println!(\"off by {off:e}\");
    assert!(off < 1e-5);
}
";

/// Springs of the length l between neighbours, gravity, and Newton's second law for each particle.
const THREAD: &str = "
include!(\"thread.rs\");

const N: usize = 1000;

fn numbers(most: f64, seed: f64) -> [f64; 3 * N] {
    std::array::from_fn(|i| most * (2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0))
}

fn off() -> f64 {
    let (m, k, l, g) = (0.1, 100.0, 0.2, 9.81);
    let mut q = numbers(0.03, 0.0);
    (0..N).for_each(|i| q[i] += 0.1 * i as f64);
    let found = thread::Thread::<f64>::default().forward_dynamics(&q, &numbers(0.1, 0.3));
    let mut force = [[0.0, 0.0, -m * g]; N];
    for i in 0..N - 1 {
        let to: [f64; 3] = std::array::from_fn(|axis| q[axis * N + i + 1] - q[axis * N + i]);
        let length = to.iter().map(|x| x * x).sum::<f64>().sqrt();
        for axis in 0..3 {
            let pull = k * (length - l) * to[axis] / length;
            force[i][axis] += pull;
            force[i + 1][axis] -= pull;
        }
    }
    assert!(found.iter().all(|x| x.is_finite()));
    let differs = |i: usize, axis: usize| (found[axis * N + i] - force[i][axis] / m).abs();
    (0..N).flat_map(|i| (0..3).map(move |axis| (i, axis))).map(|(i, axis)| differs(i, axis)).fold(0.0, f64::max)
}

fn main() {
    let off = std::thread::Builder::new().stack_size(1 << 20).spawn(off).unwrap().join().unwrap();
    println!(\"off by {off:e}\");
    assert!(off < 1e-9);
}
";

/// Newton's law for each particle with the forces of its rods, and rods that keep their lengths.
const LATTICE: &str = "
include!(\"lattice.rs\");

const N: usize = 21;

fn number(i: usize, seed: f64) -> f64 {
    2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0
}

fn off() -> f64 {
    let (m, g) = (0.1, 9.81);
    let mut q = [0.0; 2 * N * N];
    for k in 0..N * N {
        q[k] = 0.2 * (k % N) as f64 + 0.02 * number(k, 0.0);
        q[N * N + k] = -0.2 * (k / N) as f64 + 0.02 * number(k, 0.4);
    }
    let qd: [f64; 2 * N * N] = std::array::from_fn(|i| 0.3 * number(i, 0.7));
    let lattice = lattice::Lattice::<f64>::default();
    let (qdd, multipliers) = (lattice.forward_dynamics(&q, &qd), lattice.multipliers(&q, &qd));
    let rods = (0..N).flat_map(|i| (0..N - 1).map(move |j| (i, j)));
    let across = rods.clone().map(|(i, j)| (N * i + j, N * i + j + 1));
    let down = rods.map(|(i, j)| (N * j + i, N * j + i + N));
    let (mut force, mut off) = ([[0.0, -m * g]; N * N], Vec::new());
    for ((a, b), pull) in across.chain(down).zip(multipliers) {
        let mut stretch = 0.0;
        for axis in 0..2 {
            let to = |x: &[f64; 2 * N * N]| x[axis * N * N + b] - x[axis * N * N + a];
            force[a][axis] -= pull * to(&q);
            force[b][axis] += pull * to(&q);
            stretch += to(&q) * to(&qdd) + to(&qd) * to(&qd);
        }
        off.push(stretch);
    }
    for k in 0..N * N {
        off.extend((0..2).map(|axis| m * qdd[axis * N * N + k] - force[k][axis]));
    }
    assert!(off.iter().all(|x| x.is_finite()));
    let all = qdd.iter().chain(&multipliers);
    println!(\"bits {:x}\", all.fold(0u64, |bits, x| bits.rotate_left(7) ^ x.to_bits()));
    off.iter().fold(0.0, |most, x| x.abs().max(most))
}

fn main() {
    let off = std::thread::Builder::new().stack_size(2 << 20).spawn(off).unwrap().join().unwrap();
    println!(\"off by {off:e}\");
    assert!(off < 1e-10);
}
";

/// Compiles what is generated for a mechanism beside a program, and runs it; what it prints.
pub(super) fn run(name: &str, mechanism: &str, functions: &[&str], program: &str) -> String {
    let file = format!("{name}.mbs");
    let options = mbs_derive::emit::Options::default().functions(functions.iter().copied());
    let generated = mbs_derive::generate(&file, mechanism, &options);
    let code = generated.unwrap_or_else(|e| panic!("{}", e.render(&file, mechanism))).code;
    assert!(code.len() < 1_000_000, "{} bytes", code.len());
    let dependencies = "[dependencies]\nmbs-runtime = { path = \"../mbs/mbs-runtime\", features = [\"std\"] }\n";
    let crate_ = Downstream::new(name, dependencies);
    crate_.write(&format!("src/{name}.rs"), &code);
    crate_.write("src/main.rs", program);
    let run = crate_.cargo(&["run"]);
    assert!(run.status.success() && text(&run).contains("off by "), "{}", text(&run));
    text(&run)
}

#[test]
fn a_thousand_links_move_on_a_stack_of_a_mebibyte() {
    let chain = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms/n_chain.mbs")).expect("the chain");
    let chain = chain.replace("const n = 5;", &format!("const n = {LINKS};"));
    run("chain", &chain, &["inverse_dynamics", "forward_dynamics"], CHAIN);
}

/// With 3000 coordinates, as many as a mechanism may have.
#[test]
fn a_thousand_particles_move_on_a_stack_of_a_mebibyte() {
    let thread = "mechanism Thread {
        const n = 1000;
        param m: kg = 0.1; param k: N/m = 100; param l: m = 0.2; param g: m/s^2 = 9.81;
        coord x[n]: m; coord y[n]: m; coord z[n]: m;
        for i in 0..n {
            kinetic += m*(dt(x[i])^2 + dt(y[i])^2 + dt(z[i])^2)/2;
            potential += m*g*z[i];
        }
        for i in 1..n {
            potential += k*(sqrt((x[i] - x[i - 1])^2 + (y[i] - y[i - 1])^2 + (z[i] - z[i - 1])^2) - l)^2/2;
        }
    }";
    run("thread", thread, &["forward_dynamics"], THREAD);
}

/// Particles in rows and columns, neighbours on rods of one length, 840 of them: the cells are four-bars.
#[test]
fn a_lattice_of_400_four_bars_moves_on_the_stack_of_a_thread() {
    let lattice = "mechanism Lattice {
        const n = 21;
        const m: kg = 0.1; const l: m = 0.2; const g: m/s^2 = 9.81;
        coord x[n*n]: m; coord y[n*n]: m;
        fn rod(ax, ay, bx, by) = ((bx - ax)^2 + (by - ay)^2 - l^2)/2;
        for k in 0..n*n {
            kinetic += particle(m, [x[k], y[k], 0]);
            potential += m*g*y[k];
        }
        for i in 0..n { for j in 0..n-1 {
            let a = n*i + j;
            constraint across[(n-1)*i + j]: rod(x[a], y[a], x[a+1], y[a+1]) = 0;
        } }
        for i in 0..n { for j in 0..n-1 {
            let a = n*j + i;
            constraint down[(n-1)*i + j]: rod(x[a], y[a], x[a+n], y[a+n]) = 0;
        } }
    }";
    let printed = run("lattice", lattice, &["forward_dynamics", "multipliers"], LATTICE);

    // The interpreter's bits.
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&Sources::new("lattice.mbs", lattice), &graph).expect("a derivation");
    let number = |i: usize, seed: f64| 2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0;
    let n = 21;
    let x = (0..n * n).map(|k| 0.2 * (k % n) as f64 + 0.02 * number(k, 0.0));
    let y = (0..n * n).map(|k| -0.2 * (k / n) as f64 + 0.02 * number(k, 0.4));
    let qd = (0..2 * n * n).map(|i| 0.3 * number(i, 0.7)).collect();
    let state = State { q: x.chain(y).collect(), qd, ..State::default() };
    let interpreter = Interpreter::new(analysis.programs());
    let both = [FunctionKind::ForwardDynamics, FunctionKind::Multipliers].map(|kind| interpreter.call(kind, &state));
    let bits = both.into_iter().flatten().flatten().fold(0u64, |bits, x| bits.rotate_left(7) ^ x.to_bits());
    assert!(printed.contains(&format!("bits {bits:x}")), "{printed}, not {bits:x}");
}
