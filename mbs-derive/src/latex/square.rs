//! Squares of sums, `x² + 2 x y + y² = (x + y)²`, and `sin²x + cos²x = 1`.

use crate::expr::normal::combination::{Polynomial, Powers, product_of_powers};
use crate::expr::{Expr, Function, Graph, HalfInteger, Id, Node, Number};

use super::algebra::Algebra;
use super::atom::{Atom, Shape, parity};
use super::layout::sum_text;
use super::writing::common_powers;

/// Longer sums are not searched for squares.
const LONGEST: usize = 100;

/// `coefficient · outside · (first + second)²`, and the terms that it is worth.
struct Square {
    coefficient: Number,
    outside: Powers,
    first: Powers,
    second: (Powers, Number),
    terms: [Powers; 3],
}

impl<'g> Algebra<'g> {
    /// The sum with each three terms that are the square of a sum of two written as one.
    pub(super) fn with_squares(&mut self, mut sum: Polynomial) -> Polynomial {
        // Each turn leaves two terms fewer.
        while let Some(square) = find(&sum) {
            for term in &square.terms {
                sum.0.remove(term);
            }
            let mut base = Polynomial::term(square.first.clone(), Number::ONE);
            base.add(square.second.0.clone(), square.second.1);
            let expr = self.expression(&square.first)
                + self.graph.constant(square.second.1) * self.expression(&square.second.0);
            let (base, flipped) = self.leading_positive(base);
            let expr = if flipped { -expr } else { expr };
            // As of a power of a sum: the base itself may be the number of another atom.
            let id = expr.sqrt().id();
            let atom = self.square_atom(&base);
            self.atoms.insert(id, atom);
            let Some(term) = product_of_powers(&square.outside, &[(id, 4)].into()) else { return sum };
            sum.add(term, square.coefficient);
        }
        sum
    }

    /// It stands where the first of its summands would.
    fn square_atom(&self, base: &Polynomial) -> Atom {
        let parts = base.0.keys().flat_map(|powers| powers.keys()).map(|id| &self.atoms[id]);
        let parametric = parts.clone().all(|atom| atom.parametric);
        let first_coordinate = parts.map(|atom| atom.first_coordinate).min().unwrap_or(u32::MAX);
        let place = self.bracket_place(base.0.keys().cloned()).expect("a sum of two different products has a factor");
        Atom { place, parametric, first_coordinate, shape: Shape::Sum(sum_text(&self.terms(base))) }
    }

    /// What is written as a product of atoms.
    pub(super) fn expression(&self, powers: &Powers) -> Expr<'g> {
        let factor = |(&id, &halves): (&Id, &i32)| match self.atoms[&id].shape {
            // Its number is that of its root.
            Shape::Sum(_) => self.graph.expr(id).power(HalfInteger::integer(halves)),
            _ if self.has_other_sign(id) => (-self.graph.expr(id)).power(HalfInteger::halves(halves)),
            Shape::Symbol(_) | Shape::Named(..) | Shape::Closed(_) => {
                self.graph.expr(id).power(HalfInteger::halves(halves))
            }
        };
        powers.iter().map(factor).fold(self.graph.integer(1), |product, factor| product * factor)
    }

    /// Whether it is an odd function whose argument is written with the other sign: `tan(x − y)` for `tan(y − x)`.
    fn has_other_sign(&self, id: Id) -> bool {
        matches!(self.graph.node(id), Node::Call(f, argument) if parity(f) < 0 && self.is_written_negative(argument))
    }

    /// Whether it is the negative of an argument that is written in functions.
    pub(super) fn is_written_negative(&self, argument: Id) -> bool {
        let sum = self.sums.get(&argument).cloned().flatten();
        sum.is_some_and(|sum| self.leading_positive(sum).1)
    }
}

/// The polynomial with `c p sin²x + c p cos²x` written as `c p`.
pub(super) fn without_unit_circles(graph: &Graph, mut sum: Polynomial) -> Polynomial {
    // Each turn leaves fewer terms.
    loop {
        let terms = sum.0.len();
        sum = with_fewer_circles(graph, sum);
        if sum.0.len() == terms {
            return sum;
        }
    }
}

fn with_fewer_circles(graph: &Graph, sum: Polynomial) -> Polynomial {
    let mut result = sum.clone();
    for powers in sum.0.keys() {
        for (&id, _) in powers.iter().filter(|(_, halves)| **halves == 4) {
            let Node::Call(Function::Sin, angle) = graph.node(id) else { continue };
            let cosine = graph.expr(angle).cos().id();
            let rest = product_of_powers(powers, &[(id, -4)].into());
            let other = rest.as_ref().and_then(|rest| product_of_powers(rest, &[(cosine, 4)].into()));
            let (Some(rest), Some(other)) = (rest, other) else { continue };
            let coefficient = result.coefficient(powers);
            if !coefficient.is_zero() && result.coefficient(&other) == coefficient {
                result.add(powers.clone(), -coefficient);
                result.add(other, -coefficient);
                result.add(rest, coefficient);
            }
        }
    }
    result
}

/// The first square whose terms belong to no other: `(x + y + z)²` is not taken apart.
fn find(sum: &Polynomial) -> Option<Square> {
    if sum.0.len() > LONGEST {
        return None;
    }
    let terms: Vec<(&Powers, Number)> = sum.0.iter().map(|(powers, &coefficient)| (powers, coefficient)).collect();
    let pairs = terms.iter().enumerate().flat_map(|(i, a)| terms[i + 1..].iter().map(move |b| (a, b)));
    let squares: Vec<Square> = pairs.filter_map(|(a, b)| square(sum, *a, *b)).collect();
    let uses = |term: &Powers| squares.iter().filter(|square| square.terms.contains(term)).count();
    let at = squares.iter().position(|square| square.terms.iter().all(|term| uses(term) == 1))?;
    squares.into_iter().nth(at)
}

/// `α g x² + β g y²` with the term `±2 √(α β) g x y` of the sum.
fn square(sum: &Polynomial, (a, alpha): (&Powers, Number), (b, beta): (&Powers, Number)) -> Option<Square> {
    let outside = common_powers(a, b);
    let [x, y] = [a, b].map(|powers| root(powers, &outside));
    let (x, y) = (x?, y?);
    let ratio = (beta * alpha.power(-2)?).power(1).filter(|ratio| matches!(ratio, Number::Exact { .. }))?;
    let middle = product_of_powers(&product_of_powers(&x, &y)?, &outside)?;
    let (twice, found) = (alpha * ratio * Number::integer(2), sum.coefficient(&middle));
    let sign = match found {
        found if found == twice => Number::ONE,
        found if found == -twice => -Number::ONE,
        _ => return None,
    };
    let terms = [a.clone(), b.clone(), middle];
    Some(Square { coefficient: alpha, outside, first: x, second: (y, ratio * sign), terms })
}

/// `√(powers / outside)`, where that has whole positive powers.
fn root(powers: &Powers, outside: &Powers) -> Option<Powers> {
    let rest = product_of_powers(powers, &outside.iter().map(|(&id, &halves)| (id, -halves)).collect())?;
    rest.into_iter().map(|(id, halves)| (halves > 0 && halves % 4 == 0).then_some((id, halves / 2))).collect()
}
