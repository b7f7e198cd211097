//! Axes of parameters, and arrays given for several arguments.

use crate::diagnostic::Code;
use crate::expr::{Expr, Graph, Symbol, Vector, carry_out, evaluate};
use crate::model::check::sample::default_parameters;
use crate::model::frame::FrameId;
use crate::model::value::builtin::Call;
use crate::model::value::constant::Dependence;
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::{Shape, Value};
use crate::parse::syntax::Span;

impl<'g> Resolver<'_, 'g> {
    /// The unit vector along an axis of parameters, `v/|v|`; `None` where it is made of numbers, or no axis at all.
    pub(in crate::model) fn axis_of_parameters(&mut self, axis: &Argument<'g>) -> Resolved<Option<Vector<'g>>> {
        let vector = self.vector(axis)?;
        let all = vector.components.0.map(|e| self.known.facts.dependence(e)).into_iter();
        let all = all.fold(Dependence::default(), Dependence::or);
        if vector.frame != FrameId::WORLD || !all.on(Dependence::PARAMETER) || all.moves() || all.on(Dependence::RATE) {
            return Ok(None);
        }
        let squared = vector.components.norm_squared();
        let length = self.at_defaults(squared);
        if length.is_nan() || length <= 0.0 {
            let message = "an axis must have a direction, by the default values of the parameters this is zero";
            return Err(self.refuse(
                Code::AxisWithoutDirection,
                &axis.span,
                message,
                "choose another default, such as `[0, 0, 1]`",
            ));
        }
        Ok(Some(vector.components.scale(1 / squared.sqrt())))
    }

    /// A quaternion as a rotation, that is, of length 1: numbers are given to some digits and divided by their length;
    /// parameters have it by their defaults; of what moves it is the user's to keep.
    pub(in crate::model) fn unit_quaternion(&mut self, parts: [Expr<'g>; 4], span: &Span) -> Resolved<[Expr<'g>; 4]> {
        let all = parts.map(|e| self.known.facts.dependence(e)).into_iter().fold(Dependence::default(), Dependence::or);
        if all.moves() || all.on(Dependence::RATE) {
            return Ok(parts);
        }
        let (by_defaults, tolerance) = match all.on(Dependence::PARAMETER) {
            true => (", by the default values of the parameters", 1e-9),
            false => (",", 1e-6),
        };
        let square = parts.into_iter().map(|e| e.powi(2)).fold(self.graph.integer(0), |a, b| a + b);
        let length = self.at_defaults(square).sqrt();
        // Of what is no number the energies are not finite, which is said elsewhere.
        if (length - 1.0).abs() > tolerance {
            let message = format!("a rotation is a quaternion of length 1{by_defaults} this has length {length}");
            let help = "divide its components by its length";
            return Err(self.refuse(Code::QuaternionLength, span, message, help));
        }
        let inverse = self.known.facts.constant(square).filter(|square| square.to_f64() != 1.0);
        let Some(inverse) = inverse.and_then(|square| square.power(-1)) else { return Ok(parts) };
        Ok(parts.map(|e| self.known.facts.constant(e).map_or(e, |n| self.graph.constant(n * inverse))))
    }

    /// What an expression of parameters is at their defaults.
    fn at_defaults(&self, expr: Expr<'g>) -> f64 {
        let (graph, defaults) = (Graph::new(), default_parameters(&self.lagrangian));
        let value = |symbol| match symbol {
            Symbol::Parameter(i) => defaults.get(i as usize).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        evaluate(&carry_out(&[expr], &graph, |_| None), value)[0]
    }

    /// The numbers of the one array that is given for several arguments; `None` where they are given one by one.
    pub(in crate::model) fn spread(
        &mut self,
        call: &Call<'_, 'g>,
        count: usize,
        message: &str,
    ) -> Resolved<Option<Vec<Argument<'g>>>> {
        let [whole] = call.arguments else { return Ok(None) };
        let numbers = self.numbers_given(whole).filter(|numbers| numbers.len() == count);
        match numbers {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.refuse(
                Code::InertiaForm,
                &whole.span,
                message,
                format!("this is {}", whole.value.described()),
            )),
        }
    }

    /// As [`spread`](Self::spread), of three moments or six entries.
    pub(in crate::model) fn spread_inertia(&mut self, call: &Call<'_, 'g>) -> Resolved<Option<Vec<Argument<'g>>>> {
        let [whole] = call.arguments else { return Ok(None) };
        match self.numbers_given(whole).filter(|numbers| [3, 6].contains(&numbers.len())) {
            Some(numbers) => Ok(Some(numbers)),
            None => {
                let message = "an inertia is an array of 3 or 6 numbers, or a matrix";
                Err(self.refuse(
                    Code::InertiaForm,
                    &whole.span,
                    message,
                    format!("this is {}", whole.value.described()),
                ))
            }
        }
    }

    /// The elements of an array of numbers or a vector.
    fn numbers_given(&mut self, whole: &Argument<'g>) -> Option<Vec<Argument<'g>>> {
        if matches!(whole.value, Value::Scalar(_) | Value::Pose(_) | Value::Part(_)) {
            return None;
        }
        let elements = self.elements(whole).ok()?;
        let numbers = elements.iter().all(|element| element.shape() == Shape::Number);
        numbers.then(|| elements.into_iter().map(|value| Argument { value, span: whole.span.clone() }).collect())
    }
}
