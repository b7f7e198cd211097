//! `Params`: the parameters, their defaults, what they must satisfy, and how they are read.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Number;
use crate::model::requirement::Condition;
use crate::optimise::Derivation;
use crate::variable::Variable;

use super::super::doc;
use super::super::name::{Names, ident};
use super::shape::array;
use super::syntax::{number, written_out};
use super::{Module, tokens};

impl Module<'_> {
    /// `Params`, its defaults, `check`, and with serde what is read before it is checked.
    pub(super) fn parameters(&self) -> TokenStream {
        let (derivation, names, serde) = (self.walk.derivation, &self.walk.names, self.serde);
        let parameters = &derivation.parameters;
        let docs = doc::attributes(&[format!("Parameters of [`{}`].", names.mechanism)]);
        let derives = serde.then(|| serialize(&quote!(try_from = "UncheckedParams<T>")));
        let fields = fields(derivation, names, serde);
        let defaults = parameters.iter().zip(&names.fields).map(|(parameter, field)| {
            let (field, value) = (ident(field), default(parameter));
            quote!(#field: #value,)
        });
        let marked = parameters.is_empty().then(|| quote!(scalar: ::core::marker::PhantomData,));
        let check = self.check();
        let unchecked = serde.then(|| unchecked(derivation, names));
        quote! {
            #docs
            #[derive(Clone, Copy, Debug, PartialEq)]
            #derives
            pub struct Params<T = f64> { #fields }

            impl<T: ::mbs_runtime::Scalar> ::core::default::Default for Params<T> {
                /// The declared values.
                fn default() -> Self {
                    Self { #(#defaults)* #marked }
                }
            }

            #check
            #unchecked
        }
    }

    /// `check`
    fn check(&self) -> TokenStream {
        let (derivation, names) = (self.walk.derivation, &self.walk.names);
        let docs = doc::attributes(&doc::requirements(derivation));
        let finite = derivation.parameters.iter().zip(&names.fields).map(|(parameter, field)| {
        let (field, components) = (ident(field), parameter.component_names());
        let values = match parameter.columns {
            None => quote!(self.#field),
            Some(_) => quote!(self.#field.into_iter().flatten()),
        };
        match parameter.length {
            None => quote! {
                ::mbs_runtime::parameter::require(#(#components)*, self.#field, ::mbs_runtime::ParameterCondition::Finite)?;
            },
            Some(_) => quote! {
                for (name, value) in [#(#components),*].into_iter().zip(#values) {
                    ::mbs_runtime::parameter::require(name, value, ::mbs_runtime::ParameterCondition::Finite)?;
                }
            },
        }
    });
        let required = self.required();
        quote! {
            impl<T: ::mbs_runtime::Scalar> Params<T> {
                #docs
                pub fn check(&self) -> ::core::result::Result<(), ::mbs_runtime::ParameterError<T>> {
                    #(#finite)*
                    #required
                    ::core::result::Result::Ok(())
                }
            }
        }
    }

    /// The conditions on expressions of parameters.
    fn required(&self) -> TokenStream {
        let (lines, values) = self.walk.required(&self.with("*self"));
        let calls = self.walk.derivation.conditions(&values).map(|(requirement, values)| {
            let (quantity, condition) = (&requirement.quantity, condition(requirement.condition));
            let all = values.iter().map(|value| tokens(value));
            match values {
                [_] => quote!(::mbs_runtime::parameter::require(#quantity, #(#all)*, #condition)?;),
                _ => quote!(::mbs_runtime::parameter::require_inertia(#quantity, [#(#all),*], #condition)?;),
            }
        });
        let lines = tokens(&lines.join("\n"));
        quote!(#lines #(#calls)*)
    }
}

/// The fields with their documentation, and the names that they are serialized by.
fn fields(derivation: &Derivation, names: &Names, serde: bool) -> TokenStream {
    let fields = derivation.parameters.iter().zip(&names.fields).map(|(parameter, field)| {
        let docs = doc::attributes(&doc::parameter(parameter));
        let name = &parameter.name;
        let rename = (serde && field != name).then(|| quote!(#[serde(rename = #name)]));
        let (field, ty) = (ident(field), nested(&parameter.lengths()));
        quote!(#docs #rename pub #field: #ty,)
    });
    let skip = serde.then(|| quote!(#[serde(skip)]));
    let marker = derivation.parameters.is_empty().then(|| quote!(#skip scalar: ::core::marker::PhantomData<T>,));
    quote!(#(#fields)* #marker)
}

/// serde's traits, what is read being made by `how`.
fn serialize(how: &TokenStream) -> TokenStream {
    let (path, bound) = ("::mbs_runtime::serde", DESERIALIZED);
    quote! {
        #[derive(::mbs_runtime::serde::Serialize, ::mbs_runtime::serde::Deserialize)]
        #[serde(crate = #path, #how, bound(deserialize = #bound))]
    }
}

/// What the scalar must be so that parameters can be read.
const DESERIALIZED: &str = "T: ::mbs_runtime::Scalar + ::mbs_runtime::serde::Deserialize<'de>";

/// Parameters as they were read, and how those that are good become `Params`.
fn unchecked(derivation: &Derivation, names: &Names) -> TokenStream {
    let (path, bound) = ("::mbs_runtime::serde", DESERIALIZED);
    let fields = fields(derivation, names, true);
    let scalar = derivation.parameters.is_empty().then(|| ident("scalar"));
    let all: Vec<_> = names.fields.iter().map(|field| ident(field)).chain(scalar).collect();
    quote! {
        #[doc = " Parameters as they were read, not yet checked."]
        #[derive(::mbs_runtime::serde::Deserialize)]
        #[serde(crate = #path, rename = "Params", deny_unknown_fields, default, bound(deserialize = #bound))]
        struct UncheckedParams<T> { #fields }

        impl<T: ::mbs_runtime::Scalar> ::core::default::Default for UncheckedParams<T> {
            fn default() -> Self {
                let Params { #(#all),* } = Params::default();
                Self { #(#all),* }
            }
        }

        impl<T: ::mbs_runtime::Scalar> ::core::convert::TryFrom<UncheckedParams<T>> for Params<T> {
            type Error = ::mbs_runtime::ParameterError<T>;

            fn try_from(unchecked: UncheckedParams<T>) -> ::core::result::Result<Self, Self::Error> {
                let UncheckedParams { #(#all),* } = unchecked;
                let params = Self { #(#all),* };
                params.check()?;
                ::core::result::Result::Ok(params)
            }
        }
    }
}

fn condition(condition: Condition) -> TokenStream {
    let name = ident(match condition {
        Condition::Finite => "Finite",
        Condition::NotZero => "NotZero",
        Condition::NotNegative => "NotNegative",
        Condition::Positive => "Positive",
        Condition::SemiDefinite => "SemiDefinite",
        Condition::InertiaOfABody => "InertiaOfABody",
    });
    quote!(::mbs_runtime::ParameterCondition::#name)
}

/// A parameter's declared value.
fn default(parameter: &Variable) -> TokenStream {
    let values: Vec<f64> = parameter.defaults.iter().copied().map(Number::to_f64).collect();
    match (parameter.lengths().as_slice(), values.as_slice()) {
        ([], [value]) => tokens(&written_out(*value)),
        (lengths, [first, rest @ ..]) if rest.iter().all(|value| value == first) => {
            let lengths = lengths.iter().rev().map(|&n| Literal::usize_unsuffixed(n));
            lengths.fold(tokens(&written_out(*first)), |values, n| quote!([#values; #n]))
        }
        ([_, columns], values) => {
            let row = |row: &[f64]| {
                let row = row.iter().map(|value| tokens(&number(*value)));
                quote!([#(#row),*])
            };
            let rows = values.chunks(*columns).map(row);
            quote!([#(#rows),*].map(|row| row.map(T::from_f64)))
        }
        (_, values) => {
            let values = values.iter().map(|value| tokens(&number(*value)));
            quote!([#(#values),*].map(T::from_f64))
        }
    }
}

/// `T`, `[T; 3]` or `[[T; 3]; 2]`
fn nested(lengths: &[usize]) -> TokenStream {
    lengths.iter().rev().fold(quote!(T), |of, &n| array(of, n))
}
