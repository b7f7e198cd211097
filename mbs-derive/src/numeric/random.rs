//! Random numbers, the same in every process.

/// A source of random numbers: splitmix64 (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Always the same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// Uniform in (−1, 1).
    pub fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// `count` of them, times `scale`.
    pub fn vector(&mut self, count: usize, scale: f64) -> Vec<f64> {
        (0..count).map(|_| scale * self.symmetric()).collect()
    }

    /// The parameters near their defaults, so that nothing is proved that holds for the defaults alone.
    pub fn parameters_near(&mut self, defaults: &[f64]) -> Vec<f64> {
        let varied = |&default: &f64| match default {
            0.0 => 0.2 * self.symmetric(),
            value => value * (1.0 + 0.2 * self.symmetric()),
        };
        defaults.iter().map(varied).collect()
    }
}
