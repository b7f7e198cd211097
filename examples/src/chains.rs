//! Chains of 5 to 200 links about skew axes, their inverse and forward dynamics, generated when this crate is built:
//! `growth` and `benches/` time them.

include!(concat!(env!("OUT_DIR"), "/chains.rs"));

/// What the generated code of a chain of N links does.
pub trait Chain<const N: usize> {
    /// The torques that move it so.
    fn inverse_dynamics(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [f64; N];
    /// The accelerations under these torques.
    fn forward_dynamics(&self, q: &[f64; N], qd: &[f64; N], tau: &[f64; N]) -> [f64; N];
}

macro_rules! chain {
    ($module:ident, $n:literal) => {
        impl Chain<$n> for $module::NChain<f64> {
            fn inverse_dynamics(&self, q: &[f64; $n], qd: &[f64; $n], qdd: &[f64; $n]) -> [f64; $n] {
                self.inverse_dynamics(q, qd, qdd)
            }
            fn forward_dynamics(&self, q: &[f64; $n], qd: &[f64; $n], tau: &[f64; $n]) -> [f64; $n] {
                self.forward_dynamics(q, qd, tau)
            }
        }
    };
}

chain!(five, 5);
chain!(ten, 10);
chain!(twenty, 20);
chain!(forty, 40);
chain!(fifty, 50);
chain!(two_hundred, 200);

#[cfg(test)]
mod tests {
    use mbs_derive::expr::Graph;
    use mbs_derive::interpret::{Interpreter, State};
    use mbs_derive::optimise::FunctionKind;
    use mbs_derive::{Analysis, source::Sources};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::{CHAIN, fifty};

    /// Loops over the links compute what the statements of all links do.
    #[test]
    fn rolled_code_has_the_bits_of_the_interpreter() {
        let text = CHAIN.replace("const n = 5;", "const n = 50;");
        let options = mbs_derive::emit::Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
        let graph = Graph::verbatim();
        let analysis = Analysis::with_options(&Sources::new("n_chain.mbs", &text), &graph, &options).unwrap();
        let interpreter = Interpreter::<f64>::new(analysis.programs());
        let chain = fifty::NChain::<f64>::default();
        let mut random = Pcg64::seed_from_u64(50);
        let mut numbers = |most: f64| -> [f64; 50] { std::array::from_fn(|_| random.random_range(-most..most)) };
        let [q, qd, qdd] = [3.0, 1.0, 2.0].map(&mut numbers);
        let state =
            |u: &[f64]| State { q: q.to_vec(), qd: qd.to_vec(), qdd: qdd.to_vec(), u: u.to_vec(), ..State::default() };
        let torques = chain.inverse_dynamics(&q, &qd, &qdd);
        assert_eq!(interpreter.call(FunctionKind::InverseDynamics, &state(&qdd)).unwrap(), torques);
        let accelerations = chain.forward_dynamics(&q, &qd, &torques);
        assert_eq!(interpreter.call(FunctionKind::ForwardDynamics, &state(&torques)).unwrap(), accelerations);
    }
}
