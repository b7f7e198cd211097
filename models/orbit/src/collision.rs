//! Integration up to the end or to a collision, whichever comes first.

use core::ops::ControlFlow;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::{Dop853, Event, IntegrationError, Integrator, State, Step, Summary};

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
/// [`Error`].
pub fn fly<const N: usize>(
    integrator: &Dop853,
    mut acceleration: impl FnMut(f64, &[f64; N], &[f64; N], &mut [f64; N]),
    [t, t_end]: [f64; 2],
    state: &mut State<[f64; N]>,
    distance: impl Fn(f64, &State<[f64; N]>) -> f64,
    contact: f64,
    mut observer: impl FnMut(&mut dyn Step<[f64; N]>),
) -> Result<Summary, Error> {
    check::not_negative("contact", contact)?;
    let first = distance(t, state);
    if first.is_nan() {
        return Err(IntegrationError::NonFiniteState { time: t }.into());
    }
    Must::BeMoreThan(contact).check("distance at the beginning", first)?;
    let gap = |t: f64, state: &State<[f64; N]>| distance(t, state) - contact;
    let mut events = [Event::new(&gap).falling().terminal()];
    let flown = integrator.integrate_with_events(&mut acceleration, t, t_end, state, &mut events, |step| {
        observer(step);
        ControlFlow::Continue(())
    });
    match flown {
        Ok(summary) if summary.stopped => {
            Err(Failure::Collision { distance: distance(summary.time, state) }.at_time(summary.time))
        }
        Ok(summary) => Ok(summary),
        Err(error) => Err(match error {
            IntegrationError::StepTooSmall { time, .. } | IntegrationError::NonFiniteState { time }
                if contact == 0.0 && distance(time, state) <= MET * first =>
            {
                Failure::Collision { distance: distance(time, state) }.at_time(time)
            }
            error => error.into(),
        }),
    }
}
