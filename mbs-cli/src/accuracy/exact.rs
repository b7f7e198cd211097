//! Numbers of 200 bits, over which expressions and Programs are evaluated like over doubles.

use std::cell::RefCell;
use std::hash::{DefaultHasher, Hash, Hasher};

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use mbs_derive::expr::{Binary, Function, Number, Value};

const PRECISION: usize = 200;
const NEAREST: RoundingMode = RoundingMode::ToEven;

/// A number of 200 bits: its place in the arena of its thread, because evaluation copies numbers and these have a heap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact(u32);

struct Arena {
    values: Vec<BigFloat>,
    constants: Consts,
    /// How constants and the values of functions are rounded, if they are.
    roundings: Option<u64>,
}

thread_local! {
    static ARENA: RefCell<Arena> =
        RefCell::new(Arena { values: Vec::new(), constants: Consts::new().expect("memory for constants"), roundings: None });
}

/// What `compute` returns; the numbers that are made in it are forgotten.
pub(crate) fn forgetting<T>(compute: impl FnOnce() -> T) -> T {
    let before = ARENA.with_borrow(|arena| arena.values.len());
    let result = compute();
    ARENA.with_borrow_mut(|arena| arena.values.truncate(before));
    result
}

/// What `compute` returns where constants, and the values of sines, roots and other functions, are rounded to doubles,
/// up or down, each always in the same way.
pub(crate) fn rounding<T>(roundings: u64, compute: impl FnOnce() -> T) -> T {
    ARENA.with_borrow_mut(|arena| arena.roundings = Some(roundings));
    let result = compute();
    ARENA.with_borrow_mut(|arena| arena.roundings = None);
    result
}

impl Exact {
    /// Rounded, where values are: by what says which value it is.
    fn rounded(self, what: impl Hash) -> Self {
        let Some(roundings) = ARENA.with_borrow(|arena| arena.roundings) else { return self };
        let mut hasher = DefaultHasher::new();
        (roundings, what).hash(&mut hasher);
        let unit = f64::EPSILON / 2.0;
        self.add(self.mul(Exact::constant(if hasher.finish().is_multiple_of(2) { unit } else { -unit })))
    }

    /// `value (1 + relative)`
    pub(crate) fn perturbed(value: f64, relative: f64) -> Self {
        let value = Exact::constant(value);
        value.add(value.mul(Exact::constant(relative)))
    }

    /// The nearest double, to a unit in the last place.
    pub(crate) fn to_f64(self) -> f64 {
        self.with(|x, _| {
            if x.is_inf() {
                return f64::INFINITY;
            }
            let Some((mantissa, _, sign, exponent, _)) = x.as_raw_parts() else { return f64::NAN };
            // 0.m · 2^e, the most significant word last.
            let unit = mantissa.iter().rev().take(2).fold((0.0, 1.0), |(sum, scale), &word| {
                let scale = scale * 2f64.powi(-64);
                (sum + word as f64 * scale, scale)
            });
            // In two steps, where the power alone would overflow or vanish.
            let half = exponent / 2;
            let magnitude = unit.0 * 2f64.powi(half) * 2f64.powi(exponent - half);
            if sign == Sign::Neg { -magnitude } else { magnitude }
        })
    }

    /// `|self − other|`
    pub(crate) fn distance(self, other: Exact) -> f64 {
        self.sub(other).to_f64().abs()
    }

    fn with<T>(self, f: impl FnOnce(&BigFloat, &Arena) -> T) -> T {
        ARENA.with_borrow(|arena| f(&arena.values[self.0 as usize], arena))
    }

    fn of(make: impl FnOnce(&[BigFloat], &mut Consts) -> BigFloat) -> Self {
        ARENA.with_borrow_mut(|arena| {
            let value = make(&arena.values, &mut arena.constants);
            arena.values.push(value);
            Exact(arena.values.len() as u32 - 1)
        })
    }

    fn unary(self, f: impl FnOnce(&BigFloat, &mut Consts) -> BigFloat) -> Self {
        Exact::of(|values, constants| f(&values[self.0 as usize], constants))
    }

    fn binary(self, other: Exact, f: impl FnOnce(&BigFloat, &BigFloat, &mut Consts) -> BigFloat) -> Self {
        Exact::of(|values, constants| f(&values[self.0 as usize], &values[other.0 as usize], constants))
    }

    fn order(self, other: Exact) -> Option<i128> {
        ARENA.with_borrow(|arena| arena.values[self.0 as usize].cmp(&arena.values[other.0 as usize]))
    }

    fn pi() -> Self {
        Exact::of(|_, constants| constants.pi(PRECISION, NEAREST))
    }

    fn whole_power(self, n: i32) -> Self {
        let power = self.unary(|x, _| x.powi(n.unsigned_abs() as usize, PRECISION, NEAREST));
        if n < 0 { Exact::constant(1.0).div(power) } else { power }
    }

    fn atan2(self, x: Exact) -> Self {
        let zero = Exact::constant(0.0);
        let angle = || self.div(x).call(Function::Atan);
        let is = |a: Exact, order: fn(i128) -> bool| a.order(zero).is_some_and(order);
        match (is(self, |o| o < 0), is(x, |o| o < 0), is(x, |o| o > 0)) {
            (_, _, true) => angle(),
            (false, true, _) => angle().add(Exact::pi()),
            (true, true, _) => angle().sub(Exact::pi()),
            (below, ..) if !is(self, |o| o == 0) => {
                let right = Exact::pi().div(Exact::constant(2.0));
                if below { right.neg() } else { right }
            }
            _ => zero,
        }
    }
}

impl Value for Exact {
    fn constant(value: f64) -> Self {
        Exact::of(|_, _| BigFloat::from_f64(value, PRECISION))
    }
    fn number(number: Number) -> Self {
        match number {
            Number::Exact { numerator, denominator, pi } => {
                let whole = |n: i128| Exact::of(|_, _| BigFloat::from_i128(n, PRECISION));
                let value = whole(numerator).div(whole(denominator)).mul(Exact::pi().whole_power(i32::from(pi)));
                let is_double = value.distance(Exact::constant(value.to_f64())) == 0.0;
                if is_double { value } else { value.rounded((numerator, denominator, pi)) }
            }
            Number::Real { value, rest, .. } => {
                Exact::constant(value).add(Exact::constant(rest)).rounded(value.to_bits())
            }
        }
    }
    fn neg(self) -> Self {
        self.unary(|x, _| x.neg())
    }
    fn add(self, other: Self) -> Self {
        self.binary(other, |a, b, _| a.add(b, PRECISION, NEAREST))
    }
    fn sub(self, other: Self) -> Self {
        self.binary(other, |a, b, _| a.sub(b, PRECISION, NEAREST))
    }
    fn mul(self, other: Self) -> Self {
        self.binary(other, |a, b, _| a.mul(b, PRECISION, NEAREST))
    }
    fn div(self, other: Self) -> Self {
        self.binary(other, |a, b, _| a.div(b, PRECISION, NEAREST))
    }
    fn power(self, halves: i32) -> Self {
        match halves % 2 {
            0 => self.whole_power(halves / 2),
            _ => {
                let root = self.unary(|x, _| x.sqrt(PRECISION, NEAREST));
                root.rounded(("sqrt", self.to_f64().to_bits())).whole_power(halves)
            }
        }
    }
    fn call(self, function: Function) -> Self {
        let value = self.unary(|x, c| match function {
            Function::Sin => x.sin(PRECISION, NEAREST, c),
            Function::Cos => x.cos(PRECISION, NEAREST, c),
            Function::Tan => x.tan(PRECISION, NEAREST, c),
            Function::Asin => x.asin(PRECISION, NEAREST, c),
            Function::Acos => x.acos(PRECISION, NEAREST, c),
            Function::Atan => x.atan(PRECISION, NEAREST, c),
            Function::Sinh => x.sinh(PRECISION, NEAREST, c),
            Function::Cosh => x.cosh(PRECISION, NEAREST, c),
            Function::Tanh => x.tanh(PRECISION, NEAREST, c),
            Function::Sech => x.cosh(PRECISION, NEAREST, c).reciprocal(PRECISION, NEAREST),
            Function::Exp => x.exp(PRECISION, NEAREST, c),
            Function::Ln => x.ln(PRECISION, NEAREST, c),
            Function::Abs => x.abs(),
            Function::Signum if x.is_zero() => x.clone(),
            Function::Signum => x.signum(),
        });
        match function {
            Function::Abs | Function::Signum => value,
            _ => value.rounded((function, self.to_f64().to_bits())),
        }
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        let value = match function {
            Binary::Atan2 => self.atan2(other),
            Binary::Powf => self.binary(other, |a, b, c| a.pow(b, PRECISION, NEAREST, c)),
        };
        value.rounded((function, self.to_f64().to_bits(), other.to_f64().to_bits()))
    }
    fn rate(self) -> Self {
        Exact::constant(f64::NAN)
    }
    fn less(self, other: Self) -> bool {
        self.order(other).is_some_and(|order| order < 0)
    }
    fn less_equal(self, other: Self) -> bool {
        self.order(other).is_some_and(|order| order <= 0)
    }
}
