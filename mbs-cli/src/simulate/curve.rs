//! Functions through the rows of a table: broken lines, and cubic splines, whose second derivatives are continuous.

/// A function of one variable through given points, at strictly increasing places; two at least.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
    /// The slopes at the places; none of a broken line.
    slopes: Option<Vec<f64>>,
}

impl Curve {
    /// Straight between the points.
    pub(crate) fn broken_line(x: Vec<f64>, y: Vec<f64>) -> Self {
        Curve { x, y, slopes: None }
    }

    /// The cubic spline whose third derivative is continuous at the second place and the last but one ("not a knot"); a
    /// parabola through three points, a line through two.
    ///
    /// Source: C. de Boor, *A Practical Guide to Splines*, revised ed. 2001, chapter IV, equations (11) to (15).
    pub(crate) fn spline(x: Vec<f64>, y: Vec<f64>) -> Self {
        let slopes = slopes(&x, &y);
        Curve { x, y, slopes: Some(slopes) }
    }

    /// The first and the last place.
    pub(crate) fn range(&self) -> (f64, f64) {
        (self.x[0], self.x[self.x.len() - 1])
    }

    /// The least and the greatest value of the points, and of the curve, where that leaves the range of the points by
    /// more than half of it.
    pub(crate) fn overshoot(&self) -> Option<[[f64; 2]; 2]> {
        const PARTS: usize = 16;
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], y| [least.min(y), most.max(y)])
        };
        let points = range(&mut self.y.iter().copied());
        let between = |pair: &[f64]| {
            let (start, length) = (pair[0], pair[1] - pair[0]);
            (0..PARTS).map(move |part| start + length * part as f64 / PARTS as f64)
        };
        let places: Vec<f64> = self.x.windows(2).flat_map(between).collect();
        let curve = range(&mut places.into_iter().map(|x| self.at(x)[0]));
        let allowed = 0.5 * (points[1] - points[0]);
        (curve[0] < points[0] - allowed || curve[1] > points[1] + allowed).then_some([points, curve])
    }

    /// Value, first and second derivative; beyond the ends the outermost piece goes on.
    pub(crate) fn at(&self, t: f64) -> [f64; 3] {
        let i = self.x.partition_point(|&x| x <= t).clamp(1, self.x.len() - 1) - 1;
        let (h, s) = (self.x[i + 1] - self.x[i], t - self.x[i]);
        let [y0, y1] = [self.y[i], self.y[i + 1]];
        let mean = (y1 - y0) / h;
        let Some(slopes) = &self.slopes else { return [y0 + mean * s, mean, 0.0] };
        // y = y₀ + m₀ s + c s² + d s³
        let [m0, m1] = [slopes[i], slopes[i + 1]];
        let (c, d) = ((3.0 * mean - 2.0 * m0 - m1) / h, (m0 + m1 - 2.0 * mean) / (h * h));
        [y0 + s * (m0 + s * (c + s * d)), m0 + s * (2.0 * c + 3.0 * s * d), 2.0 * c + 6.0 * s * d]
    }
}

/// The slopes of the spline, by elimination in a tridiagonal system.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / h[i]).collect();
    match n {
        2 => return vec![mean[0]; 2],
        3 => {
            let curvature = (mean[1] - mean[0]) / (h[0] + h[1]);
            return vec![mean[0] - curvature * h[0], mean[0] + curvature * h[0], mean[1] + curvature * h[1]];
        }
        _ => {}
    }
    // below · m[i − 1] + middle · m[i] + above · m[i + 1] = right
    let (mut below, mut middle, mut above, mut right) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let end =
        |h0: f64, h1: f64, mean0: f64, mean1: f64| ((h0 + 2.0 * (h0 + h1)) * h1 * mean0 + h0 * h0 * mean1) / (h0 + h1);
    (middle[0], above[0], right[0]) = (h[1], h[0] + h[1], end(h[0], h[1], mean[0], mean[1]));
    for i in 1..n - 1 {
        (below[i], middle[i], above[i]) = (h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]);
        right[i] = 3.0 * (h[i] * mean[i - 1] + h[i - 1] * mean[i]);
    }
    let (last, before) = (h[n - 2], h[n - 3]);
    (middle[n - 1], below[n - 1]) = (before, last + before);
    right[n - 1] = end(last, before, mean[n - 2], mean[n - 3]);
    for i in 1..n {
        let factor = below[i] / middle[i - 1];
        middle[i] -= factor * above[i - 1];
        right[i] -= factor * right[i - 1];
    }
    let mut slopes = vec![0.0; n];
    for i in (0..n).rev() {
        let behind = if i + 1 < n { above[i] * slopes[i + 1] } else { 0.0 };
        slopes[i] = (right[i] - behind) / middle[i];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [f64; 6] = [-1.0, -0.3, 0.4, 1.0, 1.2, 2.0];

    /// A cubic is found again, with its derivatives, whatever the places.
    #[test]
    fn a_spline_through_a_cubic_is_the_cubic() {
        let cubic = |t: f64| [1.0 - t + 2.0 * t * t * t, -1.0 + 6.0 * t * t, 12.0 * t];
        for n in 4..=6 {
            let x = PLACES[..n].to_vec();
            let spline = Curve::spline(x.clone(), x.iter().map(|&t| cubic(t)[0]).collect());
            for t in [-1.0, -0.9, -0.3, 0.0, 0.7, 1.0] {
                for (found, expected) in spline.at(t).iter().zip(cubic(t)) {
                    assert!((found - expected).abs() < 1e-12, "{n} {t}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn few_points() {
        let parabola = Curve::spline(vec![0.0, 1.0, 3.0], vec![1.0, 2.0, 10.0]);
        let [value, slope, curvature] = parabola.at(2.0);
        assert!((value - 5.0).abs() < 1e-12 && (slope - 4.0).abs() < 1e-12 && (curvature - 2.0).abs() < 1e-12);
        assert_eq!(Curve::spline(vec![0.0, 2.0], vec![1.0, 2.0]).at(1.0), [1.5, 0.5, 0.0]);
    }

    #[test]
    fn second_derivatives_are_continuous() {
        let y: Vec<f64> = PLACES.iter().map(|t| (2.0 * t).sin()).collect();
        let spline = Curve::spline(PLACES.to_vec(), y.clone());
        for (&x, &y) in PLACES[1..5].iter().zip(&y[1..5]) {
            let (before, after) = (spline.at(x - 1e-9), spline.at(x + 1e-9));
            assert!((before[0] - y).abs() < 1e-8);
            assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-6), "{before:?} {after:?}");
        }
    }

    #[test]
    fn broken_lines() {
        let line = Curve::broken_line(vec![0.0, 1.0, 3.0], vec![0.0, 2.0, 0.0]);
        assert_eq!([0.0, 0.5, 1.0, 2.0, 3.0].map(|t| line.at(t)[0]), [0.0, 1.0, 2.0, 1.0, 0.0]);
        assert_eq!(line.at(2.0), [1.0, -1.0, 0.0]);
    }
}
