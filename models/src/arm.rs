//! The arm of chapter 3 of the thesis, the ABB IRB 7600: what surrounds its generated dynamics.

pub mod trajectory;
