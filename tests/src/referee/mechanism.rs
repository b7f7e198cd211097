//! What a text declares: its statements in order, and how many of everything there are.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::evaluate::{Evaluator, State};
use super::lagrange::{Wanted, Written};
use super::number::{Real, reseed};
use super::syntax::{self, Declaration, Expression, File, Kind, Statement};
use super::unit::{self, Dimension, PLAIN};
use super::wide::Wide;

/// A declared name: how many numbers it has before it, and how many it holds if it is an array.
pub(super) type Variable = (Rc<str>, usize, Option<usize>);

/// Arguments and body of each function of the text.
type Functions = BTreeMap<Rc<str>, (Vec<Rc<str>>, Rc<Expression>)>;

/// Arguments and statements of each part.
type Parts = BTreeMap<Rc<str>, (Vec<Rc<str>>, Rc<Vec<Statement>>)>;

/// A mechanism as the referee reads it.
#[derive(Debug)]
pub(super) struct Mechanism {
    /// Those of imported files come first.
    pub(super) statements: Vec<Statement>,
    pub(super) functions: Functions,
    pub(super) parts: Parts,
    /// Of constants that have one.
    pub(super) dimensions: BTreeMap<Rc<str>, Dimension>,
    pub(super) coordinates: Vec<Variable>,
    /// Which of the coordinates are angles, or plain numbers.
    pub(super) angles: Vec<usize>,
    pub(super) prescribed: Vec<Variable>,
    pub(super) inputs: Vec<Variable>,
    /// Defaults of the parameters, in SI.
    pub(super) defaults: Vec<f64>,
    /// Names of the outputs.
    pub(super) outputs: Vec<Rc<str>>,
    /// Number of joints whose wrenches are wanted.
    pub(super) joints: Vec<(Rc<str>, usize)>,
    /// Which components of which constraints do not vanish identically, and whether they are holonomic.
    pub(super) rows: Vec<(usize, bool)>,
    /// The constraint that each of these rows is a component of.
    pub(super) vectors: Vec<usize>,
    /// Where quaternions that are coordinates begin.
    pub(super) quaternions: Vec<usize>,
}

impl Mechanism {
    /// Reads a text and what it imports.
    ///
    /// # Errors
    /// What the referee does not understand.
    pub(super) fn read(text: &str, import: &dyn Fn(&str) -> Option<String>) -> Result<Self, String> {
        let mut statements = Vec::new();
        gather(text, import, &mut Vec::new(), &mut statements)?;
        let mut mechanism = Mechanism {
            functions: functions(&statements),
            parts: parts(&statements),
            statements,
            dimensions: BTreeMap::new(),
            coordinates: Vec::new(),
            angles: Vec::new(),
            prescribed: Vec::new(),
            inputs: Vec::new(),
            defaults: Vec::new(),
            outputs: Vec::new(),
            joints: Vec::new(),
            rows: Vec::new(),
            vectors: Vec::new(),
            quaternions: Vec::new(),
        };
        mechanism.declare()?;
        mechanism.classify()?;
        Ok(mechanism)
    }

    /// The number of coordinates.
    pub(super) fn dof(&self) -> usize {
        count(&self.coordinates)
    }

    pub(super) fn coordinate(&self, name: &str) -> Option<(usize, Option<usize>)> {
        self.coordinates.iter().find(|(known, ..)| known.as_ref() == name).map(|(_, first, length)| (*first, *length))
    }

    /// Finds out lengths and defaults, declaration by declaration.
    fn declare(&mut self) -> Result<(), String> {
        let state = State::<Wide> {
            t: Wide::from(0.0),
            q: Vec::new(),
            qd: Vec::new(),
            qdd: Vec::new(),
            u: Vec::new(),
            prescribed: Vec::new(),
            parameters: Vec::new(),
        };
        let declarations: Vec<Declaration> = self.statements.iter().filter_map(declaration).cloned().collect();
        for (i, declaration) in declarations.iter().enumerate() {
            // What was declared before is evaluated anew: a referee may be slow.
            let mut evaluator = Evaluator::new(self, &state);
            for before in &declarations[..i] {
                evaluator.declaration(before)?;
            }
            let lengths = evaluator.lengths(declaration)?;
            let length = (!lengths.is_empty()).then(|| lengths.iter().product());
            match (declaration.keyword.as_str(), &declaration.value) {
                ("param", Some(value)) => {
                    let defaults = evaluator.converted(declaration, value, &lengths)?.flat();
                    self.defaults.extend(defaults.iter().map(|value| value.value()));
                }
                ("const", Some(value)) => {
                    let dimension = match &declaration.unit {
                        Some(unit) => unit::meaning(unit)?.1,
                        None => unit::dimension(value, &self.dimensions),
                    };
                    if dimension != PLAIN {
                        self.dimensions.insert(declaration.name.clone(), dimension);
                    }
                }
                ("coord", _) => {
                    let first = count(&self.coordinates);
                    add(&mut self.coordinates, declaration, length);
                    if declaration.unit.as_ref().is_some_and(|unit| unit::meaning(unit).is_ok_and(|(_, d)| d == PLAIN))
                    {
                        self.angles.extend(first..count(&self.coordinates));
                    }
                }
                ("prescribed", _) => add(&mut self.prescribed, declaration, length),
                ("input", _) => add(&mut self.inputs, declaration, length),
                _ => {}
            }
        }
        let expressions = self.statements.iter().flat_map(Statement::expressions);
        let mut found: Vec<usize> = expressions.flat_map(|e| self.quaternions_in(e)).collect();
        found.sort_unstable();
        found.dedup();
        self.quaternions = found;
        Ok(())
    }

    /// Where the arrays of coordinates begin that are written as components of a quaternion.
    fn quaternions_in(&self, expression: &Expression) -> Vec<usize> {
        let mut found: Vec<usize> = expression.parts().into_iter().flat_map(|part| self.quaternions_in(part)).collect();
        if let Kind::Call(name, arguments) = &expression.kind
            && name.as_ref() == "quaternion"
            && let Some(first) = arguments.first()
            && let Kind::Name(name) = (if let Kind::Index(base, _) = &first.kind { &base.kind } else { &first.kind })
        {
            found.extend(self.coordinate(name).map(|(first, _)| first));
        }
        found
    }

    /// Finds out, at states of no meaning, which rows there are, and how many joints.
    fn classify(&mut self) -> Result<(), String> {
        reseed(1);
        let (mut moves, mut pfaffian) = (Vec::new(), Vec::new());
        let nonzero = |x: &Wide| x.value().is_nan() || x.value().abs() > 1e-24;
        for k in 0..3 {
            let state = self.anywhere(k);
            let sums = Evaluator::new(self, &state).run()?;
            let rows = Written::at(self, &state)?.equations(&state, 0..self.dof(), Wanted::Rows).rows;
            moves.resize(rows.len(), false);
            pfaffian.resize(sums.constraints.len(), false);
            let owners = sums.constraints.iter().enumerate().flat_map(|(i, row)| vec![i; row.components.len()]);
            let owners: Vec<usize> = owners.collect();
            for ((row, &owner), moves) in rows.iter().zip(&owners).zip(&mut moves) {
                pfaffian[owner] |= row.by_value.iter().any(nonzero);
                *moves |= row.by_value.iter().chain(&row.by_rate).chain(&row.along[..2]).any(nonzero);
            }
            let kinds =
                sums.constraints.iter().zip(&pfaffian).flat_map(|(row, kind)| vec![!kind; row.components.len()]);
            let numbered = kinds.enumerate().zip(&moves).filter(|(_, moves)| **moves);
            self.rows = numbered.map(|(row, _)| row).collect();
            self.vectors = self.rows.iter().map(|(row, _)| owners[*row]).collect();
            self.joints = sums.joints;
            self.outputs = sums.outputs.into_iter().map(|(name, _)| name).collect();
        }
        Ok(())
    }

    /// Some state with all numbers different.
    fn anywhere(&self, k: usize) -> State<Wide> {
        let mut last = 0.1 + 0.07 * k as f64;
        let mut next = || {
            last = (last * 1.618 + 0.271) % 1.0;
            Wide::from(last)
        };
        let mut some = |n: usize| (0..n).map(|_| next()).collect::<Vec<_>>();
        let n = self.dof();
        let (q, qd, qdd, u) = (some(n), some(n), some(n), some(count(&self.inputs)));
        let prescribed = some(3 * count(&self.prescribed)).chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
        let parameters = self.defaults.iter().map(|&value| Wide::from(value)).collect();
        State { t: some(1)[0], q, qd, qdd, u, prescribed, parameters }
    }
}

fn add(list: &mut Vec<Variable>, declaration: &Declaration, length: Option<usize>) {
    let first = count(list);
    list.push((declaration.name.clone(), first, length));
}

/// How many numbers variables hold.
pub(super) fn count(list: &[Variable]) -> usize {
    list.last().map_or(0, |(_, first, length)| first + length.unwrap_or(1))
}

fn declaration(statement: &Statement) -> Option<&Declaration> {
    match statement {
        Statement::Declaration(declaration) => Some(declaration),
        _ => None,
    }
}

fn functions(statements: &[Statement]) -> Functions {
    let functions = statements.iter().filter_map(|statement| match statement {
        Statement::Function { name, arguments, body } => Some((name.clone(), (arguments.clone(), body.clone()))),
        _ => None,
    });
    functions.collect()
}

fn parts(statements: &[Statement]) -> Parts {
    let parts = statements.iter().filter_map(|statement| match statement {
        Statement::Part { name, arguments, body } => Some((name.clone(), (arguments.clone(), body.clone()))),
        _ => None,
    });
    parts.collect()
}

/// The statements of a file after those that it imports, each file once.
fn gather(
    text: &str,
    import: &dyn Fn(&str) -> Option<String>,
    seen: &mut Vec<String>,
    statements: &mut Vec<Statement>,
) -> Result<(), String> {
    let File { imports, statements: own, .. } = syntax::read(text)?;
    for path in imports {
        if !seen.contains(&path) {
            seen.push(path.clone());
            let text = import(&path).ok_or_else(|| format!("there is no file {path}"))?;
            if path.ends_with(".csv") {
                statements.extend(syntax::read_table(&text)?);
            } else {
                gather(&text, import, seen, statements)?;
            }
        }
    }
    statements.extend(own);
    Ok(())
}
