//! What a module implements `Constraints` by.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use crate::optimise::{Function, FunctionKind};
use crate::shape::Shape;

use super::{Frame, identifier, is_written};

impl Frame<'_> {
    /// What the runtime's `Projector` asks for.
    pub(super) fn constraints(&self) -> TokenStream {
        let Some([position, rate]) = self.rows() else { return TokenStream::new() };
        let [n, k] = [self.derivation.dof(), self.derivation.constraints.len()];
        let expected = format!("{n} coordinates");
        let [n, rows] = [n, k].map(Literal::usize_unsuffixed);
        let sized = |slice: &str| {
            let slice = identifier(slice);
            quote!(let #slice = #slice.first_chunk::<#n>().expect(#expected);)
        };
        let (q, qd) = (sized("q"), sized("qd"));
        let written = |function: (&Function, &Ident), slice: &str| {
            let (slice, shape) = (identifier(slice), function.0.results[0].shape);
            let (expected, is_vector) = (shape.to_string(), matches!(shape, Shape::Vector(_)));
            let rows = (!is_vector).then(|| quote!(.as_chunks_mut().0));
            let whole = quote!(#slice #rows.first_chunk_mut().expect(#expected));
            let call = self.call(function, false, is_written(function.0).then_some(whole));
            match (is_written(function.0), is_vector) {
                (true, _) => quote!(#call;),
                (false, true) => quote!(#slice.copy_from_slice(&#call);),
                (false, false) => quote!(#slice.copy_from_slice(#call.as_flattened());),
            }
        };
        let (position, rate) = (written(position, "phi"), written(rate, "rate"));
        let by_functions = || self.find(FunctionKind::MassMatrix).zip(self.find(FunctionKind::ConstraintJacobian));
        let (mass_matrix, jacobian, least_change) = match (self.needed_system(), by_functions()) {
            (Some(system), _) => {
                let time = self.derivation.depends_on_time.then(|| quote!(t,));
                let (entries, expected) = (quote!(self.#system(#time q)), format!("{k} rows"));
                let least_change = quote! {
                    fn least_change(
                        &self, t: T, q: &[T], target: &[T], change: &mut [T]
                    ) -> ::core::option::Option<usize> {
                        #q
                        let target = target.first_chunk::<#rows>().expect(#expected);
                        let (least, rank): ([T; #n], usize) =
                            ::mbs_runtime::sparse_least_change(&ELIMINATION, #entries, *target)?;
                        change.copy_from_slice(&least);
                        ::core::option::Option::Some(rank)
                    }
                };
                let mass_matrix = quote!(ELIMINATION.write_mass_matrix(&#entries, #n, m););
                (mass_matrix, quote!(ELIMINATION.write_jacobian(&#entries, #n, a);), Some(least_change))
            }
            (None, Some((mass_matrix, jacobian))) => (written(mass_matrix, "m"), written(jacobian, "a"), None),
            (None, None) => return TokenStream::new(),
        };
        let (name, holonomic) = (self.mechanism, &self.derivation.holonomic);
        quote! {
            impl<T: ::mbs_runtime::Real> ::mbs_runtime::Constraints<T> for #name<T> {
                fn rows(&self) -> usize { #rows }
                fn is_holonomic(&self, row: usize) -> bool { [#(#holonomic),*][row] }
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

    /// The functions of φ and of `A q̇ + b`, where motions are not prescribed, of which `Constraints` does not know.
    fn rows(&self) -> Option<[(&Function, &Ident); 2]> {
        let rows = [self.find(FunctionKind::Constraint)?, self.find(FunctionKind::ConstraintRate)?];
        self.derivation.prescribed.is_empty().then_some(rows)
    }

    /// The function of what is not zero of M and A, where `Constraints` is implemented by that.
    pub(super) fn needed_system(&self) -> Option<Ident> {
        let is_needed = self.derivation.elimination.is_some() && self.motion.is_some() && self.rows().is_some();
        is_needed.then(|| self.system.cloned().unwrap_or_else(|| identifier("constrained_system")))
    }
}
