//! The Whipple bicycle against its published benchmarks, linear and nonlinear.
//!
//! # Source
//!
//! - J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, *Linearized dynamics equations for the balance and
//!   steer of a bicycle: a benchmark and review*, Proc. R. Soc. A 463 (2007): the coefficients of
//!   `M q̈ + v C₁ q̇ + (g K₀ + v² K₂) q = f` in lean and steer (section 5a), and the eigenvalues (table 2), which are
//!   also recomputed here from the coefficients.
//! - P. Basu-Mandal, A. Chatterjee, J. M. Papadopoulos, *Hands-free circular motions of a benchmark bicycle*, Proc. R.
//!   Soc. A 463 (2007), table 1: accelerations of the nonlinear bicycle in a state far from upright.

use std::ops::ControlFlow;

use mbs_runtime::{
    Constraints, Dop853, Energies, Integrator, Linearization, Projected, Projector, ReducedLinearization, Reduction,
    ReductionError, State, accelerations, to_matrix,
};
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::whipple_bicycle::WhippleBicycle;
use mbs_tests::random::{self, states};
use nalgebra::{Complex, Matrix2, Matrix4};

// The coordinates by their numbers.
const X: usize = 0;
const Y: usize = 1;
const YAW: usize = 2;
const ROLL: usize = 3;
const PITCH: usize = 4;
const STEER: usize = 5;
const REAR: usize = 6;
const FRONT: usize = 7;
/// All but the pitch, which the front wheel's contact determines.
const COORDINATES: [usize; 7] = [X, Y, YAW, ROLL, STEER, REAR, FRONT];
/// Lean rate, steer rate, and forward speed.
const SPEEDS: [usize; 3] = [ROLL, STEER, REAR];

const GRAVITY: f64 = 9.81;
// As printed; rows lean and steer.
const M: Matrix2<f64> = Matrix2::new(80.81722, 2.319_413_322_087_09, 2.319_413_322_087_09, 0.297_841_881_996_86);
const K0: Matrix2<f64> = Matrix2::new(-80.95, -2.599_516_852_498_72, -2.599_516_852_498_72, -0.803_294_884_586_18);
const K2: Matrix2<f64> = Matrix2::new(0.0, 76.597_345_895_732_22, 0.0, 2.654_315_237_946_04);
const C1: Matrix2<f64> = Matrix2::new(0.0, 33.866_413_914_924_94, -0.850_356_414_569_78, 1.685_403_973_975_60);

/// Upright and straight ahead with the speed v.
fn upright(bicycle: &WhippleBicycle<f64>, v: f64) -> State<[f64; 8]> {
    let (rear, front) = (bicycle.params().r_R, bicycle.params().r_F);
    let mut qd = [0.0; 8];
    (qd[X], qd[REAR], qd[FRONT]) = (v, -v / rear, -v / front);
    State::new([0.0; 8], qd)
}

/// About a state that satisfies the constraints.
fn reduction(bicycle: &WhippleBicycle<f64>, state: &State<[f64; 8]>) -> Reduction<f64, 8, 7, 3> {
    let (a, d) = (bicycle.constraint_jacobian(&state.q), bicycle.constraint_rate_jacobian(&state.q, &state.qd));
    Reduction::new(&a, &d, |row| bicycle.is_holonomic(row), COORDINATES, SPEEDS).expect("independent near upright")
}

fn linearized(bicycle: &WhippleBicycle<f64>, v: f64) -> ReducedLinearization<f64, 7, 3, 2> {
    let state = upright(bicycle, v);
    let (q, qd) = (&state.q, &state.qd);
    assert!(bicycle.constraint_rate(q, qd).iter().all(|rate| rate.abs() < 1e-14));
    assert!(bicycle.constraint(q, qd)[0].abs() < 1e-15);
    assert_close("q̈", &bicycle.forward_dynamics(q, qd, &[0.0; 2]), &[0.0; 8], 1e-12);
    let accelerations: Linearization<f64, 8, 2> = bicycle.linearize(q, qd, &[0.0; 2]);
    reduction(bicycle, &state).linearize(&accelerations)
}

/// `δq̈ = a δq + b δq̇ + c f` of lean and steer, and nothing else moves them.
fn lean_and_steer(reduced: &ReducedLinearization<f64, 7, 3, 2>) -> [Matrix2<f64>; 3] {
    // Places of lean and steer among the independent coordinates.
    let places = [3, 4];
    for (row, rates) in reduced.acceleration_q.iter().enumerate() {
        let others = (0..7).filter(|column| row == 2 || !places.contains(column));
        others.for_each(|column| assert!(rates[column].abs() < 1e-11, "{row} {column}: {}", rates[column]));
    }
    // The forward speed stays as it is, to first order, and has no effect on the lateral motion.
    for i in 0..3 {
        assert!(reduced.acceleration_qd[i][2].abs() < 1e-11 && reduced.acceleration_qd[2][i].abs() < 1e-11);
    }
    let [lean, steer] = places.map(|place| (reduced.rate_q[place], reduced.rate_qd[place]));
    assert_eq!((lean, steer), (([0.0; 7], [1.0, 0.0, 0.0]), ([0.0; 7], [0.0, 1.0, 0.0])));
    [
        Matrix2::from_fn(|i, j| reduced.acceleration_q[i][places[j]]),
        Matrix2::from_fn(|i, j| reduced.acceleration_qd[i][j]),
        Matrix2::from_fn(|i, j| reduced.acceleration_u[i][j]),
    ]
}

fn assert_equal(what: &str, got: Matrix2<f64>, want: Matrix2<f64>, tolerance: f64) {
    let error = (got - want).abs().max();
    assert!(error <= tolerance, "{what}: error {error:e}\n got: {got:?}\nwant: {want:?}");
}

/// M is the inverse of what torques do, as lean and steer torque are the forces of the two speeds; it is also the mass
/// matrix of the independent speeds, `Rᵀ M R`, in which the forward speed stands apart. C₁ and K then are `−M` times
/// the slopes of the accelerations, and K splits by the speed.
#[test]
fn canonical_coefficients() {
    let bicycle = WhippleBicycle::<f64>::default();
    let still = upright(&bicycle, 0.0);
    let r = to_matrix(&reduction(&bicycle, &still).r);
    let mass = r.transpose() * to_matrix(&bicycle.mass_matrix(&still.q)) * r;
    assert_equal("Rᵀ M R", mass.fixed_view::<2, 2>(0, 0).into_owned(), M, 1e-13);
    assert!(mass[(0, 2)].abs() < 1e-13 && mass[(1, 2)].abs() < 1e-13, "{mass}");

    let [at_rest, _, by_torque] = lean_and_steer(&linearized(&bicycle, 0.0));
    let m = by_torque.try_inverse().expect("positive definite");
    assert_equal("M", m, M, 1e-12);
    let gravity = -M * at_rest;
    assert_equal("g K₀", gravity, K0 * GRAVITY, 1e-11);
    assert_equal("K₀", gravity / GRAVITY, K0, 1e-12);
    for v in (1..=10).map(f64::from) {
        let [by_position, by_rate, by_torque] = lean_and_steer(&linearized(&bicycle, v));
        assert_equal("M", by_torque.try_inverse().expect("positive definite"), M, 1e-12);
        assert_equal("C₁", -M * by_rate / v, C1, 1e-11);
        assert_equal("K₂", (-M * by_position - gravity) / (v * v), K2, 2e-11);
    }
}

/// Of `δq̈ = a δq + b δq̇`, in order of real and imaginary parts.
fn eigenvalues(a: Matrix2<f64>, b: Matrix2<f64>) -> Vec<Complex<f64>> {
    let mut system = Matrix4::zeros();
    system.fixed_view_mut::<2, 2>(0, 2).copy_from(&Matrix2::identity());
    system.fixed_view_mut::<2, 2>(2, 0).copy_from(&a);
    system.fixed_view_mut::<2, 2>(2, 2).copy_from(&b);
    let mut values: Vec<Complex<f64>> = system.complex_eigenvalues().iter().copied().collect();
    // Conjugate pairs have real parts that are equal but for rounding.
    let rounded = |x: f64| (x * 1e8).round();
    values.sort_by(|x, y| rounded(x.re).total_cmp(&rounded(y.re)).then(x.im.total_cmp(&y.im)));
    values
}

/// Table 2: v, castering, capsize, weave; at rest there are four real ones.
#[rustfmt::skip]
const PUBLISHED: [(f64, f64, f64, f64, f64); 10] = [
    (1.0,  -7.110_080_146_374_42, -3.134_231_250_665_78,  3.526_961_709_900_70, 0.807_740_275_199_30),
    (2.0,  -8.673_879_848_317_35, -3.071_586_456_415_14,  2.682_345_175_127_45, 1.680_662_965_906_75),
    (3.0, -10.351_014_672_459_2,  -2.633_661_372_536_67,  1.706_756_056_639_75, 2.315_824_473_843_25),
    (4.0, -12.158_614_265_764_47, -1.429_444_273_613_26,  0.413_253_315_211_25, 3.079_108_186_032_06),
    (5.0, -14.078_389_692_798_22, -0.322_866_429_004_09, -0.775_341_882_195_85, 4.464_867_713_788_23),
    (6.0, -16.085_371_230_980_26, -0.004_066_900_769_70, -1.526_444_865_841_42, 5.876_730_605_987_09),
    (7.0, -18.157_884_661_252_62,  0.102_681_705_747_66, -2.138_756_442_583_62, 7.195_259_133_298_05),
    (8.0, -20.279_408_943_945_69,  0.143_278_797_657_13, -2.693_486_835_810_97, 8.460_379_713_969_31),
    (9.0, -22.437_885_590_408_58,  0.157_901_840_309_17, -3.216_754_022_524_85, 9.693_773_515_317_91),
    (10.0, -24.624_596_350_174_04, 0.161_053_386_531_72, -3.720_168_404_372_87, 10.906_811_394_762_87),
];

#[test]
fn published_eigenvalues() {
    let bicycle = WhippleBicycle::<f64>::default();
    let mut worst = [0.0_f64; 2];
    let mut compare = |v: f64, published: [Complex<f64>; 4]| {
        let [a, b, _] = lean_and_steer(&linearized(&bicycle, v));
        let found = eigenvalues(a, b);
        let inverse = M.try_inverse().expect("positive definite");
        let canonical = eigenvalues(-inverse * (K0 * GRAVITY + K2 * v * v), -inverse * C1 * v);
        for i in 0..4 {
            let [by_table, by_coefficients] = [published[i], canonical[i]].map(|value| (found[i] - value).norm());
            worst = [worst[0].max(by_table), worst[1].max(by_coefficients / canonical[i].norm())];
            // Fourteen decimals are printed; their last two are what the authors' arithmetic left.
            assert!(by_table < 2e-12, "{v} m/s: {} {}", found[i], published[i]);
            assert!(by_coefficients < 1e-10 * canonical[i].norm(), "{v} m/s: {} {}", found[i], canonical[i]);
        }
    };
    let real = |x| Complex::new(x, 0.0);
    let (lean, steer) = (3.131_643_247_906_56, 5.530_943_717_653_93);
    compare(0.0, [-steer, -lean, lean, steer].map(real));
    for (v, castering, capsize, re, im) in PUBLISHED {
        let weave = [Complex::new(re, -im), Complex::new(re, im)];
        let [first, second] = weave;
        let published = if capsize < re {
            [real(castering), real(capsize), first, second]
        } else {
            [real(castering), first, second, real(capsize)]
        };
        compare(v, published);
    }
    println!("largest difference to the table {:e}, to the coefficients (relative) {:e}", worst[0], worst[1]);
}

/// A state far from upright. The table has y upwards and the bicycle going along −x: rates and most angles change their
/// sign; wheels turn against the rear frame there.
#[test]
fn published_nonlinear_accelerations() {
    let bicycle = WhippleBicycle::<f64>::default();
    let (psi, phi, psi_f) = (0.950_129_285_147_2, 3.125_707_301_489_4, 0.231_138_513_574_3);
    let (half, full) = (std::f64::consts::FRAC_PI_2, std::f64::consts::PI);
    let q = [0.0, 0.0, 0.0, half - psi, full - phi, -psi_f, 0.0, 0.0];
    let [yaw, roll, pitch, steer, rear, front] = [
        -0.783_003_352_706_5,
        -0.606_842_583_541_8,
        0.011_918_552_806_9,
        -0.485_982_468_709_3,
        -8.912_989_661_489_0,
        -8.013_362_058_415_5,
    ];
    // Rolling of the rear wheel without the others gives the velocity of its contact.
    let mut qd = [0.0, 0.0, yaw, roll, pitch, steer, rear + pitch, front];
    let [_, x, y, ..] = bicycle.constraint_rate(&q, &qd);
    (qd[X], qd[Y]) = (-x, -y);
    let [contact, ..] = bicycle.constraint(&q, &qd);
    assert!(contact.abs() < 1e-12, "{contact:e}");
    assert_close("A q̇", &bicycle.constraint_rate(&q, &qd), &[0.0; 5], 1e-11);
    let qdd = bicycle.forward_dynamics(&q, &qd, &[0.0; 2]);
    let want = [
        -0.835_328_170_637_9,
        7.855_528_112_824_4,
        -0.120_554_389_788_4,
        4.619_890_403_940_3,
        -1.847_255_414_421_7 - 0.120_554_389_788_4,
        -2.454_807_290_455_0,
    ];
    println!("{:?} {want:?}", &qdd[YAW..]);
    assert_close("q̈", &qdd[YAW..], &want, 1e-11);
}

/// φ is the height of the lowest point of the front wheel's rim, as points of the rim tell.
#[test]
fn the_front_wheel_touches_with_its_lowest_point() {
    let bicycle = WhippleBicycle::<f64>::default();
    let radius = bicycle.params().r_F;
    for random::State { q, qd, .. } in states::<8>(51, 40) {
        let pose = bicycle.front_hub(&q);
        let point = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 4000.0).sin_cos();
            pose.transform_point([radius * cos, 0.0, radius * sin])[2]
        };
        let lowest = (0..4000).map(point).fold(f64::NEG_INFINITY, f64::max);
        let [contact, ..] = bicycle.constraint(&q, &qd);
        // Neighbouring points of the rim are 0.5 mm apart, and less than 1 µm lower than the lowest of the circle.
        assert!((contact - lowest).abs() < 1e-6, "{contact} {lowest}");
    }
}

/// Five seconds at 4.6 m/s after a push in roll of 0.5 rad/s, as in figure 4 of Meijaard et al.: it rights itself, and
/// keeps its energy.
#[test]
fn it_rights_itself() {
    let bicycle = WhippleBicycle::<f64>::default();
    let mut state = upright(&bicycle, 4.6);
    state.qd[ROLL] = 0.5;
    let mut projector = Projector::new(vec![0.0; Projector::<f64, Vec<f64>>::size(8, 5)]);
    projector.project(&bicycle, 0.0, &mut state).expect("near upright");
    let energy = |s: &State<[f64; 8]>| {
        Energies::kinetic_energy(&bicycle, 0.0, &s.q, &s.qd) + Energies::potential_energy(&bicycle, 0.0, &s.q)
    };
    let (initial, lean) = (energy(&state), state.qd[ROLL]);
    let mut drift = 0.0_f64;
    Projected { method: Dop853::new(1e-10, 1e-12), drift: projector.onto(&bicycle) }
        .integrate(accelerations(&bicycle, |_, _, _| [0.0; 2]), 0.0, 5.0, &mut state, |step| {
            drift = drift.max((energy(step.previous_state()) / initial - 1.0).abs());
            ControlFlow::Continue(())
        })
        .expect("a smooth motion");
    println!("drift {drift:e}, end {state:?}");
    assert!(lean > 0.4 && drift < 1e-10, "{drift:e}");
    assert!(state.q[ROLL].abs() < 0.02 && state.qd[ROLL].abs() < 0.05 && state.q[STEER].abs() < 0.02, "{state:?}");
    // Energy goes from the lateral motion into speed.
    assert!(-state.qd[REAR] * bicycle.params().r_R > 4.61);
    assert_close("A q̇", &bicycle.constraint_rate(&state.q, &state.qd), &[0.0; 5], 1e-13);
}

/// Coordinates and speeds that are not independent are named.
#[test]
fn what_is_not_independent_is_named() {
    let bicycle = WhippleBicycle::<f64>::default();
    let State { q, qd } = upright(&bicycle, 5.0);
    let (a, d) = (bicycle.constraint_jacobian(&q), bicycle.constraint_rate_jacobian(&q, &qd));
    let reduce = |coordinates: [usize; 7], speeds: [usize; 3]| {
        Reduction::new(&a, &d, |row| bicycle.is_holonomic(row), coordinates, speeds).map(|_| ())
    };
    assert_eq!(reduce(COORDINATES, SPEEDS), Ok(()));
    // The forward speed is that of either wheel.
    assert_eq!(reduce(COORDINATES, [ROLL, STEER, FRONT]), Ok(()));
    let twice = reduce(COORDINATES, [ROLL, REAR, FRONT]);
    assert!(matches!(twice, Err(ReductionError::DependentSpeed { index: REAR | FRONT })), "{twice:?}");
    // Upright, to first order, the pitch is given, and the roll is not.
    let pitch = reduce([X, Y, YAW, PITCH, STEER, REAR, FRONT], SPEEDS);
    assert_eq!(pitch, Err(ReductionError::DependentCoordinate { index: PITCH }));
}
