//! A scene as scalable vector graphics, in pixels with two decimals.

use std::fmt::Write;

use crate::scene::{Anchor, BASELINE, INDEX_DROP, Scene, Shape, Text};
use crate::style::{Color, WHITE};

/// Of texts: the font that they are measured with, then what is there.
const FONTS: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";

pub(crate) fn write(scene: &Scene<'_>, (width, height): (u32, u32)) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" fill=\"none\" stroke-linejoin=\"round\" \
         xml:space=\"preserve\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        hex(WHITE)
    );
    for shape in &scene.shapes {
        svg += &element(shape);
        svg.push('\n');
    }
    svg + "</svg>\n"
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
    fn numbers_are_short() {
        assert_eq!([0.0, -0.001, 12.5, 2.71328].map(number), ["0", "0", "12.5", "2.71"]);
    }
}
