//! Differences of places, formed in the nearest frame that all of them hang from.
//!
//! World components of a point carry the whole way from the origin of the world: the radius of an orbit, the track of a
//! vehicle. What two points share of it cancels in their difference, but only as far as rounding lets it: 1e-9 m are
//! left of an orbit's radius. So a world component that is a sum of places with numbers, `a.x`, `a.x/2 + b.x/2 + c`, is
//! remembered as such, and where the numbers add up to zero, the sum is formed anew, in the axes of the nearest common
//! frame, of what differs below it. Velocities of points are differences in the same way: `dt(a) − dt(b) = dt(a − b)`.
//!
//! An expression that is missing in the table is a difference of world components, as it was before.

use crate::expr::graph::IdMap;
use crate::expr::{Expr, Node, Number, Vector};
use crate::model::frame::{Edge, FrameId};
use crate::model::landmark::Motion;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::Resolver;
use crate::model::value::{Free, Point, Value};

/// Longer sums are left as they are.
const MOST_TERMS: usize = 8;

/// What is added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Places.
    Places,
    /// Their velocities.
    Velocities,
}

/// `Σ wᵢ pᵢ`, or its time derivative; no place twice, no number zero.
#[derive(Clone, Debug, PartialEq)]
struct Combination<'g> {
    kind: Kind,
    terms: Vec<(Number, Point<'g>)>,
}

/// A world component of a combination, and what else is added to it.
#[derive(Clone, Debug)]
struct Component<'g> {
    axis: usize,
    combination: Combination<'g>,
    rest: Option<Expr<'g>>,
}

/// What is known of expressions.
#[derive(Default)]
pub(in crate::model) struct Differences<'g> {
    components: IdMap<Component<'g>>,
    /// World components of differences that were formed: along which axis, and of what.
    formed: IdMap<(usize, Free<'g>)>,
}

impl<'g> Combination<'g> {
    /// `self ± other`; `None` where they are of two kinds, or too long.
    fn plus(&self, other: &Self, minus: bool) -> Option<Self> {
        if self.kind != other.kind {
            return None;
        }
        let mut sum = self.clone();
        for &(weight, point) in &other.terms {
            let weight = if minus { -weight } else { weight };
            match sum.terms.iter_mut().find(|(_, known)| *known == point) {
                Some((known, _)) => *known = *known + weight,
                None => sum.terms.push((weight, point)),
            }
        }
        sum.terms.retain(|(weight, _)| !weight.is_zero());
        (!sum.terms.is_empty() && sum.terms.len() <= MOST_TERMS).then_some(sum)
    }

    fn scaled(&self, factor: Number) -> Self {
        Combination { terms: self.terms.iter().map(|&(weight, point)| (weight * factor, point)).collect(), ..*self }
    }

    /// Whether where the origin is does not matter.
    fn is_difference(&self) -> bool {
        self.terms.iter().fold(Number::ZERO, |sum, &(weight, _)| sum + weight).is_zero()
    }
}

impl<'g> Component<'g> {
    fn plus(&self, other: &Self, minus: bool) -> Option<Self> {
        let combination = self.combination.plus(&other.combination, minus).filter(|_| self.axis == other.axis)?;
        let rest = match (self.rest, other.rest) {
            (Some(a), Some(b)) if minus && a == b => None,
            (Some(a), Some(b)) => Some(if minus { a - b } else { a + b }),
            (Some(a), None) => Some(a),
            (None, Some(b)) => Some(if minus { -b } else { b }),
            (None, None) => None,
        };
        Some(Component { axis: self.axis, combination, rest })
    }
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// That these are the world components of a point.
    pub(in crate::model) fn note_components(&mut self, position: Vector<'g>, point: Point<'g>) {
        for (axis, &component) in position.0.iter().enumerate() {
            self.note_component(component, axis, point);
        }
    }

    /// That an expression is a world component of a point.
    pub(in crate::model) fn note_component(&mut self, component: Expr<'g>, axis: usize, point: Point<'g>) {
        let combination = Combination { kind: Kind::Places, terms: vec![(Number::ONE, point)] };
        self.note(component, Component { axis, combination, rest: None });
    }

    /// That an expression is a world component of the velocity of something.
    pub(in crate::model) fn note_component_of_velocity(
        &mut self,
        component: Expr<'g>,
        axis: usize,
        velocity: Vector<'g>,
    ) {
        if let Some(combination) = self.velocity(velocity) {
            self.note(component, Component { axis, combination, rest: None });
        }
    }

    /// That an expression is a multiple of another.
    pub(in crate::model) fn note_multiple(&mut self, of: Expr<'g>, by: Expr<'g>, multiple: Expr<'g>) {
        let Some(factor) = self.known.facts.constant(by).filter(|factor| !factor.is_zero()) else { return };
        if let Some(known) = self.known.differences.components.get(&of.id()) {
            let (combination, rest) = (known.combination.scaled(factor), known.rest.map(|rest| by * rest));
            self.note(multiple, Component { combination, rest, ..*known });
        }
    }

    /// The time derivative of a world component of a difference that was formed: that of the difference.
    pub(in crate::model) fn rate_of_difference(&mut self, component: Expr<'g>) -> Option<Expr<'g>> {
        let (axis, difference) = self.known.differences.formed.get(&component.id()).copied()?;
        let components = self.rate_of_components(difference);
        let dimension = self.dimension(Dimension::VELOCITY);
        let rate = self.noted(Free { components, dimension, ..difference });
        Some(rate.0[axis])
    }

    /// The world components of a difference, by which it is found again.
    fn noted(&mut self, difference: Free<'g>) -> Vector<'g> {
        let world = self.in_world(difference);
        for (axis, component) in world.0.iter().enumerate() {
            self.known.differences.formed.insert(component.id(), (axis, difference));
        }
        world
    }

    /// That an expression is the time derivative of another.
    pub(in crate::model) fn note_rate(&mut self, of: Expr<'g>, rate: Expr<'g>) {
        let known = self.known.differences.components.get(&of.id());
        let Some(Component { axis, combination, rest }) = known.filter(|c| c.combination.kind == Kind::Places) else {
            return;
        };
        let combination = Combination { kind: Kind::Velocities, terms: combination.terms.clone() };
        let (axis, rest) = (*axis, rest.map(Expr::rate));
        self.note(rate, Component { axis, combination, rest });
    }

    /// Numbers and symbols mean what they mean elsewhere as well.
    fn note(&mut self, expr: Expr<'g>, component: Component<'g>) {
        if !matches!(expr.node(), Node::Constant(_) | Node::Symbol(_)) {
            self.known.differences.components.insert(expr.id(), component);
        }
    }

    /// `a ± b`, where both may be world components of places.
    pub(in crate::model) fn sum_of_numbers(&mut self, a: Expr<'g>, b: Expr<'g>, minus: bool) -> Expr<'g> {
        let of = |e: Expr<'g>| self.known.differences.components.get(&e.id());
        let sum = match (of(a), of(b)) {
            (Some(a), Some(b)) => a.plus(b, minus),
            (Some(a), None) => Some(Component { rest: Some(added(a.rest, b, minus)), ..a.clone() }),
            (None, Some(b)) => {
                let factor = if minus { -Number::ONE } else { Number::ONE };
                let rest = b.rest.map_or(a, |rest| if minus { a - rest } else { a + rest });
                Some(Component { combination: b.combination.scaled(factor), rest: Some(rest), ..*b })
            }
            (None, None) => None,
        };
        let Some(sum) = sum else { return if minus { a - b } else { a + b } };
        if let Some(difference) = self.formed(&sum.combination) {
            let component = self.in_world(difference).0[sum.axis];
            return sum.rest.map_or(component, |rest| component + rest);
        }
        let plain = if minus { a - b } else { a + b };
        self.note(plain, sum);
        plain
    }

    /// `a ± b`, where that is a difference of places in a common frame that is not the world.
    pub(in crate::model) fn difference(
        &mut self,
        (a, left): (&Value<'g>, Free<'g>),
        (b, right): (&Value<'g>, Free<'g>),
        minus: bool,
    ) -> Option<Free<'g>> {
        let ((a, added_to_a), (b, added_to_b)) = (self.combination(a, left)?, self.combination(b, right)?);
        let difference = self.formed(&a.plus(&b, minus)?)?;
        let rest = match (added_to_a, added_to_b) {
            (None, None) => return Some(difference),
            (Some(a), None) => a,
            (None, Some(b)) if minus => -b,
            (None, Some(b)) => b,
            (Some(a), Some(b)) if minus => a - b,
            (Some(a), Some(b)) => a + b,
        };
        Some(Free { components: self.in_world(difference) + rest, frame: FrameId::WORLD, ..difference })
    }

    /// The vector that three numbers are the world components of, where that is a difference that was formed.
    pub(in crate::model) fn difference_with(&self, components: [Expr<'g>; 3]) -> Option<Free<'g>> {
        let of = |axis: usize| match self.known.differences.formed.get(&components[axis].id()) {
            Some((along, vector)) if *along == axis => Some(*vector),
            _ => None,
        };
        let [x, y, z] = [of(0)?, of(1)?, of(2)?];
        let same = |a: Free<'g>| a.frame == x.frame && a.components == x.components;
        (same(y) && same(z)).then_some(x)
    }

    /// What a vector adds up, and in world axes what is added to that.
    fn combination(&self, value: &Value<'g>, vector: Free<'g>) -> Option<(Combination<'g>, Option<Vector<'g>>)> {
        if let Value::Point(point) = value {
            return Some((Combination { kind: Kind::Places, terms: vec![(Number::ONE, *point)] }, None));
        }
        if let Some(velocity) = self.velocity(vector.components) {
            return Some((velocity, None));
        }
        if !self.same_axes(vector.frame, FrameId::WORLD) {
            return None;
        }
        let of = |axis: usize| {
            let known = self.known.differences.components.get(&vector.components.0[axis].id());
            known.filter(|component| component.axis == axis)
        };
        let all = [of(0)?, of(1)?, of(2)?];
        let combination = all[0].combination.clone();
        let rest = Vector(all.map(|component| component.rest.unwrap_or_else(|| self.graph.integer(0))));
        let has_rest = all.iter().any(|component| component.rest.is_some());
        all.iter()
            .all(|component| component.combination == combination)
            .then_some((combination, has_rest.then_some(rest)))
    }

    /// The point whose velocity this is.
    fn velocity(&self, vector: Vector<'g>) -> Option<Combination<'g>> {
        match self.lagrangian.landmarks.motion(vector)? {
            Motion::Velocity { factor, coordinates, frame } if factor.is_one() => {
                Some(Combination { kind: Kind::Velocities, terms: vec![(Number::ONE, Point { coordinates, frame })] })
            }
            Motion::Velocity { .. } | Motion::Turning { .. } => None,
        }
    }

    /// The combination in the axes of the nearest common frame of its places, where it is a difference and that frame
    /// is not the world.
    fn formed(&mut self, combination: &Combination<'g>) -> Option<Free<'g>> {
        if !combination.is_difference() {
            return None;
        }
        let frames = &self.lagrangian.frames;
        let places = combination.terms.iter().map(|(_, point)| point.frame);
        let frame = places.reduce(|a, b| frames.nearest_common(a, b)).filter(|frame| *frame != FrameId::WORLD)?;
        // One difference, whichever of its places was written first.
        let mut terms = combination.terms.clone();
        terms.sort_by_key(|(weight, Point { coordinates, frame })| {
            (weight.is_negative(), *frame, coordinates.0.map(Expr::id))
        });
        let components = self.sum_in(frame, &terms);
        let length = self.dimension(Dimension::LENGTH);
        let place = Free { components, frame, dimension: length };
        let difference = match combination.kind {
            Kind::Places => place,
            Kind::Velocities => {
                let dimension = self.dimension(Dimension::VELOCITY);
                Free { components: self.rate_of_components(place), dimension, ..place }
            }
        };
        self.noted(difference);
        Some(difference)
    }

    /// `Σ wᵢ pᵢ` as seen from the origin of a frame, in its axes. What is only shifted is added up first, level by
    /// level: x and y of x + a and y + b cancel without what is added to them.
    fn sum_in(&self, frame: FrameId, terms: &[(Number, Point<'g>)]) -> Vector<'g> {
        let mut levels: Vec<Vec<(Number, Vector<'g>)>> = Vec::new();
        let mut turned: Vec<(Number, Vector<'g>)> = Vec::new();
        for &(weight, Point { coordinates, frame: fixed_in }) in terms {
            let edges = self.lagrangian.frames.path_from(frame, fixed_in);
            let shifts: Vec<Vector<'g>> = edges.iter().map_while(shift).collect();
            let behind = &edges[shifts.len()..];
            let last = behind.is_empty().then_some(coordinates);
            for (level, shift) in shifts.iter().copied().chain(last).enumerate() {
                if levels.len() == level {
                    levels.push(Vec::new());
                }
                levels[level].push((weight, shift));
            }
            if !behind.is_empty() {
                turned.push((weight, behind.iter().rev().fold(coordinates, |p, edge| carried(edge, p))));
            }
        }
        levels.push(turned);
        Vector([0, 1, 2].map(|i| {
            let sums = levels.iter().filter_map(|level| {
                let parts = level.iter().map(|(weight, vector)| (*weight, vector.0[i]));
                weighted_sum(parts.filter(|(_, e)| !e.is_zero()))
            });
            sums.reduce(|a, b| a + b).unwrap_or_else(|| self.graph.integer(0))
        }))
    }
}

fn added<'g>(rest: Option<Expr<'g>>, b: Expr<'g>, minus: bool) -> Expr<'g> {
    match rest {
        Some(rest) if minus => rest - b,
        Some(rest) => rest + b,
        None if minus => -b,
        None => b,
    }
}

fn weighted_sum<'g>(terms: impl Iterator<Item = (Number, Expr<'g>)>) -> Option<Expr<'g>> {
    let mut sum: Option<Expr<'g>> = None;
    for (weight, e) in terms {
        let (negative, size) = (weight.is_negative(), if weight.is_negative() { -weight } else { weight });
        let term = if size.is_one() { e } else { e.graph().constant(size) * e };
        sum = Some(match (sum, negative) {
            (None, false) => term,
            (None, true) => -term,
            (Some(sum), false) => sum + term,
            (Some(sum), true) => sum - term,
        });
    }
    sum
}

fn shift<'g>(edge: &Edge<'g>) -> Option<Vector<'g>> {
    match *edge {
        Edge::Translation(t) => Some(t),
        Edge::Rotation { .. } | Edge::Quaternion(_) => None,
    }
}

/// A place in the frame that an edge leads to, in the frame that it starts from.
fn carried<'g>(edge: &Edge<'g>, place: Vector<'g>) -> Vector<'g> {
    let turned = edge.rotation().map_or(place, |r| r * place);
    shift(edge).map_or(turned, |t| t + turned)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::derive::time_derivative;
    use crate::expr::{Expr, Graph, Node, Symbol, carry_out};
    use crate::model::OutputValue;
    use crate::model::check::trial::{mechanism, same};

    /// Two points on a table that turns about a place that moves, and one elsewhere.
    const POINTS: &str = "let table = translation([0, z, l]) * rot_z(theta) * translation([l, 0, 0]);
        let a = table.point([x, y, 0]); let b = table.point([l/2, 0, 0]); let c = (table * rot_x(q[0])).point([0, l, 0]);
        let elsewhere = rot_y(q[1]).point([l, 0, 0]);";

    /// What an expression depends on, once time derivatives are carried out.
    fn symbols(statements: &str, expression: &str) -> BTreeSet<Symbol> {
        mechanism(&format!("{statements} output result = {expression};"), |lagrangian| {
            let verbatim: Vec<Expr<'_>> = match &lagrangian.outputs[0].value {
                OutputValue::Scalar(expr) => vec![*expr],
                OutputValue::Array(exprs) => exprs.clone(),
                OutputValue::Matrix(_) | OutputValue::Pose(_) | OutputValue::Matrices(_) | OutputValue::Poses(_) => {
                    unreachable!("numbers and vectors are asked for")
                }
            };
            let graph = Graph::new();
            let carried = carry_out(&verbatim, &graph, |symbol| time_derivative(symbol, &graph));
            let nodes = graph.reachable(carried.iter().map(|e| e.id()));
            let symbol = |id| match graph.node(id) {
                Node::Symbol(symbol) => Some(symbol),
                _ => None,
            };
            nodes.into_iter().filter_map(symbol).collect()
        })
    }

    const X: Symbol = Symbol::Coordinate(0);
    const Y: Symbol = Symbol::Coordinate(1);
    const THETA: Symbol = Symbol::Coordinate(3);
    const Q_0: Symbol = Symbol::Coordinate(4);
    const L: Symbol = Symbol::Parameter(1);

    #[test]
    fn a_distance_does_not_depend_on_the_way_to_the_common_frame() {
        for distance in [
            "(a - b).norm()",
            "(b - a).norm_squared()",
            "(a - b).dot(a - b)",
            "[a.x - b.x, a.y - b.y, a.z - b.z].norm()",
            "[a[0] - b[0], a[1] - b[1], a[2] - b[2]].norm()",
            "(-b + a).norm()",
            "2*(a/2 - b/2).norm()",
            "((a + b)/2 - b).norm()",
            "(a + c - b - c).norm()",
            "[l + a.x - (b.x + l), -b.y + a.y, 2*a.z/2 - b.z].norm()",
            "(table.inverse()*a - table.inverse()*b).norm()",
        ] {
            assert_eq!(symbols(POINTS, distance), [X, Y, L].into(), "{distance}");
        }
        assert_eq!(symbols(POINTS, "(a - c).norm()"), [X, Y, Q_0, L].into());
        assert!(symbols(POINTS, "(a - elsewhere).norm()").contains(&THETA));
        assert_eq!(symbols(POINTS, "table.inverse()*a"), [X, Y].into());
    }

    #[test]
    fn a_difference_of_velocities_is_the_velocity_of_the_difference() {
        for speed in [
            "dt(a - b).norm()",
            "(dt(a) - dt(b)).norm()",
            "[dt(a.x) - dt(b.x), dt(a.y) - dt(b.y), dt(a.z - b.z)].norm()",
        ] {
            let found = symbols(POINTS, speed);
            assert!(!found.contains(&THETA) && !found.contains(&Symbol::Velocity(2)), "{speed}: {found:?}");
            same(POINTS, speed, "hypot(dt(a.x) - dt(b.x), hypot(dt(a.y) - dt(b.y), dt(a.z) - dt(b.z)))");
        }
    }

    #[test]
    fn differences_have_the_values_of_their_world_components() {
        let typed = "let p = [z*0 + cos(theta)*(l + x) - sin(theta)*y, z + sin(theta)*(l + x) + cos(theta)*y, l];
            let o = [cos(theta)*(l + l/2), z + sin(theta)*(l + l/2), l];";
        same(&format!("{POINTS} {typed}"), "a - b", "p - o");
        same(&format!("{POINTS} {typed}"), "a.y - b.y", "p.y - o.y");
        same(&format!("{POINTS} {typed}"), "dt(a) - dt(b)", "dt(p) - dt(o)");
        same(POINTS, "a - c", "world*[a.x, a.y, a.z] - [c.x, c.y, c.z]");
        same(POINTS, "(2*a - 3*b + c)/2", "[a.x - 3*b.x/2 + c.x/2, a.y - 3*b.y/2 + c.y/2, a.z - 3*b.z/2 + c.z/2]");
        same(POINTS, "(a + 2*c)/3 - b", "[(a.x + 2*c.x)/3 - b.x, (a.y + 2*c.y)/3 - b.y, (a.z + 2*c.z)/3 - b.z]");
        same(POINTS, "elsewhere - a", "-(a - elsewhere)");
    }
}
