// Animations in Khronos' validator, and where their bodies are.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { test } from "node:test";

import { folder, mbs, page, aboutOf, scriptsOf, stateOf } from "./support.mjs";

const require = createRequire(join(process.env.GLTF_VALIDATOR ?? process.cwd(), "/"));
let validator;
try {
  validator = require("gltf-validator");
} catch {
  // It is said below.
}
const skip = validator === undefined && "gltf-validator is not installed, see GLTF_VALIDATOR";

const MOTIONS = [
  ["models/mechanisms/pendulum.mbs", 2],
  ["models/mechanisms/double_pendulum.mbs", 2],
  ["models/mechanisms/four_bar.mbs", 1],
  ["models/mechanisms/arm6.mbs", 1],
  ["models/mechanisms/quadrotor_quaternion.mbs", 1],
  ["models/mechanisms/stewart_platform.mbs", 0.2],
  ["models/mechanisms/two_body.mbs", 2000],
  // At rest it falls flat.
  ["tests/mechanisms/rolling_coin.mbs", 0.2, { q: [0, 0, 0, 0.2, 0], qd: [0.2, 0, 2, 0, 16.7] }],
];

/** The parts of a binary file. */
function parts(file) {
  const bytes = readFileSync(file);
  assert.equal(bytes.toString("latin1", 0, 4), "glTF");
  const length = bytes.readUInt32LE(12);
  const binary = 20 + length + 8;
  return { bytes, json: JSON.parse(bytes.toString("utf8", 20, 20 + length)), binary: bytes.subarray(binary) };
}

function numbers({ json, binary }, accessor) {
  const { bufferView, count, type } = json.accessors[accessor];
  const { byteOffset, byteLength } = json.bufferViews[bufferView];
  assert.equal(byteLength, 4 * count * { SCALAR: 1, VEC3: 3, VEC4: 4 }[type]);
  return Array.from({ length: byteLength / 4 }, (_, i) => binary.readFloatLE(byteOffset + 4 * i));
}

for (const [path, end, state] of MOTIONS) {
  test(path, async (context) => {
    const { html } = page(path, { end, state });
    const about = aboutOf(html);
    const file = join(folder, `${path.replaceAll("/", "_")}.glb`);
    mbs("simulate", path, "--state", JSON.stringify(stateOf(about)), "--t-end", String(end), "--dt", String(end / 40), "--redundant", "least-norm", "--gltf", file);
    const all = parts(file);
    const { json } = all;
    assert.equal(json.animations.length, 1);

    // The first body's path is that of its mass centre as the page has it.
    const { Mechanism, Scene, Model, Motion } = await scriptsOf(html, `${path}.gltf`);
    const model = new Model(about, Mechanism, Scene);
    model.inputs = about.start.u;
    model.prescribed = about.start.prescribed;
    const motion = new Motion(model, about.start, end, 40);
    motion.advance();
    const node = json.nodes.findIndex(({ name }) => name?.startsWith("body"));
    const channel = json.animations[0].channels.find(({ target }) => target.node === node && target.path === "translation");
    const track = channel && numbers(all, json.animations[0].samplers[channel.sampler].output);
    for (const [i, { t, q, qd }] of motion.samples.entries()) {
      const [frames, bodies] = ["frames", "bodies"].map((name) => model.see(name, t, q, qd));
      const body = Number(json.nodes[node].name.split(" ")[1]) - 1;
      const { position, rotation } = frames[about.scene.bodies[body].frame];
      const centre = bodies.slice(10 * body + 1, 10 * body + 4);
      const place = position.map((x, k) => x + rotation[k].reduce((sum, r, j) => sum + r * centre[j], 0));
      const found = track?.slice(3 * i, 3 * i + 3) ?? json.nodes[node].translation;
      const size = Math.max(...place.map(Math.abs), 1e-3);
      place.forEach((x, k) => assert.ok(Math.abs(x - found[k]) < 1e-6 * size, `${place} ${found}`));
    }

    if (skip) return context.diagnostic(`skipped: the validator, ${skip}`);
    const report = await validator.validateBytes(new Uint8Array(all.bytes), { maxIssues: 20 });
    assert.deepEqual([report.issues.numErrors, report.issues.numWarnings], [0, 0], JSON.stringify(report.issues.messages));
    return undefined;
  });
}
