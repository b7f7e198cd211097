//! A reader of the RAPID that `arm_trajectory` writes: one module with constants of the types jointtarget, speeddata
//! and zonedata, procedures without arguments, and MoveAbsJ in them. Everything else is refused, with its place.
//!
//! Source: ABB, *Technical reference manual, RAPID instructions, functions and data types*: MoveAbsJ, jointtarget,
//! speeddata, zonedata; *RAPID kernel*: identifiers of at most 32 characters, keywords in either case. From memory.

use std::collections::HashMap;

/// Why a text is no such module: what is wrong, and where, counted from 1.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Refused {
    pub(crate) line: usize,
    pub(crate) column: usize,
    pub(crate) reason: String,
}

/// One MoveAbsJ.
#[derive(Debug)]
pub(crate) struct Move {
    /// The robot's own angles \[°\].
    pub(crate) angles: [f64; 6],
    /// From the target before \[s\], where it is given.
    pub(crate) time: Option<f64>,
}

/// What `main` does.
#[derive(Debug)]
pub(crate) struct Module {
    pub(crate) name: String,
    pub(crate) moves: Vec<Move>,
}

#[derive(Clone, Debug)]
struct Token {
    text: String,
    line: usize,
    column: usize,
}

/// What is declared at once.
const SPEEDS: [&str; 8] = ["v5", "v10", "v20", "v50", "v100", "v200", "v500", "v1000"];
const ZONES: [&str; 8] = ["fine", "z0", "z1", "z5", "z10", "z20", "z50", "z100"];
const LONGEST_NAME: usize = 32;

pub(crate) fn read(text: &str) -> Result<Module, Refused> {
    let mut reader = Reader { tokens: tokens(text)?, next: 0, names: HashMap::new(), main: None };
    reader.module()
}

fn tokens(text: &str) -> Result<Vec<Token>, Refused> {
    let mut tokens = Vec::new();
    for (line, source) in text.lines().enumerate() {
        let characters: Vec<char> = source.chars().collect();
        let mut at = 0;
        while at < characters.len() {
            let start = at;
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
            match characters[at] {
                '!' => break,
                ' ' | '\t' => {
                    at += 1;
                    continue;
                }
                ':' if characters.get(at + 1) == Some(&'=') => at += 2,
                '[' | ']' | ',' | ';' | '(' | ')' | '\\' | '-' => at += 1,
                c if is_word(c) => {
                    while at < characters.len()
                        && (is_word(characters[at])
                            || (matches!(characters[at], '+' | '-')
                                && characters[start].is_ascii_digit()
                                && matches!(characters[at - 1], 'E' | 'e')))
                    {
                        at += 1;
                    }
                }
                c => {
                    let reason = format!("the character {c:?} has no place here");
                    return Err(Refused { line: line + 1, column: start + 1, reason });
                }
            }
            tokens.push(Token { text: characters[start..at].iter().collect(), line: line + 1, column: start + 1 });
        }
    }
    let end = text.lines().count() + 1;
    tokens.push(Token { text: String::new(), line: end, column: 1 });
    Ok(tokens)
}

enum Named {
    Target([f64; 6]),
    Speed,
    Zone,
    Other,
}

struct Reader {
    tokens: Vec<Token>,
    next: usize,
    /// In lower case: RAPID does not tell cases apart.
    names: HashMap<String, Named>,
    main: Option<Vec<Move>>,
}

impl Reader {
    fn here(&self) -> &Token {
        &self.tokens[self.next]
    }

    fn refuse<T>(&self, token: &Token, reason: impl Into<String>) -> Result<T, Refused> {
        Err(Refused { line: token.line, column: token.column, reason: reason.into() })
    }

    fn take(&mut self) -> Token {
        let token = self.here().clone();
        self.next = (self.next + 1).min(self.tokens.len() - 1);
        token
    }

    fn is(&self, word: &str) -> bool {
        self.here().text.eq_ignore_ascii_case(word)
    }

    fn expect(&mut self, word: &str) -> Result<(), Refused> {
        if self.is(word) {
            self.take();
            return Ok(());
        }
        self.refuse(self.here(), format!("expected {word}, found '{}'", self.here().text))
    }

    fn name(&mut self) -> Result<Token, Refused> {
        let token = self.take();
        if !token.text.starts_with(|c: char| c.is_ascii_alphabetic()) || token.text.contains('.') {
            return self.refuse(&token, format!("'{}' is no name", token.text));
        }
        if token.text.len() > LONGEST_NAME {
            return self.refuse(&token, format!("the name '{}' has more than {LONGEST_NAME} characters", token.text));
        }
        Ok(token)
    }

    fn declare(&mut self, name: &Token, named: Named) -> Result<(), Refused> {
        match self.names.insert(name.text.to_ascii_lowercase(), named) {
            None => Ok(()),
            Some(_) => self.refuse(name, format!("the name '{}' is taken", name.text)),
        }
    }

    fn module(&mut self) -> Result<Module, Refused> {
        self.expect("MODULE")?;
        let name = self.name()?;
        self.declare(&name, Named::Other)?;
        while !self.is("ENDMODULE") {
            if self.is("CONST") { self.constant()? } else { self.procedure()? }
        }
        self.expect("ENDMODULE")?;
        self.expect("")?;
        match self.main.take() {
            Some(moves) => Ok(Module { name: name.text, moves }),
            None => self.refuse(self.here(), "there is no PROC main()"),
        }
    }

    fn constant(&mut self) -> Result<(), Refused> {
        self.expect("CONST")?;
        let kind = self.take();
        let name = self.name()?;
        self.expect(":=")?;
        self.expect("[")?;
        let named = match kind.text.to_ascii_lowercase().as_str() {
            "jointtarget" => {
                let angles = self.list()?;
                self.expect(",")?;
                self.list::<6>()?;
                self.expect("]")?;
                Named::Target(angles)
            }
            "speeddata" => {
                self.numbers::<4>()?;
                Named::Speed
            }
            "zonedata" => {
                if self.is("TRUE") {
                    self.take();
                } else {
                    self.expect("FALSE")?;
                }
                self.expect(",")?;
                self.numbers::<6>()?;
                Named::Zone
            }
            _ => return self.refuse(&kind, format!("the type '{}' is not read", kind.text)),
        };
        self.expect(";")?;
        self.declare(&name, named)
    }

    fn list<const N: usize>(&mut self) -> Result<[f64; N], Refused> {
        self.expect("[")?;
        self.numbers()
    }

    /// This many numbers, and the bracket that ends them.
    fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Refused> {
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            if i > 0 {
                self.expect(",")?;
            }
            *number = self.number()?;
        }
        self.expect("]")?;
        Ok(numbers)
    }

    fn number(&mut self) -> Result<f64, Refused> {
        let sign = if self.is("-") { -1.0 } else { 1.0 };
        if sign < 0.0 {
            self.take();
        }
        let token = self.take();
        match token.text.parse::<f64>() {
            Ok(number) if number.is_finite() && token.text.starts_with(|c: char| c.is_ascii_digit()) => {
                Ok(sign * number)
            }
            _ => self.refuse(&token, format!("'{}' is not a number", token.text)),
        }
    }

    fn procedure(&mut self) -> Result<(), Refused> {
        self.expect("PROC")?;
        let name = self.name()?;
        self.declare(&name, Named::Other)?;
        self.expect("(")?;
        self.expect(")")?;
        let mut moves = Vec::new();
        while !self.is("ENDPROC") {
            moves.push(self.movement()?);
        }
        self.expect("ENDPROC")?;
        if name.text.eq_ignore_ascii_case("main") {
            self.main = Some(moves);
        }
        Ok(())
    }

    fn movement(&mut self) -> Result<Move, Refused> {
        self.expect("MoveAbsJ")?;
        let target = self.name()?;
        let Some(&Named::Target(angles)) = self.names.get(&target.text.to_ascii_lowercase()) else {
            return self.refuse(&target, format!("'{}' is no jointtarget", target.text));
        };
        self.expect(",")?;
        let speed = self.name()?;
        let declared = matches!(self.names.get(&speed.text.to_ascii_lowercase()), Some(Named::Speed));
        if !declared && !SPEEDS.contains(&speed.text.to_ascii_lowercase().as_str()) {
            return self.refuse(&speed, format!("'{}' is no speeddata", speed.text));
        }
        let mut time = None;
        if self.is("\\") {
            self.take();
            self.expect("T")?;
            self.expect(":=")?;
            let place = self.here().clone();
            let seconds = self.number()?;
            if seconds <= 0.0 {
                return self.refuse(&place, "a move takes a time that is positive");
            }
            time = Some(seconds);
        }
        self.expect(",")?;
        let zone = self.name()?;
        let declared = matches!(self.names.get(&zone.text.to_ascii_lowercase()), Some(Named::Zone));
        if !declared && !ZONES.contains(&zone.text.to_ascii_lowercase().as_str()) {
            return self.refuse(&zone, format!("'{}' is no zonedata", zone.text));
        }
        self.expect(",")?;
        self.expect("tool0")?;
        self.expect(";")?;
        Ok(Move { angles, time })
    }
}
