//! Multiple-angle normal form: sums of monomials times a sine or cosine of a sum of angles, as in a textbook.
//!
//! Products of sines and cosines become sums, `cos a cos b = ½ (cos(a − b) + cos(a + b))`, so that what cancels cancels
//! and a double pendulum shows `m2 l1 l2 cos(θ1 − θ2)`. The form can be exponentially longer than the graph it stands
//! for, so it is given up when it grows past a bound; then the graph's own form is the better one.
//!
//! - [`combination`]: linear combinations and polynomials;
//! - [`powers`]: the factors of a term;
//! - `expansion`: the graph multiplied out;
//! - [`wave`]: sines and cosines of sums of angles;
//! - [`half_angle`]: doubled angles halved again, `sin²θ` for `½ (1 − cos 2θ)`;
//! - [`kept`]: sums that stay factors, so that no digits are lost;
//! - `digits`: whether a form has lost some all the same;
//! - [`factor`]: polynomials as expressions, with common factors taken out and products shared.

pub(crate) mod combination;
mod digits;
mod expansion;
pub(crate) mod factor;
pub(crate) mod half_angle;
pub(crate) mod kept;
pub(crate) mod powers;
pub(crate) mod wave;

use super::graph::{Expr, Graph};

pub(crate) use expansion::Sum;
pub(crate) use factor::weight;
pub(crate) use kept::Kept;

use combination::Polynomial;
use expansion::Expansion;
use half_angle::Doubled;
use kept::Turned;

/// The expressions in normal form, with common factors taken out again; `None` where one of them has more than `limit`
/// terms on the way.
///
/// Equal polynomials give the same expression, where nothing is kept: that is for reading and comparing, because
/// differences are multiplied out that have digits to lose.
pub(crate) fn normal_form<'g>(roots: &[Expr<'g>], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some(first) = roots.first() else { return Some(Vec::new()) };
    let mut expansion = Expansion::new(first.graph(), kept, Turned::Kept, limit);
    let form = |root: &Expr<'g>| {
        let sum = expansion.of(root.id())?;
        expansion.expression(&sum)
    };
    roots.iter().map(form).collect()
}

/// The expressions in the cheapest of the forms that texts use, all of them in the same: multiple angles, or doubled
/// angles halved; with common factors taken out, or shared products named. What is kept is not multiplied out. Forms
/// that lose digits do not count; where all of them do, the expressions stay as they are. `None` where one of them has
/// more than `limit` terms on the way.
pub(crate) fn cheapest_form<'g>(roots: &[Expr<'g>], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some(first) = roots.first() else { return Some(Vec::new()) };
    let graph = first.graph();
    let mut forms = Forms::new(graph);
    for &turned in kept.ways() {
        let mut expansion = Expansion::new(graph, kept, turned, limit);
        let sums: Option<Vec<Sum>> = roots.iter().map(|root| expansion.of(root.id())).collect();
        let Some(sums) = sums else { continue };
        for doubled in Doubled::ALL {
            forms.add(sums.iter().map(|sum| expansion.polynomial(sum, Some(doubled))).collect());
        }
    }
    forms.cheapest(roots)
}

/// The forms of polynomials, each once.
struct Forms<'g> {
    graph: &'g Graph,
    polynomials: Vec<Vec<Polynomial>>,
    written: Vec<Vec<Expr<'g>>>,
}

impl<'g> Forms<'g> {
    fn new(graph: &'g Graph) -> Self {
        Forms { graph, polynomials: Vec::new(), written: Vec::new() }
    }

    /// Of polynomials that there are, and that are not there yet: ways differ in doubled angles and kept sums alone.
    fn add(&mut self, polynomials: Option<Vec<Polynomial>>) {
        if let Some(polynomials) = polynomials.filter(|polynomials| !self.polynomials.contains(polynomials)) {
            self.written.push(factor::shared(self.graph, &polynomials));
            self.polynomials.push(polynomials);
        }
    }

    /// Of equally cheap ones the first, among those that keep the digits of what they stand for; that itself where none
    /// does, `None` where there are no forms.
    fn cheapest(mut self, given: &[Expr<'g>]) -> Option<Vec<Expr<'g>>> {
        if self.written.is_empty() {
            return None;
        }
        self.written.sort_by_cached_key(|form| weight(form));
        self.written.dedup();
        let kept = self.written.into_iter().find(|form| digits::are_kept(given, form));
        Some(kept.unwrap_or_else(|| given.to_vec()))
    }
}

/// `a / b` for each pair, in the cheapest of the forms that texts use; what is common to a and to a b of one term
/// cancels.
pub(crate) fn quotients<'g>(pairs: &[(Expr<'g>, Expr<'g>)], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some((first, _)) = pairs.first() else { return Some(Vec::new()) };
    let graph = first.graph();
    let given: Vec<_> = pairs.iter().map(|&(a, b)| a / b).collect();
    let mut forms = Forms::new(graph);
    for &turned in kept.ways() {
        let mut expansion = Expansion::new(graph, kept, turned, limit);
        let sums: Option<Vec<[Sum; 2]>> =
            pairs.iter().map(|(a, b)| Some([expansion.of(a.id())?, expansion.of(b.id())?])).collect();
        let Some(sums) = sums else { continue };
        for doubled in Doubled::ALL {
            let quotient = |[a, b]: &[Sum; 2]| {
                let [a, b] = [expansion.polynomial(a, Some(doubled))?, expansion.polynomial(b, Some(doubled))?];
                let reciprocal = b.monomial_power(-1).unwrap_or_else(|| factor::reciprocal(graph, &b));
                a.times(&reciprocal, limit)
            };
            forms.add(sums.iter().map(quotient).collect());
        }
    }
    forms.cheapest(&given)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, Symbol};

    #[test]
    fn products_of_waves_become_multiple_angles() {
        let graph = Graph::new();
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let f = m * l * (a.cos() * b.cos() + a.sin() * b.sin());
        assert_eq!(normal_form(&[f], &Kept::default(), 100), Some(vec![m * l * (a - b).cos()]));
        let unit = a.sin().powi(2) * m + m * a.cos().powi(2);
        assert_eq!(normal_form(&[unit], &Kept::default(), 100), Some(vec![m]));
    }

    #[test]
    fn common_factors_are_taken_out() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Velocity(i)));
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let f = m * l.powi(2) * x + l.powi(2) * x;
        assert_eq!(normal_form(&[f], &Kept::default(), 100), Some(vec![x * ((m + 1) * l.powi(2))]));
        let g = x * y + x * m;
        assert_eq!(normal_form(&[g], &Kept::default(), 100), Some(vec![x * (y + m)]));
    }

    #[test]
    fn doubled_angles_are_halved_where_that_is_cheaper() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (x.sin(), x.cos());
        let f = [a * s.powi(2) + b * c.powi(2), (a - b) * s * c];
        let form = cheapest_form(&f, &Kept::default(), 100).unwrap();
        assert!(f.iter().zip(&form).all(|(f, form)| agree(*f, *form)), "{form:?}");
        // (a − b) s², + b, and (a − b) s · c; with the sine and cosine of 2 x it is no less.
        assert_eq!(weight(&form), 20 + 4, "{form:?}");
        // The cosine of 2 x alone is left alone.
        let doubled = (2 * x).cos();
        assert_eq!(cheapest_form(&[c.powi(2) - s.powi(2)], &Kept::default(), 100), Some(vec![doubled]));
    }

    /// `1 − cos 4x` has lost its digits where `2 sin² 2x` has them all, however often the angle was doubled.
    #[test]
    fn a_cosine_beside_its_one_is_halved() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        for multiple in [1, 2, 4, 6] {
            let near_zero = a * (b + 1) * (multiple * x).sin().powi(2);
            let near_quarter = a * (multiple * x).cos().powi(2);
            // Where the sine, and where the cosine, is 1e-7.
            for (f, angle) in [(near_zero, 1e-7), (near_quarter, std::f64::consts::FRAC_PI_2 - 1e-7)] {
                let value = |symbol| match symbol {
                    Symbol::Coordinate(_) => angle / multiple as f64,
                    _ => 3.0,
                };
                let form = cheapest_form(&[f], &Kept::default(), 100).unwrap()[0];
                let values: Vec<f64> = crate::expr::evaluate(&[form, f], value);
                assert!((values[0] - values[1]).abs() < 1e-15 * values[1], "{form}: {values:?}");
            }
        }
    }

    #[test]
    fn signs_of_reversed_angles_are_kept() {
        let graph = Graph::new();
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        for (x, y) in [(a, b), (b, a)] {
            // Twice of each, so that halving is cheaper than another pair.
            let f = [(2 * x - 2 * y).sin() + (x - y).sin(), (2 * x - 2 * y).cos() * (x - y).cos()];
            let form = cheapest_form(&f, &Kept::default(), 100).unwrap();
            assert!(f.iter().zip(&form).all(|(f, form)| agree(*f, *form)), "{form:?}");
            let polynomial = |doubled: Doubled| {
                let nothing = Kept::default();
                let mut expansion = Expansion::new(&graph, &nothing, Turned::Kept, 100);
                let sum = expansion.of(f[0].id()).unwrap();
                factor::factored(&graph, &[expansion.polynomial(&sum, Some(doubled)).unwrap()])[0]
            };
            assert!(Doubled::ALL.into_iter().all(|doubled| agree(polynomial(doubled), f[0])));
        }
    }

    #[test]
    fn products_are_shared() {
        let graph = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|i| graph.symbol(Symbol::Velocity(i)));
        let s = graph.symbol(Symbol::Coordinate(0)).sin();
        let m = graph.symbol(Symbol::Parameter(0));
        // m s once, then one product each.
        let form = cheapest_form(&[m * (x * s), (m * y) * s, m * z * s], &Kept::default(), 100).unwrap();
        assert_eq!(weight(&form), 20 + 4, "{form:?}");
        // Sums and their negatives are one.
        let form = cheapest_form(&[m * x - s * y, s * y - m * x], &Kept::default(), 100).unwrap();
        assert_eq!(form[0], -form[1]);
    }

    /// Next to x = −a the square of the difference has digits that the sum of its products has lost.
    #[test]
    fn differences_of_places_are_kept() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, m] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let distance = ((x + a).powi(2) + y.powi(2)).sqrt();
        let product = (m * (x + a)) * ((x + a) * y.sin());
        // Of a product one factor may be rounded in its terms, 1e-11 of it; multiplied out 1e-5 were lost.
        let all = [((x + a).powi(2), 1e-15), (distance, 1e-15), ((x + a) * distance.powi(-3), 1e-15), (product, 1e-9)];
        for (f, tolerance) in all {
            let form = normal_form(&[f], &Kept::default(), 100).unwrap()[0];
            let value = |symbol| match symbol {
                Symbol::Coordinate(0) => 1e-6 - 0.3,
                Symbol::Coordinate(_) => 1e-6,
                _ => 0.3,
            };
            let values: Vec<f64> = crate::expr::evaluate(&[form, f], value);
            assert!((values[0] - values[1]).abs() < tolerance * values[1], "{values:?}");
        }
        // Beside numbers they are multiplied out, so that like terms meet; squares do not meet what they are made of.
        assert_eq!(normal_form(&[m * (x + a) - m * a], &Kept::default(), 100), Some(vec![m * x]));
        let kept = (x + a).powi(2) - x.powi(2) - 2 * a * x;
        assert!(
            normal_form(&[kept], &Kept::default(), 100).unwrap()[0] != a.powi(2)
                && agree(normal_form(&[kept], &Kept::default(), 100).unwrap()[0], kept)
        );
        // With sines and cosines there may be something to cancel.
        let turned = (x * y.cos() + a).powi(2) + (x * y.sin()).powi(2);
        assert!(agree(normal_form(&[turned], &Kept::default(), 100).unwrap()[0], turned));
        assert_eq!(
            normal_form(&[turned - 2 * a * x * y.cos()], &Kept::default(), 100),
            Some(vec![a.powi(2) + x.powi(2)])
        );
    }

    /// A force beside others, and the square of a distance in axes that turn; in a form of a form, too.
    #[test]
    fn what_energies_were_written_with_is_kept() {
        let graph = Graph::new();
        let [x, y, nu] = [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest, b] = [0, 1, 2].map(|i| graph.symbol(Symbol::Parameter(i)));
        let [[u, v], [p, q]] =
            [[x, y], [rest, b]].map(|[x, y]| [x * nu.cos() - y * nu.sin(), x * nu.sin() + y * nu.cos()]);
        let energy = k * (x - rest).powi(2) + k * ((u - p).powi(2) + (v - q).powi(2));
        let force = k * (x - rest) + k * y * (u - p) * (y - b);
        let kept = Kept::of(&[energy], &[]);
        let once = cheapest_form(&[energy, force], &kept, 100).unwrap();
        let twice = cheapest_form(&[once[0] * k, once[1] * nu.cos() * (x - rest)], &kept, 100).unwrap();
        let (far, near) = (0.3, 0.3 + 1e-9);
        let value = |symbol| match symbol {
            Symbol::Coordinate(0) => near,
            Symbol::Coordinate(1) => 0.7 + 1e-9,
            Symbol::Coordinate(_) => 0.4,
            Symbol::Parameter(i) => [1e9, far, 0.7][i as usize],
            other => unreachable!("{other} is not used here"),
        };
        let expected = [energy, force, energy * k, force * nu.cos() * (x - rest)];
        let found = [once, twice].concat();
        let values: Vec<f64> = crate::expr::evaluate(&[&expected[..], &found].concat(), value);
        // The distance is as near as the places, which are rounded at 1e-16.
        assert!((0..4).all(|i| (values[i + 4] - values[i]).abs() < 1e-6 * values[i].abs()), "{values:?}");
        // Multiplied out, they are noise.
        let expanded = normal_form(&[energy], &Kept::default(), 100).unwrap()[0];
        let noise: Vec<f64> = crate::expr::evaluate(&[expanded], value);
        assert!((noise[0] - values[0]).abs() > 0.5 * values[0], "{noise:?} {values:?}");
    }

    /// One of two sums in which sines and cosines cancel may be multiplied out, not both.
    #[test]
    fn turned_sums_are_multiplied_out_where_that_is_cheaper() {
        let graph = Graph::new();
        let [theta, phi] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (theta.sin(), theta.cos());
        let [u, v] = [a * c - b, a * s - b];
        let kept = Kept::of(&[(u.powi(2) + v.powi(2)) * phi], &[]);
        // The slope of the distance: a b (s − c).
        let slope = cheapest_form(&[v * (a * c) - u * (a * s)], &kept, 100).unwrap();
        assert!(weight(&slope) <= 20 + 3, "{slope:?}");
        let product = (u * s) * (v * c) * phi;
        let form = cheapest_form(&[product], &kept, 100).unwrap()[0];
        // cos θ = sin θ = b/a, nearly.
        let value = |symbol| match symbol {
            Symbol::Coordinate(0) => std::f64::consts::FRAC_PI_4 + 1e-9,
            Symbol::Coordinate(_) => 1.0,
            Symbol::Parameter(0) => 1.0,
            _ => std::f64::consts::FRAC_1_SQRT_2,
        };
        let values: Vec<f64> = crate::expr::evaluate(&[form, product], value);
        assert!((values[0] - values[1]).abs() < 1e-6 * values[1].abs(), "{values:?}");
    }

    #[test]
    fn factors_cancel_in_quotients() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (x.sin(), x.cos());
        let d = (a + b) * s.powi(2);
        let pairs = [(a * s * c * y + b * (s * y) * c, d), (y, s + c), (y, a * b)];
        let form = quotients(&pairs, &Kept::default(), 100).unwrap();
        // y c / s
        assert_eq!(weight(&form[..1]), 20 + 5, "{form:?}");
        assert!(form.iter().zip(pairs).all(|(form, (a, b))| agree(*form, a / b)), "{form:?}");
    }

    /// Equal at a point with no special relation.
    fn agree(a: Expr<'_>, b: Expr<'_>) -> bool {
        let value = |symbol| match symbol {
            Symbol::Coordinate(i) => 0.7 + 0.31 * f64::from(i),
            Symbol::Parameter(i) => 1.3 + 0.57 * f64::from(i),
            other => unreachable!("{other} is not used here"),
        };
        let values: Vec<f64> = crate::expr::evaluate(&[a, b], value);
        (values[0] - values[1]).abs() < 1e-13 * values[1].abs()
    }

    #[test]
    fn a_long_product_of_sums_is_given_up() {
        let graph = Graph::new();
        let factor = |i: u32| (0..3).fold(graph.integer(1), |sum, k| sum + graph.symbol(Symbol::Velocity(3 * i + k)));
        let product = (0..9).fold(graph.integer(1), |product, i| product * factor(i));
        assert_eq!(normal_form(&[product], &Kept::default(), 1000), None);
    }
}
