//! Rendezvous and docking: every part against what it should do by itself, and whole missions with good and bad
//! thrusters.

use std::f64::consts::PI;

use mbs_models::check::{Invalid, Must};
use mbs_models::{At, Error, Failure};
use mbs_orbit::clohessy_wiltshire::IN_PLANE;
use mbs_orbit::elements::Elements;
use mbs_orbit::kepler::propagate;
use mbs_orbit::lvlh::{Frame, RelativeMotion, relative_motion};
use mbs_orbit::mission::coast::Attraction;
use mbs_orbit::mission::glideslope::Glideslope;
use mbs_orbit::mission::phasing::{Method, Phasing};
use mbs_orbit::mission::safety::Zone;
use mbs_orbit::mission::{Axis, LinearModel, Mission, Phase, Report, STATION_ATTRACTION};
use mbs_orbit::vector::StateVector;
use mbs_orbit::{EARTH_MU, EARTH_RADIUS};
use mbs_tests::random::Random;
use nalgebra::Vector3;

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (Vector3::from(*a) - Vector3::from(*b)).norm()
}

fn norm(a: &[f64; 3]) -> f64 {
    Vector3::from(*a).norm()
}

/// On a circle in the plane z = 0, or inclined to it.
fn circle(altitude: f64, degrees: f64, inclination: f64) -> StateVector {
    let elements = Elements {
        semi_latus_rectum: EARTH_RADIUS + altitude,
        eccentricity: 0.0,
        inclination: inclination.to_radians(),
        ascending_node: 0.0,
        argument_of_periapsis: 0.0,
        true_anomaly: degrees.to_radians(),
    };
    elements.to_state(EARTH_MU).unwrap()
}

fn flown(mission: &Mission) -> Report {
    mission.fly(|burn| burn.delta_v, |_| {}).unwrap()
}

#[test]
fn both_axes_lead_to_the_port() {
    for axis in [Axis::VBar, Axis::RBar] {
        let mission = Mission::to_the_station(axis);
        let mut burns = Vec::new();
        let mut moments = Vec::new();
        let report = mission
            .fly(
                |burn| {
                    burns.push(*burn);
                    burn.delta_v
                },
                |moment| moments.push(*moment),
            )
            .unwrap();
        // What the linear model neglects, over the last 20 s and a few metres.
        assert!(report.port_position_error() < 1e-6, "{axis:?}: {}", report.port_position_error());
        close(report.port_velocity(), 0.05, 2e-3);
        let along: f64 = (0..3).map(|i| -report.contact.velocity[i] * axis.outward()[i]).sum();
        close(along, 0.05, 1e-3);
        assert_eq!((report.keep_out_violations, report.corridor_violations), (0, 0));

        // The budget is the sum of the burns that the thrusters were told.
        for phase in Phase::ALL {
            let of_phase: Vec<f64> = burns.iter().filter(|b| b.phase == phase).map(|b| norm(&b.delta_v)).collect();
            let found = &report.phases[phase as usize];
            assert_eq!(found.burns as usize, of_phase.len(), "{phase:?}");
            close(found.delta_v, of_phase.iter().sum(), 1e-12);
        }
        close(report.total_delta_v(), burns.iter().map(|b| norm(&b.delta_v)).sum(), 1e-10);
        assert!((55.0..80.0).contains(&report.total_delta_v()), "{}", report.total_delta_v());

        // The observer sees all of it, and what it sees are the zones.
        for pair in moments.windows(2) {
            let step = pair[1].time - pair[0].time;
            assert!(step > 0.0 && step <= 20.0 + 1e-9, "{step}: {pair:?}");
        }
        close(moments.last().unwrap().time, report.duration(), 1e-6);
        let zones = mission.zones();
        for moment in &moments {
            let place = &moment.relative.position;
            assert_eq!(moment.zone, zones.of(place));
            assert!(moment.zone != Zone::KeepOut);
            if matches!(moment.phase, Phase::Approach | Phase::Docking) {
                let (along, beside) = zones.from_port(place);
                assert!(beside <= 0.5 + along * 10_f64.to_radians().tan(), "{moment:?}");
            }
        }
        // Where phases end.
        let end = |phase: Phase| report.phases[phase as usize].end.position;
        assert!(distance(&end(Phase::Homing), &mission.homing_end) < 1.0);
        let gate = axis.outward().map(|x| 265.0 * x);
        assert!(distance(&end(Phase::Closing), &gate) < 0.5);
        let standoff = axis.outward().map(|x| 20.0 * x);
        assert!(distance(&end(Phase::Approach), &standoff) < 1e-5);
        for phase in [Phase::Homing, Phase::Closing] {
            // Without another burn it would not come into the sphere.
            assert!(report.phases[phase as usize].drift_clearance.unwrap() > 200.0, "{axis:?} {phase:?}");
        }
    }
}

/// Thrusters with errors of size and direction, other ones every burn: corrections keep it on its way.
#[test]
fn bad_thrusters_cost_fuel_and_accuracy_but_dock() {
    let perfect = flown(&Mission::to_the_station(Axis::VBar));
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let thrust = |burn: &mbs_orbit::mission::Burn| {
            let size = norm(&burn.delta_v);
            let error: [f64; 3] = std::array::from_fn(|_| size * random.uniform(-0.02..0.02));
            std::array::from_fn(|i| burn.delta_v[i] + error[i])
        };
        let report = Mission::to_the_station(Axis::VBar).fly(thrust, |_| {}).unwrap();
        assert!(report.port_position_error() < 5e-3, "{}", report.port_position_error());
        assert!(report.port_position_error() > 10.0 * perfect.port_position_error());
        close(report.port_velocity(), 0.05, 5e-3);
        assert!(report.total_delta_v() < 1.1 * perfect.total_delta_v(), "{}", report.total_delta_v());
        assert_eq!((report.keep_out_violations, report.corridor_violations), (0, 0));
    }
}

#[test]
fn corrections_make_up_for_what_the_linear_model_neglects() {
    let with = |corrections| {
        let mission = Mission { corrections, ..Mission::to_the_station(Axis::VBar) };
        let report = flown(&mission);
        let miss = |phase: Phase, to: [f64; 3]| distance(&report.phases[phase as usize].end.position, &to);
        (miss(Phase::Homing, mission.homing_end), report)
    };
    // (28 km)²/2r is 58 m; two bodies fall apart by some times that in half a revolution.
    let (without, report) = with(0);
    assert!((100.0..2000.0).contains(&without), "{without}");
    assert_eq!(report.phases[1].burns, 1);
    let misses = [1, 2, 3, 6].map(|corrections| with(corrections).0);
    assert!(misses[0] < 0.3 * without && misses[1] < 0.3 * misses[0] && misses[3] < misses[1], "{misses:?}");
}

#[test]
fn the_attraction_of_the_station_is_felt_and_corrected() {
    let mut mission = Mission::to_the_station(Axis::RBar);
    let without = flown(&mission);
    mission.attraction.station = STATION_ATTRACTION;
    let with = flown(&mission);
    assert!(with.port_position_error() < 1e-4 && with.port_position_error() > 2.0 * without.port_position_error());
    let change = distance(&with.contact.velocity, &without.contact.velocity);
    assert!((1e-7..1e-4).contains(&change), "{change}");
    assert_eq!(with.keep_out_violations, 0);
}

/// `relative_with_station_mass` of `orbit_relative.py`; without mass, two Kepler motions.
#[test]
fn coasts_are_those_of_the_reference() {
    let data: serde_json::Value = serde_json::from_str(include_str!("../data/orbit_relative.json")).unwrap();
    let station = circle(400e3, 30.0, 40.0);
    let samples = data["relative_with_station_mass"].as_array().unwrap();
    assert!(samples.len() >= 6);
    let triple = |value: &serde_json::Value| -> [f64; 3] { std::array::from_fn(|i| value[i].as_f64().unwrap()) };
    for sample in samples {
        let case = &data["relative_circular"][sample["case"].as_str().unwrap()]["initial_lvlh_km_km_s"];
        let start = StateVector::from_array(std::array::from_fn(|i| 1e3 * case[i].as_f64().unwrap()));
        let motion = RelativeMotion { station, relative: start };
        let time = sample["t_s"].as_f64().unwrap();
        let attraction = Attraction { centre: EARTH_MU, station: STATION_ATTRACTION };
        let found = attraction.coast(&motion, time).unwrap().relative;
        let error = distance(&found.position, &triple(&sample["position_m"]));
        assert!(error <= 1e-9, "{}: {error} m", sample["case"]);
        assert!(distance(&found.velocity, &triple(&sample["velocity_m_s"])) <= 1e-11);
        // With next to no mass the integration is the Kepler motion.
        let light = Attraction { station: 1e-300, ..attraction };
        let integrated = light.coast(&motion, time).unwrap().relative;
        let kepler = Attraction { station: 0.0, ..attraction }.coast(&motion, time).unwrap().relative;
        assert_eq!(kepler, relative_motion(EARTH_MU, &station, &start, time).unwrap().relative);
        let error = distance(&integrated.position, &kepler.position);
        assert!(error < 1e-9, "{}: {error} m", sample["case"]);
        assert!(distance(&found.position, &kepler.position) > 0.1);
    }
}

/// Hohmann's transfer in closed form; what Lambert's arcs find costs hardly more.
#[test]
fn phasing_between_circles_in_one_plane() {
    let (low, high) = (EARTH_RADIUS + 320e3, EARTH_RADIUS + 400e3);
    let phasing = Phasing {
        mu: EARTH_MU,
        station: circle(400e3, 0.0, 0.0),
        vehicle: circle(320e3, -18.0, 0.0),
        lag: 30e3 / (EARTH_MU / high).sqrt(),
        longest_wait: 20_000.0,
        lowest: EARTH_RADIUS + 150e3,
        tolerance: 100.0,
    };
    let a = 0.5 * (low + high);
    let speed = |r: f64| (EARTH_MU * (2.0 / r - 1.0 / a)).sqrt();
    let hohmann = speed(low) - (EARTH_MU / low).sqrt() + (EARTH_MU / high).sqrt() - speed(high);
    let plan = phasing.two_impulse().unwrap().unwrap();
    close(plan.delta_v, hohmann, 1e-9);
    close(plan.duration, PI * (a * a * a / EARTH_MU).sqrt(), 1e-9);
    assert!(plan.miss < 1e-3, "{}", plan.miss);
    // The phase: the point is as far ahead as it will not go while the vehicle goes half round.
    let [slow, fast] = [high, low].map(|r| (EARTH_MU / (r * r * r)).sqrt());
    let ahead = 18_f64.to_radians() - 30e3 / high;
    close(plan.wait, (ahead - (PI - slow * plan.duration)) / (fast - slow), 1e-3);

    let lambert = phasing.lambert().unwrap().unwrap();
    assert!(lambert.delta_v >= hohmann - 1e-9 && lambert.delta_v < 1.01 * hohmann, "{} {hohmann}", lambert.delta_v);
    let vehicle = propagate(EARTH_MU, &phasing.vehicle, lambert.wait).unwrap().state;
    let start = StateVector::new(vehicle.position, lambert.departure);
    let end = propagate(EARTH_MU, &start, lambert.duration).unwrap().state;
    let aim = phasing.aim(lambert.wait + lambert.duration).unwrap();
    assert!(distance(&end.position, &aim.position) < 1e-6);
    let burns = distance(&lambert.departure, &vehicle.velocity) + distance(&aim.velocity, &end.velocity);
    close(lambert.delta_v, burns, 1e-8);
    assert_eq!(phasing.plan().unwrap().unwrap().method, Method::TwoImpulse);

    // Out of the plane half an ellipse misses the point, and an arc does not.
    let inclined = Phasing { vehicle: circle(320e3, -18.0, 0.2), ..phasing };
    let plan = inclined.plan().unwrap().unwrap();
    assert_eq!((plan.method, plan.miss), (Method::Lambert, 0.0));
    assert!(inclined.two_impulse().unwrap().unwrap().miss > 100.0);
    // Neither may go lower than allowed.
    assert_eq!(Phasing { lowest: EARTH_RADIUS + 350e3, ..inclined }.plan(), Ok(None));
}

#[test]
fn glideslopes_obey_their_equation() {
    for (length, first, last) in [(245.0, 0.8, 0.05), (100.0, 0.05, 0.8), (10.0, 0.1, 0.1), (10.0, 0.1, 0.100_001)] {
        let slope = Glideslope::new(length, first, last).unwrap();
        let duration = slope.duration();
        close(slope.distance(0.0), length, 0.0);
        close(slope.distance(duration), 0.0, 1e-11 * length);
        let h = 1e-4 * duration;
        for part in [0.1, 0.4, 0.9] {
            let t = part * duration;
            let rate = (slope.distance(t + h) - slope.distance(t - h)) / (2.0 * h);
            close(rate, slope.rate() * slope.distance(t) - last, 1e-6 * first.max(last));
        }
        let speed = |t: f64| (slope.distance(t - 1e-3) - slope.distance(t + 1e-3)) / 2e-3;
        close(speed(1e-3), first, 1e-4 * first);
        close(speed(duration - 1e-3), last, 1e-4 * first.max(last));
    }
    // From a slope to a straight line of steady speed nothing jumps.
    let [one, other] = [1e-5, 9e-4].map(|x| Glideslope::new(10.0, 0.1, 0.1 * (1.0 + x)).unwrap());
    close(one.duration(), 100.0 * (1.0 - 0.5e-5), 1e-8);
    close(other.duration(), 100.0 * (9e-4_f64).ln_1p() / 9e-4, 1e-9);
    let expected = Must::BePositive.broken_by("last_speed", 0.0).into();
    assert_eq!(Glideslope::new(1.0, 1.0, 0.0), Err(expected));
    assert!(Glideslope::new(f64::NAN, 1.0, 1.0).is_err());
}

/// Past the station from ahead of it: through the sphere, and seen.
#[test]
fn ways_through_the_sphere_are_counted() {
    let mission = Mission { homing_end: [0.0, 2e3, 0.0], ..Mission::to_the_station(Axis::VBar) };
    let mut zones = Vec::new();
    let mut nearest = f64::INFINITY;
    let mission = Mission { closing_duration: 600.0, ..mission };
    let report = mission
        .fly(
            |burn| burn.delta_v,
            |moment| {
                zones.push(moment.zone);
                if matches!(moment.phase, Phase::Homing | Phase::Closing) {
                    nearest = f64::min(nearest, norm(&moment.relative.position));
                }
            },
        )
        .unwrap();
    assert!(nearest < 200.0, "{nearest}");
    let entries = zones.windows(2).filter(|pair| pair[0] != Zone::KeepOut && pair[1] == Zone::KeepOut).count();
    assert!(entries > 0);
    assert_eq!(report.keep_out_violations as usize, entries);
    // A corridor too narrow for the way between two pulses is left.
    let narrow = Mission {
        corridor_half_angle: 1e-4,
        corridor_mouth: 0.0,
        approach_pulses: 3,
        ..Mission::to_the_station(Axis::VBar)
    };
    assert!(flown(&narrow).corridor_violations > 0);
}

#[test]
fn zones() {
    let zones = Mission::to_the_station(Axis::RBar).zones();
    let tan = 10_f64.to_radians().tan();
    for (place, zone) in [
        ([-300.0, 0.0, 0.0], Zone::Outside),
        ([0.0, 200.0, 0.0], Zone::Outside),
        ([0.0, 199.9, 0.0], Zone::KeepOut),
        ([-100.0, 0.0, 0.0], Zone::Corridor),
        ([-100.0, 0.0, 0.49 + 85.0 * tan], Zone::Corridor),
        ([-100.0, 0.0, 0.51 + 85.0 * tan], Zone::KeepOut),
        ([-15.0, 0.4, 0.0], Zone::Corridor),
        ([-14.0, 0.0, 0.0], Zone::KeepOut),
        ([100.0, 0.0, 0.0], Zone::KeepOut),
        ([f64::NAN, 0.0, 0.0], Zone::KeepOut),
    ] {
        assert_eq!(zones.of(&place), zone, "{place:?}");
    }
}

/// On an ellipse with e = 0.1 the equations for a circle plan badly, Yamanaka and Ankersen's do not.
#[test]
fn a_station_on_an_ellipse() {
    let orbit = |a: f64, e: f64, degrees: f64| {
        let elements = Elements {
            semi_latus_rectum: a * (1.0 - e * e),
            eccentricity: e,
            inclination: 0.9,
            ascending_node: 1.0,
            argument_of_periapsis: 2.0,
            true_anomaly: f64::to_radians(degrees),
        };
        elements.to_state(EARTH_MU).unwrap()
    };
    let mission = Mission {
        station: orbit(7500e3, 0.1, 0.0),
        vehicle: orbit(7400e3, 0.095, -12.0),
        model: LinearModel::YamanakaAnkersen,
        ..Mission::to_the_station(Axis::VBar)
    };
    let good = flown(&mission);
    assert!(good.port_position_error() < 1e-6, "{}", good.port_position_error());
    assert_eq!((good.keep_out_violations, good.corridor_violations), (0, 0));
    assert_eq!(good.plan.method, Method::Lambert);
    let circular = flown(&Mission { model: LinearModel::ClohessyWiltshire, corrections: 0, ..mission });
    let fitting = flown(&Mission { corrections: 0, ..mission });
    let miss = |report: &Report| distance(&report.phases[2].end.position, &[0.0, -265.0, 0.0]);
    assert!(miss(&circular) > 10.0 * miss(&fitting), "{} {}", miss(&circular), miss(&fitting));
}

#[test]
fn orbits_through_the_surface_earn_a_warning() {
    let mission = Mission::to_the_station(Axis::VBar);
    assert_eq!(mission.warnings().unwrap(), Default::default());
    let below = Mission { station: circle(-10e3, 0.0, 0.0), ..mission };
    let warnings = below.warnings().unwrap();
    close(warnings.station_below_surface.unwrap(), -10e3, 1e-6);
    assert_eq!(warnings.vehicle_below_surface, None);
    let mut vehicle = circle(300e3, 0.0, 0.0);
    vehicle.velocity = vehicle.velocity.map(|v| 0.9 * v);
    let warnings = Mission { vehicle, ..mission }.warnings().unwrap();
    assert!(warnings.vehicle_below_surface.unwrap() < -1e5);
}

#[test]
fn bad_input_is_refused_with_its_value() {
    let good = Mission::to_the_station(Axis::VBar);
    let error = |mission: Mission| mission.fly(|burn| burn.delta_v, |_| {}).unwrap_err();
    for value in [0.0, -1.0, f64::INFINITY] {
        let expected = Must::BePositive.broken_by("homing_duration", value).into();
        assert_eq!(error(Mission { homing_duration: value, ..good }), expected);
    }
    let expected = Must::NotBeNegative.broken_by("attraction.station", -1.0).into();
    assert_eq!(error(Mission { attraction: Attraction { station: -1.0, ..good.attraction }, ..good }), expected);
    assert!(matches!(
        error(Mission { approach_distance: f64::NAN, ..good }),
        Error { failure: Failure::Invalid(Invalid { parameter: "approach_distance", value, .. }), .. } if value.is_nan()
    ));
    let parameter = "approach_distance - docking_distance";
    let expected = Must::BePositive.broken_by(parameter, -50.0).into();
    assert_eq!(error(Mission { docking_distance: 300.0, ..good }), expected);
    assert!(matches!(
        error(Mission { homing_end: [f64::NAN, 0.0, 0.0], ..good }),
        Error { failure: Failure::Invalid(Invalid { parameter: "distance of homing_end", .. }), .. }
    ));
    assert!(matches!(
        error(Mission { approach_pulses: 0, ..good }),
        Error { failure: Failure::Invalid(Invalid { parameter: "approach_pulses", value: 0.0, .. }), .. }
    ));

    let straight = StateVector::new(good.station.position, [0.0; 3]);
    let open = Failure::Undetermined("the orbital plane of a motion along a straight line");
    assert_eq!(error(Mission { station: straight, ..good }), open.into());
    let nan = StateVector::new([f64::NAN; 3], [0.0; 3]);
    assert!(matches!(
        error(Mission { vehicle: nan, ..good }),
        Error { failure: Failure::Invalid(Invalid { parameter: "position", must: Must::BeFinite, .. }), .. }
    ));
    let expected = "there is no plan of phasing within the longest wait and above the lowest altitude";
    assert_eq!(error(Mission { lowest_altitude: 1e6, ..good }).to_string(), expected);

    // A whole revolution fixes nothing.
    let n = Frame::of(&good.station).unwrap().rate();
    let period = 2.0 * PI / n;
    assert_eq!(error(Mission { homing_duration: period, ..good }).failure, Failure::Undetermined(IN_PLANE));

    let broken = good.fly(|_| [f64::NAN; 3], |_| {}).unwrap_err();
    assert_eq!(broken.failure, Failure::NotFinite("what the thrusters give"));
    assert!(matches!(broken.at, Some(At::Time(time)) if time > 1000.0), "{broken}");
    // Thrusters that fail for the last metres: it comes to a stop before the port, or drifts away.
    let failing = |burn: &mbs_orbit::mission::Burn| match burn.phase {
        Phase::Docking => [0.0, -0.02, 0.0],
        _ => burn.delta_v,
    };
    let lost = good.fly(failing, |_| {}).unwrap_err();
    assert!(matches!(lost.failure, Failure::NoContact { distance } if distance > 0.0), "{lost}");
}

/// Plans that nobody should fly end with an error that says why, or dock.
#[test]
fn absurd_plans() {
    let good = Mission::to_the_station(Axis::VBar);
    let error = |mission: Mission| mission.fly(|burn| burn.delta_v, |_| {}).unwrap_err();
    let too_large = |parameter, value, limit| Error::from(Must::BeWithin([0.0, limit]).broken_by(parameter, value));
    assert_eq!(error(Mission { longest_wait: 1e300, ..good }), too_large("longest_wait", 1e300, 1e7));
    assert_eq!(error(Mission { corrections: 40, ..good }), too_large("corrections", 40.0, 20.0));
    let slow = error(Mission { approach_speeds: [1e-300, 1e-300], ..good });
    assert!(
        matches!(
            slow,
            Error {
                failure: Failure::Invalid(Invalid {
                    parameter: "duration of the approach",
                    must: Must::BeWithin(_),
                    ..
                }),
                ..
            }
        ),
        "{slow}"
    );
    for half_angle in [0.5 * PI, 3.0, 1e300] {
        let wide = error(Mission { corridor_half_angle: half_angle, ..good });
        assert!(
            matches!(
                wide,
                Error {
                    failure: Failure::Invalid(Invalid {
                        parameter: "corridor_half_angle",
                        must: Must::BeWithin(_),
                        ..
                    }),
                    ..
                }
            ),
            "{wide}"
        );
    }
    let none = Must::BePositive.broken_by("keep_out", 0.0).into();
    assert_eq!(error(Mission { keep_out: 0.0, ..good }), none);
    let fast = error(Mission { approach_speeds: [5e-324, 1e308], ..good });
    assert!(fast.failure == Failure::OutOfRange, "{fast}");

    // From above, on a hyperbola, from where the station is, with the port in the middle: dearer, but no matter.
    let escaping = StateVector { velocity: good.vehicle.velocity.map(|v| 1.5 * v), ..good.vehicle };
    for (mission, keep_out_violations) in [
        (Mission { vehicle: circle(600e3, -6.0, 51.6), ..good }, 0),
        (Mission { vehicle: escaping, ..good }, 0),
        (Mission { vehicle: good.station, ..good }, 1),
        (Mission { port_distance: 1e-3, ..good }, 0),
    ] {
        let report = flown(&mission);
        assert!(report.port_position_error() < 1e-6, "{report:?}");
        assert_eq!(report.keep_out_violations, keep_out_violations);
        assert_eq!(report.warnings, Default::default());
    }
    // Thrusters that err by half: it arrives, and the ways through the sphere are counted.
    let mut random = Random::new(0);
    let half = good.fly(|burn| burn.delta_v.map(|v| v * (1.0 + random.uniform(-0.5..0.5))), |_| {}).unwrap();
    assert!(half.port_position_error() < 0.5 && half.total_delta_v() > 80.0, "{half:?}");
    // Those that do nothing, or the contrary, do not dock.
    for part in [0.0, -1.0] {
        let lost = good.fly(|burn| burn.delta_v.map(|v| part * v), |_| {}).unwrap_err();
        assert!(matches!(lost.failure, Failure::Missed { distance } if distance > 200.0), "{lost}");
    }
}
