//! The font that texts are measured with, and drawn with in a PNG.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

use crate::CannotDraw;

/// DejaVu Sans, reduced.
pub(crate) struct Typeface(FontRef<'static>);

impl Typeface {
    pub(crate) fn new() -> Result<Self, CannotDraw> {
        let bytes = include_bytes!("../fonts/DejaVuSans-subset.ttf");
        FontRef::try_from_slice(bytes).map(Self).map_err(|_| CannotDraw::new("the font is unreadable"))
    }

    /// The scale at which an em is this many pixels.
    fn scale(&self, em: f64) -> PxScale {
        let height = self.0.height_unscaled() / self.0.units_per_em().unwrap_or(2048.0);
        PxScale::from(em as f32 * height)
    }

    /// Width of a text in pixels, at this size of an em.
    pub(crate) fn width(&self, text: &str, em: f64) -> f64 {
        let font = self.0.as_scaled(self.scale(em));
        text.chars().map(|c| f64::from(font.h_advance(font.glyph_id(c)))).sum()
    }

    /// Calls `pixel` with the places right of and below the start of the baseline, and how much of them is covered.
    pub(crate) fn draw(&self, text: &str, em: f64, start: [f64; 2], mut pixel: impl FnMut(i32, i32, f64)) {
        let font = self.0.as_scaled(self.scale(em));
        let mut x = start[0];
        for c in text.chars() {
            let mut glyph = font.scaled_glyph(c);
            glyph.position = point(x as f32, start[1] as f32);
            x += f64::from(font.h_advance(glyph.id));
            if let Some(outline) = self.0.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|i, j, covered| {
                    pixel(corner.x as i32 + i as i32, corner.y as i32 + j as i32, f64::from(covered));
                });
            }
        }
    }
}
