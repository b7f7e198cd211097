// The generator beside the page: whatever it takes, the page answers. One model at a time.

import { ModelError, load } from "../../mbs-wasm/mbs.js";

const mbs = load();
let model = null;

const calls = {
  async compile({ text, name, files }) {
    const start = performance.now();
    const compiled = (await mbs).compile(text, { name, files });
    model?.free();
    model = compiled;
    return { description: { ...model, ops: model.ops() }, seconds: (performance.now() - start) / 1000 };
  },
  simulate(options) {
    const start = performance.now();
    return { motion: model.simulate(options), seconds: (performance.now() - start) / 1000 };
  },
  emit: ({ language }) => ({ text: model.emit(language) }),
};

onmessage = async ({ data: { number, call, given } }) => {
  try {
    await mbs;
    postMessage({ number, result: await calls[call](given) });
  } catch (error) {
    const { name, message, report, diagnostics, t } = error;
    postMessage({ number, error: { name, message, report, diagnostics, t, isModel: error instanceof ModelError } });
  }
};
