//! Columns of a Jacobian that are proved together, so that the proof of thousands of them stays linear.

use crate::expr::Symbol;

use super::tested::Tested;

/// Matrices of at most this many columns are proved column by column; of wider ones every column counts in one of this
/// many sums.
const GROUPS: usize = 8;

/// Up to this many coordinates Lagrange's equations are proved one by one; of more by their product with a vector whose
/// components have no relation.
const FEW_EQUATIONS: usize = 50;

/// Every `step`-th column from `first` on, each with its weight.
///
/// A sum of columns `Σ wⱼ ∂f/∂xⱼ` is the derivative of f in the direction w, one sweep. Errors of its columns could
/// cancel, but not at all of the states at which the proof is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    first: usize,
    step: usize,
    width: usize,
}

impl Group {
    /// All columns of a matrix of this width.
    pub(super) fn of(width: usize) -> impl Iterator<Item = Group> {
        let step = width.min(GROUPS);
        (0..step).map(move |first| Group { first, step, width })
    }

    /// Lagrange's equations of this many coordinates: one by one, or of a long mechanism all in one sum.
    pub(super) fn of_equations(width: usize) -> impl Iterator<Item = Group> {
        let step = if width <= FEW_EQUATIONS { width } else { 1 };
        (0..step).map(move |first| Group { first, step, width })
    }

    /// The numbers of its columns.
    pub(super) fn columns(self) -> impl Iterator<Item = usize> {
        (self.first..self.width).step_by(self.step)
    }

    /// What a column counts: 1 where it is alone, else what has no relation to that of others.
    pub(super) fn weight<V: Tested>(self, column: usize) -> V {
        V::weight(column / self.step)
    }

    /// What the symbol that a column belongs to counts, 0 for others.
    pub(super) fn weight_of<V: Tested>(self, other: Symbol, symbol: fn(u32) -> Symbol) -> V {
        let number = match other {
            Symbol::Coordinate(i) | Symbol::Velocity(i) | Symbol::Input(i) => i,
            Symbol::Time
            | Symbol::Acceleration(_)
            | Symbol::Parameter(_)
            | Symbol::Prescribed(..)
            | Symbol::Multiplier(_) => return V::default(),
        };
        let is_among = symbol(number) == other && number as usize % self.step == self.first;
        if is_among { self.weight(number as usize) } else { V::default() }
    }

    /// What each coordinate counts, 0 for those of other groups.
    pub(super) fn direction<V: Tested>(self) -> impl Fn(usize) -> V {
        move |i| if i % self.step == self.first { self.weight(i) } else { V::default() }
    }

    /// `Σ wⱼ xⱼ`; of a column alone its value.
    pub(super) fn sum<V: Tested>(self, values: &[V]) -> V {
        if self.step == self.width { values[self.first] } else { self.combined(values, 1)[0] }
    }

    /// `Σ wⱼ aᵢⱼ` of a matrix of `rows` rows, row by row.
    pub(super) fn combined<V: Tested>(self, matrix: &[V], rows: usize) -> Vec<V> {
        let row = |i: usize| self.columns().map(|j| self.weight::<V>(j) * matrix[i * self.width + j]).sum();
        (0..rows).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Rounded;

    #[test]
    fn few_columns_are_alone_and_of_many_each_counts_once() {
        for width in [0, 1, GROUPS, GROUPS + 1, 1000] {
            let mut columns: Vec<usize> = Group::of(width).flat_map(Group::columns).collect();
            columns.sort();
            assert_eq!(columns, (0..width).collect::<Vec<_>>());
        }
        assert_eq!(Group::of_equations(FEW_EQUATIONS).map(|group| group.columns().count()).max(), Some(1));
        assert_eq!(Group::of_equations(1000).map(|group| group.columns().count()).collect::<Vec<_>>(), [1000]);
        for group in Group::of(GROUPS) {
            assert_eq!(group.columns().map(|j| group.weight::<Rounded>(j)).collect::<Vec<_>>(), [Rounded::exact(1.0)]);
        }
    }

    #[test]
    fn a_sum_has_the_weights_of_its_columns() {
        let group = Group { first: 1, step: 2, width: 5 };
        let matrix: Vec<Rounded> = (0..10).map(|k| Rounded::exact(f64::from(k))).collect();
        let expected = [1.0 + 3.0 * group.weight::<Rounded>(3).value, 6.0 + 8.0 * group.weight::<Rounded>(3).value];
        assert_eq!(group.combined(&matrix, 2).iter().map(|v| v.value).collect::<Vec<_>>(), expected);
        let direction: Vec<Rounded> = (0..5).map(group.direction()).collect();
        let [zero, one] = [0.0, 1.0].map(Rounded::exact);
        assert_eq!(direction, [zero, one, zero, group.weight(3), zero]);
        assert_eq!(group.weight_of::<Rounded>(Symbol::Input(3), Symbol::Input), group.weight(3));
        assert_eq!(group.weight_of::<Rounded>(Symbol::Input(2), Symbol::Input), Rounded::default());
        assert_eq!(group.weight_of::<Rounded>(Symbol::Velocity(3), Symbol::Input), Rounded::default());
    }
}
