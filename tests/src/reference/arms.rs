//! Two serial arms, and the values that a third party computed for one of them.
//!
//! `tests/data/arm6.json` is the arm on which operation counts are quoted: general inertias, nothing vanishes.
//! `tests/data/serial.json` has pose, Jacobian and dynamics of the IRB 7600 at
//! the thesis' table 1, by a separate program.

use super::rigid_body::{Link, SerialArm};
use serde_json::Value;
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

/// The arm of `data/arm6.json`.
///
/// # Panics
///
/// If the file is not of the shape that it documents.
pub fn arm6() -> SerialArm<6> {
    let arm = json(include_str!("../../data/arm6.json"));
    let link = |i: usize| {
        let (dh, link) = (&arm["dh"][i], &arm["links"][i]);
        Link {
            d: number(&dh["d"]),
            a: number(&dh["a"]),
            alpha: number(&dh["alpha_deg"]).to_radians(),
            mass: number(&link["m"]),
            center_of_mass: numbers(&link["com"]),
            inertia: numbers(&link["I"]),
        }
    };
    SerialArm { links: from_fn(link), gravity: [0.0, 0.0, -number(&arm["g"])] }
}

/// ABB IRB 7600-500/2.55: geometry from the thesis' table 1, links assumed in `THESIS_SPEC.md`, section 6.
pub fn irb7600() -> SerialArm<6> {
    let twist = -FRAC_PI_2;
    let link = |[d, a, alpha]: [f64; 3], mass, center_of_mass, [xx, yy, zz]: [f64; 3]| {
        let inertia = [xx, 0.0, 0.0, yy, 0.0, zz];
        Link { d, a, alpha, mass, center_of_mass, inertia }
    };
    let links = [
        link([0.78, 0.41, twist], 650.0, [-0.20, 0.25, 0.0], [60.0, 55.0, 60.0]),
        link([0.0, 1.075, 0.0], 390.0, [-0.56, 0.0, 0.05], [12.0, 50.0, 48.0]),
        link([0.0, 0.165, twist], 480.0, [-0.10, 0.02, 0.15], [30.0, 28.0, 18.0]),
        link([1.056, 0.0, -twist], 150.0, [0.0, -0.35, 0.0], [8.0, 2.0, 8.0]),
        link([0.0, 0.0, twist], 90.0, [0.0, 0.0, 0.08], [1.2, 1.0, 0.9]),
        link([0.25, 0.0, 0.0], 40.0, [0.0, 0.0, -0.03], [0.35, 0.35, 0.6]),
    ];
    SerialArm { links, gravity: [0.0, 0.0, -9.80665] }
}

/// What `data/serial.json` says about the IRB 7600 in the configuration of the thesis' table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThesisValues {
    /// Joint angles, in rad.
    pub q: [f64; 6],
    /// Joint rates, in rad/s.
    pub qd: [f64; 6],
    /// Joint accelerations, in rad/s².
    pub qdd: [f64; 6],
    /// Position of the flange, in m.
    pub position: [f64; 3],
    /// Orientation of the flange, rows.
    pub rotation: [[f64; 3]; 3],
    /// Geometric Jacobian, rows `v` then `ω`.
    pub jacobian: [[f64; 6]; 6],
    /// `M`, in kg·m².
    pub mass_matrix: [[f64; 6]; 6],
    /// `C`, in kg·m²/s.
    pub coriolis_matrix: [[f64; 6]; 6],
    /// `C q̇`, in N·m.
    pub coriolis: [f64; 6],
    /// `G`, in N·m.
    pub gravity: [f64; 6],
    /// `M q̈ + C q̇ + G`, in N·m.
    pub torques: [f64; 6],
}

/// The values of `data/serial.json`.
///
/// # Panics
///
/// If the file is not of the shape above.
pub fn thesis_values() -> ThesisValues {
    let serial = json(include_str!("../../data/serial.json"));
    let [pose, jacobian, dynamics] = ["fk_table1", "jacobian_table1", "dynamics_table1"].map(|key| &serial[key]);
    ThesisValues {
        q: numbers(&dynamics["q_deg"]).map(f64::to_radians),
        qd: numbers(&dynamics["qd_rad_s"]),
        qdd: numbers(&dynamics["qdd_rad_s2"]),
        position: numbers(&pose["P_m"]),
        rotation: rows(&pose["R"]),
        jacobian: rows(&jacobian["J"]),
        mass_matrix: rows(&dynamics["M_kg_m2"]),
        coriolis_matrix: rows(&dynamics["C_christoffel"]),
        coriolis: numbers(&dynamics["coriolis_vector_N_m"]),
        gravity: numbers(&dynamics["gravity_vector_N_m"]),
        torques: numbers(&dynamics["tau_N_m"]),
    }
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("the data files are JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    entries(value).map(number)
}

fn rows<const N: usize, const K: usize>(value: &Value) -> [[f64; N]; K] {
    entries(value).map(numbers)
}

fn entries<const N: usize>(value: &Value) -> [&Value; N] {
    let entries = value.as_array().unwrap_or_else(|| panic!("{value} is not an array"));
    assert_eq!(entries.len(), N, "{value}");
    from_fn(|i| &entries[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::reference::EquationsOfMotion;

    /// The numbers that a reader would look up first.
    #[test]
    fn arm6_is_read_as_written() {
        let arm = arm6();
        assert_eq!(arm.gravity, [0.0, 0.0, -9.81]);
        assert_eq!(arm.links.map(|link| link.mass), [60.0, 45.0, 30.0, 12.0, 6.0, 2.5]);
        assert_eq!(arm.links.map(|link| link.d), [0.78, 0.0, 0.0, 1.056, 0.0, 0.25]);
        assert_eq!(arm.links.map(|link| link.a), [0.41, 1.075, 0.165, 0.0, 0.0, 0.0]);
        assert_eq!(arm.links.map(|link| link.alpha / FRAC_PI_2), [-1.0, 0.0, -1.0, 1.0, -1.0, 0.0]);
        assert_eq!(arm.links[3].center_of_mass, [0.01, -0.35, 0.02]);
        assert_eq!(arm.links[5].inertia, [0.002416, 0.000281, -0.000146, 0.003385, 0.00049, 0.003816]);
    }

    /// The same links were used for the values: typed above, listed in the file.
    #[test]
    fn irb7600_has_the_links_of_the_values() {
        let dynamics = &json(include_str!("../../data/serial.json"))["dynamics_table1"];
        let links = irb7600().links;
        assert_eq!(links.map(|link| link.mass), numbers(&dynamics["link_mass_kg"]));
        assert_eq!(links.map(|link| link.center_of_mass), rows(&dynamics["link_com_in_link_frame_m"]));
        assert_eq!(links.map(|link| link.inertia), rows(&dynamics["link_inertia_Ixx_Ixy_Ixz_Iyy_Iyz_Izz_kg_m2"]));
        assert_eq!(irb7600().gravity[2], -number(&dynamics["gravity_m_s2"]));
    }

    /// Both sides are rounded to doubles after some hundred operations; only the listed `C` is by finite differences.
    /// It is off by 3e-9 in entries of some 200, and by 2e-9 in forces of some 40.
    #[test]
    fn irb7600_has_the_values_of_the_thesis() {
        let (arm, want) = (irb7600(), thesis_values());
        let (q, qd, qdd) = (&want.q, &want.qd, &want.qdd);
        let flange = arm.flange(q);
        assert_close("P", flange.position.as_slice(), &want.position, 1e-13);
        assert_close("R", flange.rotation.transpose().as_slice(), &want.rotation.concat(), 1e-13);
        assert_close("J", &arm.jacobian(q).concat(), &want.jacobian.concat(), 1e-13);
        assert_close("M", &arm.mass_matrix(q).concat(), &want.mass_matrix.concat(), 1e-13);
        assert_close("G", &EquationsOfMotion::gravity(&arm, q), &want.gravity, 1e-13);
        assert_close("τ", &arm.newton_euler(q, qd, qdd), &want.torques, 1e-13);
        assert_close("C", &arm.coriolis_matrix(q, qd).concat(), &want.coriolis_matrix.concat(), 1e-10);
        let bias = arm.newton_euler(q, qd, &[0.0; 6]);
        let coriolis: [f64; 6] = from_fn(|i| bias[i] - want.gravity[i]);
        assert_close("C q̇", &coriolis, &want.coriolis, 1e-10);
    }
}
