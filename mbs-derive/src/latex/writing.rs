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
    /// The products with a common dependence on the state, in the order in which they are written.
    pub(super) fn groups(&self, sum: &Polynomial) -> Vec<(GroupOrder, Group)> {
        let mut groups: BTreeMap<Powers, Vec<(Powers, Number)>> = BTreeMap::new();
        for (powers, &coefficient) in &sum.0 {
            let (given, state): (Powers, Powers) =
                powers.iter().map(|(&id, &halves)| (id, halves)).partition(|(id, _)| self.atoms[id].is_given());
            groups.entry(state).or_default().push((given, coefficient));
        }
        let mut ordered: Vec<_> = groups
            .into_iter()
            .map(|(state, parts)| self.sorted(Group { state, parts }))
            .map(|group| (self.group_order(&group), group))
            .collect();
        ordered.sort_by(|(a, _), (b, _)| a.cmp(b));
        ordered
    }

    fn sorted(&self, mut group: Group) -> Group {
        group.parts.sort_by_cached_key(|(powers, _)| self.places(powers));
        // `m (l + 1)`: what is left as a number comes last.
        let (common, _) = group.common();
        group.parts.sort_by_key(|(powers, _)| *powers == common);
        group
    }

    /// Accelerations first, then by falling degree in the velocities, products without waves before those with;
    /// parameters before what depends on the state, and that before what is given from outside.
    fn group_order(&self, group: &Group) -> GroupOrder {
        let given = group.parts.iter().flat_map(|(powers, _)| powers).filter(|(id, _)| !self.atoms[id].parametric);
        let given: Powers = given.map(|(&id, &halves)| (id, halves)).collect();
        let places = self.places(if group.state.is_empty() { &given } else { &group.state });
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
        let mut terms = Vec::new();
        let mut groups = self.groups(sum).into_iter().peekable();
        let mut written_alone: Vec<Vec<Group>> = Vec::new();
        while let Some((order, group)) = groups.next() {
            let mut same = vec![group];
            while let Some((_, next)) = groups.next_if(|(next, _)| order.shares_acceleration(next)) {
                same.push(next);
            }
            match (same.len(), order.acceleration) {
                (1, u32::MAX) => written_alone.extend([same]),
                (1, _) => terms.extend(self.group_terms(&same[0])),
                _ => terms.push(self.acceleration_term(&same)),
            }
        }
        negative_constant_last(&mut written_alone);
        if self.is_recursive {
            // Coefficients are short, and lines break between terms.
            terms.extend(written_alone.iter().flatten().flat_map(|group| self.group_terms(group)));
            return terms;
        }
        match self.linear_form(&written_alone) {
            Some(form) if terms.is_empty() => terms.push(form),
            _ => terms.extend(with_like_coefficients(written_alone).iter().flat_map(|groups| self.like_terms(groups))),
        }
        terms
    }

    /// `k (x − r)`: a sum of parameters and coordinates that has parameters in common.
    fn linear_form(&self, groups: &[Vec<Group>]) -> Option<Signed> {
        let products: Vec<(Powers, Number)> = groups.iter().flatten().flat_map(Group::products).collect();
        let (first, number) = products.first()?;
        let common = products.iter().fold(first.clone(), |common, (powers, _)| common_powers(&common, powers));
        let is_linear = |group: &Group| match group.state.iter().next() {
            None => true,
            Some((id, &halves)) => {
                group.state.len() == 1 && halves == 2 && self.atoms[id].place.kind == Kind::Coordinate
            }
        };
        let same = products.iter().all(|(_, other)| *other == *number || *other == -*number);
        if groups.len() < 2 || common.is_empty() || !same || !groups.iter().flatten().all(is_linear) {
            return None;
        }
        let (inverse, unit) = (reciprocal(&common), number.power(-2)?);
        let inside = products.iter().map(|(p, c)| self.product(&product_of_parts(p, &inverse), *c * unit, Vec::new()));
        let inside: Vec<Signed> = inside.collect();
        let place = self.bracket_place(products.iter().map(|(p, _)| product_of_parts(p, &inverse)));
        Some(self.product(&common, *number, vec![(place, sum_text(&inside))]))
    }

    /// `a x + a y = a (x + y)`
    fn like_terms(&self, groups: &[Group]) -> Vec<Signed> {
        let [first, rest @ ..] = groups else { return Vec::new() };
        if rest.is_empty() {
            return self.group_terms(first);
        }
        let mut common = first.state.clone();
        rest.iter().for_each(|group| common = common_powers(&common, &group.state));
        let inverse = reciprocal(&common);
        let inside = groups.iter().map(|group| {
            let sign = if group.has_sign_of(first) { Number::ONE } else { -Number::ONE };
            self.product(&product_of_parts(&group.state, &inverse), sign, Vec::new())
        });
        let inside: Vec<Signed> = inside.collect();
        let place = self.first_place(&product_of_parts(&first.state, &inverse));
        self.coefficient_times(first, &common, vec![(place, sum_text(&inside))])
    }

    /// One product, or several where nothing is common to them.
    fn group_terms(&self, group: &Group) -> Vec<Signed> {
        if group.state.is_empty() && group.common().0.is_empty() {
            return group.parts.iter().map(|(p, c)| self.product(p, *c, Vec::new())).collect();
        }
        self.coefficient_times(group, &group.state, Vec::new())
    }

    /// A group's parameters and numbers times powers and brackets.
    fn coefficient_times(&self, group: &Group, powers: &Powers, mut brackets: Vec<Bracket>) -> Vec<Signed> {
        if let [(parameters, number)] = group.parts.as_slice() {
            return vec![self.product(&product_of_parts(parameters, powers), *number, brackets)];
        }
        let (common, factor) = group.common();
        let (inverse, unit) = (reciprocal(&common), factor.power(-2).unwrap_or(Number::ONE));
        let parts = group.parts.iter().map(|(p, c)| (product_of_parts(p, &inverse), *c * unit));
        let inside: Vec<Signed> = parts.map(|(p, c)| self.product(&p, c, Vec::new())).collect();
        let place = self.bracket_place(group.parts.iter().map(|(p, _)| product_of_parts(p, &inverse)));
        brackets.push((place, sum_text(&inside)));
        vec![self.product(&product_of_parts(&common, powers), factor, brackets)]
    }

    /// Where the first of the summands stands, or the first that is no parameter; before the state where none depends
    /// on it.
    pub(super) fn bracket_place(&self, summands: impl Iterator<Item = Powers>) -> Option<Place> {
        let summands: Vec<Powers> = summands.collect();
        let atoms = || summands.iter().flat_map(|powers| powers.keys()).map(|id| &self.atoms[id]);
        if atoms().any(|atom| !atom.parametric) && atoms().all(|atom| atom.is_given()) {
            return Some(Place { kind: Kind::ParametricFunction, number: u32::MAX, text: String::new() });
        }
        let places: Vec<Place> =
            summands.iter().flat_map(|powers| self.places(powers)).map(|(place, _)| place).collect();
        let other = places.iter().find(|place| place.kind > Kind::ParametricFunction);
        other.or(places.first()).cloned()
    }

    fn first_place(&self, powers: &Powers) -> Option<Place> {
        self.places(powers).first().map(|(place, _)| place.clone())
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
        let term = self.product(&acceleration, Number::ONE, vec![(None, text)]);
        Signed { negative: flipped, text: term.text }
    }

    /// Number, factors and brackets in their order, what is below the line below it.
    fn product(&self, powers: &Powers, coefficient: Number, brackets: Vec<Bracket>) -> Signed {
        let negative = coefficient.is_negative();
        let magnitude = if negative { -coefficient } else { coefficient };
        let mut factors: Vec<(Option<Place>, Shape, i32)> = powers
            .iter()
            .map(|(id, &halves)| (Some(self.atoms[id].place.clone()), self.atoms[id].shape.clone(), halves))
            .collect();
        factors.extend(brackets.into_iter().map(|(place, text)| (place, Shape::Sum(text), 2)));
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

/// A sum in brackets, and where it stands in a product.
type Bracket = (Option<Place>, String);

/// `x − r`, not `−r + x`.
fn negative_constant_last(groups: &mut [Vec<Group>]) {
    let is_negative = |group: &Group| group.parts.iter().all(|(_, number)| number.is_negative());
    if groups.first().is_some_and(|first| first[0].state.is_empty() && is_negative(&first[0])) {
        groups.rotate_left(1);
    }
}

/// Groups whose coefficients are the same up to their sign are put together, where the first of them stands.
fn with_like_coefficients(alone: Vec<Vec<Group>>) -> Vec<Vec<Group>> {
    let mut together: Vec<Vec<Group>> = Vec::new();
    for mut groups in alone {
        let like = |others: &&mut Vec<Group>| groups[0].is_like(&others[0]);
        match together.iter_mut().find(like) {
            Some(others) => others.append(&mut groups),
            None => together.push(groups),
        }
    }
    together
}

/// Products with the same dependence on the state; parts are coefficients of parameters and numbers.
pub(super) struct Group {
    pub(super) state: Powers,
    parts: Vec<(Powers, Number)>,
}

impl Group {
    /// Powers that all parts have, and the number with its sign that can be taken out of them.
    fn common(&self) -> (Powers, Number) {
        let mut common = self.parts[0].0.clone();
        self.parts[1..].iter().for_each(|(powers, _)| common = common_powers(&common, powers));
        let first = self.parts[0].1;
        let same = self.parts.iter().all(|(_, number)| *number == first || *number == -first);
        let sign = if first.is_negative() { -Number::ONE } else { Number::ONE };
        (common, if same { first } else { sign })
    }
}

impl Group {
    fn products(&self) -> impl Iterator<Item = (Powers, Number)> {
        self.parts.iter().map(|(powers, number)| (product_of_parts(powers, &self.state), *number))
    }

    /// Whether the coefficients are the same up to their sign, and no plain numbers.
    fn is_like(&self, other: &Group) -> bool {
        let sign = if self.has_sign_of(other) { Number::ONE } else { -Number::ONE };
        let equal = |((p, c), (q, d)): (&(Powers, Number), &(Powers, Number))| p == q && *c == *d * sign;
        self.parts.len() == other.parts.len()
            && self.parts.iter().all(|(powers, _)| !powers.is_empty())
            && self.parts.iter().zip(&other.parts).all(equal)
    }

    fn has_sign_of(&self, other: &Group) -> bool {
        self.parts[0].1.is_negative() == other.parts[0].1.is_negative()
    }
}

/// The powers that both have; half powers are taken whole or not at all.
pub(super) fn common_powers(a: &Powers, b: &Powers) -> Powers {
    let common = |(&id, &halves): (&Id, &i32)| {
        let &other = b.get(&id).filter(|other| other.signum() == halves.signum())?;
        let least = if halves > 0 { other.min(halves) } else { other.max(halves) };
        ((other - least) % 2 == 0 && (halves - least) % 2 == 0).then_some((id, least))
    };
    a.iter().filter_map(common).collect()
}

fn reciprocal(powers: &Powers) -> Powers {
    powers.iter().map(|(&id, &halves)| (id, -halves)).collect()
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
