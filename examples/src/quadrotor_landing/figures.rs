//! Figures 5.2 to 5.9: the guided landings of the thesis.

use mbs_chart::{Figure, Line, Panel, PlaneLine};
use mbs_platform::limits::LegState;

use super::flight::{Flight, Moment, PLACE};

/// How long a start is that is shown enlarged: the attitude's, the rotors' \[s\].
const STARTS: [f64; 2] = [6.0, 1.5];
/// How long the end is \[s\].
const END: f64 = 2.0;
/// The first figure of the thesis for case I; case II has the next four.
const FIRST: usize = 2;

/// Figures 5.2 to 5.5 of a landing of case I, 5.6 to 5.9 of case II, with the names of their files and what the legs
/// of the platform do meanwhile.
#[must_use]
pub fn drawn(flight: &Flight, legs: &[(f64, LegState)]) -> Vec<(String, Figure)> {
    let case = flight.case;
    let first = FIRST + if case == "I" { 0 } else { 4 };
    let figure = |i: usize, what: &str, height: u32, panels: Vec<Panel>| {
        let number = first + i;
        let title = format!("Figure 5.{number}: {what}, case {case}");
        (format!("figure_5_{number}"), Figure { title, size: (900, height), panels })
    };
    vec![
        figure(0, "path of the quadrotor", 800, path(flight)),
        figure(1, "elevation of the platform", 860, elevation(flight)),
        figure(2, "attitude angles of the quadrotor", 680, attitude(flight)),
        figure(3, "forces of the rotors and of the platform's legs", 1000, forces(flight, legs)),
    ]
}

/// From two sides and from above, sideways enlarged since the path is that narrow; then over time.
pub fn path(flight: &Flight) -> Vec<Panel> {
    let time = flight.touchdown.time;
    let [x, y, z, ..] = flight.touchdown.state.q;
    let positions: Vec<[f64; 3]> =
        flight.moments.iter().map(|m| [m.state.q[0], m.state.q[1], m.state.q[2]]).chain([[x, y, z]]).collect();
    let from_a_side = |axis: usize, name: &str| {
        let points: Vec<(f64, f64)> = positions.iter().map(|place| (place[axis], place[2])).collect();
        let (start, end) = (points[0], points[points.len() - 1]);
        let line = Line::new("", points).marked(start, "start").marked(end, format!("{time:.2} s"));
        Panel::fitted([&format!("{name} [m]"), "z [m], scales differ"], 0.15, vec![line])
    };
    let offset = |[x, y, _]: [f64; 3]| [x - PLACE[0], y - PLACE[1]];
    let above = Panel::plane(
        ["x − 12 m [m]", "y − 7 m [m], from above"],
        vec![PlaneLine::new("", positions.iter().map(|place| offset(*place)).collect())],
        vec![(offset(positions[0]), "start".to_string())],
    );
    let offsets: [Series; 2] = [("x − 12 m", |m| m.state.q[0] - PLACE[0]), ("y − 7 m", |m| m.state.q[1] - PLACE[1])];
    vec![
        Panel::Row(vec![from_a_side(0, "x"), from_a_side(1, "y"), above]),
        over(flight, "beside the middle of the platform [m]", 0.0..time, &offsets),
    ]
}

/// The platform, then with the vehicle, then what is between them at the end.
fn elevation(flight: &Flight) -> Vec<Panel> {
    let time = flight.touchdown.time;
    let platform: [Series; 1] = [("platform", |m| m.platform)];
    let both: [Series; 2] = [("platform", |m| m.platform), ("quadrotor", |m| m.state.q[2])];
    let height: [Series; 1] = [("", |m| m.state.q[2] - m.platform)];
    vec![
        over(flight, "elevation of the platform [m]", 0.0..time, &platform),
        over(flight, "z [m]", 0.0..time, &both),
        over(flight, "height over the platform, the end enlarged [m]", time - END..time, &height),
    ]
}

fn attitude(flight: &Flight) -> Vec<Panel> {
    vec![
        over(flight, "angle [°]", 0.0..flight.touchdown.time, &ANGLES),
        over(flight, "angle, the start enlarged [°]", 0.0..STARTS[0], &ANGLES),
    ]
}

/// "Actuators" may be the rotors or the legs of the platform: both.
fn forces(flight: &Flight, legs: &[(f64, LegState)]) -> Vec<Panel> {
    let time = flight.touchdown.time;
    let total: [Series; 1] = [("", |m| m.rotor_thrust.iter().sum())];
    let leg = legs.iter().map(|(t, legs)| (*t, legs.force[0])).collect();
    vec![
        over(flight, "thrust of a rotor [N]", 0.0..time, &ROTORS),
        over(flight, "thrust of a rotor, the start enlarged [N]", 0.0..STARTS[1], &ROTORS),
        over(flight, "thrust of all rotors [N]", 0.0..time, &total),
        Panel::over_time("force of each leg of the platform [N]", 0.0..time, vec![Line::new("", leg)]),
    ]
}

/// The name of a line, and its value at a moment.
pub type Series = (&'static str, fn(&Moment) -> f64);

/// The angles of the vehicle \[°\].
pub const ANGLES: [Series; 3] = [
    ("roll φ", |m| m.state.q[3].to_degrees()),
    ("pitch θ", |m| m.state.q[4].to_degrees()),
    ("yaw ψ", |m| m.state.q[5].to_degrees()),
];
/// Thrusts \[N\].
pub const ROTORS: [Series; 4] = [
    ("rotor 1", |m| m.rotor_thrust[0]),
    ("rotor 2", |m| m.rotor_thrust[1]),
    ("rotor 3", |m| m.rotor_thrust[2]),
    ("rotor 4", |m| m.rotor_thrust[3]),
];

/// Lines over a part of the flight.
pub fn over(flight: &Flight, label: &str, range: std::ops::Range<f64>, series: &[Series]) -> Panel {
    let line = |&(name, value): &Series| Line::new(name, flight.moments.iter().map(|m| (m.t, value(m))).collect());
    Panel::over_time(label, range, series.iter().map(line).collect())
}
