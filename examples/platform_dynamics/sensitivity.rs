//! What the forces of the legs depend on: derivatives by parameters, by the attitude and by the stiffness of the legs,
//! all of them by differentiation, at one state of motion. It has velocity, so that the terms of velocity are in the
//! derivatives.

use std::path::Path;

use mbs_examples::Failure;
use mbs_examples::output::{write_records, write_table};
use mbs_platform::dynamics::{Direction, STILL};
use mbs_platform::{LegVector, Motion, Platform};

use crate::MOMENT;

/// Of a leg along itself, assumed \[N/m\].
pub(crate) const LEG_STIFFNESS: f64 = 2e7;

/// By what the forces are differentiated, the unit of the derivatives, and they themselves.
pub(crate) type Row = (&'static str, &'static str, LegVector);

/// At the moment of the combined motion at which matrices are shown.
pub(crate) fn rows(platform: &Platform) -> Result<Vec<Row>, Failure> {
    let [q, qd, qdd] = Motion::COMBINED.at(MOMENT);
    let along = |direction: Direction, per: f64| -> Result<LegVector, Failure> {
        Ok(platform.leg_forces_along(&direction, &q, &qd, &qdd)?.map(|derivative| derivative * per))
    };
    let turned = |coordinate: usize| -> Result<LegVector, Failure> {
        let mut displacement = [0.0; 6];
        displacement[coordinate] = 1.0_f64.to_radians();
        Ok(platform.leg_forces_displaced(&displacement, &q, &qd, &qdd)?)
    };
    let (millimetre, degree) = (1e-3, 1.0_f64.to_radians());
    // 1 N/µm
    let stiffer = platform.leg_forces_by_stiffness(LEG_STIFFNESS, &q, &qd, &qdd)?.map(|derivative| derivative * 1e6);
    Ok(vec![
        ("payload", "N/kg", along(Direction { payload_mass: 1.0, ..STILL }, 1.0)?),
        ("radius of the base", "N/mm", along(Direction { base_radius: 1.0, ..STILL }, millimetre)?),
        ("radius of the platform", "N/mm", along(Direction { platform_radius: 1.0, ..STILL }, millimetre)?),
        ("half angle of the base", "N/°", along(Direction { base_half_angle: 1.0, ..STILL }, degree)?),
        ("half angle of the platform", "N/°", along(Direction { platform_half_angle: 1.0, ..STILL }, degree)?),
        ("φ", "N/°", turned(3)?),
        ("θ", "N/°", turned(4)?),
        ("ψ", "N/°", turned(5)?),
        ("stiffness of the legs", "N/(N/µm)", stiffer),
    ])
}

/// `Jᵀ K J` in the same pose: N/m, N and N·m.
pub(crate) fn stiffness(platform: &Platform) -> Result<[[f64; 6]; 6], Failure> {
    Ok(platform.stiffness(&Motion::COMBINED.at(MOMENT)[0], &[LEG_STIFFNESS; 6])?)
}

/// The table as `sensitivity.csv`, the stiffness as `stiffness.csv`.
pub(crate) fn write(folder: &Path, platform: &Platform) -> Result<(), Failure> {
    // Where the platform cannot be held no file is begun.
    let (rows, stiffness) = (rows(platform)?, stiffness(platform)?);
    let header = ["by", "unit", "leg 1", "leg 2", "leg 3", "leg 4", "leg 5", "leg 6"].map(String::from);
    let record = |(by, unit, derivatives): Row| {
        [&[by.to_string(), unit.to_string()][..], &derivatives.map(|number| number.to_string())].concat()
    };
    write_records(folder, "sensitivity", header, rows.into_iter().map(record))?;
    write_table(folder, "stiffness", "v_x v_y v_z w_x w_y w_z", stiffness.into_iter().map(Vec::from))
}
