//! Parts against the same mechanism written out: the same code to the last byte, and a robot of parts against formulas
//! by hand.

use mbs_derive::emit::Options;
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::mounted_arm::{MountedArm, Params};
use mbs_tests::random::Random;

/// The code of a mechanism, without the line that names its file.
fn code(statements: &str) -> String {
    let source = format!(
        "mechanism A {{ param m[2]: kg = [1, 2]; param l[2]: m = [0.5, 0.3]; param c: N*m*s = 0.2; param g: m/s^2 = 9.81;
         coord q[2]: rad; coord x: m; input tau[2]: N*m; kinetic += 1/2*m[0]*dt(x)^2; {statements} }}"
    );
    let generated = mbs_derive::generate("a.mbs", &source, &Options::default());
    let generated = generated.unwrap_or_else(|error| panic!("{}", error.render("a.mbs", &source)));
    // What the mechanism does not use is the only thing that it is warned of.
    let warnings = generated.warnings.matches("warning[MBS").count();
    assert_eq!(warnings, generated.warnings.matches("` is not used").count(), "{}", generated.warnings);
    generated.code
}

#[track_caller]
fn same(short: &str, long: &str) {
    assert_eq!(code(short), code(long), "{short}");
}

#[test]
fn an_arm_of_two_links_of_one_part() {
    let by_hand = |first: &str, second: &str| {
        format!(
            "let upper = translation([x, 0, 0])*rot_y(-q[0]); let elbow = upper*translation([l[0], 0, 0]);
             kinetic += rigid_body(m[0], [l[0]/2, 0, 0], diag(0, 1, 1)*m[0]*l[0]^2/12, upper);
             potential += m[0]*g*upper.point([l[0]/2, 0, 0]).z;
             dissipation += 1/2*c*dt(q[0])^2; force q[0] += tau[0]; output {first}_tip = elbow.origin();
             let lower = elbow*rot_y(-q[1]); let end = lower*translation([l[1], 0, 0]);
             kinetic += rigid_body(m[1], [l[1]/2, 0, 0], diag(0, 1, 1)*m[1]*l[1]^2/12, lower);
             potential += m[1]*g*lower.point([l[1]/2, 0, 0]).z;
             dissipation += 1/2*c*dt(q[1])^2; force q[1] += tau[1]; output {second}_tip = end.origin();"
        )
    };
    let part = "part link(m, l, pose, angle, drive) { let turned = pose*rot_y(-angle); let end = turned*translation([l, 0, 0]);
                kinetic += rigid_body(m, [l/2, 0, 0], diag(0, 1, 1)*m*l^2/12, turned);
                potential += m*g*turned.point([l/2, 0, 0]).z;
                dissipation += 1/2*c*dt(angle)^2; force angle += drive; output tip = end.origin(); }";
    same(
        &format!(
            "link upper(m[0], l[0], translation([x, 0, 0]), q[0], tau[0]); link lower(m[1], l[1], upper.end, q[1], tau[1]); {part}"
        ),
        &by_hand("upper", "lower"),
    );
    same(
        &format!(
            "{part} let mut at = translation([x, 0, 0]);
             for i in 0..2 {{ link arm[i](m[i], l[i], at, q[i], tau[i]); at = arm[i].end; }}"
        ),
        &by_hand("arm_0", "arm_1"),
    );
}

#[test]
fn constraints_and_reactions_of_parts_have_paths() {
    let bodies = "for i in 0..2 { kinetic += 1/2*m[i]*l[i]^2*dt(q[i])^2; }";
    same(
        &format!(
            "{bodies} part gear(angle, r) {{ constraint mesh: r*angle = x; if 1 == 1 {{ output turn = 2*angle; }} }}
             gear left(q[0], l[0]); if 2 > 1 {{ gear right(q[1], l[1]); }}"
        ),
        &format!(
            "{bodies} constraint left_mesh: l[0]*q[0] = x; output left_turn = 2*q[0];
             constraint right_mesh: l[1]*q[1] = x; output right_turn = 2*q[1];"
        ),
    );
    same(
        "part link(pose, i, angle) { let hinged = pose*rot_y(angle); reaction hinge at hinged;
         kinetic += particle(m[i], hinged.point([l[i], 0, 0])); } part side(pose, i) { link only(pose, i, q[i]); }
         for i in 0..2 { side arm[i](translation([x, i*l[0], 0]), i); }",
        "let a = translation([x, 0, 0])*rot_y(q[0]); reaction arm_0_only_hinge at a;
         kinetic += particle(m[0], a.point([l[0], 0, 0]));
         let b = translation([x, l[0], 0])*rot_y(q[1]); reaction arm_1_only_hinge at b;
         kinetic += particle(m[1], b.point([l[1], 0, 0]));",
    );
}

/// The words that parts and tables have brought are names as before.
#[test]
fn new_words_are_names() {
    let with = |[part, table, rpy, shape]: [&str; 4]| {
        format!(
            "mechanism A {{ param {part}: kg = 2; param {table}: N/m = 3; coord {rpy}: m; coord q: m; param {shape}[2]: m = [1, 2];
             fn down(x) = [0, 0, -x]; gravity down(9.81 m/s^2); let mut a = {part}; a = 2*{part}; let mut gravity = 1; gravity = 3;
             kinetic += 1/2*a*dt({rpy})^2 + gravity/2*{part}*dt(q)^2 + particle({part}, [0, q, {rpy}]); potential += 1/2*{table}*({rpy} - {shape}[0])^2; }}"
        )
    };
    let code = |source: &str| {
        let generated = mbs_derive::generate("a.mbs", source, &Options::default());
        generated.unwrap_or_else(|error| panic!("{}", error.render("a.mbs", source))).code
    };
    let plain = ["p0", "t0", "r0", "s0"];
    let names = ["part", "table", "rpy", "shape"];
    let renamed = |mut text: String| {
        for (name, plain) in names.iter().zip(plain) {
            let is_in_a_word = |c: char| c.is_alphanumeric() || c == '_';
            let mut out = String::new();
            for piece in text.split_inclusive(|c| !is_in_a_word(c)) {
                let word = piece.trim_end_matches(|c| !is_in_a_word(c));
                out += &piece.replacen(word, if word == *name { plain } else { word }, 1);
            }
            text = out;
        }
        text
    };
    let declared = code(&with(names));
    assert!(
        declared.contains("pub part: T") && declared.contains("pub table: T") && declared.contains("pub shape: [T; 2]")
    );
    let lines = |text: &str| text.lines().map(str::trim).filter(|line| line.starts_with("let ")).count();
    assert_eq!(lines(&renamed(declared)), lines(&code(&with(plain))));
}

type Vector = [f64; 3];
type Matrix = [Vector; 3];

fn times(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn on(a: Matrix, v: Vector) -> Vector {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

fn plus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Roll, pitch and yaw about fixed axes, entry by entry (J. J. Craig, *Introduction to Robotics*, 2005, equation 2.64).
fn rpy(roll: f64, pitch: f64, yaw: f64) -> Matrix {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// About a unit axis, by Rodrigues' formula.
fn about(n: Vector, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let skew = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (1.0 - c) * n[i] * n[j] + s * skew[i][j] + if i == j { c } else { 0.0 })
    })
}

/// T, V and the ends of the links, by velocities along the chain.
fn by_hand(p: &Params<f64>, q: &[f64; 2], qd: &[f64; 2]) -> (f64, f64, [Vector; 2]) {
    let mut turned = rpy(p.mount[0], p.mount[1], p.mount[2]);
    let (mut place, mut velocity, mut omega) = ([0.0, 0.0, 1.5], [0.0; 3], [0.0; 3]);
    let (mut kinetic, mut potential, mut ends) = (0.0, 0.0, [[0.0; 3]; 2]);
    for i in 0..2 {
        let length = dot(p.axis[i], p.axis[i]).sqrt();
        let axis = p.axis[i].map(|c| c / length);
        omega = plus(omega, on(turned, axis.map(|c| c * qd[i])));
        turned = times(turned, about(axis, q[i]));
        let centre = on(turned, p.centre[i]);
        let v = plus(velocity, cross(omega, centre));
        let transposed: Matrix = std::array::from_fn(|a| std::array::from_fn(|b| turned[b][a]));
        let own = on(transposed, omega);
        let [xx, yy, zz, xy, xz, yz] = p.moments[i];
        let momentum = on([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], own);
        kinetic += 0.5 * p.m[i] * dot(v, v) + 0.5 * dot(own, momentum);
        potential += p.m[i] * p.g * plus(place, centre)[2];
        let arm = on(turned, [0.4, 0.0, 0.0]);
        (place, velocity) = (plus(place, arm), plus(velocity, cross(omega, arm)));
        ends[i] = place;
    }
    (kinetic, potential, ends)
}

#[test]
fn a_robot_of_parts_moves_as_by_hand() {
    let mut random = Random::new(15);
    for round in 0..200 {
        let params = Params::<f64> {
            mount: std::array::from_fn(|_| random.uniform(-3.0..3.0)),
            axis: std::array::from_fn(|_| std::array::from_fn(|_| random.uniform(0.1..2.0))),
            centre: std::array::from_fn(|_| std::array::from_fn(|_| random.uniform(-0.5..0.5))),
            ..Params::default()
        };
        let mut some = |n: f64| if random.one_in(6) { 0.0 } else { random.uniform(-n..n) };
        let (q, qd) = ([some(3.0), some(3.0)], [some(5.0), some(5.0)]);
        let arm = MountedArm::new(params);
        let (kinetic, potential, ends) = by_hand(&params, &q, &qd);
        let place = format!("round {round}");
        assert_close(&place, &[arm.kinetic_energy(&q, &qd)], &[kinetic], 1e-13);
        assert_close(&place, &[arm.potential_energy(&q) + 1.0], &[potential + 1.0], 1e-13);
        assert_close(&place, &arm.upper_end(&q), &ends[0], 1e-13);
        assert_close(&place, &arm.lower_end(&q), &ends[1], 1e-13);
    }
}
