//! Files of figures: 5.2 to 5.9 of the thesis, their like for the deck at sea, the driven platform, and the curves as
//! numbers.

use std::path::Path;

use mbs_chart::curves::numbered;
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::quadrotor_landing::figures::{self as thesis, ANGLES, ROTORS, Series, over, path};
use mbs_examples::quadrotor_landing::flight::{Flight, MARINE, Moment};
use mbs_examples::quadrotor_landing::platform::{Comparison, OnPlatform};
use mbs_examples::{Failure, assumed, output};
use mbs_landing::quadrotor::driven::{DrivenMoment, TrackingError};
use mbs_platform::limits::LegState;
use mbs_platform::{LegVector, PlatformMotion};

/// Figures 5.2 to 5.9 for the cases of the thesis, and their like for the deck at sea.
pub(crate) fn write(folder: &Path, flight: &Flight, legs: &[(f64, LegState)]) -> Result<(), Failure> {
    if flight.case != MARINE {
        return output::write_figures(folder, &thesis::drawn(flight, legs));
    }
    let drawn = at_sea(flight, legs);
    drawn.iter().try_for_each(|(name, figure)| output::write_figure(folder, name, figure, &crate::assumed_keys()))
}

fn at_sea(flight: &Flight, legs: &[(f64, LegState)]) -> Vec<(String, Figure)> {
    let time = 0.0..flight.touchdown.time;
    let elevation: [Series; 2] = [("quadrotor", |m| m.state.q[2]), ("platform", |m| m.platform)];
    let height: [Series; 1] = [("", |m| m.relative.offset[2])];
    let against_deck: [Series; 3] = [
        ("roll φ", |m| m.relative.attitude[0].to_degrees()),
        ("pitch θ", |m| m.relative.attitude[1].to_degrees()),
        ("yaw ψ", |m| m.relative.attitude[2].to_degrees()),
    ];
    let total: [Series; 1] = [("", |m| m.thrust)];
    let leg_forces = leg_lines(legs.iter().map(|(t, legs)| (*t, legs.force)));
    let over = |label: &str, series: &[Series]| over(flight, label, time.clone(), series);
    let figure = |name: &str, what: &str, height: u32, panels: Vec<Panel>| {
        (format!("{MARINE}_{name}"), Figure { title: format!("Deck at sea: {what}"), size: (1100, height), panels })
    };
    let elevations = vec![over("z [m]", &elevation), over("height over the deck [m]", &height)];
    let attitudes = vec![over("angle [°]", &ANGLES), over("against the deck [°]", &against_deck)];
    let rotors = [over("thrust of a rotor [N]", &ROTORS), over("thrust asked for [N]", &total)];
    let forces = rotors.into_iter().chain([Panel::over_time("force of a leg [N]", time.clone(), leg_forces)]);
    vec![
        figure("path", "path of the quadrotor", 800, path(flight)),
        figure("elevation", "elevation", 800, elevations),
        figure("attitude", "attitude", 800, attitudes),
        figure("forces", "forces of the rotors and of the platform's legs", 1000, forces.collect()),
    ]
}

/// `unguided_CASE`: a guided landing, and one that follows the platform's elevation itself.
pub(crate) fn write_unguided(folder: &Path, guided: &Flight, unguided: &Flight) -> Result<(), Failure> {
    let both = |value: fn(&Moment) -> f64| -> Vec<Line> {
        let line =
            |(name, flight): (&str, &Flight)| Line::new(name, flight.moments.iter().map(|m| (m.t, value(m))).collect());
        [("guided", guided), ("unguided", unguided)].map(line).into()
    };
    let platform = guided.moments.iter().map(|m| (m.t, m.platform)).collect();
    let elevations = [both(|m| m.state.q[2]), vec![Line::new("platform", platform)]].concat();
    let (whole, start) = (0.0..guided.touchdown.time, 0.0..1.3 * unguided.touchdown.time);
    let panels = vec![
        Panel::over_time("z [m]", whole, elevations),
        Panel::over_time("height over the platform [m]", start.clone(), both(|m| m.relative.offset[2])),
        Panel::over_time("velocity against it [m/s]", start.clone(), both(|m| m.relative.velocity[2])),
        Panel::over_time("thrust of all rotors [N]", start, both(|m| m.rotor_thrust.iter().sum())),
    ];
    let times = [unguided, guided].map(|flight| flight.touchdown.time);
    let title = format!("Case {}: down in {:.3} s unguided, in {:.3} s guided", guided.case, times[0], times[1]);
    let figure = Figure { title, size: (900, 1000), panels };
    let keys = [assumed::LANDING, &["landing.tolerance"]].concat();
    output::write_figure(folder, &format!("unguided_{}", guided.case), &figure, &keys)
}

/// One line for each leg, or for those that do the same.
fn leg_lines(values: impl Iterator<Item = (f64, LegVector)>) -> Vec<Line> {
    let values: Vec<(f64, LegVector)> = values.collect();
    numbered(["leg", "legs"], &[0, 1, 2, 3, 4, 5].map(|leg| values.iter().map(|(t, legs)| (*t, legs[leg])).collect()))
}

/// `NAME_platform`: the deck as it is to be and as it is, how far it is off, and what the legs are asked for.
pub(crate) fn write_platform<const K: usize>(folder: &Path, on_platform: &OnPlatform<K>) -> Result<(), Failure> {
    let case = table_name(on_platform.case);
    for (name, Comparison { scale, motion, driven, moments, .. }) in on_platform.comparisons() {
        let (end, middle) = (driven.touchdown.time, motion.mean()[2]);
        let of = |value: &dyn Fn(&DrivenMoment) -> f64| moments.iter().map(|m| (m.time, value(m))).collect();
        let plan = |m: &DrivenMoment| motion.at(m.time)[0];
        let elevations = vec![
            Line::new("to be", of(&|m| plan(m)[2] - middle)),
            Line::new("platform", of(&|m| m.platform.q[2] - middle)),
        ];
        let error = |m: &DrivenMoment| TrackingError::between(&m.platform.q, &plan(m));
        let mut errors = vec![Line::new("distance [mm]", of(&|m| 1e3 * error(m).distance))];
        if driven.greatest_error.angle > 1e-9 {
            errors.push(Line::new("angle [mrad]", of(&|m| 1e3 * error(m).angle)));
        }
        let legs = |of: fn(&LegState) -> LegVector| leg_lines(moments.iter().map(|m| (m.time, of(&m.legs))));
        let panels = vec![
            Panel::over_time("elevation [m]", 0.0..end, elevations),
            Panel::over_time("off by", 0.0..end, errors),
            Panel::over_time("length of a leg [m]", 0.0..end, legs(|legs| legs.length)),
            Panel::over_time("force asked for [N]", 0.0..end, legs(|legs| legs.force)),
        ];
        let how = if name == "full" { "motion in full, raised".to_string() } else { format!("motion × {scale:.3}") };
        let deck = if on_platform.case == MARINE { "deck at sea".to_string() } else { case.replace('_', " ") };
        let title = format!("The platform under control, {deck}, {how}");
        let name = format!("{case}_platform_{name}");
        output::write_figure(folder, &name, &Figure { title, size: (1100, 1100), panels }, &crate::assumed_keys())?;
        let pose = |of: &str| POSE.split(' ').map(|word| format!(" {of}_{word}")).collect::<String>();
        let words = format!("t_s z_m height_m{}{} {LEGS}", pose("platform"), pose("planned"));
        let row = |m: &DrivenMoment| {
            let height = m.deck.relative(&m.vehicle.q, &m.vehicle.qd).offset[2];
            let LegState { length, rate, force } = m.legs;
            [&[m.time, m.vehicle.q[2], height][..], &m.platform.q, &plan(m), &length, &rate, &force].concat()
        };
        output::write_table(folder, &name, &words, moments.iter().map(row))?;
    }
    Ok(())
}

/// Columns of a pose, and of what the legs do.
const POSE: &str = "x_m y_m z_m phi_rad theta_rad psi_rad";
const LEGS: &str = "leg[1-6]_length_m leg[1-6]_rate_m_s leg[1-6]_force_N";

/// `NAME_legs.csv`: what the legs do where the platform moves exactly as it is to.
pub(crate) fn write_legs(folder: &Path, case: &str, legs: &[(f64, LegState)]) -> Result<(), Failure> {
    let row = |(t, legs): &(f64, LegState)| [&[*t][..], &legs.length, &legs.rate, &legs.force].concat();
    output::write_table(folder, &format!("{}_legs", table_name(case)), &format!("t_s {LEGS}"), legs.iter().map(row))
}

fn table_name(case: &str) -> String {
    if case == MARINE { case.to_string() } else { format!("case_{case}") }
}

pub(crate) fn write_table(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let rates = "vx_m_s vy_m_s vz_m_s phi_dot theta_dot psi_dot";
    let words = format!("t_s {POSE} {rates} platform_m thrust_N rotor[1-4]_N");
    let row = |m: &Moment| [&[m.t][..], &m.state.q, &m.state.qd, &[m.platform, m.thrust], &m.rotor_thrust].concat();
    let name = format!("{}_{}", table_name(flight.case), flight.kind.name());
    output::write_table(folder, &name, &words, flight.moments.iter().map(row))
}
