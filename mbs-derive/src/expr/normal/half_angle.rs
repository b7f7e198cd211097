//! Multiple angles as polynomials of sines and cosines: as they are, or with even ones halved.
//!
//! Mechanics texts write `cos(θ1 − θ2)` where angles are combined, but `sin²θ` and `sin θ cos θ` where one is doubled.

use crate::expr::{Graph, Node, Number};

use super::combination::{Combination, Polynomial, Powers, product_of_powers};
use super::wave::{self, Angle, Wave};
use super::{Sum, Term};

/// What becomes of the cosine of a doubled angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubled {
    /// `cos 2x`, `sin 2x`
    Kept,
    /// `1 + cos 2x = 2 cos²x` and `1 − cos 2x = 2 sin²x` where the 1 is there, else `cos 2x = 1 − 2 sin²x`.
    Matched,
    /// `1 − 2 sin²x`
    Sine,
    /// `2 cos²x − 1`
    Cosine,
}

impl Doubled {
    /// All ways; first that of most texts.
    pub const ALL: [Doubled; 4] = [Doubled::Matched, Doubled::Kept, Doubled::Sine, Doubled::Cosine];
}

/// A sum of waves as a polynomial, in which sines and cosines are indivisible; `None` where a power is too high.
pub fn polynomial(graph: &Graph, sum: &Sum, doubled: Doubled) -> Option<Polynomial> {
    let mut rest = sum.clone();
    let mut polynomial = Polynomial::default();
    for term in sum.0.keys() {
        let coefficient = rest.coefficient(term);
        rest.add(term.clone(), -coefficient);
        let (factor, wave) = match halved(term, doubled) {
            None => (Number::ONE, power_of_wave(graph, &term.wave, 2)?),
            Some(Halved::Sine(half)) => {
                let [sine, cosine] = [Wave::Sin(half.clone()), Wave::Cos(half)];
                (Number::integer(2), power_of_wave(graph, &sine, 2)?.times(&power_of_wave(graph, &cosine, 2)?, 1)?)
            }
            // c cos 2x = c − 2 c sin²x = 2 c cos²x − c
            Some(Halved::Cosine(half)) => {
                let one = Term { powers: term.powers.clone(), wave: Wave::One };
                let is_matched = doubled == Doubled::Matched && rest.coefficient(&one) == coefficient;
                let by_cosine = is_matched || doubled == Doubled::Cosine;
                let (sign, wave) =
                    if by_cosine { (-Number::ONE, Wave::Cos(half)) } else { (Number::ONE, Wave::Sin(half)) };
                rest.add(one, sign * coefficient);
                (Number::integer(-2) * sign, power_of_wave(graph, &wave, 4)?)
            }
        };
        for (powers, &number) in &wave.0 {
            polynomial.add(product_of_powers(&term.powers, powers)?, coefficient * factor * number);
        }
    }
    rest.0.into_iter().for_each(|(term, coefficient)| polynomial.add(term.powers, coefficient));
    Some(polynomial)
}

enum Halved {
    Sine(Angle),
    Cosine(Angle),
}

fn halved(term: &Term, doubled: Doubled) -> Option<Halved> {
    match &term.wave {
        _ if doubled == Doubled::Kept => None,
        Wave::One => None,
        Wave::Sin(angle) => wave::half(angle).map(Halved::Sine),
        Wave::Cos(angle) => wave::half(angle).map(Halved::Cosine),
    }
}

/// A power, in halves, of a wave as an indivisible expression; its sign is that of the graph's own form of the angle.
fn power_of_wave(graph: &Graph, wave: &Wave, halves: i32) -> Option<Polynomial> {
    let expr = wave.expression(graph);
    let (id, negative) = match expr.node() {
        Node::Neg(a) => (a, halves == 2),
        _ => (expr.id(), false),
    };
    let sign = if negative { -Number::ONE } else { Number::ONE };
    match graph.expr(id).as_constant() {
        Some(value) => Some(Combination::term(Powers::new(), sign * value.power(halves)?)),
        None => Some(Combination::term([(id, halves)].into(), sign)),
    }
}
