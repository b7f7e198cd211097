// A motion from a start state, computed by the emitted functions and kept as samples of equal distance, as
// `mbs simulate` records it: the same integrator, the same projection onto constraints, at the same times.

import { Dop853 } from "./dop853.js";
import { project } from "./projection.js";

/** A motion that is nearer than this to its projection was off by the integrator's error alone. */
const NEAR = 1e-3;

/** The emitted class with the arguments that each function takes in their order. */
export class Model {
  /** `about` is the description that the page holds, `Mechanism` and `Scene` the emitted classes. */
  constructor(about, Mechanism, Scene) {
    Object.assign(this, { about, Mechanism, Scene });
    this.setParameters(about.parameters.flatMap(({ defaults }) => defaults));
    this.inputs = about.inputs.flatMap(({ names }) => names.map(() => 0));
    this.prescribed = about.prescribed.flatMap(({ names }) => names.map(() => [0, 0, 0]));
  }

  /** Parameters, flat. */
  setParameters(values) {
    this.parameters = Array.from(values);
    const shaped = [];
    for (const { first, names, lengths } of this.about.parameters) {
      const own = this.parameters.slice(first, first + names.length);
      const [, columns] = lengths;
      const rows = () => Array.from({ length: lengths[0] }, (_, i) => own.slice(i * columns, (i + 1) * columns));
      shaped.push(lengths.length === 0 ? own[0] : lengths.length === 1 ? own : rows());
    }
    // Fields are in the order of the declaration; their names are not always those.
    const of = (Class) => new Class(Object.fromEntries(Object.keys(Class.defaults()).map((field, i) => [field, shaped[i]])));
    this.mechanism = of(this.Mechanism);
    this.scene = of(this.Scene);
  }

  /** A function of the mechanism at a state. */
  call(name, t, q, qd, more = {}) {
    return this.invoke(this.mechanism, this.about.functions[name], t, q, qd, more);
  }

  /** A function of the scene. */
  see(name, t, q, qd) {
    return this.invoke(this.scene, this.about.scene.functions[name], t, q, qd, {});
  }

  invoke(object, { method, arguments: names }, t, q, qd, more) {
    const given = { t, q, qd, u: this.inputs, prescribed: this.prescribed, ...more };
    return object[method](...names.map((name) => given[name]));
  }

  /** What the projection asks for; undefined without constraints. */
  get constraints() {
    const { constraints: names, holonomic } = this.about;
    if (names.length === 0) return undefined;
    const zero = this.about.coordinates.flatMap(({ names }) => names.map(() => 0));
    return {
      names,
      holonomic,
      mass: (t, q) => this.call("mass_matrix", t, q, zero),
      position: (t, q) => this.call("constraint", t, q, zero),
      rate: (t, q, qd) => this.call("constraint_rate", t, q, qd),
      jacobian: (t, q) => this.call("constraint_jacobian", t, q, zero),
    };
  }
}

const largest = (values) => values.reduce((size, x) => Math.max(size, Math.abs(x)), 0);
const distance = (a, b) => a.reduce((size, x, i) => Math.max(size, Math.abs(x - b[i])), 0);

/** A motion that is computed piece by piece. */
export class Motion {
  /** From `{ t, q, qd }` to `end` in `count` equal steps; the first sample is the start, on the constraints. */
  constructor(model, start, end, count, tolerances) {
    Object.assign(this, { model, end, count, start: start.t ?? 0, samples: [], error: null });
    this.dt = (end - this.start) / count;
    this.constraints = model.constraints;
    let state = { q: Array.from(start.q), qd: Array.from(start.qd) };
    try {
      state = this.onConstraints(this.start, state, false);
      const acceleration = (t, q, qd) => model.call("forward_dynamics", t, q, qd);
      // As `mbs simulate` has it.
      const longest = Math.max(this.dt, 32 * Number.EPSILON * Math.max(Math.abs(this.start), Math.abs(end)));
      this.integrator = new Dop853(acceleration, this.start, state.q, state.qd, { longest, ...tolerances });
    } catch (error) {
      this.error = error;
    }
    this.samples.push({ t: this.start, ...state });
  }

  get done() {
    return this.error !== null || this.samples.length > this.count;
  }

  time(i) {
    return i === this.count ? this.end : this.start + i * this.dt;
  }

  onConstraints(t, state, isNear) {
    if (this.constraints === undefined) return state;
    const found = project(this.constraints, t, state);
    const near = (from, to) => distance(from, to) <= NEAR * (1 + largest(from));
    if (isNear && !(near(state.q, found.q) && near(state.qd, found.qd))) {
      throw new Error(`the nearest state on the constraints is far at t = ${t} s: they lose rank there`);
    }
    return found;
  }

  /** Goes on for about so many milliseconds; all the way without a number. */
  advance(milliseconds = Infinity) {
    const until = performance.now() + milliseconds;
    while (!this.done) {
      try {
        this.step();
      } catch (error) {
        this.error = error;
      }
      if (performance.now() > until) return;
    }
  }

  step() {
    const { integrator } = this;
    integrator.step(this.end);
    for (let t = this.time(this.samples.length); this.samples.length <= this.count && t <= integrator.t; ) {
      this.samples.push({ t, ...this.onConstraints(t, integrator.interpolate(t), true) });
      t = this.time(this.samples.length);
    }
    if (this.constraints !== undefined) {
      const { q, qd } = this.onConstraints(integrator.t, integrator, true);
      integrator.replace(q, qd);
    }
  }

  /** The state at a time, straight between samples. */
  at(t) {
    const { samples } = this;
    const place = Math.min(Math.max((t - this.start) / this.dt, 0), samples.length - 1);
    const i = Math.min(Math.floor(place), Math.max(0, samples.length - 2));
    const [a, b] = [samples[i], samples[Math.min(i + 1, samples.length - 1)]];
    const share = place - i;
    const between = (x, y) => x.map((value, k) => value + share * (y[k] - value));
    return { t: a.t + share * (b.t - a.t), q: between(a.q, b.q), qd: between(a.qd, b.qd) };
  }
}
