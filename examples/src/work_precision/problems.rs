//! Problems whose solutions are known, of two coordinates.

use std::ops::ControlFlow;

use mbs_models::double_pendulum::DoublePendulum;
use mbs_runtime::{Dop853, IntegrationError, Integrator, State};

/// The accelerations of `(q, q̇)`.
pub(crate) trait Force: Fn(&[f64; 2], &[f64; 2]) -> [f64; 2] + Copy + Send + Sync {}

impl<F: Fn(&[f64; 2], &[f64; 2]) -> [f64; 2] + Copy + Send + Sync> Force for F {}

/// A motion from the time 0 to `end`.
pub(crate) struct Problem<F> {
    pub(crate) name: &'static str,
    pub(crate) q: [f64; 2],
    pub(crate) qd: [f64; 2],
    pub(crate) end: f64,
    pub(crate) force: F,
    /// Whether the accelerations depend on `q` alone.
    pub(crate) separable: bool,
    /// `(q, q̇)` at the end.
    solution: [f64; 4],
}

impl<F> Problem<F> {
    /// `(q, q̇)` at the beginning.
    pub(crate) fn start(&self) -> [f64; 4] {
        [self.q[0], self.q[1], self.qd[0], self.qd[1]]
    }

    /// The Euclidean distance of `(q, q̇)` from the solution at the end.
    pub(crate) fn error(&self, end: [f64; 4]) -> f64 {
        end.iter().zip(self.solution).map(|(found, solution)| (found - solution).powi(2)).sum::<f64>().sqrt()
    }
}

impl<F: Force> Problem<F> {
    /// As many right-hand sides, which wait for each other as those of a step's stages do: coordinates depend on the
    /// velocities of the one before, velocities on its accelerations. What they amount to keeps them from being left
    /// out.
    pub(crate) fn right_hand_sides(&self, count: usize) -> [f64; 2] {
        const STEP: f64 = 1e-3;
        let moved = |from: [f64; 2], by: [f64; 2]| [from[0] + STEP * by[0], from[1] + STEP * by[1]];
        let (mut q, mut qd) = (self.q, self.qd);
        for _ in 0..count {
            let qdd = (self.force)(&q, &qd);
            (q, qd) = (moved(self.q, qd), moved(self.qd, qdd));
        }
        moved(q, qd)
    }
}

/// Ten periods of a Kepler orbit of eccentricity 0.6, from periapsis.
pub(crate) fn kepler() -> Problem<impl Force> {
    let force = |q: &[f64; 2], _: &[f64; 2]| {
        let squared = q[0] * q[0] + q[1] * q[1];
        let cubed = squared * squared.sqrt();
        [-q[0] / cubed, -q[1] / cubed]
    };
    let end = 10.0 * std::f64::consts::TAU;
    Problem {
        name: "kepler",
        q: [0.4, 0.0],
        qd: [0.0, 2.0],
        end,
        force,
        separable: true,
        solution: [0.4, 0.0, 0.0, 2.0],
    }
}

/// One period of a satellite around the Earth and the Moon, in axes that turn with them.
///
/// R. F. Arenstorf, *Periodic solutions of the restricted three body problem representing analytic continuations of
/// Keplerian elliptic motions*, 1963; numbers of E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential
/// Equations I*, 2nd ed. 1993, formulas II.0.1 and II.0.2.
pub(crate) fn arenstorf() -> Problem<impl Force> {
    const MOON: f64 = 0.012277471;
    const EARTH: f64 = 1.0 - MOON;
    let force = |q: &[f64; 2], qd: &[f64; 2]| {
        let [to_earth, to_moon] = [q[0] + MOON, q[0] - EARTH];
        // Called twice, and not mapped over an array: without LTO that would be a call of the library for each.
        let cubed_distance = |x: f64| {
            let squared = x * x + q[1] * q[1];
            squared * squared.sqrt()
        };
        let (d1, d2) = (cubed_distance(to_earth), cubed_distance(to_moon));
        [
            q[0] + 2.0 * qd[1] - EARTH * to_earth / d1 - MOON * to_moon / d2,
            q[1] - 2.0 * qd[0] - EARTH * q[1] / d1 - MOON * q[1] / d2,
        ]
    };
    let speed = -2.001_585_106_379_082_5;
    let solution = [0.994, 0.0, 0.0, speed];
    let end = 17.065_216_560_157_963;
    Problem { name: "arenstorf", q: [0.994, 0.0], qd: [0.0, speed], end, force, separable: false, solution }
}

/// Four seconds of the generated double pendulum, released at rest. The solution is the one by steps of 2 ms, much
/// shorter than any tolerance asks for: rounding remains.
///
/// # Errors
/// [`IntegrationError`] if that integration fails.
pub(crate) fn double_pendulum() -> Result<Problem<impl Force>, IntegrationError> {
    let pendulum = DoublePendulum::<f64>::default();
    let force = move |q: &[f64; 2], qd: &[f64; 2]| pendulum.forward_dynamics(q, qd);
    let (q, qd, end) = ([1.0, 1.5], [0.0, 0.0], 4.0);
    let mut state = State::new(q, qd);
    let exact = Dop853::new(1e-14, 1e-14).with_max_step(2e-3);
    exact.integrate(
        |_, q: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]| *qdd = force(q, qd),
        0.0,
        end,
        &mut state,
        |_| ControlFlow::Continue(()),
    )?;
    let solution = [state.q[0], state.q[1], state.qd[0], state.qd[1]];
    Ok(Problem { name: "double_pendulum", q, qd, end, force, separable: false, solution })
}
