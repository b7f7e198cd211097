use super::*;

type Residue = super::Residue<0>;

fn number(numerator: i128, denominator: i128) -> Residue {
    Residue::number(Number::rational(numerator, denominator).unwrap())
}

/// Points with no relation, at which no square root is missing.
fn points() -> impl Iterator<Item = [Residue; 3]> {
    let squared = |key| Residue::random(key).power(4);
    (1..20).map(move |key| [squared(key), squared(key + 100), squared(key + 200)])
}

fn equal(a: Residue, b: Residue) {
    assert!(a.is_defined() && a.value == b.value, "{a:?}, {b:?}");
}

#[test]
fn arithmetic_is_that_of_a_field() {
    for [x, y, z] in points() {
        equal(x.add(y).mul(z), x.mul(z).add(y.mul(z)));
        equal(x.mul(y).div(y), x);
        equal(x.sub(x), number(0, 1));
        equal(x.power(6).mul(x.power(-4)), x);
        equal(x.add(number(1, 3)).sub(number(1, 3)), x);
    }
    assert_eq!(Prime::<0>::times(Residue::P - 1, Residue::P - 1), 1);
    assert_eq!(Prime::<0>::times(7, Prime::<0>::inverted(7)), 1);
    assert_eq!(product(7, inverse(7, Residue::H), Residue::H), 1);
    assert!(!number(1, 1).div(number(0, 1)).is_defined());
}

#[test]
fn angles_add() {
    let [sin, cos] = [Function::Sin, Function::Cos].map(|f| move |x: Residue| x.call(f));
    for [x, y, z] in points() {
        equal(sin(x).mul(sin(x)).add(cos(x).mul(cos(x))), number(1, 1));
        equal(sin(x.add(y)), sin(x).mul(cos(y)).add(cos(x).mul(sin(y))));
        equal(cos(x.mul(y.add(z))), cos(x.mul(z)).mul(cos(x.mul(y))).sub(sin(x.mul(z)).mul(sin(x.mul(y)))));
        equal(cos(x.div(number(2, 1))).power(4).mul(number(2, 1)), cos(x).add(number(1, 1)));
        equal(sin(x.neg()), sin(x).neg());
        assert_ne!(sin(x).value, sin(y).value);
        assert_ne!(sin(x.mul(y)).value, sin(x.mul(z)).value);
    }
}

#[test]
fn parts_of_a_turn_have_the_sines_that_they_have() {
    let degrees = |count: i128| Residue::number(Number::PI * Number::rational(count, 180).unwrap());
    let check = |count, sine: Residue| equal(degrees(count).call(Function::Sin), sine);
    check(30, number(1, 2));
    check(-90, number(-1, 1));
    check(180, number(0, 1));
    check(45, number(2, 1).power(1).div(number(2, 1)));
    check(240, number(3, 1).power(1).div(number(-2, 1)));
    check(54, number(1, 1).add(number(5, 1).power(1)).div(number(4, 1)));
    for [x, ..] in points() {
        equal(x.add(degrees(90)).call(Function::Sin), x.call(Function::Cos));
        let half = x.add(degrees(60)).div(number(2, 1));
        equal(half.sub(degrees(30)).call(Function::Cos), x.div(number(2, 1)).call(Function::Cos));
        // Multiplied with anything but a rational number, π is as any other.
        let scaled = |y: Residue| x.mul(y).call(Function::Cos);
        equal(scaled(degrees(90)).power(4).mul(number(2, 1)).sub(number(1, 1)), scaled(degrees(180)));
    }
}

#[test]
fn roots_are_multiplicative_and_of_either_sign() {
    let mut signs = [0, 0];
    for [x, y, _] in points() {
        equal(x.power(1).mul(y.power(1)), x.mul(y).power(1));
        equal(x.power(1).power(4), x);
        let plain = Residue::random(x.value);
        let size = plain.call(Function::Abs);
        equal(size.mul(size), plain.mul(plain));
        equal(plain.call(Function::Signum).mul(size), plain);
        signs[usize::from(size == Residue { rational: None, ..plain } || size.value == plain.value)] += 1;
    }
    assert!(signs[0] > 0 && signs[1] > 0);
    assert_eq!(number(49, 4).power(1), number(7, 2));
    assert!((0..20).any(|key| !Residue::random(key).power(1).is_defined()));
}

#[test]
fn other_functions_are_equal_where_their_arguments_are() {
    for [x, y, _] in points() {
        for function in [Function::Asin, Function::Atan, Function::Sinh, Function::Tanh] {
            equal(x.neg().call(function), x.call(function).neg());
            equal(x.add(y).call(function), y.add(x).call(function));
            assert_ne!(x.call(function).value, y.call(function).value);
        }
        equal(x.call(Function::Cosh).power(4), x.call(Function::Sinh).power(4).add(number(1, 1)));
        equal(x.call2(Binary::Powf, number(3, 1)), x.power(6));
        assert_ne!(x.less(y), y.less(x));
        assert!(x.less_equal(x) && !x.less(x));
    }
    assert!(number(1, 3).less(number(1, 2)) && number(-1, 2).less(number(0, 1)));
    assert!(number(0, 1).call(Function::Atan).is_zero() && number(1, 1).call(Function::Ln).is_zero());
}

#[test]
fn an_angle_of_a_point_on_the_axis_is_no_zero() {
    let atan2 = |y: Residue, x: Residue| y.call2(Binary::Atan2, x);
    let zero = number(0, 1);
    for [x, y, _] in points() {
        equal(atan2(y.neg(), x), atan2(y, x).neg());
        assert!(atan2(y.sub(y), x).is_defined() && !atan2(y.sub(y), x).is_zero());
        assert_ne!(atan2(zero, x).value, atan2(zero, x.neg()).value);
    }
    equal(atan2(zero, number(1, 3)), zero);
    equal(atan2(zero, number(-1, 3)), Residue::pi());
}

#[test]
fn tables_are_functions_without_a_law() {
    let table = Spline::new(vec![0.0], vec![vec![0.0, 2.0, 3.0], vec![0.0, 2.0, 6.0]]);
    for [x, y, _] in points() {
        equal(x.add(y).spline(&table, 0), y.add(x).spline(&table, 0));
        assert_ne!(x.neg().spline(&table, 0).value, x.spline(&table, 0).neg().value);
        assert!(!x.sub(x).spline(&table, 0).is_zero() && !x.sub(x).spline(&table, 1).is_zero());
        assert!(x.spline(&table, 2).is_zero());
    }
}

#[test]
fn exponents_add() {
    let exp = |x: Residue| x.call(Function::Exp);
    for [x, y, z] in points() {
        equal(exp(x.add(y)), exp(x).mul(exp(y)));
        equal(exp(x.sub(y.mul(z))).mul(exp(y.mul(z))), exp(x));
        equal(exp(x.mul(number(3, 2))).power(4), exp(x).power(6));
        equal(exp(x).power(1), exp(x.div(number(2, 1))));
        equal(x.add(y).call(Function::Sinh).power(4), x.add(y).call(Function::Cosh).power(4).sub(number(1, 1)));
        // With roots and functions in it, an exponent is its value.
        let unit = x.call(Function::Sin).power(4).add(x.call(Function::Cos).power(4));
        equal(exp(unit.mul(y.power(1))), exp(y.power(1)));
        equal(exp(y.power(1).neg()).mul(exp(y.power(1))), number(1, 1));
        assert_ne!(exp(x).value, exp(y).value);
    }
    equal(exp(number(0, 1)), number(1, 1));
}

/// A number that a field takes for zero, and is not, has no value in it.
#[test]
fn multiples_of_the_moduli_have_no_value() {
    let both = |n: i128| {
        let number = Number::rational(n, 1).unwrap();
        [super::Residue::<0>::number(number).is_defined(), super::Residue::<1>::number(number).is_defined()]
    };
    for of in [Residue::P, Residue::N, Residue::H] {
        assert_eq!(both(i128::from(of)), [false, true]);
        assert_eq!(both(-3 * i128::from(of)), [false, true]);
    }
    assert_eq!(both((1 << 61) - 1), [true, true]);
    let [p, q] = [Prime::<0>::P, Prime::<1>::P].map(i128::from);
    assert_eq!(both(p * q), [false, false]);
    let sum = number(p - 5, 1).add(number(5, 1));
    assert!(!sum.is_defined() && !number(p, 1).mul(Residue::random(1)).is_defined());
}
