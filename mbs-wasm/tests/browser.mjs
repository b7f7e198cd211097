// A page in Chromium, spoken to through a pipe by the DevTools protocol: no package is needed for it.

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { delimiter, extname, join, normalize } from "node:path";

const NAMES = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/** The browser of this machine, if it has one. */
export function browser() {
  const paths = (process.env.PATH ?? "").split(delimiter).flatMap((folder) => NAMES.map((name) => join(folder, name)));
  return process.env.CHROMIUM ?? paths.find((path) => existsSync(path));
}

const KINDS = { ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm" };

/** Files of a folder by HTTP, as `python3 -m http.server` has them. */
export function serve(folder) {
  const server = createServer((request, response) => {
    const path = join(folder, normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname)));
    const file = path.endsWith("/") ? join(path, "index.html") : path;
    if (!existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": KINDS[extname(file)] ?? "text/plain; charset=utf-8" }).end(readFileSync(file));
  });
  return new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(server)));
}

/** A window with one page. */
export class Window {
  /** `webgl`: pictures in three dimensions are drawn, by the processor. */
  static async open(url, { width = 1500, height = 950, dark = false, webgl = false } = {}) {
    const window = new Window();
    window.profile = mkdtempSync(join(tmpdir(), "mbs-page-"));
    const drawing = webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-gpu"];
    const options = ["--headless=new", "--no-sandbox", ...drawing, "--remote-debugging-pipe", `--user-data-dir=${window.profile}`];
    window.process = spawn(browser(), options, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    window.waiting = new Map();
    window.problems = [];
    let rest = "";
    window.process.stdio[4].setEncoding("utf8").on("data", (data) => {
      const messages = (rest + data).split("\0");
      rest = messages.pop();
      messages.forEach((message) => window.#heard(JSON.parse(message)));
    });
    const { targetId } = await window.send("Target.createTarget", { url: "about:blank" });
    window.session = (await window.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    for (const domain of ["Page", "Runtime", "Log"]) await window.send(`${domain}.enable`);
    await window.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    const features = [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }];
    await window.send("Emulation.setEmulatedMedia", { features });
    await window.send("Page.navigate", { url });
    return window;
  }

  #heard({ id, method, params, result, error }) {
    if (id !== undefined) {
      const { resolve, reject } = this.waiting.get(id);
      this.waiting.delete(id);
      return error ? reject(new Error(error.message)) : resolve(result);
    }
    if (method === "Runtime.exceptionThrown") this.problems.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Log.entryAdded" && params.entry.level === "error") this.problems.push(`${params.entry.text} ${params.entry.url ?? ""}`);
  }

  send(method, params = {}) {
    const id = (this.last = (this.last ?? 0) + 1);
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId: this.session })}\0`);
    });
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Waits until an expression holds. */
  async until(expression, seconds = 60) {
    for (const end = Date.now() + 1000 * seconds; ; ) {
      if (await this.evaluate(`Boolean(${expression})`).catch(() => false)) return;
      if (Date.now() > end) throw new Error(`not within ${seconds} s: ${expression}; ${this.problems.join("; ")}`);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  /** What is seen; with `whole` all of the page. */
  async screenshot(whole = false) {
    const options = { format: "png", captureBeyondViewport: whole };
    if (whole) options.clip = { ...(await this.send("Page.getLayoutMetrics")).cssContentSize, scale: 1 };
    return Buffer.from((await this.send("Page.captureScreenshot", options)).data, "base64");
  }

  async close() {
    const ended = new Promise((resolve) => this.process.on("exit", resolve));
    this.send("Browser.close").catch(() => {});
    await ended;
    rmSync(this.profile, { recursive: true, force: true });
  }
}
