//! Units: of declarations, and behind numbers.

use super::{Reader, Token, Unit};

impl Reader {
    pub(super) fn unit(&mut self) -> Result<Unit, String> {
        let mut unit = self.factor()?;
        loop {
            let sign = match self.peek() {
                Token::Sign("*") => 1.0,
                Token::Sign("/") => -1.0,
                _ => return Ok(unit),
            };
            self.next();
            unit.extend(self.factor()?.into_iter().map(|(name, power)| (name, sign * power)));
        }
    }

    fn factor(&mut self) -> Result<Unit, String> {
        if self.accept("(") {
            let unit = self.unit()?;
            self.expect(")")?;
            return Ok(unit);
        }
        match self.next() {
            Token::Number(one) if one == "1" => Ok(Vec::new()),
            Token::Name(name) => {
                let power = if self.accept("^") { self.exponent()? } else { 1.0 };
                Ok(vec![(name, power)])
            }
            _ => Err(self.expected("a unit")),
        }
    }

    fn exponent(&mut self) -> Result<f64, String> {
        if self.accept("(") {
            let top = self.exponent()?;
            let bottom = if self.accept("/") { self.exponent()? } else { 1.0 };
            self.expect(")")?;
            return Ok(top / bottom);
        }
        let sign = if self.accept("-") { -1.0 } else { 1.0 };
        match self.next() {
            Token::Number(digits) => digits.parse::<f64>().map(|n| sign * n).map_err(|e| e.to_string()),
            _ => Err(self.expected("an exponent")),
        }
    }

    /// The longest unit that stands behind a number.
    pub(super) fn unit_behind(&mut self) -> Result<Unit, String> {
        let mut unit = Unit::new();
        let mut sign = 1.0;
        while let Some(name) = self.unit_name(&unit) {
            self.next();
            let raised = self.is("^") && self.start() == self.end();
            let power = if raised && self.accept("^") { self.exponent()? } else { 1.0 };
            unit.push((name, sign * power));
            let operator = ["*", "/"].into_iter().find(|operator| self.is(operator));
            let Some(operator) = operator.filter(|_| self.start() == self.end()) else { break };
            sign = if operator == "/" { -1.0 } else { 1.0 };
            self.at += 1;
            if self.start() != self.end() || self.unit_name(&unit).is_none() {
                self.at -= 1;
                break;
            }
        }
        Ok(unit)
    }

    /// The name of a unit that stands here: not called, indexed or asked for a component, not the time (directly behind
    /// a number it is the tonne), and no second unit of a quantity that the unit so far has.
    fn unit_name(&self, so_far: &Unit) -> Option<String> {
        let Token::Name(name) = self.peek() else { return None };
        let behind = self.tokens.get(self.at + 1).map(|(token, _)| token);
        let used = matches!(behind, Some(Token::Sign("(" | "[" | ".")));
        let again = so_far.iter().any(|(known, _)| known != name && crate::referee::unit::same_quantity(known, name));
        (crate::referee::unit::is_unit(name) && (name != "t" || so_far.is_empty()) && !used && !again)
            .then(|| name.clone())
    }
}
