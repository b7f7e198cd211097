//! The functions of each language's library, within four units in the last place of Rust's.

use mbs_derive::emit::Trigonometry;
use mbs_derive::source::Sources;
use mbs_printers::case::{Case, Wanted};
use mbs_printers::depth::STATES;

/// Units in the last place.
const ULPS: f64 = 4.0;

/// Each function of the language as an output; what is done to its argument is exact in all languages.
const TEXT: &str = "
mechanism Elementary {
    coord x: m;
    coord y: m;
    kinetic += 1 kg*(dt(x)^2 + dt(y)^2)/2;
    let a = x/(1 m);
    let b = y/(1 m);
    output sine = sin(16*a);
    output cosine = cos(16*a);
    output tangent = tan(a);
    output arcsine = asin(a/2);
    output arccosine = acos(a/2);
    output arctangent = atan(8*a);
    output of_a_point = atan2(a, b);
    output hyperbolic_sine = sinh(4*a);
    output hyperbolic_cosine = cosh(4*a);
    output hyperbolic_tangent = tanh(2*a);
    output exponential = exp(16*a);
    output logarithm = ln(2 + a);
    output root = sqrt(2 + a);
    output power = (2 + a)^b;
    output length = hypot(a, b);
    output size = abs(a);
    output sign = signum(a);
}";

/// The mechanism of all functions, and its outputs with bounds of four units.
pub(crate) fn case() -> (Case, impl Fn(&Case, Trigonometry) -> Wanted) {
    let mut case = Case::new("elementary", &Sources::new("elementary", TEXT));
    // Their slopes and the equations of motion are no functions of the library.
    case.of.altered().functions.retain(|function| TEXT.contains(&format!("output {} =", function.name)));
    assert_eq!(case.of.functions.len(), TEXT.matches("output ").count());
    let wanted = |case: &Case, trigonometry| {
        let mut wanted = case.wanted(trigonometry, STATES);
        let bound = |(bound, value): (&mut f64, &f64)| *bound = if *bound == 0.0 { 0.0 } else { ULPS * ulp(*value) };
        wanted.bounds.iter_mut().zip(&wanted.values).for_each(bound);
        wanted
    };
    (case, wanted)
}

fn ulp(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}
