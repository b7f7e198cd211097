//! Members of ensembles against motions alone: the same bits, steps, evaluations and errors.

use core::ops::ControlFlow;
use std::vec::Vec;

use super::*;
use crate::{Dop853, Integrator, Real, Rk4};

const TAU: f64 = core::f64::consts::TAU;

/// `r̈ = −r/|r|³` in the plane, drawn from the axis by `y tanh t`.
fn drawn_kepler<T: Scalar>(t: T, q: &[T; 2], _: &[T; 2], qdd: &mut [T; 2]) {
    let squared = q[0] * q[0] + q[1] * q[1];
    let cubed = squared * squared.sqrt();
    *qdd = [-q[0] / cubed, T::from_f64(1e-3) * t.tanh() * q[1] - q[1] / cubed];
}

/// Orbits of growing eccentricity, a fall into the centre, and a start that is NaN.
fn starts<R: Real>() -> Vec<State<[R; 2]>> {
    let mut starts: Vec<State<[f64; 2]>> = (0..11)
        .map(|i| {
            let eccentricity = 0.07 * f64::from(i);
            let speed = Scalar::sqrt((1.0 + eccentricity) / (1.0 - eccentricity));
            State::new([1.0 - eccentricity, 0.0], [0.0, speed])
        })
        .collect();
    starts.insert(4, State::new([1.0, 0.0], [0.0, 0.0]));
    starts.insert(6, State::new([1.0, f64::NAN], [0.0, 1.0]));
    starts.iter().map(|s| State::new(s.q.map(R::from_f64), s.qd.map(R::from_f64))).collect()
}

/// State and outcome of one member.
type Member<R> = (State<[R; 2]>, Outcome);

fn alone<R: Real, I: Integrator<R>>(integrator: &I, start: State<[R; 2]>, t: f64, t_end: f64) -> Member<R> {
    let mut state = start;
    let outcome = integrator.integrate(drawn_kepler, t, t_end, &mut state, |_| ControlFlow::Continue(()));
    (state, outcome)
}

fn together<L: Lanes, I: EnsembleIntegrator>(integrator: &I, t: f64, t_end: f64) -> Vec<Member<L::Real>> {
    let mut ensemble = Ensemble::<L, 2>::new(starts());
    let outcomes = ensemble.integrate(integrator, t, t_end, |_| drawn_kepler);
    ensemble.states().zip(outcomes).collect()
}

/// All of it, with the bits of all numbers.
fn text<R: Real>(members: &[Member<R>]) -> Vec<std::string::String> {
    let bits = |x: &[R; 2]| x.map(|x| x.to_f64().to_bits());
    members
        .iter()
        .map(|(state, outcome)| std::format!("{:?} {:?} {outcome:?}", bits(&state.q), bits(&state.qd)))
        .collect()
}

fn same<L: Lanes, I: EnsembleIntegrator + Integrator<L::Real>>(integrator: &I, spans: &[[f64; 2]]) {
    for &[t, t_end] in spans {
        let expected: Vec<_> = starts().into_iter().map(|start| alone(integrator, start, t, t_end)).collect();
        assert_eq!(text(&together::<L, I>(integrator, t, t_end)), text(&expected), "{t} to {t_end}");
    }
}

const SPANS: [[f64; 2]; 4] = [[0.0, 3.0 * TAU], [2.0, -5.0], [1.0, 1.0], [0.0, f64::NAN]];

fn dop853_is_itself<L: Lanes>()
where
    Dop853: Integrator<L::Real>,
{
    same::<L, _>(&Dop853::new(1e-9, 1e-12), &SPANS);
    same::<L, _>(&Dop853::new(1e-4, 1e-4).with_first_step(2.0).with_beta(0.05), &SPANS);
    same::<L, _>(&Dop853::new(1e-4, 1e-4).with_first_step(1e6), &SPANS);
    same::<L, _>(&Dop853::new(1e-9, 1e-9).with_max_steps(30).with_max_step(0.5), &SPANS);
    same::<L, _>(&Dop853::new(1e-12, 1e-12).with_min_step(1.0), &SPANS);
    same::<L, _>(&Dop853::new(0.0, 1e-9), &SPANS);
    same::<L, _>(&Dop853::new(1e-3, 1e-3).with_min_step(1.0).with_max_step(0.1), &SPANS);
}

fn rk4_is_itself<L: Lanes>()
where
    Rk4: Integrator<L::Real>,
{
    same::<L, _>(&Rk4::new(0.01), &SPANS);
    same::<L, _>(&Rk4::new(0.3), &SPANS);
    same::<L, _>(&Rk4::new(0.3).with_max_steps(3), &SPANS);
    same::<L, _>(&Rk4::new(-1.0), &SPANS);
}

#[test]
fn one_lane() {
    dop853_is_itself::<f64>();
    dop853_is_itself::<f32>();
    rk4_is_itself::<f64>();
    rk4_is_itself::<f32>();
}

#[cfg(feature = "wide")]
#[test]
fn lanes_of_doubles() {
    use wide::{f64x2, f64x4, f64x8};
    dop853_is_itself::<f64x2>();
    dop853_is_itself::<f64x4>();
    dop853_is_itself::<f64x8>();
    rk4_is_itself::<f64x2>();
    rk4_is_itself::<f64x4>();
    rk4_is_itself::<f64x8>();
}

#[cfg(feature = "wide")]
#[test]
fn lanes_of_single_precision() {
    use wide::{f32x4, f32x8, f32x16};
    dop853_is_itself::<f32x4>();
    dop853_is_itself::<f32x8>();
    dop853_is_itself::<f32x16>();
    rk4_is_itself::<f32x4>();
    rk4_is_itself::<f32x8>();
    rk4_is_itself::<f32x16>();
}

#[cfg(feature = "wide")]
#[test]
fn equal_members_are_equal_in_any_blocks() {
    let starts = || (0..5).map(|i| State::new([f64::from(i)], [0.0]));
    let mut ensemble = Ensemble::<wide::f64x4, 1>::new(starts());
    let outcomes = ensemble.integrate(&Dop853::new(1e-9, 1e-9), 0.0, 1.0, |_| {
        |_, q: &[wide::f64x4; 1], _: &_, qdd: &mut _| *qdd = [-q[0]]
    });
    assert!(outcomes.iter().all(Result::is_ok));
    assert_eq!(ensemble, Ensemble::new(ensemble.states()));
    assert_ne!(ensemble, Ensemble::new(starts()));
}

/// A singular place, met within a step at different stages: nobody else is disturbed.
#[test]
fn a_member_that_ends_early_leaves_the_others_alone() {
    let outcomes = together::<f64, _>(&Dop853::new(1e-9, 1e-12), 0.0, TAU);
    let bad: Vec<usize> = (0..).zip(&outcomes).filter(|(_, (_, outcome))| outcome.is_err()).map(|(i, _)| i).collect();
    assert_eq!(bad, [4, 6]);
    assert!(matches!(outcomes[6].1, Err(IntegrationError::NonFiniteState { time: 0.0 })));
    let time = outcomes[4].1.unwrap_err().time().unwrap();
    assert!((time - core::f64::consts::PI / Scalar::sqrt(8.0)).abs() < 1e-2, "{time}");
}

#[test]
fn parameters_of_members_are_packed_by_their_number() {
    fn frequencies<L: Lanes>() -> Vec<L::Real> {
        let mut oscillators = Ensemble::<L, 1>::new((0..7).map(|_| State::new([L::Real::one()], [L::Real::zero()])));
        let outcomes = oscillators.integrate(&Dop853::new(1e-6, 1e-6), 0.0, 1.0, |members| {
            assert!(members.range().len() <= L::COUNT);
            let square: L = members.pack(|member| L::Real::from_f64(member as f64));
            move |_, q, _, qdd| *qdd = [-square * q[0]]
        });
        assert!(outcomes.iter().all(Result::is_ok));
        oscillators
            .map(|members, state| state.q[0] + L::zero() * members.pack(|member| L::Real::from_f64(member as f64)))
    }
    let ends = frequencies::<f64>();
    for (i, end) in ends.iter().enumerate() {
        assert!((end - Scalar::cos(Scalar::sqrt(i as f64))).abs() < 1e-5);
    }
    #[cfg(feature = "wide")]
    assert_eq!(frequencies::<wide::f64x4>(), ends);
}

#[test]
fn what_has_no_member() {
    let mut none = Ensemble::<f64, 2>::new([]);
    assert!(none.is_empty() && none.states().next().is_none());
    assert!(none.integrate(&Rk4::new(0.1), 0.0, 1.0, |_| drawn_kepler).is_empty());
    assert!(none.map(|_, state| state.q).is_empty());
}
