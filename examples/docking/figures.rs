//! The way to the port, the approach in its corridor, the budget.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel, PlaneLine};
use mbs_examples::Failure;
use mbs_examples::output::{write_figure, write_table};
use mbs_orbit::mission::{Axis, Moment, Phase};

use crate::flight::Flight;

pub(crate) fn write(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let axis = match flight.mission.axis {
        Axis::VBar => "V-bar",
        Axis::RBar => "R-bar",
    };
    let write = |name: &str, what: &str, panels: Vec<Panel>| {
        let title = format!("{what}, {axis}");
        write_figure(folder, name, &Figure { title, size: (1100, 850), panels }, &crate::ASSUMED)
    };
    let far = way(flight, &[Phase::Phasing, Phase::Homing]);
    let near = way(flight, &[Phase::Homing, Phase::Closing, Phase::Approach, Phase::Docking]);
    write("docking_way", "Way to the station", vec![far, near])?;
    let mut last = lines(flight, &[Phase::Closing, Phase::Approach, Phase::Docking], 1.0);
    last.push(sphere(flight));
    write("docking_closing", "Closing and approach", vec![plane(last)])?;
    let panels = vec![corridor(flight), beside(flight), speed(flight)];
    write("docking_approach", "Approach in its corridor", panels)?;
    write("docking_delta_v", "Changes of velocity up to then", vec![budget(flight)])
}

type Points = Vec<(f64, f64)>;

fn curves(x_label: &str, y_label: &str, lines: Vec<(String, Points)>) -> Panel {
    let lines = lines.into_iter().map(|(name, points)| Line::new(name, points)).collect();
    Panel::fitted([x_label, y_label], 0.02, lines)
}

/// Metres in the orbital plane, both axes to one scale.
fn plane(lines: Vec<(String, Points)>) -> Panel {
    let line =
        |(name, points): (String, Points)| PlaneLine::new(name, points.into_iter().map(|(y, x)| [y, x]).collect());
    let lines = lines.into_iter().map(line).collect();
    Panel::plane(["along the motion y [m]", "radial x [m]"], lines, vec![([0.0, 0.0], "station".to_string())])
}

/// The moments of a phase, from the last one of the phase before on.
fn of_phase(flight: &Flight, phase: Phase) -> impl Iterator<Item = &Moment> {
    let moments = &flight.moments;
    let first = moments.iter().position(|moment| moment.phase == phase).unwrap_or(moments.len());
    let last = moments.iter().rposition(|moment| moment.phase == phase).map_or(first, |last| last + 1);
    moments[first.saturating_sub(1)..last].iter()
}

/// In the orbital plane, seen from its pole: along the motion to the right, away from the Earth up.
fn lines(flight: &Flight, phases: &[Phase], scale: f64) -> Vec<(String, Points)> {
    let line = |&phase: &Phase| {
        let points = of_phase(flight, phase).map(|m| (scale * m.relative.position[1], scale * m.relative.position[0]));
        (phase.name().to_string(), points.collect())
    };
    phases.iter().map(line).collect()
}

fn way(flight: &Flight, phases: &[Phase]) -> Panel {
    curves("along the motion y [km]", "radial x [km]", lines(flight, phases, 1e-3))
}

/// What of the keep-out sphere is in the orbital plane.
fn sphere(flight: &Flight) -> (String, Points) {
    let point = |k: u32| {
        let (sin, cos) = (std::f64::consts::PI * f64::from(k) / 60.0).sin_cos();
        (flight.mission.keep_out * cos, flight.mission.keep_out * sin)
    };
    ("keep-out sphere".to_string(), (0..=120).map(point).collect())
}

/// Distance from the axis against the distance to go \[m\].
fn from_axis(flight: &Flight, phase: Phase) -> Points {
    let zones = flight.mission.zones();
    of_phase(flight, phase).map(|m| zones.from_port(&m.relative.position)).collect()
}

fn corridor(flight: &Flight) -> Panel {
    let zones = flight.mission.zones();
    let wall = |k: u32| {
        let along = flight.mission.approach_distance * f64::from(k) / 100.0;
        (along, zones.mouth + along * zones.half_angle.tan())
    };
    let mut lines = [Phase::Approach, Phase::Docking].map(|p| (p.name().to_string(), from_axis(flight, p))).to_vec();
    lines.push(("corridor".to_string(), (0..=100).map(wall).collect()));
    curves("distance to go [m]", "from the axis [m]", lines)
}

fn beside(flight: &Flight) -> Panel {
    let line = |phase: Phase| {
        let points = from_axis(flight, phase).into_iter().map(|(along, beside)| (along, 100.0 * beside));
        (phase.name().to_string(), points.collect())
    };
    curves("distance to go [m]", "from the axis [cm]", vec![line(Phase::Approach), line(Phase::Docking)])
}

fn speed(flight: &Flight) -> Panel {
    let zones = flight.mission.zones();
    let outward = flight.mission.axis.outward();
    let line = |phase: Phase| {
        let point = |m: &Moment| {
            let velocity = m.relative.velocity;
            let closing: f64 = -(0..3).map(|i| velocity[i] * outward[i]).sum::<f64>();
            (zones.from_port(&m.relative.position).0, closing)
        };
        (phase.name().to_string(), of_phase(flight, phase).map(point).collect())
    };
    curves("distance to go [m]", "closing speed [m/s]", vec![line(Phase::Approach), line(Phase::Docking)])
}

/// Steps at the burns; each phase goes on where the one before ended.
fn budget(flight: &Flight) -> Panel {
    let (mut total, mut begin) = (0.0, 0.0);
    let mut lines = Vec::new();
    for phase in Phase::ALL {
        let end = begin + flight.report.phases[phase as usize].duration;
        let mut points = vec![(begin, total)];
        for burn in flight.burns.iter().filter(|burn| burn.phase == phase) {
            points.push((burn.time, total));
            total += burn.delta_v.iter().map(|v| v * v).sum::<f64>().sqrt();
            points.push((burn.time, total));
        }
        points.push((end, total));
        lines.push((phase.name().to_string(), points));
        begin = end;
    }
    curves("t [s]", "Δv [m/s]", lines)
}

pub(crate) fn write_tables(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let row = |m: &Moment| [&[m.time, f64::from(m.phase as u8)][..], &m.relative.to_array()].concat();
    write_table(folder, "docking_way", "t_s phase x_m y_m z_m vx_m_s vy_m_s vz_m_s", flight.moments.iter().map(row))?;
    let rows = flight.burns.iter().map(|burn| [&[burn.time, f64::from(burn.phase as u8)][..], &burn.delta_v].concat());
    write_table(folder, "docking_burns", "t_s phase dvx_m_s dvy_m_s dvz_m_s", rows)
}
