//! The rows of the constraints as linear equations of the velocities: their degree, and which of them say something.

use crate::expr::{Dual, Expr, Function, Node, Residue, Symbol, Tape, Value, sparse};

use crate::model::check::degree::{Line, Problem, seems_beyond};
use crate::model::check::relation::Multiples;
use crate::model::check::velocity;
use crate::model::lagrangian::{ConstraintKind, Draft};
use crate::numeric::echelon::Echelon;

/// `A q̇ + b = 0`, the rows of all constraints.
pub(in crate::model) struct VelocityEquations {
    rows: Tape,
    /// The coordinates that each row depends on, or whose rates it does, and the row by itself.
    each: Vec<(Vec<usize>, Tape)>,
    /// Whether values of a row at some points say nothing about others.
    in_pieces: Vec<bool>,
    kinds: Vec<ConstraintKind>,
    /// Of each row the number of its constraint, and its own number there.
    owners: Vec<(usize, usize)>,
    vectors: Vec<usize>,
}

/// At this share of its length what is left of a row may be nothing but rounding, and at this it is.
const DOUBTFUL: f64 = 1e-9;
const ROUNDING: f64 = 1e-13;

impl VelocityEquations {
    pub(in crate::model) fn new(lagrangian: &Draft<'_>) -> Self {
        let all =
            || lagrangian.constraints.iter().enumerate().flat_map(|(i, c)| (0..c.rows.len()).map(move |k| (i, k)));
        let rows: Vec<Expr<'_>> = all().map(|(i, k)| lagrangian.constraints[i].rows[k]).collect();
        let each: Vec<_> = rows.iter().map(|row| Tape::new(&[*row])).map(|tape| (tape.coordinates(), tape)).collect();
        VelocityEquations {
            rows: Tape::new(&rows),
            in_pieces: each.iter().map(|(_, tape)| tape.has_pieces()).collect(),
            each,
            kinds: all().map(|(i, _)| lagrangian.constraints[i].kind).collect(),
            owners: all().collect(),
            vectors: lagrangian.constraint_vectors(),
        }
    }

    /// A, row by row.
    fn jacobian<V: Value>(&self, n: usize, at: impl Fn(&dyn Fn(u32) -> V, Symbol) -> Dual<V>) -> Vec<Vec<V>> {
        let row = |((coordinates, tape), kind): (&(Vec<usize>, Tape), &ConstraintKind)| {
            let rate = |moving: Option<usize>| {
                let velocity = |i: u32| V::constant(f64::from(u8::from(moving == Some(i as usize))));
                let rate = tape.run(|symbol| at(&velocity, symbol))[0];
                if *kind == ConstraintKind::Holonomic { rate.derivative } else { rate.value }
            };
            let rest = rate(None);
            let mut row = vec![rest.sub(rest); n];
            coordinates.iter().for_each(|&i| row[i] = rate(Some(i)).sub(rest));
            row
        };
        self.each.iter().zip(&self.kinds).map(row).collect()
    }

    /// Which rows are of one vector.
    pub(in crate::model) fn vectors(&self) -> impl Iterator<Item = usize> {
        self.vectors.iter().copied()
    }

    pub(in crate::model) fn pfaffian(&self, line: &Line, n: usize) -> Vec<Vec<f64>> {
        self.jacobian(n, |velocity, symbol| line.with_velocity(velocity, symbol))
    }

    pub(in crate::model) fn pfaffian_in_field<const K: usize>(
        &self,
        line: &Line,
        point: u64,
        n: usize,
    ) -> Vec<Vec<Residue<K>>> {
        self.jacobian(n, |velocity, symbol| line.in_field(point, velocity, symbol))
    }

    /// The constraints that are not linear in the velocities.
    pub(in crate::model) fn degrees(&self, lagrangian: &Draft<'_>, lines: &[Line]) -> Vec<Problem> {
        let bent = |(number, constraint): (usize, &crate::model::Constraint<'_>)| {
            let first = self.owners.iter().position(|owner| *owner == (number, 0)).unwrap_or(0);
            let seems = |row: usize| lines.iter().any(|line| seems_beyond(1, &self.rows, first + row, line));
            let is_bent =
                constraint.kind == ConstraintKind::Pfaffian && !velocity::beyond(1, &constraint.rows, seems).is_empty();
            is_bent.then_some(Problem::ConstraintNotLinear(number))
        };
        lagrangian.constraints.iter().enumerate().filter_map(bent).collect()
    }

    /// Rows that say nothing: what others determine, and what has no gradient where it holds.
    pub(in crate::model) fn problems(&self, lagrangian: &Draft<'_>, lines: &[Line]) -> Vec<Problem> {
        let degenerate = lagrangian.constraints.iter().enumerate().filter(|(_, constraint)| {
            let is_degenerate = |row: &Expr<'_>| is_root(*row) || has_multiple_zero(*row, lines);
            constraint.kind == ConstraintKind::Holonomic && constraint.rows.iter().any(is_degenerate)
        });
        let degenerate: Vec<Problem> = degenerate.map(|(number, _)| Problem::DegenerateConstraint(number)).collect();
        if !degenerate.is_empty() {
            return degenerate;
        }
        let dependent = self.dependent_rows(lines, lagrangian.dof());
        self.by_constraint(lines, lagrangian.dof(), &dependent)
    }

    /// Dependent rows by constraints, each with how its rows follow.
    fn by_constraint(&self, lines: &[Line], n: usize, dependent: &[usize]) -> Vec<Problem> {
        let kept: Vec<usize> = (0..self.owners.len()).filter(|row| !dependent.contains(row)).collect();
        let finite = |rows: &Vec<Vec<f64>>| rows.iter().flatten().all(|x| x.is_finite());
        let states = || lines.iter().map(|line| self.pfaffian(line, n)).filter(finite).collect();
        let states: Vec<_> = if dependent.is_empty() { Vec::new() } else { states() };
        let multiples = Multiples::of(&states, dependent, &kept);
        let constraints = dependent.chunk_by(|a, b| self.owners[*a].0 == self.owners[*b].0);
        let mut begin = 0;
        let problem = |rows: &[usize]| {
            let number = self.owners[rows[0]].0;
            let places = begin..begin + rows.len();
            begin = places.end;
            let relation = multiples.relation(places, |place| self.owners[kept[place]].0 == number);
            Problem::DependentConstraint(number, rows.iter().map(|&row| self.owners[row].1).collect(), relation)
        };
        constraints.map(problem).collect()
    }

    /// The rows that are at all states sums of multiples of those before them. Of a row for which every motion is
    /// already taken nothing is said: off the constraints a closed loop may leave no motion, and have one where it is
    /// closed.
    fn dependent_rows(&self, lines: &[Line], n: usize) -> Vec<usize> {
        if n + self.owners.len() > sparse::FEW_UNKNOWNS {
            let unit: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| f64::from(u8::from(i == j)))).collect();
            if lines.iter().take(2).any(|line| sparse::is_regular(n, &unit, &self.pfaffian(line, n).concat())) {
                return Vec::new();
            }
        }
        let matrices: Vec<Vec<Vec<f64>>> = lines.iter().map(|line| self.pfaffian(line, n)).collect();
        let finite: Vec<_> = matrices.into_iter().filter(|rows| rows.iter().flatten().all(|x| x.is_finite())).collect();
        let shares = |all: bool| -> Vec<Vec<f64>> {
            let enters = |row: usize| all || !self.in_pieces[row];
            finite.iter().map(|rows| shares_of_their_own(rows, n, enters)).collect()
        };
        let largest = |shares: &[Vec<f64>], row: usize| shares.iter().map(|here| here[row]).fold(0.0, f64::max);
        let among_all = shares(true);
        let doubtful: Vec<usize> =
            (0..self.owners.len()).filter(|&row| !finite.is_empty() && largest(&among_all, row) <= DOUBTFUL).collect();
        // What follows from rows without pieces does so everywhere.
        let among_smooth = if self.in_pieces.contains(&true) { shares(false) } else { among_all };
        let is_sure = |row: usize| !self.in_pieces[row] && largest(&among_smooth, row) <= ROUNDING;
        if doubtful.iter().all(|&row| is_sure(row)) {
            return doubtful;
        }
        // Rows may be nearly parallel for the units of their coordinates alone, or only on those sides of conditions
        // that some states lead to.
        let (first, second) = (self.dependent_in_field::<0>(lines, n), self.dependent_in_field::<1>(lines, n));
        let exactly = [first, second];
        let follows = |row: &usize| is_sure(*row) || exactly.iter().flatten().all(|dependent| dependent.contains(row));
        doubtful.into_iter().filter(follows).collect()
    }

    /// The rows that follow at all of some points, at which comparisons come out one way or the other; `None` where
    /// nothing has a value.
    fn dependent_in_field<const K: usize>(&self, lines: &[Line], n: usize) -> Option<Vec<usize>> {
        const TRIED: u64 = 16;
        let (points, tried) = if self.in_pieces.contains(&true) { (64, 4 * TRIED) } else { (1, TRIED) };
        let line = lines.first()?;
        let echelons = (0..tried).filter_map(|point| Echelon::of(self.pfaffian_in_field::<K>(line, point, n)));
        let dependent = echelons.take(points).map(|echelon| echelon.dependent_rows().to_vec());
        dependent.reduce(|all, here| all.into_iter().filter(|row| here.contains(row)).collect())
    }
}

/// Of each row that enters the share of its length that those before it do not have, by orthogonalization; 1 where they
/// are n already, and of rows that do not enter.
fn shares_of_their_own(rows: &[Vec<f64>], n: usize, enters: impl Fn(usize) -> bool) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut shares = Vec::new();
    for (number, row) in rows.iter().enumerate() {
        if basis.len() == n || !enters(number) {
            shares.push(1.0);
            continue;
        }
        let size = row.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
        let mut rest: Vec<f64> = row.iter().map(|x| x / size).collect();
        let whole = dot(&rest, &rest).sqrt();
        // Twice is enough (Giraud, Langou & Rozložník, The loss of orthogonality in the Gram–Schmidt process, 2005).
        for _ in 0..2 {
            for unit in &basis {
                let along = dot(&rest, unit);
                rest.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
        }
        let length = dot(&rest, &rest).sqrt();
        let share = if size == 0.0 { 0.0 } else { length / whole };
        shares.push(share);
        if share > ROUNDING {
            basis.push(rest.iter().map(|x| x / length).collect());
        }
    }
    shares
}

/// Whether it is a length or a size, which has no gradient where it is zero.
fn is_root(row: Expr<'_>) -> bool {
    match row.node() {
        Node::Power(_, n) => n.to_halves() == 1,
        node => matches!(node, Node::Call(Function::Abs, _)),
    }
}

/// Whether Newton's method comes nearer to zero by nothing but a constant factor at each step, from all states from
/// which it comes near at all: by 1/4 where a square is to vanish, by ever less where the gradient does not vanish with
/// the row.
fn has_multiple_zero(row: Expr<'_>, lines: &[Line]) -> bool {
    let tape = Tape::new(&[row]);
    let found: Vec<bool> = lines.iter().take(4).filter_map(|line| converges_linearly(&tape, line)).collect();
    !found.is_empty() && found.into_iter().all(|linearly| linearly)
}

fn converges_linearly(tape: &Tape, line: &Line) -> Option<bool> {
    const STEPS: usize = 60;
    const NEAR: f64 = 1e-6;
    let mut q = line.state.q.clone();
    let mut residuals: Vec<f64> = Vec::new();
    for _ in 0..STEPS {
        let (value, gradient) = value_and_gradient(tape, line, &q);
        let square: f64 = gradient.iter().map(|slope| slope * slope).sum();
        if !value.is_finite() || !square.is_finite() {
            return None;
        }
        residuals.push(value.abs());
        let near: Vec<f64> = residuals.iter().copied().skip_while(|r| *r > NEAR * residuals[0]).collect();
        if near.len() == 4 {
            let factors: Vec<f64> = near.windows(2).map(|pair| pair[1] / pair[0]).collect();
            return Some(factors.iter().all(|factor| (0.1..0.9).contains(factor)));
        }
        if value == 0.0 {
            return (!near.is_empty() && residuals.len() > 1).then_some(false);
        }
        if square == 0.0 {
            return None;
        }
        q.iter_mut().zip(&gradient).for_each(|(q, slope)| *q -= slope * value / square);
    }
    None
}

/// Of a holonomic row: the velocities are directions.
fn value_and_gradient(tape: &Tape, line: &Line, q: &[f64]) -> (f64, Vec<f64>) {
    let along = |direction: Option<usize>| {
        tape.run(|symbol| match symbol {
            Symbol::Coordinate(i) => Dual::new(q[i as usize], f64::from(u8::from(direction == Some(i as usize)))),
            other => Dual::fixed(line.with_velocity(&|_| 0.0, other).value),
        })[0]
    };
    let mut gradient = vec![0.0; q.len()];
    tape.coordinates().into_iter().for_each(|i| gradient[i] = along(Some(i)).derivative);
    (along(None).value, gradient)
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::refusals;

    #[test]
    fn a_row_must_have_a_gradient_where_it_holds() {
        for degenerate in [
            "(x + y)^2 = 0",
            "(x^2 + y^2 - l^2)^2 = 0",
            "(x - y)^4*(l^2 + x^2) = 0",
            "x^2 + y^2 = 0",
            "sin(theta) = 1",
            "cos(theta - q[0]) = 1",
            "abs(x - l) = 0",
            "[x, y, z].norm() = 0",
            "[(x - y)^2, z*l] = 0",
        ] {
            let found = refusals(&format!("constraint c: {degenerate};"));
            assert!(
                found.len() == 1 && found[0].contains("its gradient vanishes or is not finite"),
                "{degenerate}: {found:?}"
            );
        }
        for regular in [
            "x^2 + y^2 = l^2",
            "x^2 + y^2 = (1e7*l)^2",
            "1/(l^2 + x^2) = 1/(4*l^2)",
            "exp(x/l) = 1e4",
            "sin(theta) = 0.999",
            "(x + y)^3 = l^3",
            "x*y = 0",
            "[x, y, z].norm() = l",
            "tan(theta/4) = 1",
        ] {
            assert_eq!(refusals(&format!("constraint c: {regular};")), [""; 0], "{regular}");
        }
    }

    #[test]
    fn rows_that_others_determine_are_named() {
        let check = |constraints: &str, message: &str| {
            let found = refusals(constraints);
            assert!(found.len() == 1 && found[0].contains(message), "{constraints}: {found:?}");
        };
        check(
            "constraint a: x = y; constraint b: [x, y, z] = [y, z, l];",
            "the world component x of the constraint `b` follows from the other rows, or contradicts them; keep the others: \
             `[v.y, v.z] = 0`, with `let v = [x, y, z] - ([y, z, l]);`",
        );
        check(
            "constraint a: [x, y] = [y, z]; constraint b: [z, theta*l] = [x, l];",
            "row 1 of 2 of the constraint `b` follows from the other rows, or contradicts them; keep its other rows only",
        );
        check("constraint a: abs(x) = l; constraint b: 2*abs(x) = 2*l;", "the constraint `b` follows from the others");
        // Rows with pieces beside it change nothing.
        for beside in ["max(z - 50*l, 0) = 0", "sqrt(x^2 + z^2) = 3*l"] {
            check(
                &format!("constraint a: x = y; constraint b: {beside}; constraint c: 2*x = 2*y;"),
                "the constraint `c` follows from the others",
            );
        }
        check(
            "constraint a: sqrt(x^2 + l^2) = 2*l; constraint b: 3*sqrt(x^2 + l^2) = 6*l;",
            "the constraint `b` follows",
        );
        for regular in [
            // The units of coordinates alone make rows nearly parallel.
            "constraint a: 1e12*x + y = 0; constraint b: 1e12*x + 2*y = z;",
            // Sides of conditions that no sampled state leads to.
            "constraint a: x = y; constraint b: max(z - 50*l, 0) = 0;",
            "constraint a: if t > 5 s { dt(z) } else { dt(x) } = 0; constraint b: dt(x) = 0;",
        ] {
            assert_eq!(refusals(regular), [""; 0], "{regular}");
        }
    }
}
