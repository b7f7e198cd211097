//! Robots of other formats, damaged: elements deleted, doubled, moved, exchanged; values replaced by others of the
//! file and numbers by strange ones; attributes and elements of the formats put where they do not belong; stray
//! characters; truncation. Whatever is done to a file, it is read or refused, with a place in it.

use std::ops::Range;

use mbs_derive::expr::Graph;
use mbs_derive::source::Sources;
use mbs_derive::{declared, parse};

use super::examine;
use crate::random::Random;

/// Small robots, in which every kind of joint, body and coupling occurs: `tests/import/robots/`.
pub const ROBOTS: [(&str, &str); 6] = [
    ("arm.urdf", include_str!("../../import/robots/arm.urdf")),
    ("arm.sdf", include_str!("../../import/robots/arm.sdf")),
    ("rover.urdf", include_str!("../../import/robots/rover.urdf")),
    ("drone.urdf", include_str!("../../import/robots/drone.urdf")),
    ("walker.xml", include_str!("../../import/robots/walker.xml")),
    ("linkage.xml", include_str!("../../import/robots/linkage.xml")),
];

/// What became of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// An error with file and line.
    Refused,
    /// A text of the language that is no mechanism any more: too little is left, or it has no equations.
    Read,
    /// A mechanism.
    Derived,
}

/// The robot of a seed, damaged, with its name. It is the same on every machine.
pub fn damaged(seed: u64) -> (&'static str, String) {
    let mut random = Random::new(seed);
    let (file, xml) = ROBOTS[below(&mut random, ROBOTS.len())];
    let count = 1 + below(&mut random, 4);
    (file, (0..count).fold(xml.to_string(), |text, _| edited(&mut random, text)))
}

/// Reads a file as `mbs import` does, with options that the seed chooses.
///
/// # Errors
/// What does not hold that should.
pub fn answered(seed: u64, file: &str, xml: &str) -> Result<Outcome, String> {
    let mut random = Random::new(!seed);
    let robot = Sources::robot(file, xml)
        .parameters(random.one_in(4))
        .floating(random.one_in(4))
        .angles(random.one_in(4))
        .any_inertia(random.one_in(4));
    let has_meshes = !random.one_in(4);
    let sources = Sources::new(file, xml);
    let (text, warnings) = match robot.text(&|path| has_meshes.then(|| path.to_string())) {
        Ok(found) => found,
        Err(errors) if !errors.has_errors() => return Err("it is refused without an error".to_string()),
        Err(errors) => return examine::reported(&errors, &sources).map(|()| Outcome::Refused),
    };
    if warnings.iter().next().is_some() {
        examine::reported(&warnings, &sources)?;
    }
    if !text.ends_with("\n}\n") {
        return Err(format!("what is written is not whole:\n{text}"));
    }
    let written = Sources::new("robot.mbs", &text);
    if let Err(errors) = parse::declaration_of(&written) {
        return Err(format!("what is written cannot be read:\n{}\n{text}", errors.render_in(&written)));
    }
    let graph = Graph::verbatim();
    Ok(if declared(&text, &graph, &[]).is_ok() { Outcome::Derived } else { Outcome::Read })
}

fn below(random: &mut Random, n: usize) -> usize {
    (random.bits() % n.max(1) as u64) as usize
}

fn one<T: Clone>(random: &mut Random, all: &[T]) -> Option<T> {
    all.get(below(random, all.len())).cloned()
}

/// One of those that `|` separates.
fn word<'w>(random: &mut Random, words: &'w str) -> &'w str {
    let all: Vec<&str> = words.split('|').collect();
    all[below(random, all.len())]
}

/// The elements, attributes and values of the three formats.
pub fn words() -> impl Iterator<Item = String> {
    WORDS.split('|').map(str::trim).map(String::from)
}

/// One change.
fn edited(random: &mut Random, mut text: String) -> String {
    let kind = below(random, 16);
    let found = match kind {
        0..5 => elements(&text),
        5..11 => values(&text),
        11..14 => tags(&text),
        _ => places(&text),
    };
    let Some(at) = one(random, &found) else { return text };
    match kind {
        0 => text.replace_range(at, ""),
        1 => {
            let again = text[at.clone()].to_string();
            text.insert_str(at.end, &again);
        }
        // A copy of one element stands within, before or behind another one, or in its place.
        2 | 3 => {
            let Some(to) = one(random, &found) else { return text };
            let copy = text[at].to_string();
            match below(random, 3) {
                0 => text.replace_range(to, &copy),
                1 => text.insert_str(to.start, &copy),
                _ => text.insert_str(to.end, &copy),
            }
        }
        4 => {
            let Some(to) = one(random, &found) else { return text };
            let (first, second) = if at.start < to.start { (at, to) } else { (to, at) };
            if first.end > second.start {
                return text;
            }
            let (a, b) = (text[first.clone()].to_string(), text[second.clone()].to_string());
            text.replace_range(second, &a);
            text.replace_range(first, &b);
        }
        // A name becomes another one of the file, or a word of a format.
        5 | 6 => {
            let Some(from) = one(random, &found) else { return text };
            let copy = text[from].to_string();
            text.replace_range(at, &copy);
        }
        7 => text.replace_range(at, word(random, WORDS)),
        8..11 => {
            let Some(number) = one(random, &numbers(&text, &at)) else { return text };
            text.replace_range(number, word(random, NUMBERS));
        }
        // Tags: an attribute more, another name, an element within.
        11 => {
            let (name, value) = (word(random, WORDS), word(random, NUMBERS));
            text.insert_str(at.end, &format!(" {name}=\"{value}\""));
        }
        12 => text.replace_range(at, word(random, WORDS)),
        13 => text.insert_str(at.start - 1, &format!("<{}/>", word(random, WORDS))),
        14 => text.insert_str(at.start, word(random, PIECES)),
        _ if random.one_in(4) => text.truncate(at.start),
        _ => {
            let end = (at.start + [1, 3, 20, 200][below(random, 4)]).min(text.len());
            let end = (end..=text.len()).find(|&end| text.is_char_boundary(end)).unwrap_or(text.len());
            text.replace_range(at.start..end, "");
        }
    }
    text
}

/// Where characters begin.
fn places(text: &str) -> Vec<Range<usize>> {
    text.char_indices().map(|(at, _)| at..at).collect()
}

/// What stands in quotes, and between tags.
fn values(text: &str) -> Vec<Range<usize>> {
    let (mut found, mut start, mut is_tag) = (Vec::new(), 0, false);
    for (at, c) in text.char_indices() {
        match c {
            '<' if !is_tag => {
                if !text[start..at].trim().is_empty() {
                    found.push(start..at);
                }
                is_tag = true;
            }
            '>' if is_tag => (is_tag, start) = (false, at + 1),
            '"' if is_tag => {
                if text[..at].ends_with('=') {
                    start = at + 1;
                } else {
                    found.push(start..at);
                }
            }
            _ => {}
        }
    }
    found
}

/// The words of a value.
fn numbers(text: &str, value: &Range<usize>) -> Vec<Range<usize>> {
    let (mut found, mut at) = (Vec::new(), value.start);
    for word in text[value.clone()].split_inclusive(' ') {
        found.push(at..at + word.trim_end().len());
        at += word.len();
    }
    found
}

/// The names of tags that begin elements.
fn tags(text: &str) -> Vec<Range<usize>> {
    let begins = text.match_indices('<').map(|(at, _)| at + 1);
    let name = |start: usize| {
        let length = text[start..].find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(text.len() - start);
        start..start + length
    };
    begins.map(name).filter(|name| !name.is_empty()).collect()
}

/// Elements from their first tag to their last one.
fn elements(text: &str) -> Vec<Range<usize>> {
    let (mut found, mut open) = (Vec::new(), Vec::new());
    for (start, _) in text.match_indices('<') {
        let Some(end) = text[start..].find('>').map(|length| start + length + 1) else { continue };
        match &text[start..end] {
            tag if tag.starts_with("</") => found.extend(open.pop().map(|start| start..end)),
            tag if tag.starts_with("<!") || tag.starts_with("<?") => {}
            tag if tag.ends_with("/>") => found.push(start..end),
            _ => open.push(start),
        }
    }
    found
}

/// Zero, tiny, huge, not finite, NaN, nearly right angles, and what is not written as a number.
const NUMBERS: &str = "\
    0|-0|1|-1|2|0.5|1e-3|1e3|1e9|1e300|-1e300|1e308|1e400|1e-300|1e-320|nan|NaN|inf|-Infinity|1.5707963267948966|\
    1.57079632679|3.14159265358979|-1.5708|6.283185307179586|0.70710678118654757|180|90 deg|1 kg|1,5|0x10|1e|+1|\
    .5|5.||1 2|0 0 1|${a}|true|١|12345678901234567890|0.1 0.2 0.3 0.4 0.5 0.6 0.7";

/// What XML gives a meaning to, or the language.
const PIECES: &str = "\
    <|>|/|\"|'|&|&lt;|&#0;|&#x110000;|&a;|<!--|-->|<![CDATA[|]]>|<?x?>|\u{0}|\u{feff}|\u{2028}|θ|\r|\t|*/|//|\\|{|\
    }|;";

/// Elements, attributes and values of the three formats, and words of the language.
const WORDS: &str = "\
    robot|link|joint|inertial|origin|mass|inertia|visual|collision|geometry|mesh|box|cylinder|sphere|capsule|\
    ellipsoid|plane|parent|child|axis|axis2|limit|dynamics|damping|friction|mimic|calibration|safety_controller|\
    material|transmission|gazebo|xacro|fixed|revolute|revolute2|continuous|prismatic|planar|floating|universal|\
    ball|free|hinge|slide|screw|gearbox|sdf|world|model|pose|frame|include|gravity|xyz|rpy|relative_to|\
    expressed_in|mujoco|worldbody|body|geom|site|freejoint|compiler|option|default|class|childclass|asset|tendon|\
    spatial|equality|connect|weld|polycoef|actuator|motor|name|type|pos|quat|euler|axisangle|xyaxes|zaxis|fromto|\
    size|density|diaginertia|fullinertia|ref|springref|stiffness|springlength|armature|frictionloss|range|angle|\
    degree|radian|eulerseq|coordinate|autolimits|inertiafromgeom|inertiagrouprange|group|boundmass|boundinertia|\
    settotalmass|meshdir|scale|filename|multiplier|offset|lower|upper|effort|velocity|ixx|iyz|mechanism|coord|\
    param|let|sin|pi|t|g|base|turntable|crank|trunk||a b|θ|9x|__proto__|self|r#fn";
