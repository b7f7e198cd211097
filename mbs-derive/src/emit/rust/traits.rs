//! The runtime's traits, implemented by the generated functions.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, quote};

use crate::catalogue::{Argument, FunctionKind, Trait};
use crate::optimise::{Derivation, Function};
use crate::shape::{Shape, is_large};
use crate::variable::component_names;

use super::super::Options;
use super::super::name::ident;
use super::super::walk::{Walk, selected};
use super::Module;
use super::shape::zeros;

/// Whether the module implements `mbs_runtime::Mechanism`, and with it all that this rests on: all functions of the
/// traits are generated.
pub(crate) fn implements_mechanism(derivation: &Derivation, options: &Options) -> bool {
    implemented(&selected(derivation, options.functions.as_deref())).iter().any(|(of, _)| *of == Trait::Mechanism)
}

/// The traits of the runtime all of whose functions are generated, each with these and after those that it rests on.
fn implemented<'f, 'd>(functions: &'f [(usize, &'d Function)]) -> Vec<(Trait, Vec<&'f (usize, &'d Function)>)> {
    let find = |kind: FunctionKind| functions.iter().find(|(_, f)| f.kind == kind);
    let mut implemented: Vec<(Trait, Vec<_>)> = Vec::new();
    for of in Trait::ALL {
        let is_there = |other: &Trait| implemented.iter().any(|(of, _)| of == other);
        let found = FunctionKind::of_trait(of).map(find).collect::<Option<Vec<_>>>();
        if let Some(found) = found.filter(|_| of.rests_on().iter().all(is_there)) {
            implemented.push((of, found));
        }
    }
    implemented
}

/// The names of the traits of the runtime that the module implements.
pub(super) fn names(walk: &Walk<'_>) -> Vec<&'static str> {
    let by_use = implemented(&walk.functions).into_iter().map(|(of, _)| of.name());
    by_use.chain(constrained(walk).map(|_| "Constraints")).collect()
}

/// A function with its number.
type Numbered<'d> = (usize, &'d Function);

/// Where `Constraints` finds M and A.
enum Matrices<'d> {
    /// In these functions.
    Functions([Numbered<'d>; 2]),
    /// In what is not zero of the system that is eliminated.
    Entries,
}

/// The functions that `Constraints` is made of, φ and `A q̇ + b`, and M and A, where motions are not prescribed, of
/// which it does not know.
fn constrained<'d>(walk: &Walk<'d>) -> Option<([Numbered<'d>; 2], Matrices<'d>)> {
    let find = |kind| walk.functions.iter().copied().find(|(_, function)| function.kind == kind);
    let rows = [find(FunctionKind::Constraint)?, find(FunctionKind::ConstraintRate)?];
    if !walk.derivation.prescribed.is_empty() {
        return None;
    }
    if walk.derivation.elimination.is_some() && walk.constrained().is_some() {
        return Some((rows, Matrices::Entries));
    }
    let matrices = [find(FunctionKind::MassMatrix)?, find(FunctionKind::ConstraintJacobian)?];
    Some((rows, Matrices::Functions(matrices)))
}

/// Forward dynamics, if `Constraints` finds M and A in its system.
pub(super) fn eliminated<'d>(walk: &Walk<'d>) -> Option<Numbered<'d>> {
    let (_, matrices) = constrained(walk)?;
    walk.constrained().filter(|_| matches!(matrices, Matrices::Entries))
}

impl Module<'_> {
    /// The traits by use that can be implemented.
    pub(super) fn implementations(&self) -> TokenStream {
        let traits = implemented(&self.walk.functions);
        let traits = traits.iter().map(|(of, functions)| self.implementation(*of, functions));
        quote!(#(#traits)*)
    }

    fn implementation(&self, of: Trait, functions: &[&(usize, &Function)]) -> TokenStream {
        let (name, of_runtime) = (ident(&self.walk.names.mechanism), ident(of.name()));
        let [n, inputs, _, rows] = self.walk.sizes().map(Literal::usize_unsuffixed);
        let sizes = [n, inputs, rows].into_iter().take(of.sizes());
        let items = match of {
            Trait::Dynamics => self.declared(),
            Trait::Constrained => self.rows(),
            Trait::Energies | Trait::Linearized | Trait::Mechanism => TokenStream::new(),
        };
        let functions = functions.iter().map(|function| self.forwarded(function));
        quote! {
            impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::#of_runtime<#(#sizes),*> for #name<T> {
                #items
                #(#functions)*
            }
        }
    }

    /// The types and names of `Dynamics`.
    fn declared(&self) -> TokenStream {
        let declared = &self.walk.derivation.name;
        let coordinates = component_names(&self.walk.derivation.coordinates);
        let inputs = component_names(&self.walk.derivation.inputs);
        let [n, u, signals, _] = self.walk.sizes().map(Literal::usize_unsuffixed);
        let time = match self.walk.derivation.prescribed.is_empty() {
            true => quote!(T),
            false => quote!((T, [[T; 3]; #signals])),
        };
        quote! {
            type Scalar = T;
            type Time = #time;

            const NAME: &'static str = #declared;
            const COORDINATES: [&'static str; #n] = [#(#coordinates),*];
            const INPUTS: [&'static str; #u] = [#(#inputs),*];
        }
    }

    /// The names of `Constrained`.
    fn rows(&self) -> TokenStream {
        let (names, holonomic) = (&self.walk.derivation.constraints, &self.walk.derivation.holonomic);
        let rows = Literal::usize_unsuffixed(names.len());
        quote! {
            const CONSTRAINTS: [&'static str; #rows] = [#(#names),*];
            const HOLONOMIC: [bool; #rows] = [#(#holonomic),*];
        }
    }

    /// The function of a trait, which calls the mechanism's own.
    fn forwarded(&self, (number, function): &(usize, &Function)) -> TokenStream {
        let (trait_function, inherent) = (ident(function.kind.name()), ident(&self.walk.names.functions[*number]));
        let [n, inputs, ..] = self.walk.sizes().map(Literal::usize_unsuffixed);
        let arguments = function.arguments.iter().map(|&argument| {
            let (name, length) = (ident(argument.name()), if argument == Argument::U { &inputs } else { &n });
            quote!(#name: &[T; #length])
        });
        let time = if self.walk.derivation.prescribed.is_empty() { quote!(t) } else { quote!((t, prescribed)) };
        let passed = self.walk.arguments(function).into_iter().map(|(name, _)| match name {
            "prescribed" => quote!(&prescribed),
            name => ident(name).to_token_stream(),
        });
        let shapes: Vec<Shape> = function.results.iter().map(|part| part.shape).collect();
        let result = self.result_type(function.kind, &shapes);
        let called = match is_large(shapes.iter().copied()) {
            false => quote!(self.#inherent(#(#passed),*)),
            true => {
                let zeros = zeros_of(function);
                quote! {
                    let mut result = #zeros;
                    self.#inherent(#(#passed,)* &mut result);
                    result
                }
            }
        };
        quote! {
            fn #trait_function(&self, #time: Self::Time, #(#arguments),*) -> #result {
                #called
            }
        }
    }

    /// What the runtime's `Projector` asks for, where it can be implemented.
    pub(super) fn constraints(&self) -> TokenStream {
        let derivation = self.walk.derivation;
        let Some(([position, rate], matrices)) = constrained(&self.walk) else { return TokenStream::new() };
        let [n, rows] = [derivation.dof(), derivation.constraints.len()].map(Literal::usize_unsuffixed);
        let name = ident(&self.walk.names.mechanism);
        let holonomic = &derivation.holonomic;
        let written = |(number, function): Numbered<'_>, slice: &str| {
            let (inherent, slice) = (ident(&self.walk.names.functions[number]), ident(slice));
            let passed = self.walk.arguments(function).into_iter().map(|(name, _)| ident(name));
            let (shape, is_vector) = (function.results[0].shape, matches!(function.results[0].shape, Shape::Vector(_)));
            match (is_large([shape]), is_vector) {
                (true, _) => {
                    let rows = (!is_vector).then(|| quote!(.as_chunks_mut().0));
                    let expected = shape.to_string();
                    quote!(self.#inherent(#(#passed,)* #slice #rows.first_chunk_mut().expect(#expected));)
                }
                (false, true) => quote!(#slice.copy_from_slice(&self.#inherent(#(#passed),*));),
                (false, false) => quote!(#slice.copy_from_slice(self.#inherent(#(#passed),*).as_flattened());),
            }
        };
        let (system, time) =
            (ident(&self.walk.names.constrained_system), derivation.depends_on_time.then(|| quote!(t,)));
        let system = quote!(self.#system(#time q));
        let [position, rate] = [written(position, "phi"), written(rate, "rate")];
        let [mass_matrix, jacobian] = match matrices {
            Matrices::Functions([mass_matrix, jacobian]) => [written(mass_matrix, "m"), written(jacobian, "a")],
            Matrices::Entries => [
                quote!(ELIMINATION.write_mass_matrix(&#system, #n, m);),
                quote!(ELIMINATION.write_jacobian(&#system, #n, a);),
            ],
        };
        let sized = |slice: &str| {
            let (slice, expected) = (ident(slice), format!("{} coordinates", derivation.dof()));
            quote!(let #slice = #slice.first_chunk::<#n>().expect(#expected);)
        };
        let (q, qd) = (sized("q"), sized("qd"));
        let least_change = matches!(matrices, Matrices::Entries).then(|| {
            let expected = format!("{} rows", derivation.constraints.len());
            quote! {
                fn least_change(&self, t: T, q: &[T], target: &[T], change: &mut [T]) -> ::core::option::Option<usize> {
                    #q
                    let target = target.first_chunk::<#rows>().expect(#expected);
                    let (least, rank): ([T; #n], usize) = ::mbs_runtime::sparse_least_change(&ELIMINATION, #system, *target)?;
                    change.copy_from_slice(&least);
                    ::core::option::Option::Some(rank)
                }
            }
        });
        quote! {
            impl<T: ::mbs_runtime::Real> ::mbs_runtime::Constraints<T> for #name<T> {
                fn rows(&self) -> usize {
                    #rows
                }
                fn is_holonomic(&self, row: usize) -> bool {
                    [#(#holonomic),*][row]
                }
                fn mass_matrix(&self, t: T, q: &[T], m: &mut [T]) {
                    #q
                    #mass_matrix
                }
                fn position(&self, t: T, q: &[T], phi: &mut [T]) {
                    #q
                    let qd = &[T::zero(); #n];
                    #position
                }
                fn rate(&self, t: T, q: &[T], qd: &[T], rate: &mut [T]) {
                    #q
                    #qd
                    #rate
                }
                fn jacobian(&self, t: T, q: &[T], a: &mut [T]) {
                    #q
                    #jacobian
                }
                #least_change
            }
        }
    }
}

/// What a large result of a function is before it is written.
fn zeros_of(function: &Function) -> TokenStream {
    let of_each = function.results.iter().map(|part| zeros(part.shape));
    let record = match function.kind {
        FunctionKind::Linearize => quote!(::mbs_runtime::Linearization),
        FunctionKind::InverseDynamicsJacobian => quote!(::mbs_runtime::InverseDynamicsJacobian),
        _ => return quote!(#(#of_each)*),
    };
    let names = function.results.iter().map(|part| ident(part.name));
    quote!(#record { #(#names: #of_each),* })
}
