//! `reaction`: forces and moments of joints against Newton–Euler and against free bodies by hand; what they cost, and
//! that they cost nothing else.

use mbs_derive::derive::Route;
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State as Arguments};
use mbs_derive::optimise::{Derivation, FunctionKind, Instruction, by_route};
use mbs_derive::verify::Proof;
use mbs_derive::{declared, derived};
use mbs_runtime::Wrench;
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms as written;
use mbs_tests::random::{Random, State, positive, states};
use mbs_tests::reference::arms::arm6;
use mbs_tests::reference::four_bar::FourBar;
use mbs_tests::{named, source};
use nalgebra::{Rotation3, Vector3};

const TOLERANCE: f64 = 1e-9;

fn derivation(source: &str) -> Derivation {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", source)));
    let derivation = derived(&lagrangian);
    Proof::of(&lagrangian, &derivation).unwrap_or_else(|e| panic!("{source}\n{e}"));
    derivation
}

/// Force and moment in the axes that the rotation is from.
fn in_axes(rotation: &Rotation3<f64>, force: Vector3<f64>, moment: Vector3<f64>) -> [f64; 6] {
    let (force, moment) = (rotation.inverse() * force, rotation.inverse() * moment);
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}

fn flat(wrench: Wrench<f64>) -> [f64; 6] {
    let ([fx, fy, fz], [mx, my, mz]) = (wrench.force, wrench.moment);
    [fx, fy, fz, mx, my, mz]
}

// ---- trees

#[test]
fn the_arm_has_the_joint_wrenches_of_newton_and_euler() {
    let generated = written::arm_with_reactions::ArmWithReactions::<f64>::default();
    let arm = arm6();
    for State { q, qd, qdd } in states::<6>(51, 120) {
        let found = generated.joint(&q, &qd, &qdd);
        let (wrenches, axes) = (arm.joint_wrenches(&q, &qd, &qdd), arm.joint_rotations(&q));
        for i in 0..6 {
            let (force, moment) = wrenches[i];
            let expected = in_axes(&Rotation3::from_matrix_unchecked(axes[i]), force, moment);
            assert_close(&format!("joint {i} at {q:?}"), &flat(found[i]), &expected, TOLERANCE);
        }
        // Along the joints' axes they are the torques of the motors.
        let torques = generated.inverse_dynamics(&q, &qd, &qdd);
        assert_close("torques", &found.map(|wrench| wrench.moment[2]), &torques, TOLERANCE);
    }
}

/// A `reaction` changes nothing else: names, operations and programs of all other functions are the same.
#[test]
fn reactions_cost_nothing_but_themselves() {
    for module in ["arm_with_reactions", "driven_dampers", "four_bar_with_reactions", "sprung_trolley"] {
        let source = source(mbs_models::SOURCES, module);
        let is_reaction = |line: &&str| line.trim_start().starts_with("reaction ");
        let without: Vec<&str> = source.lines().filter(|line| !is_reaction(line)).collect();
        let (with, without) = (derivation(source), derivation(&without.join("\n")));
        let others: Vec<_> = with.functions.iter().filter(|f| !matches!(f.kind, FunctionKind::Reaction(_))).collect();
        assert_eq!(others.len(), without.functions.len(), "{module}");
        assert!(others.len() < with.functions.len(), "{module} has reactions");
        for (with, without) in others.into_iter().zip(&without.functions) {
            assert_eq!((&with.name, with.operations), (&without.name, without.operations), "{module}");
            assert_eq!(with.program, without.program, "{module}: {}", with.name);
        }
    }
    // The arm of the benchmark, its poses named.
    let operations = |derivation: &Derivation, name: &str| derivation.named(name).map(|f| f.operations);
    let (arm, with) = (
        derivation(source(mbs_models::SOURCES, "arm6")),
        derivation(source(mbs_models::SOURCES, "arm_with_reactions")),
    );
    for function in &arm.functions {
        assert_eq!(Some(function.operations), operations(&with, &function.name), "{}", function.name);
    }
}

/// All six wrenches, of which inverse dynamics is a part, for less than a third more.
#[test]
fn budget_of_the_arm() {
    let arm = derivation(source(mbs_models::SOURCES, "arm_with_reactions"));
    let joints = arm.named("joint").expect("it is declared").operations.flops();
    let torques = arm.function(FunctionKind::InverseDynamics).expect("it is generated").operations.flops();
    assert!(joints <= 650 && 10 * joints < 14 * torques, "{joints} and {torques}");
}

#[test]
fn a_pendulum_pulls_at_its_hinge() {
    let pendulum = derivation(
        "mechanism Pendulum { param m: kg = 3; param l: m = 2; param g: m/s^2 = 10; param b: N*m*s = 0.5; coord theta: rad; \
         input tau: N*m; let link = rot_y(-theta); reaction hinge at link; let bob = link.point([0, 0, -l]); \
         kinetic += particle(m, bob); potential += m*g*bob.z; dissipation += 1/2*b*dt(theta)^2; force theta += tau; }",
    );
    let (m, l, g) = (3.0, 2.0, 10.0);
    let interpreter = Interpreter::new(&pendulum);
    for State { q: [theta], qd: [omega], qdd: [alpha] } in states::<1>(52, 40) {
        let state =
            Arguments { q: vec![theta], qd: vec![omega], qdd: vec![alpha], u: vec![0.7], ..Arguments::default() };
        let found = named(&interpreter, "hinge", &state).expect("it is generated");
        // Across the thread, and along it: the weight and the centripetal force.
        let (across, along) = (m * (l * alpha + g * theta.sin()), m * (g * theta.cos() + l * omega * omega));
        assert_close("hinge", &found, &[across, 0.0, along, 0.0, -l * across, 0.0], 1e-13);
        // In its motion the hinge transmits the torques about it, and nothing else about its axis.
        let qdd = interpreter.call(FunctionKind::ForwardDynamics, &state).expect("it is generated");
        let found = named(&interpreter, "hinge", &Arguments { qdd, ..state }).expect("it is generated");
        assert_close("torque", &found[4..5], &[-(0.7 - 0.5 * omega)], 1e-12);
    }
}

/// What hangs at rest, by the balance of forces and moments alone.
#[test]
fn masses_hang() {
    use written::hanging_masses::{HangingMasses, Params};
    for seed in 0..6 {
        let [m0, m1, m2, g, reach, height, load] = positive(80 + seed);
        let place = Random::new(seed).array(-2.0..2.0);
        let hanging = HangingMasses::new(Params { m: [m0, m1, m2], place, reach, height, g });
        let (q, zero, weight) = ([0.4, 1.1], [0.0; 2], (m0 + m1 + m2) * g);
        let threads = hanging.thread(&q, &zero, &zero).map(flat);
        assert_close("thread", &threads[0], &[0.0, 0.0, (m1 + m2) * g, 0.0, 0.0, 0.0], 1e-14);
        assert_close("thread", &threads[1], &[0.0, 0.0, m2 * g, 0.0, 0.0, 0.0], 1e-14);
        // The axes of the bracket are turned by a quarter: its x is the world's y.
        let weld = hanging.weld(&q, &zero, &zero, &[load]);
        assert_close("weld", &flat(weld), &[0.0, load, weight, 0.0, 0.0, 0.0], 1e-14);
        let foot = hanging.foot(&q, &zero, &zero, &[load]);
        assert_close("foot", &flat(foot), &[-load, 0.0, weight, reach * weight, 0.0, reach * load], 1e-14);
        let shifted = foot.about([0.0, reach, 0.0]);
        assert_close("about the weld", &shifted.moment, &[0.0; 3], 1e-13);
    }
}

/// A spring across the hinge, friction in it, a force and a torque behind it: the free body of the rod, then of both.
#[test]
fn a_spring_bridges_a_joint() {
    use written::sprung_trolley::{Params, SprungTrolley};
    for (seed, State { q, qd, qdd }) in (0..).zip(states::<2>(53, 40)) {
        let [m_trolley, m, l, moment, g, k, rest, b] = positive(90 + seed);
        let trolley = SprungTrolley::new(Params { m_trolley, m, l, moment, g, k, rest, b });
        let [push, fx, fz, turn]: [f64; 4] = Random::new(seed).array(-5.0..5.0);
        let (theta, [_, omega], [acceleration, alpha]) = (q[1], qd, qdd);
        let along = Vector3::new(theta.cos(), 0.0, theta.sin());
        let across = Vector3::new(-theta.sin(), 0.0, theta.cos());
        let centre = along * (l / 2.0);
        let of_centre = Vector3::x() * acceleration + (across * alpha - along * (omega * omega)) * (l / 2.0);
        // From the trolley's end to the rod's; it pulls the rod back.
        let spring = centre - Vector3::new(0.2 * l, 0.0, 0.6 * l);
        let pull = -spring * (k * (1.0 - rest / spring.norm()));
        let (tip, weight) = (Vector3::new(fx, 0.0, fz), Vector3::z() * (-m * g));
        let force = of_centre * m - weight - pull - tip;
        // θ turns x towards z: against y.
        let spin = Vector3::y() * (-moment * alpha);
        let applied = centre.cross(&(pull + weight)) + (along * l).cross(&tip) + Vector3::y() * turn;
        let about_hinge = spin + centre.cross(&(of_centre * m)) - applied;
        let u = [push, fx, fz, turn];
        let found = flat(trolley.hinge(&q, &qd, &qdd, &u));
        let axes = Rotation3::from_axis_angle(&Vector3::y_axis(), -theta);
        assert_close("hinge", &found, &in_axes(&axes, force, about_hinge), TOLERANCE);
        // The spring is inside of trolley and rod.
        let all = force + pull + Vector3::new(m_trolley * acceleration - push, 0.0, m_trolley * g);
        let anchor = Vector3::new(0.2 * l, 0.0, 0.6 * l);
        let about_trolley = about_hinge + anchor.cross(&pull);
        let found = flat(trolley.rail(&q, &qd, &qdd, &u));
        assert_close("rail", &found, &in_axes(&Rotation3::identity(), all, about_trolley), TOLERANCE);
        // In the motion itself the hinge transmits its friction, and nothing else about its axis.
        let qdd = trolley.forward_dynamics(&q, &qd, &u);
        let found = trolley.hinge(&q, &qd, &qdd, &u);
        assert_close("friction", &[found.moment[1]], &[b * omega], 1e-8);
    }
}

// ---- loops

/// Each bar by itself: the hinge of coupler and rocker pulls by the multipliers, the others by their reactions.
#[test]
fn bars_of_a_loop_are_free_bodies() {
    use written::four_bar_with_reactions::{FourBarWithReactions, Params};
    let (m, l, ground, g, tau) = ([0.3, 0.8, 0.5], [0.2, 0.65, 0.5], 0.55, 9.81, 0.4);
    let by_hand = FourBar { m, l, ground, g, tau };
    let generated = FourBarWithReactions::new(Params { m, l, ground, g });
    for step in 0..24 {
        let (crank, rate) = (0.1 + 0.26 * f64::from(step), 3.0 - 0.2 * f64::from(step));
        // Of the coupler the angle from the crank.
        let relative = |[a, b, c]: [f64; 3]| [a, b - a, c];
        let angles = by_hand.closed(crank).expect("the crank turns all the way round");
        let rates = by_hand.closed_rates(&angles, rate);
        let (q, qd) = (relative(angles), relative(rates));
        let qdd = generated.forward_dynamics(&q, &qd, &[tau]);
        let multipliers = generated.multipliers(&q, &qd, &[tau]);
        let accelerations = [qdd[0], qdd[0] + qdd[1], qdd[2]];
        let along = |i: usize| Vector3::new(angles[i].cos(), 0.0, angles[i].sin());
        let across = |i: usize| Vector3::new(-angles[i].sin(), 0.0, angles[i].cos());
        // The acceleration of a point at a distance from the near end of a bar, less that of the end.
        let beyond = |i: usize, r: f64| (across(i) * accelerations[i] - along(i) * (rates[i] * rates[i])) * r;
        let knee = beyond(0, l[0]);
        let ends = [Vector3::zeros(), knee, Vector3::zeros()];
        // What a bar needs at its near end where a force acts on its far end.
        let needs = |i: usize, far: Vector3<f64>| {
            let centre = along(i) * (l[i] / 2.0);
            let inertial = (ends[i] + beyond(i, l[i] / 2.0) + Vector3::z() * g) * m[i];
            let spin = Vector3::y() * (-m[i] * l[i] * l[i] / 12.0 * accelerations[i]);
            (inertial - far, spin + centre.cross(&inertial) - (along(i) * l[i]).cross(&far))
        };
        let pull = Vector3::new(multipliers[0], 0.0, multipliers[1]);
        let (knee_force, knee_moment) = needs(1, pull);
        let (base_force, base_moment) = needs(0, -knee_force);
        let (pivot_force, pivot_moment) = needs(2, -pull);
        let axes = |i: usize| Rotation3::from_axis_angle(&Vector3::y_axis(), -angles[i]);
        let close = |what: &str, found: Wrench<f64>, i: usize, force, moment| {
            assert_close(what, &flat(found), &in_axes(&axes(i), force, moment), TOLERANCE);
        };
        close("knee", generated.knee(&q, &qd, &qdd, &multipliers), 1, knee_force, knee_moment);
        close("base", generated.base(&q, &qd, &qdd, &multipliers), 0, base_force, base_moment);
        close("pivot", generated.pivot(&q, &qd, &qdd, &multipliers), 2, pivot_force, pivot_moment);
        // Hinges are free: about their axes there is the motor's torque at the base, and nothing elsewhere.
        assert_close("about the axes", &[knee_moment.y, base_moment.y, pivot_moment.y], &[0.0, -tau, 0.0], TOLERANCE);
    }
}

/// A disk that rolls: the floor holds it sideways by the multipliers, and up by the coordinate that there is not.
#[test]
fn a_rolling_disk_rests_on_the_floor() {
    let disk = derivation(
        "mechanism RollingDisk { param m: kg = 1.3; param radius: m = 0.3; param g: m/s^2 = 9.81; \
         coord x: m; coord y: m; coord heading: rad; coord lean: rad; coord spin: rad; \
         let frame = translation([x, y, radius*cos(lean)]) * rot_z(heading) * rot_x(lean); let disk = frame * rot_y(spin); \
         reaction axle at disk; \
         kinetic += rigid_body(m, [0, 0, 0], diag(1, 2, 1)*m*radius^2/4, disk); potential += m*g*disk.origin().z; \
         constraint rolling: dt(disk.origin()) + angular_velocity(disk).cross(frame*[0, 0, -radius]) = 0; }",
    );
    let (m, radius, g) = (1.3, 0.3, 9.81);
    let interpreter = Interpreter::new(&disk);
    for State { q, qd, qdd } in states::<5>(54, 40) {
        let state = Arguments { q: q.to_vec(), qd: qd.to_vec(), qdd: qdd.to_vec(), ..Arguments::default() };
        let axle = disk.named("axle").expect("it is generated");
        let multipliers = [1.7, -0.4];
        let found = interpreter.evaluate_with(axle, &state, &multipliers);
        let up = -radius * (q[3].sin() * qdd[3] + q[3].cos() * qd[3] * qd[3]);
        let force = Vector3::new(qdd[0], qdd[1], up + g) * m - Vector3::new(multipliers[0], multipliers[1], 0.0);
        let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let axes = turn(Vector3::z_axis(), q[2]) * turn(Vector3::x_axis(), q[3]) * turn(Vector3::y_axis(), q[4]);
        assert_close("force", &found[..3], (axes.inverse() * force).as_slice(), TOLERANCE);
    }
}

/// Nothing holds a free body but what acts on it; its attitude is a quaternion, which takes the plain route.
#[test]
fn a_free_body_needs_no_reaction() {
    let body = derivation(
        "mechanism FreeBody { param m: kg = 2; coord r[3]: m; coord e[4]: 1; input torque_in[3]: N*m; input f[3]: N; \
         let body = translation(r) * quaternion(e[0], e[1], e[2], e[3]); reaction nothing at body; \
         const tensor: kg*m^2 = [[0.03, 0.001, 0], [0.001, 0.04, 0], [0, 0, 0.05]]; const arm: m = 0.2; \
         kinetic += rigid_body(m, [0, arm, 0], tensor, body); torque on body += body * torque_in; \
         force at body.point([arm, 0, 0]) += f; constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1; }",
    );
    let interpreter = Interpreter::new(&body);
    let mut random = Random::new(55);
    for _ in 0..20 {
        let (r, e, v, w): ([f64; 3], [f64; 4], [f64; 3], [f64; 4]) =
            (random.array(-1.0..1.0), random.array(-1.0..1.0), random.array(-1.0..1.0), random.array(-1.0..1.0));
        let (norm, along) =
            (e.iter().map(|c| c * c).sum::<f64>().sqrt(), e.iter().zip(w).map(|(e, w)| e * w).sum::<f64>());
        let rates = (0..4).map(|i| (w[i] - along * e[i] / (norm * norm)) / norm);
        let q = r.into_iter().chain(e.map(|c| c / norm)).collect();
        let qd = v.into_iter().chain(rates).collect();
        let u = random.array::<6>(-2.0..2.0).to_vec();
        let state = Arguments { q, qd, u, ..Arguments::default() };
        let qdd = interpreter.call(FunctionKind::ForwardDynamics, &state).expect("it is generated");
        let found = named(&interpreter, "nothing", &Arguments { qdd, ..state }).expect("it is generated");
        assert_close("no reaction", &found, &[0.0; 6], TOLERANCE);
    }
}

// ---- how

/// Each route by itself; the proof sees the cheapest one alone.
#[test]
fn all_routes_agree() {
    for module in
        ["arm_with_reactions", "driven_dampers", "four_bar_with_reactions", "sprung_trolley", "hanging_masses"]
    {
        let verbatim = Graph::verbatim();
        let (lagrangian, _) =
            declared(source(mbs_models::SOURCES, module), &verbatim, &[]).expect("a mechanism of the repository");
        let routes: Vec<_> = Route::ALL
            .into_iter()
            .flat_map(|route| by_route(&lagrangian, route).into_iter().map(move |alone| (route, alone)))
            .collect();
        assert!(routes.len() >= 2, "{module}");
        let mut random = Random::new(56);
        let n = lagrangian.dof();
        let mut numbers = |count: usize| (0..count).map(|_| random.uniform(-1.0..1.0)).collect::<Vec<_>>();
        let state = Arguments { q: numbers(n), qd: numbers(n), qdd: numbers(n), u: numbers(6), ..Arguments::default() };
        let values = |derivation: &Derivation| {
            let interpreter = Interpreter::new(derivation);
            let reactions = derivation.functions.iter().filter(|f| matches!(f.kind, FunctionKind::Reaction(_)));
            reactions.flat_map(|f| interpreter.evaluate_with(f, &state, &[1.3, -0.8])).collect::<Vec<_>>()
        };
        let first = values(&routes[0].1);
        for (route, alone) in &routes[1..] {
            assert_close(&format!("{module}, {route}"), &values(alone), &first, TOLERANCE);
        }
    }
}

/// A reaction that is wrong is not generated.
#[test]
fn a_wrong_reaction_is_found_out() {
    let graph = Graph::verbatim();
    let (lagrangian, _) =
        declared(source(mbs_models::SOURCES, "four_bar_with_reactions"), &graph, &[]).expect("a mechanism");
    let mut derivation = derived(&lagrangian);
    let knee = derivation.altered().functions.iter_mut().find(|f| f.name == "knee").expect("it is generated");
    let mut results = knee.program.results.iter().map(|value| value.index());
    let sum = |i: &usize| matches!(knee.program.instructions[*i], Instruction::Add(..) | Instruction::Sub(..));
    let number = results.find(sum).expect("some component is a sum");
    knee.program.instructions[number] = match knee.program.instructions[number] {
        Instruction::Add(a, b) => Instruction::Sub(a, b),
        Instruction::Sub(a, b) => Instruction::Add(a, b),
        other => other,
    };
    let failure = Proof::of(&lagrangian, &derivation).expect_err("it is wrong");
    assert!(failure.to_string().contains("claim: reactions"), "{failure}");
}
