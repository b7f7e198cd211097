//! The peg and the hole: contact against energies and statics by hand, Whitney's limits against equilibrium, the cell
//! against springs in series.

use std::ops::ControlFlow;

use mbs_arm::assembly::cell::{NUMBERS, Numbers};
use mbs_arm::assembly::{Cell, Contact, Hole, Impedance, Peg, PegMotion, Task, Wanted, Wrist, whitney};
use mbs_models::check::Must;
use mbs_models::scara::{Params, Scara};
use mbs_runtime::{Dopri5, Integrator, State};
use mbs_tests::random::Random;

const PEG: Peg = Peg { radius: 0.010, mass: 0.5, inertia: 5e-4, centre: 0.04 };
const MOUTH: [f64; 2] = [0.5, 0.7];
const STILL: PegMotion = PegMotion { centre: [0.0; 2], tilt: 0.0 };
/// The tip stands so far below the flange \[m\].
const LENGTH: f64 = 0.1;
/// Smooths friction \[m/s\].
const CREEP: f64 = 2e-5;

fn cell(wrist_centre: f64, friction: f64, clearance: f64) -> Cell {
    let params = Params::default();
    Cell {
        scara: Scara::new(params),
        params,
        wrist: Wrist {
            stiffness: [2e4, 1e6, 150.0],
            damping: [10.0, 40.0, 0.03],
            centre: wrist_centre,
            length: LENGTH,
        },
        peg: PEG,
        hole: Hole { radius: PEG.radius + clearance, chamfer: [2e-3, 3e-3], place: MOUTH, tilt: 0.0 },
        contact: Contact { stiffness: 2e7, damping: 50.0, friction, creep_speed: CREEP },
        control: Impedance { stiffness: [2e5, 2e5, 2e5, 500.0], damping: [200.0, 200.0, 200.0, 6.0] },
    }
}

/// With the tip at `x` and `over` above the edge, down at a constant speed for `time`; dampers are weak and it is slow.
fn lowered(cell: &Cell, x: f64, over: f64, speed: f64, time: f64) -> State<Numbers> {
    let flange = [x, 0.0, MOUTH[1] + LENGTH + over];
    let wanted = |t: f64| -> Wanted { [[x, 0.0, flange[2] - speed * t], [0.0, 0.0, -speed], [0.0; 3]] };
    let mut state = cell.rest(flange).unwrap();
    (state.qd[2], state.qd[6]) = (-speed, -speed);
    let moving =
        |t: f64, q: &Numbers, v: &Numbers, a: &mut Numbers| *a = cell.accelerations(&wanted(t), &[0.0; 3], q, v);
    let integrator = Dopri5::new(1e-8, 1e-10);
    integrator.integrate(moving, 0.0, time, &mut state, |_| ControlFlow::Continue(())).unwrap();
    state
}

/// Springs one after the other.
fn series(first: f64, second: f64) -> f64 {
    1.0 / (1.0 / first + 1.0 / second)
}

/// Without friction and damping forces are the gradient of the energy, by central differences.
#[test]
fn contact_forces_are_the_gradient_of_their_energy() {
    let mut random = Random::new(17);
    let contact = Contact { stiffness: 1e6, damping: 0.0, friction: 0.0, creep_speed: 1e-3 };
    let hole = Hole { radius: 0.0101, chamfer: [2e-3, 3e-3], place: MOUTH, tilt: 0.03 };
    let mut touching = [0; 4];
    for _ in 0..4000 {
        let mut number = |most: f64| random.uniform(-most..most);
        let at = PegMotion {
            centre: [MOUTH[0] + number(3e-3), MOUTH[1] + PEG.centre + number(2e-2)],
            tilt: hole.tilt + number(0.03),
        };
        let forces = contact.forces(&PEG, &hole, &at, &STILL);
        (0..4).for_each(|i| touching[i] += i32::from(forces.normal[i] > 0.0));
        let energy = |i: usize, by: f64| {
            let mut moved = at;
            if i < 2 {
                moved.centre[i] += by
            } else {
                moved.tilt += by
            }
            contact.forces(&PEG, &hole, &moved, &STILL).energy
        };
        // A step across a corner of a face is off by as much as the step times the stiffness.
        for (i, step) in [1e-8, 1e-8, 1e-7].into_iter().enumerate() {
            let want = (energy(i, -step) - energy(i, step)) / (2.0 * step);
            assert!((forces.generalized[i] - want).abs() < 0.02, "{i} {at:?}: {} {want}", forces.generalized[i]);
        }
    }
    assert!(touching.iter().all(|&count| count > 200), "{touching:?}");
}

/// The corner goes down the chamfer: two springs and a moment, typed by hand, with the place on the plane kept.
#[test]
fn chamfer_crossing_is_as_statics_has_it() {
    for friction in [0.0, 0.2] {
        let cell = cell(0.0, friction, 5e-5);
        let aside = 1.5e-3;
        let ([w, h], r) = (cell.hole.chamfer, PEG.radius);
        let length = w.hypot(h);
        // The undeflected corner meets the chamfer where its line is.
        let (over, speed, time) = (3e-3, 1e-3, 1.5);
        let beyond = aside - 5e-5;
        let sag = PEG.mass * cell.params.g / 1e6;
        let depth = (beyond * h - (over - speed * time - sag) * w) / length;
        let state = lowered(&cell, MOUTH[0] + aside, over, speed, time);
        let touch = cell.touch(&state.q, &state.qd);
        let (side, up) = ((h - friction * w) / length, (w + friction * h) / length);
        let angular = 150.0 - PEG.mass * cell.params.g * PEG.centre;
        let gives = h / length * side / series(2e4, 2e5) + w / length * up * (1.0 / series(1e6, 2e5) + r * r / angular);
        let want = depth / (gives + 1.0 / 2e7);
        let found = touch.normal[1];
        assert!(touch.normal[0] == 0.0 && touch.normal[3] == 0.0, "{touch:?}");
        assert!((found / want - 1.0).abs() < 0.01, "{friction}: {found} {want}");
        let [x, z, _] = touch.generalized;
        assert!((-z / x - up / side).abs() < 1e-3 * up / side, "{friction}: {x} {z}");
        let push = cell.wrist_force(&state.q, &state.qd);
        assert!((push[0] + x).abs() < 0.02 * x.abs(), "at rest to the side: {push:?} {x}");
    }
}

/// The edge on the side of the peg: Whitney's one-point contact.
#[test]
fn one_point_contact_is_as_whitney_has_it() {
    for (friction, centre) in [(0.0, 0.03), (0.25, 0.03), (0.25, 0.0)] {
        let (clearance, speed) = (1e-3, 5e-3);
        let mut cell = cell(centre, friction, clearance);
        cell.contact.creep_speed = 1e-4;
        let aside = 1.8e-3;
        let state = lowered(&cell, MOUTH[0] + aside, 5e-3, speed, 3.0);
        let touch = cell.touch(&state.q, &state.qd);
        // With the centre at the tip the peg turns towards the wall, and its corner rubs along the bore.
        let at_corner = touch.normal[1] > 0.0;
        assert_eq!(at_corner, centre == 0.0);
        let depth = if at_corner { 0.0 } else { touch.depth };
        assert!(touch.depth > 5e-3 && touch.normal.iter().filter(|&&n| n > 0.0).count() == 1, "{touch:?}");
        let (lateral, error) = (series(2e4, 2e5), aside - clearance);
        // The weight above the centre tips the peg; friction is smooth.
        let angular = 150.0 - PEG.mass * cell.params.g * (PEG.centre - centre);
        let rubs = friction * speed / f64::hypot(speed, cell.contact.creep_speed);
        let lever = centre - depth;
        let by_hand = error / (1.0 / lateral + lever * (lever - rubs * PEG.radius) / angular + 1.0 / 2e7);
        let found = touch.normal.iter().sum::<f64>();
        assert!((found / by_hand - 1.0).abs() < 5e-3, "{friction} {centre}: {found} {by_hand}");
        let whitney = whitney::one_point_force([lateral, 150.0], [centre, depth, PEG.radius], friction, [error, 0.0]);
        assert!((found / whitney - 1.0).abs() < 1e-2, "{friction} {centre}: {found} {whitney}");
    }
}

/// The peg goes on under a push if friction, fully mobilized at the two contacts that carry it, is less than the push.
#[test]
fn jamming_diagram_is_equilibrium() {
    let mut random = Random::new(1982);
    let (r, mut counts) = (PEG.radius, [0; 2]);
    for _ in 0..2000 {
        let (depth, friction) = (random.uniform(2e-3..4e-2), random.uniform(0.05..0.5));
        // Lateral force and moment at the tip, from x to z, for a push of 1 N down.
        let most = depth / (2.0 * r * friction);
        let (side, moment) = (random.uniform(-1.5..1.5) / friction, random.uniform(-2.5..2.5) * most * r);
        // Contacts: force to the side, and moment with its friction, of 1 N of normal force.
        let contacts = [-r, r, -r, r].map(|x| x * friction);
        let sides = [1.0, -1.0, 1.0, -1.0];
        let levers = [0.0, 0.0, -depth, depth];
        let pairs = [(0, 3), (1, 2), (0, 2), (1, 3)].into_iter().filter_map(|(i, j)| {
            let (a, b) = (contacts[i] + levers[i], contacts[j] + levers[j]);
            // sᵢ Nᵢ + sⱼ Nⱼ = −side, a Nᵢ + b Nⱼ = −moment
            let determinant = sides[i] * b - sides[j] * a;
            let first = (-side * b + moment * sides[j]) / determinant;
            let second = (-moment * sides[i] + side * a) / determinant;
            (first >= 0.0 && second >= 0.0).then_some(first + second)
        });
        let carried: Vec<f64> = pairs.collect();
        assert!(!carried.is_empty(), "{side} {moment}");
        let slides = carried.iter().all(|normal| friction * normal < 1.0);
        let jams = whitney::jams([side, moment / r], depth, r, friction);
        assert_eq!(jams, !slides, "{depth} {friction} {side} {moment}: {carried:?}");
        counts[usize::from(jams)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
}

/// Two forces that hold each other lie on the line between the contacts; each leans from its normal by that line.
#[test]
fn wedging_is_two_forces_on_one_line() {
    for (depth, friction) in [(1e-3, 0.1), (1.9e-3, 0.1), (2.1e-3, 0.1), (5.9e-3, 0.3), (6.1e-3, 0.3), (3e-2, 0.3)] {
        // From the edge on the left to the corner on the right.
        let (along, across) = (depth, 2.0 * PEG.radius);
        assert_eq!(whitney::can_wedge(depth, PEG.radius, friction), along / across <= friction, "{depth} {friction}");
    }
    // By geometry: a peg that leans, both touching, has its diameter, 2 r cos θ + ℓ sin θ, from wall to wall.
    let (lean, clearance) = (0.01_f64, 5e-5);
    let depth = (2.0 * (PEG.radius + clearance) - 2.0 * PEG.radius * lean.cos()) / lean.sin();
    assert!((whitney::two_point_depth(clearance, lean) / depth - 1.0).abs() < 0.02, "{depth}");
    let hole = Hole { radius: PEG.radius + clearance, chamfer: [1e-3; 2], place: MOUTH, tilt: 0.0 };
    let contact = Contact { stiffness: 1e6, damping: 0.0, friction: 0.0, creep_speed: 1e-3 };
    let touches = |depth: f64| {
        // The lower corner on the left just at the wall.
        let tip = [MOUTH[0] - hole.radius - 1e-9 + PEG.radius * lean.cos(), MOUTH[1] - depth];
        let centre = [tip[0] + PEG.centre * lean.sin(), tip[1] + PEG.centre * lean.cos()];
        contact.forces(&PEG, &hole, &PegMotion { centre, tilt: lean }, &STILL).normal[3] > 0.0
    };
    let below_corner = PEG.radius * lean.sin();
    assert!(!touches(0.99 * depth - below_corner) && touches(1.01 * depth + below_corner));
}

/// A push to the side moves the flange by its force over the stiffness chosen, and nothing turns.
#[test]
fn flange_gives_way_as_chosen() {
    let mut cell = cell(0.0, 0.0, 5e-5);
    (cell.control.stiffness, cell.control.damping) = ([3e3, 4e3, 2e5, 500.0], [350.0, 350.0, 1000.0, 6.0]);
    let place = [0.45, 0.1, 0.9];
    let mut state = cell.rest(place).unwrap();
    let (wanted, push): (Wanted, _) = ([place, [0.0; 3], [0.0; 3]], [6.0, -4.0, 20.0]);
    let moving = |_: f64, q: &Numbers, v: &Numbers, a: &mut Numbers| *a = cell.accelerations(&wanted, &push, q, v);
    Dopri5::new(1e-8, 1e-10).integrate(moving, 0.0, 4.0, &mut state, |_| ControlFlow::Continue(())).unwrap();
    let joints = [state.q[0], state.q[1], state.q[2], state.q[3]];
    let found = cell.scara.flange(&joints).position;
    for (i, want) in [6.0 / 3e3, -4.0 / 4e3, 20.0 / 2e5].into_iter().enumerate() {
        assert!((found[i] - place[i] - want).abs() < 1e-6, "{found:?}");
    }
    assert!((joints[0] + joints[1] + joints[3]).abs() < 1e-6, "{joints:?}");
    // Work of motors and of the push is in the energy, but for what dampers took.
    let started = cell.rest(place).unwrap();
    let gained = cell.energy(&state.q, &state.qd) - cell.energy(&started.q, &started.qd);
    assert!((gained - state.qd[8]).abs() < 1e-6, "{gained} {}", state.qd[8]);
}

#[test]
fn work_and_energy_agree_in_contact() {
    let speed = 5e-3;
    let mut cell = cell(0.02, 0.25, 5e-5);
    cell.contact.creep_speed = 1e-4;
    let started = cell.rest([MOUTH[0] + 1e-3, 0.0, MOUTH[1] + LENGTH + 4e-3]).unwrap();
    let state = lowered(&cell, MOUTH[0] + 1e-3, 4e-3, speed, 2.0);
    // What the start had in motion: arms are still, quill, tool and peg go down.
    let moving = 0.5 * (2.1 + 0.35 + PEG.mass) * speed * speed;
    let gained = cell.energy(&state.q, &state.qd) - cell.energy(&started.q, &started.qd) - moving;
    assert!((gained - state.qd[8]).abs() < 1e-4, "{gained} {}", state.qd[8]);
    assert!(cell.touch(&state.q, &state.qd).depth > 4e-3);
}

/// However long the integrator's steps are; the end is seen too, where it is between two milliseconds and where the arm
/// stops.
#[test]
fn samples_are_of_every_millisecond_and_of_the_end() {
    let cell = cell(0.0, 0.1, 5e-5);
    let wanted = |_: f64| -> Wanted { [[MOUTH[0], 0.0, MOUTH[1] + LENGTH + 0.02], [0.0; 3], [0.0; 3]] };
    for (whole, greatest_push, count) in [(0.05, 400.0, 51), (0.0503, 400.0, 52), (0.05, -1e3, 0)] {
        let times = [0.0125, 0.03, whole];
        let task = Task { wanted: &wanted, times, depth: 0.0, short: 0.0, greatest_push };
        let mut samples = Vec::new();
        let found = cell.insert(&task, |sample| samples.push(sample)).unwrap();
        let last = samples.pop().unwrap();
        assert!(samples.iter().enumerate().all(|(i, sample)| sample.t == i as f64 * 1e-3), "{samples:?}");
        assert_eq!((last.t, last.depth), (found.end, found.depth));
        assert!(last.t - samples.last().map_or(0.0, |sample| sample.t) <= 1e-3 + 1e-12, "{last:?}");
        assert!(count == 0 || (found.end == whole && samples.len() + 1 == count), "{} of {count}", samples.len() + 1);
    }
}

#[test]
fn what_cannot_be_is_named() {
    let good = cell(0.0, 0.1, 5e-5);
    assert_eq!(good.check(), Ok(()));
    let refused = |change: &dyn Fn(&mut Cell)| {
        let mut bad = good.clone();
        change(&mut bad);
        let error = bad.check().unwrap_err();
        (error.parameter, error.must)
    };
    assert_eq!(refused(&|c| c.hole.radius = 0.009), ("clearance", Must::BePositive));
    assert_eq!(refused(&|c| c.contact.friction = -0.1), ("contact.friction", Must::NotBeNegative));
    assert_eq!(refused(&|c| c.wrist.stiffness[1] = 0.0), ("wrist.stiffness", Must::BePositive));
    assert_eq!(refused(&|c| c.peg.mass = f64::NAN), ("peg.mass", Must::BePositive));
    assert_eq!(refused(&|c| c.hole.tilt = 0.3), ("hole.tilt", Must::BeWithin([-0.25, 0.25])));
    assert_eq!(refused(&|c| c.control.damping[2] = -1.0), ("control.damping", Must::NotBeNegative));
    // 0.425 m and 0.375 m reach 0.8 m, and not closer than 0.05 m.
    for place in [[0.9, 0.0, 0.9], [0.03, 0.0, 0.9]] {
        let error = good.posture(place).unwrap_err();
        let Must::BeWithin([least, greatest]) = error.must else { panic!("{error}") };
        assert!((greatest - 0.8).abs() < 1e-12 && (least - 0.05).abs() < 1e-12, "{error}");
    }
    for place in [[f64::NAN, 0.0, 0.9], [0.5, 0.0, f64::INFINITY]] {
        assert_eq!(good.posture(place).unwrap_err().must, Must::BeFinite);
    }
    let joints = good.posture([0.3, -0.4, 0.9]).unwrap();
    let found = good.scara.flange(&joints);
    assert!((0..3).all(|i| (found.position[i] - [0.3, -0.4, 0.9][i]).abs() < 1e-12), "{found:?}");
    // Stretched arms cannot follow.
    let stretched = [0.0; NUMBERS];
    assert_eq!(good.torques(&[[0.8, 0.0, 0.877], [0.0; 3], [0.0; 3]], &stretched, &stretched), None);
}
