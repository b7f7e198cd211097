//! The mechanism `irb7600_rail`, and its kinematics.

use std::array::from_fn;

use mbs_arm::Arm;
use mbs_arm::trajectory::cartesian::branch_of;
use mbs_landing::experiment::rail_arm::{FlangeMotion, RailArm, angles};
use mbs_models::irb7600::Irb7600;
use mbs_models::irb7600_rail::{Irb7600Rail, Params};
use mbs_runtime::Dual;
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::arms;

/// The arm with nothing at its flange.
fn unloaded() -> Irb7600Rail<f64> {
    Irb7600Rail::new(Params { module_mass: 0.0, module_inertia: [0.0; 3], ..Params::default() })
}

fn on_rail(rail: f64, joints: [f64; 6]) -> [f64; 7] {
    from_fn(|axis| if axis == 0 { rail } else { joints[axis - 1] })
}

#[test]
fn a_carriage_without_acceleration_is_not_felt() {
    let (alone, rail) = (Irb7600::<f64>::default(), unloaded());
    let mut random = Random::new(61);
    for _ in 0..200 {
        let [q, qd, qdd] = [(); 3].map(|()| random.array::<6>(-3.0..3.0));
        let (place, speed) = (random.uniform(0.0..22.0), random.uniform(-1.2..1.2));
        let forces = rail.inverse_dynamics(&on_rail(place, q), &on_rail(speed, qd), &on_rail(0.0, qdd));
        assert_close("torques", &angles(&forces), &alone.inverse_dynamics(&q, &qd, &qdd), 1e-12);
    }
}

/// In the axes of an accelerated carriage the arm weighs as under a gravity of `(−a, 0, −g)`, by Newton and Euler.
#[test]
fn an_accelerated_carriage_is_a_tilted_gravity() {
    let rail = unloaded();
    let mut random = Random::new(62);
    for _ in 0..200 {
        let [q, qd, qdd] = [(); 3].map(|()| random.array::<6>(-3.0..3.0));
        let a = random.uniform(-5.0..5.0);
        let mut arm = arms::irb7600();
        arm.gravity[0] = -a;
        let forces = rail.inverse_dynamics(&on_rail(3.0, q), &on_rail(0.4, qd), &on_rail(a, qdd));
        assert_close("torques", &angles(&forces), &arm.newton_euler(&q, &qd, &qdd), 1e-11);
        // What the carriage pushes the arm with, and what moves itself.
        let push = arm.joint_wrenches(&q, &qd, &qdd)[0].0.x + rail.params().carriage_mass * a;
        assert_close("drive", &[forces[0]], &[push], 1e-11);
    }
}

/// Newton's law of the mass centre of everything: `Σ mᵢ ẍᵢ` is the force of the drive, the only one along the rail.
#[test]
fn the_drive_moves_the_mass_centre() {
    let rail = Irb7600Rail::<f64>::default();
    let (params, arm) = (rail.params(), Irb7600::<Dual<f64>>::default());
    let mut random = Random::new(63);
    for _ in 0..100 {
        let [q, qd, qdd] = [(); 3].map(|()| random.array::<6>(-3.0..3.0));
        let a = random.uniform(-2.0..2.0);
        let dual = |value: &[f64; 6], derivative: &[f64; 6]| -> [Dual<f64>; 6] {
            from_fn(|i| Dual { value: value[i], derivative: derivative[i] })
        };
        let (moving, rates) = (dual(&q, &qd), dual(&qd, &qdd));
        let velocities = [
            arm.center_0_velocity(&moving, &rates),
            arm.center_1_velocity(&moving, &rates),
            arm.center_2_velocity(&moving, &rates),
            arm.center_3_velocity(&moving, &rates),
            arm.center_4_velocity(&moving, &rates),
            arm.center_5_velocity(&moving, &rates),
            arm.flange_velocity(&moving, &rates),
        ];
        let masses = from_fn::<f64, 7, _>(|i| if i < 6 { params.mass[i] } else { params.module_mass });
        let links: f64 = (0..7).map(|i| masses[i] * (velocities[i][0].derivative + a)).sum();
        let forces = rail.inverse_dynamics(&on_rail(9.0, q), &on_rail(0.3, qd), &on_rail(a, qdd));
        assert_close("drive", &[forces[0]], &[links + params.carriage_mass * a], 1e-12);
    }
}

/// From axes to the flange and back, away from singularities.
#[test]
fn the_axes_follow_the_flange() {
    let (robot, arm) = (RailArm::default(), Arm::default());
    let mut random = Random::new(64);
    let mut compared = 0;
    while compared < 200 {
        let q = random.array::<6>(-2.5..2.5);
        let margin = mbs_arm::jacobian::determinant_factors(&q).margin();
        if margin < 0.05 {
            continue;
        }
        compared += 1;
        let [qd, qdd] = [(); 2].map(|()| random.array::<6>(-1.0..1.0));
        let pose = arm.pose(&q);
        let (place, [speed, acceleration]) = (random.uniform(2.0..20.0), random.array::<2>(-1.0..1.0));
        // The stand-off must be what the posture has, and stay so.
        let standoff = pose.position[0];
        let jacobian = arm.jacobian(&q);
        let moving = from_fn(|i| Dual { value: q[i], derivative: qd[i] });
        let turning = Irb7600::<Dual<f64>>::default().flange_jacobian(&moving);
        let twist: [f64; 6] = from_fn(|i| (0..6).map(|j| jacobian[i][j] * qd[j]).sum());
        let rate: [f64; 6] =
            from_fn(|i| (0..6).map(|j| jacobian[i][j] * qdd[j] + turning[i][j].derivative * qd[j]).sum());
        let mut flange = FlangeMotion { pose, twist, twist_rate: rate };
        flange.pose.position[0] += place;
        flange.twist[0] += speed;
        flange.twist_rate[0] += acceleration;
        let state = robot.follow(&flange, standoff, branch_of(&q)).expect("on this branch");
        assert_close("q", &state.q, &on_rail(place, q), 1e-9);
        // The carriage takes all that goes along the rail; with it the flange moves as it is to.
        assert_eq!((state.qd[0], state.qdd[0]), (flange.twist[0], flange.twist_rate[0]));
        assert_close("twist", &robot.model.flange_velocity(&state.q, &state.qd), &flange.twist, 1e-10);
        let (jacobian, rates) =
            (robot.model.flange_jacobian(&state.q), robot.model.flange_jacobian_rate(&state.q, &state.qd));
        let found: [f64; 6] =
            from_fn(|i| (0..7).map(|j| jacobian[i][j] * state.qdd[j] + rates[i][j] * state.qd[j]).sum());
        assert_close("rate of the twist", &found, &flange.twist_rate, 1e-9);
    }
}
