//! Whole pages, read again: every abbreviation, and every entry of M, C, G, Q and of the outputs, has the value that
//! the programs compute, at random states and parameters. The reader knows of a page its text and the values of the
//! declared symbols.

use std::collections::BTreeMap;
use std::path::Path;

use crate::derive::{Equations, routes};
use crate::expr::{Expr, Graph, Symbol, evaluate};
use crate::interpret::Interpreter;
use crate::latex::plan::parts;
use crate::latex::reader::Read;
use crate::latex::{composed, page};
use crate::model::Lagrangian;
use crate::numeric::Random;
use crate::optimise::{self, FunctionKind};
use crate::state::State;

/// Relative to the largest entry of the same matrix: entries that cancel are as exact as their terms.
const TOLERANCE: f64 = 1e-10;

/// A mechanism of the repository with what it imports in place; `None` in a package, which has none beside it.
fn source(name: &str) -> Option<String> {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let path = models.join("mechanisms").join(format!("{name}.mbs"));
    models.is_dir().then(|| {
        let sources = crate::read(&path).unwrap_or_else(|report| panic!("{report}"));
        crate::parse::in_one_text(&sources).unwrap_or_else(|errors| panic!("{}", errors.render_in(&sources)))
    })
}

/// Symbols of the page by their values.
struct Given {
    state: State,
    parameters: Vec<f64>,
}

impl Given {
    fn random(lagrangian: &Lagrangian<'_>, random: &mut Random) -> Self {
        let defaults: Vec<f64> =
            lagrangian.parameters.iter().flat_map(|p| &p.defaults).map(|number| number.to_f64()).collect();
        let n = lagrangian.dof();
        let count = |variables: &[crate::variable::Variable]| variables.iter().map(|v| v.count()).sum::<usize>();
        let prescribed = (0..count(&lagrangian.prescribed)).map(|_| [0, 1, 2].map(|_| 1.5 + random.symmetric()));
        let prescribed = prescribed.collect();
        let state = State {
            t: random.symmetric(),
            // Away from where coordinates of distance are zero.
            q: random.vector(n, 0.9).into_iter().map(|q| q + 1.1).collect(),
            qd: random.vector(n, 2.0),
            qdd: random.vector(n, 3.0),
            u: random.vector(count(&lagrangian.inputs), 5.0),
            prescribed,
        };
        Given { state, parameters: random.parameters_near(&defaults) }
    }

    fn value(&self, symbol: Symbol) -> f64 {
        let Given { state, parameters } = self;
        match symbol {
            Symbol::Time => state.t,
            Symbol::Coordinate(i) => state.q[i as usize],
            Symbol::Velocity(i) => state.qd[i as usize],
            Symbol::Acceleration(i) => state.qdd[i as usize],
            Symbol::Parameter(i) => parameters[i as usize],
            Symbol::Input(i) => state.u[i as usize],
            Symbol::Prescribed(i, order) => state.prescribed[i as usize][usize::from(order)],
            Symbol::Multiplier(_) => f64::NAN,
        }
    }
}

/// How much of a page has been compared.
#[derive(Debug, Default, PartialEq, Eq)]
struct Compared {
    abbreviations: usize,
    entries: usize,
}

fn compared(name: &str) -> Option<Compared> {
    Some(compared_text(&source(name)?))
}

fn compared_text(source: &str) -> Compared {
    let (verbatim, graph) = (Graph::verbatim(), Graph::new());
    let (lagrangian, _) =
        crate::declared(source, &verbatim, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
    let routes = routes(&lagrangian, &graph, Default::default());
    let page = composed(&lagrangian, &routes);
    let named = page.algebra.recursion.named.clone();
    let symbols: Vec<(String, Symbol)> = super::tests::symbols(&lagrangian, &routes[0])
        .into_iter()
        .map(|s| (page.algebra.notation.symbol(s), s))
        .collect();
    let text = page.finished();
    let derivation = optimise::straight_line(&lagrangian, &routes);
    let mut random = Random::new(17);
    let mut all = Compared::default();
    for _ in 0..3 {
        let given = Given::random(&lagrangian, &mut random);
        let values: BTreeMap<String, f64> = symbols.iter().map(|(name, s)| (name.clone(), given.value(*s))).collect();
        let read = Read::page(&text, &values);
        all = Compared::default();

        // Abbreviations, against the graph.
        let nodes: Vec<Expr<'_>> = named.iter().map(|(_, id, _)| graph.expr(*id)).collect();
        let expected = evaluate(&nodes, |symbol| given.value(symbol));
        for ((name, _, negative), expected) in named.iter().zip(expected) {
            let expected = if *negative { -expected } else { expected };
            let found = read.values[name];
            let scale = expected.abs().max(found.abs()).max(1e-6);
            assert!((found - expected).abs() <= TOLERANCE * scale, "{name}: {found}, not {expected}");
            all.abbreviations += 1;
        }

        // Matrices, against the programs.
        let interpreter = Interpreter::with_parameters(&derivation, given.parameters.clone());
        let kinds = [
            ("\\mathbf{M}", FunctionKind::MassMatrix),
            ("\\mathbf{C}", FunctionKind::CoriolisMatrix),
            ("\\mathbf{G}", FunctionKind::Gravity),
            ("\\mathbf{Q}", FunctionKind::GeneralizedForce),
        ];
        for (symbol, kind) in kinds {
            let expected = interpreter.call(kind, &given.state).unwrap_or_else(|| panic!("no {symbol}"));
            all.entries += same(&read, symbol, &expected);
        }
        for (name, kind) in [("T", FunctionKind::KineticEnergy), ("V", FunctionKind::PotentialEnergy)] {
            let expected = interpreter.call(kind, &given.state).unwrap_or_else(|| panic!("no {name}"))[0];
            assert!((read.values[name] - expected).abs() <= TOLERANCE * expected.abs(), "{name}");
            all.entries += 1;
        }
        all.entries += outputs(&routes[0], &read, &interpreter, &given);
    }
    all
}

/// Outputs and their Jacobians, part by part, against the programs.
fn outputs(equations: &Equations<'_>, read: &Read, interpreter: &Interpreter<'_>, given: &Given) -> usize {
    let mut entries = 0;
    for output in &equations.outputs {
        let computed = |name: &str| {
            let function = interpreter.derivation().named(name).unwrap_or_else(|| panic!("no {name}"));
            interpreter.evaluate(function, &given.state)
        };
        let suffixes = [
            Some(""),
            Some("_jacobian"),
            output.jacobian_qd.as_ref().map(|_| "_jacobian_qd"),
            output.jacobian_u.as_ref().map(|_| "_jacobian_u"),
        ];
        let functions = suffixes.into_iter().flatten().map(|suffix| format!("{}{suffix}", output.name));
        let mut expected = functions.flat_map(|function| computed(&function));
        for part in parts(output) {
            let count = part.rows.concat().len();
            let expected: Vec<f64> = expected.by_ref().take(count).collect();
            entries += same(read, &part.symbol, &expected);
        }
    }
    entries
}

fn same(read: &Read, symbol: &str, expected: &[f64]) -> usize {
    // What is zero is written as one zero, and one entry as a number.
    let number = || read.values.get(symbol).map(|&value| vec![value]);
    let found = read.matrices.get(symbol).cloned().or_else(number).unwrap_or_else(|| vec![0.0; expected.len()]);
    assert_eq!(found.len(), expected.len(), "{symbol}");
    let scale = expected.iter().fold(f64::MIN_POSITIVE, |largest, value| largest.max(value.abs()));
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= TOLERANCE * scale, "{symbol}, entry {i}: {found}, not {expected}");
    }
    expected.len()
}

#[test]
fn the_arm_is_what_its_programs_compute() {
    let Some(compared) = compared("irb7600") else { return };
    // M, C, G, τ, T and V; seven poses of 12 numbers with Jacobians of 36.
    assert_eq!(compared.entries, 36 + 36 + 6 + 6 + 2 + 7 * (12 + 36));
    assert!(compared.abbreviations > 300, "{compared:?}");
}

#[test]
fn the_platform_is_what_its_programs_compute() {
    let Some(compared) = compared("stewart_platform") else { return };
    assert_eq!(compared.entries, 36 + 36 + 6 + 6 + 2 + (12 + 36) + (6 + 36));
    assert!(compared.abbreviations > 500, "{compared:?}");
}

#[test]
fn the_quadrotor_is_what_its_programs_compute() {
    let Some(compared) = compared("quadrotor_euler") else { return };
    assert_eq!(compared.entries, 36 + 36 + 6 + 6 + 2 + (12 + 36));
}

/// `sin(q₂ − q₁)` is written as `−sin(q₁ − q₂)`, in sums of angles, too.
#[test]
fn differences_of_angles_are_written_with_their_sign() {
    let text = "#![dimensionless]
        mechanism Differences {
            coord q[5]: 1;
            for i in 0..5 { kinetic += 1/2*dt(q[i])^2; }
            output a = sin(q[1] - q[0])*cos(q[2]) + cos(q[1] - q[0])*sin(q[2]);
            output b = sin(q[2])*cos(q[1] - q[0]) - cos(q[2])*sin(q[1] - q[0]);
            output c = cos(q[2])*cos(q[1] - q[0]) - sin(q[2])*sin(q[1] - q[0]);
            output d = cos(q[2] + q[3])*cos(q[1] - q[0]) - sin(q[2] + q[3])*sin(q[1] - q[0]);
        }";
    assert_eq!(compared_text(text).entries, 25 + 25 + 5 + 5 + 2 + 4 * (1 + 5));
}

#[test]
fn orbits_are_what_their_programs_compute() {
    for name in ["relative_cylindrical", "relative_lvlh", "relative_isotropic", "kepler", "moving_frame", "scara"] {
        compared(name);
    }
}

#[test]
fn nothing_is_left_out_in_silence() {
    for name in [
        "irb7600",
        "stewart_platform",
        "quadrotor_euler",
        "relative_cylindrical",
        "relative_lvlh",
        "relative_isotropic",
    ] {
        let Some(source) = source(name) else { return };
        let (verbatim, graph) = (Graph::verbatim(), Graph::new());
        let (lagrangian, _) =
            crate::declared(&source, &verbatim, &[]).unwrap_or_else(|e| panic!("{}", e.render("", &source)));
        let text = page(&lagrangian, &routes(&lagrangian, &graph, Default::default()));
        for word in ["see below", "Too long", "dots &="] {
            assert!(!text.contains(word), "{name}: {word}");
        }
    }
}
