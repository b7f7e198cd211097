//! What the generator derives, proves and prints: snapshots, identities, references, accuracy, determinism.

mod accuracy;
mod architecture;
mod book;
mod determinism;
mod downstream;
mod emitted;
mod generated;
mod identities;
mod mutants;
mod operations;
mod proof;
mod readable;
mod reference;
mod robustness;
mod rope;
mod sparse;
mod storage;
mod structured;
mod textbook;
mod ui;
mod work;
