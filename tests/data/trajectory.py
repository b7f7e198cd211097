"""Makes trajectory.json: both cases of the thesis' table 2 by polynomials, and what they ask of the IRB 7600.

    python3 trajectory.py > trajectory.json        (mpmath 1.3, a minute)

Coefficients are solved for as fractions; torques are Newton's and Euler's, link by link, in doubles.
"""

from fractions import Fraction
from math import cos, radians, sin

import arm
from mpmath import mp, polyroots
from rows import written

START, STOP, END, KNOT = (20, 10, 10, 10, 20, 10), (50, 90, 120, 80, 60, 100), 50, 25
SAMPLES, STEPS = range(0, END + 1, 5), 20_000
CASES = {"case1": Fraction(0), "case2": Fraction(3, 2)}


def row(t, order, n):
    """Of a polynomial of n coefficients the derivative of this order at t."""
    t, found = Fraction(t), []
    for power in range(n):
        factor = 1
        for k in range(order):
            factor *= power - k
        found.append(factor * t ** (power - order) if power >= order else Fraction(0))
    return found


def solved(system):
    """The solution of rows with their right side at the end, by elimination."""
    system = [list(map(Fraction, line)) for line in system]
    for k in range(len(system)):
        pivot = next(i for i in range(k, len(system)) if system[i][k])
        system[k], system[pivot] = system[pivot], system[k]
        system[k] = [x / system[k][k] for x in system[k]]
        for i in range(len(system)):
            if i != k:
                system[i] = [x - system[i][k] * y for x, y in zip(system[i], system[k])]
    return [line[-1] for line in system]


def quartic(q, v, stop):
    ends = [row(0, 0, 5) + [q], row(0, 1, 5) + [v], row(0, 2, 5) + [0], row(END, 0, 5) + [stop], row(END, 1, 5) + [0]]
    return solved(ends)


def quintic(q, v, stop):
    return solved([row(t, k, 6) + [x] for t, given in ((0, (q, v, 0)), (END, (stop, 0, 0))) for k, x in enumerate(given)])


def two_quartics(q, v, stop):
    """With a common third derivative at the knot; the second one's time begins there."""
    none = [0] * 5
    system = [row(0, k, 5) + none + [x] for k, x in enumerate((q, v, 0))]
    system += [none + row(END - KNOT, k, 5) + [x] for k, x in enumerate((stop, 0, 0))]
    system += [row(KNOT, k, 5) + [-x for x in row(0, k, 5)] + [0] for k in range(4)]
    both = solved(system)
    return both[:5], both[5:]


def at(polynomial, t, order=0):
    return sum(a * x for a, x in zip(polynomial, row(t, order, len(polynomial))))


def floats(values):
    return [floats(x) if isinstance(x, (list, tuple)) else float(x) for x in values]


def sampled(polynomials):
    keys = ("position_deg", "velocity_deg_s", "acceleration_deg_s2")
    found = {key: [floats(at(p, t, order) for p in polynomials) for t in SAMPLES] for order, key in enumerate(keys)}
    return {"t_s": floats(SAMPLES), **found}


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def times(m, x):
    return [sum(a * b for a, b in zip(line, x)) for line in m]


def plus(*vectors):
    return [sum(x) for x in zip(*vectors)]


def torques(q, qd, qdd):
    """Newton and Euler in the axes of the links: outwards the motion, inwards force and couple."""
    w, wd, a, links = [0.0] * 3, [0.0] * 3, [0.0, 0.0, float(arm.GRAVITY)], []
    for k in range(6):
        c, s, ca, sa = cos(q[k]), sin(q[k]), float(mp.cos(arm.ALPHA[k])), float(mp.sin(arm.ALPHA[k]))
        turn = [[c, s, 0.0], [-s * ca, c * ca, sa], [s * sa, -c * sa, ca]]
        shift = [float(arm.A[k]), float(arm.D[k]) * sa, float(arm.D[k]) * ca]
        wd = times(turn, plus(wd, [0.0, 0.0, qdd[k]], cross(w, [0.0, 0.0, qd[k]])))
        w = times(turn, plus(w, [0.0, 0.0, qd[k]]))
        a = plus(times(turn, a), cross(wd, shift), cross(w, cross(w, shift)))
        centre = arm.CENTRES[k]
        force = [arm.MASSES[k] * x for x in plus(a, cross(wd, centre), cross(w, cross(w, centre)))]
        xx, xy, xz, yy, yz, zz = arm.INERTIAS[k]
        inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        couple = plus(times(inertia, wd), cross(w, times(inertia, w)))
        links.append((turn, shift, force, plus(couple, cross(centre, force))))
    f, n, found = [0.0] * 3, [0.0] * 3, []
    for turn, shift, force, couple in reversed(links):
        # About the origin of this link, then about that of the joint before it.
        f, n = plus(f, force), plus(n, couple)
        n = plus(n, cross(shift, f))
        back = list(zip(*turn))
        f, n = times(back, f), times(back, n)
        found.append(n[2])
    return found[::-1]


def motion(polynomials, t):
    return [[radians(at(p, t, order)) for p in polynomials] for order in range(3)]


def determinant(polynomials, t):
    q = [mp.radians(sum(mp.mpf(a.numerator) / a.denominator * t**k for k, a in enumerate(p))) for p in polynomials]
    jacobian = mp.zeros(6, 6)
    jacobian[:3, :], jacobian[3:, :] = arm.jacobians(q, arm.frames(q)[6][0], 6)
    return mp.det(jacobian)


def zeros(f):
    """Where f changes its sign, by bisection to 25 digits."""
    found, values = [], [(t, f(mp.mpf(t))) for t in range(END + 1)]
    for (low, before), (high, after) in zip(values, values[1:]):
        if before * after < 0:
            low, high = mp.mpf(low), mp.mpf(high)
            for _ in range(85):
                middle = (low + high) / 2
                low, high = (middle, high) if f(middle) * before > 0 else (low, middle)
            found.append(low)
    return found


def roots(polynomial, order):
    """Inside of the motion."""
    derived = [at(polynomial, 0, order + k) / Fraction(arm.mp.factorial(k).__int__()) for k in range(len(polynomial) - order)]
    while derived and derived[-1] == 0:
        derived.pop()
    found = polyroots([mp.mpf(a.numerator) / a.denominator for a in reversed(derived)], maxsteps=500, extraprec=200)
    inside = [x.real for x in found if abs(x.imag) < mp.mpf(10) ** -20]
    return sorted(x for x in inside if mp.mpf(10) ** -20 < x < END - mp.mpf(10) ** -20)


def extremes(joint, polynomial):
    found, names = {"joint": joint}, (("q", "deg"), ("v", "deg_s"), ("a", "deg_s2"))
    for order, (name, unit) in enumerate(names):
        inside = [Fraction(str(mp.nstr(t, 40))) for t in roots(polynomial, order + 1)]
        values = [at(polynomial, t, order) for t in [0, END] + inside]
        found |= {f"{name}_max_{unit}": float(max(values)), f"{name}_min_{unit}": float(min(values))}
        if order == 0:
            found["interior_stationary_times_s"] = floats(inside)
    return found


def case(velocity):
    given = list(zip(START, [velocity] * 6, STOP))
    quartics, quintics = [quartic(*x) for x in given], [quintic(*x) for x in given]
    pairs = [two_quartics(*x) for x in given]
    first, second = zip(*pairs)
    power = []
    for k in range(STEPS + 1):
        q, qd, qdd = motion(quartics, Fraction(END * k, STEPS))
        power.append(sum(abs(torque * rate) for torque, rate in zip(torques(q, qd, qdd), qd)))
    # Trapezoids.
    energy = END / STEPS * (sum(power) - 0.5 * (power[0] + power[-1]))
    flange = [arm.numbers(arm.frames([mp.radians(at(p, t)) for p in quartics])[6][0]) for t in SAMPLES]
    return {
        "default_quartic": {
            "conditions": "q(0),qdot(0)=v0,qddot(0)=0,q(T),qdot(T)=0; qddot(T) is an output",
            "T_s": float(END),
            "v0_deg_s": float(velocity),
            "coeff_a0_to_a4_deg_per_s_n": floats(quartics),
            **sampled(quartics),
            "final_acceleration_deg_s2": floats(at(p, END, 2) for p in quartics),
            "extrema": [extremes(joint, p) for joint, p in enumerate(quartics, 1)],
            "end_effector_P_m": flange,
            "tau_N_m": [torques(*motion(quartics, t)) for t in SAMPLES],
            "jacobian_det_zero_crossings_s": floats(zeros(lambda t: determinant(quartics, t))),
            "integral_abs_mechanical_power_J": energy,
        },
        "alternative_quintic": {"coeff_a0_to_a5_deg_per_s_n": floats(quintics), **sampled(quintics)},
        "alternative_two_piece_quartic_C3": {
            "knot_time_s": float(KNOT),
            "piece1_a0_to_a4": floats(first),
            "piece2_local_time_a0_to_a4": floats(second),
            "mid_position_deg": floats(at(p, 0) for p in second),
            "mid_velocity_deg_s": floats(at(p, 0, 1) for p in second),
            "mid_acceleration_deg_s2": floats(at(p, 0, 2) for p in second),
        },
    }


print(written({name: case(velocity) for name, velocity in CASES.items()}))
