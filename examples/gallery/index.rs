//! The page that shows the figures.

use mbs_examples::figures::{Entry, FIGURES, assumptions, file_name};

const STYLE: &str = "\
:root { color-scheme: light dark }
body { font-family: 'DejaVu Sans', Verdana, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; \
line-height: 1.45; color: light-dark(#1a1a1a, #e4e8ec); background: light-dark(#fff, #15181c) }
h1, h2 { font-weight: 600 }
figure { margin: 2.5rem 0; padding: 0 }
img { max-width: 100%; height: auto; border: 1px solid light-dark(#ddd, #323942) }
figcaption { margin-top: .5rem }
ol { columns: 2; list-style: none; padding: 0; font-size: .85rem }
li { break-inside: avoid; margin: .2rem 0 }
.assumed { display: block; color: light-dark(#555, #98a3ae); font-size: .85rem }
.missing { color: light-dark(#777, #808a94) }
";

/// With those figures that were drawn.
pub(crate) fn page(drawn: &[&str]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>The figures of the thesis</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>The figures of the thesis</h1>\n\
         <p>The thesis' summary has captions and no pictures. These are made from the mechanisms that its equations \
         describe; what each rests on that the thesis does not give stands under it, with reasons in \
         <code>docs/thesis/assumed.md</code>.</p>\n"
    );
    page += "<figure>\n<img src=\"chapters.svg\" alt=\"Diagram of the chapters\">\n<figcaption>The chapters, and the \
             mechanisms that they share.</figcaption>\n</figure>\n<h2>List of figures</h2>\n<ol>\n";
    for Entry { number, title, .. } in &FIGURES {
        page += &format!("<li><a href=\"#figure-{number}\">Figure {number}</a> {title}</li>\n");
    }
    page += "</ol>\n";
    for chapter in [("3", "serial manipulator"), ("4", "parallel manipulator"), ("5", "landing"), ("7", "orbits")] {
        page += &format!("<h2>Chapter {}: {}</h2>\n", chapter.0, chapter.1);
        let is_here = |entry: &&Entry| entry.number.split('.').next() == Some(chapter.0);
        for entry in FIGURES.iter().filter(is_here) {
            page += &figure(entry, drawn.contains(&entry.number));
        }
    }
    page + "</body>\n</html>\n"
}

fn figure(entry: &Entry, is_drawn: bool) -> String {
    let Entry { number, title, shows, .. } = entry;
    let picture = match is_drawn {
        true => format!("<img src=\"{}\" alt=\"Figure {number}: {title}\">", file_name(number)),
        false => "<p class=\"missing\">not drawn this time</p>".to_string(),
    };
    format!(
        "<figure id=\"figure-{number}\">\n{picture}\n<figcaption><b>Figure {number}</b> {title}. {shows} \
         <span class=\"assumed\">{}</span></figcaption>\n</figure>\n",
        assumptions(entry)
    )
}
