//! The mechanism has two coordinates.

use trolley::trolley::Trolley;

fn main() {
    let trolley = Trolley::<f64>::default();
    trolley.mass_matrix(&[[0.0; 3]], &[0.0; 3]);
}
