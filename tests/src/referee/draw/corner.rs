//! Conditions, corners and sides on which a careless proof would cry wolf: numbers that are compared differ by rounding
//! alone, by many powers of ten or not at all, sides are equal or never taken, branches stand in branches.

use super::{Construct, Draw, Measure};

/// What is compared with what; `#` and `@` are numbers that move, `$` and `%` parameters.
const COMPARED: [&str; 34] = [
    "# < @",
    "# <= @",
    "# > 0.3",
    "# >= -1/2",
    "abs(#) < 1",
    "abs(#) + abs(@) <= 1.5",
    "abs(# + @) > abs(#)",
    "(#)^2 < 0.5",
    "(#)^2 + (@)^2 <= 1",
    "(#)*(@) > 0",
    "1e9*(#) < 1e9*(@)",
    "1e-200*(#) < 1e-200*(@)",
    "1e-12*(#) > 1e-13",
    "# + 1e12 < @ + 1e12",
    "(# + 1e12) - 1e12 < @",
    "(1e9 + #) - 1e9 > 1.0001*(#)",
    "# < 1e30",
    "# > 1e6",
    "(#)^2 < -1",
    "sin(#) > 2",
    "sin(#)^2 + cos(#)^2 > 0.5",
    "1e12*(sin(#)^2 + cos(#)^2 - 1) > 1e-7",
    "# <= #",
    "# - (#) < 0",
    "sqrt(1 + (#)^2) < 1.2",
    "hypot(#, 0.1) > @",
    "# < pi",
    "$ < %",
    "$ <= 2*$",
    "$ - % > # - (@)",
    "(#)*$ < %",
    "0.1 + 0.2 <= 0.3",
    "1e16 + 1 - 1e16 < 0.5",
    "max(#, @) < min(#, 0.7)",
];

/// Corners and sides; `#` and `@` are numbers, `?` and `~` conditions.
const CORNERS: [&str; 36] = [
    "(if ? { # } else { @ })",
    "(if ? { # } else { @ })",
    "(if ? { (#)^2 } else { (#)^3 })",
    "(if ? && ~ { # } else { (@)^2 })",
    "(if ? || ~ { #*(@) } else { 1 - # })",
    "(if !(?) { # } else { @ })",
    "(if ? { # } else if ~ { @ } else { # + @ })",
    "(if ? { if ~ { # } else { @ } } else { (if ~ { @ } else { 2*(#) }) })",
    "(if ? { # } else { # })",
    "(if ? { # + @ } else { @ + # })",
    "(if ? { (# + @)^2 } else { (#)^2 + 2*(#)*(@) + (@)^2 })",
    "(if ? { sqrt(0.2 + (#)^2) } else { @ })",
    "sqrt(0.3 + (if ? { (#)^2 } else { (@)^4 }))",
    "sqrt(if ? { (#)^2 + 0.1 } else { (#)^2 })",
    "sqrt((#)^2)*(@)",
    "sin(if ? { # } else { 2*(@) })",
    "cos(abs(#) + @)",
    "exp(-abs(#))",
    "abs(#)",
    "abs(# + @)",
    "abs(# - (@)) + abs(@ - (#))",
    "abs(abs(#) - abs(@))",
    "abs(#)*abs(@)",
    "abs(#*(@))",
    "abs(#)^3",
    "abs(#)^1.5",
    "sqrt(abs(#) + 0.1)",
    "sqrt(abs(#))*(#)^2",
    "1e6*abs(1e-6*(#))",
    "signum(#)*(@)",
    "signum(#)^2 + signum(@)",
    "signum((# + 0.1) - # - 0.1)*(@)",
    "max(#, @)",
    "min(#, max(@, 0.5))",
    "clamp(#, -0.4, 0.6)^2",
    "(max(#, 0)^2 + min(@, 0)^2)/(1 + abs(#))",
];

/// Sides that are NaN where they are not taken.
const GUARDED: [&str; 6] = [
    "(if # > 0.2 { sqrt(#) } else { @ })",
    "(if # > 0.2 { 1/(#) } else { @ })",
    "(if (#)^2 < 1 { sqrt(1 - (#)^2) } else { 0 })",
    "(if abs(#) > 1e-3 { sin(#)/(#) } else { 1 - (#)^2/6 })",
    "(if # > 0 { (#)^1.5 } else { -(-(#))^1.5 })",
    "(if # <= 0 { 0 } else { (#)^2.5 })",
];

impl Draw {
    /// Piecewise energies, forces, constraints and outputs.
    pub(super) fn corners(&mut self) {
        let count = 1 + self.below(3);
        for _ in 0..count {
            let statement = self.corner();
            self.say(statement);
        }
        if self.has(Construct::Constraints) && self.chance(50) {
            self.piecewise_constraint();
        }
    }

    fn corner(&mut self) -> String {
        let value = self.piecewise(2);
        match self.below(9) {
            0..3 => format!("potential += {}*{value};", self.parameter([1, 2, -2])),
            3 => {
                format!("lagrangian += {}*{value}*dt({});", self.parameter([1, 1, -1]), self.length(0))
            }
            4 => {
                format!("kinetic += 1/2*{}*(1 + ({value})^2)*dt({})^2;", self.parameter([1, 0, 0]), self.length(0))
            }
            5 => self.piecewise_dissipation(),
            6 | 7 => self.piecewise_force(),
            _ => format!("output {} = [{value}, {}];", self.fresh("y"), self.piecewise(1)),
        }
    }

    /// A number with corners.
    fn piecewise(&mut self, depth: usize) -> String {
        let form = if self.chance(15) { self.form(&GUARDED) } else { self.form(&CORNERS) };
        format!("({})", self.filled(form, depth, Self::operand))
    }

    /// A condition.
    fn condition(&mut self, operand: fn(&mut Self, usize) -> String) -> String {
        let form = self.form(&COMPARED);
        let [one, other] = [(); 2].map(|()| operand(self, 0));
        let [first, second] = [(); 2].map(|()| self.parameter([0; 3]));
        form.replace('#', &one).replace('@', &other).replace('$', &first).replace('%', &second)
    }

    /// One of these that has nothing that is left out.
    fn form(&mut self, forms: &[&'static str]) -> &'static str {
        loop {
            let form = self.pick(forms);
            if !self.left_out.iter().any(|part| form.contains(part)) {
                return form;
            }
        }
    }

    fn filled(&mut self, form: &str, depth: usize, operand: fn(&mut Self, usize) -> String) -> String {
        let mut text = String::new();
        let [one, other] = [(); 2].map(|()| operand(self, depth));
        let conditions = [(); 2].map(|()| self.condition(operand));
        for c in form.chars() {
            match c {
                '#' => text += &format!("({one})"),
                '@' => text += &format!("({other})"),
                '?' => text += &conditions[0],
                '~' => text += &conditions[1],
                c => text.push(c),
            }
        }
        text
    }

    fn operand(&mut self, depth: usize) -> String {
        match depth {
            0 => self.plain(0),
            _ if self.chance(40) => self.piecewise(depth - 1),
            _ => self.plain(1),
        }
    }

    /// A number that depends on velocities, too.
    fn rated(&mut self, depth: usize) -> String {
        let speed = self.parameter([0, 1, -1]);
        match self.below(4) {
            0 => self.operand(depth),
            1 => format!("dt({})/{speed} + {}", self.length(0), self.plain(0)),
            _ => format!("dt({})/{speed}", self.length(0)),
        }
    }

    fn piecewise_dissipation(&mut self) -> String {
        let (power, damping) = (self.parameter([1, 2, -3]), self.parameter([1, 0, -1]));
        let rate = format!("dt({})/{}", self.length(0), self.parameter([0, 1, -1]));
        let side = self.operand(1);
        match self.below(4) {
            0 => format!("dissipation += {power}*abs({rate})^3;"),
            1 => format!("dissipation += {power}*(if {rate} > 0 {{ ({rate})^2 }} else {{ 3*({rate})^2 }});"),
            2 => format!("dissipation += {power}*max({rate}, 0)^2;"),
            _ => format!("dissipation += 1/2*{damping}*(1 + ({side})^2)*dt({})^2;", self.length(0)),
        }
    }

    fn piecewise_force(&mut self) -> String {
        let coordinates = self.coordinates.clone();
        let coordinate = self.pick(&coordinates);
        let strength = match coordinate.measure {
            Measure::Length => self.parameter([1, 1, -2]),
            Measure::Angle => self.parameter([1, 2, -2]),
        };
        let form = self.form(&CORNERS);
        let value = self.filled(form, 1, Self::rated);
        format!("force {} += -{strength}*({value});", coordinate.name)
    }

    /// A coordinate that is carried by others, one way on one side and another way on the other.
    fn piecewise_constraint(&mut self) {
        let (name, length) = (self.fresh("tie"), self.parameter([0, 1, 0]));
        let (value, other) = (self.piecewise(1), self.length(0));
        let coordinate = self.coordinate(Measure::Length);
        if self.chance(60) {
            self.own_inertia(&coordinate, Measure::Length);
        }
        let statement = match self.below(2) {
            0 => format!("constraint {name}: {coordinate} = {length}*{value};"),
            _ => format!("constraint {name}: dt({coordinate}) = ({value})*dt({other});"),
        };
        self.say(statement);
    }
}
