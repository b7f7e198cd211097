//! The emitted text read again, and compared with the Programs that were proved: so that printing is proved, too.
//!
//! The text of each function is evaluated symbolically: every expression gets the number of its value, and so does
//! every instruction of the Program, in one table. A function is right where what it returns has the numbers of its
//! Program's results, in their shape, and constants their bits. Of the emitter only the module's name is used.
//!
//! - `numbering`: what is one value;
//! - `meaning`: what expressions mean, and what functions are to return;
//! - `rust`: Rust, as far as it is emitted, as a tree; `reader`: its meaning;
//! - `frame`: what stands around functions: types, traits, constants;
//! - `foreign`: the other languages, by one reader;
//! - `token`: words, numbers and marks of all of them.

mod foreign;
mod frame;
mod meaning;
mod numbering;
mod reader;
mod reading;
mod rust;
#[cfg(test)]
mod tests;
mod token;

use std::collections::{BTreeMap, BTreeSet};

use quote::ToTokens;
use syn::{ImplItem, Item, ItemImpl};

use crate::emit::{self, Language, Options};
use crate::expr::{Elimination, Number as Constant};
use crate::optimise::{Argument, Derivation, Function, FunctionKind};
use crate::verify::Failure;

use frame::{compact, path_of};
use meaning::{Expectation, Meaning, nested};
use numbering::Numbering;
use reader::{Method, Module, Reader};
use reading::Reading;
use rust::Block;

impl Derivation {
    /// Reads emitted code again, and compares each function with its Program.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; \
    ///             potential += k*x^2/2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
    /// use mbs_derive::emit::Language;
    /// let (programs, options) = (analysis.programs(), Default::default());
    /// let code = Language::C.write(programs, "spring.mbs", &options);
    /// assert!(programs.proofread(Language::C, &options, &code).is_ok());
    /// let misprint = programs.proofread(Language::C, &options, &code.replace("= k * x", "= k + x")).unwrap_err();
    /// assert!(misprint.to_string().contains("`(p_0 + q_0)` instead of `(p_0 * q_0)`"));
    /// ```
    ///
    /// # Errors
    /// [`Failure::Misprint`], with the function and what differs in it.
    pub fn proofread(&self, language: Language, options: &Options, code: &str) -> Result<(), Failure> {
        if language != Language::Rust {
            return foreign::proofread(self, language, options, code);
        }
        let cut = rust::cut(code).map_err(|what| misprint("module", what))?;
        let file = syn::parse_file(&cut.module).map_err(|error| misprint("module", error.to_string()))?;
        let [Item::Mod(module)] = file.items.as_slice() else {
            return Err(misprint("module", "the text is not one module".to_string()));
        };
        if module.ident != emit::module_name(self) {
            return Err(misprint("module", format!("`{}` is not its name", module.ident)));
        }
        let items = module.content.as_ref().map_or(&[][..], |(_, items)| items);
        Proofreader::new(self, options, &cut.bodies).module(items)
    }

    /// Reads the header of an interface again, and what is to follow it. Its forward dynamics is compared with the
    /// Program in which inputs stand for comparisons, and what it compares with the operands in this mechanism's own.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Stop { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; \
    ///             force x += if x < 1 m { 0 } else { k*(1 m - x) }; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("stop.mbs", text), &graph).unwrap();
    /// let mut interface = mbs_derive::emit::Interface::of(analysis.programs(), "stop.mbs");
    /// assert!(analysis.programs().proofread_interface(&interface).is_ok());
    /// interface.definitions = interface.definitions.replace("(x) - ", "(x) + ");
    /// assert!(analysis.programs().proofread_interface(&interface).is_err());
    /// ```
    ///
    /// # Errors
    /// [`Failure::Misprint`], with the function and what differs in it.
    pub fn proofread_interface(&self, interface: &emit::Interface) -> Result<(), Failure> {
        foreign::proofread_interface(self, interface)
    }
}

fn misprint(function: &str, what: String) -> Failure {
    Failure::Misprint { function: function.to_string(), what }
}

/// The functions that have arithmetic in them.
#[derive(Default)]
struct Bodies<'t> {
    /// The defaults of the parameters.
    default: Option<&'t syn::ImplItemFn>,
    check: Option<&'t syn::ImplItemFn>,
    /// `new`, `try_new`, `params`, the functions, and the constrained motion.
    methods: Vec<&'t syn::ImplItemFn>,
}

struct Proofreader<'d> {
    derivation: &'d Derivation,
    options: &'d Options,
    /// The texts of functions' bodies.
    bodies: &'d [&'d str],
    numbering: Numbering,
    expectation: Expectation<'d>,
    module: Module,
    /// The fields of `Params`, in the order of the declaration.
    fields: Vec<syn::Ident>,
}

impl<'d> Proofreader<'d> {
    fn new(derivation: &'d Derivation, options: &'d Options, bodies: &'d [&'d str]) -> Self {
        let mut numbering = Numbering::default();
        let expectation = Expectation::new(derivation, &mut numbering);
        let module = Module { trigonometry: options.trigonometry, ..Module::default() };
        Proofreader { derivation, options, bodies, numbering, expectation, module, fields: Vec::new() }
    }

    fn module(mut self, items: &[Item]) -> Result<(), Failure> {
        let bodies = self.bodies(items).map_err(|what| misprint("module", what))?;
        self.fields = self.parameters(items).map_err(|what| misprint("Params", what))?;
        self.tables(items).map_err(|what| misprint("tables", what))?;
        let parameters = self.read_parameters();
        self.default(bodies.default).map_err(|what| misprint("default", what))?;
        self.check(bodies.check, &parameters).map_err(|what| misprint("check", what))?;
        let mut methods = bodies.methods.into_iter();
        let new = methods.next();
        let fields = frame::fields_of_the_mechanism(items);
        let itself = self.constructor(new, parameters, &fields).map_err(|what| misprint("new", what))?;
        let methods: Vec<_> = methods.skip(2).collect();
        let functions = self.functions(&methods).map_err(|what| misprint("module", what))?;
        self.declare(&functions, &methods);
        for (function, method) in functions.iter().zip(&methods) {
            let found = self.function(function, method, &itself);
            found.map_err(|what| misprint(&function.name, what))?;
        }
        let named = |method: &syn::ImplItemFn, what| misprint(&method.sig.ident.to_string(), what);
        let mut of_constraints = methods.iter().skip(functions.len());
        if let Some(motion) = of_constraints.next() {
            self.motion(motion, &itself).map_err(|what| named(motion, what))?;
        }
        if let Some(system) = of_constraints.next() {
            self.system(system, &itself).map_err(|what| named(system, what))?;
        }
        self.frame(items, &functions, &methods).map_err(|what| misprint("module", what))
    }

    /// The functions with arithmetic, found among the items.
    fn bodies<'t>(&self, items: &'t [Item]) -> Reading<Bodies<'t>> {
        let mut bodies = Bodies::default();
        let functions = |block: &'t ItemImpl| {
            block.items.iter().filter_map(|item| match item {
                ImplItem::Fn(function) => Some(function),
                _ => None,
            })
        };
        for item in items {
            let Item::Impl(block) = item else { continue };
            let of = match &*block.self_ty {
                syn::Type::Path(of) => path_of(&of.path),
                _ => String::new(),
            };
            match (&block.trait_, of.as_str()) {
                (None, "Params") => bodies.check = functions(block).next(),
                (Some((of_trait, _)), "Params") if path_of(of_trait) == "core::default::Default" => {
                    bodies.default = functions(block).next();
                }
                (None, _) => bodies.methods.extend(functions(block)),
                _ => {}
            }
        }
        Ok(bodies)
    }

    /// The parameters as a record.
    fn read_parameters(&mut self) -> Meaning {
        let names: Vec<String> = self.fields.iter().map(ToString::to_string).collect();
        let values: Vec<Meaning> = (self.derivation.parameters.iter())
            .map(|parameter| self.expectation.parameter(parameter, &mut self.numbering))
            .collect();
        Meaning::record("Params", names.iter().map(String::as_str).zip(values))
    }

    /// The constants that are splines, and the order of elimination.
    fn tables(&mut self, items: &[Item]) -> Reading<()> {
        for item in items {
            let Item::Const(table) = item else { continue };
            if matches!(&*table.ty, syn::Type::Array(_)) {
                continue;
            }
            let text = table.expr.to_token_stream().to_string();
            let value = Reader::new(&self.module, &mut self.numbering, []).value(&rust::expression(&text)?)?;
            if table.ident == "ELIMINATION" {
                self.elimination(table, &value)?;
                self.module.constants.insert(table.ident.to_string(), value);
                continue;
            }
            let (number, columns) = self.table(&value).ok_or_else(|| format!("`{}` is no table", table.ident))?;
            if compact(&table.ty) != format!("::mbs_runtime::Spline<'static,{columns}>") {
                return Err(format!("`{}` has another number of columns", table.ident));
            }
            self.module.constants.insert(table.ident.to_string(), Meaning::Table(number));
        }
        Ok(())
    }

    /// The order of elimination.
    fn elimination(&self, constant: &syn::ItemConst, value: &Meaning) -> Reading<()> {
        let elimination = self.derivation.elimination.as_ref().ok_or("nothing is eliminated")?;
        let Elimination { order, entries, rows, .. } = elimination;
        let sizes = [order.len(), entries.len(), rows.len()].map(|size| size.to_string()).join(",");
        if compact(&constant.ty) != format!("::mbs_runtime::Elimination<{sizes}>") {
            return Err(format!("`{}` is of another size", constant.ident));
        }
        self.compare(value, &meaning::elimination(elimination))
    }

    /// The number of a spline, and how many columns it has.
    fn table(&mut self, value: &Meaning) -> Option<(usize, usize)> {
        let literals = |list: &Meaning| match list {
            Meaning::List(entries) => entries.iter().map(literal).collect::<Option<Vec<f64>>>(),
            _ => None,
        };
        match value {
            Meaning::Call(name, parts) if name == "mbs_runtime::Spline::new" => {
                let [places, Meaning::List(rows)] = &**parts else { return None };
                let rows = rows.iter().map(literals).collect::<Option<Vec<_>>>()?;
                Some((self.numbering.table(&literals(places)?, &rows), rows.first()?.len()))
            }
            _ => None,
        }
    }

    /// The declared values of the parameters.
    fn default(&mut self, default: Option<&syn::ImplItemFn>) -> Reading<()> {
        let default = default.ok_or("it is missing")?;
        let body = self.body_of(default)?;
        let found = Reader::new(&self.module, &mut self.numbering, []).block(&body)?;
        let mut fields = Vec::new();
        for (parameter, field) in self.derivation.parameters.iter().zip(&self.fields) {
            let constants = parameter.defaults.iter().copied().map(Constant::to_f64);
            let mut values = constants.map(|value| Meaning::Number(self.numbering.constant(value)));
            fields.push((field.to_string(), nested(&parameter.lengths(), &mut values)));
        }
        if fields.is_empty() {
            fields.push(("scalar".to_string(), Meaning::Path("core::marker::PhantomData".to_string())));
        }
        let fields = fields.iter().map(|(name, value)| (name.as_str(), value.clone()));
        self.compare(&found, &Meaning::record("Self", fields))
    }

    /// What is required of the parameters.
    fn check(&mut self, check: Option<&syn::ImplItemFn>, parameters: &Meaning) -> Reading<()> {
        let check = check.ok_or("it is missing")?;
        let body = self.body_of(check)?;
        let mut reader = Reader::new(&self.module, &mut self.numbering, [("self", parameters.clone())]);
        let result = reader.block(&body)?;
        let found = reader.required;
        self.compare(&result, &Meaning::Tuple([].into()))?;
        let expected = self.requirements();
        self.compare(&Meaning::list(found), &Meaning::list(expected))
    }

    fn requirements(&mut self) -> Vec<Meaning> {
        let condition = |name: &str| Meaning::Path(format!("mbs_runtime::ParameterCondition::{name}"));
        let mut required = Vec::new();
        for parameter in &self.derivation.parameters {
            for (i, name) in parameter.component_names().into_iter().enumerate() {
                let symbol = crate::expr::Symbol::Parameter((parameter.first + i) as u32);
                let value = Meaning::Number(self.numbering.symbol(symbol));
                required.push(Meaning::call("parameter::require", [Meaning::Text(name), value, condition("Finite")]));
            }
        }
        let values = self.numbering.results(&self.derivation.required, &[], |_| false);
        for (requirement, values) in self.derivation.conditions(&values) {
            let quantity = Meaning::Text(requirement.quantity.clone());
            let condition = condition(&format!("{:?}", requirement.condition));
            let numbers = || values.iter().copied().map(Meaning::Number);
            required.push(match values {
                [value] => Meaning::call("parameter::require", [quantity, Meaning::Number(*value), condition]),
                _ => Meaning::call("parameter::require_inertia", [quantity, Meaning::list(numbers()), condition]),
            });
        }
        required
    }

    /// What `self` is to the functions: the parameters, and what the constructor has computed.
    fn constructor(
        &mut self,
        new: Option<&syn::ImplItemFn>,
        parameters: Meaning,
        fields: &[syn::Ident],
    ) -> Reading<Meaning> {
        let new = new.filter(|new| new.sig.ident == "new").ok_or("it is missing")?;
        let body = self.body_of(new)?;
        let mut reader = Reader::new(&self.module, &mut self.numbering, [("params", parameters.clone())]);
        let found = reader.block(&body)?;
        match &found {
            Meaning::Record(path, made)
                if path == "Self"
                    && made.get("params") == Some(&parameters)
                    && fields.iter().map(ToString::to_string).collect::<BTreeSet<_>>().iter().eq(made.keys()) =>
            {
                Ok(found)
            }
            _ => Err("the constructor does not keep its parameters, or makes other fields than there are".to_string()),
        }
    }

    /// The functions that the text has, in its order.
    fn functions(&self, methods: &[&syn::ImplItemFn]) -> Reading<Vec<&'d Function>> {
        let is_public = |method: &&&syn::ImplItemFn| matches!(method.vis, syn::Visibility::Public(_));
        let identifiers: Vec<String> =
            methods.iter().take_while(is_public).map(|method| method.sig.ident.to_string()).collect();
        if methods.len() > identifiers.len() + 2 {
            return Err("there is a function too much".to_string());
        }
        let is_asked_for = |f: &Function| self.options.functions.as_ref().is_none_or(|names| names.contains(&f.name));
        let mut known: BTreeMap<&str, usize> = ["new", "try_new", "params", "default", "clone"].map(|n| (n, 0)).into();
        let (mut found, mut rest) = (Vec::new(), identifiers.iter().peekable());
        for function in &self.derivation.functions {
            let is_taken = known.insert(&function.name, 0).is_some();
            match rest.peek() {
                Some(identifier) if frame::spells(identifier, &function.name, is_taken) => {
                    rest.next();
                    found.push(function);
                }
                _ if is_asked_for(function) => return Err(format!("`{}` is missing", function.name)),
                _ => {}
            }
        }
        match rest.next() {
            Some(identifier) => Err(format!("`{identifier}` is no function of the mechanism")),
            None => Ok(found),
        }
    }

    /// Makes known what functions give when others call them.
    fn declare(&mut self, functions: &[&'d Function], methods: &[&syn::ImplItemFn]) {
        let Some(forward_dynamics) = self.derivation.function(FunctionKind::ForwardDynamics) else { return };
        let of_the_motion =
            |argument, reader: &mut Self| reader.expectation.of_the_motion(argument, &mut reader.numbering);
        let accelerations = of_the_motion(Argument::Qdd, self);
        let arguments = self.expectation.arguments(forward_dynamics, &mut self.numbering);
        let arguments: Vec<Meaning> = arguments.into_iter().map(|(_, meaning)| meaning).collect();
        if forward_dynamics.completion.is_constrained() {
            if let Some(motion) = methods.get(functions.len()) {
                let multipliers = of_the_motion(Argument::Multipliers, self);
                let result = Meaning::Tuple([accelerations, multipliers].into());
                self.module.methods.insert(motion.sig.ident.to_string(), Method { arguments, result });
            }
            return;
        }
        let is_it = |(f, _): &(&&Function, &&syn::ImplItemFn)| f.kind == FunctionKind::ForwardDynamics;
        if let Some((_, method)) = functions.iter().zip(methods).find(is_it) {
            let result = accelerations;
            self.module.methods.insert(method.sig.ident.to_string(), Method { arguments, result });
        }
    }

    /// One function against its Program.
    fn function(&mut self, function: &Function, method: &syn::ImplItemFn, itself: &Meaning) -> Reading<()> {
        let found = self.body(function, method, itself)?;
        let expected = self.expectation.returned(function, &mut self.numbering);
        self.compare(&found, &expected)
    }

    /// The motion with constraints against the Program of forward dynamics.
    fn motion(&mut self, method: &syn::ImplItemFn, itself: &Meaning) -> Reading<()> {
        let forward_dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        let forward_dynamics =
            forward_dynamics.filter(|f| f.completion.is_constrained()).ok_or("there is no such function")?;
        let found = self.body(forward_dynamics, method, itself)?;
        let expected = self.expectation.motion(forward_dynamics, &mut self.numbering);
        self.compare(&found, &expected)
    }

    /// What is not zero of M and A against the Program of forward dynamics.
    fn system(&mut self, method: &syn::ImplItemFn, itself: &Meaning) -> Reading<()> {
        let forward_dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        let eliminated = forward_dynamics.filter(|_| self.derivation.elimination.is_some());
        let forward_dynamics = eliminated.ok_or("there is no such function")?;
        let found = self.body(forward_dynamics, method, itself)?;
        let expected = self.expectation.entries(forward_dynamics, &mut self.numbering);
        self.compare(&found, &expected)
    }

    /// What a function returns or writes by its text.
    fn body(&mut self, function: &Function, method: &syn::ImplItemFn, itself: &Meaning) -> Reading<Meaning> {
        let arguments = self.expectation.arguments(function, &mut self.numbering);
        let bound = [("self", itself.clone())].into_iter().chain(arguments);
        let body = self.body_of(method)?;
        let mut reader = Reader::new(&self.module, &mut self.numbering, bound);
        match method.sig.output {
            syn::ReturnType::Default => reader.written(&body, "result", meaning::unwritten(function)),
            syn::ReturnType::Type(..) => reader.block(&body),
        }
    }

    /// What stands in a function.
    fn body_of(&self, function: &syn::ImplItemFn) -> Reading<Block<'d>> {
        let text = rust::body_of(&function.block).and_then(|number| self.bodies.get(number));
        rust::block(text.ok_or("it has no body")?)
    }

    fn compare(&self, found: &Meaning, expected: &Meaning) -> Reading<()> {
        found.difference(expected, &self.numbering).map_or(Ok(()), Err)
    }
}

fn literal(meaning: &Meaning) -> Option<f64> {
    match meaning {
        Meaning::Literal(value) => Some(*value),
        _ => None,
    }
}
