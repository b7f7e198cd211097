//! `constraint name: left = right;`: rows that vanish, of one kind.
//!
//! The rows of a vector are its components in world axes; those that vanish identically, as in plane motion, are left
//! out.

use std::collections::BTreeMap;

use crate::diagnostic::Code;
use crate::expr::{
    Dual, Expr, Graph, Node, Number, Rounded, Symbol, Tape, Verdict, carry_out, degree_is_at_most, vanishes,
};
use crate::model::check::closure::closes;
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::{Constraint, ConstraintKind, Draft};
use crate::model::names::family::Family;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::{Dimension, second_lacks};
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::model::value::{Free, Scalar, Shape, Value, shared};
use crate::numeric::Random;
use crate::parse::syntax::{BinaryOperator, Expression, Name, Span};
use crate::state::State;

/// More rows than any mechanism of so few coordinates has.
const MAX_ROWS: usize = 10_000;

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn constraint(
        &mut self,
        docs: &[String],
        name: &Name,
        index: Option<&Expression>,
        left: &Expression,
        right: &Expression,
    ) -> Resolved<()> {
        let span = left.span.start..right.span.end;
        let difference = difference(left, right);
        let number = self.number_of(index, MAX_ROWS, "constraint");
        let (left, right) = (self.argument(left), self.argument(right));
        let number = number?;
        self.note_constraint(name, number)?;
        let (left, right) = (left?, right?);
        let (left_shape, right_shape) = (left.value.shape(), right.value.shape());
        let rows = self.differences(left.clone(), right.clone(), &span)?;
        let (rows, effective) = match self.rows_when_held(rows.len()) {
            None => (self.effective(rows, &span)?, self.found.effective_rows.last().cloned().unwrap_or_default()),
            Some(effective) => {
                let pairs = rows.into_iter().zip(&effective).filter(|(_, is_in)| **is_in);
                (pairs.map(|(row, _)| row).collect(), effective)
            }
        };
        let kind = self.kind_of(&rows, &span)?;
        let units = self.units_of_rows([&left, &right], kind, &effective)?;
        let is_vector = [&left_shape, &right_shape].contains(&&Shape::Vector);
        self.found.places.differences.push(is_vector.then_some(difference));
        let name = number.map_or(name.text.clone(), |i| format!("{}_{i}", name.text));
        self.lagrangian.constraints.push(Constraint { name, docs: docs.to_vec(), kind, rows, units });
        let place = self.report.here(&span);
        self.found.places.constraints.push(place);
        Ok(())
    }

    fn note_constraint(&mut self, name: &Name, number: Option<usize>) -> Resolved<()> {
        match self.found.constraints.iter().position(|family| family.name.text == name.text) {
            Some(known) => {
                self.join(|resolver| &mut resolver.found.constraints[known], name, number, "constraint")?;
            }
            None => self.found.constraints.push(Family::new(name, number)),
        }
        Ok(())
    }

    /// Every index of an array stands for a constraint, and no two rows have one name.
    pub(in crate::model) fn check_families(&mut self) {
        for family in std::mem::take(&mut self.found.constraints) {
            let _ = self.complete(&family, "constraint");
        }
        let mut known: BTreeMap<String, usize> = BTreeMap::new();
        let constraints = std::mem::take(&mut self.lagrangian.constraints);
        for (number, constraint) in constraints.iter().enumerate() {
            for row in constraint.row_names() {
                if let Some(other) = known.insert(row.clone(), number).filter(|other| *other != number) {
                    let (one, other) = (&constraint.name, &constraints[other].name);
                    let message = match one == other {
                        true => format!("`{one}` is a constraint of its own and an element of an array"),
                        false => format!("the constraints `{one}` and `{other}` both have a row called `{row}`"),
                    };
                    let place = self.found.places.constraints[number].clone();
                    self.report.refuse_at(Code::NameClash, &place, message, "choose another name");
                }
            }
        }
        self.lagrangian.constraints = constraints;
    }

    /// `left − right`, row by row.
    fn differences(&mut self, left: Argument<'g>, right: Argument<'g>, span: &Span) -> Resolved<Vec<Expr<'g>>> {
        let nothing = |resolver: &mut Self, side: &Argument<'g>| match &side.value {
            Value::Scalar(scalar) => resolver.known.facts.constant(scalar.expr).is_some_and(Number::is_zero),
            _ => false,
        };
        if nothing(self, &right) {
            return Ok(self.rows_of(&left)?.into_iter().map(|row| row.expr).collect());
        }
        if nothing(self, &left) {
            return Ok(self.rows_of(&right)?.into_iter().map(|row| row.expr).collect());
        }
        if (left.value.shape(), right.value.shape()) == (Shape::Vector, Shape::Vector) {
            let (a, b) = (self.vector(&left)?, self.vector(&right)?);
            self.check_sides(a.fit(), b.fit(), span)?;
            match (&left.value, &right.value) {
                (Value::Point(_), Value::Vector(_)) => self.warn_of_a_vector_for_a_place(&right),
                (Value::Vector(_), Value::Point(_)) => self.warn_of_a_vector_for_a_place(&left),
                _ => {}
            }
            let value = self.binary(BinaryOperator::Sub, left, right, span)?;
            let rows = self.rows_of(&Argument { value, span: span.clone() })?;
            return Ok(rows.into_iter().map(|row| row.expr).collect());
        }
        let (a, b) = (self.rows_of(&left), self.rows_of(&right));
        let (a, b) = (a?, b?);
        if a.len() != b.len() || left.value.shape() != right.value.shape() {
            let (left, right) = (left.value.described(), right.value.described());
            let message = format!("both sides of a constraint are of one shape, these are {left} and {right}");
            return Err(self.refuse(Code::SidesOfOneShape, span, message, "or one side is `0`"));
        }
        let mut rows = Vec::new();
        for (a, b) in a.into_iter().zip(b) {
            self.check_sides(a.fit(), b.fit(), span)?;
            rows.push(if b.expr.is_zero() { a.expr } else { a.expr - b.expr });
        }
        Ok(rows)
    }

    fn check_sides(&mut self, a: (Dimension, bool), b: (Dimension, bool), span: &Span) -> Resolved<()> {
        if shared(a, b).is_some() {
            return Ok(());
        }
        let message = format!(
            "both sides of a constraint need equal dimensions, these are {} and {}",
            in_words(a.0),
            in_words(b.0)
        );
        Err(self.refuse(Code::SidesOfOneDimension, span, message, second_lacks(a.0, b.0)))
    }

    /// Its numbers, in world axes.
    fn rows_of(&mut self, side: &Argument<'g>) -> Resolved<Vec<Scalar<'g>>> {
        match side.value.shape() {
            Shape::Number => Ok(vec![self.scalar(side)?]),
            Shape::Vector => {
                let vector @ Free { dimension, .. } = self.vector(side)?;
                Ok(self.in_world(vector).0.map(|component| Scalar::new(component, dimension)).to_vec())
            }
            Shape::Pose => {
                let help = "constrain its place `pose.origin()`, or angles";
                let message = "a constraint is made of numbers, this is a pose";
                Err(self.refuse(Code::SidesOfOneShape, &side.span, message, help))
            }
            Shape::Part => Err(self.no_value_of_a_part(side)),
            Shape::Matrix | Shape::Array => {
                let mut rows = Vec::new();
                for value in self.elements(side)? {
                    rows.extend(self.rows_of(&Argument { value, span: side.span.clone() })?);
                }
                Ok(rows)
            }
        }
    }

    /// What the rows that are left are in, and their multipliers: those of positions work through displacements, those
    /// of rates through velocities.
    fn units_of_rows(
        &mut self,
        sides: [&Argument<'g>; 2],
        kind: ConstraintKind,
        effective: &[bool],
    ) -> Resolved<Vec<[String; 2]>> {
        let [left, right] = [self.rows_of(sides[0])?, self.rows_of(sides[1])?];
        // The literal 0 has any unit, and stands for as many rows as the other side has.
        let of = |row: usize| {
            let own =
                [&left, &right].into_iter().filter_map(|side| side.get(row)).find(|scalar| !scalar.expr.is_zero());
            own.map_or(Dimension::ONE, |scalar| scalar.dimension)
        };
        let work = self.dimension(match kind {
            ConstraintKind::Holonomic => Dimension::ENERGY,
            ConstraintKind::Pfaffian => Dimension::POWER,
        });
        let of_both = |row: Dimension| {
            let multiplier = work.over(row);
            [row.to_string(), multiplier.map_or(String::new(), |multiplier| multiplier.to_string())]
        };
        Ok((0..effective.len()).filter(|&row| effective[row]).map(|row| of_both(of(row))).collect())
    }

    /// The rows that do not vanish identically.
    fn effective(&mut self, rows: Vec<Expr<'g>>, span: &Span) -> Resolved<Vec<Expr<'g>>> {
        for row in &rows {
            if self.known.facts.dependence(*row).on(Dependence::INPUT) {
                let help = "a motion given from outside is a `prescribed` signal: its derivatives are known";
                return Err(self.refuse(Code::InputInConstraint, span, "a constraint cannot depend on an input", help));
            }
        }
        let simple = Graph::new();
        let simplified = simplified(&rows, &simple);
        let vanishing = vanishing(&rows, &simplified, &self.lagrangian);
        let mut effective = Vec::new();
        let are_effective = vanishing.iter().map(|vanishes| !vanishes).collect();
        for ((row, simplified), vanishes) in rows.iter().zip(simplified).zip(vanishing) {
            match simplified.as_constant() {
                _ if vanishes => continue,
                Some(_) => {
                    let message = "this constraint never holds";
                    return Err(self.refuse(Code::ConstrainsNothing, span, message, "no coordinate is in it"));
                }
                None => effective.push(*row),
            }
            if simplified.as_constant().is_none() && !(moves(simplified) && depends_on_motion(*row)) {
                let help = "it is made of constants, parameters, signals and time alone";
                return Err(self.refuse(Code::ConstrainsNothing, span, "this constrains no coordinate", help));
            }
        }
        self.found.effective_rows.push(are_effective);
        if effective.is_empty() {
            return Err(self.refuse(Code::ConstrainsNothing, span, "this constraint always holds", "leave it out"));
        }
        Ok(effective)
    }

    /// Warns of rows that are of one sign wherever Newton's method leads from random states, and never zero.
    pub(in crate::model) fn warn_of_unsatisfiable_constraints(&mut self) {
        let (mut found, mut are_satisfiable) = (Vec::new(), true);
        for (constraint, place) in self.lagrangian.constraints.iter().zip(&self.found.places.constraints) {
            if constraint.kind != ConstraintKind::Holonomic {
                continue;
            }
            let graph = Graph::new();
            let rows = simplified(&constraint.rows, &graph);
            if let Some(nearest) = rows.into_iter().find_map(|row| never_zero(row, &self.lagrangian)) {
                are_satisfiable = false;
                let side = if nearest > 0.0 { "above" } else { "below" };
                let help =
                    format!("the difference of its sides stays {side} {nearest:.3}: is a sign or a default wrong?");
                let message = format!("no state was found at which the constraint `{}` holds", constraint.name);
                found.push((place.clone(), message, help));
            }
        }
        let (rows, n) = (self.lagrangian.holonomic_rows().len(), self.lagrangian.dof());
        if let Some(place) = self.found.places.constraints.last()
            && are_satisfiable
            && rows >= n
            && !closes(&self.lagrangian)
        {
            let message = format!("no state was found at which all constraints hold: {rows} rows on {n} coordinates");
            found.push((place.clone(), message, "leave some out, or check signs and defaults".to_string()));
        }
        for (place, message, help) in found {
            self.report.warn_at(Code::NeverClosed, &place, message).help(help);
        }
    }

    fn kind_of(&mut self, rows: &[Expr<'g>], span: &Span) -> Resolved<ConstraintKind> {
        let rates = rows.iter().filter(|row| self.known.facts.dependence(**row).on(Dependence::VELOCITY)).count();
        match rates {
            0 if simplified(rows, &Graph::new()).into_iter().any(has_rate_of_signal) => {
                let message = "a constraint on positions cannot hold the rate of a motion that is given at run time";
                let help = "its second derivative would need the third one of that motion: declare the rate as a \
                            `prescribed` signal of its own";
                Err(self.refuse(Code::RateInConstraint, span, message, help))
            }
            0 => Ok(ConstraintKind::Holonomic),
            all if all == rows.len() => Ok(ConstraintKind::Pfaffian),
            _ => {
                let message = "some rows of this constraint are about positions, others about velocities";
                Err(self.refuse(Code::RateInConstraint, span, message, "write two constraints"))
            }
        }
    }
}

/// What vanishes, as one would write it.
fn difference(left: &Expression, right: &Expression) -> String {
    match right.to_string() {
        zero if zero == "0" => left.to_string(),
        right => format!("{left} - ({right})"),
    }
}

/// With the local rules applied and time derivatives carried out.
fn simplified<'g>(rows: &[Expr<'_>], graph: &'g Graph) -> Vec<Expr<'g>> {
    carry_out(rows, graph, |symbol| match symbol {
        Symbol::Time => Some(graph.integer(1)),
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Prescribed(i, 0) => Some(graph.symbol(Symbol::Prescribed(i, 1))),
        _ => None,
    })
}

/// Which rows are zero up to rounding wherever they are finite, at random states and parameters: the vertical velocity
/// of the point where a coin touches the table is the sum of terms that cancel, though no local rule sees it. A row of
/// pieces is zero on all sides of its conditions, too, those that no random state leads to among them.
fn vanishing(rows: &[Expr<'_>], simplified: &[Expr<'_>], lagrangian: &Draft<'_>) -> Vec<bool> {
    let tape = Tape::new(simplified);
    let mut random = Random::new(0x7661_6e69_7368);
    let mut tries = vec![0; rows.len()];
    let mut zeros = vec![0; rows.len()];
    for _ in 0..8 {
        let state = random.state(lagrangian);
        let parameters = random.parameters_near(&default_parameters(lagrangian));
        let values = tape.run(|symbol| Rounded::exact(value(symbol, &state, &parameters)));
        for (row, Rounded { value, error }) in values.into_iter().enumerate().filter(|(_, v)| v.value.is_finite()) {
            tries[row] += 1;
            zeros[row] += usize::from(value.abs() <= 2.0 * error);
        }
    }
    let tape = |row: usize| Tape::new(&simplified[row..=row]);
    // √(x²) is x on one side and −x on the other.
    let pieces = |row: usize| tape(row).has_pieces() || tape(row).has_roots();
    let is_zero = |row: usize| tries[row] > 0 && tries[row] == zeros[row];
    (0..rows.len()).map(|row| is_zero(row) && (!pieces(row) || vanishes(rows[row]) == Verdict::Holds)).collect()
}

/// The value nearest to zero of a row that does not get there from any of some random states, and has one sign at all
/// that are met on the way; `None` where it is zero somewhere, or nothing can be said.
fn never_zero(row: Expr<'_>, lagrangian: &Draft<'_>) -> Option<f64> {
    const STARTS: usize = 16;
    const STEPS: usize = 60;
    let tape = Tape::new(&[row]);
    let coordinates = tape.coordinates();
    let parameters = default_parameters(lagrangian);
    let mut random = Random::new(0x0066_6561_7369_626c);
    let (mut nearest, mut farthest, mut met) = (f64::INFINITY, 0.0f64, 0);
    for _ in 0..STARTS {
        let mut state = random.state(lagrangian);
        for step in 0..STEPS {
            let derivative = |i: usize| {
                let along = |symbol| f64::from(u8::from(symbol == Symbol::Coordinate(i as u32)));
                tape.run(|symbol| Dual::new(value(symbol, &state, &parameters), along(symbol)))[0]
            };
            let row = tape.run(|symbol| value(symbol, &state, &parameters))[0];
            let mut gradient = vec![0.0; state.q.len()];
            coordinates.iter().for_each(|&i| gradient[i] = derivative(i).derivative);
            let square: f64 = gradient.iter().map(|slope| slope * slope).sum();
            if !row.is_finite() || !square.is_finite() {
                break;
            }
            met += 1;
            // Near an extremum Newton's method leaps.
            farthest = if step == 0 { farthest.max(row.abs()) } else { farthest };
            if row.abs() <= 1e-9 * farthest || row * nearest < 0.0 && nearest.is_finite() {
                return None;
            }
            if row.abs() < nearest.abs() {
                nearest = row;
            }
            if square == 0.0 {
                break;
            }
            state.q.iter_mut().zip(&gradient).for_each(|(q, slope)| *q -= slope * row / square);
        }
    }
    (met > STARTS).then_some(nearest)
}

/// Rows depend neither on inputs nor on accelerations.
fn value(symbol: Symbol, state: &State, parameters: &[f64]) -> f64 {
    match symbol {
        Symbol::Time => state.t,
        Symbol::Coordinate(i) => state.q[i as usize],
        Symbol::Velocity(i) => state.qd[i as usize],
        Symbol::Parameter(i) => parameters[i as usize],
        Symbol::Prescribed(i, order) => state.prescribed[i as usize][usize::from(order)],
        Symbol::Input(_) | Symbol::Acceleration(_) | Symbol::Multiplier(_) => f64::NAN,
    }
}

fn moves(row: Expr<'_>) -> bool {
    holds(row, is_of_motion)
}

/// Whether coordinates do not cancel.
fn depends_on_motion(row: Expr<'_>) -> bool {
    degree_is_at_most(0, row, is_of_motion) != Verdict::Holds
}

fn is_of_motion(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Coordinate(_) | Symbol::Velocity(_))
}

fn has_rate_of_signal(row: Expr<'_>) -> bool {
    holds(row, |symbol| matches!(symbol, Symbol::Prescribed(_, 1..)))
}

fn holds(row: Expr<'_>, wanted: impl Fn(Symbol) -> bool) -> bool {
    let graph = row.graph();
    graph.reachable([row.id()]).into_iter().any(|id| matches!(graph.node(id), Node::Symbol(s) if wanted(s)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::check::trial::{mechanism, messages, near, refusals, refused, resolved, values};

    /// Kind and rows at the trial state of the only constraint.
    fn rows(statements: &str) -> (ConstraintKind, Vec<f64>) {
        mechanism(statements, |lagrangian| {
            let constraint = &lagrangian.constraints[0];
            (constraint.kind, values(&constraint.rows))
        })
    }

    fn check(statements: &str, kind: ConstraintKind, expected: &[f64]) {
        let (found, rows) = rows(statements);
        assert_eq!(found, kind, "{statements}");
        near(&rows, expected, statements);
    }

    #[test]
    fn constraints_that_hold_nowhere_earn_a_warning() {
        let warned = |statements: &str| {
            let found = messages(&format!(
                "mechanism A {{ param m: kg = 2; param l: m = 3; coord x: m; coord y: m; coord theta: rad; \
                 kinetic += m*dt(x)^2 + m*dt(y)^2 + m*l^2*dt(theta)^2; {statements} }}"
            ));
            found.into_iter().filter(|message| message.contains("no state was found")).collect::<Vec<_>>()
        };
        let above = "x^2 + l^2 = 0: no state was found at which the constraint `c` holds; the difference of its sides stays above 9.000: is a sign or a default wrong?";
        assert_eq!(warned("constraint c: x^2 + l^2 = 0;"), [above]);
        assert_eq!(warned("constraint c: cos(theta) = 2;").len(), 1);
        assert_eq!(warned("constraint c: [x, -y^2/l - l, 0] = [y, 0, 0];").len(), 1);
        for satisfiable in [
            "constraint c: x^2 + y^2 = (1e7*l)^2;",
            "constraint c: x^2 + y^2 = (l/1e4)^2;",
            "constraint c: sin(theta) = 1;",
            "constraint c: x^2 = 0;",
            "constraint c: sqrt(x/l) = 2;",
            "constraint c: [x, y, 0] = l*[cos(theta), sin(theta), 0];",
            "constraint c: exp(x/l) = 1e4;",
        ] {
            assert_eq!(warned(satisfiable), [""; 0], "{satisfiable}");
        }
    }

    #[test]
    fn rows_and_multipliers_have_units() {
        let check = |statements: &str, expected: &[[&str; 2]]| {
            let found = mechanism(statements, |lagrangian| lagrangian.constraints[0].units.clone());
            assert_eq!(found, expected, "{statements}");
        };
        check("constraint rod: x^2 + y^2 = l^2;", &[["m²", "kg/s²"]]);
        check("constraint both: 0 = [x - l, y];", &[["m", "kg·m/s²"]; 2]);
        check("constraint both: [0, theta] = [x - l, 0];", &[["m", "kg·m/s²"], ["1", "kg·m²/s²"]]);
        check("constraint skate: dt(x)*sin(theta) = dt(y)*cos(theta);", &[["m/s", "kg·m/s²"]]);
        check("let a = rot_z(theta); constraint tip: [x, y, 0] = a.point([l, 0, 0]);", &[["m", "kg·m/s²"]; 2]);
        let plain = "#![dimensionless] mechanism A { coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2; constraint c: x = y; }";
        resolved(plain, |result| assert_eq!(result.unwrap().0.constraints[0].units, [["1", "1"]]));
    }

    #[test]
    fn constraints_of_every_shape() {
        use ConstraintKind::{Holonomic, Pfaffian};
        check("constraint rod: x^2 + y^2 = l^2;", Holonomic, &[0.09 + 0.49 - 9.0]);
        check("constraint rod: l^2 = x^2 + y^2;", Holonomic, &[9.0 - 0.58]);
        check("constraint rod: x^2 + y^2 - l^2 = 0;", Holonomic, &[0.58 - 9.0]);
        check("constraint both: [x, y] = [l, 2*l];", Holonomic, &[-2.7, -6.7]);
        check("constraint both: q = 0;", Holonomic, &[-0.9, 1.3]);
        check("constraint at_rest: [x, y, z] = world.origin();", Holonomic, &[0.3, -0.7, 1.1]);
        check("constraint lift: z = l*sin(t*x/(l*t));", Holonomic, &[1.1 - 3.0 * (0.1f64).sin()]);
        // What vanishes identically constrains nothing.
        let (s, c) = 0.4f64.sin_cos();
        check(
            "let a = rot_z(theta); constraint tip: [x, y, 0] = a.point([l, 0, 0]);",
            Holonomic,
            &[0.3 - 3.0 * c, -0.7 - 3.0 * s],
        );
        check("constraint skate: dt(x)*sin(theta) = dt(y)*cos(theta);", Pfaffian, &[0.5 * s - 0.2 * c]);
        check("constraint roll: dt([x, y, 0]) = l*[dt(theta), 0, 0];", Pfaffian, &[0.5 - 5.1, 0.2]);
        // What vanishes on one side of a condition alone is a row.
        check("constraint c: [x - y, max(z - 50*l, 0), abs(z) + z] = 0;", Holonomic, &[1.0, 0.0, 2.2]);
        check("constraint c: [x - y, sqrt((z - 50*l)^2) + (z - 50*l), 0] = 0;", Holonomic, &[1.0, 0.0]);
        check("constraint c: [if t > 5 s { dt(x) - dt(y) } else { 0 }, dt(x), 0] = 0;", Pfaffian, &[0.0, 0.5]);
        check("constraint c: [theta, abs(theta)*abs(2*theta) - 2*theta^2, 0] = 0;", Holonomic, &[0.4]);
        // Nor does what vanishes for reasons that no local rule sees: the coin's lowest point does not move up.
        let lean = "let lean = rot_x(theta); let coin = translation([x, y, l*cos(theta)])*lean*rot_y(q[0]);";
        let rolling = "constraint rolling: dt(coin.origin()) + angular_velocity(coin).cross(lean*[0, 0, -l]) = 0;";
        check(&format!("{lean} {rolling}"), Pfaffian, &[0.5 + 3.0 * 0.8, 0.2 + 3.0 * c * 1.7]);
        mechanism("/// Of fixed length.\nconstraint rod: x = y;", |lagrangian| {
            assert_eq!(
                (lagrangian.constraints[0].name.as_str(), &*lagrangian.constraints[0].docs[0]),
                ("rod", "Of fixed length.")
            );
        });
    }

    #[test]
    fn prescribed_motions_may_be_constrained_to() {
        mechanism(
            "prescribed heave: m; constraint follow: z = heave; constraint b: dt(x) = dt(heave);",
            |lagrangian| {
                let kinds: Vec<_> = lagrangian.constraints.iter().map(|c| c.kind).collect();
                assert_eq!(kinds, [ConstraintKind::Holonomic, ConstraintKind::Pfaffian]);
            },
        );
    }

    #[test]
    fn wrong_constraints() {
        refused("constraint a: x = m;", "x = m: both sides of a constraint need equal dimensions, these are m and kg");
        refused(
            "constraint a: x = 1;",
            "x = 1: both sides of a constraint need equal dimensions, these are m and a plain number; the second lacks a factor of m",
        );
        refused(
            "constraint a: [x, y, z] = [m, m, m];",
            "[x, y, z] = [m, m, m]: both sides of a constraint need equal dimensions, these are m and kg",
        );
        refused(
            "constraint a: [x, y, z] = l;",
            "[x, y, z] = l: both sides of a constraint are of one shape, these are a vector and a number; or one side is `0`",
        );
        refused("constraint a: x + m = l;", "m: a sum needs equal dimensions, this term is kg, not m");
        refused(
            "constraint a: k*x = u;",
            "k*x = u: a constraint cannot depend on an input; a motion given from outside is a `prescribed` signal: its derivatives are known",
        );
        refused(
            "constraint a: 2*l = l;",
            "2*l = l: this constrains no coordinate; it is made of constants, parameters, signals and time alone",
        );
        refused(
            "prescribed w: m; constraint a: x = l*dt(w)/(l/t);",
            "x = l*dt(w)/(l/t): a constraint on positions cannot hold the rate of a motion that is given at run time; \
             its second derivative would need the third one of that motion: declare the rate as a `prescribed` signal of its own",
        );
        refused("constraint a: 1 = 2;", "1 = 2: this constraint never holds; no coordinate is in it");
        refused("constraint a: x - x = 0;", "x - x = 0: this constraint always holds; leave it out");
        refused(
            "constraint a: [x/l, l*dt(y)/l^2*t] = 0;",
            "[x/l, l*dt(y)/l^2*t] = 0: some rows of this constraint are about positions, others about velocities; write two constraints",
        );
        refused(
            "constraint a: rot_z(theta) = 0;",
            "rot_z(theta): a constraint is made of numbers, this is a pose; constrain its place `pose.origin()`, or angles",
        );
        refused(
            "constraint a: x = y; constraint a: x = z;",
            "a: there is already a constraint `a`; choose another name",
        );
        refused(
            "for i in 0..2 { constraint a: q[i] = 0; }",
            "a: each turn of the loop declares a constraint `a`; give it an index: `constraint a[i]`, which runs from 0",
        );
        refused("constraint a[1]: q[0] = 0;", "a: there is no constraint `a[0]`; indices run from 0 on, without gaps");
        refused(
            "constraint a[0]: x = y; constraint a_0: y = z;",
            "y = z: `a_0` is a constraint of its own and an element of an array; choose another name",
        );
        refused(
            "constraint a: [x, y, z] = l*[1, theta, q[0]]; constraint a_1: theta = q[1];",
            "theta = q[1]: the constraints `a_1` and `a` both have a row called `a_1`; choose another name",
        );
        assert!(refusals("constraint a: dt(dt(x)) = 0;")[0].contains("accelerations cannot enter"));
    }

    #[test]
    fn loops_declare_arrays_of_constraints() {
        let rows = "for i in 0..2 { constraint a[i]: [q[i]*l, [y, z][i]] = [x, theta*l]; } if 1 == 1 { constraint b: dt(theta)*l = dt(x); }";
        mechanism(rows, |lagrangian| {
            let names: Vec<_> = lagrangian.constraints.iter().flat_map(Constraint::row_names).collect();
            assert_eq!(names, ["a_0_0", "a_0_1", "a_1_0", "a_1_1", "b"]);
        });
    }

    #[test]
    fn constraints_are_tried_at_random_states() {
        refused(
            "constraint a: dt(x)^2 = dt(y)^2;",
            "dt(x)^2 = dt(y)^2: a constraint must be linear in the velocities; only `a(q, t)·q̇ + b(q, t) = 0` leads to a constraint force `Aᵀλ`",
        );
        refused(
            "constraint a: x = y; constraint b: 2*y = 2*x;",
            "2*y = 2*x: the constraint `b` follows from the others, or contradicts them; leave it out",
        );
        refused(
            "constraint a: [x, y, z] = 0; constraint b: [theta, q[0], q[1]] = 0; constraint c: x*sin(theta) = l;",
            "x*sin(theta) = l: no state was found at which all constraints hold: 7 rows on 6 coordinates; leave some out, or check \
             signs and defaults",
        );
        assert!(refusals("constraint a: x = y; constraint b: dt(x) = dt(z);").is_empty());
        // The mass matrix need be positive definite on the motions only that constraints leave.
        let quaternion = "coord w[4]: 1; let a = quaternion(w[0], w[1], w[2], w[3]); kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, a);";
        let unit = "constraint unit: w[0]^2 + w[1]^2 + w[2]^2 + w[3]^2 = 1;";
        assert!(refusals(&format!("{quaternion} {unit}")).is_empty());
        assert!(refusals(quaternion)[0].contains("the mass matrix is singular at every state"));
        assert!(refusals("coord s: m; constraint a: s = x + y;").is_empty());
    }
}
