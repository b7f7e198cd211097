//! How much a declaration has asked for: loops, functions and values could go on for ever.

/// What has been done so far, and how deep it is in.
#[derive(Debug, Default)]
pub(in crate::model) struct Effort {
    /// Expressions looked at.
    pub(in crate::model) steps: usize,
    /// Turns of loops.
    pub(in crate::model) turns: usize,
    /// Calls.
    pub(in crate::model) calls_so_far: usize,
    /// Expressions within expressions.
    pub(in crate::model) depth: usize,
    /// Blocks that are open: loops and choices.
    pub(in crate::model) depth_of_blocks: usize,
    /// Loops that are open.
    pub(in crate::model) loops: usize,
    /// The numbers of their turns, outermost first.
    pub(in crate::model) numbers: Vec<i64>,
    /// Whether a limit has been reported.
    pub(in crate::model) exhausted: bool,
}
