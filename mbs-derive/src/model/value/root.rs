//! Roots of squares: `√(x²)` is read as `|x|`, which it is for every real x.
//!
//! Kept as a root it would have no derivative at 0 where `|x|` has a kink, and numbers of a prime field know no sign by
//! which `√(x²)` and x could be told apart, or found equal.

use crate::expr::{Expr, Function, HalfInteger, Id, Node, Number};
use crate::model::value::evaluate::Resolver;

/// What makes a root of its arguments.
pub(super) const ROOTS: [&str; 3] = ["sqrt", "hypot", "norm"];

/// Products of more factors are left as they are.
const MAX_FACTORS: usize = 64;

/// Exponents beyond this are left as they are.
const LARGEST_EXPONENT: i64 = 400;

/// A product of powers with even exponents, which is nowhere negative.
struct Squares {
    /// Numbers that are not negative, and their exponents.
    constants: Vec<(Number, i64)>,
    /// What is squared, and the exponent, which is even.
    bases: Vec<(Id, i64)>,
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// `√x`
    pub(in crate::model) fn square_root(&mut self, x: Expr<'g>) -> Expr<'g> {
        self.root_of_squares(x, 1, 2).unwrap_or_else(|| x.sqrt())
    }

    /// `x^(numerator/denominator)` without the root, where x is a product of squares and that leaves powers of them.
    pub(in crate::model) fn root_of_squares(
        &mut self,
        x: Expr<'g>,
        numerator: i128,
        denominator: i128,
    ) -> Option<Expr<'g>> {
        let (numerator, denominator) = (i64::try_from(numerator).ok()?, i64::try_from(denominator).ok()?);
        let squares = self.squares(x)?;
        if numerator.abs() > LARGEST_EXPONENT || denominator > LARGEST_EXPONENT {
            return None;
        }
        let mut factors = Vec::new();
        for (value, exponent) in squares.constants {
            let halves = 2 * exponent * numerator;
            let power = i32::try_from(halves / denominator).ok().filter(|_| halves % denominator == 0)?;
            factors.push(self.graph.constant(value.kept_power(power)?));
        }
        let mut odd: Option<Expr<'g>> = None;
        for (base, exponent) in squares.bases {
            let (base, halves) = (self.graph.expr(base), 2 * exponent * numerator);
            let fits = halves % denominator == 0 && (halves / denominator).abs() <= 2 * LARGEST_EXPONENT;
            let power = HalfInteger::halves(i32::try_from(halves / denominator).ok().filter(|_| fits)?);
            match power.to_integer() {
                Some(n) if n % 2 == 0 => factors.push(base.power(power)),
                Some(n) => {
                    let factor = if n == 1 { base } else { base.power(power) };
                    odd = Some(odd.map_or(factor, |product| product * factor));
                }
                None => factors.push(self.cornered(Function::Abs, base).power(power)),
            }
        }
        let size = odd.map(|odd| self.cornered(Function::Abs, odd));
        size.into_iter().chain(factors.into_iter().rev()).reduce(|product, factor| factor * product)
    }

    /// `x`, where it is written as a product of squares, of one of something that is no number at least.
    fn squares(&mut self, x: Expr<'g>) -> Option<Squares> {
        let mut squares = Squares { constants: Vec::new(), bases: Vec::new() };
        let mut negative = false;
        let mut open = vec![(x, 1i64)];
        let mut steps = 0;
        while let Some((factor, exponent)) = open.pop() {
            steps += 1;
            if steps > MAX_FACTORS || exponent.abs() > LARGEST_EXPONENT {
                return None;
            }
            let factor = self.without_zeros(factor);
            if let Some(value) = self.known.facts.constant(factor) {
                let fits = !value.is_zero() && (exponent % 2 == 0 || !value.is_negative());
                let size = if value.is_negative() { -value } else { value };
                squares.constants.push(fits.then_some((size, exponent))?);
                continue;
            }
            match factor.node() {
                Node::Neg(a) => {
                    negative ^= exponent % 2 != 0;
                    open.push((self.graph.expr(a), exponent));
                }
                Node::Mul(a, b) if a == b => open.push((self.graph.expr(a), 2 * exponent)),
                Node::Mul(a, b) => open.extend([b, a].map(|id| (self.graph.expr(id), exponent))),
                Node::Power(a, n) if n.to_integer().is_some_and(|n| n != 0) => {
                    open.push((self.graph.expr(a), exponent * i64::from(n.to_integer()?)));
                }
                _ => match squares.bases.iter_mut().find(|(known, _)| *known == factor.id()) {
                    Some((_, known)) => *known += exponent,
                    None => squares.bases.push((factor.id(), exponent)),
                },
            }
        }
        let even = |&(_, exponent): &(Id, i64)| exponent % 2 == 0 && exponent != 0;
        (!negative && !squares.bases.is_empty() && squares.bases.iter().all(even)).then_some(squares)
    }

    /// `x` without terms that are zero for all values: a vector along an axis has two zero components.
    fn without_zeros(&mut self, mut x: Expr<'g>) -> Expr<'g> {
        let zero = self.graph.integer(0);
        for _ in 0..MAX_FACTORS {
            x = match x.node() {
                Node::Add(a, b) | Node::Sub(a, b) if self.known.facts.are_equal(self.graph.expr(b), zero) => {
                    self.graph.expr(a)
                }
                Node::Add(a, b) if self.known.facts.are_equal(self.graph.expr(a), zero) => self.graph.expr(b),
                _ => return x,
            };
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Node};
    use crate::model::check::trial::{mechanism, same};

    /// Whether there is a root in what the expression stands for.
    fn has_root(expression: &str) -> bool {
        mechanism(&format!("output result = {expression};"), |lagrangian| {
            let output = &lagrangian.outputs[lagrangian.outputs.len() - 1];
            let roots = output.value.components(&lagrangian.frames);
            let graph: &Graph = roots[0].graph();
            graph.reachable(roots.iter().map(|root| root.id())).into_iter().any(|id| match graph.node(id) {
                Node::Power(_, n) => n.to_integer().is_none(),
                Node::Call2(..) => true,
                _ => false,
            })
        })
    }

    fn is(expression: &str, size: &str) {
        same("", expression, size);
        assert!(!has_root(expression), "{expression}");
    }

    /// A choice that the user has not written is none that a warning is about; what is written is one.
    #[test]
    fn sides_of_roots_are_no_choices() {
        let choices = |expression: &str| {
            mechanism(&format!("output result = {expression};"), |lagrangian| lagrangian.choices.len())
        };
        for root in ["sqrt(exp(x/l)^2)", "(exp(x/l)^2)^(1/2)", "hypot(0, exp(x/l))", "[0, 0, exp(x/l)].norm()"] {
            assert_eq!((choices(root), has_root(root)), (0, false), "{root}");
        }
        assert_eq!(choices("abs(exp(x/l))"), 1);
    }

    #[test]
    fn roots_of_squares_are_absolute_values() {
        is("sqrt(x^2)", "abs(x)");
        is("sqrt((x - l)^2)", "abs(x - l)");
        is("sqrt((x - l)*(x - l))", "abs(x - l)");
        is("((x - l)^2)^(1/2)", "abs(x - l)");
        is("(x^4)^(1/4)", "abs(x)");
        is("(x^6)^(1/6)", "abs(x)");
        is("(x^2)^1.5", "abs(x)^3");
        is("(x^4)^(3/4)", "abs(x)^3");
        is("sqrt(x^4)", "x^2");
        is("sqrt(4*x^2)", "2*abs(x)");
        is("sqrt(x^2*theta^2)", "abs(x*theta)");
        is("sqrt(x*theta*theta*x)", "abs(x*theta)");
        is("sqrt(x^2/l^2)", "abs(x/l)");
        is("sqrt((-x)*(-x))", "abs(x)");
        is("hypot(x, 0)", "abs(x)");
        is("hypot(0*l, x)", "abs(x)");
        is("[0, x, 0].norm()", "abs(x)");
        is("dt([0, x, 0]).norm()", "abs(dt(x))");
        same("", "(x^2)^(1/4)", "abs(x)^(1/2)");
    }

    /// Of what may be negative, or is a sum of squares, the root stays.
    #[test]
    fn other_roots_stay() {
        let roots = [
            "sqrt(x*l)",
            "sqrt(-(x^2)*y/l)",
            "hypot(x, y)",
            "sqrt(m*x^2)",
            "sqrt(x^3)",
            "(x^2)^(1/3)",
            "(theta^2)^theta",
        ];
        roots.iter().for_each(|expression| assert!(has_root(expression), "{expression}"));
    }
}
