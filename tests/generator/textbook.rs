//! The page of a textbook for every mechanism of the repository and of the manual, as snapshots: read them as an author
//! would.

use mbs_derive::Analysis;
use mbs_derive::expr::Graph;
use mbs_derive::source::Sources;

const MANUAL: &str = include_str!("../../docs/language.md");

/// Mechanisms of the manual with what those of the repository lack: prescribed motions, magnetic terms, constraints.
const OF_THE_MANUAL: [&str; 7] =
    ["ShakenPendulum", "ChargedParticle", "PlanarQuadrotor", "FourBar", "ChaplyginSleigh", "Top", "FreeBody"];

/// Branches, powers, a nonholonomic and a holonomic constraint, one of them moving.
const CONTRIVED: &str = "\
mechanism Contrived {
    param m: kg = 1;
    param k: N/m = 5;
    param r: m = 1;
    param omega: rad/s = 2;
    param c: N = 1;
    coord x: m;
    coord y: m;
    coord theta: rad;
    prescribed lift: m;
    input f: N;
    kinetic += 1/2*m*(dt(x)^2 + dt(y)^2) + 1/10*m*r^2*dt(theta)^2;
    potential += if x < r && -r <= x { 1/2*k*(x - r)^2 } else { 0 };
    force x += f - c*signum(dt(x));
    constraint rolling: dt(x) - r*dt(theta) = 0;
    constraint ground: y = lift + r*sin(omega*t);
}
";

#[test]
fn pages() {
    let of_the_repository = mbs_models::SOURCES.iter().map(|(module, source)| (module.to_string(), source.to_string()));
    let of_the_manual = OF_THE_MANUAL.iter().map(|name| (format!("manual.{name}"), block_of_the_manual(name)));
    let contrived = [("contrived".to_string(), CONTRIVED.to_string())];
    let mut preamble: Option<String> = None;
    for (name, source) in of_the_repository.chain(of_the_manual).chain(contrived) {
        let page = page(&name, &source);
        assert_balanced(&name, &page);
        // All begin alike; one is kept as it is.
        let (own, body) = page.split_once("\\section*").expect("every page has its title");
        assert_eq!(own, *preamble.get_or_insert_with(|| own.to_string()), "{name}");
        let page = if name == "pendulum" { page } else { format!("\\section*{body}") };
        snapshot(&name, &if page.len() > LONGEST { outline(&page) } else { page });
    }
}

/// Six coordinates: with abbreviations, outputs and defaults, and nothing left out.
#[test]
fn a_large_mechanism_is_written_out() {
    let page = page("quadrotor", include_str!("../../models/mechanisms/quadrotor_euler.mbs"));
    for expected in [
        r"$m$ & parameter & $\mathrm{kg}$ & $40$ & Mass. \\",
        r"c_{\theta} = \cos\theta",
        r"\mathbf{R}_{\mathrm{pose}} &= \begin{bmatrix}",
        r"-s_{\theta} & s_{\phi} c_{\theta} & c_{\phi} c_{\theta}",
        r"\mathbf{J}_{\mathrm{pose}} &= \begin{bmatrix}",
        r"M_{46} &= -\mathrm{inertias}_1 \, s_{\theta}",
        r"C_{55} &= -(\mathrm{inertias}_2 - \mathrm{inertias}_3) \dot{\phi} c_{\phi} s_{\phi}",
    ] {
        assert!(page.contains(expected), "{expected} is not in\n{page}");
    }
    assert!(!page.contains("Too long") && !page.contains("see below"), "{page}");
}

/// Longer pages are kept by their outline; `mbs-derive/src/latex/proof.rs` reads all of the largest again.
const LONGEST: usize = 4_500;

/// A page whose displayed formulas are told by their number of lines and a digest, but for short ones.
fn outline(page: &str) -> String {
    let mut parts = page.split("\\begin{align*}\n");
    let mut outline = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let (formulas, rest) = part.split_once("\n\\end{align*}").expect("every block ends");
        let lines = formulas.lines().count();
        match lines {
            0..=5 => outline.push_str(&format!("\\begin{{align*}}\n{formulas}\n\\end{{align*}}{rest}")),
            _ => outline.push_str(&format!("%% {lines} lines, {:016x}{rest}", digest(formulas))),
        }
    }
    outline
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits.
fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn page(name: &str, source: &str) -> String {
    let graph = Graph::verbatim();
    let sources = Sources::new(name, source);
    Analysis::of(&sources, &graph).unwrap_or_else(|e| panic!("{}", e.render_in(&sources))).latex()
}

fn block_of_the_manual(name: &str) -> String {
    let mut blocks = MANUAL.split("```mbs\n").skip(1).filter_map(|rest| rest.split("```\n").next());
    blocks.find(|block| block.contains(&format!("mechanism {name} {{"))).expect("a mechanism of the manual").to_string()
}

/// Environments close in the reverse order in which they open, braces in every line.
fn assert_balanced(name: &str, page: &str) {
    let mut open = Vec::new();
    for line in page.lines() {
        let text = line.split('%').next().unwrap_or_default();
        for (place, _) in text.match_indices('\\') {
            let environment = |command: &str| text[place..].strip_prefix(command)?.strip_prefix('{')?.split('}').next();
            open.extend(environment("\\begin"));
            if let Some(closed) = environment("\\end") {
                assert_eq!(open.pop(), Some(closed), "{name}: {line}");
            }
        }
        let depth = |c: char| text.matches(c).count();
        let group = text.trim() == "{\\allowdisplaybreaks" || text.trim() == "\\end{align*}}";
        assert!(group || depth('{') == depth('}'), "{name}: {line}");
        for (left, right) in [("\\left", "\\right"), ("(", ")"), ("[", "]")] {
            assert_eq!(text.matches(left).count(), text.matches(right).count(), "{name}: {line}");
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots/latex");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}
