//! Is the generated code as fast as dynamics that a specialist writes by hand for one robot?
//!
//! The benchmark arm in one process: the generated code, the same customised by hand (`custom_newton_euler`, with its
//! sines one by one; `custom_vector_sines`, with all of them from one call; `custom_lanes`, for four states at once),
//! and the general algorithms in [`featherstone`]. `ns_batch` is generated code for four states at once, a state.
//! Look at the ratios; with `RUSTFLAGS="-C target-cpu=native"` the processor's widest instructions are used. The arms
//! agree to 1e-9 before anything is timed.

#[path = "speed/custom_lanes.rs"]
mod custom_lanes;
#[path = "speed/custom_newton_euler.rs"]
mod custom_newton_euler;
#[path = "speed/custom_vector_sines.rs"]
mod custom_vector_sines;
#[path = "speed/featherstone.rs"]
mod featherstone;

use mbs_examples::{print, println};
use std::hint::black_box;
use std::time::Instant;

use featherstone::Model;
use mbs_examples::arguments::Arguments;
use mbs_models::arm6::Arm6;
use mbs_runtime::wide::f64x4;
use mbs_runtime::{Lanes, Packed};
use serde_json::{Map, Value, json};

/// States that are gone through in a round; more than fit into the first-level cache.
const STATES: usize = 1024;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 101;

/// Angles, rates, and accelerations or torques; of one state or of several in lanes.
struct State<T> {
    q: [T; 6],
    qd: [T; 6],
    qdd: [T; 6],
    tau: [T; 6],
}

/// The same states twice.
struct States {
    one_by_one: Vec<State<f64>>,
    in_lanes: Vec<State<f64x4>>,
}

/// One function of one contender: all its results, for the comparison, and the seconds that one round takes.
struct Contender {
    name: &'static str,
    results: Results,
    round: Round,
}

type Results = Box<dyn FnMut(&States) -> Vec<Vec<f64>>>;
type Round = Box<dyn FnMut(&States) -> f64>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::of(include_str!("speed.rs"));

    let states = States::random();
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
    /// Generated code and the three ways to compile the customised one, of one function.
    macro_rules! contenders {
        ($function:ident($($argument:ident),+)) => {{
            let (arm, arms) = (Arm6::<f64>::default(), Arm6::<f64x4>::default());
            vec![
                contender("mbs", move |s| arm.$function($(&s.$argument),+)),
                batch("mbs_batch", move |s| arms.$function($(&s.$argument),+)),
                contender("custom_newton_euler", |s| custom_newton_euler::arm::$function($(&s.$argument),+)),
                contender("custom_vector_sines", |s| custom_vector_sines::arm::$function($(&s.$argument),+)),
                batch("custom_lanes", |s| custom_lanes::arm::$function($(&s.$argument),+)),
            ]
        }};
    }
    let (arm, arms) = (Arm6::<f64>::default(), Arm6::<f64x4>::default());
    let mut functions = vec![
        ("inverse_dynamics", contenders!(inverse_dynamics(q, qd, qdd))),
        ("bias", contenders!(bias(q, qd))),
        ("mass_matrix", contenders!(mass_matrix(q))),
        ("forward_dynamics", contenders!(forward_dynamics(q, qd, tau))),
        (
            "coriolis_matrix",
            vec![
                contender("mbs", move |s| arm.coriolis_matrix(&s.q, &s.qd)),
                batch("mbs_batch", move |s| arms.coriolis_matrix(&s.q, &s.qd)),
            ],
        ),
    ];
    let [mut inverse, mut bias, mut mass, mut forward, mut coriolis] = std::array::from_fn(|_| general_model());
    let general = [
        contender("featherstone_nalgebra", move |s| inverse.inverse_dynamics(&s.q, &s.qd, Some(&s.qdd))),
        contender("featherstone_nalgebra", move |s| bias.inverse_dynamics(&s.q, &s.qd, None)),
        contender("featherstone_nalgebra", move |s| mass.mass_matrix(&s.q)),
        contender("featherstone_nalgebra", move |s| forward.forward_dynamics(&s.q, &s.qd, &s.tau)),
        contender("featherstone_nalgebra", move |s| coriolis.coriolis_matrix(&s.q, &s.qd)),
    ];
    functions.iter_mut().zip(general).for_each(|((_, contenders), general)| contenders.push(general));
    functions
}

/// Of one state after the other.
///
/// The loop over the states is compiled with the function in it, so that nothing but the function is timed.
fn contender<P: Numbers<f64>>(
    name: &'static str,
    mut call: impl FnMut(&State<f64>) -> P + Clone + 'static,
) -> Contender {
    let mut timed = call.clone();
    let round = move |states: &States| {
        let start = Instant::now();
        for state in &states.one_by_one {
            black_box(timed(black_box(state)));
        }
        start.elapsed().as_secs_f64()
    };
    let results = move |states: &States| states.one_by_one.iter().map(|state| call(state).numbers(0)).collect();
    Contender { name, results: Box::new(results), round: Box::new(round) }
}

/// Of four states at once.
fn batch<P: Numbers<f64x4>>(
    name: &'static str,
    mut call: impl FnMut(&State<f64x4>) -> P + Clone + 'static,
) -> Contender {
    let mut timed = call.clone();
    let round = move |states: &States| {
        let start = Instant::now();
        for state in &states.in_lanes {
            black_box(timed(black_box(state)));
        }
        start.elapsed().as_secs_f64()
    };
    let results = move |states: &States| {
        let results = states.in_lanes.iter().map(&mut call);
        results.flat_map(|result| (0..f64x4::COUNT).map(move |lane| result.numbers(lane)).collect::<Vec<_>>()).collect()
    };
    Contender { name, results: Box::new(results), round: Box::new(round) }
}

/// What a contender returns, as the numbers of one lane.
trait Numbers<L> {
    fn numbers(&self, lane: usize) -> Vec<f64>;
}

impl<L: Lanes<Real = f64>, const N: usize> Numbers<L> for [L; N] {
    fn numbers(&self, lane: usize) -> Vec<f64> {
        self.each(lane).to_vec()
    }
}

impl<L: Lanes<Real = f64>, const N: usize> Numbers<L> for [[L; N]; N] {
    fn numbers(&self, lane: usize) -> Vec<f64> {
        self.each(lane).concat()
    }
}

/// All contenders against the first, to 1e-9 of the largest entry.
fn agree(function: &str, contenders: &mut [Contender], states: &States) -> Result<(), String> {
    let (first, others) = contenders.split_first_mut().ok_or("no contenders")?;
    let wanted = (first.results)(states);
    for other in others {
        for ((found, want), state) in (other.results)(states).iter().zip(&wanted).zip(&states.one_by_one) {
            let scale = want.iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
            let difference = found.iter().zip(want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Accelerations are as good as M allows: its condition number reaches 6e4.
            if difference.is_nan() || difference > 1e-9 * scale {
                return Err(format!("{function}: {} is off by {difference:e} at {:?}", other.name, state.q));
            }
        }
    }
    Ok(())
}

/// Medians of rounds in which all take turns, in ns a state: what disturbs the machine disturbs everyone.
fn timed(contenders: &mut [Contender], states: &States) -> Value {
    let mut seconds = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for _ in 0..ROUNDS {
        for (contender, seconds) in contenders.iter_mut().zip(&mut seconds) {
            seconds.push((contender.round)(states));
        }
    }
    let median = |seconds: &mut Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        let ns = seconds[ROUNDS / 2] * 1e9 / STATES as f64;
        json!((ns * 10.0).round() / 10.0)
    };
    let mut medians: Map<String, Value> =
        contenders.iter().map(|contender| contender.name.to_string()).zip(seconds.iter_mut().map(median)).collect();
    let [ns, ns_batch] = ["mbs", "mbs_batch"].map(|name| medians.shift_remove(name));
    json!({ "ns": ns, "ns_batch": ns_batch, "rivals": medians })
}

fn table(functions: &Value) -> String {
    let rivals = ["custom_newton_euler", "custom_vector_sines", "featherstone_nalgebra", "custom_lanes"];
    let mut text = format!("{:18} {:>7} {:>7}", "ns a state", "mbs", "batch");
    for rival in rivals {
        text += &format!(" {rival:>24}");
    }
    text += "\n";
    for (function, times) in functions.as_object().into_iter().flatten() {
        let [ns, ns_batch] = ["ns", "ns_batch"].map(|key| times[key].as_f64().unwrap_or(f64::NAN));
        text += &format!("{function:18} {ns:7.1} {ns_batch:7.1}");
        for name in rivals {
            let ours = if name == "custom_lanes" { ns_batch } else { ns };
            let cell = match times["rivals"][name].as_f64() {
                Some(rival) => format!("{rival:.1} (mbs {:.2})", ours / rival),
                None => String::new(),
            };
            text += &format!(" {cell:>24}");
        }
        text += "\n";
    }
    let sines = &functions["inverse_dynamics"]["rivals"];
    if let (Some(plain), Some(vector)) = (sines["custom_newton_euler"].as_f64(), sines["custom_vector_sines"].as_f64())
    {
        text += &format!("\ninverse dynamics, sines from one call relative to one by one: {:.2}\n", vector / plain);
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

impl States {
    /// Angles in ±π, rates in ±2, accelerations in ±5, torques in ±100; the same in every run.
    fn random() -> States {
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
        let one_by_one: Vec<State<f64>> = (0..STATES).map(state).collect();
        let in_lanes = one_by_one.chunks(f64x4::COUNT).map(|states| {
            let pack = |numbers: &dyn Fn(&State<f64>) -> [f64; 6]| {
                std::array::from_fn(|i| <f64x4 as Lanes>::from_fn(|lane| numbers(&states[lane])[i]))
            };
            State { q: pack(&|s| s.q), qd: pack(&|s| s.qd), qdd: pack(&|s| s.qdd), tau: pack(&|s| s.tau) }
        });
        States { in_lanes: in_lanes.collect(), one_by_one }
    }
}
