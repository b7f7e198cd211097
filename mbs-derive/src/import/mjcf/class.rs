//! Defaults by classes, settings of the compiler, and attitudes, of which the format has five ways.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::super::pose::{Pose, about, from_z, norm};
use super::super::xml::{Reader, children, place, tag};
use super::{of_axes, of_euler};

pub(super) const BOOLEANS: [&str; 2] = ["true", "false"];

/// The ways to state an attitude.
pub(super) const ATTITUDES: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Flags that turn off springs and dampers; older versions of MuJoCo have one for both, `passive`.
pub(super) const SPRINGS: [&str; 2] = ["spring", "passive"];
pub(super) const DAMPERS: [&str; 2] = ["damper", "passive"];
/// Flags that turn off dry friction, and equalities: as constraints they have a common one.
pub(super) const FRICTION: [&str; 2] = ["frictionloss", "constraint"];
pub(super) const EQUALITIES: [&str; 2] = ["equality", "constraint"];

/// What the whole file says of its elements.
pub(super) struct Settings<'a, 'i> {
    /// Radians of the file's unit of angles.
    pub(super) angle: f64,
    euler_sequence: String,
    pub(super) inertia_from_geom: &'static str,
    pub(super) groups: [f64; 2],
    pub(super) bound_mass: f64,
    pub(super) bound_inertia: f64,
    pub(super) gravity: [f64; 3],
    /// Flags that the file disables.
    disabled: BTreeSet<&'static str>,
    pub(super) mesh_folder: String,
    /// The class of elements that name none.
    pub(super) main: String,
    /// Of each class its elements `default`, the outermost first.
    classes: BTreeMap<String, Vec<Node<'a, 'i>>>,
    /// Of each mesh its element.
    pub(super) meshes: BTreeMap<String, Node<'a, 'i>>,
}

impl<'a, 'i> Settings<'a, 'i> {
    pub(super) fn of(root: Node<'a, 'i>, reader: &mut Reader) -> Self {
        let mut settings = Settings {
            angle: std::f64::consts::PI / 180.0,
            euler_sequence: "xyz".to_string(),
            inertia_from_geom: "auto",
            groups: [0.0, 5.0],
            bound_mass: 0.0,
            bound_inertia: 0.0,
            gravity: [0.0, 0.0, -9.81],
            disabled: BTreeSet::new(),
            mesh_folder: String::new(),
            main: "main".to_string(),
            classes: BTreeMap::new(),
            meshes: BTreeMap::new(),
        };
        let compilers: Vec<_> = children(root, "compiler").collect();
        compilers.into_iter().for_each(|compiler| settings.compiler(compiler, reader));
        for option in children(root, "option").collect::<Vec<_>>() {
            if let Some(gravity) = reader.array(option, "gravity", "gravity") {
                settings.gravity = gravity;
            }
            for fluid in ["density", "viscosity"] {
                if reader.number(option, fluid, fluid).is_some_and(|number| number != 0.0) {
                    let message = format!("forces of a medium, by `{fluid}`, are not imported");
                    reader.refuse(place(option, fluid), message, "leave it out, and write them beside the import");
                }
            }
            children(option, "flag").for_each(|flag| settings.flags(flag, reader));
        }
        if settings.is_disabled(&["gravity"]) {
            settings.gravity = [0.0; 3];
        }
        settings.read_classes(root, reader);
        for asset in children(root, "asset").collect::<Vec<_>>() {
            for mesh in children(asset, "mesh") {
                let file = mesh.attribute("file").unwrap_or_default();
                let stem = file.rsplit('/').next().unwrap_or(file);
                let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
                settings.meshes.insert(mesh.attribute("name").unwrap_or(stem).to_string(), mesh);
            }
        }
        settings
    }

    fn flags(&mut self, node: Node<'a, 'i>, reader: &mut Reader) {
        for name in ["gravity", "spring", "damper", "passive", "equality", "frictionloss", "constraint"] {
            match reader.word(node, name, &["enable", "disable"]) {
                Some("disable") => self.disabled.insert(name),
                Some(_) => self.disabled.remove(name),
                None => continue,
            };
        }
    }

    /// Whether the file disables one of these flags.
    pub(super) fn is_disabled(&self, flags: &[&str]) -> bool {
        flags.iter().any(|flag| self.disabled.contains(flag))
    }

    fn compiler(&mut self, node: Node<'a, 'i>, reader: &mut Reader) {
        match node.attribute("angle") {
            Some("radian") => self.angle = 1.0,
            Some("degree") => self.angle = std::f64::consts::PI / 180.0,
            Some(other) => reader.refuse(
                place(node, "angle"),
                format!("`{other}` is no unit of angles"),
                "there are `degree` and `radian`",
            ),
            None => {}
        }
        if node.attribute("coordinate").is_some_and(|word| word != "local") {
            let help = "MuJoCo has given them up: save the model by an older one, which writes local ones";
            reader.refuse(place(node, "coordinate"), "global coordinates are not imported", help);
        }
        if let Some(sequence) = node.attribute("eulerseq") {
            let good = sequence.len() == 3 && sequence.chars().all(|c| "xyzXYZ".contains(c));
            match good {
                true => self.euler_sequence = sequence.to_string(),
                false => reader.refuse(
                    place(node, "eulerseq"),
                    format!("`{sequence}` is no sequence of axes"),
                    "write three of `xyzXYZ`",
                ),
            }
        }
        if let Some(word) = reader.word(node, "inertiafromgeom", &["auto", "true", "false"]) {
            self.inertia_from_geom = word;
        }
        if let Some(groups) = reader.array(node, "inertiagrouprange", "`inertiagrouprange`") {
            self.groups = groups;
        }
        self.bound_mass = reader.number(node, "boundmass", "`boundmass`").unwrap_or(self.bound_mass);
        self.bound_inertia = reader.number(node, "boundinertia", "`boundinertia`").unwrap_or(self.bound_inertia);
        if reader.number(node, "settotalmass", "`settotalmass`").is_some_and(|mass| mass > 0.0) {
            let help = "save the model from MuJoCo by `mj_saveLastXML`, which writes the masses";
            reader.refuse(place(node, "settotalmass"), "`settotalmass` is not imported", help);
        }
        if reader.word(node, "balanceinertia", &BOOLEANS) == Some("true") {
            let help = "save the model from MuJoCo by `mj_saveLastXML`, which writes the inertias";
            reader.refuse(place(node, "balanceinertia"), "`balanceinertia` is not imported", help);
        }
        if let Some(folder) = node.attribute("meshdir").or(node.attribute("assetdir")) {
            self.mesh_folder = folder.trim_end_matches('/').to_string();
        }
    }

    fn read_classes(&mut self, root: Node<'a, 'i>, reader: &mut Reader) {
        let mut waiting: Vec<(Node<'a, 'i>, Option<Vec<Node<'a, 'i>>>)> =
            children(root, "default").map(|node| (node, None)).collect();
        if let Some((first, _)) = waiting.first() {
            self.main = first.attribute("class").unwrap_or("main").to_string();
        }
        self.classes.insert(self.main.clone(), Vec::new());
        // The last one is next: in the order of the file, whose later statements win.
        waiting.reverse();
        while let Some((node, outer)) = waiting.pop() {
            let is_outermost = outer.is_none();
            // A later section adds to what the main class says before it.
            let mut chain = outer.unwrap_or_else(|| self.classes[&self.main].clone());
            chain.push(node);
            let class = match node.attribute("class") {
                Some(class) => class.to_string(),
                None if is_outermost => self.main.clone(),
                None => {
                    reader.refuse(tag(node), "this class of defaults has no name", "write `<default class=\"…\">`");
                    continue;
                }
            };
            let inner: Vec<_> = children(node, "default").map(|inner| (inner, Some(chain.clone()))).collect();
            waiting.extend(inner.into_iter().rev());
            if class == self.main {
                self.classes.insert(class, chain);
            } else {
                self.classes.entry(class).or_default().extend(chain);
            }
        }
    }

    /// The class that an attribute of an element names is there.
    pub(super) fn check_class(&self, node: Node<'_, '_>, attribute: &str, reader: &mut Reader) {
        if let Some(class) = node.attribute(attribute).filter(|class| !self.classes.contains_key(*class)) {
            reader.refuse(place(node, attribute), format!("there is no class `{class}` of defaults"), "");
        }
    }

    /// What states attributes of an element: itself, then defaults of its class, the innermost first.
    pub(super) fn stating(
        &self,
        node: Node<'a, 'i>,
        element: &str,
        class: &str,
    ) -> impl Iterator<Item = Node<'a, 'i>> + use<'_, 'a, 'i> {
        let class = node.attribute("class").unwrap_or(class);
        let element = element.to_string();
        let chain = self.classes.get(class).into_iter().flatten().rev();
        let is_such = move |child: &Node<'a, 'i>| child.tag_name().name() == element;
        std::iter::once(node).chain(chain.flat_map(|default| default.children().rev()).filter(is_such))
    }

    /// Where an attribute of an element is stated: by itself, or by the innermost default of its class.
    pub(super) fn holder(&self, node: Node<'a, 'i>, element: &str, class: &str, attribute: &str) -> Node<'a, 'i> {
        self.stating(node, element, class).find(|stating| stating.has_attribute(attribute)).unwrap_or(node)
    }

    /// Place and attitude of an element.
    pub(super) fn pose(&self, node: Node<'a, 'i>, class: &str, element: &str, reader: &mut Reader) -> Pose {
        let holder = |name: &str| self.holder(node, element, class, name);
        let name = node.attribute("name").unwrap_or("");
        let of = |what: &str| {
            if name.is_empty() {
                format!("the {what} of this {element}")
            } else {
                format!("the {what} of the {element} `{name}`")
            }
        };
        let shift = reader.array(holder("pos"), "pos", &of("place")).unwrap_or_default();
        // An attitude of its own, whichever way it is stated, takes the place of that of a default.
        let states = |node: &Node<'_, '_>| ATTITUDES.iter().any(|way| node.has_attribute(*way));
        let stated = self.stating(node, element, class).find(states);
        let attitude = stated.and_then(|stating| self.attitude(stating, &of("attitude"), reader));
        Pose { shift, ..attitude.unwrap_or_default() }
    }

    /// The attitude that an element states, by one of the ways.
    fn attitude(&self, node: Node<'a, 'i>, what: &str, reader: &mut Reader) -> Option<Pose> {
        let zero = |name: &str, reader: &mut Reader| {
            reader.refuse(place(node, name), format!("{what} has no direction"), "");
            None
        };
        let ways: Vec<&str> = ATTITUDES.into_iter().filter(|way| node.has_attribute(*way)).collect();
        if let [first, second, ..] = ways.as_slice() {
            let help = format!("leave out `{first}` or `{second}`");
            reader.refuse(place(node, second), format!("{what} is stated twice"), &help);
        }
        match *ways.first()? {
            "quat" => {
                let quaternion: [f64; 4] = reader.array(node, "quat", what)?;
                if norm(&quaternion) < 1e-12 {
                    return zero("quat", reader);
                }
                Some(Pose::of_quaternion([0.0; 3], quaternion))
            }
            "axisangle" => {
                let [x, y, z, angle] = reader.array(node, "axisangle", what)?;
                if norm(&[x, y, z]) < 1e-12 {
                    return zero("axisangle", reader);
                }
                Some(Pose::of_turn([0.0; 3], about([x, y, z], angle * self.angle)))
            }
            "xyaxes" => {
                let axes = reader.array(node, "xyaxes", what)?;
                of_axes(axes).or_else(|| zero("xyaxes", reader))
            }
            "zaxis" => {
                let axis: [f64; 3] = reader.array(node, "zaxis", what)?;
                if norm(&axis) < 1e-12 {
                    return zero("zaxis", reader);
                }
                Some(Pose::of_turn([0.0; 3], from_z(axis)))
            }
            _ => {
                let angles: [f64; 3] = reader.array(node, "euler", what)?;
                Some(of_euler(&self.euler_sequence, angles.map(|angle| angle * self.angle)))
            }
        }
    }
}
