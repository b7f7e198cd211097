//! Parameters made constants: a build script's choice, carried out on the declaration.

use crate::diagnostic::{Diagnostics, nearest};

use super::syntax::{Declaration, StatementKind};

impl Declaration {
    /// Makes the parameters with these names constants of their declared defaults.
    ///
    /// # Errors
    /// A name that no parameter has, reported at the mechanism's name.
    pub fn freeze(&mut self, names: &[String]) -> Result<(), Diagnostics> {
        let mut errors = Diagnostics::default();
        for name in names {
            let known = self.parameters();
            let found = self.statements.iter_mut().find_map(|statement| match &statement.kind {
                StatementKind::Param(quantity) if quantity.name.text == *name => Some(&mut statement.kind),
                _ => None,
            });
            match found {
                Some(kind) => make_constant(kind),
                None => {
                    let message = format!("there is no parameter `{name}` to freeze");
                    let error = errors.error(self.name.span.clone(), message);
                    if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
                        error.help(format!("did you mean `{near}`?"));
                    }
                }
            }
        }
        errors.finish(())
    }

    fn parameters(&self) -> Vec<String> {
        let name = |kind: &StatementKind| match kind {
            StatementKind::Param(quantity) => Some(quantity.name.text.clone()),
            _ => None,
        };
        self.statements.iter().filter_map(|statement| name(&statement.kind)).collect()
    }
}

fn make_constant(kind: &mut StatementKind) {
    if let StatementKind::Param(quantity) = kind {
        *kind = StatementKind::Const(quantity.clone());
    }
}
