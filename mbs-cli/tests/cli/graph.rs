//! The graph of `mbs derive --emit json`, evaluated by a reader that knows nothing but `docs/json.md`.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use serde_json::{Value, json};

use crate::{CHAIN, PENDULUM, Workshop};

/// Every operation, branches, a prescribed motion, and a constraint that moves.
const MACHINE: &str = "\
mechanism Machine {
    param m[2]: kg = [1.5, 2];
    param k: N/m = 5;
    param c: N = 0.3;
    param r: m = 0.7;
    coord x: m;
    coord y: m;
    coord theta: rad;
    prescribed lift: m;
    input f: N;
    kinetic += 1/2*m[0]*(dt(x)^2 + dt(y)^2) + 1/2*m[1]*r^2*dt(theta)^2*(1 + sin(theta)^2);
    potential += if x < r && -r < x { 1/2*k*(x - r)^2 } else { k*r*abs(x) };
    potential += k*r^2*(exp(-(x/r)^2) + cosh(y/r) + sinh(theta)/9 + ln(2 + cos(theta)) + atan2(y, r + x^2/r));
    potential += k*r^2*(tanh(x/r) + atan(y/r) + asin(sin(theta)/2) + acos(cos(theta)/3) + tan(theta/9));
    potential += k*r^2*(sqrt(1 + (x/r)^2) + (2 + sin(theta))^(1.3 + y/r*y/r));
    const creep: m/s = 0.001;
    dissipation += c*sqrt(dt(x)^2 + (r*dt(theta))^2 + (r/10*dt(theta))^2 + creep^2);
    force x += f - c*signum(dt(y));
    constraint guide: y = lift + r*sin(2*theta) + x/3;
}
";

/// As functions of other languages have them.
#[test]
fn time_and_signals_are_among_the_arguments() {
    let workshop = Workshop::new();
    workshop.write("machine.mbs", MACHINE);
    assert_eq!(report(&workshop, "machine.mbs")["functions"]["gravity"]["arguments"], json!(["prescribed", "q"]));
    workshop.write("driven.mbs", MACHINE.replace("force x += f", "force x += f*sin(t/(1 s))"));
    let arguments = &report(&workshop, "driven.mbs")["functions"]["forward_dynamics"]["arguments"];
    assert_eq!(*arguments, json!(["t", "prescribed", "q", "qd", "u"]));
}

#[test]
fn the_graph_gives_what_eval_gives() {
    let workshop = Workshop::new();
    workshop.write("machine.mbs", MACHINE);
    let pendulum = json!({ "q": [0.4], "qd": [-1.1], "qdd": [0.3], "u": [2.0] });
    let chain = json!({ "q": [0.4, -0.2], "qd": [1.0, 3.0], "qdd": [-0.3, 0.9] });
    let machine = |x: f64| {
        json!({ "t": 0.5, "q": [x, 0.2, 0.9], "qd": [-1.1, 0.3, 0.8], "qdd": [0.3, 0.1, -2.0], "u": [2.0],
            "prescribed": { "lift": [0.1, -0.2, 0.4] } })
    };
    let states = [
        ("pendulum.mbs", pendulum),
        ("chain.mbs", chain),
        ("machine.mbs", machine(0.6)),
        ("machine.mbs", machine(1.6)),
    ];
    for (model, state) in states {
        let report = report(&workshop, model);
        let expected = workshop.eval(model, &state.to_string());
        let values = evaluate(&report, &state);
        let along_motion = evaluate(&report, &with_motion(&report, &state, &values));
        for (name, function) in report["functions"].as_object().unwrap() {
            let of_eval = match name.as_str() {
                "linearize" => json!([expected[name]["q"], expected[name]["qd"], expected[name]["u"]]),
                "linearize_parameters" => expected["linearize"]["params"].clone(),
                _ if expected[name].is_null() => expected["outputs"][name].clone(),
                _ => expected[name].clone(),
            };
            let found = match function["completion"].as_str().unwrap() {
                "none" => roots(&report, name, &values),
                "solve constrained" => solved(&report, name, &along_motion, 0),
                "solve multipliers" => solved(&report, name, &values, report["coordinates"].as_array().unwrap().len()),
                other => panic!("{name}: docs/json.md does not know {other} of so few coordinates"),
            };
            let (found, expected) = (in_full(&function["returns"], found), numbers(&of_eval));
            // Momenta, velocities and Jacobians of outputs are not in eval.
            let elsewhere = ["momentum", "_velocity", "_jacobian"].iter().any(|end| name.ends_with(end));
            assert!(!expected.is_empty() || elsewhere || found.is_empty(), "{model}: {name}");
            if !expected.is_empty() {
                assert_eq!(found.len(), expected.len(), "{model}: {name}");
                let close = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-13 * b.abs().max(1.0));
                assert!(close, "{model}: {name}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn operands_come_first_and_nothing_is_said_twice() {
    let workshop = Workshop::new();
    workshop.write("machine.mbs", MACHINE);
    for model in ["pendulum.mbs", "chain.mbs", "machine.mbs"] {
        let report = report(&workshop, model);
        let nodes = report["graph"]["nodes"].as_array().unwrap();
        let mut seen = BTreeMap::new();
        for (i, node) in nodes.iter().enumerate() {
            assert_eq!(seen.insert(node.to_string(), i), None, "{model}: {node}");
            let operands = node["operands"].as_array().into_iter().flatten();
            assert!(operands.map(|operand| operand.as_u64().unwrap() as usize).all(|operand| operand < i), "{node}");
        }
        let used = |i: usize| {
            let roots = report["graph"]["roots"].as_object().unwrap().values();
            let operands = nodes.iter().filter_map(|node| node.get("operands"));
            roots.chain(operands).any(|list| list.as_array().unwrap().contains(&json!(i)))
        };
        assert!((0..nodes.len()).all(used), "{model}");
    }
    let names: Vec<String> = report(&workshop, "machine.mbs")["graph"]["nodes"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|node| node["name"].as_str().map(String::from))
        .collect();
    for name in ["m_0", "m_1", "theta", "theta_dot", "theta_ddot", "lift", "lift_ddot", "f"] {
        assert!(names.contains(&name.to_string()), "{name} is not in {names:?}");
    }
}

#[test]
fn constants_are_exact() {
    let workshop = Workshop::new();
    assert!(PENDULUM.contains("1/2") && CHAIN.contains("1/2"));
    let report = report(&workshop, "chain.mbs");
    let nodes = report["graph"]["nodes"].as_array().unwrap();
    assert!(nodes.contains(&json!({ "operation": "constant", "value": 0.5, "exact": "1/2" })), "{nodes:?}");
}

fn report(workshop: &Workshop, model: &str) -> Value {
    serde_json::from_str(&workshop.good(&["derive", model, "--emit", "json"])).unwrap()
}

/// The values of a function's roots.
fn roots(report: &Value, name: &str, values: &[f64]) -> Vec<f64> {
    let roots: Vec<usize> = serde_json::from_value(report["graph"]["roots"][name].clone()).unwrap();
    roots.iter().map(|&root| values[root]).collect()
}

/// The state with the accelerations and multipliers of the motion, which what is left to solve may ask for.
fn with_motion(report: &Value, state: &Value, values: &[f64]) -> Value {
    let mut state = state.clone();
    let has_constraints = !report["constraints"].as_array().unwrap().is_empty();
    if has_constraints {
        let n = report["coordinates"].as_array().unwrap().len();
        state["qdd"] = json!(solved(report, "forward_dynamics", values, 0));
        state["multipliers"] = json!(solved(report, "multipliers", values, n));
    }
    state
}

/// `M x − Aᵀ λ = f`, `A x = c` by the roots of a function: x of all parts, or the rows from `first` on.
fn solved(report: &Value, name: &str, values: &[f64], first: usize) -> Vec<f64> {
    let (n, k) = (report["coordinates"].as_array().unwrap().len(), report["constraints"].as_array().unwrap().len());
    let all = roots(report, name, values);
    let (mass, rest) = all.split_at(n * (n + 1) / 2);
    let (jacobian, mut right_sides) = rest.split_at(k * n);
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => mass[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)],
        (true, false) => -jacobian[(j - n) * n + i],
        (false, true) => jacobian[(i - n) * n + j],
        (false, false) => 0.0,
    };
    let bordered = DMatrix::from_fn(n + k, n + k, entry).lu();
    let mut found = Vec::new();
    for part in report["functions"][name]["returns"].as_array().unwrap() {
        let width = if part["shape"][0] == "matrix" { part["shape"][2].as_u64().unwrap() as usize } else { 1 };
        let (own, behind) = right_sides.split_at((n + k) * width);
        let solution = bordered.solve(&DMatrix::from_row_slice(n + k, width, own)).unwrap();
        let rows = if first == 0 { 0..n } else { first..n + k };
        found.extend(rows.flat_map(|i| solution.row(i).iter().copied().collect::<Vec<f64>>()));
        right_sides = behind;
    }
    found
}

/// The value of every node; conditions are 1 or 0.
fn evaluate(report: &Value, state: &Value) -> Vec<f64> {
    let parameters = report["parameters"].as_array().unwrap().iter();
    let parameters: Vec<f64> = parameters.flat_map(|parameter| numbers(&parameter["defaults"])).collect();
    let mut values: Vec<f64> = Vec::new();
    for node in report["graph"]["nodes"].as_array().unwrap() {
        let operands = node["operands"].as_array().into_iter().flatten();
        let a: Vec<f64> = operands.map(|operand| values[operand.as_u64().unwrap() as usize]).collect();
        let truth = |holds: bool| f64::from(u8::from(holds));
        values.push(match node["operation"].as_str().unwrap() {
            "constant" => node["value"].as_f64().unwrap(),
            "symbol" => symbol(&node["symbol"], state, &parameters, report),
            "neg" => -a[0],
            "add" => a[0] + a[1],
            "sub" => a[0] - a[1],
            "mul" => a[0] * a[1],
            "div" => a[0] / a[1],
            "sqrt" => a[0].sqrt(),
            "sin" => a[0].sin(),
            "cos" => a[0].cos(),
            "tan" => a[0].tan(),
            "asin" => a[0].asin(),
            "acos" => a[0].acos(),
            "atan" => a[0].atan(),
            "sinh" => a[0].sinh(),
            "cosh" => a[0].cosh(),
            "tanh" => a[0].tanh(),
            "sech" => 1.0 / a[0].cosh(),
            "exp" => a[0].exp(),
            "ln" => a[0].ln(),
            "abs" => a[0].abs(),
            "signum" if a[0] == 0.0 => 0.0,
            "signum" => a[0].signum(),
            "atan2" => a[0].atan2(a[1]),
            "powf" => a[0].powf(a[1]),
            "less" => truth(a[0] < a[1]),
            "less_equal" => truth(a[0] <= a[1]),
            "and" => truth(a[0] != 0.0 && a[1] != 0.0),
            "not" => truth(a[0] == 0.0),
            "select" if a[0] != 0.0 => a[1],
            "select" => a[2],
            other => panic!("docs/json.md does not know {other}"),
        });
    }
    values
}

fn symbol(symbol: &Value, state: &Value, parameters: &[f64], report: &Value) -> f64 {
    let index = symbol[1].as_u64().unwrap_or(0) as usize;
    match symbol[0].as_str().unwrap() {
        "t" => state["t"].as_f64().unwrap(),
        "parameter" => parameters[index],
        "prescribed" => {
            let name = report["prescribed"][index]["name"].as_str().unwrap();
            state["prescribed"][name][symbol[2].as_u64().unwrap() as usize].as_f64().unwrap()
        }
        kind @ ("q" | "qd" | "qdd" | "u") => state[kind][index].as_f64().unwrap(),
        // Where they are not known yet, nobody asks for what depends on them.
        "multiplier" => state["multipliers"][index].as_f64().unwrap_or(f64::NAN),
        other => panic!("docs/json.md does not know {other}"),
    }
}

/// Symmetric matrices in full.
fn in_full(returns: &Value, values: Vec<f64>) -> Vec<f64> {
    let shape = &returns[0]["shape"];
    if shape[0] != "symmetric" {
        return values;
    }
    let n = shape[1].as_u64().unwrap() as usize;
    let entry = |i: usize, j: usize| values[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    (0..n * n).map(|k| entry(k / n, k % n)).collect()
}

/// All numbers in a value, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(number) => number.as_f64().into_iter().collect(),
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        Value::Object(items) => items.values().flat_map(numbers).collect(),
        Value::Null | Value::Bool(_) | Value::String(_) => Vec::new(),
    }
}
