//! A, B, C and D of a mechanism at a state, and what they say.

use mbs_derive::expr::Symbol;
use mbs_derive::interpret::Interpreter;
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::variable::component_names;
use nalgebra::{Complex, DMatrix, DVector};

use crate::eigenvalues::{balanced, eigenvalues};
use crate::failure::Failure;
use crate::state::Point;

use super::along::Along;
use super::exponential::exponential;
use super::observation;
use super::reduction::{self, Fault, Solution};

/// The linear system in independent coordinates and speeds.
pub(super) struct System {
    pub(super) coordinates: Vec<usize>,
    pub(super) speeds: Vec<usize>,
    /// Names and units of the outputs' components.
    pub(super) outputs: Vec<[String; 2]>,
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) c: DMatrix<f64>,
    pub(super) d: DMatrix<f64>,
    /// All of them, at the state itself.
    pub(super) accelerations: Vec<f64>,
}

/// The derivatives of constrained accelerations and of outputs, in what the constraints leave independent.
pub(super) fn linearize(derivation: &Derivation, point: &Point, independent: &[usize]) -> Result<System, Failure> {
    let interpreter = Interpreter::with_parameters(derivation, point.parameters.clone());
    let (n, inputs) = (derivation.dof(), component_names(&derivation.inputs).len());
    let call = |kind| interpreter.call(kind, &point.state).expect("every mechanism has it");
    let accelerations = call(FunctionKind::ForwardDynamics);
    if !accelerations.iter().all(|x| x.is_finite()) {
        return Err(Failure::new("accelerations are infinite or NaN at the state"));
    }

    let (positions, speeds) = independent_motions(&interpreter, point, independent)?;
    let [p, r, s] = [&positions.slopes, &speeds.slopes, &speeds.constants];
    let slopes = call(FunctionKind::Linearize);
    let [by_position, by_speed, by_input] = if slopes.iter().all(|x| x.is_finite()) {
        let block = |start: usize, width: usize| DMatrix::from_row_slice(n, width, &slopes[start..start + n * width]);
        let (by_q, by_qd) = (block(0, n), block(n * n, n));
        [&by_q * p + &by_qd * s, by_qd * r, block(2 * n * n, inputs)]
    } else {
        along_admissible_motions(derivation, point, [p, s, r])
    };
    if ![&by_position, &by_speed, &by_input].iter().all(|slopes| slopes.iter().all(|x| x.is_finite())) {
        let row = speeds.singular.map(|row| &derivation.constraints[row]);
        let why = row.map_or(String::new(), |row| {
            format!(": there `{row}` vanishes or depends on other constraints, but not in neighbouring states")
        });
        return Err(Failure::new(format_args!("derivatives of accelerations are infinite or NaN at the state{why}")));
    }
    let at = |matrix: &DMatrix<f64>, rows: &[usize]| matrix.select_rows(rows);
    let (coordinates, named) = (positions.independent.clone(), speeds.independent.clone());
    let (i, j) = (coordinates.len(), named.len());
    let mut a = DMatrix::zeros(i + j, i + j);
    a.view_mut((0, 0), (i, i)).copy_from(&at(s, &coordinates));
    a.view_mut((0, i), (i, j)).copy_from(&at(r, &coordinates));
    a.view_mut((i, 0), (j, i)).copy_from(&at(&by_position, &named));
    a.view_mut((i, i), (j, j)).copy_from(&at(&by_speed, &named));
    let mut b = DMatrix::zeros(i + j, inputs);
    b.view_mut((i, 0), (j, inputs)).copy_from(&at(&by_input, &named));

    let outputs = observation::components(derivation);
    let [out_q, out_qd, d] = observation::slopes(derivation, point);
    if !out_q.iter().chain(out_qd.iter()).chain(d.iter()).all(|x| x.is_finite()) {
        return Err(Failure::new("an output, or its derivative, is infinite or NaN at the state"));
    }
    let mut c = DMatrix::zeros(outputs.len(), i + j);
    c.view_mut((0, 0), (outputs.len(), i)).copy_from(&(&out_q * p + &out_qd * s));
    c.view_mut((0, i), (outputs.len(), j)).copy_from(&(&out_qd * r));
    Ok(System { coordinates, speeds: named, outputs, a, b, c, d, accelerations })
}

/// The derivatives of accelerations by independent coordinates, by independent speeds and by inputs, each along the
/// motion of all coordinates and speeds that follows.
///
/// Where rows depend on others, a change of one coordinate alone may make them contradict each other: `linearize` has
/// NaN for it, and no sum of its columns is the derivative along a motion on which all rows agree.
fn along_admissible_motions(
    derivation: &Derivation,
    point: &Point,
    [p, s, r]: [&DMatrix<f64>; 3],
) -> [DMatrix<f64>; 3] {
    let (n, along) = (derivation.dof(), Along::new(derivation, point));
    let function = derivation.function(FunctionKind::ForwardDynamics).expect("every mechanism has it");
    let by = |columns: usize, change: &dyn Fn(Symbol, usize) -> f64| {
        let column = |j: usize| along.slope(function, |symbol| change(symbol, j));
        DMatrix::from_column_slice(n, columns, &(0..columns).flat_map(column).collect::<Vec<f64>>())
    };
    [
        by(p.ncols(), &|symbol, j| match symbol {
            Symbol::Coordinate(i) => p[(i as usize, j)],
            Symbol::Velocity(i) => s[(i as usize, j)],
            _ => 0.0,
        }),
        by(r.ncols(), &|symbol, j| match symbol {
            Symbol::Velocity(i) => r[(i as usize, j)],
            _ => 0.0,
        }),
        by(point.state.u.len(), &|symbol, j| f64::from(u8::from(symbol == Symbol::Input(j as u32)))),
    ]
}

/// `δq = P δq_I` of the holonomic rows, and `δq̇ = S δq_I + R δq̇_J` of all.
fn independent_motions(
    interpreter: &Interpreter<'_>,
    point: &Point,
    independent: &[usize],
) -> Result<(Solution, Solution), Failure> {
    use FunctionKind::{Constraint, ConstraintJacobian, ConstraintRate, ConstraintRateJacobian};
    let derivation = interpreter.derivation();
    let (n, k) = (derivation.dof(), derivation.constraints.len());
    let rows = |kind| interpreter.rows(kind, &point.state);
    let a = DMatrix::from_row_slice(k, n, &rows(ConstraintJacobian));
    check_state(derivation, point, &a, [&rows(Constraint), &rows(ConstraintRate)])?;
    let holonomic: Vec<usize> = (0..k).filter(|&row| derivation.holonomic[row]).collect();
    let named = (!independent.is_empty()).then_some(independent);
    let names = component_names(&derivation.coordinates);
    let failed = |fault: Fault| match fault {
        Fault::Tied { .. } => {
            Failure::new("the constraints hold the coordinates of `--independent`, or tie them to each other")
        }
        Fault::Free { unknown } => {
            Failure::new(format_args!("`{}` does not follow from the coordinates of `--independent`", names[unknown]))
        }
    };
    let positions =
        reduction::solve(a.select_rows(&holonomic), DMatrix::zeros(holonomic.len(), 0), named).map_err(failed)?;
    let moved = DMatrix::from_row_slice(k, n, &rows(ConstraintRateJacobian)) * &positions.slopes;
    // Where rows on speeds alone take away more of them, those that are left are chosen.
    let speeds = reduction::solve(a.clone(), moved.clone(), named).or_else(|_| reduction::solve(a, moved, None));
    Ok((positions, speeds.map_err(failed)?))
}

/// Whether rows and their rates are zero, but for what changes of coordinates and velocities by a small part explain.
fn check_state(
    derivation: &Derivation,
    point: &Point,
    jacobian: &DMatrix<f64>,
    [position, rate]: [&[f64]; 2],
) -> Result<(), Failure> {
    const SMALL: f64 = 1e-8;
    let size = |numbers: &[f64]| numbers.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    let (far, fast) = (size(&point.state.q), size(&point.state.qd));
    for (row, name) in derivation.constraints.iter().enumerate() {
        let explained = SMALL * jacobian.row(row).abs().sum();
        let position = if derivation.holonomic[row] { position[row].abs() } else { 0.0 };
        for (what, off, explained) in
            [("", position, far * explained), ("the rate of ", rate[row].abs(), fast * explained)]
        {
            if off.is_nan() || off > explained {
                return Err(Failure::new(format_args!(
                    "the state is not on the constraints: {what}`{name}` is off by {off:e}; name in `--trim` what may be changed"
                )));
            }
        }
    }
    Ok(())
}

impl System {
    /// With inputs held for a time: the exponential of `[[A, B], [0, 0]] T` (Van Loan, 1978).
    pub(super) fn sampled(self, time: f64) -> Result<Self, Failure> {
        let (a, b) = sampled(&self.a * time, &self.b * time).ok_or_else(|| {
            Failure::new("the sampled system leaves the range of numbers: the sample time is too long")
        })?;
        Ok(System { a, b, ..self })
    }

    /// The eigenvalues of A by their size; of a pair the one above the real axis first.
    pub(super) fn poles(&self) -> Option<Vec<Complex<f64>>> {
        let size = |pole: &Complex<f64>| pole.re.hypot(pole.im);
        let mut poles = eigenvalues(self.a.clone())?;
        poles.sort_by(|x, y| size(x).total_cmp(&size(y)).then(x.re.total_cmp(&y.re)).then(y.im.total_cmp(&x.im)));
        Some(poles)
    }

    /// How many directions of the state the inputs reach.
    pub(super) fn controllability_rank(&self) -> usize {
        reachable(&self.a, &self.b)
    }

    /// How many directions of the state the outputs show in time.
    pub(super) fn observability_rank(&self) -> usize {
        reachable(&self.a.transpose(), &self.c.transpose())
    }
}

/// `exp A` and `∫₀¹ exp(A s) ds B`; `None` where they leave the range of numbers.
///
/// In balanced states, and in units of the inputs that make columns of B no larger than 1: how often the exponential is
/// squared is then a matter of the motion, not of units, and small entries of A are not lost beside large ones of B.
fn sampled(a: DMatrix<f64>, mut b: DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    if !a.iter().chain(b.iter()).all(|x| x.is_finite()) {
        return None;
    }
    let (states, inputs) = b.shape();
    let (a, unit, scale) = balanced(a);
    b.row_iter_mut().zip(scale.iter()).for_each(|(mut row, scale)| row /= *scale);
    // 2⁻¹⁰⁰⁰ has a reciprocal, too.
    let exponent = |size: f64| size.max(1.0).log2().ceil().min(1000.0) as i32;
    let input_units: Vec<f64> = b.column_iter().map(|column| 2_f64.powi(-exponent(column.amax()))).collect();
    b.column_iter_mut().zip(&input_units).for_each(|(mut column, unit)| column *= *unit);
    let mut block = DMatrix::zeros(states + inputs, states + inputs);
    block.view_mut((0, 0), (states, states)).copy_from(&(a * unit));
    block.view_mut((0, states), (states, inputs)).copy_from(&b);
    let whole = exponential(&block)?;
    let phi = DMatrix::from_fn(states, states, |i, j| whole[(i, j)] / scale[j] * scale[i]);
    let gamma = DMatrix::from_fn(states, inputs, |i, j| whole[(i, states + j)] * scale[i] / input_units[j]);
    phi.iter().chain(gamma.iter()).all(|x| x.is_finite()).then_some((phi, gamma))
}

/// The dimension of the span of `B, A B, A² B, …`, as `mbs_runtime::control` finds it.
fn reachable(a: &DMatrix<f64>, b: &DMatrix<f64>) -> usize {
    const NONE: f64 = 1e-10;
    // x = D z with powers of two, A and B taken together.
    let n = a.nrows();
    let mut both = DMatrix::zeros(n + b.ncols(), n + b.ncols());
    both.view_mut((0, 0), (n, n)).copy_from(a);
    both.view_mut((0, n), (n, b.ncols())).copy_from(b);
    let (both, ..) = balanced(both);
    let (a, b) = (both.view((0, 0), (n, n)).into_owned(), both.view((0, n), (n, b.ncols())).into_owned());
    let rounding = a.norm() * f64::EPSILON;
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let add = |mut vector: DVector<f64>, rounding: f64, basis: &mut Vec<DVector<f64>>| {
        let length = vector.norm();
        if length <= rounding || basis.len() == n {
            return;
        }
        vector /= length;
        for _ in 0..2 {
            for known in basis.iter() {
                vector -= known * known.dot(&vector);
            }
        }
        let left = vector.norm();
        if left > NONE {
            basis.push(vector / left);
        }
    };
    b.column_iter().for_each(|column| add(column.into_owned(), 0.0, &mut basis));
    let mut next = 0;
    while next < basis.len() {
        add(&a * &basis[next], rounding, &mut basis);
        next += 1;
    }
    basis.len()
}

#[cfg(test)]
mod tests {
    use super::sampled;
    use nalgebra::DMatrix;

    /// A mass on a spring, pushed, in units of all sizes: what the exponential loses does not depend on them.
    #[test]
    fn samples_do_not_depend_on_units() {
        for mass in [1e-18, 1e-9, 1.0, 1e9] {
            for (omega, time) in [(1.0, 0.1), (1.0, 100.0), (100.0, 1.0), (1e6, 1e-6), (1e-3, 1.0)] {
                let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -omega * omega, 0.0]) * time;
                let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0 / mass]) * time;
                let (phi, gamma) = sampled(a, b).unwrap();
                let (sin, cos) = (omega * time).sin_cos();
                let half = (0.5 * omega * time).sin();
                let expected = [cos, sin / omega, -omega * sin, cos];
                let units = [1.0, 1.0 / omega, omega, 1.0];
                let off = |found: f64, expected: f64, unit: f64| (found - expected).abs() / unit;
                for (k, (expected, unit)) in expected.into_iter().zip(units).enumerate() {
                    let found = phi[(k / 2, k % 2)];
                    assert!(off(found, expected, unit) < 4e-14, "{mass} {omega} {time} {k}: {found}, {expected}");
                }
                let pushed = [2.0 * half * half / (mass * omega * omega), sin / (mass * omega)];
                let unit = 1.0 / (mass * omega);
                assert!(off(gamma[0], pushed[0], unit / omega) < 4e-14, "{mass} {omega} {time}: {gamma}");
                assert!(off(gamma[1], pushed[1], unit) < 4e-14, "{mass} {omega} {time}: {gamma}");
            }
        }
    }

    #[test]
    fn what_leaves_the_range_of_numbers_is_none() {
        for [a, b] in [[1e4, 1.0], [f64::INFINITY, 1.0], [1.0, f64::NAN], [1e300, 1.0], [700.0, 1e300]] {
            assert_eq!(sampled(DMatrix::from_element(1, 1, a), DMatrix::from_element(1, 1, b)), None, "{a} {b}");
        }
        let (phi, gamma) = sampled(DMatrix::zeros(1, 1), DMatrix::from_element(1, 1, f64::MAX)).unwrap();
        assert_eq!((phi[0], gamma[0]), (1.0, f64::MAX));
    }
}
