//! Long bodies in pieces.

use proc_macro2::TokenStream;
use quote::quote;

use crate::optimise::Derivation;

use super::body::{self, Body, Text};
use super::name::Names;

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
pub(super) fn split(body: Body<'_>, _name: &str, derivation: &Derivation, names: &Names) -> Segmented {
    let text = Text::new(&body, body.trees());
    let arguments = body::arguments(derivation, names, body.trees(), &quote!(self.params));
    let (constants, statements) = (text.constants(), body.statements.iter().map(|s| text.statement(s)));
    Segmented {
        statements: quote!(#arguments #constants #(#statements)*),
        results: body.results.iter().map(|tree| text.tree(tree)).collect(),
        functions: TokenStream::new(),
    }
}
