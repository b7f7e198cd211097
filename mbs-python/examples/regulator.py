"""A cart with a pole: linearized upright, held there by a regulator, followed through pushes; all in NumPy."""

import pathlib

import mbs
import numpy as np

MODEL = pathlib.Path(__file__).resolve().parents[2] / "models" / "mechanisms" / "cart_pole.mbs"


def regulator(a, b, q, r):
    """The gain of the linear-quadratic regulator, from the stable subspace of the Hamiltonian matrix.

    Laub, A Schur Method for Solving Algebraic Riccati Equations, 1979; by eigenvectors here."""
    weighted = b @ np.linalg.solve(r, b.T)
    values, vectors = np.linalg.eig(np.block([[a, -weighted], [-q, -a.T]]))
    stable = vectors[:, values.real < 0]
    n = len(a)
    return np.linalg.solve(r, b.T @ np.linalg.solve(stable[:n].T, stable[n:].T).T.real)


def main():
    cart = mbs.compile(MODEL)
    pole = cart.coordinates.index("theta")
    # Where the pole is upright depends on what its angle is measured from: there the potential energy is greatest.
    angles = np.linspace(0, 2 * np.pi, 5)[:4]
    upright = np.zeros(cart.dof)
    states = np.tile(upright, (4, 1))
    states[:, pole] = angles
    upright[pole] = angles[np.argmax(cart.potential_energy(states))]
    rest, none = np.zeros(cart.dof), np.zeros(len(cart.inputs))
    a, b = cart.state_space(upright, rest, none)
    assert np.linalg.eigvals(a).real.max() > 1.0
    gain = regulator(a, b, np.eye(2 * cart.dof), 0.1 * np.eye(len(none)))
    assert np.linalg.eigvals(a - b @ gain).real.max() < 0

    def control(t, q, qd):
        return -gain @ np.concatenate([q - upright, qd])

    start = upright.copy()
    start[pole] += 0.2
    motion = cart.simulate(start, rest, t=12.0, u=control, times=np.linspace(0, 12, 121), rtol=1e-8)
    assert np.abs(motion.end[1] - upright).max() < 1e-2, motion.end
    free = cart.simulate(
        start, rest, t=3.0, events=[mbs.Event(lambda t, q, qd: abs(q[pole] - upright[pole]) - np.pi / 2, terminal=True)]
    )
    assert free.stopped
    print(
        f"without control the pole falls to the side in {free.end[0]:.3f} s; held, it is upright to "
        f"{np.abs(motion.end[1] - upright).max():.1e} after 12 s, with at most {np.abs(motion['x']).max():.3f} m of the cart"
    )


if __name__ == "__main__":
    main()
