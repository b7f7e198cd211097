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
    for (name, source) in of_the_repository.chain(of_the_manual).chain(contrived) {
        let page = page(&name, &source);
        assert_balanced(&name, &page);
        snapshot(&name, &page);
    }
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
