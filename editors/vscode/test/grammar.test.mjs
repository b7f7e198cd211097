// The files of the extension are what VS Code asks for, and its grammar knows every text of the repository.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { readFileSync, readdirSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { join } from "node:path";
import test from "node:test";

const require = createRequire(import.meta.url);
const here = fileURLToPath(new URL("..", import.meta.url));
const root = join(here, "..", "..");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");
const oniguruma = require("vscode-oniguruma");

const read = (...path) => readFileSync(join(...path), "utf8");
const json = (name) => JSON.parse(read(here, name));

async function grammar() {
  const wasm = readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(read(here, "syntaxes/mbs.tmLanguage.json"), "mbs.tmLanguage.json"),
  });
  return registry.loadGrammar("source.mbs");
}
const loaded = grammar();

/** Text and innermost scope of every token that is not white space. */
async function tokens(text) {
  const found = [];
  let stack = INITIAL;
  for (const line of text.split(/\r?\n/)) {
    const result = (await loaded).tokenizeLine(line, stack);
    stack = result.ruleStack;
    for (const token of result.tokens) {
      const piece = line.slice(token.startIndex, token.endIndex);
      if (piece.trim() !== "") found.push([piece.trim(), token.scopes.at(-1), token.scopes]);
    }
  }
  return found;
}

function* mechanisms() {
  const skipped = new Set(["target", "node_modules", "bad", ".git"]);
  const folders = ["models", "tests/mechanisms", "tests/platform", "tests/misprints", "examples", "mbs-cli/tests"];
  const waiting = folders.map((folder) => join(root, folder));
  while (waiting.length > 0) {
    const folder = waiting.pop();
    for (const entry of readdirSync(folder, { withFileTypes: true })) {
      if (entry.isDirectory() && !skipped.has(entry.name)) waiting.push(join(folder, entry.name));
      if (entry.name.endsWith(".mbs")) yield [entry.name, read(folder, entry.name)];
    }
  }
  const manual = read(root, "docs/language.md") + read(root, "README.md");
  for (const block of manual.matchAll(/^```mbs( [^\n]*\.mbs)?\n([^]*?)^```/gm)) yield ["a block of the manual", block[2]];
}

test("the files are JSON and name files that are there", () => {
  const { contributes, main, dependencies } = json("package.json");
  assert.deepEqual(Object.keys(dependencies), ["vscode-languageclient"]);
  assert.equal(contributes.languages[0].extensions[0], ".mbs");
  for (const path of [main, contributes.languages[0].configuration, contributes.grammars[0].path]) read(here, path);
  const { comments, wordPattern } = json("language-configuration.json");
  assert.equal(comments.lineComment, "//");
  assert.match("tau_2", new RegExp(`^${wordPattern}$`));
});

test("the client starts the server, and says so where it cannot", async () => {
  const Module = require("node:module");
  const [started, stopped, said, registered] = [[], [], [], []];
  let fails = false;
  class LanguageClient {
    constructor(...settings) { this.settings = settings; }
    async start() {
      if (fails) throw new Error("not found");
      started.push(this.settings);
    }
    needsStop() { return true; }
    async stop() { stopped.push(this.settings); }
  }
  const vscode = {
    commands: { registerCommand: (name, run) => registered.push([name, run]) },
    window: { showErrorMessage: (text) => said.push(text) },
    workspace: {
      getConfiguration: () => ({ get: () => "/opt/mbs" }),
      createFileSystemWatcher: (pattern) => pattern,
    },
  };
  const load = Module._load;
  Module._load = (name, ...rest) =>
    name === "vscode" ? vscode : name === "vscode-languageclient/node" ? { LanguageClient } : load(name, ...rest);
  try {
    const client = require(join(here, "client.js"));
    await client.activate({ subscriptions: [] });
    assert.deepEqual(started[0][2], { command: "/opt/mbs", args: ["lsp"] });
    await registered[0][1]();
    assert.equal(started.length, 2);
    await client.deactivate();
    await client.deactivate();
    assert.equal(stopped.length, 2);
    fails = true;
    await client.activate({ subscriptions: [] });
    assert.match(said[0], /does not start \(not found\)/);
  } finally {
    Module._load = load;
  }
});

test("every token of every good model has a scope, and none is wrong", async () => {
  let count = 0;
  for (const [name, text] of mechanisms()) {
    for (const [piece, scope, scopes] of await tokens(text)) {
      assert.ok(scopes.length > 1, `${name}: \`${piece}\` has no scope`);
      assert.ok(!scope.startsWith("invalid"), `${name}: \`${piece}\` is ${scope}`);
    }
    count += 1;
  }
  assert.ok(count > 100, `${count} models`);
});

test("words are told apart by what stands around them", async () => {
  const check = async (text, expected) => {
    const found = (await tokens(text)).map(([piece, scope]) => `${piece} ${scope.replace(/\.mbs$/, "")}`);
    for (const one of expected) assert.ok(found.includes(one), `${text}: ${one} is not in ${found.join(", ")}`);
  };
  await check("param m: kg*m^2 = 0.3 kg*m;", [
    "param storage.type", "m variable.other.declaration", "kg support.type.unit", "m support.type.unit",
    "0.3 constant.numeric", "kg*m support.type.unit",
  ]);
  await check("let a = 0.3 kg*x + 2 kg * m;", ["kg support.type.unit", "x variable.other", "m variable.other"]);
  await check("gravity [0, 0, -g];", ["gravity keyword.other.statement"]);
  await check("let b = gravity + 1;", ["gravity variable.other"]);
  await check("force at body.point(p) += F;", [
    "at keyword.other.at", "body variable.other", "point entity.name.function.member", "+= keyword.operator.assignment",
  ]);
  await check("let c = sin(t) + mine(pi);", [
    "sin support.function", "t constant.language", "mine entity.name.function.call", "pi constant.language",
  ]);
  await check("/// doc\n//// none\n/* a /* b */ c */ let", [
    "/// doc comment.line.documentation", "//// none comment.line.double-slash", "c comment.block", "let storage.type",
  ]);
  await check("for i in 0..6 { }", ["for keyword.control", "0 constant.numeric", ".. keyword.operator.range"]);
  await check('shape arm += mesh("a b.stl", 2);', [
    "shape keyword.other.statement", "mesh support.function", '"a b.stl" string.quoted.double', "2 constant.numeric",
  ]);
  await check("param l: m = 1, positive;", ["positive storage.modifier"]);
  await check("param l: m = 1, positive // longer\n;", ["positive storage.modifier"]);
  await check("reaction hinge[i] at link;", [
    "reaction keyword.other.statement", "hinge variable.other.declaration", "i variable.other", "at keyword.other.at",
    "link variable.other",
  ]);
  await check("let shape = 2; output o = shape*at;", ["shape variable.other.declaration", "shape variable.other", "at variable.other"]);
  await check("link arm[i + 1](m, world); link hand(m, arm);", [
    "link entity.name.function", "arm variable.other.declaration", "m variable.other", "hand variable.other.declaration",
  ]);
  await check("if a < b { } else if (a < c) { }", ["else keyword.control", "if keyword.control"]);
});

test("both grammars know every function of the language", () => {
  const words = read(root, "mbs-cli/src/lsp/words.rs");
  const functions = words.slice(words.indexOf("const FUNCTIONS"), words.indexOf("const METHODS"));
  const query = read(root, "editors/tree-sitter-mbs/queries/highlights.scm");
  const support = json("syntaxes/mbs.tmLanguage.json").repository.values.patterns.find(({ name }) => name === "support.function.mbs");
  const names = [...functions.matchAll(/\("(\w+)", "/g)].map(([, name]) => name);
  assert.ok(names.length > 40, `${names}`);
  for (const name of names) {
    assert.ok(query.includes(`"${name}"`), `tree-sitter: ${name}`);
    assert.match(`${name}(`, new RegExp(support.match), `TextMate: ${name}`);
  }
});

test("what has no meaning is marked", async () => {
  for (const wrong of ["let a = x ** 2;", "let a = θ;", "a -= 1;", "let a = 1 $ 2;"]) {
    assert.ok((await tokens(wrong)).some(([, scope]) => scope.startsWith("invalid")), wrong);
  }
});
