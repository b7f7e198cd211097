//! XML with places: elements and attributes, and what is said of them.

use std::collections::BTreeMap;

use roxmltree::{Document, Node, ParsingOptions};

use super::identifier::shown;
use super::pose::{Pose, norm};
use crate::diagnostic::{Code, Diagnostics};
use crate::span::Span;

/// Deeper files are no robots.
const MAX_DEPTH: usize = 500;

/// The document.
///
/// # Errors
/// Where it is not XML.
pub(super) fn document(text: &str) -> Result<Document<'_>, Diagnostics> {
    let mut errors = Diagnostics::default();
    if let Some(at) = too_deep(text) {
        errors.error(Code::Data, at..at + 1, format!("elements are nested deeper than {MAX_DEPTH} levels"));
        return Err(errors);
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 2_000_000, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let position = error.pos();
        let at = offset(text, position.row, position.col);
        let reason = error.to_string();
        // The library says the place, which is shown beside it.
        let reason = reason.split(" at ").next().unwrap_or(&reason);
        let at = if at >= text.len() { text.len()..text.len() } else { at..next(text, at) };
        errors.error(Code::Data, at, format!("this is not XML: {reason}")).help("repair it; `xmllint` tells more");
        errors
    })
}

/// What is no element, whatever stands in it.
const SKIPPED: [(&str, &str); 3] = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];

/// Where nesting becomes too deep, by the looks of it.
fn too_deep(text: &str) -> Option<usize> {
    let (mut depth, bytes) = (0usize, text.as_bytes());
    let (mut open, mut quote) = (None, None);
    let mut behind = 0;
    for (at, byte) in bytes.iter().enumerate() {
        match byte {
            _ if at < behind => {}
            b'<' => {
                // No value has a `<` in it, so that none goes on here.
                (open, quote) = (Some(at).filter(|_| bytes.get(at + 1) != Some(&b'!')), None);
                if let Some((begin, end)) = SKIPPED.iter().find(|(begin, _)| bytes[at..].starts_with(begin.as_bytes()))
                {
                    let inside = at + begin.len();
                    behind = text[inside..].find(end).map_or(text.len(), |length| inside + length + end.len());
                    open = None;
                }
            }
            b'"' | b'\'' if open.is_some() => match quote {
                None => quote = Some(byte),
                Some(other) if other == byte => quote = None,
                Some(_) => {}
            },
            b'>' if quote.is_none() => {
                if let Some(start) = open.take() {
                    if bytes.get(start + 1) == Some(&b'/') {
                        depth = depth.saturating_sub(1);
                    } else if bytes[at - 1] != b'/' {
                        depth += 1;
                    }
                    if depth > MAX_DEPTH {
                        return Some(start);
                    }
                }
            }
            _ => {}
        }
    }
    None
}

fn offset(text: &str, row: u32, column: u32) -> usize {
    let line: usize = text.split_inclusive('\n').take(row.saturating_sub(1) as usize).map(str::len).sum();
    let rest = text.get(line..).unwrap_or_default();
    let within: usize = rest.chars().take(column.saturating_sub(1) as usize).map(char::len_utf8).sum();
    line + within
}

/// The end of the character at `at`.
fn next(text: &str, at: usize) -> usize {
    at + text[at..].chars().next().map_or(0, char::len_utf8)
}

/// The start tag of an element.
pub(super) fn tag(node: Node<'_, '_>) -> Span {
    let range = node.range();
    let text = &node.document().input_text()[range.clone()];
    range.start..range.start + text.find('>').map_or(text.len(), |end| end + 1)
}

/// The value of an attribute, or the start tag where there is none.
pub(super) fn place(node: Node<'_, '_>, attribute: &str) -> Span {
    node.attribute_node(attribute).map_or_else(|| tag(node), |attribute| attribute.range())
}

/// The elements in an element that are called so.
pub(super) fn children<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'a str) -> impl Iterator<Item = Node<'a, 'i>> + 'a {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first of them.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == name)
}

/// The text in an element, whatever comments stand in it.
pub(super) fn content(node: Node<'_, '_>) -> String {
    node.children().filter(Node::is_text).filter_map(|part| part.text()).collect()
}

/// What is said while a file is read.
#[derive(Default)]
pub(super) struct Reader {
    pub(super) errors: Diagnostics,
}

impl Reader {
    pub(super) fn refuse(&mut self, place: Span, message: impl Into<String>, help: &str) {
        if self.errors.is_full() {
            return;
        }
        let error = self.errors.error(Code::Data, place, message);
        if !help.is_empty() {
            error.help(help);
        }
    }

    pub(super) fn warn(&mut self, place: Span, message: impl Into<String>, help: &str) {
        let warning = self.errors.warning(Code::Data, place, message);
        if !help.is_empty() {
            warning.help(help);
        }
    }

    /// Warns of angles that are more than a whole turn: they are degrees, most likely.
    pub(super) fn doubt_angles(&mut self, angles: [f64; 3], place: Span, of: &str) {
        // A turn that was rounded up to some digits is one.
        const TURN: f64 = 1.0001 * std::f64::consts::TAU;
        if let Some(angle) = angles.into_iter().find(|angle| angle.abs() > TURN) {
            let help = "angles are in rad here: a right angle is 1.5707963267948966";
            self.warn(place, format!("the attitude of {of} has an angle of {angle} rad, more than a whole turn"), help);
        }
    }

    /// A place with the attitude of a quaternion, `x y z w`; one without direction is reported.
    pub(super) fn attitude(&mut self, shift: [f64; 3], [x, y, z, w]: [f64; 4], place: Span, what: &str) -> Pose {
        if norm(&[x, y, z, w]) < 1e-12 {
            self.refuse(place, format!("{what} has no direction"), "a unit quaternion has the length 1");
            return Pose::default();
        }
        Pose::of_quaternion(shift, [w, x, y, z])
    }

    /// An attribute that must be there.
    pub(super) fn wanted<'a>(&mut self, node: Node<'a, '_>, attribute: &str, of: &str) -> Option<&'a str> {
        let found = node.attribute(attribute).filter(|value| !value.trim().is_empty());
        if found.is_none() {
            self.refuse(place(node, attribute), format!("{of} has no `{attribute}`"), "");
        }
        found
    }

    /// The word of an attribute, one of `words`; another one is reported.
    pub(super) fn word<'w>(&mut self, node: Node<'_, '_>, name: &str, words: &[&'w str]) -> Option<&'w str> {
        let given = node.attribute(name)?;
        let found = words.iter().find(|word| **word == given.trim());
        if found.is_none() {
            let all: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
            let help = format!("there are {}", all.join(", "));
            self.refuse(place(node, name), format!("`{name}` cannot be `{}`", shown(given)), &help);
        }
        found.copied()
    }

    /// The places of links among `links` by their names; two of one name are refused.
    pub(super) fn named_links<'a>(&mut self, links: &[Node<'a, '_>]) -> BTreeMap<&'a str, usize> {
        let mut places = BTreeMap::new();
        for (i, link) in links.iter().enumerate() {
            let Some(name) = self.wanted(*link, "name", "this link") else { continue };
            if places.insert(name, i).is_some() {
                self.refuse(place(*link, "name"), format!("a second link is called `{name}`"), "names are unique");
            }
        }
        places
    }

    /// The numbers of a text; one that is NaN, not finite or not written as a number is reported with what it was meant
    /// for.
    pub(super) fn numbers(&mut self, text: &str, span: Span, what: &str) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        for word in text.split([' ', '\t', '\n', '\r']).filter(|word| !word.is_empty()) {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                Ok(_) => {
                    self.refuse(span, format!("{what} is not finite: `{word}`"), "");
                    return None;
                }
                Err(_) => {
                    let help = match word {
                        _ if word.contains("${") => {
                            "this is xacro: run `xacro robot.urdf.xacro > robot.urdf` first, and import what it writes"
                        }
                        _ if word.contains(',') => "numbers are separated by spaces, decimals have a point",
                        _ => "numbers have no unit here: lengths are in m, angles in rad, masses in kg",
                    };
                    self.refuse(span, format!("{what} is not a number: `{word}`"), help);
                    return None;
                }
            }
        }
        Some(numbers)
    }

    /// As many numbers as wanted.
    pub(super) fn exactly<const N: usize>(&mut self, text: &str, span: Span, what: &str) -> Option<[f64; N]> {
        let numbers = self.numbers(text, span.clone(), what)?;
        match numbers.as_slice().try_into() {
            Ok(numbers) => Some(numbers),
            Err(_) => {
                let (many, given) = (if N == 1 { "one number" } else { "numbers" }, numbers.len());
                let count = if N == 1 { String::new() } else { format!("{N} ") };
                self.refuse(span, format!("{what} is {count}{many}, {given} are given"), "");
                None
            }
        }
    }

    /// The numbers of an attribute; none where it is not there or wrong, which is noted.
    pub(super) fn array<const N: usize>(&mut self, node: Node<'_, '_>, name: &str, what: &str) -> Option<[f64; N]> {
        let text = node.attribute(name)?;
        self.exactly(text, place(node, name), what)
    }

    /// The number of an attribute; none where it is not there or wrong, which is noted.
    pub(super) fn number(&mut self, node: Node<'_, '_>, name: &str, what: &str) -> Option<f64> {
        self.array::<1>(node, name, what).map(|[number]| number)
    }

    /// The numbers in an element; none where it is wrong, which is noted.
    pub(super) fn content<const N: usize>(&mut self, node: Node<'_, '_>, what: &str) -> Option<[f64; N]> {
        self.exactly(&content(node), tag(node), what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_xml_is_told_with_its_place() {
        let check = |text: &str, begin: &str| {
            let report = document(text).unwrap_err().render("robot.urdf", text);
            assert!(report.starts_with(begin), "{report}");
        };
        check(
            "<robot>\n  <link>\n</robot>",
            "error[MBS0310]: this is not XML: expected 'link' tag, not 'robot'\n --> robot.urdf:3:1",
        );
        check("", "error[MBS0310]: this is not XML: ");
        check("<a b='1' b='2'/>", "error[MBS0310]: this is not XML: attribute 'b'");
        check(&"<a>".repeat(100_000), "error[MBS0310]: elements are nested deeper than 500 levels");
        let wide = |inside: &str| format!("<robot>{}</robot>", inside.repeat(600));
        for inside in ["<p v=\"a->b\"/>", "<p v='/>'></p>", "<p><![CDATA[<a><b>]]></p>", "<?note <a>?>", "<!-- <a> -->"]
        {
            assert!(document(&wide(inside)).is_ok(), "{inside}");
        }
        check(&wide("<p v=\"a->b\">"), "error[MBS0310]: elements are nested deeper than 500 levels");
        check("<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "error[MBS0310]: this is not XML: ");
    }

    #[test]
    fn numbers_are_decimals_without_units() {
        let check = |text: &str, expected: &str| {
            let mut reader = Reader::default();
            assert!(reader.exactly::<3>(text, 0..1, "the place").is_none());
            let report: Vec<_> = reader.errors.iter().map(|e| e.message.clone()).collect();
            assert_eq!(report, [expected]);
        };
        assert_eq!(Reader::default().exactly(" 1\n-2e-3\t.5 ", 0..1, "the place"), Some([1.0, -2e-3, 0.5]));
        check("1 2", "the place is 3 numbers, 2 are given");
        check("1 2 0.3m", "the place is not a number: `0.3m`");
        check("1 nan 3", "the place is not finite: `nan`");
        check("1 2 1e999", "the place is not finite: `1e999`");
        check("1, 2, 3", "the place is not a number: `1,`");
        check("${x} 0 0", "the place is not a number: `${x}`");
    }
}
