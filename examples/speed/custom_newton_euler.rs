//! The customised arm as it is usually compiled: doubles, sines and cosines one by one from the standard library.

#[path = "custom_arm6.rs"]
pub(crate) mod arm;

type Number = f64;

fn number(x: f64) -> Number {
    x
}

#[inline(always)]
fn sin_cos(angles: [Number; 5]) -> [(Number, Number); 5] {
    angles.map(f64::sin_cos)
}
