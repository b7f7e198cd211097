//! The choice of an integrator.

use std::ops::ControlFlow;

use mbs_runtime::{
    Dop853, Dopri5, Event, GaussLegendre4, IntegrationError, Integrator, Rk4, SemiImplicitEuler, State, Step,
    StormerVerlet, Summary,
};

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Dormand and Prince's method of order 8 with error control; rows between its steps are interpolated.
    Dop853,
    /// Dormand and Prince's method of order 5 with error control, for loose tolerances and forces with kinks.
    Dopri5,
    /// The classical method of order 4, with the fixed step --dt.
    Rk4,
    /// Gauss and Legendre's method of order 4, implicit and symplectic, with the fixed step --dt.
    #[value(name = "gauss-legendre4")]
    GaussLegendre4,
    /// Order 2, symplectic where accelerations do not depend on velocities, with the fixed step --dt.
    StormerVerlet,
    /// Order 1, symplectic where accelerations do not depend on velocities, with the fixed step --dt.
    SemiImplicitEuler,
}

/// What methods are told: tolerances and the longest step those with error control, the step those without.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    pub(crate) relative: f64,
    pub(crate) absolute: f64,
    pub(crate) step: f64,
    /// The longest step of those with error control \[s\], which may step over what comes and goes in less time.
    pub(crate) longest: f64,
    /// After how many steps those with error control give up.
    pub(crate) most_steps: usize,
}

/// As the runtime's own.
pub(crate) const MOST_STEPS: usize = 1_000_000;

impl Method {
    /// Whether it chooses its steps by an estimate of their errors.
    pub(crate) fn has_error_control(self) -> bool {
        matches!(self, Method::Dop853 | Method::Dopri5)
    }

    /// Whether it takes accelerations for functions of the coordinates alone.
    pub(crate) fn is_for_separable(self) -> bool {
        matches!(self, Method::StormerVerlet | Method::SemiImplicitEuler)
    }

    /// The runtime's integration by this method.
    pub(crate) fn integrate(
        self,
        accuracy: Accuracy,
        accelerations: impl FnMut(f64, &Vec<f64>, &Vec<f64>, &mut Vec<f64>),
        (t, t_end): (f64, f64),
        state: &mut State<Vec<f64>>,
        events: &mut [Event<'_, Vec<f64>>],
        observer: impl FnMut(&mut dyn Step<Vec<f64>>) -> Result<ControlFlow<f64>, String>,
    ) -> Result<Summary, IntegrationError<String>> {
        let Accuracy { relative, absolute, step, longest, most_steps } = accuracy;
        // Far from zero, rows may be closer than the shortest step that is tried.
        let longest = longest.max(32.0 * f64::EPSILON * t.abs().max(t_end.abs()));
        let (f, y, e, o) = (accelerations, state, events, observer);
        match self {
            Method::Dop853 => {
                let method = Dop853::new(relative, absolute).with_max_step(longest).with_max_steps(most_steps);
                method.integrate_with_events(f, t, t_end, y, e, o)
            }
            Method::Dopri5 => {
                let method = Dopri5::new(relative, absolute).with_max_step(longest).with_max_steps(most_steps);
                method.integrate_with_events(f, t, t_end, y, e, o)
            }
            Method::Rk4 => Rk4::new(step).integrate_with_events(f, t, t_end, y, e, o),
            Method::GaussLegendre4 => GaussLegendre4::new(step).integrate_with_events(f, t, t_end, y, e, o),
            Method::StormerVerlet => StormerVerlet::new(step).integrate_with_events(f, t, t_end, y, e, o),
            Method::SemiImplicitEuler => SemiImplicitEuler::new(step).integrate_with_events(f, t, t_end, y, e, o),
        }
    }
}
