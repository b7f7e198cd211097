//! What couples bodies and coordinates besides the joints of the tree: constraints, springs along sums.

use std::fmt::Write as _;

use super::super::identifier::Identifiers;
use super::super::pose::{Pose, factors, listed, shown};
use super::super::robot::{Coupling, Kind, Robot};
use super::super::xml::Reader;
use super::{Writer, line, quoted};

/// What couplings are called in the text.
pub(super) fn names(robot: &Robot, is_word: fn(&str) -> bool, identifiers: &mut Identifiers) -> Vec<String> {
    let suffixes = ["_0", "_1", "_2", "_3", "_4", "_first", "_second", "_turn", "_stiffness", "_damping", "_rest"];
    let claimed = robot.couplings.iter().map(|coupling| {
        let (Coupling::Joints { name, .. }
        | Coupling::Sum { name, .. }
        | Coupling::Points { name, .. }
        | Coupling::Frames { name, .. }
        | Coupling::Spring { name, .. }) = coupling;
        identifiers.claim("the coupling", name, "coupling", &suffixes, is_word)
    });
    claimed.collect()
}

impl Writer<'_> {
    pub(super) fn couplings(&mut self, names: &[String], reader: &mut Reader) {
        if names.is_empty() {
            return;
        }
        line!(self, "\n    // ---- couplings");
        for (name, coupling) in names.iter().zip(&self.robot.couplings) {
            line!(self, "");
            self.coupling(name, coupling, reader);
        }
    }

    fn coupling(&mut self, name: &str, coupling: &Coupling, reader: &mut Reader) {
        match coupling {
            Coupling::Joints { first, second, powers, .. } => {
                self.polynomial(name, first, second.as_deref(), powers, reader)
            }
            Coupling::Sum { terms, offset, .. } => {
                let Some((sum, unit)) = self.sum(terms, true, reader) else { return };
                line!(self, "    const {name}_0: {unit} = {};", shown(*offset));
                line!(self, "    constraint {name}: {sum} = {name}_0;");
            }
            Coupling::Points { bodies, points, .. } => {
                let [first, second] = bodies.map(|body| self.frame(body));
                line!(self, "    const {name}_first[3]: m = {};", listed(&points[0]));
                line!(self, "    const {name}_second[3]: m = {};", listed(&points[1]));
                line!(self, "    constraint {name}: {first}.point({name}_first) = {second}.point({name}_second);");
            }
            Coupling::Frames { bodies, poses, .. } => self.weld(name, bodies, poses),
            Coupling::Spring { terms, stiffness, rest, damping, .. } => {
                let Some((sum, unit)) = self.sum(terms, false, reader) else { return };
                let (spring, damper) = if unit == "m" { ("N/m", "N*s/m") } else { ("N*m", "N*m*s") };
                if *stiffness != 0.0 {
                    line!(self, "    const {name}_stiffness: {spring} = {};", shown(*stiffness));
                    line!(self, "    const {name}_rest: {unit} = {};", shown(*rest));
                    line!(self, "    potential += 1/2*{name}_stiffness*({sum} - {name}_rest)^2;");
                }
                if *damping != 0.0 {
                    line!(self, "    const {name}_damping: {damper} = {};", shown(*damping));
                    line!(self, "    dissipation += 1/2*{name}_damping*dt({sum})^2;");
                }
            }
        }
    }

    /// The name of a body, or the world's.
    fn frame(&self, body: Option<usize>) -> String {
        body.map_or("world".to_string(), |number| self.bodies[number].0.clone())
    }

    /// The name of a joint's coordinate, its unit, and where it is zero.
    fn value(&self, joint: &str, reader: &mut Reader) -> Option<(String, &'static str, f64)> {
        let found = self.joints.get(joint).filter(|(_, kind)| matches!(kind, Kind::Hinge | Kind::Slide));
        let Some((name, kind)) = found else {
            let place = self.robot.bodies.first().map_or(0..0, |body| body.span.clone());
            reader.refuse(
                place,
                format!("a coupling names the joint `{}`, which neither turns nor slides", quoted(joint)),
                "",
            );
            return None;
        };
        let joints = self.robot.bodies.iter().flat_map(|body| &body.joints);
        let zero = joints.filter(|other| other.name == joint).map(|other| other.zero).next().unwrap_or(0.0);
        Some((name.clone(), if *kind == Kind::Slide { "m" } else { "rad" }, zero))
    }

    /// `first − first₀ = Σ powers[k] (second − second₀)^k`
    fn polynomial(&mut self, name: &str, first: &str, second: Option<&str>, powers: &[f64; 5], reader: &mut Reader) {
        let Some((first, unit, zero)) = self.value(first, reader) else { return };
        let second = match second {
            Some(second) => match self.value(second, reader) {
                Some(second) => Some(second),
                None => return,
            },
            None => None,
        };
        let mut terms = Vec::new();
        for (k, &power) in
            powers.iter().enumerate().filter(|(k, power)| **power != 0.0 && (*k == 0 || second.is_some()))
        {
            let of = second.as_ref().map_or("rad", |(_, unit, _)| *unit);
            let unit = match (unit, of, k) {
                (unit, "rad", _) | (unit, _, 0) => unit.to_string(),
                ("m", _, 1) => "1".to_string(),
                ("m", _, k) => format!("1/m^{}", k - 1),
                (_, _, k) => format!("1/m^{k}"),
            };
            line!(self, "    const {name}_{k}: {unit} = {};", shown(power));
            let base = second.as_ref().map_or(String::new(), |(second, unit, zero)| counted(second, unit, *zero));
            terms.push(match k {
                0 => format!("{name}_0"),
                1 => format!("{name}_1*{base}"),
                k => format!("{name}_{k}*{base}^{k}"),
            });
        }
        let right = if terms.is_empty() { "0".to_string() } else { terms.join(" + ") };
        line!(self, "    constraint {name}: {} = {right};", counted(&first, unit, zero));
    }

    /// `Σ factor·q`, or of `q − q₀`, in brackets, and its unit.
    fn sum(&mut self, terms: &[(f64, String)], from_zero: bool, reader: &mut Reader) -> Option<(String, &'static str)> {
        let mut all = Vec::new();
        let mut units = Vec::new();
        for (factor, joint) in terms {
            let (name, unit, zero) = self.value(joint, reader)?;
            let value = counted(&name, unit, if from_zero { zero } else { 0.0 });
            all.push(if *factor == 1.0 { value } else { format!("{}*{value}", shown(*factor)) });
            units.push(unit);
        }
        let unit = units.first().copied().unwrap_or("rad");
        if units.iter().any(|other| *other != unit) {
            let place = self.robot.bodies.first().map_or(0..0, |body| body.span.clone());
            reader.refuse(
                place,
                "a tendon adds joints that turn to joints that slide",
                "give it to joints of one kind",
            );
            return None;
        }
        Some((format!("({})", all.join(" + ")), unit))
    }

    /// Origins and axes that fall together.
    fn weld(&mut self, name: &str, bodies: &[Option<usize>; 2], poses: &[Pose; 2]) {
        let [first, second] = bodies.map(|body| self.frame(body));
        line!(self, "    const {name}_first[3]: m = {};", listed(&poses[0].shift));
        line!(self, "    const {name}_second[3]: m = {};", listed(&poses[1].shift));
        line!(self, "    constraint {name}: {first}.point({name}_first) = {second}.point({name}_second);");
        let [a, b] = [(first, &poses[0]), (second, &poses[1])].map(|(body, pose)| format!("({body}{})", factors(pose)));
        line!(self, "    // Axes that stay at right angles.");
        let row = |u: &str, v: &str| format!("({a}*{u}).dot({b}*{v})");
        let (x, y, z) = ("[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]");
        line!(self, "    constraint {name}_turn: [{}, {}, {}] = 0;", row(x, y), row(x, z), row(y, z));
    }
}

/// A coordinate from where the bodies are at their poses.
fn counted(name: &str, unit: &str, zero: f64) -> String {
    match (zero == 0.0, unit) {
        (true, _) => name.to_string(),
        (_, "m") => format!("({name} - {} m)", shown(zero)),
        _ => format!("({name} - {})", shown(zero)),
    }
}
