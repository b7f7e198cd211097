//! `let p[n];`: arrays whose elements are given their values one by one, such as by the turns of a loop.
//!
//! An element has a value from the statement `p[i] = …;` on, and takes one only (with `let mut` new ones of the same
//! shape and dimension); what has no value yet cannot be read, neither by itself nor with the whole array.

use crate::diagnostic::Code;
use crate::model::names::scope::{Binding, Origin};
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::quantity::UnitsInPlace;
use crate::model::value::{Array, Value};
use crate::parse::syntax::{Expression, Name, Span};

/// The elements of one array, row by row.
#[derive(Clone, Debug)]
pub(in crate::model) struct Elements<'g> {
    lengths: Vec<usize>,
    values: Vec<Element<'g>>,
}

#[derive(Clone, Debug)]
enum Element<'g> {
    Empty,
    /// What was wrong has been said.
    Wrong,
    Given {
        value: Value<'g>,
        place: Span,
        /// Where a pose is used first, since it was given.
        used: Option<Span>,
    },
}

impl<'g> Elements<'g> {
    /// The element with these indices, as many as there are lengths, each below its own.
    fn number(&self, indices: &[usize]) -> usize {
        indices.iter().zip(&self.lengths).fold(0, |number, (index, length)| number * length + index)
    }

    fn get_mut(&mut self, indices: &[usize]) -> &mut Element<'g> {
        let number = self.number(indices);
        &mut self.values[number]
    }

    /// All of them as an array of arrays; nothing where one has no value.
    pub(in crate::model) fn whole(&self) -> Option<Value<'g>> {
        let given = |element: &Element<'g>| match element {
            Element::Given { value, .. } => Some(value.clone()),
            Element::Empty | Element::Wrong => None,
        };
        let mut values = self.values.iter().map(given).collect::<Option<Vec<_>>>()?;
        for &length in self.lengths.iter().skip(1).rev() {
            let row = |row: &[Value<'g>]| Array::new(row.to_vec()).map(Value::Array);
            values = values.chunks(length).map(row).collect::<Option<_>>()?;
        }
        Array::new(values).map(Value::Array)
    }

    /// A new value, not used yet.
    pub(in crate::model) fn give(&mut self, indices: &[usize], value: Value<'g>, place: Span) {
        *self.get_mut(indices) = Element::Given { value, place, used: None };
    }
}

// ---- declared and given

impl<'d, 'g> Resolver<'d, 'g> {
    /// `let p[n];`
    pub(in crate::model) fn declare_elements(
        &mut self,
        name: &Name,
        mutable: bool,
        lengths: &[Expression],
    ) -> Resolved<()> {
        let origin = if mutable { Origin::Mutable } else { Origin::Local };
        let found: Vec<Resolved<usize>> = lengths.iter().map(|length| self.array_length(length)).collect();
        let elements = found.into_iter().collect::<Resolved<Vec<_>>>().and_then(|lengths| {
            let count = lengths.iter().try_fold(1usize, |count, length| count.checked_mul(*length));
            match count.filter(|&count| count <= Array::MAX_LEAVES && lengths.len() <= Array::MAX_DEPTH) {
                Some(count) => {
                    self.spend(count);
                    Ok(Elements { lengths, values: vec![Element::Empty; count] })
                }
                None => {
                    Err(self.refuse(Code::ArraySize, &name.span, "this array is too large or nested too deeply", ""))
                }
            }
        });
        self.declare(name, origin, None)?;
        if let (Ok(elements), Some(binding)) = (elements, self.names.scope.get_mut(&name.text)) {
            binding.elements = Some(elements);
        }
        Ok(())
    }

    /// `p[i] = value;`
    pub(in crate::model) fn assign_element(
        &mut self,
        name: &Name,
        indices: &[Expression],
        value: &Expression,
    ) -> Resolved<()> {
        let has_unit = self.units_in_place(value) != UnitsInPlace::None;
        let argument = self.argument(value);
        let Some(binding) = self.names.scope.get_mut(&name.text) else {
            let message = format!("`{}` is not declared", name.text);
            return Err(self.refuse(
                Code::Undeclared,
                &name.span,
                message,
                format!("write `let {}[n];` before it", name.text),
            ));
        };
        binding.has_unit |= has_unit;
        if binding.elements.is_none() {
            let binding = binding.clone();
            return self.assign_component(binding, name, indices, argument);
        }
        let Ok(numbers) = self.numbers_of(name, indices) else {
            // Nobody knows which one was meant.
            self.report.gave_up = true;
            return Err(Refused);
        };
        let shown = shown(&name.text, &numbers);
        let place = name.span.start..indices.last().map_or(name.span.end, |index| index.span.end + 1);
        let is_mutable = self.names.scope.get(&name.text).is_some_and(|binding| binding.origin == Origin::Mutable);
        match (self.element_at(&name.text, &numbers), &argument) {
            (Some(Element::Given { value: old, .. }), Ok(new)) if is_mutable => {
                self.check_assignment(&shown, old, new)?;
            }
            (Some(Element::Given { place: first, .. }), _) if !is_mutable => {
                return Err(self.given_twice(&name.text, &shown, &place, first));
            }
            _ => {}
        }
        let element = match argument {
            Ok(argument) => Element::Given { value: argument.value, place, used: None },
            Err(Refused) => Element::Wrong,
        };
        if let Some(elements) = self.names.scope.get_mut(&name.text).and_then(|binding| binding.elements.as_mut()) {
            *elements.get_mut(&numbers) = element;
        }
        Ok(())
    }

    fn given_twice(&mut self, name: &str, shown: &str, place: &Span, first: Span) -> Refused {
        if first == *place {
            let message = format!("several turns of the loop give `{shown}` a value");
            let help = format!("write `let mut {name}[n];` where elements are to take new values");
            return self.refuse(Code::ElementGivenAgain, place, message, help);
        }
        let help = format!("each element takes one; write `let mut {name}[n];` where they are to take new ones");
        self.report
            .errors
            .error(Code::ElementGivenAgain, place.clone(), format!("`{shown}` has a value already"))
            .help(help)
            .note(first, "given here");
        Refused
    }

    /// An element of a `let mut` that has its values from the start.
    fn assign_component(
        &mut self,
        binding: Binding<'g>,
        name: &Name,
        indices: &[Expression],
        value: Resolved<Argument<'g>>,
    ) -> Resolved<()> {
        if binding.value.is_none() {
            return Err(Refused);
        }
        if binding.origin != Origin::Mutable {
            let message = format!("`{}` is {}: it keeps its value", name.text, binding.origin.described());
            let help = "only the elements of what is declared by `let x[n];` or `let mut` take values";
            return Err(self.refuse(Code::KeepsItsValue, &name.span, message, help));
        }
        let (new, old) = (value?, binding.value.ok_or(Refused)?);
        let changed = self.with_element(name, old, indices, new, &mut Vec::new())?;
        if let Some(binding) = self.names.scope.get_mut(&name.text) {
            (binding.value, binding.used) = (Some(changed), None);
        }
        Ok(())
    }

    fn with_element(
        &mut self,
        name: &Name,
        old: Value<'g>,
        indices: &[Expression],
        new: Argument<'g>,
        numbers: &mut Vec<usize>,
    ) -> Resolved<Value<'g>> {
        let shown = shown(&name.text, numbers);
        let [index, inner @ ..] = indices else {
            return self.check_assignment(&shown, old, &new).map(|()| new.value);
        };
        let Value::Array(array) = old else {
            let message = format!("`{shown}` is {}: it has no elements of its own", old.described());
            return Err(self.refuse(
                Code::NoElements,
                &index.span,
                message,
                format!("write `{} = …;` for all of it", name.text),
            ));
        };
        self.spend(array.values().len());
        let argument = self.argument(index)?;
        let number = self.index(&argument, array.values().len())?;
        numbers.push(number);
        let mut values = array.values().to_vec();
        values[number] = self.with_element(name, values[number].clone(), inner, new, numbers)?;
        self.array(values, &name.span)
    }

    /// The numbers of all indices of an element.
    pub(in crate::model) fn numbers_of(&mut self, name: &Name, indices: &[Expression]) -> Resolved<Vec<usize>> {
        let lengths = self.lengths_of(&name.text);
        if lengths.len() != indices.len() {
            let form = format!("{}{}", name.text, "[i]".repeat(lengths.len()));
            let message = format!("an element of `{}` has {}", name.text, counted(lengths.len()));
            return Err(self.refuse(Code::NoElements, &name.span, message, format!("write `{form} = …;`")));
        }
        let numbers: Vec<_> =
            indices.iter().zip(lengths).map(|(index, length)| self.number_below(index, length)).collect();
        numbers.into_iter().collect()
    }

    fn number_below(&mut self, index: &Expression, length: usize) -> Resolved<usize> {
        let argument = self.argument(index)?;
        self.index(&argument, length)
    }

    fn lengths_of(&self, name: &str) -> Vec<usize> {
        let elements = self.names.scope.get(name).and_then(|binding| binding.elements.as_ref());
        elements.map(|elements| elements.lengths.clone()).unwrap_or_default()
    }

    fn element_at(&self, name: &str, numbers: &[usize]) -> Option<Element<'g>> {
        let elements = self.names.scope.get(name)?.elements.as_ref()?;
        Some(elements.values[elements.number(numbers)].clone())
    }
}

// ---- read

impl<'d, 'g> Resolver<'d, 'g> {
    /// `p`, `p[i]`, `p[i][j]` of an array declared by `let p[n];`.
    pub(in crate::model) fn element(
        &mut self,
        name: &str,
        indices: &[&Expression],
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let lengths = self.lengths_of(name);
        let (own, behind) = indices.split_at(indices.len().min(lengths.len()));
        let numbers: Vec<_> =
            own.iter().zip(&lengths).map(|(index, &length)| self.number_below(index, length)).collect();
        let numbers = numbers.into_iter().collect::<Resolved<Vec<_>>>()?;
        let mut value = self.read(name, &lengths, numbers, span)?;
        for index in behind {
            let index = self.argument(index)?;
            value = self.element_of(&Argument { value, span: span.clone() }, &index)?;
        }
        Ok(value)
    }

    /// One element, or all of those that begin with these indices.
    fn read(&mut self, name: &str, lengths: &[usize], numbers: Vec<usize>, span: &Span) -> Resolved<Value<'g>> {
        let Some(&length) = lengths.get(numbers.len()) else { return self.given(name, &numbers, span) };
        self.spend(length);
        let mut values = Vec::with_capacity(length);
        for i in 0..length {
            let numbers = [numbers.as_slice(), &[i]].concat();
            values.push(self.read(name, lengths, numbers, span)?);
        }
        self.array(values, span)
    }

    pub(in crate::model) fn given(&mut self, name: &str, numbers: &[usize], span: &Span) -> Resolved<Value<'g>> {
        match self.element_at(name, numbers) {
            Some(Element::Given { value, .. }) => {
                if let Value::Pose(_) = value {
                    self.note_use_of(name, numbers, span);
                }
                Ok(value)
            }
            // Where a loop was given up, the value would have come.
            Some(Element::Empty) if !self.report.gave_up => {
                let shown = shown(name, numbers);
                let help = format!("give it one before: `{shown} = …;`");
                Err(self.refuse(Code::ElementWithoutValue, span, format!("`{shown}` has no value yet"), help))
            }
            Some(Element::Empty | Element::Wrong) | None => Err(Refused),
        }
    }

    /// Where the pose that an element holds is used first.
    pub(in crate::model) fn use_of_element(&self, name: &str, numbers: &[usize]) -> Option<Span> {
        match self.element_at(name, numbers)? {
            Element::Given { used, .. } => used,
            Element::Empty | Element::Wrong => None,
        }
    }

    fn note_use_of(&mut self, name: &str, numbers: &[usize], place: &Span) {
        let elements = self.names.scope.get_mut(name).and_then(|binding| binding.elements.as_mut());
        if let Some(Element::Given { used, .. }) = elements.map(|elements| elements.get_mut(numbers)) {
            used.get_or_insert_with(|| place.clone());
        }
    }
}

/// `p[1][2]`
pub(in crate::model) fn shown(name: &str, numbers: &[usize]) -> String {
    let indices: Vec<String> = numbers.iter().map(|number| format!("[{number}]")).collect();
    format!("{name}{}", indices.concat())
}

fn counted(indices: usize) -> String {
    if indices == 1 { "one index".to_string() } else { format!("{indices} indices") }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, near, refusals, refused, value};

    #[test]
    fn loops_fill_arrays() {
        let filled = "let p[4]; for i in 0..4 { p[i] = if i < 2 { q[i] } else { p[i - 2] + p[i - 1] }; }";
        near(&value(filled, "p"), &[-0.9, 1.3, 0.4, 1.7], "numbers");
        near(&value(filled, "[p[3], p[0]]"), &[1.7, -0.9], "elements");
        let poses = "const n = 2; let link[n]; for i in 0..n { link[i] = (if i == 0 { world } else { link[i - 1] }) \
                     * rot_z(q[i]) * translation([l, 0, 0]); }";
        let (c, s) = ((-0.9f64).cos(), (-0.9f64).sin());
        near(&value(poses, "link[0].origin()"), &[3.0 * c, 3.0 * s, 0.0], "poses");
        near(&value("let a[3]; for i in 0..3 { a[i] = [i, 2*i, x/l]; }", "a[2][1]"), &[4.0], "behind an element");
        near(&value("let a[3]; for i in 0..3 { a[i] = i; }", "a.norm_squared()"), &[5.0], "three numbers are a vector");
        let square = "let a[2][2]; for i in 0..2 { for j in 0..2 { a[i][j] = 10*i + j; } }";
        near(&value(square, "a[1]"), &[10.0, 11.0], "a row");
        near(&value(square, "a"), &[0.0, 1.0, 10.0, 11.0], "all rows");
        near(&value("let a[1]; if 1 == 1 { a[0] = x; }", "a[0]"), &[0.3], "from an inner block");
        near(&value("for i in 0..2 { let a[1]; a[0] = x; let b = a[0]; }", "x"), &[0.3], "once a turn");
    }

    #[test]
    fn elements_of_let_mut_take_new_values() {
        near(
            &value("let mut a[2]; a[0] = 1; a[1] = 2; for i in 0..3 { a[0] = a[0] + a[1]; }", "a"),
            &[7.0, 2.0],
            "new",
        );
        near(&value("let mut a = [1, 2]; a[1] = a[0] + 4; a[0] = a[1]*2;", "a"), &[10.0, 5.0], "of a value");
        near(&value("let mut a = [[1, 2], [3, 4]]; a[1][0] = 7;", "a"), &[1.0, 2.0, 7.0, 4.0], "of a matrix");
        refused("let mut a[1]; a[0] = x; a[0] = m;", "m: `a[0]` is m, this is kg; use another name for it");
        refused(
            "let mut a[1]; a[0] = x; a[0] = [x, y, z];",
            "[x, y, z]: `a[0]` is a number, this is a vector; use another name for it",
        );
        refused("let mut a = [x, y]; a[1] = m;", "m: `a[1]` is m, this is kg; use another name for it");
        refused(
            "let mut a = [x, y]; a[2] = x;",
            "2: the index 2 is out of range: there are 2 elements; indices run from 0 to 1",
        );
        refused(
            "let mut a = [x, y]; a[0][0] = x;",
            "0: `a[0]` is a number: it has no elements of its own; write `a = …;` for all of it",
        );
        refused(
            "let a = [x, y]; a[0] = x;",
            "a: `a` is a `let`: it keeps its value; only the elements of what is declared by `let x[n];` or `let mut` take values",
        );
    }

    #[test]
    fn elements_have_one_value_and_one_only() {
        refused("let p[2]; p[0] = x; let a = p[1];", "p[1]: `p[1]` has no value yet; give it one before: `p[1] = …;`");
        refused("let p[2]; p[0] = x; output a = p;", "p: `p[1]` has no value yet; give it one before: `p[1] = …;`");
        refused(
            "let p[2]; for i in 0..2 { p[i] = p[1 - i]; }",
            "p[1 - i]: `p[1]` has no value yet; give it one before: `p[1] = …;`",
        );
        refused(
            "let p[2][2]; p[0][0] = x; output a = p[0];",
            "p[0]: `p[0][1]` has no value yet; give it one before: `p[0][1] = …;`",
        );
        refused(
            "let p[1]; p[0] = x; p[0] = y;",
            "p[0]: `p[0]` has a value already; each element takes one; write `let mut p[n];` where they are to take new ones",
        );
        refused(
            "let p[3]; for i in 0..3 { p[0] = i; }",
            "p[0]: several turns of the loop give `p[0]` a value; write `let mut p[n];` where elements are to take new values",
        );
        refused("let p[2]; p[2] = x;", "2: the index 2 is out of range: there are 2 elements; indices run from 0 to 1");
        refused("let p[2]; p = [x, y];", "p: the elements of `p` are given their values one by one; write `p[i] = …;`");
        refused("let p[2]; p[0][1] = x;", "p: an element of `p` has one index; write `p[i] = …;`");
        refused("let p[2][2]; p[0] = x;", "p: an element of `p` has 2 indices; write `p[i][i] = …;`");
        refused("p[0] = x;", "p: `p` is not declared; write `let p[n];` before it");
        refused(
            "m[0] = x;",
            "m: `m` is a parameter: it keeps its value; only the elements of what is declared by `let x[n];` or `let mut` take values",
        );
        refused(
            "let p[m];",
            "m: the length of an array must be a constant integer; a parameter may change at run time: declare it as `const name = …;`",
        );
        refused("let p[0];", "0: an array has from 1 to 10000 elements, not 0");
        refused("let p[1000][1000];", "p: this array is too large or nested too deeply");
        refused(
            "let p[1]; let p = 1;",
            "p: `p` is already a `let`; declare the first as `let mut` and write `p = …;` here, or choose another name",
        );
        // One report each: what is made of a refused value, and what the rest of a loop would have done, is not known.
        assert_eq!(refusals("let p[2]; p[0] = nothing; let a = p[0] + 1; p[1] = 1; output b = p;").len(), 1);
        assert_eq!(
            refusals("let p[2]; for i in 0..2 { let a = nothing; p[i] = a; } output b = p; let c = p[1];").len(),
            1
        );
        assert_eq!(refusals("let p[m]; p[0] = x; let c = p[1];").len(), 1);
    }

    #[test]
    fn reactions_of_elements() {
        let chain = "let link[2]; for i in 0..2 { link[i] = (if i == 0 { world } else { link[i - 1] }) * rot_z(q[i]); \
                     reaction joint[i] at link[i]; }";
        mechanism(&format!("{chain} kinetic += particle(m, link[1].point([l, 0, 0]));"), |lagrangian| {
            assert_eq!(lagrangian.reactions[0].component_names(), ["joint_0", "joint_1"]);
            assert!(lagrangian.released.is_some());
        });
        let built = "let link[1]; link[0] = rot_z(theta); let tip = link[0].origin(); reaction r at link[0];";
        refused(
            built,
            "link: something was built on `link[0]` before this reaction: it would not count; move the statement up, right \
             behind the one that gives `link[0]` its value",
        );
        refused(
            "let all = [world]; reaction r at all[0];",
            "all: a reaction is that of a pose with a name; name the pose, and build on the name: `let joint = …; reaction name at joint;`",
        );
    }
}
