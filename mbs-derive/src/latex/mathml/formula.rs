//! One formula of LaTeX → MathML Core.

use super::escaped;

/// Groups inside groups; the page breaks what would be deeper, since it does not fit on a line.
const DEEPEST: usize = 64;

const LETTERS: &str = "alpha α beta β gamma γ delta δ epsilon ϵ varepsilon ε zeta ζ eta η theta θ vartheta ϑ iota ι kappa κ \
                       lambda λ mu μ nu ν xi ξ pi π rho ρ sigma σ tau τ upsilon υ phi ϕ varphi φ chi χ psi ψ omega ω \
                       Gamma Γ Delta Δ Theta Θ Lambda Λ Xi Ξ Pi Π Sigma Σ Upsilon Υ Phi Φ Psi Ψ Omega Ω partial ∂ \
                       infty ∞ nabla ∇";
const OPERATORS: &str = "cdot · times × pm ± le ≤ leq ≤ ge ≥ geq ≥ neq ≠ approx ≈ rightarrow → int ∫ perp ⊥ in ∈ surd √ lor ∨ \
                         land ∧ dots … circ ∘ lnot ¬ prime ′";
const FUNCTIONS: &str = "sin cos tan arcsin arccos arctan sinh cosh tanh exp ln sec max min";
const ACCENTS: &str = "dot . ddot .. hat ^ bar ¯ tilde ~";
const STYLES: &str = "mathbf bold boldsymbol bold-italic mathrm normal mathsf normal operatorname normal";

/// The word behind a word in a list of pairs.
fn behind(list: &'static str, word: &str) -> Option<&'static str> {
    let mut words = list.split_whitespace();
    while let (Some(name), Some(value)) = (words.next(), words.next()) {
        if name == word {
            return Some(value);
        }
    }
    None
}

/// A formula without its dollars.
pub(super) fn formula(latex: &str) -> String {
    let mut reader = Reader { tokens: tokens(latex), next: 0, depth: 0 };
    match reader.row(&[]) {
        Some(body) => format!("<math><mrow>{body}</mrow></math>"),
        None => format!("<code>{}</code>", escaped(latex.trim())),
    }
}

/// Commands, numbers, single characters.
fn tokens(latex: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = latex.trim_start();
    while let Some(first) = rest.chars().next() {
        let of = |text: &str, inside: fn(&char) -> bool| text.chars().take_while(inside).map(char::len_utf8).sum();
        let length = match first {
            '\\' => {
                let name: usize = of(&rest[1..], char::is_ascii_alphabetic);
                1 + if name == 0 { rest[1..].chars().next().map_or(0, char::len_utf8) } else { name }
            }
            '0'..='9' => {
                let whole: usize = of(rest, char::is_ascii_digit);
                let fraction: usize = rest[whole..].strip_prefix('.').map_or(0, |rest| of(rest, char::is_ascii_digit));
                if fraction == 0 { whole } else { whole + 1 + fraction }
            }
            first => first.len_utf8(),
        };
        tokens.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    tokens
}

/// Reads tokens; `None` where something else stands than what the page writes.
struct Reader<'a> {
    tokens: Vec<&'a str>,
    next: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.tokens.get(self.next).copied()
    }

    fn take(&mut self) -> Option<&'a str> {
        self.next += 1;
        self.tokens.get(self.next - 1).copied()
    }

    fn expect(&mut self, token: &str) -> Option<()> {
        (self.take()? == token).then_some(())
    }

    /// Atoms until one of these stands there; until the end of the formula, where there are none.
    fn row(&mut self, ends: &[&str]) -> Option<String> {
        let mut text = String::new();
        loop {
            match self.peek() {
                None if ends.is_empty() => return Some(text),
                None => return None,
                Some(token) if ends.contains(&token) => return Some(text),
                Some(_) => text += &self.scripted()?,
            }
        }
    }

    /// An atom with what stands above and below it.
    fn scripted(&mut self) -> Option<String> {
        if self.depth == DEEPEST {
            return None;
        }
        self.depth += 1;
        let atom = self.atom("italic")?;
        let scripted = self.scripts(atom);
        self.depth -= 1;
        scripted
    }

    fn scripts(&mut self, base: String) -> Option<String> {
        let [mut sub, mut sup] = [None, None];
        loop {
            match self.peek() {
                Some("_") if sub.is_none() => {
                    self.next += 1;
                    sub = Some(self.argument("italic")?);
                }
                Some("^") if sup.is_none() => {
                    self.next += 1;
                    sup = Some(self.argument("italic")?);
                }
                _ => break,
            }
        }
        Some(match (sub, sup) {
            (Some(sub), Some(sup)) => format!("<msubsup>{base}{sub}{sup}</msubsup>"),
            (Some(sub), None) => format!("<msub>{base}{sub}</msub>"),
            (None, Some(sup)) => format!("<msup>{base}{sup}</msup>"),
            (None, None) => base,
        })
    }

    /// A group in braces, or one atom.
    fn argument(&mut self, style: &str) -> Option<String> {
        if self.peek() != Some("{") {
            return self.atom(style);
        }
        self.next += 1;
        let text = if style == "italic" { self.row(&["}"])? } else { self.styled(style)? };
        self.expect("}")?;
        Some(format!("<mrow>{text}</mrow>"))
    }

    /// Letters of one word in one style; what else is inside keeps its own.
    fn styled(&mut self, style: &str) -> Option<String> {
        let mut text = String::new();
        while self.peek()? != "}" {
            let mut word = String::new();
            while self.peek()?.chars().all(|c| c.is_alphanumeric()) {
                word += self.take()?;
            }
            text += &if word.is_empty() { self.scripted()? } else { self.scripts(identifier(&word, style))? };
        }
        Some(text)
    }

    fn atom(&mut self, style: &str) -> Option<String> {
        let token = self.take()?;
        if matches!(token, "{" | "_" | "^") {
            self.next -= 1;
            return if token == "{" { self.argument("italic") } else { Some("<mrow></mrow>".to_string()) };
        }
        let Some(name) = token.strip_prefix('\\') else {
            let first = token.chars().next()?;
            return Some(match first {
                '0'..='9' => format!("<mn>{token}</mn>"),
                '-' => self.minus(),
                '}' | '&' | '$' => return None,
                first if first.is_alphabetic() => identifier(token, style),
                _ => operator(token),
            });
        };
        if let Some(letter) = behind(LETTERS, name) {
            return Some(identifier(letter, style));
        }
        if let Some(sign) = behind(OPERATORS, name) {
            return Some(operator(sign));
        }
        if FUNCTIONS.split(' ').any(|function| function == name) {
            return self.called(name);
        }
        if let Some(style) = behind(STYLES, name) {
            return self.argument(style);
        }
        if let Some(accent) = behind(ACCENTS, name) {
            let base = self.argument("italic")?;
            return Some(format!("<mover>{base}<mo stretchy=\"false\" class=\"accent\">{accent}</mo></mover>"));
        }
        self.special(name)
    }

    /// A function's name, with a little room to both sides.
    fn called(&mut self, name: &str) -> Option<String> {
        const ROOM: &str = "<mspace width=\"0.14em\"></mspace>";
        let is_bracketed = matches!(self.peek(), Some("(" | "\\left" | "\\bigl" | "^"));
        let function = self.scripts(format!("<mrow>{ROOM}<mi>{name}</mi></mrow>"))?;
        Some(function + if is_bracketed { "" } else { ROOM })
    }

    /// A sign where nothing stands before it, an operation elsewhere.
    fn minus(&self) -> String {
        let before = self.next.checked_sub(2).and_then(|before| self.tokens.get(before));
        let is_sign = matches!(before, None | Some(&("=" | "(" | "[" | "{" | "&" | "\\\\" | "," | "<" | "\\le")));
        format!("<mo form=\"{}\">−</mo>", if is_sign { "prefix" } else { "infix" })
    }

    fn special(&mut self, name: &str) -> Option<String> {
        Some(match name {
            "frac" => {
                // `\frac12` is a half.
                if let Some(digits) = self.peek().filter(|digits| digits.len() == 2 && digits.parse::<u8>().is_ok()) {
                    let (above, below) = digits.split_at(1);
                    self.tokens.splice(self.next..=self.next, [above, below]);
                }
                let above = self.argument("italic")?;
                format!("<mfrac>{above}{}</mfrac>", self.argument("italic")?)
            }
            "sqrt" => format!("<msqrt>{}</msqrt>", self.argument("italic")?),
            "text" => {
                self.expect("{")?;
                let mut text = Vec::new();
                while self.peek()? != "}" {
                    text.push(self.take()?);
                }
                self.next += 1;
                format!("<mtext>\u{a0}{}\u{a0}</mtext>", escaped(&spelled(&text)))
            }
            "left" => {
                let open = fence(self.take()?, "prefix", true);
                let inside = self.row(&["\\right"])?;
                self.next += 1;
                format!("<mrow>{open}{inside}{}</mrow>", fence(self.take()?, "postfix", true))
            }
            "bigl" => fence(self.take()?, "prefix", false),
            "bigr" => fence(self.take()?, "postfix", false),
            "begin" => self.environment()?,
            "," => "<mspace width=\"0.17em\"></mspace>".to_string(),
            "quad" => "<mspace width=\"1em\"></mspace>".to_string(),
            "displaystyle" => String::new(),
            "ensuremath" => self.argument("italic")?,
            "{" | "}" | "_" | "&" | "%" | "#" | "$" => operator(name),
            _ => return None,
        })
    }

    fn environment(&mut self) -> Option<String> {
        let name = self.braced_word()?;
        let mut rows = Vec::new();
        let mut cells = String::new();
        loop {
            cells += &format!("<mtd>{}</mtd>", self.row(&["&", "\\\\", "\\end"])?);
            let end = self.take()?;
            if end != "&" {
                rows.push(format!("<mtr>{}</mtr>", std::mem::take(&mut cells)));
            }
            if end == "\\end" {
                break;
            }
        }
        self.braced_word()?;
        let (open, close, kind) = match name.as_str() {
            "bmatrix" => ("[", "]", "matrix"),
            "cases" => ("\\{", "", "cases"),
            _ => return None,
        };
        let (before, after) = (fence(open, "prefix", true), fence(close, "postfix", true));
        Some(format!("<mrow>{before}<mtable class=\"{kind}\">{}</mtable>{after}</mrow>", rows.concat()))
    }

    fn braced_word(&mut self) -> Option<String> {
        self.expect("{")?;
        let mut word = String::new();
        loop {
            match self.take()? {
                "}" => return Some(word),
                token => word += token,
            }
        }
    }
}

/// The few words of `\text`, whose blanks the tokens have lost: `if`, `otherwise`, `(see below)`.
fn spelled(letters: &[&str]) -> String {
    letters.concat().replace("seebelow", "see below").replace("elseif", "else if")
}

fn operator(sign: &str) -> String {
    match sign {
        "(" | "[" => fence(sign, "prefix", false),
        ")" | "]" => fence(sign, "postfix", false),
        "/" => "<mo lspace=\"0\" rspace=\"0\">/</mo>".to_string(),
        sign => format!("<mo>{}</mo>", escaped(sign)),
    }
}

fn fence(sign: &str, form: &str, stretchy: bool) -> String {
    match sign.trim_start_matches('\\') {
        "" | "." => String::new(),
        sign => format!("<mo form=\"{form}\" fence=\"true\" stretchy=\"{stretchy}\">{}</mo>", escaped(sign)),
    }
}

/// Letters in a style that MathML Core keeps: italics by themselves, bold by a class.
fn identifier(word: &str, style: &str) -> String {
    match style {
        "italic" => format!("<mi>{word}</mi>"),
        "normal" => format!("<mi mathvariant=\"normal\">{word}</mi>"),
        _ => format!("<mi mathvariant=\"normal\" class=\"bold\">{word}</mi>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(latex: &str) -> String {
        let all = formula(latex);
        let inside = all.strip_prefix("<math><mrow>").and_then(|rest| rest.strip_suffix("</mrow></math>"));
        inside.map_or_else(|| format!("not read: {all}"), str::to_string)
    }

    #[test]
    fn what_the_page_writes_is_read() {
        assert_eq!(of("q_1^2"), "<msubsup><mi>q</mi><mn>1</mn><mn>2</mn></msubsup>");
        assert_eq!(of("\\frac12"), "<mfrac><mn>1</mn><mn>2</mn></mfrac>");
        assert_eq!(of("9.81"), "<mn>9.81</mn>");
        assert_eq!(of("-x - 1"), "<mo form=\"prefix\">−</mo><mi>x</mi><mo form=\"infix\">−</mo><mn>1</mn>");
        assert!(of("\\sin \\theta").contains("<mi>sin</mi>"));
        assert!(of("\\ddot{\\mathrm{x}}").starts_with("<mover><mrow><mrow><mi mathvariant=\"normal\">x</mi>"));
        let matrix = of("\\begin{bmatrix}\n a & b \\\\\n c & d\n\\end{bmatrix}");
        assert_eq!(matrix.matches("<mtd>").count(), 4, "{matrix}");
        assert_eq!(matrix.matches("<mtr>").count(), 2, "{matrix}");
        assert!(of("a \\text{(see below)}").contains("(see below)"));
        assert!(of("\\left\\{x\\right.").contains(">{</mo>"));
        assert!(of("x < 1").contains("<mo>&lt;</mo>"));
    }

    #[test]
    fn anything_else_stays_as_it_was_written() {
        for latex in
            ["\\unknown{x}", "{x", "x}", "\\frac{1}", "\\begin{pmatrix}a\\end{pmatrix}", "\\left(x", "a & b", "\\"]
        {
            let html = formula(latex);
            assert_eq!(html, format!("<code>{}</code>", escaped(latex)), "{latex}");
        }
        let deep = "{".repeat(100_000) + "x" + &"}".repeat(100_000);
        assert!(formula(&deep).starts_with("<code>"));
    }
}
