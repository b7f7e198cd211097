//! Generated code says what it computes: locals are called by what they are (`w3x`: angular velocity of link 3 about x)
//! or by what they are part of, not by numbers.

use mbs_derive::emit::Options;
use mbs_derive::generate;

/// A mechanism of the repository, or one of `tests/mechanisms/`.
fn code(module: &str) -> String {
    let mut all = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES);
    let (_, source) = all.find(|(name, _)| *name == module).expect("a mechanism");
    generate(module, source, &Options::default()).expect("it is generated").code
}

/// The names that `let` binds, by function.
fn locals(code: &str) -> Vec<(&str, Vec<&str>)> {
    let mut functions: Vec<(&str, Vec<&str>)> = Vec::new();
    for line in code.lines().map(str::trim) {
        if let Some((name, _)) = line.strip_prefix("pub fn ").and_then(|rest| rest.split_once(['(', '<'])) {
            functions.push((name, Vec::new()));
        } else if let (Some(rest), Some((_, names))) = (line.strip_prefix("let "), functions.last_mut()) {
            let (bound, _) = rest.split_once('=').unwrap_or((rest, ""));
            let is_argument = rest.ends_with("= *q;") || rest.ends_with("= *qd;") || rest.contains("= self.params");
            let words = bound.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
            names.extend(words.filter(|word| !is_argument && *word != "_"));
        }
    }
    functions
}

/// `t12`: its digits say nothing.
fn is_numbered(name: &str) -> bool {
    name.strip_prefix(['t', 'k']).is_some_and(|digits| !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit()))
}

/// `f3x_a`: a part of what is named.
fn is_part(name: &str) -> bool {
    name.rsplit_once('_').is_some_and(|(_, last)| last.len() <= 2 && last.chars().all(|c| c.is_ascii_lowercase()))
}

#[test]
fn locals_have_names() {
    for module in ["arm6", "irb7600", "tree_robot"] {
        let code = code(module);
        let share = |names: &[&str], is: fn(&str) -> bool| {
            100 * names.iter().filter(|name| is(name)).count() / names.len().max(1)
        };
        let functions = locals(&code);
        for (function, names) in &functions {
            println!(
                "{module}.{function}: {} locals, {} % parts, {} % numbered",
                names.len(),
                share(names, is_part),
                share(names, is_numbered)
            );
        }
        let all: Vec<&str> = functions.into_iter().flat_map(|(_, names)| names).collect();
        assert!(all.len() > 1000, "{module}: {} locals", all.len());
        assert!(share(&all, is_numbered) <= 2, "{module}: {} % of its locals are numbered", share(&all, is_numbered));
    }
}

/// What a reader of Khalil and Dombre looks for in the recursion is there under its name, the key explains it.
#[test]
fn the_recursion_can_be_followed() {
    let code = code("arm6");
    let body = code.split_once("pub fn inverse_dynamics(").expect("the function").1;
    let body = &body[..body.find("\n        }\n").expect("its end")];
    let function = format!("pub fn inverse_dynamics(\n{body}");
    let names = &locals(&function)[0].1;
    let has = |name: &str| names.iter().any(|found| found.strip_suffix("_neg").unwrap_or(found) == name);
    for name in ["w2x", "w3x", "w4y", "w6z", "wd3x", "wd6x", "u3zx", "a3x", "f3y", "f4x", "fi6y", "n3x"] {
        assert!(has(name), "{name} is not among {names:?}");
    }
    assert!(code.contains("/// - `wjx`, `vjx`: angular velocity, velocity of the origin;"), "{}", &code[..2000]);
}

/// The key has lines for names that occur, and says of what constants are made that were regrouped.
#[test]
fn the_key_is_of_what_occurs() {
    let (kepler, arm) = (code("kepler"), code("irb7600"));
    assert!(!kepler.contains("`majxy`") && !kepler.contains("`fujx`"), "{}", &kepler[..2000]);
    // Behind joint 3 everything is a₃ off its axis.
    let line = "/// - `hr3x`: `mass_2`, `mass_3`, `mass_4`, `mass_5`, `com_x_2`;\n";
    assert!(arm.contains(line), "{}", &arm[..4000]);
}
