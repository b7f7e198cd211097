#!/usr/bin/env bash
# Tests of what `mbs report` and `mbs simulate --gltf` write: their numbers in node, the pages in Chromium, animations
# in Khronos' validator, which npm puts into a folder of its own. What is not there is skipped by name. MBS is the
# program, built already.
set -euo pipefail
cd "$(dirname "$0")"
MBS="${MBS:-$PWD/../../../target/release/mbs}"
export MBS
[ -x "$MBS" ] || { echo "skipped: reports, $MBS is not built"; exit 0; }
node --version 2> /dev/null | grep -qE '^v(2[0-9]|[3-9][0-9])' || { echo "skipped: reports, there is no node 20"; exit 0; }
command -v "${CHROMIUM:-chromium}" chromium-browser google-chrome > /dev/null 2>&1 ||
  echo "skipped: reports in a browser, there is no Chromium"
if [ -z "${GLTF_VALIDATOR:-}" ]; then
  GLTF_VALIDATOR="$(mktemp -d)"
  trap 'rm -rf "$GLTF_VALIDATOR"' EXIT
  (cd "$GLTF_VALIDATOR" && npm init -y && npm install --silent gltf-validator) > /dev/null 2>&1 ||
    echo "skipped: animations in the validator, there is no npm or no network"
fi
export GLTF_VALIDATOR
node --test --test-reporter=spec ./*.test.mjs
