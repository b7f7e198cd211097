//! Integration up to the end or to a collision, whichever comes first.

use core::ops::ControlFlow;

use mbs_models::check::{self, Invalid};
use mbs_runtime::{Dop853, Event, IntegrationError, Integrator, State, Step, Summary};

/// Why a flight ended before its time.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FlightError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Two bodies met.
    #[error("collision at {time} s, at a distance of {distance} m")]
    Collision {
        /// When \[s\].
        time: f64,
        /// Their distance then \[m\].
        distance: f64,
    },
    /// They touch at the beginning already.
    #[error("the bodies are {distance} m apart at the beginning, and touch at {contact} m")]
    StartsInside {
        /// Their distance \[m\].
        distance: f64,
        /// The distance at which they touch \[m\].
        contact: f64,
    },
    /// The integrator gave up for another reason.
    #[error(transparent)]
    Integration(IntegrationError),
}

/// Of the first distance: points whose motion cannot be continued closer than that have met.
const MET: f64 = 1e-3;

/// Integrates `q̈ = f(t, q, q̇)` from `t` to `t_end`, and ends where the distance of two bodies falls to that at which
/// they touch.
///
/// | argument   | meaning                                                        | unit |
/// |------------|----------------------------------------------------------------|------|
/// | `distance` | of the two bodies at a time and state                            | m    |
/// | `contact`  | where they touch; 0 for points, which collide where they meet     | m    |
/// | `state`    | afterwards the one at the end or at the collision               |      |
/// | `observer` | called after each accepted step                                 |      |
///
/// Points that fall into each other leave the integrator no step. They have collided where that happens at less than a
/// thousandth of their first distance, and the time is that of the last state. What is nearer for less than a step of
/// the integrator, twice across the distance of contact between two places where it looks, is not seen.
///
/// # Errors
/// [`FlightError`].
pub fn fly<const N: usize>(
    integrator: &Dop853,
    mut acceleration: impl FnMut(f64, &[f64; N], &[f64; N], &mut [f64; N]),
    [t, t_end]: [f64; 2],
    state: &mut State<[f64; N]>,
    distance: impl Fn(f64, &State<[f64; N]>) -> f64,
    contact: f64,
    mut observer: impl FnMut(&mut dyn Step<[f64; N]>),
) -> Result<Summary, FlightError> {
    check::not_negative("contact", contact)?;
    let first = distance(t, state);
    if first.is_nan() {
        return Err(FlightError::Integration(IntegrationError::NonFiniteState { time: t }));
    }
    if first <= contact {
        return Err(FlightError::StartsInside { distance: first, contact });
    }
    let gap = |t: f64, state: &State<[f64; N]>| distance(t, state) - contact;
    let mut events = [Event::new(&gap).falling().terminal()];
    let flown = integrator.integrate_with_events(&mut acceleration, t, t_end, state, &mut events, |step| {
        observer(step);
        ControlFlow::Continue(())
    });
    match flown {
        Ok(summary) if summary.stopped => {
            Err(FlightError::Collision { time: summary.time, distance: distance(summary.time, state) })
        }
        Ok(summary) => Ok(summary),
        Err(error) => Err(match error {
            IntegrationError::StepTooSmall { time, .. } | IntegrationError::NonFiniteState { time }
                if contact == 0.0 && distance(time, state) <= MET * first =>
            {
                FlightError::Collision { time, distance: distance(time, state) }
            }
            error => FlightError::Integration(error),
        }),
    }
}
