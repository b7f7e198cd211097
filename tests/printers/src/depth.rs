//! How much is run: a part with `cargo test`, all of it with `MBS_PRINTERS=all`.

/// States at which C, JavaScript and Python are compared.
pub const STATES: usize = 100;

/// Whether all of it was asked for.
#[must_use]
pub fn is_complete() -> bool {
    std::env::var("MBS_PRINTERS").is_ok_and(|asked_for| asked_for == "all")
}

/// States at which NumPy and JavaScript are compared.
#[must_use]
pub fn states_of_scripts() -> usize {
    if is_complete() { STATES } else { 10 }
}

/// States at which Octave is compared, which reads every line anew.
#[must_use]
pub fn states_of_octave() -> usize {
    if is_complete() { STATES } else { 1 }
}

/// Bytes of the longest header that is compiled with sanitizers.
#[must_use]
pub fn longest_with_sanitizers() -> usize {
    if is_complete() { usize::MAX } else { 200_000 }
}
