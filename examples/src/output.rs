//! Figures and tables in a folder.

use std::path::Path;

use mbs_chart::{Figure, Format};

use crate::{Failure, assumed};

/// Makes a folder, with those that it lies in.
///
/// # Errors
/// What the file system refuses, with the folder's name.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::new(format!("{}: {error}", folder.display())))
}

/// Writes `name.svg` and `name.png`, with a note below the title that says what of `docs/thesis/assumed.md` the figure
/// rests on, and so much higher; `keys` are those of the page, none where everything is known.
///
/// # Errors
/// What drawing or the file system refuses.
pub fn write_figure(folder: &Path, name: &str, figure: &Figure, keys: &[&str]) -> Result<(), Failure> {
    let (width, height) = figure.size;
    let mut figure = figure.clone();
    if !keys.is_empty() {
        let note = assumed::caption(keys);
        figure.size = (width, height + mbs_chart::note_height(&note, width)?);
        figure.title = format!("{}\n{note}", figure.title);
    }
    let figure = &figure;
    for (format, extension) in [(Format::Svg, "svg"), (Format::Png, "png")] {
        std::fs::write(folder.join(format!("{name}.{extension}")), mbs_chart::draw(figure, format)?)?;
    }
    Ok(())
}

/// Writes `name.csv`: a header, then rows of numbers that read back as the same.
///
/// # Errors
/// Rows of another length than the header, and what the file system refuses.
pub fn write_table(
    folder: &Path,
    name: &str,
    header: &[String],
    rows: impl IntoIterator<Item = Vec<f64>>,
) -> Result<(), Failure> {
    let mut writer = csv::Writer::from_path(folder.join(format!("{name}.csv")))?;
    writer.write_record(header)?;
    for row in rows {
        writer.write_record(row.iter().map(f64::to_string))?;
    }
    writer.flush()?;
    Ok(())
}
