//! Numbers that count what is done to them: what a formula costs is found by running it.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::Scalar;

/// What was done to [`Counted`] numbers. A subtraction is an addition, a negation is free, and so is a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Additions and subtractions.
    pub add: usize,
    /// Multiplications.
    pub mul: usize,
    /// Divisions.
    pub div: usize,
    /// Sines, cosines, and pairs of them.
    pub sincos: usize,
    /// Square roots and other functions.
    pub other: usize,
}

impl Counts {
    /// `add + mul`
    pub fn flops(self) -> usize {
        self.add + self.mul
    }

    /// In units of an addition: a division 4, a function 20.
    pub fn weight(self) -> usize {
        self.flops() + 4 * self.div + 20 * (self.sincos + self.other)
    }
}

thread_local! {
    static DONE: Cell<Counts> = const { Cell::new(Counts { add: 0, mul: 0, div: 0, sincos: 0, other: 0 }) };
}

/// What `work` returns, and what it did to [`Counted`] numbers in this thread.
pub fn counted<R>(work: impl FnOnce() -> R) -> (R, Counts) {
    DONE.set(Counts::default());
    let result = work();
    (result, DONE.get())
}

fn count(change: impl FnOnce(&mut Counts)) {
    let mut done = DONE.get();
    change(&mut done);
    DONE.set(done);
}

/// A double that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted(pub f64);

macro_rules! operators {
    ($($operator:ident $method:ident $counter:ident),*) => {$(
        impl $operator for Counted {
            type Output = Counted;
            fn $method(self, other: Counted) -> Counted {
                count(|done| done.$counter += 1);
                Counted(self.0.$method(other.0))
            }
        }
    )*};
}
operators!(Add add add, Sub sub add, Mul mul mul, Div div div);

impl Neg for Counted {
    type Output = Counted;
    fn neg(self) -> Counted {
        Counted(-self.0)
    }
}

macro_rules! functions {
    ($counter:ident: $($name:ident),*) => {$(
        fn $name(self) -> Counted {
            count(|done| done.$counter += 1);
            Counted(Scalar::$name(self.0))
        }
    )*};
}

impl Scalar for Counted {
    type Mask = bool;

    fn from_f64(value: f64) -> Counted {
        Counted(value)
    }

    functions!(sincos: sin, cos);
    functions!(other: tan, asin, acos, atan, sinh, cosh, tanh, sech, exp, ln, sqrt, abs, signum);

    fn sin_cos(self) -> (Counted, Counted) {
        count(|done| done.sincos += 1);
        (Counted(self.0.sin()), Counted(self.0.cos()))
    }

    fn atan2(self, x: Counted) -> Counted {
        count(|done| done.other += 1);
        Counted(self.0.atan2(x.0))
    }

    fn powf(self, exponent: Counted) -> Counted {
        count(|done| done.other += 1);
        Counted(self.0.powf(exponent.0))
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    fn less(self, other: Counted) -> bool {
        self.0 < other.0
    }

    fn less_equal(self, other: Counted) -> bool {
        self.0 <= other.0
    }

    fn equal(self, other: Counted) -> bool {
        self.0 == other.0
    }

    fn blend(mask: bool, then: Counted, otherwise: Counted) -> Counted {
        if mask { then } else { otherwise }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_counted_once() {
        let [x, y] = [0.5, 2.0].map(Counted);
        let (value, counts) = counted(|| -(x.mul_add(y, x) - y / x) * y.sqrt() + x.sin_cos().0 * x.cos());
        assert_eq!(value.0, -(1.5 - 4.0) * 2.0_f64.sqrt() + 0.5_f64.sin() * 0.5_f64.cos());
        assert_eq!(counts, Counts { add: 3, mul: 3, div: 1, sincos: 2, other: 1 });
        assert_eq!((counts.flops(), counts.weight()), (6, 70));
        assert_eq!(counted(|| ()).1, Counts::default());
    }
}
