//! Pages of small mechanisms, and their numbers.

use std::collections::BTreeMap;

use crate::derive::{Equations, routes};
use crate::expr::normal::combination::Polynomial;
use crate::expr::{Binary, Expr, Function, Graph, Number, Symbol, Vector, evaluate};
use crate::model::Lagrangian;

use super::algebra::Algebra;
use super::layout::Entry;
use super::notation::Notation;
use super::page;
use super::reader::Reader;

fn output(lagrangian: &Lagrangian<'_>) -> String {
    let graph = Graph::new();
    page(lagrangian, &routes(lagrangian, &graph, Default::default()))
}

fn double_pendulum(graph: &Graph) -> Lagrangian<'_> {
    let mut l = Lagrangian::new(graph, "DoublePendulum");
    l.docs = vec!["Two point masses".to_string(), "on massless rods.".to_string()];
    let [a, b] = ["theta1", "theta_2"].map(|name| l.coordinate(name, "rad", None)[0]);
    // Lengths before masses: products do not depend on it.
    let [l1, l2] = ["l1", "l2"].map(|name| l.parameter(name, "m", Number::ONE));
    let [m1, m2] = ["m1", "m2"].map(|name| l.parameter(name, "kg", Number::ONE));
    let g = l.parameter("g", "m/s^2", Number::ONE);
    let upper = Vector([l1 * a.sin(), graph.integer(0), -l1 * a.cos()]);
    let lower = upper + Vector([l2 * b.sin(), graph.integer(0), -l2 * b.cos()]);
    for (mass, [x, _, z]) in [(m1, upper.0), (m2, lower.0)] {
        l.kinetic.push(mass * (x.rate().powi(2) + z.rate().powi(2)) / 2);
        l.potential.push(mass * g * z);
    }
    l
}

fn cart_pole(graph: &Graph) -> Lagrangian<'_> {
    let mut l = Lagrangian::new(graph, "CartPole");
    let [x, theta] = [("x", "m"), ("theta", "rad")].map(|(name, unit)| l.coordinate(name, unit, None)[0]);
    let [cart, bob] = ["M", "m_bob"].map(|name| l.parameter(name, "kg", Number::ONE));
    let length = l.parameter("length", "m", Number::ONE);
    let g = l.parameter("g", "m/s^2", Number::ONE);
    let b = l.parameter("b", "N*s/m", Number::ONE);
    let push = l.input("F", "N", None)[0];
    let [px, pz] = [x + length * theta.sin(), -length * theta.cos()];
    l.kinetic.push(cart * x.rate().powi(2) / 2 + bob * (px.rate().powi(2) + pz.rate().powi(2)) / 2);
    l.potential.push(bob * g * pz);
    l.dissipation.push(b * x.rate().powi(2) / 2);
    l.forces.push((0, push));
    l
}

fn spherical_pendulum(graph: &Graph) -> Lagrangian<'_> {
    let mut l = Lagrangian::new(graph, "SphericalPendulum");
    let [theta, phi] = ["theta", "phi"].map(|name| l.coordinate(name, "rad", None)[0]);
    let [m, length, g] =
        [("m", "kg"), ("l", "m"), ("g", "m/s^2")].map(|(name, unit)| l.parameter(name, unit, Number::ONE));
    let bob = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), -theta.cos()].map(|x| length * x);
    let [vx, vy, vz] = bob.map(|x| x.rate().powi(2));
    l.kinetic.push(m * (vx + vy + vz) / 2);
    l.potential.push(m * g * bob[2]);
    l
}

/// A particle with terms of every shape.
fn contrived(graph: &Graph) -> Lagrangian<'_> {
    let mut l = Lagrangian::new(graph, "Contrived");
    let [x, y] = ["x", "y_c"].map(|name| l.coordinate(name, "m", None)[0]);
    let [m, k, gamma] =
        [("m", "kg"), ("k", "N/m"), ("gamma", "rad")].map(|(n, unit)| l.parameter(n, unit, Number::ONE));
    let u = l.input("u", "N", None)[0];
    let (vx, vy) = (x.rate(), y.rate());
    let t = graph.symbol(Symbol::Time);
    let r = (x.powi(2) + y.powi(2)).sqrt();
    l.kinetic.push(m * (vx.powi(2) + vy.powi(2)) / 2 + m * (2 * (y - x)).sin().powi(2) * vx * vy / 8);
    l.potential.push(-m * k / r + k * (r - 1).powi(2) / 2 + k * (y - x).sqrt() / (y - x));
    l.potential.push(graph.constant(Number::PI) / 3 * gamma.sin() * x.cos() * y.cos() * (x - y).call(Function::Tan));
    l.potential.push(k * (y - x).call(Function::Tan).sqrt() + (x / (m + k)).call(Function::Atan) / gamma.sqrt());
    l.potential.push(x.call(Function::Abs).call2(Binary::Powf, gamma) + y.call2(Binary::Atan2, x));
    l.dissipation.push(m * vx.call(Function::Cosh).call(Function::Ln) + (m + k) * vy.powi(2) / 4);
    l.lagrangian.push(k * (x * vy - y * vx) * (-t).call(Function::Exp));
    l.forces.push((0, u * (x - y).cos().powi(3) - m * (y * 3).call(Function::Tanh)));
    l.forces.push((1, graph.constant(Number::rounded(6.67e-11, 0.0)) * u / (x - y).powi(3)));
    l
}

#[test]
fn the_double_pendulum_is_that_of_a_textbook() {
    let graph = Graph::verbatim();
    let text = output(&double_pendulum(&graph));
    let expected = r"
\paragraph{Energies.}
\begin{align*}
  T &= \frac{1}{2} (m_1 + m_2) l_1^2 \dot{\theta}_1^2 + \frac{1}{2} m_2 l_2^2 \dot{\theta}_2^2 + m_2 l_1 l_2 \dot{\theta}_1 \dot{\theta}_2 \cos(\theta_1 - \theta_2) \\
  V &= -(m_1 + m_2) g l_1 \cos\theta_1 - m_2 g l_2 \cos\theta_2
\end{align*}

\paragraph{Terms of $\displaystyle \mathbf{M} \ddot{\mathbf{q}} + \mathbf{C} \dot{\mathbf{q}} + \mathbf{G} = \mathbf{0}$.}
\begin{align*}
  \mathbf{M} &= \begin{bmatrix}
    (m_1 + m_2) l_1^2 & m_2 l_1 l_2 \cos(\theta_1 - \theta_2) \\
    m_2 l_1 l_2 \cos(\theta_1 - \theta_2) & m_2 l_2^2
  \end{bmatrix} \\
  \mathbf{C} &= \begin{bmatrix}
    0 & m_2 l_1 l_2 \dot{\theta}_2 \sin(\theta_1 - \theta_2) \\
    -m_2 l_1 l_2 \dot{\theta}_1 \sin(\theta_1 - \theta_2) & 0
  \end{bmatrix} \\
  \mathbf{G} &= \begin{bmatrix}
    (m_1 + m_2) g l_1 \sin\theta_1 \\
    m_2 g l_2 \sin\theta_2
  \end{bmatrix}
\end{align*}

\paragraph{Equations of motion.}
\begin{align*}
  & (m_1 + m_2) l_1^2 \ddot{\theta}_1 + m_2 l_1 l_2 \ddot{\theta}_2 \cos(\theta_1 - \theta_2) + m_2 l_1 l_2 \dot{\theta}_2^2 \sin(\theta_1 - \theta_2) \\
  & \quad {} + (m_1 + m_2) g l_1 \sin\theta_1 = 0 \\
  & m_2 l_1 l_2 \ddot{\theta}_1 \cos(\theta_1 - \theta_2) + m_2 l_2^2 \ddot{\theta}_2 - m_2 l_1 l_2 \dot{\theta}_1^2 \sin(\theta_1 - \theta_2) + m_2 g l_2 \sin\theta_2 = 0
\end{align*}
";
    assert!(text.contains(expected), "{text}");
    assert!(text.starts_with("\\documentclass{article}\n") && text.ends_with("\\end{document}\n"), "{text}");
    assert!(text.contains("\\section*{DoublePendulum}\nTwo point masses\non massless rods.\n"), "{text}");
}

#[test]
fn the_cart_pole_has_dissipation_and_an_input() {
    let graph = Graph::verbatim();
    let text = output(&cart_pole(&graph));
    for expected in [
        r"
  \mathbf{M} &= \begin{bmatrix}
    M + m_{\mathrm{bob}} & m_{\mathrm{bob}} \, \mathrm{length} \cos\theta \\
    m_{\mathrm{bob}} \, \mathrm{length} \cos\theta & m_{\mathrm{bob}} \, \mathrm{length}^2
  \end{bmatrix} \\
",
        r"
  \partial D / \partial \dot{\mathbf{q}} &= \begin{bmatrix}
    b \dot{x} \\
    0
  \end{bmatrix} \\
  \mathbf{Q} &= \begin{bmatrix}
    F \\
    0
  \end{bmatrix}
",
        r"
  (M + m_{\mathrm{bob}}) \ddot{x} + m_{\mathrm{bob}} \, \mathrm{length} \, \ddot{\theta} \cos\theta - m_{\mathrm{bob}} \, \mathrm{length} \, \dot{\theta}^2 \sin\theta + b \dot{x} &= F \\
  m_{\mathrm{bob}} \, \mathrm{length} \, \ddot{x} \cos\theta + m_{\mathrm{bob}} \, \mathrm{length}^2 \, \ddot{\theta} + m_{\mathrm{bob}} g \, \mathrm{length} \sin\theta &= 0
",
        r"\paragraph{Conserved where $F = 0$ and $D = 0$.}",
        r"  p_x &= (M + m_{\mathrm{bob}}) \dot{x} + m_{\mathrm{bob}} \, \mathrm{length} \, \dot{\theta} \cos\theta",
        r"  $b$ & parameter & $\mathrm{N\,s/m}$ & $1$ \\",
    ] {
        assert!(text.contains(expected), "{expected}\nis not in\n{text}");
    }
}

#[test]
fn the_spherical_pendulum_has_squares_of_sines() {
    let graph = Graph::verbatim();
    let text = output(&spherical_pendulum(&graph));
    for expected in [
        r"T &= \frac{1}{2} m l^2 (\dot{\theta}^2 + \dot{\phi}^2 \sin^2\theta)",
        r"
    m l^2 & 0 \\
    0 & m l^2 \sin^2\theta
",
        r"
    0 & -m l^2 \dot{\phi} \sin\theta \cos\theta \\
    m l^2 \dot{\phi} \sin\theta \cos\theta & m l^2 \dot{\theta} \sin\theta \cos\theta
",
        r"
  m l^2 \ddot{\theta} - m l^2 \dot{\phi}^2 \sin\theta \cos\theta + m g l \sin\theta &= 0 \\
  m l^2 \ddot{\phi} \sin^2\theta + 2 m l^2 \dot{\theta} \dot{\phi} \sin\theta \cos\theta &= 0
",
        r"p_{\phi} &= m l^2 \dot{\phi} \sin^2\theta",
    ] {
        assert!(text.contains(expected), "{expected}\nis not in\n{text}");
    }
}

#[test]
fn what_is_too_long_is_written_by_recursion() {
    let graph = Graph::verbatim();
    let mut l = Lagrangian::new(&graph, "Long");
    let x = l.coordinate("x", "m", None)[0];
    let k = l.parameter_array("k", "N/m", vec![Number::ONE; 50]);
    l.kinetic.push(x.rate().powi(2) / 2);
    (1..).zip(k).for_each(|(i, k)| l.potential.push(k * (i * x).cos()));
    let text = output(&l);
    for expected in [
        r"  & b_1 = k_{11} \cos(11 x), \quad b_2 = k_{12} \cos(12 x)",
        r"{} + b_{28} + b_{29} + b_{30} + b_{32}",
        r"\mathbf{G} &= G_1",
    ] {
        assert!(text.contains(expected), "{expected} is not in {text}");
    }
    // The equation of motion says nothing that the terms do not say.
    assert!(!text.contains("Equations of motion") && !text.contains("ldots"), "{text}");

    let mut endless = Lagrangian::new(&graph, "Endless");
    let x = endless.coordinate("x", "m", None)[0];
    let k = endless.parameter_array("k", "N/m", vec![Number::ONE; 8000]);
    endless.kinetic.push(x.rate().powi(2) / 2);
    (1..).zip(k).for_each(|(i, k)| endless.potential.push(k * (i * x).cos()));
    let text = output(&endless);
    let words = ["of the generated functions: $V$ (", "operations; \\texttt{potential\\_energy} computes it)"];
    assert!(words.iter().all(|word| text.contains(word)) && text.contains("V &= \\text{(see below)}"), "{text}");

    let mut chain = Lagrangian::new(&graph, "Chain");
    let q = chain.coordinate("q", "m", Some(6));
    q.iter().for_each(|q| chain.kinetic.push(q.rate().powi(2) / 2));
    let text = output(&chain);
    assert!(text.contains("1 & 0 & 0 & 0 & 0 & 0"), "{text}");
}

#[test]
fn nothing_recurses_on_the_depth_of_an_expression() {
    let graph = Graph::verbatim();
    let mut l = Lagrangian::new(&graph, "Deep");
    let x = l.coordinate("x", "m", None)[0];
    l.kinetic.push(x.rate().powi(2) / 2);
    let plain = Graph::new();
    let deep = (0..100_000).fold(plain.symbol(Symbol::Coordinate(0)), |deep, _| deep.sin());
    let mut algebra = algebra(&l, &plain);
    assert!(matches!(algebra.shortest(deep).map(|sum| algebra.entry(Some(sum))), None | Some(Entry::TooLong)));
}

#[test]
fn braces_and_brackets_are_balanced() {
    let graph = Graph::verbatim();
    for l in [double_pendulum(&graph), cart_pole(&graph), spherical_pendulum(&graph), contrived(&graph)] {
        let text = output(&l);
        for (open, close) in [("{", "}"), ("(", ")"), ("\\left", "\\right"), ("\\begin", "\\end")] {
            assert_eq!(text.matches(open).count(), text.matches(close).count(), "{open} in\n{text}");
        }
        assert!(!text.contains("+ -") && !text.contains("- -") && !text.contains("  +"), "{text}");
    }
}

/// Tension, Young's modulus, voltage and what else is called as something on the page.
#[test]
fn what_the_page_calls_its_own_has_no_other_meaning() {
    const SOURCE: &str = "\
mechanism Named {
    param m: kg = 1;
    param e: 1/m = 1;
    param E: J = 1;
    param T: N = 1;
    param V: J/rad = 1;
    param D: m = 1;
    param L: m = 1;
    param lambda_1: N = 1;
    coord x: m;
    coord theta: rad;
    kinetic += 1/2*m*dt(x)^2 + 1/2*m*L^2*dt(theta)^2;
    potential += E*exp(-e*x) + T*x + lambda_1*x + V*theta;
    constraint rope: x = D*theta;
}
";
    let verbatim = Graph::verbatim();
    let (lagrangian, _) =
        crate::declared(SOURCE, &verbatim, &[]).unwrap_or_else(|errors| panic!("{}", errors.render("", SOURCE)));
    let text = output(&lagrangian);
    for expected in [
        r"  T &= \frac{1}{2} m \dot{x}^2 + \frac{1}{2} m L^2 \dot{\theta}^2 \\",
        r"  V &= (\tilde{T} + \mathrm{lambda\_1}) x + \tilde{V} \theta + \tilde{E} e^{-\tilde{e} x}",
        r"\varphi_1 &= x - D \theta = 0",
        r"= \lambda_1",
        r"  E &= ",
    ] {
        assert!(text.contains(expected), "{expected} is not in {text}");
    }
}

/// Branches with all connectives, a prescribed motion, squares of sums, time, and constraints of both kinds.
const PIECEWISE: &str = "\
mechanism Piecewise {
    param m: kg = 1;
    param k: N/m = 5;
    param r: m = 1;
    param rest: m = 2;
    param speed: m/s = 0.1;
    param omega: rad/s = 2;
    coord x: m;
    coord y: m;
    coord theta: rad;
    prescribed lift: m;
    input f[2]: N;
    let length = rest - speed*t;
    kinetic += particle(m, [x + length*sin(theta), 0, y - length*cos(theta)]) + 1/2*m*r^2*(dt(theta) + dt(x)/r)^2;
    potential += if x < r && -r <= x { 1/2*k*(x - r)^2 } else { 0 } + 1/2*k*(x - y + lift)^2;
    potential += k*r*(if (x <= y || y < lift) && (r < x || theta < 1) { x*sin(theta) } else { y*cos(theta)^2 });
    force x += (f[0] + f[1])*sin(omega*t + theta) - (if dt(x) < dt(y) { f[0] } else { f[1] });
    constraint rolling: dt(x)*sin(theta) - r*dt(theta) = 0;
    constraint ground: y = lift + r*sin(omega*t);
}
";

/// A body turning about a fixed point, its attitude a unit quaternion.
const ROTOR: &str = "\
mechanism Rotor {
    param a: kg*m^2 = 0.3;
    param b: kg*m^2 = 0.4;
    param c: kg*m^2 = 0.5;
    coord e[4]: 1;
    input torque_in[3]: N*m;
    let body = quaternion(e[0], e[1], e[2], e[3]);
    kinetic += rigid_body(0, [0, 0, 0], inertia(a, b, c), body);
    torque on body += body*torque_in;
    constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;
}
";

/// Functions that are written without brackets, beside other factors.
const OPEN: &str = "\
mechanism Open {
    param m: kg = 1;
    param k: J = 2;
    param a: 1 = 3;
    param b: 1 = 3;
    param s: m = 1;
    coord x: m;
    coord y: m;
    kinetic += 1/2*m*(dt(x)^2 + dt(y)^2);
    potential += k*ln(a)*x/s + k*atan(x/s)*sin(y/s) + k*(x/s)^a*ln(a) + k*ln(a)*ln(b)*(x/s)^b;
    potential += k*signum(x)*y/s + k*asin(x/s)*acos(y/s)*x*y/s^2 + k*ln(x/s)*(x + y)/s + k*ln(x/s)^2*y/s;
    potential += k*exp(-y/s)*ln(b)/(x*ln(a))*s;
}
";

/// Doubled angles that hold powers of sums, and functions whose arguments are written with another sign.
const HALVES: &str = "\
mechanism Halves {
    param m: kg = 1;
    param k: J = 2;
    param s: m = 1;
    param l: m = 3;
    coord x: m;
    coord y: m;
    kinetic += 1/2*m*(dt(x)^2 + dt(y)^2);
    potential += k*(1 - cos(2*s/(l + x)));
    potential += k*(1 - cos(2*sqrt(1 + x^2/l^2))) + k*(1 + cos(2*l^2/(x^2 + y^2)));
    potential += k*x*sin(2*atan((y - x)/s))/s + k*(1 - cos(2*tanh((y - x)/s)))*y/s;
    potential += k*((x + l)^(-2)*s^2 + 2*y*(x + l)^(-1) + y^2/s^2);
}
";

#[test]
fn what_is_written_is_what_was_derived() {
    let verbatim = Graph::verbatim();
    for l in [double_pendulum(&verbatim), cart_pole(&verbatim), spherical_pendulum(&verbatim), contrived(&verbatim)] {
        check_values(&l);
    }
    for source in [PIECEWISE, ROTOR, HALVES, OPEN] {
        let verbatim = Graph::verbatim();
        let (lagrangian, _) =
            crate::declared(source, &verbatim, &[]).unwrap_or_else(|errors| panic!("{}", errors.render("", source)));
        check_values(&lagrangian);
    }
}

/// Everything on the page has the value that was derived; what is too long for it is left out here, too.
fn check_values(l: &Lagrangian<'_>) {
    let graph = Graph::new();
    let equations = &routes(l, &graph, Default::default())[0];
    let (lagrange, constraints) = (&equations.lagrange, &equations.constraints);
    let mut algebra = algebra(l, &graph);
    let forces = lagrange.generalized_force.iter().zip(constraints.force(l.dof(), &graph));
    let values = [
        lagrange.mass_matrix.concat(),
        lagrange.coriolis_matrix.concat(),
        [&lagrange.gravity, &lagrange.dissipation_force, &lagrange.generalized_force].map(Vec::clone).concat(),
        vec![lagrange.kinetic_energy, lagrange.potential_energy],
        lagrange.inverse_dynamics.clone(),
        constraints.value.clone(),
        constraints.jacobian.concat(),
        constraints.bias.clone(),
        forces.map(|(&force, reaction)| force + reaction).collect(),
    ];
    let mut compared = 0;
    for value in values.concat() {
        let sum = algebra.shortest(value);
        compared += usize::from(check_value(&mut algebra, l, equations, value, sum));
    }
    for (i, &value) in lagrange.inverse_dynamics.iter().enumerate() {
        let sum = algebra.left_side(equations, i);
        check_value(&mut algebra, l, equations, value, sum);
    }
    assert!(4 * compared >= 3 * values.concat().len(), "{}: only {compared} entries are written", l.name);
}

fn check_value<'g>(
    algebra: &mut Algebra<'g>,
    l: &Lagrangian<'_>,
    equations: &Equations<'g>,
    value: Expr<'g>,
    sum: Option<Polynomial>,
) -> bool {
    let Some(sum) = sum.map(|sum| algebra.with_squares(sum)) else { return false };
    let Some(text) = algebra.text(&sum) else { return false };
    let names: BTreeMap<String, f64> =
        symbols(l, equations).into_iter().map(|s| (algebra.notation.symbol(s), value_of(s))).collect();
    let expected: f64 = evaluate(&[value], value_of)[0];
    let read = Reader { rest: &text, values: &names }.sum();
    assert!((read - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{}: {text}: {read} {expected}", l.name);
    true
}

fn algebra<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Algebra<'g> {
    Algebra::new(graph, Notation::of(lagrangian))
}

pub(super) fn symbols(l: &Lagrangian<'_>, equations: &Equations<'_>) -> Vec<Symbol> {
    let s = &equations.symbols;
    let prescribed = (0..l.prescribed.iter().map(|p| p.count() as u32).sum())
        .flat_map(|i| [0, 1, 2].map(|order| Symbol::Prescribed(i, order)))
        .collect();
    let given = [prescribed, equations.constraints.multipliers.clone(), vec![Symbol::Time]].concat();
    [&s.q, &s.qd, &s.qdd, &s.u, &s.parameters, &given].map(Vec::clone).concat()
}

/// Coordinates grow, so that the roots in `contrived` exist.
fn value_of(symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Time => 0.37,
        Symbol::Coordinate(i) => 0.31 + 0.53 * f64::from(i),
        Symbol::Velocity(i) => 0.71 - 0.29 * f64::from(i),
        Symbol::Acceleration(i) => -0.43 + 0.97 * f64::from(i),
        Symbol::Parameter(i) => 0.83 + 0.19 * f64::from(i),
        Symbol::Input(i) => 0.61 + 0.11 * f64::from(i),
        Symbol::Prescribed(i, order) => 0.47 + 0.23 * f64::from(i) - 0.31 * f64::from(order),
        Symbol::Multiplier(i) => 1.7 - 0.9 * f64::from(i),
    }
}
