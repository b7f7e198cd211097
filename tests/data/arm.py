"""The IRB 7600 in any number of digits: poses, Jacobian, energies' matrices; for serial.py and trajectory.py.

Denavit-Hartenberg's parameters are those of the thesis, table 1; masses, mass centres and inertias are assumed, as
docs/thesis/assumed.md says, in the axes of the links, inertias about the mass centres.
"""

from mpmath import cos, matrix, mp, mpf, pi, sin

mp.dps = 50
GRAVITY = mpf("9.80665")
D, A = [mpf(x) for x in ("0.78", "0", "0", "1.056", "0", "0.25")], [mpf(x) for x in ("0.41", "1.075", "0.165", "0", "0", "0")]
ALPHA = [x * pi / 180 for x in (-90, 0, -90, 90, -90, 0)]
MASSES = (650.0, 390.0, 480.0, 150.0, 90.0, 40.0)
CENTRES = ((-0.2, 0.25, 0.0), (-0.56, 0.0, 0.05), (-0.1, 0.02, 0.15), (0.0, -0.35, 0.0), (0.0, 0.0, 0.08), (0.0, 0.0, -0.03))
INERTIAS = (  # xx, xy, xz, yy, yz, zz
    (60.0, 0.0, 0.0, 55.0, 0.0, 60.0), (12.0, 0.0, 0.0, 50.0, 0.0, 48.0), (30.0, 0.0, 0.0, 28.0, 0.0, 18.0),
    (8.0, 0.0, 0.0, 2.0, 0.0, 8.0), (1.2, 0.0, 0.0, 1.0, 0.0, 0.9), (0.35, 0.0, 0.0, 0.35, 0.0, 0.6),
)


def exact(x):
    """The decimal number that a double stands for."""
    return mpf(repr(x))


def cross(a, b):
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def frames(q):
    """Origin and axes of the base and of every link."""
    origin, axes = matrix([0, 0, 0]), mp.eye(3)
    found = [(origin, axes)]
    for angle, d, a, alpha in zip(q, D, A, ALPHA):
        c, s, ca, sa = cos(angle), sin(angle), cos(alpha), sin(alpha)
        origin = origin + axes * matrix([a * c, a * s, d])
        axes = axes * matrix([[c, -s * ca, s * sa], [s, c * ca, -c * sa], [0, sa, ca]])
        found.append((origin, axes))
    return found


def jacobians(q, point, link):
    """Of a point, fixed in this link, counted from 1: velocity and angular velocity by the rates of the joints."""
    linear, angular = mp.zeros(3, 6), mp.zeros(3, 6)
    for j, (origin, axes) in enumerate(frames(q)[:link]):
        axis = axes[:, 2]
        linear[:, j], angular[:, j] = cross(axis, point - origin), axis
    return linear, angular


def bodies(q):
    """Of every link: mass, inertia in the axes of the base, Jacobians of its mass centre."""
    for k, (mass, centre, inertia) in enumerate(zip(MASSES, CENTRES, INERTIAS), 1):
        origin, axes = frames(q)[k]
        xx, xy, xz, yy, yz, zz = map(exact, inertia)
        tensor = axes * matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) * axes.T
        point = origin + axes * matrix([exact(x) for x in centre])
        yield (exact(mass), tensor) + jacobians(q, point, k)


def mass_matrix(q):
    return sum((m * v.T * v + w.T * tensor * w for m, tensor, v, w in bodies(q)), mp.zeros(6, 6))


def gravity(q):
    """dV/dq, with g against the base's z."""
    return sum((m * GRAVITY * v[2, :].T for m, _, v, _ in bodies(q)), mp.zeros(6, 1))


def slopes(q):
    """dM/dq, by differences far below the digits that are written."""
    step, found = mpf(10) ** -18, []
    for k in range(6):
        there, back = list(q), list(q)
        there[k], back[k] = q[k] + step, q[k] - step
        found.append((mass_matrix(there) - mass_matrix(back)) / (2 * step))
    return found


def coriolis_matrix(q, qd):
    """Christoffel's form."""
    m = slopes(q)
    c = mp.zeros(6, 6)
    for i in range(6):
        for j in range(6):
            c[i, j] = sum((m[k][i, j] + m[j][i, k] - m[i][j, k]) * qd[k] for k in range(6)) / 2
    return c


def numbers(x):
    """Doubles, rows of rows where it is a matrix."""
    if x.cols == 1:
        return [float(x[i]) + 0.0 for i in range(x.rows)]
    return [[float(x[i, j]) + 0.0 for j in range(x.cols)] for i in range(x.rows)]
