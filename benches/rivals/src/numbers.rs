//! The numbers of the benchmark arm, `tests/data/arm6.json`.

/// The arm.
#[derive(serde::Deserialize)]
pub struct Arm {
    pub dh: Vec<Frame>,
    pub links: Vec<Link>,
    pub g: f64,
}

/// A link's frame in that of the one before, at joint angle zero: lengths \[m\] and the twist \[°\].
#[derive(serde::Deserialize)]
pub struct Frame {
    pub d: f64,
    pub a: f64,
    pub alpha_deg: f64,
}

/// A link's mass \[kg\], mass centre \[m\], and inertia about it \[kg m²\]: xx, xy, xz, yy, yz, zz.
#[derive(serde::Deserialize)]
pub struct Link {
    pub m: f64,
    pub com: [f64; 3],
    #[serde(rename = "I")]
    pub inertia: [f64; 6],
}

/// The file of the arm.
pub const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/arm6.json");

impl Arm {
    pub fn read() -> Arm {
        let text = std::fs::read_to_string(FILE).unwrap_or_else(|error| panic!("{FILE}: {error}"));
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{FILE}: {error}"))
    }
}
