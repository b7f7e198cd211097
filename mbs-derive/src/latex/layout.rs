//! Lines and their widths, brackets, and factors side by side.

/// What fits on a line, in symbols as seen on paper.
pub(super) const LINE: usize = 64;

/// What fits on a line of abbreviations, most of whose symbols are subscripts.
pub(super) const LONG_LINE: usize = 84;

/// Blocks of more lines may be broken across pages.
pub(super) const LINES: usize = 30;

/// An expression as it is written.
#[derive(Clone)]
pub(super) enum Entry {
    Written(Vec<Signed>),
    TooLong,
}

impl Entry {
    /// The text in lines; all but the first begin with a sign.
    pub(super) fn lines(&self) -> Vec<String> {
        match self {
            Entry::Written(terms) => lines(terms),
            Entry::TooLong => vec!["\\text{(see below)}".to_string()],
        }
    }

    /// A text as it is.
    pub(super) fn of_text(text: String) -> Self {
        Entry::Written(vec![Signed { negative: false, text }])
    }
}

/// A term of a sum and its sign.
#[derive(Clone, Debug)]
pub(super) struct Signed {
    pub(super) negative: bool,
    pub(super) text: String,
}

pub(super) fn sum_text(terms: &[Signed]) -> String {
    let mut text = String::new();
    for (i, term) in terms.iter().enumerate() {
        text.push_str(match (i, term.negative) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        });
        text.push_str(&term.text);
    }
    if terms.is_empty() { "0".to_string() } else { text }
}

pub(super) fn lines(terms: &[Signed]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut start = 0;
    for end in 1..=terms.len() {
        let fits = end < terms.len() && width(&sum_text(&terms[start..=end])) <= LINE;
        if !fits {
            let continues = if start == 0 { "" } else { "{} + " };
            let text = sum_text(&terms[start..end]);
            // A sign at the beginning of a line is an operator all the same.
            lines.push(match text.strip_prefix('-') {
                Some(rest) if start > 0 => format!("{{}} - {rest}"),
                _ => format!("{continues}{text}"),
            });
            start = end;
        }
    }
    if lines.is_empty() { vec!["0".to_string()] } else { lines }
}

/// How many symbols are seen on paper, roughly.
pub(super) fn width(text: &str) -> usize {
    let mut width = 0;
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\\' => {
                let mut command = String::new();
                while let Some(letter) = rest.next_if(char::is_ascii_alphabetic) {
                    command.push(letter);
                }
                width += match command.as_str() {
                    "frac" | "left" | "right" | "dot" | "ddot" | "mathrm" | "operatorname" => 0,
                    "sin" | "cos" | "tan" => 3,
                    _ => 1,
                };
            }
            '{' | '}' | '^' | '_' | ' ' => {}
            '+' | '-' | '=' => width += 2,
            _ => width += 1,
        }
    }
    width
}

pub(super) fn applied(function: &str, argument: &str) -> String {
    let space = if argument.starts_with(|c: char| c.is_ascii_alphanumeric()) { " " } else { "" };
    format!("{function}{space}{argument}")
}

pub(super) fn bracketed(text: &str) -> String {
    let tall = ["\\frac", "\\left", "\\sqrt", "\\begin"].iter().any(|command| text.contains(command));
    if tall { format!("\\left({text}\\right)") } else { format!("({text})") }
}

/// Factors side by side; words are set apart.
pub(super) fn juxtaposed(number: Option<String>, factors: Vec<String>) -> String {
    let is_word =
        |text: &str| ["\\mathrm", "\\dot{\\mathrm", "\\ddot{\\mathrm"].iter().any(|word| text.starts_with(word));
    let is_wave = |text: &str| ["\\sin", "\\cos", "\\tan"].iter().any(|wave| text.starts_with(wave));
    let mut product = String::new();
    let mut after_word = false;
    for factor in number.into_iter().chain(factors) {
        let apart = is_word(&factor) || (after_word && !is_wave(&factor));
        product.push_str(match (product.is_empty(), apart) {
            (true, _) => "",
            (false, true) => " \\, ",
            (false, false) => " ",
        });
        after_word = is_word(&factor);
        product.push_str(&factor);
    }
    product
}
