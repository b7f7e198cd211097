//! On a microcontroller (`--target thumbv7em-none-eabihf --release`): balances for ever. Elsewhere: prints two seconds
//! of it.
#![cfg_attr(target_os = "none", no_std, no_main)]

use embedded::Model;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use panic_halt as _;
    // What the compiler cannot see through: where the pole's angle would be read, and where the push would go.
    let mut model = Model::new(core::hint::black_box(0.2));
    loop {
        core::hint::black_box(model.step());
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    let mut model = Model::new(0.2);
    for i in 0..=2000 {
        let push = model.step();
        if i % 250 == 0 {
            let [x, theta] = model.state.q;
            println!("{:5.2} s: cart at {x:7.4} m, pole at {theta:7.4} rad, push {push:7.3} N", f64::from(i) * 1e-3);
        }
    }
}
