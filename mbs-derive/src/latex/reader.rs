//! A reader of what is written: tests know by it that the page has the values that were derived.
//!
//! [`Reader`] reads an expression; [`Read`] is a whole page, of whose text nothing else is known than the values of the
//! declared symbols.

use std::collections::BTreeMap;

/// What a page says.
#[derive(Debug, Default)]
pub(super) struct Read {
    /// Declared symbols, abbreviations and entries.
    pub(super) values: BTreeMap<String, f64>,
    /// Matrices and columns, row by row.
    pub(super) matrices: BTreeMap<String, Vec<f64>>,
}

impl Read {
    /// Reads all definitions of a page in their order, each by those before it; equations of motion define nothing.
    pub(super) fn page(text: &str, symbols: &BTreeMap<String, f64>) -> Read {
        let mut read = Read { values: symbols.clone(), ..Read::default() };
        let mut matrices = Vec::new();
        let blocks = text.split("\\paragraph{").filter(|block| !block.starts_with("Equations of motion"));
        for align in blocks.flat_map(|block| block.split("\\begin{align*}\n").skip(1)) {
            let align = align.split("\n\\end{align*}").next().unwrap_or_default();
            // Lines that go on, then rows of matrices, then rows.
            let joined = ["\\\\\n  &\\quad {}", "\\\\\n  & \\quad {}"];
            let align = joined.iter().fold(align.to_string(), |text, mark| text.replace(mark, " "));
            let align = align.replace("\\\\\n    ", ";").replace("\n    ", "").replace("\n  \\end", "\\end");
            for row in align.split(" \\\\\n") {
                for definition in row.trim().trim_start_matches("& ").split(", \\quad ") {
                    let (name, text) = definition.split_once('=').unwrap_or_else(|| panic!("{definition}"));
                    let name = name.trim().trim_end_matches(['&', ' ']);
                    match text.trim().strip_prefix("\\begin{bmatrix}") {
                        Some(matrix) => matrices.push((name.to_string(), matrix.replace("\\end{bmatrix}", ""))),
                        None if text.trim() == "\\mathbf{0}" => {}
                        None => read.define(name, text.trim().trim_end_matches("= 0")),
                    }
                }
            }
        }
        for (name, matrix) in matrices {
            let entries = matrix.split(';').flat_map(|row| row.split(" & "));
            let entries = entries.map(|entry| read.value(entry)).collect();
            assert!(read.matrices.insert(name.clone(), entries).is_none(), "{name} stands twice on the page");
        }
        read
    }

    fn define(&mut self, name: &str, text: &str) {
        let value = self.value(text);
        let before = self.values.insert(name.to_string(), value);
        assert!(before.is_none(), "{name} is defined twice");
    }

    fn value(&self, text: &str) -> f64 {
        let mut reader = Reader { rest: text.trim(), values: &self.values };
        let value = reader.sum();
        assert!(reader.rest.trim().is_empty(), "{text}: {}", reader.rest);
        value
    }
}

type Named = (&'static str, fn(f64) -> f64);

/// Written without brackets: they take everything that follows for their arguments, up to the next one.
const FUNCTIONS: [Named; 12] = [
    ("\\sinh", f64::sinh),
    ("\\cosh", f64::cosh),
    ("\\tanh", f64::tanh),
    ("\\sin", f64::sin),
    ("\\cos", f64::cos),
    ("\\tan", f64::tan),
    ("\\arcsin", f64::asin),
    ("\\arccos", f64::acos),
    ("\\arctan", f64::atan),
    ("\\ln", f64::ln),
    ("\\operatorname{sgn}", f64::signum),
    ("\\operatorname{sech}", |x| 1.0 / x.cosh()),
];

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
        for (name, function) in FUNCTIONS {
            if self.accepts(name) {
                let exponent = self.exponent();
                let value = function(self.factor()).powf(exponent);
                let mut next = FUNCTIONS.iter().map(|(name, _)| *name).chain(["(", "\\left("]);
                let is_last = self.ends() || next.any(|next| self.rest.starts_with(next));
                assert!(is_last, "{name} is of {}, too", self.rest);
                return value;
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
