//! `kinetic += …` and its like, and generalized forces.

use crate::diagnostic::{Code, nearest};
use crate::expr::{Expr, Node, Symbol};
use crate::model::names::scope::Origin;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::{Dimension, lacking};
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::model::value::{Shape, Value, shared};
use crate::parse::syntax::{BinaryOperator, EnergyTerm, Expression, ExpressionKind, Name};

impl EnergyTerm {
    /// As messages call it, with its dimension.
    fn described(self) -> (&'static str, &'static str, Dimension) {
        match self {
            EnergyTerm::Kinetic => ("kinetic energy", "an energy", Dimension::ENERGY),
            EnergyTerm::Potential => ("potential energy", "an energy", Dimension::ENERGY),
            EnergyTerm::Dissipation => ("dissipation", "a power", Dimension::POWER),
            EnergyTerm::Lagrangian => ("a term of the Lagrangian", "an energy", Dimension::ENERGY),
        }
    }
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// `kinetic += value;`
    pub(in crate::model) fn energy(&mut self, term: EnergyTerm, expression: &Expression) -> Resolved<()> {
        let value = self.argument_of(Some(term.described().2), expression)?;
        if value.value.shape() == Shape::Vector {
            return Err(self.no_energy_of_a_vector(term, expression));
        }
        let scalar = self.scalar(&value)?;
        let (name, kind, wanted) = term.described();
        let wanted = self.dimension(wanted);
        if shared((wanted, false), scalar.fit()).is_none() {
            let message = format!("{name} must be {kind} ({wanted}), this term is {}", in_words(scalar.dimension));
            let help = self.missing_factor(expression, wanted, scalar.dimension);
            return Err(self.refuse(Code::EnergyDimension, &expression.span, message, help));
        }
        self.check_dependence(term, scalar.expr, expression)?;
        let place = self.report.here(&expression.span);
        let (lagrangian, places) = (&mut self.lagrangian, &mut self.found.places);
        let (terms, places) = match term {
            EnergyTerm::Kinetic => (&mut lagrangian.kinetic, &mut places.kinetic),
            EnergyTerm::Potential => (&mut lagrangian.potential, &mut places.potential),
            EnergyTerm::Dissipation => (&mut lagrangian.dissipation, &mut places.dissipation),
            EnergyTerm::Lagrangian => (&mut lagrangian.lagrangian, &mut places.lagrangian),
        };
        terms.push(scalar.expr);
        places.push(place);
        Ok(())
    }

    /// A value that is to be of this dimension, which tells which terms of it are not.
    fn argument_of(&mut self, wanted: Option<Dimension>, expression: &Expression) -> Resolved<Argument<'g>> {
        self.wanted = wanted;
        let value = self.argument(expression);
        self.wanted = None;
        value
    }

    /// `potential += m*g*bob;`: reported at the vector among the factors, or the first of two terms.
    fn no_energy_of_a_vector(
        &mut self,
        term: EnergyTerm,
        expression: &Expression,
    ) -> crate::model::value::evaluate::Refused {
        let mut place = expression;
        // Each step is a part of the one before; long ones are shown as a whole.
        while let ExpressionKind::Binary(_, left, right) = &place.kind
            && size(place) <= LONGEST_SUGGESTION
        {
            let is_vector = |value: Resolved<Argument<'g>>| value.is_ok_and(|v| v.value.shape() == Shape::Vector);
            place = if is_vector(self.argument(left)) { left } else { right };
        }
        let text = if size(place) <= LONGEST_SUGGESTION { written(place, 5) } else { "v".to_string() };
        let help = match term {
            EnergyTerm::Potential => format!("its height is a number: `{text}.z`"),
            _ => format!("its square is a number: `{text}.norm_squared()`"),
        };
        let message = format!("{} is a number, this is a vector", term.described().0);
        self.refuse(Code::EnergyShape, &place.span, message, help)
    }

    /// The momenta `∂L/∂q̇` are differentiated in time: what enters L must have a known rate.
    fn check_dependence(&mut self, term: EnergyTerm, expr: Expr<'g>, expression: &Expression) -> Resolved<()> {
        let dependence = self.known.facts.dependence(expr);
        if dependence.on(Dependence::INPUT) && term != EnergyTerm::Dissipation {
            let help = "inputs act through forces: `force q += u;`";
            return Err(self.refuse(
                Code::InputInEnergy,
                &expression.span,
                "an energy cannot depend on an input",
                help,
            ));
        }
        if dependence.on(Dependence::VELOCITY) && term == EnergyTerm::Potential {
            let help = "a velocity-dependent potential U is a term of the Lagrangian: `lagrangian += -U;`";
            return Err(self.refuse(
                Code::VelocityInPotential,
                &expression.span,
                "potential energy cannot depend on velocities",
                help,
            ));
        }
        Ok(())
    }
}

// ---- what is missing

/// Longer terms are not written out again in a suggestion.
const LONGEST_SUGGESTION: usize = 60;

impl<'d, 'g> Resolver<'d, 'g> {
    fn missing_factor(&mut self, term: &Expression, wanted: Dimension, found: Dimension) -> String {
        let Some(missing) = wanted.over(found) else { return String::new() };
        let is_decimal = |part: &Expression| matches!(&part.kind, ExpressionKind::Number(text) if text.contains('.'));
        match self.squared_speed(term, missing) {
            Some(meant) => format!("a speed enters squared: did you mean `{meant}`?"),
            None if term.parts().any(is_decimal) => {
                let unit = missing.in_ascii();
                format!(
                    "{}; numbers have no units of their own: declare it, `const name: {unit} = …;`",
                    lacking(wanted, found)
                )
            }
            None => lacking(wanted, found),
        }
    }

    /// The term with its last factors squared, where they are a speed of the dimension that is missing.
    fn squared_speed(&mut self, term: &Expression, missing: Dimension) -> Option<String> {
        if size(term) > LONGEST_SUGGESTION {
            return None;
        }
        let (first, steps) = term.left_spine();
        if steps.iter().any(|(op, _)| matches!(op, BinaryOperator::Add | BinaryOperator::Sub | BinaryOperator::Pow)) {
            return None;
        }
        let mut product = Dimension::ONE;
        let mut speed = false;
        for k in (0..=steps.len()).rev() {
            let (operator, factor) = if k == 0 { (BinaryOperator::Mul, first) } else { steps[k - 1] };
            let value = self.argument(factor).ok()?;
            let scalar = self.scalar(&value).ok()?;
            if operator != BinaryOperator::Mul {
                return None;
            }
            product = product.times(scalar.dimension)?;
            speed |= self.known.facts.dependence(scalar.expr).on(Dependence::RATE);
            if speed && product == missing {
                return Some(with_square(first, &steps, k));
            }
        }
        None
    }
}

/// The product with its factors from number k on squared as one.
fn with_square(first: &Expression, steps: &[(BinaryOperator, &Expression)], k: usize) -> String {
    let mut text = String::new();
    let single = k == steps.len();
    for at in 0..=steps.len() {
        let (operator, factor) = if at == 0 { ("", first) } else { (sign(steps[at - 1].0), steps[at - 1].1) };
        text += operator;
        if at == k && !single {
            text.push('(');
        }
        text += &written(factor, if single && at == k { 4 } else { 2 });
    }
    text + if single { "^2" } else { ")^2" }
}

fn sign(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => " + ",
        BinaryOperator::Sub => " - ",
        BinaryOperator::Mul => " * ",
        BinaryOperator::Div => "/",
        BinaryOperator::Pow => "^",
    }
}

fn binding(operator: BinaryOperator) -> u8 {
    match operator {
        BinaryOperator::Add | BinaryOperator::Sub => 0,
        BinaryOperator::Mul | BinaryOperator::Div => 1,
        BinaryOperator::Pow => 3,
    }
}

/// The expression as one would write it, in brackets unless it binds at least so tightly.
fn written(expression: &Expression, least: u8) -> String {
    let list = |values: &[Expression]| values.iter().map(|v| written(v, 0)).collect::<Vec<_>>().join(", ");
    let (tight, text) = match &expression.kind {
        ExpressionKind::Number(text) | ExpressionKind::Name(text) => (5, text.clone()),
        ExpressionKind::Quantity(text, unit) => (0, format!("{text} {unit}")),
        ExpressionKind::Negate(a) => (2, format!("-{}", written(a, 2))),
        ExpressionKind::Binary(operator, a, b) => {
            let tight = binding(*operator);
            let (left, right) = if *operator == BinaryOperator::Pow { (4, 3) } else { (tight, tight + 1) };
            (tight, format!("{}{}{}", written(a, left), sign(*operator), written(b, right)))
        }
        ExpressionKind::Call(name, arguments) => (5, format!("{}({})", name.text, list(arguments))),
        ExpressionKind::Method(a, name, arguments) => {
            (5, format!("{}.{}({})", written(a, 5), name.text, list(arguments)))
        }
        ExpressionKind::Field(a, name) => (5, format!("{}.{}", written(a, 5), name.text)),
        ExpressionKind::Index(a, index) => (5, format!("{}[{}]", written(a, 5), written(index, 0))),
        ExpressionKind::Array(values) => (5, format!("[{}]", list(values))),
        ExpressionKind::If(..)
        | ExpressionKind::Compare(..)
        | ExpressionKind::And(..)
        | ExpressionKind::Or(..)
        | ExpressionKind::Not(_) => (0, expression.to_string()),
    };
    if tight < least { format!("({text})") } else { text }
}

/// How many parts an expression has.
fn size(expression: &Expression) -> usize {
    expression.parts().count()
}

// ---- forces

impl<'d, 'g> Resolver<'d, 'g> {
    /// `force q[i] += value;`; without an index on an array, one force for each of its components.
    pub(in crate::model) fn force(
        &mut self,
        name: &Name,
        index: Option<&Expression>,
        value: &Expression,
    ) -> Resolved<()> {
        let targets = self.targets(name, index);
        let energy = self.dimension(Dimension::ENERGY);
        let wanted = targets.as_ref().ok().and_then(|targets| energy.over(targets.first()?.dimension));
        let value = self.argument_of(wanted, value)?;
        let targets = targets?;
        if index.is_some() || targets.len() == 1 && value.value.shape() == Shape::Number {
            return targets.first().map_or(Ok(()), |target| self.force_on(target, &value));
        }
        let values = self.elements(&value)?;
        if values.len() != targets.len() {
            let message =
                format!("`{}` has {} components, this is {}", name.text, targets.len(), value.value.described());
            return Err(self.refuse(
                Code::ForceShape,
                &value.span,
                message,
                format!("write `force {}[i] += …;` for one component", name.text),
            ));
        }
        let pairs = targets.iter().zip(values);
        pairs
            .map(|(target, value_of)| (target, Argument { value: value_of, span: value.span.clone() }))
            .try_for_each(|(target, value)| self.force_on(target, &value))
    }

    fn force_on(&mut self, target: &Target, value: &Argument<'g>) -> Resolved<()> {
        let energy = self.dimension(Dimension::ENERGY);
        let wanted = self.bounded(energy.over(target.dimension), &value.span)?;
        let scalar = self.scalar(value)?;
        if shared((wanted, false), scalar.fit()).is_none() {
            let message =
                format!("the force on `{}` must be {wanted}, this is {}", target.name, in_words(scalar.dimension));
            let lacking = lacking(wanted, scalar.dimension);
            let help = match target.dimension {
                Dimension::ONE => format!("{lacking}; a force on an angle is a torque, in N*m"),
                _ => lacking,
            };
            return Err(self.refuse(Code::ForceDimension, &value.span, message, help));
        }
        let force = scalar.expr;
        self.lagrangian.forces.push((target.number, force));
        let place = self.report.here(&value.span);
        self.found.places.forces.push(place);
        Ok(())
    }

    /// The components of a coordinate that a force acts on.
    fn targets(&mut self, name: &Name, index: Option<&Expression>) -> Resolved<Vec<Target>> {
        let index = index.map(|index| self.argument(index));
        let coordinates =
            || self.names.scope.names().filter(|(_, b)| matches!(b.origin, Origin::Coordinate(_))).map(|(n, _)| n);
        let Some(binding) = self.names.scope.get(&name.text) else {
            let help = match nearest(&name.text, coordinates()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => match coordinates().take(8).map(|name| format!("`{name}`")).collect::<Vec<_>>() {
                    names if names.is_empty() => "declare it: `coord theta: rad;`".to_string(),
                    names => format!("the coordinates are {}", names.join(", ")),
                },
            };
            return Err(self.refuse(
                Code::ForceTarget,
                &name.span,
                format!("there is no coordinate `{}`", name.text),
                help,
            ));
        };
        // A part is given coordinates as arguments.
        if !matches!(binding.origin, Origin::Coordinate(_) | Origin::Argument) {
            let message = format!("`{}` is {}, not a coordinate", name.text, binding.origin.described());
            let help = match coordinates().next() {
                Some(coordinate) => format!("a force acts on a coordinate: `force {coordinate} += …;`"),
                None => "a force acts on a coordinate".to_string(),
            };
            return Err(self.refuse(Code::ForceTarget, &name.span, message, help));
        }
        let value = binding.value.clone().ok_or(crate::model::value::evaluate::Refused)?;
        let array = Argument { value, span: name.span.clone() };
        let components = match &array.value {
            Value::Scalar(_) => vec![array.value.clone()],
            _ => self.elements(&array)?,
        };
        let range = match (index, &array.value) {
            (None, _) => 0..components.len(),
            (Some(index), Value::Scalar(_)) => {
                let message = format!("`{}` is one coordinate, it has no index", name.text);
                return Err(self.refuse(Code::ForceTarget, &index?.span, message, "leave the index out"));
            }
            (Some(index), _) => {
                let number = self.index(&index?, components.len())?;
                number..number + 1
            }
        };
        let single = components.len() == 1 && matches!(array.value, Value::Scalar(_));
        range
            .map(|i| {
                let coordinate = self.scalar(&Argument { value: components[i].clone(), span: name.span.clone() })?;
                let Node::Symbol(Symbol::Coordinate(number)) = coordinate.expr.node() else {
                    let message = format!("`{}` is no coordinate here", name.text);
                    let help = "a force acts on a coordinate: give the part one, or write `force at` and `torque on`";
                    return Err(self.refuse(Code::ForceTarget, &name.span, message, help));
                };
                let name = if single { name.text.clone() } else { format!("{}[{i}]", name.text) };
                Ok(Target { number: number as usize, name, dimension: coordinate.dimension })
            })
            .collect()
    }
}

/// One component of a coordinate.
struct Target {
    number: usize,
    name: String,
    dimension: Dimension,
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, near, refusals, refused, values};

    #[test]
    fn energies_must_be_energies() {
        let energy = |term: &str, message: &str, help: &str| {
            refused(
                &format!("kinetic += {term};"),
                &format!("{term}: kinetic energy must be an energy (kg·m²/s²), this term is {message}; {help}"),
            );
        };
        let meant = |meant: &str| format!("a speed enters squared: did you mean `{meant}`?");
        energy("1/2 * m * l * dt(theta)", "kg·m/s", &meant("1/2 * m * (l * dt(theta))^2"));
        energy("1/2*m*dt(x)", "kg·m/s", &meant("1/2 * m * dt(x)^2"));
        energy("m*(x + l)*dt(theta)", "kg·m/s", &meant("m * ((x + l) * dt(theta))^2"));
        energy("m*l", "kg·m", "it lacks a factor of m/s²");
        energy("m*l*dt(theta)^2", "kg·m/s²", "it lacks a factor of m");
        energy("dt(x)", "m/s", "it lacks a factor of kg·m/s");
        energy("3", "a plain number", "it lacks a factor of kg·m²/s²");
        refused(
            "potential += m*l;",
            "m*l: potential energy must be an energy (kg·m²/s²), this term is kg·m; it lacks a factor of m/s²",
        );
        refused(
            "dissipation += k*dt(x);",
            "k*dt(x): dissipation must be a power (kg·m²/s³), this term is kg·m/s³; it lacks a factor of m",
        );
        refused(
            "lagrangian += m;",
            "m: a term of the Lagrangian must be an energy (kg·m²/s²), this term is kg; it lacks a factor of m²/s²",
        );
        refused(
            "kinetic += m*dt([x, y, z]);",
            "dt([x, y, z]): kinetic energy is a number, this is a vector; its square is a number: `dt([x, y, z]).norm_squared()`",
        );
    }

    #[test]
    fn energies_depend_on_what_they_may() {
        refused(
            "potential += u*x;",
            "u*x: an energy cannot depend on an input; inputs act through forces: `force q += u;`",
        );
        refused(
            "potential += m*x/t*dt(y);",
            "m*x/t*dt(y): potential energy cannot depend on velocities; a velocity-dependent potential U is a term of the Lagrangian: `lagrangian += -U;`",
        );
        assert!(
            refusals("dissipation += u*dt(x)^2/(2*dt(t)*l)*t; lagrangian += m*x/t*dt(y); potential += k*x*dt(t*l);")
                .is_empty()
        );
    }

    #[test]
    fn forces_act_on_coordinates() {
        mechanism(
            "force theta += u*l; force q[1] += 2*u*l; force q += [u*l, 0]; force x += u; force x += 0;",
            |lagrangian| {
                let numbers: Vec<usize> = lagrangian.forces.iter().map(|f| f.0).collect();
                assert_eq!(numbers, [0, 3, 5, 4, 5, 0, 0]);
                let forces: Vec<_> = lagrangian.forces.iter().map(|f| f.1).collect();
                near(&values(&forces), &[1.5, 4.5, 9.0, 4.5, 0.0, 1.5, 0.0], "forces");
            },
        );
        refused("force thetta += u*l;", "thetta: there is no coordinate `thetta`; did you mean `theta`?");
        refused(
            "force m += u;",
            "m: `m` is a parameter, not a coordinate; a force acts on a coordinate: `force q += …;`",
        );
        refused(
            "force theta += u;",
            "u: the force on `theta` must be kg·m²/s², this is kg·m/s²; it lacks a factor of m; a force on an angle is a torque, in N*m",
        );
        refused(
            "force q[1] += u;",
            "u: the force on `q[1]` must be kg·m²/s², this is kg·m/s²; it lacks a factor of m; a force on an angle is a torque, in N*m",
        );
        refused("force q[2] += u*l;", "2: the index 2 is out of range: there are 2 elements; indices run from 0 to 1");
        refused("force x[0] += u;", "0: `x` is one coordinate, it has no index; leave the index out");
        refused(
            "force q += u*l;",
            "u*l: a number has no elements; arrays are declared with their length: `param mass[6]: kg = 1;`",
        );
        refused(
            "force q += [0, 0, 0];",
            "[0, 0, 0]: `q` has 2 components, this is a vector; write `force q[i] += …;` for one component",
        );
    }
}
