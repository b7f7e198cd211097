//! Chapter 4, the parallel manipulator, against the generated `stewart_platform`.

use mbs_models::Failure;
use mbs_models::irb7600::Irb7600;
use mbs_models::stewart_platform::{Params, StewartPlatform};
use mbs_platform::leg::LegMotion;
use mbs_platform::{Coordinates, HOME, LegVector, Motion, Platform};
use mbs_runtime::{Dual, Scalar, to_matrix, to_vector};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use super::{apart, refuted, times};
use crate::platform::{platform, random_pose};

type Twice = Dual<Dual<f64>>;

/// ρ, α, β of a leg with rates and accelerations: `stewart.spherical_leg` of the reference values.
const LEG: LegMotion =
    LegMotion { position: [1.3, 0.7, 0.4], rate: [0.2, -0.5, 0.3], acceleration: [0.15, 0.25, -0.35] };

/// Place, velocity and acceleration of the end of a leg, (4.6) differentiated exactly, twice.
fn path(LegMotion { position, rate, acceleration }: &LegMotion) -> [[f64; 3]; 3] {
    let [rho, alpha, beta]: [Twice; 3] = std::array::from_fn(|i| Dual {
        value: Dual { value: position[i], derivative: rate[i] },
        derivative: Dual { value: rate[i], derivative: acceleration[i] },
    });
    let ((sin_a, cos_a), (sin_b, cos_b)) = (alpha.sin_cos(), beta.sin_cos());
    let place = [rho * cos_a * sin_b, rho * sin_a * sin_b, rho * cos_b];
    [place.map(|x| x.value.value), place.map(|x| x.value.derivative), place.map(|x| x.derivative.derivative)]
}

/// `C⁻¹` times a vector.
fn solved(v: &[f64; 3]) -> [f64; 3] {
    let solution = to_matrix(&LEG.matrix()).lu().solve(&to_vector(v)).expect("the leg is not vertical");
    solution.into()
}

/// From the joint's velocity come rates, not the coordinates; of a vertical leg none.
#[test]
fn e12_velocity_gives_rates_of_the_leg() {
    let [_, velocity, _] = path(&LEG);
    assert_close("(4.7)", &solved(&velocity), &LEG.rate, 1e-15);
    refuted("(4.7)", &LEG.position, &solved(&velocity), 1.0);
    let determinant = to_matrix(&LEG.matrix()).determinant();
    assert_close("det C", &[determinant], &[-1.3 * 1.3 * 0.4_f64.sin()], 1e-15);
    let vertical = LegMotion::of_joint(&[0.0, 0.0, 1.0], &[0.1, 0.0, 0.0], &[0.0; 3]);
    assert_eq!(vertical, Err(Failure::Undetermined("the azimuth of a vertical leg").into()));
}

/// (4.8), with this factor of ρ̇.
fn equation_4_8(factor: f64) -> [f64; 3] {
    let vector = |x: [f64; 3]| Vector3::from(x);
    let (e, w, wd) = (vector(LEG.direction()), vector(LEG.angular_velocity()), vector(LEG.angular_acceleration()));
    let rho = LEG.position[0] * e;
    let acceleration = LEG.acceleration[0] * e + wd.cross(&rho) + w.cross(&(factor * LEG.rate[0] * e + w.cross(&rho)));
    acceleration.into()
}

/// With 2 ρ̇ it is the second derivative of the joint's place; as printed it is off by 0.067 m/s².
#[test]
fn e13_coriolis_acceleration_of_a_leg() {
    let [.., acceleration] = path(&LEG);
    assert_close("(4.8)", &equation_4_8(2.0), &acceleration, 1e-15);
    assert_close("the model's", &LEG.joint_acceleration(), &acceleration, 1e-15);
    let off = apart(&equation_4_8(1.0), &acceleration);
    assert!((off - 0.067_354_996_701_537).abs() < 1e-12, "{off}");
}

/// h of (4.11), with or without its cosine.
fn equation_4_11(stray: bool) -> [f64; 3] {
    let ([.., a], [rho, alpha, beta], [rd, ad, bd]) = (path(&LEG), LEG.position, LEG.rate);
    let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
    let turning = rho * (ad * ad + bd * bd);
    [
        a[0] - 2.0 * rd * bd * ca * cb + 2.0 * rd * ad * sa * sb + 2.0 * rho * ad * bd * sa * cb + turning * ca * sb,
        a[1] - 2.0 * rd * bd * sa * cb - 2.0 * rd * ad * ca * sb - 2.0 * rho * ad * bd * ca * cb + turning * sa * sb,
        a[2] + if stray { cb } else { 0.0 } + 2.0 * rd * bd * sb + rho * bd * bd * cb,
    ]
}

/// Without it the leg's accelerations come back; with it ρ̈ is off by cos² β.
#[test]
fn e14_cosine_in_the_third_row() {
    let right = solved(&equation_4_11(false));
    assert_close("(4.11)", &right, &LEG.acceleration, 1e-14);
    let printed = solved(&equation_4_11(true));
    assert!((printed[0] - right[0] - 0.4_f64.cos().powi(2)).abs() < 1e-14, "{printed:?}");
    refuted("(4.11)", &printed, &right, 0.84);
}

/// C⁻¹ h is the second derivative of (ρ, α, β), which a small step in time shows; the print calls it the first.
#[test]
fn e15_accelerations_of_the_leg() {
    let found = solved(&equation_4_11(false));
    assert_close("λ̈ = C⁻¹ h", &found, &LEG.acceleration, 1e-14);
    refuted("λ̇ = C⁻¹ h", &found, &LEG.rate, 0.5);
    // The model's way back from places a step apart: its rates change by λ̈ times the step.
    let h = 1e-5;
    let rate = |t: f64| {
        let at = |i: usize| LEG.position[i] + LEG.rate[i] * t + 0.5 * LEG.acceleration[i] * t * t;
        let motion = LegMotion {
            position: [at(0), at(1), at(2)],
            rate: std::array::from_fn(|i| LEG.rate[i] + LEG.acceleration[i] * t),
            ..LEG
        };
        let [place, velocity, acceleration] = path(&motion);
        LegMotion::of_joint(&place, &velocity, &acceleration).expect("not vertical").rate
    };
    let (later, earlier) = (rate(h), rate(-h));
    let slope: [f64; 3] = std::array::from_fn(|i| (later[i] - earlier[i]) / (2.0 * h));
    assert_close("dλ̇/dt", &slope, &found, 1e-9);
}

/// Dual coordinates that move along a motion.
fn moving(q: &[f64; 6], qd: &[f64; 6]) -> [Dual<f64>; 6] {
    std::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] })
}

/// The legs' rates follow from (v, ω), their accelerations from (a, ω̇); with a dot more on ω neither.
#[test]
fn e16_angular_velocity_in_the_twist() {
    let platform = Platform::default();
    let [q, qd, qdd] = Motion::COMBINED.at(0.3);
    let model = StewartPlatform::<Dual<f64>>::default();
    let twist = model.pose_velocity(&moving(&q, &qd), &moving(&qd, &qdd));
    let [v, w]: [[f64; 3]; 2] = [[0, 1, 2], [3, 4, 5]].map(|rows| rows.map(|i| twist[i].value));
    let wd = [3, 4, 5].map(|i| twist[i].derivative);
    let jacobian = platform.jacobian(&q).unwrap();
    let rates = platform.model().leg_length_velocity(&q, &qd);
    let by = |w: [f64; 3]| times(&jacobian, &[v[0], v[1], v[2], w[0], w[1], w[2]]);
    assert_close("(ẋ, ω)", &by(w), &rates, 1e-14);
    refuted("(ẋ, ω̇)", &by(wd), &rates, 0.01);
    // Of the accelerations J (a, ω̇) is all that is linear in them: what it leaves depends on velocities alone.
    let left = |scale: f64| {
        let qdd = qdd.map(|a| scale * a);
        let rate = model.leg_length_velocity(&moving(&q, &qd), &moving(&qd, &qdd)).map(|l| l.derivative);
        let twist = model.pose_velocity(&moving(&q, &qd), &moving(&qd, &qdd)).map(|x| x.derivative);
        let linear = times(&jacobian, &twist);
        let left: LegVector = std::array::from_fn(|i| rate[i] - linear[i]);
        left
    };
    assert_close("(ẍ, ω̇)", &left(1.0), &left(-3.0), 1e-13);
}

/// φ has inertia of its own; and without the legs' energies their inertia has no effect on forces that it changes by
/// hundreds of newtons.
#[test]
fn e17_coordinates_and_legs() {
    let (whole, bare) = (platform(300.0, true), platform(300.0, false));
    let mut turning = [0.0; 6];
    turning[3] = 1.0;
    let energy = bare.model().kinetic_energy(&HOME, &turning);
    // ½ (55 + 300 (1.0² + 0.8²)/12 + 300 · 0.4²) for a rate of φ, which the printed q does not have.
    assert_close("E of φ̇", &[energy], &[0.5 * (55.0 + 41.0 + 48.0)], 1e-14);
    let [q, qd, qdd] = Motion::TABLE_3.at(0.0);
    let (right, printed) = (whole.leg_forces(&q, &qd, &qdd).unwrap(), bare.leg_forces(&q, &qd, &qdd).unwrap());
    assert_close("table 3, leg 2", &right[1..2], &[1_571.959_86], 1e-8);
    refuted("(4.12) without legs", &printed, &right, 100.0);
}

/// (4.15) leaves out 120 kg·m of coupling, and all that the legs weigh.
#[test]
fn e18_mass_matrix_is_not_diagonal() {
    let [q, qd, qdd] = Motion::COMBINED.at(0.3);
    let bare = platform(300.0, false);
    let matrix = bare.model().mass_matrix(&q);
    let printed = bare.printed_mass_matrix();
    let coupling = (0..36).filter(|i| i / 6 != i % 6).map(|i| matrix[i / 6][i % 6].abs()).fold(0.0, f64::max);
    assert!((coupling - 119.628_893_702).abs() < 1e-8, "{coupling}");
    let (right, wrong) = (bare.leg_forces(&q, &qd, &qdd).unwrap(), bare.printed_leg_forces(&q, &qd, &qdd).unwrap());
    let off: LegVector = std::array::from_fn(|i| (right[i] - wrong[i]).abs());
    let leg = (0..6).max_by(|&i, &j| off[i].total_cmp(&off[j])).expect("six legs");
    // The worst leg is off by 18.8 N of 907.7 N, two parts of a hundred: the motion is slow.
    assert_eq!(leg, 1);
    assert!((right[leg] / 907.727_073_077 - 1.0).abs() < 1e-6, "{}", right[leg]);
    assert!((off[leg] / 18.842_506_900 - 1.0).abs() < 1e-6, "{}", off[leg]);
    // It is right where its assumptions hold.
    let level = bare.with_payload(0.0).unwrap().without_actuator_inertia();
    let (matrix, printed_level) = (level.model().mass_matrix(&HOME), level.printed_mass_matrix());
    for i in 0..6 {
        for j in 0..6 {
            let want = if i == j { printed_level[i] } else { 0.0 };
            assert!((matrix[i][j] - want).abs() < 1e-12, "M[{i}][{j}]");
        }
    }
    assert_eq!(printed[0], 550.0);

    // The blocks m 1, −m R [c]ₓ T, Tᵀ (I + offset) T of the right form.
    let [(sr, cr), (sp, cp)] = [q[3], q[4]].map(f64::sin_cos);
    let t = Matrix3::new(1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp);
    let r = to_matrix(&bare.model().pose(&q).rotation);
    let offset = Vector3::new(0.0, 0.0, 0.4).cross_matrix();
    let inertia = Matrix3::from_diagonal(&Vector3::new(55.0 + 41.0, 55.0 + 52.0, 105.0 + 61.0));
    let blocks = [-300.0 * r * offset * t, t.transpose() * (inertia - 300.0 * offset * offset) * t];
    let full = to_matrix(&bare.model().mass_matrix(&q));
    assert_close("coupling", full.fixed_view::<3, 3>(0, 3).into_owned().as_slice(), blocks[0].as_slice(), 1e-14);
    assert_close("rotation", full.fixed_view::<3, 3>(3, 3).into_owned().as_slice(), blocks[1].as_slice(), 1e-14);
}

/// E_t and E_r make the generated energy; with E_c, chapter 5's whole kinetic energy, translation counts twice.
#[test]
fn e19_energy_of_rotation() {
    let (bare, mut random) = (platform(0.0, false), Random::new(419));
    for _ in 0..20 {
        let (q, qd) = (random_pose(&mut random), random.array(-1.0..1.0));
        let [(sr, cr), (sp, cp)] = [q[3], q[4]].map(f64::sin_cos);
        let t = [[1.0, 0.0, -sp], [0.0, cr, sr * cp], [0.0, -sr, cr * cp]];
        let w = times(&t, &[qd[3], qd[4], qd[5]]);
        let translation = 0.5 * 250.0 * (qd[0] * qd[0] + qd[1] * qd[1] + qd[2] * qd[2]);
        let rotation = 0.5 * (55.0 * w[0] * w[0] + 55.0 * w[1] * w[1] + 105.0 * w[2] * w[2]);
        let whole = bare.model().kinetic_energy(&q, &qd);
        assert_close("E_t + E_r", &[translation + rotation], &[whole], 1e-14);
        refuted("E_t + E_c", &[translation + whole], &[whole], 1.0);
    }
}

/// Six coordinates for six degrees of freedom, and J maps their rates: the Jacobian by angular velocities does not.
#[test]
fn e20_coordinates_are_minimal() {
    // Kutzbach: 14 bodies, 18 joints, of which each leg has a universal, a prismatic and a spherical one.
    assert_eq!(6 * (14 - 1 - 18) + 6 * (2 + 1 + 3), HOME.len() as i32);
    let platform = Platform::default();
    let [q, qd, _] = Motion::COMBINED.at(0.3);
    let rank = Matrix6::from_fn(|i, j| platform.model().mass_matrix(&q)[i][j]).rank(1e-6);
    assert_eq!(rank, 6, "each coordinate moves by itself");
    let h = 1e-6;
    let lengths = |t: f64| platform.lengths(&std::array::from_fn(|i| q[i] + t * qd[i])).unwrap();
    let (later, earlier) = (lengths(h), lengths(-h));
    let rates: LegVector = std::array::from_fn(|i| (later[i] - earlier[i]) / (2.0 * h));
    assert_close("l̇ = J Ẋ", &times(&platform.model().leg_length_jacobian(&q), &qd), &rates, 1e-9);
    refuted("J by angular velocities", &times(&platform.jacobian(&q).unwrap(), &qd), &rates, 1e-3);
}

/// C of (4.18) with `U_M` made by this product, from the derivatives of M stacked.
pub(crate) fn equation_4_18(slopes: &[[[f64; 6]; 6]; 6], qd: &[f64; 6], identity_first: bool) -> Matrix6<f64> {
    let stacked = SMatrix::<f64, 36, 6>::from_fn(|row, column| slopes[row / 6][row % 6][column]);
    let rate = Vector6::from(*qd).transpose();
    let u_m = if identity_first {
        Matrix6::identity().kronecker(&rate) * stacked
    } else {
        rate.kronecker(&Matrix6::identity()) * stacked
    };
    let m_dot: Matrix6<f64> = (0..6).map(|k| qd[k] * to_matrix(&slopes[k])).sum();
    0.5 * (m_dot + u_m.transpose() - u_m)
}

/// The platform with 300 kg on legs without mass, over dual numbers.
pub(crate) fn without_legs() -> StewartPlatform<Dual<f64>> {
    let zero = Dual::constant(0.0);
    StewartPlatform::new(Params {
        cylinder_mass: zero,
        cylinder_inertia: zero,
        piston_mass: zero,
        piston_inertia: zero,
        ..Params::default()
    })
}

/// `∂M/∂q_k` of a mass matrix over dual numbers.
pub(crate) fn slopes(q: &[f64; 6], mass_matrix: impl Fn(&[Dual<f64>; 6]) -> [[Dual<f64>; 6]; 6]) -> [[[f64; 6]; 6]; 6] {
    std::array::from_fn(|k| {
        let along: Coordinates = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        mass_matrix(&moving(q, &along)).map(|row| row.map(|entry| entry.derivative))
    })
}

/// `(I ⊗ q̇ᵀ) ∂M/∂q` gives the generated C of platform and arm, and `Ṁ − 2C` skew; the other order is Ṁ, and Coriolis
/// forces that are wrong by 4.0 N·m.
#[test]
fn e21_kronecker_product_and_its_order() {
    let [q, qd, _] = Motion::COMBINED.at(0.3);
    for (model, own, wrong_by) in [
        (without_legs(), platform(300.0, false), 3.996_688_099_41),
        (StewartPlatform::default(), platform(300.0, true), 4.598_389_669_64),
    ] {
        let slopes = slopes(&q, |q| model.mass_matrix(q));
        let generated = own.model().coriolis_matrix(&q, &qd);
        check_4_18(&slopes, &qd, &generated);
        let wrong = equation_4_18(&slopes, &qd, false) * Vector6::from(qd);
        let off = apart(wrong.as_slice(), &times(&generated, &qd));
        assert!((off - wrong_by).abs() < 1e-8, "{off}");
    }
    let (q, qd) = ([0.4, -1.2, 0.3, 0.5, 0.8, -0.1], [0.3, -0.2, 0.4, -0.5, 0.6, -0.7]);
    let arm = Irb7600::<Dual<f64>>::default();
    let slopes = slopes(&q, |q| arm.mass_matrix(q));
    check_4_18(&slopes, &qd, &Irb7600::<f64>::default().coriolis_matrix(&q, &qd));
}

fn check_4_18(slopes: &[[[f64; 6]; 6]; 6], qd: &[f64; 6], generated: &[[f64; 6]; 6]) {
    let right = equation_4_18(slopes, qd, true);
    assert_close("C of (4.18)", right.transpose().as_slice(), &generated.concat(), 1e-13);
    let m_dot: Matrix6<f64> = (0..6).map(|k| qd[k] * to_matrix(&slopes[k])).sum();
    let skew = m_dot - 2.0 * to_matrix(generated);
    assert_close("Ṁ − 2C", skew.as_slice(), (-skew.transpose()).as_slice(), 1e-13);
    let wrong = equation_4_18(slopes, qd, false);
    assert_close("the other order: ½ Ṁ", wrong.as_slice(), (0.5 * m_dot).as_slice(), 1e-13);
    refuted("the other order", wrong.as_slice(), right.as_slice(), 1.0);
}
