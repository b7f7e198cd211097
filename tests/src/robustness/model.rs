//! Models written from the grammar: `#![dimensionless]`, so that most of them mean something.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// What every model declares, for its statements to use.
const DECLARED: &str = "    param a: 1 = 2;
    param b[3]: 1 = [1, 0.5, 3];
    const n = 2;
    coord x: 1;
    coord q[2]: rad;
    input u: 1;
    prescribed s: 1 = sin(t);
    prescribed w: 1;
    fn f(p, r) = p*r + 1;
    let mut k = x;
    let mut place = [x, 0, a];
    let mut frame = rot_y(q[0]);
    kinetic += a*(dt(x)^2 + dt(q[0])^2 + dt(q[1])^2);
";

/// The text of a mechanism.
pub fn text() -> BoxedStrategy<String> {
    vec(statement(), 1..7)
        .prop_map(|statements| {
            format!("#![dimensionless]\nmechanism A {{\n{DECLARED}    {}\n}}\n", statements.join("\n    "))
        })
        .boxed()
}

fn statement() -> BoxedStrategy<String> {
    let loops = vec(simple(), 1..3).prop_map(|body| format!("for i in 0..n {{ {} }}", body.join(" ")));
    let filled = (position(), simple()).prop_map(|(value, chosen)| {
        format!(
            "let e[n]; for i in 0..n {{ e[i] = {value}; if i == 1 {{ {chosen} }} else if n != 2 {{ output z = e; }} \
             output o[i] = [e[i], x]; }}"
        )
    });
    let rods = (position(), position())
        .prop_map(|(left, right)| format!("for i in 0..n {{ constraint rod[i]: q[i] + {left} = {right}; }}"));
    prop_oneof![
        12 => simple(),
        2 => loops,
        1 => filled,
        1 => rods,
        1 => (scalar(), scalar()).prop_map(|(left, right)| format!("constraint c: {left} = {right};")),
        1 => (vector(), select(vec!["0", "[x, 0, 0]"])).prop_map(|(left, right)| format!("constraint d: {left} = {right};")),
        1 => scalar().prop_map(|value| format!("output y = {value}, jacobian_rate;")),
        1 => vector().prop_map(|value| format!("output v = {value};")),
        1 => pose().prop_map(|value| format!("output p = {value}, jacobian_rate;")),
    ].boxed()
}

/// What may stand in loops, too.
fn simple() -> BoxedStrategy<String> {
    let sums = select(vec!["kinetic", "potential", "potential", "dissipation", "lagrangian", "force x", "force q[1]"]);
    prop_oneof![
        4 => (sums, scalar()).prop_map(|(sum, value)| format!("{sum} += {value};")),
        2 => scalar().prop_map(|value| format!("k = {value};")),
        1 => vector().prop_map(|value| format!("place = {value};")),
        1 => pose().prop_map(|value| format!("frame = {value};")),
        2 => place().prop_map(|place| format!("kinetic += particle(1, {place});")),
        1 => pose().prop_map(|pose| format!("kinetic += rigid_body(1, [0, a, 0], diag(1, 2, 2), {pose});")),
        1 => (place(), vector()).prop_map(|(place, force)| format!("force at {place} += {force};")),
        1 => (pose(), vector()).prop_map(|(pose, torque)| format!("torque on {pose} += {torque};")),
    ]
    .boxed()
}

/// Coordinates, parameters and numbers, as they stand in places and angles.
fn position() -> BoxedStrategy<String> {
    let leaves = [
        "x", "q[0]", "q[1]", "a", "b[2]", "s", "w", "t", "k", "0", "1", "0.5", "2", "pi", "place.z", "1e-9", "1e9",
        "(20 deg)", "(3 g/m)",
    ];
    let leaf = select(leaves.map(str::to_string).to_vec());
    leaf.prop_recursive(3, 12, 2, |inner| {
        prop_oneof![
            6 => (inner.clone(), select(vec!["+", "-", "*", "/"]), inner.clone()).prop_map(|(l, o, r)| format!("({l} {o} {r})")),
            4 => (select(ELEMENTARY), inner.clone()).prop_map(|(f, x)| format!("{f}({x})")),
            2 => (inner.clone(), select(POWERS)).prop_map(|(x, n)| format!("({x})^{n}")),
            1 => (select(vec!["atan2", "hypot", "min", "max", "f"]), inner.clone(), inner.clone())
                .prop_map(|(f, l, r)| format!("{f}({l}, {r})")),
            1 => (inner.clone(), inner.clone(), inner.clone())
                .prop_map(|(l, r, x)| format!("(if {l} < {r} {{ {x} }} else {{ {l} }})")),
            1 => inner.prop_map(|x| format!("-{x}")),
        ]
    }).boxed()
}

const ELEMENTARY: &[&str] = &[
    "sin", "cos", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "ln", "sqrt", "abs",
    "signum",
];

const POWERS: &[&str] = &["2", "2", "3", "0", "1", "(-1)", "(-2)", "0.5", "1.5", "(1/3)", "100", "a"];

/// Anything that is a number.
fn scalar() -> BoxedStrategy<String> {
    let rate = position().prop_map(|x| format!("dt({x})"));
    let leaf = prop_oneof![
        4 => position(),
        2 => rate,
        1 => Just("u".to_string()),
        1 => vector().prop_map(|v| format!("({v}).norm_squared()")),
        1 => vector().prop_map(|v| format!("({v}).norm()")),
        1 => (vector(), vector()).prop_map(|(v, w)| format!("({v}).dot({w})")),
        1 => vector().prop_map(|v| format!("({v}).z")),
    ];
    (leaf.clone(), select(vec!["+", "-", "*", "*"]), leaf).prop_map(|(l, o, r)| format!("{l} {o} {r}")).boxed()
}

/// Three numbers that do not move too fast: places and directions.
fn components() -> BoxedStrategy<String> {
    (position(), position(), position()).prop_map(|(x, y, z)| format!("[{x}, {y}, {z}]")).boxed()
}

fn vector() -> BoxedStrategy<String> {
    prop_oneof![
        3 => components(),
        1 => Just("place".to_string()),
        1 => place().prop_map(|place| format!("dt({place})")),
        1 => pose().prop_map(|pose| format!("angular_velocity({pose})")),
        1 => (pose(), components()).prop_map(|(pose, v)| format!("{pose}*{v}")),
        1 => (components(), components()).prop_map(|(v, w)| format!("{v}.cross({w})")),
    ]
    .boxed()
}

fn place() -> BoxedStrategy<String> {
    prop_oneof![
        2 => components(),
        2 => (pose(), components()).prop_map(|(pose, v)| format!("({pose}).point({v})")),
        1 => pose().prop_map(|pose| format!("({pose}).origin()")),
        1 => Just("place".to_string()),
    ]
    .boxed()
}

fn pose() -> BoxedStrategy<String> {
    let turn =
        (select(vec!["rot_x", "rot_y", "rot_z"]), position()).prop_map(|(turn, angle)| format!("{turn}({angle})"));
    let leaf = prop_oneof![
        2 => Just("frame".to_string()),
        1 => Just("world".to_string()),
        4 => turn,
        2 => components().prop_map(|v| format!("translation({v})")),
        1 => position().prop_map(|angle| format!("rotation([1, 2, 0], {angle})")),
        1 => (position(), position()).prop_map(|(theta, d)| format!("dh({theta}, {d}, a, pi/2)")),
        1 => position().prop_map(|x| format!("quaternion(cos({x}), 0, sin({x}), 0)")),
    ];
    leaf.prop_recursive(2, 4, 2, |inner| {
        prop_oneof![
            4 => (inner.clone(), inner.clone()).prop_map(|(one, other)| format!("{one}*{other}")),
            1 => inner.prop_map(|pose| format!("({pose}).inverse()")),
        ]
    })
    .boxed()
}
