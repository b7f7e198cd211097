//! Gaussian elimination in a finite field: ranks without a tolerance.

use crate::expr::{Residue, Value};

/// The reduced row echelon form of a matrix.
pub(crate) struct Echelon<const K: usize> {
    columns: usize,
    /// The rows that are left, each with the column of its leading one.
    rows: Vec<(usize, Vec<Residue<K>>)>,
    /// The numbers of the rows that those before them determine.
    dependent: Vec<usize>,
}

impl<const K: usize> Echelon<K> {
    /// `None` where an entry has no value.
    pub(crate) fn of(matrix: Vec<Vec<Residue<K>>>) -> Option<Self> {
        if matrix.iter().flatten().any(|entry| !entry.is_defined()) {
            return None;
        }
        let columns = matrix.first().map_or(0, Vec::len);
        let mut echelon = Echelon { columns, rows: Vec::new(), dependent: Vec::new() };
        for (number, row) in matrix.into_iter().enumerate() {
            echelon.append(number, row);
        }
        Some(echelon)
    }

    fn append(&mut self, number: usize, mut row: Vec<Residue<K>>) {
        for (lead, known) in &self.rows {
            let factor = row[*lead];
            subtract(&mut row, factor, known);
        }
        let Some(lead) = row.iter().position(|entry| !entry.is_zero()) else {
            self.dependent.push(number);
            return;
        };
        let leading = row[lead];
        row.iter_mut().for_each(|entry| *entry = entry.div(leading));
        for (_, known) in &mut self.rows {
            let factor = known[lead];
            subtract(known, factor, &row);
        }
        self.rows.push((lead, row));
    }

    pub(crate) fn rank(&self) -> usize {
        self.rows.len()
    }

    /// The rows that are sums of multiples of those before them.
    pub(crate) fn dependent_rows(&self) -> &[usize] {
        &self.dependent
    }

    /// The columns of a vector that the matrix takes to zero, the fewest of those that have one entry 1 among the
    /// columns without a leading one; `None` where there is no such vector.
    pub(crate) fn shortest_dependence(&self) -> Option<Vec<usize>> {
        let free = (0..self.columns).filter(|column| self.rows.iter().all(|(lead, _)| lead != column));
        let dependence = |column: usize| {
            let bound = self.rows.iter().filter(move |(_, row)| !row[column].is_zero()).map(|(lead, _)| *lead);
            let mut all: Vec<usize> = bound.chain([column]).collect();
            all.sort_unstable();
            all
        };
        free.map(dependence).min_by_key(Vec::len)
    }
}

fn subtract<const K: usize>(row: &mut [Residue<K>], factor: Residue<K>, other: &[Residue<K>]) {
    if !factor.is_zero() {
        row.iter_mut().zip(other).for_each(|(a, b)| *a = a.sub(factor.mul(*b)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Residue = crate::expr::Residue<0>;

    #[test]
    fn ranks_and_dependences() {
        let matrix = |rows: &[&[f64]]| {
            let rows = rows.iter().map(|row| row.iter().map(|&x| Residue::constant(x)).collect()).collect();
            Echelon::of(rows).unwrap()
        };
        let echelon = matrix(&[&[1.0, 2.0, 0.0, 0.0], &[2.0, 4.0, 0.0, 0.0], &[0.0, 0.5, 1e-200, 0.0]]);
        assert_eq!((echelon.rank(), echelon.dependent_rows()), (2, &[1][..]));
        assert_eq!(echelon.shortest_dependence(), Some(vec![3]));
        let echelon = matrix(&[&[1.0, 2.0, 0.0], &[0.0, 0.5, 1.0]]);
        assert_eq!(echelon.shortest_dependence(), Some(vec![0, 1, 2]));
        assert_eq!(matrix(&[&[1e-300, 1.0], &[0.0, 1.0]]).shortest_dependence(), None);
        assert!(Echelon::of(vec![vec![Residue::constant(1.0).div(Residue::constant(0.0))]]).is_none());
    }
}
