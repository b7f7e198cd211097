//! Warnings about numbers that are probably wrong: angles in degrees; and about signs: a kinetic term that is never
//! positive, friction that drives.
//!
//! Signs are tried at random states, with the default parameters and no inputs.

use crate::diagnostic::Code;
use crate::expr::{Dual, Expr, Graph, Node, Number, Symbol, Tape, carry_out};
use crate::model::check::sample::default_parameters;
use crate::model::check::singular::along_the_motion;
use crate::model::lagrangian::Draft;
use crate::model::value::evaluate::Resolver;
use crate::numeric::Random;
use crate::parse::syntax::Span;
use crate::state::State;

/// How many states with finite values are looked at, and how many are tried at most to find them.
const STATES: usize = 20;
const TRIED: usize = 200;

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn warn_of_signs(&mut self) {
        let samples = Samples::new(&self.lagrangian);
        for term in samples.never_positive(&self.lagrangian.kinetic) {
            let place = self.found.places.kinetic[term].clone();
            let warning = self.report.warn_at(Code::NeverPositive, &place, "this kinetic energy is never positive");
            warning.help("is its sign right? springs and weights are `potential += …`");
        }
        for term in samples.driving_dissipation(&self.lagrangian) {
            let message = "this dissipation brings energy in: somewhere its force acts along the motion";
            let place = self.found.places.dissipation[term].clone();
            let warning = self.report.warn_at(Code::BringsEnergyIn, &place, message);
            warning.help("D is positive and enters as the force `-∂D/∂q̇`: write `dissipation += 1/2 * b * dt(x)^2;`");
        }
        for force in samples.driving_forces(&self.lagrangian) {
            let message = "this force always acts along the motion: it brings energy in";
            let place = self.found.places.forces[force].clone();
            let warning = self.report.warn_at(Code::BringsEnergyIn, &place, message);
            warning.help("forces are written as they act on the mechanism, friction against the motion: `-b*dt(x)`");
        }
    }
}

/// With time derivatives carried out.
fn tape(exprs: &[Expr<'_>]) -> Tape {
    let graph = Graph::new();
    Tape::new(&carry_out(exprs, &graph, |symbol| along_the_motion(&graph, symbol)))
}

// ---- degrees

impl<'d, 'g> Resolver<'d, 'g> {
    /// An angle of more than a turn, written without `pi` or `deg`, was probably meant in degrees.
    pub(in crate::model) fn warn_of_degrees(&mut self, angle: Number, span: &Span) {
        let plain = matches!(angle, Number::Exact { pi: 0, .. });
        let value = angle.to_f64();
        if plain && value.abs() > std::f64::consts::TAU {
            let turns = (value.abs() / std::f64::consts::TAU * 10.0).round() / 10.0;
            let (place, calls) = self.report.place(span);
            if !self.report.has_said(&place, "degrees") {
                let message = format!("this angle is in radians: {value} rad are {turns} turns");
                let warning = self.report.errors.warning(Code::AngleInDegrees, place, message);
                warning.help(format!("for degrees write `{value}*deg`"));
                for (call, what) in calls {
                    warning.note(call, what);
                }
            }
        }
    }

    /// The angle itself, or a constant that is added to it.
    pub(in crate::model) fn warn_of_degrees_in(&mut self, angle: Expr<'g>, span: &Span) {
        let parts = match angle.node() {
            Node::Add(a, b) | Node::Sub(a, b) => vec![self.graph.expr(a), self.graph.expr(b)],
            _ => vec![angle],
        };
        for part in parts {
            if let Some(number) = self.known.facts.constant(part) {
                self.warn_of_degrees(number, span);
            }
        }
    }
}

// ---- states

/// Random states of a mechanism.
struct Samples {
    states: Vec<State>,
    parameters: Vec<f64>,
}

impl Samples {
    fn new(lagrangian: &Draft<'_>) -> Self {
        let mut random = Random::new(0x7369_676e);
        let states = (0..TRIED).map(|_| random.state(lagrangian)).collect();
        Samples { states, parameters: default_parameters(lagrangian) }
    }

    /// The states with the values of some expressions there, and their slopes with the velocities growing in
    /// proportion.
    fn values(&self, exprs: &[Expr<'_>]) -> Vec<(&State, Vec<Dual<f64>>)> {
        let tape = tape(exprs);
        let values = self.states.iter().map(|state| (state, tape.run(|symbol| self.value(state, symbol))));
        values.filter(|(_, values)| values.iter().all(|v| v.value.is_finite())).take(STATES).collect()
    }

    fn value(&self, state: &State, symbol: Symbol) -> Dual<f64> {
        match symbol {
            Symbol::Time => Dual::fixed(state.t),
            Symbol::Coordinate(i) => Dual::fixed(state.q[i as usize]),
            Symbol::Velocity(i) => Dual::new(state.qd[i as usize], state.qd[i as usize]),
            Symbol::Parameter(i) => Dual::fixed(self.parameters[i as usize]),
            Symbol::Prescribed(i, order @ 0..=2) => Dual::fixed(state.prescribed[i as usize][usize::from(order)]),
            Symbol::Prescribed(..) | Symbol::Acceleration(_) | Symbol::Input(_) | Symbol::Multiplier(_) => {
                Dual::fixed(0.0)
            }
        }
    }

    /// The numbers of the terms that are negative somewhere and positive nowhere.
    fn never_positive(&self, terms: &[Expr<'_>]) -> Vec<usize> {
        let values = self.values(terms);
        let all = |term: usize| values.iter().map(move |(_, v)| v[term].value);
        (0..terms.len()).filter(|&i| all(i).all(|v| v <= 0.0) && all(i).any(|v| v < 0.0)).collect()
    }

    /// The terms of D with `q̇·∂D/∂q̇ < 0` at a state where the sum is negative, too.
    fn driving_dissipation(&self, lagrangian: &Draft<'_>) -> Vec<usize> {
        let values = self.values(&lagrangian.dissipation);
        let size = |v: &[Dual<f64>]| v.iter().map(|d| d.derivative.abs()).sum::<f64>();
        let power = |v: &[Dual<f64>]| v.iter().map(|d| d.derivative).sum::<f64>();
        let driven: Vec<_> = values.iter().map(|(_, v)| v).filter(|v| power(v) < -1e-9 * size(v)).collect();
        (0..lagrangian.dissipation.len()).filter(|&i| driven.iter().any(|v| v[i].derivative < 0.0)).collect()
    }

    /// The forces whose part that depends on the velocities has a positive power everywhere, alone and together.
    fn driving_forces(&self, lagrangian: &Draft<'_>) -> Vec<usize> {
        let forces: Vec<Expr<'_>> = lagrangian.forces.iter().map(|(_, force)| *force).collect();
        let tape = tape(&forces);
        let at_rest = |state: &State| {
            let still = State { qd: vec![0.0; state.qd.len()], ..state.clone() };
            tape.run(|symbol| self.value(&still, symbol))
        };
        let powers: Vec<Vec<f64>> = self
            .values(&forces)
            .into_iter()
            .map(|(state, moving)| {
                let resting = at_rest(state);
                let rates = lagrangian.forces.iter().map(|(q, _)| state.qd[*q]);
                let friction = moving.iter().zip(resting).map(|(moving, resting)| moving.value - resting.value);
                friction.zip(rates).map(|(force, rate)| force * rate).collect()
            })
            .collect();
        let drives = |p: &Vec<f64>| p.iter().sum::<f64>() > 0.0;
        if powers.is_empty() || !powers.iter().all(drives) {
            return Vec::new();
        }
        (0..forces.len()).filter(|&i| powers.iter().all(|p| p[i] >= 0.0) && powers.iter().any(|p| p[i] > 0.0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{refusals, refused};

    #[test]
    fn degrees_for_radians() {
        let warned = |statements: &str, place: &str, value: &str, turns: &str| {
            let message = format!("{place}: this angle is in radians: {value} rad are {turns} turns");
            refused(statements, &format!("{message}; for degrees write `{value}*deg`"));
        };
        warned("const a: rad = 30; let b = a;", "30", "30", "4.8");
        warned("const a[2]: rad = [0.1, -45];", "[0.1, -45]", "-45", "7.2");
        warned("let a = sin(45);", "45", "45", "7.2");
        warned("let a = rot_x(theta + 90);", "theta + 90", "90", "14.3");
        warned("let a = dh(theta, 0, l, 90);", "90", "90", "14.3");
        warned("let a = rotation([1, 1, 1], 180);", "180", "180", "28.6");
        warned("fn turned(a) = rot_z(a); let a = turned(90) * turned(90);", "a", "90", "14.3");
        for fine in [
            "const a: rad = 6.28;",
            "const a: rad = 720*deg;",
            "const a: rad = 8*pi;",
            "const a: deg = 720;",
            "const a: 1/s = 300; let b = sin(a*t);",
            "const a: 1 = 30;",
            "let a = sin(12*theta);",
        ] {
            assert_eq!(refusals(fine), [""; 0], "{fine}");
        }
    }

    #[test]
    fn signs_of_dissipation_and_forces() {
        let energy = "this dissipation brings energy in: somewhere its force acts along the motion";
        let force = "this force always acts along the motion: it brings energy in";
        let warned = |statements: &str, place: &str, message: &str| {
            let found = refusals(statements);
            assert!(found.len() == 1 && found[0].starts_with(&format!("{place}: {message}; ")), "{found:?}");
        };
        let constants = "const b: N*s/m = 2; const c: kg/m = 3;";
        let with = |statements: &str| format!("{constants} {statements}");
        warned(&with("dissipation += -b*dt(x)^2;"), "-b*dt(x)^2", energy);
        warned(&with("dissipation += b*dt(y)^2; dissipation += -2*b*dt(x)^2;"), "-2*b*dt(x)^2", energy);
        warned(&with("force y += b*dt(y);"), "b*dt(y)", force);
        warned(&with("force x += k*y + c*abs(dt(x))*dt(x) + u;"), "k*y + c*abs(dt(x))*dt(x) + u", force);
        for fine in [
            "dissipation += b*(dt(x)^2 - dt(x)*dt(y) + dt(y)^2);",
            "dissipation += b*dt(x)^2; dissipation += -1/2*b*dt(x)^2;",
            "dissipation += u*dt(x)/2;",
            "force x += -b*dt(x); force x += k*x;",
            "force x += -b*(dt(x) - dt(y)); force y += b*(dt(x) - dt(y));",
            "force x += b*dt(y); force y += -b*dt(x);",
            "force x += b*dt(x); force x += -2*b*dt(x);",
            "force x += -b*(3*x^2/l^2 - 1)*dt(x);",
        ] {
            assert_eq!(refusals(&with(fine)), [""; 0], "{fine}");
        }
    }

    #[test]
    fn kinetic_terms_that_are_never_positive() {
        refused(
            "kinetic += -1/10*m*dt(x)^2; kinetic += m*dt(x)*dt(y)/4;",
            "-1/10*m*dt(x)^2: this kinetic energy is never positive; is its sign right? springs and weights are `potential += …`",
        );
        let found = refusals("kinetic += m*dt(x)*dt(y)/2; kinetic += -m*dt(x)^2;");
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with("-m*dt(x)^2: kinetic energy is never negative, this term is; "), "{found:?}");
    }
}
