"""A geometric attitude controller as textbooks have it: what flies an agent's demands without the shield.

After T. Lee, M. Leok, N. H. McClamroch, Geometric tracking control of a quadrotor UAV on SE(3), 2010. With J the
inertia, R_d the wanted attitude, omega_d the wanted rates in the body's axes,

    e_R = (R_d^T R - R^T R_d)^v / 2,    e_omega = omega - omega_d
    torque = -J (w^2 e_R + 2 zeta w e_omega) + omega x J omega

`w` is as fast as rotor lag and control period allow, and half that about yaw, where rotors are weak. A wanted
acceleration a is the force m (a + g e3): its direction is the thrust axis, its part along the present one the thrust.
Nothing is limited, estimated or
proven: the rotors clip what they cannot do.
"""

import numpy as np

# Bandwidth times the time that passes until a command acts.
SHARE = 0.3
FASTEST = 20.0  # rad/s
DAMPING = 0.8
YAW_SHARE = 0.5


class Textbook:
    """Rows of it.

    Args:
        scenario: mass, inertia, gravity, rotor lag and period.
        rows: how many.
    """

    def __init__(self, scenario, rows):
        self.mass, self.gravity, self.period = scenario.mass, scenario.gravity, scenario.period
        self.inertia = np.asarray(scenario.inertia, float)
        lag = scenario.rotors["lag"] if scenario.rotors is not None else 0.0
        self.bandwidth = min(FASTEST, SHARE / (lag + self.period)) * np.array([1.0, 1.0, YAW_SHARE])
        self.yaw = np.full(rows, np.nan)

    def reset(self, chosen=None):
        """Begins anew in the rows that are chosen, (rows,) bool: the yaw that is wanted is the one that is there."""
        self.yaw[slice(None) if chosen is None else chosen] = np.nan

    def step(self, states, demands):
        """Wrenches (rows, 4) for states (rows, 13) and demands: (rows, 4) acceleration, m/s^2 world, and yaw rate,
        rad/s; or (rows, 5) quaternion, scalar first, and thrust, N."""
        demands = np.asarray(demands, float)
        states = np.asarray(states, float)
        attitude, rates = rotations(states[:, 6:10]), states[:, 10:13]
        if demands.shape[1] == 4:
            force = self.mass * (demands[:, :3] + [0.0, 0.0, self.gravity])
            yaw = np.where(np.isnan(self.yaw), np.arctan2(attitude[:, 1, 0], attitude[:, 0, 0]), self.yaw)
            self.yaw = yaw + self.period * demands[:, 3]
            wanted = attitudes(force, yaw)
            wanted_rates = attitude.transpose(0, 2, 1) @ (np.array([0.0, 0.0, 1.0]) * demands[:, 3:])[:, :, None]
            wanted_rates = wanted_rates[:, :, 0]
            thrust = np.sum(force * attitude[:, :, 2], axis=1)
        else:
            wanted, wanted_rates, thrust = rotations(demands[:, :4]), 0.0, demands[:, 4]
        error = wanted.transpose(0, 2, 1) @ attitude
        error = 0.5 * (error - error.transpose(0, 2, 1))
        error = np.stack([error[:, 2, 1], error[:, 0, 2], error[:, 1, 0]], axis=1)
        feedback = self.bandwidth**2 * error + 2.0 * DAMPING * self.bandwidth * (rates - wanted_rates)
        torque = -self.inertia * feedback + np.cross(rates, self.inertia * rates)
        return np.concatenate([np.maximum(thrust, 0.0)[:, None], torque], axis=1)


def rotations(quaternions):
    """Rotation matrices (..., 3, 3), body to world, of quaternions (..., 4), scalar first, of any length but zero."""
    quaternions = np.asarray(quaternions, float)
    unit = quaternions / np.sqrt(np.square(quaternions).sum(axis=-1, keepdims=True))
    w, x, y, z = (unit[..., place] for place in range(4))
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrices = np.empty((*unit.shape[:-1], 3, 3))
    for number, row in enumerate(rows):
        for place, value in enumerate(row):
            matrices[..., number, place] = value
    return matrices


def attitudes(forces, yaw):
    """Attitudes (n, 3, 3) whose thrust axis lies along the forces (n, 3) and that face `yaw` (n,), rad."""
    third = forces / np.maximum(np.linalg.norm(forces, axis=1, keepdims=True), 1e-9)
    facing = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    second = np.cross(third, facing)
    second /= np.maximum(np.linalg.norm(second, axis=1, keepdims=True), 1e-9)
    return np.stack([np.cross(second, third), second, third], axis=2)
