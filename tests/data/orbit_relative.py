"""Makes orbit_relative.json: motions about a station, as two of Kepler's, linear ones, and one that the station attracts.

    python3 orbit_relative.py > orbit_relative.json        (mpmath 1.3, a minute)

The station flies on a circle of 6778.137 km, or from the nearest point of an ellipse of a = 7500 km, e = 0.1; axes x away
from the Earth, y along the motion, z normal to it; velocities in these axes, which turn. Two Kepler motions in 50 digits
by Kepler's equation in universal variables (Battin, 1999, section 4.5); the linear motions are the slope of their
difference, which is Tschauner's and Hempel's, or Clohessy's and Wiltshire's closed form; with a mass of the station that
attracts as a point, Gragg's extrapolation in 30 digits.
"""

from mpmath import cos, mp, mpf, pi, sin, sqrt
from rows import written

MU = mpf("398600.4418")
ATTRACTION = mpf("6.6743e-11") * 420_000 / 10**9  # km^3/s^2
CIRCLE, ELLIPSE = mpf("6778.137"), (mpf(7500), mpf("0.1"))
CIRCULAR = {
    "far_radial": (1000.0, 0, 0, 0, 0, 0),
    "far_tangent": (0, 1000.0, 0, 0, 0, 0),
    "far_same_orbit": (-73.76658217442363, 997.2755343205326, 0, 0, 0, 0),
    "near_radial": (0.003, 0, 0, 0, 0, 0),
    "near_tangent": (0, 0.003, 0, 0, 0, 0),
    "near_2to1_ellipse": (0.003, 0, 0, 0, -6.788199921666135e-06, 0),
    "near_3d": (0.002, 0.001, 0.002, 1e-06, -2e-06, 1.5e-06),
}
ELLIPTIC = {"near": (0.003, 0.001, 0.002, 1e-06, -6e-06, 1e-06), "far": (0, 1000.0, 0, 0, 0, 0)}
QUARTERS, PARTS = (mpf(1) / 4, mpf(1) / 2, 1, 2), [mpf(x) / 10 for x in (2, 5, 8, 10, 13)]
mp.dps = 50


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def combined(s, a, t, b):
    return [s * x + t * y for x, y in zip(a, b)]


def stumpff(z):
    """c2 and c3 by their series, the argument made small by halving is not needed: it is below 200 here."""
    found = []
    for first in (2, 3):
        term, total, k = 1 / mp.factorial(first), mpf(0), first
        while abs(term) > mpf(10) ** -(mp.dps + 40) or k < 10:
            total += term
            term *= -z / ((k + 1) * (k + 2))
            k += 2
        found.append(total)
    return found


def kepler(r0, v0, t):
    """The state after t on a bound orbit."""
    r, alpha, sigma = sqrt(dot(r0, r0)), 2 / sqrt(dot(r0, r0)) - dot(v0, v0) / MU, dot(r0, v0) / sqrt(MU)
    x = sqrt(MU) * t * alpha
    for _ in range(100):
        c2, c3 = stumpff(alpha * x * x)
        f = sigma * x**2 * c2 + (1 - alpha * r) * x**3 * c3 + r * x - sqrt(MU) * t
        slope = sigma * x * (1 - alpha * x * x * c3) + (1 - alpha * r) * x**2 * c2 + r
        x -= f / slope
        if abs(f / slope) < mpf(10) ** (5 - mp.dps) * (1 + abs(x)):
            break
    c2, c3 = stumpff(alpha * x * x)
    position = combined(1 - x * x * c2 / r, r0, t - x**3 * c3 / sqrt(MU), v0)
    s = sqrt(dot(position, position))
    rate = sqrt(MU) * x * (alpha * x * x * c3 - 1) / (s * r)
    return position, combined(rate, r0, 1 - x * x * c2 / s, v0)


def axes(r, v):
    """Of the station: x, y, z, and how fast they turn about z."""
    h = cross(r, v)
    x, z = [c / sqrt(dot(r, r)) for c in r], [c / sqrt(dot(h, h)) for c in h]
    return [x, cross(z, x), z], sqrt(dot(h, h)) / dot(r, r)


def outward(station, relative):
    """From the station's axes to a state about the Earth."""
    (x, y, z), w = axes(*station)
    p, u = relative[:3], relative[3:]
    u = [u[0] - w * p[1], u[1] + w * p[0], u[2]]
    turned = lambda a: [a[0] * i + a[1] * j + a[2] * k for i, j, k in zip(x, y, z)]
    return turned(p), turned(u)


def inward(station, p, u):
    frame, w = axes(*station)
    p, u = [dot(axis, p) for axis in frame], [dot(axis, u) for axis in frame]
    return p, [u[0] + w * p[1], u[1] - w * p[0], u[2]]


def relative(station, start, t):
    p, u = outward(station, start)
    ours, theirs = kepler(*station, t), kepler(combined(1, station[0], 1, p), combined(1, station[1], 1, u), t)
    return inward(ours, combined(1, theirs[0], -1, ours[0]), combined(1, theirs[1], -1, ours[1]))


def linear(station, start, t):
    """The slope of the exact motion."""
    part = mpf(10) ** -16
    there, back = (relative(station, [sign * part * x for x in start], t)[0] for sign in (1, -1))
    return [(a - b) / (2 * part) for a, b in zip(there, back)]


def hill(start, t):
    """Clohessy and Wiltshire."""
    x, y, z, u, v, w = start
    n = sqrt(MU / CIRCLE**3)
    s, c = sin(n * t), cos(n * t)
    return [
        (4 - 3 * c) * x + s / n * u + 2 * (1 - c) / n * v,
        6 * (s - n * t) * x + y - 2 * (1 - c) / n * u + (4 * s - 3 * n * t) / n * v,
        c * z + s / n * w,
    ]


def attracted(start, t, steps=120):
    """The motion beside the station's on its circle, which the station attracts: Gragg's midpoints, extrapolated."""
    n = sqrt(MU / CIRCLE**3)
    place = lambda time: [CIRCLE * cos(n * time), CIRCLE * sin(n * time), mpf(0)]
    station = lambda time: (place(time), [-CIRCLE * n * sin(n * time), CIRCLE * n * cos(n * time), mpf(0)])

    def slope(time, y):
        at, p = place(time), y[:3]
        whole = combined(1, at, 1, p)
        far, near = dot(whole, whole), dot(p, p)
        return y[3:] + [
            -MU * (w / (far * sqrt(far)) - a / CIRCLE**3) - ATTRACTION * x / (near * sqrt(near))
            for w, a, x in zip(whole, at, p)
        ]

    def midpoints(time, y, step, count):
        h = step / count
        before, now = y, combined(1, y, h, slope(time, y))
        for k in range(1, count):
            before, now = now, combined(1, before, 2 * h, slope(time + k * h, now))
        return [(a + b + h * c) / 2 for a, b, c in zip(before, now, slope(time + step, now))]

    p, u = outward(station(mpf(0)), start)
    y = list(p) + list(u)
    for k in range(steps):
        time, table = t * k / steps, []
        for count in range(2, 18, 2):
            row = [midpoints(time, y, t / steps, count)]
            for j, other in enumerate(table[-1] if table else []):
                ratio = (mpf(count) / (count - 2 * (j + 1))) ** 2
                row.append([a + (a - b) / (ratio - 1) for a, b in zip(row[j], other)])
            table.append(row)
        y = table[-1][-1]
    return inward(station(t), y[:3], y[3:])


def floats(values):
    return [float(x) + 0.0 for x in values]


def exact(start):
    """The numbers are decimal."""
    return [mpf(repr(x)) for x in start]


def period(a):
    return 2 * pi * sqrt(a**3 / MU)


def case(station, start, times, name, model):
    samples = []
    for t in times:
        position, velocity = relative(station, exact(start), t)
        sample = {"t_s": float(t), "position_km": floats(position), "velocity_km_s": floats(velocity)}
        samples.append(sample | ({name: floats(model(exact(start), t))} if model else {}))
    return {"initial_lvlh_km_km_s": start, "samples": samples}


circle = ([CIRCLE, mpf(0), mpf(0)], [mpf(0), sqrt(MU / CIRCLE), mpf(0)])
quarters = [part * period(CIRCLE) for part in QUARTERS]

if __name__ == "__main__":
    a, e = ELLIPSE
    ellipse = ([a * (1 - e), mpf(0), mpf(0)], [mpf(0), sqrt(MU / a * (1 + e) / (1 - e)), mpf(0)])
    parts = [part * period(a) for part in PARTS]
    found = {
        "source": "Computed by orbit_relative.py; km, km/s, of the station's mass m, m/s",
        "relative_circular": {
            name: case(circle, start, quarters, "hcw_position_km", hill) for name, start in CIRCULAR.items()
        },
        "relative_elliptic": {
            name: case(ellipse, start, parts, "tschauner_hempel_YA_position_km", None if name == "far" else lambda s, t: linear(ellipse, s, t))
            for name, start in ELLIPTIC.items()
        },
    }
    mp.dps = 30
    with_mass = []
    for name in ("near_radial", "near_tangent", "near_2to1_ellipse"):
        for t in quarters[:3]:
            position, velocity = attracted(exact(CIRCULAR[name]), t)
            metres = {"position_m": floats(1000 * x for x in position), "velocity_m_s": floats(1000 * x for x in velocity)}
            with_mass.append({"case": name, "t_s": float(t)} | metres)
    print(written(found | {"relative_with_station_mass": with_mass}))
