//! The functions of a mechanism, and systems of linear equations in their last step: accelerations, multipliers and
//! their derivatives.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Elimination;
use crate::optimise::FunctionKind;
use crate::shape::Shape;

use super::super::doc;
use super::super::name::{escaped, ident};
use super::super::walk::{Argued, Ending, Motion, Routine, Sizes};
use super::shape::{array, array_of, shape_type, shaped};
use super::{Module, tokens};

impl Module<'_> {
    /// All of them; what those with constraints have in common comes last.
    pub(super) fn functions(&self) -> TokenStream {
        let routines = self.walk.routines(&self.with("self.params"));
        let (motion, public): (Vec<_>, Vec<_>) = routines.iter().partition(|routine| routine.is_motion());
        let functions = public.into_iter().chain(motion).map(|routine| self.function(routine));
        quote!(#(#functions)*)
    }

    fn function(&self, routine: &Routine) -> TokenStream {
        let (docs, name) = (doc::attributes(&routine.docs), ident(&escaped(&routine.name)));
        let visibility = (!routine.is_motion()).then(|| quote!(pub));
        let arguments = self.arguments(&routine.arguments);
        let shapes: Vec<Shape> = routine.parts.iter().map(|(_, shape)| *shape).collect();
        let (result, body) = (self.result_type(routine.kind, &shapes), tokens(&self.body(routine)));
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
    fn body(&self, routine: &Routine) -> String {
        let given: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
        let (given, lines) = (given.join(", "), routine.lines.join("\n"));
        let motion = format!("self.{}({given})", self.walk.names.constrained_motion);
        match &routine.ending {
            Ending::Values => format!("{lines}\n{}", assembled(routine, &in_shape(routine))),
            Ending::Solve => {
                let called = || format!("let qdd = &self.{}({given});\n", escaped(&self.walk.forward_dynamics()));
                let accelerations = (routine.motion == Motion::Accelerations).then(called).unwrap_or_default();
                format!("{accelerations}{lines}\n{}", self.solved(routine))
            }
            Ending::Motion => format!("{lines}\n{}", self.constrained(routine)),
            Ending::OfMotion(part) => format!("{motion}.{}", usize::from(*part != "qdd")),
            Ending::Slopes(sizes) => {
                let scale = &self.walk.names.scale;
                let measured =
                    format!("let (qdd, multipliers) = &{motion};\nlet {scale} = (qdd, {});", measures(sizes));
                format!("{measured}\n{lines}\n{}", self.slopes(routine))
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
                format!("{mass_matrix}\n{right_side}\n::mbs_runtime::{solve}(mass_matrix, right_side)")
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
        if let Some(tables) = self.tables_of_elimination() {
            return format!("{tables}\n::mbs_runtime::sparse_solve({system}, {right_sides})");
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
        let tables = self.tables_of_elimination();
        let solution = match &tables {
            Some(_) => format!("::mbs_runtime::sparse_slopes({system}, {right_sides})"),
            None => {
                let measures = format!("{vectors:?}, {scale}.0, {scale}.1");
                format!("::mbs_runtime::constrained_slopes({system}, {right_sides}, {measures})")
            }
        };
        let tables = tables.unwrap_or_default();
        let widths = routine.widths();
        if widths.len() == 1 {
            return tables + &solution;
        }
        let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
        let parts = starts.map(|start| {
            let first = if start > 0 { format!("{start} + ") } else { String::new() };
            format!("::core::array::from_fn(|i| ::core::array::from_fn(|j| solution[i][{first}j]))")
        });
        format!("{tables}let solution = {solution};\n{}", assembled(routine, &parts.collect::<Vec<_>>()))
    }

    /// M and A, or the order in which they are eliminated and their entries.
    fn system(&self, routine: &Routine) -> String {
        if !routine.entries.is_empty() {
            let fields = ["order: &ORDER", "ends: &ENDS", "rows: &ROWS", "places: &PLACES"].join(", ");
            return format!("&::mbs_runtime::Elimination {{ {fields} }}, {}", array_of(&routine.entries));
        }
        let n = self.walk.derivation.dof();
        format!("{}, {}", rows(&routine.mass_matrix, n), rows(&routine.jacobian, n))
    }

    /// The order of elimination, where there is one.
    fn tables_of_elimination(&self) -> Option<String> {
        let Elimination { order, starts, rows, places, .. } = self.walk.derivation.elimination.as_ref()?;
        let table = |name: &str, of: &str, numbers: &[usize]| {
            let listed: Vec<String> = numbers.iter().map(ToString::to_string).collect();
            format!("static {name}: [{of}; {}] = [{}];\n", numbers.len(), listed.join(", "))
        };
        let tables = [("ORDER", "u16", order.as_slice()), ("ENDS", "u32", &starts[1..]), ("ROWS", "u16", rows)];
        let tables = tables.into_iter().chain([("PLACES", "u32", places.as_slice())]);
        Some(tables.map(|(name, of, numbers)| table(name, of, numbers)).collect())
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

/// What a function returns, of its parts.
fn assembled(routine: &Routine, parts: &[String]) -> String {
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

/// How large that is by which each column of a linearization is a derivative.
fn measures(sizes: &Sizes) -> String {
    match sizes {
        Sizes::State(kinds, _) => format!("::mbs_runtime::state_sizes(q, qd, {kinds:?})"),
        Sizes::Parameters(all) => array_of(all),
    }
}
