//! Which calculation makes which figures.

use mbs_chart::{Figure, Format};
use mbs_examples::Failure;

use crate::{data, scheme_arm, scheme_frames, scheme_platform};

/// Figures that are made of one calculation, with their numbers.
pub(crate) struct Job {
    pub(crate) numbers: &'static [&'static str],
    draw: fn() -> Result<Vec<Figure>, Failure>,
}

/// Those that take longest first.
pub(crate) const JOBS: [Job; 16] = [
    Job { numbers: &["5.2", "5.3", "5.4", "5.5"], draw: || data::landing(0) },
    Job { numbers: &["5.6", "5.7", "5.8", "5.9"], draw: || data::landing(1) },
    Job { numbers: &["7.3", "7.4"], draw: data::about_a_station },
    Job { numbers: &["3.4", "3.6", "3.8", "3.10"], draw: || data::arm(0) },
    Job { numbers: &["3.5", "3.7", "3.9", "3.11"], draw: || data::arm(1) },
    Job { numbers: &["4.9", "4.10", "4.11", "4.12"], draw: data::table_4 },
    Job { numbers: &["4.5", "4.6", "4.8", "4.7"], draw: data::table_3 },
    Job { numbers: &["3.1"], draw: scheme_arm::both_ways },
    Job { numbers: &["3.2"], draw: scheme_arm::side_view },
    Job { numbers: &["3.3"], draw: scheme_arm::second_angle },
    Job { numbers: &["4.1"], draw: scheme_platform::frames },
    Job { numbers: &["4.2"], draw: scheme_platform::joints },
    Job { numbers: &["4.3"], draw: scheme_platform::actuator },
    Job { numbers: &["4.4"], draw: scheme_platform::spherical },
    Job { numbers: &["5.1"], draw: scheme_frames::vehicle },
    Job { numbers: &["7.1", "7.2"], draw: scheme_frames::orbits },
];

impl Job {
    /// Its figures as SVG, each with its number.
    pub(crate) fn drawn(&self) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
        let figures = (self.draw)()?;
        assert_eq!(figures.len(), self.numbers.len(), "a figure for each number of {:?}", self.numbers);
        let pairs = self.numbers.iter().zip(&figures);
        pairs.map(|(number, figure)| Ok((*number, mbs_chart::draw(figure, Format::Svg)?))).collect()
    }
}
