"""What an action of an environment is, and who makes a wrench of it.

    action          columns                                              scaled: zero is     one is
    "wrench"        thrust, N; torque about the body axes, N m           hovering thrust     the scenario's limits
    "acceleration"  (3) of the vehicle, world, m/s^2; yaw rate, rad/s    to stay             half of gravity; 2 rad/s
    "forward"       the same, forwards, to the left and up               to stay             the same
    "attitude"      thrust, N; roll, pitch, yaw, rad                     level, facing x,    the scenario's limit;
                                                                         hovering thrust     45, 45, 180 degrees

Forwards is where the heading points, level: the shield's, which turns as demanded, or else the vehicle's own. A wrench
goes to the rotors as it is. The others are demands: the shield flies them (`ShieldRows`, whose limits are proven), or a
textbook attitude controller (`Textbook`, of which nothing is).
"""

from dataclasses import dataclass
from typing import Any, Callable

import numpy as np

from . import _core
from .textbook import Textbook

# The share of gravity, and of the rotors' thrust above it, that an acceleration may take; and a yaw rate, rad/s.
SHARE = 0.5
SHARE_OF_CLIMB = 0.8
YAW_RATE = 2.0
# Of an attitude, rad.
TILT = np.pi / 4


@dataclass(frozen=True)
class Kind:
    """A kind of action: bounds and middle of each column, and the demand that it makes of them and of headings (rows,
    2)."""

    low: Any
    middle: Any
    high: Any
    demand: Callable

    def unscaled(self, actions):
        """Columns in their units, of actions in [-1, 1]; what is beyond that is cut."""
        actions = np.clip(np.asarray(actions, float), -1.0, 1.0)
        return self.middle + actions * np.where(actions > 0.0, self.high - self.middle, self.middle - self.low)


def quaternions(roll, pitch, yaw):
    """R = Rz(yaw) Ry(pitch) Rx(roll) as quaternions, scalar first, in the last axis."""
    (cr, sr), (cp, sp), (cy, sy) = [(np.cos(0.5 * angle), np.sin(0.5 * angle)) for angle in (roll, pitch, yaw)]
    each = [
        cy * cp * cr + sy * sp * sr,
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
    ]
    return np.stack(each, axis=-1)


def as_it_is(columns, headings):
    """The demand of columns that are one."""
    return columns


def of_forward(columns, headings):
    """The demand of an acceleration seen from the heading."""
    return np.concatenate([turned(columns[:, :3], headings), columns[:, 3:]], axis=1)


def of_attitude(columns, headings):
    """The demand of a thrust and of roll, pitch and yaw."""
    return np.concatenate([quaternions(*np.moveaxis(columns[..., 1:], -1, 0)), columns[..., :1]], axis=-1)


def kinds(scenario):
    """The kinds of action, for a scenario's vehicle, by their names."""
    mass, gravity, greatest = scenario.mass, scenario.gravity, scenario.thrust_max
    torque = np.asarray(scenario.torque_max, float)
    hover = [mass * gravity, 0.0, 0.0, 0.0]
    climb = min(SHARE * gravity, SHARE_OF_CLIMB * (greatest / mass - gravity))
    across = SHARE * gravity
    accelerations = [-across, -across, -climb, -YAW_RATE], np.zeros(4), [across, across, climb, YAW_RATE]

    def kind(low, middle, high, demand=as_it_is):
        return Kind(*(np.array(each, float) for each in (low, middle, high)), demand)

    return {
        "wrench": kind([0.0, *-torque], hover, [greatest, *torque]),
        "acceleration": kind(*accelerations),
        "forward": kind(*accelerations, of_forward),
        "attitude": kind([0.0, -TILT, -TILT, -np.pi], hover, [greatest, TILT, TILT, np.pi], of_attitude),
    }


def turned(vectors, headings, sign=1.0):
    """Vectors (..., 3) from the frames of headings (..., 2), unit vectors, to the world; with -1 the other way."""
    vectors, headings = np.asarray(vectors, float), np.asarray(headings, float)
    x, y, cos, sin = vectors[..., 0], vectors[..., 1], headings[..., 0], sign * headings[..., 1]
    along = np.asarray(cos * x - sin * y)
    turned = np.empty((*along.shape, 3))
    turned[..., 0], turned[..., 1], turned[..., 2] = along, sin * x + cos * y, vectors[..., 2]
    return turned


def facing(states):
    """Where vehicles face, level: unit vectors (rows, 2), of states (rows, 13). Along x where they face up or down."""
    w, x, y, z = states[:, 6:10].T
    ahead = np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)], axis=1)
    length = np.linalg.norm(ahead, axis=1, keepdims=True)
    return np.where(length > 1e-3, ahead / np.maximum(length, 1e-3), [1.0, 0.0])


class Direct:
    """Wrenches as they are."""

    by_policy, reasons = None, None

    def headings(self, states):
        """Where "forward" is."""
        return facing(states)

    def step(self, vehicles, demands):
        return demands

    def reset(self, chosen):
        pass

    def end(self, clipped):
        pass


class Unshielded(Direct):
    """Demands through the textbook controller; the rotors clip what they cannot do."""

    def __init__(self, scenario, rows):
        self.controller = Textbook(scenario, rows)

    def step(self, vehicles, demands):
        return self.controller.step(vehicles.measured, demands)

    def reset(self, chosen):
        self.controller.reset(chosen)


class Shielded(Direct):
    """Demands through the shield, which keeps every row inside a box."""

    def __init__(self, scenario, rows, settings):
        self.shield = _core.ShieldRows(scenario, rows, **settings)
        self.fresh = np.ones(rows, bool)

    def headings(self, states):
        headings = self.shield.references[:, 15:17].astype(float)
        return np.where(self.fresh[:, None], facing(states), headings) if self.fresh.any() else headings

    def step(self, vehicles, demands):
        self.fresh[:] = False
        jumped = vehicles.jumped
        if jumped.any():
            self.shield.hold_estimates(jumped.tolist())
        wrenches = self.shield.step(vehicles.measured, demands, vehicles.accelerations)
        return self.shield.for_rotors(wrenches)

    def reset(self, chosen):
        self.shield.reset(chosen.tolist())
        self.fresh |= chosen

    def end(self, clipped):
        if clipped.any():
            self.shield.hold_estimates(clipped.tolist())

    @property
    def by_policy(self):
        return np.asarray(self.shield.by_policy)

    @property
    def reasons(self):
        return list(self.shield.reasons)
