"""Makes serial.json: pose, Jacobian and dynamics of the IRB 7600 in the configuration of the thesis' table 1.

    python3 serial.py > serial.json        (mpmath 1.3)

From the energies: M by the Jacobians of the mass centres, C by Christoffel's symbols, G by the heights, in 50 digits.
"""

from arm import CENTRES, GRAVITY, INERTIAS, MASSES, coriolis_matrix, exact, frames, gravity, jacobians, mass_matrix, numbers
from mpmath import eigsy, matrix, mp, radians, svd_r
from rows import written

TABLE_1 = (45, 30, 30, -45, 30, 0)
RATES, ACCELERATIONS = (0.3, -0.2, 0.4, -0.5, 0.6, -0.7), (0.1, 0.2, -0.3, 0.4, -0.5, 0.6)

q = [radians(angle) for angle in TABLE_1]
qd, qdd = (matrix([exact(x) for x in rates]) for rates in (RATES, ACCELERATIONS))
origin, axes = frames(q)[6]
linear, angular = jacobians(q, origin, 6)
jacobian = mp.zeros(6, 6)
jacobian[:3, :], jacobian[3:, :] = linear, angular
m, c, g = mass_matrix(q), coriolis_matrix(q, qd), gravity(q)

print(written({
    "dynamics_table1": {
        "gravity_m_s2": float(GRAVITY),
        "link_mass_kg": MASSES,
        "link_com_in_link_frame_m": CENTRES,
        "link_inertia_Ixx_Ixy_Ixz_Iyy_Iyz_Izz_kg_m2": INERTIAS,
        "q_deg": [float(angle) for angle in TABLE_1],
        "qd_rad_s": RATES,
        "qdd_rad_s2": ACCELERATIONS,
        "M_kg_m2": numbers(m),
        "M_eigenvalues": numbers(eigsy(m, eigvals_only=True)),
        "C_christoffel": numbers(c),
        "coriolis_vector_N_m": numbers(c * qd),
        "gravity_vector_N_m": numbers(g),
        "tau_N_m": numbers(m * qdd + c * qd + g),
    },
    "fk_table1": {
        "theta_deg": [float(angle) for angle in TABLE_1],
        "P_m": numbers(origin),
        "R": numbers(axes),
        "wrist_centre_m": numbers(frames(q)[4][0]),
    },
    "jacobian_table1": {
        "J": numbers(jacobian),
        "rows": "vx,vy,vz,wx,wy,wz in base frame; columns joints 1..6; point = frame-6 origin",
        "det": float(mp.det(jacobian)),
        "singular_values": numbers(svd_r(jacobian, compute_uv=False)),
    },
}))
