//! What there is to draw of a mechanism, for reports and animations: shapes, and bodies by their inertias.

use crate::expr::Expr;
use crate::model::lagrangian::{Draft, Drawing, Lagrangian, Output, OutputValue};

impl<'g> Draft<'g> {
    /// What bodies look like, in order of their statements.
    ///
    /// ```
    /// let text = "mechanism Ball { param r: m = 0.1; coord x: m; let ball = translation([x, 0, 0]); \
    ///             kinetic += particle(1 kg, ball.origin()); shape ball += sphere(r); }";
    /// let graph = mbs_derive::expr::Graph::verbatim();
    /// let (lagrangian, _) = mbs_derive::declared(text, &graph, &[]).unwrap();
    /// let [ball] = lagrangian.drawings() else { panic!() };
    /// assert_eq!((ball.kind, ball.on.as_str()), ("sphere", "ball"));
    /// let outputs: Vec<String> = lagrangian.pictured().outputs.iter().map(|output| output.name.clone()).collect();
    /// assert_eq!(outputs, ["shape_0", "shape_0_size", "body_0", "body_0_inertia"]);
    /// ```
    pub fn drawings(&self) -> &[Drawing<'g>] {
        &self.with_shapes().drawings
    }

    /// A mechanism to draw by: this one, whose outputs tell besides where its shapes and bodies are. It has no
    /// reactions. Behind its own outputs it has
    ///
    /// | output | shape | meaning |
    /// |---|---|---|
    /// | `shape_i` | pose | the frame of the drawing i of [`drawings`](Self::drawings) |
    /// | `shape_i_size` | array | its sizes, m; of a mesh three plain factors |
    /// | `body_i` | pose | the frame of the body i of [`bodies`](Self::bodies) |
    /// | `body_i_inertia` | array `[10]` | mass, kg; mass centre in this frame, m; `xx`, `yy`, `zz`, `xy`, `xz`, `yz` of the inertia about it in these axes, kg·m², zero of particles |
    ///
    /// with `drawn_` before them where the mechanism has outputs of such names. Poses of shapes may be made by
    /// frames that the mechanism itself does not have: frames of the picture are its own.
    #[must_use]
    pub fn pictured(&self) -> Lagrangian<'g> {
        let mut picture = self.with_shapes().clone();
        picture.reactions.clear();
        picture.released = None;
        let is_taken = |begin: String| {
            let mut rests = picture.outputs.iter().filter_map(|output| output.name.strip_prefix(begin.as_str()));
            rests.any(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
        };
        let mut prefix = String::new();
        while is_taken(format!("{prefix}shape_")) || is_taken(format!("{prefix}body_")) {
            prefix.push_str("drawn_");
        }
        let zero = self.graph.integer(0);
        let mut output = |name: String, value: OutputValue<'g>, units: &[&str]| {
            let units = units.iter().map(|unit| (*unit).to_string()).collect();
            let (name, docs) = (format!("{prefix}{name}"), Vec::new());
            picture.outputs.push(Output { name, docs, units, value, jacobian_rate: false });
        };
        let of_pose = [[METRE; 3].as_slice(), &["1"; 9]].concat();
        let drawings = self.drawings().iter().enumerate();
        for (i, Drawing { kind, sizes, frame, .. }) in drawings {
            output(format!("shape_{i}"), OutputValue::Pose(*frame), &of_pose);
            let unit = if *kind == "mesh" { "1" } else { METRE };
            output(format!("shape_{i}_size"), OutputValue::Array(sizes.clone()), &vec![unit; sizes.len()]);
        }
        let (bodies, _) = self.with_shapes().bodies();
        for (i, body) in bodies.iter().enumerate() {
            output(format!("body_{i}"), OutputValue::Pose(body.frame), &of_pose);
            let moments = body.inertia.map_or([zero; 6], |matrix| {
                let entry = |i: usize, j: usize| matrix.0[i][j];
                [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)]
            });
            let numbers = std::iter::once(body.mass).chain(body.com.0).chain(moments).collect();
            let units = [["kg"].as_slice(), &[METRE; 3], &["kg·m²"; 6]].concat();
            output(format!("body_{i}_inertia"), OutputValue::Array(numbers), &units);
        }
        Lagrangian(picture)
    }

    /// The same variables and frames with these outputs alone.
    pub(crate) fn seen(&self, outputs: Vec<Output<'g>>) -> Lagrangian<'g> {
        let Draft { coordinates, parameters, inputs, prescribed, frames, .. } = self.clone();
        let empty = Draft::new(self.graph, &self.name);
        Lagrangian(Draft { coordinates, parameters, inputs, prescribed, frames, outputs, ..empty })
    }

    /// The mechanism that has frames of shapes, too.
    fn with_shapes(&self) -> &Self {
        self.drawn.as_ref().map_or(self, |drawn| &drawn.0)
    }

    /// What shapes are made of.
    pub(in crate::model) fn drawn_expressions(&self) -> Vec<Expr<'g>> {
        let Some(drawn) = &self.drawn else { return Vec::new() };
        let of = |drawing: &Drawing<'g>| {
            let frame = drawn.frames.get(drawing.frame);
            let pose = frame.position.0.into_iter().chain(frame.rotation.0.into_iter().flatten());
            drawing.sizes.iter().copied().chain(pose).collect::<Vec<_>>()
        };
        drawn.drawings.iter().flat_map(of).collect()
    }
}

const METRE: &str = "m";
