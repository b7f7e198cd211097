//! Arm, vehicle and platform as capsules, and how far they are apart.
//!
//! A [`Capsule`] is what is no farther than a radius from a segment. Looked at are all pairs that do not touch by their
//! purpose: neighbours on the arm do, and so do vehicle or wrist and the deck, where one lands on the other.
//!
//! ```
//! use mbs_landing::experiment::collision::Capsule;
//!
//! // Two that cross at right angles, a metre above each other.
//! let one = Capsule { ends: [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], radius: 0.1 };
//! let other = Capsule { ends: [[0.0, -1.0, 1.0], [0.0, 1.0, 1.0]], radius: 0.2 };
//! assert!((one.distance(&other) - 0.7).abs() < 1e-15);
//! ```

use core::fmt;

use mbs_arm::{A1, A2, A3, D1, D4};
use mbs_models::Error;
use mbs_models::check::{self, Invalid};
use mbs_platform::{Coordinates, HOME};
use mbs_runtime::{Pose, Scalar};
use nalgebra::Vector3;

use super::plan::Plan;
use super::rail_arm::RailVector;

/// What is no farther than a radius from a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The ends of the segment \[m\].
    pub ends: [[f64; 3]; 2],
    /// The radius \[m\].
    pub radius: f64,
}

impl Capsule {
    /// How far two of them are apart \[m\]; negative where they overlap, by how much.
    ///
    /// # Source
    /// C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.9: the segments' nearest points.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let [[a, b], [c, d]] = [self.ends, other.ends].map(|ends| ends.map(Vector3::from));
        let (u, v, between) = (b - a, d - c, a - c);
        let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
        let (ub, vb) = (u.dot(&between), v.dot(&between));
        let part = |top: f64, bottom: f64| if bottom > 0.0 { (top / bottom).clamp(0.0, 1.0) } else { 0.0 };
        // On the first segment, of parallel ones anywhere; then the nearest on the second, and back where that ends.
        let first = part(uv * vb - ub * vv, uu * vv - uv * uv);
        let second = part(uv * first + vb, vv);
        let first = part(uv * second - ub, uu);
        let apart = between + first * u - second * v;
        Scalar::sqrt(apart.dot(&apart)) - self.radius - other.radius
    }
}

/// What a capsule is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The arm's base, up to its second axis.
    Base,
    /// Link 2.
    UpperArm,
    /// Links 3 and 4.
    Forearm,
    /// Links 5 and 6, up to the flange.
    Wrist,
    /// The arms of the vehicle, with their rotors.
    Vehicle,
    /// The upper plate of the platform.
    Deck,
    /// Any leg of the platform.
    Leg,
}

impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Base => "the arm's base",
            Self::UpperArm => "the upper arm",
            Self::Forearm => "the forearm",
            Self::Wrist => "the wrist",
            Self::Vehicle => "the vehicle",
            Self::Deck => "the deck",
            Self::Leg => "a leg of the platform",
        })
    }
}

/// Radii of the capsules \[m\], and the length of the vehicle's arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shapes {
    /// The radius of the arm's base.
    pub base: f64,
    /// The radius of link 2.
    pub upper_arm: f64,
    /// Of links 3 and 4.
    pub forearm: f64,
    /// Of links 5 and 6.
    pub wrist: f64,
    /// From the vehicle's mass centre to the end of an arm, and the radius around it.
    pub vehicle: [f64; 2],
    /// Half the thickness of the deck.
    pub deck: f64,
    /// The radius of a leg.
    pub leg: f64,
}

impl Shapes {
    /// Around castings and cylinders of machines of this size: assumed. The vehicle's arms are those of chapter 5.
    pub const LABORATORY: Self =
        Self { base: 0.35, upper_arm: 0.22, forearm: 0.15, wrist: 0.12, vehicle: [0.75, 0.05], deck: 0.03, leg: 0.07 };

    /// The axes of the machines alone, and a vehicle that is a point: what is left of a plan are limits of the drives.
    pub const AXES: Self =
        Self { base: 0.0, upper_arm: 0.0, forearm: 0.0, wrist: 0.0, vehicle: [0.0; 2], deck: 0.0, leg: 0.0 };

    pub(super) fn check(&self) -> Result<(), Invalid> {
        let Self { base, upper_arm, forearm, wrist, vehicle, deck, leg } = *self;
        check::not_negative("shapes", [base, upper_arm, forearm, wrist, vehicle[0], vehicle[1], deck, leg])
    }
}

/// Two bodies, and how far they are apart \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Which.
    pub bodies: [Body; 2],
    /// Negative where they overlap.
    pub distance: f64,
}

impl Nearest {
    /// True where they touch or overlap, or the distance is NaN.
    #[must_use]
    pub fn overlaps(&self) -> bool {
        self.distance <= 0.0 || self.distance.is_nan()
    }
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bodies: [one, other], distance } = self;
        write!(f, "{one} and {other} are {distance:.3} m apart")
    }
}

/// Capsules of a body.
type Part = (Body, Capsule);

/// Pairs that are looked at.
const PAIRS: [[Body; 2]; 14] = [
    [Body::Base, Body::Forearm],
    [Body::Base, Body::Wrist],
    [Body::Base, Body::Vehicle],
    [Body::Base, Body::Deck],
    [Body::Base, Body::Leg],
    [Body::UpperArm, Body::Wrist],
    [Body::UpperArm, Body::Vehicle],
    [Body::UpperArm, Body::Deck],
    [Body::UpperArm, Body::Leg],
    [Body::Forearm, Body::Vehicle],
    [Body::Forearm, Body::Deck],
    [Body::Forearm, Body::Leg],
    [Body::Wrist, Body::Leg],
    [Body::Vehicle, Body::Leg],
];

impl Plan<'_> {
    /// The two bodies that are nearest to each other, or overlap most, with the axes and the platform there.
    ///
    /// # Errors
    /// [`Error`] where the platform has no legs.
    pub fn nearest(&self, axes: &RailVector, deck: &Coordinates) -> Result<Nearest, Error> {
        let robot = self.arm_parts(axes);
        let platform = self.platform_parts(deck)?;
        let of = |body: Body| robot.iter().chain(&platform).filter(move |(part, _)| *part == body);
        let mut nearest = Nearest { bodies: PAIRS[0], distance: f64::INFINITY };
        for bodies in PAIRS {
            for (_, one) in of(bodies[0]) {
                for (_, other) in of(bodies[1]) {
                    let distance = one.distance(other);
                    // NaN is not hidden by what comes after it.
                    if distance < nearest.distance || distance.is_nan() {
                        nearest = Nearest { bodies, distance };
                    }
                }
            }
        }
        Ok(nearest)
    }

    /// The arm on its carriage, with the vehicle.
    fn arm_parts(&self, q: &RailVector) -> [Part; 6] {
        let Shapes { base, upper_arm, forearm, wrist, vehicle: [length, around], .. } = self.experiment().shapes;
        let [rail, q1, q2, q3, ..] = *q;
        let (sin, cos) = Scalar::sin_cos(q1);
        // In the plane of the arm, that far from the first axis and that high.
        let place = |[r, z]: [f64; 2]| [rail + r * cos, r * sin, z];
        let along = |[r, z]: [f64; 2], length: f64, angle: f64| {
            let (sin, cos) = Scalar::sin_cos(angle);
            [r + length * cos, z - length * sin]
        };
        let shoulder = [A1, D1];
        let elbow = along(shoulder, A2, q2);
        // The fourth axis is at right angles to the third link.
        let turned = along(elbow, A3, q2 + q3);
        let centre = along(turned, D4, q2 + q3 + core::f64::consts::FRAC_PI_2);
        let Pose { position: flange, rotation } = self.experiment().robot.pose(q);
        let rotor = |axis: usize| {
            let end = |sign: f64| core::array::from_fn(|i| flange[i] + sign * length * rotation[i][axis]);
            Capsule { ends: [end(-1.0), end(1.0)], radius: around }
        };
        let part = |ends: [[f64; 2]; 2], radius: f64| Capsule { ends: ends.map(place), radius };
        [
            (Body::Base, part([[0.0, 0.0], [0.0, D1]], base)),
            (Body::UpperArm, part([shoulder, elbow], upper_arm)),
            (Body::Forearm, part([turned, centre], forearm)),
            (Body::Wrist, Capsule { ends: [place(centre), flange], radius: wrist }),
            (Body::Vehicle, rotor(0)),
            (Body::Vehicle, rotor(1)),
        ]
    }

    /// The platform: its legs, the edge of its deck from joint to joint, and three diagonals.
    fn platform_parts(&self, q: &Coordinates) -> Result<[Part; 15], Error> {
        let Shapes { deck, leg, .. } = self.experiment().shapes;
        let (cell, platform) = (self.experiment().cell, &self.experiment().platform);
        let legs = platform.legs(q)?;
        let [x, y] = cell.platform;
        let base = [x, y, cell.deck - HOME[2]];
        let lower = |i: usize| core::array::from_fn(|k| base[k] + platform.geometry().base[i][k]);
        let upper = |i: usize| core::array::from_fn(|k| base[k] + q[k] + legs.lever[i][k]);
        let edge = |from: usize, to: usize| (Body::Deck, Capsule { ends: [upper(from), upper(to)], radius: deck });
        Ok(core::array::from_fn(|k| match k {
            0..6 => (Body::Leg, Capsule { ends: [lower(k), upper(k)], radius: leg }),
            6..12 => edge(k - 6, (k - 5) % 6),
            _ => edge(k - 12, k - 9),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::flight::Flight;
    use crate::experiment::plan::Experiment;
    use crate::quadrotor::heave::Heave;
    use crate::quadrotor::landing::{Landing, Plant};
    use mbs_arm::D6;

    fn capsule(from: [f64; 3], to: [f64; 3]) -> Capsule {
        Capsule { ends: [from, to], radius: 0.0 }
    }

    /// Parallel, crossing, beyond each other's ends, points, and one inside the other.
    #[test]
    fn distances_by_hand() {
        let unit = capsule([0.0; 3], [1.0, 0.0, 0.0]);
        let cases = [
            (capsule([0.0, 2.0, 0.0], [1.0, 2.0, 0.0]), 2.0),
            (capsule([3.0, 0.0, 0.0], [4.0, 0.0, 0.0]), 2.0),
            (capsule([3.0, 4.0, 0.0], [3.0, 9.0, 0.0]), 20.0_f64.sqrt()),
            (capsule([0.5, 1.0, -1.0], [0.5, 1.0, 1.0]), 1.0),
            (capsule([-1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]), 2.0_f64.sqrt()),
            (capsule([0.2, 0.0, 0.0], [0.7, 0.0, 0.0]), 0.0),
        ];
        for (other, want) in cases {
            for (one, two) in [(&unit, &other), (&other, &unit)] {
                assert!((one.distance(two) - want).abs() < 1e-15, "{other:?}: {}", one.distance(two));
            }
        }
        let thick = Capsule { radius: 0.4, ..unit };
        assert!((thick.distance(&Capsule { radius: 0.2, ..cases[0].0 }) - 1.4).abs() < 1e-15);
        assert_eq!(thick.distance(&thick), -0.8);
    }

    /// The wrist, from its centre to the flange, is as long as in Table 1 and along the last axis; the upper arm as
    /// long as there; legs as long as the platform says.
    #[test]
    fn parts_of_the_machines_are_where_they_should_be() {
        let flight = Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I)).expect("a landing");
        let experiment = Experiment::new(flight);
        let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
        for q in [[2.0, 0.3, -1.2, 0.4, 0.7, -0.6, 0.2], [0.0, -2.0, 0.3, -1.0, 2.0, 1.1, 3.0]] {
            let parts = plan.arm_parts(&q);
            let Pose { position, rotation } = experiment.robot.pose(&q);
            let [centre, flange] = parts[3].1.ends;
            let along: [f64; 3] = core::array::from_fn(|i| centre[i] + D6 * rotation[i][2]);
            assert!((0..3).all(|i| (along[i] - position[i]).abs() < 1e-14 && flange[i] == position[i]), "{along:?}");
            assert_eq!(centre, parts[2].1.ends[1]);
            let [from, to] = parts[1].1.ends.map(Vector3::from);
            assert!(((to - from).norm() - A2).abs() < 1e-15);
        }
        let deck = [0.1, -0.05, 1.2, 0.1, 0.05, -0.2];
        let lengths = experiment.platform.lengths(&deck).expect("legs");
        for (leg, (body, capsule)) in plan.platform_parts(&deck).expect("legs").iter().take(6).enumerate() {
            let [from, to] = capsule.ends.map(Vector3::from);
            assert!(*body == Body::Leg && ((to - from).norm() - lengths[leg]).abs() < 1e-14);
        }
    }

    /// The nearest of 201 by 201 points on the segments is no nearer, and hardly farther.
    #[test]
    fn no_points_of_the_segments_are_nearer() {
        let number = |k: u32| 4.0 * (f64::from(k) * 0.618_033_988_749_895).fract() - 2.0;
        for case in 0..40 {
            let point = |k: u32| core::array::from_fn(|i| number(12 * case + 3 * k + i as u32));
            let (one, two) = (capsule(point(0), point(1)), capsule(point(2), point(3)));
            let on = |of: &Capsule, part: f64| -> [f64; 3] {
                core::array::from_fn(|i| of.ends[0][i] + part * (of.ends[1][i] - of.ends[0][i]))
            };
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                for j in 0..=200 {
                    let (a, b) = (on(&one, f64::from(i) / 200.0), on(&two, f64::from(j) / 200.0));
                    least = least.min((0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt());
                }
            }
            let found = one.distance(&two);
            assert!(found <= least + 1e-12 && found > least - 0.05, "{found}, sampled {least}");
        }
    }
}
