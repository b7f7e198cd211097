//! modelDescription.xml of both versions, and buildDescription.xml.

use std::fmt::Write;

use super::Fmi;
use super::unit::Units;
use super::variable::{Role, Variable};
use super::xml::attribute;

/// What is said of an FMU.
pub(super) struct Description<'m> {
    pub(super) fmi: Fmi,
    /// As declared.
    pub(super) name: &'m str,
    pub(super) docs: String,
    /// What files and functions are called by.
    pub(super) identifier: &'m str,
    pub(super) variables: &'m [Variable],
    /// Whether everything that FMI may ask for can be differentiated.
    pub(super) is_differentiable: bool,
    /// Whether states have to be looked at after each step: they drift off constraints.
    pub(super) drifts: bool,
    pub(super) tolerance: f64,
}

impl Description<'_> {
    /// modelDescription.xml.
    pub(super) fn written(&self, token: &str) -> String {
        let mut units = Units::default();
        let variables: String =
            self.variables.iter().enumerate().map(|(i, v)| self.variable(i, v, &mut units)).collect();
        let head = match self.fmi {
            Fmi::Two => [attribute("fmiVersion", "2.0"), attribute("modelName", self.name), attribute("guid", token)],
            Fmi::Three => [
                attribute("fmiVersion", "3.0"),
                attribute("modelName", self.name),
                attribute("instantiationToken", token),
            ],
        };
        let mut text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription{}{}{}{}",
            head.concat(),
            attribute("description", &self.docs),
            attribute("generationTool", concat!("mbs ", env!("CARGO_PKG_VERSION"))),
            attribute("variableNamingConvention", "structured"),
        );
        if self.fmi == Fmi::Two {
            text += &attribute("numberOfEventIndicators", &self.of(Role::Switch).count().to_string());
        }
        text += ">\n";
        text += &self.interfaces();
        text += &units.definitions();
        text += "  <LogCategories>\n";
        for (name, what) in [
            ("Error", "Calls that are refused."),
            ("Discard", "What has no value at a state."),
            ("Warning", "Changes of the first state."),
        ] {
            let name = attribute("name", &format!("logStatus{name}"));
            let _ = writeln!(text, "    <Category{name}{}/>", attribute("description", what));
        }
        let time = self.variables[0].start.unwrap_or_default();
        let number = |name: &str, value: f64| attribute(name, &format!("{value:?}"));
        let _ = writeln!(
            text,
            "  </LogCategories>\n  <DefaultExperiment{}{}{}/>",
            number("startTime", time),
            number("stopTime", time + 10.0),
            number("tolerance", self.tolerance),
        );
        let _ = write!(text, "  <ModelVariables>\n{variables}  </ModelVariables>\n{}", self.structure());
        text + "</fmiModelDescription>\n"
    }

    fn of(&self, role: Role) -> impl Iterator<Item = usize> + '_ {
        (0..self.variables.len()).filter(move |&i| self.variables[i].role == role)
    }

    fn interfaces(&self) -> String {
        let truth = |name: &str| attribute(name, "true");
        let identifier = attribute("modelIdentifier", self.identifier);
        match self.fmi {
            Fmi::Two => {
                let mut common = identifier;
                for name in ["canNotUseMemoryManagementFunctions", "canGetAndSetFMUstate", "canSerializeFMUstate"] {
                    common += &truth(name);
                }
                if self.is_differentiable {
                    common += &truth("providesDirectionalDerivative");
                }
                let files = "<SourceFiles><File name=\"fmi2.c\"/></SourceFiles>";
                let co_simulation =
                    [truth("canHandleVariableCommunicationStepSize"), truth("canInterpolateInputs")].concat();
                format!(
                    "  <ModelExchange{common}>{files}</ModelExchange>\n  <CoSimulation{common}{co_simulation}>{files}</CoSimulation>\n"
                )
            }
            Fmi::Three => {
                let mut common = identifier;
                for name in ["canGetAndSetFMUState", "canSerializeFMUState"] {
                    common += &truth(name);
                }
                if self.is_differentiable {
                    common += &[truth("providesDirectionalDerivatives"), truth("providesAdjointDerivatives")].concat();
                }
                let co_simulation = truth("canHandleVariableCommunicationStepSize");
                let steps = if self.drifts { truth("needsCompletedIntegratorStep") } else { String::new() };
                format!("  <ModelExchange{common}{steps}/>\n  <CoSimulation{common}{co_simulation}/>\n")
            }
        }
    }

    fn variable(&self, number: usize, variable: &Variable, units: &mut Units) -> String {
        let (causality, variability, initial) = match variable.role {
            Role::Time => ("independent", "continuous", None),
            Role::State => ("output", "continuous", Some("exact")),
            Role::Output => ("output", "continuous", Some("calculated")),
            Role::Derivative | Role::Local | Role::Switch => ("local", "continuous", Some("calculated")),
            Role::Input => ("input", "continuous", None),
            Role::Parameter => ("parameter", "tunable", Some("exact")),
        };
        let mut common = [attribute("name", &variable.name), attribute("valueReference", &number.to_string())].concat();
        if !variable.description.is_empty() {
            common += &attribute("description", &variable.description);
        }
        common += &[attribute("causality", causality), attribute("variability", variability)].concat();
        common += &initial.map(|initial| attribute("initial", initial)).unwrap_or_default();
        let mut own = units.named(&variable.unit).map(|unit| attribute("unit", &unit)).unwrap_or_default();
        let start = variable.start.filter(|_| variable.role != Role::Time);
        own += &start.map(|value| attribute("start", &format!("{value:?}"))).unwrap_or_default();
        let of = variable.derivative_of.map(|of| self.index(of));
        own += &of.map(|of| attribute("derivative", &of.to_string())).unwrap_or_default();
        match self.fmi {
            Fmi::Two => format!("    <ScalarVariable{common}><Real{own}/></ScalarVariable>\n"),
            Fmi::Three => format!("    <Float64{common}{own}/>\n"),
        }
    }

    /// How variables are referred to by others.
    fn index(&self, number: usize) -> usize {
        match self.fmi {
            Fmi::Two => number + 1,
            Fmi::Three => number,
        }
    }

    fn structure(&self) -> String {
        let unknown = |number: usize, depends: bool| {
            let list: Vec<String> =
                self.variables[number].dependencies.iter().map(|&other| self.index(other).to_string()).collect();
            let dependencies = if depends { attribute("dependencies", &list.join(" ")) } else { String::new() };
            let reference = if self.fmi == Fmi::Two { "index" } else { "valueReference" };
            format!("{}{dependencies}", attribute(reference, &self.index(number).to_string()))
        };
        let outputs: Vec<usize> = (0..self.variables.len())
            .filter(|&i| matches!(self.variables[i].role, Role::State | Role::Output))
            .collect();
        let mut initial: Vec<usize> = self.of(Role::Derivative).chain(self.of(Role::Output)).collect();
        initial.sort_unstable();
        let list = |element: &str, numbers: &[usize], depends: bool| -> String {
            numbers.iter().map(|&number| format!("    <{element}{}/>\n", unknown(number, depends))).collect()
        };
        let (derivatives, switches): (Vec<usize>, Vec<usize>) =
            (self.of(Role::Derivative).collect(), self.of(Role::Switch).collect());
        match self.fmi {
            Fmi::Two => {
                let group = |name: &str, numbers: &[usize], depends: bool| match numbers {
                    [] => String::new(),
                    numbers => format!("    <{name}>\n{}    </{name}>\n", list("Unknown", numbers, depends)),
                };
                format!(
                    "  <ModelStructure>\n{}{}{}  </ModelStructure>\n",
                    group("Outputs", &outputs, true),
                    group("Derivatives", &derivatives, true),
                    group("InitialUnknowns", &initial, false),
                )
            }
            Fmi::Three => format!(
                "  <ModelStructure>\n{}{}{}{}  </ModelStructure>\n",
                list("Output", &outputs, true),
                list("ContinuousStateDerivative", &derivatives, true),
                list("InitialUnknown", &initial, false),
                list("EventIndicator", &switches, false),
            ),
        }
    }
}

/// buildDescription.xml, of FMI 3.
pub(super) fn build(identifier: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration{}>\n    \
         <SourceFileSet language=\"C99\">\n      <SourceFile name=\"fmi3.c\"/>\n    </SourceFileSet>\n  </BuildConfiguration>\n\
         </fmiBuildDescription>\n",
        attribute("modelIdentifier", identifier)
    )
}
