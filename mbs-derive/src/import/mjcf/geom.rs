//! Geoms: what they weigh, and what they look like.

use std::f64::consts::PI;

use roxmltree::Node;

use super::super::identifier::shown;
use super::super::pose::{Pose, from_z, norm, turned_inertia};
use super::super::robot::{Body, Form, Inertial, Shape};
use super::super::xml::{Reader, place, tag};
use super::class::BOOLEANS;
use super::{Around, File};

/// kg/m³, where a geom states neither density nor mass.
const WATER: f64 = 1000.0;

/// Geoms of later groups are not drawn by default: those of collisions.
const LAST_DRAWN: f64 = 2.0;

impl<'a, 'i> File<'a, 'i, '_> {
    /// Notes what a geom looks like; answers what it weighs, nothing within where only its mesh says so.
    pub(super) fn geom(
        &mut self,
        node: Node<'a, 'i>,
        around: &Around,
        body: &mut Body,
    ) -> Option<(Option<Inertial>, Node<'a, 'i>)> {
        let class = node.attribute("class").unwrap_or(&around.class).to_string();
        self.settings.check_class(node, "class", self.reader);
        let holder = |name: &str| self.settings.holder(node, "geom", &class, name);
        let reader = &mut *self.reader;
        let of = |what: &str| format!("the {what} of a geom of the body `{}`", body.name);
        let kind = holder("type").attribute("type").unwrap_or("sphere");
        let holds_size = holder("size");
        // What a short list leaves out is that of the next default.
        let mut known = Vec::new();
        for node in self.settings.stating(node, "geom", &class) {
            let Some(text) = node.attribute("size") else { continue };
            let numbers = reader.numbers(text, place(node, "size"), &of("size"))?;
            known.extend(numbers.into_iter().skip(known.len()));
        }
        let mut size: [f64; 3] = std::array::from_fn(|i| known.get(i).copied().unwrap_or(0.0));
        let mut pose = self.settings.pose(node, &class, "geom", reader);
        if let Some(ends) = reader.array::<6>(holder("fromto"), "fromto", &of("ends")) {
            let length;
            (pose, length) = between(holder("fromto"), ends, &of("ends"), reader)?;
            match kind {
                "capsule" | "cylinder" => size[1] = length / 2.0,
                _ => size = [size[0], size[0], length / 2.0],
            }
        }
        let pose = around.frame.then(&pose);
        let group = reader.number(holder("group"), "group", &of("group")).unwrap_or(0.0);
        let mass = reader.number(holder("mass"), "mass", &of("mass"));
        let density = reader.number(holder("density"), "density", &of("density")).unwrap_or(WATER);
        for (what, value, unit) in [("mass", mass, "kg"), ("density", Some(density), "kg/m³")] {
            if let Some(value) = value.filter(|value| *value < 0.0) {
                let message = format!("{} is negative: {value} {unit}", of(what));
                reader.refuse(place(holder(what), what), message, "");
            }
        }
        if reader.word(holder("shellinertia"), "shellinertia", &BOOLEANS) == Some("true") {
            reader.refuse(
                place(holder("shellinertia"), "shellinertia"),
                "`shellinertia` is not imported",
                "write an `<inertial>`",
            );
        }
        let is_mesh = matches!(kind, "mesh" | "sdf");
        let is_fitted = !is_mesh && holder("mesh").has_attribute("mesh");
        let sizes = match kind {
            "sphere" => 1,
            "capsule" | "cylinder" => 2,
            "box" | "ellipsoid" => 3,
            _ => 0,
        };
        if !is_fitted && size[..sizes].iter().any(|&size| size <= 0.0) {
            let help = "a sphere has one number, a capsule and a cylinder have two, a box and an ellipsoid three";
            reader.refuse(place(holds_size, "size"), format!("{} is not positive", of("size")), help);
            return None;
        }
        let form = match kind {
            _ if is_fitted => None,
            "sphere" => Some(Form::Sphere(size[0])),
            "capsule" => Some(Form::Capsule(size[0], 2.0 * size[1])),
            "cylinder" => Some(Form::Cylinder(size[0], 2.0 * size[1])),
            "box" => Some(Form::Box(size.map(|half| 2.0 * half))),
            "mesh" => self.mesh(holder("mesh"), &body.name),
            "ellipsoid" | "plane" | "hfield" | "sdf" => None,
            _ => {
                let message = format!("a geom of the body `{}` is of an unknown kind, `{kind}`", body.name);
                reader.refuse(place(holder("type"), "type"), message, "");
                return None;
            }
        };
        if group <= LAST_DRAWN {
            match form {
                Some(form) => body.shapes.push(Shape { form, pose }),
                None if is_fitted => body.notes.push("A geom that is fitted to a mesh is not drawn.".to_string()),
                None if kind == "ellipsoid" => body.notes.push("An ellipsoid is not drawn.".to_string()),
                None => {}
            }
        }
        let [low, high] = self.settings.groups;
        if !(low..=high).contains(&group) || mass == Some(0.0) || mass.is_none() && density == 0.0 {
            return None;
        }
        if is_mesh || is_fitted {
            return Some((None, node));
        }
        let [a, b, c] = size;
        let per_mass = |x: f64, y: f64, z: f64| [x, y, z, 0.0, 0.0, 0.0];
        let (volume, unit) = match kind {
            "sphere" => (4.0 / 3.0 * PI * a.powi(3), per_mass(0.4 * a * a, 0.4 * a * a, 0.4 * a * a)),
            "ellipsoid" => {
                let of = |x: f64, y: f64| (x * x + y * y) / 5.0;
                (4.0 / 3.0 * PI * a * b * c, per_mass(of(b, c), of(a, c), of(a, b)))
            }
            "box" => {
                let of = |x: f64, y: f64| (x * x + y * y) / 3.0;
                (8.0 * a * b * c, per_mass(of(b, c), of(a, c), of(a, b)))
            }
            "cylinder" => {
                let (h, across) = (2.0 * b, a * a / 2.0);
                (PI * a * a * h, per_mass((3.0 * a * a + h * h) / 12.0, (3.0 * a * a + h * h) / 12.0, across))
            }
            "capsule" => {
                let h = 2.0 * b;
                let ball = 4.0 * a / (4.0 * a + 3.0 * h);
                let rod = 1.0 - ball;
                let across = rod * (3.0 * a * a + h * h) / 12.0 + ball * (0.4 * a * a + h * (3.0 * a + 2.0 * h) / 8.0);
                let along = rod * a * a / 2.0 + ball * 0.4 * a * a;
                (PI * a * a * h + 4.0 / 3.0 * PI * a.powi(3), per_mass(across, across, along))
            }
            _ => return None,
        };
        let mass = mass.unwrap_or(density * volume);
        let inertia = turned_inertia(&pose.turn, unit.map(|entry| mass * entry));
        Some((Some(Inertial { mass, com: pose.shift, inertia, span: tag(node) }), node))
    }

    /// The file of a mesh, from the folder of the model.
    fn mesh(&mut self, geom: Node<'a, 'i>, body: &str) -> Option<Form> {
        let name = geom.attribute("mesh")?;
        let Some(mesh) = self.settings.meshes.get(name) else {
            let message = format!("the mesh `{}` of the body `{body}` is not drawn", shown(name));
            self.reader.warn(place(geom, "mesh"), message, "no `mesh` of the assets has this name");
            return None;
        };
        let file = mesh.attribute("file")?;
        let path = match self.settings.mesh_folder.as_str() {
            "" => file.to_string(),
            folder => format!("{folder}/{file}"),
        };
        let numbers = mesh
            .attribute("scale")
            .map(|text| text.split_whitespace().map_while(|word| word.parse().ok()).collect::<Vec<f64>>());
        let scale = numbers.and_then(|numbers| numbers.try_into().ok()).unwrap_or([1.0; 3]);
        Some(Form::Mesh(path, scale, place(*mesh, "file")))
    }
}

/// Half way between two ends, with z from the first to the second, and how far they are apart.
pub(super) fn between(
    node: Node<'_, '_>,
    [a, b, c, d, e, f]: [f64; 6],
    ends: &str,
    reader: &mut Reader,
) -> Option<(Pose, f64)> {
    let way = [d - a, e - b, f - c];
    let length = norm(&way);
    if length < 1e-12 {
        reader.refuse(place(node, "fromto"), format!("{ends} fall together"), "");
        return None;
    }
    Some((Pose::of_turn([(a + d) / 2.0, (b + e) / 2.0, (c + f) / 2.0], from_z(way)), length))
}
