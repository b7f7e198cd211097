//! How products and sums are written: terms in order, those that differ in parameters alone in one bracket.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::expr::normal::combination::{Polynomial, Powers, product_of_powers};
use crate::expr::{Id, Number};

use super::algebra::Algebra;
use super::atom::{Kind, Place, Shape};
use super::layout::{Signed, juxtaposed, sum_text};
use super::number::{number, numerator_and_denominator};

impl Algebra<'_> {
    pub(super) fn groups(&self, sum: &Polynomial) -> BTreeMap<GroupOrder, Group> {
        let mut groups: BTreeMap<GroupOrder, Group> = BTreeMap::new();
        for (powers, &coefficient) in &sum.0 {
            let (parameters, state): (Powers, Powers) =
                powers.iter().map(|(&id, &halves)| (id, halves)).partition(|(id, _)| self.atoms[id].parametric);
            let group = groups.entry(self.group_order(&state)).or_insert_with(|| Group { state, parts: Vec::new() });
            group.parts.push((parameters, coefficient));
        }
        for group in groups.values_mut() {
            group.parts.sort_by_cached_key(|(powers, _)| self.places(powers));
            // `m (l + 1)`: what is left as a number comes last.
            let (common, _) = group.common();
            group.parts.sort_by_key(|(powers, _)| *powers == common);
        }
        groups
    }

    /// Accelerations first, then by falling degree in the velocities, products without waves before those with.
    fn group_order(&self, state: &Powers) -> GroupOrder {
        let places = self.places(state);
        let of_kind = |kind: Kind| places.iter().filter(move |(place, _)| place.kind == kind);
        GroupOrder {
            acceleration: of_kind(Kind::Acceleration).map(|(place, _)| place.number).next().unwrap_or(u32::MAX),
            velocities: Reverse(of_kind(Kind::Velocity).map(|(_, Reverse(halves))| halves / 2).sum()),
            waves: of_kind(Kind::Trigonometric).count(),
            places,
        }
    }

    fn places(&self, powers: &Powers) -> Vec<(Place, Reverse<i32>)> {
        let mut places: Vec<_> =
            powers.iter().map(|(id, &halves)| (self.atoms[id].place.clone(), Reverse(halves))).collect();
        places.sort();
        places
    }

    /// The terms of a sum, in the order in which they are written.
    pub(super) fn terms(&self, sum: &Polynomial) -> Vec<Signed> {
        let groups = self.groups(sum);
        let mut terms = Vec::new();
        let mut groups = groups.into_iter().peekable();
        while let Some((order, group)) = groups.next() {
            let mut same = vec![group];
            while let Some((_, next)) = groups.next_if(|(next, _)| order.shares_acceleration(next)) {
                same.push(next);
            }
            match same.as_slice() {
                [group] => terms.extend(self.group_terms(group)),
                several => terms.push(self.acceleration_term(several)),
            }
        }
        terms
    }

    /// One product, or several where nothing is common to them.
    fn group_terms(&self, group: &Group) -> Vec<Signed> {
        let (common, factor) = group.common();
        if group.parts.len() == 1 || (group.state.is_empty() && common.is_empty()) {
            return group
                .parts
                .iter()
                .map(|(p, c)| self.product(&product_of_parts(p, &group.state), *c, None))
                .collect();
        }
        let inverse: Powers = common.iter().map(|(&id, &halves)| (id, -halves)).collect();
        let unit = factor.power(-2).unwrap_or(Number::ONE);
        let inside: Vec<Signed> =
            group.parts.iter().map(|(p, c)| self.product(&product_of_parts(p, &inverse), *c * unit, None)).collect();
        let first = group.parts.first().map(|(p, _)| product_of_parts(p, &inverse));
        let place = first.and_then(|powers| self.places(&powers).first().map(|(place, _)| place.clone()));
        vec![self.product(&product_of_parts(&common, &group.state), factor, Some((place, sum_text(&inside))))]
    }

    /// `(a + b) q̈`
    fn acceleration_term(&self, groups: &[Group]) -> Signed {
        let is_acceleration = |id: &Id| self.atoms[id].place.kind == Kind::Acceleration;
        let mut acceleration = Powers::new();
        let mut factor = Polynomial::default();
        for group in groups {
            for (parameters, coefficient) in &group.parts {
                let (common, state): (Powers, Powers) =
                    group.state.iter().map(|(&id, &halves)| (id, halves)).partition(|(id, _)| is_acceleration(id));
                acceleration = common;
                factor.add(product_of_parts(parameters, &state), *coefficient);
            }
        }
        let (factor, flipped) = self.leading_positive(factor);
        let text = sum_text(&self.terms(&factor));
        let term = self.product(&acceleration, Number::ONE, Some((None, text)));
        Signed { negative: flipped, text: term.text }
    }

    /// Number, factors and a bracket in their order, what is below the line below it.
    fn product(&self, powers: &Powers, coefficient: Number, bracket: Option<(Option<Place>, String)>) -> Signed {
        let negative = coefficient.is_negative();
        let magnitude = if negative { -coefficient } else { coefficient };
        let mut factors: Vec<(Option<Place>, Shape, i32)> = powers
            .iter()
            .map(|(id, &halves)| (Some(self.atoms[id].place.clone()), self.atoms[id].shape.clone(), halves))
            .collect();
        factors.extend(bracket.map(|(place, text)| (place, Shape::Sum(text), 2)));
        factors.sort_by(|a, b| a.0.cmp(&b.0));
        let (above, below): (Vec<_>, Vec<_>) = factors.into_iter().partition(|(_, _, halves)| *halves > 0);
        let written = |factors: &[(Option<Place>, Shape, i32)]| -> Vec<String> {
            factors.iter().map(|(_, shape, halves)| shape.power(halves.abs())).collect()
        };
        let text = if below.is_empty() {
            let number = number(magnitude);
            let number = (number != "1" || above.is_empty()).then_some(number);
            juxtaposed(number, written(&above))
        } else {
            let (numerator, denominator) = numerator_and_denominator(magnitude);
            let line = |number: String, factors: &[(Option<Place>, Shape, i32)]| match factors {
                // A sum that is alone on its side of the line needs no brackets.
                [(_, Shape::Sum(text), 2 | -2)] if number == "1" => text.clone(),
                _ => {
                    let number = (number != "1" || factors.is_empty()).then_some(number);
                    juxtaposed(number, written(factors))
                }
            };
            format!("\\frac{{{}}}{{{}}}", line(numerator, &above), line(denominator, &below))
        };
        Signed { negative, text }
    }
}

/// Products with the same dependence on the state; parts are coefficients of parameters and numbers.
pub(super) struct Group {
    state: Powers,
    parts: Vec<(Powers, Number)>,
}

impl Group {
    /// Powers that all parts have, and the number with its sign that can be taken out of them.
    fn common(&self) -> (Powers, Number) {
        let mut common = self.parts[0].0.clone();
        for (powers, _) in &self.parts[1..] {
            common.retain(|id, halves| match powers.get(id) {
                Some(&other) if other.signum() == halves.signum() => {
                    // Half powers are taken out whole or not at all.
                    let least = if *halves > 0 { other.min(*halves) } else { other.max(*halves) };
                    let whole = (other - least) % 2 == 0 && (*halves - least) % 2 == 0;
                    *halves = least;
                    whole
                }
                _ => false,
            });
        }
        let first = self.parts[0].1;
        let same = self.parts.iter().all(|(_, number)| *number == first || *number == -first);
        let sign = if first.is_negative() { -Number::ONE } else { Number::ONE };
        (common, if same { first } else { sign })
    }
}

/// The order of terms in a sum.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct GroupOrder {
    acceleration: u32,
    velocities: Reverse<i32>,
    waves: usize,
    places: Vec<(Place, Reverse<i32>)>,
}

impl GroupOrder {
    fn shares_acceleration(&self, other: &GroupOrder) -> bool {
        self.acceleration != u32::MAX && self.acceleration == other.acceleration
    }
}

/// Of factors that were together in a product, or whose powers were taken from it.
fn product_of_parts(a: &Powers, b: &Powers) -> Powers {
    product_of_powers(a, b).expect("parts of a product that was formed")
}
