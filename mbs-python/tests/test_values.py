"""Every function against the interpreter, the command line, and itself one state at a time."""

import json
import os
import pathlib
import shutil
import subprocess

import mbs
import numpy as np
import pytest
from conftest import ROOT, arguments, model, parts, path, same_bits, states


def needs_compiler():
    if not any(map(shutil.which, ["cc", "gcc", "clang"])):
        pytest.skip("there is no C compiler")


def test_compiled_functions_give_the_bits_of_the_interpreter(name):
    needs_compiler()
    compiled, interpreted = model(name, "c"), model(name, "interpreter")
    assert compiled.backend == "c" and interpreted.backend == "interpreter"
    given = states(compiled, 100, seed=1)
    for function in compiled.functions:
        found = parts(compiled.functions[function](*arguments(compiled, function, given)))
        expected = parts(interpreted.functions[function](*arguments(compiled, function, given)))
        assert all(map(same_bits, found, expected)), function
    # Nothing but what solves for forces of constraints may be left to the interpreter.
    solving = {"forward_dynamics", "linearize", "linearize_parameters", "multipliers"}
    assert set(compiled.interpreted) <= (solving if compiled.constraints else set())


def test_a_batch_is_a_loop(name):
    own = model(name)
    given = states(own, 12, seed=2)
    for function, call in own.functions.items():
        args = arguments(own, function, given)
        whole = parts(call(*args))
        for i in range(12):
            one = parts(call(*(arg[i] for arg in args)))
            assert all(same_bits(part[i], single) for part, single in zip(whole, one, strict=True)), function
        # Any leading axes.
        cube = parts(call(*(arg.reshape(2, 3, 2, *arg.shape[1:]) for arg in args)))
        assert all(same_bits(a, b.reshape(a.shape)) for a, b in zip(cube, whole, strict=True)), function


def test_threads_do_not_show(name):
    own = model(name)
    given = states(own, 3000 if own.backend == "c" else 200, seed=3)
    try:
        for function in ["forward_dynamics", "mass_matrix", "inverse_dynamics"]:
            found = []
            for threads in [1, 5]:
                mbs.set_threads(threads)
                found.append(parts(own.functions[function](*arguments(own, function, given))))
            assert all(map(same_bits, *found)), function
    finally:
        mbs.set_threads(0)


def shapely(value):
    """A value that `mbs eval` prints, as flat numbers."""
    if isinstance(value, dict):
        return [x for item in value.values() for x in shapely(item)]
    if isinstance(value, list):
        return [x for item in value for x in shapely(item)]
    return [np.nan if value is None else value]


@pytest.mark.parametrize("name", ["arm6", "shaken_pendulum", "branches", "four_bar", "quadrotor_quaternion"])
def test_values_are_those_of_the_command_line(name, tmp_path):
    program = os.environ.get("MBS_CLI") or next(
        (str(p) for p in [ROOT / "target" / kind / "mbs" for kind in ["release", "debug"]] if p.exists()), None
    )
    if program is None or not pathlib.Path(program).exists():
        pytest.skip("there is no `mbs`: cargo build -p mbs-cli, or MBS_CLI=path")
    own = model(name)
    given = states(own, 3, seed=4)
    wanted = [name for name in own.functions if "multipliers" not in takes(own, name)]
    for i in range(3):
        state = {key: values[i].tolist() for key, values in given.items() if key not in ("prescribed", "multipliers")}
        if "prescribed" in given:
            state["prescribed"] = dict(zip(own.prescribed, given["prescribed"][i].tolist(), strict=True))
        file = tmp_path / "state.json"
        file.write_text(json.dumps(state))
        line = [program, "eval", str(path(name)), "--state", str(file), "--only", ",".join(wanted)]
        printed = json.loads(subprocess.run(line, check=True, capture_output=True, text=True).stdout)
        for function in wanted:
            value = printed[function]
            if function == "conserved":
                continue  # printed by name
            if function == "linearize":
                value = {
                    part: value[part]
                    for part in own.linearize(*(a[i] for a in arguments(own, function, given)))._fields
                }
            found = parts(own.functions[function](*(arg[i] for arg in arguments(own, function, given))))
            flat = np.concatenate([part.ravel() for part in found])
            expected = np.array(shapely(value), float)
            # What is not finite is printed as null.
            assert np.array_equal(np.where(np.isfinite(flat), flat, np.nan), expected, equal_nan=True), function


def takes(model, name):
    return [argument for argument, _ in next(f for f in model._info["functions"] if f["name"] == name)["arguments"]]


def test_multipliers_are_not_guessed_where_the_motion_depends_on_more():
    own = model("four_bar_with_reactions")
    q, qd, tau = np.array([1.0, -0.8, 1.2]), np.zeros(3), np.array([5.0])
    q = own.simulate(q, qd, t=1e-9, u=tau).q[0]
    qdd = own.forward_dynamics(q, qd, tau)
    with pytest.raises(ValueError, match=r"depend on `u`, which knee does not take; give it multipliers\(q, qd, u\)"):
        own.knee(q, qd, qdd)
    knee = own.knee(q, qd, qdd, own.multipliers(q, qd, tau))
    pivot = own.pivot(q, qd, qdd, own.multipliers(q, qd, tau))
    # Euler's law of the crank about its hinge: all that turns it is tau, its weight and what the knee takes.
    crank, mass, length, g = q[0], own.params.m[0], own.params.l[0], own.params.g
    place = length * np.array([np.cos(crank), 0, np.sin(crank)])
    # The reaction is in the axes of the coupler, which is turned by both angles.
    a = q[0] + q[1]
    turn = np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])
    moment = np.cross(place, turn @ knee.force)[1]
    weight = mass * g * length / 2 * np.cos(crank)
    # About -y, from x to z.
    assert mass * length**2 / 3 * qdd[0] == pytest.approx(tau[0] - weight + moment, abs=1e-9)
    assert np.all(np.isfinite(pivot.force))


def test_multipliers_are_those_of_the_motion_where_none_are_given():
    # Nothing drives this one: tau is a constant of its text.
    text = path("four_bar_with_reactions").read_text()
    own = mbs.compile(text.replace("input tau: N*m;", "param tau: N*m = 5;"))
    given = states(own, 5, seed=5)
    function = next(name for name in own.functions if "multipliers" in takes(own, name))
    args = {name: given[name] for name in takes(own, function) if name != "multipliers"}
    of_motion = own.multipliers(*(given[name] for name in takes(own, "multipliers")))
    found = parts(own.functions[function](**args))
    assert all(map(same_bits, found, parts(own.functions[function](**args, multipliers=of_motion))))
    assert not all(map(same_bits, found, parts(own.functions[function](**args, multipliers=2 * of_motion))))


def test_the_pendulum_by_hand():
    m, length, g, b = 2.0, 0.7, 9.81, 0.1
    own = model("pendulum").with_params(m=m, l=length, g=g, b=b)
    q, qd, u = np.random.default_rng(6).uniform(-2, 2, (3, 50, 1))
    expected = (u - b * qd - m * g * length * np.sin(q)) / (m * length**2)
    np.testing.assert_allclose(own.forward_dynamics(q, qd, u), expected, rtol=1e-13, atol=1e-13)
    slopes = own.linearize(q, qd, u)
    np.testing.assert_allclose(slopes.q[..., 0], -g / length * np.cos(q), rtol=1e-12)
    np.testing.assert_allclose(slopes.u, np.full((50, 1, 1), 1 / (m * length**2)), rtol=1e-13)
    a, control = own.state_space(q[0], qd[0], u[0])
    np.testing.assert_allclose(a, [[0, 1], [-g / length * np.cos(q[0, 0]), -b / (m * length**2)]], rtol=1e-12)
    assert control.shape == (2, 1)


def test_jacobians_against_differences():
    own = model("arm6")
    q, qd, u = np.random.default_rng(7).uniform(-1, 1, (3, 6))
    slopes, h = own.linearize(q, qd, u), 1e-6
    shift = h * np.eye(6)
    for part, args in [("q", (shift, 0, 0)), ("qd", (0, shift, 0)), ("u", (0, 0, shift))]:
        up = own.forward_dynamics(q + args[0], qd + args[1], u + args[2])
        down = own.forward_dynamics(q - args[0], qd - args[1], u - args[2])
        expected = ((up - down) / (2 * h)).T
        scale = np.abs(expected).max()
        np.testing.assert_allclose(getattr(slopes, part), expected, atol=1e-6 * scale)


def test_poses_and_wrenches_have_names():
    own = model("arm6")
    pose = own.functions[next(name for name in own.functions if "pose" in kind(own, name))](np.zeros((4, 6)))
    assert isinstance(pose, mbs.PoseResult) and pose.position.shape == (4, 3) and pose.rotation.shape == (4, 3, 3)
    np.testing.assert_allclose(
        pose.rotation @ pose.rotation.swapaxes(-1, -2), np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-14
    )
    arm = model("arm_with_reactions")
    name = next(n for n in arm.functions if "wrench" in kind(arm, n))
    wrench = arm.functions[name](*(a[0] for a in arguments(arm, name, states(arm, 1, 8))))
    assert isinstance(wrench, mbs.WrenchResult) and wrench.force.shape[-1] == wrench.moment.shape[-1] == 3


def kind(model, name):
    return [kind for _, kind, _ in next(f for f in model._info["functions"] if f["name"] == name)["results"]]
