"""Random calls with wrong shapes, kinds, names and texts: whatever comes back is a value or an error that is meant.

    python tests/fuzz.py --minutes 20 --seed 1

Each case has a number of its own, printed where it fails: `--seed N --only CASE` repeats it. What ends the process is
found by `--minutes` in a child: the parent reports the case that the child had written down last.
"""

import argparse
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time
import warnings

os.environ.setdefault("MBS_CACHE_DIR", tempfile.mkdtemp(prefix="mbs-fuzz-"))

import mbs  # noqa: E402 - after the folder is chosen
import numpy as np  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMES = ["pendulum", "arm6", "four_bar", "quadrotor_quaternion", "shaken_pendulum", "branches", "arm_with_reactions"]
#: What may be raised: ModelError is a ValueError; TypeError and AttributeError are Python's own.
MEANT = (ValueError, TypeError, AttributeError, mbs.SimulationError)


def folder(name):
    folders = [ROOT / "models" / "mechanisms", ROOT / "tests" / "mechanisms"]
    return next(p for p in (f / f"{name}.mbs" for f in folders) if p.exists())


class Cases:
    def __init__(self):
        self.models = [mbs.compile(folder(name)) for name in NAMES]
        self.models += [mbs.compile(folder(name), backend="interpreter") for name in ["pendulum", "four_bar"]]
        self.texts = [
            p.read_text() for f in ["models/mechanisms", "tests/mechanisms"] for p in sorted((ROOT / f).glob("*.mbs"))
        ]
        self.texts = [
            text for text in self.texts if len(text) < 2500 and "import" not in text and "const n" not in text
        ]
        self.texts += [
            p.read_text(errors="replace")
            for p in sorted((ROOT / "tests" / "bad").glob("**/*.mbs"))
            if p.stat().st_size < 1500
        ]

    def run(self, seed, number):
        r = random.Random(f"{seed}-{number}")
        kinds = [self.call] * 6 + [self.parameters, self.simulate, self.text, self.text, self.builder, self.face]
        r.choice(kinds)(r)

    # ---- values

    def value(self, r, shape=(1,)):
        """Mostly arrays that are nearly right."""
        batch = r.choice([(), (), (1,), (2,), (3, 1), (1, 4), (0,), (5, 2)])
        shape = tuple(shape)
        kind = r.randrange(24)
        g = np.random.default_rng(r.randrange(2**32))
        if kind < 9:
            return g.uniform(-2, 2, (*batch, *shape))
        if kind == 9:
            wrong = list((*batch, *shape)) or [1]
            wrong[r.randrange(len(wrong))] += r.choice([-1, 1, 7])
            return np.zeros([max(0, n) for n in wrong])
        if kind == 10:
            values = g.uniform(-2, 2, (*batch, *shape))
            if values.size:
                values.flat[r.randrange(values.size)] = r.choice([np.nan, np.inf, -np.inf])
            return values
        if kind == 11:
            return g.uniform(-2, 2, (*batch, *shape)).astype(
                r.choice(["f4", "f2", "i1", "u8", "?", ">f8", "g", "c16", "O", "U5", "S3"])
            )
        if kind == 12:
            return np.asfortranarray(g.uniform(-2, 2, (*batch, *shape)))
        if kind == 13:
            return g.uniform(-2, 2, (*batch, *shape)).tolist()
        if kind == 14:
            return np.broadcast_to(g.uniform(-1, 1, shape), (4, *shape))
        if kind == 15:
            return g.uniform(-2, 2, tuple(2 * n for n in (*batch, *shape)))[
                tuple(slice(None, None, r.choice([2, -2])) for _ in (*batch, *shape))
            ]
        if kind == 16:
            return np.ma.masked_array(g.uniform(-1, 1, (*batch, *shape)))
        if kind == 17:
            return np.zeros((1,) * r.randrange(1, 33) + shape) if r.random() < 0.5 else np.zeros(shape, dtype="M8[s]")
        if kind == 18:
            return g.uniform(1e300, 1.7e308, (*batch, *shape))
        if kind == 19:
            return g.uniform(0, 1e-310, (*batch, *shape))
        return r.choice(
            [
                None,
                "",
                "1",
                b"1",
                1,
                1.5,
                -0.0,
                1e400,
                10**400,
                True,
                [],
                (),
                {},
                {"q": 1},
                object(),
                [None],
                [[1], [1, 2]],
                np.float64(3),
                np.array(2.0),
                range(6),
                iter([1]),
                lambda *_: 1,
                float("nan"),
                1j,
                "\ud800",
                np.zeros((0, 0)),
                type,
            ]
        )

    # ---- kinds of cases

    def call(self, r):
        model = r.choice(self.models)
        function = r.choice(model._info["functions"])
        args = [self.value(r, shape) for _, shape in function["arguments"]]
        if r.random() < 0.05:
            args = args[: r.randrange(len(args) + 1)] + [self.value(r)] * r.randrange(3)
        call = (
            model.functions[function["name"]]
            if r.random() < 0.7
            else model._functions[model._info["functions"].index(function)]
        )
        if r.random() < 0.1:
            call(**{r.choice(["q", "qd", "u", "t", "x"]): self.value(r, (model.dof,)) for _ in range(r.randrange(4))})
        else:
            call(*args)

    def parameters(self, r):
        model = r.choice(self.models).with_params()
        names = [*model.params, "nothing", "", "mass_0", "l_0", 3, None]
        for _ in range(r.randrange(1, 4)):
            name = r.choice(names)
            before = {name: np.array(model.params[name]) for name in model.params}
            try:
                if r.random() < 0.5:
                    model.params[name] = self.value(r, ())
                else:
                    setattr(model.params, str(name), self.value(r, ()))
            except MEANT:
                assert all(np.array_equal(before[n], model.params[n]) for n in model.params), (
                    "a refused parameter was set"
                )
        assert all(np.all(np.isfinite(model.params[n])) for n in model.params)

    def simulate(self, r):
        model = r.choice(self.models)
        n = model.dof
        given = {
            "q": np.random.default_rng(r.randrange(2**32)).uniform(-1, 1, n),
            "t": r.choice([0.01, (0, 0.02), 0.0, -0.01]),
        }
        given["max_steps"] = 200
        for _ in range(r.randrange(3)):
            name = r.choice(
                [
                    "q",
                    "qd",
                    "t",
                    "times",
                    "u",
                    "prescribed",
                    "events",
                    "method",
                    "rtol",
                    "atol",
                    "step",
                    "max_step",
                    "project",
                ]
            )
            given[name] = {
                "method": r.choice(
                    ["dop853", "dopri5", "rk4", "gauss_legendre4", "stormer_verlet", "semi_implicit_euler", "", None]
                ),
                "times": r.choice([[0.0, 0.005], [], [0.0] * 3, [1.0, 0.0], self.value(r, (3,))]),
                "events": r.choice(
                    [
                        [],
                        [mbs.Event(lambda t, q, qd: q[0])],
                        [mbs.Event(lambda *_: "x")],
                        [mbs.Event(lambda t, q, qd: q[0], action=lambda *_: 3)],
                        3,
                        [mbs.Event(lambda t, q, qd: t - 0.005, terminal=True)],
                    ]
                ),
                "step": r.choice([None, 1e-3, 0.0, -1.0, np.nan, "x"]),
                "u": r.choice(
                    [self.value(r, (len(model.inputs),)), lambda t, q, qd: self.value(r, (len(model.inputs),))]
                ),
                "prescribed": r.choice(
                    [self.value(r, (len(model.prescribed), 3)), lambda t: np.zeros((len(model.prescribed), 3))]
                ),
            }.get(name, self.value(r, (n,) if name in ("q", "qd") else ()))
        if isinstance(given["t"], float) and abs(given["t"]) > 1:
            given["t"] = 0.01
        model.simulate(**given)

    def text(self, r):
        text = r.choice(self.texts)
        other = r.choice(self.texts)
        for _ in range(r.randrange(1, 4)):
            i, j = sorted(r.randrange(len(text) + 1) for _ in range(2))
            j = min(j, i + 40)
            k = r.randrange(len(other) + 1)
            text = r.choice(
                [
                    text[:i] + text[j:],
                    text[:i] + other[k : k + 30] + text[i:],
                    text[:i] + text[i:j] * 2 + text[j:],
                    text[:i]
                    + r.choice(
                        [
                            "{",
                            "}",
                            "(",
                            ")",
                            "[0]",
                            "^",
                            "-",
                            "\0",
                            "é",
                            "\ud800",
                            "1e999",
                            "dt(",
                            "if ",
                            "for i in 0..3 {",
                            ";",
                            "/*",
                            '"',
                            "0/0",
                            "sqrt(-1)",
                        ]
                    )
                    + text[j:],
                ]
            )
        if "{" not in text:
            text += "{"
        model = mbs.compile(text, backend="interpreter")
        for name, call in model.functions.items():
            function = next(f for f in model._info["functions"] if f["name"] == name)
            call(*[np.full(shape, 0.3) for _, shape in function["arguments"]])

    def builder(self, r):
        m = mbs.Mechanism(r.choice(["A", "A", "A", "1", "", "x y", "\n", "Mechanism"]))
        x, y = m.coord("x", "m"), m.coord(r.choice(["y", "x", "dt", "let", ""]), r.choice(["m", "rad", "apples", ""]))
        pool = [
            x,
            y,
            mbs.quantity(2.0, r.choice(["kg", "N/m", "?", "m"])),
            mbs.vector(x, 0, 0),
            mbs.world(),
            2,
            0.0,
            float("nan"),
            "x",
            None,
            mbs.time(),
            (1, 2, 3),
        ]
        one = [
            mbs.sin,
            mbs.dt,
            mbs.sqrt,
            mbs.ln,
            mbs.translation,
            mbs.angular_velocity,
            lambda v: -v,
            lambda v: v.x,
            lambda v: v.dt(),
            lambda v: v.norm(),
        ]
        two = [
            lambda a, b: a + b,
            lambda a, b: a * b,
            lambda a, b: a / b,
            lambda a, b: a**b,
            mbs.atan2,
            mbs.particle,
            mbs.rotation,
            lambda a, b: a.cross(b),
            lambda a, b: a.point(b),
        ]
        for _ in range(r.randrange(1, 25)):
            try:
                pool.append(
                    r.choice(one)(r.choice(pool)) if r.random() < 0.5 else r.choice(two)(r.choice(pool), r.choice(pool))
                )
                say = [
                    m.kinetic,
                    m.potential,
                    m.dissipation,
                    m.gravity,
                    lambda v: m.output("o", v),
                    lambda v: m.constraint("c", v, 0),
                    lambda v: m.force(x, v),
                    lambda v: m.reaction("r", v),
                ]
                if r.random() < 0.3:
                    r.choice(say)(r.choice(pool))
            except MEANT + (ZeroDivisionError, OverflowError):
                pass
        m.kinetic(mbs.quantity(1.0, "kg") * (x.dt() ** 2 + y.dt() ** 2))
        mbs.compile(m, backend="interpreter")

    def face(self, r):
        model = r.choice(self.models)
        r.choice(
            [
                repr,
                str,
                lambda m: m._repr_latex_(),
                lambda m: m._repr_html_(),
                lambda m: m.units,
                lambda m: getattr(m, r.choice(["", "x", "params", "q", "__x__"])),
                lambda m: m.with_params(self.value(r)),
                lambda m: m.state_space(*[self.value(r, (m.dof,))] * r.randrange(5)),
                lambda m: mbs.compile(self.value(r), backend=r.choice(["c", "x", None, 3])),
                lambda m: mbs.set_threads(r.choice([0, 1, 2, 3, -1, 10**30, "1", None])),
            ]
        )(model)


def cases(seed, until, first, only, log):
    """How many were gone through; every one is written down before it is tried."""
    own, number = Cases(), first
    warnings.simplefilter("ignore")
    while (time.monotonic() < until or number < first + 40) if only is None else number == first:
        number = number if only is None else only
        if log:
            log.seek(0)
            log.write(f"{number:12d}")
            log.flush()
        started = time.monotonic()
        try:
            own.run(seed, number)
        except MEANT:
            pass
        except OverflowError:
            pass  # Python's own, of numbers that are no machine words
        except BaseException as error:
            print(f"case {number} of seed {seed}: {type(error).__name__}: {error}", flush=True)
            raise
        finally:
            mbs.set_threads(0)
        if time.monotonic() - started > 20:
            print(f"case {number} of seed {seed} took {time.monotonic() - started:.1f} s", flush=True)
        number += 1
    return number - first


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", type=int)
    parser.add_argument("--child", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    until = time.monotonic() + 60 * arguments.minutes
    if arguments.child or arguments.only is not None:
        with open(arguments.child or os.devnull, "w") as log:
            print(cases(arguments.seed, until, arguments.first, arguments.only, log), "cases, none of them a crash")
        return
    with tempfile.NamedTemporaryFile("r", prefix="mbs-fuzz-") as log:
        line = [
            sys.executable,
            __file__,
            "--child",
            log.name,
            "--seed",
            arguments.seed,
            "--first",
            arguments.first,
            "--minutes",
            arguments.minutes,
        ]
        code = subprocess.run([str(word) for word in line]).returncode
        if code != 0:
            sys.exit(f"the process ended with {code} in case {log.read().strip()} of seed {arguments.seed}")


if __name__ == "__main__":
    main()
