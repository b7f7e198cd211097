//! The functions of the language: sections 6, 7 and 8 of the manual.

use std::rc::Rc;

use super::number::Real;
use super::table;
use super::value::{Mixing, Moving, Pose, Shared, Triple, Value, applied, cross, dot, number, rate, rates, transposed};

/// The value of a function or method of the language.
pub(super) fn call<S: Real>(name: &str, arguments: &[Shared<S>], mixing: &Mixing<S>) -> Result<Value<S>, String> {
    if let Some(value) = elementary(name, arguments)? {
        return Ok(Value::Number(value));
    }
    if let Some(pose) = pose(name, arguments)? {
        return Ok(Value::Pose(Box::new(pose)));
    }
    let given = |i: usize| arguments.get(i).ok_or_else(|| format!("`{name}` wants more arguments"));
    let vector = |i: usize| given(i)?.vector();
    let number_ = |i: usize| given(i)?.number();
    let of_pose = |i: usize| given(i)?.pose();
    Ok(match name {
        "dt" => rate_of(given(0)?)?,
        "dot" => Value::Number(dot(&vector(0)?, &vector(1)?)),
        "cross" => Value::of_vector(cross(&vector(0)?, &vector(1)?)),
        "norm" => Value::Number(dot(&vector(0)?, &vector(0)?).sqrt()),
        "norm_squared" => Value::Number(dot(&vector(0)?, &vector(0)?)),
        "transpose" => Value::of_matrix(transposed(&given(0)?.matrix()?)),
        "point" => Value::Point(mixing.place(&of_pose(0)?.place(&vector(1)?))),
        "origin" => Value::Point(mixing.place(&of_pose(0)?.origin)),
        "rotation" => Value::of_matrix(of_pose(0)?.rotation),
        "angular_velocity" => Value::of_vector(mixing.vector(&of_pose(0)?.angular_velocity())),
        "particle" => Value::Number(particle(number_(0)?, &vector(1)?)),
        "rigid_body" => {
            let (pose, inertia) = (of_pose(3)?, given(2)?.matrix()?);
            let (centre, turning) = (mixing.place(&pose.place(&vector(1)?)), mixing.vector(&pose.angular_velocity()));
            let momentum = applied(&pose.tensor(&inertia), &turning);
            Value::Number(particle(number_(0)?, &centre) + number::<S>(0.5) * dot(&turning, &momentum))
        }
        "diag" | "inertia" if arguments.len() == 1 => match arguments[0].matrix() {
            Ok(matrix) => Value::of_matrix(matrix),
            Err(_) => return call(name, elements(&arguments[0])?, mixing),
        },
        "table" | "table_monotone" | "table_spline" => {
            let (xs, ys) = (table::column(given(1)?)?, table::column(given(2)?)?);
            let x = number_(0)?;
            Value::Number(match name {
                "table" => table::lines(x, &xs, &ys),
                "table_monotone" => table::monotone(x, &xs, &ys),
                _ => table::spline(x, &xs, &ys),
            })
        }
        "diag" | "inertia" => {
            let entry = |i: usize| if i < arguments.len() { number_(i) } else { Ok(number(0.0)) };
            let (xx, yy, zz, xy, xz, yz) = (entry(0)?, entry(1)?, entry(2)?, entry(3)?, entry(4)?, entry(5)?);
            Value::of_matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        }
        _ => Value::Number(library(name, arguments)?.ok_or_else(|| format!("there is no function `{name}`"))?),
    })
}

/// Those of an array, as arguments.
fn elements<S: Real>(array: &Shared<S>) -> Result<&[Shared<S>], String> {
    match array.as_ref() {
        Value::Array(entries) => Ok(entries),
        _ => Err("an array is wanted".to_string()),
    }
}

fn numbers<S: Real>(arguments: &[Shared<S>]) -> Option<Vec<Moving<S>>> {
    arguments.iter().map(|argument| argument.number().ok()).collect()
}

/// Section 6.
fn elementary<S: Real>(name: &str, arguments: &[Shared<S>]) -> Result<Option<Moving<S>>, String> {
    let Some(x) = numbers(arguments) else { return Ok(None) };
    Ok(Some(match (name, x.as_slice()) {
        ("sin", [x]) => x.sin(),
        ("cos", [x]) => x.cos(),
        ("tan", [x]) => x.tan(),
        ("asin", [x]) => x.asin(),
        ("acos", [x]) => x.acos(),
        ("atan", [x]) => x.atan(),
        ("sinh", [x]) => x.sinh(),
        ("cosh", [x]) => x.cosh(),
        ("tanh", [x]) => x.tanh(),
        ("exp", [x]) => x.exp(),
        ("ln", [x]) => x.ln(),
        ("sqrt", [x]) => x.sqrt(),
        ("abs", [x]) => x.abs(),
        ("signum", [x]) => x.signum(),
        ("atan2", [y, x]) => y.atan2(*x),
        ("hypot", [x, y]) => (*x * *x + *y * *y).sqrt(),
        ("min", [a, b]) => least(*a, *b),
        ("max", [a, b]) => greatest(*a, *b),
        ("clamp", [x, low, high]) => least(greatest(*x, *low), *high),
        _ => return Ok(None),
    }))
}

fn least<S: Real>(a: Moving<S>, b: Moving<S>) -> Moving<S> {
    if a.less(b) { a } else { b }
}

fn greatest<S: Real>(a: Moving<S>, b: Moving<S>) -> Moving<S> {
    if a.less(b) { b } else { a }
}

/// The library of section 6, from its formulas there.
fn library<S: Real>(name: &str, arguments: &[Shared<S>]) -> Result<Option<Moving<S>>, String> {
    let Some(x) = numbers(arguments) else { return Ok(None) };
    Ok(Some(match (name, x.as_slice()) {
        ("spring", [stiffness, length, rest]) => {
            let stretch = *length - *rest;
            number::<S>(0.5) * *stiffness * stretch * stretch
        }
        ("coulomb_stribeck", [v, f_c, f_s, v_s, v_eps]) => {
            let ratio = *v / *v_s;
            -(*f_c + (*f_s - *f_c) * (-(ratio * ratio)).exp()) * (*v / *v_eps).tanh()
        }
        ("contact", [gap, k, c, speed]) if gap.less(number(0.0)) => greatest(-*k * *gap - *c * *speed, number(0.0)),
        ("contact", [_, _, _, _]) => number(0.0),
        _ => return Ok(None),
    }))
}

/// Section 7.
fn pose<S: Real>(name: &str, arguments: &[Shared<S>]) -> Result<Option<Pose<S>>, String> {
    let axis = ["rot_x", "rot_y", "rot_z"].iter().position(|turn| *turn == name);
    if let (Some(axis), [angle]) = (axis, arguments) {
        return Ok(Some(Pose::turn_about(axis, angle.number()?)));
    }
    Ok(Some(match (name, arguments) {
        ("rotation", [axis, angle]) => Pose::turn(&axis.vector()?, angle.number()?),
        ("rpy", [roll, pitch, yaw]) => Pose::turn_about(2, yaw.number()?)
            .then(&Pose::turn_about(1, pitch.number()?))
            .then(&Pose::turn_about(0, roll.number()?)),
        ("quaternion", [e]) => return pose(name, elements(e)?),
        ("quaternion", [w, x, y, z]) => Pose::quaternion(w.number()?, x.number()?, y.number()?, z.number()?),
        ("translation", [v]) => Pose::shift(v.vector()?),
        ("translation", [x, y, z]) => Pose::shift([x.number()?, y.number()?, z.number()?]),
        ("dh", [theta, d, a, alpha]) => Pose::turn_about(2, theta.number()?)
            .then(&Pose::shift([a.number()?, number(0.0), d.number()?]))
            .then(&Pose::turn_about(0, alpha.number()?)),
        ("inverse", [pose]) => pose.pose()?.inverse(),
        _ => return Ok(None),
    }))
}

/// As seen from the world: by entry of world components.
fn rate_of<S: Real>(value: &Value<S>) -> Result<Value<S>, String> {
    match value {
        Value::Number(x) => Ok(Value::Number(rate(*x))),
        Value::Point(place) => Ok(Value::of_vector(rates(place))),
        Value::Array(entries) => {
            let entries: Result<Vec<_>, String> = entries.iter().map(|e| Ok(Rc::new(rate_of(e)?))).collect();
            Ok(Value::Array(entries?))
        }
        _ => Err("this has no rate".to_string()),
    }
}

fn particle<S: Real>(mass: Moving<S>, place: &Triple<S>) -> Moving<S> {
    let velocity = rates(place);
    number::<S>(0.5) * mass * dot(&velocity, &velocity)
}
