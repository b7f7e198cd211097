//! The arm's forces as a linear function of sixty numbers: mass, first moment and inertia of each link.
//!
//! [`model`] is the arm of the thesis with these numbers, products of inertia included, which [`irb7600`] leaves out:
//! it is [`arm6_params`](mbs_models::arm6_params), whose geometry is the same.
//! [`regressor`](mbs_runtime::control::regressor) makes Y of it.
//!
//! ```
//! use mbs_arm::inertial::{MASSES_ALONE, flat, links, model, parts};
//! use mbs_models::irb7600::Params;
//! use mbs_runtime::control::regressor;
//!
//! let (q, qd, qdd) = ([0.1, -1.5, 0.2, 0.3, 0.4, 0.5], [0.5; 6], [-0.2; 6]);
//! let torques = |numbers: &[f64; 60]| model(&parts(numbers), 9.81).inverse_dynamics(&q, &qd, &qdd);
//! let y = regressor(torques, &MASSES_ALONE);
//!
//! let arm = flat(&links(&Params::default()));
//! let found: f64 = (0..60).map(|k| y[1][k] * arm[k]).sum();
//! assert!((found - torques(&arm)[1]).abs() < 1e-12 * found.abs());
//! ```

use mbs_models::arm6_params::{Arm6Params, Params};
use mbs_models::irb7600;
use mbs_runtime::control::BodyParameters;

/// The links' parameters one after the other, ten of each as [`BodyParameters::to_array`] orders them \[kg, kg·m,
/// kg·m²\].
pub type InertialVector = [f64; 60];

/// Links of 1 kg that are points at the origins of their frames: where regressors are taken from.
pub const MASSES_ALONE: InertialVector = {
    let mut numbers = [0.0; 60];
    let mut link = 0;
    while link < 6 {
        numbers[10 * link] = 1.0;
        link += 1;
    }
    numbers
};

/// The links of the arm of the thesis, each in its own Denavit–Hartenberg frame.
#[must_use]
pub fn links(params: &irb7600::Params<f64>) -> [BodyParameters; 6] {
    core::array::from_fn(|i| {
        let center = [params.com_x[i], params.com_y[i], params.com_z[i]];
        let inertia = [params.i_xx[i], params.i_yy[i], params.i_zz[i], 0.0, 0.0, 0.0];
        BodyParameters::about_center(params.mass[i], center, inertia)
    })
}

/// All numbers of six links.
#[must_use]
pub fn flat(links: &[BodyParameters; 6]) -> InertialVector {
    core::array::from_fn(|k| links[k / 10].to_array()[k % 10])
}

/// Six links of all their numbers.
#[must_use]
pub fn parts(numbers: &InertialVector) -> [BodyParameters; 6] {
    core::array::from_fn(|link| BodyParameters::from_array(&core::array::from_fn(|k| numbers[10 * link + k])))
}

/// The arm with these links, under gravity g \[m/s²\].
///
/// All numbers of a link may be zero. Its moments without its mass have no mass centre: forces are infinite or NaN.
#[must_use]
pub fn model(links: &[BodyParameters; 6], g: f64) -> Arm6Params<f64> {
    let mut params = Params { g, ..Params::default() };
    for (i, link) in links.iter().enumerate() {
        let absent = *link == BodyParameters::default();
        let (center, inertia) =
            if absent { ([0.0; 3], [0.0; 6]) } else { (link.center(), link.inertia_about_center()) };
        params.mass[i] = link.mass;
        [params.com_x[i], params.com_y[i], params.com_z[i]] = center;
        [params.i_xx[i], params.i_yy[i], params.i_zz[i], params.i_xy[i], params.i_xz[i], params.i_yz[i]] = inertia;
    }
    Arm6Params::new(params)
}
