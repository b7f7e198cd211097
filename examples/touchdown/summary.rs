//! What became of them, as text and as JSON.

use mbs_landing::quadrotor::standing::{Ending, Settled};
use serde_json::{Value, json};

use crate::Touchdowns;
use crate::run::{OnDeck, OnPlatform};

/// The ending's name, and when it began where it has a time \[s\].
fn named(ending: Ending) -> (&'static str, Option<f64>) {
    match ending {
        Ending::Rest { since } => ("rest", Some(since)),
        Ending::TippedOver { time } => ("tipped over", Some(time)),
        Ending::Sliding => ("sliding", None),
        Ending::Airborne => ("airborne", None),
        Ending::Moving => ("moving", None),
    }
}

fn settled(settled: &Settled) -> Value {
    let (ending, time) = named(settled.ending);
    json!({
        "ending": ending,
        "ending_time": time,
        "first_touch": settled.first_touch,
        "rebounds": settled.rebounds,
        "slid": settled.slid,
        "displaced": settled.displaced,
        "leg_force_max": settled.greatest_leg_force,
        "force_max": settled.greatest_force,
        "depth_max": settled.greatest_depth,
        "tilt_max_deg": settled.greatest_tilt.to_degrees(),
        "dissipated": settled.last.dissipated,
        "energy_error": settled.energy_error,
    })
}

fn on_deck(on_deck: &OnDeck) -> (String, Value) {
    let mut results = settled(&on_deck.settled);
    results["touchdown_velocity"] = on_deck.landing.map(|end| end.relative_velocity).into();
    (on_deck.name.to_string(), results)
}

fn on_platform(on_platform: &OnPlatform) -> (String, Value) {
    let mut results = settled(&on_platform.stand.settled);
    results["touchdown_velocity"] = on_platform.stand.landing.relative_velocity.into();
    results["scale"] = on_platform.scale.into();
    results["platform_leg_force_max_before"] = on_platform.stand.greatest[0].into();
    results["platform_leg_force_max_after"] = on_platform.stand.greatest[1].into();
    results["added_lift"] = on_platform.stand.added_lift.into();
    results["push"] = on_platform.stand.push.into();
    results["weight"] = on_platform.stand.weight.into();
    results["sag"] = on_platform.stand.sag.into();
    (on_platform.name.to_string(), results)
}

pub(crate) fn to_json(touchdowns: &Touchdowns) -> Value {
    let Touchdowns { by_hand, planned, carried } = touchdowns;
    json!({
        "by_hand": by_hand.iter().map(on_deck).collect::<Value>(),
        "planned": planned.iter().map(on_deck).collect::<Value>(),
        "carried": carried.iter().map(on_platform).collect::<Value>(),
    })
}

fn line(name: &str, settled: &Settled) -> String {
    let ending = match named(settled.ending) {
        (ending, Some(time)) => format!("{ending} {:.2} s later", time - settled.first_touch.unwrap_or(time)),
        (ending, None) => format!("still {ending}"),
    };
    let touch = settled.first_touch.map_or_else(|| "never".to_string(), |time| format!("{time:.3} s"));
    format!(
        "  {name:<9} touched {touch:>9}, {ending:<24} {:>2} rebounds, slid {:.3} m, {:>6.0} N in all, {:>5.0} N a leg, tilt {:>5.2}°\n",
        settled.rebounds,
        settled.slid,
        settled.greatest_force,
        settled.greatest_leg_force,
        settled.greatest_tilt.to_degrees(),
    )
}

pub(crate) fn text(touchdowns: &Touchdowns) -> String {
    let mut text = String::from("By hand, rotors stand\n");
    text += &touchdowns.by_hand.iter().map(|one| line(one.name, &one.settled)).collect::<String>();
    text += "\nGuided landings on decks that nothing disturbs, rotors run down from the first touch\n";
    text += &touchdowns.planned.iter().map(|one| line(one.name, &one.settled)).collect::<String>();
    text += "\nGuided landings on the Stewart platform under its control, which does not know of the vehicle\n";
    for one in &touchdowns.carried {
        text += &line(one.name, &one.stand.settled);
        text += &format!(
            "            motion × {:.3}; a leg of the platform bears up to {:.0} N before and {:.0} N after; at the end they lift {:.1} N more, the vehicle presses with {:.1} N, its weight is {:.1} N; {:.1} mm below the plan\n",
            one.scale,
            one.stand.greatest[0],
            one.stand.greatest[1],
            one.stand.added_lift,
            one.stand.push,
            one.stand.weight,
            1e3 * one.stand.sag
        );
    }
    let worst = touchdowns.by_hand.iter().chain(&touchdowns.planned).map(|one| one.settled.energy_error);
    let worst = worst.chain(touchdowns.carried.iter().map(|one| one.stand.settled.energy_error)).fold(0.0, f64::max);
    text + &format!("\nThe balance of energy holds to {worst:.1e} of what was turned over.\n")
}
