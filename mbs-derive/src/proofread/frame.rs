//! What stands around functions: types, signatures, traits, constants. It is written once more from the derivation,
//! with the identifiers that the text has where they spell the names of the declaration, and compared line by line.

mod constraints;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{ToTokens, quote};
use syn::ext::IdentExt;
use syn::{ImplItem, ImplItemFn, Item};

use crate::catalogue::Trait;
use crate::optimise::{Argument, Derivation, Derived, Function, FunctionKind};
use crate::shape::{Shape, is_large};
use crate::variable::{Variable, component_names, count};

use super::Proofreader;
use super::reading::Reading;
use super::rust::body_of;

/// Whether an identifier is how a name is written: as it is; where that cannot be or is taken, with something behind.
pub(super) fn spells(identifier: &str, name: &str, is_taken: bool) -> bool {
    let plain = identifier.strip_prefix("r#").unwrap_or(identifier);
    let is_possible = syn::parse_str::<Ident>(name).is_ok();
    let start: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let start = if start.starts_with(|c: char| c.is_ascii_digit()) { format!("_{start}") } else { start };
    plain == name || ((is_taken || !is_possible) && plain.starts_with(&start))
}

impl<'d> Proofreader<'d> {
    /// The fields of `Params`, which spell the names of the parameters.
    pub(super) fn parameters(&self, items: &[Item]) -> Reading<Vec<Ident>> {
        let mut fields = fields(items, |name| name == "Params");
        if self.derivation.parameters.is_empty() {
            fields.clear();
        }
        let names: Vec<&str> = self.derivation.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        all_spell(&fields, &names)?;
        Ok(fields)
    }

    /// Everything but the bodies with arithmetic.
    pub(super) fn frame(&self, items: &[Item], functions: &[&'d Function], methods: &[&ImplItemFn]) -> Reading<()> {
        let mechanism = mechanism(items).ok_or("there is no mechanism")?;
        if !mechanism.unraw().to_string().starts_with(&self.derivation.name) {
            return Err(format!("`{mechanism}` is not `{}`", self.derivation.name));
        }
        let frame = Frame {
            derivation: self.derivation,
            mechanism,
            parameters: &self.fields,
            fields: fields_of_the_mechanism(items),
            functions: functions.iter().copied().zip(methods.iter().map(|method| &method.sig.ident)).collect(),
            motion: methods.get(functions.len()).map(|motion| &motion.sig.ident),
            system: methods.get(functions.len() + 1).map(|system| &system.sig.ident),
        };
        let expected = frame.module(self.options.serde, &indices_of(items)?);
        let expected = syn::parse2(expected).map_err(|error| error.to_string())?;
        let found = syn::File {
            shebang: None,
            frontmatter: None,
            attrs: Vec::new(),
            items: items.iter().filter_map(without_bodies).collect(),
        };
        let [found, expected] = [found, expected].map(|file: syn::File| prettyplease::unparse(&file));
        if found == expected {
            return Ok(());
        }
        let (mut found, mut expected) = (found.lines(), expected.lines());
        loop {
            let (found, expected) = (found.next(), expected.next());
            if found != expected {
                let [found, expected] = [found, expected].map(|line| line.unwrap_or_default().trim());
                return Err(format!("`{found}` instead of `{expected}`"));
            }
        }
    }
}

/// An error unless each identifier spells its name.
fn all_spell(identifiers: &[Ident], names: &[&str]) -> Reading<()> {
    if identifiers.len() != names.len() {
        return Err(format!("{} names instead of {}", identifiers.len(), names.len()));
    }
    for (i, (identifier, name)) in identifiers.iter().zip(names).enumerate() {
        if !spells(&identifier.to_string(), name, names[..i].contains(name)) {
            return Err(format!("`{identifier}` instead of `{name}`"));
        }
    }
    Ok(())
}

/// The name of the mechanism, whose struct is the last one.
fn mechanism(items: &[Item]) -> Option<&Ident> {
    items.iter().rev().find_map(|item| match item {
        Item::Struct(found) => Some(&found.ident),
        _ => None,
    })
}

/// The fields of the mechanism.
pub(super) fn fields_of_the_mechanism(items: &[Item]) -> Vec<Ident> {
    let mechanism = mechanism(items);
    fields(items, |name| Some(name) == mechanism)
}

/// The fields of a struct.
fn fields(items: &[Item], is_it: impl Fn(&Ident) -> bool) -> Vec<Ident> {
    let found = items.iter().find_map(|item| match item {
        Item::Struct(found) if is_it(&found.ident) => Some(found),
        _ => None,
    });
    found.into_iter().flat_map(|found| &found.fields).filter_map(|field| field.ident.clone()).collect()
}

/// The identifiers of indices: of coordinates, then of inputs.
fn indices_of(items: &[Item]) -> Reading<[Vec<Ident>; 2]> {
    let of = |name: &str| {
        let inner = items.iter().find_map(|item| match item {
            Item::Mod(module) if module.ident == name => module.content.as_ref(),
            _ => None,
        });
        let constants = inner.into_iter().flat_map(|(_, items)| items).map(|item| match item {
            Item::Const(constant) => Ok(constant.ident.clone()),
            other => Err(format!("`{}` is no index", compact(other))),
        });
        constants.collect::<Reading<Vec<Ident>>>()
    };
    Ok([of("coordinate")?, of("input")?])
}

/// An item without its attributes and without the names of bodies that were cut; `None` of a table.
fn without_bodies(item: &Item) -> Option<Item> {
    let mut item = match item {
        Item::Const(table) if !matches!(&*table.ty, syn::Type::Array(_)) => return None,
        Item::Impl(block) => {
            let stripped = |item: &ImplItem| match item {
                ImplItem::Fn(function) if body_of(&function.block).is_some() => ImplItem::Fn(ImplItemFn {
                    attrs: Vec::new(),
                    vis: function.vis.clone(),
                    modifiers: function.modifiers.clone(),
                    sig: function.sig.clone(),
                    block: syn::parse_quote!({}),
                }),
                ImplItem::Fn(function) => ImplItem::Fn(ImplItemFn { attrs: Vec::new(), ..function.clone() }),
                other => other.clone(),
            };
            let items = block.items.iter().map(stripped).collect();
            let mut bare = syn::ItemImpl {
                attrs: Vec::new(),
                modifiers: block.modifiers.clone(),
                unsafety: block.unsafety,
                impl_token: block.impl_token,
                generics: block.generics.clone(),
                trait_: block.trait_.clone(),
                self_ty: block.self_ty.clone(),
                brace_token: block.brace_token,
                items: Vec::new(),
            };
            bare.items = items;
            return Some(Item::Impl(bare));
        }
        other => other.clone(),
    };
    match &mut item {
        Item::Struct(item) => {
            item.attrs.clear();
            item.fields.iter_mut().for_each(|field| field.attrs.clear());
        }
        Item::Const(item) => item.attrs.clear(),
        Item::Mod(module) => {
            module.attrs.clear();
            for item in module.content.iter_mut().flat_map(|(_, items)| items) {
                if let Item::Const(constant) = item {
                    constant.attrs.clear();
                }
            }
        }
        _ => {}
    }
    Some(item)
}

/// What a module is made of.
struct Frame<'f> {
    derivation: &'f Derivation,
    mechanism: &'f Ident,
    /// The fields of `Params`.
    parameters: &'f [Ident],
    /// The fields of the mechanism.
    fields: Vec<Ident>,
    functions: Vec<(&'f Function, &'f Ident)>,
    /// The motion with constraints.
    motion: Option<&'f Ident>,
    /// What is not zero of M and A, where they are eliminated in a known order.
    system: Option<&'f Ident>,
}

impl Frame<'_> {
    fn module(&self, serde: bool, indices: &[Vec<Ident>; 2]) -> TokenStream {
        let (name, parameters) = (self.mechanism, self.parameter_items(serde));
        let hoisted = self.fields.iter().skip(1);
        let methods = self.methods();
        let traits = self.traits();
        let constraints = self.constraints();
        let constants = self.constants(indices);
        quote! {
            #parameters
            pub struct #name<T = f64> { params: Params<T>, #(#hoisted: T,)* }
            impl<T: ::mbs_runtime::Scalar> ::core::default::Default for #name<T> {
                fn default() -> Self {
                    Self::new(Params::default())
                }
            }
            impl<T: ::mbs_runtime::Scalar> #name<T> { #methods }
            #traits
            #constraints
            #constants
        }
    }

    fn parameter_items(&self, serde: bool) -> TokenStream {
        let types = self.derivation.parameters.iter().map(|parameter| arrays(&parameter.lengths()));
        let fields: Vec<_> = self.parameters.iter().zip(types).map(|(field, ty)| quote!(pub #field: #ty)).collect();
        let marker = fields.is_empty().then(|| quote!(scalar: ::core::marker::PhantomData<T>,));
        let scalar = fields.is_empty().then(|| quote!(scalar));
        let all: Vec<_> = self.parameters.iter().map(ToTokens::to_token_stream).chain(scalar).collect();
        let unchecked = serde.then(|| {
            quote! {
                struct UncheckedParams<T> { #(#fields,)* #marker }
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
        });
        quote! {
            pub struct Params<T = f64> { #(#fields,)* #marker }
            impl<T: ::mbs_runtime::Scalar> ::core::default::Default for Params<T> {
                fn default() -> Self {}
            }
            impl<T: ::mbs_runtime::Scalar> Params<T> {
                pub fn check(&self) -> ::core::result::Result<(), ::mbs_runtime::ParameterError<T>> {}
            }
            #unchecked
        }
    }

    fn methods(&self) -> TokenStream {
        let functions = self.functions.iter().map(|(function, name)| {
            let (arguments, result) = (self.arguments(function), self.result(function));
            match is_written(function) {
                true => quote!(pub fn #name(&self, #arguments, result: &mut #result) {}),
                false => quote!(pub fn #name(&self, #arguments) -> #result {}),
            }
        });
        let forward_dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        let motion = self.motion.zip(forward_dynamics).map(|(name, function)| {
            let arguments = self.arguments(function);
            let [n, rows] = [self.derivation.dof(), self.derivation.constraints.len()].map(Literal::usize_unsuffixed);
            quote!(fn #name(&self, #arguments) -> ([T; #n], [T; #rows]) {})
        });
        let system = self.needed_system().zip(self.derivation.elimination.as_ref()).map(|(name, elimination)| {
            let time = self.derivation.depends_on_time.then(|| quote!(t: T,));
            let (q, entries) = (self.argument(Argument::Q), several(&quote!(T), elimination.entries.len()));
            quote!(fn #name(&self, #time #q) -> #entries {})
        });
        quote! {
            pub fn new(params: Params<T>) -> Self {}
            pub fn try_new(params: Params<T>) -> ::core::result::Result<Self, ::mbs_runtime::ParameterError<T>> {
                params.check()?;
                ::core::result::Result::Ok(Self::new(params))
            }
            pub fn params(&self) -> &Params<T> {
                &self.params
            }
            #(#functions)*
            #motion
            #system
        }
    }

    /// How many components an argument has.
    fn count(&self, argument: Argument) -> usize {
        match argument {
            Argument::Q | Argument::Qd | Argument::Qdd => self.derivation.dof(),
            Argument::U => count(&self.derivation.inputs),
            Argument::Multipliers => self.derivation.constraints.len(),
        }
    }

    /// The arguments that a function has; without inputs it has none of them.
    fn taken(&self, function: &Function) -> Vec<Argument> {
        let is_there = |argument: &Argument| *argument != Argument::U || self.count(*argument) > 0;
        function.arguments.iter().copied().filter(is_there).collect()
    }

    fn arguments(&self, function: &Function) -> TokenStream {
        let time = self.derivation.depends_on_time.then(|| quote!(t: T,));
        let signals = count(&self.derivation.prescribed);
        let length = Literal::usize_unsuffixed(signals);
        let prescribed = (signals > 0).then(|| quote!(prescribed: &[[T; 3]; #length],));
        let state = self.taken(function).into_iter().map(|argument| self.argument(argument));
        quote!(#time #prescribed #(#state),*)
    }

    fn argument(&self, argument: Argument) -> TokenStream {
        let (name, length) = (identifier(argument.name()), Literal::usize_unsuffixed(self.count(argument)));
        quote!(#name: &[T; #length])
    }

    fn result(&self, function: &Function) -> TokenStream {
        let [n, inputs] = [self.derivation.dof(), self.count(Argument::U)].map(Literal::usize_unsuffixed);
        match (function.kind, function.results.as_slice()) {
            (FunctionKind::Linearize, _) => quote!(::mbs_runtime::Linearization<T, #n, #inputs>),
            (FunctionKind::InverseDynamicsJacobian, _) => quote!(::mbs_runtime::InverseDynamicsJacobian<T, #n>),
            (_, [part]) => type_of(part.shape),
            (_, parts) => {
                let parts = parts.iter().map(|part| type_of(part.shape));
                quote!((#(#parts),*))
            }
        }
    }

    /// A call of a function by another one that has its arguments, and storage for its result if that is written.
    fn call(
        &self,
        (function, name): (&Function, &Ident),
        is_by_a_trait: bool,
        storage: Option<TokenStream>,
    ) -> TokenStream {
        let time = self.derivation.depends_on_time.then(|| quote!(t,));
        let reference = is_by_a_trait.then(|| quote!(&));
        let prescribed = (!self.derivation.prescribed.is_empty()).then(|| quote!(#reference prescribed,));
        let state = self.taken(function).into_iter().map(|argument| identifier(argument.name()));
        let arguments = quote!(#time #prescribed #(#state),*);
        match storage {
            Some(storage) => quote!(self.#name(#arguments, #storage)),
            None => quote!(self.#name(#arguments)),
        }
    }

    fn find(&self, kind: FunctionKind) -> Option<(&Function, &Ident)> {
        self.functions.iter().find(|(function, _)| function.kind == kind).map(|(function, name)| (*function, *name))
    }

    /// The traits of the runtime whose functions are all there.
    fn traits(&self) -> TokenStream {
        let mut there: Vec<Trait> = Vec::new();
        let mut implementations = Vec::new();
        for of in Trait::ALL {
            let functions: Option<Vec<_>> = FunctionKind::of_trait(of).map(|kind| self.find(kind)).collect();
            if let Some(functions) = functions.filter(|_| of.rests_on().iter().all(|other| there.contains(other))) {
                there.push(of);
                implementations.push(self.implementation(of, &functions));
            }
        }
        quote!(#(#implementations)*)
    }

    fn implementation(&self, of: Trait, functions: &[(&Function, &Ident)]) -> TokenStream {
        let derivation = self.derivation;
        let (name, trait_name) = (self.mechanism, identifier(of.name()));
        let sizes = [derivation.dof(), self.count(Argument::U), derivation.constraints.len()];
        let sizes = sizes[..of.sizes()].iter().map(|&size| Literal::usize_unsuffixed(size));
        let items = match of {
            Trait::Dynamics => self.names(),
            Trait::Constrained => {
                let (rows, holonomic) = (&derivation.constraints, &derivation.holonomic);
                let count = Literal::usize_unsuffixed(rows.len());
                quote! {
                    const CONSTRAINTS: [&'static str; #count] = [#(#rows),*];
                    const HOLONOMIC: [bool; #count] = [#(#holonomic),*];
                }
            }
            Trait::Energies | Trait::Linearized | Trait::Mechanism => TokenStream::new(),
        };
        let time = if derivation.prescribed.is_empty() { quote!(t) } else { quote!((t, prescribed)) };
        let functions = functions.iter().map(|(function, own)| {
            let of_trait = identifier(function.kind.name());
            let state = function.arguments.iter().map(|&argument| self.argument(argument));
            let result = self.result(function);
            let call = match is_written(function) {
                false => self.call((function, own), true, None),
                true => {
                    let (zeros, call) = (zeros(function), self.call((function, own), true, Some(quote!(&mut result))));
                    quote! {
                        let mut result = #zeros;
                        #call;
                        result
                    }
                }
            };
            quote!(fn #of_trait(&self, #time: Self::Time, #(#state),*) -> #result { #call })
        });
        quote! {
            impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::#trait_name<#(#sizes),*> for #name<T> {
                #items
                #(#functions)*
            }
        }
    }

    /// The types and names of `Dynamics`.
    fn names(&self) -> TokenStream {
        let Derived { name, coordinates, inputs, prescribed, .. } = &**self.derivation;
        let [coordinates, inputs] = [coordinates, inputs].map(|variables| component_names(variables));
        let [n, u, signals] = [coordinates.len(), inputs.len(), count(prescribed)].map(Literal::usize_unsuffixed);
        let time = if prescribed.is_empty() { quote!(T) } else { quote!((T, [[T; 3]; #signals])) };
        quote! {
            type Scalar = T;
            type Time = #time;
            const NAME: &'static str = #name;
            const COORDINATES: [&'static str; #n] = [#(#coordinates),*];
            const INPUTS: [&'static str; #u] = [#(#inputs),*];
        }
    }

    fn constants(&self, [coordinates, inputs]: &[Vec<Ident>; 2]) -> TokenStream {
        let coordinates = indices("coordinate", coordinates, &self.derivation.coordinates);
        let inputs = indices("input", inputs, &self.derivation.inputs);
        let list = |name: &str, entries: &[String]| {
            let (name, length) = (identifier(name), Literal::usize_unsuffixed(entries.len()));
            quote!(pub const #name: [&str; #length] = [#(#entries),*];)
        };
        let parameters = component_names(&self.derivation.parameters);
        let parameters = (!parameters.is_empty()).then(|| list("PARAMETERS", &parameters));
        let is_conserved = self.find(FunctionKind::Conserved).is_some();
        let conserved = is_conserved.then(|| list("CONSERVED", &self.derivation.conserved));
        quote!(#coordinates #inputs #parameters #conserved)
    }
}

/// A module of the numbers and ranges of components; an identifier that spells no name is left out.
fn indices(module: &str, identifiers: &[Ident], variables: &[Variable]) -> TokenStream {
    if variables.is_empty() {
        return TokenStream::new();
    }
    let names: Vec<String> = variables.iter().map(|variable| variable.name.to_uppercase()).collect();
    if identifiers.len() != variables.len() {
        return TokenStream::new();
    }
    let constants = identifiers.iter().zip(variables).enumerate().map(|(i, (name, variable))| {
        if !spells(&name.to_string(), &names[i], names[..i].contains(&names[i])) {
            return TokenStream::new();
        }
        let [first, end] = [variable.first, variable.first + variable.count()].map(Literal::usize_unsuffixed);
        match variable.length {
            None => quote!(pub const #name: usize = #first;),
            Some(_) => quote!(pub const #name: ::core::ops::Range<usize> = #first..#end;),
        }
    });
    let module = identifier(module);
    quote!(pub mod #module { #(#constants)* })
}

/// `mbs_runtime::Pose`, without arguments of types.
pub(super) fn path_of(path: &syn::Path) -> String {
    let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
    names.join("::")
}

/// Tokens without spaces.
pub(super) fn compact(what: &impl ToTokens) -> String {
    super::rust::compact(&what.to_token_stream().to_string())
}

fn identifier(name: &str) -> Ident {
    Ident::new(name, proc_macro2::Span::call_site())
}

/// `T` in arrays of these lengths.
fn arrays(lengths: &[usize]) -> TokenStream {
    lengths.iter().rev().fold(quote!(T), |of, &length| several(&of, length))
}

fn several(of: &TokenStream, count: usize) -> TokenStream {
    let count = Literal::usize_unsuffixed(count);
    quote!([#of; #count])
}

/// Whether a function writes its result to storage of the caller.
fn is_written(function: &Function) -> bool {
    is_large(function.results.iter().map(|part| part.shape))
}

/// What a result of matrices or vectors is before it is written.
fn zeros(function: &Function) -> TokenStream {
    let zero = quote!(T::zero());
    let zeros = function.results.iter().map(|part| match part.shape {
        Shape::Vector(n) => several(&zero, n),
        Shape::Matrix(rows, columns) => several(&several(&zero, columns), rows),
        Shape::Symmetric(n) => several(&several(&zero, n), n),
        _ => TokenStream::new(),
    });
    let names = function.results.iter().map(|part| identifier(part.name));
    match function.kind {
        FunctionKind::Linearize => quote!(::mbs_runtime::Linearization { #(#names: #zeros),* }),
        FunctionKind::InverseDynamicsJacobian => quote!(::mbs_runtime::InverseDynamicsJacobian { #(#names: #zeros),* }),
        _ => quote!(#(#zeros)*),
    }
}

fn type_of(shape: Shape) -> TokenStream {
    match shape {
        Shape::Scalar => quote!(T),
        Shape::Vector(n) => arrays(&[n]),
        Shape::Matrix(rows, columns) => arrays(&[rows, columns]),
        Shape::Symmetric(n) => arrays(&[n, n]),
        Shape::Matrices(n, rows, columns) => arrays(&[n, rows, columns]),
        Shape::Pose => quote!(::mbs_runtime::Pose<T>),
        Shape::Wrench => quote!(::mbs_runtime::Wrench<T>),
        Shape::Poses(n) => several(&type_of(Shape::Pose), n),
        Shape::Wrenches(n) => several(&type_of(Shape::Wrench), n),
    }
}
