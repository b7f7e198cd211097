//! Whether the arm's masses and inertias are those of bodies.

use mbs_models::irb7600_rail::Params;

/// A mass or an inertia that no body has, or a number of the arm's parameters that is infinite or NaN.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{parameter}{} is {value}: carriage and links have positive masses and inertias, the load none below zero", Index(*index))]
pub struct InvalidMass {
    /// Its name.
    pub parameter: &'static str,
    /// Which of several, counted from 0.
    pub index: Option<usize>,
    /// Its value.
    pub value: f64,
}

/// `[2]`, or nothing.
struct Index(Option<usize>);

impl core::fmt::Display for Index {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.0.map_or(Ok(()), |index| write!(f, "[{index}]"))
    }
}

/// Whether all masses are those of bodies: positive ones of carriage and links, so that the mass matrix has an inverse;
/// the load may be none. Mass centres and gravity are to be finite.
pub(super) fn check(params: &Params<f64>) -> Result<(), InvalidMass> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let load = |value: f64| value >= 0.0 && value.is_finite();
    all("carriage_mass", &[params.carriage_mass], positive)?;
    all("mass", &params.mass, positive)?;
    all("i_xx", &params.i_xx, positive)?;
    all("i_yy", &params.i_yy, positive)?;
    all("i_zz", &params.i_zz, positive)?;
    all("module_mass", &[params.module_mass], load)?;
    all("module_inertia", &params.module_inertia, load)?;
    all("com_x", &params.com_x, f64::is_finite)?;
    all("com_y", &params.com_y, f64::is_finite)?;
    all("com_z", &params.com_z, f64::is_finite)?;
    all("module_center", &[params.module_center], f64::is_finite)?;
    all("g", &[params.g], f64::is_finite)
}

fn all(parameter: &'static str, values: &[f64], sound: impl Fn(f64) -> bool) -> Result<(), InvalidMass> {
    match values.iter().position(|&value| !sound(value)) {
        Some(at) => {
            let index = (values.len() > 1).then_some(at);
            Err(InvalidMass { parameter, index, value: values[at] })
        }
        None => Ok(()),
    }
}
