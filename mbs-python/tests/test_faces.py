"""Help, signatures, representations in notebooks, types."""

import importlib.util
import inspect
import pathlib
import pydoc
import subprocess
import sys

import mbs
import pytest
from conftest import model


def test_help_has_units_and_documentation():
    own = model("pendulum")
    text = pydoc.plain(pydoc.render_doc(own))
    for words in [
        "A point mass on a massless rod",
        "`theta` [rad] Angle from straight down.",
        "forward_dynamics(self, q, qd, u)",
    ]:
        assert words in text
    text = pydoc.plain(pydoc.render_doc(own.mass_matrix))
    assert "mass_matrix(q)" in text and "M" in text and "(..., 1, 1)" in text
    assert list(inspect.signature(own.forward_dynamics).parameters) == ["q", "qd", "u"]
    assert own.units["theta"] == "rad" and own.units["tau"] == "N*m"
    assert "forward_dynamics" in dir(own)


def test_notebooks_show_equations_and_tables():
    own = model("pendulum")
    latex, page = own._repr_latex_(), own._repr_html_()
    assert r"m l^2 \ddot{\theta}" in latex and latex.count("$$") % 2 == 0 and "align*" not in latex
    assert latex.count(r"\begin{aligned}") == latex.count(r"\end{aligned}") >= 2
    assert "<td>Mass of the bob.</td>" in page and "<code>forward_dynamics(q, qd, u)</code>" in page
    assert own.latex().startswith(r"\documentclass")
    for name in ["arm6", "four_bar", "shaken_pendulum"]:
        assert model(name)._repr_latex_().startswith("$$") and model(name)._repr_html_().count("<table>") == 2
    assert repr(own) == "<Model Pendulum: 1 coordinates, 1 inputs, 18 functions>"


def test_declared_markup_is_escaped():
    own = mbs.compile(
        "/// <script>alert(1)</script>\nmechanism A { coord x: m; kinetic += 1 kg*dt(x)^2; }", backend="interpreter"
    )
    assert "<script>" not in own._repr_html_()


def test_there_are_types(tmp_path):
    package = importlib.util.find_spec("mbs").submodule_search_locations[0]
    assert all((pathlib.Path(package) / name).exists() for name in ["py.typed", "_mbs.pyi"])
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    line = [sys.executable, "-m", "mypy", "--strict", "--no-warn-return-any", "--no-incremental", "-p", "mbs"]
    run = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 0, run.stdout


def test_all_that_is_named_is_there():
    assert all(hasattr(mbs, name) for name in mbs.__all__)
