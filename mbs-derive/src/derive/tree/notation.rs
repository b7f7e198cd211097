//! What the sweeps call what they compute, for joint j counted from the base. `emit/doc.rs` has the key.

use std::fmt::Display;

use crate::expr::{Expr, Matrix, Vector};

use super::inertia::Inertia;
use super::linkage::Linkage;
use super::wrench::Wrench;

const AXES: [char; 3] = ['x', 'y', 'z'];

impl Linkage<'_> {
    /// The joint that each link is behind, 0 for what the base carries.
    pub(super) fn joints(&self) -> Vec<usize> {
        let (mut joints, mut count): (Vec<usize>, usize) = (Vec::new(), 0);
        for link in &self.links {
            let moves = link.edge.is_some_and(|edge| edge.displacement().is_some());
            count += usize::from(moves);
            joints.push(if moves { count } else { link.parent.map_or(0, |parent| joints[parent]) });
        }
        joints
    }
}

pub(super) fn scalar(letters: &str, joint: impl Display, value: Expr<'_>) {
    value.note(format_args!("{letters}{joint}"));
}

pub(super) fn vector(letters: &str, joint: impl Display, vector: Vector<'_>) {
    vector.0.iter().zip(AXES).for_each(|(c, axis)| c.note(format_args!("{letters}{joint}{axis}")));
}

pub(super) fn matrix(letters: &str, joint: impl Display, matrix: &Matrix<'_>) {
    for (row, i) in matrix.0.iter().zip(AXES) {
        row.iter().zip(AXES).for_each(|(entry, j)| entry.note(format_args!("{letters}{joint}{i}{j}")));
    }
}

pub(super) fn wrench(suffix: &str, joint: impl Display, wrench: &Wrench<'_>) {
    vector(&format!("f{suffix}"), &joint, wrench.force);
    vector(&format!("n{suffix}"), &joint, wrench.couple);
}

pub(super) fn inertia(suffix: &str, joint: impl Display, inertia: &Inertia<'_>) {
    scalar(&format!("m{suffix}"), &joint, inertia.mass);
    vector(&format!("h{suffix}"), &joint, inertia.first);
    matrix(&format!("s{suffix}"), &joint, &inertia.second.matrix());
}
