//! Sines and cosines of sums of angles, and their products as sums.

use crate::expr::{Expr, Graph, Number};

use super::powers::Powers;

/// An angle: integer multiples of indivisible expressions, the first of them positive.
pub(crate) type Angle = Powers;

/// What a product of powers is multiplied with.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Wave {
    /// 1
    One,
    /// Its cosine.
    Cos(Angle),
    /// Its sine.
    Sin(Angle),
}

impl Wave {
    /// `cos a cos b = ½ (cos(a − b) + cos(a + b))` and its like.
    pub(crate) fn times(&self, other: &Wave) -> Vec<(Number, Wave)> {
        let half = Number::rational(1, 2).unwrap_or(Number::ONE);
        let (plus, minus) = (Number::ONE, -Number::ONE);
        let [(x, cos_x), (y, cos_y)] = match [self, other].map(|wave| match wave {
            Wave::One => None,
            Wave::Cos(angle) => Some((angle, true)),
            Wave::Sin(angle) => Some((angle, false)),
        }) {
            [Some(x), Some(y)] => [x, y],
            [None, _] => return vec![(plus, other.clone())],
            [_, None] => return vec![(plus, self.clone())],
        };
        let (sum, difference) = (x.plus(y, 1), x.plus(y, -1));
        let signed = match (cos_x, cos_y) {
            (true, true) => [(plus, cosine(difference)), (plus, cosine(sum))],
            (false, false) => [(plus, cosine(difference)), (minus, cosine(sum))],
            (false, true) => [(plus, sine(sum)), (plus, sine(difference))],
            (true, false) => [(plus, sine(sum)), (minus, sine(difference))],
        };
        let scaled = signed.into_iter().map(|(sign, (factor, wave))| (half * sign * factor, wave));
        scaled.filter(|(factor, _)| !factor.is_zero()).collect()
    }

    /// As an expression; its sign may be that of the reversed angle.
    pub(crate) fn expression<'g>(&self, graph: &'g Graph) -> Expr<'g> {
        match self {
            Wave::One => graph.integer(1),
            Wave::Cos(angle) => expression(angle, graph).cos(),
            Wave::Sin(angle) => expression(angle, graph).sin(),
        }
    }
}

/// An angle as an expression.
pub(crate) fn expression<'g>(angle: &Angle, graph: &'g Graph) -> Expr<'g> {
    angle.iter().fold(graph.integer(0), |sum, (&id, &n)| sum + i64::from(n) * graph.expr(id))
}

/// Half of an angle that is twice a sum of whole multiples.
pub(crate) fn half(angle: &Angle) -> Option<Angle> {
    angle.iter().map(|(&id, &n)| (n % 2 == 0).then_some((id, n / 2))).collect()
}

/// `cos` of an angle: even, and 1 at 0.
pub(crate) fn cosine(angle: Angle) -> (Number, Wave) {
    match leading(&angle) {
        0 => (Number::ONE, Wave::One),
        n if n < 0 => (Number::ONE, Wave::Cos(negative(angle))),
        _ => (Number::ONE, Wave::Cos(angle)),
    }
}

/// `sin` of an angle: odd, and 0 at 0.
pub(crate) fn sine(angle: Angle) -> (Number, Wave) {
    match leading(&angle) {
        0 => (Number::ZERO, Wave::One),
        n if n < 0 => (-Number::ONE, Wave::Sin(negative(angle))),
        _ => (Number::ONE, Wave::Sin(angle)),
    }
}

fn leading(angle: &Angle) -> i32 {
    angle.first_key_value().map_or(0, |(_, &n)| n)
}

fn negative(angle: Angle) -> Angle {
    angle.into_iter().map(|(id, n)| (id, -n)).collect()
}
