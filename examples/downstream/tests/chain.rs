//! The chain that `build.rs` writes from `links.csv`, against formulas typed by hand.

mbs_runtime::include_mechanism!("chain");
use chain::Chain;

const G: f64 = 9.81;
const LINKS: [(f64, f64); 3] = [(1.5, 0.4), (0.7, 0.3), (0.3, 0.25)];

/// Straight down it is as long as the table says, and its potential energy is that of the links' centres.
#[test]
fn it_hangs_as_the_table_says() {
    let chain = Chain::<f64>::default();
    let length: f64 = LINKS.iter().map(|(_, l)| l).sum();
    assert!((chain.tip(&[0.0; 3])[2] + length).abs() < 1e-15);
    let (mut top, mut energy) = (0.0, 0.0);
    for (m, l) in LINKS {
        energy -= m * G * (top + l / 2.0);
        top += l;
    }
    assert!((chain.potential_energy(&[0.0; 3]) - energy).abs() < 1e-12);
}

/// `M₁₁` about the first hinge of links that are stretched out: `Σ m (l²/12 + r²)`, r the distance of a centre.
#[test]
fn it_turns_about_its_first_hinge() {
    let m = Chain::<f64>::default().mass_matrix(&[0.3, 0.0, 0.0]);
    let (mut start, mut inertia) = (0.0, 0.0);
    for (mass, l) in LINKS {
        inertia += mass * (l * l / 12.0 + (start + l / 2.0) * (start + l / 2.0));
        start += l;
    }
    assert!((m[0][0] - inertia).abs() < 1e-14 * inertia, "{} {inertia}", m[0][0]);
}
