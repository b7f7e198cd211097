"""Runs every function of every mechanism of a list on the batch of states of a file, and writes all numbers."""

import importlib
import json
import sys

import numpy as np

sys.path.insert(0, ".")


def flat(result, states):
    """Row by row; of a pose its position, then its rotation."""
    if not isinstance(result, tuple):
        return np.reshape(result, (states, -1))
    if type(result).__name__ in ("Pose", "Wrench"):
        axes = result[0].shape[:-1]
        return np.concatenate([part.reshape((*axes, -1)) for part in result], axis=-1).reshape((states, -1))
    return np.concatenate([flat(part, states) for part in result], axis=1)


with open("list.json", encoding="utf-8") as file:
    mechanisms = json.load(file)
for mechanism in mechanisms:
    states = mechanism["states"]
    module = importlib.import_module(mechanism["file"])
    machine = getattr(module, mechanism["class"])()
    numbers = np.fromfile(mechanism["name"] + ".states").reshape((states, -1))
    given, place = {}, 0
    for argument, count in mechanism["layout"]:
        given[argument] = numbers[:, place : place + count]
        place += count
    given["t"] = given["t"][:, 0]
    given["prescribed"] = given["prescribed"].reshape((states, -1, 3))
    with open(mechanism["name"] + ".python.results", "wb") as file:
        for function in mechanism["functions"]:
            call = getattr(machine, function["python"])
            batch = call(*[given[argument] for argument in function["takes"]])
            results = flat(batch, states) if function["takes"] else np.tile(flat(batch, 1), (states, 1))
            results.tofile(file)
            # A state by itself gives the same numbers as within the batch.
            last = flat(call(*[given[argument][-1] for argument in function["takes"]]), 1)
            assert np.array_equal(last[0], results[-1], equal_nan=True), function["python"]
