//! The functions of a mechanism, and systems of linear equations in their last step: accelerations, multipliers and
//! their derivatives.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Elimination;
use crate::optimise::{Argument, FunctionKind};
use crate::shape::{Shape, is_large};

use super::super::doc;
use super::super::name::{escaped, ident};
use super::super::walk::{Argued, Ending, Motion, Routine, Sizes};
use super::shape::{array, array_of, shape_type, shaped, written};
use super::{Module, layout, tokens, traits};

impl Module<'_> {
    /// All of them; what those with constraints have in common comes last.
    pub(super) fn functions(&self) -> TokenStream {
        let (motion, public): (Vec<_>, Vec<_>) =
            self.routines.iter().enumerate().partition(|(_, routine)| routine.is_motion());
        let functions = public.into_iter().chain(motion).map(|(number, routine)| self.function(number, routine));
        let system = self.entries_of_the_system();
        quote!(#(#functions)* #system)
    }

    /// The function of the entries of M and A that are not zero, where `Constraints` needs it.
    fn entries_of_the_system(&self) -> Option<TokenStream> {
        let (_, forward_dynamics) = traits::eliminated(&self.walk)?;
        let (lines, entries) = self.walk.entries(forward_dynamics, &self.with("self.params"));
        let name = ident(&self.walk.names.constrained_system);
        let arguments = self.walk.arguments(forward_dynamics);
        let arguments: Vec<Argued> =
            arguments.into_iter().filter(|(name, _)| ["t", Argument::Q.name()].contains(name)).collect();
        let (arguments, result) = (self.arguments(&arguments), array(quote!(T), entries.len()));
        let body = tokens(&format!("{}\n{}", lines.join("\n"), array_of(&entries)));
        Some(quote! {
            /// The entries of M's lower triangle and of A that are not zero.
            fn #name(&self, #(#arguments),*) -> #result {
                #body
            }
        })
    }

    fn function(&self, number: usize, routine: &Routine) -> TokenStream {
        let (docs, name) = (doc::attributes(&routine.docs), ident(&escaped(&routine.name)));
        let visibility = (!routine.is_motion()).then(|| quote!(pub));
        let arguments = self.arguments(&routine.arguments);
        let (result, body) = (self.result_type(routine.kind, &shapes(routine)), tokens(&self.body(number, routine)));
        if is_written(routine) {
            let note = doc::attributes(&[
                String::new(),
                "Writes to `result`, which takes more than 64 kB in `f64`.".to_string(),
            ]);
            return quote! {
                #docs
                #note
                #visibility fn #name(&self, #(#arguments,)* result: &mut #result) {
                    #body
                }
            };
        }
        quote! {
            #docs
            #visibility fn #name(&self, #(#arguments),*) -> #result {
                #body
            }
        }
    }

    /// Names and types of a function's arguments.
    fn arguments<'a>(&self, arguments: &'a [Argued]) -> impl Iterator<Item = TokenStream> + use<'a> {
        arguments.iter().map(|(name, count)| {
            let name = ident(name);
            match count {
                None => quote!(#name: T),
                Some(count) => {
                    let of = if name == "prescribed" { array(quote!(T), 3) } else { quote!(T) };
                    let all = array(of, *count);
                    quote!(#name: &#all)
                }
            }
        })
    }

    pub(super) fn result_type(&self, kind: FunctionKind, shapes: &[Shape]) -> TokenStream {
        let [n, inputs, ..] = self.walk.sizes().map(Literal::usize_unsuffixed);
        match (kind, shapes) {
            (FunctionKind::Linearize, _) => quote!(::mbs_runtime::Linearization<T, #n, #inputs>),
            (FunctionKind::InverseDynamicsJacobian, _) => quote!(::mbs_runtime::InverseDynamicsJacobian<T, #n>),
            (_, [shape]) => shape_type(*shape),
            (_, shapes) => {
                let parts = shapes.iter().map(|shape| shape_type(*shape));
                quote!((#(#parts),*))
            }
        }
    }

    /// What a function does.
    fn body(&self, number: usize, routine: &Routine) -> String {
        let given: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
        let given = given.join(", ");
        let lines = match self.is_abbreviated {
            true => layout::abbreviated(number, routine),
            false => routine.lines.join("\n"),
        };
        let motion = format!("self.{}({given})", self.walk.names.constrained_motion);
        match &routine.ending {
            Ending::Values => format!("{lines}\n{}", results(routine)),
            Ending::Solve => {
                let called = || format!("let qdd = &self.{}({given});\n", escaped(&self.walk.forward_dynamics()));
                let accelerations = (routine.motion == Motion::Accelerations).then(called).unwrap_or_default();
                format!("{accelerations}{lines}\n{}", self.solved(routine))
            }
            Ending::Motion => format!("{lines}\n{}", self.constrained(routine)),
            Ending::OfMotion(part) => assembled(routine, &[format!("{motion}.{}", usize::from(*part != "qdd"))]),
            Ending::Slopes(sizes) => {
                let (scale, is_eliminated) = (&self.walk.names.scale, self.walk.derivation.elimination.is_some());
                let measured = || format!("let {scale} = (qdd, {});\n", measures(sizes));
                let measured = if is_eliminated { String::new() } else { measured() };
                format!("let (qdd, multipliers) = &{motion};\n{measured}{lines}\n{}", self.slopes(routine))
            }
        }
    }

    /// `M⁻¹` of the right sides.
    fn solved(&self, routine: &Routine) -> String {
        let mass_matrix = format!("let mass_matrix = {};", rows(&routine.mass_matrix, self.walk.derivation.dof()));
        match (routine.parts.as_slice(), in_shape(routine)) {
            ([(_, shape)], right_sides) => {
                let solve = if matches!(shape, Shape::Vector(_)) { "ldlt_solve" } else { "ldlt_solve_many" };
                let right_side = format!("let right_side = {};", right_sides[0]);
                let solution = assembled(routine, &[format!("::mbs_runtime::{solve}(mass_matrix, right_side)")]);
                format!("{mass_matrix}\n{right_side}\n{solution}")
            }
            (_, right_sides) => {
                let solved = right_sides.iter().map(|right_side| format!("factors.solve_many({right_side})"));
                let result = assembled(routine, &solved.collect::<Vec<_>>());
                format!("{mass_matrix}\nlet factors = ::mbs_runtime::Ldlt::new(mass_matrix);\n{result}")
            }
        }
    }

    /// q̈ and λ.
    fn constrained(&self, routine: &Routine) -> String {
        let (system, right_sides) = (self.system(routine), in_shape(routine).join(", "));
        if self.walk.derivation.elimination.is_some() {
            return format!("::mbs_runtime::sparse_solve({system}, {right_sides})");
        }
        let vectors = &self.walk.derivation.constraint_vectors;
        match vectors.iter().enumerate().all(|(row, &first)| row == first) {
            true => format!("::mbs_runtime::constrained_solve({system}, {right_sides})"),
            false => format!("::mbs_runtime::constrained_solve_vectors({system}, {right_sides}, {vectors:?})"),
        }
    }

    /// The columns of all parts solved for at once, and taken apart.
    fn slopes(&self, routine: &Routine) -> String {
        let [n, .., k] = self.walk.sizes();
        let rows: Vec<String> = routine.right_sides(n + k).iter().map(|row| array_of(row)).collect();
        let right_sides = format!("{}, {}", array_of(&rows[..n]), array_of(&rows[n..]));
        let (vectors, scale) = (&self.walk.derivation.constraint_vectors, &self.walk.names.scale);
        let system = self.system(routine);
        let solution = match &self.walk.derivation.elimination {
            Some(_) => format!("::mbs_runtime::sparse_slopes({system}, {right_sides})"),
            None => {
                let measures = format!("{vectors:?}, {scale}.0, {scale}.1");
                format!("::mbs_runtime::constrained_slopes({system}, {right_sides}, {measures})")
            }
        };
        let widths = routine.widths();
        if widths.len() == 1 {
            return assembled(routine, &[solution]);
        }
        let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
        let parts = starts.map(|start| {
            let first = if start > 0 { format!("{start} + ") } else { String::new() };
            format!("::core::array::from_fn(|i| ::core::array::from_fn(|j| solution[i][{first}j]))")
        });
        format!("let solution = {solution};\n{}", assembled(routine, &parts.collect::<Vec<_>>()))
    }

    /// M and A, or the order in which they are eliminated and their entries.
    fn system(&self, routine: &Routine) -> String {
        if !routine.entries.is_empty() {
            return format!("&ELIMINATION, {}", array_of(&routine.entries));
        }
        let n = self.walk.derivation.dof();
        format!("{}, {}", rows(&routine.mass_matrix, n), rows(&routine.jacobian, n))
    }

    /// The order of elimination, where a function solves by it.
    pub(super) fn elimination(&self) -> Option<TokenStream> {
        self.walk.constrained()?;
        let Elimination { order, starts, rows, entries, places, .. } = self.walk.derivation.elimination.as_ref()?;
        let table = |(name, numbers): (&str, &[usize])| {
            let listed: Vec<String> = numbers.iter().map(ToString::to_string).collect();
            format!("{name}: &[{}]", listed.join(", "))
        };
        let tables = [("order", order.as_slice()), ("ends", &starts[1..]), ("rows", rows), ("places", places)];
        let [unknowns, entries, below] = [order.len(), entries.len(), rows.len()].map(Literal::usize_unsuffixed);
        let tables = tokens(&tables.map(table).join(", "));
        Some(quote! {
            /// In which order accelerations and multipliers are eliminated.
            const ELIMINATION: ::mbs_runtime::Elimination<#unknowns, #entries, #below> =
                ::mbs_runtime::Elimination { #tables };
        })
    }
}

/// The values of each part in its shape.
fn in_shape(routine: &Routine) -> Vec<String> {
    let parts = routine.parts.iter().zip(&routine.values);
    let in_order = |values: &[String]| {
        let array = values.first()?.strip_suffix("[0]")?;
        let is_whole = values.iter().enumerate().all(|(k, value)| *value == format!("{array}[{k}]"));
        is_whole.then(|| array.to_string())
    };
    let whole = |shape: Shape, values: &[String]| in_order(values).filter(|_| matches!(shape, Shape::Vector(_)));
    parts
        .map(|((_, shape), values)| whole(*shape, values).unwrap_or_else(|| shaped(*shape, &mut values.iter())))
        .collect()
}

/// A matrix of this many columns.
fn rows(values: &[String], columns: usize) -> String {
    array_of(&values.chunks(columns).map(array_of).collect::<Vec<_>>())
}

/// The shapes of what a function returns or writes.
fn shapes(routine: &Routine) -> Vec<Shape> {
    routine.parts.iter().map(|(_, shape)| *shape).collect()
}

/// Whether a result is written to storage of the caller.
fn is_written(routine: &Routine) -> bool {
    is_large(shapes(routine)) && !routine.is_motion()
}

/// What a function whose values are its results returns, or writes.
fn results(routine: &Routine) -> String {
    if !is_written(routine) {
        return assembled(routine, &in_shape(routine));
    }
    let parts = routine.parts.iter().zip(&routine.values).enumerate();
    parts.map(|(i, ((_, shape), values))| written(&place(routine, i), *shape, values)).collect()
}

/// What a function returns, of its parts; or assignments that write them.
fn assembled(routine: &Routine, parts: &[String]) -> String {
    if is_written(routine) {
        let dereferenced = if parts.len() == 1 { "*" } else { "" };
        let assigned = |(i, part)| format!("{dereferenced}{} = {part};\n", place(routine, i));
        return parts.iter().enumerate().map(assigned).collect();
    }
    let named = |of: &str| {
        let fields = routine.parts.iter().zip(parts).map(|((name, _), part)| format!("{name}: {part}"));
        format!("::mbs_runtime::{of} {{ {} }}", fields.collect::<Vec<_>>().join(", "))
    };
    match (routine.kind, parts) {
        (FunctionKind::Linearize, _) => named("Linearization"),
        (FunctionKind::InverseDynamicsJacobian, _) => named("InverseDynamicsJacobian"),
        (_, [part]) => part.clone(),
        (_, parts) => format!("({})", parts.join(", ")),
    }
}

/// Where a part of a large result is written.
fn place(routine: &Routine, part: usize) -> String {
    match routine.parts[part].0.as_str() {
        "" => "result".to_string(),
        name => format!("result.{name}"),
    }
}

/// How large that is by which each column of a linearization is a derivative.
fn measures(sizes: &Sizes) -> String {
    match sizes {
        Sizes::State(kinds, _) => format!("::mbs_runtime::state_sizes(q, qd, {kinds:?})"),
        Sizes::Parameters(all) => array_of(all),
    }
}
