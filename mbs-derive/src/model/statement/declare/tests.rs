use crate::expr::Number;
use crate::model::check::trial::{mechanism, messages, near, refusals, refused, value, value_with_unit};

#[test]
fn plain_numbers_are_in_the_declared_unit() {
    let check = |declaration: &str, expected: Option<Number>, unit: &str| {
        mechanism(declaration, |lagrangian| {
            let parameter = lagrangian.parameters.last().unwrap();
            assert_eq!(
                (parameter.defaults.last().copied(), parameter.unit.as_str()),
                (expected, unit),
                "{declaration}"
            );
        });
    };
    check("param a: m = 0.5;", Number::rational(1, 2), "m");
    check("param a: mm = 0.5;", Number::rational(1, 2000), "m");
    check("param a: kN*mm = 3;", Number::rational(3, 1), "N*m");
    check("param a: deg = -90;", Some(Number::PI * Number::rational(-1, 2).unwrap()), "rad");
    check("const b: rad = 0.5; param a: deg = b;", Number::rational(1, 2), "rad");
    check(
        "const b[2]: deg = [90, -90]; param a: deg = -b[1];",
        Some(Number::PI * Number::rational(1, 2).unwrap()),
        "rad",
    );
    check("const b: rad = 0.5; param a[2]: deg = [90 deg, b];", Number::rational(1, 2), "rad");
    check("const b: 1 = 180; param a: deg = b;", Some(Number::PI), "rad");
    check("param a: rad = 90*deg;", Some(Number::PI * Number::rational(1, 2).unwrap()), "rad");
    check("param a: 1 = 2^-2;", Number::rational(1, 4), "1");
    check("const b: mm = 4; param a: mm = 2*b;", Number::rational(1, 125), "m");
    check("param a[3]: kg = [1, 2, 3];", Number::rational(3, 1), "kg");
    check("param a[3]: mm = -[1, 2, 3];", Number::rational(-3, 1000), "m");
    check("const v[3]: m = [1, 2, 3]; param a[3]: m = 2*[v[0], v[1], v[2]];", Number::rational(6, 1), "m");
    check("param a[3]: kg = 1/3;", Number::rational(1, 3), "kg");
    check("const n = 3; param a[2*n]: kg = 0;", Number::rational(0, 1), "kg");
}

#[test]
fn matrices_of_parameters() {
    let declared = "param j[3][3]: kg*mm^2 = [[2e6, 0, 1e6], [0, 3e6, 0], [1e6, 0, 4e6]];";
    mechanism(declared, |lagrangian| {
        let j = lagrangian.parameters.last().unwrap();
        let defaults: Vec<f64> = j.defaults.iter().map(|n| n.to_f64()).collect();
        assert_eq!((j.length, defaults), (Some(9), vec![2.0, 0.0, 1.0, 0.0, 3.0, 0.0, 1.0, 0.0, 4.0]));
        assert_eq!((j.component_names()[5].as_str(), j.lengths()), ("j_1_2", vec![3, 3]));
    });
    mechanism("param a[2][3]: m = 1; param w[3][3]: m = diag(1, 2, 3); let v = w*[1, 0, 0]; let b = a[1][2];", |l| {
        let w = l.parameters.last().unwrap();
        assert_eq!(w.defaults[4], Number::integer(2));
    });
    refused(
        "param a[2][2]: m = [1, 2, 3, 4];",
        "[1, 2, 3, 4]: 2 rows of 2 are declared, this is an array of 4; one value without brackets stands for all entries",
    );
    let text = "mechanism A { param m: kg = 1; param j[3][3]: kg*m^2 = [[2, 0, 1], [0, 3, 0], [1, 0, 4]]; coord q[3]: rad; \
                let b = rpy(q[0], q[1], q[2]); kinetic += rigid_body(m, [0, 0, 0], inertia(j), b); }";
    let report = crate::generate("a", text, &Default::default()).unwrap_err().render("a", text);
    assert!(report.contains("an inertia is symmetric"), "{report}");
    let entries = "inertia(j[0][0], j[1][1], j[2][2], j[0][1], j[0][2], j[1][2])";
    let text = text.replace("inertia(j)", entries);
    let generated = crate::generate("a", &text, &Default::default());
    assert!(generated.is_ok_and(|g| g.code.contains("pub j: [[T; 3]; 3]")));
}

#[test]
fn frozen_matrices_are_those_of_the_parameters() {
    let text = "mechanism A { param a[2][3]: kg = 1; param w[3][3]: kg = diag(1, 2, 3); \
                param k[2][2]: kg = [[4, 5], [6, 7]]; coord x: m; kinetic += (a[1][2] + w[1][1] + k[1][0])*dt(x)^2; }";
    let frozen = crate::emit::Options::default().freeze(["a", "w", "k"]);
    let generated = crate::generate("a", text, &frozen).unwrap_or_else(|error| panic!("{}", error.render("a", text)));
    assert!(generated.code.contains("18.0"), "{}", generated.code);
}

#[test]
fn constants_of_any_shape() {
    assert_eq!(value_with_unit("const a: mm = 5;", "a"), (vec![0.005], "m".to_string()));
    assert_eq!(value_with_unit("const a = 2; const b = a^2;", "b"), (vec![4.0], "1".to_string()));
    assert_eq!(value_with_unit("const a: m = 2; const b = a^2;", "b"), (vec![4.0], "m²".to_string()));
    near(&value("const com[2]: mm = [[1, 2, 3], [4, 5, 6]];", "com[1]"), &[0.004, 0.005, 0.006], "vectors");
    assert_eq!(value_with_unit("const a: m = [1, 0, 0];", "2*a").1, "m");
    assert_eq!(value_with_unit("const i: kg*m^2 = inertia(1, 2, 3);", "i").1, "kg·m²");
    near(&value("const v[3]: mm = 2*[1, 2, 3];", "v[1]"), &[0.004], "numbers of a vector");
    near(&value("const alpha[3]: deg = [90, 0, -45];", "alpha[2]"), &[-std::f64::consts::FRAC_PI_4], "degrees");
    assert_eq!(value("for i in 0..2 { const c = 2*i; }", "x"), [0.3]);
}

#[test]
fn documentation_and_units_are_kept() {
    mechanism(
        "/// How\n/// heavy.\nparam a: kg = 1; coord w[2]: m; kinetic += a*dt(w[0])^2 + m*dt(w[1])^2;",
        |lagrangian| {
            let parameter = lagrangian.parameters.last().unwrap();
            assert_eq!(parameter.docs, ["How", "heavy."]);
            let w = lagrangian.coordinates.last().unwrap();
            assert_eq!((w.first, w.length, w.unit.as_str()), (6, Some(2), "m"));
        },
    );
}

#[test]
fn prescribed_motions() {
    assert_eq!(value_with_unit("prescribed s: m = 2*l*t^2/t^2;", "s"), (vec![6.0], "m".to_string()));
    near(
        &value("prescribed s[2]: 1 = [sin(t/t), 2]; prescribed w: 1/s = 3/t;", "[s[0], s[1], w*t]"),
        &[1f64.sin(), 2.0, 3.0],
        "formulas",
    );
    near(
        &value("prescribed s: 1 = (t/(t^2)*t)^2; prescribed r[2]: m = l;", "[dt(s)*t, r[1]/l]"),
        &[0.0, 1.0],
        "formulas",
    );
    // Run-time signals with their derivatives.
    assert_eq!(value_with_unit("prescribed s: m;", "dt(s)"), (vec![-1.4], "m/s".to_string()));
    near(
        &value("prescribed s[2]: rad;", "[s[0], s[1], dt(s[1]*x/l)]"),
        &[0.6, 1.6, (-0.4 * 0.3 + 1.6 * 0.5) / 3.0],
        "signals",
    );
    mechanism("/// Up and down.\nprescribed heave[2]: m; kinetic += 1/2*m*dt(x + heave[1])^2;", |lagrangian| {
        let [heave] = &lagrangian.prescribed[..] else { panic!("one") };
        assert_eq!((heave.length, heave.unit.as_str(), &*heave.docs[0]), (Some(2), "m", "Up and down."));
    });
    refused(
        "prescribed s: m = x;",
        "x: a prescribed motion does not depend on coordinates or inputs; a prescribed motion is a formula of `t`, constants and parameters; write `let` for anything else",
    );
    refused("prescribed s: m = m*t/t;", "m*t/t: `s` must be m, this is kg");
    refused("prescribed s: mm = l;", "mm: `s` is a formula, in SI units; write `prescribed s: m = …;`");
    refused("prescribed s: mm;", "mm: `s` is given at run time, in SI units; write `prescribed s: m;`");
    refused(
        "prescribed s: m = [l, l];",
        "[l, l]: `s` is one number, this is an array of 2; write `let` for anything else, or declare a length: `[3]`",
    );
    refused(
        "prescribed s[3]: m = [l, l];",
        "[l, l]: this array has 2 elements, 3 are declared; one value without brackets stands for all elements",
    );
    refused("prescribed s: m;", "s: `s` is not used; it is in no energy, force, constraint or output");
    refused(
        "prescribed s: m; let a = dt(dt(s));",
        "dt(s): accelerations cannot enter: this is a time derivative already; energies and forces are made of positions and velocities, inertia is kinetic energy",
    );
    assert!(refusals("prescribed s: m; kinetic += particle(m, [s, 0, x]);").is_empty());
}

#[test]
fn wrong_quantities() {
    refused(
        "param a: m;",
        "a: the parameter `a` needs a default; parameters can be set at run time; the default is what they are until then",
    );
    refused(
        "param a: m = l;",
        "l: the default of a parameter must be known at build time; it is made of numbers, `pi` and other constants; what is made of parameters is a `let`",
    );
    refused(
        "const a: m = 2*x;",
        "2*x: a `const` must be known at build time; it is made of numbers, `pi` and other constants; what is made of parameters is a `let`",
    );
    refused(
        "const b: kg = 1; param a: m = 2*b;",
        "2*b: m is declared, this is kg; a plain number is taken in the declared unit",
    );
    refused(
        "param a: furlong = 1;",
        "furlong: `furlong` is not a unit; units are those of the SI: `kg`, `m`, `s`, `rad`, `N`, `J`, `W`, `Pa` …",
    );
    refused("param a: Nm = 1;", "Nm: `Nm` is not a unit; did you mean `N*m`?");
    refused(
        "param a: deg = pi/2;",
        "pi/2: this angle is in radians already, as its `pi` or `deg` shows; declare it in `rad`, or write the number of degrees alone",
    );
    refused(
        "param a[3]: kg = [1, 2];",
        "[1, 2]: this array has 2 elements, 3 are declared; one value without brackets stands for all elements",
    );
    refused(
        "const i[3]: kg*m^2 = inertia(1, 2, 3);",
        "inertia(1, 2, 3): `i` is an array of 3, this is a matrix; leave `[3]` out, or write `[…, …, …]` with three elements",
    );
    refused(
        "const w[4]: m = [1, 2, 3];",
        "[1, 2, 3]: this array has 3 elements, 4 are declared; one value without brackets stands for all elements",
    );
    // One value stands for all elements.
    let copies = "const i[2]: kg*m^2 = diag(1, 2, 3); const c[2]: m = 2*[1, 2, 3];";
    assert_eq!(refusals(copies), [""; 0]);
    refused("param a: kg = [1, 2];", "[1, 2]: `a` is one number, this is an array of 2; write `param a[2]`");
    refused(
        "param a: kg = world;",
        "world: the default of a parameter is made of numbers, this is a pose; write `let` for anything else",
    );
    refused("param a[0]: kg = 1;", "0: an array has from 1 to 10000 elements, not 0");
    refused("param a[100000]: kg = 1;", "100000: an array has from 1 to 10000 elements, not 100000");
    refused(
        "param a[m]: kg = 1;",
        "m: the length of an array must be a constant integer; a parameter may change at run time: declare it as `const name = …;`",
    );
    refused("coord w: deg;", "deg: `w` is given at run time, in SI units; write `coord w: rad;`");
    refused("input w: kN*mm^2;", "kN*mm^2: `w` is given at run time, in SI units; write `input w: N*m^2;`");
    // A wrong declaration declares its name all the same.
    assert_eq!(refusals("param a: furlong = 1; let b = a + 1; param c: m; let d = c + l;").len(), 2);
}

#[test]
fn names_of_components_are_names() {
    let text = "mechanism A { coord q[2]: m; param q_1: kg = 1; kinetic += 1/2*q_1*(dt(q[0])^2 + dt(q[1])^2); }";
    assert_eq!(messages(text), ["q_1: `q_1` and `q` both have a component called `q_1`; choose another name"]);
    // The columns of `mbs simulate`.
    let column = |coordinate: &str| {
        messages(&format!(
            "#![dimensionless] mechanism A {{ coord x: 1; coord q[2]: 1; coord {coordinate}: 1; \
             lagrangian += dt(x)^2 + dt(q[0])^2 + dt(q[1])^2 + dt({coordinate})^2; constraint c: x = q[0]; }}"
        ))
    };
    let taken = |name: &str, what: &str| {
        let help = "choose another name for the coordinate";
        assert!(
            column(name)[0].starts_with(&format!("{name}: `{name}` is what {what} is called")),
            "{:?}",
            column(name)
        );
        assert!(column(name)[0].ends_with(help));
    };
    taken("x_dot", "the rate of `x`");
    taken("q_1_dot", "the rate of `q_1`");
    taken("energy", "the energy");
    taken("lambda_c", "a number of the constraint `c`");
    assert!(column("q_dot").is_empty() && column("lambda_x").is_empty());
}
