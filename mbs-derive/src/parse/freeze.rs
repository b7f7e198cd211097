//! Parameters made constants: a build script's choice, carried out on the declaration.

use crate::diagnostic::{Code, Diagnostics, nearest};

use super::syntax::{Declaration, Name, StatementKind};

impl Declaration {
    /// Makes the parameters with these names constants of their declared defaults.
    ///
    /// # Errors
    /// A name that no parameter has, reported where something else of that name, or a parameter of a similar one, is
    /// declared.
    pub fn freeze(&mut self, names: &[String]) -> Result<(), Diagnostics> {
        let mut errors = Diagnostics::default();
        for name in names {
            let found = self.statements.iter_mut().find_map(|statement| match &statement.kind {
                StatementKind::Param(quantity) if quantity.name.text == *name => Some(&mut statement.kind),
                _ => None,
            });
            match found {
                Some(kind) => make_constant(kind),
                None => self.no_parameter(name, &mut errors),
            }
        }
        errors.finish(())
    }

    /// Shown where the name is declared as something else, or at the parameter that was probably meant.
    fn no_parameter(&self, name: &str, errors: &mut Diagnostics) {
        let message = format!("the build script freezes `{name}`, which is not a parameter");
        let declared = self.statements.iter().find_map(|statement| {
            match &statement.kind {
                StatementKind::Coord(q) | StatementKind::Input(q) | StatementKind::Prescribed(q) => Some(&q.name),
                StatementKind::Let { name, .. } | StatementKind::Elements { name, .. } => Some(name),
                _ => None,
            }
            .filter(|declared| declared.text == name)
        });
        let parameters: Vec<&Name> = self.parameters().collect();
        let near = nearest(name, parameters.iter().map(|parameter| parameter.text.as_str()));
        match (declared, parameters.iter().find(|parameter| Some(parameter.text.as_str()) == near)) {
            (Some(declared), _) => {
                errors.error(Code::Frozen, declared.span.clone(), message).help("only a `param` can be frozen")
            }
            (None, Some(near)) => {
                errors.error(Code::Frozen, near.span.clone(), message).help(format!("did you mean `{}`?", near.text))
            }
            (None, None) => {
                let names: Vec<String> = parameters.iter().take(12).map(|p| format!("`{}`", p.text)).collect();
                let help = if names.is_empty() {
                    "the mechanism has none".to_string()
                } else {
                    format!("the parameters are {}", names.join(", "))
                };
                errors.error(Code::Frozen, self.name.span.clone(), message).help(help)
            }
        };
    }

    fn parameters(&self) -> impl Iterator<Item = &Name> {
        self.statements.iter().filter_map(|statement| match &statement.kind {
            StatementKind::Param(quantity) => Some(&quantity.name),
            _ => None,
        })
    }
}

fn make_constant(kind: &mut StatementKind) {
    if let StatementKind::Param(quantity) = kind {
        *kind = StatementKind::Const(quantity.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::super::declaration;

    #[test]
    fn what_is_no_parameter_is_shown_where_it_or_its_like_stands() {
        let source = "mechanism A { param mass: kg = 1; param g: m/s^2 = 9.81; coord x: m; }";
        let report = |name: &str| {
            let errors = declaration(source).expect("a mechanism").freeze(&[name.to_string()]).unwrap_err();
            let shown = |m: &crate::diagnostic::Diagnostic| {
                format!("{}: {}; {}", &source[m.span.clone()], m.message, m.help.as_deref().unwrap_or("no help"))
            };
            errors.iter().map(shown).collect::<Vec<_>>()
        };
        let message = |name: &str| format!("the build script freezes `{name}`, which is not a parameter");
        assert_eq!(report("maas"), [format!("mass: {}; did you mean `mass`?", message("maas"))]);
        assert_eq!(report("x"), [format!("x: {}; only a `param` can be frozen", message("x"))]);
        assert_eq!(report("stiffness"), [format!("A: {}; the parameters are `mass`, `g`", message("stiffness"))]);
        assert!(declaration(source).expect("a mechanism").freeze(&["g".to_string(), "mass".to_string()]).is_ok());
    }
}
