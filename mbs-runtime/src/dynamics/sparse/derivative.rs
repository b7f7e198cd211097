//! What is solved of dual numbers: from `K x = b` follows `K x′ = b′ − K′ x`.

use super::{Elimination, Factors, take_away};
use crate::dual::Dual;
use crate::scalar::Scalar;

impl<T: Scalar, const U: usize, const L: usize> Factors<Dual<T>, U, L> {
    /// The factors of the values.
    pub(crate) fn values(&self) -> Factors<T, U, L> {
        Factors {
            diagonal: self.diagonal.map(|x| x.value),
            entries: self.entries.map(|x| x.value),
            weights: self.weights.map(|x| x.value),
            reciprocals: self.reciprocals.map(|x| x.value),
            lower: self.lower.map(|x| x.value),
            is_sound: self.is_sound,
        }
    }

    /// `b′ − K′ x`, and the sizes of its terms.
    pub(crate) fn rates<const E: usize>(
        &self,
        elimination: &Elimination<U, E, L>,
        right_side: &[Dual<T>; U],
        x: &[T; U],
    ) -> ([T; U], [T; U]) {
        let rates = (&self.diagonal.map(|x| x.derivative), &self.entries.map(|x| x.derivative));
        let mut rest = right_side.map(|b| b.derivative);
        let mut sizes = rest.map(T::abs);
        take_away(elimination, rates, x, (&mut rest, &mut sizes));
        (rest, sizes)
    }
}
