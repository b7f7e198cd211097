"""Models: what a mechanism's text becomes."""

from __future__ import annotations

import difflib
import functools
import html
import keyword
import os
import re
import warnings
from collections import namedtuple
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _mbs
from ._mechanism import Mechanism

Floats = NDArray[np.float64]


class PoseResult(NamedTuple):
    """Position and rotation of a frame: a point `x` of the body is at `position + rotation @ x`."""

    position: Floats
    rotation: Floats


class WrenchResult(NamedTuple):
    """Force and moment that a joint transmits, in the axes of its pose, about its origin."""

    force: Floats
    moment: Floats


class StateSpace(NamedTuple):
    """`d/dt [q, qd] = A [q, qd] + B u`, in the neighbourhood of a state."""

    A: Floats
    B: Floats


@dataclass(frozen=True)
class Event:
    """Where `function(t, q, qd)` passes zero during a motion, and what happens there.

    `direction`: 1 for rising, -1 for falling, 0 for both. `terminal`: whether the motion ends there.
    `action(t, q, qd)` returns `None` (go on), `"stop"`, `"restart"` (the right-hand side has changed), or a pair
    `(q, qd)` from which the motion goes on.
    """

    function: Callable[[float, Floats, Floats], float]
    direction: int = 0
    terminal: bool = False
    action: Callable[[float, Floats, Floats], Any] | None = None


class EventTime(NamedTuple):
    """When an event happened, and the state before its action."""

    event: int
    t: float
    q: Floats
    qd: Floats


# Arrays have no one truth by which motions could be equal, and no hash.
@dataclass(frozen=True, repr=False, eq=False)
class Trajectory:
    """A motion: `q[i]` and `qd[i]` at `t[i]`; it is equal to itself alone."""

    t: Floats
    q: Floats
    qd: Floats
    #: Events in the order in which they happened.
    events: list[EventTime]
    #: `(t, q, qd)` where the motion ended.
    end: tuple[float, Floats, Floats]
    #: Whether an event ended it.
    stopped: bool
    #: Accelerations evaluated, steps accepted, steps rejected.
    counts: tuple[int, int, int]
    #: Names and units of the coordinates.
    coordinates: list[tuple[str, str]] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, name: str) -> Floats:
        """A coordinate over time by its name; `x_dot` is its velocity."""
        names = [own for own, _ in self.coordinates]
        for values, known in [(self.q, names), (self.qd, [f"{own}_dot" for own in names])]:
            if name in known:
                return values[:, known.index(name)]
        raise ValueError(f"there is no coordinate {name!r}{_hint(name, names)}")

    def __repr__(self) -> str:
        evaluations, accepted, _ = self.counts
        return (
            f"<Trajectory of {len(self.t)} rows to t = {self.end[0]:.6g} s, {len(self.events)} events, "
            f"{accepted} steps, {evaluations} accelerations>"
        )


class Parameters(Mapping[str, Any]):
    """Parameters by name: `params.m`, `params["m"]`; of an array `params.mass[2]`, `params["mass_2"]`.

    They are looked at whenever they are set: a mechanism cannot have a negative mass.
    """

    __slots__ = ("_core", "_variables", "_components")

    def __init__(self, core: _mbs.Core, variables: list[dict[str, Any]]) -> None:
        object.__setattr__(self, "_core", core)
        object.__setattr__(self, "_variables", {v["name"]: v for v in variables})
        components = {name: v["first"] + i for v in variables for i, name in enumerate(v["components"])}
        object.__setattr__(self, "_components", components)

    def _place(self, name: str) -> tuple[slice, tuple[int, ...], str]:
        if name in self._variables:
            v = self._variables[name]
            return slice(v["first"], v["first"] + v["count"]), tuple(v["shape"]), v["unit"]
        if name in self._components:
            first = self._components[name]
            return slice(first, first + 1), (), ""
        raise ValueError(f"there is no parameter {name!r}{_hint(name, list(self._variables))}")

    def __getitem__(self, name: str) -> Any:
        place, shape, _ = self._place(name)
        values = self._core.parameters[place]
        return float(values[0]) if not shape else _Values(self, name, values.reshape(shape))

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        self.update({name: value})

    def update(self, values: Mapping[str, ArrayLike] | None = None, /, **named: ArrayLike) -> None:
        """Sets several at once; if one of them is refused, none is set."""
        flat = self._core.parameters
        for name, value in {**(values or {}), **named}.items():
            place, shape, _ = self._place(name)
            try:
                given = np.asarray(value)
                if given.dtype.kind not in "fiub":
                    raise ValueError(f"real numbers are expected, found {value!r}")
                if given.shape != shape:
                    raise ValueError(f"expected the shape {shape}, found {given.shape}")
            except (ValueError, TypeError) as error:
                raise ValueError(f"params: {name}: {error}") from None
            flat[place] = given.astype(float).ravel()
        self._core.set_parameters(flat)

    def __contains__(self, name: object) -> bool:
        return name in self._variables or name in self._components

    def get(self, name: str, default: Any = None) -> Any:
        """A parameter, or `default` where there is none of this name."""
        return self[name] if name in self else default  # noqa: SIM401 - it is get

    def __eq__(self, other: object) -> bool:
        """Whether names and values are the same, those of arrays entry by entry."""
        if not isinstance(other, Mapping):
            return NotImplemented
        return self.keys() == other.keys() and all(np.array_equal(self[name], other[name]) for name in self)

    def unit(self, name: str) -> str:
        """The unit of a parameter."""
        if name not in self._variables:
            raise ValueError(f"there is no parameter {name!r}{_hint(name, list(self._variables))}")
        return str(self._variables[name]["unit"])

    def __iter__(self) -> Iterator[str]:
        return iter(self._variables)

    def __len__(self) -> int:
        return len(self._variables)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name in Parameters.__slots__:
            raise AttributeError(name)
        try:
            return self[name]
        except ValueError as error:
            raise AttributeError(str(error)) from None

    def __setattr__(self, name: str, value: ArrayLike) -> None:
        if hasattr(Parameters, name):
            raise AttributeError(f"params.{name} is no parameter; params[{name!r}] is")
        self[name] = value

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy, and what is pickled, are the values by name."""
        return dict, ({name: _copied(self[name]) for name in self},)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._variables]

    def __repr__(self) -> str:
        values = (f"{name} = {_plain(self[name])} {v['unit']}" for name, v in self._variables.items())
        return "\n".join(values) or "no parameters"


class _Values(np.ndarray):
    """An array of parameters: where an entry is set, the model's parameter is.

    It is read-only for NumPy, and so are its views, which the model would not see change.
    """

    _parameters: Parameters | None
    _name: str
    _own: Floats

    def __new__(cls, parameters: Parameters, name: str, values: Floats) -> _Values:
        array = values.view(cls)
        array._parameters, array._name, array._own = parameters, name, values
        array.flags.writeable = False
        return array

    def __array_finalize__(self, other: Any) -> None:
        self._parameters, self._name = None, ""

    def __setitem__(self, index: Any, value: Any) -> None:
        if self._parameters is None:
            super().__setitem__(index, value)
            return
        # The parameter may have been set otherwise since this array was made.
        new = np.array(self._parameters[self._name])
        new[index] = value
        self._parameters[self._name] = new
        self._own[...] = new

    def _in_place(self, function: np.ufunc, other: Any) -> Any:
        present = self if self._parameters is None else self._parameters[self._name]
        self[...] = function(np.asarray(present), other)
        return self

    def __iadd__(self, other: Any) -> Any:  # type: ignore[misc]
        return self._in_place(np.add, other)

    def __isub__(self, other: Any) -> Any:  # type: ignore[misc]
        return self._in_place(np.subtract, other)

    def __imul__(self, other: Any) -> Any:  # type: ignore[misc]
        return self._in_place(np.multiply, other)

    def __itruediv__(self, other: Any) -> Any:  # type: ignore[misc]
        return self._in_place(np.divide, other)


def _copied(value: Any) -> Any:
    return value if isinstance(value, float) else np.array(value)


def _plain(value: Any) -> str:
    return repr(value) if isinstance(value, float) else str(np.asarray(value).tolist())


def _hint(name: object, known: Sequence[str]) -> str:
    near = difflib.get_close_matches(str(name), known, 1)
    if near:
        return f"; did you mean {near[0]!r}?"
    return f"; there are {', '.join(known[:12])}" if known else "; there are none"


def _pose(values: Floats) -> PoseResult:
    return PoseResult(values[..., :3], values[..., 3:].reshape((*values.shape[:-1], 3, 3)))


def _wrench(values: Floats) -> WrenchResult:
    return WrenchResult(values[..., :3], values[..., 3:])


class Model:
    """A mechanism with its generated functions, each of them a method.

    They take one state or many: leading axes broadcast, results have the same leading axes. Arguments are named `t`,
    `prescribed`, `q`, `qd`, `qdd`, `u`, `multipliers`, as far as the mechanism has them.
    """

    def __init__(self, core: _mbs.Core, info: dict[str, Any] | None = None) -> None:
        self._core = core
        self._info = info or core.info
        count = len(self._info["functions"])
        self._functions = [core.function(number) for number in range(count)]
        self._params = Parameters(core, self._info["parameters"])

    # ---- what there is

    @property
    def name(self) -> str:
        """As declared."""
        return str(self._info["name"])

    @property
    def dof(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def coordinates(self) -> list[str]:
        """Names of the coordinates, component by component."""
        return _components(self._info["coordinates"])

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs, component by component."""
        return _components(self._info["inputs"])

    @property
    def prescribed(self) -> list[str]:
        """Names of the prescribed motions, component by component."""
        return _components(self._info["prescribed"])

    @property
    def constraints(self) -> list[str]:
        """Names of the rows of constraints."""
        return list(self._info["constraints"])

    @property
    def units(self) -> dict[str, str]:
        """Units of coordinates, parameters, inputs and prescribed motions by name."""
        kinds = ["coordinates", "parameters", "inputs", "prescribed"]
        return {v["name"]: v["unit"] for kind in kinds for v in self._info[kind]}

    @property
    def functions(self) -> dict[str, Callable[..., Any]]:
        """The generated functions by name."""
        return {f["name"]: getattr(self, type(self)._methods[f["name"]]) for f in self._info["functions"]}

    @property
    def warnings(self) -> str:
        """What is to be said of the declaration."""
        return str(self._info["warnings"])

    @property
    def backend(self) -> str:
        """`c`, or `interpreter` where nothing could be compiled; see `interpreted`, `not_compiled`."""
        return "interpreter" if self._info["not_compiled"] else "c"

    @property
    def not_compiled(self) -> str | None:
        """Why nothing is compiled; `None` where it is."""
        reason = self._info["not_compiled"]
        return None if reason is None else str(reason)

    @property
    def interpreted(self) -> list[str]:
        """Functions that are interpreted, because C does not have them or there is no compiler."""
        return [f["name"] for f in self._info["functions"] if not f["compiled"]]

    _methods: dict[str, str] = {}
    #: What it was compiled from, for copies in other processes.
    _source: tuple[Any, ...] = ()

    # ---- parameters

    @property
    def params(self) -> Parameters:
        """Parameters by name; those of a mapping are set where it is assigned."""
        return self._params

    @params.setter
    def params(self, values: Mapping[str, ArrayLike]) -> None:
        self._params.update(dict(values))

    def with_params(self, values: Mapping[str, ArrayLike] | None = None, /, **named: ArrayLike) -> Model:
        """The same mechanism, some parameters changed; this one keeps its own."""
        other = type(self)(self._core.copy(), self._info)
        other.params.update(values, **named)
        return other

    def __copy__(self) -> Model:
        return self.with_params()

    def __deepcopy__(self, memo: object) -> Model:
        return self.with_params()

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process derives it anew, of the same texts, and finds the compiled code."""
        return _restored, (type(self)._source, self._core.parameters)

    # ---- motions

    def simulate(
        self,
        q: ArrayLike | Mapping[str, float],
        qd: ArrayLike | Mapping[str, float] | None = None,
        t: tuple[float, float] | float = 10.0,
        *,
        times: ArrayLike | None = None,
        u: ArrayLike | Callable[[float, Floats, Floats], ArrayLike] | None = None,
        prescribed: ArrayLike | Callable[[float], ArrayLike] | None = None,
        events: Sequence[Event] = (),
        method: str = "dop853",
        rtol: float | None = None,
        atol: float | None = None,
        step: float | None = None,
        max_step: float | None = None,
        max_steps: int | None = None,
        project: bool = True,
    ) -> Trajectory:
        """The motion from a state.

        `t`: first and last time, or the last. `times`: when to hand out the motion, between steps from dense output;
        else at the ends of steps. `u(t, q, qd)` gives the inputs, or they stay; `prescribed(t)` gives value, rate and
        acceleration of each prescribed motion. `method`: `dop853` and `dopri5` by error control (`rtol`, by default
        1e-10, and `atol`, 1e-12; at most `max_steps` steps, ten million, none of them longer than `max_step`: what a
        motion meets for a shorter time can be stepped over), `rk4`, `gauss_legendre4`, `stormer_verlet`,
        `semi_implicit_euler` with the fixed `step`, a little less where the duration is no multiple of it. What a
        method does not have earns a warning. By default `max_step` is the largest distance of `times` and of the ends
        of `t`, without `times` a hundredth of the duration, and `step` a thousandth. With constraints the first state
        and those that actions return are brought onto them, and the motion is kept on them, unless `project` is false.

        Raises `ValueError` for wrong arguments, `mbs.SimulationError` where there is no way on.
        """
        span = (0.0, _number("t", t)) if np.ndim(t) == 0 else _pair(t)
        declared = [_event(event) for event in events]
        duration = abs(span[1] - span[0])
        controls = {"rtol": rtol, "atol": atol, "max_step": max_step, "max_steps": max_steps}
        _warn_of_idle(str(method), controls, step)
        how = (
            str(method),
            1e-10 if rtol is None else _number("rtol", rtol),
            1e-12 if atol is None else _number("atol", atol),
            duration / 1000 or 1.0 if step is None else _positive("step", step),
            _distance(times, span) or np.inf if max_step is None else _positive("max_step", max_step),
            10_000_000 if max_steps is None else _count("max_steps", max_steps),
        )
        start, rates = self._state("q", q), self._state("qd", np.zeros(self.dof) if qd is None else qd)
        found = _mbs.simulate(self._core, start, rates, span, times, how, u, prescribed, declared, bool(project))
        units = [(name, v["unit"]) for v in self._info["coordinates"] for name in v["components"]]
        happened = [EventTime(*event) for event in found.pop("events")]
        return Trajectory(**found, events=happened, coordinates=units)

    def _state(self, what: str, values: ArrayLike | Mapping[str, float]) -> ArrayLike:
        if not isinstance(values, Mapping):
            return values
        names, given = self.coordinates, np.zeros(self.dof)
        for name, value in values.items():
            if name not in names:
                raise ValueError(f"{what}: there is no coordinate {name!r}{_hint(name, names)}")
            given[names.index(name)] = _number(f"{what}[{name!r}]", value)
        return given

    def state_space(self, *args: ArrayLike, **named: ArrayLike) -> StateSpace:
        """`A` and `B` of the motion near a state; arguments as those of `linearize`."""
        slopes = self.functions["linearize"](*args, **named)
        batch, n, inputs = slopes.q.shape[:-2], self.dof, slopes.u.shape[-1]
        a, b = np.zeros((*batch, 2 * n, 2 * n)), np.zeros((*batch, 2 * n, inputs))
        a[..., :n, n:] = np.eye(n)
        a[..., n:, :n], a[..., n:, n:], b[..., n:, :] = slopes.q, slopes.qd, slopes.u
        return StateSpace(a, b)

    # ---- on paper

    def latex(self) -> str:
        """Symbols, energies and equations of motion, a document of LaTeX."""
        return str(self._info["latex"])

    def _repr_latex_(self) -> str:
        """Energies and equations of motion, as notebooks show formulas."""
        wanted = ("Energies", "Constraint", "Equations of motion")
        sections = re.split(r"\\paragraph\{", self.latex())[1:]
        shown = []
        for section in sections:
            title, _, body = section.partition("}\n")
            if title.startswith(wanted):
                blocks = re.findall(r"\\begin\{align\*\}(.*?)\\end\{align\*\}", body, re.S)
                shown += [f"$$\\begin{{aligned}}{block}\\end{{aligned}}$$" for block in blocks]
        return "\n\n".join(shown) or f"$$\\text{{{self.name}}}$$"

    def _repr_html_(self) -> str:
        """What was declared, and the functions, as tables."""
        escape = html.escape
        text = [f"<h3>{escape(self.name)}</h3>", f"<p>{escape(self._info['docs'])}</p>"]
        rows = []
        for kind in ["coordinates", "inputs", "prescribed", "parameters"]:
            for v in self._info[kind]:
                value = _plain(self.params[v["name"]]) if kind == "parameters" else ""
                shape = "".join(f"[{n}]" for n in v["shape"])
                cells = [f"<code>{escape(v['name'])}{shape}</code>", kind, escape(v["unit"]), value, escape(v["docs"])]
                rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
        head = "".join(f"<th>{name}</th>" for name in ["name", "kind", "unit", "value", "meaning"])
        text.append(f"<table><tr>{head}</tr>{''.join(rows)}</table>")
        rows = []
        for f in self._info["functions"]:
            call = escape(f"{f['name']}({', '.join(name for name, _ in f['arguments'])})")
            first = escape(f["docs"].split("\n")[0])
            rows.append(f"<tr><td><code>{call}</code></td><td>{first}</td></tr>")
        text.append(f"<table><tr><th>function</th><th>what it gives</th></tr>{''.join(rows)}</table>")
        return "".join(text)

    def __repr__(self) -> str:
        count = len(self._info["functions"])
        return f"<Model {self.name}: {self.dof} coordinates, {len(self.inputs)} inputs, {count} functions>"

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        known = [f["name"] for f in self._info["functions"]]
        raise AttributeError(f"{self.name} has no function {name!r}{_hint(name, known)}")


def _components(variables: list[dict[str, Any]]) -> list[str]:
    return [name for v in variables for name in v["components"]]


def _number(name: str, value: Any) -> float:
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: a number is expected, found {value!r}") from None
    if np.isnan(number):
        raise ValueError(f"{name}: it is NaN")
    return number


def _positive(name: str, value: Any) -> float:
    number = _number(name, value)
    if number <= 0:
        raise ValueError(f"{name}: it must be positive, found {value!r}")
    return number


def _distance(times: ArrayLike | None, span: tuple[float, float]) -> float:
    """The largest of times and of the ends of their span; without times a hundredth of it."""
    if times is None:
        return abs(span[1] - span[0]) / 100
    try:
        given = np.asarray(times, dtype=float).ravel()
    except (TypeError, ValueError):
        return np.inf  # `times` is refused where it is read.
    return float(np.max(np.abs(np.diff(given, prepend=span[0], append=span[1]))))


def _warn_of_idle(method: str, controls: Mapping[str, float | None], step: float | None) -> None:
    """Of arguments that were given and that a method does not have, as the program warns."""
    if method in ("dop853", "dopri5"):
        why, idle = "chooses its steps itself", [] if step is None else ["step"]
    elif method in ("rk4", "gauss_legendre4", "stormer_verlet", "semi_implicit_euler"):
        why, idle = "has no error control", [name for name, value in controls.items() if value is not None]
    else:
        return  # It is refused where it is read.
    if idle:
        does = "does" if len(idle) == 1 else "do"
        warnings.warn(f"{method} {why}, {', '.join(idle)} {does} nothing", stacklevel=3)


def _count(name: str, value: Any) -> int:
    number = _number(name, value)
    if not 1 <= number <= 1e15 or number != int(number):
        raise ValueError(f"{name}: a whole number from 1 on is expected, found {value!r}")
    return int(number)


def _pair(t: Any) -> tuple[float, float]:
    try:
        begin, end = t
    except (TypeError, ValueError):
        raise ValueError(f"t: the last time, or a pair of the first and the last is expected, found {t!r}") from None
    return _number("t[0]", begin), _number("t[1]", end)


def _event(event: Any) -> tuple[Callable[..., float], int, bool, Callable[..., Any] | None]:
    if not isinstance(event, Event):
        raise ValueError(f"events: mbs.Event is expected, found {event!r}")
    if not callable(event.function) or not (event.action is None or callable(event.action)):
        raise ValueError("events: function and action are called with (t, q, qd)")
    if event.direction not in (-1, 0, 1):
        raise ValueError(f"events: direction is -1, 0 or 1, found {event.direction!r}")
    return event.function, int(event.direction), bool(event.terminal), event.action


def compile(  # noqa: A001 - mbs.compile
    model: str | os.PathLike[str] | Mechanism,
    *,
    params: Mapping[str, ArrayLike] | None = None,
    freeze: Sequence[str] = (),
    backend: str = "auto",
) -> Model:
    """A mechanism, derived, proved and compiled.

    `model`: the path of a file, a text of the language (it holds a brace), or a `Mechanism`. `params`: values of
    parameters by name, else those declared. `freeze`: parameters that become constants, which makes code shorter.
    `backend`: `c` compiles by a C compiler and raises `RuntimeError` where that fails, `interpreter` does not compile,
    `auto` compiles where it can.

    Raises `mbs.ModelError`, a `ValueError` with the report, where the model is wrong.
    """
    if isinstance(freeze, str):
        raise ValueError(f"freeze: a sequence of names is expected, found {freeze!r}")
    frozen = list(dict.fromkeys(str(name) for name in freeze))
    if isinstance(model, Mechanism):
        made = _made("from_calls", model._recorded(), frozen, backend)
    elif isinstance(model, str) and "{" in model:
        made = _made("from_text", _checked(model), "<text>", frozen, backend)
    elif isinstance(model, (str, os.PathLike)):
        path = os.fspath(model)
        if not isinstance(path, str) or "\0" in path:
            raise ValueError(f"model: {model!r} is no path")
        made = _made("from_file", _checked(path), frozen, backend)
    else:
        raise ValueError(f"model: a path, a text or a mbs.Mechanism is expected, found {type(model).__name__}")
    if params:
        made.params.update(params)
    return made


def _made(*source: Any) -> Model:
    core: _mbs.Core = getattr(_mbs.Core, source[0])(*source[1:])
    info = core.info
    own = _class(info)
    # A file may have changed when the model is made anew; its text of now is kept.
    own._source = ("from_texts", core.texts, *source[-2:]) if core.texts else source
    return own(core, info)


def _restored(source: tuple[Any, ...], parameters: Floats) -> Model:
    model = _made(*source)
    model._core.set_parameters(parameters)
    return model


def _checked(text: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"model: the text is not UTF-8: {error}") from None
    return text


#: What each model keeps.
_OWN = ("_core", "_info", "_functions", "_params")


def _class(info: dict[str, Any]) -> type[Model]:
    """A class with a method for each generated function, so that `help` shows them."""
    body: dict[str, Any] = {"__doc__": _described(info), "__module__": "mbs", "_methods": {}}
    names = {function["name"] for function in info["functions"]}
    for number, function in enumerate(info["functions"]):
        own = name = function["name"]
        # An output does not take the place of what every model has; it is in `functions` all the same.
        while hasattr(Model, own) or own in _OWN or keyword.iskeyword(own) or (own != name and own in names):
            own += "_"
        body[own] = _method(number, function)
        body["_methods"][name] = own
    return type(info["name"], (Model,), body)


def _method(number: int, function: dict[str, Any]) -> Callable[..., Any]:
    names = [name for name, _ in function["arguments"]]
    declared = [f"{name}=None" if name == "multipliers" else name for name in names]
    call = f"self._functions[{number}]({', '.join(names)})"
    space: dict[str, Any] = {"_pose": _pose, "_wrench": _wrench}
    [(_, kind, _), *others] = function["results"]
    if others or function["results"][0][0]:
        space["_result"] = _named(f"{function['name']}_result", tuple(part for part, _, _ in function["results"]))
        call = f"_result._make({call})" if others else f"_result({call})"
    elif kind in ("pose", "wrench"):
        call = f"_{kind}({call})"
    exec(f"def method(self{''.join(f', {name}' for name in declared)}):\n    return {call}\n", space)
    method = space["method"]
    method.__name__ = function["name"]
    method.__qualname__ = function["name"]
    method.__module__ = "mbs"
    shapes = [f"- `{name}`: (..., {', '.join(map(str, shape))})" for name, shape in function["arguments"] if shape]
    result = [f"- {part or 'result'}: {_shape(kind, shape)}" for part, kind, shape in function["results"]]
    how = "compiled" if function["compiled"] else "interpreted"
    method.__doc__ = "\n".join(
        [function["docs"], "", "Shapes, with any leading axes:", "", *shapes, *result, "", f"It is {how}."]
    )
    return method


@functools.cache
def _named(name: str, fields: tuple[str, ...]) -> type[tuple[Any, ...]]:
    """The named tuple of a function's results, which is found again by these where it is unpickled."""
    base: Any = namedtuple(name, fields)  # type: ignore[misc]

    def reduced(self: Any) -> tuple[Any, ...]:
        return _given, (name, fields, tuple(self))

    return type(name, (base,), {"__slots__": (), "__reduce__": reduced})


def _given(name: str, fields: tuple[str, ...], values: tuple[Any, ...]) -> tuple[Any, ...]:
    return _named(name, fields)(*values)


def _shape(kind: str, shape: list[int]) -> str:
    if kind == "pose":
        return "position (..., 3), rotation (..., 3, 3)"
    if kind == "wrench":
        return "force (..., 3), moment (..., 3)"
    return f"(..., {', '.join(map(str, shape))})" if shape else "(...), of one state a number"


def _described(info: dict[str, Any]) -> str:
    lines = [info["docs"] or f"The mechanism {info['name']}.", ""]
    for kind in ["coordinates", "inputs", "prescribed", "parameters"]:
        if info[kind]:
            lines += [f"{kind.capitalize()}:", ""]
        for v in info[kind]:
            shape = "".join(f"[{n}]" for n in v["shape"])
            docs = " ".join(v["docs"].split())
            lines.append(f"- `{v['name']}{shape}` [{v['unit']}] {docs}".rstrip())
        if info[kind]:
            lines.append("")
    if info["constraints"]:
        lines += [f"Rows of constraints: {', '.join(info['constraints'])}", ""]
    lines.append(f"Proved at {info['proved_at']} states.")
    return "\n".join(lines)
