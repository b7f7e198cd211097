//! Numbers that depend on positions: plain ones, lengths and angles.

use super::{Construct, Draw, Measure};

/// Functions and forms that every plain number may be put into; `#` is the number.
const SMOOTH: [&str; 22] = [
    "sin(#)",
    "cos(#)",
    "sin(#)",
    "cos(#)",
    "tanh(#)",
    "atan(#)",
    "exp(-(#)^2)",
    "exp(sin(#))",
    "sqrt(1 + (#)^2)",
    "ln(2 + (#)^2)",
    "(#)^2",
    "(#)^3",
    "1/(1 + (#)^2)",
    "(2 + (#)^2)^(-1/2)",
    "(2 + (#)^2)^1.5",
    "(1.5 + sin(#))^(1/3)",
    "asin(0.9*sin(#))",
    "acos(0.8*cos(#))",
    "sinh(sin(#))",
    "cosh(tanh(#))",
    "tan(atan(#)/2)",
    "-(#)",
];

/// Those of two numbers.
const PAIRS: [&str; 10] = [
    "(#) + (@)",
    "(#) - (@)",
    "(#)*(@)",
    "(#)/(1.5 + (@)^2)",
    "atan2(sin(#), 2 + cos(@))",
    "hypot(#, 1 + (@)^2)",
    "(1.2 + cos(#)^2)^sin(@)",
    "(#)*sin(@)",
    "(#)*cos(@)",
    "atan2(#, sqrt(1 + (@)^2))",
];

/// Those with a kink or a jump.
const KINKED: [&str; 12] = [
    "abs(#)",
    "min(#, @)",
    "max(#, @)",
    "clamp(#, -1/2, 0.7)",
    "(if # < @ { # } else { sin(@) })",
    "(if # > 0.2 { sqrt(#) } else { @ })",
    "(if # < 0 { 1 - # } else { 1/(# + 1) })",
    "(if # < 1 && @ >= -1 { (#)^2 } else { (@)^2 })",
    "(if # < -1 || !(@ > 0.3) { # } else { ln(@) })",
    "(if # <= 0 { 0 } else { (#)^2.5 })",
    "signum(#)*(@)",
    "(if # > 1 { 2*# } else if # > 0 { # + 1 } else { 1 })",
];

impl Draw {
    /// A number without a dimension.
    pub(super) fn plain(&mut self, depth: usize) -> String {
        if depth == 0 || self.chance(20) {
            return self.plain_leaf();
        }
        let kinked = self.has(Construct::Branches) && self.chance(30);
        if !self.plain_functions.is_empty() && self.chance(25) {
            let functions = self.plain_functions.clone();
            return format!("{}({})", self.pick(&functions), self.plain(depth - 1));
        }
        let form = loop {
            let form = match self.below(10) {
                _ if kinked => self.pick(&KINKED),
                0..5 => self.pick(&SMOOTH),
                _ => self.pick(&PAIRS),
            };
            if !self.left_out.iter().any(|part| form.contains(part)) {
                break form;
            }
        };
        let (one, other) = (self.plain(depth - 1), self.plain(depth - 1));
        format!("({})", form.replace('#', &one).replace('@', &other))
    }

    fn plain_leaf(&mut self) -> String {
        match self.below(8) {
            0 => self.number(),
            1 => self.parameter([0; 3]),
            2 if !self.plains.is_empty() => {
                let plains = self.plains.clone();
                self.pick(&plains)
            }
            3 | 4 => format!("{}/{}", self.length(0), self.parameter([0, 1, 0])),
            5 => format!("sin({})", self.angle(0)),
            _ => self.angle(0),
        }
    }

    pub(super) fn length(&mut self, depth: usize) -> String {
        if depth == 0 {
            let mut known: Vec<String> = self.of(Measure::Length);
            known.extend(self.lengths.clone());
            return if known.is_empty() || self.chance(20) { self.parameter([0, 1, 0]) } else { self.pick(&known) };
        }
        match self.below(6) {
            0 => format!("({} + {})", self.length(depth - 1), self.length(depth - 1)),
            1 => format!("hypot({}, {})", self.parameter([0, 1, 0]), self.length(depth - 1)),
            2 => format!("({} - {}*{})", self.length(0), self.number(), self.length(depth - 1)),
            3 if !self.places.is_empty() => {
                let (places, axis) = (self.places.clone(), self.pick(&["x", "y", "z"]));
                format!("{}.{axis}", self.pick(&places))
            }
            _ => format!("{}*{}", self.parameter([0, 1, 0]), self.plain(depth)),
        }
    }

    pub(super) fn angle(&mut self, depth: usize) -> String {
        let mut known = self.of(Measure::Angle);
        known.extend(self.angles.clone());
        match self.below(5) {
            _ if known.is_empty() => {
                if depth == 0 {
                    format!("{}/{}", self.length(0), self.parameter([0, 1, 0]))
                } else {
                    self.plain(depth)
                }
            }
            0 if depth > 0 => format!("({} + {})", self.pick(&known), self.plain(depth - 1)),
            1 if depth > 0 => format!("{}*{}", self.number(), self.pick(&known)),
            _ => self.pick(&known),
        }
    }

    /// Coordinates of a kind.
    pub(super) fn of(&self, measure: Measure) -> Vec<String> {
        self.coordinates.iter().filter(|c| c.measure == measure).map(|c| c.name.clone()).collect()
    }

    /// `fn` in the text and in another file.
    pub(super) fn functions_of_the_text(&mut self) {
        if self.has(Construct::Functions) {
            let name = self.fresh_function("f");
            let body = self.pick(&SMOOTH).replace('#', "r");
            self.functions.push(format!("fn {name}(r) = {body};"));
            self.plain_functions.push(name.clone());
            if self.chance(50) {
                let outer = self.fresh_function("f");
                let pair = self.pick(&PAIRS).replace('#', &format!("{name}(s)")).replace('@', "s");
                self.functions.push(format!("fn {outer}(s) = {pair};"));
                self.plain_functions.push(outer);
            }
        }
        if self.has(Construct::Imports) {
            let (name, constant) = (self.fresh_function("g"), self.fresh("c"));
            let body = self.pick(&SMOOTH).replace('#', &format!("{constant}*r"));
            let value = self.number();
            self.shared.push(format!("const {constant}: 1 = {value};"));
            self.shared.push(format!("fn {name}(r) = {body};"));
            self.plain_functions.push(name);
            self.plains.push(constant);
        }
    }

    /// Prescribed motions: lengths and angles, by a formula of t or from outside.
    pub(super) fn signals(&mut self) {
        if !self.has(Construct::Signals) {
            return;
        }
        let count = 1 + self.below(3);
        for _ in 0..count {
            let (name, angle) = (self.fresh("w"), self.chance(50));
            let unit = if angle { "rad" } else { "m" };
            let phase = format!("{}*t", self.parameter([0, 0, -1]));
            let form = self.pick(&["sin(#)", "cos(#)^2", "exp(-(#)^2)", "#", "1/(1 + (#)^2)", "(#)^2/2"]);
            let formula = form.replace('#', &phase);
            let amplitude = if angle { self.number() } else { self.parameter([0, 1, 0]) };
            let value = if self.chance(60) { format!(" = {amplitude}*({formula})") } else { String::new() };
            self.declarations.push(format!("prescribed {name}: {unit}{value};"));
            if angle { self.angles.push(name) } else { self.lengths.push(name) }
        }
        if self.chance(30) {
            let phase = format!("{}*t", self.parameter([0, 0, -1]));
            self.plains.push(phase);
        }
    }
}
