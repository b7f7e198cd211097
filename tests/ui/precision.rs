//! A mechanism computes in one precision.

use trolley::trolley::Trolley;

fn main() {
    let (trolley, q) = (Trolley::<f64>::default(), [0.0_f32; 2]);
    trolley.mass_matrix(&[[0.0; 3]], &q);
}
