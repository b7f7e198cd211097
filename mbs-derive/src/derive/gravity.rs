//! The uniform field in which all bodies weigh what they weigh, found among the terms of V.
//!
//! `V = −Σ g·(m p + R h)` over frames with mass m, moment h, origin p, attitude R: gravity is then the same as a base that
//! accelerates by −g, and needs no forces of its own.

use std::collections::BTreeMap;

use crate::expr::{Expr, Graph, Node, Vector, carry_out, normal_form};
use crate::model::{Body, FrameId, Lagrangian};

use super::time_derivative;

/// What V says of one frame: the factors of its origin's coordinates and of the moments, per axis of the world.
#[derive(Clone, Copy, Debug)]
struct Weight<'g> {
    /// Of the places' world components.
    force: Vector<'g>,
    /// Of the places' coordinates in the frame, per axis.
    moments: [Vector<'g>; 3],
}

/// The field's acceleration g in world axes, and the terms of V that are not gravity.
///
/// `None` where the places in V do not weigh what the bodies there do.
pub(super) fn field<'v, 'g>(
    lagrangian: &Lagrangian<'v>,
    bodies: &[Body<'g>],
    graph: &'g Graph,
) -> Option<(Vector<'g>, Vec<Expr<'v>>)> {
    let parts = lagrangian.potential.iter().map(|&term| lagrangian.landmarks.places_of(term));
    let (places, rest): (Vec<_>, Vec<_>) = parts.unzip();
    let zero = graph.integer(0);
    let nothing = Weight { force: Vector([zero; 3]), moments: [Vector([zero; 3]); 3] };
    let mut weights: BTreeMap<FrameId, Weight<'g>> = BTreeMap::new();
    let mut field = Vector([zero; 3]);
    for (factor, place) in places.concat() {
        let [factor, x, y, z] =
            carried([factor, place.coordinates.0[0], place.coordinates.0[1], place.coordinates.0[2]], graph);
        let weight = weights.entry(place.frame).or_insert(nothing);
        weight.force.0[place.axis] = weight.force.0[place.axis] + factor;
        weight.moments[place.axis] = weight.moments[place.axis] + Vector([x, y, z]).scale(factor);
        if field.0[place.axis].is_zero() {
            let here = bodies.iter().filter(|body| body.frame == place.frame);
            field.0[place.axis] = -here.filter_map(|body| quotient(factor, body.mass)).next().unwrap_or(zero);
        }
    }
    let masses = bodies.iter().fold(BTreeMap::new(), |mut masses: BTreeMap<FrameId, (Expr<'g>, Vector<'g>)>, body| {
        let moments = masses.entry(body.frame).or_insert((zero, nothing.force));
        *moments = (moments.0 + body.mass, moments.1 + body.com.scale(body.mass));
        masses
    });
    let mut frames: Vec<FrameId> = weights.keys().chain(masses.keys()).copied().collect();
    frames.sort();
    frames.dedup();
    let agree = frames.iter().all(|frame| {
        let (mass, first) = masses.get(frame).copied().unwrap_or((zero, nothing.force));
        let weight = weights.get(frame).copied().unwrap_or(nothing);
        (0..3).all(|axis| {
            let g = field.0[axis];
            are_opposite(&[weight.force.0[axis]], &[g * mass])
                && are_opposite(&weight.moments[axis].0, &first.scale(g).0)
        })
    });
    (agree && field.0.iter().any(|g| !g.is_zero())).then(|| (field, rest.concat()))
}

fn carried<'g, const N: usize>(expressions: [Expr<'_>; N], graph: &'g Graph) -> [Expr<'g>; N] {
    let carried = carry_out(&expressions, graph, |symbol| time_derivative(symbol, graph));
    std::array::from_fn(|i| carried[i])
}

/// Terms of more products are not compared.
const MOST_TERMS: usize = 100;

/// Whether a = −b; constants up to rounding, which the largest of them sets.
fn are_opposite<'g>(a: &[Expr<'g>], b: &[Expr<'g>]) -> bool {
    let size = |e: &Expr<'_>| e.as_constant().map_or(0.0, |value| value.to_f64().abs());
    let largest = a.iter().chain(b).map(size).fold(0.0, f64::max);
    a.iter().zip(b).all(|(&a, &b)| {
        let sum = normal_form(&[a + b], MOST_TERMS).map_or(a + b, |forms| forms[0]);
        sum.is_zero() || sum.as_constant().is_some_and(|sum| sum.to_f64().abs() <= 1e-12 * largest)
    })
}

/// `a / b` where b is a number or a factor of a.
fn quotient<'g>(a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    let graph = a.graph();
    if b.is_zero() {
        return None;
    }
    if b.as_constant().is_some() {
        return Some(a / b);
    }
    let mut others = graph.integer(1);
    let mut waiting = vec![a];
    let mut found = false;
    while let Some(factor) = waiting.pop() {
        match factor.node() {
            _ if factor == b && !found => found = true,
            Node::Mul(x, y) => waiting.extend([graph.expr(x), graph.expr(y)]),
            Node::Neg(x) => {
                others = -others;
                waiting.push(graph.expr(x));
            }
            _ => others = others * factor,
        }
    }
    found.then_some(others)
}
