//! The items of a module: parameters, the mechanism and its functions, the trait's implementation, names for indices.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Symbol;
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind};
use crate::variable::Variable;
use crate::variable::component_names;

use super::body::{Body, Component};
use super::expression::literal;
use super::name::{Names, Scope, ident, identifier, table};
use super::shape::{components, shape_type, shaped};
use super::text::Text;
use super::{Options, doc, module_name, parameter, segment, traits};

/// The whole module.
pub(super) fn module(derivation: &Derivation, options: &Options) -> TokenStream {
    let names = Names::of(derivation, options.infix, options.trigonometry);
    let functions = selected(derivation, options.functions.as_deref());
    let emitter = Emitter { derivation, names: &names, functions };
    let module = module_name(derivation);
    let parameters = parameter::items(derivation, &names, options.serde);
    let tables = emitter.tables();
    let mechanism = emitter.mechanism();
    let methods = emitter.methods();
    let implementation = emitter.implementations();
    let constraints = emitter.constraints();
    let constants = emitter.constants();
    let code = format!("{mechanism} {methods}");
    let docs = doc::attributes(&doc::module(derivation, &module, &names.mechanism, &code));
    let module = ident(&module);
    quote! {
        #docs
        #[allow(
            dead_code, non_camel_case_types, non_snake_case, non_upper_case_globals, unreachable_pub,
            unused_qualifications, unused_variables, clippy::all, clippy::pedantic, clippy::nursery, rustdoc::all
        )]
        pub mod #module {
            #tables
            #parameters
            #mechanism
            #methods
            #implementation
            #constraints
            #constants
        }
    }
}

/// The functions asked for, and those that they call, in their order.
pub(super) fn selected<'d>(derivation: &'d Derivation, asked_for: Option<&[String]>) -> Vec<(usize, &'d Function)> {
    let is_asked_for = |f: &Function| asked_for.is_none_or(|names| names.contains(&f.name));
    let calls_dynamics = derivation.functions.iter().any(|f| is_asked_for(f) && calls_forward_dynamics(f));
    let chosen = |f: &Function| is_asked_for(f) || (calls_dynamics && f.kind == FunctionKind::ForwardDynamics);
    derivation.functions.iter().enumerate().filter(|(_, f)| chosen(f)).collect()
}

/// Whether a function evaluates its program at the accelerations of forward dynamics.
pub(super) fn calls_forward_dynamics(function: &Function) -> bool {
    function.completion == Completion::Solve
        && function.program.uses(|symbol| matches!(symbol, Symbol::Acceleration(_)))
}

/// The hoisted values that some functions read.
pub(super) fn hoisted<'d>(derivation: &Derivation, functions: impl Iterator<Item = &'d Function>) -> Vec<usize> {
    let mut read = vec![false; derivation.constructor.results.len()];
    for instruction in functions.flat_map(|function| &function.program.instructions) {
        if let crate::optimise::Instruction::Hoisted(k) = instruction {
            read[*k as usize] = true;
        }
    }
    (0..read.len()).filter(|&k| read[k]).collect()
}

pub(super) struct Emitter<'d> {
    pub(super) derivation: &'d Derivation,
    pub(super) names: &'d Names,
    /// The functions that are generated, with their numbers.
    pub(super) functions: Vec<(usize, &'d Function)>,
}

impl<'d> Emitter<'d> {
    /// The splines that tables of the model are.
    fn tables(&self) -> TokenStream {
        let tables = self.names.splines.iter().enumerate().map(|(number, spline)| {
            let (name, columns) = (ident(&table(number)), Literal::usize_unsuffixed(spline.degree() + 2));
            let row = |row: &Vec<f64>| {
                let row = row.iter().map(|&x| literal(x));
                quote!([#(#row),*])
            };
            let (places, rows) = (spline.places().iter().map(|&x| literal(x)), spline.rows().iter().map(row));
            quote! {
                /// A table of the model: places, and the polynomials between them.
                const #name: ::mbs_runtime::Spline<'static, #columns> =
                    ::mbs_runtime::Spline::new(&[#(#places),*], &[#(#rows),*]);
            }
        });
        quote!(#(#tables)*)
    }

    /// The struct.
    fn mechanism(&self) -> TokenStream {
        let name = ident(&self.names.mechanism);
        let functions: Vec<&Function> = self.functions.iter().map(|(_, f)| *f).collect();
        let mut docs = doc::mechanism(self.derivation, &functions);
        let traits = traits::names(self.derivation, &self.functions);
        if !traits.is_empty() {
            docs.extend([String::new(), format!("Implements `{}` of mbs-runtime.", traits.join("`, `"))]);
        }
        let docs = doc::attributes(&docs);
        let hoisted = self.hoisted().into_iter().map(|k| ident(&self.names.hoisted[k]));
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

    /// The hoisted values that the generated functions read.
    fn hoisted(&self) -> Vec<usize> {
        let called = self.constrained_forward_dynamics();
        hoisted(self.derivation, self.functions.iter().map(|(_, function)| *function).chain(called))
    }

    /// `new`, `params` and the functions.
    fn methods(&self) -> TokenStream {
        let name = ident(&self.names.mechanism);
        let new = self.constructor();
        let functions = self.functions.iter().map(|(number, function)| self.function(*number, function));
        let motion = self.constrained_motion();
        quote! {
            impl<T: ::mbs_runtime::Scalar> #name<T> {
                #new

                /// The parameters.
                pub fn params(&self) -> &Params<T> {
                    &self.params
                }

                #(#functions)*

                #motion
            }
        }
    }

    /// Forward dynamics with constraints, where a generated function needs it.
    fn constrained_forward_dynamics(&self) -> Option<&'d Function> {
        let is_needed = self.functions.iter().any(|(_, f)| f.completion.is_constrained());
        let forward_dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        forward_dynamics.filter(|_| is_needed)
    }

    /// What accelerations, multipliers and linearizations of a mechanism with constraints have in common.
    fn constrained_motion(&self) -> TokenStream {
        let Some(function) = self.constrained_forward_dynamics() else { return TokenStream::new() };
        let [n, k] = [self.derivation.dof(), self.derivation.constraints.len()].map(Literal::usize_unsuffixed);
        let arguments = self.arguments(function).into_iter().map(|(name, ty)| quote!(#name: #ty));
        let body = self.statements(function, |values| self.constrained_solution(function, values));
        let name = ident(&self.names.constrained_motion);
        quote! {
            /// Accelerations and multipliers.
            fn #name(&self, #(#arguments),*) -> ([T; #n], [T; #k]) {
                #body
            }
        }
    }

    fn constructor(&self) -> TokenStream {
        let hoisted = self.hoisted();
        let component = |&k: &usize| Component::Result(k, self.names.hoisted[k].clone());
        let components: Vec<_> = hoisted.iter().map(component).collect();
        let scope = self.names.constructor_scope();
        let body = Body::new(&self.derivation.constructor, &components, self.names, scope);
        let text = Text::new(&body);
        let arguments = text.arguments(self.derivation, &quote!(params));
        let (constants, statements) =
            (text.constants(), segment::statements(&body.block.statements, &body.block.results, &text));
        let fields = hoisted.iter().zip(&body.block.results).map(|(&k, tree)| {
            let (field, value) = (ident(&self.names.hoisted[k]), text.tree(tree));
            if body.is_called(tree, &self.names.hoisted[k]) { quote!(#field,) } else { quote!(#field: #value,) }
        });
        quote! {
            /// With these parameters; what depends on them alone is computed here.
            ///
            /// They are not looked at: with what [`Params::check`] refuses, results may be NaN, or those of no mechanism. See
            /// [`try_new`](Self::try_new).
            pub fn new(params: Params<T>) -> Self {
                #arguments
                #constants
                #statements
                Self { params, #(#fields)* }
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

    /// One function.
    fn function(&self, number: usize, function: &Function) -> TokenStream {
        let name = ident(&self.names.functions[number]);
        let docs = doc::attributes(&doc::function(self.derivation, function));
        let arguments = self.arguments(function).into_iter().map(|(name, ty)| quote!(#name: #ty));
        let result = self.result_type(function);
        let body = self.body(function);
        quote! {
            #docs
            pub fn #name(&self, #(#arguments),*) -> #result {
                #body
            }
        }
    }

    /// Names and types of a function's arguments.
    pub(super) fn arguments(&self, function: &Function) -> Vec<(proc_macro2::Ident, TokenStream)> {
        let time = self.derivation.depends_on_time.then(|| (ident("t"), quote!(T)));
        let signals_length = Literal::usize_unsuffixed(self.signals());
        let prescribed = (self.signals() > 0).then(|| (ident("prescribed"), quote!(&[[T; 3]; #signals_length])));
        let state = function.arguments.iter().filter_map(|&argument| {
            let n = match argument {
                Argument::Q | Argument::Qd | Argument::Qdd => self.derivation.dof(),
                Argument::U => self.inputs(),
                Argument::Multipliers => self.derivation.constraints.len(),
            };
            let length = Literal::usize_unsuffixed(n);
            (argument != Argument::U || n > 0).then(|| (ident(argument.name()), quote!(&[T; #length])))
        });
        time.into_iter().chain(prescribed).chain(state).collect()
    }

    /// How many motions are prescribed, arrays flattened.
    pub(super) fn signals(&self) -> usize {
        self.derivation.prescribed.iter().map(Variable::count).sum()
    }

    pub(super) fn inputs(&self) -> usize {
        self.derivation.inputs.iter().map(Variable::count).sum()
    }

    pub(super) fn result_type(&self, function: &Function) -> TokenStream {
        let [n, u] = [self.derivation.dof(), self.inputs()].map(Literal::usize_unsuffixed);
        match (&function.kind, function.results.as_slice()) {
            (FunctionKind::Linearize, _) => quote!(::mbs_runtime::Linearization<T, #n, #u>),
            (FunctionKind::InverseDynamicsJacobian, _) => quote!(::mbs_runtime::InverseDynamicsJacobian<T, #n>),
            (_, [part]) => shape_type(part.shape),
            (_, parts) => {
                let parts = parts.iter().map(|part| shape_type(part.shape));
                quote!((#(#parts),*))
            }
        }
    }

    /// What a function does.
    fn body(&self, function: &Function) -> TokenStream {
        let motion = || {
            let name = ident(&self.names.constrained_motion);
            let arguments = self.arguments(function).into_iter().map(|(name, _)| name);
            quote!(self.#name(#(#arguments),*))
        };
        match (&function.kind, function.completion) {
            (_, Completion::None) => self.statements(function, |values| self.returned(function, values)),
            (_, Completion::Solve) => {
                let accelerations = calls_forward_dynamics(function).then(|| self.forward_dynamics());
                let statements = self.statements(function, |values| self.solved(function, values));
                quote!(#accelerations #statements)
            }
            (FunctionKind::ForwardDynamics, Completion::SolveConstrained) => {
                let motion = motion();
                quote!(#motion.0)
            }
            (_, Completion::SolveMultipliers) => {
                let motion = motion();
                quote!(#motion.1)
            }
            (_, Completion::SolveConstrained) => {
                let (motion, scale, sizes) = (motion(), ident(&self.names.scale), self.sizes(function));
                let statements = self.statements(function, |values| self.constrained_slopes(function, values));
                quote!(let (qdd, multipliers) = &#motion; let #scale = (qdd, #sizes); #statements)
            }
        }
    }

    /// The statements of a function's program, and what is made of its values.
    fn statements(
        &self,
        function: &Function,
        finish: impl FnOnce(&mut dyn Iterator<Item = TokenStream>) -> TokenStream,
    ) -> TokenStream {
        let components = components(self.derivation, function);
        let body = Body::new(&function.program, &components, self.names, self.names.function_scope());
        let text = Text::new(&body);
        let arguments = text.arguments(self.derivation, &quote!(self.params));
        let (constants, statements) =
            (text.constants(), segment::statements(&body.block.statements, &body.block.results, &text));
        let finish = finish(&mut body.block.results.iter().map(|tree| text.tree(tree)));
        quote!(#arguments #constants #statements #finish)
    }

    /// `let qdd = &self.forward_dynamics(q, qd, u);`
    fn forward_dynamics(&self) -> TokenStream {
        let is_called = |(_, f): &&(usize, &Function)| f.kind == FunctionKind::ForwardDynamics;
        let (number, function) = self.functions.iter().find(is_called).expect("it was selected");
        let name = ident(&self.names.functions[*number]);
        let arguments = self.arguments(function).into_iter().map(|(name, _)| name);
        quote!(let qdd = &self.#name(#(#arguments),*);)
    }

    /// What a function returns, its values put in shape.
    fn returned(&self, function: &Function, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
        let parts: Vec<_> = function.results.iter().map(|part| shaped(part.shape, values)).collect();
        self.assembled(function, &parts)
    }

    pub(super) fn assembled(&self, function: &Function, parts: &[TokenStream]) -> TokenStream {
        let fields = function.results.iter().map(|part| identifier(part.name)).map(|name| ident(&name));
        match (&function.kind, parts) {
            (FunctionKind::Linearize, _) => quote!(::mbs_runtime::Linearization { #(#fields: #parts),* }),
            (FunctionKind::InverseDynamicsJacobian, _) => {
                quote!(::mbs_runtime::InverseDynamicsJacobian { #(#fields: #parts),* })
            }
            (_, [part]) => part.clone(),
            (_, parts) => quote!((#(#parts),*)),
        }
    }

    /// Names for indices, of parameters and of first integrals.
    fn constants(&self) -> TokenStream {
        let coordinates =
            indices("coordinate", "Indices of the coordinates in `q`, `qd`, `qdd`.", &self.derivation.coordinates);
        let inputs = indices("input", "Indices of the inputs in `u`.", &self.derivation.inputs);
        let list = |name: &str, docs: &str, entries: &[String]| {
            let (name, length) = (ident(name), Literal::usize_unsuffixed(entries.len()));
            let docs = doc::attributes(&[docs.to_string()]);
            quote!(#docs pub const #name: [&str; #length] = [#(#entries),*];)
        };
        let parameters = component_names(&self.derivation.parameters);
        let has = |kind: FunctionKind| self.functions.iter().any(|(_, f)| f.kind == kind);
        let parameters = (!parameters.is_empty())
            .then(|| list("PARAMETERS", "The names of the parameters, arrays flattened.", &parameters));
        let conserved = has(FunctionKind::Conserved)
            .then(|| list("CONSERVED", "What `conserved` returns.", &self.derivation.conserved));
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
