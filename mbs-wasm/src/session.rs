//! What the page calls: nine functions over two buffers, one of text and one of numbers.
//!
//! The page asks for room with `text(bytes)` or `numbers(count)`, writes there, and calls one of the others; what that
//! answers stands in the same buffers afterwards. Text is JSON in UTF-8, or what was printed. A call returns 0, or 1
//! where the text says what is wrong. Rust never reads through a pointer that the page has given: it hands out those of
//! its own buffers, and looks into them when the page is not there.
//!
//! A panic, which would be a mistake of ours, leaves its message in the text before it traps.

#![allow(unsafe_code, reason = "exports and imports have unmangled names, which the compiler cannot know to be unique")]

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Once;

use serde_json::{Value, json};

use crate::equations::Drive;
use crate::model::{Model, Request};
use crate::motion::{Motion, Settings};
use crate::report::Failure;

#[link(wasm_import_module = "mbs")]
unsafe extern "C" {
    /// This many inputs, and prescribed motions at `(t, q, q̇)`, written by the page; 0 where it could not.
    safe fn drive(t: f64, q: *const f64, qd: *const f64, u: *mut f64, inputs: usize, prescribed: *mut f64) -> i32;
}

thread_local! {
    static TEXT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static NUMBERS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
    static MODELS: RefCell<Vec<Option<Rc<Model>>>> = const { RefCell::new(Vec::new()) };
}

/// Room for this many bytes of text.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn text(bytes: usize) -> *mut u8 {
    prepare();
    TEXT.with_borrow_mut(|text| {
        text.resize(bytes, 0);
        text.as_mut_ptr()
    })
}

/// How many bytes of text there are.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn text_length() -> usize {
    TEXT.with_borrow(Vec::len)
}

/// Room for this many numbers.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn numbers(count: usize) -> *mut f64 {
    NUMBERS.with_borrow_mut(|numbers| {
        numbers.resize(count, 0.0);
        numbers.as_mut_ptr()
    })
}

/// How many numbers there are.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn numbers_length() -> usize {
    NUMBERS.with_borrow(Vec::len)
}

/// A [`Request`] → the number of the model, and its description.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn compile() -> i32 {
    answer(|| {
        let model = Model::compile(&read::<Request>()?)?;
        let description = model.description().clone();
        let number = MODELS.with_borrow_mut(|models| {
            let free = models.iter().position(Option::is_none).unwrap_or(models.len());
            models.resize(models.len().max(free + 1), None);
            models[free] = Some(Rc::new(model));
            free
        });
        Ok(json!({ "number": number, "description": description }).to_string())
    })
}

/// Forgets a model.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn release(model: usize) {
    MODELS.with_borrow_mut(|models| {
        if let Some(place) = models.get_mut(model) {
            *place = None;
        }
    });
}

/// The name of a language → the model in it.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn print(model: usize) -> i32 {
    answer(|| find(model)?.printed(&String::from_utf8_lossy(&TEXT.take())))
}

/// A state → the results of one of the model's functions.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn evaluate(model: usize, function: usize) -> i32 {
    answer(|| {
        let model = find(model)?;
        let results = model.evaluate(function, &model.point(&NUMBERS.take())?)?;
        NUMBERS.replace(results);
        Ok(String::new())
    })
}

/// [`Settings`] and a state → rows, and what happened. Where it `is_driven`, the page gives the inputs.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn simulate(model: usize, is_driven: bool) -> i32 {
    answer(|| {
        let (model, settings) = (find(model)?, read::<Settings>()?);
        let start = model.point(&NUMBERS.take())?;
        let by_page: &Drive<'_> = &|t, q, qd, u, prescribed| {
            let (inputs, prescribed) = (u.len(), prescribed.as_mut_ptr().cast());
            drive(t, q.as_ptr(), qd.as_ptr(), u.as_mut_ptr(), inputs, prescribed) != 0
        };
        let motion = Motion::integrate(&model, &start, &settings, is_driven.then_some(by_page))?;
        NUMBERS.replace(motion.rows);
        Ok(motion.summary.to_string())
    })
}

/// Leaves the text, or what is wrong as JSON.
fn answer(call: impl FnOnce() -> Result<String, Failure>) -> i32 {
    let (text, status) = match call() {
        Ok(text) => (text, 0),
        Err(Failure(error)) => (error.to_string(), 1),
    };
    TEXT.replace(text.into_bytes());
    status
}

fn read<T: serde::de::DeserializeOwned>() -> Result<T, Failure> {
    serde_json::from_slice(&TEXT.take()).map_err(|error| Failure::of_input(error.to_string()))
}

fn find(model: usize) -> Result<Rc<Model>, Failure> {
    let model = MODELS.with_borrow(|models| models.get(model).cloned().flatten());
    model.ok_or_else(|| Failure::of_input("this model has been released"))
}

/// The message of a panic stays behind as the text.
fn prepare() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            let message: Value = json!({ "kind": "internal", "message": panic.to_string() });
            TEXT.try_with(|text| text.try_borrow_mut().map(|mut text| *text = message.to_string().into_bytes()).ok())
                .ok();
        }));
    });
}
