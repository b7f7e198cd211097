//! A fault in as small a text as it still shows in.

use super::draw::Drawn;
use super::judge::{Fault, Text, judge, proved};
use super::syntax::{self, Expression, Statement};

/// At most this many texts are tried.
const TRIES: usize = 250;

/// The smallest text that was found to have the same kind of fault, and its fault.
pub fn shrink(drawn: &Drawn, fault: &Fault, seed: u64, states: usize) -> (Drawn, Fault) {
    shrunk(drawn, fault, &|text| judge(text, seed, states).err())
}

/// As [`shrink`], of a text that is not proved.
pub fn shrink_unproved(drawn: &Drawn, fault: &Fault) -> (Drawn, Fault) {
    shrunk(drawn, fault, &|text| proved(text).err())
}

fn shrunk(drawn: &Drawn, fault: &Fault, found: &dyn Fn(Text<'_>) -> Option<Fault>) -> (Drawn, Fault) {
    let mut shrinking = Shrinking { best: drawn.clone(), fault: fault.clone(), found, tries: TRIES };
    while shrinking.tries > 0 && (shrinking.lines() | shrinking.expressions()) {}
    (shrinking.best, shrinking.fault)
}

struct Shrinking<'f> {
    best: Drawn,
    fault: Fault,
    /// What is wrong with a text.
    found: &'f dyn Fn(Text<'_>) -> Option<Fault>,
    tries: usize,
}

impl Shrinking<'_> {
    /// Takes a text for the best if its fault is of the same kind.
    fn accept(&mut self, text: String) -> bool {
        if self.tries == 0 || text.len() >= self.best.text.len() || !self.keeps_quaternions(&text) {
            return false;
        }
        self.tries -= 1;
        match (self.found)((&text, &self.best.imports)) {
            Some(fault) if fault.kind() == self.fault.kind() => {
                self.best.text = text;
                self.fault = fault;
                true
            }
            _ => false,
        }
    }

    /// Whether every quaternion still has the constraint without which its energies mean nothing.
    fn keeps_quaternions(&self, text: &str) -> bool {
        let constraints = self.best.text.lines().filter(|line| line.trim_start().starts_with("constraint unit"));
        constraints.into_iter().all(|line| text.contains(line)) || !text.contains("quaternion")
    }

    /// Leaves out lines, the last ones first: nothing depends on them.
    fn lines(&mut self) -> bool {
        let mut changed = false;
        let mut at = self.best.text.lines().count();
        while at > 0 {
            at -= 1;
            let lines: Vec<&str> = self.best.text.lines().collect();
            let kept = lines.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, line)| *line);
            let text = kept.collect::<Vec<_>>().join("\n") + "\n";
            changed |= self.accept(text);
        }
        changed
    }

    /// Puts one of its parts, or a number, in the place of an expression.
    fn expressions(&mut self) -> bool {
        let mut changed = false;
        let mut skipped = 0;
        // After each change the text is read anew: places have moved.
        while self.tries > 0 {
            let text = self.best.text.clone();
            let Ok(file) = syntax::read(&text) else { return changed };
            let mut expressions = Vec::new();
            file.statements.iter().flat_map(Statement::expressions).for_each(|e| inside(e, &mut expressions));
            let candidates = expressions.iter().flat_map(|e| {
                let parts = e.parts().into_iter().map(|part| text[part.span.clone()].to_string());
                parts.chain(["1".to_string(), "0".to_string()]).map(|new| (e.span.clone(), new))
            });
            let mut found = false;
            for (tried, (span, new)) in candidates.enumerate().skip(skipped) {
                skipped = tried + 1;
                let shorter = format!("{}{new}{}", &text[..span.start], &text[span.end..]);
                if self.accept(shorter) {
                    found = true;
                    break;
                }
            }
            changed |= found;
            if !found {
                break;
            }
        }
        changed
    }
}

fn inside<'e>(expression: &'e Expression, found: &mut Vec<&'e Expression>) {
    found.push(expression);
    expression.parts().into_iter().for_each(|part| inside(part, found));
}
