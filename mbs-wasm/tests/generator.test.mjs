// What the page asks its worker, with a worker that is none.

import assert from "node:assert/strict";
import { test } from "node:test";

test("stopped is stopped, and the next question brings the model along", async () => {
  const asked = [];
  globalThis.Worker = class {
    constructor() {
      asked.push("worker");
    }
    postMessage({ call, given }) {
      asked.push(`${call} ${given.text ?? given.t_end ?? given.language}`);
      if (given.t_end !== Infinity) this.timer = setTimeout(() => this.onmessage({ data: { result: call } }), 1);
    }
    terminate() {
      clearTimeout(this.timer);
    }
  };
  const { Generator } = await import("../../docs/playground/generator.js");
  const generator = new Generator(() => {});
  const stopped = (answer) => answer.then(assert.fail, ({ message }) => assert.equal(message, "stopped"));
  assert.equal(await generator.ask("compile", { text: "a" }), "compile");
  const endless = [generator.ask("simulate", { t_end: Infinity }), generator.ask("emit", { language: "c" })];
  generator.stop();
  await stopped(endless[0]);
  assert.equal(await endless[1], undefined);
  await new Promise((resolve) => setTimeout(resolve, 20));
  assert.deepEqual(asked, ["worker", "compile a", "simulate Infinity", "worker"]);
  assert.equal(await generator.ask("simulate", { t_end: 1 }), "simulate");
  assert.equal(await generator.ask("emit", { language: "c" }), "emit");
  assert.deepEqual(asked.slice(4), ["compile a", "simulate 1", "emit c"]);
  // Stopped while the model comes along.
  generator.stop();
  const waiting = generator.ask("simulate", { t_end: 1 });
  generator.stop();
  assert.equal(await waiting, undefined);
  // Another text takes the model's place.
  assert.equal(await generator.ask("compile", { text: "b" }), "compile");
  assert.deepEqual(asked.slice(7), ["worker", "compile a", "worker", "compile b"]);
});
