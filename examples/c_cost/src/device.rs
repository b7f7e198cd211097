//! Forward dynamics of many states: a kernel of OpenCL on the first device, and rayon over the Rust.

use std::ptr::null_mut;
use std::time::Instant;

use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, Device, get_all_devices};
use opencl3::kernel::{ExecuteKernel, Kernel};
use opencl3::memory::{Buffer, CL_MEM_READ_WRITE};
use opencl3::program::Program;
use opencl3::types::{CL_BLOCKING, cl_double};
use rayon::prelude::*;

use super::arm6::Arm6;
use super::{N, State, states};

const MANY: usize = 100_000;
const ROUNDS: usize = 20;

pub(crate) fn report(arm: &Arm6) {
    let states = states(MANY);
    let mut accelerations = vec![[0.0; N]; MANY];
    let rayon = best(|| {
        let both = states.par_iter().zip(&mut accelerations);
        both.for_each(|(s, qdd)| *qdd = arm.forward_dynamics(&s.q, &s.qd, &s.w));
    });
    println!(
        "forward_dynamics by rayon, {} threads: {:.2e} states/s",
        rayon::current_num_threads(),
        MANY as f64 / rayon
    );
    let device = match get_all_devices(CL_DEVICE_TYPE_ALL) {
        Ok(devices) if !devices.is_empty() => Device::new(devices[0]),
        _ => return println!("skipped: OpenCL, no device"),
    };
    let (time, found) = kernel(&device, &states).expect("OpenCL");
    println!("by OpenCL on {}: {:.2e} states/s", device.name().unwrap_or_default(), MANY as f64 / time);
    for (i, want) in accelerations.iter().enumerate() {
        let size = want.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        assert!((0..N).all(|k| (found[k * MANY + i] - want[k]).abs() < 1e-9 * size), "state {i}");
    }
}

fn best(mut round: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        round();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

/// Seconds of a run, without copies, and its results.
fn kernel(device: &Device, states: &[State]) -> opencl3::Result<(f64, Vec<f64>)> {
    let context = Context::from_device(device)?;
    let queue = CommandQueue::create_default_with_properties(&context, 0, 0)?;
    let source = include_str!(concat!(env!("OUT_DIR"), "/arm6.cl"));
    let program = Program::create_and_build_from_source(&context, source, "").expect("a program");
    let column = |part: fn(&State) -> &[f64; N]| -> Vec<f64> {
        (0..N).flat_map(|k| states.iter().map(move |state| part(state)[k])).collect()
    };
    let copied = |numbers: &[f64]| -> opencl3::Result<Buffer<cl_double>> {
        // SAFETY: the buffer has as many numbers, and the copy is finished before this returns.
        unsafe {
            let mut buffer = Buffer::create(&context, CL_MEM_READ_WRITE, numbers.len(), null_mut())?;
            queue.enqueue_write_buffer(&mut buffer, CL_BLOCKING, 0, numbers, &[])?;
            Ok(buffer)
        }
    };
    // The arm has no parameters: its structs are one number that nothing reads.
    let own = copied(&[0.0])?;
    let arguments = [copied(&column(|s| &s.q))?, copied(&column(|s| &s.qd))?, copied(&column(|s| &s.w))?];
    let result = copied(&vec![0.0; N * states.len()])?;
    let forward_dynamics = Kernel::create(&program, "arm6_forward_dynamics_kernel")?;
    let count = states.len() as u32;
    let time = best(|| {
        let mut run = ExecuteKernel::new(&forward_dynamics);
        // SAFETY: arguments are those that the kernel declares, of as many numbers as it reads and writes.
        unsafe {
            run.set_arg(&count).set_arg(&own);
            arguments.iter().for_each(|argument| {
                run.set_arg(argument);
            });
            run.set_arg(&result).set_global_work_size(states.len());
            run.enqueue_nd_range(&queue).expect("it runs");
        }
        queue.finish().expect("it ends");
    });
    let mut found = vec![0.0; N * states.len()];
    // SAFETY: as many numbers as the buffer has, copied before this returns.
    unsafe { queue.enqueue_read_buffer(&result, CL_BLOCKING, 0, &mut found, &[])? };
    Ok((time, found))
}
