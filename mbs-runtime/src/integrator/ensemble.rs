//! Many motions of one mechanism at once: states in blocks of lanes, blocks on all cores.
//!
//! A member's motion is the same to the bit whatever the lanes, the blocks and the threads, if sines and cosines are
//! those of [`Scalar::sin_cos_all`], as in generated code: it is that of
//! [`Integrator::integrate`](crate::Integrator::integrate) with the same settings.

use core::ops::Range;
use std::vec::Vec;

use super::{Summary, check_input};
use crate::error::IntegrationError;
use crate::scalar::Scalar;
use crate::state::State;

mod dop853;
mod lanes;
mod rk4;

pub use lanes::{Lanes, Packed};

/// The greatest number of lanes of a type.
const MOST: usize = 16;

/// The outcome of one member's motion.
type Outcome = Result<Summary, IntegrationError>;

/// States of one mechanism with `N` coordinates, in blocks of `L::COUNT` members: the first number of a block has the
/// first coordinates of all its members, and so on (structures of arrays).
///
/// `L` is `f64`, `f32`, or one of the lanes of `wide` (feature `wide`); with the feature `rayon` blocks are gone
/// through on all cores. Which of these are chosen does not change a bit of a result, if the right-hand side takes
/// sines and cosines from [`Scalar::sin_cos_all`], as generated code does (`sin` is the library's for a number and a
/// polynomial for lanes), except where the target has fused multiply–add and the right-hand side asks for it by hand.
///
/// ```
/// use mbs_runtime::{Dop853, Ensemble, Scalar, State};
///
/// // A hundred pendulums of different lengths, released at 1 rad.
/// let lengths: Vec<f64> = (0..100).map(|i| 0.5 + 0.01 * f64::from(i)).collect();
/// let mut pendulums = Ensemble::<f64, 1>::new(lengths.iter().map(|_| State::new([1.0], [0.0])));
/// let outcomes = pendulums.integrate(&Dop853::new(1e-9, 1e-12), 0.0, 2.0, |members| {
///     let length: f64 = members.pack(|member| lengths[member]);
///     move |_, q, _, qdd| {
///         let ([sine], _) = Scalar::sin_cos_all([q[0]]);
///         *qdd = [-9.81 / length * sine]
///     }
/// });
/// assert!(outcomes.iter().all(Result::is_ok));
/// // Where each of them is now.
/// let heights = pendulums.map(|members, state| {
///     members.pack::<f64>(|member| lengths[member]) * (1.0 - state.q[0].cos())
/// });
/// assert_eq!(heights.len(), 100);
/// ```
#[derive(Clone, Debug)]
pub struct Ensemble<L: Lanes, const N: usize> {
    /// Lanes after the last member repeat its state at the start.
    blocks: Vec<State<[L; N]>>,
    len: usize,
}

/// Ensembles are equal if their members are, in order; what fills the last block does not count.
impl<L: Lanes, const N: usize> PartialEq for Ensemble<L, N> {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.states().eq(other.states())
    }
}

impl<L: Lanes, const N: usize> Ensemble<L, N> {
    /// Members with these states, in this order.
    #[must_use]
    pub fn new(states: impl IntoIterator<Item = State<[L::Real; N]>>) -> Self {
        let states: Vec<_> = states.into_iter().collect();
        let blocks = members_of::<L>(states.len()).map(|members| {
            let pack = |number: &dyn Fn(usize) -> L::Real| members.pack(number);
            State::new(
                core::array::from_fn(|i| pack(&|member| states[member].q[i])),
                core::array::from_fn(|i| pack(&|member| states[member].qd[i])),
            )
        });
        Self { blocks: blocks.collect(), len: states.len() }
    }

    /// The number of members.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// True where there is no member.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The members' states, in their order.
    pub fn states(&self) -> impl Iterator<Item = State<[L::Real; N]>> {
        (0..self.len).map(|member| {
            let (block, lane) = (&self.blocks[member / L::COUNT], member % L::COUNT);
            State::new(block.q.map(|x| x.lane(lane)), block.qd.map(|x| x.lane(lane)))
        })
    }

    /// What `function` gives for each member: any generated function of states in lanes, a number, a vector or a
    /// matrix.
    ///
    /// ```
    /// use mbs_runtime::{Ensemble, State};
    ///
    /// let ensemble = Ensemble::<f64, 2>::new([State::new([1.0, 2.0], [3.0, 4.0])]);
    /// let squares = ensemble.map(|_, state| [[state.q[0] * state.q[0]], [state.qd[1] * state.qd[1]]]);
    /// assert_eq!(squares, [[[1.0], [16.0]]]);
    /// ```
    pub fn map<P: Packed<L>>(&self, function: impl Fn(Members, &State<[L; N]>) -> P + Send + Sync) -> Vec<P::Each>
    where
        P::Each: Send,
    {
        let blocks: Vec<_> = members_of::<L>(self.len).zip(&self.blocks).collect();
        let results = each_block(blocks, |(members, state)| {
            let packed = function(members, state);
            (0..members.range().len()).map(|lane| packed.each(lane)).collect::<Vec<_>>()
        });
        results.into_iter().flatten().collect()
    }

    /// Carries every member from the time `t` to `t_end`; the outcome of each.
    ///
    /// | argument       | meaning                                                                   | unit |
    /// |----------------|---------------------------------------------------------------------------|------|
    /// | `integrator`   | [`Rk4`](crate::Rk4) with the same steps for all members, or [`Dop853`](crate::Dop853), whose error control gives each member its own |  |
    /// | `t`, `t_end`   | first and last time                                                       | s    |
    /// | `acceleration` | for the members of one block: what writes `q̈ = f(t, q, q̇)` into its last argument, with the time of each lane | |
    ///
    /// A member ends where the motion alone would: with its [`Summary`], or with an [`IntegrationError`] and its last
    /// accepted state. The others of its block go on. Members of a block wait for the one with the most steps, so that
    /// members with like motions belong side by side.
    pub fn integrate<I, F, A>(&mut self, integrator: &I, t: f64, t_end: f64, acceleration: F) -> Vec<Outcome>
    where
        I: EnsembleIntegrator,
        F: Fn(Members) -> A + Send + Sync,
        A: FnMut(L, &[L; N], &[L; N], &mut [L; N]),
    {
        let blocks: Vec<_> = members_of::<L>(self.len).zip(&mut self.blocks).collect();
        let outcomes = each_block(blocks, |(members, state)| {
            let mut outcomes = std::vec![Err(IntegrationError::NonFiniteState { time: t }); members.range().len()];
            integrator.integrate_block(acceleration(members), t, t_end, state, &mut outcomes);
            outcomes
        });
        outcomes.into_iter().flatten().collect()
    }
}

/// A method that carries a block of members at once.
pub trait EnsembleIntegrator: Sync {
    /// Carries the first lanes of `state`, as many as there are `outcomes`, from `t` to `t_end` \[s\], and writes their
    /// outcomes.
    fn integrate_block<L, F, const N: usize>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<[L; N]>,
        outcomes: &mut [Result<Summary, IntegrationError>],
    ) where
        L: Lanes,
        F: FnMut(L, &[L; N], &[L; N], &mut [L; N]);
}

/// Which members of an [`Ensemble`] a block has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Members {
    first: usize,
    end: usize,
}

impl Members {
    /// Their numbers, counted from 0 through the ensemble.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.first..self.end
    }

    /// What each of them has of its own (a parameter, an input) in its lane; lanes without a member repeat the last.
    #[must_use]
    pub fn pack<L: Lanes>(&self, mut number: impl FnMut(usize) -> L::Real) -> L {
        L::from_fn(|lane| number((self.first + lane).min(self.end - 1)))
    }
}

/// The blocks of `len` members.
fn members_of<L: Lanes>(len: usize) -> impl Iterator<Item = Members> {
    (0..len).step_by(L::COUNT).map(move |first| Members { first, end: len.min(first + L::COUNT) })
}

/// What `f` makes of each block, in their order.
#[cfg(feature = "rayon")]
fn each_block<B: Send, R: Send>(blocks: Vec<B>, f: impl Fn(B) -> R + Send + Sync) -> Vec<R> {
    use rayon::iter::{IntoParallelIterator, ParallelIterator};
    blocks.into_par_iter().map(f).collect()
}

/// What `f` makes of each block, in their order.
#[cfg(not(feature = "rayon"))]
fn each_block<B, R>(blocks: Vec<B>, f: impl Fn(B) -> R) -> Vec<R> {
    blocks.into_iter().map(f).collect()
}

/// Which lanes of a block have been finite in all stages so far, and what they have cost.
struct Watch {
    fine: [bool; MOST],
    evaluations: [usize; MOST],
}

impl Watch {
    /// The accelerations of a stage: each is one more evaluation of the lanes that are fine.
    #[inline]
    fn evaluated<L: Lanes, const N: usize>(&mut self, qdd: &[L; N]) {
        let rest = rest_of(L::zero(), qdd);
        for lane in 0..L::COUNT {
            self.evaluations[lane] += usize::from(self.fine[lane]);
            self.fine[lane] &= rest.lane(lane) == L::Real::zero();
        }
    }

    /// The end of a step.
    #[inline]
    fn ended<L: Lanes, const N: usize>(&mut self, state: &State<[L; N]>) {
        let rest = rest_of(rest_of(L::zero(), &state.q), &state.qd);
        for lane in 0..L::COUNT {
            self.fine[lane] &= rest.lane(lane) == L::Real::zero();
        }
    }
}

/// `sum + Σ (x − x)`: zero in the lanes where all numbers are finite, NaN in the others.
#[inline]
#[allow(clippy::eq_op)] // of what is not finite it is not zero
fn rest_of<L: Lanes, const N: usize>(sum: L, numbers: &[L; N]) -> L {
    numbers.iter().fold(sum, |sum, &x| sum + (x - x))
}

/// In the lanes that are `chosen` the numbers of `from`.
#[inline]
fn take<L: Lanes, const N: usize>(chosen: &[bool; MOST], from: &[L; N], to: &mut [L; N]) {
    let flag = L::from_fn(|lane| if chosen[lane] { L::Real::one() } else { L::Real::zero() });
    let mask = L::zero().less(flag);
    for (to, &from) in to.iter_mut().zip(from) {
        *to = L::blend(mask, from, *to);
    }
}

/// A time of its own in each lane.
#[inline]
fn times<L: Lanes>(time: impl Fn(usize) -> f64) -> L {
    L::from_fn(|lane| L::Real::from_f64(time(lane)))
}

/// Refuses, lane by lane, what no method can start from; which lanes go on.
fn check<L: Lanes, const N: usize>(
    t: f64,
    t_end: f64,
    state: &State<[L; N]>,
    outcomes: &mut [Outcome],
) -> [bool; MOST] {
    let mut active = [false; MOST];
    for (lane, outcome) in outcomes.iter_mut().enumerate() {
        let state = State::new(state.q.map(|x| x.lane(lane)), state.qd.map(|x| x.lane(lane)));
        match check_input(t, t_end, &state) {
            Ok(()) => active[lane] = true,
            Err(error) => *outcome = Err(error),
        }
    }
    active
}

/// Before the first step.
fn summary_at(time: f64) -> Summary {
    Summary { time, stopped: false, evaluations: 0, accepted: 0, rejected: 0, next_step: 0.0 }
}

#[cfg(test)]
mod tests;
