//! What must hold of the finished mechanism, and what it was probably not meant to do. In reading order:
//!
//! - [`degree`]: what must hold of the energies; [`velocity`]: their degree; [`inertia`]: of every motion;
//! - [`rank`]: the rows of constraints; [`closure`]: whether constraints can hold together;
//! - [`singular`], [`sign`]: what it was probably not meant to do; [`misplaced`]: places counted from another origin
//!   than meant; [`contact`]: forces at places that no body holds;
//! - [`requirement`]: what parameters must satisfy whenever they are set; [`sample`]: random states.

pub(in crate::model) mod closure;
pub(in crate::model) mod contact;
pub(super) mod degree;
pub(in crate::model) mod inertia;
pub(in crate::model) mod misplaced;
pub(in crate::model) mod rank;
pub(in crate::model) mod relation;
pub(crate) mod requirement;
pub(crate) mod sample;
pub(in crate::model) mod sign;
pub(in crate::model) mod singular;
#[cfg(test)]
pub(in crate::model) mod trial;
pub(in crate::model) mod velocity;

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Code;
use crate::expr::{Expr, Matrix, Node, Symbol, evaluate};
use crate::model::check::contact::Acting;
use crate::model::check::degree::{IF_INDEPENDENT, Problem};
use crate::model::check::relation::Relation;
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::Constraint;
use crate::model::names::family::Family;
use crate::model::statement::gravity::Weights;
use crate::model::statement::output::Outputs;
use crate::model::statement::reaction::Joint;
use crate::model::value::evaluate::Resolver;
use crate::numeric::moments::{Impossible, principal_moments};
use crate::parse::syntax::{Name, Span};
use crate::variable::Variable;

/// Where something stands, and the calls and parts that led there, the innermost first.
#[derive(Clone, Debug)]
pub(in crate::model) struct Place {
    pub(in crate::model) span: Span,
    pub(in crate::model) calls: Vec<(Span, String)>,
}

/// Mass and inertia of a body, with their places.
#[derive(Clone, Debug)]
pub(in crate::model) struct Physical<'g> {
    pub(in crate::model) mass: Expr<'g>,
    pub(in crate::model) mass_place: Place,
    pub(in crate::model) inertia: Option<(Matrix<'g>, Place)>,
}

/// Where each term of an energy, each force and each constraint stands.
#[derive(Clone, Debug, Default)]
pub(in crate::model) struct Places {
    pub(in crate::model) kinetic: Vec<Place>,
    pub(in crate::model) potential: Vec<Place>,
    pub(in crate::model) lagrangian: Vec<Place>,
    pub(in crate::model) dissipation: Vec<Place>,
    /// Of the forces on coordinates.
    pub(in crate::model) forces: Vec<Place>,
    pub(in crate::model) constraints: Vec<Place>,
    /// Of constraints between vectors, what vanishes, as it was written.
    pub(in crate::model) differences: Vec<Option<String>>,
}

/// What is looked at when all is known.
#[derive(Default)]
pub(in crate::model) struct Found<'g> {
    /// Masses and inertias.
    pub(in crate::model) physical: Vec<Physical<'g>>,
    /// The field that bodies weigh in, and the bodies that were declared as such.
    pub(in crate::model) weights: Weights<'g>,
    /// Where each kinetic, potential and lagrangian term and each constraint stands.
    pub(in crate::model) places: Places,
    /// The forces that were declared with their places.
    pub(in crate::model) acting: Vec<Acting<'g>>,
    /// Joints whose wrenches are asked for, as far as they have been met.
    pub(in crate::model) joints: Vec<Joint>,
    /// Of each constraint, which of its rows do not vanish.
    pub(in crate::model) effective_rows: Vec<Vec<bool>>,
    /// Outputs, and arrays of them, as far as they have been met.
    pub(in crate::model) outputs: Vec<Outputs<'g>>,
    /// The number among them of the one that each function belongs to.
    pub(in crate::model) functions_of_outputs: BTreeMap<String, usize>,
    /// Arrays of constraints, as far as they have been met.
    pub(in crate::model) constraints: Vec<Family>,
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// Looks at the finished mechanism; `name` is where what concerns all of it is reported.
    pub(in crate::model) fn check(&mut self, name: &Name) {
        self.check_names();
        self.check_reactions();
        self.check_bodies();
        if self.lagrangian.dof() == 0 {
            let message = format!("`{}` has no coordinates", name.text);
            self.refuse(Code::NoCoordinates, &name.span, message, "declare one: `coord theta: rad;`");
        } else if self.lagrangian.kinetic.is_empty() && self.lagrangian.lagrangian.is_empty() {
            let message = format!("`{}` has no kinetic energy", name.text);
            self.refuse(
                Code::NoKineticEnergy,
                &name.span,
                message,
                "write `kinetic += 1/2 * m * dt(x)^2;` or `kinetic += particle(m, r);`",
            );
        } else {
            self.check_inertia();
        }
        self.check_use();
        self.check_calls();
        self.check_parts();
        if !self.report.errors.has_errors() {
            self.check_degree(name);
        }
        if !self.report.errors.has_errors() {
            self.warn_of_signs();
            self.warn_of_double_gravity();
            self.warn_of_places_no_body_holds();
            self.warn_of_singular_derivatives();
            self.warn_of_unsatisfiable_constraints();
        }
    }

    /// Each problem where the term or the coordinate stands that it is about.
    fn check_degree(&mut self, name: &Name) {
        for problem in degree::problems(&self.lagrangian) {
            let place = match &problem {
                Problem::KineticNotQuadratic(term)
                | Problem::KineticUndefinedAtRest(term)
                | Problem::NegativeKinetic(term) => self.found.places.kinetic.get(*term).cloned(),
                Problem::LagrangianNotQuadratic(term) | Problem::LagrangianUndefinedAtRest(term) => {
                    self.found.places.lagrangian.get(*term).cloned()
                }
                Problem::PotentialDependsOnVelocity(term) => self.found.places.potential.get(*term).cloned(),
                Problem::NoInertia(coordinate)
                | Problem::NegativeInertia(coordinate)
                | Problem::NegativeSignal(coordinate, _) => self.place_of(*coordinate),
                Problem::DependentInertia(coordinates) => coordinates.first().and_then(|c| self.place_of(*c)),
                Problem::ConstraintNotLinear(constraint)
                | Problem::ConstraintUndefinedAtRest(constraint)
                | Problem::DependentConstraint(constraint, ..)
                | Problem::DegenerateConstraint(constraint) => self.found.places.constraints.get(*constraint).cloned(),
                Problem::NeverFinite => None,
            };
            let (message, help) = self
                .in_components(&problem)
                .unwrap_or_else(|| (problem.message(&self.lagrangian), problem.help(&self.lagrangian)));
            let place = place.unwrap_or_else(|| Place { span: name.span.clone(), calls: Vec::new() });
            self.report.refuse_at(problem.code(), &place, message, help);
        }
    }

    /// Of a constraint between vectors some of whose components follow from others: which, and those to keep.
    fn in_components(&self, problem: &Problem) -> Option<(String, String)> {
        let Problem::DependentConstraint(number, dependent, relation) = problem else { return None };
        let difference = self.found.places.differences.get(*number)?.as_ref()?;
        let effective = self.found.effective_rows.get(*number).filter(|effective| effective.len() == 3)?;
        let components: Vec<&str> =
            ["x", "y", "z"].into_iter().zip(effective).filter(|(_, is_in)| **is_in).map(|(name, _)| name).collect();
        let (out, kept): (Vec<_>, Vec<_>) = (0..components.len()).partition(|row| dependent.contains(row));
        let named = |rows: &[usize], before: &str| {
            rows.iter().map(|&row| format!("{before}{}", components[row])).collect::<Vec<_>>().join(", ")
        };
        let name = &self.lagrangian.constraints[*number].name;
        if kept.is_empty() {
            return None;
        }
        if *relation == Relation::Turning {
            return Some(along_a_turning_direction(name, [out.len(), kept.len()], difference));
        }
        let kept = match kept.as_slice() {
            [one] => named(&[*one], "v."),
            several => format!("[{}]", named(several, "v.")),
        };
        let (which, follow, contradict) = if out.len() == 1 {
            ("component", "follows", "contradicts")
        } else {
            ("components", "follow", "contradict")
        };
        let message = format!(
            "the world {which} {} of the constraint `{name}` {follow} from the other rows, or {contradict} them",
            named(&out, "")
        );
        let condition = if *relation == Relation::Constant { "" } else { IF_INDEPENDENT };
        Some((message, format!("keep the others: `{kept} = 0`, with `let v = {difference};`{condition}")))
    }

    /// Where the coordinate with this number is declared.
    fn place_of(&self, number: usize) -> Option<Place> {
        let variable = self.lagrangian.coordinates.iter().find(|variable| variable.contains(number));
        variable.map(|variable| Place { span: self.span_of(&variable.name), calls: Vec::new() })
    }

    /// The components of arrays have names too: `q_0`.
    fn check_names(&mut self) {
        let lagrangian = &self.lagrangian;
        let variables = [&lagrangian.coordinates, &lagrangian.parameters, &lagrangian.inputs, &lagrangian.prescribed];
        let variables = variables.into_iter().flatten();
        let mut known: BTreeMap<String, String> = BTreeMap::new();
        let mut doubles = Vec::new();
        for variable in variables {
            for component in variable.component_names() {
                if let Some(other) = known.insert(component.clone(), variable.name.clone()) {
                    doubles.push((variable.name.clone(), component, other));
                }
            }
        }
        for (name, component, other) in doubles {
            let message = format!("`{name}` and `{other}` both have a component called `{component}`");
            self.refuse(Code::NameClash, &self.span_of(&name), message, "choose another name");
        }
        self.check_columns();
    }

    /// A motion is a table with a column for each coordinate and each rate, `energy`, and two for each row of a
    /// constraint.
    fn check_columns(&mut self) {
        let coordinates = &self.lagrangian.coordinates;
        let names: BTreeSet<String> = coordinates.iter().flat_map(Variable::component_names).collect();
        let rows: BTreeSet<String> = self.lagrangian.constraints.iter().flat_map(Constraint::row_names).collect();
        let column = |component: &str| {
            let rate = component.strip_suffix("_dot").filter(|of| names.contains(*of));
            let row = ["lambda_", "residual_"].into_iter().find_map(|kind| component.strip_prefix(kind));
            match (rate, row) {
                (Some(of), _) => Some(format!("the rate of `{of}`")),
                _ if component == "energy" => Some("the energy".to_string()),
                (_, Some(row)) if rows.contains(row) => Some(format!("a number of the constraint `{row}`")),
                _ => None,
            }
        };
        let taken = |variable: &Variable| {
            variable.component_names().iter().find_map(|component| Some((component.clone(), column(component)?)))
        };
        let taken: Vec<_> = coordinates.iter().filter_map(|c| Some((c.name.clone(), taken(c)?))).collect();
        for (name, (component, what)) in taken {
            let message = format!("`{component}` is what {what} is called in the table of a motion");
            self.refuse(Code::NameClash, &self.span_of(&name), message, "choose another name for the coordinate");
        }
    }

    fn span_of(&self, name: &str) -> Span {
        self.names.scope.get(name).map_or(0..0, |binding| binding.span.clone())
    }
}

/// No component in world axes may be left out: where the direction is across its axis, the others are too few.
fn along_a_turning_direction(name: &str, [out, kept]: [usize; 2], difference: &str) -> (String, String) {
    let message = |directions: &str| {
        format!(
            "along {directions} with the state, the constraint `{name}` follows from the other rows, or contradicts them"
        )
    };
    let (message, keep, axis) = match (out, kept) {
        (1, 1) => (
            message("a direction that changes"),
            "keep 1 component, across that direction: `v.dot(pose*[1, 0, 0]) = 0`",
            "y axis has that direction",
        ),
        (1, _) => (
            message("a direction that changes"),
            "keep 2 components, across that direction: `[v.dot(pose*[1, 0, 0]), v.dot(pose*[0, 0, 1])] = 0`",
            "y axis has that direction",
        ),
        _ => (
            message("two directions that change"),
            "keep 1 component, across both directions: `v.dot(pose*[1, 0, 0]) = 0`",
            "x axis is across both",
        ),
    };
    let help = format!(
        "{keep}, with `let v = {difference};` and a `pose` whose {axis} at every state; components in world axes are not \
         enough at every state"
    );
    (message, help)
}

// ---- bodies

impl<'d, 'g> Resolver<'d, 'g> {
    /// Masses and inertias, at the default values of the parameters.
    fn check_bodies(&mut self) {
        let bodies = std::mem::take(&mut self.found.physical);
        let roots = |body: &Physical<'g>| {
            let inertia = body.inertia.iter().flat_map(|(matrix, _)| matrix.0.into_iter().flatten());
            std::iter::once(body.mass).chain(inertia).collect::<Vec<_>>()
        };
        let all: Vec<Expr<'g>> = bodies.iter().flat_map(roots).collect();
        let defaults = default_parameters(&self.lagrangian);
        let mut values = evaluate(&all, |symbol| match symbol {
            Symbol::Parameter(i) => defaults.get(i as usize).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        })
        .into_iter();
        for body in &bodies {
            let mass = values.next().unwrap_or(f64::NAN);
            let entries: Vec<f64> =
                body.inertia.iter().flat_map(|_| values.by_ref().take(9).collect::<Vec<_>>()).collect();
            self.check_mass(body, mass, &entries);
            if let (Some((_, span)), Some(moments)) = (&body.inertia, principal_moments(&entries)) {
                self.check_moments(moments, span);
            }
        }
    }

    fn check_mass(&mut self, body: &Physical<'g>, mass: f64, inertia: &[f64]) {
        let by_default = match self.known.facts.constant(body.mass) {
            Some(_) => "",
            None => "this is so by the default values of the parameters",
        };
        if mass < 0.0 {
            self.report.refuse_at(
                Code::NegativeMass,
                &body.mass_place,
                format!("a mass is not negative, this is {mass} kg"),
                by_default,
            );
            self.note_declaration(body);
        }
        if mass == 0.0 && inertia.iter().all(|&entry| entry == 0.0) {
            let help = if by_default.is_empty() { "leave it out" } else { by_default };
            self.report.refuse_at(
                Code::NoMass,
                &body.mass_place,
                "a body without mass and inertia has no kinetic energy",
                help,
            );
            self.note_declaration(body);
        }
    }

    /// Of a mass that is a parameter.
    fn note_declaration(&mut self, body: &Physical<'g>) {
        let Node::Symbol(Symbol::Parameter(number)) = body.mass.node() else { return };
        let mut parameters = self.lagrangian.parameters.iter();
        let Some(parameter) = parameters.find(|p| p.contains(number as usize)) else { return };
        let place = self.span_of(&parameter.name);
        self.report.errors.note(&body.mass_place.span, &place, "declared here");
    }

    fn check_moments(&mut self, moments: [f64; 3], place: &Place) {
        let [a, b, c] = moments.map(shown);
        let shown = format!("its principal moments are {a}, {b} and {c}");
        match Impossible::of(moments) {
            Some(Impossible::Negative) => {
                let help = format!("{shown}; are the products of inertia too large for the diagonal?");
                self.report.refuse_at(
                    Code::ImpossibleInertia,
                    place,
                    "an inertia has no negative principal moment",
                    help,
                );
            }
            Some(Impossible::Unequal) => {
                let message = "no body has this inertia: a principal moment is greater than the sum of the other two";
                let help = format!(
                    "{shown}; where a body turns about one axis only, any two others will do, such as equal ones"
                );
                self.report.refuse_at(Code::ImpossibleInertia, place, message, help);
            }
            None => {}
        }
    }
}

fn shown(moment: f64) -> String {
    let scale = 10f64.powi(3 - moment.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    let rounded = (moment * scale).round() / scale;
    let shown = if rounded.is_finite() { rounded } else { moment };
    if shown != 0.0 && shown.abs() < 1e-4 { format!("{shown:e}") } else { shown.to_string() }
}

// ---- coordinates and parameters

impl<'d, 'g> Resolver<'d, 'g> {
    /// A coordinate whose rate enters neither T nor the Lagrangian has a mass of zero.
    fn check_inertia(&mut self) {
        let graph = self.graph;
        let energies = self.lagrangian.kinetic.iter().chain(&self.lagrangian.lagrangian);
        let rates = graph.reachable(energies.map(|e| e.id())).into_iter().filter_map(|id| match graph.node(id) {
            Node::Rate(a) => Some(a),
            _ => None,
        });
        let mut moving = self.symbols(rates.map(|id| graph.expr(id)).collect());
        // Constraints may move a coordinate without inertia.
        moving.extend(self.symbols(self.lagrangian.constraints.iter().flat_map(|c| c.rows.clone()).collect()));
        let missing = |variable: &Variable| {
            let numbers = variable.first..variable.first + variable.count();
            let names = variable.component_names().into_iter().zip(numbers);
            let massless = names.filter(|(_, i)| !moving.contains(&Symbol::Coordinate(*i as u32)));
            massless.map(|(component, _)| (variable.name.clone(), component)).collect::<Vec<_>>()
        };
        let massless: Vec<_> = self.lagrangian.coordinates.iter().flat_map(missing).collect();
        let used = self.symbols(self.everything());
        for (name, component) in massless {
            let numbers = self.lagrangian.coordinates.iter().find(|c| c.name == name);
            let mut numbers = numbers.map_or(0..0, |c| c.first..c.first + c.count());
            let (code, message) = match numbers.any(|i| used.contains(&Symbol::Coordinate(i as u32))) {
                true => (Code::NoInertia, format!("`{component}` has no inertia: its rate is in no kinetic energy")),
                false => (Code::NeverUsed, format!("the coordinate `{name}` is never used")),
            };
            let help = format!("write `kinetic += …` with `dt({name})`, or leave it out");
            self.refuse(code, &self.span_of(&name), message, help);
        }
    }

    /// All that is made of the declared names.
    fn everything(&self) -> Vec<Expr<'g>> {
        let lagrangian = &self.lagrangian;
        let energies = [&lagrangian.kinetic, &lagrangian.potential, &lagrangian.dissipation, &lagrangian.lagrangian];
        let mut roots: Vec<Expr<'g>> = energies.into_iter().flatten().copied().collect();
        roots.extend(lagrangian.forces.iter().map(|(_, force)| *force));
        roots.extend(lagrangian.point_forces.iter().flat_map(|f| f.velocity.0.into_iter().chain(f.force.0)));
        roots.extend(lagrangian.constraints.iter().flat_map(|constraint| &constraint.rows));
        for output in &lagrangian.outputs {
            roots.extend(output.value.components(&lagrangian.frames));
        }
        roots
    }

    /// Parameters and inputs that nothing depends on are probably forgotten somewhere.
    fn check_use(&mut self) {
        let mut roots = self.everything();
        roots.extend(self.lagrangian.drawn_expressions());
        let used = self.symbols(roots);
        let unused = |variables: &[Variable], symbol: fn(u32) -> Symbol| {
            let of = |variable: &&Variable| {
                let mut numbers = variable.first..variable.first + variable.count();
                !numbers.any(|i| used.contains(&symbol(i as u32)))
            };
            variables.iter().filter(of).map(|variable| variable.name.clone()).collect::<Vec<_>>()
        };
        let parameters = unused(&self.lagrangian.parameters, Symbol::Parameter);
        let inputs = unused(&self.lagrangian.inputs, Symbol::Input);
        let prescribed = unused(&self.lagrangian.prescribed, |i| Symbol::Prescribed(i, 0));
        for name in parameters.into_iter().chain(inputs).chain(prescribed) {
            let warning =
                self.report.errors.warning(Code::Unused, self.span_of(&name), format!("`{name}` is not used"));
            warning.help("it is in no energy, force, constraint or output");
        }
    }

    /// The symbols that some expressions depend on.
    fn symbols(&self, roots: Vec<Expr<'g>>) -> BTreeSet<Symbol> {
        let graph = self.graph;
        let nodes = graph.reachable(roots.into_iter().map(|root| root.id())).into_iter().map(|id| graph.node(id));
        nodes.filter_map(|node| if let Node::Symbol(symbol) = node { Some(symbol) } else { None }).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{messages, refused};

    #[test]
    fn bodies_must_be_possible() {
        let body = |mass: &str, inertia: &str| {
            format!(
                "const i: kg*m^2 = 1; const n: kg = {mass}; kinetic += rigid_body(n, [0, 0, 0], {inertia}, rot_z(theta));"
            )
        };
        refused(&body("-1", "diag(i, i, i)"), "n: a mass is not negative, this is -1 kg");
        refused(&body("0", "diag(0, 0, 0)"), "n: a body without mass and inertia has no kinetic energy; leave it out");
        refused(
            &body("1", "diag(i, i, 3*i)"),
            "diag(i, i, 3*i): no body has this inertia: a principal moment is greater than the sum of the other two; its principal moments are 1, 1 and 3; where a body turns about one axis only, any two others will do, such as equal ones",
        );
        refused(
            &body("1", "inertia(i, i, i, 2*i, 0, 0)"),
            "inertia(i, i, i, 2*i, 0, 0): an inertia has no negative principal moment; its principal moments are -1, 1 and 3; are the products of inertia too large for the diagonal?",
        );
        refused(
            "param n: kg = -3; kinetic += particle(n, [x, y, z]);",
            "n: a mass is not negative, this is -3 kg; this is so by the default values of the parameters",
        );
        refused(
            "param n: kg = 0; kinetic += particle(n, [x, y, z]);",
            "n: a body without mass and inertia has no kinetic energy; this is so by the default values of the parameters",
        );
        assert!(crate::model::check::trial::refusals(&body("0", "diag(i, i, 2*i)")).is_empty());
        assert!(crate::model::check::trial::refusals(&body("1", "diag(0, i, i)")).is_empty());
    }

    #[test]
    fn a_mechanism_has_coordinates_and_kinetic_energy() {
        let check = |statements: &str, message: &str| {
            assert_eq!(messages(&format!("mechanism A {{ {statements} }}")), [message], "{statements}");
        };
        check("", "A: `A` has no coordinates; declare one: `coord theta: rad;`");
        check(
            "coord x: m;",
            "A: `A` has no kinetic energy; write `kinetic += 1/2 * m * dt(x)^2;` or `kinetic += particle(m, r);`",
        );
        check(
            "param m: kg = 1; coord x: m; coord y: m; kinetic += 1/2*m*dt(x)^2; potential += m*y^2/t^2;",
            "y: `y` has no inertia: its rate is in no kinetic energy; write `kinetic += …` with `dt(y)`, or leave it out",
        );
        check(
            "param m: kg = 1; coord q[2]: m; kinetic += 1/2*m*dt(q[0])^2;",
            "q: `q_1` has no inertia: its rate is in no kinetic energy; write `kinetic += …` with `dt(q)`, or leave it out",
        );
    }

    #[test]
    fn the_degree_of_each_term_is_tried() {
        let check = |statements: &str, place: &str| {
            let text = format!("mechanism A {{ param m: kg = 1; coord x: m; coord y: m; {statements} }}");
            let found = messages(&text);
            assert!(found.len() == 1 && found[0].starts_with(&format!("{place}: ")), "{found:?}");
        };
        check(
            "kinetic += m*(dt(x)^2 + dt(y)^2); kinetic += m*abs(dt(x))^3*t/(x^2 + y^2)^0.5;",
            "m*abs(dt(x))^3*t/(x^2 + y^2)^0.5",
        );
        check("kinetic += m*(dt(x)^2 + dt(y)^2); lagrangian += m*dt(x)^4*t^2/y^2;", "m*dt(x)^4*t^2/y^2");
        check("kinetic += m*(dt(x) + dt(y))^2;", "x");
    }

    #[test]
    fn what_is_divided_by_does_not_vanish_at_rest() {
        let found = |statements: &str| {
            messages(&format!(
                "mechanism A {{ param m: kg = 1; coord x: m; coord y: m; kinetic += m*(dt(x)^2 + dt(y)^2); {statements} }}"
            ))
        };
        let refused = |statements: &str, message: &str| {
            let help = "divide it out: `dt(x) + dt(y)` for `(dt(x)^2 - dt(y)^2)/(dt(x) - dt(y))`";
            assert_eq!(found(statements), [format!("{message}; {help}")], "{statements}");
        };
        let row = "(dt(x)^2 - dt(y)^2)/(dt(x) - dt(y))";
        let energy = "this energy has no value at rest: it divides by what vanishes there";
        refused(&format!("lagrangian += 1 kg*m/s*{row};"), &format!("1 kg*m/s*{row}: {energy}"));
        let quotient = "1/8*m*(dt(x)^4 - dt(y)^4)/(dt(x)^2 + dt(y)^2)";
        refused(&format!("kinetic += {quotient};"), &format!("{quotient}: {energy}"));
        let constraint = "the constraint `c` has no value at rest: it divides by what vanishes there";
        refused(&format!("constraint c: {row} = 0 m/s;"), &format!("{row} = 0 m/s: {constraint}"));
        for fine in [
            "constraint c: dt(x)*(1 m/s + dt(x))/(1 m/s + dt(x)) = dt(y);",
            "kinetic += m*dt(x)^2*(1 m/s + dt(x))/(1 m/s + dt(x));",
        ] {
            assert!(found(fine).is_empty(), "{fine}: {:?}", found(fine));
        }
        // At rest it is 0/0, its coefficients are not: a warning.
        let warned = found("constraint c: dt(x)*dt(y)/dt(y) = dt(y);");
        assert!(warned.len() == 1 && warned[0].contains("this is 0/0 where `dt(y)` = 0"), "{warned:?}");
    }

    #[test]
    fn what_is_not_used_is_told() {
        let text = "mechanism A { param m: kg = 1; param mu: 1 = 2; input u[2]: N; coord x: m; kinetic += m*dt(x)^2; let a = mu; }";
        let help = "it is in no energy, force, constraint or output";
        assert_eq!(messages(text), [format!("mu: `mu` is not used; {help}"), format!("u: `u` is not used; {help}")]);
    }
}
