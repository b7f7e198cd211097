//! Reactions: the force and the moment that a joint transmits.
//!
//! The mechanism with its joints let go has auxiliary coordinates s besides its own. Lagrange's equations for them,
//! with a generalized force R that holds them at zero, are
//!
//! ```text
//! R = d/dt ∂L/∂ṡ − ∂L/∂s + ∂D/∂ṡ − Q_s − A_sᵀ λ        at s = ṡ = s̈ = 0
//! ```
//!
//! with `Q_s` of forces at points and torques on bodies, and `A_s = ∂φ/∂s`, or the slope of a Pfaffian row in ṡ. As s
//! stays zero, only derivatives *by* s and ṡ see it: one reverse sweep for each of the terms, whatever the number of
//! joints.

use crate::expr::{Expr, Graph, Kept, Symbol, gradient, gradient_of_combination, substitute};
use crate::mistake::rule;
use crate::model::{Lagrangian, lagrangian::AUXILIARY};

use super::constraint;
use super::lagrange::{add, rate, sub};
use super::lift::{self, Lifted};
use super::textbook::Form;
use super::tree::{self, Masses};
use super::{Constraints, Energies, Route, Symbols};

/// The wrenches of all reactions, ready to be derived by each route.
pub(super) struct Reactions<'g> {
    /// How many numbers each reaction has.
    counts: Vec<usize>,
    /// Those of the mechanism, those of the joints that are let go behind them.
    symbols: Symbols,
    /// Of the mechanism with its joints let go.
    energies: Energies<'g>,
    lifted: Option<Lifted<'g>>,
    /// Numbers of the auxiliary coordinates.
    auxiliary: Auxiliary,
    /// `A_sᵀ λ`
    constraint_force: Vec<Expr<'g>>,
}

/// Auxiliary coordinates are those from a number on.
#[derive(Clone, Copy, Debug)]
struct Auxiliary {
    first: usize,
}

impl<'g> Reactions<'g> {
    /// Of a mechanism with joints that can be let go.
    pub(super) fn of(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Option<Self> {
        let released = lagrangian.released.as_deref()?;
        let auxiliary = Auxiliary { first: lagrangian.dof() };
        let symbols = Symbols::of(released);
        let energies = Energies::carried_out(released, graph);
        let lifted = lift::lifted(released, &energies, graph);
        let constraints = constraint::constraints(released, graph, &symbols);
        let constraint_force = constraint_force(&constraints, &symbols.qd[auxiliary.first..], graph);
        let constraint_force = auxiliary.held(&constraint_force);
        let counts = lagrangian.reactions.iter().map(|reaction| AUXILIARY * reaction.count());
        Some(Reactions { counts: counts.collect(), symbols, energies, lifted, auxiliary, constraint_force })
    }

    /// By a route, which need not apply.
    pub(super) fn by(&self, route: Route) -> Option<Vec<Vec<Expr<'g>>>> {
        let net = match route {
            Route::Plain | Route::Textbook | Route::MultipliedOut => self.plain(&self.energies),
            Route::Structured | Route::Articulated | Route::Recursive => self.structured(Masses::Regrouped)?,
            Route::Ungrouped => self.structured(Masses::AsDeclared)?,
        };
        let less = &self.constraint_force;
        let mut all = rule!("reactions to constraints", sub(&net, less), add(&net, less)).into_iter();
        let wrenches = self.counts.iter().map(|&count| all.by_ref().take(count).collect::<Vec<_>>());
        let kept = self.factors();
        Some(match route {
            Route::Textbook => wrenches.map(|wrench| Form::Textbook(&kept).list(&wrench)).collect(),
            Route::MultipliedOut => wrenches.map(|wrench| Form::Textbook(&Kept::default()).list(&wrench)).collect(),
            Route::Plain | Route::Structured | Route::Articulated | Route::Recursive | Route::Ungrouped => {
                wrenches.collect()
            }
        })
    }

    /// The sums that springs, dampers and forces were written with, with the joints held.
    fn factors(&self) -> Kept {
        let Energies { potential, dissipation, other, .. } = self.energies;
        let energies = self.auxiliary.held(&[potential, dissipation, other]);
        let kept = Kept::of(&energies, &self.auxiliary.held(&self.energies.declared_forces));
        kept.and_constants_of(&[&energies[..], &[self.energies.kinetic]].concat())
    }

    /// `d/dt ∂L/∂ṡ − ∂L/∂s + ∂D/∂ṡ − Q_s`
    fn plain(&self, energies: &Energies<'g>) -> Vec<Expr<'g>> {
        let (s, sd) = (&self.symbols.q[self.auxiliary.first..], &self.symbols.qd[self.auxiliary.first..]);
        let held = |expressions: Vec<Expr<'g>>| self.auxiliary.held(&expressions);
        let momentum = held(gradient(energies.lagrangian, sd));
        let position_gradient = held(gradient(energies.lagrangian, s));
        let dissipation = held(gradient(energies.dissipation, sd));
        let force = held(energies.forces[self.auxiliary.first..].to_vec());
        sub(&add(&sub(&rate(&momentum), &position_gradient), &dissipation), &force)
    }

    /// Forces on the auxiliary coordinates by Newton–Euler; those of what is no body plainly.
    fn structured(&self, masses: Masses) -> Option<Vec<Expr<'g>>> {
        let lifted = self.lifted.as_ref()?;
        let bodies = tree::net_forces(lifted, masses, &self.symbols, self.auxiliary.first);
        Some(add(&self.auxiliary.held(&bodies), &self.plain(&lifted.rest)))
    }
}

impl Auxiliary {
    /// At `s = ṡ = s̈ = 0`.
    fn held<'g>(self, expressions: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let Some(graph) = expressions.first().map(|e| e.graph()) else { return Vec::new() };
        substitute(expressions, |symbol| match symbol {
            Symbol::Coordinate(i) | Symbol::Velocity(i) | Symbol::Acceleration(i) if i as usize >= self.first => {
                Some(graph.integer(0))
            }
            _ => None,
        })
    }
}

/// `A_sᵀ λ`: the slope in ṡ of `Σ λ (A q̇ + b)`.
fn constraint_force<'g>(constraints: &Constraints<'g>, sd: &[Symbol], graph: &'g Graph) -> Vec<Expr<'g>> {
    let multipliers = constraints.multipliers.iter().map(|&multiplier| graph.symbol(multiplier));
    let pairs: Vec<_> = constraints.rate.iter().copied().zip(multipliers).collect();
    if pairs.is_empty() { vec![graph.integer(0); sd.len()] } else { gradient_of_combination(&pairs, sd) }
}
