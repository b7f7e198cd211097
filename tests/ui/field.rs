//! A mechanism keeps its parameters, because what depends on them was computed when it was made.

use trolley::trolley::Trolley;

fn main() {
    let mut trolley = Trolley::<f64>::default();
    trolley.params.m = 3.0;
}
