//! Numbers are those of MuJoCo 4.0, of the same bodies in MJCF, put together by hand.

use super::{floating, moves, refused, text};

const INERTIAL: &str = "<inertial><pose>0.1 0.2 0.3 0.1 0.2 0.3</pose><mass>2</mass>\
    <inertia><ixx>0.03</ixx><iyy>0.04</iyy><izz>0.05</izz></inertia></inertial>";

/// Its bodies are named `b` and `c`, its joints `j` and `k`.
fn model(attributes: &str, inside: &str) -> String {
    let inside = inside.replace("INERTIAL", INERTIAL);
    format!("<sdf version='1.11'><model name='m' {attributes}>{inside}</model></sdf>")
}

fn link(pose: &str, rest: &str) -> String {
    format!("<link name='b'><pose>{pose}</pose>{rest}</link>")
}

/// Of `b` in the world, with this pose and axis.
fn joint(pose: &str, axis: &str) -> String {
    format!("<joint name='j' type='revolute'><parent>world</parent><child>b</child>{pose}<axis>{axis}</axis></joint>")
}

const AXIS: &str = "<xyz>0 1 0</xyz>";

/// A link `c` on `b`, hinged about x.
fn second(pose: &str, rest: &str) -> String {
    format!(
        "<link name='c'>{pose}{rest}</link><joint name='k' type='revolute'><parent>b</parent><child>c</child>\
         <axis><xyz>1 0 0</xyz></axis></joint>"
    )
}

const BEHIND: &str = "<pose relative_to='b'>0 0.5 0 0 0 0</pose>";

#[test]
fn models_have_a_pose() {
    let rolled = link("0 0 1 0 0 0", "INERTIAL") + &joint("", AXIS);
    let (mass_matrix, bias) = ([0.23917480586539036], [-1.95055526023863]);
    moves("m.sdf", &model("", &format!("<pose>0 0 0 1.0 0 0</pose>{rolled}")), &mass_matrix, &bias);
    // The pose of the model is that of its link.
    let placed = link("0 0 1 0.4 0 0", "INERTIAL") + &joint("", AXIS);
    let by_link = model("placement_frame='b'", &format!("<pose>0 0 0 1.0 0 0</pose>{placed}"));
    moves("m.sdf", &by_link, &mass_matrix, &bias);
    assert!(text("m.sdf", &by_link).contains("    let b = rot_x(1) * rot_y(j);\n"));
    let elsewhere = model("", &format!("<pose relative_to='x'>0 0 0 1.0 0 0</pose>{rolled}"));
    refused("m.sdf", &elsewhere, "the model is placed relative to `x`, which is not imported");
}

/// The first link has no weight, the second one has.
#[test]
fn links_are_without_weight() {
    let first = |rest: &str| link("0 0 1 0 0 0", &format!("INERTIAL{rest}")) + &joint("", AXIS);
    moves(
        "m.sdf",
        &model("", &(first("<gravity>false</gravity>") + &second(BEHIND, "INERTIAL"))),
        &[0.3787638342107095, -0.061226029573616295, -0.061226029573616295, 0.29171031749404613],
        &[-3.052846904861996, 5.580087909279854],
    );
    // Alone it swings by nothing.
    moves("m.sdf", &model("", &first("<gravity>0</gravity>")), &[0.23917480586539036], &[0.0]);
    refused("m.sdf", &model("", &first("<gravity>no</gravity>")), "`gravity` is neither true nor false: `no`");
}

#[test]
fn static_models_do_not_move() {
    let moving = link("0 0 1 0 0 0", "INERTIAL") + &joint("", AXIS);
    let xml = model("", &format!("<static>true</static>{moving}"));
    refused("m.sdf", &xml, "the model `m` is static: nothing of it moves");
    assert!(text("m.sdf", &xml.replace("true", "false")).contains("coord j"));
}

/// Worlds have a ground plane, which is not the robot.
#[test]
fn static_models_beside_the_robot_are_left_out() {
    let robot = format!("<model name='m'>{}</model>", link("0 0 1 0 0 0", "INERTIAL") + &joint("", AXIS));
    let robot = robot.replace("INERTIAL", INERTIAL);
    let still = |name: &str| format!("<model name='{name}'><static>true</static><link name='p'/></model>");
    let world = |models: String| format!("<sdf version='1.11'><world name='w'>{models}</world></sdf>");
    let alone = text("m.sdf", &world(robot.clone()));
    let (before, behind) = (still("ground_plane"), still("wall"));
    let beside = text("m.sdf", &world(format!("{before}{robot}{behind}")));
    let (first, rest) = alone.split_once('\n').unwrap();
    let note = "// Left out, being static models: `ground_plane`, `wall`.";
    assert_eq!(beside, format!("{first}\n{note}\n{rest}"));
    refused("m.sdf", &world(before.clone() + &behind), "all models in this file are static: nothing moves");
    refused("m.sdf", &world(before + &robot + &robot), "there is a second model in this file");
}

/// What has no place in a mechanism is said at the top.
#[test]
fn what_is_left_out_is_noted() {
    let notes = |links: &str| {
        let text = text("m.sdf", &model("", links));
        let notes = text.lines().skip(1).take_while(|line| !line.is_empty()).map(str::to_string);
        notes.collect::<Vec<_>>()
    };
    let start = |from: &str| joint("", &format!("{AXIS}<initial_position>{from}</initial_position>"));
    let body = link("0 0 1 0 0 0", "INERTIAL<sensor name='s' type='imu'/>");
    assert_eq!(notes(&(body.clone() + &start("0"))), ["// Left out: sensor."]);
    let of_start = "// The initial position of the joint `j` is left out: a simulation states its own.";
    assert_eq!(notes(&(link("", "INERTIAL") + &start("0.5"))), [of_start]);
    let ball =
        start("0").replace("revolute", "ball").replace("</xyz>", "</xyz><dynamics><damping>3</damping></dynamics>");
    let of_ball = "// The axis of the ball joint `j` is left out, and what it says of damping and limits.";
    assert_eq!(notes(&(link("", "INERTIAL") + &ball)), [of_ball]);
}

/// A kilogram, and a kg·m² about each axis.
#[test]
fn masses_have_defaults() {
    let inertial = "<inertial><pose>0.1 0 0 0 0 0</pose><mass>2</mass></inertial>";
    let links = link("0 0 1 0 0 0", "") + &joint("", AXIS) + &second(BEHIND, inertial);
    moves("m.sdf", &model("", &links), &[2.02, 0.0, 0.0, 1.0], &[-1.8724595186861879, 0.0]);
}

#[test]
fn masses_that_are_not_stated_are_refused() {
    let check = |rest: &str, message: &str| {
        refused("m.sdf", &model("", &(link("0 0 1 0 0 0", rest) + &joint("", AXIS))), message);
    };
    check(
        "<inertial auto='true'/>",
        "the inertial of the link `b` is to be computed from its collisions, by `auto`, which is not imported",
    );
    check(
        "<inertial><pose relative_to='__model__'>0 0 1 0 0 0</pose></inertial>",
        "the inertial of the link `b` is placed relative to `__model__`, which is not imported",
    );
    check(
        "<inertial><fluid_added_mass/></inertial>",
        "the inertial of the link `b` has the mass of a fluid, by `fluid_added_mass`, which is not imported",
    );
    check("<kinematic>true</kinematic>", "the link `b` is `kinematic`: forces do not move it, which is not imported");
    check(
        "<velocity_decay><linear>0.1</linear><angular>0</angular></velocity_decay>",
        "the link `b` is slowed by `velocity_decay`, which is not imported",
    );
}

/// z of the joint, where nothing is stated.
#[test]
fn axes_have_a_default() {
    let pose = "<pose>0 0 0 1.0 0 0</pose>";
    for axis in ["<limit><lower>-1</lower><upper>1</upper></limit>", "<xyz>0 0 1</xyz>"] {
        let xml = model("", &(link("0 0 1 0 0 0", "INERTIAL") + &joint(pose, axis)));
        moves("m.sdf", &xml, &[0.32180410074148863], &[-0.18145255829251555]);
    }
    let negative = format!("{AXIS}<dynamics><damping>-1</damping></dynamics>");
    let xml = model("", &(link("0 0 1 0 0 0", "INERTIAL") + &joint("", &negative)));
    refused("m.sdf", &xml, "the joint `j` has negative damping, friction or stiffness");
}

/// What is infinite is no limit, in words and in numbers; one side may have one alone.
#[test]
fn limits_may_be_infinite() {
    let check = |limits: &str, shown: &str| {
        let xml = model("", &(link("0 0 1 0 0 0", "INERTIAL") + &joint("", &format!("{AXIS}<limit>{limits}</limit>"))));
        let line = format!("    /// Joint `j`, revolute, from the world to `b`{shown}.\n");
        let text = text("m.sdf", &xml);
        assert!(text.contains(&line), "{line}{text}");
    };
    let of = |low: &str, high: &str, most: &str| {
        format!("<lower>{low}</lower><upper>{high}</upper><effort>{most}</effort><velocity>{most}</velocity>")
    };
    for (low, high) in [("-inf", "inf"), ("-INF", " +inf "), ("-1e16", "1e16"), ("-infinity", "infinity")] {
        check(&of(low, high, high), "");
        check(&of("-1.5", high, "3"), "; at least -1.5 rad, at most 3 N·m, 3 rad/s");
        check(&of(low, "2", high), "; at most 2 rad");
    }
    check("<lower>-1</lower>", "; at least -1 rad");
    check(&of("-1", "2", "-1"), "; from -1 to 2 rad");
    let links = |axis: &str| model("", &(link("0 0 1 0 0 0", "INERTIAL") + &joint("", axis)));
    let not = links(&format!("{AXIS}<limit><lower>nan</lower></limit>"));
    refused("m.sdf", &not, "`lower` of the joint `j` is not finite: `nan`");
    let damped = links(&format!("{AXIS}<dynamics><damping>inf</damping></dynamics>"));
    refused("m.sdf", &damped, "`damping` of the joint `j` is not finite: `inf`");
}

#[test]
fn attitudes_are_in_degrees_and_quaternions() {
    for pose in [
        "<pose degrees='1'>0 0 1 90 0 0</pose>",
        "<pose degrees='True'>0 0 1 90 0 0</pose>",
        "<pose degrees='0'>0 0 1 1.5707963267948966 0 0</pose>",
        "<pose rotation_format='quat_xyzw'>0 0 1 1 0 0 1</pose>",
    ] {
        let xml = model("", &format!("<link name='b'>{pose}INERTIAL</link>{}", joint("", AXIS)));
        moves("m.sdf", &xml, &[0.2391748058653902], &[0.0]);
    }
    let unknown = "<link name='b'><pose rotation_format='wxyz'>0 0 1 1 0 0 1</pose></link>";
    refused("m.sdf", &model("", unknown), "the pose of `b` is in a format that is not known, `wxyz`");
}

/// A fixed joint holds it, as any other.
#[test]
fn what_is_fixed_to_the_world_does_not_float() {
    let fixed = joint("", "").replace("revolute", "fixed");
    let xml = model("", &(link("0 0 1 0 0 0", "INERTIAL") + &fixed + &second(BEHIND, "INERTIAL")));
    assert_eq!(floating("m.sdf", &xml), text("m.sdf", &xml));
}

/// Comments in front of a text, and within it, leave what it says.
#[test]
fn comments_stand_in_texts() {
    let plain = "<pose>0 0 0 1.0 0 0</pose>".to_string() + &link("0 0 1 0 0 0", "INERTIAL") + &joint("", AXIS);
    let marked = ["<pose>", "<mass>", "<ixx>", "<parent>", "<child>", "<xyz>"]
        .iter()
        .fold(model("", &plain), |text, tag| text.replace(tag, &format!("{tag}<!-- a note -->")))
        .replace("0 0 1 0 0 0", "0 0 <!-- up --> 1 0 0 0");
    assert_eq!(text("m.sdf", &marked), text("m.sdf", &model("", &plain)));
}

/// `frame` is what versions before 1.7 call `relative_to`.
#[test]
fn links_and_shapes_stand_in_joints() {
    let pose = "<pose>0 0 0 1.0 0 0</pose>";
    let first = link("0 0 1 0 0 0", "INERTIAL") + &joint(pose, AXIS);
    for attribute in ["relative_to", "frame"] {
        let links = first.clone() + &second(&format!("<pose {attribute}='j'>0 0 0.5 0 0 0</pose>"), "INERTIAL");
        moves(
            "m.sdf",
            &model("", &links),
            &[1.1029438695880551, -0.06122602957361631, -0.06122602957361631, 0.29171031749404636],
            &[-4.305056890326029, -0.4313975811571247],
        );
    }
    let ball = "<geometry><sphere><radius>0.1</radius></sphere></geometry>";
    let visual = format!("INERTIAL<visual name='v'><pose relative_to='__model__'>0 0 3 0 0 0</pose>{ball}</visual>");
    let text = text("m.sdf", &model("", &(link("0 0 1 0 0 0", &visual) + &joint("", AXIS))));
    assert!(text.contains("    shape b * translation([0, 0, 2 m]) += sphere(0.1 m);\n"), "{text}");
}

/// A joint may name a frame for a link: it stands in that of its child, and moves what carries them.
#[test]
fn joints_are_between_frames() {
    let frame = |name: &str, of: &str, pose: &str| format!("<frame name='{name}' {of}><pose>{pose}</pose></frame>");
    let joint = |parent: &str, own: &str| {
        joint("", AXIS).replace(">world<", &format!(">{parent}<")).replace(">b<", &format!(">{own}<"))
    };
    let first = link("0 0 1 0 0 0", "INERTIAL") + &frame("f", "attached_to='b'", "0 0.2 0 0.4 0 0");
    let behind = frame("g", "attached_to='h'", "0 0 0 0 0 0") + &frame("h", "attached_to='f'", "0 0.3 0 0 0 0");
    let last = second("<pose relative_to='g'>0 0 0.5 0 0 0</pose>", "INERTIAL").replace("<parent>b<", "<parent>g<");
    let frames = model("", &(first.clone() + &joint("world", "f") + &behind + &last));
    moves(
        "m.sdf",
        &frames,
        &[1.2499983154507381, -0.06122602957361642, -0.06122602957361642, 0.2917103174940463],
        &[-8.764878099439288, 3.473043270914456],
    );
    // Attached to nothing, it is on the first link.
    let free = frames.replace("attached_to='f'", "").replace("0 0.3 0 0 0 0", "0 0.5 1 0.4 0 0");
    assert!(text("m.sdf", &free).contains("from `b` to `c`"));
    let circle = frames.replace("name='h' attached_to='f'", "name='h' attached_to='g'");
    let not = "`c` is placed relative to what is not there, or to itself";
    refused("m.sdf", &circle, not);
    let apart = frames.replace("<parent>g<", "<parent>x<");
    refused("m.sdf", &apart, "the parent of the joint `k` is `x`, which is no link or frame of the model");
    let twice = model("", &(first.clone() + &joint("b", "f")));
    refused("m.sdf", &twice, "the joints lead in a circle: the link `b` hangs on itself, or on a link that does");
}

/// Names that the file does not give are not those that it gives.
#[test]
fn automatic_names_give_way() {
    let axes = "<axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 0</xyz></axis2>";
    let mimic = "<mimic joint='cross' axis='axis2'><multiplier>3</multiplier></mimic>";
    let links = format!(
        "<link name='b'/><link name='c'/><link name='d'/><link name='e'/>\
         <joint name='cross' type='universal'><parent>world</parent><child>b</child>{axes}</joint>\
         <joint name='cross_2' type='revolute'><parent>b</parent><child>c</child><axis>{AXIS}</axis></joint>\
         <joint name='e_free' type='revolute'><parent>c</parent><child>d</child><axis>{AXIS}{mimic}</axis></joint>"
    );
    let text = text("m.sdf", &model("", &links));
    for line in [
        "    coord cross_1: rad;\n",
        "    coord cross_2_2: rad;\n",
        "    coord cross_2: rad;\n",
        "    coord e_free_2_place[3]: m;\n",
        "    let e_free = e_free_ratio*cross_2_2 + e_free_offset;\n",
    ] {
        assert!(text.contains(line), "{line}{text}");
    }
}
