//! Where the differences of a mechanism vanish: the sums that its energies and forces multiply, take powers and
//! functions of.

use std::collections::BTreeMap;

use mbs_derive::expr::{Dual, Expr, Id, Node, Symbol, Tape};
use mbs_derive::interpret::State;
use mbs_derive::model::Lagrangian;

/// How many sums of a mechanism are tried at most, spread over all of them, and after how many that vanish somewhere no
/// more are.
const TRIED: usize = 24;
const MOST: usize = 6;

/// Steps towards a zero.
const STEPS: usize = 60;

/// The coordinates near some state at which one of these sums is next to nothing, each with the number of the sum.
pub(crate) fn places(lagrangian: &Lagrangian<'_>, state: &State, parameters: &[f64]) -> Vec<(usize, Vec<f64>)> {
    let sums = sums(lagrangian);
    let zero = |sum: &Expr<'_>| {
        // Sums of squares have double roots.
        [1.0, 2.0].into_iter().find_map(|multiplicity| vanishing(*sum, state, parameters, multiplicity))
    };
    let stride = sums.len().div_ceil(TRIED).max(1);
    let tried = sums.iter().enumerate().step_by(stride);
    tried.filter_map(|(number, sum)| zero(sum).map(|place| (number, place))).take(MOST).collect()
}

/// Those that move, but not by rates.
fn sums<'g>(lagrangian: &Lagrangian<'g>) -> Vec<Expr<'g>> {
    let graph = lagrangian.graph;
    let energies = [&lagrangian.kinetic, &lagrangian.potential, &lagrangian.dissipation, &lagrangian.lagrangian];
    let forces = lagrangian.forces.iter().map(|(_, force)| force.id());
    let at_points = lagrangian.point_forces.iter().flat_map(|force| force.force.0.map(Expr::id));
    let roots = energies.into_iter().flatten().map(|term| term.id()).chain(forces).chain(at_points);
    let order = graph.reachable(roots.collect::<Vec<_>>());
    let mut depends: BTreeMap<Id, (bool, bool)> = BTreeMap::new();
    let mut found = Vec::new();
    for id in order {
        let node = graph.node(id);
        let own = match node {
            Node::Symbol(Symbol::Coordinate(_)) => (true, false),
            Node::Symbol(Symbol::Parameter(_) | Symbol::Time | Symbol::Prescribed(_, 0)) | Node::Constant(_) => {
                (false, false)
            }
            // Rates, and what has no zero to be found by its slope.
            Node::Symbol(_)
            | Node::Rate(_)
            | Node::Less(..)
            | Node::LessEqual(..)
            | Node::And(..)
            | Node::Not(_)
            | Node::Select(..) => (false, true),
            _ => (false, false),
        };
        let all = node.operands().map(|operand| depends[&operand]).fold(own, |a, b| (a.0 || b.0, a.1 || b.1));
        depends.insert(id, all);
        if matches!(node, Node::Mul(..) | Node::Power(..) | Node::Call(..) | Node::Call2(..)) {
            found.extend(node.operands());
        }
    }
    found.sort_unstable();
    found.dedup();
    found.retain(|id| matches!(graph.node(*id), Node::Add(..) | Node::Sub(..)) && depends[id] == (true, false));
    found.into_iter().map(|id| graph.expr(id)).collect()
}

/// Newton's method along the gradient.
fn vanishing(sum: Expr<'_>, state: &State, parameters: &[f64], multiplicity: f64) -> Option<Vec<f64>> {
    let tape = Tape::new(&[sum]);
    let mut q = state.q.clone();
    for _ in 0..STEPS {
        let along = |i: usize| {
            let value = |symbol| match symbol {
                Symbol::Time => Dual::fixed(state.t),
                Symbol::Coordinate(k) => Dual::new(q[k as usize], f64::from(u8::from(k as usize == i))),
                Symbol::Parameter(k) => Dual::fixed(parameters[k as usize]),
                Symbol::Prescribed(k, _) => Dual::fixed(state.prescribed[k as usize][0]),
                other => unreachable!("{other} is in no sum without rates"),
            };
            tape.run(value)[0]
        };
        let slopes: Vec<Dual<f64>> = (0..q.len()).map(along).collect();
        let (value, square) = (slopes[0].value, slopes.iter().map(|s| s.derivative * s.derivative).sum::<f64>());
        if value.abs() <= 1e-15 {
            return Some(q);
        }
        let step = multiplicity * value / square;
        if !step.is_finite() {
            return None;
        }
        q.iter_mut().zip(&slopes).for_each(|(q, slope)| *q -= step * slope.derivative);
    }
    None
}
