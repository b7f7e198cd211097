//! CSV files that are imported: each column is an array of constants.
//!
//! ```text
//! table  := header row+                   a line each; empty lines and those that begin with `#` are skipped
//! header := column ("," column)*          column := name ("[" unit "]")?
//! row    := number ("," number)*          number := ("+" | "-")? decimal
//! ```
//!
//! `stretch [mm]` above `-40` and `15` is `const stretch[2]: mm = [-40, 15];`, every part with its place in the table.

use super::grammar::{self, File};
use super::import::Shared;
use super::number::no_number;
use super::syntax::{Expression, ExpressionKind, Quantity, Span, Statement, StatementKind};
use crate::diagnostic::{Code, Diagnostics};

const COMMAS: &str = "columns are separated by commas, and decimals have a point";

const FORM: &str = "write a name and its unit, `stretch [mm]`";

/// The constants that a table declares.
pub(super) fn read(text: &str) -> File<Shared> {
    let (mut errors, mut tokens) = (Diagnostics::default(), 0);
    let mut lines = lines(text);
    let Some(header) = lines.next() else {
        errors
            .error(Code::TableForm, 0..0, "this table is empty")
            .help("its first line has the names of its columns: `stretch [mm], pull [N]`");
        return File { imports: Vec::new(), content: None, tokens, errors };
    };
    let columns: Vec<Option<Quantity>> =
        cells(text, &header).map(|cell| column(text, &cell, &mut tokens, &mut errors)).collect();
    let mut values: Vec<Vec<Expression>> = columns.iter().map(|_| Vec::new()).collect();
    let mut count = 0;
    for line in lines {
        count += 1;
        let numbers: Vec<Option<Expression>> = cells(text, &line).map(|cell| number(text, cell, &mut errors)).collect();
        tokens += 2 * numbers.len();
        let are_numbers = numbers.iter().all(Option::is_some);
        if numbers.len() != columns.len() && are_numbers && !errors.is_full() {
            let message = format!("{} in this line, {} in the first", counted(numbers.len()), counted(columns.len()));
            errors
                .error(Code::TableForm, line, message)
                .help("each line has a number for each column, with commas between them");
        }
        for (column, number) in values.iter_mut().zip(numbers) {
            column.extend(number);
        }
    }
    if count == 0 {
        errors
            .error(Code::TableForm, header.clone(), "this table has no line of numbers")
            .help("write them below the names");
    }
    let declared = columns.into_iter().zip(values).filter_map(|(column, values)| Some(constant(column?, values)));
    File { imports: Vec::new(), content: Some(Shared::Declarations(declared.collect())), tokens, errors }
}

fn counted(n: usize) -> String {
    format!("{n} {}", if n == 1 { "value" } else { "values" })
}

/// The lines that say something, without the white space around them.
fn lines(text: &str) -> impl Iterator<Item = Span> {
    let mut start = 0;
    let all = text.split_inclusive('\n').map(move |line| {
        let from = start;
        start += line.len();
        from..start
    });
    all.map(|line| trimmed(text, line)).filter(|line| !line.is_empty() && !text[line.clone()].starts_with('#'))
}

fn cells(text: &str, line: &Span) -> impl Iterator<Item = Span> {
    let mut start = line.start;
    text[line.clone()].split(',').map(move |cell| {
        let from = start;
        start += cell.len() + 1;
        trimmed(text, from..from + cell.len())
    })
}

/// Without white space at its ends, and without the mark that some programs put before the first line.
fn trimmed(text: &str, span: Span) -> Span {
    let is_space = |c: char| c.is_whitespace() || c == '\u{feff}';
    let inner = text[span.clone()].trim_start_matches(is_space);
    let start = span.end - inner.len();
    start..start + inner.trim_end_matches(is_space).len()
}

/// What a column is called, and its unit: read as `name: unit = 0`, in which every part stands where it stands in the
/// table.
fn column(text: &str, cell: &Span, tokens: &mut usize, errors: &mut Diagnostics) -> Option<Quantity> {
    let written = &text[cell.clone()];
    let (name, unit) = match written.split_once('[') {
        None => (written, None),
        Some((name, unit)) => (name, Some(unit.strip_suffix(']').unwrap_or("]"))),
    };
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_unit = |c: char| is_name(c) || "*/^()- ".contains(c);
    let is_plain = name.trim_end().chars().all(is_name)
        && unit.is_none_or(|unit| unit.chars().all(is_unit) && !unit.contains("//") && !unit.contains("/*"));
    if written.is_empty() || !is_plain {
        let help = match written.contains(';') {
            true => COMMAS,
            false => FORM,
        };
        errors.error(Code::TableForm, cell.clone(), "this is not the name of a column").help(help);
        return None;
    }
    let declared = match unit {
        None => format!("{name}=0"),
        Some(unit) => format!("{name}:{unit}=0"),
    };
    let mut read = grammar::quantity(&declared);
    *tokens += read.tokens;
    read.shift(cell.start);
    errors.append(read.errors);
    read.content
}

/// `-1.5e-3`; also `+2`, `.5` and `3.`, which programs write.
fn number(text: &str, cell: Span, errors: &mut Diagnostics) -> Option<Expression> {
    let written = &text[cell.clone()];
    let unsigned = written.strip_prefix(['-', '+']).unwrap_or(written);
    let (mantissa, exponent) = match unsigned.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (unsigned, None),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let are_digits = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    let is_exponent = |e: &str| {
        let digits = e.strip_prefix(['-', '+']).unwrap_or(e);
        !digits.is_empty() && are_digits(digits)
    };
    let has_digits = !(whole.is_empty() && fraction.is_empty());
    if !(has_digits && are_digits(whole) && are_digits(fraction) && exponent.is_none_or(is_exponent)) {
        let message = if written.is_empty() { "a number is missing" } else { "this is not a decimal number" };
        let help = match written.contains(';') {
            true => COMMAS,
            false => "write `0.3`, `-1.5e-3`; the unit stands in the first line, behind the name",
        };
        if !errors.is_full() {
            errors.error(Code::TableNumber, cell, message).help(help);
        }
        return None;
    }
    let mut decimal = if whole.is_empty() { "0".to_string() } else { whole.to_string() };
    if !fraction.is_empty() {
        decimal = format!("{decimal}.{fraction}");
    }
    if let Some(exponent) = exponent {
        decimal = format!("{decimal}e{exponent}");
    }
    if let Some((message, help)) = no_number(written, &decimal, "") {
        errors.error(Code::TableNumber, cell, message).help(help);
        return None;
    }
    let unsigned = Expression { kind: ExpressionKind::Number(decimal), span: cell.clone() };
    Some(match written.starts_with('-') {
        true => Expression { kind: ExpressionKind::Negate(Box::new(unsigned)), span: cell },
        false => unsigned,
    })
}

fn constant(column: Quantity, values: Vec<Expression>) -> Statement {
    let span = column.name.span.clone();
    let length = Expression { kind: ExpressionKind::Number(values.len().to_string()), span: span.clone() };
    let value = Expression { kind: ExpressionKind::Array(values), span: span.clone() };
    let quantity = Quantity { length: Some(length), value: Some(value), ..column };
    Statement { kind: StatementKind::Const(quantity), span }
}

#[cfg(test)]
mod tests {
    use crate::parse;
    use crate::source::{Sources, Unreadable};

    fn gathered(table: &str) -> Sources {
        let missing = || Unreadable::new("there is no such file", "look for it");
        Sources::gather("m.mbs", "import \"t/a.csv\"; mechanism M { coord x: m; }", |name| {
            (name == "t/a.csv").then(|| table.as_bytes().to_vec()).ok_or_else(missing)
        })
    }

    #[track_caller]
    fn declares(table: &str, expected: &[&str]) {
        let sources = gathered(table);
        let declaration = parse::declaration_of(&sources).unwrap_or_else(|e| panic!("{}", e.render_in(&sources)));
        let shown: Vec<String> =
            declaration.imported.iter().map(|statement| statement.to_string().trim_end().to_string()).collect();
        assert_eq!(shown, expected, "{table}");
    }

    #[track_caller]
    fn refused(table: &str, expected: &[&str]) {
        let sources = gathered(table);
        let errors = parse::declaration_of(&sources).err().unwrap_or_default();
        let line = |m: &crate::diagnostic::Diagnostic| {
            let (name, text, span) = sources.locate(&m.span);
            assert_eq!(name, "t/a.csv");
            format!("{}: {}; {}", &text[span], m.message, m.help.as_deref().unwrap_or("no help"))
        };
        assert_eq!(errors.iter().map(line).collect::<Vec<_>>(), expected, "{table}");
    }

    #[test]
    fn columns_are_constants() {
        declares(
            "stretch [mm], pull [N]\n-40,-90\n15 , 2.5e1\n",
            &["const stretch[2]: mm = [-40, 15];", "const pull[2]: N = [-90, 2.5e1];"],
        );
        declares(
            "\u{feff}# measured\r\n\r\na,b[kg*m^2/s^2]\r\n.5,+3.\r\n# more\r\n1E3,-0\r\n",
            &["const a[2] = [0.5, 1e3];", "const b[2]: kg*m^2*s^-2 = [3, -0];"],
        );
        // The quotation is no import of its own.
        declares("import\n\"b.mbs\"\n".replace("import\n\"b.mbs\"", "a\n1").as_str(), &["const a[1] = [1];"]);
    }

    #[test]
    fn what_is_wrong_is_shown_in_the_table() {
        refused(
            "a [m]\n1\nx\n",
            &[
                "x: this is not a decimal number; write `0.3`, `-1.5e-3`; the unit stands in the first line, behind the name",
            ],
        );
        refused(
            "a,b\n1,2\n3\n",
            &[
                "3: 1 value in this line, 2 values in the first; each line has a number for each column, with commas between them",
            ],
        );
        refused(
            "a,b\n1,,2\n",
            &[": a number is missing; write `0.3`, `-1.5e-3`; the unit stands in the first line, behind the name"],
        );
        refused(
            "a;b\n1;2\n",
            &[
                "a;b: this is not the name of a column; columns are separated by commas, and decimals have a point",
                "1;2: this is not a decimal number; columns are separated by commas, and decimals have a point",
            ],
        );
        refused("\"a\"\n1\n", &["\"a\": this is not the name of a column; write a name and its unit, `stretch [mm]`"]);
        refused("a [m\n1\n", &["a [m: this is not the name of a column; write a name and its unit, `stretch [mm]`"]);
        refused("a [m]\n", &["a [m]: this table has no line of numbers; write them below the names"]);
        refused("a\n1e999\n", &["1e999: `1e999` is beyond the range of an `f64`; choose other units"]);
        refused(
            "for\n1\n",
            &["for: `for` cannot be declared: it is a keyword of the language; choose another name, such as `for_`"],
        );
        refused("", &[": this table is empty; its first line has the names of its columns: `stretch [mm], pull [N]`"]);
    }
}
