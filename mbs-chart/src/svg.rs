//! A scene as scalable vector graphics, in pixels with two decimals.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::scene::{Anchor, BASELINE, INDEX_DROP, Scene, Shape, Text};
use crate::style::{BLUE, Color, GREEN, WHITE};

/// Of texts: the font that they are measured with, then what is there.
const FONTS: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";

pub(crate) fn write(scene: &Scene<'_>, (width, height): (u32, u32)) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" fill=\"none\" stroke-linejoin=\"round\" \
         xml:space=\"preserve\">\n\
         {}<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        dark(scene),
        hex(WHITE)
    );
    for shape in &scene.shapes {
        svg += &element(shape);
        svg.push('\n');
    }
    svg + "</svg>\n"
}

/// What is white, grey or black changes places on dark paper, where the reader's system has that; colours stay, but
/// for two that are too dark there.
fn dark(scene: &Scene<'_>) -> String {
    let color = |shape: &Shape| match shape {
        Shape::Line { stroke, .. } => stroke.color,
        Shape::Area { fill, .. } | Shape::Dot { fill, .. } => *fill,
        Shape::Text(text) => text.color,
    };
    let used: BTreeSet<[u8; 3]> =
        scene.shapes.iter().map(color).chain([WHITE]).map(|Color(r, g, b)| [r, g, b]).collect();
    let rules: Vec<String> = used
        .into_iter()
        .filter_map(|[r, g, b]| {
            let (from, to) = (Color(r, g, b), inverted([r, g, b])?);
            let (from, to) = (hex(from), hex(to));
            Some(format!("[fill=\"{from}\"]{{fill:{to}}}[stroke=\"{from}\"]{{stroke:{to}}}"))
        })
        .collect();
    format!("<style>@media (prefers-color-scheme: dark) {{{}}}</style>\n", rules.concat())
}

/// From white, which becomes the paper of dark pages, to black, which becomes their ink; nothing for most colours.
fn inverted(color: [u8; 3]) -> Option<Color> {
    match Color(color[0], color[1], color[2]) {
        BLUE => return Some(Color(0x3d, 0x9b, 0xd8)),
        GREEN => return Some(Color(0x2f, 0xc4, 0x98)),
        _ => {}
    }
    let (least, most) = (*color.iter().min()?, *color.iter().max()?);
    if most - least > 24 {
        return None;
    }
    let [r, g, b] = [(0x15, 0xe4), (0x18, 0xe8), (0x1c, 0xec)].map(|(paper, ink)| {
        let share = f64::from(u16::from(least) + u16::from(most)) / 510.0;
        (f64::from(ink) + share * (f64::from(paper) - f64::from(ink))).round() as u8
    });
    Some(Color(r, g, b))
}

fn element(shape: &Shape) -> String {
    match shape {
        Shape::Line { points, stroke } => {
            let dash: Vec<String> = stroke.dash.iter().map(|length| number(*length)).collect();
            let dash =
                if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", dash.join(" ")) };
            let (color, width) = (hex(stroke.color), number(stroke.width));
            format!("<path d=\"{}\" stroke=\"{color}\" stroke-width=\"{width}\"{dash}/>", path(points))
        }
        Shape::Area { points, fill } => format!("<path d=\"{}Z\" fill=\"{}\"/>", path(points), hex(*fill)),
        Shape::Dot { centre: [x, y], radius, fill } => {
            let [x, y, radius] = [x, y, radius].map(|value| number(*value));
            format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", hex(*fill))
        }
        Shape::Text(text) => text_element(text),
    }
}

fn path(points: &[[f64; 2]]) -> String {
    let mut path = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", number(*x), number(*y));
    }
    path
}

fn text_element(text: &Text) -> String {
    let [x, y] = [text.at[0], text.at[1] + BASELINE * text.size].map(number);
    let anchor = match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let (size, color) = (number(text.size), hex(text.color));
    let mut element = format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{color}\"{anchor}>");
    let drop = INDEX_DROP * text.size;
    let mut low = 0.0;
    for run in &text.runs {
        let wanted = if run.is_index { drop } else { 0.0 };
        let words = escaped(&run.text);
        element += &match (run.is_index, wanted - low) {
            (false, 0.0) => words,
            (false, shift) => format!("<tspan dy=\"{}\">{words}</tspan>", number(shift)),
            (true, shift) => {
                format!("<tspan dy=\"{}\" font-size=\"{}\">{words}</tspan>", number(shift), number(text.em(run)))
            }
        };
        low = wanted;
    }
    element + "</text>"
}

/// With two decimals at most.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

fn hex(Color(red, green, blue): Color) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_are_inverted_and_colours_kept() {
        assert_eq!(inverted([255; 3]), Some(Color(0x15, 0x18, 0x1c)));
        assert_eq!(inverted([0; 3]), Some(Color(0xe4, 0xe8, 0xec)));
        assert_eq!(inverted([213, 94, 0]), None);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, -0.001, 12.5, 2.71328].map(number), ["0", "0", "12.5", "2.71"]);
    }
}
