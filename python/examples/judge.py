"""Flies policies by the thousand, with and without the shield: on the true states, or on the boards' estimates.

    python python/examples/judge.py learnt                  what python/examples/learn.py has left in that directory
    python python/examples/judge.py learnt --estimated      with sensors and late poses
    python python/examples/judge.py learnt --estimated --late --wind 2

It prints a table: what each policy earns, how many of its episodes are lost, how often and how far the vehicle's true
place left the box, how often a rotor was asked for more than it has, and how much of the time the policy flew. The
policies are those that were learnt, one that has learnt nothing, a spring with a damper, and a malicious one.
docs/learning.md has the tables.
"""

import argparse
import pathlib
import tomllib

import numpy as np
import saturated_hybrid as sh
from saturated_hybrid.tasks import ROOM, GateRows, HoverRows

TASKS = {"hover": HoverRows, "gate": GateRows}
SIZES = (22, 16, 4)
# What makes the observation's numbers of order one: m, m/s, of the rotation, rad/s, of the last action.
SCALE = np.repeat(np.array([0.5, 0.5, 1.0, 0.2, 1.0], np.float32), [3, 3, 9, 3, 4])
# What a step costs that the law has to fly.
TAKEN_OVER = 0.5

# Poses as a poor source gives them: 50 a second of 5 mm and 0.5 degrees, 100 ms late, a tenth of them lost.
LATE = {"pose_rate": 50.0, "pose_delay": 0.1, "position_noise": 0.005, "attitude_noise_deg": 0.5, "dropout": 0.1}


class Network:
    """Layers of weights with tanh between them and at the end. Its weights may be a batch's: (candidates, weights)."""

    count = sum(after * (before + 1) for before, after in zip(SIZES, SIZES[1:]))

    def __init__(self, weights):
        self.weights = np.asarray(weights, np.float32)

    def layers(self):
        """Matrices (…, after, before) and biases (…, after)."""
        place = 0
        for before, after in zip(SIZES, SIZES[1:]):
            matrix = self.weights[..., place : place + after * before]
            place += after * before
            yield matrix.reshape(*matrix.shape[:-1], after, before), self.weights[..., place : place + after]
            place += after

    def act(self, observations):
        """Actions (…, rows, 4) in [-1, 1] for observations (…, rows, 22)."""
        values = observations * SCALE
        for matrix, bias in self.layers():
            values = np.tanh(values @ np.swapaxes(matrix, -1, -2) + bias[..., None, :])
        return values

    @classmethod
    def read(cls, path):
        """From a file that `text` made."""
        flat, scale = [], SCALE
        for layer in tomllib.loads(pathlib.Path(path).read_text())["layers"]:
            flat += [(np.array(layer["weights"]) / scale).ravel(), np.array(layer["biases"])]
            scale = 1.0
        return cls(np.concatenate(flat))

    @classmethod
    def untrained(cls, seed):
        """Small weights, at random."""
        return cls(np.random.default_rng(seed).normal(size=cls.count) * 0.1)

    def text(self, task, scale):
        """A policy file, as boards and `saturated_hybrid.Network` read it: what makes the observation's numbers small
        is part of the first matrix; an output of one demands `scale`."""
        lines = [
            f"# Learnt by python/examples/learn.py {task}.",
            f"scale = [{', '.join(f'{each:.6g}' for each in scale)}]",
        ]
        for number, (matrix, bias) in enumerate(self.layers()):
            matrix = matrix * SCALE if number == 0 else matrix
            rows = ",\n".join("    [" + ", ".join(f"{each:.6g}" for each in row) + "]" for row in matrix)
            lines += [
                "",
                "[[layers]]",
                f"weights = [\n{rows},\n]",
                "biases = [" + ", ".join(f"{each:.6g}" for each in bias) + "]",
            ]
        return "\n".join(lines) + "\n"


class Spring:
    """What no learning is needed for: a spring to the target and a damper."""

    def act(self, observations):
        """Actions (rows, 4)."""
        return np.concatenate(
            [0.8 * observations[:, :3] - 0.6 * observations[:, 3:6], np.zeros_like(observations[:, :1])], axis=1
        )


class Malicious:
    """A fifth of the rows each: noise, full deflections that change each third of a second, full speed downwards and to
    a side, a fast oscillation, and no numbers at all."""

    def __init__(self, rows, seed):
        self.random, self.rows, self.tick = np.random.default_rng(seed), rows, 0

    def act(self, observations):
        """Actions (rows, 4)."""
        kind = np.arange(self.rows) % 5
        if self.tick % 33 == 0:
            self.held = self.random.choice([-1.0, 1.0], (self.rows, 4))
        actions = self.random.uniform(-1.0, 1.0, (self.rows, 4))
        actions[kind == 1] = self.held[kind == 1]
        actions[kind == 2] = [0.0, 1.0, -1.0, 0.0]
        actions[kind == 3] = np.sin(2.0 * np.pi * 5.0 * 0.01 * self.tick) > 0.0
        actions[kind == 3] = 2.0 * actions[kind == 3] - 1.0
        actions[kind == 4] = np.nan
        self.tick += 1
        return actions


def outside(positions, box):
    """How far places (rows, 3) are outside every box of a shield, m; less than zero inside."""
    low, high = (np.reshape(box[corner], (-1, 1, 3)) for corner in ("low", "high"))
    return np.maximum(low - positions, positions - high).max(axis=2).min(axis=0)


class Flights:
    """Episodes of one task, of many rows at once, behind a shield that keeps a `box`, or without one."""

    def __init__(self, task, rows, box=None, scenario=None, estimated=False, **settings):
        shield = None if box is None else box | settings
        self.environment = TASKS[task](scenario, rows, shield=shield, estimated=estimated)
        self.ticks, self.box = self.environment.scenario.ticks, box or ROOM

    def fly(self, act, seeds):
        """One episode of every row; `act` makes actions of observations. What they earned, and what happened, (rows,)
        each."""
        environment = self.environment
        observations, _ = environment.reset(seed=seeds)
        rows = environment.num_envs
        alive, earned = np.ones(rows, bool), np.zeros(rows)
        flown, clipped, by_policy, crashed, wall = (np.zeros(rows) for _ in range(5))
        out = np.full(rows, -np.inf)
        for _ in range(self.ticks):
            observations, rewards, terminated, truncated, info = environment.step(act(observations))
            positions = environment.vehicles.states[:, :3]
            flown += alive
            policy = info.get("by_policy", np.ones(rows, bool))
            earned += alive * np.where(policy, rewards, -TAKEN_OVER)
            clipped += alive & info["clipped"]
            by_policy += alive & policy
            crashed += alive & (positions[:, 2] <= 0.0)
            wall += alive & getattr(environment, "hit", False)
            out = np.where(alive, np.maximum(out, outside(positions, self.box)), out)
            alive = alive & ~terminated
            if not alive.any():
                break
        lost = ~alive
        return {
            "earned": earned,
            "flown": flown,
            "clipped": clipped,
            "by_policy": by_policy,
            "crashed": crashed > 0,
            "lost": lost,
            "wall": wall > 0,
            "out": out,
        }


HEAD = (
    "policy",
    "shield",
    "earned",
    "crashed",
    "lost",
    "at the wall",
    "left the box",
    "to its walls, m",
    "beyond the rotors",
    "policy flew",
)


def judge(task, policies, episodes, report=print, shielded=False, **options):
    """Flies episodes of every policy with and without the shield; of the gate also with a shield that knows only the
    room. Only with the shield of the task, if `shielded`. Rows of the table that it reports: names, and numbers."""
    shields = {"no": None, "box": ROOM}
    if TASKS[task].box is not ROOM:
        shields["boxes"] = TASKS[task].box
    if shielded:
        shields = dict(list(shields.items())[-1:])
    table = []
    report("| " + " | ".join(HEAD) + " |")
    report("|" + "---|" * len(HEAD))
    for name, policy in policies.items():
        for shield, box in shields.items():
            flights = Flights(task, episodes, box, **options)
            act = policy(episodes).act
            # Without the shield what is not a number is taken for zero: it would stop the simulation.
            seen = flights.fly(
                act if box else lambda observations: np.nan_to_num(act(observations)), list(range(episodes))
            )
            flown = seen["flown"].sum()
            row = {
                "earned": seen["earned"].mean(),
                "crashed": int(seen["crashed"].sum()),
                "lost": int(seen["lost"].sum()),
                "wall": int(seen["wall"].sum()),
                "out": int((seen["out"] > 0.0).sum()),
                "nearest": -seen["out"].max(),
                "clipped": seen["clipped"].sum() / flown,
                "by_policy": seen["by_policy"].sum() / flown,
            }
            table.append((name, shield, row))
            cells = (name, shield, f"{row['earned']:.0f}", row["crashed"], row["lost"], row["wall"])
            cells += (row["out"], f"{row['nearest']:.2f}", f"{row['clipped']:.1%}", f"{row['by_policy']:.1%}")
            report("| " + " | ".join(map(str, cells)) + " |")
    return table


def policies(start, shielded, unshielded, seed):
    """Those that are compared, by name: each makes a policy for so many rows."""
    return {
        "as it starts": lambda rows: start,
        "learnt with the shield": lambda rows: shielded,
        "learnt without": lambda rows: unshielded,
        "spring and damper": lambda rows: Spring(),
        "malicious": lambda rows: Malicious(rows, seed),
    }


def scenario_of(file=None, wind=0.0):
    """A vehicle's, or the built-in Hummingbird's, in a steady wind, m/s, with turbulence."""
    scenario = sh.Scenario.load(file) if file else sh.Scenario.built_in("hummingbird")
    if not wind:
        return scenario
    turbulence = {"wind_at_20_feet": 2.0 * wind, "altitude": 10.0}
    return scenario.edited({"wind": {"steady": [0.8 * wind, 0.6 * wind, 0.0], "turbulence": turbulence}})


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("learnt", type=pathlib.Path, help="a directory that learn.py has written for both tasks")
    parser.add_argument("--task", choices=list(TASKS), action="append", help="left out: both")
    parser.add_argument("--shielded", action="store_true", help="only with the shield of the task")
    parser.add_argument("--estimated", action="store_true", help="on the boards' estimator: poses 20 ms late")
    parser.add_argument("--late", action="store_true", help="poses 100 ms late and noisy, a tenth of them lost")
    parser.add_argument("--scenario", help="a vehicle's file; left out: the Hummingbird")
    parser.add_argument("--wind", type=float, default=0.0, help="m/s, with turbulence")
    parser.add_argument("--episodes", type=int, default=1000, help="of each policy")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(given)
    scenario = scenario_of(arguments.scenario, arguments.wind)
    estimated = LATE if arguments.late else arguments.estimated
    options = {"shielded": arguments.shielded, "scenario": scenario, "estimated": estimated}
    # The gate was learnt from weights that hover.
    starts = {"hover": lambda: Network.untrained(arguments.seed), "gate": lambda: read("hover")}
    tables = {}

    def read(name):
        return Network.read(arguments.learnt / f"{name}.toml")

    for task in arguments.task or TASKS:
        print(f"\n**{task}**\n")
        compared = policies(starts[task](), read(task), read(f"{task}-without"), arguments.seed)
        tables[task] = judge(task, compared, arguments.episodes, **options)
    return tables


if __name__ == "__main__":
    main()
