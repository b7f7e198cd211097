// The page: sliders, the motion from there, the picture and the plots of it.

import { Model, Motion } from "./motion.js";
import { Phase, Plot, number } from "./plot.js";
import { add, ellipsoid, pose, solid, turned } from "./solid.js";
import { View, colour } from "./view.js";

const SAMPLES = 1000;
const MOST_CURVES = 10;
const MOST_PLOTS = 3;
const $ = (id) => document.getElementById(id);

/** Shows the mechanism that `about` describes; returns what a test looks at. */
export function start(about, Mechanism, Scene) {
  const page = new Page(about, new Model(about, Mechanism, Scene));
  page.begin();
  return page;
}

class Page {
  constructor(about, model) {
    Object.assign(this, { about, model, time: about.start.t, playing: false, frames: 0, shown: null });
    this.values = {};
    this.plots = [];
    // Messages are not held back as timers are.
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => this.compute();
    this.pump = port2;
    this.paths = [];
  }

  begin() {
    this.phase = new Phase($("phase"));
    try {
      this.view = new View($("view"));
      this.view.changed = () => this.repaint();
      new ResizeObserver(() => this.repaint()).observe($("view"));
    } catch (error) {
      $("legend").textContent = `${error.message}: there is no picture`;
    }
    this.choose();
    this.asAtFirst();
    this.listen();
    this.colours();
    // What moves by itself is not for everybody.
    this.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    requestAnimationFrame((now) => this.frame(now));
  }

  // Sliders

  /** The values with which the page was made. */
  asAtFirst() {
    const { parameters, q, qd, u, prescribed, t } = this.about.start;
    const signals = prescribed.map(([value]) => value);
    this.values = { parameters: [...parameters], q: [...q], qd: [...qd], u: [...u], prescribed: signals };
    $("end").value = this.about.end;
    this.time = t;
    this.sliders();
    this.restart();
  }

  sliders() {
    const { coordinates, parameters, inputs, prescribed } = this.about;
    const rates = coordinates.map((variable) => ({
      ...variable,
      names: variable.names.map((name) => `${name}_dot`),
      unit: variable.unit === "1" ? "1/s" : `${variable.unit}/s`,
    }));
    const groups = [
      ["q", "First state", coordinates],
      ["qd", "First velocities", rates],
      ["parameters", "Parameters", parameters],
      ["u", "Inputs, constant", inputs],
      ["prescribed", "Prescribed, constant", prescribed],
    ];
    const parts = [];
    for (const [key, title, variables] of groups) {
      if (variables.length === 0) continue;
      const heading = document.createElement("h3");
      heading.textContent = title;
      parts.push(heading);
      for (const variable of variables) {
        variable.names.forEach((name, i) => parts.push(this.slider(key, variable.first + i, name, variable)));
      }
    }
    $("sliders").replaceChildren(...parts);
  }

  slider(key, i, name, { unit, docs, positive }) {
    const value = this.values[key][i];
    const root = document.createElement("div");
    root.className = "slider";
    const label = document.createElement("label");
    const units = document.createElement("span");
    units.textContent = unit === "1" ? "" : unit;
    label.append(name, " ", units);
    label.title = docs;
    const [field, range] = ["number", "range"].map((type) => Object.assign(document.createElement("input"), { type }));
    label.htmlFor = field.id = `${key}-${i}`;
    range.setAttribute("aria-label", `${name}${unit === "1" ? "" : ` in ${unit}`}`);
    const reach = value === 0 ? (unit.startsWith("rad") ? Math.PI : 1) : 2 * Math.abs(value);
    const low = key === "parameters" && value > 0 ? (positive ? reach / 100 : 0) : -reach;
    Object.assign(field, { step: "any", value: Number(value.toPrecision(6)) });
    Object.assign(range, { min: 0, max: 1000, step: 1, value: ((value - low) / (reach - low)) * 1000 });
    const set = (x) => {
      this.values[key][i] = x;
      this.restart();
    };
    range.oninput = () => {
      const x = Number((low + (range.value / 1000) * (reach - low)).toPrecision(3));
      field.value = x;
      set(x);
    };
    field.oninput = () => {
      if (!Number.isFinite(field.valueAsNumber)) return;
      range.value = ((field.valueAsNumber - low) / (reach - low)) * 1000;
      set(field.valueAsNumber);
    };
    root.append(label, field, range);
    return root;
  }

  // Motion

  restart() {
    const { model, values, about } = this;
    const end = $("end").valueAsNumber;
    if (!(end > about.start.t)) return;
    try {
      model.setParameters(values.parameters);
      model.inputs = [...values.u];
      model.prescribed = values.prescribed.map((value, i) => [value, ...about.start.prescribed[i].slice(1)]);
      this.motion = new Motion(model, { t: about.start.t, q: values.q, qd: values.qd }, end, SAMPLES);
    } catch (error) {
      return this.say(error.message, true);
    }
    this.paths = [];
    this.fitted = false;
    this.columns = new Map();
    this.time = Math.min(this.time, end);
    this.compute();
  }

  /** Places along what is known of the motion. */
  follow() {
    const { model, motion } = this;
    if (!("places" in this.about.scene.functions)) return;
    while (this.paths.length < motion.samples.length) {
      const { t, q, qd } = motion.samples[this.paths.length];
      this.paths.push(model.see("places", t, q, qd));
    }
  }

  /** Goes on with the motion in pieces, between which frames are drawn. */
  compute() {
    const { motion } = this;
    if (motion.done && this.fitted) return;
    motion.advance(8);
    this.follow();
    if (motion.done || performance.now() - (this.lastPaint ?? 0) > 250) {
      if (motion.done) this.finish();
      this.paintPlots();
      this.lastPaint = performance.now();
    }
    if (!motion.done) this.pump.postMessage(null);
  }

  finish() {
    const { motion, about } = this;
    this.fitted = true;
    const seen = this.paths.filter((_, i) => i % 5 === 0).flatMap((places) => this.around(places));
    motion.samples.filter((_, i) => i % 50 === 0).forEach((sample) => seen.push(...this.corners(sample)));
    this.view?.fit(seen.length > 0 ? seen : [[-1, -1, -1], [1, 1, 1]]);
    const { accepted, evaluations } = motion.integrator?.summary ?? { accepted: 0, evaluations: 0 };
    if (motion.error !== null) return this.say(`The motion ends: ${motion.error.message}`, true);
    const energy = this.column("energy");
    const change = energy.reduce((most, e) => Math.max(most, Math.abs(e - energy[0])), 0);
    const open = about.constraints.map((name) => this.column(`residual_${name}`).reduce((most, x) => Math.max(most, Math.abs(x)), 0));
    const residual = open.length === 0 ? "" : `, constraints are open by ${number(Math.max(...open), 2)} at most`;
    this.say(`${accepted} steps, ${evaluations} accelerations; energy changes by ${number(change, 2)} J at most${residual}.`);
  }

  /** The corners of boxes about bodies and shapes. */
  corners({ t, q, qd }) {
    const { about, model } = this;
    const see = (name) => (name in about.scene.functions ? model.see(name, t, q, qd) : []);
    const [frames, bodies, shapes] = [see("frames"), see("bodies"), see("shapes")];
    const boxed = ([x, y, z], r) => [-r, r].flatMap((a) => [-r, r].flatMap((b) => [-r, r].map((c) => [x + a, y + b, z + c])));
    const ofBody = ({ frame, rigid, shaped }, i) => {
      const [mass, ...rest] = bodies.slice(10 * i, 10 * i + 10);
      const shape = rigid && !shaped ? ellipsoid(mass, rest.slice(3)) : undefined;
      if (shape === undefined) return [];
      const { position, rotation } = frames[frame];
      return boxed(add(position, turned(rotation, rest.slice(0, 3))), 0.8 * Math.max(...shape.axes));
    };
    const ofShape = ({ kind, frame, triangles }, i) => {
      const sizes = shapes.slice(3 * i, 3 * i + 3);
      const reach = (triangles ?? []).flat(2).reduce((most, x) => Math.max(most, Math.abs(x)), 0);
      const size = kind === "mesh" ? reach * Math.max(...sizes) : Math.max(...sizes) * (kind === "box" ? 0.5 : 1);
      return boxed(frames[frame].position, 0.8 * size);
    };
    return [...about.scene.bodies.flatMap(ofBody), ...about.scene.shapes.flatMap(ofShape)];
  }

  /** Flat numbers as places. */
  around(places) {
    const all = [];
    for (let i = 0; i < places.length; i += 3) all.push(places.slice(i, i + 3));
    return all;
  }

  say(text, isError = false) {
    $("status").textContent = text;
    $("status").className = isError ? "error" : "";
  }

  // Plots

  /** Every quantity that can be drawn: name, unit, group. */
  quantities() {
    const { coordinates, constraints, constraint_units: units, conserved, outputs } = this.about;
    const all = [];
    const put = (group, name, unit, of) => all.push({ group, name, unit, of });
    const flat = coordinates.flatMap(({ names, unit }) => names.map((name) => [name, unit]));
    flat.forEach(([name, unit], i) => put("coordinates", name, unit, (s) => s.q[i]));
    flat.forEach(([name, unit], i) => put("velocities", `${name}_dot`, unit === "1" ? "1/s" : `${unit}/s`, (s) => s.qd[i]));
    const call = (name, s) => this.model.call(name, s.t, s.q, s.qd);
    put("energies", "kinetic_energy", "J", (s) => call("kinetic_energy", s));
    put("energies", "potential_energy", "J", (s) => call("potential_energy", s));
    put("energies", "energy", "J", (s) => call("kinetic_energy", s) + call("potential_energy", s));
    flat.forEach(([name, unit], i) => put("accelerations", `${name}_ddot`, unit === "1" ? "1/s²" : `${unit}/s²`, (s) => call("forward_dynamics", s)[i]));
    constraints.forEach((name, i) => put("multipliers", `lambda_${name}`, units[i][1], (s) => call("multipliers", s)[i]));
    constraints.forEach((name, i) => put("constraints, what is left", `residual_${name}`, units[i][0], (s) => call("constraint", s)[i]));
    conserved.forEach((name, i) => put("conserved", name, "", (s) => call("conserved", s)[i]));
    for (const { name, components, units } of outputs) {
      components.forEach((component, i) => {
        const unit = units[i] ?? (/_position_\d$/.test(component) ? "m" : "1");
        put("outputs", component, unit, (s) => flattened(call(name, s))[i]);
      });
    }
    return all;
  }

  choose() {
    this.all = this.quantities();
    const groups = [...new Set(this.all.map(({ group }) => group))];
    $("show").replaceChildren(...groups.map((group) => new Option(group)));
    const options = () => this.all.map(({ name }) => new Option(name));
    $("vertical").replaceChildren(...options());
    $("horizontal").replaceChildren(...options());
    const n = this.about.start.q.length;
    [$("vertical").selectedIndex, $("horizontal").selectedIndex] = [n, 0];
    // Two coordinates of a place make a path.
    const place = ["m", "m"].every((unit, i) => this.all[i]?.unit === unit) && n > 1;
    if (place) $("vertical").selectedIndex = 1;
    const speeds = [0.1, 0.25, 0.5, 1, 2, 5];
    $("speed").replaceChildren(new Option("whole in 12 s", "whole"), ...speeds.map((speed) => new Option(`× ${speed}`, speed)));
    $("speed").value = this.about.end - this.about.start.t <= 30 ? "1" : "whole";
  }

  /** The values of a quantity along the motion, those of equal length as the samples. */
  column(name) {
    const quantity = this.all.find((other) => other.name === name);
    const { samples } = this.motion;
    let values = this.columns.get(name);
    if (values === undefined) this.columns.set(name, (values = []));
    while (values.length < samples.length) values.push(quantity.of(samples[values.length]));
    return values;
  }

  paintPlots() {
    const { motion } = this;
    const group = this.all.filter((quantity) => quantity.group === $("show").value);
    const byUnit = new Map();
    for (const quantity of group) byUnit.set(quantity.unit, [...(byUnit.get(quantity.unit) ?? []), quantity]);
    const t = motion.samples.map((sample) => sample.t);
    const panels = [...byUnit].slice(0, MOST_PLOTS);
    while (this.plots.length < panels.length) this.plots.push(new Plot($("curves"), (time) => this.scrub(time)));
    this.plots.forEach((plot, i) => (plot.root.hidden = i >= panels.length));
    panels.forEach(([unit, quantities], i) => {
      const curves = quantities.slice(0, MOST_CURVES).map(({ name }) => ({ name, values: this.column(name) }));
      const left = quantities.length - curves.length;
      const title = `${$("show").value}${unit === "1" || unit === "" ? "" : ` / ${unit}`}${left > 0 ? `, the first ${curves.length} of ${quantities.length}` : ""}`;
      this.plots[i].show({ title, t, curves, height: panels.length > 1 ? 190 : 280, end: motion.end });
    });
    const quantity = (id) => {
      const { name, unit } = this.all[$(id).selectedIndex];
      return { name, unit, values: this.column(name) };
    };
    const [x, y] = [quantity("horizontal"), quantity("vertical")];
    this.phase.show({ x, y, height: 300, equal: x.unit === y.unit && x.unit === "m" });
    this.mark();
  }

  /** The time, in numbers and in plots; it is shown less often than the picture, which is all that must be smooth. */
  mark() {
    const { motion, time } = this;
    $("time").value = (1000 * (time - motion.start)) / (motion.end - motion.start || 1);
    $("time").setAttribute("aria-valuetext", `${number(time, 4)} s`);
    $("clock").textContent = `${time.toFixed(motion.end < 100 ? 2 : 0)} s`;
    this.plots.forEach((plot) => !plot.root.hidden && plot.mark(time));
    const i = Math.min(motion.samples.length - 1, Math.max(0, Math.round((time - motion.start) / motion.dt)));
    this.phase.mark(["horizontal", "vertical"].map((id) => this.column(this.all[$(id).selectedIndex].name)[i]));
  }

  // Time

  play(isPlaying) {
    this.playing = isPlaying;
    $("play").textContent = isPlaying ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }

  scrub(time) {
    this.play(false);
    this.time = time;
    this.repaint();
    this.mark();
  }

  speed() {
    const { motion } = this;
    return $("speed").value === "whole" ? (motion.end - motion.start) / 12 : Number($("speed").value);
  }

  frame(now) {
    requestAnimationFrame((next) => this.frame(next));
    const passed = Math.min(0.1, (now - (this.last ?? now)) / 1000);
    this.last = now;
    if (this.motion === undefined) return;
    if (this.playing) {
      const { motion } = this;
      const known = motion.samples.at(-1).t;
      this.time += passed * this.speed();
      if (this.time > known) this.time = motion.done ? motion.start : known;
      if (now - (this.lastMark ?? 0) > 60) {
        this.lastMark = now;
        this.mark();
      }
    }
    this.paint();
    if (this.frames++ === 0) this.firstFrame = performance.now();
  }

  repaint() {
    this.shown = null;
  }

  // The picture

  colours() {
    const style = getComputedStyle(document.documentElement);
    const probe = document.createElement("span");
    document.body.append(probe);
    const of = (name) => {
      probe.style.color = style.getPropertyValue(name);
      return colour(getComputedStyle(probe).color);
    };
    this.theme = { paper: of("--sky"), ink: of("--ink"), faint: of("--faint"), line: of("--line") };
    probe.remove();
    this.repaint();
  }

  paint() {
    const { motion, view, model } = this;
    const key = `${this.time} ${motion.samples.length}`;
    if (key === this.shown && motion === this.shownMotion) return;
    [this.shown, this.shownMotion] = [key, motion];
    if (view === undefined) return;
    const { t, q, qd } = motion.at(this.time);
    view.begin(this.theme.paper);
    const { scene } = this.about;
    const see = (name) => (name in scene.functions ? model.see(name, t, q, qd) : []);
    const [frames, bodies, flat] = [see("frames"), see("bodies"), see("places")];
    if (![...flat, ...bodies].every(Number.isFinite)) return;
    const places = this.around(flat);
    const size = view.radius;
    this.paintGround(places);
    const rod = size * 0.014;
    for (const [a, b] of scene.links) view.rod(places[a], places[b], rod, [...this.theme.faint.slice(0, 3), 1]);
    for (const place of new Set(scene.links.flat())) view.ball(places[place], rod * 1.5, [...this.theme.faint.slice(0, 3), 1], "dot");
    this.paintBodies(frames, bodies, size);
    this.paintShapes(frames, see("shapes"));
    const axes = [colour("#d43f3f"), colour("#2e9e4f"), colour("#3b6fd4")];
    frames.slice(1).forEach((frame) => view.axes(frame, size * 0.13, axes, 1));
    view.axes({ position: [0, 0, 0], rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }, size * 0.2, axes, 0.75);
    this.paintTraces();
  }

  paintGround(places) {
    const lowest = this.paths.length > 0 ? this.lowest() : Math.min(0, ...places.map(([, , z]) => z));
    this.view.ground(lowest, [...this.theme.faint.slice(0, 3), 0.45]);
  }

  /** The height of the plane of lines: below all that moves. */
  lowest() {
    if (this.lowestOf !== this.motion || this.lowestAt !== this.paths.length) {
      let least = 0;
      for (const places of this.paths) for (let i = 2; i < places.length; i += 3) least = Math.min(least, places[i]);
      Object.assign(this, { lowestOf: this.motion, lowestAt: this.paths.length, least });
    }
    return this.least;
  }

  paintBodies(frames, numbers, size) {
    const { view, about } = this;
    const masses = about.scene.bodies.map((_, i) => numbers[10 * i]);
    const heaviest = Math.max(...masses, 0);
    about.scene.bodies.forEach(({ frame, rigid, shaped }, i) => {
      if (shaped) return;
      const [mass, ...rest] = numbers.slice(10 * i, 10 * i + 10);
      const rgba = colour(BODIES[i % BODIES.length]);
      const { position, rotation } = frames[frame];
      const centre = rest.slice(0, 3);
      const place = add(position, turned(rotation, centre));
      const shape = rigid ? ellipsoid(mass, rest.slice(3)) : undefined;
      // Points are drawn by their masses, and so is what is too small to be seen.
      const ball = size * 0.07 * Math.max(0.45, Math.cbrt(mass / (heaviest || 1)));
      if (shape === undefined || Math.max(...shape.axes) < 0.25 * ball) {
        if (mass > 0) view.ball(place, ball, rgba);
        return;
      }
      const columns = [0, 1, 2].map((k) => turned(rotation, [0, 1, 2].map((j) => shape.vectors[j][k])));
      const vectors = [0, 1, 2].map((j) => columns.map((column) => column[j]));
      view.solid("sphere", solid(place, { axes: shape.axes, vectors }, 0.012 * size), rgba);
    });
  }

  paintShapes(frames, numbers) {
    const { view, about } = this;
    this.meshes ??= about.scene.shapes.map(({ triangles }) => triangles && view.triangles(triangles));
    about.scene.shapes.forEach(({ kind, frame }, i) => {
      const [x, y, z] = numbers.slice(3 * i, 3 * i + 3);
      const rgba = colour(BODIES[i % BODIES.length]);
      const at = pose(frames[frame]);
      const forms = { box: [x / 2, y / 2, z / 2], cylinder: [x, x, y], sphere: [x, x, x], mesh: [x, y, z] };
      const scaled = at.map((value, k) => (k < 12 ? value * forms[kind][Math.floor(k / 4)] : value));
      if (kind === "mesh" && !this.meshes[i]) return;
      // Cylinders stand about their middles.
      if (kind === "cylinder") for (let k = 0; k < 3; k++) scaled[12 + k] -= scaled[8 + k] / 2;
      view.solid(kind === "mesh" ? this.meshes[i] : kind, scaled, rgba);
    });
  }

  /** Paths up to now, fading backwards. */
  paintTraces() {
    const { about, motion, view, paths } = this;
    const now = Math.min(paths.length - 1, Math.floor((this.time - motion.start) / motion.dt));
    const known = about.scene.traced.slice(0, 12);
    known.forEach((place, k) => {
      const numbers = [];
      for (let i = Math.max(0, now - 400); i <= now; i++) {
        const at = paths[i].slice(3 * place, 3 * place + 3);
        if (at.every(Number.isFinite)) numbers.push(...at, 0.15 + 0.85 * (1 - (now - i) / 400));
      }
      view.line(numbers, colour(BODIES[k % BODIES.length], 0.9));
    });
  }

  listen() {
    $("play").onclick = () => this.play(!this.playing);
    $("time").oninput = () => {
      const { motion } = this;
      this.scrub(motion.start + ($("time").value / 1000) * (motion.end - motion.start));
    };
    $("end").oninput = () => this.restart();
    $("reset").onclick = () => this.asAtFirst();
    for (const id of ["show", "vertical", "horizontal"]) $(id).onchange = () => this.paintPlots();
    document.addEventListener("keydown", (event) => {
      if (/^(INPUT|SELECT|BUTTON|TEXTAREA|A)$/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
      const { motion } = this;
      const steps = { ArrowLeft: -10, ArrowRight: 10 };
      if (event.key === " ") this.play(!this.playing);
      else if (event.key === "Home" && event.target.id === "view") this.scrub(motion.start);
      else if (event.key in steps) this.scrub(Math.min(motion.end, Math.max(motion.start, this.time + steps[event.key] * motion.dt)));
      else return;
      event.preventDefault();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.colours();
      this.paintPlots();
    });
  }
}

/** Colours of bodies, told apart by people who see fewer of them, too. */
const BODIES = ["#4c8fd0", "#e8864a", "#3fae79", "#c9a63a", "#a06cc4", "#50b8c4", "#d9647c", "#8f9aa6"];

/** The numbers of a result, in the order of its components. */
function flattened(value) {
  if (typeof value === "number") return [value];
  if (Array.isArray(value)) return value.flatMap(flattened);
  return Object.values(value).flatMap(flattened);
}
