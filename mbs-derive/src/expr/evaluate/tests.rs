use super::*;
use crate::expr::{Dual, Graph};

/// The value of an expression in x, on a strict tape.
fn strict(x: f64, build: impl for<'g> Fn(&'g Graph, Expr<'g>) -> Expr<'g>) -> f64 {
    let graph = Graph::verbatim();
    let root = build(&graph, graph.symbol(Symbol::Time));
    Tape::strict(&[root]).run(|_| x)[0]
}

#[test]
fn strict_tapes_pass_on_what_is_undefined() {
    assert!(strict(-1.0, |graph, x| graph.select(x.sqrt().less(graph.integer(0)), graph.integer(0), x)).is_nan());
    assert!(strict(-1.0, |graph, x| graph.select(x.less(x.sqrt()).not(), graph.integer(0), x)).is_nan());
    assert!(strict(-1.0, |graph, x| graph.integer(1).call2(Binary::Powf, x.sqrt())).is_nan());
}

/// Not only the value: a constant NaN would be a value that does not change.
#[test]
fn what_is_undefined_has_no_derivative() {
    let graph = Graph::verbatim();
    let x = graph.symbol(Symbol::Time);
    let root = graph.select(x.sqrt().less(x), x, graph.integer(0));
    let value = Tape::strict(&[root]).run(|_| Dual::new(Dual::new(-1.0, 1.0), Dual::new(1.0, 0.0)))[0];
    let all = [value.value.value, value.value.derivative, value.derivative.value, value.derivative.derivative];
    assert!(all.iter().all(|v: &f64| v.is_nan()), "{all:?}");
}

/// (−2)³ with its slope 3·(−2)² and the slope of that; there is none in an exponent that moves.
#[test]
fn powers_of_negative_numbers_have_derivatives_where_the_exponent_is_fixed() {
    let graph = Graph::verbatim();
    let [x, n] = [Symbol::Coordinate(0), Symbol::Parameter(0)].map(|symbol| graph.symbol(symbol));
    let at = |exponent| {
        let point = |symbol| match symbol {
            Symbol::Parameter(_) => Dual::fixed(Dual::fixed(2.0)),
            _ => Dual::new(Dual::new(-2.0, 1.0), Dual::new(1.0, 0.0)),
        };
        Tape::of_motions(&[x.call2(Binary::Powf, exponent)]).run(point)[0]
    };
    assert_eq!(at(n + graph.integer(1)), Dual::new(Dual::new(-8.0, 12.0), Dual::new(12.0, -12.0)));
    let moving: Dual<Dual<f64>> = at(n + x * graph.integer(0));
    assert!(moving.value.value == 4.0 && moving.derivative.value.is_nan());
}

#[test]
fn strict_tapes_look_at_no_branch_that_is_not_taken() {
    assert_eq!(strict(-1.0, |graph, x| graph.select(graph.integer(0).less(x), x.sqrt(), x)), -1.0);
    // x > 0 && √x < 1 is false, and x < 0 || √x < 1 true, whatever the root is.
    assert_eq!(
        strict(-1.0, |graph, x| {
            let both = graph.integer(0).less(x).and(x.sqrt().less(graph.integer(1)));
            graph.select(both, x.sqrt(), x)
        }),
        -1.0
    );
    assert_eq!(
        strict(-1.0, |graph, x| {
            let either = x.less(graph.integer(0)).or(x.sqrt().less(graph.integer(1)));
            graph.select(either, x, x.sqrt())
        }),
        -1.0
    );
}

#[test]
fn strict_tapes_have_no_value_at_a_corner() {
    let corner = |x| strict(x, |_, x| x.call(Function::Abs));
    assert!(corner(0.0).is_nan() && corner(-0.0).is_nan());
    assert_eq!((corner(2.0), corner(-2.0)), (2.0, 2.0));
}

#[test]
fn strict_tapes_have_no_value_on_the_cut_of_atan2() {
    let angle = |y| strict(y, |graph, y| y.call2(Binary::Atan2, graph.integer(-1)));
    assert!(angle(0.0).is_nan() && angle(-0.0).is_nan());
    assert!(angle(1e-300) > 3.0 && angle(-1e-300) < -3.0);
}
