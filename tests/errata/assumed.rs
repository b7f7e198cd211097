//! The page of assumed values against the code that has them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mbs_arm::JointLimits;
use mbs_landing::estimator::filter::{GATE, Uncertainty};
use mbs_landing::experiment::collision::Shapes;
use mbs_landing::experiment::inbound::Inbound;
use mbs_landing::experiment::landed::Landed;
use mbs_landing::experiment::plan::Cell;
use mbs_landing::experiment::rail_arm::{RailArm, RailLimits};
use mbs_landing::experiment::tracking::{LINK_EXCESS, MODULE_EXCESS, Tracking};
use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::backstepping::Backstepping;
use mbs_landing::quadrotor::gear::{Damping, Gear};
use mbs_landing::quadrotor::ground_effect::LEAST_HEIGHT;
use mbs_landing::quadrotor::landing::Landing;
use mbs_landing::quadrotor::lqr::Weights;
use mbs_landing::quadrotor::standing::Standing;
use mbs_landing::sensors::Sensors;
use mbs_landing::sensors::imu::Noise;
use mbs_models::{assistive_arm, irb7600_elastic, marine_platform, scara, stewart_platform_elastic};
use mbs_models::{irb7600, irb7600_rail, quadrotor_euler, quadrotor_quaternion, relative_lvlh, stewart_platform};
use mbs_orbit::mission::{Axis, Mission};
use mbs_orbit::soft_docking::flight::SoftDocking;
use mbs_orbit::soft_docking::plume::Panel;
use mbs_platform::marine::{control, simulation, spectrum, thrusters::Thrusters, wind};
use mbs_platform::{ActuatorLimits, HOME, Motion, Superposition};
use nalgebra::Vector3;

use crate::thesis_map::page;

/// A row of the page.
struct Row {
    key: String,
    value: String,
    status: String,
    place: String,
}

fn rows() -> Vec<Row> {
    let page = page("assumed.md");
    let row = |line: &str| {
        let cells: Vec<String> = line.split('|').map(|cell| cell.trim().replace('`', "")).collect();
        assert_eq!(cells.len(), 8, "{line}");
        Row { key: cells[1].clone(), value: cells[3].clone(), status: cells[4].clone(), place: cells[6].clone() }
    };
    page.lines().filter(|line| line.starts_with("| `")).map(row).collect()
}

/// Its words that are numbers.
fn words(value: &str) -> Vec<f64> {
    value.split([' ', ',', ';']).filter_map(|word| word.replace('−', "-").parse().ok()).collect()
}

/// The numbers of a source, in its order.
fn numbers_of(source: &str) -> Vec<f64> {
    let plain = source.replace("_f64", " ").replace("..", " ");
    let words = plain.split(|c: char| !(c.is_alphanumeric() || ".-_".contains(c)));
    words.filter_map(|word| word.replace('_', "").parse::<f64>().ok()).filter(|number| number.is_finite()).collect()
}

fn degrees<const N: usize>(angles: [f64; N]) -> Vec<f64> {
    angles.map(f64::to_degrees).into()
}

/// Values of the arm, by their keys and in the units of the page.
fn arm() -> Vec<(&'static str, Vec<f64>)> {
    let (arm, limits) = (irb7600::Params::<f64>::default(), JointLimits::IRB7600);
    let (mut lower, mut upper) = (degrees(limits.lower), degrees(limits.upper));
    let offset = -60.0 - lower[1];
    (lower[1], upper[1]) = (lower[1] + offset, upper[1] + offset);
    vec![
        ("gravity", vec![arm.g]),
        ("arm.masses", arm.mass.into()),
        ("arm.mass_centres", [arm.com_x, arm.com_y, arm.com_z].concat()),
        ("arm.inertias", [arm.i_xx, arm.i_yy, arm.i_zz].concat()),
        ("arm.ranges", (0..6).flat_map(|i| [lower[i], upper[i]]).collect()),
        ("arm.senses", vec![offset]),
        ("arm.speeds", degrees(limits.speed)),
        ("arm.accelerations", degrees(limits.acceleration)),
        ("arm.torques", limits.torque.map(|torque| torque / 1e3).into()),
        ("arm.quartic", vec![]),
    ]
}

fn platform() -> Vec<(&'static str, Vec<f64>)> {
    let p = stewart_platform::Params::<f64>::default();
    let limits = ActuatorLimits::PS_6TL_1500;
    let amplitude = |motion: &Motion, i: usize| motion.sine[i] + motion.cosine[i];
    let of_case = |case: usize, i: usize| amplitude(&Motion::CASES[case].1, i);
    let angles = [of_case(3, 3), of_case(4, 4), of_case(6, 5)];
    let marine = Superposition::MARINE.0;
    let deck = |i: usize| marine.map(|wave| amplitude(&wave, i));
    vec![
        ("platform.radii", vec![p.base_radius, p.platform_radius]),
        ("platform.half_angles", degrees([p.base_half_angle, p.platform_half_angle])),
        ("platform.home", vec![HOME[2]]),
        ("platform.attitude", vec![]),
        ("platform.plate", [&[p.platform_mass][..], &p.platform_inertia].concat()),
        ("platform.payload", p.payload_size.into()),
        ("platform.cylinders", vec![p.cylinder_mass, p.cylinder_centre, p.cylinder_inertia]),
        ("platform.pistons", vec![p.piston_mass, p.piston_centre, p.piston_inertia]),
        ("platform.limits", vec![limits.shortest, limits.longest, limits.speed, limits.force / 1e3]),
        ("platform.frequency", vec![Motion::TABLE_3.frequency[2]]),
        ("platform.height", vec![Motion::TABLE_3.mean[2]]),
        ("platform.cases", [vec![of_case(1, 0), of_case(2, 1)], degrees(angles)].concat()),
        ("platform.combined", (0..6).map(|i| amplitude(&Motion::COMBINED, i)).collect()),
        ("platform.combined_frequencies", Motion::COMBINED.frequency.into()),
        ("landing.marine", [&deck(2)[..], &degrees(deck(3)), &degrees(deck(4)), &degrees(deck(5))].concat()),
        ("landing.marine_frequencies", (2..6).flat_map(|i| marine.map(|wave| wave.frequency[i])).collect()),
    ]
}

fn quadrotor() -> Vec<(&'static str, Vec<f64>)> {
    let p = quadrotor_euler::Params::<f64>::default();
    let (control, approach, weights) = (Backstepping::new(p), Approach::default(), Weights::default());
    let channels = [control.horizontal, control.vertical, control.tilt, control.yaw];
    assert!(channels.iter().all(|channel| channel.k1 == channel.k2), "the page says that they are equal");
    let [least, greatest] = control.thrust_range;
    let standing = Standing::new(Gear::default());
    let Damping::HuntCrossley(damping) = standing.gear.damping else { panic!("the page has Hunt and Crossley's") };
    let (gear, rest) = (&standing.gear, &standing.still);
    let legs = [gear.half_track, gear.height, gear.stiffness, gear.exponent, damping, gear.friction, gear.creep_speed];
    let still = Landing::initial_state().qd.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
    vec![
        ("quadrotor.inertias", p.inertias.into()),
        ("quadrotor.rotors", vec![p.arm, p.thrust_factor, p.drag_factor, p.rotor_inertia]),
        ("quadrotor.drag", vec![p.drag_coefficient, p.area, p.air_density]),
        ("quadrotor.gains", channels.map(|channel| channel.k1).into()),
        ("quadrotor.limits", vec![least, greatest, control.greatest_tilt.to_degrees()]),
        ("quadrotor.guidance", vec![approach.height, approach.last_height, approach.duration, approach.sink_rate]),
        ("quadrotor.start", vec![still]),
        (
            "quadrotor.regulator",
            vec![weights.position, weights.angle.to_degrees(), weights.velocity, weights.rate, weights.rotor_speed],
        ),
        ("quadrotor.least_height", vec![LEAST_HEIGHT]),
        ("landing.gear", legs.into()),
        ("landing.run_down", vec![standing.run_down]),
        ("landing.still", vec![rest.speed, rest.rate, rest.duration]),
        ("landing.tipped", vec![standing.tipped.to_degrees()]),
    ]
}

fn experiment() -> Vec<(&'static str, Vec<f64>)> {
    let (p, rail, cell) = (irb7600_rail::Params::<f64>::default(), RailLimits::LABORATORY, Cell::LABORATORY);
    let tracking = Tracking::new(&RailArm::default());
    let landed = Landed::new(Tracking::new(&RailArm::default()));
    let Damping::HuntCrossley(damping) = landed.gear.damping else { panic!("the page has Hunt and Crossley's") };
    let feet = &landed.gear;
    let Shapes { base, upper_arm, forearm, wrist, vehicle: [arms, around], deck, leg } = Shapes::LABORATORY;
    vec![
        ("experiment.rail", vec![rail.speed, rail.acceleration, rail.force / 1e3]),
        ("experiment.carriage", vec![p.carriage_mass]),
        ("experiment.module", [&[p.module_mass, p.module_center][..], &p.module_inertia].concat()),
        ("experiment.places", vec![cell.platform[0], cell.platform[1], cell.deck]),
        ("experiment.inbound", vec![Inbound::LABORATORY.distance, Inbound::LABORATORY.duration]),
        ("experiment.shapes", vec![base, upper_arm, forearm, wrist, arms, around, deck, leg]),
        ("experiment.feet", vec![feet.half_track, feet.stiffness, damping, feet.friction, feet.creep_speed]),
        ("experiment.contact", vec![landed.platform_frequency, landed.soft_frequency, landed.threshold]),
        ("experiment.excess", vec![LINK_EXCESS, MODULE_EXCESS]),
        ("experiment.control", vec![tracking.natural_frequency, tracking.period]),
    ]
}

fn marine() -> Vec<(&'static str, Vec<f64>)> {
    let p = marine_platform::Params::<f64>::default();
    let (thrusters, weights, over) =
        (Thrusters::default(), control::Weights::default(), wind::Superstructure::default());
    assert_eq!(spectrum::GRAVITY, p.g, "waves and platform");
    let full = thrusters.thrust[0] / thrusters.rate[0];
    assert!((0..6).all(|i| thrusters.thrust[i] == full * thrusters.rate[i]) && weights.thrust == thrusters.thrust);
    let in_degrees = |[z, a, b, c]: [f64; 4]| [&[z][..], &degrees([a, b, c])].concat();
    let hull = [&[p.column_radius][..], &p.column_place, &p.pontoon, &[p.mass_centre]].concat();
    let limits = [thrusters.thrust[0] / 1e3, thrusters.thrust[4] / 1e3, full];
    vec![
        ("marine.freedoms", vec![]),
        ("marine.masses", [&[p.m / 1e3][..], &p.inertias].concat()),
        ("marine.hull", hull),
        ("marine.added", [&[p.added_mass / 1e3][..], &p.added_inertias].concat()),
        ("marine.damping", [&[p.heave_damping][..], &p.turn_damping, &[p.heave_drag], &p.turn_drag].concat()),
        ("marine.mooring", vec![p.mooring]),
        ("marine.water", vec![p.density]),
        ("marine.thrusters", [&p.lift_place[..], &p.lateral_place, &limits].concat()),
        ("marine.loads", vec![]),
        ("marine.peakedness", vec![spectrum::PEAKEDNESS]),
        ("marine.gusts", vec![wind::SURFACE_DRAG, wind::FASTEST]),
        ("marine.superstructure", [&over.areas[..], &[over.drag_coefficient, over.air_density], &over.place].concat()),
        ("marine.freeboard", vec![simulation::FREEBOARD]),
        ("marine.control", [in_degrees(weights.position), in_degrees(weights.rate)].concat()),
    ]
}

fn sensors() -> Vec<(&'static str, Vec<f64>)> {
    let Sensors { imu, altimeter, camera, markers } = Sensors::TYPICAL;
    let noise = |noise: Noise| vec![noise.density, noise.walk, noise.bias];
    let of_camera = [camera.focal, camera.size[0], camera.size[1], camera.noise, camera.margin];
    let times = [camera.least_depth, camera.period, camera.delay];
    let start = Uncertainty::START;
    vec![
        ("sensors.imu", [&imu.place[..], &[imu.interval]].concat()),
        ("sensors.gyro", noise(imu.gyro)),
        ("sensors.accelerometer", noise(imu.accelerometer)),
        (
            "sensors.altimeter",
            [
                &altimeter.place[..],
                &[altimeter.noise, altimeter.period],
                &altimeter.ranges,
                &[altimeter.greatest_incidence],
            ]
            .concat(),
        ),
        ("sensors.camera", [&camera.place[..], &of_camera, &times].concat()),
        ("sensors.markers", [&markers[0][..2], &markers[4][..2]].concat()),
        ("estimator.start", vec![start.place, start.velocity, start.attitude]),
        ("estimator.gate", vec![GATE]),
    ]
}

/// Elasticity and what assists a person.
fn elastic() -> Vec<(&'static str, Vec<f64>)> {
    let arm = irb7600_elastic::Params::<f64>::default();
    let rigid = irb7600::Params::<f64>::default();
    let of_links = |mass: [f64; 6], rest: [[f64; 6]; 6]| (mass, rest);
    assert_eq!(
        of_links(arm.mass, [arm.com_x, arm.com_y, arm.com_z, arm.i_xx, arm.i_yy, arm.i_zz]),
        of_links(rigid.mass, [rigid.com_x, rigid.com_y, rigid.com_z, rigid.i_xx, rigid.i_yy, rigid.i_zz]),
        "the same links"
    );
    let legs = stewart_platform_elastic::Params::<f64>::default();
    let p = assistive_arm::Params::<f64>::default();
    let alike = |values: &[f64]| {
        assert!(values.iter().all(|value| *value == values[0]), "{values:?}");
        values[0]
    };
    let links = [p.length, p.mass, p.centre, p.moment].concat();
    vec![
        ("elastic.rotors", [arm.rotor, arm.ratio].concat()),
        ("elastic.stiffness", arm.stiffness.into()),
        ("elastic.damping", arm.damping.into()),
        ("legs.drives", vec![alike(&legs.rotor), legs.lead]),
        ("legs.stiffness", vec![alike(&legs.stiffness), alike(&legs.damping)]),
        ("assistive.arm", [&links[..], &[alike(&p.friction)]].concat()),
        ("assistive.springs", [p.post, p.arm].concat()),
        ("assistive.forearm", vec![p.payload]),
        ("assembly.scara", scara::Params::<f64>::default().mass.into()),
    ]
}

fn orbits() -> Vec<(&'static str, Vec<f64>)> {
    let (p, mission) = (relative_lvlh::Params::<f64>::default(), Mission::to_the_station(Axis::VBar));
    let [station, vehicle] = [mission.station, mission.vehicle].map(|state| Vector3::from(state.position));
    let [own, other] = [mission.station, mission.vehicle]
        .map(|state| Vector3::from(state.position).cross(&Vector3::from(state.velocity)).normalize());
    // Both planes turn about the first axis, which angles in them are counted from.
    let behind = -vehicle.dot(&other.cross(&Vector3::x())).atan2(vehicle.x);
    let between = own.cross(&other).norm().asin();
    let start = vec![(station.norm() - vehicle.norm()) / 1e3, behind.to_degrees(), between.to_degrees()];
    let corridor = [mission.corridor_half_angle.to_degrees(), mission.corridor_mouth, mission.port_distance];
    vec![
        ("orbit.station_mass", vec![p.station_mass / 1e3]),
        ("orbit.body", vec![p.m]),
        ("docking.start", start),
        ("docking.zones", [&[mission.keep_out][..], &corridor].concat()),
        ("docking.speeds", mission.approach_speeds.into()),
    ]
}

fn soft_docking() -> Vec<(&'static str, Vec<f64>)> {
    let docking = SoftDocking::to_the_station();
    let (p, start, jets, latches) = (docking.params, docking.start, docking.jets, docking.latches);
    let length = |v: [f64; 3]| Vector3::from(v).norm();
    let [face, array, other] = docking.panels;
    assert_eq!((array.halves, array.middle[1]), (other.halves, -other.middle[1]), "both arrays are alike");
    let halves = |panel: Panel| [length(panel.halves[1]), length(panel.halves[0])];
    let brake = jets.jets[0];
    let cant = (-brake.push[0]).acos().to_degrees();
    let ring = [p.axial_stiffness, p.lateral_stiffness, p.angular_stiffness];
    let damping = [p.axial_damping, p.lateral_damping, p.angular_damping];
    let angles = degrees([latches.tilt, latches.roll]);
    let speeds = [latches.closing[0], latches.closing[1], latches.sliding, latches.turning.to_degrees()];
    vec![
        ("soft_docking.chaser", [&[p.chaser_mass][..], &p.chaser_inertia, &[length(p.chaser_port)]].concat()),
        ("soft_docking.station", [&[p.station_mass][..], &p.station_inertia, &[length(p.station_port)]].concat()),
        ("soft_docking.ring", [&ring[..], &damping, &[p.trip_depth]].concat()),
        (
            "soft_docking.start",
            [&[start.distance][..], &start.aside, &degrees(start.angles), &degrees(start.spin)].concat(),
        ),
        ("soft_docking.speeds", docking.speeds.into()),
        (
            "soft_docking.control",
            vec![docking.attitude.frequency, docking.attitude.damping, docking.place[0], docking.place[1]],
        ),
        ("soft_docking.jets", vec![brake.place[0], brake.place[1], jets.thrust, jets.shortest, jets.period, cant]),
        ("soft_docking.specific_impulse", vec![jets.exhaust_velocity / 9.80665]),
        (
            "soft_docking.plume",
            [&[docking.plume.exponent][..], &halves(face), &halves(array), &array.middle[..2]].concat(),
        ),
        ("soft_docking.latches", [&[latches.lateral][..], &angles, &speeds].concat()),
        ("soft_docking.ring_radius", vec![latches.ring]),
    ]
}

/// Numbers of the page are those of the code; where a program keeps them to itself, its source has them in this order.
#[test]
fn assumed_values_are_those_of_the_code() {
    let all = [arm(), platform(), quadrotor(), experiment(), marine(), sensors(), elastic(), orbits(), soft_docking()];
    let known: BTreeMap<_, _> = all.into_iter().flatten().collect();
    let mut checked = 0;
    for Row { key, value, status, place } in rows() {
        assert!(["assumed", "recalled", "reading"].contains(&status.as_str()), "{key}: {status}");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(&place);
        let source = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{key}: {place}: {error}"));
        let numbers = words(&value);
        match known.get(key.as_str()) {
            Some(want) => {
                checked += 1;
                let close = |(found, want): (&f64, &f64)| (found - want).abs() <= 1e-9 * (1.0 + want.abs());
                let same = numbers.len() == want.len() && numbers.iter().zip(want).all(close);
                assert!(same, "{key}: the page has {numbers:?}, the code {want:?}");
            }
            None => {
                let mut rest = numbers_of(&source).into_iter();
                for number in numbers {
                    assert!(rest.any(|other| other == number), "{key}: {place} has no {number} behind those before it");
                }
            }
        }
    }
    assert_eq!(checked, known.len(), "every value of the code has its row");
}

/// Parameters of the thesis' mechanisms: the thesis gives their values, they are public constants, or they are rows of
/// the page.
const SOURCES: [(&str, &[(&str, &str)]); 11] = [
    ("irb7600", &ARM),
    ("irb7600_rail", &RAIL_ARM),
    ("stewart_platform", &PLATFORM),
    ("marine/marine_platform", &MARINE),
    ("quadrotor_euler", &QUADROTOR),
    ("quadrotor_quaternion", &QUADROTOR),
    ("relative_cylindrical", &[("m", "orbit.body"), ("mu", PUBLIC), ("station_mass", "orbit.station_mass")]),
    ("relative_lvlh", &[("m", "orbit.body"), ("mu", PUBLIC), ("station_mass", "orbit.station_mass")]),
    ("relative_isotropic", &[("m", "orbit.body"), ("omega", "orbit.altitude"), ("station_mass", "orbit.station_mass")]),
    ("two_body", &[("G", PUBLIC), ("mass", PUBLIC)]),
    ("cr3bp", &[("mu", PUBLIC)]),
];
const THESIS: &str = "the thesis";
const PUBLIC: &str = "a public constant";

const ARM: [(&str, &str); 8] = [
    ("mass", "arm.masses"),
    ("com_x", "arm.mass_centres"),
    ("com_y", "arm.mass_centres"),
    ("com_z", "arm.mass_centres"),
    ("i_xx", "arm.inertias"),
    ("i_yy", "arm.inertias"),
    ("i_zz", "arm.inertias"),
    ("g", "gravity"),
];

const RAIL_ARM: [(&str, &str); 12] = [
    ("carriage_mass", "experiment.carriage"),
    ARM[0],
    ARM[1],
    ARM[2],
    ARM[3],
    ARM[4],
    ARM[5],
    ARM[6],
    ("module_mass", "experiment.module"),
    ("module_center", "experiment.module"),
    ("module_inertia", "experiment.module"),
    ARM[7],
];

const PLATFORM: [(&str, &str); 15] = [
    ("base_radius", "platform.radii"),
    ("platform_radius", "platform.radii"),
    ("base_half_angle", "platform.half_angles"),
    ("platform_half_angle", "platform.half_angles"),
    ("platform_mass", "platform.plate"),
    ("platform_inertia", "platform.plate"),
    ("payload_mass", THESIS),
    ("payload_size", "platform.payload"),
    ("cylinder_mass", "platform.cylinders"),
    ("cylinder_centre", "platform.cylinders"),
    ("cylinder_inertia", "platform.cylinders"),
    ("piston_mass", "platform.pistons"),
    ("piston_centre", "platform.pistons"),
    ("piston_inertia", "platform.pistons"),
    ("g", "gravity"),
];

const MARINE: [(&str, &str); 17] = [
    ("m", "marine.masses"),
    ("inertias", "marine.masses"),
    ("added_mass", "marine.added"),
    ("added_inertias", "marine.added"),
    ("column_radius", "marine.hull"),
    ("column_place", "marine.hull"),
    ("pontoon", "marine.hull"),
    ("mass_centre", "marine.hull"),
    ("heave_damping", "marine.damping"),
    ("turn_damping", "marine.damping"),
    ("heave_drag", "marine.damping"),
    ("turn_drag", "marine.damping"),
    ("mooring", "marine.mooring"),
    ("lift_place", "marine.thrusters"),
    ("lateral_place", "marine.thrusters"),
    ("density", "marine.water"),
    ("g", "gravity"),
];

const QUADROTOR: [(&str, &str); 10] = [
    ("m", THESIS),
    ("inertias", "quadrotor.inertias"),
    ("arm", "quadrotor.rotors"),
    ("thrust_factor", "quadrotor.rotors"),
    ("drag_factor", "quadrotor.rotors"),
    ("rotor_inertia", "quadrotor.rotors"),
    ("drag_coefficient", "quadrotor.drag"),
    ("area", "quadrotor.drag"),
    ("air_density", "quadrotor.drag"),
    ("g", "gravity"),
];

#[test]
fn every_parameter_has_its_source() {
    let keys: Vec<String> = rows().into_iter().map(|row| row.key).collect();
    for (mechanism, sources) in SOURCES {
        let path = format!("{}/../models/mechanisms/{mechanism}.mbs", env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(path).expect("a mechanism of the thesis");
        let declared: Vec<&str> = text
            .lines()
            .filter_map(|line| line.trim_start().strip_prefix("param "))
            .map(|rest| rest.split(['[', ':']).next().expect("a name"))
            .collect();
        assert_eq!(declared, sources.iter().map(|(name, _)| *name).collect::<Vec<_>>(), "{mechanism}");
        for (name, source) in sources {
            let is_known = [THESIS, PUBLIC].contains(source) || keys.iter().any(|key| key == source);
            assert!(is_known, "{mechanism}: {name} is of {source}, which the page does not have");
        }
    }
    // The same vehicle twice.
    let (angles, quaternion) =
        (quadrotor_euler::Params::<f64>::default(), quadrotor_quaternion::Params::<f64>::default());
    assert_eq!(format!("{angles:?}"), format!("{quaternion:?}"));
}

/// Keys are told apart, and no cell is empty.
#[test]
fn rows_are_whole() {
    let page = page("assumed.md");
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let mut keys = Vec::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        assert!(cells.iter().all(|cell| !cell.is_empty()), "{row}");
        keys.push(cells[0]);
    }
    let count = keys.len();
    keys.sort_unstable();
    keys.dedup();
    assert_eq!((keys.len(), count > 50), (count, true));
}
