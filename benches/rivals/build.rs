//! Inverse dynamics of the benchmark arm from its energies, by symplex: Lagrange's equations, common subexpressions,
//! Rust.

#[path = "src/numbers.rs"]
mod numbers;

use numbers::{Arm, Frame, Link};
use symplex::codegen::CodegenOptions;
use symplex::dynamics::{GeneralizedCoordinate, euler_lagrange};
use symplex::matrix::Matrix;
use symplex::prelude::{Context, Ex};

type Vector = [Ex; 3];

fn main() {
    println!("cargo::rerun-if-changed={}", numbers::FILE);
    let arm = Arm::read();
    let context = Context::new();
    let names = |letter: &str| (0..arm.links.len()).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
    let all: Vec<String> = ["q", "qd", "qdd"].iter().flat_map(|letter| names(letter)).collect();
    let symbols = |letter: &str| names(letter).iter().map(|name| context.symbol(name)).collect::<Vec<_>>();
    let (q, qd, qdd) = (symbols("q"), symbols("qd"), symbols("qdd"));

    let start = std::time::Instant::now();
    let (kinetic, potential) = energies(&arm, &context, &q, &qd);
    let coordinates: Vec<_> =
        (0..q.len()).map(|i| GeneralizedCoordinate { q: &q[i], q_dot: &qd[i], q_ddot: &qdd[i] }).collect();
    let torques = euler_lagrange(&kinetic, &potential, &coordinates);
    let column = Matrix::new(torques.into_iter().map(|torque| vec![torque]).collect()).expect("a column");
    let arguments: Vec<&str> = all.iter().map(String::as_str).collect();
    // Without FMA in the target `mul_add` is a call of the library.
    let features = std::env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    let options = CodegenOptions { use_mul_add: features.split(',').any(|f| f == "fma"), ..Default::default() };
    let code = column.to_rust_fn_with_options("inverse_dynamics", &arguments, &options);
    let code = code.expect("functions that Rust has");
    let seconds = start.elapsed().as_secs_f64();

    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    let code = format!("/// Seconds that deriving and printing took.\npub const SECONDS: f64 = {seconds:?};\n{code}");
    std::fs::write(format!("{folder}/symplex_arm6.rs"), code).expect("cargo's folder");
}

/// Kinetic and potential energy, by the velocities of the links in their own axes, as one would write them by hand.
fn energies(arm: &Arm, context: &Context, q: &[Ex], qd: &[Ex]) -> (Ex, Ex) {
    let number = |x: f64| context.from_f64_nice(x).expect("a decimal number");
    let zero = || context.int(0);
    let (mut omega, mut v): (Vector, Vector) = ([zero(), zero(), zero()], [zero(), zero(), zero()]);
    // The world's vertical in the link's axes, and the height of the link's origin.
    let (mut up, mut height): (Vector, Ex) = ([zero(), zero(), context.int(1)], zero());
    let (mut kinetic, mut potential) = (zero(), zero());
    for (i, (Frame { d, a, alpha_deg }, Link { m, com, inertia })) in arm.dh.iter().zip(&arm.links).enumerate() {
        let (sin, cos) = (q[i].sin(), q[i].cos());
        // Twists are multiples of a right angle.
        let alpha = alpha_deg.to_radians();
        let (sin_alpha, cos_alpha) = (number(alpha.sin().round()), number(alpha.cos().round()));
        let (d, a) = (number(*d), number(*a));
        // x in the axes of this link, which are turned by q about z and by α about x.
        let turned = |x: &Vector| -> Vector {
            let along = &(&cos * &x[0]) + &(&sin * &x[1]);
            let across = &(&cos * &x[1]) - &(&sin * &x[0]);
            [along, &(&cos_alpha * &across) + &(&sin_alpha * &x[2]), &(&cos_alpha * &x[2]) - &(&sin_alpha * &across)]
        };
        let far = [&a * &cos, &a * &sin, d.clone()];
        height = &height + &dot(&up, &far);
        up = turned(&up);
        omega = turned(&[omega[0].clone(), omega[1].clone(), &omega[2] + &qd[i]]);
        v = sum(&turned(&v), &cross(&omega, &[a, &d * &sin_alpha, &d * &cos_alpha]));

        let centre: Vector = com.map(number);
        let of_centre = sum(&v, &cross(&omega, &centre));
        let [xx, xy, xz, yy, yz, zz] = inertia.map(number);
        let rows: [Vector; 3] = [[xx, xy.clone(), xz.clone()], [xy, yy, yz.clone()], [xz, yz, zz]];
        let momentum: Vector = std::array::from_fn(|row| dot(&rows[row], &omega));
        let mass = number(*m);
        let twice = &(&mass * &dot(&of_centre, &of_centre)) + &dot(&omega, &momentum);
        kinetic = &kinetic + &(&context.rational(1, 2) * &twice);
        potential = &potential + &(&(&mass * &number(arm.g)) * &(&height + &dot(&up, &centre)));
    }
    (kinetic, potential)
}

fn sum(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] + &b[i])
}

fn dot(a: &Vector, b: &Vector) -> Ex {
    &(&a[0] * &b[0]) + &(&(&a[1] * &b[1]) + &(&a[2] * &b[2]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}
