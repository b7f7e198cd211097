//! Adaptive control: the inertial parameters of a mechanism are learnt while it follows a trajectory.
//!
//! The inverse dynamics is linear in masses, first moments and inertias, `M q̈ + C q̇ + G = Y(q, q̇, q̈) π`.

use core::error::Error;
use core::fmt;

use crate::mechanism::Mechanism;

/// The regressor `Y` of forces that are linear in P parameters, `f(π) = f(0) + Y π`: rows are forces.
///
/// A column is `f(π₀ + eₖ) − f(π₀)`, one parameter larger by a unit; as f is linear, no step has to be small, and only
/// rounding is lost. `probe` is π₀, parameters of a mechanism that exists: where a mass centre is the first moment over
/// the mass, there has to be a mass. What does not depend on π drops out.
///
/// | argument | meaning                                         | shape      | unit                    |
/// |----------|-------------------------------------------------|------------|-------------------------|
/// | `forces` | f, at one state: [`Sliding::forces`] of a mechanism with these parameters | `P` → `N` | N or N·m |
/// | `probe`  | π₀                                              | `P`        | SI                      |
/// | result   | Y                                               | `N` by `P` | force per parameter     |
///
/// ```
/// use mbs_runtime::control::regressor;
///
/// // A pendulum with π = (m l², m g l) at q = 0.5 rad, q̈ = 2 rad/s².
/// let y = regressor(|p: &[f64; 2]| [p[0] * 2.0 + p[1] * 0.5_f64.sin()], &[0.0; 2]);
/// assert_eq!(y, [[2.0, 0.5_f64.sin()]]);
/// ```
///
/// # Source
/// C. G. Atkeson, C. H. An, J. M. Hollerbach, *Estimation of inertial parameters of manipulator loads and links*, The
/// International Journal of Robotics Research 5:3, 1986: the linearity, and columns by unit parameters.
pub fn regressor<const N: usize, const P: usize>(
    forces: impl Fn(&[f64; P]) -> [f64; N],
    probe: &[f64; P],
) -> [[f64; P]; N] {
    let without = forces(probe);
    let mut regressor = [[0.0; P]; N];
    for k in 0..P {
        let mut one_more = *probe;
        one_more[k] += 1.0;
        let with = forces(&one_more);
        (0..N).for_each(|i| regressor[i][k] = with[i] - without[i]);
    }
    regressor
}

/// How far a motion is from a reference, `s`, and what the mechanism is asked to do instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding<const N: usize> {
    /// `s = q̇ − q̇_r = ė_q + Λ e_q` with `e_q = q − q_d` \[per s\].
    pub error: [f64; N],
    /// `q̇_r = q̇_d − Λ (q − q_d)` \[per s\].
    pub qd: [f64; N],
    /// `q̈_r = q̈_d − Λ (q̇ − q̇_d)` \[per s²\].
    pub qdd: [f64; N],
}

impl<const N: usize> Sliding<N> {
    /// `M q̈_r + C q̇_r + g` \[N, N·m\] with matrices of a state; g is what depends on neither: `G(q) + ∂D/∂q̇`.
    #[must_use]
    pub fn forces(
        &self,
        mass_matrix: &[[f64; N]; N],
        coriolis_matrix: &[[f64; N]; N],
        remainder: &[f64; N],
    ) -> [f64; N] {
        core::array::from_fn(|i| dot(&mass_matrix[i], &self.qdd) + dot(&coriolis_matrix[i], &self.qd) + remainder[i])
    }

    /// `M(q) q̈_r + C(q, q̇) q̇_r + G(q) + ∂D/∂q̇` \[N, N·m\] of a mechanism; with `q̇_r = q̇` and `q̈_r = q̈` its
    /// inverse dynamics.
    #[must_use]
    pub fn forces_of<M: Mechanism<N, U, Scalar = f64, Time = f64>, const U: usize>(
        &self,
        mechanism: &M,
        t: f64,
        q: &[f64; N],
        qd: &[f64; N],
    ) -> [f64; N] {
        let (gravity, dissipation) = (mechanism.gravity(t, q), mechanism.dissipation_force(t, q, qd));
        let remainder = core::array::from_fn(|i| gravity[i] + dissipation[i]);
        self.forces(&mechanism.mass_matrix(t, q), &mechanism.coriolis_matrix(t, q, qd), &remainder)
    }
}

/// Slotine's and Li's adaptive control of N coordinates with P parameters.
///
/// ```text
/// Q  = Y(q, q̇, q̇_r, q̈_r) π̂ − K_D s        Y π = M(q) q̈_r + C(q, q̇) q̇_r + G(q)
/// π̂' = −Γ Yᵀ s                             s = q̇ − q̇_r,  q̇_r = q̇_d − Λ (q − q_d)
/// ```
///
/// With C in Christoffel's form `Ṁ − 2C` is skew, and `V = ½ sᵀ M s + ½ (π̂ − π)ᵀ Γ⁻¹ (π̂ − π)` falls as
/// `V̇ = −sᵀ K_D s` whatever the true π, as long as it is constant, M does not depend on the time, and the drives give
/// the forces. So `s` vanishes, and with it the error; `π̂` reaches π only where the motion shows it.
///
/// ```
/// use mbs_runtime::control::{AdaptiveControl, regressor};
///
/// // A mass on a rail, thought to be 1 kg, behind its reference by 0.1 m: the estimate grows with what it lags.
/// let control = AdaptiveControl::new([2.0], [5.0], [4.0]).unwrap();
/// let sliding = control.sliding(&[[0.1], [0.0], [3.0]], &[0.0], &[0.0]);
/// assert_eq!((sliding.error, sliding.qd, sliding.qdd), ([-0.2], [0.2], [3.0]));
/// let y = regressor(|m: &[f64; 1]| [m[0] * sliding.qdd[0]], &[0.0]);
/// assert_eq!(control.forces(&y, &[1.0], &sliding.error), [3.0 + 5.0 * 0.2]);
/// assert!(control.estimate_rate(&y, &sliding.error)[0] > 0.0);
/// ```
///
/// # Source
/// J.-J. E. Slotine and W. Li, *On the adaptive control of robot manipulators*, The International Journal of Robotics
/// Research 6:3, 1987.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveControl<const N: usize, const P: usize> {
    /// Λ \[1/s\], positive and finite.
    convergence: [f64; N],
    /// `K_D` \[force per velocity\], positive and finite.
    damping: [f64; N],
    /// Γ \[parameter² per J\], positive and finite.
    adaptation: [f64; P],
}

/// A gain of [`AdaptiveControl`] that is not positive, or not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum InvalidAdaptiveGain {
    /// An entry of Λ.
    Convergence {
        /// The coordinate, counted from 0.
        coordinate: usize,
        /// Its value \[1/s\].
        gain: f64,
    },
    /// An entry of `K_D`.
    Damping {
        /// The coordinate, counted from 0.
        coordinate: usize,
        /// Its value \[force per velocity\].
        gain: f64,
    },
    /// An entry of Γ.
    Adaptation {
        /// The parameter, counted from 0.
        parameter: usize,
        /// Its value \[parameter² per J\].
        gain: f64,
    },
}

impl fmt::Display for InvalidAdaptiveGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, number, gain) = match *self {
            Self::Convergence { coordinate, gain } => ("convergence of coordinate", coordinate, gain),
            Self::Damping { coordinate, gain } => ("damping of coordinate", coordinate, gain),
            Self::Adaptation { parameter, gain } => ("adaptation of parameter", parameter, gain),
        };
        write!(f, "a gain must be positive and finite, the {what} {number} is {gain:?}")
    }
}

impl Error for InvalidAdaptiveGain {}

impl<const N: usize, const P: usize> AdaptiveControl<N, P> {
    /// With the diagonals of Λ \[1/s\], `K_D` \[force per velocity\] and Γ \[parameter² per J\].
    ///
    /// # Errors
    /// [`InvalidAdaptiveGain`], the first that is not positive and finite.
    pub fn new(convergence: [f64; N], damping: [f64; N], adaptation: [f64; P]) -> Result<Self, InvalidAdaptiveGain> {
        for coordinate in 0..N {
            let gain = convergence[coordinate];
            positive(gain).ok_or(InvalidAdaptiveGain::Convergence { coordinate, gain })?;
            let gain = damping[coordinate];
            positive(gain).ok_or(InvalidAdaptiveGain::Damping { coordinate, gain })?;
        }
        for parameter in 0..P {
            let gain = adaptation[parameter];
            positive(gain).ok_or(InvalidAdaptiveGain::Adaptation { parameter, gain })?;
        }
        Ok(Self { convergence, damping, adaptation })
    }

    /// `s`, `q̇_r` and `q̈_r` at a state.
    ///
    /// | argument    | meaning                                                       | unit                        |
    /// |-------------|---------------------------------------------------------------|-----------------------------|
    /// | `reference` | `[q_d, q̇_d, q̈_d]`                                             | as declared, per s, per s²  |
    /// | `q`, `qd`   | coordinates, velocities                                       | as declared, per s          |
    #[must_use]
    pub fn sliding(&self, reference: &[[f64; N]; 3], q: &[f64; N], qd: &[f64; N]) -> Sliding<N> {
        let [q_d, qd_d, qdd_d] = reference;
        let lambda = &self.convergence;
        let qd_r: [f64; N] = core::array::from_fn(|i| qd_d[i] - lambda[i] * (q[i] - q_d[i]));
        Sliding {
            error: core::array::from_fn(|i| qd[i] - qd_r[i]),
            qd: qd_r,
            qdd: core::array::from_fn(|i| qdd_d[i] - lambda[i] * (qd[i] - qd_d[i])),
        }
    }

    /// `Y π̂ − K_D s` \[N, N·m\]: to what the regressor stands for; forces of known parts are added to it.
    #[must_use]
    pub fn forces(&self, regressor: &[[f64; P]; N], estimate: &[f64; P], error: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| dot(&regressor[i], estimate) - self.damping[i] * error[i])
    }

    /// `π̂' = −Γ Yᵀ s` \[parameter per s\].
    #[must_use]
    pub fn estimate_rate(&self, regressor: &[[f64; P]; N], error: &[f64; N]) -> [f64; P] {
        core::array::from_fn(|k| -self.adaptation[k] * (0..N).map(|i| regressor[i][k] * error[i]).sum::<f64>())
    }

    /// `V = ½ sᵀ M s + ½ (π̂ − π)ᵀ Γ⁻¹ (π̂ − π)` \[J\], for those who know π; `mistake` is `π̂ − π`.
    #[must_use]
    pub fn lyapunov(&self, mass_matrix: &[[f64; N]; N], error: &[f64; N], mistake: &[f64; P]) -> f64 {
        let motion = dot(error, &core::array::from_fn(|i| dot(&mass_matrix[i], error)));
        let knowledge: f64 = (0..P).map(|k| mistake[k] * mistake[k] / self.adaptation[k]).sum();
        0.5 * (motion + knowledge)
    }

    /// `V̇ = −sᵀ K_D s` \[W\].
    #[must_use]
    pub fn lyapunov_rate(&self, error: &[f64; N]) -> f64 {
        -(0..N).map(|i| self.damping[i] * error[i] * error[i]).sum::<f64>()
    }
}

fn positive(gain: f64) -> Option<()> {
    (gain > 0.0 && gain.is_finite()).then_some(())
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    (0..N).map(|i| a[i] * b[i]).sum()
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use core::ops::ControlFlow;

    use super::*;
    use crate::{Dop853, Integrator, State};
    use std::string::ToString;

    #[test]
    fn gains_that_are_none() {
        let new = |convergence: f64, damping: f64, adaptation: f64| {
            AdaptiveControl::new([1.0, convergence], [1.0, damping], [1.0, adaptation]).err()
        };
        assert_eq!(new(1.0, 1.0, 1.0), None);
        for gain in [0.0, -2.0, f64::INFINITY] {
            assert_eq!(new(gain, 1.0, 1.0), Some(InvalidAdaptiveGain::Convergence { coordinate: 1, gain }));
            assert_eq!(new(1.0, gain, 1.0), Some(InvalidAdaptiveGain::Damping { coordinate: 1, gain }));
            assert_eq!(new(1.0, 1.0, gain), Some(InvalidAdaptiveGain::Adaptation { parameter: 1, gain }));
        }
        let text = new(1.0, 1.0, f64::NAN).map(|error| error.to_string());
        let expected = "a gain must be positive and finite, the adaptation of parameter 1 is NaN";
        assert_eq!(text.as_deref(), Some(expected));
    }

    #[test]
    fn a_regressor_of_forces_with_a_known_part() {
        let forces = |p: &[f64; 3]| [7.0 + 2.0 * p[0] - p[2], -3.0 + 0.5 * p[1]];
        assert_eq!(regressor(forces, &[1.0, 0.0, 4.0]), [[2.0, 0.0, -1.0], [0.0, 0.5, 0.0]]);
    }

    /// A pendulum with friction in its hinge that knows neither its inertia, nor its weight, nor the friction:
    /// `J q̈ + d q̇ + w sin q = Q`. V falls by what `sᵀ K_D s` adds up to, and the motion shows all three: the
    /// combination that it shows least dies out by a factor of eight in 20 s, so that 160 s leave 1e-7 of an error of
    /// one.
    #[test]
    fn a_pendulum_learns_what_it_is() {
        let truth = [0.8, 0.3, 5.0];
        let control = AdaptiveControl::new([2.0], [4.0], [1.0, 0.5, 20.0]).unwrap();
        let reference = |t: f64| {
            let wave = |w: f64, a: f64| [a * (w * t).sin(), a * w * (w * t).cos(), -a * w * w * (w * t).sin()];
            let (one, two) = (wave(1.0, 0.9), wave(2.7, 0.4));
            [[one[0] + two[0]], [one[1] + two[1]], [one[2] + two[2]]]
        };
        let y = |sliding: &Sliding<1>, q: f64, qd: f64| {
            regressor(|p: &[f64; 3]| [p[0] * sliding.qdd[0] + p[1] * qd + p[2] * q.sin()], &[0.0; 3])
        };
        // Behind the angle: integrals of the estimates, whose rates are the estimates; last, what was dissipated.
        let motion = |t: f64, x: &[f64; 5], v: &[f64; 5], a: &mut [f64; 5]| {
            let sliding = control.sliding(&reference(t), &[x[0]], &[v[0]]);
            let (y, estimate) = (y(&sliding, x[0], v[0]), [v[1], v[2], v[3]]);
            let [force] = control.forces(&y, &estimate, &sliding.error);
            a[0] = (force - truth[1] * v[0] - truth[2] * x[0].sin()) / truth[0];
            a[1..4].copy_from_slice(&control.estimate_rate(&y, &sliding.error));
            a[4] = -control.lyapunov_rate(&sliding.error);
        };
        let value = |t: f64, state: &State<[f64; 5]>| {
            let sliding = control.sliding(&reference(t), &[state.q[0]], &[state.qd[0]]);
            let mistake = core::array::from_fn(|k| state.qd[k + 1] - truth[k]);
            control.lyapunov(&[[truth[0]]], &sliding.error, &mistake)
        };
        let mut state = State::new([0.5, 0.0, 0.0, 0.0, 0.0], [0.0; 5]);
        let first = value(0.0, &state);
        let mut last = first;
        Dop853::new(1e-11, 1e-11)
            .integrate(motion, 0.0, 160.0, &mut state, |step| {
                let (now, spent) = (value(step.time(), step.state()), step.state().qd[4]);
                assert!(now <= last + 1e-9 && (now + spent - first).abs() < 1e-8, "{now} after {last}");
                last = now;
                ControlFlow::Continue(())
            })
            .unwrap();
        let behind = state.q[0] - reference(160.0)[0][0];
        assert!(behind.abs() < 1e-7, "{behind}");
        assert!((0..3).all(|k| (state.qd[k + 1] - truth[k]).abs() < 1e-6), "{:?}", state.qd);
    }
}
