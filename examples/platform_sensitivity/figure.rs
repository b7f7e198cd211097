//! Which share of the variance each parameter has, three ways.

use mbs_chart::{Figure, Line, Panel};

use crate::{QUANTITIES, Quantity};

/// Of each quantity the shares of all parameters, in the order of their total indices.
pub(crate) fn shares(results: &[Quantity]) -> Figure {
    let panel = |(name, quantity): (&&str, &Quantity)| {
        let order = quantity.order();
        let line = |label: &str, share: &dyn Fn(usize) -> f64| {
            Line::new(label, (1..).map(f64::from).zip(order.iter().map(|place| share(*place))).collect())
        };
        let lines = vec![
            line("by gradients", &|place| quantity.shares[place]),
            line("Sobol' index of first order", &|place| quantity.indices[place].first.value),
            line("total", &|place| quantity.indices[place].total.value),
        ];
        let label = format!("share of the variance of {name}");
        Panel::curves(["parameters, by their total indices", &label], 1.0..order.len() as f64, lines)
    };
    let panels = QUANTITIES.iter().zip(results).map(panel).collect();
    Figure { title: "Which numbers decide on the forces of the legs".into(), size: (1000, 800), panels }
}
