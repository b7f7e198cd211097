//! A reader of what is written: tests know by it that the page has the values that were derived.

use std::collections::BTreeMap;

/// Reads what is written, for its value.
pub(super) struct Reader<'a> {
    pub(super) rest: &'a str,
    pub(super) values: &'a BTreeMap<String, f64>,
}

impl Reader<'_> {
    fn accepts(&mut self, token: &str) -> bool {
        let rest = self.rest.trim_start_matches([' ']).trim_start_matches("\\,").trim_start();
        let found = rest.strip_prefix(token);
        self.rest = found.unwrap_or(rest);
        found.is_some()
    }

    fn ends(&mut self) -> bool {
        self.accepts("");
        let ends = [")", "}", "\\right", "+", "-", ",", "/", "&", "\\\\", "<", "\\le ", "\\land", "\\lor", "\\end"];
        self.rest.is_empty() || ends.iter().any(|end| self.rest.starts_with(end))
    }

    pub(super) fn sum(&mut self) -> f64 {
        let mut sum = if self.accepts("-") { -self.product() } else { self.product() };
        loop {
            sum += match (self.accepts("+"), self.accepts("-")) {
                (true, _) => self.product(),
                (_, true) => -self.product(),
                _ => return sum,
            };
        }
    }

    fn product(&mut self) -> f64 {
        let mut product = 1.0;
        while !self.ends() {
            let factor = self.factor();
            product *= factor.powf(self.exponent());
        }
        product
    }

    fn exponent(&mut self) -> f64 {
        match (self.accepts("^{"), self.rest.strip_prefix('^')) {
            (true, _) => {
                let exponent = self.sum();
                let exponent = if self.accepts("/") { exponent / self.sum() } else { exponent };
                assert!(self.accepts("}"), "{}", self.rest);
                exponent
            }
            (_, Some(rest)) => {
                self.rest = &rest[1..];
                rest[..1].parse().unwrap_or(f64::NAN)
            }
            _ => 1.0,
        }
    }

    /// `\lor` binds less than `\land`.
    fn condition(&mut self) -> bool {
        let mut any = false;
        loop {
            let mut all = self.comparison();
            while self.accepts("\\land") {
                all &= self.comparison();
            }
            any |= all;
            if !self.accepts("\\lor") {
                return any;
            }
        }
    }

    fn comparison(&mut self) -> bool {
        let before = self.rest;
        if self.accepts("(") {
            // A bracket begins several conditions, or a sum.
            let condition = before.split(')').next().is_some_and(|text| text.contains(['<']) || text.contains("\\le "));
            if condition {
                let any = self.condition();
                assert!(self.accepts(")"), "{}", self.rest);
                return any;
            }
            self.rest = before;
        }
        let left = self.sum();
        if self.accepts("<") {
            return left < self.sum();
        }
        assert!(self.accepts("\\le "), "{}", self.rest);
        left <= self.sum()
    }

    fn cases(&mut self) -> f64 {
        let yes = self.sum();
        assert!(self.accepts("& \\text{if }"), "{}", self.rest);
        let holds = self.condition();
        assert!(self.accepts("\\\\"), "{}", self.rest);
        let no = self.closed_by("& \\text{otherwise} \\end{cases}");
        if holds { yes } else { no }
    }

    fn closed_by(&mut self, close: &str) -> f64 {
        let value = self.sum();
        assert!(self.accepts(close), "{close} expected: {}", self.rest);
        value
    }

    fn factor(&mut self) -> f64 {
        type Named = (&'static str, fn(f64) -> f64);
        const FUNCTIONS: [Named; 9] = [
            ("\\sinh", f64::sinh),
            ("\\cosh", f64::cosh),
            ("\\tanh", f64::tanh),
            ("\\sin", f64::sin),
            ("\\cos", f64::cos),
            ("\\tan", f64::tan),
            ("\\arctan", f64::atan),
            ("\\ln", f64::ln),
            ("\\operatorname{sgn}", f64::signum),
        ];
        for (name, function) in FUNCTIONS {
            if self.accepts(name) {
                let exponent = self.exponent();
                return function(self.factor()).powf(exponent);
            }
        }
        if self.accepts("\\begin{cases}") {
            return self.cases();
        }
        if self.accepts("\\frac{") {
            let above = self.closed_by("}");
            assert!(self.accepts("{"));
            return above / self.closed_by("}");
        }
        if self.accepts("\\operatorname{atan2}(") {
            let y = self.closed_by(",");
            return y.atan2(self.closed_by(")"));
        }
        for (open, close) in [("(", ")"), ("\\left(", "\\right)"), ("\\left|", "\\right|")] {
            if self.accepts(open) {
                let value = self.closed_by(close);
                return if open.ends_with('|') { value.abs() } else { value };
            }
        }
        if self.accepts("\\sqrt{") {
            return self.closed_by("}").sqrt();
        }
        let digits = self.rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(self.rest.len());
        if digits > 0 {
            let value = self.rest[..digits].parse().unwrap_or(f64::NAN);
            self.rest = &self.rest[digits..];
            return value;
        }
        let longest = self.values.iter().filter(|(name, _)| self.rest.starts_with(name.as_str()));
        let named = longest.max_by_key(|(name, _)| name.len());
        if named.is_none() {
            for (constant, value) in [("\\pi", std::f64::consts::PI), ("e", std::f64::consts::E), ("\\cdot", 1.0)] {
                if self.accepts(constant) {
                    return value;
                }
            }
        }
        let Some((name, &value)) = named else { panic!("read {}", self.rest) };
        self.rest = &self.rest[name.len()..];
        value
    }
}
