//! `mbs ops --explain`: which route each function took, and what it would cost by the others.

use mbs_derive::Analysis;
use mbs_derive::derive::Route;
use mbs_derive::optimise::Operations;
use serde_json::{Map, Value, json};

use super::{counts, in_columns};

/// A function, the route that it took, and its costs by all.
type Explained = (String, Route, Vec<(Route, Operations)>);

/// The routes of a mechanism's functions.
pub(crate) struct Explanation {
    functions: Vec<Explained>,
    bodies: usize,
    /// Terms of T that are no bodies.
    others: usize,
}

impl Explanation {
    /// Derives by all routes.
    pub(crate) fn of(analysis: &Analysis<'_>) -> Self {
        let costs = analysis.compared();
        let functions =
            analysis.programs().functions.iter().zip(costs).map(|(f, costs)| (f.name.clone(), f.route, costs));
        let (bodies, others) = analysis.lagrangian().bodies();
        Explanation { functions: functions.collect(), bodies: bodies.len(), others: others.len() }
    }

    /// Per function the route and the costs by all.
    pub(crate) fn object(&self) -> Value {
        let function = |(name, route, costs): &Explained| {
            let by_route: Map<String, Value> =
                costs.iter().map(|(route, operations)| (route.to_string(), counts(*operations))).collect();
            (name.clone(), json!({ "route": route.to_string(), "by_route": by_route }))
        };
        Value::Object(self.functions.iter().map(function).collect())
    }

    /// As a table of additions and multiplications, and what it says.
    pub(crate) fn table(&self) -> String {
        let is_taken = |route: &Route| self.functions.iter().any(|f| f.2.iter().any(|(known, _)| known == route));
        let routes: Vec<Route> = Route::ALL.into_iter().filter(is_taken).collect();
        let is_shown = |route: &Route| !matches!(route, Route::Ungrouped | Route::MultipliedOut);
        let shown: Vec<Route> = routes.iter().copied().filter(is_shown).collect();
        let mut header = vec!["function".to_string(), "route".to_string()];
        header.extend(shown.iter().map(Route::to_string));
        if routes.contains(&Route::Ungrouped) {
            header.push("saved by regrouping".to_string());
        }
        let keeps = self.functions.iter().any(|function| kept(function) > 0);
        if keeps {
            header.push("spent on digits".to_string());
        }
        let rows = self.functions.iter().map(|function| {
            let (name, route, costs) = function;
            let flops = |wanted: Route| costs.iter().find(|(r, _)| *r == wanted).map(|(_, cost)| cost.flops());
            let mut row = vec![name.clone(), route.to_string()];
            row.extend(shown.iter().map(|route| flops(*route).map_or(String::new(), |flops| flops.to_string())));
            if routes.contains(&Route::Ungrouped) {
                let both = flops(Route::Structured).zip(flops(Route::Ungrouped));
                row.push(both.map_or(String::new(), |(with, without)| (without as i64 - with as i64).to_string()));
            }
            if keeps {
                row.push(kept(function).to_string());
            }
            row
        });
        let rows: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
        let words = if keeps { self.words() + KEPT } else { self.words() };
        format!("{}\n{words}", in_columns(&rows, 2))
    }

    fn words(&self) -> String {
        let bodies = crate::words::plural(self.bodies, "body", "bodies");
        let tree = match (self.bodies, self.others) {
            (0, _) => "T has no bodies that the generator can see: everything is derived plainly.".to_string(),
            (_, 0) => format!("T is {bodies}."),
            (_, others) => {
                let terms = crate::words::plural(others, "term that is no body", "terms that are no bodies");
                format!("T is {bodies} and {terms}: these are derived plainly and added.")
            }
        };
        let advice = "What moves with a pose is seen where it is declared by `particle(m, pose.point(c))`, \
                      `rigid_body(m, c, i, pose)`,\nor by `dt(pose.point(c)).norm_squared()` and \
                      `w.dot((pose*i)*w)` with `w = angular_velocity(pose)`.\n";
        if self.others == 0 && self.bodies > 0 { tree + "\n" } else { tree + "\n" + advice }
    }
}

/// Additions and multiplications that it takes not to multiply out the differences that energies and forces were
/// written with.
fn kept((_, route, costs): &Explained) -> usize {
    let flops = |wanted: Route| costs.iter().find(|(r, _)| *r == wanted).map(|(_, cost)| cost.flops());
    match (flops(*route), flops(Route::MultipliedOut)) {
        (Some(taken), Some(multiplied_out)) => taken.saturating_sub(multiplied_out),
        _ => 0,
    }
}

/// Below the table, where there is a difference.
const KEPT: &str = "Spent on digits: differences that energies and forces are written with stay factors, `k*(r - rest)`; \
                    multiplied out,\n`k*r - k*rest`, they would be cheaper, and wrong where r is near rest.\n";
