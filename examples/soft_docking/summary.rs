//! What is printed.

use mbs_orbit::soft_docking::bodies::Misalignment;
use mbs_orbit::soft_docking::ring::{Contact, Limit, Outcome, axial_oscillator};
use serde_json::{Value, json};

use crate::cases::{Burn, Case, Flight};

fn outcome(contact: &Contact) -> &'static str {
    match contact.outcome {
        Outcome::Captured => "captured",
        Outcome::Bounced => "bounced",
        Outcome::Missed => "missed",
        Outcome::Pressed => "pressed",
    }
}

fn refused(contact: &Contact) -> Option<&'static str> {
    contact.refused.map(|limit| match limit {
        Limit::TooSlow => "too slow",
        Limit::TooFast => "too fast",
        Limit::Sliding => "sliding",
        Limit::Turning => "turning",
        Limit::Lateral => "lateral",
        Limit::Tilt => "tilt",
        Limit::Roll => "roll",
    })
}

fn ports(ports: &Misalignment) -> Value {
    json!({
        "depth": ports.place[0],
        "lateral": ports.lateral(),
        "tilt": ports.tilt,
        "roll": ports.roll,
        "closing_speed": ports.closing(),
        "sliding_speed": ports.sliding(),
        "angular_velocity": ports.turning(),
    })
}

fn of_contact(contact: &Contact) -> Value {
    json!({
        "outcome": outcome(contact),
        "refused": refused(contact),
        "time": contact.time,
        "touch": ports(&contact.touch),
        "trip": contact.trip.as_ref().map(ports),
        "greatest_depth": contact.depth,
        "greatest_force": contact.force,
        "energy": contact.energy,
        "end": ports(&contact.ports),
    })
}

fn flight(flight: &Flight) -> Value {
    let report = &flight.report;
    json!({
        "contact": of_contact(&report.contact),
        "propellant": report.propellant,
        "pulses": report.pulses,
        "jet_impulse": report.impulse,
        "plume": {
            "greatest_force": report.plume_force,
            "greatest_torque": report.plume_torque,
            "impulse": report.plume_impulse,
        },
        "station_at_touch": {
            "position": report.station.position,
            "velocity": report.station.velocity,
            "attitude": report.station.attitude,
        },
    })
}

fn contact(case: &Case) -> Value {
    let mut value = of_contact(&case.contact);
    value["name"] = case.name.into();
    value
}

fn burn(burn: &Burn) -> Value {
    let raise = &burn.raise;
    json!({
        "thrust": burn.thrust,
        "delta_v": raise.delta_v,
        "durations": raise.durations,
        "gravity_loss": raise.gravity_loss,
        "periapsis_too_low": raise.too_low[0],
        "apoapsis_too_low": raise.too_low[1],
        "propellant": raise.propellant,
    })
}

pub(crate) fn to_json(flights: &[Flight; 2], contacts: &[Case], burns: &[Burn]) -> Value {
    let mut all = flight(&flights[0]);
    all["straight_jets"] = flight(&flights[1]);
    all["contacts"] = contacts.iter().map(contact).collect();
    all["finite_burns"] = burns.iter().map(burn).collect();
    let [frequency, damping] = axial_oscillator(&flights[0].docking.params);
    all["ring"] = json!({"axial_frequency": frequency, "axial_damping_ratio": damping});
    all
}

pub(crate) fn text(flights: &[Flight; 2], contacts: &[Case], burns: &[Burn]) -> String {
    let start = &flights[0].docking.start;
    let mut text = format!(
        "final approach along the V-bar from {} m, {:.2} m beside the axis, turned by {} °\n\n\
         jets           touch [s]  speed [m/s]  beside [mm]  tilt [°]  roll [°]  propellant [kg]  pulses  plume [N]  [N·m]  [N·s]  outcome\n",
        start.distance,
        start.aside[0].hypot(start.aside[1]),
        start.angles.map(|angle| format!("{:.0}", angle.to_degrees())).join(", ")
    );
    for (name, flight) in ["canted by 20°", "straight"].iter().zip(flights) {
        let (report, touch) = (&flight.report, &flight.report.contact.touch);
        text += &format!(
            "{name:<13} {:>10.2} {:>12.4} {:>12.2} {:>9.3} {:>9.3} {:>16.3} {:>7} {:>10.1} {:>6.0} {:>6.0}  {}\n",
            report.contact.time,
            touch.closing(),
            1e3 * touch.lateral(),
            touch.tilt.to_degrees(),
            touch.roll.to_degrees(),
            report.propellant,
            report.pulses,
            report.plume_force,
            report.plume_torque,
            report.plume_impulse,
            outcome(&report.contact)
        );
    }
    let station = &flights[0].report.station;
    text += &format!(
        "by the plumes the station has moved by {:.1} mm, at {:.2} mm/s\n\n\
         contact              speed [m/s]  beside [m]  tilt [°]  outcome    latches      depth [mm]  force [N]  energy lost [J]\n",
        1e3 * norm(&station.position),
        1e3 * norm(&station.velocity)
    );
    for Case { name, contact, .. } in contacts {
        let touch = &contact.touch;
        text += &format!(
            "{name:<20} {:>11.3} {:>11.3} {:>9.2}  {:<9}  {:<11} {:>11.2} {:>10.1} {:>16.4}\n",
            touch.closing(),
            touch.lateral(),
            touch.tilt.to_degrees(),
            outcome(contact),
            refused(contact).unwrap_or(if contact.trip.is_some() { "closed" } else { "not tripped" }),
            1e3 * contact.depth,
            contact.force,
            contact.energy[0] - contact.energy[1]
        );
    }
    text += &format!(
        "\nfrom the circle 320 km up to that 400 km up by burns of {:.3} and {:.3} m/s\n\
         thrust [N]   durations [s]      gravity loss [mm/s]   periapsis, apoapsis too low [m]   propellant [kg]\n",
        burns[0].raise.delta_v[0], burns[0].raise.delta_v[1]
    );
    for Burn { thrust, raise } in burns {
        text += &format!(
            "{thrust:>10} {:>9.2} {:>8.2} {:>21.4} {:>17.2} {:>13.2} {:>17.3}\n",
            raise.durations[0],
            raise.durations[1],
            1e3 * raise.gravity_loss,
            raise.too_low[0],
            raise.too_low[1],
            raise.propellant
        );
    }
    text
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
