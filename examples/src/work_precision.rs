//! Error against evaluations of every method, and of DOP853 as other crates have it.

mod problems;
mod rivals;

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use mbs_runtime::{Dop853, Dopri5, GaussLegendre4, Integrator, Rk4, SemiImplicitEuler, State, StormerVerlet};

use problems::{Force, Problem};

/// What a method or another crate fails with.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Tolerances at which DOP853 is compared, relative and absolute: 1e-6 to 1e-13.
pub const EXPONENTS: std::ops::RangeInclusive<i32> = 6..=13;
/// Rounds, in each of which every contender has a turn; the fastest counts.
const ROUNDS: usize = 60;

/// One run: its setting, a step \[s\] or a tolerance, the evaluations it took, and the distance of its end from the
/// solution.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The step \[s\] or the tolerance.
    pub setting: f64,
    /// The evaluations of the right-hand side.
    pub evaluations: usize,
    /// The distance of its end from the solution.
    pub error: f64,
}

/// What was measured on one problem.
pub struct Report {
    /// The problem's name.
    pub problem: &'static str,
    /// The runs of every method of `mbs_runtime`.
    pub methods: Vec<(&'static str, Vec<Point>)>,
    /// DOP853 by crate, `mbs_runtime` first, with the fastest time of each run \[µs\].
    pub crates: Vec<(&'static str, Vec<Point>, Vec<f64>)>,
    /// The fastest time of as many right-hand sides as `mbs_runtime` evaluates at each tolerance, and nothing else
    /// \[µs\].
    pub right_hand_sides: Vec<f64>,
}

/// Runs with the tolerance given.
type Contender<'p> = Box<dyn Fn(f64) -> Result<Point, Failure> + 'p>;

/// All problems.
///
/// # Errors
/// What a method or another crate fails with.
pub fn reports() -> Result<[Report; 3], Failure> {
    Ok([report(&problems::kepler())?, report(&problems::arenstorf())?, report(&problems::double_pendulum()?)?])
}

fn report<F: Force>(problem: &Problem<F>) -> Result<Report, Failure> {
    let contenders = contenders(problem);
    let mut crates: Vec<(_, Vec<Point>, Vec<f64>)> = Vec::new();
    for (name, run) in &contenders {
        let points = tolerances(EXPONENTS).map(run).collect::<Result<_, _>>()?;
        crates.push((*name, points, vec![f64::INFINITY; EXPONENTS.count()]));
    }
    let mut right_hand_sides = vec![f64::INFINITY; EXPONENTS.count()];
    for _ in 0..ROUNDS {
        for (i, tolerance) in tolerances(EXPONENTS).enumerate() {
            for ((_, run), (_, _, fastest)) in contenders.iter().zip(&mut crates) {
                let start = Instant::now();
                run(tolerance)?;
                fastest[i] = f64::min(fastest[i], start.elapsed().as_secs_f64() * 1e6);
            }
            let start = Instant::now();
            black_box(problem.right_hand_sides(crates[0].1[i].evaluations));
            right_hand_sides[i] = f64::min(right_hand_sides[i], start.elapsed().as_secs_f64() * 1e6);
        }
    }
    Ok(Report { problem: problem.name, methods: methods(problem)?, crates, right_hand_sides })
}

/// One period of the Arenstorf orbit by DOP853 of a crate, by its name in [`Report::crates`]: what `benches/` times.
///
/// # Errors
/// What the crate fails with; there is none of this name.
pub fn arenstorf(of: &str, tolerance: f64) -> Result<Point, Failure> {
    let problem = problems::arenstorf();
    let mut contenders = contenders(&problem).into_iter();
    let (_, run) = contenders.find(|(name, _)| *name == of).ok_or_else(|| format!("there is no crate {of}"))?;
    run(tolerance)
}

fn contenders<F: Force>(problem: &Problem<F>) -> Vec<(&'static str, Contender<'_>)> {
    vec![
        ("mbs_runtime", Box::new(|tolerance| run(problem, &Dop853::new(tolerance, tolerance), tolerance))),
        ("ode_solvers", Box::new(|tolerance| rivals::ode_solvers(problem, tolerance))),
        ("differential-equations", Box::new(|tolerance| rivals::differential_equations(problem, tolerance))),
        #[cfg(feature = "russell")]
        ("russell_ode", Box::new(|tolerance| rivals::russell_ode(problem, tolerance))),
    ]
}

/// The tolerances with these exponents.
pub fn tolerances(exponents: std::ops::RangeInclusive<i32>) -> impl Iterator<Item = f64> {
    exponents.map(|exponent| 10.0_f64.powi(-exponent))
}

/// Every method, the fixed steps halved from one run to the next.
fn methods<F: Force>(problem: &Problem<F>) -> Result<Vec<(&'static str, Vec<Point>)>, Failure> {
    let fixed = |run: &dyn Fn(f64) -> Result<Point, Failure>, least: u32, most: u32| {
        let steps = (least..=most).map(|power| problem.end / f64::from(1_u32 << power));
        // A step that is too long for a close encounter throws the body out, or does not converge: no point.
        steps.filter_map(|step| run(step).ok()).filter(|point| point.error < 1.0).collect::<Vec<_>>()
    };
    let by_tolerance = |run: &dyn Fn(f64) -> Result<Point, Failure>| -> Result<Vec<_>, Failure> {
        let points = tolerances(3..=13).map(run).collect::<Result<Vec<_>, _>>()?;
        Ok(points.into_iter().filter(|point| point.error < 1.0).collect())
    };
    let mut methods = vec![("SemiImplicitEuler", fixed(&|h| run(problem, &SemiImplicitEuler::new(h), h), 8, 20))];
    if problem.separable {
        methods.push(("StormerVerlet", fixed(&|h| run(problem, &StormerVerlet::new(h), h), 8, 20)));
    }
    methods.extend([
        ("Rk4", fixed(&|h| run(problem, &Rk4::new(h), h), 7, 17)),
        ("GaussLegendre4", fixed(&|h| run(problem, &GaussLegendre4::new(h), h), 7, 16)),
        ("Dopri5", by_tolerance(&|tol| run(problem, &Dopri5::new(tol, tol), tol))?),
        ("Dop853", by_tolerance(&|tol| run(problem, &Dop853::new(tol, tol), tol))?),
    ]);
    Ok(methods)
}

/// The problem by a method of `mbs_runtime`.
fn run<F: Force>(problem: &Problem<F>, method: &impl Integrator<f64>, setting: f64) -> Result<Point, Failure> {
    let mut state = State::new(problem.q, problem.qd);
    let force = |_: f64, q: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]| *qdd = (problem.force)(q, qd);
    let summary = method.integrate(force, 0.0, problem.end, &mut state, |_| ControlFlow::Continue(()))?;
    let [x, y] = state.q;
    let [vx, vy] = state.qd;
    Ok(Point { setting, evaluations: summary.evaluations, error: problem.error([x, y, vx, vy]) })
}

/// The runs that no other one beats in both error and work, from the least precise one on.
fn frontier(points: &[Point]) -> Vec<Point> {
    let beaten = |a: &Point| points.iter().any(|b| b.error < a.error && b.evaluations <= a.evaluations);
    points.iter().copied().filter(|point| !beaten(point)).collect()
}

/// The evaluations for an error, between two runs on a straight line in logarithms; none beyond them.
fn work(frontier: &[Point], error: f64) -> Option<f64> {
    let pair = frontier.windows(2).find(|pair| pair[1].error <= error && error <= pair[0].error)?;
    let part = (error / pair[0].error).ln() / (pair[1].error / pair[0].error).ln();
    let [from, to] = [0, 1].map(|i| (pair[i].evaluations as f64).ln());
    Some((from + part * (to - from)).exp())
}

/// The smallest ratio of the other's evaluations to ours for the same error, where both curves reach.
#[must_use]
pub fn least_work_ratio(ours: &[Point], other: &[Point]) -> f64 {
    let (ours, other) = (frontier(ours), frontier(other));
    let errors = ours.iter().chain(&other).map(|point| point.error);
    let ratios = errors.filter_map(|error| Some(work(&other, error)? / work(&ours, error)?));
    ratios.fold(f64::INFINITY, f64::min)
}

/// The smallest ratio of the other's time to ours at the same tolerance.
#[must_use]
pub fn least_time_ratio(ours: &[f64], other: &[f64]) -> f64 {
    other.iter().zip(ours).map(|(other, ours)| other / ours).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_rival_needs_less_work_on_the_arenstorf_orbit() {
        let problem = problems::arenstorf();
        let curves: Vec<(&str, Vec<Point>)> = contenders(&problem)
            .into_iter()
            .map(|(name, run)| (name, tolerances(EXPONENTS).map(|tolerance| run(tolerance).unwrap()).collect()))
            .collect();
        for (name, curve) in &curves[1..] {
            let ratio = least_work_ratio(&curves[0].1, curve);
            assert!((0.95..2.0).contains(&ratio), "{name}: {ratio}");
        }
    }

    #[test]
    fn curves_are_interpolated_in_logarithms() {
        let point = |evaluations, error| Point { setting: 0.0, evaluations, error };
        // The second run is beaten by the third.
        let curve = frontier(&[point(100, 1e-2), point(2000, 1e-3), point(1000, 1e-4), point(10_000, 1e-6)]);
        assert_eq!(curve.len(), 3);
        assert!((work(&curve, 1e-3).unwrap() - 1e5_f64.sqrt()).abs() < 1e-9);
        assert!((work(&curve, 1e-5).unwrap() - 1e7_f64.sqrt()).abs() < 1e-9);
        assert_eq!((work(&curve, 1e-1), work(&curve, 1e-7)), (None, None));
    }
}
