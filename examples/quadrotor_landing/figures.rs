//! Figures 5.2 to 5.9 of the thesis, and the curves as numbers.

use std::path::Path;

use mbs_cli::chart::{Curves, Figure, Line, Panel, Space, SpaceLine};
use mbs_examples::{Failure, output};

use crate::flight::{Flight, Moment};

/// The first figure of the thesis for case I; case II has the next four.
const FIRST: usize = 2;

pub(crate) fn write(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let first = FIRST + if flight.case.name == "I" { 0 } else { 4 };
    let write = |number: usize, what: &str, panels: Vec<Panel>| {
        let title = format!("Figure 5.{number}: {what}, case {}", flight.case.name);
        output::write_figure(folder, &format!("figure_5_{number}"), &Figure { title, size: (1100, 800), panels })
    };
    write(first, "path of the quadrotor", vec![path(flight)])?;
    let elevation: [Series; 2] = [("quadrotor", |m| m.state.q[2]), ("platform", |m| m.platform)];
    write(first + 1, "elevation", vec![curves(flight, "z [m]", &elevation)])?;
    let angles: [Series; 3] = [
        ("φ", |m| m.state.q[3].to_degrees()),
        ("θ", |m| m.state.q[4].to_degrees()),
        ("ψ", |m| m.state.q[5].to_degrees()),
    ];
    write(first + 2, "attitude", vec![curves(flight, "angle [°]", &angles)])?;
    let rotors: [Series; 4] = [
        ("rotor 1", |m| m.rotor_thrust[0]),
        ("rotor 2", |m| m.rotor_thrust[1]),
        ("rotor 3", |m| m.rotor_thrust[2]),
        ("rotor 4", |m| m.rotor_thrust[3]),
    ];
    let total: [Series; 1] = [("U", |m| m.thrust)];
    let panels = vec![curves(flight, "thrust [N]", &rotors), curves(flight, "thrust asked for [N]", &total)];
    write(first + 3, "forces of the rotors", panels)
}

type Series = (&'static str, fn(&Moment) -> f64);

fn curves(flight: &Flight, label: &str, series: &[Series]) -> Panel {
    let line = |&(name, value): &Series| Line::new(name, flight.moments.iter().map(|m| (m.t, value(m))).collect());
    Panel::Curves(Curves {
        x_label: "t [s]".to_string(),
        y_label: label.to_string(),
        x_range: 0.0..flight.touchdown.time,
        lines: series.iter().map(line).collect(),
    })
}

fn path(flight: &Flight) -> Panel {
    let points: Vec<[f64; 3]> = flight.moments.iter().map(|m| [m.state.q[0], m.state.q[1], m.state.q[2]]).collect();
    let [x, y, z, ..] = flight.touchdown.state.q;
    let marks =
        vec![(points[0], "start".to_string()), ([x, y, z], format!("touchdown at {:.2} s", flight.touchdown.time))];
    let lines = vec![SpaceLine { name: "quadrotor".to_string(), points, marks }];
    Panel::Space(Space { labels: ["x [m]", "y [m]", "z [m]"].map(String::from), lines })
}

pub(crate) fn write_table(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let mut header: Vec<String> =
        ["t_s", "x_m", "y_m", "z_m", "phi_rad", "theta_rad", "psi_rad"].map(String::from).into();
    header.extend(["vx_m_s", "vy_m_s", "vz_m_s", "phi_dot", "theta_dot", "psi_dot"].map(String::from));
    header.extend(["platform_m", "thrust_N", "rotor1_N", "rotor2_N", "rotor3_N", "rotor4_N"].map(String::from));
    let row = |m: &Moment| [&[m.t][..], &m.state.q, &m.state.qd, &[m.platform, m.thrust], &m.rotor_thrust].concat();
    let name = format!("case_{}_{}", flight.case.name, flight.name());
    output::write_table(folder, &name, &header, flight.moments.iter().map(row))
}
