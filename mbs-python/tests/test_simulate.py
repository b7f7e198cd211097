"""Motions against solutions in closed form, conserved quantities, and what is refused."""

import mbs
import numpy as np
import pytest
from conftest import arguments, model, same_bits

SPRING = """mechanism Spring { param m: kg = 2; param k: N/m = 18; param c: N*s/m = 0; coord x: m; input f: N;
    kinetic += 1/2*m*dt(x)^2; potential += 1/2*k*x^2; dissipation += 1/2*c*dt(x)^2; force x += f; }"""
BALL = (
    "mechanism Ball { param m: kg = 1; param g: m/s^2 = 10; coord z: m; kinetic += m*dt(z)^2/2; potential += m*g*z; }"
)


@pytest.mark.parametrize(
    ("method", "step", "tolerance"),
    [
        ("dop853", None, 1e-9),
        ("dopri5", None, 1e-8),
        ("rk4", 1e-3, 1e-9),
        ("gauss_legendre4", 1e-3, 1e-9),
        ("stormer_verlet", 1e-3, 1e-4),
        ("semi_implicit_euler", 1e-3, 2e-2),
    ],
)
def test_a_spring_oscillates(method, step, tolerance):
    times = np.linspace(0, 10, 101)
    motion = mbs.compile(SPRING).simulate([1.0], [0.0], t=10.0, times=times, method=method, step=step)
    np.testing.assert_allclose(motion["x"], np.cos(3 * times), atol=tolerance)
    np.testing.assert_allclose(motion["x_dot"], -3 * np.sin(3 * times), atol=3 * tolerance)
    assert same_bits(motion.t, times) and not motion.stopped


def test_the_period_of_a_pendulum():
    # 2π √(l/g) / agm(1, cos(θ₀/2)): Gauss, by the arithmetic-geometric mean.
    own = model("pendulum")
    a, b = 1.0, np.cos(0.6)
    for _ in range(6):
        a, b = (a + b) / 2, np.sqrt(a * b)
    period = 2 * np.pi / np.sqrt(9.81) / a
    motion = own.simulate([1.2], t=3 * period, times=np.array([0.25, 0.5, 1, 3]) * period)
    np.testing.assert_allclose(motion["theta"], [0, -1.2, 1.2, 1.2], atol=1e-8)
    assert motion == motion != own.simulate([1.2], t=period) and len({motion, motion}) == 1


def test_damped_and_driven():
    own = mbs.compile(SPRING, params={"c": 0.4})
    delta, omega = 0.1, np.sqrt(9 - 0.01)
    times = np.linspace(0, 8, 33)
    motion = own.simulate({"x": 0.5}, None, t=(0.0, 8.0), times=times)
    expected = 0.5 * np.exp(-delta * times) * (np.cos(omega * times) + delta / omega * np.sin(omega * times))
    np.testing.assert_allclose(motion.q[:, 0], expected, atol=1e-9)
    # At resonance, without damping: x = F/(2 m ω) t sin ωt.
    driven = mbs.compile(SPRING).simulate([0.0], times=times, t=8.0, u=lambda t, q, qd: [2 * np.cos(3 * t)])
    np.testing.assert_allclose(driven.q[:, 0], 2 / (2 * 2 * 3) * times * np.sin(3 * times), atol=1e-9)
    # A constant force moves the rest.
    pushed = mbs.compile(SPRING).simulate([1.0], times=times, t=8.0, u=[18.0])
    np.testing.assert_allclose(pushed.q[:, 0], 1.0, atol=1e-9)


def test_backwards():
    own = mbs.compile(SPRING)
    there = own.simulate([1.0], [0.3], t=(0, 5))
    back = own.simulate(there.end[1], there.end[2], t=(5, 0))
    np.testing.assert_allclose([back.end[1][0], back.end[2][0]], [1.0, 0.3], atol=1e-9)


def test_prescribed_motions():
    # A mass on a spring whose end moves as sin t: x'' = -9 (x - sin t), x = (9 sin t - 3 sin 3t)/8 from rest.
    own = mbs.compile("""mechanism Shaken { param m: kg = 1; prescribed s: m; coord x: m;
        kinetic += m*dt(x)^2/2; potential += 9/2 * 1 N/m * (x - s)^2; }""")
    times = np.linspace(0, 6, 25)
    motion = own.simulate([0.0], t=6.0, times=times, prescribed=lambda t: [[np.sin(t), np.cos(t), -np.sin(t)]])
    np.testing.assert_allclose(motion.q[:, 0], (9 * np.sin(times) - 3 * np.sin(3 * times)) / 8, atol=1e-9)


def test_events():
    ball = mbs.compile(BALL)
    ground = mbs.Event(lambda t, q, qd: q[0], direction=-1, action=lambda t, q, qd: (q, -0.5 * qd))
    top = mbs.Event(lambda t, q, qd: qd[0], direction=-1, terminal=False)
    motion = ball.simulate([5.0], t=(0, 2.4), events=[ground, top])
    # It falls for 1 s, bounces with half of 10 m/s, is at the top after 0.5 s, on the ground after 1 s.
    assert [(e.event, round(e.t, 9)) for e in motion.events] == [(0, 1.0), (1, 1.5), (0, 2.0), (1, 2.25)]
    assert motion.events[1].q[0] == pytest.approx(1.25, abs=1e-9)
    stopped = ball.simulate([5.0], t=60.0, events=[mbs.Event(lambda t, q, qd: q[0], terminal=True)])
    assert (
        stopped.stopped
        and stopped.end[0] == pytest.approx(1.0, abs=1e-11)
        and stopped.end[2][0] == pytest.approx(-10.0)
    )
    assert stopped.t[-1] == stopped.end[0]
    word = ball.simulate([5.0], t=60.0, events=[mbs.Event(lambda t, q, qd: q[0], action=lambda *_: "stop")])
    assert word.stopped and word.end[0] == stopped.end[0]


def residuals(model, motion):
    rest = np.zeros((len(model.prescribed), 3))
    given = {"t": motion.t, "q": motion.q, "qd": motion.qd, "prescribed": rest}
    return model.functions["constraint"](*arguments(model, "constraint", given))


def test_loops_stay_closed():
    bar = model("four_bar")
    motion = bar.simulate(np.full(bar.dof, 0.4), np.zeros(bar.dof), t=(0, 1.0), method="dop853", rtol=1e-9)
    assert np.abs(residuals(bar, motion)).max() < 1e-9
    energy = bar.kinetic_energy(motion.q, motion.qd) + bar.potential_energy(motion.q)
    if not np.any(bar.dissipation_force(motion.q, motion.qd)):
        assert np.ptp(energy) < 1e-6 * (1 + np.abs(energy).max())


def test_a_quaternion_stays_a_unit():
    own = model("quadrotor_quaternion")
    index = [i for i, unit in enumerate(own._info["coordinates"]) for _ in range(unit["count"]) if unit["unit"] == "1"]
    assert index
    q = np.zeros(own.dof)
    quaternion = slice(own.dof - 4, own.dof)
    q[quaternion] = [0.8, 0.6, 0.0, 0.0]
    motion = own.simulate(q, np.zeros(own.dof), t=0.5)
    assert np.abs(residuals(own, motion)).max() < 1e-9


def test_compiled_and_interpreted_motions_are_the_same():
    one, other = (model("pendulum", backend).simulate([1.0], t=5.0) for backend in ["auto", "interpreter"])
    assert same_bits(one.q, other.q) and same_bits(one.t, other.t)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (dict(q=[1.0, 2.0]), "q: expected an array of the shape [1]"),
        (dict(q=[np.nan]), "q: entry 0 is NaN"),
        (dict(qd=[np.inf]), "qd: entry 0 is inf"),
        (dict(q={"y": 1.0}), "there is no coordinate 'y'"),
        (dict(t=np.nan), "t: it is NaN"),
        (dict(t=(0, np.inf)), "t[1]"),
        (dict(t=(0, 1, 2)), "t: the last time, or a pair"),
        (dict(t="a"), "t"),
        (dict(times=[0.0, 11.0]), "times: entry 1, 11.0, lies behind the last time, t[1] = 10.0"),
        (dict(times=[1.0, 0.5]), "times: entry 1, 0.5, lies before the one before it, 1.0"),
        (dict(times=[-1.0, 0.5]), "times: entry 0, -1.0, lies before the first time"),
        (dict(times=["a"]), "times"),
        (dict(method="euler"), 'method: "euler" is none of'),
        (dict(rtol=-1.0), "tolerances must be positive"),
        (dict(rtol="x"), "rtol"),
        (dict(method="rk4", step=np.nan), "step"),
        (dict(method="rk4", step=0.0), "step: it must be positive, found 0.0"),
        (dict(method="rk4", step=-1), "step: it must be positive, found -1"),
        (dict(max_step=0), "max_step: it must be positive, found 0"),
        (dict(max_steps=0), "max_steps"),
        (dict(u=[1.0, 2.0]), "u: expected an array of the shape [1]"),
        (dict(u=lambda t, q, qd: [np.nan]), "u: entry 0 is NaN"),
        (dict(u=lambda t, q, qd: "x"), "u: real numbers"),
        (dict(prescribed=[1.0]), "prescribed"),
        (dict(events=[1]), "events: mbs.Event"),
        (dict(events=[mbs.Event(lambda *_: 1.0, direction=2)]), "direction"),
        (dict(events=[mbs.Event(lambda t, q, qd: q[0], action=lambda *_: "go")]), "action"),
        (dict(events=[mbs.Event(lambda t, q, qd: q[0], action=lambda t, q, qd: (q, [1, 2]))]), "action qd"),
    ],
)
def test_what_is_refused(given, words):
    with pytest.raises(ValueError) as error:
        mbs.compile(SPRING).simulate(**{"q": [1.0], "t": 10.0, **given})
    assert words in str(error.value), error.value


def test_the_last_time_may_be_off_by_rounding():
    motion = mbs.compile(SPRING).simulate([1.0], t=0.3, times=np.arange(4) * 0.1)
    assert motion.t.tolist() == [0.0, 0.1, 0.2, 0.3]


def test_short_pushes_are_not_stepped_over():
    # A force of 10 N while a car of 1 kg that runs at 1 m/s passes 0.1 m: v² = 1 + 2·10·0.1.
    text = "mechanism A { coord x: m; kinetic += 1 kg*dt(x)^2/2; force x += if abs(x - 5.27 m) < 0.05 m {10 N} else {0 N}; }"
    own = mbs.compile(text)
    for given in [dict(t=100.0, times=np.linspace(0, 100, 1001)), dict(t=5.6)]:
        motion = own.simulate([0.0], [1.0], **given)
        assert motion.qd[-1, 0] == pytest.approx(np.sqrt(3), abs=1e-7)


def test_states_that_actions_return_are_brought_onto_the_constraints():
    own = model("cartesian_pendulum")
    push = mbs.Event(lambda t, q, qd: t - 0.5, action=lambda t, q, qd: (q, qd + 1.0))
    start = ([0.6, -0.8], [0.0, 0.0])
    half = own.simulate(*start, t=0.5)
    expected = own.simulate(half.end[1], half.end[2] + 1.0, t=(0.5, 1.0)).end[1]
    normal = half.end[1] / np.linalg.norm(half.end[1])
    along = half.end[2] + 1.0 - normal * np.dot(normal, half.end[2] + 1.0)
    by_hand = own.simulate(half.end[1], along, t=(0.5, 1.0)).end[1]
    np.testing.assert_allclose(expected, by_hand, atol=1e-9)
    for rtol in [1e-4, 1e-10]:
        found = own.simulate(*start, t=1.0, events=[push], rtol=rtol).end[1]
        np.testing.assert_allclose(found, expected, atol=max(1e-8, 10 * rtol))


def test_errors_of_callbacks_come_back():
    class Mine(Exception):
        pass

    def broken(*_):
        raise Mine("here")

    own = mbs.compile(SPRING)

    # Ctrl+C while NumPy reads what was answered is no fault of the answer.
    class Stopping:
        def __array__(self, *_, **__):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        own.simulate([1.0], t=10.0, u=lambda *_: Stopping())
    for given in [
        dict(u=broken),
        dict(events=[mbs.Event(broken)]),
        dict(events=[mbs.Event(lambda t, q, qd: q[0], action=broken)]),
    ]:
        with pytest.raises(Mine, match="here"):
            own.simulate([1.0], t=10.0, **given)


def test_where_there_is_no_way_on():
    # It falls into the pole of 1/x.
    own = mbs.compile(
        "mechanism Falling { param m: kg = 1; coord x: m; kinetic += m*dt(x)^2/2; potential += -(1 J*m)/x; }"
    )
    with pytest.raises(mbs.SimulationError, match="the integration stopped"):
        own.simulate([1.0], t=10.0)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (dict(step=0.3), "dop853 chooses its steps itself, step does nothing"),
        (dict(method="rk4", step=0.1, rtol=1e-3), "rk4 has no error control, rtol does nothing"),
        (
            dict(method="stormer_verlet", max_step=0.1, max_steps=3),
            "stormer_verlet has no error control, max_step, max_steps do nothing",
        ),
    ],
)
def test_what_a_method_does_not_have_earns_a_warning(given, words):
    with pytest.warns(UserWarning) as warned:
        mbs.compile(SPRING).simulate([1.0], [0.0], t=1.0, **given)
    assert [str(warning.message) for warning in warned] == [words]
    assert warned[0].filename == __file__
