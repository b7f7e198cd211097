//! (4.1)–(4.18): the platform, typed from the print or as corrected, against the generated `stewart_platform`.

use mbs_models::stewart_platform::StewartPlatform;
use mbs_platform::{HOME, Motion};
use mbs_runtime::{Dual, Scalar};
use mbs_tests::compare::{assert_close, error};
use mbs_tests::random::Random;
use nalgebra::{Matrix3, Vector3};

use super::{along, assert_shown};
use crate::errata::{chapter_4, times};
use crate::platform::{platform, random_pose};

type Twice = Dual<Dual<f64>>;

/// Directions of the joints of base and platform \[°\], on circles of 1.2 and 0.9 m.
const BASE: [f64; 6] = [-12.0, 12.0, 108.0, 132.0, 228.0, 252.0];
const PLATFORM: [f64; 6] = [-48.0, 48.0, 72.0, 168.0, 192.0, 288.0];
const RADII: [f64; 2] = [1.2, 0.9];

/// `B_i` and `P_i`, x and y.
fn joints(leg: usize) -> [[f64; 2]; 2] {
    let on = |radius: f64, angle: f64| [radius * angle.to_radians().cos(), radius * angle.to_radians().sin()];
    [on(RADII[0], BASE[leg]), on(RADII[1], PLATFORM[leg])]
}

/// The first two columns of R = R_z(ψ) R_y(θ) R_x(φ): joints lie in the plane of the others.
fn columns<T: Scalar>(&[_, _, _, phi, theta, psi]: &[T; 6]) -> [[T; 2]; 3] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [phi, theta, psi].map(Scalar::sin_cos);
    [[cy * cp, cy * sp * sr - sy * cr], [sy * cp, sy * sp * sr + cy * cr], [-sp, cp * sr]]
}

/// (4.2).
fn equation_4_2<T: Scalar>(leg: usize, q: &[T; 6]) -> [T; 3] {
    let ([base, platform], r) = (joints(leg).map(|joint| joint.map(T::from_f64)), columns(q));
    let turned = |row: usize| r[row][0] * platform[0] + r[row][1] * platform[1];
    [turned(0) + q[0] - base[0], turned(1) + q[1] - base[1], turned(2) + q[2]]
}

/// f of (4.5): the right side of (4.4) less the square of a length.
fn equation_4_5(leg: usize, q: &[f64; 6], length: f64) -> f64 {
    let ([[bx, by], [px, py]], r, [x, y, z]) = (joints(leg), columns(q), [q[0], q[1], q[2]]);
    let turned = |row: usize| r[row][0] * px + r[row][1] * py;
    let squares = x * x + y * y + z * z + RADII[1] * RADII[1] + RADII[0] * RADII[0];
    squares + 2.0 * turned(0) * (x - bx) + 2.0 * turned(1) * (y - by) + 2.0 * turned(2) * z
        - 2.0 * (x * bx + y * by)
        - length * length
}

#[test]
fn equations_4_1_to_4_5_are_the_generated_lengths() {
    let (model, mut random) = (StewartPlatform::<f64>::default(), Random::new(41));
    for _ in 0..100 {
        let q = random_pose(&mut random);
        let generated = model.leg_length(&q);
        let pose = model.pose(&q);
        let rotation = Matrix3::from_fn(|i, j| pose.rotation[i][j]);
        for leg in 0..6 {
            let [[bx, by], [px, py]] = joints(leg);
            let vector =
                rotation * Vector3::new(px, py, 0.0) + Vector3::from(pose.position) - Vector3::new(bx, by, 0.0);
            let components = equation_4_2(leg, &q);
            assert_close("(4.1), (4.2)", vector.as_slice(), &components, 4e-16);
            let length = components.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert_close("(4.3)", &[length], &generated[leg..=leg], 1e-15);
            assert!(equation_4_5(leg, &q, generated[leg]).abs() < 1e-14, "(4.4), (4.5)");
            assert!(equation_4_5(leg, &q, generated[leg] + 0.01).abs() > 0.02, "(4.5) of other lengths");
        }
    }
}

/// (4.6) to (4.11), corrected: from the motion of the joint come ρ, its rate and its acceleration, which are those of
/// the generated length.
#[test]
fn equations_4_6_to_4_11_are_the_generated_lengths_in_motion() {
    let (model, own) = (StewartPlatform::<Dual<f64>>::default(), StewartPlatform::<f64>::default());
    for step in 0..20 {
        let [q, qd, qdd] = Motion::COMBINED.at(0.2 * f64::from(step));
        let accelerations = model.leg_length_velocity(&along(&q, &qd), &along(&qd, &qdd)).map(|l| l.derivative);
        let (lengths, rates) = (own.leg_length(&q), own.leg_length_velocity(&q, &qd));
        let path: [Twice; 6] = std::array::from_fn(|i| Dual {
            value: Dual { value: q[i], derivative: qd[i] },
            derivative: Dual { value: qd[i], derivative: qdd[i] },
        });
        for leg in 0..6 {
            let joint = equation_4_2(leg, &path);
            let part = |of: fn(&Twice) -> f64| Vector3::from_fn(|i, _| of(&joint[i]));
            let place = part(|x| x.value.value);
            let (velocity, acceleration) = (part(|x| x.value.derivative), part(|x| x.derivative.derivative));

            let [rho, alpha, beta] = [place.norm(), place.y.atan2(place.x), (place.z / place.norm()).acos()];
            let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
            let e = Vector3::new(ca * sb, sa * sb, cb);
            assert_close("(4.6)", (rho * e).as_slice(), place.as_slice(), 1e-14);
            assert_close("ρ", &[rho], &lengths[leg..=leg], 1e-15);

            let c = Matrix3::new(
                ca * sb,
                -rho * sa * sb,
                rho * ca * cb, //
                sa * sb,
                rho * ca * sb,
                rho * sa * cb, //
                cb,
                0.0,
                -rho * sb,
            );
            let solve = |right: Vector3<f64>| c.lu().solve(&right).expect("the leg is not vertical");
            let rate = solve(velocity);
            let [rd, ad, bd] = rate.into();
            assert_close("(4.7)", &[rd], &rates[leg..=leg], 1e-13);

            let turning = rho * (ad * ad + bd * bd);
            let h = acceleration
                + Vector3::new(
                    -2.0 * rd * bd * ca * cb
                        + 2.0 * rd * ad * sa * sb
                        + 2.0 * rho * ad * bd * sa * cb
                        + turning * ca * sb,
                    -2.0 * rd * bd * sa * cb - 2.0 * rd * ad * ca * sb - 2.0 * rho * ad * bd * ca * cb
                        + turning * sa * sb,
                    2.0 * rd * bd * sb + rho * bd * bd * cb,
                );
            let [rdd, add, bdd] = solve(h).into();
            assert_close("(4.11)", &[rdd], &accelerations[leg..=leg], 1e-12);

            let w = Vector3::new(-bd * sa, bd * ca, ad);
            let equation_4_10 = Vector3::new(-bdd * sa - bd * ad * ca, bdd * ca - bd * ad * sa, add);
            let rotated = rdd * e + equation_4_10.cross(&(rho * e)) + w.cross(&(2.0 * rd * e + w.cross(&(rho * e))));
            assert_close("(4.8) to (4.10)", rotated.as_slice(), acceleration.as_slice(), 1e-13);
        }
    }
}

/// (4.12): the derivatives of the generated energies, taken exactly by nested dual numbers.
#[test]
fn equation_4_12_is_the_generated_inverse_dynamics() {
    let (model, once) = (StewartPlatform::<Twice>::default(), StewartPlatform::<Dual<f64>>::default());
    let (own, mut random) = (StewartPlatform::<f64>::default(), Random::new(412));
    for _ in 0..10 {
        let q = random_pose(&mut random);
        let [qd, qdd]: [[f64; 6]; 2] = std::array::from_fn(|_| random.array(-1.0..1.0));
        let unit = |k: usize| -> [f64; 6] { std::array::from_fn(|i| f64::from(u8::from(i == k))) };
        let left: [f64; 6] = std::array::from_fn(|k| {
            // The outer part is time, the inner one the velocity q̇_k.
            let path = std::array::from_fn(|i| Dual { value: Dual::constant(q[i]), derivative: Dual::constant(qd[i]) });
            let rate = std::array::from_fn(|i| Dual {
                value: Dual { value: qd[i], derivative: unit(k)[i] },
                derivative: Dual::constant(qdd[i]),
            });
            let momentum_rate = model.kinetic_energy(&path, &rate).derivative.derivative;
            let (moved, still) = (along(&q, &unit(k)), qd.map(Dual::constant));
            let slope = once.kinetic_energy(&moved, &still) - once.potential_energy(&moved);
            momentum_rate - slope.derivative
        });
        assert_close("(4.12)", &left, &own.inverse_dynamics(&q, &qd, &qdd), 1e-12);
    }
}

/// (4.13), (4.14) and (4.16) of a platform alone, and what payload and legs add to (4.16).
#[test]
fn equations_4_13_to_4_16_are_the_generated_energies() {
    let ([bare, loaded, whole], g) =
        ([(0.0, false), (300.0, false), (300.0, true)].map(|(m, a)| platform(m, a)), 9.80665);
    let mut random = Random::new(416);
    for _ in 0..20 {
        let (q, qd): (_, [f64; 6]) = (random_pose(&mut random), random.array(-1.0..1.0));
        let [(sr, cr), (sp, cp)] = [q[3], q[4]].map(f64::sin_cos);
        let w = times(&[[1.0, 0.0, -sp], [0.0, cr, sr * cp], [0.0, -sr, cr * cp]], &[qd[3], qd[4], qd[5]]);
        let translation = 0.5 * 250.0 * (qd[0] * qd[0] + qd[1] * qd[1] + qd[2] * qd[2]);
        let rotation = 0.5 * (55.0 * w[0] * w[0] + 55.0 * w[1] * w[1] + 105.0 * w[2] * w[2]);
        assert_close("(4.13), (4.14)", &[translation + rotation], &[bare.model().kinetic_energy(&q, &qd)], 1e-14);

        let u = 250.0 * g * q[2];
        assert_close("(4.16)", &[u], &[bare.model().potential_energy(&q)], 1e-15);
        let u = u + 300.0 * g * (q[2] + 0.4 * cp * cr);
        assert_close("and the payload's", &[u], &[loaded.model().potential_energy(&q)], 1e-15);
        let legs = (0..6).map(|leg| {
            let [x, y, z] = equation_4_2(leg, &q);
            let rise = z / (x * x + y * y + z * z).sqrt();
            35.0 * g * 0.35 * rise + 15.0 * g * (z - 0.4 * rise)
        });
        assert_close("and the legs'", &[u + legs.sum::<f64>()], &[whole.model().potential_energy(&q)], 1e-14);
    }
}

/// (4.17): the generated terms under forces of the legs, with J typed from their directions and T.
#[test]
fn equation_4_17_of_the_generated_terms() {
    let (model, mut random) = (StewartPlatform::<f64>::default(), Random::new(417));
    for _ in 0..20 {
        let q = random_pose(&mut random);
        let (qd, tau): ([f64; 6], [f64; 6]) = (random.array(-1.0..1.0), random.array(-3000.0..3000.0));
        // The derivative of (4.3) by each coordinate.
        let slopes: [[f64; 6]; 6] = std::array::from_fn(|k| {
            let moved = along(&q, &std::array::from_fn(|i| f64::from(u8::from(i == k))));
            std::array::from_fn(|leg| {
                let [x, y, z] = equation_4_2(leg, &moved);
                (x * x + y * y + z * z).sqrt().derivative
            })
        });
        let right = times(&slopes, &tau);
        assert_close("Jᵀ τ", &right, &model.generalized_force(&q, &qd, &tau), 1e-13);
        let qdd = model.forward_dynamics(&q, &qd, &tau);
        let (inertia, coriolis) = (times(&model.mass_matrix(&q), &qdd), times(&model.coriolis_matrix(&q, &qd), &qd));
        let gravity = model.gravity(&q);
        let left: [f64; 6] = std::array::from_fn(|i| inertia[i] + coriolis[i] + gravity[i]);
        assert_close("(4.17)", &left, &right, 1e-11);
    }
}

/// (4.18) in both orders, as the page shows it: the Coriolis forces of the platform with 300 kg on legs without mass.
#[test]
fn equation_4_18_in_numbers() {
    let [q, qd, _] = Motion::COMBINED.at(0.3);
    let own = platform(300.0, false);
    let model = chapter_4::without_legs();
    let slopes = chapter_4::slopes(&q, |q| model.mass_matrix(q));
    let [right, other] = [true, false].map(|identity_first| {
        let forces = chapter_4::equation_4_18(&slopes, &qd, identity_first) * nalgebra::Vector6::from(qd);
        <[f64; 6]>::from(forces)
    });
    let generated = times(&own.model().coriolis_matrix(&q, &qd), &qd);
    assert_close("C q̇ of (4.18)", &right, &generated, 1e-13);
    assert!(error(&other, &generated) > 0.1, "the other order");
    assert_shown(4, &right, 4);
    assert_shown(4, &other, 4);
    // At rest at home nothing is left of it.
    assert_eq!(own.model().coriolis_matrix(&HOME, &[0.0; 6]), [[0.0; 6]; 6]);
}
