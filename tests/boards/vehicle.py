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
from hands import Hands, Quaternion, product
from schedule import NS_PER_MS
from sensors.inertial import GRAVITY

# Poses: their rate, how late they are, and their noise.
POSE_PERIOD_NS, POSE_DELAY_NS, POSE_NOISE_M = 10 * NS_PER_MS, 5 * NS_PER_MS, 0.0005
START = (1.0, 0.0, 0.0)
_HALF = math.sqrt(0.5)


def to_ned(attitude: Quaternion) -> Quaternion:
    """Body to world, of ours, as of forward-right-down to north-east-down."""
    return product(product((0.0, _HALF, _HALF, 0.0), attitude), (0.0, -1.0, 0.0, 0.0))


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
        self.position, self.velocity = START, (0.0, 0.0, 0.0)
        self.attitude: Quaternion = (1.0, 0.0, 0.0, 0.0)
        self.last_driven_ns = 0
        # Whether the vehicle moves at all: at first it waits for its board.
        self.is_free = False
        # Of a person who holds it.
        self.hands: Hands | None = None
        self._rate, self._force = (0.0, 0.0, 0.0), (0.0, 0.0, GRAVITY)
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
        self.is_free |= any(commands)
        if self.hands is not None:
            self.hands.pass_step()
        if self.is_free:
            self._move(commands)
        if self.is_free or self.hands is not None:
            held = (self._rate, self._force) if self.hands is None else self.hands.felt(self._rate, self._force)
            board.motion.feel(*held)

    def _move(self, commands: list[float]) -> None:
        board = self.board
        # A controller holds the speed of its command; thrust is its square.
        self.body.step([most * command * command for most, command in zip(self.thrust_max, commands)])
        state = self.body.state.tolist()
        self.position, self.velocity, self.attitude = tuple(state[0:3]), tuple(state[3:6]), tuple(state[6:10])
        self._rate, self._force = tuple(state[10:13]), tuple(self.body.specific_force.tolist())
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
        position, attitude = self.position, self.attitude
        if self.hands is not None:
            position, attitude = self.hands.seen(position, attitude)
        east, north, up = (value + self._draw.gauss(0.0, POSE_NOISE_M) for value in position)
        return (north, east, -up), to_ned(attitude)
