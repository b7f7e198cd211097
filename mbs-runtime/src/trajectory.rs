//! Recording: a table of times, coordinates and velocities.

use std::vec::Vec;

use crate::error::DimensionMismatch;
use crate::state::{Coordinates, State};

/// A motion as a table: one row `(t, q, q̇)` per instant, in the order in which they were recorded.
///
/// With the feature `serde` it is written as `{"dimension": N, "t": […], "q": [[…], …], "qd": [[…], …]}`, one inner
/// array per row, and checked when it is read.
///
/// ```
/// use mbs_runtime::{Dop853, Integrator, State, Trajectory};
///
/// let mut state = State::new([1.0], [0.0]);
/// let mut trajectory = Trajectory::new(1);
/// Dop853::new(1e-9, 1e-12)
///     .sample(|_, q, _, qdd| qdd[0] = -q[0], 0.0, &[0.0, 0.5, 1.0], &mut state, |t, state| {
///         trajectory.push(t, state).unwrap();
///     })
///     .unwrap();
/// assert_eq!(trajectory.len(), 3);
/// for row in &trajectory {
///     assert!((row.q[0] - row.t.cos()).abs() < 1e-8);
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize),
    serde(try_from = "table::Table<T>", bound(deserialize = "T: serde::Deserialize<'de>"))
)]
pub struct Trajectory<T = f64> {
    /// The number of coordinates.
    dimension: usize,
    t: Vec<f64>,
    /// `dimension` numbers for each time.
    q: Vec<T>,
    /// `dimension` numbers for each time.
    qd: Vec<T>,
}

/// One instant of a [`Trajectory`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a, T = f64> {
    /// Time \[s\].
    pub t: f64,
    /// Coordinates.
    pub q: &'a [T],
    /// Velocities.
    pub qd: &'a [T],
}

impl<T: Copy> Trajectory<T> {
    /// An empty table for `dimension` coordinates.
    #[must_use]
    pub const fn new(dimension: usize) -> Self {
        Self { dimension, t: Vec::new(), q: Vec::new(), qd: Vec::new() }
    }

    /// Appends a row.
    ///
    /// # Errors
    /// [`DimensionMismatch`] if `state` has another number of coordinates or velocities; nothing is appended.
    pub fn push<V>(&mut self, t: f64, state: &State<V>) -> Result<(), DimensionMismatch>
    where
        V: Coordinates<Scalar = T>,
    {
        let (q, qd) = (state.q.as_slice(), state.qd.as_slice());
        for found in [q.len(), qd.len()] {
            if found != self.dimension {
                return Err(DimensionMismatch { expected: self.dimension, found });
            }
        }
        self.t.push(t);
        self.q.extend_from_slice(q);
        self.qd.extend_from_slice(qd);
        Ok(())
    }

    /// The number of coordinates.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        self.dimension
    }

    /// The number of rows.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.t.len()
    }

    /// True where there is no row.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The times of all rows \[s\].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.t
    }

    /// The row `index`, counted from 0.
    #[must_use]
    pub fn row(&self, index: usize) -> Option<Row<'_, T>> {
        let &t = self.t.get(index)?;
        let numbers = index * self.dimension..(index + 1) * self.dimension;
        Some(Row { t, q: &self.q[numbers.clone()], qd: &self.qd[numbers] })
    }

    /// The last row.
    #[must_use]
    pub fn last(&self) -> Option<Row<'_, T>> {
        self.row(self.len().checked_sub(1)?)
    }

    /// All rows.
    #[must_use]
    pub fn iter(&self) -> Rows<'_, T> {
        Rows { trajectory: self, remaining: 0..self.len() }
    }

    /// Coordinate `index` of all rows, as a plot wants it; empty where there is no such coordinate.
    pub fn coordinate(&self, index: usize) -> impl Iterator<Item = T> {
        self.iter().filter_map(move |row| row.q.get(index).copied())
    }

    /// Velocity `index` of all rows; empty where there is no such coordinate.
    pub fn velocity(&self, index: usize) -> impl Iterator<Item = T> {
        self.iter().filter_map(move |row| row.qd.get(index).copied())
    }
}

/// The rows of a [`Trajectory`], from first to last.
#[derive(Clone, Debug)]
pub struct Rows<'a, T> {
    trajectory: &'a Trajectory<T>,
    remaining: core::ops::Range<usize>,
}

impl<'a, T: Copy> Iterator for Rows<'a, T> {
    type Item = Row<'a, T>;

    fn next(&mut self) -> Option<Row<'a, T>> {
        self.trajectory.row(self.remaining.next()?)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.remaining.size_hint()
    }
}

impl<'a, T: Copy> DoubleEndedIterator for Rows<'a, T> {
    fn next_back(&mut self) -> Option<Row<'a, T>> {
        self.trajectory.row(self.remaining.next_back()?)
    }
}

impl<T: Copy> ExactSizeIterator for Rows<'_, T> {}

impl<'a, T: Copy> IntoIterator for &'a Trajectory<T> {
    type Item = Row<'a, T>;
    type IntoIter = Rows<'a, T>;

    fn into_iter(self) -> Rows<'a, T> {
        self.iter()
    }
}

/// The written form.
#[cfg(feature = "serde")]
mod table {
    use std::vec::Vec;

    use serde::ser::{Serialize, SerializeStruct, Serializer};

    use super::{Row, Trajectory};
    use crate::error::DimensionMismatch;

    #[derive(serde::Deserialize)]
    pub(super) struct Table<T> {
        dimension: usize,
        t: Vec<f64>,
        q: Vec<Vec<T>>,
        qd: Vec<Vec<T>>,
    }

    impl<T> TryFrom<Table<T>> for Trajectory<T> {
        type Error = DimensionMismatch;

        fn try_from(table: Table<T>) -> Result<Self, DimensionMismatch> {
            let Table { dimension, t, q, qd } = table;
            for rows in [&q, &qd] {
                check(t.len(), rows.len())?;
                rows.iter().try_for_each(|row| check(dimension, row.len()))?;
            }
            let [q, qd] = [q, qd].map(|rows| rows.into_iter().flatten().collect());
            Ok(Self { dimension, t, q, qd })
        }
    }

    fn check(expected: usize, found: usize) -> Result<(), DimensionMismatch> {
        if found == expected { Ok(()) } else { Err(DimensionMismatch { expected, found }) }
    }

    /// One column of vectors, a row at a time.
    struct Column<'a, T>(&'a Trajectory<T>, fn(Row<'a, T>) -> &'a [T]);

    impl<T: Copy + Serialize> Serialize for Column<'_, T> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.collect_seq(self.0.iter().map(self.1))
        }
    }

    impl<T: Copy + Serialize> Serialize for Trajectory<T> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut table = serializer.serialize_struct("Trajectory", 4)?;
            table.serialize_field("dimension", &self.dimension)?;
            table.serialize_field("t", &self.t)?;
            table.serialize_field("q", &Column(self, |row| row.q))?;
            table.serialize_field("qd", &Column(self, |row| row.qd))?;
            table.end()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Trajectory {
        let mut trajectory = Trajectory::new(2);
        trajectory.push(0.0, &State::new([1.0, 2.0], [3.0, 4.0])).unwrap();
        trajectory.push(0.5, &State::new([5.0, 6.0], [7.0, 8.0])).unwrap();
        trajectory
    }

    #[test]
    fn rows_come_in_order() {
        let trajectory = example();
        assert_eq!(trajectory.len(), 2);
        assert_eq!(trajectory.row(0), Some(Row { t: 0.0, q: &[1.0, 2.0], qd: &[3.0, 4.0] }));
        assert_eq!((trajectory.row(2), trajectory.row(usize::MAX)), (None, None));
        assert_eq!(trajectory.last(), trajectory.iter().next_back());
        assert_eq!(trajectory.coordinate(1).collect::<Vec<_>>(), [2.0, 6.0]);
        assert_eq!(trajectory.velocity(0).collect::<Vec<_>>(), [3.0, 7.0]);
        assert_eq!(trajectory.coordinate(2).count(), 0);
        assert_eq!(trajectory.times(), [0.0, 0.5]);
        assert_eq!(Trajectory::<f64>::new(3).last(), None);
    }

    #[test]
    fn rows_of_another_length_are_refused() {
        let mut trajectory = example();
        let result = trajectory.push(1.0, &State::new([1.0], [2.0]));
        assert_eq!(result, Err(DimensionMismatch { expected: 2, found: 1 }));
        assert_eq!(trajectory, example());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn written_and_read_again() {
        let text = serde_json::to_string(&example()).unwrap();
        assert_eq!(text, r#"{"dimension":2,"t":[0.0,0.5],"q":[[1.0,2.0],[5.0,6.0]],"qd":[[3.0,4.0],[7.0,8.0]]}"#);
        assert_eq!(serde_json::from_str::<Trajectory>(&text).unwrap(), example());
        let torn = r#"{"dimension":2,"t":[0.0],"q":[[1.0]],"qd":[[3.0,4.0]]}"#;
        let error = serde_json::from_str::<Trajectory>(torn).unwrap_err();
        assert_eq!(std::string::ToString::to_string(&error), "expected 2 numbers, found 1");
    }
}
