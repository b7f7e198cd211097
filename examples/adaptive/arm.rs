//! The arm under computed torque with a wrong model, and under adaptive control.

use mbs_arm::inertial::{self, MASSES_ALONE, flat, links, parts};
use mbs_arm::trajectory::{JointState, Motion};
use mbs_arm::{JointLimits, JointVector};
use mbs_examples::Failure;
use mbs_models::arm6_params::Arm6Params;
use mbs_models::irb7600::Params;
use mbs_runtime::control::{
    AdaptiveControl, BaseParameters, BodyParameters, ComputedTorque, RegressorStack, Sliding, regressor,
};

use crate::motion::{Sines, ThereAndBack};
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

/// An arm of which P numbers are unknown.
struct Family<const P: usize> {
    g: f64,
    /// The links, the unknown numbers left out.
    known: Option<[BodyParameters; 6]>,
    /// What the unknown numbers are the links of.
    unknown: fn(&[f64; P]) -> [BodyParameters; 6],
    /// Unknown numbers that an arm can have.
    probe: [f64; P],
}

impl<const P: usize> Family<P> {
    /// The whole arm.
    fn arm(&self, numbers: &[f64; P]) -> Arm6Params<f64> {
        let unknown = (self.unknown)(numbers);
        let links = match &self.known {
            Some(known) => std::array::from_fn(|i| known[i].plus(&unknown[i])),
            None => unknown,
        };
        inertial::model(&links, self.g)
    }

    /// Y of the unknown numbers.
    fn regressor(&self, sliding: &Sliding<6>, q: &JointVector, qd: &JointVector) -> [[f64; P]; 6] {
        let forces =
            |numbers: &[f64; P]| sliding.forces_of(&inertial::model(&(self.unknown)(numbers), self.g), 0.0, q, qd);
        regressor(forces, &self.probe)
    }
}

/// The numbers of the last link alone.
fn last_link(numbers: &[f64; 10]) -> [BodyParameters; 6] {
    let mut links = [BodyParameters::default(); 6];
    links[5] = BodyParameters::from_array(numbers);
    links
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
    let mut others = bare;
    others[5] = BodyParameters::default();

    let of_payload = Family { g: params.g, known: Some(others), unknown: last_link, probe: last_link_probe() };
    let (initial, truth) = (bare[5].to_array(), loaded[5].to_array());
    let of_links = Family { g: params.g, known: None, unknown: parts, probe: MASSES_ALONE };
    let all = flat(&loaded);
    let thought = all.map(|number| number / (1.0 + LINK_EXCESS));
    let (payload, links) = rayon::join(
        || -> Result<_, Failure> {
            let table_2 = compare("table_2_there_and_back", &ThereAndBack::new()?, &of_payload, initial, truth)?;
            Ok([table_2, compare("sines", &Sines, &of_payload, initial, truth)?])
        },
        || compare("sines", &Sines, &of_links, thought, all),
    );
    let (payload, links) = (payload?, links?);
    Ok(Study { truth: all, base: base(&of_links)?, payload, links })
}

fn last_link_probe() -> [f64; 10] {
    BodyParameters { mass: 1.0, ..BodyParameters::default() }.to_array()
}

/// What regressors at many states tell, which no motion has to connect.
fn base(family: &Family<60>) -> Result<BaseParameters<60>, Failure> {
    let mut stack = RegressorStack::default();
    for state in 0..STATES {
        // Numbers without a pattern between −2 and 2: the steps are multiples of the golden mean.
        let number = |k: u32| 4.0 * (f64::from(18 * state + k) * 0.618_033_988_749_895).fract() - 2.0;
        let of = |from: u32| std::array::from_fn(|i| number(from + i as u32));
        let (q, qd) = (of(0), of(6));
        stack.add(&family.regressor(&Sliding { error: [0.0; 6], qd, qdd: of(12) }, &q, &qd));
    }
    Ok(stack.base(RANK_TOLERANCE)?)
}

fn compare<const P: usize>(
    name: &'static str,
    motion: &dyn Motion<6>,
    family: &Family<P>,
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
    let known = family.known.map(|links| inertial::model(&links, family.g));
    let velocities = [&start.qd[..], &initial, &[0.0]].concat();
    let adaptive = Adaptive { followed, family, known, control, truth };
    Ok(Comparison {
        motion: name,
        duration,
        window: WINDOW,
        initial,
        truth,
        told: told(family, motion)?,
        wrong: computed(family.arm(&initial))?,
        right: computed(plant)?,
        adaptive: simulate(&adaptive, start.q, velocities, duration)?,
    })
}

/// What a motion shows that is followed exactly, looked at ten times a second.
fn told<const P: usize>(family: &Family<P>, motion: &dyn Motion<6>) -> Result<BaseParameters<P>, Failure> {
    let mut stack = RegressorStack::default();
    for k in 0..(10.0 * motion.duration()) as u32 {
        let JointState { q, qd, qdd } = motion.at(0.1 * f64::from(k))?;
        stack.add(&family.regressor(&Sliding { error: [0.0; 6], qd, qdd }, &q, &qd));
    }
    Ok(stack.base(RANK_TOLERANCE)?)
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
    family: &'a Family<P>,
    known: Option<Arm6Params<f64>>,
    control: AdaptiveControl<6, P>,
    truth: [f64; P],
}

impl<const P: usize> Adaptive<'_, P> {
    /// The torques, `s`, and the rates of the estimate.
    fn act(&self, t: f64, q: &JointVector, v: &[f64]) -> (JointVector, JointVector, [f64; P]) {
        let (qd, estimate) = (first(v), first(&v[6..]));
        let sliding = self.control.sliding(&self.followed.reference(t), q, &qd);
        let y = self.family.regressor(&sliding, q, &qd);
        let known = self.known.as_ref().map_or([0.0; 6], |known| sliding.forces_of(known, 0.0, q, &qd));
        let learnt = self.control.forces(&y, &estimate, &sliding.error);
        let torques = std::array::from_fn(|i| known[i] + learnt[i]);
        (torques, sliding.error, self.control.estimate_rate(&y, &sliding.error))
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
