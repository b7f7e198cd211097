//! The paths of the three, and how far they come from the closed forms.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel, PlaneLine};
use mbs_examples::{Failure, output};
use mbs_runtime::State;

use crate::coin::Coin;
use crate::edge::Edge;
use crate::flown::Flown;
use crate::rolling_coin;
use crate::sleigh::Sleigh;

pub(crate) fn write(folder: &Path, edge: &Edge, sleigh: &Sleigh, coin: &Coin) -> Result<(), Failure> {
    let figure = |name: &str, title: &str, size, panels| {
        output::write_figure(folder, name, &Figure { title: title.to_string(), size, panels }, &crate::ASSUMED)
    };
    let path = |flown: &Flown<3>| -> Vec<[f64; 2]> { flown.samples.iter().map(|(_, s)| [s.q[0], s.q[1]]).collect() };
    let turned = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| [y, -x]).collect::<Vec<_>>();
    let exact = turned(edge.flown.exact.iter().map(|s| [s.q[0], s.q[1]]).collect());
    let lines = vec![PlaneLine::new("integrated", turned(path(&edge.flown))), PlaneLine::new("cycloid", exact)];
    let marks = vec![([0.0, 0.0], "start, at rest".to_string())];
    let labels = ["across the slope y [m]", "up the slope −x [m]"];
    figure(
        "nonholonomic_edge",
        "A knife edge on an incline of 20°, turning at 0.7 rad/s",
        (1100, 640),
        vec![Panel::plane(labels, lines, marks), difference(&edge.flown, &[2])],
    )?;

    let centre = |s: &State<[f64; 3]>| [s.q[0] + sleigh.a * s.q[2].cos(), s.q[1] + sleigh.a * s.q[2].sin()];
    let centres = sleigh.flown.samples.iter().map(|(_, s)| centre(s)).collect();
    let lines = vec![PlaneLine::new("blade", path(&sleigh.flown)), PlaneLine::new("mass centre", centres)];
    let marks = vec![([0.0, 0.0], "start, backwards".to_string())];
    let plane = Panel::plane(["x [m]", "y [m]"], lines, marks);
    figure("nonholonomic_sleigh", "Chaplygin's sleigh, pushed backwards", (1000, 800), vec![plane])?;
    let column = |rows: &[[f64; 3]], i: usize| rows.iter().map(|row| (row[0], row[i])).collect::<Vec<_>>();
    let pair = |label: &str, i: usize| {
        let lines = vec![("integrated", column(&sleigh.rates, i)), ("closed form", column(&sleigh.exact_rates, i))];
        curves(label, lines)
    };
    let panels = vec![pair("v [m/s]", 1), pair("ω [rad/s]", 2), difference(&sleigh.flown, &[2])];
    figure("nonholonomic_sleigh_rates", "Chaplygin's sleigh: v = V tanh τ, ω = (V/k) sech τ", (1000, 850), panels)?;

    let radius = rolling_coin::Params::<f64>::default().radius;
    let mm = |points: Vec<[f64; 2]>| points.into_iter().map(|point| point.map(|x| 1e3 * x)).collect::<Vec<_>>();
    let samples = &coin.flown.samples;
    let centres = mm(samples.iter().map(|(_, s)| [s.q[0], s.q[1]]).collect());
    let contacts = mm(samples.iter().map(|(_, s)| coin.contact(s, radius)).collect());
    let lines = vec![PlaneLine::new("centre", centres), PlaneLine::new("point of contact", contacts)];
    let plane = Panel::plane(["x [mm]", "y [mm]"], lines, Vec::new());
    let title = "A coin that leans by 22.9° and goes round at 6 rad/s";
    figure("nonholonomic_coin", title, (900, 1100), vec![plane, difference(&coin.flown, &[2, 3, 4])])?;
    write_tables(folder, edge, sleigh, coin)
}

fn curves(label: &str, lines: Vec<(&str, Vec<(f64, f64)>)>) -> Panel {
    let end = lines.iter().flat_map(|line| &line.1).fold(0.0_f64, |most, point| most.max(point.0));
    Panel::over_time(label, 0.0..end, lines.into_iter().map(|(name, points)| Line::new(name, points)).collect())
}

/// From the closed form, in units of 10⁻¹⁵.
fn difference<const N: usize>(flown: &Flown<N>, angles: &[usize]) -> Panel {
    let small = |coordinates: &[usize]| {
        flown.differences(coordinates).into_iter().map(|(t, difference)| (t, 1e15 * difference)).collect()
    };
    curves("difference [10⁻¹⁵]", vec![("path [m]", small(&[0, 1])), ("angles [rad]", small(angles))])
}

fn write_tables(folder: &Path, edge: &Edge, sleigh: &Sleigh, coin: &Coin) -> Result<(), Failure> {
    fn rows<const N: usize>(flown: &Flown<N>) -> impl Iterator<Item = Vec<f64>> + '_ {
        flown.samples.iter().zip(&flown.exact).map(|((t, s), exact)| [&[*t][..], &s.q, &exact.q].concat())
    }
    let plane = "t_s x_m y_m phi_rad exact_x_m exact_y_m exact_phi_rad";
    output::write_table(folder, "nonholonomic_edge", plane, rows(&edge.flown))?;
    output::write_table(folder, "nonholonomic_sleigh", plane, rows(&sleigh.flown))?;
    let exact = "exact_x_m exact_y_m exact_heading_rad exact_lean_rad exact_spin_rad";
    let words = format!("t_s x_m y_m heading_rad lean_rad spin_rad {exact}");
    output::write_table(folder, "nonholonomic_coin", &words, rows(&coin.flown))
}
