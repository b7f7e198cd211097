//! The mass matrix by composite bodies, and the equations that it is the matrix of; names as in the module above.

use super::super::number;
use super::Number;

/// The lower triangle of `M`, row by row.
pub(super) fn mass_matrix_at(angles: &[(Number, Number); 5]) -> [Number; 21] {
    let [(s2, c2), (s3, c3), (s4, c4), (s5, c5), (s6, c6)] = *angles;
    let f65p = 0.0075 * c6 - 0.005 * s6;
    let f65q = 0.0075 * s6 + 0.005 * c6;
    let n65p = -0.000996 * c6 - 0.001765 * s6;
    let n65q = 0.001765 * c6 - 0.000996 * s6;
    let f64p = c5 * f65p;
    let f64q = s5 * f65p;
    let n64p = c5 * n65p - 0.0038485 * s5;
    let n64q = s5 * n65p + 0.0038485 * c5;
    let n64x = n64p - 1.056 * f65q;
    let n64y = n65q + 1.056 * f64p;
    let f63p = c4 * f64p - s4 * f65q;
    let f63q = s4 * f64p + c4 * f65q;
    let n63p = c4 * n64x - s4 * n64y;
    let n63q = s4 * n64x + c4 * n64y;
    let n63y = n64q + 0.165 * f63q;
    let n63z = 0.165 * f64q - n63q;
    let f62q = s3 * f63p + c3 * f64q;
    let n62p = c3 * n63p - s3 * n63y;
    let n62q = s3 * n63p + c3 * n63y;
    let n62y = n62q + 1.075 * f63q;
    let n62z = n63z + 1.075 * f62q;
    let n61q = s2 * n62p + c2 * n62y;
    let n61z = -n61q - 0.41 * f63q;
    let ss6 = s6 * s6;
    let cs6 = c6 * s6;
    let t6 = 0.000592 * cs6 - 0.0009565 * ss6;
    let jxy6 = 0.000296 - 0.0009565 * cs6 - 0.000592 * ss6;
    let jxx6 = -0.0009565 - t6;
    let j5xx = 0.084293 + jxx6;
    let j5xy = 0.002931 + n65p;
    let j5xz = 0.003291 - jxy6;
    let j5yz = 0.002041 - n65q;
    let j5zz = 0.107899 + t6;
    let p5x = 0.03 + f65q;
    let f54p = -0.665 * c5 - s5 * p5x;
    let f54q = c5 * p5x - 0.665 * s5;
    let n54p = c5 * j5xz - s5 * j5yz;
    let n54q = s5 * j5xz + c5 * j5yz;
    let n54y = 1.056 * f54p - j5zz;
    let f53p = c4 * f54p;
    let f53q = s4 * f54p;
    let n53p = c4 * n54p - s4 * n54y;
    let n53q = s4 * n54p + c4 * n54y;
    let n53y = n54q + 0.165 * f53q;
    let n53z = 0.165 * f54q - n53q;
    let f52q = s3 * f53p + c3 * f54q;
    let n52p = c3 * n53p - s3 * n53y;
    let n52q = s3 * n53p + c3 * n53y;
    let n52y = n52q + 1.075 * f53q;
    let n52z = n53z + 1.075 * f52q;
    let n51q = s2 * n52p + c2 * n52y;
    let n51z = -n51q - 0.41 * f53q;
    let d5 = j5xx - 0.0038485;
    let ss5 = s5 * s5;
    let cs5 = c5 * s5;
    let e5 = 2.0 * j5xy;
    let t5 = ss5 * d5 + cs5 * e5;
    let jxy5 = cs5 * d5 + j5xy - ss5 * e5;
    let jxx5 = j5xx - t5;
    let jyy5 = 0.0038485 + t5;
    let k5z = -2.112 * f54p;
    let j4xx = 0.101007 + jxx5 + k5z;
    let j4xy = -0.020158 - n54p;
    let j4xz = jxy5 - 0.036398 - 1.056 * f54q;
    let j4yy = j5zz + k5z;
    let j4yz = 0.0275 - n54q + 1.056 * f65p;
    let j4zz = 0.373829 + jyy5;
    let p4x = 0.12 + f54q;
    let p4y = -0.18 - f65p;
    let f43p = -c4 * p4y - s4 * p4x;
    let f43q = c4 * p4x - s4 * p4y;
    let n43p = c4 * j4xz - s4 * j4yz;
    let n43q = s4 * j4xz + c4 * j4yz;
    let n43y = j4zz + 0.165 * f43q;
    let f42q = s3 * f43p;
    let n42p = c3 * n43p - s3 * n43y;
    let n42q = s3 * n43p + c3 * n43y;
    let n42y = n42q + 1.075 * f43q;
    let n42z = 1.075 * f42q - n43q;
    let n41q = s2 * n42p + c2 * n42y;
    let n41z = -n41q - 0.41 * f43q;
    let d4 = j4xx - j4yy;
    let ss4 = s4 * s4;
    let cs4 = c4 * s4;
    let e4 = 2.0 * j4xy;
    let t4 = ss4 * d4 + cs4 * e4;
    let jxy4 = cs4 * d4 + j4xy - ss4 * e4;
    let jxx4 = j4xx - t4;
    let jyy4 = j4yy + t4;
    let k4x = 0.33 * f43q;
    let j3xx = 15.2605205 + jxx4;
    let j3xy = n43p + 0.165 * f54p - 3.0326;
    let j3xz = 0.05451 - jxy4 - 0.165 * f43p;
    let j3yy = j4zz + k4x;
    let j3yz = 0.110677 - n43q;
    let j3zz = 17.6243655 + jyy4 + k4x;
    let p3x = 6.8325 + f43q;
    let p3y = 19.248 - f54p;
    let f32p = -c3 * p3y - s3 * p3x;
    let f32q = c3 * p3x - s3 * p3y;
    let n32p = c3 * j3xz - s3 * j3yz;
    let n32q = s3 * j3xz + c3 * j3yz;
    let n32z = j3zz + 1.075 * f32q;
    let n31q = s2 * n32p + c2 * n32q;
    let d3 = j3xx - j3yy;
    let ss3 = s3 * s3;
    let cs3 = c3 * s3;
    let e3 = 2.0 * j3xy;
    let t3 = ss3 * d3 + cs3 * e3;
    let jxy3 = cs3 * d3 + j3xy - ss3 * e3;
    let jxx3 = j3xx - t3;
    let jyy3 = j3yy + t3;
    let k3x = 2.15 * f32q;
    let j2xx = jxx3 - 68.4504025;
    let j2xy = jxy3 + 1.075 * f32p - 0.525348;
    let j2xz = n32p - 1.234624 - 1.075 * f43p;
    let j2yy = jyy3 + k3x;
    let j2yz = 0.876157 + n32q;
    let j2zz = 73.2161035 + j3zz + k3x;
    let p2x = 75.6625 + f32q;
    let p2y = 0.9 - f32p;
    let f21q = c2 * p2x - s2 * p2y;
    let n21q = s2 * j2xz + c2 * j2yz;
    let d2 = j2xx - j2yy;
    let ss2 = s2 * s2;
    let cs2 = c2 * s2;
    let e2 = 2.0 * j2xy;
    let t2 = ss2 * d2 + cs2 * e2;
    let jyy2 = j2yy + t2;
    let k2x = 0.82 * f21q;
    let j1zz = 94.690734 + jyy2 + k2x;
    [
        j1zz,
        -n21q,
        j2zz,
        -n31q,
        n32z,
        j3zz,
        n41z,
        n42z,
        -n43q,
        j4zz,
        n51z,
        n52z,
        n53z,
        n54q,
        j5zz,
        n61z,
        n62z,
        n63z,
        n64q,
        -n65q,
        number(0.0038485),
    ]
}

/// `M x = t` by `M = L D Lᵀ`.
pub(super) fn solve(m: &[Number; 21], t: &[Number; 6]) -> [Number; 6] {
    let [m11, m21, m22, m31, m32, m33, m41, m42, m43, m44, m51, m52, m53, m54, m55, m61, m62, m63, m64, m65, m66] = *m;
    let [t1, t2, t3, t4, t5, t6] = *t;
    let i1 = 1.0 / m11;
    let l21 = m21 * i1;
    let d2 = m22 - m21 * l21;
    let i2 = 1.0 / d2;
    let l31 = m31 * i1;
    let y32 = m32 - m31 * l21;
    let l32 = y32 * i2;
    let d3 = m33 - m31 * l31 - y32 * l32;
    let i3 = 1.0 / d3;
    let l41 = m41 * i1;
    let y42 = m42 - m41 * l21;
    let l42 = y42 * i2;
    let y43 = m43 - m41 * l31 - y42 * l32;
    let l43 = y43 * i3;
    let d4 = m44 - m41 * l41 - y42 * l42 - y43 * l43;
    let i4 = 1.0 / d4;
    let l51 = m51 * i1;
    let y52 = m52 - m51 * l21;
    let l52 = y52 * i2;
    let y53 = m53 - m51 * l31 - y52 * l32;
    let l53 = y53 * i3;
    let y54 = m54 - m51 * l41 - y52 * l42 - y53 * l43;
    let l54 = y54 * i4;
    let d5 = m55 - m51 * l51 - y52 * l52 - y53 * l53 - y54 * l54;
    let i5 = 1.0 / d5;
    let l61 = m61 * i1;
    let y62 = m62 - m61 * l21;
    let l62 = y62 * i2;
    let y63 = m63 - m61 * l31 - y62 * l32;
    let l63 = y63 * i3;
    let y64 = m64 - m61 * l41 - y62 * l42 - y63 * l43;
    let l64 = y64 * i4;
    let y65 = m65 - m61 * l51 - y62 * l52 - y63 * l53 - y64 * l54;
    let l65 = y65 * i5;
    let d6 = m66 - m61 * l61 - y62 * l62 - y63 * l63 - y64 * l64 - y65 * l65;
    let i6 = 1.0 / d6;
    let x2 = t2 - l21 * t1;
    let x3 = t3 - l31 * t1 - l32 * x2;
    let x4 = t4 - l41 * t1 - l42 * x2 - l43 * x3;
    let x5 = t5 - l51 * t1 - l52 * x2 - l53 * x3 - l54 * x4;
    let x6 = t6 - l61 * t1 - l62 * x2 - l63 * x3 - l64 * x4 - l65 * x5;
    let z1 = t1 * i1;
    let z2 = x2 * i2;
    let z3 = x3 * i3;
    let z4 = x4 * i4;
    let z5 = x5 * i5;
    let z6 = x6 * i6;
    let a5 = z5 - l65 * z6;
    let a4 = z4 - l54 * a5 - l64 * z6;
    let a3 = z3 - l43 * a4 - l53 * a5 - l63 * z6;
    let a2 = z2 - l32 * a3 - l42 * a4 - l52 * a5 - l62 * z6;
    let a1 = z1 - l21 * a2 - l31 * a3 - l41 * a4 - l51 * a5 - l61 * z6;
    [a1, a2, a3, a4, a5, z6]
}
