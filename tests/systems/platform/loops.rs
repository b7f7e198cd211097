//! The platform declared with closed loops, `stewart_platform_loops.mbs`, against the one in coordinates of the
//! platform: the same motion from 24 coordinates on 18 constraints. Its Programs are interpreted: nothing else needs
//! its 20 000 lines of code.

use std::ops::ControlFlow;

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::{declared, derived};
use mbs_platform::geometry::Geometry;
use mbs_platform::{Coordinates, HOME, LegVector, Motion, Platform};
use mbs_runtime::control::ComputedTorque;
use mbs_runtime::{Dop853, Dual, Integrator, Scalar, State};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;

use super::random_pose;

/// Platform, α, β and lengths of the legs.
type LoopCoordinates<T = f64> = [T; 24];

fn derivation() -> Derivation {
    let source = include_str!("../../platform/stewart_platform_loops.mbs");
    let graph = Graph::verbatim();
    let (lagrangian, warnings) =
        declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("loops", source)));
    assert_eq!(warnings.render("loops", source), "");
    let derivation = derived(&lagrangian);
    assert_eq!((derivation.dof(), derivation.constraints.len()), (24, 18));
    derivation
}

/// What the closed loops evaluate.
struct Loops<'d>(Interpreter<'d>);

impl Loops<'_> {
    fn call(&self, kind: FunctionKind, q: &LoopCoordinates, qd: &LoopCoordinates, u: &LegVector) -> Vec<f64> {
        let (q, qd, u) = (q.to_vec(), qd.to_vec(), u.to_vec());
        let state = interpret::State { t: 0.0, q, qd, qdd: vec![0.0; 24], u, prescribed: Vec::new() };
        self.0.call(kind, &state).expect("a mechanism with constraints has it")
    }

    fn accelerations(&self, q: &LoopCoordinates, qd: &LoopCoordinates, u: &LegVector) -> LoopCoordinates {
        self.call(FunctionKind::ForwardDynamics, q, qd, u).try_into().expect("24 accelerations")
    }

    /// The largest entry of φ and of A q̇.
    fn open(&self, state: &State<LoopCoordinates>) -> f64 {
        let largest =
            |kind| self.call(kind, &state.q, &state.qd, &[0.0; 6]).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        largest(FunctionKind::Constraint).max(largest(FunctionKind::ConstraintRate))
    }
}

/// All coordinates of the pose. The legs' direction is `(sin β, −sin α cos β, cos α cos β)`.
fn closed<T: Scalar>(geometry: &Geometry<T>, q: &Coordinates<T>) -> LoopCoordinates<T> {
    let legs = geometry.legs(q);
    std::array::from_fn(|i| match i {
        0..6 => q[i],
        6..12 => (-legs.direction[i - 6][1]).atan2(legs.direction[i - 6][2]),
        12..18 => legs.direction[i - 12][0].asin(),
        _ => legs.length[i - 18],
    })
}

/// The state of all bodies that goes with one of the platform.
fn consistent(platform: &Platform, q: &Coordinates, qd: &Coordinates) -> State<LoopCoordinates> {
    let lift = |joints: &[[f64; 3]; 6]| joints.map(|joint| joint.map(Dual::constant));
    let geometry = Geometry { base: lift(&platform.geometry().base), platform: lift(&platform.geometry().platform) };
    let all = closed(&geometry, &std::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] }));
    State::new(all.map(|x| x.value), all.map(|x| x.derivative))
}

#[test]
fn accelerations_agree() {
    let (platform, derivation) = (Platform::default(), derivation());
    let (loops, mut random) = (Loops(Interpreter::new(&derivation)), Random::new(11));
    for _ in 0..100 {
        let (q, qd) = (random_pose(&mut random), random.array(-1.0..1.0));
        let forces: LegVector = random.array(-3000.0..3000.0);
        let state = consistent(&platform, &q, &qd);
        assert!(loops.open(&state) < 1e-14, "consistent");
        let found = loops.accelerations(&state.q, &state.qd, &forces);
        let want = platform.accelerations(&q, &qd, &forces).unwrap();
        assert_close("accelerations of the platform", &found[..6], &want, 1e-9);
        // Those of the lengths follow: J_q q̈ + J̇_q q̇, as of the motion of the joints along the legs.
        for leg in 0..6 {
            let motion = platform.spherical_leg(leg, &q, &qd, &want).unwrap();
            assert_close("accelerations of the legs", &[found[18 + leg]], &[motion.acceleration[0]], 1e-9);
        }
        let energy = loops.call(FunctionKind::KineticEnergy, &state.q, &state.qd, &forces)[0];
        assert_close("T", &[energy], &[platform.model().kinetic_energy(&q, &qd)], 1e-13);
    }
}

fn integrate<const N: usize>(
    end: f64,
    state: &mut State<[f64; N]>,
    mut accelerations: impl FnMut(f64, &[f64; N], &[f64; N]) -> [f64; N],
) {
    let motion = |t: f64, q: &[f64; N], qd: &[f64; N], qdd: &mut [f64; N]| *qdd = accelerations(t, q, qd);
    Dop853::new(1e-13, 1e-14)
        .integrate(motion, 0.0, end, state, |_| ControlFlow::Continue(()))
        .expect("a smooth motion");
}

/// Both declarations under `forces(t, q, q̇)` of the platform's state, and how far their platforms are apart in the
/// end.
fn apart(
    end: f64,
    start: [Coordinates; 2],
    forces: impl Fn(&Platform, f64, &Coordinates, &Coordinates) -> LegVector,
) -> f64 {
    let (platform, derivation) = (Platform::default(), derivation());
    let loops = Loops(Interpreter::new(&derivation));
    let mut task = State::new(start[0], start[1]);
    let mut all = consistent(&platform, &start[0], &start[1]);
    integrate(end, &mut task, |t, q, qd| platform.accelerations(q, qd, &forces(&platform, t, q, qd)).unwrap());
    let six = |x: &LoopCoordinates| -> Coordinates { std::array::from_fn(|i| x[i]) };
    integrate(end, &mut all, |t, q, qd| loops.accelerations(q, qd, &forces(&platform, t, &six(q), &six(qd))));
    println!("loops open by {:e} after {end} s", loops.open(&all));
    assert!(loops.open(&all) < 1e-9, "the loops stay closed");
    let moved = (0..6).map(|i| (task.q[i] - start[0][i]).abs()).fold(0.0, f64::max);
    assert!(moved > 0.01, "it moves by {moved}");
    let difference = |a: &Coordinates, b: &Coordinates| (0..6).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    difference(&task.q, &six(&all.q)).max(difference(&task.qd, &six(&all.qd)))
}

/// The forces of the combined motion, given as functions of time, from a state beside that motion.
#[test]
fn open_loop_motions_agree() {
    let motion = Motion::COMBINED;
    let [mut q, qd, _] = motion.at(0.0);
    q[0] += 0.01;
    let apart = apart(0.5, [q, qd], |platform, t, _, _| {
        let [q, qd, qdd] = motion.at(t);
        platform.leg_forces(&q, &qd, &qdd).unwrap()
    });
    println!("{apart:e}");
    assert!(apart < 1e-9, "{apart:e}");
}

#[test]
fn controlled_motions_agree() {
    let control = ComputedTorque::critically_damped(5.0).unwrap();
    let apart = apart(4.0, [HOME, [0.0; 6]], |platform, t, q, qd| {
        platform.computed_forces(&control, &Motion::COMBINED.at(t), q, qd).unwrap()
    });
    println!("{apart:e}");
    assert!(apart < 1e-8, "{apart:e}");
}
