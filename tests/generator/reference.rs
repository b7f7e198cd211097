//! Generated equations against equations obtained another way: closed forms typed by hand, Newton–Euler, composite and
//! articulated bodies, and the thesis' reference values.

use mbs_models::arm6::Arm6;
use mbs_models::arm6_params::Arm6Params;
use mbs_models::irb7600::Irb7600;
use mbs_runtime::Mechanism;
use mbs_tests::compare::assert_close;
use mbs_tests::random::{State, states};
use mbs_tests::reference::rigid_body::SerialArm;
use mbs_tests::reference::{EquationsOfMotion, arms};
use mbs_tests::reference::{cart_pole, double_pendulum, heavy_top, n_pendulum, pendulum, spherical_pendulum};

/// Rounding errors of two ways to add up the same terms, relative to the largest entry.
const TOLERANCE: f64 = 1e-11;

/// M, C, G, T, V, h, ∂D/∂q̇ and inverse dynamics, at states of every posture.
fn check<const N: usize, const U: usize>(
    generated: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    reference: &impl EquationsOfMotion<N>,
) {
    let t = 0.0;
    for State { q, qd, qdd } in states::<N>(5, 60) {
        let close = |what: &str, found: &[f64], expected: &[f64]| assert_close(what, found, expected, TOLERANCE);
        close("M", &generated.mass_matrix(t, &q).concat(), &reference.mass_matrix(&q).concat());
        close("C", &generated.coriolis_matrix(t, &q, &qd).concat(), &reference.coriolis_matrix(&q, &qd).concat());
        close("G", &generated.gravity(t, &q), &reference.gravity(&q));
        close("T", &[generated.kinetic_energy(t, &q, &qd)], &[reference.kinetic_energy(&q, &qd)]);
        close("V", &[generated.potential_energy(t, &q)], &[reference.potential_energy(&q)]);
        close("h", &generated.bias(t, &q, &qd), &reference.bias(&q, &qd));
        close("∂D/∂q̇", &generated.dissipation_force(t, &q, &qd), &reference.dissipation_force(&qd));
        close("τ", &generated.inverse_dynamics(t, &q, &qd, &qdd), &reference.inverse_dynamics(&q, &qd, &qdd));
    }
}

#[test]
fn pendulum_is_the_textbook_one() {
    use mbs_models::pendulum::{Params, Pendulum};
    let reference = pendulum::Pendulum { m: 1.3, l: 0.7, g: 9.81, b: 0.2 };
    check(&Pendulum::new(Params { m: 1.3, l: 0.7, g: 9.81, b: 0.2 }), &reference);
}

#[test]
fn cart_pole_is_the_textbook_one() {
    use mbs_models::cart_pole::{CartPole, Params};
    let reference = cart_pole::CartPole { m_cart: 1.3, m_bob: 0.4, length: 0.7, g: 9.81, b: 0.2 };
    let generated = CartPole::new(Params { m_cart: 1.3, m_bob: 0.4, length: 0.7, g: 9.81, b: 0.2 });
    check(&generated, &reference);
    assert_eq!(generated.generalized_force(&[0.0; 2], &[0.0; 2], &[3.0]), reference.generalized_force(3.0));
}

#[test]
fn double_pendulum_is_the_textbook_one() {
    use mbs_models::double_pendulum::{DoublePendulum, Params};
    let reference = double_pendulum::DoublePendulum { m1: 1.3, m2: 0.4, l1: 0.7, l2: 1.9, g: 9.81 };
    check(&DoublePendulum::new(Params { m1: 1.3, m2: 0.4, l1: 0.7, l2: 1.9, g: 9.81 }), &reference);
}

#[test]
fn spherical_pendulum_is_the_textbook_one() {
    use mbs_models::spherical_pendulum::{Params, SphericalPendulum};
    let reference = spherical_pendulum::SphericalPendulum { m: 1.3, l: 0.7, g: 9.81 };
    check(&SphericalPendulum::new(Params { m: 1.3, l: 0.7, g: 9.81 }), &reference);
}

#[test]
fn heavy_top_is_the_textbook_one() {
    use mbs_models::heavy_top::{HeavyTop, Params};
    let reference = heavy_top::HeavyTop { m: 1.3, l: 0.2, i1: 0.06, i3: 0.02, g: 9.81 };
    check(&HeavyTop::new(Params { m: 1.3, l: 0.2, i1: 0.06, i3: 0.02, g: 9.81 }), &reference);
}

#[test]
fn n_pendulum_is_the_textbook_one() {
    use mbs_models::n_pendulum::{NPendulum, Params};
    let reference = n_pendulum::NPendulum::<10>::uniform(1.3, 0.7, 9.81);
    check(&NPendulum::new(Params { m: 1.3, l: 0.7, g: 9.81 }), &reference);
}

#[test]
fn the_arms_are_the_textbook_ones() {
    check(&Arm6::<f64>::default(), &arms::arm6());
    check(&Arm6Params::<f64>::default(), &arms::arm6());
    check(&Irb7600::<f64>::default(), &arms::irb7600());
}

/// Newton–Euler, composite bodies and articulated bodies, to 1e-9 of the largest entry.
fn check_arm(generated: &impl Mechanism<6, 6, Scalar = f64, Time = f64>, arm: &SerialArm<6>) {
    let t = 0.0;
    for State { q, qd, qdd } in states::<6>(9, 120) {
        let torques = arm.newton_euler(&q, &qd, &qdd);
        assert_close("Newton–Euler", &generated.inverse_dynamics(t, &q, &qd, &qdd), &torques, 1e-9);
        assert_close(
            "composite bodies",
            &generated.mass_matrix(t, &q).concat(),
            &arm.composite_bodies(&q).concat(),
            1e-9,
        );
        let accelerations = generated.forward_dynamics(t, &q, &qd, &torques);
        assert_close("articulated bodies", &accelerations, &arm.articulated_bodies(&q, &qd, &torques), 1e-9);
        assert_close("forward of inverse", &accelerations, &qdd, 1e-9);
    }
}

#[test]
fn arms_agree_with_rigid_body_algorithms() {
    check_arm(&Arm6::<f64>::default(), &arms::arm6());
    check_arm(&Arm6Params::<f64>::default(), &arms::arm6());
    check_arm(&Irb7600::<f64>::default(), &arms::irb7600());
}

/// Every parameter of its own: the defaults would hide one that was mistaken for another.
#[test]
fn arm6_params_follows_its_parameters() {
    use mbs_models::arm6_params::Params;
    let mut arm = arms::arm6();
    let mut params = Params::<f64>::default();
    for (i, link) in arm.links.iter_mut().enumerate() {
        let vary = |x: f64, k: usize| x * (1.0 + 0.03 * ((7 * i + 3 * k) % 11) as f64) + 0.01 * (k + 1) as f64;
        // Lengths that are 0 by design are no parameters.
        let length = |x: f64, k: usize| if x == 0.0 { 0.0 } else { vary(x, k) };
        (link.d, link.a, link.mass) = (length(link.d, 0), length(link.a, 1), vary(link.mass, 2));
        link.center_of_mass = std::array::from_fn(|k| vary(link.center_of_mass[k], 3 + k));
        link.inertia = std::array::from_fn(|k| vary(link.inertia[k], 6 + k));
        params.mass[i] = link.mass;
        [params.com_x[i], params.com_y[i], params.com_z[i]] = link.center_of_mass;
        [params.i_xx[i], params.i_xy[i], params.i_xz[i], params.i_yy[i], params.i_yz[i], params.i_zz[i]] = link.inertia;
    }
    params.d = [0, 3, 5].map(|i: usize| arm.links[i].d);
    params.a = [0, 1, 2].map(|i: usize| arm.links[i].a);
    params.g = 8.5;
    arm.gravity = [0.0, 0.0, -8.5];
    check(&Arm6Params::new(params), &arm);
    check_arm(&Arm6Params::new(params), &arm);
}

#[test]
fn irb7600_has_the_thesis_values() {
    let arm = Irb7600::<f64>::default();
    let thesis = arms::thesis_values();
    let flange = arm.flange(&thesis.q);
    assert_close("flange position", &flange.position, &thesis.position, 1e-14);
    assert_close("flange rotation", &flange.rotation.concat(), &thesis.rotation.concat(), 1e-14);
    assert_close("flange Jacobian", &arm.flange_jacobian(&thesis.q).concat(), &thesis.jacobian.concat(), 1e-14);
    let (q, qd, qdd) = (&thesis.q, &thesis.qd, &thesis.qdd);
    assert_close("M", &arm.mass_matrix(q).concat(), &thesis.mass_matrix.concat(), 1e-12);
    assert_close("G", &arm.gravity(q), &thesis.gravity, 1e-12);
    assert_close("C", &arm.coriolis_matrix(q, qd).concat(), &thesis.coriolis_matrix.concat(), 1e-12);
    assert_close("τ", &arm.inverse_dynamics(q, qd, qdd), &thesis.torques, 1e-12);
}
