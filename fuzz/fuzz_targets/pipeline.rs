//! Derived, proved, emitted in every language.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mbs_fuzz::{hold, robustness::target};

fuzz_target!(|bytes: &[u8]| hold(target::pipeline, bytes));
