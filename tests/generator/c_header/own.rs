//! Doubles with the sines and cosines that the header has.

use mbs_derive::expr::{Binary, Function, Value};
use mbs_runtime::Scalar;

/// `f64`, but for [`Scalar::sin_cos_all`] in the place of the library's sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Own(pub(super) f64);

impl Value for Own {
    fn constant(value: f64) -> Own {
        Own(value)
    }
    fn neg(self) -> Own {
        Own(-self.0)
    }
    fn add(self, other: Own) -> Own {
        Own(self.0 + other.0)
    }
    fn sub(self, other: Own) -> Own {
        Own(self.0 - other.0)
    }
    fn mul(self, other: Own) -> Own {
        Own(self.0 * other.0)
    }
    fn div(self, other: Own) -> Own {
        Own(self.0 / other.0)
    }
    fn power(self, halves: i32) -> Own {
        Own(Value::power(self.0, halves))
    }
    fn call(self, function: Function) -> Own {
        let ([sine], [cosine]) = f64::sin_cos_all([self.0]);
        Own(match function {
            Function::Sin => sine,
            Function::Cos => cosine,
            other => other.value(self.0),
        })
    }
    fn call2(self, function: Binary, other: Own) -> Own {
        Own(function.value(self.0, other.0))
    }
    fn rate(self) -> Own {
        Own(f64::NAN)
    }
    fn less(self, other: Own) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Own) -> bool {
        self.0 <= other.0
    }
    fn exponent(self) -> i32 {
        Value::exponent(self.0)
    }
}
