//! Tables.

use super::Draw;

/// Kinds of tables, and how few samples each can have.
const KINDS: [(&str, usize); 3] = [("table", 2), ("table_monotone", 2), ("table_spline", 3)];

impl Draw {
    /// Places that increase, around 0, which is one of them now and then.
    fn places_of_samples(&mut self, count: usize) -> Vec<String> {
        // In tenths.
        let mut at = self.below(15) as i32 - 20;
        let mut places = Vec::new();
        for _ in 0..count {
            places.push(at);
            at += 1 + self.below(12) as i32;
        }
        if let Some(near) = places.iter().position(|place| place.abs() < 3).filter(|_| self.chance(60)) {
            let shift = places[near];
            places.iter_mut().for_each(|place| *place -= shift);
        }
        places
            .iter()
            .map(|place| format!("{}{}.{}", if *place < 0 { "-" } else { "" }, place.abs() / 10, place.abs() % 10))
            .collect()
    }

    /// Values that rise, fall and stay.
    fn values_of_samples(&mut self, count: usize) -> Vec<String> {
        let mut last = 0.3;
        let mut value = || {
            last += [0.0, 0.4, 0.7, -0.9, 1.3, -0.2][self.below(6)];
            format!("{last:.1}")
        };
        (0..count).map(|_| value()).collect()
    }

    /// Functions of a plain number that a table gives.
    pub(super) fn samples(&mut self) {
        let tables = 1 + self.below(2);
        for _ in 0..tables {
            let (kind, least) = self.pick(&KINDS);
            let count = least + self.below(4);
            let (xs, ys) = (self.places_of_samples(count), self.values_of_samples(count));
            let (place, value) = (self.fresh("xs"), self.fresh("ys"));
            match self.below(4) {
                0 => {
                    let path = format!("{place}.csv");
                    let rows: String = xs.iter().zip(&ys).map(|(x, y)| format!("{x}, {y}\n")).collect();
                    self.tables.push((path, format!("# Measured.\n{place}, {value} [1]\n\n{rows}")));
                }
                1 => {
                    self.declarations.push(format!("const {place}[{count}] = [{}];", xs.join(", ")));
                    self.declarations.push(format!("const {value}[{count}]: deg = [{}];", ys.join(", ")));
                }
                _ => {
                    self.declarations.push(format!("const {place}[{count}]: 1 = [{}];", xs.join(", ")));
                    self.declarations.push(format!("param {value}[{count}]: 1 = [{}];", ys.join(", ")));
                }
            }
            let function = self.fresh_function("f");
            self.functions.push(format!("fn {function}(r) = {kind}(r, {place}, {value});"));
            // A slope that jumps is no energy's.
            if kind != "table" {
                self.plain_functions.push(function.clone());
            }
            self.tabulated.push(function);
        }
    }
}
