//! What the legs do over time in each of the eight cases: lengths, speeds, forces and powers; their extremes, and
//! which limits they pass.

use std::path::Path;

use mbs_chart::curves::numbered;
use mbs_chart::{Figure, Panel};
use mbs_examples::platform_dynamics::tables::{PAYLOAD_OF_TABLE_4, PAYLOADS};
use mbs_examples::{Failure, output};
use mbs_platform::limits::{Excess, Extreme, LegState, Quantity, Survey, extremes};
use mbs_platform::{LegVector, Motion, Platform};
use serde_json::{Map, Value, json};

/// Between samples of a motion \[s\].
pub(crate) const STEP: f64 = 0.01;
/// All motions but the combined one have this period \[s\].
const PERIOD: f64 = 4.0;
/// Long enough for the combined motion to come near all its extremes \[s\].
const LONG: f64 = 20.0;

/// How long a case is looked at \[s\].
pub(crate) fn duration(motion: &Motion) -> f64 {
    if *motion == Motion::COMBINED { LONG } else { PERIOD }
}

/// A case under a payload, sample by sample.
pub(crate) struct History {
    /// Counted from 1.
    pub(crate) number: usize,
    pub(crate) name: &'static str,
    /// The payload \[kg\].
    pub(crate) payload: u32,
    /// The times \[s\].
    pub(crate) times: Vec<f64>,
    pub(crate) legs: Vec<LegState>,
}

fn extreme(Extreme { value, leg, time }: Extreme) -> Value {
    json!({"value": value, "leg": leg, "time": time})
}

/// What a panel or a group of columns shows, with its unit.
pub(crate) const LENGTH: (&str, fn(&LegState) -> LegVector) = ("l [m]", |legs| legs.length);
pub(crate) const SPEED: (&str, fn(&LegState) -> LegVector) = ("dl/dt [m/s]", |legs| legs.rate);
pub(crate) const FORCE: (&str, fn(&LegState) -> LegVector) = ("F [N]", |legs| legs.force);
pub(crate) const POWER: (&str, fn(&LegState) -> LegVector) = ("F dl/dt [W]", |legs| legs.power());

/// All cases under all payloads, legs with mass.
pub(crate) fn all(platform: &Platform) -> Result<Vec<History>, Failure> {
    let mut histories = Vec::new();
    for (i, (name, motion)) in Motion::CASES.iter().enumerate() {
        for payload in PAYLOADS {
            let loaded = platform.with_payload(f64::from(payload))?;
            let last = (duration(motion) / STEP).round() as u32;
            let times: Vec<f64> = (0..=last).map(|k| f64::from(k) * STEP).collect();
            let at = |&t: &f64| {
                let [q, qd, qdd] = motion.at(t);
                loaded.leg_state(&q, &qd, &qdd)
            };
            let legs = times.iter().map(at).collect::<Result<_, _>>()?;
            histories.push(History { number: i + 1, name, payload, times, legs });
        }
    }
    Ok(histories)
}

impl History {
    /// The least and the greatest value of any leg, each where it is first met.
    pub(crate) fn extremes(&self, of: fn(&LegState) -> LegVector) -> [Extreme; 2] {
        extremes(self.times.iter().zip(&self.legs).map(|(&time, legs)| (time, of(legs))))
    }

    /// Of all six legs together \[W\], at every sample.
    pub(crate) fn total_power(&self) -> impl Iterator<Item = f64> {
        self.legs.iter().map(|legs| legs.power().iter().sum())
    }

    fn to_json(&self, survey: &Survey) -> Value {
        let pair = |(_, of): (&str, fn(&LegState) -> LegVector)| {
            let [least, greatest] = self.extremes(of).map(extreme);
            json!({"least": least, "greatest": greatest})
        };
        let total = self.total_power().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        json!({
            "length": pair(LENGTH),
            "speed": pair(SPEED),
            "force": pair(FORCE),
            "power": pair(POWER),
            "total_power": {"least": total[0], "greatest": total[1]},
            "condition": {"value": survey.condition.0, "time": survey.condition.1},
            "limits_passed": survey.excesses.as_flattened().iter().flatten().map(passed).collect::<Vec<_>>(),
        })
    }

    fn file(&self) -> String {
        format!("case_{}", self.number)
    }
}

fn passed(Excess { first, worst }: &Excess) -> Value {
    let limit = match worst.quantity {
        Quantity::TooShort => "shortest",
        Quantity::TooLong => "longest",
        Quantity::Speed => "speed",
        Quantity::Force => "force",
    };
    json!({
        "leg": worst.leg + 1,
        "limit": limit,
        "bound": worst.limit,
        "unit": worst.quantity.unit(),
        "first": {"time": first.time, "value": first.value},
        "worst": {"time": worst.time, "value": worst.value},
    })
}

/// A list of the cases, each with its payloads; all values are those of samples.
pub(crate) fn to_json<'a>(histories: &[History], surveys: impl Iterator<Item = &'a Survey>) -> Value {
    let surveys: Vec<&Survey> = surveys.collect();
    let pairs: Vec<(&History, &Survey)> = histories.iter().zip(surveys).collect();
    let case = |group: &[(&History, &Survey)]| {
        let (first, _) = group[0];
        let payloads: Map<String, Value> =
            group.iter().map(|(history, survey)| (history.payload.to_string(), history.to_json(survey))).collect();
        json!({
            "number": first.number,
            "name": first.name,
            "duration": first.times[first.times.len() - 1],
            "step": STEP,
            "payloads": payloads,
        })
    };
    pairs.chunks(PAYLOADS.len()).map(case).collect()
}

/// `case_1` … `case_8`: figures with the payload of Table 4, tables with all payloads.
pub(crate) fn write(folder: &Path, histories: &[History]) -> Result<(), Failure> {
    for of_one in histories.chunks(PAYLOADS.len()) {
        for history in of_one.iter().filter(|history| history.payload == PAYLOAD_OF_TABLE_4) {
            output::write_figure(folder, &history.file(), &figure(history), &crate::CASES)?;
        }
        write_values(folder, of_one)?;
    }
    Ok(())
}

fn figure(history: &History) -> Figure {
    let panel = |(label, of): (&str, fn(&LegState) -> LegVector)| {
        let leg = |i: usize| history.times.iter().zip(&history.legs).map(move |(&t, legs)| (t, of(legs)[i])).collect();
        let lines = numbered(["leg", "legs"], &[0, 1, 2, 3, 4, 5].map(leg));
        Panel::over_time(label, 0.0..history.times[history.times.len() - 1], lines)
    };
    let History { number, name, payload, .. } = history;
    let title = format!("Case {number}, {name}: lengths, speeds, forces and powers, payload {payload} kg");
    Figure { title, size: (900, 1060), panels: [LENGTH, SPEED, FORCE, POWER].map(panel).into() }
}

/// A row a sample: lengths and speeds, then forces and powers by payload.
fn write_values(folder: &Path, of_one: &[History]) -> Result<(), Failure> {
    let columns = |label: &str| (1..=6).map(|leg| format!("leg {leg}: {label}")).collect::<Vec<_>>();
    let mut header = vec!["t [s]".to_string()];
    header.extend([columns(LENGTH.0), columns(SPEED.0)].concat());
    for history in of_one {
        for (label, _) in [FORCE, POWER] {
            header.extend(columns(&format!("{label}, payload {} kg", history.payload)));
        }
    }
    let row = |k: usize| {
        let first = &of_one[0];
        let mut row = vec![first.times[k]];
        row.extend([LENGTH.1(&first.legs[k]), SPEED.1(&first.legs[k])].concat());
        for history in of_one {
            row.extend([FORCE.1(&history.legs[k]), POWER.1(&history.legs[k])].concat());
        }
        row
    };
    output::write_table(folder, &of_one[0].file(), &header, (0..of_one[0].times.len()).map(row))
}
