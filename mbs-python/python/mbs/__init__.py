"""Mechanisms written as energies: derived, proved, compiled and simulated.

>>> import mbs
>>> arm = mbs.compile("arm6.mbs")                   # a file, a text, or a mbs.Mechanism
>>> tau = arm.inverse_dynamics(q, qd, qdd)          # one state, or many: leading axes broadcast
>>> motion = arm.simulate(q, qd, t=(0, 2), u=tau)   # by the methods of mbs-runtime
>>> help(arm)                                       # what was declared and derived, with units

The language of mechanisms is described in `docs/language.md` of the project, this package in `docs/python.md`.
"""

from ._mbs import ModelError, SimulationError, __version__, set_threads, threads
from ._mechanism import (
    Array,
    Mechanism,
    Pose,
    Scalar,
    Vector,
    abs,  # noqa: A004 - as in the language
    acos,
    angular_velocity,
    asin,
    atan,
    atan2,
    below,
    cos,
    cosh,
    dt,
    exp,
    hypot,
    inertia,
    ln,
    max,  # noqa: A004 - as in the language
    min,  # noqa: A004 - as in the language
    particle,
    quantity,
    rigid_body,
    rotation,
    rpy,
    signum,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
    time,
    translation,
    vector,
    world,
)
from ._model import Event, Model, Parameters, PoseResult, StateSpace, Trajectory, WrenchResult, compile

__all__ = [
    "Array",
    "Event",
    "Mechanism",
    "Model",
    "ModelError",
    "Parameters",
    "Pose",
    "PoseResult",
    "Scalar",
    "SimulationError",
    "StateSpace",
    "Trajectory",
    "Vector",
    "WrenchResult",
    "__version__",
    "abs",
    "acos",
    "angular_velocity",
    "asin",
    "atan",
    "atan2",
    "below",
    "compile",
    "cos",
    "cosh",
    "dt",
    "exp",
    "hypot",
    "inertia",
    "ln",
    "max",
    "min",
    "particle",
    "quantity",
    "rigid_body",
    "rotation",
    "rpy",
    "set_threads",
    "signum",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
    "threads",
    "time",
    "translation",
    "vector",
    "world",
]
