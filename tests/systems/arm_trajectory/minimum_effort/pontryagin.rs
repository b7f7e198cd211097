//! Swing-ups, found a second time by solving the boundary value problem of Pontryagin's principle.
//!
//! With `H = u² + pᵀ f(x, u)` and f linear in u: `u = −½ pᵀ ∂f/∂u`, `ẋ = f`, `ṗ = −(∂f/∂x)ᵀ p`. The equations of motion
//! are typed here; dual numbers differentiate them, Runge and Kutta's method of order four integrates them, and
//! Newton's method finds the costates at the start from which the motion arrives.

use nalgebra::{DMatrix, DVector};

use super::*;

type Field<const N: usize> = fn([Dual<f64>; N], Dual<f64>) -> [Dual<f64>; N];

fn with<const N: usize>(x: [f64; N], along: Option<usize>) -> [Dual<f64>; N] {
    core::array::from_fn(|i| Dual { value: x[i], derivative: if along == Some(i) { 1.0 } else { 0.0 } })
}

/// `(ẋ, ṗ, u²)`.
fn rates<const N: usize>(field: Field<N>, x: [f64; N], p: [f64; N]) -> ([f64; N], [f64; N], f64) {
    let by_input = field(with(x, None), Dual::variable(0.0)).map(|f| f.derivative);
    let u = -0.5 * (0..N).map(|i| p[i] * by_input[i]).sum::<f64>();
    let costate = core::array::from_fn(|j| {
        let slopes = field(with(x, Some(j)), Dual::constant(u));
        -(0..N).map(|i| p[i] * slopes[i].derivative).sum::<f64>()
    });
    (field(with(x, None), Dual::constant(u)).map(|f| f.value), costate, u * u)
}

/// Where the motion ends that begins with these costates, and its effort.
fn shot<const N: usize>(field: Field<N>, start: [f64; N], costate: [f64; N], duration: f64) -> ([f64; N], f64) {
    const STEPS: usize = 4000;
    let h = duration / STEPS as f64;
    let (mut x, mut p, mut effort) = (start, costate, 0.0);
    for _ in 0..STEPS {
        let moved = |r: &([f64; N], [f64; N], f64), by: f64| {
            let [x, p]: [[f64; N]; 2] =
                [(x, r.0), (p, r.1)].map(|(at, rate)| core::array::from_fn(|i| at[i] + by * rate[i]));
            rates(field, x, p)
        };
        let k1 = rates(field, x, p);
        let k2 = moved(&k1, 0.5 * h);
        let k3 = moved(&k2, 0.5 * h);
        let k4 = moved(&k3, h);
        let mean = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        for i in 0..N {
            x[i] += mean(k1.0[i], k2.0[i], k3.0[i], k4.0[i]);
            p[i] += mean(k1.1[i], k2.1[i], k3.1[i], k4.1[i]);
        }
        effort += mean(k1.2, k2.2, k3.2, k4.2);
    }
    (x, effort)
}

/// The effort of the extremal from start to stop, and its costates at the start, near to those given.
fn extremal<const N: usize>(
    field: Field<N>,
    [start, stop]: [[f64; N]; 2],
    near: [f64; N],
    duration: f64,
) -> ([f64; N], f64) {
    let mut costate = near;
    for _ in 0..20 {
        let (end, effort) = shot(field, start, costate, duration);
        let miss = DVector::from_fn(N, |i, _| end[i] - stop[i]);
        if miss.amax() < 1e-9 {
            return (costate, effort);
        }
        let slopes = DMatrix::from_fn(N, N, |i, j| {
            let step = 1e-6 * costate[j].abs().max(1.0);
            let ends = [step, -step].map(|step| {
                let mut moved = costate;
                moved[j] += step;
                shot(field, start, moved, duration).0[i]
            });
            (ends[0] - ends[1]) / (2.0 * step)
        });
        let change = slopes.lu().solve(&miss).unwrap();
        costate = core::array::from_fn(|i| costate[i] - change[i]);
    }
    panic!("the shooting does not arrive");
}

fn costates<const N: usize>(motion: &MinimumEffort<N, 1>) -> Vec<f64> {
    motion.points()[0].costate.concat()
}

/// `θ̈ = −g sin θ + τ`, for 1 kg and 1 m.
fn pendulum([theta, rate]: [Dual<f64>; 2], torque: Dual<f64>) -> [Dual<f64>; 2] {
    [rate, torque - Dual::constant(9.81) * theta.sin()]
}

#[test]
fn a_pendulum_swings_up_as_pontryagin_has_it() {
    let mechanism = Pendulum::<Dual<f64>>::default();
    let transfer = turn(std::f64::consts::PI, 3.0, Limits::NONE);
    let found = |intervals| minimum_effort(&mechanism, &transfer, intervals, None).unwrap();
    let motions = [20, 40, 80].map(found);
    let finest = costates(&motions[2]);
    let (costate, effort) = extremal(pendulum, [[0.0; 2], [std::f64::consts::PI, 0.0]], [finest[0], finest[1]], 3.0);
    // The method is of the fourth order.
    let errors = motions.each_ref().map(|motion| motion.effort() - effort);
    assert!((errors[2] / effort).abs() < 1e-6, "{errors:?} of {effort}");
    for pair in errors.windows(2) {
        assert!((12.0..20.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    for (found, want) in finest.iter().zip(costate) {
        assert!((found - want).abs() < 2e-3 * want.abs(), "{finest:?} {costate:?}");
    }
    // H is the same everywhere; it is the derivative of the least effort by the time.
    let middle = |motion: &MinimumEffort<1, 1>| motion.points()[motion.points().len() / 2].hamiltonian;
    let spread = |motion: &MinimumEffort<1, 1>| {
        motion.points().iter().map(|point| (point.hamiltonian - middle(motion)).abs()).fold(0.0, f64::max)
    };
    assert!(spread(&motions[2]) < 1e-3 * middle(&motions[2]).abs(), "{}", spread(&motions[2]));
    let [later, earlier] = [1e-3, -1e-3].map(|change| {
        let transfer = Transfer { duration: 3.0 + change, ..transfer };
        minimum_effort(&mechanism, &transfer, 80, Some(&motions[2])).unwrap().effort()
    });
    let slope = (later - earlier) / 2e-3;
    assert!((slope / middle(&motions[2]) - 1.0).abs() < 1e-4, "{slope} {}", middle(&motions[2]));
}

/// Kelly's equations of the cart with a pole, θ from straight down, with his numbers.
///
/// # Source
/// M. Kelly, *An introduction to trajectory optimization*, SIAM Review 59:4, 2017, equations (6.1) and (6.2) and
/// appendix E.1: 1 kg, 0.3 kg, 0.5 m, 9.81 m/s², 1 m in 2 s.
fn cart_pole([_, theta, speed, rate]: [Dual<f64>; 4], push: Dual<f64>) -> [Dual<f64>; 4] {
    let [m1, m2, l, g] = [1.0, 0.3, 0.5, 9.81].map(Dual::constant);
    let (sin, cos) = (theta.sin(), theta.cos());
    let heavy = m1 + m2 * sin * sin;
    let cart = (l * m2 * sin * rate * rate + push + m2 * g * cos * sin) / heavy;
    let pole = -(l * m2 * cos * sin * rate * rate + push * cos + (m1 + m2) * g * sin) / (l * heavy);
    [speed, rate, cart, pole]
}

#[test]
fn a_cart_swings_its_pole_up_as_pontryagin_has_it() {
    let params = cart_pole::Params { m_bob: 0.3, b: 0.0, ..cart_pole::Params::default() };
    let cart_pole::Params { m_cart, m_bob, length, g, b } = params;
    let [m_cart, m_bob, length, g, b] = [m_cart, m_bob, length, g, b].map(Dual::constant);
    let mechanism = CartPole::new(cart_pole::Params { m_cart, m_bob, length, g, b });
    let limits = Limits { lower: [-2.0, -10.0], upper: [2.0, 10.0], input: [20.0], ..Limits::NONE };
    let stop = [[1.0, std::f64::consts::PI], [0.0; 2]];
    let transfer = Transfer { start: [[0.0; 2]; 2], stop, duration: 2.0, scale: [1.0], limits };
    let motion = minimum_effort(&mechanism, &transfer, 100, None).unwrap();
    let near: [f64; 4] = costates(&motion).try_into().unwrap();
    let (_, effort) = extremal(cart_pole, [[0.0; 4], [1.0, std::f64::consts::PI, 0.0, 0.0]], near, 2.0);
    assert!((motion.effort() / effort - 1.0).abs() < 1e-6, "{} {effort}", motion.effort());
    // No limit acts, as in the paper's figure.
    assert!(motion.points().iter().all(|point| point.input[0].abs() < 19.0 && point.state.q[0].abs() < 1.9));
}
