// For the linter of generated modules: `eslint -c eslint.config.mjs *.mjs`.
import js from "@eslint/js";

export default [js.configs.recommended];
