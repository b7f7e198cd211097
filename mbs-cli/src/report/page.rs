//! The page, section by section.

use mbs_derive::optimise::{Derivation, FunctionKind, Operations};
use mbs_derive::source::Sources;
use mbs_derive::variable::Variable;
use serde_json::Value;

use super::about::{about, called};
use super::html::{code, escaped, number, paragraphs, prose, section, size, table};
use super::{Parts, accuracy, in_script, module};
use crate::check::Freedom;
use crate::failure::Failure;
use crate::output;
use crate::scene::mesh;
use crate::state::Point;
use crate::words::plural;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");

/// The page's modules, each behind those that it imports.
const SCRIPTS: [&str; 7] = [
    include_str!("dop853.js"),
    include_str!("projection.js"),
    include_str!("motion.js"),
    include_str!("plot.js"),
    include_str!("solid.js"),
    include_str!("view.js"),
    include_str!("page.js"),
];

/// Equations of more bytes are cut, line by line: a browser would set them for seconds, and nobody would read them.
const MOST_EQUATIONS: usize = 1_200_000;

/// All of it; the motion begins at `start` and takes `seconds`.
pub(super) fn page(sources: &Sources, parts: &Parts, start: &Point, seconds: f64) -> Result<String, Failure> {
    let (meshes, missing) = mesh::meshes(&parts.scene, sources);
    missing.iter().for_each(output::warn);
    let derivation = &parts.mechanism.derivation;
    let sections = [
        ("declaration", "Declaration", declaration(sources, derivation)),
        ("equations", "Equations", equations(&parts.equations)),
        ("constraints", "Constraints and degrees of freedom", constraints(derivation)?),
        ("conserved", "Conserved quantities", conserved(derivation)),
        ("cost", "Cost by route", costs(derivation, &parts.costs)),
        ("accuracy", "Accuracy", accuracy(derivation, start, seconds)),
        ("proof", "Proof", proof(parts)),
    ];
    let contents: String = sections.iter().map(|(id, title, _)| format!("<a href=\"#{id}\">{title}</a>\n")).collect();
    let body: String = sections.iter().map(|(id, title, body)| section(id, title, body)).collect();
    let name = sources.portable_name();
    let scene = &parts.scene.derivation;
    let see = scene.functions.iter().map(|function| function.name.clone()).collect();
    let script = format!(
        "const Mechanism = {};\nconst Scene = {};\n\n{}\n\
         window.report = start(JSON.parse(document.getElementById(\"about\").textContent), Mechanism, Scene);\n",
        module(derivation, name, called(derivation)),
        module(scene, name, see),
        bundle(&SCRIPTS),
    );
    let footer =
        format!("Written by mbs {} from {}. This page asks for no other file.", env!("CARGO_PKG_VERSION"), code(name));
    Ok(filled(&[
        ("title", &escaped(&derivation.name)),
        ("style", STYLE),
        ("name", &escaped(&derivation.name)),
        ("docs", &paragraphs(&derivation.docs)),
        ("contents", &format!("<a href=\"#motion\">Motion</a>\n{contents}")),
        ("sections", &body),
        ("footer", &footer),
        ("about", &in_script(&about(parts, &meshes, start, seconds))),
        ("script", &ended_nowhere(&script)),
    ]))
}

/// The page with its places filled, in one pass: what is put in may hold braces.
fn filled(values: &[(&str, &str)]) -> String {
    let mut page = String::new();
    let mut rest = PAGE;
    while let Some((before, from)) = rest.split_once("{{") {
        let (name, behind) = from.split_once("}}").unwrap_or((from, ""));
        page += before;
        page += values.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value);
        rest = behind;
    }
    page + rest
}

/// Modules as one: without what they import from each other, and without `export`.
fn bundle(modules: &[&str]) -> String {
    let mut text = String::new();
    for line in modules.iter().flat_map(|module| module.lines().chain([""])) {
        if line.starts_with("import ") {
            continue;
        }
        text += line.strip_prefix("export ").unwrap_or(line);
        text.push('\n');
    }
    text
}

/// A script in which nothing ends the script: `</` and `<!` stand in comments alone, where users write them.
fn ended_nowhere(script: &str) -> String {
    script.replace("</", "<\\/").replace("<!", "<\\!")
}

fn declaration(sources: &Sources, derivation: &Derivation) -> String {
    let kinds = [
        ("Coordinates", &derivation.coordinates),
        ("Parameters", &derivation.parameters),
        ("Inputs", &derivation.inputs),
        ("Prescribed motions", &derivation.prescribed),
    ];
    let mut html = String::new();
    for (title, variables) in kinds.into_iter().filter(|(_, variables)| !variables.is_empty()) {
        let has_values = variables.iter().any(|variable| !variable.defaults.is_empty());
        let mut head = vec!["name", "unit"];
        head.extend(has_values.then_some("value"));
        head.push("meaning");
        let head: Vec<String> = head.into_iter().map(str::to_string).collect();
        let rows: Vec<Vec<String>> = variables.iter().map(|variable| row(variable, has_values)).collect();
        html += &format!("<h3>{title}</h3>\n{}", table(&head, &rows, usize::MAX));
    }
    html + &format!(
        "<h3>As entered</h3>\n<p class=\"note\">Energies, forces and constraints are marked.</p>\n{}",
        entered(sources)
    )
}

fn row(variable: &Variable, has_value: bool) -> Vec<String> {
    let lengths: String = variable.lengths().iter().map(|length| format!("[{length}]")).collect();
    let unit = if variable.unit == "1" { "–".to_string() } else { escaped(&variable.unit) };
    let mut row = vec![code(&format!("{}{lengths}", variable.name)), unit];
    if has_value {
        let degrees = variable.declared_unit.as_deref() == Some("deg");
        let values: Vec<f64> = variable.defaults.iter().map(|value| value.to_f64()).collect();
        let shown = |&value: &f64| if degrees { format!("{}°", number(value.to_degrees())) } else { number(value) };
        let mut shown: Vec<String> = values.iter().map(shown).collect();
        if shown.iter().all(|value| *value == shown[0]) {
            shown.truncate(1);
        }
        row.push(shown.join(", "));
    }
    row.push(prose(variable.docs.join(" ").trim()));
    row
}

/// The text of the declaration.
fn entered(sources: &Sources) -> String {
    const ENERGIES: [&str; 7] = ["kinetic", "potential", "dissipation", "lagrangian", "force", "torque", "constraint"];
    let text = sources.main().text.as_deref().unwrap_or_default();
    let lines = text.lines().map(|line| {
        let start = line.trim_start();
        let word: String = start.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let class = match word.as_str() {
            _ if start.starts_with("//") => " class=\"comment\"",
            word if ENERGIES.contains(&word) => " class=\"energy\"",
            _ => "",
        };
        format!("<span{class}>{}</span>", escaped(line))
    });
    let others = sources.names().skip(1).map(code).collect::<Vec<_>>();
    let others = if others.is_empty() {
        String::new()
    } else {
        format!("<p class=\"note\">It imports {}.</p>\n", others.join(", "))
    };
    format!("<pre id=\"declared\">{}</pre>\n{others}", lines.collect::<Vec<_>>().join(""))
}

/// Without the title, the documentation and the table of symbols, which stand above; no longer than anybody reads.
fn equations(html: &str) -> String {
    const TABLE: [&str; 2] = ["<table class=\"symbols\">", "</table>\n"];
    let mut html = html.find(TABLE[0]).map_or(html, |start| &html[start..]);
    // One table behind the other.
    while let Some((_, rest)) = html.strip_prefix(TABLE[0]).and_then(|rest| rest.split_once(TABLE[1])) {
        html = rest;
    }
    let (mut text, mut left_out) = (String::new(), 0);
    for piece in html.split_inclusive('\n') {
        let is_line = piece.starts_with("<tr><td>");
        if is_line && text.len() + piece.len() > MOST_EQUATIONS {
            left_out += 1;
        } else {
            text += piece;
        }
    }
    let note = match left_out {
        0 => String::new(),
        count => format!(
            "<p class=\"note\">Left out: the last {}; <code>mbs derive --emit latex</code> has them all.</p>\n",
            plural(count, "line of these equations", "lines of these equations")
        ),
    };
    format!("{note}<div class=\"equations\">\n{text}</div>\n{note}")
}

fn constraints(derivation: &Derivation) -> Result<String, Failure> {
    let coordinates = derivation.dof();
    if derivation.constraints.is_empty() {
        let degrees = plural(coordinates, "degree of freedom", "degrees of freedom");
        let names = plural(coordinates, "coordinate", "coordinates");
        return Ok(format!("<p>There are no constraints: {degrees}, as many as {names}.</p>\n"));
    }
    let summary = Freedom::of(derivation)?.summary();
    let head = ["row", "kind", "unit", "unit of its multiplier"].map(str::to_string);
    let rows = derivation.constraints.iter().zip(&derivation.holonomic).zip(&derivation.constraint_units);
    let rows: Vec<Vec<String>> = rows
        .map(|((name, holonomic), units)| {
            let kind = if *holonomic { "holonomic, φ(q, t) = 0" } else { "on velocities, a·q̇ + b = 0" };
            vec![code(name), kind.to_string(), escaped(&units[0]), escaped(&units[1])]
        })
        .collect();
    let count = plural(coordinates, "coordinate", "coordinates");
    Ok(format!("<p>{count}{}.</p>\n{}", escaped(&summary), table(&head, &rows, usize::MAX)))
}

fn conserved(derivation: &Derivation) -> String {
    if derivation.conserved.is_empty() {
        return "<p>No first integrals were found.</p>\n".to_string();
    }
    let meaning = |name: &str| match name.strip_prefix("p_") {
        Some(coordinate) => format!("the momentum of {}, which does not occur in L", code(coordinate)),
        None => "q̇·∂L/∂q̇ − L: the energy T + V, where T is quadratic in q̇ and L = T − V".to_string(),
    };
    let rows: Vec<Vec<String>> = derivation.conserved.iter().map(|name| vec![code(name), meaning(name)]).collect();
    let table = table(&["quantity".to_string(), "what it is".to_string()], &rows, usize::MAX);
    format!("<p>Constant along motions without inputs and dissipation; the motion above plots them.</p>\n{table}")
}

/// Additions and multiplications by each route, and the other operations of the one that was taken.
fn costs(derivation: &Derivation, explained: &str) -> String {
    let explained: Value = serde_json::from_str(explained).unwrap_or_default();
    let by_route = |function: &str| explained[function]["by_route"].as_object();
    let first = derivation.functions.first().and_then(|function| by_route(&function.name));
    let routes: Vec<String> = first.map_or(Vec::new(), |routes| routes.keys().cloned().collect());
    let head = ["function", "route", "add", "mul", "div", "√", "sin, cos", "other"].map(str::to_string);
    let head: Vec<String> = head.into_iter().chain(routes.iter().map(|route| format!("flops, {route}"))).collect();
    let rows: Vec<Vec<String>> = derivation
        .functions
        .iter()
        .map(|function| {
            let Operations { add, mul, div, sqrt, sincos, other } = function.operations;
            let mut row = vec![code(&function.name), function.route.to_string()];
            row.extend([add, mul, div, sqrt, sincos, other].map(|count| count.to_string()));
            row.extend(routes.iter().map(|route| {
                let flops = &explained[function.name.as_str()]["by_route"][route.as_str()]["flops"];
                let text = flops.as_u64().map_or("–".to_string(), |flops| flops.to_string());
                if *route == function.route.to_string() { format!("<strong>{text}</strong>") } else { text }
            }));
            row
        })
        .collect();
    format!(
        "<p>What one call of each function costs, by the route that it took, and the additions and multiplications that it \
         would take by the others. Negations are free; what depends on parameters alone is computed once.</p>\n{}",
        table(&head, &rows, 2)
    )
}

fn accuracy(derivation: &Derivation, start: &Point, seconds: f64) -> String {
    let motion = match accuracy::motion(derivation, start, seconds) {
        Ok(motion) => motion,
        Err(failure) => {
            return format!(
                "<p>It was to be looked at along the motion above, which ends early: {}</p>\n",
                escaped(failure.messages().text().trim().trim_start_matches("error: "))
            );
        }
    };
    let kept = accuracy::kept(derivation, &motion);
    let [change, scale] = kept.energy;
    let mut html =
        "<p>Along the motion above, by DOP853 with tolerances of 10<sup>−10</sup> and 10<sup>−12</sup>, T + V "
            .to_string();
    html += &match (derivation.conserved.iter().any(|name| name == "energy_integral"), scale > 0.0) {
        (true, true) => format!("stays within {} J, {} of the largest of T and V.", size(change), size(change / scale)),
        _ => format!("changes by {} J at most.", size(change)),
    };
    if !derivation.constraints.is_empty() {
        html += &format!(" Constraints are open by {} at most.", size(kept.residual));
    }
    html += "</p>\n<p>What rounding may do to each function at 21 states of it: a running error bound in doubles, relative to \
             the largest component, of the state for which it is largest.</p>\n";
    let bounds = accuracy::bounds(derivation, start, &motion);
    let rows: Vec<Vec<String>> =
        bounds.iter().map(|bound| vec![code(&bound.function), bound.relative.map_or("–".to_string(), size)]).collect();
    html + &table(&["function".to_string(), "relative error, at most".to_string()], &rows, 1)
}

fn proof(parts: &Parts) -> String {
    let mechanism = &parts.mechanism;
    let singular = match mechanism.singular_at {
        0 => String::new(),
        count => format!(" At {count} of them some motion has no inertia; there accelerations are not compared."),
    };
    let warnings = match mechanism.warnings().text().trim() {
        "" => String::new(),
        warnings => format!("<pre>{}</pre>\n", escaped(warnings)),
    };
    let count = mechanism.derivation.functions.len();
    let forward = mechanism.derivation.function(FunctionKind::ForwardDynamics).is_some();
    let accelerations = if forward { "accelerations, " } else { "" };
    format!(
        "<p>All {count} functions agree with the energies as they were declared at {}, those with exact zeros included: \
         forces, inertia, {accelerations}their derivatives, constraints and outputs are compared with dual numbers that share \
         no derivative and no rule with the generator, to 10<sup>−9</sup> and what rounding explains.{singular}</p>\n{warnings}",
        plural(mechanism.proved_at, "state", "states"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_become_one() {
        let text = bundle(&["import { a } from \"./a.js\";\n\nexport function f() {}\n", "export const x = 1;"]);
        assert_eq!(text, "\nfunction f() {}\n\nconst x = 1;\n\n");
        // Names of modules that are one must not meet.
        let all = bundle(&SCRIPTS);
        let mut names = std::collections::BTreeSet::new();
        for line in all.lines().filter(|line| !line.starts_with([' ', '}', '/'])) {
            let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            if let (Some("function" | "class" | "const"), Some(name)) = (words.next(), words.next()) {
                assert!(names.insert(name.to_string()), "{name} is there twice");
            }
        }
        assert!(names.contains("Dop853") && names.contains("start"), "{names:?}");
        assert!(!all.contains("import ") && !all.contains("\nexport "));
    }

    #[test]
    fn a_script_is_ended_by_nothing_in_it() {
        assert_eq!(ended_nowhere("// </script> <!-- "), "// <\\/script> <\\!-- ");
        assert_eq!(in_script(&serde_json::json!({"a": "</script>"})), "{\"a\":\"\\u003c/script>\"}");
    }

    #[test]
    fn long_equations_are_cut_and_it_is_said() {
        let line = format!("<tr><td>{}</td></tr>\n", "x".repeat(1000));
        let html = format!(
            "<h3>A</h3>\n<table class=\"symbols\">\n</table>\n<h4>M</h4>\n<table class=\"align\">\n{}</table>\n",
            line.repeat(1300)
        );
        let cut = equations(&html);
        assert!(cut.len() < MOST_EQUATIONS + 2000, "{}", cut.len());
        assert!(cut.contains("lines of these equations; ") && !cut.contains("<h3>"), "{}", &cut[..300]);
        assert_eq!(cut.matches("<table").count(), cut.matches("</table>").count());
        assert!(!equations("<h3>A</h3>\n<table class=\"align\">\n</table>\n").contains("Left out"));
    }
}
