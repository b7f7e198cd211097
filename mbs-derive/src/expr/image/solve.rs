//! Linear systems in a field: what solves them, whatever the order of pivots is.

use super::{Element, Image, Value};

/// `M q̈ − Aᵀ λ = f`, `A q̈ = c`, reduced.
pub(super) struct System<const K: usize> {
    size: usize,
    /// What takes right sides to those of the reduced system, row by row.
    taken: Vec<Vec<Image<K>>>,
    /// The unknown that each row gives; rows behind these are zero.
    leads: Vec<usize>,
    /// Whether q̈ is the same in all solutions.
    is_determined: bool,
}

impl<const K: usize> System<K> {
    /// Of the lower triangle of M and of A, row by row, with this many rows of A.
    pub(super) fn new(n: usize, rows: usize, mass: &[Image<K>], jacobian: &[Image<K>]) -> Self {
        let size = n + rows;
        let zero = Image::constant(0.0);
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => mass[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)],
            (true, false) => jacobian[(j - n) * n + i].neg(),
            (false, true) => jacobian[(i - n) * n + j],
            (false, false) => zero,
        };
        let unit = |i: usize, j: usize| if i == j { Image::constant(1.0) } else { zero };
        let row = |i: usize| (0..size).map(|j| entry(i, j)).chain((0..size).map(|j| unit(i, j))).collect::<Vec<_>>();
        let mut matrix: Vec<Vec<Image<K>>> = (0..size).map(row).collect();
        let mut leads = Vec::new();
        for column in 0..size {
            let Some(pivot) = (leads.len()..size).find(|&i| !matrix[i][column].is_zero()) else { continue };
            matrix.swap(leads.len(), pivot);
            let (row, factor) = (leads.len(), matrix[leads.len()][column]);
            matrix[row].iter_mut().for_each(|entry| *entry = entry.div(factor));
            let pivot = matrix[row].clone();
            for other in (0..size).filter(|&other| other != row) {
                let factor = matrix[other][column];
                if !factor.is_zero() {
                    let entries = matrix[other].iter_mut().zip(&pivot);
                    entries.for_each(|(entry, &pivot)| *entry = entry.sub(factor.mul(pivot)));
                }
            }
            leads.push(column);
        }
        let is_free = |column: usize| !leads.contains(&column);
        let moves = |column: usize| leads.iter().zip(&matrix).any(|(&lead, row)| lead < n && !row[column].is_zero());
        let is_determined = (0..size).filter(|&column| is_free(column)).all(|column| column >= n && !moves(column));
        let taken = matrix.into_iter().map(|row| row[size..].to_vec()).collect();
        System { size, taken, leads, is_determined }
    }

    /// q̈, then λ; nothing defined where there is no solution, or more than one q̈. Of rows that depend on each other λ
    /// is one of those that solve the system.
    pub(super) fn solution(&self, column: &[Image<K>]) -> Vec<Image<K>> {
        let zero = Image::constant(0.0);
        let product = |row: &Vec<Image<K>>| row.iter().zip(column).fold(zero, |sum, (a, &b)| sum.add(a.mul(b)));
        let reduced: Vec<Image<K>> = self.taken.iter().map(product).collect();
        if !self.is_determined || reduced[self.leads.len()..].iter().any(|rest| !rest.is_zero()) {
            return vec![Image::NOT_DEFINED; self.size];
        }
        let mut solution = vec![zero; self.size];
        self.leads.iter().zip(reduced).for_each(|(&lead, value)| solution[lead] = value);
        solution
    }
}
