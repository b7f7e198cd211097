//! Whatever a text says, the generator answers: with code, or with a report that names the place.
//!
//! The texts are drawn from a fixed stream, so that every run sees the same ones. `MBS_CASES=100000 cargo
//! test --release -p mbs-tests --test robustness` draws more of them.

use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use mbs_derive::parse;
use mbs_derive::source::Sources;
use mbs_tests::random::Random;
use mbs_tests::robustness::examine::{Outcome, examine};
use mbs_tests::robustness::target::TARGETS;
use mbs_tests::robustness::{Models, model, mutation, seeded};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

/// A text is answered within this time, on a machine that does other things as well.
const PATIENCE: Duration = Duration::from_secs(60);

/// A small text is answered within this time.
const HASTE: Duration = Duration::from_secs(5);

/// This many cases are drawn, unless `MBS_CASES` says how many.
pub(crate) fn cases(usual: u32) -> u32 {
    std::env::var("MBS_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// The same cases in every run; `MBS_SEED` draws others.
fn runner(usual: u32) -> TestRunner {
    let seed = std::env::var("MBS_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(7_u8);
    let config = Config { cases: cases(usual), failure_persistence: None, max_shrink_iters: 300, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]))
}

/// Examines a file.
fn answered(models: &Arc<Models>, name: &str, bytes: Vec<u8>) -> Result<Outcome, String> {
    let text = match parse::text(name, bytes) {
        Ok(text) => text,
        Err(report) if report.contains(&format!("--> {name}:")) => return Ok(Outcome::Unread),
        Err(report) => return Err(format!("a report without a place: {report}")),
    };
    let (models, name, source) = (Arc::clone(models), name.to_string(), text.clone());
    let result = watched(PATIENCE, move || examine(&Sources::gather(&name, &source, |name| models.import(name))));
    result.map_err(|reason| format!("{reason}\n\n{text}"))
}

/// Does a work in a thread of the usual stack, and waits no longer than is reasonable.
fn watched<T: Send + 'static>(
    patience: Duration,
    work: impl FnOnce() -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let (send, receive) = mpsc::channel();
    let worker = thread::Builder::new().stack_size(2 << 20).spawn(move || {
        // Nobody listens where the time is over.
        send.send(work()).unwrap_or(());
    });
    let worker = worker.expect("a thread");
    match receive.recv_timeout(patience) {
        Ok(result) => result,
        Err(mpsc::RecvTimeoutError::Timeout) => Err(format!("no answer in {patience:?}")),
        Err(mpsc::RecvTimeoutError::Disconnected) => Err(format!("a panic: {}", panic_of(worker))),
    }
}

fn panic_of(worker: thread::JoinHandle<()>) -> String {
    match worker.join() {
        Ok(()) => "none".to_string(),
        Err(payload) => match (payload.downcast_ref::<String>(), payload.downcast_ref::<&str>()) {
            (Some(text), _) => text.clone(),
            (None, Some(text)) => (*text).to_string(),
            (None, None) => "of another kind".to_string(),
        },
    }
}

/// How many texts came how far.
#[derive(Debug, Default)]
struct Tally {
    unread: usize,
    refused: usize,
    unproved: usize,
    generated: usize,
}

impl Tally {
    fn count(&mut self, outcome: Outcome) {
        *match outcome {
            Outcome::Unread => &mut self.unread,
            Outcome::Refused => &mut self.refused,
            Outcome::Unproved => &mut self.unproved,
            Outcome::Generated => &mut self.generated,
        } += 1;
    }
}

/// Examines what a strategy draws.
fn drawn<S: Strategy>(usual: u32, strategy: &S, file: impl Fn(S::Value) -> (String, Vec<u8>)) -> Tally {
    let models = Arc::new(Models::read());
    let tally = std::cell::RefCell::new(Tally::default());
    let result = runner(usual).run(strategy, |value| {
        let (name, bytes) = file(value);
        let outcome = answered(&models, &name, bytes).map_err(TestCaseError::fail)?;
        tally.borrow_mut().count(outcome);
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
    let tally = tally.into_inner();
    println!("{tally:?}");
    tally
}

#[test]
fn damaged_models_are_answered() {
    let models = Models::read();
    let strategy = (0..models.mechanisms.len(), mutation::edits());
    let tally = drawn(300, &strategy, |(number, edits)| {
        let (name, text) = &models.mechanisms[number];
        (name.clone(), mutation::damaged(text, &edits))
    });
    let Tally { unread, refused, generated, .. } = tally;
    assert!(unread > 0 && refused > 0 && generated > 0, "some come to each end");
}

#[test]
fn models_from_the_grammar_are_answered() {
    let tally = drawn(60, &model::text(), |text| ("a.mbs".to_string(), text.into_bytes()));
    assert!(tally.refused > 0 && tally.generated > 0, "some come to each end");
}

/// The bodies of the fuzz targets, on bytes that are damaged from a seed; `MBS_CASES=100` draws hundred times as many.
#[test]
fn damaged_bytes_are_answered() {
    for (name, target) in TARGETS {
        let corpus = seeded::corpus(name);
        let count = match name {
            "pipeline" => 40,
            "import" => 150,
            "state" => 3000,
            _ => 400,
        };
        let mut random = Random::new(name.len() as u64);
        for number in 0..count * cases(1) {
            let bytes = seeded::damaged(&mut random, &corpus);
            let hasty = || {
                let bytes = bytes.clone();
                watched(HASTE, move || target(&bytes))
            };
            // Once more, because this machine may have done other things.
            let answer = hasty().or_else(|_| hasty());
            let shown = || String::from_utf8_lossy(&bytes).chars().take(20_000).collect::<String>();
            answer.unwrap_or_else(|fault| panic!("{name}, number {number}: {fault}\n\n{}", shown()));
        }
    }
}

/// What was found by drawing, and mended: a body at rest; a rate whose second derivative nobody gives; a
/// momentum that is conserved on one side of a branch; thousands of
/// parameters and inputs, whose proof was quadratic.
#[test]
fn what_was_found_stays_mended() {
    let models = Arc::new(Models::read());
    let mechanism = |body: &str| {
        let text = format!(
            "#![dimensionless]\nmechanism A {{\nparam a: 1 = 2;\ncoord x: 1;\ncoord y: 1;\nprescribed w: 1;\n\
             kinetic += a*(dt(x)^2 + dt(y)^2);\n{body}\n}}\n"
        );
        answered(&models, "a.mbs", text.into_bytes())
    };
    let check = |body: &str, expected: Outcome| assert_eq!(mechanism(body), Ok(expected), "{body}");
    check("kinetic += rigid_body(1, [0, a, 0], diag(1, 2, 2), world);", Outcome::Generated);
    check("kinetic += rigid_body(1, [0, a, 0], diag(1, 2, 2), rot_y(w));", Outcome::Generated);
    // Behind a branch the momentum of x is not conserved.
    check("kinetic += (dt(x) + dt(y))^2; potential += a*(if x*w > 2 { x*w } else { y });", Outcome::Generated);
    check("constraint c: x = dt(w);", Outcome::Refused);
    check("input u[3000]: 1; for i in 0..3000 { force x += u[i]; }", Outcome::Generated);
}
