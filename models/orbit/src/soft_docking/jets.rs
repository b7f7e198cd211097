//! Jets: which of them make a wrench, and the pulses that they are fired in.
//!
//! A jet pushes and does not pull: thrusts are the least, not negative, that make the wrench, the solution of
//!
//! ```text
//! min |A f − w|² + ε² |f|²,   f ≥ 0
//! ```
//!
//! with torques over the arm of a jet, found by the active set of Lawson and Hanson. A period's impulse is one pulse of
//! full thrust; where one is longer than the period all are shortened alike, and one that is shorter than a valve makes
//! waits until enough has come together.
//!
//! # Source
//! Lawson, Hanson, *Solving Least Squares Problems*, 1974, chapter 23; Wie, *Space Vehicle Dynamics and Control*,
//! 2008, on pulse-width modulation.

use mbs_models::check::{self, Invalid};
use mbs_runtime::Scalar;
use nalgebra::{SMatrix, SVector};

use crate::vector::{Vector, cross, scaled};

/// How many.
pub const JETS: usize = 24;
/// A number for each jet.
pub type PerJet = [f64; JETS];
/// Force, then torque about the mass centre, in the chaser's axes \[N, N·m\].
pub type Wrench = [f64; 6];

/// ε as a part of the largest column of A.
const REGULAR: f64 = 1e-4;
/// No active set is longer on its way.
const CHANGES: usize = 20 * JETS;

/// A jet in the chaser's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Of its nozzle, from the mass centre \[m\].
    pub place: Vector,
    /// Of the force on the chaser, a unit vector: the exhaust goes the other way.
    pub push: Vector,
}

/// All jets of a chaser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JetSet {
    /// Where they are.
    pub jets: [Jet; JETS],
    /// The thrust of each jet \[N\].
    pub thrust: f64,
    /// Effective velocity of the exhaust: specific impulse × 9.80665 m/s² \[m/s\].
    pub exhaust_velocity: f64,
    /// The shortest pulse \[s\].
    pub shortest: f64,
    /// Between two decisions \[s\].
    pub period: f64,
}

impl JetSet {
    /// Of a capsule: four jets that brake, canted away from the approach by `cant` \[rad\], four that push ahead, and
    /// sixteen across, at the corners of a box.
    #[must_use]
    pub fn capsule(cant: f64) -> Self {
        /// Half of the box along the approach and across \[m\].
        const HALF: [f64; 2] = [2.0, 1.5];
        let (sin, cos) = Scalar::sin_cos(cant);
        let out = sin * Scalar::sqrt(0.5);
        let side = |bit: usize, i: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let jets = core::array::from_fn(|i| {
            let (y, z) = (side(0, i), side(1, i));
            match i / 4 {
                0 => Jet { place: [HALF[0], HALF[1] * y, HALF[1] * z], push: [-cos, -out * y, -out * z] },
                1 => Jet { place: [-HALF[0], HALF[1] * y, HALF[1] * z], push: [1.0, 0.0, 0.0] },
                across => {
                    let end = HALF[0] * if across % 2 == 0 { 1.0 } else { -1.0 };
                    let place = [end, HALF[1] * y, HALF[1] * z];
                    Jet { place, push: if across < 4 { [0.0, -y, 0.0] } else { [0.0, 0.0, -z] } }
                }
            }
        });
        Self { jets, thrust: 100.0, exhaust_velocity: 285.0 * 9.80665, shortest: 0.02, period: 1.0 }
    }

    /// The wrench of one jet per newton.
    #[must_use]
    pub fn column(&self, jet: usize) -> Wrench {
        let Jet { place, push } = &self.jets[jet];
        let [[x, y, z], [u, v, w]] = [*push, cross(place, push)];
        [x, y, z, u, v, w]
    }

    /// The wrench of these thrusts.
    #[must_use]
    pub fn wrench(&self, thrusts: &PerJet) -> Wrench {
        let columns: [Wrench; JETS] = core::array::from_fn(|jet| self.column(jet));
        core::array::from_fn(|row| (0..JETS).map(|jet| columns[jet][row] * thrusts[jet]).sum())
    }

    /// Thrusts that make a wrench, of any size \[N\].
    #[must_use]
    pub fn allocate(&self, wrench: &Wrench) -> PerJet {
        // An arm's length, so that newtons and newton metres count alike.
        let arm = (0..JETS).fold(0.0_f64, |most, jet| most.max(crate::vector::norm(&self.jets[jet].place)));
        let scale = |row: usize| if row < 3 { 1.0 } else { 1.0 / arm.max(f64::MIN_POSITIVE) };
        let a = SMatrix::<f64, 6, JETS>::from_fn(|row, jet| scale(row) * self.column(jet)[row]);
        let w = SVector::<f64, 6>::from_fn(|row, _| scale(row) * wrench[row]);
        let normal = a.tr_mul(&a) + SMatrix::<f64, JETS, JETS>::identity() * (REGULAR * REGULAR);
        nonnegative(&normal, &a.tr_mul(&w))
    }

    /// How long each is open in a period \[s\].
    ///
    /// `owed` is what was asked for and not fired, since valves do not open for less than the shortest pulse; it begins
    /// with zeros, and never is more than a pulse of that length.
    #[must_use]
    pub fn pulses(&self, thrusts: &PerJet, owed: &mut PerJet) -> PerJet {
        let longest = thrusts.iter().fold(self.thrust, |most, thrust| most.max(*thrust));
        core::array::from_fn(|jet| {
            owed[jet] += self.period * thrusts[jet] / longest;
            let open = if owed[jet] < self.shortest { 0.0 } else { owed[jet].min(self.period) };
            owed[jet] -= open;
            open
        })
    }

    /// The propellant that a jet takes \[kg/s\].
    #[must_use]
    pub fn mass_flow(&self) -> f64 {
        self.thrust / self.exhaust_velocity
    }

    /// Force and torque per newton of one jet.
    pub(super) fn push(&self, jet: usize, thrust: f64) -> [Vector; 2] {
        let Jet { place, push } = &self.jets[jet];
        let force = scaled(thrust, push);
        [force, cross(place, &force)]
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        check::positive("jets.thrust", self.thrust)?;
        check::positive("jets.exhaust_velocity", self.exhaust_velocity)?;
        check::positive("jets.period", self.period)?;
        check::within("jets.shortest", self.shortest, [0.0, self.period])?;
        self.jets.iter().try_for_each(|jet| {
            check::finite("jets.place", jet.place)?;
            check::finite("jets.push", jet.push)
        })
    }
}

/// Least squares without negative numbers, `normal` positive definite.
fn nonnegative(normal: &SMatrix<f64, JETS, JETS>, right: &SVector<f64, JETS>) -> PerJet {
    let mut x = SVector::<f64, JETS>::zeros();
    let mut passive = [false; JETS];
    // What the gradient of a jet that is off must be to count, against the greatest at the beginning.
    let small = 1e-12 * right.amax();
    for _ in 0..CHANGES {
        let gradient = right - normal * x;
        let best = (0..JETS).filter(|&i| !passive[i]).max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        let Some(best) = best.filter(|&i| gradient[i] > small) else { break };
        passive[best] = true;
        loop {
            let Some(wanted) = solved(normal, right, &passive) else { return x.into() };
            let step = (0..JETS).filter(|&i| passive[i] && wanted[i] <= 0.0);
            let step = step.map(|i| x[i] / (x[i] - wanted[i])).fold(1.0, f64::min);
            x += (wanted - x) * step;
            if step == 1.0 {
                break;
            }
            for i in 0..JETS {
                if passive[i] && x[i] <= small {
                    (passive[i], x[i]) = (false, 0.0);
                }
            }
        }
    }
    x.into()
}

/// Of those that are on, all others zero.
fn solved(
    normal: &SMatrix<f64, JETS, JETS>,
    right: &SVector<f64, JETS>,
    passive: &[bool; JETS],
) -> Option<SVector<f64, JETS>> {
    let entry = |i: usize, j: usize| match (passive[i] && passive[j], i == j) {
        (true, _) => normal[(i, j)],
        (false, true) => 1.0,
        (false, false) => 0.0,
    };
    let right = SVector::from_fn(|i, _| if passive[i] { right[i] } else { 0.0 });
    Some(SMatrix::<f64, JETS, JETS>::from_fn(entry).cholesky()?.solve(&right))
}
