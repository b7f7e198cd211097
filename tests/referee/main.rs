//! The generator against a second reading of the language.
//!
//! A short run of what `cargo run --release -p mbs-tests --bin referee -- --seed 1 --count 10000` does at length.

use mbs_tests::referee::{Construct, draw, draw_piecewise, judge, proved, shrink, shrink_unproved};
use mbs_tests::robustness::Models;

/// Mechanisms of the manual that are small enough for a patient referee.
#[test]
fn mechanisms_of_the_manual() {
    let models = Models::read();
    let small = |text: &str| text.len() < 1500;
    let mut compared = 0;
    for (name, text) in models.mechanisms.iter().filter(|(name, text)| name.starts_with("manual") && small(text)) {
        match judge((text, &models.shared), 1, 1) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => panic!("{name}: {fault}\n{text}"),
        }
    }
    assert!(compared > 500, "{compared} numbers");
}

/// Each construct once, with what else its seed has; what makes large mechanisms is met alone.
#[test]
fn random_mechanisms() {
    let large = [Construct::Loops, Construct::Closures, Construct::Rolling, Construct::Quaternions, Construct::Parts];
    let mut compared = 0;
    for (seed, construct) in (1..).zip(Construct::ALL) {
        let without: Vec<Construct> = large.into_iter().filter(|other| *other != construct).collect();
        let drawn = draw(seed, Some(construct), &without);
        match judge((&drawn.text, &drawn.imports), seed, 1) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => {
                let (small, fault) = shrink(&drawn, &fault, seed, 1);
                panic!("seed {seed}: {fault}\n{:?}\n{}", small.imports, small.text);
            }
        }
    }
    assert!(compared > 500, "{compared} numbers");
}

/// What is drawn has none there.
#[test]
fn inputs_in_dissipation() {
    let text = include_str!("../mechanisms/driven_dampers.mbs");
    let judged = judge((text, &Default::default()), 1, 3).unwrap_or_else(|fault| panic!("{fault}"));
    assert!(judged.numbers > 100, "{judged:?}");
}

/// Branches and corners of every kind are proved: of thousands by
/// `cargo run --release -p mbs-tests --bin referee -- --piecewise yes --count 2000`.
#[test]
fn piecewise_mechanisms_are_proved() {
    let (mut exactly, mut finite) = (0, 0);
    for seed in 0..24 {
        let drawn = draw_piecewise(seed);
        match proved((&drawn.text, &drawn.imports)) {
            Ok(None) => {}
            Ok(Some(proof)) => {
                finite += 1;
                exactly += proof.evidence.identities;
            }
            Err(fault) => {
                let (small, fault) = shrink_unproved(&drawn, &fault);
                panic!("seed {seed}: {fault}\n{}", small.text);
            }
        }
    }
    assert!(finite > 20 && exactly > 1000, "{finite} mechanisms, {exactly} identities in fields");
}

/// Of what depends on an inertia that is nothing but rounding there may be no answer, and none that has some digits.
#[test]
fn without_inertia_but_rounding() {
    // Where the nut does not turn, because the screw turns it back, 1e-18 of the inertia is left.
    let screw = "mechanism Screw {
        coord x: m;
        coord a: rad;
        coord y: m;
        coord z: m;
        param m: kg = 1;
        param j: kg*m^2 = 1;
        param pitch: m = 1e-9;
        input pull: N;
        kinetic += 1/2*m*dt(x)^2 + 1/2*j*dt(a + x/pitch)^2 + 1/2*m*dt(y)^2 + 1/2*m*dt(z)^2;
        constraint guide: y = 2*z;
        force y += pull;
    }";
    let judged = judge((screw, &Default::default()), 1, 3).unwrap();
    assert!(judged.numbers > 50 && judged.undetermined > 50, "{judged:?}");
}

/// A shaft's own inertia is 1e-8 of that of what it turns: its acceleration is a difference of two equations, which
/// round each by itself what they have in common.
#[test]
fn differences_of_equations() {
    let shaft = "mechanism Shaft {
        param p2: kHz = 1;
        param p3: km = 1;
        prescribed w1: m = 0;
        coord a4: rad;
        param p5: kg*m^2 = 1;
        coord a6: rad;
        const p7: kg*m^2 = 4.40e-9;
        coord a8: rad;
        param p10: g = 1;
        param p11: kg*cm^2 = 1;
        param p12: m = 4.88e-4;
        param p14: mm = 0;
        param p15: mm/ms^2 = 1;
        coord x16: m;
        param p17: m = 3.27e-4;
        param p19: kg*cm^2 = 1;
        param p20: m = 1;
        param p22: mm = 1;
        param p23: N/m = 1;
        param p27: m*s^-1 = 1;
        kinetic += p5*dt(a4)^2;
        kinetic += p7*dt(a6)^2;
        let mut link9 = rot_z(a8 + a6^2);
        kinetic += rigid_body(0, [0, 0, 0], diag(1, 1, 2)*p11, link9);
        let place13 = link9.point([0, 0, p14]);
        let mut link18 = link9 * translation([x16, 0, 0]);
        kinetic += rigid_body(p10, [0, 0, 0], diag(p19, p19, p19), link18);
        let place21 = (rot_y(1)*translation([0, p20, p22])) * link18.point([0, 0, p12]);
        potential += spring(p23, sqrt((place13 - place21).norm_squared() + p17^2), p17);
    }";
    for seed in 1..3 {
        let judged = judge((shaft, &Default::default()), seed, 3).unwrap_or_else(|fault| panic!("{fault}"));
        assert!(judged.numbers > 50, "{judged:?}");
    }
}

/// Seeds of long runs that once had a fault: energies with terms linear in the velocities, a constraint that holds to
/// the last digit, `p/p < 1`, tensors that no turn changes, the moment of a reaction in turned axes, a force that
/// saturates; hinges that are nearly upright, or at multiples of a right angle; a heavy body that slides and turns; a
/// right angle between joints; bodies declared by their motion that turn by quaternions.
#[test]
fn mechanisms_with_a_fault_once() {
    let solved = [83149, 87175, 88133, 89437, 90755, 102930, 201189, 201927];
    let derived = [40122, 80866, 81839, 82118, 83176, 83245, 89913, 91198, 100949, 101659, 202374];
    for seed in derived.into_iter().chain(solved) {
        let drawn = draw(seed, None, &[]);
        if let Err(fault) = judge((&drawn.text, &drawn.imports), seed, 3) {
            panic!("seed {seed}: {fault}\n{:?}\n{}", drawn.imports, drawn.text);
        }
    }
}
