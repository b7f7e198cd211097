"""Ensembles under Dask: the table is the same bytes, whoever was lost on the way."""

import importlib.util
import os
import shutil
import signal
import subprocess
import threading
import time

import pytest
from conftest import ROOT

PROGRAM = os.environ.get("MBS", "mbs")

PLAN = """
mechanism = "pendulum.mbs"
members = 400
seed = 4
[vary]
theta = { normal = [1, 0.2] }
l = { uniform = [0.5, 2] }
[motion]
duration = "5 s"
[quantities]
highest = { max = "1 - cos(theta)" }
swings = { count = "theta" }
"""


@pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="distributed is not installed")
@pytest.mark.skipif(shutil.which(PROGRAM) is None, reason="mbs is not on the path")
def test_a_lost_workers_members_are_done_again(tmp_path):
    from distributed import Client, LocalCluster

    source = ROOT / "mbs-python" / "examples" / "ensemble_dask.py"
    spec = importlib.util.spec_from_file_location("ensemble_dask", source)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    shutil.copy(ROOT / "models" / "mechanisms" / "pendulum.mbs", tmp_path)
    plan, one, two = tmp_path / "plan.toml", tmp_path / "one.csv", tmp_path / "two.csv"
    plan.write_text(PLAN)
    subprocess.run([PROGRAM, "sweep", plan, "--out", one], check=True, capture_output=True)

    def kill(pid, parts):
        while not any(parts.glob("rows-*")):
            time.sleep(0.01)
        os.kill(pid, signal.SIGKILL)

    # Workers import the example by its source.
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with cluster, Client(cluster) as client:
        client.upload_file(str(source))
        victim = next(iter(client.run(os.getpid).values()))
        killer = threading.Thread(target=kill, args=(victim, tmp_path / "two.csv.parts"))
        killer.start()
        example.ensemble(client, plan, two)
        killer.join()
    assert one.read_bytes() == two.read_bytes()
