//! Numbers are worked out by hand.

use super::{moves, near, refused, text, values};

/// Mass 2 kg.
const INERTIAL: &str = "<inertial><origin xyz='0.1 0.2 0.3'/><mass value='2'/>\
    <inertia ixx='0.03' iyy='0.04' izz='0.05' ixy='0' ixz='0' iyz='0'/></inertial>";

fn robot(joint: &str) -> String {
    format!(
        "<robot name='r'><link name='base'/><link name='b'>{INERTIAL}</link>\
         <joint name='j' {joint}<parent link='base'/><child link='b'/></joint></robot>"
    )
}

/// At the place 0 and the attitude (1, 0, 0, 0) the body is at the origin of its joint: `G = m g R₃` on the place, with
/// the last row `(−sin p, cos p sin r, cos p cos r)` of R.
#[test]
fn floating_joints_have_an_origin() {
    let text = text("r.urdf", &robot("type='floating'><origin xyz='1 2 3' rpy='0.3 0.2 0.1'/>"));
    assert!(
        text.contains("    let b = base * translation(j_at) * rpy(0.3, 0.2, 0.1) * translation(j_place)"),
        "{text}"
    );
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let [gravity, potential] = values(&text, &q, &[0.0; 7], ["gravity", "potential_energy"]);
    let (sine, cosine) = 0.2_f64.sin_cos();
    let row = [-sine, cosine * 0.3_f64.sin(), cosine * 0.3_f64.cos()];
    near("G", &gravity[..3], &row.map(|entry| 2.0 * 9.81 * entry));
    let height = 3.0 + 0.1 * row[0] + 0.2 * row[1] + 0.3 * row[2];
    near("V", &potential, &[2.0 * 9.81 * height]);
}

/// x, y, z of the link are y, z, x of the world; about −z of the link its mass centre is at the height
/// `y cos q − x sin q`, and `M = izz + m (x² + y²)`.
#[test]
fn origins_have_quaternions() {
    let joint = "type='revolute'><origin xyz='0 0 1' quat_xyzw='0.5 0.5 0.5 0.5'/><axis xyz='0 0 -2'/>";
    let torque = -2.0 * 9.81 * (0.2 * 0.3_f64.sin() + 0.1 * 0.3_f64.cos());
    moves("r.urdf", &robot(joint), &[0.05 + 2.0 * 0.05], &[torque]);
    let twice = joint.replace("quat_xyzw", "rpy='0 0 0' quat_xyzw");
    refused("r.urdf", &robot(&twice), "the attitude of the joint `j` is stated twice");
    let zero = joint.replace("0.5 0.5 0.5 0.5", "0 0 0 0");
    refused("r.urdf", &robot(&zero), "the attitude of the joint `j` has no direction");
}

/// An axis is divided by its length.
#[test]
fn axes_do_not_overflow() {
    let message = "numbers of the link `b` are so large that they overflow";
    for joint in ["type='prismatic'><axis xyz='1e200 1e200 0'/>", "type='revolute'><axis xyz='0 1e200 1'/>"] {
        refused("r.urdf", &robot(joint), message);
    }
    assert!(text("r.urdf", &robot("type='prismatic'><axis xyz='0 1e100 0'/>")).contains("translation([0, j, 0])"));
}

/// Units are no names: `0.1 m` would be a product.
#[test]
fn units_are_no_names() {
    let robot = robot("type='prismatic'><axis xyz='1 0 0'/>").replace("name='j'", "name='m'");
    let robot = robot.replace(
        "<inertial>",
        "<visual><origin xyz='0.1 0 0'/><geometry><sphere radius='0.2'/></geometry></visual><inertial>",
    );
    let text = text("r.urdf", &robot);
    assert!(text.contains("// the joint `m` is `m_joint`.\n") && text.contains("    coord m_joint: m;\n"), "{text}");
    let [m] = values(&text, &[0.3], &[0.7], ["mass_matrix"]);
    near("M", &m, &[2.0]);
}
