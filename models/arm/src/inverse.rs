//! Inverse kinematics in closed form: all configurations that reach a pose, thesis equations (3.5)–(3.12).
//!
//! The wrist centre `w = P − d₆ h₃` depends on the first three joints alone. In the plane of the arm, with
//! `x = w_x c₁ + w_y s₁ − a₁` and `y = d₁ − w_z`,
//!
//! ```text
//! x + i y = e^{iθ₂} (a₂ + l₁ e^{iκ}),   κ = θ₃ + φ,   l₁ = √(a₃² + d₄²),   φ = atan2(d₄, a₃)
//! ```
//!
//! is a triangle with the sides `a₂`, `l₁` and `ρ = |x + i y|`. Its angle comes by half angles, where (3.11) takes an
//! arc cosine that loses half of the digits near the stretched arm:
//!
//! ```text
//! tan ½κ = ± √( (a₂ + l₁ − ρ)(a₂ + l₁ + ρ) / ((ρ − a₂ + l₁)(ρ + a₂ − l₁)) )
//! ```
//!
//! and `θ₂` by a complex division. The wrist's angles are those of the rotation that is left, (3.8)–(3.10) with signs:
//! `R₃ᵀ R`. Sines and cosines are found before angles, and no angle is put into a sine again.
//!
//! | branch     | positive or front                     | negative or back                       |
//! |------------|---------------------------------------|----------------------------------------|
//! | [`Shoulder`] | axis 1 faces the wrist                | axis 1 faces away: `θ₁` is half a turn further |
//! | [`Elbow`]  | `0 < κ < π`                           | `−π < κ < 0`                           |
//! | [`Wrist`]  | `sin θ₅ > 0`                          | `sin θ₅ < 0`: `θ₄`, `θ₆` half a turn further |
//!
//! # Singularities
//! Where branches meet, one of them is returned, and [`Solution::singular`] says so:
//!
//! | singularity | where                                    | what is undetermined, and chosen               |
//! |-------------|------------------------------------------|------------------------------------------------|
//! | shoulder    | the wrist is on axis 1                   | `θ₁`: that of [`InverseKinematics::reference`] |
//! | elbow       | the arm is stretched or folded: `κ = 0, π` | nothing; the branches are one                  |
//! | wrist       | axes 4 and 6 are in line: `sin θ₅ = 0`   | `θ₄` against `θ₆`: `θ₄` is that of the reference |
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, section 3.2. The decoupling is that of D.
//! L. Pieper, *The kinematics of manipulators under computer control*, 1968. Triangles from their sides: W.
//! Kahan, *Miscalculating area and angles of a needle-like triangle*, 2014.

mod solutions;

use core::f64::consts::{PI, TAU};

use mbs_models::{Error, Failure, check};
use mbs_runtime::attitude::{NotARotation, ROTATION_TOLERANCE, check_rotation, orthonormalized_within};
use mbs_runtime::{Pose, Scalar};

pub use solutions::{EXCESS, Solutions};

use super::{A1, A2, A3, D1, D4, D6, JointVector};

/// How the shoulder stands to the wrist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shoulder {
    /// The wrist is on the side that axis 1 faces: `w_x c₁ + w_y s₁ > 0`.
    Front,
    /// The arm reaches over its own base: `w_x c₁ + w_y s₁ < 0`.
    Back,
}

/// To which side of the upper arm the forearm is bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Elbow {
    /// `0 ≤ θ₃ + φ ≤ π`: the elbow is above the line from shoulder to wrist where the arm reaches forward; (3.11),
    /// (3.12).
    Positive,
    /// `−π < θ₃ + φ < 0`.
    Negative,
}

/// To which side the wrist is bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrist {
    /// `sin θ₅ ≥ 0`.
    Positive,
    /// `sin θ₅ < 0`.
    Negative,
}

/// Which of up to eight configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Branch {
    /// Front or back.
    pub shoulder: Shoulder,
    /// The sign of `θ₃ + φ`.
    pub elbow: Elbow,
    /// The sign of `sin θ₅`.
    pub wrist: Wrist,
}

/// The singularities that a configuration is in, where branches meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Singularities {
    /// The wrist is on axis 1: any `θ₁` with the right sum of what follows reaches the pose.
    pub shoulder: bool,
    /// The arm is stretched or folded, up to [`STRETCHED`].
    pub elbow: bool,
    /// Axes 4 and 6 are in line: the pose says nothing of their angles but the sum, or the difference where `θ₅ = π`.
    pub wrist: bool,
}

impl Singularities {
    /// Whether there is any.
    #[must_use]
    pub fn any(&self) -> bool {
        self.shoulder || self.elbow || self.wrist
    }
}

/// How close the wrist is to axis 1 \[m\], and how small `|sin θ₅|`, where they are singular: then what is left is
/// rounding, and says nothing of the angle.
pub const UNDETERMINED: f64 = 1e-13;

/// How near `κ` is to 0 or π \[rad\] where the arm is stretched or folded: near the stretched arm the distance of the
/// wrist changes with the square of `κ`, so that a pose in double precision tells the branches apart down to some 1e-8.
pub const STRETCHED: f64 = 1e-7;

/// How far beyond the stretched arm a wrist is still taken for reached \[m\]: what rounding adds to a pose.
pub const REACH_TOLERANCE: f64 = 1e-12;

/// One configuration that reaches the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Joint angles \[rad\], in `[−π, π]` unless they were moved into ranges.
    pub q: JointVector,
    /// Which configuration it is.
    pub branch: Branch,
    /// Whether branches meet here.
    pub singular: Singularities,
}

/// What becomes of a matrix that is not quite a rotation. Tolerances are of the largest entry of `RᵀR − 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inexact {
    /// The nearest rotation takes its place, up to this tolerance.
    Orthonormalize(f64),
    /// It is refused beyond this tolerance, and taken as it is within.
    Reject(f64),
}

/// The closed form, with what it does about poses that are inexact or singular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseKinematics {
    /// What becomes of matrices that are not quite rotations; by default they are orthonormalized up to
    /// [`ROTATION_TOLERANCE`].
    pub inexact: Inexact,
    /// The angles of which `θ₁` and `θ₄` are taken where the pose leaves them open \[rad\]; by default zero. These two
    /// must be finite.
    pub reference: JointVector,
}

impl Default for InverseKinematics {
    fn default() -> Self {
        Self { inexact: Inexact::Orthonormalize(ROTATION_TOLERANCE), reference: [0.0; 6] }
    }
}

/// `l₁² = a₃² + d₄²` \[m²\].
const L1_SQUARED: f64 = A3 * A3 + D4 * D4;
/// `l₁`, the distance from axis 3 to the wrist \[m\].
pub(super) const L1: f64 = 1.068_812_892_886_308_7;
/// `φ = atan2(d₄, a₃)`, by which `κ` is more than `θ₃` \[rad\].
pub const PHI: f64 = 1.415_799_584_870_955_7;
const COS_PHI: f64 = A3 / L1;
const SIN_PHI: f64 = D4 / L1;

impl InverseKinematics {
    /// All configurations that reach the pose: up to eight, with angles in `[−π, π]`.
    ///
    /// | argument | meaning                                      | unit |
    /// |----------|----------------------------------------------|------|
    /// | `pose`   | of the flange, in the axes of the base       | m    |
    ///
    /// # Errors
    /// [`Error`]: a rotation that is none or not near enough to one, a position that is not finite or out of
    /// reach, a reference that is not finite, whether this pose needs it or not.
    pub fn solve(&self, pose: &Pose<f64>) -> Result<Solutions, Error> {
        for joint in [0, 3] {
            check::finite("reference of joint", self.reference[joint]).map_err(|error| error.of(joint))?;
        }
        let h = self.rotation(&pose.rotation)?;
        let p = &pose.position;
        check::finite("position", *p)?;
        let wrist = [p[0] - D6 * h[0][2], p[1] - D6 * h[1][2], p[2] - D6 * h[2][2]];

        let distance = Scalar::sqrt(wrist[0] * wrist[0] + wrist[1] * wrist[1]);
        let on_axis_1 = distance <= UNDETERMINED;
        let (theta_1, cos_1, sin_1) = if on_axis_1 {
            let (sin, cos) = Scalar::sin_cos(self.reference[0]);
            (wrapped(self.reference[0]), cos, sin)
        } else {
            (Scalar::atan2(wrist[1], wrist[0]), wrist[0] / distance, wrist[1] / distance)
        };
        let facing = Facing { theta_1, cos_1, sin_1, x: distance - A1, y: D1 - wrist[2], shoulder: Shoulder::Front };

        let mut solutions = Solutions::none();
        let front = self.reach(&facing, &h, on_axis_1, &mut solutions);
        // With the wrist on axis 1 the other shoulder is the same motion, half a turn further.
        let back = if on_axis_1 { front } else { self.reach(&facing.turned(distance), &h, false, &mut solutions) };
        match (front, back) {
            (Err(front), Err(back)) => {
                Err(if out_of_reach(&front) <= out_of_reach(&back) { front } else { back }.into())
            }
            _ => Ok(solutions),
        }
    }

    fn rotation(&self, rows: &[[f64; 3]; 3]) -> Result<[[f64; 3]; 3], NotARotation> {
        match self.inexact {
            Inexact::Reject(tolerance) => check_rotation(rows, tolerance).map(|_| *rows),
            Inexact::Orthonormalize(tolerance) => orthonormalized_within(rows, tolerance),
        }
    }

    /// The configurations of one shoulder.
    #[inline]
    fn reach(
        &self,
        facing: &Facing,
        h: &[[f64; 3]; 3],
        on_axis_1: bool,
        solutions: &mut Solutions,
    ) -> Result<(), Failure> {
        let triangle = Triangle::new(facing.x, facing.y)?;
        // The attitude in the axes of the arm's plane: rows along it, across it, and up.
        let (c, s) = (facing.cos_1, facing.sin_1);
        let along: [f64; 3] = core::array::from_fn(|j| c * h[0][j] + s * h[1][j]);
        let across: [f64; 3] = core::array::from_fn(|j| s * h[0][j] - c * h[1][j]);
        let stretched = triangle.kappa <= STRETCHED || PI - triangle.kappa <= STRETCHED;
        for elbow in [Elbow::Positive, Elbow::Negative] {
            if stretched && elbow == Elbow::Negative {
                break;
            }
            let arm = triangle.solve(elbow);
            let forward: [f64; 3] = core::array::from_fn(|j| arm.cos_23 * along[j] - arm.sin_23 * h[2][j]);
            let axial = -arm.sin_23 * along[2] - arm.cos_23 * h[2][2];
            let singular = Singularities { shoulder: on_axis_1, elbow: stretched, wrist: false };
            let branch = Branch { shoulder: facing.shoulder, elbow, wrist: Wrist::Positive };
            let q = [facing.theta_1, arm.theta_2, arm.theta_3, 0.0, 0.0, 0.0];
            self.turn_wrist(&forward, &across, axial, Solution { q, branch, singular }, solutions);
        }
        Ok(())
    }

    /// The configurations of the wrist, from the rotation that is left for it:
    ///
    /// ```text
    /// R₃ᵀ R = ⎡ forward ⎤   ⎡ c₄c₅c₆ − s₄s₆   −c₄c₅s₆ − s₄c₆   −c₄s₅ ⎤
    ///         ⎢ across  ⎥ = ⎢ s₄c₅c₆ + c₄s₆   −s₄c₅s₆ + c₄c₆   −s₄s₅ ⎥
    ///         ⎣   …     ⎦   ⎣ s₅c₆            −s₅s₆             c₅   ⎦
    /// ```
    #[inline]
    fn turn_wrist(
        &self,
        forward: &[f64; 3],
        across: &[f64; 3],
        cos_5: f64,
        mut solution: Solution,
        solutions: &mut Solutions,
    ) {
        let sin_5 = Scalar::sqrt(forward[2] * forward[2] + across[2] * across[2]);
        let (theta_4, cos_4, sin_4);
        if sin_5 <= UNDETERMINED {
            solution.singular.wrist = true;
            theta_4 = wrapped(self.reference[3]);
            (sin_4, cos_4) = Scalar::sin_cos(self.reference[3]);
        } else {
            theta_4 = Scalar::atan2(-across[2], -forward[2]);
            (cos_4, sin_4) = (-forward[2] / sin_5, -across[2] / sin_5);
        }
        // From θ₄ and not from the last row: so an error of θ₄, which is large where s₅ is small, is made good by θ₆.
        let sin_6 = cos_4 * across[0] - sin_4 * forward[0];
        let cos_6 = cos_4 * across[1] - sin_4 * forward[1];
        let theta_5 = Scalar::atan2(sin_5, cos_5);
        let theta_6 = Scalar::atan2(sin_6, cos_6);
        solution.q[3] = theta_4;
        solution.q[4] = theta_5;
        solution.q[5] = theta_6;
        solutions.push(solution);
        if !solution.singular.wrist {
            solution.branch.wrist = Wrist::Negative;
            solution.q[3] = opposite(theta_4);
            solution.q[4] = -theta_5;
            solution.q[5] = opposite(theta_6);
            solutions.push(solution);
        }
    }
}

/// The arm's plane, turned about axis 1, and the wrist in it, seen from axis 2.
struct Facing {
    theta_1: f64,
    cos_1: f64,
    sin_1: f64,
    /// Forward \[m\].
    x: f64,
    /// Down \[m\].
    y: f64,
    shoulder: Shoulder,
}

impl Facing {
    /// The other way, where the wrist is at this distance from axis 1.
    fn turned(&self, distance: f64) -> Self {
        Self {
            theta_1: opposite(self.theta_1),
            cos_1: -self.cos_1,
            sin_1: -self.sin_1,
            x: -distance - A1,
            y: self.y,
            shoulder: Shoulder::Back,
        }
    }
}

/// The triangle of axis 2, axis 3 and the wrist.
struct Triangle {
    /// The wrist from axis 2, forward and down \[m\].
    x: f64,
    y: f64,
    /// `1/ρ²` \[1/m²\].
    reciprocal: f64,
    /// The angle by which the forearm is bent from the upper arm's direction, in `[0, π]` \[rad\].
    kappa: f64,
    /// The wrist along the upper arm, `a₂ + l₁ cos κ`, and across it, `l₁ sin κ` \[m\].
    u: f64,
    v: f64,
}

/// The first three joints of one branch.
struct Bent {
    theta_2: f64,
    theta_3: f64,
    cos_23: f64,
    sin_23: f64,
}

impl Triangle {
    #[inline]
    fn new(x: f64, y: f64) -> Result<Self, Failure> {
        let square = x * x + y * y;
        let rho = Scalar::sqrt(square);
        let short = (A2 + L1) - rho;
        let excess = rho - (A2 - L1).abs();
        if short < -REACH_TOLERANCE {
            return Err(Failure::TooFar { by: -short });
        }
        if excess < -REACH_TOLERANCE {
            return Err(Failure::TooNear { by: -excess });
        }
        // (a₂ + l₁)² − ρ² and ρ² − (a₂ − l₁)², whose sum is 4 a₂ l₁.
        let short = Scalar::sqrt(short.max(0.0) * ((A2 + L1) + rho));
        let excess = Scalar::sqrt(excess.max(0.0) * (rho + (A2 - L1).abs()));
        Ok(Self {
            x,
            y,
            reciprocal: 1.0 / square,
            kappa: 2.0 * Scalar::atan2(short, excess),
            // The law of cosines, as a sum of positive terms: a₂ > l₁.
            u: (square + (A2 * A2 - L1_SQUARED)) / (2.0 * A2),
            v: short * excess / (2.0 * A2),
        })
    }

    #[inline]
    fn solve(&self, elbow: Elbow) -> Bent {
        let (kappa, v) = match elbow {
            Elbow::Positive => (self.kappa, self.v),
            Elbow::Negative => (-self.kappa, -self.v),
        };
        // e^{iθ₂} = (x + i y)/(u + i v).
        let cos_2 = (self.x * self.u + self.y * v) * self.reciprocal;
        let sin_2 = (self.y * self.u - self.x * v) * self.reciprocal;
        // l₁ e^{i(θ₂ + κ)} = (x + i y) − a₂ e^{iθ₂}, and θ₂ + θ₃ = θ₂ + κ − φ.
        let (along, across) = ((self.x - A2 * cos_2) / L1, (self.y - A2 * sin_2) / L1);
        Bent {
            theta_2: Scalar::atan2(sin_2, cos_2),
            theta_3: wrapped(kappa - PHI),
            cos_23: along * COS_PHI + across * SIN_PHI,
            sin_23: across * COS_PHI - along * SIN_PHI,
        }
    }
}

/// How far a pose is out of reach \[m\].
fn out_of_reach(failure: &Failure) -> f64 {
    match *failure {
        Failure::TooFar { by } | Failure::TooNear { by } => by,
        _ => f64::INFINITY,
    }
}

/// The direction half a turn further, in `[−π, π]`.
#[inline]
fn opposite(angle: f64) -> f64 {
    if angle > 0.0 { angle - PI } else { angle + PI }
}

/// The angle in `[−π, π]` that differs by whole turns.
#[inline]
fn wrapped(angle: f64) -> f64 {
    if (-PI..=PI).contains(&angle) {
        return angle;
    }
    let rest = angle % TAU;
    if rest > PI {
        rest - TAU
    } else if rest < -PI {
        rest + TAU
    } else {
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_those_of_the_table() {
        assert_eq!(L1, Scalar::sqrt(L1_SQUARED));
        assert_eq!(PHI, Scalar::atan2(D4, A3));
        assert!((COS_PHI * COS_PHI + SIN_PHI * SIN_PHI - 1.0).abs() < 1e-15);
        // The folded arm does not reach axis 2, and the side along the upper arm is positive.
        const { assert!(A2 > L1) };
    }

    #[test]
    fn angles_are_wrapped() {
        for (angle, want) in
            [(0.0, 0.0), (PI, PI), (-PI, -PI), (4.0, 4.0 - TAU), (-4.0, TAU - 4.0), (9.0 * PI / 2.0, PI / 2.0)]
        {
            assert!((wrapped(angle) - want).abs() < 1e-14, "{angle}: {}", wrapped(angle));
        }
        assert_eq!([opposite(1.0), opposite(-1.0), opposite(0.0)], [1.0 - PI, PI - 1.0, PI]);
    }

    #[test]
    fn a_reference_that_is_not_finite_is_refused() {
        let arm = crate::Arm::default();
        // The wrist straight; and any pose at all.
        for q in [[0.3, -1.0, 0.2, 0.4, 0.0, 0.1], [0.3, -1.0, 0.2, 0.4, 0.5, 0.1]] {
            let pose = arm.pose(&q);
            for joint in [0, 3] {
                for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let mut reference = [0.0; 6];
                    reference[joint] = value;
                    let refused = (InverseKinematics { reference, ..Default::default() }).solve(&pose).unwrap_err();
                    let found = refused.invalid().expect("a number");
                    assert_eq!((found.parameter, found.index), ("reference of joint", Some(joint)));
                    assert_eq!(found.value.to_bits(), value.to_bits());
                }
            }
            // The other angles are not asked for.
            let reference = [0.0, f64::NAN, f64::NAN, 0.0, f64::NAN, f64::NAN];
            let solutions = (InverseKinematics { reference, ..Default::default() }).solve(&pose).expect("reachable");
            assert!(solutions.iter().all(|solution| solution.q.iter().all(|angle| angle.is_finite())));
        }
    }

    #[test]
    fn the_law_of_cosines_by_half_angles() {
        // A right angle between upper arm and forearm.
        let triangle = Triangle::new(A2, L1).expect("a triangle");
        assert!((triangle.kappa - PI / 2.0).abs() < 1e-15);
        assert!((triangle.u - A2).abs() < 1e-15 && (triangle.v - L1).abs() < 1e-15);
        let bent = triangle.solve(Elbow::Positive);
        assert!(bent.theta_2.abs() < 1e-15 && (bent.theta_3 - (PI / 2.0 - PHI)).abs() < 1e-15);
        // Straight, and 1e-12 m short of it: κ² l₁ a₂/(a₂ + l₁) = 2e-12.
        let straight = Triangle::new(0.0, A2 + L1).expect("a triangle");
        assert_eq!((straight.kappa, straight.v), (0.0, 0.0));
        let short = Triangle::new(0.0, A2 + L1 - 1e-12).expect("a triangle");
        let want = Scalar::sqrt(2e-12 * (A2 + L1) / (A2 * L1));
        // The distance itself is known to 4e-16 of 1e-12.
        assert!((short.kappa / want - 1.0).abs() < 3e-4, "{} {want}", short.kappa);
    }
}
