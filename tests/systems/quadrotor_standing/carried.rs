//! The Stewart platform under the vehicle that comes down on it.

use mbs_landing::quadrotor::deck::MovingDeck;
use mbs_landing::quadrotor::driven::Drive;
use mbs_landing::quadrotor::gear::Gear;
use mbs_landing::quadrotor::standing::{Carried, Carrier, Ending, Moment, Start, twist, with_quaternion};
use mbs_models::stewart_platform::Params;
use mbs_platform::jacobian::angular_rates;
use mbs_platform::{HOME, Platform, Superposition};
use mbs_runtime::State;
use mbs_runtime::control::ComputedTorque;
use nalgebra::{Matrix3, Vector3};

use super::{G, M, close, in_vacuum};

const PLATE: f64 = 250.0;
const FREQUENCY: f64 = 8.0;

/// Held at home, or let go, with legs that have no mass or with the declared ones.
fn carried(g: f64, controlled: bool, legs: bool) -> Carried<Superposition<1>> {
    let declared = Params { payload_mass: 0.0, g, ..Params::default() };
    let bare = Params { cylinder_mass: 0.0, cylinder_inertia: 0.0, piston_mass: 0.0, piston_inertia: 0.0, ..declared };
    let platform = Platform::new(if legs { declared } else { bare }).unwrap();
    let motion = Superposition::heave(HOME[2], &[0.0], &[0.0]);
    let deck = MovingDeck { motion, base: [0.0; 3], point: [0.1, -0.05, 0.0] };
    let control = ComputedTorque::critically_damped(FREQUENCY).unwrap();
    Carried { deck, drive: Drive { platform, control }, controlled }
}

/// Over home by a gap, tilted, with rates.
fn over_home(gap: f64, tilt: [f64; 2], velocity: [f64; 3]) -> Start {
    let [roll, pitch] = tilt;
    let q = [0.1, -0.05, HOME[2] + Gear::default().height + gap, roll, pitch, 0.1];
    let [x, y, z] = velocity;
    let vehicle = with_quaternion(&State::new(q, [x, y, z, 0.1, -0.2, 0.3]));
    Start { platform: State::new(HOME, [0.0; 6]), ..Start::at_rest(0.0, vehicle) }
}

/// Nothing from outside acts on vehicle and plate: momentum and angular momentum of both together stay, through the
/// impact and the sliding.
#[test]
fn action_is_reaction() {
    let carrier = carried(0.0, false, false);
    let mut standing = in_vacuum(Gear::default(), 0.0);
    standing.duration = 1.5;
    let inertias = Matrix3::from_diagonal(&Vector3::from(standing.vehicle.params().inertias));
    let plate = Matrix3::from_diagonal(&Vector3::new(55.0, 55.0, 105.0));
    let momenta = |moment: &Moment| {
        let own = twist(&standing.vehicle, &moment.vehicle);
        let State { q, qd } = moment.platform;
        let rotation = Matrix3::from_fn(|i, j| moment.deck.rotation[i][j]);
        let rates = Matrix3::from_fn(|i, j| angular_rates(&q)[i][j]);
        let turning = rates * Vector3::new(qd[3], qd[4], qd[5]);
        let (place, speed) = (Vector3::new(q[0], q[1], q[2]), Vector3::new(qd[0], qd[1], qd[2]));
        let linear = own.velocity * M + speed * PLATE;
        let angular = own.position.cross(&own.velocity) * M
            + own.rotation * inertias * own.rotation.transpose() * own.angular_velocity
            + place.cross(&speed) * PLATE
            + rotation * plate * rotation.transpose() * turning;
        (linear, angular)
    };
    let mut first = None;
    let mut greatest: f64 = 0.0;
    let end = standing
        .simulate(&carrier, &over_home(0.15, [0.1, 0.05], [0.4, 0.2, -0.6]), |moment| {
            let (linear, angular) = momenta(moment);
            let (before, turned) = *first.get_or_insert((linear, angular));
            assert!((linear - before).norm() < 1e-7 * before.norm(), "{linear} {before}");
            assert!((angular - turned).norm() < 1e-7 * turned.norm(), "{angular} {turned}");
            greatest = greatest.max(moment.platform.qd[2].abs());
        })
        .unwrap();
    assert!(greatest > 0.05 && end.greatest_force > 100.0 && end.slid > 1e-3 && end.energy_error < 1e-8, "{end:?}");
}

/// At rest six legs without mass carry plate and vehicle, `Σ F u = (M + m) g`; and the controller, which does not know
/// of the vehicle, yields by `m g/(M ω²)`.
#[test]
fn six_legs_carry_the_added_weight() {
    let carrier = carried(G, true, false);
    let mut standing = in_vacuum(Gear::default(), G);
    standing.still.duration = 2.5;
    let before = carrier.forces(0.0, &State::new(HOME, [0.0; 6])).unwrap();
    // Upright, over the middle: the plate only sinks.
    let mut start = over_home(0.05, [0.0; 2], [0.0, 0.0, -0.2]);
    start.vehicle = with_quaternion(&State::new([0.0, 0.0, HOME[2] + 0.45, 0.0, 0.0, 0.0], [0.0; 6]));
    let end = standing.simulate(&carrier, &start, |_| ()).unwrap();
    assert!(matches!(end.ending, Ending::Rest { .. }) && end.energy_error < 1e-8, "{end:?}");
    let lift = |platform: &State<[f64; 6]>, forces: [f64; 6]| -> f64 {
        let legs = carrier.drive.platform.legs(&platform.q).unwrap();
        (0..6).map(|i| forces[i] * legs.direction[i][2]).sum()
    };
    close(lift(&State::new(HOME, [0.0; 6]), before), PLATE * G, 1e-9);
    let after = carrier.forces(end.last.time, &end.last.platform).unwrap();
    close(lift(&end.last.platform, after), (PLATE + M) * G, 0.05);
    close(HOME[2] - end.last.platform.q[2], M * G / (PLATE * FREQUENCY * FREQUENCY), 1e-5);
    assert!(end.greatest_force > M * G);
}

/// With the declared legs and a vehicle that comes down aslant.
#[test]
fn the_balance_of_energy_holds_on_the_driven_platform() {
    let carrier = carried(G, true, true);
    let standing = in_vacuum(Gear::default(), G);
    let start = Start { rotor_speed: [250.0; 4], ..over_home(0.1, [0.05, -0.08], [0.3, -0.2, -0.7]) };
    let end = standing.simulate(&carrier, &start, |_| ()).unwrap();
    assert!(matches!(end.ending, Ending::Rest { .. }), "{end:?}");
    assert!(end.energy_error < 1e-8 && end.last.dissipated > 1.0, "{end:?}");
    assert!(carrier.energy(&end.last.platform) > 0.0);
}
