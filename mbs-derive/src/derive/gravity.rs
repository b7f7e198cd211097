//! The uniform field in which all bodies weigh what they weigh, found among the terms of V.
//!
//! `V = −Σ g·(m p + R h)` over frames with mass m, moment h, origin p, attitude R: gravity is then the same as a base
//! that accelerates by −g, and needs no forces of its own.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Expr, Graph, Kept, Node, Vector, normal_form};
use crate::model::landmark::Place;
use crate::model::{Body, FrameId, Lagrangian};

use super::carried;

/// What V says of one frame: the factors of its origin's coordinates and of the moments, per axis of the world.
#[derive(Clone, Copy, Debug)]
struct Weight<'g> {
    /// The factor of the places' world components.
    force: Vector<'g>,
    /// The factors of the places' coordinates in the frame, per axis.
    moments: [Vector<'g>; 3],
}

/// What T says of one frame.
#[derive(Clone, Debug)]
struct Masses<'g> {
    /// The mass of each body.
    single: Vec<Expr<'g>>,
    /// m
    sum: Expr<'g>,
    /// h
    moment: Vector<'g>,
}

type OfFrames<T> = BTreeMap<FrameId, T>;

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
    let places =
        places.concat().into_iter().map(|(factor, place)| carried_place(factor, place, graph)).collect::<Vec<_>>();
    let masses = masses(bodies, graph);
    let field = acceleration(&places, &masses, graph);
    let found = field.0.iter().any(|g| !g.is_zero()) && agree(&weights(&places, graph), &masses, field);
    found.then(|| (field, rest.concat()))
}

fn carried_place<'g>(factor: Expr<'_>, place: Place<'_>, graph: &'g Graph) -> (Expr<'g>, Place<'g>) {
    let [x, y, z] = place.coordinates.0;
    let [factor, x, y, z] = carried([factor, x, y, z], graph);
    (factor, Place { axis: place.axis, coordinates: Vector([x, y, z]), frame: place.frame })
}

fn masses<'g>(bodies: &[Body<'g>], graph: &'g Graph) -> OfFrames<Masses<'g>> {
    let mut masses = OfFrames::new();
    for body in bodies {
        let nothing = || Masses { single: Vec::new(), sum: graph.integer(0), moment: Vector::zero(graph) };
        let here = masses.entry(body.frame).or_insert_with(nothing);
        here.single.push(body.mass);
        here.sum = here.sum + body.mass;
        here.moment = here.moment + body.com.scale(body.mass);
    }
    masses
}

/// Along each axis as the first place has it whose factor is the weight of a body there.
fn acceleration<'g>(places: &[(Expr<'g>, Place<'g>)], masses: &OfFrames<Masses<'g>>, graph: &'g Graph) -> Vector<'g> {
    let mut field = Vector::zero(graph);
    for (factor, place) in places {
        if field.0[place.axis].is_zero()
            && let Some(here) = masses.get(&place.frame)
            && let Some(g) = here.single.iter().find_map(|&mass| quotient(*factor, mass))
        {
            field.0[place.axis] = -g;
        }
    }
    field
}

fn weights<'g>(places: &[(Expr<'g>, Place<'g>)], graph: &'g Graph) -> OfFrames<Weight<'g>> {
    let nothing = Weight { force: Vector::zero(graph), moments: [Vector::zero(graph); 3] };
    let mut weights = OfFrames::new();
    for &(factor, Place { axis, coordinates, frame }) in places {
        let weight = weights.entry(frame).or_insert(nothing);
        weight.force.0[axis] = weight.force.0[axis] + factor;
        weight.moments[axis] = weight.moments[axis] + coordinates.scale(factor);
    }
    weights
}

/// Whether each frame weighs what its masses do.
fn agree<'g>(weights: &OfFrames<Weight<'g>>, masses: &OfFrames<Masses<'g>>, field: Vector<'g>) -> bool {
    let zero = Vector::zero(field.0[0].graph());
    let frames: BTreeSet<FrameId> = weights.keys().chain(masses.keys()).copied().collect();
    frames.iter().all(|frame| {
        let (mass, moment) = masses.get(frame).map_or((zero.0[0], zero), |here| (here.sum, here.moment));
        let (force, moments) = weights.get(frame).map_or((zero, [zero; 3]), |weight| (weight.force, weight.moments));
        (0..3).all(|axis| {
            let g = field.0[axis];
            are_opposite(&[force.0[axis]], &[g * mass]) && are_opposite(&moments[axis].0, &moment.scale(g).0)
        })
    })
}

/// Terms of more products are not compared.
const MOST_TERMS: usize = 100;

/// Whether a = −b; constants up to rounding, which the largest of them sets.
fn are_opposite<'g>(a: &[Expr<'g>], b: &[Expr<'g>]) -> bool {
    let size = |e: &Expr<'_>| e.as_constant().map_or(0.0, |value| value.to_f64().abs());
    let largest = a.iter().chain(b).map(size).fold(0.0, f64::max);
    a.iter().zip(b).all(|(&a, &b)| {
        let sum = normal_form(&[a + b], &Kept::default(), MOST_TERMS).map_or(a + b, |forms| forms[0]);
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

#[cfg(test)]
mod tests {
    use super::super::Energies;
    use super::super::lift::lifted;
    use super::*;

    /// Of two masses on a swinging link, with this potential: g, and whether no other force is left.
    fn found(potential: &str, mass: &str) -> ([f64; 3], bool) {
        let text = format!(
            "#![dimensionless]\nmechanism A {{ const m: 1 = {mass}; coord a: 1; let link = rot_y(a)*translation([1, 0, 0]); \
             let p = link.point([0.1, 0, 0.2]); let w = link.point([0, 0, 0]); \
             kinetic += particle(m, p); kinetic += particle(2*m, w); potential += {potential}; }}"
        );
        let declarations = Graph::verbatim();
        let (lagrangian, _) =
            crate::declared(&text, &declarations, &[]).unwrap_or_else(|e| panic!("{}", e.render("a", &text)));
        let graph = Graph::new();
        let lifted = lifted(&lagrangian, &Energies::carried_out(&lagrangian, &graph), &graph).expect("two particles");
        let value = |e: Expr<'_>| e.as_constant().expect("a number").to_f64();
        (lifted.gravity.0.map(value), lifted.springs.is_empty() && lifted.rest.potential.is_zero())
    }

    #[test]
    fn a_uniform_field_is_found() {
        assert_eq!(found("m*9.81*p.z + 2*m*9.81*w.z", "3"), ([0.0, 0.0, -9.81], true));
        assert_eq!(found("m*(p.z + 2*w.z) - 2*m*(p.x + 2*w.x)", "3"), ([2.0, 0.0, -1.0], true));
    }

    #[test]
    fn what_is_no_weight_is_another_force() {
        assert_eq!(found("m*9.81*p.z + 2.001*m*9.81*w.z", "3"), ([0.0; 3], false));
        assert_eq!(found("m*9.81*p.z", "3"), ([0.0; 3], false));
        assert_eq!(found("m*9.81*p.z + m*w.z", "3"), ([0.0; 3], false));
    }

    #[test]
    fn tiny_masses_are_compared_with_tiny_weights() {
        assert_eq!(found("m*9.81*p.z + 2*m*9.81*w.z", "1e-20"), ([0.0, 0.0, -9.81], true));
        assert_eq!(found("m*9.81*p.z", "1e-20"), ([0.0; 3], false));
    }
}
