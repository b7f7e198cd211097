#!/usr/bin/env bash
# Tests of the extension for VS Code and of the tree-sitter grammar; what is not there is skipped by name.
set -euo pipefail
cd "$(dirname "$0")"

node --version 2> /dev/null | grep -qE '^v(2[0-9]|[3-9][0-9])' || { echo "skipped: editors, there is no node 20"; exit 0; }
command -v npm > /dev/null || { echo "skipped: editors, there is no npm"; exit 0; }

# In a copy: nothing is installed into the sources.
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
npm_install() { npm install --silent --no-audit --no-fund "$@" > "$work/npm.log" 2>&1; }

echo "VS Code: manifest, client, TextMate grammar"
if (cd vscode && npm_install --no-save --no-package-lock vscode-textmate@^9.2.0 vscode-oniguruma@^2.0.1 --prefix "$work/vscode"); then
  NODE_PATH="$work/vscode/node_modules" node --test --test-reporter=spec vscode/test/*.test.mjs
else echo "skipped: editors/vscode, npm installs nothing (no network?)"; fi

# The program of tree-sitter: as installed, or from npm, whose package fetches it from elsewhere.
echo "tree-sitter: corpus, and every good mechanism"
cp -r tree-sitter-mbs "$work/grammar"
if command -v tree-sitter > /dev/null; then tree_sitter=tree-sitter
elif (cd "$work/grammar" && npm_install tree-sitter-cli@^0.25.0); then tree_sitter="$work/grammar/node_modules/.bin/tree-sitter"
else echo "skipped: editors/tree-sitter-mbs, npm does not install tree-sitter-cli and it is not on the path"; exit 0; fi
command -v "${CC:-cc}" > /dev/null || { echo "skipped: editors/tree-sitter-mbs, there is no C compiler"; exit 0; }
root="$(cd .. && pwd)"
find "$root"/{models,tests/mechanisms,tests/platform,tests/misprints,examples,mbs-cli/tests} -name '*.mbs' \
  -not -path '*/target/*' > "$work/mechanisms.txt"
blocks="$work" node -e '
  const fs = require("fs"), text = fs.readFileSync("../docs/language.md", "utf8") + fs.readFileSync("../README.md", "utf8");
  let count = 0;
  for (const [, block] of text.matchAll(/^```mbs(?: [^\n]*\.mbs)?\n([^]*?)^```/gm)) {
    const path = `${process.env.blocks}/block${count++}.mbs`;
    fs.writeFileSync(path, block);
    fs.appendFileSync(`${process.env.blocks}/mechanisms.txt`, `${path}\n`);
  }'
cd "$work/grammar"
export XDG_CACHE_HOME="$work/cache" HOME="$work"
"$tree_sitter" generate
"$tree_sitter" test
# It fails where a tree has an ERROR node.
"$tree_sitter" parse --quiet --stat --paths "$work/mechanisms.txt" 2> /dev/null | grep 'Total parses' || true
"$tree_sitter" parse --quiet --paths "$work/mechanisms.txt" > /dev/null 2>&1
"$tree_sitter" query --quiet queries/highlights.scm --paths "$work/mechanisms.txt" 2> /dev/null > /dev/null
