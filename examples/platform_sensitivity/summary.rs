//! What decides on each quantity, as JSON and as text.

use mbs_ensemble::statistics::sensitivity::{Estimate, Indices};
use serde_json::{Value, json};

use crate::study::Study;
use crate::{QUANTITIES, Quantity};

/// All parameters of all quantities.
pub(crate) fn to_json(study: &Study, results: &[Quantity]) -> Value {
    QUANTITIES.iter().zip(results).map(|(name, quantity)| (name.to_string(), object(quantity, study))).collect()
}

fn object(quantity: &Quantity, study: &Study) -> Value {
    let entry = |place: usize| {
        let Indices { first, total } = quantity.indices[place];
        let value = json!({
            "by_gradient": quantity.shares[place],
            "first": first.value, "first_ci95": first.interval,
            "total": total.value, "total_ci95": total.interval,
        });
        (study.parameters[place].name().to_string(), value)
    };
    let parameters: Value = (0..quantity.shares.len()).map(entry).collect();
    json!({ "sd_by_gradient": quantity.deviations[0], "sd": quantity.deviations[1], "parameters": parameters })
}

/// The parameters that decide, in order.
pub(crate) fn text(study: &Study, results: &[Quantity]) -> String {
    const SHOWN: usize = 8;
    let mut text = String::new();
    for (name, quantity) in QUANTITIES.iter().zip(results) {
        let [by_gradient, by_members] = quantity.deviations;
        text += &format!(
            "{name} of the forces: deviation {by_gradient:.2} N by gradients, {by_members:.2} N by members\n  \
             parameter             gradient   first order                 total\n"
        );
        for place in quantity.order().into_iter().take(SHOWN) {
            let Indices { first, total } = quantity.indices[place];
            let bounded = |e: Estimate| format!("{:.3} ({:.3} to {:.3})", e.value, e.interval[0], e.interval[1]);
            let (share, first, total) = (quantity.shares[place], bounded(first), bounded(total));
            text += &format!("  {:<20}  {share:<9.3}  {first:<26}  {total}\n", study.parameters[place].name());
        }
    }
    text
}
