//! Triangles of STL files, text or binary.
//!
//! Source: 3D Systems, *StereoLithography Interface Specification*, 1989.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mbs_derive::source::Sources;

use super::Scene;
use crate::files::Files;

/// Files of more triangles are not read; nor are files after these together.
const MOST_TRIANGLES: usize = 60_000;

/// Corners of triangles, in the units of the file.
pub(crate) type Triangles = Vec<[[f32; 3]; 3]>;

/// Whether all meshes of a scene are there: else bodies are drawn by their inertias, beside the shapes that there are.
pub(crate) fn are_all(scene: &Scene, meshes: &BTreeMap<usize, Triangles>) -> bool {
    scene.shapes.iter().filter(|shape| shape.file.is_some()).count() == meshes.len()
}

/// Notes the files of a scene's meshes as read.
pub(crate) fn note(scene: &Scene, sources: &Sources, files: &mut Files) {
    let shapes = scene.shapes.iter().filter_map(|shape| Some((shape.file.as_ref()?, shape.place)));
    shapes.for_each(|(file, place)| files.reads("the mesh", &path(sources.locate(&(place..place)).0, file)));
}

/// Where a mesh is that a file names.
fn path(of: &str, file: &str) -> PathBuf {
    Path::new(of).parent().unwrap_or(Path::new("")).join(file)
}

/// The meshes of a scene by the numbers of their shapes, and a warning for each that is not there.
pub(crate) fn meshes(scene: &Scene, sources: &Sources) -> (BTreeMap<usize, Triangles>, Vec<String>) {
    let (mut found, mut warnings, mut count) = (BTreeMap::new(), Vec::new(), 0);
    for (number, shape) in scene.shapes.iter().enumerate() {
        let Some(file) = &shape.file else { continue };
        let (of, text, at) = sources.locate(&(shape.place..shape.place));
        let line = text[..at.start.min(text.len())].matches('\n').count() + 1;
        let path = path(of, file);
        let triangles = fs::read(&path).map_err(|error| error.to_string()).and_then(|bytes| triangles(&bytes));
        let triangles = triangles.and_then(|triangles| {
            count += triangles.len();
            let fits = count <= MOST_TRIANGLES;
            fits.then_some(triangles).ok_or(format!("it has too many triangles; all meshes may have {MOST_TRIANGLES}"))
        });
        match triangles {
            Ok(triangles) => {
                found.insert(number, triangles);
            }
            Err(reason) => {
                warnings.push(format!("{of}:{line}: the mesh {} is not drawn: {reason}", path.display()));
            }
        }
    }
    (found, warnings)
}

/// Of the bytes of a file.
fn triangles(bytes: &[u8]) -> Result<Triangles, String> {
    const HEADER: usize = 80;
    const TRIANGLE: usize = 50;
    let count = bytes.get(HEADER..HEADER + 4).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let body = bytes.get(HEADER + 4..).unwrap_or_default();
    // Binary files may begin with the word of text files; their length tells them.
    let triangles = match count.map(|count| count as usize) {
        Some(count) if count.checked_mul(TRIANGLE) == Some(body.len()) => binary(body),
        _ => std::str::from_utf8(bytes).ok().filter(|text| text.trim_start().starts_with("solid")).and_then(text),
    };
    let triangles = triangles.ok_or("it is no STL file, or not all of one; other formats are not read")?;
    if triangles.iter().flatten().flatten().all(|x| x.is_finite()) {
        Ok(triangles)
    } else {
        Err("it has corners that are NaN or not finite".to_string())
    }
}

/// A normal, three corners and two bytes each.
fn binary(body: &[u8]) -> Option<Triangles> {
    let number = |bytes: &[u8]| Some(f32::from_le_bytes(bytes.try_into().ok()?));
    let triangle = |bytes: &[u8]| -> Option<[[f32; 3]; 3]> {
        let mut corners = [[0.0; 3]; 3];
        for (i, x) in corners.as_flattened_mut().iter_mut().enumerate() {
            *x = number(bytes.get(12 + 4 * i..16 + 4 * i)?)?;
        }
        Some(corners)
    };
    body.chunks_exact(50).map(triangle).collect()
}

/// `vertex x y z`, three for each triangle, up to `endsolid`.
fn text(text: &str) -> Option<Triangles> {
    let mut words = text.split_ascii_whitespace();
    let mut numbers = Vec::new();
    while let Some(word) = words.next() {
        if word == "vertex" {
            for _ in 0..3 {
                numbers.push(words.next()?.parse::<f32>().ok()?);
            }
        }
    }
    let is_whole = numbers.len() % 9 == 0 && text.contains("endsolid");
    let corner = |x: &[f32]| [x[0], x[1], x[2]];
    is_whole.then(|| numbers.chunks_exact(9).map(|n| [corner(n), corner(&n[3..]), corner(&n[6..])]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid a\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1e0 0.5\n endloop\n \
                        endfacet\nendsolid a\n";

    fn binary_of(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = b"solid, but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for corners in triangles {
            bytes.extend([0; 12]);
            bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_are_read_alike() {
        let expected = vec![[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]];
        assert_eq!(triangles(TEXT.as_bytes()).unwrap(), expected);
        assert_eq!(triangles(&binary_of(&expected)).unwrap(), expected);
        assert_eq!(triangles(&binary_of(&[])).unwrap(), Triangles::new());
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = binary_of(&[[[0.0; 3]; 3]; 2]);
        for length in 0..whole.len() {
            assert!(triangles(&whole[..length]).is_err(), "{length}");
        }
        for length in 0..TEXT.len() - "endsolid a\n".len() {
            assert!(triangles(&TEXT.as_bytes()[..length]).is_err(), "{length}");
        }
        assert!(triangles(TEXT.replace("1e0", "x").as_bytes()).is_err());
        assert!(triangles(TEXT.replace("1e0", "NaN").as_bytes()).is_err());
        assert!(triangles(&binary_of(&[[[f32::INFINITY; 3]; 3]])).is_err());
        assert!(triangles(b"v 0 0 0\nv 1 0 0\n").is_err());
    }
}
