//! Figures of feet on the deck and of legs under it.

use std::path::Path;

use mbs_chart::curves::numbered;
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};
use mbs_landing::quadrotor::standing::Moment;
use mbs_landing::quadrotor::standing::{Legs, Stand};

use crate::run::{BEFORE, OnDeck, OnPlatform};

/// What is shown after the first touch \[s\].
const AFTER: f64 = 1.5;

/// What a run shows.
fn words(name: &str) -> String {
    match name {
        "I" | "II" => format!("case {name}"),
        "marine" => "deck at sea".to_string(),
        other => other.replace('_', " "),
    }
}

/// `touchdown_NAME`: heights of the feet, forces, way along the deck.
pub(crate) fn write(folder: &Path, on_deck: &OnDeck) -> Result<(), Failure> {
    let OnDeck { name, moments, .. } = on_deck;
    let (Some(first), Some(last)) = (moments.first(), moments.last()) else { return Ok(()) };
    let range = first.time..last.time;
    let feet = |of: &dyn Fn(&Moment, usize) -> f64| -> Vec<Line> {
        let foot = |i: usize| moments.iter().map(|m| (m.time, of(m, i))).collect();
        numbered(["foot", "feet"], &[0, 1, 2, 3].map(foot))
    };
    let panels = vec![
        Panel::over_time("foot over the deck [mm]", range.clone(), feet(&|m, i| -1e3 * m.contact.depth[i])),
        Panel::over_time("force along the normal [N]", range.clone(), feet(&|m, i| m.contact.normal[i])),
        Panel::over_time("way along the deck [mm]", range, feet(&|m, i| 1e3 * m.slid[i])),
    ];
    let (name, title) = (format!("touchdown_{name}"), format!("After the touchdown: {}", words(name)));
    output::write_figure(folder, &name, &Figure { title, size: (900, 900), panels }, &crate::assumed_keys())?;
    let row = |m: &Moment| [&[m.time, m.vehicle.q[2]][..], &m.contact.normal].concat();
    output::write_table(folder, &name, "t_s z_m leg[1-4]_N", moments.iter().map(row))
}

/// `touchdown_NAME_platform`: what the feet do to the deck, and the platform's legs before, at and after the impact.
pub(crate) fn write_platform(folder: &Path, on_platform: &OnPlatform) -> Result<(), Failure> {
    let OnPlatform { name, stand: Stand { legs, landing, .. }, .. } = on_platform;
    let range = landing.time - BEFORE..landing.time + AFTER;
    let shown: Vec<&Legs> = legs.iter().filter(|legs| range.contains(&legs.time)).collect();
    let of = |value: &dyn Fn(&Legs) -> f64| -> Vec<_> { shown.iter().map(|legs| (legs.time, value(legs))).collect() };
    let line = |value: &dyn Fn(&Legs) -> f64| vec![Line::new("", of(value))];
    let forces = numbered(["leg", "legs"], &[0, 1, 2, 3, 4, 5].map(|i| of(&move |legs| legs.forces[i])));
    let panels = vec![
        Panel::over_time("four feet on the deck [N]", range.clone(), line(&|legs| legs.contact)),
        Panel::over_time("force of a leg of the platform [N]", range.clone(), forces),
        Panel::over_time("platform over its plan [mm]", range, line(&|legs| 1e3 * legs.off)),
    ];
    let title = format!("The platform feels the touchdown: {}", words(name));
    let name = format!("touchdown_{name}_platform");
    output::write_figure(folder, &name, &Figure { title, size: (900, 900), panels }, &crate::assumed_keys())?;
    let row = |legs: &Legs| [&[legs.time, legs.contact, legs.off][..], &legs.forces].concat();
    output::write_table(folder, &name, "t_s contact_N off_m leg[1-6]_N", legs.iter().map(row))
}
