//! Mechanisms of every kind that the manual `docs/language.md` promises, written from it alone and generated at build
//! time from `tests/mechanisms/*.mbs`; `tests/motion/mechanisms.rs` compares each to its [`mod@crate::reference`].

include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));
