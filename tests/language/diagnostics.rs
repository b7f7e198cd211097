//! Every wrong declaration in `bad/` and the report it earns, as snapshots; what follows from the advice; and inputs
//! too large to be kept as files.
//!
//! In `bad/` lines `// mended: …` behind a line say what to write in its place; `bad/shared/` is what some of them
//! import.

use std::path::{Path, PathBuf};

use mbs_derive::expr::Graph;
use mbs_derive::source::Sources;
use mbs_derive::{Analysis, emit, generate};

/// Errors, or the warnings where there are none.
fn report(name: &str, source: &str) -> String {
    report_of(&Sources::new(name, source))
}

fn report_of(sources: &Sources) -> String {
    let graph = Graph::verbatim();
    match Analysis::of(sources, &graph).and_then(|analysis| analysis.rust(&emit::Options::default())) {
        Ok(generated) if generated.warnings.is_empty() => {
            panic!("{} is accepted without a warning", sources.main().name)
        }
        Ok(generated) => generated.warnings,
        Err(error) => error.render_in(sources),
    }
}

/// Name and bytes of each file.
fn bad() -> Vec<(String, Vec<u8>)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/bad");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("bad/").map(|e| e.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "mbs"));
    files.sort();
    let name = |file: &PathBuf| file.file_stem().expect("a name").to_string_lossy().into_owned();
    files.iter().map(|file| (name(file), std::fs::read(file).expect("a file"))).collect()
}

fn snapshot(name: &str, report: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots/bad");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, report));
}

#[test]
fn wrong_declarations_earn_helpful_reports() {
    let files = bad();
    assert!(files.len() >= 85, "{} files", files.len());
    for (name, _) in files {
        // What a build script would say; cargo runs tests in the folder of their crate.
        let sources = mbs_derive::read(Path::new(&format!("bad/{name}.mbs")));
        let report = sources.map_or_else(|report| report, |sources| report_of(&sources));
        let titles = report.lines().filter(|line| line.starts_with("error") || line.starts_with("warning"));
        let coded =
            |title: &str| title.split_once("[MBS").is_some_and(|(_, rest)| rest.as_bytes().get(4) == Some(&b']'));
        assert!(titles.clone().count() > 0 && titles.clone().all(coded), "{name}: {report}");
        snapshot(&name, &report);
    }
}

/// The text with each line replaced by those that mend it.
fn mended(source: &str) -> String {
    let mut lines: Vec<&str> = Vec::new();
    let mut first = true;
    for line in source.lines() {
        match line.trim_start().strip_prefix("// mended:") {
            Some(better) => {
                if first {
                    lines.pop();
                }
                lines.push(better);
                first = false;
            }
            None => {
                lines.push(line);
                first = true;
            }
        }
    }
    lines.join("\n")
}

/// The words of every "did you mean `…`?".
fn meant(report: &str) -> Vec<Vec<&str>> {
    let quoted = report.split("did you mean `").skip(1).filter_map(|rest| rest.split_once("`?"));
    quoted
        .map(|(text, _)| text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| w.len() > 1).collect())
        .collect()
}

/// Whoever does what the reports say has a mechanism without a warning.
#[test]
fn the_advice_mends_them() {
    // Of imports it is mostly the other file that is to be mended.
    let mendable = |name: &str| !["empty", "lines_of_carriage_returns"].contains(&name) && !name.starts_with("import_");
    for (name, bytes) in bad().into_iter().filter(|(name, _)| mendable(name)) {
        // What is not UTF-8 here is Latin-1.
        let source =
            String::from_utf8(bytes).unwrap_or_else(|e| e.as_bytes().iter().copied().map(char::from).collect());
        let better = mended(&source);
        assert!(better != source || name == "non_utf8", "{name} says nothing about how it is mended");
        let generated = generate(&name, &better, &emit::Options::default());
        let generated = generated.unwrap_or_else(|e| panic!("{}", e.render(&name, &better)));
        assert_eq!(generated.warnings, "", "{name}");
        if name != "non_utf8" {
            for words in meant(&report(&name, &source)) {
                let followed = words.is_empty() || words.iter().any(|word| better.contains(word));
                assert!(followed, "{name}: {words:?} was meant, but does not mend it");
            }
        }
    }
}

/// A table of ten megabytes behind a comment sign, and one that is the whole file; a picture; nesting.
#[test]
fn very_large_files_are_reported_as_others_are() {
    let row = "// 0.125, 0.250, 0.375, 0.500\n";
    let table = row.repeat(10_000_000 / row.len());
    let file = format!("mechanism Cart {{\n{table}param m: kg = 1;\ncoord x: m;\nkinetic += 1/2*mm*dt(x)^2;\n}}\n");
    snapshot("generated_ten_megabytes", &report("generated.mbs", &file));
    snapshot("generated_ten_megabytes_of_zeros", &report("generated.mbs", &"\0".repeat(10_000_000)));
    // One expression, of which no token is made.
    let terms = "m*x*x + ".repeat(8_000_000);
    let file = format!("mechanism Cart {{\nparam m: kg = 1;\ncoord x: m;\nkinetic += {terms}0;\n}}\n");
    snapshot("generated_expression_of_sixty_megabytes", &report("generated.mbs", &file));
    let name = "x".repeat(10_000_000);
    let file = format!("mechanism Cart {{ param m: kg = 1; coord x: m; kinetic += 1/2*m*dt({name})^2; }}");
    snapshot("generated_name_of_ten_megabytes", &report("generated.mbs", &file));
    for deep in [257, 100_000] {
        let file = format!(
            "mechanism Cart {{\nparam m: kg = 1;\ncoord x: m;\nkinetic += 1/2*m*{}dt(x){}^2;\n}}\n",
            "(".repeat(deep),
            ")".repeat(deep)
        );
        snapshot(&format!("generated_{deep}_levels"), &report("generated.mbs", &file));
    }
    let levels = 250;
    let file = format!(
        "mechanism Cart {{\nparam m: kg = 1;\ncoord x: m;\nkinetic += 1/2*m*{}dt(x){}^2;\n}}\n",
        "(".repeat(levels),
        ")".repeat(levels)
    );
    assert!(generate("generated.mbs", &file, &emit::Options::default()).is_ok());
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
        assert!(text.starts_with("error[MBS"), "{text}");
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
