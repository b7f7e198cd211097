"""Makes orbit_kepler.json: Kepler motions in 80 digits, by the classical equations in E, H and tan(nu/2).

    python3 orbit_kepler.py > orbit_kepler.json        (mpmath 1.3)

Each row: mu, time, six numbers of the state before, six of the state after. The states before are doubles and taken as exact.
"""

import json
import math
import random

from mpmath import mp, mpf

mp.dps = 80
random.seed(7)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def root(f, derivative, x):
    """Newton's method to the last digit, x to the right of the root of an increasing convex function."""
    for _ in range(400):
        step = f(x) / derivative(x)
        x -= step
        if abs(step) <= mpf(10) ** -76 * max(abs(x), mpf(10) ** -30):
            return x
    raise ArithmeticError


def propagated(mu, time, r0, v0):
    mu, time = mpf(mu), mpf(time)
    r0, v0 = [mpf(x) for x in r0], [mpf(x) for x in v0]
    distance = mp.sqrt(dot(r0, r0))
    h = cross(r0, v0)
    p = dot(h, h) / mu
    vector = [x / mu - r / distance for x, r in zip(cross(v0, h), r0)]
    e = mp.sqrt(dot(vector, vector))
    toward = [x / e for x in vector] if e > 0 else [x / distance for x in r0]
    normal = [x / mp.sqrt(dot(h, h)) for x in h]
    ahead = cross(normal, toward)
    x, y = dot(r0, toward), dot(r0, ahead)
    energy = dot(v0, v0) / 2 - mu / distance
    if energy < 0:
        a = -mu / (2 * energy)
        n = mp.sqrt(mu / a**3)
        b = mp.sqrt(a * p)
        anomaly = mp.atan2(y / b, x / a + e)
        mean = anomaly - e * mp.sin(anomaly) + n * time
        mean -= 2 * mp.pi * mp.nint(mean / (2 * mp.pi))
        sign = 1 if mean >= 0 else -1
        mean = abs(mean)
        E = sign * root(lambda E: E - e * mp.sin(E) - mean, lambda E: 1 - e * mp.cos(E), mp.pi)
        c, s = mp.cos(E), mp.sin(E)
        x, y, rate = a * (c - e), b * s, n / (1 - e * c)
        u, v = -a * s * rate, b * c * rate
    elif energy > 0:
        a = mu / (2 * energy)
        n = mp.sqrt(mu / a**3)
        b = mp.sqrt(a * p)
        anomaly = mp.asinh(y / b)
        mean = e * mp.sinh(anomaly) - anomaly + n * time
        sign = 1 if mean >= 0 else -1
        mean = abs(mean)
        # sinh H - H <= M for the start.
        start = mp.asinh(mean / (e - 1)) if mean < e - 1 else mp.asinh(mean + 60) + 1
        H = sign * root(lambda H: e * mp.sinh(H) - H - mean, lambda H: e * mp.cosh(H) - 1, start)
        c, s = mp.cosh(H), mp.sinh(H)
        x, y, rate = a * (e - c), b * s, n / (e * c - 1)
        u, v = -a * s * rate, b * c * rate
    else:
        tangent = y / (x + distance)
        barker = tangent + tangent**3 / 3 + 2 * mp.sqrt(mu / p**3) * time
        w = mp.sqrt(barker**2 * mpf(9) / 4 + 1) + abs(barker) * mpf(3) / 2
        t = (mp.cbrt(w) - 1 / mp.cbrt(w)) * (1 if barker >= 0 else -1)
        x, y = p / 2 * (1 - t * t), p * t
        rate = 2 * mp.sqrt(mu / p**3) / (1 + t * t)
        u, v = -p * t * rate, p * rate
    position = [x * i + y * j for i, j in zip(toward, ahead)]
    velocity = [u * i + v * j for i, j in zip(toward, ahead)]
    return [float(c) for c in position + velocity]


def random_direction():
    z, turn = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
    return [math.sqrt(1 - z * z) * math.cos(turn), math.sqrt(1 - z * z) * math.sin(turn), z]


def random_state(e):
    """Doubles near a state of this eccentricity, and the time of one radian of mean anomaly."""
    mu, q = 10 ** random.uniform(-3, 15), 10 ** random.uniform(-2, 8)
    if e < 1:
        a = q / (1 - e)
        E = random.uniform(-math.pi, math.pi)
        nu = 2 * math.atan2(math.sqrt(1 + e) * math.sin(E / 2), math.sqrt(1 - e) * math.cos(E / 2))
    elif e > 1:
        a = q / (e - 1)
        H = random.uniform(-5, 5)
        nu = 2 * math.atan(math.sqrt((e + 1) / (e - 1)) * math.tanh(H / 2))
    else:
        a, nu = q, random.uniform(-3, 3)
    p = q * (1 + e)
    r, speed = p / (1 + e * math.cos(nu)), math.sqrt(mu / p)
    x = random_direction()
    y = cross(random_direction(), x)
    y = [c / math.sqrt(dot(y, y)) for c in y]
    c, s = math.cos(nu), math.sin(nu)
    position = [r * (c * i + s * j) for i, j in zip(x, y)]
    velocity = [speed * (-s * i + (e + c) * j) for i, j in zip(x, y)]
    return mu, math.sqrt(a**3 / mu), position, velocity


def rows():
    kinds = [lambda: random.uniform(0, 5)] * 600
    kinds += [lambda: 1 - 10 ** random.uniform(-13, -2)] * 120
    kinds += [lambda: 1 + 10 ** random.uniform(-13, -2)] * 120
    kinds += [lambda: 10 ** random.uniform(-17, -2)] * 120
    for kind in kinds:
        e = kind()
        mu, unit, r, v = random_state(e)
        # A parabola's radian is that of its nearest distance; so is one of what is nearly a parabola, half of the times.
        if abs(e - 1) < 0.01 and random.random() < 0.5:
            unit *= abs(e - 1) ** 1.5
        time = unit * random.uniform(-100, 100)
        yield [mu, time] + r + v + propagated(mu, time, r, v)
    for _ in range(40):
        # Parabolas to the last bit: mu = v^2 r / 2 in small whole numbers.
        x, y, d = random.choice([(3, 4, 5), (5, 12, 13), (8, 15, 17), (7, 24, 25)])
        r = random.choice([[x, y, 0], [-y, 0, x], [0, x, -y]])
        v = [random.randint(-9, 9) for _ in range(2)] + [random.choice([-3, 2, 5])]
        if dot(cross(r, v), cross(r, v)) == 0:
            continue
        mu = dot(v, v) * d / 2
        time = random.uniform(-30, 30)
        r, v = [float(c) for c in r], [float(c) for c in v]
        yield [mu, time] + r + v + propagated(mu, time, r, v)


table = list(rows())
print('{\n  "source": "Computed by orbit_kepler.py, 80 digits",\n  "rows": [')
print(",\n".join("    " + json.dumps(row) for row in table))
print("  ]\n}")
