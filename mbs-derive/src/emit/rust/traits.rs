//! The runtime's traits, implemented by the generated functions.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, quote};

use crate::catalogue::{Argument, FunctionKind, Trait};
use crate::optimise::{Derivation, Function};
use crate::shape::Shape;
use crate::variable::component_names;

use super::super::Options;
use super::super::name::ident;
use super::super::walk::selected;
use super::Module;

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
pub(super) fn names(derivation: &Derivation, functions: &[(usize, &Function)]) -> Vec<&'static str> {
    let by_use = implemented(functions).into_iter().map(|(of, _)| of.name());
    by_use.chain(constrained(derivation, functions).map(|_| "Constraints")).collect()
}

/// The functions that `Constraints` is made of, where motions are not prescribed, of which it does not know.
fn constrained<'f, 'd>(
    derivation: &Derivation,
    functions: &'f [(usize, &'d Function)],
) -> Option<[&'f (usize, &'d Function); 4]> {
    let find = |kind| functions.iter().find(|(_, function)| function.kind == kind);
    let found = [
        find(FunctionKind::MassMatrix)?,
        find(FunctionKind::Constraint)?,
        find(FunctionKind::ConstraintRate)?,
        find(FunctionKind::ConstraintJacobian)?,
    ];
    derivation.prescribed.is_empty().then_some(found)
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
        quote! {
            fn #trait_function(&self, #time: Self::Time, #(#arguments),*) -> #result {
                self.#inherent(#(#passed),*)
            }
        }
    }

    /// What the runtime's `Projector` asks for, where it can be implemented.
    pub(super) fn constraints(&self) -> TokenStream {
        let derivation = self.walk.derivation;
        let Some(found) = constrained(derivation, &self.walk.functions) else { return TokenStream::new() };
        let [n, rows] = [derivation.dof(), derivation.constraints.len()].map(Literal::usize_unsuffixed);
        let name = ident(&self.walk.names.mechanism);
        let holonomic = &derivation.holonomic;
        let call = |(number, function): &(usize, &Function)| {
            let inherent = ident(&self.walk.names.functions[*number]);
            let passed = self.walk.arguments(function).into_iter().map(|(name, _)| ident(name));
            quote!(self.#inherent(#(#passed),*))
        };
        let [mass_matrix, position, rate, jacobian] = found.map(call);
        let sized = |slice: &str| {
            let (slice, expected) = (ident(slice), format!("{} coordinates", derivation.dof()));
            quote!(let #slice = #slice.first_chunk::<#n>().expect(#expected);)
        };
        let (q, qd) = (sized("q"), sized("qd"));
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
                    m.copy_from_slice(#mass_matrix.as_flattened());
                }
                fn position(&self, t: T, q: &[T], phi: &mut [T]) {
                    #q
                    let qd = &[T::zero(); #n];
                    phi.copy_from_slice(&#position);
                }
                fn rate(&self, t: T, q: &[T], qd: &[T], rate: &mut [T]) {
                    #q
                    #qd
                    rate.copy_from_slice(&#rate);
                }
                fn jacobian(&self, t: T, q: &[T], a: &mut [T]) {
                    #q
                    a.copy_from_slice(#jacobian.as_flattened());
                }
            }
        }
    }
}
