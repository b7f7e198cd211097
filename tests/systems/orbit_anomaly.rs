//! Anomalies against 256 bits: the error is a few times what one unit in the last place of the anomaly given would
//! change.

use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use mbs_models::Failure;
use mbs_orbit::anomaly;
use mbs_tests::random::Random;

/// A number of 256 bits.
#[derive(Clone, Debug)]
struct Precise(BigFloat);

const BITS: usize = 256;
const ROUNDING: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory for constants"));
}

impl From<f64> for Precise {
    fn from(x: f64) -> Self {
        Self(BigFloat::from_f64(x, BITS))
    }
}

macro_rules! operators {
    ($($operator:ident $name:ident),*) => { $(impl<T: Into<Precise>> $operator<T> for &Precise {
        type Output = Precise;
        fn $name(self, other: T) -> Precise {
            Precise(self.0.$name(&other.into().0, BITS, ROUNDING))
        }
    }
    impl<T: Into<Precise>> $operator<T> for Precise {
        type Output = Precise;
        fn $name(self, other: T) -> Precise {
            (&self).$name(other)
        }
    })* };
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl From<&Precise> for Precise {
    fn from(x: &Precise) -> Self {
        x.clone()
    }
}

impl Neg for Precise {
    type Output = Precise;
    fn neg(self) -> Precise {
        Precise(self.0.neg())
    }
}

macro_rules! functions {
    ($($name:ident),*) => { impl Precise { $(fn $name(&self) -> Self {
        CONSTANTS.with_borrow_mut(|constants| Self(self.0.$name(BITS, ROUNDING, constants)))
    })* } };
}
functions!(sin, cos, tan, atan, sinh, cosh, tanh);

impl Precise {
    fn pi() -> Self {
        CONSTANTS.with_borrow_mut(|constants| Self(constants.pi(BITS, ROUNDING)))
    }

    fn sqrt(&self) -> Self {
        Self(self.0.sqrt(BITS, ROUNDING))
    }

    fn cube(&self) -> Self {
        self * self * self
    }

    /// To 64 bits, which is enough for an error.
    fn to_f64(&self) -> f64 {
        let Some((words, _, sign, exponent, _)) = self.0.as_raw_parts() else { return f64::NAN };
        if self.0.is_zero() {
            return 0.0;
        }
        let size = *words.last().expect("a word") as f64 * 2_f64.powi(-64) * 2_f64.powi(exponent);
        if sign == Sign::Neg { -size } else { size }
    }
}

/// The unit in the last place.
fn unit(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

/// Whole turns of an angle, so that at most half a turn is left.
fn turns(angle: &Precise) -> Precise {
    let whole = Precise::pi() * 2.0 * (angle.to_f64() / (2.0 * PI)).round();
    let rest = angle - &whole;
    // Next to an odd multiple of π the quotient is rounded to the half, and that to either side.
    if (&rest - Precise::pi()).to_f64() > 0.0 {
        whole + Precise::pi() * 2.0
    } else if (rest + Precise::pi()).to_f64() < 0.0 {
        whole - Precise::pi() * 2.0
    } else {
        whole
    }
}

/// `tan(b/2) = k tan(a/2)`, whole turns kept.
fn half_angle(k: &Precise, a: &Precise) -> Precise {
    let whole = turns(a);
    let half = ((a - &whole) / 2.0).tan();
    whole + (k * half).atan() * 2.0
}

/// What belongs together on a conic, and the changes that one radian of the mean anomaly makes.
struct Place {
    mean: Precise,
    eccentric: Precise,
    true_anomaly: Precise,
    eccentric_by_mean: f64,
    true_by_eccentric: f64,
}

impl Place {
    fn of_eccentric(e: f64, x: Precise) -> Self {
        let one = Precise::from(1.0);
        let e = Precise::from(e);
        let (ratio, root) = (((&e + 1.0) / (&e - 1.0)), ((&e + 1.0) * (&e - 1.0)));
        let [mean, true_anomaly, r, root] = match e.to_f64() {
            small if small < 1.0 => {
                [&x - &e * x.sin(), half_angle(&(-ratio).sqrt(), &x), one - &e * x.cos(), (-root).sqrt()]
            }
            large if large > 1.0 => {
                let half = (&x / 2.0).tanh();
                [&e * x.sinh() - &x, (ratio.sqrt() * half).atan() * 2.0, e * x.cosh() - 1.0, root.sqrt()]
            }
            // D + D³/3, and dν/dD = 2/(1 + D²).
            _ => [&x + x.cube() / 3.0, x.atan() * 2.0, one + &x * &x, Precise::from(2.0)],
        };
        let (eccentric_by_mean, true_by_eccentric) = (1.0 / r.to_f64(), (root / r).to_f64());
        Self { mean, eccentric: x, true_anomaly, eccentric_by_mean, true_by_eccentric }
    }

    /// By Newton's method from a place nearby; `None` where that is too far off.
    fn of_mean(e: f64, mean: f64, guess: f64) -> Option<Self> {
        let mut place = Self::of_eccentric(e, guess.into());
        for _ in 0..40 {
            let left = place.mean.clone() - mean;
            let change = (&left * place.eccentric_by_mean).to_f64();
            if left.to_f64() == 0.0 || change.abs() <= 1e-30 * guess.abs() {
                return Some(place);
            }
            let next = place.eccentric.clone() - left * place.eccentric_by_mean;
            place = Self::of_eccentric(e, next);
        }
        None
    }
}

/// In units of what rounding of the argument and of the result explains; the greatest error found is 1.8.
fn check(found: f64, expected: &Precise, explained: f64, what: &str) {
    let error = (expected.clone() - found).to_f64().abs();
    let error = if error == 0.0 { 0.0 } else { error / (explained + unit(found)) };
    assert!(error <= 3.0, "{what}: {found} is off by {error} times what rounding explains");
}

fn check_mean(e: f64, mean: f64) {
    let what = format!("e = {e:?}, mean anomaly {mean:?}");
    let eccentric = anomaly::eccentric_from_mean(e, mean).unwrap();
    let place = Place::of_mean(e, mean, eccentric).unwrap_or_else(|| panic!("{what}: {eccentric} is far off"));
    let explained = unit(mean) * place.eccentric_by_mean;
    check(eccentric, &place.eccentric, explained, &what);
    let explained = (explained + unit(eccentric)) * place.true_by_eccentric;
    check(anomaly::true_from_mean(e, mean).unwrap(), &place.true_anomaly, explained, &what);
}

fn check_eccentric(e: f64, eccentric: f64) {
    let what = format!("e = {e:?}, anomaly in between {eccentric:?}");
    let place = Place::of_eccentric(e, eccentric.into());
    let explained = unit(eccentric) / place.eccentric_by_mean;
    let mean = anomaly::mean_from_eccentric(e, eccentric).unwrap();
    check(mean, &place.mean, explained, &what);
    let explained = unit(eccentric) * place.true_by_eccentric;
    let true_anomaly = anomaly::true_from_eccentric(e, eccentric).unwrap();
    check(true_anomaly, &place.true_anomaly, explained, &what);
}

fn check_true(e: f64, true_anomaly: f64) {
    let what = format!("e = {e:?}, true anomaly {true_anomaly:?}");
    let (less, more) = (Precise::from(e) - 1.0, Precise::from(e) + 1.0);
    let half = || (Precise::from(true_anomaly) / 2.0).tan();
    let eccentric = if e < 1.0 {
        half_angle(&(-(less / more)).sqrt(), &true_anomaly.into())
    } else if e > 1.0 {
        let tangent = (less / more).sqrt() * half();
        let ratio = (Precise::from(1.0) + &tangent) / (Precise::from(1.0) - &tangent);
        CONSTANTS.with_borrow_mut(|constants| Precise(ratio.0.ln(BITS, ROUNDING, constants)))
    } else {
        half()
    };
    let place = Place::of_eccentric(e, eccentric);
    let explained = unit(true_anomaly) / place.true_by_eccentric;
    let found = anomaly::eccentric_from_true(e, true_anomaly).unwrap();
    check(found, &place.eccentric, explained, &what);
    let explained = (explained + unit(found)) / place.eccentric_by_mean;
    let found = anomaly::mean_from_true(e, true_anomaly).unwrap();
    check(found, &place.mean, explained, &what);
}

/// As they are, and two units in the last place beside.
fn with_neighbours(x: f64) -> [f64; 5] {
    [x, x.next_up(), x.next_up().next_up(), x.next_down(), x.next_down().next_down()]
}

/// Circles, ellipses and the last ones before the parabola.
fn elliptic_eccentricities(random: &mut Random, count: usize) -> Vec<f64> {
    let near = (1..=16).map(|k| 1.0 - 10_f64.powi(-k));
    let small = (1..=20).map(|k| 10_f64.powi(-k));
    let grid = (0..count).map(|k| k as f64 / count as f64);
    let drawn = (0..count).map(|_| random.uniform(0.0..1.0));
    grid.chain(near).chain(small).chain([1e-300, 1.0_f64.next_down()]).chain(drawn.collect::<Vec<_>>()).collect()
}

/// The finding: at a mean anomaly of π a step of bisection was taken for the end of the search.
#[test]
fn half_a_turn() {
    for k in 0..10_000 {
        let e = f64::from(k) / 10_000.0;
        for half_turns in [1.0, -1.0, 3.0] {
            for mean in with_neighbours(half_turns * PI) {
                let excess = (mean - half_turns * PI) - half_turns * 1.224_646_799_147_353_2e-16;
                let expected = half_turns * PI + (half_turns * 1.224_646_799_147_353_2e-16 + excess / (1.0 + e));
                let found = anomaly::eccentric_from_mean(e, mean).unwrap();
                assert!((found - expected).abs() <= unit(expected), "e = {e}: {mean:?} to {found:?}");
            }
        }
    }
}

#[test]
fn anomalies_of_ellipses() {
    let mut random = Random::new(11);
    for e in elliptic_eccentricities(&mut random, 20) {
        let angles = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, -1.0, 31.0, 1e6].into_iter().flat_map(|k| with_neighbours(k * PI));
        let drawn: Vec<f64> = (0..12).map(|_| random.uniform(-4.0..4.0)).collect();
        let small: Vec<f64> = (0..8).map(|_| 10_f64.powf(random.uniform(-40.0..0.0))).collect();
        let large: Vec<f64> = (0..4).map(|_| 10_f64.powf(random.uniform(0.0..15.0))).collect();
        for angle in angles.chain(drawn).chain(small).chain(large) {
            check_mean(e, angle);
            check_eccentric(e, angle);
            check_true(e, angle);
        }
    }
}

#[test]
fn anomalies_of_hyperbolas_and_of_parabolas() {
    let mut random = Random::new(12);
    let mut eccentricities: Vec<f64> = (1..=15).map(|k| 1.0 + 10_f64.powi(-k)).collect();
    eccentricities.extend([1.0, 1.0_f64.next_up(), 1.5, 2.0, 5.0, 1e3, 1e8, 1e100]);
    eccentricities.extend((0..30).map(|_| random.uniform(1.0..6.0)));
    for e in eccentricities {
        let limit = (-1.0 / e).acos().min(PI - 2.0 * ((e - 1.0) / (e + 1.0)).sqrt().atan());
        for _ in 0..20 {
            check_eccentric(e, random.uniform(-30.0..30.0));
            check_eccentric(e, 10_f64.powf(random.uniform(-40.0..1.0)));
            check_mean(e, random.uniform(-30.0..30.0));
            check_mean(e, 10_f64.powf(random.uniform(-40.0..20.0)));
            check_true(e, random.uniform(-limit..limit));
            check_true(e, limit * (1.0 - 10_f64.powf(random.uniform(-12.0..0.0))));
            check_true(e, limit * 10_f64.powf(random.uniform(-40.0..0.0)));
        }
    }
}

/// Numbers so large that their squares are not: an answer, or the refusal.
#[test]
fn large_mean_anomalies() {
    for mean in [1e160, 1e200, 1e300, f64::MAX] {
        let d = anomaly::eccentric_from_mean(1.0, mean).unwrap();
        assert!((d / mean.cbrt() / 3_f64.cbrt() - 1.0).abs() < 1e-15, "{:?} {d}", d / mean.cbrt() / 3_f64.cbrt());
        let h = anomaly::eccentric_from_mean(2.0, mean).unwrap();
        assert!((h - mean.ln()).abs() < 1e-12, "{h}");
        assert_eq!(anomaly::eccentric_from_mean(0.5, mean), Ok(mean));
        assert_eq!(anomaly::mean_from_eccentric(1.0, mean), Err(Failure::OutOfRange.into()));
    }
}
