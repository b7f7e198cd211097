//! What stands in functions, as a tree: statements, patterns and expressions, each with its text.

/// `{ … }`
#[derive(Debug)]
pub(in crate::proofread) struct Block<'t> {
    pub(in crate::proofread) statements: Vec<Statement<'t>>,
    /// The expression without a semicolon that it ends with.
    pub(in crate::proofread) value: Option<Box<Expression<'t>>>,
}

/// A statement.
#[derive(Debug)]
pub(in crate::proofread) enum Statement<'t> {
    /// `let pattern = value;`
    Let(Pattern<'t>, Expression<'t>),
    /// `let [a, b]: [T; 2];`, with the text of the type.
    Declare(Pattern<'t>, &'t str),
    /// `static NAME: [f64; 2] = value;`
    Static(&'t str, Expression<'t>),
    /// `place = value;`
    Assign(Expression<'t>, Expression<'t>),
    /// `for pattern in values { … }`
    For(Pattern<'t>, Expression<'t>, Block<'t>),
    /// `value?;`
    Try(Expression<'t>),
    /// A block.
    Block(Block<'t>),
}

/// A pattern, and its text.
#[derive(Debug)]
pub(in crate::proofread) struct Pattern<'t> {
    pub(in crate::proofread) kind: PatternKind<'t>,
    pub(in crate::proofread) text: &'t str,
}

#[derive(Debug)]
pub(in crate::proofread) enum PatternKind<'t> {
    Wild,
    /// A name, and whether it may be given other values.
    Name(&'t str, bool),
    /// A pattern, and the text of its type.
    Typed(Box<Pattern<'t>>, &'t str),
    /// `[a, b]`, and whether `..` is behind.
    List(Vec<Pattern<'t>>, bool),
    Tuple(Vec<Pattern<'t>>),
    /// `Params { m, k: [a, b] }`, and whether `..` is behind.
    Record(String, Vec<(&'t str, Pattern<'t>)>, bool),
}

/// An expression, and its text.
#[derive(Debug)]
pub(in crate::proofread) struct Expression<'t> {
    pub(in crate::proofread) kind: ExpressionKind<'t>,
    pub(in crate::proofread) text: &'t str,
}

#[derive(Debug)]
pub(in crate::proofread) enum ExpressionKind<'t> {
    /// A literal with a point or an exponent.
    Float(f64),
    Integer(usize),
    Text(String),
    /// `_`
    Wild,
    /// Names with `::` between them, and none in front.
    Path(String),
    /// An expression in brackets, or a reference to one.
    Same(Box<Expression<'t>>),
    /// `-`, `!` or `*`, and its operand.
    Unary(char, Box<Expression<'t>>),
    /// `+`, `-`, `*`, `/` or `&`, and its operands.
    Binary(char, Box<[Expression<'t>; 2]>),
    /// `a..b`
    Range(Box<[Expression<'t>; 2]>),
    Array(Vec<Expression<'t>>),
    /// `[value; length]`
    Repeat(Box<[Expression<'t>; 2]>),
    Tuple(Vec<Expression<'t>>),
    Record(String, Vec<(&'t str, Expression<'t>)>),
    Block(Block<'t>),
    /// A closure without arguments.
    Closure(Box<Expression<'t>>),
    /// A closure with arguments.
    Function,
    Field(Box<Expression<'t>>, &'t str),
    Index(Box<[Expression<'t>; 2]>),
    Call(String, Vec<Expression<'t>>),
    Method(Box<Expression<'t>>, &'t str, Vec<Expression<'t>>),
}

/// A text without spaces.
pub(in crate::proofread) fn compact(text: &str) -> String {
    text.split_whitespace().collect()
}
