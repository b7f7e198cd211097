//! Three equations of the thesis whose misprints dimensional analysis finds: as printed they are refused, with the
//! terms that do not fit and their dimensions; corrected they are accepted.
//!
//! The equations are (4.11), (5.8) and (7.13) of the thesis *Dynamics of multibody systems in a gravitational field*.

use mbs_derive::{emit, generate};

/// The report that the printed form earns, and its snapshot.
fn refused(name: &str, source: &str) -> String {
    let file = format!("misprints/{name}.mbs");
    let report = match generate(&file, source, &emit::Options::default()) {
        Ok(_) => panic!("{file} is accepted"),
        Err(error) => error.render(&file, source),
    };
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots/misprints");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, report));
    report
}

/// Generated, proved, and without a warning.
fn accepted(name: &str, source: &str) {
    let file = format!("misprints/{name}.mbs");
    let generated =
        generate(&file, source, &emit::Options::default()).unwrap_or_else(|e| panic!("{}", e.render(&file, source)));
    assert_eq!(generated.warnings, "");
}

/// The third row adds a cosine to accelerations.
#[test]
fn equation_4_11() {
    let report = refused("leg_printed", include_str!("../misprints/leg_printed.mbs"));
    assert!(report.contains("a sum needs equal dimensions, this term is a plain number, not m/s²"), "{report}");
    assert!(report.contains("a[2] + cos(beta)"), "{report}");
    accepted("leg", include_str!("../misprints/leg.mbs"));
}

/// The gyroscopic torque of the rotors has the angle in place of its rate; the torque of the thrusts has a moment of
/// inertia in place of the arm.
#[test]
fn equation_5_8() {
    let report = refused("quadrotor_printed", include_str!("../misprints/quadrotor_printed.mbs"));
    assert!(report.contains("a sum needs equal dimensions, this term is 1/s, not 1/s²"), "{report}");
    assert!(report.contains("a sum needs equal dimensions, this term is kg·m/s², not 1/s²"), "{report}");
    accepted("quadrotor", include_str!("../misprints/quadrotor.mbs"));
}

/// The factor of u'' lost its square.
#[test]
fn equation_7_13() {
    let report = refused("relative_orbit_printed", include_str!("../misprints/relative_orbit_printed.mbs"));
    assert!(report.contains("a sum needs equal dimensions, this term is 1/m, not m"), "{report}");
    assert!(report.contains("(C_r - r^2)/r^2*u_2"), "{report}");
    accepted("relative_orbit", include_str!("../misprints/relative_orbit.mbs"));
}
