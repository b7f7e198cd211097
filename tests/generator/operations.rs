//! Generated code costs no more than the formulas of a mechanics text typed by hand: both are counted.

use mbs_derive::interpret::{Interpreter, State as Arguments};
use mbs_derive::optimise::FunctionKind;
use mbs_runtime::{Mechanism, Scalar};
use mbs_tests::by_hand::ByHand;
use mbs_tests::by_hand::cart_pole::CartPole;
use mbs_tests::by_hand::double_pendulum::DoublePendulum;
use mbs_tests::by_hand::furuta_pendulum::FurutaPendulum;
use mbs_tests::by_hand::heavy_top::HeavyTop;
use mbs_tests::by_hand::spherical_pendulum::SphericalPendulum;
use mbs_tests::compare::assert_close;
use mbs_tests::counting::{Counted, Counts, counted};
use mbs_tests::random::{State, states};
use mbs_tests::{derivation, source};

const FUNCTIONS: [FunctionKind; 6] = [
    FunctionKind::MassMatrix,
    FunctionKind::CoriolisMatrix,
    FunctionKind::Gravity,
    FunctionKind::Bias,
    FunctionKind::InverseDynamics,
    FunctionKind::ForwardDynamics,
];

/// The results of a function by hand and what it cost.
fn by_hand<const N: usize, const U: usize>(
    hand: &impl ByHand<Counted, N, U>,
    kind: FunctionKind,
    state: &State<N>,
    u: [f64; U],
) -> (Vec<f64>, Counts) {
    let [q, qd, qdd] = [state.q, state.qd, state.qdd].map(|x| x.map(Counted));
    let (values, counts) = counted(|| match kind {
        FunctionKind::MassMatrix => hand.mass_matrix(&q).concat(),
        FunctionKind::CoriolisMatrix => hand.coriolis_matrix(&q, &qd).concat(),
        FunctionKind::Gravity => hand.gravity(&q).to_vec(),
        FunctionKind::Bias => hand.bias(&q, &qd).to_vec(),
        FunctionKind::InverseDynamics => hand.inverse_dynamics(&q, &qd, &qdd).to_vec(),
        _ => hand.forward_dynamics(&q, &qd, &u.map(Counted)).to_vec(),
    });
    (values.iter().map(|value| value.0).collect(), counts)
}

fn check<const N: usize, const U: usize, const P: usize, H: ByHand<Counted, N, U>>(
    source: &str,
    hand: impl Fn([Counted; P]) -> H,
) {
    let derivation = derivation(source);
    let interpreter = Interpreter::new(&derivation);
    let hand = hand(std::array::from_fn(|i| Counted(interpreter.parameters()[i])));
    let u = [0.7; U];
    let mut compared = 0;
    for state in states::<N>(11, 60) {
        let [q, qd, qdd] = [state.q, state.qd, state.qdd].map(|x| x.to_vec());
        let arguments = Arguments { t: 0.0, q, qd, qdd, u: u.to_vec(), prescribed: Vec::new() };
        for kind in FUNCTIONS {
            let name = kind.name();
            let found = interpreter.call(kind, &arguments).expect("generated for every mechanism");
            let (expected, _) = by_hand(&hand, kind, &state, u);
            // Accelerations are infinite or NaN where M is singular, and nothing but rounding where it nearly is.
            if found.iter().chain(&expected).all(|x| x.abs() < 1e9) {
                assert_close(name, &found, &expected, 1e-10);
                compared += 1;
            }
        }
    }
    assert!(compared >= 5 * 60 + 20, "{compared} results compared");
    let generic = states::<N>(11, 1)[0];
    let mut losses = String::new();
    for kind in FUNCTIONS {
        let name = kind.name();
        let (_, hand) = by_hand(&hand, kind, &generic, u);
        let found = derivation.function(kind).expect("generated for every mechanism").operations;
        println!("{:18} {name:17} by hand {hand:?}\n{:36} {found:?}", derivation.name, "generated");
        if found.flops() > hand.flops() || found.weight() > hand.weight() {
            losses += &format!("{name}: generated {found:?}, by hand {hand:?}\n");
        }
    }
    assert!(losses.is_empty(), "{}\n{losses}", derivation.name);
}

#[test]
fn cart_pole_costs_no_more_than_by_hand() {
    check(source(mbs_models::SOURCES, "cart_pole"), CartPole::new);
}

#[test]
fn double_pendulum_costs_no_more_than_by_hand() {
    check(source(mbs_models::SOURCES, "double_pendulum"), DoublePendulum::new);
}

#[test]
fn spherical_pendulum_costs_no_more_than_by_hand() {
    check(source(mbs_models::SOURCES, "spherical_pendulum"), SphericalPendulum::new);
}

#[test]
fn heavy_top_costs_no_more_than_by_hand() {
    check(source(mbs_models::SOURCES, "heavy_top"), HeavyTop::new);
}

#[test]
fn furuta_pendulum_costs_no_more_than_by_hand() {
    check(source(mbs_models::SOURCES, "furuta_pendulum"), FurutaPendulum::new);
}

/// What the programs are said to cost is what running the generated code costs.
#[test]
fn the_counts_of_the_programs_are_those_of_the_code() {
    fn check<const N: usize, const U: usize>(
        module: &str,
        generated: impl Mechanism<N, U, Scalar = Counted, Time = Counted>,
    ) {
        let derivation = derivation(source(mbs_models::SOURCES, module));
        let State { q, qd, qdd } = states::<N>(11, 1)[0];
        let ([q, qd, qdd], t, u) = ([q, qd, qdd].map(|x| x.map(Counted)), Counted::zero(), [Counted(0.7); U]);
        for (kind, (_, counts)) in [
            (FunctionKind::MassMatrix, counted(|| _ = generated.mass_matrix(t, &q))),
            (FunctionKind::CoriolisMatrix, counted(|| _ = generated.coriolis_matrix(t, &q, &qd))),
            (FunctionKind::Gravity, counted(|| _ = generated.gravity(t, &q))),
            (FunctionKind::Bias, counted(|| _ = generated.bias(t, &q, &qd))),
            (FunctionKind::InverseDynamics, counted(|| _ = generated.inverse_dynamics(t, &q, &qd, &qdd))),
            (FunctionKind::ForwardDynamics, counted(|| _ = generated.forward_dynamics(t, &q, &qd, &u))),
            (FunctionKind::Linearize, counted(|| _ = generated.linearize(t, &q, &qd, &u))),
        ] {
            let said = derivation.function(kind).expect("generated for every mechanism").operations;
            let said = Counts { add: said.add, mul: said.mul, div: said.div, sincos: said.sincos, other: 0 };
            assert_eq!(counts, said, "{module}: {}", kind.name());
        }
    }
    check("cart_pole", mbs_models::cart_pole::CartPole::<Counted>::default());
    check("double_pendulum", mbs_models::double_pendulum::DoublePendulum::<Counted>::default());
    check("spherical_pendulum", mbs_models::spherical_pendulum::SphericalPendulum::<Counted>::default());
    check("heavy_top", mbs_models::heavy_top::HeavyTop::<Counted>::default());
    check("furuta_pendulum", mbs_models::furuta_pendulum::FurutaPendulum::<Counted>::default());
}
