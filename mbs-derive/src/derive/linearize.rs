//! First derivatives of the dynamics.
//!
//! With `r(q, q̇, q̈, u) = M q̈ + h + ∂D/∂q̇ − Q`, which forward dynamics makes zero, `∂q̈/∂x = −M⁻¹ ∂r/∂x` at that q̈
//! (implicit differentiation): no derivative of a factorization is needed. With constraints r has `−Aᵀ λ` and the rows
//! `A q̈ + γ` besides, and the system is that of q̈ and λ.

use crate::equations::{
    Constraints, Derivatives, Factorization, ForwardDynamics, InverseDynamicsJacobian, Lagrange, LeftOut,
    Linearization, Route, Rows, Slopes, Symbols,
};
use crate::expr::{Expr, Symbol, gradient, substitute};
use crate::mistake::rule;

use super::Form;
use super::lagrange::{add, jacobian_by_rows, sub, transpose};

/// What derivatives are of.
pub(crate) struct Dynamics<'a, 'g> {
    pub(crate) lagrange: &'a Lagrange<'g>,
    pub(crate) forward: &'a ForwardDynamics<'g>,
    pub(crate) route: Route,
    pub(crate) form: Form<'a>,
    pub(crate) constraints: &'a Constraints<'g>,
    pub(crate) symbols: &'a Symbols,
    pub(crate) left_out: LeftOut,
}

impl<'g> Dynamics<'_, 'g> {
    /// The derivatives of inverse dynamics and of forward dynamics, those that are asked for.
    pub(crate) fn derivatives(&self) -> Derivatives<'g> {
        let (left_out, mut found) = (self.left_out, Derivatives::none(self.route));
        if left_out.inverse_dynamics_jacobian && left_out.linearization {
            return found;
        }
        let slopes = jacobian_by_rows(&self.lagrange.inverse_dynamics, &self.variables());
        if !left_out.inverse_dynamics_jacobian {
            found.inverse_dynamics_jacobian = self.inverse_dynamics_jacobian(&slopes);
        }
        if !left_out.linearization {
            found.linearization = self.linearization(&self.residual_slopes(&slopes));
        }
        found
    }

    /// The same where the slopes of bodies are known; those in the parameters only if nobody else has them.
    pub(crate) fn by_recursion(&self, bodies: &Slopes<'g>, with_parameters: bool) -> Derivatives<'g> {
        let (left_out, mut found) = (self.left_out, Derivatives::none(Route::Recursive));
        let zeros = vec![self.lagrange.kinetic_energy.graph().integer(0); self.symbols.u.len()];
        let of_bodies: Rows<'g> =
            bodies.q.iter().zip(&bodies.qd).map(|(q, qd)| [q.as_slice(), qd, &zeros].concat()).collect();
        let with_bodies = |others: &[Expr<'g>]| {
            let mut rows = jacobian_by_rows(others, &self.variables());
            rows.iter_mut().zip(&of_bodies).for_each(|(row, bodies)| *row = add(row, bodies));
            rows
        };
        if !left_out.inverse_dynamics_jacobian {
            found.inverse_dynamics_jacobian =
                self.inverse_dynamics_jacobian(&with_bodies(&bodies.other_inverse_dynamics));
        }
        if !left_out.linearization {
            let mut slopes = with_bodies(&self.residual(&bodies.other_residual));
            if with_parameters {
                let residual = self.residual(&self.lagrange.residual);
                let of_parameters = jacobian_by_rows(&residual, &self.symbols.parameters);
                slopes.iter_mut().zip(of_parameters).for_each(|(row, parameters)| row.extend(parameters));
            }
            found.linearization = self.linearization(&slopes);
        }
        found
    }

    /// All but the parameters: q, q̇ and u.
    fn variables(&self) -> Vec<Symbol> {
        [self.symbols.q.as_slice(), &self.symbols.qd, &self.symbols.u].concat()
    }

    /// Those in q and q̇ of inverse dynamics.
    fn inverse_dynamics_jacobian(&self, slopes: &Rows<'g>) -> InverseDynamicsJacobian<'g> {
        let n = self.symbols.q.len();
        let rows = self.form.rows(&slopes.iter().map(|row| row[..2 * n].to_vec()).collect());
        InverseDynamicsJacobian {
            q: rows.iter().map(|row| row[..n].to_vec()).collect(),
            qd: rows.iter().map(|row| row[n..].to_vec()).collect(),
        }
    }

    /// `τ − Q − Aᵀ λ` with this for `τ − Q`, then `A q̈ + γ`.
    fn residual(&self, less_force: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let (constraints, graph) = (self.constraints, self.lagrange.kinetic_energy.graph());
        let mut residual = sub(less_force, &constraints.force(less_force.len(), graph));
        let rows = constraints.jacobian.iter().zip(&constraints.bias);
        residual.extend(rows.map(|(row, &bias)| {
            row.iter().zip(&self.symbols.qdd).fold(bias, |sum, (&a, &qdd)| sum + a * graph.symbol(qdd))
        }));
        residual
    }

    /// `∂r/∂x`, in the parameters too: one sweep a row for all symbols.
    fn residual_slopes(&self, inverse_dynamics_slopes: &Rows<'g>) -> Rows<'g> {
        let residual = self.residual(&self.lagrange.residual);
        let x = [self.variables().as_slice(), &self.symbols.parameters].concat();
        let is_less_force = self.symbols.parameters.is_empty() && self.constraints.count() == 0;
        let known = |i: usize| {
            is_less_force.then(|| less_force(&inverse_dynamics_slopes[i], self.lagrange.generalized_force[i], &x))?
        };
        (0..residual.len()).map(|i| known(i).unwrap_or_else(|| gradient(residual[i], &x))).collect()
    }

    /// `∂q̈/∂x = −M⁻¹ ∂r/∂x`
    fn linearization(&self, residual_slopes: &Rows<'g>) -> Linearization<'g> {
        let slopes = rule!("the sign of a linearization", negative(residual_slopes), residual_slopes.clone());
        let [n, inputs] = [self.symbols.q.len(), self.symbols.u.len()];
        let parameters = slopes[0].len() - (2 * n + inputs);
        let [q, qd, u, parameters] = split(&slopes, [n, n, inputs, parameters]);
        let [q, qd, u] = together(self.form, [q, qd, u]);
        let parameters = self.form.rows(&parameters);
        let (Some(solution), Some(factorization)) = (&self.forward.unrolled, &self.forward.factorization) else {
            return Linearization { state: [q, qd, u], parameters };
        };
        let finish = |rows: Rows<'g>| solve_columns(factorization, &at_solution(&rows, solution));
        Linearization { state: [finish(q), finish(qd), finish(u)], parameters: finish(parameters) }
    }
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
