//! A function body as text: the arguments and constants that it reads, its statements, its expressions.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use crate::expr::{Symbol, Trigonometry};
use crate::optimise::Derivation;
use crate::variable::Variable;

use super::body::{Angle, Block, Body, FAMILIAR, Statement, familiar};
use super::expression::{self, Leaves, Tree, literal};
use super::name::{Names, ident, table};
use super::segment;

/// At most this many fields are bound to locals; of more, each is read as `self.k12`.
const FIELDS: usize = 8;

/// At most this many other constants are written out; of more, each is `c(0.295242)` with `let c = T::from_f64`.
const WRITTEN_OUT: usize = 3;

/// A body with its constants counted, ready to be printed.
pub(super) struct Text<'b, 'n> {
    body: &'b Body<'n>,
    /// Which of the familiar constants are bound.
    bound: [bool; FAMILIAR.len()],
    /// Whether other constants are `c(…)`.
    abbreviated: bool,
    /// The fields that are read.
    fields: BTreeSet<u32>,
}

impl<'b, 'n> Text<'b, 'n> {
    pub(super) fn new(body: &'b Body<'n>) -> Self {
        let (mut uses, mut others) = ([0; FAMILIAR.len()], 0);
        let mut fields = BTreeSet::new();
        each_leaf(body.block.trees().into_iter(), &mut |leaf| match leaf {
            Tree::Constant(value) => *familiar(*value).map_or(&mut others, |i| &mut uses[i]) += 1,
            Tree::Hoisted(k) => fields.extend([*k]),
            _ => {}
        });
        // `T::zero()` and `T::one()` speak for themselves.
        let is_bound = |i: usize| uses[i] > 1 || (uses[i] == 1 && !matches!(FAMILIAR[i].0, 0.0 | 1.0));
        Text { body, bound: std::array::from_fn(is_bound), abbreviated: others > WRITTEN_OUT, fields }
    }

    /// `let [x, theta] = *q;`, …: the arguments and fields that the body reads, taken apart; parameters come from
    /// `params`.
    pub(super) fn arguments(&self, derivation: &Derivation, params: &TokenStream) -> TokenStream {
        let mut symbols = BTreeSet::new();
        each_leaf(self.body.block.trees().into_iter(), &mut |leaf| {
            if let Tree::Symbol(symbol) = leaf {
                symbols.insert(*symbol);
            }
        });
        let names = self.body.names;
        let component = |symbol: Symbol| symbols.contains(&symbol).then(|| names.symbol(symbol));
        let n = derivation.dof();
        let inputs = derivation.inputs.iter().map(Variable::count).sum();
        let array = |count: usize, symbol: fn(u32) -> Symbol, argument: &str| {
            pattern((0..count).map(|i| component(symbol(i as u32)))).map(|pattern| {
                let argument = ident(argument);
                quote!(let #pattern = *#argument;)
            })
        };
        let q = array(n, Symbol::Coordinate, "q");
        let qd = array(n, Symbol::Velocity, "qd");
        let qdd = array(n, Symbol::Acceleration, "qdd");
        let u = array(inputs, Symbol::Input, "u");
        let multipliers = array(derivation.constraints.len(), Symbol::Multiplier, "multipliers");
        let signals = 0..derivation.prescribed.iter().map(Variable::count).sum::<usize>() as u32;
        let used = |i: u32| (0..3).any(|order| component(Symbol::Prescribed(i, order)).is_some());
        let prescribed = signals.clone().any(used).then(|| {
            let rows = signals.map(|i| {
                let row = pattern((0..3).map(|order| component(Symbol::Prescribed(i, order))));
                row.unwrap_or_else(|| quote!(_))
            });
            quote!(let [#(#rows),*] = *prescribed;)
        });
        let fields = self.fields.iter().map(|k| ident(&names.hoisted[*k as usize]));
        let bound = self.binds_fields() && !self.fields.is_empty();
        let own = bound.then(|| quote!(let Self { #(#fields,)* .. } = *self;));
        let parameters = parameters(derivation, names, component).map(|pattern| quote!(let #pattern = #params;));
        quote!(#q #qd #qdd #u #prescribed #multipliers #own #parameters)
    }

    fn binds_fields(&self) -> bool {
        self.fields.len() <= FIELDS
    }

    /// The tokens of an expression.
    pub(super) fn tree(&self, tree: &Tree) -> TokenStream {
        expression::print(tree, self)
    }

    /// `let half = T::from_f64(0.5);`, …
    pub(super) fn constants(&self) -> TokenStream {
        let bound = (0..FAMILIAR.len()).filter(|&i| self.bound[i]).map(|i| {
            let (local, value) = (ident(&self.body.familiar[i]), written_out(FAMILIAR[i].0));
            quote!(let #local = #value;)
        });
        let convert = ident(&self.body.convert);
        let abbreviation = self.abbreviated.then(|| quote!(let #convert = T::from_f64;));
        quote!(#(#bound)* #abbreviation)
    }

    /// A statement; locals that are `declared` before are assigned to.
    pub(super) fn statement(&self, statement: &Statement, declared: &BTreeSet<usize>) -> TokenStream {
        let binding = statement.binds().iter().all(|local| !declared.contains(local)).then(|| quote!(let));
        let locals: Vec<_> = statement.binds().into_iter().map(|i| ident(&self.body.locals[i])).collect();
        let value = self.bound(statement);
        match statement {
            Statement::SinCos(angles) => {
                let bound = |local: fn(&Angle) -> Option<usize>| {
                    let locals = angles.iter().map(|angle| local(angle).map(|i| ident(&self.body.locals[i])));
                    let locals = locals.map(|local| local.map_or_else(|| quote!(_), |local| quote!(#local)));
                    let is_read = angles.iter().any(|angle| local(angle).is_some());
                    match self.body.names.trigonometry {
                        Trigonometry::Library => quote!(#(#locals)*),
                        Trigonometry::Polynomials if is_read => quote!([#(#locals),*]),
                        Trigonometry::Polynomials => quote!(_),
                    }
                };
                let (sines, cosines) = (bound(|angle| angle.sin), bound(|angle| angle.cos));
                quote!(#binding (#sines, #cosines) = #value;)
            }
            Statement::Spline { orders, .. } => {
                let bound = (0..=orders[orders.len() - 1]).map(|order| match orders.binary_search(&order) {
                    Ok(i) => locals[i].to_token_stream(),
                    Err(_) => quote!(_),
                });
                quote!(#binding [#(#bound),*] = #value;)
            }
            Statement::Branch(..) if locals.len() > 1 => quote!(#binding [#(#locals),*] = #value;),
            Statement::Let(..) | Statement::Branch(..) => quote!(#binding #(#locals)* = #value;),
            // Without `dyn` the type of one closure would hold those of all that it asks, each in full.
            Statement::OnDemand(..) => quote! {
                let #(#locals)*: &dyn Fn() -> T = &#value;
                let #(#locals)* = ::core::cell::LazyCell::new(#(#locals)*);
            },
        }
    }

    /// What a statement binds to its locals.
    fn bound(&self, statement: &Statement) -> TokenStream {
        match statement {
            Statement::Let(_, tree) => self.tree(tree),
            Statement::SinCos(angles) => match self.body.names.trigonometry {
                Trigonometry::Library => {
                    self.tree(&Tree::Method("sin_cos", Box::new(angles[0].tree.clone()), Vec::new()))
                }
                Trigonometry::Polynomials => {
                    let angles = angles.iter().map(|angle| self.tree(&angle.tree));
                    quote!(T::sin_cos_all([#(#angles),*]))
                }
            },
            Statement::Spline { table: number, x, .. } => {
                let (table, x) = (ident(&table(*number)), self.tree(x));
                quote!(#table.derivatives(#x))
            }
            Statement::Branch(locals, condition, sides) => {
                let (condition, [then, otherwise]) =
                    (self.tree(condition), sides.each_ref().map(|side| self.block(side)));
                let select = if locals.len() > 1 { quote!(T::select_each) } else { quote!(T::select) };
                quote!(#select(#condition, || #then, || #otherwise))
            }
            Statement::OnDemand(_, block) => {
                let block = self.block(block);
                quote!(|| #block)
            }
        }
    }

    /// The expression that a closure consists of; a last statement that binds just the results goes without its `let`.
    fn block(&self, block: &Block) -> TokenStream {
        let results: Vec<Tree> = block.results.clone();
        let (statements, value) = match block.statements.split_last() {
            Some((last @ (Statement::Let(..) | Statement::Branch(..)), before))
                if last.binds().into_iter().map(Tree::Local).eq(results.iter().cloned()) =>
            {
                (before, self.bound(last))
            }
            _ => {
                let values = results.iter().map(|tree| self.tree(tree));
                (&*block.statements, if results.len() == 1 { quote!(#(#values)*) } else { quote!([#(#values),*]) })
            }
        };
        let statements = segment::statements(statements, &block.results, self);
        if statements.is_empty() { value } else { quote!({ #statements #value }) }
    }

    /// The name of a local.
    pub(super) fn local(&self, local: usize) -> &str {
        &self.body.locals[local]
    }
}

impl Leaves for Text<'_, '_> {
    fn constant(&self, value: f64) -> TokenStream {
        match familiar(value) {
            Some(i) => {
                let sign = self.is_signed(value).then(|| quote!(-));
                if self.bound[i] {
                    let name = ident(&self.body.familiar[i]);
                    quote!(#sign #name)
                } else {
                    let value = written_out(value.abs());
                    quote!(#sign #value)
                }
            }
            None if self.abbreviated => {
                let (convert, value) = (ident(&self.body.convert), number(value));
                quote!(#convert(#value))
            }
            None => written_out(value),
        }
    }

    fn is_signed(&self, value: f64) -> bool {
        value.is_sign_negative() && familiar(value).is_some()
    }

    fn leaf(&self, leaf: &Tree) -> TokenStream {
        let name = ident(self.body.name(leaf));
        match leaf {
            Tree::Hoisted(_) if !self.binds_fields() => quote!(self.#name),
            Tree::Local(_) if self.is_on_demand(leaf) => quote!(*#name),
            _ => quote!(#name),
        }
    }

    fn is_on_demand(&self, leaf: &Tree) -> bool {
        matches!(leaf, Tree::Local(local) if self.body.on_demand.contains(local))
    }

    fn is_infix(&self) -> bool {
        self.body.names.infix
    }
}

/// `T::from_f64(0.295242)`
pub(super) fn written_out(value: f64) -> TokenStream {
    if value == 0.0 && value.is_sign_positive() {
        quote!(T::zero())
    } else if value == 1.0 {
        quote!(T::one())
    } else {
        let value = number(value);
        quote!(T::from_f64(#value))
    }
}

/// A literal, or π.
pub(super) fn number(value: f64) -> TokenStream {
    if value == std::f64::consts::PI { quote!(::core::f64::consts::PI) } else { literal(value) }
}

/// Calls `found` with every leaf.
pub(super) fn each_leaf<'t>(trees: impl Iterator<Item = &'t Tree>, found: &mut impl FnMut(&'t Tree)) {
    for tree in trees {
        match tree {
            Tree::Constant(_) | Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => found(tree),
            Tree::Neg(_)
            | Tree::Add(..)
            | Tree::Sub(..)
            | Tree::Mul(..)
            | Tree::Div(..)
            | Tree::Method(..)
            | Tree::Less(..)
            | Tree::LessEqual(..)
            | Tree::And(..)
            | Tree::Not(_)
            | Tree::Select(..) => each_leaf(tree.children().into_iter(), found),
        }
    }
}

/// `[x, _]`; `None` where no component is named.
fn pattern<'a>(components: impl Iterator<Item = Option<&'a str>>) -> Option<TokenStream> {
    pattern_of(components.map(|component| component.map(|name| ident(name).to_token_stream())))
}

/// As [`pattern`], of components that are patterns themselves.
fn pattern_of(components: impl Iterator<Item = Option<TokenStream>>) -> Option<TokenStream> {
    let components: Vec<_> = components.collect();
    let read = components.iter().rposition(Option::is_some)? + 1;
    let unread = components.len() - read;
    let shown = components[..read].iter().map(|component| match component {
        Some(shown) => shown.clone(),
        None => quote!(_),
    });
    let rest = match unread {
        0 => None,
        1 => Some(quote!(_)),
        _ => Some(quote!(..)),
    };
    let shown = shown.chain(rest);
    Some(quote!([#(#shown),*]))
}

/// `Params { m, length, .. }`
fn parameters<'a>(
    derivation: &Derivation,
    names: &Names,
    component: impl Fn(Symbol) -> Option<&'a str>,
) -> Option<TokenStream> {
    let mut fields = Vec::new();
    for (parameter, field) in derivation.parameters.iter().zip(&names.fields) {
        let symbol = |i: usize| Symbol::Parameter((parameter.first + i) as u32);
        let name = ident(field);
        fields.extend(match parameter.length {
            None => component(symbol(0)).map(|local| {
                if local == field {
                    quote!(#name)
                } else {
                    let local = ident(local);
                    quote!(#name: #local)
                }
            }),
            Some(count) => {
                let row = |first: usize, n: usize| pattern((first..first + n).map(|i| component(symbol(i))));
                let pattern = match parameter.columns {
                    None => row(0, count),
                    Some(columns) => pattern_of((0..count).step_by(columns).map(|first| row(first, columns))),
                };
                pattern.map(|pattern| quote!(#name: #pattern))
            }
        });
    }
    let rest = (fields.len() < derivation.parameters.len()).then(|| quote!(..));
    (!fields.is_empty()).then(|| quote!(Params { #(#fields,)* #rest }))
}
