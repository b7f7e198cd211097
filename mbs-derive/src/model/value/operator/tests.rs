use crate::model::check::trial::{near, refused, same, value, value_with_unit};

#[test]
fn dimensions_follow_the_operators() {
    let unit = |expression: &str, unit: &str| assert_eq!(value_with_unit("", expression).1, unit, "{expression}");
    unit("m*dt(x)^2", "kg·m²/s²");
    unit("k*x/m", "m/s²");
    unit("l^-1", "1/m");
    unit("(l*l)^(1/2)", "m");
    unit("l^1.5", "m^(3/2)");
    unit("l^(1/3)", "m^(1/3)");
    unit("(l^(2/3))^1.5", "m");
    unit("-l + 0", "m");
    unit("sqrt(k/m)", "1/s");
    unit("[x, 0, l]", "m");
    unit("2*[x, 0, l]/t", "m/s");
    unit("diag(m, m, 0)*[x, 0, l]", "kg·m");
    refused("let a = m + l;", "l: a sum needs equal dimensions, this term is m, not kg");
    // The one that is unlike the others, wherever it stands; zeros are like all others.
    refused("let a = 0 + m + l*l/x - x + l;", "m: a sum needs equal dimensions, this term is kg, not m");
    refused("let a = 2*(x - (l + m) + x);", "m: a sum needs equal dimensions, this term is kg, not m");
    refused("let a = (x - 2*m + l)*m + x*m;", "2*m: a sum needs equal dimensions, this term is kg, not m");
    // An energy is wanted.
    refused(
        "kinetic += m*dt(x)/2 + m*dt(x)^2;",
        "m*dt(x)/2: a sum needs equal dimensions, this term is kg·m/s, not kg·m²/s²",
    );
    refused("force x += m + k*x;", "m: a sum needs equal dimensions, this term is kg, not kg·m/s²");
    refused(
        "let a = l + 1;",
        "1: a sum needs equal dimensions, this term is a plain number, not m; it lacks a factor of m",
    );
    refused("let a = [x, y, z] - [m, m, m];", "[m, m, m]: a sum needs equal dimensions, this term is kg, not m");
    refused(
        "let a = [x, theta, 0] + [x, 0, 0];",
        "[x, theta, 0]: the components of a vector share one dimension, these are m and 1",
    );
    refused(
        "let a = 2^l;",
        "l: an exponent must be a plain number, this is m; divide by a quantity of the same dimension",
    );
    refused(
        "let a = l^theta;",
        "theta: a power of m needs a constant exponent, such as 2, -1 or 1/3; divide the base by a quantity of its dimension to make it a plain number",
    );
    refused(
        "let a = l^(1/1000000007);",
        "(1/1000000007): m to the power of 1/1000000007 is no dimension; the exponents of a dimension are small \
         fractions: divide the base by a quantity of its dimension to make it a plain number",
    );
    // Underflow is no zero.
    let underflow =
        "this is not zero, but nearer to it than an `f64` can be; choose other units, or check the exponents";
    refused("let a = 1e-200*1e-200;", &format!("1e-200*1e-200: {underflow}"));
    refused("const c = 1e-200; let a = x*c^2;", &format!("c^2: {underflow}"));
    refused("let a = x*(1e-300/1e300);", &format!("1e-300/1e300: {underflow}"));
    refused(
        "param a: mm = 1e-322;",
        "1e-322: in m this is nearer to zero than an `f64` can be; choose other units, or check the exponent",
    );
    refused("let a = l^1000;", "1000: an exponent is at most 100; `exp(n * ln(x))` takes any");
    refused(
        "let mut a = l/l*m; for i in 0..20 { let b = a^100; let c = b^100; }",
        "b^100: the exponents of this dimension are out of range",
    );
    refused(
        "let a = (-2)^0.3;",
        "(-2): a negative number has no power with this exponent; integers and halves are exponents for any base",
    );
    let changes = "zero has no power with an exponent that changes; write 0 in its place: that is what it is where the exponent is positive";
    refused("let a = (sin(pi))^theta;", &format!("(sin(pi)): {changes}"));
    refused("let a = 0^(u/(1 N));", &format!("0: {changes}"));
}

#[test]
fn powers() {
    near(
        &value("", "[2^3, 2^-1, 2^0.5, 2^0.3, 2^theta]"),
        &[8.0, 0.5, 2f64.sqrt(), 2f64.powf(0.3), 2f64.powf(0.4)],
        "powers",
    );
    near(&value("param p: 1 = 2;", "[sin(pi)^0.3, 0^0.3]"), &[0.0, 0.0], "powers of zero");
}

#[test]
fn vectors() {
    near(&value("", "2*[1, 2, 3] - [1, 1, 1]/2 + -[1, 0, 0]"), &[0.5, 3.5, 5.5], "combination");
    near(&value("", "[1, 2, 3].cross([4, 5, 6])"), &[-3.0, 6.0, -3.0], "cross");
    near(&value("", "dot([1, 2, 3], [4, 5, 6])"), &[32.0], "dot");
    refused(
        "let a = [x, y, z]*[x, y, z];",
        "[x, y, z]*[x, y, z]: no `*` between a vector and a vector; write `a.dot(b)` or `a.cross(b)`",
    );
    refused(
        "let a = [x, y, z]^2;",
        "[x, y, z]^2: no `^` between a vector and a number; the square of a vector is `v.norm_squared()`",
    );
    refused("let a = [x, y, z] + x;", "[x, y, z] + x: no `+` between a vector and a number");
    refused(
        "let a = 2*q;",
        "q: an array of 2 cannot be calculated with as a whole; only vectors can, arrays of three numbers: use its elements, `a[0]`",
    );
}

#[test]
fn vectors_of_one_frame_are_not_turned() {
    let poses = "let a = rot_z(theta); let b = a * translation([l, 0, 0]); let c = a * rot_x(q[0]);";
    // In the axes that they share, whatever their origins: the sum has the same components.
    crate::model::check::trial::mechanism(
        &format!("{poses} output r = (a*[x, 0, 0] + b*[0, y, 0]).norm_squared();"),
        |lagrangian| {
            let crate::model::OutputValue::Scalar(expr) = lagrangian.outputs[0].value else { panic!("a number") };
            assert_eq!(expr.to_string(), "(q_0 + 0)^2 + (0 + q_1)^2 + (0 + 0)^2");
        },
    );
    same(
        poses,
        "(a*[x, 0, 0]).dot(c*[0, y, 0])",
        "[x*cos(theta), x*sin(theta), 0].dot(a.rotation() * (rot_x(q[0]).rotation() * [0, y, 0]))",
    );
    same(poses, "a*[x, y, z] + [l, 0, 0]", "[x*cos(theta) - y*sin(theta) + l, x*sin(theta) + y*cos(theta), z]");
}

#[test]
fn points() {
    let poses = "let a = rot_z(theta) * translation([l, 0, 0]); let p = a.point([x, y, 0]); let r = a.origin();";
    same(poses, "p - r", "a * [x, y, 0]");
    same(poses, "(p - r).norm_squared()", "x^2 + y^2");
    same(poses, "r + a*[x, y, 0]", "p");
    same(poses, "p - a*[x, y, 0]", "r");
    same(poses, "p - world.origin()", "p");
    same(poses, "(p + r)/2", "[(p.x + r.x)/2, (p.y + r.y)/2, 0]");
    same(poses, "rot_x(q[0]) * p", "(rot_x(q[0]) * a).point([x, y, 0])");
    same(poses, "-p", "[-p.x, -p.y, 0]");
}

#[test]
fn poses_compose_and_invert() {
    let poses = "let a = rot_z(theta) * translation([l, x, 0]) * rot_y(q[0]); let b = rotation([2, 3, 6], q[1]);";
    same(poses, "(a * b) * a", "a * (b * a)");
    same(poses, "a * a.inverse()", "world");
    same(poses, "(a * b).inverse()", "b.inverse() * a.inverse()");
    same(poses, "a * world", "a");
    same(poses, "(a * b) * [x, y, z]", "a.rotation() * (b.rotation() * [x, y, z])");
    same(poses, "a * (b * [x, y, z])", "(a * b) * [x, y, z]");
    // Long enough to become frames on the way.
    same(&format!("{poses} let mut c = a; for i in 0..9 {{ c = c * b; }}"), "c * c.inverse()", "world");
    refused("let a = world + world;", "world + world: no `+` between a pose and a pose; poses are composed by `*`");
    refused("let a = -world;", "world: a pose has no sign; the inverse of a pose is `pose.inverse()`");
    refused(
        "let a = [x, y, z]*world;",
        "[x, y, z]*world: no `*` between a vector and a pose; the vector stands behind what turns it: `pose * v`",
    );
    refused(
        "let a = rot_z(u*l/(k*l^2));",
        "u*l/(k*l^2): a pose cannot depend on an input; the rate of an input is not known: make it a coordinate or a formula of `t`",
    );
    refused(
        "let a = translation([t*dt(x), 0, 0]);",
        "[t*dt(x), 0, 0]: a pose cannot depend on a time derivative; its own velocity would be an acceleration",
    );
}

#[test]
fn only_poses_that_something_stands_on_become_frames() {
    let count = |statements: &str| crate::model::check::trial::mechanism(statements, |l| l.frames.iter().count());
    assert_eq!(count("let a = rot_z(theta) * translation([l, 0, 0]); let b = a * rot_x(q[0]);"), 1);
    assert_eq!(count("let a = rot_z(theta) * translation([l, 0, 0]); output r = (a * rot_x(q[0])).origin();"), 4);
}

#[test]
fn matrices() {
    same("", "(diag(1, 2, 3) + [[0, 1, 0], [1, 0, 0], [0, 0, 0]]) * [x, y, z]", "[x + y, x + 2*y, 3*z]");
    same("", "2*diag(1, 2, 3) - diag(1, 1, 1)", "diag(1, 3, 5)");
    same("", "rot_z(theta).rotation() * rot_z(theta).rotation().transpose()", "diag(1, 1, 1)");
    same("", "-diag(1, 1, 1)*[x, y, z]/2", "[-x/2, -y/2, -z/2]");
}

#[test]
fn rates() {
    let pose = "let a = rot_z(theta) * rot_x(q[0]) * translation([l, x, 0]);";
    same("", "dt(x*sin(theta))", "dt(x)*sin(theta) + x*cos(theta)*dt(theta)");
    same("", "dt(t^2)", "2*t");
    same("", "dt(m)", "0*m/t");
    same("", "dt(q)", "[dt(q[0]), dt(q[1])]");
    same("", "dt([x, 0, z])", "[dt(x), 0, dt(z)]");
    same("", "dt([x, y*theta, z])", "[dt(x), dt(y*theta), dt(z)]");
    // In the axes of the pose, and yet the rates of the world components.
    same(pose, "dt(a * [x, y, z])", "[dt((a * [x, y, z]).x), dt((a * [x, y, z]).y), dt((a * [x, y, z]).z)]");
    same(
        pose,
        "dt(a.point([x, y, z]))",
        "[dt(a.point([x, y, z]).x), dt(a.point([x, y, z]).y), dt(a.point([x, y, z]).z)]",
    );
    same(pose, "dt(a.rotation()*[1, 2, 3])", "angular_velocity(a).cross(a * [1, 2, 3])");
    same("", "angular_velocity(rot_z(theta))", "[0, 0, dt(theta)]");
    refused(
        "let a = dt(dt(x));",
        "dt(x): accelerations cannot enter: this is a time derivative already; energies and forces are made of positions and velocities, inertia is kinetic energy",
    );
    refused(
        "let a = dt(dt([x, y, z]));",
        "dt([x, y, z]): accelerations cannot enter: this is a time derivative already; energies and forces are made of positions and velocities, inertia is kinetic energy",
    );
    refused("let a = dt(u);", "u: the rate of an input is not known; make it a coordinate or a formula of `t`");
    refused(
        "let a = dt(world);",
        "world: a pose has no time derivative; its velocities are `angular_velocity(pose)` and `dt(pose.origin())`",
    );
}
