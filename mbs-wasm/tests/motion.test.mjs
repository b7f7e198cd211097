// Motions against what is known of them in closed form.

import assert from "node:assert/strict";
import { before, test } from "node:test";

import { InputError, MotionError, load } from "../mbs.js";
import { mechanism } from "./support.mjs";

let mbs;
before(async () => (mbs = await load()));

function model(path) {
  const { name, text, files } = mechanism(path);
  return mbs.compile(text, { name, files });
}

const pendulum = () => model("models/mechanisms/pendulum.mbs");

/** K(k) by the arithmetic–geometric mean. Source: Abramowitz & Stegun, Handbook of Mathematical Functions, 17.6.3. */
function completeEllipticIntegral(k) {
  let [a, b] = [1, Math.sqrt(1 - k * k)];
  while (Math.abs(a - b) > 1e-15 * a) [a, b] = [(a + b) / 2, Math.sqrt(a * b)];
  return Math.PI / (2 * a);
}

/** sn(u, k) by descending Landen transformations. Source: Abramowitz & Stegun, 16.4.2 and 16.4.3. */
function sn(u, k) {
  const [a, c] = [[1], [k]];
  for (let b = Math.sqrt(1 - k * k); Math.abs(c.at(-1)) > 1e-16; ) {
    const last = a.at(-1);
    c.push((last - b) / 2);
    a.push((last + b) / 2);
    b = Math.sqrt(last * b);
  }
  let phi = 2 ** (a.length - 1) * a.at(-1) * u;
  for (let n = a.length - 1; n > 0; n--) phi = (phi + Math.asin((c[n] / a[n]) * Math.sin(phi))) / 2;
  return Math.sin(phi);
}

test("a pendulum swings as Jacobi's elliptic function, and keeps its energy", () => {
  const [amplitude, g] = [2.5, 9.81];
  const motion = pendulum().simulate({ q: [amplitude], t_end: 20, dt: 0.05, tolerance: 1e-12 });
  // Landau & Lifshitz, Mechanics, section 11: sin(θ/2) = k sn(K − ω t, k), k = sin(θ₀/2), for l = 1 m.
  const [k, omega] = [Math.sin(amplitude / 2), Math.sqrt(g)];
  const quarter = completeEllipticIntegral(k);
  motion.t.forEach((t, i) => {
    const expected = 2 * Math.asin(k * sn(quarter - omega * t, k));
    assert.ok(Math.abs(motion.columns.theta[i] - expected) < 1e-8, `${t}: ${motion.columns.theta[i]}, ${expected}`);
  });
  const { energy } = motion.columns;
  assert.ok(Math.abs(energy[0] + g * Math.cos(amplitude)) < 1e-14);
  // Between its steps the method is of order 7 and loses two digits.
  for (const e of energy) assert.ok(Math.abs(e - energy[0]) < 1e-9, `${e - energy[0]}`);
  assert.equal(motion.t.length, 401);
  assert.equal(motion.units.theta_dot, "rad/s");
});

test("its period is 4 K/ω, as an event finds it", () => {
  const events = [{ of: "theta_dot", direction: "falling" }];
  const motion = pendulum().simulate({ q: [-1], t_end: 30, tolerance: 1e-12, events });
  const period = (4 * completeEllipticIntegral(Math.sin(0.5))) / Math.sqrt(9.81);
  assert.ok(motion.events.length > 10);
  motion.events.forEach(({ of, t }, i) => {
    assert.equal(of, "theta_dot");
    assert.ok(Math.abs(t - (i + 0.5) * period) < 1e-9 * (i + 1), `${t}`);
  });
});

test("every method goes to the same place", () => {
  const swing = pendulum();
  const end = (options) => swing.simulate({ q: [1], t_end: 2, ...options }).columns.theta.at(-1);
  const exact = 2 * Math.asin(Math.sin(0.5) * sn(completeEllipticIntegral(Math.sin(0.5)) - 2 * Math.sqrt(9.81), Math.sin(0.5)));
  const bounds = { dop853: 1e-9, dopri5: 1e-8, rk4: 1e-9, "gauss-legendre4": 1e-8, "stormer-verlet": 1e-5, "semi-implicit-euler": 1e-2 };
  for (const [method, bound] of Object.entries(bounds)) {
    const error = Math.abs(end({ method, dt: 0.002 }) - exact);
    assert.ok(error < bound, `${method}: ${error}`);
  }
});

test("linkages stay closed, and keep their energy", () => {
  const fourBar = model("models/mechanisms/four_bar.mbs");
  const start = { q: { crank: 1, coupler: 0.5, rocker: 1.5 }, qd: { crank: 6 }, hold: ["crank"] };
  const motion = fourBar.simulate({ ...start, t_end: 3 });
  assert.equal(motion.summary.assembled, true);
  assert.equal(motion.columns.crank[0], 1);
  const rows = Object.keys(motion.columns).filter((name) => name.startsWith("residual_"));
  assert.equal(rows.length, fourBar.constraints.length);
  // Units are written as the language does, those of what is computed, too.
  const units = [...Object.values(motion.units), ...fourBar.constraints.flatMap((row) => [row.unit, row.multiplier_unit])];
  assert.match(units.join(" "), /^[ -~]*kg\*m\/s\^2[ -~]*$/);
  for (const row of rows) motion.columns[row].forEach((x) => assert.ok(Math.abs(x) < 1e-12, `${row} ${x}`));
  const { energy } = motion.columns;
  for (const e of energy) assert.ok(Math.abs(e - energy[0]) < 1e-8 * Math.abs(energy[0]));
  const moved = Math.max(...motion.columns.crank) - Math.min(...motion.columns.crank);
  assert.ok(moved > 1, `the crank has turned by ${moved}`);
});

/** A ball above a floor, whose height is known in closed form between bounces. */
const BALL = "mechanism Ball { param m: kg = 2; param g: m/s^2 = 10; coord z: m; input push: N; \
  kinetic += m*dt(z)^2/2; potential += m*g*z; force z += push; }";

test("a ball bounces where it should", () => {
  const ball = mbs.compile(BALL);
  const events = [{ of: "z", direction: "falling", multiply: { z_dot: -0.5 } }];
  const motion = ball.simulate({ q: [5], t_end: 2.7, events });
  // Falls 1 s, then bounces with half the speed: 1 s and 1/2 s in the air.
  assert.equal(motion.events.length, 3);
  [1, 2, 2.5].forEach((t, i) => assert.ok(Math.abs(motion.events[i].t - t) < 1e-12, `${motion.events[i].t}`));
  const t = motion.t.at(-1) - 2.5;
  assert.ok(Math.abs(motion.columns.z.at(-1) - (1.25 * t - 5 * t * t)) < 1e-10);
  const stopped = ball.simulate({ q: [5], t_end: 9, events: [{ of: "z", stop: true }] });
  assert.ok(stopped.summary.stopped && Math.abs(stopped.t.at(-1) - 1) < 1e-12);
  // Where a row is due at the event, it stands there once.
  const even = mbs.compile("mechanism Even { coord x: m; kinetic += 1 kg*dt(x)^2/2; }");
  const met = [{ of: "x", value: 0.5, stop: true, multiply: { x_dot: -1 } }];
  const hit = even.simulate({ q: [0], qd: [1], t_end: 1, dt: 0.25, method: "rk4", events: met });
  assert.deepEqual([[...hit.t], [...hit.columns.x_dot], hit.summary.rows], [[0, 0.25, 0.5], [1, 1, -1], 3]);
});

test("inputs are numbers, tables, or functions", () => {
  const ball = mbs.compile(BALL);
  const end = (inputs) => ball.simulate({ q: [0], t_end: 2, inputs, tolerance: 1e-12 }).columns.z.at(-1);
  const near = (found, expected) => assert.ok(Math.abs(found - expected) < 1e-9, `${found}, ${expected}`);
  near(end([30]), 10); // z̈ = 5
  near(end({ push: 30 }), 10);
  near(end({ push: [[0, 2], [20, 50]] }), 10 / 3 + 20 / 3); // z̈ = 7.5 t
  near(end({ push: (t) => 20 + 15 * t }), 10);
  near(end(() => [30]), 10);
  // Gravity computed by the model itself while it moves, and a spring: z = 1 − cos t.
  near(end((t, q) => [ball.evaluate("gravity", { q, t })[0] + 2 * (1 - q[0])]), 1 - Math.cos(2));
});

test("inputs of an array, and beside what is prescribed", () => {
  const pair = mbs.compile("mechanism Pair { const m: kg = 2; const k: N/m = 1; coord x[2]: m; input f[2]: N; prescribed s: m; \
    for i in 0..2 { kinetic += m*dt(x[i])^2/2; force x[i] += f[i] + k*s; } }");
  const rest = (t) => [0 * t, 0, 0];
  for (const inputs of [[4, 8], { f: [4, 8] }, { f_0: 4, f_1: () => 8 }, { f_1: 8, f_0: [[0, 1], [4, 4]] }, () => [4, 8]]) {
    for (const prescribed of [{}, { s: rest }]) {
      const { columns } = pair.simulate({ q: [0, 0], t_end: 1, inputs, prescribed });
      [columns.x_0, columns.x_1].forEach((x, i) => assert.ok(Math.abs(x.at(-1) - (i + 1)) < 1e-9, `${x.at(-1)}`));
    }
  }
  const refused = (inputs) => assert.throws(() => pair.simulate({ q: [0, 0], t_end: 1, inputs, prescribed: { s: rest } }), { name: "InputError" });
  [[4], [4, 8, 1], { f: [4] }, { f: () => [4, 8] }, { f: [4, 8], f_1: 8 }, { f: [4, NaN] }].forEach(refused);
});

test("what comes and goes between two steps is not stepped over", () => {
  const ball = mbs.compile(BALL);
  const inputs = { push: (t) => 20 + (t > 5 && t < 6.5 ? 2 : 0) };
  for (const method of ["dop853", "dopri5"]) {
    const end = (options) => ball.simulate({ q: [0], t_end: 10, inputs, method, ...options }).columns.z.at(-1);
    // z̈ = 1 for 1.5 s, then 3.5 s at 1.5 m/s.
    assert.ok(Math.abs(end({}) - 6.375) < 1e-6, `${end({})}`);
    assert.ok(Math.abs(end({ dt: 10, max_step: 0.1 }) - 6.375) < 1e-6);
  }
});

test("prescribed motions", () => {
  const shaken = mbs.compile("mechanism Shaken { param m: kg = 1; param k: N/m = 4; coord x: m; prescribed s: m; \
    kinetic += m*dt(x)^2/2; potential += k*(x - s)^2/2; }");
  const stays = shaken.simulate({ q: [0], t_end: 1, prescribed: { s: 0.5 }, tolerance: 1e-12 });
  assert.ok(Math.abs(stays.columns.x.at(-1) - 0.5 * (1 - Math.cos(2))) < 1e-10);
  // ẍ + 4 x = 4 sin t from rest: x = (4/3) sin t − (2/3) sin 2t.
  const s = (t) => [Math.sin(t), Math.cos(t), -Math.sin(t)];
  const moves = shaken.simulate({ q: [0], t_end: 1, prescribed: { s }, tolerance: 1e-12 });
  assert.ok(Math.abs(moves.columns.x.at(-1) - (4 * Math.sin(1) - 2 * Math.sin(2)) / 3) < 1e-10);
});

test("linearized about the rest below", () => {
  const { A, B } = pendulum().linearize({ q: [0], params: { l: 2, m: 3 } });
  [0, 1, -9.81 / 2, 0].forEach((x, i) => assert.ok(Math.abs(A[i] - x) < 1e-15, `${A}`));
  assert.ok(Math.abs(B[1] - 1 / 12) < 1e-16 && B[0] === 0);
});

/** A table on three parallel cranks; state: the angles of the cranks, middle and inclination of the table. */
const PARALLEL = `mechanism Parallel {
    param m: kg = 2;
    param l: m = 0.5;
    param w: m = 1;
    param g: m/s^2 = 9.81;
    coord a[3]: rad;
    coord x: m;
    coord z: m;
    coord phi: rad;
    fn along(angle, length) = [length*cos(angle), 0, length*sin(angle)];
    for i in 0..3 {
        kinetic += 1/12*m*l^2*dt(a[i])^2;
    }
    kinetic += 1/2*m*(dt(x)^2 + dt(z)^2) + 1/24*m*w^2*dt(phi)^2;
    potential += m*g*z;
    constraint left: [x, 0, z] = along(phi, w/2) + along(a[0], l);
    constraint middle: [x, 0, z] = [w/2, 0, 0] + along(a[1], l);
    constraint right: [x, 0, z] = [w, 0, 0] - along(phi, w/2) + along(a[2], l);
}`;

test("what stops a motion is told", () => {
  const sling = mbs.compile("mechanism Sling { param m: kg = 1; param k: J = 1; coord x: m; kinetic += m*dt(x)^2/2; \
    potential += k*ln(x/(1 m)); }");
  const falls = () => sling.simulate({ q: [1], t_end: 10 });
  assert.throws(falls, (error) => error instanceof MotionError && error.t > 1 && error.t < 2 && error.q[0] < 1);

  // A table on three cranks: the third bears nothing that the others could not.
  const table = mbs.compile(PARALLEL);
  const start = { q: [1, 1, 1, 0.5 + Math.cos(1) / 2, Math.sin(1) / 2, 0], t_end: 0.3 };
  const turned = (redundant) => table.simulate({ ...start, redundant }).columns;
  assert.throws(() => turned("refuse"), (error) => error instanceof MotionError && /^constraint `.*` depends/.test(error.message));
  const { a_0, a_2, energy } = turned("least-norm");
  assert.ok(Math.abs(a_0.at(-1) - a_2.at(-1)) < 1e-9 && Math.abs(energy.at(-1) - energy[0]) < 1e-9);

  const open = model("models/mechanisms/four_bar.mbs");
  const far = () => open.simulate({ q: [0, 0, 0], params: { ground: 10 }, t_end: 1 });
  assert.throws(far, (error) => error instanceof MotionError && /closure/.test(error.message));
});

test("what a page throws while it gives inputs comes through", () => {
  const ball = mbs.compile(BALL);
  const own = new RangeError("mine");
  const thrown = (inputs) => () => ball.simulate({ q: [0], t_end: 1, inputs });
  assert.throws(thrown(() => { throw own; }), own);
  assert.throws(thrown(() => [NaN]), (error) => error instanceof InputError && /push/.test(error.message));
  assert.throws(thrown({ push: () => "1" }), InputError);
  assert.throws(thrown({ push: [[0, 0.5], [1, 1]] }), (error) => error instanceof InputError && /goes from/.test(error.message));
  assert.ok(Math.abs(ball.simulate({ q: [1], t_end: 0.1 }).columns.z.at(-1) - 0.95) < 1e-12);
});
