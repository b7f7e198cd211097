use core::error::Error;
use core::fmt;

/// Computed-torque control: the model of a mechanism turns it into N oscillators that do not know of each other.
///
/// ```text
/// Q = M(q) a + C(q, q̇) q̇ + G(q),   a = q̈_d + K_d ė + K_p e,   e = q_d − q
/// ```
///
/// [`acceleration`](Self::acceleration) is `a`, the model's inverse dynamics is the rest. With these forces the error
/// obeys `ë + K_d ė + K_p e = 0`, each coordinate by itself, as far as the model is right and the drives can give the
/// forces.
///
/// ```
/// use mbs_runtime::control::ComputedTorque;
///
/// // A mass of 2 kg that slides, held at 0.1 m: its inverse dynamics is 2 a.
/// let control = ComputedTorque::critically_damped(3.0).unwrap();
/// let [a] = control.acceleration(&[[0.1], [0.0], [0.0]], &[0.0], &[0.5]);
/// assert!((2.0 * a - 2.0 * (9.0 * 0.1 - 6.0 * 0.5)).abs() < 1e-15);
/// ```
///
/// # Source
/// J. Y. S. Luh, M. W. Walker, R. P. C. Paul, *Resolved-acceleration control of mechanical manipulators*, IEEE
/// Transactions on Automatic Control 25:3, 1980, for generalized coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComputedTorque<const N: usize> {
    /// `K_p` \[1/s²\], positive and finite.
    stiffness: [f64; N],
    /// `K_d` \[1/s\], positive and finite.
    damping: [f64; N],
}

/// A gain that is not positive, or not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct InvalidGain {
    /// The coordinate, counted from 0.
    pub coordinate: usize,
    /// The gain given: `K_p` \[1/s²\], `K_d` \[1/s\], or the natural frequency \[rad/s\] of which they are made.
    pub gain: f64,
}

impl fmt::Display for InvalidGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a gain must be positive and finite, that of coordinate {} is {}", self.coordinate, self.gain)
    }
}

impl Error for InvalidGain {}

impl<const N: usize> ComputedTorque<N> {
    /// With these gains, one a coordinate: `K_p` \[1/s²\] and `K_d` \[1/s\].
    ///
    /// # Errors
    /// [`InvalidGain`], the first that is not positive and finite.
    pub fn new(stiffness: [f64; N], damping: [f64; N]) -> Result<Self, InvalidGain> {
        for coordinate in 0..N {
            for gain in [stiffness[coordinate], damping[coordinate]] {
                positive(coordinate, gain)?;
            }
        }
        Ok(Self { stiffness, damping })
    }

    /// `K_p = ω²`, `K_d = 2 ω`: every error dies as `(e₀ + (ė₀ + ω e₀) t) exp(−ω t)`, without overshoot from rest.
    ///
    /// # Errors
    /// [`InvalidGain`] if the natural frequency `ω` \[rad/s\] is not positive, or its square is not finite.
    pub fn critically_damped(natural_frequency: f64) -> Result<Self, InvalidGain> {
        positive(0, natural_frequency)?;
        Self::new([natural_frequency * natural_frequency; N], [2.0 * natural_frequency; N])
    }

    /// `K_p` \[1/s²\].
    #[must_use]
    pub fn stiffness(&self) -> &[f64; N] {
        &self.stiffness
    }

    /// `K_d` \[1/s\].
    #[must_use]
    pub fn damping(&self) -> &[f64; N] {
        &self.damping
    }

    /// The accelerations `q̈_d + K_d ė + K_p e` that are asked of the mechanism.
    ///
    /// | argument    | meaning                                                       | unit         |
    /// |-------------|---------------------------------------------------------------|--------------|
    /// | `reference` | coordinates, rates and accelerations wanted at this moment    | as declared, per second |
    /// | `q`, `qd`   | the state                                                     | as declared, per second |
    #[must_use]
    pub fn acceleration(&self, [q_d, qd_d, qdd_d]: &[[f64; N]; 3], q: &[f64; N], qd: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| qdd_d[i] + self.damping[i] * (qd_d[i] - qd[i]) + self.stiffness[i] * (q_d[i] - q[i]))
    }
}

fn positive(coordinate: usize, gain: f64) -> Result<(), InvalidGain> {
    if gain > 0.0 && gain.is_finite() { Ok(()) } else { Err(InvalidGain { coordinate, gain }) }
}
