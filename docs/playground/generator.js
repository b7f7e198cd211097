// The generator's worker as the page asks it: one question at a time.

/**
 * Calls the generator; of several calls of one kind that wait, the last is made. `slow` is told whether a call takes
 * more than a second.
 */
export class Generator {
  constructor(slow) {
    this.slow = slow;
    this.waiting = new Map();
    this.compiled = null; // what the model was made of
    this.start();
  }

  start() {
    this.worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.current = null;
    this.isEmpty = true;
    this.worker.onmessage = ({ data }) => this.answered(data);
    this.worker.onerror = (event) => this.answered({ error: { message: event.message ?? "the generator could not be loaded" } });
  }

  /** Resolves to nothing where a later call of the same kind has taken its place. */
  ask(call, given) {
    return new Promise((resolve, reject) => {
      this.waiting.get(call)?.resolve(undefined);
      this.waiting.set(call, { call, given, resolve, reject });
      this.next();
    });
  }

  next() {
    if (this.current !== null || this.waiting.size === 0) return;
    const [first, request] = this.waiting.entries().next().value;
    // After a stop the worker is a new one: it gets the model when it is asked about it.
    if (first !== "compile" && this.isEmpty && this.compiled !== null) {
      this.current = { call: "compile", given: this.compiled, resolve: () => {}, reject: (error) => this.refuse(error) };
    } else {
      this.waiting.delete(first);
      this.current = request;
    }
    const { call, given } = this.current;
    this.worker.postMessage({ call, given });
    this.timer = setTimeout(() => this.slow(true), 1000);
  }

  answered({ result, error }) {
    clearTimeout(this.timer);
    this.slow(false);
    const request = this.current;
    this.current = null;
    if (request === null) return;
    if (error === undefined) {
      if (request.call === "compile") [this.isEmpty, this.compiled] = [false, request.given];
      request.resolve(result);
    } else request.reject(error);
    this.next();
  }

  refuse(error) {
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    waiting.forEach(({ reject }) => reject(error));
  }

  /** Ends what takes too long. */
  stop() {
    this.worker.terminate();
    const request = this.current;
    this.waiting.forEach(({ resolve }) => resolve(undefined));
    this.waiting.clear();
    this.start();
    request?.reject({ message: "stopped" });
    clearTimeout(this.timer);
    this.slow(false);
  }
}
