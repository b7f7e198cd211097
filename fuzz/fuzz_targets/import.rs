//! A robot of another format, or a table.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mbs_fuzz::{hold, robustness::target};

fuzz_target!(|bytes: &[u8]| hold(target::import, bytes));
