//! What the examples share: their arguments, what they assume, the files they write, how they fail; the
//! calculations and figures of the thesis that the programs of a chapter and `gallery` both draw; what `benches/`
//! times, too; contests of who is faster; and ensembles by a plan.

pub mod arguments;
pub mod arm_trajectory;
pub mod assumed;
pub mod chains;
pub mod contest;
pub mod dispersion;
pub mod figures;
pub mod histograms;
pub mod numbers;
pub mod output;
pub mod platform_dynamics;
pub mod quadrotor_landing;
pub mod relative_motion;
pub mod work_precision;

use std::error::Error;
use std::fmt;

/// What ends an example early, in words: `main` prints it after `Error: `.
pub struct Failure(Box<dyn Error + Send + Sync>);

impl Failure {
    /// With a text of its own.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into().into())
    }
}

impl<E: Error + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(Box::new(error))
    }
}

impl fmt::Debug for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)?;
        let mut cause = self.0.source();
        while let Some(error) = cause {
            write!(f, ": {error}")?;
            cause = error.source();
        }
        Ok(())
    }
}
