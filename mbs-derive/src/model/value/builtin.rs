//! The functions and methods of the language: two tables, then one Rust function an entry.

use crate::diagnostic::nearest;
use crate::expr::{Binary, Expr, Function, HalfInteger, Matrix, Number, Vector};
use crate::model::frame::{Edge, FrameId};
use crate::model::landmark::Motion;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::interpolation;
use crate::model::value::{Free, Point, Pose, Scalar, Shape, Tensor, Value, shared};
use crate::parse::syntax::{Name, Span};

/// Names that stand for values in every mechanism.
pub(in crate::model) const CONSTANTS: [&str; 4] = ["pi", "deg", "t", "world"];

/// One function or method.
pub(in crate::model) struct Builtin {
    pub(in crate::model) name: &'static str,
    /// As it is called; for messages.
    form: &'static str,
    /// How many arguments it may have; a method's receiver counts.
    arguments: &'static [usize],
    apply: Apply,
}

#[derive(Clone, Copy)]
enum Apply {
    /// A function of `f64`, argument and value plain numbers.
    Elementary(Function),
    /// Anything else.
    With(for<'d, 'g> fn(&mut Resolver<'d, 'g>, &Call<'_, 'g>) -> Resolved<Value<'g>>),
}

/// The arguments of a call, as many as the table says, and where it stands.
pub(in crate::model) struct Call<'c, 'g> {
    pub(in crate::model) arguments: &'c [Argument<'g>],
    pub(in crate::model) span: &'c Span,
}

const fn entry(name: &'static str, form: &'static str, arguments: &'static [usize], apply: Apply) -> Builtin {
    Builtin { name, form, arguments, apply }
}

use Apply::{Elementary, With};

#[rustfmt::skip]
pub(in crate::model) const FUNCTIONS: &[Builtin] = &[
    entry("dt",    "dt(x)",       &[1], With(rate)),
    entry("sin",   "sin(x)",      &[1], Elementary(Function::Sin)),
    entry("cos",   "cos(x)",      &[1], Elementary(Function::Cos)),
    entry("tan",   "tan(x)",      &[1], Elementary(Function::Tan)),
    entry("asin",  "asin(x)",     &[1], Elementary(Function::Asin)),
    entry("acos",  "acos(x)",     &[1], Elementary(Function::Acos)),
    entry("atan",  "atan(x)",     &[1], Elementary(Function::Atan)),
    entry("sinh",  "sinh(x)",     &[1], Elementary(Function::Sinh)),
    entry("cosh",  "cosh(x)",     &[1], Elementary(Function::Cosh)),
    entry("tanh",  "tanh(x)",     &[1], Elementary(Function::Tanh)),
    entry("exp",   "exp(x)",      &[1], Elementary(Function::Exp)),
    entry("ln",    "ln(x)",       &[1], Elementary(Function::Ln)),
    entry("abs",   "abs(x)",      &[1], With(abs)),
    entry("signum", "signum(x)",  &[1], With(signum)),
    entry("sqrt",  "sqrt(x)",     &[1], With(sqrt)),
    entry("atan2", "atan2(y, x)", &[2], With(atan2)),
    entry("hypot", "hypot(x, y)", &[2], With(hypot)),
    entry("min",   "min(a, b)",   &[2], With(min)),
    entry("max",   "max(a, b)",   &[2], With(max)),
    entry("clamp", "clamp(x, low, high)", &[3], With(clamp)),
    entry("dot",   "dot(a, b)",   &[2], With(dot)),
    entry("cross", "cross(a, b)", &[2], With(cross)),
    entry("rot_x", "rot_x(angle)", &[1], With(rot_x)),
    entry("rot_y", "rot_y(angle)", &[1], With(rot_y)),
    entry("rot_z", "rot_z(angle)", &[1], With(rot_z)),
    entry("rotation",    "rotation([x, y, z], angle)",  &[2], With(rotation)),
    entry("quaternion",  "quaternion(w, x, y, z)",      &[1, 4], With(quaternion)),
    entry("rpy",         "rpy(roll, pitch, yaw)",       &[3], With(rpy)),
    entry("translation", "translation([x, y, z])",      &[1, 3], With(translation)),
    entry("dh",          "dh(theta, d, a, alpha)",      &[4], With(dh)),
    entry("angular_velocity", "angular_velocity(pose)", &[1], With(angular_velocity)),
    entry("diag",        "diag(xx, yy, zz)",            &[1, 3], With(diagonal)),
    entry("inertia",     "inertia(xx, yy, zz, xy, xz, yz)", &[1, 3, 6], With(inertia)),
    entry("particle",    "particle(mass, position)",    &[2], With(particle)),
    entry("rigid_body",  "rigid_body(mass, com, inertia, pose)", &[4], With(rigid_body)),
    entry("table",          "table(x, xs, ys)",          &[3], With(interpolation::table)),
    entry("table_monotone", "table_monotone(x, xs, ys)", &[3], With(interpolation::monotone)),
    entry("table_spline",   "table_spline(x, xs, ys)",   &[3], With(interpolation::spline)),
];

/// Functions that came after mechanisms had been written: a `fn` may take their names.
pub(in crate::model) const REPLACEABLE: [&str; 4] = ["rpy", "table", "table_monotone", "table_spline"];

#[rustfmt::skip]
pub(in crate::model) const METHODS: &[Builtin] = &[
    entry("dot",          "a.dot(b)",               &[2], With(dot)),
    entry("cross",        "a.cross(b)",             &[2], With(cross)),
    entry("norm",         "v.norm()",               &[1], With(norm)),
    entry("norm_squared", "v.norm_squared()",       &[1], With(norm_squared)),
    entry("transpose",    "matrix.transpose()",     &[1], With(transpose)),
    entry("inverse",      "pose.inverse()",         &[1], With(inverse)),
    entry("point",        "pose.point([x, y, z])",  &[2], With(point)),
    entry("origin",       "pose.origin()",          &[1], With(origin)),
    entry("rotation",     "pose.rotation()",        &[1], With(rotation_matrix)),
];

/// How the function of this name is called, if there is one.
pub(in crate::model) fn form_of_function(name: &str) -> Option<&'static str> {
    FUNCTIONS.iter().find(|f| f.name == name).map(|f| f.form)
}

/// How the method of this name is called, if there is one.
pub(in crate::model) fn form_of_method(name: &str) -> Option<&'static str> {
    METHODS.iter().find(|f| f.name == name).map(|f| f.form)
}

/// The value of `name(arguments)`.
pub(in crate::model) fn function<'g>(
    resolver: &mut Resolver<'_, 'g>,
    name: &Name,
    arguments: Resolved<Vec<Argument<'g>>>,
    span: &Span,
) -> Resolved<Value<'g>> {
    let Some(function) = FUNCTIONS.iter().find(|f| f.name == name.text) else {
        return Err(unknown_function(resolver, name));
    };
    apply(resolver, function, name, &arguments?, span)
}

/// The value of `receiver.name(arguments)`.
pub(in crate::model) fn method<'g>(
    resolver: &mut Resolver<'_, 'g>,
    name: &Name,
    receiver: Resolved<Argument<'g>>,
    arguments: Resolved<Vec<Argument<'g>>>,
    span: &Span,
) -> Resolved<Value<'g>> {
    let Some(method) = METHODS.iter().find(|f| f.name == name.text) else {
        return Err(unknown_method(resolver, name));
    };
    let mut all = vec![receiver?];
    all.extend(arguments?);
    apply(resolver, method, name, &all, span)
}

fn apply<'g>(
    resolver: &mut Resolver<'_, 'g>,
    builtin: &Builtin,
    name: &Name,
    arguments: &[Argument<'g>],
    span: &Span,
) -> Resolved<Value<'g>> {
    if !builtin.arguments.contains(&arguments.len()) {
        return Err(wrong_count(resolver, builtin, name, arguments.len()));
    }
    match builtin.apply {
        Apply::With(apply) => apply(resolver, &Call { arguments, span }),
        Apply::Elementary(function) => {
            let what = format!("the argument of `{}`", builtin.name);
            let x = resolver.of_dimension(&arguments[0], &what, Dimension::ONE)?;
            if matches!(function, Function::Sin | Function::Cos | Function::Tan) {
                resolver.warn_of_degrees_in(x, &arguments[0].span);
            }
            Ok(Value::Scalar(Scalar::plain(x.call(function))))
        }
    }
}

fn wrong_count(resolver: &mut Resolver<'_, '_>, builtin: &Builtin, name: &Name, found: usize) -> Refused {
    let is_method = !FUNCTIONS.iter().any(|f| std::ptr::eq(f, builtin));
    let less = usize::from(is_method);
    let counts: Vec<String> = builtin.arguments.iter().map(|n| (n - less).to_string()).collect();
    let noun = if counts == ["1"] { "argument" } else { "arguments" };
    let (wanted, found) = (counts.join(" or "), found - less);
    let message =
        format!("`{}` takes {wanted} {noun}, {found} {} given", builtin.name, if found == 1 { "is" } else { "are" });
    resolver.refuse(&name.span, message, format!("write `{}`", builtin.form))
}

fn unknown_function(resolver: &mut Resolver<'_, '_>, name: &Name) -> Refused {
    let text = &name.text;
    if let Some(form) = form_of_method(text) {
        return resolver.refuse(&name.span, format!("`{text}` is a method"), format!("write `{form}`"));
    }
    if resolver.scope.get(text).is_some() || CONSTANTS.contains(&text.as_str()) {
        return resolver.refuse(&name.span, format!("`{text}` is not a function"), "write `*` for a product");
    }
    let in_sight = resolver.functions_in_sight();
    let own = in_sight.keys().copied();
    let known = FUNCTIONS.iter().chain(METHODS).map(|f| f.name);
    let help = match (elsewhere(text), nearest(text, own.chain(known))) {
        _ if resolver.functions.contains_key(text.as_str()) => {
            "it is a function of the mechanism, which imported files do not see".to_string()
        }
        (Some(form), _) => format!("did you mean `{form}`?"),
        (None, Some(meant)) => {
            let own = in_sight.get(meant).map(crate::model::names::function::Function::form);
            let form = own.or(form_of_function(meant).or(form_of_method(meant)).map(str::to_string));
            format!("did you mean `{}`?", form.as_deref().unwrap_or(meant))
        }
        (None, None) => format!("the functions are {}", list(FUNCTIONS)),
    };
    resolver.refuse(&name.span, format!("there is no function `{text}`"), help)
}

fn unknown_method(resolver: &mut Resolver<'_, '_>, name: &Name) -> Refused {
    let text = &name.text;
    let help = match (form_of_function(text), nearest(text, METHODS.iter().map(|f| f.name))) {
        (Some(form), _) => format!("it is a function: write `{form}`"),
        (None, Some(meant)) => format!("did you mean `{}`?", form_of_method(meant).unwrap_or(meant)),
        (None, None) => format!("the methods are {}", list(METHODS)),
    };
    resolver.refuse(&name.span, format!("there is no method `{text}`"), help)
}

/// What other languages call it, and how it is written here.
const ELSEWHERE: [(&[&str], &str); 21] = [
    (&["rotate_x", "rotation_x", "rotx", "Rx", "rx"], "rot_x(angle)"),
    (&["rotate_y", "rotation_y", "roty", "Ry", "ry"], "rot_y(angle)"),
    (&["rotate_z", "rotation_z", "rotz", "Rz", "rz"], "rot_z(angle)"),
    (&["translate", "trans", "transl", "shift"], "translation([x, y, z])"),
    (&["rotate", "axis_angle", "axang"], "rotation([x, y, z], angle)"),
    (&["quat"], "quaternion(w, x, y, z)"),
    (&["pow", "powi", "powf", "power"], "x^n"),
    (&["sqr", "square"], "x^2"),
    (&["cbrt"], "x^(1/3)"),
    (&["log", "log10", "loge"], "ln(x)"),
    (&["arcsin", "arsin"], "asin(x)"),
    (&["arccos", "arcos"], "acos(x)"),
    (&["arctan"], "atan(x)"),
    (&["arctan2", "atan_2"], "atan2(y, x)"),
    (&["sign", "sgn"], "signum(x)"),
    (&["fabs"], "abs(x)"),
    (&["der", "ddt", "diff", "derivative", "d_dt"], "dt(x)"),
    (&["length", "magnitude", "len"], "v.norm()"),
    (&["omega", "angular_vel"], "angular_velocity(pose)"),
    (&["radians", "deg2rad", "rad"], "x*deg"),
    (&["point_mass", "mass_point", "body"], "particle(mass, position)"),
];

/// How what other languages have under this name is written.
fn elsewhere(name: &str) -> Option<&'static str> {
    ELSEWHERE.iter().find(|(names, _)| names.contains(&name)).map(|(_, form)| *form)
}

fn list(builtins: &[Builtin]) -> String {
    let names: Vec<String> = builtins.iter().map(|f| format!("`{}`", f.name)).collect();
    names.join(", ")
}

// ---- numbers

fn rate<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    resolver.rate(&call.arguments[0])
}

fn abs<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let x = resolver.scalar(&call.arguments[0])?;
    Ok(Value::Scalar(Scalar::new(x.expr.call(Function::Abs), x.dimension)))
}

fn signum<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let x = resolver.scalar(&call.arguments[0])?;
    Ok(Value::Scalar(Scalar::plain(x.expr.call(Function::Signum))))
}

fn sqrt<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let x = resolver.scalar(&call.arguments[0])?;
    let dimension = resolver.bounded(x.dimension.power(1, 2), call.span)?;
    Ok(Value::Scalar(Scalar::new(x.expr.sqrt(), dimension)))
}

/// Two numbers of one dimension.
fn pair<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<(Expr<'g>, Expr<'g>, Dimension)> {
    let (a, b) = (resolver.scalar(&call.arguments[0]), resolver.scalar(&call.arguments[1]));
    let (a, b) = (a?, b?);
    match shared(a.fit(), b.fit()) {
        Some(dimension) => Ok((a.expr, b.expr, dimension)),
        None => {
            let message = format!("the arguments need equal dimensions, these are {} and {}", a.dimension, b.dimension);
            Err(resolver.refuse(call.span, message, ""))
        }
    }
}

fn atan2<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let (y, x, _) = pair(resolver, call)?;
    Ok(Value::Scalar(Scalar::plain(y.call2(Binary::Atan2, x))))
}

fn hypot<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let (x, y, dimension) = pair(resolver, call)?;
    Ok(Value::Scalar(Scalar::new((x.powi(2) + y.powi(2)).sqrt(), dimension)))
}

fn min<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [a, b] = call.arguments else { return Err(Refused) };
    resolver.smaller(a, b, call.span)
}

fn max<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [a, b] = call.arguments else { return Err(Refused) };
    resolver.larger(a, b, call.span)
}

/// `min(max(x, low), high)`
fn clamp<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [x, low, high] = call.arguments else { return Err(Refused) };
    let value = resolver.larger(x, low, call.span)?;
    resolver.smaller(&Argument { value, span: x.span.clone() }, high, call.span)
}

// ---- vectors

/// Two vectors in common axes, and the dimension of their product.
struct Aligned<'g> {
    a: Vector<'g>,
    b: Vector<'g>,
    frame: FrameId,
    dimension: Dimension,
}

fn aligned<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Aligned<'g>> {
    let (a, b) = (resolver.vector(&call.arguments[0]), resolver.vector(&call.arguments[1]));
    let (a, b) = (a?, b?);
    let dimension = resolver.bounded(a.dimension.times(b.dimension), call.span)?;
    let (a, b, frame) = resolver.aligned(a, b);
    Ok(Aligned { a, b, frame, dimension })
}

fn dot<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let Aligned { a, b, dimension, .. } = aligned(resolver, call)?;
    let product = resolver.lagrangian.product_of_velocities(a, b).unwrap_or_else(|| a.dot(b));
    resolver.lagrangian.landmarks.note_product(a, b, product);
    Ok(Value::Scalar(Scalar::new(product, dimension)))
}

fn cross<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let Aligned { a, b, frame, dimension } = aligned(resolver, call)?;
    Ok(Value::Vector(Free { components: a.cross(b), frame, dimension }))
}

/// `v·v`
fn square_of<'g>(resolver: &Resolver<'_, 'g>, v: Vector<'g>) -> Expr<'g> {
    resolver.lagrangian.product_of_velocities(v, v).unwrap_or_else(|| v.norm_squared())
}

fn norm_squared<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let v = resolver.vector(&call.arguments[0])?;
    let dimension = resolver.bounded(v.dimension.power(2, 1), call.span)?;
    let square = square_of(resolver, v.components);
    resolver.lagrangian.landmarks.note_product(v.components, v.components, square);
    Ok(Value::Scalar(Scalar::new(square, dimension)))
}

fn norm<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let v = resolver.vector(&call.arguments[0])?;
    let square = square_of(resolver, v.components);
    resolver.lagrangian.landmarks.note_product(v.components, v.components, square);
    Ok(Value::Scalar(Scalar::new(square.sqrt(), v.dimension)))
}

// ---- poses

fn pose<'g>(edges: impl IntoIterator<Item = Option<Edge<'g>>>) -> Resolved<Value<'g>> {
    Ok(Value::Pose(Pose { base: FrameId::WORLD, edges: edges.into_iter().flatten().collect() }))
}

fn turn<'g>(resolver: &mut Resolver<'_, 'g>, axis: usize, angle: &Argument<'g>) -> Resolved<Option<Edge<'g>>> {
    let axis = Vector::unit(resolver.graph, axis);
    let expr = resolver.of_dimension(angle, "an angle", Dimension::ONE)?;
    resolver.warn_of_degrees_in(expr, &angle.span);
    resolver.edge(Edge::Rotation { axis, angle: expr }, &angle.span)
}

fn rot_x<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    pose([turn(resolver, 0, &call.arguments[0])?])
}

fn rot_y<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    pose([turn(resolver, 1, &call.arguments[0])?])
}

fn rot_z<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    pose([turn(resolver, 2, &call.arguments[0])?])
}

fn rotation<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [axis, angle] = call.arguments else { return Err(Refused) };
    if let Some(unit) = resolver.axis_of_parameters(axis)? {
        let expr = resolver.of_dimension(angle, "an angle", Dimension::ONE)?;
        resolver.warn_of_degrees_in(expr, &angle.span);
        return pose([resolver.edge(Edge::Rotation { axis: unit, angle: expr }, &angle.span)?]);
    }
    let numbers = constant_axis(resolver, axis);
    let expr = resolver.of_dimension(angle, "an angle", Dimension::ONE);
    let (numbers, expr) = (numbers?, expr?);
    resolver.warn_of_degrees_in(expr, &angle.span);
    // Turning about −x by an angle is turning about x by its negative.
    let single = numbers.iter().filter(|n| !n.is_zero()).count() == 1;
    let reversed = single && numbers.iter().any(|n| n.is_negative());
    let component = |n: Number| resolver.graph.constant(if reversed { -n } else { n });
    let unit = Vector(numbers.map(component));
    pose([resolver.edge(Edge::Rotation { axis: unit, angle: if reversed { -expr } else { expr } }, &angle.span)?])
}

/// For `|q| = 1`, which is the user's to keep: by a constraint, where coordinates are among them.
fn quaternion<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let part = |resolver: &mut Resolver<'_, 'g>, argument| {
        resolver.of_dimension(argument, "a component of a quaternion", Dimension::ONE)
    };
    let single = resolver.spread(call, 4, "a quaternion is an array of 4 numbers, the scalar part first")?;
    let [w, x, y, z] = single.as_deref().unwrap_or(call.arguments) else { return Err(Refused) };
    let parts = [part(resolver, w), part(resolver, x), part(resolver, y), part(resolver, z)];
    let [w, x, y, z] = parts;
    let parts = [w?, x?, y?, z?];
    let numbers: Option<Vec<f64>> = parts.iter().map(|p| resolver.facts.constant(*p).map(Number::to_f64)).collect();
    let squared = numbers.map(|numbers| numbers.iter().map(|n| n * n).sum::<f64>());
    if let Some(squared) = squared.filter(|squared| (squared - 1.0).abs() > 1e-9) {
        let message = format!("a rotation is a quaternion of length 1, this has length {}", squared.sqrt());
        return Err(resolver.refuse(call.span, message, "divide its components by its length"));
    }
    pose([resolver.edge(Edge::Quaternion(parts), call.span)?])
}

/// Roll, pitch and yaw about fixed axes, as in URDF: `Rz(yaw) · Ry(pitch) · Rx(roll)`.
fn rpy<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [roll, pitch, yaw] = call.arguments else { return Err(Refused) };
    let turns = [turn(resolver, 2, yaw), turn(resolver, 1, pitch), turn(resolver, 0, roll)];
    let [yaw, pitch, roll] = turns;
    pose([yaw?, pitch?, roll?])
}

/// A unit vector of constants, exact where its length is rational.
fn constant_axis<'g>(resolver: &mut Resolver<'_, 'g>, axis: &Argument<'g>) -> Resolved<[Number; 3]> {
    let vector = resolver.vector(axis)?;
    if vector.frame != FrameId::WORLD {
        let message = "an axis is given in the axes of the pose that is turned";
        return Err(resolver.refuse(&axis.span, message, "write its components: `[x, y, z]`"));
    }
    let mut numbers = [Number::ZERO; 3];
    for (number, component) in numbers.iter_mut().zip(vector.components.0) {
        let Some(value) = resolver.facts.constant(component) else {
            let help = "compose rotations about constant axes: `rot_z(a) * rot_x(b)`";
            return Err(resolver.refuse(&axis.span, "an axis must be constant", help));
        };
        *number = value;
    }
    let squared = numbers.iter().map(|&n| n * n).reduce(|a, b| a + b).unwrap_or(Number::ZERO);
    match squared.power(HalfInteger::halves(-1).to_halves()) {
        Some(inverse) if squared.to_f64() > 0.0 => Ok(numbers.map(|n| n * inverse)),
        _ => Err(resolver.refuse(&axis.span, "an axis must have a direction, this is zero", "")),
    }
}

fn translation<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let vector = match call.arguments {
        [by] => resolver.vector(by)?,
        several => {
            let values = several.iter().map(|a| a.value.clone()).collect();
            let value = resolver.array(values, call.span)?;
            resolver.vector(&Argument { value, span: call.span.clone() })?
        }
    };
    let span = &call.arguments[0].span;
    resolver.check_dimension(vector.fit(), "a translation", Dimension::LENGTH, span)?;
    let shift = resolver.in_world(vector);
    pose([resolver.edge(Edge::Translation(shift), span)?])
}

/// Denavit & Hartenberg, standard form: `Rz(θ) · T(a, 0, d) · Rx(α)`.
fn dh<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [theta, d, a, alpha] = call.arguments else { return Err(Refused) };
    let first = turn(resolver, 2, theta);
    let along_z = resolver.of_dimension(d, "the offset d", Dimension::LENGTH);
    let along_x = resolver.of_dimension(a, "the length a", Dimension::LENGTH);
    let last = turn(resolver, 0, alpha);
    let shift = Vector([along_x?, resolver.graph.integer(0), along_z?]);
    pose([first?, resolver.edge(Edge::Translation(shift), &(d.span.start..a.span.end))?, last?])
}

fn inverse<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    match &call.arguments[0].value {
        Value::Pose(pose) => resolver.inverse(pose, call.span).map(Value::Pose),
        _ => Err(resolver.wrong_shape(&call.arguments[0], Shape::Pose)),
    }
}

fn point<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [pose, place] = call.arguments else { return Err(Refused) };
    let frame = resolver.frame(pose)?;
    let vector = resolver.components_in(place, frame, "this vector")?;
    resolver.check_dimension(vector.fit(), "a place", Dimension::LENGTH, &place.span)?;
    resolver.point_at(vector.components, frame, &place.span).map(Value::Point)
}

fn origin<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let frame = resolver.frame(&call.arguments[0])?;
    Ok(Value::Point(Point { coordinates: Vector::zero(resolver.graph), frame }))
}

fn rotation_matrix<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let frame = resolver.frame(&call.arguments[0])?;
    // In its own axes on the left and those of the world on the right it is the unit matrix.
    let entries = Matrix::identity(resolver.graph);
    let axes = Some((frame, FrameId::WORLD));
    Ok(Value::matrix(Tensor { entries, axes, dimension: Dimension::ONE }))
}

fn angular_velocity<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let frame = resolver.frame(&call.arguments[0])?;
    let components = resolver.lagrangian.frames.get(frame).angular_velocity;
    let tensor = Matrix::identity(resolver.graph);
    resolver.lagrangian.landmarks.note_motion(components, Motion::Turning { tensor, frame });
    let dimension = resolver.dimension(Dimension::ANGULAR_VELOCITY);
    Ok(Value::Vector(Free { components, frame, dimension }))
}

// ---- matrices and bodies

/// Numbers that share a dimension.
fn entries<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<(Vec<Expr<'g>>, Dimension)> {
    let mut common = (Dimension::ONE, true);
    let mut exprs = Vec::new();
    for argument in call.arguments {
        let entry = resolver.scalar(argument)?;
        let Some(dimension) = shared(common, entry.fit()) else {
            let message =
                format!("the entries of a matrix share one dimension, these are {} and {}", common.0, entry.dimension);
            return Err(resolver.refuse(&argument.span, message, ""));
        };
        common = (dimension, common.1 && entry.fit().1);
        exprs.push(entry.expr);
    }
    Ok((exprs, common.0))
}

fn diagonal<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let single = resolver.spread(call, 3, "a diagonal is an array of 3 numbers")?;
    let arguments = single.as_deref().unwrap_or(call.arguments);
    let (entries, dimension) = entries(resolver, &Call { arguments, span: call.span })?;
    let &[x, y, z] = entries.as_slice() else { return Err(Refused) };
    Ok(Value::matrix(Tensor::plain(Matrix::diagonal([x, y, z]), dimension)))
}

fn inertia<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    if let [whole] = call.arguments
        && whole.value.shape() == Shape::Matrix
    {
        return resolver.matrix(whole).map(Value::matrix);
    }
    let single = resolver.spread_inertia(call)?;
    let arguments = single.as_deref().unwrap_or(call.arguments);
    let (entries, dimension) = entries(resolver, &Call { arguments, span: call.span })?;
    match *entries.as_slice() {
        [x, y, z] => Ok(Value::matrix(Tensor::plain(Matrix::diagonal([x, y, z]), dimension))),
        [xx, yy, zz, xy, xz, yz] => {
            let entries = Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
            Ok(Value::matrix(Tensor::plain(entries, dimension)))
        }
        _ => Err(Refused),
    }
}

fn transpose<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let matrix = resolver.matrix(&call.arguments[0])?;
    let axes = matrix.axes.map(|(rows, columns)| (columns, rows));
    Ok(Value::matrix(Tensor { entries: matrix.entries.transpose(), axes, ..matrix }))
}

fn particle<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [mass, position] = call.arguments else { return Err(Refused) };
    resolver.particle(mass, position)
}

fn rigid_body<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let [mass, com, inertia, pose] = call.arguments else { return Err(Refused) };
    resolver.rigid_body(mass, com, inertia, pose)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::check::trial::{mechanism, near, refused, same, value, value_with_unit};

    #[test]
    fn the_tables_agree_with_themselves() {
        for function in FUNCTIONS {
            assert!(function.form.starts_with(&format!("{}(", function.name)), "{}", function.form);
        }
        for method in METHODS {
            assert!(method.form.contains(&format!(".{}(", method.name)), "{}", method.form);
        }
        for function in Function::ALL {
            assert!(form_of_function(function.name()).is_some(), "{}", function.name());
        }
    }

    #[test]
    fn functions_of_numbers() {
        let check = |expression: &str, expected: f64| near(&value("", expression), &[expected], expression);
        check("sin(theta)", 0.4f64.sin());
        check("atan2(y, x)", (-0.7f64).atan2(0.3));
        check("hypot(3*x, 4*x)", 1.5);
        check("tanh(theta) + ln(m/(m/2)) + exp(0)", 0.4f64.tanh() + 2f64.ln() + 1.0);
        assert_eq!(value_with_unit("", "abs(y)"), (vec![0.7], "m".to_string()));
        assert_eq!(value_with_unit("", "signum(y)"), (vec![-1.0], "1".to_string()));
        refused(
            "let a = sin(x);",
            "x: the argument of `sin` must be a plain number, this is m; divide by a quantity of the same dimension",
        );
        refused("let a = atan2(y, m);", "atan2(y, m): the arguments need equal dimensions, these are m and kg");
        refused(
            "let a = sin([x, y, z]/l);",
            "[x, y, z]/l: expected a number, found a vector; of a vector, `.x`, `.norm()` and `.dot(v)` are numbers",
        );
    }

    #[test]
    fn wrong_calls_are_shown_the_right_form() {
        refused("let a = atan2(x);", "atan2: `atan2` takes 2 arguments, 1 is given; write `atan2(y, x)`");
        refused("let a = sin();", "sin: `sin` takes 1 argument, 0 are given; write `sin(x)`");
        refused("let a = [x, y, z].norm(2);", "norm: `norm` takes 0 arguments, 1 is given; write `v.norm()`");
        refused(
            "let a = inertia(m, m);",
            "inertia: `inertia` takes 1 or 3 or 6 arguments, 2 are given; write `inertia(xx, yy, zz, xy, xz, yz)`",
        );
        refused("let a = sine(x);", "sine: there is no function `sine`; did you mean `sin(x)`?");
        refused("let a = norm([x, y, z]);", "norm: `norm` is a method; write `v.norm()`");
        refused("let a = theta.sin();", "sin: there is no method `sin`; it is a function: write `sin(x)`");
        refused(
            "let a = [x, y, z].norm_sqared();",
            "norm_sqared: there is no method `norm_sqared`; did you mean `v.norm_squared()`?",
        );
        refused("let a = m(l + x);", "m: `m` is not a function; write `*` for a product");
        refused(
            "let a = x.origin();",
            "x: expected a pose, found a number; poses are made by `rot_z(angle)`, `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
        );
    }

    #[test]
    fn rotations_turn_by_the_right_hand() {
        near(&value("", "rot_x(pi/2) * [1, 2, 3]"), &[1.0, -3.0, 2.0], "about x");
        near(&value("", "rot_y(pi/2) * [1, 2, 3]"), &[3.0, 2.0, -1.0], "about y");
        near(&value("", "rot_z(pi/2) * [1, 2, 3]"), &[-2.0, 1.0, 3.0], "about z");
        same("", "rotation([0, 0, 2], theta)", "rot_z(theta)");
        same("", "rotation([0, -1, 0], theta)", "rot_y(-theta)");
        same("", "rotation([1, 1, 1], 2*pi/3) * [1, 2, 3]", "[3, 1, 2]");
        same("", "rotation([1, 0, 0]*0 + [2, 3, 6], theta) * [2, 3, 6]", "[2, 3, 6]");
        refused("let a = rotation([0, 0, 0], theta);", "[0, 0, 0]: an axis must have a direction, this is zero");
        refused(
            "let a = rotation([x, y, z], theta);",
            "[x, y, z]: an axis must be constant; compose rotations about constant axes: `rot_z(a) * rot_x(b)`",
        );
        refused(
            "let a = rot_z(x);",
            "x: an angle must be a plain number, this is m; divide by a quantity of the same dimension",
        );
        refused(
            "let a = translation([1, 2, 3]);",
            "[1, 2, 3]: a translation must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
    }

    /// URDF: fixed axes, x first.
    #[test]
    fn roll_pitch_and_yaw() {
        same("", "rpy(theta, q[0], q[1])", "rot_z(q[1]) * rot_y(q[0]) * rot_x(theta)");
        near(&value("", "rpy(pi/2, 0, pi/2) * [0, 1, 0]"), &[0.0, 0.0, 1.0], "y is turned up by the roll");
        same("fn rpy(x) = 2*x;", "rpy(x)", "2*x");
    }

    #[test]
    fn arrays_for_several_arguments() {
        let e = "let e = [cos(theta/2), 2/7*sin(theta/2), 3/7*sin(theta/2), 6/7*sin(theta/2)];";
        same(e, "quaternion(e)", "rotation([2, 3, 6], theta)");
        same("let j = [1, 2, 3, 4, 5, 6];", "inertia(j)", "inertia(1, 2, 3, 4, 5, 6)");
        same("const j[3] = [1, 2, 3];", "inertia(j)", "diag(1, 2, 3)");
        same("const j[3] = [1, 2, 3];", "diag(j)", "diag(1, 2, 3)");
        same("let j = [[1, 0, 2], [0, 3, 0], [2, 0, 4]];", "inertia(j)", "[[1, 0, 2], [0, 3, 0], [2, 0, 4]]");
        refused(
            "let a = quaternion([1, 0, 0]);",
            "[1, 0, 0]: a quaternion is an array of 4 numbers, the scalar part first; this is a vector",
        );
        refused(
            "let a = inertia([1, 2, 3, 4]);",
            "[1, 2, 3, 4]: an inertia is an array of 3 or 6 numbers, or a matrix; this is an array of 4",
        );
    }

    #[test]
    fn axes_of_parameters() {
        let text = |axis: &str| {
            format!(
                "mechanism A {{ param a[3]: m = [2, 3, 6]; param j: kg*m^2 = 2; coord theta: rad; coord psi: rad; \
                 let first = rotation({axis}, theta); let second = first * rot_x(psi); \
                 kinetic += rigid_body(0*j/a[0]^2, [0, 0, 0], diag(1, 2, 2.5)*j, second); \
                 output w = angular_velocity(second); output r = second.rotation(); }}"
            )
        };
        let all = |axis: &str| {
            crate::model::check::trial::resolved(&text(axis), |result| {
                let (lagrangian, _) = result.unwrap_or_else(|e| panic!("{}", e.render("a", &text(axis))));
                let exprs: Vec<Expr<'_>> = lagrangian.kinetic.clone();
                let graph = crate::expr::Graph::new();
                let along = |symbol| crate::model::check::singular::along_the_motion(&graph, symbol);
                crate::expr::evaluate(&crate::expr::carry_out(&exprs, &graph, along), |symbol| match symbol {
                    crate::expr::Symbol::Coordinate(i) => [0.4, -0.9][i as usize],
                    crate::expr::Symbol::Velocity(i) => [1.7, 0.8][i as usize],
                    crate::expr::Symbol::Parameter(i) => [2.0, 3.0, 6.0, 2.0][i as usize],
                    _ => f64::NAN,
                })
            })
        };
        near(&all("a"), &all("[2, 3, 6]"), "an axis of parameters is that of their values");
        let generated = crate::generate("a", &text("a"), &Default::default());
        assert!(generated.is_ok(), "{}", generated.unwrap_err().render("a", &text("a")));
        refused(
            "param a[3]: m = 0; let p = rotation(a, theta);",
            "a: an axis must have a direction, by the default values of the parameters this is zero; choose another default, such as `[0, 0, 1]`",
        );
    }

    #[test]
    fn quaternions() {
        let half = "let w = cos(theta/2); let s = sin(theta/2);";
        same(half, "quaternion(w, s, 0, 0)", "rot_x(theta)");
        same(half, "quaternion(w, 0, 0, s) * rot_x(q[0])", "rot_z(theta) * rot_x(q[0])");
        same(half, "quaternion(w, 2*s/7, 3*s/7, 6*s/7)", "rotation([2, 3, 6], theta)");
        same(
            half,
            "angular_velocity(quaternion(w, 2*s/7, 3*s/7, 6*s/7))",
            "angular_velocity(rotation([2, 3, 6], theta))",
        );
        same(
            half,
            "angular_velocity(rot_x(q[1]) * quaternion(w, 2*s/7, 3*s/7, 6*s/7) * rot_y(q[0]))",
            "angular_velocity(rot_x(q[1]) * rotation([2, 3, 6], theta) * rot_y(q[0]))",
        );
        same(half, "quaternion(w, s, 0, 0).inverse() * quaternion(w, s, 0, 0)", "world");
        same("", "quaternion(1, 0, 0, 0)", "world");
        same("", "quaternion(0.6, 0, 0.8, 0) * [x, y, z]", "rotation([0, 1, 0], 2*acos(0.6)) * [x, y, z]");
        refused(
            "let a = quaternion(1, 0, 0, 2);",
            "quaternion(1, 0, 0, 2): a rotation is a quaternion of length 1, this has length 2.23606797749979; divide its components by its length",
        );
        refused(
            "let a = quaternion(1, 0, 0, x);",
            "x: a component of a quaternion must be a plain number, this is m; divide by a quantity of the same dimension",
        );
        refused(
            "let a = quaternion(1, 0, 0, u/(k*l));",
            "quaternion(1, 0, 0, u/(k*l)): a pose cannot depend on an input; the rate of an input is not known: make it a coordinate or a formula of `t`",
        );
    }

    #[test]
    fn a_rational_axis_is_exact() {
        mechanism("output r = rotation([2, 3, 6], theta);", |lagrangian| {
            let Some(Edge::Rotation { axis, .. }) = lagrangian.frames.iter().last().unwrap().edge else {
                panic!("turned")
            };
            let seventh = |n| Number::rational(n, 7);
            assert_eq!(axis.0.map(|e| e.as_constant()), [seventh(2), seventh(3), seventh(6)]);
        });
    }

    #[test]
    fn denavit_hartenberg() {
        let lengths = "const d: m = 2; const a: m = 3;";
        same(
            lengths,
            "dh(theta, d, a, q[0])",
            "rot_z(theta) * translation([0, 0, d]) * translation([a, 0, 0]) * rot_x(q[0])",
        );
        near(&value(lengths, "dh(90*deg, d, a, -90*deg).point([d, a, a])"), &[-3.0, 5.0, -1.0], "of constants");
        // What does nothing is no frame.
        let edges = |pose: &str| mechanism(&format!("{lengths} output r = {pose};"), |l| l.frames.iter().count() - 1);
        assert_eq!(edges("dh(theta, d, a, pi/2)"), 3);
        assert_eq!(edges("dh(theta, 0, 0, pi - pi)"), 1);
        assert_eq!(edges("dh(0, 0, 0, 0)"), 0);
    }

    #[test]
    fn places_belong_to_their_pose() {
        let poses = "let a = rot_z(theta); let b = rot_x(theta);";
        refused(
            &format!("{poses} let p = a.point(b * [x, y, z]);"),
            "b * [x, y, z]: this vector belongs to another pose; write its components in the axes of this pose: `[x, y, z]`",
        );
        refused(
            &format!("{poses} let p = a.point(b.point([x, y, z]));"),
            "b.point([x, y, z]): this vector belongs to another pose; write its components in the axes of this pose: `[x, y, z]`",
        );
        refused(
            "let p = world.point([1, 0, 0]);",
            "[1, 0, 0]: a place must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        same(poses, "a.point(a * [x, y, z])", "a.point([x, y, z])");
    }
}
