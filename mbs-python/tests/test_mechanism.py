"""Mechanisms written in Python are those of the text; mistakes name the line of Python."""

import mbs
import numpy as np
import pytest
from conftest import same_bits


def pendulum(mistake=False):
    m = mbs.Mechanism("Pendulum", "A bob on a rod.")
    mass = m.param("m", "kg", 1.0, doc="Mass of the bob.")
    length = m.param("l", "m", 0.5, positive=True)
    g, b = m.param("g", "m/s^2", 9.81), m.param("b", "N*m*s/rad", 0.1)
    theta, tau = m.coord("theta", "rad", doc="Angle from straight down."), m.input("tau", "N*m")
    bob = mbs.vector(length * mbs.sin(theta), 0, -length * mbs.cos(theta))
    m.kinetic(mbs.particle(mass, bob))
    m.potential(mass * g * bob.z)
    if mistake:
        m.potential(mass * length)
    m.dissipation(b * theta.dt() ** 2 / 2)
    m.force(theta, tau)
    m.output("tip", bob)
    return m


TEXT = """/// A bob on a rod.
mechanism Pendulum { param m: kg = 1.0; param l: m = 0.5, positive; param g: m/s^2 = 9.81; param b: N*m*s/rad = 0.1;
    coord theta: rad; input tau: N*m; let bob = [l*sin(theta), 0, -l*cos(theta)];
    kinetic += particle(m, bob); potential += m*g*bob.z; dissipation += b*dt(theta)^2/2; force theta += tau;
    output tip = bob; }"""


def test_arrays_of_numpy_are_numbers_and_vectors():
    def written(two, down, zeros):
        m = mbs.Mechanism("Ball")
        place = mbs.vector(m.coord("x", "m"), m.coord("y", "m"), m.coord("z", "m"))
        m.kinetic(mbs.particle(two * mbs.quantity(1, "kg"), place))
        m.gravity([0, 0, mbs.quantity(-9.81, "m/s^2")])
        m.output("down", down)
        m.constraint("c", place, zeros)
        return mbs.compile(m)

    one = written(2.0, [0, 0, -1], [0, 0, 0])
    other = written(np.array(2.0), np.array([0, 0, -1]), np.zeros(3))
    assert same_bits(one.mass_matrix([0, 0, 0]), other.mass_matrix([0, 0, 0])) and one.constraints == other.constraints


def test_the_name_is_reported_where_the_mechanism_is_begun():
    with pytest.raises(mbs.ModelError, match=r"test_mechanism.py:\d+"):
        mbs.compile(mbs.Mechanism("a b"))


def test_calls_and_text_are_one_mechanism():
    one, other = mbs.compile(pendulum()), mbs.compile(TEXT)
    q, qd, qdd, u = np.random.default_rng(1).uniform(-2, 2, (4, 20, 1))
    given = {"q": q, "qd": qd, "qdd": qdd, "u": u}
    assert list(one.functions) == list(other.functions)
    for name, call in one.functions.items():
        names = [a for a, _ in next(f for f in one._info["functions"] if f["name"] == name)["arguments"]]
        a, b = (f(*(given[n] for n in names)) for f in (call, other.functions[name]))
        a, b = (x if isinstance(x, tuple) else (x,) for x in (a, b))
        assert all(map(same_bits, a, b)), name
    assert "Angle from straight down." in one.__doc__ and "Mass of the bob." in one.__doc__


def test_operators_of_python_are_those_of_the_text():
    m = mbs.Mechanism("Ball")
    x = m.coord("x", "m")
    place = +mbs.vector(x, 0, 0)
    m.kinetic(mbs.particle(mbs.quantity(2, "kg"), place))
    m.output("found", abs(x) + mbs.quantity(1, "m") * 2 ** (x / mbs.quantity(1, "m")))
    own = mbs.compile(m)
    assert own.found([-2.0]) == 2.25 and own.mass_matrix([0.0]) == 2.0


def test_a_mechanism_can_be_compiled_twice_and_go_on():
    m = pendulum()
    first, again = mbs.compile(m), mbs.compile(m)
    assert same_bits(first.mass_matrix([0.3]), again.mass_matrix([0.3]))
    m.output("twice", 2 * m.coord("x", "m"))
    m.kinetic(mbs.quantity(1.0, "kg") * mbs.quantity(0.0, "m/s") ** 2)
    with pytest.raises(mbs.ModelError):
        mbs.compile(m)  # x has no inertia


def test_a_mistake_names_the_line_of_python():
    with pytest.raises(mbs.ModelError) as error:
        mbs.compile(pendulum(mistake=True))
    line = next(i for i, text in enumerate(open(__file__), 1) if "mass * length)" in text and "potential" in text)
    assert f"{__file__}:{line}:" in str(error.value) and "must be an energy" in str(error.value)
    assert isinstance(error.value, ValueError)


def test_bodies_frames_and_arrays():
    m = mbs.Mechanism("Arm", "Two links in space.")
    q, lengths = m.coords("q", 2, "rad"), m.params("l", "m", [0.5, 0.4])
    m.gravity([0, 0, mbs.quantity(-9.81, "m/s^2")])
    frame, zero = mbs.world(), mbs.quantity(0.0, "m")
    for i, axis in enumerate([(0, 0, 1), (0, 1, 0)]):
        frame = frame * mbs.rotation(axis, q[i])
        body = mbs.inertia(*(mbs.quantity(x, "kg*m^2") for x in (0.1, 0.2, 0.25)))
        m.kinetic(mbs.rigid_body(mbs.quantity(2.0, "kg"), [lengths[i] / 2, zero, zero], body, frame))
        frame = frame * mbs.translation([lengths[i], zero, zero])
    m.output("hand", frame)
    m.output("turn", mbs.angular_velocity(frame))
    arm = mbs.compile(m)
    same = mbs.compile("""mechanism Arm { coord q[2]: rad; param l[2]: m = [0.5, 0.4]; gravity [0, 0, -9.81 m/s^2];
        let a = rotation([0, 0, 1], q[0]); let b = a * translation([l[0], 0, 0]) * rotation([0, 1, 0], q[1]);
        let i = inertia(0.1 kg*m^2, 0.2 kg*m^2, 0.25 kg*m^2, 0, 0, 0);
        kinetic += rigid_body(2 kg, [l[0]/2, 0, 0], i, a); kinetic += rigid_body(2 kg, [l[1]/2, 0, 0], i, b);
        output hand = b * translation([l[1], 0, 0]); output turn = angular_velocity(b); }""")
    q, qd = np.random.default_rng(2).uniform(-1, 1, (2, 10, 2))
    np.testing.assert_allclose(arm.forward_dynamics(q, qd), same.forward_dynamics(q, qd), rtol=1e-12)
    np.testing.assert_allclose(arm.hand(q).position, same.hand(q).position, atol=1e-15)
    np.testing.assert_allclose(arm.turn(q, qd), same.turn(q, qd), atol=1e-14)


def test_constraints_choices_and_prescribed_motions():
    m = mbs.Mechanism("Hoop")
    x, z = m.coord("x", "m"), m.coord("z", "m")
    r, kg = m.param("r", "m", 1.0), mbs.quantity(1.0, "kg")
    shift = m.prescribed("shift", "m", mbs.quantity(0.1, "m") * mbs.sin(mbs.quantity(2.0, "rad/s") * mbs.time()))
    m.kinetic(mbs.particle(kg, [x, mbs.quantity(0.0, "m"), z]))
    m.constraint("hoop", x**2 + (z - shift) ** 2, r**2)
    m.potential(kg * mbs.quantity(9.81, "m/s^2") * z)
    m.force(x, mbs.below(x, 0.0 * r, mbs.quantity(1.0, "N"), mbs.quantity(-1.0, "N")))
    hoop = mbs.compile(m)
    assert hoop.constraints == ["hoop"] and hoop.forward_dynamics(0.0, [0.0, -1.0], [0.0, 0.0]).shape == (2,)


def test_what_python_refuses():
    m, other = pendulum(), mbs.Mechanism("Other")
    x = other.coord("x", "m")
    m.potential(x)
    with pytest.raises(ValueError, match="coord x m belongs to another mechanism"):
        mbs.compile(m)
    for wrong in [
        lambda: x + mbs.world(),
        lambda: mbs.world() + mbs.world(),
        lambda: x + "1",
        lambda: x < 1,
        lambda: bool(x),
        lambda: x == 0,
        lambda: x != 0,
        lambda: x in [1, 2],
        lambda: mbs.world() == mbs.world(),
        lambda: mbs.vector(1, 2, 3) * mbs.vector(1, 2, 3),
    ]:
        with pytest.raises(TypeError):
            wrong()
    # Objects are told apart by what they are.
    assert {x: "x"}[x] == "x" and x in [x] and x in {x, other.coord("y", "m")}
    for wrong in [
        lambda: mbs.sin("x"),
        lambda: mbs.vector(1, 2, None),
        lambda: other.coord(3, "m"),
        lambda: other.coords("y", 0, "m"),
        lambda: other.coords("y", 10**9, "m"),
        lambda: other.param("p", "kg", "1"),
        lambda: mbs.rigid_body(1, [0, 0, 0], [1, 2], mbs.world()),
        lambda: mbs.compile(3),
        lambda: mbs.compile("mechanism A { }", backend="fortran"),
        lambda: mbs.compile("mechanism A { coord x: m; \ud800 }"),
        lambda: mbs.compile("no/such/file.mbs"),
        lambda: mbs.compile("a\0b.mbs"),
        lambda: mbs.compile(TEXT, freeze="m"),
        lambda: mbs.compile(TEXT, freeze=["nothing"]),
        lambda: mbs.compile(TEXT, params={"nothing": 1.0}),
    ]:
        with pytest.raises(ValueError):
            wrong()
    for name in ["", "a b", "1x", "let", "x; coord y: m", "\n", "θ"]:
        bad = mbs.Mechanism("Bad")
        bad.coord(name, "m")
        with pytest.raises(mbs.ModelError):
            mbs.compile(bad)


def test_deep_sums_are_no_recursion():
    m = mbs.Mechanism("Deep")
    x = m.coord("x", "m")
    kg, total = mbs.quantity(1.0, "kg"), x * 0.0
    for _ in range(3000):
        total = total + x / 3000
    m.kinetic(kg * total.dt() ** 2 / 2)
    assert mbs.compile(m, backend="interpreter").mass_matrix([0.0]) == pytest.approx(1.0)
