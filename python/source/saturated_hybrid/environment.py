"""Environments in the manner of Gymnasium: simulated vehicles under the commands of an agent.

`VectorEnvironment` is many vehicles, `Environment` one of them: row `k` of a vector that was reset with the seed `s` is
the one environment that was reset with `s + k`. With gymnasium installed they are a `gymnasium.vector.VectorEnv` and a
`gymnasium.Env`; without it they work alone, and their spaces have only what is needed.

    observation  (32,) float32   the state's 13 columns, then the reference's 19 (see `saturated_hybrid`)
    action        (4,) float32   held for one control period: a wrench, or what `saturated_hybrid.actions` lists
    reward                       exp(-distance from the reference in m): one where it should be, 0.37 a metre off
    terminated                   further than `lost` from the reference, or no longer finite
    truncated                    the scenario's duration is over

`copy.copy` and `copy.deepcopy` give an environment that flies on, to the same bits, from where this one is. One that has
just been made or reset can be pickled; in the middle of an episode `pickle` refuses.

A subclass of either defines anything else that is in `Task`. `saturated_hybrid.tasks` has two that are registered with
Gymnasium.

The law itself is a policy: with `law = LawRows(scenario, rows)`, `law.for_rotors(law.step(observations[:, :13],
observations[:, 13:]))` are its actions; report those that were `clipped` to it:
`law.hold_estimates(info["clipped"].tolist())`.
"""

import copy
import functools
import operator

import numpy as np

from . import _core, spaces
from .episodes import Rows

STATE = 13
REFERENCE = 19
# Where episodes start at random: in balls of these radii about the reference's first point, any attitude, at rest but
# for its rates.
OFFSET = 10.0  # m
RATE = 15.0  # rad/s


def _in_ball(random, radius):
    """A point, uniform in a ball."""
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction) * radius * random.random() ** (1 / 3)


class Task:
    """What an environment wants of its agent: a subclass of `Environment` or `VectorEnvironment` may define any of
    these.

    `rows` are the 32 columns that the module lists, in the last axis: (32,) of an `Environment`, (num_envs, 32) of a
    `VectorEnvironment`. A text that writes `rows[..., column]` serves both. An observation gets the state as it
    is measured or estimated, the rest the true one.
    """

    def observation(self, rows):
        """What the agent sees, (m,) or (num_envs, m)."""
        return rows

    def reward(self, rows, actions):
        """What the step to `rows` by `actions`, as the agent gave them, earns: a number, or (num_envs,)."""
        return np.exp(-distance(rows))

    def terminated(self, rows):
        """Whether the episode is over, its goal reached or its vehicle lost: a bool, or (num_envs,)."""
        return ~(distance(rows) <= self.lost)

    def drawn(self, random):
        """A random start (13,), by one row's generator."""
        attitude = random.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        position = self.scenario.reference([0.0])[0, :3] + _in_ball(random, OFFSET)
        return _core.state(position, None, attitude, _in_ball(random, RATE))

    def begun(self, rows, chosen):
        """Told of every start: `chosen` is a bool, or (num_envs,): where an episode has just begun, at `rows`."""

    def moved(self, rows, actions):
        """Told of every step, before it is judged: where every vehicle is now, and by which actions. Of those that
        start anew in it, `begun` tells afterwards."""

    def things(self):
        """Lines that stand in the world, for pictures: a list of arrays (k, 3), m."""
        return []


def distance(rows):
    """From the reference, m."""
    return np.linalg.norm(rows[..., :3] - rows[..., STATE : STATE + 3], axis=-1).astype(float)


class VectorEnvironment(Task, spaces.Many):
    """Rows of vehicles, stepped together on all cores.

    An episode that ended is started anew by the next step, whose action it does not take (Gymnasium's `NEXT_STEP`); its
    reward is zero then.

    Args:
        scenario: vehicle, rotors, air, sensors or estimator, reference, duration and rate.
        num_envs: rows.
        start: "random" (any attitude, up to 10 m from the reference, up to 15 rad/s) or "scenario" (its own).
        lost: distance from the reference, m, at which an episode is over.
        action: "wrench", "acceleration", "forward" or "attitude": see `saturated_hybrid.actions`.
        scaled: whether actions are in [-1, 1], where zero hovers.
        shield: arguments of `ShieldRows`, the box to stay in at least: `{"low": [-4, -3, 0.3], "high": [4, 3, 4]}`;
            left out: none.
        render_mode: "rgb_array" keeps every episode, for `render` and `replay`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20, "autoreset_mode": spaces.NEXT_STEP}
    spec = None

    def __init__(
        self,
        scenario,
        num_envs,
        *,
        start="random",
        lost=100.0,
        action="wrench",
        scaled=False,
        shield=None,
        render_mode=None,
    ):
        self._rows = Rows(
            self,
            scenario,
            num_envs,
            False,
            start=start,
            lost=lost,
            action=action,
            scaled=scaled,
            shield=shield,
            render_mode=render_mode,
        )
        self.num_envs = self._rows.count
        self.single_action_space = self._rows.action_space
        self.action_space = spaces.batch_space(self.single_action_space, self.num_envs)

    @property
    def vehicles(self):
        """The `VehicleRows` that fly."""
        return self._rows.vehicles

    @property
    def headings(self):
        """Where "forward" is: unit vectors (num_envs, 2), world: the shield's headings, or else the vehicles' own."""
        return self._rows.headings()

    @functools.cached_property
    def single_observation_space(self):
        """Of one row."""
        return self._rows.observation_space

    @functools.cached_property
    def observation_space(self):
        """Of all rows."""
        return spaces.batch_space(self.single_observation_space, self.num_envs)

    def reset(self, *, seed=None, options=None):
        """Starts every row anew.

        Args:
            seed: an integer, of which row `k` takes `seed + k`; or one for each row. Left out: the generators go on.
            options: `{"state": array (num_envs, 13)}` to start there.

        Returns:
            observations (num_envs, m), and a dictionary.
        """
        return self._rows.reset(seed, _state(options))

    def step(self, actions):
        """Holds a command in every row for one control period.

        Args:
            actions: (num_envs, 4).

        Returns:
            observations (num_envs, m), rewards (num_envs,), terminated and truncated (num_envs,) bool, and a
            dictionary: `clipped` (num_envs,) bool, whether limits or rotors cut anything of the wrench; with the shield
            `by_policy` (num_envs,) bool, whether the agent's demand flew, and `reasons` (num_envs,), why not, in words.
        """
        return self._rows.step(actions)

    def render(self):
        """A picture (420, 480, 3) of uint8 of every row's episode so far; None without a `render_mode`."""
        if self.render_mode is None:
            return None
        return tuple(self._rows.picture(row) for row in range(self.num_envs))

    def replay(self, path, row=0, speed=1.0):
        """Writes a row's episode so far: a moving picture, `.gif`, or a page that any browser opens, `.html`."""
        self._rows.replay(path, operator.index(row), speed)

    def close(self, **_):
        """Nothing is left open."""

    def __copy__(self):
        """Another environment that flies on from where this one is: nothing of what flies is shared."""
        return copy.deepcopy(self)


class Environment(Task, spaces.One):
    """One vehicle: what a row of `VectorEnvironment` is, without starting anew by itself. Arguments as there."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}
    spec = None

    def __init__(
        self, scenario, *, start="random", lost=100.0, action="wrench", scaled=False, shield=None, render_mode=None
    ):
        self._rows = Rows(
            self,
            scenario,
            1,
            True,
            start=start,
            lost=lost,
            action=action,
            scaled=scaled,
            shield=shield,
            render_mode=render_mode,
        )
        self.action_space = self._rows.action_space

    @property
    def vehicles(self):
        """The one row of `VehicleRows` that flies."""
        return self._rows.vehicles

    @property
    def headings(self):
        """Where "forward" is: a unit vector (2,), world: the shield's heading, or else the vehicle's own."""
        return self._rows.headings()

    @functools.cached_property
    def observation_space(self):
        """As many numbers as the first observation has."""
        return self._rows.observation_space

    def reset(self, *, seed=None, options=None):
        """Starts anew; `options` may have a `state` (13,). Returns the observation (m,) and a dictionary."""
        if spaces.gymnasium is not None:
            super().reset(seed=seed)
        state = _state(options)
        observations, info = self._rows.reset(seed, None if state is None else np.asarray(state)[None])
        return observations[0], info

    def step(self, action):
        """Holds a command (4,) for one control period. Returns observation, reward, terminated, truncated and a
        dictionary; after an episode's end `RuntimeError`."""
        if self._rows.over[0]:
            raise RuntimeError("step: the episode is over: call reset first")
        observations, rewards, terminated, truncated, info = self._rows.step(np.asarray(action)[None])
        info = {key: value[0] if key == "reasons" else bool(value[0]) for key, value in info.items()}
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self):
        """A picture (420, 480, 3) of uint8 of the episode so far; None without a `render_mode`."""
        return None if self.render_mode is None else self._rows.picture(0)

    def replay(self, path, speed=1.0):
        """Writes the episode so far: a moving picture, `.gif`, or a page that any browser opens, `.html`."""
        self._rows.replay(path, 0, speed)

    def close(self):
        """Nothing is left open."""

    def __copy__(self):
        """Another environment that flies on from where this one is: nothing of what flies is shared."""
        return copy.deepcopy(self)


def _state(options):
    """Where to start, if the options say so."""
    unknown = set(options or {}) - {"state"}
    if unknown:
        raise ValueError(f"options: unknown key {sorted(unknown)[0]!r} (allowed: state)")
    return (options or {}).get("state")
