//! The gallery as outside programs call it: a page with all figures of the thesis.

use crate::support::{good, refused};

const PROGRAM: &str = env!("CARGO_BIN_EXE_gallery");

/// What stands between two texts, at every place.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    text.split(start).skip(1).filter_map(|rest| rest.split(end).next()).collect()
}

#[test]
fn the_page_lists_36_figures_with_captions_and_what_they_rest_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    good(PROGRAM, &["--out", out.to_str().unwrap(), "--only", "3.1,4.3,5.1,7.2"]);
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    let list = between(&page, "<ol>", "</ol>")[0];
    let entries = between(list, "<li>", "</li>");
    let chapters = [(3, 11), (4, 12), (5, 9), (7, 4)];
    let numbers = chapters.iter().flat_map(|(chapter, count)| (1..=*count).map(move |i| format!("{chapter}.{i}")));
    let expected: Vec<String> = numbers.collect();
    assert_eq!((entries.len(), expected.len()), (36, 36));
    for (entry, number) in entries.iter().zip(&expected) {
        let (_, title) = entry.split_once(&format!("<a href=\"#figure-{number}\">Figure {number}</a> ")).unwrap();
        assert!(title.len() > 10, "{number}: {title}");
        let own = between(&page, &format!("<figure id=\"figure-{number}\">"), "</figure>");
        assert!(own.len() == 1 && own[0].contains(title) && own[0].contains("assumed: "), "{number}: {own:?}");
    }
    let mut names: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let figures = ["figure_3_1.svg", "figure_4_3.svg", "figure_5_1.svg", "figure_7_2.svg"];
    assert_eq!(names, [&["chapters.svg"], &figures[..], &["index.html"]].concat());
    for name in figures {
        let svg = std::fs::read_to_string(out.join(name)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("viewBox") && !svg.contains("NaN"), "{name}");
        assert!(page.contains(&format!("<img src=\"{name}\"")), "{name}");
    }
    assert_eq!(page.matches("not drawn this time").count(), 32);
}

#[test]
fn the_same_bytes_again() {
    let draw = || {
        let folder = tempfile::tempdir().unwrap();
        good(PROGRAM, &["--out", folder.path().to_str().unwrap(), "--only", "4.5,3.2"]);
        ["figure_4_5.svg", "figure_3_2.svg", "index.html"].map(|name| std::fs::read(folder.path().join(name)).unwrap())
    };
    assert!(draw() == draw());
}

#[test]
fn unknown_figures_end_with_2_and_the_list_of_those_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("none");
    for wrong in ["6.1", "3.12", "3.4,x", ""] {
        let told = refused(PROGRAM, &["--out", out.to_str().unwrap(), "--only", wrong]);
        assert!(told.contains("3.1, 3.2") && told.contains("7.4"), "{wrong}: {told}");
        assert!(!out.exists(), "{wrong}");
    }
    refused(PROGRAM, &[]);
}
