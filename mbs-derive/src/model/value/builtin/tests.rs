use super::*;
use crate::model::check::trial::{mechanism, near, refused, same, value, value_with_unit};

#[test]
fn the_tables_agree_with_themselves() {
    for function in FUNCTIONS {
        assert!(function.form.starts_with(&format!("{}(", function.name)), "{}", function.form);
    }
    for method in METHODS {
        assert!(method.form.contains(&format!(".{}(", method.name)), "{}", method.form);
    }
    for function in Function::ALL {
        assert!(form_of_function(function.name()).is_some(), "{}", function.name());
    }
}

#[test]
fn functions_of_numbers() {
    let check = |expression: &str, expected: f64| near(&value("", expression), &[expected], expression);
    check("sin(theta)", 0.4f64.sin());
    check("atan2(y, x)", (-0.7f64).atan2(0.3));
    check("hypot(3*x, 4*x)", 1.5);
    check("tanh(theta) + ln(m/(m/2)) + exp(0)", 0.4f64.tanh() + 2f64.ln() + 1.0);
    assert_eq!(value_with_unit("", "abs(y)"), (vec![0.7], "m".to_string()));
    assert_eq!(value_with_unit("", "signum(y)"), (vec![-1.0], "1".to_string()));
    refused(
        "let a = sin(x);",
        "x: the argument of `sin` must be a plain number, this is m; divide by a quantity of the same dimension",
    );
    refused("let a = atan2(y, m);", "atan2(y, m): the arguments need equal dimensions, these are m and kg");
    refused(
        "let a = sin([x, y, z]/l);",
        "[x, y, z]/l: expected a number, found a vector; of a vector, `.x`, `.norm()` and `.dot(v)` are numbers",
    );
}

#[test]
fn wrong_calls_are_shown_the_right_form() {
    refused("let a = atan2(x);", "atan2: `atan2` takes 2 arguments, 1 is given; write `atan2(y, x)`");
    refused("let a = sin();", "sin: `sin` takes 1 argument, 0 are given; write `sin(x)`");
    refused("let a = [x, y, z].norm(2);", "norm: `norm` takes 0 arguments, 1 is given; write `v.norm()`");
    refused(
        "let a = inertia(m, m);",
        "inertia: `inertia` takes 1 or 3 or 6 arguments, 2 are given; write `inertia(xx, yy, zz, xy, xz, yz)`",
    );
    refused("let a = sine(x);", "sine: there is no function `sine`; did you mean `sin(x)`?");
    refused("let a = norm([x, y, z]);", "norm: `norm` is a method; write `v.norm()`");
    refused("let a = theta.sin();", "sin: there is no method `sin`; it is a function: write `sin(x)`");
    refused(
        "let a = [x, y, z].norm_sqared();",
        "norm_sqared: there is no method `norm_sqared`; did you mean `v.norm_squared()`?",
    );
    refused("let a = m(l + x);", "m: `m` is not a function; write `*` for a product");
    refused(
        "let a = x.origin();",
        "x: expected a pose, found a number; poses are made by `rot_z(angle)`, `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
    );
}

#[test]
fn rotations_turn_by_the_right_hand() {
    near(&value("", "rot_x(pi/2) * [1, 2, 3]"), &[1.0, -3.0, 2.0], "about x");
    near(&value("", "rot_y(pi/2) * [1, 2, 3]"), &[3.0, 2.0, -1.0], "about y");
    near(&value("", "rot_z(pi/2) * [1, 2, 3]"), &[-2.0, 1.0, 3.0], "about z");
    same("", "rotation([0, 0, 2], theta)", "rot_z(theta)");
    same("", "rotation([0, -1, 0], theta)", "rot_y(-theta)");
    same("", "rotation([1, 1, 1], 2*pi/3) * [1, 2, 3]", "[3, 1, 2]");
    same("", "rotation([1, 0, 0]*0 + [2, 3, 6], theta) * [2, 3, 6]", "[2, 3, 6]");
    refused("let a = rotation([0, 0, 0], theta);", "[0, 0, 0]: an axis must have a direction, this is zero");
    refused(
        "let a = rotation([x, y, z], theta);",
        "[x, y, z]: an axis must be constant; compose rotations about constant axes: `rot_z(a) * rot_x(b)`",
    );
    refused(
        "let a = rot_z(x);",
        "x: an angle must be a plain number, this is m; divide by a quantity of the same dimension",
    );
    refused(
        "let a = translation([1, 2, 3]);",
        "[1, 2, 3]: a translation must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
    );
}

/// URDF: fixed axes, x first.
#[test]
fn roll_pitch_and_yaw() {
    same("", "rpy(theta, q[0], q[1])", "rot_z(q[1]) * rot_y(q[0]) * rot_x(theta)");
    near(&value("", "rpy(pi/2, 0, pi/2) * [0, 1, 0]"), &[0.0, 0.0, 1.0], "y is turned up by the roll");
    same("fn rpy(x) = 2*x;", "rpy(x)", "2*x");
}

#[test]
fn arrays_for_several_arguments() {
    let e = "let e = [cos(theta/2), 2/7*sin(theta/2), 3/7*sin(theta/2), 6/7*sin(theta/2)];";
    same(e, "quaternion(e)", "rotation([2, 3, 6], theta)");
    same("let j = [1, 2, 3, 4, 5, 6];", "inertia(j)", "inertia(1, 2, 3, 4, 5, 6)");
    same("const j[3] = [1, 2, 3];", "inertia(j)", "diag(1, 2, 3)");
    same("const j[3] = [1, 2, 3];", "diag(j)", "diag(1, 2, 3)");
    same("let j = [[1, 0, 2], [0, 3, 0], [2, 0, 4]];", "inertia(j)", "[[1, 0, 2], [0, 3, 0], [2, 0, 4]]");
    refused(
        "let a = quaternion([1, 0, 0]);",
        "[1, 0, 0]: a quaternion is an array of 4 numbers, the scalar part first; this is a vector",
    );
    refused(
        "let a = inertia([1, 2, 3, 4]);",
        "[1, 2, 3, 4]: an inertia is an array of 3 or 6 numbers, or a matrix; this is an array of 4",
    );
}

#[test]
fn axes_of_parameters() {
    let text = |axis: &str| {
        format!(
            "mechanism A {{ param a[3]: m = [2, 3, 6]; param j: kg*m^2 = 2; coord theta: rad; coord psi: rad; \
             let first = rotation({axis}, theta); let second = first * rot_x(psi); \
             kinetic += rigid_body(0*j/a[0]^2, [0, 0, 0], diag(1, 2, 2.5)*j, second); \
             output w = angular_velocity(second); output r = second.rotation(); }}"
        )
    };
    let all = |axis: &str| {
        crate::model::check::trial::resolved(&text(axis), |result| {
            let (lagrangian, _) = result.unwrap_or_else(|e| panic!("{}", e.render("a", &text(axis))));
            let exprs: Vec<Expr<'_>> = lagrangian.kinetic.clone();
            let graph = crate::expr::Graph::new();
            let along = |symbol| crate::model::check::singular::along_the_motion(&graph, symbol);
            crate::expr::evaluate(&crate::expr::carry_out(&exprs, &graph, along), |symbol| match symbol {
                crate::expr::Symbol::Coordinate(i) => [0.4, -0.9][i as usize],
                crate::expr::Symbol::Velocity(i) => [1.7, 0.8][i as usize],
                crate::expr::Symbol::Parameter(i) => [2.0, 3.0, 6.0, 2.0][i as usize],
                _ => f64::NAN,
            })
        })
    };
    near(&all("a"), &all("[2, 3, 6]"), "an axis of parameters is that of their values");
    let generated = crate::generate("a", &text("a"), &Default::default());
    assert!(generated.is_ok(), "{}", generated.unwrap_err().render("a", &text("a")));
    refused(
        "param a[3]: m = 0; let p = rotation(a, theta);",
        "a: an axis must have a direction, by the default values of the parameters this is zero; choose another default, such as `[0, 0, 1]`",
    );
}

#[test]
fn quaternions() {
    let half = "let w = cos(theta/2); let s = sin(theta/2);";
    same(half, "quaternion(w, s, 0, 0)", "rot_x(theta)");
    same(half, "quaternion(w, 0, 0, s) * rot_x(q[0])", "rot_z(theta) * rot_x(q[0])");
    same(half, "quaternion(w, 2*s/7, 3*s/7, 6*s/7)", "rotation([2, 3, 6], theta)");
    same(half, "angular_velocity(quaternion(w, 2*s/7, 3*s/7, 6*s/7))", "angular_velocity(rotation([2, 3, 6], theta))");
    same(
        half,
        "angular_velocity(rot_x(q[1]) * quaternion(w, 2*s/7, 3*s/7, 6*s/7) * rot_y(q[0]))",
        "angular_velocity(rot_x(q[1]) * rotation([2, 3, 6], theta) * rot_y(q[0]))",
    );
    same(half, "quaternion(w, s, 0, 0).inverse() * quaternion(w, s, 0, 0)", "world");
    same("", "quaternion(1, 0, 0, 0)", "world");
    same("", "quaternion(0.6, 0, 0.8, 0) * [x, y, z]", "rotation([0, 1, 0], 2*acos(0.6)) * [x, y, z]");
    refused(
        "let a = quaternion(1, 0, 0, 2);",
        "quaternion(1, 0, 0, 2): a rotation is a quaternion of length 1, this has length 2.23606797749979; divide its components by its length",
    );
    // Of eight digits, as files hold them.
    let digits = "quaternion(0.70710678, 0, 0, 0.70710678)";
    near(&value("", &format!("[({digits}*[1, 0, 0]).norm(), {digits}.point([l, 0, 0]).y/l]")), &[1.0, 1.0], "a unit");
    near(&value("", "quaternion(0.6, 0.8000009, 0, 0).rotation()[0]"), &[1.0, 0.0, 0.0], "a unit");
    refused(
        "param e[4]: 1 = [0.70710678, 0, 0, 0.70710678]; let a = quaternion(e);",
        "quaternion(e): a rotation is a quaternion of length 1, by the default values of the parameters this has length \
         0.9999999983219684; divide its components by its length",
    );
    refused(
        "param e[4]: 1 = [2, 0, 0, 0]; let a = quaternion(e);",
        "quaternion(e): a rotation is a quaternion of length 1, by the default values of the parameters this has length 2; \
         divide its components by its length",
    );
    let unit = "param e[4]: 1 = [2, 0, 0, 0]; let n = sqrt(e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2); \
                output o = quaternion(e[0]/n, e[1]/n, e[2]/n, e[3]/n).rotation();";
    mechanism(unit, |_| ());
    refused(
        "let a = quaternion(1, 0, 0, x);",
        "x: a component of a quaternion must be a plain number, this is m; divide by a quantity of the same dimension",
    );
    refused(
        "let a = quaternion(1, 0, 0, u/(k*l));",
        "quaternion(1, 0, 0, u/(k*l)): a pose cannot depend on an input; the rate of an input is not known: make it a coordinate or a formula of `t`",
    );
}

#[test]
fn a_rational_axis_is_exact() {
    mechanism("output r = rotation([2, 3, 6], theta);", |lagrangian| {
        let Some(Edge::Rotation { axis, .. }) = lagrangian.frames.iter().last().unwrap().edge else { panic!("turned") };
        let seventh = |n| Number::rational(n, 7);
        assert_eq!(axis.0.map(|e| e.as_constant()), [seventh(2), seventh(3), seventh(6)]);
    });
}

#[test]
fn denavit_hartenberg() {
    let lengths = "const d: m = 2; const a: m = 3;";
    same(
        lengths,
        "dh(theta, d, a, q[0])",
        "rot_z(theta) * translation([0, 0, d]) * translation([a, 0, 0]) * rot_x(q[0])",
    );
    near(&value(lengths, "dh(90*deg, d, a, -90*deg).point([d, a, a])"), &[-3.0, 5.0, -1.0], "of constants");
    // What does nothing is no frame.
    let edges = |pose: &str| mechanism(&format!("{lengths} output r = {pose};"), |l| l.frames.iter().count() - 1);
    assert_eq!(edges("dh(theta, d, a, pi/2)"), 3);
    assert_eq!(edges("dh(theta, 0, 0, pi - pi)"), 1);
    assert_eq!(edges("dh(0, 0, 0, 0)"), 0);
}

#[test]
fn places_belong_to_their_pose() {
    let poses = "let a = rot_z(theta); let b = rot_x(theta);";
    refused(
        &format!("{poses} let p = a.point(b * [x, y, z]);"),
        "b * [x, y, z]: this vector belongs to another pose; write its components in the axes of this pose: `[x, y, z]`",
    );
    refused(
        &format!("{poses} let p = a.point(b.point([x, y, z]));"),
        "b.point([x, y, z]): this vector belongs to another pose; write its components in the axes of this pose: `[x, y, z]`",
    );
    refused(
        "let p = world.point([1, 0, 0]);",
        "[1, 0, 0]: a place must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
    );
    same(poses, "a.point(a * [x, y, z])", "a.point([x, y, z])");
}
