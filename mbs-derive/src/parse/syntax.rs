//! The declaration as it was written; every part keeps its byte range in the source.

use std::mem;

use crate::diagnostic::Diagnostics;

pub(crate) use crate::span::Span;

/// A name with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The identifier's text.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// `import "file.mbs";`
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The path as written, from the folder of the file that it stands in.
    pub path: String,
    /// Where it stands.
    pub span: Span,
}

/// One mechanism: the file that it stands in, and what that imports.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    /// `#![dimensionless]`: no dimensional analysis.
    pub dimensionless: bool,
    /// What its own file imports.
    pub imports: Vec<Import>,
    /// The constants and functions of all imported files, those that a file needs before its own.
    pub imported: Vec<Statement>,
    /// The mechanism's name.
    pub name: Name,
    /// Doc comments before `mechanism`, one line each, markers and the first space removed.
    pub docs: Vec<String>,
    /// What stands between the braces, behind the statements of robots that it imports.
    pub statements: Vec<Statement>,
    /// How many of them, the first ones, are those of robots.
    pub of_robots: usize,
    /// What is doubtful in the files that it imports.
    pub warnings: Diagnostics,
}

/// One statement of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// What it says.
    pub kind: StatementKind,
    /// From its first token to its semicolon or closing brace.
    pub span: Span,
}

/// What a statement says.
#[derive(Clone, Debug, PartialEq)]
pub enum StatementKind {
    /// `param mass[6]: kg = 1.0;`
    Param(Quantity),
    /// `coord q[6]: rad;`
    Coord(Quantity),
    /// `input tau[6]: N*m;`
    Input(Quantity),
    /// `const d[6]: m = [0.78, …];`: fixed at build time.
    Const(Quantity),
    /// `let name = value;`, `let mut name = value;`
    Let {
        /// May be assigned again.
        mutable: bool,
        /// The local name.
        name: Name,
        /// Its value.
        value: Expression,
    },
    /// `let name[n];`, `let mut name[n];`: an array whose elements are given their values one by one.
    Elements {
        /// Elements may be assigned again.
        mutable: bool,
        /// The local name.
        name: Name,
        /// How many, one length for each index.
        lengths: Vec<Expression>,
    },
    /// `name = value;`: a `let mut` takes a new value; `name[i] = value;`: an element is given its value.
    Assign {
        /// The local name.
        name: Name,
        /// Which element, if it is one.
        indices: Vec<Expression>,
        /// The value.
        value: Expression,
    },
    /// `kinetic += value;` and its like.
    Energy {
        /// Which of the mechanism's scalar functions grows.
        term: EnergyTerm,
        /// By what.
        value: Expression,
    },
    /// `force q[i] += value;`: a generalized force on a coordinate.
    Force {
        /// The coordinate.
        coordinate: Name,
        /// Its index, where it is an array.
        index: Option<Expression>,
        /// The generalized force.
        value: Expression,
    },
    /// `fn name(x, y) = body;`: a function of the mechanism's own.
    Function {
        /// Its name.
        name: Name,
        /// The names of its arguments.
        parameters: Vec<Name>,
        /// Its value.
        body: Expression,
    },
    /// `prescribed heave: m;`, `prescribed heave: m = a * sin(w * t);`: a motion given from outside, as a run-time
    /// signal with two derivatives or as a formula of the time.
    Prescribed(Quantity),
    /// `force at point += value;`: a force on a point, generalized by virtual work.
    ForceAt {
        /// Where it acts.
        point: Expression,
        /// The force, a vector.
        value: Expression,
    },
    /// `torque on pose += value;`: a torque on a body, generalized by virtual work.
    TorqueOn {
        /// The body's frame.
        pose: Expression,
        /// The torque, a vector.
        value: Expression,
    },
    /// `gravity [0, 0, -g];`: the uniform field that all bodies weigh in.
    Gravity {
        /// Its acceleration, a vector.
        acceleration: Expression,
    },
    /// `part name(x, y) { … }`: statements to be used many times.
    Part {
        /// Its name.
        name: Name,
        /// The names of its arguments.
        parameters: Vec<Name>,
        /// Its statements.
        body: Vec<Statement>,
    },
    /// `link arm(m, pose);`, `link leg[i](m, pose);`: a part used.
    Instance {
        /// The part.
        part: Name,
        /// What this one is called.
        name: Name,
        /// Which one, where it is an array.
        index: Option<Expression>,
        /// What the part is given.
        arguments: Vec<Expression>,
    },
    /// `reaction name at pose;`, `reaction name[i] at pose;`: the wrench that a joint transmits to what hangs on the
    /// pose.
    Reaction {
        /// Doc comments before it.
        docs: Vec<String>,
        /// Its name.
        name: Name,
        /// Which one, where it is an array.
        index: Option<Expression>,
        /// The variable that holds the pose.
        pose: Name,
        /// Which of its elements, if it is one.
        element: Vec<Expression>,
    },
    /// `constraint name: left = right;`, `constraint name[i]: left = right;`: holonomic where no velocity occurs, else
    /// linear in the velocities (Pfaffian).
    Constraint {
        /// Doc comments before it.
        docs: Vec<String>,
        /// Its name.
        name: Name,
        /// Which one, where it is an array.
        index: Option<Expression>,
        /// What is constrained: a number, a vector or an array.
        left: Expression,
        /// What it must equal, of the same shape or 0.
        right: Expression,
    },
    /// `output name = value;`, `output name[i] = value;`, `output name = value, jacobian_rate;`
    Output {
        /// Doc comments before it.
        docs: Vec<String>,
        /// Its name.
        name: Name,
        /// Which one, where it is an array.
        index: Option<Expression>,
        /// What is put out.
        value: Expression,
        /// Where the time derivative of its Jacobian is asked for, if it is.
        jacobian_rate: Option<Span>,
    },
    /// `shape pose += box([x, y, z]);` and its like: what a body looks like, for drawing alone.
    Shape {
        /// The frame that it is fixed in.
        pose: Expression,
        /// `box`, `cylinder`, `sphere` or `mesh`.
        kind: Name,
        /// The file of a mesh, as written.
        file: Option<String>,
        /// Its sizes.
        sizes: Vec<Expression>,
    },
    /// `for i in 0..6 { … }`
    For {
        /// The loop variable.
        variable: Name,
        /// First value.
        start: Expression,
        /// One past the last value.
        end: Expression,
        /// The statements repeated.
        body: Vec<Statement>,
    },
    /// `if n == 1 { … } else if n > 1 { … } else { … }`: decided at build time.
    If {
        /// Conditions, each with the statements that it chooses; the first one that holds counts.
        branches: Vec<(Expression, Vec<Statement>)>,
        /// The statements behind the last `else`.
        otherwise: Vec<Statement>,
    },
}

/// The scalar functions that a mechanism is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyTerm {
    /// `kinetic`
    Kinetic,
    /// `potential`
    Potential,
    /// `dissipation`: Rayleigh's function.
    Dissipation,
    /// `lagrangian`: terms that are neither kinetic nor potential energy.
    Lagrangian,
}

/// `name[length]: unit = value, positive`: what `param`, `coord`, `input` and `const` declare.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Doc comments before it.
    pub docs: Vec<String>,
    /// Its name.
    pub name: Name,
    /// How many, where it is an array.
    pub length: Option<Expression>,
    /// How many columns, where it is a matrix.
    pub columns: Option<Expression>,
    /// Its unit; absent where none was written.
    pub unit: Option<Unit>,
    /// Its default or value; absent where none was written.
    pub value: Option<Expression>,
    /// The word `positive` behind the default of a parameter.
    pub positive: Option<Span>,
}

/// A unit as written: a product of powers of named units. `1` is the empty product.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its factors in source order.
    pub factors: Vec<UnitFactor>,
    /// Where it stands.
    pub span: Span,
}

/// `m^2`; a factor after `/` has its exponent negated.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// The unit's name.
    pub name: Name,
    /// Numerator and denominator of its exponent.
    pub exponent: (i32, i32),
}

/// An expression with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// What it is.
    pub kind: ExpressionKind,
    /// Where it stands.
    pub span: Span,
}

impl Expression {
    /// The leftmost operand of a chain of operators, then every operator with its right operand, in source order.
    ///
    /// `a*b + c - d` is `a`, then `* b`, `+ c`, `- d`: computing from left to right needs no recursion. A sum of many
    /// terms is as deep as it is long, on its left side; everything else is at most a few hundred levels deep.
    pub fn left_spine(&self) -> (&Expression, Vec<(BinaryOperator, &Expression)>) {
        let (mut first, mut steps) = (self, Vec::new());
        while let ExpressionKind::Binary(operator, left, right) = &first.kind {
            steps.push((*operator, &**right));
            first = left;
        }
        steps.reverse();
        (first, steps)
    }

    /// The name and the indices, in source order, where it is an element: `p[i][j]`, or `p` without any.
    pub fn element_of(&self) -> Option<(&str, Vec<&Expression>)> {
        let (mut whole, mut indices) = (self, Vec::new());
        while let ExpressionKind::Index(array, index) = &whole.kind {
            indices.push(&**index);
            whole = array;
        }
        indices.reverse();
        match &whole.kind {
            ExpressionKind::Name(name) => Some((name, indices)),
            _ => None,
        }
    }

    /// The expressions that it is directly made of, in source order.
    pub fn operands(&self) -> Vec<&Expression> {
        match &self.kind {
            ExpressionKind::Number(_) | ExpressionKind::Quantity(..) | ExpressionKind::Name(_) => Vec::new(),
            ExpressionKind::Negate(a) | ExpressionKind::Not(a) | ExpressionKind::Field(a, _) => vec![a],
            ExpressionKind::Binary(_, a, b)
            | ExpressionKind::Index(a, b)
            | ExpressionKind::Compare(_, a, b)
            | ExpressionKind::And(a, b)
            | ExpressionKind::Or(a, b) => vec![a, b],
            ExpressionKind::If(a, b, c) => vec![a, b, c],
            ExpressionKind::Call(_, arguments) | ExpressionKind::Array(arguments) => arguments.iter().collect(),
            ExpressionKind::Method(a, _, arguments) => std::iter::once(&**a).chain(arguments).collect(),
        }
    }

    /// All expressions that it is made of, itself included.
    pub fn parts(&self) -> impl Iterator<Item = &Expression> {
        let mut waiting = vec![self];
        std::iter::from_fn(move || {
            let part = waiting.pop()?;
            waiting.extend(part.operands());
            Some(part)
        })
    }

    /// Takes the left operand out of a chain.
    fn take_left(&mut self) -> Option<Expression> {
        match &mut self.kind {
            ExpressionKind::Binary(_, left, _) if matches!(left.kind, ExpressionKind::Binary(..)) => {
                let nothing = Expression { kind: ExpressionKind::Name(String::new()), span: 0..0 };
                Some(mem::replace(left, nothing))
            }
            _ => None,
        }
    }
}

/// A sum of many terms is dropped term by term: the compiler's way would recurse over all of them.
impl Drop for Expression {
    fn drop(&mut self) {
        let mut rest = self.take_left();
        while let Some(mut chain) = rest {
            rest = chain.take_left();
        }
    }
}

/// What an expression is.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// `2`, `9.81`, `1e-3`: the decimal as written, underscores removed; it is an exact rational.
    Number(String),
    /// `0.3 kg`: a decimal with its unit.
    Quantity(String, Unit),
    /// `x`
    Name(String),
    /// `-x`
    Negate(Box<Expression>),
    /// `x + y` and its like.
    Binary(BinaryOperator, Box<Expression>, Box<Expression>),
    /// `f(x, y)`
    Call(Name, Vec<Expression>),
    /// `x.f(y)`
    Method(Box<Expression>, Name, Vec<Expression>),
    /// `v.z`
    Field(Box<Expression>, Name),
    /// `q[i]`
    Index(Box<Expression>, Box<Expression>),
    /// `[x, y, z]`
    Array(Vec<Expression>),
    /// `if x < 0 { y } else { z }`
    If(Box<Expression>, Box<Expression>, Box<Expression>),
    /// `x < y` and its like; only in conditions.
    Compare(Comparison, Box<Expression>, Box<Expression>),
    /// `a && b`
    And(Box<Expression>, Box<Expression>),
    /// `a || b`
    Or(Box<Expression>, Box<Expression>),
    /// `!a`
    Not(Box<Expression>),
}

/// The comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`; of constants only.
    Equal,
    /// `!=`; of constants only.
    NotEqual,
}

/// The binary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOperator {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `^`, right-associative, binds tighter than unary minus on its left.
    Pow,
}
