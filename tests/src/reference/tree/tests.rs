//! The algorithms against each other and against those for serial arms.

use super::*;
use crate::compare::assert_close;
use crate::random::{Posture, Random, onto_the_sphere};
use crate::reference::arms::{arm6, irb7600};
use crate::reference::tests::ROUND_OFF;
use crate::reference::{EquationsOfMotion, robots};

/// Variables, rates and accelerations of a tree, of every posture; quaternions have unit length and keep it.
fn states(tree: &Tree, seed: u64) -> Vec<[Vec<f64>; 3]> {
    let mut random = Random::new(seed);
    let state = |k: usize| {
        let [mut x, mut xd, mut xdd] = [(); 3].map(|()| vec![0.0; tree.variables()]);
        random.fill_posture(Posture::ALL[k % Posture::ALL.len()], &mut x);
        random.fill(&mut xd, -3.0..3.0);
        random.fill(&mut xdd, -10.0..10.0);
        tree.balls()
            .for_each(|first| onto_the_sphere(&mut x[first..][..4], &mut xd[first..][..4], &mut xdd[first..][..4]));
        [x, xd, xdd]
    };
    (0..24).map(state).collect()
}

/// Defaults of every parameter of the mechanisms that are tested here.
fn value(name: &str, i: usize) -> f64 {
    match name {
        "g" => 9.8,
        "gear" => 21.5,
        "lead" => 0.12,
        "rotor" => 0.013,
        name if name.starts_with("i_x") && name != "i_xx" => 0.01,
        "i_yz" => -0.02,
        name => 0.2 + 0.01 * (name.len() + 3 * i) as f64,
    }
}

fn each_tree(check: impl Fn(&Tree)) {
    check(&robots::serial(&irb7600()));
    check(&robots::scara(&value));
    check(&robots::tree_robot(&value));
    check(&robots::floating_arm(&value));
    check(&robots::n_chain(4));
    check(&robots::coupled_gripper(&value));
    check(&robots::arm_on_moving_base(&value));
    check(&robots::menagerie());
}

fn flat(rows: Vec<Vec<f64>>) -> Vec<f64> {
    rows.concat()
}

#[test]
fn serial_trees_are_serial_arms() {
    for arm in [arm6(), irb7600()] {
        let tree = robots::serial(&arm);
        for [x, xd, xdd] in states(&tree, 1) {
            let [q, qd, qdd] = [&x, &xd, &xdd].map(|v| <[f64; 6]>::try_from(v.as_slice()).expect("six joints"));
            assert_close("τ", &tree.newton_euler(&x, &xd, &xdd), &arm.newton_euler(&q, &qd, &qdd), ROUND_OFF);
            assert_close("M", tree.composite_bodies(&x).as_slice(), &arm.composite_bodies(&q).concat(), ROUND_OFF);
            assert_close("C", &flat(tree.coriolis_matrix(&x, &xd)), &arm.coriolis_matrix(&q, &qd).concat(), ROUND_OFF);
            assert_close("V", &[tree.potential_energy(&x)], &[arm.weight_energy(&q)], ROUND_OFF);
        }
    }
}

#[test]
fn three_mass_matrices_are_one() {
    each_tree(|tree| {
        let weightless = Tree { gravity: [0.0; 3], ..tree.clone() };
        let n = tree.variables();
        for [x, ..] in states(tree, 2) {
            let m = tree.composite_bodies(&x);
            assert_close("Jacobians", &flat(tree.jacobian_mass_matrix(&x)), m.as_slice(), ROUND_OFF);
            let columns = (0..n).flat_map(|j| {
                let axis: Vec<f64> = (0..n).map(|k| if k == j { 1.0 } else { 0.0 }).collect();
                weightless.newton_euler(&x, &vec![0.0; n], &axis)
            });
            assert_close("Newton–Euler", &columns.collect::<Vec<_>>(), m.as_slice(), ROUND_OFF);
        }
    });
}

/// `C q̇ + G = h` with C by Christoffel symbols and h, G by Newton–Euler; signals move in all of them.
#[test]
fn christoffel_symbols_yield_the_bias() {
    each_tree(|tree| {
        if tree.has_ball_joints() {
            return;
        }
        let n = tree.coordinates;
        for [x, xd, mut xdd] in states(tree, 3) {
            xdd[..n].fill(0.0);
            let mut rest = xd.clone();
            rest[..n].fill(0.0);
            let c = tree.coriolis_matrix(&x, &xd);
            let gravity = tree.newton_euler(&x, &rest, &xdd);
            let bias = tree.newton_euler(&x, &xd, &xdd);
            let sum: Vec<f64> = c
                .iter()
                .zip(gravity)
                .map(|(row, g)| g + row.iter().zip(&xd).map(|(c, v)| c * v).sum::<f64>())
                .collect();
            assert_close("h", &sum, &bias[..n], ROUND_OFF);
        }
    });
}

/// `G = ∂V/∂q` where nothing moves, by central differences: good to some 1e-9.
#[test]
fn potential_energy_yields_gravity() {
    each_tree(|tree| {
        if tree.has_ball_joints() {
            return;
        }
        for [x, ..] in states(tree, 4) {
            let rest = vec![0.0; x.len()];
            let slope = |k: usize| {
                let at = |step: f64| {
                    let mut x = x.clone();
                    x[k] += step;
                    tree.potential_energy(&x)
                };
                (at(1e-4) - at(-1e-4)) / 2e-4
            };
            let slopes: Vec<f64> = (0..x.len()).map(slope).collect();
            assert_close("G", &tree.newton_euler(&x, &rest, &rest), &slopes, 1e-6);
        }
    });
}

/// `q̈` comes back from its forces, prescribed motions, drives and ball joints included.
#[test]
fn articulated_bodies_invert_newton_euler() {
    let inverted = std::cell::Cell::new(0);
    each_tree(|tree| {
        for [x, xd, xdd] in states(tree, 5) {
            let forces = tree.newton_euler(&x, &xd, &xdd);
            let Some(qdd) = tree.articulated_bodies(&x, &xd, &xdd, &forces) else { continue };
            let m = tree.composite_bodies(&x).view((0, 0), (tree.coordinates, tree.coordinates)).into_owned();
            // Euler angles at 90° and the like; a quaternion's M is singular by itself.
            let regular = tree.has_ball_joints() || m.symmetric_eigenvalues().min() > 1e-4;
            if regular {
                inverted.set(inverted.get() + 1);
                assert_close("q̈", &qdd, &xdd[..tree.coordinates], 1e-9);
            }
        }
    });
    let coupled = robots::coupled_gripper(&value);
    assert!(
        coupled.articulated_bodies(&[0.1; 4], &[0.0; 4], &[0.0; 4], &[0.0; 4]).is_none(),
        "joints share coordinates"
    );
    assert!(inverted.get() > 100, "{} states", inverted.get());
}
