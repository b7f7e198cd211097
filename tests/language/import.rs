//! Robots of other formats: against Pinocchio and MuJoCo, whose numbers `tests/import/compare.py` has written; what is
//! wrong with files; files that are damaged.

use mbs_derive::Analysis;
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::source::{Sources, Unreadable};
use mbs_tests::robustness::robot::{Outcome, ROBOTS, answered, damaged};
use serde_json::Value;

const ARM_URDF: &str = ROBOTS[0].1;
const ARM_SDF: &str = ROBOTS[1].1;
const ROVER: &str = ROBOTS[2].1;
const DRONE: &str = ROBOTS[3].1;

/// Written in the language.
fn text(file: &str, xml: &str) -> String {
    match Sources::robot(file, xml).text(&|path| Some(path.to_string())) {
        Ok((text, _)) => text,
        Err(errors) => panic!("{}", errors.render(file, xml)),
    }
}

/// Derived, without a warning.
fn analysed<'g>(name: &str, text: &str, graph: &'g Graph) -> Analysis<'g> {
    let sources = Sources::gather(name, text, |file| {
        let robot = ROBOTS.iter().find(|(name, _)| *name == file);
        robot.map(|(_, xml)| xml.as_bytes().to_vec()).ok_or_else(|| Unreadable::new("it is not there", ""))
    });
    let analysis =
        Analysis::of(&sources, graph).unwrap_or_else(|error| panic!("{}\n{text}", error.render_in(&sources)));
    assert_eq!(analysis.warnings(None).render_in(&sources), "", "{text}");
    analysis
}

/// What a function gives at a state.
fn called(analysis: &Analysis<'_>, name: &str, state: &State) -> Vec<f64> {
    let derivation = analysis.programs();
    let function = derivation.named(name).unwrap_or_else(|| panic!("there is no {name}"));
    Interpreter::new(derivation).evaluate(function, state)
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

#[track_caller]
fn near(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1e-12, |largest: f64, value| largest.max(value.abs()));
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= 1e-9 * scale, "{what}: off by {off:e} of {scale}\n{found:?}\n{expected:?}");
}

#[test]
fn robots_move_as_pinocchio_and_mujoco_have_it() {
    let reference: Value = serde_json::from_str(include_str!("../import/reference.json")).unwrap();
    let robots = reference["robots"].as_array().unwrap();
    assert_eq!(robots.len(), 5);
    for robot in robots {
        let file = robot["file"].as_str().unwrap();
        let (_, xml) = ROBOTS.into_iter().find(|(name, _)| *name == file).unwrap();
        let (graph, text) = (Graph::verbatim(), text(file, xml));
        let analysis = analysed("robot.mbs", &text, &graph);
        let coordinates: Vec<String> =
            analysis.programs().coordinates.iter().flat_map(|variable| variable.component_names()).collect();
        assert_eq!(Value::from(coordinates), robot["coordinates"], "{file}");
        for entry in robot["states"].as_array().unwrap() {
            let inputs = analysis.programs().inputs.iter().map(|input| input.count()).sum();
            let (q, qd) = (numbers(&entry["q"]), numbers(&entry["qd"]));
            let state = State { qdd: vec![0.0; q.len()], q, qd, u: vec![0.0; inputs], ..State::default() };
            for name in ["mass_matrix", "bias", "gravity"].into_iter().filter(|name| !entry[*name].is_null()) {
                near(&format!("{name} of {file}"), &called(&analysis, name, &state), &numbers(&entry[name]));
            }
            if !entry["qdd"].is_null() {
                let found = called(&analysis, "forward_dynamics", &state);
                near(&format!("accelerations of {file}"), &found, &numbers(&entry["qdd"]));
            }
            if let Some(residuals) = entry["residuals"].as_object() {
                // In the plane of the linkage the row across it vanishes, in MuJoCo it is 0.
                let expected: Vec<f64> =
                    ["loop", "geared", "tied"].iter().flat_map(|name| numbers(&residuals[*name])).collect();
                let expected: Vec<f64> = expected.into_iter().filter(|residual| residual.abs() > 1e-12).collect();
                near(&format!("constraints of {file}"), &called(&analysis, "constraint", &state), &expected);
            }
        }
    }
}

/// The same arm in two formats, and with its masses as parameters.
#[test]
fn formats_agree() {
    let state =
        State { q: vec![0.3, -0.7, 0.5, 0.08], qd: vec![0.4, 1.1, -0.6, 0.2], u: vec![0.0; 4], ..State::default() };
    let graph = Graph::verbatim();
    let arm = analysed("robot.mbs", &text("arm.urdf", ARM_URDF), &graph);
    let parameters = Sources::robot("arm.urdf", ARM_URDF).parameters(true).text(&|_| None).unwrap().0;
    assert!(parameters.contains("    param turntable_mass: kg = 7.3;\n"), "{parameters}");
    for text in [text("arm.sdf", ARM_SDF), parameters] {
        let graph = Graph::verbatim();
        let other = analysed("robot.mbs", &text, &graph);
        for name in ["mass_matrix", "bias", "gravity", "forward_dynamics"] {
            near(name, &called(&other, name, &state), &called(&arm, name, &state));
        }
    }
}

/// By angles and by quaternions a body flies alike.
#[test]
fn attitudes_by_angles_are_those_by_quaternions() {
    let angles = Sources::robot("drone.urdf", DRONE).angles(true).text(&|_| None).unwrap().0;
    assert!(
        angles.contains("rot_z(flight_attitude[0]) * rot_y(flight_attitude[1]) * rot_x(flight_attitude[2])"),
        "{angles}"
    );
    let (graph, other) = (Graph::verbatim(), Graph::verbatim());
    let by_angles = analysed("robot.mbs", &angles, &graph);
    let by_quaternion = analysed("robot.mbs", &text("drone.urdf", DRONE), &other);
    let (half_sine, half_cosine) = 0.35f64.sin_cos();
    // Turned about z by 0.7 rad, at 0.9 rad/s.
    let state = State {
        q: vec![0.1, 0.2, 0.3, 0.7, 0.0, 0.0, 0.5],
        qd: vec![0.0, 0.0, 0.0, 0.9, 0.0, 0.0, 0.3],
        u: vec![0.0],
        ..State::default()
    };
    let rates = [-0.45 * half_sine, 0.0, 0.0, 0.45 * half_cosine];
    let of_quaternion = State {
        q: [vec![0.1, 0.2, 0.3, half_cosine, 0.0, 0.0, half_sine], vec![0.5]].concat(),
        qd: [vec![0.0; 3], rates.to_vec(), vec![0.3]].concat(),
        u: vec![0.0],
        ..State::default()
    };
    let energy = |analysis: &Analysis<'_>, state: &State| called(analysis, "kinetic_energy", state);
    near("energy", &energy(&by_angles, &state), &energy(&by_quaternion, &of_quaternion));
    let (a, b) =
        (called(&by_angles, "forward_dynamics", &state), called(&by_quaternion, "forward_dynamics", &of_quaternion));
    near("accelerations", &[&a[..3], &a[6..]].concat(), &[&b[..3], &b[7..]].concat());
}

const WITH_A_SPRING: &str = "\
import \"arm.urdf\";

/// The arm, held by a spring and driven by a controller.
mechanism HeldArm {
    param k: N/m = 300;
    let hook = tool.point([0.05 m, 0, 0]);
    potential += spring(k, (hook - [0.3 m, 0, 1 m]).norm(), 0);
    force elbow += -2 N*m*elbow;
    output tip = hook;
}
";

/// `import \"arm.urdf\";` is what `mbs import` writes, and what stands beside it is added.
#[test]
fn robots_are_imported_in_memory() {
    let (graph, other) = (Graph::verbatim(), Graph::verbatim());
    let held = analysed("held.mbs", WITH_A_SPRING, &graph);
    let (head, written) = WITH_A_SPRING.split_once("mechanism HeldArm {").unwrap();
    let arm = text("arm.urdf", ARM_URDF);
    let (_, statements) = arm.split_once("mechanism SkewArm {").unwrap();
    let whole = format!(
        "{}mechanism HeldArm {{{}{written}",
        head.replace("import \"arm.urdf\";", ""),
        statements.trim_end().trim_end_matches('}')
    );
    let pasted = analysed("pasted.mbs", &whole, &other);
    let state =
        State { q: vec![0.3, -0.7, 0.5, 0.08], qd: vec![0.4, 1.1, -0.6, 0.2], u: vec![1.0; 4], ..State::default() };
    for name in ["mass_matrix", "gravity", "forward_dynamics", "tip"] {
        assert_eq!(called(&held, name, &state), called(&pasted, name, &state), "{name}");
    }
    assert_eq!(held.lagrangian().drawings().len(), 4);
}

#[test]
fn names_kinds_limits_and_shapes_are_kept() {
    let arm = text("arm.urdf", ARM_URDF);
    for line in [
        "// Imported from arm.urdf, URDF. Lengths are in m, angles in rad, masses in kg.\n",
        "// the link `upper-arm` is `upper_arm`.\n",
        "mechanism SkewArm {\n",
        "    /// Joint `shoulder`, revolute, from `turntable` to `upper-arm`; from -1.9 to 2.1 rad, at most 120 N·m, 2.5 rad/s.\n",
        "    coord shoulder: rad;\n    input shoulder_torque: N*m;\n",
        "    // It does not move: its 12 kg are in no energy.\n",
        "    shape base += cylinder(0.15 m, 0.1 m);\n",
        "    let upper_arm = turntable * translation(shoulder_at) * rot_x(-90 deg) * rotation([0.1, 0.2, 0.97], shoulder);\n",
        "    let forearm = upper_arm * translation(elbow_at) * rpy(0.3, -0.5, 0.2) * rot_y(-elbow);\n",
        "    dissipation += 1/2*feed_damping*dt(feed)^2;\n",
        "    // Dry friction of 0.2 N*m is left out",
        "    // Link `tool`, fixed by `flange`.\n",
    ] {
        assert!(arm.contains(line), "{line}\nis not in\n{arm}");
    }
    let rover = text("rover.urdf", ROVER);
    assert!(
        rover.contains("    let right_finger = right_finger_ratio*left_finger + right_finger_offset;\n"),
        "{rover}"
    );
    assert!(rover.contains("translation([drive_x, drive_y, 0]) * rot_z(drive_angle)"), "{rover}");
    let free = Sources::robot("drone.urdf", ROVER).floating(true).text(&|_| None).unwrap().0;
    assert!(free.contains("    coord floor_joint_place[3]: m;\n"), "{free}");
}

// ---- what is wrong with files

/// A robot of one hinge, in which something is replaced.
fn hinge(from: &str, to: &str) -> String {
    let good = r#"<robot name="r">
  <link name="stand"/>
  <link name="rod">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.2" iyy="0.2" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="rod.stl"/></geometry></visual>
  </link>
  <joint name="hinge" type="continuous"><parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/></joint>
</robot>"#;
    assert!(good.contains(from), "{from}");
    good.replacen(from, to, 1)
}

#[track_caller]
fn refused(file: &str, xml: &str, expected: &str) {
    let errors = Sources::robot(file, xml).text(&|_| Some("x.stl".to_string())).expect_err("a mistake");
    let report = errors.render(file, xml);
    let lines: Vec<&str> = report.lines().take(2).collect();
    assert_eq!(lines.join("\n"), expected, "{report}");
}

#[test]
fn mistakes_are_reported_with_file_line_and_link() {
    let check = |from: &str, to: &str, expected: &str| refused("r.urdf", &hinge(from, to), expected);
    check(
        "value=\"2\"",
        "value=\"-2\"",
        "error[MBS0310]: the mass of the link `rod` is negative: -2 kg\n --> r.urdf:4:5",
    );
    check(
        "value=\"2\"",
        "value=\"NaN\"",
        "error[MBS0310]: the mass of the link `rod` is not finite: `NaN`\n --> r.urdf:4:45",
    );
    check(
        "value=\"2\"",
        "value=\"2 kg\"",
        "error[MBS0310]: the mass of the link `rod` is not a number: `kg`\n --> r.urdf:4:45",
    );
    check(
        "izz=\"0.01\"",
        "izz=\"0.5\"",
        "error[MBS0310]: no body has the inertia of the link `rod`: a principal moment is greater than the sum of the other two\n --> r.urdf:4:5",
    );
    check(
        "ixy=\"0\"",
        "ixy=\"0.4\"",
        "error[MBS0310]: the inertia of the link `rod` has a negative principal moment\n --> r.urdf:4:5",
    );
    check("izz=\"0.01\" ", "", "error[MBS0310]: the inertia of the link `rod` has no `izz`\n --> r.urdf:5:7");
    check("<mass value=\"2\"/>", "", "error[MBS0310]: the inertial of the link `rod` has no mass\n --> r.urdf:4:5");
    check(
        "link name=\"rod\"",
        "link name=\"stand\"",
        "error[MBS0310]: a second link is called `stand`\n --> r.urdf:3:9",
    );
    check(
        "child link=\"rod\"",
        "child link=\"rode\"",
        "error[MBS0310]: the child of the joint `hinge` is the link `rode`, which is not there\n --> r.urdf:8:70",
    );
    check(
        "parent link=\"stand\"",
        "parent link=\"rod\"",
        "error[MBS0310]: the joints lead in a circle: the link `rod` hangs on itself\n --> r.urdf:3:3",
    );
    check(
        "  <joint",
        "  <link name=\"other\"/>\n  <joint",
        "error[MBS0310]: there are two roots: neither `stand` nor `other` is the child of a joint\n --> r.urdf:8:3",
    );
    check(
        "continuous",
        "helical",
        "error[MBS0310]: the joint `hinge` is of an unknown kind, `helical`\n --> r.urdf:8:23",
    );
    check(
        "xyz=\"0 1 0\"",
        "xyz=\"0 0 0\"",
        "error[MBS0310]: the axis of the joint `hinge` has no direction\n --> r.urdf:8:3",
    );
    check(
        "xyz=\"0 1 0\"",
        "xyz=\"0 1\"",
        "error[MBS0310]: the axis of the joint `hinge` is 3 numbers, 2 are given\n --> r.urdf:8:88",
    );
    check("continuous", "fixed", "error[MBS0310]: no joint of the robot `r` moves\n --> r.urdf:2:3");
    check(
        "value=\"2\"",
        "value=\"${mass}\"",
        "error[MBS0310]: the mass of the link `rod` is not a number: `${mass}`\n --> r.urdf:4:45",
    );
    check(
        "<link name=\"stand\"/>",
        "<link name=\"stand\">",
        "error[MBS0310]: this is not XML: expected 'link' tag, not 'robot'\n --> r.urdf:9:1",
    );
    check(
        "<robot name=\"r\">",
        "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:leg/>",
        "error[MBS0310]: this file is xacro: `leg` is not expanded\n --> r.urdf:1:61",
    );
    check(
        "<robot name=\"r\">",
        "<robots>",
        "error[MBS0310]: this is not XML: expected 'robots' tag, not 'robot'\n --> r.urdf:9:1",
    );
    // Nothing behind the hinge weighs anything.
    let massless = "<robot name=\"r\"><link name=\"a\"/>\n<link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    refused(
        "r.urdf",
        massless,
        "error[MBS0310]: the link `b` moves by the joint `j`, and neither it nor what hangs on it has mass\n --> r.urdf:2:1",
    );
    let circle = hinge(
        "</robot>",
        "<joint name=\"back\" type=\"fixed\"><parent link=\"rod\"/><child link=\"stand\"/></joint></robot>",
    );
    refused(
        "r.urdf",
        &circle,
        "error[MBS0310]: the joints lead in a circle: the link `stand` hangs on itself\n --> r.urdf:2:3",
    );
    // It stood for ever once, since the circle is below a root: `damaged_robots` found it.
    let loop_below = hinge(
        "</robot>",
        "<link name=\"top\"/><joint name=\"back\" type=\"fixed\"><parent link=\"rod\"/><child link=\"stand\"/></joint>\
         <joint name=\"base\" type=\"fixed\"><parent link=\"top\"/><child link=\"stand\"/></joint></robot>",
    );
    refused("r.urdf", &loop_below, "error[MBS0310]: the link `stand` is the child of two joints\n --> r.urdf:2:3");
    refused("r.urdf", "<html/>", "error[MBS0310]: `html` is no robot\n --> r.urdf:1:1");
    let follows = |other: &str, expected: &str| {
        let mimic = hinge("</joint>", &format!("<mimic joint=\"{other}\"/></joint>"));
        refused("r.urdf", &mimic, expected);
    };
    follows("hinge", "error[MBS0310]: the joint `hinge` follows itself, by way of others\n --> r.urdf:8:3");
    follows(
        "none",
        "error[MBS0310]: the joint `hinge` follows `none`, which is no joint that moves\n --> r.urdf:8:101",
    );
}

#[test]
fn mistakes_of_other_formats_are_reported_too() {
    let model = |body: &str| format!("<mujoco>\n<worldbody>\n<body name=\"a\">{body}</body>\n</worldbody>\n</mujoco>");
    let check = |body: &str, expected: &str| refused("m.xml", &model(body), expected);
    let joint = "<joint name=\"j\"/>";
    check(
        &format!("{joint}<geom type=\"mesh\" mesh=\"m\"/>"),
        "error[MBS0310]: the body `a` has the mass of a mesh, which is not known here\n --> m.xml:3:33",
    );
    check(
        &format!("{joint}<geom size=\"0.1 x\"/>"),
        "error[MBS0310]: the size of a geom of the body `a` is not a number: `x`\n --> m.xml:3:39",
    );
    check(
        "<joint name=\"j\" type=\"screw\"/><geom size=\"1\"/>",
        "error[MBS0310]: the joint `j` is of an unknown kind, `screw`\n --> m.xml:3:32",
    );
    check(
        &format!("{joint}{joint}<geom size=\"1\"/>"),
        "error[MBS0310]: a second joint is called `j`\n --> m.xml:3:40",
    );
    check(
        "<joint class=\"no\"/><geom size=\"1\"/>",
        "error[MBS0310]: there is no class `no` of defaults\n --> m.xml:3:23",
    );
    check("<include file=\"b.xml\"/>", "error[MBS0310]: `include` is not imported\n --> m.xml:3:16");
    // Its spring would be one of nothing.
    let belt = "<tendon>\n<fixed name=\"belt\" stiffness=\"4\"/>\n</tendon>\n</mujoco>";
    let belted = model(&format!("{joint}<geom size=\"1\"/>")).replace("</mujoco>", belt);
    refused("m.xml", &belted, "error[MBS0310]: the tendon `belt` is along no joint\n --> m.xml:6:1");
    for (without, left) in [("joint", "coef=\"1\""), ("coef", "joint=\"j\"")] {
        let both = "<joint joint=\"j\" coef=\"1\"/>";
        let tendon = format!("<fixed name=\"belt\" stiffness=\"4\">{both}<joint {left}/></fixed>");
        let message = format!("error[MBS0310]: a joint of the tendon `belt` has no `{without}`\n --> m.xml:6:61");
        refused("m.xml", &belted.replace("<fixed name=\"belt\" stiffness=\"4\"/>", &tendon), &message);
    }
    check(
        joint,
        "error[MBS0310]: the link `a` moves by the joint `j`, and neither it nor what hangs on it has mass\n --> m.xml:3:1",
    );
    check(
        "<freejoint/><body><freejoint/><geom size=\"1\"/></body>",
        "error[MBS0310]: the body `body_2` hangs on another one by a free joint\n --> m.xml:3:28",
    );
    let sdf =
        |inside: &str| format!("<sdf version=\"1.9\"><model name=\"m\">\n<link name=\"l\"/>{inside}</model></sdf>");
    refused(
        "m.sdf",
        &sdf("<joint name=\"j\" type=\"screw\"><parent>world</parent><child>l</child></joint>"),
        "error[MBS0310]: the joint `j` is of a kind that is not imported, `screw`\n --> m.sdf:2:33",
    );
    refused(
        "m.sdf",
        &sdf("<joint name=\"j\" type=\"fixed\"><parent>x</parent><child>l</child></joint>"),
        "error[MBS0310]: the parent of the joint `j` is `x`, which is no link or frame of the model\n --> m.sdf:2:46",
    );
    let massless = "<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>";
    refused(
        "m.sdf",
        &sdf("").replace("<link name=\"l\"/>", &format!("<link name=\"l\">{massless}</link>")),
        "error[MBS0310]: the link `l` moves by the joint `l_free`, and neither it nor what hangs on it has mass\n --> m.sdf:2:16",
    );
    refused("m.sdf", "<sdf/>", "error[MBS0310]: there is no model in this file\n --> m.sdf:1:1");
}

/// On request an inertia that no body has is taken, with a warning, and T is what it says.
#[test]
fn any_inertia_is_taken_on_request() {
    let xml = hinge("izz=\"0.01\"", "izz=\"0.5\"");
    let (text, warnings) = Sources::robot("r.urdf", &xml).any_inertia(true).text(&|_| None).unwrap();
    assert!(warnings.render("r.urdf", &xml).contains("warning[MBS0310]: no body has the inertia of the link `rod`"));
    let graph = Graph::verbatim();
    let state = State { q: vec![0.3], qd: vec![1.0], u: vec![0.0], ..State::default() };
    near("M", &called(&analysed("r.mbs", &text, &graph), "mass_matrix", &state), &[0.2 + 2.0 * 0.25]);
}

/// A mesh that is not there is no mistake, but told, and not drawn.
#[test]
fn missing_meshes_are_told() {
    let xml = hinge("<robot", "<robot");
    let (text, warnings) = Sources::robot("r.urdf", &xml).text(&|_| None).unwrap();
    assert!(
        warnings
            .render("r.urdf", &xml)
            .starts_with("warning[MBS0310]: the mesh `rod.stl` of the link `rod` is not drawn\n --> r.urdf:6:29\n")
    );
    assert!(!text.contains("shape"), "{text}");
}

/// What is most likely a slip is told, and taken.
#[test]
fn doubtful_numbers_and_names_are_told() {
    let check = |file: &str, xml: &str, expected: &str| {
        let (_, warnings) = Sources::robot(file, xml).text(&|_| Some("x.stl".to_string())).expect("no mistake");
        let report = warnings.render(file, xml);
        assert_eq!(report.lines().take(2).collect::<Vec<_>>().join("\n"), expected, "{report}");
    };
    check("r.urdf", &hinge("<axis", "<origin rpy=\"0 6.28 -3.15\"/><axis"), "");
    check(
        "r.urdf",
        &hinge("<axis", "<origin rpy=\"0 90 0\"/><axis"),
        "warning[MBS0310]: the attitude of the joint `hinge` has an angle of 90 rad, more than a whole turn\n --> r.urdf:8:90",
    );
    check(
        "r.urdf",
        &hinge("value=\"2\"", "value=\"0\""),
        "warning[MBS0310]: the link `rod` has an inertia, and no mass\n --> r.urdf:4:5",
    );
    let geoms = "<joint name=\"j\"/><geom size=\"1\"/><geom type=\"mesh\" mesh=\"none\" mass=\"0\"/>";
    check(
        "m.xml",
        &format!("<mujoco><worldbody>\n<body name=\"a\">{geoms}</body></worldbody></mujoco>"),
        "warning[MBS0310]: the mesh `none` of the body `a` is not drawn\n --> m.xml:2:67",
    );
    // What stands in comments is no element.
    let comments = "<!-- a <link> -->".repeat(600);
    check("r.urdf", &hinge("<link name=\"stand\"/>", &format!("<link name=\"stand\"/>{comments}")), "");
}

/// `multiplier*(leader - reference) + offset`, also behind a joint of two axes.
#[test]
fn joints_of_sdf_follow_others() {
    let inertial = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
    let joint = |name: &str, kind: &str, ends: [&str; 2], rest: &str| {
        let [parent, child] = ends;
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent>{parent}</parent><child>{child}</child>{rest}</joint>\n\
             <link name=\"{child}\">{inertial}</link>"
        )
    };
    let axis = |name: &str, inside: &str| format!("<{name}><xyz>0 0 1</xyz>{inside}</{name}>");
    let follows = |axis: &str| {
        format!(
            "<mimic joint=\"cross\" axis=\"{axis}\"><multiplier>3</multiplier><offset>0.5</offset><reference>0.125</reference></mimic>"
        )
    };
    let cross = axis("axis", "") + "<axis2><xyz>0 1 0</xyz></axis2>";
    let xml = |of: &str| {
        let first = joint("cross", "universal", ["world", "a"], &cross);
        let second = joint("tail", "revolute", ["a", "b"], &axis("axis", &follows(of)));
        format!("<sdf version=\"1.11\"><model name=\"m\">{first}{second}</model></sdf>")
    };
    let second = text("m.sdf", &xml("axis2"));
    assert!(second.contains("    const tail_ratio: 1 = 3;\n    const tail_offset: 1 = 0.125;"), "{second}");
    assert!(second.contains("    let tail = tail_ratio*cross_2 + tail_offset;\n"), "{second}");
    assert!(text("m.sdf", &xml("axis")).contains("    let tail = tail_ratio*cross_1 + tail_offset;\n"));
}

/// A mistake in a robot that a mechanism imports is shown at the import, with its place.
#[test]
fn mistakes_in_imported_robots_are_shown_at_the_import() {
    let bad = hinge("value=\"2\"", "value=\"-2\"");
    let source = "import \"r.urdf\";\nmechanism A { }\n";
    let sources = Sources::gather("a.mbs", source, |_| Ok(bad.clone().into_bytes()));
    let graph = Graph::verbatim();
    let report = Analysis::of(&sources, &graph).err().unwrap().render_in(&sources);
    let expected = "error[MBS0301]: cannot import `r.urdf`: r.urdf:4:5: the mass of the link `rod` is negative: -2 kg\n --> a.mbs:1:1\n";
    assert!(report.starts_with(expected), "{report}");
    // What is wrong with what it has become is shown in that text, which is not the file's.
    let still = hinge("ixx=\"0.2\" iyy=\"0.2\" izz=\"0.01\"", "ixx=\"0\" iyy=\"0\" izz=\"0\"").replace("-0.5", "0");
    let sources = Sources::gather("a.mbs", source, |_| Ok(still.clone().into_bytes()));
    let report = Analysis::of(&sources, &graph).err().unwrap().render_in(&sources);
    assert!(report.contains("\n  --> `mbs import r.urdf`:12:11\n   |\n12 |     coord hinge: rad;\n"), "{report}");
    // In a file of shared declarations there is no place for coordinates.
    let sources = Sources::gather("a.mbs", "import \"b.mbs\";\nmechanism A { }\n", |file| match file {
        "b.mbs" => Ok(b"import \"r.urdf\"; const n = 1;".to_vec()),
        _ => Ok(hinge("<robot", "<robot").into_bytes()),
    });
    let report = Analysis::of(&sources, &graph).err().unwrap().render_in(&sources);
    assert!(
        report.starts_with(
            "error[MBS0303]: cannot import `r.urdf`: it is a robot, this is a file of shared declarations\n"
        ),
        "{report}"
    );
}

/// Whatever is done to a file, it is read or refused, with file and line; what is read is a text of the language.
/// `cargo run --release -p mbs-tests --bin damaged_robots` draws more of them.
#[test]
fn damaged_files_are_answered() {
    let (mut refused, mut derived) = (0, 0);
    for seed in 0..3000 {
        let (file, xml) = damaged(seed);
        match answered(seed, file, &xml).unwrap_or_else(|fault| panic!("seed {seed}: {fault}\n{xml}")) {
            Outcome::Refused => refused += 1,
            Outcome::Read => {}
            Outcome::Derived => derived += 1,
        }
    }
    assert!(refused > 1000 && derived > 300, "{refused} refused, {derived} derived");
}
