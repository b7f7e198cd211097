//! The 36 figures of the thesis: their captions, what is shown here, and what that rests on.

use crate::assumed::{self, HOME, JOINTS, LEGS, PLATE};

/// A figure of the thesis.
pub struct Entry {
    /// As printed.
    pub number: &'static str,
    /// The thesis' caption.
    pub title: &'static str,
    /// What is shown here.
    pub shows: &'static str,
    /// Rows of `docs/thesis/assumed.md`.
    assumed: Keys,
}

/// Of its file in the folder.
#[must_use]
pub fn file_name(number: &str) -> String {
    format!("figure_{}.svg", number.replace('.', "_"))
}

/// What a figure with this number rests on: rows of `docs/thesis/assumed.md`; nothing of one that the thesis has not.
#[must_use]
pub fn keys(number: &str) -> Vec<&'static str> {
    FIGURES.iter().find(|entry| entry.number == number).map_or_else(Vec::new, |entry| entry.assumed.concat())
}

/// "assumed: …", or that nothing is.
#[must_use]
pub fn assumptions(entry: &Entry) -> String {
    match &entry.assumed.concat()[..] {
        [] => "assumed: nothing".to_string(),
        keys => assumed::caption(keys),
    }
}

const fn entry(number: &'static str, title: &'static str, shows: &'static str, assumed: Keys) -> Entry {
    Entry { number, title, shows, assumed }
}

/// Groups of rows.
type Keys = &'static [&'static [&'static str]];

const PATH_1: Keys = &[&["arm.quartic"]];
const PATH_2: Keys = &[&["arm.quartic", "arm.case_2"]];
const ATTITUDE: &[&str] = &["platform.attitude"];
const MOTION: &[&str] = &["platform.frequency", "platform.height"];
const LOAD: &[&str] = &["gravity", "platform.payload"];
const GEOMETRY: Keys = &[JOINTS, HOME];
const FRAMES: Keys = &[JOINTS, HOME, ATTITUDE];
const ACTUATOR: Keys = &[JOINTS, HOME, LEGS];
const LENGTHS: Keys = &[JOINTS, HOME, MOTION];
const FORCES: Keys = &[JOINTS, HOME, LEGS, PLATE, MOTION, LOAD];
const SENSITIVITY: Keys = &[JOINTS, HOME, LEGS, PLATE, MOTION, LOAD, ATTITUDE, &["platform.angles"]];
const ROTORS: Keys = &[&["quadrotor.rotors"]];
const LANDING: Keys = &[assumed::LANDING];
// Not on home: there the platform cannot make the motion.
const LANDING_ON_LEGS: Keys = &[assumed::LANDING, JOINTS, LEGS, PLATE, &["platform.limits"]];
const ORBIT: Keys = &[&["orbit.altitude", "orbit.initial"]];

/// In the order of the thesis.
pub const FIGURES: [Entry; 36] = [
    entry(
        "3.1",
        "The relationship between direct and inverse kinematics",
        "From six joint angles to the pose of the flange and back, with the numbers of Table 1: the arm in its \
         posture, and the other seven that reach the same pose.",
        &[],
    ),
    entry(
        "3.2",
        "Simplified side view of the robotic arm",
        "The plane of the arm in the posture of Table 1, to scale: the lengths that θ₃ follows from.",
        &[],
    ),
    entry(
        "3.3",
        "Robotic arm side view",
        "The same plane with the two triangles of (3.12): θ₂ is what three angles leave of π.",
        &[],
    ),
    entry(
        "3.4",
        "End effector trajectory case 1",
        "The flange on the way of Table 2 from rest, by one quartic per joint; the other readings lead along the \
         same way.",
        PATH_1,
    ),
    entry(
        "3.5",
        "End effector trajectory case 2",
        "The flange on the way of Table 2 with an initial velocity of 1.5 °/s.",
        PATH_2,
    ),
    entry(
        "3.6",
        "Angular displacement case 1",
        "Joint angles by one quartic, and by how much two quartics and a quintic are more.",
        PATH_1,
    ),
    entry(
        "3.7",
        "Angular displacement case 2",
        "As Figure 3.6, with an initial velocity: joint 1 overshoots its goal.",
        PATH_2,
    ),
    entry("3.8", "Angular velocity case 1", "By three readings of the thesis' polynomial.", PATH_1),
    entry("3.9", "Angular velocity case 2", "By three readings of the thesis' polynomial.", PATH_2),
    entry(
        "3.10",
        "Angular acceleration case 1",
        "One quartic cannot end without acceleration, the other readings do (E9).",
        PATH_1,
    ),
    entry("3.11", "Angular acceleration case 2", "As Figure 3.10, with an initial velocity.", PATH_2),
    entry(
        "4.1",
        "Coordinate frames Stewart platform",
        "The frames of base and platform, and the vectors of (4.1) for one leg, in a pose off home.",
        FRAMES,
    ),
    entry(
        "4.2",
        "Positioning of points on the Stewart platform",
        "The joints of base and platform from above, at home.",
        GEOMETRY,
    ),
    entry(
        "4.3",
        "Stewart platform actuator",
        "A leg at home, to scale: cylinder and piston with their mass centres.",
        ACTUATOR,
    ),
    entry(
        "4.4",
        "B_iP_i in spherical coordinates",
        "A leg with its length ρ and its angles α and β of (4.6), in a pose off home.",
        FRAMES,
    ),
    entry("4.5", "Actuator lengths as a function of time", "Along the motion of Table 3.", LENGTHS),
    entry(
        "4.6",
        "Actuator forces as a function of time",
        "Along the motion of Table 3 without a payload; below, what the legs' own mass takes of it.",
        FORCES,
    ),
    entry(
        "4.7",
        "Actuator forces as a function of time with a payload of 1250 kg",
        "Along the motion of Table 3; below, what the legs' own mass takes of it.",
        FORCES,
    ),
    entry(
        "4.8",
        "Actuator forces as a function of time with a payload of 300 kg",
        "Along the motion of Table 3; below, what the legs' own mass takes of it.",
        FORCES,
    ),
    entry("4.9", "Sensitivity analysis for F1", "Along the motion of Table 4 with θ and φ changed.", SENSITIVITY),
    entry("4.10", "Sensitivity analysis for F2", "Along the motion of Table 4 with θ and φ changed.", SENSITIVITY),
    entry("4.11", "Sensitivity analysis for F3", "Along the motion of Table 4 with θ and φ changed.", SENSITIVITY),
    entry("4.12", "Sensitivity analysis for F4", "Along the motion of Table 4 with θ and φ changed.", SENSITIVITY),
    entry(
        "5.1",
        "Coordinate system of the spacecraft",
        "The inertial frame and the frame of the vehicle, with its rotors, their senses and thrusts.",
        ROTORS,
    ),
    entry(
        "5.2",
        "Quadcopter trajectory case I",
        "The guided landing from two sides and from above, and how far beside the platform it is.",
        LANDING,
    ),
    entry(
        "5.3",
        "Platform elevation case I",
        "The platform alone, as (5.9) says; with the vehicle; and the height between them at the end.",
        LANDING,
    ),
    entry("5.4", "Quadcopter attitude angles case I", "Whole, and the start enlarged.", LANDING),
    entry(
        "5.5",
        "Variation of actuator forces case I",
        "Of the rotors and, since the caption may mean these, of the platform's legs, on a platform raised so far that \
         it can make the motion.",
        LANDING_ON_LEGS,
    ),
    entry(
        "5.6",
        "Quadcopter trajectory case II",
        "The guided landing from two sides and from above, and how far beside the platform it is.",
        LANDING,
    ),
    entry(
        "5.7",
        "Platform elevation case II",
        "The platform alone, which falls faster than freely (E36); with the vehicle; and the height between them at \
         the end.",
        LANDING,
    ),
    entry("5.8", "Quadcopter attitude angles case II", "Whole, and the start enlarged.", LANDING),
    entry(
        "5.9",
        "Variation of actuator forces case II",
        "Of the rotors, which are at their limits for a part of the time, and of the platform's legs, on a platform \
         raised so far that it can make the motion.",
        LANDING_ON_LEGS,
    ),
    entry(
        "7.1",
        "Coordinate system",
        "The origin of the moving frame at r_ν and ν, a body about it at ρ, θ and z, as in (7.7). Not to scale.",
        &[],
    ),
    entry(
        "7.2",
        "Coordinate system for a relative motion",
        "The station on its circle at r_t and ν, a body about it at r, θ and z, as in (7.11). Not to scale.",
        &[],
    ),
    entry(
        "7.3",
        "Initial distance between the astronaut and the orbital station of 1000 km",
        "Released at rest outwards and along the track, and on the station's own circle, where the distance stays.",
        ORBIT,
    ),
    entry(
        "7.4",
        "Initial distance between the astronaut and the orbital station of 3 m",
        "Released at rest outwards and along the track, and on the closed ellipse. Regular, not chaotic (E46).",
        ORBIT,
    ),
];
