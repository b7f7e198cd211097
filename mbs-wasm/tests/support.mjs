// What the tests share: the mechanisms of the repository, random numbers, and what this machine computes.

import { spawn } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { basename, dirname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";

export const repository = fileURLToPath(new URL("../../", import.meta.url));
const folders = ["models/mechanisms", "tests/mechanisms"];

/** Every text in a folder and in those that it holds. */
function texts(folder) {
  const paths = readdirSync(join(repository, folder), { recursive: true }).filter((file) => /\.(mbs|csv)$/.test(file));
  return paths.map((path) => join(folder, path));
}

/** A text, and all others, by their paths from the folder that it is in. */
export function mechanism(path) {
  const folder = dirname(join(repository, path));
  const all = folders.flatMap(texts).map((file) => join(repository, file));
  const files = Object.fromEntries(all.map((file) => [relative(folder, file), readFileSync(file, "utf8")]));
  const name = basename(path);
  return { path, folder, name, text: files[name], files };
}

/** Every mechanism of the repository, those in folders too; files that are imported are none. */
export function mechanisms() {
  const paths = folders.flatMap(texts).filter((path) => path.endsWith(".mbs"));
  return paths.sort().map(mechanism).filter(({ text }) => /^mechanism /m.test(text));
}

/** Numbers in [0, 1), the same in every run. Source: G. Marsaglia, Xorshift RNGs, 2003, section 4 (xorshift128). */
export function random(seed) {
  const state = Uint32Array.from([123456789, 362436069, 521288629, 88675123 ^ seed]);
  return () => {
    const t = state[0] ^ (state[0] << 11);
    state.copyWithin(0, 1);
    state[3] = state[3] ^ (state[3] >>> 19) ^ t ^ (t >>> 8);
    return state[3] / 2 ** 32;
  };
}

/** A number as its bits. */
export function bits(number) {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, number);
  return view.getBigUint64(0).toString(16).padStart(16, "0");
}

/** Numbers from their bits, one behind the other. */
export function fromBits(text) {
  const view = new DataView(new ArrayBuffer(8));
  return Array.from({ length: text.length / 16 }, (_, i) => {
    view.setBigUint64(0, BigInt(`0x${text.slice(16 * i, 16 * i + 16)}`));
    return view.getFloat64(0);
  });
}

/** A program that takes lines of JSON and answers each with one, in order. */
export class Native {
  #waiting = [];
  #rest = "";

  constructor(program) {
    this.process = spawn(program, [], { stdio: ["pipe", "pipe", "inherit"] });
    this.process.stdout.setEncoding("utf8").on("data", (data) => {
      const lines = (this.#rest + data).split("\n");
      this.#rest = lines.pop();
      for (const line of lines) this.#waiting.shift().resolve(JSON.parse(line));
    });
    const failed = (reason) => this.#waiting.splice(0).forEach(({ reject }) => reject(new Error(reason)));
    this.process.on("error", (error) => failed(error.message)).on("exit", (code) => failed(`${program} ended with ${code}`));
  }

  ask(request) {
    return new Promise((resolve, reject) => {
      this.#waiting.push({ resolve, reject });
      this.process.stdin.write(`${JSON.stringify(request)}\n`);
    });
  }

  close() {
    this.process.stdin.end();
  }
}
