//! One function body: bindings, then the result.
//!
//! A value that is used once is written where it is used, as long as that stays short; one that is used more often gets
//! a `let`, and a name that says what it is where there is one: `sin_theta`, `m_1_0`, else `t12`.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Function, Trigonometry};
use crate::optimise::region::{Branch, Place, Region};
use crate::optimise::{Instruction, Program, Value};

use super::angles::{Angles, Wanted};
use super::expression::Tree;
use super::links;
use super::name::{Names, Scope};
pub(super) use super::statement::{Angle, Block, Component, Leaves, Statement, locals};

/// Operations and characters that one expression has at most.
const LONGEST: (usize, usize) = (6, 60);

/// Operations of a component that is written in the result without a name, where there are few components or many.
const IN_RESULT: [usize; 2] = [4, 2];

/// Constants with names, bound where they are used.
pub(super) const FAMILIAR: [(f64, &str); 8] = [
    (0.0, "zero"),
    (1.0, "one"),
    (2.0, "two"),
    (3.0, "three"),
    (4.0, "four"),
    (0.5, "half"),
    (0.25, "quarter"),
    (1.0 / 3.0, "third"),
];

/// For this many characters a constant counts of which only the kind is known.
const LONGEST_CONSTANT: usize = 20;

/// A name counts for this many characters at most.
const WIDEST: usize = 6;

/// A body before it is printed.
#[derive(Clone, Debug)]
pub(super) struct Body<'n> {
    pub(super) names: &'n Names,
    pub(super) scope: Scope,
    /// Whether it is of a long chain, whose links are written alike: how long numbers and names are is not looked at.
    pub(super) is_of_long_chain: bool,
    /// What the familiar constants are called.
    pub(super) familiar: [String; FAMILIAR.len()],
    /// What `T::from_f64` is called.
    pub(super) convert: String,
    /// The names of the locals.
    pub(super) locals: Vec<String>,
    /// The links that they belong to.
    pub(super) links: Vec<Option<usize>>,
    /// How many parts of a name there are.
    parts: BTreeMap<String, usize>,
    /// Those that are computed on demand.
    pub(super) on_demand: BTreeSet<usize>,
    /// Its results are in the order of the components.
    pub(super) block: Block,
    /// What that reads.
    pub(super) leaves: Leaves,
}

impl<'n> Body<'n> {
    /// Of the statements that `components` of a program's results need; the locals get their names from `scope`.
    pub(super) fn new(program: &Program, components: &[Component], names: &'n Names, mut scope: Scope) -> Self {
        let familiar = FAMILIAR.map(|(_, name)| scope.unique(name));
        let convert = scope.unique("c");
        let (locals, links, parts, on_demand) = (Vec::new(), Vec::new(), BTreeMap::new(), BTreeSet::new());
        let (block, leaves) = (Block::default(), Leaves::default());
        let is_of_long_chain = links::are_many(program);
        let body =
            Body { names, scope, is_of_long_chain, familiar, convert, locals, links, parts, on_demand, block, leaves };
        let (program, components) = restricted(program, components);
        let mut writer = Writer::new(&program, &components, body);
        writer.write();
        writer.finish(&components)
    }

    /// The body with other texts for its locals, and further ones.
    pub(super) fn renamed(&self, locals: Vec<String>) -> Self {
        Body { locals, ..self.clone() }
    }

    fn local(&mut self, wish: Wish, link: Option<usize>) -> usize {
        let name = match &wish {
            Wish::Name(name) => self.scope.exactly(name).unwrap_or_else(|| self.part(name)),
            Wish::PartOf(name) => self.part(name),
            Wish::Number => {
                let mut numbered = (self.locals.len()..).map(|i| format!("t{i}"));
                numbered.find_map(|name| self.scope.exactly(&name)).expect("there are enough numbers")
            }
        };
        self.locals.push(name);
        self.links.push(link);
        self.locals.len() - 1
    }

    /// `name_a`, `name_b`, …: the next one that is free.
    fn part(&mut self, name: &str) -> String {
        let next = self.parts.entry(name.to_string()).or_insert(0);
        loop {
            let part = format!("{name}_{}", letters(*next));
            *next += 1;
            if let Some(free) = self.scope.exactly(&part) {
                return free;
            }
        }
    }

    /// The name of a symbol, a hoisted value or a local.
    pub(super) fn name(&self, leaf: &Tree) -> &str {
        match leaf {
            Tree::Symbol(symbol) => self.names.symbol(*symbol),
            Tree::Hoisted(k) => &self.names.hoisted[*k as usize],
            Tree::Local(i) => &self.locals[*i],
            Tree::Constant(_)
            | Tree::Neg(_)
            | Tree::Add(..)
            | Tree::Sub(..)
            | Tree::Mul(..)
            | Tree::Div(..)
            | Tree::Less(..)
            | Tree::LessEqual(..)
            | Tree::And(..)
            | Tree::Not(_)
            | Tree::Select(..)
            | Tree::Method(..) => unreachable!("only leaves have names"),
        }
    }

    /// About how many characters a tree takes.
    fn width(&self, tree: &Tree) -> usize {
        let own = match tree {
            Tree::Constant(value) => {
                if familiar(*value).is_some() {
                    4
                } else if self.is_of_long_chain {
                    LONGEST_CONSTANT
                } else {
                    format!("c({value:?})").len()
                }
            }
            // A long name says more; it is no reason to cut an expression into more pieces.
            Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) if self.is_of_long_chain => WIDEST,
            Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => self.name(tree).len().min(WIDEST),
            Tree::Neg(_) | Tree::Not(_) => 1,
            Tree::Add(..) | Tree::Sub(..) | Tree::Mul(..) | Tree::Div(..) | Tree::And(..) => 3,
            Tree::Less(..) | Tree::LessEqual(..) => 7,
            Tree::Select(..) => LONGEST.1,
            Tree::Method(name, _, arguments) => name.len() + 3 + 2 * arguments.len().saturating_sub(1),
        };
        own + tree.children().into_iter().map(|child| self.width(child)).sum::<usize>()
    }

    fn is_short(&self, tree: &Tree) -> bool {
        tree.operations() <= LONGEST.0 && self.width(tree) <= LONGEST.1
    }

    /// Words for a short expression, for use in a name.
    fn describe(&self, tree: &Tree) -> Option<String> {
        let words = match tree {
            Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => self.name(tree).to_string(),
            Tree::Constant(value) if value.fract() == 0.0 && (0.0..100.0).contains(value) => format!("{value}"),
            Tree::Constant(_)
            | Tree::Div(..)
            | Tree::Less(..)
            | Tree::LessEqual(..)
            | Tree::And(..)
            | Tree::Not(_)
            | Tree::Select(..) => return None,
            Tree::Neg(a) => format!("minus_{}", self.describe(a)?),
            Tree::Add(a, b) => format!("{}_plus_{}", self.describe(a)?, self.describe(b)?),
            Tree::Sub(a, b) => format!("{}_minus_{}", self.describe(a)?, self.describe(b)?),
            Tree::Mul(a, b) => format!("{}_{}", self.describe(a)?, self.describe(b)?),
            Tree::Method("mul_add", a, rest) => {
                format!("{}_{}_plus_{}", self.describe(a)?, self.describe(&rest[0])?, self.describe(&rest[1])?)
            }
            Tree::Method(name, a, rest) if rest.is_empty() => format!("{name}_{}", self.describe(a)?),
            Tree::Method(..) => return None,
        };
        (words.len() <= 32).then_some(words)
    }
}

/// What a local would be called.
enum Wish {
    /// So, or as a part of it where that is taken.
    Name(String),
    /// As a part of what it contributes to.
    PartOf(String),
    /// It contributes to nothing that has a name.
    Number,
}

/// a, b, …, z, aa, ab, …
fn letters(number: usize) -> String {
    let last = char::from(b'a' + (number % 26) as u8);
    if number < 26 { last.to_string() } else { letters(number / 26 - 1) + &last.to_string() }
}

/// Writes the instructions of a program as statements.
struct Writer<'p, 'n> {
    program: &'p Program,
    /// How often each value is used by what the components need; a sine and a cosine of one angle use it once.
    uses: Vec<usize>,
    /// Those whose sines and cosines are computed by statements.
    angles: Angles,
    /// Several derivatives of one spline at one argument, by their orders.
    splines: BTreeMap<(u32, Value), Vec<(usize, Value)>>,
    /// Names that values have as results, or where they were derived.
    wishes: BTreeMap<Value, String>,
    /// The links that values with names belong to.
    links: BTreeMap<Value, usize>,
    /// To what with a name each value contributes first.
    goals: Vec<Option<Value>>,
    /// The values that are known and not used up.
    trees: Vec<Option<Tree>>,
    /// The values that are or were known.
    known: Vec<bool>,
    /// The statements of each region, those of finished ones taken.
    statements: Vec<Vec<Statement>>,
    /// The region that is written to.
    region: Region,
    body: Body<'n>,
}

impl<'p, 'n> Writer<'p, 'n> {
    fn new(program: &'p Program, components: &[Component], body: Body<'n>) -> Self {
        let mut uses = vec![0; program.instructions.len()];
        let mut wishes = BTreeMap::new();
        for component in components {
            if let Component::Result(number, wish) = component {
                let value = program.results[*number];
                uses[value.index()] += 1;
                if !wish.is_empty() {
                    wishes.entry(value).or_insert_with(|| wish.clone());
                }
            }
        }
        let mut links = BTreeMap::new();
        for (value, name) in &program.notes {
            wishes.entry(*value).or_insert_with(|| name.clone());
            links.extend(links::of_note(name).map(|link| (*value, link)));
        }
        let mut goals = vec![None; program.instructions.len()];
        for (i, instruction) in program.instructions.iter().enumerate().rev() {
            if uses[i] == 0 {
                continue;
            }
            if wishes.contains_key(&value(i)) {
                goals[i] = Some(value(i));
            }
            for operand in instruction.operands() {
                uses[operand.index()] += 1;
                goals[operand.index()] = goals[i].or(goals[operand.index()]);
            }
        }
        let angles = Angles::new(program, |value| uses[value.index()] > 0);
        angles.iter().filter(|wanted| wanted.is_pair()).for_each(|wanted| uses[wanted.angle.index()] -= 1);
        let splines = Self::splines(program, &mut uses);
        let (trees, statements) = (vec![None; uses.len()], vec![Vec::new(); program.regions.count()]);
        let (known, region) = (vec![false; uses.len()], Region::BODY);
        Writer { program, uses, angles, splines, wishes, links, goals, trees, known, statements, region, body }
    }

    /// The derivatives of a spline at one argument that are computed at one place, which use the argument once.
    fn splines(program: &Program, uses: &mut [usize]) -> BTreeMap<(u32, Value), Vec<(usize, Value)>> {
        let mut splines: BTreeMap<(u32, Value), Vec<(usize, Value)>> = BTreeMap::new();
        for (i, instruction) in program.instructions.iter().enumerate().filter(|(i, _)| uses[*i] > 0) {
            if let Instruction::Spline(derivative, argument) = *instruction {
                splines.entry((derivative.spline, argument)).or_default().push((derivative.order as usize, value(i)));
            }
        }
        splines.retain(|_, derivatives| {
            let places: Vec<Place> = derivatives.iter().map(|(_, value)| program.regions.place(*value)).collect();
            derivatives.len() > 1 && places.iter().all(|place| *place == places[0] && place.on_demand.is_none())
        });
        splines.values_mut().for_each(|derivatives| derivatives.sort_unstable());
        splines.iter().for_each(|((_, argument), derivatives)| uses[argument.index()] -= derivatives.len() - 1);
        splines
    }

    fn write(&mut self) {
        for i in 0..self.program.instructions.len() {
            self.write_value(i);
        }
    }

    /// The value of one instruction, after what it needs; once.
    fn write_value(&mut self, i: usize) {
        if self.uses[i] == 0 || self.known[i] {
            return;
        }
        self.known[i] = true;
        let instruction = self.program.instructions[i];
        let place = self.program.regions.place(value(i));
        self.region = place.on_demand.unwrap_or(place.region);
        if self.is_computed_at_once(value(i)) {
            self.sin_cos(value(i));
            if place.on_demand.is_none() {
                return;
            }
        }
        if let Instruction::Spline(derivative, argument) = instruction
            && let Some(derivatives) = self.splines.get(&(derivative.spline, argument)).cloned()
        {
            self.spline(derivative.spline, argument, &derivatives);
            return;
        }
        if let Some(branch) = self.program.regions.branch(value(i)) {
            self.branch(branch);
        }
        let tree = match self.trees[i].take() {
            Some(known) => known,
            None => self.tree(value(i), instruction),
        };
        if place.on_demand.is_some() {
            self.trees[i] = Some(self.on_demand(value(i), tree, place));
            return;
        }
        let shared = (self.uses[i] > 1 && !tree.is_free()) || matches!(tree, Tree::Select(..));
        self.trees[i] = Some(if shared { self.bind(value(i), tree) } else { tree });
    }

    /// Whether it is a sine or cosine that a statement binds: of the library those that are needed both.
    fn is_computed_at_once(&self, value: Value) -> bool {
        let is_library = self.body.names.trigonometry == Trigonometry::Library;
        self.angles.of(value).is_some_and(|wanted| !is_library || wanted.is_pair())
    }

    /// Selections on one condition.
    fn branch(&mut self, branch: &Branch) {
        let selections = &branch.selections;
        let condition = self.take(branch.condition);
        let sides = [0, 1].map(|side| {
            let results = selections.iter().map(|&selection| match self.program.instructions[selection.index()] {
                Instruction::Select(_, a, b) => self.take([a, b][side]),
                other => unreachable!("a branch selects, {other:?} does not"),
            });
            let results = results.collect();
            Block { statements: std::mem::take(&mut self.statements[branch.sides[side].index()]), results }
        });
        let locals = self.locals(selections);
        for (selection, &local) in selections.iter().zip(&locals) {
            self.know(*selection, local);
        }
        self.push(Statement::Branch(locals, condition, sides));
    }

    /// A value that is computed when it is first asked for, where there is anything to compute.
    fn on_demand(&mut self, value: Value, tree: Tree, place: Place) -> Tree {
        let statements = std::mem::take(&mut self.statements[self.region.index()]);
        if statements.is_empty() && tree.is_free() {
            return tree;
        }
        let local = self.local(value, &tree);
        self.body.on_demand.insert(local);
        self.region = place.region;
        self.push(Statement::OnDemand(local, Block { statements, results: vec![tree] }));
        Tree::Local(local)
    }

    fn push(&mut self, statement: Statement) {
        self.statements[self.region.index()].push(statement);
    }

    /// A value is known by a local.
    fn know(&mut self, value: Value, local: usize) {
        self.known[value.index()] = true;
        self.trees[value.index()] = Some(Tree::Local(local));
    }

    /// One call for a sine or cosine, and all that can be computed with it.
    fn sin_cos(&mut self, value: Value) {
        let (region, known) = (self.region, &self.known);
        let (group, before) = match self.body.names.trigonometry {
            Trigonometry::Library => (self.angles.of(value).into_iter().collect(), BTreeSet::new()),
            Trigonometry::Polynomials => {
                // The one that is asked for is not known yet, though it is being written.
                self.angles.together(self.program, value, |other| other != value && known[other.index()])
            }
        };
        before.into_iter().for_each(|value| self.write_value(value.index()));
        self.region = region;
        let angles = group.into_iter().map(|wanted| self.angle(wanted)).collect();
        self.push(Statement::SinCos(angles));
    }

    fn angle(&mut self, wanted: Wanted) -> Angle {
        let tree = self.take(wanted.angle);
        let words = self.body.describe(&tree);
        let [sin, cos] = [(Function::Sin, wanted.sin), (Function::Cos, wanted.cos)].map(|(function, value)| {
            value.map(|value| {
                let wish = words.as_ref().map(|words| Wish::Name(format!("{}_{words}", function.name())));
                let wish = wish.unwrap_or_else(|| self.wish(value, &Tree::Constant(0.0)));
                let local = self.body.local(wish, None);
                self.know(value, local);
                local
            })
        });
        Angle { tree, sin, cos }
    }

    /// One call for all derivatives.
    fn spline(&mut self, spline: u32, argument: Value, derivatives: &[(usize, Value)]) {
        let argument = self.take(argument);
        let (orders, values): (Vec<usize>, Vec<Value>) = derivatives.iter().copied().unzip();
        let locals = self.spline_derivatives(spline, orders, &values, argument);
        values.iter().zip(locals).for_each(|(&value, local)| self.know(value, local));
    }

    /// The locals that hold derivatives of these orders.
    fn spline_derivatives(&mut self, spline: u32, orders: Vec<usize>, values: &[Value], x: Tree) -> Vec<usize> {
        let table = self.body.names.spline(&self.program.splines[spline as usize]);
        let locals = self.locals(values);
        self.push(Statement::Spline { table, orders, locals: locals.clone(), x });
        locals
    }

    fn tree(&mut self, value: Value, instruction: Instruction) -> Tree {
        match instruction {
            Instruction::Constant(number) => Tree::Constant(number.to_f64()),
            Instruction::Symbol(symbol) => Tree::Symbol(symbol),
            Instruction::Hoisted(k) => Tree::Hoisted(k),
            Instruction::Neg(a) => Tree::neg(self.take(a)),
            Instruction::Add(a, b) => self.combine(Tree::add, a, b),
            Instruction::Sub(a, b) => self.combine(Tree::sub, a, b),
            Instruction::Mul(a, b) => self.combine(Tree::mul, a, b),
            Instruction::Div(a, b) => self.combine(Tree::div, a, b),
            Instruction::Sqrt(a) => self.call("sqrt", a),
            Instruction::Call(function, a) => self.call(function.name(), a),
            Instruction::Spline(derivative, a) => {
                let argument = self.take(a);
                let orders = vec![derivative.order as usize];
                let locals = self.spline_derivatives(derivative.spline, orders, &[value], argument);
                Tree::Local(locals[0])
            }
            Instruction::Less(a, b) => self.comparison(Tree::Less, a, b),
            Instruction::LessEqual(a, b) => self.comparison(Tree::LessEqual, a, b),
            Instruction::And(a, b) => Tree::And(Box::new(self.take(a)), Box::new(self.take(b))),
            Instruction::Not(a) => Tree::Not(Box::new(self.take(a))),
            Instruction::Select(c, a, b) => {
                let [c, a, b] = [c, a, b].map(|operand| Box::new(self.take(operand)));
                Tree::Select(c, a, b)
            }
            Instruction::Call2(function, a, b) => {
                self.combine(|a, b| Tree::Method(function.name(), Box::new(a), vec![b]), a, b)
            }
        }
    }

    /// A comparison of names: it is written again wherever it is asked.
    fn comparison(&mut self, comparison: fn(Box<Tree>, Box<Tree>) -> Tree, a: Value, b: Value) -> Tree {
        let [a, b] = [a, b].map(|operand| {
            let tree = self.take(operand);
            Box::new(if tree.is_free() { tree } else { self.bind(operand, tree) })
        });
        comparison(a, b)
    }

    fn call(&mut self, name: &'static str, a: Value) -> Tree {
        let argument = self.take(a);
        let tree = |argument: Tree| Tree::Method(name, Box::new(argument), Vec::new());
        if self.body.is_short(&tree(argument.clone())) {
            return tree(argument);
        }
        let local = self.bind(a, argument);
        tree(local)
    }

    /// An operation of two values; where that gets too long, they are bound first: terms before products, which are to
    /// be fused into sums, and else the longer one.
    fn combine(&mut self, operation: impl Fn(Tree, Tree) -> Tree, a: Value, b: Value) -> Tree {
        let [mut first, mut second] = [self.take(a), self.take(b)];
        loop {
            let tree = operation(first.clone(), second.clone());
            if self.body.is_short(&tree) {
                return tree;
            }
            let weight = |tree: &Tree| match tree {
                tree if tree.is_free() => 0,
                Tree::Mul(..) => tree.operations(),
                tree => 100 + tree.operations(),
            };
            match (weight(&first), weight(&second)) {
                (0, 0) => return tree,
                (x, y) if x > y => first = self.bind(a, first),
                _ => second = self.bind(b, second),
            }
        }
    }

    /// A value's tree: for good where it is used once.
    fn take(&mut self, value: Value) -> Tree {
        let tree = &mut self.trees[value.index()];
        let taken = if self.uses[value.index()] == 1 { tree.take() } else { tree.clone() };
        taken.expect("operands come before what is made of them")
    }

    fn bind(&mut self, value: Value, tree: Tree) -> Tree {
        let local = self.local(value, &tree);
        self.push(Statement::Let(local, tree));
        Tree::Local(local)
    }

    /// A local for a value that a tree is of.
    fn local(&mut self, value: Value, tree: &Tree) -> usize {
        let wish = self.wish(value, tree);
        let link = |value: Value| self.links.get(&value).copied();
        let link = link(value).or_else(|| self.goals[value.index()].and_then(link));
        self.body.local(wish, link)
    }

    /// Locals for values that are computed together.
    fn locals(&mut self, values: &[Value]) -> Vec<usize> {
        values.iter().map(|&value| self.local(value, &Tree::Constant(0.0))).collect()
    }

    /// What a value would be called: as a result, where it was derived, by what it is, by what it contributes to.
    fn wish(&self, value: Value, tree: &Tree) -> Wish {
        let described = || match tree {
            Tree::Method(_, _, rest) if rest.is_empty() => self.body.describe(tree),
            Tree::Mul(a, b) if a == b => self.body.describe(a).map(|words| format!("{words}_squared")),
            _ => None,
        };
        let goal = || self.goals[value.index()].and_then(|goal| self.wishes.get(&goal)).cloned();
        match self.wishes.get(&value).cloned().or_else(described) {
            Some(name) => Wish::Name(name),
            None => goal().map_or(Wish::Number, Wish::PartOf),
        }
    }

    /// The results: short ones as they are.
    fn finish(mut self, components: &[Component]) -> Body<'n> {
        let longest = match components.len() {
            1 => usize::MAX,
            2..=9 => IN_RESULT[0],
            _ => IN_RESULT[1],
        };
        self.region = Region::BODY;
        for component in components {
            let tree = match component {
                Component::Zero => Tree::Constant(0.0),
                Component::Result(number, _) => {
                    let value = self.program.results[*number];
                    let tree = self.take(value);
                    if tree.operations() > longest { self.bind(value, tree) } else { tree }
                }
            };
            self.body.block.results.push(tree);
        }
        let statements = self.statements.swap_remove(Region::BODY.index());
        self.body.block.statements = links::together(statements, &self.body.links);
        self.body.leaves = self.body.block.leaves();
        self.body
    }
}

/// The program as far as these components need it, and the components with the numbers of its results.
fn restricted(program: &Program, components: &[Component]) -> (Program, Vec<Component>) {
    let (mut results, mut restricted) = (Vec::new(), Vec::new());
    for component in components {
        restricted.push(match component {
            Component::Zero => Component::Zero,
            Component::Result(number, wish) => {
                results.push(program.results[*number]);
                Component::Result(results.len() - 1, wish.clone())
            }
        });
    }
    let splines = program.splines.clone();
    (Program { splines, ..Program::new(program.instructions.clone(), results, program.notes.clone()) }, restricted)
}

fn value(index: usize) -> Value {
    Value(u32::try_from(index).expect("programs are shorter than 2³² instructions"))
}

/// Its number among the familiar constants, but for its sign.
pub(super) fn familiar(value: f64) -> Option<usize> {
    FAMILIAR.iter().position(|(number, _)| *number == value.abs())
}
