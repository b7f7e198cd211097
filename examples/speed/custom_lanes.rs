//! The customised arm in four lanes, with the sines and cosines of generated code.

#[allow(clippy::duplicate_mod)] // once more, for other numbers
#[path = "custom_arm6.rs"]
pub(crate) mod arm;

type Number = mbs_runtime::wide::f64x4;

fn number(x: f64) -> Number {
    Number::splat(x)
}

#[inline(always)]
fn sin_cos(angles: [Number; 5]) -> [(Number, Number); 5] {
    angles.map(mbs_runtime::Scalar::sin_cos)
}
