//! Names beside pieces of their lines, in rows.

use crate::font::Typeface;
use crate::scene::{Anchor, Scene, Text};
use crate::style::stroke;

/// Of an em, of a row and of a piece of line \[px\].
const SIZE: f64 = 13.0;
pub(crate) const ROW: f64 = 20.0;
const PIECE: f64 = 30.0;
/// Behind the piece, and behind the name \[px\].
const GAPS: [f64; 2] = [6.0, 18.0];
/// The last of more rows is a count.
const MOST_ROWS: usize = 3;

/// Which names stand in which row.
pub(crate) struct Legend<'a> {
    names: Vec<&'a str>,
    rows: Vec<Vec<usize>>,
    face: &'a Typeface,
}

impl<'a> Legend<'a> {
    /// In rows that are no wider \[px\]; names of lines without one are left out.
    pub(crate) fn new(names: Vec<&'a str>, face: &'a Typeface, width: f64) -> Self {
        let mut legend = Legend { names, rows: Vec::new(), face };
        let mut used = f64::INFINITY;
        for i in (0..legend.names.len()).filter(|&i| !legend.names[i].is_empty()).collect::<Vec<_>>() {
            let own = legend.entry_width(i);
            if used + own > width + GAPS[1] {
                legend.rows.push(Vec::new());
                used = 0.0;
            }
            legend.rows.last_mut().into_iter().for_each(|row| row.push(i));
            used += own;
        }
        legend
    }

    fn entry_width(&self, i: usize) -> f64 {
        PIECE + GAPS[0] + self.face.width(self.names[i], SIZE) + GAPS[1]
    }

    fn row_width(&self, row: &[usize]) -> f64 {
        row.iter().map(|&i| self.entry_width(i)).sum::<f64>() - GAPS[1]
    }

    /// How high it is \[px\].
    pub(crate) fn height(&self) -> f64 {
        ROW * self.rows.len().min(MOST_ROWS) as f64
    }

    /// The width of a legend of one row, which may stand beside something else \[px\].
    pub(crate) fn single_row(&self) -> Option<f64> {
        match &self.rows[..] {
            [row] => Some(self.row_width(row)),
            _ => None,
        }
    }

    /// With its rows ending at `right`, the first in the middle of the 20 pixels under `top`.
    pub(crate) fn draw(&self, scene: &mut Scene<'_>, right: f64, top: f64) {
        for (k, row) in self.rows.iter().take(MOST_ROWS).enumerate() {
            let y = top + ROW * (k as f64 + 0.5);
            let is_cut = k + 1 == MOST_ROWS && self.rows.len() > MOST_ROWS;
            let row = if is_cut { &row[..row.len().saturating_sub(2)] } else { row };
            let mut x = right - self.row_width(row);
            if is_cut {
                let left = self.rows[k..].iter().map(Vec::len).sum::<usize>() - row.len();
                let count = format!("… and {left} more");
                x -= self.face.width(&count, SIZE) + GAPS[1];
                scene.text(Text::new([right, y], &count, SIZE, Anchor::End));
            }
            for &i in row {
                scene.line([[x, y], [x + PIECE, y]], stroke(i, self.names.len()));
                scene.text(Text::new([x + PIECE + GAPS[0], y], self.names[i], SIZE, Anchor::Start));
                x += self.entry_width(i);
            }
        }
    }
}
