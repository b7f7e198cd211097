// What the tests of reports share: the program, the pages that it writes, and what is in them.

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const repository = fileURLToPath(new URL("../../../", import.meta.url));
export const MBS = process.env.MBS ?? join(repository, "target/release/mbs");
export const folder = mkdtempSync(join(tmpdir(), "mbs-report-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/** What the program prints. */
export function mbs(...args) {
  return execFileSync(MBS, args, { cwd: repository, encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "pipe"] });
}

/** A page of a mechanism: its file and its text. */
export function page(path, { state, end, name = path.replaceAll("/", "_") } = {}) {
  const file = join(folder, `${name}.html`);
  const more = [state === undefined ? [] : ["--state", JSON.stringify(state)], end === undefined ? [] : ["--t-end", String(end)]];
  mbs("report", path, "--out", file, ...more.flat());
  return { file, html: readFileSync(file, "utf8") };
}

export function aboutOf(html) {
  return JSON.parse(/<script type="application\/json" id="about">(.*?)<\/script>/s.exec(html)[1]);
}

/** The scripts of a page as a module: what it draws is left alone. */
export async function scriptsOf(html, name) {
  const [, text] = /<script type="module" async>\n(.*?)<\/script>/s.exec(html);
  const last = text.lastIndexOf("window.report = ");
  const file = join(folder, `${name.replaceAll("/", "_")}.mjs`);
  writeFileSync(file, `${text.slice(0, last)}\nexport { Mechanism, Scene, Model, Motion, project, ellipsoid, principal };\n`);
  return import(pathToFileURL(file));
}

/** The state of a page as `--state` takes it. */
export function stateOf({ parameters, prescribed, start }) {
  const shaped = (variables, values) =>
    Object.fromEntries(
      variables.map(({ name, first, names, lengths }) => {
        const own = values.slice(first, first + names.length);
        const rows = () => Array.from({ length: lengths[0] }, (_, i) => own.slice(i * lengths[1], (i + 1) * lengths[1]));
        return [name, lengths.length === 0 ? own[0] : lengths.length === 1 ? own : rows()];
      }),
    );
  const { t, q, qd, u } = start;
  const signals = prescribed.flatMap(({ names }) => names).map((name, i) => [name, start.prescribed[i]]);
  return { t, q, qd, u, params: shaped(parameters, start.parameters), prescribed: Object.fromEntries(signals) };
}

/** All numbers of a value, in order. */
export function flat(value) {
  if (typeof value === "number" || value === null) return [value ?? NaN];
  return (Array.isArray(value) ? value : Object.values(value)).flatMap(flat);
}
