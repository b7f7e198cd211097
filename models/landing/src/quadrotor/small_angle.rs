//! The plant for small angles and rates: (5.8) and (5.12), corrected.
//!
//! ```text
//! ẍ = (sφ sψ + cφ sθ cψ) U/m − k |ẋ| ẋ        φ̈ = ((Iy − Iz) θ̇ ψ̇ − J θ̇ Ω + τx) / Ix
//! ÿ = (sψ sθ cφ − cψ sφ) U/m − k |ẏ| ẏ        θ̈ = ((Iz − Ix) φ̇ ψ̇ + J φ̇ Ω + τy) / Iy
//! z̈ = cθ cφ U/m − g − k |ż| ż                 ψ̈ = ((Ix − Iy) φ̇ θ̇ + τz) / Iz
//! ```
//!
//! with `k = C ρ A / 2m` and `Ω = Ω₂ + Ω₄ − Ω₁ − Ω₃`; in wind, velocities of the drag are those against the air. It
//! takes the rates of the Euler angles for the angular velocity: its error is of the first order in the angles.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, equations (5.8) and (5.12), corrected: the
//! sign of the drag (E27) and of a rotor's term (E31), a lost dot (E28), `cθ cφ` in z̈ (E26 of
//! `docs/thesis/errata.md`).

use mbs_runtime::Scalar;

use super::mixer::Mixer;
use mbs_models::quadrotor_euler::Params;

/// `q̈` at these rotor speeds \[rad/s\], in wind with this velocity \[m/s\].
#[must_use]
pub fn accelerations(
    params: &Params<f64>,
    wind: &[f64; 3],
    q: &[f64; 6],
    qd: &[f64; 6],
    rotor_speed: &[f64; 4],
) -> [f64; 6] {
    let [_, _, _, phi, theta, psi] = *q;
    let [xd, yd, zd, phid, thetad, psid] = *qd;
    let [ix, iy, iz] = params.inertias;
    let effort = Mixer::new(params).effort(rotor_speed);
    let [o1, o2, o3, o4] = *rotor_speed;
    let spin = params.rotor_inertia * (o2 + o4 - o1 - o3);
    let ((sr, cr), (sp, cp), (sy, cy)) = (Scalar::sin_cos(phi), Scalar::sin_cos(theta), Scalar::sin_cos(psi));
    let u = effort.thrust / params.m;
    let k = params.drag_coefficient * params.air_density * params.area / (2.0 * params.m);
    let drag = |v: f64| -k * v.abs() * v;
    [
        (sr * sy + cr * sp * cy) * u + drag(xd - wind[0]),
        (sy * sp * cr - cy * sr) * u + drag(yd - wind[1]),
        cp * cr * u - params.g + drag(zd - wind[2]),
        ((iy - iz) * thetad * psid - spin * thetad + effort.torque[0]) / ix,
        ((iz - ix) * phid * psid + spin * phid + effort.torque[1]) / iy,
        ((ix - iy) * phid * thetad + effort.torque[2]) / iz,
    ]
}
