//! A motion with its constraints, looked at where its closed form is asked, too.

use std::ops::ControlFlow;

use mbs_examples::Failure;
use mbs_runtime::{Constraints, Dop853, Integrator, Mechanism, Onto, Projected, Projector, State, accelerations};
use serde_json::{Value, json};

/// Memory for five coordinates and two rows, the most of the three mechanisms.
const MEMORY: usize = Projector::<f64, [f64; 0]>::size(5, 2);

/// DOP853 with its steps on the constraints.
pub(crate) fn projected<C>(constraints: &C) -> Projected<Dop853, Onto<'_, C, f64, [f64; MEMORY]>> {
    Projected { method: Dop853::new(1e-13, 1e-14), drift: Projector::new([0.0; MEMORY]).onto(constraints) }
}

/// Integrated, and by its closed form.
pub(crate) struct Flown<const N: usize> {
    /// Times \[s\] and states.
    pub(crate) samples: Vec<(f64, State<[f64; N]>)>,
    /// By the closed form, at the same times.
    pub(crate) exact: Vec<State<[f64; N]>>,
    /// Greatest `|A q̇ + b|` \[m/s\].
    pub(crate) slip: f64,
    /// Greatest change of `T + V`, relative to the greatest `T`.
    pub(crate) energy: f64,
}

impl<const N: usize> Flown<N> {
    /// From the first state of the closed form, in `steps` equal parts of `duration`.
    pub(crate) fn of<const U: usize>(
        mechanism: &(impl Mechanism<N, U, Scalar = f64, Time = f64> + Constraints<f64>),
        duration: f64,
        steps: u32,
        exact: impl Fn(f64) -> State<[f64; N]>,
    ) -> Result<Self, Failure> {
        let times: Vec<f64> = (0..=steps).map(|k| duration * f64::from(k) / f64::from(steps)).collect();
        let exact: Vec<State<[f64; N]>> = times.iter().map(|&t| exact(t)).collect();
        let mut state = exact[0];
        let mut samples = vec![(0.0, state)];
        let kinetic = |s: &State<[f64; N]>| mechanism.kinetic_energy(0.0, &s.q, &s.qd);
        let energy = |s: &State<[f64; N]>| kinetic(s) + mechanism.potential_energy(0.0, &s.q);
        let (first, mut drift, mut most, mut slip) = (energy(&state), 0.0_f64, kinetic(&state), 0.0_f64);
        for pair in times.windows(2) {
            // Ended where it is looked at: the dense output is of a lower order than the method.
            let motion = accelerations(mechanism, |_, _, _| [0.0; U]);
            projected(mechanism).integrate(motion, pair[0], pair[1], &mut state, |_| ControlFlow::Continue(()))?;
            let mut rates = [0.0; 2];
            mechanism.rate(pair[1], &state.q, &state.qd, &mut rates[..mechanism.rows()]);
            slip = rates.iter().fold(slip, |most, rate| most.max(rate.abs()));
            drift = drift.max((energy(&state) - first).abs());
            most = most.max(kinetic(&state));
            samples.push((pair[1], state));
        }
        Ok(Self { samples, exact, slip, energy: drift / most })
    }

    /// Greatest difference of these coordinates from the closed form.
    pub(crate) fn error(&self, coordinates: &[usize]) -> f64 {
        self.differences(coordinates).into_iter().fold(0.0, |most, (_, difference)| most.max(difference))
    }

    /// Length of the difference of these coordinates from the closed form, over time.
    pub(crate) fn differences(&self, coordinates: &[usize]) -> Vec<(f64, f64)> {
        let length = |a: &State<[f64; N]>, b: &State<[f64; N]>| {
            coordinates.iter().map(|&i| (a.q[i] - b.q[i]).powi(2)).sum::<f64>().sqrt()
        };
        self.samples.iter().zip(&self.exact).map(|((t, state), exact)| (*t, length(state, exact))).collect()
    }

    /// What all three tell alike.
    pub(crate) fn to_json(&self, angles: &[usize]) -> Value {
        json!({
            "duration": self.samples.last().map(|(t, _)| t),
            "path_error": self.error(&[0, 1]),
            "angle_error": self.error(angles),
            "slip": self.slip,
            "energy_drift": self.energy,
        })
    }

    /// What all three tell alike, as a line.
    pub(crate) fn text(&self, angles: &[usize]) -> String {
        format!(
            "  from the closed form: path {:.1e} m, angles {:.1e} rad; slip {:.1e} m/s, drift of the energy {:.1e}\n",
            self.error(&[0, 1]),
            self.error(angles),
            self.slip,
            self.energy
        )
    }
}
