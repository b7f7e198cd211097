//! The user's promise: a crate of one's own, made from the README, builds and runs; a new `.mbs` beside the others
//! builds, runs, and shows up as one new snapshot and nothing else.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// The text of the README's code block whose opening fence is this.
fn block(fence: &str) -> String {
    let readme = fs::read_to_string(format!("{ROOT}/README.md")).expect("the README");
    let start = readme.find(&format!("```{fence}\n")).unwrap_or_else(|| panic!("no block ```{fence}"));
    let text = &readme[start + fence.len() + 4..];
    text[..text.find("```").expect("a closing fence")].to_string()
}

/// A crate in a temporary folder, of a name of its own; its target folder lies in the workspace's, so that what it
/// depends on is built once.
pub(crate) struct Downstream {
    folder: tempfile::TempDir,
}

impl Downstream {
    pub(crate) fn new(name: &str, dependencies: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let root = fs::canonicalize(ROOT).expect("the workspace");
        let dependencies = dependencies.replace("../mbs", &root.to_string_lossy());
        let manifest = format!(
            "[package]\nname = \"{name}-{}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n{dependencies}\n[workspace]\n",
            std::process::id()
        );
        let downstream = Downstream { folder };
        downstream.write("Cargo.toml", &manifest);
        // The versions that the workspace was tested with; no look at a registry.
        fs::copy(root.join("Cargo.lock"), downstream.path("Cargo.lock")).expect("the lockfile");
        downstream
    }

    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    pub(crate) fn write(&self, file: &str, text: &str) {
        let path = self.path(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a temporary folder");
        fs::write(path, text).expect("a temporary folder");
    }

    pub(crate) fn cargo(&self, arguments: &[&str]) -> Output {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(arguments).env("INSTA_UPDATE", "new").env("INSTA_WORKSPACE_ROOT", self.folder.path());
        self.within(&mut cargo).output().expect("cargo runs")
    }

    /// A program in the crate's folder.
    pub(crate) fn within<'c>(&self, program: &'c mut Command) -> &'c mut Command {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("downstream");
        program
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", target)
            .env("CARGO_NET_OFFLINE", "true")
            .env("CARGO_PROFILE_DEV_DEBUG", "false") // so that programs and build scripts share one mbs-derive
            .env_remove("CI")
    }

    fn pending_snapshots(&self) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.path("tests/snapshots")) else { return Vec::new() };
        let names = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
        let mut pending: Vec<String> = names.filter(|name| name.ends_with(".snap.new")).collect();
        pending.sort();
        pending
    }
}

pub(crate) fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

#[test]
fn the_readme_makes_a_crate() {
    let crate_ = Downstream::new("readme", &block("toml"));
    crate_.write("mechanisms/cart_pole.mbs", &block("mbs"));
    crate_.write("build.rs", &block("rust,build.rs"));
    crate_.write("src/main.rs", &block("rust,main.rs"));
    let run = crate_.cargo(&["run"]);
    assert!(run.status.success(), "{}", text(&run));
    assert!(text(&run).contains("accelerations"), "{}", text(&run));

    // A mistake stops the build with file, line, column and the text underlined, not with a panic.
    crate_.write("mechanisms/cart_pole.mbs", &block("mbs").replace("dt(x)^2", "dt(y)^2"));
    let wrong = crate_.cargo(&["build"]);
    assert!(!wrong.status.success());
    let report = text(&wrong);
    assert!(report.contains("mechanisms/cart_pole.mbs:14:36"), "{report}");
    assert!(!report.contains("panicked"), "{report}");
}

/// The README's review is that of `examples/downstream`, which CI runs.
#[test]
fn the_readme_keeps_a_snapshot() {
    let example = fs::read_to_string(format!("{ROOT}/examples/downstream/tests/review.rs")).expect("the example");
    let review = block("rust,tests/review.rs").replace("cart_pole", "crane");
    assert!(example.ends_with(&review), "{example}\n{review}");
}

/// Shared functions in a file of their own: a change of that file alone is seen, a mistake in it is shown there.
#[test]
fn what_a_mechanism_imports_belongs_to_it() {
    let crate_ = Downstream::new("import", &block("toml"));
    let mechanism = block("mbs").replace("m_bob * g * bob.z", "weight(m_bob, g) * bob.z");
    crate_.write("mechanisms/cart_pole.mbs", &format!("import \"../shared/weight.mbs\";\n{mechanism}"));
    crate_.write("shared/weight.mbs", "fn weight(mass, g) = mass*g;\n");
    crate_.write("build.rs", &block("rust,build.rs"));
    crate_.write(
        "src/main.rs",
        "mbs_runtime::include_mechanism!(\"cart_pole\");\n\
         fn main() { println!(\"V = {:.3}\", cart_pole::CartPole::<f64>::default().potential_energy(&[0.0, 0.0])); }\n",
    );
    let first = text(&crate_.cargo(&["run"]));
    assert!(first.contains("V = -0.491\n"), "{first}");
    crate_.write("shared/weight.mbs", "fn weight(mass, g) = 2*mass*g;\n");
    let second = text(&crate_.cargo(&["run"]));
    assert!(second.contains("V = -0.981\n"), "{second}");
    crate_.write("shared/weight.mbs", "/// In N.\nfn weight(mass, g) = mass*g*nothing;\n");
    let wrong = text(&crate_.cargo(&["build"]));
    assert!(
        wrong.contains("--> shared/weight.mbs:2:29\n") && wrong.contains("--> mechanisms/cart_pole.mbs:16:"),
        "{wrong}"
    );
    assert!(wrong.contains("2 | fn weight(mass, g) = mass*g*nothing;\n"), "{wrong}");
    assert!(!wrong.contains("panicked"), "{wrong}");
}

/// After an error there is nothing to be compiled: neither what the text said before, nor under what name.
#[test]
fn a_build_that_goes_on_has_no_old_equations() {
    let crate_ = Downstream::new("stale", &block("toml"));
    let bead = "mechanism Bead { param m: kg = 1.0; coord s: m; kinetic += 1/2*m*dt(s)^2; }\n";
    let build = "fn main() {\n    if let Err(report) = mbs_derive::try_compile(\"bead.mbs\") {\n        \
                 println!(\"cargo::warning={}\", report.to_string().lines().next().unwrap_or_default());\n    }\n}\n";
    crate_.write("build.rs", build);
    crate_.write("src/main.rs", "mbs_runtime::include_mechanism!(\"bead\");\nfn main() {}\n");
    for other in [bead.replace("m*dt", "mass*dt"), bead.replace("Bead", "Pearl"), String::new()] {
        crate_.write("bead.mbs", bead);
        let good = crate_.cargo(&["build"]);
        assert!(good.status.success(), "{}", text(&good));
        crate_.write("bead.mbs", &other);
        assert!(!crate_.cargo(&["build"]).status.success(), "{other}");
    }
    crate_.write("bead.mbs", bead);
    assert!(crate_.cargo(&["build"]).status.success());
    fs::remove_file(crate_.path("bead.mbs")).expect("the mechanism");
    assert!(!crate_.cargo(&["build"]).status.success(), "the text is gone");
}

/// Code that is checked in, of a folder with shared files in it; and modules that would be one file.
#[test]
fn a_folder_is_generated_beside_its_index() {
    let crate_ = Downstream::new("folder", &block("toml"));
    let mechanism = block("mbs").replace("m_bob * g * bob.z", "weight(m_bob, g) * bob.z");
    crate_.write("mechanisms/cart_pole.mbs", &format!("import \"weight.mbs\";\n{mechanism}"));
    crate_.write("mechanisms/weight.mbs", "/// In N.\nfn weight(mass, g) = mass*g;\n");
    crate_.write(
        "build.rs",
        "fn main() {\n    let folder = concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/mechanisms\");\n    \
         mbs_derive::Config::new().out_dir(\"src/generated\").compile_folder(folder);\n}\n",
    );
    crate_.write("src/generated/README", "Generated from ../../mechanisms.\n");
    crate_.write(
        "src/main.rs",
        "mod generated { include!(\"generated/mechanisms.rs\"); }\n\
         fn main() {\n    use generated::{GENERATED, SOURCES, cart_pole::CartPole};\n    \
         let [(module, source)] = SOURCES else { panic!(\"one mechanism\") };\n    \
         assert!(source.ends_with(\"output tip = bob;\\n}\\n\") && GENERATED[0].1.contains(\"pub mod cart_pole {\"));\n    \
         println!(\"{module}: {:?}\", CartPole::<f64>::default().tip(&[1.0, 0.0]));\n}\n",
    );
    let run = text(&crate_.cargo(&["run"]));
    assert!(run.contains("cart_pole: [1.0, 0.0, -0.5]\n"), "{run}");
    for file in ["mechanisms.rs", "cart_pole.rs"] {
        let code = fs::read_to_string(crate_.path(&format!("src/generated/{file}"))).expect("generated");
        assert!(!code.contains(&*crate_.folder.path().to_string_lossy()), "{file} names a folder of this machine");
    }
    assert!(!crate_.path("src/generated/weight.rs").exists());

    let other = "mechanism Cart_Pole { param m: kg = 1; coord x: m; kinetic += 1/2*m*dt(x)^2; }\n";
    crate_.write("mechanisms/other.mbs", other);
    let twice = text(&crate_.cargo(&["build"]));
    assert!(twice.contains(": `Cart_Pole` would be written to cart_pole.rs, as the mechanism of "), "{twice}");
    assert!(twice.contains("mechanisms/other.mbs:1:1\n"), "{twice}");
    crate_.write("mechanisms/other.mbs", &other.replace("Cart_Pole", "Mechanisms"));
    let index = text(&crate_.cargo(&["build"]));
    assert!(index.contains(": `Mechanisms` would be written to mechanisms.rs, which lists all mechanisms"), "{index}");
    crate_.write("mechanisms/other.mbs", "const a = 2 b;\n");
    let shared = text(&crate_.cargo(&["build"]));
    assert!(shared.contains("mechanisms/other.mbs:1:13\n"), "files to be shared are looked through: {shared}");
}

#[test]
fn a_new_mechanism_is_one_new_snapshot() {
    let dependencies = block("toml").replace("[build-dependencies]", "insta = \"1\"\n\n[build-dependencies]");
    let crate_ = Downstream::new("promise", &format!("[lib]\nname = \"promise\"\n\n{dependencies}"));
    crate_.write("build.rs", "fn main() { mbs_derive::Config::new().compile_folder(\"mechanisms\"); }\n");
    crate_.write("src/lib.rs", "include!(concat!(env!(\"OUT_DIR\"), \"/mechanisms.rs\"));\n");
    crate_.write(
        "tests/generated.rs",
        r#"
#[test]
fn modules() {
    for (module, code) in promise::GENERATED {
        insta::assert_snapshot!(*module, code);
    }
}

macro_rules! run {
    ($($module:ident $name:ident $n:literal $u:literal $k:literal;)*) => {$(
        #[test]
        fn $module() {
            use mbs_runtime::Dynamics;
            let mechanism = promise::$module::$name::<f64>::default();
            let q = Dynamics::forward_dynamics(&mechanism, 0.0, &[0.3; $n], &[0.1; $n], &[0.2; $u]);
            assert!(q.iter().all(|x| x.is_finite()));
        }
    )*};
}
promise::for_each_mechanism!(run);
"#,
    );
    crate_.write("mechanisms/cart_pole.mbs", &block("mbs"));
    let first = crate_.cargo(&["test"]);
    assert_eq!(crate_.pending_snapshots(), ["generated__cart_pole.snap.new"], "{}", text(&first));
    let accepted = crate_.path("tests/snapshots/generated__cart_pole.snap");
    fs::rename(crate_.path("tests/snapshots/generated__cart_pole.snap.new"), &accepted).expect("accepted");
    let accepted_text = fs::read_to_string(&accepted).expect("accepted");

    let bead = "mechanism Bead { param m: kg = 1.0; param k: N/m = 5.0; coord s: m; \
                kinetic += 1/2*m*dt(s)^2; potential += 1/2*k*s^2; }\n";
    crate_.write("mechanisms/bead.mbs", bead);
    let second = crate_.cargo(&["test"]);
    assert_eq!(crate_.pending_snapshots(), ["generated__bead.snap.new"], "{}", text(&second));
    assert_eq!(fs::read_to_string(&accepted).expect("still there"), accepted_text, "the other one did not move");
    fs::rename(
        crate_.path("tests/snapshots/generated__bead.snap.new"),
        crate_.path("tests/snapshots/generated__bead.snap"),
    )
    .expect("accepted");
    let third = crate_.cargo(&["test"]);
    assert!(third.status.success(), "{}", text(&third));
    assert!(text(&third).contains("test bead ... ok"), "{}", text(&third));
}
