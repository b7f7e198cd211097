//! What is derived and proved, kept for the next call that asks for the same.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use mbs_derive::builder::Mechanism;
use mbs_derive::expr::Graph;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::{Analysis, Error, emit};
use pyo3::prelude::*;

use crate::ModelError;
use crate::builder::Calls;

/// A mechanism's programs, and what was said of it when it was derived.
pub(crate) struct Derived {
    pub(crate) derivation: Derivation,
    /// Names of the functions, and what their documentation says.
    pub(crate) functions: Vec<(String, Vec<String>)>,
    pub(crate) warnings: String,
    pub(crate) latex: String,
    pub(crate) proved_at: usize,
}

/// What a mechanism is written as.
#[derive(Clone, PartialEq)]
pub(crate) enum Written {
    Text(Sources),
    Calls(Calls),
}

/// What was asked for: the mechanism, and the parameters that become constants.
#[derive(Clone, PartialEq)]
pub(crate) struct Request {
    pub(crate) written: Written,
    pub(crate) freeze: Vec<String>,
}

/// How many are kept: those that were asked for last.
const KEPT: usize = 16;

static LAST: Mutex<VecDeque<(Request, Arc<Derived>)>> = Mutex::new(VecDeque::new());

impl Derived {
    /// Derived and proved, unless it was lately.
    pub(crate) fn of(request: Request) -> PyResult<Arc<Self>> {
        if let Some(known) = known(&request) {
            return Ok(known);
        }
        let made = match &request.written {
            Written::Text(sources) => made(sources, None, &request.freeze),
            Written::Calls(calls) => {
                let mechanism = calls.mechanism()?;
                made(&mechanism.sources(), Some(&mechanism), &request.freeze)
            }
        };
        let made = Arc::new(made?);
        let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
        last.truncate(KEPT - 1);
        last.push_front((request, Arc::clone(&made)));
        Ok(made)
    }
}

/// What was made of this request lately, which is now the latest.
fn known(request: &Request) -> Option<Arc<Derived>> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let place = last.iter().position(|(known, _)| known == request)?;
    let found = last.remove(place)?;
    let derived = Arc::clone(&found.1);
    last.push_front(found);
    Some(derived)
}

fn made(sources: &Sources, calls: Option<&Mechanism>, freeze: &[String]) -> PyResult<Derived> {
    let graph = Graph::verbatim();
    let wrong = |error: Error| ModelError::new_err(error.render_in(sources));
    let analysis = match calls {
        None => Analysis::frozen(sources, &graph, freeze),
        Some(mechanism) => Analysis::written(mechanism, &graph, freeze),
    };
    let analysis = analysis.map_err(wrong)?;
    let proof = analysis.prove().map_err(wrong)?;
    let warnings = analysis.warnings(Some(&proof)).render_in(sources);
    let latex = analysis.latex();
    let derivation = analysis.into_programs();
    let functions = emit::Language::documented(&derivation);
    Ok(Derived { derivation, functions, warnings, latex, proved_at: proof.states })
}
