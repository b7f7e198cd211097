//! The kernels of OpenCL C, run by whatever device of OpenCL there is, as POCL makes one of the processor.
//!
//! Skipped without a compiler of C, without OpenCL's header and library, and without a device with doubles.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use mbs_derive::emit::{Language, Options, Trigonometry};
use mbs_derive::optimise::{Function, FunctionKind};
use mbs_printers::call::{arguments, takes};
use mbs_printers::case::{ALL, Case, named};
use mbs_printers::depth;
use mbs_printers::tools::each;

use super::{bits, has, numbers, printed};
use crate::elementary;

/// States of a run that is not complete.
const FEW: usize = 24;

/// Branches and tables, motions that are given, constraints with reactions, attitudes: what is run where not all was
/// asked for, because a device takes seconds to compile a mechanism.
const SOME: [&str; 4] = ["branches", "shaken_pendulum", "four_bar_with_reactions", "quadrotor_quaternion"];

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
    let states = if depth::is_complete() { depth::STATES } else { FEW };
    let cases = ALL.iter().filter(|case| depth::is_complete() || SOME.contains(&case.name.as_str()));
    let compared = each(cases, |case| {
        let ways = [Trigonometry::Polynomials, Trigonometry::Library];
        // The library's where it is quick: the kernels differ in two functions of the prelude alone.
        let is_short = case.of.dof() < 4;
        let ways = &ways[..if is_short { 2 } else { 1 }];
        let counts = ways.iter().map(|&trigonometry| {
            let found = ran(case, trigonometry, states, folder.path());
            case.compare("OpenCL", &found, &case.wanted(trigonometry, states), states)
        });
        counts.fold([0, 0], |[a, b], [c, d]| [a + c, b + d])
    });
    let [exact, close] = compared.iter().fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
    println!("{} mechanisms, {exact} numbers with the same bits, {close} within their bounds", compared.len());
    assert!(exact > 10_000 && close > 100, "{exact} {close}");
}

/// What all kernels give, in the order of the programs: function by function, state by state.
fn ran(case: &Case, trigonometry: Trigonometry, states: usize, folder: &Path) -> Vec<f64> {
    let (of, name) = (&case.of, &case.name);
    let header = Language::Opencl.write(of, name, &Options::default().trigonometry(trigonometry));
    let file = format!("{name}_{trigonometry:?}.cl");
    std::fs::write(folder.join(&file), &header).expect("written");
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
    let outputs = |function: &Function| -> Vec<usize> {
        function.results.iter().map(|part| part.shape.entries()).filter(|n| *n > 0).collect()
    };
    assert_eq!(kernels.len(), of.functions.len() + 1, "{name}");
    for (function, kernel) in of.functions.iter().zip(&kernels[1..]) {
        let inputs: Vec<(&str, usize)> =
            arguments(of).into_iter().filter(|(name, n)| *n > 0 && takes(of, function, name)).collect();
        let outputs = outputs(function);
        let _ = write!(given, "\nrun {states} {} {} {kernel} ", inputs.len(), outputs.len());
        for (argument, count) in inputs {
            let all: Vec<Vec<f64>> = case.states[..states]
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
    let printed = printed(&folder.join("host"), &[&file, ""], given);
    assert_eq!(printed.lines().count(), of.functions.len(), "{name}");
    let mut found = Vec::new();
    for line in printed.lines() {
        // Number k of state i is at `k*states + i`.
        let columns = numbers(line.split_whitespace());
        (0..states).for_each(|i| found.extend(columns.iter().copied().skip(i).step_by(states)));
    }
    found
}

/// Every function that the language of mechanisms has.
#[test]
fn the_device_s_functions_are_within_4_ulp() {
    let folder = tempfile::tempdir().expect("a folder");
    if !host(folder.path()) {
        return;
    }
    let (case, wanted) = elementary::case();
    for trigonometry in [Trigonometry::Polynomials, Trigonometry::Library] {
        let found = ran(&case, trigonometry, depth::STATES, folder.path());
        case.compare("OpenCL", &found, &wanted(&case, trigonometry), depth::STATES);
    }
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
    let accelerations = super::pendulum(FunctionKind::ForwardDynamics, [0.3; 2]);
    let (a, b) = (accelerations[0], accelerations[1]);
    let found: Vec<f64> =
        String::from_utf8_lossy(&output.stdout).split_whitespace().map(|x| x.parse().expect("a number")).collect();
    assert!(found.len() == 2 && (found[0] - a).abs() < 1e-11 && (found[1] - b).abs() < 1e-11, "{output:?}");
}

/// A device without doubles, as clang reads for it: nothing is of that type, with constraints or without.
#[test]
fn single_precision_needs_no_doubles() {
    if !Command::new("clang").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("skipped: clang, which is not there");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["double_pendulum", "four_bar"] {
        let of = &named(name).of;
        let file = Language::Opencl.file_name(of);
        std::fs::write(folder.path().join(&file), Language::Opencl.write(of, name, &Options::default()))
            .expect("written");
        let options = ["-x", "cl", "-cl-std=CL1.2", "-Xclang", "-cl-ext=-cl_khr_fp64", "-cl-single-precision-constant"];
        let arguments = [&options[..], &["-DMBS_REAL=float", "-fsyntax-only", file.as_str()]].concat();
        let output = Command::new("clang").args(arguments).current_dir(folder.path()).output().expect("it runs");
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
