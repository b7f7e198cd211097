# needs: ray
"""An ensemble on Ray's workers: what `ensemble_dask.py` does with Dask; `python ensemble_ray.py PLAN.toml TABLE.csv`."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import ray

PLAN = pathlib.Path(__file__).resolve().parents[2] / "examples" / "ensembles" / "pendulum_periods.toml"
PROGRAM = os.environ.get("MBS", "mbs")
SHARES_PER_CORE = 2


def sweep(plan, table, *options):
    """What `mbs sweep` prints."""
    command = [PROGRAM, "sweep", str(plan), "--out", str(table), *options]
    while True:
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode == 0:
            return run.stdout
        # The process of a worker that was lost may outlive it, and is at the same share.
        if "is being written by another process" not in run.stderr:
            raise RuntimeError(run.stderr)
        time.sleep(0.2)


@ray.remote(max_retries=-1)
def share(plan, table, rank, ranks):
    """One share of the members; what an earlier run has done of it is not done again."""
    return sweep(plan, table, "--rank", str(rank), "--ranks", str(ranks), "--threads", "1")


def ensemble(plan, table):
    """All shares, and the table of them."""
    ranks = SHARES_PER_CORE * int(ray.cluster_resources()["CPU"])
    ray.get([share.remote(str(plan), str(table), rank, ranks) for rank in range(ranks)])
    return sweep(plan, table, "--merge")


def main():
    if shutil.which(PROGRAM) is None:
        print("skipped: mbs is not on the path")
        return
    ray.init(num_cpus=None if len(sys.argv) == 3 else 2, include_dashboard=False, log_to_driver=False)
    with tempfile.TemporaryDirectory() as folder:
        plan, table = sys.argv[1:3] if len(sys.argv) == 3 else (PLAN, pathlib.Path(folder) / "table.csv")
        print(ensemble(plan, table))
    ray.shutdown()


if __name__ == "__main__":
    main()
