//! What the machines do over time and over the scale, as figures and as numbers.

use std::path::Path;

use mbs_chart::curves::numbered;
use mbs_chart::{Figure, Line, Panel, Space, SpaceLine};
use mbs_examples::{Failure, output};
use mbs_landing::experiment::landed::Meeting;

use crate::assumed;
use crate::run::{Other, Outcome, Run, Sample, Simulated, Touched};

/// Files whose names begin with a word and the case.
pub(crate) fn write(folder: &Path, word: &str, run: &Run<'_>) -> Result<(), Failure> {
    let stem = format!("{word}_{}", run.case.name);
    if !run.others.is_empty() {
        scales(folder, &stem, run)?;
    }
    let Some(outcome) = &run.outcome else { return Ok(()) };
    let Ok(simulated) = &outcome.simulated else { return Ok(()) };
    let Simulated { tracked, samples } = simulated;
    let write = |name: &str, what: &str, panels: Vec<Panel>| {
        let title = format!("{what}, case {} at {:.5}", run.case.name, run.scale);
        let name = format!("{stem}_{name}");
        output::write_figure(folder, &name, &Figure { title, size: (1100, 900), panels }, &assumed::keys())
    };
    let end = tracked.contact.time;
    let over_time = |label: &str, lines: Vec<Line>| Panel::over_time(label, 0.0..end, lines);

    let [x, y] = run.experiment.cell.platform;
    let aside = vec![
        line("x", samples, |s| 1e3 * (s.flange.position[0] - x)),
        line("y", samples, |s| 1e3 * (s.flange.position[1] - y)),
    ];
    let panels = vec![path(run, outcome, simulated), over_time("from the middle [mm]", aside)];
    write("path", "Path of the flange", panels)?;
    let heights =
        |samples: &[Sample]| vec![line("flange", samples, |s| s.flange.position[2]), line("deck", samples, |s| s.deck)];
    let last = &samples[samples.partition_point(|s| s.look.time < end - LAST)..];
    let near = Panel::over_time("height, the end enlarged [m]", (end - LAST).max(0.0)..end, heights(last));
    write("elevation", "Elevation of flange and deck", vec![over_time("height [m]", heights(samples)), near])?;

    let angles = (1..7).map(|axis| line(axis_name(axis), samples, move |s| s.look.state.q[axis].to_degrees()));
    let carriage = vec![line("", samples, |s| s.look.state.q[0])];
    let panels = vec![over_time("q [°]", angles.collect()), over_time("carriage [m]", carriage)];
    write("axes", "Axes", panels)?;

    let robot = &run.experiment.robot;
    let (speeds, forces) = (robot.speed_limits(), robot.force_limits());
    let speeds =
        (0..7).map(|axis| line(axis_name(axis), samples, move |s| 100.0 * s.look.state.qd[axis] / speeds[axis]));
    let forces = (0..7).map(|axis| line(axis_name(axis), samples, move |s| 100.0 * s.look.forces[axis] / forces[axis]));
    let panels = vec![
        over_time("speed [% of limit]", speeds.collect()),
        over_time("force, torque [% of limit]", forces.collect()),
    ];
    write("limits", "Speeds and forces of the axes", panels)?;

    let panels = vec![
        over_time("position [mm]", vec![line("", samples, |s| 1e3 * s.look.error)]),
        over_time("attitude [°]", vec![line("", samples, |s| s.look.turn.to_degrees())]),
    ];
    write("tracking", "Tracking error of the flange", panels)?;

    // A level deck that goes up and down moves all legs alike.
    let leg = |which: usize| vec![line("leg 1 of 6 alike", samples, move |s| s.legs[which][0])];
    let limits = &run.experiment.platform.limits;
    let lengths =
        leg(0).into_iter().chain([flat("shortest", limits.shortest, end), flat("longest", limits.longest, end)]);
    let panels = vec![over_time("length [m]", lengths.collect()), over_time("force [N]", leg(1))];
    write("platform", "Legs of the platform", panels)?;
    if let Ok(touched) = &outcome.landed {
        let (end, panels) = contact(touched);
        let from = (end - LAST_CONTACT).max(0.0);
        let panels = panels.into_iter().map(|(label, lines)| Panel::over_time(label, from..end, lines)).collect();
        write("contact", "Contact of the vehicle with the deck that legs drive", panels)?;
    }
    table(folder, &stem, samples)
}

/// What is drawn of the contact, up to when \[s\].
const LAST_CONTACT: f64 = 5.0;

/// The end, and what is drawn up to it.
fn contact(touched: &Touched) -> (f64, Vec<(&'static str, Vec<Line>)>) {
    let meetings = &touched.meetings;
    let of = |value: &dyn Fn(&Meeting) -> f64| -> Vec<_> {
        meetings.iter().map(|meeting| (meeting.time, value(meeting))).collect()
    };
    let line = |value: &dyn Fn(&Meeting) -> f64| vec![Line::new("", of(value))];
    let legs = [0, 1, 2, 3, 4, 5].map(|leg| of(&|meeting| meeting.legs[leg]));
    let panels = vec![
        ("force on the deck [N]", line(&|meeting| meeting.load)),
        ("lowest foot over the deck [mm]", line(&|meeting| (1e3 * meeting.height).min(50.0))),
        ("platform off its plan [mm]", line(&|meeting| 1e3 * meeting.platform_error)),
        ("force of the legs [N]", numbered(["leg", "legs"], &legs)),
    ];
    (meetings.last().map_or(0.0, |meeting| meeting.time), panels)
}

/// How long before the contact elevations are drawn once more \[s\].
const LAST: f64 = 2.0;

fn axis_name(axis: usize) -> String {
    if axis == 0 { "carriage".to_string() } else { format!("joint {axis}") }
}

fn line(name: impl Into<String>, samples: &[Sample], value: impl Fn(&Sample) -> f64) -> Line {
    Line::new(name, samples.iter().map(|s| (s.look.time, value(s))).collect())
}

fn flat(name: &str, value: f64, end: f64) -> Line {
    Line::new(name, vec![(0.0, value), (end, value)])
}

fn path(run: &Run<'_>, outcome: &Outcome<'_>, simulated: &Simulated) -> Panel {
    let Simulated { tracked, samples } = simulated;
    let points: Vec<[f64; 3]> = samples.iter().map(|s| s.flange.position).collect();
    let [x, y] = run.experiment.cell.platform;
    let contact = &tracked.contact;
    let place = [x + contact.position[0], y + contact.position[1], outcome.plan.deck_height(contact.time)[0]];
    let marks = vec![(points[0], "start".to_string()), (place, format!("contact at {:.2} s", contact.time))];
    let deck = samples.iter().map(|s| [x, y, s.deck]).collect();
    let lines = vec![
        SpaceLine { name: "flange".to_string(), points, marks },
        SpaceLine { name: "middle of the deck".to_string(), points: deck, marks: Vec::new() },
    ];
    Panel::Space(Space { labels: ["x [m]", "y [m]", "z [m]"].map(String::from), lines })
}

/// What every scale asks for: the name of a column, panel and name of a curve where one is drawn, and the value.
type Column = (&'static str, Option<(usize, &'static str)>, fn(&Other) -> f64);
const COLUMNS: [Column; 7] = [
    ("scale", None, |o| o.scale),
    ("standoff_m", None, |o| o.standoff),
    ("clearance", Some((1, "ranges, singularities, bodies")), |o| o.clearance),
    ("speed_ratio", Some((0, "speed")), |o| o.survey.speed_ratio.value),
    ("force_ratio", Some((0, "force")), |o| o.survey.force_ratio.value),
    ("singularity_margin", Some((1, "singularities alone")), |o| o.survey.singularity_margin.value),
    ("distance_m", None, |o| o.survey.distance.value),
];

fn scales(folder: &Path, stem: &str, run: &Run<'_>) -> Result<(), Failure> {
    let name = format!("{stem}_scales");
    let rows = run.others.iter().map(|other| COLUMNS.map(|(.., of)| of(other)).into());
    output::write_table(folder, &name, &COLUMNS.map(|(name, ..)| name).join(" "), rows)?;
    let (Some(first), Some(last)) = (run.others.first(), run.others.last()) else { return Ok(()) };
    let panel = |which: usize, label: &str| {
        let drawn =
            COLUMNS.iter().filter_map(|(_, name, of)| name.filter(|name| name.0 == which).map(|name| (name.1, of)));
        let points = |of: &fn(&Other) -> f64| run.others.iter().map(|other| (other.scale, of(other))).collect();
        let lines = drawn.map(|(name, of)| Line::new(name, points(of))).collect();
        Panel::curves(["scale of the landing", label], first.scale..last.scale, lines)
    };
    let panels = vec![
        panel(0, "greatest of an axis, part of its limit"),
        panel(1, "least distance, part of half a range; below 0 bodies overlap"),
    ];
    let title = format!("What a scale asks of the arm, case {}; {:.5} is feasible", run.case.name, run.scale);
    output::write_figure(folder, &name, &Figure { title, size: (1100, 800), panels }, &assumed::keys())
}

fn table(folder: &Path, stem: &str, samples: &[Sample]) -> Result<(), Failure> {
    let axes = "q0_m q[1-6]_rad qd0_m_s qd[1-6]_rad_s wanted_q0_m wanted_q[1-6]_rad force0_N force[1-6]_Nm";
    let flange = "flange_x_m flange_y_m flange_z_m deck_m error_m turn_rad";
    let words = format!("t_s {axes} {flange} leg_length[1-6]_m leg_force[1-6]_N");
    let row = |s: &Sample| {
        let Sample { look, flange, deck, legs: [lengths, forces] } = s;
        let axes = [look.state.q, look.state.qd, look.wanted.q, look.forces].concat();
        [&[look.time][..], &axes, &flange.position, &[*deck, look.error, look.turn], lengths, forces].concat()
    };
    output::write_table(folder, stem, &words, samples.iter().map(row))
}
