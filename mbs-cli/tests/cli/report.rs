//! `mbs report`, and the animations of `mbs simulate --gltf`. Their numbers are compared in `tests/report/`.

use serde_json::Value;

use crate::Workshop;

/// A slider on a rail, with a rod closed by a constraint, shapes and a doc comment that would end a script.
const DRAWN: &str = "\
/// A slider </script><img src=//example.org/x> `x<y` <!-- and
///
/// a second paragraph.
mechanism Drawn {
    param m: kg = 1;
    param l: m = 0.5;
    /// Not </script> either.
    param g: m/s^2 = 9.81;
    coord x: m;
    coord theta: rad;
    input push: N;
    let slider = translation([x, 0, 0]);
    let rod = slider * rot_y(-theta);
    kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, slider) + particle(m, rod.point([0, 0, -l]));
    potential += m*g*rod.point([0, 0, -l]).z;
    force x += push;
    constraint height: rod.point([0, 0, -l]).z = -l/2;
    shape slider += box([l, l/2, l/3]);
    shape rod += mesh(\"ball.stl\", 1e-3);
    output tip = rod.point([0, 0, -l]);
}
";

const BALL: &str = "solid ball\nfacet\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 10 0\nendfacet\nendsolid ball\n";

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("drawn.mbs", DRAWN);
    workshop.write("ball.stl", BALL);
    workshop
}

fn about(html: &str) -> Value {
    let (_, rest) = html.split_once("<script type=\"application/json\" id=\"about\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Every element is closed, in order.
fn check_elements(html: &str) {
    const VOID: [&str; 5] = ["meta", "link", "input", "br", "hr"];
    let mut open: Vec<&str> = Vec::new();
    let mut rest = html;
    while let Some((_, from)) = rest.split_once('<') {
        let (tag, behind) = from.split_once('>').expect("a tag ends");
        rest = behind;
        if tag.starts_with('!') {
            continue;
        }
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
        assert!(name.chars().all(|c| c.is_ascii_alphanumeric()) && !name.is_empty(), "<{tag}>");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "</{name}> behind {open:?}");
        } else if !VOID.contains(&name) {
            open.push(name);
        }
        if matches!(name, "script" | "style") && !tag.starts_with('/') {
            let (_, behind) = rest.split_once(&format!("</{name}>")).expect("it ends");
            assert_eq!(open.pop(), Some(name));
            rest = behind;
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// What `src` and `href` name, and whether anything else would be fetched.
fn check_hosts(html: &str) {
    for attribute in ["src", "href", "srcset", "poster", "action"] {
        for (at, _) in html.match_indices(&format!(" {attribute}=\"")) {
            let value = html[at..].split('"').nth(1).unwrap();
            assert!(value.starts_with('#') || value == "data:,", "{attribute}=\"{value}\"");
        }
    }
    for word in ["http:", "https:", "@import", "url(", "fetch(", "XMLHttpRequest", "import("] {
        assert!(!html.contains(word), "{word}");
    }
}

#[test]
fn a_page_asks_for_nothing_and_is_whole() {
    let workshop = workshop();
    for model in ["pendulum.mbs", "chain.mbs", "drawn.mbs"] {
        workshop.good(&["report", model, "--out", "report.html"]);
        let html = workshop.read("report.html");
        check_elements(&html);
        check_hosts(&html);
        assert_eq!(html.matches("<script").count(), 2, "{model}");
        assert_eq!(html.matches("</script>").count(), 2, "{model}");
        for section in ["motion", "declaration", "equations", "constraints", "conserved", "cost", "accuracy", "proof"] {
            assert!(html.contains(&format!("<section id=\"{section}\">")), "{section}");
        }
        assert!(html.matches("<math>").count() > 10 && html.contains("<mfrac>"), "{model}");
        // Formulas that could not be read would stand as they were written.
        assert!(!html.contains("\\frac") && !html.contains("\\mathbf"), "{model}");
        assert!(html.len() < 400_000, "{} bytes", html.len());
    }
    assert_eq!(workshop.files(), ["ball.stl", "chain.mbs", "drawn.mbs", "pendulum.mbs", "report.html"]);
}

/// Without a state: away from where a spring is relaxed; with a speed where nothing pulls; at rest where all is held.
#[test]
fn a_page_begins_with_a_motion() {
    let workshop = Workshop::new();
    let start = |rest: &str| {
        let text = format!("mechanism A {{ param m: kg = 1; coord x: m; kinetic += 1/2*m*dt(x)^2; {rest} }}");
        workshop.write("a.mbs", text);
        let found = about(&workshop.good(&["report", "a.mbs"]));
        [found["start"]["q"][0].as_f64().unwrap(), found["start"]["qd"][0].as_f64().unwrap()]
    };
    assert_eq!(start("param k: N/m = 3; potential += 1/2*k*x^2;"), [0.3, 0.0]);
    assert_eq!(start(""), [0.0, 1.0]);
    assert_eq!(start("constraint held: x = 2 m;"), [2.0, 0.0]);
}

#[test]
fn two_runs_give_the_same_bytes() {
    let workshop = workshop();
    let first = workshop.good(&["report", "drawn.mbs"]);
    assert_eq!(workshop.good(&["report", "drawn.mbs", "--out", "report.html"]), "");
    assert_eq!(workshop.read("report.html"), first);
}

#[test]
fn a_page_says_what_the_mechanism_is() {
    let workshop = workshop();
    let html = workshop.good(&["report", "drawn.mbs"]);
    assert!(
        html.contains("<p>A slider &lt;/script&gt;&lt;img src=//example.org/x&gt; <code>x&lt;y</code> &lt;!-- and</p>")
    );
    assert!(html.contains("<p>a second paragraph.</p>"));
    assert!(html.contains("<td><code>m</code></td><td>kg</td><td>1</td>"));
    assert!(html.contains("<span class=\"energy\">    potential += m*g*rod.point([0, 0, -l]).z;</span>"));
    assert!(html.contains("2 coordinates, 1 constraint row: 1 degree of freedom."));
    assert!(html.contains("<td><code>height</code></td><td>holonomic, φ(q, t) = 0</td><td>m</td>"));
    assert!(html.contains("functions agree with the energies"));
    let pendulum = workshop.good(&["report", "pendulum.mbs"]);
    assert!(pendulum.contains("There are no constraints: 1 degree of freedom"));
    assert!(pendulum.contains("<td><code>energy_integral</code></td>"));
    let header = pendulum.split("<section id=\"cost\">").nth(1).unwrap();
    assert!(header.contains("flops, plain") && header.contains("flops, textbook"));
    // Rounding of a product of four numbers, and no more.
    let rounding = pendulum.split("<section id=\"accuracy\">").nth(1).unwrap();
    let gravity = rounding.split("<code>gravity</code>").nth(1).unwrap();
    assert!(
        gravity[..80].contains("10<sup>−16</sup>") || gravity[..80].contains("10<sup>−15</sup>"),
        "{}",
        &gravity[..80]
    );
}

#[test]
fn the_scripts_are_told_what_there_is() {
    let workshop = workshop();
    let html = workshop.good(&[
        "report",
        "drawn.mbs",
        "--state",
        r#"{"q": [0.25, 1.0471975511965976], "u": [2]}"#,
        "--t-end",
        "3",
    ]);
    let about = about(&html);
    assert_eq!(about["end"], 3.0);
    assert_eq!(about["start"]["q"], serde_json::json!([0.25, 1.0471975511965976]));
    assert_eq!(about["start"]["u"], serde_json::json!([2.0]));
    assert_eq!(about["coordinates"][1]["names"], serde_json::json!(["theta"]));
    assert_eq!(about["constraints"], serde_json::json!(["height"]));
    assert_eq!(about["functions"]["forward_dynamics"]["arguments"], serde_json::json!(["q", "qd", "u"]));
    assert_eq!(about["outputs"][0]["components"], serde_json::json!(["tip_0", "tip_1", "tip_2"]));
    let scene = &about["scene"];
    assert_eq!(scene["bodies"][0]["shaped"], true);
    assert_eq!(scene["shapes"][0]["kind"], "box");
    assert_eq!(
        scene["shapes"][1]["triangles"],
        serde_json::json!([[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]]])
    );
    assert!(scene["places"].as_array().unwrap().iter().any(|name| name == "tip"));
}

#[test]
fn a_mesh_that_is_not_there_is_named_and_left_out() {
    let workshop = workshop();
    for (content, reason) in [(None, "No such file"), (Some("solid"), "it is no STL file")] {
        std::fs::remove_file(workshop.path("ball.stl")).unwrap();
        if let Some(content) = content {
            workshop.write("ball.stl", content);
        }
        let outcome = workshop.mbs(&["report", "drawn.mbs"]);
        assert_eq!(outcome.code, 0);
        assert!(outcome.stderr.contains(": the mesh ball.stl is not drawn: "), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(reason) && outcome.stderr.contains("drawn.mbs:19"), "{}", outcome.stderr);
        let scene = &about(&outcome.stdout)["scene"];
        assert_eq!(
            (&scene["shapes"][1]["triangles"], &scene["bodies"][1]["shaped"]),
            (&Value::Null, &Value::from(false))
        );
        workshop.write("ball.stl", "");
    }
}

#[test]
fn bad_input_writes_no_page() {
    let workshop = workshop();
    let bad = |more: &[&str]| workshop.bad(&[&["report", "pendulum.mbs", "--out", "report.html"], more].concat());
    assert!(bad(&["--state", r#"{"q": [1, 2]}"#]).contains("q"));
    assert!(bad(&["--state", r#"[{"q": [1]}, {"q": [2]}]"#]).contains("a motion starts from one state"));
    assert!(bad(&["--state", "missing.json"]).contains("missing.json"));
    let over = workshop.bad(&["report", "pendulum.mbs", "--out", "./pendulum.mbs"]);
    assert!(over.contains("would overwrite a file in use"), "{over}");
    assert!(workshop.bad(&["report", "pendulum.mbs", "--out", "no/where.html"]).contains("make the folder first"));
    for t_end in ["0", "-1", "NaN", "soon"] {
        assert_eq!(workshop.mbs(&["report", "pendulum.mbs", "--t-end", t_end]).code, 2, "{t_end}");
    }
    assert_eq!(workshop.files(), ["ball.stl", "chain.mbs", "drawn.mbs", "pendulum.mbs"]);
}

#[test]
fn a_motion_without_a_way_on_is_no_error() {
    let workshop = workshop();
    workshop.write(
        "singular.mbs",
        "mechanism A { param m: kg = 1; const k: J*m = 1; coord r: m; kinetic += m*dt(r)^2/2; potential += -k/r; }",
    );
    // It falls into the centre.
    let html = workshop.good(&["report", "singular.mbs", "--state", r#"{"q": [1]}"#]);
    assert!(html.contains("which ends early"), "no way on is said");
    check_elements(&html);
}

/// The two chunks of a binary glTF.
fn chunks(file: &[u8]) -> (Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (b"glTF".as_slice(), 2, file.len()));
    let length = number(12);
    assert_eq!((&file[16..20], length % 4), (b"JSON".as_slice(), 0));
    let rest = &file[20 + length..];
    assert_eq!(&rest[4..8], b"BIN\0");
    (serde_json::from_slice(&file[20..20 + length]).unwrap(), &rest[8..])
}

#[test]
fn animations_have_bodies_shapes_and_lines() {
    let workshop = workshop();
    let state = r#"{"q": [0, 1.0471975511965976], "qd": [1, 0]}"#;
    let arguments = [
        "simulate",
        "drawn.mbs",
        "--state",
        state,
        "--t-end",
        "0.5",
        "--dt",
        "0.1",
        "--csv",
        "a.csv",
        "--gltf",
        "a.glb",
    ];
    workshop.good(&arguments);
    let file = std::fs::read(workshop.path("a.glb")).unwrap();
    let (json, binary) = chunks(&file);
    assert!(binary.len() >= json["buffers"][0]["byteLength"].as_u64().unwrap() as usize);
    let names: Vec<&str> = json["nodes"].as_array().unwrap().iter().filter_map(|node| node["name"].as_str()).collect();
    // Bodies are shown by what is fixed to them.
    for name in ["shape 1", "shape 2", "line 1", "Drawn"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(!names.iter().any(|name| name.starts_with("body")), "{names:?}");
    let channels = json["animations"][0]["channels"].as_array().unwrap();
    assert!(channels.iter().any(|channel| channel["target"]["path"] == "translation"));
    let input = json["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
    assert_eq!(json["accessors"][input]["count"], 6);
    assert_eq!(json["accessors"][input]["max"], serde_json::json!([0.5]));
    // Again, the same bytes.
    workshop.good(&arguments);
    assert_eq!(std::fs::read(workshop.path("a.glb")).unwrap(), file);
    // What stands still has no animation, and is a file all the same.
    workshop.good(&[
        "simulate",
        "drawn.mbs",
        "--state",
        state,
        "--t-end",
        "0",
        "--csv",
        "a.csv",
        "--gltf",
        "still.glb",
    ]);
    assert_eq!(chunks(&std::fs::read(workshop.path("still.glb")).unwrap()).0["animations"], Value::Null);
    // Nothing to see is a file, too.
    let chain = [
        "simulate",
        "chain.mbs",
        "--state",
        r#"{"q": [0, 1]}"#,
        "--t-end",
        "1",
        "--csv",
        "a.csv",
        "--gltf",
        "chain.glb",
    ];
    workshop.good(&chain);
    chunks(&std::fs::read(workshop.path("chain.glb")).unwrap());
}

#[test]
fn long_motions_are_shown_in_ten_seconds() {
    let workshop = workshop();
    let arguments = [
        "simulate",
        "pendulum.mbs",
        "--state",
        r#"{"q": [1]}"#,
        "--t-end",
        "1000",
        "--csv",
        "a.csv",
        "--gltf",
        "a.glb",
    ];
    let outcome = workshop.mbs(&arguments);
    assert_eq!(
        (outcome.code, outcome.stderr.as_str()),
        (0, "warning: the animation takes 10 s, the motion 100.000 times as long\n")
    );
}

#[test]
fn an_animation_is_no_other_file() {
    let workshop = workshop();
    let over = ["simulate", "pendulum.mbs", "--state", r#"{"q": [1]}"#, "--t-end", "1", "--csv", "a", "--gltf", "a"];
    assert!(workshop.bad(&over).contains("is the same file"));
    let state = r#"{"q": [0, 1.0471975511965976]}"#;
    for (option, over) in [
        ("--gltf", &["simulate", "drawn.mbs", "--state", state, "--t-end", "0", "--gltf", "ball.stl"][..]),
        ("--csv", &["simulate", "drawn.mbs", "--state", state, "--t-end", "0", "--gltf", "a", "--csv", "ball.stl"]),
        ("--out", &["report", "drawn.mbs", "--out", "ball.stl"]),
    ] {
        let expected = format!("error: {option} ball.stl would overwrite a file in use: the mesh ball.stl was read\n");
        assert_eq!(workshop.bad(over), expected);
        assert_eq!(workshop.read("ball.stl"), BALL);
    }
}
