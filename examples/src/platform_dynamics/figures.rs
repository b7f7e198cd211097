//! Figures 4.5 to 4.12 of the thesis, each with its numbers as CSV, and the platform in three poses.

use std::path::Path;

use crate::Failure;
use crate::output::{write_figure, write_figures, write_records};
use mbs_chart::{Figure, Line, Panel, Space, SpaceLine};
use mbs_platform::{Coordinates, HOME, LegVector, Motion, Platform};

use super::tables::{DURATION, Run, Samples, TABLE_4, table_3, table_4};

/// What the poses rest on.
const POSES: [&str; 6] = [
    "platform.radii",
    "platform.half_angles",
    "platform.home",
    "platform.attitude",
    "platform.frequency",
    "platform.height",
];

/// Lines of one panel: names and values at all samples.
type Lines = Vec<(String, Vec<f64>)>;

/// Writes the figures of the thesis, each with its numbers, and the poses.
pub fn write(folder: &Path, platform: &Platform) -> Result<(), Failure> {
    let samples = Samples::fine();
    for drawing in along_table_3(platform, &samples)?.into_iter().chain(along_table_4(platform, &samples)?) {
        write_values(folder, &samples, &drawing)?;
        write_figures(folder, &[(drawing.name.clone(), drawing.figure(&samples))])?;
    }
    poses(folder, platform)
}

/// A figure of the thesis, before it is drawn.
pub struct Drawing {
    /// The name of its files.
    pub name: String,
    /// Above its panels.
    pub title: String,
    /// What the vertical axis says, and the lines.
    panels: Vec<(String, Lines)>,
}

/// Figures 4.5 to 4.8.
pub fn along_table_3(platform: &Platform, samples: &Samples) -> Result<Vec<Drawing>, Failure> {
    let runs = table_3(platform, samples)?;
    let lengths = vec![("l [m]".to_string(), legs(&runs[0].lengths))];
    let title = "Figure 4.5: lengths of the legs, table 3".to_string();
    let mut drawings = vec![Drawing { name: "figure_4_5".to_string(), title, panels: lengths }];
    for (number, run) in [6, 8, 7].into_iter().zip(&runs) {
        let title = format!("Figure 4.{number}: forces of the legs, table 3, {}", payload(run));
        drawings.push(Drawing { name: format!("figure_4_{number}"), title, panels: forces(run) });
    }
    Ok(drawings)
}

/// Figures 4.9 to 4.12.
pub fn along_table_4(platform: &Platform, samples: &Samples) -> Result<Vec<Drawing>, Failure> {
    let runs = TABLE_4.map(|(_, angles)| table_4(platform, angles, samples).map(|run| (angles, run)));
    let runs = runs.into_iter().collect::<Result<Vec<_>, _>>()?;
    let drawing = |leg: usize| {
        let title = format!("Figure 4.{}: sensitivity of the force of leg {}, table 4", 9 + leg, leg + 1);
        let of = |value: &dyn Fn(&Run, usize) -> f64| -> Lines {
            let line = |(angles, run): &([f64; 3], Run)| {
                (attitude_name(angles), (0..samples.0.len()).map(|k| value(run, k)).collect::<Vec<_>>())
            };
            runs.iter().map(line).collect()
        };
        let force = |run: &Run, k: usize| run.forces[k][leg];
        let panels = vec![
            (format!("F{} [N]", leg + 1), of(&force)),
            (format!("F{} less that at φ 0°, θ 0° [N]", leg + 1), of(&|run, k| force(run, k) - force(&runs[0].1, k))),
            (format!("of F{} by the legs' own mass [N]", leg + 1), of(&|run, k| by_own_mass(run)[k][leg])),
        ];
        Drawing { name: format!("figure_4_{}", 9 + leg), title, panels }
    };
    Ok((0..4).map(drawing).collect())
}

fn payload(run: &Run) -> String {
    if run.payload == 0 { "no payload".to_string() } else { format!("payload {} kg", run.payload) }
}

fn attitude_name([phi, theta, psi]: &[f64; 3]) -> String {
    format!("φ {phi}°, θ {theta}°, ψ {psi}°")
}

fn forces(run: &Run) -> Vec<(String, Lines)> {
    vec![
        ("F [N]".to_string(), legs(&run.forces)),
        ("of it by the legs' own mass [N]".to_string(), legs(&by_own_mass(run))),
    ]
}

/// What the forces are more than those of legs without mass.
fn by_own_mass(run: &Run) -> Vec<LegVector> {
    let pairs = run.forces.iter().zip(&run.forces_without_actuators);
    pairs.map(|(with, without)| std::array::from_fn(|leg| with[leg] - without[leg])).collect()
}

/// One line a leg.
fn legs(rows: &[LegVector]) -> Lines {
    (0..6).map(|leg| (format!("leg {}", leg + 1), rows.iter().map(|row| row[leg]).collect())).collect()
}

impl Drawing {
    /// One panel for each set of lines.
    #[must_use]
    pub fn figure(&self, samples: &Samples) -> Figure {
        let panel = |(label, lines): &(String, Lines)| {
            let line = |(name, values): &(String, Vec<f64>)| {
                Line::new(name.clone(), samples.0.iter().copied().zip(values.iter().copied()).collect())
            };
            Panel::over_time(label, 0.0..DURATION, lines.iter().map(line).collect())
        };
        let height = [480, 680, 860][self.panels.len().min(3) - 1];
        Figure { title: self.title.clone(), size: (900, height), panels: self.panels.iter().map(panel).collect() }
    }
}

/// A table with all lines.
fn write_values(folder: &Path, samples: &Samples, Drawing { name, panels, .. }: &Drawing) -> Result<(), Failure> {
    let columns = || panels.iter().flat_map(|(label, lines)| lines.iter().map(move |line| (label, line)));
    let names = columns().map(|(label, (name, _))| format!("{name}: {label}"));
    let values = |i: usize| columns().map(move |(_, (_, values))| values[i]);
    let rows = samples.0.iter().enumerate().map(|(i, &t)| std::iter::once(t).chain(values(i)).collect::<Vec<f64>>());
    write_records(folder, name, std::iter::once("t [s]".to_string()).chain(names), rows)
}

/// At home, and in the first pose of both tables.
fn poses(folder: &Path, platform: &Platform) -> Result<(), Failure> {
    let poses =
        [("home", HOME), ("table 3, 0 s", Motion::TABLE_3.at(0.0)[0]), ("table 4, 1 s", Motion::TABLE_4.at(1.0)[0])];
    let panels = poses.into_iter().map(|(name, q)| drawing(platform, name, &q)).collect::<Result<_, _>>()?;
    let title = "The platform at home, on the motion of table 3 and on that of table 4".to_string();
    write_figure(folder, "platform_poses", &Figure { title, size: (900, 1700), panels }, &POSES)
}

fn drawing(platform: &Platform, name: &str, q: &Coordinates) -> Result<Panel, Failure> {
    let legs = platform.legs(q)?;
    let base = platform.geometry().base;
    let joint = |i: usize| [0, 1, 2].map(|axis| base[i][axis] + legs.length[i] * legs.direction[i][axis]);
    let closed = |point: &dyn Fn(usize) -> [f64; 3]| (0..=6).map(|i| point(i % 6)).collect::<Vec<_>>();
    let line = |name: String, points| SpaceLine { name, points, marks: Vec::new() };
    let mut lines =
        vec![line(format!("base, {name}"), closed(&|i| base[i])), line("platform".to_string(), closed(&joint))];
    for i in 0..6 {
        lines.push(line(format!("leg {}: {:.2} m", i + 1, legs.length[i]), vec![base[i], joint(i)]));
    }
    Ok(Panel::Space(Space { labels: ["x [m]", "y [m]", "z [m]"].map(String::from), lines }))
}
