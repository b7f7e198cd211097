//! Instructions that a call takes, as valgrind counts them: the guard against code that grows slower unnoticed.
//!
//! `cargo bench -p mbs-benches --no-default-features --bench instructions` compares with `instructions.toml` beside it,
//! and fails where a function takes 3 % more; `-- --write` writes the table anew. The counts are those of plain x86-64,
//! and of one compiler: they do not depend on the machine or on what else it does.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::process::{Command, ExitCode};

use mbs_benches::states;
use mbs_models::arm6::Arm6;
use mbs_models::four_bar::FourBar;
use mbs_models::irb7600::Irb7600;
use mbs_models::quadrotor_quaternion::QuadrotorQuaternion;
use mbs_models::stewart_platform::StewartPlatform;
use mbs_runtime::{Dop853, Integrator, State};

/// The table, and what it may be exceeded by.
const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instructions.toml");
const MOST: f64 = 1.03;

/// What is counted: a name, and what runs `calls` calls.
type Counted = (&'static str, fn(calls: usize));

const COUNTED: [Counted; 10] = [
    ("arm6 inverse_dynamics", |calls| arm(calls, |arm, [q, qd, qdd]| arm.inverse_dynamics(q, qd, qdd))),
    ("arm6 bias", |calls| arm(calls, |arm, [q, qd, _]| arm.bias(q, qd))),
    ("arm6 mass_matrix", |calls| arm(calls, |arm, [q, ..]| arm.mass_matrix(q))),
    ("arm6 forward_dynamics", |calls| arm(calls, |arm, [q, qd, tau]| arm.forward_dynamics(q, qd, tau))),
    ("arm6 linearize", |calls| arm(calls, |arm, [q, qd, tau]| arm.linearize(q, qd, tau))),
    ("irb7600 forward_dynamics", |calls| {
        let arm = Irb7600::<f64>::default();
        each(calls, |[q, qd, tau]: &[[f64; 6]; 3]| arm.forward_dynamics(q, qd, tau));
    }),
    ("stewart_platform forward_dynamics", |calls| {
        let platform = StewartPlatform::<f64>::default();
        each(calls, |[q, qd, force]: &[[f64; 6]; 3]| {
            let [x, y, z, phi, theta, psi] = q.map(|x| 0.1 * x);
            platform.forward_dynamics(&[x, y, z + 1.2, phi, theta, psi], qd, force)
        });
    }),
    ("quadrotor_quaternion forward_dynamics", |calls| {
        let vehicle = QuadrotorQuaternion::<f64>::default();
        each(calls, |[q, qd, _]: &[[f64; 7]; 3]| vehicle.forward_dynamics(&[[0.0; 3]; 3], q, qd, &[300.0; 4]));
    }),
    ("four_bar forward_dynamics", |calls| {
        let loops = FourBar::<f64>::default();
        each(calls, |[q, qd, _]: &[[f64; 3]; 3]| loops.forward_dynamics(q, qd, &[1.0]));
    }),
    ("Dop853, a Kepler orbit", |calls| {
        for _ in 0..calls {
            let mut state = State::new([0.4, 0.0], [0.0, 2.0]);
            let force = |_: f64, q: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]| {
                let squared = q[0] * q[0] + q[1] * q[1];
                let cubed = squared * squared.sqrt();
                *qdd = [-q[0] / cubed, -q[1] / cubed];
            };
            let end = std::f64::consts::TAU;
            let done =
                Dop853::new(1e-9, 1e-9).integrate(force, 0.0, end, &mut state, |_| std::ops::ControlFlow::Continue(()));
            black_box(done).expect("an orbit without an impact");
        }
    }),
];

/// A function of the arm.
fn arm<R>(calls: usize, function: impl Fn(&Arm6<f64>, &[[f64; 6]; 3]) -> R) {
    let arm = Arm6::default();
    each(calls, |state| function(&arm, state));
}

/// A function at one state after the other.
fn each<const N: usize, R>(calls: usize, function: impl Fn(&[[f64; N]; 3]) -> R) {
    for state in states([3.0, 2.0, 5.0]).iter().cycle().take(calls) {
        black_box(function(black_box(state)));
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["run", name, calls] => {
            let (_, run) = COUNTED.iter().find(|(known, _)| known == name).expect("a name of the table");
            run(calls.parse().expect("a number"));
            ExitCode::SUCCESS
        }
        [] | ["--write"] => compare(!arguments.is_empty()),
        _ => {
            eprintln!("usage: cargo bench -p mbs-benches --no-default-features --bench instructions [-- --write]");
            ExitCode::from(2)
        }
    }
}

fn compare(write: bool) -> ExitCode {
    if !cfg!(target_arch = "x86_64") || Command::new("valgrind").arg("--version").output().is_err() {
        println!("skipped: instructions, there is no valgrind, or this is not x86-64");
        return ExitCode::SUCCESS;
    }
    let known: BTreeMap<String, u64> = match std::fs::read_to_string(TABLE) {
        Ok(text) => toml::from_str(&text).expect("names and numbers"),
        Err(_) => BTreeMap::new(),
    };
    let counted: BTreeMap<String, u64> = COUNTED.iter().map(|(name, _)| (name.to_string(), a_call(name))).collect();
    let mut slower = Vec::new();
    for (name, &count) in &counted {
        let ratio = known.get(name).map(|&known| count as f64 / known as f64);
        println!("{name:40} {count:8} {:>8}", ratio.map_or("new".to_string(), |ratio| format!("{ratio:.3}")));
        if !write && ratio.is_none_or(|ratio| ratio > MOST) {
            slower.push(name);
        }
    }
    if write {
        let text = "# Instructions of a call on x86-64, by `instructions.rs` beside this; written by `-- --write`.\n";
        let table = toml::to_string(&counted).expect("names and numbers");
        std::fs::write(TABLE, text.to_string() + &table).expect("the table is written");
    }
    if slower.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("not in the table, or more than 3 % above it: {slower:?}");
    ExitCode::FAILURE
}

/// Instructions of a call: those of a longer run without those of a shorter one.
fn a_call(name: &str) -> u64 {
    const CALLS: [u64; 2] = [1024, 2048];
    let [shorter, longer] = CALLS.map(|calls| instructions(name, calls));
    (longer - shorter) / (CALLS[1] - CALLS[0])
}

/// Instructions of a process with this many calls, by callgrind's summary on standard error.
fn instructions(name: &str, calls: u64) -> u64 {
    let program = std::env::current_exe().expect("a program has a path");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["run", name, &calls.to_string()])
        .output()
        .expect("valgrind runs");
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split_once("Collected : "));
    let (_, count) = collected.unwrap_or_else(|| panic!("valgrind says no count: {text}"));
    count.trim().parse().expect("a number")
}
