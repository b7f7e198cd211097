//! Tables over numbered things, where a hash map would spend the time of a pass on hashing.

use std::ops::{Index, IndexMut};

use super::graph::Id;

/// A value for each of some nodes.
pub(crate) struct Table<V> {
    /// For every 64 nodes of the graph: which are among ours, and how many of ours come before these.
    words: Vec<(u64, u32)>,
    values: Vec<V>,
}

impl<V: Clone> Table<V> {
    /// The same value for each of these nodes, in the order of their numbers.
    pub(crate) fn new(nodes: &[Id], value: V) -> Self {
        let mut words: Vec<(u64, u32)> = vec![(0, 0); nodes.last().map_or(0, |last| last.index() / 64 + 1)];
        for (i, id) in nodes.iter().enumerate() {
            let (members, before) = &mut words[id.index() / 64];
            if *members == 0 {
                *before = i as u32;
            }
            *members |= 1 << (id.index() % 64);
        }
        Table { words, values: vec![value; nodes.len()] }
    }
}

impl<V> Table<V> {
    /// Where the value of a node stands, if it is one of ours.
    #[inline(always)] // every pass looks up every operand
    pub(crate) fn position(&self, id: Id) -> Option<usize> {
        let (members, before) = *self.words.get(id.index() / 64)?;
        let bit = 1 << (id.index() % 64);
        (members & bit != 0).then(|| before as usize + (members & (bit - 1)).count_ones() as usize)
    }

    pub(crate) fn get_mut(&mut self, id: Id) -> Option<&mut V> {
        self.position(id).map(|position| &mut self.values[position])
    }
}

impl<V> Index<Id> for Table<V> {
    type Output = V;

    #[inline(always)] // as `position`
    fn index(&self, id: Id) -> &V {
        &self.values[self.position(id).expect("one of the nodes")]
    }
}

impl<V> IndexMut<Id> for Table<V> {
    fn index_mut(&mut self, id: Id) -> &mut V {
        self.get_mut(id).expect("one of the nodes")
    }
}

/// Finds things that are kept elsewhere, numbered 0, 1, …, by their hashes: linear probing, the home slot of a hash
/// being its leading bits.
#[derive(Default)]
pub(crate) struct Finder {
    /// Part of the hash and one more than the number; a free slot has 0. As many as a power of two.
    slots: Vec<(u32, u32)>,
    count: u32,
}

impl Finder {
    /// With room for about `count` things.
    pub(crate) fn with_capacity(count: usize) -> Self {
        Finder { slots: vec![(0, 0); (count + count / 2).next_power_of_two()], count: 0 }
    }

    /// The number of what has this hash and of which `is` holds; else it is given the next number, and the answer is
    /// `None`.
    pub(crate) fn find_or_add(&mut self, hash: u64, is: impl Fn(u32) -> bool) -> Option<u32> {
        if self.count as usize >= self.slots.len() / 4 * 3 {
            self.grow();
        }
        let hash = (hash >> 32) as u32;
        let mut at = home(hash, self.slots.len());
        while let (other, number @ 1..) = self.slots[at] {
            if other == hash && is(number - 1) {
                return Some(number - 1);
            }
            at = (at + 1) % self.slots.len();
        }
        self.count = self.count.checked_add(1).expect("fewer than 2^32 numbers");
        self.slots[at] = (hash, self.count);
        None
    }

    fn grow(&mut self) {
        let size = (2 * self.slots.len()).max(64);
        for (hash, number) in std::mem::replace(&mut self.slots, vec![(0, 0); size]) {
            if number > 0 {
                let mut at = home(hash, size);
                while self.slots[at].1 > 0 {
                    at = (at + 1) % size;
                }
                self.slots[at] = (hash, number);
            }
        }
    }
}

fn home(hash: u32, size: usize) -> usize {
    ((u64::from(hash) * size as u64) >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_holds_its_nodes_alone() {
        let nodes = [0, 3, 63, 64, 200].map(Id);
        let mut table = Table::new(&nodes, 0);
        nodes.iter().enumerate().for_each(|(i, &id)| table[id] = i);
        assert_eq!(nodes.map(|id| table[id]), [0, 1, 2, 3, 4]);
        assert_eq!([1, 65, 201, 1000].map(|id| table.position(Id(id))), [None; 4]);
    }

    #[test]
    fn things_of_one_hash_are_told_apart() {
        let mut finder = Finder::default();
        for number in 0..1000 {
            let hash = u64::MAX - u64::from(number % 7);
            assert_eq!(finder.find_or_add(hash, |other| other == number), None);
        }
        for number in 0..1000 {
            let hash = u64::MAX - u64::from(number % 7);
            assert_eq!(finder.find_or_add(hash, |other| other == number), Some(number));
        }
    }
}
