//! The configurations of a pose: those within the ranges of the joints, and the one that is nearest to another.

use core::fmt;
use core::ops::Deref;

use super::{Branch, Elbow, Shoulder, Singularities, Solution, Wrist};
use crate::JointVector;
use crate::limits::{InvalidLimits, JointLimits};

/// Up to eight configurations, as a slice.
///
/// Front before back, then positive before negative elbow, then positive before negative wrist.
#[derive(Clone, Copy)]
pub struct Solutions {
    /// The first `len` of them count.
    list: [Solution; 8],
    /// At most 8.
    len: usize,
}

/// Why none of the configurations of a pose is within the ranges of the joints.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OutsideLimits {
    /// The limits that were given are none, for the reason inside.
    #[error(transparent)]
    Limits(#[from] InvalidLimits),
    /// All configurations have an angle that no turn brings into its range.
    #[error("every configuration crosses a limit, the best one that of joint {joint} by {by} rad")]
    Crossed {
        /// The configuration that is outside by least.
        best: Solution,
        /// Its joint that is outside by most, counted from 0.
        joint: usize,
        /// By how much \[rad\].
        by: f64,
    },
    /// There are no configurations.
    #[error("there are no configurations to choose from")]
    Empty,
}

impl Solutions {
    pub(super) fn none() -> Self {
        let branch = Branch { shoulder: Shoulder::Front, elbow: Elbow::Positive, wrist: Wrist::Positive };
        Self { list: [Solution { q: [0.0; 6], branch, singular: Singularities::default() }; 8], len: 0 }
    }

    #[inline]
    pub(super) fn push(&mut self, solution: Solution) {
        self.list[self.len] = solution;
        self.len += 1;
    }

    /// Those within the ranges of the joints, every angle moved into its range by whole turns, to the value nearest to
    /// `near`.
    #[must_use]
    pub fn within(&self, limits: &JointLimits, near: &JointVector) -> Self {
        let mut admitted = Self::none();
        for solution in self {
            if let Some(q) = turned(&solution.q, limits, near) {
                admitted.push(Solution { q, ..*solution });
            }
        }
        admitted
    }

    /// All of them, every angle moved into its range by whole turns where that can be done; of several values that
    /// nearest to `near` is taken. Angles that no turn brings into range are left in `[−π, π]`.
    #[must_use]
    pub fn wrapped(&self, limits: &JointLimits, near: &JointVector) -> Self {
        let mut moved = *self;
        for solution in &mut moved.list[..self.len] {
            let q = solution.q;
            solution.q = core::array::from_fn(|i| limits.nearest_turn(i, q[i], near[i]).unwrap_or(q[i]));
        }
        moved
    }

    /// The one within the ranges of the joints that is nearest to `near`, whole turns considered: the sum of the
    /// squared differences of the angles is least. `None` where none is within.
    #[must_use]
    pub fn nearest(&self, limits: &JointLimits, near: &JointVector) -> Option<Solution> {
        let distance = |solution: &Solution| -> f64 { (0..6).map(|i| square(solution.q[i] - near[i])).sum() };
        let admitted = self.within(limits, near);
        admitted.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
    }

    /// As [`nearest`](Self::nearest), and why there is none.
    ///
    /// # Errors
    /// [`OutsideLimits`]: by how much the limits are crossed, or that they are none.
    pub fn choose(&self, limits: &JointLimits, near: &JointVector) -> Result<Solution, OutsideLimits> {
        limits.check()?;
        if let Some(solution) = self.nearest(limits, near) {
            return Ok(solution);
        }
        let outside = |solution: &Solution| {
            let joints = (0..6).map(|joint| (joint, limits.excess(joint, solution.q[joint])));
            let (joint, by) = joints.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
            (*solution, joint, by)
        };
        let best = self.iter().map(outside).min_by(|a, b| a.2.total_cmp(&b.2));
        Err(best.map_or(OutsideLimits::Empty, |(best, joint, by)| OutsideLimits::Crossed { best, joint, by }))
    }

    /// The one of this branch.
    #[must_use]
    pub fn of_branch(&self, branch: Branch) -> Option<Solution> {
        self.iter().find(|solution| solution.branch == branch).copied()
    }
}

fn turned(q: &JointVector, limits: &JointLimits, near: &JointVector) -> Option<JointVector> {
    let mut moved = *q;
    for i in 0..6 {
        moved[i] = limits.nearest_turn(i, q[i], near[i])?;
    }
    Some(moved)
}

impl Deref for Solutions {
    type Target = [Solution];

    fn deref(&self) -> &[Solution] {
        &self.list[..self.len]
    }
}

impl<'a> IntoIterator for &'a Solutions {
    type Item = &'a Solution;
    type IntoIter = core::slice::Iter<'a, Solution>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Debug for Solutions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self).finish()
    }
}

impl PartialEq for Solutions {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

fn square(x: f64) -> f64 {
    x * x
}
