//! First integrals: momenta of cyclic coordinates, and the energy integral where t is absent.

use std::cell::OnceCell;

use crate::expr::graph::IdMap;
use crate::expr::{
    Expr, Graph, Id, Node, Rounded, Symbol, Verdict, degree_is_at_most, evaluate, gradient, substitute,
    vanishes as is_zero_everywhere,
};
use crate::mistake::rule;
use crate::model::Lagrangian;
use crate::numeric::Random;
use crate::variable::component_names;

use super::constraint::constraints;
use super::{Conserved, Constraints, Energies, Lagrange, Symbols};

/// What is conserved for `u = 0`, `D = 0`: `q̇·∂L/∂q̇ − L` where t does not occur, no force acts and constraints do no
/// work, and each momentum `pᵢ = ∂L/∂q̇ᵢ` with `∂L/∂qᵢ = 0` on which neither force nor constraint acts.
pub(crate) fn conserved<'g>(
    lagrange: &Lagrange<'g>,
    energies: &Energies<'g>,
    constraints: &Constraints<'g>,
    exact: &Exact<'_, '_>,
    symbols: &Symbols,
) -> Vec<Conserved<'g>> {
    let lagrangian = exact.lagrangian;
    let forces = without_inputs(&lagrange.generalized_force);
    let force_free: Vec<bool> =
        (0..forces.len()).map(|i| exact.vanishes(forces[i], |declared| declared.forces[i])).collect();
    let mut found = Vec::new();
    // The power of a constraint is −b·λ: constraints that do not move do no work.
    let is_at_rest = |(k, &drift)| exact.vanishes(drift, |declared| declared.constraints.drift[k]);
    let workless = constraints.drift.iter().enumerate().all(is_at_rest);
    if force_free.iter().all(|&free| free) && workless && is_independent_of_time(lagrangian, energies) {
        found.push(Conserved {
            name: "energy_integral".to_string(),
            value: energy_integral(lagrange, energies, symbols),
        });
    }
    for (i, name) in component_names(&lagrangian.coordinates).into_iter().enumerate() {
        let is_free_of =
            |(k, row): (usize, &Vec<Expr<'g>>)| exact.vanishes(row[i], |declared| declared.constraints.jacobian[k][i]);
        let unconstrained = constraints.jacobian.iter().enumerate().all(is_free_of);
        let cyclic = || exact.vanishes(lagrange.position_gradient[i], |declared| declared.position_gradient[i]);
        if force_free[i] && unconstrained && cyclic() {
            found.push(Conserved { name: format!("p_{name}"), value: lagrange.momentum[i] });
        }
    }
    found
}

/// Decides what is zero for all values of the symbols, without a tolerance.
///
/// Where equations are derived, constants are folded to decimals, between which `sin²(5) + cos²(5) = 1` does not hold
/// exactly. Here the declaration is differentiated once more, in a graph that folds nothing.
pub(crate) struct Exact<'l, 'u> {
    lagrangian: &'l Lagrangian<'l>,
    graph: &'u Graph,
    declared: OnceCell<Declared<'u>>,
}

/// Derivatives of the declaration, as it was written.
struct Declared<'u> {
    /// `∂L/∂q`
    position_gradient: Vec<Expr<'u>>,
    /// Q at `u = 0`
    forces: Vec<Expr<'u>>,
    constraints: Constraints<'u>,
}

impl<'l, 'u> Exact<'l, 'u> {
    /// Of a mechanism, in an empty verbatim graph.
    pub(crate) fn new(lagrangian: &'l Lagrangian<'l>, graph: &'u Graph) -> Self {
        Exact { lagrangian, graph, declared: OnceCell::new() }
    }

    /// Whether an expression is zero: not where its value at some points, with the bound of its rounding, shows that it
    /// is not, and else if the same derivative of the declaration is.
    fn vanishes(&self, expr: Expr<'_>, of: impl Fn(&Declared<'u>) -> Expr<'u>) -> bool {
        let declared = || of(self.declared.get_or_init(|| self.declared()));
        expr.is_zero() || may_vanish(expr) && is_zero_everywhere(declared()) == Verdict::Holds
    }

    fn declared(&self) -> Declared<'u> {
        let symbols = Symbols::of(self.lagrangian);
        let energies = Energies::carried_out(self.lagrangian, self.graph);
        Declared {
            position_gradient: gradient(energies.lagrangian, &symbols.q),
            forces: without_inputs(&energies.forces),
            constraints: constraints(self.lagrangian, self.graph, &symbols),
        }
    }
}

fn without_inputs<'g>(forces: &[Expr<'g>]) -> Vec<Expr<'g>> {
    substitute(forces, |symbol| match symbol {
        Symbol::Input(_) => Some(forces[0].graph().integer(0)),
        _ => None,
    })
}

/// `q̇·∂L/∂q̇ − L`, Jacobi's integral; its value is `T + V` where T is homogeneous of second degree in the velocities
/// and L is `T − V`, but it is formed as written, less what is seen to be linear in the velocities on both sides of the
/// difference: there it leaves nothing but its rounding.
///
/// Where t cancels, as in a frame that turns, it has the same value at any time: it is formed for t = 0, if that is a
/// number.
fn energy_integral<'g>(lagrange: &Lagrange<'g>, energies: &Energies<'g>, symbols: &Symbols) -> Expr<'g> {
    let graph = energies.lagrangian.graph();
    let dot_velocity = |momentum: &[Expr<'g>]| {
        momentum.iter().zip(&symbols.qd).fold(graph.integer(0), |sum, (&p, &qd)| sum + p * graph.symbol(qd))
    };
    let degrees = degrees(lagrange.momentum.iter().copied().chain([energies.lagrangian]));
    let (linear, rest) = parted(energies.lagrangian, |addend| degrees[&addend.id()] == Some(1));
    let (constant, varying): (Vec<_>, Vec<_>) =
        lagrange.momentum.iter().map(|&p| parted(p, |addend| degrees[&addend.id()] == Some(0))).unzip();
    let cancels = !linear.is_zero() && is_zero_everywhere(dot_velocity(&constant) - linear) == Verdict::Holds;
    let integral = match cancels {
        true => dot_velocity(&varying) - rest,
        false => {
            let twice_kinetic = dot_velocity(&lagrange.momentum);
            rule!("Jacobi's integral", twice_kinetic - energies.lagrangian, twice_kinetic + energies.lagrangian)
        }
    };
    if !depends_on_time(integral) {
        return integral;
    }
    let at_zero = substitute(&[integral], |symbol| is_of_time(symbol).then(|| graph.integer(0)))[0];
    let is_finite =
        (0..3).all(|round| evaluate::<f64>(&[at_zero], |symbol| generic_value(symbol, round))[0].is_finite());
    if is_finite { at_zero } else { integral }
}

/// Of a sum the addends of a kind, and the others.
fn parted<'g>(sum: Expr<'g>, is_of_kind: impl Fn(Expr<'g>) -> bool) -> (Expr<'g>, Expr<'g>) {
    let graph = sum.graph();
    let (mut of_kind, mut others) = (graph.integer(0), graph.integer(0));
    let mut stack = vec![(sum, false)];
    while let Some((addend, negative)) = stack.pop() {
        match addend.node() {
            Node::Add(a, b) => stack.extend([(graph.expr(b), negative), (graph.expr(a), negative)]),
            Node::Sub(a, b) => stack.extend([(graph.expr(b), !negative), (graph.expr(a), negative)]),
            Node::Neg(a) => stack.push((graph.expr(a), !negative)),
            _ => {
                let part = if is_of_kind(addend) { &mut of_kind } else { &mut others };
                *part = if negative { *part - addend } else { *part + addend };
            }
        }
    }
    (of_kind, others)
}

/// In which degree each part of the expressions is homogeneous in the velocities, where that is seen.
fn degrees<'g>(roots: impl Iterator<Item = Expr<'g>> + Clone) -> IdMap<Option<i32>> {
    let mut degrees = IdMap::default();
    let Some(graph) = roots.clone().next().map(|root| root.graph()) else { return degrees };
    for id in graph.reachable(roots.map(|root| root.id())) {
        let node = graph.node(id);
        let of = |operand: Id| degrees[&operand];
        let equal = |a: Id, b: Id| of(a).filter(|degree| of(b) == Some(*degree));
        let is_at_rest = || node.operands().all(|operand| of(operand) == Some(0));
        let degree = match node {
            Node::Symbol(Symbol::Velocity(_)) => Some(1),
            Node::Neg(a) => of(a),
            Node::Add(a, b) | Node::Sub(a, b) => equal(a, b),
            Node::Mul(a, b) => of(a).zip(of(b)).map(|(a, b)| a + b),
            Node::Power(a, _) if of(a) == Some(0) => Some(0),
            Node::Power(a, n) => of(a).zip(n.to_integer()).and_then(|(degree, n)| degree.checked_mul(n)),
            Node::Select(condition, a, b) => equal(a, b).filter(|_| of(condition) == Some(0)),
            Node::Constant(_)
            | Node::Symbol(_)
            | Node::Rate(_)
            | Node::Call(..)
            | Node::Call2(..)
            | Node::Spline(..)
            | Node::Less(..)
            | Node::LessEqual(..)
            | Node::And(..)
            | Node::Not(_) => is_at_rest().then_some(0),
        };
        degrees.insert(id, degree);
    }
    degrees
}

/// Time itself, or a signal in time.
fn is_of_time(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Time | Symbol::Prescribed(..))
}

/// Whether L is the same at all times: t does not occur, or cancels.
fn is_independent_of_time<'l>(lagrangian: &Lagrangian<'l>, energies: &Energies<'_>) -> bool {
    if !depends_on_time(energies.lagrangian) {
        return true;
    }
    let sum = |terms: &[Expr<'l>]| terms.iter().fold(lagrangian.graph.integer(0), |sum, &term| sum + term);
    let declared = sum(&lagrangian.kinetic) + sum(&lagrangian.lagrangian) - sum(&lagrangian.potential);
    degree_is_at_most(0, declared, is_of_time) == Verdict::Holds
}

fn depends_on_time(expr: Expr<'_>) -> bool {
    let graph = expr.graph();
    graph
        .reachable([expr.id()])
        .into_iter()
        .any(|id| matches!(graph.node(id), Node::Symbol(symbol) if is_of_time(symbol)))
}

/// Whether an expression is zero to rounding at some points with no special relation, of both signs and with the
/// parameters among the symbols.
fn may_vanish(expr: Expr<'_>) -> bool {
    (0..4).all(|round| {
        let value = evaluate(&[expr], |symbol| Rounded::exact(generic_value(symbol, round)))[0];
        value.value.abs() <= 8.0 * value.error || value.error.is_nan()
    })
}

/// A value in ±(0.3, 1.3) for each symbol and round; parameters are positive.
pub(super) fn generic_value(symbol: Symbol, round: u64) -> f64 {
    let (kind, index) = match symbol {
        Symbol::Time => (0, 0),
        Symbol::Coordinate(i) => (1, i),
        Symbol::Velocity(i) => (2, i),
        Symbol::Acceleration(i) => (3, i),
        Symbol::Parameter(i) => (4, i),
        Symbol::Input(i) => (5, i),
        Symbol::Prescribed(i, order) => (6 + u64::from(order), i),
        Symbol::Multiplier(i) => (9, i),
    };
    let mut random = Random::new((kind * 1_000_003 + u64::from(index)) * 7919 + round);
    let (magnitude, sign) = (0.8 + 0.5 * random.symmetric(), random.symmetric());
    if sign < 0.0 && kind != 4 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use crate::expr::Graph;
    use crate::interpret::{Interpreter, State};
    use crate::optimise::FunctionKind;

    fn conserved(potential: &str) -> Vec<String> {
        conserved_with(&format!("kinetic += dt(x)^2 + dt(y)^2; potential += {potential};"))
    }

    fn conserved_with(statements: &str) -> Vec<String> {
        let text = format!("#![dimensionless]\nmechanism A {{ param w: 1 = 2; coord x: 1; coord y: 1; {statements} }}");
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            crate::declared(&text, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("a", &text)));
        crate::derived(&lagrangian).conserved.clone()
    }

    /// Farther away than any point where it is tried, a force may act.
    #[test]
    fn a_momentum_is_not_conserved_beyond_a_branch_or_a_step() {
        assert_eq!(conserved("y^2"), ["energy_integral", "p_x"]);
        assert_eq!(conserved("if x > 20 { x - 20 } else { 0 }"), ["energy_integral", "p_y"]);
        assert_eq!(conserved("abs(x - 20) + x"), ["energy_integral", "p_y"]);
        assert_eq!(conserved("if y > 20 { y - 20 } else { 0 }"), ["energy_integral", "p_x"]);
    }

    /// Without input `atan2(u, x)` is π where x is negative.
    #[test]
    fn a_force_that_is_zero_on_one_side_conserves_nothing() {
        let free = "input u: 1; kinetic += dt(x)^2 + dt(y)^2;";
        assert_eq!(conserved_with(&format!("{free} force x += u;")), ["energy_integral", "p_x", "p_y"]);
        assert_eq!(conserved_with(&format!("{free} force x += atan2(u, 9 - 0.3*x);")), ["p_y"]);
    }

    /// At a thousand the slope of tanh is zero in doubles.
    #[test]
    fn a_momentum_is_not_conserved_where_a_force_has_saturated() {
        assert_eq!(conserved("tanh(1000*y)"), ["energy_integral", "p_x"]);
        assert_eq!(conserved("exp(-1e6*y^2)"), ["energy_integral", "p_x"]);
        assert_eq!(conserved("tanh(x)*y/(y*cosh(x))"), ["energy_integral", "p_y"]);
    }

    /// What is left of large terms may be smaller than their rounding, and act all the same.
    #[test]
    fn a_momentum_is_not_conserved_because_its_rate_is_below_rounding() {
        assert_eq!(conserved("x*(y + 1) - (1 - 1e-17)*x*y"), ["energy_integral"]);
        assert_eq!(conserved("x*(y + 1) - x*y - x"), ["energy_integral", "p_x", "p_y"]);
    }

    /// `sin²(1) + cos²(1)` of decimals is not 1.
    #[test]
    fn a_momentum_is_conserved_in_axes_turned_by_a_constant() {
        let puck = "let p = rot_x(1) * rot_z(x) * [1, 0, 0]; kinetic += particle(1, p) + dt(y)^2; potential += y^2;";
        assert_eq!(conserved_with(puck), ["energy_integral", "p_x"]);
    }

    #[test]
    fn both_sides_of_a_branch_may_conserve_a_momentum() {
        assert_eq!(conserved("if y > 20 { x - x + y } else { 0 }"), ["energy_integral", "p_x"]);
    }

    /// What a hand moves it works on; a slot takes momentum from what slides in it.
    #[test]
    fn constraints_that_move_do_work_and_those_that_do_not_take_momentum() {
        let free = "kinetic += dt(x)^2 + dt(y)^2;";
        assert_eq!(conserved_with(free), ["energy_integral", "p_x", "p_y"]);
        assert_eq!(conserved_with(&format!("{free} constraint hand: x = w*t;")), ["p_y"]);
        assert_eq!(conserved_with(&format!("{free} constraint slot: y = w*x;")), ["energy_integral"]);
    }

    /// A puck on a turntable: t is in the energies, and cancels.
    #[test]
    fn energy_is_conserved_where_time_cancels() {
        let puck = "let table = rot_z(w*t); let p = table.point([x, y, 0]); kinetic += particle(1, p);";
        let spring = "potential += 1/2*w*(p - table.origin()).norm_squared();";
        assert_eq!(conserved_with(&format!("{puck} {spring}")), ["energy_integral"]);
        let distance = "potential += (p - table.point([1, 0, 0])).norm();";
        assert_eq!(conserved_with(&format!("{puck} {distance}")), ["energy_integral"]);
        assert_eq!(conserved_with(&format!("{puck} potential += p.x;")), [""; 0]);
        assert_eq!(conserved_with(&format!("{puck} {spring} potential += 1e-20*t*x;")), [""; 0]);
        let late = "potential += if t > 100 { x*t } else { 0 };";
        assert_eq!(conserved_with(&format!("{puck} {spring} {late}")), [""; 0]);
    }
    /// A magnetic field does no work, however strong it is.
    #[test]
    fn terms_linear_in_the_velocities_leave_no_rounding_in_the_energy() {
        let energy = |more: &str| {
            let text = format!(
                "#![dimensionless]\nmechanism A {{ param w: 1 = 1e17; coord x: 1; coord y: 1; kinetic += dt(x)^2 + \
                 x^2*dt(y)^2; potential += y^2; {more} }}"
            );
            let graph = Graph::verbatim();
            let (lagrangian, _) =
                crate::declared(&text, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("a", &text)));
            let state = State { t: 0.0, q: vec![0.3, 0.7], qd: vec![0.1, -0.2], ..State::default() };
            let derivation = crate::derived(&lagrangian);
            Interpreter::new(&derivation).call(FunctionKind::Conserved, &state).expect("it is conserved")[0]
        };
        let plain = energy("");
        assert!((plain - 0.5036).abs() < 1e-15);
        assert_eq!(energy("lagrangian += w*x*dt(y) - w*cos(y)*dt(x);"), plain);
        assert_eq!(energy("lagrangian += w*(x*dt(y) - y*dt(x)) + w*dt(x);"), plain);
    }
}
