//! The build script chose some functions, this one not among them.

use trolley::trolley::Trolley;

fn main() {
    let trolley = Trolley::<f64>::default();
    trolley.linearize(&[[0.0; 3]], &[0.0; 2], &[0.0; 2], &[0.0]);
}
