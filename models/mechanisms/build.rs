//! Every `.mbs` file of this folder becomes a module of this crate. Those of `sensors/` are declared for their outputs
//! alone, and nothing else of them is generated.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
    let step = |output: &str| all_of(output, &["", "_jacobian", "_jacobian_qd", "_jacobian_u"]);
    let turn = all_of("next_attitude", &["", "_jacobian", "_jacobian_u"]);
    outputs("sensors/strapdown.mbs", [step("next_place"), step("next_velocity"), turn].concat());
    let measured = ["pixel", "range"].map(|output| all_of(output, &["", "_jacobian"])).concat();
    outputs("sensors/sensor_head.mbs", [measured, all_of("depth", &[""]), all_of("incidence", &[""])].concat());
}

fn outputs(file: &str, functions: Vec<String>) {
    mbs_derive::Config::new().functions(functions).compile(file);
}

fn all_of(output: &str, functions: &[&str]) -> Vec<String> {
    functions.iter().map(|function| format!("{output}{function}")).collect()
}
