//! Numbers are those of MuJoCo 4.0, `mj_fullM` and `qfrc_bias − qfrc_spring`.

use super::{Sources, driven, floating, moves, near, refused, text, values};

const INERTIAL: &str = "<inertial pos='0.1 0.2 0.3' mass='1.3' diaginertia='0.02 0.03 0.04'/>";

/// A model of these bodies, with what stands before and behind them.
fn model(head: &str, bodies: &str, tail: &str) -> String {
    let bodies = bodies.replace("INERTIAL", INERTIAL);
    format!("<mujoco><compiler angle='radian'/>{head}<worldbody>{bodies}</worldbody>{tail}</mujoco>")
}

/// A hinge that carries the usual inertia, with these attributes.
fn hinge(attributes: &str) -> String {
    model("", &format!("<body name='b'><joint name='a' axis='1 0.3 0' {attributes}/>INERTIAL</body>"), "")
}

#[test]
fn joints_keep_their_order_across_frames() {
    let bodies = "<body name='b'><frame euler='0.3 0 0'><joint name='a' type='slide' axis='0 1 0'/>\
                  <frame pos='0 0 0.2'><joint name='e' axis='1 0 0'/></frame></frame>\
                  <joint name='c' axis='0 1 0' pos='0.1 0 0'/>INERTIAL</body>";
    moves(
        "m.xml",
        &model("", bodies, ""),
        &[
            1.2999999999999998,
            0.14519971232055637,
            -0.12045322055609076,
            0.14519971232055637,
            0.11865044692668833,
            -0.048446226882396796,
            -0.12045322055609076,
            -0.048446226882396796,
            0.14699999999999996,
        ],
        &[3.52596731067288, 3.332112041663923, -1.6892380920937606],
    );
}

#[test]
fn bodies_keep_their_order_across_frames() {
    let body = |name: &str| format!("<body name='{name}'><joint name='of_{name}'/>INERTIAL</body>");
    let [a, b, c, d] = ["a", "b", "c", "d"].map(body);
    let text = text("m.xml", &model("", &format!("{a}<frame>{b}<frame>{c}</frame></frame>{d}"), ""));
    let coordinates: Vec<&str> = text.lines().filter(|line| line.starts_with("    coord")).collect();
    let expected = ["a", "b", "c", "d"].map(|name| format!("    coord of_{name}: rad;"));
    assert_eq!(coordinates, expected);
}

/// The torque of a ball joint acts between two bodies: its work is `τ·ω` with ω of the one against the other, in the
/// axes of the one that hangs, so that none is done where both turn together.
#[test]
fn balls_are_driven_from_what_they_hang_on() {
    let bodies = "<body name='b'><freejoint name='f'/>INERTIAL\
                  <body name='d' pos='0 0 1'><joint name='c' type='ball'/>INERTIAL</body></body>";
    let text = text("m.xml", &model("", bodies, ""));
    let [w, x, y, z] = [0.5, -0.7, 0.1, 0.5];
    let q = [0.1, 0.2, 0.3, 0.1, 0.7, -0.1, 0.7, w, x, y, z];
    let torque = [0.3, -0.4, 0.9];
    let [force] = driven(&text, &q, &[0.0; 11], &torque, ["generalized_force"]);
    // ω = 2 (w v̇ − ẇ v − v × v̇) of the quaternion (w, v).
    let rows = [[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]];
    let own: [f64; 4] = std::array::from_fn(|k| (0..3).map(|i| 2.0 * rows[i][k] * torque[i]).sum());
    near(&format!("Q\n{text}"), &force, &[&[0.0; 7][..], &own[..]].concat());
}

/// The last of several counts.
#[test]
fn inertials_stand_in_frames() {
    let bodies = "<body name='b'><inertial pos='1 2 5' mass='2' diaginertia='1 1 1'/>\
                  <frame quat='1 0 0 1' pos='1 0 0'><geom type='box' size='0.1 0.2 0.3'/>INERTIAL</frame>\
                  <joint name='a' axis='1 0.3 0'/><joint name='c' axis='0 0.3 1'/></body>";
    let mass_matrix = [0.43535670297768236, -0.18881569818870536, -0.18881569818870536, 0.8704678899082565];
    moves("m.xml", &model("", bodies, ""), &mass_matrix, &[-6.277120541743256, -0.15692298759645915]);
}

/// Of its own, then of the innermost default, whichever way they are stated.
#[test]
fn attitudes_take_the_place_of_those_of_defaults() {
    let head = "<default><geom type='box' size='0.1 0.2 0.3'/><default class='k'>\
                <geom pos='0 1 0' quat='1 0.3 0 0'/><default class='z'><geom mass='2' euler='0 0.5 0'/></default>\
                </default></default>";
    let bodies = "<body name='b' childclass='k'><joint name='a' axis='1 0.3 0'/><joint name='c' axis='0 0.3 1'/>\
                  <geom/><geom class='z' pos='1 0 0'/>\
                  <geom class='z' pos='0 0 1' axisangle='1 0.5 0.2 0.7'/></body>";
    let mass_matrix = [33.99808294800681, -3.768834317577938, -3.768834317577938, 47.57598554528823];
    moves("m.xml", &model(head, bodies, ""), &mass_matrix, &[325.64954451008464, 22.87814260808617]);
    let twice = bodies.replace("<geom/>", "<geom quat='1 0 0 0' zaxis='0 0 1'/>");
    refused("m.xml", &model(head, &twice, ""), "the attitude of this geom is stated twice");
}

/// Sizes that a geom does not state are those of its defaults, number by number.
#[test]
fn sizes_are_filled_from_defaults() {
    let head =
        "<default><geom type='box' size='0.1 0.2 0.3'/><default class='k'><geom size='0.05 0.4'/></default></default>";
    let of = |geom: &str| {
        let body = format!("<body name='b'><joint name='a' axis='1 0.3 0'/>{geom}</body>");
        text("m.xml", &model(head, &body, ""))
    };
    assert_eq!(of("<geom class='k' size='0.03'/>"), of("<geom size='0.03 0.4 0.3'/>"));
}

/// Of two statements of one class the later one counts.
#[test]
fn defaults_are_read_in_their_order() {
    let head = "<default><joint damping='1' armature='0.3'/></default><default><joint damping='2'/></default>";
    let sections = |attributes: &str, head: &str| {
        text("m.xml", &hinge(attributes).replace("<worldbody>", &format!("{head}<worldbody>")))
    };
    let [m, loss] = values(&sections("", head), &[0.3], &[0.7], ["mass_matrix", "dissipation_force"]);
    near("M", &m, &[0.4722935779816513]);
    near("∂D/∂q̇", &loss, &[1.4]);
    let later =
        head.replace("<default><joint damping='2'/>", "<default><default class='k'><joint stiffness='2'/></default>");
    let [loss] = values(&sections("class='k'", &later), &[0.3], &[0.7], ["dissipation_force"]);
    near("∂D/∂q̇ of a class in a later section", &loss, &[0.7]);
}

/// `springlength` is where the springs of the joints are relaxed, not where the bodies are at their poses.
#[test]
fn springs_of_tendons_are_relaxed_where_those_of_joints_are() {
    let bodies = "<body name='b'><joint name='a' axis='1 0.3 0' ref='0.2' springref='0.5'/>INERTIAL\
                  <body name='d' pos='0 0 1'><joint name='c' axis='0 1 0' springref='-0.3'/>INERTIAL</body></body>";
    let tendon = "<tendon><fixed name='t' stiffness='3' damping='0.2'>\
                  <joint joint='a' coef='2'/><joint joint='c' coef='-1'/></fixed></tendon>";
    moves(
        "m.xml",
        &model("", bodies, tendon),
        &[2.496093588589712, 0.1698977863848982, 0.1698977863848982, 0.16000000000000003],
        &[0.7244407626083187, 1.092314126252744],
    );
    // -1 stands for that, other negative lengths for themselves.
    let rest = |length: &str| {
        let stated = tendon.replace("name='t'", &format!("name='t' springlength='{length}'"));
        let text = text("m.xml", &model("", bodies, &stated));
        text.lines().find(|line| line.contains("_rest: rad")).map(str::to_string)
    };
    assert_eq!(rest("-1"), rest("-1 -1"));
    assert_eq!(rest("-1").as_deref(), Some("    const t_spring_rest: rad = 1.3;"));
    assert_eq!(rest("-0.3").as_deref(), Some("    const t_spring_rest: rad = -0.3;"));
    assert_eq!(rest("-2 -2").as_deref(), Some("    const t_spring_rest: rad = -2;"));
    let zone = tendon.replace("name='t'", "name='t' springlength='-1 0.2'");
    refused("m.xml", &model("", bodies, &zone), "the spring of the tendon `t` has a dead zone, which is not imported");
}

#[test]
fn principal_moments_and_masses_are_bounded() {
    let bounds = |attributes: &str, xml: String| xml.replace("'radian'", &format!("'radian' {attributes}"));
    let turned = "<body name='b'><joint name='a' axis='1 0.3 0'/><joint name='c' axis='0 1 0'/>\
                  <inertial pos='0.1 0 0' quat='1 0.3 0.2 0.1' mass='1' diaginertia='0.001 0.1 0.1'/></body>";
    moves(
        "m.xml",
        &bounds("boundinertia='0.05'", model("", turned, "")),
        &[0.05254318382466605, 0.01761904299648277, 0.01761904299648277, 0.10606032625423205],
        &[-0.358979722635876, -0.8921479916828923],
    );
    let empty = "<body name='b'><joint name='a' axis='1 0.3 0'/>\
                 <body name='d' pos='0 0 1'><joint name='c' axis='0 1 0'/>INERTIAL</body></body>";
    moves(
        "m.xml",
        &bounds("boundmass='0.5' boundinertia='0.05'", model("", empty, "")),
        &[2.4001918152809703, 0.175644744096225, 0.175644744096225, 0.17999999999999997],
        &[-2.544509564569316, -0.04948994489696501],
    );
    // A bound does not hide a mistake.
    let negative = hinge("").replace("diaginertia='0.02", "diaginertia='-0.02");
    refused(
        "m.xml",
        &bounds("boundinertia='0.05'", negative),
        "the inertia of the link `b` has a negative principal moment",
    );
}

/// MuJoCo puts it at the `pos` of the body's element, read in the body's frame, whatever frames are around.
#[test]
fn masses_of_bounds_stand_where_the_body_does() {
    let bodies = |body: &str| model("", body, "").replace("'radian'", "'radian' boundmass='0.5' boundinertia='0.01'");
    let joint = "<joint name='a' axis='0 1 0'/>";
    let turned = bodies(&format!("<body name='b' pos='1 0.2 0.3' euler='0.3 0 0'>{joint}</body>"));
    moves("m.xml", &turned, &[0.555], &[-4.8920712953663825]);
    let geom = format!("<body name='b' pos='1 0.2 0.3'>{joint}<geom size='0.1' mass='0'/></body>");
    let framed = bodies(&format!("<frame pos='0 2 0' euler='0 0 0.5'>{geom}</frame>"));
    moves("m.xml", &framed, &[0.555], &[-5.120783463263257]);
    let note = "    // Its mass is that of `boundmass`, placed as by MuJoCo: ";
    assert!(text("m.xml", &framed).contains(note));
    assert!(!text("m.xml", &framed.replace("pos='1 0.2 0.3'", "")).contains(note));
}

/// Geoms without mass leave what is stated, even where `inertiafromgeom` has them decide.
#[test]
fn massless_geoms_decide_nothing() {
    let xml = hinge("").replace("</body>", "<geom size='0.1' mass='0'/></body>");
    let xml = xml.replace("'radian'", "'radian' inertiafromgeom='true'");
    moves("m.xml", &xml, &[0.1722935779816513], &[0.8531989881157648]);
}

/// In the axes of what is around it: a frame turns it, an attitude of its own is refused as by MuJoCo.
#[test]
fn full_inertias_have_no_attitude() {
    let full = |attributes: &str| {
        format!("<inertial pos='0.1 0.2 0.3' mass='1.3' {attributes} fullinertia='0.03 0.04 0.05 0.001 0.002 0.003'/>")
    };
    let body = |inertial: &str| hinge("").replace(INERTIAL, inertial);
    let framed = format!("<frame euler='0 0 0.7'>{}</frame>", full(""));
    moves("m.xml", &body(&framed), &[0.21265192964697466], &[1.5895265935637108]);
    for way in ["quat='1 0.2 0 0'", "euler='0.1 0 0'", "diaginertia='1 1 1'"] {
        let name = way.split('=').next().unwrap();
        let message =
            format!("the inertial of the body `b` has `{name}` beside `fullinertia`, which MuJoCo does not take");
        refused("m.xml", &body(&full(way)), &message);
    }
}

#[test]
fn negative_masses_and_sizes_are_refused() {
    let negative = hinge("").replace("mass='1.3'", "mass='-1'");
    refused("m.xml", &negative, "the mass of the link `b` is negative: -1 kg");
    let geom = |geom: &str, message: &str| refused("m.xml", &hinge("").replace(INERTIAL, geom), message);
    let good = "<geom type='box' size='0.1 0.2 0.3' mass='5'/>";
    geom(&format!("{good}<geom size='0.1' mass='-1'/>"), "the mass of a geom of the body `b` is negative: -1 kg");
    geom(
        &format!("{good}<geom size='0.1' density='-5'/>"),
        "the density of a geom of the body `b` is negative: -5 kg/m³",
    );
    geom(&format!("{good}<geom size='-0.1'/>"), "the size of a geom of the body `b` is not positive");
    geom(&format!("{good}<geom/>"), "the size of a geom of the body `b` is not positive");
    geom("<geom type='box' mesh='x'/>", "the body `b` has the mass of a mesh, which is not known here");
}

#[test]
fn disabled_forces_vanish() {
    let flags = |flags: &str| {
        let head = format!("<option><flag {flags}/></option><option><flag gravity='enable'/></option>");
        let tendon = "<tendon><fixed name='t' stiffness='3' damping='0.2' springlength='0.1'>\
                      <joint joint='a' coef='2'/></fixed></tendon>";
        let body = "<body name='b'><joint name='a' axis='1 0.3 0' stiffness='3' damping='1' frictionloss='2'/>\
                    INERTIAL</body>";
        text("m.xml", &model(&head, body, tendon))
    };
    let none = flags("spring='disable' damper='disable' gravity='disable'");
    let [m, h] = values(&none, &[0.3], &[0.7], ["mass_matrix", "bias"]);
    near("M", &m, &[0.1722935779816513]);
    near("C q̇ + G", &h, &[0.8531989881157648]);
    assert!(none.lines().all(|line| !line.starts_with("    dissipation")), "{none}");
    assert_eq!(flags("passive='disable'"), none);
    assert!(!flags("frictionloss='disable'").contains("friction"));
    assert!(!flags("constraint='disable'").contains("friction"));
    // τ = −1.4 − 3·0.3 of the joint alone, and −2²·0.2·0.7 and −2·3·(2·0.3 − 0.1) of the tendon.
    let [h, loss] = values(&flags("spring='enable'"), &[0.3], &[0.7], ["bias", "dissipation_force"]);
    near("C q̇ + G", &h, &[0.8531989881157648 + 0.9 + 3.0]);
    near("∂D/∂q̇", &loss, &[0.7 + 0.56]);
    refused(
        "m.xml",
        &hinge("").replace("<worldbody>", "<option><flag spring='false'/></option><worldbody>"),
        "`spring` cannot be `false`",
    );
}

/// Joints and tendons state them by up to three numbers, the factors of a polynomial.
#[test]
fn springs_and_dampers_are_linear() {
    let tendon = |attributes: &str, head: &str| {
        let body = "<body name='b'><joint name='a' axis='1 0.3 0'/>INERTIAL</body>";
        let tendon = format!("<tendon><fixed name='t' {attributes}><joint joint='a' coef='2'/></fixed></tendon>");
        model(head, body, &tendon)
    };
    let plain = text("m.xml", &tendon("stiffness='3' damping='0.2'", ""));
    assert_eq!(text("m.xml", &tendon("stiffness='3 0 0' damping='0.2 0 0'", "")), plain);
    refused("m.xml", &tendon("stiffness='3 0 1'", ""), "`stiffness` of the tendon `t` is not linear");
    refused("m.xml", &hinge("damping='3 1'"), "the damping of the joint `a` is not linear");
    // What is turned off may be of any kind.
    let off = "<option><flag spring='disable' damper='disable'/></option>";
    assert_eq!(text("m.xml", &tendon("stiffness='3 0 1' damping='1 2'", off)), text("m.xml", &tendon("", "")));
    let curved = hinge("stiffness='3 1' damping='0.1 2'").replace("<worldbody>", &format!("{off}<worldbody>"));
    assert_eq!(text("m.xml", &curved), text("m.xml", &hinge("")));
}

#[test]
fn disabled_equalities_vanish() {
    let bodies = "<body name='b'><joint name='a' axis='1 0.3 0'/>INERTIAL</body>";
    let equality = |head: &str, attributes: &str| {
        let tail = format!("<equality><joint name='e' joint1='a' {attributes}/></equality>");
        text("m.xml", &model(head, bodies, &tail))
    };
    let class = "<default><default class='k'><equality active='false'/></default></default>";
    assert!(equality("", "").contains("    constraint e: a = 0;\n"));
    assert!(equality(class, "").contains("constraint"));
    assert!(equality(class, "class='k' active='true'").contains("constraint"));
    for (head, attributes) in [
        ("", "active='false'"),
        ("<default><equality active='false'/></default>", ""),
        (class, "class='k'"),
        ("<option><flag equality='disable'/></option>", ""),
        ("<option><flag constraint='disable'/></option>", ""),
    ] {
        assert!(!equality(head, attributes).contains("constraint"), "{head}");
    }
}

/// Two hinged bodies with a site each, at (0.1, 0, 0) and (0, 0.2, 0), and what couples them.
fn coupled(equality: &str) -> String {
    let bodies = "<body name='b'><joint name='a' axis='0 0 1'/><site name='p' pos='0.1 0 0'/>INERTIAL</body>\
                  <body name='d' pos='0.5 0 0'><joint name='c' axis='0 1 0'/><site name='q' pos='0 0.2 0'/>INERTIAL</body>";
    model("", bodies, &format!("<equality>{equality}</equality>"))
}

/// Half way between its ends, with z towards the first; of its own or of a default.
#[test]
fn sites_have_ends() {
    let weld = coupled("<weld name='e' site1='p' site2='q'/>");
    let posed = weld.replace("name='p' pos='0.1 0 0'", "name='p' pos='0 0 1' quat='0 1 0 0'");
    let ends = "fromto='0 0 0.5 0 0 1.5'";
    let own = weld.replace("name='p' pos='0.1 0 0'", &format!("name='p' {ends}"));
    let default = format!("<default><default class='k'><site {ends}/></default></default><worldbody>");
    let of_class = weld.replace("name='p' pos='0.1 0 0'", "name='p' class='k'").replace("<worldbody>", &default);
    for xml in [own, of_class] {
        assert_eq!(text("m.xml", &xml), text("m.xml", &posed));
    }
    refused("m.xml", &weld.replace("name='p'", "name='p' fromto='1 0 0 1 0 0'"), "the ends of a site fall together");
}

#[test]
fn sites_come_in_pairs() {
    for equality in ["<connect name='e' site1='p'/>", "<weld name='e' site1='p'/>"] {
        refused("m.xml", &coupled(equality), "the equality `e` has no `site2`");
        refused("m.xml", &coupled(&equality.replace("site1", "site2")), "the equality `e` has no `site1`");
    }
}

/// The anchor is a point of the second body; of the first one it is where `relpose` has it, or where it is at rest.
#[test]
fn welds_have_an_anchor() {
    let check = |attributes: &str, first: &str| {
        let equality = format!("<weld name='e' body1='b' body2='d' anchor='0.1 0.2 0.3' {attributes}/>");
        let text = text("m.xml", &coupled(&equality));
        for line in [
            format!("    const e_first[3]: m = {first};\n"),
            "    const e_second[3]: m = [0.1, 0.2, 0.3];\n".to_string(),
            "    constraint e: b.point(e_first) = d.point(e_second);\n".to_string(),
        ] {
            assert!(text.contains(&line), "{line}{text}");
        }
    };
    check("relpose='1 2 3 1 0 0 0'", "[1, 2, 3]");
    check("", "[0.6, 0.2, 0.3]");
    check("torquescale='0'", "[0.6, 0.2, 0.3]");
}

/// What no torque holds turns freely.
#[test]
fn welds_without_torque_are_connections() {
    for of in ["body1='b' body2='d'", "site1='p' site2='q'"] {
        let rows = |scale: &str| {
            let text = text("m.xml", &coupled(&format!("<weld name='e' {of} torquescale='{scale}'/>")));
            assert!(text.contains("    constraint e: "), "{text}");
            text.contains("    constraint e_turn: ")
        };
        assert!(rows("1") && !rows("0"), "{of}");
    }
}

/// What a joint of one axis alone could move is held by that joint: six rows would follow from one another.
#[test]
fn welds_across_a_joint_lock_it() {
    let bodies = "<body name='b'><joint name='a' axis='0 1 0'/>INERTIAL<site name='s' pos='0 0 1.3'/>\
                  <body name='d' pos='0 0 1'><joint name='c' axis='1 0 0' ref='0.2'/>INERTIAL\
                  <site name='t' pos='0 0 0.3'/><body name='e' pos='1 0 0'><joint name='f' type='slide'/>INERTIAL\
                  <body name='g' quat='1 1 0 0'>INERTIAL</body></body></body></body>";
    let rows = |equality: &str| {
        let text = text("m.xml", &model("", bodies, &format!("<equality>{equality}</equality>")));
        values(&text, &[0.0; 3], &[0.0; 3], ["mass_matrix"]);
        let rows = text.lines().filter(|line| line.starts_with("    constraint ")).map(|line| line.trim().to_string());
        rows.collect::<Vec<_>>()
    };
    for weld in [
        "<weld name='k' body1='b' body2='d'/>",
        "<weld name='k' body1='d' body2='b' anchor='0 1 0'/>",
        "<weld name='k' body1='b' body2='d' relpose='0 0 1 1 0 0 0' torquescale='0' anchor='0 0 0'/>\
         <connect name='p' body1='b' body2='d' anchor='0 0.1 1'/>",
        "<weld name='k' site1='s' site2='t'/>",
        "<connect name='k' site1='s' site2='t'/>",
    ] {
        let name = if weld.contains("torquescale") { "p" } else { "k" };
        assert_eq!(rows(weld), [format!("constraint {name}: (c - 0.2) = 0;")], "{weld}");
    }
    for weld in ["<weld name='k' body1='d' body2='g'/>", "<connect name='k' body1='e' body2='d' anchor='0 0 0'/>"] {
        assert_eq!(rows(weld), ["constraint k: f = 0;"], "{weld}");
    }
    for nothing in ["<weld name='k' body1='e' body2='g'/>", "<connect name='k' body1='b' body2='d' anchor='2 0 1'/>"] {
        assert_eq!(rows(nothing), [""; 0], "{nothing}");
    }
    // What does not hold at rest, or has joints between that can move, is as it was.
    let two = rows("<connect name='k' body1='b' body2='e' anchor='1 1 1'/>");
    assert_eq!(two, ["constraint k: b.point(k_first) = e.point(k_second);"]);
}

#[test]
fn renamed_couplings_stand_at_the_top() {
    let text = text("m.xml", &coupled("<joint name='c' joint1='a' joint2='c'/>"));
    assert!(text.contains("// the coupling `c` is `c_coupling`.\n"), "{text}");
}

#[test]
fn springs_by_time_constants_are_refused() {
    let message = "the joint `a` has its spring by `springdamper`, which is not imported";
    refused("m.xml", &hinge("springdamper='0.5 0.7'"), message);
    assert!(text("m.xml", &hinge("springdamper='0 0' stiffness='3'")).contains("a_stiffness"));
}

/// Of what no joint holds the bases become free that carry joints: neither tables nor mocap bodies.
#[test]
fn surroundings_do_not_float() {
    let scene =
        "<body name='t'><geom size='.1'/></body><body name='m' mocap='true' pos='1 0 0'><geom size='.1'/></body>";
    let arm = "<body name='b'>INERTIAL<body name='c' pos='0 0 1'><joint name='j' axis='1 0 0'/>INERTIAL</body></body>";
    let free = |bodies: &str| {
        let text = floating("m.xml", &model("", bodies, ""));
        let places = text.lines().filter_map(|line| line.trim().strip_prefix("coord ")?.strip_suffix("_place[3]: m;"));
        places.map(str::to_string).collect::<Vec<_>>()
    };
    assert_eq!(free(&format!("{scene}{arm}")), ["b_joint"]);
    let held = arm.replace("name='b'", "name='b' mocap='true'");
    assert_eq!(free(&format!("{scene}{held}")), [""; 0]);
    // Where nothing has a joint, all is the robot.
    assert_eq!(free(scene), ["t_joint"]);
}

/// The help does not promise what `--floating` does not do.
#[test]
fn what_cannot_float_is_not_told_to() {
    let help = |body: &str, expected: &str| {
        let errors = Sources::robot("m.xml", &model("", body, "")).text(&|_| None).unwrap_err();
        let helps: Vec<_> = errors.iter().filter_map(|error| error.help.as_deref()).collect();
        assert_eq!(helps, [format!("a mechanism has coordinates: {expected}")]);
    };
    help("<body name='b'>INERTIAL</body>", "with `mbs import --floating` the base moves freely");
    help("<body name='b' mocap='true'>INERTIAL</body>", "give a link a joint that moves");
}

/// Names that the file does not give are not those that it gives.
#[test]
fn automatic_names_give_way() {
    let bodies = "<body name='x'><joint axis='1 0.3 0'/><joint axis='0 1 0'/>INERTIAL</body>\
                  <body><joint name='x_joint'/>INERTIAL</body><body name='body_2'><joint/>INERTIAL</body>";
    let text = text("m.xml", &model("", bodies, "<equality><joint joint1='x_joint'/></equality>"));
    for line in [
        "    coord x_joint_2: rad;\n",
        "    coord x_joint: rad;\n",
        "    let body_2_2 = rot_z(x_joint);\n",
        "    constraint joint_1: x_joint = 0;\n",
    ] {
        assert!(text.contains(line), "{line}{text}");
    }
}

/// Each statement in the comments on dry friction can be taken out of it.
#[test]
fn dry_friction_can_be_taken_out_of_comments() {
    let taken = |joint: &str, q: &[f64], qd: &[f64]| {
        let body = format!("<body name='b'><joint name='f' {joint} frictionloss='0.3'/>INERTIAL</body>");
        let text = text("m.xml", &model("", &body, ""));
        let text = text.replace("    // const f_", "    const f_").replace("    // dissipation", "    dissipation");
        let [loss] = values(&text, q, qd, ["dissipation_force"]);
        loss
    };
    near("a hinge", &taken("", &[0.1], &[2.0]), &[0.3 * 2.0 / 4.000001_f64.sqrt()]);
    // At e = (1, 0, 0, 0) ω = 2 (ė₁, ė₂, ė₃), and the force on ė is twice the torque: 4·0.3 ė/√(4 ė² + 10⁻⁶).
    let rates = [0.0, 0.3, -0.2, 0.6];
    let torque = rates.map(|rate| 4.0 * 0.3 * rate / (4.0 * 0.49 + 1e-6_f64).sqrt());
    near("a ball", &taken("type='ball'", &[1.0, 0.0, 0.0, 0.0], &rates), &torque);
    let place = [2.0, -1.0, 0.5];
    let force = place.map(|rate| 0.3 * rate / (5.25 + 1e-6_f64).sqrt());
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let loss = taken("type='free'", &q, &[&place[..], &rates[..]].concat());
    near("a free body", &loss, &[&force[..], &torque[..]].concat());
}
