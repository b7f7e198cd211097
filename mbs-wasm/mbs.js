/**
 * The generator of mbs in a page: text of a mechanism → proved equations → code, numbers, motion.
 *
 *     import { load } from "./mbs.js";
 *     const mbs = await load();
 *     const model = mbs.compile(text, { name: "pendulum.mbs" });
 *     model.evaluate("mass_matrix", { q: [0.3] });
 *     const motion = model.simulate({ q: { theta: 2 }, t_end: 10 });
 *     motion.columns.theta; // one number for each of motion.t
 *
 * Numbers are in SI units, angles in radians. Types are in `mbs.d.ts`, the manual is `docs/webassembly.md`.
 */

/** What everything here throws; `instanceof` tells which. */
export class MbsError extends Error {
  constructor(message) {
    super(message);
    this.name = new.target.name;
  }
}

/** The text is not a mechanism: `diagnostics` are what is wrong and where, `report` is that for people. */
export class ModelError extends MbsError {
  constructor({ message, report, diagnostics }) {
    super(message);
    this.report = report;
    this.diagnostics = diagnostics;
  }
}

/** An argument is not what it should be; the message begins with its name. */
export class InputError extends MbsError {}

/** A motion did not go on from `q`, `qd` at the time `t`. */
export class MotionError extends MbsError {
  constructor({ message, t, q, qd }) {
    super(message);
    Object.assign(this, { t, q, qd });
  }
}

/** A mistake of the generator itself. Models stay usable: they are compiled anew when they are used next. */
export class InternalError extends MbsError {}

/**
 * Loads the generator.
 * @param {URL | string | Response | BufferSource | WebAssembly.Module} [source] where `mbs_wasm.wasm` is, or what it is
 * @returns {Promise<Mbs>}
 */
export async function load(source = new URL("mbs_wasm.wasm", import.meta.url)) {
  return new Mbs(new Machine(await compiled(await source)));
}

async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (typeof source === "string" || source instanceof URL) {
    const url = new URL(source, import.meta.url);
    if (url.protocol === "file:") {
      const { readFile } = await import("node:fs/promises");
      return WebAssembly.compile(await readFile(url));
    }
    source = await fetch(url);
  }
  if (typeof Response !== "undefined" && source instanceof Response) {
    if (!source.ok) throw new InputError(`source: ${source.url} answers ${source.status}`);
    source = await source.arrayBuffer();
  }
  return WebAssembly.compile(source);
}

/** An instance of the WebAssembly, and a new one after it has trapped. */
class Machine {
  #module;
  #exports = null;

  constructor(module) {
    this.#module = module;
    this.epoch = 0;
    this.drive = null;
    this.exports;
  }

  /** What the present instance exports. */
  get exports() {
    if (this.#exports === null) {
      const drive = (...given) => (this.drive && exports === this.#exports ? this.drive(exports, ...given) : 0);
      const { exports } = new WebAssembly.Instance(this.#module, { mbs: { drive } });
      this.#exports = exports;
      this.epoch += 1;
    }
    return this.#exports;
  }

  /** Calls an export; a text that it answers comes back, errors are thrown. */
  call(name, ...given) {
    const status = this.guarded((exports) => exports[name](...given));
    const text = this.guarded((exports) => {
      const length = exports.text_length();
      return new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.text(length), length));
    });
    if (status !== 0) throw failure(JSON.parse(text));
    return text;
  }

  /** What traps leaves nothing behind that could be relied on: the next call finds a new instance. */
  guarded(call) {
    const { exports } = this;
    try {
      return call(exports);
    } catch (trap) {
      if (this.#exports === exports) this.#exports = null;
      const error = new InternalError(`${trap.message}${told(exports)}`);
      error.cause = trap;
      throw error;
    }
  }

  write(text) {
    const bytes = new TextEncoder().encode(text);
    this.guarded((exports) => {
      const place = exports.text(bytes.length);
      new Uint8Array(exports.memory.buffer, place, bytes.length).set(bytes);
    });
  }

  writeNumbers(numbers) {
    this.guarded((exports) => {
      const place = exports.numbers(numbers.length);
      new Float64Array(exports.memory.buffer, place, numbers.length).set(numbers);
    });
  }

  numbers() {
    return this.guarded((exports) => {
      const length = exports.numbers_length();
      return new Float64Array(exports.memory.buffer, exports.numbers(length), length).slice();
    });
  }
}

/** What a panic has left behind. */
function told(exports) {
  try {
    const length = exports.text_length();
    const bytes = new Uint8Array(exports.memory.buffer, exports.text(length), length);
    const answer = JSON.parse(new TextDecoder().decode(bytes));
    return answer.kind === "internal" ? `: ${answer.message}` : "";
  } catch {
    return ""; // there was no time to say anything
  }
}

function failure(error) {
  switch (error.kind) {
    case "model":
      return new ModelError(error);
    case "motion":
      return new MotionError(error);
    case "input":
      return new InputError(error.message);
    default:
      return new InternalError(error.message);
  }
}

const released = new FinalizationRegistry(({ machine, epoch, number }) => {
  if (machine.epoch === epoch) machine.exports.release(number);
});

/** The generator. */
class Mbs {
  #machine;

  constructor(machine) {
    this.#machine = machine;
  }

  /**
   * Reads, derives and proves a mechanism.
   * @param {string} text in the language of `docs/language.md`
   * @param {{ name?: string, files?: Record<string, string> }} [options] what reports call the text, and the texts of
   *     what it imports, by name
   * @returns {Model}
   */
  compile(text, options = {}) {
    const { name = "model.mbs", files = {} } = known("compile", options, ["name", "files"]);
    if (!isPlain(files)) throw new InputError(`files: it must be an object, found ${kind(files)}`);
    for (const [key, value] of [["text", text], ["name", name], ...Object.entries(files)]) {
      if (typeof value !== "string") throw new InputError(`${key}: it must be a string, found ${kind(value)}`);
    }
    return new Model(this.#machine, { name, text, files });
  }

  /** The memory that the generator has taken so far. */
  get memoryBuffer() {
    return this.#machine.exports.memory.buffer;
  }
}

/** A mechanism whose equations are proved. */
class Model {
  #machine;
  #request;
  #token = {};
  #place = null;

  constructor(machine, request) {
    this.#machine = machine;
    // Half a pair of code units is no text.
    const sound = (text) => new TextDecoder().decode(new TextEncoder().encode(text));
    const files = Object.fromEntries(Object.entries(request.files).map(([name, text]) => [name, sound(text)]));
    this.#request = JSON.stringify({ name: sound(request.name), text: sound(request.text), files });
    const description = this.#compile();
    const { functions, columns, coordinate_names, input_names, prescribed_names, parameter_names, ...rest } = description;
    Object.assign(this, rest);
    this.coordinateNames = coordinate_names;
    this.inputNames = input_names;
    this.prescribedNames = prescribed_names;
    this.parameterNames = parameter_names;
    this.functions = byName(functions.map((f, number) => [f.name, { ...f, number }]));
    this.columns = columns.map(([name, unit]) => ({ name, unit }));
  }

  #compile() {
    this.#machine.write(this.#request);
    const { number, description } = JSON.parse(this.#machine.call("compile"));
    this.#place = { machine: this.#machine, epoch: this.#machine.epoch, number };
    released.register(this, this.#place, this.#token);
    return description;
  }

  /** The number of the model; after a trap it is compiled anew. */
  get #number() {
    if (this.#place === null) throw new InputError("this model has been released");
    this.#machine.exports; // a new instance, if the last one has trapped
    if (this.#place.epoch !== this.#machine.epoch) this.#compile();
    return this.#place.number;
  }

  /** Forgets the model at once; else that is done when nothing refers to it any more. */
  free() {
    if (this.#place === null) return;
    released.unregister(this.#token);
    if (this.#place.epoch === this.#machine.epoch) this.#machine.exports.release(this.#place.number);
    this.#place = null;
  }

  /**
   * The model as code or as a page.
   * @param {"rust" | "c" | "latex" | "mathml" | "review"} language
   * @returns {string} what `mbs derive --emit` prints; `"mathml"` is the LaTeX as HTML
   */
  emit(language) {
    const number = this.#number;
    this.#machine.write(String(language));
    return this.#machine.call("print", number);
  }

  /** A module of Rust. */
  rust() {
    return this.emit("rust");
  }

  /** A document of LaTeX: symbols, energies, matrices, equations of motion. */
  latex() {
    return this.emit("latex");
  }

  /** What one call of each function costs, by name. */
  ops() {
    return byName(Object.values(this.functions).map((f) => [f.name, { ...f.operations }]));
  }

  /**
   * The value of a function at a state.
   * @param {string} name one of `functions`
   * @param {object} state `{ t, q, qd, qdd, u, params, prescribed }`, all but q optional
   * @returns a number, a `Float64Array` row by row, a pose, a wrench, or an object of named ones
   */
  evaluate(name, state = {}) {
    const f = this.functions[name];
    if (f === undefined) throw new InputError(`there is no function \`${name}\`; there are ${list(Object.keys(this.functions))}`);
    const numbers = this.#point("evaluate", state, []);
    const number = this.#number;
    this.#machine.writeNumbers(numbers);
    this.#machine.call("evaluate", number, f.number);
    return shaped(f.results, this.#machine.numbers());
  }

  /**
   * The linear system `d(q, q̇)/dt ≈ A (δq, δq̇) + B δu` about a state, A and B row by row.
   * @param {object} state as of `evaluate`
   */
  linearize(state) {
    const { q, qd, u } = this.evaluate("linearize", state);
    const [n, inputs] = [this.coordinateNames.length, this.inputNames.length];
    const [A, B] = [new Float64Array(4 * n * n), new Float64Array(2 * n * inputs)];
    for (let i = 0; i < n; i++) {
      A[i * 2 * n + n + i] = 1;
      A.set(q.subarray(i * n, (i + 1) * n), (n + i) * 2 * n);
      A.set(qd.subarray(i * n, (i + 1) * n), (n + i) * 2 * n + n);
      B.set(u.subarray(i * inputs, (i + 1) * inputs), (n + i) * inputs);
    }
    return { q, qd, u, A, B, states: 2 * n, inputs };
  }

  /**
   * A motion from a state to `t_end`, by the integrators of mbs-runtime.
   * @param {object} options see `mbs.d.ts`
   */
  simulate(options = {}) {
    const own = ["t_end", "dt", "method", "tolerance", "atol", "inputs", "events", "project", "redundant", "hold", "max_step"];
    const { inputs, u, prescribed, ...state } = known("simulate", options, [...STATE, ...own]);
    if (inputs !== undefined && u !== undefined) throw new InputError("inputs: they are given twice, as `inputs` and `u`");
    const signals = this.#signals(inputs ?? u, prescribed);
    const plain = Object.fromEntries(Object.entries(state).filter(([key]) => STATE.includes(key)));
    const numbers = this.#point("simulate", { ...plain, u: signals.u, prescribed: signals.prescribed }, []);
    const settings = this.#settings(options, numbers[0]);
    const number = this.#number;
    this.#machine.write(JSON.stringify(settings));
    this.#machine.writeNumbers(numbers);
    const summary = this.#driven(signals.drive, () =>
      JSON.parse(this.#machine.call("simulate", number, signals.drive !== null)),
    );
    return this.#motion(summary, this.#machine.numbers(), settings.events, options.events ?? []);
  }

  /** Lets the page give inputs during a call; what it throws is thrown here. */
  #driven(drive, call) {
    if (drive === null) return call();
    const machine = this.#machine;
    const outer = machine.drive;
    const n = this.coordinateNames.length;
    let thrown = null;
    machine.drive = ({ memory }, t, q, qd, u, inputs, prescribed) => {
      if (thrown !== null) return 0;
      const at = (place) => new Float64Array(memory.buffer, place, n).slice();
      try {
        const given = drive(t, at(q), at(qd), inputs);
        if (inputs > 0) new Float64Array(memory.buffer, u, inputs).set(given.u);
        new Float64Array(memory.buffer, prescribed, given.prescribed.length).set(given.prescribed);
        return 1;
      } catch (error) {
        thrown = { error };
        return 0;
      }
    };
    try {
      return call();
    } catch (error) {
      throw thrown === null ? error : thrown.error;
    } finally {
      machine.drive = outer;
    }
  }

  /** Inputs and prescribed motions at the start, and what gives them later, if they change. */
  #signals(inputs, prescribed) {
    const names = this.inputNames;
    const rates = (name, value) => {
      const three = typeof value === "number" ? [value, 0, 0] : value;
      if (!isList(three) || three.length !== 3) {
        throw new InputError(`prescribed.${name}: it must be a number, or [value, rate, acceleration]`);
      }
      return Array.from(three, (x) => finite(`prescribed.${name}`, x));
    };
    const whole = typeof inputs === "function";
    const each = whole ? [...names].fill(0) : signals("inputs", inputs, names, this.inputs);
    const motions = this.prescribedNames.map((name) => {
      const value = named("prescribed", prescribed ?? {}, this.prescribedNames, [])[name];
      return typeof value === "function" ? (t) => rates(name, value(t)) : () => rates(name, value ?? 0);
    });
    const moves = Object.values(prescribed ?? {}).some((value) => typeof value === "function");
    const drive = (t, q, qd, count) => {
      let u = [];
      if (count > 0 && whole) u = vector("inputs", inputs(t, q, qd), names, this.inputs);
      else if (count > 0) u = each.map((one, i) => (typeof one === "function" ? finite(`inputs.${names[i]}`, one(t, q, qd)) : one));
      return { u, prescribed: motions.flatMap((motion) => motion(t)) };
    };
    const drives = whole || moves || each.some((one) => typeof one === "function");
    const u = drives ? new Float64Array(names.length) : Float64Array.from(each);
    const start = drives ? [] : this.prescribedNames.map((name, i) => [name, motions[i](0)]);
    return { u, prescribed: Object.fromEntries(start), drive: drives ? drive : null };
  }

  #settings(options, t) {
    const { t_end, method = "dop853", tolerance = 1e-10, project = true, redundant = "refuse" } = options;
    const { atol = tolerance / 100, hold = [], events = [] } = options;
    finite("t_end", t_end);
    if (!Number.isFinite(t_end - t)) throw new InputError(`t_end: from ${t} to ${t_end} is too long a time to be a number`);
    const { dt = t_end > t ? (t_end - t) / 1000 : 1 } = options;
    const { max_step = dt } = options;
    const choice = (name, value, choices) => {
      if (!choices.includes(value)) throw new InputError(`${name}: it is one of ${choices.join(", ")}, found ${kind(value)}`);
      return value;
    };
    if (!isList(hold) || !isList(events)) throw new InputError("hold, events: they must be arrays");
    return {
      t_end,
      dt: finite("dt", dt),
      max_step: finite("max_step", max_step),
      method: choice("method", method, METHODS),
      rtol: finite("tolerance", tolerance),
      atol: finite("atol", atol),
      project: choice("project", project, [true, false]),
      redundant: choice("redundant", redundant, ["refuse", "least-norm"]) === "least-norm",
      hold: hold.map((name) => place("hold", name, this.coordinateNames)),
      events: events.map((event, i) => this.#event(`events[${i}]`, event)),
    };
  }

  #event(name, event) {
    const { of, value = 0, direction = "any", stop = false, multiply = {} } = known(name, event, [
      "of",
      "value",
      "direction",
      "stop",
      "multiply",
    ]);
    const sign = ["falling", "any", "rising"].indexOf(direction) - 1;
    if (sign < -1) throw new InputError(`${name}.direction: it is one of falling, any, rising, found ${kind(direction)}`);
    const velocities = this.coordinateNames.map((coordinate) => `${coordinate}_dot`);
    return {
      column: place(`${name}.of`, of, this.columns.map((column) => column.name)),
      value: finite(`${name}.value`, value),
      direction: sign,
      stop: Boolean(stop),
      multiply: Object.entries(named(`${name}.multiply`, multiply, velocities, [])).map(([velocity, factor]) => [
        velocities.indexOf(velocity),
        finite(`${name}.multiply.${velocity}`, factor),
      ]),
    };
  }

  #motion(summary, rows, settings, given) {
    const width = this.columns.length;
    const column = (i) => Float64Array.from({ length: rows.length / width }, (_, row) => rows[row * width + i]);
    const columns = byName(this.columns.map(({ name }, i) => [name, column(i)]));
    const events = summary.events.map(([event, t]) => ({ event, of: given[event].of, t }));
    return { t: columns.t, columns, units: byName(this.columns.map(({ name, unit }) => [name, unit])), events, summary: { ...summary, events: undefined } };
  }

  /** t, q, q̇, q̈, u, prescribed motions and parameters in one array. */
  #point(call, state, own) {
    const { t = 0, q, qd, qdd, u, params = {}, prescribed = {} } = known(call, state, [...STATE, ...own]);
    const names = this.coordinateNames;
    if (q === undefined && names.length > 0) throw new InputError(`q: it is missing, ${count(names)}`);
    const zero = (names) => new Float64Array(names.length);
    const coordinates = (key, value) => (value === undefined ? zero(names) : vector(key, value, names, this.coordinates));
    const signals = named("prescribed", prescribed, this.prescribedNames, []);
    const parts = [
      [finite("t", t)],
      coordinates("q", q),
      coordinates("qd", qd),
      coordinates("qdd", qdd),
      u === undefined ? zero(this.inputNames) : vector("u", u, this.inputNames, this.inputs),
      ...this.prescribedNames.map((name) => vector(`prescribed.${name}`, signals[name] ?? [0, 0, 0], ["value", "rate", "acceleration"], [])),
      this.#parameters(params),
    ];
    const numbers = new Float64Array(parts.reduce((sum, part) => sum + part.length, 0));
    let start = 0;
    for (const part of parts) {
      numbers.set(part, start);
      start += part.length;
    }
    return numbers;
  }

  #parameters(given) {
    if (isList(given)) return vector("params", given, this.parameterNames, this.parameters);
    const defaults = this.parameters.flatMap((parameter) => parameter.defaults);
    return vector("params", given, this.parameterNames, this.parameters, defaults);
  }
}

const STATE = ["t", "q", "qd", "qdd", "u", "params", "prescribed"];
const METHODS = ["dop853", "dopri5", "rk4", "gauss-legendre4", "stormer-verlet", "semi-implicit-euler"];

/** The object, if it has no other keys than these. */
function known(call, object, keys) {
  if (!isPlain(object)) throw new InputError(`${call}: it takes an object, found ${kind(object)}`);
  const other = Object.keys(object).find((key) => !keys.includes(key));
  if (other !== undefined) throw new InputError(`${call}: there is no \`${other}\`; there are ${keys.join(", ")}`);
  return object;
}

/** An object whose keys are these names, or those of whole arrays of variables; the answer inherits nothing. */
function named(key, object, names, variables) {
  if (!isPlain(object)) throw new InputError(`${key}: it must be an array or an object, found ${kind(object)}`);
  const wholes = variables.map((variable) => variable.name);
  const other = Object.keys(object).find((name) => !names.includes(name) && !wholes.includes(name));
  if (other !== undefined) throw new InputError(`${key}: there is no \`${other}\`; there ${names.length ? `are ${list(names)}` : "is none"}`);
  return byName(Object.entries(object));
}

/** Numbers in order, or by name; those that are not named are as given by `rest`, or zero. */
function vector(key, value, names, variables, rest = undefined) {
  if (isList(value)) {
    const flat = Array.from(value).flat(2);
    if (flat.length !== names.length) throw new InputError(`${key}: it must have ${count(names)}, found ${flat.length}`);
    return Float64Array.from(flat, (x, i) => finite(`${key}[${i}] (${names[i]})`, x));
  }
  const numbers = rest === undefined ? new Float64Array(names.length) : Float64Array.from(rest);
  const given = new Set();
  const fill = (first, values) => {
    for (const [i, x] of values.entries()) {
      const name = names[first + i];
      if (given.has(name)) throw new InputError(`${key}: \`${name}\` is given twice`);
      given.add(name);
      numbers[first + i] = x;
    }
  };
  for (const [name, part] of Object.entries(named(key, value, names, variables))) {
    const variable = variables.find((variable) => variable.name === name);
    if (variable !== undefined && variable.lengths.length > 0) {
      fill(variable.first, vector(`${key}.${name}`, isList(part) ? part : [part], variable.components, []));
    } else {
      fill(names.indexOf(name), [finite(`${key}.${name}`, part)]);
    }
  }
  return numbers;
}

/** Inputs over time, one by one: each a number, or a function of `(t, q, qd)`; zero where none is given. */
function signals(key, value, names, variables) {
  if (isList(value)) return Array.from(vector(key, value, names, variables));
  const found = [...names].fill(undefined);
  for (const [name, part] of Object.entries(named(key, value ?? {}, names, variables))) {
    if (part === undefined) continue;
    const array = variables.find((variable) => variable.name === name && variable.lengths.length > 0);
    if (array !== undefined && typeof part === "function") {
      throw new InputError(`${key}.${name}: it must be numbers; functions are given for one component, or for all inputs at once`);
    }
    const own = array === undefined
      ? [signal(`${key}.${name}`, part)]
      : Array.from(vector(`${key}.${name}`, isList(part) ? part : [part], array.components, []));
    for (const [i, one] of own.entries()) {
      const at = (array?.first ?? names.indexOf(name)) + i;
      if (found[at] !== undefined) throw new InputError(`${key}: \`${names[at]}\` is given twice`);
      found[at] = one;
    }
  }
  return found.map((one) => one ?? 0);
}

/** An input over time: a number, a table `[times, values]`, straight in between, or a function of `(t, q, qd)`. */
function signal(key, value) {
  if (typeof value === "function") return value;
  if (!isList(value)) return finite(key, value);
  const [times, values] = value;
  const sound = value.length === 2 && isList(times) && isList(values) && times.length === values.length && times.length > 1;
  if (!sound) throw new InputError(`${key}: a table is [times, values], each of the same two numbers or more`);
  const [x, y] = [times, values].map((list) => Float64Array.from(list, (number) => finite(key, number)));
  if (x.some((time, i) => i > 0 && time <= x[i - 1])) throw new InputError(`${key}: times must increase`);
  return (t) => {
    if (t < x[0] || t > x[x.length - 1]) throw new InputError(`${key}: the table goes from t = ${x[0]} to ${x[x.length - 1]}, asked for ${t}`);
    let i = Math.max(1, x.findIndex((time) => time >= t));
    return y[i - 1] + ((y[i] - y[i - 1]) * (t - x[i - 1])) / (x[i] - x[i - 1]);
  };
}

function place(key, name, names) {
  const i = names.indexOf(name);
  if (i < 0) throw new InputError(`${key}: there is no \`${name}\`; there are ${list(names)}`);
  return i;
}

function finite(key, value) {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new InputError(`${key}: it must be a finite number, found ${kind(value)}`);
  return value;
}

function isList(value) {
  return Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));
}

/** Whether an object is there for its keys: no list, no `Map`, no promise. */
function isPlain(value) {
  if (typeof value !== "object" || value === null || isList(value)) return false;
  const prototype = Object.getPrototypeOf(value);
  return prototype === null || Object.getPrototypeOf(prototype) === null;
}

function count(names) {
  return `${names.length} ${names.length === 1 ? "number" : "numbers"} (${list(names)})`;
}

function list(names) {
  return names.length > 12 ? `${names.slice(0, 12).join(", ")} … and ${names.length - 12} more` : names.join(", ");
}

function kind(value) {
  if (typeof value === "string") return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (isList(value)) return "an array";
  if (typeof value === "object" && value !== null) return isPlain(value) ? "an object" : `an object of type ${value.constructor?.name}`;
  return typeof value === "function" ? "a function" : String(value);
}

/** An object that has these entries and inherits nothing. */
function byName(entries) {
  const object = Object.create(null);
  for (const [name, value] of entries) object[name] = value;
  return object;
}

/** Results in their shape: one value, or an object of named ones. */
function shaped(results, numbers) {
  let start = 0;
  const take = (count) => numbers.slice(start, (start += count));
  const part = ({ kind, shape }) => {
    const size = shape.reduce((product, length) => product * length, 1);
    if (kind === "array") return take(size);
    if (kind === "number") return take(1)[0];
    const one = () => (kind === "pose" ? { position: take(3), rotation: take(9) } : { force: take(3), moment: take(3) });
    return shape.length === 0 ? one() : Array.from({ length: size }, one);
  };
  if (results.length === 1 && results[0].name === "") return part(results[0]);
  return Object.fromEntries(results.map((result) => [result.name, part(result)]));
}
