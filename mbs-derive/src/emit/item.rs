//! The items of a module: parameters, the mechanism and its functions, the trait's implementation, names for indices.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Symbol;
use crate::model::Variable;
use crate::model::lagrangian::component_names;
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind, Shape};

use super::body::{Body, Component};
use super::name::{Names, Scope, ident, identifier};
use super::text::Text;
use super::{Options, doc, module_name, parameter, segment};

/// The functions of the trait `Mechanism`.
const MECHANISM: [FunctionKind; 13] = [
    FunctionKind::KineticEnergy,
    FunctionKind::PotentialEnergy,
    FunctionKind::Momentum,
    FunctionKind::MassMatrix,
    FunctionKind::CoriolisMatrix,
    FunctionKind::Gravity,
    FunctionKind::Bias,
    FunctionKind::DissipationForce,
    FunctionKind::GeneralizedForce,
    FunctionKind::InverseDynamics,
    FunctionKind::ForwardDynamics,
    FunctionKind::Linearize,
    FunctionKind::InverseDynamicsJacobian,
];

/// The whole module.
pub(super) fn module(derivation: &Derivation, options: &Options) -> TokenStream {
    let names = Names::of(derivation);
    let functions = selected(derivation, options.functions.as_deref());
    let emitter = Emitter { derivation, names: &names, functions };
    let module = ident(&module_name(derivation));
    let docs = doc::attributes(&[format!("The mechanism [`{0}`]({module}::{0}).", names.mechanism)]);
    let parameters = parameter::items(derivation, &names, options.serde);
    let mechanism = emitter.mechanism();
    let methods = emitter.methods();
    let implementation = emitter.implementation();
    let constraints = emitter.constraints();
    let constants = emitter.constants();
    quote! {
        #docs
        #[allow(
            dead_code, non_camel_case_types, non_snake_case, non_upper_case_globals, unreachable_pub,
            unused_qualifications, unused_variables, clippy::all, clippy::pedantic, clippy::nursery, rustdoc::all
        )]
        pub mod #module {
            #parameters
            #mechanism
            #methods
            #implementation
            #constraints
            #constants
        }
    }
}

/// Whether the module implements the trait `Mechanism`.
pub(super) fn implements_mechanism(derivation: &Derivation, options: &Options) -> bool {
    of_trait(derivation, &selected(derivation, options.functions.as_deref())).is_some()
}

/// The functions of the trait, where all of them are generated and none takes more than the trait gives.
fn of_trait<'f, 'd>(
    derivation: &Derivation,
    functions: &'f [(usize, &'d Function)],
) -> Option<Vec<&'f (usize, &'d Function)>> {
    let find = |kind: &FunctionKind| functions.iter().find(|(_, f)| f.kind == *kind);
    let found = || MECHANISM.iter().map(find).collect::<Option<Vec<_>>>();
    derivation.prescribed.is_empty().then(found).flatten()
}

/// The functions asked for, and those that they call, in their order.
fn selected<'d>(derivation: &'d Derivation, asked_for: Option<&[String]>) -> Vec<(usize, &'d Function)> {
    let is_asked_for = |f: &Function| asked_for.is_none_or(|names| names.contains(&f.name));
    let calls_dynamics = derivation.functions.iter().any(|f| is_asked_for(f) && calls_forward_dynamics(f));
    let chosen = |f: &Function| is_asked_for(f) || (calls_dynamics && f.kind == FunctionKind::ForwardDynamics);
    derivation.functions.iter().enumerate().filter(|(_, f)| chosen(f)).collect()
}

/// Whether a function evaluates its program at the accelerations of forward dynamics.
fn calls_forward_dynamics(function: &Function) -> bool {
    function.completion == Completion::Solve
        && function.program.uses(|symbol| matches!(symbol, Symbol::Acceleration(_)))
}

struct Emitter<'d> {
    derivation: &'d Derivation,
    names: &'d Names,
    /// The functions that are generated, with their numbers.
    functions: Vec<(usize, &'d Function)>,
}

impl<'d> Emitter<'d> {
    /// The struct.
    fn mechanism(&self) -> TokenStream {
        let name = ident(&self.names.mechanism);
        let functions: Vec<&Function> = self.functions.iter().map(|(_, f)| *f).collect();
        let docs = doc::attributes(&doc::mechanism(self.derivation, &functions));
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
        let mut read = vec![false; self.derivation.constructor.results.len()];
        let called = self.constrained_forward_dynamics();
        for function in self.functions.iter().map(|(_, function)| *function).chain(called) {
            for instruction in &function.program.instructions {
                if let crate::optimise::Instruction::Hoisted(k) = instruction {
                    read[*k as usize] = true;
                }
            }
        }
        (0..read.len()).filter(|&k| read[k]).collect()
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
        let forward_dynamics = self.derivation.functions.iter().find(|f| f.kind == FunctionKind::ForwardDynamics);
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
    fn arguments(&self, function: &Function) -> Vec<(proc_macro2::Ident, TokenStream)> {
        let time = self.derivation.depends_on_time.then(|| (ident("t"), quote!(T)));
        let signals: usize = self.derivation.prescribed.iter().map(Variable::count).sum();
        let signals_length = Literal::usize_unsuffixed(signals);
        let prescribed = (signals > 0).then(|| (ident("prescribed"), quote!(&[[T; 3]; #signals_length])));
        let state = function.arguments.iter().filter_map(|&argument| {
            let n = match argument {
                Argument::Q | Argument::Qd | Argument::Qdd => self.derivation.dof(),
                Argument::U => self.inputs(),
                Argument::Multipliers => self.derivation.constraints.len(),
            };
            let length = Literal::usize_unsuffixed(n);
            (argument != Argument::U || n > 0).then(|| (ident(doc::argument(argument)), quote!(&[T; #length])))
        });
        time.into_iter().chain(prescribed).chain(state).collect()
    }

    fn inputs(&self) -> usize {
        self.derivation.inputs.iter().map(Variable::count).sum()
    }

    fn result_type(&self, function: &Function) -> TokenStream {
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
                let motion = motion();
                let statements = self.statements(function, |values| self.constrained_slopes(function, values));
                quote!(let (qdd, multipliers) = &#motion; #statements)
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

    fn assembled(&self, function: &Function, parts: &[TokenStream]) -> TokenStream {
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

    /// `M⁻¹` of the right sides.
    fn solved(&self, function: &Function, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
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
    fn constrained_solution(&self, function: &Function, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        debug_assert_eq!(function.results[0].shape, Shape::Vector(n), "forward dynamics");
        let shapes = [Shape::Matrix(n, n), Shape::Matrix(k, n), Shape::Vector(n), Shape::Vector(k)];
        let [mass_matrix, jacobian, force, target] = shapes.map(|shape| shaped(shape, values));
        quote!(::mbs_runtime::constrained_solve(#mass_matrix, #jacobian, #force, #target))
    }

    /// The columns of all parts solved for at once, and taken apart.
    fn constrained_slopes(&self, function: &Function, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let (mass_matrix, jacobian) = (shaped(Shape::Matrix(n, n), values), shaped(Shape::Matrix(k, n), values));
        let widths: Vec<usize> = function.results.iter().map(|part| part.shape.count() / n).collect();
        let mut rows: Vec<Vec<TokenStream>> = vec![Vec::new(); n + k];
        for &width in &widths {
            rows.iter_mut().for_each(|row| row.extend((0..width).filter_map(|_| values.next())));
        }
        let (force, target) = rows.split_at(n);
        let (force, target) =
            (force.iter().map(|row| quote!([#(#row),*])), target.iter().map(|row| quote!([#(#row),*])));
        let solution = quote! {
            ::mbs_runtime::constrained_solve_many(#mass_matrix, #jacobian, [#(#force),*], [#(#target),*]).0
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

    /// The trait, where it can be implemented.
    fn implementation(&self) -> TokenStream {
        let Some(functions) = of_trait(self.derivation, &self.functions) else { return TokenStream::new() };
        let (n, u) = (self.derivation.dof(), self.inputs());
        let name = ident(&self.names.mechanism);
        let declared = &self.derivation.name;
        let coordinates = component_names(&self.derivation.coordinates);
        let inputs = component_names(&self.derivation.inputs);
        let [n_literal, u_literal] = [n, u].map(Literal::usize_unsuffixed);
        let forwards = functions.into_iter().map(|(number, function)| {
            let trait_function = ident(trait_name(&function.kind));
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
    fn constraints(&self) -> TokenStream {
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
        let has = |kind: &FunctionKind| self.functions.iter().any(|(_, f)| f.kind == *kind);
        let parameters = (!parameters.is_empty())
            .then(|| list("PARAMETERS", "The names of the parameters, arrays flattened.", &parameters));
        let conserved = self.derivation.functions.iter().find_map(|f| match &f.kind {
            FunctionKind::Conserved(names) if has(&f.kind) => {
                Some(list("CONSERVED", "What `conserved` returns.", names))
            }
            _ => None,
        });
        quote!(#coordinates #inputs #parameters #conserved)
    }
}

/// Which of a program's results make up what a function returns, or hands to the runtime.
fn components(derivation: &Derivation, function: &Function) -> Vec<Component> {
    let n = derivation.dof();
    let square = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let mut components = Vec::new();
    let mut start = 0;
    let mut shapes: Vec<Shape> = function.results.iter().map(|part| part.shape).collect();
    if function.completion.solves() {
        let right_sides = shapes.into_iter().map(|shape| right_side_shape(derivation, shape));
        shapes = [Shape::Matrix(derivation.constraints.len(), n)].into_iter().chain(right_sides).collect();
        // The runtime reads the lower triangle of M.
        components.extend(square().map(|(i, j)| match j <= i {
            true => Component::Result(triangular(i, j), format!("m_{i}_{j}")),
            false => Component::Zero,
        }));
        start = triangular(n, 0);
    }
    for shape in shapes {
        match shape {
            Shape::Symmetric(_) => components.extend(square().map(|(i, j)| {
                let (row, column) = (i.max(j), i.min(j));
                Component::Result(start + triangular(row, column), format!("m_{row}_{column}"))
            })),
            Shape::Scalar
            | Shape::Vector(_)
            | Shape::Matrix(..)
            | Shape::Pose
            | Shape::Wrench
            | Shape::Wrenches(_)
            | Shape::Matrices(..)
            | Shape::Poses(_) => {
                let wish = |i| result_name(derivation, function, shape, i);
                components.extend((0..shape.count()).map(|i| Component::Result(start + i, wish(i))));
            }
        }
        start += shape.count();
    }
    components
}

/// The right sides of the system for accelerations and multipliers, for a result of this shape.
fn right_side_shape(derivation: &Derivation, shape: Shape) -> Shape {
    let size = derivation.dof() + derivation.constraints.len();
    match shape {
        Shape::Matrix(_, columns) => Shape::Matrix(size, columns),
        Shape::Scalar
        | Shape::Vector(_)
        | Shape::Symmetric(_)
        | Shape::Pose
        | Shape::Wrench
        | Shape::Wrenches(_)
        | Shape::Matrices(..)
        | Shape::Poses(_) => Shape::Vector(size),
    }
}

/// The number of an entry of a lower triangle.
fn triangular(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// What a component of a result is called; empty for no name.
fn result_name(derivation: &Derivation, function: &Function, shape: Shape, i: usize) -> String {
    let coordinate = || component_names(&derivation.coordinates)[i].clone();
    match (&function.kind, shape) {
        (FunctionKind::Momentum, _) => format!("p_{}", coordinate()),
        (FunctionKind::Gravity, _) => format!("g_{}", coordinate()),
        (FunctionKind::Bias, _) => format!("h_{}", coordinate()),
        (FunctionKind::InverseDynamics, _) => format!("tau_{}", coordinate()),
        (FunctionKind::ForwardDynamics, _) if function.completion == Completion::None => {
            format!("{}_ddot", coordinate())
        }
        (FunctionKind::CoriolisMatrix, Shape::Matrix(_, columns)) => format!("c_{}_{}", i / columns, i % columns),
        _ => String::new(),
    }
}

/// The name of a function of the trait.
fn trait_name(kind: &FunctionKind) -> &'static str {
    match kind {
        FunctionKind::KineticEnergy => "kinetic_energy",
        FunctionKind::PotentialEnergy => "potential_energy",
        FunctionKind::Momentum => "momentum",
        FunctionKind::MassMatrix => "mass_matrix",
        FunctionKind::CoriolisMatrix => "coriolis_matrix",
        FunctionKind::Gravity => "gravity",
        FunctionKind::Bias => "bias",
        FunctionKind::DissipationForce => "dissipation_force",
        FunctionKind::GeneralizedForce => "generalized_force",
        FunctionKind::InverseDynamics => "inverse_dynamics",
        FunctionKind::ForwardDynamics => "forward_dynamics",
        FunctionKind::Linearize => "linearize",
        FunctionKind::InverseDynamicsJacobian => "inverse_dynamics_jacobian",
        FunctionKind::LinearizeParameters
        | FunctionKind::Constraint
        | FunctionKind::ConstraintRate
        | FunctionKind::ConstraintRateJacobian
        | FunctionKind::ConstraintJacobian
        | FunctionKind::ConstraintBias
        | FunctionKind::Multipliers
        | FunctionKind::Conserved(_)
        | FunctionKind::Output(_)
        | FunctionKind::OutputVelocity(_)
        | FunctionKind::OutputJacobian(_)
        | FunctionKind::OutputJacobianQd(_)
        | FunctionKind::OutputJacobianU(_)
        | FunctionKind::OutputJacobianRate(_)
        | FunctionKind::Reaction(_) => unreachable!("not in the trait"),
    }
}

/// `T` or `[T; 6]`
pub(super) fn array(of: TokenStream, length: Option<usize>) -> TokenStream {
    match length {
        None => of,
        Some(n) => {
            let n = Literal::usize_unsuffixed(n);
            quote!([#of; #n])
        }
    }
}

fn shape_type(shape: Shape) -> TokenStream {
    match shape {
        Shape::Scalar => quote!(T),
        Shape::Vector(n) => array(quote!(T), Some(n)),
        Shape::Matrix(rows, columns) => array(array(quote!(T), Some(columns)), Some(rows)),
        Shape::Symmetric(n) => array(array(quote!(T), Some(n)), Some(n)),
        Shape::Pose => quote!(::mbs_runtime::Pose<T>),
        Shape::Wrench => quote!(::mbs_runtime::Wrench<T>),
        Shape::Wrenches(n) => array(shape_type(Shape::Wrench), Some(n)),
        Shape::Matrices(n, rows, columns) => array(shape_type(Shape::Matrix(rows, columns)), Some(n)),
        Shape::Poses(n) => array(shape_type(Shape::Pose), Some(n)),
    }
}

/// The next values in this shape.
fn shaped(shape: Shape, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
    match shape {
        Shape::Scalar => values.next().expect("a value for each component"),
        Shape::Vector(n) => {
            let entries = values.take(n);
            quote!([#(#entries),*])
        }
        Shape::Matrix(rows, columns) => {
            let rows: Vec<_> = (0..rows).map(|_| shaped(Shape::Vector(columns), values)).collect();
            quote!([#(#rows),*])
        }
        Shape::Symmetric(n) => shaped(Shape::Matrix(n, n), values),
        Shape::Pose => {
            let (position, rotation) = (shaped(Shape::Vector(3), values), shaped(Shape::Matrix(3, 3), values));
            quote!(::mbs_runtime::Pose { position: #position, rotation: #rotation })
        }
        Shape::Wrench => {
            let (force, moment) = (shaped(Shape::Vector(3), values), shaped(Shape::Vector(3), values));
            quote!(::mbs_runtime::Wrench { force: #force, moment: #moment })
        }
        Shape::Wrenches(n) => several(n, Shape::Wrench, values),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns), values),
        Shape::Poses(n) => several(n, Shape::Pose, values),
    }
}

/// An array of `n` results in this shape.
fn several(n: usize, shape: Shape, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
    let elements: Vec<_> = (0..n).map(|_| shaped(shape, values)).collect();
    quote!([#(#elements),*])
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
