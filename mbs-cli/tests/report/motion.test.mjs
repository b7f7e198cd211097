// The numbers of pages, without a browser: functions against `mbs eval`, motions against `mbs simulate`, for every
// mechanism of the repository.

import assert from "node:assert/strict";
import { readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

import { aboutOf, flat, mbs, page, repository, scriptsOf, stateOf } from "./support.mjs";

const FOLDERS = ["models/mechanisms", "tests/mechanisms"];
const TOLERANCE = 1e-12;

/** Where the state that is chosen by itself leads nowhere soon: a coin that does not roll falls flat. */
const STATES = { "tests/mechanisms/rolling_coin.mbs": { q: [0, 0, 0, 0.2, 0], qd: [0.2, 0, 2, 0, 16.7] } };

/** Those that need no table beside them and are mechanisms by themselves. */
const mechanisms = FOLDERS.flatMap((folder) =>
  readdirSync(join(repository, folder)).filter((file) => file.endsWith(".mbs")).map((file) => `${folder}/${file}`),
);

/** The largest difference of two lists, in units of the largest number. */
function difference(a, b) {
  assert.equal(a.length, b.length);
  const size = Math.max(...a.map(Math.abs), ...b.map(Math.abs), 1e-300);
  return Math.max(0, ...a.map((x, i) => (Object.is(x, b[i]) || x === b[i] ? 0 : Math.abs(x - b[i]) / size)));
}

/** The largest difference of the columns of two tables, in units of the largest number of the column, or of one. */
function apart(rows, others) {
  assert.equal(rows.length, others.length);
  return Math.max(
    ...rows[0].map((_, column) => {
      const size = Math.max(1, ...others.map((row) => Math.abs(row[column])));
      return Math.max(...rows.map((row, i) => Math.abs(row[column] - others[i][column]) / size));
    }),
  );
}

/** Times of a motion in which rounding does not grow: the chaotic ones are short. */
const end = (about) => (about.start.q.some((x) => Math.abs(x) > 1e5) ? 1000 : 0.5);

for (const path of mechanisms) {
  test(path, async () => {
    const { html } = page(path, { end: 1, state: STATES[path] });
    const about = aboutOf(html);
    const { Mechanism, Scene, Model, Motion } = await scriptsOf(html, path);
    const model = new Model(about, Mechanism, Scene);
    const state = stateOf(about);

    // Functions where the motion begins.
    const { t, q, qd } = about.start;
    const names = Object.keys(about.functions);
    const values = JSON.parse(mbs("eval", path, "--state", JSON.stringify(state), "--only", names.join(",")));
    model.prescribed = about.start.prescribed;
    for (const name of names) {
      const [own, native] = [flat(model.call(name, t, q, qd)), flat(values[name])];
      assert.ok(difference(own, native) <= TOLERANCE, `${name}: ${own} ${native}`);
    }

    // The picture: what places and bodies are made of is finite.
    for (const name of Object.keys(about.scene.functions)) {
      assert.ok(flat(model.see(name, t, q, qd)).every(Number.isFinite), name);
    }

    // The motion.
    const last = t + end(about);
    const rows = 50;
    const motion = new Motion(model, { t, q, qd }, last, rows);
    motion.advance();
    const step = (last - t) / rows;
    let csv;
    try {
      csv = mbs("simulate", path, "--state", JSON.stringify(state), "--t-end", String(last), "--dt", String(step), "--redundant", "least-norm");
    } catch (error) {
      // Where there is no way on, there is none here.
      assert.ok(motion.error !== null, `${error.stderr}`);
      return;
    }
    assert.equal(motion.error, null);
    const table = csv.trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
    table.forEach((row, i) => assert.equal(row[0], motion.samples[i].t));
    const own = motion.samples.map((sample) => [...sample.q, ...sample.qd]);
    const worst = apart(own, table.map((row) => row.slice(1, 1 + 2 * q.length)));
    // What a few roundings of the first state make of the motion is no difference of the two.
    const moved = new Motion(model, { t, q: q.map((x, i) => x + (i % 2 ? -16 : 16) * Number.EPSILON * Math.max(1, Math.abs(x))), qd }, last, rows);
    moved.advance();
    const grown = apart(own, moved.samples.map((sample) => [...sample.q, ...sample.qd]));
    assert.ok(worst <= Math.max(TOLERANCE, 10 * grown), `they differ by ${worst}, roundings make ${grown}`);
  });
}

test("a report of the arm is small", () => {
  const { file } = page("models/mechanisms/arm6.mbs");
  assert.ok(statSync(file).size <= 3_000_000, `${statSync(file).size} bytes`);
});

test("ellipsoids have the inertia that they are drawn for", async () => {
  const { html } = page("models/mechanisms/pendulum.mbs");
  const { ellipsoid, principal } = await scriptsOf(html, "ellipsoid");
  const inertia = [2.0, 1.5, 1.8, 0.3, -0.2, 0.1];
  const [xx, yy, zz, xy, xz, yz] = inertia;
  const { axes, vectors } = ellipsoid(3, inertia);
  // I = m/5 (b² + c²) about the first axis.
  const own = axes.map((_, i) => (3 / 5) * (axes[(i + 1) % 3] ** 2 + axes[(i + 2) % 3] ** 2));
  const matrix = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
  for (let i = 0; i < 3; i++) {
    for (let j = 0; j < 3; j++) {
      const back = own.reduce((sum, value, k) => sum + value * vectors[i][k] * vectors[j][k], 0);
      assert.ok(Math.abs(back - matrix[i][j]) < 1e-14, `${i} ${j}: ${back}`);
    }
  }
  assert.deepEqual(principal([[1, 0, 0], [0, 2, 0], [0, 0, 3]]).values, [1, 2, 3]);
  assert.equal(ellipsoid(0, inertia), undefined);
});
