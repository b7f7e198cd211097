"""Forward dynamics inside torch: an `autograd.Function` with our Jacobians."""
# needs: torch

import mbs
import numpy as np
import torch

PENDULUM = mbs.compile(
    """
/// A point on a massless rod.
mechanism Pendulum {
    param m: kg = 1; param l: m = 1; param g: m/s^2 = 9.81;
    coord theta: rad; input tau: N*m;
    kinetic += 1/2*m*l^2*dt(theta)^2; potential += -m*g*l*cos(theta); force theta += tau;
}
"""
)


class Accelerations(torch.autograd.Function):
    @staticmethod
    def forward(ctx, q, qd, u):
        ctx.save_for_backward(q, qd, u)
        return torch.from_numpy(PENDULUM.forward_dynamics(*(a.detach().numpy() for a in (q, qd, u))))

    @staticmethod
    def backward(ctx, gradient):
        slopes = PENDULUM.linearize(*(a.detach().numpy() for a in ctx.saved_tensors))
        return tuple(
            torch.einsum("...i,...ij->...j", gradient, torch.from_numpy(np.ascontiguousarray(s))) for s in slopes
        )


def main():
    random = np.random.default_rng(1)
    given = [torch.tensor(a, requires_grad=True) for a in random.uniform(-1, 1, (3, 4, 1))]
    assert torch.autograd.gradcheck(Accelerations.apply, given)
    # Torques that bring the pendulum to a radian in half a second.
    torques = torch.zeros(50, 1, dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.LBFGS([torques], max_iter=50, line_search_fn="strong_wolfe")

    def cost():
        q, qd, h = torch.zeros(1, dtype=torch.float64), torch.zeros(1, dtype=torch.float64), 0.01
        for u in torques:
            qd = qd + h * Accelerations.apply(q, qd, u)
            q = q + h * qd
        return ((q - 1.0) ** 2 + 0.1 * qd**2).sum() + 1e-4 * (torques**2).mean()

    def closure():
        optimiser.zero_grad()
        value = cost()
        value.backward()
        return value

    first = cost().item()
    optimiser.step(closure)
    last = cost().item()
    assert last < 0.1 * first, (first, last)
    print(f"gradcheck passes; cost from {first:.3f} to {last:.5f}")


if __name__ == "__main__":
    main()
