//! Files of figures: 5.2 to 5.9 of the thesis, their like for the deck at sea, the driven platform, and the curves as
//! numbers.

use std::path::Path;

use mbs_chart::{Curves, Figure, Line, Panel, Space, SpaceLine};
use mbs_examples::quadrotor_landing::figures as thesis;
use mbs_examples::quadrotor_landing::flight::{Flight, MARINE, Moment};
use mbs_examples::quadrotor_landing::platform::{Comparison, OnPlatform};
use mbs_examples::{Failure, output};
use mbs_landing::quadrotor::driven::{DrivenMoment, TrackingError};
use mbs_platform::limits::LegState;
use mbs_platform::{LegVector, PlatformMotion};

/// Figures 5.2 to 5.9 for the cases of the thesis, and their like for the deck at sea.
pub(crate) fn write(folder: &Path, flight: &Flight, legs: &[(f64, LegState)]) -> Result<(), Failure> {
    let drawn = if flight.case == MARINE { at_sea(flight, legs) } else { thesis::drawn(flight, legs) };
    drawn.iter().try_for_each(|(name, figure)| output::write_figure(folder, name, figure, &crate::ASSUMED))
}

fn at_sea(flight: &Flight, legs: &[(f64, LegState)]) -> Vec<(String, Figure)> {
    let elevation: [Series; 2] = [("quadrotor", |m| m.state.q[2]), ("platform", |m| m.platform)];
    let angles: [Series; 3] = [
        ("φ", |m| m.state.q[3].to_degrees()),
        ("θ", |m| m.state.q[4].to_degrees()),
        ("ψ", |m| m.state.q[5].to_degrees()),
    ];
    let against_deck: [Series; 3] = [
        ("φ", |m| m.relative.attitude[0].to_degrees()),
        ("θ", |m| m.relative.attitude[1].to_degrees()),
        ("ψ", |m| m.relative.attitude[2].to_degrees()),
    ];
    let rotors: [Series; 4] = [
        ("rotor 1", |m| m.rotor_thrust[0]),
        ("rotor 2", |m| m.rotor_thrust[1]),
        ("rotor 3", |m| m.rotor_thrust[2]),
        ("rotor 4", |m| m.rotor_thrust[3]),
    ];
    let total: [Series; 1] = [("U", |m| m.thrust)];
    let leg_forces = leg_lines(legs.iter().map(|(t, legs)| (*t, legs.force)));
    let figure = |name: &str, what: &str, height: u32, panels: Vec<Panel>| {
        (format!("{MARINE}_{name}"), Figure { title: format!("Deck at sea: {what}"), size: (1100, height), panels })
    };
    vec![
        figure("path", "path of the quadrotor", 800, vec![path(flight)]),
        figure("elevation", "elevation", 800, vec![curves(flight, "z [m]", &elevation)]),
        figure(
            "attitude",
            "attitude",
            800,
            vec![curves(flight, "angle [°]", &angles), curves(flight, "against the deck [°]", &against_deck)],
        ),
        figure(
            "forces",
            "forces of the rotors and of the platform's legs",
            1000,
            vec![
                curves(flight, "thrust [N]", &rotors),
                curves(flight, "thrust asked for [N]", &total),
                panel("force of a leg [N]", flight.touchdown.time, leg_forces),
            ],
        ),
    ]
}

/// One line for each leg, or one for all where they do the same.
fn leg_lines(values: impl Iterator<Item = (f64, LegVector)>) -> Vec<Line> {
    let values: Vec<(f64, LegVector)> = values.collect();
    let largest = values.iter().flat_map(|(_, legs)| legs).fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let alike = values.iter().all(|(_, legs)| legs.iter().all(|x| (x - legs[0]).abs() <= 1e-6 * largest));
    let line = |name: String, leg: usize| Line::new(name, values.iter().map(|(t, legs)| (*t, legs[leg])).collect());
    if alike {
        vec![line("each leg".to_string(), 0)]
    } else {
        (0..6).map(|leg| line(format!("leg {}", leg + 1), leg)).collect()
    }
}

/// `NAME_platform`: the deck as it is to be and as it is, how far it is off, and what the legs are asked for.
pub(crate) fn write_platform<const K: usize>(folder: &Path, on_platform: &OnPlatform<K>) -> Result<(), Failure> {
    let case = table_name(on_platform.case);
    for (name, Comparison { scale, motion, driven, moments, .. }) in on_platform.comparisons() {
        let (end, middle) = (driven.touchdown.time, motion.mean()[2]);
        let of = |value: &dyn Fn(&DrivenMoment) -> f64| moments.iter().map(|m| (m.time, value(m))).collect();
        let plan = |m: &DrivenMoment| motion.at(m.time)[0];
        let elevations = vec![
            Line::new("to be", of(&|m| plan(m)[2] - middle)),
            Line::new("platform", of(&|m| m.platform.q[2] - middle)),
        ];
        let error = |m: &DrivenMoment| TrackingError::between(&m.platform.q, &plan(m));
        let mut errors = vec![Line::new("distance [mm]", of(&|m| 1e3 * error(m).distance))];
        if driven.greatest_error.angle > 1e-9 {
            errors.push(Line::new("angle [mrad]", of(&|m| 1e3 * error(m).angle)));
        }
        let panels = vec![
            panel("elevation [m]", end, elevations),
            panel("off by", end, errors),
            panel("length of a leg [m]", end, leg_lines(moments.iter().map(|m| (m.time, m.legs.length)))),
            panel("force asked for [N]", end, leg_lines(moments.iter().map(|m| (m.time, m.legs.force)))),
        ];
        let how = if name == "full" { "motion in full, raised".to_string() } else { format!("motion × {scale:.3}") };
        let title = format!("The platform under control, {}, {how}", case.replace('_', " "));
        let name = format!("{case}_platform_{name}");
        output::write_figure(folder, &name, &Figure { title, size: (1100, 1100), panels }, &crate::ASSUMED)?;
        let mut header: Vec<String> = ["t_s", "z_m", "height_m"].map(String::from).into();
        for coordinates in ["platform", "planned"] {
            header
                .extend(["x_m", "y_m", "z_m", "phi_rad", "theta_rad", "psi_rad"].map(|c| format!("{coordinates}_{c}")));
        }
        header.extend(leg_header());
        let row = |m: &DrivenMoment| {
            let height = m.deck.relative(&m.vehicle.q, &m.vehicle.qd).offset[2];
            let LegState { length, rate, force } = m.legs;
            [&[m.time, m.vehicle.q[2], height][..], &m.platform.q, &plan(m), &length, &rate, &force].concat()
        };
        output::write_table(folder, &name, &header, moments.iter().map(row))?;
    }
    Ok(())
}

fn leg_header() -> impl Iterator<Item = String> {
    ["length_m", "rate_m_s", "force_N"].into_iter().flat_map(|what| (1..=6).map(move |leg| format!("leg{leg}_{what}")))
}

/// `NAME_legs.csv`: what the legs do where the platform moves exactly as it is to.
pub(crate) fn write_legs(folder: &Path, case: &str, legs: &[(f64, LegState)]) -> Result<(), Failure> {
    let header: Vec<String> = ["t_s".to_string()].into_iter().chain(leg_header()).collect();
    let row = |(t, legs): &(f64, LegState)| [&[*t][..], &legs.length, &legs.rate, &legs.force].concat();
    output::write_table(folder, &format!("{}_legs", table_name(case)), &header, legs.iter().map(row))
}

fn table_name(case: &str) -> String {
    if case == MARINE { case.to_string() } else { format!("case_{case}") }
}

type Series = (&'static str, fn(&Moment) -> f64);

fn curves(flight: &Flight, label: &str, series: &[Series]) -> Panel {
    let line = |&(name, value): &Series| Line::new(name, flight.moments.iter().map(|m| (m.t, value(m))).collect());
    panel(label, flight.touchdown.time, series.iter().map(line).collect())
}

fn panel(label: &str, end: f64, lines: Vec<Line>) -> Panel {
    let (x_label, y_label) = ("t [s]".to_string(), label.to_string());
    Panel::Curves(Curves { x_label, y_label, x_range: 0.0..end, lines })
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
    let name = format!("{}_{}", table_name(flight.case), flight.kind.name());
    output::write_table(folder, &name, &header, flight.moments.iter().map(row))
}
