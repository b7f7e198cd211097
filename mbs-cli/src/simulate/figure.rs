//! The motion as a figure: coordinates, velocities and energies over time, one panel each.
//!
//! Figures need nothing from the machine: the font that texts are measured with, and drawn with in a PNG, is part of
//! the program.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::motion::{Motion, Row};
use crate::failure::Failure;

/// Vector or raster graphics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Portable network graphics.
    Png,
}

/// Width and height in pixels.
const SIZE: (u32, u32) = (1100, 1000);
/// A PNG is drawn so many times larger, and averaged: lines come out smooth.
const OVERSAMPLING: u32 = 3;
/// A line has at most so many points; beyond that a bucket of rows is drawn by its extremes.
const POINTS: usize = 4000;
/// Okabe and Ito, *Color universal design*, 2008: told apart by everybody; yellow is left out.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// The bytes of the figure.
pub(crate) fn draw(motion: &Motion, format: Format) -> Result<Vec<u8>, Failure> {
    let font = include_bytes!("../../fonts/DejaVuSans-subset.ttf");
    if register_font("sans-serif", FontStyle::Normal, font).is_err() {
        return Err(cannot_draw("the font is unreadable"));
    }
    match format {
        Format::Svg => svg(motion),
        Format::Png => png(motion),
    }
}

fn svg(motion: &Motion) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        draw_panels(&Canvas { area, scale: 1 }, motion).map_err(cannot_draw)?;
    }
    Ok(text.into_bytes())
}

fn png(motion: &Motion) -> Result<Vec<u8>, Failure> {
    let (width, height) = (SIZE.0 * OVERSAMPLING, SIZE.1 * OVERSAMPLING);
    let mut pixels = vec![0; 3 * (width * height) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw_panels(&Canvas { area, scale: OVERSAMPLING }, motion).map_err(cannot_draw)?;
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIZE.0, SIZE.1);
    encoder.set_color(png::ColorType::Rgb);
    let encoded = encoder.write_header().and_then(|mut writer| writer.write_image_data(&averaged(&pixels)));
    encoded.map_err(cannot_draw)?;
    Ok(bytes)
}

/// Means over squares of `OVERSAMPLING` pixels; rows of red, green and blue.
fn averaged(pixels: &[u8]) -> Vec<u8> {
    let n = OVERSAMPLING as usize;
    let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
    let mean = |x: usize, y: usize, channel: usize| {
        let at = |i: usize| 3 * ((n * y + i / n) * n * width + n * x + i % n) + channel;
        let sum: usize = (0..n * n).map(|i| usize::from(pixels[at(i)])).sum();
        (sum / (n * n)) as u8
    };
    (0..3 * width * height).map(|i| mean(i / 3 % width, i / 3 / width, i % 3)).collect()
}

fn cannot_draw(reason: impl std::fmt::Display) -> Failure {
    Failure::new(format_args!("cannot draw the figure: {reason}"))
}

/// Some lines over time, on one vertical axis.
struct Panel {
    /// What the vertical axis says.
    label: String,
    lines: Vec<Line>,
}

struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

/// Part of a figure; its pixels are `scale` times smaller than those that lengths here are given in.
struct Canvas<D: DrawingBackend> {
    area: DrawingArea<D, Shift>,
    scale: u32,
}

impl<D: DrawingBackend> Canvas<D> {
    fn length(&self, pixels: u32) -> u32 {
        self.scale * pixels
    }

    fn place(&self, x: i32, y: i32) -> (i32, i32) {
        (x * self.scale as i32, y * self.scale as i32)
    }

    fn font(&self, size: u32) -> FontDesc<'static> {
        ("sans-serif", self.length(size)).into_font()
    }

    fn with(&self, area: DrawingArea<D, Shift>) -> Self {
        Canvas { area, scale: self.scale }
    }
}

type Drawn<D> = Result<(), DrawingAreaErrorKind<<D as DrawingBackend>::ErrorType>>;

fn draw_panels<D: DrawingBackend>(canvas: &Canvas<D>, motion: &Motion) -> Drawn<D> {
    canvas.area.fill(&WHITE)?;
    let (title, rest) = canvas.area.split_vertically(canvas.length(44));
    title.draw(&Text::new(motion.name.clone(), canvas.place(86, 14), canvas.font(22)))?;
    let rates: Vec<String> = motion.units.iter().map(|unit| rate_unit(unit)).collect();
    let names: Vec<String> = motion.coordinates.iter().map(|name| format!("d{name}/dt")).collect();
    let panels = [
        of_components(motion, "coordinates", &motion.coordinates, &motion.units, |row, i| row.q[i]),
        of_components(motion, "velocities", &names, &rates, |row, i| row.qd[i]),
        Panel {
            label: "energy [J]".to_string(),
            lines: vec![
                line(motion, "kinetic T", |row| row.kinetic),
                line(motion, "potential V", |row| row.potential),
                line(motion, "T + V", |row| row.kinetic + row.potential),
            ],
        },
    ];
    let times = time_range(motion);
    for (panel, area) in panels.iter().zip(rest.split_evenly((panels.len(), 1))) {
        draw_panel(panel, &canvas.with(area), times.clone())?;
    }
    canvas.area.present()
}

/// `rad/s`, `1/s`, `(m/s)/s`
fn rate_unit(unit: &str) -> String {
    if unit.contains('/') { format!("({unit})/s") } else { format!("{unit}/s") }
}

/// The unit is at the axis where all have the same, else in the legend.
fn of_components(
    motion: &Motion,
    what: &str,
    names: &[String],
    units: &[String],
    value: impl Fn(&Row, usize) -> f64,
) -> Panel {
    let common = units.iter().all(|unit| *unit == units[0]);
    let label = match units.first() {
        Some(unit) if common => format!("{what} [{unit}]"),
        _ => what.to_string(),
    };
    let name = |i: usize| if common { names[i].clone() } else { format!("{} [{}]", names[i], units[i]) };
    let lines = (0..names.len()).map(|i| line(motion, &name(i), |row| value(row, i))).collect();
    Panel { label, lines }
}

/// All rows, or the extremes of buckets of rows.
fn line(motion: &Motion, name: &str, value: impl Fn(&Row) -> f64) -> Line {
    let all: Vec<(f64, f64)> = motion.rows.iter().map(|row| (row.t, value(row))).collect();
    let points =
        if all.len() <= POINTS { all } else { all.chunks(all.len().div_ceil(POINTS / 2)).flat_map(extremes).collect() };
    Line { name: name.to_string(), points }
}

/// The lowest and the highest point, in order of time.
fn extremes(bucket: &[(f64, f64)]) -> [(f64, f64); 2] {
    let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let lowest = bucket.iter().min_by(by_value).copied().unwrap_or_default();
    let highest = bucket.iter().max_by(by_value).copied().unwrap_or_default();
    if lowest.0 <= highest.0 { [lowest, highest] } else { [highest, lowest] }
}

fn time_range(motion: &Motion) -> Range<f64> {
    let first = motion.rows.first().map_or(0.0, |row| row.t);
    let last = motion.rows.last().map_or(0.0, |row| row.t);
    if first < last { first..last } else { first - 0.5..first + 0.5 }
}

/// From the lowest to the highest value with a margin; what varies by rounding alone stays a flat line.
fn value_range(panel: &Panel) -> Range<f64> {
    let values = || panel.lines.iter().flat_map(|line| &line.points).map(|point| point.1).filter(|y| y.is_finite());
    let (lowest, highest) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    if lowest > highest {
        return -1.0..1.0;
    }
    let magnitude = lowest.abs().max(highest.abs());
    let least = if magnitude > 0.0 { 1e-3 * magnitude } else { 1.0 };
    let (middle, half) = (0.5 * (lowest + highest), 0.53 * (highest - lowest).max(least));
    middle - half..middle + half
}

fn draw_panel<D: DrawingBackend>(panel: &Panel, canvas: &Canvas<D>, times: Range<f64>) -> Drawn<D> {
    let (width, _) = canvas.area.dim_in_pixel();
    let (chart_area, legend_area) = canvas.area.split_horizontally(width.saturating_sub(canvas.length(170)));
    let values = value_range(panel);
    let mut chart = ChartBuilder::on(&chart_area)
        .margin(canvas.length(10))
        .x_label_area_size(canvas.length(44))
        .y_label_area_size(canvas.length(76))
        .build_cartesian_2d(times.clone(), values.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(220, 220, 220).stroke_width(canvas.length(1)))
        .axis_style(BLACK.stroke_width(canvas.length(1)))
        .set_all_tick_mark_size(canvas.length(5))
        .x_labels(11)
        .y_labels(7)
        .x_label_formatter(&|t| tick(*t, &times))
        .y_label_formatter(&|y| tick(*y, &values))
        .label_style(canvas.font(14))
        .axis_desc_style(canvas.font(16))
        .x_desc("t [s]")
        .y_desc(&panel.label)
        .draw()?;
    for (i, line) in panel.lines.iter().enumerate() {
        let finite = line.points.iter().copied().filter(|point| point.1.is_finite());
        chart.draw_series(LineSeries::new(finite, stroke(panel, i, canvas)))?;
    }
    draw_legend(panel, &canvas.with(legend_area))
}

fn draw_legend<D: DrawingBackend>(panel: &Panel, canvas: &Canvas<D>) -> Drawn<D> {
    let (_, height) = canvas.area.dim_in_pixel();
    let room = (height / canvas.length(20)).saturating_sub(3).max(1) as usize;
    let shown = if panel.lines.len() <= room { panel.lines.len() } else { room - 1 };
    let entry = |i: usize, text: String| Text::new(text, canvas.place(32, 13 + 20 * i as i32), canvas.font(14));
    for (i, line) in panel.lines.iter().take(shown).enumerate() {
        let y = 20 + 20 * i as i32;
        canvas.area.draw(&PathElement::new(vec![canvas.place(4, y), canvas.place(26, y)], stroke(panel, i, canvas)))?;
        canvas.area.draw(&entry(i, line.name.clone()))?;
    }
    if shown < panel.lines.len() {
        canvas.area.draw(&entry(shown, format!("… and {} more", panel.lines.len() - shown)))?;
    }
    Ok(())
}

fn stroke<D: DrawingBackend>(panel: &Panel, i: usize, canvas: &Canvas<D>) -> ShapeStyle {
    color(i, panel.lines.len()).stroke_width(canvas.length(2))
}

/// Of few lines each has a colour that everybody can tell; of many, hues around the circle.
fn color(i: usize, count: usize) -> RGBColor {
    if count <= COLORS.len() {
        return COLORS[i];
    }
    let (red, green, blue) = HSLColor(i as f64 / count as f64, 0.75, 0.42).rgb();
    RGBColor(red, green, blue)
}

/// A number at an axis, with the digits that tell it from its neighbours.
fn tick(value: f64, range: &Range<f64>) -> String {
    let span = range.end - range.start;
    let magnitude = range.start.abs().max(range.end.abs());
    let value = if value.abs() < 1e-9 * span { 0.0 } else { value };
    if !(1e-3..1e6).contains(&magnitude) {
        let digits = (magnitude / span).log10().max(0.0) as usize + 2;
        return format!("{value:.digits$e}");
    }
    let decimals = (2.0 - span.log10()).ceil().clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        assert_eq!(tick(0.30000000000000004, &(0.0..1.0)), "0.3");
        assert_eq!(tick(-1e-17, &(-1.0..1.0)), "0");
        assert_eq!(tick(2000.0, &(0.0..8000.0)), "2000");
        assert_eq!(tick(1000.0002, &(1000.0..1000.001)), "1000.0002");
        assert_eq!(tick(2.5e-7, &(0.0..1e-6)), "2.50e-7");
        assert_eq!(tick(3e8, &(0.0..1e9)), "3.00e8");
    }

    #[test]
    fn peaks_survive_where_rows_are_many() {
        let quiet = |i: usize| (i as f64, if i == 70_000 { 5.0 } else { 0.0 });
        let points: Vec<_> = (0..100_000).map(quiet).collect();
        let drawn: Vec<_> = points.chunks(50).flat_map(extremes).collect();
        assert_eq!((drawn.len(), drawn.contains(&(70_000.0, 5.0))), (4000, true));
        assert!(drawn.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn units_of_rates() {
        assert_eq!(["rad", "1", "m/s"].map(rate_unit), ["rad/s", "1/s", "(m/s)/s"]);
    }
}
