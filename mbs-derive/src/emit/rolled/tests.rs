use super::super::{Language, Options, Trigonometry};
use crate::Analysis;
use crate::expr::Graph;
use crate::source::Sources;

/// A chain of links about skew axes.
fn chain(links: usize) -> String {
    format!(
        "mechanism Chain {{
            coord q[{links}]: rad;
            input u[{links}]: N*m;
            let moments = inertia(9 kg*m^2, 8 kg*m^2, 7 kg*m^2, 1 kg*m^2, 2 kg*m^2, 3 kg*m^2);
            let mut link = world;
            for i in 0..{links} {{
                link = link * translation([1 m, 2 m, 3 m]) * rotation([0.4, -0.3, 0.7], 0.8)
                    * rotation([0.36, -0.48, 0.8], q[i]);
                kinetic += rigid_body(2 kg, [1 m, 2 m, 3 m], moments, link);
                potential += 2 kg * 10 m/s^2 * link.point([1 m, 2 m, 3 m]).z;
            }}
            force q += u;
        }}"
    )
}

/// A chain whose links have masses, lengths and springs of their own, which are parameters.
fn rope(links: usize) -> String {
    format!(
        "mechanism Rope {{
            param m[{links}]: kg = 1.4;
            param l[{links}]: m = 0.25;
            param k[{links}]: N*m/rad = 3;
            coord q[{links}]: rad;
            let mut link = world;
            for i in 0..{links} {{
                link = link * translation([l[i], 0, 0.05 m]) * rotation([0.4, -0.3, 0.7], 0.8)
                    * rotation([0.36, -0.48, 0.8], q[i]);
                kinetic += rigid_body(m[i], [0.1 m, 0, 0], diag(3 m^2, 2 m^2, 4 m^2)*m[i], link);
                potential += m[i]*9.81 m/s^2*link.point([0.1 m, 0, 0]).z + k[i]*q[i]^2/2;
            }}
        }}"
    )
}

/// Links on universal joints: what turns about a line is a link of no mass, and the angles about the second lines stand
/// behind all those about the first.
fn cable(links: usize) -> String {
    format!(
        "mechanism Cable {{
            coord a[{links}]: rad;
            coord b[{links}]: rad;
            let mut link = world;
            for i in 0..{links} {{
                link = link * rot_x(a[i]) * rot_y(b[i]);
                kinetic += rigid_body(2 kg, [0, 0, -0.15 m], diag(0.02 kg*m^2, 0.02 kg*m^2, 0.003 kg*m^2), link);
                potential += 2 kg * 9.81 m/s^2 * link.point([0, 0, -0.15 m]).z + 3 N*m*(a[i]^2 + b[i]^2)/2;
                link = link * translation([0, 0, -0.3 m]);
            }}
        }}"
    )
}

/// Telescopes in a row: joints of two kinds, coordinates in turn.
fn telescopes(links: usize) -> String {
    format!(
        "mechanism Telescopes {{
            coord q[{links}]: rad;
            coord s[{links}]: m;
            let mut link = world;
            for i in 0..{links} {{
                link = link * rotation([0.6, 0, 0.8], q[i]) * translation([0.1 m, 0, 0.3 m]);
                kinetic += rigid_body(1 kg, [0.1 m, 0, 0], diag(0.02 kg*m^2, 0.03 kg*m^2, 0.04 kg*m^2), link);
                link = link * translation([0, s[i], 0]) * rot_x(0.3);
                kinetic += rigid_body(2 kg, [0, 0.1 m, 0], diag(0.02 kg*m^2, 0.01 kg*m^2, 0.02 kg*m^2), link);
                potential += 100 N/m*s[i]^2/2;
            }}
        }}"
    )
}

/// A sledge that carries two chains, of links that grow heavier and of such that do not.
const FORK: &str = "mechanism Chain {
    coord s: m;
    coord a[20]: rad;
    coord b[20]: rad;
    param k: N*m/rad = 2;
    let sledge = translation([s, 0, 0]);
    kinetic += rigid_body(3 kg, [0, 0, 0], diag(1 kg*m^2, 1 kg*m^2, 1 kg*m^2), sledge);
    let mut p = sledge;
    let mut r = sledge * rot_z(90 deg);
    for i in 0..20 {
        p = p * rotation([0.6, 0, 0.8], a[i]) * translation([0.3 m, 0, 0.1 m]);
        r = r * rot_x(b[i]) * translation([0, 0.2 m, 0]) * rot_z(0.3);
        kinetic += rigid_body(1 kg + 0.01 kg*i, [0.1 m, 0, 0], diag(0.02 kg*m^2, 0.03 kg*m^2, 0.04 kg*m^2), p);
        kinetic += rigid_body(0.5 kg, [0, 0.1 m, 0], diag(0.02 kg*m^2, 0.01 kg*m^2, 0.02 kg*m^2), r);
        potential += 1/2*k*a[i]^2;
    }
}";

/// The text of inverse and forward dynamics, and whether it is right with this in the place of that, wherever it stands
/// in the loops.
fn emitted(links: usize, mutations: &[(&str, &str)]) -> (String, Vec<bool>) {
    emitted_of(&chain(links), Language::Rust, mutations)
}

fn emitted_of(text: &str, language: Language, mutations: &[(&str, &str)]) -> (String, Vec<bool>) {
    let graph = Graph::verbatim();
    let options = Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
    let analysis = Analysis::with_options(&Sources::new("chain.mbs", text), &graph, &options).unwrap();
    let programs = analysis.programs();
    let code = language.write(programs, "chain.mbs", &options);
    programs.proofread(language, &options, &code).unwrap();
    let begin = match language {
        Language::Rust => "for i in (",
        Language::Js => "for (let i = ",
        Language::Python => "for i in ",
        Language::Matlab => "for k = ",
        _ => "for (int i = ",
    };
    let is_right = |(from, to): &(&str, &str)| {
        let (before, behind) = code.split_once(begin).expect("a loop");
        assert!(behind.contains(from), "{from}");
        let wrong = format!("{before}{begin}{}", behind.replacen(from, to, 1));
        programs.proofread(language, &options, &wrong).is_ok()
    };
    let right = mutations.iter().map(is_right).collect();
    (code, right)
}

/// The text of a mechanism in each of these languages, read again.
fn written(text: &str, languages: &[Language]) -> Vec<String> {
    let options = Options::default().functions(["generalized_force", "inverse_dynamics", "forward_dynamics"]);
    let graph = Graph::verbatim();
    let analysis = Analysis::with_options(&Sources::new("chain.mbs", text), &graph, &options).unwrap();
    let programs = analysis.programs();
    let text = |&language: &Language| {
        let code = language.write(programs, "chain.mbs", &options);
        programs.proofread(language, &options, &code).unwrap_or_else(|fault| panic!("{}: {fault}", language.name()));
        code
    };
    languages.iter().map(text).collect()
}

#[test]
fn links_that_repeat_are_written_once() {
    let [(shorter, _), (longer, _)] = [40, 60].map(|links| emitted(links, &[]));
    let [lines, more] = [&shorter, &longer].map(|code| code.lines().filter(|line| line.contains(" = ")).count());
    assert!(shorter.contains("for i in ") && lines.abs_diff(more) * 20 < lines, "{lines} {more}");
    // Tables, names and lengths alone grow.
    let [length, further] = [&shorter, &longer].map(String::len);
    assert!(further < length + 30_000, "{length} {further}");
}

#[test]
fn few_links_are_written_one_by_one() {
    let (code, _) = emitted(12, &[]);
    assert!(!code.contains("for i in ") && code.contains("w12"));
}

#[test]
fn loops_are_read_again_turn_by_turn() {
    let mutations =
        [(".rev()", ""), ("[i]", "[i - 1]"), ("[i - 1]", "[i]"), (" = sines", " = cosines"), ("q[i", "qd[i")];
    let (_, right) = emitted(40, &mutations);
    assert_eq!(right, [false; 5]);
}

#[test]
fn loops_of_c_are_read_again_turn_by_turn() {
    let mutations = [
        ("; i < ", "; i <= "),
        ("; i -= 1", "; i -= 2"),
        ("[i]", "[i - 1]"),
        ("[i - 1]", "[i]"),
        (" = sines", " = cosines"),
        ("q[i", "qd[i"),
        ("result[mbs_i] = results[mbs_i]", "result[mbs_i] = results[0]"),
        ("mbs_i < 40", "mbs_i < 39"),
        ("mbs_i = 0", "mbs_i = 1"),
    ];
    let (code, right) = emitted_of(&chain(40), Language::C, &mutations);
    assert_eq!(right, [false; 9]);
    let (longer, _) = emitted_of(&chain(60), Language::C, &[]);
    // Numbers alone grow.
    let [lines, more] = [&code, &longer].map(|code| code.lines().filter(|line| line.contains(" = ")).count());
    assert!(lines.abs_diff(more) * 20 < lines, "{lines} {more}");
}

#[test]
fn loops_of_scripts_are_read_again_turn_by_turn() {
    let of_js = [
        ("; i < ", "; i <= "),
        ("; i -= 1", "; i -= 2"),
        ("[i]", "[i - 1]"),
        ("[i - 1]", "[i]"),
        (" = sines", " = cosines"),
        ("q[i", "qd[i"),
        ("const ", "let "),
        ("results[1]", "results[2]"),
    ];
    let of_python = [
        ("reversed(", "("),
        (", 39)", ", 38)"),
        ("[i]", "[i - 1]"),
        ("[i - 1]", "[i]"),
        (" = sines", " = cosines"),
        ("q[..., i", "qd[..., i"),
        ("q[..., i", "q[i"),
        ("            ", "        "),
        ("results[1]", "results[2]"),
    ];
    let of_matlab = [
        (":-1:", ":-2:"),
        (":38", ":37"),
        ("(k + 1)", "(k)"),
        ("(k)", "(k + 1)"),
        (" = sines", " = cosines"),
        ("q(k", "qd(k"),
        ("\nend\n", "\n"),
        ("results(2)", "results(3)"),
    ];
    for (language, mutations) in
        [(Language::Js, &of_js[..]), (Language::Python, &of_python), (Language::Matlab, &of_matlab)]
    {
        let (code, right) = emitted_of(&chain(40), language, mutations);
        assert_eq!(right, vec![false; mutations.len()], "{}", language.name());
        let (longer, _) = emitted_of(&chain(60), language, &[]);
        let [lines, more] = [&code, &longer].map(|code| code.lines().filter(|line| line.contains(" = ")).count());
        // Numbers alone grow; MATLAB has a line for each result.
        let grown = if language == Language::Matlab { 2 * 20 } else { 0 };
        assert!((more - lines - grown) * 20 < lines, "{}: {lines} {more}", language.name());
    }
}

/// Sines of the library are computed one by one.
#[test]
fn sines_of_the_library_are_in_no_loop() {
    let options = Options::default().functions(["inverse_dynamics"]).trigonometry(Trigonometry::Library);
    let graph = Graph::verbatim();
    let analysis = Analysis::with_options(&Sources::new("chain.mbs", &chain(40)), &graph, &options).unwrap();
    for language in Language::ALL {
        let code = language.write(analysis.programs(), "chain.mbs", &options);
        analysis.programs().proofread(language, &options, &code).unwrap();
        assert!(!code.contains("sin_cos_all(angles"), "{}", language.name());
    }
}

#[test]
fn parameters_of_each_link_come_from_lists() {
    let mutations = [("values[i", "values[1 + i"), ("[i - 1]", "[i]"), ("let values", "let values_x")];
    let (code, right) = emitted_of(&rope(40), Language::Rust, &mutations);
    assert_eq!(right, [false; 3]);
    let (longer, _) = emitted_of(&rope(60), Language::Rust, &[]);
    // Parameters grow, what is made of them, and their checks: not the functions.
    let functions = |code: &str| {
        let (_, functions) = code.split_once("pub fn inverse_dynamics").expect("a function");
        functions.matches(" = ").count()
    };
    let [few, more] = [functions(&code), functions(&longer)];
    assert!(few.abs_diff(more) * 20 < few, "{few} {more}");
    let mutations = [
        ("const mbs_real values[", "static const mbs_real values["),
        ("static const mbs_real NUMBERS", "const mbs_real NUMBER_S"),
        ("values[i", "values[1 + i"),
        ("mbs_sin_cos_all(40", "mbs_sin_cos_all(39"),
        ("[i]", "[(i)]"),
        ("i += 1", "i += 01"),
        ("result[mbs_i]", "result[mbs_i + 1]"),
    ];
    let (in_c, right) = emitted_of(&rope(40), Language::C, &mutations);
    assert!(in_c.contains("const mbs_real values[") && in_c.len() < code.len());
    assert_eq!(right, [false; 7]);
    let scripts = [Language::Js, Language::Python, Language::Matlab];
    for (script, list) in written(&rope(40), &scripts).iter().zip(["const values = [", "listed = [", "values = [ ..."])
    {
        assert!(script.contains(list) && script.len() < code.len());
    }
}

/// A turn of a loop may be several links, whose statements are other ones.
#[test]
fn joints_of_several_kinds_are_one_loop() {
    let statements = |code: &str| code.lines().filter(|line| line.contains(" = ")).count();
    for (chain, index, wrong) in
        [(cable as fn(usize) -> String, "[2 * i", "[3 * i"), (telescopes, "[i + 26]", "[i + 25]")]
    {
        let mutations = [("[i]", "[i - 1]"), ("[i - 1]", "[i]"), (index, wrong)];
        let (shorter, right) = emitted_of(&chain(26), Language::Rust, &mutations);
        assert_eq!(right, [false; 3]);
        let (longer, _) = emitted_of(&chain(34), Language::Rust, &[]);
        let [few, more] = [statements(&shorter), statements(&longer)];
        assert!(few.abs_diff(more) * 20 < few, "{few} {more}");
        for language in [Language::C, Language::Js, Language::Python] {
            let mutations = &mutations[..if language == Language::Python { 2 } else { 3 }];
            let (_, right) = emitted_of(&chain(26), language, mutations);
            assert_eq!(right, vec![false; mutations.len()]);
        }
    }
}

/// What moves with one joint alone, a rotor, leaves a chain what it is; what couples two rates does not: then
/// accelerations need M.
#[test]
fn rotors_are_part_of_a_chain() {
    let text =
        |rate: &str| rope(40).replace("potential +=", &format!("kinetic += (1 kg*m^2)*({rate})^2/2; potential +="));
    let [(driven, _), (coupled, _)] =
        ["dt(q[i])", "dt(q[i]) + dt(q[0])"].map(|rate| emitted_of(&text(rate), Language::Rust, &[]));
    assert!(!driven.contains("ldlt_solve") && driven.contains(".rev()"));
    assert!(coupled.contains("ldlt_solve"));
}

/// The first force is one along the first joint, and written as those that all other links hand on: it is a result, and
/// no turn of the loop before it.
#[test]
fn results_are_no_turns_of_the_links() {
    let text = "mechanism Train {
        const n = 40;
        coord q[n]: m;
        coord s: m;
        input u[n + 1]: N;
        kinetic += (1 kg)*dt(s)^2/2;
        let mut link = world;
        for i in 0..n {
            let d = if i == 0 { q[0] + s } else { q[i] };
            link = link * translation([d, 0, 0]);
            kinetic += particle(2 kg, link.point([0, 0, 0]));
            force at link.point([0, 0, 0]) += [u[i + 1], 0, 0];
        }
        force q[0] += u[0];
    }";
    written(text, &Language::ALL);
}

#[test]
fn kernels_are_written_without_loops() {
    let (code, _) = emitted_of(&chain(40), Language::Cuda, &[]);
    assert!(!code.contains("for (int i = 1;"));
}

#[test]
fn trees_of_several_chains_are_right_whatever_is_rolled_of_them() {
    assert!(written(FORK, &Language::ALL).iter().all(|code| code.contains("forward_dynamics")));
}
