//! Doc comments as LaTeX.

/// The text of a doc comment, whose empty lines begin paragraphs.
pub(super) fn paragraphs(docs: &[String]) -> String {
    let lines: Vec<String> = docs.iter().flat_map(|doc| doc.lines()).map(|line| marked(line.trim())).collect();
    lines.join("\n").trim().to_string()
}

/// A line with its `*emphasis*` and `` `code` ``, where that ends on the line on which it begins.
fn marked(line: &str) -> String {
    let mut marked = String::new();
    let mut rest = line;
    while let Some(start) = rest.find(['*', '`']) {
        let (before, from) = rest.split_at(start);
        let (mark, inside) = from.split_at(1);
        let begins = before.is_empty() || before.ends_with([' ', '(']);
        let end = inside.find(mark).filter(|&end| begins && end > 0 && !inside[..end].contains("  "));
        marked.push_str(&escaped(before));
        rest = match end {
            Some(end) => {
                let command = if mark == "*" { "emph" } else { "texttt" };
                marked.push_str(&format!("\\{command}{{{}}}", escaped(&inside[..end])));
                &inside[end + 1..]
            }
            None => {
                marked.push_str(mark);
                inside
            }
        };
    }
    marked + &escaped(rest)
}

/// A text whose characters mean themselves. Letters that pdflatex does not know become commands; what it has no command
/// for is given by its number.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let mut letter = command(c);
        while let Some(accent) = rest.peek().and_then(|next| accent(*next)) {
            rest.next();
            letter = format!("\\ensuremath{{{accent}{{{letter}}}}}");
        }
        escaped += &letter;
    }
    escaped
}

/// Combining characters stand behind their letter.
fn accent(c: char) -> Option<&'static str> {
    let accents = [
        ('\u{307}', "\\dot"),
        ('\u{308}', "\\ddot"),
        ('\u{302}', "\\hat"),
        ('\u{304}', "\\bar"),
        ('\u{303}', "\\tilde"),
    ];
    accents.into_iter().find(|(own, _)| *own == c).map(|(_, command)| command)
}

fn command(c: char) -> String {
    const GREEK: &str = "α alpha β beta γ gamma δ delta ε varepsilon ζ zeta η eta θ theta ι iota κ kappa λ lambda μ mu ν nu ξ xi \
                         π pi ρ rho σ sigma τ tau υ upsilon φ varphi χ chi ψ psi ω omega Γ Gamma Δ Delta Θ Theta Λ Lambda \
                         Ξ Xi Π Pi Σ Sigma Φ Phi Ψ Psi Ω Omega µ mu ϕ phi ϑ vartheta";
    const SYMBOLS: &str = "∂ partial √ surd × times · cdot − - ± pm ≤ leq ≥ geq ≠ neq ≈ approx → rightarrow ∞ infty ∇ nabla ∫ int \
                           ° ^\\circ ⊥ perp ∈ in ½ frac12 ² ^2 ³ ^3 ¹ ^1 ⁰ ^0 ⁴ ^4 ⁵ ^5 ⁶ ^6 ⁻ ^- ᵀ ^\\mathsf{T} ₀ _0 ₁ _1 ₂ _2 ₃ _3 \
                           ₄ _4 ₅ _5 ₆ _6 ₙ _n ᵢ _i ⱼ _j ẋ dot{x} ẏ dot{y} ż dot{z} ′ prime ″ prime\\prime";
    let listed = |list: &str| -> Option<String> {
        let words: Vec<&str> = list.split_whitespace().collect();
        let own = words.chunks(2).find(|pair| pair[0].chars().eq([c]))?;
        let word = own[1];
        let is_command = word.starts_with(|c: char| c.is_ascii_alphabetic());
        Some(format!("\\ensuremath{{{}{word}}}", if is_command { "\\" } else { "" }))
    };
    match c {
        '%' | '&' | '#' | '_' | '$' | '{' | '}' => format!("\\{c}"),
        '\\' => "\\textbackslash{}".to_string(),
        '~' => "\\textasciitilde{}".to_string(),
        '^' => "\\textasciicircum{}".to_string(),
        '<' | '>' | '|' => format!("\\ensuremath{{{c}}}"),
        '*' | '`' | ' '..='~' => c.to_string(),
        '–' => "--".to_string(),
        '—' => "---".to_string(),
        '…' => "\\dots{}".to_string(),
        '“' | '”' | '„' => "\"".to_string(),
        '‘' | '’' => "'".to_string(),
        // Latin letters with accents.
        'À'..='ſ' if c != '×' && c != '÷' => c.to_string(),
        _ => listed(GREEK).or_else(|| listed(SYMBOLS)).unwrap_or_else(|| format!("(U+{:04X})", u32::from(c))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_mean_themselves() {
        assert_eq!(escaped("50 % of m_1 & #2 {x} $"), r"50 \% of m\_1 \& \#2 \{x\} \$");
        assert_eq!(escaped(r"a\b ~ 2^3"), r"a\textbackslash{}b \textasciitilde{} 2\textasciicircum{}3");
        assert_eq!(
            escaped("θ̇ = ω, q̈ m/s² – Störmer"),
            "\\ensuremath{\\dot{\\ensuremath{\\theta}}} = \\ensuremath{\\omega}, \
                    \\ensuremath{\\ddot{q}} m/s\\ensuremath{^2} -- Störmer"
        );
        assert_eq!(escaped("漢"), "(U+6F22)");
        assert_eq!(marked("(*A book*, `R_z`) 2*3 and *4"), r"(\emph{A book}, \texttt{R\_z}) 2*3 and *4");
    }
}
