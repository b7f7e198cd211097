use super::*;
use crate::emit::Options;
use crate::generate;

/// Links of these masses and lengths, each hinged at the end of the one before.
fn chain(links: &[(f64, f64)]) -> Mechanism {
    let mut chain = Mechanism::new("Chain", "Links on hinges.");
    let g = chain.param("g", "m/s^2", 9.81);
    chain.gravity(Vector::new(0.0, 0.0, -&g));
    let q = chain.coords("q", links.len(), "rad");
    let mut end = Pose::world();
    for (&(mass, length), angle) in links.iter().zip(&q) {
        let (m, l) = (quantity(mass, "kg"), quantity(length, "m"));
        let link = end * Pose::rotation([0.0, 1.0, 0.0], -angle);
        let moment = &m * l.pow(2.0) / 12.0;
        let zero = || quantity(0.0, "kg*m^2");
        let inertia = [moment.clone(), moment, zero(), zero(), zero(), zero()];
        chain.kinetic(rigid_body(&m, Vector::new(0.0, 0.0, -&l / 2.0), inertia, &link));
        chain.dissipation(quantity(0.01, "N*m*s") * angle.dt().pow(2.0) / 2.0);
        end = link * Pose::translation(Vector::new(0.0, 0.0, -&l));
    }
    chain.doc("The end of the last link.");
    chain.output("tip", &end.origin());
    chain
}

const CHAIN: &str = "/// Links on hinges.
mechanism Chain {
    param g: m/s^2 = 9.81;
    gravity [0, 0, -g];
    coord q[3]: rad;
    const m[3]: kg = [1.5, 0.7, 0.3];
    const l[3]: m = [0.4, 0.3, 0.25];
    let mut end = world;
    for i in 0..3 {
        let link = end * rotation([0, 1, 0], -q[i]);
        let moment = m[i]*l[i]^2/12;
        kinetic += rigid_body(m[i], [0, 0, -l[i]/2], inertia(moment, moment, 0, 0, 0, 0), link);
        dissipation += 0.01 N*m*s*dt(q[i])^2/2;
        end = link * translation([0, 0, -l[i]]);
    }
    /// The end of the last link.
    output tip = end.origin();
}";

/// Without the first line, which names the source.
fn module(code: &str) -> &str {
    code.split_once('\n').expect("more than a line").1
}

#[test]
fn calls_and_text_give_one_module() {
    let options = Options::default();
    let written = chain(&[(1.5, 0.4), (0.7, 0.3), (0.3, 0.25)]).generate(&options).unwrap();
    let read = generate("chain.mbs", CHAIN, &options).unwrap();
    assert_eq!(written.warnings, "");
    assert_eq!(module(&written.code), module(&read.code));
}

/// The report on what a function has written, and the line that the function begins on.
#[track_caller]
fn refused(write: impl FnOnce(&mut Mechanism, &Scalar, &Scalar)) -> String {
    let mut mechanism = Mechanism::new("A", "");
    let (m, x) = (mechanism.param("m", "kg", 1.0), mechanism.coord("x", "m"));
    write(&mut mechanism, &m, &x);
    mechanism.kinetic(m * x.dt().pow(2.0) / 2.0);
    mechanism.generate(&Options::default()).unwrap_err().render_in(&mechanism.sources())
}

#[test]
fn reports_name_the_call() {
    let line = line!() + 1;
    let report = refused(|a, m, x| a.potential(m + x));
    let place = format!("builder/tests.rs:{line}:");
    assert!(report.starts_with("error[MBS") && report.contains(&place) && report.contains("kg"), "{report}");
    // What the text says of the same mistake.
    let text = "mechanism A { param m: kg = 1; coord x: m; potential += m + x; kinetic += m*dt(x)^2/2; }";
    let told = generate("a.mbs", text, &Options::default()).unwrap_err().render("a.mbs", text);
    assert_eq!(report.lines().next(), told.lines().next());
}

#[test]
fn what_is_no_declaration_is_refused() {
    let check = |report: String, part: &str| assert!(report.contains(part), "{report}");
    check(refused(|a, _, _| drop(a.param("for", "m", 1.0))), "`for`");
    check(refused(|a, _, _| drop(a.param("l", "metre/", 1.0))), "error[MBS");
    check(refused(|a, _, _| drop(a.param("l", "m = 1; coord y: m", 1.0))), "error[MBS");
    check(refused(|a, _, _| drop(a.signal("s", "m = 2*t"))), "error[MBS");
    check(refused(|a, _, _| drop(a.param("l", "m", f64::NAN))), "NaN is not finite");
    check(refused(|a, _, x| a.force(&(x + x), 1.0)), "acts on a coordinate");
    check(refused(|a, _, x| a.output("dt of", x)), "error[MBS");
    check(refused(|a, _, _| drop(a.coord("x", "m"))), "`x` is already a coordinate");
    check(refused(|a, _, x| a.kinetic(x.dt().pow(3.0))), "error[MBS");
}

/// Neither the depth of what calls build nor the length of sums meets a limit of the stack or of the language.
#[test]
fn long_and_deep_values_are_taken() {
    let mut a = Mechanism::new("A", "");
    let (m, k, x) = (a.param("m", "kg", 1.0), a.param("k", "N/m", 1.0), a.coord("x", "m"));
    a.kinetic(&m * x.dt().pow(2.0) / 2.0);
    let square = &k * x.pow(2.0);
    let sum = (0..20_000).fold(&square / 2.0, |sum, _| sum + &square);
    let deep = (0..500).fold(square, |inner, _| -(-inner));
    a.potential(sum + deep);
    let drawn = a.declaration().expect("no mistake");
    assert!(drawn.statements.len() > 300);
    assert_eq!(a.generate(&Options::default()).unwrap().dof, 1);
    drop((0..1_000_000).fold(x, |sum, _| sum + 1.0));
}

#[test]
fn what_hangs_on_a_reaction_counts() {
    let mut a = Mechanism::new("A", "");
    let (m, g, q) = (a.param("m", "kg", 1.0), a.param("g", "m/s^2", 9.81), a.coord("q", "rad"));
    let hinge = a.reaction("hinge", Pose::rotation([0.0, 1.0, 0.0], &q));
    let bob = hinge.point(Vector::new(0.0, 0.0, quantity(-1.0, "m")));
    a.gravity(Vector::new(0.0, 0.0, -g));
    a.kinetic(particle(m, bob));
    let text =
        "mechanism A { param m: kg = 1; param g: m/s^2 = 9.81; coord q: rad; let hinge_pose = rotation([0, 1, 0], q);
        reaction hinge at hinge_pose; gravity [0, 0, -g]; kinetic += particle(m, hinge_pose.point([0, 0, -1 m])); }";
    let read = generate("a.mbs", text, &Options::default()).unwrap();
    let written = a.generate(&Options::default()).unwrap();
    assert_eq!(module(&written.code), module(&read.code));
}

#[test]
fn a_free_body_on_tables() {
    let mut a = Mechanism::new("A", "");
    let (r, e) = (a.coords("r", 3, "m"), a.coords("e", 4, "1"));
    let push = a.input("push", "N");
    let body = Pose::translation(Vector::new(&r[0], &r[1], &r[2])) * Pose::quaternion(&e[0], &e[1], &e[2], &e[3]);
    let moment = |number| quantity(number, "kg*m^2");
    let inertia = [3.0, 4.0, 5.0, 0.0, 0.0, 0.0].map(moment);
    a.kinetic(rigid_body(quantity(2.0, "kg"), [0.0, 0.0, 0.0], inertia, &body));
    let square = |part: &Scalar| part.pow(2.0);
    a.constraint("unit", &(square(&e[0]) + square(&e[1]) + square(&e[2]) + square(&e[3])), &1.0.into());
    let samples = [(-1.0, -8.0), (0.0, 0.0), (1.0, 9.0)].map(|(x, f)| (quantity(x, "m"), quantity(f, "N")));
    a.force(&r[0], -r[0].table_monotone(samples.clone()));
    a.force(&r[1], -r[1].table_spline(samples.clone()));
    a.force(&r[2], -r[2].table(samples) + push.clamp(quantity(-1.0, "N"), quantity(1.0, "N")));
    let text = "mechanism A { coord r[3]: m; coord e[4]: 1; input push: N;
        let body = translation([r[0], r[1], r[2]])*quaternion(e[0], e[1], e[2], e[3]);
        kinetic += rigid_body(2 kg, [0, 0, 0], inertia(3 kg*m^2, 4 kg*m^2, 5 kg*m^2, 0, 0, 0), body);
        constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;
        const xs[3]: m = [-1, 0, 1]; const fs[3]: N = [-8, 0, 9];
        force r[0] += -table_monotone(r[0], xs, fs); force r[1] += -table_spline(r[1], xs, fs);
        force r[2] += -table(r[2], xs, fs) + clamp(push, -1 N, 1 N); }";
    let read = generate("a.mbs", text, &Options::default()).unwrap();
    let written = a.generate(&Options::default()).unwrap();
    assert_eq!(module(&written.code), module(&read.code));
}

#[test]
fn joints_of_tables_with_shapes_springs_and_friction() {
    let mut a = Mechanism::new("A", "");
    let (q, u) = (a.coord("q", "rad"), a.coord("u", "m"));
    let zero = || quantity(0.0, "m");
    let link = Pose::dh(&q, quantity(0.2, "m"), quantity(0.5, "m"), 0.3);
    let tool = Pose::dh(0.1, &u, zero(), -0.2);
    let tool = &link * &tool;
    a.kinetic(particle(quantity(2.0, "kg"), link.origin()) + particle(quantity(1.0, "kg"), tool.origin()));
    a.potential(quantity(30.0, "N/m").spring(&u, quantity(0.1, "m")));
    let [f_c, f_s] = [3.0, 4.0].map(|force| quantity(force, "N"));
    let [v_s, v_eps] = [0.1, 0.01].map(|speed| quantity(speed, "m/s"));
    let contact = u.contact(quantity(1e4, "N/m"), quantity(10.0, "N*s/m"), u.dt());
    a.force(&u, u.dt().coulomb_stribeck(f_c, f_s, v_s, v_eps) + contact);
    a.output_with_jacobian_rate("tip", &tool.origin());
    a.draw_box(&link, Vector::new(quantity(0.1, "m"), quantity(0.2, "m"), quantity(0.3, "m")));
    a.draw_cylinder(&tool, quantity(0.02, "m"), quantity(0.4, "m"));
    a.draw_sphere(&(&tool * Pose::translation([0.0, 0.0, 0.0])), quantity(0.05, "m"));
    let text = "mechanism A { coord q: rad; coord u: m;
        let link = dh(q, 0.2 m, 0.5 m, 0.3); let tool = link * dh(0.1, u, 0 m, -0.2);
        kinetic += particle(2 kg, link.origin()) + particle(1 kg, tool.origin());
        potential += spring(30 N/m, u, 0.1 m);
        force u += coulomb_stribeck(dt(u), 3 N, 4 N, 0.1 m/s, 0.01 m/s) + contact(u, 1e4 N/m, 10 N*s/m, dt(u));
        output tip = tool.origin(), jacobian_rate; }";
    let read = generate("a.mbs", text, &Options::default()).unwrap();
    assert_eq!(module(&a.generate(&Options::default()).unwrap().code), module(&read.code));

    let graph = crate::expr::Graph::verbatim();
    let scene = crate::Analysis::written(&a, &graph, &[]).unwrap().scene();
    let shapes: Vec<_> = scene.shapes.iter().map(|shape| (shape.kind, shape.file.is_none())).collect();
    assert_eq!(shapes, [("box", true), ("cylinder", true), ("sphere", true)]);

    a.draw_sphere(&link, quantity(0.05, "kg"));
    let report = a.generate(&Options::default()).map(|_| ()).unwrap_err().render_in(&a.sources());
    assert!(report.contains("radius") && report.contains("builder/tests.rs"), "{report}");
}
