"""Environments in the manner of Gymnasium: rows of simulated vehicles under wrenches that an agent decides on.

`VectorEnvironment` is many vehicles, `Environment` one of them: row `k` of a vector that was reset with the seed `s` is the one
environment that was reset with `s + k`. With gymnasium installed they are a `gymnasium.vector.VectorEnv` and a `gymnasium.Env`;
without it they work alone, and their spaces have only what is needed.

    observation  (32,) float32   the state's 13 columns, then the reference's 19 (see `saturated_hybrid`)
    action        (4,) float32   thrust, N, and torque about the body axes, N m, held for one control period
    reward                       exp(-distance from the reference in m): one where it should be, 0.37 a metre off
    terminated                   further than `lost` from the reference, or no longer finite
    truncated                    the scenario's duration is over

The law itself is a policy: with `law = LawRows(scenario, rows)`, `law.for_rotors(law.step(observations[:, :13], observations[:, 13:]))`
are its actions; report those that were `clipped` to it: `law.hold_estimates(info["clipped"].tolist())`.
"""

import operator

import numpy as np

from . import _core

try:
    import gymnasium
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector.utils import batch_space

    _One, _Many, _Box = gymnasium.Env, gymnasium.vector.VectorEnv, gymnasium.spaces.Box
    _NEXT_STEP = AutoresetMode.NEXT_STEP
except ImportError:
    gymnasium = None
    _One, _Many, _NEXT_STEP = object, object, "NextStep"

    class _Box:
        """What an environment without gymnasium says of its observations and actions: bounds, shape and type."""

        def __init__(self, low, high, shape=None, dtype=np.float32):
            self.dtype = np.dtype(dtype)
            shape = np.shape(low) if shape is None else shape
            self.low = np.broadcast_to(np.asarray(low, dtype), shape).copy()
            self.high = np.broadcast_to(np.asarray(high, dtype), shape).copy()
            self.shape = self.low.shape

        def contains(self, x):
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all((x >= self.low) & (x <= self.high)))

    def batch_space(space, n):
        return _Box(np.repeat(space.low[None], n, 0), np.repeat(space.high[None], n, 0), dtype=space.dtype)


STATE = 13
REFERENCE = 19
# Where episodes start at random: in balls of these radii about the reference's first point, any attitude, at rest but for its rates.
OFFSET = 10.0  # m
RATE = 15.0  # rad/s


def _in_ball(random, radius):
    """A point, uniform in a ball."""
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction) * radius * random.random() ** (1 / 3)


class VectorEnvironment(_Many):
    """Rows of vehicles, stepped together on all cores.

    An episode that ended is started anew by the next step, whose action it does not take (Gymnasium's `NEXT_STEP`); its reward is
    zero then.

    Args:
        scenario: vehicle, rotors, air, sensors, reference, duration and rate. `[estimator]` is refused.
        num_envs: rows.
        start: "random" (any attitude, up to 10 m from the reference, up to 15 rad/s) or "scenario" (its own).
        lost: distance from the reference, m, at which an episode is over.
    """

    metadata = {"render_modes": [], "autoreset_mode": _NEXT_STEP}
    render_mode = None
    spec = None

    def __init__(self, scenario, num_envs, *, start="random", lost=100.0):
        if start not in ("random", "scenario"):
            raise ValueError(f'start: must be "random" or "scenario", found {start!r}')
        if not lost > 0.0:
            raise ValueError(f"lost: must be greater than zero, found {lost}")
        self.scenario, self.num_envs, self.start, self.lost = scenario, operator.index(num_envs), start, float(lost)
        self.vehicles = _core.VehicleRows(scenario, self.num_envs)
        infinite = np.full(STATE + REFERENCE, np.inf, np.float32)
        self.single_observation_space = _Box(-infinite, infinite, dtype=np.float32)
        greatest = np.concatenate([[scenario.thrust_max], scenario.torque_max]).astype(np.float32)
        self.single_action_space = _Box(greatest * np.float32([0, -1, -1, -1]), greatest, dtype=np.float32)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._generators = None
        self._over = np.zeros(self.num_envs, bool)

    def reset(self, *, seed=None, options=None):
        """Starts every row anew.

        Args:
            seed: an integer, of which row `k` takes `seed + k`; or one for each row. Left out: the generators go on.
            options: `{"state": array (num_envs, 13)}` to start there.

        Returns:
            observations (num_envs, 32), and a dictionary.
        """
        if seed is not None or self._generators is None:
            if seed is None:
                seeds = [None] * self.num_envs
            elif np.ndim(seed) == 0:
                seeds = [int(seed) + row for row in range(self.num_envs)]
            else:
                seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError(f"seed: must be an integer or {self.num_envs} of them, found {len(seeds)}")
            below = [each for each in seeds if each is not None and each < 0]
            if below:
                raise ValueError(f"seed: must not be below zero, found {below[0]}")
            self._generators = [np.random.default_rng(each) for each in seeds]
        unknown = set(options or {}) - {"state"}
        if unknown:
            raise ValueError(f"options: unknown key {sorted(unknown)[0]!r} (allowed: state)")
        states = (options or {}).get("state")
        self._place(np.ones(self.num_envs, bool), states)
        return self._observe(), {}

    def step(self, actions):
        """Holds a wrench in every row for one control period.

        Args:
            actions: (num_envs, 4), N and N m.

        Returns:
            observations (num_envs, 32), rewards (num_envs,), terminated and truncated (num_envs,) bool, and a dictionary:
            `clipped` (num_envs,) bool, whether limits or rotors cut anything of the wrench.
        """
        if self._generators is None:
            raise RuntimeError("step: call reset first")
        begun = self._over
        clipped, not_finite = self.vehicles.step(actions)
        if begun.any():
            self._place(begun)
        observations = self._observe()
        distance = np.linalg.norm(observations[:, :3] - observations[:, STATE : STATE + 3], axis=1)
        terminated = ((not_finite & ~begun) | ~(distance <= self.lost)) & ~begun
        truncated = (self.vehicles.ticks >= self.scenario.ticks) & ~terminated
        rewards = np.where(begun | ~np.isfinite(distance), 0.0, self.reward(observations, actions))
        self._over = terminated | truncated
        return observations, rewards, terminated, truncated, {"clipped": clipped & ~begun}

    def reward(self, observations, actions):
        """What every row earns, (num_envs,): a subclass may want something else."""
        distance = np.linalg.norm(observations[:, :3] - observations[:, STATE : STATE + 3], axis=1)
        return np.exp(-distance.astype(float))

    def close(self, **_):
        """Nothing is left open."""

    def _place(self, chosen, states=None):
        """Starts the chosen rows anew: where `states` says, or as `start` does."""
        given = states is not None
        states = np.array(states if given else np.tile(self.scenario.initial, (self.num_envs, 1)), float)
        seeds = [0] * self.num_envs
        for row in np.flatnonzero(chosen):
            random = self._generators[row]
            seeds[row] = int(random.integers(2**53))
            if self.start == "random" and not given:
                states[row] = self._drawn(random)
        self.vehicles.place(states, chosen.tolist(), seeds)
        self._over = self._over & ~chosen

    def _drawn(self, random):
        """A random start."""
        attitude = random.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        position = self.scenario.reference([0.0])[0, :3] + _in_ball(random, OFFSET)
        return _core.state(position, None, attitude, _in_ball(random, RATE))

    def _observe(self):
        return np.concatenate([self.vehicles.measured, self.vehicles.references], axis=1, dtype=np.float32)


class Environment(_One):
    """One vehicle: what a row of `VectorEnvironment` is, without starting anew by itself. Arguments as there."""

    metadata = {"render_modes": []}
    render_mode = None
    spec = None

    def __init__(self, scenario, *, start="random", lost=100.0):
        self.rows = VectorEnvironment(scenario, 1, start=start, lost=lost)
        self.observation_space = self.rows.single_observation_space
        self.action_space = self.rows.single_action_space

    def reset(self, *, seed=None, options=None):
        """Starts anew; `options` may have a `state` (13,). Returns the observation (32,) and a dictionary."""
        if gymnasium is not None:
            super().reset(seed=seed)
        rows = {key: np.asarray(value)[None] for key, value in (options or {}).items()}
        observations, info = self.rows.reset(seed=seed, options=rows)
        return observations[0], info

    def step(self, action):
        """Holds a wrench (4,) for one control period. Returns observation, reward, terminated, truncated and a dictionary."""
        observations, rewards, terminated, truncated, info = self.rows.step(np.asarray(action)[None])
        info = {"clipped": bool(info["clipped"][0])}
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def close(self):
        """Nothing is left open."""
