//! Pass 1: text → [`Declaration`](syntax::Declaration).

pub mod syntax;
