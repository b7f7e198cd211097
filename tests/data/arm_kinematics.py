"""Makes arm_kinematics.json: poses of the IRB 7600 and its eight configurations, by the formulas of a spherical wrist.

    python3 arm_kinematics.py > arm_kinematics.json        (the standard library alone)

Denavit-Hartenberg's parameters and angles are those of the thesis, tables 1 and 2; PRINTED is its (3.20), (3.21).
"""

import json
from math import acos, atan2, cos, degrees, hypot, pi, radians, sin

D, A, ALPHA = (0.78, 0, 0, 1.056, 0, 0.25), (0.41, 1.075, 0.165, 0, 0, 0), (-90, 0, -90, 90, -90, 0)
TABLE_1 = (45, 30, 30, -45, 30, 0)
PRINTED = (0.2586, 0.1336, -0.4601), ((-0.5227, 0.75, -0.4053), (0.3433, -0.25, -0.9053), (-0.7803, -0.6124, -0.1268))
TABLE_2 = {"fk_table2_start": (20, 10, 10, 10, 20, 10), "fk_table2_stop": (50, 90, 120, 80, 60, 100)}
FOREARM, BEND = hypot(A[2], D[3]), atan2(D[3], A[2])


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))] for i in range(len(a))]


def pose(angles):
    """Position and rotation behind the joints with these angles."""
    frame = [[float(i == j) for j in range(4)] for i in range(4)]
    for q, d, a, alpha in zip(angles, D, A, ALPHA):
        c, s, ca, sa = cos(q), sin(q), cos(radians(alpha)), sin(radians(alpha))
        link = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        frame = times(frame, link)
    return [row[3] for row in frame[:3]], [row[:3] for row in frame[:3]]


def within_a_turn(angle):
    return atan2(sin(angle), cos(angle)) if abs(angle) > pi else angle


def configurations(position, rotation):
    """Shoulder in front or behind, elbow, wrist: the arm to the wrist's centre in its plane, then the wrist."""
    x, y, z = (p - D[5] * row[2] for p, row in zip(position, rotation))
    for shoulder, side in ("front", 1), ("back", -1):
        first = within_a_turn(atan2(y, x) + (0 if side == 1 else -pi))
        across, down = side * hypot(x, y) - A[0], D[0] - z
        span = (across**2 + down**2 - A[1] ** 2 - FOREARM**2) / (2 * A[1] * FOREARM)
        for elbow in 1, -1:
            bend = elbow * acos(span)
            second = atan2(down, across) - atan2(FOREARM * sin(bend), A[1] + FOREARM * cos(bend))
            third = within_a_turn(bend - BEND)
            second = within_a_turn(second)
            _, arm = pose((first, second, third))
            hand = times([list(column) for column in zip(*arm)], rotation)
            for wrist in 1, -1:
                fourth = atan2(-wrist * hand[1][2], -wrist * hand[0][2])
                c, s = cos(fourth), sin(fourth)
                fifth = atan2(-c * hand[0][2] - s * hand[1][2], hand[2][2])
                sixth = atan2(c * hand[1][0] - s * hand[0][0], c * hand[1][1] - s * hand[0][1])
                angles = [first, second, third, fourth, fifth, sixth]
                yield {"shoulder": shoulder, "elbow": elbow, "wrist": wrist, "theta_rad": angles}


def forward(degrees_of_joints):
    position, rotation = pose(map(radians, degrees_of_joints))
    return {"theta_deg": list(degrees_of_joints), "P_m": position, "R": rotation}


LONGEST = A[0] + A[1] + FOREARM
print(json.dumps({
    "source": "Computed by arm_kinematics.py; DH angles, the base's axes",
    **{name: forward(angles) for name, angles in TABLE_2.items()},
    "ik_table1": list(configurations(*pose(map(radians, TABLE_1)))),
    "ik_printed_rounded_inputs_deg": [degrees(q) for q in next(configurations(*PRINTED))["theta_rad"]],
    "elbow_singularity_theta3_deg": [180 - degrees(BEND), -degrees(BEND)],
    "reach": {
        "max_flange_distance_from_axis1_m": LONGEST + D[5],
        "max_wrist_distance_from_axis1_m": LONGEST,
        "max_flange_height_m": D[0] + A[1] + FOREARM + D[5],
    },
}, indent=1))
