//! An editor with its server, as messages go between them.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};

use super::{place, range};
use crate::{Workshop, command};

/// Longer than any answer takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// An editor with its server.
pub(super) struct Editor {
    pub(super) child: Child,
    pub(super) input: Option<ChildStdin>,
    messages: Receiver<Value>,
    asked: i64,
    /// What is wrong in each file, as last told.
    pub(super) problems: BTreeMap<String, Vec<Value>>,
    versions: BTreeMap<String, i64>,
    pub(super) workshop: Workshop,
}

impl Editor {
    /// A conversation that has begun, about files in a workshop.
    pub(super) fn new(workshop: Workshop) -> Self {
        let mut editor = Editor::started(workshop);
        let folder = editor.uri("");
        let found = editor.ask(
            "initialize",
            json!({
                "processId": null, "rootUri": null, "capabilities": {},
                "workspaceFolders": [{ "uri": folder, "name": "workshop" }],
            }),
        );
        assert_eq!(found["capabilities"]["positionEncoding"], "utf-16");
        editor.tell("initialized", json!({}));
        editor
    }

    pub(super) fn started(workshop: Workshop) -> Self {
        let mut child = command(&workshop.path(""), &["lsp"]);
        let mut child =
            child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the server");
        let (input, output) = (child.stdin.take(), child.stdout.take().expect("its output"));
        let (send, messages) = channel();
        thread::spawn(move || {
            let mut output = BufReader::new(output);
            while let Some(message) = message(&mut output) {
                if send.send(message).is_err() {
                    return;
                }
            }
        });
        let (problems, versions) = (BTreeMap::new(), BTreeMap::new());
        Editor { child, input, messages, asked: 0, problems, versions, workshop }
    }

    pub(super) fn uri(&self, name: &str) -> String {
        format!("file://{}", self.workshop.path(name).display())
    }

    pub(super) fn raw(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().expect("an open conversation");
        input.write_all(bytes).and_then(|()| input.flush()).expect("somebody listens");
    }

    pub(super) fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    pub(super) fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// What has come, and what it says about the files.
    pub(super) fn next(&mut self) -> Value {
        let message = self.messages.recv_timeout(PATIENCE).expect("a message in time");
        if message["method"] == "textDocument/publishDiagnostics" {
            let uri = message["params"]["uri"].as_str().expect("a file").to_string();
            let found = message["params"]["diagnostics"].as_array().expect("a list").clone();
            self.problems.insert(uri, found);
        }
        let is_of_a_bug = message["method"] == "window/logMessage" && message.to_string().contains("a bug of");
        assert!(!is_of_a_bug, "{message}");
        message
    }

    /// The whole response.
    pub(super) fn response(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = self.asked;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.next();
            if message["id"] == id {
                return message;
            }
        }
    }

    #[track_caller]
    pub(super) fn ask(&mut self, method: &str, params: Value) -> Value {
        let response = self.response(method, params);
        assert_eq!(response["error"], Value::Null, "{method}");
        response["result"].clone()
    }

    #[track_caller]
    pub(super) fn refused(&mut self, method: &str, params: Value) -> String {
        let response = self.response(method, params);
        response["error"]["message"].as_str().unwrap_or_else(|| panic!("{method} is answered: {response}")).to_string()
    }

    pub(super) fn open(&mut self, name: &str, text: &str) {
        let uri = self.uri(name);
        self.versions.insert(name.to_string(), 1);
        let document = json!({ "uri": uri, "languageId": "mbs", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    pub(super) fn change(&mut self, name: &str, changes: Value) {
        let uri = self.uri(name);
        let version = self.versions.get_mut(name).expect("an open file");
        *version += 1;
        let document = json!({ "uri": uri, "version": *version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// What is wrong in a file now: an answer comes after all that was found.
    pub(super) fn problems(&mut self, name: &str) -> Vec<Value> {
        let uri = self.uri(name);
        self.ask(
            "textDocument/codeAction",
            json!({
                "textDocument": { "uri": uri }, "range": range(0, 0, 0, 0), "context": { "diagnostics": [] },
            }),
        );
        self.problems.get(&uri).cloned().unwrap_or_default()
    }

    /// The parameters of a question about the place in a file's text that is marked by `|`.
    pub(super) fn at(&self, name: &str, text: &str, marked: &str) -> Value {
        let (line, character) = place(text, marked);
        json!({ "textDocument": { "uri": self.uri(name) }, "position": { "line": line, "character": character } })
    }

    pub(super) fn hover(&mut self, name: &str, text: &str, marked: &str) -> String {
        let params = self.at(name, text, marked);
        let found = self.ask("textDocument/hover", params);
        found["contents"]["value"].as_str().unwrap_or_default().to_string()
    }

    pub(super) fn end(mut self) -> i32 {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        self.tell("exit", Value::Null);
        self.child.wait().expect("its end").code().expect("a code")
    }
}

/// One message; nothing at the end.
fn message(output: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim().split_once(": ") {
            Some((_, value)) => length = value.parse().ok()?,
            None => break,
        }
    }
    let mut content = vec![0; length];
    output.read_exact(&mut content).ok()?;
    serde_json::from_slice(&content).ok()
}
