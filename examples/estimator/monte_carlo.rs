//! Many landings on estimates, each with a start, biases and noise of its own, and the same starts on the true state.

use mbs_examples::Failure;
use mbs_examples::quadrotor_landing::flight::{PLACE, heaving};
use mbs_examples::quadrotor_landing::members;
use mbs_landing::estimator::filter::{Filter, Innovation, Uncertainty};
use mbs_landing::estimator::nominal::{ERRORS, Nominal};
use mbs_landing::quadrotor::estimated::{EstimatedMoment, inertial_state, vehicle_state};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::Landing;
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_landing::sensors::Sensors;
use mbs_landing::sensors::imu::{Biases, ImuSample};
use mbs_models::Error;
use nalgebra::{SVector, Vector3};

/// Consistency is looked at twice a second: these are the intervals of the IMU and the images between two looks.
pub(crate) const LOOK: f64 = 0.5;

/// The middle of the deck at its mean height, which errors of the attitude turn the vehicle about.
pub(crate) const ORIGIN: Vector3<f64> = Vector3::new(PLACE[0], PLACE[1], 0.0);

/// What a landing shows of its estimator, at every look until its touchdown.
pub(crate) struct Run {
    /// Normalized estimation error squared.
    pub(crate) state: Vec<f64>,
    /// Normalized innovations squared of ranges and of images; none where there was none.
    pub(crate) range: Vec<Option<Innovation>>,
    pub(crate) image: Vec<Option<Innovation>>,
    /// Squares of the errors over the variances that the filter states, summed over all looks, for each error.
    pub(crate) squares: SVector<f64, ERRORS>,
    /// Measurements that were not believed, of all.
    pub(crate) refused: usize,
    pub(crate) measured: usize,
    /// The error of the estimated place of the IMU when the controller acted last \[m\].
    pub(crate) last_error: Vector3<f64>,
    /// On the estimate, and on the true state from the same start.
    pub(crate) estimated: Touchdown,
    pub(crate) exact: Touchdown,
}

/// The filter that every landing begins with: where the vehicle is said to be, and how sure that is.
pub(crate) fn first_filter(sensors: &Sensors) -> (Filter, SVector<f64, ERRORS>) {
    let said = inertial_state(&Landing::initial_state(), sensors, Biases::default());
    let deviations = Uncertainty::START.deviations(&sensors.imu);
    (Filter::new(&sensors.imu, said, ORIGIN, &deviations), deviations)
}

/// A landing on the estimate, seen by an observer; before it the same start on the true state.
pub(crate) fn flown(
    heave: Heave<4>,
    seed: u64,
    observer: impl FnMut(&EstimatedMoment<'_>),
) -> Result<[Touchdown; 2], Error> {
    let sensors = Sensors::TYPICAL;
    let landing = Landing::on(mbs_landing::quadrotor::landing::Plant::Exact, heaving(heave));
    let mut normal = members::deviates(seed);
    let (filter, deviations) = first_filter(&sensors);
    let errors = deviations.map(|deviation| deviation * normal());
    let truth: Nominal = filter.estimate.nominal.with(&errors, &ORIGIN);
    // The vehicle begins without turning: its gyroscopes say their biases.
    let still = ImuSample { rate: truth.biases.gyro, specific_force: Vector3::zeros() };
    let start = vehicle_state(&truth, &still, &sensors);
    let exact = landing.simulate_sampled(start, sensors.imu.interval, |_, state| *state)?;
    let estimated = landing.simulate_estimated(start, &sensors, truth.biases, filter, normal, observer)?;
    Ok([estimated, exact])
}

/// One landing, and how consistent its estimator was.
fn run(heave: Heave<4>, seed: u64) -> Result<Run, Error> {
    let (mut state, mut range, mut image) = (Vec::new(), Vec::new(), Vec::new());
    let (mut refused, mut measured) = (0, 0);
    let (mut squares, mut last_error) = (SVector::zeros(), Vector3::zeros());
    let mut looks = 0.0;
    // An image is told of 80 ms after its moment: of each look the last one that was told of until then.
    let mut told = None;
    let [estimated, exact] = flown(heave, seed, |moment| {
        for innovation in moment.range.into_iter().chain(moment.image.map(|(_, seen)| seen)) {
            measured += 1;
            refused += usize::from(!innovation.accepted);
        }
        told = moment.image.map(|(_, seen)| seen).or(told);
        last_error = moment.truth.pose.place - moment.filter.estimate.nominal.pose.place;
        if moment.time + 1e-9 < LOOK * looks {
            return;
        }
        looks += 1.0;
        let errors = moment.filter.estimate.nominal.errors(moment.truth, &ORIGIN);
        state.push(moment.filter.normalized_error(moment.truth));
        squares += errors.component_mul(&errors).component_div(&moment.filter.state_covariance().diagonal());
        range.push(moment.range);
        image.push(told.take());
    })?;
    Ok(Run { state, range, image, squares, refused, measured, last_error, estimated, exact })
}

/// Landings of a case with the seeds 0, 1, ….
pub(crate) fn runs(heave: Heave<4>, count: u32) -> Result<Vec<Run>, Failure> {
    Ok(members::flown(count, |seed| run(heave, seed)).into_iter().collect::<Result<_, Error>>()?)
}
