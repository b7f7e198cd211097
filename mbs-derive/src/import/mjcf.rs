//! MJCF, the format of MuJoCo.
//!
//! - `class`: defaults, settings of the compiler, attitudes; `geom`: what geoms weigh and look like;
//! - `equality`: constraints and tendons.
//!
//! Source: MuJoCo documentation, *XML reference*, and its `src/user/` for what the documentation leaves open.

mod class;
mod equality;
mod geom;

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::identifier::spare;
use super::pose::{Pose, raised_inertia, transposed, turned, turned_inertia};
use super::robot::{Body, Inertial, Joint, Kind, Robot};
use super::urdf::together;
use super::xml::{Reader, child, children, place, tag};
use crate::numeric::moments::{Impossible, principal_moments};
use class::{ATTITUDES, BOOLEANS, DAMPERS, FRICTION, SPRINGS, Settings};

/// A file while it is read.
struct File<'a, 'i, 'r> {
    settings: Settings<'a, 'i>,
    robot: Robot,
    /// Bodies by their names.
    bodies: BTreeMap<String, usize>,
    joints: BTreeSet<String>,
    /// The names that bodies and joints have in the file, each with its kind: other names give way.
    named: BTreeSet<(&'static str, String)>,
    /// Of each site its body and where it is.
    sites: BTreeMap<String, (Option<usize>, Pose)>,
    reader: &'r mut Reader,
}

/// What is open around an element.
#[derive(Clone)]
struct Around {
    body: Option<usize>,
    /// The class of what names none.
    class: String,
    /// Frames of the file within the body.
    frame: Pose,
}

/// A robot; what is wrong is noted.
pub(super) fn robot<'a, 'i>(root: Node<'a, 'i>, reader: &mut Reader) -> Option<Robot> {
    for node in root.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        let help = match name {
            "include" => "paste the file in, or save the model from MuJoCo by `mj_saveLastXML`",
            "replicate" | "attach" => "save the model from MuJoCo by `mj_saveLastXML`, which writes it out",
            "composite" | "flexcomp" | "flex" | "deformable" => {
                "import the rigid bodies, and write the rest as energies"
            }
            "plugin" if node.parent().is_some_and(|parent| parent.tag_name().name() == "body") => {
                "write it as energies"
            }
            _ => continue,
        };
        reader.refuse(tag(node), format!("`{name}` is not imported"), help);
    }
    let settings = Settings::of(root, reader);
    if reader.errors.has_errors() {
        return None;
    }
    let name = root.attribute("model").unwrap_or("MuJoCo model").to_string();
    let mut file = File {
        robot: Robot { name, gravity: settings.gravity, ..Robot::default() },
        settings,
        bodies: BTreeMap::new(),
        joints: BTreeSet::new(),
        named: named(root),
        sites: BTreeMap::new(),
        reader,
    };
    let around = Around { body: None, class: file.settings.main.clone(), frame: Pose::default() };
    let mut stack: Vec<(Node<'a, 'i>, Around)> = Vec::new();
    for world in children(root, "worldbody").collect::<Vec<_>>() {
        for (element, around) in file.within(world, around.clone()) {
            match element.tag_name().name() {
                "body" => stack.push((element, around)),
                "site" => file.site(element, &around),
                _ => {}
            }
        }
    }
    stack.reverse();
    // The last one is next, so that bodies stand in the order of the file, each behind its parent.
    while let Some((node, around)) = stack.pop() {
        let mut below = Vec::new();
        file.body(node, &around, &mut below);
        stack.extend(below.into_iter().rev());
    }
    file.equalities(root);
    let left_out: Vec<&str> = ["actuator", "sensor", "contact", "keyframe", "custom", "extension", "size", "visual"]
        .into_iter()
        .filter(|name| child(root, name).is_some())
        .collect();
    if !left_out.is_empty() {
        file.robot.notes.push(format!(
            "Left out: {}. Joints of one axis and ball joints have an input, whatever drives them in the file.",
            left_out.join(", ")
        ));
    }
    Some(file.robot)
}

impl<'a, 'i> File<'a, 'i, '_> {
    /// What stands in an element, in the order of the document, with what is around it: frames are gone through.
    fn within(&mut self, node: Node<'a, 'i>, around: Around) -> Vec<(Node<'a, 'i>, Around)> {
        let mut found = Vec::new();
        let mut waiting = vec![(node, around)];
        while let Some((element, around)) = waiting.pop() {
            let inside = match element.tag_name().name() {
                _ if element == node => around,
                "frame" => {
                    self.settings.check_class(element, "childclass", self.reader);
                    let class = element.attribute("childclass").unwrap_or(&around.class).to_string();
                    let pose = self.settings.pose(element, &around.class, "frame", self.reader);
                    Around { class, frame: around.frame.then(&pose), ..around }
                }
                _ => {
                    found.push((element, around));
                    continue;
                }
            };
            let elements = element.children().rev().filter(Node::is_element);
            waiting.extend(elements.map(|element| (element, inside.clone())));
        }
        found
    }

    fn site(&mut self, node: Node<'a, 'i>, around: &Around) {
        let holder = self.settings.holder(node, "site", &around.class, "fromto");
        let of = "the ends of a site";
        let pose = match self.reader.array(holder, "fromto", of) {
            // Its z is along the way back, as MuJoCo has it.
            Some([a, b, c, d, e, f]) => {
                geom::between(holder, [d, e, f, a, b, c], of, self.reader).map(|(pose, _)| pose).unwrap_or_default()
            }
            None => self.settings.pose(node, &around.class, "site", self.reader),
        };
        if let Some(name) = node.attribute("name") {
            self.sites.insert(name.to_string(), (around.body, around.frame.then(&pose)));
        }
    }

    fn body(&mut self, node: Node<'a, 'i>, around: &Around, below: &mut Vec<(Node<'a, 'i>, Around)>) {
        let number = self.robot.bodies.len();
        let name = node.attribute("name").map_or_else(
            || spare(&format!("body_{}", number + 1), |name| self.named.contains(&("body", name.to_string()))),
            str::to_string,
        );
        if self.bodies.insert(name.clone(), number).is_some() {
            self.reader.refuse(place(node, "name"), format!("a second body is called `{name}`"), "names are unique");
        }
        let class = node.attribute("childclass").unwrap_or(&around.class).to_string();
        self.settings.check_class(node, "childclass", self.reader);
        let own = self.settings.pose(node, &around.class, "body", self.reader);
        let pose = around.frame.then(&own);
        let mut body = Body { parent: around.body, pose, ..Body::new(&name, tag(node)) };
        if self.reader.word(node, "mocap", &BOOLEANS) == Some("true") {
            body.is_held = true;
            body.notes.push("A mocap body: it stands where the file has it.".to_string());
        }
        if let Some(lifted) = self.reader.number(node, "gravcomp", "`gravcomp`").filter(|lifted| *lifted != 0.0) {
            let message = format!("the body `{name}` is lifted by `gravcomp` of {lifted}, which is not imported");
            self.reader.refuse(
                place(node, "gravcomp"),
                message,
                "leave it out, and write it as a force beside the import",
            );
        }
        let (mut masses, mut stated) = (Vec::new(), None);
        for (element, around) in self.within(node, Around { body: Some(number), class, frame: Pose::default() }) {
            match element.tag_name().name() {
                "joint" | "freejoint" => self.joint(element, &around, &mut body),
                "geom" => masses.extend(self.geom(element, &around, &mut body)),
                // Of several the last one counts.
                "inertial" => stated = Some((element, around)),
                "site" => self.site(element, &around),
                "body" => below.push((element, around)),
                _ => {}
            }
        }
        let stated = self.inertial(&name, masses, stated);
        self.give_mass(&mut body, stated, own.shift);
        if body.joints.len() > 1 && body.joints.iter().any(|joint| joint.kind == Kind::Free) {
            self.reader.refuse(
                tag(node),
                format!("the body `{name}` has a free joint beside others"),
                "a free joint stands alone",
            );
        }
        if around.body.is_some() && body.joints.iter().any(|joint| joint.kind == Kind::Free) {
            self.reader.refuse(
                tag(node),
                format!("the body `{name}` hangs on another one by a free joint"),
                "free bodies stand in the world",
            );
        }
        self.robot.bodies.push(body);
    }

    /// What the body weighs: as stated, or by its geoms.
    fn inertial(
        &mut self,
        name: &str,
        masses: Vec<(Option<Inertial>, Node<'a, 'i>)>,
        stated: Option<(Node<'a, 'i>, Around)>,
    ) -> Option<Inertial> {
        let by_geoms = match self.settings.inertia_from_geom {
            "true" => !masses.is_empty() || stated.is_none(),
            "false" => false,
            _ => stated.is_none(),
        };
        if by_geoms {
            let mut known = Vec::new();
            for (mass, geom) in masses {
                match mass {
                    Some(mass) => known.push(mass),
                    None => {
                        let message = format!("the body `{name}` has the mass of a mesh, which is not known here");
                        let help =
                            "write an `<inertial>` for the body, or save the model from MuJoCo by `mj_saveLastXML`";
                        self.reader.refuse(tag(geom), message, help);
                        return None;
                    }
                }
            }
            together(&known)
        } else {
            stated.and_then(|(inertial, around)| self.stated(inertial, &around.frame, name))
        }
    }

    /// What the body weighs, and at least what the compiler asks for. Where the file gives a body no mass, MuJoCo puts
    /// that of `boundmass` at the `pos` of its element, read in the frame of the body.
    fn give_mass(&self, body: &mut Body, stated: Option<Inertial>, pos: [f64; 3]) {
        let Settings { bound_mass, bound_inertia, .. } = self.settings;
        let is_bounded = bound_mass > 0.0 || bound_inertia > 0.0;
        if stated.is_none() && bound_mass > 0.0 && pos != [0.0; 3] {
            let note = "Its mass is that of `boundmass`, placed as by MuJoCo: at its `pos`, in its own frame.";
            body.notes.push(note.to_string());
        }
        let nothing = Inertial { mass: 0.0, com: pos, inertia: [0.0; 6], span: body.span.clone() };
        let inertial = stated.or(is_bounded.then_some(nothing));
        body.inertial = inertial.map(|inertial| bounded(inertial, bound_mass, bound_inertia));
    }

    fn stated(&mut self, node: Node<'a, 'i>, frame: &Pose, name: &str) -> Option<Inertial> {
        let of = format!("the inertial of the body `{name}`");
        let pose = frame.then(&self.settings.pose(node, "", "inertial", self.reader));
        self.reader.wanted(node, "mass", &of)?;
        let mass = self.reader.number(node, "mass", &format!("the mass of the body `{name}`"))?;
        let what = format!("the inertia of the body `{name}`");
        if let Some(way) = ATTITUDES.iter().chain(&["diaginertia"]).find(|way| node.has_attribute(**way))
            && node.has_attribute("fullinertia")
        {
            let message = format!("{of} has `{way}` beside `fullinertia`, which MuJoCo does not take");
            let help =
                "`fullinertia` is in the axes of the body: leave out the other, or state `diaginertia` in turned ones";
            self.reader.refuse(place(node, way), message, help);
        }
        let entries = match (node.attribute("fullinertia"), node.attribute("diaginertia")) {
            (Some(_), _) => self.reader.array::<6>(node, "fullinertia", &what)?,
            (None, Some(_)) => {
                let [xx, yy, zz] = self.reader.array(node, "diaginertia", &what)?;
                [xx, yy, zz, 0.0, 0.0, 0.0]
            }
            (None, None) => {
                self.reader.refuse(tag(node), format!("{of} has no inertia"), "write `diaginertia` or `fullinertia`");
                return None;
            }
        };
        Some(Inertial { mass, com: pose.shift, inertia: turned_inertia(&pose.turn, entries), span: tag(node) })
    }

    fn joint(&mut self, node: Node<'a, 'i>, around: &Around, body: &mut Body) {
        let is_free = node.tag_name().name() == "freejoint";
        let class = node.attribute("class").unwrap_or(&around.class).to_string();
        self.settings.check_class(node, "class", self.reader);
        let (settings, reader) = (&self.settings, &mut *self.reader);
        let holder = |name: &str| if is_free { node } else { settings.holder(node, "joint", &class, name) };
        let name = node.attribute("name").map_or_else(
            || {
                let number = if body.joints.is_empty() { String::new() } else { format!("_{}", body.joints.len() + 1) };
                spare(&format!("{}_joint{number}", body.name), |name| {
                    self.named.contains(&("joint", name.to_string())) || self.joints.contains(name)
                })
            },
            str::to_string,
        );
        let word = if is_free { "free" } else { holder("type").attribute("type").unwrap_or("hinge") };
        let kind = match word {
            "hinge" => Kind::Hinge,
            "slide" => Kind::Slide,
            "ball" => Kind::Ball,
            "free" => Kind::Free,
            _ => {
                let message = format!("the joint `{name}` is of an unknown kind, `{word}`");
                reader.refuse(place(node, "type"), message, "there are `hinge`, `slide`, `ball` and `free`");
                return;
            }
        };
        if !self.joints.insert(name.clone()) {
            reader.refuse(place(node, "name"), format!("a second joint is called `{name}`"), "names are unique");
        }
        let mut joint = Joint::new(&name, kind, word, tag(node));
        let of = |what: &str| format!("{what} of the joint `{name}`");
        if kind != Kind::Free {
            joint.anchor = reader.array(holder("pos"), "pos", &of("the place")).unwrap_or_default();
            joint.anchor = around.frame.point(joint.anchor);
            joint.axis = reader.array(holder("axis"), "axis", &of("the axis")).unwrap_or([0.0, 0.0, 1.0]);
            joint.axis = turned(&around.frame.turn, joint.axis);
        }
        let angle = if kind == Kind::Hinge { settings.angle } else { 1.0 };
        let mut first = |name: &str, what: &str, flags: &[&str]| {
            linear(holder(name), name, &of(what), settings.is_disabled(flags), reader).unwrap_or(0.0)
        };
        joint.armature = first("armature", "the armature", &[]);
        joint.damping = first("damping", "the damping", &DAMPERS);
        joint.stiffness = first("stiffness", "the stiffness", &SPRINGS);
        joint.friction = first("frictionloss", "the friction", &FRICTION);
        joint.zero = first("ref", "`ref`", &[]) * angle;
        joint.rest = first("springref", "`springref`", &[]) * angle;
        if [joint.damping, joint.stiffness, joint.armature, joint.friction].iter().any(|&number| number < 0.0) {
            reader.refuse(
                tag(node),
                format!("the joint `{name}` has negative damping, stiffness, armature or friction"),
                "",
            );
        }
        let tuned = holder("springdamper");
        if let Some([time, ratio]) = reader.array::<2>(tuned, "springdamper", &of("`springdamper`"))
            && (time, ratio) != (0.0, 0.0)
        {
            let message = format!("the joint `{name}` has its spring by `springdamper`, which is not imported");
            let help = "write `stiffness` and `damping`: `mj_saveLastXML` of MuJoCo gives their values";
            reader.refuse(place(tuned, "springdamper"), message, help);
        }
        if kind != Kind::Free
            && let Some([low, high]) = reader.array::<2>(holder("range"), "range", &of("the range"))
            && reader.word(holder("limited"), "limited", &["auto", "true", "false"]) != Some("false")
        {
            let angle = if kind == Kind::Slide { 1.0 } else { settings.angle };
            let way = if kind == Kind::Slide { "m" } else { "rad" };
            joint.limits = format!("from {} to {} {way}", low * angle, high * angle);
        }
        body.joints.push(joint);
    }
}

/// The factor of a force: of several numbers, which are those of a polynomial, the first one where the others are zero.
/// Nothing acts where the file turns the force off; what is negative stays so, and is refused.
fn linear(holder: Node<'_, '_>, name: &str, what: &str, is_off: bool, reader: &mut Reader) -> Option<f64> {
    let numbers = reader.numbers(holder.attribute(name)?, place(holder, name), what)?;
    if !is_off && numbers.iter().skip(1).any(|&number| number != 0.0) {
        let help = "write it as an energy beside the import";
        reader.refuse(place(holder, name), format!("{what} is not linear"), help);
    }
    numbers.first().map(|&number| if is_off && number > 0.0 { 0.0 } else { number })
}

/// A turn by three angles about axes `xyz`, about those that turn along, or `XYZ`, about those that stay.
fn of_euler(sequence: &str, angles: [f64; 3]) -> Pose {
    let mut pose = Pose::default();
    for (axis, angle) in sequence.chars().zip(angles) {
        let number = match axis.to_ascii_lowercase() {
            'x' => 0,
            'y' => 1,
            _ => 2,
        };
        let mut rpy = [0.0; 3];
        rpy[number] = angle;
        let turn = Pose::of_rpy([0.0; 3], rpy);
        pose = if axis.is_ascii_lowercase() { pose.then(&turn) } else { turn.then(&pose) };
    }
    pose
}

/// A turn by the axes that x and y are turned to.
fn of_axes([a, b, c, d, e, f]: [f64; 6]) -> Option<Pose> {
    let length = super::pose::norm(&[a, b, c]);
    let x = [a, b, c].map(|v| v / length);
    let along = d * x[0] + e * x[1] + f * x[2];
    let rest = [d - along * x[0], e - along * x[1], f - along * x[2]];
    let size = super::pose::norm(&rest);
    let y = rest.map(|v| v / size);
    let z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    let turn = transposed(&[x, y, z]);
    (length > 1e-12 && size > 1e-12).then(|| Pose::of_turn([0.0; 3], turn))
}

/// The names of bodies and joints that the file gives.
fn named(root: Node<'_, '_>) -> BTreeSet<(&'static str, String)> {
    let mut names = BTreeSet::new();
    for element in root.descendants().filter(Node::is_element) {
        let kind = match element.tag_name().name() {
            "body" => "body",
            "joint" | "freejoint" => "joint",
            _ => continue,
        };
        names.extend(element.attribute("name").map(|name| (kind, name.to_string())));
    }
    names
}

/// At least the mass and the principal moments that `boundmass` and `boundinertia` ask for. What is negative stays so,
/// and is refused.
fn bounded(inertial: Inertial, least_mass: f64, least_moment: f64) -> Inertial {
    let [xx, yy, zz, xy, xz, yz] = inertial.inertia;
    let moments = principal_moments(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    let is_negative = inertial.mass < 0.0 || moments.and_then(Impossible::of) == Some(Impossible::Negative);
    if is_negative {
        return inertial;
    }
    let raised = raised_inertia(inertial.inertia, least_moment);
    Inertial {
        mass: inertial.mass.max(least_mass),
        inertia: if least_moment > 0.0 { raised } else { inertial.inertia },
        ..inertial
    }
}
