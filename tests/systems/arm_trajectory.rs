//! Trajectories of the IRB 7600: the thesis' Table 2 against its reference values, extrema and continuity, limits,
//! work, the fastest motion along a path, and what is refused.

mod cartesian;
mod minimum_effort;
mod polynomials;
mod refused;
mod table2;
mod time_optimal;

/// Table 2 of the thesis \[rad\].
pub(crate) fn table2_ends() -> [[f64; 6]; 2] {
    [[20.0, 10.0, 10.0, 10.0, 20.0, 10.0], [50.0, 90.0, 120.0, 80.0, 60.0, 100.0]]
        .map(|q: [f64; 6]| q.map(f64::to_radians))
}

/// How long it takes \[s\].
pub(crate) const DURATION: f64 = 50.0;
