//! The arm of `models/mechanisms/arm6.mbs`, customised as a specialist would do it by hand: straight-line code for this
//! arm alone, constants folded, terms with zero factors dropped, bodies regrouped to base inertial parameters.
//!
//! | function | additions and multiplications | |
//! |---|---|---|
//! | [`inverse_dynamics`] | 511 | Newton–Euler |
//! | [`bias`] | 473 | the same without q̈ |
//! | [`mass_matrix`] | 263 | composite bodies |
//! | [`forward_dynamics`] | 893, 6 divisions | both, and `M = L D Lᵀ` |
//!
//! Sines and cosines come besides: five pairs. The code is compiled three times, each time for the numbers and with the
//! sines of the module around it: [`super::super::custom_newton_euler`], `custom_vector_sines`, `custom_lanes`.
//!
//! # Source
//!
//! Khalil, Dombre, *Modeling, Identification and Control of Robots*, 2002: customised Newton–Euler, section 9.5 (the
//! products of rates are shared in `U = [ω̇]× + [ω]×[ω]×`), base inertial parameters, section 9.4.3 (`Jyy = 0`, centres
//! of mass on the axes' planes, no mass at all), composite bodies, section 9.7. The code was written out by a script
//! from these formulas and the arm's Denavit–Hartenberg parameters.
//!
//! # Names
//!
//! Frame i has its z axis along joint i. The digit of a name is its frame, the letters after it the components.
//!
//! | name | |
//! |---|---|
//! | `s2`, `c2` | sine and cosine of a joint angle |
//! | `w`, `e` | ω, ω̇; `w2xy` is a product of two components of ω; `r` is ω̇ of the frame before, turned |
//! | `u`, `v` | entries of U, differences of its diagonal |
//! | `a`, `b` | acceleration of the origin of a frame; of the next one's, before it is turned |
//! | `f`, `m` | force and moment of a link; with `p`, `q`: turned to the frame before |
//! | `g`, `n` | force and moment at a joint, of all links beyond |
//! | `f54`, `n54` | those that joint 5's unit acceleration takes at joint 4 |
//! | `p`, `j` | first moments and inertias of composite bodies, about the frame's origin |

#[path = "custom_arm6/composite_bodies.rs"]
mod composite_bodies;

use super::{Number, sin_cos};
use composite_bodies::{mass_matrix_at, solve};

/// `M q̈ + C q̇ + G`.
pub(crate) fn inverse_dynamics(q: &[Number; 6], qd: &[Number; 6], qdd: &[Number; 6]) -> [Number; 6] {
    let [(s2, c2), (s3, c3), (s4, c4), (s5, c5), (s6, c6)] = angles(q);
    let [qd1, qd2, qd3, qd4, qd5, qd6] = *qd;
    let [qdd1, qdd2, qdd3, qdd4, qdd5, qdd6] = *qdd;
    let w1zz = qd1 * qd1;
    let m1z = 94.690734 * qdd1;
    let b1x = -0.41 * w1zz;
    let b1y = 0.41 * qdd1;
    let a2x = c2 * b1x - 9.81 * s2;
    let a2y = -9.81 * c2 - s2 * b1x;
    let w2x = -s2 * qd1;
    let w2y = -c2 * qd1;
    let r2x = -s2 * qdd1;
    let r2y = -c2 * qdd1;
    let e2x = r2x + w2y * qd2;
    let e2y = r2y - w2x * qd2;
    let w2xx = w2x * w2x;
    let w2yy = w2y * w2y;
    let w2zz = qd2 * qd2;
    let w2xy = w2x * w2y;
    let w2xz = w2x * qd2;
    let w2yz = w2y * qd2;
    let u2xx = -w2yy - w2zz;
    let u2xy = w2xy - qdd2;
    let u2xz = w2xz + e2y;
    let u2yx = w2xy + qdd2;
    let u2yy = -w2xx - w2zz;
    let u2yz = w2yz - e2x;
    let u2zx = w2xz - e2y;
    let u2zy = w2yz + e2x;
    let u2zz = -w2xx - w2yy;
    let f2z = 75.6625 * u2zx + 0.9 * u2zy;
    let v2yz = u2yy - u2zz;
    let v2zx = u2zz - u2xx;
    let v2xy = u2xx - u2yy;
    let m2x = 73.2161035 * w2yz + 0.525348 * u2zx + 0.876157 * v2yz + 0.9 * b1y - 68.4504025 * e2x - 1.234624 * u2yx;
    let m2y = -141.666506 * w2xz - 0.525348 * u2zy - 0.876157 * u2xy - 1.234624 * v2zx - 75.6625 * b1y;
    let m2z = 73.2161035 * qdd2 + 68.4504025 * w2xy + 1.234624 * u2yz + 0.876157 * u2xz - 0.525348 * v2xy
        + 75.6625 * a2y
        - 0.9 * a2x;
    let b2x = a2x + 1.075 * u2xx;
    let b2y = a2y + 1.075 * u2yx;
    let b2z = b1y + 1.075 * u2zx;
    let a3x = c3 * b2x + s3 * b2y;
    let a3y = c3 * b2y - s3 * b2x;
    let w3x = c3 * w2x + s3 * w2y;
    let w3y = c3 * w2y - s3 * w2x;
    let r3x = c3 * e2x + s3 * e2y;
    let r3y = c3 * e2y - s3 * e2x;
    let e3x = r3x + w3y * qd3;
    let e3y = r3y - w3x * qd3;
    let e3z = qdd2 + qdd3;
    let w3z = qd2 + qd3;
    let w3xx = w3x * w3x;
    let w3yy = w3y * w3y;
    let w3zz = w3z * w3z;
    let w3xy = w3x * w3y;
    let w3xz = w3x * w3z;
    let w3yz = w3y * w3z;
    let u3xx = -w3yy - w3zz;
    let u3xy = w3xy - e3z;
    let u3xz = w3xz + e3y;
    let u3yx = w3xy + e3z;
    let u3yy = -w3xx - w3zz;
    let u3yz = w3yz - e3x;
    let u3zx = w3xz - e3y;
    let u3zy = w3yz + e3x;
    let u3zz = -w3xx - w3yy;
    let f3x = 6.8325 * u3xx + 19.248 * u3xy;
    let f3y = 6.8325 * u3yx + 19.248 * u3yy;
    let f3z = 6.8325 * u3zx + 19.248 * u3zy;
    let v3yz = u3yy - u3zz;
    let v3zx = u3zz - u3xx;
    let v3xy = u3xx - u3yy;
    let m3x = 15.2605205 * e3x + 17.6243655 * w3yz + 3.0326 * u3zx + 0.05451 * u3yx + 0.110677 * v3yz + 19.248 * b2z;
    let m3y = 0.05451 * v3zx - 2.363845 * w3xz - 3.0326 * u3zy - 0.110677 * u3xy - 6.8325 * b2z;
    let m3z = 17.6243655 * e3z - 15.2605205 * w3xy - 0.05451 * u3yz + 0.110677 * u3xz - 3.0326 * v3xy + 6.8325 * a3y
        - 19.248 * a3x;
    let b3x = a3x + 0.165 * u3xx;
    let b3y = a3y + 0.165 * u3yx;
    let b3z = b2z + 0.165 * u3zx;
    let a4x = c4 * b3x - s4 * b3z;
    let a4y = -c4 * b3z - s4 * b3x;
    let w4x = c4 * w3x - s4 * w3z;
    let w4y = -c4 * w3z - s4 * w3x;
    let r4x = c4 * e3x - s4 * e3z;
    let r4y = -c4 * e3z - s4 * e3x;
    let e4x = r4x + w4y * qd4;
    let e4y = r4y - w4x * qd4;
    let e4z = e3y + qdd4;
    let w4z = w3y + qd4;
    let w4xx = w4x * w4x;
    let w4yy = w4y * w4y;
    let w4zz = w4z * w4z;
    let w4xy = w4x * w4y;
    let w4xz = w4x * w4z;
    let w4yz = w4y * w4z;
    let u4xx = -w4yy - w4zz;
    let u4xy = w4xy - e4z;
    let u4xz = w4xz + e4y;
    let u4yx = w4xy + e4z;
    let u4yy = -w4xx - w4zz;
    let u4yz = w4yz - e4x;
    let u4zx = w4xz - e4y;
    let u4zy = w4yz + e4x;
    let u4zz = -w4xx - w4yy;
    let f4x = 0.12 * u4xx - 0.18 * u4xy;
    let f4y = 0.12 * u4yx - 0.18 * u4yy;
    let f4z = 0.12 * u4zx - 0.18 * u4zy;
    let v4yz = u4yy - u4zz;
    let v4zx = u4zz - u4xx;
    let v4xy = u4xx - u4yy;
    let m4x = 0.101007 * e4x + 0.373829 * w4yz + 0.020158 * u4zx - 0.036398 * u4yx + 0.0275 * v4yz - 0.18 * b3y;
    let m4y = -0.272822 * w4xz - 0.020158 * u4zy - 0.0275 * u4xy - 0.036398 * v4zx - 0.12 * b3y;
    let m4z =
        0.373829 * e4z - 0.101007 * w4xy + 0.036398 * u4yz + 0.0275 * u4xz - 0.020158 * v4xy + 0.12 * a4y + 0.18 * a4x;
    let b4x = a4x + 1.056 * u4xz;
    let b4y = a4y + 1.056 * u4yz;
    let b4z = b3y + 1.056 * u4zz;
    let a5x = c5 * b4x + s5 * b4z;
    let a5y = c5 * b4z - s5 * b4x;
    let w5x = c5 * w4x + s5 * w4z;
    let w5y = c5 * w4z - s5 * w4x;
    let r5x = c5 * e4x + s5 * e4z;
    let r5y = c5 * e4z - s5 * e4x;
    let e5x = r5x + w5y * qd5;
    let e5y = r5y - w5x * qd5;
    let e5z = qdd5 - e4y;
    let w5z = qd5 - w4y;
    let w5xx = w5x * w5x;
    let w5yy = w5y * w5y;
    let w5zz = w5z * w5z;
    let w5xy = w5x * w5y;
    let w5xz = w5x * w5z;
    let w5yz = w5y * w5z;
    let u5xx = -w5yy - w5zz;
    let u5xy = w5xy - e5z;
    let u5xz = w5xz + e5y;
    let u5yx = w5xy + e5z;
    let u5yy = -w5xx - w5zz;
    let u5yz = w5yz - e5x;
    let u5zx = w5xz - e5y;
    let u5zy = w5yz + e5x;
    let u5zz = -w5xx - w5yy;
    let f5x = 0.03 * u5xx + 0.665 * u5xy;
    let f5y = 0.03 * u5yx + 0.665 * u5yy;
    let f5z = 0.03 * u5zx + 0.665 * u5zy;
    let v5yz = u5yy - u5zz;
    let v5zx = u5zz - u5xx;
    let v5xy = u5xx - u5yy;
    let m5x = 0.084293 * e5x + 0.107899 * w5yz - 0.002931 * u5zx + 0.003291 * u5yx + 0.002041 * v5yz - 0.665 * b4y;
    let m5y = 0.002931 * u5zy + 0.003291 * v5zx + 0.03 * b4y - 0.023606 * w5xz - 0.002041 * u5xy;
    let m5z = 0.107899 * e5z - 0.084293 * w5xy - 0.003291 * u5yz + 0.002041 * u5xz + 0.002931 * v5xy + 0.03 * a5y
        - 0.665 * a5x;
    let a6x = c6 * a5x + s6 * b4y;
    let a6y = c6 * b4y - s6 * a5x;
    let w6x = c6 * w5x - s6 * w5z;
    let w6y = -c6 * w5z - s6 * w5x;
    let r6x = c6 * e5x - s6 * e5z;
    let r6y = -c6 * e5z - s6 * e5x;
    let e6x = r6x + w6y * qd6;
    let e6y = r6y - w6x * qd6;
    let e6z = e5y + qdd6;
    let w6z = w5y + qd6;
    let w6xx = w6x * w6x;
    let w6yy = w6y * w6y;
    let w6zz = w6z * w6z;
    let w6xy = w6x * w6y;
    let w6xz = w6x * w6z;
    let w6yz = w6y * w6z;
    let u6xx = -w6yy - w6zz;
    let u6xy = w6xy - e6z;
    let u6xz = w6xz + e6y;
    let u6yx = w6xy + e6z;
    let u6yy = -w6xx - w6zz;
    let u6yz = w6yz - e6x;
    let u6zx = w6xz - e6y;
    let u6zy = w6yz + e6x;
    let u6zz = -w6xx - w6yy;
    let f6x = 0.005 * u6xx - 0.0075 * u6xy;
    let f6y = 0.005 * u6yx - 0.0075 * u6yy;
    let f6z = 0.005 * u6zx - 0.0075 * u6zy;
    let v6yz = u6yy - u6zz;
    let v6zx = u6zz - u6xx;
    let v6xy = u6xx - u6yy;
    let m6x = 0.0038485 * w6yz + 0.001765 * v6yz - 0.0009565 * e6x - 0.000296 * u6zx - 0.000996 * u6yx - 0.0075 * a5y;
    let m6y = 0.000296 * u6zy - 0.004805 * w6xz - 0.001765 * u6xy - 0.000996 * v6zx - 0.005 * a5y;
    let m6z = 0.0038485 * e6z
        + 0.0009565 * w6xy
        + 0.000996 * u6yz
        + 0.001765 * u6xz
        + 0.000296 * v6xy
        + 0.005 * a6y
        + 0.0075 * a6x;
    let f6p = c6 * f6x - s6 * f6y;
    let f6q = s6 * f6x + c6 * f6y;
    let m6p = c6 * m6x - s6 * m6y;
    let m6q = s6 * m6x + c6 * m6y;
    let n5x = m5x + m6p;
    let n5y = m5y + m6z;
    let n5z = m5z - m6q;
    let g5x = f5x + f6p;
    let g5y = f5y + f6z;
    let g5z = f5z - f6q;
    let f5p = c5 * g5x - s5 * g5y;
    let f5q = s5 * g5x + c5 * g5y;
    let m5p = c5 * n5x - s5 * n5y;
    let m5q = s5 * n5x + c5 * n5y;
    let n4x = m4x + m5p + 1.056 * g5z;
    let n4y = m4y - n5z + 1.056 * f5p;
    let n4z = m4z + m5q;
    let g4x = f4x + f5p;
    let g4y = f4y - g5z;
    let g4z = f4z + f5q;
    let f4p = c4 * g4x - s4 * g4y;
    let f4q = s4 * g4x + c4 * g4y;
    let m4p = c4 * n4x - s4 * n4y;
    let m4q = s4 * n4x + c4 * n4y;
    let n3x = m3x + m4p;
    let n3y = m3y + n4z + 0.165 * f4q;
    let n3z = m3z - m4q + 0.165 * g4z;
    let g3x = f3x + f4p;
    let g3y = f3y + g4z;
    let g3z = f3z - f4q;
    let f3q = s3 * g3x + c3 * g3y;
    let m3p = c3 * n3x - s3 * n3y;
    let m3q = s3 * n3x + c3 * n3y;
    let n2x = m2x + m3p;
    let n2y = m2y + m3q - 1.075 * g3z;
    let n2z = m2z + n3z + 1.075 * f3q;
    let g2z = f2z + g3z;
    let m2q = s2 * n2x + c2 * n2y;
    let n1z = m1z - m2q + 0.41 * g2z;
    [n1z, n2z, n3z, n4z, n5z, m6z]
}

/// `C q̇ + G`.
pub(crate) fn bias(q: &[Number; 6], qd: &[Number; 6]) -> [Number; 6] {
    bias_at(&angles(q), qd)
}

/// `M`, both triangles.
pub(crate) fn mass_matrix(q: &[Number; 6]) -> [[Number; 6]; 6] {
    let [m11, m21, m22, m31, m32, m33, m41, m42, m43, m44, m51, m52, m53, m54, m55, m61, m62, m63, m64, m65, m66] =
        mass_matrix_at(&angles(q));
    [
        [m11, m21, m31, m41, m51, m61],
        [m21, m22, m32, m42, m52, m62],
        [m31, m32, m33, m43, m53, m63],
        [m41, m42, m43, m44, m54, m64],
        [m51, m52, m53, m54, m55, m65],
        [m61, m62, m63, m64, m65, m66],
    ]
}

/// `M⁻¹ (τ − C q̇ − G)`.
pub(crate) fn forward_dynamics(q: &[Number; 6], qd: &[Number; 6], tau: &[Number; 6]) -> [Number; 6] {
    let angles = angles(q);
    let h = bias_at(&angles, qd);
    solve(&mass_matrix_at(&angles), &std::array::from_fn(|i| tau[i] - h[i]))
}

/// Sines and cosines of all joints but the first, which is upright.
fn angles(q: &[Number; 6]) -> [(Number, Number); 5] {
    sin_cos([q[1], q[2], q[3], q[4], q[5]])
}

fn bias_at(angles: &[(Number, Number); 5], qd: &[Number; 6]) -> [Number; 6] {
    let [(s2, c2), (s3, c3), (s4, c4), (s5, c5), (s6, c6)] = *angles;
    let [qd1, qd2, qd3, qd4, qd5, qd6] = *qd;
    let w1zz = qd1 * qd1;
    let b1x = -0.41 * w1zz;
    let a2x = c2 * b1x - 9.81 * s2;
    let a2y = -9.81 * c2 - s2 * b1x;
    let w2x = -s2 * qd1;
    let w2y = -c2 * qd1;
    let e2x = w2y * qd2;
    let e2y = -w2x * qd2;
    let w2xx = w2x * w2x;
    let w2yy = w2y * w2y;
    let w2zz = qd2 * qd2;
    let w2xy = w2x * w2y;
    let u2xx = -w2yy - w2zz;
    let u2yy = -w2xx - w2zz;
    let u2zx = -2.0 * e2y;
    let u2zy = 2.0 * e2x;
    let u2zz = -w2xx - w2yy;
    let f2z = 75.6625 * u2zx + 0.9 * u2zy;
    let v2yz = u2yy - u2zz;
    let v2zx = u2zz - u2xx;
    let v2xy = u2xx - u2yy;
    let m2x = 4.765701 * e2x + 0.525348 * u2zx - 1.234624 * w2xy + 0.876157 * v2yz;
    let m2y = 141.666506 * e2y - 0.525348 * u2zy - 0.876157 * w2xy - 1.234624 * v2zx;
    let m2z = 68.4504025 * w2xy - 0.525348 * v2xy + 75.6625 * a2y - 0.9 * a2x;
    let b2x = a2x + 1.075 * u2xx;
    let b2y = a2y + 1.075 * w2xy;
    let b2z = 1.075 * u2zx;
    let a3x = c3 * b2x + s3 * b2y;
    let a3y = c3 * b2y - s3 * b2x;
    let w3x = c3 * w2x + s3 * w2y;
    let w3y = c3 * w2y - s3 * w2x;
    let r3x = c3 * e2x + s3 * e2y;
    let r3y = c3 * e2y - s3 * e2x;
    let e3x = r3x + w3y * qd3;
    let e3y = r3y - w3x * qd3;
    let w3z = qd2 + qd3;
    let w3xx = w3x * w3x;
    let w3yy = w3y * w3y;
    let w3zz = w3z * w3z;
    let w3xy = w3x * w3y;
    let w3xz = w3x * w3z;
    let w3yz = w3y * w3z;
    let u3xx = -w3yy - w3zz;
    let u3xz = w3xz + e3y;
    let u3yy = -w3xx - w3zz;
    let u3yz = w3yz - e3x;
    let u3zx = w3xz - e3y;
    let u3zy = w3yz + e3x;
    let u3zz = -w3xx - w3yy;
    let f3x = 6.8325 * u3xx + 19.248 * w3xy;
    let f3y = 6.8325 * w3xy + 19.248 * u3yy;
    let f3z = 6.8325 * u3zx + 19.248 * u3zy;
    let v3yz = u3yy - u3zz;
    let v3zx = u3zz - u3xx;
    let v3xy = u3xx - u3yy;
    let m3x = 15.2605205 * e3x + 17.6243655 * w3yz + 3.0326 * u3zx + 0.05451 * w3xy + 0.110677 * v3yz + 19.248 * b2z;
    let m3y = 0.05451 * v3zx - 2.363845 * w3xz - 3.0326 * u3zy - 0.110677 * w3xy - 6.8325 * b2z;
    let m3z = 0.110677 * u3xz + 6.8325 * a3y - 15.2605205 * w3xy - 0.05451 * u3yz - 3.0326 * v3xy - 19.248 * a3x;
    let b3x = a3x + 0.165 * u3xx;
    let b3y = a3y + 0.165 * w3xy;
    let b3z = b2z + 0.165 * u3zx;
    let a4x = c4 * b3x - s4 * b3z;
    let a4y = -c4 * b3z - s4 * b3x;
    let w4x = c4 * w3x - s4 * w3z;
    let w4y = -c4 * w3z - s4 * w3x;
    let r4x = c4 * e3x;
    let r4y = -s4 * e3x;
    let e4x = r4x + w4y * qd4;
    let e4y = r4y - w4x * qd4;
    let w4z = w3y + qd4;
    let w4xx = w4x * w4x;
    let w4yy = w4y * w4y;
    let w4zz = w4z * w4z;
    let w4xy = w4x * w4y;
    let w4xz = w4x * w4z;
    let w4yz = w4y * w4z;
    let u4xx = -w4yy - w4zz;
    let u4xy = w4xy - e3y;
    let u4xz = w4xz + e4y;
    let u4yx = w4xy + e3y;
    let u4yy = -w4xx - w4zz;
    let u4yz = w4yz - e4x;
    let u4zx = w4xz - e4y;
    let u4zy = w4yz + e4x;
    let u4zz = -w4xx - w4yy;
    let f4x = 0.12 * u4xx - 0.18 * u4xy;
    let f4y = 0.12 * u4yx - 0.18 * u4yy;
    let f4z = 0.12 * u4zx - 0.18 * u4zy;
    let v4yz = u4yy - u4zz;
    let v4zx = u4zz - u4xx;
    let v4xy = u4xx - u4yy;
    let m4x = 0.101007 * e4x + 0.373829 * w4yz + 0.020158 * u4zx - 0.036398 * u4yx + 0.0275 * v4yz - 0.18 * b3y;
    let m4y = -0.272822 * w4xz - 0.020158 * u4zy - 0.0275 * u4xy - 0.036398 * v4zx - 0.12 * b3y;
    let m4z =
        0.373829 * e3y - 0.101007 * w4xy + 0.036398 * u4yz + 0.0275 * u4xz - 0.020158 * v4xy + 0.12 * a4y + 0.18 * a4x;
    let b4x = a4x + 1.056 * u4xz;
    let b4y = a4y + 1.056 * u4yz;
    let b4z = b3y + 1.056 * u4zz;
    let a5x = c5 * b4x + s5 * b4z;
    let a5y = c5 * b4z - s5 * b4x;
    let w5x = c5 * w4x + s5 * w4z;
    let w5y = c5 * w4z - s5 * w4x;
    let r5x = c5 * e4x + s5 * e3y;
    let r5y = c5 * e3y - s5 * e4x;
    let e5x = r5x + w5y * qd5;
    let e5y = r5y - w5x * qd5;
    let w5z = qd5 - w4y;
    let w5xx = w5x * w5x;
    let w5yy = w5y * w5y;
    let w5zz = w5z * w5z;
    let w5xy = w5x * w5y;
    let w5xz = w5x * w5z;
    let w5yz = w5y * w5z;
    let u5xx = -w5yy - w5zz;
    let u5xy = w5xy + e4y;
    let u5xz = w5xz + e5y;
    let u5yx = w5xy - e4y;
    let u5yy = -w5xx - w5zz;
    let u5yz = w5yz - e5x;
    let u5zx = w5xz - e5y;
    let u5zy = w5yz + e5x;
    let u5zz = -w5xx - w5yy;
    let f5x = 0.03 * u5xx + 0.665 * u5xy;
    let f5y = 0.03 * u5yx + 0.665 * u5yy;
    let f5z = 0.03 * u5zx + 0.665 * u5zy;
    let v5yz = u5yy - u5zz;
    let v5zx = u5zz - u5xx;
    let v5xy = u5xx - u5yy;
    let m5x = 0.084293 * e5x + 0.107899 * w5yz - 0.002931 * u5zx + 0.003291 * u5yx + 0.002041 * v5yz - 0.665 * b4y;
    let m5y = 0.002931 * u5zy + 0.003291 * v5zx + 0.03 * b4y - 0.023606 * w5xz - 0.002041 * u5xy;
    let m5z = 0.002041 * u5xz + 0.002931 * v5xy + 0.03 * a5y
        - 0.107899 * e4y
        - 0.084293 * w5xy
        - 0.003291 * u5yz
        - 0.665 * a5x;
    let a6x = c6 * a5x + s6 * b4y;
    let a6y = c6 * b4y - s6 * a5x;
    let w6x = c6 * w5x - s6 * w5z;
    let w6y = -c6 * w5z - s6 * w5x;
    let r6x = c6 * e5x + s6 * e4y;
    let r6y = c6 * e4y - s6 * e5x;
    let e6x = r6x + w6y * qd6;
    let e6y = r6y - w6x * qd6;
    let w6z = w5y + qd6;
    let w6xx = w6x * w6x;
    let w6yy = w6y * w6y;
    let w6zz = w6z * w6z;
    let w6xy = w6x * w6y;
    let w6xz = w6x * w6z;
    let w6yz = w6y * w6z;
    let u6xx = -w6yy - w6zz;
    let u6xy = w6xy - e5y;
    let u6xz = w6xz + e6y;
    let u6yx = w6xy + e5y;
    let u6yy = -w6xx - w6zz;
    let u6yz = w6yz - e6x;
    let u6zx = w6xz - e6y;
    let u6zy = w6yz + e6x;
    let u6zz = -w6xx - w6yy;
    let f6x = 0.005 * u6xx - 0.0075 * u6xy;
    let f6y = 0.005 * u6yx - 0.0075 * u6yy;
    let f6z = 0.005 * u6zx - 0.0075 * u6zy;
    let v6yz = u6yy - u6zz;
    let v6zx = u6zz - u6xx;
    let v6xy = u6xx - u6yy;
    let m6x = 0.0038485 * w6yz + 0.001765 * v6yz - 0.0009565 * e6x - 0.000296 * u6zx - 0.000996 * u6yx - 0.0075 * a5y;
    let m6y = 0.000296 * u6zy - 0.004805 * w6xz - 0.001765 * u6xy - 0.000996 * v6zx - 0.005 * a5y;
    let m6z = 0.0038485 * e5y
        + 0.0009565 * w6xy
        + 0.000996 * u6yz
        + 0.001765 * u6xz
        + 0.000296 * v6xy
        + 0.005 * a6y
        + 0.0075 * a6x;
    let f6p = c6 * f6x - s6 * f6y;
    let f6q = s6 * f6x + c6 * f6y;
    let m6p = c6 * m6x - s6 * m6y;
    let m6q = s6 * m6x + c6 * m6y;
    let n5x = m5x + m6p;
    let n5y = m5y + m6z;
    let n5z = m5z - m6q;
    let g5x = f5x + f6p;
    let g5y = f5y + f6z;
    let g5z = f5z - f6q;
    let f5p = c5 * g5x - s5 * g5y;
    let f5q = s5 * g5x + c5 * g5y;
    let m5p = c5 * n5x - s5 * n5y;
    let m5q = s5 * n5x + c5 * n5y;
    let n4x = m4x + m5p + 1.056 * g5z;
    let n4y = m4y - n5z + 1.056 * f5p;
    let n4z = m4z + m5q;
    let g4x = f4x + f5p;
    let g4y = f4y - g5z;
    let g4z = f4z + f5q;
    let f4p = c4 * g4x - s4 * g4y;
    let f4q = s4 * g4x + c4 * g4y;
    let m4p = c4 * n4x - s4 * n4y;
    let m4q = s4 * n4x + c4 * n4y;
    let n3x = m3x + m4p;
    let n3y = m3y + n4z + 0.165 * f4q;
    let n3z = m3z - m4q + 0.165 * g4z;
    let g3x = f3x + f4p;
    let g3y = f3y + g4z;
    let g3z = f3z - f4q;
    let f3q = s3 * g3x + c3 * g3y;
    let m3p = c3 * n3x - s3 * n3y;
    let m3q = s3 * n3x + c3 * n3y;
    let n2x = m2x + m3p;
    let n2y = m2y + m3q - 1.075 * g3z;
    let n2z = m2z + n3z + 1.075 * f3q;
    let g2z = f2z + g3z;
    let m2q = s2 * n2x + c2 * n2y;
    let n1z = 0.41 * g2z - m2q;
    [n1z, n2z, n3z, n4z, n5z, m6z]
}
