//! The model language: every construct against the same thing said another way, and every mistake with its report.

mod branches;
mod diagnostics;
mod editors;
mod format;
mod import;
mod keywords;
mod loops;
mod manual;
mod misprints;
mod outputs;
mod parameters;
mod parts;
mod singular;
mod tables;
