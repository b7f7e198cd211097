//! How values and statements are written in Rust.

use std::collections::BTreeMap;

use super::super::body::{Block, Body, FAMILIAR, familiar};
use super::super::expression::Tree;
use super::super::name::{escaped, table};
use super::super::rolled::Loops;
use super::super::walk::{Place, Side, Syntax, Walk, Wanted, Writer, plain};
use super::shape::array_of;
use super::{Module, segment};

/// At most this many fields are bound to locals; of more, each is read as `self.k12`.
const FIELDS: usize = 8;

/// Lines of tables are of at most this many characters.
const WIDTH: usize = 120;

/// At most this many other constants are written out; of more, each is `c(0.295242)` with `let c = T::from_f64`.
const WRITTEN_OUT: usize = 3;

/// Rust within a function of a module.
pub(super) struct Rust<'m, 'd> {
    walk: &'m Walk<'d>,
    /// Whether sums of products are written as such.
    infix: bool,
    /// What the parameters are taken from.
    params: &'static str,
}

impl<'d> Module<'d> {
    /// Where the parameters are at `params`.
    pub(super) fn with(&self, params: &'static str) -> Rust<'_, 'd> {
        Rust::new(&self.walk, self.infix, params)
    }
}

impl<'m, 'd> Rust<'m, 'd> {
    pub(super) fn new(walk: &'m Walk<'d>, infix: bool, params: &'static str) -> Self {
        Rust { walk, infix, params }
    }
}

/// The shortest literal that reads back as `value`, its sign in front.
pub(super) fn literal(value: f64) -> String {
    assert!(value.is_finite(), "constants are finite");
    format!("{value:?}")
}

/// What stands for a comment among tokens, which have none.
fn marked(comment: &str) -> String {
    format!("comment!({comment:?});")
}

/// A line of the formatted text, with the comment that is marked in it.
pub(super) fn unmarked(line: &str) -> String {
    let comment = |line: &str| Some(line.trim_start().strip_prefix("comment!(\"")?.strip_suffix("\");")?.to_string());
    let indent = &line[..line.len() - line.trim_start().len()];
    comment(line).map_or_else(|| line.to_string(), |comment| format!("{indent}// {comment}"))
}

/// Whether a line of the formatted text begins a table of numbers.
pub(super) fn opens_table(line: &str) -> bool {
    line.trim_start().starts_with("static ") && line.ends_with("= [")
}

/// Writes a number of a table that begins with the line `begin` behind the one before, where there is room; whether it
/// is one.
pub(super) fn pack(text: &mut String, begin: &str, line: &str) -> bool {
    let number = line.trim_start();
    if !number.starts_with(|c: char| c == '-' || c.is_ascii_digit()) {
        return false;
    }
    let last = text.trim_end_matches('\n').rsplit('\n').next().unwrap_or_default();
    let indent = begin.len() - begin.trim_start().len();
    if last == begin || last.len() + 1 + number.len() > WIDTH {
        text.push_str(&" ".repeat(indent + 4));
    } else {
        text.pop();
        text.push(' ');
    }
    text.push_str(number);
    text.push('\n');
    true
}

/// A literal, or π.
pub(super) fn number(value: f64) -> String {
    if value == std::f64::consts::PI { "::core::f64::consts::PI".to_string() } else { literal(value) }
}

/// `T::from_f64(0.295242)`
pub(super) fn written_out(value: f64) -> String {
    if value == 0.0 && value.is_sign_positive() {
        "T::zero()".to_string()
    } else if value == 1.0 {
        "T::one()".to_string()
    } else {
        format!("T::from_f64({})", number(value))
    }
}

/// Whether a familiar constant has a name: `T::zero()` and `T::one()` speak for themselves.
fn is_bound(body: &Body<'_>, i: usize) -> bool {
    let uses = body.leaves.familiar[i];
    uses > 1 || (uses == 1 && !matches!(FAMILIAR[i].0, 0.0 | 1.0))
}

/// Whether other constants are `c(…)`.
fn is_abbreviated(body: &Body<'_>) -> bool {
    body.leaves.others > WRITTEN_OUT
}

fn binds_fields(body: &Body<'_>) -> bool {
    body.leaves.hoisted.len() <= FIELDS
}

impl Syntax for Rust<'_, '_> {
    fn eliminates(&self) -> bool {
        true
    }

    fn identifier(&self, name: &str) -> String {
        name.to_string()
    }

    fn leaf(&self, leaf: &Tree, body: &Body<'_>) -> String {
        match leaf {
            Tree::Constant(value) => match familiar(*value) {
                Some(i) => {
                    let sign = if value.is_sign_negative() { "-" } else { "" };
                    let named = is_bound(body, i).then(|| body.familiar[i].clone());
                    format!("{sign}{}", named.unwrap_or_else(|| written_out(value.abs())))
                }
                None if is_abbreviated(body) => format!("{}({})", body.convert, number(*value)),
                None => written_out(*value),
            },
            Tree::Hoisted(_) if binds_fields(body) => body.name(leaf).to_string(),
            Tree::Hoisted(_) => self.hoisted(body.name(leaf)),
            Tree::Local(local) if body.on_demand.contains(local) => format!("*{}", body.name(leaf)),
            leaf => body.name(leaf).to_string(),
        }
    }

    fn constant(&self, value: f64) -> String {
        written_out(value)
    }

    fn hoisted(&self, name: &str) -> String {
        format!("self.{name}")
    }

    fn and(&self) -> &'static str {
        "&"
    }

    fn and_is_tight(&self) -> bool {
        true
    }

    fn not(&self) -> &'static str {
        "!"
    }

    fn select(&self, condition: &str, [then, otherwise]: [&str; 2], known: bool) -> String {
        match known {
            true => format!("T::blend({condition}, {then}, {otherwise})"),
            false => format!("T::select({condition}, || {then}, || {otherwise})"),
        }
    }

    fn call(&self, name: &str, arguments: &[String]) -> String {
        format!("{}.{name}({})", arguments[0], arguments[1..].join(", "))
    }

    fn has_methods(&self) -> bool {
        true
    }

    fn fuses(&self) -> bool {
        !self.infix
    }

    /// The arguments and fields taken apart, then names of constants.
    fn begin(&self, reads: &[(&str, Place<'_>)], body: &Body<'_>) -> Vec<String> {
        let names: BTreeMap<&Place<'_>, &str> = reads.iter().map(|(name, place)| (place, *name)).collect();
        let name = |place: Place<'_>| names.get(&place).map(ToString::to_string);
        let taken = |(argument, count): (&'static str, usize)| {
            let pattern = pattern((0..count).map(|i| name(Place::Argument(argument, i))))?;
            Some(format!("let {pattern} = *{argument};"))
        };
        let [n, inputs, signals, rows] = self.walk.sizes();
        let prescribed = || {
            let motion = |i| pattern((0..3).map(|order| name(Place::Prescribed(i, order))));
            let motions: Vec<Option<String>> = (0..signals).map(motion).collect();
            motions.iter().any(Option::is_some).then(|| {
                let motions: Vec<String> =
                    motions.into_iter().map(|motion| motion.unwrap_or("_".to_string())).collect();
                format!("let [{}] = *prescribed;", motions.join(", "))
            })
        };
        let hoisted = body.leaves.hoisted.iter().map(|k| format!("{}, ", body.name(&Tree::Hoisted(*k))));
        let is_bound = binds_fields(body) && !body.leaves.hoisted.is_empty();
        let fields = || is_bound.then(|| format!("let Self {{ {}.. }} = *self;", hoisted.collect::<String>()));
        let parameters = self.parameters(&name).map(|pattern| format!("let {pattern} = {};", self.params));
        let state = [("q", n), ("qd", n), ("qdd", n), ("u", inputs)].into_iter().filter_map(taken);
        let others = [prescribed(), taken(("multipliers", rows)), fields(), parameters];
        state.chain(others.into_iter().flatten()).chain(constants(body)).collect()
    }

    fn comment(&self, text: &str) -> String {
        marked(text)
    }

    fn loops(&self) -> Option<&dyn Loops> {
        Some(self)
    }

    fn block(&self, block: &Block, writer: &Writer<'_, '_>) -> Vec<String> {
        segment::statements(block, writer)
    }

    fn bind(&self, name: &str, value: &str) -> String {
        format!("let {name} = {value};")
    }

    fn sin_cos(&self, [sin, cos]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("let ({sin}, {cos}) = {angle}.sin_cos();")]
    }

    /// Those of the library one by one, which are wanted both.
    fn sin_cos_all(&self, angles: &[Wanted], library: bool, _number: usize) -> Vec<String> {
        if let ([Wanted { angle, sin: Some(sin), cos: Some(cos) }], true) = (angles, library) {
            return self.sin_cos([sin, cos], angle);
        }
        let names = |name: fn(&Wanted) -> &Option<String>| {
            let names = angles.iter().map(|angle| name(angle).as_deref().unwrap_or("_"));
            let names: Vec<&str> = names.collect();
            if names.iter().all(|name| *name == "_") { "_".to_string() } else { format!("[{}]", names.join(", ")) }
        };
        let (sines, cosines) = (names(|angle| &angle.sin), names(|angle| &angle.cos));
        let angles: Vec<&str> = angles.iter().map(|wanted| wanted.angle.as_str()).collect();
        vec![format!("let ({sines}, {cosines}) = T::sin_cos_all([{}]);", angles.join(", "))]
    }

    /// Those of all orders up to one, as an array.
    fn spline(&self, number: usize, _order: usize, x: &str) -> String {
        format!("{}.derivatives({x})", table(number))
    }

    fn splines(&self, names: &[String], orders: &[usize], number: usize, x: &str) -> Vec<String> {
        let highest = orders[orders.len() - 1];
        let name = |order| orders.binary_search(&order).map_or("_", |i| names[i].as_str());
        let bound: Vec<&str> = (0..=highest).map(name).collect();
        vec![format!("let [{}] = {};", bound.join(", "), self.spline(number, highest, x))]
    }

    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String> {
        let pattern = several(names);
        let select = if names.len() > 1 { "T::select_each" } else { "T::select" };
        let [then, otherwise] = sides.map(computed);
        vec![format!("let {pattern} = {select}({condition}, || {then}, || {otherwise});")]
    }

    /// Without `dyn` the type of one closure would hold those of all that it asks, each in full.
    fn on_demand(&self, name: &str, wanted: Side) -> Vec<String> {
        vec![
            format!("let {name}: &dyn Fn() -> T = &|| {};", computed(wanted)),
            format!("let {name} = ::core::cell::LazyCell::new({name});"),
        ]
    }

    fn read(&self, place: &Place<'_>) -> String {
        match place {
            Place::Argument(name, i) => format!("{name}[{i}]"),
            Place::Prescribed(i, order) => format!("prescribed[{i}][{order}]"),
            Place::Parameter(name, indices) => {
                let indices: String = indices.iter().map(|i| format!("[{i}]")).collect();
                format!("{}.{}{indices}", self.params, escaped(name))
            }
        }
    }
}

impl Rust<'_, '_> {
    /// `Params { m, length: [a, _], .. }`
    fn parameters(&self, name: &dyn Fn(Place<'_>) -> Option<String>) -> Option<String> {
        let (all, fields) = (&self.walk.derivation.parameters, &self.walk.names.fields);
        let read = all.iter().zip(fields).filter_map(|(parameter, field)| {
            let own = plain(field);
            let component = |indices: &[usize]| name(Place::Parameter(&own, indices.to_vec()));
            let named = match parameter.lengths().as_slice() {
                [] => component(&[]),
                [count] => pattern((0..*count).map(|i| component(&[i]))),
                [rows, columns, ..] => pattern((0..*rows).map(|i| pattern((0..*columns).map(|j| component(&[i, j]))))),
            };
            named.map(|named| if named == *field { format!("{named}, ") } else { format!("{field}: {named}, ") })
        });
        let read: Vec<String> = read.collect();
        let rest = if read.len() < all.len() { ".." } else { "" };
        (!read.is_empty()).then(|| format!("Params {{ {}{rest} }}", read.concat()))
    }
}

/// `let half = T::from_f64(0.5);`, …
fn constants(body: &Body<'_>) -> impl Iterator<Item = String> {
    let bound = (0..FAMILIAR.len()).filter(|&i| is_bound(body, i));
    let bound = bound.map(|i| format!("let {} = {};", body.familiar[i], written_out(FAMILIAR[i].0)));
    bound.chain(is_abbreviated(body).then(|| format!("let {} = T::from_f64;", body.convert)))
}

/// `[x, _]`; `None` where no component is named.
fn pattern(components: impl Iterator<Item = Option<String>>) -> Option<String> {
    let components: Vec<Option<String>> = components.collect();
    let read = components.iter().rposition(Option::is_some)? + 1;
    let rest = match components.len() - read {
        0 => None,
        1 => Some("_"),
        _ => Some(".."),
    };
    let shown = components[..read].iter().map(|component| component.as_deref().unwrap_or("_"));
    Some(format!("[{}]", shown.chain(rest).collect::<Vec<_>>().join(", ")))
}

/// One as it is, several as an array.
fn several(parts: &[String]) -> String {
    match parts {
        [part] => part.clone(),
        parts => array_of(parts),
    }
}

/// The expression that a closure consists of; a last statement that binds just the results goes without its `let`.
fn computed(Side { mut lines, values, is_named_last }: Side) -> String {
    let mut value = several(&values);
    let last = |line: &String| Some(line.strip_prefix(&format!("let {value} = "))?.strip_suffix(';')?.to_string());
    if let Some(bound) = lines.last().filter(|_| is_named_last).and_then(last) {
        lines.pop();
        value = bound;
    }
    if lines.is_empty() { value } else { format!("{{ {}\n{value} }}", lines.join("\n")) }
}
