//! A pendulum in Cartesian coordinates, and a knife edge.
//!
//! Values: `orbit.constraint_pendulum` and `orbit.constraint_knife_edge` of the reference data, `g = 9.80665 m/s²`.

use core::ops::ControlFlow;
use std::vec::Vec;

use crate::{
    ConstraintError, Constraints, Coordinates, Dop853, Drift, Event, IntegrationError, Integrator, Onto, Projected,
    Projector, Response, Rk4, State, Step,
};

const G: f64 = 9.80665;

/// A point of mass 1 at the distance 1 from the origin.
struct Circle;

impl Constraints<f64> for Circle {
    fn rows(&self) -> usize {
        1
    }
    fn is_holonomic(&self, _: usize) -> bool {
        true
    }
    fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
        m.copy_from_slice(&[1.0, 0.0, 0.0, 1.0]);
    }
    fn position(&self, _: f64, q: &[f64], phi: &mut [f64]) {
        phi[0] = length_error(q);
    }
    fn rate(&self, _: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        rate[0] = q[0] * qd[0] + q[1] * qd[1];
    }
    fn jacobian(&self, _: f64, q: &[f64], a: &mut [f64]) {
        a.copy_from_slice(q);
    }
}

/// `φ = (x² + y² − 1)/2`.
fn length_error(q: &[f64]) -> f64 {
    0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0)
}

/// `q̈ = g + Aᵀ λ` with `A q̈ + q̇·q̇ = 0`; y points up.
fn swing(_: f64, q: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]) {
    let lambda = -(qd[0] * qd[0] + qd[1] * qd[1] - G * q[1]) / (q[0] * q[0] + q[1] * q[1]);
    *qdd = [lambda * q[0], lambda * q[1] - G];
}

/// At rest at 60°.
fn raised() -> State<[f64; 2]> {
    let (sin, cos) = core::f64::consts::FRAC_PI_3.sin_cos();
    State::new([sin, -cos], [0.0, 0.0])
}

fn energy(state: &State<[f64; 2]>) -> f64 {
    0.5 * (state.qd[0] * state.qd[0] + state.qd[1] * state.qd[1]) + G * (state.q[1] + 1.0)
}

/// The method with its steps on the constraints.
fn projected<C>(method: Dop853, constraints: &C) -> Projected<Dop853, Onto<'_, C, f64, [f64; 64]>> {
    Projected { method, drift: Projector::new([0.0; 64]).onto(constraints) }
}

#[test]
fn the_pendulum_stays_on_its_circle() {
    let mut state = raised();
    let initial = energy(&state);
    let (mut open, mut drift) = (0.0_f64, 0.0_f64);
    let summary = projected(Dop853::new(1e-11, 1e-13), &Circle)
        .integrate(swing, 0.0, 1000.0, &mut state, |step| {
            // What the step begins with is what the projection left.
            open = open.max(length_error(&step.previous_state().q).abs());
            drift = drift.max((energy(step.previous_state()) / initial - 1.0).abs());
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(summary.time, 1000.0);
    assert!(open.max(length_error(&state.q).abs()) <= 1e-15, "{open:e}");
    assert!(drift <= 5e-9, "{drift:e}");
}

/// A rule of one's own: a length of 1, and no velocity along it.
#[derive(Clone)]
struct UnitLength;

impl Drift<f64> for UnitLength {
    fn remove<V: Coordinates<Scalar = f64>>(&mut self, _: f64, state: &mut State<V>) -> Result<(), ConstraintError> {
        let length = state.q.as_slice().iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return Err(ConstraintError::Open { row: 0, residual: -0.5 });
        }
        state.q.as_mut_slice().iter_mut().for_each(|x| *x /= length);
        let along: f64 = state.q.as_slice().iter().zip(state.qd.as_slice()).map(|(x, v)| x * v).sum();
        state.qd.as_mut_slice().iter_mut().zip(state.q.as_slice()).for_each(|(v, x)| *v -= along * x);
        Ok(())
    }
}

/// Where all directions weigh the same, the nearest state on the circle is the one along the radius.
#[test]
fn a_rule_of_ones_own_does_as_the_projection() {
    let go_on = |_: &mut dyn Step<[f64; 2]>| ControlFlow::Continue(());
    let [mut state, mut expected] = [raised(), raised()];
    let method = Projected { method: Dop853::new(1e-11, 1e-13), drift: UnitLength };
    method.integrate(swing, 0.0, 20.0, &mut state, go_on).unwrap();
    projected(Dop853::new(1e-11, 1e-13), &Circle).integrate(swing, 0.0, 20.0, &mut expected, go_on).unwrap();
    assert!((0..2).all(|i| (state.q[i] - expected.q[i]).abs() < 1e-9), "{state:?}, {expected:?}");
    assert!(length_error(&state.q).abs() <= 1e-15);
    // Nothing is near the origin: it stops there.
    let still = |_: f64, _: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]| *qdd = [0.0; 2];
    let result = method.integrate(still, 0.0, 1.0, &mut State::new([0.0; 2], [0.0; 2]), go_on);
    assert!(matches!(result, Err(IntegrationError::Constraint { error: ConstraintError::Open { row: 0, .. }, .. })));
}

#[test]
fn the_pendulum_keeps_its_period() {
    let mut times = Vec::new();
    let mut note = |t, _: &mut State<[f64; 2]>| {
        times.push(t);
        Response::Continue
    };
    let mut lowest = [Event::new(&|_, state: &State<[f64; 2]>| state.q[0]).with_action(&mut note)];
    projected(Dop853::new(1e-12, 1e-13), &Circle)
        .integrate_with_events(swing, 0.0, 22.0, &mut raised(), &mut lowest, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(times.len(), 20);
    let period = 2.153_242_351_783_842_6;
    for (i, time) in times.iter().enumerate() {
        assert!((time - (0.25 + 0.5 * i as f64) * period).abs() < 1e-9, "passage {i}: {time}");
    }
}

/// What takes away some of each step, before and behind an event.
#[derive(Clone)]
struct Back(f64);

impl Drift<f64> for Back {
    fn remove<V: Coordinates<Scalar = f64>>(&mut self, _: f64, state: &mut State<V>) -> Result<(), ConstraintError> {
        state.q.as_mut_slice()[0] -= self.0;
        Ok(())
    }
}

/// Where the projection leads back over the zero, it does not happen again where the motion is gone on with.
#[test]
fn a_projected_motion_goes_on_behind_its_terminal_event() {
    let go_on = |_: &mut dyn Step<[f64; 1]>| ControlFlow::Continue(());
    let glide = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
    let level = |_: f64, state: &State<[f64; 1]>| state.q[0] - 0.83;
    for back in [1e-6, 1e-12, 0.0, -1e-6] {
        let method = Projected { method: Rk4::new(0.25), drift: Back(back) };
        let (mut t, mut state, mut counts) = (0.0, State::new([0.0], [1.0]), [0; 2]);
        for count in &mut counts {
            let mut passed = [Event::new(&level).rising().terminal(), Event::new(&|t, _| t - 1.7)];
            let summary = method.integrate_with_events(glide, t, 2.0, &mut state, &mut passed, go_on).unwrap();
            (t, *count) = (summary.time, passed[0].count());
            assert!((summary.time - if *count == 1 { 0.83 } else { 2.0 }).abs() < 2e-5, "{back}: {summary:?}");
            assert_eq!(passed[0].last_time(), (*count == 1).then_some(t));
        }
        assert_eq!(counts, [1, 0], "{back}: {t}");
    }
    // What happens before the projected state is behind the zero is not jumped over.
    let method = Projected { method: Rk4::new(0.25), drift: Back(1e-6) };
    let (mut t, mut state, mut happened) = (0.0, State::new([0.0], [1.0]), 0);
    for _ in 0..4 {
        let mut passed = [Event::new(&level).rising().terminal(), Event::new(&|t, _| t - 0.830_000_3)];
        t = method.integrate_with_events(glide, t, 2.0, &mut state, &mut passed, go_on).unwrap().time;
        happened += passed[1].count();
    }
    assert_eq!((t, happened), (2.0, 1));
}

/// A blade on an incline that moves along its heading `φ` only: `sin φ ẋ − cos φ ẏ = 0`; x points down the slope.
struct KnifeEdge;

impl Constraints<f64> for KnifeEdge {
    fn rows(&self) -> usize {
        1
    }
    fn is_holonomic(&self, _: usize) -> bool {
        false
    }
    fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
        m.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    }
    fn position(&self, _: f64, _: &[f64], _: &mut [f64]) {}
    fn rate(&self, _: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        rate[0] = q[2].sin() * qd[0] - q[2].cos() * qd[1];
    }
    fn jacobian(&self, _: f64, q: &[f64], a: &mut [f64]) {
        a.copy_from_slice(&[q[2].sin(), -q[2].cos(), 0.0]);
    }
}

#[test]
fn the_knife_edge_goes_where_it_points() {
    // γ = φ̇ (cos φ ẋ + sin φ ẏ), λ = −(A g + γ), the slope 20°, φ̇ = 0.7 for ever.
    let pull = G * 20.0_f64.to_radians().sin();
    let slide = |_: f64, q: &[f64; 3], qd: &[f64; 3], qdd: &mut [f64; 3]| {
        let (sin, cos) = q[2].sin_cos();
        let lambda = -(pull * sin + qd[2] * (cos * qd[0] + sin * qd[1]));
        *qdd = [pull + lambda * sin, -lambda * cos, 0.0];
    };
    let mut state = State::new([0.0; 3], [0.0, 0.0, 0.7]);
    for (t, x, y) in
        [(1.0, 1.420_402_975_033_200_8, 0.709_403_768_523_874_7), (2.0, 3.323_649_620_933_192_5, 4.218_278_993_490_296)]
    {
        projected(Dop853::new(1e-12, 1e-13), &KnifeEdge)
            .integrate(slide, t - 1.0, t, &mut state, |_| ControlFlow::Continue(()))
            .unwrap();
        assert!((state.q[0] - x).hypot(state.q[1] - y) < 1e-10, "{state:?}");
        let mut rate = [0.0];
        KnifeEdge.rate(t, &state.q, &state.qd, &mut rate);
        assert!(rate[0].abs() < 1e-15);
    }
}

/// To the bit what an observer does that projects each step itself.
#[test]
fn a_projection_is_an_observer_that_replaces() {
    let (mut by_hand, mut state) = (raised(), raised());
    let mut projector = Projector::new([0.0; 64]);
    let method = Dop853::new(1e-8, 1e-10);
    let expected = method.integrate(swing, 0.0, 20.0, &mut by_hand, |step| {
        let mut nearest = *step.state();
        projector.project(&Circle, step.time(), &mut nearest)?;
        step.replace(&nearest);
        Ok::<_, ConstraintError>(ControlFlow::Continue(()))
    });
    let found = projected(method, &Circle).integrate(swing, 0.0, 20.0, &mut state, |_| ControlFlow::Continue(()));
    assert_eq!((found.unwrap(), state), (expected.unwrap(), by_hand));
}

#[test]
fn samples_and_stops_between_steps_are_on_the_constraints() {
    let method = projected(Dop853::new(1e-5, 1e-5), &Circle);
    let (mut state, mut seen) = (raised(), 0);
    method
        .sample(swing, 0.0, &[0.01, 0.3, 0.31, 2.0], &mut state, |_, state| {
            assert!(length_error(&state.q).abs() <= 1e-15);
            seen += 1;
        })
        .unwrap();
    assert_eq!(seen, 4);
    let mut state = raised();
    let summary = method.integrate(swing, 0.0, 2.0, &mut state, |step| {
        if step.time() > 1.0 { ControlFlow::Break(1.0) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(summary.unwrap().time, 1.0);
    assert!(length_error(&state.q).abs() <= 1e-15);
}

#[test]
fn what_does_not_close_ends_the_motion() {
    /// A circle that is torn open a second later.
    struct Torn;
    impl Constraints<f64> for Torn {
        fn rows(&self) -> usize {
            1
        }
        fn is_holonomic(&self, _: usize) -> bool {
            true
        }
        fn mass_matrix(&self, t: f64, q: &[f64], m: &mut [f64]) {
            Circle.mass_matrix(t, q, m);
        }
        fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
            phi[0] = if t > 1.0 { f64::NAN } else { length_error(q) };
        }
        fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
            Circle.rate(t, q, qd, rate);
        }
        fn jacobian(&self, t: f64, q: &[f64], a: &mut [f64]) {
            Circle.jacobian(t, q, a);
        }
    }
    let mut state = raised();
    let result =
        projected(Dop853::new(1e-9, 1e-9), &Torn).integrate(swing, 0.0, 2.0, &mut state, |_| ControlFlow::Continue(()));
    let Err(IntegrationError::Constraint { time, error: ConstraintError::NonFinite }) = result else {
        panic!("{result:?}")
    };
    assert!(time > 1.0 && state.is_finite());
}

#[test]
fn a_state_that_cannot_be_projected_is_not_handed_out() {
    /// A rule that has no state before 0.5 s.
    #[derive(Clone)]
    struct Late;
    impl Drift<f64> for Late {
        fn remove<V: Coordinates<Scalar = f64>>(&mut self, t: f64, _: &mut State<V>) -> Result<(), ConstraintError> {
            if t < 0.5 { Err(ConstraintError::NonFinite) } else { Ok(()) }
        }
    }
    let method = Projected { method: Dop853::new(1e-9, 1e-9).with_first_step(1.0), drift: Late };
    let still = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
    let refused = IntegrationError::Constraint { time: 0.25, error: ConstraintError::NonFinite };
    let result = method.integrate(still, 0.0, 1.0, &mut State::new([0.0], [1.0]), |step| {
        let mut there = State::new([7.0], [7.0]);
        assert_eq!((step.interpolate(0.25, &mut there), there), (Err(refused), State::new([7.0], [7.0])));
        ControlFlow::Continue(())
    });
    assert_eq!(result, Err(refused));
}
