//! Statements of a long chain by their links, and which groups of them are alike.

use std::collections::BTreeMap;

use crate::expr::{Symbol, Trigonometry};

use super::super::body::Body;
use super::super::expression::Tree;
use super::super::statement::Statement;

/// What groups of one statement each are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sink {
    Angles,
    Results,
}

/// Statements of one link; or one angle, or one result.
pub(super) struct Group {
    /// That of the link, of the angle, or of the result.
    pub(super) number: i64,
    pub(super) sink: Option<Sink>,
    pub(super) bindings: Vec<(usize, Tree)>,
    /// The number of the first group whose statements are the same but for what differs between links.
    pub(super) kind: usize,
    /// What may differ: leaves that are no locals of the group.
    pub(super) leaves: Vec<Tree>,
}

/// Where a local is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// By a statement of a group.
    Binding(usize, usize),
    /// As the sine (0) or the cosine (1) of an angle.
    OfAngle(usize, i64),
}

/// A body in groups.
pub(super) struct Groups {
    pub(super) all: Vec<Group>,
    /// Before which group sines and cosines are computed.
    pub(super) sines_at: Option<usize>,
    /// The locals of the sine and the cosine of each angle.
    pub(super) angles: Vec<[Option<usize>; 2]>,
    pub(super) homes: BTreeMap<usize, Home>,
}

impl Groups {
    /// `None` where there are branches, or sines of the library, which no call computes for many angles.
    pub(super) fn of(body: &Body<'_>) -> Option<Groups> {
        let mut groups = Groups { all: Vec::new(), sines_at: None, angles: Vec::new(), homes: BTreeMap::new() };
        let is_library = body.names.trigonometry == Trigonometry::Library;
        let mut next = body.locals.len();
        let mut single = |number: usize, sink, tree: &Tree| {
            next += 1;
            Group::new(number as i64, Some(sink), (next - 1, tree.clone()))
        };
        for statement in &body.block.statements {
            match statement {
                Statement::Let(local, tree) => {
                    let is_last = groups.sines_at != Some(groups.all.len());
                    let open = groups.all.last_mut().filter(|group| is_last && group.sink.is_none());
                    let link = body.links[*local].map(|link| link as i64);
                    let binding = (*local, tree.clone());
                    match open.filter(|group| link.is_none_or(|link| link == group.number)) {
                        Some(group) => group.bindings.push(binding),
                        None => groups.all.push(Group::new(link.unwrap_or(0), None, binding)),
                    }
                }
                Statement::SinCos(angles) if groups.sines_at.is_none() && !is_library => {
                    let of_angles = angles.iter().enumerate().map(|(k, angle)| single(k, Sink::Angles, &angle.tree));
                    groups.all.extend(of_angles);
                    groups.sines_at = Some(groups.all.len());
                    groups.angles = angles.iter().map(|angle| [angle.sin, angle.cos]).collect();
                }
                Statement::SinCos(_) | Statement::Spline { .. } | Statement::Branch(..) | Statement::OnDemand(..) => {
                    return None;
                }
            }
        }
        let results = body.block.results.iter().enumerate().map(|(k, tree)| single(k, Sink::Results, tree));
        groups.all.extend(results);
        groups.find_homes();
        groups.find_kinds();
        Some(groups)
    }

    fn find_homes(&mut self) {
        for (k, locals) in self.angles.iter().enumerate() {
            for (which, local) in locals.iter().enumerate() {
                self.homes.extend(local.map(|local| (local, Home::OfAngle(which, k as i64))));
            }
        }
        for (number, group) in self.all.iter().enumerate() {
            let home = |(at, (local, _)): (usize, &(usize, Tree))| (*local, Home::Binding(number, at));
            self.homes.extend(group.bindings.iter().enumerate().map(home));
        }
    }

    /// The kinds of all groups, and their leaves.
    fn find_kinds(&mut self) {
        let mut kinds: BTreeMap<Vec<Token>, usize> = BTreeMap::new();
        for number in 0..self.all.len() {
            let (mut shape, mut leaves) = (Vec::new(), Vec::new());
            let bindings = &self.all[number].bindings;
            match self.statement_of(number) {
                Some((_, at)) => {
                    shape.push(Token::Statement(at));
                    leaves.push(bindings[0].1.clone());
                }
                None => {
                    let own = |local: usize| match self.homes.get(&local) {
                        Some(Home::Binding(home, at)) if *home == number => Some(*at),
                        _ => None,
                    };
                    bindings.iter().for_each(|(_, tree)| describe(tree, &own, &mut shape, &mut leaves));
                }
            }
            self.all[number].kind = *kinds.entry(shape).or_insert(number);
            self.all[number].leaves = leaves;
        }
    }

    /// The group and the number of the statement whose value an angle or a result is, if it is nothing else.
    pub(super) fn statement_of(&self, group: usize) -> Option<(usize, usize)> {
        let Group { sink: Some(_), bindings, .. } = &self.all[group] else { return None };
        let [(_, Tree::Local(local))] = bindings.as_slice() else { return None };
        match self.homes.get(local) {
            Some(&Home::Binding(home, at)) => Some((home, at)),
            _ => None,
        }
    }

    /// Whether a local has its value before a group.
    pub(super) fn is_bound_before(&self, local: usize, group: usize) -> bool {
        match self.homes[&local] {
            Home::Binding(home, _) => home < group,
            Home::OfAngle(..) => self.sines_at.is_some_and(|sines_at| sines_at <= group),
        }
    }
}

impl Group {
    fn new(number: i64, sink: Option<Sink>, binding: (usize, Tree)) -> Self {
        Group { number, sink, bindings: vec![binding], kind: 0, leaves: Vec::new() }
    }
}

/// A part of what statements are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Token {
    Operation(&'static str),
    /// The local that this statement of the group binds.
    Own(usize),
    /// One of another group.
    Other,
    /// The value of this statement of another group.
    Statement(usize),
    Number,
    /// Component of an argument.
    Argument(&'static str),
    /// A parameter, or what depends on parameters alone.
    Given,
    /// What is the same for all links.
    Symbol(Symbol),
}

/// Adds what a tree is to a shape, and what may differ to the leaves.
fn describe(tree: &Tree, own: &dyn Fn(usize) -> Option<usize>, shape: &mut Vec<Token>, leaves: &mut Vec<Tree>) {
    let token = match tree {
        Tree::Constant(_) => Token::Number,
        Tree::Hoisted(_) | Tree::Symbol(Symbol::Parameter(_)) => Token::Given,
        Tree::Symbol(symbol) => argument(*symbol).map_or(Token::Symbol(*symbol), |(name, _)| Token::Argument(name)),
        Tree::Local(local) => own(*local).map_or(Token::Other, Token::Own),
        Tree::Neg(_) => Token::Operation("-a"),
        Tree::Add(..) => Token::Operation("+"),
        Tree::Sub(..) => Token::Operation("-"),
        Tree::Mul(..) => Token::Operation("*"),
        Tree::Div(..) => Token::Operation("/"),
        Tree::Method(name, ..) => Token::Operation(name),
        Tree::Less(..) => Token::Operation("<"),
        Tree::LessEqual(..) => Token::Operation("<="),
        Tree::And(..) => Token::Operation("&"),
        Tree::Not(_) => Token::Operation("!"),
        Tree::Select(..) => Token::Operation("if"),
    };
    shape.push(token);
    if matches!(token, Token::Other | Token::Number | Token::Argument(_) | Token::Given) {
        leaves.push(tree.clone());
    }
    tree.children().into_iter().for_each(|child| describe(child, own, shape, leaves));
}

/// The argument that a symbol is a component of, and its number there.
pub(super) fn argument(symbol: Symbol) -> Option<(&'static str, i64)> {
    match symbol {
        Symbol::Coordinate(i) => Some(("q", i64::from(i))),
        Symbol::Velocity(i) => Some(("qd", i64::from(i))),
        Symbol::Acceleration(i) => Some(("qdd", i64::from(i))),
        Symbol::Input(i) => Some(("u", i64::from(i))),
        Symbol::Multiplier(i) => Some(("multipliers", i64::from(i))),
        Symbol::Time | Symbol::Parameter(_) | Symbol::Prescribed(..) => None,
    }
}
