//! Motions that go back the way they came, and sums of sines, which show a model's numbers.

use core::f64::consts::TAU;

use mbs_models::Error;
use mbs_models::check;
use mbs_runtime::Scalar;

use super::{JointState, Motion};

/// A motion, and then the same way back in the same time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThereAndBack<M>(pub M);

impl<const N: usize, M: Motion<N>> Motion<N> for ThereAndBack<M> {
    fn duration(&self) -> f64 {
        2.0 * self.0.duration()
    }

    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        check::within("time", t, [0.0, self.duration()])?;
        if t <= self.0.duration() {
            return self.0.at(t);
        }
        let JointState { q, qd, qdd } = self.0.at(self.duration() - t)?;
        Ok(JointState { q, qd: qd.map(|rate| -rate), qdd })
    }
}

/// W sines in each joint about a posture, `qᵢ = mᵢ + Σₖ Aᵢₖ sin(2π t/Tᵢₖ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sines<const N: usize, const W: usize> {
    /// m \[rad\].
    pub middle: [f64; N],
    /// A \[rad\] and T \[s\], which is not zero, of each joint.
    pub waves: [[(f64, f64); W]; N],
    /// How long it lasts \[s\].
    pub duration: f64,
}

impl<const N: usize, const W: usize> Motion<N> for Sines<N, W> {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        check::within("time", t, [0.0, self.duration])?;
        let mut state = JointState::at_rest(self.middle);
        for (joint, waves) in self.waves.iter().enumerate() {
            for &(a, period) in waves {
                let w = TAU / period;
                let (sin, cos) = Scalar::sin_cos(w * t);
                state.q[joint] += a * sin;
                state.qd[joint] += a * w * cos;
                state.qdd[joint] -= a * w * w * sin;
            }
        }
        Ok(state)
    }
}

#[cfg(test)]
mod tests {
    use mbs_models::check::Must;

    use super::*;

    #[test]
    fn rates_are_those_of_the_angles_there_and_back() {
        let sines = Sines { middle: [0.3], waves: [[(0.5, 7.0), (-0.2, 3.0)]], duration: 5.0 };
        let motion = ThereAndBack(sines);
        for t in [0.4, 4.9, 5.2, 9.7] {
            let [before, now, after] = [t - 1e-4, t, t + 1e-4].map(|t| motion.at(t).unwrap());
            assert!(((after.q[0] - before.q[0]) / 2e-4 - now.qd[0]).abs() < 1e-7);
            assert!(((after.qd[0] - before.qd[0]) / 2e-4 - now.qdd[0]).abs() < 1e-7);
        }
        assert_eq!(motion.at(10.0).unwrap().q, [0.3]);
    }

    #[test]
    fn a_time_outside_is_refused_as_it_was_given() {
        let sines = Sines { middle: [0.3], waves: [[(0.5, 7.0)]], duration: 5.0 };
        for t in [-0.1, 10.1, f64::NAN] {
            let refused = [(sines.at(t), 5.0), (ThereAndBack(sines).at(t), 10.0)];
            for (state, duration) in refused {
                let wrong = state.unwrap_err().invalid().unwrap();
                assert_eq!((wrong.parameter, wrong.must), ("time", Must::BeWithin([0.0, duration])));
                assert_eq!(wrong.value.to_bits(), t.to_bits());
            }
        }
    }
}
