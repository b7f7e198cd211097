//! Mechanisms of many coordinates whose mass matrix is mostly zero: accelerations are statements without a solver, as
//! many as there are couplings. With many constraints the system is eliminated in an order chosen for its zeros.

use mbs_derive::emit::{Language, Options};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Completion, FunctionKind};
use mbs_derive::{Analysis, expr::Graph, source::Sources};

/// Masses in a row, each on springs between its neighbours.
fn springs(n: usize) -> String {
    format!(
        "mechanism Springs {{
            param m[{n}]: kg = 2; param k: N/m = 30; coord x[{n}]: m; input u: N;
            for i in 0..{n} {{ kinetic += m[i]*dt(x[i])^2/2; }}
            for i in 0..{} {{ potential += k*(x[i + 1] - x[i])^2/2; }}
            force x[0] += u;
        }}",
        n - 1
    )
}

/// Pendulums below a cart, whose mass matrix has entries in the first row, the first column and the diagonal.
fn cart(n: usize) -> String {
    format!(
        "mechanism Cart {{
            param m: kg = 2; param l: m = 0.5; param g: m/s^2 = 9.81; coord x: m; coord phi[{n}]: rad; input u: N;
            kinetic += 10 kg*dt(x)^2/2;
            for i in 0..{n} {{
                kinetic += m*(dt(x + l*sin(phi[i]))^2 + dt(l*cos(phi[i]))^2)/2;
                potential += -m*g*l*cos(phi[i]);
            }}
            force x += u;
        }}"
    )
}

/// Numbers without a pattern, within ±1.
fn numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| 2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0).collect()
}

fn with_analysis(text: &str, check: impl FnOnce(&Analysis<'_>)) {
    let graph = Graph::verbatim();
    check(&Analysis::of(&Sources::new("sparse.mbs", text), &graph).expect("a derivation"));
}

/// `mᵢ ẍᵢ = k (xᵢ₊₁ − 2 xᵢ + xᵢ₋₁)`, at the ends with one spring.
#[test]
fn masses_on_springs_are_accelerated_by_their_neighbours_alone() {
    let n = 40;
    with_analysis(&springs(n), |analysis| {
        let programs = analysis.programs();
        let accelerations = programs.function(FunctionKind::ForwardDynamics).expect("accelerations");
        assert_eq!(accelerations.completion, Completion::None);
        let operations = accelerations.operations;
        assert!(operations.flops() + operations.div <= 5 * n, "{operations:?}");
        let masses: Vec<f64> = numbers(n, 0.1).iter().map(|x| 2.0 + x).collect();
        let (k, q, qd, u) = (30.0, numbers(n, 0.2), numbers(n, 0.3), 0.7);
        let state = State { t: 0.0, q: q.clone(), qd, qdd: vec![0.0; n], u: vec![u], prescribed: Vec::new() };
        let parameters = masses.iter().copied().chain([k]).collect();
        let interpreter = Interpreter::with_parameters(programs, parameters);
        let found = interpreter.call(FunctionKind::ForwardDynamics, &state).expect("accelerations");
        for i in 0..n {
            let from = |j: usize| k * (q[j] - q[i]);
            let before = if i > 0 { from(i - 1) } else { u };
            let behind = if i + 1 < n { from(i + 1) } else { 0.0 };
            assert!((masses[i] * found[i] - before - behind).abs() < 1e-12, "{i}: {}", found[i]);
        }
        // M⁻¹ K is written out, too.
        let linearization = programs.function(FunctionKind::Linearize).expect("a linearization");
        assert_eq!(linearization.completion, Completion::None);
    });
}

/// `(M + n m) ẍ + m l Σ (φ̈ cos φ − φ̇² sin φ) = u`, `l φ̈ + ẍ cos φ + g sin φ = 0`: ẍ by hand, then each φ̈.
#[test]
fn pendulums_below_a_cart_are_eliminated_before_the_cart() {
    let n = 16;
    with_analysis(&cart(n), |analysis| {
        let programs = analysis.programs();
        let accelerations = programs.function(FunctionKind::ForwardDynamics).expect("accelerations");
        assert_eq!(accelerations.completion, Completion::None);
        let (m, l, g, u) = (2.0, 0.5, 9.81, -3.0);
        let angles: Vec<f64> = numbers(n, 0.4).iter().map(|x| 3.0 * x).collect();
        let rates = numbers(n, 0.6);
        let state = State {
            t: 0.0,
            q: [&[0.3], angles.as_slice()].concat(),
            qd: [&[-0.2], rates.as_slice()].concat(),
            qdd: vec![0.0; n + 1],
            u: vec![u],
            prescribed: Vec::new(),
        };
        let found = Interpreter::<f64>::new(programs).call(FunctionKind::ForwardDynamics, &state);
        let found = found.expect("accelerations");
        let sum = |term: &dyn Fn(f64, f64) -> f64| angles.iter().zip(&rates).map(|(&a, &w)| term(a, w)).sum::<f64>();
        let inertia = 10.0 + sum(&|angle, _| m * angle.sin().powi(2));
        let force = u + sum(&|angle, rate| m * angle.sin() * (l * rate * rate + g * angle.cos()));
        let cart = force / inertia;
        assert!((found[0] - cart).abs() < 1e-12, "{} instead of {cart}", found[0]);
        for (i, &angle) in angles.iter().enumerate() {
            let expected = -(cart * angle.cos() + g * angle.sin()) / l;
            assert!((found[i + 1] - expected).abs() < 1e-11, "{i}: {} instead of {expected}", found[i + 1]);
        }
    });
}

/// Of more than a hundred coordinates M is left out where it is mostly zero, but for a mechanism with outputs.
#[test]
fn outputs_of_many_masses_stay() {
    let without = springs(120);
    let with = without.replace("force x[0]", "output end = x[119]; force x[0]");
    let has = |text: &str, kind| {
        let mut found = false;
        with_analysis(text, |analysis| found = analysis.programs().function(kind).is_some());
        found
    };
    assert!(!has(&without, FunctionKind::MassMatrix) && has(&without, FunctionKind::ForwardDynamics));
    assert!(has(&with, FunctionKind::MassMatrix));
    with_analysis(&with, |analysis| assert!(analysis.programs().named("end").is_some()));
    // Nor for one of bodies that springs couple.
    let bodies = "mechanism Beads {
        const n = 120; coord x[n]: m;
        for i in 0..n { kinetic += particle(2 kg, [x[i], 0, 0]); }
        for i in 1..n { potential += 1/2*(3 N/m)*(x[i] - x[i - 1])^2; }
        output end = x[119];
    }";
    assert!(has(bodies, FunctionKind::MassMatrix) && has(bodies, FunctionKind::ForwardDynamics));
    with_analysis(bodies, |analysis| assert!(analysis.programs().named("end").is_some()));
}

/// Written out, each mass takes two lines; the full matrix alone would have 90 000 entries.
#[test]
fn three_hundred_masses_take_few_lines() {
    let options = Options::default().functions(["forward_dynamics"]);
    let text = springs(300).replace("m[300]", "m").replace("m[i]", "m");
    let code = mbs_derive::generate("springs.mbs", &text, &options).expect("a derivation").code;
    assert!(code.len() < 60_000, "{} bytes", code.len());
    assert!(!code.contains("ldlt_solve"));
}

/// A closed chain of links in a vertical plane, each with its place and angle, pinned to the ground where it begins and
/// ends.
fn ring(links: usize) -> String {
    format!(
        "mechanism Ring {{
            const n = {links};
            param m: kg = 0.1; param l: m = 0.2; param c: N*m*s = 0.01; const g: m/s^2 = 9.81;
            coord x[n]: m; coord y[n]: m; coord phi[n]: rad; input tau: N*m;
            fn end(x, y, phi, side) = [x + side*l/2*cos(phi), y + side*l/2*sin(phi), 0];
            for i in 0..n {{
                kinetic += particle(m, [x[i], y[i], 0]) + 1/2*(m*l^2/12)*dt(phi[i])^2;
                potential += m*g*y[i];
                dissipation += c*dt(phi[i])^2/2;
            }}
            force phi[0] += tau;
            constraint first: end(x[0], y[0], phi[0], -1) = 0;
            for i in 0..n-1 {{
                constraint pin[i]: end(x[i], y[i], phi[i], 1) = end(x[i+1], y[i+1], phi[i+1], -1);
            }}
            constraint last: end(x[n-1], y[n-1], phi[n-1], 1) = [n*l/2, 0, 0];
        }}"
    )
}

#[test]
fn a_closed_chain_is_eliminated_and_satisfies_its_equations() {
    let n = 99;
    with_analysis(&ring(n / 3), |analysis| {
        let programs = analysis.programs();
        let elimination = programs.elimination.as_ref().expect("an order");
        let (unknowns, k) = (elimination.order.len(), programs.constraints.len());
        assert_eq!((unknowns, k), (n + k, 2 * (n / 3 + 1)));
        // The factor grows with the number of links: not with the square of it.
        assert!(elimination.rows.len() < 6 * unknowns, "{} entries", elimination.rows.len());

        let state = State { q: numbers(n, 0.1), qd: numbers(n, 0.2), u: vec![0.3], ..State::default() };
        let ring = Interpreter::new(programs);
        let call = |kind| ring.call(kind, &state).expect("a function");
        let (qdd, multipliers) = (call(FunctionKind::ForwardDynamics), call(FunctionKind::Multipliers));
        let [m, h, d, q, a, bias] = [
            FunctionKind::MassMatrix,
            FunctionKind::Bias,
            FunctionKind::DissipationForce,
            FunctionKind::GeneralizedForce,
            FunctionKind::ConstraintJacobian,
            FunctionKind::ConstraintBias,
        ]
        .map(call);
        let forces = (0..n).map(|i| {
            let inertial: f64 = (0..n).map(|j| m[i * n + j] * qdd[j]).sum();
            let held: f64 = (0..k).map(|row| a[row * n + i] * multipliers[row]).sum();
            inertial + h[i] + d[i] - q[i] - held
        });
        let rows = (0..k).map(|row| (0..n).map(|j| a[row * n + j] * qdd[j]).sum::<f64>() + bias[row]);
        let left: Vec<f64> = forces.chain(rows).collect();
        assert!(left.iter().all(|left| left.abs() < 1e-10), "{left:?}");

        // Along a direction of places, speeds and the torque: the linearization against a difference.
        let direction = [numbers(n, 0.4), numbers(n, 0.5), vec![0.7]];
        let at = |step: f64| {
            let moved = |x: &[f64], by: &[f64]| x.iter().zip(by).map(|(x, by)| x + step * by).collect::<Vec<f64>>();
            let state = State {
                q: moved(&state.q, &direction[0]),
                qd: moved(&state.qd, &direction[1]),
                u: moved(&state.u, &direction[2]),
                ..State::default()
            };
            ring.call(FunctionKind::ForwardDynamics, &state).expect("accelerations")
        };
        let (slopes, after, before) = (call(FunctionKind::Linearize), at(1e-5), at(-1e-5));
        let along = |start: usize, by: &[f64], i: usize| -> f64 {
            slopes[start + i * by.len()..].iter().zip(by).map(|(slope, by)| slope * by).sum()
        };
        for i in 0..n {
            let found =
                along(0, &direction[0], i) + along(n * n, &direction[1], i) + along(2 * n * n, &direction[2], i);
            let expected = (after[i] - before[i]) / 2e-5;
            assert!((found - expected).abs() < 1e-5 * expected.abs().max(1.0), "{i}: {found} {expected}");
        }
    });
}

#[test]
fn other_languages_solve_a_closed_chain_in_full() {
    let options = Options::default().languages(Language::ALL);
    with_analysis(&ring(33), |analysis| {
        let emitted = analysis.rust(&options).unwrap_or_else(|error| panic!("{error:?}"));
        assert!(emitted.code.contains("sparse_solve(") && emitted.code.contains("sparse_slopes("));
        assert!(!emitted.code.contains("constrained_solve"));
        assert_eq!(emitted.others.len(), Language::ALL.len() - 1);
        assert!(emitted.others.iter().all(|(_, code)| !code.contains("sparse_solve")));
    });
}

/// The second row of each pair says the same as the first one where that holds, and something else elsewhere.
#[test]
fn rows_that_depend_on_others_wherever_they_hold_are_solved() {
    let n = 60;
    let twice = |second: &str| {
        format!(
            "#![dimensionless]
            mechanism Twice {{
                coord x[{n}]: 1; coord y[{n}]: 1;
                for i in 0..{n} {{
                    kinetic += (dt(x[i])^2 + dt(y[i])^2)/2;
                    potential += y[i];
                    constraint circle[i]: x[i]^2 + y[i]^2 = 1;
                    constraint other[i]: {second} = 0;
                }}
            }}"
        )
    };
    with_analysis(&twice("(x[i]^2 + y[i]^2 - 1)*(2 + x[i])"), |analysis| {
        let programs = analysis.programs();
        assert!(programs.elimination.is_some());
        // A bead at rest on the side of its circle falls.
        let q: Vec<f64> = (0..2 * n).map(|i| f64::from(u8::from(i < n))).collect();
        let state = State { q, qd: vec![0.0; 2 * n], ..State::default() };
        let beads = Interpreter::new(programs);
        let qdd = beads.call(FunctionKind::ForwardDynamics, &state).expect("accelerations");
        assert_eq!(beads.least_change(&state, &vec![0.0; 2 * n]), Some((vec![0.0; 2 * n], n)));
        assert!(
            qdd[..n].iter().all(|x| x.abs() < 1e-12) && qdd[n..].iter().all(|y| (y + 1.0).abs() < 1e-12),
            "{qdd:?}"
        );
    });
}

/// A chain of particles on rods that hangs at rest: nothing is accelerated, and rod i holds all that is below it,
/// `λ = −(n − i) m g/(2 l)` with rows `Δx² + Δy² = l²`.
#[test]
fn a_chain_that_hangs_at_rest_has_tensions() {
    for (n, l) in [(33, 0.1), (34, 0.1), (40, 0.125), (60, 1.0), (100, 0.1)] {
        let text = format!(
            "mechanism Hanging {{
                const n = {n}; const l: m = {l:?}; param m: kg = 0.3; param g: m/s^2 = 9.81;
                coord x[n]: m; coord y[n]: m;
                for i in 0..n {{ kinetic += m*(dt(x[i])^2 + dt(y[i])^2)/2; potential += m*g*y[i]; }}
                constraint top: x[0]^2 + y[0]^2 = l^2;
                for i in 1..n {{ constraint rod[i - 1]: (x[i] - x[i - 1])^2 + (y[i] - y[i - 1])^2 = l^2; }}
            }}"
        );
        with_analysis(&text, |analysis| {
            let programs = analysis.programs();
            assert_eq!(programs.elimination.is_some(), 3 * n > 100);
            let y = (1..=n).map(|i| -l * i as f64);
            let state =
                State { q: std::iter::repeat_n(0.0, n).chain(y).collect(), qd: vec![0.0; 2 * n], ..State::default() };
            let interpreter = Interpreter::<f64>::new(programs);
            let accelerations = interpreter.call(FunctionKind::ForwardDynamics, &state).expect("accelerations");
            // As much as is rounded of 9.81 times as many links.
            assert!(accelerations.iter().all(|a| a.abs() < 1e-11), "{n}: {accelerations:?}");
            let multipliers = interpreter.call(FunctionKind::Multipliers, &state).expect("multipliers");
            for (i, found) in multipliers.iter().enumerate() {
                let expected = -((n - i) as f64) * 0.3 * 9.81 / (2.0 * l);
                assert!((found - expected).abs() < 1e-10 * expected.abs(), "{n}, {i}: {found} {expected}");
            }
        });
    }
}

/// Of 65 unknowns rounding is bounded by pivots, and where these do not tell, in full.
#[test]
fn few_rows_beside_many_coordinates_are_proved() {
    let text = "mechanism Few {
        const n = 62; coord x[n]: m;
        for i in 0..n { kinetic += 1/2*1 kg*dt(x[i])^2; potential += 1/2*3 N/m*x[i]^2; }
        for i in 0..3 { constraint c[i]: x[i]^2/(1 m) + x[i + 1] = 0.1 m; }
    }";
    with_analysis(text, |analysis| {
        let proof = analysis.prove(analysis.programs());
        assert!(proof.is_ok(), "{proof:?}");
    });
}

/// Derivatives of long chains with constraints are loops over links that read multipliers.
#[test]
fn loops_of_links_read_multipliers() {
    let text = "mechanism Tied {
        const n = 12; coord q[n]: rad; param m: kg = 1; param l: m = 0.1;
        let mut joint = world.origin();
        for i in 0..n {
            let along = [l*sin(q[i]), 0, -l*cos(q[i])];
            kinetic += particle(m, joint + along/2) + 1/2*m*l^2/12*dt(q[i])^2;
            joint = joint + along;
        }
        constraint end: joint.x = l;
    }";
    with_analysis(text, |analysis| {
        let (programs, options) = (analysis.programs(), Options::default());
        let code = Language::Rust.write(programs, "tied.mbs", &options);
        let read = programs.proofread(Language::Rust, &options, &code);
        assert!(read.is_ok(), "{read:?}");
        assert!(code.contains("multipliers["), "no loop reads them");
    });
}
