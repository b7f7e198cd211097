//! Points of the unit cube, each a function of seed and index alone.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use sobol::Sobol;
use sobol::params::JoeKuoD6;

/// How points fill the cube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Independent points.
    #[default]
    Random,
    /// In each dimension one point in each of as many intervals as there are points.
    LatinHypercube,
    /// Sobol's sequence, shifted at random.
    Sobol,
    /// Rows of points between which one coordinate changes, for Sobol' indices: see
    /// [`sensitivity`](crate::statistics::sensitivity).
    Saltelli,
    /// Gauss' rules, each value of a variable with each of the others: see [`chaos`](crate::statistics::chaos). It is
    /// no sequence: the points are those of the distributions.
    Chaos,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Kind; 5] = [Kind::Random, Kind::LatinHypercube, Kind::Sobol, Kind::Saltelli, Kind::Chaos];

    /// As a plan writes it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Random => "random",
            Kind::LatinHypercube => "latin-hypercube",
            Kind::Sobol => "sobol",
            Kind::Saltelli => "saltelli",
            Kind::Chaos => "chaos",
        }
    }
}

/// What a stream of random numbers is for: a seed has one for each purpose and index, and none overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The values of a member.
    Values,
    /// What happens during its motion.
    Motion,
    /// What all members share.
    Whole,
}

/// Random numbers that depend on seed, purpose and index alone.
///
/// ```
/// use mbs_ensemble::sequence::{Purpose, random};
/// use chacha20::rand_core::Rng;
/// assert_eq!(random(1, Purpose::Motion, 7).next_u64(), random(1, Purpose::Motion, 7).next_u64());
/// assert_ne!(random(1, Purpose::Motion, 7).next_u64(), random(1, Purpose::Motion, 8).next_u64());
/// ```
pub fn random(seed: u64, purpose: Purpose, index: u64) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8] = match purpose {
        Purpose::Values => 0,
        Purpose::Motion => 1,
        Purpose::Whole => 2,
    };
    let mut random = ChaCha8Rng::from_seed(key);
    random.set_stream(index);
    random
}

/// 52 bits as a number within 0 and 1, both excluded: the middle of one of 2⁵² intervals.
pub(crate) fn unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// Points of the unit cube.
#[derive(Clone, Debug)]
pub struct Sequence {
    seed: u64,
    points: u64,
    dimensions: usize,
    method: Method,
}

#[derive(Clone, Debug)]
enum Method {
    Random,
    LatinHypercube {
        /// What decides on the order of the intervals, in each dimension.
        keys: Vec<u64>,
    },
    Sobol {
        /// Of each dimension one for each bit of the index.
        directions: Vec<Vec<u64>>,
        shifts: Vec<u64>,
        /// Whether a point is a row of them.
        is_in_rows: bool,
    },
}

impl Sequence {
    /// The most dimensions of Sobol's sequence.
    pub const MOST_DIMENSIONS: usize = 1000;

    /// How many points a row has, of this many dimensions.
    pub fn row(kind: Kind, dimensions: usize) -> u64 {
        if kind == Kind::Saltelli { dimensions as u64 + 2 } else { 1 }
    }

    /// This many points, or rows of points; `None` where Sobol's sequence has not as many dimensions. A hypercube has
    /// one point at least, and behind its points begins another.
    pub fn new(kind: Kind, seed: u64, points: u64, dimensions: usize) -> Option<Self> {
        let mut whole = random(seed, Purpose::Whole, 0);
        let of_sobol = if kind == Kind::Saltelli { 2 * dimensions } else { dimensions };
        let mut words = || (0..of_sobol).map(|_| whole.next_u64()).collect();
        let method = match kind {
            Kind::Random | Kind::Chaos => Method::Random,
            Kind::LatinHypercube => Method::LatinHypercube { keys: words() },
            Kind::Sobol | Kind::Saltelli if of_sobol > Self::MOST_DIMENSIONS => return None,
            Kind::Sobol | Kind::Saltelli => {
                let parameters = if of_sobol <= 100 { JoeKuoD6::minimal() } else { JoeKuoD6::standard() };
                let directions = Sobol::<f64>::init_direction_vals(of_sobol, 52, &parameters);
                Method::Sobol { directions, shifts: words(), is_in_rows: kind == Kind::Saltelli }
            }
        };
        Some(Sequence { seed, points, dimensions, method })
    }

    /// The point with this index, each coordinate within 0 and 1, both excluded.
    pub fn point(&self, index: u64) -> Vec<f64> {
        match &self.method {
            Method::Random => {
                let mut random = random(self.seed, Purpose::Values, index);
                (0..self.dimensions).map(|_| unit(random.next_u64())).collect()
            }
            Method::LatinHypercube { keys } => {
                let mut random = random(self.seed, Purpose::Values, index);
                let points = self.points.max(1);
                let (turn, place) = (index / points, index % points);
                let within = |key: &u64| {
                    let interval = permuted(place, points, key.wrapping_add(turn)) as f64;
                    (interval + unit(random.next_u64())) / points as f64
                };
                // Where the quotient is rounded up to 1 it is not within the cube.
                keys.iter().map(within).map(|x| x.min(1.0 - f64::EPSILON / 2.0)).collect()
            }
            Method::Sobol { directions, shifts, is_in_rows: false } => sobol(directions, shifts, index),
            Method::Sobol { directions, shifts, is_in_rows: true } => {
                let row = Self::row(Kind::Saltelli, self.dimensions);
                let mut a = sobol(directions, shifts, index / row);
                let b = a.split_off(self.dimensions);
                match (index % row) as usize {
                    0 => a,
                    1 => b,
                    changed => {
                        a[changed - 2] = b[changed - 2];
                        a
                    }
                }
            }
        }
    }
}

/// A point of Sobol's sequence: of the bits of the index in Gray's code each adds its direction.
fn sobol(directions: &[Vec<u64>], shifts: &[u64], index: u64) -> Vec<f64> {
    let gray = index ^ (index >> 1);
    let coordinate = |(directions, shift): (&Vec<u64>, &u64)| {
        let bits = directions.iter().enumerate().filter(|(bit, _)| gray >> bit & 1 == 1);
        unit(bits.fold(*shift, |sum, (_, direction)| sum ^ direction))
    };
    directions.iter().zip(shifts).map(coordinate).collect()
}

/// Where `index` goes in the permutation of `0..count` that belongs to a key: without a table, so that memory does not
/// grow with the count. The index is below the count.
///
/// A Feistel network of four rounds permutes the next even power of two; who lands outside walks on.
///
/// Source: J. Black and P. Rogaway, *Ciphers with arbitrary finite domains*, CT-RSA 2002, section 3.
fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let half = (64 - count.saturating_sub(1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1_u64 << half) - 1;
    let mut place = index;
    loop {
        let (mut left, mut right) = (place >> half, place & mask);
        for round in 0..4 {
            (left, right) = (right, left ^ (mixed(right ^ key.rotate_left(16 * round)) & mask));
        }
        place = left << half | right;
        if place < count {
            return place;
        }
    }
}

/// A function of 64 bits whose results look random.
///
/// Source: D. Stafford, *Better bit mixing*, 2011, variant 13, the finalizer of SplitMix64.
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_are_permutations() {
        for count in [1, 2, 3, 7, 64, 1000] {
            let mut places: Vec<u64> = (0..count).map(|i| permuted(i, count, 12345)).collect();
            places.sort_unstable();
            assert_eq!(places, (0..count).collect::<Vec<_>>());
        }
        let order = |key| (0..100).map(|i| permuted(i, 100, key)).collect::<Vec<_>>();
        assert_ne!(order(1), order(2));
    }

    #[test]
    fn a_hypercube_has_one_point_in_each_interval() {
        let sequence = Sequence::new(Kind::LatinHypercube, 7, 50, 3).unwrap();
        for dimension in 0..3 {
            let intervals = |from: u64| -> Vec<u64> {
                (from..from + 50).map(|i| (50.0 * sequence.point(i)[dimension]) as u64).collect()
            };
            assert_ne!(intervals(0), intervals(50), "another hypercube, in another order");
            for from in [0, 50, 5000] {
                let mut intervals = intervals(from);
                intervals.sort_unstable();
                assert_eq!(intervals, (0..50).collect::<Vec<_>>());
            }
        }
        let none = Sequence::new(Kind::LatinHypercube, 1, 0, 1).unwrap().point(0);
        assert!(none[0] > 0.0 && none[0] < 1.0);
    }

    /// The first points as Joe and Kuo's own program prints them, in the same order, but shifted.
    #[test]
    fn sobol_is_that_of_joe_and_kuo() {
        let mut sequence = Sequence::new(Kind::Sobol, 0, 8, 3).unwrap();
        let Method::Sobol { shifts, .. } = &mut sequence.method else { panic!("another method") };
        shifts.fill(0);
        let half = 0.5 / (1_u64 << 52) as f64;
        let points: Vec<Vec<f64>> = (0..6).map(|i| sequence.point(i).into_iter().map(|x| x - half).collect()).collect();
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
        ];
        assert_eq!(points, expected.map(|point| point.to_vec()));
    }

    /// Each of the 2ⁿ boxes of volume 2⁻ⁿ of two first coordinates has one point, and a shift does not change that.
    #[test]
    fn shifted_sobol_points_are_a_net() {
        let sequence = Sequence::new(Kind::Sobol, 99, 64, 2).unwrap();
        let mut boxes: Vec<(u64, u64)> =
            (0..64).map(|i| sequence.point(i)).map(|x| ((8.0 * x[0]) as u64, (8.0 * x[1]) as u64)).collect();
        boxes.sort_unstable();
        boxes.dedup();
        assert_eq!(boxes.len(), 64);
    }

    #[test]
    fn in_a_row_one_coordinate_changes() {
        let sequence = Sequence::new(Kind::Saltelli, 5, 4, 3).unwrap();
        let row: Vec<Vec<f64>> = (10..15).map(|index| sequence.point(index)).collect();
        for i in 0..3 {
            let expected: Vec<f64> = (0..3).map(|j| row[usize::from(i == j)][j]).collect();
            assert_eq!(row[2 + i], expected);
            assert_ne!(row[0][i], row[1][i]);
        }
    }

    #[test]
    fn random_points_fill_the_cube() {
        let sequence = Sequence::new(Kind::Random, 3, 4000, 2).unwrap();
        let points: Vec<Vec<f64>> = (0..4000).map(|i| sequence.point(i)).collect();
        for dimension in 0..2 {
            let mean = points.iter().map(|x| x[dimension]).sum::<f64>() / 4000.0;
            // Four deviations of the mean.
            assert!((mean - 0.5).abs() < 4.0 / (12.0_f64 * 4000.0).sqrt(), "{mean}");
        }
        assert_eq!(Sequence::new(Kind::Random, 3, 10, 2).unwrap().point(3), points[3], "whatever their number");
    }
}
