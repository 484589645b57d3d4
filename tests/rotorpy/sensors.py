"""The controllers' measured state: the vehicle's own, or with noise and delay.

White noise from a fixed seed, the same for every controller:

- gyro, position: normal, each axis on its own;
- attitude: turned about a body-fixed vector whose components are normal;
- accelerometer: f = R' ((v - v of the last tick) / T + g e3), its mean over the tick, plus normal noise on each axis;
- velocity: exact, or from the noisy positions x by an alpha-beta filter with a double pole p = exp(-bandwidth T):

      x^ += T v^ + T^2/2 a,  v^ += T a,  then with r = x - x^:  x^ += alpha r,  v^ += beta r / T,
      alpha = 1 - p^2,  beta = (1 - p)^2

  with a = 0, as where poses are all there is, or, with an accelerometer (an observer), a = R_m f - g e3, R_m the noisy attitude.

Everything then arrives a whole number of ticks late; before that, what was measured first.
"""

import collections
import dataclasses

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle import GRAVITY


@dataclasses.dataclass(frozen=True)
class Noise:
    gyro: float  # rad/s
    position: float  # m
    attitude: float  # rad
    bandwidth: float | None  # rad/s, of the velocity filter; None: exact velocity
    delay: float  # s
    accelerometer: float | None = None  # m/s^2; None: the filter has none
    seed: int = 1


class AlphaBeta:
    """Velocity from positions."""

    def __init__(self, bandwidth, period):
        pole = np.exp(-bandwidth * period)
        self.period, self.alpha, self.beta = period, 1.0 - pole**2, (1.0 - pole) ** 2
        self.position = None
        self.velocity = np.zeros(3)

    def update(self, measured, acceleration=np.zeros(3)):
        if self.position is None:
            self.position = measured.copy()
            return self.velocity
        predicted = self.position + self.period * self.velocity + self.period**2 / 2 * acceleration
        innovation = measured - predicted
        self.position = predicted + self.alpha * innovation
        self.velocity = self.velocity + self.period * acceleration + self.beta / self.period * innovation
        return self.velocity


class Delay:
    """Gives back what came in `ticks` calls ago; until then, what came first."""

    def __init__(self, ticks):
        self.waiting = collections.deque(maxlen=ticks + 1)

    def pass_through(self, value):
        self.waiting.append(value)
        return self.waiting[0]


def turned(quaternion, vector):
    """The attitude x y z w turned by a rotation vector in body axes, rad."""
    angle = np.linalg.norm(vector)
    sine = np.sinc(angle / (2 * np.pi)) / 2  # sin(angle / 2) / angle
    imaginary, real = sine * vector, np.cos(angle / 2)
    return np.append(
        quaternion[3] * imaginary + real * quaternion[:3] + np.cross(quaternion[:3], imaginary),
        quaternion[3] * real - quaternion[:3] @ imaginary,
    )


class Sensors:
    """For one flight. Without noise the state passes as it is."""

    def __init__(self, noise, period):
        self.noise = noise
        if noise is not None:
            ticks = round(noise.delay / period)
            assert abs(ticks * period - noise.delay) < 1e-9, "the delay must be a whole number of control periods"
            self.delay = Delay(ticks)
            self.filter = noise.bandwidth and AlphaBeta(noise.bandwidth, period)
            self.random = np.random.default_rng(noise.seed)
            self.period, self.true_velocity = period, None

    def measure(self, state):
        if self.noise is None:
            return state
        gyro, position, attitude = (self.random.normal(0.0, sd, 3)
                                    for sd in (self.noise.gyro, self.noise.position, self.noise.attitude))
        measured = {"x": state["x"] + position, "q": turned(state["q"], attitude), "w": state["w"] + gyro}
        measured["v"] = state["v"]
        if self.filter:
            measured["v"] = self.filter.update(measured["x"], self.acceleration(state, measured["q"]))
        return self.delay.pass_through(measured)

    def acceleration(self, state, attitude):
        """What the filter takes for the vehicle's acceleration since the last tick, m/s^2, world."""
        before, self.true_velocity = self.true_velocity, state["v"].copy()
        if self.noise.accelerometer is None or before is None:
            return np.zeros(3)
        gravity = np.array([0.0, 0.0, GRAVITY])
        felt = Rotation.from_quat(state["q"]).inv().apply((state["v"] - before) / self.period + gravity)
        sample = felt + self.random.normal(0.0, self.noise.accelerometer, 3)
        return Rotation.from_quat(attitude).apply(sample) - gravity
