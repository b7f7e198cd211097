"""What the tests share: the repository's mechanisms, compiled once, and random states of them."""

import functools
import os
import pathlib
import tempfile

import numpy as np
import pytest

# Compiled code of tests stays out of the user's cache.
os.environ.setdefault("MBS_CACHE_DIR", tempfile.mkdtemp(prefix="mbs-tests-"))

import mbs  # noqa: E402 - after the folder is chosen

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = [ROOT / "models" / "mechanisms", ROOT / "tests" / "mechanisms"]

#: One of each kind: a chain, friction and input, prescribed motions, branches, tables, loops, unit quaternions,
#: reactions with and without loops, velocities that are constrained.
NAMES = [
    "arm6",
    "pendulum",
    "shaken_pendulum",
    "branches",
    "measured_slider",
    "four_bar",
    "quadrotor_quaternion",
    "arm_with_reactions",
    "four_bar_with_reactions",
    "chaplygin_sleigh",
]


def path(name):
    return next(folder / f"{name}.mbs" for folder in FOLDERS if (folder / f"{name}.mbs").exists())


@functools.cache
def model(name, backend="auto"):
    return mbs.compile(path(name), backend=backend)


def states(model, count, seed):
    """Arguments of every function by name, `count` of each."""
    random = np.random.default_rng(seed)
    sizes = {}
    for function in model._info["functions"]:
        for name, shape in function["arguments"]:
            sizes.setdefault(name, tuple(shape))
    return {name: random.uniform(-1.5, 1.5, (count, *sizes[name])) for name in sorted(sizes)}


def arguments(model, name, states):
    function = next(f for f in model._info["functions"] if f["name"] == name)
    return [states[argument] for argument, _ in function["arguments"]]


def parts(result):
    """The arrays of a result."""
    return list(map(np.asarray, result)) if isinstance(result, tuple) else [np.asarray(result)]


def same_bits(a, b):
    """To the bit; NaN is NaN."""
    a, b = np.ascontiguousarray(a, float), np.ascontiguousarray(b, float)
    return a.shape == b.shape and bool(np.all((a.view(np.int64) == b.view(np.int64)) | (np.isnan(a) & np.isnan(b))))


@pytest.fixture(params=NAMES)
def name(request):
    return request.param
