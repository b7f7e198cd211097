//! Sums, products, quotients and powers.

use super::super::syntax::Kind;
use super::{Evaluator, Expression, Moving, Real, Value, number};

impl<S: Real> Evaluator<'_, S> {
    pub(super) fn binary(&mut self, operator: &str, left: &Expression, right: &Expression) -> Result<Value<S>, String> {
        if operator == "^" {
            return Ok(Value::Number(self.power(left, right)?));
        }
        let (a, b) = (self.value(left)?, self.value(right)?);
        match operator {
            "+" => a.plus(&b, 1.0),
            "-" => a.plus(&b, -1.0),
            "*" => a.times(&b),
            "/" => {
                let divisor = b.number()?;
                a.each(&|x| x / divisor)
            }
            "&&" => Ok(Value::Truth(a.truth()? & b.truth()?)),
            "||" => Ok(Value::Truth(a.truth()? | b.truth()?)),
            _ => {
                let (a, b) = (a.number()?, b.number()?);
                Ok(Value::Truth(match operator {
                    "<" => a.less(b),
                    "<=" => a.less_equal(b),
                    ">" => b.less(a),
                    ">=" => b.less_equal(a),
                    "==" => a.value() == b.value(),
                    "!=" => a.value() != b.value(),
                    _ => return Err(format!("no operator {operator}")),
                }))
            }
        }
    }

    /// Integers and halves multiply and take roots, which every base bears; other exponents want a positive one.
    fn power(&mut self, base: &Expression, exponent: &Expression) -> Result<Moving<S>, String> {
        let exponent = self.number(exponent)?;
        let halves = 2.0 * exponent.value();
        let moves = !(exponent - number(exponent.value())).is_zero();
        let even = !moves && halves % 4.0 == 0.0;
        let base = self.number(if even { without_sign(base) } else { base })?;
        if moves || (halves - halves.round()).abs() > 1e-12 || halves.abs() > 200.0 {
            return Ok(base.powf(exponent));
        }
        let halves = halves.round() as i64;
        Ok(if halves % 2 == 0 { base.powi(halves / 2) } else { base.sqrt().powi(halves) })
    }
}

/// What an even power asks of its base: `|x|² = x²`, which has all derivatives at x = 0, where those of `|x|` do not
/// exist.
fn without_sign(mut base: &Expression) -> &Expression {
    loop {
        base = match &base.kind {
            Kind::Unary('-', inner) => inner,
            Kind::Call(name, arguments) if &**name == "abs" => match arguments.as_slice() {
                [inner] => inner,
                _ => return base,
            },
            _ => return base,
        };
    }
}
