//! Declarations with an index, `output tip[i] = …;`: the elements of one array, gathered from the turns of loops.

use std::collections::BTreeMap;

use crate::diagnostic::Code;
use crate::model::value::evaluate::{Refused, Resolved, Resolver};
use crate::parse::syntax::{Expression, Name, Span};

/// A declaration, or an array of them, as far as its statements have been met.
#[derive(Clone, Debug)]
pub(in crate::model) struct Family {
    pub(in crate::model) name: Name,
    pub(in crate::model) is_array: bool,
    /// Where each element is declared; of what is no array element 0.
    elements: BTreeMap<usize, Span>,
}

impl Family {
    pub(in crate::model) fn new(name: &Name, number: Option<usize>) -> Self {
        let elements = BTreeMap::from([(number.unwrap_or(0), name.span.clone())]);
        Family { name: name.clone(), is_array: number.is_some(), elements }
    }

    /// How many elements.
    pub(in crate::model) fn count(&self) -> usize {
        self.elements.len()
    }

    /// How many elements, where it is an array.
    pub(in crate::model) fn length(&self) -> Option<usize> {
        self.is_array.then_some(self.elements.len())
    }
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// The index of a declaration, below `limit`; `what` it is, such as "output".
    pub(in crate::model) fn number_of(
        &mut self,
        index: Option<&Expression>,
        limit: usize,
        what: &str,
    ) -> Resolved<Option<usize>> {
        let Some(index) = index else { return Ok(None) };
        let index = self.argument(index)?;
        let number = self.integer(&index, "an index")?;
        match usize::try_from(number) {
            Ok(number) if number < limit => Ok(Some(number)),
            Ok(_) => {
                let message = format!("an array has at most {limit} {what}s, this one has the index {number}");
                Err(self.refuse(Code::TooMuch, &index.span, message, "indices run from 0 on, without gaps"))
            }
            Err(_) => {
                let message = format!("the index {number} is negative");
                Err(self.refuse(Code::IndexOutOfRange, &index.span, message, "indices run from 0 on, without gaps"))
            }
        }
    }

    /// One more element of the family of this name; `what` it is, such as "output".
    pub(in crate::model) fn join(
        &mut self,
        family: impl Fn(&mut Self) -> &mut Family,
        name: &Name,
        number: Option<usize>,
        what: &str,
    ) -> Resolved<()> {
        let text = &name.text;
        let Family { name: first, is_array, elements } = family(self);
        if *is_array != number.is_some() {
            let first = first.span.clone();
            let message = format!("`{text}` is both one {what} and an array");
            let help = "give all of them an index, or another name".to_string();
            return Err(self.refuse_twice(&name.span, message, help, first));
        }
        let element = number.unwrap_or(0);
        match (elements.get(&element).cloned(), number) {
            (None, _) => {
                elements.insert(element, name.span.clone());
                Ok(())
            }
            (Some(first), None) if first == name.span => {
                let message = format!("each turn of the loop declares {} `{text}`", with_article(what));
                let help = format!("give it an index: `{what} {text}[i]`, which runs from 0");
                Err(self.refuse(Code::IndexInALoop, &name.span, message, help))
            }
            (Some(first), None) => {
                let message = format!("there is already {} `{text}`", with_article(what));
                Err(self.refuse_twice(&name.span, message, "choose another name".to_string(), first))
            }
            (Some(first), Some(i)) if first == name.span => {
                let message = format!("several turns of the loop declare {} `{text}[{i}]`", with_article(what));
                Err(self.refuse(
                    Code::IndexInALoop,
                    &name.span,
                    message,
                    "give it an index that is another one in each turn",
                ))
            }
            (Some(first), Some(i)) => {
                let message = format!("there is already {} `{text}[{i}]`", with_article(what));
                let help = format!("each index stands for one {what}");
                Err(self.refuse_twice(&name.span, message, help, first))
            }
        }
    }

    /// Every index from 0 on stands for an element.
    pub(in crate::model) fn complete(&mut self, family: &Family, what: &str) -> Resolved<()> {
        match (0..family.count()).find(|i| !family.elements.contains_key(i)) {
            Some(_) if self.report.gave_up => Err(Refused),
            Some(missing) => {
                let message = format!("there is no {what} `{}[{missing}]`", family.name.text);
                Err(self.refuse(Code::IndexWithGaps, &family.name.span, message, "indices run from 0 on, without gaps"))
            }
            None => Ok(()),
        }
    }
}

fn with_article(what: &str) -> String {
    let article = if what.starts_with('o') { "an" } else { "a" };
    format!("{article} {what}")
}
