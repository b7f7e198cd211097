//! The SCARA, the wrist below its flange with the peg, and the control.
//!
//! Coordinates are the four of [`Scara`], then x, y, z of the peg's mass centre \[m\] and its tilt in the plane of x
//! and z \[rad\]; the last one is no coordinate: its velocity is the work done on all of it less what was lost \[J\].

use mbs_models::check::{Invalid, Must, finite, not_negative, positive};
use mbs_models::scara::{Params, Scara};
use mbs_runtime::{Scalar, State};

use super::contact::{Contact, Forces, Hole, Peg, PegMotion, axes};

/// The numbers of a state.
pub const NUMBERS: usize = 9;
/// Coordinates or velocities.
pub type Numbers = [f64; NUMBERS];

/// Springs and dampers between flange and peg, which act at one point of the peg: the centre of compliance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrist {
    /// K_x (in y the same), K_z \[N/m\], K_θ \[N·m/rad\].
    pub stiffness: [f64; 3],
    /// The damping \[N·s/m, N·s/m, N·m·s/rad\].
    pub damping: [f64; 3],
    /// L_g: height of the centre over the tip \[m\].
    pub centre: f64,
    /// From the flange down to the tip \[m\].
    pub length: f64,
}

/// Stiffness and damping that the drives give to x, y and z of the flange \[N/m, N·s/m\], and to its yaw \[N·m/rad,
/// N·m·s/rad\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impedance {
    /// K
    pub stiffness: [f64; 4],
    /// D
    pub damping: [f64; 4],
}

/// Where the flange is to be, its velocity and acceleration, in the world \[m, s\]; its yaw is to be zero.
pub type Wanted = [[f64; 3]; 3];

/// All of it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Generated.
    pub scara: Scara<f64>,
    /// Its numbers.
    pub params: Params<f64>,
    /// Between flange and peg.
    pub wrist: Wrist,
    /// What is carried.
    pub peg: Peg,
    /// Where it goes.
    pub hole: Hole,
    /// Between them.
    pub contact: Contact,
    /// Stiffness and damping by the drives.
    pub control: Impedance,
}

impl Cell {
    /// Whether all numbers are such that it can work.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("wrist.stiffness", self.wrist.stiffness)?;
        not_negative("wrist.damping", self.wrist.damping)?;
        finite("wrist.centre", self.wrist.centre)?;
        finite("wrist.length", self.wrist.length)?;
        not_negative("control.stiffness", self.control.stiffness)?;
        not_negative("control.damping", self.control.damping)?;
        self.peg.check()?;
        self.hole.check(&self.peg)?;
        self.contact.check()
    }

    /// The joints with the flange at a place, its yaw zero, the elbow to the right: law of cosines.
    ///
    /// # Errors
    /// [`Invalid`] for a place that the arms do not reach, also where the arms are stretched or folded, and can only
    /// turn.
    pub fn posture(&self, [x, y, z]: [f64; 3]) -> Result<[f64; 4], Invalid> {
        let [l1, l2] = self.params.length;
        let distance = Scalar::sqrt(x * x + y * y);
        let cos = (distance * distance - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
        finite("place", [x, y, z])?;
        if cos.is_nan() || cos.abs() >= 1.0 {
            return Err(Must::BeWithin([(l1 - l2).abs(), l1 + l2]).broken_by("distance from the first axis", distance));
        }
        let sin = Scalar::sqrt(1.0 - cos * cos);
        let elbow = Scalar::atan2(sin, cos);
        let shoulder = Scalar::atan2(y, x) - Scalar::atan2(l2 * sin, l1 + l2 * cos);
        Ok([shoulder, elbow, z - self.params.height, -shoulder - elbow])
    }

    /// At rest with the flange at a place, the peg hanging still from it.
    ///
    /// # Errors
    /// [`Invalid`] for a place that the arms do not reach.
    pub fn rest(&self, place: [f64; 3]) -> Result<State<Numbers>, Invalid> {
        let [a, b, c, d] = self.posture(place)?;
        let sag = self.peg.mass * self.params.g / self.wrist.stiffness[1];
        let height = place[2] - self.wrist.length + self.peg.centre - sag;
        Ok(State::new([a, b, c, d, place[0], place[1], height, 0.0, 0.0], [0.0; NUMBERS]))
    }

    /// Torques of the hinges, force of the slide, torque of the tool.
    ///
    /// ```text
    /// τ = M q̈_d + h + Jᵀ (K e + D ė + m_p (ẍ_d + g e_z)),   J q̈_d + J̇ q̇ = ẍ_d
    /// ```
    ///
    /// Hogan's impedance without a change of the apparent inertia, so that no force need be measured: in contact the
    /// flange is a spring K and a damper D. `None` where the arms are stretched or folded.
    #[must_use]
    pub fn torques(&self, wanted: &Wanted, q: &Numbers, v: &Numbers) -> Option<[f64; 4]> {
        let (joints, rates) = (first(q), first(v));
        let jacobian = self.scara.flange_jacobian(&joints);
        let (place, velocity) = (self.scara.flange(&joints).position, self.scara.flange_velocity(&joints, &rates));
        let [l1, l2] = self.params.length;
        // J̇ q̇ of two hinges: centripetal.
        let (sin1, cos1) = Scalar::sin_cos(joints[0]);
        let (sin2, cos2) = Scalar::sin_cos(joints[0] + joints[1]);
        let (first_rate, both) = (rates[0] * rates[0], (rates[0] + rates[1]) * (rates[0] + rates[1]));
        let x = wanted[2][0] + l1 * first_rate * cos1 + l2 * both * cos2;
        let y = wanted[2][1] + l1 * first_rate * sin1 + l2 * both * sin2;
        let [[a, b, ..], [c, d, ..], ..] = jacobian;
        let determinant = a * d - b * c;
        if determinant.abs() < 1e-3 * l1 * l2 {
            return None;
        }
        let (shoulder, elbow) = ((d * x - b * y) / determinant, (a * y - c * x) / determinant);
        let acceleration = [shoulder, elbow, wanted[2][2], -shoulder - elbow];
        let Impedance { stiffness, damping } = self.control;
        let mut force: [f64; 4] = [0.0; 4];
        for i in 0..3 {
            let weight = if i == 2 { self.params.g } else { 0.0 };
            force[i] = stiffness[i] * (wanted[0][i] - place[i])
                + damping[i] * (wanted[1][i] - velocity[i])
                + self.peg.mass * (wanted[2][i] + weight);
        }
        force[3] = -stiffness[3] * (joints[0] + joints[1] + joints[3]) - damping[3] * velocity[5];
        let own = self.scara.inverse_dynamics(&joints, &rates, &acceleration);
        Some(core::array::from_fn(|j| {
            own[j] + (0..3).map(|i| jacobian[i][j] * force[i]).sum::<f64>() + jacobian[5][j] * force[3]
        }))
    }

    /// Accelerations, under a force on the flange besides \[N\]; NaN where there are no torques, which integrators
    /// refuse.
    #[must_use]
    pub fn accelerations(&self, wanted: &Wanted, pushed: &[f64; 3], q: &Numbers, v: &Numbers) -> Numbers {
        let (joints, rates) = (first(q), first(v));
        let torques = self.torques(wanted, q, v).unwrap_or([f64::NAN; 4]);
        let (support, lost) = self.support(q, v);
        let jacobian = self.scara.flange_jacobian(&joints);
        let felt: [f64; 4] = core::array::from_fn(|j| {
            torques[j] + (0..3).map(|i| jacobian[i][j] * (pushed[i] - support.force[i])).sum::<f64>()
        });
        let [a, b, c, d] = self.scara.forward_dynamics(&joints, &rates, &felt);
        let touch = self.touch(q, v);
        let Peg { mass, inertia, .. } = self.peg;
        let x = (support.force[0] + touch.generalized[0]) / mass;
        let z = (support.force[2] + touch.generalized[1]) / mass - self.params.g;
        let turn = (support.moment + touch.generalized[2]) / inertia;
        let velocity = self.scara.flange_velocity(&joints, &rates);
        let driven = (0..4).map(|j| torques[j] * rates[j]).sum::<f64>();
        let pushing = (0..3).map(|i| pushed[i] * velocity[i]).sum::<f64>();
        [a, b, c, d, x, support.force[1] / mass, z, turn, driven + pushing - lost + touch.power]
    }

    /// What the hole does to the peg.
    #[must_use]
    pub fn touch(&self, q: &Numbers, v: &Numbers) -> Forces {
        let motion = |of: &Numbers| PegMotion { centre: [of[4], of[6]], tilt: of[7] };
        self.contact.forces(&self.peg, &self.hole, &motion(q), &motion(v))
    }

    /// What the wrist does to the peg.
    #[must_use]
    pub fn wrist_force(&self, q: &Numbers, v: &Numbers) -> [f64; 3] {
        self.support(q, v).0.force
    }

    /// Energy of all of it, springs of contacts included \[J\].
    #[must_use]
    pub fn energy(&self, q: &Numbers, v: &Numbers) -> f64 {
        let (joints, rates) = (first(q), first(v));
        let Peg { mass, inertia, .. } = self.peg;
        let moving = 0.5 * mass * (v[4] * v[4] + v[5] * v[5] + v[6] * v[6]) + 0.5 * inertia * v[7] * v[7];
        let robot = self.scara.kinetic_energy(&joints, &rates) + self.scara.potential_energy(&joints);
        robot + moving + mass * self.params.g * q[6] + self.support(q, v).0.energy + self.touch(q, v).energy
    }

    /// Force of the wrist and its moment about the peg's mass centre; the power that its dampers take \[W\].
    fn support(&self, q: &Numbers, v: &Numbers) -> (Support, f64) {
        let (joints, rates) = (first(q), first(v));
        let (flange, velocity) = (self.scara.flange(&joints).position, self.scara.flange_velocity(&joints, &rates));
        let Wrist { stiffness, damping, centre, length } = self.wrist;
        let lever = centre - self.peg.centre;
        let (n, u) = axes(q[7]);
        // The centre of compliance of the peg and, on the flange, where it belongs.
        let drop = [0.0, 0.0, length - centre];
        let place = [q[4] + lever * u[0], q[5], q[6] + lever * u[1]];
        let rate = [v[4] + lever * v[7] * n[0], v[5], v[6] + lever * v[7] * n[1]];
        let (mut force, mut energy, mut lost) = ([0.0; 3], 0.5 * stiffness[2] * q[7] * q[7], damping[2] * v[7] * v[7]);
        for i in 0..3 {
            let kind = usize::from(i == 2);
            let (stretch, speed) = (flange[i] - drop[i] - place[i], velocity[i] - rate[i]);
            force[i] = stiffness[kind] * stretch + damping[kind] * speed;
            energy += 0.5 * stiffness[kind] * stretch * stretch;
            lost += damping[kind] * speed * speed;
        }
        let moment = lever * (force[0] * n[0] + force[2] * n[1]) - stiffness[2] * q[7] - damping[2] * v[7];
        (Support { force, moment, energy }, lost)
    }
}

struct Support {
    force: [f64; 3],
    moment: f64,
    energy: f64,
}

fn first(numbers: &Numbers) -> [f64; 4] {
    [numbers[0], numbers[1], numbers[2], numbers[3]]
}
