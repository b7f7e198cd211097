//! The trees of bodies that the mechanisms declare, typed a second time.
//!
//! Parameters come from outside, by name and component, so that a test can vary them; what is constant in a declaration
//! is typed here as a number.

use super::arms;
use super::rigid_body::SerialArm;
use super::tree::{Body, Law, Motion, Node, Place, Tree};

/// The value of a parameter's component.
pub type Values<'a> = &'a dyn Fn(&str, usize) -> f64;

/// A serial arm in standard Denavit–Hartenberg frames: a hinge about z, then a body in a frame that is shifted and
/// twisted.
pub fn serial<const N: usize>(arm: &SerialArm<N>) -> Tree {
    let mut nodes = Vec::new();
    for (i, link) in arm.links.iter().enumerate() {
        let parent = i.checked_sub(1).map(|before| 2 * before + 1);
        nodes.push(node(parent, Place::HERE, Motion::Turn([0.0, 0.0, 1.0], Law::of(i)), None));
        let place = Place { shift: [link.a, 0.0, link.d], axis: [1.0, 0.0, 0.0], angle: link.alpha };
        let [xx, xy, xz, yy, yz, zz] = link.inertia;
        let body = Body { mass: link.mass, center: link.center_of_mass, inertia: [xx, yy, zz, xy, xz, yz] };
        nodes.push(node(Some(2 * i), place, Motion::Fixed, Some(body)));
    }
    tree(N, 0, nodes, arm.gravity)
}

/// `models/mechanisms/arm6.mbs` and `arm6_world.mbs`
pub fn arm6(_: Values<'_>) -> Tree {
    serial(&arms::arm6())
}

/// `models/mechanisms/arm6_params.mbs`
pub fn arm6_params(value: Values<'_>) -> Tree {
    let mut arm = arms::arm6();
    // The other lengths are 0 by design.
    [0, 3, 5].into_iter().enumerate().for_each(|(k, i)| arm.links[i].d = value("d", k));
    [0, 1, 2].into_iter().enumerate().for_each(|(k, i)| arm.links[i].a = value("a", k));
    for (i, link) in arm.links.iter_mut().enumerate() {
        link.mass = value("mass", i);
        link.center_of_mass = ["com_x", "com_y", "com_z"].map(|name| value(name, i));
        link.inertia = ["i_xx", "i_xy", "i_xz", "i_yy", "i_yz", "i_zz"].map(|name| value(name, i));
    }
    serial(&SerialArm { gravity: down(value), ..arm })
}

/// `models/mechanisms/irb7600.mbs`
pub fn irb7600(value: Values<'_>) -> Tree {
    let mut arm = arms::irb7600();
    for (i, link) in arm.links.iter_mut().enumerate() {
        link.mass = value("mass", i);
        link.center_of_mass = ["com_x", "com_y", "com_z"].map(|name| value(name, i));
        let [xx, yy, zz] = ["i_xx", "i_yy", "i_zz"].map(|name| value(name, i));
        link.inertia = [xx, 0.0, 0.0, yy, 0.0, zz];
    }
    serial(&SerialArm { gravity: down(value), ..arm })
}

/// `models/mechanisms/irb7600_rail.mbs`: a slide below the arm, a body more beyond it.
pub fn irb7600_rail(value: Values<'_>) -> Tree {
    let arm = irb7600(value);
    let body = |mass, center, [xx, yy, zz]: [f64; 3]| body(mass, center, [xx, yy, zz, 0.0, 0.0, 0.0]);
    // The carriage slides and does not turn: its mass centre and its inertia do not matter.
    let carriage = body(value("carriage_mass", 0), [0.0; 3], [0.0; 3]);
    let module_inertia = [0, 1, 2].map(|axis| value("module_inertia", axis));
    let module = body(value("module_mass", 0), [0.0, 0.0, value("module_center", 0)], module_inertia);
    let mut nodes = vec![node(None, Place::HERE, Motion::Slide([1.0, 0.0, 0.0], Law::of(0)), carriage)];
    nodes.extend(arm.nodes.into_iter().enumerate().map(|(i, link)| {
        let motion = match link.motion {
            Motion::Turn(axis, _) => Motion::Turn(axis, Law::of(1 + i / 2)),
            other => other,
        };
        node(Some(link.parent.map_or(0, |parent| parent + 1)), link.place, motion, link.body)
    }));
    nodes.push(node(Some(nodes.len() - 1), Place::HERE, Motion::Fixed, module));
    tree(7, 0, nodes, down(value))
}

/// `models/mechanisms/scara.mbs`
pub fn scara(value: Values<'_>) -> Tree {
    let body = |i| {
        let [xx, yy, zz, xy, xz, yz] = ["i_xx", "i_yy", "i_zz", "i_xy", "i_xz", "i_yz"].map(|name| value(name, i));
        let center = ["com_x", "com_y", "com_z"].map(|name| value(name, i));
        Some(Body { mass: value("mass", i), center, inertia: [xx, yy, zz, xy, xz, yz] })
    };
    let up = [0.0, 0.0, 1.0];
    let along = |x| Place::at([x, 0.0, 0.0]);
    let nodes = vec![
        node(None, Place::at([0.0, 0.0, value("height", 0)]), Motion::Turn(up, Law::of(0)), body(0)),
        node(Some(0), along(value("length", 0)), Motion::Turn(up, Law::of(1)), body(1)),
        node(Some(1), along(value("length", 1)), Motion::Slide(up, Law::of(2)), body(2)),
        node(Some(2), Place::HERE, Motion::Turn(up, Law::of(3)), body(3)),
    ];
    tree(4, 0, nodes, down(value))
}

/// `tests/mechanisms/tree_robot.mbs`
pub fn tree_robot(value: Values<'_>) -> Tree {
    let reach = |k| Motion::Slide([0.64, -0.48, 0.6], Law::of(k));
    let turn = |axis, k| Motion::Turn(axis, Law::of(k));
    let carriage = body(23.5, [0.04, -0.03, 0.07], [0.61, 0.74, 0.55, 0.021, -0.017, 0.033]);
    let torso = body(31.2, [0.021, 0.034, 0.28], [1.27, 1.19, 0.43, -0.034, 0.052, -0.026]);
    let left = body(5.6, [0.15, 0.02, -0.041], [0.021, 0.083, 0.079, 0.0043, -0.0021, 0.0017]);
    let left_boom = body(2.4, [0.08, -0.012, 0.013], [0.0052, 0.0147, 0.0139, 0.0004, -0.0003, 0.0005]);
    let right = body(6.1, [0.13, -0.024, 0.036], [0.024, 0.077, 0.071, -0.0037, 0.0029, -0.0013]);
    let forearm = body(3.7, [0.11, 0.017, -0.022], [0.0098, 0.0312, 0.0297, 0.0011, -0.0008, 0.0006]);
    let right_boom = body(1.9, [0.06, 0.009, -0.014], [0.0031, 0.0089, 0.0083, -0.0002, 0.0003, 0.0001]);
    let nodes = vec![
        node(None, Place::HERE, Motion::Slide([0.8, 0.36, 0.48], Law::of(0)), carriage),
        node(Some(0), Place::at([0.11, -0.07, 0.32]), turn([0.2, -0.3, 0.93], 1), torso),
        node(Some(1), Place::at([0.06, 0.24, 0.41]), turn([0.51, 0.62, -0.33], 2), left),
        node(Some(2), Place::at([0.27, 0.03, -0.05]), reach(3), left_boom),
        node(Some(1), Place::at([0.05, -0.26, 0.43]), turn([-0.44, 0.71, 0.29], 4), right),
        node(Some(4), Place::at([0.29, -0.04, 0.07]), turn([0.35, -0.21, 0.81], 5), forearm),
        node(Some(5), Place::at([0.22, 0.05, -0.03]), reach(6), right_boom),
    ];
    tree(7, 0, nodes, down(value))
}

/// `tests/mechanisms/floating_arm.mbs`; node 5 is the base.
pub fn floating_arm(value: Values<'_>) -> Tree {
    let given = |i, inertia| body(value("mass", i), ["com_x", "com_y", "com_z"].map(|name| value(name, i)), inertia);
    let base = given(0, [0.071, 0.083, 0.122, 0.0013, -0.0021, 0.0009]);
    let upper = given(1, [0.0008, 0.0021, 0.0023, -0.0001, 0.00012, 0.00005]);
    let forearm = given(2, [0.0005, 0.0014, 0.0013, 0.00007, -0.00006, 0.00004]);
    let hand = given(3, [0.0002, 0.0005, 0.0004, 0.00002, 0.00001, -0.00001]);
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let nodes = vec![
        node(None, Place::HERE, Motion::Slide(x, Law::of(0)), None),
        node(Some(0), Place::HERE, Motion::Slide(y, Law::of(1)), None),
        node(Some(1), Place::HERE, Motion::Slide(z, Law::of(2)), None),
        node(Some(2), Place::HERE, Motion::Turn(z, Law::of(3)), None),
        node(Some(3), Place::HERE, Motion::Turn(y, Law::of(4)), None),
        node(Some(4), Place::HERE, Motion::Turn(x, Law::of(5)), base),
        node(Some(5), Place::at([0.05, 0.02, -0.11]), Motion::Turn([0.1, 0.97, -0.2], Law::of(6)), upper),
        node(Some(6), Place::at([0.21, 0.01, -0.02]), Motion::Turn([-0.15, 0.92, 0.31], Law::of(7)), forearm),
        node(Some(7), Place::at([0.18, -0.015, 0.013]), Motion::Turn([0.83, 0.12, -0.41], Law::of(8)), hand),
    ];
    tree(9, 0, nodes, down(value))
}

/// `tests/mechanisms/n_chain.mbs`, of `n` links.
pub fn n_chain(n: usize) -> Tree {
    let link = |i: usize| {
        let place = Place { shift: [0.23, 0.04, -0.06], axis: [0.4, -0.3, 0.7], angle: 0.8 };
        let inertia = [0.0052, 0.0141, 0.0133, 0.0007, -0.0005, 0.0004].map(|radius| 1.4 * radius);
        node(
            i.checked_sub(1),
            place,
            Motion::Turn([0.36, -0.48, 0.8], Law::of(i)),
            body(1.4, [0.11, -0.02, 0.03], inertia),
        )
    };
    tree(n, 0, (0..n).map(link).collect(), [0.0, 0.0, -9.80665])
}

/// `tests/mechanisms/coupled_gripper.mbs`
pub fn coupled_gripper(value: Values<'_>) -> Tree {
    let gear = 1.0 / value("gear", 0);
    let carrier = body(8.1, [0.021, 0.017, 0.13], [0.064, 0.059, 0.037, 0.0012, -0.0031, 0.0023]);
    let upper = body(3.2, [0.14, -0.012, 0.023], [0.0061, 0.0312, 0.0298, -0.0011, 0.0008, 0.0004]);
    let forearm = body(2.3, [0.12, 0.009, -0.015], [0.0043, 0.0187, 0.0179, 0.0006, -0.0005, 0.0003]);
    let hand = body(0.9, [0.041, -0.004, 0.011], [0.0011, 0.0017, 0.0014, 0.00004, -0.00003, 0.00002]);
    let first = body(0.12, [0.031, 0.006, 0.003], [0.00002, 0.00007, 0.00006, 0.000003, 0.000002, -0.000001]);
    let second = body(0.11, [0.029, -0.007, 0.004], [0.00003, 0.00006, 0.00005, -0.000002, 0.000001, 0.000002]);
    let turn = |axis, terms: &[(usize, f64)]| Motion::Turn(axis, Law::sum(terms));
    let nodes = vec![
        node(None, Place::HERE, turn([0.0, 0.0, 1.0], &[(0, 1.0)]), carrier),
        node(Some(0), Place::at([0.07, 0.03, 0.28]), turn([0.0, 1.0, 0.0], &[(1, 1.0)]), upper),
        node(Some(1), Place::at([0.31, -0.02, 0.04]), turn([0.05, 0.96, 0.21], &[(1, 1.0), (2, 1.0)]), forearm),
        node(Some(2), Place::at([0.26, 0.015, -0.02]), turn([0.88, 0.2, -0.36], &[(0, 0.5), (2, -0.75)]), None),
        node(Some(3), Place::HERE, Motion::Slide([1.0, 0.0, 0.0], Law::sum(&[(3, value("lead", 0))])), hand),
        node(Some(4), Place::at([0.08, 0.03, 0.004]), turn([0.1, -0.2, 0.94], &[(3, gear)]), first),
        node(Some(4), Place::at([0.08, -0.03, -0.005]), turn([0.12, 0.17, 0.95], &[(3, -gear)]), second),
    ];
    Tree { drives: vec![0.0, 0.0, 0.0, value("rotor", 0)], ..tree(4, 0, nodes, down(value)) }
}

/// `tests/mechanisms/arm_on_moving_base.mbs`; the signals are heave, roll, pitch, yaw.
pub fn arm_on_moving_base(value: Values<'_>) -> Tree {
    let given = |i, inertia| body(value("mass", i), ["com_x", "com_y", "com_z"].map(|name| value(name, i)), inertia);
    let column = given(0, [9.7, 9.1, 4.2, 0.31, -0.42, 0.27]);
    let boom = given(1, [1.3, 12.4, 12.1, -0.22, 0.35, 0.18]);
    let jib = given(2, [0.41, 2.2, 2.3, 0.06, -0.04, 0.03]);
    let [heave, roll, pitch, yaw] = [3, 4, 5, 6].map(Law::of);
    let nodes = vec![
        node(None, Place::HERE, Motion::Slide([0.0, 0.0, 1.0], heave), None),
        node(Some(0), Place::HERE, Motion::Turn([0.0, 0.0, 1.0], yaw), None),
        node(Some(1), Place::HERE, Motion::Turn([0.0, 1.0, 0.0], pitch), None),
        node(Some(2), Place::HERE, Motion::Turn([1.0, 0.0, 0.0], roll), None),
        node(Some(3), Place::at([2.1, -1.3, 0.9]), Motion::Turn([0.06, -0.04, 0.99], Law::of(0)), column),
        node(Some(4), Place::at([0.17, 0.05, 1.24]), Motion::Turn([0.11, 0.98, -0.07], Law::of(1)), boom),
        node(Some(5), Place::at([1.43, -0.06, 0.08]), Motion::Turn([-0.09, 0.97, 0.13], Law::of(2)), jib),
    ];
    tree(3, 4, nodes, down(value))
}

/// A sliding ball joint with two branches, slides and hinges that signals drive, bent laws, skew places: every kind of
/// joint, for the algorithms to agree on.
#[cfg(test)]
pub(super) fn menagerie() -> Tree {
    let place = |shift, angle| Place { shift, axis: [0.3, -0.7, 0.2], angle };
    let any = |mass| body(mass, [0.1, -0.2, 0.05], [0.03, 0.04, 0.05, 0.002, -0.003, 0.001]);
    let law = |terms: &[(usize, f64)]| Law { offset: 0.3, bend: 0.02, ..Law::sum(terms) };
    let nodes = vec![
        node(None, Place::HERE, Motion::Slide([0.6, 0.0, 0.8], law(&[(0, 1.0)])), None),
        node(Some(0), place([0.1, 0.2, 0.3], 0.4), Motion::Ball { first: 1 }, any(2.0)),
        node(
            Some(1),
            place([0.4, -0.1, 0.2], std::f64::consts::FRAC_PI_2),
            Motion::Turn([0.2, 0.5, -0.4], law(&[(5, 1.5)])),
            any(1.0),
        ),
        node(
            Some(2),
            place([0.3, 0.1, -0.2], 1.1),
            Motion::Slide([0.0, 0.6, -0.8], law(&[(6, -2.0), (8, 1.0)])),
            any(0.7),
        ),
        node(Some(1), place([-0.2, 0.3, 0.1], -0.8), Motion::Turn([0.9, -0.1, 0.2], law(&[(8, 0.5)])), any(0.4)),
        node(Some(4), place([0.2, 0.2, 0.1], 0.0), Motion::Turn([0.1, 0.8, 0.3], law(&[(7, 1.0)])), None),
        node(Some(5), place([0.2, 0.1, 0.5], 0.3), Motion::Fixed, any(0.9)),
    ];
    Tree { drives: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.2], ..tree(8, 1, nodes, [1.0, -2.0, -9.0]) }
}

fn node(parent: Option<usize>, place: Place, motion: Motion, body: Option<Body>) -> Node {
    Node { parent, place, motion, body }
}

fn body(mass: f64, center: [f64; 3], inertia: [f64; 6]) -> Option<Body> {
    Some(Body { mass, center, inertia })
}

fn tree(coordinates: usize, signals: usize, nodes: Vec<Node>, gravity: [f64; 3]) -> Tree {
    Tree { coordinates, signals, nodes, gravity, drives: Vec::new() }
}

fn down(value: Values<'_>) -> [f64; 3] {
    [0.0, 0.0, -value("g", 0)]
}
