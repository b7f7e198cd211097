//! Whether every motion that the constraints leave has inertia: the mass matrix of the declared energies.

use crate::expr::{Dual, Expr, Graph, Residue, Rounded, Symbol, Tape, Value, carry_out, gradient, sparse};
use crate::numeric::elimination::{Elimination, ROUNDING, eliminate_rounded, on_allowed_motions};

use crate::model::check::degree::{Line, Problem};
use crate::model::check::rank::VelocityEquations;
use crate::numeric::echelon::Echelon;

/// Up to this many coordinates M is found by polarization, n² values of L; beyond by its gradient, n of these.
const FEW: usize = 20;
/// Of a mechanism of more coordinates than these M is not looked at as a whole: its accelerations are proved, and that
/// they are finite.
const MANY: usize = 100;

/// `L + V`, which carries all velocities.
pub(in crate::model) struct Motion {
    tape: Tape,
    /// Its derivatives in the velocities, where there are many.
    momenta: Option<Tape>,
}

impl Motion {
    /// Of a mechanism of n coordinates.
    pub(in crate::model) fn new(sum: Expr<'_>, n: usize) -> Self {
        Motion { tape: Tape::new(&[sum]), momenta: (n > FEW).then(|| momenta(sum, n)) }
    }

    /// M, row by row.
    fn mass_matrix<V: Value>(&self, n: usize, at: impl Fn(&dyn Fn(u32) -> V, Symbol) -> Dual<V>) -> Vec<V> {
        match &self.momenta {
            None => self.by_polarization(n, at),
            Some(_) => {
                let unit = |i: usize| move |k: u32| V::constant(f64::from(u8::from(k as usize == i)));
                let columns: Vec<Vec<V>> = (0..n).map(|i| self.momenta_of(&unit(i), &at)).collect();
                (0..n * n).map(|k| columns[(k / n).min(k % n)][(k / n).max(k % n)]).collect()
            }
        }
    }

    /// `M v`
    fn momenta_of<V: Value>(&self, v: &dyn Fn(u32) -> V, at: &impl Fn(&dyn Fn(u32) -> V, Symbol) -> Dual<V>) -> Vec<V> {
        let Some(momenta) = &self.momenta else { return Vec::new() };
        let with = |velocity: &dyn Fn(u32) -> V| momenta.run(|symbol| at(velocity, symbol).value);
        with(v).into_iter().zip(with(&|_| V::constant(0.0))).map(|(moving, rest)| moving.sub(rest)).collect()
    }

    /// `Mᵢⱼ = L(eᵢ + eⱼ) − L(eᵢ) − L(eⱼ) + L(0)`, the polarization of a quadratic polynomial.
    fn by_polarization<V: Value>(&self, n: usize, at: impl Fn(&dyn Fn(u32) -> V, Symbol) -> Dual<V>) -> Vec<V> {
        let with = |i: Option<usize>, j: Option<usize>| {
            let one = |k: u32, index: Option<usize>| f64::from(u8::from(index == Some(k as usize)));
            let velocity = |k: u32| V::constant(one(k, i) + one(k, j));
            self.tape.run(|symbol| at(&velocity, symbol))[0].value
        };
        let rest = with(None, None);
        let single: Vec<V> = (0..n).map(|i| with(Some(i), None)).collect();
        let entry = |i: usize, j: usize| with(Some(i), Some(j)).sub(single[i]).sub(single[j]).add(rest);
        let lower: Vec<V> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
        let at = |i: usize, j: usize| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        (0..n * n).map(|k| at(k / n, k % n)).collect()
    }
}

/// `∂L/∂q̇`
fn momenta(sum: Expr<'_>, n: usize) -> Tape {
    let graph = Graph::verbatim();
    let carried = carry_out(&[sum], &graph, |symbol| rate(symbol, &graph))[0];
    Tape::new(&gradient(carried, &(0..n as u32).map(Symbol::Velocity).collect::<Vec<_>>()))
}

/// What a symbol changes by along a motion, in energies and constraints.
pub(in crate::model) fn rate<'g>(symbol: Symbol, graph: &'g Graph) -> Option<Expr<'g>> {
    match symbol {
        Symbol::Time => Some(graph.integer(1)),
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Prescribed(i, order) => Some(graph.symbol(Symbol::Prescribed(i, order + 1))),
        Symbol::Velocity(_)
        | Symbol::Acceleration(_)
        | Symbol::Parameter(_)
        | Symbol::Input(_)
        | Symbol::Multiplier(_) => None,
    }
}

/// Of many coordinates, one that has no inertia in a motion of all, or whose motion with others has a negative one.
fn problem_of_many(motion: &Motion, lines: &[Line]) -> Option<Problem> {
    let line = lines.first()?;
    let at = |velocity: &dyn Fn(u32) -> Rounded, symbol| line.rounded(velocity, symbol);
    let velocity = |i: u32| Rounded::exact(line.direction[i as usize]);
    let momenta = motion.momenta_of(&velocity, &at);
    if let Some(alone) = momenta.iter().position(|p| p.value == 0.0) {
        return Some(Problem::NoInertia(alone));
    }
    let powers = || momenta.iter().zip(0..).map(|(&p, i)| p * velocity(i));
    let twice_kinetic: Rounded = powers().sum();
    let is_negative = twice_kinetic.value < -ROUNDING * twice_kinetic.error;
    let least = (0..momenta.len()).zip(powers()).min_by(|(_, a), (_, b)| a.value.total_cmp(&b.value));
    least.filter(|_| is_negative).map(|(i, _)| Problem::NegativeInertia(i))
}

/// Whether M and A are clearly regular at a state, by an elimination that takes but what is not zero.
fn is_clearly_regular(motion: &Motion, constraints: &VelocityEquations, line: &Line, n: usize) -> bool {
    let mass = motion.mass_matrix(n, |velocity, symbol| line.with_velocity(velocity, symbol));
    let triangle: Vec<f64> = (0..n).flat_map(|i| mass[i * n..=i * n + i].to_vec()).collect();
    sparse::is_regular(n, &triangle, &constraints.pfaffian(line, n).concat())
}

/// What is wrong with the inertia of a mechanism, if anything.
pub(in crate::model) fn problem(
    motion: &Motion,
    constraints: &VelocityEquations,
    lines: &[Line],
    n: usize,
) -> Option<Problem> {
    if n > MANY && constraints.vectors().next().is_none() {
        return problem_of_many(motion, lines);
    }
    let is_large = n + constraints.vectors().count() > sparse::FEW_UNKNOWNS;
    if is_large && lines.iter().take(2).any(|line| is_clearly_regular(motion, constraints, line, n)) {
        return None;
    }
    let matrix = |line: &Line| {
        let mass = motion.mass_matrix(n, |velocity, symbol| line.rounded(velocity, symbol));
        let rows = constraints.pfaffian(line, n).into_iter().zip(constraints.vectors());
        let (rows, vectors): (Vec<_>, Vec<_>) = rows.filter(|(row, _)| row.iter().all(|x| x.is_finite())).unzip();
        on_allowed_motions(n, mass, rows.concat().into_iter().map(Rounded::exact).collect(), &vectors)
    };
    // Of a large mechanism, whose matrix takes n evaluations of its gradient, fewer states have to do.
    let tried = lines.iter().take(if n > FEW { 2 } else { lines.len() });
    let found: Vec<(Elimination, f64)> = tried.map(matrix).map(|m| eliminate_rounded(&m, n)).collect();
    if let Some((negative, _)) = found.iter().find(|(e, rounding)| e.smallest < -rounding) {
        return Some(Problem::NegativeInertia(negative.last));
    }
    if found.iter().any(|(e, rounding)| e.smallest > *rounding) {
        return None;
    }
    without_inertia(motion, constraints, lines, n)
}

/// The coordinates of a motion that has no inertia at any state, decided in a finite field at the defaults of the
/// parameters; where it has no values, none is said to be.
fn without_inertia(motion: &Motion, constraints: &VelocityEquations, lines: &[Line], n: usize) -> Option<Problem> {
    let first = dependence::<0>(motion, constraints, lines, n);
    let second = dependence::<1>(motion, constraints, lines, n);
    // In a field in which nothing has a value, nothing is decided.
    let coordinates = match (first, second) {
        (Some(first), Some(second)) => second.and(first),
        (only, None) | (None, only) => only.flatten(),
    }?;
    Some(match coordinates.as_slice() {
        &[alone] => Problem::NoInertia(alone),
        _ => Problem::DependentInertia(coordinates),
    })
}

/// The coordinates of a motion without inertia in one of the fields, if there is one; `None` where nothing has a value.
fn dependence<const K: usize>(
    motion: &Motion,
    constraints: &VelocityEquations,
    lines: &[Line],
    n: usize,
) -> Option<Option<Vec<usize>>> {
    const TRIED: u64 = 64;
    let line = lines.first()?;
    let echelons = (0..TRIED).filter_map(|point| {
        let mass = motion.mass_matrix(n, |velocity, symbol| line.in_field(point, velocity, symbol));
        let rows = constraints.pfaffian_in_field::<K>(line, point, n);
        // A motion without inertia is in the null space of both.
        Echelon::of(mass.chunks(n).map(<[Residue<K>]>::to_vec).chain(rows).collect())
    });
    let singular: Vec<Option<Vec<usize>>> = echelons.take(2).map(|echelon| echelon.shortest_dependence()).collect();
    (!singular.is_empty()).then(|| singular.into_iter().collect::<Option<Vec<_>>>()?.pop())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which sign the inertia of the motions has that a row leaves: 0 where one has none.
    fn sign(mass: [f64; 9], row: [f64; 3]) -> i32 {
        let [mass, row] = [mass.as_slice(), &row].map(|numbers| numbers.iter().copied().map(Rounded::exact).collect());
        let (found, rounding) = eliminate_rounded(&on_allowed_motions(3, mass, row, &[0]), 3);
        i32::from(found.smallest > rounding) - i32::from(found.smallest < -rounding)
    }

    /// `½ Σ (i + 1) vᵢ² + vᵢ vᵢ₊₁`, with rates and velocities.
    #[test]
    fn the_gradient_of_many_velocities_gives_what_polarization_does() {
        let (graph, n) = (Graph::verbatim(), FEW + 1);
        let rate = |i: usize| graph.symbol(Symbol::Coordinate(i as u32)).rate();
        let velocity = |i: usize| graph.symbol(Symbol::Velocity(i as u32));
        let term = |i: usize| rate(i) * velocity(i) * (i as i64 + 1) / 2 + rate(i) * rate((i + 1) % n);
        let motion = Motion::new((1..n).fold(term(0), |sum, i| sum + term(i)), n);
        let at = |velocity: &dyn Fn(u32) -> f64, symbol| match symbol {
            Symbol::Coordinate(i) => Dual::new(0.3, velocity(i)),
            Symbol::Velocity(i) => Dual::fixed(velocity(i)),
            other => unreachable!("{other:?}"),
        };
        assert!(motion.momenta.is_some());
        assert_eq!(motion.mass_matrix(n, at), motion.by_polarization(n, at));
    }

    #[test]
    fn of_many_coordinates_one_without_inertia_or_with_a_negative_one_is_found() {
        let report = |kinetic: &str| {
            let text = format!(
                "#![dimensionless] mechanism A {{ coord q[101]: 1; for i in 0..100 {{ kinetic += dt(q[i])^2; }} \
                 potential += q[100]^2; kinetic += {kinetic}; }}"
            );
            let graph = Graph::verbatim();
            crate::declared(&text, &graph, &[]).err().map(|found| found.render("a", &text)).unwrap_or_default()
        };
        assert_eq!(report("dt(q[100])^2"), "");
        let cancelled = report("dt(q[100])^2 - dt(q[100])^2");
        assert!(cancelled.contains("coordinate `q_100` has no inertia"), "{cancelled}");
        let negative = report("dt(q[100])^2 - 1000000*dt(q[7])^2*cos(q[3])^2");
        assert!(negative.contains("negative"), "{negative}");
    }

    #[test]
    fn units_do_not_change_what_has_inertia() {
        // The second coordinate follows the third: 0.5 + 4·(−1.25), (1, 0.25), nothing at all.
        let cases = [
            ([3.0, 0.0, 0.0, 0.0, -1.25, 0.0, 0.0, 0.0, 0.5], -1),
            ([3.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.25], 1),
            ([3.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0], 1),
            ([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0),
        ];
        for units in 0..81 {
            let power = |digit: u32| 2.0_f64.powi(60 * (units / 3_i32.pow(digit) % 3 - 1));
            let unit = [power(0), power(1), power(2)];
            for (mass, expected) in cases {
                let mass = std::array::from_fn(|k| unit[k / 3] * mass[k] * unit[k % 3]);
                let row = std::array::from_fn(|i| power(3) * unit[i] * [0.0, 1.0, -2.0][i]);
                assert_eq!(sign(mass, row), expected, "{unit:?} {mass:?} {row:?}");
            }
        }
    }
}
