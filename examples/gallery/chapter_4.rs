//! Figures 4.5 to 4.12, by the code of `platform_dynamics`.

#[path = "../platform_dynamics/figures.rs"]
#[allow(dead_code, reason = "platform_dynamics also draws poses, and writes files")]
mod figures;
#[path = "../platform_dynamics/tables.rs"]
#[allow(dead_code, reason = "platform_dynamics also prints tables")]
mod tables;

use mbs_chart::Figure;
use mbs_examples::Failure;
use mbs_platform::Platform;

/// Figures 4.5, 4.6, 4.8 and 4.7.
pub(crate) fn table_3() -> Result<Vec<Figure>, Failure> {
    let samples = tables::Samples::fine();
    let drawings = figures::along_table_3(&Platform::default(), &samples)?;
    Ok(drawings.into_iter().map(|drawing| figures::figure(&samples, drawing)).collect())
}

/// Figures 4.9 to 4.12.
pub(crate) fn table_4() -> Result<Vec<Figure>, Failure> {
    let samples = tables::Samples::fine();
    let drawings = figures::along_table_4(&Platform::default(), &samples)?;
    Ok(drawings.into_iter().map(|drawing| figures::figure(&samples, drawing)).collect())
}
