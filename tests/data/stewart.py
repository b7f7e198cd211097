"""Makes stewart.json: lengths, forces and matrices of the Stewart platform of models/mechanisms/stewart_platform.mbs.

    python3 stewart.py > stewart.json        (mpmath 1.3, numpy for extremes; a few minutes)

From the places of mass centres and joints alone: M by their Jacobians, C by Christoffel's symbols, G by the potential,
forces of the legs by virtual work; derivatives by differences far below the digits that are written.
"""

import math

import numpy
from mpmath import cos, lu_solve, matrix, mp, mpf, pi, radians, sin, sqrt, svd_r
from rows import written

mp.dps = 80
GRAVITY, BASE, PLATFORM, HALF = mpf("9.80665"), mpf("1.2"), mpf("0.9"), 12
OWN, SIZE = ((250, (55, 55, 105))), [mpf(x) for x in ("1.2", "1.0", "0.8")]
CYLINDER, PISTON = (35, mpf("0.35"), mpf(3)), (15, mpf("0.4"), mpf("1.5"))
HOME, OMEGA = mpf("1.1"), pi / 2
PAIRS = [(120 * (k // 2), -1 if k % 2 == 0 else 1) for k in range(6)]
SMALL = mpf(10) ** -30


def on_circle(radius, degrees):
    return matrix([radius * cos(radians(degrees)), radius * sin(radians(degrees)), 0])


FEET = [on_circle(BASE, pair + side * HALF) for pair, side in PAIRS]
JOINTS = [on_circle(PLATFORM, pair + side * (60 - HALF)) for pair, side in PAIRS]


def attitude(q):
    (a, b, c), (d, e, f) = (cos(x) for x in q[3:]), (sin(x) for x in q[3:])
    x, y = matrix([[1, 0, 0], [0, a, -d], [0, d, a]]), matrix([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    return matrix([[c, -f, 0], [f, c, 0], [0, 0, 1]]) * y * x


def legs(q):
    r, place = attitude(q), matrix(q[:3])
    return [place + r * joint - foot for joint, foot in zip(JOINTS, FEET)]


def norm(v):
    return sqrt(sum(x * x for x in v))


def lengths(q):
    return matrix([norm(leg) for leg in legs(q)])


def slope(f, q):
    """Columns are the coordinates."""
    columns = []
    for k in range(6):
        there, back = list(q), list(q)
        there[k], back[k] = q[k] + SMALL, q[k] - SMALL
        columns.append((f(there) - f(back)) / (2 * SMALL))
    found = mp.zeros(columns[0].rows, 6)
    for k, column in enumerate(columns):
        found[:, k] = column
    return found


def weights(payload, actuators):
    """Masses with their places, and unit vectors with the inertia of what turns with them."""
    middle = matrix([0, 0, SIZE[2] / 2])

    def places(q):
        r, place = attitude(q), matrix(q[:3])
        found = [(mpf(OWN[0]), place), (mpf(payload), place + r * middle)]
        if actuators:
            for leg, foot in zip(legs(q), FEET):
                u = leg / norm(leg)
                found += [(mpf(CYLINDER[0]), foot + CYLINDER[1] * u), (mpf(PISTON[0]), foot + leg - PISTON[1] * u)]
        return found

    def turning(q):
        return [leg / norm(leg) for leg in legs(q)] if actuators else []

    def tensor(q):
        a, b, c = (x * x for x in SIZE)
        box = [mpf(payload) / 12 * x for x in (b + c, a + c, a + b)]
        r = attitude(q)
        return r * mp.diag([x + y for x, y in zip(OWN[1], box)]) * r.T

    return places, turning, tensor


def stacked(vectors):
    return matrix([x for vector in vectors for x in vector])


def turns(q):
    """The angular velocity by the rates of roll, pitch and yaw, and by those of the place none."""
    found = mp.zeros(3, 6)
    c, s, ct, st = cos(q[5]), sin(q[5]), cos(q[4]), sin(q[4])
    for k, axis in enumerate(([c * ct, s * ct, -st], [-s, c, 0], [0, 0, 1])):
        found[:, 3 + k] = matrix(axis)
    return found


def mass_matrix(q, parts):
    places, turning, tensor = parts
    w = turns(q)
    m = w.T * tensor(q) * w
    masses, moved = [mass for mass, _ in places(q)], slope(lambda q: stacked(place for _, place in places(q)), q)
    for k, mass in enumerate(masses):
        rows = moved[3 * k : 3 * k + 3, :]
        m += mass * (rows.T * rows)
    if turning(q):
        rows = slope(lambda q: stacked(turning(q)), q)
        m += (CYLINDER[2] + PISTON[2]) * (rows.T * rows)
    return m


def gravity(q, parts):
    potential = lambda q: matrix([sum(mass * GRAVITY * place[2] for mass, place in parts[0](q))])
    return slope(potential, q).T


def coriolis_matrix(q, qd, parts):
    step, m = mpf(10) ** -12, []
    for k in range(6):
        there, back = list(q), list(q)
        there[k], back[k] = q[k] + step, q[k] - step
        m.append((mass_matrix(there, parts) - mass_matrix(back, parts)) / (2 * step))
    entry = lambda i, j: sum((m[k][i, j] + m[j][i, k] - m[i][j, k]) * qd[k] for k in range(6)) / 2
    return matrix([[entry(i, j) for j in range(6)] for i in range(6)])


def force(q, qd, qdd, parts):
    """Generalized, and of the legs."""
    rates, accelerations = matrix(qd), matrix(qdd)
    total = mass_matrix(q, parts) * accelerations + gravity(q, parts)
    if any(qd):
        total += coriolis_matrix(q, qd, parts) * rates
    return total, lu_solve(slope(lengths, q).T, total)


def motion(t, mean, sine, cosine, frequency):
    t = mpf(t)
    rows = list(zip(mean, sine, cosine, frequency))
    q = [m + s * sin(w * t) + c * cos(w * t) for m, s, c, w in rows]
    qd = [w * (s * cos(w * t) - c * sin(w * t)) for _, s, c, w in rows]
    return q, qd, [-w * w * (x - m) for x, (m, _, _, w) in zip(q, rows)]


def decimal(*numbers):
    return [mpf(x) for x in numbers]


NONE = [mpf(0)] * 6
TABLE_3 = (decimal("-0.2", "-0.3") + [HOME] + NONE[:3], NONE, decimal(0, 0, "-0.08", 0, 0, 0), [OMEGA] * 6)
COMBINED = (
    [mpf(0), mpf(0), HOME] + NONE[:3],
    decimal("0.05", 0, "0.06", "0.1", 0, "0.15"),
    decimal(0, "0.07", 0, 0, "0.12", 0),
    decimal("1.3", "1.1", "0.9", "1.3", "1.3", "1.7"),
)


def table_4(angles, height):
    mean = decimal("-0.3", 0) + [height + mpf("0.7")] + [radians(x) for x in angles]
    return mean, decimal("0.25", "-0.4", "0.5", 0, 0, 0), NONE, [OMEGA] * 6


def floats(values):
    return [floats(x) if isinstance(x, list) else float(x) + 0.0 for x in values]


def rows(m):
    return floats([[m[i, j] for j in range(m.cols)] for i in range(m.rows)])


def sampled(of, parts):
    moments = [motion(k / mpf(2), *of) for k in range(9)]
    return {
        "lengths": [floats(lengths(q)) for q, _, _ in moments],
        "forces": [floats(force(q, qd, qdd, parts)[1]) for q, qd, qdd in moments],
    }


def jacobian(q):
    """Of the lengths by the platform's velocity and angular velocity."""
    r, found = attitude(q), mp.zeros(6, 6)
    for k, (leg, joint) in enumerate(zip(legs(q), JOINTS)):
        u, arm = leg / norm(leg), r * joint
        found[k, :] = matrix([[*u, arm[1] * u[2] - arm[2] * u[1], arm[2] * u[0] - arm[0] * u[2], arm[0] * u[1] - arm[1] * u[0]]])
    return found


def surveyed(of):
    """Lengths, condition and determinant at 4001 instants of one period, in doubles."""
    mean, sine, cosine, frequency = ([float(x) for x in row] for row in of)
    feet, joints = (numpy.array([[float(x) for x in point] for point in points]) for points in (FEET, JOINTS))
    found = []
    for k in range(4001):
        q = [m + s * math.sin(w * k / 1000) + c * math.cos(w * k / 1000) for m, s, c, w in zip(mean, sine, cosine, frequency)]
        (a, b, c), (d, e, f) = map(math.cos, q[3:]), map(math.sin, q[3:])
        x, y = numpy.array([[1, 0, 0], [0, a, -d], [0, d, a]]), numpy.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
        arms = joints @ (numpy.array([[c, -f, 0], [f, c, 0], [0, 0, 1]]) @ y @ x).T
        leg = numpy.array(q[:3]) + arms - feet
        length = numpy.linalg.norm(leg, axis=1)
        u = leg / length[:, None]
        j = numpy.hstack([u, numpy.cross(arms, u)])
        found.append((length.min(), length.max(), numpy.linalg.cond(j), numpy.linalg.det(j)))
    return list(zip(*found))


def spherical():
    """A leg's joint from its length, azimuth and angle to the vertical, and their rates."""
    inputs = {
        "rho": 1.3, "alpha": 0.7, "beta": 0.4, "rhod": 0.2, "alphad": -0.5, "betad": 0.3, "rhodd": 0.15, "alphadd": 0.25, "betadd": -0.35,
    }
    exact = {name: mpf(repr(x)) for name, x in inputs.items()}

    def place(rho, alpha, beta):
        return rho * matrix([cos(alpha) * sin(beta), sin(alpha) * sin(beta), cos(beta)])

    names = ("rho", "alpha", "beta")
    at = lambda t: place(*(exact[n] + exact[n + "d"] * t + exact[n + "dd"] * t * t / 2 for n in names))
    step, here = mpf(10) ** -15, [exact[n] for n in names]
    columns = []
    for k in range(3):
        there, back = list(here), list(here)
        there[k], back[k] = here[k] + step, here[k] - step
        columns.append((place(*there) - place(*back)) / (2 * step))
    return {
        "inputs": inputs,
        "velocity": floats((at(step) - at(-step)) / (2 * step)),
        "acceleration": floats((at(step) - 2 * at(0) + at(-step)) / step**2),
        "C": floats([[columns[j][i] for j in range(3)] for i in range(3)]),
    }


def matrices(parts):
    q, qd, _ = motion(mpf("0.3"), *COMBINED)
    return {"M": rows(mass_matrix(q, parts)), "C": rows(coriolis_matrix(q, qd, parts)), "G": floats(gravity(q, parts))}


def turned(angles):
    of = table_4(angles, HOME)
    least, most, condition, _ = surveyed(of)
    return {
        "angles_deg": angles,
        "leg_min_m": min(least),
        "leg_max_m": max(most),
        "max_cond_J": max(condition),
        "with_actuators": sampled(of, weights(300, True)),
        "without_actuators": sampled(of, weights(300, False)),
    }


def general(t, actuators):
    q, qd, qdd = motion(mpf(t), *COMBINED)
    total, of_legs = force(q, qd, qdd, weights(300, actuators))
    return {
        "t_s": float(t), "actuators": actuators, "payload_kg": 300.0, "q": floats(q), "qd": floats(qd), "qdd": floats(qdd),
        "Q_N_or_Nm": floats(total), "leg_force_N": floats(of_legs),
    }


home, known = [mpf(0), mpf(0), HOME] + NONE[:3], decimal("0.05", "-0.04", "1.15", "0.1", "-0.08", "0.2")
values = svd_r(jacobian(home), compute_uv=False)
determinants = surveyed(table_4((10, 0, 20), 0))[3]
print(written({
    "source": "Computed by stewart.py; m, N, kg, s, rad",
    "table3": {
        f"payload_{payload}_act_{actuators}": sampled(TABLE_3, weights(payload, actuators))
        for payload in (0, 300, 1250)
        for actuators in (False, True)
    },
    "table4": {
        name: turned(angles) for name, angles in
        (("base_psi20", (0, 0, 20)), ("theta10_psi20", (0, 10, 20)), ("phi10_psi20", (10, 0, 20)))
    },
    "table4_from_the_base_phi10": {"det_J_min": min(determinants), "det_J_max": max(determinants)},
    "home": {
        "home_leg_length_m": float(lengths(home)[0]), "home_Jtwist": rows(jacobian(home)), "home_cond": float(values[0] / values[5]),
    },
    "fk_newton": {"q_true": floats(known), "lengths_m": floats(lengths(known))},
    "spherical_leg": spherical(),
    "general": [general(t, actuators) for t in ("0.3", "1.1", "2.7") for actuators in (False, True)],
    "eq_4_18": {"with_actuators": matrices(weights(300, True)), "without_actuators": matrices(weights(300, False))},
}))
