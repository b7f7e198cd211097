//! What a motion costs: the work of the motors, and their effort.

use mbs_models::{Error, Failure};
use mbs_runtime::Mechanism;

use super::{JointState, Motion};

/// An integral over the motion, and a bound on the error of its quadrature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// The integral.
    pub value: f64,
    /// Sum over all panels of the difference between Kronrod's and Gauss' rule; far above the error of smooth panels.
    pub error: f64,
}

/// `∫ Σ |τᵢ q̇ᵢ| dt` \[J\]: the energy that motors spend that cannot take any back.
///
/// # Errors
/// [`Failure::NotConverged`] where a torque is infinite or NaN.
pub fn energy<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    motion: &impl Motion<N>,
) -> Result<Integral, Error> {
    integrate(motion, |_, state, torque| dot(|i| (torque[i] * state.qd[i]).abs(), N), mechanism)
}

/// `∫ Σ τᵢ q̇ᵢ dt` \[J\]: what the motors add to kinetic and potential energy.
///
/// # Errors
/// As [`energy`].
pub fn net_work<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    motion: &impl Motion<N>,
) -> Result<Integral, Error> {
    integrate(motion, |_, state, torque| dot(|i| torque[i] * state.qd[i], N), mechanism)
}

/// `∫ Σ τᵢ² dt` \[N²·m²·s\]: what heats the windings.
///
/// # Errors
/// As [`energy`].
pub fn effort<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    motion: &impl Motion<N>,
) -> Result<Integral, Error> {
    integrate(motion, |_, _, torque| dot(|i| torque[i] * torque[i], N), mechanism)
}

fn dot(term: impl Fn(usize) -> f64, n: usize) -> f64 {
    (0..n).map(term).sum()
}

/// Error that is allowed, of the integral of the absolute value.
const TOLERANCE: f64 = 1e-10;
/// Equal panels to begin with.
const PANELS: usize = 32;
/// A panel is halved at most this many times.
const DEPTH: usize = 48;

/// Adaptive quadrature: panels are halved until each has its part of the tolerance, which closes in on corners.
fn integrate<const N: usize, const U: usize>(
    motion: &impl Motion<N>,
    integrand: impl Fn(f64, &JointState<N>, &[f64; N]) -> f64,
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
) -> Result<Integral, Error> {
    let duration = motion.duration();
    let at = |t: f64| {
        let state = motion.at(t.clamp(0.0, duration))?;
        let torque = mechanism.inverse_dynamics(t, &state.q, &state.qd, &state.qdd);
        Ok(integrand(t, &state, &torque))
    };
    let bounds = |panel: usize| [panel, panel + 1].map(|edge| duration * (edge as f64 / PANELS as f64));
    let mut magnitude = 0.0;
    for panel in 0..PANELS {
        let [from, to] = bounds(panel);
        magnitude += kronrod(&|t| at(t).map(f64::abs), from, to)?.value;
    }
    let mut total = Integral { value: 0.0, error: 0.0 };
    for panel in 0..PANELS {
        // Panels still to do, the next one last; each was halved from the one below it.
        let mut waiting = [[0.0; 2]; DEPTH + 1];
        waiting[0] = bounds(panel);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let [from, to] = waiting[count];
            let part = kronrod(&at, from, to)?;
            if part.error <= TOLERANCE * magnitude * (to - from) / duration {
                total.value += part.value;
                total.error += part.error;
                continue;
            }
            let middle = from + 0.5 * (to - from);
            if count + 2 > waiting.len() || to - from <= duration * 1e-14 {
                let (what, unit) = ("the integral", "in the unit of the integral");
                let failure = Failure::NotConverged { what, iterations: count, residual: part.error, unit };
                return Err(failure.at_time(middle));
            }
            (waiting[count], waiting[count + 1]) = ([middle, to], [from, middle]);
            count += 2;
        }
    }
    Ok(total)
}

/// Positive nodes of Kronrod's rule with 15 points, the odd ones those of Gauss' with 7.
///
/// R. Piessens et al., *QUADPACK*, 1983, routine `qk15`.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
/// Weights of Kronrod's rule.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
/// Weights of Gauss' rule, of the odd nodes.
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

fn kronrod(integrand: &impl Fn(f64) -> Result<f64, Error>, from: f64, to: f64) -> Result<Integral, Error> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (0.0, 0.0);
    for (i, node) in NODES.iter().enumerate() {
        let mut value = integrand(middle + half * node)?;
        if *node > 0.0 {
            value += integrand(middle - half * node)?;
        }
        kronrod += KRONROD[i] * value;
        if i % 2 == 1 {
            gauss += GAUSS[i / 2] * value;
        }
    }
    Ok(Integral { value: half * kronrod, error: (half * (kronrod - gauss)).abs() })
}
