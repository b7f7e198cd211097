//! Arrays and matrices where other texts have numbers.

use super::{Draw, Measure};

impl Draw {
    /// A matrix of plain parameters, whose entries stand where plain numbers do.
    pub(super) fn grid(&mut self) {
        let name = self.fresh("grid");
        let rows: Vec<String> =
            (0..2).map(|_| format!("[{}, {}, {}]", self.number(), self.number(), self.number())).collect();
        self.declarations.push(format!("param {name}[2][3]: 1 = [{}];", rows.join(", ")));
        self.plains.push(format!("{name}[1][{}]", self.random.bits() % 3));
        if self.chance(50) {
            // Every element the same.
            let (name, value) = (self.fresh("row"), self.number());
            let positive = if self.chance(50) { ", positive" } else { "" };
            self.declarations.push(format!("param {name}[2]: 1 = {value}{positive};"));
            self.plains.push(format!("{name}[0]*{name}[1]"));
        }
    }

    /// A turn by a coordinate: about fixed axes, or about one of parameters.
    pub(super) fn turn_of_arrays(&mut self) -> String {
        let (one, other) = (self.number(), self.number());
        let coordinate = self.coordinate(Measure::Angle);
        match self.below(5) {
            0 => format!("rpy({coordinate}, {one}, -{other})"),
            1 => format!("rpy({one}, {coordinate}, {other})"),
            2 => format!("rpy(0, {one}, {coordinate})"),
            3 => format!("rotation([{}, {one}, -{}], {coordinate})", self.parameter([0; 3]), self.parameter([0; 3])),
            _ => {
                let axis = self.fresh("axis");
                self.declarations.push(format!("param {axis}[3]: 1 = [{one}, -{other}, 0.5];"));
                format!("rotation({axis}, {coordinate})")
            }
        }
    }

    /// A tensor of an array or a matrix.
    pub(super) fn inertia_of_arrays(&mut self) -> String {
        let (name, moment) = (self.fresh("j"), self.scaled(self.scale[0] + 2 * self.scale[1]));
        let times = |factors: &[&str]| factors.iter().map(|by| format!("{by}*{moment}")).collect::<Vec<_>>().join(", ");
        match self.below(5) {
            0 => {
                self.declarations.push(format!("param {name}[3]: kg*m^2 = [{}];", times(&["1", "1.2", "0.8"])));
                let function = self.pick(&["diag", "inertia"]);
                format!("{function}({name})")
            }
            1 => {
                let entries = times(&["1", "1.1", "0.9", "0.1", "-0.05", "0.02"]);
                self.declarations.push(format!("param {name}[6]: kg*m^2 = [{entries}];"));
                format!("inertia({name})")
            }
            2 => {
                let rows = ["1 0.1 0.05", "0.1 1.2 0", "0.05 0 0.9"];
                let rows = rows.map(|row| format!("[{}]", times(&row.split(' ').collect::<Vec<_>>())));
                self.declarations.push(format!("param {name}[3][3]: kg*m^2 = [{}];", rows.join(", ")));
                let entry = |place: &str| format!("{name}[{}][{}]", &place[..1], &place[1..]);
                format!("inertia({})", ["00", "11", "22", "01", "02", "12"].map(entry).join(", "))
            }
            3 => {
                let row = |row: [&str; 3]| format!("[{}]", times(&row));
                let rows = [row(["1", "-0.1", "0"]), row(["-0.1", "1.1", "0"]), row(["0", "0", "0.8"])];
                self.declarations.push(format!("const {name}: kg*m^2 = [{}];", rows.join(", ")));
                if self.chance(50) { name } else { format!("inertia({name})") }
            }
            _ => {
                let moment = self.parameter([1, 2, 0]);
                format!("inertia([{moment}, 1.3*{moment}, 0.8*{moment}])")
            }
        }
    }
}
