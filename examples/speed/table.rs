//! The times beside each other, and how much of each rival's time the generated code takes.

use serde_json::Value;

pub(crate) fn of(functions: &Value) -> String {
    let rivals = ["custom_newton_euler", "custom_vector_sines", "featherstone_nalgebra", "custom_lanes"];
    let mut text = format!("{:18} {:>7} {:>7}", "ns a state", "mbs", "batch");
    for rival in rivals {
        text += &format!(" {rival:>24}");
    }
    text += "\n";
    for (function, times) in functions.as_object().into_iter().flatten() {
        let [ns, ns_batch] = ["ns", "ns_batch"].map(|key| times[key].as_f64().unwrap_or(f64::NAN));
        text += &format!("{function:18} {ns:7.1} {ns_batch:7.1}");
        for name in rivals {
            let ours = if name == "custom_lanes" { ns_batch } else { ns };
            let cell = match times["rivals"][name].as_f64() {
                Some(rival) => format!("{rival:.1} (mbs {:.2})", ours / rival),
                None => String::new(),
            };
            text += &format!(" {cell:>24}");
        }
        text += "\n";
    }
    let sines = &functions["inverse_dynamics"]["rivals"];
    if let (Some(plain), Some(vector)) = (sines["custom_newton_euler"].as_f64(), sines["custom_vector_sines"].as_f64())
    {
        text += &format!("\ninverse dynamics, sines from one call relative to one by one: {:.2}\n", vector / plain);
    }
    text
}
