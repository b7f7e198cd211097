//! Bodies and gravity, found again among the declared energies.

use crate::expr::{Expr, Graph, Matrix, Node, Symbol, Vector, evaluate, gradient};
use crate::model::lagrangian::Application;
use crate::model::landmark::Place;
use crate::model::{Body, Edge, FrameId, Lagrangian, PointForce};
use crate::numeric::moments::{Impossible, principal_moments};

use super::gravity;
use super::tree::force_element::{Anchor, ForceElement, Held};
use super::tree::inertia::Inertia;
use super::tree::linkage::{Linkage, Seat};
use super::tree::load::Load;
use super::{Energies, Symbols, carried, generalized_forces, sum};

/// A mechanism as a tree of masses in a uniform field, and everything else that it has.
#[derive(Clone, Debug)]
pub(super) struct Lifted<'g> {
    /// The links.
    pub(crate) linkage: Linkage<'g>,
    /// The masses of each link.
    pub(crate) inertias: Vec<Inertia<'g>>,
    /// The field's acceleration, in world axes.
    pub(crate) gravity: Vector<'g>,
    /// Forces on points of links and torques on them.
    pub(crate) loads: Vec<Load<'g>>,
    /// Terms of V that pull at points of links.
    pub(crate) springs: Vec<Held<'g>>,
    /// What drags on each link: masses whose kinetic energy is a part of D.
    pub(crate) drags: Vec<Inertia<'g>>,
    /// Terms of D between points of links.
    pub(crate) dampers: Vec<Held<'g>>,
    /// What is left of the energies and forces.
    pub(crate) rest: Energies<'g>,
}

impl<'g> Lifted<'g> {
    /// Whether T and V are bodies and their weight and nothing else, on joints that follow the coordinates linearly.
    pub(crate) fn is_all(&self) -> bool {
        self.rest.lagrangian.is_zero() && self.linkage.is_linear()
    }

    /// Whether nothing has inertia but bodies, on such joints, and what moves with one coordinate, as rotors do.
    pub(crate) fn has_all_inertia(&self, symbols: &Symbols) -> bool {
        self.linkage.is_linear() && self.own_inertia(symbols).is_some()
    }

    /// `∂²L/∂q̇ᵢ²` of what is no body; `None` where rates are coupled there, or L is no polynomial of them.
    pub(crate) fn own_inertia(&self, symbols: &Symbols) -> Option<Vec<Expr<'g>>> {
        let graph = self.rest.lagrangian.graph();
        let has_rates = |e: Expr<'g>, besides: Option<Symbol>| {
            let is_rate = |symbol| matches!(symbol, Symbol::Velocity(_)) && Some(symbol) != besides;
            let mut nodes = graph.reachable([e.id()]).into_iter();
            nodes.any(|id| matches!(graph.node(id), Node::Symbol(symbol) if is_rate(symbol)))
        };
        let own = |(momentum, &rate): (Expr<'g>, &Symbol)| {
            let inertia = gradient(momentum, &[rate])[0];
            (!has_rates(momentum, Some(rate)) && !has_rates(inertia, None)).then_some(inertia)
        };
        gradient(self.rest.lagrangian, &symbols.qd).into_iter().zip(&symbols.qd).map(own).collect()
    }
}

/// Splits a mechanism into bodies in a field and the rest; `None` where no body is on a tree.
///
/// A body that turns by a quaternion stays with the rest: off the unit sphere its energy is not a rigid body's, and
/// Lagrange's equations are about all quaternions. So does an inertia that no body has: regrouping would lose its
/// digits.
pub(super) fn lifted<'g>(lagrangian: &Lagrangian<'_>, energies: &Energies<'g>, graph: &'g Graph) -> Option<Lifted<'g>> {
    let is_tree = |frame: FrameId| {
        let mut way = lagrangian.frames.way_to_world(frame);
        !way.any(|at| at.edge.as_ref().is_some_and(is_quaternion))
    };
    let (bodies, mut other_kinetic) = lagrangian.landmarks.bodies_of(&lagrangian.kinetic, is_tree);
    let is_physical = |body: &Body<'_>| is_tree(body.frame) && !is_impossible(body.inertia);
    let (bodies, others): (Vec<_>, Vec<_>) = bodies.into_iter().partition(is_physical);
    other_kinetic.extend(others.iter().map(|body| lagrangian.energy_of(body)));
    let bodies: Vec<Body<'g>> = bodies.iter().map(|body| carried_body(body, graph)).collect();
    let [dissipation, _] = lagrangian.dissipation_without_and_with_inputs();
    let (drags, mut other_dissipation) = lagrangian.landmarks.bodies_of(&dissipation, is_tree);
    let (drags, others): (Vec<_>, Vec<_>) = drags.into_iter().partition(is_physical);
    other_dissipation.extend(others.iter().map(|body| lagrangian.energy_of(body)));
    let drags: Vec<Body<'g>> = drags.iter().map(|body| carried_body(body, graph)).collect();
    let (applications, other_forces): (Vec<&PointForce<'_>>, Vec<_>) =
        lagrangian.point_forces.iter().partition(|force| force.application.is_some_and(|at| is_tree(at.frame)));
    let applications = applications.iter().filter_map(|force| force.application);
    let field = gravity::field(lagrangian, &bodies, graph);
    let (gravity, other_potential) = field.unwrap_or_else(|| (Vector::zero(graph), lagrangian.potential.clone()));
    let on_trees = |element: &Element<'_>| element.1.iter().all(|place| is_tree(place.frame));
    let landmarks = &lagrangian.landmarks;
    let (springs, other_potential) =
        split(&other_potential, |term| ForceElement::spring(term, landmarks).filter(on_trees));
    let (dampers, other_dissipation) =
        split(&other_dissipation, |term| ForceElement::damper(term, landmarks).filter(on_trees));
    let ends = springs.iter().chain(&dampers).flat_map(|(_, places)| places.iter().map(|place| place.frame));
    let frames = bodies.iter().map(|body| body.frame).chain(applications.clone().map(|at| at.frame)).chain(ends);
    let frames = frames.chain(drags.iter().map(|drag| drag.frame));
    let (linkage, seats) = Linkage::of(lagrangian, &frames.collect::<Vec<_>>(), graph)?;
    let mut seats = seats.iter();
    let inertias = seated(&bodies, &mut seats, &linkage, graph);
    let loads = applications.zip(seats.by_ref()).map(|(at, seat)| load(&at, seat, graph)).collect();
    let mut held = |elements: Vec<Element<'_>>| -> Vec<Held<'g>> {
        let hold = |(element, places): Element<'_>| {
            let anchors = places.iter().zip(seats.by_ref()).map(|(place, seat)| anchor(place, seat, graph));
            Held { element, anchors: anchors.collect() }
        };
        elements.into_iter().map(hold).collect()
    };
    let (springs, dampers) = (held(springs), held(dampers));
    let drags = seated(&drags, &mut seats, &linkage, graph);
    if inertias.iter().all(Inertia::is_zero) || !linkage.has_joints() {
        return None;
    }
    let forces = generalized_forces(lagrangian, &other_forces, graph);
    let dissipation = sum(&other_dissipation, graph);
    let rest = energies.with_terms(&other_kinetic, &other_potential);
    let rest = Energies { forces, dissipation, ..rest };
    Some(Lifted { linkage, inertias, gravity, loads, springs, drags, dampers, rest })
}

/// A force element with its places.
type Element<'v> = (ForceElement, Vec<Place<'v>>);

/// The terms that are force elements, and the others.
fn split<'v>(
    terms: &[Expr<'v>],
    element_of: impl Fn(Expr<'v>) -> Option<Element<'v>>,
) -> (Vec<Element<'v>>, Vec<Expr<'v>>) {
    let (mut elements, mut others) = (Vec::new(), Vec::new());
    for &term in terms {
        match element_of(term) {
            Some(element) => elements.push(element),
            None => others.push(term),
        }
    }
    (elements, others)
}

/// What bodies add up to on each link.
fn seated<'g, 's>(
    bodies: &[Body<'g>],
    seats: &mut impl Iterator<Item = &'s Seat<'g>>,
    linkage: &Linkage<'g>,
    graph: &'g Graph,
) -> Vec<Inertia<'g>>
where
    'g: 's,
{
    let mut inertias = vec![Inertia::zero(graph); linkage.links.len()];
    for (body, seat) in bodies.iter().zip(seats) {
        let own = Inertia::of_body(body.mass, body.com, body.inertia);
        let turned = seat.turn.map_or(own, |turn| own.turned(turn));
        inertias[seat.link] = inertias[seat.link].plus(turned.shifted(seat.shift));
    }
    inertias
}

fn anchor<'g>(place: &Place<'_>, seat: &Seat<'g>, graph: &'g Graph) -> Anchor<'g> {
    let point = Vector(carried(place.coordinates.0, graph));
    Anchor { link: seat.link, point: seat.shift + seat.in_link(point) }
}

fn load<'g>(at: &Application<'_>, seat: &Seat<'g>, graph: &'g Graph) -> Load<'g> {
    let vector = Vector(carried(at.vector.0, graph));
    Load {
        link: seat.link,
        point: at.point.map(|point| seat.shift + seat.in_link(Vector(carried(point.0, graph)))),
        vector: if at.is_in_world { vector } else { seat.in_link(vector) },
        is_in_world: at.is_in_world,
    }
}

fn is_quaternion(edge: &Edge<'_>) -> bool {
    matches!(edge, Edge::Quaternion(_))
}

/// Whether no body has this inertia; of one that depends on parameters, nothing is known.
fn is_impossible(inertia: Option<Matrix<'_>>) -> bool {
    let entries: Vec<Expr<'_>> = inertia.iter().flat_map(|matrix| matrix.0.into_iter().flatten()).collect();
    principal_moments(&evaluate(&entries, |_| f64::NAN)).is_some_and(|moments| Impossible::of(moments).is_some())
}

/// A body in the graph with rules; what it is made of is constant in time.
fn carried_body<'g>(body: &Body<'_>, graph: &'g Graph) -> Body<'g> {
    Body {
        mass: carried([body.mass], graph)[0],
        com: Vector(carried(body.com.0, graph)),
        inertia: body.inertia.map(|inertia| Matrix(inertia.0.map(|row| carried(row, graph)))),
        frame: body.frame,
    }
}
