//! Mechanisms of bodies against the algorithms that rigid-body dynamics has for them: Newton–Euler, composite and
//! articulated bodies, Christoffel symbols; how the code grows with the number of bodies; what the benchmark arm may
//! cost.

mod agreement;
mod declared_tree;

use agreement::Pair;
use declared_tree::{DeclaredTree, declared_tree};
use mbs_derive::Analysis;
use mbs_derive::derive::{self, Route};
use mbs_derive::expr::Graph;
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::{Derivation, FunctionKind, by_route};
use mbs_derive::source::Sources;
use mbs_derive::variable::Variable;
use mbs_derive::verify::{self, Proof};
use mbs_derive::{declared, derived};
use mbs_tests::random::Random;
use mbs_tests::reference::robots::{self, Values};
use mbs_tests::reference::tree::Tree;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestCaseResult, TestError, TestRunner};

/// The mechanisms that are too large, or too unlike the others, for `models/mechanisms`.
const MECHANISMS: [(&str, &str); 5] = [
    ("arm_on_moving_base", include_str!("../mechanisms/arm_on_moving_base.mbs")),
    ("coupled_gripper", include_str!("../mechanisms/coupled_gripper.mbs")),
    ("floating_arm", include_str!("../mechanisms/floating_arm.mbs")),
    ("n_chain", include_str!("../mechanisms/n_chain.mbs")),
    ("tree_robot", include_str!("../mechanisms/tree_robot.mbs")),
];

fn source(name: &str) -> &'static str {
    let known = mbs_models::SOURCES.iter().chain(&MECHANISMS).find(|(module, _)| *module == name);
    known.unwrap_or_else(|| panic!("no mechanism {name}")).1
}

fn derivation_of(source: &str) -> Result<Derivation, String> {
    let graph = Graph::verbatim();
    match declared(source, &graph, &[]) {
        Ok((lagrangian, _)) => Ok(derived(&lagrangian)),
        Err(errors) => Err(errors.render("case.mbs", source)),
    }
}

/// Values of the parameters, from a flat list in declaration order.
fn values<'a>(parameters: &'a [Variable], flat: &'a [f64]) -> impl Fn(&str, usize) -> f64 + 'a {
    move |name, i| {
        let parameter = parameters.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("no parameter {name}"));
        flat[parameter.first + i]
    }
}

/// Every function of the mechanism against its tree: at the declared parameters, and twice at others.
fn check(name: &str, tree: impl Fn(Values<'_>) -> Tree) {
    check_with(name, tree, |_, _| Vec::new(), |_, _, u| u.to_vec());
}

fn check_with(
    name: &str,
    tree: impl Fn(Values<'_>) -> Tree,
    formulas: impl Fn(Values<'_>, f64) -> Vec<[f64; 3]>,
    force: impl Fn(&Tree, &[f64], &[f64]) -> Vec<f64>,
) {
    let derivation = derivation_of(source(name)).unwrap_or_else(|errors| panic!("{errors}"));
    let defaults: Vec<f64> = derivation.parameters.iter().flat_map(|p| &p.defaults).map(|d| d.to_f64()).collect();
    let mut random = Random::new(21);
    for round in 0..3 {
        let mut vary = |value: &f64| if round == 0 { *value } else { value * random.uniform(0.8..1.2) };
        let parameters: Vec<f64> = defaults.iter().map(&mut vary).collect();
        let value = values(&derivation.parameters, &parameters);
        let tree = tree(&value);
        let pair = Pair {
            derivation: &derivation,
            parameters: parameters.clone(),
            tree: tree.clone(),
            formulas: &|t| formulas(&value, t),
            force: &|x, u| force(&tree, x, u),
        };
        pair.agrees(31 + round, 24).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn arms_are_trees() {
    check("arm6", robots::arm6);
    check("arm6_params", robots::arm6_params);
    check("arm6_world", robots::arm6);
    check("irb7600", robots::irb7600);
    check("irb7600_rail", robots::irb7600_rail);
}

#[test]
fn scara_is_a_tree() {
    check("scara", robots::scara);
}

#[test]
fn tree_robot_is_a_tree() {
    check("tree_robot", robots::tree_robot);
}

#[test]
fn coupled_gripper_is_a_tree() {
    check("coupled_gripper", robots::coupled_gripper);
}

#[test]
fn n_chain_is_a_tree() {
    check("n_chain", |_| robots::n_chain(5));
}

/// The rotors push at a point of the base, which is node 5, and turn it.
#[test]
fn floating_arm_is_a_tree() {
    let force = |tree: &Tree, x: &[f64], u: &[f64]| {
        let [thrust, moment]: [[f64; 3]; 2] = [[u[0], u[1], u[2]], [u[3], u[4], u[5]]];
        let mut force = tree.wrench(5, [0.003, -0.004, 0.06], thrust, moment, x);
        (0..3).for_each(|k| force[6 + k] += u[6 + k]);
        force
    };
    check_with("floating_arm", robots::floating_arm, |_, _| Vec::new(), force);
}

#[test]
fn arm_on_moving_base_is_a_tree() {
    let yaw = |value: Values<'_>, t: f64| {
        let (a, w) = (value("yaw_amplitude", 0), value("yaw_frequency", 0));
        vec![[a * (w * t).sin(), a * w * (w * t).cos(), -a * w * w * (w * t).sin()]]
    };
    check_with("arm_on_moving_base", robots::arm_on_moving_base, yaw, |_, _, u| u.to_vec());
}

/// Those of `models/mechanisms` are proved by the build.
#[test]
fn mechanisms_are_proved_without_a_warning() {
    for (name, source) in MECHANISMS {
        let graph = Graph::verbatim();
        let (lagrangian, warnings) =
            declared(source, &graph, &[]).unwrap_or_else(|errors| panic!("{}", errors.render(name, source)));
        assert_eq!(warnings.render(name, source), "", "{name}");
        let proof = Proof::of(&lagrangian, &derived(&lagrangian)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(proof.states >= verify::STATES, "{name}");
    }
}

/// A program takes of each function the cheapest route; here each route has to compute all of them.
#[test]
fn every_route_is_proved() {
    // A body that turns by a quaternion or about an axis of parameters, and energies without a body on a pose.
    let without_bodies = [
        "heavy_top",
        "moving_frame",
        "quadrotor_quaternion",
        "branches",
        "long_branches",
        "measured_slider",
        "mounted_arm",
        "slow_frame",
        "switched_spring",
    ];
    for (name, source) in every_mechanism() {
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            declared(source, &graph, &[]).unwrap_or_else(|errors| panic!("{}", errors.render(name, source)));
        let routes = routes_proved(&lagrangian).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(routes.contains(&Route::Structured), !without_bodies.contains(&name), "{name}: {routes:?}");
        let is_long_chain = lagrangian.dof() > derive::LARGEST_UNROLLED;
        assert!(routes.contains(&Route::Plain) || is_long_chain, "{name}: {routes:?}");
    }
}

fn every_mechanism() -> impl Iterator<Item = (&'static str, &'static str)> {
    mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).copied()
}

/// Each route by itself against the energies; those that there are.
fn routes_proved(lagrangian: &Lagrangian<'_>) -> Result<Vec<Route>, String> {
    let mut proved = Vec::new();
    for route in Route::ALL {
        for alone in by_route(lagrangian, route) {
            Proof::of(lagrangian, &alone).map_err(|error| format!("{route}: {error}"))?;
            proved.push(route);
        }
    }
    Ok(proved)
}

/// Trees at random, declared by bodies and by world positions, with numbers and with parameters, shrunk where they
/// fail.
#[test]
fn random_trees_agree_with_the_algorithms_for_trees() {
    for_random_trees(100, tree_agrees);
}

/// Fewer of them, because each is derived and proved four times over, without loads and with them.
#[test]
fn every_route_of_random_trees_is_proved() {
    for_random_trees(12, every_route_of_a_tree_is_proved);
}

/// The seed is fixed, so that every run draws the same trees; `MBS_CASES` says how many.
fn for_random_trees(cases: u32, check: fn(DeclaredTree) -> TestCaseResult) {
    let config = Config {
        cases: crate::robustness::cases(cases),
        rng_seed: RngSeed::Fixed(4),
        failure_persistence: None,
        max_shrink_iters: 300,
        ..Config::default()
    };
    match TestRunner::new(config).run(&declared_tree(), check) {
        Ok(()) => {}
        // The reason holds the text of the smallest tree that fails, which says more than its fields do.
        Err(TestError::Fail(reason, _) | TestError::Abort(reason)) => panic!("{reason}"),
    }
}

/// Of a tree that is not too large to be differentiated.
fn every_route_of_a_tree_is_proved(declared_tree: DeclaredTree) -> TestCaseResult {
    let (text, tree) = (declared_tree.text(), declared_tree.tree());
    if !(1..=8).contains(&tree.coordinates) || !has_inertia(&tree) {
        return Err(TestCaseError::reject("no coordinate, too many of them, or one without inertia"));
    }
    all_routes_of(&text)?;
    let with = |loads: &[String]| text.replacen("\n}\n", &format!("\n{}\n}}\n", loads.join("\n")), 1);
    let is_accepted = |load: &String| declared(&with(std::slice::from_ref(load)), &Graph::verbatim(), &[]).is_ok();
    let loads: Vec<String> = declared_tree.loads().into_iter().filter(is_accepted).collect();
    if loads.is_empty() {
        return Err(TestCaseError::fail(format!("nothing can be loaded\n{text}")));
    }
    all_routes_of(&with(&loads))
}

fn all_routes_of(text: &str) -> TestCaseResult {
    let failed = |error: String| TestCaseError::fail(format!("{error}\n{text}"));
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(text, &graph, &[]).map_err(|errors| failed(errors.render("case.mbs", text)))?;
    routes_proved(&lagrangian).map(|_| ()).map_err(failed)
}

/// Derived from the tree's text, evaluated with other parameters than the declared ones.
fn tree_agrees(declared: DeclaredTree) -> TestCaseResult {
    let (text, varied) = (declared.text(), declared.varied(5));
    let failed = |error: String| TestCaseError::fail(format!("{error}\n{text}"));
    let (tree, original) = (varied.tree(), declared.tree());
    if tree.coordinates == 0 || !has_inertia(&original) || !has_inertia(&tree) {
        return Err(TestCaseError::reject("a coordinate without inertia"));
    }
    let derivation = derivation_of(&text).map_err(failed)?;
    let pair = Pair {
        derivation: &derivation,
        parameters: varied.parameters(),
        formulas: &|t| varied.formulas(t),
        force: &|_, u| u.to_vec(),
        tree,
    };
    pair.agrees(41, 6).map_err(failed)
}

fn has_inertia(tree: &Tree) -> bool {
    agreement::regularity(tree, 51) > 1e-4
}

/// The additions and multiplications of a function.
fn flops(derivation: &Derivation, function: FunctionKind) -> f64 {
    derivation.function(function).expect("generated for every mechanism").operations.flops() as f64
}

/// The chain of `n` links, and how many nodes of expressions it takes to derive it.
fn chain(n: usize) -> (Derivation, f64) {
    let source = source("n_chain").replace("const n = 5;", &format!("const n = {n};"));
    let (sources, graph) = (Sources::new("chain.mbs", &source), Graph::verbatim());
    let analysis = Analysis::of(&sources, &graph).unwrap_or_else(|e| panic!("{}", e.render_in(&sources)));
    let derivation = analysis.programs().clone();
    assert_eq!(derivation.dof(), n, "the chain's length is a constant of its file");
    (derivation, analysis.nodes() as f64)
}

/// Each further link costs the same in the equations of motion and in accelerations, and in M, and in the work of
/// deriving it, as much more as there are links before it.
#[test]
fn a_chain_grows_linearly() {
    let [five, ten, twenty, forty] = [5, 10, 20, 40].map(chain);
    let (equations, accelerations) =
        ([FunctionKind::InverseDynamics, FunctionKind::Bias], [FunctionKind::ForwardDynamics]);
    per_link_constant([&five.0, &ten.0, &twenty.0], &equations);
    per_link_constant([&ten.0, &twenty.0, &forty.0], &equations);
    // Of five links M is factorized; of ten, articulated bodies are cheaper.
    per_link_constant([&ten.0, &twenty.0, &forty.0], &accelerations);
    let mass_matrix = |chain: &(Derivation, f64)| flops(&chain.0, FunctionKind::MassMatrix);
    let nodes = |chain: &(Derivation, f64)| chain.1;
    for (what, count) in [("M", &mass_matrix as &dyn Fn(&(Derivation, f64)) -> f64), ("nodes", &nodes)] {
        // The parabola through three counts, at the fourth: Newton's divided differences.
        let [m5, m10, m20, m40] = [&five, &ten, &twenty, &forty].map(count);
        let (first, second) = ((m10 - m5) / 5.0, (m20 - m10) / 10.0);
        let expected = m5 + 35.0 * first + 35.0 * 30.0 * (second - first) / 15.0;
        assert!(m40 / expected <= 1.03, "{what} of forty links: {m40}, a parabola says {expected}");
        assert!(what == "nodes" || m40 / expected >= 0.97, "{what} of forty links: {m40}, a parabola says {expected}");
    }
}

/// Within 3 %, from the first to the second and from the second to the third.
fn per_link_constant(chains: [&Derivation; 3], functions: &[FunctionKind]) {
    for &function in functions {
        let slope =
            |a: &Derivation, b: &Derivation| (flops(b, function) - flops(a, function)) / (b.dof() - a.dof()) as f64;
        let (first, second) = (slope(chains[0], chains[1]), slope(chains[1], chains[2]));
        assert!((second / first - 1.0).abs() <= 0.03, "{function:?}: {first} a link, then {second}");
    }
}

/// What the benchmark arm costs at most, however it is declared: less than dynamics that a specialist customises by
/// hand. A rise is a mistake, a fall is to be written here.
#[test]
fn budget_of_the_benchmark_arm_as_bodies() {
    let budget = [
        (FunctionKind::InverseDynamics, 494),
        (FunctionKind::Bias, 456),
        (FunctionKind::MassMatrix, 253),
        (FunctionKind::ForwardDynamics, 871),
        (FunctionKind::CoriolisMatrix, 936),
        (FunctionKind::InverseDynamicsJacobian, 3006),
    ];
    let mut excess = String::new();
    for name in ["arm6", "arm6_params", "arm6_world"] {
        let derivation = derivation_of(source(name)).unwrap_or_else(|errors| panic!("{errors}"));
        for (function, most) in budget {
            let operations = derivation.function(function).expect("generated for every mechanism").operations;
            if operations.flops() > most || operations.sincos > 5 {
                excess += &format!("{name}: {function:?}: {operations:?}, budget {most}\n");
            }
        }
    }
    assert!(excess.is_empty(), "{excess}");
}

/// The operation counts of [`MECHANISMS`], as snapshots.
#[test]
fn operation_counts() {
    for (name, source) in MECHANISMS {
        let derivation = derivation_of(source).unwrap_or_else(|errors| panic!("{errors}"));
        let mut table =
            format!("{:28} {:>6} {:>6} {:>4} {:>4} {:>6} {:>5}\n", "", "add", "mul", "div", "sqrt", "sincos", "other");
        for function in &derivation.functions {
            let o = function.operations;
            let name = &function.name;
            table +=
                &format!("{name:28} {:6} {:6} {:4} {:4} {:6} {:5}\n", o.add, o.mul, o.div, o.sqrt, o.sincos, o.other);
        }
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path("../snapshots");
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(format!("{name}.operations"), table));
    }
}
