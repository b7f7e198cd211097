"""The examples and the page of documentation do what they say."""

import contextlib
import importlib.util
import io
import os
import pathlib
import re
import subprocess
import sys

import pytest
from conftest import ROOT

EXAMPLES = sorted((ROOT / "mbs-python" / "examples").glob("*.py"))


@pytest.mark.parametrize("script", EXAMPLES, ids=[script.stem for script in EXAMPLES])
def test_examples_run(script):
    for package in re.findall(r"^# needs: (\w+)", script.read_text(), re.M):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.strip()


@pytest.mark.parametrize("page", ["docs/python.md", "mbs-python/README.md"])
def test_pages_are_true(page, tmp_path):
    """Blocks of Python run one after the other; what a `text` block behind one shows is what is printed."""
    text = (ROOT / page).read_text()
    blocks = re.findall(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```)?", text, re.S)
    assert blocks
    space, before = {}, pathlib.Path.cwd()
    os.chdir(ROOT)
    try:
        for code, shown in blocks:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(code, page, "exec"), space)
            if shown:
                assert printed.getvalue().strip() == shown.strip(), code
    finally:
        os.chdir(before)
