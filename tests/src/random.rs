//! Seeded random numbers and states: the same on every machine, in every run.

use std::array::from_fn;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

/// SplitMix64.
///
/// # Source
///
/// Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014, figure 17; the mixing constants
/// are Stafford's variant 13, as in Vigna's `splitmix64.c` (2015).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A stream of its own for every seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// Uniform in `range`, of which 53 bits are random.
    pub fn uniform(&mut self, range: Range<f64>) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        range.start + (range.end - range.start) * unit
    }

    /// True once in `n` times.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.bits().is_multiple_of(n)
    }

    /// Each entry uniform in `range`; exactly zero once in eight.
    pub fn fill(&mut self, values: &mut [f64], range: Range<f64>) {
        for value in values {
            *value = if self.one_in(8) { 0.0 } else { self.uniform(range.clone()) };
        }
    }

    /// As [`fill`](Self::fill), for a fixed number.
    pub fn array<const N: usize>(&mut self, range: Range<f64>) -> [f64; N] {
        let mut values = [0.0; N];
        self.fill(&mut values, range);
        values
    }

    /// Coordinates at which sines vanish and matrices lose rank.
    pub fn fill_posture(&mut self, posture: Posture, q: &mut [f64]) {
        match posture {
            Posture::Generic => q.fill_with(|| self.uniform(-PI..PI)),
            Posture::SomeZeros => self.fill(q, -PI..PI),
            Posture::StraightRelative => {
                q.fill(0.0);
                if let Some(first) = q.first_mut() {
                    *first = self.uniform(-PI..PI);
                }
            }
            Posture::StraightAbsolute => q.fill(self.uniform(-PI..PI)),
            Posture::RightAngles => q.fill_with(|| (self.bits() % 5) as f64 * FRAC_PI_2 - PI),
            Posture::Zero => q.fill(0.0),
        }
    }
}

/// How the coordinates of a state are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Posture {
    /// Uniform in ±π, never zero on purpose.
    Generic,
    /// Uniform in ±π, each exactly zero once in eight.
    SomeZeros,
    /// All but the first exactly zero: a straight arm in relative angles.
    StraightRelative,
    /// All equal: a straight arm in absolute angles.
    StraightAbsolute,
    /// Multiples of π/2.
    RightAngles,
    /// All exactly zero.
    Zero,
}

impl Posture {
    /// Every posture, the generic one first.
    pub const ALL: [Self; 6] =
        [Self::Generic, Self::SomeZeros, Self::StraightRelative, Self::StraightAbsolute, Self::RightAngles, Self::Zero];
}

/// A state and an acceleration of a mechanism with `N` coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize> {
    /// Coordinates, in ±π whatever their unit.
    pub q: [f64; N],
    /// Velocities, in ±3.
    pub qd: [f64; N],
    /// Accelerations, in ±10.
    pub qdd: [f64; N],
}

/// `count` states that walk through every [`Posture`]; each seventh is at rest.
pub fn states<const N: usize>(seed: u64, count: usize) -> Vec<State<N>> {
    let mut random = Random::new(seed);
    let state = |k: usize| {
        let mut q = [0.0; N];
        random.fill_posture(Posture::ALL[k % Posture::ALL.len()], &mut q);
        // Seven and six have no common factor, so every posture is met at rest, too.
        let qd = if k % 7 == 6 { [0.0; N] } else { random.array(-3.0..3.0) };
        State { q, qd, qdd: random.array(-10.0..10.0) }
    };
    (0..count).map(state).collect()
}

/// Makes `q` a unit vector, and its derivatives those of one: `q·q̇ = 0`, `q·q̈ = −q̇·q̇`. Zero becomes the first axis.
pub fn onto_the_sphere(q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length = dot(q, q).sqrt();
    if length == 0.0 {
        q[0] = 1.0;
    } else {
        q.iter_mut().for_each(|c| *c /= length);
    }
    let along = dot(q, qd);
    qd.iter_mut().zip(&*q).for_each(|(v, c)| *v -= along * c);
    let along = dot(q, qdd) + dot(qd, qd);
    qdd.iter_mut().zip(&*q).for_each(|(a, c)| *a -= along * c);
}

/// Positive numbers for masses, lengths and the like, in 0.2..3.
pub fn positive<const N: usize>(seed: u64) -> [f64; N] {
    let mut random = Random::new(seed);
    from_fn(|_| random.uniform(0.2..3.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first outputs for seed 1234567 that are published with the algorithm (Rosetta Code, "Pseudo-random
    /// numbers/Splitmix64"), hence the stream is the same as everyone's.
    #[test]
    fn stream_is_splitmix64() {
        let mut random = Random::new(1_234_567);
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(published.map(|_| random.bits()), published);
    }

    #[test]
    fn uniform_covers_its_range() {
        let mut random = Random::new(1);
        let values: Vec<f64> = (0..1000).map(|_| random.uniform(-2.0..6.0)).collect();
        assert!(values.iter().all(|value| (-2.0..6.0).contains(value)));
        assert!(values.iter().any(|&value| value < -1.9) && values.iter().any(|&value| value > 5.9));
        // Standard deviation of the mean is 8/√12/√1000 = 0.073: five of them.
        assert!((values.iter().sum::<f64>() / 1000.0 - 2.0).abs() < 0.37);
    }

    #[test]
    fn states_hold_every_posture_moving_and_at_rest() {
        let states = states::<3>(7, 84);
        let straight = |state: &State<3>| state.q[0] != 0.0 && state.q[1..] == [0.0, 0.0];
        let aligned = |state: &State<3>| state.q[0] != 0.0 && state.q.iter().all(|&angle| angle == state.q[0]);
        let at_zero = |state: &State<3>| state.q == [0.0; 3];
        for posture in [straight, aligned, at_zero] {
            assert!(states.iter().any(|state| posture(state) && state.qd == [0.0; 3]));
            assert!(states.iter().any(|state| posture(state) && state.qd != [0.0; 3]));
        }
        assert_eq!(states, super::states::<3>(7, 84));
        assert_ne!(states, super::states::<3>(8, 84));
    }
}
