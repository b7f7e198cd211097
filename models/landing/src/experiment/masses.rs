//! Whether the arm's masses and inertias are those of bodies.

use mbs_models::check::{Invalid, finite, not_negative, positive};
use mbs_models::irb7600_rail::Params;

/// Whether all masses are those of bodies: positive ones of carriage and links, so that the mass matrix has an inverse;
/// the load may be none. Mass centres and gravity are to be finite.
pub(super) fn check(params: &Params<f64>) -> Result<(), Invalid> {
    positive("carriage_mass", params.carriage_mass)?;
    positive("mass", params.mass)?;
    positive("i_xx", params.i_xx)?;
    positive("i_yy", params.i_yy)?;
    positive("i_zz", params.i_zz)?;
    not_negative("module_mass", params.module_mass)?;
    not_negative("module_inertia", params.module_inertia)?;
    finite("com_x", params.com_x)?;
    finite("com_y", params.com_y)?;
    finite("com_z", params.com_z)?;
    finite("module_center", params.module_center)?;
    finite("g", params.g)
}
