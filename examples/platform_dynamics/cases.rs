//! The eight motions under all payloads: what legs do over time, what that asks of them, and which limits it passes.

use std::path::Path;

use mbs_chart::curves::numbered;
use mbs_chart::{Figure, Panel};
use mbs_examples::output::{write_figure, write_records};
use mbs_examples::platform_dynamics::tables::{PAYLOAD_OF_TABLE_4, PAYLOADS};
use mbs_examples::{Failure, assumed};
use mbs_platform::limits::{Excess, Extreme, LegState, Quantity, Survey, extremes};
use mbs_platform::{LegVector, Motion, Platform};
use serde_json::{Value, json};

/// Between samples of a motion \[s\].
pub(crate) const STEP: f64 = 0.01;
/// All motions but the combined one have this period \[s\].
const PERIOD: f64 = 4.0;
/// Long enough for the combined motion to come near all its extremes \[s\].
const LONG: f64 = 20.0;

/// What the histories of the eight cases rest on, beside what every leg does.
const ASSUMED: [&str; 8] = [
    "gravity",
    "platform.attitude",
    "platform.payload",
    "platform.frequency",
    "platform.height",
    "platform.cases",
    "platform.combined",
    "platform.combined_frequencies",
];

/// What the histories of the eight cases rest on.
pub(crate) fn assumed_keys() -> Vec<&'static str> {
    [&assumed::PLATFORM.concat()[..], &ASSUMED].concat()
}

/// How long a case is looked at \[s\].
fn duration(motion: &Motion) -> f64 {
    if *motion == Motion::COMBINED { LONG } else { PERIOD }
}

/// The moments at which a case is looked at \[s\].
pub(crate) fn times(motion: &Motion, step: f64) -> impl Iterator<Item = f64> + use<> {
    let last = (duration(motion) / step).round() as u32;
    (0..=last).map(move |k| f64::from(k) * step)
}

/// A case under a payload, sample by sample.
pub(crate) struct Case {
    /// Counted from 1.
    pub(crate) number: usize,
    pub(crate) name: &'static str,
    /// The payload \[kg\].
    pub(crate) payload: u32,
    /// The times \[s\].
    times: Vec<f64>,
    /// Legs with mass.
    legs: Vec<LegState>,
    /// Of legs with mass, and of legs without.
    pub(crate) with_actuators: Survey,
    pub(crate) without_actuators: Survey,
}

/// What a panel or a group of columns shows, with its unit.
type Shown = (&'static str, fn(&LegState) -> LegVector);
const LENGTH: Shown = ("l [m]", |legs| legs.length);
const SPEED: Shown = ("dl/dt [m/s]", |legs| legs.rate);
const FORCE: Shown = ("F [N]", |legs| legs.force);
pub(crate) const POWER: Shown = ("F dl/dt [W]", |legs| legs.power());

/// All cases under all payloads.
pub(crate) fn all(platform: &Platform) -> Result<Vec<Case>, Failure> {
    let mut cases = Vec::new();
    for (i, (name, motion)) in Motion::CASES.iter().enumerate() {
        let times: Vec<f64> = times(motion, STEP).collect();
        for payload in PAYLOADS {
            let loaded = platform.with_payload(f64::from(payload))?;
            let at = |&t: &f64| {
                let [q, qd, qdd] = motion.at(t);
                loaded.leg_state(&q, &qd, &qdd)
            };
            let survey = |platform: &Platform| platform.survey(motion, duration(motion), STEP);
            cases.push(Case {
                number: i + 1,
                name,
                payload,
                legs: times.iter().map(at).collect::<Result<_, _>>()?,
                times: times.clone(),
                with_actuators: survey(&loaded)?,
                without_actuators: survey(&loaded.without_actuator_inertia())?,
            });
        }
    }
    Ok(cases)
}

impl Case {
    /// The least and the greatest value of any leg, each where it is first met.
    pub(crate) fn extremes(&self, (_, of): Shown) -> [Extreme; 2] {
        extremes(self.times.iter().zip(&self.legs).map(|(&time, legs)| (time, of(legs))))
    }

    /// The least and the greatest power of all six legs together \[W\].
    pub(crate) fn total_power(&self) -> [f64; 2] {
        let total = self.legs.iter().map(|legs| legs.power().iter().sum());
        total.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x: f64| [a.min(x), b.max(x)])
    }

    /// Where legs with mass pass their limits.
    pub(crate) fn excesses(&self) -> impl Iterator<Item = &Excess> {
        self.with_actuators.excesses.as_flattened().iter().flatten()
    }

    fn to_json(&self) -> Value {
        let extreme = |Extreme { value, leg, time }| json!({"value": value, "leg": leg, "time": time});
        let pair = |shown| {
            let [least, greatest] = self.extremes(shown).map(extreme);
            json!({"least": least, "greatest": greatest})
        };
        let [least, greatest] = self.total_power();
        let (condition, time) = self.with_actuators.condition;
        json!({
            "length": pair(LENGTH),
            "speed": pair(SPEED),
            "force": pair(FORCE),
            "power": pair(POWER),
            "total_power": {"least": least, "greatest": greatest},
            "condition": {"value": condition, "time": time},
            "limits_passed": self.excesses().map(passed).collect::<Vec<_>>(),
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
pub(crate) fn to_json(cases: &[Case]) -> Value {
    let of_motion = |group: &[Case]| {
        let first = &group[0];
        json!({
            "number": first.number,
            "name": first.name,
            "duration": first.times[first.times.len() - 1],
            "step": STEP,
            "payloads": group.iter().map(|case| (case.payload.to_string(), case.to_json())).collect::<Value>(),
        })
    };
    cases.chunks(PAYLOADS.len()).map(of_motion).collect()
}

/// `case_1` … `case_8`: figures with the payload of Table 4, tables with all payloads; `cases.csv` and `limits.csv`.
pub(crate) fn write(folder: &Path, cases: &[Case]) -> Result<(), Failure> {
    for of_motion in cases.chunks(PAYLOADS.len()) {
        for case in of_motion.iter().filter(|case| case.payload == PAYLOAD_OF_TABLE_4) {
            write_figure(folder, &case.file(), &figure(case), &assumed_keys())?;
        }
        write_values(folder, of_motion)?;
    }
    write_demands(folder, cases)?;
    write_limits(folder, cases)
}

fn figure(case: &Case) -> Figure {
    let panel = |(label, of): Shown| {
        let leg = |i: usize| case.times.iter().zip(&case.legs).map(move |(&t, legs)| (t, of(legs)[i])).collect();
        let lines = numbered(["leg", "legs"], &[0, 1, 2, 3, 4, 5].map(leg));
        Panel::over_time(label, 0.0..case.times[case.times.len() - 1], lines)
    };
    let Case { number, name, payload, .. } = case;
    let title = format!("Case {number}, {name}: lengths, speeds, forces and powers, payload {payload} kg");
    Figure { title, size: (900, 1060), panels: [LENGTH, SPEED, FORCE, POWER].map(panel).into() }
}

/// A row a sample: lengths and speeds, then forces and powers by payload.
fn write_values(folder: &Path, of_motion: &[Case]) -> Result<(), Failure> {
    let first = &of_motion[0];
    let loaded = of_motion.iter().flat_map(|case| [FORCE, POWER].map(|shown| (case, shown, true)));
    let shown: Vec<_> = [LENGTH, SPEED].map(|shown| (first, shown, false)).into_iter().chain(loaded).collect();
    let names = shown.iter().flat_map(|(case, (label, _), is_loaded)| {
        let load = if *is_loaded { format!(", payload {} kg", case.payload) } else { String::new() };
        (1..=6).map(move |leg| format!("leg {leg}: {label}{load}"))
    });
    let row = |(k, &t): (usize, &f64)| {
        let values = shown.iter().flat_map(|(case, (_, of), _)| of(&case.legs[k]));
        std::iter::once(t).chain(values).collect::<Vec<f64>>()
    };
    let header = std::iter::once("t [s]".to_string()).chain(names);
    write_records(folder, &first.file(), header, first.times.iter().enumerate().map(row))
}

/// `cases.csv`: what each motion asks of the legs, by payload; the largest force on legs without mass, too.
fn write_demands(folder: &Path, cases: &[Case]) -> Result<(), Failure> {
    let header = "motion; payload [kg]; shortest leg [m]; longest leg [m]; largest speed [m/s]; largest condition; \
                  largest force, legs with mass [N]; largest force, legs without mass [N]";
    let rows = cases.iter().map(|Case { number, payload, with_actuators, without_actuators, .. }| {
        let Survey { length: [shortest, longest], speed, force, condition, .. } = *with_actuators;
        let payload = f64::from(*payload);
        vec![*number as f64, payload, shortest, longest, speed, condition.0, force, without_actuators.force]
    });
    write_records(folder, "cases", header.split("; ").map(String::from), rows)
}

/// `limits.csv`: where legs with mass exceed the limits, by motion, payload and leg.
fn write_limits(folder: &Path, cases: &[Case]) -> Result<(), Failure> {
    let header = "motion; name; payload [kg]; leg; limit; unit; limit value; first time [s]; first value; \
                  worst time [s]; worst value; legs";
    let rows = cases.iter().flat_map(|case| {
        case.excesses().map(|Excess { first, worst }| {
            let (what, unit) = (worst.quantity.to_string(), worst.quantity.unit().to_string());
            let numbers = [worst.limit, first.time, first.value, worst.time, worst.value].map(|x| x.to_string());
            let leg = (worst.leg + 1).to_string();
            let of = [case.number.to_string(), case.name.to_string(), case.payload.to_string(), leg, what, unit];
            [&of[..], &numbers, &["with mass".to_string()]].concat()
        })
    });
    write_records(folder, "limits", header.split("; ").map(String::from), rows)
}
