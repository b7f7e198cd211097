//! Other languages than Rust: every function of every mechanism of the repository is compiled and run in each, at
//! random states, and compared with the proved program.
//!
//! `MBS_PRINTERS=all` asks for all of it: a hundred states in every language, the library's sines too, sanitizers and
//! OpenCL for every mechanism. Without it `mbs_printers::depth` says which part is run. What is not there is skipped,
//! which the output says.

mod c_header;
mod elementary;
mod scripts;
