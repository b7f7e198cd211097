//! Doubled angles halved: `sin²θ` for `½ (1 − cos 2θ)`, `sin θ cos θ` for `½ sin 2θ`.
//!
//! Mechanics texts write `cos(θ1 − θ2)` where angles are combined, but powers of `sin θ` and `cos θ` where one is
//! doubled.

use std::collections::BTreeMap;

use crate::expr::{Function, Id, Number};
use crate::mistake::rule;

use super::combination::{Polynomial, product_of_powers};

/// What becomes of the cosine of a doubled angle.
///
/// Where all that it is multiplied with stands beside it, `k + k cos 2x = 2 k cos²x` and `k − k cos 2x = 2 k sin²x`
/// whatever the way: near their zeros the sums have lost the digits that the squares have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Doubled {
    /// `1 + cos 2x = 2 cos²x` and `1 − cos 2x = 2 sin²x`, where the 1 is there.
    Matched,
    /// `1 − 2 sin²x`
    Sine,
    /// `2 cos²x − 1`
    Cosine,
    /// Nothing, nor of the sine.
    Kept,
}

impl Doubled {
    /// All ways; first that of most texts, last that which needs another sine and cosine where the single angle's are
    /// there.
    pub(crate) const ALL: [Doubled; 4] = [Doubled::Matched, Doubled::Sine, Doubled::Cosine, Doubled::Kept];
}

/// The sine or cosine of a doubled angle.
#[derive(Clone, Debug)]
pub(crate) struct Double {
    /// Which of them.
    pub function: Function,
    /// The sine of the angle that is doubled.
    pub sine: Polynomial,
    /// Its cosine.
    pub cosine: Polynomial,
    /// Whether the single angle is a double one as well: then it is halved only where the 1 is there.
    pub is_fourfold: bool,
}

/// The polynomial with doubled angles halved, given which indivisible expressions have one; `None` beyond `limit`
/// terms.
pub(crate) fn halved(
    polynomial: &Polynomial,
    doubled: Doubled,
    limit: usize,
    mut double: impl FnMut(Id) -> Option<Double>,
) -> Option<Polynomial> {
    let mut result = polynomial.clone();
    // Per cosine the sign of the 1 beside it, if that is the same in all products.
    let mut ones: BTreeMap<Id, Option<bool>> = BTreeMap::new();
    for (powers, &coefficient) in &polynomial.0 {
        for (&id, _) in powers.iter().filter(|(_, halves)| **halves == 2) {
            let one = polynomial.coefficient(&product_of_powers(powers, &[(id, -2)].into())?);
            let sign = if one == coefficient { Some(true) } else { (one == -coefficient).then_some(false) };
            ones.entry(id).and_modify(|known| *known = known.filter(|_| *known == sign)).or_insert(sign);
        }
    }
    for powers in polynomial.0.keys() {
        for (&id, _) in powers.iter().filter(|(_, halves)| **halves == 2) {
            let coefficient = result.coefficient(powers);
            let Some(found) = double(id).filter(|_| !coefficient.is_zero()) else { continue };
            let Double { function, sine, cosine, is_fourfold } = found;
            let rest = product_of_powers(powers, &[(id, -2)].into())?;
            let one = result.coefficient(&rest);
            let is_matched = doubled == Doubled::Matched || ones[&id].is_some();
            // c sin 2x = 2 c sin x cos x, c cos 2x = c − 2 c sin²x = 2 c cos²x − c
            let (constant, wave) = match (function, doubled) {
                (Function::Cos, _) if is_matched && one == coefficient => (-coefficient, cosine.times(&cosine, limit)?),
                (Function::Cos, _) if is_matched && one == -coefficient => {
                    (coefficient, sine.times(&sine, limit)?.negative())
                }
                _ if is_fourfold || doubled == Doubled::Kept => continue,
                (Function::Sin, _) => {
                    (Number::ZERO, sine.times(rule!("the sine of a doubled angle", &cosine, &sine), limit)?)
                }
                (_, Doubled::Sine) => (coefficient, sine.times(&sine, limit)?.negative()),
                (_, Doubled::Cosine) => (-coefficient, cosine.times(&cosine, limit)?),
                _ => continue,
            };
            result.add(powers.clone(), -coefficient);
            result.add(rest.clone(), constant);
            let scale = Polynomial::term(rest, coefficient * Number::integer(2));
            result = result.plus(&wave.times(&scale, limit)?, Number::ONE);
        }
    }
    Some(result)
}
