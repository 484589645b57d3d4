"""Two tasks to learn, registered with Gymnasium, where that is installed, as `import saturated_hybrid` finds it:

    saturated_hybrid/Hover-v0    fly to a point and stay there, from up to 2 m away, tilted, in motion
    saturated_hybrid/Gate-v0     fly through an opening of 1 m by 1 m in a wall, and on to a point behind it

`gymnasium.make(id, …)` is one vehicle, `gymnasium.make_vec(id, num_envs, …)` rows. Both take a `scenario`, whose
reference is replaced (left out: the built-in Hummingbird), and what `Environment` takes but `start`. `estimated=True`
flies on the boards' estimator, with an IMU and late poses, in place of the scenario's own `[sensors]`; a dictionary of
keys of `[estimator]` chooses them. An episode is judged by the true states. Actions are accelerations forwards, to the
left and up, and a yaw rate, in [-1, 1], unless an argument says otherwise.

    observation (22,)   target - position, m | velocity, m/s | rotation, row by row | body rates, rad/s | the last action
                        the first three from the heading: forwards, to the left, up; what `saturated_hybrid.Network`
                        sees
    terminated          on the ground or beyond it, out of the room, at the wall, or back through the opening

The target is the point; of the gate its middle, until the vehicle is through. `shield=HoverRows.box` or `GateRows.box`
keeps vehicles in what their task leaves them: of the gate a box on either side of the wall, and one through the
opening.
"""

import numpy as np

from . import _core
from .actions import turned
from .environment import Environment, VectorEnvironment
from .textbook import rotations

# The box that an episode is in, m: a crash, below 0, or lost.
LOW, HIGH = np.array([-5.0, -4.0, 0.0]), np.array([5.0, 4.0, 5.0])
# Where to stay, m.
POINT = np.array([0.0, 0.0, 1.5])
# Episodes start within these of their middle, uniformly: m, m/s, rad.
AWAY, SPEED, TILT, YAW = np.array([1.5, 1.5, 0.7]), 0.5, 0.5, np.pi
DURATION = 5.0  # s

# The wall stands at x = 0; its opening's middle, m, and half its width and height, m.
GATE, HALF = np.array([0.0, 0.0, 1.5]), 0.5
BEHIND = np.array([2.0, 0.0, 1.5])
BEFORE = np.array([-2.5, 0.0, 1.5])

# How far a shield's boxes end before the room's walls, before the wall and the opening's rim, and how far the box
# through the opening reaches on either side, m.
INSIDE, CLEAR, REACH = np.array([0.2, 0.2, 0.2]), 0.1, 2.0
# The floor is the ground.
FLOOR = 0.3


def boxes(*corners):
    """What `shield` takes, for boxes from corner to corner."""
    low, high = (np.array(each, float).tolist() for each in zip(*corners))
    return {"low": low, "high": high}


def _box_and_wall():
    low, high = np.append((LOW + INSIDE)[:2], FLOOR), HIGH - INSIDE
    before, behind = high.copy(), low.copy()
    before[0], behind[0] = GATE[0] - CLEAR, GATE[0] + CLEAR
    through = np.array([REACH, HALF - CLEAR, HALF - CLEAR])
    return boxes((low, high)), boxes((low, before), (GATE - through, GATE + through), (behind, high))


ROOM, ROOMS = _box_and_wall()


def scenario_of(scenario, point, estimated=False):
    """The scenario with rest at `point` as its reference, for one episode; on the estimator, if so."""
    scenario = _core.Scenario.built_in("hummingbird") if scenario is None else scenario
    changes = {"reference": {"kind": "hover", "position": list(point)}, "duration": DURATION}
    if estimated:
        changes |= {"sensors": None, "estimator": {} if estimated is True else dict(estimated)}
    return scenario.edited(changes | {"initial": {"position": list(point)}})


def seen(rows, headings, target, last):
    """The 22 numbers of an observation, for rows (..., 32), headings (..., 2), a target (..., 3) and the last action
    (..., 4)."""
    rows, headings = np.asarray(rows, float), np.asarray(headings, float)
    # Five vectors in the last axis but one: towards the target, the velocity, and the axes of the body.
    vectors = np.empty((*rows.shape[:-1], 5, 3))
    vectors[..., 0, :], vectors[..., 1, :] = target - rows[..., :3], rows[..., 3:6]
    vectors[..., 2:, :] = np.swapaxes(rotations(rows[..., 6:10]), -1, -2)
    here = turned(vectors, headings[..., None, :], -1.0)
    rotation = np.swapaxes(here[..., 2:, :], -1, -2).reshape(*rows.shape[:-1], 9)
    return np.concatenate([here[..., 0, :], here[..., 1, :], rotation, rows[..., 10:13], last], axis=-1)


class _Hover:
    """Stay at a point."""

    point, middle, box = POINT, POINT, ROOM

    def __init__(self, scenario=None, *rows, action="forward", scaled=True, estimated=False, **options):
        self._last = np.zeros(4)
        super().__init__(scenario_of(scenario, self.point, estimated), *rows, action=action, scaled=scaled, **options)

    def target(self, rows):
        """Where to fly to, m."""
        return self.point

    def observation(self, rows):
        """Where the target is, seen from the vehicle, and how the vehicle moves: the 22 numbers that the module
        lists."""
        return seen(rows, self.headings, self.target(rows), self._last)

    def begun(self, rows, chosen):
        """Nothing was done yet."""
        self._last = np.where(np.asarray(chosen)[..., None], 0.0, self._last)

    def moved(self, rows, actions):
        """Keeps the last action; zeros in place of NaN."""
        self._last = np.where(np.isfinite(actions).all(axis=-1, keepdims=True), np.clip(actions, -1.0, 1.0), 0.0)

    def reward(self, rows, actions):
        """One at rest at the target, less with distance, speed, turning and effort; -10 for a crash."""
        away = np.linalg.norm(self.target(rows) - rows[..., :3], axis=-1)
        speed, rates = np.linalg.norm(rows[..., 3:6], axis=-1), np.linalg.norm(rows[..., 10:13], axis=-1)
        effort = np.mean(np.square(np.clip(np.nan_to_num(actions, nan=1.0), -1.0, 1.0)), axis=-1)
        earned = np.exp(-away) - 0.03 * speed - 0.02 * rates - 0.1 * effort
        return np.where(self.terminated(rows), -10.0, earned.astype(float))

    def terminated(self, rows):
        """A crash: on the ground, or out of the box."""
        return ~np.all((rows[..., :3] > LOW) & (rows[..., :3] < HIGH), axis=-1)

    def drawn(self, random):
        """About the middle of where episodes start, tilted, facing anywhere, in motion."""
        tilt, direction, yaw = random.uniform(0.0, TILT), random.uniform(-np.pi, np.pi), random.uniform(-YAW, YAW)
        euler = [tilt * np.cos(direction), tilt * np.sin(direction), yaw]
        position = self.middle + AWAY * random.uniform(-1.0, 1.0, 3)
        return _core.state(position, SPEED * random.uniform(-1.0, 1.0, 3), euler=euler)


class _Gate(_Hover):
    """Through a gate to a point behind it."""

    point, middle, box = BEHIND, BEFORE, ROOMS

    def begun(self, rows, chosen):
        """None is through who has just begun."""
        super().begun(rows, chosen)
        if not hasattr(self, "through"):
            self.through, self.hit, self.back, self._before = False, False, False, 0.0
        self.through, self.hit, self.back = self.through & ~chosen, self.hit & ~chosen, self.back & ~chosen
        self._before = np.where(chosen, rows[..., 0], self._before)

    def moved(self, rows, actions):
        """Who crosses the wall is through or has hit it; who was through may not come back."""
        super().moved(rows, actions)
        crossed = (self._before < GATE[0]) & (rows[..., 0] >= GATE[0])
        inside = np.all(np.abs(rows[..., 1:3] - GATE[1:]) < HALF, axis=-1)
        self.back = self.back | (self.through & (rows[..., 0] < GATE[0]))
        self.hit = self.hit | (crossed & ~inside)
        self.through = self.through | (crossed & inside)
        self._before = np.array(rows[..., 0])

    def target(self, rows):
        """The gate's middle, then the point."""
        return np.where(np.asarray(self.through)[..., None], BEHIND, GATE + [0.3, 0.0, 0.0])

    def terminated(self, rows):
        """A crash, at the wall beside the opening, or back before it."""
        return super().terminated(rows) | self.hit | self.back

    def reward(self, rows, actions):
        """As for staying at a point, and one more for every step behind the gate."""
        return super().reward(rows, actions) + self.through

    def things(self):
        """The opening's rim."""
        y, z = HALF * np.array([-1.0, 1.0, 1.0, -1.0, -1.0]), HALF * np.array([-1.0, -1.0, 1.0, 1.0, -1.0])
        return [GATE + np.stack([np.zeros(5), y, z], axis=1)]


class Hover(_Hover, Environment):
    """One vehicle that is to stay at a point."""


class HoverRows(_Hover, VectorEnvironment):
    """Rows of vehicles, each to stay at a point."""


class Gate(_Gate, Environment):
    """One vehicle that is to fly through a gate."""


class GateRows(_Gate, VectorEnvironment):
    """Rows of vehicles, each to fly through a gate."""
