//! The approach, what jets and plumes do, the contact, and burns that last.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};
use mbs_orbit::soft_docking::flight::Moment;

use crate::cases::{Burn, Case, Flight};

type Points = Vec<(f64, f64)>;

pub(crate) fn write(folder: &Path, flight: &Flight, contacts: &[Case], burns: &[Burn]) -> Result<(), Failure> {
    let write = |name: &str, title: &str, panels: Vec<Panel>| {
        let figure = Figure { title: title.to_string(), size: (1100, 850), panels };
        output::write_figure(folder, name, &figure, &crate::ASSUMED)
    };
    let touch = flight.report.contact.time;
    let before: Vec<&Moment> = flight.moments.iter().filter(|moment| moment.time < touch).collect();
    let of = |value: &dyn Fn(&Moment) -> f64| -> Points { before.iter().map(|m| (m.time, value(m))).collect() };
    let above = ("above", of(&|m| m.ports.place[2]));
    let roll = ("roll", of(&|m| m.ports.roll.to_degrees()));
    let panels = vec![
        curves("t [s]", "to go [m]", vec![("", of(&|m| -m.ports.place[0]))]),
        curves("t [s]", "behind the reference [mm]", vec![("", of(&|m| 1e3 * (m.wanted - m.ports.place[0])))]),
        curves("t [s]", "closing speed [m/s]", vec![("", of(&|m| m.ports.closing()))]),
        curves("t [s]", "beside the axis [m]", vec![("left", of(&|m| m.ports.place[1])), above]),
        curves("t [s]", "of the ports [°]", vec![("tilt", of(&|m| m.ports.tilt.to_degrees())), roll]),
    ];
    write("soft_docking_approach", "Final approach by the frames of the ports", panels)?;
    let panels = vec![
        curves("t [s]", "all jets, a period [N·s]", vec![("", of(&|m| m.impulse))]),
        curves("t [s]", "on the station, a period [N·s]", vec![("", of(&|m| m.plume))]),
        curves("t [s]", "station moved [mm]", {
            let [x, y, z] = [0, 1, 2].map(|i| of(&|m| 1e3 * m.pair.station.position[i]));
            vec![("away from the Earth", x), ("along the motion", y), ("normal", z)]
        }),
    ];
    write("soft_docking_jets", "Jets, and what their plumes do to the station", panels)?;
    let shown: Vec<&Case> =
        contacts.iter().filter(|case| ["within all limits", "tilted", "too slow"].contains(&case.name)).collect();
    let of_all = |value: &dyn Fn(&Case, usize) -> f64| -> Vec<(&str, Points)> {
        let line = |case: &&Case| {
            let points = (0..case.way.len()).map(|i| (case.way[i].time, value(case, i))).filter(|(t, _)| *t <= 20.0);
            (case.name, points.collect())
        };
        shown.iter().map(line).collect()
    };
    let panels = vec![
        curves("t from touch [s]", "depth [mm]", of_all(&|case, i| 1e3 * case.way[i].ports.place[0])),
        curves("t from touch [s]", "force of the ring [N]", of_all(&|case, i| case.way[i].force)),
        curves("t from touch [s]", "tilt [°]", of_all(&|case, i| case.way[i].ports.tilt.to_degrees())),
        curves("t from touch [s]", "energy lost [J]", of_all(&|case, i| case.contact.energy[0] - case.way[i].energy)),
    ];
    write("soft_docking_contact", "The ring: captured, and pushed back", panels)?;
    let loss: Points =
        burns.iter().rev().map(|burn| (burn.raise.durations[0], 1e3 * burn.raise.gravity_loss)).collect();
    let factor = loss.first().map_or(0.0, |(duration, loss)| loss / (duration * duration));
    let beyond = loss.iter().map(|(t, loss)| (*t, loss - factor * t * t)).collect();
    let duration = "duration of the first burn [s]";
    let low = |i: usize| -> Points { burns.iter().rev().map(|b| (b.raise.durations[0], b.raise.too_low[i])).collect() };
    let panels = vec![
        curves(duration, "gravity loss [mm/s]", vec![("", loss)]),
        curves(duration, "more than by the square of the duration [mm/s]", vec![("", beyond)]),
        curves(duration, "orbit too low [m]", vec![("periapsis", low(0)), ("apoapsis", low(1))]),
    ];
    write("soft_docking_burns", "Burns that last, from 320 km to 400 km", panels)?;
    tables(folder, flight, burns)
}

fn curves(x_label: &str, y_label: &str, lines: Vec<(&str, Points)>) -> Panel {
    let end = lines.iter().flat_map(|line| &line.1).fold(0.0_f64, |most, point| most.max(point.0));
    let lines = lines.into_iter().map(|(name, points)| Line::new(name, points)).collect();
    Panel::curves([x_label, y_label], 0.0..end, lines)
}

fn tables(folder: &Path, flight: &Flight, burns: &[Burn]) -> Result<(), Failure> {
    let ports = "depth_m left_m above_m closing_m_s tilt_rad roll_rad";
    let words = format!("t_s {ports} impulse_N_s plume_N_s ring_N energy_J");
    let row = |m: &Moment| {
        let ports = [m.ports.closing(), m.ports.tilt, m.ports.roll];
        [&[m.time][..], &m.ports.place, &ports, &[m.impulse, m.plume, m.ring, m.energy]].concat()
    };
    output::write_table(folder, "soft_docking_way", &words, flight.moments.iter().map(row))?;
    let words = "thrust_N first_s second_s gravity_loss_m_s periapsis_too_low_m apoapsis_too_low_m";
    let row = |burn: &Burn| {
        let raise = &burn.raise;
        [&[burn.thrust][..], &raise.durations, &[raise.gravity_loss], &raise.too_low].concat()
    };
    output::write_table(folder, "soft_docking_burns", words, burns.iter().map(row))
}
