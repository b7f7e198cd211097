//! Where flights arrive, and the ellipsoid that linear covariance says holds 95 % of them.

use std::f64::consts::TAU;

use mbs_chart::{Figure, Panel, PlaneLine};
use nalgebra::{Matrix2, Matrix6, Vector2};

use crate::WITHIN;

/// At most this many flights are drawn.
const DRAWN: usize = 1000;

/// Half the width of the cross of a flight \[m\].
const CROSS: f64 = 1.0;

/// Misses along the orbit beside those radially, and beside those across it.
pub(crate) fn places(covariance: &Matrix6<f64>, misses: &[Vec<f64>]) -> Figure {
    let panel = |[right, up]: [usize; 2], label: &str| {
        let crosses = misses[right].iter().zip(&misses[up]).take(DRAWN).flat_map(|(x, y)| cross(*x, *y));
        let lines = vec![
            PlaneLine::new("flights", crosses.collect()),
            PlaneLine::new("ellipsoid of 95 % by covariance", shadow(covariance, [right, up])),
        ];
        Panel::plane(["along the orbit [m]", label], lines, Vec::new())
    };
    let panels = vec![Panel::Row(vec![panel([1, 0], "radially [m]"), panel([1, 2], "across [m]")])];
    let title = format!("Where {} of {} flights miss", misses[0].len().min(DRAWN), misses[0].len());
    Figure { title, size: (1200, 620), panels }
}

/// Two strokes and a gap.
fn cross(x: f64, y: f64) -> [[f64; 2]; 6] {
    let gap = [f64::NAN; 2];
    [[x - CROSS, y], [x + CROSS, y], gap, [x, y - CROSS], [x, y + CROSS], gap]
}

/// The outline of the ellipsoid of places, seen along the third axis: `yᵀ P₂⁻¹ y = χ²`, where `P₂` is the covariance
/// along the two axes of the panel.
fn shadow(covariance: &Matrix6<f64>, axes: [usize; 2]) -> Vec<[f64; 2]> {
    const SIDES: u32 = 180;
    let plane = Matrix2::from_fn(|i, j| covariance[(axes[i], axes[j])]);
    let root = plane.cholesky().expect("the covariance was inverted").l();
    let point = |k: u32| {
        let angle = TAU * f64::from(k) / f64::from(SIDES);
        WITHIN.sqrt() * root * Vector2::new(angle.cos(), angle.sin())
    };
    (0..=SIDES).map(|k| point(k).into()).collect()
}
