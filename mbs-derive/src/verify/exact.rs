//! Claims decided in prime fields, without rounding and without a tolerance; see `docs/proof.md`.
//!
//! The claims are those that are made of doubles, word by word, of images of random points in three fields. What is
//! claimed holds as an identity of functions, but for a chance that their degrees bound.

use std::collections::BTreeSet;

use crate::catalogue::Claim;
use crate::expr::{Degree, Dual, FIELDS, Image};
use crate::interpret::State;
use crate::optimise::Derivation;
use crate::variable::count;

use super::Failure;
use super::claim::{Difference, Trial};
use super::nodes::{Nodes, Shown};
use super::tested::Tested;
use super::witness::{Witness, moving};

/// Of an identity whose bound at one point is larger, doubles say more.
const LARGEST_CHANCE: f64 = 1.0 / (1 << 20) as f64;

/// In this many fields at least an identity holds: a number may be a multiple of one of the primes.
const AGREEING: usize = 2;

/// How much is proved exactly.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Evidence {
    /// How many identities hold in prime fields: equations between numbers.
    pub identities: usize,
    /// The probability that one of them holds by chance is below ten to the minus this power; 0 where there are none.
    pub digits: u32,
    /// The greatest degree of an identity.
    pub degree: u64,
    /// At how many points, each in a field of its own.
    pub points: usize,
    /// The sizes of these fields.
    pub moduli: Vec<u64>,
    /// What is proved in doubles alone.
    pub in_doubles: Vec<InDoubles>,
}

/// Identities that are proved in doubles alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InDoubles {
    /// What is claimed.
    pub claim: &'static str,
    /// How many identities.
    pub identities: usize,
    /// Why they are not decided in prime fields.
    pub reason: String,
}

/// What fields say of a mechanism.
pub(super) struct Verdict {
    evidence: Evidence,
    chance: f64,
    /// The claims of which every identity is proved.
    pub known: BTreeSet<Claim>,
    /// The first identity that does not hold in any field, though nothing is in it that fields do not know.
    refused: Option<(&'static str, usize)>,
    /// The identities that may hold on each side of every choice.
    piecewise: Vec<Piecewise>,
    /// Of how many roots claims are made.
    roots: usize,
}

/// An identity that does not hold whatever conditions are.
struct Piecewise {
    number: usize,
    text: &'static str,
    component: usize,
    degree: u64,
    /// How likely it is that it holds by chance at one point.
    bound: f64,
}

/// Decides every claim of a mechanism.
pub(super) fn decide(witness: &Witness<'_, '_>, derivation: &Derivation) -> Verdict {
    let nodes = Nodes::of(witness, derivation);
    let degrees = differences(witness, derivation, &point(witness, Degree::symbol));
    let decidable = nodes.obstacle(witness, |number| nth_point(witness, number));
    let roots = decidable.unwrap_or(0);
    let fields = match decidable {
        Ok(_) => Field::all(witness, derivation, roots, None),
        Err(_) => Default::default(),
    };
    let shown = |of: fn(&Shown) -> bool| fields.iter().any(|field| of(&field.shown));
    let obstacle = decidable.err().or(shown(|shown| shown.has_other_roots).then_some("roots of another form"));
    // Of roots the norm counts, and that points without roots are drawn again.
    let factor = libm::exp2(2.0 * roots as f64);

    let mut evidence = Evidence { moduli: Image::<0>::moduli().to_vec(), points: FIELDS, ..Evidence::default() };
    let (mut chance, mut open, mut refused, mut piecewise) = (0.0, BTreeSet::new(), None, Vec::new());
    for (number, identity) in degrees.iter().enumerate() {
        let count = |outcome| fields.iter().filter(|field| field.outcomes.get(number) == Some(&outcome)).count();
        let (equal, differing) = (count(Outcome::Holds), count(Outcome::Fails));
        let bound = factor * identity.left.chance(nodes.arguments);
        let is_small = bound <= LARGEST_CHANCE;
        let reason = match obstacle {
            Some(obstacle) => obstacle.to_string(),
            None if equal >= AGREEING && is_small => {
                chance += FIELDS as f64 * libm::pow(bound, equal as f64);
                evidence.identities += 1;
                evidence.degree = evidence.degree.max(identity.left.total() as u64);
                continue;
            }
            None if count(Outcome::NotMade) > 0 || !identity.is_made => "where constraints hold alone".to_string(),
            None if differing > 0 && !nodes.opaque.is_empty() => nodes.opaque.join(", "),
            None if differing > 0 && nodes.has_choices => {
                let (text, component, degree) = (identity.text, identity.component, identity.left.total() as u64);
                piecewise.push(Piecewise { number, text, component, degree, bound });
                open.extend(identity.claim);
                continue;
            }
            None if differing > 0 && shown(|shown| shown.has_other_angles) => "functions of sums in angles".to_string(),
            None if differing >= AGREEING => {
                refused = refused.or(Some((identity.text, identity.component)));
                "refused".to_string()
            }
            None if nodes.has_rounded_constants => "rounded constants".to_string(),
            None if !is_small => "of a high degree".to_string(),
            None => "not defined everywhere".to_string(),
        };
        open.extend(identity.claim);
        note(&mut evidence.in_doubles, identity.text, reason);
    }
    let claims = degrees.iter().filter_map(|identity| identity.claim).collect::<BTreeSet<_>>();
    Verdict { evidence, chance, known: claims.difference(&open).copied().collect(), refused, piecewise, roots }
}

impl Verdict {
    /// What is proved once every side of the choices is known by a state that is on it; or what is refused.
    pub(super) fn settled(
        mut self,
        witness: &Witness<'_, '_>,
        derivation: &Derivation,
        states: &[(State, Vec<f64>)],
    ) -> Result<Evidence, Failure> {
        let sides: Vec<[Field; FIELDS]> = match self.piecewise.is_empty() {
            true => Vec::new(),
            false => states.iter().map(|state| Field::all(witness, derivation, self.roots, Some(state))).collect(),
        };
        for Piecewise { number, text, component, degree, bound } in &self.piecewise {
            let count = |fields: &[Field; FIELDS], outcome| {
                fields.iter().filter(|field| field.outcomes.get(*number) == Some(&outcome)).count()
            };
            let is_known = |fields: &[Field; FIELDS]| fields.iter().any(|field| field.shown.is_unusual());
            let fails = |fields| count(fields, Outcome::Fails) >= AGREEING && !is_known(fields);
            let is_small = *bound <= LARGEST_CHANCE;
            if !sides.is_empty() && is_small && sides.iter().all(|side| count(side, Outcome::Holds) >= AGREEING) {
                let each = |side| FIELDS as f64 * libm::pow(*bound, count(side, Outcome::Holds) as f64);
                self.chance += sides.iter().map(each).sum::<f64>();
                self.evidence.identities += 1;
                self.evidence.degree = self.evidence.degree.max(*degree);
            } else {
                if sides.iter().any(fails) {
                    self.refused = self.refused.or(Some((text, *component)));
                }
                note(&mut self.evidence.in_doubles, text, "conditions".to_string());
            }
        }
        if let Some((claim, component)) = self.refused {
            return Err(Failure::Inexact { claim, component });
        }
        let is_any = self.evidence.identities > 0;
        self.evidence.digits = if is_any { (-self.chance.log10()).clamp(0.0, 300.0) as u32 } else { 0 };
        Ok(self.evidence)
    }
}

/// Counts one more identity.
fn note(in_doubles: &mut Vec<InDoubles>, claim: &'static str, reason: String) {
    match in_doubles.iter_mut().find(|known| known.claim == claim && known.reason == reason) {
        Some(known) => known.identities += 1,
        None => in_doubles.push(InDoubles { claim, identities: 1, reason }),
    }
}

/// How an identity comes out at a point of a field.
#[derive(Clone, Copy, PartialEq)]
enum Outcome {
    Holds,
    Fails,
    NotDefined,
    NotMade,
}

/// What one field says.
#[derive(Default)]
struct Field {
    /// Of each identity; of none where no point was found.
    outcomes: Vec<Outcome>,
    shown: Shown,
}

impl Field {
    /// What each field says.
    fn all(
        witness: &Witness<'_, '_>,
        derivation: &Derivation,
        roots: usize,
        beside: Option<&(State, Vec<f64>)>,
    ) -> [Field; FIELDS] {
        [
            Field::of::<0>(witness, derivation, roots, beside),
            Field::of::<1>(witness, derivation, roots, beside),
            Field::of::<2>(witness, derivation, roots, beside),
        ]
    }

    /// At the first point at which everything declared has a value, with this many roots; conditions come out as at the
    /// state `beside`.
    fn of<const K: usize>(
        witness: &Witness<'_, '_>,
        derivation: &Derivation,
        roots: usize,
        beside: Option<&(State, Vec<f64>)>,
    ) -> Field {
        let tried = if roots == 0 { 1 } else { 32 << roots };
        let points = (0..tried).map(|number| nth_point_beside(witness, number, beside));
        let Some(point) = points.into_iter().find(|point| is_defined(witness, point)) else { return Field::default() };
        let outcome = |identity: &Difference<Image<K>>| match identity.left {
            _ if !identity.is_made => Outcome::NotMade,
            left if !left.is_defined() => Outcome::NotDefined,
            left if left.is_zero() => Outcome::Holds,
            _ => Outcome::Fails,
        };
        let outcomes: Vec<Outcome> = differences(witness, derivation, &point).iter().map(outcome).collect();
        let multipliers: Vec<_> = (0..derivation.constraints.len()).map(|k| Image::multiplier(point.0.t, k)).collect();
        let asks = roots > 0 || outcomes.contains(&Outcome::Fails);
        let shown = if asks { Shown::at(witness, derivation, &point, &multipliers) } else { Shown::default() };
        Field { outcomes, shown }
    }
}

/// A point of a sequence of them.
fn nth_point<const K: usize>(witness: &Witness<'_, '_>, number: u64) -> Point<Image<K>> {
    point(witness, |symbol| Image::random(0x7072_6f6f_0000_0000 + (number << 16) + symbol))
}

/// A point of a sequence of them whose numbers have those of a state with them.
fn nth_point_beside<const K: usize>(
    witness: &Witness<'_, '_>,
    number: u64,
    beside: Option<&(State, Vec<f64>)>,
) -> Point<Image<K>> {
    let point = nth_point(witness, number);
    let Some((state, parameters)) = beside else { return point };
    let each = |images: &[Image<K>], doubles: &[f64]| {
        images.iter().zip(doubles).map(|(image, &double)| image.beside(double)).collect::<Vec<_>>()
    };
    let (images, of_parameters) = point;
    let signals = images.prescribed.iter().zip(&state.prescribed);
    let state = State {
        t: images.t.beside(state.t),
        q: each(&images.q, &state.q),
        qd: each(&images.qd, &state.qd),
        qdd: each(&images.qdd, &state.qdd),
        u: each(&images.u, &state.u),
        prescribed: signals.map(|(images, doubles)| [0, 1, 2].map(|k| images[k].beside(doubles[k]))).collect(),
    };
    (state, each(&of_parameters, parameters))
}

/// Whether everything declared has a value.
fn is_defined<const K: usize>(witness: &Witness<'_, '_>, (state, parameters): &Point<Image<K>>) -> bool {
    let has_value = |number: Dual<Image<K>>| number.value.is_defined();
    witness.tapes().iter().all(|tape| tape.run(moving(state, parameters)).into_iter().all(has_value))
}

/// A state, and parameters.
pub(super) type Point<V> = (State<V>, Vec<V>);

/// A point whose numbers come from a sequence.
fn point<V: Tested>(witness: &Witness<'_, '_>, number: impl Fn(u64) -> V) -> Point<V> {
    let lagrangian = witness.lagrangian;
    let mut next = 0;
    let mut number = || {
        next += 1;
        number(next)
    };
    let n = lagrangian.dof();
    let t = number();
    let mut several = |count: usize| (0..count).map(|_| number()).collect::<Vec<V>>();
    let [q, qd, qdd] = [(); 3].map(|()| several(n));
    let (u, parameters) = (several(count(&lagrangian.inputs)), several(count(&lagrangian.parameters)));
    let signals = several(3 * count(&lagrangian.prescribed));
    let prescribed = signals.chunks(3).map(|signal| [signal[0], signal[1], signal[2]]).collect();
    (State { t, q, qd, qdd, u, prescribed }, parameters)
}

/// What is left of every claim at a point, in order.
fn differences<V: Tested>(
    witness: &Witness<'_, '_>,
    derivation: &Derivation,
    (state, parameters): &Point<V>,
) -> Vec<Difference<V>> {
    let trial = Trial::new(witness, derivation, state, parameters);
    trial.prove(&BTreeSet::new()).expect("differences are taken down, not judged");
    trial.differences.take()
}

#[cfg(test)]
mod mutation;
