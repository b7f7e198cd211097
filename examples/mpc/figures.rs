//! How the landings of a case go, and how long their plans take.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};
use mbs_landing::quadrotor::predictive::flight::Moment;
use mbs_landing::quadrotor::predictive::limits::Limits;
use mbs_models::quadrotor_euler::Params;

use crate::flights::{Case, Flown, kept};

/// `mpc_landing_CASE`, `mpc_planning_CASE`, and the curves as numbers.
pub(crate) fn write(folder: &Path, case: &Case) -> Result<(), Failure> {
    let name = case.name;
    let write = |what: &str, title: String, height: u32, panels: Vec<Panel>| {
        let figure = Figure { title, size: (1100, height), panels };
        output::write_figure(folder, &format!("mpc_{what}_{name}"), &figure, &crate::assumed_keys())
    };
    let title = format!("Landings of case {name}: the shortest, planned anew, and predictive control");
    write("landing", title, 1250, landing(case))?;
    write("planning", format!("Case {name}: what plans say, and how long they take"), 850, planning(case))?;
    let words = "t_s x_m y_m z_m phi_rad theta_rad psi_rad deck_m visibility_m tilt_rad rotor[1-4]_rad_s";
    for (kind, flights) in [("shortest", &case.replanned), ("predictive", &case.predictive)] {
        for (air, flown) in ["calm", "windy"].into_iter().zip(flights) {
            let row = |m: &Moment| {
                [&[m.time][..], &m.state.q, &[m.deck.position[2], m.visibility, m.tilt], &m.speeds].concat()
            };
            output::write_table(folder, &format!("mpc_{kind}_{name}_{air}"), words, kept(flown).map(row))?;
        }
    }
    Ok(())
}

/// The four flights of a case, by their names in legends.
fn flights(case: &Case) -> [(&'static str, &Flown); 4] {
    let ([calm, windy], [quiet, rough]) = (&case.replanned, &case.predictive);
    [("shortest", calm), ("shortest, windy", windy), ("predictive", quiet), ("predictive, windy", rough)]
}

fn landing(case: &Case) -> Vec<Panel> {
    let end = flights(case).iter().fold(0.0_f64, |end, (_, flown)| end.max(flown.touchdown.time));
    let factor = Params::<f64>::default().thrust_factor;
    let limits = Limits::default();
    let lines = |value: &dyn Fn(&Moment) -> f64| -> Vec<Line> {
        let line = |(name, flown): (&str, &Flown)| Line::new(name, kept(flown).map(|m| (m.time, value(m))).collect());
        flights(case).map(line).into()
    };
    let greatest = |m: &Moment| m.speeds.iter().fold(0.0_f64, |most, speed| most.max(factor * speed * speed));
    let tilt = limits.tilt.to_degrees();
    let panel = |label: &str, lines: Vec<Line>| Panel::over_time(label, 0.0..end, lines);
    vec![
        panel("height over the deck [m]", lines(&|m| m.state.q[2] - m.deck.position[2])),
        panel("velocity against the deck [m/s]", lines(&|m| m.state.qd[2] - m.deck.velocity[2])),
        panel("greatest thrust of a rotor [N]", lines(&greatest)),
        panel(&format!("tilt [°], at most {tilt:.0}"), lines(&|m| m.tilt.to_degrees())),
        panel("mark within the cone by [m]", lines(&|m| m.visibility)),
    ]
}

fn planning(case: &Case) -> Vec<Panel> {
    let [calm, windy] = &case.replanned;
    let end = windy.touchdown.time.max(calm.touchdown.time);
    let times = |flown: &Flown| flown.plans.iter().skip(1).map(|(t, took)| (*t, 1e3 * took)).collect();
    let of = |flights: &[Flown; 2], value: &dyn Fn(&Flown) -> Vec<(f64, f64)>| {
        ["calm", "windy"].iter().zip(flights).map(|(air, flown)| Line::new(*air, value(flown))).collect::<Vec<_>>()
    };
    let last = case.predictive.iter().fold(0.0_f64, |end, flown| end.max(flown.touchdown.time));
    vec![
        Panel::over_time("touchdown by the plan [s]", 0.0..end, of(&case.replanned, &|flown| flown.ends.clone())),
        Panel::over_time("shortest: time of a plan [ms]", 0.0..end, of(&case.replanned, &times)),
        Panel::over_time("predictive: time of a plan [ms]", 0.0..last, of(&case.predictive, &times)),
    ]
}
