//! Long runs: what the equations conserve stays what it is.

use std::ops::ControlFlow;

use mbs_models::cr3bp::{self, Cr3bp};
use mbs_models::double_pendulum::DoublePendulum;
use mbs_models::four_bar::FourBar;
use mbs_models::heavy_top::HeavyTop;
use mbs_models::n_pendulum::NPendulum;
use mbs_runtime::{Dop853, Integrator, Mechanism, State, accelerations};
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::chaplygin_sleigh::ChaplyginSleigh;
use mbs_tests::mechanisms::charged_particle::{self, ChargedParticle};
use mbs_tests::mechanisms::rolling_coin::{self, RollingCoin};
use mbs_tests::reference;

/// The state after `t_end` without inputs; `observe` sees it at every accepted step.
fn run<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    start: State<[f64; N]>,
    t_end: f64,
    mut observe: impl FnMut(&State<[f64; N]>),
) -> State<[f64; N]> {
    let mut state = start;
    let motion = accelerations(mechanism, |_, _, _| [0.0; U]);
    let summary = Dop853::new(1e-12, 1e-12).integrate(motion, 0.0, t_end, &mut state, |step| {
        observe(step.state());
        ControlFlow::Continue(())
    });
    assert_eq!(summary.expect("a smooth motion").time, t_end);
    state
}

/// Largest change of `T + V` over the largest T, at the accepted steps of a run.
fn energy_drift<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    start: State<[f64; N]>,
    t_end: f64,
) -> f64 {
    let kinetic = |s: &State<[f64; N]>| mechanism.kinetic_energy(0.0, &s.q, &s.qd);
    let total = |s: &State<[f64; N]>| kinetic(s) + mechanism.potential_energy(0.0, &s.q);
    let (mut drift, mut largest) = (0.0f64, 0.0f64);
    run(mechanism, start, t_end, |state| {
        largest = largest.max(kinetic(state));
        drift = drift.max((total(state) - total(&start)).abs());
    });
    drift / largest
}

#[test]
fn double_pendulum_keeps_its_energy_over_100_seconds() {
    let drift = energy_drift(&DoublePendulum::<f64>::default(), State { q: [2.0, 2.5], qd: [0.0; 2] }, 100.0);
    assert!(drift <= 1e-9, "{drift:e}");
}

#[test]
fn ten_links_keep_their_energy_over_10_seconds() {
    let q = std::array::from_fn(|i| 0.5 + 0.1 * i as f64);
    let drift = energy_drift(&NPendulum::<f64>::default(), State { q, qd: [0.0; 10] }, 10.0);
    assert!(drift <= 1e-10, "{drift:e}");
}

/// A fast top keeps its energy and both momenta, which the generator found by itself.
#[test]
fn heavy_top_keeps_its_momenta() {
    let top = HeavyTop::<f64>::default();
    assert_eq!(mbs_models::heavy_top::CONSERVED, ["energy_integral", "p_phi", "p_psi"]);
    let start = State { q: [0.0, 0.4, 0.0], qd: [0.0, 0.0, 200.0] };
    let state = run(&top, start, 5.0, |_| ());
    let [before, after] = [start, state].map(|s| top.conserved(&s.q, &s.qd));
    for (a, b) in before.iter().zip(&after) {
        assert!((a - b).abs() <= 1e-10 * a.abs(), "{before:?} {after:?}");
    }
}

/// A hundred turns of a helix: the magnetic field does no work, and the place is the exact one.
#[test]
fn charged_particle_follows_its_helix() {
    let (m, charge, b) = (1e-3, 2e-3, [0.3, -0.2, 0.6]);
    let particle = ChargedParticle::new(charged_particle::Params { m, charge, b, e: [0.0; 3] });
    let exact = reference::charged_particle::ChargedParticle { m, charge, b, e: [0.0; 3] };
    let t_end = 100.0 * std::f64::consts::TAU / exact.cyclotron_frequency();
    let (q, qd) = ([0.1, -0.4, 0.2], [0.7, -0.3, 0.5]);
    let end = run(&particle, State { q, qd }, t_end, |_| ());
    let [place, velocity] = exact.helix(q, qd, t_end);
    assert_close("place", &end.q, &place, 1e-10);
    assert_close("velocity", &end.qd, &velocity, 1e-10);
}

#[test]
fn charged_particle_keeps_its_energy_in_both_fields() {
    let particle = ChargedParticle::<f64>::default();
    let start = State { q: [0.1, -0.4, 0.2], qd: [0.7, -0.3, 0.5] };
    let drift = energy_drift(&particle, start, 500.0);
    assert!(drift <= 1e-10, "{drift:e}");
}

/// Off L₄ in space, for 30 turns of the primaries.
#[test]
fn jacobis_constant_is_kept() {
    assert_eq!(cr3bp::CONSERVED, ["energy_integral"]);
    let system = Cr3bp::<f64>::default();
    let exact = reference::restricted_three_body::RestrictedThreeBody { mu: system.params().mu };
    let start = State { q: [0.47, 0.88, 0.1], qd: [0.01, -0.02, 0.03] };
    let jacobi = |s: &State<[f64; 3]>| exact.jacobi_constant(&s.q, &s.qd);
    let (mut drift, mut far) = (0.0f64, 0.0f64);
    run(&system, start, 30.0 * std::f64::consts::TAU, |state| {
        drift = drift.max((jacobi(state) - jacobi(&start)).abs());
        far = far.max((state.q[0] - start.q[0]).abs());
        // The integral that the generator found is E = −C/2.
        let [energy] = system.conserved(&state.q, &state.qd);
        assert!((2.0 * energy + jacobi(state)).abs() < 1e-13);
    });
    assert!(far > 0.05, "it moves about: {far}");
    assert!(drift <= 1e-10, "{drift:e}");
}

/// The blade's force does no work; the sleigh ends straight ahead, blade behind.
#[test]
fn chaplygin_sleigh_keeps_its_energy_and_comes_round() {
    let sleigh = ChaplyginSleigh::<f64>::default();
    // Backwards along the blade, slightly turning: unstable, and so it turns round.
    let start = State { q: [0.0; 3], qd: [-1.0, 0.0, 0.01] };
    let drift = energy_drift(&sleigh, start, 60.0);
    assert!(drift <= 1e-10, "{drift:e}");
    let end = run(&sleigh, start, 60.0, |state| {
        let [slip] = sleigh.constraint(&state.q, &state.qd);
        assert!(slip.abs() <= 1e-10, "{slip:e}");
    });
    let [xd, yd, turn] = end.qd;
    let ahead = xd * end.q[2].cos() + yd * end.q[2].sin();
    assert!(turn.abs() < 1e-6 && ahead > 0.9, "{end:?}");
}

/// Rolling does no work; the point of contact stays at rest.
#[test]
fn rolling_coin_keeps_its_energy() {
    let coin = RollingCoin::<f64>::default();
    let rolling_coin::Params { m, radius, axial, transverse, g } = *coin.params();
    let exact = reference::rolling_coin::RollingCoin { m, radius, axial, transverse, g };
    // Near a steady circle, leaning out and in.
    let q = [0.0, 0.0, 0.3, 0.4, 0.0];
    let rates = [25.0, 3.0, exact.steady_spin(0.4, 25.0)];
    let [xd, yd] = exact.rolling_velocity(&q, &rates);
    let start = State { q, qd: [xd, yd, rates[0], rates[1], rates[2]] };
    let drift = energy_drift(&coin, start, 10.0);
    assert!(drift <= 1e-9, "{drift:e}");
    let (mut slip, mut leans) = (0.0f64, [f64::MAX, f64::MIN]);
    run(&coin, start, 10.0, |state| {
        slip = coin.constraint(&state.q, &state.qd).iter().fold(slip, |slip, rate| slip.max(rate.abs()));
        leans = [leans[0].min(state.q[3]), leans[1].max(state.q[3])];
    });
    assert!(leans[1] - leans[0] > 0.1, "it nods: {leans:?}");
    assert!(slip <= 1e-9, "{slip:e} m/s");
}

/// A crank that turns all the way round, without torque: the multipliers do no work, and the loop stays closed.
#[test]
fn four_bar_keeps_its_energy() {
    let linkage = FourBar::<f64>::default();
    let mbs_models::four_bar::Params { m, l, ground, g } = *linkage.params();
    let exact = reference::four_bar::FourBar { m, l, ground, g, tau: 0.0 };
    let q = exact.closed(0.3).expect("the crank turns all the way round");
    let start = State { q, qd: exact.closed_rates(&q, 20.0) };
    let drift = energy_drift(&linkage, start, 10.0);
    assert!(drift <= 1e-8, "{drift:e}");
    let mut gap = 0.0f64;
    let end = run(&linkage, start, 10.0, |state| {
        gap = linkage.constraint(&state.q, &state.qd).iter().fold(gap, |gap, x| gap.max(x.abs()));
    });
    assert!(end.q[0].abs() > 60.0, "it turns round: {}", end.q[0]);
    assert!(gap <= 1e-8, "{gap:e} m");
}
