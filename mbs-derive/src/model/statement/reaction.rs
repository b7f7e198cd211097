//! `reaction name at pose;`: joints whose wrenches are asked for.
//!
//! A declaration with reactions is gone through twice. The first time the joints are held, and a `reaction` statement
//! changes nothing: the mechanism is what it would be without it, and so is all that is derived from it but the
//! reactions. The second time the joints are let go: each pose moves, from its statement on, with six auxiliary
//! coordinates,
//!
//! ```text
//! pose · translation(ξ) · rot_x(ψ₁) · rot_y(ψ₂) · rot_z(ψ₃)
//! ```
//!
//! whose generalized forces, where all of them are zero, are the force and the moment at the joint.

use crate::diagnostic::Code;
use crate::expr::{Expr, Graph, Symbol, Tape, Vector};
use crate::model::frame::Edge;
use crate::model::lagrangian::{AUXILIARY, Draft, Reaction};
use crate::model::names::element::shown;
use crate::model::names::family::Family;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::{Pose, Shape, Value};
use crate::parse::syntax::{Declaration, Expression, Name, Statement, StatementKind};
use crate::variable::Variable;

/// More joints than any mechanism of so few coordinates has.
pub(in crate::model) const MAX_JOINTS: usize = 100;

/// Whether joints are held.
#[derive(Clone, Debug)]
pub(in crate::model) enum Hold<'g> {
    /// There are no reactions.
    Always,
    /// They are let go the next time.
    Now,
    /// They are let go.
    Released(Released<'g>),
}

/// What is known of a mechanism when its joints are let go.
#[derive(Clone, Debug)]
pub(in crate::model) struct Released<'g> {
    /// All joints.
    reactions: Vec<Reaction>,
    /// Their auxiliary coordinates, behind those of the mechanism.
    auxiliary: Vec<Expr<'g>>,
    /// Which rows of each constraint do not vanish when they are held.
    effective_rows: Vec<Vec<bool>>,
}

/// A reaction, or an array of them, as far as its statements have been met.
#[derive(Clone, Debug)]
pub(in crate::model) struct Joint {
    pub(in crate::model) family: Family,
    docs: Vec<String>,
    /// The name that holds the pose of the first of them.
    pose: String,
}

impl Hold<'_> {
    /// Of what is gone through for the first time.
    pub(in crate::model) fn of(declaration: &Declaration) -> Self {
        let statements = [&declaration.imported, &declaration.statements];
        if statements.into_iter().any(|statements| has_reactions(statements)) { Hold::Now } else { Hold::Always }
    }
}

fn has_reactions(statements: &[Statement]) -> bool {
    statements.iter().any(|statement| match &statement.kind {
        StatementKind::Reaction { .. } => true,
        StatementKind::For { body, .. } | StatementKind::Part { body, .. } => has_reactions(body),
        StatementKind::If { branches, otherwise } => {
            has_reactions(otherwise) || branches.iter().any(|(_, body)| has_reactions(body))
        }
        _ => false,
    })
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// `reaction name at pose;`, `reaction name[i] at pose;`
    pub(in crate::model) fn reaction(
        &mut self,
        docs: &[String],
        name: &Name,
        index: Option<&Expression>,
        pose: &Name,
        element: &[Expression],
    ) -> Resolved<()> {
        let number = self.number_of(index, MAX_JOINTS, "reaction");
        let element = self.element_that_holds(pose, element);
        let held = element.clone().and_then(|element| self.held(pose, element.as_deref()));
        let number = number?;
        self.note_joint(docs, name, number, pose)?;
        let (held, element) = (held?, element?);
        let Some(auxiliary) = self.auxiliary(&name.text, number.unwrap_or(0)) else { return Ok(()) };
        let base = self.attached(&held, &pose.span)?;
        let moved = Pose { base, edges: let_go(self.graph, auxiliary) };
        self.give_pose(pose, element.as_deref(), moved);
        Ok(())
    }

    /// Which element of an array that is given its values one by one; none where the name itself holds the pose.
    fn element_that_holds(&mut self, pose: &Name, element: &[Expression]) -> Resolved<Option<Vec<usize>>> {
        let has_elements = self.names.scope.get(&pose.text).is_some_and(|binding| binding.elements.is_some());
        match (has_elements, element) {
            (true, _) => self.numbers_of(pose, element).map(Some),
            (false, []) => Ok(None),
            (false, _) => {
                let help = "name the pose, and build on the name: `let joint = …; reaction name at joint;`";
                Err(self.refuse(Code::ReactionOfAName, &pose.span, "a reaction is that of a pose with a name", help))
            }
        }
    }

    /// The pose of a name, or of an element, that nothing has been built on.
    fn held(&mut self, pose: &Name, element: Option<&[usize]>) -> Resolved<Pose<'g>> {
        let used = match element {
            Some(numbers) => self.use_of_element(&pose.text, numbers),
            None => self.names.scope.get(&pose.text).and_then(|binding| binding.used.clone()),
        };
        let value = match element {
            Some(numbers) => self.given(&pose.text, numbers, &pose.span)?,
            None => self.name(&pose.text, &pose.span)?,
        };
        let shown = element.map_or(pose.text.clone(), |numbers| shown(&pose.text, numbers));
        let Value::Pose(held) = value else {
            return Err(self.wrong_shape(&Argument { value, span: pose.span.clone() }, Shape::Pose));
        };
        if self.names.scope.get(&pose.text).is_none() {
            let help = "name a pose that is made of it, and build on it what the joint carries: \
                        `let base = world; reaction name at base; let part = base * …;`";
            return Err(self.refuse(Code::ReactionOfAName, &pose.span, format!("`{}` is built in", pose.text), help));
        }
        if let Some(place) = used {
            let message = format!("something was built on `{shown}` before this reaction: it would not count");
            let help = format!("move the statement up, right behind the one that gives `{shown}` its value");
            self.report
                .errors
                .error(Code::ReactionTooLate, pose.span.clone(), message)
                .help(help)
                .note(place, "it is used here");
            return Err(Refused);
        }
        // Asking for the reaction builds nothing on it.
        self.give_pose(pose, element, held.clone());
        Ok(held)
    }

    /// A new value, not used yet.
    fn give_pose(&mut self, pose: &Name, element: Option<&[usize]>, held: Pose<'g>) {
        let Some(binding) = self.names.scope.get_mut(&pose.text) else { return };
        match (element, &mut binding.elements) {
            (Some(numbers), Some(elements)) => elements.give(numbers, Value::Pose(held), pose.span.clone()),
            _ => (binding.value, binding.used) = (Some(Value::Pose(held)), None),
        }
    }

    fn note_joint(&mut self, docs: &[String], name: &Name, number: Option<usize>, pose: &Name) -> Resolved<()> {
        match self.found.joints.iter().position(|joint| joint.family.name.text == name.text) {
            Some(known) => {
                self.join(|resolver| &mut resolver.found.joints[known].family, name, number, "reaction")?;
            }
            None => {
                self.check_reaction_name(name)?;
                let (family, docs) = (Family::new(name, number), docs.to_vec());
                self.found.joints.push(Joint { family, docs, pose: pose.text.clone() });
            }
        }
        Ok(())
    }

    fn check_reaction_name(&mut self, name: &Name) -> Resolved<()> {
        if let Some(&position) = self.found.functions_of_outputs.get(&name.text) {
            let output = &self.found.outputs[position].family.name.text;
            let message = format!("there is already an output `{output}` with a function of this name");
            return Err(self.refuse(Code::NameClash, &name.span, message, "choose another name"));
        }
        self.check_is_free(name, std::slice::from_ref(&name.text), "reaction")
    }

    /// Every index of an array stands for a joint, and no two joints have one name.
    pub(in crate::model) fn check_reactions(&mut self) {
        let mut reactions: Vec<Reaction> = Vec::new();
        let total: usize = self.found.joints.iter().map(|joint| joint.family.count()).sum();
        for Joint { family, docs, .. } in self.found.joints.clone() {
            let _ = self.complete(&family, "reaction");
            let (name, length) = (family.name.clone(), family.length());
            let reaction = Reaction { name: name.text, docs, length };
            let names = reaction.component_names();
            let same = |other: &&Reaction| other.component_names().iter().any(|known| names.contains(known));
            if let Some(other) = reactions.iter().find(same) {
                let message = format!("`{}` and `{}` both have a joint of one name", reaction.name, other.name);
                self.refuse(Code::NameClash, &name.span, message, "choose another name");
            }
            if total > MAX_JOINTS && reactions.is_empty() {
                let message = format!("a mechanism has at most {MAX_JOINTS} reactions, these are {total}");
                self.refuse(Code::TooMuch, &name.span, message, "ask for fewer");
            }
            reactions.push(reaction);
        }
        self.lagrangian.reactions = reactions;
    }
}

// ---- joints let go

impl<'g> Resolver<'_, 'g> {
    /// How the declaration is gone through once more, where its joints are to be let go.
    pub(in crate::model) fn released(&self) -> Option<Hold<'g>> {
        let reactions = self.lagrangian.reactions.clone();
        let (first, joints) = (self.lagrangian.dof(), reactions.iter().map(Reaction::count).sum::<usize>());
        let symbol = |i: usize| self.graph.symbol(Symbol::Coordinate(i as u32));
        let auxiliary = (first..first + AUXILIARY * joints).map(symbol).collect();
        let effective_rows = self.found.effective_rows.clone();
        (joints > 0).then_some(Hold::Released(Released { reactions, auxiliary, effective_rows }))
    }

    /// Whether what no coordinate moves may yet be moved by a joint that is let go.
    pub(in crate::model) fn may_be_released(&self) -> bool {
        matches!(self.hold, Hold::Now)
    }

    /// Which of the next constraint's `rows` did not vanish when the joints were held; nothing where they are.
    pub(in crate::model) fn rows_when_held(&self, rows: usize) -> Option<Vec<bool>> {
        let Hold::Released(Released { effective_rows, .. }) = &self.hold else { return None };
        let known = effective_rows.get(self.lagrangian.constraints.len()).filter(|known| known.len() == rows);
        // Where a constraint before it has been refused, nothing comes of this one.
        Some(known.cloned().unwrap_or_else(|| vec![true; rows]))
    }

    /// Of joints that carry nothing: what is let go moves no energy, no force and no constraint with it.
    pub(in crate::model) fn warn_of_idle_reactions(&mut self, released: &Draft<'g>) {
        let energies = [&released.kinetic, &released.potential, &released.lagrangian, &released.dissipation];
        let energies = energies.into_iter().flatten().copied();
        let velocities = released.point_forces.iter().flat_map(|force| force.velocity.0);
        let rows = released.constraints.iter().flat_map(|constraint| constraint.rows.iter().copied());
        let moved = Tape::new(&energies.chain(velocities).chain(rows).collect::<Vec<_>>()).coordinates();
        let mut first = self.lagrangian.dof();
        for (reaction, joint) in self.lagrangian.reactions.iter().zip(&self.found.joints) {
            let joints = reaction.component_names().len();
            let carries = |number: usize| {
                let own = first + AUXILIARY * number..first + AUXILIARY * (number + 1);
                moved.iter().any(|coordinate| own.contains(coordinate))
            };
            let name = |number: usize| match reaction.length {
                Some(_) => format!("`{}[{number}]`", reaction.name),
                None => format!("`{}`", reaction.name),
            };
            let idle: Vec<String> = (0..joints).filter(|&number| !carries(number)).map(name).collect();
            first += AUXILIARY * joints;
            if !idle.is_empty() {
                let (what, pose) = (if idle.len() == 1 { "is" } else { "are" }, &joint.pose);
                let message = format!(
                    "{} {what} zero at every state: nothing that has a mass, or that a force or a constraint acts on, is \
                     built on `{pose}` behind this reaction",
                    idle.join(", ")
                );
                let help = format!(
                    "build on `{pose}` what the joint carries: `let part = {pose} * translation([x, y, z]);`; what is written \
                     in world coordinates does not rest on it"
                );
                self.report.errors.warning(Code::IdleReaction, joint.family.name.span.clone(), message).help(help);
            }
        }
    }

    /// The auxiliary coordinates of a joint, if it is let go.
    fn auxiliary(&self, name: &str, number: usize) -> Option<[Expr<'g>; AUXILIARY]> {
        let Hold::Released(Released { reactions, auxiliary, .. }) = &self.hold else { return None };
        let before: usize = reactions.iter().take_while(|reaction| reaction.name != name).map(Reaction::count).sum();
        auxiliary.as_chunks::<AUXILIARY>().0.get(before + number).copied()
    }

    /// The auxiliary coordinates follow those of the mechanism.
    pub(in crate::model) fn let_go(&mut self) {
        let Hold::Released(Released { auxiliary, .. }) = &self.hold else { return };
        self.lagrangian.coordinates.push(Variable {
            name: "auxiliary".to_string(),
            docs: Vec::new(),
            unit: "1".to_string(),
            length: Some(auxiliary.len()),
            columns: None,
            first: self.lagrangian.dof(),
            defaults: Vec::new(),
            declared_unit: None,
            positive: false,
        });
    }
}

/// Shifted along the axes of the pose, then turned about them: for small angles the order does not matter.
fn let_go<'g>(graph: &'g Graph, auxiliary: [Expr<'g>; AUXILIARY]) -> Vec<Edge<'g>> {
    let [x, y, z, turns @ ..] = auxiliary;
    let turn = |(axis, angle)| Edge::Rotation { axis: Vector::unit(graph, axis), angle };
    std::iter::once(Edge::Translation(Vector([x, y, z]))).chain(turns.into_iter().enumerate().map(turn)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::evaluate;
    use crate::model::check::trial::{at, mechanism, refused};
    use crate::model::{Lagrangian, OutputValue};

    const ARM: &str = "let arm = translation([x, 0, 0]) * rot_z(theta);";

    #[test]
    fn held_joints_change_nothing_and_released_ones_move() {
        let statements = format!("{ARM} reaction hinge at arm; output tip = arm.point([l, 0, 0]);");
        mechanism(&statements, |lagrangian| {
            let released = lagrangian.released.as_deref().expect("there is a reaction");
            assert_eq!(lagrangian.reactions[0].component_names(), ["hinge"]);
            let n = lagrangian.dof();
            assert_eq!(released.dof(), n + AUXILIARY);
            let tip = |lagrangian: &Lagrangian<'_>, moved: Option<usize>| {
                let OutputValue::Array(tip) = &lagrangian.outputs[0].value else { panic!("a vector") };
                evaluate(tip, |symbol| match symbol {
                    Symbol::Coordinate(i) if i as usize >= n => f64::from(u8::from(moved == Some(i as usize - n))),
                    other => at(other),
                })
            };
            let held = tip(&lagrangian, None);
            assert_eq!(tip(released, None), held);
            // Shifted by 1 along the arm's y; turned by 1 about its z.
            let (s, c) = 0.4f64.sin_cos();
            let shifted = tip(released, Some(1));
            assert!((shifted[0] - held[0] + s).abs() < 1e-12 && (shifted[1] - held[1] - c).abs() < 1e-12);
            let turned = tip(released, Some(5));
            assert!((turned[1] - 3.0 * 1.4f64.sin()).abs() < 1e-12);
        });
    }

    #[test]
    fn rows_that_are_left_out_stay_out() {
        let statements = format!(
            "{ARM} reaction hinge at arm; \
             constraint closed: arm.point([l, 0, 0]) = [y, z, 0]; kinetic += m*(dt(y)^2 + dt(z)^2);"
        );
        mechanism(&statements, |lagrangian| {
            let released = lagrangian.released.as_deref().expect("there is a reaction");
            assert_eq!(lagrangian.constraints[0].rows.len(), 2);
            assert_eq!(released.constraints[0].rows.len(), 2);
        });
    }

    #[test]
    fn wrong_reactions() {
        refused(
            "reaction r at theta;",
            "theta: expected a pose, found a number; poses are made by `rot_z(angle)`, `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
        );
        refused(
            &format!("{ARM} let tip = arm.origin(); reaction r at arm;"),
            "arm: something was built on `arm` before this reaction: it would not count; move the statement up, right behind \
             the one that gives `arm` its value",
        );
        refused(
            &format!("{ARM} reaction r[1] at arm;"),
            "r: there is no reaction `r[0]`; indices run from 0 on, without gaps",
        );
        refused(
            &format!("{ARM} reaction r[100] at arm;"),
            "100: an array has at most 100 reactions, this one has the index 100; indices run from 0 on, without gaps",
        );
    }

    #[test]
    fn a_joint_that_carries_nothing_is_reported() {
        let warning = |statements: &str| {
            let source = format!("mechanism A {{ param m: kg = 1; coord x: m; coord z: m; {statements} }}");
            crate::model::check::trial::resolved(&source, |result| match result {
                Ok((_, warnings)) => warnings.render("trial", &source),
                Err(errors) => panic!("{}", errors.render("trial", &source)),
            })
        };
        let floor = "let floor = world; reaction ground at floor;";
        let idle = warning(&format!("{floor} kinetic += particle(m, [x, 0, z]);"));
        assert!(idle.contains("warning[MBS1107]: `ground` is zero at every state: nothing that has a mass"), "{idle}");
        for built in [
            "kinetic += particle(m, floor.point([x, 0, z]));",
            "kinetic += particle(m, [x, 0, z]); force at floor.origin() += [0, 0, -1 N];",
            "kinetic += particle(m, [x, 0, z]); constraint on: floor.point([0, 0, 1 m]).z = z;",
        ] {
            assert_eq!(warning(&format!("{floor} {built}")), "", "{built}");
        }
        let two = "let mut a = world; for i in 0..2 { a = a * translation([x, 0, 0]); reaction r[i] at a; }";
        let second = warning(&format!("{two} kinetic += particle(m, a.point([0, 0, z]));"));
        assert_eq!(second, "");
        let last = "let b = translation([x, 0, 0]); let mut a = b; \
                    for i in 0..2 { a = b * translation([0, 0, z]); reaction r[i] at a; \
                    if i == 0 { kinetic += particle(m, a.origin()); } }";
        assert!(warning(last).contains("`r[1]` is zero at every state"), "{}", warning(last));
    }
}
