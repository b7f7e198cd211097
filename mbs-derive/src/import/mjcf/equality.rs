//! Equality constraints, and tendons along sums of coordinates.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::super::identifier::{shown, spare};
use super::super::pose::{Pose, norm, plus, turned};
use super::super::robot::{Coupling, Kind};
use super::super::write::{at_rest, carried};
use super::super::xml::{children, place, tag};
use super::class::{BOOLEANS, DAMPERS, EQUALITIES, SPRINGS};
use super::{File, linear};

/// Coordinates and their factors.
type Terms = Vec<(f64, String)>;

/// What frames that stay together come to, where that is plain.
enum Held {
    /// They do so always, for this reason.
    Always(String),
    /// This joint stays where it is.
    By(String),
}

/// Whether places or axes fall together; MuJoCo saves six digits.
fn is_near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-5 * (1.0 + b.abs()))
}

/// Whether a constraint is stated by sites, not by bodies.
fn is_between_sites(node: Node<'_, '_>) -> bool {
    ["site1", "site2"].iter().any(|site| node.has_attribute(*site))
}

impl<'a, 'i> File<'a, 'i, '_> {
    pub(super) fn equalities(&mut self, root: Node<'a, 'i>) {
        let tendons = self.tendons(root);
        let all = children(root, "equality").flat_map(|node| node.children().filter(Node::is_element));
        let all: Vec<_> = all.collect();
        if !all.is_empty() && self.settings.is_disabled(&EQUALITIES) {
            self.robot.notes.push("Equalities are disabled by a flag, and left out.".to_string());
            return;
        }
        for (count, equality) in (1..).zip(all) {
            let kind = equality.tag_name().name();
            let name = equality.attribute("name").map_or_else(|| format!("{kind}_{count}"), str::to_string);
            self.settings.check_class(equality, "class", self.reader);
            let holder = self.settings.holder(equality, "equality", &self.settings.main, "active");
            if self.reader.word(holder, "active", &BOOLEANS) == Some("false") {
                self.robot.notes.push(format!("The equality `{name}` is not active, and left out."));
                continue;
            }
            match kind {
                "connect" => self.connect(equality, name),
                "weld" => self.weld(equality, name),
                "joint" => self.coupled_joints(equality, name),
                "tendon" => self.coupled_tendons(equality, name, &tendons),
                _ => self.reader.refuse(
                    tag(equality),
                    format!("the equality `{kind}` is not imported"),
                    "write it as a constraint beside the import",
                ),
            }
        }
    }

    /// The body that an attribute names; the world where it names none.
    fn end(&mut self, node: Node<'a, 'i>, attribute: &str) -> Option<Option<usize>> {
        match node.attribute(attribute) {
            None | Some("world") => Some(None),
            Some(name) => match self.bodies.get(name) {
                Some(&number) => Some(Some(number)),
                None => {
                    self.reader.refuse(place(node, attribute), format!("there is no body `{name}`"), "");
                    None
                }
            },
        }
    }

    /// The two sites of a constraint that is stated by sites.
    fn between_sites(&mut self, node: Node<'a, 'i>, of: &str) -> Option<[(Option<usize>, Pose); 2]> {
        let mut site = |attribute: &str| {
            let name = self.reader.wanted(node, attribute, &format!("the equality `{of}`"))?;
            let found = self.sites.get(name).copied();
            if found.is_none() {
                self.reader.refuse(place(node, attribute), format!("there is no site `{name}`"), "");
            }
            found
        };
        let (first, second) = (site("site1"), site("site2"));
        Some([first?, second?])
    }

    fn connect(&mut self, node: Node<'a, 'i>, name: String) {
        let (bodies, poses) = if is_between_sites(node) {
            let Some([(a, p), (b, q)]) = self.between_sites(node, &name) else { return };
            ([a, b], [p, q])
        } else {
            let (Some(a), Some(b)) = (self.end(node, "body1"), self.end(node, "body2")) else { return };
            if self.reader.wanted(node, "anchor", &format!("the equality `{name}`")).is_none() {
                return;
            }
            let Some(anchor) = self.reader.array(node, "anchor", &format!("the anchor of `{name}`")) else { return };
            let points = [anchor, carried(&self.robot, a, anchor, b)];
            ([a, b], points.map(|shift| Pose { shift, ..Pose::default() }))
        };
        self.held(name, bodies, poses, true);
    }

    fn weld(&mut self, node: Node<'a, 'i>, name: String) {
        if is_between_sites(node) {
            let Some([(a, p), (b, q)]) = self.between_sites(node, &name) else { return };
            return self.welded(node, name, [a, b], [p, q]);
        }
        let (Some(a), Some(b)) = (self.end(node, "body1"), self.end(node, "body2")) else { return };
        let stated: Option<[f64; 7]> = self.reader.array(node, "relpose", &format!("`relpose` of `{name}`"));
        let anchor = self.reader.array(node, "anchor", &format!("the anchor of `{name}`")).unwrap_or_default();
        let anchor = Pose { shift: anchor, ..Pose::default() };
        let relative = match stated {
            Some([x, y, z, rest @ ..]) if norm(&rest) > 1e-12 => Pose::of_quaternion([x, y, z], rest),
            _ => at_rest(&self.robot, a).inverse().then(&at_rest(&self.robot, b)).then(&anchor),
        };
        self.welded(node, name, [a, b], [relative, anchor]);
    }

    /// Two frames; their origins alone where no torque holds them.
    fn welded(&mut self, node: Node<'a, 'i>, name: String, bodies: [Option<usize>; 2], poses: [Pose; 2]) {
        let scale = self.reader.number(node, "torquescale", &format!("`torquescale` of `{name}`"));
        self.held(name, bodies, poses, scale == Some(0.0));
    }

    /// Two frames that stay together, or their origins alone, where they `may_turn`.
    fn held(&mut self, name: String, bodies: [Option<usize>; 2], poses: [Pose; 2], may_turn: bool) {
        let coupling = match self.plainly_held(bodies, &poses, may_turn) {
            Some(Held::Always(why)) => {
                let note = format!("The equality `{}` holds always, {why}, and is left out.", shown(&name));
                return self.robot.notes.push(note);
            }
            Some(Held::By(first)) => {
                let note = format!("The equality `{}` holds the joint `{}`.", shown(&name), shown(&first));
                self.robot.notes.push(note);
                Coupling::Joints { name, first, second: None, powers: [0.0; 5] }
            }
            None if may_turn => Coupling::Points { name, bodies, points: poses.map(|pose| pose.shift) },
            None => Coupling::Frames { name, bodies, poses },
        };
        self.robot.couplings.push(coupling);
    }

    /// Where frames that fall together at rest have one joint of one axis between them, or none, most of their rows
    /// follow from one row, or from nothing.
    fn plainly_held(&self, bodies: [Option<usize>; 2], poses: &[Pose; 2], may_turn: bool) -> Option<Held> {
        let [first, second] = [0, 1].map(|i| at_rest(&self.robot, bodies[i]).then(&poses[i]));
        let is_turned = first.turn.iter().zip(second.turn).any(|(a, b)| !is_near(*a, b));
        if !is_near(first.shift, second.shift) || is_turned && !may_turn {
            return None;
        }
        let between = self.between(bodies);
        let mut joints =
            between.iter().flat_map(|&body| self.robot.bodies[body].joints.iter().map(move |joint| (body, joint)));
        let Some((body, joint)) = joints.next() else {
            return Some(Held::Always("no joint being between".to_string()));
        };
        if joints.next().is_some() || !matches!(joint.kind, Kind::Hinge | Kind::Slide) {
            return None;
        }
        let of = at_rest(&self.robot, Some(body));
        let (from, axis) = (of.point(joint.anchor), turned(&of.turn, joint.axis));
        let along: f64 = (0..3).map(|i| (first.shift[i] - from[i]) * axis[i]).sum::<f64>() / norm(&axis).powi(2);
        let is_on_axis = is_near(first.shift, plus(from, axis.map(|c| along * c)));
        if may_turn && joint.kind == Kind::Hinge && is_on_axis {
            return Some(Held::Always(format!("its point being on the axis of the joint `{}`", shown(&joint.name))));
        }
        Some(Held::By(joint.name.clone()))
    }

    /// The bodies on the way from one to the other, without the one that both hang on.
    fn between(&self, [a, b]: [Option<usize>; 2]) -> BTreeSet<usize> {
        let chain = |body| std::iter::successors(body, |&body: &usize| self.robot.bodies[body].parent).collect();
        let (a, b): (BTreeSet<usize>, BTreeSet<usize>) = (chain(a), chain(b));
        a.symmetric_difference(&b).copied().collect()
    }

    fn powers(&mut self, node: Node<'a, 'i>, name: &str) -> Option<[f64; 5]> {
        let Some(text) = node.attribute("polycoef") else { return Some([0.0, 1.0, 0.0, 0.0, 0.0]) };
        let numbers = self.reader.numbers(text, place(node, "polycoef"), &format!("`polycoef` of `{name}`"))?;
        // What is not stated keeps its default.
        Some(std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(if k == 1 { 1.0 } else { 0.0 })))
    }

    fn named_joint(&mut self, node: Node<'a, 'i>, attribute: &str) -> Option<String> {
        let name = node.attribute(attribute)?;
        if !self.joints.contains(name) {
            self.reader.refuse(place(node, attribute), format!("there is no joint `{name}`"), "");
            return None;
        }
        Some(name.to_string())
    }

    fn coupled_joints(&mut self, node: Node<'a, 'i>, name: String) {
        let Some(powers) = self.powers(node, &name) else { return };
        if self.reader.wanted(node, "joint1", &format!("the equality `{name}`")).is_none() {
            return;
        }
        let Some(first) = self.named_joint(node, "joint1") else { return };
        let second = self.named_joint(node, "joint2");
        if second.is_none() && node.has_attribute("joint2") {
            return;
        }
        self.robot.couplings.push(Coupling::Joints { name, first, second, powers });
    }

    fn coupled_tendons(&mut self, node: Node<'a, 'i>, name: String, tendons: &BTreeMap<String, Option<Terms>>) {
        let Some(powers) = self.powers(node, &name) else { return };
        let mut terms = Terms::new();
        for (attribute, factor) in [("tendon1", 1.0), ("tendon2", -powers[1])] {
            let Some(tendon) = node.attribute(attribute) else { continue };
            match tendons.get(tendon) {
                Some(Some(own)) => {
                    terms.extend(own.iter().map(|(coefficient, joint)| (factor * coefficient, joint.clone())))
                }
                Some(None) => {
                    let message =
                        format!("the equality `{name}` is about the spatial tendon `{tendon}`, which is not imported");
                    return self.reader.refuse(
                        place(node, attribute),
                        message,
                        "write it as a constraint beside the import",
                    );
                }
                None => {
                    return self.reader.refuse(place(node, attribute), format!("there is no tendon `{tendon}`"), "");
                }
            }
        }
        if node.has_attribute("tendon2") && powers[2..].iter().any(|&power| power != 0.0) {
            let message = format!("the equality `{name}` couples tendons by more than a factor");
            return self.reader.refuse(place(node, "polycoef"), message, "write it as a constraint beside the import");
        }
        if terms.is_empty() {
            return self.reader.refuse(tag(node), format!("the equality `{name}` has no `tendon1`"), "");
        }
        self.robot.couplings.push(Coupling::Sum { name, terms, offset: powers[0] });
    }

    /// All tendons; of spatial ones no terms.
    fn tendons(&mut self, root: Node<'a, 'i>) -> BTreeMap<String, Option<Terms>> {
        let mut all = BTreeMap::new();
        let nodes: Vec<_> =
            children(root, "tendon").flat_map(|node| node.children().filter(Node::is_element)).collect();
        let named: BTreeSet<&str> = nodes.iter().filter_map(|node| node.attribute("name")).collect();
        for (count, node) in (1..).zip(nodes) {
            let kind = node.tag_name().name();
            let name = node.attribute("name").map_or_else(
                || spare(&format!("tendon_{count}"), |name| named.contains(name) || all.contains_key(name)),
                str::to_string,
            );
            if all.contains_key(&name) {
                let message = format!("a second tendon is called `{name}`");
                self.reader.refuse(place(node, "name"), message, "names are unique");
            }
            self.settings.check_class(node, "class", self.reader);
            let class = self.settings.main.clone();
            let holder = |what: &str| self.settings.holder(node, "tendon", &class, what);
            let of = |what: &str| format!("`{what}` of the tendon `{name}`");
            let [stiffness, damping] = [("stiffness", &SPRINGS), ("damping", &DAMPERS)].map(|(what, flags)| {
                let is_off = self.settings.is_disabled(flags);
                linear(holder(what), what, &of(what), is_off, self.reader).unwrap_or(0.0)
            });
            let [armature, friction] = ["armature", "frictionloss"]
                .map(|what| self.reader.number(holder(what), what, &of(what)).unwrap_or(0.0));
            if stiffness < 0.0 || damping < 0.0 {
                let message = format!("the tendon `{name}` has negative stiffness or damping");
                self.reader.refuse(tag(node), message, "");
            }
            if friction != 0.0 {
                self.robot.notes.push(format!("Dry friction of the tendon `{name}` is left out."));
            }
            if armature != 0.0 || kind != "fixed" && (stiffness != 0.0 || damping != 0.0) {
                let message = format!("the tendon `{name}` has forces that are not imported");
                self.reader.refuse(
                    tag(node),
                    message,
                    "only springs and dampers of `fixed` tendons are: write the others as energies",
                );
                continue;
            }
            if kind != "fixed" {
                self.robot.notes.push(format!("The tendon `{name}`, without a force of its own, is left out."));
                all.insert(name, None);
                continue;
            }
            let mut terms = Terms::new();
            let joints: Vec<_> = children(node, "joint").collect();
            for &joint in &joints {
                let part = format!("a joint of the tendon `{name}`");
                if ["joint", "coef"].iter().any(|of| self.reader.wanted(joint, of, &part).is_none()) {
                    continue;
                }
                let coefficient = self.reader.number(joint, "coef", &format!("a factor of the tendon `{name}`"));
                if let (Some(coefficient), Some(of)) = (coefficient, self.named_joint(joint, "joint")) {
                    terms.push((coefficient, of));
                }
            }
            if joints.is_empty() {
                let help = "name one in it: `<joint joint=\"…\" coef=\"1\"/>`";
                self.reader.refuse(tag(node), format!("the tendon `{name}` is along no joint"), help);
            }
            if stiffness != 0.0 || damping != 0.0 {
                let rest = self.rest(node, &name, &terms);
                let spring =
                    Coupling::Spring { name: format!("{name}_spring"), terms: terms.clone(), stiffness, rest, damping };
                self.robot.couplings.push(spring);
            }
            all.insert(name, Some(terms));
        }
        all
    }

    /// Where the spring of a tendon is relaxed: as stated, or where the springs of its joints are.
    fn rest(&mut self, node: Node<'a, 'i>, name: &str, terms: &Terms) -> f64 {
        let holder = self.settings.holder(node, "tendon", &self.settings.main.clone(), "springlength");
        let stated = holder.attribute("springlength").and_then(|text| {
            self.reader.numbers(text, place(holder, "springlength"), &format!("`springlength` of the tendon `{name}`"))
        });
        match stated.as_deref() {
            // MuJoCo takes these numbers alone, not all negative ones, for what the springs of the joints say.
            Some([first, others @ ..]) if *first != -1.0 || others.iter().any(|other| *other != -1.0) => {
                if others.iter().any(|other| other != first) {
                    let message = format!("the spring of the tendon `{name}` has a dead zone, which is not imported");
                    self.reader.refuse(place(holder, "springlength"), message, "");
                }
                *first
            }
            _ => {
                let relaxed = |joint: &str| {
                    let mut joints = self.robot.bodies.iter().flat_map(|body| &body.joints);
                    joints.find(|other| other.name == joint).map_or(0.0, |other| other.rest)
                };
                terms.iter().map(|(factor, joint)| factor * relaxed(joint)).sum()
            }
        }
    }
}
