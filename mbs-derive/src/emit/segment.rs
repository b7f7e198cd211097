//! Long bodies in pieces.
//!
//! Each `let` opens a scope in the one before, and the compiler recurses over scopes: on x86-64 Linux rustc 1.95 in debug
//! mode overflows its stack at 3400 of them (the linearization of an 18-link pendulum) and does not at 2200 (that of a
//! six-joint arm). Its time in release mode is proportional to the number of operations up to some 30 000 in a function
//! (1.1 s), and more than that beyond (73 000: 4.0 s instead of 2.4 s).
//!
//! So a body of more than [`LONGEST`] statements becomes several functions, which leave what others need in an array.

use std::collections::BTreeMap;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use crate::optimise::Derivation;

use super::body::{self, Body, Statement, Text, each_leaf};
use super::doc;
use super::expression::Tree;
use super::name::{Names, ident};

/// Statements in one function.
const LONGEST: usize = 1000;

/// What the pieces have in common.
pub(super) struct Frame<'a> {
    pub(super) derivation: &'a Derivation,
    pub(super) names: &'a Names,
    /// The name of the function.
    pub(super) function: &'a str,
    /// Whether it is a method; the constructor is not.
    pub(super) is_method: bool,
    /// Names and types of what the statements read.
    pub(super) arguments: Vec<(Ident, TokenStream)>,
}

/// A body, printed.
pub(super) struct Segmented {
    /// What comes before the result.
    pub(super) statements: TokenStream,
    /// The components of the result.
    pub(super) results: Vec<TokenStream>,
    /// The functions that the statements call.
    pub(super) functions: TokenStream,
}

/// Prints a body, in pieces if it is long.
pub(super) fn split(body: Body<'_>, frame: &Frame<'_>) -> Segmented {
    if body.statements.len() <= LONGEST { whole(&body, frame) } else { Split::new(body.bound(), frame).print() }
}

impl Frame<'_> {
    /// Where the parameters are.
    fn parameters(&self) -> TokenStream {
        if self.is_method { quote!(self.params) } else { quote!(params) }
    }
}

fn whole(body: &Body<'_>, frame: &Frame<'_>) -> Segmented {
    let text = Text::new(body, body.trees(), BTreeMap::new());
    let arguments = body::arguments(frame.derivation, frame.names, body.trees(), &frame.parameters());
    let (constants, statements) = (text.constants(), body.statements.iter().map(|s| text.statement(s)));
    Segmented {
        statements: quote!(#arguments #constants #(#statements)*),
        results: body.results.iter().map(|tree| text.tree(tree)).collect(),
        functions: TokenStream::new(),
    }
}

struct Split<'f, 'n> {
    frame: &'f Frame<'f>,
    body: Body<'n>,
    /// Statements in a piece, the last one aside.
    length: usize,
    /// Where the locals are that other pieces than their own need, by their numbers.
    places: BTreeMap<usize, usize>,
}

impl<'f, 'n> Split<'f, 'n> {
    fn new(body: Body<'n>, frame: &'f Frame<'f>) -> Self {
        let count = body.statements.len();
        let length = count.div_ceil(count.div_ceil(LONGEST));
        let mut pieces = vec![0; body.locals.len()];
        for (i, statement) in body.statements.iter().enumerate() {
            statement.binds().for_each(|local| pieces[local] = i / length);
        }
        let mut shared = Vec::new();
        for (i, statement) in body.statements.iter().enumerate() {
            each_local(statement.tree(), |local| shared.extend((pieces[local] != i / length).then_some(local)));
        }
        body.results.iter().for_each(|tree| each_local(tree, |local| shared.push(local)));
        shared.sort_unstable();
        shared.dedup();
        let places = shared.into_iter().enumerate().map(|(place, local)| (local, place)).collect();
        Split { frame, body, length, places }
    }

    fn print(&self) -> Segmented {
        let pieces: Vec<&[Statement]> = self.body.statements.chunks(self.length).collect();
        let name = |i: usize| ident(&format!("{}_part_{}", self.frame.function, i + 1));
        let place_count = Literal::usize_unsuffixed(self.places.len());
        let passed: Vec<&Ident> = self.frame.arguments.iter().map(|(name, _)| name).collect();
        let receiver = if self.frame.is_method { quote!(self.) } else { quote!(Self::) };
        let calls = (0..pieces.len()).map(|i| {
            let name = name(i);
            quote!(#receiver #name(#(#passed,)* &mut shared);)
        });
        let functions = pieces.iter().enumerate().map(|(i, piece)| {
            let docs = format!("Part {} of {} of [`{2}`](Self::{2}).", i + 1, pieces.len(), self.frame.function);
            let (docs, name, body) = (doc::attributes(&[docs]), name(i), self.piece(piece));
            let receiver = self.frame.is_method.then(|| quote!(&self,));
            let arguments = self.frame.arguments.iter().map(|(name, ty)| quote!(#name: #ty,));
            quote! {
                #docs
                #[inline(never)]
                fn #name(#receiver #(#arguments)* shared: &mut [T; #place_count]) {
                    #body
                }
            }
        });
        let results = &self.body.results;
        let text = Text::new(&self.body, results.iter(), self.places.clone());
        let (constants, frame) = (text.constants(), self.frame);
        let arguments = body::arguments(frame.derivation, frame.names, results.iter(), &frame.parameters());
        Segmented {
            statements: quote!(#arguments #constants let mut shared = [T::zero(); #place_count]; #(#calls)*),
            results: results.iter().map(|tree| text.tree(tree)).collect(),
            functions: quote!(#(#functions)*),
        }
    }

    /// One piece: what it reads, its statements, what it leaves.
    fn piece(&self, statements: &[Statement]) -> TokenStream {
        let trees = || statements.iter().map(Statement::tree);
        let text = Text::new(&self.body, trees(), BTreeMap::new());
        let arguments = body::arguments(self.frame.derivation, self.frame.names, trees(), &self.frame.parameters());
        let own: Vec<usize> = statements.iter().flat_map(Statement::binds).collect();
        let is_own = |local: &usize| own.binary_search(local).is_ok();
        let mut read = Vec::new();
        trees().for_each(|tree| each_local(tree, |local| read.push(local)));
        read.sort_unstable();
        read.dedup();
        let place = |local: &usize| Literal::usize_unsuffixed(self.places[local]);
        let reads = read.iter().filter(|local| !is_own(local)).map(|local| {
            let (name, place) = (ident(&self.body.locals[*local]), place(local));
            quote!(let #name = shared[#place];)
        });
        let leaves = own.iter().filter(|local| self.places.contains_key(local)).map(|local| {
            let (name, place) = (ident(&self.body.locals[*local]), place(local));
            quote!(shared[#place] = #name;)
        });
        let (constants, statements) = (text.constants(), statements.iter().map(|s| text.statement(s)));
        quote!(#arguments #constants #(#reads)* #(#statements)* #(#leaves)*)
    }
}

fn each_local(tree: &Tree, mut found: impl FnMut(usize)) {
    each_leaf(std::iter::once(tree), &mut |leaf| {
        if let Tree::Local(local) = leaf {
            found(*local);
        }
    });
}
