//! Figures 4.1 to 4.4: the platform from its generated kinematics.

use mbs_chart::style::{BLACK, BLUE, Color, DASHED, DOTTED, GRAY, GREEN, LIGHT, ORANGE, PINK, Stroke};
use mbs_chart::{Figure, Sketch};
use mbs_examples::Failure;
use mbs_platform::{Coordinates, HOME, Platform};

use crate::solid::{Point, STEEL, Solid, THIN, arc, drawing, plane_arc, plus, unit, upright};

/// Off home, so that nothing lies on anything else.
const POSE: Coordinates = [0.2, -0.1, 1.35, 0.12, -0.14, 0.3];
/// The leg that is shown, counted from 0.
const LEG: usize = 1;
const PLATE: Color = Color(222, 232, 240);

/// Base, legs and platform at a pose.
fn machine(solid: &mut Solid, platform: &Platform, q: &Coordinates) -> [[Point; 6]; 2] {
    let base = platform.geometry().base;
    let frame = platform.model().pose(q);
    let joints = platform.geometry().platform.map(|place| frame.transform_point(place));
    solid.area(&base, LIGHT);
    solid.line(&[&base[..], &base[..1]].concat(), Stroke::new(GRAY, 1.4));
    for i in 0..6 {
        solid.line(&[base[i], joints[i]], Stroke::new(STEEL, 5.0));
    }
    solid.area(&joints, PLATE);
    solid.line(&[&joints[..], &joints[..1]].concat(), Stroke::new(GRAY, 1.4));
    base.iter().chain(&joints).for_each(|joint| solid.dot(*joint, 4.0, GRAY));
    [base, joints]
}

/// Figure 4.1.
pub(crate) fn frames() -> Result<Vec<Figure>, Failure> {
    let platform = Platform::default();
    let mut solid = Solid::new(-62.0, 22.0);
    let [base, joints] = machine(&mut solid, &platform, &POSE);
    let frame = platform.model().pose(&POSE);
    solid.frame(&upright([0.0; 3]), 0.6, ["x_B", "y_B", "z_B"], BLACK);
    solid.frame(&frame, 0.5, ["x_P", "y_P", "z_P"], GREEN);
    let arrow =
        |solid: &mut Solid, [from, to]: [Point; 2], (part, word): (f64, &str), shift: [f64; 2], color: Color| {
            solid.arrow(&[from, to], Stroke::new(color, 2.2));
            solid.tinted(plus(from, part, plus(to, -1.0, from)), word, shift, color);
        };
    arrow(&mut solid, [[0.0; 3], frame.position], (0.62, "P"), [10.0, 0.0], BLUE);
    arrow(&mut solid, [[0.0; 3], base[LEG]], (0.6, "B_i"), [0.0, -14.0], PINK);
    arrow(&mut solid, [frame.position, joints[LEG]], (0.6, "R P_i"), [-4.0, -14.0], PINK);
    arrow(&mut solid, [base[LEG], joints[LEG]], (0.5, "L_i = R P_i + P − B_i"), [12.0, 0.0], ORANGE);
    solid.word([0.0; 3], "B", [-12.0, 10.0]);
    Ok(vec![drawing("Figure 4.1: frames of base and platform, and the vectors of leg i", (900, 720), solid.sketch)])
}

/// Figure 4.2.
pub(crate) fn joints() -> Result<Vec<Figure>, Failure> {
    let platform = Platform::default();
    let params = platform.params();
    let geometry = platform.geometry();
    let mut sketch = Sketch::default();
    let around = [0.0, 2.0 * std::f64::consts::PI];
    sketch.line(plane_arc([0.0; 2], params.base_radius, around), THIN.dashed(DASHED));
    sketch.line(plane_arc([0.0; 2], params.platform_radius, around), THIN.dashed(DOTTED));
    let flat = |[x, y, _]: Point| [x, y];
    let (base, joints) = (geometry.base.map(flat), geometry.platform.map(flat));
    for i in 0..6 {
        sketch.line([base[i], joints[i]], Stroke::new(STEEL, 5.0));
    }
    for (joints, color, name) in [(base, ORANGE, "B"), (joints, BLUE, "P")] {
        sketch.line([&joints[..], &joints[..1]].concat(), Stroke::new(color, 1.6));
        for (i, at) in joints.into_iter().enumerate() {
            let radius = at[0].hypot(at[1]);
            sketch.dot(at, 5.5, color);
            let shift = [20.0 * at[0] / radius, -20.0 * at[1] / radius];
            let shift = if shift[0].abs() < 7.0 { [0.0, shift[1]] } else { [0.6 * shift[0], shift[1]] };
            sketch.styled_word(at, format!("{name}_{}", i + 1), shift, 15.0, color);
        }
    }
    for (axis, name) in [([0.45, 0.0], "x"), ([0.0, 0.45], "y")] {
        sketch.arrow([[0.0; 2], axis], Stroke::new(BLACK, 1.6));
        sketch.word(axis, name, [if axis[0] > 0.0 { 8.0 } else { 0.0 }, -12.0]);
    }
    // The direction of a pair, and half the angle between its joints.
    sketch.line([[0.0; 2], [1.5, 0.0]], THIN.dashed(DOTTED));
    sketch.line([[0.0; 2], base[1]], THIN);
    sketch.line(plane_arc([0.0; 2], 0.95, [0.0, params.base_half_angle]), Stroke::new(ORANGE, 1.8));
    let half = 0.5 * params.base_half_angle;
    sketch.styled_word(
        [0.95 * half.cos(), 0.95 * half.sin()],
        format!("{:.0}°", params.base_half_angle.to_degrees()),
        [7.0, -2.0],
        14.0,
        ORANGE,
    );
    let pair = 60.0_f64.to_radians();
    sketch.line([[0.0; 2], [0.95 * pair.cos(), 0.95 * pair.sin()]], THIN.dashed(DOTTED));
    sketch.line([[0.0; 2], joints[1]], THIN);
    let ends = [pair - params.platform_half_angle, pair];
    sketch.line(plane_arc([0.0; 2], 0.6, ends), Stroke::new(BLUE, 1.8));
    let middle = 0.5 * (ends[0] + ends[1]);
    let at = [0.6 * middle.cos(), 0.6 * middle.sin()];
    sketch.styled_word(at, format!("{:.0}°", params.platform_half_angle.to_degrees()), [3.0, -14.0], 14.0, BLUE);
    for (radius, turn, name, color) in
        [(params.base_radius, 205.0_f64, "r_B", ORANGE), (params.platform_radius, 155.0, "r_P", BLUE)]
    {
        let (sin, cos) = turn.to_radians().sin_cos();
        sketch.dimension([[0.0; 2], [radius * cos, radius * sin]], Stroke::new(color, 1.2));
        let part = if sin > 0.0 { 0.55 } else { 0.3 };
        let at = [part * radius * cos, part * radius * sin];
        sketch.styled_word(
            at,
            format!("{name} = {radius} m"),
            [0.0, if sin > 0.0 { -28.0 } else { 30.0 }],
            14.0,
            color,
        );
    }
    Ok(vec![drawing("Figure 4.2: joints of base and platform from above, at home, to scale", (820, 780), sketch)])
}

/// Figure 4.3.
pub(crate) fn actuator() -> Result<Vec<Figure>, Failure> {
    let platform = Platform::default();
    let (params, legs) = (platform.params(), platform.legs(&HOME)?);
    let length = legs.length[0];
    let [x, y, z] = legs.direction[0];
    // In the vertical plane of the leg: along it, and across it to the left.
    let (sin, cos) = (z, x.hypot(y));
    let at = |along: f64, across: f64| [along * cos - across * sin, along * sin + across * cos];
    let bar = |from: f64, to: f64, half: f64| [at(from, half), at(to, half), at(to, -half), at(from, -half)];
    let mut sketch = Sketch::default();
    let outline = |sketch: &mut Sketch, corners: [[f64; 2]; 4], color: Color| {
        sketch.area(corners, color);
        sketch.line([&corners[..], &corners[..1]].concat(), THIN);
    };
    // Where one ends in the other is not declared: the cylinder is drawn up to two thirds of the leg.
    outline(&mut sketch, bar(0.5 * length, length - 0.03, 0.028), Color(236, 226, 214));
    outline(&mut sketch, bar(0.03, 0.66 * length, 0.055), PLATE);
    sketch.line([at(0.0, 0.0), at(length, 0.0)], Stroke::new(GRAY, 1.0).dashed(DASHED));
    for (end, word, shift) in [
        (0.0, "B_i: Hooke joint, on the base", [26.0, 20.0]),
        (length, "P_i: ball joint, on the platform", [16.0, -20.0]),
    ] {
        sketch.dot(at(end, 0.0), 8.0, GRAY);
        sketch.word(at(end, 0.0), word, shift);
    }
    let (cylinder, piston) = (params.cylinder_centre, length - params.piston_centre);
    for (centre, color, text, mass) in
        [(cylinder, BLUE, "cylinder", params.cylinder_mass), (piston, ORANGE, "piston", params.piston_mass)]
    {
        sketch.dot(at(centre, 0.0), 6.0, color);
        sketch.styled_word(at(centre, -0.06), format!("{text}: mass centre, {mass} kg"), [18.0, 4.0], 15.0, color);
    }
    let mut dimension = |from: f64, to: f64, off: f64, text: String, color: Color| {
        for end in [from, to] {
            sketch.line([at(end, 0.02), at(end, off + 0.02)], THIN.dashed(DOTTED));
        }
        sketch.dimension([at(from, off), at(to, off)], Stroke::new(color, 1.3));
        sketch.styled_word(at(0.5 * (from + to), off), text, [-10.0, -4.0], 14.0, color);
    };
    dimension(0.0, cylinder, 0.14, format!("l_1 = {cylinder} m"), BLUE);
    dimension(piston, length, 0.14, format!("l_2 = {} m", params.piston_centre), ORANGE);
    dimension(0.0, length, 0.34, format!("l_i = {length:.4} m"), BLACK);
    sketch.line([[-0.25, 0.0], [0.35, 0.0]], Stroke::new(GRAY, 1.6));
    let [px, pz] = at(length, 0.0);
    sketch.line([[px - 0.3, pz], [px + 0.25, pz]], Stroke::new(GRAY, 1.6));
    Ok(vec![drawing("Figure 4.3: an actuator at home, lengths along it to scale", (820, 760), sketch)])
}

/// Figure 4.4.
pub(crate) fn spherical() -> Result<Vec<Figure>, Failure> {
    let platform = Platform::default();
    let leg = 2;
    let [rho, alpha, beta] = platform.spherical_leg(leg, &POSE, &[0.0; 6], &[0.0; 6])?.position;
    let base = platform.geometry().base[leg];
    let joint = platform.geometry().joint(leg, &POSE);
    let foot = [joint[0], joint[1], base[2]];
    let mut solid = Solid::new(-105.0, 24.0);
    let length = 0.75;
    solid.frame(&upright(base), length, ["x_{B3}", "y_{B3}", "z_{B3}"], BLACK);
    let across = [alpha.cos(), alpha.sin(), 0.0];
    solid.line(&[base, foot], Stroke::new(GRAY, 1.4).dashed(DASHED));
    solid.line(&[foot, joint], Stroke::new(GRAY, 1.4).dashed(DASHED));
    solid.arrow(&[base, joint], Stroke::new(ORANGE, 2.6));
    solid.tinted(plus(base, 0.55, plus(joint, -1.0, base)), &format!("ρ = {rho:.3} m"), [12.0, -6.0], ORANGE);
    let azimuth = arc(base, [unit(0), unit(1)], 0.32, [0.0, alpha]);
    solid.arrow(&azimuth, Stroke::new(BLUE, 1.8));
    solid.tinted(azimuth[24], &format!("α = {:.1}°", alpha.to_degrees()).replace('-', "−"), [-8.0, 34.0], BLUE);
    let polar = arc(base, [unit(2), across], 0.66, [0.0, beta]);
    solid.arrow(&polar, Stroke::new(GREEN, 1.8));
    solid.tinted(polar[24], &format!("β = {:.1}°", beta.to_degrees()), [0.0, 30.0], GREEN);
    solid.dot(base, 5.0, GRAY);
    solid.dot(joint, 5.0, GRAY);
    solid.word(base, &format!("B_{}", leg + 1), [-12.0, 12.0]);
    solid.word(joint, &format!("P_{}", leg + 1), [0.0, -16.0]);
    Ok(vec![drawing("Figure 4.4: leg 3 in spherical coordinates, to scale", (820, 720), solid.sketch)])
}
