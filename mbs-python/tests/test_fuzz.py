"""A few seconds of what `fuzz.py` does for as long as it is told."""

import pathlib
import subprocess
import sys


def test_nothing_crashes():
    script = pathlib.Path(__file__).with_name("fuzz.py")
    run = subprocess.run([sys.executable, script, "--minutes", "0.1", "--seed", "18"], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:]
    assert "none of them a crash" in run.stdout and int(run.stdout.split()[0]) > 20
