//! Long runs of generated mechanisms on their constraints, to which every accepted step is brought back.
//!
//! Values: `orbit.constraint_pendulum` and `orbit.constraint_knife_edge` of the thesis' reference data.

use std::ops::ControlFlow;

use mbs_runtime::{
    Constraints, Dop853, Event, Integrator, Mechanism, Onto, Projected, Projector, Response, State, accelerations,
    ldlt_solve,
};
use mbs_tests::mechanisms::bouncing_pendulum::{self, BouncingPendulum};
use mbs_tests::mechanisms::cartesian_pendulum::CartesianPendulum;
use mbs_tests::mechanisms::knife_edge::KnifeEdge;
use mbs_tests::mechanisms::slider_crank::{self, SliderCrank};
use mbs_tests::reference;

/// The method with its steps on the constraints.
fn projected<C>(method: Dop853, constraints: &C) -> Projected<Dop853, Onto<'_, C, f64, [f64; 128]>> {
    // Room for three coordinates and two rows, with some to spare.
    Projected { method, drift: Projector::new([0.0; 128]).onto(constraints) }
}

/// Largest `|φ|` and `|A q̇ + b|` of a state.
fn open<const N: usize>(constraints: &impl Constraints<f64>, t: f64, state: &State<[f64; N]>) -> [f64; 2] {
    let [mut phi, mut rate] = [[0.0; 4]; 2];
    let rows = constraints.rows();
    constraints.position(t, &state.q, &mut phi[..rows]);
    constraints.rate(t, &state.q, &state.qd, &mut rate[..rows]);
    let phi = (0..rows).filter(|&row| constraints.is_holonomic(row)).map(|row| phi[row].abs());
    [phi.fold(0.0, f64::max), rate.iter().fold(0.0, |largest, rate| largest.max(rate.abs()))]
}

/// What a run did to the constraints, at the states that it accepted, and to the energy.
#[derive(Debug)]
struct Drift {
    /// `|φ|`
    open: f64,
    /// `|A q̇ + b|`
    slip: f64,
    /// Change of `T + V` over its first value above `floor`.
    energy: f64,
}

/// Runs with projection, without inputs; `floor` is the least V that there can be.
fn run<const N: usize, const U: usize>(
    mechanism: &(impl Mechanism<N, U, Scalar = f64, Time = f64> + Constraints<f64>),
    method: Dop853,
    [start, end]: [f64; 2],
    state: &mut State<[f64; N]>,
    floor: f64,
) -> Drift {
    let energy = |s: &State<[f64; N]>| {
        mechanism.kinetic_energy(0.0, &s.q, &s.qd) + mechanism.potential_energy(0.0, &s.q) - floor
    };
    let (initial, mut drift) = (energy(state), Drift { open: 0.0, slip: 0.0, energy: 0.0 });
    let mut note = |t, state: &State<[f64; N]>| {
        let [phi, rate] = open(mechanism, t, state);
        drift.open = drift.open.max(phi);
        drift.slip = drift.slip.max(rate);
        drift.energy = drift.energy.max((energy(state) / initial - 1.0).abs());
    };
    let summary = projected(method, mechanism)
        .integrate(accelerations(mechanism, |_, _, _| [0.0; U]), start, end, state, |step| {
            // What the step begins with is what the projection left.
            note(step.previous_time(), step.previous_state());
            ControlFlow::Continue(())
        })
        .expect("a smooth motion");
    assert_eq!(summary.time, end);
    note(end, state);
    drift
}

/// At rest at 60°.
fn raised() -> State<[f64; 2]> {
    let (sin, cos) = std::f64::consts::FRAC_PI_3.sin_cos();
    State::new([sin, -cos], [0.0, 0.0])
}

#[test]
fn the_pendulum_stays_on_its_circle_for_1000_seconds() {
    let pendulum = CartesianPendulum::<f64>::default();
    let floor = -pendulum.params().m * pendulum.params().g * pendulum.params().l;
    let drift = run(&pendulum, Dop853::new(1e-11, 1e-13), [0.0, 1000.0], &mut raised(), floor);
    println!("{drift:?}");
    assert!(drift.open <= 1e-12 && drift.slip <= 1e-12 && drift.energy <= 5e-9, "{drift:?}");
}

#[test]
fn the_pendulum_keeps_its_period() {
    let pendulum = CartesianPendulum::<f64>::default();
    let mut times = Vec::new();
    let mut note = |t, _: &mut State<[f64; 2]>| {
        times.push(t);
        Response::Continue
    };
    let mut lowest = [Event::new(&|_, state: &State<[f64; 2]>| state.q[0]).with_action(&mut note)];
    projected(Dop853::new(1e-12, 1e-13), &pendulum)
        .integrate_with_events(accelerations(&pendulum, |_, _, _| []), 0.0, 22.0, &mut raised(), &mut lowest, |_| {
            ControlFlow::Continue(())
        })
        .expect("a smooth motion");
    assert_eq!(times.len(), 20);
    let period = 2.153_242_351_783_842_6;
    for (i, time) in times.iter().enumerate() {
        let late = time - (0.25 + 0.5 * i as f64) * period;
        assert!(late.abs() < 1e-9, "passage {i}: {late:e}");
    }
    println!("period {}", times[2] - times[0]);
    assert!((times[2] - times[0] - period).abs() < 1e-9);
}

#[test]
fn the_knife_edge_goes_where_it_points() {
    let edge = KnifeEdge::<f64>::default();
    let mut state = State::new([0.0; 3], [0.0, 0.0, 0.7]);
    let mut start = 0.0;
    for (t, [x, y]) in [
        (1.0, [1.420_402_975_033_200_8, 0.709_403_768_523_874_7]),
        (2.0, [3.323_649_620_933_192_5, 4.218_278_993_490_296]),
        (5.0, [0.421_137_509_304_311_54, 10.854_552_357_524_872]),
    ] {
        // The energy is zero at the start; counted from far below, it stays to twelve digits.
        let drift = run(&edge, Dop853::new(1e-12, 1e-13), [start, t], &mut state, -100.0);
        let error = (state.q[0] - x).hypot(state.q[1] - y);
        println!("{t}: {error:e}, {drift:?}");
        assert!(error < 1e-10, "at {t}: {state:?}");
        assert!(drift.slip <= 1e-14 && drift.energy < 1e-12, "{drift:?}");
        start = t;
    }
    // What the slope does to the blade, in the place of the multiplier.
    let speed = state.qd[0] * state.q[2].cos() + state.qd[1] * state.q[2].sin();
    let exact = reference::knife_edge::KnifeEdge { m: 1.0, moment: 1.0, slope: 20f64.to_radians(), g: 9.80665 };
    let [lambda] = edge.multipliers(&state.q, &state.qd);
    assert!((lambda - exact.side_force(state.q[2], speed, 0.7)).abs() < 1e-9, "{lambda}");
    assert!((lambda.abs() - 2.353_104_290_855_316).abs() < 1e-9, "{lambda}");
}

/// Turning freely, without friction.
#[test]
fn the_slider_crank_stays_closed() {
    let params = slider_crank::Params { c: 0.0, ..slider_crank::Params::default() };
    let slider_crank::Params { m, l, offset, g, c } = params;
    let engine = SliderCrank::new(params);
    let exact = reference::slider_crank::SliderCrank { m, l, offset, g, c, inputs: [0.0; 2] };
    let q = exact.closed(0.3).expect("the rod is longer than the crank");
    let mut state = State::new(q, exact.closed_rates(&q, 30.0));
    let drift = run(&engine, Dop853::new(1e-11, 1e-13), [0.0, 10.0], &mut state, 0.0);
    println!("{drift:?} {state:?}");
    assert!(state.q[0] > 200.0, "it turns round: {}", state.q[0]);
    assert!(drift.open <= 1e-15 && drift.slip <= 1e-13 && drift.energy <= 1e-9, "{drift:?}");
}

/// Newton's restitution: the velocity of the gap turns round and loses its part; wall and constraints share the
/// impulse, `M Δq̇ = nᵀ j + Aᵀ μ` with `n (q̇ + Δq̇) = −e n q̇` and `A (q̇ + Δq̇) = 0`, n the gap's Jacobian.
fn bounce(rod: &BouncingPendulum<f64>, restitution: f64, state: &mut State<[f64; 3]>) {
    let (m, a, n) = (rod.mass_matrix(&state.q), rod.constraint_jacobian(&state.q), rod.gap_jacobian(&state.q));
    let rows = [a[0], a[1], n[0]];
    let solved = rows.map(|row| ldlt_solve(m, row));
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let compliance = rows.map(|row| solved.map(|column| dot(&row, &column)));
    let [hinge_x, hinge_y, gap] = rows.map(|row| dot(&row, &state.qd));
    let impulse = ldlt_solve(compliance, [-hinge_x, -hinge_y, -(1.0 + restitution) * gap]);
    for i in 0..3 {
        state.qd[i] += (0..3).map(|row| solved[row][i] * impulse[row]).sum::<f64>();
    }
}

/// Released at 1.2 rad against a wall with the restitution 0.8: the impacts come when the pendulum's periods say.
#[test]
fn the_pendulum_bounces_as_its_periods_say() {
    const RESTITUTION: f64 = 0.8;
    let rod = BouncingPendulum::<f64>::default();
    let bouncing_pendulum::Params { m, l, moment, g } = *rod.params();
    let exact = reference::bouncing_pendulum::BouncingPendulum { m, l, moment, g };
    let mut state = State::new(exact.held(1.2), [0.0; 3]);
    let expected: Vec<f64> = exact.impacts(1.2, RESTITUTION).take_while(|&t| t < 10.0).collect();
    let mut found = Vec::new();
    let mut impact = |t, state: &mut State<[f64; 3]>| {
        found.push(t);
        let before = state.qd[2];
        bounce(&rod, RESTITUTION, state);
        assert!((state.qd[2] + RESTITUTION * before).abs() < 1e-12, "{before} {state:?}");
        Response::Continue
    };
    let gap = |_, state: &State<[f64; 3]>| rod.gap(&state.q);
    let mut wall = [Event::new(&gap).falling().with_action(&mut impact)];
    projected(Dop853::new(1e-12, 1e-13), &rod)
        .integrate_with_events(accelerations(&rod, |_, _, _| []), 0.0, 10.0, &mut state, &mut wall, |_| {
            ControlFlow::Continue(())
        })
        .expect("impacts are far from each other");
    assert!(expected.len() > 10 && found.len() == expected.len(), "{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    let [phi, rate] = open(&rod, 10.0, &state);
    assert!(phi <= 1e-15 && rate <= 1e-14, "{phi:e} {rate:e}");
}
