//! Figures: panels of curves with axes, units and legends, and drawings, one below the other, as SVG or PNG.
//!
//! Figures need nothing from the machine: the font that texts are measured with, and drawn with in a PNG, is part of
//! the program. The same figure is the same bytes everywhere.
//!
//! Lines differ by colour and by their gaps. One legend stands above the first of panels whose lines have the same
//! names; panels one below the other with one horizontal axis say once what it is.
//!
//! - [`curves`]: lines over one horizontal axis;
//! - [`plane`]: paths in a plane, both axes to one scale;
//! - [`cells`]: values over a grid, by colour;
//! - [`space`]: lines in three dimensions, seen from the side;
//! - [`sketch`]: drawings without axes;
//! - [`camera`]: from space to a plane, for drawings;
//! - [`style`]: colours and strokes of drawings.

pub mod camera;
pub mod cells;
pub mod curves;
pub mod plane;
pub mod sketch;
pub mod space;
pub mod style;

mod axis;
mod font;
mod legend;
mod raster;
mod scene;
mod svg;

use std::fmt;
use std::ops::Range;

pub use camera::Camera;
pub use cells::{Cell, Cells};
pub use curves::{Curves, Line};
pub use plane::{Plane, PlaneLine};
pub use sketch::Sketch;
pub use space::{Space, SpaceLine};

use font::Typeface;
use scene::{Anchor, Rect, Scene, Text};

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
    /// Stands on top; an empty one takes no room. Lines after the first are notes: small, wrapped to the width.
    pub title: String,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// From top to bottom; their charts are of equal height.
    pub panels: Vec<Panel>,
}

/// A part of a figure with axes of its own.
#[derive(Clone, Debug)]
pub enum Panel {
    /// Lines over one horizontal axis.
    Curves(Curves),
    /// Paths in a plane.
    Plane(Plane),
    /// Values over a grid.
    Cells(Cells),
    /// Lines in space.
    Space(Space),
    /// A drawing without axes.
    Sketch(Sketch),
    /// Panels side by side, of equal width.
    Row(Vec<Panel>),
}

impl Panel {
    /// Lines over one horizontal axis: what it and the vertical axis say, and from where to where it goes.
    #[must_use]
    pub fn curves(labels: [&str; 2], x_range: Range<f64>, lines: Vec<Line>) -> Self {
        let [x_label, y_label] = labels.map(String::from);
        Self::Curves(Curves { x_label, y_label, x_range, lines })
    }

    /// Lines over as much of the horizontal axis as they take, and this part of it more on both sides.
    #[must_use]
    pub fn fitted(labels: [&str; 2], margin: f64, lines: Vec<Line>) -> Self {
        Self::curves(labels, curves::range_of(&lines, margin), lines)
    }

    /// Paths in a plane: what its axes say, to the right and up, and points with a word beside them.
    #[must_use]
    pub fn plane(labels: [&str; 2], lines: Vec<PlaneLine>, marks: Vec<([f64; 2], String)>) -> Self {
        Self::Plane(Plane { labels: labels.map(String::from), lines, marks })
    }

    /// Lines over a time in seconds.
    #[must_use]
    pub fn over_time(label: &str, range: Range<f64>, lines: Vec<Line>) -> Self {
        Self::curves(["t [s]", label], range, lines)
    }
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

/// The bytes of the figure.
///
/// # Errors
/// [`CannotDraw`] if a panel is too small for its axes.
pub fn draw(figure: &Figure, format: Format) -> Result<Vec<u8>, CannotDraw> {
    let face = Typeface::new()?;
    let mut scene = Scene { face: &face, shapes: Vec::new() };
    let (width, height) = figure.size;
    let mut area = Rect { x: 0.0, y: 0.0, width: f64::from(width), height: f64::from(height) };
    if !figure.title.is_empty() {
        let height = heading(&figure.title, area.width, &mut scene);
        area = area.inset([0.0, height, 0.0, 0.0]);
    }
    stack(&figure.panels, &mut scene, area.inset([12.0, 4.0, 18.0, 8.0]), [0.0; 2])?;
    match format {
        Format::Svg => Ok(svg::write(&scene, figure.size).into_bytes()),
        Format::Png => png(&scene, figure.size),
    }
}

/// Writes the title and, below it, what follows its first line, small; the height that both take \[px\].
fn heading(title: &str, width: f64, scene: &mut Scene<'_>) -> f64 {
    let (title, notes) = title.split_once('\n').unwrap_or((title, ""));
    scene.text(Text::new([SIDE, 24.0], title, 18.0, Anchor::Start));
    let mut height = 38.0;
    for line in notes.lines().flat_map(|note| wrapped(note, width - 2.0 * SIDE, scene.face)) {
        scene.text(Text::new([SIDE, height + 4.0], &line, NOTE, Anchor::Start).colored(style::GRAY));
        height += 1.4 * NOTE;
    }
    height
}

/// How much higher a figure of this width has to be for a note below its title \[px\].
///
/// # Errors
/// [`CannotDraw`] if the font cannot be read.
pub fn note_height(note: &str, width: u32) -> Result<u32, CannotDraw> {
    let lines = wrapped(note, f64::from(width) - 2.0 * SIDE, &Typeface::new()?).len();
    Ok((lines as f64 * 1.4 * NOTE).ceil() as u32)
}

/// Left and right of a title \[px\].
const SIDE: f64 = 24.0;
/// An em of what stands below a title \[px\].
const NOTE: f64 = 12.0;

/// Lines no wider than this \[px\], broken between words.
fn wrapped(text: &str, width: f64, face: &Typeface) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if face.width(&format!("{line} {word}"), NOTE) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

fn png(scene: &Scene<'_>, size: (u32, u32)) -> Result<Vec<u8>, CannotDraw> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = raster::pixels(scene, size);
    let encoded = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    encoded.map_err(CannotDraw::new)?;
    Ok(bytes)
}

/// A chart is at least this high and this wide \[px\].
const LEAST: f64 = 20.0;
/// Between panels side by side \[px\].
const GAP: f64 = 16.0;

/// Panels from top to bottom, each with room above and below its chart, at least `least` \[px\].
fn stack<'a>(panels: &'a [Panel], scene: &mut Scene<'a>, area: Rect, least: [f64; 2]) -> Result<(), CannotDraw> {
    let face = scene.face;
    let prepared = prepared(panels);
    let rough = area.height / panels.len().max(1) as f64;
    // Charts of curves begin at the same place.
    let left = prepared.iter().flatten().map(|curves| curves.left(rough, face)).fold(50.0, f64::max);
    let sides = |panel: &Panel| match panel {
        Panel::Curves(_) => left,
        Panel::Plane(_) => plane::LEFT,
        Panel::Cells(_) => cells::LEFT,
        Panel::Space(_) | Panel::Sketch(_) | Panel::Row(_) => 0.0,
    };
    let margins: Vec<[f64; 2]> = panels
        .iter()
        .zip(&prepared)
        .map(|(panel, curves)| margins(panel, curves.as_ref(), face, area.width - sides(panel)))
        .map(|[above, below]| [above.max(least[0]), below.max(least[1])])
        .collect();
    let around: f64 = margins.iter().flatten().sum();
    let height = (area.height - around) / panels.len().max(1) as f64;
    if height < LEAST || area.width - left < LEAST {
        return Err(CannotDraw::new("it is too small for its panels"));
    }
    let mut top = area.y;
    for ((panel, curves), [above, below]) in panels.iter().zip(&prepared).zip(margins) {
        let side = sides(panel);
        let chart = Rect { x: area.x + side, y: top + above, width: area.width - side, height };
        match (panel, curves) {
            (Panel::Curves(_), Some(curves)) => curves.draw(scene, chart),
            (Panel::Curves(_), None) => {}
            (Panel::Plane(plane), _) => plane.draw(scene, chart),
            (Panel::Cells(cells), _) => cells.draw(scene, chart),
            (Panel::Space(space), _) => space.draw(scene, chart),
            (Panel::Sketch(sketch), _) => sketch.draw(scene, chart),
            (Panel::Row(row), _) => {
                let width = width_in_row(row.len(), chart.width);
                let least = margins_of_row(row, face, chart.width);
                for (i, panel) in row.iter().enumerate() {
                    let x = chart.x + i as f64 * (width + GAP);
                    stack(std::slice::from_ref(panel), scene, Rect { x, width, ..chart }, least)?;
                }
            }
        }
        top += above + height + below;
    }
    Ok(())
}

/// What a panel needs above and below its chart, which is this wide \[px\]; a row has it within itself.
fn margins<'a>(panel: &Panel, curves: Option<&curves::Prepared<'a>>, face: &'a Typeface, width: f64) -> [f64; 2] {
    match (panel, curves) {
        (Panel::Curves(_), Some(curves)) => curves.margins(face, width),
        (Panel::Plane(plane), _) => plane.margins(face, width),
        (Panel::Cells(cells), _) => cells.margins(face, width),
        (Panel::Space(space), _) => space.margins(face, width),
        (Panel::Curves(_) | Panel::Sketch(_) | Panel::Row(_), _) => [0.0, 0.0],
    }
}

fn width_in_row(count: usize, width: f64) -> f64 {
    (width + GAP) / count.max(1) as f64 - GAP
}

/// The most that a panel of a row needs: charts side by side are of one height.
fn margins_of_row(row: &[Panel], face: &Typeface, width: f64) -> [f64; 2] {
    let width = width_in_row(row.len(), width) - plane::LEFT;
    row.iter().fold([0.0, 0.0], |[above, below], panel| {
        let own = prepared(std::slice::from_ref(panel));
        let [a, b] = margins(panel, own[0].as_ref(), face, width);
        [f64::max(above, a), f64::max(below, b)]
    })
}

/// Those that are curves, with what their neighbours say for them.
fn prepared(panels: &[Panel]) -> Vec<Option<curves::Prepared<'_>>> {
    let curves = |i: usize| match panels.get(i) {
        Some(Panel::Curves(curves)) => Some(curves),
        _ => None,
    };
    let prepare = |i: usize| {
        let own = curves(i)?;
        let mut prepared = curves::Prepared::new(own);
        prepared.is_named_above =
            i.checked_sub(1).and_then(curves).is_some_and(|above| curves::have_same_names(above, own));
        prepared.is_continued = curves(i + 1).is_some_and(|below| curves::have_same_axis(below, own));
        Some(prepared)
    };
    (0..panels.len()).map(prepare).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let line = || Line::new("one & only", vec![(0.0, -1.0), (1.0, 1.0)]);
        let panel = |label: &str| Panel::over_time(label, 0.0..1.0, vec![line()]);
        Figure { title: "A title".to_string(), size: (600, 400), panels: vec![panel("a [m]"), panel("b [m]")] }
    }

    #[test]
    fn panels_say_once_what_they_share() {
        let svg = String::from_utf8(draw(&figure(), Format::Svg).unwrap()).unwrap();
        let count = |text: &str| svg.matches(text).count();
        assert_eq!((count("one &amp; only"), count("t [s]"), count("a [m]"), count("b [m]")), (1, 1, 1, 1));
        assert!(svg.contains("viewBox=\"0 0 600 400\"") && svg.contains("−1") && !svg.contains(">-"), "{svg}");
    }

    /// Every word of a long note is there, in lines that end before the figure does.
    #[test]
    fn notes_are_wrapped_below_the_title() {
        let words: Vec<String> = (0..60).map(|i| format!("word{i}")).collect();
        let noted = Figure { title: format!("A title\n{}", words.join(" ")), ..figure() };
        let svg = String::from_utf8(draw(&noted, Format::Svg).unwrap()).unwrap();
        let texts = svg.split("<text").filter_map(|part| part.split_once('>')?.1.split_once('<'));
        let lines: Vec<&str> = texts.map(|(text, _)| text).filter(|text| text.starts_with("word")).collect();
        assert_eq!(lines.join(" "), words.join(" "));
        let face = Typeface::new().unwrap();
        assert!(lines.len() > 3 && lines.iter().all(|line| face.width(line, NOTE) <= 552.0), "{lines:?}");
    }

    /// What is not a number, or infinite, is left out, be it a point or the end of a range; the rest is drawn.
    #[test]
    fn what_is_not_finite_is_left_out() {
        const INFINITY: f64 = f64::INFINITY;
        let bad = [f64::NAN, INFINITY, -INFINITY];
        let points = || (0..4).map(f64::from).chain(bad).zip((0..4).map(f64::from).chain(bad));
        let pairs: Vec<(f64, f64)> = points().flat_map(|(x, y)| [(x, y), (x, 1.0), (1.0, y)]).collect();
        let line = || vec![Line::new("", pairs.clone()).marked((f64::NAN, INFINITY), "nowhere")];
        let marks = vec![([INFINITY, 0.0], "nowhere".to_string())];
        let plane =
            Panel::plane(["x", "y"], vec![PlaneLine::new("", pairs.iter().map(|&(x, y)| [x, y]).collect())], marks);
        let space = SpaceLine {
            name: String::new(),
            points: pairs.iter().map(|&(x, y)| [x, y, x]).collect(),
            marks: vec![([0.0, 0.0, f64::NAN], "nowhere".to_string())],
        };
        let space = Panel::Space(Space { labels: ["x", "y", "z"].map(String::from), lines: vec![space] });
        let nothing = Panel::fitted(["x", "y"], 0.1, vec![Line::new("", vec![(INFINITY, f64::NAN)])]);
        for (panel, has_lines) in [
            (Panel::fitted(["x", "y"], 0.1, line()), true),
            (Panel::curves(["x", "y"], 0.0..INFINITY, line()), true),
            (Panel::curves(["x", "y"], f64::NAN..f64::NAN, line()), true),
            (plane, true),
            (space, true),
            (nothing, false),
        ] {
            let svg = draw(&Figure { panels: vec![panel], ..figure() }, Format::Svg).unwrap();
            let svg = String::from_utf8(svg).unwrap();
            assert!(!["NaN", "inf", "nowhere"].iter().any(|word| svg.contains(word)), "{svg}");
            assert_eq!(svg.contains(" stroke=\"#0072b2\""), has_lines, "{svg}");
        }
    }

    #[test]
    fn both_formats_are_drawn_and_what_is_too_small_is_not() {
        assert!(draw(&figure(), Format::Png).unwrap().starts_with(b"\x89PNG"));
        let small = Figure { size: (60, 60), ..figure() };
        assert!(draw(&small, Format::Svg).unwrap_err().to_string().contains("too small"));
    }
}
