//! The mechanisms of `mechanisms/*.mbs`, and those of `models/mechanisms/` that have references of the same kind,
//! against their references: `M`, `h`, `Q − ∂D/∂q̇`, `q̈`, and `A`, `γ`, `λ` where there are constraints, at random
//! parameters and states, straight and zero ones among them.
//!
//! The files were written from `docs/language.md` alone.

use mbs_runtime::{Constrained, Mechanism};
use mbs_tests::compare::{assert_close, error};
use mbs_tests::mechanisms as written;
use mbs_tests::random::{Random, State, positive, states};
use mbs_tests::reference::dynamics::{Dynamics, motion};
use mbs_tests::reference::{
    bead_on_hoop, bouncing_pendulum, cart_with_five_links, cartesian_pendulum, chaplygin_sleigh, charged_particle,
    driven_dampers, elastic_joint_arm, four_bar, furuta_pendulum, heavy_top, knife_edge, quadrotor_with_slung_load,
    restricted_three_body, rolling_coin, shaken_pendulum, slider_crank, turntable,
};

/// The error that is let pass, of the largest entry.
const TOLERANCE: f64 = 1e-9;

/// Beyond this condition the accelerations of two ways to solve differ by more than the tolerance.
const CONDITION: f64 = 1e5;

/// What the generated code says at one state.
struct Found<const N: usize> {
    mass_matrix: [[f64; N]; N],
    bias: [f64; N],
    /// `Q − ∂D/∂q̇`.
    force: [f64; N],
    accelerations: [f64; N],
    constraints: Constraints<N>,
}

#[derive(Default)]
struct Constraints<const N: usize> {
    /// `A`
    jacobian: Vec<[f64; N]>,
    /// `γ`
    bias: Vec<f64>,
    /// `λ`
    multipliers: Vec<f64>,
}

/// As the trait has it, at a time and inputs.
fn found<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    t: f64,
    (q, qd): (&[f64; N], &[f64; N]),
    u: &[f64; U],
) -> Found<N> {
    let (force, damping) = (mechanism.generalized_force(t, q, qd, u), mechanism.dissipation_force(t, q, qd));
    Found {
        mass_matrix: mechanism.mass_matrix(t, q),
        bias: mechanism.bias(t, q, qd),
        force: std::array::from_fn(|i| force[i] - damping[i]),
        accelerations: mechanism.forward_dynamics(t, q, qd, u),
        constraints: Constraints::default(),
    }
}

/// What a mechanism with constraints says at a state, as its traits have it.
fn constrained<const N: usize, const U: usize, const K: usize, M>(
    mechanism: &M,
    (q, qd): (&[f64; N], &[f64; N]),
    u: &[f64; U],
) -> Found<N>
where
    M: Mechanism<N, U, Scalar = f64, Time = f64> + Constrained<N, U, K>,
{
    let constraints = Constraints {
        jacobian: mechanism.constraint_jacobian(0.0, q).to_vec(),
        bias: mechanism.constraint_bias(0.0, q, qd).to_vec(),
        multipliers: mechanism.multipliers(0.0, q, qd, u).to_vec(),
    };
    Found { constraints, ..found(mechanism, 0.0, (q, qd), u) }
}

/// Compares at states of every posture; accelerations and multipliers where they are well determined, which must be at
/// half of the states or more.
fn check<const N: usize>(seed: u64, reference: &impl Dynamics<N>, found: impl Fn(&[f64; N], &[f64; N]) -> Found<N>) {
    let states = states::<N>(seed, 60);
    let mut moved = 0;
    for State { q, qd, .. } in &states {
        let close = |what: &str, got: &[f64], want: &[f64]| {
            assert_close(&format!("{what} at {q:?}, {qd:?}"), got, want, TOLERANCE);
        };
        let found = found(q, qd);
        close("M", &found.mass_matrix.concat(), &reference.mass_matrix(q).concat());
        close("h", &found.bias, &reference.bias(q, qd));
        close("Q − ∂D/∂q̇", &found.force, &reference.force(q, qd));
        let (rows, gamma): (Vec<[f64; N]>, Vec<f64>) = reference.constraints(q, qd).into_iter().unzip();
        let Constraints { jacobian, bias, multipliers } = found.constraints;
        close("A", &jacobian.concat(), &rows.concat());
        close("γ", &bias, &gamma);
        if let Some(motion) = motion(reference, q, qd).filter(|motion| motion.condition < CONDITION) {
            close("q̈", &found.accelerations, &motion.accelerations);
            close("λ", &multipliers, &motion.multipliers);
            moved += 1;
        }
    }
    assert!(2 * moved >= states.len(), "{moved} of {} states are well conditioned", states.len());
}

/// Six sets of parameters of order one.
fn sets<const P: usize>() -> impl Iterator<Item = (u64, [f64; P])> {
    (1..=6).map(|seed| (seed, positive(40 + seed)))
}

fn inputs<const U: usize>(seed: u64) -> [f64; U] {
    Random::new(70 + seed).array(-5.0..5.0)
}

#[test]
fn cart_with_five_links() {
    use written::cart_with_five_links::{CartWithFiveLinks, Params};
    for (seed, p) in sets::<13>() {
        let (m_cart, g, b) = (p[0], p[1], p[2]);
        let [m, l] = [3, 8].map(|first| std::array::from_fn(|i| p[first + i]));
        let [push] = inputs(seed);
        let generated = CartWithFiveLinks::new(Params { m_cart, m, l, g, b });
        let reference = cart_with_five_links::CartWithFiveLinks { m_cart, m, l, g, b, push };
        check(seed, &reference, |q, qd| found(&generated, 0.0, (q, qd), &[push]));
    }
}

/// Also at random parameters: `reference.rs` has the others.
#[test]
fn heavy_top() {
    use mbs_models::heavy_top::{HeavyTop, Params};
    use mbs_tests::reference::EquationsOfMotion;
    struct Top(heavy_top::HeavyTop);
    impl Dynamics<3> for Top {
        fn mass_matrix(&self, q: &[f64; 3]) -> [[f64; 3]; 3] {
            self.0.mass_matrix(q)
        }
        fn bias(&self, q: &[f64; 3], qd: &[f64; 3]) -> [f64; 3] {
            EquationsOfMotion::bias(&self.0, q, qd)
        }
    }
    for (seed, [m, l, i1, i3, g]) in sets::<5>() {
        let generated = HeavyTop::new(Params { m, l, i1, i3, g });
        check(seed, &Top(heavy_top::HeavyTop { i1, i3, m, l, g }), |q, qd| found(&generated, 0.0, (q, qd), &[]));
    }
}

#[test]
fn bead_on_hoop() {
    use written::bead_on_hoop::{BeadOnHoop, Params};
    for (seed, [m, radius, offset, lean, g, b]) in sets::<6>() {
        let [turn, rate, acceleration] = inputs(seed);
        let generated = BeadOnHoop::new(Params { m, radius, offset, lean, g, b });
        let signals = [[turn, rate, acceleration]];
        let reference = bead_on_hoop::BeadOnHoop { m, radius, offset, lean, g, b, omega: [rate, acceleration] };
        check(seed, &reference, |q, qd| {
            let (force, damping) =
                (generated.generalized_force(&signals, q, qd), generated.dissipation_force(&signals, q, qd));
            Found {
                mass_matrix: generated.mass_matrix(&signals, q),
                bias: generated.bias(&signals, q, qd),
                force: [force[0] - damping[0]],
                accelerations: generated.forward_dynamics(&signals, q, qd),
                constraints: Constraints::default(),
            }
        });
    }
}

#[test]
fn shaken_pendulum() {
    use written::shaken_pendulum::{Params, ShakenPendulum};
    for (seed, [m, g, mean, part, omega, t]) in sets::<6>() {
        // The thread keeps a length.
        let swing = 0.2 * part * mean;
        let generated = ShakenPendulum::new(Params { m, g, mean, swing, omega });
        let [a, b, c, d, right, up] = inputs(seed);
        let signals = [[a, b, right], [c, d, up]];
        let length = [mean + swing * (omega * t).sin(), swing * omega * (omega * t).cos()];
        let reference = shaken_pendulum::ShakenPendulum { m, g, length, pivot: [right, up] };
        check(seed, &reference, |q, qd| Found {
            mass_matrix: generated.mass_matrix(t, &signals, q),
            bias: generated.bias(t, &signals, q, qd),
            force: generated.generalized_force(t, &signals, q, qd),
            accelerations: generated.forward_dynamics(t, &signals, q, qd),
            constraints: Constraints::default(),
        });
    }
}

#[test]
fn turntable() {
    use written::turntable::{Params, Turntable};
    for (seed, [m, k, c, rate, growth, amplitude, omega, t]) in sets::<8>() {
        let generated = Turntable::new(Params { m, k, c, rate, growth, amplitude, omega });
        let turn = [rate * t + 0.5 * growth * t * t, rate + growth * t, growth];
        let centre = -amplitude * omega * omega * (omega * t).cos();
        let reference = turntable::Turntable { m, k, c, turn, centre };
        check(seed, &reference, |q, qd| found(&generated, t, (q, qd), &[]));
    }
}

#[test]
fn restricted_three_body() {
    use mbs_models::cr3bp::{Cr3bp, Params};
    for (seed, [part, t]) in sets::<2>() {
        let mu = part / 6.0;
        let generated = Cr3bp::new(Params { mu });
        let reference = restricted_three_body::RestrictedThreeBody { mu };
        check(seed, &reference, |q, qd| found(&generated, t, (q, qd), &[]));
    }
}

#[test]
fn quadrotor_with_slung_load() {
    use written::quadrotor_with_slung_load::{Params, QuadrotorWithSlungLoad};
    for (seed, [m, moment, arm, hook, m_load, thread, g, spin_drag, load_drag]) in sets::<9>() {
        let thrust = inputs(seed);
        let params = Params { m, moment, arm, hook, m_load, thread, g, spin_drag, load_drag };
        let generated = QuadrotorWithSlungLoad::new(params);
        let reference = quadrotor_with_slung_load::QuadrotorWithSlungLoad {
            m,
            moment,
            arm,
            hook,
            m_load,
            thread,
            g,
            spin_drag,
            load_drag,
            thrust,
        };
        check(seed, &reference, |q, qd| found(&generated, 0.0, (q, qd), &thrust));
    }
}

/// Inputs within `dissipation`.
#[test]
fn driven_dampers() {
    use mbs_tests::reference::cart_pole::CartPole;
    use written::driven_dampers::{DrivenDampers, Params};
    for (seed, [m_cart, m, l, moment, g, rail, clutch]) in sets::<7>() {
        let [drag, speed] = inputs(seed);
        let generated = DrivenDampers::new(Params { m_cart, m, l, moment, g, rail, clutch });
        let cart_pole = CartPole { m_cart, m_bob: m, length: l, g, b: rail };
        let reference = driven_dampers::DrivenDampers { cart_pole, moment, clutch, drag, speed };
        check(seed, &reference, |q, qd| {
            assert_eq!(generated.dissipation_force(q, qd), [rail * qd[0], 0.0, 0.0]);
            found(&generated, 0.0, (q, qd), &[drag, speed])
        });
    }
}

#[test]
fn elastic_joint_arm() {
    use written::elastic_joint_arm::{ElasticJointArm, Params};
    for (seed, p) in sets::<14>() {
        let [m, centre, moment, rotor, k, d] = [0, 2, 4, 6, 8, 10].map(|first| [p[first], p[first + 1]]);
        let (l, g, tau) = (p[12], p[13], inputs(seed));
        let generated = ElasticJointArm::new(Params { m, l, centre, moment, rotor, k, d, g });
        let reference = elastic_joint_arm::ElasticJointArm { m, l, centre, moment, rotor, k, d, g, tau };
        check(seed, &reference, |q, qd| found(&generated, 0.0, (q, qd), &tau));
    }
}

#[test]
fn furuta_pendulum() {
    use mbs_models::furuta_pendulum::{FurutaPendulum, Params};
    for (seed, [arm_moment, arm_length, m, l, transverse, axial, g, b0, b1]) in sets::<9>() {
        let [tau] = inputs(seed);
        let b = [b0, b1];
        let params = Params { arm_moment, arm_length, m, l, transverse, axial, g, b };
        let generated = FurutaPendulum::new(params);
        let reference = furuta_pendulum::FurutaPendulum { arm_moment, arm_length, m, l, transverse, axial, g, b, tau };
        check(seed, &reference, |q, qd| found(&generated, 0.0, (q, qd), &[tau]));
    }
}

#[test]
fn charged_particle() {
    use written::charged_particle::{ChargedParticle, Params};
    for (seed, [m, charge]) in sets::<2>() {
        let [bx, by, bz, ex, ey, ez] = inputs(seed);
        let (b, e) = ([bx, by, bz], [ex, ey, ez]);
        let generated = ChargedParticle::new(Params { m, charge, b, e });
        let reference = charged_particle::ChargedParticle { m, charge, b, e };
        check(seed, &reference, |q, qd| found(&generated, 0.0, (q, qd), &[]));
    }
}

#[test]
fn chaplygin_sleigh() {
    use written::chaplygin_sleigh::{ChaplyginSleigh, Params};
    for (seed, [m, moment, a]) in sets::<3>() {
        let u = inputs(seed);
        let generated = ChaplyginSleigh::new(Params { m, moment, a });
        let reference = chaplygin_sleigh::ChaplyginSleigh { m, moment, a, inputs: u };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &u));
    }
}

#[test]
fn rolling_coin() {
    use written::rolling_coin::{Params, RollingCoin};
    for (seed, [m, radius, axial, transverse, g]) in sets::<5>() {
        let generated = RollingCoin::new(Params { m, radius, axial, transverse, g });
        let reference = rolling_coin::RollingCoin { m, radius, axial, transverse, g };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &[]));
    }
}

/// The steady circles that Euler's equations allow are what the generated equations do.
#[test]
fn rolling_coin_goes_round() {
    use written::rolling_coin::{Params, RollingCoin};
    for (seed, [m, radius, axial, transverse, g]) in sets::<5>() {
        let reference = rolling_coin::RollingCoin { m, radius, axial, transverse, g };
        let generated = RollingCoin::new(Params { m, radius, axial, transverse, g });
        let (lean, turn) = (0.2 * seed as f64, 3.0 - seed as f64 + 0.5);
        let q = [0.3, -0.2, 0.8, lean, 1.1];
        let spin = reference.steady_spin(lean, turn);
        let [xd, yd] = reference.rolling_velocity(&q, &[turn, 0.0, spin]);
        let qdd = generated.forward_dynamics(&q, &[xd, yd, turn, 0.0, spin]);
        assert_close("q̈", &qdd, &[-turn * yd, turn * xd, 0.0, 0.0, 0.0], TOLERANCE);
    }
}

#[test]
fn four_bar() {
    use mbs_models::four_bar::{FourBar, Params};
    for (seed, p) in sets::<8>() {
        let (m, l, ground, g) = ([p[0], p[1], p[2]], [p[3], p[4], p[5]], p[6], p[7]);
        let [tau] = inputs(seed);
        let generated = FourBar::new(Params { m, l, ground, g });
        let reference = four_bar::FourBar { m, l, ground, g, tau };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &[tau]));
    }
}

/// Where the loop closes by the cosine rule, φ vanishes.
#[test]
fn four_bar_closes() {
    use mbs_models::four_bar::{FourBar, Params};
    let Params { m, l, ground, g } = Params::default();
    let reference = four_bar::FourBar { m, l, ground, g, tau: 0.0 };
    for step in 0..60 {
        let q = reference.closed(0.1 * f64::from(step)).expect("Grashof's crank turns all the way round");
        let phi = FourBar::<f64>::default().constraint(&q, &reference.closed_rates(&q, 1.0));
        assert!(error(&phi, &[0.0; 2]) < 1e-14, "{phi:?}");
    }
}

#[test]
fn cartesian_pendulum() {
    use written::cartesian_pendulum::{CartesianPendulum, Params};
    for (seed, [m, l, g]) in sets::<3>() {
        let generated = CartesianPendulum::new(Params { m, l, g });
        let reference = cartesian_pendulum::CartesianPendulum { m, l, g };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &[]));
    }
}

#[test]
fn knife_edge() {
    use written::knife_edge::{KnifeEdge, Params};
    for (seed, [m, moment, slope, g]) in sets::<4>() {
        let generated = KnifeEdge::new(Params { m, moment, slope, g });
        let reference = knife_edge::KnifeEdge { m, moment, slope, g };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &[]));
    }
}

#[test]
fn slider_crank() {
    use written::slider_crank::{Params, SliderCrank};
    for (seed, p) in sets::<8>() {
        let (m, l, offset, g, c) = ([p[0], p[1], p[2]], [p[3], p[4]], p[5], p[6], p[7]);
        let u = inputs(seed);
        let generated = SliderCrank::new(Params { m, l, offset, g, c });
        let reference = slider_crank::SliderCrank { m, l, offset, g, c, inputs: u };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &u));
    }
}

/// Where the piston is where the rod puts it, φ vanishes.
#[test]
fn slider_crank_closes() {
    use written::slider_crank::{Params, SliderCrank};
    let Params { m, l, offset, g, c } = Params::default();
    let reference = slider_crank::SliderCrank { m, l, offset, g, c, inputs: [0.0; 2] };
    for step in 0..60 {
        let q = reference.closed(0.1 * f64::from(step)).expect("the rod is longer than the crank");
        let phi = SliderCrank::<f64>::default().constraint(&q, &reference.closed_rates(&q, 1.0));
        assert!(error(&phi, &[0.0; 2]) < 1e-15, "{phi:?}");
    }
}

#[test]
fn bouncing_pendulum() {
    use written::bouncing_pendulum::{BouncingPendulum, Params};
    for (seed, [m, l, moment, g]) in sets::<4>() {
        let generated = BouncingPendulum::new(Params { m, l, moment, g });
        let reference = bouncing_pendulum::BouncingPendulum { m, l, moment, g };
        check(seed, &reference, |q, qd| constrained(&generated, (q, qd), &[]));
    }
}
