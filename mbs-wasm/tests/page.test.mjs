// The page in a real browser: it derives, moves, shows equations, and underlines what is wrong.
// MBS_SHOTS=FOLDER keeps pictures of it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { load } from "../mbs.js";
import { examples } from "../../docs/playground/examples.js";
import { Window, browser, serve } from "./browser.mjs";
import { mechanism, mechanisms, repository } from "./support.mjs";

const skip = browser() === undefined && "there is no Chromium";
let server;
before(async () => (server = await serve(repository)));
after(() => server.close());

async function opened(query, use) {
  const window = await Window.open(`http://127.0.0.1:${server.address().port}/docs/playground/${query}`);
  try {
    await window.until('document.getElementById("energy").textContent.includes("accelerations")');
    await use(window);
    if (process.env.MBS_SHOTS) {
      writeFileSync(join(process.env.MBS_SHOTS, `${query.replace(/\W+/g, "_") || "page"}.png`), await window.screenshot());
    }
    assert.deepEqual(window.problems, []);
  } finally {
    await window.close();
  }
}

test("it derives, proves and moves", { skip }, () =>
  opened("", async (window) => {
    const report = await window.evaluate('document.getElementById("report").textContent');
    assert.match(report, /DoublePendulum: 2 coordinates, derived and proved at \d+ states/);
    const energy = await window.evaluate('document.getElementById("energy").textContent');
    const [, drift] = /at most (\S+) J/.exec(energy);
    assert.ok(Number(drift.replace("−", "-")) < 1e-6, energy);
    // Something is drawn: more than one colour on the canvas.
    const colours = await window.evaluate(`(() => {
      const canvas = document.querySelector("canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return new Set(new Uint32Array(data.buffer)).size;
    })()`);
    assert.ok(colours > 20, `${colours} colours`);
    // A slider changes the motion.
    await window.evaluate(`(() => {
      const range = document.querySelectorAll('#controls input[type="range"]')[4];
      range.value = 0; // gravity
      range.dispatchEvent(new Event("input"));
    })()`);
    await window.until(`document.getElementById("energy").textContent !== ${JSON.stringify(energy)}`);
  }));

test("of two examples that are chosen in a row the second is shown", { skip }, () =>
  opened("", async (window) => {
    // The first answer comes last.
    await window.evaluate(`(() => {
      const [answered, waits] = [fetch, [300, 0]];
      globalThis.fetch = async (address) => {
        await new Promise((resolve) => setTimeout(resolve, waits.shift()));
        return answered(address);
      };
      const menu = document.getElementById("examples");
      for (menu.value of ["1", "2"]) menu.dispatchEvent(new Event("change"));
    })()`);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    const shown = await window.evaluate('document.getElementById("text").value');
    assert.equal(shown, mechanism(`models/mechanisms/${examples[2].file}`).text);
  }));

test("equations are typeset", { skip }, () =>
  opened("?tab=equations&example=four_bar.mbs", async (window) => {
    await window.until('document.querySelectorAll("#equations math").length > 30');
    const high = await window.evaluate('document.querySelector("#equations mfrac").getBoundingClientRect().height');
    assert.ok(high > 14, `a fraction is ${high} pixels high`);
    assert.equal(await window.evaluate('getComputedStyle(document.getElementById("motion")).display'), "none");
  }));

test("what is wrong is underlined, and gone when it is mended", { skip }, () =>
  opened("?example=pendulum.mbs", async (window) => {
    const edit = (from, to) => window.evaluate(`(() => {
      const text = document.getElementById("text");
      text.value = text.value.replace(${JSON.stringify(from)}, ${JSON.stringify(to)});
      text.dispatchEvent(new Event("input"));
    })()`);
    await edit("bob.z", "bob");
    await window.until('document.querySelector("#marks mark.error")');
    const [mark, text] = await window.evaluate(`(() => {
      const mark = document.querySelector("#marks mark").getBoundingClientRect();
      const text = document.getElementById("text").getBoundingClientRect();
      return [[mark.x - text.x, mark.y - text.y, mark.width], document.querySelector("#marks mark").textContent];
    })()`);
    assert.ok(mark[2] > 5 && text.length > 0);
    assert.match(await window.evaluate('document.getElementById("report").textContent'), /pendulum\.mbs:\d+:\d+/);
    await edit("bob;", "bob.z;");
    await window.until('document.querySelector("#marks mark") === null');
    await window.until('document.querySelector("#report .good")');
  }));

test("every example of the menu can be compiled and moves", async () => {
  const mbs = await load();
  for (const { file, q, qd, t_end, hold } of examples) {
    const { name, text, files } = mechanism(`models/mechanisms/${file}`);
    const model = mbs.compile(text, { name, files: {} });
    assert.ok(!/^\s*import/m.test(text), `${file} imports`);
    const start = { q: q ?? model.coordinateNames.map(() => 0.3), qd, hold, redundant: "least-norm" };
    const motion = model.simulate({ ...start, t_end, dt: t_end / 100 });
    assert.equal(motion.summary.time, t_end, file);
    model.free();
  }
});

/** Among them every command that mbs writes occurs. */
const written = /^(arm6|arm6_params|branches|cart_with_five_links|cr3bp|four_bar|furuta_pendulum|heavy_top|irb7600|measured_slider|moving_frame|n_pendulum|quadrotor_euler|relative_isotropic|slow_frame)\.mbs$/;

test("equations as MathML are sound HTML", async () => {
  const mbs = await load();
  const chosen = mechanisms().filter(({ name }) => written.test(name));
  assert.equal(chosen.length, 15);
  for (const { name, text, files } of chosen) {
    const model = mbs.compile(text, { name, files });
    const html = model.emit("mathml");
    model.free();
    assert.doesNotMatch(html, /\\[a-zA-Z]|\$/, name);
    const open = [];
    for (const [, close, tag] of html.matchAll(/<(\/?)([a-z0-9]+)[^>]*>/g)) {
      if (close === "") open.push(tag);
      else assert.equal(open.pop(), tag, name);
    }
    assert.deepEqual(open, [], name);
  }
});

test("the folder that ci.sh makes works by itself", { skip }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "mbs-site-"));
  const own = await serve(folder);
  try {
    execFileSync(join(repository, "mbs-wasm/ci.sh"), ["site", folder]);
    const window = await Window.open(`http://127.0.0.1:${own.address().port}/`);
    try {
      await window.until('document.getElementById("energy")?.textContent.includes("accelerations")');
      assert.deepEqual(window.problems, []);
    } finally {
      await window.close();
    }
  } finally {
    own.close();
    rmSync(folder, { recursive: true });
  }
});
