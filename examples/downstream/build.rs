//! Two mechanisms: one from a text, one written as Rust values, link by link from a table of numbers.

use mbs_derive::Config;
use mbs_derive::builder::{Mechanism, Pose, Vector, quantity, rigid_body};

fn main() {
    mbs_derive::compile("mechanisms/crane.mbs");
    println!("cargo::rerun-if-changed=links.csv");
    let table = std::fs::read_to_string("links.csv").expect("links.csv can be read");
    let numbers = |line: &str| -> Option<(f64, f64)> {
        let (mass, length) = line.split_once(',')?;
        Some((mass.parse().ok()?, length.parse().ok()?))
    };
    let links: Vec<_> = table.lines().skip(1).map(|line| numbers(line).expect("a mass and a length")).collect();
    Config::new().compile_mechanism(&chain(&links));
}

/// Slender links of these masses \[kg\] and lengths \[m\], each hinged at the end of the one before.
fn chain(links: &[(f64, f64)]) -> Mechanism {
    let mut chain = Mechanism::new("Chain", "Slender links, each hinged at the end of the one before.");
    let g = chain.param("g", "m/s^2", 9.81);
    chain.gravity(Vector::new(0.0, 0.0, -g));
    let angles = chain.coords("q", links.len(), "rad");
    let mut end = Pose::world();
    for (&(mass, length), angle) in links.iter().zip(&angles) {
        let (m, l) = (quantity(mass, "kg"), quantity(length, "m"));
        let link = end * Pose::rotation([0.0, 1.0, 0.0], -angle);
        let (moment, zero) = (&m * l.pow(2.0) / 12.0, || quantity(0.0, "kg*m^2"));
        let inertia = [moment.clone(), moment, zero(), zero(), zero(), zero()];
        chain.kinetic(rigid_body(&m, Vector::new(0.0, 0.0, -&l / 2.0), inertia, &link));
        end = link * Pose::translation(Vector::new(0.0, 0.0, -&l));
    }
    chain.output("tip", &end.origin());
    chain
}
