//! The configurations of a pose: those within the ranges of the joints, and the one that is nearest to another.

use core::fmt;
use core::ops::Deref;

use super::{Branch, Elbow, Shoulder, Singularities, Solution, Wrist};
use crate::JointVector;
use crate::limits::JointLimits;
use mbs_models::{Error, Failure};

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

/// What [exceeds a limit](Failure::LimitExceeded) where no turn brings an angle of any configuration into its range
/// \[rad\].
pub const EXCESS: &str = "excess of the best configuration over the range of joint";

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
    /// [`Failure::LimitExceeded`]: [by how much](EXCESS) the configuration that is outside by least crosses a limit,
    /// and of which joint; else that there are no limits, or no configurations.
    pub fn choose(&self, limits: &JointLimits, near: &JointVector) -> Result<Solution, Error> {
        limits.check()?;
        if let Some(solution) = self.nearest(limits, near) {
            return Ok(solution);
        }
        let outside = |solution: &Solution| {
            let joints = (0..6).map(|joint| (joint, limits.excess(joint, solution.q[joint])));
            let (joint, by) = joints.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
            (joint, by)
        };
        let best = self.iter().map(outside).min_by(|a, b| a.1.total_cmp(&b.1));
        Err(best
            .map_or(Failure::Missing("configuration to choose from"), |(index, value)| Failure::LimitExceeded {
                quantity: EXCESS,
                unit: "rad",
                index,
                value,
                limit: 0.0,
            })
            .into())
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
