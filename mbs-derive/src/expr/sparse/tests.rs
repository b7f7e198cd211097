use super::*;
use crate::expr::{Dual, Rounded, evaluate::Terms};

/// Links: masses in a row, coupled with their neighbours, and a row between each two but the first.
const LINKS: usize = 60;

fn system<V: Value>(vary: impl Fn(usize, f64) -> V) -> (Elimination, Vec<V>) {
    let (n, mut places, mut entries) = (LINKS, Vec::new(), Vec::new());
    let mut put = |place: [usize; 2], value: f64| {
        entries.push(vary(places.len(), value));
        places.push(place);
    };
    for i in 0..n {
        put([i, i], 2.0 + 0.1 * (i % 7) as f64);
        if i > 0 {
            put([i, i - 1], 0.5 - 0.03 * (i % 5) as f64);
        }
    }
    for k in 0..n - 2 {
        put([n + k, k + 1], 1.0 + 0.2 * (k % 3) as f64);
        put([n + k, k + 2], -0.7);
    }
    (Elimination::of(n, 2 * n - 2, places).expect("a chain"), entries)
}

fn right_side() -> Vec<f64> {
    (0..2 * LINKS - 2).map(|i| (1.0 + 2.3 * i as f64).sin()).collect()
}

#[test]
fn it_solves_what_the_null_space_solves() {
    let (elimination, entries) = system(|_, x: f64| x);
    let (mass, jacobian) = elimination.in_full(&entries);
    let vectors: Vec<usize> = (0..LINKS - 2).collect();
    let expected = f64::constrained(LINKS, mass.clone(), jacobian.clone(), &vectors)(&right_side());
    let found = f64::eliminated(&elimination, entries.clone())(&right_side());
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
    // The work grows with the length of the chain.
    assert!(elimination.pairs()[0] < 8 * elimination.order.len(), "{:?}", elimination.pairs());
    let (again, values) = Elimination::of_values(LINKS, &mass, &jacobian, |&x| x == 0.0).unwrap();
    let same = f64::eliminated(&again, values)(&right_side());
    assert!(same.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{same:?} {expected:?}");
    assert_eq!(Factors::new(&elimination, &entries).unwrap().dependent_rows(&elimination), 0);
    assert!(is_regular(LINKS, &mass, &jacobian));
}

#[test]
fn a_solution_is_differentiated_and_bounded() {
    let change = |number: usize| if number % 9 == 4 { 0.3 } else { 0.0 };
    let at = |step: f64| {
        let (elimination, entries) = system(|number, x| x + step * change(number));
        f64::eliminated(&elimination, entries)(&right_side())
    };
    let (elimination, entries) = system(|number, x| Dual::new(x, change(number)));
    let found = Dual::eliminated(&elimination, entries)(&right_side().into_iter().map(Dual::fixed).collect::<Vec<_>>());
    for ((found, after), before) in found.iter().zip(at(1e-6)).zip(at(-1e-6)) {
        assert!((found.derivative - (after - before) / 2e-6).abs() < 1e-8, "{found:?}");
    }
    // An entry that is not known better than 1e-8 lets the solution move by no more than its bound.
    let (elimination, entries) = system(|number, value| Rounded { value, error: 1e-8 * change(number) });
    let column: Vec<Rounded> = right_side().into_iter().map(Rounded::exact).collect();
    let bounded = Rounded::eliminated(&elimination, entries.clone())(&column);
    let (mass, jacobian) = elimination.in_full(&entries);
    let vectors: Vec<usize> = (0..LINKS - 2).collect();
    let none = Terms { sizes: Vec::new(), motion: Vec::new(), scales: Vec::new() };
    let in_full = Rounded::constrained_columns(LINKS, mass, jacobian, &vectors)(&[column], &none).remove(0);
    for ((bounded, in_full), moved) in bounded.iter().zip(in_full).zip(at(1e-8)) {
        let off = (bounded.value - moved).abs();
        // No more than by the inverse in full.
        assert!(off <= bounded.error && bounded.error <= 1.01 * in_full.error, "{bounded:?} {moved} {in_full:?}");
        assert!((bounded.value - in_full.value).abs() < 1e-12, "{bounded:?} {in_full:?}");
    }
    assert!(at(1e-8).iter().zip(at(0.0)).any(|(a, b)| (a - b).abs() > 1e-10));
}

#[test]
fn what_has_no_solution_is_nan() {
    let first_of_rows = 2 * LINKS - 1;
    let solves = |vary: &dyn Fn(usize, f64) -> f64, target: f64| {
        let (elimination, entries) = system(vary);
        let mut b = right_side();
        b[LINKS + 4] = target;
        let dependent = Factors::new(&elimination, &entries).map(|factors| factors.dependent_rows(&elimination));
        (f64::eliminated(&elimination, entries)(&b), dependent)
    };
    // A row of zeros may ask for nothing but zero.
    let without: &dyn Fn(usize, f64) -> f64 =
        &|number, x| if [8, 9].contains(&number.wrapping_sub(first_of_rows)) { 0.0 } else { x };
    let (found, dependent) = solves(without, 0.0);
    assert!(found.iter().all(|x| x.is_finite()) && dependent == Some(1), "{dependent:?}");
    assert!(solves(without, 1.0).0.iter().all(|x| x.is_nan()));
    // A coordinate without inertia, an infinite entry.
    let cases: [&dyn Fn(usize, f64) -> f64; 2] =
        [&|number, x| if number < 2 { 0.0 } else { x }, &|number, x| if number == 7 { f64::INFINITY } else { x }];
    for (number, case) in cases.into_iter().enumerate() {
        assert!(solves(case, 0.0).0.iter().all(|x| x.is_nan()), "case {number}");
    }
    // A full matrix, and a coordinate that stands nowhere.
    let full = (0..70).flat_map(|i| (0..=i).map(move |j| [i, j])).collect();
    assert!(Elimination::of(70, 70, full).is_none());
    assert!(Elimination::of(2, 2, vec![[0, 0]]).is_none());
}

/// The third row follows from the other two, which are nearly parallel: their pivots make rounding large.
#[test]
fn what_rounding_leaves_of_a_row_is_no_row() {
    let n = 120;
    let mut jacobian = vec![0.0; 3 * n];
    for (row, factor) in [1.0, 1.0 + 1e-4, 3.0].into_iter().enumerate() {
        (jacobian[row * n], jacobian[row * n + 1], jacobian[row * n + 2]) = (1.0, factor, 1.0);
    }
    let unit: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| f64::from(u8::from(i == j)))).collect();
    assert!(!is_regular(n, &unit, &jacobian));
    assert!(is_regular(n, &unit, &jacobian[..n]));
}

/// Twice the same row, and one of zeros.
#[test]
fn rows_that_depend_on_others_change_what_they_may() {
    let n = 120;
    let mut jacobian = vec![0.0; 3 * n];
    (jacobian[3], jacobian[4], jacobian[n + 3], jacobian[n + 4]) = (1.0, 2.0, 2.0, 4.0);
    let weights: Vec<f64> = (0..n).map(|i| if i == 3 { 4.0 } else { 1.0 }).collect();
    let x = least_change(&weights, &jacobian, &[3.0, 6.0, 0.0], None).unwrap();
    // x = W⁻¹ aᵀ (a W⁻¹ aᵀ)⁻¹ c with a W⁻¹ aᵀ = 1/4 + 4.
    for (i, x) in x.iter().enumerate() {
        let expected = [0.75, 6.0].get(i.wrapping_sub(3)).map_or(0.0, |x| x / 4.25);
        assert!((x - expected).abs() < 1e-12, "{i}: {x} {expected}");
    }
    // As near to 3 as to 5/2: rows are off in proportion to what they move, the second one by four times as much.
    let apart = least_change(&weights, &jacobian, &[3.0, 5.0, 1.0], None).unwrap();
    assert!(
        apart.iter().all(|x| x.is_finite()) && (apart[3] + 2.0 * apart[4] - 2.75).abs() < 1e-2,
        "{:?}",
        &apart[3..5]
    );
}
