//! The expression graph of all functions of a mechanism as data; `docs/json.md` says how to read it.
//!
//! It is what the programs compute, put together: equal values are one node, whichever functions and whether the
//! constructor computes them.

use std::collections::BTreeMap;

use mbs_derive::expr::Symbol;
use mbs_derive::optimise::{Derivation, Instruction, Program};
use mbs_derive::variable::component_names;
use serde_json::{Map, Value, json};

use super::json::{instruction, of_symbol, spline_numbers};

/// Nodes in an order in which operands come first, and the roots of each function.
pub(crate) fn graph(derivation: &Derivation) -> Value {
    let mut nodes = Nodes { derivation, list: Vec::new(), known: BTreeMap::new() };
    let hoisted = nodes.add(&derivation.constructor, &[]);
    let roots: Map<String, Value> =
        derivation.functions.iter().map(|f| (f.name.clone(), nodes.add(&f.program, &hoisted).into())).collect();
    json!({ "nodes": nodes.list, "roots": roots })
}

struct Nodes<'d> {
    derivation: &'d Derivation,
    list: Vec<Value>,
    /// Numbers of the nodes by what they say.
    known: BTreeMap<String, usize>,
}

impl Nodes<'_> {
    /// Adds what a program computes; the nodes of its results.
    fn add(&mut self, program: &Program, hoisted: &[usize]) -> Vec<usize> {
        let (mut numbers, splines) = (Vec::new(), spline_numbers(self.derivation, program));
        for &step in &program.instructions {
            let number = match step {
                Instruction::Hoisted(k) => hoisted[k as usize],
                Instruction::Constant(value) => {
                    self.number(json!({ "operation": "constant", "value": value.to_f64(), "exact": value.to_string() }))
                }
                Instruction::Symbol(symbol) => {
                    let name = self.name(symbol);
                    self.number(json!({ "operation": "symbol", "name": name, "symbol": of_symbol(symbol) }))
                }
                Instruction::Spline(derivative, a) => {
                    let (spline, order) = (splines[derivative.spline as usize], derivative.order);
                    let operands = [numbers[a.index()]];
                    self.number(
                        json!({ "operation": "spline", "spline": spline, "order": order, "operands": operands }),
                    )
                }
                _ => {
                    let operands: Vec<usize> = step.operands().map(|operand| numbers[operand.index()]).collect();
                    self.number(json!({ "operation": instruction(step, &splines)[0], "operands": operands }))
                }
            };
            numbers.push(number);
        }
        program.results.iter().map(|result| numbers[result.index()]).collect()
    }

    fn number(&mut self, node: Value) -> usize {
        let next = self.list.len();
        let number = *self.known.entry(node.to_string()).or_insert(next);
        if number == next {
            self.list.push(node);
        }
        number
    }

    /// `theta`, `theta_dot`, `theta_ddot`; parameters and inputs as declared.
    fn name(&self, symbol: Symbol) -> String {
        let derivation = self.derivation;
        let of = |variables, i: u32| component_names(variables).swap_remove(i as usize);
        let rate = |order: u8| ["", "_dot", "_ddot"][usize::from(order.min(2))];
        match symbol {
            Symbol::Time => "t".to_string(),
            Symbol::Coordinate(i) => of(&derivation.coordinates, i),
            Symbol::Velocity(i) => of(&derivation.coordinates, i) + rate(1),
            Symbol::Acceleration(i) => of(&derivation.coordinates, i) + rate(2),
            Symbol::Parameter(i) => of(&derivation.parameters, i),
            Symbol::Input(i) => of(&derivation.inputs, i),
            Symbol::Prescribed(i, order) => of(&derivation.prescribed, i) + rate(order),
            Symbol::Multiplier(i) => format!("lambda_{}", derivation.constraints[i as usize]),
        }
    }
}
