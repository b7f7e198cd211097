use super::*;

type Image = super::Image<0>;

fn number(numerator: i128, denominator: i128) -> Image {
    Image::number(Number::rational(numerator, denominator).unwrap())
}

/// Points with no relation, at which no square root is missing.
fn points() -> impl Iterator<Item = [Image; 3]> {
    let squared = |key| Image::of_constant(Image::random(key).power(4).value, f64::NAN);
    (1..20).map(move |key| [squared(key), squared(key + 100), squared(key + 200)])
}

#[track_caller]
fn equal(a: Image, b: Image) {
    assert!(a.is_defined() && a.value == b.value, "{a:?}, {b:?}");
}

#[track_caller]
fn differ(a: Image, b: Image) {
    assert!(a.is_defined() && b.is_defined() && a.value != b.value, "{a:?}, {b:?}");
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
    assert!(!number(1, 1).div(number(0, 1)).is_defined());
    equal(Image::dyadic(0.375), number(3, 8));
    equal(Image::constant(0.1), number(1, 10));
    assert_eq!(number(6, 4).add(number(1, 2)).form, Form::Rational(Ratio::TWO));
}

#[test]
fn angles_add() {
    let [sin, cos] = [Function::Sin, Function::Cos].map(|f| move |x: Image| x.call(f));
    for [x, y, z] in points() {
        equal(sin(x).mul(sin(x)).add(cos(x).mul(cos(x))), number(1, 1));
        let addition = |a: Image, b: Image| {
            equal(sin(a.add(b)), sin(a).mul(cos(b)).add(cos(a).mul(sin(b))));
            equal(cos(a.sub(b)), cos(a).mul(cos(b)).add(sin(a).mul(sin(b))));
        };
        addition(x, y);
        addition(x, x);
        addition(x.add(y), z);
        // Products and quotients of symbols are terms, in any order of their factors.
        addition(x, y.mul(z));
        addition(x.mul(y), z.div(y));
        addition(number(1, 3).mul(x).mul(y), x.mul(y.mul(number(2, 3))));
        equal(sin(x.mul(y)), sin(y.mul(x)));
        equal(sin(number(2, 1).mul(x.mul(y))), sin(x.mul(y)).mul(cos(x.mul(y))).mul(number(2, 1)));
        // A radian is a term.
        addition(x, number(3, 10));
        equal(cos(x.div(number(2, 1))).power(4).mul(number(2, 1)), cos(x).add(number(1, 1)));
        equal(sin(x.neg()), sin(x).neg());
        equal(sin(x.add(y).sub(x)), sin(y));
        // Of what is no term it is the value that counts.
        let root = x.add(y).power(4).power(1);
        equal(sin(root.mul(z)), sin(z.mul(root)));
        equal(sin(root.neg()), sin(root).neg());
        differ(sin(x), sin(y));
        differ(sin(x.mul(y)), sin(x.mul(z)));
    }
}

/// `g^a`, `g^b` and `g^(a b)` are no random points of a torus; here they have no relation.
#[test]
fn a_product_of_angles_is_another_angle() {
    for [x, y, _] in points() {
        let [a, b, c] = [x, y, x.mul(y)].map(|angle| angle.exponents().0);
        assert_ne!(product(a, b, Image::N), c);
    }
}

#[test]
fn parts_of_a_turn_have_the_sines_that_they_have() {
    let degrees = |count: i128| Image::number(Number::PI * Number::rational(count, 180).unwrap());
    let check = |count, sine: Image| equal(degrees(count).call(Function::Sin), sine);
    check(30, number(1, 2));
    check(-90, number(-1, 1));
    check(180, number(0, 1));
    check(45, number(2, 1).power(1).div(number(2, 1)));
    check(240, number(3, 1).power(1).div(number(-2, 1)));
    check(54, number(1, 1).add(number(5, 1).power(1)).div(number(4, 1)));
    for [x, y, _] in points() {
        equal(x.add(degrees(90)).call(Function::Sin), x.call(Function::Cos));
        let half = x.add(degrees(60)).div(number(2, 1));
        equal(half.sub(degrees(30)).call(Function::Cos), x.div(number(2, 1)).call(Function::Cos));
        // Multiplied with anything but a rational number, π is as any other.
        let doubled = |y: Image| x.mul(y).call(Function::Cos);
        equal(doubled(degrees(90)).power(4).mul(number(2, 1)).sub(number(1, 1)), doubled(degrees(180)));
        equal(degrees(180).div(degrees(90)), number(2, 1));
        let [a, b] = [degrees(90), degrees(90).mul(y)];
        equal(a.add(b).call(Function::Sin), b.call(Function::Cos));
    }
}

#[test]
fn roots_are_multiplicative() {
    for [x, y, _] in points() {
        equal(x.power(1).mul(y.power(1)), x.mul(y).power(1));
        equal(x.power(1).power(4), x);
    }
    assert_eq!(number(49, 4).power(1).form, number(7, 2).form);
    assert!((0..20).any(|key| !Image::random(key).power(1).is_defined()));
}

#[test]
fn exponents_add_and_other_functions_are_equal_where_their_arguments_are() {
    let exp = |x: Image| x.call(Function::Exp);
    for [x, y, z] in points() {
        equal(exp(x.add(y)), exp(x).mul(exp(y)));
        equal(exp(x.sub(y.mul(z))).mul(exp(y.mul(z))), exp(x));
        equal(exp(x.mul(number(3, 2))).power(4), exp(x).power(6));
        equal(exp(x).power(1), exp(x.div(number(2, 1))));
        equal(x.call(Function::Cosh).power(4), x.call(Function::Sinh).power(4).add(number(1, 1)));
        differ(exp(x), exp(y));
        for function in [Function::Asin, Function::Atan, Function::Sinh, Function::Tanh] {
            equal(x.neg().call(function), x.call(function).neg());
            equal(x.add(y).call(function), y.add(x).call(function));
            differ(x.call(function), y.call(function));
        }
        equal(x.call2(Binary::Powf, number(3, 1)), x.power(6));
        assert!(x.less_equal(x) && !x.less(x));
    }
    assert!(number(1, 3).less(number(1, 2)) && number(-1, 2).less(number(0, 1)));
    assert!(number(0, 1).call(Function::Atan).is_zero() && number(1, 1).call(Function::Ln).is_zero());
    equal(exp(number(0, 1)), number(1, 1));
}

#[test]
fn an_angle_of_a_point_on_the_axis_is_no_zero() {
    let atan2 = |y: Image, x: Image| y.call2(Binary::Atan2, x);
    let zero = number(0, 1);
    for [x, y, _] in points() {
        equal(atan2(y.neg(), x), atan2(y, x).neg());
        differ(atan2(y.sub(y), x), zero);
        differ(atan2(zero, x), atan2(zero, x.neg()));
    }
    equal(atan2(zero, number(1, 3)), zero);
    equal(atan2(zero, number(-1, 3)), Image::turn(Ratio::ONE));
}

#[test]
fn tables_are_functions_without_a_law() {
    let table = Spline::new(vec![0.0], vec![vec![0.0, 2.0, 3.0], vec![0.0, 2.0, 6.0]]);
    for [x, y, _] in points() {
        equal(x.add(y).spline(&table, 0), y.add(x).spline(&table, 0));
        differ(x.neg().spline(&table, 0), x.spline(&table, 0).neg());
        equal(x.sub(x).spline(&table, 0), number(2, 1));
        equal(x.sub(x).spline(&table, 1), number(6, 1));
        equal(x.spline(&table, 2), number(0, 1));
    }
    equal(number(-1, 2).spline(&table, 0), number(1, 2));
}

#[test]
fn conditions_are_numbers() {
    let (zero, one) = (number(0, 1), number(1, 1));
    let less = |a: Image, b: Image| a.condition(b, false);
    for [x, y, z] in points() {
        equal(less(x, y), one.sub(y.condition(x, true)));
        equal(x.condition(y, true), one.sub(less(y, x)));
        equal(less(x.add(z), y.add(z)), less(x, y));
        differ(less(x, y), x.condition(y, true));
        differ(less(x, y), less(x, z));
        let choice = less(x, y).select(y, z);
        assert!(!choice.is_equal(y) && !choice.is_equal(z));
        equal(choice, one.sub(less(x, y)).select(z, y));
        equal(less(x, y).select(z, z), z);
        equal(x.neg().call(Function::Abs), x.call(Function::Abs));
        equal(x.neg().call(Function::Signum), x.call(Function::Signum).neg());
        differ(x.call(Function::Abs), x);
    }
    assert_eq!([less(zero, one), less(one, zero), less(one, one)].map(|c| c.value), [1, 0, 0]);
    for [x, y, z] in points() {
        let (x, y) = (x.beside(-2.0), y.beside(3.0));
        equal(less(x, y).select(y, z), y);
        equal(x.add(y).mul(x).condition(zero, true).select(x, z), x);
        equal(x.call(Function::Sin).power(2).condition(zero, false).select(x, z), x);
        equal(x.call(Function::Abs).power(4), x.power(4));
        equal(x.call(Function::Signum), number(-1, 1));
    }
    equal(number(-3, 2).call(Function::Abs), number(3, 2));
    equal(number(-3, 2).call(Function::Signum), number(-1, 1));
}

#[test]
fn multiples_of_the_prime_have_no_value() {
    let p = i128::from(Image::P);
    assert!(!number(p, 1).is_defined() && !number(-3 * p, 1).is_defined());
    assert!(!number(p - 5, 1).add(number(5, 1)).is_defined() && !number(p, 1).mul(Image::random(1)).is_defined());
    assert!(super::super::Image::<1>::number(Number::rational(p, 1).unwrap()).is_defined());
}

/// M is singular; with the row of A it is not, and with that row twice neither.
#[test]
fn systems_have_the_solution_that_they_have() {
    let c = |n| number(n, 1);
    let mass = vec![c(0), c(1), c(0)];
    let check = |rows: &[[i128; 2]], right_side: &[i128]| {
        let jacobian = rows.iter().flatten().map(|&a| c(a)).collect();
        let column: Vec<Image> = right_side.iter().map(|&b| c(b)).collect();
        Image::constrained(2, mass.clone(), jacobian, &vec![0; rows.len()])(&column)
    };
    // q₂ = 5, q₁ = 7.
    assert_eq!(check(&[], &[5, 7]).iter().map(|x| x.value).collect::<Vec<_>>(), [7, 5]);
    // q₁ + q₂ = 4, q₂ − λ = 5, q₁ − λ = 7.
    assert_eq!(check(&[[1, 1]], &[5, 7, 4]).iter().map(|x| x.value).collect::<Vec<_>>(), [3, 1, Image::P - 4]);
    let twice = check(&[[1, 1], [2, 2]], &[5, 7, 4, 8]);
    assert_eq!(twice[..2].iter().map(|x| x.value).collect::<Vec<_>>(), [3, 1]);
    assert!(check(&[[1, 1], [2, 2]], &[5, 7, 4, 9]).iter().all(|x| !x.is_defined()));
}
