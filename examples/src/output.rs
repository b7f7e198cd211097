//! Figures and tables in a folder.

use std::io::Write;
use std::path::Path;

use mbs_chart::{Figure, Format};

use crate::{Failure, assumed, figures};

/// Makes a folder, with those that it lies in.
///
/// # Errors
/// What the file system refuses, with the folder's name.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::new(format!("{}: {error}", folder.display())))
}

/// Writes `name.svg` and `name.png`, with a note below the title that says what of `docs/thesis/assumed.md` the figure
/// rests on, and higher by that note; `keys` are those of the page, none where everything is known.
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
        write_file(&folder.join(format!("{name}.{extension}")), &mbs_chart::draw(figure, format)?)?;
    }
    Ok(())
}

/// Writes figures of the thesis, named `figure_5_2`, by [`write_figure`] with what each rests on.
///
/// # Errors
/// Those of [`write_figure`].
pub fn write_figures(folder: &Path, drawn: &[(String, Figure)]) -> Result<(), Failure> {
    let number = |name: &str| name.trim_start_matches("figure_").replace('_', ".");
    drawn.iter().try_for_each(|(name, figure)| write_figure(folder, name, figure, &figures::keys(&number(name))))
}

/// The columns of a table: words, of which `leg[1-3]_N` is `leg1_N`, `leg2_N` and `leg3_N`.
fn columns(words: &str) -> Vec<String> {
    let numbered = |word: &str| -> Option<Vec<String>> {
        let (before, rest) = word.split_once('[')?;
        let (range, behind) = rest.split_once(']')?;
        let (first, last) = range.split_once('-')?;
        let numbers = first.parse::<u8>().ok()?..=last.parse().ok()?;
        Some(numbers.map(|number| format!("{before}{number}{behind}")).collect())
    };
    words.split_whitespace().flat_map(|word| numbered(word).unwrap_or_else(|| vec![word.to_string()])).collect()
}

/// Writes `name.csv` with these [`columns`] as its header, then rows of numbers.
///
/// # Errors
/// Those of [`write_records`].
pub fn write_table(
    folder: &Path,
    name: &str,
    words: &str,
    rows: impl IntoIterator<Item = Vec<f64>>,
) -> Result<(), Failure> {
    write_records(folder, name, columns(words), rows)
}

/// Writes `name.csv`: a header, then rows of numbers, which read back as the same, or of words.
///
/// # Errors
/// Rows of another length than the header, and what the file system refuses.
pub fn write_records(
    folder: &Path,
    name: &str,
    header: impl IntoIterator<Item = String>,
    rows: impl IntoIterator<Item = Vec<impl ToString>>,
) -> Result<(), Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.into_iter().collect::<Vec<_>>())?;
    rows.into_iter().try_for_each(|row| writer.write_record(row.iter().map(ToString::to_string)))?;
    let bytes = writer.into_inner().map_err(|error| Failure::new(error.to_string()))?;
    write_file(&folder.join(format!("{name}.csv")), &bytes)
}

/// Writes `name.json`, in one line.
///
/// # Errors
/// Those of [`write_file`].
pub fn write_json(folder: &Path, name: &str, value: &serde_json::Value) -> Result<(), Failure> {
    write_file(&folder.join(format!("{name}.json")), format!("{value}\n").as_bytes())
}

/// Writes a file whole or not at all: beside its place first, then there.
///
/// # Errors
/// What the file system refuses, with the file's name.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let beside = path.with_extension("part");
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path));
    written.map_err(|error| {
        // Where nothing was written there is nothing to take away.
        let _ = std::fs::remove_file(&beside);
        Failure::new(format!("{}: {error}", path.display()))
    })
}

/// Prints a text; a reader that has gone away ends the program quietly, anything else with a message and exit code 1.
pub fn print(text: std::fmt::Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_fmt(text).and_then(|()| out.flush()) {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            std::process::exit(0);
        }
        eprintln!("Error: standard output: {error}");
        std::process::exit(1);
    }
}

/// `std::print!` by [`output::print`](crate::output::print).
#[macro_export]
macro_rules! print {
    ($($argument:tt)*) => { $crate::output::print(format_args!($($argument)*)) };
}

/// `std::println!` by [`output::print`](crate::output::print).
#[macro_export]
macro_rules! println {
    () => { $crate::output::print(format_args!("\n")) };
    ($($argument:tt)*) => { $crate::output::print(format_args!("{}\n", format_args!($($argument)*))) };
}

#[cfg(test)]
mod tests {
    #[test]
    fn columns_are_words_with_numbers() {
        let expected = ["t_s", "q9_deg", "q10_deg", "l[m]", "z_m"];
        assert_eq!(super::columns("t_s q[9-10]_deg l[m] z_m"), expected);
    }
}
