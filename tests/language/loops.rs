//! Arrays that loops fill, outputs and constraints in loops, and choices at build time, against the same mechanism at
//! length.

use mbs_derive::emit::Options;
use mbs_tests::mechanisms::ladder_of_links::LadderOfLinks;

/// The code of a mechanism, without the line that names its file.
fn code(statements: &str) -> String {
    let source = format!(
        "mechanism A {{ param m: kg = 1; param l: m = 0.5; param k: N/m = 3; coord x[3]: m; coord q[3]: rad;
         for i in 0..3 {{ kinetic += 1/2*m*(dt(x[i])^2 + l^2*dt(q[i])^2); }} 
         potential += k*x[2]^2; {statements} }}"
    );
    let generated = mbs_derive::generate("a.mbs", &source, &Options::default());
    let generated = generated.unwrap_or_else(|error| panic!("{}", error.render("a.mbs", &source)));
    assert_eq!(generated.warnings, "", "{statements}");
    generated.code
}

#[track_caller]
fn same(short: &str, long: &str) {
    assert_eq!(code(short), code(long), "{short}");
}

#[test]
fn arrays_filled_in_loops_are_arrays() {
    same(
        "let r[3]; for i in 0..3 { r[i] = [x[i], l*q[i], 0]; kinetic += particle(m, r[i]); } output a = r;",
        "let r = [[x[0], l*q[0], 0], [x[1], l*q[1], 0], [x[2], l*q[2], 0]];
         kinetic += particle(m, r[0]); kinetic += particle(m, r[1]); kinetic += particle(m, r[2]); output a = r;",
    );
    same(
        "let link[3]; for i in 0..3 { link[i] = (if i == 0 { world } else { link[i - 1] })*rot_y(q[i])*translation([l, 0, 0]);
         kinetic += particle(m, link[i].origin()); }",
        "let mut link = world; for i in 0..3 { link = link*rot_y(q[i])*translation([l, 0, 0]);
         kinetic += particle(m, link.origin()); }",
    );
    same(
        "let mut sum[2]; sum[0] = 0; sum[1] = 0; for i in 0..3 { sum[0] = sum[0] + x[i]; sum[1] = sum[1] + l*q[i]; }
         potential += k*(sum[0]^2 + sum[1]^2);",
        "potential += k*((x[0] + x[1] + x[2])^2 + (l*q[0] + l*q[1] + l*q[2])^2);",
    );
}

#[test]
fn outputs_in_loops_are_outputs_of_arrays() {
    same("for i in 0..3 { output a[i] = k*x[i]; }", "output a = [k*x[0], k*x[1], k*x[2]];");
    same(
        "for i in 0..2 { output a[i] = [x[i], l*q[i]], jacobian_rate; }",
        "output a = [[x[0], l*q[0]], [x[1], l*q[1]]], jacobian_rate;",
    );
    same(
        "for i in 0..2 { output a[i] = translation([x[i], 0, 0])*rot_y(q[i]); }",
        "output a = [translation([x[0], 0, 0])*rot_y(q[0]), translation([x[1], 0, 0])*rot_y(q[1])];",
    );
}

#[test]
fn constraints_in_loops_are_constraints() {
    same(
        "for i in 0..2 { constraint rod[i]: x[i] = l*sin(q[i]); }",
        "constraint rod_0: x[0] = l*sin(q[0]); constraint rod_1: x[1] = l*sin(q[1]);",
    );
    same(
        "for i in 0..2 { if i == 1 { constraint roll[i]: dt(x[i]) = l*dt(q[i]); } else { constraint roll[i]: x[i] = l*q[i]; } }",
        "constraint roll_0: x[0] = l*q[0]; constraint roll_1: dt(x[1]) = l*dt(q[1]);",
    );
}

#[test]
fn choices_at_build_time_leave_nothing_of_the_other_side() {
    same(
        "const kind = 2; if kind == 1 { potential += nothing; } else if kind != 1 && kind <= 2 { potential += k*x[0]^2; }
         else { force x += nothing; }",
        "potential += k*x[0]^2;",
    );
}

/// Values, velocities and Jacobians of arrays of every shape fit together in compiled code; they are proved one by one.
#[test]
fn arrays_of_outputs_in_generated_code() {
    let ladder = LadderOfLinks::<f64>::default();
    let (q, qd) = ([0.3, -0.8, 1.1, 0.0, 0.0, 0.0], [0.5, 0.2, -0.7, 0.0, 0.0, 0.0]);
    let tips: [[f64; 3]; 3] = ladder.tips(&q);
    let frames = ladder.frames(&q);
    let attitudes: [[[f64; 3]; 3]; 3] = ladder.attitudes(&q);
    let twists: [[f64; 6]; 3] = ladder.frames_velocity(&q, &qd);
    assert_eq!(ladder.distance(&q), tips.map(|tip| tip[0]));
    assert_eq!(frames.map(|frame| frame.rotation), attitudes);
    assert_eq!(ladder.last(&q), frames[2]);
    // About −y, each link by the sum of the angles before it.
    let (c, s) = ((0.3f64 - 0.8).cos(), (0.3f64 - 0.8).sin());
    assert!((attitudes[1][0][0] - c).abs() < 1e-15 && (attitudes[1][2][0] - s).abs() < 1e-15);
    assert!((tips[0][0] - 0.5 * 0.3f64.cos()).abs() < 1e-15 && (tips[0][2] - 0.5 * 0.3f64.sin()).abs() < 1e-15);
    assert_eq!(frames[1].position, tips[0]);
    assert!((twists[2][4] + 0.5 + 0.2 - 0.7).abs() < 1e-15);
    let jacobian: [[f64; 6]; 18] = ladder.frames_jacobian(&q);
    for (row, expected) in jacobian.iter().zip(twists.as_flattened()) {
        let product: f64 = row.iter().zip(qd).map(|(j, v)| j * v).sum();
        assert!((product - expected).abs() < 1e-14);
    }
    let hinges: [mbs_runtime::Wrench<f64>; 3] = ladder.hinge(&q, &qd, &[0.0; 6], &[0.0; 3]);
    assert!(hinges[0].force[0].is_finite());
}
