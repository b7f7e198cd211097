//! The runtime's traits, implemented by the generated functions.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::catalogue::{Argument, FunctionKind, Trait};
use crate::optimise::{Derivation, Function};
use crate::variable::component_names;

use super::item::{Emitter, selected};
use super::name::ident;
use super::{Options, doc};

/// Whether the module implements the trait `Mechanism`, and with it all that this rests on.
pub(super) fn implements_mechanism(derivation: &Derivation, options: &Options) -> bool {
    of_trait(derivation, &selected(derivation, options.functions.as_deref())).is_some()
}

/// The functions of the trait, where all of them are generated and none takes more than the trait gives.
fn of_trait<'f, 'd>(
    derivation: &Derivation,
    functions: &'f [(usize, &'d Function)],
) -> Option<Vec<&'f (usize, &'d Function)>> {
    let find = |kind: FunctionKind| functions.iter().find(|(_, f)| f.kind == kind);
    let found = || FunctionKind::of_trait(Trait::Mechanism).map(find).collect::<Option<Vec<_>>>();
    derivation.prescribed.is_empty().then(found).flatten()
}

impl Emitter<'_> {
    /// The trait, where it can be implemented.
    pub(super) fn implementation(&self) -> TokenStream {
        let Some(functions) = of_trait(self.derivation, &self.functions) else { return TokenStream::new() };
        let (n, u) = (self.derivation.dof(), self.inputs());
        let name = ident(&self.names.mechanism);
        let declared = &self.derivation.name;
        let coordinates = component_names(&self.derivation.coordinates);
        let inputs = component_names(&self.derivation.inputs);
        let [n_literal, u_literal] = [n, u].map(Literal::usize_unsuffixed);
        let forwards = functions.into_iter().map(|(number, function)| {
            let trait_function = ident(function.kind.name());
            let inherent = ident(&self.names.functions[*number]);
            let arguments = function.arguments.iter().map(|&argument| {
                let length = if argument == Argument::U { &u_literal } else { &n_literal };
                let name = ident(doc::argument(argument));
                quote!(#name: &[T; #length])
            });
            let passed = self.arguments(function).into_iter().map(|(name, _)| name);
            let result = self.result_type(function);
            quote! {
                fn #trait_function(&self, t: T, #(#arguments),*) -> #result {
                    self.#inherent(#(#passed),*)
                }
            }
        });
        quote! {
            impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::Mechanism<#n_literal, #u_literal> for #name<T> {
                type Scalar = T;

                const NAME: &'static str = #declared;
                const COORDINATES: [&'static str; #n_literal] = [#(#coordinates),*];
                const INPUTS: [&'static str; #u_literal] = [#(#inputs),*];

                #(#forwards)*
            }
        }
    }

    /// What the runtime's `Projector` asks for, where it can be implemented.
    pub(super) fn constraints(&self) -> TokenStream {
        let derivation = self.derivation;
        let find = |kind| self.functions.iter().find(|(_, function)| function.kind == kind);
        let found = [
            FunctionKind::MassMatrix,
            FunctionKind::Constraint,
            FunctionKind::ConstraintRate,
            FunctionKind::ConstraintJacobian,
        ]
        .map(find);
        let [Some(mass_matrix), Some(position), Some(rate), Some(jacobian)] = found else { return TokenStream::new() };
        if !derivation.prescribed.is_empty() {
            return TokenStream::new();
        }
        let [n, rows] = [derivation.dof(), derivation.constraints.len()].map(Literal::usize_unsuffixed);
        let name = ident(&self.names.mechanism);
        let holonomic = &derivation.holonomic;
        let call = |(number, function): &(usize, &Function)| {
            let inherent = ident(&self.names.functions[*number]);
            let passed = self.arguments(function).into_iter().map(|(name, _)| name);
            quote!(self.#inherent(#(#passed),*))
        };
        let [mass_matrix, position, rate, jacobian] = [mass_matrix, position, rate, jacobian].map(call);
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
