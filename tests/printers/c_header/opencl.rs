//! The kernels of OpenCL C, run by whatever device of OpenCL there is, as POCL makes one of the processor.
//!
//! Skipped without a compiler of C, without OpenCL's header and library, and without a device with doubles.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::{Binary, Rounded};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, Instruction, Program};
use mbs_tests::random::Random;

use super::{
    analysed, arguments, bits, entries, has, interpreted, mechanisms, numbers, printed, same, states, takes, want,
};

const STATES: usize = 24;

/// Branches and tables, motions that are given, constraints with reactions, attitudes. They are few because a device
/// takes seconds to compile a mechanism.
const MECHANISMS: [&str; 4] = ["branches", "shaken_pendulum", "four_bar_with_reactions", "quadrotor_quaternion"];

/// The program that runs kernels, where there is a device for it.
fn host(folder: &Path) -> bool {
    if !has("cc") {
        return false;
    }
    let compile = |file: &str, text: &str| {
        std::fs::write(folder.join(file), text).expect("written");
        let arguments = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", file, "-o", "host", "-lOpenCL"];
        Command::new("cc").args(arguments).current_dir(folder).output().expect("it runs")
    };
    let probe = "#define CL_TARGET_OPENCL_VERSION 120\n#include <CL/cl.h>\n\
                 int main(void) { cl_platform_id p; cl_device_id d; return clGetPlatformIDs(1, &p, 0) || \
                 clGetDeviceIDs(p, CL_DEVICE_TYPE_ALL, 1, &d, 0); }\n";
    if !compile("probe.c", probe).status.success() {
        println!("skipped: OpenCL, no header or library");
        return false;
    }
    if !Command::new(folder.join("host")).status().is_ok_and(|status| status.success()) {
        println!("skipped: OpenCL, no device");
        return false;
    }
    let output = compile("host.c", include_str!("host.c"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    true
}

/// Whether nothing but `+ − × ÷ √`, sines and cosines occur.
fn is_exact(program: &Program) -> bool {
    use mbs_derive::expr::Function as F;
    let is_exact = |instruction: &Instruction| match instruction {
        Instruction::Call(function, _) => matches!(function, F::Sin | F::Cos | F::Abs | F::Signum),
        Instruction::Call2(Binary::Atan2 | Binary::Powf, ..) => false,
        _ => true,
    };
    program.instructions.iter().all(is_exact)
}

/// Number k of state i is at `k*states + i`.
fn columns(states: &[Vec<f64>]) -> Vec<f64> {
    let count = states.first().map_or(0, Vec::len);
    (0..count).flat_map(|k| states.iter().map(move |state| state[k])).collect()
}

#[test]
fn kernels_give_the_bits_of_their_programs() {
    let folder = tempfile::tempdir().expect("a folder");
    if !host(folder.path()) {
        return;
    }
    let mut random = Random::new(19);
    let (mut exact, mut close) = (0, 0);
    for (name, text) in mechanisms().filter(|(name, _)| MECHANISMS.contains(name)) {
        analysed(name, text, |of| {
            let header = Language::Opencl.write(of, name, &Options::default());
            std::fs::write(folder.path().join("kernels.cl"), &header).expect("written");
            let counts = compare(of, name, &header, folder.path(), &mut random);
            exact += counts[0];
            close += counts[1];
        });
    }
    assert!(exact > 10_000 && close > 100, "{exact} {close}");
}

fn compare(of: &Derivation, name: &str, header: &str, folder: &Path, random: &mut Random) -> [usize; 2] {
    let states = states(of, STATES, random);
    let kernels: Vec<&str> = header.lines().filter_map(|line| line.strip_prefix("MBS_KERNEL ")).collect();
    let kernels: Vec<&str> = kernels.iter().filter_map(|line| line.split('(').next()).collect();
    let number = |ending: &str| {
        let line = header.lines().find(|line| line.starts_with("#define ") && line.contains(ending)).expect("a size");
        line.rsplit(' ').next().expect("a number").to_string()
    };
    let (parameters, length) = (number("_PARAMETERS "), number("_NUMBERS "));
    let defaults: Vec<f64> = of.parameters.iter().flat_map(|p| &p.defaults).map(|value| value.to_f64()).collect();
    let defaults = if defaults.is_empty() { vec![0.0] } else { defaults };
    let mut given = format!("new {parameters} {length} {} {}", kernels[0], bits(&defaults));
    for (function, kernel) in of.functions.iter().zip(&kernels[1..]) {
        let inputs: Vec<(&str, usize)> =
            arguments(of).into_iter().filter(|(name, n)| *n > 0 && takes(of, function, name)).collect();
        let outputs: Vec<usize> = function.results.iter().map(|part| entries(part.shape)).filter(|n| *n > 0).collect();
        let _ = write!(given, "\nrun {STATES} {} {} {kernel} ", inputs.len(), outputs.len());
        for (argument, count) in inputs {
            let all: Vec<Vec<f64>> = states
                .iter()
                .map(|(state, multipliers)| match argument {
                    "t" => vec![state.t],
                    "prescribed" => state.prescribed.as_flattened().to_vec(),
                    "q" => state.q.clone(),
                    "qd" => state.qd.clone(),
                    "qdd" => state.qdd.clone(),
                    "u" => state.u.clone(),
                    _ => multipliers.clone(),
                })
                .collect();
            let _ = write!(given, "{count} {}", bits(&columns(&all)));
        }
        outputs.iter().for_each(|count| {
            let _ = write!(given, "{count} ");
        });
    }
    let printed = printed(&folder.join("host"), &["kernels.cl", ""], given);
    assert_eq!(printed.lines().count(), of.functions.len(), "{name}");
    let mut counts = [0, 0];
    for (function, line) in of.functions.iter().zip(printed.lines()) {
        let found = numbers(line.split_whitespace());
        for (i, (state, multipliers)) in states.iter().enumerate() {
            let own: Vec<f64> = found.iter().copied().skip(i).step_by(STATES).collect();
            counts[usize::from(!agree(of, function, (state, multipliers.as_slice()), &own, name))] += own.len();
        }
    }
    counts
}

/// To the bit, or where other functions of the library occur within the running error; which of them.
fn agree(
    of: &Derivation,
    function: &Function,
    (state, multipliers): (&State, &[f64]),
    found: &[f64],
    name: &str,
) -> bool {
    let want = want(&interpreted(of), function, state, multipliers);
    let is_exact = of.functions.iter().all(|f| is_exact(&f.program)) && is_exact(&of.constructor);
    let bounds = (!is_exact).then(|| bounds(of, function, state, multipliers));
    assert_eq!(found.len(), want.len(), "{name}, {}", function.name);
    for (i, (&found, &want)) in found.iter().zip(&want).enumerate() {
        let is_close = bounds.as_ref().is_some_and(|bounds| (found - want).abs() <= bounds[i]);
        assert!(same(found, want) || is_close, "{name}, {}[{i}]: {found:e}, not {want:e}", function.name);
    }
    is_exact
}

/// How far rounding may carry each result; twice, because both have been carried.
fn bounds(of: &Derivation, function: &Function, state: &State, multipliers: &[f64]) -> Vec<f64> {
    let exact = |values: &[f64]| values.iter().copied().map(Rounded::exact).collect::<Vec<_>>();
    let parameters = of.parameters.iter().flat_map(|p| &p.defaults).map(|value| Rounded::exact(value.to_f64()));
    let state = State {
        t: Rounded::exact(state.t),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Rounded::exact)).collect(),
        q: exact(&state.q),
        qd: exact(&state.qd),
        qdd: exact(&state.qdd),
        u: exact(&state.u),
    };
    let results =
        Interpreter::with_parameters(of, parameters.collect()).evaluate_with(function, &state, &exact(multipliers));
    results.iter().map(|result| 2.0 * result.error).collect()
}

/// Each function of the header that is not the runtime's own, within 4 ulp of the host's.
#[test]
fn the_device_s_functions_are_within_4_ulp() {
    let folder = tempfile::tempdir().expect("a folder");
    if !host(folder.path()) {
        return;
    }
    type Elementary = (&'static str, fn(f64) -> f64, [f64; 2]);
    let functions: [Elementary; 12] = [
        ("tan", f64::tan, [-1.5, 1.5]),
        ("asin", f64::asin, [-1.0, 1.0]),
        ("acos", f64::acos, [-1.0, 1.0]),
        ("atan", f64::atan, [-9.0, 9.0]),
        ("sinh", f64::sinh, [-9.0, 9.0]),
        ("cosh", f64::cosh, [-9.0, 9.0]),
        ("tanh", f64::tanh, [-9.0, 9.0]),
        ("exp", f64::exp, [-30.0, 30.0]),
        ("ln", f64::ln, [1e-3, 1e3]),
        ("sqrt", f64::sqrt, [0.0, 1e3]),
        ("sin", f64::sin, [-1e5, 1e5]),
        ("cos", f64::cos, [-1e5, 1e5]),
    ];
    let (_, text) = mechanisms().find(|(name, _)| *name == "pendulum").expect("it is shipped");
    let mut program = analysed("pendulum", text, |of| Language::Opencl.write(of, "pendulum", &Options::default()));
    let mut given = "new 1 1 none 0".to_string();
    program += "__kernel void none(__global const mbs_real *params, __global mbs_real *self) { *self = *params; }\n";
    let head = "(unsigned int n, __global const void *self, __global const mbs_real *x, __global mbs_real *y)";
    let mut random = Random::new(20);
    let count = 1000;
    let mut arguments = Vec::new();
    for (name, _, [low, high]) in functions {
        let _ = writeln!(
            program,
            "__kernel void test_{name}{head} {{ const size_t i = get_global_id(0); y[i] = mbs_{name}(x[i]); }}"
        );
        let x: Vec<f64> = (0..count).map(|_| random.uniform(low..high)).collect();
        let _ = write!(given, "\nrun {count} 1 1 test_{name} 1 {} 1", bits(&x));
        arguments.push(x);
    }
    std::fs::write(folder.path().join("functions.cl"), program).expect("written");
    let printed = printed(&folder.path().join("host"), &["functions.cl", ""], given);
    for (((name, function, _), x), line) in functions.iter().zip(&arguments).zip(printed.lines()) {
        for (&x, found) in x.iter().zip(numbers(line.split_whitespace())) {
            let want = function(x);
            let ulp = f64::from_bits(want.abs().to_bits() + 1) - want.abs();
            assert!((found - want).abs() <= 4.0 * ulp, "{name}({x}) = {found}, not {want}");
        }
    }
    assert_eq!(printed.lines().count(), functions.len());
}

/// The program of docs/c.md for a host in Python.
#[test]
fn the_manual_s_host_runs() {
    let has_pyopencl = Command::new("python3").args(["-c", "import pyopencl"]).output();
    if !has_pyopencl.is_ok_and(|output| output.status.success()) {
        println!("skipped: pyopencl, which is not there");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    super::write_manual(folder.path(), Language::Opencl, "main.py", super::manual("python"));
    let output = Command::new("python3").arg("main.py").current_dir(folder.path()).output().expect("it runs");
    let [a, b] = super::pendulum().forward_dynamics(&[0.3; 2], &[0.0; 2]);
    let found: Vec<f64> =
        String::from_utf8_lossy(&output.stdout).split_whitespace().map(|x| x.parse().expect("a number")).collect();
    assert!(found.len() == 2 && (found[0] - a).abs() < 1e-11 && (found[1] - b).abs() < 1e-11, "{output:?}");
}
