#!/usr/bin/env bash
# Builds the wheel, installs it in a virtual environment of its own, runs the tests. Prints `skipped: NAME, reason`
# where Python, its package index or the C compiler is missing.
set -euo pipefail
cd "$(dirname "$0")"
skip() { echo "skipped: mbs-python, $1"; exit 0; }
python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2> /dev/null || skip "there is no Python 3.10 or later"
python3 -c 'import venv, ensurepip' 2> /dev/null || skip "Python has no venv"
command -v cc > /dev/null || command -v gcc > /dev/null || command -v clang > /dev/null \
  || echo "skipped: compiled functions of mbs-python, there is no C compiler"
cargo fmt --check
export CARGO_TARGET_DIR="${MBS_PYTHON_TARGET_DIR:-$PWD/target}"
environment="$CARGO_TARGET_DIR/venv"
[ -x "$environment/bin/python" ] || python3 -m venv "$environment"
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check 'maturin>=1.8,<2' numpy pytest ruff mypy \
  || skip "pip installs no packages here"
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check distributed \
  || echo "skipped: ensembles under Dask, pip does not install distributed"
# shellcheck disable=SC1091
. "$environment/bin/activate"
rm -rf "$CARGO_TARGET_DIR/wheels"
maturin build --release --locked --quiet --out "$CARGO_TARGET_DIR/wheels"
pip install --quiet --disable-pip-version-check --force-reinstall --no-deps "$CARGO_TARGET_DIR"/wheels/mbs-*.whl
ruff check --quiet .
# `-rs` names what was skipped, and why; the package that is tested is the one installed.
python -m pytest -q -rs -p no:cacheprovider tests
