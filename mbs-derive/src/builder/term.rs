//! The values that a mechanism is written with: graphs of calls, each of which knows where it was made.

use std::mem;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::panic::Location;
use std::rc::Rc;

use crate::parse::syntax::BinaryOperator;
use crate::source::Place;

/// One call; shared, because values are used many times.
#[derive(Clone, Debug)]
pub struct Term(pub(super) Rc<Node>);

#[derive(Debug)]
pub(super) struct Node {
    pub(super) kind: Kind,
    pub(super) operands: Vec<Term>,
    /// Leaves stand where they are used.
    pub(super) call: Option<Place>,
    /// Calls within calls, since the last one that is kept.
    depth: usize,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    Number(f64),
    Quantity(f64, String),
    Name(String),
    Element(String, usize),
    Negate,
    Binary(BinaryOperator),
    Call(&'static str),
    Method(&'static str),
    Field(&'static str),
    Array,
    /// `if a < b { c } else { d }`
    Less,
}

/// The parser allows four times as many levels.
const MAX_DEPTH: usize = 64;

impl Term {
    pub(super) fn leaf(kind: Kind) -> Self {
        Term(Rc::new(Node { kind, operands: Vec::new(), call: None, depth: 0 }))
    }

    #[track_caller]
    fn call(kind: Kind, operands: Vec<Term>) -> Self {
        let depth = 1 + operands.iter().map(|operand| operand.0.depth % MAX_DEPTH).max().unwrap_or(0);
        Term(Rc::new(Node { kind, operands, call: Some(Location::caller().into()), depth }))
    }

    /// As if the call had been made there; what others hold already stays as it is.
    fn at(mut self, place: Place) -> Self {
        let Some(node) = Rc::get_mut(&mut self.0) else { return self };
        let Some(made) = node.call else { return self };
        node.call = Some(place);
        // What the same call has made on the way.
        for operand in mem::take(&mut node.operands) {
            let is_own = operand.0.call == Some(made) && Rc::strong_count(&operand.0) == 1;
            node.operands.push(if is_own { operand.at(place) } else { operand });
        }
        self
    }

    pub(super) fn is_leaf(&self) -> bool {
        matches!(self.0.kind, Kind::Number(_) | Kind::Quantity(..) | Kind::Name(_) | Kind::Element(..))
    }

    /// Whether it may be used again, or is too deep to be written out.
    pub(super) fn is_kept(&self) -> bool {
        Rc::strong_count(&self.0) > 1 || self.0.depth == MAX_DEPTH
    }
}

/// Long sums are dropped term by term: the compiler's way would recurse over all of them.
impl Drop for Node {
    fn drop(&mut self) {
        let mut rest = mem::take(&mut self.operands);
        while let Some(Term(node)) = rest.pop() {
            if let Ok(mut node) = Rc::try_unwrap(node) {
                rest.append(&mut node.operands);
            }
        }
    }
}

/// What is constrained and put out: [`Scalar`], [`Vector`] and [`Pose`], and nothing else.
pub trait Value: Written {}

/// What a call takes.
pub trait Written {
    /// The calls that it is made of.
    fn term(&self) -> Term;
}

macro_rules! values {
    ($($value:ident)*) => {$(
        impl Value for $value {}

        impl Written for $value {
            fn term(&self) -> Term {
                self.0.clone()
            }
        }

        impl $value {
            /// As if it had been made at another place, for those who write mechanisms in another language: reports
            /// name that place. What is held by others, too, stays as it is.
            #[must_use]
            pub fn at(self, place: Place) -> Self {
                $value(self.0.at(place))
            }
        }

        impl From<$value> for Term {
            fn from(value: $value) -> Self {
                value.0
            }
        }

        impl From<&$value> for Term {
            fn from(value: &$value) -> Self {
                value.0.clone()
            }
        }

        impl From<&$value> for $value {
            fn from(value: &$value) -> Self {
                value.clone()
            }
        }
    )*};
}

/// A number with a dimension: `f64`s are plain ones.
#[derive(Clone, Debug)]
pub struct Scalar(pub(super) Term);

/// A vector that knows its axes, or a place that knows its frame.
#[derive(Clone, Debug)]
pub struct Vector(pub(super) Term);

/// Position and attitude of a frame, built on others.
#[derive(Clone, Debug)]
pub struct Pose(pub(super) Term);

values!(Scalar Vector Pose);

impl From<f64> for Term {
    fn from(number: f64) -> Self {
        Term::leaf(Kind::Number(number))
    }
}

impl From<f64> for Scalar {
    fn from(number: f64) -> Self {
        Scalar(number.into())
    }
}

impl From<[f64; 3]> for Vector {
    #[track_caller]
    fn from([x, y, z]: [f64; 3]) -> Self {
        Vector::new(x, y, z)
    }
}

// ---- operators

macro_rules! operators {
    ($($trait:ident $method:ident $operator:ident: $left:ty, $right:ty => $value:ident;)*) => {$(
        impl $trait<$right> for $left {
            type Output = $value;

            #[track_caller]
            fn $method(self, right: $right) -> $value {
                $value(Term::call(Kind::Binary(BinaryOperator::$operator), vec![self.into(), right.into()]))
            }
        }
    )*};
}

/// Of values and of references to them.
macro_rules! of_values {
    ($($trait:ident $method:ident $operator:ident: $left:ident, $right:ident => $value:ident;)*) => {$(
        operators! {
            $trait $method $operator: $left, $right => $value;
            $trait $method $operator: $left, &$right => $value;
            $trait $method $operator: &$left, $right => $value;
            $trait $method $operator: &$left, &$right => $value;
        }
    )*};
}

/// Of values and numbers, on either side.
macro_rules! with_numbers {
    ($($trait:ident $method:ident $operator:ident $value:ident;)*) => {$(
        operators! {
            $trait $method $operator: $value, f64 => $value;
            $trait $method $operator: &$value, f64 => $value;
        }
    )*};
}

macro_rules! numbers_with {
    ($($trait:ident $method:ident $operator:ident $value:ident;)*) => {$(
        operators! {
            $trait $method $operator: f64, $value => $value;
            $trait $method $operator: f64, &$value => $value;
        }
    )*};
}

of_values! {
    Add add Add: Scalar, Scalar => Scalar;
    Sub sub Sub: Scalar, Scalar => Scalar;
    Mul mul Mul: Scalar, Scalar => Scalar;
    Div div Div: Scalar, Scalar => Scalar;
    Add add Add: Vector, Vector => Vector;
    Sub sub Sub: Vector, Vector => Vector;
    Mul mul Mul: Scalar, Vector => Vector;
    Mul mul Mul: Vector, Scalar => Vector;
    Div div Div: Vector, Scalar => Vector;
    Mul mul Mul: Pose, Vector => Vector;
    Mul mul Mul: Pose, Pose => Pose;
}

with_numbers! {
    Add add Add Scalar;
    Sub sub Sub Scalar;
    Mul mul Mul Scalar;
    Div div Div Scalar;
    Mul mul Mul Vector;
    Div div Div Vector;
}

numbers_with! {
    Add add Add Scalar;
    Sub sub Sub Scalar;
    Mul mul Mul Scalar;
    Div div Div Scalar;
    Mul mul Mul Vector;
}

macro_rules! negative {
    ($($value:ident: $left:ty;)*) => {$(
        impl Neg for $left {
            type Output = $value;

            #[track_caller]
            fn neg(self) -> $value {
                $value(Term::call(Kind::Negate, vec![self.into()]))
            }
        }
    )*};
}

negative! { Scalar: Scalar; Scalar: &Scalar; Vector: Vector; Vector: &Vector; }

// ---- functions

macro_rules! elementary {
    ($($name:ident)*) => {
        impl Scalar {$(
            #[doc = concat!("`", stringify!($name), "(x)`, as in the language.")]
            #[must_use]
            #[track_caller]
            pub fn $name(&self) -> Scalar {
                Scalar(Term::call(Kind::Call(stringify!($name)), vec![self.term()]))
            }
        )*}
    };
}

elementary!(sin cos tan asin acos atan sinh cosh tanh exp ln abs signum sqrt);

macro_rules! of_two {
    ($($name:ident)*) => {
        impl Scalar {$(
            #[doc = concat!("`", stringify!($name), "(a, b)`, as in the language.")]
            #[must_use]
            #[track_caller]
            pub fn $name(&self, other: impl Into<Scalar>) -> Scalar {
                Scalar(Term::call(Kind::Call(stringify!($name)), vec![self.term(), other.into().0]))
            }
        )*}
    };
}

of_two!(atan2 hypot min max);

macro_rules! tables {
    ($($name:ident)*) => {
        impl Scalar {$(
            #[doc = concat!("`", stringify!($name), "(x, xs, ys)`, as in the language, of samples (x, y).")]
            #[must_use]
            #[track_caller]
            pub fn $name<X: Into<Scalar>, Y: Into<Scalar>>(&self, samples: impl IntoIterator<Item = (X, Y)>) -> Scalar {
                let samples = samples.into_iter().map(|(x, y)| (x.into().0, y.into().0));
                let (xs, ys) = samples.unzip();
                let (xs, ys) = (Term::call(Kind::Array, xs), Term::call(Kind::Array, ys));
                Scalar(Term::call(Kind::Call(stringify!($name)), vec![self.term(), xs, ys]))
            }
        )*}
    };
}

tables!(table table_monotone table_spline);

impl Scalar {
    /// `clamp(x, low, high)`
    #[must_use]
    #[track_caller]
    pub fn clamp(&self, low: impl Into<Scalar>, high: impl Into<Scalar>) -> Scalar {
        Scalar(Term::call(Kind::Call("clamp"), vec![self.term(), low.into().0, high.into().0]))
    }

    /// `spring(stiffness, length, rest)`: the energy of a linear spring of this stiffness.
    #[must_use]
    #[track_caller]
    pub fn spring(&self, length: impl Into<Scalar>, rest: impl Into<Scalar>) -> Scalar {
        Scalar(Term::call(Kind::Call("spring"), vec![self.term(), length.into().0, rest.into().0]))
    }

    /// `coulomb_stribeck(v, f_c, f_s, v_s, v_eps)`: the friction of this velocity.
    #[must_use]
    #[track_caller]
    pub fn coulomb_stribeck(
        &self,
        f_c: impl Into<Scalar>,
        f_s: impl Into<Scalar>,
        v_s: impl Into<Scalar>,
        v_eps: impl Into<Scalar>,
    ) -> Scalar {
        let given = vec![self.term(), f_c.into().0, f_s.into().0, v_s.into().0, v_eps.into().0];
        Scalar(Term::call(Kind::Call("coulomb_stribeck"), given))
    }

    /// `contact(gap, k, c, rate)`: the force of a compliant contact whose gap this is.
    #[must_use]
    #[track_caller]
    pub fn contact(&self, k: impl Into<Scalar>, c: impl Into<Scalar>, rate: impl Into<Scalar>) -> Scalar {
        Scalar(Term::call(Kind::Call("contact"), vec![self.term(), k.into().0, c.into().0, rate.into().0]))
    }

    /// `dt(x)`: the total time derivative.
    #[must_use]
    #[track_caller]
    pub fn dt(&self) -> Scalar {
        Scalar(Term::call(Kind::Call("dt"), vec![self.term()]))
    }

    /// `x^n`
    #[must_use]
    #[track_caller]
    pub fn pow(&self, exponent: impl Into<Scalar>) -> Scalar {
        Scalar(Term::call(Kind::Binary(BinaryOperator::Pow), vec![self.term(), exponent.into().0]))
    }

    /// `if self < bound { yes } else { no }`
    #[must_use]
    #[track_caller]
    pub fn below(&self, bound: impl Into<Scalar>, yes: impl Into<Scalar>, no: impl Into<Scalar>) -> Scalar {
        Scalar(Term::call(Kind::Less, vec![self.term(), bound.into().0, yes.into().0, no.into().0]))
    }
}

impl Vector {
    /// `[x, y, z]`, in world axes.
    #[track_caller]
    pub fn new(x: impl Into<Scalar>, y: impl Into<Scalar>, z: impl Into<Scalar>) -> Self {
        Vector(Term::call(Kind::Array, vec![x.into().0, y.into().0, z.into().0]))
    }

    /// `v.x`: the component along the world's x.
    #[must_use]
    #[track_caller]
    pub fn x(&self) -> Scalar {
        Scalar(Term::call(Kind::Field("x"), vec![self.term()]))
    }

    /// `v.y`: the component along the world's y.
    #[must_use]
    #[track_caller]
    pub fn y(&self) -> Scalar {
        Scalar(Term::call(Kind::Field("y"), vec![self.term()]))
    }

    /// `v.z`: the component along the world's z.
    #[must_use]
    #[track_caller]
    pub fn z(&self) -> Scalar {
        Scalar(Term::call(Kind::Field("z"), vec![self.term()]))
    }

    /// `v.dot(w)`
    #[must_use]
    #[track_caller]
    pub fn dot(&self, other: impl Into<Vector>) -> Scalar {
        Scalar(Term::call(Kind::Method("dot"), vec![self.term(), other.into().0]))
    }

    /// `v.cross(w)`
    #[must_use]
    #[track_caller]
    pub fn cross(&self, other: impl Into<Vector>) -> Vector {
        Vector(Term::call(Kind::Method("cross"), vec![self.term(), other.into().0]))
    }

    /// `v.norm()`
    #[must_use]
    #[track_caller]
    pub fn norm(&self) -> Scalar {
        Scalar(Term::call(Kind::Method("norm"), vec![self.term()]))
    }

    /// `v.norm_squared()`
    #[must_use]
    #[track_caller]
    pub fn norm_squared(&self) -> Scalar {
        Scalar(Term::call(Kind::Method("norm_squared"), vec![self.term()]))
    }

    /// `dt(v)`: the total time derivative, as seen from the world.
    #[must_use]
    #[track_caller]
    pub fn dt(&self) -> Vector {
        Vector(Term::call(Kind::Call("dt"), vec![self.term()]))
    }
}

impl Pose {
    /// `world`
    pub fn world() -> Self {
        Pose(Term::leaf(Kind::Name("world".to_string())))
    }

    /// `translation([x, y, z])`
    #[track_caller]
    pub fn translation(by: impl Into<Vector>) -> Self {
        Pose(Term::call(Kind::Call("translation"), vec![by.into().0]))
    }

    /// `rotation([x, y, z], angle)`: about an axis of plain numbers.
    #[track_caller]
    pub fn rotation(axis: impl Into<Vector>, angle: impl Into<Scalar>) -> Self {
        Pose(Term::call(Kind::Call("rotation"), vec![axis.into().0, angle.into().0]))
    }

    /// `rpy(roll, pitch, yaw)`: about fixed axes x, y, z, one after the other.
    #[track_caller]
    pub fn rpy(roll: impl Into<Scalar>, pitch: impl Into<Scalar>, yaw: impl Into<Scalar>) -> Self {
        Pose(Term::call(Kind::Call("rpy"), vec![roll.into().0, pitch.into().0, yaw.into().0]))
    }

    /// `quaternion(w, x, y, z)`: of length 1, which a constraint keeps where coordinates are among them.
    #[track_caller]
    pub fn quaternion(w: impl Into<Scalar>, x: impl Into<Scalar>, y: impl Into<Scalar>, z: impl Into<Scalar>) -> Self {
        Pose(Term::call(Kind::Call("quaternion"), vec![w.into().0, x.into().0, y.into().0, z.into().0]))
    }

    /// `dh(theta, d, a, alpha)`: Denavit & Hartenberg, standard.
    #[track_caller]
    pub fn dh(theta: impl Into<Scalar>, d: impl Into<Scalar>, a: impl Into<Scalar>, alpha: impl Into<Scalar>) -> Self {
        Pose(Term::call(Kind::Call("dh"), vec![theta.into().0, d.into().0, a.into().0, alpha.into().0]))
    }

    /// `pose.inverse()`
    #[must_use]
    #[track_caller]
    pub fn inverse(&self) -> Pose {
        Pose(Term::call(Kind::Method("inverse"), vec![self.term()]))
    }

    /// `pose.origin()`
    #[must_use]
    #[track_caller]
    pub fn origin(&self) -> Vector {
        Vector(Term::call(Kind::Method("origin"), vec![self.term()]))
    }

    /// `pose.point([x, y, z])`: the place with these coordinates in the pose.
    #[must_use]
    #[track_caller]
    pub fn point(&self, coordinates: impl Into<Vector>) -> Vector {
        Vector(Term::call(Kind::Method("point"), vec![self.term(), coordinates.into().0]))
    }
}

/// `t`, in seconds.
///
/// ```
/// use mbs_derive::builder::{Mechanism, quantity, time};
/// let mut shaker = Mechanism::new("Shaker", "A mass on a spring whose end shakes.");
/// let x = shaker.coord("x", "m");
/// let shift = shaker.prescribed("shift", "m", quantity(0.01, "m") * (quantity(5.0, "rad/s") * time()).sin());
/// shaker.kinetic(quantity(0.5, "kg") * x.dt().pow(2.0));
/// shaker.potential(quantity(2.0, "N/m") * (&x - shift).pow(2.0));
/// assert!(shaker.generate(&Default::default()).is_ok());
/// ```
pub fn time() -> Scalar {
    Scalar(Term::leaf(Kind::Name("t".to_string())))
}

/// `0.3 kg`: a number with its unit, in place.
///
/// ```
/// use mbs_derive::builder::{Mechanism, quantity};
/// let mut spring = Mechanism::new("Spring", "A mass of half a kilogram on a spring.");
/// let x = spring.coord("x", "m");
/// spring.kinetic(quantity(0.25, "kg") * x.dt().pow(2.0));
/// spring.potential(quantity(2.0, "N/m") * x.pow(2.0));
/// assert!(spring.generate(&Default::default()).is_ok());
/// ```
pub fn quantity(number: f64, unit: &str) -> Scalar {
    Scalar(Term::leaf(Kind::Quantity(number, unit.to_string())))
}

/// `angular_velocity(pose)`
#[track_caller]
pub fn angular_velocity(pose: &Pose) -> Vector {
    Vector(Term::call(Kind::Call("angular_velocity"), vec![pose.term()]))
}

/// `particle(mass, position)`: ½ m v², a kinetic energy.
///
/// ```
/// use mbs_derive::builder::{Mechanism, Vector, particle};
/// let mut thrown = Mechanism::new("Thrown", "A stone in a plane.");
/// let [m, g] = [("m", "kg", 0.3), ("g", "m/s^2", 9.81)].map(|(name, unit, value)| thrown.param(name, unit, value));
/// let [x, z] = ["x", "z"].map(|name| thrown.coord(name, "m"));
/// thrown.kinetic(particle(&m, Vector::new(&x, 0.0, &z)));
/// thrown.potential(m * g * z);
/// assert_eq!(thrown.generate(&Default::default()).unwrap().dof, 2);
/// ```
#[track_caller]
pub fn particle(mass: impl Into<Scalar>, position: impl Into<Vector>) -> Scalar {
    Scalar(Term::call(Kind::Call("particle"), vec![mass.into().0, position.into().0]))
}

/// `rigid_body(mass, com, inertia, pose)`: a kinetic energy. Mass centre and inertia, about the mass centre, are in the
/// axes of the pose; the inertia's entries are xx, yy, zz, xy, xz, yz, as those of a matrix.
///
/// ```
/// use mbs_derive::builder::{Mechanism, Pose, Vector, angular_velocity, quantity, rigid_body};
/// let mut door = Mechanism::new("Door", "Turns about a vertical hinge.");
/// let leaf = Pose::rotation([0.0, 0.0, 1.0], &door.coord("angle", "rad"));
/// let (m, zero) = (quantity(20.0, "kg"), || quantity(0.0, "kg*m^2"));
/// let inertia = [quantity(7.0, "kg*m^2"), quantity(1.4, "kg*m^2"), quantity(8.3, "kg*m^2"), zero(), zero(), zero()];
/// let com = Vector::new(quantity(0.5, "m"), quantity(0.0, "m"), quantity(0.0, "m"));
/// door.kinetic(rigid_body(m, com, inertia, &leaf));
/// door.output("turn", &angular_velocity(&leaf));
/// assert!(door.generate(&Default::default()).is_ok());
/// ```
#[track_caller]
pub fn rigid_body(mass: impl Into<Scalar>, com: impl Into<Vector>, inertia: [Scalar; 6], pose: &Pose) -> Scalar {
    let inertia = Term::call(Kind::Call("inertia"), inertia.into_iter().map(|entry| entry.0).collect());
    Scalar(Term::call(Kind::Call("rigid_body"), vec![mass.into().0, com.into().0, inertia, pose.term()]))
}
