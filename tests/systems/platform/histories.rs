//! Histories of the eight cases against mechanics typed by hand: motions as the thesis prints them, lengths by vectors,
//! speeds and accelerations by differences over time, forces by Newton's and Euler's laws for six legs of two bodies
//! each, power as the rate of the energy.
//!
//! No parameter, no formula and no derivative of the platform's own is used; numbers are those of
//! `docs/thesis/assumed.md`.

use std::f64::consts::FRAC_PI_2;

use mbs_platform::{Motion, Platform};
use mbs_tests::compare::assert_close;
use nalgebra::{Matrix3, Matrix6, Rotation3, SVector, Vector3, Vector6};

use super::platform;

/// Between the points of a difference \[s\]. Five points leave an error of h⁴/30 of the fifth derivative: 1e-8 at 1.7
/// rad/s.
const H: f64 = 0.01;
const TOLERANCE: f64 = 1e-7;

type Point = Vector3<f64>;

/// `(f(t − 2h) − 8 f(t − h) + 8 f(t + h) − f(t + 2h)) / 12h`
fn rate<const N: usize>(f: impl Fn(f64) -> SVector<f64, N>, t: f64) -> SVector<f64, N> {
    (f(t - 2.0 * H) - f(t - H) * 8.0 + f(t + H) * 8.0 - f(t + 2.0 * H)) / (12.0 * H)
}

/// `(−f(t − 2h) + 16 f(t − h) − 30 f(t) + 16 f(t + h) − f(t + 2h)) / 12h²`
fn acceleration(f: impl Fn(f64) -> Point, t: f64) -> Point {
    ((f(t - H) + f(t + H)) * 16.0 - f(t) * 30.0 - f(t - 2.0 * H) - f(t + 2.0 * H)) / (12.0 * H * H)
}

/// Place and angles of a case, counted from 1, as `docs/thesis/chapter_4.md` has them.
fn place(case: usize, t: f64) -> [f64; 6] {
    let (sin, cos) = (FRAC_PI_2 * t).sin_cos();
    let degrees = f64::to_radians;
    match case {
        1 => [-0.2, -0.3, 1.1 - 0.08 * cos, 0.0, 0.0, 0.0],
        2 => [0.15 * sin, 0.0, 1.1, 0.0, 0.0, 0.0],
        3 => [0.0, 0.15 * sin, 1.1, 0.0, 0.0, 0.0],
        4 => [0.0, 0.0, 1.1, degrees(10.0) * sin, 0.0, 0.0],
        5 => [0.0, 0.0, 1.1, 0.0, degrees(10.0) * sin, 0.0],
        6 => [-0.3 + 0.25 * sin, -0.4 * sin, 1.1 + 0.7 + 0.5 * sin, 0.0, 0.0, degrees(20.0)],
        7 => [0.0, 0.0, 1.1, 0.0, 0.0, degrees(15.0) * sin],
        _ => [
            0.05 * (1.3 * t).sin(),
            0.07 * (1.1 * t).cos(),
            1.1 + 0.06 * (0.9 * t).sin(),
            0.1 * (1.3 * t).sin(),
            0.12 * (1.3 * t).cos(),
            0.15 * (1.7 * t).sin(),
        ],
    }
}

/// A case under a payload \[kg\], on legs whose masses count or do not.
#[derive(Clone, Copy)]
struct Bodies {
    case: usize,
    payload: f64,
    /// 1, or 0.
    legs: f64,
}

const G: f64 = 9.80665;
const CYLINDER: [f64; 2] = [35.0, 0.35];
const PISTON: [f64; 2] = [15.0, 0.4];
/// Across a leg, of cylinder and piston \[kg·m²\].
const LEG_INERTIA: f64 = 3.0 + 1.5;
const UP: Point = Vector3::new(0.0, 0.0, 1.0);

fn on_circle(radius: f64, degrees: f64) -> Point {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vector3::new(radius * cos, radius * sin, 0.0)
}

impl Bodies {
    fn rotation(self, t: f64) -> Matrix3<f64> {
        let [.., phi, theta, psi] = place(self.case, t);
        // R_z(ψ) R_y(θ) R_x(φ)
        Rotation3::from_euler_angles(phi, theta, psi).into_inner()
    }

    fn origin(self, t: f64) -> Point {
        let [x, y, z, ..] = place(self.case, t);
        Vector3::new(x, y, z)
    }

    fn foot(leg: usize) -> Point {
        on_circle(1.2, [-12.0, 12.0, 108.0, 132.0, 228.0, 252.0][leg])
    }

    fn joint(self, leg: usize, t: f64) -> Point {
        self.origin(t) + self.rotation(t) * on_circle(0.9, [-48.0, 48.0, 72.0, 168.0, 192.0, 288.0][leg])
    }

    fn leg(self, leg: usize, t: f64) -> Point {
        self.joint(leg, t) - Self::foot(leg)
    }

    fn lengths(self, t: f64) -> Vector6<f64> {
        Vector6::from_fn(|i, _| self.leg(i, t).norm())
    }

    /// Mass centre of the box of the payload, 0.4 m over the plane of the joints.
    fn load(self, t: f64) -> Point {
        self.origin(t) + self.rotation(t) * Vector3::new(0.0, 0.0, 0.4)
    }

    fn cylinder(self, leg: usize, t: f64) -> Point {
        Self::foot(leg) + self.leg(leg, t).normalize() * CYLINDER[1]
    }

    fn piston(self, leg: usize, t: f64) -> Point {
        self.joint(leg, t) - self.leg(leg, t).normalize() * PISTON[1]
    }

    /// Moments of inertia of plate and box about their own mass centres, in the axes of the platform.
    fn inertia(self) -> Matrix3<f64> {
        let [x, y, z] = [1.2_f64, 1.0, 0.8].map(|side| side * side * self.payload / 12.0);
        Matrix3::from_diagonal(&Vector3::new(55.0 + y + z, 55.0 + x + z, 105.0 + x + y))
    }

    /// `[ω]× = Ṙ Rᵀ`
    fn angular_velocity(self, t: f64) -> Point {
        let columns = |t: f64| SVector::<f64, 9>::from_column_slice(self.rotation(t).as_slice());
        let spin = Matrix3::from_column_slice(rate(columns, t).as_slice()) * self.rotation(t).transpose();
        Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)])
    }

    /// About the mass centres: `R I Rᵀ ω`.
    fn spin(self, t: f64) -> Point {
        let rotation = self.rotation(t);
        rotation * self.inertia() * rotation.transpose() * self.angular_velocity(t)
    }

    /// Kinetic and potential energy \[J\].
    fn energy(self, t: f64) -> f64 {
        let particle =
            |mass: f64, centre: &dyn Fn(f64) -> Point| mass * (0.5 * rate(centre, t).norm_squared() + G * centre(t).z);
        let mut energy = particle(250.0, &|t| self.origin(t)) + particle(self.payload, &|t| self.load(t));
        energy += 0.5 * self.angular_velocity(t).dot(&self.spin(t));
        for leg in 0..6 {
            let turning = rate(|t| self.leg(leg, t).normalize(), t).norm_squared();
            let bodies =
                particle(CYLINDER[0], &|t| self.cylinder(leg, t)) + particle(PISTON[0], &|t| self.piston(leg, t));
            energy += self.legs * (bodies + 0.5 * LEG_INERTIA * turning);
        }
        energy
    }

    /// What a leg takes at its upper joint to be moved and carried \[N\], its actuator left out.
    ///
    /// Cylinder and piston turn about the foot; by d'Alembert's principle, for a displacement `δa` of the joint with
    /// `δu = (1 − u uᵀ) δa / l`.
    fn drag(self, leg: usize, t: f64) -> Point {
        let inertial = |mass: f64, centre: &dyn Fn(f64) -> Point| (acceleration(centre, t) + UP * G) * mass;
        let (cylinder, piston) =
            (inertial(CYLINDER[0], &|t| self.cylinder(leg, t)), inertial(PISTON[0], &|t| self.piston(leg, t)));
        let turning = acceleration(|t| self.leg(leg, t).normalize(), t) * LEG_INERTIA;
        let across = cylinder * CYLINDER[1] - piston * PISTON[1] + turning;
        let (length, u) = (self.leg(leg, t).norm(), self.leg(leg, t).normalize());
        (piston + (across - u * u.dot(&across)) / length) * self.legs
    }

    /// Newton's law and Euler's, about the origin of the base: `Σ Fᵢ uᵢ = m (a + g) + …`, `Σ aᵢ × Fᵢ uᵢ = …`.
    fn forces(self, t: f64) -> Vector6<f64> {
        let inertial = |mass: f64, centre: &dyn Fn(f64) -> Point| {
            let force = (acceleration(centre, t) + UP * G) * mass;
            (force, centre(t).cross(&force))
        };
        let (plate, load) = (inertial(250.0, &|t| self.origin(t)), inertial(self.payload, &|t| self.load(t)));
        let (mut force, mut moment) = (plate.0 + load.0, plate.1 + load.1 + rate(|t| self.spin(t), t));
        let mut by_legs = Matrix6::zeros();
        for leg in 0..6 {
            let (joint, u, drag) = (self.joint(leg, t), self.leg(leg, t).normalize(), self.drag(leg, t));
            force += drag;
            moment += joint.cross(&drag);
            by_legs.fixed_view_mut::<3, 1>(0, leg).copy_from(&u);
            by_legs.fixed_view_mut::<3, 1>(3, leg).copy_from(&joint.cross(&u));
        }
        let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        by_legs.lu().solve(&wrench).expect("a pose that legs can hold")
    }
}

/// Every case under every payload, on both kinds of legs, at moments of no pattern.
fn every_case(check: impl Fn(&str, Bodies, &Platform, &Motion, f64)) {
    for (i, (name, motion)) in Motion::CASES.iter().enumerate() {
        for (payload, actuators) in [(0.0, true), (300.0, true), (300.0, false), (1250.0, true)] {
            let bodies = Bodies { case: i + 1, payload, legs: f64::from(u8::from(actuators)) };
            for k in 0..12 {
                let t = 0.05 + 0.37 * f64::from(k);
                let what = format!("case {} ({name}), {payload} kg, legs with mass: {actuators}, {t} s", i + 1);
                check(&what, bodies, &platform(payload, actuators), motion, t);
            }
        }
    }
}

#[test]
fn lengths_and_speeds_are_those_of_vectors_and_their_differences() {
    every_case(|what, bodies, platform, motion, t| {
        let [q, qd, qdd] = motion.at(t);
        assert_close(what, &q, &place(bodies.case, t), 1e-15);
        let legs = platform.leg_state(&q, &qd, &qdd).unwrap();
        assert_close(what, &legs.length, bodies.lengths(t).as_slice(), 1e-14);
        assert_close(what, &legs.rate, rate(|t| bodies.lengths(t), t).as_slice(), TOLERANCE);
    });
}

#[test]
fn forces_are_those_of_newton_and_euler() {
    every_case(|what, bodies, platform, motion, t| {
        let [q, qd, qdd] = motion.at(t);
        let forces = platform.leg_state(&q, &qd, &qdd).unwrap().force;
        assert_close(what, &forces, bodies.forces(t).as_slice(), TOLERANCE);
    });
}

#[test]
fn power_is_the_rate_of_the_energy() {
    let mut most = 0.0_f64;
    every_case(|what, bodies, platform, motion, t| {
        let [q, qd, qdd] = motion.at(t);
        let legs = platform.leg_state(&q, &qd, &qdd).unwrap();
        let want = rate(|t| SVector::<f64, 1>::new(bodies.energy(t)), t)[0];
        let power = legs.power();
        // Legs push and are pushed: their powers are larger than the sum.
        let scale = power.iter().fold(1.0, |largest: f64, x| largest.max(x.abs()));
        assert_close(what, &[power.iter().sum::<f64>() / scale], &[want / scale], TOLERANCE);
    });
    for (name, motion) in &Motion::CASES[..7] {
        // Over a period nothing is gained; the trapezoidal rule is exact for what has few frequencies.
        let power = |k: i32| {
            let [q, qd, qdd] = motion.at(0.02 * f64::from(k));
            platform(300.0, true).leg_state(&q, &qd, &qdd).unwrap().power()
        };
        let powers: Vec<f64> = (0..200).map(|k| power(k).iter().sum()).collect();
        let largest = powers.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        assert!((0.02 * powers.iter().sum::<f64>()).abs() < 1e-9 * largest, "{name}");
        most = most.max(largest);
    }
    assert!(most > 1000.0, "{most} W");
}
