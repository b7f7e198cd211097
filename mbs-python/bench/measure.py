"""Throughput at 10 000 states beside Rust's, and what a single call costs.

    cargo build --release --manifest-path mbs-python/bench/Cargo.toml
    python mbs-python/bench/measure.py

The better of several turns, Python and Rust by turns, because machines are not quiet.
"""

import os
import pathlib
import subprocess
import timeit

import mbs
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
FUNCTIONS = ["forward_dynamics", "inverse_dynamics", "mass_matrix"]


def rust(threads):
    program = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", HERE / "target")) / "release" / "bench"
    printed = subprocess.run([program, str(threads)], check=True, capture_output=True, text=True).stdout
    return {name: float(time) for name, time in map(str.split, printed.splitlines())}


def python(threads):
    arm, states = mbs.compile(HERE.parents[1] / "models" / "mechanisms" / "arm6.mbs"), 10_000
    q, qd, u = np.random.default_rng(1).uniform(-1, 1, (3, states, 6))
    mbs.set_threads(threads)
    given = {"forward_dynamics": (q, qd, u), "inverse_dynamics": (q, qd, u), "mass_matrix": (q,)}
    return {
        n: min(timeit.repeat(lambda n=n: getattr(arm, n)(*given[n]), number=1, repeat=60)) / states * 1e9
        for n in FUNCTIONS
    }


def main():
    for threads in [1, os.cpu_count() or 1]:
        turns = [(rust(threads), python(threads)) for _ in range(5)]
        for name in FUNCTIONS:
            a, b = (min(turn[i][name] for turn in turns) for i in (0, 1))
            print(
                f"{name}, {threads} threads: Rust {a:.1f} ns, Python {b:.1f} ns a state, throughput {a / b:.0%} of Rust's"
            )
    pendulum = mbs.compile(HERE.parents[1] / "models" / "mechanisms" / "pendulum.mbs")
    q, qd, u = np.array([0.3]), np.array([0.1]), np.array([0.0])
    for name, args in [("forward_dynamics", (q, qd, u)), ("potential_energy", (q,))]:
        f, n = getattr(pendulum, name), 20_000
        best = min(timeit.repeat("f(*args)", number=n, repeat=15, globals={"f": f, "args": args})) / n
        print(f"pendulum, {name} of one state: {best * 1e6:.2f} µs")


if __name__ == "__main__":
    main()
