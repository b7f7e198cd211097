"""Compiled code: kept, made anew where it is not what it should be, and done without where there is no compiler."""

import os
import pathlib
import shutil
import subprocess
import sys

import mbs
import numpy as np
import pytest
from conftest import same_bits

TEXT = "mechanism Kept {{ param m: kg = {m}; coord x: m; kinetic += 1/2*m*dt(x)^2; potential += 3 J*cos(1 rad/m*x); }}"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MBS_CACHE_DIR", str(tmp_path))
    return tmp_path / "mbs" / "python"


def needs_compiler():
    if not any(map(shutil.which, ["cc", "gcc", "clang"])):
        pytest.skip("there is no C compiler")


def test_code_is_compiled_once(folder):
    needs_compiler()
    mbs.compile(TEXT.format(m=1), backend="c")
    (library,), (code,) = folder.glob("*.so"), folder.glob("*.c")
    assert folder.stat().st_mode & 0o077 == 0
    before = library.stat().st_mtime_ns
    mbs.compile(TEXT.format(m=1), backend="c")
    assert library.stat().st_mtime_ns == before
    mbs.compile(TEXT.format(m=2), backend="c")
    assert len(list(folder.glob("*"))) == 4
    # A digest says nothing of who wrote the file: the text does. Another process has nothing in memory.
    code.write_text("something else")
    script = f"import mbs; mbs.compile({TEXT.format(m=1)!r}, backend='c')"
    subprocess.run([sys.executable, "-c", script], check=True)
    assert library.stat().st_mtime_ns > before and "kept" in code.read_text()


def test_what_was_derived_stays_in_the_process(folder, tmp_path):
    needs_compiler()

    def emptied():
        for file in folder.glob("*"):
            file.unlink()

    text = TEXT.format(m=4)
    own = mbs.compile(text, backend="c")
    own.params.m = 9.0
    emptied()
    again = mbs.compile(text, backend="c")
    assert not list(folder.glob("*")), "it was compiled once more"
    # The declared values, not those that a model was given; each has its own.
    assert again.params.m == 4.0 and own.params.m == 9.0
    assert again.potential_energy([0.5]) == own.potential_energy([0.5])
    # What else decides: frozen parameters, the backend, the folder, the text of a file when it is read.
    assert "m" not in mbs.compile(text, freeze=["m"], backend="c").units and "m" in again.units
    assert mbs.compile(text, backend="interpreter").backend == "interpreter"
    file = tmp_path / "kept.mbs"
    for m in (5.0, 6.0, 5.0):
        file.write_text(TEXT.format(m=m))
        assert mbs.compile(file, backend="interpreter").params.m == m
    # The last sixteen are kept.
    for m in range(100, 116):
        mbs.compile(TEXT.format(m=m), backend="interpreter")
    emptied()
    mbs.compile(text, backend="c")
    assert len(list(folder.glob("*.so"))) == 1


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("MBS_CC", "", "there is no C compiler"),
        ("MBS_CC", "no-such-compiler", "there is no C compiler"),
        ("MBS_CC", "false", "false"),
        ("MBS_CACHE_DIR", os.devnull, "null"),
    ],
)
def test_without_one_everything_is_interpreted(folder, monkeypatch, name, value, reason):
    monkeypatch.setenv(name, value)
    own = mbs.compile(TEXT.format(m=3))
    assert own.backend == "interpreter" and reason in own.not_compiled
    assert own.interpreted == list(own.functions)
    q = np.linspace(-1, 1, 7)[:, None]
    np.testing.assert_allclose(own.forward_dynamics(q, 0 * q), np.sin(q), rtol=1e-15)
    with pytest.raises(RuntimeError, match="not compiled"):
        mbs.compile(TEXT.format(m=3), backend="c")
    assert not [file for file in folder.glob("*") if file.suffix in (".c", ".so")], "something half made was left"
    monkeypatch.undo()
    if shutil.which("cc"):
        assert same_bits(
            mbs.compile(TEXT.format(m=3), backend="c").forward_dynamics(q, 0 * q), own.forward_dynamics(q, 0 * q)
        )


def test_names_of_c_are_no_trouble(folder):
    needs_compiler()
    own = mbs.compile(
        """mechanism Double { param long: kg = 2; coord int[2]: m; input signed: N; param double[2][2]: N/m = [[1, 0], [0, 2]];
        kinetic += 1/2*long*(dt(int[0])^2 + dt(int[1])^2); force int[0] += signed;
        for i in 0..2 { potential += 1/2*double[i][i]*int[i]^2; } output static = int[0]; output params_2 = int[1]; }""",
        backend="c",
    )
    assert own.forward_dynamics([1.0, 1.0], [0.0, 0.0], [3.0]).tolist() == [1.0, -1.0]
    assert own.functions["static"]([4.0, 5.0]) == 4.0 and own.interpreted == []
    own.params.double[1, 1] = 4.0
    assert own.forward_dynamics([1.0, 1.0], [0.0, 0.0], [3.0]).tolist() == [1.0, -2.0]
    assert pathlib.Path(folder).exists()
