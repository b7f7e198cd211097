//! What the hinges and the middle of the coupler go through in a turn of the crank, and the bars at rest.

use std::f64::consts::TAU;

use mbs_chart::{Figure, Panel, PlaneLine};
use mbs_examples::Failure;
use mbs_models::four_bar::FourBar;
use mbs_runtime::State;

use crate::{CRANK, close};

pub(crate) fn turn(bars: &FourBar<f64>, rest: &State<[f64; 3]>) -> Result<Figure, Failure> {
    const STEPS: usize = 240;
    let mut state = *rest;
    let mut turn = vec![state.q];
    for step in 1..=STEPS {
        // From the place before, on the same branch.
        state.q[CRANK] = rest.q[CRANK] + TAU * step as f64 / STEPS as f64;
        close(bars, &mut state)?;
        turn.push(state.q);
    }
    let params = bars.params();
    let along = |angle: f64, length: f64| [length * angle.cos(), length * angle.sin()];
    let knee = |q: &[f64; 3]| along(q[0], params.l[0]);
    let tip = |q: &[f64; 3]| {
        let [x, z] = along(q[2], params.l[2]);
        [params.ground + x, z]
    };
    let middle = |q: &[f64; 3]| {
        let [x, _, z] = bars.coupler_point(q);
        [x, z]
    };
    let path =
        |name: &str, point: &dyn Fn(&[f64; 3]) -> [f64; 2]| PlaneLine::new(name, turn.iter().map(point).collect());
    let lines = vec![
        path("middle of the coupler", &middle),
        path("crank and coupler", &knee),
        path("coupler and rocker", &tip),
        PlaneLine::new("bars at rest", vec![[0.0; 2], knee(&rest.q), tip(&rest.q), [params.ground, 0.0]]),
    ];
    let panels = vec![Panel::plane(["x [m]", "z [m]"], lines, Vec::new())];
    Ok(Figure { title: "A turn of the crank".to_string(), size: (900, 700), panels })
}
