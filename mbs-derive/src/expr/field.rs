//! Three prime fields, their arithmetic, and the circle in each of them.
//!
//! Found as the first primes below 2⁶¹ of this form, by trial of n downwards: `p = 720 n − 1` with n and
//! `h = (p − 1)/2` prime as well (Miller–Rabin with the first twelve primes as bases decides below 2⁶⁴; Sorenson and
//! Webster, *Strong pseudoprimes to twelve prime bases*, Mathematics of Computation 86, 2017).

/// A field, and points of its circle.
struct Field {
    /// The size of the field, `720 n − 1`, with which `h = (p − 1)/2` is prime as well.
    p: u64,
    /// A point of order n.
    circle: (u64, u64),
    /// A point of order 720 whose multiples are 90° = (0, 1), 45° = (√2, √2)/2, 60° = (1, √3)/2, and 36° with the
    /// cosine (1 + √5)/4; the first that is found among the n-th powers of `((1 − t²)/(1 + t²), 2t/(1 + t²))`.
    half_degree: (u64, u64),
}

/// How many fields there are.
pub(crate) const FIELDS: usize = 3;

const ALL: [Field; FIELDS] = [
    Field {
        p: 2_305_843_009_208_591_759,
        circle: (1_733_659_751_054_248_685, 761_210_962_574_323_124),
        half_degree: (1_964_450_089_492_106_191, 2_259_175_976_771_650_554),
    },
    Field {
        p: 2_305_843_009_207_890_479,
        circle: (1_718_969_204_003_166_294, 192_908_251_710_863_377),
        half_degree: (1_410_380_946_736_960_010, 601_431_223_218_329_537),
    },
    Field {
        p: 2_305_843_009_197_666_479,
        circle: (490_095_351_787_617_916, 417_175_859_095_411_660),
        half_degree: (931_411_003_213_750_471, 626_697_950_588_764_280),
    },
];

/// The base of exponentials, of order h: a square.
pub(super) const BASE: u64 = 4;

/// A power of a fixed base is a product of one entry for each of this many digits of four bits.
const DIGITS: usize = 16;

type Powers<T> = [[T; 16]; DIGITS];

/// Arithmetic modulo p of one of the fields.
pub(super) struct Prime<const K: usize>;

impl<const K: usize> Prime<K> {
    /// The size of the field.
    pub(super) const P: u64 = ALL[K].p;
    /// The order of a point of the circle whose powers are angles: prime.
    pub(super) const N: u64 = (Self::P + 1) / 720;
    /// The order of the base of exponentials: prime.
    pub(super) const H: u64 = (Self::P - 1) / 2;
    pub(super) const CIRCLE: (u64, u64) = ALL[K].circle;
    pub(super) const HALF_DEGREE: (u64, u64) = ALL[K].half_degree;

    const ANGLES: Powers<(u64, u64)> = {
        let mut table = [[(1, 0); 16]; DIGITS];
        let mut base = Self::CIRCLE;
        let mut digit = 0;
        while digit < DIGITS {
            let mut entry = 1;
            while entry < 16 {
                table[digit][entry] = Self::multiplied(table[digit][entry - 1], base);
                entry += 1;
            }
            base = Self::multiplied(table[digit][15], base);
            digit += 1;
        }
        table
    };

    const EXPONENTIALS: Powers<u64> = {
        let mut table = [[1; 16]; DIGITS];
        let mut base = BASE;
        let mut digit = 0;
        while digit < DIGITS {
            let mut entry = 1;
            while entry < 16 {
                table[digit][entry] = Self::times(table[digit][entry - 1], base);
                entry += 1;
            }
            base = Self::times(table[digit][15], base);
            digit += 1;
        }
        table
    };

    /// `2⁶¹ ≡ 2⁶¹ − p`, which is small.
    pub(super) const fn times(a: u64, b: u64) -> u64 {
        const LOW: u128 = (1 << 61) - 1;
        let fold = (1 << 61) - Self::P;
        let product = a as u128 * b as u128;
        let once = (product & LOW) + (product >> 61) * fold as u128;
        let twice = (once & LOW) as u64 + (once >> 61) as u64 * fold;
        if twice >= Self::P { twice - Self::P } else { twice }
    }

    pub(super) fn raised(base: u64, mut exponent: u64) -> u64 {
        let (mut result, mut square) = (1, base);
        while exponent > 0 {
            if exponent % 2 == 1 {
                result = Self::times(result, square);
            }
            square = Self::times(square, square);
            exponent /= 2;
        }
        result
    }

    /// Of a number that is not zero.
    pub(super) fn inverted(a: u64) -> u64 {
        inverse(a, Self::P)
    }

    /// The one of `a` and `−a` that is below p/2, and whether that is not `a`.
    pub(super) fn sign(a: u64) -> (u64, bool) {
        if a > Self::P / 2 { (Self::P - a, true) } else { (a, false) }
    }

    /// The root that is a square, of a square: `p ≡ 3 (mod 4)`.
    pub(super) fn root(a: u64) -> Option<u64> {
        let root = Self::raised(a, Self::P.div_ceil(4));
        (Self::times(root, root) == a).then_some(root)
    }

    /// A function without a law, another one for each tag.
    pub(super) fn any(tag: u64, a: u64) -> u64 {
        mixed(mixed(a) ^ tag) % Self::P
    }

    /// An odd function, another one for each tag.
    pub(super) fn odd(tag: u64, a: u64) -> u64 {
        let (size, is_negative) = Self::sign(a);
        let image = if size == 0 { 0 } else { mixed(mixed(size) ^ tag) % Self::P };
        if is_negative { negative_of(image, Self::P) } else { image }
    }

    /// Angles of two points of the circle are added.
    #[inline(always)] // four products, which a power of a point takes a hundred times
    pub(super) const fn multiplied((c, s): (u64, u64), (d, r): (u64, u64)) -> (u64, u64) {
        let (cd, sr, cr, sd) = (Self::times(c, d), Self::times(s, r), Self::times(c, r), Self::times(s, d));
        (sum(cd, negative_of(sr, Self::P), Self::P), sum(cr, sd, Self::P))
    }

    pub(super) fn power_of(point: (u64, u64), mut exponent: u64) -> (u64, u64) {
        let (mut result, mut square) = ((1, 0), point);
        while exponent > 0 {
            if exponent % 2 == 1 {
                result = Self::multiplied(result, square);
            }
            square = Self::multiplied(square, square);
            exponent /= 2;
        }
        result
    }

    /// The point of the circle with this exponent.
    pub(super) fn at_angle(exponent: u64) -> (u64, u64) {
        powers(exponent, (1, 0), const { &Self::ANGLES }, Self::multiplied)
    }

    /// The base of exponentials to this power.
    pub(super) fn exponential(exponent: u64) -> u64 {
        powers(exponent, 1, const { &Self::EXPONENTIALS }, Self::times)
    }
}

fn powers<T: Copy>(exponent: u64, one: T, table: &Powers<T>, multiplied: impl Fn(T, T) -> T) -> T {
    let digits = table.iter().enumerate().map(|(k, entries)| (exponent >> (4 * k) & 15, entries));
    digits
        .filter(|(digit, _)| *digit != 0)
        .fold(one, |product, (digit, entries)| multiplied(product, entries[digit as usize]))
}

// ---- arithmetic modulo any prime below 2⁶¹

pub(super) const fn sum(a: u64, b: u64, modulus: u64) -> u64 {
    let sum = a + b;
    if sum >= modulus { sum - modulus } else { sum }
}

pub(super) const fn negative_of(a: u64, modulus: u64) -> u64 {
    if a == 0 { 0 } else { modulus - a }
}

pub(super) fn product(a: u64, b: u64, modulus: u64) -> u64 {
    if a == 1 {
        return b;
    }
    (u128::from(a) * u128::from(b) % u128::from(modulus)) as u64
}

/// By Euclid's algorithm; 0 of 0: no angle, but the number itself may be fine.
pub(super) fn inverse(a: u64, modulus: u64) -> u64 {
    let (mut rest, mut divisor) = (modulus, a);
    // Each is a multiple of `a` modulo the prime: of these factors, of alternating sign.
    let (mut before, mut factor, mut is_negative) = (0, 1, false);
    while divisor > 1 {
        let quotient = rest / divisor;
        (rest, divisor) = (divisor, rest % divisor);
        (before, factor) = (factor, before + quotient * factor);
        is_negative = !is_negative;
    }
    if divisor == 0 {
        0
    } else if is_negative {
        modulus - factor
    } else {
        factor
    }
}

/// The finalizer of splitmix64 (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014).
pub(super) const fn mixed(key: u64) -> u64 {
    let mut z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_a_field<const K: usize>() {
        let (p, n, h) = (Prime::<K>::P, Prime::<K>::N, Prime::<K>::H);
        assert_eq!((720 * n, p % 4), (p + 1, 3));
        for prime in [p, n, h] {
            assert!((2..40).all(|base| product(base, inverse(base, prime), prime) == 1));
            let reciprocals = (2..40).map(mixed).map(|a| a % prime).filter(|&a| a != 0);
            assert!(reciprocals.into_iter().all(|a| product(a, inverse(a, prime), prime) == 1));
        }
        let (circle, half) = (Prime::<K>::CIRCLE, Prime::<K>::HALF_DEGREE);
        assert_eq!((Prime::<K>::power_of(circle, n), Prime::<K>::power_of(half, 180)), ((1, 0), (0, 1)));
        assert_eq!(Prime::<K>::raised(BASE, h), 1);
        assert_eq!(Prime::<K>::times(p - 1, p - 1), 1);
        let (half_of, at) = (inverse(2, p), |count: u64| Prime::<K>::power_of(half, count));
        let root = |a: u64| Prime::<K>::raised(a, p.div_ceil(4));
        assert_eq!(at(90), (Prime::<K>::times(root(2), half_of), Prime::<K>::times(root(2), half_of)));
        assert_eq!(at(120).1, Prime::<K>::times(root(3), half_of));
        assert_eq!(at(72).0, Prime::<K>::times(1 + root(5), inverse(4, p)));
        for exponent in (0..50).map(mixed).chain([0, 1, 15, 16]) {
            assert_eq!(Prime::<K>::at_angle(exponent % n), Prime::<K>::power_of(circle, exponent % n));
            assert_eq!(Prime::<K>::exponential(exponent % h), Prime::<K>::raised(BASE, exponent % h));
        }
    }

    #[test]
    fn the_three_are_fields() {
        is_a_field::<0>();
        is_a_field::<1>();
        is_a_field::<2>();
        assert_eq!(inverse(0, Prime::<0>::P), 0);
    }
}
