//! Figures 5.1, 7.1 and 7.2: frames of the vehicle, by its generated pose, and about a station.

use std::f64::consts::PI;

use mbs_chart::Figure;
use mbs_chart::style::{BLACK, BLUE, Color, DASH_DOT, DASHED, DOTTED, GRAY, GREEN, LIGHT, ORANGE, PINK, Stroke};
use mbs_examples::Failure;
use mbs_models::quadrotor_euler::QuadrotorEuler;
use mbs_orbit::EARTH_MU;
use mbs_orbit::station::{Station, from_cylindrical};
use mbs_runtime::{Pose, State};

use crate::solid::{Point, STEEL, Solid, THIN, arc, drawing, plus, unit, upright};

/// Figure 5.1.
pub(crate) fn vehicle() -> Result<Vec<Figure>, Failure> {
    let vehicle = QuadrotorEuler::<f64>::default();
    let [roll, pitch, yaw] = [10.0_f64, 6.0, 52.0].map(f64::to_radians);
    let body = vehicle.pose(&[[0.0; 3]; 3], &[1.3, 1.5, 1.25, roll, pitch, yaw]);
    let arm = vehicle.params().arm;
    let mut solid = Solid::new(-66.0, 32.0);
    solid.frame(&upright([0.0; 3]), 0.8, ["x", "y", "z"], BLACK);
    solid.word([0.0; 3], "O", [-10.0, 12.0]);
    solid.arrow(&[[0.0; 3], body.position], Stroke::new(GRAY, 1.4).dashed(DASHED));
    solid.word(plus([0.0; 3], 0.5, body.position), "(x, y, z)", [10.0, 12.0]);
    let axes: [Point; 3] = [0, 1, 2].map(|axis| std::array::from_fn(|row| body.rotation[row][axis]));
    // In the order of the mechanism's rotors: in front, right, behind, left; 1 and 3 spin about −z.
    let places = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (i, place) in places.into_iter().enumerate() {
        let hub = body.transform_point(place.map(|x| arm * x));
        solid.line(&[body.position, hub], Stroke::new(STEEL, 6.0));
        let disc = arc(hub, [axes[0], axes[1]], 0.3, [0.0, 2.0 * PI]);
        solid.area(&disc, LIGHT);
        solid.line(&disc, THIN);
        let turn = if i % 2 == 0 { [0.9 * PI, -0.5 * PI] } else { [-0.5 * PI, 0.9 * PI] };
        solid.arrow(&arc(hub, [axes[0], axes[1]], 0.19, turn), Stroke::new(BLUE, 1.6));
        let tip = plus(hub, 0.45, axes[2]);
        solid.arrow(&[hub, tip], Stroke::new(ORANGE, 2.2));
        solid.tinted(tip, &format!("T_{}", i + 1), [-8.0, -2.0], ORANGE);
        let below = plus(plus(hub, -0.22, axes[0]), -0.22, axes[1]);
        solid.tinted(below, &format!("Ω_{}", i + 1), [0.0, 14.0], BLUE);
    }
    solid.frame(&body, arm + 0.6, ["x_d", "y_d", "z_d"], GREEN);
    solid.word(body.position, "O_d", [10.0, 14.0]);
    solid.arrow(&[body.position, plus(body.position, -0.75, unit(2))], Stroke::new(PINK, 2.2));
    solid.tinted(plus(body.position, -0.75, unit(2)), "m g", [-8.0, 0.0], PINK);
    let title = "Figure 5.1: inertial frame and frame of the vehicle, with its rotors";
    Ok(vec![drawing(title, (900, 700), solid.sketch)])
}

/// Figures 7.1 and 7.2.
pub(crate) fn orbits() -> Result<Vec<Figure>, Failure> {
    // Both in units of the periapsis; what is near the station is enlarged.
    let ellipse = About {
        station: Station::from_periapsis(EARTH_MU, UNIT, 0.25)?,
        part: 0.075,
        names: ["ρ", "r_ν", "O", "C"],
        centre: ["O_1", "x_1", "y_1", "z_1"],
    };
    let circle = About {
        station: Station::on_a_circle(EARTH_MU, UNIT)?,
        part: 0.13,
        names: ["r", "r_t", "station", "chaser"],
        centre: ["Earth", "x_i", "y_i", "z_i"],
    };
    Ok(vec![
        ellipse.figure("Figure 7.1: inertial and moving frame, not to scale")?,
        circle.figure("Figure 7.2: relative motion about a station on its orbit, not to scale")?,
    ])
}

/// The unit of lengths \[m\].
const UNIT: f64 = 7e6;

/// A station on its orbit and a body about it.
struct About {
    station: Station,
    /// Of the orbit since the periapsis.
    part: f64,
    /// Of the body's distance, of the station's, of both themselves.
    names: [&'static str; 4],
    /// Of the centre and its axes.
    centre: [&'static str; 4],
}

impl About {
    fn place(&self, part: f64) -> Result<Point, Failure> {
        let position = self.station.state(part * self.station.period())?.position;
        Ok(std::array::from_fn(|i| position[i] / UNIT))
    }

    fn figure(&self, title: &str) -> Result<Figure, Failure> {
        let mut solid = Solid::new(-72.0, 32.0);
        let orbit = (-14..=44).map(|k| self.place(f64::from(k) / 120.0)).collect::<Result<Vec<_>, _>>()?;
        solid.line(&orbit, Stroke::new(GRAY, 1.4).dashed(DASH_DOT));
        let [centre, axes @ ..] = self.centre;
        if centre == "Earth" {
            solid.dot([0.0; 3], 20.0, Color(206, 224, 238));
        }
        solid.frame(&upright([0.0; 3]), 0.42, axes, BLACK);
        solid.word([0.0; 3], centre, [if centre == "Earth" { -24.0 } else { -8.0 }, 14.0]);

        let place = self.place(self.part)?;
        let angle = place[1].atan2(place[0]);
        let (sin, cos) = angle.sin_cos();
        let frame = Pose { position: place, rotation: [[cos, -sin, 0.0], [sin, cos, 0.0], unit(2)] };
        solid.arrow(&[[0.0; 3], place], Stroke::new(BLUE, 2.2));
        let [distance, radius, origin, body] = self.names;
        solid.tinted(plus([0.0; 3], 0.62, place), radius, [0.0, -15.0], BLUE);
        let anomaly = arc([0.0; 3], [unit(0), unit(1)], 0.3, [0.0, angle]);
        solid.arrow(&anomaly, Stroke::new(BLUE, 1.6));
        solid.tinted(anomaly[24], "ν", [10.0, 4.0], BLUE);

        let theta = 38.0_f64.to_radians();
        let local = |r: f64, z: f64| {
            let state = State::new([r, theta, z], [0.0; 3]);
            frame.transform_point(from_cylindrical(&state).q)
        };
        solid.frame(&frame, 0.5, ["x", "y", "z"], GREEN);
        let (foot, top) = (local(0.7, 0.0), local(0.7, 0.34));
        solid.arrow(&[place, foot], Stroke::new(ORANGE, 2.2));
        solid.tinted(plus(place, 0.6, plus(foot, -1.0, place)), distance, [0.0, -13.0], ORANGE);
        solid.arrow(&[foot, top], Stroke::new(ORANGE, 2.2));
        solid.tinted(plus(foot, 0.5, plus(top, -1.0, foot)), "z", [9.0, 0.0], ORANGE);
        solid.line(&[place, top], THIN.dashed(DOTTED));
        let (u, v) = ([cos, sin, 0.0], [-sin, cos, 0.0]);
        let turn = arc(place, [u, v], 0.33, [0.0, theta]);
        solid.arrow(&turn, Stroke::new(ORANGE, 1.6));
        solid.tinted(turn[24], "θ", [9.0, -2.0], ORANGE);
        solid.line(&[[0.0; 3], top], THIN.dashed(DASHED));
        solid.dot(place, 5.0, GREEN);
        solid.dot(top, 5.0, PINK);
        solid.word(place, origin, [12.0, 14.0]);
        solid.tinted(top, body, [0.0, -16.0], PINK);
        Ok(drawing(title, (900, 700), solid.sketch))
    }
}
