//! Is the generated code as fast as dynamics that a specialist writes by hand for one robot?
//!
//! The benchmark arm three ways, in one process: the generated code, [`custom_arm6`] customised by hand, and the
//! general algorithms in [`featherstone`]. Look at the ratios; with `RUSTFLAGS="-C target-cpu=native"` the processor's
//! widest instructions are used. The arms agree to 1e-9 before anything is timed.

#[path = "speed/custom_arm6.rs"]
mod custom_arm6;
#[path = "speed/featherstone.rs"]
mod featherstone;

use mbs_examples::{print, println};
use std::hint::black_box;
use std::time::Instant;

use featherstone::Model;
use mbs_examples::arguments::Arguments;
use mbs_models::arm6::Arm6;
use serde_json::{Map, Value, json};

/// States that are gone through in a round; more than fit into the first-level cache.
const STATES: usize = 1024;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 101;

/// Angles, rates, and accelerations or torques.
struct State {
    q: [f64; 6],
    qd: [f64; 6],
    qdd: [f64; 6],
    tau: [f64; 6],
}

/// One function of one contender: all its results, for the comparison, and the seconds that one round takes.
struct Contender {
    name: &'static str,
    results: Results,
    round: Round,
}

type Results = Box<dyn FnMut(&State) -> Vec<f64>>;
type Round = Box<dyn FnMut(&[State]) -> f64>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::of(include_str!("speed.rs"));

    let states = states();
    let mut functions = Map::new();
    for (function, mut contenders) in functions_of_arm6() {
        agree(function, &mut contenders, &states)?;
        functions.insert(function.to_string(), timed(&mut contenders, &states));
    }
    let report = json!({ "arm6": functions });
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)?;
        std::fs::write(folder.join("speed.json"), format!("{report}\n"))?;
    }
    if arguments.json {
        println!("{report}");
    } else {
        print!("{}", table(&report["arm6"]));
    }
    Ok(())
}

/// Every function with its contenders, the generated code first.
fn functions_of_arm6() -> Vec<(&'static str, Vec<Contender>)> {
    let generated = Arm6::<f64>::default;
    let (arm, mut model) = (generated(), general_model());
    let inverse_dynamics = vec![
        contender("mbs", move |s| arm.inverse_dynamics(&s.q, &s.qd, &s.qdd)),
        contender("custom_newton_euler", |s| custom_arm6::inverse_dynamics(&s.q, &s.qd, &s.qdd)),
        contender("featherstone_nalgebra", move |s| model.inverse_dynamics(&s.q, &s.qd, Some(&s.qdd))),
    ];
    let (arm, mut model) = (generated(), general_model());
    let bias = vec![
        contender("mbs", move |s| arm.bias(&s.q, &s.qd)),
        contender("custom_newton_euler", |s| custom_arm6::bias(&s.q, &s.qd)),
        contender("featherstone_nalgebra", move |s| model.inverse_dynamics(&s.q, &s.qd, None)),
    ];
    let (arm, mut model) = (generated(), general_model());
    let mass_matrix = vec![
        contender("mbs", move |s| arm.mass_matrix(&s.q)),
        contender("custom_newton_euler", |s| custom_arm6::mass_matrix(&s.q)),
        contender("featherstone_nalgebra", move |s| model.mass_matrix(&s.q)),
    ];
    let (arm, mut model) = (generated(), general_model());
    let forward_dynamics = vec![
        contender("mbs", move |s| arm.forward_dynamics(&s.q, &s.qd, &s.tau)),
        contender("custom_newton_euler", |s| custom_arm6::forward_dynamics(&s.q, &s.qd, &s.tau)),
        contender("featherstone_nalgebra", move |s| model.forward_dynamics(&s.q, &s.qd, &s.tau)),
    ];
    let (arm, mut model) = (generated(), general_model());
    let coriolis_matrix = vec![
        contender("mbs", move |s| arm.coriolis_matrix(&s.q, &s.qd)),
        contender("featherstone_nalgebra", move |s| model.coriolis_matrix(&s.q, &s.qd)),
    ];
    vec![
        ("inverse_dynamics", inverse_dynamics),
        ("bias", bias),
        ("mass_matrix", mass_matrix),
        ("forward_dynamics", forward_dynamics),
        ("coriolis_matrix", coriolis_matrix),
    ]
}

/// The loop over the states is compiled with the function in it, so that nothing but the function is timed.
fn contender<R: Numbers>(name: &'static str, mut call: impl FnMut(&State) -> R + Clone + 'static) -> Contender {
    let mut timed = call.clone();
    let round = move |states: &[State]| {
        let start = Instant::now();
        for state in states {
            black_box(timed(black_box(state)));
        }
        start.elapsed().as_secs_f64()
    };
    Contender { name, results: Box::new(move |state| call(state).numbers()), round: Box::new(round) }
}

/// What a contender returns, as numbers.
trait Numbers {
    fn numbers(self) -> Vec<f64>;
}

impl<const N: usize> Numbers for [f64; N] {
    fn numbers(self) -> Vec<f64> {
        self.to_vec()
    }
}

impl<const N: usize> Numbers for [[f64; N]; N] {
    fn numbers(self) -> Vec<f64> {
        self.concat()
    }
}

/// All contenders against the first, to 1e-9 of the largest entry.
fn agree(function: &str, contenders: &mut [Contender], states: &[State]) -> Result<(), String> {
    let (first, others) = contenders.split_first_mut().ok_or("no contenders")?;
    for state in states {
        let want = (first.results)(state);
        let scale = want.iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
        for other in &mut *others {
            let difference = (other.results)(state).iter().zip(&want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Accelerations are as good as M allows: its condition number reaches 6e4.
            if difference.is_nan() || difference > 1e-9 * scale {
                return Err(format!("{function}: {} is off by {difference:e} at {:?}", other.name, state.q));
            }
        }
    }
    Ok(())
}

/// Medians of rounds in which all take turns, in ns a call: what disturbs the machine disturbs everyone.
fn timed(contenders: &mut [Contender], states: &[State]) -> Value {
    let mut seconds = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for _ in 0..ROUNDS {
        for (contender, seconds) in contenders.iter_mut().zip(&mut seconds) {
            seconds.push((contender.round)(states));
        }
    }
    let median = |seconds: &mut Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        let ns = seconds[ROUNDS / 2] * 1e9 / STATES as f64;
        (ns * 10.0).round() / 10.0
    };
    let medians: Vec<f64> = seconds.iter_mut().map(median).collect();
    let rivals: Map<String, Value> =
        contenders.iter().zip(&medians).skip(1).map(|(rival, ns)| (rival.name.to_string(), json!(ns))).collect();
    json!({ "ns": medians[0], "rivals": rivals })
}

fn table(functions: &Value) -> String {
    let mut text =
        format!("{:18} {:>8} {:>22} {:>24}\n", "ns a call", "mbs", "customised by hand", "Featherstone, nalgebra");
    for (function, times) in functions.as_object().into_iter().flatten() {
        let ns = times["ns"].as_f64().unwrap_or(f64::NAN);
        let rival = |name: &str| match times["rivals"][name].as_f64() {
            Some(rival) => format!("{rival:.1} (mbs {:.2})", ns / rival),
            None => String::new(),
        };
        text += &format!(
            "{function:18} {ns:8.1} {:>22} {:>24}\n",
            rival("custom_newton_euler"),
            rival("featherstone_nalgebra")
        );
    }
    text
}

/// The arm of `models/mechanisms/arm6.mbs`, as the general algorithms take it.
fn general_model() -> Model {
    let quarter = std::f64::consts::FRAC_PI_2;
    let geometry = [
        [0.78, 0.41, -quarter],
        [0.0, 1.075, 0.0],
        [0.0, 0.165, -quarter],
        [1.056, 0.0, quarter],
        [0.0, 0.0, -quarter],
        [0.25, 0.0, 0.0],
    ];
    let mass = [60.0, 45.0, 30.0, 12.0, 6.0, 2.5];
    let center = [
        [-0.25, 0.12, 0.03],
        [-0.6, 0.02, 0.11],
        [-0.05, 0.04, 0.06],
        [0.01, -0.35, 0.02],
        [0.005, 0.01, 0.04],
        [0.002, -0.003, -0.08],
    ];
    let inertia = [
        [2.634093, 1.811827, 2.877648, -0.295242, -0.061282, -0.14061],
        [4.752158, 4.708373, 4.685916, -0.097848, -0.173374, 0.975157],
        [0.788004, 0.77469, 0.467434, 0.08349, 0.05332, -0.038677],
        [0.396917, 0.341614, 0.325725, 0.048322, 0.022558, 0.07858],
        [0.024663, 0.022504, 0.025465, -0.002991, 0.004131, 0.000359],
        [0.002416, 0.003385, 0.003816, 0.000281, -0.000146, 0.00049],
    ];
    let links: [_; 6] = std::array::from_fn(|i| (geometry[i], mass[i], center[i], inertia[i]));
    Model::serial(&links, 9.81)
}

/// Angles in ±π, rates in ±2, accelerations in ±5, torques in ±100; the same in every run.
fn states() -> Vec<State> {
    let mut seed = 1_u64;
    // SplitMix64: Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014.
    let mut uniform = |most: f64| {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0) * most
    };
    let mut six = |most: f64| std::array::from_fn(|_| uniform(most));
    let state = |_| State { q: six(std::f64::consts::PI), qd: six(2.0), qdd: six(5.0), tau: six(100.0) };
    (0..STATES).map(state).collect()
}
