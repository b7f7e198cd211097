// Bad input: an error that names it, and everything goes on.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";

import { InputError, InternalError, ModelError, load } from "../mbs.js";
import { mechanism, random, repository } from "./support.mjs";

let mbs;
before(async () => (mbs = await load()));

const SPRING = "mechanism Spring { param m: kg = 1; param k[2]: N/m = [4, 1]; coord x: m; input f: N; \
  kinetic += m*dt(x)^2/2; potential += (k[0] + k[1])*x^2/2; force x += f; }";

const isInput = (pattern) => (error) => {
  assert.ok(error instanceof InputError, `${error.stack}`);
  assert.match(error.message, pattern);
  return true;
};

test("every wrong declaration of the repository has its report", () => {
  const folder = join(repository, "tests/bad");
  const files = readdirSync(folder).filter((file) => file.endsWith(".mbs"));
  assert.ok(files.length > 150);
  for (const name of files) {
    const bytes = readFileSync(join(folder, name));
    const beside = Object.fromEntries(files.map((file) => [file, readFileSync(join(folder, file), "utf8")]));
    let error = null;
    try {
      const { warnings } = mbs.compile(bytes.toString("utf8"), { name, files: beside });
      assert.ok(warnings.length > 0 || /import|utf8/.test(name), `${name} is taken without a word`);
      continue;
    } catch (thrown) {
      error = thrown;
    }
    assert.ok(error instanceof ModelError, `${name}: ${error.stack}`);
    assert.match(error.report, /^error\[MBS\d{4}\]: |\nerror\[MBS\d{4}\]: /);
    for (const { file, line, column, length, start, end, message, severity } of error.diagnostics) {
      assert.ok(message.length > 0 && ["error", "warning"].includes(severity));
      if (file !== name) continue;
      const text = bytes.toString("utf8");
      // The place in lines and columns is the place in the string.
      const before = text.slice(0, start);
      assert.equal(line, before.split("\n").length, name);
      assert.equal(column, [...before.slice(before.lastIndexOf("\n") + 1)].length + 1, name);
      assert.equal(length, [...text.slice(start, end)].length, name);
      assert.ok(error.report.includes(`${name}:${line}:${column}`) || error.diagnostics.length > 20, `${name} ${line}`);
    }
  }
});

test("places count as JavaScript does", () => {
  const text = "// 🛰 ẋ\nmechanism A { coord x: m; kinetic += y; }";
  assert.throws(() => mbs.compile(text), (error) => {
    const [{ start, end, line, column }] = error.diagnostics;
    assert.deepEqual([text.slice(start, end), line, column], ["y", 2, 38]);
    return true;
  });
});

test("imports are among the files, or the report says so", () => {
  const { name, text, files } = mechanism("models/mechanisms/double_pendulum.mbs");
  const shared = "const g0: m/s^2 = 9.81;";
  const importing = `import "shared/g.mbs"; ${text.replace("= 9.81", "= g0")}`;
  assert.equal(mbs.compile(importing, { name, files: { "shared/g.mbs": shared } }).parameters.length, 5);
  assert.throws(() => mbs.compile(importing, { name, files }), (error) => error instanceof ModelError && /files/.test(error.report));
  const wrong = { "shared/g.mbs": "const g0: m/s^2 = ;" };
  assert.throws(() => mbs.compile(importing, { name, files: wrong }), (error) => error.diagnostics[0].file === "shared/g.mbs");
});

test("robots are imported", () => {
  const blocks = readFileSync(join(repository, "docs/import.md"), "utf8").split("```");
  const block = (fence) => blocks.find((block) => block.startsWith(fence)).slice(fence.length);
  const model = mbs.compile(block("mbs held_crane.mbs"), { files: { "crane.urdf": block("xml crane.urdf") } });
  assert.deepEqual(model.coordinateNames, ["luff"]);
});

test("arguments of compile", () => {
  assert.throws(() => mbs.compile(3), isInput(/^text: .* found 3$/));
  assert.throws(() => mbs.compile("", { name: null }), isInput(/^name/));
  assert.throws(() => mbs.compile("", { files: { "a.mbs": 1 } }), isInput(/^a\.mbs/));
  assert.throws(() => mbs.compile("", { file: {} }), isInput(/no `file`/));
  assert.throws(() => mbs.compile("", { files: null }), isInput(/^files: .* found null/));
  assert.throws(() => mbs.compile("", new Map()), isInput(/^compile: .* found an object of type Map/));
  assert.throws(() => mbs.compile(""), ModelError);
  assert.throws(() => mbs.compile("\ud800 mechanism"), ModelError);
  assert.throws(() => mbs.compile("mechanism A {".repeat(1000)), ModelError);
});

test("nesting beyond reason is refused, not a trap", () => {
  for (const [open, close] of [["(", ")"], ["[", "]"], ["-", ""], ["sin(", ")"], ["if true { 1 } else ", ""], ["1^", ""], ["{", "}"]]) {
    for (const depth of [50, 84, 255, 256, 257, 1000, 100_000]) {
      const text = `mechanism A { let x = ${open.repeat(depth)}1${close.repeat(depth)}; }`;
      assert.throws(() => mbs.compile(text), (error) => error instanceof ModelError, `${open} ${depth}`);
    }
  }
});

test("states", () => {
  const spring = mbs.compile(SPRING);
  const call = (state) => () => spring.evaluate("inverse_dynamics", state);
  assert.throws(call({}), isInput(/^q: it is missing, 1 number \(x\)/));
  assert.throws(call({ q: [1, 2] }), isInput(/^q: .*found 2/));
  assert.throws(call({ q: "1" }), isInput(/^q: .*found "1"/));
  assert.throws(call({ q: [NaN] }), isInput(/^q\[0\] \(x\)/));
  assert.throws(call({ q: [Infinity] }), isInput(/^q\[0\]/));
  assert.throws(call({ q: ["1"] }), isInput(/^q\[0\]/));
  assert.throws(call({ q: { y: 1 } }), isInput(/^q: there is no `y`; there are x/));
  assert.throws(call({ q: { x: null } }), isInput(/^q\.x/));
  assert.throws(call({ q: [1], qd: [] }), isInput(/^qd/));
  assert.throws(call({ q: [1], t: 1n }), isInput(/^t/));
  assert.throws(call({ q: [1], speed: 1 }), isInput(/no `speed`/));
  assert.throws(call({ q: [1], params: { m: -1 } }), isInput(/^params: `m` must .* it is -1/));
  assert.throws(call({ q: [1], params: { mass: 1 } }), isInput(/^params: there is no `mass`/));
  assert.throws(call({ q: [1], params: { k: [1] } }), isInput(/^params\.k: it must have 2 numbers/));
  assert.throws(call({ q: [1], params: { k_0: NaN } }), isInput(/^params\.k_0/));
  assert.throws(call({ q: [1], prescribed: { s: 1 } }), isInput(/^prescribed: there is no `s`; there is none/));
  assert.throws(call(null), isInput(/takes an object/));
  // What holds numbers, but has no keys.
  for (const q of [new Map([["x", 1]]), new Set([1]), new Float64Array(1).buffer, Promise.resolve([1])]) {
    assert.throws(call({ q }), isInput(new RegExp(`^q: .* found an object of type ${q.constructor.name}`)));
  }
  assert.throws(call({ q: [1], params: new Map([["m", 4]]) }), isInput(/^params: .* found an object of type Map/));
  for (const params of [{ k_0: 5, k: [1, 1] }, { k: [1, 1], k_0: 5 }]) {
    assert.throws(call({ q: [1], params }), isInput(/^params: `k_0` is given twice/));
  }
  assert.throws(() => spring.evaluate("mass", { q: [0] }), isInput(/no function `mass`; there are/));
  assert.throws(() => spring.evaluate("constructor", { q: [0] }), isInput(/no function/));
  assert.throws(() => spring.emit("cobol"), isInput(/no language `cobol`/));
  assert.deepEqual([...spring.evaluate("gravity", { q: { x: 2 }, params: { k_1: 3 } })], [14]);
  assert.deepEqual([...spring.evaluate("gravity", { q: new Float32Array([2]), params: [1, 2, 3] })], [10]);
});

test("motions", () => {
  const spring = mbs.compile(SPRING);
  const call = (options) => () => spring.simulate({ q: [1], t_end: 1, ...options });
  assert.throws(call({ t_end: undefined }), isInput(/^t_end/));
  assert.throws(call({ t_end: -1 }), isInput(/^t_end: -1/));
  assert.throws(call({ t_end: 1e308, t: -1e308 }), isInput(/^t_end/));
  assert.throws(call({ dt: 0 }), isInput(/^dt: .* found 0/));
  assert.throws(call({ dt: 1e-300 }), isInput(/^dt/));
  assert.throws(call({ dt: 1e-7 }), isInput(/rows/));
  assert.throws(call({ max_step: 0 }), isInput(/^max_step: .* found 0/));
  assert.throws(call({ tolerance: -1 }), isInput(/^tolerance/));
  assert.throws(call({ method: "euler" }), isInput(/^method: it is one of dop853/));
  assert.throws(call({ events: [{ of: "y" }] }), isInput(/^events\[0\]\.of: there is no `y`; there are t, x/));
  assert.throws(call({ events: [{ of: "x", direction: "up" }] }), isInput(/^events\[0\]\.direction/));
  assert.throws(call({ events: [{ of: "x", direction: "toString" }] }), isInput(/^events\[0\]\.direction/));
  assert.throws(call({ events: [{ of: "x", multiply: { x: 2 } }] }), isInput(/^events\[0\]\.multiply/));
  assert.throws(call({ events: [{ of: "x", multiply: null }] }), isInput(/^events\[0\]\.multiply: .* found null/));
  assert.throws(call({ inputs: async () => [1] }), isInput(/^inputs: .* found an object of type Promise/));
  assert.throws(call({ inputs: { g: 1 } }), isInput(/^inputs: there is no `g`; there are f/));
  assert.throws(call({ inputs: [1], u: [1] }), isInput(/twice/));
  assert.throws(call({ inputs: { f: [[0, 0], [1, 1]] } }), isInput(/times must increase/));
  assert.throws(call({ hold: ["y"] }), isInput(/^hold/));
  assert.throws(call({ redundant: true }), isInput(/^redundant/));
  assert.equal(spring.simulate({ q: [1], t_end: 0 }).t.length, 1);
});

test("random damage to texts is refused or taken, and never a trap", () => {
  const { text } = mechanism("tests/mechanisms/slider_crank.mbs");
  const next = random(18);
  const pieces = ["(", ")", "{", "}", ";", "*", "^", "-1e308", "0/0", "dt(", "[", "]", "q", "\u0000", "é", "1 m", "input", ":", "=", "\n"];
  const pick = (list) => list[Math.floor(next() * list.length)];
  let taken = 0;
  for (let i = 0; i < 120; i++) {
    let damaged = text;
    for (let j = 0; j <= 3 * next(); j++) {
      const place = Math.floor(next() * damaged.length);
      damaged = damaged.slice(0, place) + (next() < 0.6 ? pick(pieces) : "") + damaged.slice(place + Math.floor(4 * next()));
    }
    try {
      mbs.compile(damaged).free();
      taken += 1;
    } catch (error) {
      assert.ok(error instanceof ModelError, `${error.stack}\n${damaged}`);
    }
  }
  assert.ok(taken < 80, `${taken} are still mechanisms`);
});

test("a model that was released says so", () => {
  const spring = mbs.compile(SPRING);
  spring.free();
  spring.free();
  assert.throws(() => spring.evaluate("gravity", { q: [0] }), isInput(/released/));
  assert.throws(() => spring.rust(), isInput(/released/));
});

test("a trap ends one call, not the page", async () => {
  // No input that traps is known; a stack that was nearly used up before the call is.
  const own = await load();
  const spring = own.compile(SPRING);
  const before = spring.rust();
  const below = (frames, call) => (frames === 0 ? call() : below(frames - 1, call));
  const { text } = mechanism("models/mechanisms/double_pendulum.mbs");
  let traps = 0;
  for (let frames = 4000; traps < 3; frames += 100) {
    try {
      below(frames, () => own.compile(text).free());
    } catch (error) {
      assert.ok(error instanceof InternalError || error instanceof RangeError, error.stack);
      traps += 1;
      assert.equal(spring.rust(), before);
    }
  }
  assert.deepEqual([...spring.evaluate("gravity", { q: [2] })], [10]);
});

test("a panic leaves its message, and a module that traps is told apart from a mistake of the page", async () => {
  const wasm = await WebAssembly.compile(readFileSync(new URL("../mbs_wasm.wasm", import.meta.url)));
  const { exports } = await WebAssembly.instantiate(wasm, { mbs: { drive: () => 0 } });
  exports.text(0);
  assert.throws(() => exports.numbers(2 ** 32 - 1), WebAssembly.RuntimeError);
  const length = exports.text_length();
  const bytes = new Uint8Array(exports.memory.buffer, exports.text(length), length);
  const { kind, message } = JSON.parse(new TextDecoder().decode(bytes));
  assert.equal(kind, "internal");
  assert.match(message, /capacity overflow/);

  // The same exports, but all of them trap: functions of no arguments whose body is `unreachable`.
  const names = ["text", "text_length", "numbers", "numbers_length", "compile"];
  const section = (id, bytes) => [id, bytes.length, ...bytes];
  const exported = names.flatMap((name) => [name.length, ...new TextEncoder().encode(name), 0, 0]);
  const module = await WebAssembly.compile(Uint8Array.from([
    ...[0, 0x61, 0x73, 0x6d, 1, 0, 0, 0],
    ...section(1, [1, 0x60, 0, 0]),
    ...section(3, [1, 0]),
    ...section(7, [names.length, ...exported]),
    ...section(10, [1, 3, 0, 0, 0x0b]),
  ]));
  const broken = await load(module);
  assert.throws(() => broken.compile(SPRING), (error) => error instanceof InternalError && error.cause instanceof WebAssembly.RuntimeError);
});
