# needs: distributed
"""An ensemble on Dask's workers: each does shares of the members with `mbs sweep`, a lost one's shares are done again.

A member is a function of the plan and its index alone, so the table is the same bytes on one worker or on a hundred. All
of them see the folder of the table; `mbs` is on the path, or named by MBS. On a cluster, name its scheduler:
`python ensemble_dask.py PLAN.toml TABLE.csv tcp://scheduler:8786`.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from distributed import Client, LocalCluster, as_completed

PLAN = pathlib.Path(__file__).resolve().parents[2] / "examples" / "ensembles" / "pendulum_periods.toml"
PROGRAM = os.environ.get("MBS", "mbs")
SHARES_PER_WORKER = 4


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


def share(plan, table, rank, ranks):
    """One share of the members; what an earlier run has done of it is not done again."""
    return sweep(plan, table, "--rank", str(rank), "--ranks", str(ranks), "--threads", "1")


def ensemble(client, plan, table):
    """All shares, and the table of them."""
    ranks = SHARES_PER_WORKER * max(1, len(client.scheduler_info()["workers"]))
    tasks = [client.submit(share, plan, table, rank, ranks, pure=False) for rank in range(ranks)]
    for done in as_completed(tasks):
        done.result()
    return sweep(plan, table, "--merge")


def main():
    if shutil.which(PROGRAM) is None:
        print("skipped: mbs is not on the path")
        return
    if len(sys.argv) == 4:
        with Client(sys.argv[3]) as client:
            print(ensemble(client, sys.argv[1], sys.argv[2]))
        return
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with tempfile.TemporaryDirectory() as folder, cluster, Client(cluster) as client:
        print(ensemble(client, PLAN, pathlib.Path(folder) / "table.csv"))


if __name__ == "__main__":
    main()
