//! Adaptive control of the arm: forces are linear in the numbers of its links, some of which a controller learns.
//!
//! ```
//! use mbs_arm::adaptive::Unknown;
//! use mbs_models::irb7600::Params;
//!
//! // Of the last link the ten numbers, all of which an arm shows; of all links 36 combinations of sixty.
//! let params = Params::default();
//! assert_eq!(Unknown::last_link(&params).base(20, 1e-9)?.rank(), 10);
//! assert_eq!(Unknown::all_links(&params).base(40, 1e-9)?.rank(), 36);
//! # Ok::<(), mbs_models::Error>(())
//! ```
//!
//! # Source
//! J.-J. E. Slotine, W. Li, *On the adaptive control of robot manipulators*, International Journal of Robotics Research
//! 6:3, 1987.

use core::array;

use mbs_models::arm6_params::Arm6Params;
use mbs_models::irb7600::Params;
use mbs_models::{Error, Failure};
use mbs_runtime::control::{AdaptiveControl, BaseParameters, BodyParameters, RegressorStack, Sliding, regressor};

use crate::JointVector;
use crate::inertial::{self, MASSES_ALONE, links, parts};
use crate::trajectory::{JointState, Motion};

/// An arm of which P numbers are unknown.
#[derive(Clone, Copy, Debug)]
pub struct Unknown<const P: usize> {
    g: f64,
    /// The links, the unknown numbers left out.
    known: Option<[BodyParameters; 6]>,
    /// What the unknown numbers are the links of.
    unknown: fn(&[f64; P]) -> [BodyParameters; 6],
    /// Unknown numbers that an arm can have.
    probe: [f64; P],
}

impl Unknown<10> {
    /// The last link, with what the flange carries; the others are those of the mechanism.
    #[must_use]
    pub fn last_link(params: &Params<f64>) -> Self {
        let mut known = links(params);
        known[5] = BodyParameters::default();
        let unknown = |numbers: &[f64; 10]| {
            let mut links = [BodyParameters::default(); 6];
            links[5] = BodyParameters::from_array(numbers);
            links
        };
        let probe = BodyParameters { mass: 1.0, ..BodyParameters::default() }.to_array();
        Self { g: params.g, known: Some(known), unknown, probe }
    }
}

impl Unknown<60> {
    /// All six links.
    #[must_use]
    pub fn all_links(params: &Params<f64>) -> Self {
        Self { g: params.g, known: None, unknown: parts, probe: MASSES_ALONE }
    }
}

impl<const P: usize> Unknown<P> {
    /// The whole arm with these numbers.
    #[must_use]
    pub fn arm(&self, numbers: &[f64; P]) -> Arm6Params<f64> {
        let unknown = (self.unknown)(numbers);
        let links = match &self.known {
            Some(known) => array::from_fn(|i| known[i].plus(&unknown[i])),
            None => unknown,
        };
        inertial::model(&links, self.g)
    }

    /// Y of the unknown numbers.
    #[must_use]
    pub fn regressor(&self, sliding: &Sliding<6>, q: &JointVector, qd: &JointVector) -> [[f64; P]; 6] {
        let forces =
            |numbers: &[f64; P]| sliding.forces_of(&inertial::model(&(self.unknown)(numbers), self.g), 0.0, q, qd);
        regressor(forces, &self.probe)
    }

    /// What regressors at this many states tell, which no motion has to connect; a column of length 1 that is shorter
    /// than the tolerance across the others tells nothing.
    ///
    /// # Errors
    /// [`Error`] where a regressor is not finite.
    pub fn base(&self, states: u32, tolerance: f64) -> Result<BaseParameters<P>, Error> {
        let mut stack = RegressorStack::default();
        for state in 0..states {
            // Numbers without a pattern between −2 and 2: the steps are multiples of the golden mean.
            let part = |x: f64| x - f64::from(x as u32);
            let number = |k: u32| 4.0 * part(f64::from(18 * state + k) * 0.618_033_988_749_895) - 2.0;
            let of = |from: u32| array::from_fn(|i| number(from + i as u32));
            let (q, qd) = (of(0), of(6));
            stack.add(&self.regressor(&Sliding { error: [0.0; 6], qd, qdd: of(12) }, &q, &qd));
        }
        stack.base(tolerance).map_err(|_| Failure::NotFinite("a regressor of the arm").into())
    }

    /// What a motion shows that is followed exactly, looked at ten times a second.
    ///
    /// # Errors
    /// [`Error`] of the motion, or where a regressor is not finite.
    pub fn told(&self, motion: &dyn Motion<6>, tolerance: f64) -> Result<BaseParameters<P>, Error> {
        let mut stack = RegressorStack::default();
        for k in 0..(10.0 * motion.duration()) as u32 {
            let JointState { q, qd, qdd } = motion.at(0.1 * f64::from(k))?;
            stack.add(&self.regressor(&Sliding { error: [0.0; 6], qd, qdd }, &q, &qd));
        }
        stack.base(tolerance).map_err(|_| Failure::NotFinite("a regressor of the arm").into())
    }

    /// Torques under a control for a reference `(q, q̇, q̈)`, how far off the sliding surface it is, and the rates of
    /// the estimate.
    #[must_use]
    pub fn act(
        &self,
        control: &AdaptiveControl<6, P>,
        reference: &[JointVector; 3],
        [q, qd]: [&JointVector; 2],
        estimate: &[f64; P],
    ) -> (JointVector, JointVector, [f64; P]) {
        let sliding = control.sliding(reference, q, qd);
        let y = self.regressor(&sliding, q, qd);
        let forces = |links: &[BodyParameters; 6]| sliding.forces_of(&inertial::model(links, self.g), 0.0, q, qd);
        let known = self.known.as_ref().map_or([0.0; 6], forces);
        let learnt = control.forces(&y, estimate, &sliding.error);
        let torques = array::from_fn(|i| known[i] + learnt[i]);
        (torques, sliding.error, control.estimate_rate(&y, &sliding.error))
    }
}
