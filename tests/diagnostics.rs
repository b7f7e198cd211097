//! Every wrong declaration in `bad/` and the report it earns, as snapshots (`bad/shared/` is what some of them import); and
//! inputs too large to be kept as files.

use std::path::Path;

use mbs_derive::{cargo, emit, generate, generate_from};

fn report(name: &str, source: &str) -> String {
    match generate(name, source, &emit::Options::default()) {
        Ok(_) => panic!("{name} is accepted"),
        Err(error) => error.render(name, source),
    }
}

/// What a build script would say of a file; cargo runs tests in the folder of their crate.
fn report_of_file(name: &str) -> String {
    let sources = match cargo::read(Path::new(name)) {
        Ok(sources) => sources,
        Err(report) => return report,
    };
    match generate_from(&sources, &emit::Options::default()) {
        Ok(_) => panic!("{name} is accepted"),
        Err(error) => error.render_in(&sources),
    }
}

#[test]
fn wrong_declarations_earn_helpful_reports() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/bad");
    let mut files: Vec<_> = std::fs::read_dir(folder).expect("bad/").map(|e| e.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "mbs"));
    files.sort();
    assert!(files.len() >= 17);
    for file in files {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path("snapshots/bad");
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name.clone(), report_of_file(&format!("bad/{name}.mbs"))));
    }
}

/// A hundred thousand of everything that nests: reported, in the stack of a thread, not overflowed.
#[test]
fn deep_nesting_is_refused_before_it_overflows() {
    let deep = 100_000;
    let bodies = [
        format!("kinetic += {}1{};", "(".repeat(deep), ")".repeat(deep)),
        format!("kinetic += {}1{};", "[".repeat(deep), "]".repeat(deep)),
        format!("kinetic += {}1;", "-".repeat(deep)),
        format!("kinetic += 1{};", "^1".repeat(deep)),
        format!("kinetic += {}1{};", "sin(".repeat(deep), ")".repeat(deep)),
        format!("{}{}", "for i in 0..1 {".repeat(deep), "}".repeat(deep)),
        "{".repeat(deep),
        "(".repeat(deep),
    ];
    for body in bodies {
        let text = report("deep.mbs", &format!("mechanism Deep {{ coord x: m; {body} }}"));
        assert!(text.starts_with("error: "), "{text}");
    }
}

/// Long flat sums are not nested: they are accepted, and take time in proportion.
#[test]
fn a_sum_of_twenty_thousand_terms_is_accepted() {
    let terms = vec!["dt(x)^2"; 20_000].join(" + ");
    let source = format!("mechanism Long {{ param m: kg = 1.0; coord x: m; kinetic += 1/2 * m * ({terms}); }}");
    let generated = generate("long.mbs", &source, &emit::Options::default());
    assert!(generated.is_ok(), "{}", generated.unwrap_err().render("long.mbs", &source));
}
