// The page: an editor, what the generator says of the text, and the motion.

import { examples, folder } from "./examples.js";
import { Generator } from "./generator.js";
import { Phase, Plot, number } from "../../mbs-cli/src/report/plot.js";

const $ = (id) => document.getElementById(id);
const escape = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
const METHODS = ["dop853", "dopri5", "rk4", "gauss-legendre4", "stormer-verlet", "semi-implicit-euler"];

const generator = new Generator((isSlow) => ($("stop").hidden = !isSlow));
let example = examples[0];
let files = {};
let model = null;
let values = null; // of the sliders: params, q, qd, u
let texts = {}; // printed, by language
let plots = [];
let path = null;

// The editor

function paintEditor(diagnostics = []) {
  const text = $("text").value;
  const count = text.split("\n").length;
  $("lines").textContent = Array.from({ length: count }, (_, i) => i + 1).join("\n");
  let [html, end] = ["", 0];
  const own = diagnostics.filter(({ file }) => file === example.file);
  for (const { start, end: stop, severity } of own.sort((a, b) => a.start - b.start)) {
    if (start < end) continue;
    const marked = text.slice(start, Math.max(stop, start + 1));
    html += `${escape(text.slice(end, start))}<mark class="${severity}">${escape(marked === "\n" || marked === "" ? " " : marked)}</mark>`;
    if (marked === "\n") html += "\n";
    end = start + marked.length;
  }
  $("marks").innerHTML = `${html}${escape(text.slice(end))}\n`;
}

function showReport(diagnostics, summary) {
  const line = ({ severity, message, help, line, column, file, start, end }, i) => `
    <button data-i="${i}"><span class="where">${escape(file)}:${line}:${column}</span><span class="${severity}">${severity}</span>:
    ${inCode(message)}${help ? `<span class="help">${inCode(help)}</span>` : ""}</button>`;
  $("report").innerHTML = diagnostics.slice(0, 20).map(line).join("") + summary;
  $("report").querySelectorAll("button").forEach((button) => {
    button.onclick = () => select(diagnostics[button.dataset.i]);
  });
}

function inCode(message) {
  return escape(message).replace(/`([^`]*)`/g, "<code>$1</code>");
}

function select({ file, start, end, line }) {
  if (file !== example.file) return;
  $("text").focus();
  $("text").setSelectionRange(start, end);
  $("editor").scrollTop = Math.max(0, (line - 6) * 19);
}

// From text to model

const stateAfter = (error) => (error.message === "stopped" ? "stopped" : "");

async function compile() {
  const text = $("text").value;
  $("state").textContent = "deriving …";
  try {
    const compiled = await generator.ask("compile", { text, name: example.file, files });
    if (compiled === undefined) return;
    const before = model;
    model = compiled.description;
    texts = {};
    const { proof, warnings } = model;
    paintEditor(warnings);
    const summary = `derived and proved at ${proof.states} states in ${compiled.seconds.toFixed(2)} s`;
    showReport(warnings, `<p class="good">${escape(model.name)}: ${model.coordinateNames.length} ${model.coordinateNames.length === 1 ? "coordinate" : "coordinates"}, ${summary}</p>`);
    $("results").style.opacity = 1;
    makeControls(before);
    paintOperations();
    await Promise.all([simulate(), paintTexts()]);
  } catch (error) {
    $("state").textContent = stateAfter(error);
    if (error.isModel) {
      paintEditor(error.diagnostics);
      showReport(error.diagnostics, error.diagnostics.length ? "" : `<p class="error">${inCode(error.message)}</p>`);
      $("results").style.opacity = 0.45;
    } else {
      showReport([], `<p class="error">${inCode(error.message)}</p>`);
      // What is shown is of another text.
      $("results").style.opacity = 0.45;
    }
  }
}

// Sliders

/** Start values by name: of the example, or else a little away from zero. */
function startOf(key, names, fallback) {
  const given = example[key] ?? {};
  if (Array.isArray(given)) return names.map((_, i) => given[i] ?? fallback);
  const byComponent = {};
  for (const variable of model.coordinates) {
    [given[variable.name] ?? []].flat().forEach((value, i) => (byComponent[variable.components[i]] = value));
  }
  return names.map((name) => byComponent[name] ?? (Object.keys(given).length ? 0 : fallback));
}

function makeControls(before) {
  const unitOf = (variables) => variables.flatMap(({ components, unit }) => components.map(() => unit));
  const docsOf = (variables) => variables.flatMap(({ components, docs }) => components.map(() => docs));
  const n = model.coordinateNames;
  const groups = [
    ["params", "Parameters", model.parameterNames, unitOf(model.parameters), model.parameters.flatMap((p) => p.defaults), docsOf(model.parameters)],
    ["q", "Start", n, unitOf(model.coordinates), startOf("q", n, 0.3), docsOf(model.coordinates)],
    ["qd", "Start, velocities", n.map((name) => `${name}_dot`), unitOf(model.coordinates).map((unit) => `${unit}/s`), startOf("qd", n, 0), docsOf(model.coordinates)],
    ["u", "Inputs, constant", model.inputNames, unitOf(model.inputs), model.inputNames.map(() => 0), docsOf(model.inputs)],
  ];
  const signature = JSON.stringify(groups.map(([, , names, units, defaults]) => [names, units, defaults]));
  if (before && values?.signature === signature) return; // the text has changed, but not what can be set
  values = { signature };
  const parts = [];
  for (const [key, title, names, units, defaults, docs] of groups) {
    values[key] = Float64Array.from(defaults);
    if (names.length === 0) continue;
    const heading = document.createElement("h2");
    heading.textContent = title;
    parts.push(heading, ...names.map((name, i) => slider(key, i, name, units[i], defaults[i], docs[i])));
  }
  $("controls").replaceChildren(...parts);
  showChoices();
}

function slider(key, i, name, unit, value, docs) {
  const root = document.createElement("div");
  root.className = "slider";
  const reach = value === 0 ? (unit.startsWith("rad") ? 3.2 : 1) : 2 * Math.abs(value);
  const low = key === "params" && value > 0 ? 0 : -reach;
  root.innerHTML = `<label title="${escape(docs)}">${escape(name)} <span>${unit === "1" ? "" : escape(unit)}</span></label>
    <input type="number" step="any" aria-label="${escape(name)}"><input type="range" min="0" max="1000" aria-label="${escape(name)}">`;
  const [field, range] = root.querySelectorAll("input");
  const set = (x) => (range.value = ((x - low) / (reach - low)) * 1000);
  field.value = value;
  set(value);
  const changed = (x) => {
    values[key][i] = x;
    simulate();
  };
  range.oninput = () => {
    const x = Number((low + (range.value / 1000) * (reach - low)).toPrecision(3));
    field.value = x;
    changed(x);
  };
  field.oninput = () => {
    if (!Number.isFinite(field.valueAsNumber)) return;
    set(field.valueAsNumber);
    changed(field.valueAsNumber);
  };
  return root;
}

/** What can be shown: columns in groups. */
function choices() {
  const names = model.columns.map(({ name }) => name);
  const n = model.coordinateNames.length;
  const rows = model.constraints.length;
  const groups = [
    ["coordinates", names.slice(1, 1 + n)],
    ["velocities", names.slice(1 + n, 1 + 2 * n)],
    ["energies", names.slice(1 + 2 * n, 4 + 2 * n)],
    ["multipliers", names.slice(4 + 2 * n, 4 + 2 * n + rows)],
    ["constraints, what is left", names.slice(4 + 2 * n + rows, 4 + 2 * n + 2 * rows)],
    ["outputs", names.slice(4 + 2 * n + 2 * rows)],
  ];
  return groups.filter(([, names]) => names.length > 0);
}

function showChoices() {
  const before = $("show").value;
  $("show").replaceChildren(...choices().map(([name]) => new Option(name)));
  if (choices().some(([name]) => name === before)) $("show").value = before;
}

// Motion

async function simulate() {
  const t_end = $("t_end").valueAsNumber;
  if (!(t_end > 0)) return;
  const method = $("method").value;
  const { params, q, qd, u } = values;
  const given = { params, q, qd, u, t_end, method, tolerance: Number($("tolerance").value), dt: t_end / 1000 };
  if (model.constraints.length > 0) {
    const held = (example.hold ?? []).filter((name) => model.coordinateNames.includes(name));
    Object.assign(given, { hold: held, redundant: "least-norm" });
  }
  $("state").textContent = "moving …";
  try {
    const answer = await generator.ask("simulate", given);
    if (answer === undefined) return;
    $("state").textContent = "";
    showMotion(answer);
  } catch (error) {
    $("state").textContent = stateAfter(error);
    $("energy").className = "error";
    $("energy").innerHTML = inCode(error.message);
  }
}

let shown = null;

function showMotion(answer = shown) {
  if (answer === null) return;
  shown = answer;
  const { motion, seconds } = answer;
  const [, names] = choices().find(([name]) => name === $("show").value) ?? choices()[0];
  const byUnit = new Map();
  for (const name of names) {
    if (!(name in motion.columns)) return;
    const unit = motion.units[name];
    byUnit.set(unit, [...(byUnit.get(unit) ?? []), { name, values: motion.columns[name] }]);
  }
  const { energy } = motion.columns;
  const drift = energy.map((e) => e - energy[0]);
  const panels = [...byUnit].slice(0, 4).map(([unit, curves]) => ({ title: `${$("show").value}${unit === "1" ? "" : ` in ${unit}`}`, curves: curves.slice(0, 12) }));
  panels.push({ title: "energy T + V less that at the start, in J", curves: [{ name: "energy", values: drift }] });
  while (plots.length < panels.length) plots.push(new Plot($("canvases")));
  plots.forEach((plot, i) => (plot.root.hidden = i >= panels.length));
  const height = Math.max(150, Math.min(220, 400 / (panels.length - 1)));
  panels.forEach((panel, i) => plots[i].show({ ...panel, t: motion.t, height: i === panels.length - 1 ? 150 : height }));

  showPath(motion);

  const most = drift.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  const scale = Math.max(...["kinetic_energy", "potential_energy"].map((name) => motion.columns[name].reduce((most, x) => Math.max(most, Math.abs(x)), 0)));
  const isFree = model.conserved.includes("energy_integral") && values.u.every((x) => x === 0);
  const { accepted, rejected, evaluations, assembled } = motion.summary;
  $("energy").className = "";
  $("energy").innerHTML = `${isFree ? "Drift of the energy" : "Change of the energy"}: at most <strong>${number(most, 3)} J</strong>${
    scale > 0 ? `, <strong>${number(most / scale, 3)}</strong> of the largest T or V` : ""
  }${isFree ? "; without friction and inputs it should be none" : "; friction, inputs and time take part in it"}. ${accepted} steps, ${rejected} rejected,
  ${evaluations} accelerations in ${(1000 * seconds).toFixed(0)} ms.${assembled ? " The start was moved onto the constraints." : ""}`;
}

/** The path of the first output that is a place, seen along the axis in which it moves least. */
function showPath({ columns, units }) {
  const isPlace = ({ units }) => units?.length === 3 && units.every((unit) => unit === "m");
  const output = Object.values(model.functions).find(isPlace);
  const names = output ? [0, 1, 2].map((i) => `${output.name}_${i}`) : [];
  path ??= new Phase($("path"));
  path.root.hidden = names.length === 0 || names.some((name) => !(name in columns));
  if (path.root.hidden) return;
  const span = (name) => columns[name].reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);
  const spans = names.map(span).map(([low, high]) => high - low);
  const least = spans.indexOf(Math.min(...spans));
  const [x, y] = names.filter((_, i) => i !== least).map((name) => ({ name, unit: units[name], values: columns[name] }));
  path.show({ x, y, height: 260, equal: true });
}

// Equations, code, operations

async function paintTexts() {
  const tab = document.querySelector('[aria-selected="true"]').dataset.tab;
  const language = tab === "equations" ? "mathml" : $("language").value;
  if (model === null || !["equations", "code"].includes(tab)) return;
  if (!(language in texts)) {
    $("state").textContent = "writing …";
    const answer = await generator.ask("emit", { language });
    if (answer === undefined) return;
    texts[language] = answer.text;
    $("state").textContent = "";
  }
  const text = texts[language];
  if (tab === "code") {
    $("printed").textContent = text;
    $("size").textContent = `${text.split("\n").length} lines, ${(text.length / 1024).toFixed(0)} KiB`;
  } else if ($("equations").dataset.of !== text) {
    $("equations").dataset.of = text;
    const short = text.length < 4_000_000;
    $("equations").innerHTML = short ? text : "<p>These equations are too long for a page: see the LaTeX under Code.</p>";
  }
}

function paintOperations() {
  const kinds = ["add", "mul", "div", "sqrt", "sincos", "other", "flops"];
  const head = ["function", "result", ...kinds].map((name) => `<th>${name}</th>`).join("");
  const shape = ({ name, kind, shape }) => `${name ? `${name}: ` : ""}${kind === "array" ? shape.join(" × ") : [...shape, kind].join(" × ")}`;
  const rows = Object.values(model.functions).map(({ name, docs, results, operations }) => {
    const counts = kinds.map((kind) => `<td>${operations[kind] || ""}</td>`).join("");
    return `<tr><td title="${escape(docs)}">${escape(name)}</td><td>${escape(results.map(shape).join(", "))}</td>${counts}</tr>`;
  });
  $("operations").innerHTML = `<table><thead><tr>${head}</tr></thead><tbody>${rows.join("")}</tbody></table>`;
}

function choose(tab) {
  for (const button of document.querySelectorAll('[role="tab"]')) {
    const isChosen = button.dataset.tab === tab;
    button.setAttribute("aria-selected", isChosen);
    $(button.dataset.tab).hidden = !isChosen;
  }
  paintTexts().catch((error) => ($("state").textContent = error.message));
}

// To begin with

async function open(chosen) {
  example = chosen;
  const answer = await fetch(new URL(chosen.file, folder));
  const text = await answer.text();
  if (example !== chosen) return; // another one was chosen meanwhile
  if (!answer.ok) {
    showReport([], `<p class="error">${escape(chosen.file)}: ${answer.status}; serve the repository's folder, so that models/ is there</p>`);
    return;
  }
  $("text").value = text;
  files = {};
  values = null;
  $("t_end").value = chosen.t_end;
  paintEditor();
  await compile();
}

function later(call, milliseconds) {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(call, milliseconds);
  };
}

$("examples").replaceChildren(...examples.map(({ title }, i) => new Option(title, i)));
$("method").replaceChildren(...METHODS.map((name) => new Option(name)));
$("examples").onchange = () => open(examples[$("examples").value]);
const compileLater = later(compile, 300);
$("text").oninput = () => {
  paintEditor();
  compileLater();
};
$("text").onkeydown = (event) => {
  if (event.key !== "Tab" || event.shiftKey) return;
  event.preventDefault();
  document.execCommand("insertText", false, "    ");
};
for (const id of ["t_end", "method", "tolerance"]) $(id).oninput = () => simulate();
$("show").onchange = () => showMotion();
$("stop").onclick = () => {
  generator.stop();
};
$("language").onchange = () => paintTexts();
$("copy").onclick = () => navigator.clipboard.writeText($("printed").textContent);
$("download").onclick = () => {
  const link = document.createElement("a");
  const ending = { rust: "rs", c: "h", latex: "tex" }[$("language").value];
  link.href = URL.createObjectURL(new Blob([$("printed").textContent], { type: "text/plain" }));
  link.download = example.file.replace(/mbs$/, ending);
  link.click();
  URL.revokeObjectURL(link.href);
};
document.querySelectorAll('[role="tab"]').forEach((button) => (button.onclick = () => choose(button.dataset.tab)));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => [...plots, path].forEach((plot) => plot?.draw()));
const wanted = new URLSearchParams(location.search);
choose(wanted.get("tab") ?? "motion");
const first = Math.max(0, examples.findIndex(({ file }) => file === wanted.get("example")));
$("examples").value = first;
open(examples[first]);
