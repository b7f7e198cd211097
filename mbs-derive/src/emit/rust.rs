//! Pass 6 for Rust: [`Derivation`] → a formatted module.
//!
//! - `parameter`: its parameters and what they must satisfy;
//! - `function`: its functions, and systems that are solved for them;
//! - `traits`: the runtime's traits, implemented by them;
//! - `shape`: results, their types and values;
//! - `syntax`: how values and statements are written in Rust; `segment`: long bodies in blocks;
//!   `loops`: those of long chains in loops;
//! - `layout`: statements that need no formatting;
//! - `outline`: a long module without its function bodies, for review.
//!
//! What stands in a function, in which order, with which names, is said by the walk of `walk`, as text that is read as
//! tokens; items around it are tokens already.
//!
//! The code links mbs-runtime by absolute path and nothing else. It computes what [`interpret`](crate::interpret)
//! computes, to the bit, except where the target has a fused multiply–add. Its text depends on the derivation alone.

mod function;
mod layout;
mod loops;
mod outline;
mod parameter;
mod segment;
mod shape;
mod syntax;
#[cfg(test)]
mod tests;
mod traits;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::optimise::{Derivation, Function, FunctionKind};
use crate::variable::{Variable, component_names};

use super::name::{self, Scope, ident, table};
use super::walk::{Routine, Walk, generated_from};
use super::{Options, doc};
use syntax::{Rust, literal};
pub(crate) use traits::implements_mechanism;

/// The module of a mechanism, formatted, to be included where items may stand.
///
/// `source` is what the first line calls the declaration.
pub(crate) fn rust(derivation: &Derivation, source: &str, options: &Options) -> String {
    let module = Module::new(derivation, options);
    module.printed(&module.file(), source)
}

/// The module without the functions of the runtime's traits, which call those that are generated.
pub(crate) fn without_forwarders(derivation: &Derivation, source: &str, options: &Options) -> String {
    let module = Module::new(derivation, options);
    let mut file = module.file();
    outline::leave_out_forwarders(&mut file.items);
    module.printed(&file, source)
}

/// The module with long function bodies left out; a digest of each is in its documentation.
pub(crate) fn outline(derivation: &Derivation, source: &str, options: &Options) -> String {
    let module = Module { is_abbreviated: false, ..Module::new(derivation, options) };
    let mut file = module.file();
    outline::leave_out_forwarders(&mut file.items);
    outline::leave_out_bodies(&mut file.items);
    module.printed(&file, source)
}

/// The formatted text with comments, and an empty line between items, which the formatter does not leave.
fn spaced(text: &str) -> String {
    let begins_item = |line: &str| ["///", "#[", "pub ", "impl", "fn "].iter().any(|start| line.starts_with(start));
    let mut spaced = String::with_capacity(text.len());
    let (mut after_item, mut table) = (false, None);
    for line in text.lines() {
        if syntax::opens_table(line) {
            table = Some(line);
        }
        if let Some(begin) = table.filter(|begin| *begin != line) {
            if syntax::pack(&mut spaced, begin, line) {
                continue;
            }
            table = None;
        }
        if after_item && begins_item(line.trim_start()) {
            spaced.push('\n');
        }
        spaced.push_str(&syntax::unmarked(line));
        spaced.push('\n');
        after_item = line.trim_start() == "}";
    }
    spaced
}

/// The name of the struct: the mechanism's, escaped where that is a keyword of Rust.
pub(crate) fn type_name(derivation: &Derivation) -> String {
    name::type_name(&derivation.name)
}

/// The name of the module: the mechanism's in snake case.
pub(crate) fn module_name(derivation: &Derivation) -> String {
    name::identifier(&name::snake_case(&derivation.name))
}

/// Tokens of what the walk has written.
fn tokens(text: &str) -> TokenStream {
    text.parse().expect("the emitted text is Rust")
}

struct Module<'d> {
    walk: Walk<'d>,
    routines: Vec<Routine>,
    infix: bool,
    serde: bool,
    /// Whether names stand for statements among its tokens.
    is_abbreviated: bool,
}

impl<'d> Module<'d> {
    fn new(derivation: &'d Derivation, options: &Options) -> Self {
        let (walk, infix) = (Walk::new(derivation, "", options), options.infix);
        let routines = walk.routines(&Rust::new(&walk, infix, "self.params"));
        Module { walk, routines, infix, serde: options.serde, is_abbreviated: true }
    }

    fn file(&self) -> syn::File {
        syn::parse2(self.items()).expect("the emitted tokens are Rust")
    }

    fn printed(&self, file: &syn::File, source: &str) -> String {
        let text = layout::unabbreviated(&prettyplease::unparse(file), &self.routines);
        format!("// {}\n\n{}", generated_from(source), spaced(&text))
    }

    /// The whole module.
    fn items(&self) -> TokenStream {
        let Walk { derivation, names, .. } = &self.walk;
        let (mechanism, methods) = (self.mechanism(), self.methods());
        let (module, code) = (module_name(derivation), format!("{mechanism} {methods}"));
        let lines = self.routines.iter().flat_map(|routine| &routine.lines).map(String::as_str);
        let docs = doc::module(derivation, &module, &names.mechanism, lines.chain([code.as_str()]));
        let docs = doc::attributes(&docs);
        let (module, tables, parameters) = (ident(&module), self.tables(), self.parameters());
        let elimination = self.elimination();
        let (implementations, constraints, constants) = (self.implementations(), self.constraints(), self.constants());
        quote! {
            #docs
            #[allow(
                dead_code, non_camel_case_types, non_snake_case, non_upper_case_globals, unreachable_pub,
                unused_qualifications, unused_variables, clippy::all, clippy::pedantic, clippy::nursery, rustdoc::all
            )]
            pub mod #module {
                #tables
                #elimination
                #parameters
                #mechanism
                #methods
                #implementations
                #constraints
                #constants
            }
        }
    }

    /// The splines that tables of the model are.
    fn tables(&self) -> TokenStream {
        let list = |values: &[f64]| {
            let values: Vec<String> = values.iter().map(|&x| literal(x)).collect();
            tokens(&format!("[{}]", values.join(", ")))
        };
        let tables = self.walk.names.splines.iter().enumerate().map(|(number, spline)| {
            let (name, columns) = (ident(&table(number)), Literal::usize_unsuffixed(spline.degree() + 2));
            let (places, rows) = (list(spline.places()), spline.rows().iter().map(|row| list(row)));
            quote! {
                /// A table of the model: places, and the polynomials between them.
                const #name: ::mbs_runtime::Spline<'static, #columns> =
                    ::mbs_runtime::Spline::new(&#places, &[#(#rows),*]);
            }
        });
        quote!(#(#tables)*)
    }

    /// The struct.
    fn mechanism(&self) -> TokenStream {
        let name = ident(&self.walk.names.mechanism);
        let functions: Vec<&Function> = self.walk.functions.iter().map(|(_, f)| *f).collect();
        let mut docs = doc::mechanism(self.walk.derivation, &functions);
        let traits = traits::names(&self.walk);
        if !traits.is_empty() {
            docs.extend([String::new(), format!("Implements `{}` of mbs-runtime.", traits.join("`, `"))]);
        }
        let docs = doc::attributes(&docs);
        let hoisted = self.walk.hoisted().into_iter().map(|k| ident(&self.walk.names.hoisted[k]));
        quote! {
            #docs
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct #name<T = f64> {
                params: Params<T>,
                #(#hoisted: T,)*
            }

            impl<T: ::mbs_runtime::Scalar> ::core::default::Default for #name<T> {
                /// With the declared parameters.
                fn default() -> Self {
                    Self::new(Params::default())
                }
            }
        }
    }

    /// `new`, `try_new`, `params` and the functions.
    fn methods(&self) -> TokenStream {
        let name = ident(&self.walk.names.mechanism);
        let (new, functions) = (self.constructor(), self.functions());
        quote! {
            impl<T: ::mbs_runtime::Scalar> #name<T> {
                #new

                /// The parameters.
                pub fn params(&self) -> &Params<T> {
                    &self.params
                }

                #functions
            }
        }
    }

    fn constructor(&self) -> TokenStream {
        let (lines, hoisted) = self.walk.constructor(&self.with("params"));
        let field = |(name, value): &(String, String)| match name == value {
            true => format!("{name}, "),
            false => format!("{name}: {value}, "),
        };
        let (lines, fields) = (tokens(&lines.join("\n")), tokens(&hoisted.iter().map(field).collect::<String>()));
        quote! {
            /// With these parameters; what depends on them alone is computed here.
            ///
            /// They are not looked at: with what [`Params::check`] refuses, results may be NaN, or those of no mechanism. See
            /// [`try_new`](Self::try_new).
            pub fn new(params: Params<T>) -> Self {
                #lines
                Self { params, #fields }
            }

            /// With these parameters, if a mechanism can have them.
            ///
            /// # Errors
            /// What [`Params::check`] refuses first.
            pub fn try_new(params: Params<T>) -> ::core::result::Result<Self, ::mbs_runtime::ParameterError<T>> {
                params.check()?;
                ::core::result::Result::Ok(Self::new(params))
            }
        }
    }

    /// Names for indices, of parameters and of first integrals.
    fn constants(&self) -> TokenStream {
        let coordinates =
            indices("coordinate", "Indices of the coordinates in `q`, `qd`, `qdd`.", &self.walk.derivation.coordinates);
        let inputs = indices("input", "Indices of the inputs in `u`.", &self.walk.derivation.inputs);
        let list = |name: &str, docs: &str, entries: &[String]| {
            let (name, length) = (ident(name), Literal::usize_unsuffixed(entries.len()));
            let docs = doc::attributes(&[docs.to_string()]);
            quote!(#docs pub const #name: [&str; #length] = [#(#entries),*];)
        };
        let parameters = component_names(&self.walk.derivation.parameters);
        let has = |kind: FunctionKind| self.walk.functions.iter().any(|(_, f)| f.kind == kind);
        let parameters = (!parameters.is_empty())
            .then(|| list("PARAMETERS", "The names of the parameters, arrays flattened.", &parameters));
        let conserved = has(FunctionKind::Conserved)
            .then(|| list("CONSERVED", "What `conserved` returns.", &self.walk.derivation.conserved));
        quote!(#coordinates #inputs #parameters #conserved)
    }
}

/// A module of constants: the number of each variable's component, the range of an array's.
fn indices(name: &str, docs: &str, variables: &[Variable]) -> TokenStream {
    if variables.is_empty() {
        return TokenStream::new();
    }
    let (name, docs) = (ident(name), doc::attributes(&[docs.to_string()]));
    let mut scope = Scope::default();
    let constants = variables.iter().map(|variable| {
        let constant = ident(&scope.unique(&variable.name.to_uppercase()));
        let first = Literal::usize_unsuffixed(variable.first);
        let end = Literal::usize_unsuffixed(variable.first + variable.count());
        let docs = doc::attributes(&[format!("`{}`", variable.name)]);
        match variable.length {
            None => quote!(#docs pub const #constant: usize = #first;),
            Some(_) => quote!(#docs pub const #constant: ::core::ops::Range<usize> = #first..#end;),
        }
    });
    quote! {
        #docs
        pub mod #name {
            #(#constants)*
        }
    }
}
