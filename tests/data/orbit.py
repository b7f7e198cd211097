"""Makes orbit.json: libration points, an ellipse of e = 0.6, the Earth and the Moon, growth of displacements.

    python3 orbit.py > orbit.json        (mpmath 1.3, a minute)

By the equilibrium of the restricted problem, Kepler's equation and the motions of orbit_relative.py, in 30 digits and more.
"""

import orbit_relative
from mpmath import cos, findroot, mp, mpf, sin, sqrt
from orbit_relative import CIRCLE, CIRCULAR, attracted, circle, exact, floats, hill, period, relative
from rows import written

RATIOS = {"earth_moon": mpf("0.0121505856"), "arenstorf": mpf("0.012277471")}
DISPLACEMENT = mpf("1e-9")  # km, along x


def libration(mu):
    """Where gravity of both and the centrifugal force leave nothing; the heavy body at -mu, the light one at 1 - mu."""

    def force(x):
        return x - (1 - mu) * (x + mu) / abs(x + mu) ** 3 - mu * (x - 1 + mu) / abs(x - 1 + mu) ** 3

    away = mp.cbrt(mu / 3)
    line = [findroot(force, guess) for guess in (1 - mu - away, 1 - mu + away, -1 - 5 * mu / 12)]
    return [floats((x, 0)) for x in line] + [floats((mpf(1) / 2 - mu, sign * sqrt(mpf(3)) / 2)) for sign in (1, -1)]


def kepler(mu, distance, speed, t):
    """From a point where the motion is square to the way to the centre; position and velocity."""
    a = 1 / (2 / distance - speed**2 / mu)
    n, e = sqrt(mu / a**3), 1 - distance / a
    # From the far point e is negative, and the anomaly is counted from there.
    anomaly = findroot(lambda x: x - e * sin(x) - n * t, n * t)
    c, s, b = cos(anomaly), sin(anomaly), a * sqrt(1 - e * e)
    rate = n / (1 - e * c)
    return (a * (c - e), b * s), (-a * s * rate, b * c * rate)


def grown(name, mass):
    start = exact(CIRCULAR[name])
    there = [start[0] + DISPLACEMENT] + start[1:]
    if mass:
        ends = [attracted(x, period(CIRCLE), steps=240)[0] for x in (there, start)]
    else:
        ends = [relative(circle, x, period(CIRCLE))[0] for x in (there, start)]
    return float(sqrt(sum((x - y) ** 2 for x, y in zip(*ends))) / DISPLACEMENT)


g, earth, moon = mpf("6.6743e-11"), mpf("5.9722e24"), mpf("7.342e22")
between, _ = kepler(g * (earth + moon), mpf("384400000"), mpf(950), mpf(864000))
exactly, linearly = (
    relative(circle, exact(CIRCULAR["near_radial"]), period(CIRCLE))[0], hill(exact(CIRCULAR["near_radial"]), period(CIRCLE))
)
print(written({
    "source": "Computed by orbit.py",
    # Along the axis where it is greatest.
    "hcw_difference_m": float(1000 * max(abs(x - y) for x, y in zip(exactly, linearly))),
    "amplification": [
        [name, mass, grown(name, mass)] for name in ("near_2to1_ellipse", "near_radial") for mass in (0.0, 420000.0)
    ],
    "libration": {name: libration(mu) for name, mu in RATIOS.items()},
    "dimensionless": [
        {"t": float(t), "state": floats(sum(kepler(mpf(1), mpf("0.4"), mpf(2), mpf(t)), ()))} for t in (1, 2, 3, 5, 10)
    ],
    "earth_moon": {
        "body1_m": floats(-moon / (earth + moon) * x for x in between + (mpf(0),)),
        "body2_m": floats(earth / (earth + moon) * x for x in between + (mpf(0),)),
    },
}))
