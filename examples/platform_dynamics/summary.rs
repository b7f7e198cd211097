//! What each motion asks of the legs, and where it asks too much, as JSON and as text.

use mbs_examples::platform_dynamics::tables::{PAYLOAD_OF_TABLE_4, PAYLOADS, Run, Samples, TABLE_4, table_3, table_4};
use mbs_examples::{Failure, print, println};
use mbs_platform::limits::{Excess, Survey};
use mbs_platform::{HOME, LegVector, Motion, Platform};
use serde_json::{Value, json};

use crate::cases::{self, Case, POWER, STEP};
use crate::control::{self, follow};
use crate::{MOMENT, POSE, Results, along, direct, sensitivity};

/// The tables at t = 0, 0.5, …, 4 s, the equations of motion at one moment, and the eight cases.
pub(crate) fn to_json(platform: &Platform, results: &Results) -> Result<Value, Failure> {
    let samples = Samples::coarse();
    let table_3 = table_3(platform, &samples)?;
    let forces = |run: &Run| json!({"with_actuators": run.forces, "without_actuators": run.forces_without_actuators});
    let by_payload: Value = table_3.iter().map(|run| (format!("payload_{}", run.payload), forces(run))).collect();
    let mut by_angles = json!({});
    for (name, angles) in TABLE_4 {
        let run = table_4(platform, angles, &samples)?;
        by_angles[name] = json!({
            "lengths": run.lengths,
            "with_actuators": run.forces,
            "without_actuators": run.forces_without_actuators,
        });
    }
    let found = direct(platform)?;
    let [q, qd, _] = Motion::COMBINED.at(MOMENT);
    let mut report = json!({
        "table3": {"lengths": table_3[0].lengths, "forces": by_payload},
        "table4": by_angles,
        "direct_kinematics": {"pose": found.pose, "iterations": found.iterations, "residual": found.residual},
        "mass_matrix": platform.model().mass_matrix(&q),
        "coriolis_matrix": platform.model().coriolis_matrix(&q, &qd),
        "gravity": platform.model().gravity(&q),
        "cases": cases::to_json(&results.cases),
        "sensitivity": along::to_json(&results.tables),
    });
    if let Some((pair, courses)) = &results.pair {
        report["sensitivity_of"] = along::pair_to_json(courses, *pair);
    }
    Ok(report)
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
    print_cases(platform, &results.cases);
    print_power(&results.cases);
    print_sensitivity(platform)?;
    along::print(&results.tables, platform)?;
    if let Some((pair, courses)) = &results.pair {
        along::print_pair(courses, *pair);
    }
    print_diagonal(platform)?;
    print_control(platform)
}

fn print_cases(platform: &Platform, cases: &[Case]) {
    let limits = platform.limits;
    println!(
        "\nEight motions: lengths [m], speed [m/s], condition; largest force [N], in brackets on legs without mass"
    );
    for of_motion in cases.chunks(PAYLOADS.len()) {
        let Survey { length: [shortest, longest], speed, condition, .. } = of_motion[0].with_actuators;
        print!(
            "  {} {:9} {shortest:.3} to {longest:.3}, {speed:.3}, {:.2};",
            of_motion[0].number, of_motion[0].name, condition.0
        );
        for case in of_motion {
            let [with, without] = [&case.with_actuators, &case.without_actuators].map(|survey| survey.force);
            print!("  {} kg: {with:.0} ({without:.0})", case.payload);
        }
        println!();
    }
    println!(
        "\nBeyond the limits {} to {} m, {} m/s, {} N, legs with mass:",
        limits.shortest, limits.longest, limits.speed, limits.force
    );
    for case in cases {
        let Case { number, name, payload, .. } = case;
        // Lengths and speeds are those of all payloads.
        for Excess { first, worst } in case.excesses().filter(|of| *payload == 0 || of.first.quantity.unit() == "N") {
            let (what, unit, leg) = (worst.quantity, worst.quantity.unit(), worst.leg + 1);
            let load = if unit == "N" { format!(", payload {payload} kg") } else { String::new() };
            println!(
                "  motion {number} ({name}{load}), leg {leg}: {what} from {:.2} s on, most at {:.2} s: {:.3} {unit}, the limit is {} {unit}",
                first.time, worst.time, worst.value, worst.limit
            );
        }
    }
    let clear = cases.iter().filter(|case| case.with_actuators.is_clear()).count();
    println!("  {clear} of {} combinations of motion and payload keep all limits", cases.len());
}

fn print_power(cases: &[Case]) {
    println!("\nPower [W]: of one leg, and of all six together, least to greatest, payload {PAYLOAD_OF_TABLE_4} kg");
    for case in cases.iter().filter(|case| case.payload == PAYLOAD_OF_TABLE_4) {
        let [least, greatest] = case.extremes(POWER).map(|extreme| extreme.value);
        let ([lowest, highest], Case { number, name, .. }) = (case.total_power(), case);
        println!("  {number} {name:9} {least:8.0} to {greatest:6.0}; {lowest:8.0} to {highest:6.0}");
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

fn row(numbers: &[f64], decimals: usize) -> String {
    let width = decimals + 7;
    numbers.iter().map(|x| format!("{x:>width$.decimals$}")).collect::<Vec<_>>().join(" ")
}
