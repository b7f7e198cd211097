// Every mechanism of the repository in WebAssembly: what it computes has the bits that this machine computes, and what
// it prints is what the program `mbs` prints.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { promisify } from "node:util";

import { load } from "../mbs.js";
import { Native, bits, fromBits, mechanisms, random, repository } from "./support.mjs";

const STATES = 100;
const program = process.env.MBS_NATIVE ?? join(repository, "mbs-wasm/target/native/native");
const cli = process.env.MBS ?? join(repository, "target/release/mbs");

let mbs;
let native;
const measured = [];
before(async () => {
  mbs = await load();
  native = new Native(program);
});
after(() => {
  native.close();
  const sum = measured.reduce((sum, row) => sum + row.seconds, 0);
  const slowest = measured.sort((a, b) => b.seconds - a.seconds).slice(0, 3);
  console.log(
    `${measured.length} mechanisms derived and proved in ${sum.toFixed(1)} s; ` +
      `slowest ${slowest.map((row) => `${row.path} ${row.seconds.toFixed(1)} s`).join(", ")}`,
  );
});

/** States with their numbers in the order of the native program; every other one with other parameters. */
function states(model, next) {
  const spread = () => 4 * next() - 2;
  const list = (names) => names.map(spread);
  const defaults = model.parameters.flatMap((parameter) => parameter.defaults);
  return Array.from({ length: STATES }, (_, i) => {
    const n = model.coordinateNames;
    const state = { t: spread(), q: list(n), qd: list(n), qdd: list(n), u: list(model.inputNames) };
    const signals = model.prescribedNames.map((name) => [name, [spread(), spread(), spread()]]);
    const params = defaults.map((value) => (i % 2 ? value * (1 + 1e-4 * next()) : value));
    return {
      state: { ...state, params, prescribed: Object.fromEntries(signals) },
      numbers: [state.t, state.q, state.qd, state.qdd, state.u, signals.map(([, three]) => three), params].flat(3),
    };
  });
}

/** The numbers of a value, in order. */
function flat(value) {
  if (typeof value === "number") return [value];
  if (ArrayBuffer.isView(value)) return Array.from(value);
  return Object.values(value).flatMap(flat);
}

for (const [seed, { path, name, text, files }] of mechanisms().entries()) {
  test(`bits of ${path}`, async () => {
    const start = performance.now();
    const model = mbs.compile(text, { name, files });
    measured.push({ path, seconds: (performance.now() - start) / 1000 });
    const all = states(model, random(seed));
    const answer = native.ask({ name, text, files, states: all.map(({ numbers }) => numbers.map(bits)) });
    const found = all.map(({ state }) => Object.keys(model.functions).map((f) => flat(model.evaluate(f, state))));
    const { values } = await answer;
    let finite = 0;
    for (const [i, expected] of values.entries()) {
      for (const [f, function_] of Object.keys(model.functions).entries()) {
        const numbers = fromBits(expected[f]);
        assert.equal(found[i][f].length, numbers.length, `${function_} at state ${i}`);
        numbers.forEach((number, k) => {
          const same = Object.is(found[i][f][k], number);
          assert.ok(same, `${function_}[${k}] at state ${i}: ${found[i][f][k]} is not ${number}`);
          finite += Number.isFinite(number) ? 1 : 0;
        });
      }
    }
    assert.ok(finite > STATES, `only ${finite} finite numbers were compared`);
    model.free();
  });
}

/** Of one mechanism of each kind: all of them would be derived once more for each text. */
const printed = ["double_pendulum", "arm6", "four_bar", "quadrotor_quaternion", "heavy_top", "branches", "turntable", "keywords"];

test("code is that of the program mbs, byte by byte", { skip: !existsSync(cli) && `${cli} is not built` }, async () => {
  const cache = mkdtempSync(join(tmpdir(), "mbs-wasm-"));
  const run = promisify(execFile);
  const options = (folder) => ({ cwd: folder, maxBuffer: 1 << 28, env: { ...process.env, MBS_CACHE_DIR: cache } });
  try {
    for (const { folder, name, text, files } of mechanisms().filter(({ name }) => printed.includes(name.slice(0, -4)))) {
      const model = mbs.compile(text, { name, files });
      for (const language of ["rust", "c", "latex"]) {
        const { stdout } = await run(cli, ["derive", name, "--emit", language], options(folder));
        assert.ok(stdout.length > 1000 && model.emit(language) === stdout, `${name}: ${language}`);
      }
      const { stdout } = await run(cli, ["derive", name, "--review"], options(folder));
      // What a function gives at three states depends on the machine's sine.
      const signatures = (text) => text.split("\n").filter((line) => line.includes("pub fn "));
      assert.deepEqual(signatures(model.emit("review")), signatures(stdout), `${name}: review`);

      const names = Object.keys(model.functions);
      const [{ state, numbers }] = states(model, random(7));
      const params = Object.fromEntries(
        model.parameters.map(({ name, lengths, first, components }) => {
          const values = numbers.slice(numbers.length - state.params.length).slice(first, first + components.length);
          const rows = Array.from({ length: lengths[0] }, (_, i) => values.slice(i * lengths[1], (i + 1) * lengths[1]));
          return [name, [values[0], values, rows][lengths.length]];
        }),
      );
      const file = join(cache, "state.json");
      writeFileSync(file, JSON.stringify({ ...state, params }));
      const only = names.filter((name) => !["conserved", "linearize"].includes(name));
      const evaluated = JSON.parse((await run(cli, ["eval", name, "--state", file, "--only", only.join(",")], options(folder))).stdout);
      for (const function_ of only.filter((name) => !model.functions[name].arguments.includes("multipliers"))) {
        near(flat(model.evaluate(function_, state)), numbersOf(evaluated[function_]), `${name}: ${function_}`);
      }
      model.free();
    }
  } finally {
    rmSync(cache, { recursive: true });
  }
});

function numbersOf(value) {
  return typeof value === "object" && value !== null ? Object.values(value).flatMap(numbersOf) : [value];
}

/** The machine's own sine differs by an ulp, which a solution enlarges by the condition of its system. */
function near(found, expected, what) {
  assert.equal(found.length, expected.length, what);
  const size = Math.max(1, ...expected.map(Math.abs));
  expected.forEach((number, i) => {
    if (number === null) assert.ok(!Number.isFinite(found[i]), `${what}[${i}]: ${found[i]}`);
    else assert.ok(Math.abs(found[i] - number) <= 1e-9 * size, `${what}[${i}]: ${found[i]}, ${number}`);
  });
}

test("the stack suffices", () => {
  // The stack grows downwards from 1 MiB to 0, over memory that was zero: what was never reached still is.
  const memory = new Uint8Array(mbs.memoryBuffer, 0, 1 << 20);
  const reached = memory.length - memory.findIndex((byte) => byte !== 0);
  console.log(`of a stack of 1024 KiB ${Math.ceil(reached / 1024)} KiB were used`);
  assert.ok(reached < memory.length / 2, `${reached} bytes`);
});
