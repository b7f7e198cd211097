//! One mechanism through the passes: the face of the generator.

use crate::builder::Mechanism;
use crate::derive::{self, LeftOut, Route};
use crate::diagnostic::Diagnostics;
use crate::emit::{self, Language, Options};
use crate::expr::Graph;
use crate::generated::{Error, Generated};
use crate::latex;
use crate::model::{self, Lagrangian};
use crate::optimise::{self, Derivation, FunctionKind, Operations};
use crate::parse::{self, syntax::Declaration};
use crate::scene::Scene;
use crate::source::Sources;
use crate::variable;
use crate::verify::Proof;

/// What is derived from one mechanism, of a text or of calls; the Programs are not proved before they are printed.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param m: kg = 1; param k: N/m = 4; coord x: m; \
///             kinetic += m*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// assert_eq!(analysis.lagrangian().dof(), 1);
/// assert!(analysis.latex().contains("frac"));
/// assert!(analysis.rust(&Default::default()).unwrap().code.contains("fn mass_matrix"));
/// ```
#[derive(Debug)]
pub struct Analysis<'g> {
    sources: Sources,
    lagrangian: Lagrangian<'g>,
    warnings: Diagnostics,
    programs: Derivation,
    nodes: usize,
}

impl<'g> Analysis<'g> {
    /// The mechanism of a text and of all that it imports; its Lagrangian is written into the verbatim `graph`.
    ///
    /// # Errors
    /// [`Error::Declaration`] if the text is not a mechanism.
    pub fn of(sources: &Sources, graph: &'g Graph) -> Result<Self, Error> {
        Self::frozen(sources, graph, &[])
    }

    /// The mechanism of a text, its parameters named in `freeze` constants.
    ///
    /// # Errors
    /// [`Error::Declaration`] if the text is not a mechanism, or has no parameter of such a name.
    pub fn frozen(sources: &Sources, graph: &'g Graph, freeze: &[String]) -> Result<Self, Error> {
        let (lagrangian, warnings) = declared_from(sources, graph, freeze)?;
        Ok(Self::new(sources.clone(), lagrangian, warnings, LeftOut::default()))
    }

    /// The mechanism that calls have written, its parameters named in `freeze` constants.
    ///
    /// # Errors
    /// [`Error::Declaration`] if what they have written is not a mechanism, or has no parameter of such a name.
    pub fn written(mechanism: &Mechanism, graph: &'g Graph, freeze: &[String]) -> Result<Self, Error> {
        let (lagrangian, warnings) = resolved(mechanism.declaration()?, graph, freeze)?;
        Ok(Self::new(mechanism.sources(), lagrangian, warnings, LeftOut::default()))
    }

    /// The mechanism of a text with its parameters named in `options.freeze` constants, and of its functions those that
    /// `options.functions` names; functions that cost little are there besides.
    ///
    /// # Errors
    /// [`Error::Declaration`] if the text is not a mechanism; [`Error::UnknownFunction`] if the options ask for a
    /// function that there is not.
    pub fn with_options(sources: &Sources, graph: &'g Graph, options: &Options) -> Result<Self, Error> {
        Self::asked_for(parse::declaration_of(sources)?, sources.clone(), graph, options)
    }

    /// What is needed for the functions that the options ask for, of a mechanism and its texts.
    fn asked_for(
        declaration: Declaration,
        sources: Sources,
        graph: &'g Graph,
        options: &Options,
    ) -> Result<Self, Error> {
        let (lagrangian, warnings) = resolved(declaration, graph, &options.freeze)?;
        let analysis = Self::new(sources, lagrangian, warnings, left_out(options.functions.as_deref()));
        analysis.knows_all(options).map(|()| analysis)
    }

    fn new(sources: Sources, lagrangian: Lagrangian<'g>, warnings: Diagnostics, left_out: LeftOut) -> Self {
        let left_out = of_many(&lagrangian, left_out);
        let is_long = left_out.mass_matrix && lagrangian.dof() > derive::FEW_COORDINATES;
        let graph = if is_long { Graph::by_age() } else { Graph::new() };
        let programs = optimise::straight_line(&lagrangian, &derive::routes(&lagrangian, &graph, left_out));
        let nodes = lagrangian.graph.len() + graph.len();
        Analysis { sources, lagrangian, warnings, programs, nodes }
    }

    /// Energies, forces and constraints as they were declared.
    pub fn lagrangian(&self) -> &Lagrangian<'g> {
        &self.lagrangian
    }

    /// The generated functions, straight-line programs.
    pub fn programs(&self) -> &Derivation {
        &self.programs
    }

    /// The generated functions, by themselves.
    pub fn into_programs(self) -> Derivation {
        self.programs
    }

    /// How many nodes of expressions the passes have made up to the programs: what deriving costs, the same on every
    /// machine.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// What each function would cost by each route, those for comparison included; in the order of the programs.
    pub fn compared(&self) -> Vec<Vec<(Route, Operations)>> {
        let graph = Graph::new();
        optimise::compared(&derive::all_routes(&self.lagrangian, &graph))
    }

    /// Holds programs against the energies: those of this mechanism, or others that claim to be as good.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, optimise::Instruction, source::Sources};
    /// let text = "mechanism A { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
    /// assert!(analysis.prove(analysis.programs()).is_ok());
    ///
    /// let mut programs = analysis.programs().clone();
    /// let wrong = |instruction: &mut Instruction| match *instruction {
    ///     Instruction::Mul(a, b) => *instruction = Instruction::Add(a, b),
    ///     _ => {}
    /// };
    /// programs.altered().functions.iter_mut().flat_map(|function| &mut function.program.instructions).for_each(wrong);
    /// assert!(analysis.prove(&programs).is_err());
    /// ```
    ///
    /// # Errors
    /// [`Error::Proof`] where they disagree, or there are too few finite states.
    pub fn prove(&self, programs: &Derivation) -> Result<Proof, Error> {
        Ok(Proof::of(&self.lagrangian, programs)?)
    }

    /// What is to be said of the declaration, and of what the proof, where there is one, has not reached.
    pub fn warnings(&self, proof: Option<&Proof>) -> Diagnostics {
        let mut warnings = self.warnings.clone();
        if let Some(proof) = proof {
            proof.warn(&self.lagrangian, &mut warnings);
        }
        warnings
    }

    /// A module of Rust, proved, and read again.
    ///
    /// # Errors
    /// As [`prove`](Self::prove), and [`Error::Proof`] where the text is not what was proved;
    /// [`Error::UnknownFunction`] if the options ask for a function that there is not.
    pub fn rust(&self, options: &Options) -> Result<Generated, Error> {
        let (derivation, warnings) = (&self.programs, self.warnings(Some(&self.prove(&self.programs)?)));
        self.knows_all(options)?;
        let code = emit::rust(derivation, self.sources.portable_name(), options);
        derivation.proofread(Language::Rust, options, &code)?;
        Ok(Generated {
            module: emit::module_name(derivation),
            name: emit::type_name(derivation),
            dof: derivation.dof(),
            inputs: variable::count(&derivation.inputs),
            constraints: derivation.constraints.len(),
            implements_mechanism: emit::implements_mechanism(derivation, options),
            code,
            others: self.others(options)?,
            warnings: warnings.render_in(&self.sources),
        })
    }

    /// An error unless there are all functions that the options ask for.
    fn knows_all(&self, options: &Options) -> Result<(), Error> {
        match options.functions.iter().flatten().find(|name| self.programs.named(name).is_none()) {
            None => Ok(()),
            Some(name) => {
                // All of them, also those that were left out.
                let known = derived(&self.lagrangian).functions.iter().map(|f| f.name.clone()).collect();
                Err(Error::UnknownFunction { name: name.clone(), known })
            }
        }
    }

    /// The files of other languages than Rust, in the order of the list.
    fn others(&self, options: &Options) -> Result<Vec<(String, String)>, Error> {
        let derivation = &self.programs;
        let asked_for = |language: &Language| *language != Language::Rust && options.languages.contains(language);
        let file = |language: Language| {
            let code = language.write(derivation, self.sources.portable_name(), options);
            derivation.proofread(language, options, &code)?;
            Ok((language.file_name(derivation), code))
        };
        Language::ALL.into_iter().filter(asked_for).map(file).collect()
    }

    /// Symbols, outputs, energies, matrices and equations of motion, a document of LaTeX.
    pub fn latex(&self) -> String {
        let graph = Graph::new();
        latex::page(&self.lagrangian, &derive::routes(&self.lagrangian, &graph, LeftOut::default()))
    }

    /// Bodies, shapes, frames, places and lines as functions of the coordinates: what a picture is drawn from.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Ball { param m: kg = 1; coord r[3]: m; kinetic += particle(m, [r[0], r[1], r[2]]); }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("ball.mbs", text), &graph).unwrap();
    /// assert_eq!((analysis.scene().bodies.len(), analysis.scene().traced.len()), (1, 1));
    /// ```
    pub fn scene(&self) -> Scene {
        Scene::of(&self.lagrangian)
    }

    /// What [`latex`](Self::latex) writes, as HTML with MathML, which browsers set: headings `h3`, `h4`, paragraphs,
    /// and tables of the classes `symbols` and `align`; the latter have a row for each line of a formula.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Spring { param k: N/m = 4; coord x: m; potential += k*x^2/2; kinetic += 1 kg*dt(x)^2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
    /// assert!(analysis.mathml().starts_with("<h3>Spring</h3>"));
    /// assert!(analysis.mathml().contains("<mfrac>"));
    /// ```
    pub fn mathml(&self) -> String {
        latex::mathml::html(&self.latex())
    }
}

impl Mechanism {
    /// A module of Rust, proved.
    ///
    /// # Errors
    /// As [`generate`]; `error.render_in(&mechanism.sources())` is the report for people.
    pub fn generate(&self, options: &Options) -> Result<Generated, Error> {
        Analysis::asked_for(self.declaration()?, self.sources(), &Graph::verbatim(), options)?.rust(options)
    }
}

/// Of a chain of more coordinates than this, and of a mechanism whose M and A couple little, only the dynamics is
/// derived unless functions are asked for.
const MANY_COORDINATES: usize = 100;

/// What is not derived of a mechanism: where nothing is asked for, and there are many coordinates, all whose length
/// grows with their square.
fn of_many(lagrangian: &Lagrangian<'_>, left_out: LeftOut) -> LeftOut {
    match left_out == LeftOut::default() && lagrangian.dof() > MANY_COORDINATES {
        true => LeftOut {
            coriolis_matrix: true,
            inverse_dynamics_jacobian: true,
            linearization: true,
            mass_matrix: true,
            outputs: false,
        },
        false => left_out,
    }
}

/// What is not derived where these functions are asked for.
fn left_out(functions: Option<&[String]>) -> LeftOut {
    use FunctionKind::{CoriolisMatrix, Gravity, InverseDynamicsJacobian, Linearize, LinearizeParameters};
    let Some(names) = functions else { return LeftOut::default() };
    let none_of = |kinds: &[FunctionKind]| !names.iter().any(|name| kinds.iter().any(|kind| kind.name() == name));
    let is_dynamics = |name: &String| FunctionKind::OF_DYNAMICS.iter().any(|kind| kind.name() == name);
    let dynamics_alone = names.iter().all(is_dynamics);
    LeftOut {
        coriolis_matrix: none_of(&[CoriolisMatrix, Gravity]),
        inverse_dynamics_jacobian: none_of(&[InverseDynamicsJacobian]),
        linearization: none_of(&[Linearize, LinearizeParameters]),
        mass_matrix: dynamics_alone,
        outputs: dynamics_alone,
    }
}

/// The text of a mechanism that imports nothing → a module of Rust, proved.
///
/// `file_name` is what the module's first line and the reports call the source.
///
/// ```
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let module = mbs_derive::generate("spring.mbs", text, &Default::default()).unwrap();
/// assert_eq!((module.name.as_str(), module.dof, module.inputs), ("Spring", 1, 0));
/// assert!(module.code.contains("pub fn mass_matrix"));
/// ```
///
/// # Errors
/// [`Error::Declaration`] if the text is not a mechanism, [`Error::Proof`] if the derived code disagrees with the
/// energies, [`Error::UnknownFunction`] if the options ask for a function that there is not.
pub fn generate(file_name: &str, source: &str, options: &Options) -> Result<Generated, Error> {
    generated(&Sources::new(file_name, source), options)
}

pub(crate) fn generated(sources: &Sources, options: &Options) -> Result<Generated, Error> {
    Analysis::with_options(sources, &Graph::verbatim(), options)?.rust(options)
}

/// `parse` and `model`: the text of a mechanism that imports nothing → its Lagrangian, and warnings. The parameters
/// named in `freeze` become constants.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let (lagrangian, warnings) = mbs_derive::declared(text, &graph, &[]).unwrap();
/// assert_eq!((lagrangian.dof(), warnings.iter().count()), (1, 0));
/// ```
///
/// # Errors
/// All mistakes of the first pass that finds any.
pub fn declared<'g>(
    source: &str,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    declared_from(&Sources::new("", source), graph, freeze)
}

/// `parse` and `model`: the texts of a mechanism and of all that it imports → its Lagrangian, and warnings. The
/// parameters named in `freeze` become constants.
///
/// # Errors
/// All mistakes of the first pass that finds any.
fn declared_from<'g>(
    sources: &Sources,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    resolved(parse::declaration_of(sources)?, graph, freeze)
}

/// `model`, with the parameters named in `freeze` as constants.
fn resolved<'g>(
    mut declaration: Declaration,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    declaration.freeze(freeze)?;
    model::resolve(&declaration, graph)
}

/// `derive` and `optimise`: a Lagrangian → its Programs, not yet proved.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let (lagrangian, _) = mbs_derive::declared(text, &graph, &[]).unwrap();
/// let derivation = mbs_derive::derived(&lagrangian);
/// let torques = derivation.function(mbs_derive::optimise::FunctionKind::InverseDynamics).unwrap();
/// assert_eq!(torques.operations.flops(), 2); // q̈ + k x
/// ```
pub fn derived(lagrangian: &Lagrangian<'_>) -> Derivation {
    let (graph, left_out) = (Graph::new(), of_many(lagrangian, LeftOut::default()));
    optimise::straight_line(lagrangian, &derive::routes(lagrangian, &graph, left_out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpret::{Interpreter, State};

    /// What is not asked for is not derived, and nothing else is another program for that.
    /// Right angles as they are printed: their cosine is 6e-17, and no hundred bits tell their sine less 1 from 0.
    #[test]
    fn turns_of_nearly_a_right_angle_are_proved() {
        for [first, second] in [["y", "z"], ["z", "y"], ["x", "z"], ["z", "z"]] {
            let text = format!(
                "#![dimensionless] mechanism A {{
                    param m: 1 = 1; coord q[2]: 1; let a = rot_{first}(q[0]);
                    let b = a*translation([1, 0, 1/5])*rot_x(1.5707963267948966)*rot_{second}(q[1]);
                    let i = inertia(1, 2, 5/2, 1/10, 1/5, 3/10); kinetic += rigid_body(m, [1/10, 1/5, 3/10], i, a);
                    kinetic += rigid_body(m, [1/10, 1/5, 3/10], i, b);
                }}"
            );
            crate::generate("a.mbs", &text, &Default::default()).unwrap_or_else(|e| panic!("{}", e.render("a", &text)));
        }
    }

    #[test]
    fn functions_that_nobody_asks_for_are_not_derived() {
        let text = "#![dimensionless] mechanism Arm {
            coord q[3]: 1; input u: 1;
            let mut link = world;
            for i in 0..3 {
                link = link*rotation([0, 0, 1], q[i])*translation([1, 0, 0]);
                kinetic += particle(2, link.origin()); potential += 20*link.origin().y;
            }
            force q[0] += u;
        }";
        let sources = Sources::new("arm.mbs", text);
        let asked_for = |names: &[&str]| {
            let options = Options::default().functions(names.iter().copied());
            let graph = Graph::verbatim();
            let analysis = Analysis::with_options(&sources, &graph, &options).expect("it is right");
            analysis.prove(analysis.programs()).expect("it is right");
            analysis.into_programs()
        };
        let all = derived(&declared(text, &Graph::verbatim(), &[]).expect("it is right").0);
        for (asked, left_out) in [
            (vec!["forward_dynamics"], vec!["coriolis_matrix", "gravity", "linearize", "inverse_dynamics_jacobian"]),
            (vec!["gravity", "linearize"], vec!["inverse_dynamics_jacobian"]),
            (vec!["coriolis_matrix", "inverse_dynamics_jacobian"], vec!["linearize"]),
        ] {
            let some = asked_for(&asked);
            let names = |derivation: &Derivation| -> Vec<String> {
                derivation.functions.iter().map(|function| function.name.clone()).collect()
            };
            let expected: Vec<String> = names(&all).into_iter().filter(|n| !left_out.contains(&n.as_str())).collect();
            assert_eq!(names(&some), expected, "{asked:?}");
            for function in &some.functions {
                let same = all.named(&function.name).expect("among all");
                assert_eq!(function.program.instructions, same.program.instructions, "{}", function.name);
            }
        }
        let options = Options::default().functions(["forward_dynamics", "forward_dinamics"]);
        let Err(Error::UnknownFunction { name, known }) = generated(&sources, &options) else { panic!("a wrong name") };
        assert_eq!(name, "forward_dinamics");
        assert!(known.contains(&"linearize".to_string()), "{known:?}");
    }

    /// Where inputs may stand there is code in every language; what it does is the program's, as it is read again.
    #[test]
    fn inputs_are_known_wherever_they_may_stand() {
        let text = "mechanism Brake {
            param m: kg = 2; param b: N*s/m = 3;
            coord x: m; coord y: m;
            input c: N*s/m; input w: m/s; input f: N;
            let place = world.point([x, y, 0]);
            kinetic += particle(m, place);
            dissipation += 1/2*b*dt(x)^2 + 1/2*b*dt(y)^2;
            dissipation += 1/2*c*dt(place).norm_squared();
            dissipation += 1/2*b*(dt(y) - w)^2;
            force x += f; force at place += [0, 2*f, 0]; torque on world * rot_z(x/(1 m)) += [0, 0, f*(1 m)];
            output power = f*dt(x);
        }";
        let sources = Sources::new("brake.mbs", text);
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&sources, &graph).unwrap_or_else(|error| panic!("{}", error.render_in(&sources)));
        let emitted =
            analysis.rust(&Options::default().languages(Language::ALL)).unwrap_or_else(|error| panic!("{error:?}"));
        assert_eq!(emitted.others.len(), Language::ALL.len() - 1);
        let interpreter = Interpreter::new(analysis.programs());
        let (m, b, c, w, f, vx, vy) = (2.0, 3.0, 0.5, 4.0, 7.0, 1.5, -2.5);
        let state = State { q: vec![0.3, 0.4], qd: vec![vx, vy], u: vec![c, w, f], ..State::default() };
        let call = |kind| interpreter.call(kind, &state).expect("it is there");
        let expected = [(2.0 * f - b * vx - c * vx) / m, (2.0 * f - b * vy - c * vy - b * (vy - w)) / m];
        let found = call(FunctionKind::ForwardDynamics);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14 * b.abs()), "{found:?} {expected:?}");
        assert_eq!(call(FunctionKind::DissipationForce), [b * vx, b * vy], "without the terms that inputs enter");
        assert_eq!(call(FunctionKind::GeneralizedForce), [2.0 * f - c * vx, 2.0 * f - c * vy - b * (vy - w)]);
    }

    /// Matrices of a thousand coordinates are nothing that one derives in passing.
    #[test]
    fn of_many_links_the_dynamics_alone_is_derived() {
        let chain = |links: usize| {
            format!(
                "mechanism Chain {{ coord q[{links}]: rad; let mut link = world; for i in 0..{links} {{
                    link = link * rot_z(q[i]) * rot_x(1) * translation([1 m, 0 m, 0 m]);
                    kinetic += rigid_body(2 kg, [1 m, 2 m, 3 m], inertia(9, 8, 7, 1, 2, 3)*(1 kg*m^2), link);
                }} }}"
            )
        };
        let functions = |links: usize, asked: Option<&str>| {
            let options = Options { functions: asked.map(|name| vec![name.to_string()]), ..Options::default() };
            generate("chain.mbs", &chain(links), &options).unwrap_or_else(|e| panic!("{e:?}")).code
        };
        let has = |code: &str, name: &str| code.contains(&format!("pub fn {name}("));
        let dynamics = functions(MANY_COORDINATES + 1, None);
        let is_of_rows = |name: &str| name.starts_with("constraint") || name == "multipliers";
        for name in FunctionKind::OF_DYNAMICS.map(FunctionKind::name) {
            assert_eq!(has(&dynamics, name), !is_of_rows(name), "{name}");
        }
        assert!(!has(&dynamics, "mass_matrix") && !has(&dynamics, "linearize"));
        assert!(has(&functions(derive::FEW_COORDINATES + 1, Some("momentum")), "momentum"));
    }

    /// A mechanism passes on what is doubtful in the file that it imports, at the `import`.
    #[test]
    #[cfg(feature = "import")]
    fn imported_robots_are_doubted() {
        let robot = "<robot name='r'><link name='base'/><link name='b'><inertial><mass value='2'/>\
                     <inertia ixx='0.03' iyy='0.04' izz='0.05' ixy='0' ixz='0' iyz='0'/></inertial></link>\
                     <joint name='j' type='continuous'><origin rpy='90 0 0'/><parent link='base'/><child link='b'/></joint>\
                     </robot>";
        let column = 1 + robot.find("rpy").expect("an attitude");
        let sources = Sources::gather("a.mbs", "import \"r.urdf\"; mechanism A { }", |_| Ok(robot.into()));
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&sources, &graph).unwrap_or_else(|error| panic!("{}", error.render_in(&sources)));
        let of_joint = "the attitude of the joint `j` has an angle of 90 rad, more than a whole turn";
        for report in [analysis.warnings(None), sources.surveyed().0] {
            let report = report.render_in(&sources);
            let lines: Vec<&str> = report.lines().take(2).collect();
            let warning = format!("warning[MBS0310]: r.urdf:1:{column}: {of_joint}");
            assert_eq!(lines, [warning.as_str(), " --> a.mbs:1:1"], "{report}");
        }
    }
}
