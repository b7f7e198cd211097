//! What generated code implements: the equations of motion of one mechanism as functions of its state.

use crate::scalar::Scalar;

/// When equations are evaluated: the time, or the time with the motions that are prescribed at it.
///
/// ```
/// use mbs_runtime::Instant;
/// let prescribed = [[0.0, 2.0, 0.0]; 1]; // value, rate, rate of the rate
/// assert_eq!((0.5_f64.time(), (0.5, prescribed).time()), (0.5, 0.5));
/// assert_eq!(<(f64, [[f64; 3]; 1])>::at(0.5, |_| [0.0, 2.0, 0.0]), (0.5, prescribed));
/// ```
pub trait Instant<T>: Copy {
    /// How many motions are prescribed, arrays flattened.
    const SIGNALS: usize;

    /// The time \[s\].
    fn time(&self) -> T;

    /// At this time, with what `signal` gives for each prescribed motion: its value, its first and its second
    /// derivative by time.
    fn at(t: T, signal: impl FnMut(usize) -> [T; 3]) -> Self;
}

impl<T: Scalar> Instant<T> for T {
    const SIGNALS: usize = 0;

    fn time(&self) -> T {
        *self
    }

    fn at(t: T, _: impl FnMut(usize) -> [T; 3]) -> T {
        t
    }
}

impl<T: Scalar, const S: usize> Instant<T> for (T, [[T; 3]; S]) {
    const SIGNALS: usize = S;

    fn time(&self) -> T {
        self.0
    }

    fn at(t: T, signal: impl FnMut(usize) -> [T; 3]) -> Self {
        (t, core::array::from_fn(signal))
    }
}

/// How `N` coordinates accelerate under `U` inputs: what a motion needs.
///
/// | argument         | meaning                                | shape | unit                           |
/// |------------------|----------------------------------------|-------|--------------------------------|
/// | `t`              | time, with what is prescribed at it    |       | s                              |
/// | `q`, `qd`, `qdd` | coordinates, velocities, accelerations | `N`   | as declared, per s, per s²     |
/// | `u`              | inputs                                 | `U`   | as declared                    |
///
/// Functions, those of [`Energies`], [`Linearized`], [`Constrained`] and [`Mechanism`] too, are algebra: they give
/// infinity or NaN where the equations do (a singular mass matrix), and never panic. A generated module implements what
/// it has the functions of.
///
/// The [front page](crate) implements it by hand for a pendulum.
pub trait Dynamics<const N: usize, const U: usize> {
    /// The numbers it is evaluated in.
    type Scalar: Scalar;
    /// What the equations depend on beside state and inputs: the time, `(time, signals)` where motions are prescribed.
    type Time: Instant<Self::Scalar>;

    /// The mechanism's name as declared.
    const NAME: &'static str;
    /// The names of the coordinates; those of an array `q` are `q_0`, `q_1` ….
    const COORDINATES: [&'static str; N];
    /// The names of the inputs, flattened in the same way.
    const INPUTS: [&'static str; U];

    /// Accelerations `q̈ = M⁻¹ (Q − C q̇ − G − ∂D/∂q̇)`.
    fn forward_dynamics(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        u: &[Self::Scalar; U],
    ) -> [Self::Scalar; N];
}

/// The energies of a mechanism with `N` coordinates: what a motion is measured by.
pub trait Energies<const N: usize, const U: usize>: Dynamics<N, U> {
    /// Kinetic energy `T` \[J\].
    fn kinetic_energy(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> Self::Scalar;

    /// Potential energy `V` \[J\].
    fn potential_energy(&self, t: Self::Time, q: &[Self::Scalar; N]) -> Self::Scalar;
}

/// The derivatives of the accelerations: what vibrations and regulators are made of.
pub trait Linearized<const N: usize, const U: usize>: Dynamics<N, U> {
    /// Derivatives of [`forward_dynamics`](Dynamics::forward_dynamics) at this state.
    ///
    /// Every coordinate, rate and input is varied by itself. Where rows of constraints depend on each other, a change
    /// of one coordinate or rate alone may make them contradict each other: its column is NaN, and no sum of columns
    /// is the derivative along a motion on which all rows agree. `mbs linearize` takes derivatives along such motions;
    /// [`Reduction::linearize`](crate::Reduction::linearize) needs columns that are finite.
    fn linearize(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        u: &[Self::Scalar; U],
    ) -> Linearization<Self::Scalar, N, U>;
}

/// The `K` rows of the constraints of a mechanism, and the forces that keep them.
///
/// ```text
/// M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ
/// A q̈ + γ = 0
/// ```
///
/// Arguments are those of [`Dynamics`]. A generated module with constraints implements it beside
/// [`Constraints`](crate::Constraints), which is what a [`Projector`](crate::Projector) asks for.
pub trait Constrained<const N: usize, const U: usize, const K: usize>: Dynamics<N, U> {
    /// The names of the rows; those of a constraint of three components `c` are `c_0`, `c_1`, `c_2`.
    const CONSTRAINTS: [&'static str; K];
    /// Whether a row is holonomic, `φ(q, t) = 0`; otherwise it is Pfaffian, `a(q, t)·q̇ + b(q, t) = 0`.
    const HOLONOMIC: [bool; K];

    /// What must vanish: `φ`, or `a·q̇ + b` of Pfaffian rows.
    fn constraint(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; K];

    /// What velocities must satisfy: `A q̇ + b`, with `b = ∂φ/∂t` of holonomic rows.
    fn constraint_rate(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; K];

    /// `∂(A q̇ + b)/∂q`, which a [`Reduction`](crate::Reduction) takes.
    fn constraint_rate_jacobian(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
    ) -> [[Self::Scalar; N]; K];

    /// `A`: `∂φ/∂q`, or `a` of Pfaffian rows.
    fn constraint_jacobian(&self, t: Self::Time, q: &[Self::Scalar; N]) -> [[Self::Scalar; N]; K];

    /// `γ = Ȧ q̇ + ḃ`.
    fn constraint_bias(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; K];

    /// Lagrange's multipliers `λ`; where rows depend on others, the least of those that give the same `Aᵀ λ`.
    fn multipliers(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        u: &[Self::Scalar; U],
    ) -> [Self::Scalar; K];
}

/// A mechanism with `N` coordinates and `U` inputs, all of its equations:
///
/// ```text
/// M(q, t) q̈ + C(q, q̇, t) q̇ + G(q, t) + ∂D/∂q̇ = Q(q, q̇, u, t)
/// ```
///
/// Arguments are those of [`Dynamics`]. Forces are conjugate to the coordinates: N for a coordinate in m, N·m for one
/// in rad. Matrices are arrays of rows, `m[row][column]`.
pub trait Mechanism<const N: usize, const U: usize>: Energies<N, U> + Linearized<N, U> {
    /// Generalized momenta `p = ∂L/∂q̇` \[force · s\].
    fn momentum(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; N];

    /// Mass matrix `M = ∂²L/∂q̇²`, symmetric, both triangles filled \[force per acceleration\].
    fn mass_matrix(&self, t: Self::Time, q: &[Self::Scalar; N]) -> [[Self::Scalar; N]; N];

    /// Coriolis matrix `C` in Christoffel's form: `Ṁ + ∂M/∂t − 2C` is skew-symmetric \[force per velocity\].
    fn coriolis_matrix(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [[Self::Scalar; N]; N];

    /// Gravity and other forces of position `G = −∂L₀/∂q + ∂a/∂t`, which is `∂V/∂q` in the plain case \[force\].
    fn gravity(&self, t: Self::Time, q: &[Self::Scalar; N]) -> [Self::Scalar; N];

    /// Bias `h = C q̇ + G`, without forming `C` \[force\].
    fn bias(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; N];

    /// `∂D/∂q̇`, the force that Rayleigh's dissipation function takes from the motion, on the side of `M q̈` \[force\].
    fn dissipation_force(&self, t: Self::Time, q: &[Self::Scalar; N], qd: &[Self::Scalar; N]) -> [Self::Scalar; N];

    /// Generalized force `Q` of the inputs and of the declared forces \[force\].
    fn generalized_force(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        u: &[Self::Scalar; U],
    ) -> [Self::Scalar; N];

    /// `M q̈ + C q̇ + G + ∂D/∂q̇`: the generalized force that makes the mechanism move so; `Q` is not subtracted
    /// \[force\].
    fn inverse_dynamics(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        qdd: &[Self::Scalar; N],
    ) -> [Self::Scalar; N];

    /// Derivatives of [`inverse_dynamics`](Self::inverse_dynamics) at this state; the one by `q̈` is `M`.
    fn inverse_dynamics_jacobian(
        &self,
        t: Self::Time,
        q: &[Self::Scalar; N],
        qd: &[Self::Scalar; N],
        qdd: &[Self::Scalar; N],
    ) -> InverseDynamicsJacobian<Self::Scalar, N>;
}

/// The accelerations of `mechanism` under `control`, in the form that an [`Integrator`](crate::Integrator) takes.
///
/// `control(t, q, q̇)` gives the inputs `u`; `|_, _, _| []` where there are none.
#[allow(clippy::type_complexity)] // it is the signature of a closure, and cannot be named otherwise
pub fn accelerations<T, M, const N: usize, const U: usize>(
    mechanism: &M,
    control: impl FnMut(T, &[T; N], &[T; N]) -> [T; U],
) -> impl FnMut(T, &[T; N], &[T; N], &mut [T; N])
where
    T: Scalar,
    M: Dynamics<N, U, Scalar = T, Time = T>,
{
    prescribed_accelerations(mechanism, |t| t, control)
}

/// The accelerations of `mechanism` under `control` and the motions that `instant` prescribes, in the form that an
/// [`Integrator`](crate::Integrator) takes.
///
/// `instant(t)` gives the time and, for each prescribed motion, its value and its first and second derivative by time:
/// `|t| (t, [[0.1 * t.sin(), 0.1 * t.cos(), -0.1 * t.sin()]])`.
#[allow(clippy::type_complexity)] // as above
pub fn prescribed_accelerations<T, M, const N: usize, const U: usize>(
    mechanism: &M,
    mut instant: impl FnMut(T) -> M::Time,
    mut control: impl FnMut(T, &[T; N], &[T; N]) -> [T; U],
) -> impl FnMut(T, &[T; N], &[T; N], &mut [T; N])
where
    T: Scalar,
    M: Dynamics<N, U, Scalar = T>,
{
    move |t, q, qd, qdd| {
        let u = control(t, q, qd);
        *qdd = mechanism.forward_dynamics(instant(t), q, qd, &u);
    }
}

/// First derivatives of the accelerations `q̈(t, q, q̇, u)`; rows are accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<T, const N: usize, const U: usize> {
    /// `∂q̈/∂q`.
    pub q: [[T; N]; N],
    /// `∂q̈/∂q̇`.
    pub qd: [[T; N]; N],
    /// `∂q̈/∂u`.
    pub u: [[T; U]; N],
}

/// First derivatives of the inverse dynamics `τ = M q̈ + C q̇ + G + ∂D/∂q̇`; rows are forces. `∂τ/∂q̈` is `M`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseDynamicsJacobian<T, const N: usize> {
    /// `∂τ/∂q`.
    pub q: [[T; N]; N],
    /// `∂τ/∂q̇`.
    pub qd: [[T; N]; N],
}

/// Where a body is and how it is turned: a point `x` of the body is at `position + rotation · x` in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose<T> {
    /// The origin of the body's axes in the world \[m\].
    pub position: [T; 3],
    /// Turns body axes to world axes: rows, so that column `j` is the body's axis `j` seen in the world.
    pub rotation: [[T; 3]; 3],
}

impl<T: Scalar> Pose<T> {
    /// The point of the world at which the body's point `x` is: `position + rotation · x` \[m\].
    #[must_use]
    pub fn transform_point(&self, x: [T; 3]) -> [T; 3] {
        let [p, r] = [&self.position, &self.rotation.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])];
        core::array::from_fn(|i| p[i] + r[i])
    }
}

/// What a joint transmits: the force and the moment that the part before it exerts on the part behind it.
///
/// Both are in the axes of the joint's pose, the moment is about the pose's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wrench<T> {
    /// The force \[N\].
    pub force: [T; 3],
    /// The moment \[N·m\].
    pub moment: [T; 3],
}

impl<T: Scalar> Wrench<T> {
    /// The wrench about the point `x` of the same axes: `moment − x × force`.
    #[must_use]
    pub fn about(&self, x: [T; 3]) -> Self {
        let (f, m) = (self.force, self.moment);
        let component = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            m[i] - (x[j] * f[k] - x[k] * f[j])
        };
        Wrench { force: f, moment: core::array::from_fn(component) }
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    #[test]
    fn a_wrench_about_another_point() {
        // A weight of 2 N at (3, 0, 0) has no moment about its place.
        let weight = Wrench { force: [0.0, 0.0, -2.0], moment: [0.0, 6.0, 0.0] };
        assert_eq!(weight.about([3.0, 0.0, 0.0]), Wrench { force: [0.0, 0.0, -2.0], moment: [0.0; 3] });
        assert_eq!(weight.about([0.0, 1.0, 0.0]).moment, [2.0, 6.0, 0.0]);
    }
}
