//! `table(x, xs, ys)` and its like: values between samples.
//!
//! In each interval between two places stands a polynomial. Where the samples are numbers they are one [`Spline`], a
//! function of one argument like others, which generated code looks up in a constant. Where their values depend on
//! parameters the table is written as branches: a tree of comparisons with the places finds the interval, as a binary
//! search would.
//!
//! - `table`: straight lines; before the first and behind the last place their values;
//! - `table_monotone`: cubics that rise where the samples rise, with a continuous slope (F. N. Fritsch, R. E. Carlson,
//!   *Monotone piecewise cubic interpolation*, 1980; the slopes of F. N. Fritsch, J. Butland, *A method for
//!   constructing local monotone piecewise cubic interpolants*, 1984, and at the ends those of C. Moler, *Numerical
//!   Computing with MATLAB*, 2004, section 3.6);
//! - `table_spline`: the natural cubic spline, with a continuous curvature (C. de Boor, *A Practical Guide to Splines*,
//!   1978, chapter IV);
//!
//! the last two go on along the tangents at their ends.

use crate::diagnostic::Code;
use crate::expr::{Expr, Number, Spline};
use crate::model::value::builtin::Call;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::model::value::{Scalar, Value, shared};

/// Samples of one table at most.
pub(in crate::model) const MAX_SAMPLES: usize = 10_000;

/// Where values depend on parameters, a table is a tree of as many branches as it has samples, in each function that
/// needs it and in each derivative.
pub(in crate::model) const MAX_PARAMETRIC: usize = 200;

/// What a table is made of.
struct Samples<'g> {
    x: Expr<'g>,
    /// The places, increasing; and their values as numbers.
    xs: Vec<Expr<'g>>,
    places: Vec<f64>,
    ys: Vec<Expr<'g>>,
    dimension: Dimension,
}

/// `c₀ + c₁ s + c₂ s² + c₃ s³` of the distance s from a place.
struct Piece<'g> {
    from: Expr<'g>,
    coefficients: Vec<Expr<'g>>,
}

pub(in crate::model) fn table<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let samples = samples(resolver, call, 2)?;
    let slopes = slopes(resolver, &samples);
    let mut pieces = vec![samples.constant(0)];
    pieces.extend((0..slopes.len()).map(|k| samples.piece(k, vec![samples.ys[k], slopes[k]])));
    pieces.push(samples.constant(samples.ys.len() - 1));
    Ok(samples.value(resolver, &pieces))
}

pub(in crate::model) fn monotone<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let samples = samples(resolver, call, 2)?;
    let secants = slopes(resolver, &samples);
    let tangents = monotone_tangents(resolver, &samples, &secants);
    let pieces = hermite(resolver, &samples, &secants, &tangents);
    Ok(samples.value(resolver, &pieces))
}

pub(in crate::model) fn spline<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let samples = samples(resolver, call, 3)?;
    let secants = slopes(resolver, &samples);
    let tangents = spline_tangents(resolver, &samples, &secants);
    let pieces = hermite(resolver, &samples, &secants, &tangents);
    Ok(samples.value(resolver, &pieces))
}

// ---- what is given

fn samples<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>, least: usize) -> Resolved<Samples<'g>> {
    let [x, xs, ys] = call.arguments else { return Err(Refused) };
    let (found, places, values) = (resolver.scalar(x), numbers(resolver, xs), numbers(resolver, ys));
    let (found, (places, along), (values, dimension)) = (found?, places?, values?);
    if shared((along, false), found.fit()).is_none() {
        let message =
            format!("the places of this table are {}, this is {}", in_words(along), in_words(found.dimension));
        return Err(resolver.refuse(Code::UnequalDimensions, &x.span, message, ""));
    }
    if places.len() != values.len() {
        let message = format!("this table has {} places and {} values", places.len(), values.len());
        return Err(resolver.refuse(Code::TablePlaces, &ys.span, message, "each place has a value"));
    }
    let is_constant = values.iter().all(|&value| resolver.known.facts.constant(value).is_some());
    let most = if is_constant { MAX_SAMPLES } else { MAX_PARAMETRIC };
    if !(least..=most).contains(&places.len()) {
        let kind = if is_constant { "" } else { " with parameters in its values" };
        let message = format!("a table of this kind{kind} has from {least} to {most} samples, not {}", places.len());
        let help = if places.len() < least { "" } else { "leave out samples where the curve is nearly straight" };
        return Err(resolver.refuse(Code::TablePlaces, &xs.span, message, help));
    }
    let places = increasing(resolver, &places, xs)?;
    for &value in &values {
        let dependence = resolver.known.facts.dependence(value);
        if dependence.moves() || dependence.on(Dependence::RATE) {
            let message = "the values of a table are constants and parameters";
            return Err(resolver.refuse(
                Code::TableValues,
                &ys.span,
                message,
                "multiply the table by what changes, or add it",
            ));
        }
    }
    let xs = places.iter().map(|&place| resolver.graph.constant(place)).collect();
    let places = places.iter().map(|place| place.to_f64()).collect();
    let ys = values.into_iter().map(|value| folded(resolver, value)).collect();
    Ok(Samples { x: found.expr, xs, places, ys, dimension })
}

/// The numbers of an array, and the dimension that they share.
fn numbers<'g>(resolver: &mut Resolver<'_, 'g>, array: &Argument<'g>) -> Resolved<(Vec<Expr<'g>>, Dimension)> {
    let (mut exprs, mut common) = (Vec::new(), (Dimension::ONE, true));
    for value in resolver.elements(array)? {
        let number = resolver.scalar(&Argument { value, span: array.span.clone() })?;
        let Some(dimension) = shared(common, number.fit()) else {
            let message =
                format!("the numbers of a table share one dimension, these are {} and {}", common.0, number.dimension);
            return Err(resolver.refuse(Code::UnequalDimensions, &array.span, message, ""));
        };
        common = (dimension, common.1 && number.fit().1);
        exprs.push(number.expr);
    }
    Ok((exprs, common.0))
}

fn increasing<'g>(resolver: &mut Resolver<'_, 'g>, places: &[Expr<'g>], xs: &Argument<'g>) -> Resolved<Vec<Number>> {
    let known: Option<Vec<Number>> = places.iter().map(|&place| resolver.known.facts.constant(place)).collect();
    let Some(known) = known else {
        let help = "the values may be parameters; places are numbers and constants";
        return Err(resolver.refuse(
            Code::TablePlaces,
            &xs.span,
            "the places of a table are known at build time",
            help,
        ));
    };
    match known.windows(2).position(|two| two[0].to_f64() >= two[1].to_f64()) {
        None => Ok(known),
        Some(k) => {
            let (a, b) = (known[k].to_f64(), known[k + 1].to_f64());
            let message = format!("the places of a table increase, here {b} follows {a}");
            Err(resolver.refuse(
                Code::TablePlaces,
                &xs.span,
                message,
                "put the samples in order, and leave out double ones",
            ))
        }
    }
}

/// As one number, where it is made of numbers.
fn folded<'g>(resolver: &mut Resolver<'_, 'g>, expr: Expr<'g>) -> Expr<'g> {
    resolver.known.facts.constant(expr).map_or(expr, |number| resolver.graph.constant(number))
}

// ---- slopes

/// Of the straight lines from place to place.
fn slopes<'g>(resolver: &mut Resolver<'_, 'g>, samples: &Samples<'g>) -> Vec<Expr<'g>> {
    let Samples { xs, ys, .. } = samples;
    (0..xs.len() - 1).map(|k| folded(resolver, (ys[k + 1] - ys[k]) / (xs[k + 1] - xs[k]))).collect()
}

/// The distances from place to place.
fn widths<'g>(resolver: &mut Resolver<'_, 'g>, samples: &Samples<'g>) -> Vec<Expr<'g>> {
    samples.xs.windows(2).map(|two| folded(resolver, two[1] - two[0])).collect()
}

/// A weighted harmonic mean of the secants on both sides, 0 at a turn.
fn monotone_tangents<'g>(
    resolver: &mut Resolver<'_, 'g>,
    samples: &Samples<'g>,
    secants: &[Expr<'g>],
) -> Vec<Expr<'g>> {
    let h = widths(resolver, samples);
    let last = h.len();
    let mut tangents = Vec::new();
    for k in 0..=last {
        let tangent = if last == 1 {
            secants[0]
        } else if k == 0 {
            end_tangent(resolver, [h[0], h[1]], [secants[0], secants[1]])
        } else if k == last {
            end_tangent(resolver, [h[last - 1], h[last - 2]], [secants[last - 1], secants[last - 2]])
        } else {
            let weights = [2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]].map(|weight| folded(resolver, weight));
            mean_tangent(resolver, weights, [secants[k - 1], secants[k]])
        };
        tangents.push(tangent);
    }
    tangents
}

fn mean_tangent<'g>(resolver: &mut Resolver<'_, 'g>, [v, w]: [Expr<'g>; 2], [a, b]: [Expr<'g>; 2]) -> Expr<'g> {
    let (zero, mean) = (resolver.graph.integer(0), (v + w) / (v / a + w / b));
    match both(resolver, a, b) {
        Some(secants) if turn(secants) => zero,
        Some(_) => folded(resolver, mean),
        None => {
            let sum = folded(resolver, v + w);
            resolver.graph.select((a * b).less_equal(zero), zero, sum / (v / a + w / b))
        }
    }
}

/// By the parabola through three samples, kept from turning.
fn end_tangent<'g>(resolver: &mut Resolver<'_, 'g>, [h, next]: [Expr<'g>; 2], [a, b]: [Expr<'g>; 2]) -> Expr<'g> {
    let own = folded(resolver, (2 * h + next) / (h + next));
    let other = folded(resolver, -h / (h + next));
    let zero = resolver.graph.integer(0);
    let tangent = folded(resolver, own * a + other * b);
    if let (Some([slope, first]), Some([_, second])) = (both(resolver, tangent, a), both(resolver, a, b)) {
        return if turn([slope, first]) {
            zero
        } else if turn([first, second]) && slope.abs() > 3.0 * first.abs() {
            folded(resolver, 3 * a)
        } else {
            tangent
        };
    }
    let too_steep = (a * b).less_equal(zero).and((9 * a.powi(2)).less(tangent.powi(2)));
    let kept = resolver.graph.select(too_steep, 3 * a, tangent);
    resolver.graph.select((tangent * a).less_equal(zero), zero, kept)
}

/// Whether a curve with these slopes, one after the other, does not only rise or only fall.
fn turn([a, b]: [f64; 2]) -> bool {
    !((a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0))
}

fn both<'g>(resolver: &mut Resolver<'_, 'g>, a: Expr<'g>, b: Expr<'g>) -> Option<[f64; 2]> {
    Some([resolver.known.facts.constant(a)?.to_f64(), resolver.known.facts.constant(b)?.to_f64()])
}

/// Of the spline whose curvature is continuous, and 0 at the ends.
///
/// With `h_k` the widths and `δ_k` the secants, the curvatures solve
/// `h_{k−1} m_{k−1} + 2 (h_{k−1} + h_k) m_k + h_k m_{k+1} = 6 (δ_k − δ_{k−1})`, `m_0 = m_n = 0`.
fn spline_tangents<'g>(resolver: &mut Resolver<'_, 'g>, samples: &Samples<'g>, secants: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let h = widths(resolver, samples);
    if secants.iter().all(|&secant| resolver.known.facts.constant(secant).is_some()) {
        return tangents(resolver, &h, secants);
    }
    // Linear in the secants: the answers to one of them being 1.
    let mut sums: Vec<Option<Expr<'g>>> = vec![None; h.len() + 1];
    for (j, &secant) in secants.iter().enumerate() {
        let unit: Vec<Expr<'g>> = (0..h.len()).map(|k| resolver.graph.integer(i64::from(k == j))).collect();
        let weights = tangents(resolver, &h, &unit);
        for (sum, weight) in sums.iter_mut().zip(weights).filter(|(_, weight)| !weight.is_zero()) {
            *sum = Some(sum.map_or(weight * secant, |sum| sum + weight * secant));
        }
    }
    sums.into_iter().map(|sum| sum.unwrap_or_else(|| resolver.graph.integer(0))).collect()
}

/// `δ_k − h_k (2 m_k + m_{k+1})/6` at each place, and `δ + h m/6` at the last, for secants that are numbers.
fn tangents<'g>(resolver: &mut Resolver<'_, 'g>, h: &[Expr<'g>], secants: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let m = curvatures(resolver, h, secants);
    let last = h.len() - 1;
    let inner = (0..h.len()).map(|k| secants[k] - h[k] * (2 * m[k] + m[k + 1]) / 6);
    let all: Vec<Expr<'g>> = inner.chain([secants[last] + h[last] * m[last] / 6]).collect();
    all.into_iter().map(|tangent| folded(resolver, tangent)).collect()
}

/// By elimination: the matrix is tridiagonal and its diagonal prevails.
fn curvatures<'g>(resolver: &mut Resolver<'_, 'g>, h: &[Expr<'g>], secants: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let (n, zero) = (h.len(), resolver.graph.integer(0));
    let (mut upper, mut right) = (vec![zero; n + 1], vec![zero; n + 1]);
    for k in 1..n {
        let pivot = folded(resolver, 2 * (h[k - 1] + h[k]) - h[k - 1] * upper[k - 1]);
        upper[k] = folded(resolver, h[k] / pivot);
        right[k] = folded(resolver, (6 * (secants[k] - secants[k - 1]) - h[k - 1] * right[k - 1]) / pivot);
    }
    let mut m = vec![zero; n + 1];
    for k in (1..n).rev() {
        m[k] = folded(resolver, right[k] - upper[k] * m[k + 1]);
    }
    m
}

// ---- pieces

/// Cubics with these slopes at the places, and their tangents outside.
fn hermite<'g>(
    resolver: &mut Resolver<'_, 'g>,
    samples: &Samples<'g>,
    secants: &[Expr<'g>],
    tangents: &[Expr<'g>],
) -> Vec<Piece<'g>> {
    let mut pieces = vec![samples.piece(0, vec![samples.ys[0], tangents[0]])];
    for (k, &secant) in secants.iter().enumerate() {
        let h = samples.xs[k + 1] - samples.xs[k];
        let (a, b) = (tangents[k], tangents[k + 1]);
        let squares = folded(resolver, (3 * secant - 2 * a - b) / h);
        let cubes = folded(resolver, (a + b - 2 * secant) / h.powi(2));
        pieces.push(samples.piece(k, vec![samples.ys[k], a, squares, cubes]));
    }
    let last = secants.len();
    pieces.push(samples.piece(last, vec![samples.ys[last], tangents[last]]));
    pieces
}

impl<'g> Samples<'g> {
    fn piece(&self, k: usize, coefficients: Vec<Expr<'g>>) -> Piece<'g> {
        Piece { from: self.xs[k], coefficients }
    }

    fn constant(&self, k: usize) -> Piece<'g> {
        self.piece(k, vec![self.ys[k]])
    }

    fn value(&self, resolver: &mut Resolver<'_, 'g>, pieces: &[Piece<'g>]) -> Value<'g> {
        let expr = match self.spline(resolver, pieces) {
            Some(spline) => resolver.graph.spline(&spline, self.x),
            None => self.search(pieces, &self.xs),
        };
        Value::Scalar(Scalar::new(expr, self.dimension))
    }

    /// The pieces as a spline, where all of them are made of numbers.
    fn spline(&self, resolver: &mut Resolver<'_, 'g>, pieces: &[Piece<'g>]) -> Option<Spline> {
        let longest = pieces.iter().map(|piece| piece.coefficients.len()).max()?;
        let mut rows = Vec::new();
        for piece in pieces {
            let mut row = vec![0.0; longest + 1];
            for (entry, &expr) in row.iter_mut().zip([piece.from].iter().chain(&piece.coefficients)) {
                *entry = resolver.known.facts.constant(expr)?.to_f64();
            }
            rows.push(row);
        }
        Some(Spline::new(self.places.clone(), rows))
    }

    /// The piece where x lies: one more of them than places between them.
    fn search(&self, pieces: &[Piece<'g>], between: &[Expr<'g>]) -> Expr<'g> {
        let Some(&middle) = between.get(between.len() / 2) else { return self.along(&pieces[0]) };
        let half = between.len() / 2;
        let before = self.search(&pieces[..=half], &between[..half]);
        let behind = self.search(&pieces[half + 1..], &between[half + 1..]);
        self.x.graph().select(self.x.less(middle), before, behind)
    }

    /// By Horner's rule.
    fn along(&self, piece: &Piece<'g>) -> Expr<'g> {
        let s = if piece.from.is_zero() { self.x } else { self.x - piece.from };
        let mut coefficients = piece.coefficients.iter().rev();
        let highest = *coefficients.next().expect("a piece has a value");
        coefficients.fold(highest, |sum, &c| c + s * sum)
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{near, refused, value, value_with_unit};

    /// At x, whose trial state is 0.3 m and 0.5 m/s; the tables are in m.
    fn at(kind: &str, ys: &str, x: f64) -> f64 {
        let statements = format!("const d[4]: m = [0, 1, 2, 3]; let at = {x}/0.3*x;");
        value(&statements, &format!("{kind}(at, d, {ys})"))[0]
    }

    #[test]
    fn lines_between_samples() {
        for (x, expected) in [(0.0, 1.0), (0.25, 1.5), (1.5, 3.5), (2.75, 4.75), (-1.0, 1.0), (3.0, 5.0), (7.0, 5.0)] {
            near(&[at("table", "[1, 3, 4, 5]", x)], &[expected], &x.to_string());
        }
        assert_eq!(value_with_unit("const d[2]: m = [0, 2]; const f[2]: N = [1, 5];", "table(x, d, f)").1, "kg·m/s²");
        near(&value("const d[2]: m = [0, 2]; const f[2]: m = [1, 5];", "dt(table(x, d, f))"), &[1.0], "2 · 0.5");
        near(&value("const d[2]: m = [0, 2];", "table(x, d, [l, 5*l])"), &[4.8], "values of parameters");
        near(&value("fn table(x) = 2*x;", "table(x)"), &[0.6], "a function of the mechanism's own");
    }

    /// Of de Boor's equations solved by hand: the curvatures are 0, −4, 4, 0.
    #[test]
    fn splines_have_continuous_curvature() {
        for ys in ["[0, 1, 0, 1]", "[0, 1, 0, 1*l/l]"] {
            for (x, expected) in [(0.5, 0.75), (1.5, 0.5), (2.5, 0.25), (-1.0, -5.0 / 3.0), (4.0, 1.0 + 5.0 / 3.0)] {
                near(&[at("table_spline", ys, x)], &[expected], &format!("{ys} at {x}"));
            }
        }
    }

    /// A cubic is its own spline only where its curvature vanishes at the ends; the slopes are those of the formulas.
    #[test]
    fn monotone_tables_rise_where_their_samples_do() {
        // d = 0, 1.5, …: h₀₁ + 1.5 h₁₁ at the middle of the first interval.
        for ys in ["[0, 1, 4, 9]", "[0, 1, 4, 9*l/l]"] {
            near(&[at("table_monotone", ys, 0.5)], &[0.5 - 1.5 / 8.0], ys);
        }
        // A step: nothing overshoots.
        for k in 0..=40 {
            let x = 0.1 * f64::from(k) - 0.5;
            let step = at("table_monotone", "[0, 0, 1, 1]", x);
            assert!((0.0..=1.0).contains(&step), "{x}: {step}");
        }
    }

    #[test]
    fn tables_are_generated_and_proved() {
        for kind in ["table", "table_monotone", "table_spline"] {
            let text = format!(
                "mechanism A {{ param m: kg = 1; param stiff: N/m = 5; coord x: m; kinetic += 1/2*m*dt(x)^2; \
                 const d[5]: m = [-1, -0.3, 0, 0.4, 1]; param f[5]: N = [-8, -1, 0, 2, 9]; \
                 const v[3]: m/s = [-2, 0, 2]; const r[3]: N = [3, 0, -3]; \
                 potential += 1/2*stiff*x^2; force x += -{kind}(x, d, f) + {kind}(dt(x), v, r); }}"
            );
            let generated = crate::generate("a", &text, &Default::default());
            let generated = generated.unwrap_or_else(|e| panic!("{}", e.render("a", &text)));
            assert_eq!(generated.warnings, "", "{kind}");
        }
    }

    #[test]
    fn wrong_tables() {
        let table = |arguments: &str, message: &str| {
            refused(&format!("const d[3]: m = [0, 1, 2]; let a = table_spline({arguments});"), message);
        };
        table("x, [0, 2, 1], d", "x: the places of this table are a plain number, this is m");
        table(
            "x/l, [0, 2, 1], d",
            "[0, 2, 1]: the places of a table increase, here 1 follows 2; put the samples in order, and leave out double ones",
        );
        table("x, d, [1, 2]", "[1, 2]: this table has 3 places and 2 values; each place has a value");
        table("x/l, [0, 1], [1, 2]", "[0, 1]: a table of this kind has from 3 to 10000 samples, not 2");
        let [places, values] = ["k", "l*k"].map(|value| format!("[{}]", vec![value; 201].join(", ")).replace('k', "1"));
        table(
            &format!("x/l, {places}, {values}"),
            &format!(
                "{places}: a table of this kind with parameters in its values has from 3 to 200 samples, not 201; \
                 leave out samples where the curve is nearly straight"
            ),
        );
        table(
            "x, [l, 2*l, 3*l], d",
            "[l, 2*l, 3*l]: the places of a table are known at build time; the values may be parameters; places are numbers and constants",
        );
        table(
            "x, d, [x, y, z]",
            "[x, y, z]: the values of a table are constants and parameters; multiply the table by what changes, or add it",
        );
    }
}
