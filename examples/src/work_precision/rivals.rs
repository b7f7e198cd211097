//! DOP853 as other crates have it, with their defaults but for the tolerances.

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use ode_solvers::Vector4;
use ode_solvers::dop_shared::OutputType;

use super::problems::{Force, Problem};
use super::{Failure, Point};

/// `(q, q̇)` as a system of first order.
struct FirstOrder<F>(F);

impl<F: Force> ode_solvers::System<f64, Vector4<f64>> for FirstOrder<F> {
    fn system(&self, _: f64, y: &Vector4<f64>, dy: &mut Vector4<f64>) {
        let [ax, ay] = (self.0)(&[y[0], y[1]], &[y[2], y[3]]);
        *dy = Vector4::new(y[2], y[3], ax, ay);
    }
}

impl<F: Force> ODE<f64, [f64; 4]> for FirstOrder<F> {
    fn diff(&self, _: f64, &[x, y, vx, vy]: &[f64; 4], dy: &mut [f64; 4]) {
        let [ax, ay] = (self.0)(&[x, y], &[vx, vy]);
        *dy = [vx, vy, ax, ay];
    }
}

/// `ode_solvers`, without its dense output.
pub(crate) fn ode_solvers<F: Force>(problem: &Problem<F>, tolerance: f64) -> Result<Point, Failure> {
    let system = FirstOrder(problem.force);
    let start = Vector4::from(problem.start());
    let mut solver = ode_solvers::Dop853::new(system, 0.0, problem.end, 0.0, start, tolerance, tolerance);
    solver.set_output(OutputType::Sparse);
    let statistics = solver.integrate()?;
    let end = solver.y_out().last().ok_or("no state")?;
    let error = problem.error([end[0], end[1], end[2], end[3]]);
    Ok(Point { setting: tolerance, evaluations: statistics.num_eval as usize, error })
}

/// `differential-equations`.
pub(crate) fn differential_equations<F: Force>(problem: &Problem<F>, tolerance: f64) -> Result<Point, Failure> {
    let system = FirstOrder(problem.force);
    let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance);
    let solution = IVP::ode(&system, 0.0, problem.end, problem.start())
        .method(method)
        .solve()
        .map_err(|error| format!("differential-equations: {error:?}"))?;
    let end = solution.y.last().ok_or("no state")?;
    Ok(Point { setting: tolerance, evaluations: solution.evals.function, error: problem.error(*end) })
}

/// `russell_ode`.
#[cfg(feature = "russell")]
pub(crate) fn russell_ode<F: Force>(problem: &Problem<F>, tolerance: f64) -> Result<Point, Failure> {
    use russell_lab::Vector;
    use russell_ode::{Method, NoArgs, OdeSolver, Params};
    let force = problem.force;
    let system = russell_ode::System::new(4, move |dy: &mut Vector, _, y: &Vector, _: &mut NoArgs| {
        let [ax, ay] = force(&[y[0], y[1]], &[y[2], y[3]]);
        [dy[0], dy[1], dy[2], dy[3]] = [y[2], y[3], ax, ay];
        Ok(())
    });
    let mut parameters = Params::new(Method::DoPri8);
    parameters.set_tolerances(tolerance, tolerance, None)?;
    let mut solver = OdeSolver::new(parameters, system)?;
    let mut y = Vector::from(&problem.start());
    solver.solve(&mut y, 0.0, problem.end, None, &mut 0, None)?;
    let error = problem.error([y[0], y[1], y[2], y[3]]);
    Ok(Point { setting: tolerance, evaluations: solver.stats().n_function, error })
}
