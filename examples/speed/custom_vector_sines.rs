//! The customised arm with all sines and cosines from one call, that of generated code.

#[allow(clippy::duplicate_mod)] // once more, with other sines
#[path = "custom_arm6.rs"]
pub(crate) mod arm;

type Number = f64;

fn number(x: f64) -> Number {
    x
}

#[inline(always)]
fn sin_cos(angles: [Number; 5]) -> [(Number, Number); 5] {
    let (sines, cosines) = mbs_runtime::Scalar::sin_cos_all(angles);
    std::array::from_fn(|i| (sines[i], cosines[i]))
}
