// The example of docs/webassembly.md prints what the page says that it prints.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";

import { repository } from "./support.mjs";

test("the example of the manual", async () => {
  const manual = readFileSync(join(repository, "docs/webassembly.md"), "utf8");
  const block = (language) => new RegExp(`\`\`\`${language}\n([^]*?)\`\`\``).exec(manual)[1];
  const folder = mkdtempSync(join(tmpdir(), "mbs-manual-"));
  try {
    const file = join(folder, "example.mjs");
    writeFileSync(file, block("js").replace('"./mbs.js"', JSON.stringify(join(repository, "mbs-wasm/mbs.js"))));
    const { stdout } = await promisify(execFile)(process.execPath, [file]);
    assert.equal(stdout, block("text"));
  } finally {
    rmSync(folder, { recursive: true });
  }
});
