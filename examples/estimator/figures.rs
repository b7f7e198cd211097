//! One landing with the bounds that its filter states, averages over all with their bounds, markers in the image, and
//! where and how fast landings touch down.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel, PlaneLine};
use mbs_examples::{Failure, output};
use mbs_landing::estimator::nominal::ERRORS;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_landing::sensors::Sensors;
use mbs_landing::sensors::camera::{Image, MARKERS};
use nalgebra::SVector;

use crate::Case;
use crate::consistency::Looks;
use crate::monte_carlo::{Run, flown};
use crate::summary::sensors;

/// What is drawn of one landing.
struct Flight {
    /// Every moment: time, differences of estimate and truth, standard deviations of them.
    moments: Vec<(f64, SVector<f64, ERRORS>, SVector<f64, ERRORS>)>,
    images: Vec<Image>,
    end: f64,
}

impl Flight {
    fn of(heave: Heave<4>, seed: u64) -> Result<Self, Failure> {
        let (mut moments, mut images) = (Vec::new(), Vec::new());
        let [end, _] = flown(heave, seed, |moment| {
            let estimate = &moment.filter.estimate.nominal;
            moments.push((moment.time, estimate.differences(moment.truth), moment.filter.deviations()));
            images.extend(moment.image.map(|(image, _)| *image));
        })?;
        Ok(Flight { moments, images, end: end.time })
    }
}

/// Figures of a case, and of one landing of it; and the moments of that one as a table.
pub(crate) fn write(folder: &Path, case: &Case, heave: Heave<4>) -> Result<(), Failure> {
    let flight = Flight::of(heave, 0)?;
    let name = case.name;
    let figure = |key: &str, what: &str, size: (u32, u32), panels: Vec<Panel>| {
        let figure = Figure { title: format!("{what}, case {name}"), size, panels };
        output::write_figure(folder, &format!("estimator_{key}_{name}"), &figure, &crate::assumed_keys())
    };
    figure("errors", "Errors of one estimate and ±3σ as the filter states them", (1100, 1150), errors(&flight))?;
    figure("consistency", "Averages over landings of normalized squares", (900, 900), consistency(&case.runs))?;
    figure("markers", "Markers of the deck in the image during one landing", (900, 760), vec![markers(&flight)])?;
    figure("touchdown", "Touchdown on the estimate and on the true state", (900, 760), touchdown(&case.runs))?;
    write_table(folder, name, &flight)
}

/// What errs along three axes, with its unit.
const AXES: [(&str, &str); 5] =
    [("place", "m"), ("velocity", "m_s"), ("attitude", "rad"), ("gyro_bias", "rad_s"), ("accelerometer_bias", "m_s2")];

fn write_table(folder: &Path, case: &str, flight: &Flight) -> Result<(), Failure> {
    let mut words = "t_s".to_string();
    for kind in ["error", "sd"] {
        for (what, unit) in AXES {
            words += &["x", "y", "z"].map(|axis| format!(" {kind}_{what}_{axis}_{unit}")).concat();
        }
    }
    let rows = flight
        .moments
        .iter()
        .map(|(t, errors, deviations)| [&[*t][..], errors.as_slice(), deviations.as_slice()].concat());
    output::write_table(folder, &format!("estimator_{case}"), &words, rows)
}

/// There and back, with a gap in between.
fn band(above: impl Iterator<Item = (f64, f64)>, below: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = above.collect();
    let end = points.last().map_or(0.0, |point| point.0);
    points.push((end, f64::NAN));
    let mut back: Vec<(f64, f64)> = below.collect();
    back.reverse();
    points.extend(back);
    points
}

/// An error, its name with a unit, and how many of these make one of the SI.
type Shown = (usize, &'static str, f64);

const SHOWN: [[Shown; 2]; 5] = [
    [(0, "place x [mm]", 1e3), (2, "place z [mm]", 1e3)],
    [(3, "velocity x [mm/s]", 1e3), (5, "velocity z [mm/s]", 1e3)],
    [(6, "attitude about x [mrad]", 1e3), (8, "attitude about z [mrad]", 1e3)],
    [(9, "bias of gyroscope x [mrad/s]", 1e3), (11, "bias of gyroscope z [mrad/s]", 1e3)],
    [(12, "bias of accelerometer x [mm/s²]", 1e3), (14, "bias of accelerometer z [mm/s²]", 1e3)],
];

/// Of the first second what comes after it leaves no room for: all is shown from then on.
const SETTLED: f64 = 1.0;

fn errors(flight: &Flight) -> Vec<Panel> {
    let panel = |&(i, label, scale): &Shown| {
        let moments = || flight.moments.iter().filter(|(t, ..)| *t >= SETTLED).step_by(4);
        let side = |side: f64| moments().map(move |(t, _, deviations)| (*t, side * 3.0 * scale * deviations[i]));
        let error = moments().map(|(t, errors, _)| (*t, scale * errors[i])).collect();
        let lines = vec![Line::new("error", error), Line::new("±3σ", band(side(1.0), side(-1.0)))];
        Panel::curves(["t [s], from the first second on", label], SETTLED..flight.end, lines)
    };
    SHOWN.iter().map(|row| Panel::Row(row.iter().map(panel).collect())).collect()
}

fn consistency(runs: &[Run]) -> Vec<Panel> {
    let panel = |label: &str, freedom: f64, looks: &Looks| {
        let end = looks.0.last().map_or(1.0, |look| look.time);
        let mean = looks.0.iter().map(|look| (look.time, freedom * look.mean)).collect();
        let bounds = |i: usize| {
            let side = |side: usize| looks.0.iter().map(move |look| (look.time, freedom * look.bounds[i][side]));
            band(side(1), side(0))
        };
        let lines = vec![Line::new("average", mean), Line::new("95 %", bounds(0)), Line::new("99 %", bounds(1))];
        Panel::over_time(label, 0.0..end, lines)
    };
    let mut panels = vec![panel("error of the estimate, 15 degrees of freedom", ERRORS as f64, &Looks::of_state(runs))];
    for ((_, looks), label) in sensors(runs).iter().zip(["innovation of ranges", "innovation of images, a coordinate"])
    {
        panels.push(panel(label, 1.0, looks));
    }
    panels
}

fn markers(flight: &Flight) -> Panel {
    let [width, height] = Sensors::TYPICAL.camera.size;
    let up = |[right, down]: [f64; 2]| [right - 0.5 * width, 0.5 * height - down];
    let edge = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height], [0.0, 0.0]].map(up).to_vec();
    let paths = |markers: std::ops::Range<usize>| {
        let path = |i: usize| flight.images.iter().map(move |image| image[i].map_or([f64::NAN; 2], up));
        markers.flat_map(|i| path(i).chain([[f64::NAN; 2]])).collect::<Vec<_>>()
    };
    let marks = flight.images.first().and_then(|image| image[0]).map(|place| (up(place), "first image".to_string()));
    let lines = vec![
        PlaneLine::new("edge of the image", edge),
        PlaneLine::new("outer markers", paths(0..MARKERS / 2)),
        PlaneLine::new("inner markers", paths(MARKERS / 2..MARKERS)),
    ];
    Panel::plane(["right of the middle of the image [px]", "above it [px]"], lines, marks.into_iter().collect())
}

/// Parts of the landings that stay below a value.
fn touchdown(runs: &[Run]) -> Vec<Panel> {
    let panel = |label: &str, value: fn(&Touchdown) -> f64| {
        let part = |touchdown: fn(&Run) -> &Touchdown| {
            let mut values: Vec<f64> = runs.iter().map(|run| value(touchdown(run))).collect();
            values.sort_by(f64::total_cmp);
            let step = |(i, value): (usize, f64)| [i, i + 1].map(|i| (value, 100.0 * i as f64 / runs.len() as f64));
            values.into_iter().enumerate().flat_map(step).collect::<Vec<_>>()
        };
        let (estimated, exact) = (part(|run| &run.estimated), part(|run| &run.exact));
        let lines = vec![Line::new("on the estimate", estimated), Line::new("on the true state", exact)];
        Panel::fitted([label, "landings with less [%]"], 0.05, lines)
    };
    vec![
        panel("horizontal offset [mm]", |end| 1e3 * end.horizontal_offset),
        panel("relative velocity [mm/s]", |end| 1e3 * end.relative_velocity),
    ]
}
