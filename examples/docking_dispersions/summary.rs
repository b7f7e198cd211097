//! How far flights miss, as JSON and as text.

use serde_json::{Value, json};

use crate::{Dispersions, QUANTITIES};

pub(crate) fn to_json(dispersions: &Dispersions) -> Value {
    let mut object = json!({ "members": dispersions.members, "within_95": dispersions.within });
    for (i, (name, _)) in QUANTITIES.iter().enumerate() {
        let (linear, flown) = (dispersions.linear[i], dispersions.flown[i]);
        object[name] = json!({ "sd_linear": linear, "sd": flown.deviation(), "mean": flown.mean });
    }
    object
}

pub(crate) fn text(dispersions: &Dispersions) -> String {
    let members = dispersions.members;
    let mut text = format!("{members} flights\n            deviation: linear   flown       ratio   mean\n");
    for (i, (name, unit)) in QUANTITIES.iter().enumerate() {
        let (linear, flown) = (dispersions.linear[i], dispersions.flown[i]);
        let (deviation, ratio) = (flown.deviation(), flown.deviation() / linear);
        text += &format!("{name:<9} {unit:<4}  {linear:>14.5}  {deviation:>10.5}  {ratio:>8.4}  {:>8.4}\n", flown.mean);
    }
    text + &format!("{:.2} % of the flights arrive within the ellipsoid of 95 %\n", 100.0 * dispersions.within)
}
