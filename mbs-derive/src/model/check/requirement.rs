//! What the parameters of a mechanism must satisfy, as expressions of them, to be looked at whenever they are set.
//!
//! - A parameter that is declared `positive` is.
//! - The mass of a body is not negative; its inertia is that of a body.
//! - What squares in T are multiplied with is not negative: `1/2*m*dt(x)^2` asks for `m >= 0`, `1/2*(m1 - m2)*dt(x)^2`
//!   for `m1 - m2 >= 0`; what is multiplied with one square is added up first.
//! - What energies, forces and constraints divide by is not zero, of what they take the square root or the logarithm is
//!   in the domain of that, wherever they are evaluated (not on one side of a branch alone).
//!
//! A condition that the defaults do not satisfy is none: the declaration means something else.

use std::collections::BTreeMap;

use crate::expr::display::infix;
use crate::expr::{Binary, Expr, Function, Graph, Id, Matrix, Node, Symbol, carry_out, evaluate};
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::{Body, Draft};
use crate::numeric::moments::{Impossible, principal_moments};
use crate::variable::component_names;

/// What must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Condition {
    /// It is neither infinite nor NaN.
    Finite,
    /// It is not zero.
    NotZero,
    /// It is zero or more.
    NotNegative,
    /// It is more than zero.
    Positive,
    /// No principal moment of the symmetric matrix is negative.
    SemiDefinite,
    /// The principal moments of the inertia are `0 ≤ a ≤ b ≤ c ≤ a + b`.
    InertiaOfABody,
}

impl Condition {
    /// How many numbers it is about: one, or the entries xx, yy, zz, xy, xz, yz of a symmetric matrix.
    pub fn count(self) -> usize {
        match self {
            Condition::Finite | Condition::NotZero | Condition::NotNegative | Condition::Positive => 1,
            Condition::SemiDefinite | Condition::InertiaOfABody => 6,
        }
    }

    /// Nothing where these numbers satisfy it; else the number that does not, and what it must be, as the end of a
    /// sentence.
    ///
    /// The number is the quantity itself, the least principal moment, or the greatest less the other two.
    pub fn violation(self, values: &[f64]) -> Option<(f64, &'static str)> {
        let is_finite = values.iter().all(|value| value.is_finite());
        let worst = values.iter().copied().find(|value| !value.is_finite()).unwrap_or(values[0]);
        let one = |holds: bool, what| (!holds).then_some((worst, what));
        match self {
            _ if !is_finite => Some((worst, "must be finite")),
            Condition::Finite => None,
            Condition::NotZero => one(worst != 0.0, "must not be zero"),
            Condition::NotNegative => one(worst >= 0.0, "must not be negative"),
            Condition::Positive => one(worst > 0.0, "must be positive"),
            Condition::SemiDefinite | Condition::InertiaOfABody => {
                let &[xx, yy, zz, xy, xz, yz] = values else { return None };
                let moments = principal_moments(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])?;
                let [a, b, c] = moments;
                match Impossible::of(moments)? {
                    Impossible::Negative => Some((a, "must have no negative principal moment")),
                    Impossible::Unequal if self == Condition::InertiaOfABody => {
                        Some((c - a - b, "must have no principal moment greater than the sum of the other two"))
                    }
                    Impossible::Unequal => None,
                }
            }
        }
    }
}

/// One condition on one quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Requirement {
    /// The parameter, or the expression of parameters: `m`, `m1 - m2`, `inertia(ixx, iyy, izz, 0, 0, 0)`.
    pub quantity: String,
    /// What must hold of it.
    pub condition: Condition,
}

/// The requirements in the order of the documentation, and for each its numbers, one behind the other, in `graph`.
pub(crate) fn requirements<'g>(lagrangian: &Draft<'_>, graph: &'g Graph) -> (Vec<Requirement>, Vec<Expr<'g>>) {
    let (bodies, others) = lagrangian.bodies();
    let mut found: Vec<(Condition, Vec<Expr<'_>>)> = positive(lagrangian);
    found.extend(bodies.iter().flat_map(of_body));
    found
        .extend(of_squares(lagrangian.graph, &others).into_iter().map(|factor| (Condition::NotNegative, vec![factor])));
    found.extend(of_domains(lagrangian));
    let defaults = default_parameters(lagrangian);
    let at_defaults = |symbol| match symbol {
        Symbol::Parameter(i) => defaults[i as usize],
        _ => f64::NAN,
    };
    let names = component_names(&lagrangian.parameters);
    let (mut requirements, mut roots): (Vec<Requirement>, Vec<Expr<'g>>) = (Vec::new(), Vec::new());
    for (condition, declared) in found {
        let values = carry_out(&declared, graph, |_| None);
        let is_fixed = values.iter().all(|value| value.as_constant().is_some());
        if is_fixed || condition.violation(&evaluate(&values, at_defaults)).is_some() {
            continue;
        }
        let requirement = Requirement { quantity: written(&declared, &names), condition };
        if !requirements.contains(&requirement) {
            requirements.push(requirement);
            roots.extend(values);
        }
    }
    (requirements, roots)
}

/// As the language writes it.
fn written(values: &[Expr<'_>], names: &[String]) -> String {
    let name = |symbol: Symbol| match symbol {
        Symbol::Parameter(i) => names[i as usize].clone(),
        other => other.to_string(),
    };
    let texts: Vec<String> = values.iter().map(|value| infix(value.graph(), value.id(), &name)).collect();
    match texts.as_slice() {
        [text] => text.clone(),
        [diagonal @ .., a, b, c] if [a, b, c].iter().all(|entry| *entry == "0") => {
            format!("diag({})", diagonal.join(", "))
        }
        _ => format!("inertia({})", texts.join(", ")),
    }
}

fn positive<'g>(lagrangian: &Draft<'g>) -> Vec<(Condition, Vec<Expr<'g>>)> {
    let declared = lagrangian.parameters.iter().filter(|parameter| parameter.positive);
    let components = declared.flat_map(|parameter| parameter.first..parameter.first + parameter.count());
    let symbol = |i: usize| lagrangian.graph.symbol(Symbol::Parameter(i as u32));
    components.map(|i| (Condition::Positive, vec![symbol(i)])).collect()
}

fn of_body<'g>(body: &Body<'g>) -> Vec<(Condition, Vec<Expr<'g>>)> {
    let mass = (Condition::NotNegative, vec![without_ones(body.mass)]);
    let entries = |Matrix([[xx, xy, xz], [_, yy, yz], [_, _, zz]]): Matrix<'g>| {
        [xx, yy, zz, xy, xz, yz].map(without_ones).to_vec()
    };
    // One without mass was recognised in a formula, whose matrix need not be that of a body.
    let condition = if body.mass.is_zero() { Condition::SemiDefinite } else { Condition::InertiaOfABody };
    [mass].into_iter().chain(body.inertia.map(|inertia| (condition, entries(inertia)))).collect()
}

/// A body that was recognised may have a mass of `1 m`, and moments of inertia likewise.
fn without_ones(mut value: Expr<'_>) -> Expr<'_> {
    while let Node::Mul(a, b) = value.node() {
        let [a, b] = [a, b].map(|id| value.graph().expr(id));
        match (a.is_one(), b.is_one()) {
            (true, _) => value = b,
            (_, true) => value = a,
            (false, false) => break,
        }
    }
    value
}

// ---- squares

/// A term of T: a product of a sign, factors of parameters alone, other factors, and factors that are not yet looked
/// at.
#[derive(Clone, Default)]
struct Term {
    negative: bool,
    parameters: Vec<Id>,
    others: Vec<Id>,
    pending: Vec<Id>,
}

/// Sums are multiplied out in at most this many steps; longer energies have no squares to be found.
const MOST_STEPS: usize = 20_000;

/// What the squares in T are multiplied with.
fn of_squares<'g>(graph: &'g Graph, terms: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let Some(terms) = multiplied_out(graph, terms) else { return Vec::new() };
    let mut by_square: BTreeMap<Vec<Id>, Vec<Term>> = BTreeMap::new();
    let mut order = Vec::new();
    for mut term in terms {
        term.others.sort();
        if !is_square(graph, &term.others) {
            continue;
        }
        let known = by_square.entry(term.others.clone()).or_default();
        if known.is_empty() {
            order.push(term.others.clone());
        }
        known.push(term);
    }
    order.iter().filter_map(|square| factor(graph, &by_square[square])).collect()
}

fn multiplied_out(graph: &Graph, terms: &[Expr<'_>]) -> Option<Vec<Term>> {
    let first = |term: &Expr<'_>| Term { pending: vec![term.id()], ..Term::default() };
    let mut stack: Vec<Term> = terms.iter().rev().map(first).collect();
    let mut finished = Vec::new();
    for _ in 0..MOST_STEPS {
        let Some(mut term) = stack.pop() else { return Some(finished) };
        let Some(id) = term.pending.pop() else {
            finished.push(term);
            continue;
        };
        match graph.node(id) {
            Node::Mul(a, b) => term.pending.extend([b, a]),
            Node::Neg(a) => {
                term.negative = !term.negative;
                term.pending.push(a);
            }
            _ if graph.is_parametric(id) => term.parameters.push(id),
            Node::Add(a, b) | Node::Sub(a, b) => {
                let is_difference = matches!(graph.node(id), Node::Sub(..));
                let mut second = term.clone();
                second.negative ^= is_difference;
                second.pending.push(b);
                stack.push(second);
                term.pending.push(a);
            }
            _ => term.others.push(id),
        }
        stack.push(term);
    }
    None
}

/// Whether a product of these factors, in order of their numbers, is a square of something that moves, whatever that
/// is.
fn is_square(graph: &Graph, factors: &[Id]) -> bool {
    let mut single: Vec<Id> = Vec::new();
    for &factor in factors {
        match single.pop() {
            Some(last) if last == factor => {}
            other => single.extend(other.into_iter().chain([factor])),
        }
    }
    let never_negative = |id: &Id| match graph.node(*id) {
        Node::Power(_, n) => n.to_halves() % 4 == 0 || n.to_halves() % 2 != 0,
        Node::Call(function, _) => matches!(function, Function::Abs | Function::Exp | Function::Cosh | Function::Sech),
        _ => false,
    };
    !factors.is_empty() && single.iter().all(never_negative)
}

/// What one square is multiplied with, up to what is positive in any case; `None` where that is all.
fn factor<'g>(graph: &'g Graph, terms: &[Term]) -> Option<Expr<'g>> {
    let product = |factors: &[Id]| factors.iter().map(|&id| graph.expr(id)).reduce(|a, b| a * b);
    let signed = |term: &Term, value: Expr<'g>| if term.negative { -value } else { value };
    if let [term] = terms {
        let of_unknown_sign = odd(graph, &term.parameters);
        return product(&of_unknown_sign).map(|value| signed(term, value));
    }
    let summand = |term: &Term| {
        let (numbers, others): (Vec<Id>, Vec<Id>) = term.parameters.iter().partition(|id| is_number(graph, **id));
        let number = product(&numbers).map(|value| folded(graph, value)).filter(|value| !value.is_one());
        let value = [number, product(&others)].into_iter().flatten().reduce(|a, b| a * b);
        value.unwrap_or_else(|| graph.integer(1))
    };
    let sum = |sum: Option<Expr<'g>>, term: &Term| match (sum, summand(term)) {
        (None, value) => Some(signed(term, value)),
        (Some(sum), value) => Some(if term.negative { sum - value } else { sum + value }),
    };
    terms.iter().fold(None, sum)
}

/// Whether an expression holds no symbol.
fn is_number(graph: &Graph, id: Id) -> bool {
    graph.reachable([id]).iter().all(|id| !matches!(graph.node(*id), Node::Symbol(_)))
}

/// The same number as one constant.
fn folded<'g>(graph: &'g Graph, value: Expr<'g>) -> Expr<'g> {
    let rules = Graph::new();
    carry_out(&[value], &rules, |_| None)[0].as_constant().map_or(value, |number| graph.constant(number))
}

/// The factors that may be negative, each once: of `1/2 m l l` that is m.
fn odd(graph: &Graph, factors: &[Id]) -> Vec<Id> {
    let mut odd: Vec<Id> = Vec::new();
    for &factor in factors {
        let factor = match graph.node(factor) {
            Node::Power(base, n) => match n.to_halves() {
                n if n % 4 == 0 || n % 2 != 0 => continue,
                _ => base,
            },
            _ => factor,
        };
        // A constant with a sign is a Neg, whose sign the term has taken.
        let is_positive = matches!(graph.node(factor), Node::Constant(value) if value.to_f64() > 0.0);
        match odd.iter().position(|known| *known == factor) {
            _ if is_positive => {}
            Some(twin) => {
                odd.remove(twin);
            }
            None => odd.push(factor),
        }
    }
    odd
}

// ---- domains

/// Reciprocals, roots and logarithms of parameters that are taken in any case.
fn of_domains<'g>(lagrangian: &Draft<'g>) -> Vec<(Condition, Vec<Expr<'g>>)> {
    let graph = lagrangian.graph;
    let energies = [&lagrangian.kinetic, &lagrangian.potential, &lagrangian.dissipation, &lagrangian.lagrangian];
    let mut roots: Vec<Expr<'g>> = energies.into_iter().flatten().copied().collect();
    roots.extend(lagrangian.forces.iter().map(|(_, force)| *force));
    roots.extend(lagrangian.point_forces.iter().flat_map(|f| f.velocity.0.into_iter().chain(f.force.0)));
    roots.extend(lagrangian.constraints.iter().flat_map(|constraint| &constraint.rows));
    certain(graph, &roots).into_iter().filter_map(|id| domain(graph, id)).collect()
}

/// The nodes of parameters alone that are evaluated whichever branches are taken, operands first.
fn certain(graph: &Graph, roots: &[Expr<'_>]) -> Vec<Id> {
    let order = graph.reachable(roots.iter().map(|root| root.id()));
    let mut needed: std::collections::BTreeSet<Id> = roots.iter().map(|root| root.id()).collect();
    for &id in order.iter().rev().filter(|_| !roots.is_empty()) {
        if !needed.contains(&id) {
            continue;
        }
        match graph.node(id) {
            Node::Select(condition, _, _) => needed.extend([condition]),
            node => needed.extend(node.operands()),
        }
    }
    needed.into_iter().filter(|id| graph.is_parametric(*id)).collect()
}

fn domain(graph: &Graph, id: Id) -> Option<(Condition, Vec<Expr<'_>>)> {
    let (condition, value) = match graph.node(id) {
        Node::Power(base, n) => match (n.to_halves() < 0, n.to_halves() % 2 != 0) {
            (true, true) => (Condition::Positive, base),
            (true, false) => (Condition::NotZero, base),
            (false, true) => (Condition::NotNegative, base),
            (false, false) => return None,
        },
        Node::Call(Function::Ln, argument) => (Condition::Positive, argument),
        Node::Call(Function::Asin | Function::Acos | Function::Tan, _) | Node::Call2(Binary::Powf, ..) => {
            (Condition::Finite, id)
        }
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Mul(..)
        | Node::Call(..)
        | Node::Call2(Binary::Atan2, ..)
        | Node::Spline(..)
        | Node::Less(..)
        | Node::LessEqual(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => return None,
    };
    Some((condition, vec![graph.expr(value)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::check::trial::resolved;

    /// Quantities and conditions of a mechanism of these statements.
    fn found(statements: &str) -> Vec<String> {
        let declared =
            "param m1: kg = 3; param m2: kg = 1; param l: m = 2; param J: kg*m^2 = 1; coord x: m; coord a: rad;";
        resolved(&format!("mechanism A {{ {declared} {statements} }}"), |result| {
            let (lagrangian, _) = result.unwrap_or_else(|errors| panic!("{errors}"));
            let graph = Graph::new();
            let (requirements, roots) = requirements(&lagrangian, &graph);
            assert_eq!(roots.len(), requirements.iter().map(|r| r.condition.count()).sum::<usize>());
            requirements.iter().map(|r| format!("{} {:?}", r.quantity, r.condition)).collect()
        })
    }

    fn check(statements: &str, expected: &[&str]) {
        assert_eq!(found(statements), expected, "{statements}");
    }

    #[test]
    fn what_squares_are_multiplied_with() {
        let rest = "kinetic += 1/2*J*dt(a)^2;";
        check(&format!("kinetic += 1/2*m1*dt(x)^2; {rest}"), &["m1 NotNegative", "J NotNegative"]);
        check("kinetic += 1/2*m1*dt(x)^2 + 1/2*m2*(l*dt(a))^2;", &["m1 NotNegative", "m2 NotNegative"]);
        check("kinetic += 1/2*m1*(dt(x)^2 + l^2*dt(a)^2);", &["m1 NotNegative"]);
        check(&format!("kinetic += 1/2*(m1 - m2)*dt(x)^2; {rest}"), &["m1 - m2 NotNegative", "J NotNegative"]);
        check(
            "kinetic += 1/2*m1*dt(x)^2 - 1/2*m2*dt(x)^2 + J*dt(a)*dt(a);",
            &["1/2 * m1 - 1/2 * m2 NotNegative", "J NotNegative"],
        );
        check(
            "kinetic += 1/2*(J + m1*l^2)*dt(a)^2 + m2*abs(x/l)*dt(x)^2;",
            &["J + m1 * l^2 NotNegative", "m2 NotNegative", "l NotZero"],
        );
        // Mixed terms say nothing, nor does one that the defaults make negative.
        let mixed = "kinetic += m1*dt(x)^2 + J*dt(a)^2 + m2*l*cos(a)*dt(x)*dt(a) + (m2 - m1)*dt(x + l*a)^2/100;";
        check(mixed, &["m1 NotNegative", "J NotNegative"]);
    }

    #[test]
    fn bodies() {
        check("kinetic += particle(m1 - m2, [x, l*a, 0]);", &["m1 - m2 NotNegative"]);
        check(
            "kinetic += particle(m1, [x, 0, 0]) + rigid_body(m2, [0, 0, 0], inertia(J, J, J, J/9, 0, 0), rot_x(a));",
            &["m1 NotNegative", "m2 NotNegative", "inertia(J, J, J, J * 9^-1, 0, 0) InertiaOfABody"],
        );
        check(
            "kinetic += particle(m1, [x, 0, 0]) + rigid_body(m2, [l, 0, 0], diag(J, J, J), rot_x(a));",
            &["m1 NotNegative", "m2 NotNegative", "diag(J, J, J) InertiaOfABody"],
        );
    }

    #[test]
    fn domains() {
        let motion = "kinetic += 1/2*m1*dt(x)^2 + 1/2*J*dt(a)^2; const k: N*m = 1;";
        let with = |statement: &str, expected: &[&str]| {
            check(&format!("{motion} {statement}"), &[&["m1 NotNegative", "J NotNegative"], expected].concat());
        };
        with("potential += k*x/l;", &["l NotZero"]);
        with("potential += k*sqrt(m1/m2)*x^2/x^2;", &["m2 NotZero", "m1 * m2^-1 NotNegative"]);
        with("potential += k*ln(m1/m2)*x^2/x^2;", &["m2 NotZero", "m1 * m2^-1 Positive"]);
        with("potential += if x < l { k*x/l } else { k };", &[]);
    }

    #[test]
    fn violations() {
        assert_eq!(Condition::NotNegative.violation(&[-1.0]), Some((-1.0, "must not be negative")));
        assert_eq!(Condition::NotNegative.violation(&[0.0]), None);
        assert!(Condition::NotNegative.violation(&[f64::NAN]).is_some_and(|(value, _)| value.is_nan()));
        assert_eq!(Condition::Positive.violation(&[0.0]), Some((0.0, "must be positive")));
        assert_eq!(Condition::InertiaOfABody.violation(&[1.0, 2.0, 2.5, 0.0, 0.0, 0.0]), None);
        let (excess, _) = Condition::InertiaOfABody.violation(&[1.0, 2.0, 4.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((excess - 1.0).abs() < 1e-12);
        assert_eq!(Condition::SemiDefinite.violation(&[1.0, 2.0, 4.0, 0.0, 0.0, 0.0]), None);
        assert!(Condition::SemiDefinite.violation(&[1.0, 1.0, 1.0, 2.0, 0.0, 0.0]).is_some());
    }
}
