//! The arm under computed torque with a wrong model, and under adaptive control.

use mbs_arm::adaptive::Unknown;
use mbs_arm::inertial::{flat, links};
use mbs_arm::trajectory::{JointState, Motion};
use mbs_arm::{JointLimits, JointVector};
use mbs_examples::Failure;
use mbs_models::arm6_params::Arm6Params;
use mbs_models::irb7600::Params;
use mbs_runtime::control::{AdaptiveControl, BaseParameters, BodyParameters, ComputedTorque};

use crate::motion::{sines, there_and_back};
use crate::run::{Loop, Run, Seen, first, simulate};

/// What the flange carries: mass \[kg\], centre in the flange's frame \[m\], sides of a uniform box \[m\].
pub(crate) const PAYLOAD_MASS: f64 = 300.0;
const PAYLOAD_CENTER: [f64; 3] = [0.1, -0.05, 0.3];
const PAYLOAD_SIZE: [f64; 3] = [0.8, 0.6, 0.5];
/// Of computed torque, critically damped \[rad/s\].
const NATURAL_FREQUENCY: f64 = 10.0;
/// Γ of a mass \[kg²/J\], a first moment \[kg²·m²/J\], a moment of inertia \[kg²·m⁴/J\].
const ADAPTATION: [f64; 3] = [100.0, 30.0, 100.0];
/// How much heavier all links are than a controller thinks that knows none of them.
const LINK_EXCESS: f64 = 0.2;
/// Errors count at the beginning and at the end of a motion for so long \[s\].
const WINDOW: f64 = 10.0;
/// The states whose regressors tell what an arm can tell.
const STATES: u32 = 60;
/// A column of length 1 that is shorter than this across the others tells nothing.
pub(crate) const RANK_TOLERANCE: f64 = 1e-9;

/// What comes of all of it.
pub(crate) struct Study {
    /// The arm's sixty numbers, payload included.
    pub(crate) truth: [f64; 60],
    /// Which of them there are to tell.
    pub(crate) base: BaseParameters<60>,
    /// Table 2 there and back, then sines.
    pub(crate) payload: [Comparison<10>; 2],
    /// Sines, with all links unknown.
    pub(crate) links: Comparison<60>,
}

/// One motion under several controllers.
pub(crate) struct Comparison<const P: usize> {
    pub(crate) motion: &'static str,
    pub(crate) duration: f64,
    /// Errors count at the beginning and at the end of a motion for so long \[s\].
    pub(crate) window: f64,
    pub(crate) initial: [f64; P],
    pub(crate) truth: [f64; P],
    /// What this motion tells of these parameters.
    pub(crate) told: BaseParameters<P>,
    pub(crate) wrong: Run,
    pub(crate) right: Run,
    pub(crate) adaptive: Run,
}

fn payload() -> BodyParameters {
    let [x, y, z] = PAYLOAD_SIZE.map(|side| PAYLOAD_MASS * side * side / 12.0);
    BodyParameters::about_center(PAYLOAD_MASS, PAYLOAD_CENTER, [y + z, x + z, x + y, 0.0, 0.0, 0.0])
}

/// All runs of the arm.
pub(crate) fn study() -> Result<Study, Failure> {
    let params = Params::default();
    let bare = links(&params);
    let mut loaded = bare;
    loaded[5] = bare[5].plus(&payload());
    let (of_payload, of_links) = (Unknown::last_link(&params), Unknown::all_links(&params));
    let (initial, truth) = (bare[5].to_array(), loaded[5].to_array());
    let all = flat(&loaded);
    let thought = all.map(|number| number / (1.0 + LINK_EXCESS));
    let (payload, links) = rayon::join(
        || -> Result<_, Failure> {
            let table_2 = compare("table_2_there_and_back", &there_and_back()?, &of_payload, initial, truth)?;
            Ok([table_2, compare("sines", &sines(), &of_payload, initial, truth)?])
        },
        || compare("sines", &sines(), &of_links, thought, all),
    );
    let (payload, links) = (payload?, links?);
    Ok(Study { truth: all, base: of_links.base(STATES, RANK_TOLERANCE)?, payload, links })
}

fn compare<const P: usize>(
    name: &'static str,
    motion: &dyn Motion<6>,
    family: &Unknown<P>,
    initial: [f64; P],
    truth: [f64; P],
) -> Result<Comparison<P>, Failure> {
    let (duration, start) = (motion.duration(), motion.at(0.0)?);
    let plant = family.arm(&truth);
    let followed = Followed { motion, plant: &plant };
    let computed = |model: Arm6Params<f64>| -> Result<Run, Failure> {
        let control = ComputedTorque::critically_damped(NATURAL_FREQUENCY)?;
        simulate(&Computed { followed, control, model }, start.q, start.qd.to_vec(), duration)
    };
    // As stiff and as damped as computed torque is at the beginning, with the inertias that it believes in.
    let mass_matrix = family.arm(&initial).mass_matrix(&start.q);
    let damping = std::array::from_fn(|i| 2.0 * NATURAL_FREQUENCY * mass_matrix[i][i]);
    let gains = std::array::from_fn(|k| match k % 10 {
        0 => ADAPTATION[0],
        1..=3 => ADAPTATION[1],
        _ => ADAPTATION[2],
    });
    let control = AdaptiveControl::new([0.5 * NATURAL_FREQUENCY; 6], damping, gains)?;
    let velocities = [&start.qd[..], &initial, &[0.0]].concat();
    let adaptive = Adaptive { followed, family, control, truth };
    Ok(Comparison {
        motion: name,
        duration,
        window: WINDOW,
        initial,
        truth,
        told: family.told(motion, RANK_TOLERANCE)?,
        wrong: computed(family.arm(&initial))?,
        right: computed(plant)?,
        adaptive: simulate(&adaptive, start.q, velocities, duration)?,
    })
}

/// An arm and what it is to do.
#[derive(Clone, Copy)]
struct Followed<'a> {
    motion: &'a dyn Motion<6>,
    plant: &'a Arm6Params<f64>,
}

impl Followed<'_> {
    /// What is wanted; not a number where there is nothing, which the integrator refuses.
    fn reference(&self, t: f64) -> [JointVector; 3] {
        self.motion.held_at(t).map_or([[f64::NAN; 6]; 3], |JointState { q, qd, qdd }| [q, qd, qdd])
    }

    /// The distance of the flange from where it is to be \[m\].
    fn error(&self, t: f64, q: &JointVector) -> f64 {
        let (is, wanted) = (self.plant.flange(q).position, self.plant.flange(&self.reference(t)[0]).position);
        (0..3).map(|i| (is[i] - wanted[i]).powi(2)).sum::<f64>().sqrt()
    }
}

struct Computed<'a> {
    followed: Followed<'a>,
    control: ComputedTorque<6>,
    model: Arm6Params<f64>,
}

impl Computed<'_> {
    fn torques(&self, t: f64, q: &JointVector, qd: &JointVector) -> JointVector {
        self.model.inverse_dynamics(q, qd, &self.control.acceleration(&self.followed.reference(t), q, qd))
    }
}

impl Loop for Computed<'_> {
    fn rates(&self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]) {
        let (q, qd) = (first(q), first(v));
        a.copy_from_slice(&self.followed.plant.forward_dynamics(&q, &qd, &self.torques(t, &q, &qd)));
    }

    fn look(&self, t: f64, q: &[f64], v: &[f64]) -> Seen {
        let (q, qd) = (first(q), first(v));
        let (error, forces) = (self.followed.error(t, &q), self.torques(t, &q, &qd).to_vec());
        Seen { error, forces, limited: false, estimate: vec![], lyapunov: 0.0, spent: 0.0 }
    }
}

struct Adaptive<'a, const P: usize> {
    followed: Followed<'a>,
    family: &'a Unknown<P>,
    control: AdaptiveControl<6, P>,
    truth: [f64; P],
}

impl<const P: usize> Adaptive<'_, P> {
    /// The torques, `s`, and the rates of the estimate.
    fn act(&self, t: f64, q: &JointVector, v: &[f64]) -> (JointVector, JointVector, [f64; P]) {
        let (qd, estimate) = (first(v), first(&v[6..]));
        self.family.act(&self.control, &self.followed.reference(t), [q, &qd], &estimate)
    }
}

impl<const P: usize> Loop for Adaptive<'_, P> {
    fn rates(&self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]) {
        let (q, qd) = (first(q), first(v));
        let (torques, error, rates) = self.act(t, &q, v);
        a[..6].copy_from_slice(&self.followed.plant.forward_dynamics(&q, &qd, &torques));
        a[6..6 + P].copy_from_slice(&rates);
        a[6 + P] = -self.control.lyapunov_rate(&error);
    }

    fn look(&self, t: f64, q: &[f64], v: &[f64]) -> Seen {
        let q = first(q);
        let (torques, error, _) = self.act(t, &q, v);
        let estimate: [f64; P] = first(&v[6..]);
        let mistake = std::array::from_fn(|k| estimate[k] - self.truth[k]);
        Seen {
            error: self.followed.error(t, &q),
            forces: torques.to_vec(),
            limited: false,
            estimate: estimate.to_vec(),
            lyapunov: self.control.lyapunov(&self.followed.plant.mass_matrix(&q), &error, &mistake),
            spent: v[6 + P],
        }
    }
}

/// The largest torque of a run, as a part of what the drives are assumed to give.
pub(crate) fn torque_ratio(run: &Run) -> f64 {
    let limits = JointLimits::IRB7600.torque;
    (0..6).map(|joint| run.greatest_force(joint) / limits[joint]).fold(0.0, f64::max)
}
