//! Values of the language: numbers, arrays (three numbers are a vector, three vectors a matrix), points and poses, all
//! in components of the world.

use std::rc::Rc;

use super::number::{Dual, Real};

/// A number along the motion: its value, its rate and its acceleration.
pub(super) type Moving<S> = Dual<Dual<S>>;

/// Three components.
pub(super) type Triple<S> = [Moving<S>; 3];

/// Where a frame stands: columns of the rotation are its axes in the world.
#[derive(Clone, Debug)]
pub(super) struct Pose<S> {
    pub(super) rotation: [Triple<S>; 3],
    pub(super) origin: Triple<S>,
}

/// A value, shared by all who name it.
pub(super) type Shared<S> = Rc<Value<S>>;

/// A value.
#[derive(Clone, Debug)]
pub(super) enum Value<S> {
    Number(Moving<S>),
    Array(Vec<Shared<S>>),
    Point(Triple<S>),
    Pose(Box<Pose<S>>),
    Truth(bool),
    /// What is seen of an instance of a part.
    Part(Vec<(Rc<str>, Shared<S>)>),
}

/// A number that moves like this.
pub(super) fn moving<S: Real>(value: S, rate: S, acceleration: S) -> Moving<S> {
    Dual::new(Dual::new(value, rate), Dual::new(rate, acceleration))
}

/// The rate of a number; the second rate of that is known to nobody.
pub(super) fn rate<S: Real>(x: Moving<S>) -> Moving<S> {
    Dual::new(x.eps, Dual::new(x.eps.eps, S::of(f64::NAN)))
}

pub(super) fn rates<S: Real>(v: &Triple<S>) -> Triple<S> {
    v.map(rate)
}

pub(super) fn number<S: Real>(value: f64) -> Moving<S> {
    Moving::of(value)
}

pub(super) fn dot<S: Real>(a: &Triple<S>, b: &Triple<S>) -> Moving<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<S: Real>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn add<S: Real>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(super) fn transposed<S: Real>(m: &[Triple<S>; 3]) -> [Triple<S>; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

pub(super) fn applied<S: Real>(m: &[Triple<S>; 3], v: &Triple<S>) -> Triple<S> {
    std::array::from_fn(|i| dot(&m[i], v))
}

pub(super) fn product<S: Real>(a: &[Triple<S>; 3], b: &[Triple<S>; 3]) -> [Triple<S>; 3] {
    let columns = transposed(b);
    std::array::from_fn(|i| std::array::from_fn(|j| dot(&a[i], &columns[j])))
}

impl<S: Real> Pose<S> {
    pub(super) fn world() -> Self {
        let entry = |i, j| number(if i == j { 1.0 } else { 0.0 });
        Pose { rotation: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))), origin: [number(0.0); 3] }
    }

    /// The turn about an axis (Rodrigues): R = cos φ 1 + sin φ [n]ₓ + (1 − cos φ) n nᵀ.
    pub(super) fn turn(axis: &Triple<S>, angle: Moving<S>) -> Self {
        let length = dot(axis, axis).sqrt();
        let n = axis.map(|x| x / length);
        let (sin, cos) = (angle.sin(), angle.cos());
        let zero = number(0.0);
        let skew = [[zero, -n[2], n[1]], [n[2], zero, -n[0]], [-n[1], n[0], zero]];
        let unit = Self::world();
        let entry =
            |i: usize, j: usize| unit.rotation[i][j] * cos + sin * skew[i][j] + (number::<S>(1.0) - cos) * n[i] * n[j];
        Pose { rotation: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))), origin: unit.origin }
    }

    /// The turn about a coordinate axis, without the zeros that `turn` would multiply by.
    pub(super) fn turn_about(axis: usize, angle: Moving<S>) -> Self {
        let (sin, cos) = (angle.sin(), angle.cos());
        let mut pose = Self::world();
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        pose.rotation[j][j] = cos;
        pose.rotation[k][k] = cos;
        pose.rotation[j][k] = -sin;
        pose.rotation[k][j] = sin;
        pose
    }

    pub(super) fn shift(origin: Triple<S>) -> Self {
        Pose { origin, ..Self::world() }
    }

    /// The rotation of w + xi + yj + zk over its length.
    pub(super) fn quaternion(w: Moving<S>, x: Moving<S>, y: Moving<S>, z: Moving<S>) -> Self {
        let (two, square) = (number::<S>(2.0), w * w + x * x + y * y + z * z);
        let rows = [
            [w * w + x * x - y * y - z * z, two * (x * y - w * z), two * (x * z + w * y)],
            [two * (x * y + w * z), w * w - x * x + y * y - z * z, two * (y * z - w * x)],
            [two * (x * z - w * y), two * (y * z + w * x), w * w - x * x - y * y + z * z],
        ];
        Pose { rotation: rows.map(|row| row.map(|entry| entry / square)), origin: Self::world().origin }
    }

    pub(super) fn then(&self, next: &Self) -> Self {
        Pose { rotation: product(&self.rotation, &next.rotation), origin: self.place(&next.origin) }
    }

    pub(super) fn place(&self, components: &Triple<S>) -> Triple<S> {
        add(&self.origin, &applied(&self.rotation, components))
    }

    pub(super) fn inverse(&self) -> Self {
        let rotation = transposed(&self.rotation);
        let origin = applied(&rotation, &self.origin).map(|x| -x);
        Pose { rotation, origin }
    }

    /// ω of Ṙ Rᵀ = [ω]ₓ, from the skew part.
    pub(super) fn angular_velocity(&self) -> Triple<S> {
        let rates: [Triple<S>; 3] = self.rotation.map(|row| row.map(rate));
        let spin = product(&rates, &transposed(&self.rotation));
        let half = number::<S>(0.5);
        [(spin[2][1] - spin[1][2]) * half, (spin[0][2] - spin[2][0]) * half, (spin[1][0] - spin[0][1]) * half]
    }

    /// The tensor with these entries in the axes of the pose.
    pub(super) fn tensor(&self, entries: &[Triple<S>; 3]) -> [Triple<S>; 3] {
        product(&product(&self.rotation, entries), &transposed(&self.rotation))
    }
}

/// What turning a vector into the axes of a body and back may do to it: a small part of it gets from one component into
/// another, and how much changes as the axes turn.
#[derive(Clone, Debug)]
pub(super) struct Mixing<S>(Option<[Triple<S>; 3]>);

impl<S: Real> Mixing<S> {
    /// With the angles that axes turn by.
    pub(super) fn new(angles: &[Moving<S>]) -> Self {
        if S::noise() == 0.0 {
            return Mixing(None);
        }
        let entry = || {
            let change = |angle: &Moving<S>| (*angle - number(angle.value())) * number(S::noise());
            angles.iter().map(change).fold(number(S::noise()), |sum, term| sum + term)
        };
        Mixing(Some(std::array::from_fn(|_| std::array::from_fn(|_| entry()))))
    }

    /// The vector after that.
    pub(super) fn vector(&self, v: &Triple<S>) -> Triple<S> {
        self.0.as_ref().map_or(*v, |mixing| add(v, &applied(mixing, v)))
    }

    /// A place, of which only the displacements are turned.
    pub(super) fn place(&self, place: &Triple<S>) -> Triple<S> {
        let displacement = place.map(|x| x - number(x.value()));
        self.0.as_ref().map_or(*place, |mixing| add(place, &applied(mixing, &displacement)))
    }
}

/// What a value is called in the referee's own complaints.
type Found<T> = Result<T, String>;

impl<S: Real> Value<S> {
    pub(super) fn number(&self) -> Found<Moving<S>> {
        match self {
            Value::Number(x) => Ok(*x),
            other => Err(format!("a number is wanted, not {}", other.shape())),
        }
    }

    pub(super) fn truth(&self) -> Found<bool> {
        match self {
            Value::Truth(truth) => Ok(*truth),
            other => Err(format!("a condition is wanted, not {}", other.shape())),
        }
    }

    pub(super) fn pose(&self) -> Found<&Pose<S>> {
        match self {
            Value::Pose(pose) => Ok(pose),
            other => Err(format!("a pose is wanted, not {}", other.shape())),
        }
    }

    /// A vector, or a point as one from the world's origin.
    pub(super) fn vector(&self) -> Found<Triple<S>> {
        match self {
            Value::Point(place) => Ok(*place),
            Value::Array(entries) if entries.len() == 3 => {
                Ok([entries[0].number()?, entries[1].number()?, entries[2].number()?])
            }
            other => Err(format!("a vector is wanted, not {}", other.shape())),
        }
    }

    pub(super) fn matrix(&self) -> Found<[Triple<S>; 3]> {
        match self {
            Value::Array(rows) if rows.len() == 3 => Ok([rows[0].vector()?, rows[1].vector()?, rows[2].vector()?]),
            other => Err(format!("a matrix is wanted, not {}", other.shape())),
        }
    }

    pub(super) fn of_vector(v: Triple<S>) -> Self {
        Value::Array(v.iter().map(|&x| Rc::new(Value::Number(x))).collect())
    }

    pub(super) fn of_matrix(rows: [Triple<S>; 3]) -> Self {
        Value::Array(rows.into_iter().map(|row| Rc::new(Value::of_vector(row))).collect())
    }

    fn shape(&self) -> &'static str {
        match self {
            Value::Number(_) => "a number",
            Value::Array(_) => "an array",
            Value::Point(_) => "a point",
            Value::Pose(_) => "a pose",
            Value::Truth(_) => "a condition",
            Value::Part(_) => "a part",
        }
    }

    /// Every number in it changed by `f`.
    pub(super) fn each(&self, f: &impl Fn(Moving<S>) -> Moving<S>) -> Found<Self> {
        match self {
            Value::Number(x) => Ok(Value::Number(f(*x))),
            Value::Array(entries) => {
                let entries: Found<Vec<_>> = entries.iter().map(|entry| Ok(Rc::new(entry.each(f)?))).collect();
                Ok(Value::Array(entries?))
            }
            // What is done to a place makes a vector of it.
            Value::Point(place) => Ok(Value::of_vector(place.map(f))),
            other => Err(format!("no arithmetic with {}", other.shape())),
        }
    }

    /// Sum or difference.
    pub(super) fn plus(&self, other: &Self, sign: f64) -> Found<Self> {
        let sum = |a: Moving<S>, b: Moving<S>| if sign < 0.0 { a - b } else { a + b };
        let sums = |a: Triple<S>, b: Triple<S>| std::array::from_fn(|i| sum(a[i], b[i]));
        match (self, other) {
            (Value::Number(a), Value::Number(b)) => Ok(Value::Number(sum(*a, *b))),
            (Value::Point(a), Value::Point(b)) if sign < 0.0 => Ok(Value::of_vector(sums(*a, *b))),
            (Value::Point(a), b) => Ok(Value::Point(sums(*a, b.vector()?))),
            (a, Value::Point(b)) => Ok(Value::Point(sums(a.vector()?, *b))),
            (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
                let entries: Found<Vec<_>> = a.iter().zip(b).map(|(a, b)| Ok(Rc::new(a.plus(b, sign)?))).collect();
                Ok(Value::Array(entries?))
            }
            (a, b) => Err(format!("no sum of {} and {}", a.shape(), b.shape())),
        }
    }

    pub(super) fn times(&self, other: &Self) -> Found<Self> {
        match (self, other) {
            (Value::Number(a), b) => b.each(&|x| *a * x),
            (a, Value::Number(b)) => a.each(&|x| x * *b),
            (Value::Pose(a), Value::Pose(b)) => Ok(Value::Pose(Box::new(a.then(b)))),
            (Value::Pose(pose), Value::Point(place)) => Ok(Value::Point(pose.place(place))),
            (Value::Pose(pose), b) => match b.matrix() {
                Ok(entries) => Ok(Value::of_matrix(pose.tensor(&entries))),
                Err(_) => Ok(Value::of_vector(applied(&pose.rotation, &b.vector()?))),
            },
            (a, b) => match b.matrix() {
                Ok(right) => Ok(Value::of_matrix(product(&a.matrix()?, &right))),
                Err(_) => Ok(Value::of_vector(applied(&a.matrix()?, &b.vector()?))),
            },
        }
    }

    /// All numbers in it: of a pose its origin, then the rows of the rotation.
    pub(super) fn flat(&self) -> Vec<Moving<S>> {
        match self {
            Value::Number(x) => vec![*x],
            Value::Array(entries) => entries.iter().flat_map(|entry| entry.flat()).collect(),
            Value::Point(place) => place.to_vec(),
            Value::Pose(pose) => pose.origin.iter().chain(pose.rotation.iter().flatten()).copied().collect(),
            Value::Truth(_) | Value::Part(_) => Vec::new(),
        }
    }
}
