//! The root of the crate of `fuzz/`: what its targets do with bytes is what tests do with damaged ones, and these
//! modules of mbs-tests are all that they need.

pub mod random;
pub mod robustness;

/// Ends the program where what must hold of a target's answer does not.
///
/// # Panics
/// With what is wrong.
pub fn hold(target: robustness::target::Target, bytes: &[u8]) {
    if let Err(fault) = target(bytes) {
        panic!("{fault}");
    }
}
