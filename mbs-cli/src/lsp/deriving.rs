//! What takes longer than a key press: a mechanism derived and proved beside the conversation, one at a time.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use mbs_derive::Analysis;
use mbs_derive::diagnostic::Diagnostic;
use mbs_derive::expr::Graph;
use mbs_derive::source::Sources;

use super::Event;

/// A mechanism to be derived.
#[derive(Debug)]
pub(super) struct Job {
    /// The file's name, and the texts that it is about.
    pub(super) name: String,
    pub(super) sources: Sources,
}

/// What came of it.
#[derive(Debug)]
pub(super) struct Derived {
    pub(super) job: Job,
    /// What the proof has found, beside what was known before.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Additions and multiplications of each function.
    pub(super) costs: Vec<(String, usize)>,
}

/// Jobs in, the last one first; of several about one file the last one counts.
pub(super) fn worker(events: Sender<Event>) -> Sender<Job> {
    let (jobs, waiting): (Sender<Job>, Receiver<Job>) = channel();
    // Deep expressions are gone through by recursion.
    let builder = thread::Builder::new().stack_size(16 << 20);
    let spawned = builder.spawn(move || {
        let mut pending: Vec<Job> = Vec::new();
        loop {
            let awaited = if pending.is_empty() { waiting.recv().ok() } else { None };
            for later in awaited.into_iter().chain(waiting.try_iter()) {
                pending.retain(|job| job.name != later.name);
                pending.push(later);
            }
            let Some(job) = pending.pop() else { return };
            // A bug of the generator is no reason to leave the editor alone.
            let derived = catch_unwind(AssertUnwindSafe(|| derived(&job)));
            let (diagnostics, costs) = derived.unwrap_or_default();
            if events.send(Event::Derived(Derived { job, diagnostics, costs })).is_err() {
                return;
            }
        }
    });
    // Without it, nothing is derived and the rest is as it is.
    drop(spawned);
    jobs
}

fn derived(job: &Job) -> (Vec<Diagnostic>, Vec<(String, usize)>) {
    let graph = Graph::verbatim();
    let Ok(analysis) = Analysis::of(&job.sources, &graph) else { return Default::default() };
    let functions = analysis.programs().functions.iter();
    let costs = functions.map(|function| (function.name.clone(), function.operations.flops())).collect();
    let found = match analysis.prove(analysis.programs()) {
        Ok(proof) => analysis.warnings(Some(&proof)),
        Err(error) => {
            // About the mechanism as a whole.
            let name = mbs_derive::parse::declaration_of(&job.sources).map_or(0..0, |read| read.name.span.clone());
            error.at(name)
        }
    };
    (found.iter().cloned().collect(), costs)
}
