//! What a name stands for, and where else it stands: in a file and in those that it imports.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use mbs_derive::source::Sources;

use super::documents::Documents;
use super::outline::{Kind, Outline, Role, Scope, Space, Symbol, Word};
use super::text::Text;

/// A file with what it declares.
#[derive(Debug)]
pub(super) struct File {
    pub(super) name: String,
    pub(super) text: Text,
    pub(super) outline: Outline,
    /// The numbers of its symbols by name, rising.
    called: BTreeMap<String, Vec<usize>>,
    /// Where its text begins among those of all files.
    pub(super) start: usize,
}

/// A file and all that it imports, itself first.
#[derive(Debug)]
pub(super) struct Files(pub(super) Vec<File>);

/// A symbol: the file's number and its own.
pub(super) type Place = (usize, usize);

/// Where a name stands: the file's name and the place in it.
pub(super) type Occurrence = (String, (usize, usize));

impl Files {
    pub(super) fn of(sources: &Sources) -> Self {
        let file = |number: usize| {
            let source = sources.file(number);
            let text = source.text.as_deref().unwrap_or_default();
            let is_table = source.name.to_lowercase().ends_with(".csv");
            let outline = if is_table { table(text) } else { Outline::of(text) };
            let mut called: BTreeMap<String, Vec<usize>> = BTreeMap::new();
            for (number, symbol) in outline.symbols.iter().enumerate() {
                called.entry(symbol.name.clone()).or_default().push(number);
            }
            File { name: source.name.clone(), text: Text::new(text.to_string()), outline, called, start: source.start }
        };
        Files((0..sources.count()).map(file).collect())
    }

    /// Of a robot that is imported, the place of the statement in the first file.
    pub(super) fn import_of(&self, number: usize) -> Option<Range<usize>> {
        let (main, robot) = (&self.0[0].text.text, &self.0[number]);
        if number == 0 || !robot.text.text.starts_with("// Imported from ") {
            return None;
        }
        let last = robot.name.rsplit('/').next().unwrap_or(&robot.name);
        let end = main.find(&format!("{last}\"")).map_or(0, |at| at + last.len() + 1);
        Some(main[..end].rfind("import").unwrap_or(0)..end)
    }

    /// The block of a file whose names are seen in the first one: of a robot that of its mechanism, of a table or
    /// shared declarations the file.
    fn shared(&self, number: usize) -> Option<usize> {
        let outline = &self.0[number].outline;
        match self.import_of(number) {
            Some(_) => outline.symbols.iter().find(|symbol| symbol.kind == Kind::Mechanism)?.body,
            None => (!outline.is_mechanism).then_some(0),
        }
    }

    /// The symbols of a file that are called so, with their numbers.
    fn called(&self, file: usize, name: &str) -> impl Iterator<Item = (usize, &Symbol)> {
        let File { outline, called, .. } = &self.0[file];
        called.get(name).into_iter().flatten().map(|&number| (number, &outline.symbols[number]))
    }

    pub(super) fn symbol(&self, (file, symbol): Place) -> &Symbol {
        &self.0[file].outline.symbols[symbol]
    }

    pub(super) fn text_of(&self, file: usize, span: &Range<usize>) -> &str {
        self.0[file].text.text.get(span.clone()).unwrap_or_default()
    }

    /// What the word with this number of a file stands for, if that is declared anywhere.
    pub(super) fn resolved(&self, file: usize, word: usize) -> Option<Place> {
        let Word { span, role, scope } = &self.0[file].outline.words[word];
        let name = self.text_of(file, span);
        match role {
            Role::Declared(symbol) => Some((file, *symbol)),
            Role::Value => self.found(file, *scope, name, Space::Value, span.start),
            Role::Called => self.found(file, *scope, name, Space::Function, span.start),
            Role::Part => self.found(file, *scope, name, Space::Part, span.start),
            Role::Member(chain) => self.member(file, chain, name),
            Role::Keyword | Role::Unit => None,
        }
    }

    fn found(&self, file: usize, scope: usize, name: &str, space: Space, at: usize) -> Option<Place> {
        let outline = &self.0[file].outline;
        let (mut scope, mut through, mut later) = (scope, false, None);
        loop {
            let fits = |(_, symbol): &(usize, &Symbol)| {
                symbol.scope == scope && symbol.kind.space() == space && (!through || symbol.kind.is_everywhere())
            };
            let here: Vec<(usize, &Symbol)> = self.called(file, name).filter(fits).collect();
            let is_known = |symbol: &Symbol| {
                let always = matches!(symbol.kind, Kind::Argument | Kind::Loop | Kind::Function | Kind::Part);
                through || always || symbol.statement.end <= at
            };
            if let Some((number, _)) = here.iter().rev().find(|(_, symbol)| is_known(symbol)) {
                return Some((file, *number));
            }
            later = later.or(here.first().map(|(number, _)| (file, *number)));
            let Scope { parent, is_body, .. } = &outline.scopes[scope];
            if scope == 0 {
                return self.imported(file, name, space, through).or(later);
            }
            through |= is_body;
            scope = *parent;
        }
    }

    /// What another file declares for all, and a robot for the first file; `through` the body of a function or a part
    /// only what is seen there.
    fn imported(&self, file: usize, name: &str, space: Space, through: bool) -> Option<Place> {
        let others =
            (0..self.0.len()).filter(|&number| number != file && (file == 0 || self.import_of(number).is_none()));
        let shared = others.filter_map(|number| Some((number, self.shared(number)?)));
        let mut declared = shared.flat_map(|(number, scope)| {
            let symbols = self.called(number, name);
            symbols.filter(move |(_, symbol)| symbol.scope == scope).map(move |(i, symbol)| ((number, i), symbol))
        });
        let fits = |symbol: &Symbol| symbol.kind.space() == space;
        let is_seen = |symbol: &Symbol| !through || symbol.kind.is_everywhere();
        declared.find(|(_, symbol)| fits(symbol) && is_seen(symbol)).map(|(place, _)| place)
    }

    /// `tip` of `arm.tip`, of the chain of words before it.
    fn member(&self, file: usize, chain: &[usize], name: &str) -> Option<Place> {
        let (first, inner) = chain.split_first()?;
        let mut instance = self
            .resolved(file, *first)
            .filter(|_| !matches!(self.0[file].outline.words[*first].role, Role::Member(_)))?;
        for word in inner {
            let span = &self.0[file].outline.words[*word].span;
            instance = self.member_of(instance, self.text_of(file, span))?;
        }
        self.member_of(instance, name)
    }

    fn member_of(&self, instance: Place, name: &str) -> Option<Place> {
        self.members(instance).into_iter().find(|place| self.symbol(*place).name == name)
    }

    /// What the part declares that is used here, local names before outputs.
    pub(super) fn members(&self, instance: Place) -> Vec<Place> {
        let symbol = self.symbol(instance);
        let Some(part) = &symbol.part else { return Vec::new() };
        let place = self.found(instance.0, symbol.scope, part, Space::Part, symbol.span.start);
        let Some(place) = place else { return Vec::new() };
        let Some(body) = self.symbol(place).body else { return Vec::new() };
        let symbols = self.0[place.0].outline.symbols.iter().enumerate().filter(|(_, member)| member.scope == body);
        let of = |kinds: &'static [Kind]| {
            let chosen = symbols.clone().filter(|(_, member)| kinds.contains(&member.kind));
            chosen.map(|(number, _)| (place.0, number)).collect::<Vec<_>>()
        };
        [of(&[Kind::Local, Kind::Constant, Kind::Instance]), of(&[Kind::Output])].concat()
    }

    /// All symbols that are seen at an offset of the first file, the innermost first.
    pub(super) fn in_sight(&self, offset: usize) -> Vec<Place> {
        let outline = &self.0[0].outline;
        let mut names: BTreeSet<String> = BTreeSet::new();
        let mut places = Vec::new();
        let mut scope = outline.scope_at(offset);
        loop {
            let here = outline.symbols.iter().filter(|symbol| symbol.scope == scope);
            names.extend(here.map(|symbol| symbol.name.clone()));
            if scope == 0 {
                break;
            }
            scope = outline.scopes[scope].parent;
        }
        for (number, other) in self.0.iter().enumerate().skip(1) {
            let shared = self.shared(number);
            let here = other.outline.symbols.iter().filter(|symbol| Some(symbol.scope) == shared);
            names.extend(here.map(|symbol| symbol.name.clone()));
        }
        let scope = outline.scope_at(offset);
        for name in &names {
            for space in [Space::Value, Space::Function, Space::Part] {
                places.extend(self.found(0, scope, name, space, offset));
            }
        }
        places
    }

    /// Where a symbol of the file called `declared` at `start` stands in these files; a robot's text is in none.
    fn occurrences(&self, declared: &str, start: usize, name: &str, found: &mut BTreeSet<Occurrence>) {
        for (number, file) in self.0.iter().enumerate().filter(|(number, _)| self.import_of(*number).is_none()) {
            for (word, Word { span, .. }) in file.outline.words.iter().enumerate() {
                if self.text_of(number, span) != name {
                    continue;
                }
                let is_meant = self
                    .resolved(number, word)
                    .is_some_and(|place| self.0[place.0].name == declared && self.symbol(place).span.start == start);
                if is_meant {
                    found.insert((file.name.clone(), (span.start, span.end)));
                }
            }
        }
    }
}

/// All places where a symbol stands: in its file, and if others may import that, in those that do.
pub(super) fn references(documents: &Documents, files: &Files, place: Place) -> BTreeMap<String, Vec<Range<usize>>> {
    let (file, symbol) = (&files.0[place.0], files.symbol(place));
    let mut found = BTreeSet::new();
    files.occurrences(&file.name, symbol.span.start, &symbol.name, &mut found);
    for sources in importing(documents, files, place) {
        Files::of(&sources).occurrences(&file.name, symbol.span.start, &symbol.name, &mut found);
    }
    let mut places: BTreeMap<String, Vec<Range<usize>>> = BTreeMap::new();
    for (name, (start, end)) in found {
        places.entry(name).or_default().push(start..end);
    }
    places
}

/// The other files that import the one of a symbol, if others may.
pub(super) fn importing(documents: &Documents, files: &Files, place: Place) -> Vec<Sources> {
    let file = &files.0[place.0];
    if files.shared(place.0).is_none() {
        return Vec::new();
    }
    let others = documents.all().into_iter().filter(|name| *name != files.0[0].name);
    let sources = others.filter_map(|name| documents.sources(&name));
    sources.filter(|sources| sources.names().any(|other| other == file.name)).collect()
}

/// The columns of a table.
fn table(text: &str) -> Outline {
    let mut outline =
        Outline { scopes: vec![Scope { parent: 0, span: 0..text.len(), is_body: false }], ..Outline::default() };
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            start += line.len();
            continue;
        }
        for column in line.split(',') {
            let name: String =
                column.trim_start().chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
            let first = start + column.len() - column.trim_start().len();
            let (span, statement) = (first..first + name.len(), start..start + column.trim_end().len());
            let has_unit = column.contains('[');
            let role = Role::Declared(outline.symbols.len());
            outline.words.push(Word { span: span.clone(), role, scope: 0 });
            outline.symbols.push(Symbol {
                name,
                kind: Kind::Constant,
                span,
                statement,
                docs: String::new(),
                scope: 0,
                body: None,
                part: None,
                has_unit,
            });
            start += column.len() + 1;
        }
        break;
    }
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARED: &str = "/// Standard.\nconst g: m/s^2 = 9.81;\nfn half(x) = x/2;\n\
                          part link(m, pose) { let end = pose*rot_z(pi); output tip = end.origin(); kinetic += particle(m, tip); }\n";
    const MAIN: &str = "import \"lib.mbs\"; import \"t.csv\";\n\
                        mechanism A {\n    param m: kg = 1;\n    param t_: s = 0.3 s*m;\n    coord x: m;\n    let a = m*g + stretch[0];\n    \
                        for m in 0..2 { let a = a*m; x = a; }\n    fn f(x, y) = half(x) + m*y;\n    link arm(m, world);\n    \
                        force x += f(arm.end.x, arm.tip) + if m > 0 { a } else { x };\n    output a = a;\n    \
                        let c = 0.3 kg*g + 2 kg*m*g + 3 kg/g; let d = 2 kg*m/s/s + 1 kg*2 g;\n    \
                        param s: s = 1; let e = 3 m*s^-1/s + 4 m/s^-1/s + 5 m*s^(-1)/s/s + 6 m*s^-1*s;\n}\n";

    fn files() -> Files {
        let sources = Sources::gather("main.mbs", MAIN, |name| match name {
            "lib.mbs" => Ok(SHARED.as_bytes().to_vec()),
            _ => Ok(b"# lengths\nstretch [mm], load [N]\n0, 0\n1, 1\n".to_vec()),
        });
        Files::of(&sources)
    }

    /// The text from the `n`-th occurrence of a piece of the main file on, `|` before the word; where it is declared.
    #[track_caller]
    fn check(piece: &str, expected: &str) {
        let files = files();
        let (plain, mark) = (piece.replacen('|', "", 1), piece.find('|').expect("a mark"));
        let offset = MAIN.find(&plain).expect("the piece") + mark;
        let word = files.0[0].outline.word_at(offset).expect("a word");
        let found = files.resolved(0, word).map(|place| {
            let statement = files.text_of(place.0, &files.symbol(place).statement).replace('\n', " ");
            format!("{}: {}", files.0[place.0].name, statement.chars().take(24).collect::<String>())
        });
        assert_eq!(found.as_deref().unwrap_or("nothing"), expected, "{piece}");
    }

    #[test]
    fn names_are_found_where_they_are_declared() {
        check("let a = |m*g", "main.mbs: param m: kg = 1;");
        check("m*|g +", "lib.mbs: const g: m/s^2 = 9.81;");
        check("|stretch[0]", "t.csv: stretch [mm]");
        check("let a = |a*m", "main.mbs: let a = m*g + stretch[0]");
        check("a*|m; x", "main.mbs: for m");
        check("x = |a; }", "main.mbs: let a = a*m;");
        check("|half(x)", "lib.mbs: fn half(x) = x/2;");
        check("half(|x)", "main.mbs: fn f(x, y) = half(x) + m");
        check("+ |m*y", "main.mbs: param m: kg = 1;");
        check("|link arm", "lib.mbs: part link(m, pose) { let");
        check("|arm.end", "main.mbs: link arm(m, world);");
        check("arm.|end", "lib.mbs: let end = pose*rot_z(pi)");
        check("arm.|tip", "lib.mbs: output tip = end.origin(");
        check("{ |a } else", "main.mbs: let a = m*g + stretch[0]");
        check("output |a", "main.mbs: output a = a;");
        check("output a = |a", "main.mbs: let a = m*g + stretch[0]");
        check("0.3 |s", "nothing");
        check("0.3 s*|m", "nothing");
        // A second unit of one quantity is a name.
        check("0.3 kg*|g", "lib.mbs: const g: m/s^2 = 9.81;");
        check("2 kg*m*|g", "lib.mbs: const g: m/s^2 = 9.81;");
        check("3 kg/|g", "lib.mbs: const g: m/s^2 = 9.81;");
        check("2 kg*|m/s", "nothing");
        check("m/s/|s", "nothing");
        check("kg*2 |g", "nothing");
        // The sign of an exponent counts, too.
        check("3 m*s^-1/|s", "nothing");
        check("4 m/s^-1/|s", "main.mbs: param s: s = 1;");
        check("s^(-1)/s/|s", "nothing");
        check("6 m*s^-1*|s", "main.mbs: param s: s = 1;");
    }

    #[test]
    fn many_names_are_looked_up_in_linear_time() {
        // The least of some times, as other programs run beside.
        let time = |count: usize| {
            let names: String = (0..count).map(|i| format!("let a{i} = x; ")).collect();
            let files = Files::of(&Sources::new("a.mbs", &format!("mechanism A {{ coord x: m; {names} }}")));
            let once = || {
                let begun = std::time::Instant::now();
                assert_eq!(files.in_sight(files.0[0].text.text.len() - 1).len(), count + 1);
                begun.elapsed()
            };
            (0..5).map(|_| once()).min().unwrap().as_secs_f64()
        };
        // Four times as many: 4 times as long, or 16 where each is compared with all.
        let (few, many) = (time(15_000), time(60_000));
        assert!(many < 8.0 * few, "{few} s, {many} s");
    }

    /// Each name in turn: a use that is missed is not declared any more, one too many is an error, too.
    #[test]
    fn renamed_mechanisms_are_as_good() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mechanisms");
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "mbs"));
        paths.sort();
        let mut renamed = 0;
        for path in paths {
            let text = std::fs::read_to_string(&path).unwrap();
            let sources = Sources::new("a.mbs", &text);
            let files = Files::of(&sources);
            let problems = |text: &str| Sources::new("a.mbs", text).surveyed().0.iter().count();
            let before = problems(&text);
            for symbol in 0..files.0[0].outline.symbols.len() {
                let mut other = text.clone();
                let places = references(&Documents::default(), &files, (0, symbol)).remove("a.mbs").unwrap();
                for place in places.into_iter().rev() {
                    other.replace_range(place, "zz_new");
                }
                let name = &files.0[0].outline.symbols[symbol].name;
                assert_eq!(problems(&other), before, "{}: `{name}`\n{other}", path.display());
                renamed += 1;
            }
        }
        assert!(renamed > 100, "{renamed}");
    }

    #[test]
    fn broken_texts_have_outlines() {
        for broken in [
            "mechanism A { let a = (b + ; }",
            "mechanism {",
            "for i in",
            "part p(",
            "x.y.",
            "if if if {",
            "} } }",
            "let a = [1, 2\nparam m: kg = a",
            "import",
            "fn f(",
            "θ",
            "\"",
            "/* ",
            "a[b[c",
            ".a.b",
            "output",
            "link a[",
        ] {
            for end in 0..=broken.len() {
                if let Some(text) = broken.get(..end) {
                    let files = Files::of(&Sources::new("a.mbs", text));
                    for word in 0..files.0[0].outline.words.len() {
                        let _ = files.resolved(0, word);
                    }
                    files.in_sight(end);
                }
            }
        }
        let outline = Outline::of("mechanism A { let a = (b + ;\n param m: kg = 1; let c = [1, 2\ncoord x: m; ");
        let names: Vec<&str> = outline.symbols.iter().map(|symbol| symbol.name.as_str()).collect();
        assert_eq!(names, ["A", "a", "m", "c", "x"]);
    }
}
