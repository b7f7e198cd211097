"""Forward dynamics inside jax: our Jacobians by `custom_jvp`, many states by `vmap`, and a gradient through a motion.

`jax.pure_callback` hands arrays to the compiled functions; they take leading axes, so that `vmap` is one call.
"""
# needs: jax

import jax
import jax.numpy as jnp
import mbs
import numpy as np

jax.config.update("jax_enable_x64", True)

ARM = mbs.compile("""
/// Two links in a vertical plane, driven at both joints.
mechanism Arm {
    param m[2]: kg = [2, 1]; param l[2]: m = [0.5, 0.4]; param g: m/s^2 = 9.81;
    coord q[2]: rad; input tau[2]: N*m;
    let elbow = [l[0]*sin(q[0]), 0, -l[0]*cos(q[0])];
    let hand = elbow + [l[1]*sin(q[0] + q[1]), 0, -l[1]*cos(q[0] + q[1])];
    kinetic += particle(m[0], elbow) + particle(m[1], hand);
    potential += g*(m[0]*elbow.z + m[1]*hand.z);
    for i in 0..2 { force q[i] += tau[i]; }
}
""")


def called(function, shapes, *args):
    batch = jnp.broadcast_shapes(*(a.shape[:-1] for a in args))
    kinds = [jax.ShapeDtypeStruct((*batch, *shape), jnp.float64) for shape in shapes]
    on_arrays = lambda *a: tuple(map(np.asarray, function(*map(np.asarray, a))))  # noqa: E731
    return jax.pure_callback(on_arrays, tuple(kinds), *args, vmap_method="broadcast_all")


@jax.custom_jvp
def accelerations(q, qd, u):
    """The accelerations of the arm."""
    return called(lambda *a: (ARM.forward_dynamics(*a),), [(2,)], q, qd, u)[0]


@accelerations.defjvp
def _(primals, tangents):
    by_q, by_qd, by_u = called(ARM.linearize, [(2, 2)] * 3, *primals)
    dq, dqd, du = tangents
    along = lambda slope, d: jnp.einsum("...ij,...j->...i", slope, d)  # noqa: E731
    return accelerations(*primals), along(by_q, dq) + along(by_qd, dqd) + along(by_u, du)


def end(torques, q, qd, h=0.02):
    """Where the arm is after torques, one for each step of length h, by Heun's method."""

    def step(state, u):
        q, qd = state
        a = accelerations(q, qd, u)
        b = accelerations(q + h * qd, qd + h * a, u)
        return (q + h * qd + h * h / 2 * a, qd + h / 2 * (a + b)), None

    (q, qd), _ = jax.lax.scan(step, (q, qd), torques)
    return q, qd


def main():
    random = np.random.default_rng(1)
    q, qd, u = (jnp.asarray(a) for a in random.uniform(-1, 1, (3, 2)))
    slopes = jax.jacfwd(accelerations, argnums=(0, 1, 2))(q, qd, u)
    exact = ARM.linearize(q, qd, u)
    assert all(np.allclose(a, b, rtol=1e-12) for a, b in zip(slopes, exact, strict=True))
    backward = jax.jacrev(accelerations)(q, qd, u)
    assert np.allclose(backward, exact.q, rtol=1e-12)

    many = random.uniform(-1, 1, (3, 50, 2))
    assert np.array_equal(jax.vmap(accelerations)(*many), ARM.forward_dynamics(*many))

    def cost(torques):
        q_end, qd_end = end(torques, jnp.zeros(2), jnp.zeros(2))
        return jnp.sum((q_end - jnp.array([0.6, 0.4])) ** 2) + 0.01 * jnp.sum(qd_end**2)

    torques = jnp.zeros((25, 2))
    first, gradient = jax.value_and_grad(cost)(torques)
    h, i = 1e-6, (3, 1)
    difference = (cost(torques.at[i].add(h)) - cost(torques.at[i].add(-h))) / (2 * h)
    assert abs(difference - gradient[i]) < 1e-7 * (1 + abs(difference)), (difference, gradient[i])
    value = jax.jit(jax.value_and_grad(cost))
    speed = jnp.zeros_like(torques)
    for _ in range(200):  # Polyak's heavy ball
        last, gradient = value(torques)
        speed = 0.95 * speed - 5.0 * gradient
        torques = torques + speed
    assert last < 0.01 * first, (first, last)
    print(
        f"the gradient through 25 steps agrees with differences; cost from {first:.4f} to {last:.6f} in 200 steps of descent"
    )


if __name__ == "__main__":
    main()
