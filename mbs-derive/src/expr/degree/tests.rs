use super::*;

fn number(numerator: i128, denominator: i128) -> Degree {
    Degree::number(Number::rational(numerator, denominator).unwrap())
}

fn plain(numerator: f64, denominator: f64) -> Quotient {
    Quotient { numerator, denominator }
}

#[test]
fn rational_operations_by_hand() {
    let x = Degree::symbol(1);
    // x³/(x + 1) + 1/x = (x⁴ + x + 1)/(x² + x)
    let sum = x.power(6).div(x.add(number(1, 1))).add(number(1, 1).div(x));
    assert_eq!((sum.without_factors().plain, sum.angle), (plain(4.0, 2.0), plain(0.0, 0.0)));
    assert_eq!(sum.power(-4).without_factors().plain, plain(4.0, 8.0));
    // x/(x + 1) + x²/(x + 1)² = (x (x + 1) + x²)/(x + 1)², and that times (x + 1).
    let below = x.add(number(1, 1));
    let sum = x.div(below).add(x.div(below).power(4));
    assert_eq!(sum.without_factors().plain, plain(2.0, 2.0));
    let pivots = number(1, 1).div(x.sub(x.mul(x).div(below)));
    assert_eq!(pivots.mul(x.div(below)).without_factors().plain, plain(1.0, 2.0));
    assert_eq!(x.mul(number(0, 1)).add(number(3, 1)).plain, plain(0.0, 0.0));
    assert_eq!(x.mul(x).sub(x).power(1).plain, plain(2.0, 0.0));
}

#[test]
fn multiples_of_angles_by_hand() {
    let (x, y) = (Degree::symbol(1), Degree::symbol(2));
    // sin(3 x − y/4): 2 (3 + 1/4), by quarters.
    let sine = x.mul(number(3, 1)).sub(y.div(number(4, 1))).call(Function::Sin);
    assert_eq!((sine.angle, sine.denominators), (plain(6.5, 0.0), 4.0));
    assert_eq!(sine.total(), 26.0);
    // cos(x/6) sin(x/4): by twelfths, of which there are 2 (2 + 3).
    let product = x.div(number(6, 1)).call(Function::Cos).mul(x.div(number(4, 1)).call(Function::Sin));
    assert!((product.total() - 10.0).abs() < 1e-12, "{product:?}");
    // A product of symbols is a term, a root is one too: 2.
    assert_eq!(x.mul(y).call(Function::Cos).total(), 2.0);
    assert_eq!(x.add(y).power(1).mul(number(1, 7)).call(Function::Cos).total(), 2.0);
}

#[test]
fn many_denominators_have_an_end() {
    assert_eq!((1..=10).map(f64::from).fold(1.0, common_multiple), 2520.0);
    assert_eq!((1..2000).map(f64::from).fold(1.0, common_multiple), f64::INFINITY);
    assert_eq!(common_multiple(f64::NAN, 2.0), f64::INFINITY);
    let x = Degree::symbol(1);
    let sum = |of: fn(Degree) -> Degree| (1..2000).map(|i| of(x.div(number(i, 1)))).fold(number(1, 1), Degree::add);
    assert_eq!(sum(|part| part.call(Function::Sin)).chance(0), f64::INFINITY);
    // Without a point of a circle nothing is divided.
    assert_eq!(sum(|part| part).chance(0), 1.0 / Prime::<2>::P as f64);
    assert_eq!(sum(|part| part).call(Function::Sin).chance(0), f64::INFINITY);
}

#[test]
fn powers_of_powers_are_of_any_degree() {
    let large = (0..6).fold(Degree::symbol(1).power(-200), |power, _| power.power(200));
    assert_eq!(large.total(), 1e14);
}

#[test]
fn of_what_is_nan_no_bound_is_known() {
    assert_eq!((larger(1.0, 2.0), larger(f64::NAN, 1.0), larger(1.0, f64::NAN)), (2.0, f64::INFINITY, f64::INFINITY));
    let (all, none) = (Quotient::polynomial(f64::INFINITY), Quotient::polynomial(-f64::INFINITY));
    assert_eq!(all.plus(Quotient { denominator: f64::INFINITY, ..none }).numerator, f64::INFINITY);
}

/// `[2, x; x, y] (a, b) = (1, z)`: rows of degree one each.
#[test]
fn linear_solves_by_hand() {
    let x = Degree::symbol(1);
    let mut columns = vec![vec![number(1, 1), x]];
    Degree::solve_symmetric(&[number(2, 1), x, x], &mut columns);
    assert!(columns[0].iter().all(|entry| entry.plain == plain(2.0, 2.0)));
    let solved = Degree::constrained(1, vec![x.mul(x)], vec![x], &[0])(&[x, x]);
    assert!(solved.iter().all(|entry| entry.plain == plain(3.0, 3.0)));
}

#[test]
fn a_chance_is_that_of_degrees() {
    let (x, y) = (Degree::symbol(1), Degree::symbol(2));
    let (p, n) = (Prime::<2>::P as f64, Prime::<2>::N as f64);
    assert_eq!(x.mul(y).add(x).chance(0), 2.0 / p);
    assert_eq!(x.mul(y.call(Function::Sin)).chance(0), 1.0 / p + 2.0 / n);
    // Four arguments are six pairs: at most eight, of degree two each.
    assert_eq!(x.mul(y).call(Function::Atan).chance(4), (1.0 + 8.0 * 2.0) / p);
}
