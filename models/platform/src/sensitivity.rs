//! Sensitivity along a motion: exact derivatives of what the legs do by what describes platform and motion.
//!
//! Every [`Output`] is a length, a rate, a force or a power of a leg, or the power of all; every [`Parameter`] is one
//! of the mechanism's or one of the [`Motion`]'s. The platform follows the motion whatever the parameters are:
//!
//! ```text
//! J_qᵀ F = M q̈ + C q̇ + G,     J_qᵀ ∂F/∂p = ∂(M q̈ + C q̇ + G)/∂p − (∂J_q/∂p)ᵀ F
//! ```
//!
//! Right sides come from the equations of motion evaluated in dual numbers; no step is chosen, nothing is cut off. The
//! thesis compares whole runs with a changed angle instead (4.3): differences of size 10°, in which curvature counts
//! besides the derivative.

use core::fmt;
use core::str::FromStr;

use mbs_models::stewart_platform::{PARAMETERS, Params};
use mbs_models::{Error, Failure};
use mbs_runtime::{Dual, Scalar};

use super::dynamics::{STILL, dual_legs, lifted};
use super::limits::LegState;
use super::{Motion, NOT_FINITE, Platform, all_finite};

/// What a leg, counted from 0, or all of them do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// `l_i` \[m\].
    Length(usize),
    /// `l̇_i` \[m/s\].
    Speed(usize),
    /// `F_i` \[N\].
    Force(usize),
    /// `P_i = F_i l̇_i` \[W\].
    Power(usize),
    /// `Σ P_i` \[W\].
    TotalPower,
}

/// How many outputs there are.
pub const OUTPUTS: usize = 25;
const OUTPUT_NAMES: [[&str; 6]; 4] = [
    ["length_1", "length_2", "length_3", "length_4", "length_5", "length_6"],
    ["speed_1", "speed_2", "speed_3", "speed_4", "speed_5", "speed_6"],
    ["force_1", "force_2", "force_3", "force_4", "force_5", "force_6"],
    ["power_1", "power_2", "power_3", "power_4", "power_5", "power_6"],
];

impl Output {
    /// All of them: lengths, speeds, forces and powers of the legs, and the power of all.
    pub fn all() -> impl Iterator<Item = Self> {
        [Self::Length, Self::Speed, Self::Force, Self::Power]
            .into_iter()
            .flat_map(|of_leg| (0..6).map(of_leg))
            .chain([Self::TotalPower])
    }

    /// `length_1` … `power_6`, legs counted from 1, and `power`.
    ///
    /// # Panics
    /// If the leg is not below 6.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Length(leg) => OUTPUT_NAMES[0][leg],
            Self::Speed(leg) => OUTPUT_NAMES[1][leg],
            Self::Force(leg) => OUTPUT_NAMES[2][leg],
            Self::Power(leg) => OUTPUT_NAMES[3][leg],
            Self::TotalPower => "power",
        }
    }

    /// `m`, `m/s`, `N` or `W`.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Length(_) => "m",
            Self::Speed(_) => "m/s",
            Self::Force(_) => "N",
            Self::Power(_) | Self::TotalPower => "W",
        }
    }

    /// Its value of these legs.
    ///
    /// # Panics
    /// If the leg is not below 6.
    #[must_use]
    pub fn of<T: Scalar>(self, legs: &LegState<T>) -> T {
        match self {
            Self::Length(leg) => legs.length[leg],
            Self::Speed(leg) => legs.rate[leg],
            Self::Force(leg) => legs.force[leg],
            Self::Power(leg) => legs.power()[leg],
            Self::TotalPower => legs.power().into_iter().fold(T::zero(), |sum, power| sum + power),
        }
    }
}

/// A number that describes the platform or its motion; coordinates are counted in the order x, y, z, φ, θ, ψ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// One of the mechanism's, counted as in its `PARAMETERS`.
    Platform(usize),
    /// The mean of a coordinate \[m, rad\].
    Mean(usize),
    /// The amplitude of its sine \[m, rad\].
    Sine(usize),
    /// The amplitude of its cosine \[m, rad\].
    Cosine(usize),
    /// Its frequency \[rad/s\].
    Frequency(usize),
    /// The frequencies of all coordinates, which grow alike \[rad/s\].
    Omega,
}

/// Units of the mechanism's parameters, in their order.
const PLATFORM_UNITS: [&str; 19] = [
    "m", "m", "rad", "rad", "kg", "kg·m²", "kg·m²", "kg·m²", "kg", "m", "m", "m", "kg", "m", "kg·m²", "kg", "m",
    "kg·m²", "m/s²",
];
const MOTION_NAMES: [[&str; 6]; 4] = [
    ["mean_x", "mean_y", "mean_z", "mean_phi", "mean_theta", "mean_psi"],
    ["sine_x", "sine_y", "sine_z", "sine_phi", "sine_theta", "sine_psi"],
    ["cosine_x", "cosine_y", "cosine_z", "cosine_phi", "cosine_theta", "cosine_psi"],
    ["frequency_x", "frequency_y", "frequency_z", "frequency_phi", "frequency_theta", "frequency_psi"],
];

impl Parameter {
    /// All of them, the mechanism's first.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_motion = [Self::Mean, Self::Sine, Self::Cosine, Self::Frequency];
        (0..PARAMETERS.len())
            .map(Self::Platform)
            .chain(of_motion.into_iter().flat_map(|of_coordinate| (0..6).map(of_coordinate)))
            .chain([Self::Omega])
    }

    /// The mechanism's own name of it, `mean_x` … `frequency_psi`, or `omega`.
    ///
    /// # Panics
    /// If there is none of this number.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Platform(place) => PARAMETERS[place],
            Self::Mean(coordinate) => MOTION_NAMES[0][coordinate],
            Self::Sine(coordinate) => MOTION_NAMES[1][coordinate],
            Self::Cosine(coordinate) => MOTION_NAMES[2][coordinate],
            Self::Frequency(coordinate) => MOTION_NAMES[3][coordinate],
            Self::Omega => "omega",
        }
    }

    /// Its SI unit.
    ///
    /// # Panics
    /// If there is none of this number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Platform(place) => PLATFORM_UNITS[place],
            Self::Mean(coordinate) | Self::Sine(coordinate) | Self::Cosine(coordinate) => {
                if coordinate < 3 {
                    "m"
                } else {
                    "rad"
                }
            }
            Self::Frequency(_) | Self::Omega => "rad/s",
        }
    }

    /// Its value; of [`Omega`](Self::Omega) that of the first coordinate.
    ///
    /// # Panics
    /// If there is none of this number.
    #[must_use]
    pub fn value<T: Scalar>(self, params: &Params<T>, motion: &Motion<T>) -> T {
        match self {
            Self::Platform(place) => *entries(&mut { *params })[place],
            Self::Mean(coordinate) => motion.mean[coordinate],
            Self::Sine(coordinate) => motion.sine[coordinate],
            Self::Cosine(coordinate) => motion.cosine[coordinate],
            Self::Frequency(coordinate) => motion.frequency[coordinate],
            Self::Omega => motion.frequency[0],
        }
    }

    /// Adds `amount` to it, in these parameters or this motion.
    ///
    /// # Panics
    /// If there is none of this number.
    pub fn add<T: Scalar>(self, amount: T, params: &mut Params<T>, motion: &mut Motion<T>) {
        let grow = |entry: &mut T| *entry = *entry + amount;
        match self {
            Self::Platform(place) => {
                if let Some(entry) = entries(params).into_iter().nth(place) {
                    grow(entry);
                }
            }
            Self::Mean(coordinate) => grow(&mut motion.mean[coordinate]),
            Self::Sine(coordinate) => grow(&mut motion.sine[coordinate]),
            Self::Cosine(coordinate) => grow(&mut motion.cosine[coordinate]),
            Self::Frequency(coordinate) => grow(&mut motion.frequency[coordinate]),
            Self::Omega => motion.frequency.iter_mut().for_each(grow),
        }
    }
}

/// The mechanism's parameters in the order of its `PARAMETERS`.
fn entries<T>(params: &mut Params<T>) -> [&mut T; 19] {
    let Params {
        base_radius,
        platform_radius,
        base_half_angle,
        platform_half_angle,
        platform_mass,
        platform_inertia: [i_0, i_1, i_2],
        payload_mass,
        payload_size: [size_0, size_1, size_2],
        cylinder_mass,
        cylinder_centre,
        cylinder_inertia,
        piston_mass,
        piston_centre,
        piston_inertia,
        g,
    } = params;
    [
        base_radius,
        platform_radius,
        base_half_angle,
        platform_half_angle,
        platform_mass,
        i_0,
        i_1,
        i_2,
        payload_mass,
        size_0,
        size_1,
        size_2,
        cylinder_mass,
        cylinder_centre,
        cylinder_inertia,
        piston_mass,
        piston_centre,
        piston_inertia,
        g,
    ]
}

impl FromStr for Output {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::all().find(|output| output.name() == name).ok_or(Failure::Missing("output of this name").into())
    }
}

impl FromStr for Parameter {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::all().find(|parameter| parameter.name() == name).ok_or(Failure::Missing("parameter of this name").into())
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Platform {
    /// What the legs do at a moment \[s\] of a motion, with the derivatives by a parameter.
    ///
    /// | output                    | derivative                                       |
    /// |---------------------------|--------------------------------------------------|
    /// | `length`, `rate`, `force` | of these, per unit of the parameter              |
    /// | `power()`                 | likewise: `∂F/∂p l̇ + F ∂l̇/∂p`                    |
    ///
    /// ```
    /// use mbs_platform::sensitivity::Parameter;
    /// use mbs_platform::{HOME, Motion, Platform};
    ///
    /// // In the middle of a surge the legs move and the platform is at home:
    /// // l² = r_B² + r_P² − 2 r_B r_P cos 36° + h².
    /// let radius: Parameter = "base_radius".parse().unwrap();
    /// let legs = Platform::default().leg_state_by(radius, &Motion::CASES[1].1, 0.0).unwrap();
    /// let by_radius = (1.2 - 0.9 * 36.0_f64.to_radians().cos()) / legs.length[0].value;
    /// assert!(legs.length.iter().all(|length| (length.derivative - by_radius).abs() < 1e-15));
    /// ```
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces).
    pub fn leg_state_by(&self, parameter: Parameter, motion: &Motion, t: f64) -> Result<LegState<Dual<f64>>, Error> {
        self.legs(&motion.at(t)[0])?;
        let (mut params, mut moving) = (lifted(self.params(), &STILL), lifted_motion(motion));
        parameter.add(Dual { value: 0.0, derivative: 1.0 }, &mut params, &mut moving);
        let legs = dual_legs(&params, &moving.at(t))?;
        let slopes = [legs.length, legs.rate, legs.force].map(|row| row.map(|x| x.derivative));
        if all_finite(&[slopes.as_flattened()]) { Ok(legs) } else { Err(NOT_FINITE.into()) }
    }

    /// The greatest derivative of every output by a parameter at these times \[s\], in the order of [`Output::all`].
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces).
    pub fn largest_derivatives(
        &self,
        parameter: Parameter,
        motion: &Motion,
        times: impl Iterator<Item = f64>,
    ) -> Result<[Largest; OUTPUTS], Error> {
        let mut largest = [Largest::default(); OUTPUTS];
        for t in times {
            let legs = self.leg_state_by(parameter, motion, t)?;
            for (largest, output) in largest.iter_mut().zip(Output::all()) {
                largest.take_in(output.of(&legs).derivative, t);
            }
        }
        Ok(largest)
    }
}

/// The derivative of greatest magnitude, and when \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// With its sign.
    pub value: f64,
    /// The first time at which it is so large \[s\].
    pub time: f64,
}

impl Largest {
    /// Takes in the derivative at a time \[s\].
    pub fn take_in(&mut self, value: f64, time: f64) {
        if value.abs() > self.value.abs() {
            *self = Self { value, time };
        }
    }
}

/// The motion in dual numbers, all of them constant.
fn lifted_motion(&Motion { mean, sine, cosine, frequency }: &Motion) -> Motion<Dual<f64>> {
    let [mean, sine, cosine, frequency] = [mean, sine, cosine, frequency].map(|row| row.map(Dual::constant));
    Motion { mean, sine, cosine, frequency }
}
