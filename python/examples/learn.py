"""Learns to hover, or to fly through a gate: with the shield from the first episode on, and without it.

    python python/examples/learn.py hover --out learnt
    python python/examples/learn.py gate --out learnt --start learnt/hover.toml

It writes the weights that were learnt, the learning curve, and a replay, and flies a thousand episodes each of the
policy as it starts, as it is learnt, and a malicious one, with and without the shield. The wheel and numpy are enough;
with matplotlib it draws the curve as well. `judge.py` beside it flies what was learnt on the boards' estimator.

The policy is a small tanh network, and evolution strategies train it: a generation flies every candidate through the
same episodes and moves the weights towards what earned more (Salimans et al., Evolution strategies as a scalable
alternative to reinforcement learning, 2017). An action is an acceleration and a yaw rate, scaled. What becomes of it is
the shield's to fly, whose limits are proven, or a textbook attitude controller's. docs/learning.md has the figures.
"""

import argparse
import pathlib
import time

import numpy as np
from judge import SIZES, TASKS, Flights, Network, judge, policies, scenario_of
from saturated_hybrid.actions import kinds

PAIRS, EPISODES = 24, 4  # candidates, two of a pair; episodes of each
EXAMINED = 16  # episodes of the weights themselves, which the learning curve shows
NOISE, STEP = 0.1, 0.1  # the step falls to a tenth
FINE = 0.3  # of both, where it begins with weights that were learnt
# While it learns, the policy gets its vehicle back soon, s.
PATIENCE = {"patience": 0.3}


def learn(task, shield, generations, start, seed, fine=1.0, report=print, **options):
    """The network that was learnt, and its learning curve: steps flown, what the network earns in the same EXAMINED
    episodes each time, and episodes lost so far."""
    candidates, spreading = 2 * PAIRS, fine * NOISE
    box, patience = (TASKS[task].box, PATIENCE) if shield else (None, {})
    flights = Flights(task, EXAMINED + candidates * EPISODES, box, **patience, **options)
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


def replay(task, network, path, scenario):
    """One episode of the network, shielded, as a moving picture."""
    environment = TASKS[task](scenario, 1, shield=TASKS[task].box, render_mode="rgb_array")
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
    parser.add_argument("--scenario", help="a vehicle's file; left out: the Hummingbird")
    parser.add_argument("--wind", type=float, default=0.0, help="m/s, with turbulence")
    arguments = parser.parse_args(given)
    out = pathlib.Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    task, curves, networks = arguments.task, {}, {}
    scenario = scenario_of(arguments.scenario, arguments.wind)
    start = Network.read(arguments.start) if arguments.start else Network.untrained(arguments.seed)
    fine = FINE if arguments.start else 1.0
    scale = kinds(TASKS[task](scenario, 1).scenario)["forward"].high
    for shield, name in ((True, "with the shield"), (False, "without")):
        print(name)
        learnt = learn(task, shield, arguments.generations, start, arguments.seed, fine, scenario=scenario)
        networks[shield], curves[name] = learnt
        header = "steps,earned,lost"
        np.savetxt(
            out / f"{task}-{name.split()[0]}.csv", curves[name], delimiter=",", header=header, comments="", fmt="%.6g"
        )
        (out / f"{task}{'' if shield else '-without'}.toml").write_text(networks[shield].text(task, scale))
    replay(task, networks[True], out / f"{task}.gif", scenario)
    compared = policies(start, networks[True], networks[False], arguments.seed)
    table = judge(task, compared, arguments.episodes, scenario=scenario)
    try:
        draw(curves, out / f"{task}.svg")
    except ImportError:
        print("without matplotlib there is no picture of the learning curve")
    return curves, table


if __name__ == "__main__":
    main()
