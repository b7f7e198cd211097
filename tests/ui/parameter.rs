//! Parameters are given all, or the others from the defaults: `Params { m: 1.0, ..Params::default() }`.

use trolley::trolley::{Params, Trolley};

fn main() {
    Trolley::new(Params { m: 1.0 });
}
