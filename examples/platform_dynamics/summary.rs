//! The summary: what each motion asks of the legs, and where it asks too much.

use mbs_examples::{print, println};
use std::path::Path;

use mbs_examples::{Failure, output::write_table};
use mbs_platform::limits::{Excess, Survey};
use mbs_platform::{HOME, LegVector, Motion, Platform};

use crate::control::{self, follow};
use crate::histories::{History, POWER, STEP, duration};
use crate::{MOMENT, POSE, Results, along, direct, sensitivity};
use mbs_examples::platform_dynamics::tables::{PAYLOAD_OF_TABLE_4, PAYLOADS, Samples, TABLE_4, table_3, table_4};

/// A motion, and what it asks of the legs under one payload.
pub(crate) struct Study {
    number: usize,
    name: &'static str,
    payload: u32,
    pub(crate) with_actuators: Survey,
    without_actuators: Survey,
}

pub(crate) fn studies(platform: &Platform) -> Result<Vec<Study>, Failure> {
    let mut studies = Vec::new();
    for (i, (name, motion)) in Motion::CASES.iter().enumerate() {
        let end = duration(motion);
        for payload in PAYLOADS {
            let loaded = platform.with_payload(f64::from(payload))?;
            studies.push(Study {
                number: i + 1,
                name,
                payload,
                with_actuators: loaded.survey(motion, end, STEP)?,
                without_actuators: loaded.without_actuator_inertia().survey(motion, end, STEP)?,
            });
        }
    }
    Ok(studies)
}

fn excesses(survey: &Survey) -> impl Iterator<Item = &Excess> {
    survey.excesses.as_flattened().iter().flatten()
}

pub(crate) fn print(platform: &Platform, results: &Results) -> Result<(), Failure> {
    println!("The Stewart platform PS-6TL-1500, geometry and masses assumed\n");
    let regularity = platform.regularity(&HOME)?;
    println!(
        "At home the legs are {:.4} m long, the Jacobian has the condition {:.4}",
        platform.lengths(&HOME)?[0],
        regularity.condition
    );
    let found = direct(platform)?;
    println!(
        "Direct kinematics from home: ({}) in {} steps, lengths to {:.0e} m",
        row(&found.pose, 6),
        found.iterations,
        found.residual
    );
    println!("  the pose was               ({})", row(&POSE, 6));

    let samples = Samples::coarse();
    println!("\nTable 3 at 0 s: lengths and forces of the legs 1 to 6");
    let runs = table_3(platform, &samples)?;
    println!("  {} m", row(&runs[0].lengths[0], 6));
    for run in &runs {
        println!("  {} N, payload {} kg", row(&run.forces[0], 2), run.payload);
        println!("  {} N, payload {} kg, legs without mass", row(&run.forces_without_actuators[0], 2), run.payload);
    }
    println!("\nTable 4 at 0 s, payload 300 kg: forces of the legs [N]");
    for (name, angles) in TABLE_4 {
        let run = table_4(platform, angles, &samples)?;
        println!("  {} {name}", row(&run.forces[0], 2));
        println!("  {} {name}, legs without mass", row(&run.forces_without_actuators[0], 2));
    }
    print_studies(platform, &results.studies);
    print_power(&results.histories);
    print_sensitivity(platform)?;
    along::print(&results.tables, platform)?;
    if let Some((pair, courses)) = &results.pair {
        along::print_pair(courses, *pair);
    }
    print_diagonal(platform)?;
    print_control(platform)
}

fn print_studies(platform: &Platform, studies: &[Study]) {
    let limits = platform.limits;
    println!(
        "\nEight motions: lengths [m], speed [m/s], condition; largest force [N], in brackets on legs without mass"
    );
    for of_one in studies.chunks(PAYLOADS.len()) {
        let Survey { length: [shortest, longest], speed, condition, .. } = of_one[0].with_actuators;
        print!(
            "  {} {:9} {shortest:.3} to {longest:.3}, {speed:.3}, {:.2};",
            of_one[0].number, of_one[0].name, condition.0
        );
        for study in of_one {
            let [with, without] = [&study.with_actuators, &study.without_actuators].map(|survey| survey.force);
            print!("  {} kg: {with:.0} ({without:.0})", study.payload);
        }
        println!();
    }
    println!(
        "\nBeyond the limits {} to {} m, {} m/s, {} N, legs with mass:",
        limits.shortest, limits.longest, limits.speed, limits.force
    );
    for study in studies {
        // Lengths and speeds are those of all payloads.
        let told =
            excesses(&study.with_actuators).filter(|excess| study.payload == 0 || excess.first.quantity.unit() == "N");
        for Excess { first, worst } in told {
            let (what, unit) = (worst.quantity, worst.quantity.unit());
            let load = if unit == "N" { format!(", payload {} kg", study.payload) } else { String::new() };
            println!(
                "  motion {} ({}{load}), leg {}: {what} from {:.2} s on, most at {:.2} s: {:.3} {unit}, the limit is {} {unit}",
                study.number,
                study.name,
                worst.leg + 1,
                first.time,
                worst.time,
                worst.value,
                worst.limit
            );
        }
    }
    let clear = studies.iter().filter(|study| study.with_actuators.is_clear()).count();
    println!("  {clear} of {} combinations of motion and payload keep all limits", studies.len());
}

fn print_power(histories: &[History]) {
    println!("\nPower [W]: of one leg, and of all six together, least to greatest, payload {PAYLOAD_OF_TABLE_4} kg");
    for history in histories.iter().filter(|history| history.payload == PAYLOAD_OF_TABLE_4) {
        let [least, greatest] = history.extremes(POWER.1).map(|extreme| extreme.value);
        let [lowest, highest] =
            history.total_power().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        println!(
            "  {} {:9} {least:8.0} to {greatest:6.0}; {lowest:8.0} to {highest:6.0}",
            history.number, history.name
        );
    }
}

fn print_sensitivity(platform: &Platform) -> Result<(), Failure> {
    println!("\nDerivatives of the forces of legs 1 to 6, combined motion at {MOMENT} s, payload 300 kg");
    for (by, unit, derivatives) in sensitivity::rows(platform)? {
        println!("  {} {unit} by {by}", row(&derivatives, 4));
    }
    println!("Stiffness of the platform there, legs of {} N/µm: N/µm, kN, kN·m", sensitivity::LEG_STIFFNESS * 1e-6);
    let stiffness = sensitivity::stiffness(platform)?;
    for (i, entries) in stiffness.iter().enumerate() {
        let scaled: LegVector =
            std::array::from_fn(|j| if i < 3 && j < 3 { 1e-6 * entries[j] } else { 1e-3 * entries[j] });
        println!("  {}", row(&scaled, 3));
    }
    Ok(())
}

/// How far (4.15) is off.
fn print_diagonal(platform: &Platform) -> Result<(), Failure> {
    let (mut worst, mut at, mut of) = (0.0, 0.0, 0.0);
    let bare = platform.without_actuator_inertia();
    for i in 0..2000 {
        let t = f64::from(i) * STEP;
        let [q, qd, qdd] = Motion::COMBINED.at(t);
        let (right, printed) = (bare.leg_forces(&q, &qd, &qdd)?, bare.printed_leg_forces(&q, &qd, &qdd)?);
        for leg in 0..6 {
            if (right[leg] - printed[leg]).abs() > worst {
                (worst, at, of) = ((right[leg] - printed[leg]).abs(), t, right[leg]);
            }
        }
    }
    let q = Motion::COMBINED.at(MOMENT)[0];
    let matrix = bare.model().mass_matrix(&q);
    let coupling = (0..36).filter(|i| i / 6 != i % 6).map(|i| matrix[i / 6][i % 6].abs()).fold(0.0, f64::max);
    println!("\nThe diagonal mass matrix of (4.15), E18, payload 300 kg, legs without mass, combined motion:");
    println!(
        "  it leaves out entries of up to {coupling:.2} kg·m at {MOMENT} s; forces are wrong by up to {worst:.1} N (of {of:.1} N at {at:.2} s)"
    );
    Ok(())
}

fn print_control(platform: &Platform) -> Result<(), Failure> {
    println!(
        "\nComputed torque, from rest at home onto the combined motion in {} s, payload 300 kg",
        control::DURATION
    );
    for limit in [platform.limits.force, 2000.0, 1500.0] {
        let following = follow(platform, limit)?;
        print!("  actuators of {:.0} N, at their limit for {:.2} s: ", following.limit, following.saturated);
        match following.lost {
            Some(time) => println!("the platform falls into a singular pose at {time:.2} s"),
            None => println!(
                "up to {:.0} N are asked, at the end off by {:.1e} m, {:.1e} rad",
                following.asked, following.error[0], following.error[1]
            ),
        }
    }
    Ok(())
}

/// `cases.csv`: what each motion asks of the legs, by payload; `limits.csv`: where it exceeds the limits, by payload
/// and leg.
///
/// Forces in `limits.csv` are those on legs with mass; `cases.csv` has the largest ones on legs without mass too.
pub(crate) fn write(folder: &Path, studies: &[Study]) -> Result<(), Failure> {
    let header = [
        "motion",
        "payload [kg]",
        "shortest leg [m]",
        "longest leg [m]",
        "largest speed [m/s]",
        "largest condition",
        "largest force, legs with mass [N]",
        "largest force, legs without mass [N]",
    ];
    let rows = studies.iter().map(|Study { number, payload, with_actuators, without_actuators, .. }| {
        let Survey { length: [shortest, longest], speed, force, condition, .. } = *with_actuators;
        let payload = f64::from(*payload);
        vec![*number as f64, payload, shortest, longest, speed, condition.0, force, without_actuators.force]
    });
    write_table(folder, "cases", &header.map(String::from), rows)?;
    let mut writer = csv::Writer::from_path(folder.join("limits.csv"))?;
    writer.write_record([
        "motion",
        "name",
        "payload [kg]",
        "leg",
        "limit",
        "unit",
        "limit value",
        "first time [s]",
        "first value",
        "worst time [s]",
        "worst value",
        "legs",
    ])?;
    for study in studies {
        for Excess { first, worst } in excesses(&study.with_actuators) {
            let record = [
                study.number.to_string(),
                study.name.to_string(),
                study.payload.to_string(),
                (worst.leg + 1).to_string(),
                worst.quantity.to_string(),
                worst.quantity.unit().to_string(),
                worst.limit.to_string(),
                first.time.to_string(),
                first.value.to_string(),
                worst.time.to_string(),
                worst.value.to_string(),
                "with mass".to_string(),
            ];
            writer.write_record(record)?;
        }
    }
    writer.flush()?;
    Ok(())
}

fn row(numbers: &[f64], decimals: usize) -> String {
    let width = decimals + 7;
    numbers.iter().map(|x| format!("{x:>width$.decimals$}")).collect::<Vec<_>>().join(" ")
}
