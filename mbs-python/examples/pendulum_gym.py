"""Swinging up a pendulum as an environment of gymnasium.

The environment's step is five steps of Runge and Kutta's method on compiled forward dynamics. Reward and limits are those
of gymnasium's own `Pendulum-v1`: an angle of zero is straight up.
"""
# needs: gymnasium

import gymnasium
import mbs
import numpy as np

TEXT = """
/// A uniform rod, hinged at one end.
mechanism Rod {
    param m: kg = 1; param l: m = 1; param g: m/s^2 = 10;
    coord theta: rad; input tau: N*m;
    kinetic += 1/2 * m*l^2/3 * dt(theta)^2;
    potential += m*g*l/2*cos(theta);
    force theta += tau;
}
"""


class SwingUp(gymnasium.Env):
    """Observation: cosine, sine, rate; action: torque within 2 N m."""

    observation_space = gymnasium.spaces.Box(
        -np.array([1.0, 1.0, 8.0], np.float32), np.array([1.0, 1.0, 8.0], np.float32)
    )
    action_space = gymnasium.spaces.Box(-2.0, 2.0, (1,), np.float32)
    dt, substeps = 0.05, 5

    def __init__(self, **params):
        self.rod = mbs.compile(TEXT, params=params)
        self.q, self.qd = np.zeros(1), np.zeros(1)

    def observation(self):
        (angle,), (rate,) = self.q, self.qd
        return np.array([np.cos(angle), np.sin(angle), rate], np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.q, self.qd = self.np_random.uniform([-np.pi], [np.pi]), self.np_random.uniform([-1.0], [1.0])
        return self.observation(), {}

    def step(self, action):
        u = np.clip(np.asarray(action, float), -2.0, 2.0)
        angle = (self.q[0] + np.pi) % (2 * np.pi) - np.pi
        reward = -(angle**2 + 0.1 * self.qd[0] ** 2 + 0.001 * u[0] ** 2)
        h, f = self.dt / self.substeps, self.rod.forward_dynamics
        for _ in range(self.substeps):
            q, v = self.q, self.qd
            a1 = f(q, v, u)
            a2 = f(q + h / 2 * v, v + h / 2 * a1, u)
            a3 = f(q + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2, u)
            a4 = f(q + h * v + h * h / 2 * a2, v + h * a3, u)
            self.q = q + h * v + h * h / 6 * (a1 + a2 + a3)
            self.qd = np.clip(v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4), -8.0, 8.0)
        return self.observation(), float(reward), False, False, {}


def pump(observation):
    """Puts energy in below, holds the rod upright near the top."""
    cosine, sine, rate = observation
    angle = np.arctan2(sine, cosine)
    energy = rate**2 / 6 + 5 * cosine  # m l²/3 = 1/3 kg m², m g l/2 = 5 N m
    torque = -20 * angle - 5 * rate if abs(angle) < 0.15 else 2 * np.sign(rate or 1.0) * np.sign(5 - energy)
    return np.clip([torque], -2, 2)


def main():
    from gymnasium.utils.env_checker import check_env

    environment = SwingUp()
    check_env(environment, skip_render_check=True)
    observation, _ = environment.reset(seed=1)
    total = 0.0
    for _ in range(400):
        observation, reward, *_ = environment.step(pump(observation))
        total += reward
    assert observation[0] > 0.99, observation
    # Without torque the energy stays.
    environment.reset(seed=2)
    energy = environment.rod.kinetic_energy(environment.q, environment.qd) + environment.rod.potential_energy(
        environment.q
    )
    for _ in range(20):
        environment.step([0.0])
    after = environment.rod.kinetic_energy(environment.q, environment.qd) + environment.rod.potential_energy(
        environment.q
    )
    assert abs(after - energy) < 1e-4 or abs(environment.qd[0]) == 8.0
    print(f"upright after 20 s, cosine {observation[0]:.4f}, return {total:.1f}")


if __name__ == "__main__":
    main()
