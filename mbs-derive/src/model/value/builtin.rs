//! The functions and methods of the language: two tables, then one Rust function an entry.

use crate::diagnostic::{Code, nearest};
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

impl Builtin {
    /// As it is called.
    pub(in crate::model) fn form(&self) -> &'static str {
        self.form
    }
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
    resolver.refuse(Code::ArgumentCount, &name.span, message, format!("write `{}`", builtin.form))
}

fn unknown_function(resolver: &mut Resolver<'_, '_>, name: &Name) -> Refused {
    let text = &name.text;
    if let Some(form) = form_of_method(text) {
        return resolver.refuse(
            Code::UnknownFunction,
            &name.span,
            format!("`{text}` is a method"),
            format!("write `{form}`"),
        );
    }
    if resolver.names.scope.get(text).is_some() || CONSTANTS.contains(&text.as_str()) {
        return resolver.refuse(
            Code::UnknownFunction,
            &name.span,
            format!("`{text}` is not a function"),
            "write `*` for a product",
        );
    }
    let in_sight = resolver.functions_in_sight();
    let own = in_sight.keys().copied();
    let known = FUNCTIONS.iter().chain(METHODS).map(|f| f.name);
    let help = match (elsewhere(text), nearest(text, own.chain(known))) {
        _ if resolver.names.functions.contains_key(text.as_str()) => {
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
    resolver.refuse(Code::UnknownFunction, &name.span, format!("there is no function `{text}`"), help)
}

fn unknown_method(resolver: &mut Resolver<'_, '_>, name: &Name) -> Refused {
    let text = &name.text;
    let help = match (form_of_function(text), nearest(text, METHODS.iter().map(|f| f.name))) {
        (Some(form), _) => format!("it is a function: write `{form}`"),
        (None, Some(meant)) => format!("did you mean `{}`?", form_of_method(meant).unwrap_or(meant)),
        (None, None) => format!("the methods are {}", list(METHODS)),
    };
    resolver.refuse(Code::UnknownFunction, &name.span, format!("there is no method `{text}`"), help)
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
    Ok(Value::Scalar(Scalar::new(resolver.cornered(Function::Abs, x.expr), x.dimension)))
}

fn signum<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let x = resolver.scalar(&call.arguments[0])?;
    Ok(Value::Scalar(Scalar::plain(resolver.cornered(Function::Signum, x.expr))))
}

fn sqrt<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let x = resolver.scalar(&call.arguments[0])?;
    let dimension = resolver.bounded(x.dimension.power(1, 2), call.span)?;
    Ok(Value::Scalar(Scalar::new(resolver.square_root(x.expr), dimension)))
}

/// Two numbers of one dimension.
fn pair<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<(Expr<'g>, Expr<'g>, Dimension)> {
    let (a, b) = (resolver.scalar(&call.arguments[0]), resolver.scalar(&call.arguments[1]));
    let (a, b) = (a?, b?);
    match shared(a.fit(), b.fit()) {
        Some(dimension) => Ok((a.expr, b.expr, dimension)),
        None => {
            let message = format!("the arguments need equal dimensions, these are {} and {}", a.dimension, b.dimension);
            Err(resolver.refuse(Code::UnequalDimensions, call.span, message, ""))
        }
    }
}

fn atan2<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let (y, x, _) = pair(resolver, call)?;
    Ok(Value::Scalar(Scalar::plain(y.call2(Binary::Atan2, x))))
}

fn hypot<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let (x, y, dimension) = pair(resolver, call)?;
    Ok(Value::Scalar(Scalar::new(resolver.square_root(x.powi(2) + y.powi(2)), dimension)))
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
    Ok(Value::Scalar(Scalar::new(resolver.square_root(square), v.dimension)))
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

/// For `|q| = 1`, which is the user's to keep: by a constraint, where coordinates are among them, or when parameters
/// are set.
fn quaternion<'g>(resolver: &mut Resolver<'_, 'g>, call: &Call<'_, 'g>) -> Resolved<Value<'g>> {
    let part = |resolver: &mut Resolver<'_, 'g>, argument| {
        resolver.of_dimension(argument, "a component of a quaternion", Dimension::ONE)
    };
    let single = resolver.spread(call, 4, "a quaternion is an array of 4 numbers, the scalar part first")?;
    let [w, x, y, z] = single.as_deref().unwrap_or(call.arguments) else { return Err(Refused) };
    let parts = [part(resolver, w), part(resolver, x), part(resolver, y), part(resolver, z)];
    let [w, x, y, z] = parts;
    let parts = resolver.unit_quaternion([w?, x?, y?, z?], call.span)?;
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
        return Err(resolver.refuse(Code::OtherAxes, &axis.span, message, "write its components: `[x, y, z]`"));
    }
    let mut numbers = [Number::ZERO; 3];
    for (number, component) in numbers.iter_mut().zip(vector.components.0) {
        let Some(value) = resolver.known.facts.constant(component) else {
            let help = "compose rotations about constant axes: `rot_z(a) * rot_x(b)`";
            return Err(resolver.refuse(Code::AxisThatTurns, &axis.span, "an axis must be constant", help));
        };
        *number = value;
    }
    let squared = numbers.iter().map(|&n| n * n).reduce(|a, b| a + b).unwrap_or(Number::ZERO);
    match squared.power(HalfInteger::halves(-1).to_halves()) {
        Some(inverse) if squared.to_f64() > 0.0 => Ok(numbers.map(|n| n * inverse)),
        _ => Err(resolver.refuse(
            Code::AxisWithoutDirection,
            &axis.span,
            "an axis must have a direction, this is zero",
            "",
        )),
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
    Ok(Value::Vector(Free { components, frame, dimension: resolver.dimension(Dimension::ANGULAR_VELOCITY) }))
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
            return Err(resolver.refuse(Code::UnequalDimensions, &argument.span, message, ""));
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
        [a, b, c, ab, ac, bc] => {
            Ok(Value::matrix(Tensor::plain(Matrix([[a, ab, ac], [ab, b, bc], [ac, bc, c]]), dimension)))
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
mod tests;
