"""Closes the loop: host-sim's vehicle, which the Python wheel has, turns what the controllers drive into motion, and
the motion into what the sensors feel and a motion-capture system sees.

Frames: the world's z is up, body x forward, y left, z up; MAVLink's are north-east-down and forward-right-down.
"""

import math
import pathlib
import random
import tomllib
from collections import deque

import saturated_hybrid as sh

from boards import Board
from schedule import NS_PER_MS

# Poses: their rate, how late they are, and their noise.
POSE_PERIOD_NS, POSE_DELAY_NS, POSE_NOISE_M = 10 * NS_PER_MS, 5 * NS_PER_MS, 0.0005
START = (1.0, 0.0, 0.0)
_HALF = math.sqrt(0.5)


def _product(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
    """Of two quaternions, scalar first."""
    (s, x, y, z), (t, u, v, w) = a, b
    return (s * t - x * u - y * v - z * w, s * u + x * t + y * w - z * v, s * v - x * w + y * t + z * u,
            s * w + x * v - y * u + z * t)


def to_ned(attitude: tuple[float, ...]) -> tuple[float, ...]:
    """Body to world, of ours, as of forward-right-down to north-east-down."""
    return _product(_product((0.0, _HALF, _HALF, 0.0), attitude), (0.0, -1.0, 0.0, 0.0))


class Vehicle:
    """The vehicle of a scenario's file, on the ground, with a board on it."""

    def __init__(self, board: Board, file: pathlib.Path) -> None:
        said = tomllib.loads(file.read_text())
        rotors, plant = said["rotors"], said.get("plant", {})
        scenario = sh.Scenario.load(file).edited({"ground": {}, "initial.position": list(START)})
        self.body = sh.RotorVehicle(scenario)
        self.board = board
        coefficient, fastest = rotors["thrust_coefficient"], rotors["speed"][1]
        self.thrust_max = [coefficient * fastest**2] * len(rotors["position"])
        self._coefficient = coefficient
        board.escs.speeds = self.speeds
        self._step_ns = round(plant.get("step", 0.001) * 1e9)
        assert self._step_ns == NS_PER_MS, "the sensors' filters are for a plant step of a millisecond"
        self._draw = random.Random(2)
        self.position, self.attitude, self.velocity = START, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        self.last_driven_ns = 0
        # Whether the vehicle moves at all: at first it waits for its board.
        self.is_free = False
        # Every so often: (time, position).
        self.track: list[tuple[int, tuple[float, float, float]]] = []
        # How fast the rotors turned, rad/s, of late: (time, speeds).
        self.rotor_speeds: deque[tuple[int, list[float]]] = deque(maxlen=500)
        board.schedule.after(self._step_ns, self._advance)

    def _advance(self) -> None:
        board = self.board
        board.schedule.after(self._step_ns, self._advance)
        commands = board.escs.commands()
        if not board.escs.are_still():
            self.last_driven_ns = board.schedule.now
        if not self.is_free:
            if not any(commands):
                return
            self.is_free = True
        # A controller holds the speed of its command; thrust is its square.
        self.body.step([most * command * command for most, command in zip(self.thrust_max, commands)])
        state = self.body.state.tolist()
        self.position, self.velocity, self.attitude = tuple(state[0:3]), tuple(state[3:6]), tuple(state[6:10])
        board.motion.feel(tuple(state[10:13]), tuple(self.body.specific_force.tolist()))
        self.rotor_speeds.append((board.schedule.now, self.speeds()))
        if len(self.track) * 10 * NS_PER_MS <= board.schedule.now:
            self.track.append((board.schedule.now, self.position))

    def speeds(self) -> list[float]:
        """How fast the rotors turn, rad/s."""
        if not self.is_free:
            return [0.0] * len(self.thrust_max)
        return [math.sqrt(max(0.0, thrust) / self._coefficient) for thrust in self.body.thrusts.tolist()]

    def pose(self) -> tuple[tuple[float, float, float], tuple[float, ...]]:
        """What a motion-capture system sees: position and attitude, in MAVLink's frames."""
        east, north, up = (value + self._draw.gauss(0.0, POSE_NOISE_M) for value in self.position)
        return (north, east, -up), to_ned(self.attitude)
