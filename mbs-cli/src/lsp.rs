//! `mbs lsp`: what editors ask, over standard input and output, in the Language Server Protocol.
//!
//! - [`transport`]: messages; [`text`]: positions in units of UTF-16; [`documents`]: open files, which count before
//!   those on the disk;
//! - [`outline`]: what a file declares and where its names stand, right or wrong; [`resolve`]: what they stand for;
//! - [`answers`]: hover, definitions, references, rename, completion, symbols, hints; [`words`]: the language's words;
//! - [`mod@problems`]: what is wrong, and what may be written instead; [`deriving`]: the proof and the costs, beside
//!   the conversation.
//!
//! What is wrong in a text is said as soon as there is nothing else to answer; when nothing has been typed for a
//! moment, the mechanism is derived and proved.

mod answers;
mod deriving;
mod documents;
mod outline;
mod problems;
mod resolve;
mod text;
mod transport;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufReader};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::{
    CodeActionParams, CompletionParams, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, DocumentFormattingParams, DocumentSymbolParams, GotoDefinitionParams, HoverParams,
    InitializeParams, InlayHintParams, Position, PublishDiagnosticsParams, ReferenceParams, RenameParams,
    TextDocumentPositionParams, TextEdit, Uri,
};
use mbs_derive::diagnostic::{Diagnostic, Severity};
use mbs_derive::source::Sources;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::failure::Failure;
use answers::View;
use deriving::{Derived, Job};
use documents::{Document, Documents, name_of};
use problems::{Problem, problems};
use resolve::Files;
use text::Text;

/// Serve an editor: errors as you type, hover, definitions, rename, completion, formatting. Editors start it.
///
/// It speaks the Language Server Protocol over standard input and output.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Standard input and output, as editors ask for; there is no other way.
    #[arg(long, hide = true)]
    stdio: bool,
}

/// How long nothing must have been typed before a mechanism is derived.
const PAUSE: Duration = Duration::from_millis(400);

/// What happens.
#[derive(Debug)]
enum Event {
    Message(Message),
    Garbage(String),
    Derived(Derived),
    End,
}

/// Answers until the editor ends the conversation.
pub(crate) fn run(_: &Arguments) -> Result<(), Failure> {
    let (events, happening) = channel();
    let (to_editor, from_server): (Sender<Message>, Receiver<Message>) = channel();
    let reading = events.clone();
    thread::spawn(move || {
        let mut input = BufReader::new(io::stdin());
        loop {
            let (event, ends) = match transport::read(&mut input) {
                transport::Incoming::Message(message) => (Event::Message(message), false),
                transport::Incoming::Garbage(reason) => (Event::Garbage(reason), false),
                transport::Incoming::End => (Event::End, true),
            };
            if reading.send(event).is_err() || ends {
                return;
            }
        }
    });
    let writer = thread::spawn(move || {
        let mut output = io::stdout().lock();
        for message in from_server {
            if !transport::write(&mut output, &message) {
                return;
            }
        }
    });
    let server = Server { jobs: deriving::worker(events), to_editor, ..Server::new() };
    let is_orderly = server.serve(&happening);
    let _ = writer.join();
    match is_orderly {
        true => Ok(()),
        false => {
            Err(Failure::new("the editor has gone without a word; it ends the conversation by `shutdown` and `exit`"))
        }
    }
}

/// What is known of an open file.
#[derive(Debug, Default)]
struct State {
    /// The texts that all this is about.
    sources: Option<Sources>,
    /// What its names stand for, by their places among all files, and with which texts.
    meanings: Vec<(Range<usize>, String)>,
    costs: Vec<(String, usize)>,
    /// Messages by files.
    problems: BTreeMap<String, Vec<Problem>>,
    found: Vec<Diagnostic>,
    is_derived: bool,
}

struct Server {
    documents: Documents,
    states: BTreeMap<String, State>,
    /// Open files that are to be looked at again.
    changed: BTreeSet<String>,
    /// What the editor shows.
    shown: BTreeMap<String, Vec<Problem>>,
    /// When nothing will have been typed for a moment.
    quiet: Instant,
    is_initialized: bool,
    is_shut_down: bool,
    jobs: Sender<Job>,
    to_editor: Sender<Message>,
}

impl Server {
    fn new() -> Self {
        Server {
            documents: Documents::default(),
            states: BTreeMap::new(),
            changed: BTreeSet::new(),
            shown: BTreeMap::new(),
            quiet: Instant::now(),
            is_initialized: false,
            is_shut_down: false,
            jobs: channel().0,
            to_editor: channel().0,
        }
    }

    /// Whether the conversation was ended in order.
    fn serve(mut self, happening: &Receiver<Event>) -> bool {
        loop {
            let event = match happening.try_recv() {
                Ok(event) => event,
                Err(_) if !self.changed.is_empty() => {
                    self.look();
                    continue;
                }
                Err(_) => match self.waiting() {
                    None => match happening.recv() {
                        Ok(event) => event,
                        Err(_) => return false,
                    },
                    Some(job) => match happening.recv_timeout(self.quiet.saturating_duration_since(Instant::now())) {
                        Ok(event) => event,
                        Err(RecvTimeoutError::Timeout) => {
                            self.derive(&job);
                            continue;
                        }
                        Err(RecvTimeoutError::Disconnected) => return false,
                    },
                },
            };
            match event {
                Event::End => return self.is_shut_down,
                Event::Garbage(reason) => self.tell(&reason),
                Event::Derived(derived) => self.derived(derived),
                Event::Message(Message::Notification(notification)) if notification.method == "exit" => {
                    return self.is_shut_down;
                }
                Event::Message(message) => {
                    // A bug in an answer is no reason to leave the editor alone.
                    let id = match &message {
                        Message::Request(request) => Some(request.id.clone()),
                        Message::Notification(_) | Message::Response(_) => None,
                    };
                    let answered = catch_unwind(AssertUnwindSafe(|| self.message(message)));
                    if let (Err(_), Some(id)) = (answered, id) {
                        self.refuse(id, ErrorCode::InternalError, "a bug of `mbs lsp`; it goes on".to_string());
                    }
                }
            }
        }
    }

    fn send(&self, message: impl Into<Message>) {
        // Where nobody reads, the end of the input is near.
        let _ = self.to_editor.send(message.into());
    }

    fn refuse(&self, id: RequestId, code: ErrorCode, reason: String) {
        self.send(Response::new_err(id, code as i32, reason));
    }

    /// For the editor's log.
    fn tell(&self, reason: &str) {
        self.send(Notification::new("window/logMessage".to_string(), json!({ "type": 2, "message": reason })));
    }

    fn message(&mut self, message: Message) {
        match message {
            Message::Request(request) => {
                let id = request.id.clone();
                match self.answer(request) {
                    Ok(result) => self.send(Response::new_ok(id, result)),
                    Err((code, reason)) => self.refuse(id, code, reason),
                }
            }
            Message::Notification(notification) => {
                let method = notification.method.clone();
                if let Err(reason) = self.note(notification) {
                    self.tell(&format!("{method}: {reason}"));
                }
            }
            Message::Response(_) => {}
        }
    }
}

// ---- what editors tell

/// Parameters of a message.
fn read<T: DeserializeOwned>(params: Value) -> Result<T, String> {
    serde_json::from_value(params).map_err(|error| error.to_string())
}

impl Server {
    fn note(&mut self, notification: Notification) -> Result<(), String> {
        let params = notification.params;
        match notification.method.as_str() {
            "textDocument/didOpen" => {
                let opened = read::<DidOpenTextDocumentParams>(params)?.text_document;
                let document = Document { uri: opened.uri, text: Text::new(opened.text), version: opened.version };
                let name = self.documents.insert(document);
                self.touch(&name);
            }
            "textDocument/didChange" => {
                let changes: DidChangeTextDocumentParams = read(params)?;
                let name = name_of(&changes.text_document.uri);
                let document = self.documents.get_mut(&name).ok_or_else(|| format!("{name} is not open"))?;
                document.version = changes.text_document.version;
                for change in changes.content_changes {
                    document.text.change(change);
                }
                self.touch(&name);
            }
            "textDocument/didClose" => {
                let name = name_of(&read::<DidCloseTextDocumentParams>(params)?.text_document.uri);
                self.touch(&name);
                self.documents.remove(&name);
                self.states.remove(&name);
                self.changed.remove(&name);
                self.show();
            }
            // What is on the disk counts where nothing is open.
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => self.changed.extend(self.documents.names()),
            _ => {}
        }
        Ok(())
    }

    /// A text has changed: what imports it is looked at again.
    fn touch(&mut self, name: &str) {
        self.quiet = Instant::now() + PAUSE;
        for other in self.documents.names() {
            let imports = self.states.get(&other).is_none_or(|state| state.problems.contains_key(name));
            if other == name || imports {
                self.changed.insert(other);
            }
        }
    }
}

// ---- what is wrong

impl Server {
    /// Looks at what has changed, and says what is wrong there.
    fn look(&mut self) {
        if self.changed.is_empty() {
            return;
        }
        for name in std::mem::take(&mut self.changed) {
            let Some(sources) = self.documents.sources(&name) else { continue };
            // What the proof has found holds while the texts are the same.
            if self.states.get(&name).is_some_and(|state| state.sources.as_ref() == Some(&sources)) {
                continue;
            }
            let seen = catch_unwind(AssertUnwindSafe(|| sources.surveyed()));
            let Ok((found, meanings)) = seen else {
                self.tell(&format!("{name}: a bug of mbs; please report this text"));
                continue;
            };
            let problems = problems(&Files::of(&sources), found.iter(), &self.documents);
            let found = found.iter().cloned().collect();
            let costs = self.states.remove(&name).map(|state| state.costs).unwrap_or_default();
            let state = State { sources: Some(sources), meanings, costs, problems, found, is_derived: false };
            self.states.insert(name, state);
        }
        self.show();
    }

    /// An open mechanism that is good, but not yet derived.
    fn waiting(&self) -> Option<String> {
        let is_good = |state: &State| state.found.iter().all(|message| message.severity == Severity::Warning);
        self.states.iter().find(|(_, state)| !state.is_derived && is_good(state)).map(|(name, _)| name.clone())
    }

    fn derive(&mut self, name: &str) {
        let Some(state) = self.states.get_mut(name) else { return };
        state.is_derived = true;
        let Some(sources) = state.sources.clone() else { return };
        let is_mechanism = outline::Outline::of(sources.main().text.as_deref().unwrap_or_default()).is_mechanism;
        if is_mechanism {
            let _ = self.jobs.send(Job { name: name.to_string(), sources });
        }
    }

    fn derived(&mut self, derived: Derived) {
        self.look();
        let Job { name, sources } = derived.job;
        let of_these = |state: &&mut State| state.sources.as_ref() == Some(&sources);
        let Some(state) = self.states.get_mut(&name).filter(of_these) else { return };
        state.costs = derived.costs;
        let known: Vec<&Diagnostic> = state.found.iter().collect();
        let new = derived.diagnostics.iter().filter(|message| !known.contains(message));
        let all: Vec<Diagnostic> = state.found.iter().chain(new).cloned().collect();
        state.problems = problems(&Files::of(&sources), all.iter(), &self.documents);
        state.found = all;
        self.show();
    }

    /// Sends what has changed of all that is wrong, each message once.
    fn show(&mut self) {
        let mut all: BTreeMap<String, Vec<Problem>> = BTreeMap::new();
        for (name, found) in self.states.values().flat_map(|state| &state.problems) {
            let here = all.entry(name.clone()).or_default();
            for problem in found {
                if !here.contains(problem) {
                    here.push(problem.clone());
                }
            }
        }
        let names: BTreeSet<String> = all.keys().chain(self.shown.keys()).cloned().collect();
        for name in names {
            let now = all.remove(&name).unwrap_or_default();
            let is_first = self.documents.get(&name).is_some() && !self.shown.contains_key(&name);
            if self.shown.get(&name).map_or(&[][..], Vec::as_slice) == now && !is_first {
                continue;
            }
            if let Some(uri) = self.documents.uri(&name) {
                let version = self.documents.get(&name).map(|document| document.version);
                let diagnostics = now.iter().map(|problem| problem.shown.clone()).collect();
                let params = PublishDiagnosticsParams { uri, diagnostics, version };
                self.send(Notification::new("textDocument/publishDiagnostics".to_string(), params));
            }
            match now.is_empty() && self.documents.get(&name).is_none() {
                true => drop(self.shown.remove(&name)),
                false => drop(self.shown.insert(name, now)),
            }
        }
    }
}

// ---- what editors ask

type Answer = Result<Value, (ErrorCode, String)>;

impl Server {
    fn answer(&mut self, request: Request) -> Answer {
        if request.method == "initialize" {
            return self.initialize(request.params);
        }
        if !self.is_initialized {
            return Err((ErrorCode::ServerNotInitialized, "`initialize` comes first".to_string()));
        }
        if self.is_shut_down {
            return Err((ErrorCode::InvalidRequest, "after `shutdown` comes `exit`".to_string()));
        }
        if request.method == "shutdown" {
            self.is_shut_down = true;
            return Ok(Value::Null);
        }
        // Answers are about the texts as they are now.
        self.look();
        let wrong = |reason| (ErrorCode::InvalidParams, reason);
        self.answer_about_a_file(&request.method, request.params)
            .map_err(wrong)?
            .unwrap_or_else(|| Err((ErrorCode::MethodNotFound, format!("there is no `{}`", request.method))))
    }

    fn initialize(&mut self, params: Value) -> Answer {
        let params: InitializeParams = read(params).map_err(|reason| (ErrorCode::InvalidParams, reason))?;
        let folders = params.workspace_folders.unwrap_or_default().into_iter().map(|folder| folder.uri);
        self.documents.folders = folders.map(|uri| name_of(&uri).into()).collect();
        self.is_initialized = true;
        Ok(json!({
            "serverInfo": { "name": "mbs", "version": env!("CARGO_PKG_VERSION") },
            "capabilities": {
                "positionEncoding": "utf-16",
                "textDocumentSync": { "openClose": true, "change": 2, "save": true },
                "hoverProvider": true,
                "definitionProvider": true,
                "referencesProvider": true,
                "documentHighlightProvider": true,
                "documentSymbolProvider": true,
                "documentFormattingProvider": true,
                "codeActionProvider": { "codeActionKinds": ["quickfix"] },
                "renameProvider": { "prepareProvider": true },
                "completionProvider": { "triggerCharacters": ["."] },
                "inlayHintProvider": true,
            },
        }))
    }

    /// Nothing where the method is not known.
    fn answer_about_a_file(&self, method: &str, params: Value) -> Result<Option<Answer>, String> {
        let value = |value: Option<Value>| Some(Ok(value.unwrap_or(Value::Null)));
        let at = |asked: TextDocumentPositionParams| (asked.text_document.uri, asked.position);
        Ok(match method {
            "textDocument/hover" => {
                let (uri, place) = at(read::<HoverParams>(params)?.text_document_position_params);
                value(self.view(&uri, |view| json!(view.hover(place))))
            }
            "textDocument/definition" => {
                let (uri, place) = at(read::<GotoDefinitionParams>(params)?.text_document_position_params);
                value(self.view(&uri, |view| json!(view.definition(place))))
            }
            "textDocument/references" => {
                let asked: ReferenceParams = read(params)?;
                let (uri, place) = at(asked.text_document_position);
                value(self.view(&uri, |view| json!(view.references(place, asked.context.include_declaration))))
            }
            "textDocument/documentHighlight" => {
                let (uri, place) = at(read::<HoverParams>(params)?.text_document_position_params);
                value(self.view(&uri, |view| highlights(view, place, &uri)))
            }
            "textDocument/prepareRename" => {
                let (uri, place) = at(read(params)?);
                value(self.view(&uri, |view| json!(view.renamable(place))))
            }
            "textDocument/rename" => {
                let asked: RenameParams = read(params)?;
                let (uri, place) = at(asked.text_document_position);
                let renamed = self.view(&uri, |view| view.renamed(place, &asked.new_name));
                match renamed {
                    Some(Ok(edits)) => Some(Ok(edits)),
                    Some(Err(reason)) => Some(Err((ErrorCode::RequestFailed, reason))),
                    None => value(None),
                }
            }
            "textDocument/completion" => {
                let (uri, place) = at(read::<CompletionParams>(params)?.text_document_position);
                value(self.view(&uri, |view| json!(view.completion(place))))
            }
            "textDocument/documentSymbol" => {
                let uri = read::<DocumentSymbolParams>(params)?.text_document.uri;
                value(self.view(&uri, |view| view.symbols()))
            }
            "textDocument/inlayHint" => {
                let asked: InlayHintParams = read(params)?;
                value(self.view(&asked.text_document.uri, |view| json!(view.hints(asked.range))))
            }
            "textDocument/codeAction" => {
                let asked: CodeActionParams = read(params)?;
                let uri = asked.text_document.uri;
                let problems = self.shown.get(&name_of(&uri)).map_or(&[][..], Vec::as_slice);
                value(Some(json!(problems::actions(&uri, problems, asked.range))))
            }
            "textDocument/formatting" => {
                let uri = read::<DocumentFormattingParams>(params)?.text_document.uri;
                value(self.formatted(&uri))
            }
            _ => None,
        })
    }

    /// What is asked of an open file.
    fn view<T>(&self, uri: &Uri, ask: impl FnOnce(&View<'_>) -> T) -> Option<T> {
        let name = name_of(uri);
        self.documents.get(&name)?;
        let sources = self.documents.sources(&name)?;
        let nothing = State::default();
        let state = self.states.get(&name).unwrap_or(&nothing);
        let files = Files::of(&sources);
        let (meanings, costs) = (state.meanings.as_slice(), state.costs.as_slice());
        Some(ask(&View { files: &files, meanings, costs, documents: &self.documents }))
    }

    /// One edit; none where nothing is to be changed, or the text cannot be read.
    fn formatted(&self, uri: &Uri) -> Option<Value> {
        let document = self.documents.get(&name_of(uri))?;
        let text = Sources::new("", &document.text.text).formatted().ok()?;
        let edit = TextEdit { range: document.text.whole(), new_text: text };
        Some(json!(if edit.new_text == document.text.text { Vec::new() } else { vec![edit] }))
    }
}

/// Where the name at a position stands in its own file.
fn highlights(view: &View<'_>, position: Position, uri: &Uri) -> Value {
    let places = view.references(position, true).unwrap_or_default().into_iter();
    let here = places.filter(|location| location.uri.as_str() == uri.as_str());
    here.map(|location| json!({ "range": location.range })).collect()
}
