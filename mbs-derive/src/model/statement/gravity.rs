//! `gravity [0, 0, -g];`: the weight of every body that was declared as one.
//!
//! A body of mass m with its mass centre at r has the potential energy `−m g·r`. It is added when all statements have
//! been gone through, so that the statement may stand anywhere; it is written as a hand would write it, `m*g*r.z`, and
//! found again by what finds that.

use std::collections::BTreeMap;

use crate::diagnostic::Code;
use crate::expr::{Expr, Graph, Id, Node, Symbol, Vector, carry_out, evaluate};
use crate::model::check::Place;
use crate::model::check::sample::default_parameters;
use crate::model::check::singular::along_the_motion;
use crate::model::lagrangian::{Body, Draft};
use crate::model::landmark;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Resolved, Resolver};
use crate::model::value::{Free, Point, Shape};
use crate::numeric::Random;
use crate::parse::syntax::{Expression, Span};

/// The field, and what weighs in it.
#[derive(Debug, Default)]
pub(in crate::model) struct Weights<'g> {
    /// The acceleration in world axes, and where it is declared.
    field: Option<(Vector<'g>, Span)>,
    /// The energies of `particle` and `rigid_body`, a node for each call, with the bodies that they are of.
    pub(in crate::model) bodies: BTreeMap<Id, Body<'g>>,
    /// The potential energies that gravity has added: the last of V.
    added: usize,
}

impl<'g> Resolver<'_, 'g> {
    /// `gravity vector;`
    pub(in crate::model) fn gravity(&mut self, acceleration: &Expression, statement: &Span) -> Resolved<()> {
        let value = self.argument(acceleration)?;
        if let Some((_, first)) = self.found.weights.field.clone() {
            let help = "it acts on all bodies: add the vectors".to_string();
            return Err(self.refuse_twice(statement, "gravity is declared already".to_string(), help, first));
        }
        if value.value.shape() == Shape::Number {
            let help = "write `gravity [0, 0, -g];` where z points up";
            return Err(self.refuse(Code::GravityShape, &value.span, "gravity is a vector, this is a number", help));
        }
        let vector = self.vector(&value)?;
        self.check_dimension(vector.fit(), "gravity", Dimension::ACCELERATION, &value.span)?;
        let field = self.in_world(Free { ..vector });
        self.check_constant_field(field, &value.span)?;
        self.found.weights.field = Some((field, statement.clone()));
        Ok(())
    }

    fn check_constant_field(&mut self, field: Vector<'g>, span: &Span) -> Resolved<()> {
        let all = field.0.iter().map(|&e| self.known.facts.dependence(e)).fold(Dependence::default(), Dependence::or);
        let message = match all {
            all if all.on(Dependence::COORDINATE.or(Dependence::VELOCITY)) => "gravity does not depend on coordinates",
            all if all.moves() || all.on(Dependence::RATE) => "gravity does not change in time",
            _ => return Ok(()),
        };
        let help = "its vector is made of constants and parameters; for any other field write the potential energies: \
                    `potential += -m*a.dot(r);`";
        Err(self.refuse(Code::GravityThatChanges, span, message, help))
    }

    /// Adds the potential energies of all bodies; the last that is done with the statements.
    pub(in crate::model) fn weigh(&mut self) {
        let Some((field, statement)) = self.found.weights.field.clone() else { return };
        self.check_bodies_are_terms();
        for body in self.declared_bodies() {
            if let Some(potential) = self.weight(&body, field) {
                self.lagrangian.potential.push(potential);
                self.found.places.potential.push(Place { span: statement.clone(), calls: Vec::new() });
                self.found.weights.added += 1;
            }
        }
    }

    /// `−m g·r`
    fn weight(&mut self, body: &Body<'g>, field: Vector<'g>) -> Option<Expr<'g>> {
        let centre = Point { coordinates: body.com, frame: body.frame };
        let mut sum: Option<Expr<'g>> = None;
        for (axis, &g) in field.0.iter().enumerate().filter(|(_, g)| !g.is_zero()) {
            let place = self.world_component(centre, axis);
            let term = match g.node() {
                Node::Neg(down) => body.mass * self.graph.expr(down) * place,
                _ => -(body.mass * g * place),
            };
            sum = Some(sum.map_or(term, |sum| sum + term));
        }
        sum
    }

    /// The bodies among the terms of T that were declared as bodies, in their order.
    fn declared_bodies(&self) -> Vec<Body<'g>> {
        let declared = &self.found.weights.bodies;
        let terms = self.lagrangian.kinetic.iter().flat_map(|&e| landmark::terms(e, |id| declared.contains_key(&id)));
        let body = |(factor, term): (Expr<'g>, Expr<'g>)| {
            let body = declared.get(&term.id())?;
            Some(Body { mass: if factor.is_one() { body.mass } else { factor * body.mass }, ..*body })
        };
        terms.filter_map(body).collect()
    }

    /// A body that is chosen, or multiplied by what changes, has no weight that follows from its kinetic energy.
    fn check_bodies_are_terms(&mut self) {
        let declared = &self.found.weights.bodies;
        let known = |id: Id| declared.contains_key(&id);
        let hides_body = |e: Expr<'g>, of_lagrangian: bool| {
            let rest = landmark::terms(e, known).into_iter().filter(|(_, term)| of_lagrangian || !known(term.id()));
            let rest: Vec<Id> = rest.map(|(_, term)| term.id()).collect();
            self.graph.reachable(rest).into_iter().any(known)
        };
        let kinetic =
            self.lagrangian.kinetic.iter().zip(&self.found.places.kinetic).map(|(e, place)| (e, place, false));
        let others =
            self.lagrangian.lagrangian.iter().zip(&self.found.places.lagrangian).map(|(e, place)| (e, place, true));
        let found = kinetic.chain(others).filter(|(e, _, of_lagrangian)| hides_body(**e, *of_lagrangian));
        let found: Vec<Place> = found.map(|(_, place, _)| place.clone()).collect();
        for place in found {
            let help = "gravity acts on each `particle` and `rigid_body` that is a term of `kinetic +=`, with a factor that \
                        is constant in time; without the `gravity` statement, write the potential energies";
            self.report.refuse_at(
                Code::GravityOfHiddenBody,
                &place,
                "gravity does not find the body in this energy",
                help,
            );
        }
    }
}

// ---- gravity declared twice

/// States at which potential energies are compared.
const STATES: usize = 6;

/// Potentials are compared term by term up to this many.
const MOST_TERMS: usize = 2000;

impl<'g> Resolver<'_, 'g> {
    /// A potential energy that is the weight of a body, or of all of them, up to a constant.
    pub(in crate::model) fn warn_of_double_gravity(&mut self) {
        let Some((_, statement)) = self.found.weights.field.clone() else { return };
        let (written, weights) =
            self.lagrangian.potential.split_at(self.lagrangian.potential.len() - self.found.weights.added);
        if weights.is_empty() && self.declared_bodies().is_empty() {
            let warning = self.report.errors.warning(Code::GravityOnNothing, statement, "gravity acts on nothing");
            warning.help("it acts on every `particle` and `rigid_body` in `kinetic +=`, and there is none");
            return;
        }
        let doubles = doubles(&self.lagrangian, written, weights);
        for term in doubles {
            let message = "this is gravity once more: the `gravity` statement adds the weight of every body";
            let place = self.found.places.potential[term].clone();
            let warning = self.report.warn_at(Code::GravityTwice, &place, message);
            warning.help("leave one of them out").note(statement.clone(), "gravity is declared here");
        }
    }
}

/// The numbers of the terms of V, as written, that hold a weight.
fn doubles<'g>(lagrangian: &Draft<'g>, written: &[Expr<'g>], weights: &[Expr<'g>]) -> Vec<usize> {
    let mut parts: Vec<(usize, Expr<'g>)> = Vec::new();
    for (number, &term) in written.iter().enumerate() {
        parts.push((number, term));
        let terms = landmark::terms(term, |_| false);
        let several = terms.len() > 1 && parts.len() + terms.len() <= MOST_TERMS;
        parts.extend(terms.into_iter().filter(|_| several).map(|(factor, rest)| (number, factor * rest)));
    }
    let all = weights.iter().copied().reduce(|a, b| a + b);
    let wanted: Vec<Expr<'g>> = weights.iter().copied().chain(all).collect();
    let exprs: Vec<Expr<'g>> = parts.iter().map(|(_, e)| *e).chain(wanted).collect();
    let changes = changes(lagrangian, &exprs);
    let (parts_changes, weights_changes) = changes.split_at(parts.len());
    let is_weight = |part: &[f64]| weights_changes.iter().any(|weight| are_equal(part, weight));
    let mut found: Vec<usize> =
        parts.iter().zip(parts_changes).filter(|(_, change)| is_weight(change)).map(|((n, _), _)| *n).collect();
    found.dedup();
    found
}

/// How much each expression changes from a state to the next, at the default parameters.
fn changes(lagrangian: &Draft<'_>, exprs: &[Expr<'_>]) -> Vec<Vec<f64>> {
    let graph = Graph::new();
    let exprs = carry_out(exprs, &graph, |symbol| along_the_motion(&graph, symbol));
    let (mut random, parameters) = (Random::new(0x6772_6176), default_parameters(lagrangian));
    let mut at = |_| {
        let state = random.state(lagrangian);
        evaluate(&exprs, |symbol| match symbol {
            Symbol::Time => state.t,
            Symbol::Coordinate(i) => state.q[i as usize],
            Symbol::Velocity(i) => state.qd[i as usize],
            Symbol::Parameter(i) => parameters[i as usize],
            Symbol::Prescribed(i, order @ 0..=2) => state.prescribed[i as usize][usize::from(order)],
            Symbol::Prescribed(..) | Symbol::Acceleration(_) | Symbol::Input(_) | Symbol::Multiplier(_) => f64::NAN,
        })
    };
    let values: Vec<Vec<f64>> = (0..STATES).map(&mut at).collect();
    (0..exprs.len()).map(|i| values.windows(2).map(|two| two[1][i] - two[0][i]).collect()).collect()
}

/// Equal but for rounding, and not all zero.
fn are_equal(a: &[f64], b: &[f64]) -> bool {
    let size = a.iter().chain(b).fold(0.0, |size: f64, x| size.max(x.abs()));
    size > 0.0 && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * size)
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, messages, refused};

    /// Both ways to declare it have the same Programs, by the same route, and no warning.
    fn same(declarations: &str, kinetic: &str, gravity: &str, potential: &str) {
        let text = |gravity: &str| format!("mechanism A {{ {declarations} {kinetic} {gravity} }}");
        let code = |text: &str| {
            let generated = crate::generate("a", text, &Default::default());
            let generated = generated.unwrap_or_else(|e| panic!("{}", e.render("a", text)));
            assert_eq!(generated.warnings, "", "{text}");
            generated.code
        };
        let before = format!("mechanism A {{ {declarations} {gravity} {kinetic} }}");
        let (by_field, by_hand) = (code(&text(gravity)), code(&text(potential)));
        let differs = by_field.lines().zip(by_hand.lines()).find(|(a, b)| a != b);
        assert_eq!(differs, None, "{gravity} and {potential}");
        assert!(by_field == code(&before), "the statement may stand before the bodies");
    }

    const ARM: &str = "param m[3]: kg = [3, 2, 1]; param l: m = 0.4; param g: m/s^2 = 9.81; coord q[3]: rad; \
                       let a = rot_z(q[0]); let b = a*translation([0, 0, l])*rot_y(q[1]); \
                       let c = b*translation([l, 0, 0])*rot_y(q[2]);";

    const BODIES: &str = "kinetic += rigid_body(m[0], [0, 0, l/2], diag(1, 1, 1)*m[0]*l^2, a); \
                          kinetic += rigid_body(m[1], [l/2, 0, 0], diag(1, 1, 1)*m[1]*l^2, b) + \
                          particle(m[2], c.point([l/3, 0, 0]));";

    #[test]
    fn a_field_is_the_potential_that_a_hand_writes() {
        same(
            ARM,
            BODIES,
            "gravity [0, 0, -g];",
            "potential += m[0]*g*a.point([0, 0, l/2]).z; potential += m[1]*g*b.point([l/2, 0, 0]).z; \
             potential += m[2]*g*c.point([l/3, 0, 0]).z;",
        );
        same(
            "param m: kg = 1; param l: m = 0.5; param g: m/s^2 = 9.81; coord x: m; coord theta: rad; \
             let bob = [x + l*sin(theta), 0, -l*cos(theta)];",
            "kinetic += particle(m, bob) + m*dt(x)^2;",
            "gravity [0, 0, -g];",
            "potential += m*g*world.point(bob).z;",
        );
    }

    /// The energy of every body counts, and nothing else.
    #[test]
    fn every_declared_body_weighs() {
        let weight = |statements: &str, expected: f64| {
            let fields = "param g: m/s^2 = 10; let down = rot_x(pi/2)*[0, g, 0];";
            mechanism(&format!("{fields} {statements} let nothing = down;"), |lagrangian| {
                let found: f64 = crate::model::check::trial::values(&lagrangian.potential[1..]).iter().sum();
                // The third parameter of the trial is k; g is behind it.
                assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{statements}: {found}");
            });
        };
        // At z = 1.1, x = 0.3, y = -0.7 of the trial state, with m = 2.
        weight("const c: m/s^2 = 10; gravity [0, 0, -c]; kinetic += particle(m, [x, y, z]);", 22.0);
        weight(
            "const c: m/s^2 = 10; kinetic += 2*particle(m, [x, y, z]) + particle(m, [0, 0, z]); gravity [0, -2*c, -c];",
            66.0 + 40.0 * -1.4,
        );
        weight("const c: m/s^2 = 10; gravity rot_x(pi/2)*[0, -c, 0]; kinetic += particle(m, [x, y, z]);", 22.0);
        weight(
            "const c: m/s^2 = 10; gravity [0, 0, -c]; kinetic += 1/2*m*dt(z)^2; kinetic += particle(m, [0, z, x]);",
            6.0,
        );
        weight(
            "const c: m/s^2 = 10; gravity [0, 0, -c]; for i in 0..3 { kinetic += particle(m, [x, i*l, z]); } \
             let unused = particle(m, [0, 0, z]);",
            66.0,
        );
    }

    /// The weight hangs on the call, and not on what is written like its energy.
    #[test]
    fn energies_written_out_weigh_nothing() {
        let weights = |kinetic: &str| {
            let statements = format!(
                "const c: m/s^2 = 10; gravity [0, 0, -c]; let p = [x, y, z]; let a = rot_y(theta)*translation([l, 0, 0]); \
                 let b = a.origin(); {kinetic}"
            );
            mechanism(&statements, |lagrangian| crate::model::check::trial::values(&lagrangian.potential[1..]))
        };
        // At z = 1.1 with m = 2: 2·10·1.1.
        let one = "kinetic += particle(m, p);";
        assert_eq!(weights(&format!("{one} kinetic += 1/2*m*dt(p).norm_squared();")), [22.0]);
        assert_eq!(weights(&format!("kinetic += 1/2*m*dt(p).norm_squared(); {one}")), [22.0]);
        assert_eq!(weights("kinetic += particle(m, p) - 1/2*m*dt(p).norm_squared();"), [22.0]);
        assert_eq!(weights("kinetic += 1/2*m*dt(b).norm_squared() + particle(m, p);"), [22.0]);
        assert_eq!(weights("let unused = particle(m, p); kinetic += 1/2*m*dt(p).norm_squared();"), [] as [f64; 0]);
        // Two bodies, and the energy of one taken twice.
        assert_eq!(weights(&format!("{one} {one}")), [22.0, 22.0]);
        assert_eq!(weights("let e = particle(m, p); kinetic += e; kinetic += e;"), [22.0, 22.0]);
        assert_eq!(weights("fn body(r) = particle(m, r); kinetic += body(p) + 3*body(p);"), [22.0, 66.0]);
        let link = "kinetic += rigid_body(m, [0, 0, 0], diag(0, 0, 0)*m*l^2, a);";
        let place = -20.0 * 3.0 * 0.4_f64.sin();
        let near = |found: Vec<f64>, count: usize| {
            assert_eq!(found.len(), count);
            assert!(found.iter().all(|weight| (weight - place).abs() < 1e-13), "{found:?}");
        };
        near(weights(&format!("{link} {link}")), 2);
        near(weights(&format!("{link} kinetic += 1/2*m*dt(b).norm_squared();")), 1);
    }

    #[test]
    fn the_field_is_constant() {
        let help = "its vector is made of constants and parameters; for any other field write the potential energies: \
                    `potential += -m*a.dot(r);`";
        let body = "const g: m/s^2 = 9; kinetic += particle(m, [x, y, z]);";
        let refused_at = |field: &str, message: &str| refused(&format!("{body} gravity {field};"), message);
        refused_at(
            "rot_x(theta)*[0, 0, g]",
            &format!("rot_x(theta)*[0, 0, g]: gravity does not depend on coordinates; {help}"),
        );
        refused_at("[0, 0, g*t/t]", &format!("[0, 0, g*t/t]: gravity does not change in time; {help}"));
        refused_at("[0, 0, x]", "[0, 0, x]: gravity must be m/s², this is m");
        refused_at(
            "[0, 0, -9.81]",
            "[0, 0, -9.81]: gravity must be m/s², this is a plain number; a number has no unit unless it is \
             written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        refused_at("g", "g: gravity is a vector, this is a number; write `gravity [0, 0, -g];` where z points up");
        refused(
            &format!("{body} gravity [0, 0, -g]; gravity [0, 0, -g];"),
            "gravity [0, 0, -g];: gravity is declared already; it acts on all bodies: add the vectors",
        );
        refused(
            &format!("{body} for i in 0..2 {{ gravity [0, 0, -g]; }}"),
            "gravity [0, 0, -g];: `gravity` cannot stand in a loop; one statement acts on all bodies, wherever they stand: \
             move it out of the loop",
        );
    }

    #[test]
    fn hidden_bodies_are_told() {
        let told = |energy: &str| {
            let all =
                crate::model::check::trial::refusals(&format!("const g: m/s^2 = 9; gravity [0, 0, -g]; {energy}"));
            assert!(all[0].contains("gravity does not find the body in this energy"), "{energy}: {all:?}");
        };
        told("kinetic += cos(theta)^2*particle(m, [x, y, z]);");
        told("kinetic += if x < l { particle(m, [x, y, z]) } else { 0 };");
        told("lagrangian += particle(m, [x, y, z]);");
        // What is written like a body hides none.
        let written = "let p = [x, y, z]; kinetic += particle(m, p); lagrangian += 1/2*m*dt(p).norm_squared();";
        mechanism(&format!("const g: m/s^2 = 9; gravity [0, 0, -g]; {written}"), |_| ());
    }

    #[test]
    fn gravity_declared_twice_earns_a_warning() {
        let warned = |potential: &str, expected: &[&str]| {
            let text = format!(
                "mechanism A {{ param m: kg = 2; param l: m = 3; param g: m/s^2 = 9.81; coord x: m; coord theta: rad; \
                 let bob = [x + l*sin(theta), 0, -l*cos(theta)]; \
                 kinetic += particle(m, [x, 0, 0]) + particle(m, bob); gravity [0, 0, -g]; {potential} }}"
            );
            let place = |message: &str| message.split(": this is gravity once more").next().map(str::to_string);
            assert_eq!(messages(&text).iter().filter_map(|m| place(m)).collect::<Vec<_>>(), expected, "{potential}");
        };
        warned("potential += m*g*bob.z;", &["m*g*bob.z"]);
        warned("potential += 1/2*m*g/l*x^2 + m*g*l*(1 - cos(theta));", &["1/2*m*g/l*x^2 + m*g*l*(1 - cos(theta))"]);
        warned("const w: N = 2*9.81; potential += -w*l*cos(theta);", &["-w*l*cos(theta)"]);
        // A counterweight, and a spring.
        warned("potential += m*g*l*cos(theta); potential += 1/2*m*g/l*x^2;", &[]);
        let nothing = messages(
            "mechanism A { param m: kg = 2; param g: m/s^2 = 9; coord z: m; kinetic += m*dt(z)^2; gravity [0, 0, -g]; }",
        );
        assert!(nothing.iter().any(|message| message.contains("gravity acts on nothing")), "{nothing:?}");
    }
}
