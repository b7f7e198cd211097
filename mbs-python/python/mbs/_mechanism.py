"""Mechanisms written as Python values: calls are recorded here, and made anew on the builder of mbs-derive."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Sequence
from typing import Any, TypeVar

import numpy as np

Place = tuple[str, int, int]
Call = tuple[str, list[int], list[float], list[str], Place]


_UNKNOWN = "its value is not known before the motion; mbs.below chooses between two values"


class _Value:
    """One recorded call and the values that it is given."""

    __slots__ = ("_name", "_operands", "_numbers", "_words", "_made")
    __array_ufunc__ = None  # NumPy's operators leave it to ours

    def __init__(
        self, name: str, operands: Sequence[_Value] = (), numbers: Sequence[float] = (), words: Sequence[str] = ()
    ) -> None:
        self._name = name
        self._operands = tuple(operands)
        self._numbers = tuple(_number(name, number) for number in numbers)
        self._words = tuple(_word(name, word) for word in words)
        frame = sys._getframe(1)
        while frame.f_globals.get("__name__") == __name__ and frame.f_back is not None:
            frame = frame.f_back
        self._made = (frame.f_code, frame.f_lasti, frame.f_lineno)

    def _place(self) -> Place:
        """Where it was written, as reports name it."""
        code, instruction, line = self._made
        column: int | None = 0
        if hasattr(code, "co_positions"):
            positions = itertools.islice(code.co_positions(), instruction // 2, None)
            line, _, column, _ = next(positions, (line, line, 0, 0))
        return code.co_filename, line or 1, (column or 0) + 1

    def __bool__(self) -> bool:
        raise TypeError(_UNKNOWN)

    def __eq__(self, other: object) -> bool:
        raise TypeError(f"{_UNKNOWN}; `is` tells objects apart")

    def __ne__(self, other: object) -> bool:
        raise TypeError(f"{_UNKNOWN}; `is` tells objects apart")

    # A key of a mapping is told by what it is.
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self._name}{' '.join(('', *self._words))}>"


class Scalar(_Value):
    """A number with a dimension; plain numbers of Python have none."""

    __slots__ = ()

    def __add__(self, other: Scalar | float) -> Scalar:
        return _combined("add", self, other)

    def __radd__(self, other: Scalar | float) -> Scalar:
        return _combined("add", other, self)

    def __sub__(self, other: Scalar | float) -> Scalar:
        return _combined("sub", self, other)

    def __rsub__(self, other: Scalar | float) -> Scalar:
        return _combined("sub", other, self)

    def __mul__(self, other: Any) -> Any:
        return _combined("mul", self, other)

    def __rmul__(self, other: Any) -> Any:
        return _combined("mul", other, self)

    def __truediv__(self, other: Scalar | float) -> Scalar:
        return _combined("div", self, other)

    def __rtruediv__(self, other: Scalar | float) -> Scalar:
        return _combined("div", other, self)

    def __pow__(self, exponent: Scalar | float) -> Scalar:
        return Scalar("pow", [self, _scalar(exponent)])

    def __rpow__(self, base: float) -> Scalar:
        return Scalar("pow", [_scalar(base), self])

    def __abs__(self) -> Scalar:
        return Scalar("abs", [self])

    def __neg__(self) -> Scalar:
        return Scalar("neg", [self])

    def __pos__(self) -> Scalar:
        return self

    def dt(self) -> Scalar:
        """The total time derivative."""
        return Scalar("dt", [self])


class Vector(_Value):
    """A vector that knows its axes, or a place that knows its frame."""

    __slots__ = ()

    def __add__(self, other: VectorLike) -> Vector:
        return _combined("add", self, other)

    def __radd__(self, other: VectorLike) -> Vector:
        return _combined("add", other, self)

    def __sub__(self, other: VectorLike) -> Vector:
        return _combined("sub", self, other)

    def __rsub__(self, other: VectorLike) -> Vector:
        return _combined("sub", other, self)

    def __mul__(self, other: Scalar | float) -> Vector:
        return _combined("mul", self, other)

    def __rmul__(self, other: Scalar | float) -> Vector:
        return _combined("mul", other, self)

    def __truediv__(self, other: Scalar | float) -> Vector:
        return _combined("div", self, other)

    def __neg__(self) -> Vector:
        return Vector("neg", [self])

    def __pos__(self) -> Vector:
        return self

    @property
    def x(self) -> Scalar:
        """The component along the world's x."""
        return Scalar("x", [self])

    @property
    def y(self) -> Scalar:
        """The component along the world's y."""
        return Scalar("y", [self])

    @property
    def z(self) -> Scalar:
        """The component along the world's z."""
        return Scalar("z", [self])

    def dot(self, other: VectorLike) -> Scalar:
        """The scalar product."""
        return Scalar("dot", [self, _vector(other)])

    def cross(self, other: VectorLike) -> Vector:
        """The vector product."""
        return Vector("cross", [self, _vector(other)])

    def norm(self) -> Scalar:
        """The length; its derivative is undefined at 0."""
        return Scalar("norm", [self])

    def norm_squared(self) -> Scalar:
        """The square of the length."""
        return Scalar("norm_squared", [self])

    def dt(self) -> Vector:
        """The total time derivative, as seen from the world."""
        return Vector("dt", [self])


class Pose(_Value):
    """Position and attitude of a frame, built on others by `*`."""

    __slots__ = ()

    def __mul__(self, other: Any) -> Any:
        return _combined("mul", self, other)

    def inverse(self) -> Pose:
        """The world as seen from the frame."""
        return Pose("inverse", [self])

    def origin(self) -> Vector:
        """The place of the frame."""
        return Vector("origin", [self])

    def point(self, coordinates: VectorLike) -> Vector:
        """The place with these coordinates in the frame."""
        return Vector("point", [self, _vector(coordinates)])


class Array(_Value, Sequence[Scalar]):
    """Several coordinates, inputs or parameters of one name."""

    __slots__ = ("_elements",)

    def __init__(self, name: str, numbers: Sequence[float], words: Sequence[str], count: int) -> None:
        super().__init__(name, (), numbers, words)
        self._elements = [Scalar("element", [self], [i]) for i in range(count)]

    def __len__(self) -> int:
        return len(self._elements)

    def __getitem__(self, index: Any) -> Any:
        return self._elements[index]

    def __iter__(self) -> Iterator[Scalar]:
        return iter(self._elements)


ScalarLike = Scalar | float
VectorLike = Vector | Sequence[ScalarLike]
_V = TypeVar("_V", bound=_Value)


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise ValueError(f"{name}: a number is expected, found {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name}: {value!r} is too large") from None


def _word(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{name}: a name or a unit is expected, found {value!r}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name}: {value!r} is no text") from None
    return value


def _scalar(value: Any) -> Scalar:
    return value if isinstance(value, Scalar) else Scalar("number", [], [value])


def _is_list(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim > 0)


def _vector(value: Any) -> Vector:
    if isinstance(value, Vector):
        return value
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise ValueError(f"a vector is three numbers, found {value!r}") from None
    return Vector("vector", [_scalar(x), _scalar(y), _scalar(z)])


def _pose(value: Any) -> Pose:
    if not isinstance(value, Pose):
        raise ValueError(f"a pose is expected, found {value!r}")
    return value


#: What operators take and give.
_PAIRS: dict[tuple[str, type, type], type] = {
    **{(name, Scalar, Scalar): Scalar for name in ["add", "sub", "mul", "div"]},
    **{(name, Vector, Vector): Vector for name in ["add", "sub"]},
    ("mul", Scalar, Vector): Vector,
    ("mul", Vector, Scalar): Vector,
    ("div", Vector, Scalar): Vector,
    ("mul", Pose, Vector): Vector,
    ("mul", Pose, Pose): Pose,
}


def _combined(operator: str, left: Any, right: Any) -> Any:
    def valued(value: Any) -> Any:
        if isinstance(value, (Scalar, Vector, Pose)):
            return value
        if isinstance(value, (int, float, np.integer, np.floating)):
            return _scalar(value)
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return valued(value[()])
        if _is_list(value) and len(value) == 3:
            return _vector(value)
        return None

    a, b = valued(left), valued(right)
    kind = _PAIRS.get((operator, type(a), type(b)))
    if kind is None:
        return NotImplemented
    return kind(operator, [a, b])


class Mechanism:
    """A mechanism that is being written, statement by statement, as in the language of the same words.

    >>> m = Mechanism("Pendulum", "A bob on a thread.")
    >>> mass, length, g = m.param("m", "kg", 1.0), m.param("l", "m", 0.5), m.param("g", "m/s^2", 9.81)
    >>> theta = m.coord("theta", "rad")
    >>> bob = vector(length * sin(theta), 0, -length * cos(theta))
    >>> m.kinetic(particle(mass, bob))
    >>> m.potential(mass * g * bob.z)
    >>> m.output("tip", bob)
    """

    def __init__(self, name: str, doc: str = "", *, dimensionless: bool = False) -> None:
        self.name = _word("name", name)
        self._statements: list[_Value] = [_Value("mechanism", words=[name, doc])]
        if dimensionless:
            self._say("dimensionless")

    def _say(
        self, name: str, operands: Sequence[_Value] = (), numbers: Sequence[float] = (), words: Sequence[str] = ()
    ) -> None:
        self._statements.append(_Value(name, operands, numbers, words))

    def _declare(self, value: _V, doc: str) -> _V:
        if doc:
            self._say("doc", words=[doc])
        self._statements.append(value)
        return value

    # ---- declarations

    def param(self, name: str, unit: str, default: float, *, positive: bool = False, doc: str = "") -> Scalar:
        """A parameter with its default; `positive`: refused where it is not."""
        return self._declare(Scalar("positive" if positive else "param", [], [default], [name, unit]), doc)

    def params(self, name: str, unit: str, defaults: Sequence[float], *, doc: str = "") -> Array:
        """An array of parameters."""
        return self._declare(Array("params", list(defaults), [name, unit], _length(name, len(defaults))), doc)

    def coord(self, name: str, unit: str, *, doc: str = "") -> Scalar:
        """A generalized coordinate, in a unit of the SI."""
        return self._declare(Scalar("coord", [], [], [name, unit]), doc)

    def coords(self, name: str, count: int, unit: str, *, doc: str = "") -> Array:
        """An array of coordinates."""
        return self._declare(Array("coords", [count], [name, unit], _length(name, count)), doc)

    def input(self, name: str, unit: str, *, doc: str = "") -> Scalar:
        """What is given at every moment of the motion."""
        return self._declare(Scalar("input", [], [], [name, unit]), doc)

    def inputs(self, name: str, count: int, unit: str, *, doc: str = "") -> Array:
        """An array of inputs."""
        return self._declare(Array("inputs", [count], [name, unit], _length(name, count)), doc)

    def prescribed(self, name: str, unit: str, formula: ScalarLike | None = None, *, doc: str = "") -> Scalar:
        """A motion that is a formula of the time, or given at run time with its first and second derivative."""
        if formula is None:
            return self._declare(Scalar("signal", [], [], [name, unit]), doc)
        return self._declare(Scalar("prescribed", [_scalar(formula)], [], [name, unit]), doc)

    # ---- energies and forces

    def kinetic(self, energy: ScalarLike) -> None:
        """A term of T, in J."""
        self._say("kinetic", [_scalar(energy)])

    def potential(self, energy: ScalarLike) -> None:
        """A term of V, in J."""
        self._say("potential", [_scalar(energy)])

    def dissipation(self, power: ScalarLike) -> None:
        """A term of Rayleigh's function, in W."""
        self._say("dissipation", [_scalar(power)])

    def lagrangian(self, energy: ScalarLike) -> None:
        """A term of L that is neither T nor -V, in J."""
        self._say("lagrangian", [_scalar(energy)])

    def gravity(self, acceleration: VectorLike) -> None:
        """The uniform field that all bodies weigh in."""
        self._say("gravity", [_vector(acceleration)])

    def force(self, coordinate: Scalar, force: ScalarLike) -> None:
        """A generalized force on a coordinate, as it acts on the mechanism."""
        self._say("force", [_scalar(coordinate), _scalar(force)])

    def force_at(self, point: VectorLike, force: VectorLike) -> None:
        """A force at a place, in N."""
        self._say("force_at", [_vector(point), _vector(force)])

    def torque_on(self, pose: Pose, torque: VectorLike) -> None:
        """A torque on a frame, in N m."""
        self._say("torque_on", [_pose(pose), _vector(torque)])

    # ---- constraints, outputs, reactions

    def constraint(self, name: str, left: Any, right: Any, *, doc: str = "") -> None:
        """`left = right`, of numbers or of vectors."""
        is_vector = any(isinstance(side, Vector) or _is_list(side) for side in (left, right))
        sides = [_vector(side) if is_vector else _scalar(side) for side in (left, right)]
        self._declare(_Value("constraint", sides, (), [name]), doc)

    def output(self, name: str, value: Any, *, doc: str = "") -> None:
        """A value whose velocity and Jacobian are generated, too."""
        if not isinstance(value, (Vector, Pose)):
            value = _vector(value) if _is_list(value) else _scalar(value)
        self._declare(_Value("output", [value], (), [name]), doc)

    def reaction(self, name: str, pose: Pose, *, doc: str = "") -> Pose:
        """What a joint transmits to the part that is built on the pose which is returned."""
        return self._declare(Pose("reaction", [_pose(pose)], (), [name]), doc)

    # ---- what the builder reads

    def _recorded(self) -> list[Call]:
        """The calls in order, each operand before what is made of it."""
        calls: list[Call] = []
        numbers: dict[int, int] = {}
        waiting = list(reversed(self._statements))
        while waiting:
            value = waiting[-1]
            if id(value) in numbers:
                waiting.pop()
                continue
            missing = [operand for operand in value._operands if id(operand) not in numbers]
            for operand in missing:
                # Those of this mechanism have been stated before.
                if operand._name in _DECLARATIONS:
                    raise ValueError(f"{' '.join((operand._name, *operand._words))} belongs to another mechanism")
            if missing:
                waiting.extend(reversed(missing))
                continue
            numbers[id(value)] = len(calls)
            operands = [numbers[id(operand)] for operand in value._operands]
            calls.append((value._name, operands, list(value._numbers), list(value._words), value._place()))
            waiting.pop()
        return calls

    def __repr__(self) -> str:
        return f"<Mechanism {self.name} of {len(self._statements) - 1} statements>"


_DECLARATIONS = {
    "param", "positive", "params", "coord", "coords", "input", "inputs", "signal", "prescribed", "reaction"
}  # fmt: skip


def _length(name: str, count: Any) -> int:
    most = 10_000
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or not 1 <= count <= most:
        raise ValueError(f"{name}: an array has from 1 to {most} elements, found {count!r}")
    return int(count)


# ---- values


def vector(x: ScalarLike, y: ScalarLike, z: ScalarLike) -> Vector:
    """`[x, y, z]`, in world axes."""
    return _vector((x, y, z))


def quantity(number: float, unit: str) -> Scalar:
    """A number with its unit: `quantity(0.3, "kg")`."""
    return Scalar("quantity", [], [number], [unit])


def time() -> Scalar:
    """`t`, in seconds."""
    return Scalar("time")


def world() -> Pose:
    """The frame of the world."""
    return Pose("world")


def translation(by: VectorLike) -> Pose:
    """A frame displaced by a vector."""
    return Pose("translation", [_vector(by)])


def rotation(axis: VectorLike, angle: ScalarLike) -> Pose:
    """A frame turned about an axis of plain numbers."""
    return Pose("rotation", [_vector(axis), _scalar(angle)])


def rpy(roll: ScalarLike, pitch: ScalarLike, yaw: ScalarLike) -> Pose:
    """A frame turned about fixed axes x, y, z, one after the other."""
    return Pose("rpy", [_scalar(roll), _scalar(pitch), _scalar(yaw)])


def angular_velocity(pose: Pose) -> Vector:
    """The angular velocity of a frame."""
    return Vector("angular_velocity", [_pose(pose)])


def particle(mass: ScalarLike, position: VectorLike) -> Scalar:
    """The kinetic energy of a particle."""
    return Scalar("particle", [_scalar(mass), _vector(position)])


def inertia(
    xx: ScalarLike, yy: ScalarLike, zz: ScalarLike, xy: ScalarLike = 0, xz: ScalarLike = 0, yz: ScalarLike = 0
) -> list[ScalarLike]:
    """The entries of an inertia, as `rigid_body` takes them."""
    zero = quantity(0.0, "kg*m^2")
    return [zero if isinstance(entry, int) and entry == 0 else entry for entry in (xx, yy, zz, xy, xz, yz)]


def rigid_body(mass: ScalarLike, com: VectorLike, inertia: Sequence[ScalarLike], pose: Pose) -> Scalar:
    """The kinetic energy of a body. Mass centre and inertia, about the mass centre, are in the axes of the pose; the
    inertia's entries are xx, yy, zz, xy, xz, yz."""
    entries = [_scalar(entry) for entry in inertia]
    if len(entries) != 6:
        raise ValueError(f"rigid_body: an inertia has 6 entries, found {len(entries)}")
    return Scalar("rigid_body", [_scalar(mass), _vector(com), *entries, _pose(pose)])


def dt(value: _V) -> _V:
    """The total time derivative of a number or a vector."""
    if not isinstance(value, (Scalar, Vector)):
        raise ValueError(f"dt: a number or a vector of the mechanism is expected, found {value!r}")
    return value.dt()  # type: ignore[return-value]


def below(x: ScalarLike, bound: ScalarLike, yes: ScalarLike, no: ScalarLike) -> Scalar:
    """`if x < bound { yes } else { no }`"""
    return Scalar("below", [_scalar(x), _scalar(bound), _scalar(yes), _scalar(no)])


def sin(x: ScalarLike) -> Scalar:
    """The sine."""
    return Scalar("sin", [_scalar(x)])


def cos(x: ScalarLike) -> Scalar:
    """The cosine."""
    return Scalar("cos", [_scalar(x)])


def tan(x: ScalarLike) -> Scalar:
    """The tangent."""
    return Scalar("tan", [_scalar(x)])


def asin(x: ScalarLike) -> Scalar:
    """The inverse of the sine."""
    return Scalar("asin", [_scalar(x)])


def acos(x: ScalarLike) -> Scalar:
    """The inverse of the cosine."""
    return Scalar("acos", [_scalar(x)])


def atan(x: ScalarLike) -> Scalar:
    """The inverse of the tangent."""
    return Scalar("atan", [_scalar(x)])


def sinh(x: ScalarLike) -> Scalar:
    """The hyperbolic sine."""
    return Scalar("sinh", [_scalar(x)])


def cosh(x: ScalarLike) -> Scalar:
    """The hyperbolic cosine."""
    return Scalar("cosh", [_scalar(x)])


def tanh(x: ScalarLike) -> Scalar:
    """The hyperbolic tangent."""
    return Scalar("tanh", [_scalar(x)])


def exp(x: ScalarLike) -> Scalar:
    """The exponential function."""
    return Scalar("exp", [_scalar(x)])


def ln(x: ScalarLike) -> Scalar:
    """The natural logarithm."""
    return Scalar("ln", [_scalar(x)])


def abs(x: ScalarLike) -> Scalar:  # noqa: A001 - as in the language
    """The absolute value."""
    return Scalar("abs", [_scalar(x)])


def signum(x: ScalarLike) -> Scalar:
    """-1, 0 or 1."""
    return Scalar("signum", [_scalar(x)])


def sqrt(x: ScalarLike) -> Scalar:
    """The square root."""
    return Scalar("sqrt", [_scalar(x)])


def atan2(y: ScalarLike, x: ScalarLike) -> Scalar:
    """The angle of the point (x, y)."""
    return Scalar("atan2", [_scalar(y), _scalar(x)])


def hypot(x: ScalarLike, y: ScalarLike) -> Scalar:
    """The distance of the point (x, y)."""
    return Scalar("hypot", [_scalar(x), _scalar(y)])


def min(x: ScalarLike, y: ScalarLike) -> Scalar:  # noqa: A001 - as in the language
    """The lesser one."""
    return Scalar("min", [_scalar(x), _scalar(y)])


def max(x: ScalarLike, y: ScalarLike) -> Scalar:  # noqa: A001 - as in the language
    """The greater one."""
    return Scalar("max", [_scalar(x), _scalar(y)])
