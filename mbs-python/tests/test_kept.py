"""What is derived is kept for the next call of the process; parameters are not shared."""

import time

import mbs
from conftest import path


def test_derivations_are_kept_in_a_process():
    text = path("arm6").read_text()
    text = text.replace("mechanism Arm6 {", "mechanism KeptArm {")
    spent = []
    for _ in range(3):
        start = time.perf_counter()
        mbs.compile(text, backend="interpreter")
        spent.append(time.perf_counter() - start)
    assert min(spent[1:]) < 0.2 * spent[0], spent


def test_models_that_share_a_derivation_share_no_parameters():
    text = "mechanism Shared { param m: kg = 2; coord x: m; input f: N; kinetic += 1/2*m*dt(x)^2; force x += f; }"
    first, second = (mbs.compile(text, backend="interpreter") for _ in range(2))
    first.params.m = 4.0
    assert second.params.m == 2.0
    assert [own.forward_dynamics([0.0], [0.0], [8.0])[0] for own in (first, second)] == [2.0, 4.0]
    assert mbs.compile(text.replace("2;", "1;", 1), backend="interpreter").params.m == 1.0
    frozen = mbs.compile(text, freeze=["m"], backend="interpreter")
    assert list(frozen.params) == [] and frozen.forward_dynamics([0.0], [0.0], [8.0])[0] == 4.0


def test_mechanisms_of_calls_are_kept_by_what_was_called():
    def made(stiffness):
        m = mbs.Mechanism("Called")
        x = m.coord("x", "m")
        m.kinetic(mbs.quantity(1.0, "kg") * x.dt() ** 2 / 2)
        m.potential(mbs.quantity(stiffness, "N/m") * x**2 / 2)
        return mbs.compile(m, backend="interpreter")

    assert [made(k).gravity([1.0])[0] for k in (2.0, 2.0, 3.0)] == [2.0, 2.0, 3.0]
