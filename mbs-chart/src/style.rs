//! Colours and strokes.

/// Red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

/// The color of axes and texts.
pub const BLACK: Color = Color(0, 0, 0);
/// The color of what is behind.
pub const GRAY: Color = Color(130, 130, 130);
/// The color of areas.
pub const LIGHT: Color = Color(232, 236, 241);
/// The first of the colours that everybody can tell apart: Okabe and Ito, *Color universal design*, 2008.
pub const BLUE: Color = Color(0, 114, 178);
/// The second of these colours.
pub const ORANGE: Color = Color(213, 94, 0);
/// The third of these colours.
pub const GREEN: Color = Color(0, 158, 115);
/// The fourth of these colours.
pub const PINK: Color = Color(204, 121, 167);

/// Of lines that help to read others.
pub(crate) const GRID: Color = Color(224, 224, 224);
/// Of the grid's lines at zero.
pub(crate) const ZERO: Color = Color(165, 165, 165);
pub(crate) const WHITE: Color = Color(255, 255, 255);

/// Yellow is left out.
const COLORS: [Color; 7] = [BLUE, ORANGE, GREEN, PINK, Color(230, 159, 0), Color(86, 180, 233), BLACK];

/// Lengths of strokes and of gaps \[px\]; nothing for a line without gaps.
pub type Dash = &'static [f64];

/// A line without gaps.
pub const SOLID: Dash = &[];
/// Of hidden edges and of what is only thought of.
pub const DASHED: Dash = &[7.0, 4.0];
/// The dashes of auxiliary lines.
pub const DOTTED: Dash = &[2.0, 3.0];
/// The dashes of axes.
pub const DASH_DOT: Dash = &[10.0, 3.0, 2.0, 3.0];

/// So that lines differ without colours, too.
const DASHES: [Dash; 7] = [SOLID, DASHED, DOTTED, DASH_DOT, &[14.0, 4.0], &[7.0, 3.0, 2.0, 3.0, 2.0, 3.0], &[4.0, 2.0]];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// In pixels.
    pub width: f64,
    /// Its gaps.
    pub dash: Dash,
}

impl Stroke {
    /// Without gaps.
    #[must_use]
    pub const fn new(color: Color, width: f64) -> Self {
        Stroke { color, width, dash: SOLID }
    }

    /// With gaps.
    #[must_use]
    pub const fn dashed(self, dash: Dash) -> Self {
        Stroke { dash, ..self }
    }
}

/// Of few lines each has a colour and gaps of its own; of many, hues around the circle.
pub(crate) fn stroke(i: usize, count: usize) -> Stroke {
    let color = if count <= COLORS.len() { COLORS[i] } else { hue(i as f64 / count as f64) };
    Stroke { color, width: 1.8, dash: DASHES[i % DASHES.len()] }
}

/// Around the circle of colours, all of one lightness.
fn hue(turn: f64) -> Color {
    let channel = |shift: f64| {
        let distance = ((turn + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        (255.0 * (0.1 + 0.63 * distance.clamp(0.0, 1.0))) as u8
    };
    Color(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}
