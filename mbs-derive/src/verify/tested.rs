//! The numbers in which claims are tested: doubles with bounds on their rounding errors, images in prime fields, and
//! degrees, which say how likely it is that an image is right by chance.

use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

use crate::expr::{Degree, Image, Rounded, Value};
use crate::interpret::State;
use crate::numeric::elimination::ROUNDING;

use super::claim::{Difference, Trial, doubles, doubles_of};
use super::linear::{add, times};
use super::{Failure, TOLERANCE};

/// A number in which claims are tested.
pub(crate) trait Tested:
    Value + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + Sum
{
    /// Whether of systems with constraints the entries are claimed, and not that solutions fit: off the constraints
    /// rows that depend on each other where these hold have no solution, or another one.
    const CLAIMS_SYSTEMS: bool;

    /// A number that is meant to the last digit.
    fn exact(value: f64) -> Self;

    /// What the column of this number counts where several are proved as one sum; 1 for the first.
    fn weight(round: usize) -> Self;

    /// A multiplier, for claims that are made of all.
    fn multiplier(t: Self, number: usize) -> Self;

    /// Whether it is nothing but what rounding leaves of zero.
    fn vanishes(self) -> bool;

    /// Whether it is finite, where that can be asked.
    fn is_number(self) -> bool {
        true
    }

    /// What constraints that hold to rounding alone leave open of velocities.
    fn left_open(velocities: &[Self]) -> Self;

    /// Compares component by component.
    fn compare(trial: &Trial<'_, Self>, claim: &'static str, found: &[Self], expected: &[Self]) -> Result<(), Failure>;

    /// Takes note of a claim that is not made here.
    fn pass_over(trial: &Trial<'_, Self>, claim: &'static str, components: usize) -> Result<(), Failure>;

    /// Whether accelerations are determined.
    fn accelerations_are_determined(_: &Trial<'_, Self>) -> Result<bool, Failure> {
        Ok(true)
    }

    /// `A q̈ + γ = 0`
    fn rows_of_motion(trial: &Trial<'_, Self>, a: &[Self], qdd: &[Self], bias: &[Self]) -> Result<(), Failure> {
        let rates = add(&times(a, qdd), bias);
        trial.equal("A q̈ + γ = 0", &rates, &vec![Self::default(); rates.len()])
    }

    /// Velocities that the constraints allow.
    fn allowed_velocities(trial: &Trial<'_, Self>) -> Vec<Self> {
        trial.state.qd.clone()
    }

    /// The power of constraint forces that is not zero because constraints hold to rounding alone; nothing where the
    /// motion is not one that they allow.
    fn power_left(_: &Trial<'_, Self>, _: &State<Self>, _: &[Self]) -> Option<Self> {
        Some(Self::default())
    }
}

impl Tested for Rounded {
    const CLAIMS_SYSTEMS: bool = false;

    fn exact(value: f64) -> Self {
        Rounded::exact(value)
    }

    /// Irregular and of order one, by the golden ratio.
    fn weight(round: usize) -> Self {
        Rounded::exact(1.0 + (round as f64 * 0.618_033_988_749_894_9).fract())
    }

    /// Irregular, by the golden ratio, and others at other states.
    fn multiplier(t: Self, number: usize) -> Self {
        Rounded::exact(4.0 * (t.value + 0.618_033_988_749_894_9 * number as f64).fract() - 2.0)
    }

    fn vanishes(self) -> bool {
        self.value.abs() < 1e-9
    }

    fn is_number(self) -> bool {
        self.value.is_finite()
    }

    fn left_open(velocities: &[Self]) -> Self {
        let speed = velocities.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        Rounded { value: 0.0, error: 10.0 * super::claim::CLOSED * speed }
    }

    /// To [`TOLERANCE`], or to what rounding may have done to either side.
    fn compare(trial: &Trial<'_, Self>, claim: &'static str, found: &[Self], expected: &[Self]) -> Result<(), Failure> {
        for (component, (found, expected)) in found.iter().zip(expected).enumerate() {
            let rounding = ROUNDING * (found.error + expected.error);
            let allowed = TOLERANCE * found.value.abs().max(expected.value.abs()) + rounding;
            // Where the witness itself is 0/0 (a derivative at a corner), or all rounding, it says nothing; but where
            // it is a number, what is none disagrees.
            let silent = !(expected.value.is_finite() && expected.error.is_finite())
                || found.value.is_finite() && !found.error.is_finite();
            let agrees = (found.value - expected.value).abs() <= allowed;
            if !agrees && !silent {
                return Err(Failure::Disagreement {
                    claim,
                    component,
                    found: found.value,
                    expected: expected.value,
                    state: Box::new(doubles(trial.state)),
                    parameters: doubles_of(trial.parameters),
                });
            }
        }
        Ok(())
    }

    fn pass_over(_: &Trial<'_, Self>, _: &'static str, _: usize) -> Result<(), Failure> {
        Ok(())
    }

    fn accelerations_are_determined(trial: &Trial<'_, Self>) -> Result<bool, Failure> {
        trial.accelerations_are_determined()
    }

    fn rows_of_motion(trial: &Trial<'_, Self>, a: &[Self], qdd: &[Self], bias: &[Self]) -> Result<(), Failure> {
        trial.rows_of_motion(a, qdd, bias)
    }

    fn allowed_velocities(trial: &Trial<'_, Self>) -> Vec<Self> {
        trial.allowed_velocities().unwrap_or_else(|| vec![Rounded::exact(f64::NAN); trial.n()])
    }

    fn power_left(trial: &Trial<'_, Self>, free: &State<Self>, multipliers: &[Self]) -> Option<Self> {
        trial.power_left(free, multipliers)
    }
}

/// Numbers of which the differences are taken down.
macro_rules! taken_down {
    () => {
        const CLAIMS_SYSTEMS: bool = true;

        fn compare(
            trial: &Trial<'_, Self>,
            claim: &'static str,
            found: &[Self],
            expected: &[Self],
        ) -> Result<(), Failure> {
            let pairs = found.iter().zip(expected).enumerate();
            let left =
                pairs.map(|(component, (&found, &expected))| trial.difference(claim, component, found - expected));
            trial.differences.borrow_mut().extend(left);
            Ok(())
        }

        fn pass_over(trial: &Trial<'_, Self>, claim: &'static str, components: usize) -> Result<(), Failure> {
            let none = |component| Difference { is_made: false, ..trial.difference(claim, component, Self::default()) };
            trial.differences.borrow_mut().extend((0..components).map(none));
            Ok(())
        }

        fn left_open(_: &[Self]) -> Self {
            Self::default()
        }
    };
}

impl<const K: usize> Tested for Image<K> {
    fn exact(value: f64) -> Self {
        Image::constant(value)
    }

    fn weight(round: usize) -> Self {
        if round == 0 { Image::constant(1.0) } else { Image::random(0x7765_0000_0000 + round as u64) }
    }

    fn multiplier(_: Self, number: usize) -> Self {
        Image::random(0x6c61_0000_0000 + number as u64)
    }

    fn vanishes(self) -> bool {
        self.is_zero()
    }

    taken_down!();
}

impl Tested for Degree {
    fn exact(value: f64) -> Self {
        Degree::constant(value)
    }

    fn weight(round: usize) -> Self {
        if round == 0 { Degree::constant(1.0) } else { Degree::symbol(0x7765_0000_0000 + round as u64) }
    }

    fn multiplier(_: Self, number: usize) -> Self {
        Degree::symbol(0x6c61_0000_0000 + number as u64)
    }

    fn vanishes(self) -> bool {
        true
    }

    taken_down!();
}
