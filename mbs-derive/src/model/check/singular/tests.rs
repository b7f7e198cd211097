use crate::model::check::trial::refusals;

/// Statements with one warning: the place, and where the derivative fails.
fn warned(statements: &str, place: &str, at: &str) {
    let found = refusals(statements);
    let expected =
        found.len() == 1 && found[0].starts_with(&format!("{place}: ")) && found[0].contains(&format!(" where {at}: "));
    assert!(expected, "{statements}: {found:?}");
}

fn fine(statements: &str) {
    assert_eq!(refusals(statements), [""; 0], "{statements}");
}

#[test]
fn lengths_at_zero() {
    warned("potential += k*l*[x, y, z].norm();", "[x, y, z].norm()", "`x` = 0, `y` = 0, `z` = 0");
    warned("potential += k*l*sqrt(x^2 + y^2);", "sqrt(x^2 + y^2)", "`x` = 0, `y` = 0");
    warned("potential += k*l*hypot(x, y);", "hypot(x, y)", "`x` = 0, `y` = 0");
    warned("potential += k*l*(x^2 + y^2)^0.5;", "(x^2 + y^2)^0.5", "`x` = 0, `y` = 0");
    warned(
        "potential += spring(k, hypot(x - y, z - theta*l), l);",
        "hypot(x - y, z - theta*l)",
        "`x` = 0, `y` = 0, `z` = 0, `theta` = 0",
    );
    warned("output speed = dt([x, y, 0]).norm();", "dt([x, y, 0]).norm()", "`dt(x)` = 0, `dt(y)` = 0");
    warned("fn far(a) = sqrt(a^2 + y^2); potential += k*l*far(x);", "sqrt(a^2 + y^2)", "`x` = 0, `y` = 0");
    // A folded arm whose tip comes back to its base; two points that meet.
    let arm = "let a = rot_z(theta) * translation([l, 0, 0]) * rot_z(q[0]);";
    warned(&format!("{arm} output reach = a.point([l, 0, 0]).norm();"), "a.point([l, 0, 0]).norm()", "`q_0` = π");
    warned("output gap = ((x - y)^2)^(1/2);", "((x - y)^2)^(1/2)", "`x`, `y` are equal");
    warned("constraint level: x*hypot(x, y) = 0;", "hypot(x, y)", "`x` = 0, `y` = 0");
}

/// Where the same vanishes at several places each has its own warning.
#[test]
fn each_place_has_its_warning() {
    let found = refusals("output a = sqrt(x^2); output b = (x^2)^(1/3); potential += k*l^(2/3)*(x^2)^(2/3);");
    let of = |place: &str, means: &str| {
        let is_it = |warning: &&String| warning.starts_with(&format!("{place}: ")) && warning.contains(means);
        assert_eq!(found.iter().filter(is_it).count(), 1, "{place}: {found:?}");
    };
    of("sqrt(x^2)", "this has a kink");
    of("(x^2)^(1/3)", "the output's velocity");
    of("(x^2)^(2/3)", "the equations of motion");
}

#[test]
fn what_cancels_or_is_never_reached_is_fine() {
    fine("potential += k*[x, y, z].norm()^2;");
    fine("potential += k*sqrt(x^2 + y^2)*sqrt(x^2 + y^2) + k*hypot(x, y)^2 + k*abs(x)^2 + spring(k, hypot(x, y), 0);");
    fine("potential += k*sqrt(x^2 + y^2 + l^2)*l;");
    // Gravity, a metric of Poincaré's half plane, a dipole: nobody gets to the centre.
    fine("potential += -k*l^3/[x, y, z].norm();");
    fine("kinetic += m*l^2*dt(x)^2/y^2;");
    fine("potential += k*l^3*z*l/[x, y, z].norm()^3;");
    // A rod keeps its ends apart.
    fine("constraint rod: sqrt(x^2 + y^2) = l;");
    fine("constraint rod: x^2 + y^2 = l^2; output length = hypot(x, y);");
    // Parameters do not move, and branches that are not taken do not count.
    fine("param e: 1 = 0; potential += sqrt(e)*k*x^2 + abs(e)*k*x^2;");
    fine("potential += if x^2 + y^2 > l^2/1000 { k*l*hypot(x, y) } else { k*(x^2 + y^2) };");
}

/// Forces are differentiated once, energies twice.
#[test]
fn what_the_linearization_needs() {
    let drag = "const c: N*s^2/m^2 = 1; let v = dt([x, y, z]);";
    let at_rest = "`dt(x)` = 0, `dt(y)` = 0, `dt(z)` = 0";
    warned(&format!("{drag} force at [x, y, z] += -c*v.norm()*v;"), "v.norm()", at_rest);
    warned(&format!("{drag} dissipation += c/3*v.norm()^3;"), "v.norm()", at_rest);
    warned("potential += k*hypot(x, y)^3/l;", "hypot(x, y)", "`x` = 0, `y` = 0");
    warned("force x += -k*l*x/(hypot(x, y) + l);", "hypot(x, y)", "`x` = 0, `y` = 0");
    fine(&format!("{drag} force x += -c*abs(dt(x))*dt(x); force y += -c*v.norm_squared();"));
    fine("force x += -k*abs(x); potential += k*hypot(x, y)^4/l^2;");
}

#[test]
fn kinks() {
    warned("potential += k*l*abs(x);", "abs(x)", "`x` = 0");
    warned("const c: N = 1; dissipation += c*abs(dt(x));", "abs(dt(x))", "`dt(x)` = 0");
    warned("output distance = abs(x - y);", "abs(x - y)", "`x`, `y` are equal");
    fine("potential += k*(abs(x) + x)^2 + k*abs(x)*x^2/l + k*x*abs(x);");
}

#[test]
fn angles_and_powers() {
    warned("output azimuth = atan2(y, x);", "atan2(y, x)", "`x` = 0, `y` = 0");
    // An angular velocity grows without bound towards the centre.
    fine("kinetic += m*l^2*dt(atan2(y, x))^2;");
    warned("potential += k*l^2*acos(cos(theta));", "acos(cos(theta))", "`theta` = 0");
    warned("potential += k*l^2*asin(sin(theta));", "asin(sin(theta))", "`theta` = π/2");
    warned("potential += k*l^2*(theta^2)^(1/3);", "(theta^2)^(1/3)", "`theta` = 0");
    warned("potential += k*l^2*(theta^2)^(4/3);", "(theta^2)^(4/3)", "`theta` = 0");
    fine("potential += k*l^2*(theta^2)^(7/3) + k*l^(2/3)*(x^2)^(2/3 + 1/3)*(l^2)^(-1/3);");
    fine("output angle = atan2(l + abs(x)*x/l, l) + asin(sin(theta)/2);");
}

#[test]
fn nothing_over_nothing() {
    warned("potential += k*l^2*sin(theta)/theta;", "k*l^2*sin(theta)/theta", "`theta` = 0");
    warned("constraint row: x*dt(t*x)/x = dt(y)*t;", "x*dt(t*x)/x", "`x` = 0");
    warned("potential += k*x^2*theta/theta;", "k*x^2*theta/theta", "`theta` = 0");
    fine("potential += k*l^3/x;");
    fine("potential += if theta^2 > 1/1000 { k*l^2*sin(theta)/theta } else { k*l^2*(1 - theta^2/6) };");
}
