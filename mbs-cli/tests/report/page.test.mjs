// Pages in a real browser: they open without errors, show something, and their numbers are the Rust's.
// MBS_SHOTS=FOLDER keeps pictures of them. Times are printed; MBS_TIMES=1 holds them to their bounds, on a machine that does nothing else.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";

import { Window, browser } from "../../../mbs-wasm/tests/browser.mjs";
import { aboutOf, flat, mbs, page, stateOf } from "./support.mjs";

const skip = browser() === undefined && "there is no Chromium";

/** Mechanisms with the states that show them best. */
const SHOWN = [
  ["models/mechanisms/pendulum.mbs", { state: { q: [2.5] } }],
  ["models/mechanisms/double_pendulum.mbs", { state: { q: [2, 2.5] } }],
  ["models/mechanisms/four_bar.mbs", { state: { q: [1, 0.5, 1.5], qd: [8, 0, 0] }, end: 4 }],
  ["models/mechanisms/arm6.mbs", { state: { q: [0, -1, 0.5, 0, 0.3, 0] }, end: 3 }],
  ["models/mechanisms/quadrotor_quaternion.mbs", {
    state: { q: [0, 0, 5, 1, 0, 0, 0], qd: [2, 0, 0, 0, 0, 0, 0], u: [299, 299, 298, 298] },
    end: 4,
  }],
  ["models/mechanisms/stewart_platform.mbs", {
    state: { q: [0.1, 0, 1.1, 0.1, 0.15, 0.2], u: [1300, 1300, 1300, 1300, 1300, 1300] }, end: 0.5,
  }],
  ["models/mechanisms/two_body.mbs", {
    state: { q: [0, 0, 0, 3.844e8, 0, 0], qd: [0, -12.5, 0, 0, 1018, 0] }, end: 2360000,
  }],
  ["tests/mechanisms/rolling_coin.mbs", { state: { q: [0, 0, 0, 0.2, 0], qd: [0.2, 0, 2, 0, 16.7] }, end: 5 }],
];

/** What the page holds of a function at the start, and what it shows. */
const PROBE = `(() => {
  const { model, about, motion, firstFrame } = window.report;
  const { t, q, qd } = about.start;
  const values = Object.fromEntries(Object.keys(about.functions).map((name) => [name, model.call(name, t, q, qd)]));
  const picture = document.getElementById("view");
  const sample = motion.samples[Math.min(20, motion.samples.length - 1)];
  return { values, firstFrame, sample, error: motion.error?.message ?? null, width: picture.width, status: document.getElementById("status").textContent };
})()`;

/** How many frames are drawn in two seconds of moving, and how long one takes. */
const RATE = `new Promise((resolve) => {
  const { report } = window;
  report.play(true);
  const [start, first] = [performance.now(), report.frames];
  setTimeout(() => {
    const count = report.frames - first;
    const rate = (1000 * count) / (performance.now() - start);
    const begin = performance.now();
    for (let i = 0; i < 30; i++) { report.repaint(); report.paint(); }
    report.view.gl.finish();
    const pixel = new Uint8Array(4);
    report.view.gl.readPixels(0, 0, 1, 1, report.view.gl.RGBA, report.view.gl.UNSIGNED_BYTE, pixel);
    resolve({ rate, cost: (performance.now() - begin) / 30 });
  }, 2000);
})`;

function difference(a, b) {
  const size = Math.max(...a.map(Math.abs), ...b.map(Math.abs), 1e-300);
  return Math.max(0, ...a.map((x, i) => (Object.is(x, b[i]) || x === b[i] ? 0 : Math.abs(x - b[i]) / size)));
}

for (const [path, options] of SHOWN) {
  test(path, { skip }, async () => {
    const { file, html } = page(path, options);
    const about = aboutOf(html);
    const window = await Window.open(pathToFileURL(file).href, { width: 1400, height: 1000, webgl: true });
    try {
      await window.until("window.report?.motion.done && window.report.fitted && window.report.frames > 3");
      const { values, firstFrame, sample, error, status } = await window.evaluate(PROBE);
      assert.equal(error, null);
      if (process.env.MBS_TIMES) assert.ok(firstFrame <= 1000, `the first frame comes after ${firstFrame} ms`);

      // Functions and a sample of the motion as the Rust has them.
      const state = JSON.stringify(stateOf(about));
      const native = JSON.parse(mbs("eval", path, "--state", state, "--only", Object.keys(values).join(",")));
      for (const [name, value] of Object.entries(values)) {
        assert.ok(difference(flat(value), flat(native[name])) <= 1e-12, name);
      }
      const step = (about.end - about.start.t) / 1000;
      const csv = mbs("simulate", path, "--state", state, "--t-end", String(about.start.t + 20 * step), "--dt", String(step), "--redundant", "least-norm");
      const row = csv.trim().split("\n").at(-1).split(",").map(Number).slice(1, 1 + 2 * sample.q.length);
      assert.ok(difference([...sample.q, ...sample.qd], row) <= 1e-9, `${[...sample.q, ...sample.qd]} ${row}`);

      // Something is drawn, at a rate that is told.
      const shades = await window.evaluate(`(() => {
        const { gl } = window.report.view;
        window.report.repaint();
        window.report.paint();
        const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
        const pixels = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return new Set(new Uint32Array(pixels.buffer)).size;
      })()`);
      assert.ok(shades > 40, `${shades} shades`);
      const { rate, cost } = await window.evaluate(RATE);
      console.log(`${path}: first frame ${firstFrame.toFixed(0)} ms, ${rate.toFixed(0)} frames/s, ${cost.toFixed(1)} ms each; ${status}`);
      if (process.env.MBS_SHOTS) {
        await window.evaluate("window.report.scrub(window.report.motion.start + 0.35 * (window.report.motion.end - window.report.motion.start))");
        await window.evaluate("new Promise((resolve) => setTimeout(resolve, 300))");
        const name = path.split("/").at(-1).replace(".mbs", "");
        writeFileSync(join(process.env.MBS_SHOTS, `${name}.png`), await window.screenshot());
        if (process.env.MBS_SHOTS_ALL) writeFileSync(join(process.env.MBS_SHOTS, `${name}_all.png`), await window.screenshot(true));
      }
      assert.deepEqual(window.problems, []);
    } finally {
      await window.close();
    }
  });
}

test("sliders, keys and times", { skip }, async () => {
  const { file } = page("models/mechanisms/double_pendulum.mbs", { state: { q: [2, 2.5] }, name: "keys" });
  const window = await Window.open(pathToFileURL(file).href, { width: 1200, height: 900, dark: true, webgl: true });
  const key = async (name) => {
    for (const type of ["keyDown", "keyUp"]) await window.send("Input.dispatchKeyEvent", { type, key: name, text: type === "keyDown" && name.length === 1 ? name : undefined });
  };
  try {
    await window.until("window.report?.motion.done && window.report.fitted");
    const playing = () => window.evaluate("window.report.playing");
    assert.equal(await playing(), true);
    await key(" ");
    assert.equal(await playing(), false);
    await window.evaluate("window.report.scrub(1)");
    await key("ArrowRight");
    assert.ok(Math.abs((await window.evaluate("window.report.time")) - 1.1) < 1e-9);
    // The picture turns.
    const before = await window.evaluate('(document.getElementById("view").focus(), window.report.view.azimuth)');
    await key("ArrowLeft");
    assert.notEqual(await window.evaluate("window.report.view.azimuth"), before);
    // Every control is reached by the tabulator and has a name.
    const nameless = await window.evaluate(`Array.from(document.querySelectorAll("input, select, button")).filter((control) =>
      !(control.labels?.length || control.getAttribute("aria-label") || control.textContent.trim()) || control.tabIndex < 0).length`);
    assert.equal(nameless, 0);
    // A slider changes the motion; the button brings it back.
    const last = () => window.evaluate("window.report.motion.samples.at(-1).q[0]");
    const first = await last();
    await window.evaluate(`(() => {
      const field = document.getElementById("parameters-2");
      field.value = 0.5;
      field.dispatchEvent(new Event("input"));
    })()`);
    await window.until("window.report.motion.done");
    assert.notEqual(await last(), first);
    await window.evaluate('document.getElementById("reset").click()');
    await window.until("window.report.motion.done");
    assert.equal(await last(), first);
    // A state without a motion is said, and left again.
    await window.evaluate(`(() => {
      const field = document.getElementById("parameters-0");
      field.value = -1;
      field.dispatchEvent(new Event("input"));
    })()`);
    await window.until("window.report.motion.done");
    await window.evaluate('document.getElementById("reset").click()');
    await window.until("window.report.motion.done && window.report.fitted");
    assert.deepEqual(window.problems, []);
  } finally {
    await window.close();
  }
});
