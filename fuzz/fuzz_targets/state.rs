//! A state file for `mbs eval --state`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mbs_fuzz::{hold, robustness::target};

fuzz_target!(|bytes: &[u8]| hold(target::state, bytes));
