//! Where motions are prescribed, functions take them before the state.

use trolley::trolley::Trolley;

fn main() {
    let trolley = Trolley::<f64>::default();
    let (q, qd, push) = ([0.0_f64; 2], [0.0_f64; 2], [0.0_f64]);
    trolley.forward_dynamics(&q, &qd, &push);
}
