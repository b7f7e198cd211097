//! Products of powers, and sums of multiples: an integer for each of a few indivisible expressions.

use std::iter::Map;
use std::slice;

use crate::expr::Id;

/// Integers of indivisible expressions, in the order of these. A list and no map: most have few entries, and terms are
/// compared more often than anything else.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Powers(Vec<(Id, i32)>);

/// What goes through the entries.
type Entries<'p> = Map<slice::Iter<'p, (Id, i32)>, fn(&'p (Id, i32)) -> (&'p Id, &'p i32)>;

impl Powers {
    /// None.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    pub(crate) fn iter(&self) -> Entries<'_> {
        self.0.iter().map(|(id, n)| (id, n))
    }

    pub(crate) fn keys(&self) -> impl Iterator<Item = &Id> + Clone {
        self.0.iter().map(|(id, _)| id)
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn get(&self, id: &Id) -> Option<&i32> {
        self.0.binary_search_by_key(id, |(id, _)| *id).ok().map(|place| &self.0[place].1)
    }

    pub(crate) fn insert(&mut self, id: Id, n: i32) {
        match self.0.binary_search_by_key(&id, |(id, _)| *id) {
            Ok(place) => self.0[place].1 = n,
            Err(place) => self.0.insert(place, (id, n)),
        }
    }

    /// The entry of the first expression.
    pub(crate) fn first_key_value(&self) -> Option<(&Id, &i32)> {
        self.iter().next()
    }

    /// `self + factor · other`, entry by entry, without zeros.
    pub(crate) fn plus(&self, other: &Self, factor: i32) -> Self {
        let mut sum = Vec::with_capacity(self.0.len() + other.0.len());
        let mut a = self.0.iter().copied().peekable();
        for &(id, n) in &other.0 {
            while let Some(before) = a.next_if(|(before, _)| *before < id) {
                sum.push(before);
            }
            let known = a.next_if(|(known, _)| *known == id).map_or(0, |(_, known)| known);
            sum.extend([(id, known + factor * n)].into_iter().filter(|(_, n)| *n != 0));
        }
        sum.extend(a);
        Powers(sum)
    }
}

impl<'p> IntoIterator for &'p Powers {
    type Item = (&'p Id, &'p i32);
    type IntoIter = Entries<'p>;

    fn into_iter(self) -> Entries<'p> {
        self.iter()
    }
}

impl IntoIterator for Powers {
    type Item = (Id, i32);
    type IntoIter = std::vec::IntoIter<(Id, i32)>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl Extend<(Id, i32)> for Powers {
    fn extend<I: IntoIterator<Item = (Id, i32)>>(&mut self, entries: I) {
        entries.into_iter().for_each(|(id, n)| self.insert(id, n));
    }
}

impl<'p> Extend<(&'p Id, &'p i32)> for Powers {
    fn extend<I: IntoIterator<Item = (&'p Id, &'p i32)>>(&mut self, entries: I) {
        entries.into_iter().for_each(|(&id, &n)| self.insert(id, n));
    }
}

impl FromIterator<(Id, i32)> for Powers {
    fn from_iter<I: IntoIterator<Item = (Id, i32)>>(entries: I) -> Self {
        let mut powers = Self::new();
        powers.extend(entries);
        powers
    }
}

impl<const N: usize> From<[(Id, i32); N]> for Powers {
    fn from(entries: [(Id, i32); N]) -> Self {
        entries.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_in_order_and_never_twice() {
        let powers: Powers = [(Id(5), 1), (Id(2), -3), (Id(5), 4)].into();
        assert_eq!(powers.iter().collect::<Vec<_>>(), [(&Id(2), &-3), (&Id(5), &4)]);
        assert_eq!((powers.get(&Id(5)), powers.get(&Id(3)), powers.len()), (Some(&4), None, 2));
        assert_eq!(powers.first_key_value(), Some((&Id(2), &-3)));
    }

    #[test]
    fn sums_are_without_zeros() {
        let a: Powers = [(Id(1), 2), (Id(3), 4), (Id(9), 1)].into();
        let b: Powers = [(Id(0), 1), (Id(3), 2), (Id(4), -1), (Id(9), -5)].into();
        assert_eq!(a.plus(&b, -2), [(Id(0), -2), (Id(1), 2), (Id(4), 2), (Id(9), 11)].into());
        assert_eq!(a.plus(&a, -1), Powers::new());
        assert_eq!(Powers::new().plus(&a, 1), a);
        assert_eq!(a.plus(&Powers::new(), 1), a);
    }
}
