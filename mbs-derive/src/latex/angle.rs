//! Sines and cosines as textbooks abbreviate them, `s_{23} = \sin(q_2 + q_3)`, and sums of angles.

use crate::expr::normal::combination::{Polynomial, Powers, product_of_powers};
use crate::expr::{Expr, Function, Id, Node, Number};

use super::algebra::Algebra;
use super::atom::{Kind, Shape};
use super::layout::applied;
use super::notation::subscripted;

/// `coefficient · rest · angle`, the sine or cosine of a sum, and the two terms that it is worth.
struct Pair<'g> {
    terms: [Powers; 2],
    rest: Powers,
    angle: Expr<'g>,
    coefficient: Number,
}

impl<'g> Algebra<'g> {
    /// Whether it is a sum of coordinates, each once, with any signs.
    pub(super) fn is_angle(&self, sum: &Polynomial) -> bool {
        !sum.0.is_empty() && sum.0.iter().all(|(powers, &c)| self.angle(powers).is_some() && is_sign(c))
    }

    fn angle(&self, powers: &Powers) -> Option<(u32, &str)> {
        let (id, &halves) = powers.first_key_value().filter(|_| powers.len() == 1)?;
        let atom = &self.atoms[id];
        match &atom.shape {
            Shape::Symbol(name) if halves == 2 && atom.place.kind == Kind::Coordinate => {
                Some((atom.place.number, name))
            }
            _ => None,
        }
    }

    /// `s_{23}` for `\sin(q_2 + q_3)`, `c_\theta` for `\cos\theta`; `None` of other functions and arguments, and where
    /// such a name is taken.
    pub(super) fn wave(&mut self, function: Function, sum: &Polynomial, argument: &str) -> Option<String> {
        let (letter, command) = match function {
            Function::Sin => ("s", "\\sin"),
            Function::Cos => ("c", "\\cos"),
            _ => return None,
        };
        if !self.abbreviates || !self.is_angle(sum) {
            return None;
        }
        let mut parts: Vec<(u32, &str, bool)> =
            sum.0.iter().filter_map(|(p, c)| self.angle(p).map(|(n, name)| (n, name, c.is_negative()))).collect();
        parts.sort_unstable();
        let mut numbered = self.notation.coordinates.iter().filter(|c| !c.subscript.is_empty()).map(|c| &c.stem);
        let first = numbered.next();
        let of_one_kind = numbered.all(|stem| Some(stem) == first);
        let digits: Option<String> =
            parts.iter().map(|(_, name, negative)| digit(name).filter(|_| !negative)).collect();
        let subscript = digits.filter(|_| of_one_kind).unwrap_or_else(|| {
            let signed = |(i, (_, name, negative)): (usize, &(u32, &str, bool))| match (i, negative) {
                (0, false) => name.to_string(),
                (_, true) => format!("-{name}"),
                (_, false) => format!("+{name}"),
            };
            parts.iter().enumerate().map(signed).collect()
        });
        let name = subscripted(letter, &subscript);
        let meaning = applied(command, argument);
        self.notation.wave(&name, &meaning).then_some(name)
    }

    /// `c_2 c_3 − s_2 s_3 = c_{23}` and its like, where these are abbreviated.
    pub(super) fn with_sums_of_angles(&mut self, mut sum: Polynomial) -> Polynomial {
        if !self.abbreviates {
            return sum;
        }
        // Each turn leaves one term fewer.
        while let Some(Pair { terms, rest, angle, coefficient }) = self.pair(&sum) {
            let Some(wave) = self.expand(angle) else { return sum };
            let Some((powers, unit)) = wave.as_term() else { return sum };
            let Some(product) = product_of_powers(&rest, powers) else { return sum };
            for term in &terms {
                sum.0.remove(term);
            }
            sum.add(product, coefficient * unit);
        }
        sum
    }

    /// Two terms that are the sine or cosine of a sum or difference times something.
    fn pair(&self, sum: &Polynomial) -> Option<Pair<'g>> {
        for (powers, &coefficient) in &sum.0 {
            let waves: Vec<(Id, Function, Id)> = powers.keys().filter_map(|&id| self.short_wave(id)).collect();
            for (i, &(a, f, x)) in waves.iter().enumerate() {
                for &(b, g, y) in waves[i + 1..].iter().filter(|(_, _, y)| *y != x) {
                    let rest = product_of_powers(powers, &[(a, -2), (b, -2)].into())?;
                    let [x, y] = [x, y].map(|id| self.graph.expr(id));
                    // The sine that is written is that of the angle with its sign.
                    let written = |x: Expr<'g>| if self.is_written_negative(x.id()) { -x } else { x };
                    let other = |function: Function, angle: Expr<'g>| match function {
                        Function::Sin => angle.cos().id(),
                        _ => angle.sin().id(),
                    };
                    let (c, d) = (other(f, x), other(g, y));
                    if !self.atoms.contains_key(&c) || !self.atoms.contains_key(&d) {
                        continue;
                    }
                    let partner = product_of_powers(&rest, &[(c, 2)].into())
                        .and_then(|half| product_of_powers(&half, &[(d, 2)].into()))?;
                    let found = sum.coefficient(&partner);
                    let same = found == coefficient;
                    if found.is_zero() || !(same || found == -coefficient) {
                        continue;
                    }
                    let (x, y) = (written(x), written(y));
                    let (angle, sign) = match (f, g, same) {
                        // cc − ss, cc + ss
                        (Function::Cos, Function::Cos, same) => (if same { (x - y).cos() } else { (x + y).cos() }, 1),
                        // ss + cc, ss − cc
                        (Function::Sin, Function::Sin, true) => ((x - y).cos(), 1),
                        (Function::Sin, Function::Sin, false) => ((x + y).cos(), -1),
                        // sc + cs, sc − cs
                        (Function::Sin, _, same) => (if same { (x + y).sin() } else { (x - y).sin() }, 1),
                        (_, _, true) => ((x + y).sin(), 1),
                        (_, _, false) => ((x - y).sin(), -1),
                    };
                    let coefficient = if sign < 0 { -coefficient } else { coefficient };
                    return Some(Pair { terms: [powers.clone(), partner], rest, angle, coefficient });
                }
            }
        }
        None
    }

    /// The sine or cosine of an angle that has a short name.
    fn short_wave(&self, id: Id) -> Option<(Id, Function, Id)> {
        let Node::Call(function @ (Function::Sin | Function::Cos), argument) = self.graph.node(id) else { return None };
        let atom = self.atoms.get(&id)?;
        (atom.place.kind == Kind::Trigonometric && matches!(atom.shape, Shape::Symbol(_)))
            .then_some((id, function, argument))
    }
}

fn is_sign(coefficient: Number) -> bool {
    coefficient == Number::ONE || coefficient == -Number::ONE
}

/// `q_3` → 3
fn digit(name: &str) -> Option<&str> {
    name.split_once('_')
        .map(|(_, digit)| digit)
        .filter(|digit| digit.len() == 1 && digit.as_bytes()[0].is_ascii_digit())
}
