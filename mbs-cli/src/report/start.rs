//! A state to begin with, where none is given: one that satisfies the constraints, moves, and is far from zero.

use mbs_derive::expr::Number;
use mbs_derive::interpret::State;
use mbs_derive::optimise::Derivation;
use mbs_derive::variable::Variable;
use mbs_runtime::RedundantRows;

use crate::equations::{Equations, Solver};
use crate::state::Point;

/// How far lengths are from zero, one guess after the other.
const LENGTHS: [f64; 5] = [0.0, 0.3, 1.0, 10.0, 1e7];

/// Rates of all coordinates: where nothing pulls, only what moves already goes on moving.
const RATES: [f64; 2] = [0.0, 1.0];

/// The first guess that moves; else the first from which there are accelerations; all zero, where there is none.
pub(super) fn of(derivation: &Derivation) -> Point {
    let guesses = RATES.iter().flat_map(|&rate| LENGTHS.iter().map(move |&length| (length, rate)));
    let mut still = None;
    for (length, rate) in guesses {
        match started(derivation, point(derivation, coordinates(derivation, length), rate)) {
            Some((point, true)) => return point,
            Some((point, false)) => still = still.or(Some(point)),
            None => {}
        }
    }
    still.unwrap_or_else(|| point(derivation, vec![0.0; derivation.dof()], 0.0))
}

/// A guess on the constraints, and whether it moves; nothing where there are no accelerations, or huge ones.
fn started(derivation: &Derivation, mut point: Point) -> Option<(Point, bool)> {
    let equations = Equations::new(derivation, &point).ok()?;
    let mut motion = equations.start();
    if !derivation.constraints.is_empty() {
        equations.projector(RedundantRows::LeaveOut).project(&equations, 0.0, &mut motion).ok()?;
    }
    let state = equations.state(0.0, &motion.q, &motion.qd);
    let found = Solver::closed(&equations).accelerations(&state).ok()?;
    let is_moderate = found.iter().all(|x| x.abs() < 1e6);
    let moves = found.iter().chain(&motion.qd).any(|x| x.abs() > 1e-9);
    (point.state.q, point.state.qd) = (motion.q, motion.qd);
    is_moderate.then_some((point, moves))
}

fn point(derivation: &Derivation, q: Vec<f64>, rate: f64) -> Point {
    let count = |variables: &[Variable]| variables.iter().map(Variable::count).sum::<usize>();
    let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults).copied().map(Number::to_f64);
    let state = State {
        t: 0.0,
        qd: vec![rate; q.len()],
        qdd: vec![0.0; q.len()],
        q,
        u: vec![0.0; count(&derivation.inputs)],
        prescribed: vec![[0.0; 3]; count(&derivation.prescribed)],
    };
    Point { state, accelerations_are_given: false, parameters: defaults.collect() }
}

/// Coordinates to begin a motion at: angles of half a radian or more, quaternions of no turn, lengths from `length` on.
fn coordinates(derivation: &Derivation, length: f64) -> Vec<f64> {
    let mut q = Vec::new();
    for variable in &derivation.coordinates {
        let is_quaternion = variable.unit == "1" && variable.length == Some(4);
        for i in 0..variable.count() {
            let number = q.len() as f64;
            q.push(match variable.unit.as_str() {
                "rad" => (100.0 * (0.5 + 0.7 / (1.0 + number))).round() / 100.0,
                "1" if is_quaternion => f64::from(u8::from(i == 0)),
                "1" => 0.3,
                _ => length * (100.0 + 37.0 * number) / 100.0,
            });
        }
    }
    q
}
