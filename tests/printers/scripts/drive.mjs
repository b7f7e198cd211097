// Runs every function of every mechanism of a list at the states of a file, and writes all numbers that they give.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const flat = (value) => (typeof value === "number" ? [value] : Object.values(value).flatMap(flat));

for (const mechanism of JSON.parse(readFileSync("list.json", "utf8"))) {
  const module = await import(pathToFileURL(`${mechanism.file}.mjs`));
  const machine = new (Object.values(module)[0])();
  const bytes = readFileSync(`${mechanism.name}.states`);
  const numbers = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.length / 8);
  const size = mechanism.layout.reduce((sum, [, count]) => sum + count, 0);
  const results = [];
  for (const { js: name, takes } of mechanism.functions) {
    for (let state = 0; state < mechanism.states; state++) {
      let place = state * size;
      const given = {};
      for (const [argument, count] of mechanism.layout) {
        given[argument] = numbers.subarray(place, place + count);
        place += count;
      }
      given.t = given.t[0];
      const motions = given.prescribed;
      given.prescribed = Array.from({ length: motions.length / 3 }, (_, i) => motions.subarray(3 * i, 3 * i + 3));
      results.push(flat(machine[name](...takes.map((argument) => given[argument]))));
    }
  }
  writeFileSync(`${mechanism.name}.js.results`, new Float64Array(results.flat()));
}
