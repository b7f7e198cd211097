//! Declarations on which a careless proof would cry wolf: exact zeros that come out as rounding, bad scales,
//! saturation, corners; and one-sided forces, which conserve nothing that they only seem to.

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::FunctionKind;
use mbs_derive::source::Sources;
use mbs_derive::verify::{self, Proof};
use mbs_derive::{Analysis, declared, derived};

/// Derives and proves; the names of what is conserved.
fn proved(source: &str) -> Vec<String> {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", source)));
    let derivation = derived(&lagrangian);
    let proof = Proof::of(&lagrangian, &derivation).unwrap_or_else(|e| panic!("{source}\n{e}"));
    assert!(proof.states >= verify::STATES);
    derivation.conserved.clone()
}

fn dimensionless(body: &str) -> Vec<String> {
    proved(&format!("#![dimensionless] mechanism Case {{ {body} }}"))
}

#[test]
fn exact_zeros_may_come_out_as_rounding() {
    dimensionless(
        "param m: 1 = 3; param l: 1 = 0.5; param w: 1 = 3; coord x: 1; \
         let p = [l*sin(x)*cos(w*t), l*sin(x)*sin(w*t), -l*cos(x)]; \
         kinetic += particle(m, p); potential += m*9.81*p.z; output v = dt(p);",
    );
    dimensionless("param m: 1 = 3; coord a: 1; kinetic += 1/2*m*dt(a)^2; potential += 1.1*m*a^2 + m*cos(a);");
    dimensionless("coord a: 1; kinetic += dt(a)^2; output w = angular_velocity(rotation([1,2,-1], 3*t)*rot_z(a));");
    dimensionless("coord x: 1; kinetic += dt(x)^2; potential += sin(x)^2 + cos(x)^2 + (x+1/3)^2 - x^2 - 2/3*x;");
}

/// Charge over Boltzmann's constant: 10²⁵ has more than 64 bits, and the quotient has fewer.
#[test]
fn constants_of_many_digits_may_stand_in_angles_and_exponents() {
    for angle in ["x*1.6e-19/1.38e-23", "x*1e18/1e20", "x*1e-30*1e15", "x/1e-10/1e20", "x/1e15", "x*1.6e-19"] {
        dimensionless(&format!("coord x: 1; kinetic += dt(x)^2; potential += exp({angle}) + sin({angle} + x);"));
    }
}

/// Half a radian and thirty degrees: no fraction holds their sum, which as an angle is the one and then the other.
#[test]
fn angles_may_be_a_number_and_a_part_of_a_half_turn() {
    let angles = [
        "x + 0.5 + pi/6",
        "x - (0.1 + pi/2)",
        "2*(x + 0.5 - 30*deg)/3",
        "x + 0.5 + pi/6 - 0.5",
        "1.5 - pi/3",
        "abs(1 - pi)",
        "x*(1 + pi)",
        "sqrt(2) + pi + x",
    ];
    for angle in angles {
        for function in ["sin", "tan", "exp", "tanh"] {
            dimensionless(&format!(
                "coord x: 1; let r = rot_z({angle})*rot_x(x + ({angle})); kinetic += particle(2, r.point([1, 2, 3])); \
                 kinetic += dt(x)^2; potential += {function}({angle})*x; output o = {function}({angle}) + ({angle});"
            ));
        }
    }
}

/// Products of constants that are nearer to 0 than any double stay products.
#[test]
fn products_of_constants_may_be_nearer_to_zero_than_doubles() {
    dimensionless("param k: 1 = 2; coord x: 1; kinetic += dt(x)^2; potential += 1e-200*(1e-200*k*x^2);");
    let squared = "1/2*(dt(x)*1e-170 + 1e-170*dt(y))^2";
    dimensionless(&format!("coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2 + {squared};"));
}

/// A force on one end reaches the other as the 99th power of a weak coupling, 1e-396. All other accelerations are those
/// of Thomas' algorithm.
#[test]
fn a_long_row_of_masses_may_be_coupled_weakly() {
    const N: usize = 100;
    let row = format!(
        "#![dimensionless] mechanism Row {{ coord x[{N}]: 1; input f: 1; for i in 0..{N} {{ kinetic += 1/2*dt(x[i])^2; }} \
         for i in 0..{} {{ kinetic += 1e-4*dt(x[i])*dt(x[i + 1]); }} force x[0] += f; }}",
        N - 1
    );
    let graph = Graph::verbatim();
    let analysis =
        Analysis::of(&Sources::new("row.mbs", &row), &graph).unwrap_or_else(|e| panic!("{}", e.render("", &row)));
    let programs = analysis.programs();
    let state = State { q: vec![0.0; N], qd: vec![0.0; N], qdd: vec![0.0; N], u: vec![3.0], ..State::default() };
    let found = Interpreter::<f64>::new(programs).call(FunctionKind::ForwardDynamics, &state).expect("it is generated");
    let (mut pivots, mut forces) = (vec![1.0; N], vec![3.0; N]);
    for i in 1..N {
        let factor = 1e-4 / pivots[i - 1];
        pivots[i] -= factor * 1e-4;
        forces[i] = -factor * forces[i - 1];
    }
    let mut expected = 0.0;
    for i in (0..N).rev() {
        expected = (forces[i] - 1e-4 * expected) / pivots[i];
        let error: f64 = found[i] - expected;
        assert!(error.abs() <= 1e-13 * f64::abs(expected) + 1e-300, "{i}: {}, not {expected}", found[i]);
    }
    assert!(found[0] != 0.0 && found[70] != 0.0);
}

/// Tilts of 20° and 30° have irrational sines: what cancels among their products is nothing but rounding.
#[test]
fn constants_cancel_as_exact_ones_do() {
    let chain = |tilts: [f64; 3]| {
        let link = |i: usize| {
            format!(
                "p = p * dh(q[{i}] + 45*deg, 0, 0.4*m, {:?}*deg); \
                 kinetic += rigid_body(1.5*kg, [-0.2*m, 0, 0], 0.05*kg*m^2*diag(1, 1, 1), p); \
                 potential += 1.5*kg*9.81*m/s^2*p.point([-0.2*m, 0, 0]).z; ",
                tilts[i]
            )
        };
        proved(&format!(
            "mechanism Chain {{ const kg: kg = 1; const m: m = 1; const s: s = 1; coord rail: m; coord q[3]: rad; \
             kinetic += 1/2*kg*dt(rail)^2; \
             let mut p = translation([rail*cos(30*deg), 0, rail*sin(30*deg)]) * rot_z(1) * rot_x(0.3); \
             {}{}{} output w = angular_velocity(p); }}",
            link(0),
            link(1),
            link(2)
        ));
    };
    let tilts = [-60.0, 20.0, 30.0, 45.0, 90.0];
    (0..25).for_each(|i| chain([tilts[i % 5], tilts[i / 5], tilts[(i + i / 5) % 5]]));
}

#[test]
fn bad_scales_and_saturation_are_no_disagreement() {
    dimensionless(
        "param m: 1 = 1e12; param n: 1 = 1e-12; coord x: 1; coord y: 1; \
         kinetic += m*dt(x)^2 + n*dt(y)^2 + n*dt(x)*dt(y)/2; potential += m*cos(x)*n*cos(y) + m*x^2;",
    );
    dimensionless("coord x: 1; kinetic += dt(x)^2; potential += ln(cosh(20*x));");
    dimensionless("coord x: 1; kinetic += dt(x)^2; potential += tanh(10*x);");
    dimensionless(
        "coord x: 1; kinetic += dt(x)^2; let mut a = x; for i in 0..12 { a = sin(a)*a + a; } potential += a;",
    );
    dimensionless("coord x: 1; kinetic += dt(x)^2; let mut a = x; for i in 0..60 { a = a*a; } potential += a;");
}

#[test]
fn one_sided_springs_conserve_energy_and_no_momentum() {
    let conserved = dimensionless("param k: 1 = 2; coord x: 1; kinetic += dt(x)^2; potential += 1/8*k*(abs(x) - x)^2;");
    assert_eq!(conserved, ["energy_integral"]);
}

#[test]
fn deriving_and_checking_take_work_in_proportion() {
    let terms = |n: usize| {
        format!("coord x: 1; kinetic += dt(x)^2; for i in 0..{n} {{ kinetic += i*dt(x)^2; potential += x^2*i; }}")
    };
    let nodes = [1000, 2000].map(|n| {
        let text = format!("#![dimensionless] mechanism Case {{ {} }}", terms(n));
        let (sources, graph) = (Sources::new("case.mbs", &text), Graph::verbatim());
        Analysis::of(&sources, &graph).unwrap_or_else(|e| panic!("{}", e.render_in(&sources))).nodes()
    });
    assert!(10 * nodes[1] <= 21 * nodes[0], "{nodes:?}");
    // What is proved has more terms than a proof in another proportion would end with.
    dimensionless(&terms(4000));
}

/// Polar coordinates lose the azimuth at the pole: reported, not refused. A negative inertia is refused as a mistake.
#[test]
fn singular_states_are_counted() {
    let count = |body: &str| {
        let source = format!("#![dimensionless] mechanism Case {{ {body} }}");
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            declared(&source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", &source)));
        Proof::of(&lagrangian, &derived(&lagrangian)).map(|proof| proof.singular)
    };
    assert_eq!(count("coord r: 1; kinetic += dt(r)^2;"), Ok(0));
    let polar = count("coord r: 1; coord a: 1; kinetic += dt(r)^2 + r^2*dt(a)^2;").expect("regular but at the pole");
    assert!(polar >= 2, "all zero and at the origin");
    let negative = count("coord x: 1; coord y: 1; kinetic += dt(x)^2 + (x^2 - 1/10000)*dt(y)^2;");
    assert!(matches!(negative, Err(verify::Failure::NegativeInertia { .. })), "{negative:?}");
}

/// A pendulum in Cartesian coordinates, a skate, and a quaternion body, whose mass matrix is singular by itself.
#[test]
fn constrained_mechanisms_are_proved_on_and_off_their_constraints() {
    dimensionless(
        "coord x: 1; coord z: 1; kinetic += 1/2*(dt(x)^2 + dt(z)^2); potential += 9.81*z; constraint rod: x^2 + z^2 = 1;",
    );
    dimensionless(
        "coord x: 1; coord y: 1; coord a: 1; kinetic += 1/2*(dt(x)^2 + dt(y)^2) + 0.2*dt(a)^2; \
         constraint blade: -sin(a)*dt(x) + cos(a)*dt(y) - 0.3*dt(a) = 0;",
    );
    let conserved = dimensionless(
        "coord e[4]: 1; let body = quaternion(e[0], e[1], e[2], e[3]); let w = angular_velocity(body); \
         kinetic += 1/2*(w.dot(body*[1,0,0])^2 + 2*w.dot(body*[0,1,0])^2 + 2.5*w.dot(body*[0,0,1])^2); \
         constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;",
    );
    assert_eq!(conserved, ["energy_integral"]);
}

/// A comparison with NaN is false, and `1^NaN` is 1: where the declared energies hide so that they are undefined,
/// derived code that has `x/x = 1` may well have another value. So it may where the sign of a zero decides.
#[test]
fn states_at_which_something_undefined_is_hidden_prove_nothing() {
    let plane = "coord x: 1; coord y: 1; kinetic += (dt(x)^2 + dt(y)^2)/2;";
    for body in [
        "potential += min(tan(x/x), exp(x) + cosh(y));",
        "potential += max(cosh(x) - [0.7, x, 0].norm(), tanh(y/y));",
        "potential += clamp(y/y, x, x + 1);",
        "potential += if !(x/x < 2) { x^2 } else { y^2 };",
        "force x += tan(min((y^(5/2))^4, sqrt(sqrt(dt(x)))));",
        "force x += exp(tanh(y))^(atan2(-x + signum(y), clamp(abs(y), 0.7/y, dt(x) - x)));",
        "output o = min(tan(x/x), exp(x));",
    ] {
        dimensionless(&format!("{plane} {body}"));
    }
}

/// Hilbert's matrix of twelve rows is positive definite, though its last pivot is 1e-15 of its first.
#[test]
fn a_mass_matrix_of_bad_condition_is_not_singular() {
    let source = "#![dimensionless] mechanism Hilbert { coord x[12]: 1; \
                  for i in 0..12 { for j in 0..12 { kinetic += 1/2*dt(x[i])*dt(x[j])/(i + j + 1); } } }";
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", source)));
    let proof = Proof::of(&lagrangian, &derived(&lagrangian)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(proof.singular, 0);
}

/// A four-bar linkage in space whose hinges are declared in full: 10 rows on 8 coordinates, of rank 7 where it is
/// closed.
#[test]
fn a_closed_loop_may_have_more_rows_than_coordinates() {
    let conserved = proved(
        "mechanism Loop {
            param l[3]: m = [0.2, 0.5, 0.4]; param m: kg = 1; param ground: m = 0.5; param g: m/s^2 = 9.81;
            coord q: rad; coord r: rad; coord p[3]: m; coord e[3]: rad;
            let crank = rot_z(q);
            let coupler = translation(p) * rot_z(e[0]) * rot_y(e[1]) * rot_x(e[2]);
            let rocker = translation([ground, 0, 0]) * rot_z(r);
            kinetic += rigid_body(m, [l[0]/2, 0, 0], diag(1, 1, 1)*m*l[0]^2/12, crank);
            potential += m*g*crank.point([l[0]/2, 0, 0]).y;
            kinetic += rigid_body(m, [l[1]/2, 0, 0], diag(1, 1, 1)*m*l[1]^2/12, coupler);
            potential += m*g*coupler.point([l[1]/2, 0, 0]).y;
            kinetic += rigid_body(m, [l[2]/2, 0, 0], diag(1, 1, 1)*m*l[2]^2/12, rocker);
            potential += m*g*rocker.point([l[2]/2, 0, 0]).y;
            constraint a: crank.point([l[0], 0, 0]) = coupler.origin();
            constraint a_axis: (crank*[0, 0, 1]).cross(coupler*[0, 0, 1]) = 0;
            constraint b: rocker.point([l[2], 0, 0]) = coupler.point([l[1], 0, 0]);
            constraint b_axis: (rocker*[0, 0, 1]).cross(coupler*[0, 0, 1]) = 0;
        }",
    );
    assert_eq!(conserved, ["energy_integral"]);
}

/// What is quadratic in the velocities, in spellings in which this is seen only after something has cancelled.
#[test]
fn kinetic_energies_may_be_quadratic_in_disguise() {
    for energy in [
        "1/2*sqrt(dt(x)^2 + dt(y)^2)^2",
        "1/2*(dt(x)^2 + dt(y)^2)*(sin(dt(x))^2 + cos(dt(x))^2)",
        "1/2*abs(dt(x))^2 + 1/2*dt(y)*dt(y)",
        "(dt(x) + dt(y))^3/24 - (dt(x) + dt(y))*(dt(x)^2 + dt(y)^2 + 2*dt(x)*dt(y))/24 + (dt(x)^2 + dt(y)^2)/2",
        "if x > 100 { dt(x)^2 + dt(y)^2 } else { (dt(x)^2 + dt(y)^2)/2 }",
    ] {
        dimensionless(&format!("coord x: 1; coord y: 1; kinetic += {energy};"));
    }
}

/// `p/p` is 1 by rule and `p*(1/p)` as written, which rounding makes less than that: no branch may hang on it.
#[test]
fn what_is_equal_for_all_values_is_no_matter_of_rounding() {
    let slopes = "coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2; param p: 1 = 0.7; param r: 1 = 3;";
    dimensionless(&format!("{slopes} potential += if p/p < 1 && sin(x) >= -1 {{ p*x }} else {{ x^2 }};"));
    dimensionless(&format!("{slopes} dissipation += p*dt(if r/r < 1 {{ x }} else {{ 2*y }})^2;"));
    dimensionless(&format!("{slopes} force y += if sin(r*x)^2 + cos(r*x)^2 <= 1 {{ 1 }} else {{ dt(x) }};"));
}

/// Comparisons that rounding decides, though what is compared differs: no side is the wrong one.
#[test]
fn what_rounding_decides_is_no_disagreement() {
    let plane = "coord x: 1; coord y: 1; param m: 1 = 1e9; kinetic += dt(x)^2 + dt(y)^2;";
    for body in [
        "potential += if (x + 1e12) - 1e12 < y { x^2 } else { y^3 };",
        "potential += if (1e9 + x) - 1e9 > 1.0001*x { x^2*y } else { y^3 };",
        "potential += if 1e12*(sin(x)^2 + cos(x)^2 - 1) > 1e-7 { x^2*y } else { y^3 };",
        "potential += signum(m*(sin(x)^2 + cos(x)^2 - 1))*y^2 + abs(y)^3;",
        "potential += signum((x + 0.1) - x - 0.1)*y + abs(x)^3;",
        "dissipation += abs(dt(m))^3 + abs(dt(x) - dt(x + 0.1));",
        "force x += abs(m*(dt(x) + 0.1) - m*dt(x) - m/10)*y + signum(dt(y));",
        "potential += if 1e16 + 1 - 1e16 < 0.5 { x^2 } else { x^3 };",
        "potential += 1e3*(x^2 + y^2) + 1e-12*(if m*(sin(x)^2 + cos(x)^2 - 1) > 1e-9 { x } else { y });",
        "potential += 1e3*(x^2 + y^2) + 1e-12*(if m*(x/3.7*3.7 - x) > 1e-8*y { y } else { x });",
        "potential += if 0.1 + 0.2 <= 0.3 { x^2 } else { x^3 };",
    ] {
        dimensionless(&format!("{plane} {body}"));
    }
}

/// `x^n` of a parameter n that is an integer has a value and derivatives where x is negative, and a sign.
#[test]
fn powers_of_negative_numbers_are_proved() {
    let line = "param n: 1 = 2; param k: 1 = 3; coord x: 1; kinetic += dt(x)^2/2;";
    for body in [
        "potential += (-1 - x^2)^n;",
        "potential += (-1 - x^2)^(2*n + 1) + x^n;",
        "kinetic += (-1 - x^2)^n*dt(x)^2/2;",
        "potential += abs(x^k);",
        "potential += sqrt((x^k)^2 + 1) + sqrt((x^k)^2);",
    ] {
        assert_eq!(dimensionless(&format!("{line} {body}")), ["energy_integral"], "{body}");
    }
    let source = format!("#![dimensionless] mechanism Cubic {{ {line} potential += abs(x^k); }}");
    let graph = Graph::verbatim();
    let (lagrangian, _) =
        declared(&source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", &source)));
    let derivation = derived(&lagrangian);
    let state = State { q: vec![-0.5], qd: vec![0.0], qdd: vec![0.0], ..State::default() };
    let call = |kind| Interpreter::new(&derivation).call(kind, &state).expect("generated");
    let found = [FunctionKind::PotentialEnergy, FunctionKind::ForwardDynamics].map(call);
    assert_eq!(found, [[0.125], [0.75]]);
}

/// Slopes at zero that duals take for 0 · ∞.
#[test]
fn powers_that_are_not_whole_have_rates_at_zero() {
    let line = "coord x: 1; coord y: 1; param k: 1 = 2; kinetic += dt(x)^2 + dt(y)^2;";
    for body in [
        "potential += if x > 0 { x^1.5 } else { 0 };",
        "potential += k*(if x > 0 { x^1.5 } else { -(-x)^1.5 });",
        "potential += k*abs(x)^1.5 + abs(y)^2.5;",
        "potential += max(x, 0)^1.5;",
        "lagrangian += abs(x)^1.5*dt(y);",
    ] {
        assert!(dimensionless(&format!("{line} {body}")).contains(&"energy_integral".to_string()), "{body}");
    }
}
