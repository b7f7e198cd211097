//! Answers to what editors ask about a place in a file: hover, definitions, references, names to be written, outlines.

use std::collections::BTreeMap;
use std::ops::Range;

use lsp_types::{
    CompletionItem, CompletionItemKind, Documentation, Hover, HoverContents, InlayHint, InlayHintKind, InlayHintLabel,
    Location, MarkupContent, MarkupKind, Position, SymbolKind, TextEdit,
};
use mbs_derive::diagnostic::Diagnostic;
use mbs_derive::source::Sources;
use serde_json::{Value, json};

use super::documents::{Document, Documents};
use super::outline::{Kind, Role, Space, Symbol, Word};
use super::resolve::{Files, Place, importing, references};
use super::text::Text;
use super::words::{Known, known};

/// A file as it is now, and what is known of it.
pub(super) struct View<'v> {
    pub(super) files: &'v Files,
    /// What names stand for, by their places among all files.
    pub(super) meanings: &'v [(Range<usize>, String)],
    /// Additions and multiplications of the generated functions, as far as they were derived.
    pub(super) costs: &'v [(String, usize)],
    pub(super) documents: &'v Documents,
}

impl View<'_> {
    fn offset(&self, position: Position) -> usize {
        self.files.0[0].text.offset(position)
    }

    fn place(&self, position: Position) -> Option<(usize, Option<Place>)> {
        let word = self.files.0[0].outline.word_at(self.offset(position))?;
        Some((word, self.files.resolved(0, word)))
    }

    /// Of a robot's name the statement that imports the robot.
    fn location(&self, (file, symbol): Place) -> Option<Location> {
        if let Some(import) = self.files.import_of(file) {
            let main = &self.files.0[0];
            return Some(Location { uri: self.documents.uri(&main.name)?, range: main.text.range(&import) });
        }
        let found = &self.files.0[file];
        let range = found.text.range(&found.outline.symbols[symbol].span);
        Some(Location { uri: self.documents.uri(&found.name)?, range })
    }

    fn meaning(&self, (file, symbol): Place) -> Option<&str> {
        let file = &self.files.0[file];
        let start = file.start + file.outline.symbols[symbol].span.start;
        self.meanings.iter().find(|(place, _)| place.start == start).map(|(_, text)| text.as_str())
    }
}

// ---- places

impl View<'_> {
    pub(super) fn definition(&self, position: Position) -> Option<Location> {
        let offset = self.offset(position);
        let paths = &self.files.0[0].outline.paths;
        if let Some(path) = paths.iter().find(|path| path.start <= offset && offset <= path.end) {
            let written = self.files.text_of(0, path).trim_matches('"');
            let sources = self.documents.sources(&self.files.0[0].name)?;
            let file = sources.file(sources.imported(0, written)?);
            file.text.as_ref().ok()?;
            return Some(Location { uri: self.documents.uri(&file.name)?, range: lsp_types::Range::default() });
        }
        self.location(self.place(position)?.1?)
    }

    pub(super) fn references(&self, position: Position, with_declaration: bool) -> Option<Vec<Location>> {
        let place = self.place(position)?.1?;
        let declared = (self.files.0[place.0].name.clone(), self.files.symbol(place).span.clone());
        let mut locations = Vec::new();
        for (name, spans) in references(self.documents, self.files, place) {
            let Some(uri) = self.documents.uri(&name) else { continue };
            let Some(text) = self.text(&name) else { continue };
            let spans =
                spans.into_iter().filter(|span| with_declaration || (&name, span) != (&declared.0, &declared.1));
            locations.extend(spans.map(|span| Location { uri: uri.clone(), range: text.range(&span) }));
        }
        if with_declaration && self.files.import_of(place.0).is_some() {
            locations.extend(self.location(place));
        }
        Some(locations)
    }

    fn text(&self, name: &str) -> Option<Text> {
        if let Some(file) = self.files.0.iter().find(|file| file.name == name) {
            return Some(file.text.clone());
        }
        let sources = self.documents.sources(name)?;
        Some(Text::new(sources.main().text.clone().ok()?))
    }

    /// The name at a position, if it can have another.
    pub(super) fn renamable(&self, position: Position) -> Option<lsp_types::Range> {
        let (word, place) = self.place(position)?;
        let file = &self.files.0[0];
        self.kept(place?).is_none().then(|| file.text.range(&file.outline.words[word].span))
    }

    /// Why a name is not changed here: columns of tables are data, and a robot's text is made of its file.
    fn kept(&self, place: Place) -> Option<&'static str> {
        if self.files.import_of(place.0).is_some() {
            return Some("a name of a robot is renamed in the robot's file");
        }
        let is_table = self.files.0[place.0].name.to_lowercase().ends_with(".csv");
        is_table.then_some("a column of a table is renamed in the table")
    }

    /// The edits that give the name at a position another one, by the addresses of files.
    ///
    /// # Errors
    /// Why that cannot be.
    pub(super) fn renamed(&self, position: Position, name: &str) -> Result<Value, String> {
        let place =
            self.place(position).and_then(|(_, place)| place).ok_or("there is no name here that is declared")?;
        self.kept(place).map_or(Ok(()), Err)?;
        let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && name.contains(|c: char| c.is_ascii_alphabetic());
        if !is_name {
            return Err(format!("`{name}` is not a name: names are ASCII letters, digits and `_`"));
        }
        let mut changes: BTreeMap<String, Vec<TextEdit>> = BTreeMap::new();
        let mut renamed = self.documents.clone();
        for (file, spans) in references(self.documents, self.files, place) {
            let (Some(uri), Some(mut text)) = (self.documents.uri(&file), self.text(&file)) else { continue };
            let edits = spans.iter().map(|span| TextEdit { range: text.range(span), new_text: name.to_string() });
            changes.insert(uri.as_str().to_string(), edits.collect());
            spans.into_iter().rev().for_each(|span| text.text.replace_range(span, name));
            renamed.insert(Document { uri, text: Text::new(text.text), version: 0 });
        }
        let own = self.documents.sources(&self.files.0[0].name);
        for old in own.into_iter().chain(importing(self.documents, self.files, place)) {
            let new = renamed.sources(&old.main().name);
            new.map_or(Ok(()), |new| same_meaning(&old, &new, name))?;
        }
        Ok(json!({ "changes": changes }))
    }
}

/// Whether a text still means the same when something in it is called otherwise.
///
/// # Errors
/// Why not: the first word that stands for something else, or what is wrong now.
fn same_meaning(old: &Sources, new: &Sources, name: &str) -> Result<(), String> {
    let (before, after) = (Files::of(old), Files::of(new));
    let roles = |files: &Files| -> Vec<Role> {
        files.0.iter().flat_map(|file| &file.outline.words).map(|word| word.role.clone()).collect()
    };
    if roles(&before) != roles(&after) {
        return Err(format!("`{name}` is a word of the language"));
    }
    // What is declared has the same number in both.
    for (number, file) in before.0.iter().enumerate() {
        for (word, Word { span, .. }) in file.outline.words.iter().enumerate() {
            let (was, is) = (before.resolved(number, word), after.resolved(number, word));
            // Of the two places one has had the name already.
            let had = |place: &Place| before.symbol(*place).name == name;
            match [was, is].into_iter().flatten().find(had) {
                _ if was == is => {}
                Some(place) => {
                    let what = before.symbol(place).kind.described();
                    let article = if what.starts_with(['a', 'i', 'o']) { "an" } else { "a" };
                    return Err(format!("`{name}` is already {article} {what}"));
                }
                None => {
                    let line = file.text.position(span.start).line + 1;
                    return Err(format!("`{name}` would be something else in line {line} of `{}`", file.name));
                }
            }
        }
    }
    let found = new.surveyed().0;
    if found.iter().next().is_none() {
        return Ok(());
    }
    let mut known: Vec<String> = old.surveyed().0.iter().map(Diagnostic::code).collect();
    let is_new = |found: &&Diagnostic| {
        let place = known.iter().position(|code| *code == found.code());
        place.map(|place| known.swap_remove(place)).is_none()
    };
    let new = found.iter().find(is_new).map(|found| found.message.clone());
    new.map_or(Ok(()), Err)
}

// ---- hover

impl View<'_> {
    pub(super) fn hover(&self, position: Position) -> Option<Hover> {
        let (word, place) = self.place(position)?;
        let file = &self.files.0[0];
        let span = file.outline.words[word].span.clone();
        let text = match place {
            Some(place) => self.about(place),
            None => about_word(self.files.text_of(0, &span), &file.outline.words[word].role)?,
        };
        let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: text });
        Some(Hover { contents, range: Some(file.text.range(&span)) })
    }

    fn about(&self, place: Place) -> String {
        let (symbol, file) = (self.files.symbol(place), &self.files.0[place.0]);
        let mut text =
            format!("```mbs\n{}\n```\n\n{} `{}`", self.statement(place), symbol.kind.described(), symbol.name);
        if let Some(meaning) = self.meaning(place) {
            text += &format!(": {meaning}");
        }
        if place.0 > 0 {
            text += &format!(", of `{}`", file.name.rsplit('/').next().unwrap_or(&file.name));
        }
        if !symbol.docs.is_empty() {
            text += &format!("\n\n{}", symbol.docs);
        }
        let cost = |name: &str| self.costs.iter().find(|(function, _)| function == name).map(|(_, flops)| *flops);
        match symbol.kind {
            Kind::Output | Kind::Reaction => {
                if let Some(flops) = cost(&symbol.name) {
                    text += &format!("\n\n{flops} additions and multiplications");
                }
            }
            Kind::Mechanism if !self.costs.is_empty() => {
                text += "\n\n| function | additions and multiplications |\n|---|---|";
                for (name, flops) in self.costs {
                    text += &format!("\n| `{name}` | {flops} |");
                }
            }
            _ => {}
        }
        text
    }

    /// As it was written, abridged.
    fn statement(&self, place: Place) -> String {
        const LONGEST: usize = 400;
        let symbol = self.files.symbol(place);
        let text = self.files.text_of(place.0, &symbol.statement);
        let body = matches!(symbol.kind, Kind::Mechanism | Kind::Part | Kind::Loop);
        let text = if body { text.split('{').next().unwrap_or(text).trim_end() } else { text };
        match text.char_indices().nth(LONGEST) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text.to_string(),
        }
    }
}

fn about_word(word: &str, role: &Role) -> Option<String> {
    let kinds: &[&str] = match role {
        Role::Keyword => &["keyword"],
        Role::Unit => &["unit"],
        Role::Called => &["function"],
        Role::Member(_) => &["method"],
        Role::Value => &["constant", "keyword"],
        Role::Declared(_) | Role::Part => &[],
    };
    let found = known().into_iter().find(|known| known.name == word && kinds.contains(&known.kind))?;
    let Known { kind, name, form, sentence } = found;
    Some(match kind {
        "unit" => format!("unit `{name}`: {form}"),
        "constant" => format!("`{name}`: {form}"),
        "keyword" => format!("`{name}`\n\n{sentence}"),
        _ => format!("```mbs\n{form}\n```\n\n{sentence}"),
    })
}

// ---- completion

impl View<'_> {
    pub(super) fn completion(&self, position: Position) -> Vec<CompletionItem> {
        let offset = self.offset(position);
        let text = &self.files.0[0].text.text;
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let before = text[..offset].trim_end_matches(is_part);
        let line = before.rsplit('\n').next().unwrap_or_default();
        if line.contains("//") {
            return Vec::new();
        }
        let known = known();
        let of = |kinds: &[&str]| known.iter().filter(|k| kinds.contains(&k.kind)).map(item).collect::<Vec<_>>();
        if before.trim_end().ends_with('.') && !before.trim_end().ends_with("..") {
            return self.members(before.trim_end().len() - 1, &of(&["method"]));
        }
        let statement = line.rsplit([';', '{', '}']).next().unwrap_or(line).trim_start();
        // Where something stands before an `if`, a value stands in the braces behind it.
        let chooses = line.rsplit(';').next().unwrap_or(line);
        let is_branch = line.trim_end().ends_with('{')
            && chooses.match_indices("if").any(|(at, word)| {
                let (before, behind) = (chooses[..at].trim_end(), &chooses[at + word.len()..]);
                let is_word = !chooses[..at].ends_with(is_part) && !behind.starts_with(is_part);
                is_word && !before.is_empty() && !before.ends_with(['{', '}']) && !before.ends_with("else")
            });
        if statement.is_empty() && !is_branch {
            let mut items = of(&["keyword"]);
            let assigned = |symbol: &Symbol| matches!(symbol.kind, Kind::Local | Kind::Part);
            items.extend(self.names(offset, assigned));
            return items;
        }
        let declares = ["param ", "coord ", "input ", "prescribed ", "const "];
        let is_unit = declares.iter().any(|word| statement.starts_with(word))
            && statement.contains(':')
            && !statement.contains('=');
        let behind_number = before.ends_with(' ')
            && before
                .trim_end()
                .rsplit(|c: char| !is_part(c) && c != '.')
                .next()
                .is_some_and(|word| word.starts_with(|c: char| c.is_ascii_digit()));
        if is_unit || behind_number {
            return of(&["unit"]);
        }
        let mut items = self.names(offset, |symbol| symbol.kind.space() != Space::Part);
        items.extend(of(&["function", "constant"]));
        items.extend(
            of(&["keyword"]).into_iter().filter(|item| ["if", "else", "in", "at", "on"].contains(&&*item.label)),
        );
        items
    }

    fn names(&self, offset: usize, wanted: impl Fn(&Symbol) -> bool) -> Vec<CompletionItem> {
        let places = self.files.in_sight(offset).into_iter();
        places.filter(|place| wanted(self.files.symbol(*place))).map(|place| self.name(place)).collect()
    }

    fn name(&self, place: Place) -> CompletionItem {
        let symbol = self.files.symbol(place);
        let kind = match symbol.kind {
            Kind::Function | Kind::Part => CompletionItemKind::FUNCTION,
            Kind::Constant => CompletionItemKind::CONSTANT,
            Kind::Parameter | Kind::Coordinate | Kind::Input | Kind::Prescribed => CompletionItemKind::FIELD,
            _ => CompletionItemKind::VARIABLE,
        };
        let meaning = self.meaning(place).map(|meaning| format!("{}: {meaning}", symbol.kind.described()));
        CompletionItem {
            label: symbol.name.clone(),
            kind: Some(kind),
            detail: Some(meaning.unwrap_or_else(|| symbol.kind.described().to_string())),
            documentation: (!symbol.docs.is_empty()).then(|| Documentation::String(symbol.docs.clone())),
            ..CompletionItem::default()
        }
    }

    /// What may stand behind the point at an offset.
    fn members(&self, point: usize, methods: &[CompletionItem]) -> Vec<CompletionItem> {
        let outline = &self.files.0[0].outline;
        let end = self.files.0[0].text.text[..point].trim_end().len();
        let indexed = self.files.0[0].text.text[..end].ends_with(']');
        let word = match indexed {
            true => {
                let open = self.files.0[0].text.text[..end].rfind('[').unwrap_or(0);
                outline.word_at(open)
            }
            false => outline.word_at(end),
        };
        let place = word.and_then(|word| self.files.resolved(0, word));
        if let Some(place) = place.filter(|place| self.files.symbol(*place).kind == Kind::Instance) {
            return self.files.members(place).into_iter().map(|place| self.name(place)).collect();
        }
        let component = |name: &str| CompletionItem {
            label: name.to_string(),
            kind: Some(CompletionItemKind::FIELD),
            detail: Some("component of a vector".to_string()),
            ..CompletionItem::default()
        };
        ["x", "y", "z"].into_iter().map(component).chain(methods.iter().cloned()).collect()
    }
}

fn item(known: &Known) -> CompletionItem {
    let kind = match known.kind {
        "keyword" => CompletionItemKind::KEYWORD,
        "function" => CompletionItemKind::FUNCTION,
        "method" => CompletionItemKind::METHOD,
        "unit" => CompletionItemKind::UNIT,
        _ => CompletionItemKind::CONSTANT,
    };
    CompletionItem {
        label: known.name.clone(),
        kind: Some(kind),
        detail: (!known.form.is_empty()).then(|| known.form.clone()),
        documentation: (!known.sentence.is_empty()).then(|| Documentation::String(known.sentence.to_string())),
        ..CompletionItem::default()
    }
}

// ---- the whole file

impl View<'_> {
    /// What the file declares, what is declared in a mechanism or a part below it.
    pub(super) fn symbols(&self) -> Value {
        let file = &self.files.0[0];
        let shown = |symbol: &&Symbol| !matches!(symbol.kind, Kind::Argument | Kind::Loop);
        let all: Vec<&Symbol> = file.outline.symbols.iter().filter(shown).collect();
        let one = |symbol: &Symbol, children: Vec<Value>| {
            let kind = match symbol.kind {
                Kind::Mechanism => SymbolKind::CLASS,
                Kind::Function => SymbolKind::FUNCTION,
                Kind::Part => SymbolKind::CLASS,
                Kind::Constant => SymbolKind::CONSTANT,
                Kind::Parameter | Kind::Coordinate | Kind::Input | Kind::Prescribed => SymbolKind::FIELD,
                Kind::Output => SymbolKind::METHOD,
                Kind::Constraint | Kind::Reaction => SymbolKind::OPERATOR,
                _ => SymbolKind::VARIABLE,
            };
            json!({
                "name": symbol.name,
                "detail": symbol.kind.described(),
                "kind": kind,
                "range": file.text.range(&symbol.statement),
                "selectionRange": file.text.range(&symbol.span),
                "children": children,
            })
        };
        let inside = |outer: &Symbol| {
            let within =
                |symbol: &&&Symbol| outer.statement.start < symbol.span.start && symbol.span.end <= outer.statement.end;
            all.iter().filter(within).copied().filter(|symbol| symbol.span != outer.span).collect::<Vec<_>>()
        };
        // Blocks of blocks are as deep as mechanism, part, name.
        let parts = |symbol: &Symbol| match symbol.kind {
            Kind::Part => one(symbol, inside(symbol).into_iter().map(|member| one(member, Vec::new())).collect()),
            _ => one(symbol, Vec::new()),
        };
        let in_part = |symbol: &Symbol| {
            all.iter().any(|part| part.kind == Kind::Part && inside(part).iter().any(|inner| inner.span == symbol.span))
        };
        let top = |symbols: Vec<&Symbol>| -> Vec<Value> {
            symbols.into_iter().filter(|symbol| !in_part(symbol)).map(parts).collect()
        };
        let mechanism = all.iter().find(|symbol| symbol.kind == Kind::Mechanism);
        match mechanism {
            Some(mechanism) => json!([one(mechanism, top(inside(mechanism)))]),
            None => json!(top(all.clone())),
        }
    }

    /// Dimensions behind names that are declared without a unit.
    pub(super) fn hints(&self, range: lsp_types::Range) -> Vec<InlayHint> {
        let file = &self.files.0[0];
        let span = file.text.span(range);
        let is_wanted = |symbol: &Symbol| {
            let kind = matches!(symbol.kind, Kind::Local | Kind::Constant | Kind::Function | Kind::Output);
            kind && !symbol.has_unit && span.start <= symbol.span.end && symbol.span.end <= span.end
        };
        let hint = |(number, symbol): (usize, &Symbol)| {
            let meaning = self.meaning((0, number))?;
            let meaning = meaning.split(" = ").next().unwrap_or(meaning);
            // Behind the arguments of a function.
            let arguments = file.text.text[symbol.span.end..].find(')').filter(|_| symbol.kind == Kind::Function);
            let end = arguments.map_or(symbol.span.end, |close| symbol.span.end + close + 1);
            Some(InlayHint {
                position: file.text.position(end),
                label: InlayHintLabel::String(format!(": {meaning}")),
                kind: Some(InlayHintKind::TYPE),
                text_edits: None,
                tooltip: None,
                padding_left: None,
                padding_right: None,
                data: None,
            })
        };
        let wanted = file.outline.symbols.iter().enumerate().filter(|(_, symbol)| is_wanted(symbol));
        wanted.filter_map(hint).collect()
    }
}
