//! Chains of 5 to 1000 links about skew axes, their inverse and forward dynamics, generated when this crate is built:
//! `growth` and `benches/` time them.

include!(concat!(env!("OUT_DIR"), "/chains.rs"));

#[cfg(test)]
mod tests {
    use mbs_derive::expr::Graph;
    use mbs_derive::interpret::{Interpreter, State};
    use mbs_derive::optimise::FunctionKind;
    use mbs_derive::{Analysis, source::Sources};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::{CHAIN, fifty, thousand};

    fn random<const N: usize>(most: [f64; 3]) -> [[f64; N]; 3] {
        let mut random = Pcg64::seed_from_u64(N as u64);
        most.map(|most| std::array::from_fn(|_| random.random_range(-most..most)))
    }

    /// Loops over the links compute what the statements of all links do.
    #[test]
    fn rolled_code_has_the_bits_of_the_interpreter() {
        let text = CHAIN.replace("const n = 5;", "const n = 50;");
        let options = mbs_derive::emit::Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
        let graph = Graph::verbatim();
        let analysis = Analysis::with_options(&Sources::new("n_chain.mbs", &text), &graph, &options).unwrap();
        let interpreter = Interpreter::<f64>::new(analysis.programs());
        let chain = fifty::NChain::<f64>::default();
        let [q, qd, qdd] = random([3.0, 1.0, 2.0]);
        let state =
            |u: &[f64]| State { q: q.to_vec(), qd: qd.to_vec(), qdd: qdd.to_vec(), u: u.to_vec(), ..State::default() };
        let torques = chain.inverse_dynamics(&q, &qd, &qdd);
        assert_eq!(interpreter.call(FunctionKind::InverseDynamics, &state(&qdd)).unwrap(), torques);
        let accelerations = chain.forward_dynamics(&q, &qd, &torques);
        assert_eq!(interpreter.call(FunctionKind::ForwardDynamics, &state(&torques)).unwrap(), accelerations);
    }

    #[test]
    fn a_thousand_links_move_on_a_stack_of_a_mebibyte() {
        let moves = || {
            let chain = thousand::NChain::<f64>::default();
            let [q, qd, qdd] = random::<1000>([3.0, 0.1, 2.0]);
            let found = chain.forward_dynamics(&q, &qd, &chain.inverse_dynamics(&q, &qd, &qdd));
            found.iter().zip(&qdd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let off = std::thread::Builder::new().stack_size(1 << 20).spawn(moves).unwrap().join().unwrap();
        assert!(off < 1e-6, "{off:e}");
    }
}
