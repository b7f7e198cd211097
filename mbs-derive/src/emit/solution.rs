//! Systems of linear equations in a function's last step: accelerations, multipliers and their derivatives.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::optimise::{Function, FunctionKind, Shape};

use super::item::Emitter;
use super::name::ident;
use super::shape::shaped;

impl Emitter<'_> {
    /// `M⁻¹` of the right sides.
    pub(super) fn solved(&self, function: &Function, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
        let n = self.derivation.dof();
        let mass_matrix = shaped(Shape::Matrix(n, n), values);
        match function.results.as_slice() {
            [part] => {
                let right_side = shaped(part.shape, values);
                let solve =
                    ident(if matches!(part.shape, Shape::Vector(_)) { "ldlt_solve" } else { "ldlt_solve_many" });
                quote! {
                    let mass_matrix = #mass_matrix;
                    let right_side = #right_side;
                    ::mbs_runtime::#solve(mass_matrix, right_side)
                }
            }
            parts => {
                let solved = parts.iter().map(|part| {
                    let right_side = shaped(part.shape, values);
                    quote!(factors.solve_many(#right_side))
                });
                let solved: Vec<_> = solved.collect();
                let result = self.assembled(function, &solved);
                quote! {
                    let mass_matrix = #mass_matrix;
                    let factors = ::mbs_runtime::Ldlt::new(mass_matrix);
                    #result
                }
            }
        }
    }

    /// q̈ and λ.
    pub(super) fn constrained_solution(
        &self,
        function: &Function,
        values: &mut dyn Iterator<Item = TokenStream>,
    ) -> TokenStream {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        debug_assert_eq!(function.results[0].shape, Shape::Vector(n), "forward dynamics");
        let shapes = [Shape::Matrix(n, n), Shape::Matrix(k, n), Shape::Vector(n), Shape::Vector(k)];
        let [mass_matrix, jacobian, force, target] = shapes.map(|shape| shaped(shape, values));
        if self.derivation.constraint_vectors.iter().enumerate().all(|(row, &first)| row == first) {
            return quote!(::mbs_runtime::constrained_solve(#mass_matrix, #jacobian, #force, #target));
        }
        let vectors = self.vectors();
        quote!(::mbs_runtime::constrained_solve_vectors(#mass_matrix, #jacobian, #force, #target, #vectors))
    }

    /// The number of the vector that each row is of.
    fn vectors(&self) -> TokenStream {
        let numbers = self.derivation.constraint_vectors.iter().map(|&number| Literal::usize_unsuffixed(number));
        quote!([#(#numbers),*])
    }

    /// How large that is by which each column of a linearization is a derivative.
    pub(super) fn sizes(&self, function: &Function) -> TokenStream {
        if function.kind == FunctionKind::Linearize {
            let kinds = self.derivation.coordinate_kinds().into_iter().map(Literal::usize_unsuffixed);
            return quote!(::mbs_runtime::state_sizes(q, qd, [#(#kinds),*]));
        }
        let all = self.derivation.parameters.iter().zip(&self.names.fields).flat_map(|(parameter, field)| {
            let field = ident(field);
            match parameter.length {
                Some(length) => {
                    let place =
                        |i: usize| match parameter.columns.map(|n| [i / n, i % n].map(Literal::usize_unsuffixed)) {
                            Some([row, column]) => quote!(self.params.#field[#row][#column]),
                            None => {
                                let i = Literal::usize_unsuffixed(i);
                                quote!(self.params.#field[#i])
                            }
                        };
                    (0..length).map(place).collect::<Vec<_>>()
                }
                None => vec![quote!(self.params.#field)],
            }
        });
        quote!([#(#all),*])
    }

    /// The columns of all parts solved for at once, and taken apart.
    pub(super) fn constrained_slopes(
        &self,
        function: &Function,
        values: &mut dyn Iterator<Item = TokenStream>,
    ) -> TokenStream {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let (mass_matrix, jacobian) = (shaped(Shape::Matrix(n, n), values), shaped(Shape::Matrix(k, n), values));
        let widths: Vec<usize> = function.results.iter().map(|part| part.shape.count() / n).collect();
        let mut rows: Vec<Vec<TokenStream>> = vec![Vec::new(); n + k];
        for &width in &widths {
            rows.iter_mut().for_each(|row| row.extend((0..width).filter_map(|_| values.next())));
        }
        let (force, target) = rows.split_at(n);
        let (vectors, scale) = (self.vectors(), ident(&self.names.scale));
        let (force, target) =
            (force.iter().map(|row| quote!([#(#row),*])), target.iter().map(|row| quote!([#(#row),*])));
        let solution = quote! {
            ::mbs_runtime::constrained_slopes(
                #mass_matrix, #jacobian, [#(#force),*], [#(#target),*], #vectors, #scale.0, #scale.1
            )
        };
        if widths.len() == 1 {
            return solution;
        }
        let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
        let parts = starts.map(|start| {
            let first = (start > 0).then(|| Literal::usize_unsuffixed(start)).map(|start| quote!(#start +));
            quote!(::core::array::from_fn(|i| ::core::array::from_fn(|j| solution[i][#first j])))
        });
        let result = self.assembled(function, &parts.collect::<Vec<_>>());
        quote!(let solution = #solution; #result)
    }
}
