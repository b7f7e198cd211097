//! Pass 6: [`Derivation`] → Rust, one module a mechanism.
//!
//! - `item`: the module, its structs and functions;
//! - `traits`: the runtime's traits, implemented by them;
//! - `shape`: results, their types and components; `solution`: systems that are solved for them;
//! - `parameter`: its parameters and what they must satisfy;
//! - `doc`: what its documentation says;
//! - `body`: one function body: bindings, then the result;
//! - `angles`: which sines and cosines one call computes;
//! - `text`: its text;
//! - `expression`: how values are written: order of operands, parentheses, fused multiply–add;
//! - `statement`: what a body is made of;
//! - `segment`: long bodies in blocks;
//! - `name`: identifiers, from the declaration where they can be;
//! - `outline`: a long module without its function bodies, for review;
//! - `walk`: what all other languages have in common: which statements stand where;
//! - `c`: the same in C99, C++, CUDA and OpenCL C;
//! - `script`: the same in languages that are not compiled;
//! - `language`: the list of languages; `identifiers`: what a text in one of them calls things.
//!
//! The code links mbs-runtime by absolute path and nothing else. It computes what [`interpret`](crate::interpret)
//! computes, to the bit, except where the target has a fused multiply–add. Its text depends on the derivation alone.

mod angles;
mod body;
mod c;
mod doc;
mod expression;
mod identifiers;
mod item;
mod language;
mod name;
mod outline;
mod parameter;
mod script;
mod segment;
mod shape;
mod solution;
mod statement;
mod text;
mod traits;
mod walk;

pub use crate::expr::sin_cos::Trigonometry;
use crate::optimise::Derivation;
pub use c::Interface;
pub(crate) use identifiers::{Identifiers, shared};
pub use language::Language;

/// What is generated.
///
/// ```
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let options = mbs_derive::emit::Options::default().freeze(["k"]);
/// let module = mbs_derive::generate("spring.mbs", text, &options).unwrap();
/// assert!(!module.code.contains("pub k: T"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Options {
    /// Derive serde's traits for the parameters, through `::mbs_runtime::serde`. serde knows arrays of up to 32.
    pub serde: bool,
    /// Parameters that become constants with their declared defaults; carried out by `model`.
    pub freeze: Vec<String>,
    /// The functions to generate, with those that they call; `None` for all.
    pub functions: Option<Vec<String>>,
    /// Write `a * b + c` instead of `a.mul_add(b, c)`: for people who review the code. It computes the same bits where
    /// the target has no fused multiply–add.
    pub infix: bool,
    /// Which sines and cosines are computed.
    pub trigonometry: Trigonometry,
    /// Languages that the mechanism is written in besides Rust; carried out where files are made.
    pub languages: Vec<Language>,
}

impl Options {
    /// Derives serde's traits for the parameters, or does not.
    #[must_use]
    pub fn serde(mut self, serde: bool) -> Self {
        self.serde = serde;
        self
    }

    /// Makes these parameters constants, too.
    #[must_use]
    pub fn freeze<S: Into<String>>(mut self, parameters: impl IntoIterator<Item = S>) -> Self {
        self.freeze.extend(parameters.into_iter().map(Into::into));
        self
    }

    /// Generates these functions alone, with those that they call, added to those that were named before.
    ///
    /// Not derived either are C and G, the derivatives of inverse dynamics, and those of accelerations, where none of
    /// them is named: their cost grows with the square of the number of coordinates.
    #[must_use]
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.functions.get_or_insert_default().extend(names.into_iter().map(Into::into));
        self
    }

    /// Writes `a * b + c`, or `a.mul_add(b, c)`.
    #[must_use]
    pub fn infix(mut self, infix: bool) -> Self {
        self.infix = infix;
        self
    }

    /// Chooses the sines and cosines.
    #[must_use]
    pub fn trigonometry(mut self, trigonometry: Trigonometry) -> Self {
        self.trigonometry = trigonometry;
        self
    }

    /// Writes the mechanism in these languages as well.
    #[must_use]
    pub fn languages(mut self, languages: impl IntoIterator<Item = Language>) -> Self {
        self.languages.extend(languages);
        self
    }
}

/// The module of a mechanism, formatted, to be included where items may stand.
///
/// `source` is what the first line calls the declaration.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let module = mbs_derive::emit::rust(analysis.programs(), "spring.mbs", &Default::default());
/// assert!(module.starts_with("// Generated by mbs"));
/// ```
pub fn rust(derivation: &Derivation, source: &str, options: &Options) -> String {
    printed(&file(derivation, options), source)
}

/// The module without the functions of the runtime's traits, which call those that are generated.
pub(crate) fn without_forwarders(derivation: &Derivation, source: &str, options: &Options) -> String {
    let mut file = file(derivation, options);
    outline::leave_out_forwarders(&mut file.items);
    printed(&file, source)
}

/// The module with long function bodies left out; a digest of each is in its documentation.
pub(crate) fn outline(derivation: &Derivation, source: &str, options: &Options) -> String {
    let mut file = file(derivation, options);
    outline::leave_out_forwarders(&mut file.items);
    outline::leave_out_bodies(&mut file.items);
    printed(&file, source)
}

fn file(derivation: &Derivation, options: &Options) -> syn::File {
    syn::parse2(item::module(derivation, options)).expect("the emitted tokens are Rust")
}

fn printed(file: &syn::File, source: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let source: String = source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let text = spaced(&prettyplease::unparse(file));
    format!("// Generated by mbs {version} from {source}. Do not edit.\n\n{text}")
}

/// An empty line between items, which the formatter does not leave.
fn spaced(text: &str) -> String {
    let begins_item = |line: &str| ["///", "#[", "pub ", "impl", "fn "].iter().any(|start| line.starts_with(start));
    let mut spaced = String::with_capacity(text.len());
    let mut after_item = false;
    for line in text.lines() {
        if after_item && begins_item(line.trim_start()) {
            spaced.push('\n');
        }
        spaced.push_str(line);
        spaced.push('\n');
        after_item = line.trim_start() == "}";
    }
    spaced
}

/// The name of the struct: the mechanism's, escaped where that is a keyword of Rust.
pub(crate) fn type_name(derivation: &Derivation) -> String {
    name::type_name(&derivation.name)
}

/// The name of the module: the mechanism's in snake case.
pub(crate) fn module_name(derivation: &Derivation) -> String {
    name::identifier(&name::snake_case(&derivation.name))
}

/// Whether the module implements `mbs_runtime::Mechanism`: all functions of the traits are generated.
pub(crate) fn implements_mechanism(derivation: &Derivation, options: &Options) -> bool {
    traits::implements_mechanism(derivation, options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Expr, Graph, Number, Symbol};
    use crate::model::lagrangian::Output;
    use crate::model::{Lagrangian, OutputValue};
    use crate::optimise::{Instruction, Program, Value};

    fn derivation(name: &str, declare: impl for<'g> Fn(&mut Lagrangian<'g>)) -> Derivation {
        let graph = Graph::verbatim();
        let mut lagrangian = Lagrangian::new(&graph, name);
        declare(&mut lagrangian);
        crate::derived(&lagrangian)
    }

    /// A mass on a spring, with a force.
    fn oscillator(name: &str, coordinate: &str, mass: &str) -> Derivation {
        derivation(name, |lagrangian| {
            let half = 1 / lagrangian.graph.integer(2);
            let m = lagrangian.parameter(mass, "kg", Number::ONE);
            let k = lagrangian.parameter("k", "N/m", Number::parse_decimal("0.1").unwrap());
            let x = lagrangian.coordinate(coordinate, "m", None)[0];
            let f = lagrangian.input("force", "N", None)[0];
            lagrangian.kinetic.push(half * m * x.rate().powi(2));
            lagrangian.potential.push(half * k * x.powi(2));
            lagrangian.forces.push((0, f));
        })
    }

    /// A link of length 1 and mass 1, all constants: no parameters, no inputs.
    fn chain(n: usize) -> Derivation {
        derivation("Chain", |lagrangian| {
            let graph = lagrangian.graph;
            let q = lagrangian.coordinate("q", "rad", Some(n));
            let (mut x, mut y) = (graph.integer(0), graph.integer(0));
            for &angle in &q {
                (x, y) = (x + angle.sin(), y - angle.cos());
                lagrangian.kinetic.push((x.rate().powi(2) + y.rate().powi(2)) / graph.integer(2));
                lagrangian.potential.push(y * graph.integer(10));
            }
        })
    }

    fn emitted(derivation: &Derivation) -> String {
        let text = rust(derivation, "mechanisms/x.mbs", &Options::default());
        syn::parse_file(&text).expect("a module");
        assert_eq!(text, rust(derivation, "mechanisms/x.mbs", &Options::default()));
        text
    }

    #[track_caller]
    fn check(text: &str, lines: &[&str]) {
        let found: Vec<&str> = text.lines().map(str::trim).collect();
        let is_there = |lines: &[&str]| found.windows(lines.len()).any(|window| window == lines);
        assert!(is_there(lines), "{lines:#?} not in\n{text}");
    }

    #[test]
    fn a_function_reads_like_the_textbook() {
        let text = emitted(&oscillator("Oscillator", "x", "m"));
        check(&text, &["// Generated by mbs 0.1.0 from mechanisms/x.mbs. Do not edit."]);
        check(&text, &["pub mod oscillator {"]);
        check(&text, &["/// Unit: N/m, default: 0.1.", "pub k: T,"]);
        check(
            &text,
            &[
                "pub fn inverse_dynamics(&self, q: &[T; 1], qd: &[T; 1], qdd: &[T; 1]) -> [T; 1] {",
                "let [x] = *q;",
                "let [x_ddot] = *qdd;",
                "let Params { m, k } = self.params;",
                "[m.mul_add(x_ddot, k * x)]",
                "}",
            ],
        );
        check(&text, &["impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::Mechanism<1, 1> for Oscillator<T> {"]);
        check(&text, &["pub const PARAMETERS: [&str; 2] = [\"m\", \"k\"];"]);
        check(&text, &["/// `force`", "pub const FORCE: usize = 0;"]);
    }

    #[test]
    fn awkward_names_are_made_good() {
        let text = emitted(&oscillator("Params", "q", "T"));
        check(&text, &["pub struct ParamsMechanism<T = f64> {"]);
        check(&emitted(&oscillator("f64", "q", "x")), &["pub struct f64Mechanism<T = f64> {"]);
        check(&text, &["let [q] = *q;", "let [q_ddot] = *qdd;", "let Params { T: T_2, k } = self.params;"]);
        let text = emitted(&oscillator("Match", "zero", "force_dot"));
        check(&text, &["pub mod match_ {"]);
    }

    #[test]
    fn no_parameters_and_no_inputs() {
        let text = emitted(&chain(1));
        check(&text, &["pub struct Params<T = f64> {", "scalar: ::core::marker::PhantomData<T>,", "}"]);
        check(&text, &["pub fn forward_dynamics(&self, q: &[T; 1], qd: &[T; 1]) -> [T; 1] {"]);
        check(&text, &["const INPUTS: [&'static str; 0] = [];"]);
        check(&text, &["pub const Q: ::core::ops::Range<usize> = 0..1;"]);
    }

    #[test]
    fn large_mechanisms_are_solved_by_the_runtime() {
        let text = emitted(&chain(9));
        check(&text, &["::mbs_runtime::ldlt_solve(mass_matrix, right_side)"]);
        check(&text, &["let qdd = &self.forward_dynamics(q, qd);"]);
        check(&text, &["let factors = ::mbs_runtime::Ldlt::new(mass_matrix);"]);
    }

    #[test]
    fn chosen_functions_and_what_they_call() {
        let chosen = |derivation: &Derivation, name: &str| {
            let options = Options { functions: Some(vec![name.to_string()]), ..Options::default() };
            let text = rust(derivation, "x.mbs", &options);
            let functions = text.lines().filter_map(|line| line.trim().strip_prefix("pub fn "));
            let names: Vec<String> = functions.map(|f| f[..f.find('(').unwrap()].to_string()).collect();
            let traits = text.lines().filter_map(|line| line.trim().strip_prefix("/// Implements "));
            names.join(" ") + &traits.collect::<String>()
        };
        assert_eq!(chosen(&chain(2), "gravity"), "check new try_new params gravity");
        assert_eq!(chosen(&chain(2), "linearize"), "check new try_new params linearize");
        let with = "`Dynamics`, `Linearized` of mbs-runtime.";
        assert_eq!(
            chosen(&chain(9), "linearize"),
            format!("check new try_new params forward_dynamics linearize{with}")
        );
    }

    #[test]
    fn serde_goes_through_the_runtime() {
        let options = Options { serde: true, ..Options::default() };
        let text = rust(&oscillator("Oscillator", "x", "self"), "x.mbs", &options);
        assert!(text.contains("try_from = \"UncheckedParams<T>\""), "{text}");
        assert!(text.contains("::core::convert::TryFrom<UncheckedParams<T>>"), "{text}");
        check(&text, &["#[serde(rename = \"self\")]", "pub self_: T,"]);
    }

    #[test]
    fn an_output_does_not_take_the_name_of_a_function() {
        let text = emitted(&derivation("Slider", |lagrangian| {
            let x = lagrangian.coordinate("x", "m", None)[0];
            lagrangian.kinetic.push(x.rate().powi(2));
            let value = OutputValue::Scalar(x);
            lagrangian.outputs.push(Output {
                name: "gravity".to_string(),
                docs: Vec::new(),
                units: vec!["m".to_string()],
                value,
                jacobian_rate: false,
            });
        }));
        check(&text, &["pub fn gravity_2(&self, q: &[T; 1]) -> T {"]);
    }

    /// A force that is `sides(x, 0)`.
    fn pushed(sides: impl for<'g> Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> String {
        let text = emitted(&derivation("Pushed", |lagrangian| {
            let x = lagrangian.coordinate("x", "m", None)[0];
            lagrangian.kinetic.push(x.rate().powi(2));
            let force = sides(x, lagrangian.graph.integer(0));
            lagrangian.forces.push((0, force));
        }));
        let start = text.find("pub fn generalized_force").unwrap();
        text[start..start + text[start..].find("///").unwrap()].to_string()
    }

    #[test]
    fn a_side_of_a_branch_is_computed_there() {
        let text = pushed(|x, zero| x.graph().select(zero.less(x), x.sqrt(), -(1 / x)));
        check(
            &text,
            &[
                "let generalized_force_0 = T::select(",
                "T::zero().less(x),",
                "|| x.sqrt(),",
                "|| -T::one() / x,",
                ");",
                "[generalized_force_0]",
            ],
        );
        let text = pushed(|x, zero| x.graph().select(zero.less(x), x.sin() * x.sqrt() + x.sqrt(), x));
        let sine = "let ([sin_x], _) = T::sin_cos_all([x]);";
        let side = ["|| {", "let sqrt_x = x.sqrt();", sine, "sqrt_x.mul_add(sin_x, sqrt_x)", "},", "|| x,"];
        check(&text, &side);
        // Both sides are known.
        check(
            &pushed(|x, zero| x.graph().select(zero.less(x), x, zero)),
            &["let generalized_force_0 = T::blend(zero.less(x), x, zero);", "[generalized_force_0]"],
        );
    }

    #[test]
    fn sines_of_angles_that_are_known_together_are_one_call() {
        // The first needs nothing, the second a sum, the third a sine.
        let text = pushed(|x, _| {
            let sum = x + x.sqrt();
            x.sin() * sum.cos() + sum.sin() * x.sin().cos()
        });
        let together = [
            "let ([sin_sqrt_x_plus_x, sin_x], [cos_sqrt_x_plus_x, _]) = T::sin_cos_all([",
            "x.sqrt() + x,",
            "x,",
            "]);",
            "let (_, [cos_sin_x]) = T::sin_cos_all([sin_x]);",
        ];
        check(&text, &together);
        // Of different sides none is computed for the other, and what is certain does not wait for them.
        let text = pushed(|x, zero| x.graph().select(zero.less(x), x.sin(), (x + x).sin()) + (3 * x).cos());
        check(&text, &["let (_, [cos_3_x]) = T::sin_cos_all([three * x]);"]);
        assert_eq!(text.matches("sin_cos_all").count(), 3, "{text}");
        // The angle of the second is the sine that the first call is for.
        let text = pushed(|x, _| x.sin() + x.sin().cos());
        check(&text, &["let ([sin_x], _) = T::sin_cos_all([x]);", "let (_, [cos_sin_x]) = T::sin_cos_all([sin_x]);"]);
    }

    #[test]
    fn sines_of_the_library_come_one_by_one() {
        let options = Options { trigonometry: Trigonometry::Library, ..Options::default() };
        let text = rust(&chain(2), "x.mbs", &options);
        assert!(text.contains(".sin_cos();") && text.contains(".sin()") && !text.contains("sin_cos_all"), "{text}");
    }

    #[test]
    fn what_several_branches_may_need_is_computed_on_demand() {
        let text = pushed(|x, zero| {
            let graph = x.graph();
            graph.select(zero.less(x), x.sqrt(), zero) + graph.select(x.less(zero - 1), zero, x.sqrt() * 3)
        });
        let root = "let sqrt_x: &dyn Fn() -> T = &|| x.sqrt();";
        check(&text, &[root, "let sqrt_x = ::core::cell::LazyCell::new(sqrt_x);"]);
        check(&text, &["let generalized_force_0_a = T::select(zero.less(x), || *sqrt_x, || zero);"]);
    }

    #[test]
    fn selections_on_one_condition_are_one_branch() {
        let text = emitted(&derivation("Pushed", |lagrangian| {
            let (graph, q) = (lagrangian.graph, lagrangian.coordinate("q", "m", Some(2)));
            let condition = q[0].less(q[1]);
            for (i, side) in [q[0].sqrt() * 2, q[0].sqrt() * 3].into_iter().enumerate() {
                lagrangian.kinetic.push(q[i].rate().powi(2));
                lagrangian.forces.push((i, graph.select(condition, side, q[1])));
            }
        }));
        check(&text, &["let sqrt_q_0 = q_0.sqrt();", "[two * sqrt_q_0, three * sqrt_q_0]"]);
    }

    #[test]
    fn long_sides_come_in_blocks() {
        let side = |x: Expr<'_>| (0..1500).fold(x, |a, _| a * (a + 1)).id();
        let text = pushed(|x, zero| {
            let graph = x.graph();
            graph.select(zero.less(x), graph.expr(side(x)), x)
        });
        let blocks: Vec<usize> = text.split("{\n").map(|block| block.matches("let ").count()).collect();
        assert!(
            blocks.iter().all(|&statements| statements <= 1000) && blocks.iter().sum::<usize>() > 1500,
            "{blocks:?}"
        );
    }

    #[test]
    fn branches_are_nested_no_deeper_than_compilers_like() {
        // On a small stack: formatting is recursive.
        let text =
            pushed(|x, _| (0..300).fold(x, |f, i| x.graph().select(x.less(x.graph().integer(i)), f, (x + i).sqrt())));
        let deepest = text.lines().map(|line| line.len() - line.trim_start().len()).max().unwrap();
        assert!((200..2000).contains(&deepest), "{deepest} spaces");
        assert!(text.contains("LazyCell"));
    }

    #[test]
    fn long_bodies_come_in_blocks() {
        let mut derivation = oscillator("Long", "x", "m");
        // v ← (v + x)², many times: each sum is used twice.
        let mut instructions = vec![Instruction::Symbol(Symbol::Coordinate(0))];
        let mut last = Value(0);
        for _ in 0..2500 {
            let sum = Value(instructions.len() as u32);
            instructions.extend([Instruction::Add(last, Value(0)), Instruction::Mul(sum, sum)]);
            last = Value(sum.0 + 1);
        }
        let gravity = derivation.altered().functions.iter_mut().find(|f| f.name == "gravity").expect("there is one");
        gravity.program = Program::new(instructions, vec![last], Vec::new());
        let text = emitted(&derivation);
        let start = text.find("pub fn gravity").unwrap();
        let body = &text[start..start + text[start..].find("///").unwrap()];
        let blocks: Vec<usize> = body.split("{\n").skip(2).map(|block| block.matches("let ").count()).collect();
        assert_eq!(blocks.len(), 3);
        assert!(blocks.iter().all(|statements| (500..=1000).contains(statements)), "{blocks:?}");
    }
}
