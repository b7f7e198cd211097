//! First derivatives of the dynamics.
//!
//! With `r(q, q̇, q̈, u) = M q̈ + h + ∂D/∂q̇ − Q`, which forward dynamics makes zero, `∂q̈/∂x = −M⁻¹ ∂r/∂x` at that q̈
//! (implicit differentiation): no derivative of a factorization is needed. With constraints r has `−Aᵀ λ` and the rows
//! `A q̈ + γ` besides, and the system is that of q̈ and λ.

use crate::equations::{
    Constraints, Factorization, ForwardDynamics, InverseDynamicsJacobian, Lagrange, LeftOut, Linearization, Rows,
    Symbols,
};
use crate::expr::{Expr, Symbol, gradient, substitute};
use crate::mistake::rule;

use super::Form;
use super::lagrange::{jacobian_by_rows, sub, transpose};

/// The derivatives of inverse dynamics and of forward dynamics, those that are asked for.
pub(crate) fn derivatives<'g>(
    lagrange: &Lagrange<'g>,
    forward: &ForwardDynamics<'g>,
    form: Form<'_>,
    constraints: &Constraints<'g>,
    symbols: &Symbols,
    left_out: LeftOut,
) -> (InverseDynamicsJacobian<'g>, Linearization<'g>) {
    let (mut jacobian, mut linear) = (InverseDynamicsJacobian::default(), Linearization::default());
    if left_out.inverse_dynamics_jacobian && left_out.linearization {
        return (jacobian, linear);
    }
    let slopes = inverse_dynamics_slopes(lagrange, symbols);
    if !left_out.inverse_dynamics_jacobian {
        jacobian = inverse_dynamics_jacobian(&slopes, form, symbols);
    }
    if !left_out.linearization {
        linear = linearization(lagrange, &slopes, forward, form, constraints, symbols);
    }
    (jacobian, linear)
}

/// `∂τ/∂x` for all x but the parameters: q, q̇ and u. One reverse sweep per generalized force.
fn inverse_dynamics_slopes<'g>(lagrange: &Lagrange<'g>, symbols: &Symbols) -> Rows<'g> {
    jacobian_by_rows(&lagrange.inverse_dynamics, &[symbols.q.as_slice(), &symbols.qd, &symbols.u].concat())
}

/// Those in q and q̇.
fn inverse_dynamics_jacobian<'g>(slopes: &Rows<'g>, form: Form<'_>, symbols: &Symbols) -> InverseDynamicsJacobian<'g> {
    let n = symbols.q.len();
    let rows = form.rows(&slopes.iter().map(|row| row[..2 * n].to_vec()).collect());
    InverseDynamicsJacobian {
        q: rows.iter().map(|row| row[..n].to_vec()).collect(),
        qd: rows.iter().map(|row| row[n..].to_vec()).collect(),
    }
}

/// `∂q̈/∂x = −M⁻¹ ∂r/∂x`
fn linearization<'g>(
    lagrange: &Lagrange<'g>,
    inverse_dynamics_slopes: &Rows<'g>,
    forward: &ForwardDynamics<'g>,
    form: Form<'_>,
    constraints: &Constraints<'g>,
    symbols: &Symbols,
) -> Linearization<'g> {
    let graph = lagrange.kinetic_energy.graph();
    let mut residual = sub(&lagrange.residual, &constraints.force(lagrange.residual.len(), graph));
    residual.extend(
        constraints
            .jacobian
            .iter()
            .zip(&constraints.bias)
            .map(|(row, &bias)| row.iter().zip(&symbols.qdd).fold(bias, |sum, (&a, &qdd)| sum + a * graph.symbol(qdd))),
    );
    // One sweep a row for all symbols.
    let x = [symbols.q.as_slice(), &symbols.qd, &symbols.u, &symbols.parameters];
    let known = |i: usize| {
        let is_less_force = symbols.parameters.is_empty() && constraints.count() == 0;
        is_less_force.then(|| less_force(&inverse_dynamics_slopes[i], lagrange.generalized_force[i], &x.concat()))?
    };
    let row = |i: usize| known(i).unwrap_or_else(|| gradient(residual[i], &x.concat()));
    let residual_slopes = (0..residual.len()).map(row).collect();
    let slopes = rule!("the sign of a linearization", negative(&residual_slopes), residual_slopes);
    let [q, qd, u, parameters] = split(&slopes, x.map(<[_]>::len));
    let [q, qd, u] = together(form, [q, qd, u]);
    let parameters = form.rows(&parameters);
    let (Some(solution), Some(factorization)) = (&forward.unrolled, &forward.factorization) else {
        return Linearization { state: [q, qd, u], parameters };
    };
    let finish = |rows: Rows<'g>| solve_columns(factorization, &at_solution(&rows, solution));
    Linearization { state: [finish(q), finish(qd), finish(u)], parameters: finish(parameters) }
}

/// `∂(τ − Q)/∂x` from `∂τ/∂x`, without the long sweep over τ, where no symbol moves both: often Q is an input alone.
fn less_force<'g>(slopes: &[Expr<'g>], force: Expr<'g>, x: &[Symbol]) -> Option<Vec<Expr<'g>>> {
    let force_slopes = gradient(force, x);
    let are_apart = slopes.iter().zip(&force_slopes).all(|(a, b)| a.is_zero() || b.is_zero());
    are_apart.then(|| sub(slopes, &force_slopes))
}

/// Matrices that stand side by side, by their numbers of columns.
fn split<'g, const N: usize>(rows: &Rows<'g>, widths: [usize; N]) -> [Rows<'g>; N] {
    let mut start = 0;
    widths.map(|width| {
        start += width;
        rows.iter().map(|row| row[start - width..start].to_vec()).collect()
    })
}

/// Matrices of equally many rows, written in one form.
fn together<'g, const N: usize>(form: Form<'_>, matrices: [Rows<'g>; N]) -> [Rows<'g>; N] {
    let mut rows = form.rows(&matrices.concat()).into_iter();
    matrices.map(|matrix| rows.by_ref().take(matrix.len()).collect())
}

/// The expressions with forward dynamics in the place of q̈.
fn at_solution<'g>(rows: &Rows<'g>, solution: &[Expr<'g>]) -> Rows<'g> {
    let replacement = |symbol| match symbol {
        Symbol::Acceleration(i) => Some(solution[i as usize]),
        _ => None,
    };
    let width = rows[0].len();
    let flat: Vec<_> = rows.iter().flatten().copied().collect();
    let replaced = substitute(&flat, replacement);
    (0..rows.len()).map(|i| replaced[i * width..(i + 1) * width].to_vec()).collect()
}

fn solve_columns<'g>(factorization: &Factorization<'g>, rows: &Rows<'g>) -> Rows<'g> {
    let columns = transpose(rows, rows[0].len());
    let solved = columns.iter().map(|column| factorization.solve(column)).collect();
    transpose(&solved, rows.len())
}

fn negative<'g>(rows: &Rows<'g>) -> Rows<'g> {
    rows.iter().map(|row| row.iter().map(|&e| -e).collect()).collect()
}

#[cfg(test)]
mod tests {
    use crate::catalogue::FunctionKind;
    use crate::expr::Graph;
    use crate::interpret::{Interpreter, State};

    /// `l q̈ = −g sin q − c q̇ + u`, whose slopes are `−g cos q / l`, `−c/l`, `1/l`.
    #[test]
    fn a_pendulum_is_linearized_as_by_hand() {
        let text = "#![dimensionless]
            mechanism A {
                param l: 1 = 2; param g: 1 = 10; param c: 1 = 3; coord q: 1; input u: 1;
                kinetic += 1/2*l*dt(q)^2; potential += -g*cos(q); dissipation += 1/2*c*dt(q)^2; force q += u;
            }";
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            crate::declared(text, &graph, &[]).unwrap_or_else(|error| panic!("{}", error.render("a", text)));
        let derivation = crate::derived(&lagrangian);
        let (q, q_dot, u) = (0.4_f64, 1.5, 0.7);
        let state = State { t: 0.0, q: vec![q], qd: vec![q_dot], qdd: vec![0.0], u: vec![u], prescribed: Vec::new() };
        let slopes = |kind| Interpreter::<f64>::new(&derivation).call(kind, &state).unwrap();
        let is = |found: Vec<f64>, expected: &[f64]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
        };
        is(slopes(FunctionKind::Linearize), &[-5.0 * q.cos(), -1.5, 0.5]);
        let acceleration = (-10.0 * q.sin() - 3.0 * q_dot + u) / 2.0;
        is(slopes(FunctionKind::LinearizeParameters), &[-acceleration / 2.0, -q.sin() / 2.0, -q_dot / 2.0]);
        is(slopes(FunctionKind::InverseDynamicsJacobian), &[10.0 * q.cos(), 3.0]);
    }
}
