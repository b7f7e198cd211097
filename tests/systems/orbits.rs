//! `mbs_orbit` around the generated mechanisms: libration points, a station's motion, collisions; and the
//! mechanisms themselves against Kepler's laws.

use mbs_models::check::Must;
use mbs_models::cr3bp::{Cr3bp, Params};
use mbs_models::kepler::{self, Kepler};
use mbs_models::relative_isotropic::{self, RelativeIsotropic};
use mbs_models::two_body::TwoBody;
use mbs_models::{At, Error, Failure};
use mbs_orbit::EARTH_MU;
use mbs_orbit::collision::fly;
use mbs_orbit::libration::{Modes, Point, points};
use mbs_orbit::station::{Station, from_cylindrical, to_cylindrical};
use mbs_runtime::{Dop853, State, accelerations};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;

/// At rest at each point nothing pulls, for mass ratios from a grain's to equal ones.
#[test]
fn bodies_rest_at_the_libration_points() {
    for mu in [1e-12, 3e-6, 9.5e-4, 0.012_150_585_6, 0.2, 0.5] {
        let system = Cr3bp::new(Params { mu });
        for (i, [x, y]) in points(mu).unwrap().into_iter().enumerate() {
            // One unit in the last place of x weighs by the stiffness of the point.
            let stiffness =
                system.linearize(&[x, y, 0.0], &[0.0; 3]).q.concat().into_iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            let pull = system.forward_dynamics(&[x, y, 0.0], &[0.0; 3]);
            assert!(pull.iter().all(|a| a.abs() < 4e-16 * stiffness), "L{} for {mu}: {pull:?}", i + 1);
        }
    }
    for mu in [0.0, -0.1, 0.6, f64::NAN, f64::INFINITY] {
        let refused = points(mu).unwrap_err();
        assert!(refused.invalid().is_some_and(|found| found.value == mu || mu.is_nan()), "{refused}");
    }
    assert_eq!(
        Modes::about(0.7, Point::L4),
        Err(Must::BeAtMost(0.5).broken_by("part of the smaller primary", 0.7).into())
    );
}

/// L₁ to L₃ are never stable, L₄ and L₅ up to Routh's mass ratio; the rates are those of the characteristic equation in
/// textbooks.
#[test]
fn triangles_are_stable_up_to_rouths_mass_ratio() {
    let routh = 0.5 * (1.0 - (23.0_f64 / 27.0).sqrt());
    for (mu, stable) in [(0.012, true), (routh * (1.0 - 1e-9), true), (routh * (1.0 + 1e-9), false), (0.3, false)] {
        for (i, point) in Point::ALL.into_iter().enumerate() {
            let modes = Modes::about(mu, point).unwrap();
            assert_eq!(modes.is_stable(), stable && i >= 3, "L{} for {mu}: {modes:?}", i + 1);
            assert_eq!(modes.growth() == 0.0, modes.is_stable());
            if i >= 3 {
                // λ⁴ + λ² + 27/4 μ (1 − μ) = 0, and a turn of the primaries for each oscillation out of the plane.
                let [sum, product] = match modes.plane {
                    [[a, 0.0], [b, 0.0]] => [a + b, a * b],
                    [[a, b], [c, d]] => [a + c, a * c - b * d],
                };
                assert_close("λ²", &[sum, product, modes.normal], &[-1.0, 6.75 * mu * (1.0 - mu), -1.0], 1e-12);
            }
        }
    }
}

/// A displaced body leaves L₁ at the rate that the linearization says.
#[test]
fn the_growth_is_that_of_the_motion() {
    let mu = 0.012_150_585_6;
    let [l1, ..] = points(mu).unwrap();
    let growth = Modes::about(mu, Point::L1).unwrap().growth();
    let system = Cr3bp::new(Params { mu });
    // Once the direction of growth has won, the distance grows by the same factor in equal times.
    let mut state = State { q: [l1[0] + 1e-9, 0.0, 0.0], qd: [0.0; 3] };
    let mut distances = Vec::new();
    for t in [0.0, 3.0, 4.0] {
        if t > 0.0 {
            let from = if t == 3.0 { 0.0 } else { 3.0 };
            let motion = accelerations(&system, |_, _: &[f64; 3], _: &[f64; 3]| []);
            fly(&Dop853::new(1e-13, 1e-18), motion, [from, t], &mut state, |_, _| 1.0, 0.0, |_| ()).unwrap();
            distances.push((state.q[0] - l1[0]).hypot(state.q[1]));
        }
    }
    let measured = (distances[1] / distances[0]).ln();
    assert!((measured - growth).abs() < 2e-3 * growth, "{measured}, {growth}");
}

/// r and ν with their derivatives, against the vectors of the same motion and against differences.
#[test]
fn the_signals_of_a_station_fit_together() {
    for eccentricity in [0.0, 0.1, 0.7, 1.0, 2.5] {
        let station = Station::from_periapsis(EARTH_MU, 7e6, eccentricity).unwrap();
        for t in [-3000.0, -1.0, 0.0, 700.0, 9000.0] {
            let [[r, r_dot, r_ddot], [nu, nu_dot, nu_ddot]] = station.signals(t).unwrap();
            let state = station.state(t).unwrap();
            let [x, y, _] = state.position;
            let turned = [r_dot * nu.cos() - r * nu_dot * nu.sin(), r_dot * nu.sin() + r * nu_dot * nu.cos()];
            assert_close("place", &[r * nu.cos(), r * nu.sin()], &[x, y], 1e-12);
            assert_close("velocity", &turned, &state.velocity[..2], 1e-12);
            let step = 0.5;
            let [before, after] = [-step, step].map(|dt| station.signals(t + dt).unwrap());
            let slope = |i: usize| [0, 1].map(|k| (after[k][i] - before[k][i]) / (2.0 * step));
            let [rates, seconds] = [slope(0), slope(1)];
            assert!((rates[0] - r_dot).abs() < 1e-5 * (1.0 + r_dot.abs()), "{eccentricity} {t}");
            assert!((seconds[0] - r_ddot).abs() < 1e-6 * (1.0 + r_ddot.abs()), "{eccentricity} {t}");
            assert!((seconds[1] - nu_ddot).abs() < 1e-6 * nu_dot * nu_dot.max(1e-3), "{eccentricity} {t}");
        }
    }
}

#[test]
fn a_station_that_cannot_be_is_refused() {
    let not_positive = |parameter, value| Err(Must::BePositive.broken_by(parameter, value).into());
    assert_eq!(Station::on_a_circle(-1.0, 7e6), not_positive("mu", -1.0));
    assert_eq!(Station::on_a_circle(EARTH_MU, 0.0), not_positive("periapsis", 0.0));
    let negative = |parameter, value| Err(Must::NotBeNegative.broken_by(parameter, value).into());
    assert_eq!(Station::from_periapsis(EARTH_MU, 7e6, -0.1), negative("eccentricity", -0.1));
    let station = Station::on_a_circle(EARTH_MU, 7e6).unwrap();
    assert_eq!(station.with_mass(-5.0), negative("station mass", -5.0));
    assert!(station.with_mass(f64::NAN).unwrap_err().invalid().is_some());
    assert!(Station::from_periapsis(EARTH_MU, 7e6, f64::INFINITY).is_err());
    assert!(station.signals(f64::NAN).unwrap_err().invalid().is_some_and(|error| error.value.is_nan()));
    // Below the surface: computed all the same, with a warning that names both numbers.
    assert_eq!(station.below(6_378_137.0), None);
    let low = Station::on_a_circle(EARTH_MU, 6e6).unwrap().below(6_378_137.0).unwrap();
    assert_eq!((low.periapsis, low.surface), (6e6, 6_378_137.0));
    assert!(low.to_string().contains("6000000") && low.to_string().contains("6378137"));
}

#[test]
fn cylindrical_coordinates_there_and_back() {
    let mut random = Random::new(5);
    for _ in 0..100 {
        let local = State { q: random.array(-3.0..3.0), qd: random.array(-1.0..1.0) };
        let Ok(cylindrical) = to_cylindrical(&local) else {
            assert_eq!((local.q[0], local.q[1]), (0.0, 0.0));
            continue;
        };
        let back = from_cylindrical(&cylindrical);
        assert_close("place", &back.q, &local.q, 1e-14);
        assert_close("velocity", &back.qd, &local.qd, 1e-13);
    }
    let above = State { q: [0.0, 0.0, 2.0], qd: [0.1, 0.0, 0.0] };
    let open = Failure::Undetermined("the direction to a body at the station itself");
    assert_eq!(to_cylindrical(&above), Err(open.into()));
}

/// From rest at r₀ two points meet after `π √(r₀³/(8 μ))`, and spheres that touch at half of r₀ after `(½ + π/4)
/// √(r₀³/(2 μ))`.
#[test]
fn bodies_that_fall_into_each_other_collide_in_time() {
    let body = Kepler::new(kepler::Params { mu: 2.0, m: 1.0 });
    let motion = || accelerations(&body, |_, _: &[f64; 3], _: &[f64; 3]| [0.0; 3]);
    let distance = |_: f64, s: &State<[f64; 3]>| s.q[0].hypot(s.q[1]).hypot(s.q[2]);
    let start = State { q: [1.2, -0.4, 0.3], qd: [0.0; 3] };
    let first = distance(0.0, &start);
    let dop853 = Dop853::new(1e-10, 1e-12);
    let fall = |contact: f64| {
        let mut state = start;
        fly(&dop853, motion(), [0.0, 100.0], &mut state, distance, contact, |_| ())
    };
    let points_meet = std::f64::consts::PI * (first.powi(3) / 16.0).sqrt();
    let collision = |contact: f64| match fall(contact) {
        Err(Error { failure: Failure::Collision { distance }, at: Some(At::Time(time)) }) => (time, distance),
        other => panic!("they meet: {other:?}"),
    };
    let (time, last) = collision(0.0);
    assert!((time - points_meet).abs() < 1e-4 * points_meet && last < 1e-3 * first, "{time}, {points_meet}, {last}");
    let spheres_touch = (0.5 + std::f64::consts::FRAC_PI_4) * (first.powi(3) / 4.0).sqrt();
    let (time, last) = collision(0.5 * first);
    assert!((time - spheres_touch).abs() < 1e-9 && (last - 0.5 * first).abs() < 1e-9, "{time}, {spheres_touch}");
    let inside = Must::BeMoreThan(2.0).broken_by("distance at the beginning", first);
    assert_eq!(fall(2.0), Err(inside.into()));
    for contact in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(fall(contact).unwrap_err().invalid().is_some());
    }
    // A motion that stays away is flown to its end.
    let mut circle = State { q: [1.0, 0.0, 0.0], qd: [0.0, 2.0_f64.sqrt(), 0.0] };
    let summary = fly(&dop853, motion(), [0.0, 10.0], &mut circle, distance, 0.5, |_| ()).unwrap();
    assert!(!summary.stopped && summary.time == 10.0);
}

/// An astronaut next to a heavy station falls onto its hull, and onto its point if it has none.
#[test]
fn an_astronaut_next_to_a_heavy_station_falls_onto_it() {
    let station = Station::on_a_circle(EARTH_MU, 6_778_137.0).unwrap().with_mass(420e3).unwrap();
    let distance = |_: f64, s: &State<[f64; 3]>| s.q[0].hypot(s.q[1]).hypot(s.q[2]);
    let fall = |contact: f64| {
        let mut state = State { q: [0.0, 0.0, 0.5], qd: [0.0; 3] };
        fly(
            &Dop853::new(1e-10, 1e-12),
            station.accelerations_about(),
            [0.0, 5000.0],
            &mut state,
            distance,
            contact,
            |_| (),
        )
    };
    // From rest at a to r in a free fall of its own: √(a³/2μ) (√(s (1 − s)) + acos √s), s = r/a. The tide across the
    // orbit, n² z, adds half of n² a³/μ to the pull at the beginning, a hundredth, less later on.
    for contact in [0.0, 0.1] {
        let s: f64 = contact / 0.5;
        let alone = (0.125 / (2.0 * 6.6743e-11 * 420e3_f64)).sqrt() * ((s * (1.0 - s)).sqrt() + s.sqrt().acos());
        let Err(Error { failure: Failure::Collision { .. }, at: Some(At::Time(time)) }) = fall(contact) else {
            panic!("it falls")
        };
        assert!(time < alone && time > 0.99 * alone, "{time}, {alone}");
    }
}

/// Two bodies in inertial axes: the barycentre stays, and the relative motion is Kepler's, with the same vectors of
/// Laplace.
#[test]
fn two_bodies_move_as_one_relative_to_the_other() {
    let pair = TwoBody::new(mbs_models::two_body::Params { G: 1.0, mass: [0.7, 0.3] });
    let relative = Kepler::new(kepler::Params { mu: 1.0, m: 0.21 });
    let mut random = Random::new(2);
    for _ in 0..100 {
        let (r, v): ([f64; 3], [f64; 3]) = (random.array(0.5..2.0), random.array(-1.0..1.0));
        if r.iter().all(|x| *x == 0.0) {
            continue;
        }
        let place = |share: f64, v: &[f64; 3]| v.map(|x| share * x);
        let q: [f64; 6] = [place(-0.3, &r), place(0.7, &r)].concat().try_into().unwrap();
        let qd: [f64; 6] = [place(-0.3, &v), place(0.7, &v)].concat().try_into().unwrap();
        let both = pair.forward_dynamics(&q, &qd);
        let one = relative.forward_dynamics(&r, &v, &[0.0; 3]);
        assert_close("relative", &std::array::from_fn::<_, 3, _>(|i| both[3 + i] - both[i]), &one, 1e-13);
        assert_close(
            "barycentre",
            &std::array::from_fn::<_, 3, _>(|i| 0.7 * both[i] + 0.3 * both[3 + i]),
            &[0.0; 3],
            1e-14,
        );
        assert_close("energy", &pair.conserved(&q, &qd), &relative.conserved(&r, &v), 1e-13);
        let momentum = relative.angular_momentum(&r, &v).map(|l| 0.21 * l);
        assert_close("angular momentum", &pair.angular_momentum(&q, &qd), &momentum, 1e-13);
    }
}

/// How long the approximation behind (7.13) is good: its error reaches a hundredth of the way within a minute and a
/// quarter, at any distance, as what it drops is as large as what it keeps.
#[test]
fn the_approximation_7_13_is_good_for_a_minute() {
    let station = Station::on_a_circle(EARTH_MU, 6_778_137.0).unwrap();
    let omega = station.rate();
    for distance in [3.0, 300.0, 30_000.0] {
        let body = RelativeIsotropic::new(relative_isotropic::Params { m: 1.0, omega, station_mass: 0.0 });
        let dop853 = Dop853::new(1e-13, 1e-13);
        let (mut exact, mut polar) =
            (State { q: [distance, 0.0, 0.0], qd: [0.0; 3] }, State { q: [distance, 0.0], qd: [0.0; 2] });
        let mut good = 0.0;
        for second in 0..200 {
            let span = [f64::from(second), f64::from(second + 1)];
            fly(&dop853, station.accelerations_about(), span, &mut exact, |_, s| s.q[0].abs(), 0.0, |_| ()).unwrap();
            let motion = accelerations(&body, |_, _: &[f64; 2], _: &[f64; 2]| []);
            fly(&dop853, motion, span, &mut polar, |_, s| s.q[0], 0.0, |_| ()).unwrap();
            let (sin, cos) = polar.q[1].sin_cos();
            let apart = (exact.q[0] - polar.q[0] * cos).hypot(exact.q[1] - polar.q[0] * sin);
            if apart > 0.01 * distance {
                break;
            }
            good = span[1];
        }
        // 3/2 ω² t² = 1 %
        let expected = (0.02_f64 / 3.0).sqrt() / omega;
        assert!((good - expected).abs() < 0.02 * expected, "{distance} m: {good} s, {expected} s");
    }
}
