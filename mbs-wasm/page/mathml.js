// The LaTeX that mbs writes → HTML with MathML, as text. It knows the commands that occur there and no others: a text
// of any other origin may hold one that it throws at.

const GREEK = "alpha α beta β gamma γ delta δ epsilon ϵ varepsilon ε zeta ζ eta η theta θ vartheta ϑ iota ι kappa κ lambda λ mu μ nu ν xi ξ pi π rho ρ sigma σ tau τ upsilon υ phi ϕ varphi φ chi χ psi ψ omega ω Gamma Γ Delta Δ Theta Θ Lambda Λ Xi Ξ Pi Π Sigma Σ Upsilon Υ Phi Φ Psi Ψ Omega Ω partial ∂";
const OPERATORS = "cdot · times × pm ± le ≤ ge ≥ lor ∨ land ∧ dots … circ ∘ lnot ¬";
const FUNCTIONS = "sin cos tan arcsin arccos arctan sinh cosh tanh exp ln sec max min";
const ACCENTS = { dot: ".", ddot: "..", hat: "^", bar: "¯", tilde: "~" };
const STYLES = { mathbf: "bold", boldsymbol: "bold-italic", mathrm: "normal", mathsf: "normal", operatorname: "normal" };
const table = (words) => Object.fromEntries(words.split(" ").reduce((pairs, word, i, all) => (i % 2 ? pairs : [...pairs, [word, all[i + 1]]]), []));
const [greek, operators, functions] = [table(GREEK), table(OPERATORS), new Set(FUNCTIONS.split(" "))];

export function escape(text) {
  return text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
}

/** A formula without its dollars. */
export function formula(latex, display = false) {
  const reader = new Reader(latex);
  const body = reader.row(() => reader.done);
  return `<math${display ? ' display="block"' : ""}><mrow>${body}</mrow></math>`;
}

/** Reads tokens: commands, numbers, single characters. */
class Reader {
  constructor(latex) {
    this.tokens = latex.match(/\\[a-zA-Z]+\*?|\\.|\d+(?:\.\d+)?|[^\s]/g) ?? [];
    this.next = 0;
  }

  get done() {
    return this.next >= this.tokens.length;
  }

  peek() {
    return this.tokens[this.next];
  }

  take(expected = undefined) {
    const token = this.tokens[this.next++];
    if (token === undefined || (expected !== undefined && token !== expected)) {
      throw new Error(`LaTeX: ${expected ?? "more"} was expected, found ${token ?? "the end"}`);
    }
    return token;
  }

  /** Atoms until the end, one behind the other. */
  row(ends) {
    let text = "";
    while (!ends()) text += this.scripted();
    return text;
  }

  /** An atom with what stands above and below it. */
  scripted() {
    return this.scripts(this.atom());
  }

  scripts(base) {
    let [sub, sup] = [null, null];
    for (;;) {
      if (this.peek() === "_" && sub === null) sub = (this.take(), this.argument());
      else if (this.peek() === "^" && sup === null) sup = (this.take(), this.argument());
      else break;
    }
    if (sub !== null && sup !== null) return `<msubsup>${base}${sub}${sup}</msubsup>`;
    if (sub !== null) return `<msub>${base}${sub}</msub>`;
    return sup !== null ? `<msup>${base}${sup}</msup>` : base;
  }

  /** A group in braces, or one atom. */
  argument(style = undefined) {
    if (this.peek() !== "{") return this.atom(style);
    this.take("{");
    const text = style === undefined ? this.row(() => this.peek() === "}") : this.styled(style);
    this.take("}");
    return `<mrow>${text}</mrow>`;
  }

  /** Letters of one word in one style; scripts inside keep theirs. */
  styled(style) {
    let text = "";
    while (this.peek() !== "}") {
      let word = "";
      while (/^[a-zA-Z0-9]+$/.test(this.peek())) word += this.take();
      text += word === "" ? this.scripted() : this.scripts(identifier(word, style));
    }
    return text;
  }

  atom(style = undefined) {
    const token = this.take();
    if (token === "{" || token === "_" || token === "^") {
      this.next -= 1;
      return token === "{" ? this.argument() : "<mrow></mrow>";
    }
    if (/^\d/.test(token)) return `<mn>${token}</mn>`;
    if (/^[a-zA-Z]$/.test(token)) return identifier(token, style ?? "italic");
    if (token === "-") return this.minus();
    if (!token.startsWith("\\")) return operator(token);
    const name = token.slice(1);
    if (name in greek) return identifier(greek[name], style ?? "italic");
    if (name in operators) return operator(operators[name]);
    if (functions.has(name)) return this.called(name);
    if (name in STYLES) return this.argument(STYLES[name]);
    if (name in ACCENTS) return `<mover>${this.argument()}<mo stretchy="false" class="accent">${ACCENTS[name]}</mo></mover>`;
    return this.special(name);
  }

  /** A function's name, with a little room to both sides. */
  called(name) {
    const room = '<mspace width="0.14em"></mspace>';
    const isBracketed = ["(", "\\left", "\\bigl", "^"].includes(this.peek());
    return this.scripts(`<mrow>${room}<mi>${name}</mi></mrow>`) + (isBracketed ? "" : room);
  }

  /** A sign where nothing stands before it, an operation elsewhere. */
  minus() {
    const before = this.tokens[this.next - 2];
    const isSign = before === undefined || ["=", "(", "[", "{", "&", "\\\\", ",", "<", "\\le"].includes(before);
    return isSign ? '<mo form="prefix">−</mo>' : '<mo form="infix">−</mo>';
  }

  /** `\frac12` is a half. */
  separateDigits() {
    const token = this.peek();
    if (/^\d\d+$/.test(token)) this.tokens.splice(this.next, 1, ...token);
  }

  special(name) {
    switch (name) {
      case "frac": {
        this.separateDigits();
        const above = this.argument();
        return `<mfrac>${above}${this.argument()}</mfrac>`;
      }
      case "sqrt":
        return `<msqrt>${this.argument()}</msqrt>`;
      case "text":
        return `<mtext>${escape(this.words())}</mtext>`;
      case "left": {
        const open = fence(this.take(), "prefix", true);
        const inside = this.row(() => this.peek() === "\\right");
        this.take("\\right");
        return `<mrow>${open}${inside}${fence(this.take(), "postfix", true)}</mrow>`;
      }
      case "bigl":
        return fence(this.take(), "prefix", false);
      case "bigr":
        return fence(this.take(), "postfix", false);
      case "begin":
        return this.environment();
      case ",":
        return '<mspace width="0.17em"></mspace>';
      case "quad":
        return '<mspace width="1em"></mspace>';
      case "displaystyle":
        return "";
      case "ensuremath":
        return this.argument();
      case "{":
      case "}":
      case "_":
      case "&":
      case "%":
        return operator(name);
      default:
        throw new Error(`LaTeX: \\${name} is not known`);
    }
  }

  /** The words in braces; blanks were lost, which the few words that occur do not mind. */
  words() {
    this.take("{");
    let text = "";
    while (this.peek() !== "}") text += this.take();
    this.take("}");
    return ` ${text.replace(/^if$/, "if")} `;
  }

  environment() {
    this.take("{");
    let name = "";
    while (this.peek() !== "}") name += this.take();
    this.take("}");
    const rows = [];
    let cells = [];
    const ends = () => ["&", "\\\\", "\\end"].includes(this.peek());
    for (;;) {
      cells.push(this.row(ends));
      const end = this.take();
      if (end === "&") continue;
      rows.push(cells);
      cells = [];
      if (end === "\\end") break;
    }
    while (this.take() !== "}");
    const lines = rows.map((row) => `<mtr>${row.map((cell) => `<mtd>${cell}</mtd>`).join("")}</mtr>`).join("");
    const [open, close, kind] = { bmatrix: ["[", "]", "matrix"], cases: ["{", "", "cases"] }[name] ?? ["", "", name];
    const [before, after] = [fence(open, "prefix", true), fence(close, "postfix", true)];
    return `<mrow>${before}<mtable class="${kind}">${lines}</mtable>${after}</mrow>`;
  }
}

function operator(sign) {
  if ("([".includes(sign)) return fence(sign, "prefix", false);
  if (")]".includes(sign)) return fence(sign, "postfix", false);
  return sign === "/" ? '<mo lspace="0" rspace="0">/</mo>' : `<mo>${escape(sign)}</mo>`;
}

function fence(sign, form, stretchy) {
  if (sign === "" || sign === ".") return "";
  return `<mo form="${form}" fence="true" stretchy="${stretchy}">${escape(sign)}</mo>`;
}

/** Letters in a style that MathML Core keeps: italics by themselves, bold by mathematical letters. */
function identifier(word, style) {
  if (style === "normal") return `<mi mathvariant="normal">${word}</mi>`;
  if (!style.startsWith("bold")) return `<mi>${word}</mi>`;
  return `<mi mathvariant="normal" class="bold">${word}</mi>`;
}

/** Lines of an `align*`: what stands before the first `&` to the right, the rest to the left. */
function aligned(body) {
  const lines = split(body, "\\\\").map((line) => {
    const [left, ...right] = split(line, "&");
    return `<tr><td>${formula(left)}</td><td>${formula(right.join(" "))}</td></tr>`;
  });
  return `<table class="align">${lines.join("")}</table>`;
}

/** Parts between separators that stand outside of braces and environments. */
function split(latex, separator) {
  const parts = [""];
  let depth = 0;
  for (const token of latex.match(/\\begin|\\end|\\[a-zA-Z]+|\\.|[^\\]/gs) ?? []) {
    if (token === "{" || token === "\\begin") depth += 1;
    if (token === "}" || token === "\\end") depth -= 1;
    if (token === separator && depth === 0) parts.push("");
    else parts[parts.length - 1] += token;
  }
  return parts;
}

/** Prose with formulas in dollars, or in `\ensuremath`. */
function prose(text) {
  const group = String.raw`\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}`;
  const spans = text.split(new RegExp(String.raw`(\$[^$]*\$|\\(?:ensuremath|texttt|emph)${group})`));
  const html = spans.map((part) => {
    const command = /^\\(ensuremath|texttt|emph)\{/.exec(part);
    if (part.startsWith("$")) return formula(part.slice(1, -1));
    if (command === null) return words(part);
    const inside = part.slice(command[0].length, -1);
    if (command[1] === "ensuremath") return formula(inside);
    return command[1] === "emph" ? `<em>${prose(inside)}</em>` : `<code>${prose(inside)}</code>`;
  });
  return html.join("");
}

function words(text) {
  const html = escape(text).replace(/\\dots/g, "…").replace(/\\(&amp;|[_&%#{}])/g, "$1");
  return html.replace(/~/g, " ").replace(/---?/g, (dash) => (dash.length > 2 ? "—" : "–"));
}

/** The document as HTML. */
export function page(latex) {
  let rest = latex.slice(latex.indexOf("\\begin{document}") + "\\begin{document}".length, latex.indexOf("\\end{document}"));
  rest = rest.replace(/\{\\allowdisplaybreaks\s*/g, "").replace(/\\end\{align\*\}\}/g, "\\end{align*}");
  let html = "";
  const blocks = /\\begin\{align\*\}([\s\S]*?)\\end\{align\*\}|\\begin\{small\}\s*\\begin\{tabular\}\{[^\n]*\}\n([\s\S]*?)\\end\{tabular\}\s*\\end\{small\}/g;
  let start = 0;
  for (const block of rest.matchAll(blocks)) {
    html += paragraphs(rest.slice(start, block.index));
    html += block[1] !== undefined ? aligned(block[1]) : symbols(block[2]);
    start = block.index + block[0].length;
  }
  return html + paragraphs(rest.slice(start));
}

function symbols(body) {
  const rows = body.split("\\\\").map((row) => row.replace("\\hline", "").trim()).filter((row) => row !== "");
  const cells = (row) => row.split(/(?<!\\)&/).map((cell) => prose(cell.trim()));
  const line = (row, tag) => `<tr>${cells(row).map((cell) => `<${tag}>${cell}</${tag}>`).join("")}</tr>`;
  return `<table class="symbols">${rows.map((row, i) => line(row, i === 0 ? "th" : "td")).join("")}</table>`;
}

function paragraphs(text) {
  const parts = text.split(/\n\s*\n/).map((part) => part.trim()).filter((part) => part !== "");
  return parts.map(paragraph).join("");
}

/** Headings are in braces that hold others. */
function paragraph(part) {
  const heading = /^\\(section\*|paragraph)\{/.exec(part);
  if (heading === null) return `<p>${prose(part)}</p>`;
  let [depth, end] = [1, heading[0].length];
  for (; depth > 0 && end < part.length; end++) {
    if (part[end] === "\\") end += 1;
    else if (part[end] === "{") depth += 1;
    else if (part[end] === "}") depth -= 1;
  }
  const title = prose(part.slice(heading[0].length, end - 1));
  const rest = part.slice(end).trim();
  const tag = heading[1] === "section*" ? "h2" : "h3";
  return `<${tag}>${title}</${tag}>${rest === "" ? "" : `<p>${prose(rest)}</p>`}`;
}
