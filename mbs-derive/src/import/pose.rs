//! Places and attitudes as numbers, and how they are written.

/// Rows of a rotation: components in the inner axes to those in the outer ones.
pub(super) type Turn = [[f64; 3]; 3];

/// No turn.
pub(super) const STRAIGHT: Turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A turn and a shift; as roll, pitch and yaw where the file has it so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) turn: Turn,
    pub(super) shift: [f64; 3],
    /// Roll, pitch, yaw as they were read.
    pub(super) rpy: Option<[f64; 3]>,
}

impl Default for Pose {
    fn default() -> Self {
        Pose { turn: STRAIGHT, shift: [0.0; 3], rpy: None }
    }
}

/// An angle is a right angle, or a multiple of it, where it is that near: what files write as 1.57079632679.
const NEAR: f64 = 1e-10;

impl Pose {
    pub(super) fn of_rpy(shift: [f64; 3], rpy: [f64; 3]) -> Self {
        let [(sr, cr), (sp, cp), (sy, cy)] = rpy.map(|angle| match quarters(angle) {
            Some(n) => {
                ([0.0, 1.0, 0.0, -1.0][n.rem_euclid(4) as usize], [1.0, 0.0, -1.0, 0.0][n.rem_euclid(4) as usize])
            }
            None => (libm::sin(angle), libm::cos(angle)),
        });
        let turn = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Pose { turn, shift, rpy: Some(rpy) }
    }

    pub(super) fn of_turn(shift: [f64; 3], turn: Turn) -> Self {
        Pose { turn, shift, rpy: None }
    }

    /// Of a place and a quaternion, scalar part first, of any length but 0.
    pub(super) fn of_quaternion(shift: [f64; 3], quaternion: [f64; 4]) -> Self {
        Pose::of_turn(shift, of_quaternion(quaternion))
    }

    /// First `self`, then `inner` in its axes.
    pub(super) fn then(&self, inner: &Pose) -> Pose {
        let shift = plus(self.shift, turned(&self.turn, inner.shift));
        if self.turn == STRAIGHT {
            return Pose { shift, ..*inner };
        }
        if inner.turn == STRAIGHT {
            return Pose { shift, ..*self };
        }
        Pose::of_turn(shift, product(&self.turn, &inner.turn))
    }

    pub(super) fn inverse(&self) -> Pose {
        let turn = transposed(&self.turn);
        Pose::of_turn(turned(&turn, self.shift).map(|c| -c), turn)
    }

    /// Where a place of the inner axes is in the outer ones.
    pub(super) fn point(&self, place: [f64; 3]) -> [f64; 3] {
        plus(self.shift, turned(&self.turn, place))
    }
}

pub(super) fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(super) fn turned(turn: &Turn, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| turn[i][k] * v[k]).sum())
}

pub(super) fn transposed(turn: &Turn) -> Turn {
    std::array::from_fn(|i| std::array::from_fn(|k| turn[k][i]))
}

pub(super) fn product(a: &Turn, b: &Turn) -> Turn {
    std::array::from_fn(|i| std::array::from_fn(|k| (0..3).map(|j| a[i][j] * b[j][k]).sum()))
}

pub(super) fn norm(v: &[f64]) -> f64 {
    libm::sqrt(v.iter().map(|c| c * c).sum())
}

/// Of a quaternion, scalar part first, of any length but 0.
pub(super) fn of_quaternion(q: [f64; 4]) -> Turn {
    let length = norm(&q);
    let [w, x, y, z] = q.map(|c| c / length);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// About an axis of any length but 0.
pub(super) fn about(axis: [f64; 3], angle: f64) -> Turn {
    let length = norm(&axis);
    let (sine, cosine) = match quarters(angle) {
        Some(n) => ([0.0, 1.0, 0.0, -1.0][n.rem_euclid(4) as usize], [1.0, 0.0, -1.0, 0.0][n.rem_euclid(4) as usize]),
        None => (libm::sin(angle), libm::cos(angle)),
    };
    let [x, y, z] = axis.map(|c| c / length);
    let rest = 1.0 - cosine;
    [
        [cosine + x * x * rest, x * y * rest - z * sine, x * z * rest + y * sine],
        [y * x * rest + z * sine, cosine + y * y * rest, y * z * rest - x * sine],
        [z * x * rest - y * sine, z * y * rest + x * sine, cosine + z * z * rest],
    ]
}

/// The turn that takes z to `axis` by the shortest way; a half turn about x where they are opposite.
pub(super) fn from_z(axis: [f64; 3]) -> Turn {
    let length = norm(&axis);
    let [x, y, z] = axis.map(|c| c / length);
    let sine = norm(&[x, y]);
    if sine < 1e-14 {
        return if z > 0.0 { STRAIGHT } else { [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]] };
    }
    about([-y, x, 0.0], libm::atan2(sine, z))
}

/// How many right angles an angle is, if it is a multiple of them.
pub(super) fn quarters(angle: f64) -> Option<i64> {
    let number = angle / std::f64::consts::FRAC_PI_2;
    let nearest = libm::round(number);
    ((angle - nearest * std::f64::consts::FRAC_PI_2).abs() < NEAR && nearest.abs() < 9.0).then_some(nearest as i64)
}

/// The axis, ±1, ±2 or ±3, where a direction is along one of x, y and z.
pub(super) fn coordinate_axis(axis: [f64; 3]) -> Option<i64> {
    let length = norm(&axis);
    let near = |c: f64, to: f64| (c / length - to).abs() < 1e-13;
    (0..3).find_map(|k| {
        let others = (0..3).filter(|&i| i != k).all(|i| near(axis[i], 0.0));
        let sign = if axis[k] > 0.0 { 1 } else { -1 };
        (others && near(axis[k].abs(), 1.0)).then_some(sign * (k as i64 + 1))
    })
}

/// An inertia, `xx yy zz xy xz yz`, in the outer axes.
pub(super) fn turned_inertia(turn: &Turn, [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 6] {
    if *turn == STRAIGHT {
        return [xx, yy, zz, xy, xz, yz];
    }
    let inner = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let m = product(&product(turn, &inner), &transposed(turn));
    [m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]]
}

/// An inertia, `xx yy zz xy xz yz`, whose principal moments are `least` where they are smaller.
///
/// Source: Golub, Van Loan, *Matrix Computations*, 2013, section 8.5: cyclic Jacobi rotations.
pub(super) fn raised_inertia([xx, yy, zz, xy, xz, yz]: [f64; 6], least: f64) -> [f64; 6] {
    // It converges quadratically: six sweeps are enough for doubles.
    const SWEEPS: usize = 10;
    let mut m = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut axes = STRAIGHT;
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * SWEEPS) {
        if m[p][q] == 0.0 {
            continue;
        }
        let cotangent = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
        let tangent = 1.0_f64.copysign(cotangent) / (cotangent.abs() + libm::sqrt(cotangent * cotangent + 1.0));
        let cosine = 1.0 / libm::sqrt(tangent * tangent + 1.0);
        let mut turn = STRAIGHT;
        (turn[p][p], turn[q][q]) = (cosine, cosine);
        (turn[p][q], turn[q][p]) = (tangent * cosine, -tangent * cosine);
        m = product(&transposed(&turn), &product(&m, &turn));
        axes = product(&axes, &turn);
    }
    let moments = [m[0][0], m[1][1], m[2][2]];
    if moments.iter().all(|&moment| moment >= least) {
        return [xx, yy, zz, xy, xz, yz];
    }
    let [a, b, c] = moments.map(|moment| moment.max(least));
    turned_inertia(&axes, [a, b, c, 0.0, 0.0, 0.0])
}

// ---- as text

/// The shortest decimal that is this number.
pub(super) fn shown(number: f64) -> String {
    if number == 0.0 {
        return "0".to_string();
    }
    let text = format!("{number:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

/// `[x, y, z]`
pub(super) fn listed(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|&n| shown(n)).collect::<Vec<_>>().join(", "))
}

/// `90 deg` or a number of radians.
pub(super) fn angle(value: f64) -> String {
    match quarters(value) {
        Some(0) => "0".to_string(),
        Some(n) => format!("{} deg", 90 * n),
        None => shown(value),
    }
}

/// The turn as factors of a pose, each behind ` * `; nothing where there is none.
pub(super) fn factors(pose: &Pose) -> String {
    let rpy = pose.rpy.unwrap_or([f64::NAN; 3]);
    if pose.rpy.is_some() {
        return roll_pitch_yaw(rpy);
    }
    let m = &pose.turn;
    let signed_axes = m.iter().flatten().all(|c| [-1.0, 0.0, 1.0].iter().any(|whole| (c - whole).abs() < 1e-12));
    let level = libm::hypot(m[0][0], m[1][0]);
    let pitch = libm::atan2(-m[2][0], level);
    if level > 0.1 {
        return roll_pitch_yaw([libm::atan2(m[2][1], m[2][2]), pitch, libm::atan2(m[1][0], m[0][0])]);
    }
    if signed_axes {
        return roll_pitch_yaw([0.0, pitch, libm::atan2(-m[0][1], m[1][1])]);
    }
    let axis = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let sine = norm(&axis);
    if sine > 1e-3 {
        let turn = libm::atan2(sine, m[0][0] + m[1][1] + m[2][2] - 1.0);
        return format!(" * rotation({}, {})", listed(&axis.map(|c| c / sine)), angle(turn));
    }
    // A turn by nearly a half one: by halves, each of which has a good axis.
    let quarter = about([0.0, 1.0, 0.0], if m[2][0] < 0.0 { FRAC_PI_4 } else { -FRAC_PI_4 });
    let first = Pose::of_turn([0.0; 3], product(m, &transposed(&quarter)));
    let second = Pose::of_turn([0.0; 3], quarter);
    let [a, b] = [first, second].map(|part| {
        let m = &part.turn;
        let level = libm::hypot(m[0][0], m[1][0]);
        roll_pitch_yaw([libm::atan2(m[2][1], m[2][2]), libm::atan2(-m[2][0], level), libm::atan2(m[1][0], m[0][0])])
    });
    a + &b
}

use std::f64::consts::FRAC_PI_4;

fn roll_pitch_yaw(rpy: [f64; 3]) -> String {
    match rpy.map(angle) {
        [r, p, y] if [&r, &p, &y].iter().all(|a| *a == "0") => String::new(),
        [r, p, y] if p == "0" && y == "0" => format!(" * rot_x({r})"),
        [r, p, y] if r == "0" && y == "0" => format!(" * rot_y({p})"),
        [r, p, y] if r == "0" && p == "0" => format!(" * rot_z({y})"),
        [r, p, y] => format!(" * rpy({r}, {p}, {y})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: &Turn, b: &Turn) -> bool {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-14)
    }

    #[test]
    fn turns_agree_however_they_are_given() {
        let half: f64 = 0.35;
        let q = [libm::cos(half), 0.0, 0.0, 2.0 * libm::sin(half)];
        assert!(!near(&of_quaternion(q), &STRAIGHT));
        let q = [libm::cos(half), 0.0, 0.0, libm::sin(half)];
        assert!(near(&of_quaternion(q), &about([0.0, 0.0, 3.0], 0.7)));
        assert!(near(&of_quaternion(q), &Pose::of_rpy([0.0; 3], [0.0, 0.0, 0.7]).turn));
        assert!(near(&from_z([0.0, -2.0, 0.0]), &about([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2)));
        let pose = Pose::of_rpy([1.0, 2.0, 3.0], [0.1, -0.4, 2.0]);
        let back = pose.then(&pose.inverse());
        assert!(near(&back.turn, &STRAIGHT) && norm(&back.shift) < 1e-14);
    }

    /// Each text is read again as the turn that it was made of.
    #[test]
    fn turns_are_written_without_loss() {
        let texts = [
            (["0", "0", "0"], ""),
            (["1.57079632679", "0", "0"], " * rot_x(90 deg)"),
            (["0", "0", "-3.14159265359"], " * rot_z(-180 deg)"),
            (["0.2", "0", "1.5708"], " * rpy(0.2, 0, 1.5708)"),
        ];
        for (rpy, text) in texts {
            let rpy = rpy.map(|angle| angle.parse().unwrap());
            assert_eq!(factors(&Pose::of_rpy([0.0; 3], rpy)), text);
        }
        // Where roll and yaw cannot be told apart, roll is 0.
        assert_eq!(factors(&Pose::of_turn([0.0; 3], of_quaternion([0.5, 0.5, 0.5, 0.5]))), " * rpy(90 deg, 0, 90 deg)");
        assert_eq!(factors(&Pose::of_turn([0.0; 3], of_quaternion([0.0, 1.0, 0.0, 0.0]))), " * rot_x(180 deg)");
        assert_eq!(factors(&Pose::of_turn([0.0; 3], of_quaternion([1.0, 0.0, 1.0, 0.0]))), " * rot_y(90 deg)");
    }

    /// diag(1, 4, 9)/9 in the axes (2, 2, 1)/3, (−2, 1, 2)/3, (1, −2, 2)/3, of which the first two become 6/9.
    #[test]
    fn principal_moments_are_raised_in_their_axes() {
        let rotated = [29.0, 44.0, 53.0, -22.0, 4.0, -26.0].map(|entry: f64| entry / 81.0);
        assert_eq!(raised_inertia(rotated, 0.1), rotated);
        // 6/9 I + 3/9 v vᵀ with v = (1, −2, 2)/3.
        let expected = [6.0 + 3.0 / 9.0, 6.0 + 12.0 / 9.0, 6.0 + 12.0 / 9.0, -6.0 / 9.0, 6.0 / 9.0, -12.0 / 9.0];
        let found = raised_inertia(rotated, 6.0 / 9.0);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b / 9.0).abs() < 1e-15), "{found:?}");
        assert_eq!(raised_inertia([0.0; 6], 0.05), [0.05, 0.05, 0.05, 0.0, 0.0, 0.0]);
        assert_eq!(raised_inertia([0.001, 0.1, 0.1, 0.0, 0.0, 0.0], 0.05), [0.05, 0.1, 0.1, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn numbers_are_the_shortest_decimals() {
        assert_eq!([0.1, -2.0, 1e-7, 1e22, -0.0].map(shown), ["0.1", "-2", "1e-7", "1e22", "0"]);
        assert_eq!(coordinate_axis([0.0, -2.0, 0.0]), Some(-2));
        assert_eq!(coordinate_axis([0.0, -2.0, 1e-9]), None);
    }
}
