"""Episodes of rows of vehicles: what `VectorEnvironment` and `Environment` have in common.

`Rows` moves the vehicles and asks the environment, its `Task`, for everything else: of one vehicle with one row, of a
vector with all.
"""

import functools
import operator

import numpy as np

from . import _core, spaces
from .actions import Direct, Shielded, Unshielded, kinds


class Rows:
    """The vehicles of an environment, and what it wants of them. `one`: the task is of one vehicle, not of rows."""

    def __init__(self, task, scenario, count, one, *, start, lost, action, scaled, shield, render_mode):
        if start not in ("random", "scenario"):
            raise ValueError(f'start: must be "random" or "scenario", found {start!r}')
        if not lost > 0.0:
            raise ValueError(f"lost: must be greater than zero, found {lost}")
        known = kinds(scenario)
        if action not in known:
            raise ValueError(f"action: must be one of {', '.join(known)}, found {action!r}")
        if shield is not None and action == "wrench":
            raise ValueError('shield: carries no wrenches: choose action="acceleration" or "attitude"')
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode: must be None or "rgb_array", found {render_mode!r}')
        task.scenario, task.start, task.lost, task.render_mode = scenario, start, float(lost), render_mode
        self.task, self.scenario, self.count, self.one = task, scenario, operator.index(count), one
        self.vehicles = _core.VehicleRows(scenario, self.count)
        self.kind, self.scaled = known[action], bool(scaled)
        if action == "wrench":
            self.flier = Direct()
        elif shield is None:
            self.flier = Unshielded(scenario, self.count)
        else:
            self.flier = Shielded(scenario, self.count, shield)
        low, high = (self.kind.low, self.kind.high) if not self.scaled else (-np.ones(4), np.ones(4))
        self.action_space = spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
        self.generators = None
        self.over = np.zeros(self.count, bool)
        # Of each row, what happened since it started.
        self.kept = None if render_mode is None else [[] for _ in range(self.count)]

    @functools.cached_property
    def observation_space(self):
        """As many numbers as the task's first observation has."""
        if self.generators is None:
            self.vehicles.place(np.tile(self.scenario.initial, (self.count, 1)))
            self.ask("begun", self.true_rows(), np.ones(self.count, bool))
        infinite = np.full(self.observe(self.rows()).shape[1:], np.inf, np.float32)
        return spaces.Box(-infinite, infinite, dtype=np.float32)

    def ask(self, name, *rows):
        """The task's answer, for every row."""
        asked = getattr(self.task, name)
        return np.asarray(asked(*(each[0] for each in rows)))[None] if self.one else np.asarray(asked(*rows))

    def judged(self, name, *rows):
        """The same, where it must be one value for every row."""
        answer = self.ask(name, *rows)
        if answer.shape != (self.count,):
            wanted, found = ("()", answer.shape[1:]) if self.one else (f"({self.count},)", answer.shape)
            raise ValueError(f"{name}: must have shape {wanted}, found {found}")
        return answer

    def rows(self, states=None):
        states = self.vehicles.measured if states is None else states
        return np.concatenate([states, self.vehicles.references], axis=1, dtype=np.float32)

    def true_rows(self):
        return self.rows(self.vehicles.states)

    def headings(self):
        headings = self.flier.headings(self.vehicles.measured)
        return headings[0] if self.one else headings

    def observe(self, rows):
        return np.array(self.ask("observation", rows), np.float32)

    def reset(self, seed, states):
        if seed is not None or self.generators is None:
            if seed is None:
                seeds = [None] * self.count
            elif np.ndim(seed) == 0:
                seeds = [int(seed) + row for row in range(self.count)]
            else:
                seeds = list(seed)
            if len(seeds) != self.count:
                raise ValueError(f"seed: must be an integer or {self.count} of them, found {len(seeds)}")
            below = [each for each in seeds if each is not None and each < 0]
            if below:
                raise ValueError(f"seed: must not be below zero, found {below[0]}")
            self.generators = [np.random.default_rng(each) for each in seeds]
        chosen = np.ones(self.count, bool)
        self.place(chosen, states)
        self.ask("begun", self.true_rows(), chosen)
        return self.observe(self.rows()), {}

    def place(self, chosen, states=None):
        """Starts the chosen rows anew: where `states` says, or as the task does."""
        given = states is not None
        states = np.array(states if given else np.tile(self.scenario.initial, (self.count, 1)), float)
        seeds = [0] * self.count
        for row in np.flatnonzero(chosen):
            random = self.generators[row]
            seeds[row] = int(random.integers(2**53))
            if self.task.start == "random" and not given:
                states[row] = self.task.drawn(random)
        self.vehicles.place(states, chosen.tolist(), seeds)
        self.over = self.over & ~chosen
        self.flier.reset(chosen)
        if self.kept is not None:
            for row in np.flatnonzero(chosen):
                self.kept[row] = []

    def step(self, actions):
        if self.generators is None:
            raise RuntimeError("step: call reset first")
        begun = self.over
        try:
            columns = np.asarray(actions, float)
        except (TypeError, ValueError):
            raise ValueError("actions: must be an array of numbers") from None
        if columns.shape != (self.count, 4):
            raise ValueError(f"actions: must have shape ({self.count}, 4), found {columns.shape}")
        measured = self.vehicles.measured
        columns = self.kind.unscaled(columns) if self.scaled else columns
        demands = self.kind.demand(columns, self.flier.headings(measured))
        wrenches = np.asarray(self.flier.step(self.vehicles, demands))
        by_policy, reasons = self.flier.by_policy, self.flier.reasons
        self.keep(wrenches, by_policy)
        clipped, not_finite = self.vehicles.step(wrenches)
        self.flier.end(clipped)
        if begun.any():
            self.place(begun)
        rows = self.true_rows()
        self.ask("moved", rows, np.asarray(actions))
        if begun.any():
            self.ask("begun", rows, begun)
        finite = np.isfinite(rows).all(axis=1) & ~not_finite
        terminated = (self.judged("terminated", rows) | ~finite) & ~begun
        truncated = (self.vehicles.ticks >= self.scenario.ticks) & ~terminated & ~begun
        rewards = np.where(begun | ~finite, 0.0, self.judged("reward", rows, np.asarray(actions)))
        self.over = terminated | truncated
        info = {"clipped": clipped & ~begun}
        if by_policy is not None:
            info |= {"by_policy": by_policy, "reasons": np.array(reasons, object)}
        return self.observe(self.rows()), rewards, terminated, truncated, info

    def keep(self, wrenches, by_policy):
        if self.kept is None:
            return
        states, references = self.vehicles.states, self.vehicles.references
        for row, kept in enumerate(self.kept):
            flown = True if by_policy is None else bool(by_policy[row])
            kept.append((states[row], references[row], wrenches[row], flown))

    def episode(self, row):
        """States, references, wrenches and who flew, of the row's episode so far."""
        if self.kept is None:
            raise RuntimeError('replay: nothing is kept: make the environment with render_mode="rgb_array"')
        if not 0 <= row < self.count:
            raise ValueError(f"row: must be from 0 to {self.count - 1}, found {row}")
        if not self.kept[row]:
            raise RuntimeError("replay: the episode has no step yet")
        return tuple(np.array(column) for column in zip(*self.kept[row]))

    def picture(self, row):
        kept = self.kept[row]
        states = [*(each[0] for each in kept), self.vehicles.states[row]]
        references = [*(each[1] for each in kept), self.vehicles.references[row]]
        corners = references[0][:3] + np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
        return _core.picture(states, references, things=self.task.things(), around=[*corners, states[0][:3]])

    def replay(self, path, row, speed):
        states, references, wrenches, by_policy = self.episode(row)
        shown = {} if self.flier.by_policy is None else {"by_policy": by_policy}
        _core.replay(self.scenario, path, states, references, wrenches, things=self.task.things(), speed=speed, **shown)
