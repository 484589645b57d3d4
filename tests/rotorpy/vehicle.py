"""The vehicle: RotorPy's Multirotor with its Hummingbird, and what a flight changes about it.

Rotor drag, frame drag, translational lift and the motors' lag of 5 ms are RotorPy's. It is integrated as RotorPy does, by
scipy's RK45 (Dormand and Prince, fifth order), but with a fixed step. SI units; world z up, body x forward, y left.
"""

import dataclasses

import numpy as np
from rotorpy.vehicles.hummingbird_params import quad_params as PARAMETERS
from rotorpy.vehicles.multirotor import Multirotor
from rotorpy.wind.default_winds import ConstantWind, NoWind

GRAVITY = 9.81


@dataclasses.dataclass(frozen=True)
class Conditions:
    """How the vehicle differs from its controller's model, and the air around it."""

    drag: bool = True
    lag: bool = True
    wind: tuple = (0.0, 0.0, 0.0)  # m/s, world
    acceleration: tuple = (0.0, 0.0, 0.0)  # m/s^2, world: a force on the centre of mass over the nominal mass
    rotor_thrust: tuple = (1.0, 1.0, 1.0, 1.0)  # thrust and drag torque of each rotor over those commanded
    mass: float = 1.0  # over the nominal one; the inertia stays
    centre_of_mass: tuple = (0.0, 0.0, 0.0)  # m, body, from the middle of the rotors


@dataclasses.dataclass(frozen=True)
class Start:
    """Not turning, the rotors at the speeds that hover."""

    position: tuple = (0.0, 0.0, 0.0)  # m
    velocity: tuple = (0.0, 0.0, 0.0)  # m/s, world
    roll: float = 0.0  # degrees
    yaw: float = 0.0  # degrees; R = Rz(yaw) Rx(roll)

    def quaternion(self):
        """x y z w. Half a turn is exact: its cosine is zero and not what rounding leaves of it."""
        half_roll, half_yaw = np.radians(self.roll) / 2, np.radians(self.yaw) / 2
        sine, cosine = np.sin(half_roll), (0.0 if abs(self.roll) == 180 else np.cos(half_roll))
        return np.array([
            np.cos(half_yaw) * sine, np.sin(half_yaw) * sine, np.sin(half_yaw) * cosine, np.cos(half_yaw) * cosine
        ])


class Vehicle:
    def __init__(self, conditions, start, step):
        parameters = dict(PARAMETERS)
        shift = np.asarray(conditions.centre_of_mass)
        parameters["rotor_pos"] = {name: place - shift for name, place in PARAMETERS["rotor_pos"].items()}
        parameters["mass"] = conditions.mass * PARAMETERS["mass"]
        # Tolerances that no error exceeds: every step is `max_step` long.
        fixed = {"method": "RK45", "first_step": step, "max_step": step, "rtol": 1.0, "atol": 1e12}
        self.body = Multirotor(parameters, aero=conditions.drag, integrator_kwargs=fixed)
        # RotorPy's weight is the constant force in the world frame.
        self.body.weight = self.body.weight + PARAMETERS["mass"] * np.asarray(conditions.acceleration)
        self.lag = conditions.lag
        self.wind = ConstantWind(*conditions.wind) if any(conditions.wind) else NoWind()
        # A rotor of s times the thrust and drag torque is one that turns sqrt(s) times as fast.
        self.speed_ratio = np.sqrt(conditions.rotor_thrust)
        hover = np.sqrt(PARAMETERS["mass"] * GRAVITY / 4 / PARAMETERS["k_eta"])
        self.state = {
            "x": np.array(start.position, float),
            "v": np.array(start.velocity, float),
            "q": start.quaternion(),
            "w": np.zeros(3),
            "wind": np.zeros(3),
            "rotor_speeds": hover * self.speed_ratio,
        }

    def hold(self, speeds, time, duration):
        """Moves on for `duration` s with the rotors commanded to these speeds, rad/s, within their range."""
        commanded = speeds * self.speed_ratio
        self.state["wind"] = np.asarray(self.wind.update(time, self.state["x"]), float)
        if not self.lag:
            # At the commanded speed already: RotorPy's lag has nothing left to do.
            self.state["rotor_speeds"] = np.clip(commanded, self.body.rotor_speed_min, self.body.rotor_speed_max)
        self.state = self.body.step(self.state, {"cmd_motor_speeds": commanded}, duration)
