//! Sensitivity along the eight cases: of every output to every parameter the largest derivative of a case, and of one
//! pair all of it over time. Derivatives are exact, the payload is that of Table 4.

use mbs_examples::println;
use std::path::Path;
use std::str::FromStr;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::platform_dynamics::tables::PAYLOAD_OF_TABLE_4;
use mbs_examples::{Failure, output};
use mbs_platform::sensitivity::{Largest, OUTPUTS, Output, Parameter};
use mbs_platform::{Motion, Platform};
use serde_json::{Value, json};

use crate::cases::{assumed_keys, times};

/// Between samples of the tables \[s\].
const STEP: f64 = 0.05;
/// Between samples of one pair \[s\].
const FINE: f64 = 0.01;

/// `OUTPUT:PARAMETER`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) output: Output,
    pub(crate) parameter: Parameter,
}

impl FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (output, parameter) = text.split_once(':').ok_or("it is to be OUTPUT:PARAMETER, as in force_1:omega")?;
        let list = |names: &mut dyn Iterator<Item = &'static str>| names.collect::<Vec<_>>().join(", ");
        Ok(Self {
            output: output.parse().map_err(|_| {
                format!("there is no output '{output}'; outputs are {}", list(&mut Output::all().map(Output::name)))
            })?,
            parameter: parameter.parse().map_err(|_| {
                let names = list(&mut Parameter::all().map(Parameter::name));
                format!("there is no parameter '{parameter}'; parameters are {names}")
            })?,
        })
    }
}

/// The unit of the derivatives.
fn unit(output: Output, parameter: Parameter) -> String {
    format!("{}/({})", output.unit(), parameter.unit())
}

/// Of one case, by parameter and output, in the order of [`Parameter::all`] and [`Output::all`].
pub(crate) struct Table {
    number: usize,
    name: &'static str,
    motion: Motion,
    rows: Vec<(Parameter, [Largest; OUTPUTS])>,
}

/// The tables of every case.
pub(crate) fn tables(platform: &Platform) -> Result<Vec<Table>, Failure> {
    let loaded = platform.with_payload(f64::from(PAYLOAD_OF_TABLE_4))?;
    let table = |(i, &(name, motion)): (usize, &(&'static str, Motion))| -> Result<Table, Failure> {
        let row = |parameter| Ok((parameter, loaded.largest_derivatives(parameter, &motion, times(&motion, STEP))?));
        let rows = Parameter::all().map(row).collect::<Result<_, Failure>>()?;
        Ok(Table { number: i + 1, name, motion, rows })
    };
    Motion::CASES.iter().enumerate().map(table).collect()
}

impl Table {
    /// What a hundredth more of each parameter changes of a force at most \[N\], the largest first; those that are zero
    /// change nothing.
    fn per_percent(&self, platform: &Platform) -> Vec<(Parameter, f64)> {
        let largest_force = |row: &[Largest]| {
            let forces = Output::all().zip(row).filter(|(output, _)| matches!(output, Output::Force(_)));
            forces.map(|(_, largest)| largest.value.abs()).fold(0.0, f64::max)
        };
        let change = |(parameter, row): &(Parameter, [Largest; OUTPUTS])| {
            (*parameter, 0.01 * parameter.value(platform.params(), &self.motion).abs() * largest_force(row))
        };
        let mut changes: Vec<_> = self.rows.iter().map(change).collect();
        changes.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        changes
    }

    /// By parameter the leg with the largest derivative of each kind.
    fn to_json(&self) -> Value {
        let entry = |(parameter, row): &(Parameter, [Largest; OUTPUTS])| {
            let of_kind = |(kind, legs): (&str, &[Largest])| {
                let of_all = legs.iter().enumerate().max_by(|(_, a), (_, b)| a.value.abs().total_cmp(&b.value.abs()));
                let (leg, largest) = of_all.map_or((0, Largest::default()), |(leg, largest)| (leg + 1, *largest));
                (kind.to_string(), json!({"value": largest.value, "leg": leg, "time": largest.time}))
            };
            let kinds = ["length", "speed", "force", "power"].into_iter().zip(row.chunks(6)).map(of_kind);
            (parameter.to_string(), kinds.collect::<Value>())
        };
        self.rows.iter().map(entry).collect()
    }
}

/// By case and parameter, SI units.
pub(crate) fn to_json(tables: &[Table]) -> Value {
    let case = |table: &Table| (format!("case_{}", table.number), table.to_json());
    tables.iter().map(case).collect()
}

/// The five parameters of each case that forces depend on most.
pub(crate) fn print(tables: &[Table], platform: &Platform) -> Result<(), Failure> {
    let loaded = platform.with_payload(f64::from(PAYLOAD_OF_TABLE_4))?;
    println!("\nOf a force at most, N by one per cent more of a parameter, payload {PAYLOAD_OF_TABLE_4} kg:");
    for table in tables {
        let changes = table.per_percent(&loaded);
        let first: Vec<String> = changes[..5].iter().map(|(name, change)| format!("{name} {change:.1}")).collect();
        println!("  {} {:9} {}", table.number, table.name, first.join(", "));
    }
    Ok(())
}

/// `sensitivity_case_1.csv` … `sensitivity_case_8.csv`: a row a parameter, a column an output.
pub(crate) fn write(folder: &Path, tables: &[Table]) -> Result<(), Failure> {
    let outputs = || Output::all().map(|output| format!("{output} [{}]", output.unit()));
    let record = |(parameter, row): &(Parameter, [Largest; OUTPUTS])| -> Vec<String> {
        let numbers = row.iter().map(|largest| largest.value.to_string());
        [parameter.to_string(), parameter.unit().to_string()].into_iter().chain(numbers).collect()
    };
    tables.iter().try_for_each(|table| {
        let header = ["by", "its unit"].map(String::from).into_iter().chain(outputs());
        let name = format!("sensitivity_case_{}", table.number);
        output::write_records(folder, &name, header, table.rows.iter().map(record))
    })
}

/// One output by one parameter over time.
pub(crate) struct Course {
    number: usize,
    name: &'static str,
    /// Times \[s\] and derivatives.
    points: Vec<(f64, f64)>,
}

/// In every case.
pub(crate) fn courses(platform: &Platform, pair: Pair) -> Result<Vec<Course>, Failure> {
    let loaded = platform.with_payload(f64::from(PAYLOAD_OF_TABLE_4))?;
    let course = |(i, &(name, motion)): (usize, &(&'static str, Motion))| -> Result<Course, Failure> {
        let point = |t: f64| -> Result<(f64, f64), Failure> {
            Ok((t, pair.output.of(&loaded.leg_state_by(pair.parameter, &motion, t)?).derivative))
        };
        Ok(Course { number: i + 1, name, points: times(&motion, FINE).map(point).collect::<Result<_, _>>()? })
    };
    Motion::CASES.iter().enumerate().map(course).collect()
}

impl Course {
    fn largest(&self) -> Largest {
        let mut largest = Largest::default();
        self.points.iter().for_each(|&(time, value)| largest.take_in(value, time));
        largest
    }

    fn line(&self) -> Line {
        Line::new(format!("{} {}", self.number, self.name), self.points.clone())
    }
}

/// The pair with its largest value and its course in every case.
pub(crate) fn pair_to_json(courses: &[Course], Pair { output, parameter }: Pair) -> Value {
    let case = |course: &Course| {
        let Largest { value, time } = course.largest();
        let (t, values): (Vec<f64>, Vec<f64>) = course.points.iter().copied().unzip();
        (
            format!("case_{}", course.number),
            json!({"largest": {"value": value, "time": time}, "t": t, "values": values}),
        )
    };
    json!({
        "output": output.name(),
        "parameter": parameter.name(),
        "unit": unit(output, parameter),
        "payload": PAYLOAD_OF_TABLE_4,
        "cases": courses.iter().map(case).collect::<Value>(),
    })
}

/// The largest of each case.
pub(crate) fn print_pair(courses: &[Course], Pair { output, parameter }: Pair) {
    println!("\nLargest d {output} / d {parameter} [{}], payload {PAYLOAD_OF_TABLE_4} kg:", unit(output, parameter));
    for course in courses {
        let Largest { value, time } = course.largest();
        println!("  {} {:9} {value:>14.6e} at {time:.2} s", course.number, course.name);
    }
}

/// `sensitivity_OUTPUT_PARAMETER` as figure and table; the table has the cases one below the other.
pub(crate) fn write_pair(folder: &Path, courses: &[Course], Pair { output, parameter }: Pair) -> Result<(), Failure> {
    let name = format!("sensitivity_{output}_{parameter}");
    let label = format!("d {output} / d {parameter} [{}]", unit(output, parameter));
    let panel = |courses: &[Course]| {
        let end = courses[0].points[courses[0].points.len() - 1].0;
        let lines = courses.iter().map(Course::line).collect();
        Panel::over_time(&label, 0.0..end, lines)
    };
    // The combined case is five times as long as the others.
    let (periodic, combined) = courses.split_at(courses.len() - 1);
    let title = format!("Sensitivity of {output} to {parameter}, payload {PAYLOAD_OF_TABLE_4} kg");
    let figure = Figure { title, size: (900, 760), panels: vec![panel(periodic), panel(combined)] };
    output::write_figure(folder, &name, &figure, &assumed_keys())?;
    let row = |course: &Course, &(t, value): &(f64, f64)| vec![course.number as f64, t, value];
    let rows = courses.iter().flat_map(|course| course.points.iter().map(|point| row(course, point)));
    output::write_records(folder, &name, ["case".to_string(), "t [s]".to_string(), label.clone()], rows)
}
