//! Quasi-static insertion in closed form: forces of one-point contact, jamming, wedging.
//!
//! Whitney's letters: r radius of the peg, R of the hole, `c = (R − r)/R`, μ friction, ℓ depth, `λ = ℓ/(2 r μ)`; K_x
//! and K_θ stiffnesses of the support at its centre, which is L_g above the tip.

/// The normal force of an edge on the side of the peg, one-point contact at the depth ℓ \[N\], while the peg goes down:
///
/// ```text
/// N = K_x K_θ (e + (L_g − ℓ) α)/(K_θ + K_x (L_g − ℓ) (L_g − ℓ − μ r))
/// ```
///
/// | argument                    | meaning                                                            | unit        |
/// |-----------------------------|--------------------------------------------------------------------|-------------|
/// | `stiffness`                 | K_x, K_θ                                                           | N/m, N·m/rad |
/// | `centre`, `depth`, `radius` | L_g, ℓ (0 where the corner touches the bore), r                    | m           |
/// | `friction`                  | μ                                                                  | –           |
/// | `error`                     | e, by which the undeflected peg's side would be beyond the edge, at the centre | m |
/// | `tilt`                      | α, by which the undeflected peg leans away from that edge          | rad         |
///
/// # Source
/// Whitney 1982, the section on one-point contact, for small angles; with the error counted from contact.
#[must_use]
pub fn one_point_force(
    [lateral, angular]: [f64; 2],
    [centre, depth, radius]: [f64; 3],
    friction: f64,
    [error, tilt]: [f64; 2],
) -> f64 {
    let lever = centre - depth;
    lateral * angular * (error + lever * tilt) / (angular + lateral * lever * (lever - friction * radius))
}

/// The depth at which a peg that leans by θ in the hole touches on both sides: `ℓ₂ = 2 (R − r)/|θ|`, for small angles
/// \[m\].
#[must_use]
pub fn two_point_depth(clearance: f64, tilt: f64) -> f64 {
    2.0 * clearance / tilt.abs()
}

/// Whether two-point contact at this depth can wedge: the line between both contacts is within both cones of friction,
/// `ℓ ≤ 2 r μ`. Then forces between them hold each other, and no push gets the peg on.
#[must_use]
pub fn can_wedge(depth: f64, radius: f64, friction: f64) -> bool {
    depth <= 2.0 * radius * friction
}

/// Whether a peg that does not move stays so under a push: outside of Whitney's jamming diagram.
///
/// `lateral` and `moment` are `F_x/F_z` and `M/(r F_z)` at the tip, F_z down, M from x to z. The peg goes on if
///
/// ```text
/// |F_x/F_z| < 1/μ   and   |M/(r F_z) + μ (1 + λ) F_x/F_z| < λ
/// ```
#[must_use]
pub fn jams([lateral, moment]: [f64; 2], depth: f64, radius: f64, friction: f64) -> bool {
    let lambda = depth / (2.0 * radius * friction);
    let inside = lateral.abs() * friction < 1.0 && (moment + friction * (1.0 + lambda) * lateral).abs() < lambda;
    !inside
}
