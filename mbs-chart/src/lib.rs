//! Figures: panels of curves with axes, units and legends, one below the other, as SVG or PNG.
//!
//! Figures need nothing from the machine: the font that texts are measured with, and drawn with in a PNG, is part of
//! the program. The same figure is the same bytes everywhere.
//!
//! - [`curves`]: lines over one horizontal axis;
//! - [`plane`]: paths in a plane, both axes to one scale;
//! - [`space`]: lines in three dimensions, seen from the side.

pub mod curves;
pub mod plane;
pub mod space;

use std::fmt;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

pub use curves::{Curves, Line};
pub use plane::{Plane, PlaneLine};
pub use space::{Space, SpaceLine};

/// Vector or raster graphics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Portable network graphics.
    Png,
}

/// A title and panels below it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Stands on top.
    pub title: String,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// From top to bottom, of equal height.
    pub panels: Vec<Panel>,
}

/// A part of a figure with axes of its own.
#[derive(Clone, Debug)]
pub enum Panel {
    /// Lines over one horizontal axis.
    Curves(Curves),
    /// Paths in a plane.
    Plane(Plane),
    /// Lines in space.
    Space(Space),
}

/// Why a figure was not drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CannotDraw {
    reason: String,
}

impl CannotDraw {
    fn new(reason: impl fmt::Display) -> Self {
        Self { reason: reason.to_string() }
    }
}

impl fmt::Display for CannotDraw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot draw the figure: {}", self.reason)
    }
}

impl std::error::Error for CannotDraw {}

/// A PNG is drawn larger by this factor, and averaged: lines come out smooth.
const OVERSAMPLING: u32 = 3;
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
/// Of lines that help to read others.
const GRID: RGBColor = RGBColor(220, 220, 220);

/// The bytes of the figure.
///
/// # Errors
/// [`CannotDraw`] if a panel is too small for its axes.
pub fn draw(figure: &Figure, format: Format) -> Result<Vec<u8>, CannotDraw> {
    let font = include_bytes!("../fonts/DejaVuSans-subset.ttf");
    if register_font("sans-serif", FontStyle::Normal, font).is_err() {
        return Err(CannotDraw::new("the font is unreadable"));
    }
    match format {
        Format::Svg => svg(figure),
        Format::Png => png(figure),
    }
}

fn svg(figure: &Figure) -> Result<Vec<u8>, CannotDraw> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, figure.size).into_drawing_area();
        draw_panels(&Canvas { area, scale: 1 }, figure).map_err(CannotDraw::new)?;
    }
    Ok(text.into_bytes())
}

fn png(figure: &Figure) -> Result<Vec<u8>, CannotDraw> {
    let (width, height) = (figure.size.0 * OVERSAMPLING, figure.size.1 * OVERSAMPLING);
    let mut pixels = vec![0; 3 * (width * height) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw_panels(&Canvas { area, scale: OVERSAMPLING }, figure).map_err(CannotDraw::new)?;
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, figure.size.0, figure.size.1);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = averaged(&pixels, figure.size);
    let encoded = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    encoded.map_err(CannotDraw::new)?;
    Ok(bytes)
}

/// Means over squares of `OVERSAMPLING` pixels; rows of red, green and blue.
fn averaged(pixels: &[u8], size: (u32, u32)) -> Vec<u8> {
    let n = OVERSAMPLING as usize;
    let (width, height) = (size.0 as usize, size.1 as usize);
    let mean = |x: usize, y: usize, channel: usize| {
        let at = |i: usize| 3 * ((n * y + i / n) * n * width + n * x + i % n) + channel;
        let sum: usize = (0..n * n).map(|i| usize::from(pixels[at(i)])).sum();
        (sum / (n * n)) as u8
    };
    (0..3 * width * height).map(|i| mean(i / 3 % width, i / 3 / width, i % 3)).collect()
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

    fn stroke(&self, color: RGBColor, width: u32) -> ShapeStyle {
        color.stroke_width(self.length(width))
    }

    fn with(&self, area: DrawingArea<D, Shift>) -> Self {
        Canvas { area, scale: self.scale }
    }
}

type Drawn<D> = Result<(), DrawingAreaErrorKind<<D as DrawingBackend>::ErrorType>>;

fn draw_panels<D: DrawingBackend>(canvas: &Canvas<D>, figure: &Figure) -> Drawn<D> {
    canvas.area.fill(&WHITE)?;
    let (title, rest) = canvas.area.split_vertically(canvas.length(44));
    title.draw(&Text::new(figure.title.clone(), canvas.place(86, 14), canvas.font(22)))?;
    for (panel, area) in figure.panels.iter().zip(rest.split_evenly((figure.panels.len(), 1))) {
        match panel {
            Panel::Curves(curves) => curves::draw(curves, &canvas.with(area))?,
            Panel::Plane(plane) => plane::draw(plane, &canvas.with(area))?,
            Panel::Space(space) => space::draw(space, &canvas.with(area))?,
        }
    }
    canvas.area.present()
}

/// One axis of a chart in a plane.
struct Axis<'a> {
    /// What it says, with its unit.
    label: &'a str,
    range: Range<f64>,
    /// How many, about.
    ticks: usize,
}

type PlaneChart<'a, D> = ChartContext<'a, D, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The horizontal and the vertical axis, with a grid.
fn draw_axes<D: DrawingBackend>(chart: &mut PlaneChart<'_, D>, [x, y]: &[Axis<'_>; 2], canvas: &Canvas<D>) -> Drawn<D> {
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(canvas.stroke(GRID, 1))
        .axis_style(canvas.stroke(BLACK, 1))
        .set_all_tick_mark_size(canvas.length(5))
        .x_labels(x.ticks)
        .y_labels(y.ticks)
        .x_label_formatter(&|value| tick(*value, &x.range))
        .y_label_formatter(&|value| tick(*value, &y.range))
        .label_style(canvas.font(14))
        .axis_desc_style(canvas.font(16))
        .x_desc(x.label)
        .y_desc(y.label)
        .draw()
}

/// Names beside strokes of their colours, from the top; the last of more than fit is a count.
fn draw_legend<D: DrawingBackend>(names: &[&str], canvas: &Canvas<D>) -> Drawn<D> {
    let (_, height) = canvas.area.dim_in_pixel();
    let room = (height / canvas.length(20)).saturating_sub(3).max(1) as usize;
    let shown = if names.len() <= room { names.len() } else { room - 1 };
    let entry = |i: usize, text: String| Text::new(text, canvas.place(32, 13 + 20 * i as i32), canvas.font(14));
    for (i, name) in names.iter().take(shown).enumerate() {
        let y = 20 + 20 * i as i32;
        let stroke = canvas.stroke(color(i, names.len()), 2);
        canvas.area.draw(&PathElement::new(vec![canvas.place(4, y), canvas.place(26, y)], stroke))?;
        canvas.area.draw(&entry(i, (*name).to_string()))?;
    }
    if shown < names.len() {
        canvas.area.draw(&entry(shown, format!("… and {} more", names.len() - shown)))?;
    }
    Ok(())
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
}
