"""Learns to hover, or to fly through a gate: with the shield from the first episode on, and without it.

    python python/examples/learn.py hover --out learnt
    python python/examples/learn.py gate --out learnt --start learnt/hover.toml

It writes the weights that were learnt, the learning curve, and a replay, and flies a thousand episodes each of the
policy as it starts, as it is learnt, and a malicious one, with and without the shield. The wheel and numpy are enough;
with matplotlib it draws the curve as well.

The policy is a small tanh network, and evolution strategies train it: a generation flies every candidate through the
same episodes and moves the weights towards what earned more (Salimans et al., Evolution strategies as a scalable
alternative to reinforcement learning, 2017). An action is an acceleration and a yaw rate, scaled. What becomes of it is
the shield's to fly, whose limits are proven, or a textbook attitude controller's. docs/learning.md has the figures.
"""

import argparse
import pathlib
import time
import tomllib

import numpy as np
from saturated_hybrid.actions import kinds
from saturated_hybrid.tasks import GateRows, HoverRows

# The box that the shield keeps vehicles in, m, inside the one that ends an episode.
BOX = {"low": [-4.8, -3.8, 0.3], "high": [4.8, 3.8, 4.8]}
TASKS = {"hover": HoverRows, "gate": GateRows}
SIZES = (22, 16, 4)
# What makes the observation's numbers of order one: m, m/s, of the rotation, rad/s, of the last action.
SCALE = np.repeat(np.array([0.5, 0.5, 1.0, 0.2, 1.0], np.float32), [3, 3, 9, 3, 4])

PAIRS, EPISODES = 24, 4  # candidates, two of a pair; episodes of each
EXAMINED = 16  # episodes of the weights themselves, which the learning curve shows
NOISE, STEP = 0.1, 0.1  # the step falls to a tenth
FINE = 0.3  # of both, where it begins with weights that were learnt
# What a step costs that the law has to fly.
TAKEN_OVER = 0.5
# While it learns, the policy gets its vehicle back soon, s.
PATIENCE = {"patience": 0.3}


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


class Flights:
    """Episodes of one task, of many rows at once."""

    def __init__(self, task, rows, shield, **settings):
        self.environment = TASKS[task](None, rows, shield=BOX | settings if shield else None)
        self.ticks = self.environment.scenario.ticks

    def fly(self, act, seeds):
        """One episode of every row; `act` makes actions of observations. What they earned, and what happened, (rows,)
        each."""
        environment = self.environment
        observations, _ = environment.reset(seed=seeds)
        rows = environment.num_envs
        alive, earned = np.ones(rows, bool), np.zeros(rows)
        flown, clipped, by_policy, crashed, out = (np.zeros(rows) for _ in range(5))
        low, high = np.array(BOX["low"]), np.array(BOX["high"])
        for _ in range(self.ticks):
            observations, rewards, terminated, truncated, info = environment.step(act(observations))
            positions = environment.vehicles.states[:, :3]
            flown += alive
            policy = info.get("by_policy", np.ones(rows, bool))
            earned += alive * np.where(policy, rewards, -TAKEN_OVER)
            clipped += alive & info["clipped"]
            by_policy += alive & policy
            crashed += alive & (positions[:, 2] <= 0.0)
            out = np.where(alive, np.maximum(out, np.maximum(low - positions, positions - high).max(axis=1)), out)
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
            "out": out,
        }


def learn(task, shield, generations, start, seed, fine=1.0, report=print):
    """The network that was learnt, and its learning curve: steps flown, what the network earns in the same EXAMINED
    episodes each time, and episodes lost so far."""
    candidates, spreading = 2 * PAIRS, fine * NOISE
    flights = Flights(task, EXAMINED + candidates * EPISODES, shield, **PATIENCE)
    random = np.random.default_rng(seed)
    weights = start.weights.astype(float)
    momentum, square = np.zeros_like(weights), np.zeros_like(weights)
    curve, steps, lost, started = [], 0, 0, time.monotonic()
    for generation in range(generations):
        noise = random.normal(size=(PAIRS, Network.count))
        spread = np.concatenate([noise, -noise])
        examined, network = Network(weights), Network(weights + spreading * spread)
        starts = np.concatenate([np.arange(EXAMINED), np.tile(random.integers(2**31, size=EPISODES), candidates)])

        def act(observations):
            others = network.act(observations[EXAMINED:].reshape(candidates, EPISODES, -1))
            return np.concatenate([examined.act(observations[:EXAMINED]), others.reshape(-1, SIZES[-1])])

        seen = flights.fly(act, starts.tolist())
        earned = seen["earned"][EXAMINED:].reshape(candidates, EPISODES).mean(axis=1)
        steps, lost = steps + int(seen["flown"].sum()), lost + int(seen["lost"].sum())
        curve.append((steps, seen["earned"][:EXAMINED].mean(), lost))
        # By rank, from -1/2 to 1/2, so that no crash outweighs the rest.
        ranks = np.argsort(np.argsort(earned)) / (candidates - 1) - 0.5
        slope = ranks @ spread / (candidates * spreading)
        momentum, square = 0.9 * momentum + 0.1 * slope, 0.99 * square + 0.01 * slope**2
        share = (1 - 0.9 ** (generation + 1)), (1 - 0.99 ** (generation + 1))
        fall = 1.0 - 0.9 * generation / generations
        weights += fall * fine * STEP * (momentum / share[0]) / (np.sqrt(square / share[1]) + 1e-8)
        if generation % 10 == 9 or generation == 0:
            took = time.monotonic() - started
            report(
                f"generation {generation + 1}: earns {curve[-1][1]:.0f}, {steps} steps, "
                f"{lost} episodes lost, {took:.0f} s"
            )
    return Network(weights), np.array(curve)


def judge(task, policies, episodes, report=print):
    """Flies episodes of every policy with and without the shield. Rows of the table that it reports: names, and
    numbers."""
    head = (
        "policy",
        "shield",
        "earned",
        "crashed",
        "lost",
        "left the box",
        "farthest out, m",
        "beyond the rotors",
        "policy flew",
    )
    table = []
    report("| " + " | ".join(head) + " |")
    report("|" + "---|" * len(head))
    for name, policy in policies.items():
        for shield in (False, True):
            flights = Flights(task, episodes, shield)
            act = policy(episodes).act
            # Without the shield what is not a number is taken for zero: it would stop the simulation.
            seen = flights.fly(
                act if shield else lambda observations: np.nan_to_num(act(observations)), list(range(episodes))
            )
            flown = seen["flown"].sum()
            row = {
                "earned": seen["earned"].mean(),
                "crashed": int(seen["crashed"].sum()),
                "lost": int(seen["lost"].sum()),
                "out": int((seen["out"] > 0.0).sum()),
                "farthest": max(0.0, seen["out"].max()),
                "clipped": seen["clipped"].sum() / flown,
                "by_policy": seen["by_policy"].sum() / flown,
            }
            table.append((name, shield, row))
            cells = (name, "yes" if shield else "no", f"{row['earned']:.0f}", row["crashed"], row["lost"], row["out"])
            cells += (f"{row['farthest']:.2f}", f"{row['clipped']:.1%}", f"{row['by_policy']:.1%}")
            report("| " + " | ".join(map(str, cells)) + " |")
    return table


def draw(curves, path):
    """The learning curves as SVG."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "learn", "font.size": 9})
    figure, (above, below) = plt.subplots(2, sharex=True, figsize=(6, 4.2), constrained_layout=True)
    for (name, curve), color, style in zip(curves.items(), ("#0072B2", "#D55E00"), ("-", "--")):
        above.plot(curve[:, 0] / 1e6, curve[:, 1], style, color=color, label=name)
        below.plot(curve[:, 0] / 1e6, curve[:, 2], style, color=color, label=name)
    above.set_ylabel("earned in an episode\nof 500 steps")
    below.set_ylabel("episodes that were lost")
    below.set_xlabel("steps flown, millions")
    above.legend(frameon=False)
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def replay(task, network, path):
    """One episode of the network, shielded, as a moving picture."""
    environment = TASKS[task](None, 1, shield=BOX, render_mode="rgb_array")
    observations, _ = environment.reset(seed=3)
    for _ in range(environment.scenario.ticks - 1):
        observations, _, terminated, *_ = environment.step(network.act(observations))
        if terminated.any():
            break
    environment.replay(path)


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("task", choices=list(TASKS))
    parser.add_argument("--out", default="learnt", help="directory for what comes out")
    parser.add_argument("--generations", type=int, default=100)
    parser.add_argument("--episodes", type=int, default=1000, help="of each policy in the table")
    parser.add_argument(
        "--start", help="weights to begin with, a file of an earlier run; left out: small ones, at random"
    )
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(given)
    out = pathlib.Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    task, curves, networks = arguments.task, {}, {}
    start = Network.read(arguments.start) if arguments.start else Network.untrained(arguments.seed)
    fine = FINE if arguments.start else 1.0
    for shield, name in ((True, "with the shield"), (False, "without")):
        print(name)
        networks[shield], curves[name] = learn(task, shield, arguments.generations, start, arguments.seed, fine)
        header = "steps,earned,lost"
        np.savetxt(
            out / f"{task}-{name.split()[0]}.csv", curves[name], delimiter=",", header=header, comments="", fmt="%.6g"
        )
    (out / f"{task}.toml").write_text(networks[True].text(task, kinds(TASKS[task](None, 1).scenario)["forward"].high))
    replay(task, networks[True], out / f"{task}.gif")
    policies = {
        "as it starts": lambda rows: start,
        "learnt with the shield": lambda rows: networks[True],
        "learnt without": lambda rows: networks[False],
        "spring and damper": lambda rows: Spring(),
        "malicious": lambda rows: Malicious(rows, arguments.seed),
    }
    table = judge(task, policies, arguments.episodes)
    try:
        draw(curves, out / f"{task}.svg")
    except ImportError:
        print("without matplotlib there is no picture of the learning curve")
    return curves, table


if __name__ == "__main__":
    main()
