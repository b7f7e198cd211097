//! The motion as an animated glTF 2.0 binary: bodies by their shapes or as inertia ellipsoids, points as balls, lines
//! as rods.
//!
//! Axes are turned so that z is up on the screen, too; lengths are in metres and times in seconds, but motions of more
//! than two minutes, or of less than a tenth of a second, are shown in ten seconds.
//!
//! Source: Khronos Group, *glTF 2.0 Specification*, ISO/IEC 12113:2022.

use std::collections::BTreeMap;
use std::f32::consts::{FRAC_1_SQRT_2, PI};

use mbs_derive::interpret::State;
use nalgebra::{Unit, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::motion::Motion;
use crate::scene::mesh::{self, Triangles};
use crate::scene::{Body, Scene, Shape, Sight, ellipsoid};

/// Durations in seconds that are shown as they are, and what the others are shown in.
const SHOWN_AS_THEY_ARE: std::ops::RangeInclusive<f64> = 0.1..=120.0;
const SHOWN_IN: f64 = 10.0;

/// No more keys than screens show of a motion.
const MOST_KEYS: usize = 4000;

/// Colours of bodies, told apart by people who see fewer of them, too: as linear numbers.
const COLOURS: [[f64; 3]; 6] = [
    [0.07, 0.27, 0.63],
    [0.81, 0.24, 0.07],
    [0.05, 0.43, 0.19],
    [0.58, 0.37, 0.04],
    [0.35, 0.15, 0.55],
    [0.08, 0.48, 0.55],
];
const GREY: [f64; 3] = [0.28, 0.3, 0.33];

/// Rings and sectors of a sphere, sectors of a rod.
const RINGS: usize = 16;
const SECTORS: usize = 24;

/// `FLOAT`, `UNSIGNED_INT`, `ARRAY_BUFFER`, `ELEMENT_ARRAY_BUFFER`
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// By how much times are divided, where they are not shown as they are.
pub(crate) fn slowdown(duration: f64) -> Option<f64> {
    (duration > 0.0 && !SHOWN_AS_THEY_ARE.contains(&duration)).then_some(duration / SHOWN_IN)
}

/// The file. States are those of the motion's rows.
pub(crate) fn glb(
    (scene, meshes): (&Scene, &BTreeMap<usize, Triangles>),
    parameters: &[f64],
    motion: &Motion,
    state_of: impl Fn(usize) -> State,
) -> Vec<u8> {
    let keys = keys(motion);
    let interpreter = scene.interpreter(parameters);
    let sights: Vec<Sight> = keys.iter().map(|&(row, _)| scene.at(&interpreter, &state_of(row))).collect();
    let size = extent(&sights);
    let mut file = File::default();
    let sphere = file.form("sphere", sphere);
    let rod = file.form("rod", cylinder);
    let times: Vec<f32> = keys.iter().map(|&(_, time)| time).collect();
    let times = file.numbers(&times, 1, "SCALAR", None);

    let heaviest = sights[0].bodies.iter().fold(0.0_f64, |most, body| most.max(body.mass));
    for (number, first) in sights[0].bodies.iter().enumerate() {
        let Some(shape) = shape(first, size, heaviest) else { continue };
        if scene.bodies[number].has_shape && mesh::are_all(scene, meshes) {
            continue;
        }
        let track: Vec<Key> = sights.iter().map(|sight| key_of(&sight.bodies[number])).collect();
        let colour = COLOURS[number % COLOURS.len()];
        file.solid(&format!("body {}", number + 1), sphere, colour, shape, times, &track);
    }
    for (number, of) in scene.shapes.iter().enumerate() {
        let own = sights[0].shapes[number];
        let own_mesh = meshes.get(&number).map(facets).filter(|mesh| !mesh.indices.is_empty());
        let [x, y, z] = [0, 1, 2].map(|i| own.sizes[i]);
        let (form, scale) = match (of.kind.as_str(), own_mesh) {
            ("box", _) => (file.form("box", cube), [x / 2.0, y / 2.0, z / 2.0]),
            // About its middle.
            ("cylinder", _) => (file.form("centred", || centred(cylinder())), [x, x, y]),
            ("sphere", _) => (sphere, [x; 3]),
            (_, Some(mesh)) => (file.mesh(&mesh), [x, y, z]),
            (_, None) => continue,
        };
        let track: Vec<Key> = sights.iter().map(|sight| key_of_shape(&sight.shapes[number])).collect();
        let colour = COLOURS[number % COLOURS.len()];
        let lies = Key { scale: scale.map(|x| x as f32), ..AT_REST };
        file.solid(&format!("shape {}", number + 1), form, colour, lies, times, &track);
    }
    for (number, &[from, to]) in scene.links.iter().enumerate() {
        let along = |sight: &Sight| between(sight.places[from], sight.places[to], 0.014 * size);
        let track: Vec<Key> = sights.iter().map(along).collect();
        file.solid(&format!("line {}", number + 1), rod, GREY, AT_REST, times, &track);
    }
    file.finished(&motion.name)
}

/// Rows and their times as the file has them: from zero, increasing as floats, finite.
fn keys(motion: &Motion) -> Vec<(usize, f32)> {
    let [first, .., last] = motion.rows.as_slice() else { return vec![(0, 0.0)] };
    let divisor = slowdown(last.t - first.t).unwrap_or(1.0);
    let step = motion.rows.len().div_ceil(MOST_KEYS);
    let mut keys: Vec<(usize, f32)> = Vec::new();
    for (row, at) in motion.rows.iter().enumerate() {
        let time = ((at.t - first.t) / divisor) as f32;
        let is_later = keys.last().is_none_or(|(_, before)| time > *before);
        if is_later && (row % step == 0 || row + 1 == motion.rows.len()) {
            keys.push((row, time));
        }
    }
    keys
}

/// Half the diagonal of the box of all places, or 1.
fn extent(sights: &[Sight]) -> f64 {
    let places =
        sights.iter().flat_map(|sight| sight.bodies.iter().map(|body| body.centre).chain(sight.places.iter().copied()));
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for place in places.filter(|place| place.iter().all(|x| x.is_finite())) {
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    let size = (high - low).norm() / 2.0;
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}

/// Where something is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    translation: [f32; 3],
    /// x, y, z, w
    rotation: [f32; 4],
    scale: [f32; 3],
}

const AT_REST: Key = Key { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };

fn floats(vector: &Vector3<f64>) -> [f32; 3] {
    [0, 1, 2].map(|i| vector[i] as f32)
}

fn quaternion(rotation: &UnitQuaternion<f64>) -> [f32; 4] {
    [rotation.i, rotation.j, rotation.k, rotation.w].map(|x| x as f32)
}

fn key_of(body: &Body) -> Key {
    Key { translation: floats(&body.centre), rotation: quaternion(&body.attitude), scale: [1.0; 3] }
}

fn key_of_shape(shape: &Shape) -> Key {
    Key { translation: floats(&shape.centre), rotation: quaternion(&shape.attitude), ..AT_REST }
}

/// An ellipsoid as it lies in its body's axes; a ball of points, and of what is too small to be seen.
fn shape(body: &Body, size: f64, heaviest: f64) -> Option<Key> {
    if body.mass <= 0.0 || !body.mass.is_finite() {
        return None;
    }
    let ball = 0.07 * size * (body.mass / heaviest).cbrt().max(0.45);
    let shape = ellipsoid(body.mass, &body.inertia).filter(|(axes, _)| axes.max() >= 0.25 * ball);
    let (axes, lies) = shape.unwrap_or((Vector3::repeat(ball), UnitQuaternion::identity()));
    let axes = axes.map(|axis| axis.max(0.012 * size));
    Some(Key { translation: [0.0; 3], rotation: quaternion(&lies), scale: floats(&axes) })
}

/// A rod along +z of length 1, laid between two places.
fn between(from: Vector3<f64>, to: Vector3<f64>, radius: f64) -> Key {
    let way = to - from;
    let turn = Unit::try_new(way, 0.0)
        .and_then(|along| UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &along))
        // Straight down.
        .unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), if way.z < 0.0 { f64::from(PI) } else { 0.0 })
        });
    let length = way.norm().max(1e-9 * radius);
    Key {
        translation: floats(&from),
        rotation: quaternion(&turn),
        scale: floats(&Vector3::new(radius, radius, length)),
    }
}

/// Triangles with normals.
struct Mesh {
    places: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

/// A sphere of radius 1.
fn sphere() -> Mesh {
    let mut mesh = Mesh { places: Vec::new(), normals: Vec::new(), indices: Vec::new() };
    for i in 0..=RINGS {
        let latitude = PI * i as f32 / RINGS as f32;
        for j in 0..=SECTORS {
            let longitude = 2.0 * PI * j as f32 / SECTORS as f32;
            let place = [latitude.sin() * longitude.cos(), latitude.sin() * longitude.sin(), latitude.cos()];
            mesh.places.push(place);
            mesh.normals.push(normal(place));
        }
    }
    let at = |i: usize, j: usize| (i * (SECTORS + 1) + j) as u32;
    for i in 0..RINGS {
        for j in 0..SECTORS {
            if i + 1 < RINGS {
                mesh.indices.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            }
            if i > 0 {
                mesh.indices.extend([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    mesh
}

/// A cylinder of radius 1, from z = 0 to z = 1, with its ends.
fn cylinder() -> Mesh {
    let mut mesh = Mesh { places: Vec::new(), normals: Vec::new(), indices: Vec::new() };
    let around = |j: usize| {
        let angle = 2.0 * PI * j as f32 / SECTORS as f32;
        [angle.cos(), angle.sin()]
    };
    for j in 0..=SECTORS {
        let [x, y] = around(j);
        for z in [0.0, 1.0] {
            mesh.places.push([x, y, z]);
            mesh.normals.push(normal([x, y, 0.0]));
        }
    }
    for j in 0..SECTORS as u32 {
        mesh.indices.extend([2 * j, 2 * j + 2, 2 * j + 3, 2 * j, 2 * j + 3, 2 * j + 1]);
    }
    for (z, up) in [(0.0, -1.0), (1.0, 1.0)] {
        let centre = mesh.places.len() as u32;
        mesh.places.push([0.0, 0.0, z]);
        mesh.normals.push([0.0, 0.0, up]);
        for j in 0..=SECTORS {
            let [x, y] = around(j);
            mesh.places.push([x, y, z]);
            mesh.normals.push([0.0, 0.0, up]);
        }
        for j in 1..=SECTORS as u32 {
            let [a, b] = if up > 0.0 { [j, j + 1] } else { [j + 1, j] };
            mesh.indices.extend([centre, centre + a, centre + b]);
        }
    }
    mesh
}

/// With edges of 2 about the origin.
fn cube() -> Mesh {
    let mut triangles = Triangles::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |a: f32, b: f32| {
                let mut place = [0.0; 3];
                [place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]] = [side, a, b];
                place
            };
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(side, -side), corner(1.0, 1.0), corner(-side, side)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    facets(&triangles)
}

/// Half a length down.
fn centred(mut mesh: Mesh) -> Mesh {
    mesh.places.iter_mut().for_each(|place| place[2] -= 0.5);
    mesh
}

/// Each triangle with its own normal; those without an area are left out.
fn facets(triangles: &Triangles) -> Mesh {
    let mut mesh = Mesh { places: Vec::new(), normals: Vec::new(), indices: Vec::new() };
    for corners in triangles {
        let [a, b, c] = corners.map(Vector3::from);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
        for corner in corners {
            mesh.indices.push(mesh.places.len() as u32);
            mesh.places.push(*corner);
            mesh.normals.push(normal.into());
        }
    }
    mesh
}

fn normal([x, y, z]: [f32; 3]) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// A file under way: numbers, and what they mean.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    /// Accessors of places, normals and indices of each form, which meshes of all colours share.
    forms: Vec<[usize; 3]>,
    /// The numbers of forms that are made when they are used first.
    known: BTreeMap<&'static str, usize>,
    /// Form and colour of each mesh.
    coloured: Vec<(usize, [f64; 3])>,
    materials: Vec<Value>,
    nodes: Vec<Value>,
    roots: Vec<usize>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
}

impl File {
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        // Everything begins at a multiple of four bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// An accessor of floats, `width` of them for each element, with their bounds.
    fn numbers(&mut self, values: &[f32], width: usize, kind: &str, target: Option<u32>) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes, target);
        let bound = |better: fn(f32, f32) -> f32| -> Vec<f32> {
            let column = |i: usize| values.iter().skip(i).step_by(width).copied().reduce(better).unwrap_or_default();
            (0..width).map(column).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len() / width, "type": kind,
            "min": bound(f32::min), "max": bound(f32::max),
        }));
        self.accessors.len() - 1
    }

    /// The number of a form that is made once.
    fn form(&mut self, name: &'static str, make: impl Fn() -> Mesh) -> usize {
        if let Some(&known) = self.known.get(name) {
            return known;
        }
        let form = self.mesh(&make());
        self.known.insert(name, form);
        form
    }

    /// The number of a form.
    fn mesh(&mut self, mesh: &Mesh) -> usize {
        let places = self.numbers(mesh.places.as_flattened(), 3, "VEC3", Some(VERTICES));
        let normals = self.numbers(mesh.normals.as_flattened(), 3, "VEC3", Some(VERTICES));
        let bytes: Vec<u8> = mesh.indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(INDICES));
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": mesh.indices.len(), "type": "SCALAR",
        }));
        self.forms.push([places, normals, self.accessors.len() - 1]);
        self.forms.len() - 1
    }

    /// A mesh of this form and colour.
    fn coloured(&mut self, form: usize, colour: [f64; 3]) -> usize {
        if let Some(known) = self.coloured.iter().position(|known| *known == (form, colour)) {
            return known;
        }
        let [r, g, b] = colour;
        self.materials.push(json!({
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.55 },
        }));
        let [places, normals, indices] = self.forms[form];
        self.meshes.push(json!({ "primitives": [{
            "attributes": { "POSITION": places, "NORMAL": normals }, "indices": indices, "material": self.materials.len() - 1,
        }] }));
        self.coloured.push((form, colour));
        self.coloured.len() - 1
    }

    /// A mesh on a node that moves; `shape` is how it lies there.
    fn solid(&mut self, name: &str, form: usize, colour: [f64; 3], shape: Key, times: usize, track: &[Key]) {
        let mesh = self.coloured(form, colour);
        let Key { rotation, scale, .. } = shape;
        self.nodes.push(json!({ "mesh": mesh, "rotation": rotation, "scale": scale }));
        let child = self.nodes.len() - 1;
        let first = track[0];
        self.nodes.push(json!({
            "name": name, "children": [child],
            "translation": first.translation, "rotation": first.rotation, "scale": first.scale,
        }));
        let node = self.nodes.len() - 1;
        self.roots.push(node);
        let moves = |part: fn(&Key) -> Vec<f32>| track.iter().any(|key| part(key) != part(&first));
        let mut rotations = track.to_vec();
        // Of the two quaternions of an attitude the one that is nearer to the last.
        for i in 1..rotations.len() {
            let dot: f32 = (0..4).map(|k| rotations[i - 1].rotation[k] * rotations[i].rotation[k]).sum();
            if dot < 0.0 {
                rotations[i].rotation = rotations[i].rotation.map(|x| -x);
            }
        }
        for (path, kind, part) in [
            ("translation", "VEC3", (|key| key.translation.to_vec()) as fn(&Key) -> Vec<f32>),
            ("rotation", "VEC4", |key| key.rotation.to_vec()),
            ("scale", "VEC3", |key| key.scale.to_vec()),
        ] {
            if track.len() < 2 || !moves(part) {
                continue;
            }
            let values: Vec<f32> = rotations.iter().flat_map(part).collect();
            let width = if kind == "VEC4" { 4 } else { 3 };
            let output = self.numbers(&values, width, kind, None);
            self.samplers.push(json!({ "input": times, "output": output, "interpolation": "LINEAR" }));
            self.channels.push(json!({
                "sampler": self.samplers.len() - 1, "target": { "node": node, "path": path },
            }));
        }
    }

    /// Header, JSON, numbers.
    fn finished(mut self, name: &str) -> Vec<u8> {
        // z is up in the world, y in the file.
        let mut root = json!({ "name": name, "rotation": [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2] });
        if !self.roots.is_empty() {
            root["children"] = json!(self.roots);
        }
        self.nodes.push(root);
        let mut object = json!({
            "asset": { "version": "2.0", "generator": format!("mbs {}", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [self.nodes.len() - 1] }],
            "nodes": self.nodes,
            "buffers": [{ "byteLength": self.bytes.len() }],
            "bufferViews": self.views,
            "accessors": self.accessors,
        });
        // Lists are left out where they are empty.
        for (key, list) in [("meshes", self.meshes), ("materials", self.materials)] {
            if !list.is_empty() {
                object[key] = Value::Array(list);
            }
        }
        if !self.channels.is_empty() {
            object["animations"] = json!([{ "name": "motion", "samplers": self.samplers, "channels": self.channels }]);
        }
        let mut text = object.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
        let mut file = b"glTF".to_vec();
        file.extend(2_u32.to_le_bytes());
        file.extend(((12 + 8 + text.len() + 8 + self.bytes.len()) as u32).to_le_bytes());
        for (kind, bytes) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            file.extend(length(bytes));
            file.extend(kind);
            file.extend(bytes);
        }
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_closed_and_look_outwards() {
        for (mesh, whole) in [(sphere(), 4.0 / 3.0 * PI), (cylinder(), PI), (centred(cylinder()), PI), (cube(), 8.0)] {
            let at = |i: u32| Vector3::from(mesh.places[i as usize]);
            let mut volume = 0.0;
            for corners in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [at(corners[0]), at(corners[1]), at(corners[2])];
                volume += a.dot(&b.cross(&c)) / 6.0;
                let own = Vector3::from(mesh.normals[corners[0] as usize]);
                assert!((b - a).cross(&(c - a)).dot(&own) > 0.0);
            }
            // Less what the chords cut off.
            assert!((0.96..1.000_001).contains(&(volume / whole)), "{volume} of {whole}");
        }
    }

    #[test]
    fn rods_reach_from_place_to_place() {
        for to in [[0.0, 0.0, -2.0], [1.0, 2.0, 3.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]] {
            let (from, to) = (Vector3::new(0.5, 0.0, 1.0), Vector3::from(to));
            let key = between(from, to, 0.1);
            let [x, y, z, w] = key.rotation.map(f64::from);
            let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            let end = from + turn * Vector3::new(0.0, 0.0, f64::from(key.scale[2]));
            assert!((end - to).norm() < 1e-6, "{end} {to}");
        }
        assert!(between(Vector3::zeros(), Vector3::zeros(), 0.1).scale[2] > 0.0);
    }

    #[test]
    fn long_and_short_motions_are_shown_in_ten_seconds() {
        assert_eq!(slowdown(10.0), None);
        assert_eq!(slowdown(0.0), None);
        assert_eq!(slowdown(2.0e6), Some(2.0e5));
        assert_eq!(slowdown(0.01), Some(0.001));
    }
}
