//! Headers with kernels of CUDA, compiled to PTX, functions of host and device and kernels alike.
//!
//! `nvcc` is what `NVCC` names or what is on the path. It is skipped where there is none.

use std::process::Command;

use mbs_derive::emit::{Language, Options};
use mbs_derive::optimise::FunctionKind;

use mbs_printers::case::named;

/// One with constraints, one without, for a compiler that takes its time.
const MECHANISMS: [&str; 2] = ["double_pendulum", "four_bar"];

fn nvcc() -> Option<String> {
    let nvcc = std::env::var("NVCC").unwrap_or_else(|_| "nvcc".to_string());
    let found = Command::new(&nvcc).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: nvcc, which is not there");
    }
    found.then_some(nvcc)
}

#[test]
fn headers_are_cuda() {
    let Some(nvcc) = nvcc() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let mut all = String::new();
    let mut kernels = 0;
    for name in MECHANISMS {
        let of = &named(name).of;
        let (file, text) = (Language::Cuda.file_name(of), Language::Cuda.write(of, name, &Options::default()));
        kernels += text.matches("\nMBS_KERNEL ").count();
        std::fs::write(folder.path().join(&file), text).expect("written");
        all += &format!("#include \"{file}\"\n");
    }
    std::fs::write(folder.path().join("all.cu"), all).expect("written");
    let arguments = ["--ptx", "-std=c++17", "--fmad=false", "-Werror", "all-warnings", "all.cu", "-o", "all.ptx"];
    let output = Command::new(&nvcc).args(arguments).current_dir(folder.path()).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let code = std::fs::read_to_string(folder.path().join("all.ptx")).expect("written");
    assert_eq!(code.matches(".visible .entry ").count(), kernels);
    assert!(code.contains(".visible .entry double_pendulum_forward_dynamics_kernel("));
}

/// The program of docs/c.md is compiled; it runs where there is a device.
#[test]
fn the_manual_s_program_is_cuda() {
    let Some(nvcc) = nvcc() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    super::write_manual(folder.path(), Language::Cuda, "main.cu", super::manual("cuda"));
    let has_device = Command::new("nvidia-smi").output().is_ok_and(|output| output.status.success());
    let made: &[&str] = if has_device { &["main.cu", "-o", "main"] } else { &["-c", "main.cu", "-o", "main.o"] };
    let arguments = [&["-std=c++17", "--fmad=false"], made].concat();
    let output = Command::new(&nvcc).args(arguments).current_dir(folder.path()).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    if !has_device {
        println!("skipped: CUDA, no device");
        return;
    }
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    let accelerations = super::pendulum(FunctionKind::ForwardDynamics, [0.3; 2]);
    let (a, b) = (accelerations[0], accelerations[1]);
    let found: Vec<f64> =
        String::from_utf8_lossy(&output.stdout).split_whitespace().map(|x| x.parse().expect("a number")).collect();
    assert!(found.len() == 2 && (found[0] - a).abs() < 1e-11 && (found[1] - b).abs() < 1e-11, "{output:?}");
}
