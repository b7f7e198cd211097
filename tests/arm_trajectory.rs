//! Trajectories of the IRB 7600: the thesis' Table 2 against its reference values, extrema and continuity, limits,
//! work, the fastest motion along a path, and what is refused.

#[path = "arm_trajectory/cartesian.rs"]
mod cartesian;
#[path = "arm_trajectory/polynomials.rs"]
mod polynomials;
#[path = "arm_trajectory/refused.rs"]
mod refused;
#[path = "arm_trajectory/table2.rs"]
mod table2;
#[path = "arm_trajectory/time_optimal.rs"]
mod time_optimal;

/// Table 2 of the thesis \[rad\].
fn table2_ends() -> [[f64; 6]; 2] {
    [[20.0, 10.0, 10.0, 10.0, 20.0, 10.0], [50.0, 90.0, 120.0, 80.0, 60.0, 100.0]]
        .map(|q: [f64; 6]| q.map(f64::to_radians))
}

/// \[s\]
const DURATION: f64 = 50.0;
