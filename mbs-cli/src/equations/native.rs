//! The functions that a motion asks for, compiled.

use mbs_derive::interpret::State;
use mbs_derive::optimise::{Argument, Derivation, Function, FunctionKind};
use mbs_native::{Compilers, Instance, Kind, Library, MOST, Misfit, NotCompiled};

use crate::cache::Cache;
use crate::simulate::drive::FORMULA;

/// A mechanism's compiled functions, and how each is called.
pub(crate) struct Native {
    library: Library,
    calls: Vec<Call>,
    multipliers: Option<usize>,
}

/// What a function takes, in its order, and how many numbers each part of its result has.
struct Call {
    arguments: Vec<Kind>,
    parts: Vec<usize>,
}

impl Call {
    fn takes_multipliers(&self) -> bool {
        self.arguments.contains(&Kind::Of(Argument::Multipliers))
    }
}

impl Native {
    /// Compiles what motions ask for, unless an earlier call has.
    pub(crate) fn compiled(
        derivation: &Derivation,
        compilers: &Compilers,
        cache: &Cache,
    ) -> Result<Native, NotCompiled> {
        let library = match cache.folder() {
            Some(folder) => Library::compiled(derivation, compilers, &folder.join("native"), is_of_motion)?,
            None => {
                let failed = |error| NotCompiled::Folder { folder: std::env::temp_dir(), error };
                // What is loaded needs its file no more.
                let folder = tempfile::tempdir().map_err(failed)?;
                Library::compiled(derivation, compilers, folder.path(), is_of_motion)?
            }
        };
        let call = |number: usize| Call {
            arguments: mbs_native::arguments(derivation, number).iter().map(|argument| argument.kind).collect(),
            parts: derivation.functions[number].results.iter().map(|part| part.shape.entries()).collect(),
        };
        let multipliers = derivation.functions.iter().position(|f| f.kind == FunctionKind::Multipliers);
        Ok(Native { library, calls: (0..derivation.functions.len()).map(call).collect(), multipliers })
    }

    /// With these parameters, as many as the mechanism has.
    pub(crate) fn with_parameters(&self, parameters: &[f64]) -> Result<Compiled<'_>, Misfit> {
        Ok(Compiled { native: self, instance: self.library.instance(parameters)? })
    }
}

/// Whether motions ask for a function again and again.
fn is_of_motion(function: &Function) -> bool {
    use FunctionKind::{
        Bias, Constraint, ConstraintBias, ConstraintJacobian, ConstraintRate, DissipationForce, ForwardDynamics,
        GeneralizedForce, KineticEnergy, MassMatrix, Multipliers, Output, PotentialEnergy,
    };
    match function.kind {
        Output(_) => function.name.starts_with(FORMULA),
        kind => [
            Bias,
            Constraint,
            ConstraintBias,
            ConstraintJacobian,
            ConstraintRate,
            DissipationForce,
            ForwardDynamics,
            GeneralizedForce,
            KineticEnergy,
            MassMatrix,
            Multipliers,
            PotentialEnergy,
        ]
        .contains(&kind),
    }
}

/// A mechanism's compiled functions with values of its parameters.
pub(crate) struct Compiled<'n> {
    native: &'n Native,
    instance: Instance,
}

impl Compiled<'_> {
    /// The results of the function with this number, part by part, as the interpreter has them; multipliers are those
    /// of the motion where none are given. `None` where it is not compiled.
    pub(crate) fn evaluate(&self, number: usize, state: &State, multipliers: Option<&[f64]>) -> Option<Vec<f64>> {
        let call = self.native.calls.get(number)?;
        let mut values = vec![0.0; call.parts.iter().sum()];
        self.put(number, state, multipliers, &mut values).then_some(values)
    }

    /// Puts the results of a function where there is place for as many; `false` where it is not compiled.
    pub(crate) fn put(&self, number: usize, state: &State, multipliers: Option<&[f64]>, values: &mut [f64]) -> bool {
        let Some(call) = self.native.calls.get(number).filter(|_| self.instance.has(number)) else { return false };
        let mut of_motion = Vec::new();
        if multipliers.is_none() && call.takes_multipliers() {
            let found = self.native.multipliers.and_then(|number| self.evaluate(number, state, None));
            let Some(found) = found else { return false };
            of_motion = found;
        }
        let t = [state.t];
        let mut arguments: [(&[f64], usize); MOST] = [(&[], 0); MOST];
        for (argument, kind) in arguments.iter_mut().zip(&call.arguments) {
            argument.0 = match kind {
                Kind::Time => &t,
                Kind::Prescribed => state.prescribed.as_flattened(),
                Kind::Of(Argument::Q) => &state.q,
                Kind::Of(Argument::Qd) => &state.qd,
                Kind::Of(Argument::Qdd) => &state.qdd,
                Kind::Of(Argument::U) => &state.u,
                Kind::Of(Argument::Multipliers) => multipliers.unwrap_or(&of_motion),
            };
        }
        let mut parts: [&mut [f64]; MOST] = Default::default();
        let mut rest = values;
        for (part, size) in parts.iter_mut().zip(&call.parts) {
            let Some((values, behind)) = rest.split_at_mut_checked(*size) else { return false };
            (*part, rest) = (values, behind);
        }
        let (arguments, parts) = (&arguments[..call.arguments.len()], &mut parts[..call.parts.len()]);
        self.instance.call(number, arguments, 1, parts).is_ok()
    }

    /// The first result of a function; `None` where it is not compiled.
    pub(crate) fn first(&self, number: usize, state: &State) -> Option<f64> {
        let mut value = [f64::NAN];
        match self.native.calls.get(number)?.parts.as_slice() {
            [1] => self.put(number, state, None, &mut value).then_some(value[0]),
            _ => self.evaluate(number, state, None)?.first().copied(),
        }
    }
}
