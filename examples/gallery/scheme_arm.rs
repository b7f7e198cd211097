//! Figures 3.1 to 3.3: the arm from its generated kinematics, in the posture of Table 1.

use mbs_arm::{A1, A2, A3, Arm, D1, D4, JointVector};
use mbs_chart::style::{BLACK, BLUE, Color, DASHED, DOTTED, GRAY, GREEN, LIGHT, ORANGE, PINK, Stroke};
use mbs_chart::{Figure, Sketch};
use mbs_examples::Failure;
use mbs_runtime::Pose;

use crate::solid::{Point, STEEL, Solid, THIN, drawing, plane_arc, upright};

/// The angles of Table 1 \[°\].
const ANGLES: JointVector = [45.0, 30.0, 30.0, -45.0, 30.0, 0.0];

fn posture() -> JointVector {
    ANGLES.map(f64::to_radians)
}

/// The origins of the links' frames, from the generated frames of their mass centres.
fn origins(arm: &Arm, q: &JointVector) -> [Point; 6] {
    let (model, params) = (&arm.model, arm.model.params());
    let centres: [Pose<f64>; 6] = [
        model.center_0(q),
        model.center_1(q),
        model.center_2(q),
        model.center_3(q),
        model.center_4(q),
        model.center_5(q),
    ];
    std::array::from_fn(|i| centres[i].transform_point([-params.com_x[i], -params.com_y[i], -params.com_z[i]]))
}

/// From the base through all joints to the flange.
fn chain(arm: &Arm, q: &JointVector) -> Vec<Point> {
    let own = origins(arm, q);
    [&[[0.0; 3], [0.0, 0.0, D1]], &own[..4], &own[5..]].concat()
}

/// Figure 3.1.
pub(crate) fn both_ways() -> Result<Vec<Figure>, Failure> {
    let arm = Arm::default();
    let pose = arm.pose(&posture());
    let title = "Figure 3.1: direct and inverse kinematics, with the numbers of Table 1";
    Ok(vec![drawing(title, (900, 680), postures(&arm, &pose)?)])
}

/// A number as the thesis prints it.
fn number(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('-', "−")
}

fn flow(pose: &Pose<f64>) -> Sketch {
    let mut sketch = Sketch::default();
    let high = 2.0;
    for (left, wide, title) in [(0.0, 2.9, "joint angles"), (6.2, 3.3, "pose of the flange")] {
        let corners = [[left, 0.0], [left + wide, 0.0], [left + wide, high], [left, high]];
        sketch.area(corners, LIGHT);
        sketch.line([&corners[..], &corners[..1]].concat(), THIN);
        sketch.styled_word([left + 0.5 * wide, high], title, [0.0, 18.0], 17.0, BLUE);
    }
    for (i, angle) in ANGLES.into_iter().enumerate() {
        let at = [0.75 + 1.4 * (i / 3) as f64, 1.3 - 0.45 * (i % 3) as f64];
        sketch.word(at, format!("θ_{} = {}°", i + 1, number(angle, 0)), [0.0, 0.0]);
    }
    for (name, y) in [("P =", 1.42), ("R =", 0.69)] {
        sketch.word([6.45, y], name, [0.0, 0.0]);
    }
    let rows = [(1.42, pose.position), (1.02, pose.rotation[0]), (0.69, pose.rotation[1]), (0.36, pose.rotation[2])];
    for (y, values) in rows {
        for (column, value) in values.into_iter().enumerate() {
            sketch.word([7.55 + 0.8 * column as f64, y], number(value, 4), [-1.0, 0.0]);
        }
    }
    sketch.word([9.18, 1.42], "m", [2.0, 0.0]);
    let strokes = [Stroke::new(GREEN, 2.2), Stroke::new(ORANGE, 2.2)];
    sketch.arrow([[3.0, 1.45], [6.1, 1.45]], strokes[0]);
    sketch.styled_word([4.55, 1.45], "direct: T_1 T_2 T_3 T_4 T_5 T_6", [0.0, -16.0], 15.0, GREEN);
    sketch.styled_word([4.55, 1.45], "(3.1)–(3.4), one pose", [0.0, 16.0], 13.0, GRAY);
    sketch.arrow([[6.1, 0.5], [3.0, 0.5]], strokes[1]);
    sketch.styled_word([4.55, 0.5], "inverse: eight configurations", [0.0, -16.0], 15.0, ORANGE);
    sketch.styled_word([4.55, 0.5], "(3.5)–(3.12)", [0.0, 16.0], 13.0, GRAY);
    sketch
}

/// All that reach the pose; those which differ by the wrist alone lie on each other.
fn postures(arm: &Arm, pose: &Pose<f64>) -> Result<Sketch, Failure> {
    let mut solid = Solid::new(-52.0, 16.0).on(flow(pose), [4.9, -2.9], 2.1);
    for solution in arm.inverse(pose)?.iter() {
        let is_own = solution.q.iter().zip(posture()).all(|(a, b)| (a - b).abs() < 1e-6);
        if !is_own {
            solid.line(&chain(arm, &solution.q), Stroke::new(STEEL, 4.0));
        }
    }
    let own = chain(arm, &posture());
    solid.line(&own, Stroke::new(BLUE, 6.0));
    for joint in &own[1..] {
        solid.dot(*joint, 5.0, ORANGE);
    }
    solid.frame(&upright([0.0; 3]), 0.55, ["x_0", "y_0", ""], BLACK);
    solid.word([0.0, 0.0, 0.55], "z_0", [-10.0, 0.0]);
    solid.frame(pose, 0.4, ["x_6", "y_6", "z_6"], GREEN);
    solid.word(own[2], "axis 2", [14.0, -8.0]);
    solid.word(own[3], "axis 3", [12.0, -6.0]);
    solid.word(own[5], "wrist", [12.0, 12.0]);
    let mut sketch = solid.sketch;
    for (y, line) in
        [(-1.5, "gray: the seven other configurations,"), (-1.75, "in pairs that differ by the wrist alone")]
    {
        sketch.styled_word([0.0, y], line, [1.0, 0.0], 13.0, GRAY);
    }
    Ok(sketch)
}

/// The plane of the arm: to the front, up.
struct Side {
    base: [f64; 2],
    shoulder: [f64; 2],
    elbow: [f64; 2],
    corner: [f64; 2],
    wrist: [f64; 2],
}

impl Side {
    fn of(q: &JointVector) -> Self {
        let arm = Arm::default();
        let own = origins(&arm, q);
        let (sin, cos) = q[0].sin_cos();
        let flat = |[x, y, z]: Point| [cos * x + sin * y, z];
        Side {
            base: [0.0, 0.0],
            shoulder: flat(own[0]),
            elbow: flat(own[1]),
            corner: flat(own[2]),
            wrist: flat(own[3]),
        }
    }

    /// Links thick, axes as dots, and the ground.
    fn draw(&self, sketch: &mut Sketch) {
        sketch.line([[-0.55, 0.0], [0.55, 0.0]], Stroke::new(GRAY, 2.0));
        for k in 0..10 {
            let x = -0.5 + 0.11 * f64::from(k);
            sketch.line([[x, 0.0], [x - 0.06, -0.07]], Stroke::new(GRAY, 1.0));
        }
        sketch.line([self.base, [0.0, D1], self.shoulder], Stroke::new(STEEL, 9.0));
        sketch.line([self.shoulder, self.elbow], Stroke::new(STEEL, 9.0));
        sketch.line([self.elbow, self.corner, self.wrist], Stroke::new(STEEL, 9.0));
        for (at, word, shift) in [
            (self.base, "0", [-14.0, -14.0]),
            (self.shoulder, "1", [-4.0, -22.0]),
            (self.elbow, "2", [6.0, -18.0]),
            (self.wrist, "4", [-6.0, 20.0]),
        ] {
            sketch.dot(at, 6.5, ORANGE);
            sketch.styled_word(at, word, shift, 14.0, ORANGE);
        }
    }
}

fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).hypot(to[0] - from[0])
}

/// A length with its name and value beside its middle.
fn length(sketch: &mut Sketch, [from, to]: [[f64; 2]; 2], name: &str, shift: [f64; 2], color: Color) {
    sketch.line([from, to], Stroke::new(color, 1.8).dashed(DASHED));
    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    sketch.styled_word(middle, format!("{name} = {:.4} m", distance(from, to)), shift, 14.0, color);
}

/// An angle with its name, from one direction to another.
fn angle(sketch: &mut Sketch, at: [f64; 2], radius: f64, ends: [f64; 2], word: String, shift: [f64; 2], color: Color) {
    let arc = plane_arc(at, radius, ends);
    let middle = arc[arc.len() / 2];
    sketch.line(arc, Stroke::new(color, 1.8));
    sketch.styled_word(middle, word, shift, 14.0, color);
}

fn degrees(ends: [f64; 2]) -> f64 {
    (ends[1] - ends[0]).abs().to_degrees()
}

/// Figure 3.2.
pub(crate) fn side_view() -> Result<Vec<Figure>, Failure> {
    let side = Side::of(&posture());
    let mut sketch = Sketch::default();
    side.draw(&mut sketch);
    length(&mut sketch, [side.base, side.shoulder], "P_{01}", [-76.0, 22.0], GREEN);
    length(&mut sketch, [side.base, side.wrist], "P_{04}", [-16.0, 6.0], PINK);
    length(&mut sketch, [side.shoulder, side.wrist], "P_{14}", [10.0, -30.0], BLUE);
    length(&mut sketch, [side.elbow, side.wrist], "l_1", [-12.0, -10.0], ORANGE);
    let along = |a: [f64; 2], b: [f64; 2], k: f64| [a[0] + k * (b[0] - a[0]), a[1] + k * (b[1] - a[1])];
    sketch.word(along(side.shoulder, side.elbow, 0.5), format!("a_2 = {A2} m"), [12.0, -14.0]);
    sketch.word(side.corner, format!("a_3 = {A3} m"), [8.0, 46.0]);
    sketch.word(along(side.corner, side.wrist, 0.5), format!("d_4 = {D4} m"), [16.0, 12.0]);
    sketch.word([0.0, 0.75 * D1], format!("d_1 = {D1} m"), [-12.0, 0.0]);
    sketch.word([0.36 * A1, D1], format!("a_1 = {A1} m"), [0.0, -20.0]);
    // Of the elbow: l₁ against a₃, a₂ against l₁.
    let (inner, outer) = (direction(side.elbow, side.wrist), direction(side.elbow, side.corner));
    angle(&mut sketch, side.elbow, 0.1, [inner, outer], String::new(), [0.0, 0.0], GREEN);
    let name = format!("α_1 = arctg(d_4/a_3) = {:.2}°", degrees([inner, outer]));
    sketch.styled_word(side.elbow, name, [34.0, -20.0], 14.0, GREEN);
    let upper = direction(side.elbow, side.shoulder);
    let lower = inner + if inner < 0.0 { 2.0 * std::f64::consts::PI } else { 0.0 };
    let name = format!("γ = {:.2}°", degrees([upper, lower]));
    angle(&mut sketch, side.elbow, 0.2, [upper, lower], name, [-6.0, 2.0], BLUE);
    // θ₃ from the upper arm's own direction.
    let onwards = direction(side.shoulder, side.elbow);
    let beyond = [side.elbow[0] + 0.42 * onwards.cos(), side.elbow[1] + 0.42 * onwards.sin()];
    sketch.line([side.elbow, beyond], THIN.dashed(DOTTED));
    let name = format!("θ_3 = π − α_1 − γ = {:.2}°", degrees([onwards, outer]));
    angle(&mut sketch, side.elbow, 0.3, [onwards, outer], String::new(), [0.0, 0.0], ORANGE);
    sketch.styled_word(beyond, name, [8.0, 0.0], 14.0, ORANGE);
    let title = "Figure 3.2: side view in the plane of the arm, to scale, posture of Table 1";
    Ok(vec![drawing(title, (900, 580), sketch)])
}

/// Figure 3.3.
pub(crate) fn second_angle() -> Result<Vec<Figure>, Failure> {
    use std::f64::consts::PI;
    let side = Side::of(&posture());
    let mut sketch = Sketch::default();
    sketch.area([side.base, side.shoulder, side.wrist], LIGHT);
    sketch.area([side.shoulder, side.elbow, side.wrist], Color(243, 240, 232));
    side.draw(&mut sketch);
    length(&mut sketch, [side.base, side.shoulder], "P_{01}", [-76.0, 22.0], GREEN);
    length(&mut sketch, [side.base, side.wrist], "P_{04}", [-16.0, 6.0], PINK);
    length(&mut sketch, [side.shoulder, side.wrist], "P_{14}", [12.0, 20.0], BLUE);
    length(&mut sketch, [side.elbow, side.wrist], "l_1", [-12.0, -10.0], ORANGE);
    let middle = [0.5 * (side.shoulder[0] + side.elbow[0]), 0.5 * (side.shoulder[1] + side.elbow[1])];
    sketch.word(middle, format!("a_2 = {A2} m"), [12.0, -14.0]);
    sketch.line([[side.shoulder[0] - 0.62, D1], [side.shoulder[0] + 0.75, D1]], THIN.dashed(DOTTED));
    sketch.word([0.4 * A1, D1], format!("a_1 = {A1} m"), [0.0, -22.0]);
    sketch.word([0.0, 0.75 * D1], format!("d_1 = {D1} m"), [-12.0, 0.0]);
    // Around axis 2 from behind to the front: three angles and θ₂ make π.
    let at = side.shoulder;
    let turns = [-PI, direction(at, side.base), direction(at, side.wrist), direction(at, side.elbow), 0.0];
    let angles: Vec<f64> = turns.windows(2).map(|pair| degrees([pair[0], pair[1]])).collect();
    for (k, (radius, color)) in [(0.34, GREEN), (0.22, PINK), (0.3, BLUE), (0.42, ORANGE)].into_iter().enumerate() {
        let names = ["δ", "ε", "β", "θ_2"];
        let shift = [[-8.0, 4.0], [-2.0, 14.0], [4.0, 14.0], [10.0, 4.0]][k];
        angle(&mut sketch, at, radius, [turns[k], turns[k + 1]], names[k].to_string(), shift, color);
    }
    let lines = [
        format!("δ = arctg(d_1/a_1) = {:.2}°", angles[0]),
        format!("ε = arccos((P_{{01}}² + P_{{14}}² − P_{{04}}²)/(2 P_{{01}} P_{{14}})) = {:.2}°", angles[1]),
        format!("β = arccos((a_2² + P_{{14}}² − l_1²)/(2 a_2 P_{{14}})) = {:.2}°", angles[2]),
        format!("θ_2 = π − β − ε − δ = {:.2}°", angles[3]),
    ];
    for (k, (line, color)) in lines.into_iter().zip([GREEN, PINK, BLUE, ORANGE]).enumerate() {
        sketch.styled_word([0.95, 1.22 - 0.1 * k as f64], line, [1.0, 0.0], 14.0, color);
    }
    let title = "Figure 3.3: side view, the second angle, to scale, posture of Table 1";
    Ok(vec![drawing(title, (900, 660), sketch)])
}
