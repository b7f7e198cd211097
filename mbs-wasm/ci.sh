#!/usr/bin/env bash
# Builds the WebAssembly and runs its tests; what is not there is skipped by name. `ci.sh build` builds it alone;
# `ci.sh site FOLDER` puts the playground with all that it asks for into a folder that any file server serves.
set -euo pipefail
target=wasm32-unknown-unknown

if [ "${1:-}" = site ]; then
  folder="$(realpath "${2:?ci.sh site FOLDER}")"
  cd "$(dirname "$0")/.."
  [ -f mbs-wasm/mbs_wasm.wasm ] || mbs-wasm/ci.sh build
  # The same places as here, so that the same addresses lead there.
  for file in docs/playground/* models/mechanisms/*.mbs mbs-cli/src/report/plot.js mbs-wasm/mbs.js mbs-wasm/mbs_wasm.wasm; do
    mkdir -p "$folder/$(dirname "$file")"
    cp "$file" "$folder/$file"
  done
  # The empty icon keeps browsers from asking for /favicon.ico.
  echo '<!doctype html><meta http-equiv="refresh" content="0; url=docs/playground/"><link rel="icon" href="data:,"><title>mbs</title>' \
    > "$folder/index.html"
  exit 0
fi
cd "$(dirname "$0")"

rustup target list --installed 2> /dev/null | grep -qx "$target" || rustup target add "$target" > /dev/null 2>&1 ||
  { echo "skipped: mbs-wasm, the target $target is not installed"; exit 0; }
[ "${1:-}" = build ] || cargo fmt --check
cargo build --locked --profile page --lib --target "$target"
cp "${CARGO_TARGET_DIR:-target}/$target/page/mbs_wasm.wasm" mbs_wasm.wasm
echo "mbs_wasm.wasm: $(wc -c < mbs_wasm.wasm) bytes, $(gzip -9 -c mbs_wasm.wasm | wc -c) compressed"
[ "${1:-}" != build ] || exit 0

cargo clippy --locked --profile page --lib --target "$target" -- -D warnings
node --version 2> /dev/null | grep -qE '^v(2[0-9]|[3-9][0-9])' || { echo "skipped: tests of mbs-wasm, there is no node 20"; exit 0; }
cargo build --locked --bin native
absolute() { case "$1" in /*) echo "$1" ;; *) echo "$PWD/$1" ;; esac; }
MBS_NATIVE="$(absolute "${CARGO_TARGET_DIR:-target}/debug/native")"
MBS="$(absolute "${MBS:-${CARGO_TARGET_DIR:-../target}/release/mbs}")"
export MBS_NATIVE MBS
[ -x "$MBS" ] || echo "skipped: code beside that of the program mbs, $MBS is not built"
command -v "${CHROMIUM:-chromium}" chromium-browser google-chrome > /dev/null 2>&1 ||
  echo "skipped: the page in a browser, there is no Chromium"
node --test --test-reporter=spec tests/*.test.mjs
